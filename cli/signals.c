#include "signals.h"
#include "exit_code.h"
#include "output_file.h"

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

static volatile sig_atomic_t pending;

static void handle(int signal)
{
	if (pending) {
		output_file_remove_temporaries();
		_exit(EXIT_CODE_SIGNAL + signal);
	}
	pending = signal;
}

void signals_install(void)
{
	/* Without SA_RESTART: reading from a pipe that never ends must return. */
	struct sigaction stop = { .sa_handler = handle };
	struct sigaction ignore = { .sa_handler = SIG_IGN };
	sigaction(SIGINT, &stop, NULL);
	sigaction(SIGTERM, &stop, NULL);
	sigaction(SIGPIPE, &ignore, NULL);
	sigaction(SIGXFSZ, &ignore, NULL);
	/* A file that we open must not become standard output. Read-only: writes to it then fail. */
	for (int fd = 0; fd <= 2; fd++)
		if (fcntl(fd, F_GETFD) < 0 && open("/dev/null", O_RDONLY) != fd)
			_exit(EXIT_CODE_INTERNAL);
}

int signals_pending(void)
{
	return pending;
}

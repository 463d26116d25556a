#include "signals.h"
#include "exit_code.h"
#include "input_file.h"
#include "output_file.h"

#include <errno.h>
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

/* Only reading a file raises it where nothing is wrong with the program. */
static void handle_lost_page(int number, siginfo_t *info, void *context)
{
	(void)context;
	int saved = errno;
	if (!input_file_lost_page(info->si_addr))
		signal(number, SIG_DFL);
	errno = saved;
}

void signals_install(void)
{
	/* Without SA_RESTART: reading from a pipe that never ends must return. */
	struct sigaction stop = { .sa_handler = handle };
	struct sigaction ignore = { .sa_handler = SIG_IGN };
	struct sigaction lost = { .sa_sigaction = handle_lost_page, .sa_flags = SA_SIGINFO };
	sigaction(SIGBUS, &lost, NULL);
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

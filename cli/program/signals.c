#include "program/signals.h"
#include "program/exit_code.h"
#include "files/input_file.h"
#include "files/output_file.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/time.h>
#include <unistd.h>

/* Where the work asks too seldom, in libraries and drivers, it is ended after this. */
#define PATIENCE_MICROSECONDS 500000

static volatile sig_atomic_t pending, hasty;

static void end_now(void)
{
	output_file_remove_temporaries();
	_exit(EXIT_CODE_SIGNAL + pending);
}

static void handle(int signal)
{
	if (pending)
		end_now();
	pending = signal;
	if (hasty)
		output_file_remove_temporaries();
	/* Unlike timers made with timer_create, this one also works in a process that was forked. */
	struct itimerval once = { .it_value = { .tv_usec = PATIENCE_MICROSECONDS } };
	setitimer(ITIMER_REAL, &once, NULL);
}

static void handle_patience(int signal)
{
	static const char text[] = "glowworm: stopped\n";
	(void)signal;
	if (!pending)
		return;
	if (write(STDERR_FILENO, text, sizeof text - 1) < 0) {
		/* Nobody is there to be told. */
	}
	end_now();
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
	struct sigaction patience = { .sa_handler = handle_patience }, hangup;
	sigaction(SIGALRM, &patience, NULL);
	/* Under nohup the terminal may close. */
	if (sigaction(SIGHUP, NULL, &hangup) == 0 && hangup.sa_handler != SIG_IGN)
		sigaction(SIGHUP, &stop, NULL);
	sigaction(SIGPIPE, &ignore, NULL);
	sigaction(SIGXFSZ, &ignore, NULL);
	/* A file that we open must not become standard output. Read-only: writes to it then fail. */
	for (int fd = 0; fd <= 2; fd++)
		if (fcntl(fd, F_GETFD) < 0 && open("/dev/null", O_RDONLY) != fd)
			_exit(EXIT_CODE_INTERNAL);
}

void signals_expect_haste(void)
{
	hasty = 1;
}

int signals_pending(void)
{
	return pending;
}

gw_status signals_check(gw_error *error)
{
	return signals_pending() ? gw_fail(error, GW_ERROR_CANCELLED, "stopped") : GW_OK;
}

#include "program/child_process.h"
#include "program/signals.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* What work that returned exits with: not a number that programs and libraries like to use. */
#define FINISHED 87

static double now(void)
{
	struct timespec time;
	clock_gettime(CLOCK_MONOTONIC, &time);
	return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

void *child_memory_create(size_t bytes)
{
	void *memory = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
	return memory == MAP_FAILED ? NULL : memory;
}

void child_memory_destroy(void *memory, size_t bytes)
{
	if (memory)
		munmap(memory, bytes);
}

/* The last line of what was written, without what a terminal would obey. */
static void read_last_line(int file, char *text, size_t size)
{
	char tail[1024];
	off_t length = lseek(file, 0, SEEK_END);
	off_t from = length > (off_t)sizeof tail ? length - (off_t)sizeof tail : 0;
	ssize_t got = length > 0 ? pread(file, tail, sizeof tail, from) : 0;
	while (got > 0 && (tail[got - 1] == '\n' || tail[got - 1] == '\r'))
		got--;
	ssize_t first = got > 0 ? got : 0;
	while (first > 0 && tail[first - 1] != '\n')
		first--;
	size_t used = 0;
	for (; first < got && used + 1 < size; first++)
		text[used++] = tail[first] >= ' ' && tail[first] <= '~' ? tail[first] : '?';
	text[used] = '\0';
}

/* In the child. */
static _Noreturn void run_here(void (*work)(void *user), void *user, int errors)
{
	static const int usual[] = { SIGINT, SIGTERM, SIGHUP, SIGABRT, SIGSEGV, SIGBUS };
	const struct rlimit none = { 0, 0 };
	for (size_t i = 0; i < sizeof usual / sizeof *usual; i++)
		signal(usual[i], SIG_DFL);
	setrlimit(RLIMIT_CORE, &none);
	if (errors >= 0)
		dup2(errors, STDERR_FILENO);
	work(user);
	_exit(FINISHED);
}

static gw_status wait_for(pid_t child, double seconds, child_end *end, gw_error *error)
{
	const struct timespec pause = { .tv_nsec = 2000000 };
	double start = now();
	int status = 0;
	pid_t ended;
	while ((ended = waitpid(child, &status, WNOHANG)) == 0 || (ended < 0 && errno == EINTR)) {
		end->timed_out = now() - start > seconds;
		if (end->timed_out || signals_pending()) {
			kill(child, SIGKILL);
			waitpid(child, &status, 0);
			break;
		}
		nanosleep(&pause, NULL);
	}
	end->seconds = now() - start;
	GW_TRY(signals_check(error));
	if (ended < 0)
		return gw_fail(error, GW_ERROR_INTERNAL, "a process is lost: %s", strerror(errno));
	end->code = WIFEXITED(status) ? WEXITSTATUS(status) : 0;
	end->signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
	end->finished = WIFEXITED(status) && end->code == FINISHED;
	return GW_OK;
}

gw_status child_run(void (*work)(void *user), void *user, double seconds, child_end *end,
					gw_error *error)
{
	*end = (child_end){ 0 };
	int errors = memfd_create("errors", MFD_CLOEXEC);
	fflush(NULL);
	pid_t child = fork();
	if (child == 0)
		run_here(work, user, errors);
	gw_status status =
		child < 0 ? gw_fail(error, GW_ERROR_MEMORY, "no process can be made: %s", strerror(errno))
				  : wait_for(child, seconds, end, error);
	if (errors >= 0) {
		read_last_line(errors, end->said, sizeof end->said);
		close(errors);
	}
	return status;
}

void child_end_text(const child_end *end, char *text, size_t size)
{
	char how[64];
	const char *name = end->signal ? sigabbrev_np(end->signal) : NULL;
	if (end->timed_out)
		snprintf(how, sizeof how, "killed because it did not end");
	else if (end->signal)
		snprintf(how, sizeof how, "ended by signal %d, SIG%s", end->signal, name ? name : "?");
	else
		snprintf(how, sizeof how, "ended with status %d", end->code);
	snprintf(text, size, "%s after %.1f s%s%s", how, end->seconds, *end->said ? ": " : "",
			 end->said);
}

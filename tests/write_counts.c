/*
 * write_counts.c - linked into the programs that count lines, so that they can write their counts.
 *
 * libgcov writes them when a program ends. Under a limit on the size of files, as some tests set
 * it, they would be cut short, and libgcov would say so where a test compares what is printed; a
 * limit that was set with `ulimit -S` can be lifted again. What ends by _exit, as children and
 * whoever is stopped do, would write none.
 */
#include <gcov.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

/* Destructors without a priority run before libgcov's, which has one. */
__attribute__((destructor)) static void lift_file_limit(void)
{
	struct rlimit limit;
	if (getrlimit(RLIMIT_FSIZE, &limit) != 0)
		return;
	limit.rlim_cur = limit.rlim_max;
	setrlimit(RLIMIT_FSIZE, &limit);
}

/* Instead of the C library's. */
_Noreturn void _exit(int status)
{
	lift_file_limit();
	__gcov_dump();
	for (;;)
		syscall(SYS_exit_group, status);
}

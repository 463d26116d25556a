/*
 * lift_file_limit.c - linked into the programs that count lines, so that they can write the counts.
 *
 * They are written when a program ends. Under a limit on the size of files, as some tests set it,
 * they would be cut short, and libgcov would say so where a test compares what is printed. A limit
 * that a test sets with `ulimit -S` can be lifted again.
 */
#include <sys/resource.h>

/* Destructors without a priority run before libgcov's, which has one. */
__attribute__((destructor)) static void lift_file_limit(void)
{
	struct rlimit limit;
	if (getrlimit(RLIMIT_FSIZE, &limit) != 0)
		return;
	limit.rlim_cur = limit.rlim_max;
	setrlimit(RLIMIT_FSIZE, &limit);
}

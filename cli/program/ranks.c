/* ranks.c - see ranks.h. */
#include "program/ranks.h"

#include "files/plugin.h"
#include "program/exit_code.h"
#include "program/mpi_ranks.h"
#include "program/signals.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

/* How long the first rank may take to end all others: on a busy machine more than one. */
#define END_SECONDS 5

/* How often a rank that waits looks whether the others are there. */
#define LOOK_NANOSECONDS 20000000L

/* Those of the shared object; NULL while this process is alone. */
static mpi_ranks_begin_function *begin;
static mpi_ranks_meet_function *meet;
static mpi_ranks_end_function *end;
static bool silent;

static bool says_several(const char *variable)
{
	const char *count = getenv(variable);
	return count && strtol(count, NULL, 10) > 1;
}

/* Whether somebody starts several of us, who can meet: Open MPI's mpirun, or those of MPICH; srun
 * only with an interface by which they do. */
static bool is_one_of_several(void)
{
	return says_several("OMPI_COMM_WORLD_SIZE") || says_several("PMI_SIZE") ||
		   (getenv("PMIX_RANK") && says_several("SLURM_STEP_NUM_TASKS"));
}

/* dlsym returns a pointer to data; ISO C has no cast from that to a function. */
gw_status ranks_try(gw_error *error)
{
	static const char file[] = "libglowworm-mpi.so", purpose[] = "several processes by MPI need";
	const void *address;
	GW_TRY(plugin_find(file, "mpi_ranks_begin", purpose, &address, error));
	memcpy(&begin, &address, sizeof begin);
	GW_TRY(plugin_find(file, "mpi_ranks_meet", purpose, &address, error));
	memcpy(&meet, &address, sizeof meet);
	GW_TRY(plugin_find(file, "mpi_ranks_end", purpose, &address, error));
	memcpy(&end, &address, sizeof end);
	return GW_OK;
}

gw_status ranks_join(ranks *r, gw_error *error)
{
	int rank, count;
	*r = (ranks){ .count = 1 };
	if (!is_one_of_several())
		return GW_OK;
	GW_TRY(ranks_try(error));
	if (!begin(&rank, &count)) {
		end = NULL;
		return gw_fail(error, GW_ERROR_INTERNAL, "MPI cannot be begun");
	}
	*r = (ranks){ (uint32_t)rank, (uint32_t)count };
	silent = rank > 0;
	if (count > 1)
		signals_expect_haste();
	return GW_OK;
}

gw_status ranks_wait(const ranks *r, gw_error *error)
{
	const struct timespec pause = { .tv_nsec = LOOK_NANOSECONDS };
	while (r->count > 1 && !meet()) {
		nanosleep(&pause, NULL);
		GW_TRY(signals_check(error));
	}
	return GW_OK;
}

gw_status ranks_fail(const ranks *r, gw_status status, gw_error *error)
{
	const struct timespec pause = { .tv_sec = END_SECONDS };
	if (r->rank == 0 || status == GW_OK || status == GW_ERROR_CANCELLED)
		return status;
	/* A signal ends it. */
	nanosleep(&pause, NULL);
	GW_TRY(signals_check(error));
	const gw_error own = *error;
	return gw_fail(error, status, "process %u of %u: %.900s", r->rank + 1, r->count, own.text);
}

bool ranks_speak(void)
{
	return !silent;
}

/* Who was stopped by a signal ends by it: then the others were, or are, by those who started them.
 */
void ranks_end(int code)
{
	bool failed = code != EXIT_CODE_GOOD && code != EXIT_CODE_MISSED;
	if (end && code < EXIT_CODE_SIGNAL)
		end(failed ? code : 0);
}

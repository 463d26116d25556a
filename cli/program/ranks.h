/*
 * ranks.h - a program that runs as several processes, on one machine or on many: the ranks of
 * mpirun, or of srun with its PMIx or PMI.
 */
#ifndef RANKS_H
#define RANKS_H

#include "glowworm.h"

typedef struct ranks {
	uint32_t rank, count; /* of all; 0 and 1 where this process is alone */
} ranks;

/* Meets the other ranks, where this process was started as one of several.
 * GW_ERROR_INTERNAL when the shared object that does it is not there, or MPI cannot be begun. */
gw_status ranks_join(ranks *ranks, gw_error *error);

/* Whether processes could meet: the shared object loads. GW_ERROR_INTERNAL when it does not. */
gw_status ranks_try(gw_error *error);

/* Waits until all ranks are here. It takes next to no processor time. GW_ERROR_CANCELLED. */
gw_status ranks_wait(const ranks *ranks, gw_error *error);

/* What went wrong: one rank says it. Those but the first give the first one five seconds, in
 * which it ends all ranks if the same is wrong there; else they say which rank they are. Returns
 * the status. */
gw_status ranks_fail(const ranks *ranks, gw_status status, gw_error *error);

/* Whether this process is to say that it was stopped: it is the first, or alone. */
bool ranks_speak(void);

/* To be called at the end of the process: when the work failed, by another code than 0, it ends all
 * ranks. A process that is alone goes on. */
void ranks_end(int code);

#endif

/*
 * mpi_ranks.h - what ranks.c takes of MPI: the functions of a shared object by itself, so that the
 * program needs no MPI where it works alone. It uses nothing of the program.
 */
#ifndef MPI_RANKS_H
#define MPI_RANKS_H

#include <stdbool.h>

/* False when MPI cannot be begun. */
typedef bool mpi_ranks_begin_function(int *rank, int *count);
bool mpi_ranks_begin(int *rank, int *count);

/* Waits for all ranks: the first call says that this one is here, and each whether all are. */
typedef bool mpi_ranks_meet_function(void);
bool mpi_ranks_meet(void);

/* Ends MPI; where the code is not 0, all ranks with it. */
typedef void mpi_ranks_end_function(int code);
void mpi_ranks_end(int code);

#endif

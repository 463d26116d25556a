/* mpi_ranks.c - a shared object by itself: several processes by MPI; see mpi_ranks.h. */
#include "program/mpi_ranks.h"

#include <mpi.h>

static MPI_Request meeting = MPI_REQUEST_NULL;
static bool met = true;

bool mpi_ranks_begin(int *rank, int *count)
{
	int level;
	return MPI_Init_thread(NULL, NULL, MPI_THREAD_FUNNELED, &level) == MPI_SUCCESS &&
		   MPI_Comm_rank(MPI_COMM_WORLD, rank) == MPI_SUCCESS &&
		   MPI_Comm_size(MPI_COMM_WORLD, count) == MPI_SUCCESS;
}

bool mpi_ranks_meet(void)
{
	int done = 0;
	if (met)
		MPI_Ibarrier(MPI_COMM_WORLD, &meeting);
	MPI_Test(&meeting, &done, MPI_STATUS_IGNORE);
	met = done != 0;
	return met;
}

void mpi_ranks_end(int code)
{
	if (code != 0)
		MPI_Abort(MPI_COMM_WORLD, code);
	else
		MPI_Finalize();
}

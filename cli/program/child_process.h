/*
 * child_process.h - work that may end its process (a driver that aborts, a library that throws
 * where nothing can catch) is done in a process of its own, which hands back what it found in
 * memory that both see.
 */
#ifndef CHILD_PROCESS_H
#define CHILD_PROCESS_H

#include "glowworm.h"

/* How such a process came to its end. */
typedef struct child_end {
	bool finished;  /* the work returned */
	int code;       /* what it exited with, when it exited by itself */
	int signal;     /* that ended it, or 0 */
	bool timed_out; /* it was killed because it took too long */
	double seconds;
	char said[200]; /* the last line that it wrote to standard error */
} child_end;

/* Memory, filled with zeros, that a process and its children see alike; NULL when there is none. */
void *child_memory_create(size_t bytes);
void child_memory_destroy(void *memory, size_t bytes); /* NULL is accepted */

/*
 * Runs work(user) in a new process and waits for it. There it may do what it likes but print to
 * standard output; signals end it as usual, and no core file is left. Fails when no process can be
 * made, and with GW_ERROR_CANCELLED when this one is asked to stop, which ends the child.
 *   seconds   after which it is killed
 */
gw_status child_run(void (*work)(void *user), void *user, double seconds, child_end *end,
					gw_error *error);

/* A phrase: "ended by SIGABRT after 0.2 s: LLVM ERROR: out of memory". */
void child_end_text(const child_end *end, char *text, size_t size);

#endif

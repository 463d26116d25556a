/*
 * one_processor.h - work that is to be the same by one thread as by many.
 */
#ifndef ONE_PROCESSOR_H
#define ONE_PROCESSOR_H

#include <sched.h>

/* Keeps the process to the first of the processors that it may use; before: receives these, for
 * sched_setaffinity(0, sizeof before, &before). */
void keep_to_one_processor(cpu_set_t *before);

#endif

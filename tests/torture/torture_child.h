/*
 * torture_child.h - runs the program within limits, and says how it ended.
 */
#ifndef TORTURE_CHILD_H
#define TORTURE_CHILD_H

#include "torture_case.h"

#define CHILD_ARGUMENTS 64

typedef struct torture_child {
	const char *argument[CHILD_ARGUMENTS]; /* after the program's name, NULL at the end */
	char text[8192];                       /* what arguments point to, if they were printed */
	size_t text_used, count, setting_count;
	const char *setting[16]; /* NAME=VALUE for the environment, added to ours */
	double limit;            /* seconds until it counts as hanging */
	double kill_after;       /* seconds until it gets kill_signal; 0: never */
	int kill_signal;
	uint64_t file_bytes;    /* longest file that it may write; 0: any */
	uint64_t address_bytes; /* of its address space; 0: any */

	/* how it ended */
	int code;   /* exit status, -1 when a signal ended it */
	int signal; /* 0 when it exited */
	bool hung;
	double seconds;
	double megabytes; /* resident at its most */
	char message[4096];
} torture_child;

void child_start(torture_child *child);

/* Adds one argument, printed. */
void child_add(torture_child *child, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Adds words with blanks between them; an argument with blanks is for child_add. */
void child_add_words(torture_child *child, const char *words);

/* Adds NAME=VALUE to the environment. */
void child_set(torture_child *child, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Runs it in the case's folder; standard output goes to the file `stdout` there. */
void child_run(torture_case *c, torture_child *child);

/* The command as a line for a shell. */
const char *child_line(const torture_child *child);

/*
 * What every run has to hold, whatever it was asked: it ends in time, not by a signal unless we
 * sent it, with a status of the documented ones, with a sentence unless it succeeded, and no
 * temporary file stays. Says the first thing that is wrong, as a failure of the case, and is false.
 *   row    begins the class of the failure
 */
bool child_check(torture_case *c, const torture_child *child, const char *row);

/* The number of files in the folder whose name ends so. */
int child_count_files(const torture_case *c, const char *end);

/* The bytes of a file of the folder; NULL when it is not there. Freed by the caller. */
unsigned char *child_read_file(const torture_case *c, const char *name, size_t *length);

/* Writes one; ends the campaign when it can't. */
void child_write_file(const torture_case *c, const char *name, const void *bytes, size_t length);

/* Two files of points or pictures are the same but for the line that names the command. */
bool child_same_files(const torture_case *c, const char *a, const char *b);

#endif

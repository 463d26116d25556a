/*
 * exit_code.h - what the process ends with; the numbers are those of sysexits.h where it has them.
 */
#ifndef EXIT_CODE_H
#define EXIT_CODE_H

#include "files/file_status.h"

#include <stdio.h>

/* All went well, but the result is not as good as asked: a gw_status of the program's own. */
#define STATUS_MISSED ((gw_status)FILE_STATUS_NEXT)

typedef enum exit_code {
	EXIT_CODE_GOOD = 0,
	EXIT_CODE_MISSED = 1,
	EXIT_CODE_USAGE = 2,
	EXIT_CODE_DATA = 65,
	EXIT_CODE_NO_INPUT = 66,
	EXIT_CODE_NO_DEVICE = 69,
	EXIT_CODE_INTERNAL = 70,
	EXIT_CODE_MEMORY = 71,
	EXIT_CODE_CREATE = 73,
	EXIT_CODE_IO = 74,
	EXIT_CODE_SIGNAL = 128, /* plus the number of the signal */
} exit_code;

/* The exit code for a status; signal: the one that asked to stop, or 0. Thread-safe. */
int exit_code_of(gw_status status, int signal);

/* Hands all that was printed to the system. FILE_ERROR_IO when some of it has not arrived, now or
 * earlier: a full disk or a closed pipe is a failure. Of a closed pipe the error's text is empty:
 * who reads the beginning (`| head`) knows what is missing. */
gw_status exit_code_flush(FILE *printed, gw_error *error);

/* What each code means, for the manual: the i-th code, or -1 behind the last one. */
int exit_code_describe(int i, const char **meaning);

#endif

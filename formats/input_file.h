/*
 * input_file.h - a whole input as bytes in memory.
 *
 * A regular file is mapped, so that only the parts that are read take memory; a pipe or standard
 * input is read to its end. Readers take (data, length) and never touch a byte outside of it.
 *
 * A mapped file that another program cuts shorter while it is being read ends the process with
 * SIGBUS, as with every program that maps files.
 */
#ifndef INPUT_FILE_H
#define INPUT_FILE_H

#include "glowworm.h"

/* How the bytes are held, and so how they are given back. */
typedef enum input_file_storage {
	INPUT_FILE_BORROWED, /* belong to somebody else; a zeroed struct is such a one */
	INPUT_FILE_HEAP,
	INPUT_FILE_MAPPED,
} input_file_storage;

typedef struct input_file {
	const char *name;    /* for messages: the path, or "standard input" */
	const uint8_t *data; /* length bytes, read-only; not NULL after input_file_open */
	size_t length;       /* bytes */
	input_file_storage storage;
	const char *columns; /* what the caller says the columns of a table are, with commas; or NULL */
	uint32_t threads;    /* for reading; 0 means one a processor */
	char *owned_name;    /* NULL when the name belongs to somebody else */
} input_file;

/*
 * Opens a file and makes its content available.
 *
 *   in      filled on success, to be given back with input_file_close; zeroed on failure
 *   path    of a file, pipe or device; "-" is standard input, which is read but not closed
 *   error   GW_ERROR_NO_INPUT when it cannot be opened or is a directory, GW_ERROR_IO when reading
 *           fails, GW_ERROR_MEMORY when a pipe brings more than this machine's memory holds,
 *           GW_ERROR_CANCELLED when a signal interrupted the reading of a pipe
 *
 * Thread-safety: calls on different structs may run at the same time.
 */
gw_status input_file_open(input_file *in, const char *path, gw_error *error);

/*
 * Says that the bytes [begin, end) of the input will not be needed soon, so that what of them was
 * mapped no longer takes memory. They stay readable, at the price of being fetched again; pages
 * that hold other bytes too are kept. Thread-safe.
 */
void input_file_release(const input_file *in, const void *begin, const void *end);

/* Gives back what input_file_open took and zeroes *in. A zeroed struct is accepted. */
void input_file_close(input_file *in);

#endif

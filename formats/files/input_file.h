/*
 * input_file.h - a whole input as bytes in memory.
 *
 * A file is copied into memory, so that it may change or vanish afterwards. One that is large
 * beside the free memory is mapped instead: only the parts that are read take memory. A pipe or
 * standard input is read to its end. Readers take (data, length) and never touch a byte outside.
 *
 * Pages of a mapped file that cannot be read, because the disk fails or the file was cut shorter,
 * raise SIGBUS. A program's handler hands the address to input_file_lost_page and goes on: readers
 * see zeros, and input_file_check says afterwards that what was read is worth nothing.
 */
#ifndef INPUT_FILE_H
#define INPUT_FILE_H

#include "files/file_status.h"

#include <time.h>

/* How the bytes are held, and so how they are given back. */
typedef enum input_file_storage {
	INPUT_FILE_BORROWED, /* belong to somebody else; a zeroed struct is such a one */
	INPUT_FILE_HEAP,
	INPUT_FILE_COPIED, /* in pages of memory */
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
	uint64_t most;       /* bytes that a stream may bring; 0: as memory allows */

	struct mapped_range *range; /* of a mapped file, as are the next two */
	int descriptor;
	struct timespec modified; /* when the file was opened */
} input_file;

/*
 * Opens a file and makes its content available.
 *
 *   in      filled on success, to be given back with input_file_close; zeroed on failure
 *   path    of a file, pipe or device; "-" is standard input, which is read but not closed
 *   error   FILE_ERROR_NO_INPUT when it cannot be opened or is a directory, FILE_ERROR_IO when
 *           reading fails or the file changes meanwhile, GW_ERROR_MEMORY when a pipe or device
 * brings more than half of the free memory holds, GW_ERROR_CANCELLED when a signal interrupted it
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

/* The same for bytes that nobody will look at again: those of a copy are gone. */
void input_file_discard(const input_file *in, const void *begin, const void *end);

/*
 * The same with limits of the caller's.
 *   copied  bytes of the largest file that is copied; UINT64_MAX: of any, for bytes that are used
 *           for long and by threads that are not ours, on which a handler cannot run
 *   most    bytes that a pipe or device may bring; 0: half of the free memory
 */
gw_status input_file_open_as(input_file *in, const char *path, uint64_t copied, uint64_t most,
							 gw_error *error);

/*
 * To be called when a reader is done, whether it succeeded or not: hands the status back, or fails
 * with FILE_ERROR_IO when the file was cut short, changed or could not be read meanwhile.
 */
gw_status input_file_check(const input_file *in, gw_status status, gw_error *error);

/*
 * For a handler of SIGBUS: true when the address lies in an input whose bytes there cannot be read.
 * They are zeros from then on, and the access may be tried again. Async-signal-safe.
 */
bool input_file_lost_page(const void *address);

/* Gives back what input_file_open took and zeroes *in. A zeroed struct is accepted. Bytes that a
 * driver may still read are not given back (gw_lent_memory_is_kept). */
void input_file_close(input_file *in);

#endif

/*
 * fuzz_reader.h - every reader of the program by its name, and one attempt to read arbitrary bytes.
 */
#ifndef FUZZ_READER_H
#define FUZZ_READER_H

#include "seed_files.h"

typedef struct fuzz_reader {
	const char *name;
	seed_reader read;
	bool sealed; /* the bytes are put into E57's pages with their checksums first */
} fuzz_reader;

/* The readers of the table of formats, then those of maps, meshes and luminaires; false behind the
 * last. */
bool fuzz_reader_at(size_t index, fuzz_reader *reader);

/* The one of that name; false when there is none. */
bool fuzz_reader_find(const char *name, fuzz_reader *reader);

/*
 * Reads bytes, in memory of exactly their length, and uses every value of the result, so that a
 * sanitizer sees a byte too many or too few.
 *   complaint   receives a sentence when the reader refused without an empty result or without
 *               naming the file; "" when all was well
 * Returns what the reader returned.
 */
gw_status fuzz_reader_attempt(const fuzz_reader *reader, const uint8_t *data, size_t length,
							  char complaint[GW_ERROR_TEXT]);

#endif

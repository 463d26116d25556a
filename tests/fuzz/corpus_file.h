/*
 * corpus_file.h - many small inputs in one file: for each its length in 4 bytes, lowest first, and
 * its bytes. Such a file is NAME.corpus in this folder, for the reader of that name.
 */
#ifndef CORPUS_FILE_H
#define CORPUS_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct corpus {
	uint8_t *bytes; /* owned */
	size_t length;
	size_t next; /* where the next input begins */
} corpus;

/* Loads a whole file; a corpus that does not exist is an empty one. False when reading fails. */
bool corpus_open(corpus *c, const char *path);

/* The next input, which lies in the corpus; false behind the last. */
bool corpus_next(corpus *c, const uint8_t **data, size_t *length);

void corpus_close(corpus *c);

#endif

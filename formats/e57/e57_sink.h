/*
 * e57_sink.h - bytes of an E57 file in pages with their checksums, one after the other.
 */
#ifndef E57_SINK_H
#define E57_SINK_H

#include "e57/e57_pages.h"
#include "files/output_file.h"

typedef struct e57_sink {
	output_file *out;
	uint8_t page[E57_PAGE];
	size_t used;    /* bytes of the page */
	uint8_t *first; /* receives the first page, E57_PAGE bytes; NULL: nobody wants it */
} e57_sink;

/* Puts a page's checksum behind its content. */
void e57_sink_seal(uint8_t page[E57_PAGE]);

/* Appends bytes. A failure is latched, and told by e57_sink_end. */
void e57_sink_put(e57_sink *sink, const void *bytes, size_t length);

/* Appends an unsigned number of `size` bytes, lowest first. */
void e57_sink_number(e57_sink *sink, uint64_t value, size_t size);

/* Fills the last page with zeros, and hands on what failed. FILE_ERROR_IO. */
gw_status e57_sink_end(e57_sink *sink, gw_error *error);

/* From an offset among the bytes to one in the file, where checksums are between them. */
uint64_t e57_sink_place(uint64_t at);

/* How long a file of so many bytes is. */
uint64_t e57_sink_length(uint64_t bytes);

#endif

/*
 * laz_output.h - a LAZ file as it is written: head, chunks as points come, and the table of them,
 * of which the place is said before the chunks when they are all there.
 */
#ifndef LAZ_OUTPUT_H
#define LAZ_OUTPUT_H

#include "files/output_file.h"
#include "las/laz_chunks.h"

typedef struct laz_output {
	output_file *out;
	laz_chunks chunks;    /* all so far, whose bytes are written */
	uint8_t *pending;     /* owned: records of a chunk that is not full */
	size_t pending_count; /* of these */
	uint64_t place, at;   /* in the file: what says where the table is; bytes so far */
} laz_output;

/* Writes all that stands before the chunks. Zeros begin an output; it is to be given back with
 * laz_output_clear, also on failure. out: has a temporary file */
gw_status laz_output_begin(laz_output *o, const las_records *records, output_file *out,
						   gw_error *error);

/* Adds points, compressed on as many threads as the output has: some chunks of each of them at a
 * time. Chunks are the same however points are split. */
gw_status laz_output_add(laz_output *o, const las_records *records, gw_error *error);

/* Writes what is left. */
gw_status laz_output_end(laz_output *o, gw_error *error);

/* All of it to an output that bytes can only be appended to: memory holds all chunks. */
gw_status laz_output_append(laz_output *o, const las_records *records, output_file *out,
							gw_error *error);

void laz_output_clear(laz_output *o);

#endif

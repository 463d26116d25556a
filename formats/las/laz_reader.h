/*
 * laz_reader.h - LAZ, the compressed form of LAS: from compressed chunks to points as LAS has them.
 *
 * Compressors 1 (one stream), 2 (chunks) and 3 (chunks in layers); chunks of one size or of many,
 * so COPC too. LASzip specification: a VLR says which items a point has and how they are coded; a
 * table at the end says where chunks lie.
 */
#ifndef LAZ_READER_H
#define LAZ_READER_H

#include "las/las_header.h"
#include "points/format.h"

typedef struct laz_stream laz_stream;

/*
 * Takes points as they come out, on several threads at once, each point once.
 *   first    number of the first one in the file
 *   record   count records of las_header.record bytes
 */
typedef void laz_sink(void *user, size_t first, size_t count, const uint8_t *records);

/*
 * Reads how the points are compressed and where, and checks that header and chunks agree, before
 * anything is allocated for the points.
 *   stream   to be given back with laz_close; NULL on failure
 *   in, header   must live as long
 *   error    GW_ERROR_DATA with file, place and reason; GW_ERROR_MEMORY
 */
gw_status laz_open(laz_stream **stream, const input_file *in, const las_header *header,
				   gw_error *error);

/* Decodes some of the points, for which the chunks that they lie in are decoded from their
 * beginning. Errors: as above; the one of the first bad chunk, whatever the threads. */
gw_status laz_decode(laz_stream *stream, const format_rows *rows, laz_sink *sink, void *user,
					 gw_error *error);

/* How many points a chunk has; 1 where they have different numbers. */
uint64_t laz_chunk_points(const laz_stream *stream);

void laz_close(laz_stream **stream);

#endif

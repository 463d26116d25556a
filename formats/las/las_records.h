/*
 * las_records.h - the points of a scan as LAS has them: of which format, which column in which
 * field, on which grid.
 */
#ifndef LAS_RECORDS_H
#define LAS_RECORDS_H

#include "las/las_survey.h"

/* What a record or the content of a VLR has at most. */
#define LAS_LENGTH_MAX ((size_t)UINT16_MAX)

typedef struct las_records {
	const char *name; /* of the file, for messages */
	const scan *cloud;
	const uint8_t *made;   /* NULL, or all records, of layout.bytes; then there is no cloud */
	size_t count;          /* records */
	uint64_t total;        /* points of the file, and of them */
	uint64_t returned[15]; /* those with each return number */
	const size_t *order;   /* which point of the cloud each is, or NULL: as they are there */
	unsigned format;
	las_grid grid[3];
	las_layout layout;
	size_t own;                 /* fields of the format; behind them extra ones */
	const scan_column **column; /* owned; of each field, NULL: zeros */
	scan_color color;
	bool colored, returns; /* the scan has colours, return numbers */
	bool preview; /* colours are bytes and not what points reflect, which has columns of its
					 own: bytes become multiples of 256, as the LAS standard has it, of which
					 LAZ makes half as many bytes as of multiples of 257 */
	bool legacy;  /* it came from an old format, and is written in a new one */
} las_records;

/*
 * Finds a place for every column; las_format.h says how.
 *   records      to be given back with las_records_clear, also on failure
 *   cloud, name  must live as long
 *   newer        only formats 6 to 8
 *   error        GW_ERROR_DATA when LAS cannot hold the scan; GW_ERROR_MEMORY
 */
gw_status las_records_make(las_records *records, const scan *cloud, const char *name, bool newer,
						   gw_error *error);

/* The same for points that are a part of those that were surveyed. */
gw_status las_records_of_part(las_records *records, const las_survey *survey, const scan *part,
							  bool newer, gw_error *error);

/* Writes points [first, first + count), each of records->layout.bytes. Several threads may. */
void las_records_put(const las_records *records, size_t first, size_t count, uint8_t *bytes);

void las_records_clear(las_records *records);

#endif

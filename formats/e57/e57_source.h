/*
 * e57_source.h - the records of one scan of an E57 file, from the first to the last.
 *
 * Packets hold some bytes of each field, and not of the same records: a field's bytes wait until
 * those of all others are there.
 */
#ifndef E57_SOURCE_H
#define E57_SOURCE_H

#include "e57/e57_description.h"

/* Bytes of a field that were read from packets; 16 more have room behind them. */
typedef struct e57_waiting {
	uint8_t *bytes; /* owned */
	size_t length, room;
	unsigned skip; /* bits of the first byte that are of records before */
} e57_waiting;

typedef struct e57_source {
	const e57_pages *pages;
	const e57_scan *scan;
	size_t index;         /* of the scan in the file, for messages */
	size_t next, end;     /* of its packets, in the pages */
	uint64_t *bytes;      /* owned; of each field in all packets */
	e57_waiting *waiting; /* owned; of each field, from the first record that is held */
	uint8_t *packet;      /* owned; room for one */
	uint64_t taken;       /* records, those that are held included */
	size_t held;          /* that can be unpacked */
} e57_source;

/*
 * Finds the packets of a scan, and whether all fields have the bytes that so many records take.
 *   source   to be given back with e57_source_clear, also on failure; pages and scan live as long
 *   error    GW_ERROR_DATA with file and scan; GW_ERROR_MEMORY
 */
gw_status e57_source_open(e57_source *source, const e57_pages *pages, const e57_scan *scan,
						  size_t index, gw_error *error);

/* Goes on to the next records, as many as are wanted or left: source->held. GW_ERROR_MEMORY. */
gw_status e57_source_take(e57_source *source, size_t wanted, gw_error *error);

/* Unpacks a field of all that are held, on so many threads. */
void e57_source_unpack(const e57_source *source, size_t field, uint32_t threads, double *to);

void e57_source_clear(e57_source *source);

/* Fails with what is wrong with a scan. */
gw_status e57_source_fail(const e57_pages *pages, size_t index, const char *what, gw_error *error);

#endif

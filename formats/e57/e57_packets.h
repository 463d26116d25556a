/*
 * e57_packets.h - the bytes of an E57 file from its first to its last: header, packets of records
 * of each scan, description.
 */
#ifndef E57_PACKETS_H
#define E57_PACKETS_H

#include "e57/e57_records.h"
#include "e57/e57_sink.h"
#include "files/checksum.h"

typedef struct e57_packets {
	e57_sink sink;
	checksum sum;     /* of all values so far, by which files have names */
	uint8_t *stretch; /* owned; values of a field in a packet */
} e57_packets;

/* Records of a packet: rows, or NULL and the points of a cloud. */
typedef struct e57_packet {
	const e57_layout *layout;
	const uint8_t *rows;
	size_t first, count;
} e57_packet;

/* Zeros begin; to be given back with e57_packets_clear, also on failure. GW_ERROR_MEMORY. */
gw_status e57_packets_begin(e57_packets *p, output_file *out, gw_error *error);

/* What stands before the scans, with the length of the description, 0 if it is not known; and
 * before the packets of each. */
void e57_packets_header(e57_packets *p, const e57_layout *layout, size_t text_length);
void e57_packets_section(e57_packets *p, const e57_out_scan *s);

void e57_packets_put(e57_packets *p, const e57_out_scan *s, const e57_packet *packet);

/* Writes the description, and hands on what failed. *length receives how long it is. */
gw_status e57_packets_end(e57_packets *p, const e57_layout *layout, size_t *length,
						  gw_error *error);

void e57_packets_clear(e57_packets *p);

#endif

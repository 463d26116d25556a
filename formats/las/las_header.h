/*
 * las_header.h - what stands before the points of a LAS or LAZ file: the public header block and
 * the variable-length records (VLR).
 *
 * What a scan has no place for, and what a LAS file written from it needs again, becomes comments
 * of the scan that begin with "las " (las_notes.h). ASPRS LAS specification 1.0 to 1.5.
 */
#ifndef LAS_HEADER_H
#define LAS_HEADER_H

#include "files/input_file.h"
#include "points/scan.h"

#define LAS_HEADER_BYTES 227     /* versions 1.0 to 1.2 */
#define LAS_HEADER_BYTES_1_4 375 /* 1.4; 1.5 adds to it */
#define LAS_VLR_BYTES 54         /* what precedes the content of a VLR */
#define LAS_FORMATS 11           /* point data record formats 0 to 10 */

/* The content of a VLR, in the file's memory; zeroed when the file has none. */
typedef struct las_vlr {
	const uint8_t *data;
	size_t length;
} las_vlr;

typedef struct las_header {
	unsigned minor;    /* of version 1.minor */
	uint16_t encoding; /* global encoding bits */
	unsigned format;   /* point data record format, 0 to 10 */
	bool compressed;   /* the points are LAZ */
	size_t record;     /* bytes of a point, at least those of its format */
	uint64_t count;    /* points; not yet compared with the bytes that are there */
	size_t points;     /* offset of the first point, within the file */
	double scale[3], offset[3];
	double minimum[3], maximum[3]; /* bounds as the header claims them */
	las_vlr extra;                 /* extra bytes: descriptions of 192 bytes */
	las_vlr laszip;                /* how LAZ points are compressed */
	las_vlr text;                  /* lines: comments, and names of columns (LAS_COLUMN_LINE) */
} las_header;

/*
 * Parses header and VLRs.
 *   header    filled on success; its VLRs lead into in->data
 *   notes     receives comments
 *   error     GW_ERROR_DATA with file, place and what is wrong; GW_ERROR_MEMORY
 */
gw_status las_header_parse(las_header *header, const input_file *in, scan *notes, gw_error *error);

/* Bytes of a point of a format without extra bytes. format: below LAS_FORMATS */
size_t las_format_bytes(unsigned format);

#endif

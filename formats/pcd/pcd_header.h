/*
 * pcd_header.h - the text at the start of a PCD file.
 */
#ifndef PCD_HEADER_H
#define PCD_HEADER_H

#include "files/input_file.h"
#include "points/scan.h"

/* More values than this in a point are no point cloud. */
#define PCD_VALUES 4096

typedef enum pcd_encoding { PCD_ASCII, PCD_BINARY, PCD_COMPRESSED } pcd_encoding;

typedef struct pcd_field {
	char *name;   /* owned */
	size_t size;  /* bytes of a value: 1, 2, 4 or 8 */
	char type;    /* I, U or F */
	size_t count; /* values of a point, at least 1 */
} pcd_field;

typedef struct pcd_header {
	pcd_encoding encoding;
	pcd_field *field; /* owned */
	size_t field_count;
	size_t values;   /* of a point */
	size_t stride;   /* bytes of a point in a binary body */
	uint64_t points; /* as the header has it */
	uint64_t width, height;
	double viewpoint[7]; /* position, then quaternion w x y z; 0 0 0 1 0 0 0 by default */
	size_t lines;        /* of the header */
	size_t body;         /* offset of the first byte after the header */
} pcd_header;

/*
 * Parses the header.
 *   header    filled on success, to be given back with pcd_header_clear; empty on failure
 *   comments  receives comments but for the usual first one
 *   error     GW_ERROR_DATA with file, line and what was expected; GW_ERROR_MEMORY
 */
gw_status pcd_header_parse(pcd_header *header, const input_file *in, scan *comments,
						   gw_error *error);
void pcd_header_clear(pcd_header *header);

#endif

/*
 * ply_header.h - the text at the start of a PLY file: what elements follow, with what properties.
 */
#ifndef PLY_HEADER_H
#define PLY_HEADER_H

#include "files/input_file.h"
#include "points/scan.h"

/* More than this is no header of a point cloud, and would only cost time. */
#define PLY_HEADER_BYTES ((size_t)1 << 20)
#define PLY_PROPERTIES 4096

/* Comments that came as obj_info lines start with this; the writer makes obj_info lines of them. */
#define PLY_OBJ_INFO "obj_info "

typedef enum ply_encoding { PLY_ASCII, PLY_LITTLE_ENDIAN, PLY_BIG_ENDIAN } ply_encoding;

typedef struct ply_property {
	char *name; /* owned */
	scan_type type;
	bool list;            /* a count and then that many values */
	scan_type count_type; /* of a list: an integer type */
} ply_property;

typedef struct ply_element {
	char *name; /* owned */
	uint64_t count;
	ply_property *property; /* owned */
	size_t property_count;
} ply_element;

typedef struct ply_header {
	ply_encoding encoding;
	ply_element *element; /* owned, in the order of the body */
	size_t element_count;
	size_t vertex; /* index of the element "vertex" */
	size_t lines;  /* of the header, with end_header */
	size_t body;   /* offset of the first byte after the header */
} ply_header;

/*
 * Parses the header. Lines may end in LF, CRLF or a bare CR, and have any white space between
 * words. header    filled on success, to be given back with ply_header_clear; empty on failure
 *   comments  receives the comment and obj_info lines
 *   error     GW_ERROR_DATA with file, line and what was expected; GW_ERROR_MEMORY
 */
gw_status ply_header_parse(ply_header *header, const input_file *in, scan *comments,
						   gw_error *error);
void ply_header_clear(ply_header *header);

/* PLY's name of a type: char uchar short ushort int uint float double. */
const char *ply_type_name(scan_type type);

#endif

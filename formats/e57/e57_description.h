/*
 * e57_description.h - the XML text in an E57 file: which scans it has, where, with what fields.
 */
#ifndef E57_DESCRIPTION_H
#define E57_DESCRIPTION_H

#include "e57/e57_pages.h"

/* More fields than this in a record are no point cloud. */
#define E57_FIELDS 1024

typedef enum e57_type { E57_INTEGER, E57_SCALED, E57_SINGLE, E57_DOUBLE, E57_STRING } e57_type;

typedef struct e57_field {
	char *name;   /* owned; as in the file */
	char *column; /* owned; the name of the column, of fields of our extension, else NULL */
	e57_type type;
	int64_t minimum, maximum; /* of integers as they are stored */
	double scale, offset;     /* of scaled ones */
	unsigned bits;            /* of a value as it is stored; 0: always the minimum */
} e57_field;

typedef struct e57_scan {
	e57_field *field; /* owned */
	size_t field_count;
	uint64_t offset;    /* in the file, of the section with the records */
	uint64_t count;     /* of records */
	double rotation[4]; /* quaternion w x y z */
	double translation[3];
	bool has_pose;
} e57_scan;

typedef struct e57_description {
	e57_scan *scan; /* owned */
	size_t scan_count;
	char **comment; /* owned, each and the list; comment_count, of our extension */
	size_t comment_count;
} e57_description;

/*
 * Parses the description.
 *   description  on success to be given back with e57_description_clear; empty on failure
 *   error        GW_ERROR_DATA with file and line of the description; GW_ERROR_MEMORY
 */
gw_status e57_description_parse(e57_description *description, const e57_pages *pages,
								const input_file *in, gw_error *error);
void e57_description_clear(e57_description *description);

#endif

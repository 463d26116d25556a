/*
 * las_fields.h - where in a LAS point its values stand, and as what columns they come.
 *
 * A point is a record of bytes: the fields of one of eleven formats, and behind them extra bytes
 * that a VLR describes. Reader and writer work from the same table of fields.
 */
#ifndef LAS_FIELDS_H
#define LAS_FIELDS_H

#include "las/las_header.h"

/* Types of values, numbered as in descriptions of extra bytes. */
typedef enum las_kind {
	LAS_UINT8 = 1,
	LAS_INT8,
	LAS_UINT16,
	LAS_INT16,
	LAS_UINT32,
	LAS_INT32,
	LAS_UINT64,
	LAS_INT64,
	LAS_FLOAT32,
	LAS_FLOAT64,
	LAS_KIND_COUNT
} las_kind;

#define LAS_EXTRA_BYTES 192 /* length of the description of one extra value */
#define LAS_EXTRA_NAME 32   /* of which this is for the name, without a zero if it is full */
#define LAS_COLUMN_NAME 256 /* for that of a column, with a zero */

typedef struct las_field {
	char name[LAS_COLUMN_NAME]; /* of the column */
	las_kind kind;
	size_t place;  /* byte in the record */
	uint8_t shift; /* of a part of a byte: its lowest bit */
	uint8_t bits;  /* and their number; 0 for whole values */
	bool optional; /* no column when all points have 0 here */
	bool scaled;   /* value = stored * scale + offset, in double */
	double scale, offset;
	char standard[24]; /* of an extra value called like a field of the format: that name, which it
						  takes when the field is 0 everywhere */
} las_field;

typedef struct las_layout {
	las_field *field; /* owned */
	size_t count;
	size_t bytes; /* of the record that fields take */
} las_layout;

/* Makes the table of a format's own fields, x y z first; on success to be given back with
 * las_layout_clear. scale, offset: 3 each */
gw_status las_layout_make(las_layout *layout, unsigned format, const double *scale,
						  const double *offset, gw_error *error);

/* Adds a field; layout->bytes grows to its end. */
gw_status las_layout_add(las_layout *layout, const las_field *field, gw_error *error);

/* Adds the extra bytes of a file; notes: what of them is left out. On failure the layout is still
 * to be given back. */
gw_status las_layout_add_extra(las_layout *layout, const las_header *header, scan *notes,
							   gw_error *error);

void las_layout_clear(las_layout *layout);

/* Red, green or blue. */
bool las_field_is_color(const char *name);

/* Bytes of a value. */
size_t las_kind_size(las_kind kind);

/* The column's type. Integers of 64 bits lie in a column of doubles, at first as the bits that they
 * are. */
scan_type las_field_type(const las_field *field);

#endif

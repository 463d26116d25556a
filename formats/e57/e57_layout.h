/*
 * e57_layout.h - how a cloud becomes scans of an E57 file: which points are whose, what fields
 * their records have, and where in the file they stand; all known before the first byte is written.
 */
#ifndef E57_LAYOUT_H
#define E57_LAYOUT_H

#include "e57/e57_description.h"
#include "points/scan.h"

/* Where more scanners stood than this, as of a way through the air, all points are one scan. */
#define E57_SCANS_MOST 4096

/* What the values of a field are. */
typedef enum e57_source {
	E57_OF_COLUMN,
	E57_OF_POSITION, /* of the column, less where the scanner stood */
	E57_OF_STATE,    /* 2 where a position is not finite, which is 0 then */
	E57_OF_ROW,      /* by the cell of a range image */
	E57_OF_CELL_COLUMN,
} e57_source;

typedef struct e57_out_field {
	e57_field field; /* its name, type, limits and bits */
	e57_source source;
	const scan_column *column; /* NULL for those of no column */
	int axis;                  /* of E57_OF_POSITION */
	double low, high;          /* of finite values; low above high where there are none */
} e57_out_field;

typedef struct e57_out_scan {
	size_t first, count;         /* of its points, in their order */
	const double *place;         /* where its scanner stood, or NULL */
	const gw_range_image *image; /* that all of it belongs to, or NULL */
	e57_out_field *field;        /* owned; field_count */
	size_t field_count;
	size_t packet;   /* records of a packet */
	uint64_t at;     /* where its section begins, without checksums */
	uint64_t length; /* of the section */
} e57_out_scan;

typedef struct e57_layout {
	const scan *cloud;
	size_t *order;      /* owned; points, scan after scan; NULL: as they are */
	e57_out_scan *scan; /* owned; scan_count */
	size_t scan_count;
	uint64_t length; /* of header and sections */
} e57_layout;

/* What is known of all points before a part of them is laid out. */
typedef struct e57_column_limits {
	char *name; /* owned by who made it */
	scan_type type;
	double low, high;
} e57_column_limits;

typedef struct e57_known {
	const e57_column_limits *column; /* those of whole numbers */
	size_t column_count;
	uint64_t count; /* points */
	bool finite;    /* all positions are */
} e57_known;

/* Number of the i-th point of a scan. */
static inline size_t e57_layout_point(const e57_layout *layout, const e57_out_scan *s, size_t i)
{
	return layout->order ? layout->order[s->first + i] : s->first + i;
}

/* A coordinate as it is written: what added to the scanner's place gives it again to the last bit,
 * if anything does. */
double e57_layout_local(double value, double place);

/*
 * Lays a cloud out.
 *   name     of the file, for messages
 *   layout   to be freed with e57_layout_clear, also on failure; the cloud has to live as long
 *   error    GW_ERROR_DATA where a record would be too long; GW_ERROR_MEMORY
 */
gw_status e57_layout_make(const scan *cloud, const char *name, e57_layout *layout, gw_error *error);
void e57_layout_clear(e57_layout *layout);

/* The same for a part of a cloud that is one scan: as all of it is laid out, but that floats have
 * no limits yet, and integers of which nothing is known those of their type. */
gw_status e57_layout_of_part(const scan *part, const e57_known *known, const char *name,
							 e57_layout *layout, gw_error *error);

/* Whether a point of a scan has a position. */
bool e57_layout_is_finite(const e57_out_scan *s, size_t p);

/* Bytes of a packet of so many records, and of what stands before its values. */
size_t e57_layout_packet(const e57_out_scan *s, size_t records);
size_t e57_layout_packet_head(const e57_out_scan *s);
/* Bytes of a field's values of so many records. */
size_t e57_layout_stretch(const e57_out_field *field, size_t records);

#define E57_SECTION_HEAD 32 /* bytes before the packets of a scan */

#endif

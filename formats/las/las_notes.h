/*
 * las_notes.h - the comments in which a scan carries what only LAS knows.
 *
 * "las scale 0.01 0.01 0.01" and "las offset 0 0 0" are the grid on which the coordinates lie;
 * "las file ENCODING SOURCE DAY YEAR" four numbers of the header; "las system NAME" and "las
 * software NAME" its two texts; "las wkt TEXT", continued by "las wkt+ TEXT", the coordinate
 * system; "las geokeys NUMBERS", "las geodoubles NUMBERS" and "las geotext TEXT" the same in older
 * files (GeoTIFF). They go through PLY as comments, so that LAS can be written again from it.
 */
#ifndef LAS_NOTES_H
#define LAS_NOTES_H

#include "points/scan.h"

#define LAS_NOTE "las "

/* The longest text in one comment: some readers of PLY take lines of 1024 bytes at most. */
#define LAS_NOTE_TEXT 800

/* As bits the classes of low and of high noise; the latter is for other use in old formats. */
#define LAS_LOW_NOISE (1u << 7)
#define LAS_HIGH_NOISE (1u << LAS_CLASS_HIGH_NOISE)

/* Of the latter, and of points where flight lines overlap in old formats; new ones have a flag for
 * these, and no such class. */
#define LAS_CLASS_HIGH_NOISE 18
#define LAS_CLASS_OVERLAP 12

/* Begins a line of the text record that gives an extra value its whole name, where the 32 bytes
 * that LAS has for it cut that short: "glowworm column CUT = WHOLE". */
#define LAS_COLUMN_LINE "glowworm column "
#define LAS_COLUMN_IS " = "

#define LAS_USER_SPEC "LASF_Spec"
#define LAS_USER_CRS "LASF_Projection"
#define LAS_USER_LASZIP "laszip encoded"
#define LAS_USER_COPC "copc"

enum las_vlr_id {
	LAS_VLR_TEXT = 3,        /* of LASF_Spec: text area description */
	LAS_VLR_EXTRA = 4,       /* of LASF_Spec: extra bytes */
	LAS_VLR_WKT_MATH = 2111, /* of LASF_Projection, as those below */
	LAS_VLR_WKT = 2112,
	LAS_VLR_GEO_KEYS = 34735,
	LAS_VLR_GEO_DOUBLES = 34736,
	LAS_VLR_GEO_TEXT = 34737,
	LAS_VLR_LASZIP = 22204,   /* of LAS_USER_LASZIP */
	LAS_VLR_COPC_INFO = 1,    /* of LAS_USER_COPC */
	LAS_VLR_COPC_TREE = 1000, /* of LAS_USER_COPC, extended */
};

/* Adds a comment that begins with SCAN_NOTE. */
gw_status las_note(scan *cloud, gw_error *error, const char *format, ...)
	__attribute__((format(printf, 3, 4)));

/* Adds "las KEY a b c". count: at most 16 */
gw_status las_note_numbers(scan *cloud, const char *key, const double *value, size_t count,
						   gw_error *error);

/* Adds "las KEY TEXT" and, when the text is long, "las KEY+ TEXT" for its further parts. What is
 * not printable becomes a blank. */
gw_status las_note_text(scan *cloud, const char *key, const char *text, size_t length,
						gw_error *error);

/* The text behind "las KEY " of a comment, or NULL when it is another comment. */
const char *las_note_find(const char *comment, const char *key);

/* Reads the numbers behind "las KEY " of a comment. Returns how many there were, at most capacity;
 * 0 when it is another comment. */
size_t las_note_read(const char *comment, const char *key, double *value, size_t capacity);

/* Puts the parts of the first text with that key together again. *text is the caller's, for
 * free(), and NULL when there is none. */
gw_status las_note_join(const scan *cloud, const char *key, char **text, gw_error *error);

/* Whether a scan has the columns of formats 0 to 5 of LAS, from which it came. */
bool las_note_legacy(const scan *cloud);

/* The noise_classes of a scan that came from LAS by way of another format; 0 of any other. */
unsigned las_note_noise(const scan *cloud);

#endif

/*
 * lit_notes.h - what a lit file says of its light: by which lamps it is, of which it has columns,
 * its unit, the exposure of its preview, how wrong it is said to be, and how it was mixed.
 */
#ifndef LIT_NOTES_H
#define LIT_NOTES_H

#include "points/scan.h"

typedef struct lit_note {
	const char *key; /* "lit_by", "lamps", "unit", "exposure", "error", "mixed" */
	char *text;      /* owned; one lamp as --light takes it, names of lamps, an EV... */
} lit_note;

typedef struct lit_notes {
	lit_note *note; /* owned; count, those of one key behind each other */
	size_t count;
} lit_notes;

/*
 * Reads them from comments and names of columns, which may be anybody's.
 *   notes   on success freed with lit_notes_clear; without any where the cloud is not lit
 * GW_ERROR_MEMORY.
 */
gw_status lit_notes_find(const scan *cloud, lit_notes *notes, gw_error *error);
void lit_notes_clear(lit_notes *notes);

#endif

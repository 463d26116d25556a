/*
 * e57_records.h - the records of a scan that is written: values of a field behind each other, as
 * packets have them, or all values of a record, as long as it waits for its packet.
 */
#ifndef E57_RECORDS_H
#define E57_RECORDS_H

#include "e57/e57_layout.h"

/* Writes a field's values of records first .. first + count - 1, e57_layout_stretch bytes. */
void e57_records_stretch(const e57_layout *layout, const e57_out_scan *s, const e57_out_field *f,
						 size_t first, size_t count, uint8_t *to);

/* Bytes of a record as a row: each value in bytes of its own. */
size_t e57_records_row(const e57_out_scan *s);

/* Writes rows of such records. */
void e57_records_rows(const e57_layout *layout, const e57_out_scan *s, size_t first, size_t count,
					  uint8_t *rows);

/* A field's values of rows, as e57_records_stretch has them. */
void e57_rows_stretch(const e57_out_scan *s, const e57_out_field *f, const uint8_t *rows,
					  size_t count, uint8_t *to);

/* Widens the limits of all floats by what rows hold, as e57_layout_make finds them. */
void e57_rows_limits(e57_out_scan *s, const uint8_t *rows, size_t count);

#endif

/*
 * las_whole.h - what LAS and LAZ have in common when they are written part by part: the functions
 * of format_parted.
 */
#ifndef LAS_WHOLE_H
#define LAS_WHOLE_H

#include "files/output_file.h"
#include "las/las_records.h"

gw_status las_whole_begin(format_whole *whole, gw_error *error);
gw_status las_whole_add(format_whole *whole, const scan *part, gw_error *error);
gw_status las_whole_go_on(format_whole *whole, bool *again, gw_error *error);
void las_whole_clear(format_whole *whole);
gw_status las_whole_row(const format_whole *whole, const scan *part, size_t *row, gw_error *error);

/* Records as they are in LAS, one after the other. */
gw_status las_whole_write_rows(output_file *out, const format_whole *whole, const scan *part,
							   gw_error *error);
gw_status las_whole_write_records(output_file *out, const las_records *records, gw_error *error);

#endif

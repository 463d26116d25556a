/*
 * output_name.h - what the name of an output says: its format.
 */
#ifndef OUTPUT_NAME_H
#define OUTPUT_NAME_H

#include "options/settings.h"
#include "table/format_table.h"

/* Whether bytes can only be appended to what has that name: standard output, a pipe, a device. */
bool output_name_is_stream(const char *path);

/* Whether a format is written part by part to what has that name. f: or NULL */
bool output_name_takes_parts(const char *path, const format *f);

/*
 * The format to write: the one called `name`, or when that is NULL the one whose extension the path
 * has; PLY for standard output and devices.
 *   found   receives it
 *   error   GW_ERROR_USAGE: no format that can be written is called so or has this extension
 */
gw_status output_name_format(const char *path, const char *name, const format **found,
							 gw_error *error);

/* Whether a format's values may be rounded as options have it; GW_ERROR_USAGE: only those of LAS
 * and its kin are.
 *   path   of the output, for the message */
gw_status output_name_check_rounding(const format *f, const settings *s, const char *path,
									 gw_error *error);

/* GW_ERROR_USAGE where --las-step would move points by more than a millimetre because x and y are
 * degrees. */
gw_status output_name_check_step(const settings *s, bool degrees, gw_error *error);

#endif

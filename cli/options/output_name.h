/*
 * output_name.h - what the name of an output says: its format.
 */
#ifndef OUTPUT_NAME_H
#define OUTPUT_NAME_H

#include "table/format_table.h"

/* Whether bytes can only be appended to what has that name: standard output, a pipe, a device. */
bool output_name_is_stream(const char *path);

/*
 * The format to write: the one called `name`, or when that is NULL the one whose extension the path
 * has; PLY for standard output and devices.
 *   found   receives it
 *   error   GW_ERROR_USAGE: no format that can be written is called so or has this extension
 */
gw_status output_name_format(const char *path, const char *name, const format **found,
							 gw_error *error);

/* Whether a format can keep light so; GW_ERROR_USAGE: only LAS and its kin are rounded.
 *   how    a settings_las_radiance
 *   path   of the output, for the message */
gw_status output_name_check_light(const format *f, int how, const char *path, gw_error *error);

#endif

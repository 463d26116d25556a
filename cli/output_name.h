/*
 * output_name.h - what the name of an output says: its format, and whether it is an input as well.
 */
#ifndef OUTPUT_NAME_H
#define OUTPUT_NAME_H

#include "format.h"

/*
 * The format to write by the extension of a name; PLY for standard output and devices.
 *   found   receives it
 *   error   GW_ERROR_USAGE: no format that can be written has this extension
 */
gw_status output_name_format(const char *path, const format **found, gw_error *error);

/* True when both names lead to the same regular file. */
bool output_name_same(const char *a, const char *b);

#endif

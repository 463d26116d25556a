/*
 * panorama_reader.h - a map of the environment from a file, whatever its format.
 */
#ifndef PANORAMA_READER_H
#define PANORAMA_READER_H

#include "panoramas/panorama.h"

/*
 * Reads a map, its format found by content.
 *   path   "-" is standard input
 *   map    on success owned by the caller, freed with panorama_clear; empty on failure
 *   error  as input_file_open; GW_ERROR_DATA when it is no such picture, is cut short, or is not
 *          twice as wide as high; GW_ERROR_MEMORY
 */
gw_status panorama_read(const char *path, panorama *map, gw_error *error);

#endif

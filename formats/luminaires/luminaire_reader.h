/*
 * luminaire_reader.h - a luminaire from a file, whatever its format.
 */
#ifndef LUMINAIRE_READER_H
#define LUMINAIRE_READER_H

#include "luminaires/luminaire.h"

/*
 * Reads a luminaire, its format found by content: what has a line that begins with TILT= is an IES
 * file.
 *   path       "-" is standard input
 *   l          on success the caller's, freed with luminaire_clear; empty on failure
 *   error      as input_file_open; GW_ERROR_DATA when it is no such file, or makes no sense;
 *              GW_ERROR_MEMORY
 */
gw_status luminaire_read(const char *path, luminaire *l, gw_error *error);

#endif

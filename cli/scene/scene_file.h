/*
 * scene_file.h - scenes as JSON, version 1: units, inputs, lights, and options under "bake".
 *
 * Unknown keys are errors with the nearest known name; messages say on which line. Paths of inputs
 * count from the folder of the scene file. Options on the command line go before those in the file.
 */
#ifndef SCENE_FILE_H
#define SCENE_FILE_H

#include "program/json_writer.h"
#include "options/settings.h"

/* True when an argument is a scene file, by its name: it ends in .json. */
bool scene_is_file(const char *path);

/*
 * Puts what a scene file says into the settings: its inputs in the place of settings->input[index],
 * its lights before those of the command line, its options where the command line has none.
 * GW_ERROR_DATA for content that makes no sense.
 */
gw_status scene_read(const char *path, size_t index, settings *settings, gw_error *error);

/* Reads the scene file among the inputs, if there is one. GW_ERROR_USAGE when there are two, or
 * when the lights have units of two kinds; as luminaire_read for files that lights name. */
gw_status scene_read_all(settings *settings, gw_error *error);

/* Writes units, lights and bake with the values in effect, as members of an object. */
void scene_write_members(json_writer *json, const settings *settings);

/* Writes a whole scene file that gives the same bake again. The lights must be resolved. */
void scene_write(FILE *out, const settings *settings);

#endif

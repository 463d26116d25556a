/*
 * probe_files.h - probes as files: their maps as one OpenEXR picture, all else as JSON. The manual
 * page glowworm-probes(1) says what is in both.
 */
#ifndef PROBE_FILES_H
#define PROBE_FILES_H

#include "files/output_file.h"
#include "options/settings.h"
#include "units/coordinates.h"

typedef struct probe_files {
	const settings *settings;
	const gw_probes *probes;
	const coordinates *place; /* from the inputs' coordinates to metres */
} probe_files;

/*
 * Writes the maps: tiles of size x size pixels, probe by probe in rows of probe_files_columns. The
 * smaller maps of distances lie in tiles of their own channels: that of half the size in the upper
 * left corner, each next one to the right of the one before.
 * GW_ERROR_MEMORY; those of exr_picture_write.
 */
gw_status probe_files_atlas(const probe_files *files, output_file *out, gw_error *error);

/* Tiles in a row of the picture: as many as make it about square. */
uint32_t probe_files_columns(const gw_probes *probes);

/* Writes which probes serve each cell, as OpenVDB grids at path. Errors as vdb_write. */
gw_status probe_files_grids(const probe_files *files, const char *path, gw_error *error);

/* Writes the rest. GW_ERROR_MEMORY; those of output_file_write. */
gw_status probe_files_json(const probe_files *files, output_file *out, gw_error *error);

#endif

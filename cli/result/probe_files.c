/*
 * probe_files.c - see probe_files.h.
 */
#include "result/probe_files.h"

#include "grids/vdb_grids.h"
#include "pictures/exr_picture.h"
#include "program/json_writer.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

/* Where the values of a pixel lie, and how many there are. */
enum { RADIANCE = 0, NORMAL = 3, DISTANCE = 6, LEAST, GREATEST, VALUES };

/* What both files say of the maps. */
static const char octahedral[] =
	"u right, v down, -1 to 1 over a tile; direction (u, v, z) with z = 1 - |u| - |v|, or where z "
	"< "
	"0 ((1 - |v|) sign u, (1 - |u|) sign v, z); pixels are at their middles";
static const char harmonics[] =
	"radiance; real, orthonormal over the sphere, without Condon-Shortley phase: 1, y, z, x, xy, "
	"yz, 3z^2-1, xz, x^2-y^2";

uint32_t probe_files_columns(const gw_probes *probes)
{
	uint32_t columns = 1;
	while ((uint64_t)columns * columns < probes->count)
		columns++;
	return columns;
}

/* Puts the smaller maps of one value next to each other. */
static void put_mips(float *tile, size_t stride, uint32_t size, const float *mip)
{
	uint32_t left = 0;
	for (uint32_t side = size / 2; side > 0; side /= 2) {
		for (uint32_t row = 0; row < side; row++)
			for (uint32_t column = 0; column < side; column++)
				tile[row * stride + VALUES * (size_t)(left + column)] = *mip++;
		left += side;
	}
}

/* Puts the maps of a probe where its tile begins; stride: numbers from one row to the next. */
static void put_tile(const gw_probes *p, size_t k, float *tile, size_t stride)
{
	const size_t texels = (size_t)p->size * p->size, mips = (texels - 1) / 3;
	for (uint32_t row = 0; row < p->size; row++)
		for (uint32_t column = 0; column < p->size; column++) {
			const size_t i = k * texels + (size_t)row * p->size + column;
			float *pixel = tile + row * stride + VALUES * (size_t)column;
			memcpy(pixel + RADIANCE, p->radiance + 3 * i, 3 * sizeof *pixel);
			memcpy(pixel + NORMAL, p->normal + 3 * i, 3 * sizeof *pixel);
			pixel[DISTANCE] = p->distance[i];
		}
	put_mips(tile + LEAST, stride, p->size, p->least + k * mips);
	put_mips(tile + GREATEST, stride, p->size, p->greatest + k * mips);
}

static gw_status write_picture(const probe_files *f, const float *values, uint32_t width,
							   uint32_t height, output_file *out, gw_error *error)
{
	static const char *const name[VALUES] = { "R",
											  "G",
											  "B",
											  "normal.X",
											  "normal.Y",
											  "normal.Z",
											  "distance",
											  "distance.least",
											  "distance.greatest" };
	exr_channel channel[VALUES];
	char tiles[96], far[48];
	for (size_t i = 0; i < VALUES; i++)
		channel[i] = (exr_channel){ name[i], false, values + i, VALUES };
	snprintf(tiles, sizeof tiles,
			 "%zu probes of %" PRIu32 " x %" PRIu32 " pixels, %" PRIu32 " a row", f->probes->count,
			 f->probes->size, f->probes->size, probe_files_columns(f->probes));
	snprintf(far, sizeof far, "%g m: nothing is there", (double)GW_PROBE_FAR);
	const exr_text text[] = {
		{ "software", "glowworm " GW_VERSION },
		{ "comments", f->settings->command },
		{ "units", f->settings->units == LIGHT_UNITS_PHOTOMETRIC ? "cd/m^2" : "W/(sr m^2)" },
		{ "probes", tiles },
		{ "octahedral", octahedral },
		{ "distanceFar", far },
	};
	const exr_picture picture = {
		width, height, channel, VALUES, text, sizeof text / sizeof *text
	};
	return exr_picture_write(out, &picture, error);
}

gw_status probe_files_atlas(const probe_files *f, output_file *out, gw_error *error)
{
	const gw_probes *p = f->probes;
	const uint32_t columns = probe_files_columns(p);
	const uint32_t rows = (uint32_t)((p->count + columns - 1) / columns);
	const size_t stride = VALUES * (size_t)columns * p->size;
	float *values = calloc((size_t)rows * p->size, stride * sizeof *values);
	if (!values)
		return gw_fail(error, GW_ERROR_MEMORY,
					   "no memory for the picture of %zu probes; smaller maps (--size) take less",
					   p->count);
	for (size_t k = 0; k < p->count; k++)
		put_tile(p, k, values + k / columns * p->size * stride + VALUES * (k % columns) * p->size,
				 stride);
	gw_status status = write_picture(f, values, columns * p->size, rows * p->size, out, error);
	free(values);
	return status;
}

gw_status probe_files_grids(const probe_files *f, const char *path, gw_error *error)
{
	const gw_probe_cells *cells = &f->probes->cells;
	const settings *s = f->settings;
	gw_voxels voxels = { .count = cells->count, .cell = cells->cell, .size = cells->size };
	memcpy(voxels.origin, cells->origin, sizeof voxels.origin);
	const vdb_text text[] = { { "creator", "glowworm " GW_VERSION }, { "command", s->command } };
	const vdb_numbers numbers = { cells->probe };
	const vdb_metadata metadata = { .text = text,
									.text_count = sizeof text / sizeof *text,
									.memory = s->bake.memory,
									.numbers = &numbers };
	return vdb_write(path, s->force, &voxels, &metadata, error);
}

/* ------------------------------------------------------------------------------------- JSON */

static void put_place(json_writer *json, const char *key, const coordinates *to,
					  const double metres[3])
{
	double place[3] = { metres[0], metres[1], metres[2] };
	coordinates_from_metres(to, place);
	json_put_reals(json, key, place, 3);
}

static void put_probe(json_writer *json, const probe_files *f, size_t k)
{
	const gw_probe *probe = &f->probes->probe[k];
	const uint32_t columns = probe_files_columns(f->probes), size = f->probes->size;
	const double corner[2] = { (double)(k % columns * size), (double)(k / columns * size) };
	json_put_open(json, NULL, '{');
	put_place(json, "position", f->place, probe->position);
	json_put_single(json, "radius", probe->radius);
	json_put_single(json, "nearest", probe->nearest);
	json_put_single(json, "farthest", probe->farthest);
	json_put_reals(json, "tile", corner, 2);
	json_put_open_flat(json, "harmonics", '[');
	for (size_t h = 0; h < GW_PROBE_HARMONICS; h++)
		json_put_singles(json, NULL, probe->harmonic[h], 3);
	json_put_close(json, ']');
	json_put_close(json, '}');
}

static void put_all(json_writer *json, const probe_files *f)
{
	const gw_probes *p = f->probes;
	bool photometric = f->settings->units == LIGHT_UNITS_PHOTOMETRIC;
	json_put_open(json, NULL, '{');
	json_put_text(json, "creator", "glowworm " GW_VERSION);
	json_put_text(json, "command", f->settings->command);
	json_put_text(json, "units", photometric ? "cd/m^2" : "W/(sr m^2)");
	json_put_count(json, "size", p->size);
	json_put_count(json, "columns", probe_files_columns(p));
	json_put_text(json, "octahedral", octahedral);
	json_put_text(json, "harmonics", harmonics);
	json_put_single(json, "far", GW_PROBE_FAR);
	json_put_real(json, "seen", p->seen);
	json_put_real(json, "seeable", p->seeable);
	json_put_count(json, "places", p->candidates);
	json_put_count(json, "before_moves", p->first);
	put_place(json, "minimum", f->place, p->minimum);
	put_place(json, "maximum", f->place, p->maximum);
	json_put_open(json, "probes", '[');
	for (size_t k = 0; k < p->count; k++)
		put_probe(json, f, k);
	json_put_close(json, ']');
	json_put_close(json, '}');
}

gw_status probe_files_json(const probe_files *f, output_file *out, gw_error *error)
{
	char *text = NULL;
	size_t length = 0;
	FILE *memory = open_memstream(&text, &length);
	if (memory) {
		json_writer json = { .out = memory, .lines = true };
		put_all(&json, f);
		fputc('\n', memory);
	}
	gw_status status = GW_OK;
	if (!memory || fclose(memory) != 0)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory for the probes as JSON");
	if (status == GW_OK)
		status = output_file_write(out, text, length, error);
	free(text);
	return status;
}

/* tiled_result.c - see tiled_result.h. */
#include "result/tiled_result.h"

#include "glowworm_host.h"
#include "points/scan_join.h"
#include "options/output_columns.h"
#include "program/signals.h"
#include "result/lit_scan.h"
#include "scene/glossy_points.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Width of the cubes that tiles are made of, in spacings of the points that were kept: what is of
 * one spacing's size beyond a halo of two of them takes no more than 1/16 in angle. */
#define CUBE_SPACINGS 4.0

/* Tiles of which bakes of half of their points say how wrong they are. */
#define TILES_CHECKED 4u

/* Tiles are told from what comes before by this share of the progress. */
#define PREPARED 0.1

gw_status tiled_result_check(const settings *s, gw_error *error)
{
	const struct {
		bool asked;
		const char *name, *why;
	} no[] = {
		{ s->bake.method != GW_METHOD_RAYS, "--method", "tiles are lit by rays" },
		{ s->vdb || s->vdb_sh, "--vdb", "grids are of all points at once" },
		{ s->region, "--region", "a region is lit by itself already" },
		{ s->frames, "--frames", "frames are of all points at once" },
		{ s->transport || s->save_transport, "--transport", "each tile is a scene of its own" },
		{ s->bake.surface_points > 0, "--surface-points", "tiles are lit by all points" },
		{ s->bake.time_limit > 0.0f, "--time", "how long tiles take is not known before" },
		{ s->explain, "--explain", "how long tiles take is not foretold" },
		{ !s->output || strcmp(s->output, "-") == 0, "-o -", "tiles are kept beside the output" },
	};
	for (size_t i = 0; s->tiles > 0 && i < sizeof no / sizeof *no; i++)
		if (no[i].asked)
			return gw_fail(error, GW_ERROR_USAGE, "--tiles does not go with %s: %s", no[i].name,
						   no[i].why);
	return GW_OK;
}

/* ------------------------------------------------------------------------------ sorting by tiles
 */

/* For each part of the cloud. */
typedef gw_status part_user(void *user, uint32_t number, const scan *cloud, const gw_points *points,
							gw_error *error);

/* A part's points as the file has them, and as the bake takes them. */
static gw_status use_part(const tiled_result *r, uint32_t number, part_user *use, void *user,
						  gw_error *error)
{
	scan cloud, copy;
	loaded_scene scene;
	const parted_result *kept = r->kept;
	GW_TRY(parted_cloud_read(kept->scene->parted, number, &cloud, error));
	gw_status status = scan_copy(&cloud, &copy, error);
	if (status == GW_OK) {
		status = loaded_scene_take_part(kept->settings, kept->scene, &copy, &scene, error);
		if (status == GW_OK)
			status = use(user, number, &cloud, &scene.points.points, error);
		loaded_scene_clear_part(&scene);
	}
	scan_clear(&cloud);
	return status == GW_OK ? signals_check(error) : status;
}

static gw_status use_parts(const tiled_result *r, part_user *use, void *user, gw_error *error)
{
	uint64_t parts = parted_cloud_parts(r->kept->scene->parted);
	for (uint64_t number = 0; number < parts; number++)
		GW_TRY(use_part(r, (uint32_t)number, use, user, error));
	return GW_OK;
}

static gw_status count_part(void *user, uint32_t number, const scan *cloud, const gw_points *points,
							gw_error *error)
{
	(void)number;
	(void)cloud;
	return gw_tiling_count(user, points, error);
}

typedef struct sorting {
	const gw_tiling *tiling;
	tile_file *file;
} sorting;

/* Puts the points of a part that are in one tile into the file. */
static gw_status sort_tile(const sorting *s, const scan *cloud, const gw_tile_members *members,
						   tile_rows *rows, gw_error *error)
{
	scan points;
	uint64_t first = members->first[rows->tile], end = members->first[rows->tile + 1];
	if (first == end)
		return GW_OK;
	rows->row = members->point + first;
	rows->core = members->core + first;
	GW_TRY(scan_take_points(cloud, rows->row, (size_t)(end - first), &points, error));
	gw_status status = tile_file_add(s->file, rows, &points, error);
	scan_clear(&points);
	return status;
}

static gw_status sort_part(void *user, uint32_t number, const scan *cloud, const gw_points *points,
						   gw_error *error)
{
	const sorting *s = user;
	gw_tile_members members;
	gw_status status = gw_tiling_members(s->tiling, points, &members, error);
	for (uint32_t tile = 0; status == GW_OK && tile < gw_tiling_tiles(s->tiling); tile++) {
		tile_rows rows = { .tile = tile, .part = number };
		status = sort_tile(s, cloud, &members, &rows, error);
	}
	gw_tile_members_clear(&members);
	return status;
}

/* Which of the points that were kept each tile has by itself. */
static gw_status sort_kept(const sorting *s, const gw_points *kept, gw_error *error)
{
	gw_tile_members members;
	gw_status status = gw_tiling_members(s->tiling, kept, &members, error);
	for (uint32_t tile = 0; status == GW_OK && tile < gw_tiling_tiles(s->tiling); tile++) {
		uint64_t first = members.first[tile];
		status = tile_file_add_kept(s->file, tile, members.point + first,
									(size_t)(members.first[tile + 1] - first), error);
	}
	gw_tile_members_clear(&members);
	return status;
}

static gw_status sort_all(tiled_result *r, gw_tiling *tiling, gw_error *error)
{
	const parted_result *kept = r->kept;
	const sorting s = { tiling, &r->file };
	GW_TRY(use_parts(r, count_part, tiling, error));
	GW_TRY(gw_tiling_form(tiling, kept->scene->parted->tile, kept->settings->tiles, error));
	GW_TRY(tile_file_begin(&r->file, error));
	GW_TRY(use_parts(r, sort_part, (void *)(uintptr_t)&s, error));
	GW_TRY(sort_kept(&s, &kept->scene->points.points, error));
	return tile_file_settle(&r->file, gw_tiling_tiles(tiling), error);
}

static gw_status sort_points(tiled_result *r, gw_error *error)
{
	gw_tiling *tiling;
	const parted_result *kept = r->kept;
	progress_show(kept->progress, "tiles", 0.0);
	GW_TRY(gw_tiling_begin(&kept->scene->points.points, CUBE_SPACINGS * kept->light->report.spacing,
						   &tiling, error));
	gw_status status = sort_all(r, tiling, error);
	gw_tiling_end(&tiling);
	return status;
}

gw_status tiled_result_open(tiled_result *r, gw_error *error)
{
	const settings *s = r->kept->settings;
	journal_file *journal = r->kept->scene->parted->journal;
	const gw_byte_sink to = { journal_file_write, journal };
	const gw_byte_source from = { journal_file_read, journal };
	bool there = false;
	GW_TRY(tile_file_open(s->output, s->force, s->resume, &r->file, error));
	if (!journal)
		return sort_points(r, error);
	GW_TRY(journal_file_begin(journal, BAKE_JOURNAL_SORTED, &there, error));
	GW_TRY(there ? tile_file_load(&r->file, &from, error) : sort_points(r, error));
	if (!there)
		GW_TRY(tile_file_save(&r->file, &to, error));
	return journal_file_end(journal, error);
}

void tiled_result_close(tiled_result *r)
{
	tile_file_close(&r->file, r->kept && r->kept->ranks.rank > 0);
}

/* ---------------------------------------------------------------------------------- lighting them
 */

/* A tile, its light, and what is known of it. */
typedef struct lit_tile {
	loaded_scene scene;
	gw_tile tile;
	uint8_t *core;
	uint32_t *replaced;
	gw_tile_share share;
	gw_bake_result *light;
} lit_tile;

static void clear(lit_tile *t)
{
	gw_bake_result_destroy(&t->light);
	loaded_scene_clear_part(&t->scene);
	free(t->core);
	free(t->replaced);
}

static bool is_checked(const tiled_result *r, uint32_t number)
{
	uint32_t step = (r->file.tiles + TILES_CHECKED - 1) / TILES_CHECKED;
	return number % step == 0;
}

static gw_status load(const tiled_result *r, uint32_t number, lit_tile *t, gw_error *error)
{
	scan cloud;
	const parted_result *kept = r->kept;
	GW_TRY(tile_file_points(&r->file, number, &cloud, &t->core, error));
	GW_TRY(loaded_scene_take_part(kept->settings, kept->scene, &cloud, &t->scene, error));
	glossy_points_apply(kept->settings, &t->scene);
	t->tile = (gw_tile){ .near = &t->scene.points.points,
						 .core = t->core,
						 .kept = &kept->scene->points.points,
						 .light = kept->light,
						 .checked = is_checked(r, number) };
	GW_TRY(tile_file_kept(&r->file, number, &t->replaced, &t->tile.replaced_count, error));
	t->tile.replaced = t->replaced;
	return GW_OK;
}

/* A column that only one of both has: a tile alone may have all that glows, or none of it. */
static gw_status match(float **own, const float *of_kept, size_t count, gw_error *error)
{
	if (!of_kept) {
		free(*own);
		*own = NULL;
	}
	if (of_kept && !*own)
		*own = calloc(3 * count + 1, sizeof **own);
	return of_kept && !*own ? gw_fail(error, GW_ERROR_MEMORY, "no memory for a column") : GW_OK;
}

static void on_progress(void *user, const char *stage, double done)
{
	const tiled_result *r = user;
	(void)stage;
	double share = (r->under_way + done) / r->file.tiles;
	progress_show(r->kept->progress, "tiles", PREPARED + (1.0 - PREPARED) * fmin(share, 1.0));
}

static bool on_cancelled(void *user)
{
	(void)user;
	return signals_pending() != 0;
}

static void say_tile(const tiled_result *r, const lit_tile *t, double seconds)
{
	size_t core = 0, count = t->tile.near->count;
	for (size_t i = 0; i < count; i++)
		core += t->core[i];
	if (!r->kept->settings->verbose)
		return;
	progress_clear(r->kept->progress);
	fprintf(stderr, "glowworm: tile %u of %u: %zu points, %zu around them, %.1f s\n",
			r->under_way + 1, r->file.tiles, core, count - core, seconds);
}

static gw_status light_tile(tiled_result *r, uint32_t number, gw_tile_device *device, lit_tile *t,
							gw_error *error)
{
	const parted_result *kept = r->kept;
	const gw_bake_callbacks callbacks = { on_progress, on_cancelled, r, NULL };
	const gw_tile_lighting lighting = { r->light, kept->settings->light_count, r->options,
										&callbacks, device };
	r->under_way = number;
	*t = (lit_tile){ .light = NULL };
	GW_TRY(load(r, number, t, error));
	double start = gw_seconds();
	GW_TRY(gw_tile_light(&t->tile, &lighting, &t->share, &t->light, error));
	say_tile(r, t, gw_seconds() - start);
	return match(&t->light->rest, kept->light->rest, t->tile.near->count, error);
}

static gw_status write_tile(tiled_result *r, uint32_t number, const settings *s, lit_tile *t,
							gw_error *error)
{
	scan lit;
	double exposure;
	journal_slot slot;
	journal_file *journal = r->kept->scene->parted->journal;
	GW_TRY(lit_scan_make(&t->scene, t->light, s, &lit, &exposure, error));
	const tile_outcome outcome = { &t->share, &lit, r->kept->format,
								   &r->kept->scene->parted->whole };
	gw_status status = tile_file_put(&r->file, number, &outcome, &slot, error);
	scan_clear(&lit);
	GW_TRY(status);
	if (!journal)
		return GW_OK;
	GW_TRY(tile_file_sync(&r->file, error));
	GW_TRY(journal_file_put(journal, number, &slot, error));
	return journal_file_sync(journal, error);
}

/* s: with the exposure */
static gw_status light_all(tiled_result *r, const settings *s, gw_tile_device *device,
						   gw_error *error)
{
	const ranks *all = &r->kept->ranks;
	journal_file *journal = r->kept->scene->parted->journal;
	journal_slot slot;
	if (journal)
		GW_TRY(journal_file_slots(journal, r->file.tiles, error));
	for (uint32_t number = all->rank; number < r->file.tiles; number += all->count) {
		GW_TRY(signals_check(error));
		if (journal && journal_file_get(journal, number, &slot) && tile_file_holds(&r->file, &slot))
			continue;
		lit_tile t;
		gw_status status = light_tile(r, number, device, &t, error);
		if (status == GW_OK)
			status = write_tile(r, number, s, &t, error);
		clear(&t);
		GW_TRY(status);
	}
	return tile_file_sync(&r->file, error);
}

/* ----------------------------------------------------------------------------------- the result */

static gw_status report(const tiled_result *r, gw_error *error)
{
	const parted_result *kept = r->kept;
	gw_status status = GW_OK;
	gw_tile_share *share = reallocarray(NULL, r->file.tiles, sizeof *share);
	if (!share)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %u tiles", r->file.tiles);
	for (uint32_t tile = 0; tile < r->file.tiles && status == GW_OK; tile++)
		status = tile_file_share(&r->file, tile, &share[tile], error);
	if (status == GW_OK)
		gw_tiles_report(share, r->file.tiles, (double)r->options->max_error, &kept->light->report);
	free(share);
	return status;
}

static gw_status put_rows(const tiled_result *r, const tile_part *part, output_file *out,
						  gw_error *error)
{
	const format_parted *to = r->kept->format->parted;
	const format_loose rows = { part->bytes, part->row, part->count };
	return to->pack_loose ? to->pack_loose(out, &r->kept->scene->parted->whole, &rows, error)
						  : output_file_write(out, part->bytes, part->row * part->count, error);
}

static gw_status write_parts(const tiled_result *r, size_t row, output_file *out, gw_error *error)
{
	const parted_cloud *parted = r->kept->scene->parted;
	gw_status status = GW_OK;
	uint8_t *bytes = reallocarray(NULL, parted->part, row);
	if (!bytes)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu points", parted->part);
	for (uint64_t number = 0; number < parted_cloud_parts(parted) && status == GW_OK; number++) {
		uint64_t left = parted->file.count - number * parted->part;
		const tile_part part = { (uint32_t)number, row,
								 left < parted->part ? (size_t)left : parted->part, bytes };
		status = tile_file_part(&r->file, &part, error);
		if (status == GW_OK)
			status = put_rows(r, &part, out, error);
		if (status == GW_OK)
			status = signals_check(error);
	}
	free(bytes);
	return status;
}

/* What another run wrote may be longer. */
static gw_status begin_anew(output_file *out, gw_error *error)
{
	GW_TRY(output_file_resize(out, 0, error));
	return output_file_seek(out, 0, error);
}

/* What stands before all points is that of the first part, in the light of those that were kept;
 * it has the columns that all have. */
static gw_status write_all(const tiled_result *r, const settings *s, output_file *out,
						   gw_error *error)
{
	scan lit;
	size_t row;
	const parted_result *kept = r->kept;
	GW_TRY(parted_result_light_part(kept, 0, s, &lit, error));
	const format_parted *to = kept->format->parted;
	const format_whole *whole = &kept->scene->parted->whole;
	gw_status status = format_whole_row(kept->format, whole, &lit, &row, error);
	if (status == GW_OK && kept->scene->parted->journal)
		status = begin_anew(out, error);
	if (status == GW_OK) {
		output_columns_note(kept->format, &lit, s->quiet);
		status = to->write_head(out, whole, &lit, error);
	}
	scan_clear(&lit);
	if (status == GW_OK)
		status = write_parts(r, row, out, error);
	return status == GW_OK && to->write_end ? to->write_end(out, whole, error) : status;
}

gw_status tiled_result_write(tiled_result *r, output_file *out, double *exposure, gw_error *error)
{
	const parted_result *kept = r->kept;
	settings s = *kept->settings; /* nothing of it is freed */
	gw_tile_device *device;
	GW_TRY(lit_scan_meter(kept->scene, kept->light, kept->settings, exposure, error));
	s.exposure = (float)*exposure;
	GW_TRY(gw_tile_device_open(&device, error));
	double start = gw_seconds();
	gw_status status = light_all(r, &s, device, error);
	r->seconds = gw_seconds() - start;
	gw_tile_device_close(&device);
	GW_TRY(status);
	GW_TRY(ranks_wait(&kept->ranks, error));
	if (kept->ranks.rank > 0)
		return GW_OK;
	GW_TRY(report(r, error));
	GW_TRY(write_all(r, &s, out, error));
	tile_file_done(&r->file);
	return GW_OK;
}

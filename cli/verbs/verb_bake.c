#include "verbs/verbs.h"
#include "result/las_step.h"
#include "result/bake_report.h"
#include "scene/file_roles.h"
#include "points/scan_aside.h"
#include "scene/stream_roles.h"
#include "result/frame_bake.h"
#include "scene/glossy_points.h"
#include "files/input_file.h"
#include "result/light_shares.h"
#include "result/lit_scan.h"
#include "result/tiled_result.h"
#include "scene/input_notes.h"
#include "scene/region_text.h"
#include "options/output_name.h"
#include "options/output_scanners.h"
#include "options/output_columns.h"
#include "options/output_system.h"
#include "options/progress.h"
#include "options/quality_preset.h"
#include "program/ranks.h"
#include "scene/scene_file.h"
#include "program/signals.h"
#include "program/text_quote.h"
#include "grids/vdb_grids.h"
#include "grids/voxel_merge.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* All that lives as long as one bake. */
typedef struct bake {
	settings *settings;
	const format *format; /* of the output */
	output_file *output, *report, *transport;
	ranks ranks;         /* who work together */
	input_file reused;   /* a transport, */
	uint64_t kept;       /* of so many points of a parted cloud, or of all: 0 */
	parted_cloud parted; /* where memory does not hold the input */
	loaded_scene scene;
	region_points region;
	gw_light *light;
	gw_bake_result *result;
	parted_result all;  /* points of a parted cloud */
	tiled_result tiled; /* where tiles are lit */
	gw_bake_options options;
	gw_drivers *drivers; /* loaded while the inputs are read */
	scan lit;
	progress progress;
	bake_facts facts;
	gw_bake_result planned; /* what was foretold with --explain; owns nothing */
	gw_error *error;
} bake;

static double now(void)
{
	struct timespec time;
	clock_gettime(CLOCK_MONOTONIC, &time);
	return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

/* ------------------------------------------------------------------------- before reading */

/* Lux are there only where lamps have them. */
static gw_status check_units(const settings *s, gw_error *error)
{
	uint32_t photometric = 1u << SETTINGS_FIELD_ILLUMINANCE | 1u << SETTINGS_FIELD_LUMINANCE;
	if (!(s->fields & photometric) || s->units == LIGHT_UNITS_PHOTOMETRIC)
		return GW_OK;
	return gw_fail(error, GW_ERROR_USAGE, "--fields %s is in %s, and %s; %s",
				   s->fields & 1u << SETTINGS_FIELD_ILLUMINANCE ? "illuminance" : "luminance",
				   s->fields & 1u << SETTINGS_FIELD_ILLUMINANCE ? "lx" : "cd/m^2",
				   s->units == LIGHT_UNITS_RADIOMETRIC ? "this scene's lamps are in watts"
													   : "no unit of this scene's lamps is known",
				   "say cd, lm or lx behind their numbers, or \"units\": \"photometric\" in the "
				   "scene file");
}

static gw_status check_streams(const settings *s, gw_error *error)
{
	const stream_output out[] = { { "--output", s->output, "this is" },
								  { "--vdb", s->vdb, "this is" },
								  { "--vdb-sh", s->vdb_sh, "this is" },
								  { "--report", s->report, NULL },
								  { "--save-transport", s->save_transport, "this is" } };
	GW_TRY(stream_roles_check_inputs(s, error));
	return stream_roles_check_outputs(out, sizeof out / sizeof *out, error);
}

/* What is kept of a bake are its points. */
static gw_status check_resume(const settings *s, gw_error *error)
{
	if (!s->resume)
		return GW_OK;
	if (!s->output || strcmp(s->output, "-") == 0)
		return gw_fail(error, GW_ERROR_USAGE,
					   "--resume needs -o FILE, beside which it keeps what is done");
	if (s->frames)
		return gw_fail(
			error, GW_ERROR_USAGE,
			"--resume is for one bake of points, and frames are whole once they have "
			"their names: leave it out and let --frames name those that are missing; with "
			"--independent and --exposure they are what they would have been");
	if (s->vdb || s->vdb_sh)
		return gw_fail(error, GW_ERROR_USAGE,
					   "--resume goes on with points alone: leave the grids out, or --resume");
	return GW_OK;
}

static gw_status check(bake *b)
{
	settings *s = b->settings;
	const uint32_t ao_fields = 1u << SETTINGS_FIELD_AO | 1u << SETTINGS_FIELD_BENT_NORMALS;
	if (s->input_count == 0)
		return gw_fail(b->error, GW_ERROR_USAGE,
					   "what to light? Name an input, or - for standard input");
	if (s->print_scene)
		return GW_OK;
	if (!s->output && !s->vdb && !s->vdb_sh && !s->report && !s->save_transport)
		return gw_fail(b->error, GW_ERROR_USAGE,
					   "where to write? Give -o FILE, or -o - for standard output");
	if (s->output_format && !s->output)
		return gw_fail(b->error, GW_ERROR_USAGE, "--output-format needs -o FILE");
	if (s->vdb_half && !s->vdb && !s->vdb_sh)
		return gw_fail(b->error, GW_ERROR_USAGE, "--vdb-half needs --vdb or --vdb-sh FILE");
	if (s->vdb_points && !s->vdb)
		return gw_fail(b->error, GW_ERROR_USAGE, "--vdb-points needs --vdb FILE");
	if (s->vdb_voxel > 0.0f && !s->vdb)
		return gw_fail(b->error, GW_ERROR_USAGE, "--vdb-voxel needs --vdb FILE");
	if (s->bake.ambient_occlusion_distance > 0.0f && !(s->fields & ao_fields))
		return gw_fail(b->error, GW_ERROR_USAGE,
					   "--ao-distance says how far --fields ao and bent-normals look; give one of "
					   "them, or leave it out");
	GW_TRY(check_resume(s, b->error));
	GW_TRY(tiled_result_check(s, b->error));
	GW_TRY(check_units(s, b->error));
	GW_TRY(region_text_check(s, b->error));
	GW_TRY(check_streams(s, b->error));
	GW_TRY(frame_bake_check(s, b->error));
	if (!s->frames)
		GW_TRY(file_roles_check(VERB_BAKE, s, NULL, b->error));
	if (s->output) {
		GW_TRY(output_name_format(s->output, s->output_format, &b->format, b->error));
		GW_TRY(output_name_check_rounding(b->format, s, s->output, b->error));
	}
	return output_shift_read(s->shift, b->format, &s->shifting, b->error);
}

/* Can grids be written, and there? path may be NULL. */
static gw_status probe_grids(bake *b, const char *path)
{
	struct stat info;
	output_file *probe;
	if (!path)
		return GW_OK;
	GW_TRY(vdb_load(b->error));
	if (strcmp(path, "-") == 0 || (stat(path, &info) == 0 && !S_ISREG(info.st_mode)))
		return GW_OK;
	GW_TRY(output_file_create(&probe, path, b->settings->force, b->error));
	output_file_abandon(&probe);
	return GW_OK;
}

/* Before hours of work it has to be clear that the results can be put down. */
static gw_status open_outputs(bake *b)
{
	const settings *s = b->settings;
	bool lasts = s->resume || b->ranks.count > 1;
	if (s->output && !s->frames)
		GW_TRY(lasts ? output_file_check(s->output, s->force, b->error)
					 : output_file_create(&b->output, s->output, s->force, b->error));
	if (s->output && !s->frames && !s->resume && b->ranks.rank == 0)
		GW_TRY(bake_journal_left(s, b->ranks.count > 1, b->error));
	if (s->report)
		GW_TRY(output_file_create(&b->report, s->report, s->force, b->error));
	if (s->save_transport)
		GW_TRY(output_file_create(&b->transport, s->save_transport, s->force, b->error));
	GW_TRY(probe_grids(b, s->vdb));
	GW_TRY(probe_grids(b, s->vdb_sh));
	return GW_OK;
}

/* ------------------------------------------------------------------------------- the bake */

/* A column that is made anew. */
static void note_quality(const bake *b)
{
	bool lit = true;
	for (size_t i = 0; i < b->scene.input_count; i++)
		lit = lit && b->scene.input[i].lit;
	if (!lit && b->settings->output && scan_find(&b->scene.cloud, "quality"))
		fprintf(stderr, "glowworm: note: the column 'quality' that came in is replaced by the "
						"luminance\n");
}

/* Without an account: all points at once. */
static gw_status open_alone(bake *b)
{
	const settings *s = b->settings;
	if (b->ranks.count > 1 && access(s->input[0].path, R_OK) != 0)
		return gw_fail(b->error, FILE_ERROR_NO_INPUT, "cannot open %s: %s", s->input[0].path,
					   strerror(errno));
	if (b->ranks.count > 1)
		return gw_fail(
			b->error, GW_ERROR_USAGE,
			"this bake is of all points at once, which %u processes cannot share: start "
			"one, or where the result is PLY or LAS give a --memory that does not hold all "
			"points",
			b->ranks.count);
	if (!s->quiet)
		fprintf(stderr, "glowworm: note: --resume keeps nothing of this bake: it is of all points "
						"at once, not by parts\n");
	return output_file_create(&b->output, s->output, s->force, b->error);
}

/* What is done of a bake by parts is kept beside the output, where another run of it may have
 * begun. The name of the journal is `path`. Ranks but the first begin when that is ready to share
 * parts. */
static gw_status open_account(bake *b, const char *path)
{
	const settings *s = b->settings;
	const bake_journal_use use = { path, b->ranks.rank == 0, s->resume };
	bool there = b->ranks.rank > 0 || access(path, F_OK) == 0;
	if (b->ranks.rank > 0)
		GW_TRY(ranks_wait(&b->ranks, b->error));
	if (!b->parted.file.found || (b->parted.most == 0 && !there))
		return open_alone(b);
	if (b->format->parted->pack_loose && s->tiles == 0)
		return gw_fail(
			b->error, GW_ERROR_USAGE,
			"%s: --resume, and processes that share a bake, write each part at its place, which "
			"for %s is not known before: write LAS or PLY, or light by --tiles",
			s->output, b->format->name);
	if (s->resume && s->save_transport)
		return gw_fail(
			b->error, GW_ERROR_USAGE,
			"--resume goes on with the light of a bake by parts, not with its transport: "
			"leave --save-transport out, or --resume");
	GW_TRY(parted_cloud_keep(&b->parted, s, &use, b->error));
	GW_TRY(output_file_create_lasting(&b->output, s->output, s->force, s->resume, b->error));
	if (!b->parted.begun)
		return output_file_resize(b->output, 0, b->error);
	if (!s->quiet)
		text_message(stderr, "glowworm: note: the bake goes on with %s\n", path);
	return GW_OK;
}

static gw_status keep_account(bake *b)
{
	if (!b->settings->resume && b->ranks.count == 1)
		return GW_OK;
	if (!b->settings->output)
		return open_alone(b);
	char *path = output_file_beside(b->settings->output, BAKE_JOURNAL_NAME);
	gw_status status = path
						   ? open_account(b, path)
						   : gw_fail(b->error, GW_ERROR_MEMORY, "no memory for the name of a file");
	free(path);
	return status;
}

/* A transport, and how many points of a parted cloud it is of; NULL: there is none. */
static gw_status open_transport(bake *b, const uint64_t **kept)
{
	*kept = NULL;
	if (!b->settings->transport)
		return GW_OK;
	/* Mapped: most of a transport is used where it lies. */
	GW_TRY(input_file_open_as(&b->reused, b->settings->transport, 0, 0, b->error));
	const gw_transport reused = { .name = b->reused.name,
								  .data = b->reused.data,
								  .length = b->reused.length };
	*kept = &b->kept;
	return input_file_check(&b->reused, gw_transport_note(&reused, &b->kept, b->error), b->error);
}

/* Whether the points can be lit by tiles, if they are to be. */
static gw_status check_tiles(const bake *b)
{
	if (b->settings->tiles == 0 || b->parted.most > 0)
		return GW_OK;
	if (b->parted.memory_wanted > 0)
		return gw_fail(
			b->error, GW_ERROR_USAGE,
			"--tiles needs more memory than there is for it: say --memory %lluM, or more, "
			"or leave it out, which lights some of the points for all",
			(unsigned long long)((b->parted.memory_wanted >> 20) + 1));
	return gw_fail(b->error, GW_ERROR_USAGE,
				   "--tiles lights clouds from files, of more than %u points in all, to a file of "
				   "PLY, LAS, LAZ, E57 or PCD; not pipes, meshes, frames, or inputs of which a "
				   "scene file says more than where they stand; leave it out",
				   PARTED_CLOUD_LEAST);
}

static gw_status read_inputs(bake *b)
{
	const uint64_t *kept;
	double start = now();
	GW_TRY(open_transport(b, &kept));
	progress_show(&b->progress, "read", 0.0);
	GW_TRY(parted_cloud_open(b->settings, b->settings->frames ? NULL : b->format, kept, &b->parted,
							 b->error));
	GW_TRY(check_tiles(b));
	GW_TRY(keep_account(b));
	parted_cloud *parted = b->parted.most > 0 ? &b->parted : NULL;
	gw_status status = loaded_scene_read_parted(b->settings, parted, &b->scene, b->error);
	if (status == GW_OK)
		glossy_points_apply(b->settings, &b->scene);
	progress_clear(&b->progress);
	if (status == GW_OK && !b->settings->quiet) {
		input_notes_print(b->settings, &b->scene);
		note_quality(b);
	}
	b->facts.read_seconds = now() - start;
	return status;
}

/* Bytes that a point adds at least to grids with leaves as wide as by default, and to their points,
 * compressed; a third of what was seen. */
#define GRID_BYTES 10u
#define GRID_POINT_BYTES 4u

/* The files beside the points: known only as far as it goes without their octree. */
static gw_status check_room_beside(const bake *b)
{
	const settings *s = b->settings;
	uint64_t count = b->scene.cloud.count, grid_bytes = s->vdb_points ? GRID_POINT_BYTES : 0;
	bool usual = s->bake.depth == GW_DEPTH_AUTO && s->vdb_voxel <= 0.0f && !s->vdb_half &&
				 s->bake.leaf_spacing <= GW_LEAF_SPACING;
	if (s->save_transport)
		GW_TRY(output_file_check_room(s->save_transport, TRANSPORT_BYTES * count, b->error));
	grid_bytes += usual ? GRID_BYTES : 0;
	return s->vdb ? output_file_check_room(s->vdb, grid_bytes * count, b->error) : GW_OK;
}

/* Of a cloud that comes in parts all points are looked at for it. */
static gw_status check_format(bake *b)
{
	if (!b->scene.parted)
		return b->format->accept ? b->format->accept(&b->scene.cloud, b->settings->output, b->error)
								 : GW_OK;
	progress_show(&b->progress, "read", 0.0);
	GW_TRY(parted_cloud_survey(&b->parted, b->settings->output, b->error));
	progress_clear(&b->progress);
	return GW_OK;
}

/* What is known of the results before hours of work: whether their format can hold the points, and
 * the disk the files. */
static gw_status check_results(bake *b)
{
	const settings *s = b->settings;
	size_t columns, row = b->format ? lit_scan_row_bytes(&b->scene, s, &columns) : 0;
	GW_TRY(check_room_beside(b));
	if (!b->format)
		return GW_OK;
	if (b->output)
		output_file_use_threads(b->output, s->bake.threads);
	GW_TRY(output_name_check_step(s, b->scene.place.projected, b->error));
	GW_TRY(check_format(b));
	row = b->format->row_bytes ? b->format->row_bytes : b->format->text ? 2 * columns : row;
	if (b->parted.begun) /* what is there takes room already */
		return GW_OK;
	/* Of frames, at least one. */
	uint64_t count = b->scene.parted ? b->parted.file.count : b->scene.cloud.count;
	return output_file_check_room(s->output, (uint64_t)row * count, b->error);
}

static void on_progress(void *user, const char *stage, double done)
{
	progress_show(&((bake *)user)->progress, stage, done);
}

/* Before what takes long: what is going to be done. */
static void on_planned(void *user, const gw_bake_result *plan)
{
	bake *b = user;
	size_t columns, row = b->format ? lit_scan_row_bytes(&b->scene, b->settings, &columns) : 0;
	progress_clear(&b->progress);
	b->planned = *plan;
	bake_plan_add_scene(&b->planned.report, b->settings, &b->scene);
	b->facts.forecast =
		bake_plan_foretell(b->settings, &b->scene, &b->planned, b->facts.read_seconds, row,
						   frame_bake_following(b->settings));
	if (b->settings->explain)
		bake_plan_print(&b->facts.forecast, stderr);
	b->planned.given = NULL; /* the bake goes on to fill it */
	b->planned.given_count = 0;
}

static bool on_cancelled(void *user)
{
	(void)user;
	return signals_pending() != 0;
}

/* Frames are planned by themselves, before the first of them. */
static gw_status explain_frames(bake *b)
{
	const gw_bake_callbacks callbacks = { on_progress, on_cancelled, b, NULL };
	gw_bake_result *plan = NULL;
	gw_status status = frame_bake_plan(b->settings, &b->scene, &callbacks, &plan, b->error);
	if (status == GW_OK)
		on_planned(b, plan);
	b->planned.report.forecast.own_seconds = 0.0; /* of none of the bakes */
	gw_bake_result_destroy(&plan);
	return status;
}

static gw_status write_transport(void *user, const void *bytes, size_t length, gw_error *error)
{
	return output_file_write(((bake *)user)->transport, bytes, length, error);
}

static gw_status bake_points(bake *b, const gw_bake_options *options,
							 const gw_bake_callbacks *callbacks)
{
	if (b->parted.journal)
		GW_TRY(parted_result_load(&b->scene, &b->result, b->error));
	b->all.loaded = b->result != NULL;
	if (b->all.loaded)
		return GW_OK;
	loaded_scene *s = &b->scene;
	scan_put_aside(&s->cloud, &s->points);
	gw_status status =
		gw_bake(&(gw_scene_description){ &s->points.points, b->light, b->settings->light_count },
				options, callbacks, &b->result, b->error);
	return status == GW_OK ? scan_take_back(&s->cloud, &s->points, b->error) : status;
}

static gw_status open_tiles(bake *b)
{
	if (b->settings->tiles == 0)
		return GW_OK;
	b->tiled.kept = &b->all;
	b->tiled.light = b->light;
	b->tiled.options = &b->options;
	return tiled_result_open(&b->tiled, b->error);
}

static gw_status light_points(bake *b)
{
	double start = now();
	gw_bake_options options = b->options = bake_plan_options(b->settings);
	/* What is far off need not be better than that, and a target is one for the tiles. */
	if (b->settings->tiles > 0 && options.max_error > 0.0f) {
		gw_bake_options_set_quality(&options, GW_QUALITY_NORMAL);
		options.max_error = 0.0f;
	}
	/* What reading took is gone; a limit of 0 would be none. */
	if (options.time_limit > 0.0f)
		options.time_limit = fmaxf(options.time_limit - (float)b->facts.read_seconds, 1e-3f);
	const gw_transport transport = { .name = b->reused.name,
									 .data = b->reused.data,
									 .length = b->reused.length,
									 .fleeting = b->reused.storage == INPUT_FILE_MAPPED,
									 .write = b->transport ? write_transport : NULL,
									 .user = b,
									 .note = b->parted.most };
	if (transport.data || transport.write)
		options.transport = &transport;
	if (b->settings->region) {
		GW_TRY(region_points_find(b->settings, &b->scene, &b->region, b->error));
		options.region = &b->region.region;
	}
	gw_bake_callbacks callbacks = { on_progress, on_cancelled, b,
									b->settings->explain ? on_planned : NULL };
	gw_status status =
		b->settings->frame_count > 0
			? frame_bake_first(b->settings, &b->scene, &options, &callbacks, &b->result, b->error)
			: bake_points(b, &options, &callbacks);
	progress_clear(&b->progress);
	b->facts.bake_seconds = now() - start;
	b->facts.result = b->result;
	if (status != GW_OK || !b->scene.parted)
		return status;
	b->all = (parted_result){ .settings = b->settings,
							  .scene = &b->scene,
							  .light = b->result,
							  .format = b->format,
							  .progress = &b->progress,
							  .loaded = b->all.loaded,
							  .ranks = b->ranks };
	GW_TRY(parted_result_open(&b->all, b->error));
	GW_TRY(open_tiles(b));
	return b->ranks.rank == 0 ? ranks_wait(&b->ranks, b->error) : GW_OK;
}

/* -------------------------------------------------------------------------------- results */

/* Leaves the rows of points that stay, of `width` numbers each. */
static void keep_rows(float *values, size_t width, const uint8_t *gone, size_t count)
{
	for (size_t i = 0, kept = 0; i < count; i++)
		if (!gone[i])
			memmove(values + width * kept++, values + width * i, width * sizeof *values);
}

/* The points of grids are without those that are not to be written; returns how many stay. */
static size_t drop_strays(bake *b)
{
	const gw_bake_result *r = b->result;
	double *position = b->scene.points.position;
	size_t kept = 0;
	if (b->settings->strays != SETTINGS_STRAYS_DROP || !r->stray || !b->settings->vdb_points)
		return r->count;
	float *const triple[] = { r->radiance, r->albedo, r->normal };
	for (size_t k = 0; k < sizeof triple / sizeof *triple; k++)
		keep_rows(triple[k], 3, r->stray, r->count);
	for (size_t i = 0; i < r->count; i++)
		if (!r->stray[i])
			memmove(position + 3 * kept++, position + 3 * i, 3 * sizeof *position);
	return kept;
}

#define GRID_TEXTS 3

/* What grids say about themselves. */
static void describe_grids(const settings *s, vdb_text text[GRID_TEXTS])
{
	text[0] = (vdb_text){ "creator", "glowworm " GW_VERSION };
	text[1] = (vdb_text){ "command", s->command };
	text[2] = (vdb_text){ "units", s->units == LIGHT_UNITS_PHOTOMETRIC ? "cd/m^2" : "W/(sr m^2)" };
}

/* The radiance in free space. */
static gw_status write_harmonics(bake *b)
{
	const settings *s = b->settings;
	vdb_text text[GRID_TEXTS];
	describe_grids(s, text);
	uint64_t clamped = 0;
	const vdb_metadata metadata = { .text = text,
									.text_count = GRID_TEXTS,
									.half = s->vdb_half,
									.volume = &b->result->volume,
									.memory = s->bake.memory,
									.clamped = &clamped };
	gw_status status = vdb_write(s->vdb_sh, s->force, &b->result->voxels, &metadata, b->error);
	b->facts.vdb_clamped += clamped;
	return status;
}

static gw_status write_grids(bake *b)
{
	const settings *s = b->settings;
	vdb_text text[GRID_TEXTS];
	describe_grids(s, text);
	const vdb_points points = { .count = drop_strays(b),
								.position = b->scene.points.points.position,
								.radiance = b->result->radiance,
								.albedo = b->result->albedo,
								.normal = b->result->normal };
	vdb_metadata metadata = { .text = text,
							  .text_count = GRID_TEXTS,
							  .half = s->vdb_half,
							  .memory = s->bake.memory,
							  .points = s->vdb_points ? &points : NULL,
							  .clamped = &b->facts.vdb_clamped };
	if (!(s->vdb_voxel > 0.0f))
		return vdb_write(s->vdb, s->force, &b->result->voxels, &metadata, b->error);
	gw_voxels merged;
	gw_status status = voxel_merge(&b->result->voxels, (double)s->vdb_voxel, &merged, b->error);
	if (status == GW_OK)
		status = vdb_write(s->vdb, s->force, &merged, &metadata, b->error);
	voxel_merge_clear(&merged);
	return status;
}

/* Comments hold so many scanners, and are made with the points. */
static void note_scanners(const bake *b)
{
	if (b->format)
		output_scanners_note(b->format, &b->scene.cloud, b->settings->quiet);
}

static gw_status write_points(bake *b)
{
	if (b->settings->tiles > 0)
		return tiled_result_write(&b->tiled, b->output, &b->facts.exposure, b->error);
	if (b->parted.journal)
		return parted_result_go_on(&b->all, b->output, &b->facts.exposure, b->error);
	if (b->scene.parted)
		return parted_result_write(&b->all, b->output, &b->facts.exposure, b->error);
	GW_TRY(lit_scan_make(&b->scene, b->result, b->settings, &b->lit, &b->facts.exposure, b->error));
	if (!b->output)
		return GW_OK;
	GW_TRY(output_system_settle(b->format, &b->lit, b->settings->quiet, b->error));
	output_columns_note(b->format, &b->lit, b->settings->quiet);
	return b->format->write(b->output, &b->lit, b->error);
}

/* The outputs that appear under their names when all of them are written. */
static gw_status write_outputs(bake *b, gw_status *grids)
{
	GW_TRY(write_points(b));
	if (b->settings->vdb)
		*grids = write_grids(b);
	if (b->settings->vdb_sh && *grids == GW_OK)
		*grids = write_harmonics(b);
	if (*grids == GW_ERROR_CANCELLED)
		return GW_ERROR_CANCELLED;
	GW_TRY(signals_check(b->error));
	if (b->ranks.rank > 0)
		output_file_leave(&b->output);
	if (b->output)
		GW_TRY(output_file_commit(&b->output, b->error));
	journal_file_close(&b->parted.journal, true);
	return b->transport ? output_file_commit(&b->transport, b->error) : GW_OK;
}

static gw_status write_report(bake *b)
{
	if (!b->report)
		return GW_OK;
	GW_TRY(bake_report_write(&b->facts, b->report, b->error));
	return output_file_commit(&b->report, b->error);
}

/* What takes hours to bake is not lost with the grids: the other outputs are written. */
static gw_status write_results(bake *b)
{
	double start = now();
	gw_status grids = GW_OK;
	note_scanners(b);
	progress_show(&b->progress, "write", 1.0);
	gw_status status = write_outputs(b, &grids);
	b->facts.bake_seconds += b->tiled.seconds;
	b->facts.write_seconds = now() - start - b->tiled.seconds;
	if (status == GW_OK)
		status = write_report(b);
	progress_end(&b->progress);
	return status == GW_OK ? grids : status;
}

static gw_status light_frames(bake *b)
{
	note_scanners(b);
	const frame_outputs to = { b->format, b->report, &b->progress };
	gw_status status = frame_bake_all(&b->facts, b->settings, &b->scene, &to, b->error);
	if (status == GW_OK && b->report)
		status = output_file_commit(&b->report, b->error);
	progress_end(&b->progress);
	return status;
}

static gw_status print_scene(bake *b)
{
	settings *s = b->settings;
	char up = settings_up_axis(s->up);
	bool ask = false;
	for (size_t i = 0; i < s->light_count; i++)
		ask = ask || ((s->light[i].from_sky || s->light[i].ies[0] || s->light[i].hangs) &&
					  s->up == SETTINGS_UP_AUTO);
	for (size_t i = 0; i < s->light_count; i++)
		ask = ask || s->light[i].stand.kind || s->light[i].aim.kind;
	if (ask) {
		GW_TRY(read_inputs(b));
		GW_TRY(loaded_scene_name_places(&b->scene, s, b->error));
		up = b->scene.up;
	}
	for (size_t i = 0; i < s->light_count; i++)
		light_resolve(&s->light[i], up);
	scene_write(stdout, s);
	return GW_OK;
}

/* The first rank speaks for all. */
static gw_status join_ranks(bake *b)
{
	settings *s = b->settings;
	GW_TRY(ranks_join(&b->ranks, b->error));
	if (b->ranks.rank == 0)
		return GW_OK;
	s->quiet = true;
	s->verbose = s->explain = s->profile = false;
	s->report = NULL;
	b->progress = progress_start(SETTINGS_PROGRESS_NONE, true);
	return GW_OK;
}

/* Where points are written, by those that were read; of a parted cloud by those that were kept. */
static gw_status settle_step(bake *b)
{
	const loaded_scene *scene = &b->scene;
	return las_step_settle(b->settings,
						   &(las_step_points){ .said = &scene->cloud,
											   .points = &scene->points.points,
											   .place = &scene->place,
											   .all = scene->parted ? b->parted.file.count : 0 },
						   b->error);
}

static gw_status run(bake *b)
{
	GW_TRY(join_ranks(b));
	GW_TRY(scene_read_all(b->settings, b->error));
	quality_preset_apply(b->settings);
	bake_plan_apply_effects(b->settings);
	GW_TRY(check(b));
	if (b->settings->print_scene)
		return print_scene(b);
	GW_TRY(bake_plan_apply_motion(b->settings, b->error));
	GW_TRY(open_outputs(b));
	if (b->ranks.rank == 0)
		b->settings->bake.drivers = b->drivers = gw_drivers_load();
	GW_TRY(read_inputs(b));
	output_shift_settle_by(&b->settings->shifting, &b->scene.cloud, b->settings->quiet);
	GW_TRY(settle_step(b));
	GW_TRY(check_results(b));
	GW_TRY(loaded_scene_lights(&b->scene, b->settings, &b->light, b->error));
	if (b->settings->explain && b->settings->frame_count > 0)
		GW_TRY(explain_frames(b));
	if (b->settings->frames)
		return light_frames(b);
	GW_TRY(input_file_check(&b->reused, light_points(b), b->error));
	return write_results(b);
}

/* On standard error; fails when the bake missed what it was to reach. */
static gw_status say_results(const bake *b)
{
	const settings *s = b->settings;
	if (!s->quiet)
		bake_report_notes(&b->facts);
	if (!s->quiet)
		light_shares_print(&(light_shares){ s, &b->scene, b->result, 0 });
	if (s->verbose)
		bake_report_summary(&b->facts);
	if (!s->quiet && !b->result->report.missed)
		bake_report_error(&b->facts);
	if (s->explain && b->facts.forecast.plan)
		bake_plan_print_outcome(&b->result->report,
								b->facts.read_seconds + b->facts.bake_seconds -
									b->planned.report.forecast.own_seconds,
								stderr);
	if (s->profile)
		bake_report_profile(&b->result->report, false);
	return bake_report_goal(&b->facts, b->error);
}

/* What is done of a bake that failed is kept for the same command. Where that is wrong nothing can
 * go on with it; a run that began it has done nothing then, and leaves nothing behind. */
static void settle_what_is_kept(bake *b, gw_status failed)
{
	bool wrong = failed == GW_ERROR_USAGE || failed == GW_ERROR_DATA;
	if (!b->settings->resume || !b->parted.journal || !b->output)
		return;
	if (failed == GW_ERROR_USAGE && !b->parted.begun && b->ranks.rank == 0) {
		unlink(output_file_temporary(b->output));
		journal_file_close(&b->parted.journal, true);
	} else if (!wrong && !b->settings->quiet) {
		text_message(
			stderr,
			"glowworm: note: what is done is kept in %s%s%s and %s; the same command goes on "
			"with it\n",
			output_file_temporary(b->output), b->tiled.file.out ? ", " : "",
			b->tiled.file.out ? output_file_temporary(b->tiled.file.out) : "",
			journal_file_name(b->parted.journal));
	}
}

gw_status verb_bake(settings *s, gw_error *error)
{
	bake b = { .settings = s,
			   .progress = progress_start((settings_progress)s->progress, s->quiet),
			   .error = error };
	b.facts = (bake_facts){ .settings = s, .scene = &b.scene };
	gw_status status = run(&b);
	progress_end(&b.progress);
	if (status == GW_OK && b.result && b.ranks.rank == 0)
		status = say_results(&b);
	status = ranks_fail(&b.ranks, status, error);
	settle_what_is_kept(&b, status);
	journal_file_close(&b.parted.journal, false);
	output_file_abandon(&b.output);
	output_file_abandon(&b.report);
	output_file_abandon(&b.transport);
	input_file_close(&b.reused);
	s->bake.drivers = NULL;
	gw_drivers_release(&b.drivers);
	tiled_result_close(&b.tiled);
	parted_result_close(&b.all);
	gw_bake_result_destroy(&b.result);
	region_points_clear(&b.region);
	loaded_scene_clear(&b.scene);
	parted_cloud_close(&b.parted);
	scan_clear(&b.lit);
	free(b.light);
	return status;
}

/* parted_cloud.c - see parted_cloud.h. */
#include "scene/parted_cloud.h"

#include "glowworm_host.h"
#include "glowworm_parts.h"
#include "options/output_name.h"
#include "points/scan_bytes.h"
#include "points/scan_thinning.h"
#include "program/signals.h"

#include <stdlib.h>
#include <string.h>

/* Points that are read at once: such that some parts are there of small clouds too, for those who
 * go on where others ended. */
#define PART_LEAST ((size_t)1 << 14)
#define PART_MOST ((size_t)1 << 18)
#define PARTS_WANTED 16u

/* Bytes of a point that is kept where gw_bake cannot make the surface of fewer: of tiles, and of
 * what a transport is of; and of the program and its driver. */
#define LASTING_BYTES 1270u
#define LASTING_FIXED_BYTES (UINT64_C(264) << 20)

/* Of the program and its driver where a cloud is only looked at. */
#define LOOK_FIXED_BYTES (UINT64_C(64) << 20)

#define KEPT_MOST ((uint64_t)1 << 30)

/* Whether results can be written one part after the other: LAZ goes to files only, and rows of text
 * have no places that are known. */
static bool can_be_written(const settings *s, const format *output)
{
	return s->output && output_name_takes_parts(s->output, output) && !output->parted->any_length;
}

/* Whether what is asked for needs no more than one point after the other. */
static bool asks_for_points_alone(const settings *s)
{
	return !s->vdb_points && !s->region && s->frame_count == 0 && s->path_count == 0 &&
		   s->strays != SETTINGS_STRAYS_DROP && s->points.albedo != SCAN_ALBEDO_INTENSITY;
}

/* Whether one file has all points, as they are. */
static bool is_one_file(const settings *s)
{
	const settings_input *from = s->input;
	return s->input_count == 1 && !from->has_matrix && !from->mesh && !s->columns;
}

/* How many bytes a bake may take in all. */
static uint64_t memory_for(const settings *s)
{
	uint64_t available = gw_available_memory();
	if (s->bake.memory > 0)
		return s->bake.memory;
	return available > 0 ? available / 4 * 3 + gw_resident_memory() : UINT64_MAX;
}

static uint64_t lasting_points(uint64_t memory)
{
	return memory > LASTING_FIXED_BYTES ? (memory - LASTING_FIXED_BYTES) / LASTING_BYTES : 0;
}

/* 0: all, or too few to mean anything. */
static size_t kept_of(uint64_t fit, uint64_t memory, uint64_t count)
{
	if (memory == UINT64_MAX || count <= fit || fit < PARTED_CLOUD_LEAST)
		return 0;
	return (size_t)(fit < KEPT_MOST ? fit : KEPT_MOST);
}

/* Where all points are lit by tiles: of what memory holds, half is kept of the whole cloud, though
 * no more than an eighth of it. When that is lit it takes but a tenth, and what is far from a tile
 * less than half of it (far_points.h): so half is a tile's. */
static void share_memory(parted_cloud *parted, uint64_t memory)
{
	uint64_t count = parted->file.count, fit = lasting_points(memory);
	if (count <= PARTED_CLOUD_LEAST)
		return;
	if (fit < PARTED_CLOUD_LEAST) {
		parted->memory_wanted = LASTING_FIXED_BYTES + LASTING_BYTES * (uint64_t)PARTED_CLOUD_LEAST;
		return;
	}
	uint64_t all = fit < KEPT_MOST ? fit : KEPT_MOST;
	uint64_t kept = all / 2 < count / 8 ? all / 2 : count / 8;
	parted->most = (size_t)(kept > PARTED_CLOUD_LEAST ? kept : PARTED_CLOUD_LEAST);
	parted->tile = (size_t)(all / 2);
}

/* Whether points of the file have some columns; the first ones tell. */
static gw_status find_columns(parted_cloud *parted, const char *const *name, size_t count,
							  bool *found, gw_error *error)
{
	scan some;
	GW_TRY(format_parts_read(&parted->file, 0, 1, &some, error));
	*found = true;
	for (size_t i = 0; i < count; i++)
		*found = *found && scan_find_scalar(&some, name[i]) != NULL;
	scan_clear(&some);
	return GW_OK;
}

/* How many points are to be kept where all of them make the surface. */
static gw_status choose_most(parted_cloud *parted, const settings *s, gw_error *error)
{
	static const char *const normal[3] = { "nx", "ny", "nz" };
	uint64_t memory = memory_for(s), count = parted->file.count, fit;
	bool normals, lamps = false;
	/* Then nothing has to be read. */
	if (!s->save_transport && gw_points_in_memory(memory, false, true, &s->bake) >= count)
		return GW_OK;
	GW_TRY(find_columns(parted, normal, 3, &normals, error));
	for (size_t i = 0; i < s->light_count; i++)
		lamps |= s->light[i].light.type != GW_LIGHT_ENVIRONMENT;
	fit = s->save_transport ? lasting_points(memory)
							: gw_points_in_memory(memory, normals, lamps, &s->bake);
	parted->most = kept_of(fit, memory, count);
	return GW_OK;
}

/* About so many points, such that what is read at once is in one part. */
static uint64_t whole_groups(const parted_cloud *parted, uint64_t part)
{
	uint64_t together = parted->file.together;
	return part > together ? part / together * together : together;
}

/* Opens what can be read in parts: one file, or what is gathered of several; nothing is found where
 * there is none. */
static gw_status open_file(const settings *s, const gathered_cloud_use *use, parted_cloud *parted,
						   gw_error *error)
{
	const format_options options = { s->format, s->columns, s->bake.threads };
	if (!asks_for_points_alone(s))
		return GW_OK;
	if (is_one_file(s))
		GW_TRY(format_parts_open(s->input[0].path, &options, &parted->file, error));
	if (!parted->file.found) {
		format_parts_close(&parted->file);
		GW_TRY(gathered_cloud_make(s, use, &parted->file, &parted->input, error));
	}
	if (!parted->file.found)
		return GW_OK;
	uint64_t part = parted->file.count / PARTS_WANTED;
	part = part < PART_LEAST ? PART_LEAST : part < PART_MOST ? part : PART_MOST;
	parted->part = (size_t)whole_groups(parted, part);
	return GW_OK;
}

static bool is_open(const parted_cloud *parted)
{
	return parted->file.found && parted->file.together <= PART_MOST;
}

static gw_status open_to_bake(const settings *s, const uint64_t *kept, parted_cloud *parted,
							  gw_error *error)
{
	uint64_t memory = memory_for(s);
	const gathered_cloud_use use = { .output = s->output,
									 .memory = memory,
									 .fit = gw_points_in_memory(memory, false, true, &s->bake),
									 .always = s->tiles > 0 || (kept && *kept > 0) };
	GW_TRY(open_file(s, &use, parted, error));
	if (!is_open(parted))
		return GW_OK;
	if (s->tiles > 0)
		share_memory(parted, memory);
	else if (kept)
		parted->most = (size_t)*kept;
	else
		return choose_most(parted, s, error);
	return GW_OK;
}

gw_status parted_cloud_open(const settings *s, const format *output, const uint64_t *kept,
							parted_cloud *parted, gw_error *error)
{
	*parted = (parted_cloud){ .format = output };
	return can_be_written(s, output) ? open_to_bake(s, kept, parted, error) : GW_OK;
}

gw_status parted_cloud_open_to_plan(const settings *s, const format *output, parted_cloud *parted,
									gw_error *error)
{
	*parted = (parted_cloud){ .format = output };
	return !s->output || can_be_written(s, output) ? open_to_bake(s, NULL, parted, error) : GW_OK;
}

gw_status parted_cloud_open_to_look(const settings *s, const parted_cloud_look *look,
									parted_cloud *parted, gw_error *error)
{
	bool column = false;
	uint64_t memory = memory_for(s);
	uint64_t left = memory > LOOK_FIXED_BYTES ? memory - LOOK_FIXED_BYTES : 0;
	const gathered_cloud_use use = { .output = s->output,
									 .memory = memory,
									 .fit = left / look->bytes };
	*parted = (parted_cloud){ .most = 0 };
	GW_TRY(open_file(s, &use, parted, error));
	if (!is_open(parted))
		return GW_OK;
	uint64_t count = parted->file.count;
	if (look->column && parted->file.count > 0)
		GW_TRY(find_columns(parted, &look->column, 1, &column, error));
	uint64_t bytes = column ? look->column_bytes : look->bytes;
	parted->most = kept_of(left / bytes, memory, count);
	return GW_OK;
}

gw_status parted_cloud_keep(parted_cloud *parted, const settings *s, const bake_journal_use *use,
							gw_error *error)
{
	bake_journal journal = { .most = parted->most };
	GW_TRY(bake_journal_open(use, s, &parted->file, &journal, error));
	parted->journal = journal.file;
	parted->most = journal.most;
	parted->begun = journal.begun;
	return GW_OK;
}

static gw_status read_points(parted_cloud *parted, uint64_t first, size_t count, scan *cloud,
							 gw_error *error)
{
	return format_parts_read(&parted->file, first, count, cloud, error);
}

static gw_status thin(parted_cloud *parted, scan_thinning *thinning, gw_error *error)
{
	size_t step = (size_t)whole_groups(parted, PART_MOST);
	for (uint64_t first = 0; first < parted->file.count; first += step) {
		scan part;
		GW_TRY(read_points(parted, first, step, &part, error));
		gw_status status = scan_thinning_add(thinning, &part, error);
		scan_clear(&part);
		GW_TRY(status);
		GW_TRY(signals_check(error));
	}
	return GW_OK;
}

/* Reads the file once. */
static gw_status choose(parted_cloud *parted, scan *cloud, gw_error *error)
{
	scan_thinning thinning = scan_thinning_begin(parted->most, parted->file.in.threads);
	gw_status status = thin(parted, &thinning, error);
	if (status == GW_OK)
		scan_thinning_take(&thinning, cloud);
	scan_thinning_clear(&thinning);
	if (status == GW_OK && cloud->count == 0)
		status = gw_fail(error, GW_ERROR_DATA, "%s has no point whose place is finite",
						 parted->file.in.name);
	return status == GW_OK ? format_parts_settle(&parted->file, cloud, error) : status;
}

/* The same, or what the journal has of it. */
static gw_status choose_or_load(parted_cloud *parted, scan *cloud, gw_error *error)
{
	journal_file *journal = parted->journal;
	const gw_byte_sink to = { journal_file_write, journal };
	const gw_byte_source from = { journal_file_read, journal };
	bool there;
	GW_TRY(journal_file_begin(journal, BAKE_JOURNAL_KEPT, &there, error));
	GW_TRY(there ? scan_bytes_load(&from, cloud, error) : choose(parted, cloud, error));
	if (!there)
		GW_TRY(scan_bytes_save(cloud, &to, error));
	return journal_file_end(journal, error);
}

gw_status parted_cloud_thin(parted_cloud *parted, scan *cloud, gw_error *error)
{
	*cloud = (scan){ 0 };
	gw_status status =
		parted->journal ? choose_or_load(parted, cloud, error) : choose(parted, cloud, error);
	if (status == GW_OK)
		status = format_parts_follow(&parted->file, cloud, error);
	if (status == GW_OK)
		status = scan_told_find(cloud, &parted->told, error);
	if (status != GW_OK)
		scan_clear(cloud);
	return status;
}

gw_status parted_cloud_survey(parted_cloud *parted, const char *output, gw_error *error)
{
	const format_survey_use use = { parted->format, (size_t)whole_groups(parted, PART_MOST),
									signals_check };
	parted->whole.name = output;
	return format_parts_survey(&parted->file, &use, &parted->whole, error);
}

uint64_t parted_cloud_parts(const parted_cloud *parted)
{
	return (parted->file.count + parted->part - 1) / parted->part;
}

gw_status parted_cloud_read(parted_cloud *parted, uint64_t part, scan *cloud, gw_error *error)
{
	return read_points(parted, part * parted->part, parted->part, cloud, error);
}

void parted_cloud_close(parted_cloud *parted)
{
	format_whole_clear(parted->format, &parted->whole);
	format_parts_close(&parted->file);
	free(parted->input);
	*parted = (parted_cloud){ .most = 0 };
}

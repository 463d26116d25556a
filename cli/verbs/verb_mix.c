#include "verbs/verbs.h"
#include "scene/file_roles.h"
#include "scene/stream_roles.h"
#include "program/signals.h"
#include "result/bake_columns.h"
#include "result/light_mix.h"
#include "result/las_step.h"
#include "result/parted_copy.h"
#include "scene/loaded_scene.h"
#include "glowworm_host.h"
#include "files/number_text.h"
#include "files/output_file.h"
#include "options/output_name.h"
#include "options/output_scanners.h"
#include "options/output_columns.h"
#include "options/output_system.h"
#include "options/preview.h"
#include "options/progress.h"
#include "points/scan_color.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* All that lives as long as one mix. */
typedef struct mixing {
	settings *settings; /* a copy, nothing of which is freed */
	const format *format;
	output_file *output;
	parted_copy copy; /* where points are mixed part by part */
	light_mix mix;
	preview_meter meter;
	output_shift shift;
	double exposure;         /* of the preview */
	unsigned passed, passes; /* how often all parts were read, and will be */
	progress progress;
	gw_error *error;
} mixing;

/* A cloud, or a part of one, and its light. */
typedef struct mixed_part {
	scan cloud;
	float *radiance; /* 3 * cloud.count, after mixing */
} mixed_part;

/* What is done with a part that is mixed. */
typedef gw_status mix_use(mixing *m, mixed_part *part);

static gw_status check(mixing *m)
{
	const settings *s = m->settings;
	if (s->input_count != 1)
		return gw_fail(m->error, GW_ERROR_USAGE, "mix what? Name one lit cloud, or -");
	if (s->gain_count == 0)
		return gw_fail(m->error, GW_ERROR_USAGE,
					   "change which lamp? Give --gain NAME=FACTOR, such as --gain lamp=2, or "
					   "--group NAME=FACTOR");
	if (!s->output)
		return gw_fail(m->error, GW_ERROR_USAGE,
					   "where to write? Give -o FILE, or -o - for standard output");
	GW_TRY(stream_roles_check_outputs(&(stream_output){ "--output", s->output, "points are" }, 1,
									  m->error));
	GW_TRY(file_roles_check(VERB_MIX, s, NULL, m->error));
	GW_TRY(output_name_format(s->output, s->output_format, &m->format, m->error));
	GW_TRY(output_name_check_rounding(m->format, s, s->output, m->error));
	return output_shift_read(s->shift, m->format, &m->shift, m->error);
}

/* ------------------------------------------------------------------------------------- preview */

/* Colours that are the surface's own stay; those of a bake are a preview of its light. */
static bool wants_preview(const mixing *m, const scan *cloud)
{
	return m->settings->colors == 0 && (scan_find(cloud, "albedo_r") || !scan_find(cloud, "red"));
}

/* One column of the preview, of bytes. */
static uint8_t *find_color(const mixing *m, scan *cloud, const char *name)
{
	scan_column *column = scan_find(cloud, name);
	if (column && column->type != SCAN_UINT8) {
		scan_remove_column(cloud, name);
		column = NULL;
	}
	if (!column)
		column = scan_add_column(cloud, name, SCAN_UINT8, m->error);
	return column ? column->data : NULL;
}

static gw_status make_preview(const mixing *m, mixed_part *part)
{
	double scale = preview_scale(m->exposure);
	uint8_t *data[3];
	for (int k = 0; k < 3; k++) {
		data[k] = find_color(m, &part->cloud, scan_color_names[k]);
		if (!data[k])
			return GW_ERROR_MEMORY;
	}
	for (size_t i = 0; i < part->cloud.count; i++) {
		uint8_t rgb[3];
		preview_color(part->radiance + 3 * i, scale, rgb);
		for (int k = 0; k < 3; k++)
			data[k][i] = rgb[k];
	}
	char text[128], number[NUMBER_TEXT];
	number_print_float(number, (float)m->exposure);
	snprintf(text, sizeof text, "glowworm preview of the mix: EV %s", number);
	return scan_add_comment(&part->cloud, text, m->error);
}

/* Whether the light of all points has to be known before the first can be written. */
static bool meters(const mixing *m, const scan *cloud)
{
	return wants_preview(m, cloud) && isnan(m->settings->exposure);
}

/* -------------------------------------------------------------------------------------- parts */

/* What the bake said of its preview and its error is not so any more. */
static void drop_comments(scan *cloud)
{
	static const char *const stale[] = { "glowworm preview", "glowworm estimated error" };
	size_t kept = 0;
	for (size_t c = 0; c < cloud->comment_count; c++) {
		bool drop = false;
		for (size_t i = 0; i < sizeof stale / sizeof *stale; i++)
			drop = drop || strncmp(cloud->comment[c], stale[i], strlen(stale[i])) == 0;
		if (drop)
			free(cloud->comment[c]);
		else
			cloud->comment[kept++] = cloud->comment[c];
	}
	cloud->comment_count = kept;
}

/* The header says how the light was changed, after all that was done before. */
static gw_status add_command(const mixing *m, scan *cloud)
{
	char *text;
	if (asprintf(&text, "glowworm mixed: %s", m->settings->command) < 0)
		return gw_fail(m->error, GW_ERROR_MEMORY, "no memory for a comment line");
	gw_status status = scan_add_comment(cloud, text, m->error);
	free(text);
	return status;
}

/* Says of which input it is that something is wrong with. */
static gw_status name_input(const mixing *m, gw_status status, const gw_error *reason)
{
	const char *name = loaded_scene_input_name(m->settings->input[0].path);
	return status == GW_OK ? GW_OK : gw_fail(m->error, status, "%s: %.900s", name, reason->text);
}

static gw_status mix_part(mixing *m, mixed_part *part)
{
	gw_error reason = { 0 };
	gw_status status = light_mix_apply(&m->mix, &part->cloud, &part->radiance, &reason);
	return name_input(m, status, &reason);
}

static gw_status check_mix(const mixing *m)
{
	gw_error reason = { 0 };
	gw_status status = light_mix_check(&m->mix, &reason);
	return name_input(m, status, &reason);
}

/* To be done when the exposure is known. */
static gw_status finish_part(const mixing *m, mixed_part *part)
{
	drop_comments(&part->cloud);
	GW_TRY(add_command(m, &part->cloud));
	if (wants_preview(m, &part->cloud))
		GW_TRY(make_preview(m, part));
	bake_columns_round(&part->cloud, m->settings);
	return output_shift_apply(&m->shift, &part->cloud, m->error);
}

static void clear_part(mixed_part *part)
{
	scan_clear(&part->cloud);
	free(part->radiance);
}

/* ----------------------------------------------------------------------------------- one by one */

/* Whether the input is read in parts, more than once, and the output written so. */
static gw_status open_parts(mixing *m, bool *parted)
{
	const settings *s = m->settings;
	const format_options options = { s->format, NULL, s->bake.threads };
	m->copy = (parted_copy){ .settings = s,
							 .path = s->output,
							 .format = m->format,
							 .output = m->output,
							 .shift = &m->shift };
	GW_TRY(parted_copy_open(&m->copy, &options, parted, m->error));
	return *parted ? parted_copy_settle(&m->copy, parted, m->error) : GW_OK;
}

static gw_status use_part(mixing *m, uint64_t first, mix_use *use)
{
	mixed_part part = { .radiance = NULL };
	gw_status status = parted_copy_read(&m->copy, first, &part.cloud, m->error);
	if (status == GW_OK)
		status = mix_part(m, &part);
	if (status == GW_OK)
		status = use(m, &part);
	clear_part(&part);
	return status == GW_OK ? signals_check(m->error) : status;
}

/* Mixes part after part. */
static gw_status use_parts(mixing *m, mix_use *use)
{
	uint64_t count = m->copy.parts.count;
	m->mix.points = 0;
	for (uint64_t first = 0; first < count; first += m->copy.step) {
		double done = (double)first / (double)count;
		progress_show(&m->progress, "mix", (m->passed + done) / m->passes);
		GW_TRY(use_part(m, first, use));
	}
	m->passed++;
	GW_TRY(check_mix(m));
	m->mix.adds_up = true;
	return GW_OK;
}

static gw_status add_light(mixing *m, mixed_part *part)
{
	preview_meter_add(&m->meter, part->radiance, NULL, part->cloud.count);
	return GW_OK;
}

static gw_status look_at_light(mixing *m, mixed_part *part)
{
	preview_meter_look(&m->meter, part->radiance, NULL, part->cloud.count);
	return GW_OK;
}

static gw_status write_part(mixing *m, mixed_part *part)
{
	GW_TRY(finish_part(m, part));
	return parted_copy_write(&m->copy, &part->cloud, m->error);
}

static gw_status mix_parts(mixing *m)
{
	GW_TRY(las_step_settle(m->settings, &(las_step_points){ .said = &m->copy.told }, m->error));
	GW_TRY(parted_copy_check_step(&m->copy, m->error));
	parted_copy_settle_shift(&m->copy);
	m->exposure = meters(m, &m->copy.told) ? NAN : (double)m->settings->exposure;
	m->passes = isnan(m->exposure) ? 3 : 1;
	if (isnan(m->exposure)) {
		GW_TRY(use_parts(m, add_light));
		GW_TRY(use_parts(m, look_at_light));
		m->exposure = preview_meter_exposure(&m->meter);
	}
	GW_TRY(use_parts(m, write_part));
	return parted_copy_end(&m->copy, m->error);
}

/* ------------------------------------------------------------------------------ all at once */

static gw_status mix_whole(mixing *m)
{
	const settings *s = m->settings;
	mixed_part all = { .radiance = NULL };
	gw_status status = format_read(s->input[0].path, s->format, &all.cloud, m->error);
	if (status == GW_OK)
		status = mix_part(m, &all);
	if (status == GW_OK)
		status = check_mix(m);
	if (status == GW_OK)
		m->exposure = meters(m, &all.cloud) ? preview_exposure(all.radiance, NULL, all.cloud.count)
											: (double)s->exposure;
	if (status == GW_OK)
		status = las_step_settle(m->settings, &(las_step_points){ .said = &all.cloud }, m->error);
	if (status == GW_OK)
		status = output_system_check_step(s, &all.cloud, NULL, NULL, m->error);
	if (status == GW_OK)
		status = output_scanners_settle(m->format, &all.cloud, s->quiet, m->error);
	if (status == GW_OK) {
		output_shift_settle_by(&m->shift, &all.cloud, s->quiet);
		status = finish_part(m, &all);
	}
	if (status == GW_OK)
		status = output_system_settle(m->format, &all.cloud, s->quiet, m->error);
	if (status == GW_OK) {
		output_columns_note(m->format, &all.cloud, s->quiet);
		status = m->format->write(m->output, &all.cloud, m->error);
	}
	clear_part(&all);
	return status;
}

static gw_status run(mixing *m)
{
	const settings *s = m->settings;
	bool parted;
	GW_TRY(check(m));
	GW_TRY(output_file_create(&m->output, s->output, s->force, m->error));
	output_file_use_threads(m->output, s->bake.threads);
	GW_TRY(open_parts(m, &parted));
	GW_TRY(parted ? mix_parts(m) : mix_whole(m));
	progress_clear(&m->progress);
	if (m->mix.removed > 0 && !s->quiet)
		fprintf(stderr,
				"glowworm: note: columns that do not say which lamp their light comes from are "
				"left out: %zu\n",
				m->mix.removed);
	return output_file_commit(&m->output, m->error);
}

gw_status verb_mix(const settings *s, gw_error *error)
{
	settings own = *s;
	mixing m = { .settings = &own,
				 .mix = { .gain = s->gain, .gain_count = s->gain_count },
				 .progress = progress_start((settings_progress)s->progress, s->quiet),
				 .error = error };
	gw_status status = run(&m);
	progress_end(&m.progress);
	parted_copy_close(&m.copy);
	output_file_abandon(&m.output);
	return status;
}

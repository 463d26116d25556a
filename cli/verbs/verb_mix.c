#include "verbs/verbs.h"
#include "scene/file_roles.h"
#include "scene/stream_roles.h"
#include "result/light_mix.h"
#include "scene/loaded_scene.h"
#include "files/number_text.h"
#include "files/output_file.h"
#include "options/output_name.h"
#include "options/preview.h"
#include "points/scan_color.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* All that lives as long as one mix. */
typedef struct mixing {
	const settings *settings;
	const format *format;
	output_file *output;
	scan cloud;
	float *radiance;
	size_t removed; /* columns that would have become wrong */
	gw_error *error;
} mixing;

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
	return output_name_format(s->output, s->output_format, &m->format, m->error);
}

/* Colours that are the surface's own stay; those of a bake are a preview of its light. */
static bool wants_preview(const mixing *m)
{
	return m->settings->colors == 0 &&
		   (scan_find(&m->cloud, "albedo_r") || !scan_find(&m->cloud, "red"));
}

/* One column of the preview, of bytes. */
static uint8_t *find_color(mixing *m, const char *name)
{
	scan_column *column = scan_find(&m->cloud, name);
	if (column && column->type != SCAN_UINT8) {
		scan_remove_column(&m->cloud, name);
		column = NULL;
	}
	if (!column)
		column = scan_add_column(&m->cloud, name, SCAN_UINT8, m->error);
	return column ? column->data : NULL;
}

static gw_status make_preview(mixing *m)
{
	const settings *s = m->settings;
	double exposure = isnan(s->exposure) ? preview_exposure(m->radiance, NULL, m->cloud.count)
										 : (double)s->exposure;
	double scale = preview_scale(exposure);
	uint8_t *data[3];
	for (int k = 0; k < 3; k++) {
		data[k] = find_color(m, scan_color_names[k]);
		if (!data[k])
			return GW_ERROR_MEMORY;
	}
	for (size_t i = 0; i < m->cloud.count; i++) {
		uint8_t rgb[3];
		preview_color(m->radiance + 3 * i, scale, rgb);
		for (int k = 0; k < 3; k++)
			data[k][i] = rgb[k];
	}
	char text[128], number[NUMBER_TEXT];
	number_print_float(number, (float)exposure);
	snprintf(text, sizeof text, "glowworm preview of the mix: EV %s", number);
	return scan_add_comment(&m->cloud, text, m->error);
}

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
static gw_status add_command(mixing *m)
{
	char *text;
	if (asprintf(&text, "glowworm mixed: %s", m->settings->command) < 0)
		return gw_fail(m->error, GW_ERROR_MEMORY, "no memory for a comment line");
	gw_status status = scan_add_comment(&m->cloud, text, m->error);
	free(text);
	return status;
}

static gw_status mix_cloud(mixing *m)
{
	const settings *s = m->settings;
	gw_error reason = { 0 };
	const char *name = loaded_scene_input_name(s->input[0].path);
	GW_TRY(format_read(s->input[0].path, s->format, &m->cloud, m->error));
	gw_status status =
		light_mix_apply(&m->cloud, s->gain, s->gain_count, &m->radiance, &m->removed, &reason);
	if (status != GW_OK)
		return gw_fail(m->error, status, "%s: %.900s", name, reason.text);
	if (m->removed > 0 && !s->quiet)
		fprintf(stderr,
				"glowworm: note: columns that do not say which lamp their light comes from are "
				"left out: %zu\n",
				m->removed);
	drop_comments(&m->cloud);
	status = add_command(m);
	if (status == GW_OK && wants_preview(m))
		status = make_preview(m);
	return status;
}

static gw_status run(mixing *m)
{
	const settings *s = m->settings;
	GW_TRY(check(m));
	GW_TRY(output_file_create(&m->output, s->output, s->force, m->error));
	GW_TRY(mix_cloud(m));
	GW_TRY(m->format->write(m->output, &m->cloud, m->error));
	return output_file_commit(&m->output, m->error);
}

gw_status verb_mix(const settings *s, gw_error *error)
{
	mixing m = { .settings = s, .error = error };
	gw_status status = run(&m);
	output_file_abandon(&m.output);
	scan_clear(&m.cloud);
	free(m.radiance);
	return status;
}

#include "verbs/verbs.h"
#include "scene/file_roles.h"
#include "scene/stream_roles.h"
#include "scene/loaded_scene.h"
#include "files/output_file.h"
#include "options/output_name.h"
#include "comparison/worst_scan.h"

#include <stdlib.h>
#include <string.h>

/* All that lives as long as one comparison. */
typedef struct comparison {
	const settings *settings;
	const format *format; /* of the worst points */
	output_file *worst, *json;
	scan found, truth;
	matched_scans match;
	compare_figures figures;
	gw_error *error;
} comparison;

static gw_status check_outputs(comparison *c)
{
	const settings *s = c->settings;
	const stream_output out[] = { { "--worst", s->worst, "points are" },
								  { "--json", s->json_file, NULL } };
	GW_TRY(stream_roles_check_outputs(out, sizeof out / sizeof *out, c->error));
	gw_status status = file_roles_check(VERB_COMPARE, s, NULL, c->error);
	return status == GW_OK && s->worst ? output_name_format(s->worst, NULL, &c->format, c->error)
									   : status;
}

static gw_status check(comparison *c)
{
	const settings *s = c->settings;
	if (s->input_count != 2)
		return gw_fail(c->error, GW_ERROR_USAGE,
					   "compare what? Name two lit clouds: the result, then the truth");
	if (stream_roles_inputs(s) > 1)
		return gw_fail(c->error, GW_ERROR_USAGE, "standard input can be read once, not twice");
	return check_outputs(c);
}

static gw_status open_outputs(comparison *c)
{
	const settings *s = c->settings;
	if (s->worst)
		GW_TRY(output_file_create(&c->worst, s->worst, s->force, c->error));
	if (c->worst)
		output_file_use_threads(c->worst, s->bake.threads);
	if (s->json_file)
		GW_TRY(output_file_create(&c->json, s->json_file, s->force, c->error));
	return GW_OK;
}

static gw_status read_clouds(comparison *c)
{
	const settings *s = c->settings;
	format_options options = { s->format, s->columns, s->bake.threads };
	GW_TRY(format_read_with(s->input[0].path, &options, &c->found, NULL, c->error));
	return format_read_with(s->input[1].path, &options, &c->truth, NULL, c->error);
}

static gw_status write_worst(comparison *c)
{
	scan worst;
	gw_status status = worst_scan_make(&c->figures, c->settings->worst_count, &worst, c->error);
	if (status == GW_OK)
		status = c->format->write(c->worst, &worst, c->error);
	scan_clear(&worst);
	return status == GW_OK ? output_file_commit(&c->worst, c->error) : status;
}

static gw_status write_json(comparison *c, bool missed)
{
	char *text = NULL;
	size_t length;
	FILE *out = open_memstream(&text, &length);
	if (out)
		compare_figures_json(&c->figures, missed, out);
	gw_status status = GW_OK;
	if (!out || fclose(out) != 0)
		status = gw_fail(c->error, GW_ERROR_MEMORY, "no memory for the figures as JSON");
	if (status == GW_OK)
		status = output_file_write(c->json, text, length, c->error);
	free(text);
	return status == GW_OK ? output_file_commit(&c->json, c->error) : status;
}

/* Everything is written before a limit that is missed becomes an error. */
static gw_status show(comparison *c)
{
	gw_error reason = { 0 };
	const settings *s = c->settings;
	gw_status limits = compare_figures_check(&c->figures, s, &reason);
	if (!stream_roles_standard(s->json_file))
		compare_figures_print(&c->figures, stream_roles_standard(s->worst) ? stderr : stdout);
	if (s->worst)
		GW_TRY(write_worst(c));
	if (s->json_file)
		GW_TRY(write_json(c, limits != GW_OK));
	return limits == GW_OK ? GW_OK : gw_fail(c->error, limits, "%s", reason.text);
}

static gw_status run(comparison *c)
{
	const settings *s = c->settings;
	GW_TRY(check(c));
	GW_TRY(open_outputs(c));
	GW_TRY(read_clouds(c));
	c->match = (matched_scans){ .found = &c->found,
								.truth = &c->truth,
								.found_name = loaded_scene_input_name(s->input[0].path),
								.truth_name = loaded_scene_input_name(s->input[1].path) };
	GW_TRY(matched_scans_make(&c->match, c->error));
	GW_TRY(compare_figures_make(&c->match, &c->figures, c->error));
	return show(c);
}

gw_status verb_compare(const settings *s, gw_error *error)
{
	comparison c = { .settings = s, .error = error };
	gw_status status = run(&c);
	output_file_abandon(&c.worst);
	output_file_abandon(&c.json);
	compare_figures_clear(&c.figures);
	matched_scans_clear(&c.match);
	scan_clear(&c.found);
	scan_clear(&c.truth);
	return status;
}

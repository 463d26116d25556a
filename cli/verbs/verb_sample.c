#include "verbs/verbs.h"
#include "glowworm_host.h"
#include "scene/file_roles.h"
#include "scene/stream_roles.h"
#include "scene/loaded_scene.h"
#include "scene/mesh_notes.h"
#include "options/options.h"
#include "files/output_file.h"
#include "options/output_name.h"
#include "scene/scene_file.h"
#include "program/signals.h"
#include "program/text_quote.h"
#include "meshes/mesh_reader.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static bool is_given(const settings *s, const char *name)
{
	const option *o = option_find(VERB_SAMPLE, name, strlen(name));
	return s->given[o - options] == SETTINGS_BY_COMMAND;
}

static gw_status check(const settings *s, const format **to, gw_error *error)
{
	if (s->input_count != 1)
		return gw_fail(error, GW_ERROR_USAGE,
					   "name one mesh to sample, not %zu; - is standard input", s->input_count);
	if (scene_is_file(s->input[0].path))
		return gw_fail(error, GW_ERROR_USAGE,
					   "%s is a scene; bake samples the meshes of a scene by itself",
					   s->input[0].path);
	if (is_given(s, "count") && s->density > 0.0f)
		return gw_fail(error, GW_ERROR_USAGE, "give --density or --count, not both");
	if (!s->output)
		return gw_fail(error, GW_ERROR_USAGE,
					   "where to write? Give -o FILE, or -o - for standard output");
	GW_TRY(
		stream_roles_check_outputs(&(stream_output){ "--output", s->output, "this is" }, 1, error));
	GW_TRY(file_roles_check(VERB_SAMPLE, s, NULL, error));
	return output_name_format(s->output, s->output_format, to, error);
}

/* Points for the density, or as many as were asked for. */
static gw_status find_count(const settings *s, const mesh *m, const char *name, uint64_t *count,
							gw_error *error)
{
	*count = s->count;
	return s->density > 0.0f ? loaded_scene_mesh_count(m, (double)s->density, name, count, error)
							 : GW_OK;
}

/* Not "glowworm ...": that would mark a lit cloud. */
static gw_status add_comment(const settings *s, scan *cloud, gw_error *error)
{
	char text[1024];
	snprintf(text, sizeof text, "sampled by glowworm " GW_VERSION ": %.900s", s->command);
	return scan_add_comment(cloud, text, error);
}

static void print_summary(const mesh *m, const char *name, uint64_t count)
{
	text_message(stderr,
				 "glowworm: %s: %zu faces, %zu triangles, %zu materials, %s m^2; %llu points, "
				 "%s a square metre\n",
				 name, m->faces, m->triangle_count, m->material_count, GW_SAID(m->area, 6),
				 (unsigned long long)count, GW_SAID((double)count / m->area, 6));
}

static gw_status sample(const settings *s, mesh *m, scan *cloud, gw_error *error)
{
	const char *path = s->input[0].path, *name = loaded_scene_input_name(path);
	uint64_t count = 0;
	GW_TRY(mesh_read(path, m, error));
	GW_TRY(mesh_measure(m, name, error));
	GW_TRY(find_count(s, m, name, &count, error));
	GW_TRY(mesh_sample(m, count, s->bake.seed, s->bake.threads, cloud, error));
	GW_TRY(add_comment(s, cloud, error));
	if (!s->quiet)
		mesh_notes_print(m, name, false);
	if (s->verbose)
		print_summary(m, name, count);
	return GW_OK;
}

static gw_status run(const settings *s, mesh *m, scan *cloud, output_file **output, gw_error *error)
{
	const format *to = NULL;
	GW_TRY(check(s, &to, error));
	GW_TRY(output_file_create(output, s->output, s->force, error));
	output_file_use_threads(*output, s->bake.threads);
	GW_TRY(sample(s, m, cloud, error));
	GW_TRY(signals_check(error));
	GW_TRY(to->write(*output, cloud, error));
	GW_TRY(signals_check(error));
	return output_file_commit(output, error);
}

gw_status verb_sample(const settings *s, gw_error *error)
{
	output_file *output = NULL;
	mesh m = { 0 };
	scan cloud = { 0 };
	gw_status status = run(s, &m, &cloud, &output, error);
	output_file_abandon(&output);
	mesh_clear(&m);
	scan_clear(&cloud);
	return status;
}

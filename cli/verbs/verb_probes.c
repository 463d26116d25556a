#include "verbs/verbs.h"
#include "options/progress.h"
#include "options/quality_preset.h"
#include "program/signals.h"
#include "program/text_quote.h"
#include "result/bake_plan.h"
#include "result/probe_files.h"
#include "scene/file_roles.h"
#include "scene/glossy_points.h"
#include "scene/scene_file.h"
#include "glowworm_host.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* All that lives as long as one run. */
typedef struct probing {
	settings *settings;
	output_file *atlas, *json;
	loaded_scene scene;
	gw_light *light;
	gw_drivers *drivers;
	gw_probes *probes;
	progress progress;
	gw_error *error;
} probing;

static void on_progress(void *user, const char *stage, double done)
{
	progress_show(&((probing *)user)->progress, stage, done);
}

static bool on_cancelled(void *user)
{
	(void)user;
	return signals_pending() != 0;
}

static bool is_stream(const char *path)
{
	return path && strcmp(path, "-") == 0;
}

static gw_status check(const settings *s, gw_error *error)
{
	if (s->input_count == 0)
		return gw_fail(error, GW_ERROR_USAGE,
					   "where to place probes? Name an input, or - for standard input");
	int streams = is_stream(s->output) + is_stream(s->json_file) + is_stream(s->vdb);
	if (!s->output && !s->json_file && !s->vdb)
		return gw_fail(error, GW_ERROR_USAGE,
					   "where to write? Give -o FILE for the maps, --json FILE for places and "
					   "harmonics, or --vdb FILE for a grid");
	if (streams > 1)
		return gw_fail(error, GW_ERROR_USAGE,
					   "standard output can hold one of --output, --json and --vdb, not %d",
					   streams);
	if (streams > 0 && !is_stream(s->json_file) && isatty(STDOUT_FILENO))
		return gw_fail(error, GW_ERROR_USAGE,
					   "standard output is a terminal, and this is binary data; redirect it, or "
					   "name a file with -o");
	if ((s->probes.size & (s->probes.size - 1)) != 0)
		return gw_fail(error, GW_ERROR_USAGE, "--size %u is no power of two, such as 32, 64 or 128",
					   s->probes.size);
	return file_roles_check(VERB_PROBES, s, NULL, error);
}

/* Whether a file of grids can be made there, before the work. */
static gw_status check_grids(const settings *s, gw_error *error)
{
	output_file *trial = NULL;
	if (!s->vdb || is_stream(s->vdb))
		return GW_OK;
	GW_TRY(output_file_create(&trial, s->vdb, s->force, error));
	output_file_abandon(&trial);
	return GW_OK;
}

static gw_status read_scene(probing *p)
{
	settings *s = p->settings;
	GW_TRY(scene_read_all(s, p->error));
	quality_preset_apply(s);
	bake_plan_apply_effects(s);
	GW_TRY(check(s, p->error));
	GW_TRY(bake_plan_apply_motion(s, p->error));
	if (s->output)
		GW_TRY(output_file_create(&p->atlas, s->output, s->force, p->error));
	if (s->json_file)
		GW_TRY(output_file_create(&p->json, s->json_file, s->force, p->error));
	GW_TRY(check_grids(s, p->error));
	s->bake.drivers = p->drivers = gw_drivers_load();
	GW_TRY(loaded_scene_read(s, &p->scene, p->error));
	glossy_points_apply(s, &p->scene);
	return loaded_scene_lights(&p->scene, s, &p->light, p->error);
}

/* ------------------------------------------------------------------------------- the probes */

static gw_status place(probing *p, gw_scene *scene)
{
	const settings *s = p->settings;
	gw_probes_options options = s->probes;
	gw_lighting *lighting = NULL;
	options.seed = s->bake.seed;
	gw_status status = gw_lighting_create(scene, p->light, s->light_count, &lighting, p->error);
	if (status == GW_OK)
		status = gw_probes_make(lighting, &options, &p->probes, p->error);
	gw_lighting_destroy(&lighting);
	return status;
}

/* Lights the points as a bake does that has no goal and says nothing of its error. */
static gw_status light_and_place(probing *p)
{
	const settings *s = p->settings;
	gw_bake_options options = bake_plan_options(s);
	const gw_bake_callbacks callbacks = { on_progress, on_cancelled, p, NULL };
	const gw_scene_description description = { &p->scene.points.points, p->light, s->light_count };
	gw_scene *scene = NULL;
	options.estimate_points = 0;
	options.effects_forced |= 1u << GW_EFFECT_OCTREE;
	gw_status status = gw_scene_create(&description, &options, &callbacks, &scene, p->error);
	if (status == GW_OK)
		status = place(p, scene);
	gw_scene_destroy(&scene);
	progress_clear(&p->progress);
	return status;
}

static gw_status write_files(probing *p)
{
	const probe_files files = { p->settings, p->probes, &p->scene.place };
	if (p->atlas)
		GW_TRY(probe_files_atlas(&files, p->atlas, p->error));
	if (p->json)
		GW_TRY(probe_files_json(&files, p->json, p->error));
	if (p->settings->vdb)
		GW_TRY(probe_files_grids(&files, p->settings->vdb, p->error));
	GW_TRY(signals_check(p->error));
	if (p->atlas)
		GW_TRY(output_file_commit(&p->atlas, p->error));
	return p->json ? output_file_commit(&p->json, p->error) : GW_OK;
}

static void say(const probing *p)
{
	const gw_probes *probes = p->probes;
	char seen[TEXT_PERCENT], seeable[TEXT_PERCENT];
	fprintf(stderr,
			"glowworm: %zu probe%s %s %% of the surface; from any of %zu places %s %% are seen\n",
			probes->count, gw_plural(probes->count, " sees", "s see"),
			text_percent(probes->seen, seen), probes->candidates,
			text_percent(probes->seeable, seeable));
}

gw_status verb_probes(settings *s, gw_error *error)
{
	probing p = { .settings = s,
				  .progress = progress_start((settings_progress)s->progress, s->quiet),
				  .error = error };
	gw_status status = read_scene(&p);
	if (status == GW_OK)
		status = light_and_place(&p);
	if (status == GW_OK)
		status = write_files(&p);
	progress_end(&p.progress);
	if (status == GW_OK && !s->quiet)
		say(&p);
	output_file_abandon(&p.atlas);
	output_file_abandon(&p.json);
	s->bake.drivers = NULL;
	gw_drivers_release(&p.drivers);
	gw_probes_destroy(&p.probes);
	loaded_scene_clear(&p.scene);
	free(p.light);
	return status;
}

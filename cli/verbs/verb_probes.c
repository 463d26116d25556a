#include "verbs/verbs.h"
#include "options/progress.h"
#include "options/quality_preset.h"
#include "program/signals.h"
#include "pictures/probe_picture.h"
#include "pictures/render_cameras.h"
#include "program/text_quote.h"
#include "files/input_file.h"
#include "grids/vdb_grids.h"
#include "result/bake_plan.h"
#include "result/probe_files.h"
#include "scene/file_roles.h"
#include "scene/stream_roles.h"
#include "scene/glossy_points.h"
#include "scene/input_notes.h"
#include "scene/scene_file.h"
#include "scene/thinned_scene.h"
#include "glowworm_host.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* All that lives as long as one run. */
typedef struct probing {
	settings *settings;
	output_file *atlas, *json, *png, *transport;
	input_file reused; /* a transport */
	thinned_scene scene;
	gw_light *light;
	gw_drivers *drivers;
	gw_probes *probes;
	float *radiance;       /* of the points, for the picture */
	probe_picture picture; /* what was seen in it */
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

static gw_status check_streams(const settings *s, gw_error *error)
{
	const stream_output out[] = { { "--output", s->output, "this is" },
								  { "--json", s->json_file, NULL },
								  { "--vdb", s->vdb, "this is" },
								  { "--picture", s->picture, "this is" },
								  { "--save-transport", s->save_transport, "this is" } };
	GW_TRY(stream_roles_check_inputs(s, error));
	return stream_roles_check_outputs(out, sizeof out / sizeof *out, error);
}

static gw_status check(const settings *s, gw_error *error)
{
	if (s->input_count == 0)
		return gw_fail(error, GW_ERROR_USAGE,
					   "where to place probes? Name an input, or - for standard input");
	if (!s->output && !s->json_file && !s->vdb && !s->picture && !s->save_transport)
		return gw_fail(error, GW_ERROR_USAGE,
					   "where to write? Give -o FILE for the maps, --json FILE for places and "
					   "harmonics, --vdb FILE for a grid, or --picture FILE for a picture");
	GW_TRY(check_streams(s, error));
	if ((s->probes.size & (s->probes.size - 1)) != 0)
		return gw_fail(error, GW_ERROR_USAGE, "--size %u is no power of two, such as 32, 64 or 128",
					   s->probes.size);
	return file_roles_check(VERB_PROBES, s, NULL, error);
}

static bool is_called(const char *path, const char *extension)
{
	const char *dot = strrchr(path, '.');
	return stream_roles_nameless(path) || (dot && strcasecmp(dot, extension) == 0);
}

/* The pictures' names, and the camera of that of balls, before the work. */
static gw_status check_pictures(const settings *s, gw_error *error)
{
	camera_plan plan;
	if (s->output && !is_called(s->output, ".exr"))
		return gw_fail(error, GW_ERROR_USAGE,
					   "%s: maps of probes are OpenEXR, and the name must end in .exr; --picture "
					   "draws the scene with the probes in it, as PNG",
					   s->output);
	if (!s->picture)
		return GW_OK;
	if (!is_called(s->picture, ".png"))
		return gw_fail(error, GW_ERROR_USAGE, "--picture %s: the name must end in .png",
					   s->picture);
	GW_TRY(camera_plan_read(s, &plan, error));
	camera_plan_clear(&plan);
	return GW_OK;
}

/* Whether a file of grids can be made, and there, before the work. */
static gw_status check_grids(const settings *s, gw_error *error)
{
	output_file *trial = NULL;
	if (!s->vdb)
		return GW_OK;
	GW_TRY(vdb_load(error));
	if (stream_roles_standard(s->vdb))
		return GW_OK;
	GW_TRY(output_file_create(&trial, s->vdb, s->force, error));
	output_file_abandon(&trial);
	return GW_OK;
}

static gw_status open_outputs(probing *p)
{
	const settings *s = p->settings;
	const struct {
		const char *path;
		output_file **file;
	} out[] = { { s->output, &p->atlas },
				{ s->json_file, &p->json },
				{ s->picture, &p->png },
				{ s->save_transport, &p->transport } };
	for (size_t i = 0; i < sizeof out / sizeof *out; i++)
		if (out[i].path)
			GW_TRY(output_file_create(out[i].file, out[i].path, s->force, p->error));
	return check_grids(s, p->error);
}

static gw_status read_scene(probing *p)
{
	const parted_cloud_look look = { .bytes = THINNED_SCENE_LIT_BYTES };
	settings *s = p->settings;
	GW_TRY(scene_read_all(s, p->error));
	quality_preset_apply(s);
	bake_plan_apply_effects(s);
	GW_TRY(check(s, p->error));
	GW_TRY(check_pictures(s, p->error));
	GW_TRY(bake_plan_apply_motion(s, p->error));
	GW_TRY(open_outputs(p));
	s->bake.drivers = p->drivers = gw_drivers_load();
	GW_TRY(thinned_scene_read(s, &look, "taken", &p->scene, p->error));
	if (!s->quiet)
		input_notes_print(s, &p->scene.loaded);
	glossy_points_apply(s, &p->scene.loaded);
	if (s->save_transport)
		GW_TRY(output_file_check_room(s->save_transport,
									  TRANSPORT_BYTES * p->scene.loaded.cloud.count, p->error));
	if (s->transport)
		GW_TRY(input_file_open_as(&p->reused, s->transport, 0, 0, p->error));
	return loaded_scene_lights(&p->scene.loaded, s, &p->light, p->error);
}

/* ------------------------------------------------------------------------------- the probes */

/* What the points send out, which the picture shows. */
static gw_status keep_radiance(probing *p, gw_scene *scene, gw_lighting *lighting)
{
	p->radiance = reallocarray(NULL, gw_scene_point_count(scene) + 1, 3 * sizeof *p->radiance);
	if (!p->radiance)
		return gw_fail(p->error, GW_ERROR_MEMORY, "no memory for the light of %zu points",
					   gw_scene_point_count(scene));
	return gw_lighting_radiance(lighting, p->radiance, p->error);
}

static gw_status place(probing *p, gw_scene *scene)
{
	const settings *s = p->settings;
	gw_probes_options options = s->probes;
	gw_lighting *lighting = NULL;
	options.seed = s->bake.seed;
	gw_status status = gw_lighting_create(scene, p->light, s->light_count, &lighting, p->error);
	if (status == GW_OK)
		status = gw_probes_make(lighting, &options, &p->probes, p->error);
	if (status == GW_OK && p->png)
		status = keep_radiance(p, scene, lighting);
	gw_lighting_destroy(&lighting);
	return status;
}

static gw_status write_transport(void *user, const void *bytes, size_t length, gw_error *error)
{
	return output_file_write(((probing *)user)->transport, bytes, length, error);
}

/* Lights the points as a bake does that has no goal and says nothing of its error. */
static gw_status light_and_place(probing *p)
{
	const settings *s = p->settings;
	gw_bake_options options = bake_plan_options(s);
	const gw_bake_callbacks callbacks = { on_progress, on_cancelled, p, NULL };
	const gw_transport transport = { .name = p->reused.name,
									 .data = p->reused.data,
									 .length = p->reused.length,
									 .fleeting = p->reused.storage == INPUT_FILE_MAPPED,
									 .write = p->transport ? write_transport : NULL,
									 .user = p };
	const gw_scene_description description = { &p->scene.loaded.points.points, p->light,
											   s->light_count };
	gw_scene *scene = NULL;
	if (transport.data || transport.write)
		options.transport = &transport;
	options.estimate_points = 0;
	options.effects_forced |= 1u << GW_EFFECT_OCTREE;
	gw_status status = gw_scene_create(&description, &options, &callbacks, &scene, p->error);
	if (status == GW_OK)
		status = place(p, scene);
	gw_scene_destroy(&scene);
	progress_clear(&p->progress);
	return input_file_check(&p->reused, status, p->error);
}

/* The last of the files, because it takes the scene apart. */
static gw_status write_picture(probing *p)
{
	if (!p->png)
		return GW_OK;
	p->picture =
		(probe_picture){ .settings = p->settings, .probes = p->probes, .radiance = p->radiance };
	GW_TRY(probe_picture_write(&p->picture, &p->scene.loaded, p->png, p->error));
	GW_TRY(signals_check(p->error));
	return output_file_commit(&p->png, p->error);
}

static gw_status write_files(probing *p)
{
	const probe_files files = { p->settings, p->probes, &p->scene.loaded.place };
	if (p->atlas)
		GW_TRY(probe_files_atlas(&files, p->atlas, p->error));
	if (p->json)
		GW_TRY(probe_files_json(&files, p->json, p->error));
	if (p->settings->vdb)
		GW_TRY(probe_files_grids(&files, p->settings->vdb, p->error));
	GW_TRY(signals_check(p->error));
	if (p->atlas)
		GW_TRY(output_file_commit(&p->atlas, p->error));
	if (p->json)
		GW_TRY(output_file_commit(&p->json, p->error));
	if (p->transport)
		GW_TRY(output_file_commit(&p->transport, p->error));
	return write_picture(p);
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
	if (!p->settings->picture)
		return;
	fprintf(stderr, "glowworm: the picture shows %zu of the probes\n", p->picture.shown);
	if (p->picture.camera[0])
		fprintf(stderr, "glowworm: note: the camera is --camera '%s'\n", p->picture.camera);
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
	output_file_abandon(&p.png);
	output_file_abandon(&p.transport);
	input_file_close(&p.reused);
	s->bake.drivers = NULL;
	gw_drivers_release(&p.drivers);
	gw_probes_destroy(&p.probes);
	thinned_scene_clear(&p.scene);
	free(p.light);
	free(p.radiance);
	return status;
}

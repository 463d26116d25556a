/*
 * handles.c - the scenes and lightings of glowworm.h: what gw_bake does once, in steps that others
 * call in their own order.
 */
#include "light/direct_light.h"
#include "base/memory.h"
#include "bake/probes.h"
#include "bake/record_fields.h"
#include "bake/report.h"
#include "bake/result.h"
#include "bake/transport.h"
#include "bake/volume_light.h"
#include "bake/record_steps.h"
#include "bake/options_check.h"
#include "bake/lighting_steps.h"
#include "bake/lighting_error.h"
#include "bake/region.h"

#include <stdlib.h>
#include <string.h>

/* Asks from anew, also where the answer was yes in an earlier call. */
static void begin_call(gw_scene *scene)
{
	scene->stage.stopped = false;
	if (scene->gpu)
		gw_gpu_resume(scene->gpu);
}

/* The steps of a call, with where they are in it, as measured on a cave of 1.4 million points. */
static gw_status begin(gw_scene *scene, const char *name, double done, double share,
					   gw_error *error)
{
	gw_report_stage(scene->report, scene->gpu, name);
	return gw_scene_begin(scene, name, done, share, error);
}

/* Stops the clock of the last step; what went well so far is asked for what validation said. */
static gw_status end(gw_scene *scene, gw_status status, gw_error *error)
{
	gw_report_stage(scene->report, scene->gpu, NULL);
	return status == GW_OK ? gw_scene_check_validation(scene, error) : status;
}

/* -------------------------------------------------------------------------------------- scenes */

/* What an earlier scene of these points was, in place of all steps. */
static gw_status load(gw_scene *scene, const gw_points *points, gw_error *error)
{
	GW_TRY(begin(scene, "transport", 0.01, 0.99, error));
	return gw_transport_load(scene, points, scene->options.transport, error);
}

/* All that any light may call for, as far as the options let it; for a transport, that of any. */
static gw_status prepare(gw_scene *scene, const gw_scene_description *from, gw_error *error)
{
	const gw_bake_options *o = &scene->options;
	bool kept = gw_transport_is_written(o->transport);
	bool gathers = kept || gw_plan_may_gather(o), traces = kept || gw_plan_may_trace(o);
	GW_TRY(begin(scene, "device", 0.0, 0.01, error));
	GW_TRY(gw_scene_open_device(scene, error));
	if (kept)
		scene->of = gw_transport_identify(from->points);
	if (gw_transport_is_read(o->transport))
		return load(scene, from->points, error);
	GW_TRY(begin(scene, "surfels", 0.01, 0.45, error));
	GW_TRY(gw_scene_make_surfels(scene, from, error));
	GW_TRY(gw_region_ask(scene, error));
	if (traces || o->unknown || gw_effect_forced(o, GW_EFFECT_GAPS))
		GW_TRY(gw_scene_find_space(scene, from->points, error));
	GW_TRY(begin(scene, "octree", 0.46, 0.3, error));
	GW_TRY(traces ? gw_scene_build_octree(scene, error) : gw_scene_do_without_octree(scene, error));
	if (!gathers)
		return GW_OK;
	GW_TRY(begin(scene, "records", 0.76, 0.24, error));
	return gw_scene_place_records(scene, error);
}

static gw_status check(const gw_scene_description *description, const gw_bake_options *options,
					   gw_error *error)
{
	GW_TRY(gw_options_check(options, description, error));
	if (options->surface_points > 0)
		return gw_fail(error, GW_ERROR_USAGE,
					   "a scene's surface is made of all its points; leave their number out");
	if (gw_options_refine(options))
		return gw_fail(
			error, GW_ERROR_USAGE,
			"a scene keeps the settings that it was made with; it cannot be refined until "
			"an error or a time is reached");
	return GW_OK;
}

gw_status gw_scene_create(const gw_scene_description *description, const gw_bake_options *options,
						  const gw_bake_callbacks *callbacks, gw_scene **scene, gw_error *error)
{
	const gw_bake_options ordinary = gw_bake_options_default();
	*scene = NULL;
	options = options ? options : &ordinary;
	GW_TRY(check(description, options, error));
	gw_scene *s = gw_allocate_zeros(1, sizeof *s);
	if (s)
		s->own_report = gw_allocate_zeros(1, sizeof *s->own_report);
	if (!s || !s->own_report) {
		free(s);
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a scene");
	}
	s->report = s->own_report;
	if (callbacks)
		s->callbacks = *callbacks;
	const gw_bake_options effective = gw_options_effective(options);
	gw_status status = gw_scaled_scene_make(description, &effective, 0.0, &s->units, error);
	s->options = s->units.options;
	if (status == GW_OK)
		status = end(s, prepare(s, &s->units.scene, error), error);
	gw_scaled_scene_let_go(&s->units);
	s->options.device = NULL;
	s->options.drivers = NULL;
	s->prepared = *s->report;
	if (status == GW_OK)
		*scene = s;
	else
		gw_scene_destroy(&s);
	return status;
}

void gw_scene_destroy(gw_scene **scene)
{
	gw_scene *s = *scene;
	if (s == NULL)
		return;
	gw_scene_close(s);
	gw_scaled_scene_clear(&s->units);
	free(s->own_report->bounce);
	free(s->own_report);
	free(s);
	*scene = NULL;
}

gw_status gw_scene_change_emission(gw_scene *scene, const float *emission, gw_error *error)
{
	size_t points = scene->surfels.point_count;
	begin_call(scene);
	float *scaled = emission ? gw_scaled_emission(&scene->units, emission, points) : NULL;
	if (emission && !scaled)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the emission of %zu points", points);
	gw_status status = gw_scene_replace_emission(scene, scaled, points, error);
	free(scaled);
	GW_TRY(status);
	gw_report_emission(&scene->prepared, &scene->surfels);
	scene->emissions++;
	return GW_OK;
}

size_t gw_scene_point_count(const gw_scene *scene)
{
	return scene->surfels.point_count;
}

const gw_report *gw_scene_report(const gw_scene *scene)
{
	return scene->own_report;
}

/* ----------------------------------------------------------------------------------- lightings */

/* What the last lighting said is not so any more. */
static void reset_report(gw_scene *scene)
{
	free(scene->report->bounce);
	*scene->report = scene->prepared;
}

static gw_status light(gw_lighting *lighting, gw_error *error)
{
	gw_scene *scene = lighting->scene;
	reset_report(scene);
	gw_lighting_plan(lighting);
	if (!lighting->plan.lamps || !lighting->plan.records)
		gw_lighting_clear(lighting); /* of an earlier light that had more to it */
	GW_TRY(begin(scene, "direct light", 0.0, 0.4, error));
	GW_TRY(gw_lighting_direct(lighting, error));
	if (!lighting->plan.records)
		return GW_OK;
	GW_TRY(begin(scene, "first gather", 0.4, 0.2, error));
	GW_TRY(gw_lighting_gather_first(lighting, error));
	GW_TRY(begin(scene, "bounces", 0.6, 0.35, error));
	GW_TRY(gw_lighting_bounce(lighting, error));
	GW_TRY(begin(scene, "read back", 0.95, 0.05, error));
	return gw_lighting_read_back(lighting, error);
}

/* What a call that failed may have left half done is made anew when it is asked for. */
static void forget_halves(gw_lighting *lighting)
{
	gw_scene *scene = lighting->scene;
	gw_lighting_clear(lighting);
	lighting->lights = NULL;
	scene->lit = NULL;
	gw_scene_forget_light(scene);
}

static gw_status run(gw_lighting *lighting, gw_error *error)
{
	gw_scene *scene = lighting->scene;
	begin_call(scene);
	gw_status status = end(scene, light(lighting, error), error);
	scene->lit = lighting;
	lighting->emissions = scene->emissions;
	if (status != GW_OK)
		forget_halves(lighting);
	return status;
}

gw_status gw_lighting_change(gw_lighting *lighting, const gw_light *lights, size_t light_count,
							 gw_error *error)
{
	gw_scene *scene = lighting->scene;
	gw_light *own;
	GW_TRY(gw_lights_check(lights, light_count, error));
	GW_TRY(gw_scaled_lights(&scene->units, lights, light_count, &own, error));
	free(lighting->own_lights);
	lighting->lights = lighting->own_lights = own;
	lighting->light_count = light_count;
	gw_lighting_drop_map(lighting);
	return run(lighting, error);
}

gw_status gw_lighting_create(gw_scene *scene, const gw_light *lights, size_t light_count,
							 gw_lighting **lighting, gw_error *error)
{
	*lighting = NULL;
	gw_lighting *l = gw_allocate_zeros(1, sizeof *l);
	if (!l)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a lighting");
	l->scene = scene;
	l->kept = scene->options.lamps;
	gw_status status = gw_lighting_change(l, lights, light_count, error);
	if (status == GW_OK)
		*lighting = l;
	else
		gw_lighting_destroy(&l);
	return status;
}

void gw_lighting_destroy(gw_lighting **lighting)
{
	gw_lighting *l = *lighting;
	if (l == NULL)
		return;
	if (l->scene->lit == l)
		l->scene->lit = NULL;
	gw_lighting_clear(l);
	free(l->own_lights);
	free(l);
	*lighting = NULL;
}

/* ------------------------------------------------------------------------ what is asked of it */

static gw_status check_lit(const gw_lighting *lighting, gw_error *error)
{
	if (!lighting->lights)
		return gw_fail(error, GW_ERROR_USAGE,
					   "there is no light to read: the last change of the lighting failed");
	if (lighting->emissions != lighting->scene->emissions)
		return gw_fail(error, GW_ERROR_USAGE,
					   "the points have been given other emission since this lighting was made; "
					   "change the lighting before it is read");
	return GW_OK;
}

/* Sees to it that the light of this lighting is in the records. */
static gw_status bring_back(gw_lighting *lighting, gw_error *error)
{
	gw_status status = check_lit(lighting, error);
	begin_call(lighting->scene);
	return status == GW_OK && lighting->scene->lit != lighting ? run(lighting, error) : status;
}

gw_status gw_lighting_radiance(gw_lighting *lighting, float *radiance, gw_error *error)
{
	gw_scene *scene = lighting->scene;
	GW_TRY(check_lit(lighting, error));
	begin_call(scene);
	GW_TRY(gw_result_radiance(lighting, radiance, error));
	return gw_scaled_scene_undo_radiance(&scene->units, radiance, scene->surfels.point_count,
										 error);
}

/* A report of its own for a result, with its array. */
static gw_status copy_report(const gw_report *from, gw_report *to, gw_error *error)
{
	*to = *from;
	to->bounce = gw_allocate_array(from->bounce_count, sizeof *to->bounce);
	if (!to->bounce)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a report");
	if (from->bounce_count > 0)
		memcpy(to->bounce, from->bounce, from->bounce_count * sizeof *to->bounce);
	return GW_OK;
}

static gw_status collect(gw_lighting *lighting, gw_bake_result *result, gw_error *error)
{
	gw_scene *scene = lighting->scene;
	const gw_bake_options *o = &scene->options;
	GW_TRY(gw_scene_begin(scene, "points", 0.0, 1.0, error));
	GW_TRY(gw_record_fields_collect(lighting, result, error));
	/* What follows works where the records' light is. */
	if (o->voxels || o->lamps)
		scene->lit = NULL;
	if (o->volume)
		GW_TRY(gw_volume_light_collect(lighting, result, error));
	if (o->voxels)
		GW_TRY(gw_result_collect_voxels(lighting, result, error));
	GW_TRY(gw_result_collect(lighting, result, error));
	if (o->lamps)
		GW_TRY(gw_result_collect_lamps(lighting, result, error));
	gw_report_device(scene->report, scene->gpu);
	GW_TRY(copy_report(scene->report, &result->report, error));
	return gw_scaled_scene_undo(&scene->units, result, error);
}

gw_status gw_lighting_result(gw_lighting *lighting, gw_bake_result **result, gw_error *error)
{
	*result = NULL;
	GW_TRY(bring_back(lighting, error));
	gw_bake_result *r = gw_allocate_zeros(1, sizeof *r);
	if (!r)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a result");
	gw_status status = collect(lighting, r, error);
	if (status == GW_OK)
		*result = r;
	else
		gw_bake_result_destroy(&r);
	return status;
}

gw_status gw_lighting_error(gw_lighting *lighting, gw_error_estimate *estimate, gw_error *error)
{
	gw_scene *scene = lighting->scene;
	*estimate = (gw_error_estimate){ .points = 0 };
	if (scene->options.estimate_points == 0)
		return gw_fail(error, GW_ERROR_USAGE,
					   "the scene was made with 0 points to estimate the error by");
	gw_status status = bring_back(lighting, error);
	if (status != GW_OK || !(lighting->plan.records || lighting->plan.lamps))
		return status;
	status = gw_scene_begin(scene, "estimate", 0.0, 1.0, error);
	if (status == GW_OK)
		status = gw_lighting_estimate(lighting, error);
	if (status == GW_OK)
		*estimate = scene->report->error;
	else
		gw_scene_forget_light(scene);
	return status;
}

/* Keeps the scene with its first probes, where that is asked for. */
static gw_status save(gw_lighting *lighting, gw_error *error)
{
	gw_scene *scene = lighting->scene;
	const gw_transport *transport = scene->options.transport;
	if (scene->saved || !gw_transport_is_written(transport))
		return GW_OK;
	GW_TRY(begin(scene, "save transport", 0.9, 0.1, error));
	scene->saved = true;
	return gw_transport_save(lighting, &scene->of, transport, error);
}

gw_status gw_probes_make(gw_lighting *lighting, const gw_probes_options *options,
						 gw_probes **probes, gw_error *error)
{
	const gw_probes_options ordinary = gw_probes_options_default();
	gw_scene *scene = lighting->scene;
	options = options ? options : &ordinary;
	*probes = NULL;
	GW_TRY(gw_probes_options_check(options, error));
	GW_TRY(check_lit(lighting, error));
	begin_call(scene);
	gw_probes *p = gw_allocate_zeros(1, sizeof *p);
	if (!p)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for probes");
	gw_status status = begin(scene, "probes", 0.0, 1.0, error);
	if (status == GW_OK)
		status = gw_lighting_probes(lighting, options, p, error);
	if (status == GW_OK)
		status = save(lighting, error);
	status = end(scene, status, error);
	if (status == GW_OK)
		*probes = p;
	else
		gw_probes_destroy(&p);
	return status;
}

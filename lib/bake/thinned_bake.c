/*
 * thinned_bake.c - gw_bake and gw_plan_bake: bakes of all points, or where there are more than
 * memory holds or than their user wants to wait for, of a surface of some of them by which the
 * others are lit; see surface_points.h.
 */
#include "bake/bake.h"
#include "bake/options_check.h"
#include "bake/report.h"
#include "bake/surface_light.h"
#include "bake/surface_points.h"
#include "glowworm_host.h"

#include <stdio.h>

/* A bake of a surface of some of the points. */
typedef struct thinned {
	const gw_scene_description *whole;
	const gw_bake_options *options;
	gw_point_subset surface;
	double seconds; /* that thinning took */
} thinned;

/* The surface of a scene; all points where they are few enough, and then none are taken. */
static gw_status thin(thinned *t, gw_error *error)
{
	const gw_points *points = t->whole->points;
	const gw_region *region = t->options->region;
	size_t most = gw_surface_points_most(points, t->options);
	double start = gw_seconds();
	if (most >= points->count)
		return GW_OK;
	GW_TRY(gw_surface_points_choose(points, most, t->options->threads, &t->surface, error));
	if (region && region->point)
		GW_TRY(gw_point_subset_ask(&t->surface, region->point, error));
	t->seconds = gw_seconds() - start;
	if (t->surface.points.count == 0)
		return gw_fail(error, GW_ERROR_DATA,
					   "none of the %zu points can be of a surface; there is nothing to light",
					   points->count);
	return GW_OK;
}

static void report_surface(const thinned *t, gw_report *report)
{
	size_t all = t->whole->points->count, count = t->surface.points.count;
	char meaning[200];
	snprintf(meaning, sizeof meaning,
			 "point{ is|s are} lit by the surface that %zu others make, %.3g m apart: %s", count,
			 report->spacing,
			 t->options->surface_points > 0 ? "more were not to be" : "memory holds no more");
	report->surface_points = count;
	gw_report_count(report, "beside_surface", all - count, meaning);
}

static void report_stages(const thinned *t, double seconds, gw_report *report)
{
	const gw_stage choosing = { .name = "choice of points", .seconds = t->seconds };
	const gw_stage spreading = { .name = "points beside", .seconds = seconds };
	gw_report_add_stage(report, &choosing);
	gw_report_add_stage(report, &spreading);
}

static gw_status bake_surface(thinned *t, const gw_bake_callbacks *callbacks,
							  gw_bake_result **result, gw_error *error)
{
	const gw_scene_description part = { &t->surface.points, t->whole->lights,
										t->whole->light_count };
	gw_bake_options options = *t->options;
	options.surface_points = (uint32_t)t->surface.points.count;
	const gw_region region = { .point = t->surface.asked };
	options.region = options.region ? &region : NULL;
	GW_TRY(gw_bake_checked(&part, &options, callbacks, result, error));
	const gw_surface_light_task task = { .points = t->whole->points,
										 .surface = &t->surface,
										 .asked =
											 t->options->region ? t->options->region->point : NULL,
										 .estimated = options.normals == GW_NORMALS_ESTIMATE,
										 .threads = options.threads };
	double start = gw_seconds();
	report_surface(t, &(*result)->report);
	gw_status status = gw_surface_light_spread(&task, *result, error);
	if (status == GW_OK)
		report_stages(t, gw_seconds() - start, &(*result)->report);
	else
		gw_bake_result_destroy(result);
	return status;
}

gw_status gw_bake(const gw_scene_description *scene, const gw_bake_options *options,
				  const gw_bake_callbacks *callbacks, gw_bake_result **result, gw_error *error)
{
	const gw_bake_options ordinary = gw_bake_options_default();
	*result = NULL;
	options = options ? options : &ordinary;
	GW_TRY(gw_options_check(options, scene, error));
	const gw_bake_options effective = gw_options_effective(options);
	if (options->region && callbacks && callbacks->planned)
		return gw_fail(error, GW_ERROR_USAGE,
					   "what the light of a region takes is not foretold; ask for no plan of it");
	gw_bake_options all = effective;
	all.surface_points = 0;
	thinned t = { .whole = scene, .options = &effective };
	gw_status status = thin(&t, error);
	if (status == GW_OK)
		status = t.surface.from ? bake_surface(&t, callbacks, result, error)
								: gw_bake_checked(scene, &all, callbacks, result, error);
	gw_point_subset_clear(&t.surface);
	return status;
}

gw_status gw_plan_bake(const gw_scene_description *scene, const gw_bake_options *options,
					   const gw_bake_callbacks *callbacks, gw_bake_result **plan, gw_error *error)
{
	const gw_bake_options ordinary = gw_bake_options_default();
	*plan = NULL;
	options = options ? options : &ordinary;
	GW_TRY(gw_options_check(options, scene, error));
	if (options->region)
		return gw_fail(error, GW_ERROR_USAGE,
					   "what the light of a region takes is not foretold; plan the whole scene");
	const gw_bake_options effective = gw_options_effective(options);
	const gw_bake_manner planning = { .planning = true };
	thinned t = { .whole = scene, .options = &effective };
	GW_TRY(thin(&t, error));
	const gw_scene_description part = { t.surface.from ? &t.surface.points : scene->points,
										scene->lights, scene->light_count };
	gw_bake_options of_part = effective;
	of_part.surface_points = (uint32_t)t.surface.points.count;
	gw_status status = gw_bake_once(&part, &of_part, planning, callbacks, plan, error);
	if (status == GW_OK && t.surface.from)
		report_surface(&t, &(*plan)->report);
	gw_point_subset_clear(&t.surface);
	return status;
}

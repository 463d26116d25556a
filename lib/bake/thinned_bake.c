/*
 * thinned_bake.c - gw_bake and gw_plan_bake: bakes of all points, or where there are more than
 * memory holds, their user wants to wait for or an error that is asked for takes, of a surface of
 * some of them by which the others are lit; see surface_points.h.
 */
#include "bake/bake.h"
#include "bake/options_check.h"
#include "bake/progress_part.h"
#include "bake/report.h"
#include "bake/surface_light.h"
#include "bake/surface_points.h"
#include "base/memory.h"
#include "glowworm_host.h"

#include <stdio.h>

/* A bake of a surface of some of the points. */
typedef struct thinned {
	const gw_scene_description *whole;
	const gw_bake_options *options;
	size_t limit;              /* more than this its points cannot be, or are not to be */
	size_t most;               /* that this one may be made of */
	gw_memory_ceiling ceiling; /* that its bake has to hold */
	gw_point_subset surface;
	double seconds; /* that choosing it took */
	double spent;   /* and before, on such as memory did not hold */
} thinned;

/* Whether smaller surfaces are tried first, until one has the error that is asked for. */
static bool climbs(const gw_bake_options *o)
{
	return o->max_error > 0.0f && !(o->time_limit > 0.0f) && o->surface_points == 0 && !o->region;
}

static thinned begin(const gw_scene_description *scene, const gw_bake_options *options)
{
	uint64_t memory = gw_surface_points_memory(scene->points, options);
	size_t limit = gw_surface_points_most(scene, options, memory);
	return (thinned){ .whole = scene,
					  .options = options,
					  .limit = limit,
					  .ceiling = gw_surface_points_ceiling(options, memory),
					  .most =
						  climbs(options) ? gw_surface_points_next(0, 0.0, 0.0, limit) : limit };
}

/* The surface of a scene; all points where they are few enough, and then none are taken. */
static gw_status thin(thinned *t, gw_error *error)
{
	const gw_points *points = t->whole->points;
	const gw_region *region = t->options->region;
	double start = gw_seconds();
	if (t->most >= points->count)
		return GW_OK;
	GW_TRY(gw_surface_points_choose(points, t->most, t->options->threads, &t->surface, error));
	if (region && region->point)
		GW_TRY(gw_point_subset_ask(&t->surface, region->point, error));
	t->seconds = gw_seconds() - start;
	if (t->surface.points.count == 0)
		return gw_fail(error, GW_ERROR_DATA,
					   "none of the %zu points can be of a surface; there is nothing to light",
					   points->count);
	return GW_OK;
}

static const char *why_thinned(const thinned *t)
{
	return t->options->surface_points > 0 ? "more were not to be"
		   : t->most < t->limit           ? "the error that is asked for takes no more"
										  : "memory holds no more";
}

static void report_surface(const thinned *t, gw_report *report)
{
	report->surface_points = t->surface.points.count;
	gw_surface_light_count(t->whole->points->count, why_thinned(t), report);
}

static void add_stage(const char *name, double seconds, gw_report *report)
{
	gw_stage stage = { .seconds = seconds };
	snprintf(stage.name, sizeof stage.name, "%s", name);
	if (seconds > 0.0)
		gw_report_add_stage(report, &stage);
}

/* From the light of the surface to that of all points. */
static gw_status light_others(const thinned *t, gw_bake_result *result, gw_error *error)
{
	const gw_region *region = t->options->region;
	const gw_surface_light_task task = { .points = t->whole->points,
										 .surface = &t->surface,
										 .asked = region ? region->point : NULL,
										 .estimated = t->options->normals == GW_NORMALS_ESTIMATE,
										 .threads = t->options->threads };
	double start = gw_seconds();
	GW_TRY(gw_surface_light_spread(&task, result, error));
	report_surface(t, &result->report);
	gw_surface_light_hold_against((double)t->options->max_error, &result->report);
	add_stage("choice of points", t->seconds, &result->report);
	add_stage("points beside", gw_seconds() - start, &result->report);
	return GW_OK;
}

static gw_memory_ceiling *ceiling_of(thinned *t)
{
	return t->ceiling.bytes > 0 ? &t->ceiling : NULL;
}

/* Whether memory turned out not to hold a surface, but holds one of fewer points, which is tried
 * next. */
static bool takes_fewer(thinned *t, double start)
{
	if (t->ceiling.fit == 0)
		return false;
	t->limit = t->most = gw_surface_points_fewer(t->ceiling.fit);
	t->ceiling.fit = t->ceiling.foretold = 0;
	t->spent = gw_seconds() - start;
	gw_give_back_memory();
	return true;
}

static gw_status bake_surface(thinned *t, const gw_bake_callbacks *callbacks,
							  gw_bake_result **result, gw_error *error)
{
	bool all = t->surface.from == NULL;
	const gw_scene_description part = { all ? t->whole->points : &t->surface.points,
										t->whole->lights, t->whole->light_count };
	const gw_region region = { .point = t->surface.asked };
	gw_bake_options options = *t->options;
	options.surface_points = (uint32_t)t->surface.points.count;
	options.region = !all && options.region ? &region : options.region;
	const gw_bake_manner manner = { .trial = t->most < t->limit, .ceiling = ceiling_of(t) };
	GW_TRY(gw_bake_checked(&part, &options, manner, callbacks, result, error));
	/* What is missed already the others would not mend. */
	bool useless = manner.trial && (*result)->report.missed;
	gw_status status = all || useless ? GW_OK : light_others(t, *result, error);
	if (status != GW_OK)
		gw_bake_result_destroy(result);
	return status;
}

/* One bake, of a surface or of all points; where memory does not hold what it takes, of fewer.
 * part: receives which of the progress it is. */
static gw_status try_surface(thinned *t, gw_progress_part *part, gw_bake_result **result,
							 gw_error *error)
{
	double share = (double)t->most / ((double)t->limit + (double)t->most);
	part->share = (1.0 - part->from) * (t->most < t->limit ? share : 1.0);
	const gw_bake_callbacks callbacks = gw_progress_part_callbacks(part);
	double start = gw_seconds();
	gw_status status;
	do {
		status = thin(t, error);
		if (status == GW_OK)
			status = bake_surface(t, &callbacks, result, error);
		gw_point_subset_clear(&t->surface);
	} while (status == GW_ERROR_MEMORY && takes_fewer(t, start));
	if (status == GW_OK)
		add_stage("larger surfaces", t->spent, &(*result)->report);
	part->from += part->share;
	return status;
}

/* What keeps a target out of reach of some of the points, such as edges of shadows, is likely to do
 * so of more of them, and only what is gathered gets as right as it does without a target. So
 * records are as many from the start as there, which saves rounds; unless the caller chose other
 * records. */
static void begin_with_more_records(gw_bake_options *options)
{
	gw_bake_options start = *options, normal = *options;
	gw_bake_options_set_start(&start);
	gw_bake_options_set_quality(&normal, GW_QUALITY_NORMAL);
	if (options->record_spacing != start.record_spacing ||
		options->least_records != start.least_records ||
		options->most_records != start.most_records)
		return;
	options->record_spacing = normal.record_spacing;
	options->least_records = normal.least_records;
	options->most_records = normal.most_records;
}

gw_status gw_bake(const gw_scene_description *scene, const gw_bake_options *options,
				  const gw_bake_callbacks *callbacks, gw_bake_result **result, gw_error *error)
{
	const gw_bake_options ordinary = gw_bake_options_default();
	double start = gw_seconds(), before = 0.0;
	*result = NULL;
	options = options ? options : &ordinary;
	GW_TRY(gw_options_check(options, scene, error));
	gw_bake_options effective = gw_options_effective(options);
	if (options->region && callbacks && callbacks->planned)
		return gw_fail(error, GW_ERROR_USAGE,
					   "what the light of a region takes is not foretold; ask for no plan of it");
	thinned t = begin(scene, &effective);
	gw_progress_part part = { .whole = callbacks };
	GW_TRY(try_surface(&t, &part, result, error));
	while ((*result)->report.missed && t.most < t.limit) {
		double stated = (*result)->report.error.relative_rms;
		if ((*result)->report.goal == GW_GOAL_OUT_OF_REACH)
			begin_with_more_records(&effective);
		t.most = gw_surface_points_next(t.most, stated, (double)effective.max_error, t.limit);
		gw_bake_result_destroy(result);
		before = gw_seconds() - start;
		GW_TRY(try_surface(&t, &part, result, error));
	}
	add_stage("smaller surfaces", before, &(*result)->report);
	return GW_OK;
}

static gw_status plan_surface(thinned *t, const gw_bake_callbacks *callbacks, gw_bake_result **plan,
							  gw_error *error)
{
	GW_TRY(thin(t, error));
	bool all = t->surface.from == NULL;
	const gw_scene_description part = { all ? t->whole->points : &t->surface.points,
										t->whole->lights, t->whole->light_count };
	const gw_bake_manner planning = { .planning = true, .ceiling = ceiling_of(t) };
	gw_bake_options of_part = *t->options;
	of_part.surface_points = (uint32_t)t->surface.points.count;
	GW_TRY(gw_bake_once(&part, &of_part, planning, callbacks, plan, error));
	if (!all)
		report_surface(t, &(*plan)->report);
	return GW_OK;
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
	thinned t = begin(scene, &effective);
	gw_status status;
	do {
		status = plan_surface(&t, callbacks, plan, error);
		gw_point_subset_clear(&t.surface);
	} while (status == GW_ERROR_MEMORY && takes_fewer(&t, 0.0));
	return status;
}

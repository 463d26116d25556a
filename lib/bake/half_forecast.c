/*
 * half_forecast.c - see half_forecast.h.
 */
#include "bake/half_forecast.h"

#include "bake/half_sample.h"
#include "bake/report.h"
#include "glowworm_host.h"

#include <math.h>

/* Share of a difference that few records do not see, as of an error in error_estimate.h. */
#define UNSEEN 0.1

/* Bakes of half of the points, and mostly of half of these, take this share of the whole one. */
#define HALVES_SHARE 0.65

/* Its records are as far apart in metres as those of all points, whose leaves are smaller, and
 * cells of a volume have as few rays. */
static gw_bake_options few_records(const gw_points *points, const gw_bake_options *options,
								   const gw_bake_result *light)
{
	gw_bake_options few = gw_half_sample_options(points, options);
	if (light->report.record_spacing > 0.0f) {
		few.record_spacing = light->report.record_spacing / (float)M_SQRT2;
		few.least_records = few.most_records = 0;
	}
	if (light->report.forecast.cell_rays > 0)
		few.rays = light->report.forecast.cell_rays;
	return few;
}

/* What a whole bake would say if all of the difference were its error, the noise of few records
 * too: how much of it that is, a pilot knows badly where light hardly gets to most places. */
static double most(const gw_error_estimate *pilot, const gw_half_difference *difference,
				   const gw_forecast *f)
{
	const gw_half_difference unknown = { 0 };
	gw_half_difference seen_more = *difference;
	seen_more.turned *= 1.0 + UNSEEN;
	seen_more.near *= 1.0 + UNSEEN;
	seen_more.rest *= 1.0 + UNSEEN;
	gw_error_estimate e = *pilot;
	double others = e.relative_rms * e.relative_rms - e.gathered * e.gathered;
	e.gathered = sqrt(fmax(f->error * f->error - fmax(others, 0.0), 0.0));
	e.relative_rms = f->error;
	gw_half_sample_add(&seen_more, &unknown, 0.0, &e);
	return e.relative_rms;
}

/* Of which an octree that found no memory for its leaves shows other differences. */
static gw_status refuse_coarser(const gw_bake_result *of_half, gw_error *error)
{
	return *of_half->report.why_coarser == '\0'
			   ? GW_OK
			   : gw_fail(error, GW_ERROR_MEMORY, "%s", of_half->report.why_coarser);
}

static gw_status bake_half(const gw_half_forecast_task *task, const gw_bake_options *options,
						   const gw_point_subset *half, gw_bake_result **result, gw_error *error)
{
	const gw_scene_description part = { &half->points, task->scene->lights,
										task->scene->light_count };
	const gw_bake_callbacks quiet = { .user = task->callbacks->user,
									  .cancelled = task->callbacks->cancelled };
	gw_gpu *device = task->device;
	gw_gpu_aside aside;
	*result = NULL;
	if (half->points.count == 0)
		return gw_fail(error, GW_ERROR_DATA, "nothing is left of the points in half of them");
	gw_gpu_put_aside(device, &aside);
	gw_status status = task->bake(&part, options, &device, &quiet, result, error);
	gw_gpu_go_on(task->device, &aside);
	return status == GW_OK ? refuse_coarser(*result, error) : status;
}

static void add_difference(const gw_half_difference *d, const gw_bake_result *light, gw_forecast *f)
{
	double least = f->error, highest = most(&light->report.error, d, f);
	f->error = 0.5 * (least + highest);
	f->spread = hypot(f->spread, 0.5 * (highest - least));
}

/* What the outcome of the bake of half of the points means for the whole one. */
static gw_status tell(gw_status status, gw_report *r)
{
	gw_forecast *f = &r->forecast;
	f->error_is_least = status == GW_ERROR_MEMORY;
	if (status == GW_ERROR_DATA)
		return GW_OK;
	if (status != GW_OK && status != GW_ERROR_MEMORY)
		return status;
	f->seconds *= 1.0 + HALVES_SHARE;
	gw_report_effect(
		r, gw_effect_name(GW_EFFECT_ERROR), "points solved again, and half of the points baked",
		"the surface is in doubt: what half of the points tell otherwise is added to "
		"the error%s",
		f->error_is_least ? "; beside the bake of all there was no memory to foretell it" : "");
	return GW_OK;
}

gw_status gw_half_forecast_add(const gw_half_forecast_task *task, const gw_bake_result *light,
							   gw_report *report, gw_error *error)
{
	const gw_bake_options few = few_records(task->scene->points, task->options, light);
	double start = gw_seconds();
	gw_point_subset half;
	gw_bake_result *of_half = NULL;
	gw_status status = gw_half_sample_make(task->scene->points, 0, &half, error);
	if (status == GW_OK)
		status = bake_half(task, &few, &half, &of_half, error);
	gw_half_difference d = { 0 };
	if (status == GW_OK)
		status = gw_half_sample_difference(&half, of_half, light, &d, error);
	if (status == GW_OK)
		add_difference(&d, light, &report->forecast);
	status = tell(status, report);
	report->forecast.own_seconds += gw_seconds() - start;
	gw_bake_result_destroy(&of_half);
	gw_point_subset_clear(&half);
	return status;
}

/*
 * half_forecast.c - see half_forecast.h.
 */
#include "bake/half_forecast.h"

#include "bake/bake.h"
#include "bake/half_sample.h"
#include "glowworm_host.h"

#include <math.h>

/* Share of a difference that few records do not see, as of an error in error_estimate.h. */
#define UNSEEN 0.1

/* Its records are as far apart in metres as those of all points, whose leaves are smaller. */
static gw_bake_options few_records(const gw_bake_options *options, const gw_bake_result *light)
{
	gw_bake_options few = gw_half_sample_options(options);
	if (light->report.record_spacing > 0.0f) {
		few.record_spacing = light->report.record_spacing / (float)M_SQRT2;
		few.least_records = 0;
	}
	return few;
}

/* What a whole bake would say if all of the difference were its error, the noise of few records
 * too: how much of it that is, a pilot knows badly where light hardly gets to most places. */
static double most(const gw_error_estimate *pilot, const gw_half_difference *difference,
				   const gw_forecast *f)
{
	const gw_half_difference unknown = { 0 };
	const gw_half_difference seen_more = { .turned = (1.0 + UNSEEN) * difference->turned,
										   .rest = (1.0 + UNSEEN) * difference->rest };
	gw_error_estimate e = *pilot;
	double others = e.relative_rms * e.relative_rms - e.gathered * e.gathered;
	e.gathered = sqrt(fmax(f->error * f->error - fmax(others, 0.0), 0.0));
	e.relative_rms = f->error;
	gw_half_sample_add(&seen_more, &unknown, 0.0, &e);
	return e.relative_rms;
}

static gw_status bake_half(const gw_scene_description *scene, const gw_bake_options *options,
						   const gw_bake_callbacks *callbacks, const gw_half_sample *half,
						   gw_bake_result **result, gw_error *error)
{
	const gw_scene_description part = { &half->points, scene->lights, scene->light_count };
	const gw_bake_callbacks quiet = { .user = callbacks->user, .cancelled = callbacks->cancelled };
	*result = NULL;
	return half->points.count > 0
			   ? gw_bake_once(&part, options, (gw_bake_manner){ 0 }, &quiet, result, error)
			   : gw_fail(error, GW_ERROR_DATA, "nothing is left of the points in half of them");
}

gw_status gw_half_forecast_add(const gw_scene_description *scene, const gw_bake_options *options,
							   const gw_bake_callbacks *callbacks, const gw_bake_result *light,
							   gw_forecast *forecast, gw_error *error)
{
	const gw_bake_options few = few_records(options, light);
	double start = gw_seconds();
	gw_half_sample half;
	gw_bake_result *of_half = NULL;
	gw_status status = gw_half_sample_make(scene->points, 0, &half, error);
	if (status == GW_OK)
		status = bake_half(scene, &few, callbacks, &half, &of_half, error);
	if (status == GW_OK) {
		const gw_half_difference d = gw_half_sample_difference(&half, of_half, light);
		double least = forecast->error, highest = most(&light->report.error, &d, forecast);
		forecast->error = 0.5 * (least + highest);
		forecast->spread = hypot(forecast->spread, 0.5 * (highest - least));
	}
	forecast->error_is_least = status != GW_OK;
	forecast->own_seconds += gw_seconds() - start;
	gw_bake_result_destroy(&of_half);
	gw_half_sample_clear(&half);
	return status == GW_ERROR_DATA || status == GW_ERROR_MEMORY ? GW_OK : status;
}

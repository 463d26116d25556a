/*
 * halved_bake.c - a bake of all points, and where their surface is in doubt, of half of them and of
 * half of these, for the error; see bake.h and half_sample.h.
 */
#include "bake/bake.h"
#include "bake/half_sample.h"
#include "bake/progress_part.h"
#include "bake/report.h"
#include "bake/scene.h"
#include "bake/options_check.h"
#include "base/memory.h"
#include "device/gpu.h"
#include "glowworm_host.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What a bake of all points is of the time where halves of them follow. */
#define WHOLE_SHARE 0.57

/* A bake takes as long as its points are many: where halves will follow, so much is left of it. */
static const gw_progress_part parts[] = {
	{ .from = 0.0, .share = WHOLE_SHARE },
	{ .from = 0.57, .share = 0.29, .name = "half the points" },
	{ .from = 0.86, .share = 0.14, .name = "a quarter of the points" }
};

/* The bake of all points. */
typedef struct whole {
	const gw_scene_description *scene;
	const gw_bake_options *options; /* that it began with */
	const gw_bake_callbacks *callbacks;
	gw_bake_manner manner; /* with its device, which those of halves use too */
	float *known[2];       /* owned: of the half, and of half of it: gw_known_light.all */
	double told;           /* of the progress */
} whole;

/* The part of halves, after what the first part told of the progress. */
static gw_progress_part after(const whole *w, const gw_progress_part *half)
{
	gw_progress_part p = *half;
	p.whole = w->callbacks;
	p.from = fmax(p.from, w->told);
	p.share = fmin(p.share, 1.0 - p.from);
	return p;
}

/* The known light of a half, of that of what it is a half of. */
static gw_status take_known(whole *w, uint32_t level, const gw_point_subset *half, gw_error *error)
{
	if (!w->manner.known)
		return GW_OK;
	const float *from = level == 0 ? w->manner.known->all : w->known[0];
	float *known = w->known[level] = gw_allocate_array(half->points.count, 3 * sizeof *known);
	if (!known)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the light of %zu points",
					   half->points.count);
	for (size_t i = 0; i < half->points.count; i++)
		memcpy(known + 3 * i, from + 3 * half->from[i], 3 * sizeof *known);
	return GW_OK;
}

/* A bake with the settings that the whole one began with, on the device of that one, and with its
 * passes. level: as the half was made; of half of a half nobody asks about sides. */
static gw_status bake_half(whole *w, uint32_t level, const gw_point_subset *half,
						   const gw_bake_callbacks *callbacks, gw_bake_result **result,
						   gw_error *error)
{
	const gw_scene_description scene = { &half->points, w->scene->lights, w->scene->light_count };
	GW_TRY(take_known(w, level, half, error));
	const gw_known_light known = { .all = w->known[level] };
	const gw_bake_manner manner = { .known = w->manner.known ? &known : NULL,
									.device = w->manner.device };
	const gw_region region = { .point = half->asked };
	gw_bake_options plain = gw_half_sample_options(w->scene->points, w->options);
	plain.estimate_points = level == 0 ? plain.estimate_points : 0;
	plain.region = half->asked ? &region : NULL;
	return half->points.count > 0
			   ? gw_bake_once(&scene, &plain, manner, callbacks, result, error)
			   : gw_fail(error, GW_ERROR_DATA, "nothing is left of the points in half of them");
}

/* What the device did for a bake, added to a stage. */
static void add_work(gw_stage *stage, const gw_bake_result *result)
{
	for (uint32_t i = 0; result && i < result->report.stage_count; i++) {
		const gw_stage *more = &result->report.stage[i];
		stage->device_seconds += more->device_seconds;
		stage->compile_seconds += more->compile_seconds;
		stage->dispatches += more->dispatches;
		stage->submissions += more->submissions;
		stage->uploaded_bytes += more->uploaded_bytes;
		stage->downloaded_bytes += more->downloaded_bytes;
	}
}

/* The difference to half of the points, and where more is known from it, of half of that half.
 * stage: receives what the device did for it. */
static gw_status compare_halves(whole *w, gw_stage *stage, gw_bake_result *result, gw_error *error)
{
	gw_point_subset half, quarter = { .from = NULL };
	gw_progress_part second_part = after(w, &parts[1]), third_part = after(w, &parts[2]);
	const gw_bake_callbacks of_second = gw_progress_part_callbacks(&second_part);
	const gw_bake_callbacks of_third = gw_progress_part_callbacks(&third_part);
	gw_bake_result *of_half = NULL, *of_quarter = NULL;
	const gw_report *r = &result->report;
	gw_half_difference first = { 0 }, second = { 0 };
	double gathered = r->round_count > 0 ? r->round[0].error.gathered : r->error.gathered;
	gw_status status = gw_half_sample_make(w->scene->points, 0, &half, error);
	if (status == GW_OK)
		status = gw_point_subset_ask(&half, result->asked, error);
	if (status == GW_OK)
		status = bake_half(w, 0, &half, &of_second, &of_half, error);
	if (status == GW_OK)
		status = gw_half_sample_difference(&half, of_half, result, &first, error);
	bool more = status == GW_OK && gw_half_difference_all(&first) > r->error.relative_rms;
	if (more)
		status = gw_half_sample_make(&half.points, 1, &quarter, error);
	if (more && status == GW_OK)
		status = gw_point_subset_ask(&quarter, of_half->asked, error);
	if (more && status == GW_OK)
		status = bake_half(w, 1, &quarter, &of_third, &of_quarter, error);
	if (more && status == GW_OK)
		status = gw_half_sample_difference(&quarter, of_quarter, of_half, &second, error);
	if (status == GW_OK)
		gw_half_sample_add(&first, &second, gathered, &result->report.error);
	add_work(stage, of_half);
	add_work(stage, of_quarter);
	gw_bake_result_destroy(&of_half);
	gw_bake_result_destroy(&of_quarter);
	gw_point_subset_clear(&half);
	gw_point_subset_clear(&quarter);
	return status;
}

/* What bakes of half of the points say of the surface; nothing where half of them is no cloud. */
static gw_status check_by_halves(whole *w, gw_bake_result *result, gw_error *error)
{
	gw_stage stage = { .name = "half the points" };
	gw_report *r = &result->report;
	double start = gw_seconds();
	gw_status status = compare_halves(w, &stage, result, error);
	stage.seconds = gw_seconds() - start;
	gw_report_add_stage(r, &stage);
	double wanted = (double)w->options->max_error;
	if (status == GW_OK && wanted > 0.0 && r->error.relative_rms > wanted && !r->missed) {
		r->missed = true;
		r->goal = GW_GOAL_EXHAUSTED;
	}
	if (r->price.error > 0.0 && r->price.error < r->error.halves)
		r->price = (gw_price){ 0 };
	return status == GW_ERROR_DATA ? GW_OK : status;
}

gw_status gw_bake_checked(const gw_scene_description *scene, const gw_bake_options *options,
						  gw_bake_manner manner, const gw_bake_callbacks *callbacks,
						  gw_bake_result **result, gw_error *error)
{
	double start = gw_seconds();
	gw_progress_part first = parts[0];
	first.whole = callbacks;
	first.share = gw_half_sample_is_likely(scene->points, options) ? first.share : 1.0;
	const gw_bake_callbacks of_first = gw_progress_part_callbacks(&first);
	gw_gpu *own = NULL;
	manner.device = manner.device ? manner.device : &own;
	whole w = { scene, options, callbacks, manner, { NULL, NULL }, first.share };
	gw_status status = gw_bake_once(scene, options, manner, &of_first, result, error);
	/* Two smaller bakes take less than twice as long as this one did. */
	bool in_time =
		!(options->time_limit > 0.0f) || gw_seconds() - start < 0.5 * (double)options->time_limit;
	bool lit =
		scene->light_count > 0 || scene->points->emission; /* and not for a transport alone */
	bool wanted = status == GW_OK && lit && !(manner.trial && (*result)->report.missed) &&
				  gw_half_sample_is_wanted(scene->points, options, &(*result)->report);
	if (wanted && in_time && !gw_transport_is_read(options->transport))
		status = check_by_halves(&w, *result, error);
	else if (wanted)
		(*result)->report.halves_left_out = true;
	free(w.known[0]);
	free(w.known[1]);
	gw_gpu_destroy(&own);
	if (status != GW_OK)
		gw_bake_result_destroy(result);
	return status;
}

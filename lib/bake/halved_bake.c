/*
 * halved_bake.c - gw_bake: a bake of all points, and where their surface is in doubt, of half of
 * them and of half of these, for the error; see half_sample.h.
 */
#include "bake/bake.h"
#include "bake/half_sample.h"
#include "bake/report.h"
#include "bake/scene.h"
#include "glowworm_host.h"

#include <math.h>

/* What a bake of all points is of the time where halves of them follow. */
#define WHOLE_SHARE 0.57

/* The callbacks of the whole, for a part of it. */
typedef struct part {
	const gw_bake_callbacks *whole; /* NULL: nobody listens */
	double from, share;             /* of the progress */
	const char *name;               /* NULL: that of each stage */
} part;

/* A bake takes as long as its points are many: where halves will follow, so much is left of it. */
static const part parts[] = { { .from = 0.0, .share = WHOLE_SHARE },
							  { .from = 0.57, .share = 0.29, .name = "half the points" },
							  { .from = 0.86, .share = 0.14, .name = "a quarter of the points" } };

/* The part of halves, where the first part told all of the progress up to `told`. */
static part after(const part *half, double told)
{
	part p = *half;
	p.from = fmax(p.from, told);
	p.share = fmin(p.share, 1.0 - p.from);
	return p;
}

static void progress_of_part(void *user, const char *stage, double done)
{
	const part *p = user;
	if (p->whole->progress)
		p->whole->progress(p->whole->user, p->name ? p->name : stage, p->from + p->share * done);
}

static bool part_is_cancelled(void *user)
{
	const part *p = user;
	return p->whole->cancelled && p->whole->cancelled(p->whole->user);
}

static void whole_is_planned(void *user, const gw_bake_result *plan)
{
	const part *p = user;
	p->whole->planned(p->whole->user, plan);
}

/* Only the first part tells what is planned. */
static gw_bake_callbacks callbacks_of(part *p, const gw_bake_callbacks *whole)
{
	bool planned = whole && whole->planned && p->from <= 0.0;
	p->whole = whole;
	return whole ? (gw_bake_callbacks){ progress_of_part, part_is_cancelled, p,
										planned ? whole_is_planned : NULL }
				 : (gw_bake_callbacks){ .user = NULL };
}

/* A bake of which only the light is wanted, with the settings that the whole one began with. */
static gw_status bake_half(const gw_scene_description *all, const gw_half_sample *half,
						   const gw_bake_options *options, const gw_bake_callbacks *callbacks,
						   gw_bake_result **result, gw_error *error)
{
	const gw_scene_description scene = { &half->points, all->lights, all->light_count };
	gw_bake_options plain = *options;
	plain.estimate_points = 0;
	plain.max_error = plain.time_limit = 0.0f;
	plain.voxels = plain.lamps = plain.ambient_occlusion = plain.unknown = plain.errors = false;
	plain.bent_normals = false;
	if (plain.gaps == GW_GAPS_OPEN)
		plain.effects_forbidden |= 1u
								   << GW_EFFECT_GAPS; /* gaps that stay open light nothing else */
	return half->points.count > 0
			   ? gw_bake_once(&scene, &plain, false, callbacks, result, error)
			   : gw_fail(error, GW_ERROR_DATA, "nothing is left of the points in half of them");
}

/* The difference to half of the points, and where more is known from it, of half of that half. */
static gw_status compare_halves(const gw_scene_description *scene, const gw_bake_options *options,
								const gw_bake_callbacks *callbacks, double told,
								gw_bake_result *result, gw_error *error)
{
	gw_half_sample half, quarter = { .from = NULL };
	part second_part = after(&parts[1], told), third_part = after(&parts[2], told);
	const gw_bake_callbacks of_second = callbacks_of(&second_part, callbacks);
	const gw_bake_callbacks of_third = callbacks_of(&third_part, callbacks);
	gw_bake_result *of_half = NULL, *of_quarter = NULL;
	const gw_report *r = &result->report;
	gw_half_difference first = { 0 }, second = { 0 };
	double gathered = r->round_count > 0 ? r->round[0].error.gathered : r->error.gathered;
	gw_status status = gw_half_sample_make(scene->points, 0, &half, error);
	if (status == GW_OK)
		status = bake_half(scene, &half, options, &of_second, &of_half, error);
	if (status == GW_OK)
		first = gw_half_sample_difference(&half, of_half, result);
	bool more = status == GW_OK && gw_half_difference_all(&first) > r->error.relative_rms;
	if (more)
		status = gw_half_sample_make(&half.points, 1, &quarter, error);
	if (more && status == GW_OK)
		status = bake_half(scene, &quarter, options, &of_third, &of_quarter, error);
	if (more && status == GW_OK)
		second = gw_half_sample_difference(&quarter, of_quarter, of_half);
	if (status == GW_OK)
		gw_half_sample_add(&first, &second, gathered, &result->report.error);
	gw_bake_result_destroy(&of_half);
	gw_bake_result_destroy(&of_quarter);
	gw_half_sample_clear(&half);
	gw_half_sample_clear(&quarter);
	return status;
}

/* What bakes of half of the points say of the surface; nothing where half of them is no cloud. */
static gw_status check_by_halves(const gw_scene_description *scene, const gw_bake_options *options,
								 const gw_bake_callbacks *callbacks, double told,
								 gw_bake_result *result, gw_error *error)
{
	gw_report *r = &result->report;
	double start = gw_seconds();
	gw_status status = compare_halves(scene, options, callbacks, told, result, error);
	gw_report_add_stage(r, "half the points", gw_seconds() - start);
	double wanted = (double)options->max_error;
	if (status == GW_OK && wanted > 0.0 && r->error.relative_rms > wanted && !r->missed) {
		r->missed = true;
		r->goal = GW_GOAL_EXHAUSTED;
	}
	if (r->price.error > 0.0 && r->price.error < r->error.halves)
		r->price = (gw_price){ 0 };
	return status == GW_ERROR_DATA ? GW_OK : status;
}

gw_status gw_bake(const gw_scene_description *scene, const gw_bake_options *options,
				  const gw_bake_callbacks *callbacks, gw_bake_result **result, gw_error *error)
{
	const gw_bake_options ordinary = gw_bake_options_default();
	double start = gw_seconds();
	*result = NULL;
	options = options ? options : &ordinary;
	GW_TRY(gw_options_check(options, scene, error));
	const gw_bake_options effective = gw_options_effective(options);
	options = &effective;
	part first = parts[0];
	first.share = gw_half_sample_is_likely(scene->points, options) ? first.share : 1.0;
	const gw_bake_callbacks of_first = callbacks_of(&first, callbacks);
	GW_TRY(gw_bake_once(scene, options, false, &of_first, result, error));
	/* Two smaller bakes take less than twice as long as this one did. */
	bool in_time =
		!(options->time_limit > 0.0f) || gw_seconds() - start < 0.5 * (double)options->time_limit;
	if (!in_time || !gw_half_sample_is_wanted(scene->points, &effective, &(*result)->report))
		return GW_OK;
	gw_status status = check_by_halves(scene, options, callbacks, first.share, *result, error);
	if (status != GW_OK)
		gw_bake_result_destroy(result);
	return status;
}

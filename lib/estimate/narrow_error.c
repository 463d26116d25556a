/*
 * narrow_error.c - see narrow_error.h.
 */
#include "estimate/narrow_error.h"

#include "base/luminance.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "base/shared_math.h"
#include "estimate/check_light.h"
#include "estimate/check_point_choice.h"
#include "light/cpu_loop.h"
#include "light/direct_light.h"
#include "light/shader_functions.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

/* Few points lie where such things have their shadows: a tenth of them, half of which see no
 * difference with the number that they have. */
#define POINTS 1024u
#define RAYS 16u /* of each, in two halves; even */

/* So near, in radii, discs that face alike are of the surface that a ray leaves. */
#define OWN_RADII 2.0f

/* Steps between the points' numbers, which are spread evenly whatever part of them one takes. */
#define GOLDEN 0.61803398874989484

#define FAR_METRES 1e30f
#define CHUNK 16u

typedef struct check {
	const gw_side_task *task;
	gw_lamp *lamp; /* lamps */
	size_t lamps;
	gw_check_point_choice choice;
	double *gain;   /* choice.count: radiance that each has more of without the discs in doubt */
	double *square; /* and its square, without noise on average */
	double *albedo; /* mean, of what its rays meet; 0 where that is nothing */
	atomic_bool stopped;
} check;

/* A point that is looked from. */
typedef struct place {
	size_t surfel;
	gw_vec3 at;
	gw_check_ray ray; /* with all but a direction and its end */
	float number;     /* in (0, 1] */
} place;

/* What the same ray meets with the discs in doubt, and without them. */
static void trace_both(const check *c, const place *from, const gw_check_ray *ray, float until,
					   gw_check_hit hit[2])
{
	const gw_surfels *s = c->task->surfels;
	gw_check_ray without = *ray;
	without.unless = from->number;
	hit[0] = hit[1] = gw_check_discs_trace(c->task->discs, ray, until);
	if (hit[0].small != GW_NONE && s->doubt[hit[0].small] >= from->number)
		hit[1] = gw_check_discs_trace(c->task->discs, &without, until);
}

/* Irradiance that the point has more of from lamps. */
static double gain_of_lamps(const check *c, const place *from)
{
	const gw_octree *o = c->task->octree;
	const gw_surfels *s = c->task->surfels;
	const float *shone_on = s->shading_normal ? s->shading_normal : s->normal;
	gw_vec3 towards, low = gw_xyz(o->cube_minimum);
	const gw_check_place lit = { gw_times(gw_minus(from->at, low), 1 / o->leaf_size),
								 gw_xyz(shone_on + 3 * from->surfel) };
	double sum = 0.0;
	for (size_t l = 0; l < c->lamps; l++) {
		const gw_lamp *lamp = &c->lamp[l];
		float distance, range,
			turn = unit_float(pcg_hash2((uint32_t)from->surfel, lamp->push.seed));
		double whole = gw_check_lamp_light(lamp, &lit, &towards, &distance);
		for (uint32_t k = 0; k < lamp->push.samples && whole > 0.0; k++) {
			gw_check_hit hit[2];
			gw_check_ray ray = from->ray;
			ray.direction = gw_lamp_aim(lamp, k, turn, towards, distance, &range);
			ray.t_max = lamp->push.type == GW_PUSH_SUN ? FAR_METRES : range * o->leaf_size;
			trace_both(c, from, &ray, GW_THROUGH_LEAST, hit);
			double with = hit[0].small == GW_NONE ? (double)hit[0].through[0] : 0.0;
			double without = hit[1].small == GW_NONE ? (double)hit[1].through[0] : 0.0;
			sum += whole * (without - with) / lamp->push.samples;
		}
	}
	return sum;
}

/* What is seen along a ray: backs of surfaces are dark. */
static double light_along(const check *c, const gw_check_ray *ray, const gw_check_hit *hit)
{
	const gw_surfels *s = c->task->surfels;
	size_t met = hit->small;
	if (hit->small == GW_NONE)
		return gw_check_sky_light(&c->task->sky, ray->direction);
	bool front = gw_dot(gw_xyz(s->normal + 3 * met), ray->direction) < 0.0f;
	return front || s->two_sided[met] ? (double)c->task->radiance[met] : 0.0;
}

/* Irradiance over pi that the point has more of from all around, by two halves of the rays, each a
 * half; returns the mean albedo of what they meet. */
static double gain_from_around(const check *c, const place *from, double gain[2])
{
	const gw_surfels *s = c->task->surfels;
	double albedo = 0.0;
	for (uint32_t k = 0; k < RAYS && c->task->radiance; k++) {
		gw_check_hit hit[2];
		gw_check_ray ray = from->ray;
		ray.direction = gw_record_ray(from->at, ray.facing, k, RAYS, c->task->seed);
		ray.t_max = FAR_METRES;
		trace_both(c, from, &ray, gw_record_chance(from->at, k, c->task->seed), hit);
		gain[k % 2] += (light_along(c, &ray, &hit[1]) - light_along(c, &ray, &hit[0])) / RAYS;
		if (hit[0].small != GW_NONE)
			albedo += gw_luminance(s->albedo + 3 * (size_t)hit[0].small) / RAYS;
	}
	return albedo;
}

static void look(check *c, size_t i)
{
	const gw_surfels *s = c->task->surfels;
	size_t surfel = c->choice.point[i];
	double number = fmod((double)(i + 1) * GOLDEN, 1.0), gain[2] = { 0 };
	place from = { .surfel = surfel,
				   .at = gw_xyz(s->position + 3 * surfel),
				   .number = 1.0f - (float)number };
	from.ray =
		(gw_check_ray){ .origin = from.at,
						.facing = gw_xyz(s->normal + 3 * surfel),
						.own = fmaxf(OWN_RADII * s->radius[surfel], c->task->octree->leaf_size),
						.both_sides = true,
						.whole = true };
	double reflectance = gw_luminance(s->albedo + 3 * surfel);
	c->albedo[i] = gain_from_around(c, &from, gain);
	double lamps = gain_of_lamps(c, &from) / (2.0 * GW_PI);
	for (int half = 0; half < 2; half++)
		gain[half] = reflectance * (gain[half] + lamps);
	c->gain[i] = gain[0] + gain[1];
	c->square[i] = 4.0 * gain[0] * gain[1];
}

static void look_from(void *user, size_t first, size_t last, uint32_t worker)
{
	check *c = user;
	for (size_t i = first; i < last; i++) {
		if (gw_loop_stopped(c->task->gpu, worker, &c->stopped))
			return;
		look(c, i);
	}
}

/* What is off on average is so in each reflection: 1 + kept + kept^2 and so on. */
static double reflections(const check *c)
{
	double kept = 0.0;
	uint32_t limit = c->task->radiance ? c->task->limit : 1;
	for (size_t i = 0; i < c->choice.count; i++)
		kept += c->choice.weight[i] * c->albedo[i];
	return gw_check_reflections(kept, limit);
}

/* The mean square of a share that is anything from 0 to 1 is a third. */
static double conclude(const check *c)
{
	double mean = gw_check_point_average(&c->choice, c->gain).mean;
	double square = gw_check_point_average(&c->choice, c->square).mean;
	double single = fmax(square - mean * mean, 0.0);
	return hypot(reflections(c) * mean, sqrt(single)) / sqrt(3.0);
}

static gw_status look_and_conclude(check *c, double *rms, gw_error *error)
{
	size_t count = c->choice.count;
	double *room = gw_allocate_zeros(count, 3 * sizeof *room);
	c->lamp = gw_allocate_array(c->task->light_count + 1, sizeof *c->lamp);
	if (!room || !c->lamp) {
		free(room);
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu points", count);
	}
	c->gain = room;
	c->square = room + count;
	c->albedo = room + 2 * count;
	c->lamps = gw_side_lamps(c->task, c->lamp);
	gw_parallel_for(c->task->threads, count, CHUNK, look_from, c);
	bool stopped = atomic_load(&c->stopped);
	if (!stopped)
		*rms = conclude(c);
	free(room);
	return stopped ? gw_fail(error, GW_ERROR_CANCELLED, "stopped while narrow things were checked")
				   : GW_OK;
}

gw_status gw_narrow_error(const gw_side_task *task, const bool *counts, double *rms,
						  gw_error *error)
{
	const gw_surfels *s = task->surfels;
	check c = { .task = task };
	*rms = 0.0;
	if (!s->doubt)
		return GW_OK;
	gw_status status =
		gw_check_point_choose(&(gw_check_point_shares){ s->count, counts, NULL, 0, NULL }, POINTS,
							  task->seed, &c.choice, error);
	if (status == GW_OK && c.choice.count > 1)
		status = look_and_conclude(&c, rms, error);
	free(c.lamp);
	gw_check_point_choice_clear(&c.choice);
	return status;
}

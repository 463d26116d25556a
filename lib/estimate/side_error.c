/*
 * side_error.c - see side_error.h.
 */
#include "estimate/side_error.h"

#include "base/luminance.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "base/shared_math.h"
#include "cloud/frame.h"
#include "estimate/check_light.h"
#include "estimate/check_point_choice.h"
#include "estimate/side_components.h"
#include "light/cpu_loop.h"
#include "light/direct_light.h"
#include "light/shader_functions.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

/* Where all normals were given, one of so many of them is looked at first; the rest only where more
 * than this share of all rays says that something is wrong. Of a room with one of six walls turned
 * that is 0.14. Less there is where noisy points see each other's backs at grazing angles, or
 * sheets have one side alone: they still face as they were given. */
#define FIRST_STEP 6u
#define SUSPECT 0.1
/* Nor is it where more than this share of what rays meet says so, as above and below a plate over a
 * floor: such a scene is not closed anywhere, and sheets are seen from either side. */
#define SHEETS 0.5
#define RAYS 32u /* of each side, in two halves; even */
#define LAMP_RAYS 4u

/* So near, in radii, discs that face alike are of the surface that a ray leaves. */
#define OWN_RADII 2.0f

/* Rays begin so far above the disc, in radii. */
#define ABOVE_RADII 0.15f

/* The rays of a point lie close together: they say as much as so many that do not. */
#define OWN_OPINIONS 8.0

/* By how much a scanner that saw a point makes it less likely that it faces the wrong way: the
 * logarithm of a factor. What the point's own rays say is worth no more then: they may meet the
 * backs of things that have no underside, since no scanner saw that. */
#define SEEN_ODDS 6.0

/* Pieces of surface are not asked for where a smaller share of the points is likely to be wrong. */
#define WRONG_LEAST 5e-4

/* Where no ray differs there may still be one in so many. */
#define SHARE_LEAST 1e-6

#define FAR_METRES 1e30f
#define CHUNK 4u

/* What one side of a point sees. */
typedef struct side {
	double light[2];  /* radiance that it would send out, by two halves of the rays */
	uint32_t fits;    /* rays that meet what that side should see, if both are right */
	uint32_t differs; /* that meet the opposite */
	uint32_t leaves;  /* that leave the scene */
} side;

typedef struct check {
	const gw_side_task *task;
	gw_lamp *lamp; /* lamps */
	size_t lamps;
	gw_check_point_choice choice;
	uint32_t step;    /* one of so many of them is looked at */
	side (*found)[2]; /* choice.count: front, back; all 0 where nobody looked */
	double *value[2]; /* choice.count: see below */
	double *wrong;    /* choice.count: probability that a point faces the wrong way */
	atomic_bool stopped;
} check;

/* ---------------------------------------------------------------------------------------- rays */

/* What lamps send to one side of a surfel. */
static double light_of_lamps(const check *c, size_t surfel, gw_vec3 facing)
{
	const gw_octree *o = c->task->octree;
	const gw_surfels *s = c->task->surfels;
	gw_vec3 at = gw_xyz(s->position + 3 * surfel), towards;
	const gw_check_place place = {
		gw_times(gw_minus(at, gw_xyz(o->cube_minimum)), 1 / o->leaf_size), facing
	};
	double sum = 0.0;
	for (size_t l = 0; l < c->lamps; l++) {
		const gw_lamp *lamp = &c->lamp[l];
		float distance, range, turn = unit_float(pcg_hash2((uint32_t)surfel, lamp->push.seed));
		double whole = gw_check_lamp_light(lamp, &place, &towards, &distance);
		for (uint32_t k = 0; k < lamp->push.samples && whole > 0.0; k++) {
			gw_check_ray ray = { .origin = at,
								 .direction = gw_lamp_aim(lamp, k, turn, towards, distance, &range),
								 .facing = facing,
								 .own = OWN_RADII * s->radius[surfel],
								 .both_sides = true };
			ray.t_max = lamp->push.type == GW_PUSH_SUN ? FAR_METRES : range * o->leaf_size;
			gw_check_hit hit = gw_check_discs_trace(c->task->discs, &ray, GW_THROUGH_LEAST);
			double share = hit.small == GW_NONE ? (double)hit.through[0] : 0.0;
			sum += whole * share / lamp->push.samples;
		}
	}
	return sum;
}

/* A ray of a side, and so near, metres, the surface that it leaves says nothing. */
typedef struct point_ray {
	gw_check_ray ray;
	bool front;
	float own;
} point_ray;

/* What it brings, and what it says. */
static void add_ray(const check *c, const point_ray *from, uint32_t k, side *to)
{
	const gw_check_ray *ray = &from->ray;
	const gw_surfels *s = c->task->surfels;
	float chance = gw_record_chance(ray->origin, k, c->task->seed);
	gw_check_hit hit = gw_check_discs_trace(c->task->discs, ray, chance);
	uint32_t met = hit.small;
	double light = 0.0;
	bool meets_front = false, near = false;
	if (met == GW_NONE) {
		light = c->task->radiance ? gw_check_sky_light(&c->task->sky, ray->direction) : 0.0;
	} else {
		gw_vec3 normal = gw_xyz(s->normal + 3 * (size_t)met);
		gw_vec3 way = gw_minus(gw_xyz(s->position + 3 * (size_t)met), ray->origin);
		float approach = gw_dot(normal, ray->direction);
		meets_front = approach < 0.0f;
		near = fabsf(gw_dot(normal, way)) < from->own * fabsf(approach);
		if ((meets_front || s->two_sided[met]) && c->task->radiance)
			light = (double)c->task->radiance[met];
	}
	to->light[k % 2] += light / RAYS;
	if (met == GW_NONE)
		to->leaves++;
	if (met == GW_NONE || s->two_sided[met] || near)
		return;
	to->fits += meets_front == from->front;
	to->differs += meets_front != from->front;
}

static void look(const check *c, size_t surfel, bool front, side *to)
{
	const gw_surfels *s = c->task->surfels;
	gw_vec3 normal = gw_times(gw_xyz(s->normal + 3 * surfel), front ? 1.0f : -1.0f);
	double reflectance = gw_luminance(s->albedo + 3 * surfel);
	gw_vec3 at = gw_xyz(s->position + 3 * surfel);
	point_ray from = {
		.ray = { .origin = gw_plus(at, gw_times(normal, ABOVE_RADII * s->radius[surfel])),
				 .facing = normal,
				 .t_max = FAR_METRES,
				 .both_sides = true },
		.front = front,
		.own = OWN_RADII * s->radius[surfel],
	};
	*to = (side){ 0 };
	for (uint32_t k = 0; k < RAYS; k++) {
		from.ray.direction = gw_record_ray(at, normal, k, RAYS, c->task->seed);
		add_ray(c, &from, k, to);
	}
	double lamps = light_of_lamps(c, surfel, normal) / (2.0 * GW_PI);
	for (int half = 0; half < 2; half++)
		to->light[half] = reflectance * (to->light[half] + lamps);
}

static void look_from(void *user, size_t first, size_t last, uint32_t worker)
{
	check *c = user;
	for (size_t i = first; i < last; i++) {
		if (gw_loop_stopped(c->task->gpu, worker, &c->stopped))
			return;
		side *at = c->found[i * c->step];
		for (int back = 0; back < 2 && at[back].fits + at[back].differs == 0; back++)
			look(c, c->choice.point[i * c->step], back == 0, &at[back]);
	}
}

static gw_status look_at(check *c, uint32_t step, gw_error *error)
{
	c->step = step;
	gw_parallel_for(c->task->threads, (c->choice.count + step - 1) / step, CHUNK, look_from, c);
	return atomic_load(&c->stopped)
			   ? gw_fail(error, GW_ERROR_CANCELLED, "stopped while sides were checked")
			   : GW_OK;
}

/* ------------------------------------------------------------------------------------- finding */

static bool is_unknown(const check *c, size_t i)
{
	return c->task->surfels->two_sided[c->choice.point[i]];
}

/* Rays from the front of a point that leave the scene, as far as its back sees nothing: that the
 * point lies in the open and faces what is open fits. Where the back sees surface, the front of a
 * room's wall that was turned leaves the scene, too. Where normals were given, nobody looked for
 * the open side; and where each side is lit by itself, the one that is shown is no more the front
 * than the other: what leaves says as much for either. */
static double open_rays(const check *c, size_t i)
{
	const gw_surfels *s = c->task->surfels;
	const side *of = c->found[i];
	bool either = is_unknown(c, i) && gw_surfels_one_sided(s, c->choice.point[i]);
	if (either || s->normals_given == s->count)
		return 0.0;
	double met = (double)(of[1].fits + of[1].differs) / RAYS;
	return (1.0 - met) * of[0].leaves;
}

/* Share of the rays that differ, of one point. */
static double differing(const check *c, size_t i)
{
	const side *of = c->found[i];
	double differs = of[0].differs + of[1].differs;
	double all = differs + of[0].fits + of[1].fits + open_rays(c, i);
	return all > 0.0 ? differs / all : 0.5;
}

static double share_differing(const check *c)
{
	double differs = 0.0, all = 0.0;
	for (size_t i = 0; i < c->choice.count; i++) {
		const side *of = c->found[i];
		double opposite = of[0].differs + of[1].differs;
		differs += c->choice.weight[i] * opposite;
		all += c->choice.weight[i] * (opposite + of[0].fits + of[1].fits + open_rays(c, i));
	}
	return all > 0.0 ? differs / all : 0.0;
}

/* The same of all rays, also those that meet nothing, of the points that were looked at, where all
 * count alike: normals were given. */
static double share_of_rays(const check *c)
{
	double differs = 0.0;
	for (size_t i = 0; i < c->choice.count; i++)
		differs += c->found[i][0].differs + c->found[i][1].differs;
	return differs / (2.0 * RAYS * ((c->choice.count + c->step - 1) / c->step));
}

/* The share w of points that are wrong, where 2 w (1 - w) of the rays differ. */
static double share_wrong(double differing)
{
	double w = 0.5 * (1.0 - sqrt(fmax(1.0 - 2.0 * differing, 0.0)));
	return fmax(w, SHARE_LEAST);
}

/* That a point faces the wrong way: a ray of it differs with probability w where it does not, and
 * with 1 - w where it does. Before any ray, w of the points do, and half of those whose side nobody
 * knows. */
static double probability(const check *c, size_t i, double w)
{
	const side *of = c->found[i];
	bool unknown = is_unknown(c, i);
	double odds = log(w / (1.0 - w));
	double rays = of[0].fits + of[1].fits + of[0].differs + of[1].differs + open_rays(c, i);
	double says = fmin(rays, OWN_OPINIONS) * (1.0 - 2.0 * differing(c, i)) * odds;
	if (c->task->seen && !unknown)
		says = fmin(says, SEEN_ODDS) - SEEN_ODDS;
	return 1.0 / (1.0 + exp(-says - (unknown ? 0.0 : odds)));
}

/* By how much the light of a side is less than what is written, by each half of its rays. */
static void miss(const side *of, double written, double off[2])
{
	for (int half = 0; half < 2; half++)
		off[half] = 2.0 * of->light[half] - written;
}

/* What a point is off by that is lit from both sides, of which one is right: p is the back's. */
static void list_unknown(check *c, size_t i, double p)
{
	const side *of = c->found[i];
	double front = of[0].light[0] + of[0].light[1], back = of[1].light[0] + of[1].light[1];
	double off[2][2];
	double written = c->task->radiance && c->task->whole
						 ? (double)c->task->radiance[c->choice.point[i]]
						 : fmax(front, back);
	miss(&of[0], written, off[0]);
	miss(&of[1], written, off[1]);
	c->value[0][i] = (1.0 - p) * (front - written) + p * (back - written);
	c->value[1][i] = (1.0 - p) * off[0][0] * off[0][1] + p * off[1][0] * off[1][1];
}

/* What each point is off by, and its square without noise, on average; returns the share of points
 * that face the wrong way. */
static double list_errors(check *c)
{
	double wrong = 0.0;
	for (size_t i = 0; i < c->choice.count; i++) {
		const side *of = c->found[i];
		double p = c->wrong[i];
		double more[2] = { of[1].light[0] - of[0].light[0], of[1].light[1] - of[0].light[1] };
		wrong += c->choice.weight[i] * (is_unknown(c, i) ? fmin(p, 1.0 - p) : p);
		c->value[0][i] = p * (more[0] + more[1]);
		c->value[1][i] = p * 4.0 * more[0] * more[1];
		if (is_unknown(c, i))
			list_unknown(c, i, p);
	}
	return wrong;
}

/* --------------------------------------------------------------------------------- components */

/* Of the points of a component of surface, together. */
typedef struct component_rays {
	double differs, all; /* rays */
	double wrong, points;
} component_rays;

static void add_to_component(const check *c, size_t i, component_rays *to)
{
	const side *of = c->found[i];
	double weight = c->choice.weight[i], opposite = of[0].differs + of[1].differs;
	to->all += weight * (opposite + of[0].fits + of[1].fits + open_rays(c, i));
	to->differs += weight * opposite;
	to->wrong += weight * c->wrong[i];
	to->points += weight;
}

/* What is wrong of a component at most, over what its points say one by one. As w of all points are
 * wrong, of a component with a share v of wrong ones v (1 - w) + (1 - v) w of the rays differ. */
static double part_of(const component_rays *component, double w)
{
	double differs = component->all > 0.0 ? component->differs / component->all : 1.0;
	double most = fmin(fmax((differs - w) / fmax(1.0 - 2.0 * w, SHARE_LEAST), 0.0), 1.0);
	return component->wrong > 0.0 ? fmin(most * component->points / component->wrong, 1.0) : 1.0;
}

/* Where a few points of a component see backs and the others do not, something is missing
 * elsewhere, as the underside of what stands on a floor. */
static void limit_by_components(check *c, const uint32_t *component, component_rays *rays_of,
								double w)
{
	for (size_t i = 0; i < c->choice.count; i++)
		if (!is_unknown(c, i))
			add_to_component(c, i, &rays_of[component[c->choice.point[i]]]);
	for (size_t i = 0; i < c->choice.count; i++)
		if (!is_unknown(c, i))
			c->wrong[i] *= part_of(&rays_of[component[c->choice.point[i]]], w);
}

static gw_status ask_components(check *c, double w, gw_error *error)
{
	size_t count = c->task->surfels->count;
	uint32_t *component = gw_allocate_array(count, sizeof *component);
	component_rays *rays_of = gw_allocate_zeros(count, sizeof *rays_of);
	gw_status status =
		component && rays_of
			? gw_side_components_find(c->task->surfels, c->task->threads, component, error)
			: gw_fail(error, GW_ERROR_MEMORY, "no memory for components of %zu points", count);
	if (status == GW_OK)
		limit_by_components(c, component, rays_of, w);
	free(component);
	free(rays_of);
	return status;
}

static gw_status find_wrong(check *c, gw_error *error)
{
	double w = share_wrong(share_differing(c)), wrong = 0.0;
	for (size_t i = 0; i < c->choice.count; i++) {
		c->wrong[i] = probability(c, i, w);
		wrong += is_unknown(c, i) ? 0.0 : c->choice.weight[i] * c->wrong[i];
	}
	return wrong > WRONG_LEAST ? ask_components(c, w, error) : GW_OK;
}

/* What is off on average is so in each reflection: 1 + kept + kept^2 and so on. */
static double reflections(const check *c)
{
	double kept = 0.0;
	uint32_t limit = c->task->radiance ? c->task->limit : 1;
	for (size_t i = 0; i < c->choice.count; i++)
		kept += c->choice.weight[i] *
				gw_luminance(c->task->surfels->albedo + 3 * (size_t)c->choice.point[i]);
	return gw_check_reflections(kept, limit);
}

static void conclude(check *c, gw_side_finding *found)
{
	found->share = list_errors(c);
	gw_check_point_mean off = gw_check_point_average(&c->choice, c->value[0]);
	gw_check_point_mean square = gw_check_point_average(&c->choice, c->value[1]);
	double single = fmax(square.mean - off.mean * off.mean, 0.0);
	found->rms = hypot(reflections(c) * off.mean, sqrt(single));
	found->spread = fmin(sqrt(square.variance) / (2.0 * found->rms), sqrt(sqrt(square.variance)));
}

/* What a point that is lit from both sides may be off by: its light. */
static double doubt(const check *c, size_t i)
{
	if (!c->task->surfels->two_sided[i])
		return 0.0;
	return c->task->radiance ? (double)c->task->radiance[i] : 1.0;
}

static gw_status draw(check *c, gw_error *error)
{
	const gw_surfels *s = c->task->surfels;
	bool *counts = gw_allocate_array(s->count, sizeof *counts);
	double *unknown = gw_allocate_array(s->count, sizeof *unknown), sum = 0.0;
	const double *const part[] = { unknown };
	const gw_check_point_shares shares = { s->count, counts, part, 1, unknown };
	gw_status status = GW_OK;
	if (!counts || !unknown)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu points", s->count);
	for (size_t i = 0; i < s->count && status == GW_OK; i++) {
		counts[i] = !gw_surfel_emits(s, i) && (!c->task->asked || c->task->asked[i]);
		unknown[i] = doubt(c, i);
		sum += counts[i] ? unknown[i] : 0.0;
	}
	if (status == GW_OK)
		status = gw_check_point_choose(&shares, sum > 0.0 ? 2 * GW_SIDE_POINTS : GW_SIDE_POINTS,
									   c->task->seed, &c->choice, error);
	free(unknown);
	free(counts);
	return status;
}

size_t gw_side_lamps(const gw_side_task *task, gw_lamp *lamp)
{
	size_t lamps = 0;
	for (size_t i = 0; i < task->light_count; i++) {
		if (!gw_light_shines(&task->lights[i]))
			continue;
		gw_lamp *own = &lamp[lamps++];
		*own = gw_lamp_of(&task->lights[i], task->octree, task->surfels, task->options);
		own->push.samples = own->push.samples < LAMP_RAYS ? own->push.samples : LAMP_RAYS;
	}
	return lamps;
}

static bool any_unknown(const check *c)
{
	bool any = false;
	for (size_t i = 0; i < c->choice.count && !any; i++)
		any = is_unknown(c, i);
	return any;
}

static gw_status look_and_conclude(check *c, gw_side_finding *found, gw_error *error)
{
	const gw_surfels *s = c->task->surfels;
	bool sure = s->normals_given == s->count;
	gw_status status = GW_OK;
	if (sure)
		status = look_at(c, FIRST_STEP, error);
	if (status != GW_OK || (sure && (share_of_rays(c) < SUSPECT || share_differing(c) > SHEETS)))
		return status;
	status = look_at(c, 1, error);
	if (status != GW_OK || !(share_differing(c) > 0.0 || any_unknown(c)))
		return status;
	GW_TRY(find_wrong(c, error));
	conclude(c, found);
	return GW_OK;
}

gw_status gw_side_error(const gw_side_task *task, gw_side_finding *found, gw_error *error)
{
	check c = { .task = task };
	*found = (gw_side_finding){ 0 };
	gw_status status = draw(&c, error);
	uint32_t count = c.choice.count;
	c.lamp = gw_allocate_array(task->light_count + 1, sizeof *c.lamp);
	c.found = gw_allocate_zeros(count + 1, sizeof *c.found);
	c.value[0] = gw_allocate_array(count + 1, 3 * sizeof *c.value[0]);
	c.value[1] = c.value[0] ? c.value[0] + count : NULL;
	c.wrong = c.value[0] ? c.value[0] + 2 * (size_t)count : NULL;
	if (status == GW_OK && (!c.lamp || !c.found || !c.value[0]))
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory to look from %u points", count);
	if (status == GW_OK && count > 1) {
		c.lamps = gw_side_lamps(c.task, c.lamp);
		status = look_and_conclude(&c, found, error);
	}
	gw_check_point_choice_clear(&c.choice);
	free(c.value[0]);
	free(c.found);
	free(c.lamp);
	return status;
}

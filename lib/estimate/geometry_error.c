/*
 * geometry_error.c - see geometry_error.h.
 */
#include "estimate/geometry_error.h"

#include "estimate/check_discs.h"
#include "estimate/check_light.h"
#include "light/cpu_loop.h"
#include "light/direct_light.h"
#include "base/luminance.h"
#include "base/memory.h"
#include "cloud/frame.h"
#include "base/parallel.h"
#include "estimate/check_point_choice.h"
#include "light/shader_functions.h"
#include "base/shared_math.h"
#include "light/transport_layout.h"
#include "octree/octree_layout.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

/* Rays of records that are looked at, half of them such that leave the scene: a tenth of what a
 * bake of 100,000 points takes. */
#define RAYS_MOST 32768u

/* Points that look at the lamps, and the least, where lamps are many or have an extent. */
#define LAMP_POINTS_MOST 4000u
#define LAMP_POINTS_LEAST 50u

/* So near, discs that face alike are of the surface that a ray leaves: radii, and of records, which
 * have none, spacings. It is a cell of the octree at least: where points lie much closer, as right
 * under a scanner, their noise stacks discs that are smaller than it. */
#define OWN_RADII 2.0f
#define OWN_SPACINGS 3.2f

/* Share of the rays that pass the backs of discs, from which on a place may be inside something. */
#define BEHIND_LEAST 0.25

#define FAR_METRES 1e30f
#define ROUNDING 1e-4 /* of a lamp's light */
#define CHUNK 16u

/* What is read of the device. */
typedef struct views {
	gw_view position, normal;    /* of records */
	gw_view hit, distance;       /* of their rays */
	gw_view reflected, emission; /* of facets */
	gw_view leaf;                /* of facets, where some surfels emit */
	gw_view first, fragment;     /* surfels of leaves, likewise */
	gw_view texel;               /* of the sky's map */
} views;

/* What one record's rays say; sums over those that were looked at stand for all. */
typedef struct gathered {
	double excess[2]; /* radiance that two halves of the rays bring too much, each a half */
	double albedo;    /* mean, of what the rays meet; 0 where that is nothing */
} gathered;

typedef struct check {
	const gw_geometry_task *task;
	views view;
	uint32_t stride_leaving, stride_hit; /* one of so many rays is looked at */
	gathered *record;
	const gw_lamp *lamp; /* lamps */
	size_t lamps;
	gw_check_point_choice choice; /* the points that look at them, and */
	double *excess;               /* radiance that each has too much */
	atomic_bool stopped;          /* somebody asked to stop: what is found is not whole */
} check;

/* What was found of one kind of light, in radiance and its squares. */
typedef struct finding {
	double mean, variance; /* of all points' error, and of the finding */
	double square;         /* mean square error, noise taken off */
	double kept;           /* share of light that is reflected again */
} finding;

static double reflectance(const gw_surfels *s, size_t i)
{
	return gw_luminance(s->albedo + 3 * i);
}

/* By how much a value lies outside of what two say. */
static double outside(double value, double a, double b)
{
	return value - fmin(fmax(value, fmin(a, b)), fmax(a, b));
}

/* ----------------------------------------------------------------------------------- gathering */

static double sky_light(const check *c, gw_vec3 d)
{
	const gw_sky_view sky = { c->task->sky, c->task->map, c->view.texel.bytes };
	return gw_check_sky_light(&sky, d);
}

static double emission_of(const gw_surfels *s, uint32_t surfel)
{
	return surfel == GW_NONE || !gw_surfels_emit(s)
			   ? 0.0
			   : gw_luminance(s->emission + 3 * (size_t)surfel);
}

/* Is a surfel one of those that a facet is the mean of? */
static bool is_part(const check *c, uint32_t facet, uint32_t surfel)
{
	const uint32_t *first = c->view.first.bytes, *word = c->view.fragment.bytes;
	size_t leaf = gw_facet_leaf(((const uint32_t *)c->view.leaf.bytes)[facet]);
	for (uint32_t f = first[leaf]; f < first[leaf + 1]; f++)
		if ((word[f] & GW_FRAGMENT_ROI) == 0 && (word[f] & GW_FRAGMENT_SURFEL) == surfel)
			return true;
	return false;
}

/* Do a facet and a surfel that the same ray meets agree about what emits? */
static bool agree(const check *c, uint32_t facet, double emission, uint32_t surfel)
{
	return surfel != GW_NONE &&
		   ((emission > 0.0) == (emission_of(c->task->surfels, surfel) > 0.0) ||
			is_part(c, facet, surfel));
}

/* What a facet sends to a ray. Its emission is a mean over all that lies in it, which matters
 * little where emitters are sampled by their area: as long as discs agree that the ray meets one,
 * or none, theirs counts. */
static double facet_light(const check *c, uint32_t facet, const gw_check_hit *hit)
{
	const float *reflected = c->view.reflected.bytes, *mean = c->view.emission.bytes;
	double light = reflected ? gw_luminance(reflected + 4 * (size_t)facet) : 0.0;
	double emission = mean ? gw_luminance(mean + 4 * (size_t)facet) : 0.0;
	if (mean && agree(c, facet, emission, hit->small))
		emission = emission_of(c->task->surfels, hit->small);
	else if (mean && agree(c, facet, emission, hit->large))
		emission = emission_of(c->task->surfels, hit->large);
	return light + emission;
}

static uint32_t facet_hit(const check *c, size_t record, uint32_t k)
{
	return ((const uint32_t *)c->view.hit.bytes)[record * c->task->rays->rays + k];
}

static bool is_buried(const check *c, size_t record)
{
	return ((const float *)c->view.normal.bytes)[4 * record + 3] < 1.0f;
}

/* Whether what a ray met counts for its record. */
static bool is_seen(const check *c, size_t record, uint32_t k)
{
	const float *distance = c->view.distance.bytes;
	return !is_buried(c, record) || distance[record * c->task->rays->rays + k] >= 0.0f;
}

/* What one ray says. */
typedef struct ray_finding {
	double excess;         /* radiance that it brings too much */
	double albedo;         /* of what it meets */
	bool passed_back_face; /* of a disc */
} ray_finding;

/* What a surfel sends along a ray; the back of what lets light through is dark. */
static double light_of(const gw_geometry_task *t, uint32_t surfel, gw_vec3 direction)
{
	const gw_surfels *s = t->surfels;
	bool dark = s->transparency && s->transparency[surfel] > 0.0f && !s->two_sided[surfel] &&
				gw_dot(gw_xyz(s->normal + 3 * (size_t)surfel), direction) > 0.0f;
	return dark ? 0.0 : (double)t->radiance[surfel];
}

/* What a facet and two discs send to a ray. */
typedef struct ray_light {
	double found, small, large;
} ray_light;

/* Makes it that of the place that the ray meets: facets have the light of several points, and what
 * differs by where these lie is no fault of the octree. */
static void light_at_place(const check *c, size_t record, uint32_t k, const gw_hit_place *at,
						   const gw_check_hit *hit, ray_light *light)
{
	const gw_hit_light *h = c->task->hit_light;
	uint32_t facet = facet_hit(c, record, k);
	if (!h || facet == GW_NONE || !is_seen(c, record, k))
		return;
	light->found += gw_hit_light_beyond_facet(h, facet, at);
	light->small += gw_hit_light_beyond_point(h, facet, hit->small, at);
	light->large += gw_hit_light_beyond_point(h, facet, hit->large, at);
}

/* How far from its record a ray meets a facet, leaf cells. */
static float distance_of(const check *c, size_t record, uint32_t k)
{
	return fabsf(((const float *)c->view.distance.bytes)[record * c->task->rays->rays + k]);
}

static ray_finding check_ray(const check *c, size_t record, uint32_t k)
{
	const gw_geometry_task *t = c->task;
	const float *low = t->octree->cube_minimum;
	const float *own = (const float *)c->view.normal.bytes + 4 * record;
	gw_vec3 place = gw_xyz((const float *)c->view.position.bytes + 4 * record);
	gw_check_ray ray = { .direction =
							 gw_record_ray(place, gw_xyz(own), k, t->rays->rays, t->rays->seed),
						 .facing = gw_xyz(own),
						 .own = OWN_SPACINGS * t->surfels->spacing,
						 .t_max = FAR_METRES };
	ray.origin =
		gw_plus((gw_vec3){ low[0], low[1], low[2] }, gw_times(place, t->octree->leaf_size));
	gw_check_hit hit =
		gw_check_discs_trace(c->task->discs, &ray, gw_record_chance(place, k, t->rays->seed));
	uint32_t facet = facet_hit(c, record, k);
	bool leaves = facet == GW_NONE || hit.small == GW_NONE || hit.large == GW_NONE;
	double sky = leaves ? sky_light(c, ray.direction) : 0.0;
	double small = hit.small == GW_NONE ? sky : light_of(t, hit.small, ray.direction);
	double large = hit.large == GW_NONE ? sky : light_of(t, hit.large, ray.direction);
	double found = facet == GW_NONE ? sky : facet_light(c, facet, &hit);
	ray_light light = { is_seen(c, record, k) ? found : 0.0, small, large };
	const gw_hit_place at = { gw_plus(place, gw_times(ray.direction, distance_of(c, record, k))),
							  ray.direction };
	light_at_place(c, record, k, &at, &hit, &light);
	return (ray_finding){ .excess = outside(light.found, light.small, light.large),
						  .albedo = hit.large == GW_NONE ? 0.0 : reflectance(t->surfels, hit.large),
						  .passed_back_face = hit.passed_back_face };
}

static void check_record(const check *c, size_t record)
{
	uint32_t rays = c->task->rays->rays, phase = pcg_hash((uint32_t)record);
	gathered sum = { 0 };
	double behind = 0.0, all = 0.0;
	for (uint32_t k = 0; k < rays; k++) {
		uint32_t turn = k + phase;
		uint32_t stride = facet_hit(c, record, k) == GW_NONE ? c->stride_leaving : c->stride_hit;
		if (turn % stride != 0)
			continue;
		ray_finding ray = check_ray(c, record, k);
		double share = (double)stride / rays;
		sum.excess[turn / stride % 2] += share * ray.excess;
		sum.albedo += share * ray.albedo;
		behind += ray.passed_back_face ? share : 0.0;
		all += share;
	}
	/* Inside something solid backs are black, unless the discs are sure that it is none. */
	if (is_buried(c, record) && behind > BEHIND_LEAST * all)
		sum.excess[0] = sum.excess[1] = 0.0;
	c->record[record] = sum;
}

static bool stops(check *c, uint32_t worker)
{
	return gw_loop_stopped(c->task->gpu, worker, &c->stopped);
}

static gw_status check_whole(const check *c, gw_error *error)
{
	return atomic_load(&c->stopped)
			   ? gw_fail(error, GW_ERROR_CANCELLED, "stopped while the octree was checked")
			   : GW_OK;
}

static void check_records(void *user, size_t first, size_t last, uint32_t worker)
{
	for (size_t i = first; i < last && !stops(user, worker); i++)
		check_record(user, i);
}

/* How much of a mean over the points, and of a mean of squares, each record stands for. */
static void weigh_records(const gw_geometry_task *t, double *mean, double *square)
{
	const gw_read_back *rows = t->read_back;
	double used = 0.0;
	for (size_t i = 0; i < rows->count; i++) {
		double rho = reflectance(t->surfels, i);
		used += t->counts[i] ? 1.0 : 0.0;
		for (uint32_t e = rows->first[i]; e < rows->first[i + 1] && t->counts[i]; e++) {
			mean[rows->record[e]] += rho * (double)rows->weight[e];
			square[rows->record[e]] += rho * rho * (double)rows->weight[e];
		}
	}
	for (size_t r = 0; r < t->records->count && used > 0.0; r++) {
		mean[r] /= used;
		square[r] /= used;
	}
}

static void choose_rays(check *c)
{
	size_t rays = (size_t)c->task->records->count * c->task->rays->rays, leaving = 0;
	const uint32_t *hit = c->view.hit.bytes;
	for (size_t i = 0; i < rays; i++)
		leaving += hit[i] == GW_NONE;
	c->stride_leaving = (uint32_t)(leaving / (RAYS_MOST / 2) + 1);
	c->stride_hit = (uint32_t)((rays - leaving) / (RAYS_MOST / 2) + 1);
}

/* The halves' products have no noise in them on average; what is left of it is taken off as well,
 * so that one ray that is far off says little. */
static finding sum_records(const check *c, const double *mean, const double *square)
{
	finding f = { 0 };
	double whole = 0.0, spread = 0.0;
	for (size_t r = 0; r < c->task->records->count; r++) {
		double a = c->record[r].excess[0], b = c->record[r].excess[1];
		f.mean += mean[r] * (a + b);
		f.variance += mean[r] * mean[r] * (a - b) * (a - b);
		f.square += square[r] * 4.0 * a * b;
		spread += square[r] * square[r] * 16.0 * a * a * b * b;
		f.kept += mean[r] * c->record[r].albedo;
		whole += mean[r];
	}
	f.square = fmax(f.square - sqrt(spread), 0.0);
	f.kept = whole > 0.0 ? f.kept / whole : 0.0;
	return f;
}

static gw_status check_gathered(check *c, finding *found, gw_error *error)
{
	size_t count = c->task->records->count;
	double *weight = gw_allocate_zeros(count, 2 * sizeof *weight);
	c->record = gw_allocate_array(count, sizeof *c->record);
	gw_status status = GW_OK;
	if (weight && c->record) {
		choose_rays(c);
		weigh_records(c->task, weight, weight + count);
		gw_parallel_for(c->task->threads, count, CHUNK, check_records, c);
		status = check_whole(c, error);
		if (status == GW_OK)
			*found = sum_records(c, weight, weight + count);
	} else {
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory to check %zu records", count);
	}
	free(weight);
	free(c->record);
	return status;
}

/* --------------------------------------------------------------------------------------- lamps */

/* Adds what reaches a surfel of it, between small discs and between large ones. */
static void add_lamp(const check *c, const gw_lamp *lamp, size_t surfel, double light[2])
{
	const gw_surfels *s = c->task->surfels;
	const gw_octree *o = c->task->octree;
	const float *p = s->position + 3 * surfel, *n = s->normal + 3 * surfel, *low = o->cube_minimum;
	gw_vec3 at = { p[0], p[1], p[2] }, towards;
	gw_vec3 place = gw_times(gw_minus(at, (gw_vec3){ low[0], low[1], low[2] }), 1 / o->leaf_size);
	const float *shone_on = s->shading_normal ? s->shading_normal + 3 * surfel : n;
	float distance, turn = unit_float(pcg_hash2((uint32_t)surfel, lamp->push.seed));
	const gw_check_place lit = { place, { shone_on[0], shone_on[1], shone_on[2] } };
	double whole = gw_check_lamp_light(lamp, &lit, &towards, &distance);
	gw_way way = gw_light_way(&lamp->push, o, s, surfel);
	if (whole > 0.0 && c->task->closed && gw_scanned_space_is_gap(c->task->closed, &way))
		return;
	for (uint32_t k = 0; k < lamp->push.samples && whole > 0.0; k++) {
		float range;
		gw_check_ray ray = { .origin = at,
							 .direction = gw_lamp_aim(lamp, k, turn, towards, distance, &range),
							 .facing = { n[0], n[1], n[2] },
							 .own = fmaxf(OWN_RADII * s->radius[surfel], o->leaf_size),
							 .both_sides = true };
		ray.t_max = lamp->push.type == GW_PUSH_SUN ? FAR_METRES : range * o->leaf_size;
		gw_check_hit hit = gw_check_discs_trace(c->task->discs, &ray, GW_THROUGH_LEAST);
		double share[2] = { hit.small == GW_NONE ? (double)hit.through[0] : 0.0,
							hit.large == GW_NONE ? (double)hit.through[1] : 0.0 };
		for (int size = 0; size < 2; size++)
			light[size] += whole * share[size] / lamp->push.samples;
	}
}

static void check_points(void *user, size_t first, size_t last, uint32_t worker)
{
	const check *c = user;
	for (size_t i = first; i < last && !stops(user, worker); i++) {
		size_t surfel = c->choice.point[i];
		double light[2] = { 0 }, found = gw_luminance(c->task->direct + 4 * surfel);
		for (size_t l = 0; l < c->lamps; l++)
			add_lamp(c, &c->lamp[l], surfel, light);
		double off = outside(found, light[0] * (1.0 + ROUNDING), light[1] * (1.0 - ROUNDING));
		c->excess[i] = reflectance(c->task->surfels, surfel) / M_PI * off;
	}
}

/* Points for the lamps, more where these shine; how many, by how many rays each takes. */
static gw_status choose_points(check *c, gw_error *error)
{
	const gw_geometry_task *t = c->task;
	size_t count = t->surfels->count, rays = 0;
	double *light = gw_allocate_array(count, sizeof *light);
	if (!light)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to draw from %zu points", count);
	for (size_t i = 0; i < count; i++)
		light[i] = reflectance(t->surfels, i) * gw_luminance(t->direct + 4 * i);
	for (size_t l = 0; l < c->lamps; l++)
		rays += c->lamp[l].push.samples;
	size_t wanted = rays > 0 ? RAYS_MOST / 2 / rays : 0;
	wanted = wanted < LAMP_POINTS_MOST ? wanted : LAMP_POINTS_MOST;
	wanted = wanted > LAMP_POINTS_LEAST ? wanted : LAMP_POINTS_LEAST;
	gw_status status = gw_check_point_choose(
		&(gw_check_point_shares){ count, t->counts, (const double *const[]){ light }, 1, light },
		(uint32_t)wanted, t->seed, &c->choice, error);
	free(light);
	return status;
}

static gw_status look_at_lamps(check *c, finding *found, gw_error *error)
{
	uint32_t count = c->choice.count;
	c->excess = gw_allocate_array(count, 2 * sizeof *c->excess);
	if (!c->excess)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %u points", count);
	gw_parallel_for(c->task->threads, count, CHUNK, check_points, c);
	gw_status status = check_whole(c, error);
	if (status != GW_OK) {
		free(c->excess);
		return status;
	}
	double *square = c->excess + count;
	for (size_t i = 0; i < count; i++)
		square[i] = c->excess[i] * c->excess[i];
	gw_check_point_mean mean = gw_check_point_average(&c->choice, c->excess);
	gw_check_point_mean squares = gw_check_point_average(&c->choice, square);
	*found = (finding){ .mean = mean.mean,
						.variance = mean.variance,
						.square = fmax(squares.mean - sqrt(squares.variance), 0.0) };
	free(c->excess);
	return GW_OK;
}

static gw_status check_lamps(check *c, finding *found, gw_error *error)
{
	const gw_geometry_task *t = c->task;
	gw_lamp *lamp = gw_allocate_array(t->light_count, sizeof *lamp);
	if (!lamp)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu lights", t->light_count);
	for (size_t i = 0; i < t->light_count; i++)
		if (gw_light_shines(&t->lights[i]))
			lamp[c->lamps++] = gw_lamp_of(&t->lights[i], t->octree, t->surfels, t->options);
	c->lamp = lamp;
	gw_status status = choose_points(c, error);
	if (status == GW_OK && c->choice.count > 1)
		status = look_at_lamps(c, found, error);
	gw_check_point_choice_clear(&c->choice);
	free(lamp);
	return status;
}

/* ---------------------------------------------------------------------------------------- both */

static gw_status open_records(const gw_geometry_task *t, views *v, gw_error *error)
{
	const gw_octree *o = t->octree;
	uint64_t records = 16 * (uint64_t)t->records->count, facets = 16 * (uint64_t)o->facet_count;
	const gw_sky_map *m = t->map;
	GW_TRY(gw_view_open(t->gpu, &t->records->position, records, &v->position, error));
	GW_TRY(gw_view_open(t->gpu, &t->records->normal, records, &v->normal, error));
	GW_TRY(gw_view_open(t->gpu, &t->rays->facet, records / 4 * t->rays->rays, &v->hit, error));
	GW_TRY(
		gw_view_open(t->gpu, &t->rays->distance, records / 4 * t->rays->rays, &v->distance, error));
	if (t->facet_radiance)
		GW_TRY(gw_view_open(t->gpu, t->facet_radiance, facets, &v->reflected, error));
	if (gw_surfels_emit(t->surfels))
		GW_TRY(gw_view_open(t->gpu, &o->facet_emission, facets, &v->emission, error));
	if (gw_surfels_emit(t->surfels))
		GW_TRY(gw_view_open(t->gpu, &o->facet_leaf, facets / 4, &v->leaf, error));
	if (gw_surfels_emit(t->surfels))
		GW_TRY(gw_view_open(t->gpu, &o->leaf_fragment, 4 * ((uint64_t)o->leaf_count + 1), &v->first,
							error));
	if (gw_surfels_emit(t->surfels))
		GW_TRY(gw_view_open(t->gpu, &o->fragment_surfel, 4 * (uint64_t)o->fragment_count,
							&v->fragment, error));
	if (m && m->width > 0)
		GW_TRY(
			gw_view_open(t->gpu, &m->texel, 16 * (uint64_t)m->width * m->height, &v->texel, error));
	return GW_OK;
}

static void close_all(check *c)
{
	gw_view *view[] = { &c->view.position, &c->view.normal,   &c->view.hit,      &c->view.distance,
						&c->view.texel,    &c->view.first,    &c->view.fragment, &c->view.leaf,
						&c->view.emission, &c->view.reflected };
	for (size_t i = 0; i < sizeof view / sizeof view[0]; i++)
		gw_view_close(view[i]);
}

/* What is wrong on average is so in each reflection: 1 + kept + kept^2 and so on. */
static double reflections(double kept, uint32_t limit)
{
	kept = fmin(kept, (double)GW_ALBEDO_MAX);
	return limit == GW_BOUNCES_AUTO ? 1.0 / (1.0 - kept) : (1.0 - pow(kept, limit)) / (1.0 - kept);
}

gw_status gw_geometry_error(const gw_geometry_task *task, double *rms, gw_error *error)
{
	check c = { .task = task };
	finding rays = { 0 }, lamps = { 0 };
	gw_status status = GW_OK;
	if (task->records)
		status = open_records(task, &c.view, error);
	if (status == GW_OK && task->records)
		status = check_gathered(&c, &rays, error);
	if (status == GW_OK && task->direct)
		status = check_lamps(&c, &lamps, error);
	close_all(&c);
	double mean = rays.mean + lamps.mean;
	double sure = fmax(mean * mean - rays.variance - lamps.variance, 0.0);
	double single = fmax(rays.square + lamps.square - mean * mean, 0.0);
	*rms = reflections(rays.kept, task->limit) * sqrt(sure);
	*rms = status == GW_OK ? hypot(*rms, sqrt(single)) : 0.0;
	return status;
}

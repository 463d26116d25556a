/*
 * hit_light.c - see hit_light.h.
 */
#include "estimate/hit_light.h"

#include "base/luminance.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "cloud/frame.h"
#include "estimate/check_light.h"
#include "light/direct_light.h"
#include "octree/octree_layout.h"

#include <stdlib.h>

#define CHUNK 4u

/* Fragments of a leaf that are looked at where there are very many, as facet_direct.comp does; here
 * fewer, as a mean over so many is as good. */
#define FRAGMENTS 64u

#define LEAF_DIAGONAL 1.7321f

/* Sums over the points that lie in a facet, by their area. */
typedef struct facet_points {
	double direct[3]; /* irradiance that lamps send there ... */
	double whole;     /* ... and would with nothing in the way, luminance */
	size_t nearest;   /* to a place */
	float squared;    /* distance */
} facet_points;

/* What lamps would send to a place with nothing in the way, luminance. */
static double received(const gw_hit_light *h, gw_check_place place)
{
	double sum = 0.0;
	for (size_t l = 0; l < h->lamps; l++) {
		gw_vec3 towards;
		float distance;
		sum += gw_check_lamp_light(&h->lamp[l], &place, &towards, &distance);
	}
	return sum;
}

static gw_vec3 place_of(const gw_hit_light *h, size_t surfel)
{
	const gw_octree *o = h->task.octree;
	const float *p = h->task.surfels->position + 3 * surfel;
	return gw_times(gw_minus(gw_xyz(p), gw_xyz(o->cube_minimum)), 1.0f / o->leaf_size);
}

static const float *normal_of(const gw_surfels *s, size_t surfel)
{
	return (s->shading_normal ? s->shading_normal : s->normal) + 3 * surfel;
}

static gw_check_place own_place(const gw_hit_light *h, size_t i)
{
	return (gw_check_place){ place_of(h, i), gw_xyz(normal_of(h->task.surfels, i)) };
}

static void add_point(const gw_hit_light *h, size_t i, float weight, gw_vec3 at, facet_points *sum)
{
	gw_vec3 place = place_of(h, i), off = gw_minus(at, place);
	for (size_t c = 0; c < 3; c++)
		sum->direct[c] += (double)(weight * h->task.direct[4 * i + c]);
	sum->whole += (double)weight * received(h, own_place(h, i));
	if (gw_dot(off, off) < sum->squared) {
		sum->squared = gw_dot(off, off);
		sum->nearest = i;
	}
}

/* A bent disc and a way through a place, in metres, in the disc's own frame. */
typedef struct bent_disc {
	gw_vec3 t, b, n;
	float bend[3];
	float at[3], way[3]; /* along t, b and n */
} bent_disc;

/* How a disc bends along two directions in its plane. */
static float bend_along(const bent_disc *d, const float *p, const float *q)
{
	return d->bend[0] * p[0] * q[0] + d->bend[1] * (p[0] * q[1] + p[1] * q[0]) +
		   d->bend[2] * p[1] * q[1];
}

static bent_disc disc_of(const gw_hit_light *h, size_t i, const gw_hit_place *place)
{
	const gw_surfels *s = h->task.surfels;
	const float *n = s->normal + 3 * i, *bend = s->bend + 3 * i;
	float tangent[3], bitangent[3];
	gw_tangent_frame(n, tangent, bitangent);
	gw_vec3 t = gw_xyz(tangent), b = gw_xyz(bitangent);
	gw_vec3 off = gw_times(gw_minus(place->at, place_of(h, i)), h->task.octree->leaf_size);
	return (bent_disc){ t,
						b,
						gw_xyz(n),
						{ bend[0], bend[1], bend[2] },
						{ gw_dot(off, t), gw_dot(off, b), gw_dot(off, gw_xyz(n)) },
						{ gw_dot(place->way, t), gw_dot(place->way, b),
						  gw_dot(place->way, gw_xyz(n)) } };
}

/* How far on the way goes through the disc's front; 0 where that is more than `most` from here. */
static float way_to_disc(const bent_disc *d, float most)
{
	float above = d->at[2] - 0.5f * bend_along(d, d->at, d->at);
	float rises = d->way[2] - bend_along(d, d->at, d->way);
	float root = rises * rises + 2.0f * above * bend_along(d, d->way, d->way);
	if (!(rises < 0.0f && root >= 0.0f))
		return 0.0f;
	float on = 2.0f * above / (sqrtf(root) - rises);
	return fabsf(on) <= most ? on : 0.0f;
}

/*
 * Where a ray that met a plane at a place meets the surface of which that is a piece, and the
 * normal there: on the disc of a point nearby, which bends where planes go straight on. In a sphere
 * planes stand out behind it: lamps are farther from them, and who comes flat meets them too far
 * along.
 */
static gw_check_place surface_at(const gw_hit_light *h, size_t i, const gw_hit_place *place)
{
	const float leaf = h->task.octree->leaf_size;
	gw_check_place found = { place->at, gw_xyz(normal_of(h->task.surfels, i)) };
	if (!h->task.surfels->bend)
		return found;
	bent_disc d = disc_of(h, i, place);
	float on = way_to_disc(&d, LEAF_DIAGONAL * leaf);
	for (int k = 0; k < 3; k++)
		d.at[k] += on * d.way[k];
	if (hypotf(d.at[0], d.at[1]) > h->task.surfels->radius[i])
		return own_place(h, i);
	const float x[2] = { 1.0f, 0.0f }, y[2] = { 0.0f, 1.0f };
	float turn_x = bend_along(&d, x, d.at), turn_y = bend_along(&d, y, d.at);
	gw_vec3 turn = gw_plus(gw_times(d.t, turn_x), gw_times(d.b, turn_y));
	float below = 0.5f * bend_along(&d, d.at, d.at) - d.at[2];
	gw_vec3 move = gw_plus(gw_times(place->way, on), gw_times(d.n, below));
	found.at = gw_plus(found.at, gw_times(move, 1.0f / leaf));
	found.normal = gw_unit(gw_minus(found.normal, turn));
	return found;
}

/* The fragments of a facet's leaf. */
static void fragments_around(const gw_hit_light *h, uint32_t facet, uint32_t *begin, uint32_t *end)
{
	size_t leaf = gw_facet_leaf(((const uint32_t *)h->leaf.bytes)[facet]);
	*begin = ((const uint32_t *)h->first.bytes)[leaf];
	*end = ((const uint32_t *)h->first.bytes)[leaf + 1];
}

static facet_points sum_points(const gw_hit_light *h, uint32_t facet, gw_vec3 at)
{
	const uint32_t *fragment = h->fragment.bytes;
	const float *weight = h->weight.bytes;
	uint32_t own = ((const uint32_t *)h->leaf.bytes)[facet], begin, end;
	fragments_around(h, facet, &begin, &end);
	uint32_t stride = (end - begin) / FRAGMENTS + 1;
	facet_points sum = { .squared = INFINITY };
	for (uint32_t f = begin; f < end; f += stride)
		if (gw_facet_holds(own, fragment[f]))
			add_point(h, fragment[f] & GW_FRAGMENT_SURFEL, weight[f], at, &sum);
	return sum;
}

/* Can a place so far from the nearest point of a facet lie in its leaf, on one of its discs? Where
 * an octree is damaged it may not. */
static bool lies_on(const gw_hit_light *h, size_t nearest, float distance)
{
	return distance <= h->task.surfels->radius[nearest] / h->task.octree->leaf_size + LEAF_DIAGONAL;
}

/* What a place reflects beyond its facet, pi times radiance, 3; nothing where that has two sides.
 */
static void find_beyond(const gw_hit_light *h, uint32_t facet, const gw_hit_place *place,
						double *radiosity)
{
	const float *rho = (const float *)h->albedo.bytes + 4 * (size_t)facet;
	const float *has = (const float *)h->direct.bytes + 4 * (size_t)facet;
	facet_points sum = { .whole = 0.0 };
	radiosity[0] = radiosity[1] = radiosity[2] = 0.0;
	if (rho[3] < 1.0f) /* else lit from both sides */
		sum = sum_points(h, facet, place->at);
	if (!(sum.whole > 0.0) || !lies_on(h, sum.nearest, sqrtf(sum.squared)))
		return;
	double light = received(h, surface_at(h, sum.nearest, place)) / sum.whole;
	for (size_t c = 0; c < 3; c++)
		radiosity[c] = (double)rho[c] * (sum.direct[c] * light - (double)has[c]);
}

double gw_hit_light_beyond_facet(const gw_hit_light *h, uint32_t facet, const gw_hit_place *place)
{
	double more[3];
	find_beyond(h, facet, place, more);
	const float radiosity[3] = { (float)more[0], (float)more[1], (float)more[2] };
	return gw_luminance(radiosity) / M_PI;
}

static bool lies_in(const gw_hit_light *h, uint32_t facet, uint32_t surfel)
{
	const uint32_t *fragment = h->fragment.bytes;
	uint32_t begin, end;
	fragments_around(h, facet, &begin, &end);
	for (uint32_t f = begin; f < end; f++)
		if ((fragment[f] & GW_FRAGMENT_ROI) == 0 && (fragment[f] & GW_FRAGMENT_SURFEL) == surfel)
			return true;
	return false;
}

double gw_hit_light_beyond_point(const gw_hit_light *h, uint32_t facet, uint32_t surfel,
								 const gw_hit_place *place)
{
	const gw_surfels *s = h->task.surfels;
	if (surfel == GW_NONE || s->two_sided[surfel] || !lies_in(h, facet, surfel))
		return 0.0;
	double own = received(h, own_place(h, surfel));
	double there = received(h, surface_at(h, surfel, place));
	const float *rho = s->albedo + 3 * (size_t)surfel, *e = h->task.direct + 4 * (size_t)surfel;
	const float sent[3] = { rho[0] * e[0], rho[1] * e[1], rho[2] * e[2] };
	return own > 0.0 ? (there / own - 1.0) * gw_luminance(sent) / M_PI : 0.0;
}

/* Places under way. */
typedef struct adding {
	const gw_hit_light *light;
	const gw_hit_light_rays *rays;
	gw_view place, normal; /* 4 floats each */
	float *irradiance;
} adding;

static void add_some(void *user, size_t first, size_t last, uint32_t worker)
{
	const adding *a = user;
	const gw_hit_light_rays *r = a->rays;
	(void)worker;
	for (size_t i = first; i < last; i++) {
		gw_vec3 from = gw_xyz((const float *)a->place.bytes + 4 * i);
		gw_vec3 normal = gw_xyz((const float *)a->normal.bytes + 4 * i);
		for (uint32_t k = 0; k < r->rays; k++) {
			double radiosity[3];
			uint32_t facet = r->facet[i * r->rays + k];
			if (facet == GW_NONE)
				continue;
			gw_vec3 way = gw_record_ray(from, normal, k, r->rays, r->seed);
			gw_vec3 off = gw_times(way, fabsf(r->distance[i * r->rays + k]));
			const gw_hit_place place = { gw_plus(from, off), way };
			find_beyond(a->light, facet, &place, radiosity);
			for (size_t c = 0; c < 3; c++)
				a->irradiance[4 * i + c] += (float)(radiosity[c] / r->rays);
		}
	}
}

gw_status gw_hit_light_add(const gw_hit_light *light, const gw_hit_light_rays *rays,
						   uint32_t threads, float *irradiance, gw_error *error)
{
	const uint64_t bytes = 16 * (uint64_t)rays->place->count;
	adding a = { .light = light, .rays = rays, .irradiance = irradiance };
	gw_status status =
		gw_view_open(light->task.gpu, &rays->place->position, bytes, &a.place, error);
	if (status == GW_OK)
		status = gw_view_open(light->task.gpu, &rays->place->normal, bytes, &a.normal, error);
	if (status == GW_OK)
		gw_parallel_for(threads, rays->place->count, CHUNK, add_some, &a);
	gw_view_close(&a.normal);
	gw_view_close(&a.place);
	return status;
}

static gw_status open_views(gw_hit_light *h, gw_error *error)
{
	gw_gpu *gpu = h->task.gpu;
	const gw_octree *o = h->task.octree;
	const uint64_t facets = 16 * (uint64_t)o->facet_count,
				   fragments = 4 * (uint64_t)o->fragment_count;
	GW_TRY(gw_view_open(gpu, &o->facet_albedo, facets, &h->albedo, error));
	GW_TRY(gw_view_open(gpu, h->task.facet_direct, facets, &h->direct, error));
	GW_TRY(gw_view_open(gpu, &o->facet_leaf, facets / 4, &h->leaf, error));
	GW_TRY(
		gw_view_open(gpu, &o->leaf_fragment, 4 * ((uint64_t)o->leaf_count + 1), &h->first, error));
	GW_TRY(gw_view_open(gpu, &o->fragment_surfel, fragments, &h->fragment, error));
	return gw_view_open(gpu, &o->fragment_weight, fragments, &h->weight, error);
}

gw_status gw_hit_light_open(const gw_hit_light_task *task, gw_hit_light *light, gw_error *error)
{
	*light = (gw_hit_light){ .task = *task };
	light->lamp = gw_allocate_array(task->light_count, sizeof *light->lamp);
	if (!light->lamp)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu lights", task->light_count);
	for (size_t i = 0; i < task->light_count; i++)
		if (gw_light_shines(&task->lights[i]))
			light->lamp[light->lamps++] =
				gw_lamp_of(&task->lights[i], task->octree, task->surfels, task->options);
	gw_status status = open_views(light, error);
	if (status != GW_OK)
		gw_hit_light_close(light);
	return status;
}

void gw_hit_light_close(gw_hit_light *light)
{
	gw_view *const all[] = { &light->albedo, &light->direct,   &light->leaf,
							 &light->first,  &light->fragment, &light->weight };
	for (size_t i = 0; i < sizeof all / sizeof *all; i++)
		gw_view_close(all[i]);
	free(light->lamp);
	*light = (gw_hit_light){ .lamps = 0 };
}

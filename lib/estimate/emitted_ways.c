/*
 * emitted_ways.c - see emitted_ways.h.
 */
#include "estimate/emitted_ways.h"

#include "base/luminance.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "base/shared_math.h"
#include "estimate/check_light.h"
#include "light/cpu_loop.h"
#include "light/shader_functions.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

#define CHUNK 64u

/* Points that emit, of all, and those that a record has ways to. */
#define EMITTERS 1024u
#define WAYS 16u

/* Likewise of a place where surface is missing. */
#define WAYS_FROM_GAPS 4u

/* So many radii around a point lies the surface that a way begins or ends on. */
#define OWN_RADII 2.0f

typedef struct work {
	const gw_emitted_ways_task *task;
	uint32_t emitter[EMITTERS]; /* surfels, as often as their power says */
	gw_view position, normal;   /* of the records */
	gw_view hit, distance;      /* of their rays */
	gw_emitted_ways *ways;
	atomic_bool stopped;
} work;

static void draw_emitters(work *w)
{
	const gw_surfels *s = w->task->surfels;
	double power = 0.0, passed = 0.0;
	uint32_t drawn = 0;
	for (size_t i = 0; i < s->count; i++)
		power += gw_emitted_power(s, i);
	for (size_t i = 0; i < s->count; i++) {
		passed += gw_emitted_power(s, i);
		while (drawn < EMITTERS && (drawn + 0.5) * power < passed * EMITTERS)
			w->emitter[drawn++] = (uint32_t)i;
	}
}

/* A way to a point that emits. */
typedef struct emitted_way {
	gw_way way;
	uint32_t emitter;
	float weight; /* of its light; 0: none comes this way */
	bool gap, solid;
} emitted_way;

static emitted_way way_to(const work *w, gw_vec3 from, gw_vec3 normal, uint32_t emitter)
{
	const gw_surfels *s = w->task->surfels;
	gw_vec3 along = gw_minus(gw_xyz(s->position + 3 * (size_t)emitter), from);
	float squared = gw_dot(along, along), length = sqrtf(squared);
	emitted_way e = { .way = { from, gw_times(along, length > 0.0f ? 1.0f / length : 0.0f),
							   length },
					  .emitter = emitter };
	float leaves = -gw_dot(gw_xyz(s->normal + 3 * (size_t)emitter), e.way.direction);
	float arrives = gw_dot(normal, e.way.direction);
	float nearest = s->area[emitter]; /* nearer, it is no point any more */
	if (!(leaves > 0.0f && arrives > 0.0f))
		return e;
	e.weight = leaves * arrives / fmaxf(squared, nearest);
	e.solid = gw_scanned_space_is_solid(w->task->space, &e.way, NULL);
	e.gap = !e.solid && gw_scanned_space_is_gap(w->task->space, &e.way);
	return e;
}

/* Whether discs leave it free, small ones and large ones. */
static bool is_free(const work *w, const emitted_way *e, gw_vec3 normal)
{
	const gw_surfels *s = w->task->surfels;
	float own = fmaxf(OWN_RADII * s->radius[e->emitter], w->task->on.octree->leaf_size);
	const gw_check_ray ray = { .origin = e->way.from,
							   .direction = e->way.direction,
							   .facing = normal,
							   .own = OWN_RADII * s->spacing,
							   .t_max = e->way.length - own };
	gw_check_hit hit = gw_check_discs_trace(w->task->discs, &ray, GW_THROUGH_LEAST);
	return hit.small == GW_NONE && hit.large == GW_NONE;
}

static void look_from(const work *w, size_t record, gw_vec3 from, gw_vec3 normal)
{
	emitted_way way[WAYS];
	bool any = false;
	for (uint32_t k = 0; k < WAYS; k++) {
		uint32_t turn = pcg_hash((uint32_t)record) % (EMITTERS / WAYS);
		way[k] = way_to(w, from, normal, w->emitter[k * (EMITTERS / WAYS) + turn]);
		any = any || way[k].gap || way[k].solid;
	}
	float all = 0.0f, gap = 0.0f, solid = 0.0f;
	for (uint32_t k = 0; k < WAYS && any; k++) {
		float light = way[k].weight > 0.0f && is_free(w, &way[k], normal) ? way[k].weight : 0.0f;
		all += light;
		gap += way[k].gap ? light : 0.0f;
		solid += way[k].solid ? light : 0.0f;
	}
	if (all > 0.0f)
		w->ways[record] = (gw_emitted_ways){ .gap = gap / all, .solid = solid / all };
}

/* Emitted light that would fall on a surface at a place, whichever way that faces. */
static float light_at(const work *w, gw_vec3 place, uint32_t turn)
{
	float sum = 0.0f;
	for (uint32_t k = 0; k < WAYS_FROM_GAPS; k++) {
		uint32_t stretch = EMITTERS / WAYS_FROM_GAPS;
		uint32_t emitter = w->emitter[k * stretch + turn % stretch];
		gw_vec3 towards =
			gw_unit(gw_minus(gw_xyz(w->task->surfels->position + 3 * (size_t)emitter), place));
		emitted_way e = way_to(w, place, towards, emitter);
		sum += e.weight > 0.0f && !e.solid && is_free(w, &e, towards) ? e.weight : 0.0f;
	}
	return sum / WAYS_FROM_GAPS;
}

/* Whether surface is missing on a way, and how far along it. */
static bool is_missing(const work *w, const gw_way *way, float *where)
{
	const gw_scanned_space *space = w->task->space;
	return gw_scanned_space_is_solid(space, way, where) ||
		   (!isfinite(way->length) && gw_scanned_space_hole(space, way, where) != GW_NO_HOLE);
}

/* Of a record that is buried no ray counts that passed a back. */
static void look_through(const work *w, size_t record, gw_vec3 place, gw_way way)
{
	const gw_ray_gather *rays = w->task->rays;
	const uint32_t *hit = (const uint32_t *)w->hit.bytes + record * rays->rays;
	const float *distance = (const float *)w->distance.bytes + record * rays->rays;
	const float *normal = (const float *)w->normal.bytes + 4 * record;
	float sum = 0.0f, squares = 0.0f, where, share = 1.0f / (float)rays->rays;
	for (uint32_t k = 0; k < rays->rays; k++) {
		if (normal[3] < 1.0f && distance[k] < 0.0f)
			continue;
		way.direction = gw_record_ray(place, gw_xyz(normal), k, rays->rays, rays->seed);
		way.length =
			hit[k] == GW_NONE ? INFINITY : fabsf(distance[k]) * w->task->on.octree->leaf_size;
		if (!is_missing(w, &way, &where))
			continue;
		gw_vec3 at = gw_plus(way.from, gw_times(way.direction, where));
		float light = share * light_at(w, at, pcg_hash2((uint32_t)record, k));
		sum += light;
		squares += light * light;
	}
	w->ways[record].lost = sum;
	w->ways[record].squares = squares;
}

static void look_around(const work *w, size_t record)
{
	const gw_octree *o = w->task->on.octree;
	gw_vec3 place = gw_xyz((const float *)w->position.bytes + 4 * record);
	gw_vec3 normal = gw_xyz((const float *)w->normal.bytes + 4 * record);
	gw_vec3 from = gw_plus(gw_xyz(o->cube_minimum), gw_times(place, o->leaf_size));
	look_from(w, record, from, normal);
	look_through(w, record, place, (gw_way){ .from = from });
}

static void look_from_all(void *user, size_t first, size_t last, uint32_t worker)
{
	work *w = user;
	for (size_t i = first; i < last; i++) {
		if (gw_loop_stopped(w->task->on.passes->gpu, worker, &w->stopped))
			return;
		look_around(w, i * w->task->step);
	}
}

static gw_status open_views(work *w, gw_error *error)
{
	const gw_emitted_ways_task *t = w->task;
	gw_gpu *gpu = t->on.passes->gpu;
	const gw_records *r = t->on.records;
	uint64_t bytes = 16 * (uint64_t)r->count, rays = (uint64_t)r->count * t->rays->rays;
	GW_TRY(gw_view_open(gpu, &r->position, bytes, &w->position, error));
	GW_TRY(gw_view_open(gpu, &r->normal, bytes, &w->normal, error));
	GW_TRY(gw_view_open(gpu, &t->rays->facet, 4 * rays, &w->hit, error));
	return gw_view_open(gpu, &t->rays->distance, 4 * rays, &w->distance, error);
}

gw_status gw_emitted_ways_find(const gw_emitted_ways_task *task, gw_emitted_ways *ways,
							   gw_error *error)
{
	work w = { .task = task, .ways = ways };
	size_t count = task->on.records->count, looked = (count + task->step - 1) / task->step;
	draw_emitters(&w);
	for (size_t i = 0; i < count; i++)
		ways[i] = (gw_emitted_ways){ 0 };
	gw_status status = open_views(&w, error);
	if (status == GW_OK) {
		gw_parallel_for(task->threads, looked, CHUNK, look_from_all, &w);
		if (atomic_load(&w.stopped))
			status = gw_fail(error, GW_ERROR_CANCELLED, "stopped while gaps were looked for");
	}
	gw_view_close(&w.position);
	gw_view_close(&w.normal);
	gw_view_close(&w.hit);
	gw_view_close(&w.distance);
	return status;
}

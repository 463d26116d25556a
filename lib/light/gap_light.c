/*
 * gap_light.c - see gap_light.h.
 */
#include "light/gap_light.h"

#include "base/memory.h"
#include "base/parallel.h"
#include "cloud/frame.h"
#include "base/shared_math.h"
#include "light/cpu_loop.h"
#include "light/shader_functions.h"
#include "light/transport_layout.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

#define CHUNK 64u

/* A record that sees nothing but gaps knows nothing of what surrounds them. */
#define SHARE_MOST 0.9f

typedef struct work {
	const gw_gap_task *task;
	gw_view position, normal, hit, texel;
	float *glow; /* NULL unless surfels emit; one a hole */
	gw_gap_sight *gap;
	atomic_bool stopped;
} work;

/* What a hole that the way passes would send along it. */
static float glow_of(const work *w, const gw_way *way)
{
	uint32_t hole = w->glow ? gw_scanned_space_hole(w->task->space, way, NULL) : GW_NO_HOLE;
	return hole != GW_NO_HOLE ? w->glow[hole] : 0.0f;
}

static void look_through(const work *w, size_t record)
{
	const gw_gap_task *t = w->task;
	const gw_octree *o = t->on->octree;
	const float *p = (const float *)w->position.bytes + 4 * record;
	gw_vec3 place = gw_xyz(p), normal = gw_xyz((const float *)w->normal.bytes + 4 * record);
	const uint32_t *hit = (const uint32_t *)w->hit.bytes + record * t->rays->rays;
	const gw_sky_view sky = { t->sky, t->map, w->texel.bytes };
	gw_way way = { .length = INFINITY };
	gw_gap_sight *sum = &w->gap[record];
	float share = 1.0f / (float)t->rays->rays;
	way.from = gw_plus((gw_vec3){ o->cube_minimum[0], o->cube_minimum[1], o->cube_minimum[2] },
					   gw_times(place, o->leaf_size));
	for (uint32_t k = 0; k < t->rays->rays; k++) {
		if (hit[k] != GW_NONE)
			continue;
		way.direction = gw_record_ray(place, normal, k, t->rays->rays, t->rays->seed);
		float radiance[4] = { 0 };
		gw_sky_radiance(&sky, way.direction, radiance);
		sum->all += share * gw_luminance_of(gw_xyz(radiance));
		if (!gw_scanned_space_is_gap(t->space, &way)) {
			bool dark = !(gw_luminance_of(gw_xyz(radiance)) > 0.0f);
			sum->pane += dark && gw_scanned_space_is_pane(t->space, &way) ? share : 0.0f;
			continue;
		}
		for (int c = 0; c < 3; c++)
			sum->sky[c] += share * radiance[c];
		sum->share += share;
		sum->glow += share * glow_of(w, &way);
	}
}

static void look_through_all(void *user, size_t first, size_t last, uint32_t worker)
{
	work *w = user;
	for (size_t i = first; i < last; i++) {
		if (gw_loop_stopped(w->task->on->passes->gpu, worker, &w->stopped))
			return;
		look_through(w, i);
	}
}

/* A hole emits what the points along its rim do, each for the part of it that is about as long as
 * its disc is wide. */
static gw_status find_glow(work *w, gw_error *error)
{
	const gw_surfels *s = w->task->surfels;
	size_t holes = w->task->space->holes;
	float *length = gw_allocate_zeros(holes, sizeof *length);
	w->glow = gw_allocate_zeros(holes, sizeof *w->glow);
	if (!length || !w->glow) {
		free(length);
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu holes", holes);
	}
	for (size_t i = 0; i < s->count; i++) {
		uint32_t hole = gw_scanned_space_rim(w->task->space, s->position + 3 * i);
		if (hole == GW_NO_HOLE)
			continue;
		length[hole] += s->radius[i];
		w->glow[hole] += s->radius[i] * gw_luminance_of(gw_xyz(s->emission + 3 * i));
	}
	for (size_t hole = 0; hole < holes; hole++)
		w->glow[hole] /= length[hole] > 0.0f ? length[hole] : 1.0f;
	free(length);
	return GW_OK;
}

static gw_status open_views(work *w, gw_error *error)
{
	const gw_gap_task *t = w->task;
	gw_gpu *gpu = t->on->passes->gpu;
	const gw_records *r = t->on->records;
	uint64_t bytes = 16 * (uint64_t)r->count;
	const gw_sky_map *m = t->map;
	GW_TRY(gw_view_open(gpu, &r->position, bytes, &w->position, error));
	GW_TRY(gw_view_open(gpu, &r->normal, bytes, &w->normal, error));
	GW_TRY(gw_view_open(gpu, &t->rays->facet, bytes / 4 * t->rays->rays, &w->hit, error));
	if (m && m->width > 0)
		GW_TRY(gw_view_open(gpu, &m->texel, 16 * (uint64_t)m->width * m->height, &w->texel, error));
	return GW_OK;
}

static gw_status look_from_records(work *w, gw_error *error)
{
	size_t count = w->task->on->records->count;
	GW_TRY(open_views(w, error));
	if (w->task->surfels && gw_surfels_emit(w->task->surfels))
		GW_TRY(find_glow(w, error));
	w->gap = gw_allocate_zeros(count, sizeof *w->gap);
	if (!w->gap)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu records", count);
	gw_parallel_for(w->task->threads, count, CHUNK, look_through_all, w);
	if (atomic_load(&w->stopped))
		return gw_fail(error, GW_ERROR_CANCELLED, "stopped while gaps were looked for");
	return GW_OK;
}

gw_status gw_gap_light_find(const gw_gap_task *task, gw_gap_sight **gap, gw_error *error)
{
	work w = { .task = task };
	*gap = NULL;
	gw_status status = look_from_records(&w, error);
	gw_view_close(&w.position);
	gw_view_close(&w.normal);
	gw_view_close(&w.hit);
	gw_view_close(&w.texel);
	free(w.glow);
	if (status == GW_OK)
		*gap = w.gap;
	else
		free(w.gap);
	return status;
}

/* Of a light that a record gathered, so many times as much. */
static float enlarged(float share)
{
	return 1.0f / (1.0f - gw_smaller(share, SHARE_MOST));
}

/* Of the sky's light that all records see, what comes through gaps. */
static float share_of_all(const gw_gap_sight *gap, size_t count)
{
	double all = 0.0, through = 0.0;
	for (size_t i = 0; i < count; i++) {
		all += (double)gap[i].all;
		through += (double)gw_luminance_of(gw_xyz(gap[i].sky));
	}
	return all > 0.0 ? (float)(through / all) : 0.0f;
}

/* What is left of what a record gathered. */
static float left_of(const gw_gap_sight *gap, float first, float through, const float *mean_share)
{
	if (!mean_share)
		return gw_larger(first - through, 0.0f);
	float share = gap->all > 0.0f ? gw_luminance_of(gw_xyz(gap->sky)) / gap->all : *mean_share;
	return first * (1.0f - gw_smaller(share, 1.0f));
}

gw_status gw_gap_light_close(const gw_record_context *on, const gw_gap_sight *gap,
							 const float *fill, bool alone, gw_buffer *to, gw_error *error)
{
	gw_gpu *gpu = on->passes->gpu;
	size_t count = on->records->count;
	uint64_t bytes = 16 * (uint64_t)count;
	float *first = gw_allocate_array(count, 8 * sizeof *first);
	if (!first)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu records", count);
	float *normal = first + 4 * count, mean_share = share_of_all(gap, count);
	gw_status status = gw_buffer_download(gpu, to, 0, first, bytes, error);
	if (status == GW_OK)
		status = gw_buffer_download(gpu, &on->records->normal, 0, normal, bytes, error);
	for (size_t i = 0; i < 4 * count && status == GW_OK; i++) {
		float share = gap[i / 4].share, inside = GW_PI * normal[i / 4 * 4 + 3];
		float rest = i % 4 < 3 ? left_of(&gap[i / 4], first[i], inside * gap[i / 4].sky[i % 4],
										 alone ? &mean_share : NULL)
							   : first[i];
		if (fill)
			first[i] = i % 4 < 3 ? rest + inside * share * fill[i % 4] : rest;
		else
			first[i] = rest * enlarged(share);
	}
	if (status == GW_OK)
		status = gw_buffer_upload(gpu, to, 0, first, bytes, error);
	free(first);
	return status;
}

gw_status gw_gap_light_fill(const gw_record_context *on, const gw_gap_sight *gap,
							gw_buffer *gathered, gw_error *error)
{
	gw_gpu *gpu = on->passes->gpu;
	size_t count = on->records->count;
	uint64_t bytes = 16 * (uint64_t)count;
	float *light = gw_allocate_array(count, 4 * sizeof *light);
	if (!light)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu records", count);
	gw_status status = gw_buffer_download(gpu, gathered, 0, light, bytes, error);
	for (size_t i = 0; i < 4 * count && status == GW_OK; i++)
		light[i] *= enlarged(gap[i / 4].share);
	if (status == GW_OK)
		status = gw_buffer_upload(gpu, gathered, 0, light, bytes, error);
	free(light);
	return status;
}

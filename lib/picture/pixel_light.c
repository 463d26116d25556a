/*
 * pixel_light.c - what pixels see in an octree: glossy reflections by rays, cones or caches, and
 * the light of voxels.
 */
#include "picture/render_octree.h"

#include "base/memory.h"
#include "glowworm_host.h"
#include "picture/gloss_caches.h"
#include "picture/gloss_clusters.h"

#include <stdlib.h>
#include <string.h>

/* A pixel that reads caches has no more noise than by so many rays. */
#define CACHES_AS_RAYS 64u

/* Pixels that are on the device at once: 48 MB. */
#define BATCH ((size_t)1 << 20)

/* What a batch needs on the device. */
typedef struct batch {
	gw_buffer position, normal, result; /* vec4 a pixel */
	float *host;                        /* 4 a pixel */
	size_t first, count;                /* pixels that are in it now */
} batch;

/* Where the eye is, for a push. */
static vec4 eye_of(const gw_render_octree *o, const gw_pixels *pixels, float w)
{
	float eye[3];
	gw_render_octree_to_grid(o, pixels->eye, eye);
	return (vec4){ eye[0], eye[1], eye[2], w };
}

static gw_status open_batch(gw_render_octree *o, size_t pixels, batch *b, gw_error *error)
{
	size_t count = pixels < BATCH ? pixels : BATCH;
	b->host = gw_allocate_array(count, 4 * sizeof *b->host);
	if (!b->host)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu pixels", count);
	gw_buffer *const buffer[] = { &b->position, &b->normal, &b->result };
	static const char *const name[] = { "pixel position", "pixel normal", "pixel result" };
	for (int i = 0; i < 3; i++)
		GW_TRY(gw_buffer_create(o->gpu,
								&(gw_buffer_description){ GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED,
														  16 * (uint64_t)count, name[i] },
								buffer[i], error));
	return GW_OK;
}

static void close_batch(gw_render_octree *o, batch *b)
{
	gw_buffer_destroy(o->gpu, &b->position);
	gw_buffer_destroy(o->gpu, &b->normal);
	gw_buffer_destroy(o->gpu, &b->result);
	free(b->host);
}

static gw_status load_batch(gw_render_octree *o, batch *b, const gw_pixels *pixels, size_t first,
							size_t count, gw_error *error)
{
	b->first = first;
	b->count = count;
	for (size_t i = 0; i < count; i++) {
		gw_render_octree_to_grid(o, pixels->position + 4 * (first + i), b->host + 4 * i);
		b->host[4 * i + 3] = pixels->position[4 * (first + i) + 3];
	}
	GW_TRY(gw_buffer_upload(o->gpu, &b->position, 0, b->host, 16 * (uint64_t)count, error));
	return gw_buffer_upload(o->gpu, &b->normal, 0, pixels->normal + 4 * first, 16 * (uint64_t)count,
							error);
}

/* One pass over a batch. */
typedef gw_status (*batch_pass)(gw_render_octree *o, batch *b, const gw_pixels *pixels,
								const void *how, gw_error *error);

static gw_status run_batches(gw_render_octree *o, const gw_pixels *pixels, batch_pass run,
							 const void *how, float *result, gw_error *error)
{
	batch b = { .host = NULL };
	gw_status status = pixels->count ? open_batch(o, pixels->count, &b, error) : GW_OK;
	for (size_t first = 0; first < pixels->count && status == GW_OK; first += BATCH) {
		size_t count = pixels->count - first < BATCH ? pixels->count - first : BATCH;
		status = load_batch(o, &b, pixels, first, count, error);
		if (status == GW_OK)
			status = run(o, &b, pixels, how, error);
		if (status == GW_OK)
			status = gw_buffer_download(o->gpu, &b.result, 0, result + 4 * first,
										16 * (uint64_t)count, error);
	}
	close_batch(o, &b);
	return status;
}

/* What a ray's passes are told of the sky, and of these pixels. */
static gw_pixel_push push_of(const gw_render_octree *o, const gw_reflection *r, const batch *b)
{
	return (gw_pixel_push){ .rays = r->rays,
							.seed = r->seed,
							.pixel_first = (uint32_t)b->first,
							.sky = { r->sky[0], r->sky[1], r->sky[2], 0.0f },
							.sky_width = o->sky.width,
							.sky_height = o->sky.height,
							.sky_turn = o->sky.turn,
							.sky_y_up = o->sky.y_up };
}

/* Of passes that trace. */
#define RAY_BINDINGS(o, b)                                                                         \
	GW_TRACE_BINDINGS(&(o)->octree), GW_DISC_BINDINGS(&(o)->octree),                               \
		gw_whole(&(o)->surfel_radiance), gw_window(&(b)->position, 16),                            \
		gw_window(&(b)->normal, 16), gw_window(&(b)->result, 16), GW_TREE_BINDING(&(o)->octree),   \
		gw_render_octree_sky(o), GW_OPACITY_BINDING(&(o)->octree), GW_LEAF_BINDING(&(o)->octree)

static gw_status run_rays(gw_render_octree *o, batch *b, const gw_pixels *pixels, const void *how,
						  gw_error *error)
{
	const gw_reflection *r = how;
	gw_pixel_push push = push_of(o, r, b);
	push.eye = eye_of(o, pixels, 0.0f);
	const gw_binding bindings[] = { RAY_BINDINGS(o, b) };
	for (push.ray = 0; push.ray < r->rays; push.ray++) {
		GW_TRY(gw_passes_run(&o->passes, GW_PASS_PIXEL_RAYS, bindings, &push, b->count, error));
		if (r->cancelled && r->cancelled(r->user))
			return gw_fail(error, GW_ERROR_CANCELLED, "stopped while light was reflected");
	}
	return GW_OK;
}

typedef struct given_run {
	const gw_given_rays *rays;
	const gw_reflection *reflection;
} given_run;

static gw_status run_given(gw_render_octree *o, batch *b, const gw_pixels *pixels, const void *how,
						   gw_error *error)
{
	const given_run *run = how;
	const gw_pixel_push push = push_of(o, run->reflection, b);
	const gw_binding bindings[] = { RAY_BINDINGS(o, b) };
	(void)pixels;
	GW_TRY(gw_buffer_upload(o->gpu, &b->result, 0, run->rays->way + 4 * b->first,
							16 * (uint64_t)b->count, error));
	return gw_passes_run(&o->passes, GW_PASS_GIVEN_RAYS, bindings, &push, b->count, error);
}

gw_status gw_given_rays_trace(gw_render_octree *o, const gw_given_rays *rays,
							  const gw_reflection *reflection, float *light, gw_error *error)
{
	const given_run how = { rays, reflection };
	return run_batches(o, &rays->from, run_given, &how, light, error);
}

/* Of passes that read the bricks. */
#define BRICK_BINDINGS(o, b)                                                                       \
	gw_whole(&(o)->octree.level_directory), gw_whole(&(o)->octree.node),                           \
		gw_voxels_of(&(o)->bricks.leaf_pool), gw_voxels_of(&(o)->bricks.mip_pool),                 \
		gw_window(&(b)->position, 16), gw_window(&(b)->normal, 16), gw_window(&(b)->result, 16)

static gw_status run_cone(gw_render_octree *o, batch *b, const gw_pixels *pixels, const void *how,
						  gw_error *error)
{
	const gw_reflection *r = how;
	gw_cone_push push = gw_cone_gather_push(&o->bricks, o->scale, r->sky);
	push.eye = eye_of(o, pixels, 0.0f);
	push.sky_width = o->sky.width;
	push.sky_height = o->sky.height;
	push.sky_turn = o->sky.turn;
	push.sky_y_up = o->sky.y_up;
	const gw_binding bindings[] = { BRICK_BINDINGS(o, b), gw_render_octree_sky(o) };
	return gw_passes_run(&o->passes, GW_PASS_PIXEL_CONE, bindings, &push, b->count, error);
}

/* ------------------------------------------------------------------------- pixels, by caches */

typedef struct cache_run {
	const gw_gloss_caches *caches;
	const gw_reflection *reflection;
} cache_run;

static gw_status run_caches(gw_render_octree *o, batch *b, const gw_pixels *pixels, const void *how,
							gw_error *error)
{
	const cache_run *run = how;
	const gw_gloss_caches *c = run->caches;
	gw_cache_push push = gw_gloss_caches_push(o, c, pixels, run->reflection);
	push.pixel_first = (uint32_t)b->first;
	const gw_binding bindings[] = { gw_whole(&c->tile_first),    gw_whole(&c->place),
									gw_whole(&c->facing),        gw_whole(&c->pixel),
									gw_whole(&c->texel),         gw_whole(&c->screen),
									gw_window(&b->position, 16), gw_window(&b->normal, 16),
									gw_window(&b->result, 16) };
	if (run->reflection->cancelled && run->reflection->cancelled(run->reflection->user))
		return gw_fail(error, GW_ERROR_CANCELLED, "stopped while light was reflected");
	return gw_passes_run(&o->passes, GW_PASS_PIXEL_CACHES, bindings, &push, b->count, error);
}

/* Some of the pixels, as pixels of their own. */
typedef struct pixel_part {
	size_t count;
	uint32_t *pixel; /* count: which of all, ascending */
	float *position, *normal, *reflected;
} pixel_part;

static void clear_part(pixel_part *part)
{
	free(part->pixel);
	free(part->position);
	free(part->normal);
	free(part->reflected);
}

/* Takes those that read caches, or all others. */
static gw_status take_part(const gw_pixels *pixels, const gw_gloss_caches *caches, bool readers,
						   pixel_part *part, gw_error *error)
{
	size_t count = readers ? caches->reader_count : pixels->count - caches->reader_count;
	*part = (pixel_part){ .pixel = gw_allocate_array(count, sizeof *part->pixel),
						  .position = gw_allocate_array(count, 4 * sizeof *part->position),
						  .normal = gw_allocate_array(count, 4 * sizeof *part->normal),
						  .reflected = gw_allocate_array(count, 4 * sizeof *part->reflected) };
	if (!part->pixel || !part->position || !part->normal || !part->reflected)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu pixels", count);
	for (size_t i = 0, next = 0; i < pixels->count; i++) {
		bool reads = next < caches->reader_count && caches->reader[next] == i;
		next += reads;
		if (reads != readers)
			continue;
		memcpy(part->position + 4 * part->count, pixels->position + 4 * i, 4 * sizeof(float));
		memcpy(part->normal + 4 * part->count, pixels->normal + 4 * i, 4 * sizeof(float));
		part->pixel[part->count++] = (uint32_t)i;
	}
	return GW_OK;
}

static gw_status reflect_part(gw_render_octree *o, const gw_pixels *pixels, const cache_run *how,
							  bool readers, float *reflected, gw_error *error)
{
	pixel_part part;
	gw_status status = take_part(pixels, how->caches, readers, &part, error);
	gw_pixels own = { .count = part.count, .position = part.position, .normal = part.normal };
	memcpy(own.eye, pixels->eye, sizeof own.eye);
	if (status == GW_OK)
		status = readers ? run_batches(o, &own, run_caches, how, part.reflected, error)
						 : run_batches(o, &own, run_rays, how->reflection, part.reflected, error);
	for (size_t i = 0; i < part.count && status == GW_OK; i++)
		memcpy(reflected + 4 * (size_t)part.pixel[i], part.reflected + 4 * i, 4 * sizeof(float));
	clear_part(&part);
	return status;
}

static gw_status reflect_by_caches(gw_render_octree *o, const gw_pixels *pixels,
								   const gw_reflection *reflection, float *reflected,
								   gw_error *error)
{
	gw_gloss_caches caches;
	GW_TRY(gw_gloss_caches_make(o, pixels, reflection, &caches, error));
	const cache_run how = { &caches, reflection };
	double start = gw_seconds();
	gw_status status = reflect_part(o, pixels, &how, true, reflected, error);
	o->cache_seconds.readers += caches.reader_count;
	o->cache_seconds.evaluation += gw_seconds() - start;
	if (status == GW_OK)
		status = reflect_part(o, pixels, &how, false, reflected, error);
	gw_gloss_caches_destroy(o->gpu, &caches);
	return status;
}

uint32_t gw_reflection_rays(const gw_reflection *r, float roughness)
{
	bool cached = r->caches && gw_gloss_is_cached(roughness);
	return cached && r->rays < CACHES_AS_RAYS ? CACHES_AS_RAYS : r->rays;
}

gw_status gw_render_octree_reflect(gw_render_octree *o, const gw_pixels *pixels,
								   const gw_reflection *reflection, float *reflected,
								   gw_error *error)
{
	if (reflection->caches)
		return reflect_by_caches(o, pixels, reflection, reflected, error);
	return run_batches(o, pixels, reflection->cone ? run_cone : run_rays, reflection, reflected,
					   error);
}

static gw_status run_read(gw_render_octree *o, batch *b, const gw_pixels *pixels, const void *how,
						  gw_error *error)
{
	const float black[3] = { 0 };
	gw_cone_push push = gw_cone_gather_push(&o->bricks, o->scale, black);
	push.eye = eye_of(o, pixels, *(const bool *)how ? 1.0f : 0.0f);
	const gw_binding bindings[] = { BRICK_BINDINGS(o, b) };
	return gw_passes_run(&o->passes, GW_PASS_PIXEL_BRICKS, bindings, &push, b->count, error);
}

gw_status gw_render_octree_read(gw_render_octree *o, const gw_pixels *pixels, bool cubic,
								float *radiance, gw_error *error)
{
	return run_batches(o, pixels, run_read, &cubic, radiance, error);
}

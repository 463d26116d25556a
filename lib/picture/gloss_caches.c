/*
 * gloss_caches.c - see gloss_caches.h.
 */
#include "picture/gloss_caches.h"

#include "base/memory.h"
#include "base/shader_math.h"
#include "glowworm_host.h"
#include "picture/gloss_clusters.h"
#include "picture/gloss_functions.h"

#include <stdlib.h>

/* Caches at most: their texels take 90 MB. */
#define CACHES_MOST 16384u

/* What is seen at a grazing angle is further apart than it seems, but no more than by this counts.
 */
#define SLANT_MOST 4.0f

static uint32_t screen_of(const gw_pixels *p, uint32_t pixel)
{
	uint32_t place = p->place[pixel];
	return place % p->width | place / p->width << 16;
}

static gw_status put_buffer(gw_gpu *gpu, const gw_buffer_description *description, const void *data,
							gw_buffer *buffer, gw_error *error)
{
	GW_TRY(gw_buffer_create_unset(gpu, description, buffer, error));
	return gw_buffer_upload(gpu, buffer, 0, data, description->bytes, error);
}

#define TEXELS(format, bytes, name)                                                                \
	&(gw_buffer_description)                                                                       \
	{                                                                                              \
		GW_BUFFER_TEXEL, format, (bytes), name                                                     \
	}

/* -------------------------------------------------------------------------------------- placing */

/* What the caches are told of: host arrays. */
typedef struct placing {
	float *place, *facing;
	uint32_t *pixel, *screen;
} placing;

/* How far a cache's light is of use: as far as it is in the picture, on the surface that it is on.
 */
static float reach_of(const gw_pixels *p, uint32_t pixel, uint32_t tile, gw_vec3 *normal)
{
	gw_vec3 way = gw_minus(gw_xyz(p->eye), gw_xyz(p->position + 4 * (size_t)pixel));
	float distance = sqrtf(gw_dot(way, way));
	gw_vec3 to_eye = gw_times(way, 1.0f / gw_larger(distance, 1e-20f));
	*normal = gw_gloss_facing(gw_xyz(p->normal + 4 * (size_t)pixel), to_eye);
	float slant = 1.0f / gw_larger(gw_dot(*normal, to_eye), 1.0f / SLANT_MOST);
	return GW_CACHE_REACH * (float)tile * p->step * distance * slant;
}

static void place_cache(const gw_render_octree *o, const gw_pixels *p,
						const gw_gloss_clusters *clusters, size_t cache, const placing *to)
{
	uint32_t pixel = clusters->representative[cache];
	gw_vec3 normal;
	gw_render_octree_to_grid(o, p->position + 4 * (size_t)pixel, to->place + 4 * cache);
	to->place[4 * cache + 3] = reach_of(p, pixel, clusters->tile, &normal) / o->octree.leaf_size;
	to->facing[4 * cache] = normal.x;
	to->facing[4 * cache + 1] = normal.y;
	to->facing[4 * cache + 2] = normal.z;
	to->facing[4 * cache + 3] = p->position[4 * (size_t)pixel + 3];
	to->pixel[cache] = screen_of(p, pixel);
}

/* The pixels that read them, and what these are told. */
static void list_readers(const gw_pixels *p, const gw_gloss_clusters *clusters, gw_gloss_caches *c,
						 uint32_t *screen)
{
	for (size_t i = 0; i < p->count; i++) {
		if (clusters->cluster_of[i] == GW_NO_CLUSTER)
			continue;
		screen[2 * c->reader_count] = screen_of(p, (uint32_t)i);
		screen[2 * c->reader_count + 1] = clusters->cluster_of[i];
		c->reader[c->reader_count++] = (uint32_t)i;
	}
}

static gw_status upload(gw_gpu *gpu, const gw_gloss_clusters *clusters, const placing *from,
						gw_gloss_caches *c, gw_error *error)
{
	uint64_t tiles = (uint64_t)c->columns * c->rows, count = c->count;
	GW_TRY(put_buffer(gpu, TEXELS(VK_FORMAT_R32_UINT, 4 * (tiles + 1), "caches of tiles"),
					  clusters->tile_first, &c->tile_first, error));
	GW_TRY(put_buffer(gpu, TEXELS(VK_FORMAT_R32G32B32A32_SFLOAT, 16 * count, "cache places"),
					  from->place, &c->place, error));
	GW_TRY(put_buffer(gpu, TEXELS(VK_FORMAT_R32G32B32A32_SFLOAT, 16 * count, "cache normals"),
					  from->facing, &c->facing, error));
	GW_TRY(put_buffer(gpu, TEXELS(VK_FORMAT_R32_UINT, 4 * count, "cache pixels"), from->pixel,
					  &c->pixel, error));
	return put_buffer(
		gpu, TEXELS(VK_FORMAT_R32G32_UINT, 8 * (uint64_t)c->reader_count, "pixels of caches"),
		from->screen, &c->screen, error);
}

static gw_status place_all(gw_render_octree *o, const gw_pixels *p,
						   const gw_gloss_clusters *clusters, gw_gloss_caches *c, gw_error *error)
{
	placing to = { gw_allocate_zeros(clusters->count, 4 * sizeof *to.place),
				   gw_allocate_zeros(clusters->count, 4 * sizeof *to.facing),
				   gw_allocate_array(clusters->count, sizeof *to.pixel),
				   gw_allocate_array(p->count, 2 * sizeof *to.screen) };
	c->reader = gw_allocate_array(p->count, sizeof *c->reader);
	gw_status status = GW_OK;
	if (!to.place || !to.facing || !to.pixel || !to.screen || !c->reader)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory for caches of %zu pixels", p->count);
	for (size_t i = 0; i < clusters->count && status == GW_OK; i++)
		place_cache(o, p, clusters, i, &to);
	if (status == GW_OK) {
		list_readers(p, clusters, c, to.screen);
		status = upload(o->gpu, clusters, &to, c, error);
	}
	free(to.place);
	free(to.facing);
	free(to.pixel);
	free(to.screen);
	return status;
}

/* -------------------------------------------------------------------------------------- filling */

gw_cache_push gw_gloss_caches_push(const gw_render_octree *o, const gw_gloss_caches *caches,
								   const gw_pixels *pixels, const gw_reflection *r)
{
	float eye[3];
	gw_render_octree_to_grid(o, pixels->eye, eye);
	return (gw_cache_push){ .seed = r->seed,
							.columns = caches->columns,
							.rows = caches->rows,
							.tile = caches->tile,
							.eye = { eye[0], eye[1], eye[2], 0.0f },
							.sky = { r->sky[0], r->sky[1], r->sky[2], 0.0f },
							.sky_width = o->sky.width,
							.sky_height = o->sky.height,
							.sky_turn = o->sky.turn,
							.sky_y_up = o->sky.y_up };
}

static gw_status fill(gw_render_octree *o, const gw_pixels *pixels, const gw_reflection *r,
					  gw_gloss_caches *c, gw_error *error)
{
	const gw_octree *t = &o->octree;
	const uint64_t texels = (uint64_t)c->count * GW_CACHE_TEXELS;
	GW_TRY(gw_buffer_create_unset(
		o->gpu, TEXELS(VK_FORMAT_R32G32B32A32_SFLOAT, 16 * texels, "radiance caches"), &c->texel,
		error));
	gw_cache_push push = gw_gloss_caches_push(o, c, pixels, r);
	const gw_binding rays[] = {
		GW_TRACE_BINDINGS(t), GW_DISC_BINDINGS(t),     gw_whole(&o->surfel_radiance),
		gw_whole(&c->place),  gw_whole(&c->facing),    gw_whole(&c->texel),
		GW_TREE_BINDING(t),   gw_render_octree_sky(o), GW_OPACITY_BINDING(t),
		GW_LEAF_BINDING(t)
	};
	const gw_binding mips[] = { gw_whole(&c->texel) };
	for (push.ray = 0; push.ray < GW_CACHE_RAYS; push.ray++) {
		GW_TRY(gw_passes_run(&o->passes, GW_PASS_CACHE_RAYS, rays, &push,
							 (uint64_t)c->count * GW_CACHE_SIDE * GW_CACHE_SIDE, error));
		if (r->cancelled && r->cancelled(r->user))
			return gw_fail(error, GW_ERROR_CANCELLED, "stopped while light was reflected");
	}
	return gw_passes_run(&o->passes, GW_PASS_CACHE_MIPS, mips, &push, c->count, error);
}

static gw_status make(gw_render_octree *o, const gw_pixels *pixels, const gw_reflection *r,
					  gw_gloss_caches *c, gw_error *error)
{
	gw_gloss_clusters clusters = { 0 };
	double start = gw_seconds();
	GW_TRY(gw_gloss_clusters_make(pixels, CACHES_MOST, &clusters, error));
	c->count = (uint32_t)clusters.count;
	c->tile = clusters.tile;
	c->columns = clusters.columns;
	c->rows = clusters.rows;
	gw_status status = c->count ? place_all(o, pixels, &clusters, c, error) : GW_OK;
	double placed = gw_seconds();
	if (status == GW_OK && c->count)
		status = fill(o, pixels, r, c, error);
	o->cache_seconds.caches += c->count;
	o->cache_seconds.distribution += placed - start;
	o->cache_seconds.creation += gw_seconds() - placed;
	gw_gloss_clusters_clear(&clusters);
	return status;
}

gw_status gw_gloss_caches_make(gw_render_octree *o, const gw_pixels *pixels,
							   const gw_reflection *reflection, gw_gloss_caches *caches,
							   gw_error *error)
{
	*caches = (gw_gloss_caches){ .count = 0 };
	if (!pixels->place)
		return gw_fail(error, GW_ERROR_USAGE, "caches are for pixels with places in a picture");
	gw_status status = make(o, pixels, reflection, caches, error);
	if (status != GW_OK)
		gw_gloss_caches_destroy(o->gpu, caches);
	return status;
}

void gw_gloss_caches_destroy(gw_gpu *gpu, gw_gloss_caches *c)
{
	gw_buffer *const buffer[] = { &c->tile_first, &c->place, &c->facing,
								  &c->pixel,      &c->texel, &c->screen };
	for (size_t i = 0; i < sizeof buffer / sizeof *buffer; i++)
		gw_buffer_destroy(gpu, buffer[i]);
	free(c->reader);
	*c = (gw_gloss_caches){ .count = 0 };
}

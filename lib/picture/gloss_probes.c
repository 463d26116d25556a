/*
 * gloss_probes.c - the glossy bounce by the maps of probes; see gw_probes_reflect of
 * glowworm_picture.h. Rays leave the pixels as those of pixel_rays.comp do. Those that no probe
 * serves are kept, block by block of pixels, and traced together.
 */
#include "glowworm_picture.h"
#include "glowworm_probes.h"

#include "base/memory.h"
#include "base/parallel.h"
#include "picture/gloss_functions.h"
#include "picture/render_octree.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#define CHUNK 256u /* pixels that a thread takes at a time */

/* Rays of a block of pixels, at most, but for those of its last one: 24 MB. */
#define BLOCK_RAYS ((size_t)1 << 20)

/* A ray that no probe serves. */
typedef struct lost_ray {
	gw_vec3 way; /* unit */
	float share; /* of what it sees in the pixel */
	float chance;
	uint32_t pixel; /* of the block */
} lost_ray;

/* A block of pixels. */
typedef struct looking {
	const gw_probes *probes;
	const double *origin;
	const gw_pixels *pixels;
	const gw_reflection *reflection;
	float *reflected;
	size_t first, count;           /* pixels */
	lost_ray *lost;                /* reflection->rays a pixel; NULL: they aren't traced */
	uint32_t *lost_count;          /* a pixel */
	_Atomic uint64_t rays, traced; /* of all blocks */
	atomic_bool cancelled;
} looking;

static gw_vec3 facing_of(const gw_pixels *pixels, size_t pixel)
{
	const gw_vec3 at = gw_xyz(pixels->position + 4 * pixel), eye = gw_xyz(pixels->eye);
	return gw_gloss_facing(gw_xyz(pixels->normal + 4 * pixel), gw_unit(gw_minus(eye, at)));
}

/* What a pixel sees by the maps; `lost`, if not NULL, receives the rays that see nothing. Returns
 * how many these are. */
static uint32_t look_from(looking *l, size_t pixel, lost_ray *lost)
{
	const gw_vec3 at = gw_xyz(l->pixels->position + 4 * pixel), eye = gw_xyz(l->pixels->eye);
	const gw_gloss_seen seen = { .normal = facing_of(l->pixels, pixel),
								 .to_eye = gw_unit(gw_minus(eye, at)),
								 .roughness = l->pixels->position[4 * pixel + 3],
								 .reflectance = l->pixels->normal[4 * pixel + 3] };
	const double from[3] = { l->origin[0] + (double)at.x, l->origin[1] + (double)at.y,
							 l->origin[2] + (double)at.z };
	const uint32_t own = gw_gloss_word((uint32_t)pixel, l->reflection->seed);
	const uint32_t rays = gw_gloss_rays(&seen, l->reflection->rays);
	float *to = l->reflected + 4 * pixel;
	uint32_t count = 0;
	memset(to, 0, 4 * sizeof *to);
	for (uint32_t k = 0; k < rays; k++) {
		lost_ray ray = { .pixel = (uint32_t)(pixel - l->first) };
		gw_probe_look look;
		ray.way = gw_gloss_direction(&seen, own, k, &ray.share);
		ray.share /= (float)rays;
		gw_probes_look(l->probes, from, (const float[3]){ ray.way.x, ray.way.y, ray.way.z }, true,
					   &look);
		to[3] += ray.share;
		if (lost && look.probe < 0) {
			ray.chance = gw_gloss_chance(own, k);
			lost[count++] = ray;
			continue;
		}
		for (int c = 0; c < 3; c++)
			to[c] += ray.share * look.radiance[c];
	}
	atomic_fetch_add(&l->rays, rays);
	return count;
}

static void look_around(void *user, size_t first, size_t last, uint32_t worker)
{
	looking *l = user;
	const gw_reflection *r = l->reflection;
	/* Only the caller's own thread may be asked. */
	if (worker == 0 && r->cancelled && r->cancelled(r->user))
		atomic_store(&l->cancelled, true);
	for (size_t i = first; i < last && !atomic_load(&l->cancelled); i++) {
		lost_ray *lost = l->lost ? l->lost + i * r->rays : NULL;
		uint32_t count = look_from(l, l->first + i, lost);
		if (lost)
			l->lost_count[i] = count;
	}
}

/* ------------------------------------------------------------------------ rays that are traced */

/* The rays of a block that no probe serves, one behind the other. */
static size_t gather_lost(looking *l)
{
	size_t count = 0;
	for (size_t i = 0; i < l->count; i++)
		for (size_t k = 0; k < l->lost_count[i]; k++)
			l->lost[count++] = l->lost[i * l->reflection->rays + k];
	return count;
}

static gw_status trace_rays(looking *l, size_t count, float *numbers, gw_error *error)
{
	float *position = numbers, *normal = numbers + 4 * count, *way = numbers + 8 * count;
	float *light = numbers + 12 * count;
	for (size_t i = 0; i < count; i++) {
		const lost_ray *ray = l->lost + i;
		const size_t pixel = l->first + ray->pixel;
		const gw_vec3 facing = facing_of(l->pixels, pixel);
		memcpy(position + 4 * i, l->pixels->position + 4 * pixel, 3 * sizeof *position);
		position[4 * i + 3] = ray->chance;
		memcpy(normal + 4 * i, (const float[4]){ facing.x, facing.y, facing.z },
			   4 * sizeof *normal);
		memcpy(way + 4 * i, (const float[4]){ ray->way.x, ray->way.y, ray->way.z },
			   4 * sizeof *way);
	}
	const gw_given_rays rays = { { .count = count, .position = position, .normal = normal }, way };
	GW_TRY(gw_given_rays_trace(l->reflection->octree, &rays, l->reflection, light, error));
	for (size_t i = 0; i < count; i++) {
		float *to = l->reflected + 4 * (l->first + l->lost[i].pixel);
		for (size_t c = 0; c < 3; c++)
			to[c] += l->lost[i].share * light[4 * i + c];
	}
	return GW_OK;
}

static gw_status trace_lost(looking *l, gw_error *error)
{
	const size_t count = gather_lost(l);
	if (count == 0)
		return GW_OK;
	float *numbers = gw_allocate_array(count, 16 * sizeof *numbers);
	gw_status status = numbers ? trace_rays(l, count, numbers, error)
							   : gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu rays", count);
	free(numbers);
	l->traced += count;
	return status;
}

/* --------------------------------------------------------------------------------- all of them */

static gw_status reflect_block(looking *l, gw_lost_rays *told, gw_error *error)
{
	const double start = gw_seconds();
	gw_parallel_for(0, l->count, CHUNK, look_around, l);
	const double looked = gw_seconds();
	if (atomic_load(&l->cancelled))
		return gw_fail(error, GW_ERROR_CANCELLED, "stopped while light was reflected");
	if (!l->lost)
		return GW_OK;
	gw_status status = trace_lost(l, error);
	told->looking += looked - start;
	told->tracing += gw_seconds() - looked;
	return status;
}

static gw_status reflect_blocks(looking *l, gw_error *error)
{
	gw_lost_rays told = { 0 };
	const size_t block = l->count;
	gw_status status = GW_OK;
	for (; l->first < l->pixels->count && status == GW_OK; l->first += block) {
		const size_t left = l->pixels->count - l->first;
		l->count = left < block ? left : block;
		status = reflect_block(l, &told, error);
	}
	if (l->lost) {
		gw_lost_rays *all = &l->reflection->octree->lost;
		all->rays += l->rays;
		all->traced += l->traced;
		all->looking += told.looking;
		all->tracing += told.tracing;
	}
	return status;
}

gw_status gw_probes_reflect(const gw_probes *probes, const double origin[3],
							const gw_pixels *pixels, const gw_reflection *reflection,
							float *reflected, gw_error *error)
{
	const size_t block = (BLOCK_RAYS - 1) / reflection->rays + 1;
	looking l = { .probes = probes,
				  .origin = origin,
				  .pixels = pixels,
				  .reflection = reflection,
				  .reflected = reflected,
				  .count = pixels->count };
	if (reflection->octree && block < pixels->count)
		l.count = block;
	if (reflection->octree) {
		l.lost = gw_allocate_array(l.count * reflection->rays, sizeof *l.lost);
		l.lost_count = gw_allocate_array(l.count, sizeof *l.lost_count);
	}
	gw_status status = GW_OK;
	if (reflection->octree && (!l.lost || !l.lost_count))
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory for the rays of %zu pixels", l.count);
	if (status == GW_OK)
		status = reflect_blocks(&l, error);
	free(l.lost);
	free(l.lost_count);
	return status;
}

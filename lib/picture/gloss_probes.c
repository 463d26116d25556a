/*
 * gloss_probes.c - the glossy bounce by the maps of probes; see gw_probes_reflect of
 * glowworm_picture.h. Rays leave the pixels as those of pixel_rays.comp do.
 */
#include "glowworm_picture.h"
#include "glowworm_probes.h"

#include "base/parallel.h"
#include "picture/gloss_functions.h"

#include <stdatomic.h>
#include <string.h>

#define CHUNK 256u /* pixels that a thread takes at a time */

typedef struct looking {
	const gw_probes *probes;
	const double *origin;
	const gw_pixels *pixels;
	const gw_reflection *reflection;
	float *reflected;
	atomic_bool cancelled;
} looking;

static void look_from(const looking *l, size_t pixel)
{
	const gw_vec3 at = gw_xyz(l->pixels->position + 4 * pixel), eye = gw_xyz(l->pixels->eye);
	const float *facing = l->pixels->normal + 4 * pixel;
	gw_gloss_seen seen = { .to_eye = gw_unit(gw_minus(eye, at)),
						   .roughness = l->pixels->position[4 * pixel + 3],
						   .reflectance = facing[3] };
	seen.normal = gw_gloss_facing(gw_xyz(facing), seen.to_eye);
	const double from[3] = { l->origin[0] + (double)at.x, l->origin[1] + (double)at.y,
							 l->origin[2] + (double)at.z };
	const uint32_t own = gw_gloss_word((uint32_t)pixel, l->reflection->seed);
	const uint32_t rays = gw_gloss_rays(&seen, l->reflection->rays);
	float *to = l->reflected + 4 * pixel;
	memset(to, 0, 4 * sizeof *to);
	for (uint32_t k = 0; k < rays; k++) {
		float share;
		const gw_vec3 way = gw_gloss_direction(&seen, own, k, &share);
		gw_probe_look look;
		gw_probes_look(l->probes, from, (const float[3]){ way.x, way.y, way.z }, true, &look);
		for (int c = 0; c < 3; c++)
			to[c] += share / (float)rays * look.radiance[c];
		to[3] += share / (float)rays;
	}
}

static void look_around(void *user, size_t first, size_t last, uint32_t worker)
{
	looking *l = user;
	const gw_reflection *r = l->reflection;
	/* Only the caller's own thread may be asked. */
	if (worker == 0 && r->cancelled && r->cancelled(r->user))
		atomic_store(&l->cancelled, true);
	for (size_t i = first; i < last && !atomic_load(&l->cancelled); i++)
		look_from(l, i);
}

gw_status gw_probes_reflect(const gw_probes *probes, const double origin[3],
							const gw_pixels *pixels, const gw_reflection *reflection,
							float *reflected, gw_error *error)
{
	looking l = { .probes = probes,
				  .origin = origin,
				  .pixels = pixels,
				  .reflection = reflection,
				  .reflected = reflected };
	gw_parallel_for(0, pixels->count, CHUNK, look_around, &l);
	if (atomic_load(&l.cancelled))
		return gw_fail(error, GW_ERROR_CANCELLED, "stopped while light was reflected");
	return GW_OK;
}

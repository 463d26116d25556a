/*
 * cpu_kernels.c - the CPU kernels of the light's passes: loops over the shaders' texts (kernel.h).
 */
#include "light/cpu_loop.h"
#include "light/transport_layout.h"
#include "picture/gloss_cache.h"

#define CHUNK 4096u       /* facets, surfels or rays that a thread takes at a time */
#define CHUNK_POINTS 512u /* points that look for records */
#define CHUNK_HITS 65536u /* hits or vectors that are added up */

/* Elements of which each has so many rays or samples. */
static size_t chunk_of(size_t rays, uint32_t samples)
{
	return rays / (samples > 0 ? samples : 1) + 1;
}

void gw_cpu_light_visibility(gw_passes *passes, const gw_binding *b, const void *push,
							 uint64_t count)
{
	const gw_light_push *p = push;
	gw_kernel_loop(
		passes, GW_PASS_LIGHT_VISIBILITY,
		(gw_kernel_run){ .kernel = gw_kernel_light_visibility, .bindings = b, .push = push }, count,
		chunk_of(CHUNK, p->samples));
}

void gw_cpu_light_irradiance(gw_passes *passes, const gw_binding *b, const void *push,
							 uint64_t count)
{
	gw_kernel_loop(
		passes, GW_PASS_LIGHT_IRRADIANCE,
		(gw_kernel_run){ .kernel = gw_kernel_light_irradiance, .bindings = b, .push = push }, count,
		CHUNK);
}

void gw_cpu_facet_direct(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	gw_kernel_loop(passes, GW_PASS_FACET_DIRECT,
				   (gw_kernel_run){ .kernel = gw_kernel_facet_direct, .bindings = b, .push = push },
				   count, CHUNK);
}

void gw_cpu_record_rays(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	gw_kernel_loop(passes, GW_PASS_RECORD_RAYS,
				   (gw_kernel_run){ .kernel = gw_kernel_record_rays, .bindings = b, .push = push },
				   count, CHUNK);
}

void gw_cpu_record_again(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	gw_kernel_loop(passes, GW_PASS_RECORD_AGAIN,
				   (gw_kernel_run){ .kernel = gw_kernel_record_again, .bindings = b, .push = push },
				   count, CHUNK);
}

void gw_cpu_record_emitters(gw_passes *passes, const gw_binding *b, const void *push,
							uint64_t count)
{
	const gw_record_push *p = push;
	gw_kernel_loop(
		passes, GW_PASS_RECORD_EMITTERS,
		(gw_kernel_run){ .kernel = gw_kernel_record_emitters, .bindings = b, .push = push }, count,
		chunk_of(CHUNK, p->light_samples));
}

void gw_cpu_record_sky(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	const gw_record_push *p = push;
	gw_kernel_loop(passes, GW_PASS_RECORD_SKY,
				   (gw_kernel_run){ .kernel = gw_kernel_record_sky, .bindings = b, .push = push },
				   count, chunk_of(CHUNK, p->sky_samples));
}

void gw_cpu_record_portals(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	gw_kernel_loop(
		passes, GW_PASS_RECORD_PORTALS,
		(gw_kernel_run){ .kernel = gw_kernel_record_portals, .bindings = b, .push = push }, count,
		chunk_of(CHUNK, GW_PORTAL_SAMPLES));
}

void gw_cpu_portal_light(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	const gw_record_push *p = push;
	gw_kernel_loop(passes, GW_PASS_PORTAL_LIGHT,
				   (gw_kernel_run){ .kernel = gw_kernel_portal_light, .bindings = b, .push = push },
				   count, chunk_of(CHUNK, p->rays));
}

void gw_cpu_record_first(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	const gw_record_push *p = push;
	gw_kernel_loop(passes, GW_PASS_RECORD_FIRST,
				   (gw_kernel_run){ .kernel = gw_kernel_record_first, .bindings = b, .push = push },
				   count, chunk_of(CHUNK, p->rays));
}

void gw_cpu_record_gather(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	const gw_record_push *p = push;
	gw_kernel_loop(
		passes, GW_PASS_RECORD_GATHER,
		(gw_kernel_run){ .kernel = gw_kernel_record_gather, .bindings = b, .push = push }, count,
		chunk_of(CHUNK_HITS, p->rays));
}

void gw_cpu_record_moments(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	const gw_record_push *p = push;
	gw_kernel_loop(
		passes, GW_PASS_RECORD_MOMENTS,
		(gw_kernel_run){ .kernel = gw_kernel_record_moments, .bindings = b, .push = push }, count,
		chunk_of(CHUNK_HITS, p->rays));
}

void gw_cpu_record_share(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	const gw_record_push *p = push;
	gw_kernel_loop(passes, GW_PASS_RECORD_SHARE,
				   (gw_kernel_run){ .kernel = gw_kernel_record_share, .bindings = b, .push = push },
				   count, chunk_of(CHUNK, p->rays));
}

void gw_cpu_record_add(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	gw_kernel_loop(passes, GW_PASS_RECORD_ADD,
				   (gw_kernel_run){ .kernel = gw_kernel_record_add, .bindings = b, .push = push },
				   count, CHUNK_HITS);
}

void gw_cpu_facet_weights(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	gw_kernel_loop(
		passes, GW_PASS_FACET_WEIGHTS,
		(gw_kernel_run){ .kernel = gw_kernel_facet_weights, .bindings = b, .push = push }, count,
		CHUNK_POINTS);
}

void gw_cpu_facet_shade(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	gw_kernel_loop(passes, GW_PASS_FACET_SHADE,
				   (gw_kernel_run){ .kernel = gw_kernel_facet_shade, .bindings = b, .push = push },
				   count, CHUNK);
}

void gw_cpu_read_back(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	gw_kernel_loop(passes, GW_PASS_READ_BACK,
				   (gw_kernel_run){ .kernel = gw_kernel_read_back, .bindings = b, .push = push },
				   count, CHUNK_POINTS);
}

void gw_cpu_volume_rays(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	gw_kernel_loop(passes, GW_PASS_VOLUME_RAYS,
				   (gw_kernel_run){ .kernel = gw_kernel_volume_rays, .bindings = b, .push = push },
				   count, CHUNK);
}

void gw_cpu_volume_fill(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	const gw_volume_push *p = push;
	gw_kernel_loop(passes, GW_PASS_VOLUME_FILL,
				   (gw_kernel_run){ .kernel = gw_kernel_volume_fill, .bindings = b, .push = push },
				   count, chunk_of(CHUNK_HITS, p->rays));
}

void gw_cpu_volume_weights(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	gw_kernel_loop(
		passes, GW_PASS_VOLUME_WEIGHTS,
		(gw_kernel_run){ .kernel = gw_kernel_volume_weights, .bindings = b, .push = push }, count,
		CHUNK_POINTS);
}

void gw_cpu_volume_read(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	gw_kernel_loop(passes, GW_PASS_VOLUME_READ,
				   (gw_kernel_run){ .kernel = gw_kernel_volume_read, .bindings = b, .push = push },
				   count, CHUNK);
}

void gw_cpu_volume_faces(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	gw_kernel_loop(passes, GW_PASS_VOLUME_FACES,
				   (gw_kernel_run){ .kernel = gw_kernel_volume_faces, .bindings = b, .push = push },
				   count, CHUNK);
}

void gw_cpu_volume_inject(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	gw_kernel_loop(
		passes, GW_PASS_VOLUME_INJECT,
		(gw_kernel_run){ .kernel = gw_kernel_volume_inject, .bindings = b, .push = push }, count,
		CHUNK_POINTS);
}

void gw_cpu_volume_spread(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	gw_kernel_loop(
		passes, GW_PASS_VOLUME_SPREAD,
		(gw_kernel_run){ .kernel = gw_kernel_volume_spread, .bindings = b, .push = push }, count,
		CHUNK);
}

void gw_cpu_probe_sight(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	gw_kernel_loop(passes, GW_PASS_PROBE_SIGHT,
				   (gw_kernel_run){ .kernel = gw_kernel_probe_sight, .bindings = b, .push = push },
				   count, CHUNK_POINTS);
}

void gw_cpu_probe_rays(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	gw_kernel_loop(passes, GW_PASS_PROBE_RAYS,
				   (gw_kernel_run){ .kernel = gw_kernel_probe_rays, .bindings = b, .push = push },
				   count, CHUNK_POINTS);
}

void gw_cpu_given_rays(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	gw_kernel_loop(passes, GW_PASS_GIVEN_RAYS,
				   (gw_kernel_run){ .kernel = gw_kernel_given_rays, .bindings = b, .push = push },
				   count, CHUNK);
}

void gw_cpu_cache_rays(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	gw_kernel_loop(passes, GW_PASS_CACHE_RAYS,
				   (gw_kernel_run){ .kernel = gw_kernel_cache_rays, .bindings = b, .push = push },
				   count, CHUNK);
}

void gw_cpu_cache_mips(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	gw_kernel_loop(passes, GW_PASS_CACHE_MIPS,
				   (gw_kernel_run){ .kernel = gw_kernel_cache_mips, .bindings = b, .push = push },
				   count, chunk_of(CHUNK_HITS, GW_CACHE_TEXELS));
}

void gw_cpu_pixel_caches(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	gw_kernel_loop(passes, GW_PASS_PIXEL_CACHES,
				   (gw_kernel_run){ .kernel = gw_kernel_pixel_caches, .bindings = b, .push = push },
				   count, chunk_of(CHUNK, GW_CACHE_LOOKS));
}

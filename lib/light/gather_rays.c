/*
 * gather_rays.c - see gather_rays.h.
 */
#include "light/gather_rays.h"

#include "base/memory.h"
#include "light/shut_out.h"
#include "light/transport_layout.h"

#include <stdlib.h>

gw_status gw_ray_gather_create(gw_gpu *gpu, const gw_records *records, uint32_t rays, uint32_t seed,
							   gw_ray_gather *gather, gw_error *error)
{
	*gather = (gw_ray_gather){ .rays = rays, .seed = seed };
	uint64_t count = (uint64_t)rays * records->count;
	if (count > UINT32_MAX)
		return gw_fail(error, GW_ERROR_MEMORY,
					   "%u records with %u rays each are more than 2^32 rays; use fewer rays or a "
					   "larger record spacing",
					   records->count, rays);
	gw_status status = gw_buffer_create(
		gpu,
		&(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_R32_UINT, 4 * count, "hit facet" },
		&gather->facet, error);
	if (status == GW_OK)
		status = gw_buffer_create(gpu,
								  &(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_R32_SFLOAT,
															4 * count, "hit distance" },
								  &gather->distance, error);
	if (status != GW_OK)
		gw_ray_gather_destroy(gpu, gather);
	return status;
}

gw_status gw_ray_gather_trace(const gw_record_context *on, uint32_t rays, uint32_t seed,
							  gw_ray_gather *gather, gw_error *error)
{
	uint64_t count = (uint64_t)rays * on->records->count;
	gw_status status =
		gw_ray_gather_create(on->passes->gpu, on->records, rays, seed, gather, error);
	if (status == GW_OK) {
		const gw_binding bindings[] = {
			GW_TRACE_BINDINGS(on->octree),   gw_whole(&on->records->position),
			gw_whole(&on->records->normal),  gw_window(&gather->facet, 4),
			gw_window(&gather->distance, 4), GW_DISC_BINDINGS(on->octree),
			GW_TREE_BINDING(on->octree),     GW_OPACITY_BINDING(on->octree),
			GW_LEAF_BINDING(on->octree)
		};
		gw_record_push push = { .rays = rays, .seed = seed };
		status = gw_passes_run(on->passes, GW_PASS_RECORD_RAYS, bindings, &push, count, error);
	}
	if (status != GW_OK)
		gw_ray_gather_destroy(on->passes->gpu, gather);
	return status;
}

void gw_ray_gather_destroy(gw_gpu *gpu, gw_ray_gather *gather)
{
	gw_buffer_destroy(gpu, &gather->facet);
	gw_buffer_destroy(gpu, &gather->distance);
	gw_buffer_destroy(gpu, &gather->through);
}

gw_status gw_ray_gather_shut_out(const gw_record_context *on, gw_ray_gather *gather,
								 gw_error *error)
{
	if (gather->shut_out == on->records->count)
		return GW_OK;
	GW_TRY(gw_shut_out_hits(on, gather->rays, &gather->facet, error));
	gather->shut_out = on->records->count;
	return GW_OK;
}

/* What two buffers hold, one behind the other; values has room for it. */
static gw_status join(gw_gpu *gpu, VkFormat format, gw_buffer *const part[2], char *values,
					  gw_buffer *joined, gw_error *error)
{
	uint64_t first = part[0]->bytes, bytes = first + part[1]->bytes;
	GW_TRY(gw_buffer_download(gpu, part[0], 0, values, first, error));
	GW_TRY(gw_buffer_download(gpu, part[1], 0, values + first, part[1]->bytes, error));
	GW_TRY(gw_buffer_create(
		gpu, &(gw_buffer_description){ GW_BUFFER_TEXEL, format, bytes, part[0]->name }, joined,
		error));
	return gw_buffer_upload(gpu, joined, 0, values, bytes, error);
}

/* Puts what another buffer holds behind *buffer. */
static gw_status append(gw_gpu *gpu, VkFormat format, gw_buffer *more, gw_buffer *buffer,
						gw_error *error)
{
	gw_buffer joined = { 0 };
	uint64_t bytes = buffer->bytes + more->bytes;
	char *values = gw_allocate_array(bytes, 1);
	if (!values)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %llu bytes of %s",
					   (unsigned long long)bytes, buffer->name);
	gw_buffer *const part[2] = { buffer, more };
	gw_status status = join(gpu, format, part, values, &joined, error);
	free(values);
	if (status != GW_OK) {
		gw_buffer_destroy(gpu, &joined);
		return status;
	}
	gw_buffer_destroy(gpu, buffer);
	*buffer = joined;
	return GW_OK;
}

gw_status gw_ray_gather_add(const gw_record_context *on, gw_ray_gather *gather, gw_ray_gather *own,
							gw_error *error)
{
	gw_gpu *gpu = on->passes->gpu;
	GW_TRY(gw_ray_gather_trace(on, gather->rays, gather->seed, own, error));
	GW_TRY(append(gpu, VK_FORMAT_R32_UINT, &own->facet, &gather->facet, error));
	return append(gpu, VK_FORMAT_R32_SFLOAT, &own->distance, &gather->distance, error);
}

gw_status gw_ray_gather_open(const gw_record_context *on, const gw_portals *portals,
							 gw_ray_gather *gather, gw_error *error)
{
	if (portals->count == 0 || gather->through.handle != VK_NULL_HANDLE)
		return GW_OK;
	gw_status status = gw_buffer_create(
		on->passes->gpu,
		&(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_R32_UINT,
								  4 * (uint64_t)on->records->count, "sky through portals" },
		&gather->through, error);
	if (status == GW_OK) {
		const gw_binding bindings[] = {
			GW_TRACE_BINDINGS(on->octree),  gw_whole(&on->records->position),
			gw_whole(&on->records->normal), gw_whole(&portals->sphere),
			gw_window(&gather->through, 4), GW_DISC_BINDINGS(on->octree),
			GW_TREE_BINDING(on->octree),    GW_OPACITY_BINDING(on->octree),
			GW_LEAF_BINDING(on->octree)
		};
		gw_record_push push = { .seed = gather->seed, .portals = portals->count };
		status = gw_passes_run(on->passes, GW_PASS_RECORD_PORTALS, bindings, &push,
							   on->records->count, error);
	}
	if (status != GW_OK)
		gw_buffer_destroy(on->passes->gpu, &gather->through);
	return status;
}

gw_status gw_ray_gather_open_further(const gw_record_context *on, const gw_portals *portals,
									 gw_ray_gather *gather, gw_ray_gather *own, gw_error *error)
{
	if (gather->through.handle == VK_NULL_HANDLE)
		return GW_OK;
	GW_TRY(gw_ray_gather_open(on, portals, own, error));
	return append(on->passes->gpu, VK_FORMAT_R32_UINT, &own->through, &gather->through, error);
}

/* One gather from sources under way. */
typedef struct gathering {
	const gw_record_context *on;
	const gw_ray_gather *gather;
	const gw_sampled_sources *sources;
	gw_buffer sampled; /* what samples bring, vec4 a record; w: mark of its compartment */
} gathering;

/* Where moments go; any buffer will do where none are asked for. */
static gw_binding moment_of(const gathering *g)
{
	return g->sources->moment ? gw_window(g->sources->moment, 32) : gw_window(&g->sampled, 16);
}

/* Adds samples of the emitters to what is sampled. */
static gw_status sample_emitters(const gathering *g, gw_record_push push, gw_error *error)
{
	const gw_emitters *emitters = g->sources->emitters;
	const gw_binding bindings[] = { GW_TRACE_BINDINGS(g->on->octree),
									gw_whole(emitters->radiance),
									gw_whole(&emitters->table),
									gw_window(&g->on->records->position, 16),
									gw_window(&g->on->records->normal, 16),
									gw_window(&g->sampled, 16),
									gw_whole(g->sources->part ? g->sources->part
															  : emitters->radiance),
									GW_DISC_BINDINGS(g->on->octree),
									GW_TREE_BINDING(g->on->octree),
									GW_OPACITY_BINDING(g->on->octree),
									moment_of(g),
									GW_LEAF_BINDING(g->on->octree) };
	push.batch_count = push.light_samples;
	return gw_passes_run(g->on->passes, GW_PASS_RECORD_EMITTERS, bindings, &push,
						 g->on->records->count, error);
}

/* Any buffer will do where there are none. */
static const gw_buffer *spheres_of(const gw_sampled_sources *sources)
{
	return sources->portals && sources->portals->count > 0 ? &sources->portals->sphere
														   : sources->emitters->radiance;
}

/* The same for the map of the sky. */
static gw_status sample_sky(const gathering *g, gw_record_push push, gw_error *error)
{
	const gw_sky_map *map = g->sources->map;
	const gw_binding bindings[] = { GW_TRACE_BINDINGS(g->on->octree),
									gw_whole(&map->texel),
									gw_whole(&map->alias),
									gw_window(&g->on->records->position, 16),
									gw_window(&g->on->records->normal, 16),
									gw_window(&g->sampled, 16),
									GW_DISC_BINDINGS(g->on->octree),
									gw_whole(spheres_of(g->sources)),
									GW_TREE_BINDING(g->on->octree),
									GW_OPACITY_BINDING(g->on->octree),
									moment_of(g),
									GW_LEAF_BINDING(g->on->octree) };
	push.batch_count = push.sky_samples;
	return gw_passes_run(g->on->passes, GW_PASS_RECORD_SKY, bindings, &push, g->on->records->count,
						 error);
}

/* Adds the sky as rays and samples of portals see it. */
static gw_status add_opened(const gathering *g, gw_record_push push, gw_error *error)
{
	const gw_binding bindings[] = { gw_whole(&g->gather->facet),
									gw_whole(&g->gather->through),
									gw_whole(spheres_of(g->sources)),
									gw_whole(push.sky_width > 0 ? &g->sources->map->texel
																: g->sources->emitters->radiance),
									gw_window(&g->on->records->position, 16),
									gw_window(&g->on->records->normal, 16),
									gw_window(&g->sampled, 16),
									moment_of(g),
									GW_LEAF_BINDING(g->on->octree) };
	push.seed = g->gather->seed;
	push.batch_count = push.rays;
	return gw_passes_run(g->on->passes, GW_PASS_PORTAL_LIGHT, bindings, &push,
						 g->on->records->count, error);
}

void gw_sampled_map_push(const gw_sampled_sources *sources, struct gw_record_push *push)
{
	const gw_sky_map *map = sources->map;
	if (!map || map->width == 0)
		return;
	push->sky_width = map->width;
	push->sky_height = map->height;
	push->sky_samples = sources->map_samples;
	push->sky_hits = sources->map_hits;
	push->sky_total = map->total;
	push->sky_turn = map->turn;
	push->sky_y_up = map->y_up;
}

static gw_status add_times(gw_passes *passes, float share, const gw_buffer *from, gw_buffer *to,
						   uint64_t count, gw_error *error)
{
	const gw_binding bindings[] = { gw_window(from, 16), gw_window(to, 16) };
	return gw_passes_run(passes, GW_PASS_RECORD_ADD, bindings, &(gw_record_push){ .share = share },
						 count, error);
}

gw_status gw_light_add(gw_passes *passes, const gw_buffer *from, gw_buffer *to, uint64_t count,
					   gw_error *error)
{
	return add_times(passes, 1.0f, from, to, count, error);
}

gw_status gw_light_take(gw_passes *passes, const gw_buffer *from, gw_buffer *to, uint64_t count,
						gw_error *error)
{
	return add_times(passes, -1.0f, from, to, count, error);
}

/* What the rays themselves meet, and what was sampled. */
static gw_status gather_hits(const gathering *g, gw_record_push push, gw_buffer *irradiance,
							 gw_error *error)
{
	const gw_buffer *radiance = g->sources->emitters->radiance;
	/* The directions of the rays are made again, from their seed. */
	push.seed = g->gather->seed;
	if (push.portals > 0) {
		push.sky = (vec4){ 0 };
		push.sky_hits = 0;
	}
	const gw_binding bindings[] = { gw_whole(&g->gather->facet),
									gw_whole(&g->gather->distance),
									gw_whole(&g->on->octree->facet_plane),
									gw_whole(radiance),
									gw_window(&g->sampled, 16),
									gw_window(&g->on->records->position, 16),
									gw_window(&g->on->records->normal, 16),
									gw_window(irradiance, 16),
									gw_whole(g->sources->part ? g->sources->part : radiance),
									gw_whole(push.sky_width > 0 ? &g->sources->map->texel
																: radiance),
									moment_of(g),
									GW_LEAF_BINDING(g->on->octree) };
	return gw_passes_run(g->on->passes, GW_PASS_RECORD_FIRST, bindings, &push,
						 g->on->records->count, error);
}

/* All sources at once. */
static gw_status gather_all(const gathering *g, gw_record_push push, gw_buffer *irradiance,
							gw_error *error)
{
	if (push.light_samples > 0)
		GW_TRY(sample_emitters(g, push, error));
	if (push.sky_width > 0)
		GW_TRY(sample_sky(g, push, error));
	if (push.portals > 0)
		GW_TRY(add_opened(g, push, error));
	return gather_hits(g, push, irradiance, error);
}

static gw_status gather_sources(const gw_record_context *on, const gw_ray_gather *gather,
								const gw_sampled_sources *sources, gw_buffer *irradiance,
								gw_error *error)
{
	const gw_emitters *emitters = sources->emitters;
	const float *sky = sources->sky;
	bool map = sources->map && sources->map->width > 0;
	gathering g = { .on = on, .gather = gather, .sources = sources };
	bool dark = emitters->count == 0 && !map && sky[0] == 0.0f && sky[1] == 0.0f && sky[2] == 0.0f;
	if (sources->moment)
		GW_TRY(gw_buffer_fill(on->passes->gpu, sources->moment, 0, error));
	if (dark && sources->looked)
		return gw_buffer_fill(on->passes->gpu, irradiance, 0, error);
	bool sampled_too =
		emitters->count > 0 && !(sources->use_hits && gw_emitters_are_everywhere(emitters));
	gw_record_push push = { .rays = gather->rays,
							.seed = sources->seed,
							.light_samples = sampled_too ? sources->samples : 0,
							.emitters = emitters->count,
							.emitter_power = emitters->power,
							.use_hits = sources->use_hits && emitters->count > 0,
							.looked = sources->looked,
							.moments = sources->moment != NULL,
							.sky = { sky[0], sky[1], sky[2], 0.0f } };
	gw_sampled_map_push(sources, &push);
	bool shines = map || sky[0] > 0.0f || sky[1] > 0.0f || sky[2] > 0.0f;
	if (shines && sources->portals && gather->through.handle != VK_NULL_HANDLE)
		push.portals = sources->portals->count;
	gw_status status = gw_buffer_create(
		on->passes->gpu,
		&(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_R32G32B32A32_SFLOAT,
								  16 * (uint64_t)on->records->count, "sampled irradiance" },
		&g.sampled, error);
	if (status == GW_OK && (shines || push.light_samples > 0))
		status = gw_shut_out_mark(on, &g.sampled, error);
	if (status == GW_OK)
		status = gather_all(&g, push, irradiance, error);
	gw_buffer_destroy(on->passes->gpu, &g.sampled);
	return status;
}

/* Buffers for what emitters alone bring, and for its moment where that is asked for. */
static gw_status make_kept(const gw_record_context *on, const gw_sampled_sources *sources,
						   gw_error *error)
{
	const uint64_t bytes = 16 * (uint64_t)on->records->count;
	GW_TRY(
		gw_buffer_create(on->passes->gpu,
						 &(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_R32G32B32A32_SFLOAT,
												   bytes, "irradiance from emitters" },
						 sources->kept, error));
	if (!sources->moment)
		return GW_OK;
	return gw_buffer_create(on->passes->gpu,
							&(gw_buffer_description){ GW_BUFFER_TEXEL,
													  VK_FORMAT_R32G32B32A32_SFLOAT, 2 * bytes,
													  "moment of irradiance from emitters" },
							sources->kept_moment, error);
}

static void drop_kept(gw_gpu *gpu, const gw_sampled_sources *sources)
{
	gw_buffer_destroy(gpu, sources->kept);
	if (sources->kept_moment)
		gw_buffer_destroy(gpu, sources->kept_moment);
}

/* What emitters alone bring, unless that is kept from before with all that is asked for. */
static gw_status keep_emitters(const gw_record_context *on, const gw_ray_gather *gather,
							   const gw_sampled_sources *sources, gw_error *error)
{
	const float black[3] = { 0 };
	gw_sampled_sources alone = *sources;
	if (sources->kept->handle != VK_NULL_HANDLE &&
		(!sources->moment || sources->kept_moment->handle != VK_NULL_HANDLE))
		return GW_OK;
	drop_kept(on->passes->gpu, sources);
	alone.sky = black;
	alone.map = NULL;
	alone.moment = sources->moment ? sources->kept_moment : NULL;
	gw_status status = make_kept(on, sources, error);
	if (status == GW_OK)
		status = gather_sources(on, gather, &alone, sources->kept, error);
	if (status != GW_OK)
		drop_kept(on->passes->gpu, sources);
	return status;
}

gw_status gw_ray_gather_sample_further(const gw_record_context *on, const gw_ray_gather *own,
									   const gw_sampled_sources *sources, gw_error *error)
{
	const VkFormat format = VK_FORMAT_R32G32B32A32_SFLOAT;
	gw_gpu *gpu = on->passes->gpu;
	gw_buffer more = { 0 }, more_moment = { 0 };
	gw_sampled_sources alone = *sources;
	bool moments = sources->kept_moment && sources->kept_moment->handle != VK_NULL_HANDLE;
	alone.kept = &more;
	alone.kept_moment = &more_moment;
	alone.moment = moments ? &more_moment : NULL;
	alone.looked = false;
	gw_status status = keep_emitters(on, own, &alone, error);
	if (status == GW_OK)
		status = append(gpu, format, &more, sources->kept, error);
	if (status == GW_OK && moments)
		status = append(gpu, format, &more_moment, sources->kept_moment, error);
	gw_buffer_destroy(gpu, &more);
	gw_buffer_destroy(gpu, &more_moment);
	return status;
}

gw_status gw_ray_gather_sampled(const gw_record_context *on, const gw_ray_gather *gather,
								const gw_sampled_sources *sources, gw_buffer *irradiance,
								gw_error *error)
{
	const gw_emitters none = { .radiance = sources->emitters->radiance };
	gw_sampled_sources others = *sources;
	if (!sources->kept)
		return gather_sources(on, gather, sources, irradiance, error);
	others.emitters = &none;
	GW_TRY(keep_emitters(on, gather, sources, error));
	GW_TRY(gather_sources(on, gather, &others, irradiance, error));
	if (sources->moment)
		GW_TRY(gw_light_add(on->passes, sources->kept_moment, sources->moment,
							2 * (uint64_t)on->records->count, error));
	return gw_light_add(on->passes, sources->kept, irradiance, on->records->count, error);
}

gw_status gw_ray_gather_look(const gw_record_context *on, const gw_ray_gather *gather,
							 gw_error *error)
{
	const float black[3] = { 0 };
	const gw_emitters none = { .radiance = &on->octree->facet_emission };
	const gw_sampled_sources nothing = { .emitters = &none, .sky = black };
	return gw_ray_gather_sampled(on, gather, &nothing, &on->records->first, error);
}

gw_status gw_ray_gather_bounce(gw_passes *passes, const gw_ray_gather *gather,
							   const gw_buffer *facet_radiance, gw_records *records,
							   gw_error *error)
{
	const gw_binding bindings[] = { gw_whole(&gather->facet), gw_whole(facet_radiance),
									gw_window(&records->normal, 16),
									gw_window(&records->gathered, 16),
									gw_whole(&gather->distance) };
	gw_record_push push = { .rays = gather->rays };
	return gw_passes_run(passes, GW_PASS_RECORD_GATHER, bindings, &push, records->count, error);
}

gw_status gw_ray_gather_moments(const gw_record_context *on, const gw_ray_gather *gather,
								const gw_buffer *facet_radiance, gw_buffer *moment, gw_error *error)
{
	const gw_binding bindings[] = { gw_whole(&gather->facet),
									gw_whole(facet_radiance),
									gw_window(&on->records->position, 16),
									gw_window(&on->records->normal, 16),
									gw_window(moment, 32),
									gw_whole(&gather->distance) };
	const gw_record_push push = { .rays = gather->rays, .seed = gather->seed };
	return gw_passes_run(on->passes, GW_PASS_RECORD_MOMENTS, bindings, &push, on->records->count,
						 error);
}

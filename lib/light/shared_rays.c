/*
 * shared_rays.c - see shared_rays.h.
 */
#include "light/shared_rays.h"

#include "light/shut_out.h"
#include "light/transport_layout.h"

/* What the pass takes beside what there is. */
typedef struct sharing {
	gw_record_push push;
	gw_buffer facet; /* R32_UINT: where each record was placed */
	gw_buffer mark;  /* vec4 a record; w: of its compartment */
} sharing;

static gw_status make_texels(const gw_shared_rays *task, VkFormat format, uint64_t size,
							 gw_buffer *buffer, gw_error *error)
{
	const gw_buffer_description texels = { GW_BUFFER_TEXEL, format, size * task->on->records->count,
										   "places of records" };
	return gw_buffer_create(task->on->passes->gpu, &texels, buffer, error);
}

/* Where there are no moments, or no light, any buffer will do. */
static gw_status run(const gw_shared_rays *task, const sharing *s, gw_error *error)
{
	const gw_records *r = task->on->records;
	const gw_octree *octree = task->on->octree;
	const gw_binding bindings[] = {
		gw_whole(&task->gather->facet),
		gw_whole(task->facet_radiance ? task->facet_radiance : &octree->facet_plane),
		gw_whole(&r->position),
		gw_whole(&r->normal),
		gw_whole(&octree->facet_plane),
		gw_whole(&task->gather->distance),
		gw_whole(&s->facet),
		gw_whole(&r->facet_row),
		gw_whole(&r->facet_record),
		gw_whole(s->push.sky_width > 0 ? &task->sky->map->texel : &octree->facet_plane),
		gw_window(&s->mark, 16),
		gw_window(&r->first, 16),
		task->moments ? gw_window(&r->first_moment, 32) : gw_window(&r->first, 16),
		gw_window(&r->indirect, 16),
		task->moments ? gw_window(&r->indirect_moment, 32) : gw_window(&r->indirect, 16)
	};
	return gw_passes_run(task->on->passes, GW_PASS_RECORD_SHARE, bindings, &s->push, r->count,
						 error);
}

static gw_status share(const gw_shared_rays *task, sharing *s, gw_error *error)
{
	const gw_records *r = task->on->records;
	gw_gpu *gpu = task->on->passes->gpu;
	GW_TRY(make_texels(task, VK_FORMAT_R32_UINT, 4, &s->facet, error));
	GW_TRY(gw_buffer_upload(gpu, &s->facet, 0, r->facet, 4 * (uint64_t)r->count, error));
	GW_TRY(make_texels(task, VK_FORMAT_R32G32B32A32_SFLOAT, 16, &s->mark, error));
	GW_TRY(gw_shut_out_mark(task->on, &s->mark, error));
	return run(task, s, error);
}

/* Whether rays see a sky that is not sampled through portals; then push has it. */
static bool put_sky(const gw_shared_rays *task, gw_record_push *push)
{
	const gw_sampled_sources *from = task->sky;
	const float *sky = from->sky;
	bool portals =
		from->portals && from->portals->count > 0 && task->gather->through.handle != VK_NULL_HANDLE;
	if (portals)
		return false;
	push->sky = (vec4){ sky[0], sky[1], sky[2], 0.0f };
	gw_sampled_map_push(from, push);
	return push->sky_width > 0 || sky[0] > 0.0f || sky[1] > 0.0f || sky[2] > 0.0f;
}

gw_status gw_shared_rays_see(const gw_shared_rays *task, gw_error *error)
{
	const gw_records *r = task->on->records;
	sharing s = { .push = { .rays = task->gather->rays,
							.seed = task->gather->seed,
							.use_hits = task->facet_radiance != NULL,
							.moments = task->moments } };
	bool sky = put_sky(task, &s.push);
	s.push.looked = !sky;
	if (!r->facet || r->count == 0 || (!sky && !task->facet_radiance))
		return GW_OK;
	gw_status status = share(task, &s, error);
	gw_buffer_destroy(task->on->passes->gpu, &s.mark);
	gw_buffer_destroy(task->on->passes->gpu, &s.facet);
	return status;
}

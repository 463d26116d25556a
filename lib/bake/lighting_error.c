/*
 * lighting_error.c - see lighting_error.h.
 */
#include "bake/lighting_error.h"

#include "bake/scene_records.h"
#include "base/memory.h"
#include "estimate/error_estimate.h"
#include "estimate/gap_error.h"

#include <stdlib.h>

/* Rays that light comes along to what an estimate is held against. */
static uint32_t rays_of(const gw_bake_options *o)
{
	return gw_method_keeps_hits(o->method) ? o->rays : o->light_samples;
}

gw_status gw_lighting_foresee(gw_lighting *lighting, gw_error *error)
{
	gw_scene *s = lighting->scene;
	const gw_check_point_task task = { .passes = &s->passes,
									   .octree = &s->octree,
									   .surfels = &s->surfels,
									   .emitters = &lighting->emitters,
									   .rays = gw_estimate_rays(rays_of(&s->options)),
									   .seed = (uint32_t)s->options.seed };
	if (lighting->plan.records)
		GW_TRY(gw_scene_find_compartments(s, error));
	return s->check_points.count > 0
			   ? GW_OK
			   : gw_estimate_foresee(
					 &task, gw_estimate_points(s->options.estimate_points, s->records.count),
					 &s->check_points, error);
}

static gw_status find_gap_error(gw_lighting *lighting, const gw_estimate_task *estimate,
								gw_error *error)
{
	gw_scene *s = lighting->scene;
	const gw_gap_error_task task = { .on = gw_scene_context(s, &s->records),
									 .surfels = &s->surfels,
									 .asked = s->region.asked,
									 .space = &s->space,
									 .read_back = &s->read_back,
									 .gap = lighting->gap,
									 .rays = &s->rays,
									 .direct = estimate->direct,
									 .first = lighting->surfel_first,
									 .indirect = lighting->surfel_indirect,
									 .lights = lighting->lights,
									 .light_count = estimate->light_count,
									 .limit = estimate->limit,
									 .options = &s->options,
									 .discs = estimate->discs };
	return gw_gap_error(&task, &s->report->gaps, &s->report->error, error);
}

/* The surfels whose light is asked for: of surface that may face either way those of the side that
 * is shown.
 *   asked   receives them, one a surfel, or NULL: all
 *   own     receives the same for free(), or NULL where they are the region's */
static gw_status list_asked(gw_lighting *lighting, const bool **asked, bool **own, gw_error *error)
{
	const gw_scene *s = lighting->scene;
	*asked = s->region.asked;
	*own = NULL;
	GW_TRY(gw_lighting_choose_sides(lighting, error));
	if (!lighting->shown)
		return GW_OK;
	*asked = *own = gw_allocate_zeros(s->surfels.count, sizeof **own);
	if (!*own)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the sides of %zu points",
					   s->surfels.count);
	for (size_t i = 0; i < s->surfels.count; i++)
		if (s->surfels.two_sided[i] != GW_SIDE_BACK)
			(*own)[lighting->shown[i]] = !s->region.asked || s->region.asked[i];
	return GW_OK;
}

static gw_status estimate(gw_lighting *lighting, const bool *asked, gw_error *error)
{
	gw_scene *s = lighting->scene;
	const gw_bake_options *o = &s->options;
	gw_view direct, turned = { 0 };
	gw_check_discs discs = { .tree = &s->check_tree };
	gw_status status = gw_lighting_view(lighting, &lighting->surfel_direct, &direct, error);
	if (status == GW_OK)
		status = gw_lighting_view(lighting, &lighting->surfel_turned, &turned, error);
	if (status == GW_OK) {
		const gw_estimate_task task = {
			.passes = &s->passes,
			.octree = &s->octree,
			.surfels = &s->surfels,
			.records = lighting->plan.records ? &s->records : NULL,
			.read_back = &s->read_back,
			.rays_of_records = &s->rays,
			.emitters = &lighting->emitters,
			.facet_direct = &lighting->facet_direct,
			.sky = lighting->plan.sky_radiance,
			.map = &lighting->map,
			.portals = &s->portals,
			.bounces = lighting->plan.bounces,
			.direct = direct.bytes,
			.turned = turned.bytes,
			.first = lighting->surfel_first,
			.indirect = lighting->surfel_indirect,
			.rays = rays_of(o),
			.light_samples = o->light_samples,
			.points = gw_estimate_points(o->estimate_points, s->records.count),
			.seed = (uint32_t)o->seed,
			.threads = o->threads,
			.lights = lighting->lights,
			.light_count = lighting->plan.lamps ? lighting->light_count : 0,
			.options = o,
			.limit = lighting->plan.bounces ? lighting->plan.limit : 1,
			.remaining = s->report->remaining,
			.asked = asked,
			.seen = s->space.scanners > 0 || s->surfels.seen_from_above,
			.closed = gw_scene_closed_space(s),
			.hits = &s->check_points,
			.discs = &discs
		};
		status = gw_estimate_error(&task, &s->report->error, error);
		if (status == GW_OK && lighting->gap)
			status = find_gap_error(lighting, &task, error);
	}
	gw_check_discs_close(&discs);
	gw_view_close(&turned);
	gw_view_close(&direct);
	return status;
}

gw_status gw_lighting_estimate(gw_lighting *lighting, gw_error *error)
{
	const bool *asked;
	bool *own;
	gw_status status = list_asked(lighting, &asked, &own, error);
	if (status == GW_OK)
		status = estimate(lighting, asked, error);
	free(own);
	return status;
}

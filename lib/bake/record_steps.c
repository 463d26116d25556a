/*
 * record_steps.c - see record_steps.h.
 */
#include "bake/record_steps.h"

#include "bake/options_check.h"
#include "bake/plan.h"
#include "bake/region_records.h"
#include "bake/report.h"
#include "bake/scene_probes.h"
#include "bake/scene_records.h"
#include "base/memory.h"
#include "octree/compartments.h"

/* What the records see by the maps of probes. */
static gw_status follow_maps(gw_scene *scene, gw_error *error)
{
	const gw_record_context on = gw_scene_context(scene, &scene->records);
	GW_TRY(gw_scene_make_maps(scene, error));
	scene->traced = (uint64_t)scene->options.rays * scene->records.count;
	return gw_probe_gather_trace(&on, &scene->maps, scene->options.rays,
								 (uint32_t)scene->options.seed, &scene->rays, error);
}

/* What the records see; for cones, how near their surroundings are. */
static gw_status trace_records(gw_scene *scene, gw_error *error)
{
	const gw_record_context on = gw_scene_context(scene, &scene->records);
	const gw_bake_options *o = &scene->options;
	if (o->method == GW_METHOD_PROBES)
		GW_TRY(follow_maps(scene, error));
	else if (scene->kept)
		GW_TRY(gw_kept_hits_trace(&on, scene->kept, scene->boxes, &scene->rays, &scene->traced,
								  error));
	else
		GW_TRY(gw_ray_gather_trace(&on, gw_scene_ray_count(scene), (uint32_t)o->seed, &scene->rays,
								   error));
	gw_scene_report_rays(scene);
	return gw_ray_gather_look(&on, &scene->rays, error);
}

/* Light that goes from cell to cell needs them all, and no rays. */
static gw_status make_propagation(gw_scene *scene, gw_error *error)
{
	const gw_record_context on = gw_scene_context(scene, &scene->records);
	gw_volume_wish wish = gw_scene_wish_volume(scene);
	if (scene->options.volume_cells == 0)
		wish.cells = GW_LPV_CELLS;
	wish.order = 2;
	wish.rays = 0;
	wish.whole = true;
	GW_TRY(gw_radiance_volume_make(&on, &wish, &scene->volume, error));
	return gw_propagation_make(&on, &scene->volume, &scene->propagation, error);
}

/* Cells of a volume, what they see, and which of them light each record. */
static gw_status make_volume(gw_scene *scene, gw_error *error)
{
	const gw_record_context on = gw_scene_context(scene, &scene->records);
	const gw_volume_wish wish = gw_scene_wish_volume(scene);
	GW_TRY(gw_scene_part_facets(scene, error));
	GW_TRY(scene->options.method == GW_METHOD_LPV
			   ? make_propagation(scene, error)
			   : gw_radiance_volume_make(&on, &wish, &scene->volume, error));
	scene->report->volume_cells = scene->volume.count;
	return gw_volume_weigh_records(&on, &scene->volume, &scene->volume_rows, error);
}

/* Buffers of the records, and what these show. */
static gw_status draw_buffers(gw_scene *scene, gw_error *error)
{
	const gw_record_context on = gw_scene_context(scene, &scene->records);
	const gw_bake_options *o = &scene->options;
	GW_TRY(gw_micro_buffers_make(&on, o->rays, (uint32_t)o->seed, &scene->buffers, error));
	scene->report->buffer_pieces = scene->buffers.drawn;
	return GW_OK;
}

/* Work space of cones, a volume or buffers. */
static gw_status make_pools(gw_scene *scene, gw_error *error)
{
	const gw_bake_options *o = &scene->options;
	if (gw_method_has_cells(o->method))
		return make_volume(scene, error);
	if (o->method == GW_METHOD_BUFFERS)
		return draw_buffers(scene, error);
	if (o->method != GW_METHOD_CONES)
		return GW_OK;
	GW_TRY(gw_cone_gather_create(scene->gpu, &scene->octree, o->cones, (uint32_t)o->seed,
								 &scene->cones, error));
	scene->report->brick_bytes = scene->cones.leaf_pool.allocated + scene->cones.mip_pool.allocated;
	return GW_OK;
}

gw_status gw_scene_part_facets(gw_scene *scene, gw_error *error)
{
	return gw_compartments_find(scene->gpu, &scene->surfels, scene->options.threads, &scene->octree,
								error);
}

gw_status gw_scene_place_records(gw_scene *scene, gw_error *error)
{
	const gw_record_context on = gw_scene_context(scene, &scene->records);
	const gw_record_wish wish = gw_scene_wish_records(scene, &scene->options);
	GW_TRY(gw_scene_part_facets(scene, error));
	if (scene->region.asked) {
		GW_TRY(gw_region_place_records(scene, error));
		gw_scene_report_records(scene);
		gw_scene_report_rays(scene);
		return GW_OK;
	}
	GW_TRY(gw_records_place(&on, &wish, error));
	gw_scene_report_records(scene);
	GW_TRY(trace_records(scene, error));
	GW_TRY(make_pools(scene, error));
	GW_TRY(gw_records_weigh_facets(&on, NULL, error));
	GW_TRY(gw_read_back_make(&on, scene->surfels.count, &scene->read_back, error));
	return gw_scene_measure_turn(scene, error);
}

/* Which records light what, where they have come closer. */
static gw_status weigh_again(gw_scene *s, gw_error *error)
{
	const gw_record_density *density = &s->density;
	const gw_record_context on = gw_scene_context(s, &s->records);
	const gw_own_spacings facet = { density->facet_spacing, density->facet_closer,
									s->octree.facet_count };
	const gw_own_spacings surfel = { density->surfel_spacing, density->surfel_closer,
									 s->surfels.count };
	gw_buffer facets = { 0 }, surfels = { 0 };
	gw_status status =
		gw_records_reach(s->gpu, &s->records, GW_FACET_REACH, &facet, &facets, error);
	if (status == GW_OK)
		status = gw_records_reach(s->gpu, &s->records, GW_SURFEL_REACH, &surfel, &surfels, error);
	if (status == GW_OK)
		status = gw_records_weigh_facets(&on, &facets, error);
	if (status == GW_OK)
		status = gw_read_back_again(&on, &surfels, density->surfel_closer, &s->read_back, error);
	gw_buffer_destroy(s->gpu, &facets);
	gw_buffer_destroy(s->gpu, &surfels);
	return status;
}

gw_status gw_scene_add_records(gw_scene *scene, gw_error *error)
{
	const gw_record_context on = gw_scene_context(scene, &scene->records);
	const gw_record_context further = gw_scene_context(scene, &scene->further);
	uint32_t before = scene->records.count;
	gw_scene_forget_further(scene);
	GW_TRY(gw_records_add(&on, scene->options.seed, scene->density.facet_spacing, error));
	gw_scene_report_records(scene);
	if (scene->records.count > before)
		GW_TRY(gw_scene_list_further(scene, before, error));
	if (scene->further.count > 0)
		GW_TRY(gw_ray_gather_add(&further, &scene->rays, &scene->further_rays, error));
	gw_scene_report_rays(scene);
	GW_TRY(gw_ray_gather_look(&on, &scene->rays, error));
	GW_TRY(weigh_again(scene, error));
	return scene->region.asked ? GW_OK : gw_scene_measure_turn(scene, error);
}

gw_status gw_scene_complete(gw_scene *scene, const gw_points *points, gw_error *error)
{
	gw_report_surfels(scene->report, &scene->surfels, points);
	gw_scene_report_octree(scene);
	gw_scene_report_records(scene);
	GW_TRY(gw_scene_find_space(scene, points, error));
	GW_TRY(gw_records_make_room(scene->gpu, &scene->records, error));
	GW_TRY(gw_scene_measure_turn(scene, error));
	return make_pools(scene, error);
}

gw_status gw_scene_keep_hits(gw_scene *scene, gw_kept_hits *kept, gw_error *error)
{
	const gw_record_context on = gw_scene_context(scene, &scene->records);
	const gw_bake_options *o = &scene->options;
	const gw_record_wish wish = gw_scene_wish_records(scene, o);
	gw_status status = gw_scene_part_facets(scene, error);
	if (status == GW_OK)
		status = gw_records_place(&on, &wish, error);
	if (status == GW_OK) { /* each frame gets what stands still got, so that its light keeps */
		scene->options.record_spacing = scene->records.spacing;
		scene->options.least_records = 0;
		status = gw_ray_gather_trace(&on, gw_scene_ray_count(scene), (uint32_t)o->seed,
									 &scene->rays, error);
	}
	if (status == GW_OK)
		status = gw_kept_hits_take(scene->gpu, &scene->octree, &scene->records, &scene->rays, kept,
								   error);
	gw_scene_drop_records(scene);
	return status;
}

/*
 * scene_records.c - see scene_records.h.
 */
#include "bake/scene_records.h"

#include "base/memory.h"
#include "bake/options_check.h"
#include "bake/plan.h"
#include "light/rows_apart.h"
#include "octree/compartments.h"

#include <math.h>
#include <stdlib.h>

/* Rays a record that only look for the nearest surface, when cones gather. */
#define NEAREST_RAYS 16u

uint32_t gw_scene_ray_count(const gw_scene *scene)
{
	return gw_method_keeps_hits(scene->options.method) ? scene->options.rays : NEAREST_RAYS;
}

void gw_scene_report_rays(gw_scene *scene)
{
	gw_report *r = scene->report;
	r->rays = (uint64_t)scene->rays.rays * scene->records.count;
	r->rays_traced = scene->kept ? scene->traced : r->rays;
}

void gw_scene_report_records(gw_scene *scene)
{
	scene->report->records = scene->records.count;
	scene->report->record_spacing =
		scene->region.asked ? scene->region.spacing : scene->records.spacing;
}

gw_volume_wish gw_scene_wish_volume(const gw_scene *scene)
{
	const gw_bake_options *o = &scene->options;
	return (gw_volume_wish){ .surfels = &scene->surfels,
							 .cells = o->volume_cells > 0 ? o->volume_cells : GW_VOLUME_CELLS,
							 .order = o->volume_harmonics == 9 ? 3 : 2,
							 .rays = o->rays,
							 .seed = (uint32_t)o->seed,
							 .whole = o->volume };
}

gw_record_wish gw_scene_wish_records(const gw_scene *scene, const gw_bake_options *o)
{
	bool few = scene->adds_records && gw_options_few_records(o);
	return (gw_record_wish){ .spacing = o->record_spacing,
							 .least = gw_records_least(&scene->surfels, o->least_records),
							 .most = few ? o->most_records : 0,
							 .seed = o->seed };
}

/* Normals that are turned by less on the average, radians, read the same light. */
#define TURN_LEAST 0.02

/* Of normals that are off by this share of how far they are turned, what they read is noise. */
#define OFF_MOST 0.5

/* By how much normals are off: the root of the mean square, radians; of noisy points how far their
 * own normals are turned from the surface's counts as well. */
static double normals_off(const gw_scene *scene)
{
	const gw_surfels *s = &scene->surfels;
	const bool *asked = scene->region.asked;
	double sum = 0.0;
	for (size_t i = 0; i < s->count && s->shading_normal_off; i++)
		if (!asked || asked[i])
			sum += (double)s->shading_normal_off[i] * (double)s->shading_normal_off[i];
	for (size_t i = 0; i < s->count && s->shading_normal; i++) {
		const float *a = s->normal + 3 * i, *b = s->shading_normal + 3 * i;
		double cosine = (double)(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
		if (!asked || asked[i])
			sum += fmax(0.0, 1.0 - cosine * cosine);
	}
	return sqrt(sum / (double)(asked ? scene->region.count : s->count));
}

/* By how far normals are turned from theirs, unless that is noise. */
gw_status gw_scene_measure_turn(gw_scene *scene, gw_error *error)
{
	const gw_surfels *s = &scene->surfels;
	gw_view normal;
	scene->turn = 0.0;
	if (!gw_method_keeps_hits(scene->options.method) || scene->options.basis != GW_BASIS_AUTO)
		return GW_OK;
	GW_TRY(gw_view_open(scene->gpu, &scene->records.normal, 16 * (uint64_t)scene->records.count,
						&normal, error));
	scene->turn =
		gw_read_back_turn(&scene->read_back, normal.bytes, s->normal, scene->options.threads);
	gw_view_close(&normal);
	if (scene->region.asked) /* the rows of others are empty by then */
		scene->turn *= sqrt((double)s->count / (double)scene->region.count);
	if (normals_off(scene) > OFF_MOST * scene->turn)
		scene->turn = 0.0;
	return GW_OK;
}

gw_status gw_scene_list_further(gw_scene *scene, uint32_t first, gw_error *error)
{
	gw_records *all = &scene->records;
	size_t count = all->count - first;
	float *rows = gw_allocate_array(count, 8 * sizeof *rows);
	if (!rows)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu records", count);
	gw_status status = gw_buffer_download(scene->gpu, &all->position, 16 * (uint64_t)first, rows,
										  16 * count, error);
	if (status == GW_OK)
		status = gw_buffer_download(scene->gpu, &all->normal, 16 * (uint64_t)first,
									rows + 4 * count, 16 * count, error);
	if (status == GW_OK)
		status = gw_records_put(scene->gpu, rows, rows + 4 * count, (uint32_t)count,
								&scene->further, error);
	free(rows);
	return status;
}

bool gw_scene_keeps_moments(const gw_scene *scene)
{
	const gw_bake_options *o = &scene->options;
	bool closed = o->gaps != GW_GAPS_OPEN && gw_scanned_space_known(&scene->space);
	if (!gw_method_keeps_hits(o->method) || closed || o->basis == GW_BASIS_SCALAR)
		return false;
	return o->basis == GW_BASIS_DIRECTIONAL || scene->turn >= TURN_LEAST;
}

gw_status gw_scene_find_compartments(gw_scene *s, gw_error *error)
{
	const gw_record_context on = gw_scene_context(s, &s->records);
	const gw_record_context further = gw_scene_context(s, &s->further);
	GW_TRY(gw_compartments_find(s->gpu, &s->surfels, s->options.threads, &s->octree, error));
	GW_TRY(gw_rows_part(&on, &s->read_back, error));
	if (s->buffers.hits.facet.handle != VK_NULL_HANDLE)
		return gw_micro_buffers_shut_out(&on, &s->buffers, error);
	if (!gw_method_keeps_hits(s->options.method) || s->rays.facet.handle == VK_NULL_HANDLE)
		return GW_OK;
	GW_TRY(gw_ray_gather_shut_out(&on, &s->rays, error));
	return s->further.count > 0 ? gw_ray_gather_shut_out(&further, &s->further_rays, error) : GW_OK;
}

gw_status gw_scene_open_to_sky(gw_scene *s, gw_error *error)
{
	const gw_record_context on = gw_scene_context(s, &s->records);
	const gw_record_context further = gw_scene_context(s, &s->further);
	if (!s->portals.looked && !gw_options_forbid(&s->options, GW_EFFECT_PORTALS))
		GW_TRY(gw_portals_find(&s->passes, &s->octree, &s->records, &s->rays, &s->portals, error));
	if (s->further.count > 0)
		GW_TRY(
			gw_ray_gather_open_further(&further, &s->portals, &s->rays, &s->further_rays, error));
	return gw_ray_gather_open(&on, &s->portals, &s->rays, error);
}

/*
 * volume_light.c - see volume_light.h.
 */
#include "bake/volume_light.h"
#include "bake/sampled_light.h"
#include "bake/scene_records.h"

#include "base/memory.h"
#include "light/bounces.h"
#include "octree/compartments.h"

#include <math.h>
#include <stdlib.h>

static float largest_of(const float *values, size_t count)
{
	float largest = 0.0f;
	for (size_t i = 0; values && i < count; i++)
		largest = fmaxf(largest, values[i]);
	return largest;
}

/* Fills the volume, and reads it back at the records. */
static gw_status gather(gw_scene *s, const gw_volume_light *light, float largest, gw_error *error)
{
	const gw_record_context on = gw_scene_context(s, &s->records);
	GW_TRY(s->options.method == GW_METHOD_LPV
			   ? gw_propagation_fill(&s->passes, &s->volume, &s->propagation, light, error)
			   : gw_radiance_volume_fill(&s->passes, &s->volume, light, error));
	return gw_volume_read_records(&on, &s->volume, &s->volume_rows, largest, &s->records.gathered,
								  error);
}

gw_status gw_volume_light_first(gw_lighting *lighting, gw_error *error)
{
	const float black[3] = { 0 };
	gw_scene *s = lighting->scene;
	const float *sky = lighting->plan.sky ? lighting->plan.sky_radiance : black;
	bool large;
	GW_TRY(gw_radiance_volume_clear_sum(&s->passes, &s->volume, error));
	GW_TRY(gw_lighting_sample_small(lighting, &large, error));
	float emission = large ? largest_of(s->surfels.emission, 3 * s->surfels.count) : 0.0f;
	float brightest = fmaxf(emission, largest_of(sky, 3));
	if (!(brightest > 0.0f))
		return GW_OK;
	/* The facets' radiance is dark yet. */
	const gw_volume_light light = { large ? &s->octree.facet_emission : &lighting->facet_radiance,
									sky, NULL };
	GW_TRY(gather(s, &light, brightest, error));
	return gw_light_add(&s->passes, &s->records.gathered, &s->records.first, s->records.count,
						error);
}

gw_status gw_volume_light_gather_apart(void *self, const gw_buffer *facet_radiance, float largest,
									   gw_error *error)
{
	const float black[3] = { 0 };
	return gather(((gw_lighting *)self)->scene, &(gw_volume_light){ facet_radiance, black, NULL },
				  largest, error);
}

gw_status gw_volume_light_gather(void *self, const gw_buffer *facet_radiance, float largest,
								 gw_error *error)
{
	gw_scene *s = ((gw_lighting *)self)->scene;
	GW_TRY(gw_volume_light_gather_apart(self, facet_radiance, largest, error));
	return gw_radiance_volume_add(&s->passes, &s->volume, error);
}

gw_status gw_volume_light_read_back(gw_lighting *lighting, gw_error *error)
{
	gw_scene *s = lighting->scene;
	const gw_record_context on = gw_scene_context(s, &s->records);
	return gw_volume_read_surfels(&on, &s->volume, s->surfels.count, lighting->surfel_indirect,
								  error);
}

/* ------------------------------------------------------------------------- radiance in free space
 */

/* What the facets send out in the end; buffers: of records, and the result. */
static gw_status shade_all(gw_lighting *lighting, gw_buffer *total, gw_buffer *radiance,
						   gw_error *error)
{
	gw_scene *s = lighting->scene;
	const gw_record_context on = gw_scene_context(s, &s->records);
	const VkFormat f4 = VK_FORMAT_R32G32B32A32_SFLOAT;
	uint64_t records = s->records.count, facets = (uint64_t)s->octree.facet_count;
	GW_TRY(gw_buffer_create(
		s->gpu, &(gw_buffer_description){ GW_BUFFER_TEXEL, f4, 16 * records, "record irradiance" },
		total, error));
	GW_TRY(gw_buffer_create(
		s->gpu,
		&(gw_buffer_description){ GW_BUFFER_TEXEL, f4, 16 * facets, "final facet radiance" },
		radiance, error));
	GW_TRY(gw_light_add(&s->passes, &s->records.first, total, records, error));
	GW_TRY(gw_light_add(&s->passes, &s->records.indirect, total, records, error));
	GW_TRY(gw_facets_shade(&on, total, &lighting->facet_direct, 1.0f, radiance, error));
	if (!lighting->plan.emitters)
		return GW_OK;
	return gw_light_add(&s->passes, &s->octree.facet_emission, radiance, facets, error);
}

/* The cells and their harmonics, from the device. */
static gw_status download(const gw_scene *s, const gw_radiance_volume *from, gw_volume *to,
						  gw_error *error)
{
	uint32_t terms = gw_radiance_volume_terms(from);
	size_t values = (size_t)terms * from->count;
	double leaf = (double)s->octree.leaf_size;
	float *radiance = gw_allocate_array(values, 4 * sizeof *radiance);
	to->cell = gw_allocate_array(from->count, 3 * sizeof *to->cell);
	to->radiance = gw_allocate_array(values, 3 * sizeof *to->radiance);
	gw_status status = GW_OK;
	if (!radiance || !to->cell || !to->radiance)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory for %u cells of a volume", from->count);
	if (status == GW_OK)
		status =
			gw_buffer_download(s->gpu, &from->radiance, 0, radiance, 16 * (uint64_t)values, error);
	for (size_t i = 0; i < values && status == GW_OK; i++)
		for (size_t c = 0; c < 3; c++)
			to->radiance[3 * i + c] = radiance[4 * i + c];
	free(radiance);
	GW_TRY(status);
	to->count = from->count;
	to->harmonics = terms;
	to->size = leaf * (double)from->size;
	for (size_t k = 0; k < 3; k++)
		to->origin[k] = s->surfels.origin[k] + (double)s->octree.cube_minimum[k] +
						leaf * (double)from->minimum[k];
	for (size_t i = 0; i < from->count; i++) {
		uint32_t cell = from->cell[i];
		to->cell[3 * i] = (int32_t)(cell % from->cells[0]);
		to->cell[3 * i + 1] = (int32_t)(cell / from->cells[0] % from->cells[1]);
		to->cell[3 * i + 2] = (int32_t)(cell / from->cells[0] / from->cells[1]);
	}
	return GW_OK;
}

/* The scene's own volume, or one for this alone, in *own. */
static gw_status find_volume(gw_scene *s, gw_radiance_volume *own, gw_radiance_volume **volume,
							 gw_error *error)
{
	const gw_record_context on = gw_scene_context(s, &s->records);
	const gw_volume_wish wish = gw_scene_wish_volume(s);
	*volume = s->options.method == GW_METHOD_VOLUME ? &s->volume : own;
	if (*volume != own)
		return GW_OK;
	GW_TRY(gw_compartments_find(s->gpu, &s->surfels, s->options.threads, &s->octree, error));
	GW_TRY(gw_radiance_volume_make(&on, &wish, own, error));
	s->report->volume_cells = own->count;
	return GW_OK;
}

static gw_status collect(gw_lighting *lighting, const gw_buffer *radiance, gw_radiance_volume *own,
						 gw_volume *result, gw_error *error)
{
	gw_scene *s = lighting->scene;
	const gw_volume_light light = { radiance, lighting->plan.sky_radiance, &lighting->map };
	gw_radiance_volume *volume;
	GW_TRY(find_volume(s, own, &volume, error));
	GW_TRY(gw_radiance_volume_fill(&s->passes, volume, &light, error));
	return download(s, volume, result, error);
}

gw_status gw_volume_light_collect(gw_lighting *lighting, gw_bake_result *result, gw_error *error)
{
	gw_gpu *gpu = lighting->scene->gpu;
	gw_buffer total = { 0 }, radiance = { 0 };
	gw_radiance_volume own = { 0 };
	gw_status status = shade_all(lighting, &total, &radiance, error);
	if (status == GW_OK)
		status = collect(lighting, &radiance, &own, &result->volume, error);
	gw_radiance_volume_destroy(gpu, &own);
	gw_buffer_destroy(gpu, &radiance);
	gw_buffer_destroy(gpu, &total);
	return status;
}

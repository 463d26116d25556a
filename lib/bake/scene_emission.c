/*
 * scene_emission.c - other emission for the points of a scene, see scene.h.
 */
#include "bake/scene.h"

#include "base/memory.h"
#include "light/direct_light.h"
#include "surfels/surfel_backs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What takes the place of the old emission once all of it is there. */
typedef struct replacement {
	float *surfels; /* 3 each, or NULL: none of them emits */
	uint64_t repaired;
	gw_buffer facets;
} replacement;

/* What faces either way emits to both sides. */
static gw_status repeat_on_backs(const gw_surfels *s, float *emission, gw_error *error)
{
	uint32_t *back;
	GW_TRY(gw_surfel_backs_find(s, &back, error));
	for (size_t i = 0; back && i < s->count; i++)
		if (back[i] != UINT32_MAX)
			memcpy(emission + 3 * (size_t)back[i], emission + 3 * i, 3 * sizeof *emission);
	free(back);
	return GW_OK;
}

/* The mean emission of each surfel's points. */
static gw_status merge(const gw_surfels *s, const float *emission, size_t points, replacement *to,
					   gw_error *error)
{
	bool emits = false;
	double *sum = gw_allocate_zeros(s->count, 4 * sizeof *sum);
	to->surfels = gw_allocate_array(s->count, 3 * sizeof *to->surfels);
	if (!sum || !to->surfels) {
		free(sum);
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the emission of %zu surfels",
					   s->count);
	}
	for (size_t i = 0; i < points; i++) {
		uint32_t surfel = s->surfel_of_point[i];
		bool repaired = false;
		if (surfel == UINT32_MAX)
			continue;
		for (size_t k = 0; k < 3; k++) {
			double e = (double)emission[3 * i + k];
			bool good = isfinite(e) && e >= 0.0;
			sum[4 * (size_t)surfel + k] += good ? e : 0.0;
			repaired |= !good;
		}
		sum[4 * (size_t)surfel + 3] += 1.0;
		to->repaired += repaired;
	}
	for (size_t i = 0; i < 3 * s->count; i++) {
		to->surfels[i] = (float)(sum[i / 3 * 4 + i % 3] / fmax(sum[i / 3 * 4 + 3], 1.0));
		emits |= to->surfels[i] > 0.0f;
	}
	free(sum);
	if (!emits) {
		free(to->surfels);
		to->surfels = NULL;
		return GW_OK;
	}
	return repeat_on_backs(s, to->surfels, error);
}

static gw_status make_texels(const gw_scene *scene, uint64_t count, const char *name,
							 gw_buffer *buffer, gw_error *error)
{
	return gw_buffer_create(scene->gpu,
							&(gw_buffer_description){
								GW_BUFFER_TEXEL, VK_FORMAT_R32G32B32A32_SFLOAT, 16 * count, name },
							buffer, error);
}

static gw_status upload(const gw_scene *scene, const float *surfels, gw_buffer *buffer,
						gw_error *error)
{
	size_t count = scene->surfels.count;
	float *rows = gw_allocate_zeros(count, 4 * sizeof *rows);
	if (!rows)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the emission of %zu surfels", count);
	for (size_t i = 0; i < count; i++)
		memcpy(rows + 4 * i, surfels + 3 * i, 3 * sizeof *rows);
	gw_status status = gw_buffer_upload(scene->gpu, buffer, 0, rows, 16 * (uint64_t)count, error);
	free(rows);
	return status;
}

/* The mean emission of each facet's surfels. */
static gw_status average(gw_scene *scene, gw_buffer *emission, replacement *to, gw_error *error)
{
	GW_TRY(make_texels(scene, scene->surfels.count, "emission of surfels", emission, error));
	GW_TRY(upload(scene, to->surfels, emission, error));
	GW_TRY(make_texels(scene, scene->octree.facet_count, "emission of facets", &to->facets, error));
	return gw_average_facets(&scene->passes, &scene->octree, emission, &to->facets, error);
}

static gw_status make(gw_scene *scene, const float *emission, size_t points, replacement *to,
					  gw_error *error)
{
	gw_buffer rows = { 0 };
	if (emission)
		GW_TRY(merge(&scene->surfels, emission, points, to, error));
	if (!to->surfels || scene->surfels.emission_alone)
		return make_texels(scene, 1, "emission of facets", &to->facets, error);
	gw_status status = average(scene, &rows, to, error);
	gw_buffer_destroy(scene->gpu, &rows);
	return status;
}

/* Of points that are no surface. */
static void replace_of_strays(gw_surfels *s, const float *emission)
{
	for (size_t i = 0; i < 3 * s->stray_count; i++) {
		float e = emission ? emission[3 * (size_t)s->stray[i / 3].point + i % 3] : 0.0f;
		s->stray[i / 3].emission[i % 3] = isfinite(e) && e > 0.0f ? e : 0.0f;
	}
}

gw_status gw_scene_replace_emission(gw_scene *scene, const float *emission, size_t points,
									gw_error *error)
{
	replacement to = { .surfels = NULL };
	gw_status status = make(scene, emission, points, &to, error);
	if (status != GW_OK) {
		gw_buffer_destroy(scene->gpu, &to.facets);
		free(to.surfels);
		return status;
	}
	gw_scene_forget_samples(scene);
	gw_free_unless_lent(scene->surfels.emission, scene->surfels.lent, scene->surfels.lent_bytes);
	scene->surfels.emission = to.surfels;
	scene->surfels.emission_repaired = to.repaired;
	replace_of_strays(&scene->surfels, emission);
	gw_buffer_destroy(scene->gpu, &scene->octree.facet_emission);
	scene->octree.facet_emission = to.facets;
	return GW_OK;
}

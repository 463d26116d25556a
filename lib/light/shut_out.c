/*
 * shut_out.c - see shut_out.h.
 */
#include "light/shut_out.h"

#include "base/memory.h"
#include "light/transport_layout.h"
#include "octree/compartments.h"

#include <stdlib.h>
#include <string.h>

/* Is a light on the side that the normal turns its back to? */
static bool shines_on_back(const gw_light_push *light, const float *place, const float *normal)
{
	const float sun[3] = { -light->direction.x, -light->direction.y, -light->direction.z };
	const float lamp[3] = { light->position.x - place[0], light->position.y - place[1],
							light->position.z - place[2] };
	const float *to = light->type == GW_PUSH_SUN ? sun : lamp;
	return to[0] * normal[0] + to[1] * normal[1] + to[2] * normal[2] < 0.0f;
}

static uint32_t compartment_of(const gw_octree *octree, const gw_light_push *light)
{
	const float place[3] = { light->position.x, light->position.y, light->position.z };
	return light->type == GW_PUSH_SUN ? gw_compartment_outside(octree)
									  : gw_compartment_at(octree, place);
}

bool gw_shut_out_is_outside(const gw_octree *octree, const gw_light_push *light)
{
	return compartment_of(octree, light) == gw_compartment_outside(octree);
}

/* Leaves out normals of surfels that look into another compartment than the light's. Those that the
 * light does not shine on anyway may keep theirs. */
static size_t leave_out(const gw_lit_cloud *cloud, const gw_light_push *light, const float *place,
						float *normal)
{
	uint32_t from = compartment_of(cloud->octree, light);
	size_t left_out = 0;
	for (size_t i = 0; i < cloud->surfels->count && from != GW_COMPARTMENT_UNKNOWN; i++) {
		bool back = shines_on_back(light, place + 4 * i, normal + 4 * i);
		uint32_t to = gw_compartment_of_surfel(cloud->octree, i, back);
		if (to == GW_COMPARTMENT_UNKNOWN || to == from)
			continue;
		memset(normal + 4 * i, 0, 3 * sizeof *normal);
		left_out++;
	}
	return left_out;
}

static gw_status leave_out_normals(const gw_lit_cloud *cloud, const gw_light_push *light,
								   float *normal, gw_buffer *shut, gw_error *error)
{
	gw_gpu *gpu = cloud->passes->gpu;
	uint64_t bytes = 16 * (uint64_t)cloud->surfels->count;
	gw_view place = { 0 };
	GW_TRY(gw_view_open(gpu, &cloud->octree->surfel_position, bytes, &place, error));
	size_t left_out = leave_out(cloud, light, place.bytes, normal);
	gw_view_close(&place);
	if (left_out == 0)
		return GW_OK;
	GW_TRY(
		gw_buffer_create(gpu,
						 &(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_R32G32B32A32_SFLOAT,
												   bytes, "normals that a light reaches" },
						 shut, error));
	gw_status status = gw_buffer_upload(gpu, shut, 0, normal, bytes, error);
	if (status != GW_OK)
		gw_buffer_destroy(gpu, shut);
	return status;
}

gw_status gw_shut_out_light(const gw_lit_cloud *cloud, const gw_light_push *light,
							const gw_buffer *normal, gw_buffer *shut, gw_error *error)
{
	if (!gw_compartments_several(cloud->octree))
		return GW_OK;
	float *own = gw_allocate_array(cloud->surfels->count, 4 * sizeof *own);
	if (own == NULL)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the normals of %zu surfels",
					   cloud->surfels->count);
	gw_status status = gw_buffer_download(cloud->passes->gpu, normal, 0, own,
										  16 * (uint64_t)cloud->surfels->count, error);
	if (status == GW_OK)
		status = leave_out_normals(cloud, light, own, shut, error);
	free(own);
	return status;
}

/* By the places where they stand. */
static gw_status label_places(const gw_record_context *on, uint32_t *label, gw_error *error)
{
	gw_gpu *gpu = on->passes->gpu;
	uint64_t bytes = 16 * (uint64_t)on->records->count;
	gw_view place = { 0 }, normal = { 0 };
	gw_status status = gw_view_open(gpu, &on->records->position, bytes, &place, error);
	if (status == GW_OK)
		status = gw_view_open(gpu, &on->records->normal, bytes, &normal, error);
	const gw_surface_places places = { on->records->count, place.bytes, normal.bytes };
	if (status == GW_OK)
		status = gw_compartments_of_places(on->passes, on->octree, &places, label, error);
	gw_view_close(&normal);
	gw_view_close(&place);
	return status;
}

/* A record on the front of a facet looks into what that looks into: where surface of several
 * compartments lies in one cell, places do not tell. */
static void label_fronts(const gw_record_context *on, uint32_t *label)
{
	const uint32_t *of = gw_compartments_of_facets(on->octree), *facet = on->records->facet;
	for (size_t i = 0; i < on->records->count && of && facet; i++)
		if ((facet[i] & GW_RECORD_BACK) == 0 && of[facet[i]] != GW_COMPARTMENT_UNKNOWN)
			label[i] = of[facet[i]];
}

gw_status gw_shut_out_label(const gw_record_context *on, uint32_t **label, gw_error *error)
{
	*label = gw_allocate_array(on->records->count, sizeof **label);
	if (*label == NULL)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %u records", on->records->count);
	gw_status status = label_places(on, *label, error);
	if (status == GW_OK) {
		label_fronts(on, *label);
		return GW_OK;
	}
	free(*label);
	*label = NULL;
	return status;
}

gw_status gw_shut_out_mark(const gw_record_context *on, gw_buffer *marks, gw_error *error)
{
	uint32_t count = on->records->count, *label = NULL;
	if (!gw_compartments_several(on->octree))
		return GW_OK;
	GW_TRY(gw_shut_out_label(on, &label, error));
	float *mark = gw_allocate_zeros(count, 4 * sizeof *mark);
	gw_status status =
		mark ? GW_OK : gw_fail(error, GW_ERROR_MEMORY, "no memory for marks of %u records", count);
	for (size_t i = 0; i < count && mark; i++)
		mark[4 * i + 3] = (float)gw_compartment_mark(label[i]);
	if (status == GW_OK)
		status = gw_buffer_upload(on->passes->gpu, marks, 0, mark, 16 * (uint64_t)count, error);
	free(mark);
	free(label);
	return status;
}

/* What the steps of gw_shut_out_hits find. */
typedef struct hit_labels {
	uint32_t *hit; /* what each ray hit */
	const uint32_t *facet;
	uint32_t outside, empty; /* empty: the facet that is */
} hit_labels;

/* Has a ray from a compartment slipped through rock? */
static bool slipped(const hit_labels *l, uint32_t from, uint32_t hit)
{
	return gw_compartments_apart(from, hit == GW_NONE ? l->outside : l->facet[hit]);
}

/* Puts right what a record's rays hit: one that slipped through takes what the one before it hit,
 * which is right already, and those before the first right one what that hit. Returns how many
 * slipped through. */
static uint32_t turn_record(const hit_labels *l, uint32_t from, uint32_t *hit, uint32_t rays)
{
	uint32_t turned = 0, right = 0;
	while (right < rays && slipped(l, from, hit[right]))
		right++;
	for (uint32_t k = 0; k < rays; k++) {
		if (!slipped(l, from, hit[k]))
			continue;
		if (right < rays)
			hit[k] = hit[k < right ? right : k - 1];
		else if (hit[k] != GW_NONE)
			hit[k] = l->empty;
		turned++;
	}
	return turned;
}

static gw_status turn_hits(const gw_record_context *on, const gw_labelled_rays *from,
						   gw_buffer *facet, hit_labels *l, gw_error *error)
{
	gw_gpu *gpu = on->passes->gpu;
	size_t count = from->count, turned = 0;
	uint32_t rays = from->rays;
	l->outside = gw_compartment_outside(on->octree);
	l->empty = GW_FACET_EMPTY;
	l->facet = from->facet ? from->facet : gw_compartments_of_facets(on->octree);
	l->hit = gw_allocate_array(count, rays * sizeof *l->hit);
	if (!l->hit)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for what rays of %zu places hit", count);
	GW_TRY(gw_buffer_download(gpu, facet, 0, l->hit, 4 * rays * (uint64_t)count, error));
	for (size_t i = 0; i < count; i++)
		turned += turn_record(l, from->label[i], l->hit + rays * i, rays);
	return turned > 0 ? gw_buffer_upload(gpu, facet, 0, l->hit, 4 * rays * (uint64_t)count, error)
					  : GW_OK;
}

gw_status gw_shut_out_hits_of(const gw_record_context *on, const gw_labelled_rays *from,
							  gw_buffer *facet, gw_error *error)
{
	hit_labels l = { 0 };
	if (!gw_compartments_several(on->octree))
		return GW_OK;
	gw_status status = turn_hits(on, from, facet, &l, error);
	free(l.hit);
	return status;
}

gw_status gw_shut_out_hits(const gw_record_context *on, uint32_t rays, gw_buffer *facet,
						   gw_error *error)
{
	uint32_t *label;
	if (!gw_compartments_several(on->octree))
		return GW_OK;
	GW_TRY(gw_shut_out_label(on, &label, error));
	const gw_labelled_rays from = { .label = label, .count = on->records->count, .rays = rays };
	gw_status status = gw_shut_out_hits_of(on, &from, facet, error);
	free(label);
	return status;
}

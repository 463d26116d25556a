/*
 * cones_apart.c - see cones_apart.h.
 */
#include "light/cones_apart.h"

#include "base/memory.h"
#include "light/shut_out.h"
#include "octree/compartments.h"

#include <stdlib.h>
#include <string.h>

/* A bounce that goes from compartment to compartment. */
typedef struct apart {
	const gw_record_context *on;
	float largest;                /* of the radiance of all facets */
	const uint32_t *record;       /* their compartments */
	const uint32_t *facet;        /* and those of facets */
	float *normal, *radiance;     /* 4 a record and 4 a facet: all of them */
	float *own;                   /* room for those of one compartment */
	gw_buffer normals, radiances; /* of one compartment */
	uint64_t record_bytes, facet_bytes;
} apart;

static gw_status make_room(apart *a, gw_error *error)
{
	gw_gpu *gpu = a->on->passes->gpu;
	uint64_t most = a->record_bytes > a->facet_bytes ? a->record_bytes : a->facet_bytes;
	a->normal = gw_allocate_array(a->record_bytes, 1);
	a->radiance = gw_allocate_array(a->facet_bytes, 1);
	a->own = gw_allocate_array(most, 1);
	if (!a->normal || !a->radiance || !a->own)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the light of %u records",
					   a->on->records->count);
	const gw_buffer_description normals = { GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED, a->record_bytes,
											"normals of a compartment" };
	const gw_buffer_description radiances = { GW_BUFFER_TEXEL, VK_FORMAT_R32G32B32A32_SFLOAT,
											  a->facet_bytes, "radiance of a compartment" };
	GW_TRY(gw_buffer_create(gpu, &normals, &a->normals, error));
	return gw_buffer_create(gpu, &radiances, &a->radiances, error);
}

/* Once for all bounces: records that are added are more. */
static gw_status label_records(const gw_record_context *on, gw_cone_gather *gather, gw_error *error)
{
	if (gather->record_label != NULL && gather->labelled == on->records->count)
		return GW_OK;
	free(gather->record_label);
	gather->record_label = NULL;
	gather->labelled = on->records->count;
	return gw_shut_out_label(on, &gather->record_label, error);
}

static gw_status fetch(apart *a, gw_cone_gather *gather, const gw_buffer *radiance, gw_error *error)
{
	gw_gpu *gpu = a->on->passes->gpu;
	GW_TRY(make_room(a, error));
	GW_TRY(label_records(a->on, gather, error));
	a->record = gather->record_label;
	a->facet = gw_compartments_of_facets(a->on->octree);
	GW_TRY(gw_buffer_download(gpu, &a->on->records->normal, 0, a->normal, a->record_bytes, error));
	return gw_buffer_download(gpu, radiance, 0, a->radiance, a->facet_bytes, error);
}

/* The records' normals, with all records marked to be left out but those of a compartment. Returns
 * how many those are. */
static uint32_t choose_records(const apart *a, uint32_t label)
{
	uint32_t chosen = 0;
	memcpy(a->own, a->normal, a->record_bytes);
	for (size_t i = 0; i < a->on->records->count; i++) {
		if (a->record[i] == label)
			chosen++;
		else
			a->own[4 * i + 3] = GW_RECORD_LEFT;
	}
	return chosen;
}

/* The facets' radiance, black for those in other compartments. */
static void choose_facets(const apart *a, uint32_t label)
{
	for (size_t i = 0; i < a->facet_bytes / 16; i++) {
		if (gw_compartments_apart(a->facet[i], label))
			memset(a->own + 4 * i, 0, 4 * sizeof *a->own);
		else
			memcpy(a->own + 4 * i, a->radiance + 4 * i, 4 * sizeof *a->own);
	}
}

static gw_status gather_one(apart *a, uint32_t label, gw_cone_gather *gather, const float sky[3],
							gw_buffer *gathered, gw_error *error)
{
	gw_gpu *gpu = a->on->passes->gpu;
	const float black[3] = { 0 };
	gw_records records = *a->on->records;
	const gw_record_context on = { a->on->passes, a->on->octree, &records };
	bool shut = gw_compartments_apart(label, gw_compartment_outside(on.octree));
	if (choose_records(a, label) == 0)
		return GW_OK;
	GW_TRY(gw_buffer_upload(gpu, &a->normals, 0, a->own, a->record_bytes, error));
	choose_facets(a, label);
	GW_TRY(gw_buffer_upload(gpu, &a->radiances, 0, a->own, a->facet_bytes, error));
	records.normal = a->normals;
	const gw_facet_radiance radiance = { &a->radiances, a->largest };
	return gw_cone_gather_bounce(&on, gather, radiance, shut ? black : sky, gathered, error);
}

gw_status gw_cones_apart_bounce(const gw_record_context *on, gw_cone_gather *gather,
								gw_facet_radiance radiance, const float sky[3], gw_buffer *gathered,
								gw_error *error)
{
	apart a = { .on = on,
				.largest = radiance.largest,
				.record_bytes = 16 * (uint64_t)on->records->count,
				.facet_bytes = 32 * (uint64_t)on->octree->leaf_count };
	if (!gw_compartments_several(on->octree))
		return gw_cone_gather_bounce(on, gather, radiance, sky, gathered, error);
	gw_status status = fetch(&a, gather, radiance.facets, error);
	uint32_t count = gw_compartments_count(on->octree);
	for (uint32_t i = 0; i <= count && status == GW_OK; i++)
		status =
			gather_one(&a, i < count ? i : GW_COMPARTMENT_UNKNOWN, gather, sky, gathered, error);
	gw_buffer_destroy(on->passes->gpu, &a.normals);
	gw_buffer_destroy(on->passes->gpu, &a.radiances);
	free(a.normal);
	free(a.radiance);
	free(a.own);
	return status;
}

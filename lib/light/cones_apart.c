/*
 * cones_apart.c - see cones_apart.h.
 */
#include "light/cones_apart.h"

#include "base/memory.h"
#include "light/shut_out.h"
#include "octree/compartments.h"

#include <stdlib.h>

static gw_status upload_marks(gw_gpu *gpu, const uint32_t *mark, size_t count, const char *name,
							  gw_buffer *marks, gw_error *error)
{
	const gw_buffer_description description = { GW_BUFFER_TEXEL, VK_FORMAT_R32_UINT,
												sizeof *mark * (uint64_t)count, name };
	GW_TRY(gw_buffer_create(gpu, &description, marks, error));
	return gw_buffer_upload(gpu, marks, 0, mark, description.bytes, error);
}

/* Makes labels marks, and finds which of them records have. */
static gw_status mark_records(const gw_record_context *on, gw_cone_gather *gather, uint32_t *label,
							  gw_error *error)
{
	uint32_t marks = gw_compartments_count(on->octree) + 1;
	gather->looked_into = gw_allocate_zeros(marks, sizeof *gather->looked_into);
	if (!gather->looked_into)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %u compartments", marks);
	for (size_t i = 0; i < on->records->count; i++) {
		label[i] = gw_compartment_mark(label[i]);
		gather->looked_into[label[i]] = true;
	}
	return upload_marks(on->passes->gpu, label, on->records->count, "compartments of records",
						&gather->record_mark, error);
}

static gw_status mark_facets(const gw_record_context *on, gw_cone_gather *gather, gw_error *error)
{
	const uint32_t *label = gw_compartments_of_facets(on->octree);
	size_t count = on->octree->facet_count;
	uint32_t *mark = gw_allocate_array(count, sizeof *mark);
	if (!mark)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for marks of %zu facets", count);
	for (size_t i = 0; i < count; i++)
		mark[i] = gw_compartment_mark(label[i]);
	gw_status status = upload_marks(on->passes->gpu, mark, count, "compartments of facets",
									&gather->facet_mark, error);
	free(mark);
	return status;
}

/* Once for all bounces, unless records were added. */
static gw_status find_marks(const gw_record_context *on, gw_cone_gather *gather, gw_error *error)
{
	uint32_t *label = NULL;
	if (gather->looked_into && gather->marked == on->records->count)
		return GW_OK;
	gw_cone_gather_forget_marks(on->passes->gpu, gather);
	gw_status status = gw_shut_out_label(on, &label, error);
	if (status == GW_OK)
		status = mark_records(on, gather, label, error);
	if (status == GW_OK)
		status = mark_facets(on, gather, error);
	free(label);
	gather->marked = on->records->count;
	if (status != GW_OK)
		gw_cone_gather_forget_marks(on->passes->gpu, gather);
	return status;
}

gw_status gw_cones_apart_bounce(const gw_record_context *on, gw_cone_gather *gather,
								gw_facet_radiance radiance, const float sky[3], gw_buffer *gathered,
								gw_error *error)
{
	const float black[3] = { 0 };
	if (!gw_compartments_several(on->octree))
		return gw_cone_gather_bounce(on, gather, radiance, sky, gathered, error);
	GW_TRY(find_marks(on, gather, error));
	uint32_t count = gw_compartments_count(on->octree);
	uint32_t outside = gw_compartment_mark(gw_compartment_outside(on->octree));
	radiance.apart = true;
	for (radiance.mark = 0; radiance.mark <= count; radiance.mark++) {
		bool open = radiance.mark == 0 || radiance.mark == outside;
		if (gather->looked_into[radiance.mark])
			GW_TRY(
				gw_cone_gather_bounce(on, gather, radiance, open ? sky : black, gathered, error));
	}
	return GW_OK;
}

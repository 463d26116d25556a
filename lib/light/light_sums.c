/*
 * light_sums.c - see light_sums.h. The buffer begins with the two sums, one of each kind; behind
 * them are the parts of the one that is being made, level by level.
 */
#include "light/light_sums.h"

#include "light/transport_layout.h"

#define SUMS 2u /* GW_SUM_FACETS and GW_SUM_RECORDS */
#define PART_BYTES 16u

static uint32_t parts_of(uint32_t elements)
{
	return elements / GW_SUM_RUN + (elements % GW_SUM_RUN != 0);
}

gw_status gw_light_sums_create(const gw_record_context *on, gw_light_sums *sums, gw_error *error)
{
	uint32_t facets = on->octree->facet_count, records = on->records->count;
	uint64_t parts = SUMS;
	for (uint32_t n = parts_of(facets > records ? facets : records); n > 1; n = parts_of(n))
		parts += n;
	return gw_buffer_create(on->passes->gpu,
							&(gw_buffer_description){ GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED,
													  PART_BYTES * parts, "sums of light" },
							&sums->part, error);
}

void gw_light_sums_destroy(gw_gpu *gpu, gw_light_sums *sums)
{
	gw_buffer_destroy(gpu, &sums->part);
}

/* Adds up elements, then their parts, until one is left, which goes to its place at the start. */
static gw_status add_up(gw_passes *passes, const gw_binding *bindings, uint32_t kind,
						uint32_t elements, gw_error *error)
{
	gw_sum_push push = { .kind = kind, .total = elements, .target = SUMS };
	for (;;) {
		push.parts = parts_of(push.total);
		bool last = push.parts <= 1;
		if (last)
			push.target = kind;
		GW_TRY(gw_passes_run(passes, GW_PASS_LIGHT_SUM, bindings, &push, push.parts, error));
		if (last)
			return GW_OK;
		push.kind = GW_SUM_PARTS;
		push.total = push.parts;
		push.source = push.target;
		push.target += push.parts;
	}
}

gw_status gw_light_sums_facets(const gw_record_context *on, gw_light_sums *sums,
							   const gw_buffer *facet_radiance, gw_error *error)
{
	const gw_binding bindings[] = { gw_whole(facet_radiance), gw_whole(&on->octree->facet_centre),
									gw_whole(&on->octree->facet_albedo), gw_whole(&sums->part) };
	return add_up(on->passes, bindings, GW_SUM_FACETS, on->octree->facet_count, error);
}

gw_status gw_light_sums_records(const gw_record_context *on, gw_light_sums *sums,
								const gw_buffer *power, gw_error *error)
{
	const gw_binding bindings[] = { gw_whole(&on->records->gathered), gw_whole(power),
									gw_whole(&on->octree->facet_albedo), gw_whole(&sums->part) };
	return add_up(on->passes, bindings, GW_SUM_RECORDS, on->records->count, error);
}

static gw_light_sum sum_of(const float part[4])
{
	return (gw_light_sum){ .power = (double)part[0] + (double)part[1],
						   .squares = (double)part[2],
						   .largest = part[3] };
}

gw_status gw_light_sums_read(gw_gpu *gpu, const gw_light_sums *sums, gw_light_sum *facets,
							 gw_light_sum *records, gw_error *error)
{
	float part[SUMS][4];
	GW_TRY(gw_buffer_download(gpu, &sums->part, 0, part, sizeof part, error));
	*facets = sum_of(part[GW_SUM_FACETS]);
	*records = sum_of(part[GW_SUM_RECORDS]);
	return GW_OK;
}

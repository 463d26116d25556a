/*
 * emitters.c - see emitters.h.
 */
#include "light/emitters.h"

#include "base/alias_table.h"
#include "base/luminance.h"
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

typedef struct emitter_row {
	uint32_t facet;
	uint32_t alias;
	float probability;
	uint32_t zero;
} emitter_row;

static gw_status upload_table(gw_gpu *gpu, const float *radiance, const float *centre, size_t slots,
							  gw_emitters *emitters, gw_error *error)
{
	emitter_row *rows = gw_allocate_zeros(emitters->count, sizeof *rows);
	double *share = gw_allocate_array(emitters->count, sizeof *share);
	gw_alias_row *alias = gw_allocate_array(emitters->count, sizeof *alias);
	gw_status status = GW_OK;
	if (!rows || !share || !alias)
		status = gw_fail(error, GW_ERROR_MEMORY, "no host memory for %u emitters", emitters->count);
	if (status == GW_OK) {
		uint32_t n = 0;
		double total = 0.0;
		for (size_t i = 0; i < slots; i++) {
			double power = gw_luminance(&radiance[4 * i]) * (double)centre[4 * i + 3];
			if (!(power > 0.0))
				continue;
			rows[n].facet = (uint32_t)i;
			share[n++] = power;
			total += power;
		}
		emitters->power = (float)total;
		status = gw_alias_table_fill(alias, share, n, error);
		for (uint32_t i = 0; i < n && status == GW_OK; i++) {
			rows[i].alias = alias[i].alias;
			rows[i].probability = alias[i].probability;
		}
	}
	if (status == GW_OK)
		status = gw_buffer_create(
			gpu,
			&(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_R32G32B32A32_UINT,
									  sizeof *rows * (uint64_t)emitters->count, "emitter table" },
			&emitters->table, error);
	if (status == GW_OK)
		status = gw_buffer_upload(gpu, &emitters->table, 0, rows,
								  sizeof *rows * (uint64_t)emitters->count, error);
	free(rows);
	free(share);
	free(alias);
	return status;
}

static void count_emitters(const float *radiance, const float *centre, size_t slots,
						   gw_emitters *emitters)
{
	double emitting = 0.0, whole = 0.0, power = 0.0, square = 0.0;
	for (size_t i = 0; i < slots; i++) {
		double l = gw_luminance(&radiance[4 * i]), area = (double)centre[4 * i + 3];
		whole += area;
		if (!(l * area > 0.0))
			continue;
		emitters->count++;
		emitting += area;
		power += l * area;
		square += l * l * area;
	}
	emitters->area_share = whole > 0.0 ? emitting / whole : 0.0;
	emitters->evenness = square > 0.0 ? power * power / (square * whole) : 0.0;
}

gw_status gw_emitters_make(gw_gpu *gpu, const gw_octree *octree, const gw_buffer *radiance,
						   bool always, gw_emitters *emitters, gw_error *error)
{
	*emitters = (gw_emitters){ .radiance = radiance };
	size_t slots = 2 * (size_t)octree->leaf_count;
	if (radiance->bytes < 16 * slots)
		return GW_OK;
	gw_view values = { 0 }, centre = { 0 };
	gw_status status = gw_view_open(gpu, radiance, 16 * slots, &values, error);
	if (status == GW_OK)
		status = gw_view_open(gpu, &octree->facet_centre, 16 * slots, &centre, error);
	if (status == GW_OK)
		count_emitters(values.bytes, centre.bytes, slots, emitters);
	if (status == GW_OK && emitters->count > 0 && (always || gw_emitters_are_small(emitters)))
		status = upload_table(gpu, values.bytes, centre.bytes, slots, emitters, error);
	gw_view_close(&values);
	gw_view_close(&centre);
	return status;
}

void gw_emitters_destroy(gw_gpu *gpu, gw_emitters *emitters)
{
	gw_buffer_destroy(gpu, &emitters->table);
	*emitters = (gw_emitters){ 0 };
}

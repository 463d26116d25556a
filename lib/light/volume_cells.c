/*
 * volume_cells.c - see volume_cells.h.
 */
#include "light/volume_cells.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

/* Leaf cells that a cell is wide at least: finer ones would see the same planes. */
#define SIZE_LEAST 0.5f

/* Of a cell: rounding does not make a row longer. */
#define ROUNDING 1e-4f

/* Places look for cells at half a cell along their normals, at one, and at two
 * (volume_weights.comp). */
#define STEPS 3

gw_status gw_volume_lay_out(const gw_record_context *on, const gw_volume_wish *wish,
							gw_radiance_volume *volume, gw_error *error)
{
	const gw_octree *octree = on->octree;
	const gw_surfels *s = wish->surfels;
	float extent[3], longest = 0.0f;
	uint64_t cells = 1, most = gw_gpu_limits(on->passes->gpu)->maxTexelBufferElements;
	for (int k = 0; k < 3; k++) {
		extent[k] = (s->maximum[k] - s->minimum[k]) / octree->leaf_size;
		longest = fmaxf(longest, extent[k]);
	}
	volume->size = fmaxf(longest / (float)wish->cells, SIZE_LEAST);
	for (int k = 0; k < 3; k++) {
		volume->cells[k] = (uint32_t)fmaxf(ceilf(extent[k] / volume->size - ROUNDING), 1.0f) + 2;
		float over = (float)volume->cells[k] * volume->size - extent[k];
		volume->minimum[k] =
			(s->minimum[k] - octree->cube_minimum[k]) / octree->leaf_size - 0.5f * over;
		cells *= volume->cells[k];
	}
	if (cells > most || cells >= GW_NONE)
		return gw_fail(error, GW_ERROR_MEMORY,
					   "a volume of %u x %u x %u cells is more than the %llu that the device can "
					   "number; ask for fewer along its longest side",
					   volume->cells[0], volume->cells[1], volume->cells[2],
					   (unsigned long long)most);
	return GW_OK;
}

void gw_volume_centre(const gw_radiance_volume *v, uint32_t cell, float centre[3])
{
	const uint32_t at[3] = { cell % v->cells[0], cell / v->cells[0] % v->cells[1],
							 cell / v->cells[0] / v->cells[1] };
	for (int k = 0; k < 3; k++)
		centre[k] = v->minimum[k] + ((float)at[k] + 0.5f) * v->size;
}

/* Marks the eight cells around a place. */
static void mark_around(const gw_radiance_volume *v, const float at[3], uint8_t *wanted)
{
	int64_t low[3];
	for (int k = 0; k < 3; k++)
		low[k] = (int64_t)floorf((at[k] - v->minimum[k]) / v->size - 0.5f);
	for (int c = 0; c < 8; c++) {
		int64_t x = low[0] + (c & 1), y = low[1] + (c >> 1 & 1), z = low[2] + (c >> 2);
		if (x >= 0 && y >= 0 && z >= 0 && x < v->cells[0] && y < v->cells[1] && z < v->cells[2])
			wanted[x + v->cells[0] * (y + v->cells[1] * z)] = 1;
	}
}

/* Marks the cells that places on the surface may look at: 4 floats a place and a normal. */
static void mark_read(const gw_radiance_volume *v, const float *place, const float *normal,
					  size_t count, uint8_t *wanted)
{
	for (size_t i = 0; i < count; i++) {
		float distance = 0.5f * v->size;
		if (normal[4 * i + 3] > 0.5f) /* lit from both sides, or of a record */
			mark_around(v, place + 4 * i, wanted);
		for (int step = 0; step < STEPS; step++, distance *= 2.0f) {
			float at[3];
			for (size_t k = 0; k < 3; k++)
				at[k] = place[4 * i + k] + distance * normal[4 * i + k];
			mark_around(v, at, wanted);
		}
	}
}

/* Places on the surface, on the device. */
typedef struct place_buffers {
	const gw_buffer *place, *normal;
	size_t count;
} place_buffers;

static gw_status mark_buffers(gw_gpu *gpu, const gw_radiance_volume *v, const place_buffers *of,
							  uint8_t *wanted, gw_error *error)
{
	gw_view places = { 0 }, normals = { 0 };
	if (of->count == 0)
		return GW_OK;
	gw_status status = gw_view_open(gpu, of->place, 16 * (uint64_t)of->count, &places, error);
	if (status == GW_OK)
		status = gw_view_open(gpu, of->normal, 16 * (uint64_t)of->count, &normals, error);
	if (status == GW_OK)
		mark_read(v, places.bytes, normals.bytes, of->count, wanted);
	gw_view_close(&normals);
	gw_view_close(&places);
	return status;
}

static gw_status mark(const gw_record_context *on, const gw_volume_wish *wish,
					  const gw_radiance_volume *v, size_t cells, uint8_t *wanted, gw_error *error)
{
	const gw_octree *octree = on->octree;
	const gw_records *r = on->records;
	for (size_t i = 0; i < cells && wish->whole; i++)
		wanted[i] = 1;
	if (wish->whole)
		return GW_OK;
	const place_buffers surfels = { &octree->surfel_position, &octree->surfel_normal,
									wish->surfels->count };
	GW_TRY(mark_buffers(on->passes->gpu, v, &surfels, wanted, error));
	return mark_buffers(on->passes->gpu, v, &(place_buffers){ &r->position, &r->normal, r->count },
						wanted, error);
}

static gw_status list(const uint8_t *wanted, size_t cells, gw_radiance_volume *v, gw_error *error)
{
	for (size_t i = 0; i < cells; i++)
		v->count += wanted[i];
	v->cell = gw_allocate_array(v->count, sizeof *v->cell);
	if (!v->cell)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %u cells of a volume", v->count);
	for (size_t i = 0, n = 0; i < cells; i++)
		if (wanted[i])
			v->cell[n++] = (uint32_t)i;
	return GW_OK;
}

gw_status gw_volume_list_cells(const gw_record_context *on, const gw_volume_wish *wish,
							   gw_radiance_volume *v, gw_error *error)
{
	size_t cells = (size_t)v->cells[0] * v->cells[1] * v->cells[2];
	uint8_t *wanted = gw_allocate_zeros(cells, 1);
	if (!wanted)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the %zu cells of a volume", cells);
	gw_status status = mark(on, wish, v, cells, wanted, error);
	if (status == GW_OK)
		status = list(wanted, cells, v, error);
	free(wanted);
	return status;
}

#include "grids/voxel_merge.h"
#include "glowworm_host.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Cells are from -CELLS to CELLS - 1. */
#define CELLS ((int64_t)1 << 20)

typedef struct place {
	uint64_t cell; /* z, y, x of 21 bits each */
	size_t voxel;
} place;

static int compare_places(const void *a, const void *b)
{
	const place *one = a, *other = b;
	if (one->cell != other->cell)
		return one->cell < other->cell ? -1 : 1;
	return one->voxel < other->voxel ? -1 : one->voxel > other->voxel;
}

/* Where the voxels go, sorted. */
static gw_status sort_places(const gw_voxels *v, double size, place *places, gw_error *error)
{
	for (size_t i = 0; i < v->count; i++) {
		places[i] = (place){ .voxel = i };
		for (size_t k = 3; k-- > 0;) {
			double cell = floor(((double)v->cell[3 * i + k] + 0.5) * v->size / size);
			if (!(cell >= (double)-CELLS && cell < (double)CELLS))
				return gw_fail(error, GW_ERROR_USAGE,
							   "voxels of %s m are too many along an axis; choose larger ones",
							   GW_SAID(size, 6));
			places[i].cell = places[i].cell << 21 | (uint64_t)((int64_t)cell + CELLS);
		}
	}
	qsort(places, v->count, sizeof *places, compare_places);
	return GW_OK;
}

static size_t count_cells(const place *places, size_t count)
{
	size_t cells = 0;
	for (size_t i = 0; i < count; i++)
		cells += i == 0 || places[i].cell != places[i - 1].cell;
	return cells;
}

static gw_status allocate(gw_voxels *m, gw_error *error)
{
	size_t n = m->count;
	m->cell = calloc(n, 3 * sizeof *m->cell);
	m->density = calloc(n, sizeof *m->density);
	m->radiance = calloc(n, 3 * sizeof *m->radiance);
	m->albedo = calloc(n, 3 * sizeof *m->albedo);
	m->emission = calloc(n, 3 * sizeof *m->emission);
	m->normal = calloc(n, 3 * sizeof *m->normal);
	if (m->cell && m->density && m->radiance && m->albedo && m->emission && m->normal)
		return GW_OK;
	voxel_merge_clear(m);
	return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu merged voxels", n);
}

/* Mean of one quantity over the voxels of a cell. */
static void put_mean(const gw_voxels *v, const place *places, size_t count, const float *from,
					 float *to)
{
	double sum[3] = { 0 }, even[3] = { 0 }, weight = 0.0;
	for (size_t i = 0; i < count; i++) {
		size_t voxel = places[i].voxel;
		double density = (double)v->density[voxel];
		weight += density;
		for (size_t k = 0; k < 3; k++) {
			sum[k] += density * (double)from[3 * voxel + k];
			even[k] += (double)from[3 * voxel + k];
		}
	}
	for (size_t k = 0; k < 3; k++)
		to[k] = (float)(weight > 0.0 ? sum[k] / weight : even[k] / (double)count);
}

static void put_cell(const gw_voxels *v, const place *places, size_t count, gw_voxels *m,
					 size_t cell)
{
	double density = 0.0, side = v->size / m->size;
	for (size_t i = 0; i < count; i++)
		density += (double)v->density[places[i].voxel] * side * side;
	m->density[cell] = (float)fmin(density, 1.0);
	for (size_t k = 0; k < 3; k++)
		m->cell[3 * cell + k] =
			(int32_t)((int64_t)(places->cell >> 21 * k & (uint64_t)(2 * CELLS - 1)) - CELLS);
	put_mean(v, places, count, v->radiance, m->radiance + 3 * cell);
	put_mean(v, places, count, v->albedo, m->albedo + 3 * cell);
	put_mean(v, places, count, v->emission, m->emission + 3 * cell);
	put_mean(v, places, count, v->normal, m->normal + 3 * cell);
}

static gw_status merge(const gw_voxels *v, place *places, gw_voxels *m, gw_error *error)
{
	GW_TRY(sort_places(v, m->size, places, error));
	m->count = count_cells(places, v->count);
	GW_TRY(allocate(m, error));
	for (size_t i = 0, cell = 0; i < v->count; cell++) {
		size_t first = i;
		while (i < v->count && places[i].cell == places[first].cell)
			i++;
		put_cell(v, places + first, i - first, m, cell);
	}
	return GW_OK;
}

gw_status voxel_merge(const gw_voxels *v, double size, gw_voxels *m, gw_error *error)
{
	*m = (gw_voxels){ .size = size };
	memcpy(m->origin, v->origin, sizeof m->origin);
	/* A size that was printed with six digits means the voxels' own. */
	if (!(size >= v->size * (1.0 - 1e-5)))
		return gw_fail(error, GW_ERROR_USAGE,
					   "voxels of %s m are asked for, but those of the bake are %s m wide; give a "
					   "larger --vdb-voxel, or a smaller --leaf-spacing",
					   GW_SAID(size, 6), GW_SAID(v->size, 6));
	place *places = calloc(v->count + 1, sizeof *places);
	if (!places)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to merge %zu voxels", v->count);
	gw_status status = merge(v, places, m, error);
	free(places);
	if (status != GW_OK)
		*m = (gw_voxels){ 0 };
	return status;
}

void voxel_merge_clear(gw_voxels *m)
{
	free(m->cell);
	free(m->density);
	free(m->radiance);
	free(m->albedo);
	free(m->emission);
	free(m->normal);
	*m = (gw_voxels){ 0 };
}

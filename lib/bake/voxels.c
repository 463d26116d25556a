/*
 * voxels.c - see voxels.h.
 */
#include "bake/voxels.h"

#include "light/bounces.h"
#include "base/memory.h"
#include "light/transport_layout.h"

#include <math.h>
#include <stdlib.h>

/* Host copies of what the leaves hold; 4 floats a facet unless said. */
typedef struct leaf_arrays {
	float *geometry; /* 8 a leaf */
	float *centre, *albedo, *emission, *plane, *direct, *gathered;
	uint32_t *cell; /* 4 a leaf */
	gw_view leaf;   /* facet_leaf */
} leaf_arrays;

static gw_status fetch(const gw_voxels_task *task, const gw_buffer *buffer, uint64_t texels,
					   void **values, gw_error *error)
{
	*values = gw_allocate_zeros((size_t)texels, 16);
	if (!*values)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %llu voxels",
					   (unsigned long long)texels);
	if (buffer->bytes < 16 * texels)
		return GW_OK; /* an attribute that nothing has: zeros */
	return gw_buffer_download(task->passes->gpu, buffer, 0, *values, 16 * texels, error);
}

/* What the facets reflect of all that was gathered, into a buffer of its own. */
static gw_status shade_gathered(const gw_voxels_task *task, float **values, gw_error *error)
{
	gw_gpu *gpu = task->passes->gpu;
	uint64_t facets = task->octree->facet_count;
	gw_records *records = task->records;
	const gw_record_context on = { task->passes, task->octree, records };
	gw_buffer reflected = { 0 };
	GW_TRY(gw_light_add(task->passes, &records->first, &records->indirect, records->count, error));
	GW_TRY(gw_buffer_create(gpu,
							&(gw_buffer_description){ GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED,
													  16 * facets, "voxel radiance" },
							&reflected, error));
	gw_status status =
		gw_facets_shade(&on, &records->indirect, task->facet_direct, 0.0f, &reflected, error);
	if (status == GW_OK)
		status = fetch(task, &reflected, facets, (void **)values, error);
	gw_buffer_destroy(gpu, &reflected);
	return status;
}

static gw_status fetch_all(const gw_voxels_task *task, leaf_arrays *arrays, gw_error *error)
{
	const gw_octree *o = task->octree;
	uint64_t facets = o->facet_count;
	const struct {
		const gw_buffer *buffer;
		uint64_t texels;
		void **values;
	} rows[] = {
		{ &o->leaf_geometry, 2 * (uint64_t)o->leaf_count, (void **)&arrays->geometry },
		{ &o->facet_centre, facets, (void **)&arrays->centre },
		{ &o->facet_albedo, facets, (void **)&arrays->albedo },
		{ &o->facet_emission, facets, (void **)&arrays->emission },
		{ &o->facet_plane, facets, (void **)&arrays->plane },
		{ task->facet_direct, facets, (void **)&arrays->direct },
		{ &o->leaf_cell, o->leaf_count, (void **)&arrays->cell },
	};
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
		if (rows[i].buffer->handle != VK_NULL_HANDLE)
			GW_TRY(fetch(task, rows[i].buffer, rows[i].texels, rows[i].values, error));
	if (task->records)
		GW_TRY(shade_gathered(task, &arrays->gathered, error));
	return gw_view_open(task->passes->gpu, &o->facet_leaf, 4 * facets, &arrays->leaf, error);
}

static gw_status allocate(size_t count, gw_voxels *voxels, gw_error *error)
{
	voxels->count = count;
	voxels->cell = gw_allocate_zeros(count, 3 * sizeof *voxels->cell);
	voxels->density = gw_allocate_zeros(count, sizeof(float));
	bool complete = voxels->cell && voxels->density;
	float **vectors[] = { &voxels->radiance, &voxels->albedo, &voxels->emission, &voxels->normal };
	for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++)
		complete &= (*vectors[i] = gw_allocate_zeros(count, 3 * sizeof(float))) != NULL;
	if (!complete)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu voxels", count);
	return GW_OK;
}

/* The number of a leaf that has these facets. */
typedef struct leaf_facets {
	size_t leaf, first, end;
} leaf_facets;

/* The leaf of facet number `first`. */
static leaf_facets leaf_with(const leaf_arrays *arrays, size_t first, size_t facets)
{
	const uint32_t *word = arrays->leaf.bytes;
	size_t leaf = gw_facet_leaf(word[first]), end = first + 1;
	end += end < facets && gw_facet_is_second(word[end]);
	return (leaf_facets){ leaf, first, end };
}

/* Area-weighted means over a leaf's facets. A leaf that only a region of influence touches has no
 * surface: its albedo comes from there. */
static void fill_voxel(const leaf_arrays *arrays, const leaf_facets *of, gw_voxels *voxels)
{
	size_t leaf = of->leaf;
	const float *geometry = &arrays->geometry[8 * leaf];
	float area = 0.0f;
	for (size_t facet = of->first; facet < of->end; facet++)
		area += arrays->centre[4 * facet + 3];
	for (size_t axis = 0; axis < 3; axis++)
		voxels->cell[3 * leaf + axis] = (int32_t)arrays->cell[4 * leaf + axis];
	voxels->density[leaf] = fminf(1.0f, geometry[3]);
	for (size_t c = 0; c < 3; c++) {
		float radiance = 0.0f, albedo = 0.0f, emission = 0.0f, normal = 0.0f;
		for (size_t facet = of->first; facet < of->end && area > 0.0f; facet++) {
			size_t at = 4 * facet + c;
			float share = arrays->centre[4 * facet + 3] / area;
			float lamps = arrays->direct ? arrays->direct[at] : 0.0f;
			float reflected = arrays->albedo[at] * 0.318309886f * lamps +
							  (arrays->gathered ? arrays->gathered[at] : 0.0f);
			radiance += share * (arrays->emission[at] + reflected);
			albedo += share * arrays->albedo[at];
			emission += share * arrays->emission[at];
			normal += share * arrays->plane[at];
		}
		if (area <= 0.0f && geometry[3] > 0.0f) {
			albedo = geometry[c] / geometry[3];
			normal = geometry[4 + c] / geometry[3];
		}
		voxels->radiance[3 * leaf + c] = radiance;
		voxels->albedo[3 * leaf + c] = albedo;
		voxels->emission[3 * leaf + c] = emission;
		voxels->normal[3 * leaf + c] = normal;
	}
}

gw_status gw_voxels_collect(const gw_voxels_task *task, gw_voxels *voxels, gw_error *error)
{
	const gw_octree *octree = task->octree;
	*voxels = (gw_voxels){ .size = (double)octree->leaf_size };
	for (int axis = 0; axis < 3; axis++)
		voxels->origin[axis] = task->surfels->origin[axis] + (double)octree->cube_minimum[axis];
	leaf_arrays arrays = { 0 };
	gw_status status = fetch_all(task, &arrays, error);
	if (status == GW_OK)
		status = allocate(octree->leaf_count, voxels, error);
	for (size_t facet = GW_FACET_EMPTY + 1; facet < octree->facet_count && status == GW_OK;) {
		const leaf_facets of = leaf_with(&arrays, facet, octree->facet_count);
		fill_voxel(&arrays, &of, voxels);
		facet = of.end;
	}
	gw_view_close(&arrays.leaf);
	void *all[] = { arrays.geometry, arrays.centre, arrays.albedo,   arrays.emission,
					arrays.plane,    arrays.direct, arrays.gathered, arrays.cell };
	for (size_t i = 0; i < sizeof all / sizeof *all; i++)
		free(all[i]);
	if (status != GW_OK)
		gw_voxels_clear(voxels);
	return status;
}

void gw_voxels_clear(gw_voxels *voxels)
{
	free(voxels->cell);
	free(voxels->density);
	free(voxels->radiance);
	free(voxels->albedo);
	free(voxels->emission);
	free(voxels->normal);
	*voxels = (gw_voxels){ 0 };
}

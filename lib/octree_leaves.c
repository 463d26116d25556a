/*
 * octree_leaves.c - what lies in each leaf, and the directory that lets rays skip what is empty;
 * see octree_steps.h.
 */
#include "octree_steps.h"

#include "memory.h"

#include <stdlib.h>

/* Fragments of the leaf that has most. */
static gw_status find_longest(gw_octree_work *work, uint32_t *longest, gw_error *error)
{
	gw_octree *octree = work->octree;
	uint64_t words = (uint64_t)octree->leaf_count + 1;
	uint32_t *first = gw_allocate_array(words, sizeof *first);
	if (first == NULL)
		return gw_fail(error, GW_ERROR_MEMORY, "not enough memory for %u leaves",
		               octree->leaf_count);
	gw_status status =
		gw_buffer_download(work->gpu, &octree->leaf_fragment, 0, first, 4 * words, error);
	*longest = 0;
	for (uint32_t i = 0; i < octree->leaf_count && status == GW_OK; i++)
		if (first[i + 1] - first[i] > *longest)
			*longest = first[i + 1] - first[i];
	free(first);
	return status;
}

static gw_status create_leaves(gw_octree_work *work, gw_error *error)
{
	gw_octree *octree = work->octree;
	uint64_t leaves = octree->leaf_count, cells = UINT64_C(1) << 3 * octree->directory_level;
	VkFormat floats = VK_FORMAT_R32G32B32A32_SFLOAT;
	uint64_t emission = work->surfels->emission != NULL ? 32 * leaves : 16;
	const struct {
		gw_buffer *buffer;
		VkFormat format;
		uint64_t bytes;
		const char *name;
	} part[] = {
		{ &octree->leaf_geometry, floats, 32 * leaves, "geometry of leaves" },
		{ &octree->lobe_plane, floats, 32 * leaves, "planes of lobes" },
		{ &octree->lobe_centre, floats, 32 * leaves, "centroids of lobes" },
		{ &octree->lobe_albedo, floats, 32 * leaves, "albedos of lobes" },
		{ &octree->lobe_emission, floats, emission, "emission of lobes" },
		{ &octree->ray_directory, VK_FORMAT_R32_UINT, 4 * cells, "directory of rays" },
		{ &work->seed, VK_FORMAT_R32G32B32A32_UINT, 16 * leaves, "seeds of lobes" },
		{ &work->ray_mark, VK_FORMAT_R32_UINT, 4 * cells, "marked cells" },
		{ &work->distance, VK_FORMAT_R32_UINT, 4 * cells, "distances to marked cells" },
	};
	for (size_t i = 0; i < sizeof part / sizeof *part; i++)
		GW_TRY(gw_octree_buffer(work, part[i].format, part[i].bytes, part[i].name, part[i].buffer,
		                        error));
	return GW_OK;
}

/* Lobes' emission; when there is none, a buffer of one texel that the passes leave alone. */
static gw_binding emission_binding(gw_octree *octree, bool emissive)
{
	return emissive ? GW_WINDOW(&octree->lobe_emission, 32) : GW_WHOLE(&octree->lobe_emission);
}

static gw_status reduce(gw_octree_work *work, gw_leaves_push push, uint32_t longest,
                        gw_error *error)
{
	gw_octree *octree = work->octree;
	gw_binding seeding[] = {
		GW_WHOLE(&octree->leaf_fragment),   GW_WHOLE(&octree->fragment_surfel),
		GW_WHOLE(&octree->fragment_weight), GW_WHOLE(&octree->surfel_normal),
		GW_WHOLE(&work->surfel_albedo),     GW_WINDOW(&work->seed, 16),
		GW_WINDOW(&octree->leaf_geometry, 32),
	};
	for (uint64_t from = 0; from < longest; from += GW_REDUCE_RUN) {
		push.from = (uint32_t)from;
		GW_TRY(gw_octree_run(work, GW_OCTREE_SEED, seeding, &push, octree->leaf_count, error));
	}
	gw_binding adding[] = {
		GW_WHOLE(&octree->leaf_fragment),     GW_WHOLE(&octree->leaf_cell),
		GW_WHOLE(&octree->fragment_weight),   GW_WHOLE(&work->fragment_centroid),
		GW_WHOLE(&octree->surfel_position),   GW_WHOLE(&octree->surfel_normal),
		GW_WHOLE(&work->surfel_albedo),       GW_WHOLE(&work->surfel_emission),
		GW_WHOLE(&octree->fragment_surfel),   GW_WINDOW(&work->seed, 16),
		GW_WINDOW(&octree->lobe_plane, 32),   GW_WINDOW(&octree->lobe_centre, 32),
		GW_WINDOW(&octree->lobe_albedo, 32),  emission_binding(octree, push.emissive),
	};
	for (uint64_t from = 0; from < longest; from += GW_REDUCE_RUN) {
		push.from = (uint32_t)from;
		GW_TRY(gw_octree_run(work, GW_OCTREE_LOBES, adding, &push, octree->leaf_count, error));
	}
	return GW_OK;
}

static gw_status finish(gw_octree_work *work, gw_leaves_push push, gw_error *error)
{
	gw_octree *octree = work->octree;
	gw_binding bindings[] = {
		GW_WHOLE(&octree->leaf_cell),        GW_WHOLE(&octree->fragment_surfel),
		GW_WHOLE(&octree->surfel_position),  GW_WHOLE(&octree->surfel_normal),
		GW_WINDOW(&work->seed, 16),          GW_WINDOW(&octree->lobe_plane, 32),
		GW_WINDOW(&octree->lobe_centre, 32), GW_WINDOW(&octree->lobe_albedo, 32),
		emission_binding(octree, push.emissive), GW_WHOLE(&octree->leaf_tile),
		GW_WHOLE(&work->ray_mark),
	};
	return gw_octree_run(work, GW_OCTREE_FINISH, bindings, &push, octree->leaf_count, error);
}

static gw_status find_distances(gw_octree_work *work, gw_error *error)
{
	gw_octree *octree = work->octree;
	gw_buffer *stage[] = { &work->ray_mark, &work->distance, &work->ray_mark,
		                   &octree->ray_directory };
	uint64_t cells = UINT64_C(1) << 3 * octree->directory_level;
	for (uint32_t axis = 0; axis < 3; axis++) {
		gw_distance_push push = { .level = octree->directory_level, .axis = axis };
		gw_binding bindings[] = { GW_WHOLE(stage[axis]), GW_WHOLE(&octree->level_directory),
			                      GW_WINDOW(stage[axis + 1], 4) };
		GW_TRY(gw_octree_run(work, GW_OCTREE_DISTANCE, bindings, &push, cells, error));
	}
	return GW_OK;
}

gw_status gw_octree_reduce_leaves(gw_octree_work *work, gw_error *error)
{
	gw_octree *octree = work->octree;
	uint32_t longest;
	GW_TRY(find_longest(work, &longest, error));
	GW_TRY(create_leaves(work, error));
	gw_leaves_push push = {
		.leaves = octree->leaf_count,
		.emissive = work->surfels->emission != NULL,
		.depth = octree->depth,
		.directory_level = octree->directory_level,
	};
	GW_TRY(reduce(work, push, longest, error));
	GW_TRY(finish(work, push, error));
	return find_distances(work, error);
}

/*
 * octree_leaves.c - what lies in each leaf, and the directory that lets rays skip what is empty;
 * see octree_steps.h.
 */
#include "octree/octree_steps.h"

#include "base/memory.h"
#include "cloud/frame.h"

#include <stdlib.h>
#include <string.h>

/* Fragments of the leaf that has most. */
static gw_status find_longest(gw_octree_work *work, uint32_t *longest, gw_error *error)
{
	gw_octree *octree = work->octree;
	gw_view view;
	*longest = 0;
	GW_TRY(gw_view_open(work->gpu, &octree->leaf_fragment, 4 * ((uint64_t)octree->leaf_count + 1),
						&view, error));
	const uint32_t *first = view.bytes;
	for (uint32_t i = 0; i < octree->leaf_count; i++)
		if (first[i + 1] - first[i] > *longest)
			*longest = first[i + 1] - first[i];
	gw_view_close(&view);
	return GW_OK;
}

static gw_status create_seeds(gw_octree_work *work, gw_error *error)
{
	gw_octree *octree = work->octree;
	uint64_t leaves = octree->leaf_count;
	const gw_octree_part part[] = {
		{ &octree->leaf_geometry, VK_FORMAT_R32G32B32A32_SFLOAT, 32 * leaves,
		  "geometry of leaves" },
		{ &work->seed, VK_FORMAT_R32G32B32A32_UINT, 16 * leaves, "seeds of facets" },
	};
	return gw_octree_buffers(work, part, sizeof part / sizeof *part, error);
}

static gw_status create_facets(gw_octree_work *work, gw_error *error)
{
	gw_octree *octree = work->octree;
	uint64_t facets = 16 * (uint64_t)octree->facet_count;
	uint64_t cells = UINT64_C(1) << 3 * octree->directory_level;
	VkFormat floats = VK_FORMAT_R32G32B32A32_SFLOAT;
	uint64_t emission = gw_surfels_emit(work->surfels) ? facets : 16;
	const gw_octree_part part[] = {
		{ &octree->facet_plane, floats, facets, "planes of facets" },
		{ &octree->facet_centre, floats, facets, "centroids of facets" },
		{ &octree->facet_albedo, floats, facets, "albedos of facets" },
		{ &octree->facet_emission, floats, emission, "emission of facets" },
		{ &work->ray_mark, VK_FORMAT_R32_UINT, 4 * cells, "marked cells" },
	};
	return gw_octree_buffers(work, part, sizeof part / sizeof *part, error);
}

/* Facets' emission; when there is none, a buffer of one texel that the passes leave alone. */
static gw_binding emission_binding(gw_octree *octree, bool emissive)
{
	return emissive ? GW_WINDOW(&octree->facet_emission, 16) : GW_WHOLE(&octree->facet_emission);
}

/* Seeds of facets, and geometry of leaves. */
static gw_status find_seeds(gw_octree_work *work, gw_leaves_push push, uint32_t longest,
							gw_error *error)
{
	gw_octree *octree = work->octree;
	gw_binding seeding[] = {
		GW_WHOLE(&octree->leaf_fragment),      GW_WHOLE(&octree->fragment_surfel),
		GW_WHOLE(&octree->fragment_weight),    GW_WHOLE(&octree->surfel_normal),
		GW_WHOLE(&work->surfel_albedo),        GW_WINDOW(&work->seed, 16),
		GW_WINDOW(&octree->leaf_geometry, 32),
	};
	for (uint64_t from = 0; from < longest; from += GW_REDUCE_RUN) {
		push.from = (uint32_t)from;
		GW_TRY(gw_passes_run(&work->passes, GW_PASS_OCTREE_SEED, seeding, &push, octree->leaf_count,
							 error));
	}
	return GW_OK;
}

/* Which facet of its leaf each disc fragment joins. */
static gw_status join_facets(gw_octree_work *work, gw_leaves_push push, uint32_t longest,
							 gw_error *error)
{
	gw_octree *octree = work->octree;
	gw_binding joining[] = { GW_WHOLE(&octree->leaf_fragment), GW_WHOLE(&octree->surfel_normal),
							 GW_WHOLE(&octree->fragment_surfel), GW_WINDOW(&work->seed, 16) };
	for (uint64_t from = 0; from < longest; from += GW_REDUCE_RUN) {
		push.from = (uint32_t)from;
		GW_TRY(gw_passes_run(&work->passes, GW_PASS_OCTREE_JOIN, joining, &push, octree->leaf_count,
							 error));
	}
	return GW_OK;
}

static gw_status add_up_facets(gw_octree_work *work, gw_leaves_push push, uint32_t longest,
							   gw_error *error)
{
	gw_octree *octree = work->octree;
	gw_binding adding[] = {
		GW_WHOLE(&octree->leaf_fragment),
		GW_WHOLE(&octree->leaf_cell),
		GW_WHOLE(&octree->fragment_weight),
		GW_WHOLE(&work->fragment_centroid),
		GW_WHOLE(&octree->surfel_position),
		GW_WHOLE(&octree->surfel_normal),
		GW_WHOLE(&work->surfel_albedo),
		GW_WHOLE(&work->surfel_emission),
		GW_WHOLE(&work->surfel_bend),
		GW_WHOLE(&octree->fragment_surfel),
		GW_WHOLE(&work->seed),
		GW_WHOLE(&octree->facet_leaf),
		GW_WINDOW(&octree->facet_plane, 16),
		GW_WINDOW(&octree->facet_centre, 16),
		GW_WINDOW(&octree->facet_albedo, 16),
		emission_binding(octree, push.emissive),
	};
	for (uint64_t from = 0; from < longest; from += GW_REDUCE_RUN) {
		push.from = (uint32_t)from;
		GW_TRY(gw_passes_run(&work->passes, GW_PASS_OCTREE_FACETS, adding, &push,
							 octree->facet_count, error));
	}
	return GW_OK;
}

static gw_status finish(gw_octree_work *work, gw_leaves_push push, gw_error *error)
{
	gw_octree *octree = work->octree;
	gw_binding bindings[] = {
		GW_WHOLE(&octree->leaf_cell),
		GW_WHOLE(&octree->fragment_surfel),
		GW_WHOLE(&octree->facet_leaf),
		GW_WHOLE(&octree->surfel_normal),
		GW_WHOLE(&work->seed),
		GW_WINDOW(&octree->facet_plane, 16),
		GW_WINDOW(&octree->facet_centre, 16),
		GW_WINDOW(&octree->facet_albedo, 16),
		emission_binding(octree, push.emissive),
		GW_WHOLE(&octree->leaf_tile),
		GW_WHOLE(&work->ray_mark),
	};
	return gw_passes_run(&work->passes, GW_PASS_OCTREE_FINISH, bindings, &push, octree->facet_count,
						 error);
}

static uint8_t lesser(uint8_t a, uint8_t b)
{
	return a < b ? a : b;
}

/* Lowers a row's distances by the 13 cells around each that come before it in the order of z, y, x;
 * step is -1, and 1 for those that come behind. least: side + 2. */
static void spread_along_row(uint8_t *row, size_t side, ptrdiff_t step, uint8_t *least)
{
	const ptrdiff_t wide = (ptrdiff_t)side + 2, layer = wide * wide;
	const uint8_t *beside = row + step * wide, *below = row + step * layer;
	for (ptrdiff_t x = 0; x < wide; x++)
		least[x] = lesser(lesser(beside[x], below[x]), lesser(below[x - wide], below[x + wide]));
	uint8_t last = GW_DISTANCE_FAR;
	for (ptrdiff_t n = 1; n <= (ptrdiff_t)side; n++) {
		ptrdiff_t x = step < 0 ? n : wide - 1 - n;
		uint8_t around = lesser(lesser(least[x - 1], least[x]), lesser(least[x + 1], last));
		last = lesser(row[x], around < GW_DISTANCE_FAR ? (uint8_t)(around + 1) : around);
		row[x] = last;
	}
}

/*
 * Chessboard distances to the nearest cell of 0, in a grid with a rim of one cell that stays as it
 * is. Two passes in opposite orders are exact: a shortest way goes first along, then against one.
 * least: side + 2, for their use.
 */
static void spread_distances(uint8_t *grid, size_t side, uint8_t *least)
{
	const size_t wide = side + 2;
	for (size_t z = 1; z <= side; z++)
		for (size_t y = 1; y <= side; y++)
			spread_along_row(grid + (z * wide + y) * wide, side, -1, least);
	for (size_t z = side; z > 0; z--)
		for (size_t y = side; y > 0; y--)
			spread_along_row(grid + (z * wide + y) * wide, side, 1, least);
}

/* Marks of `side`^3 cells become distances, at most GW_DISTANCE_FAR. */
static bool make_distances(uint32_t *cells, size_t side)
{
	const size_t wide = side + 2, all = wide * wide * wide;
	uint8_t *grid = gw_allocate_array(all + wide, 1);
	if (grid == NULL)
		return false;
	memset(grid, GW_DISTANCE_FAR, all);
	const uint32_t *mark = cells;
	for (size_t z = 1; z <= side; z++)
		for (size_t y = 1; y <= side; y++)
			for (size_t x = 1; x <= side; x++)
				if (*mark++ != 0)
					grid[(z * wide + y) * wide + x] = 0;
	spread_distances(grid, side, grid + all);
	for (size_t z = 1; z <= side; z++)
		for (size_t y = 1; y <= side; y++)
			for (size_t x = 1; x <= side; x++)
				*cells++ = grid[(z * wide + y) * wide + x];
	free(grid);
	return true;
}

/* On the host, which looks at each cell twice; threads with one cell each would have to search. */
static gw_status find_distances(gw_octree_work *work, gw_error *error)
{
	gw_octree *octree = work->octree;
	size_t side = (size_t)1 << octree->directory_level, cells = side * side * side;
	GW_TRY(gw_octree_buffer_unset(work, VK_FORMAT_R32_UINT, 4 * (uint64_t)cells,
								  "distances to marked cells", &work->distance, error));
	GW_TRY(gw_octree_buffer_unset(work, VK_FORMAT_R32_UINT, 4 * (uint64_t)cells,
								  "directory of rays", &octree->ray_directory, error));
	uint32_t *host = gw_allocate_array(cells, sizeof *host);
	gw_status status = GW_OK;
	if (host == NULL)
		return gw_fail(error, GW_ERROR_MEMORY, "not enough memory for %zu cells", cells);
	status = gw_buffer_download(work->gpu, &work->ray_mark, 0, host, 4 * cells, error);
	if (status == GW_OK && !make_distances(host, side))
		status = gw_fail(error, GW_ERROR_MEMORY, "not enough memory for %zu cells", cells);
	if (status == GW_OK)
		status = gw_buffer_upload(work->gpu, &work->distance, 0, host, 4 * cells, error);
	free(host);
	GW_TRY(status);
	gw_distance_push push = { .level = octree->directory_level };
	gw_binding bindings[] = { GW_WHOLE(&work->distance), GW_WHOLE(&octree->level_directory),
							  GW_WINDOW(&octree->ray_directory, 4) };
	return gw_passes_run(&work->passes, GW_PASS_OCTREE_DISTANCE, bindings, &push, cells, error);
}

/* What only facets were made of. */
static void forget_fragments(gw_octree_work *work)
{
	gw_buffer *buffer[] = { &work->surfel_albedo, &work->surfel_emission, &work->surfel_bend,
							&work->fragment_centroid, &work->seed };
	for (size_t i = 0; i < sizeof buffer / sizeof *buffer; i++)
		gw_buffer_destroy(work->gpu, buffer[i]);
}

gw_status gw_octree_reduce_leaves(gw_octree_work *work, gw_error *error)
{
	gw_octree *octree = work->octree;
	uint32_t longest = 0;
	GW_TRY(find_longest(work, &longest, error));
	GW_TRY(gw_octree_upload_colours(work, error));
	GW_TRY(create_seeds(work, error));
	gw_leaves_push push = {
		.leaves = octree->leaf_count,
		.emissive = gw_surfels_emit(work->surfels),
		.depth = octree->depth,
		.directory_level = octree->directory_level,
	};
	GW_TRY(find_seeds(work, push, longest, error));
	if (!work->regions)
		gw_buffer_destroy(work->gpu, &octree->leaf_geometry);
	GW_TRY(join_facets(work, push, longest, error));
	GW_TRY(gw_octree_number_facets(work, error));
	GW_TRY(create_facets(work, error));
	GW_TRY(add_up_facets(work, push, longest, error));
	GW_TRY(finish(work, push, error));
	forget_fragments(work);
	return find_distances(work, error);
}

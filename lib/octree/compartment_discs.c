/*
 * compartment_discs.c - walls of surface that is sparser than leaves are wide; see compartments.h.
 *
 * There voids are many leaves across, and discs that are too large for leaves have no cells at all.
 * So each such disc makes walls of cells about as wide as itself, and a little beyond its rim.
 * Where finer surface has divided these, smaller ones; empty space is divided as far as it takes.
 */
#include "octree/compartments_steps.h"

#include <string.h>

/* Discs that reach as far are of surface that is much sparser than leaves are wide: even at the rim
 * of a window, where half of the points around are missing, one in 3,000 random ones does. */
#define CUT_RADIUS 3.0f

/* The discs of an octree. */
typedef struct discs {
	size_t count;
	gw_view view[4];    /* places, normals, sizes, cuts */
	const float *clear; /* NULL, or what shines through them */
	float least;        /* radius, leaf cells */
	bool whole;         /* they are not cut */
	uint32_t depth;
} discs;

static bool shape_of(const void *user, size_t number, gw_wall_shape *shape)
{
	const discs *all = user;
	const float *row[4];
	for (int i = 0; i < 4; i++)
		row[i] = (const float *)all->view[i].bytes + 4 * number;
	if (row[2][0] < all->least || (all->clear && all->clear[number] > 0.0f))
		return false;
	*shape = gw_wall_shape_of_disc(row[0], row[1], row[2], row[3], all->depth);
	if (all->whole)
		memset(shape->cut, 0, sizeof shape->cut);
	return true;
}

static gw_status wall_with(gw_gpu *gpu, const gw_octree *octree, discs *all, uint32_t threads,
						   gw_compartments *c, gw_error *error)
{
	const gw_buffer *const buffer[4] = { &octree->surfel_position, &octree->surfel_normal,
										 &octree->surfel_disc, &octree->surfel_clip };
	const gw_wall_shapes shapes = { all->count, shape_of, all, false, all->whole };
	gw_status status = GW_OK;
	for (int i = 0; i < 4 && status == GW_OK; i++)
		status = gw_view_open(gpu, buffer[i], 16 * (uint64_t)all->count, &all->view[i], error);
	if (status == GW_OK)
		status = gw_walls_make(c, &shapes, threads, error);
	for (int i = 0; i < 4; i++)
		gw_view_close(&all->view[i]);
	return status;
}

gw_status gw_compartments_wall_discs(gw_gpu *gpu, const gw_octree *octree,
									 const gw_surfels *surfels, uint32_t threads,
									 gw_compartments *c, gw_error *error)
{
	discs all = { .count = surfels->count,
				  .clear = surfels->transparency,
				  .least = GW_SPARSE_RADIUS,
				  .depth = c->depth };
	return wall_with(gpu, octree, &all, threads, c, error);
}

gw_status gw_compartments_mark_discs(gw_gpu *gpu, const gw_octree *octree,
									 const gw_surfels *surfels, uint32_t threads,
									 gw_compartments *c, gw_error *error)
{
	discs all = { .count = surfels->count,
				  .clear = surfels->transparency,
				  .least = CUT_RADIUS,
				  .whole = true,
				  .depth = c->depth };
	return wall_with(gpu, octree, &all, threads, c, error);
}

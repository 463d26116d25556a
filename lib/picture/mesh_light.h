/*
 * mesh_light.h - triangles that take their light from the points on them.
 *
 * A mesh that was sampled and lit is drawn as what it is: its triangles are cut into pieces as
 * small as the points are dense, each corner of a piece takes what the points around it on the same
 * side have, and the points on the mesh are not drawn themselves.
 */
#ifndef MESH_LIGHT_H
#define MESH_LIGHT_H

#include "surfels/surfels.h"

/* Pieces of triangles, three corners of their own each. Zeroed: none. */
typedef struct gw_mesh_pieces {
	float *position; /* owned; 9 * count, metres in the surfels' frame */
	float *normal;   /* owned; 9 * count, unit */
	float *channel;  /* owned; 3 * channel_count * count, from gw_mesh_light; NULL before */
	size_t count, capacity;
	/* Set before the first triangle is added: */
	float longest;                /* metres, of an edge */
	float minimum[3], maximum[3]; /* bounds; pieces that are wholly outside are left out */
	size_t most;                  /* no more pieces than this are added */
} gw_mesh_pieces;

/*
 * Adds a triangle, cut by halving its longest edge until none is longer than pieces->longest. Edges
 * that triangles share are cut at the same places, so that no gaps arise.
 *   corner   9, metres in the surfels' frame, finite
 *   normal   9, unit
 * Fails with GW_ERROR_MEMORY.
 */
gw_status gw_mesh_pieces_add(gw_mesh_pieces *pieces, const float corner[9], const float normal[9],
							 gw_error *error);
void gw_mesh_pieces_clear(gw_mesh_pieces *pieces);

/*
 * Finds the points on the pieces and lights these by them. Pieces with no point near are taken off:
 * nobody knows their light.
 *   channel   channel_count * surfels->count, what the surfels have
 *   on_mesh   surfels->count; receives 1 for each that lies on a piece
 * Fails with GW_ERROR_MEMORY. The result does not depend on the number of threads.
 */
gw_status gw_mesh_light(gw_mesh_pieces *pieces, const gw_surfels *surfels, const float *channel,
						uint32_t channel_count, uint32_t threads, uint8_t *on_mesh,
						gw_error *error);

#endif

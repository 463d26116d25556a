/*
 * box_mesh.h - boxes, frames and discs as triangles, for pictures of cells and samples.
 */
#ifndef BOX_MESH_H
#define BOX_MESH_H

#include "glowworm_picture.h"

/* Channels of each vertex: red, green, blue, and where on its face it lies, 0..1 twice. */
enum { BOX_MESH_U = 3, BOX_MESH_V = 4, BOX_MESH_CHANNELS = 5 };

typedef struct box_mesh {
	float *position, *channel; /* owned */
	uint32_t *index;           /* owned */
	size_t face_count, face_room;
} box_mesh;

/*
 * Adds a cube.
 *   low     its corner, metres in the surfels' frame
 *   faces   1 << face for each that is wanted, faces in the order +x -x +y -y +z -z
 * GW_ERROR_MEMORY.
 */
gw_status box_mesh_add(box_mesh *mesh, const float low[3], float size, const float color[3],
					   unsigned faces, gw_error *error);

/*
 * Adds one of the twelve edges of a cube, as a thin bar around it. It has no lines of its own.
 *   low    the cube's corner, metres in the surfels' frame
 *   edge   0 to 11: axis along which it goes, times four, and which of the four
 * GW_ERROR_MEMORY.
 */
gw_status box_mesh_add_edge(box_mesh *mesh, const float low[3], float size, unsigned edge,
							const float color[3], gw_error *error);

/*
 * Adds a disc, as an octagon around its circle's points.
 *   normal   unit
 *   radius   metres
 * GW_ERROR_MEMORY.
 */
gw_status box_mesh_add_disc(box_mesh *mesh, const float centre[3], const float normal[3],
							float radius, const float color[3], gw_error *error);

void box_mesh_clear(box_mesh *mesh);

/* The boxes as they are drawn; valid as long as the mesh stays unchanged. */
gw_raster_triangles box_mesh_triangles(const box_mesh *mesh);

#endif

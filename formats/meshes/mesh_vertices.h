/*
 * mesh_vertices.h - the vertices of a mesh file as points.
 *
 * OBJ, OFF and GLB files may hold points alone, and the vertices of meshes are points too.
 */
#ifndef MESH_VERTICES_H
#define MESH_VERTICES_H

#include "meshes/mesh.h"

/*
 * Fills a scan from the vertices of a mesh: x y z, float64; nx ny nz, float32, where each vertex
 * has a normal of its own; red green blue, uint8, where there are colours. The notes come along.
 *   faces   the file has faces, and a note says that they were left out
 *   cloud   on success owned by the caller; to be cleared on failure too
 */
gw_status mesh_vertices_put(const mesh *mesh, bool faces, scan *cloud, gw_error *error);

#endif

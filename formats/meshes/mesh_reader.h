/*
 * mesh_reader.h - a mesh from a file, whatever its format.
 */
#ifndef MESH_READER_H
#define MESH_READER_H

#include "meshes/mesh.h"

/* True when the name says that a file is a mesh, unless it has no faces: it ends in .obj or .glb.
 */
bool mesh_is_name(const char *path);

/* False when an OBJ or GLB file can be read and holds points only. */
bool mesh_has_faces(const char *path);

/*
 * Reads a mesh: PLY, OFF and GLB by their content, else OBJ with the MTL files that it names.
 *   path    "-" is standard input
 *   mesh    on success owned by the caller, freed with mesh_clear; empty on failure
 *   error   as input_file_open; GW_ERROR_DATA when the content is bad or there are no faces
 */
gw_status mesh_read(const char *path, mesh *mesh, gw_error *error);

#endif

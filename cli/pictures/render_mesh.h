/*
 * render_mesh.h - meshes in a picture: their triangles, in the light of the points on them.
 */
#ifndef RENDER_MESH_H
#define RENDER_MESH_H

#include "pictures/render_scene.h"

/*
 * Reads the meshes of --mesh, which is a mesh or a scene file with some, puts them into the scene,
 * and leaves the points on them out of the picture. Does nothing when none is asked for.
 *   scene   made, with its channels
 * Fails as scene_read and mesh_read; GW_ERROR_DATA for a scene file without a mesh.
 */
gw_status render_mesh_add(const settings *settings, render_scene *scene, gw_error *error);

#endif

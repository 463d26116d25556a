/*
 * octree_walk.glsl - what a shader needs to walk the octree: its specialisation constants.
 * octree_tiles.glsl (finding tiles) and octree_trace.glsl (rays) are included after the bindings.
 */
#ifndef OCTREE_WALK_GLSL
#define OCTREE_WALK_GLSL

#include "base/pass.glsl"
#include "octree/trace_constants.h"

CONSTANT(1, uint, depth, 8u);
CONSTANT(2, uint, directory_level, 7u);

#endif

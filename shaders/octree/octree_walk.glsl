/*
 * octree_walk.glsl - what a shader needs to walk the octree: its specialisation constants.
 * octree_tiles.glsl (finding tiles) and octree_trace.glsl (rays) are included after the bindings.
 */
#ifndef OCTREE_WALK_GLSL
#define OCTREE_WALK_GLSL

#include "octree/trace_constants.h"

layout(constant_id = 1) const uint depth = 8u;
layout(constant_id = 2) const uint directory_level = 7u;

#endif

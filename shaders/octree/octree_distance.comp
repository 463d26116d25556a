/*
 * octree_distance.comp - the directory of rays, of the distances of cells to the nearest one that
 * holds facets: see ray_directory in lib/octree/octree.h.
 */
#version 460
#extension GL_GOOGLE_include_directive : require

#include "octree/octree_layout.h"

layout(local_size_x_id = 0) in;

layout(binding = 0) uniform usamplerBuffer distance_of; /* 0: it holds facets itself */
layout(binding = 1) uniform usamplerBuffer level_directory;
layout(binding = 2) writeonly buffer Directory { uint ray_directory[]; }; /* windowed */

layout(push_constant) uniform Push { gw_distance_push push; };

void main()
{
	uint local = gl_GlobalInvocationID.x, cell = push.first + local;
	if (local >= push.count)
		return;
	uint entry = texelFetch(distance_of, int(cell)).x;
	if (entry == 0u) {
		uint offset = ((1u << (3u * push.level)) - 1u) / 7u;
		entry = 0x80000000u | (texelFetch(level_directory, int(offset + cell)).x - 1u);
	}
	ray_directory[local] = entry;
}

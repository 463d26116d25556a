/*
 * record_block.comp - the block that lists each record: the child tile of the octree cell of
 * push.block_level in which it lies, counted from that level's first tile. A record may stand off
 * its facet's leaf, where the octree has no such cell: then it is listed where its leaf lies.
 */
#version 460

#include "octree/octree_numbers.glsl"
#include "octree/octree_walk.glsl"
#include "light/transport_layout.h"

layout(local_size_x_id = 0) in;
layout(binding = 0) uniform usamplerBuffer level_directory;
layout(binding = 1) uniform usamplerBuffer node;
layout(binding = 2) readonly buffer Position
{
	vec4 record_position[];
};
layout(binding = 3) writeonly buffer Block
{
	uint record_block[];
};
layout(binding = 4) readonly buffer Facet
{
	uint record_facet[];
};
layout(binding = 5) uniform usamplerBuffer leaf_cell;
layout(binding = 6) uniform usamplerBuffer facet_leaf;
layout(push_constant) uniform Push
{
	gw_lookup_push push;
};

#include "octree/octree_tiles.glsl"

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	float size = exp2(float(depth - push.block_level));
	float cells = exp2(float(push.block_level));
	vec3 cell = clamp(floor(record_position[i].xyz / size), vec3(0.0), vec3(cells - 1.0));
	uint pointer = find_tile(uvec3(cell), push.block_level);
	if (pointer == 0u) {
		uint own = texelFetch(facet_leaf, int(record_facet[i] & ~GW_RECORD_BACK)).x;
		uvec3 leaf = texelFetch(leaf_cell, int(leaf_of(own))).xyz;
		pointer = find_tile(leaf >> (depth - push.block_level), push.block_level);
	}
	record_block[i] = pointer - 1u - push.tile_first;
}

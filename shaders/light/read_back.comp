/*
 * read_back.comp - the records each surfel's light is interpolated from, once for all lights:
 * GW_SURFEL_WEIGHTS at most, the heaviest, with weights that sum to 1. A row ends at GW_NONE.
 */
#version 460

#include "octree/octree_walk.glsl"
#include "light/transport_layout.h"

layout(local_size_x_id = 0) in;
layout(binding = 0) uniform usamplerBuffer ray_directory;
layout(binding = 1) uniform usamplerBuffer node;
layout(binding = 2) uniform usamplerBuffer leaf_tile;
layout(binding = 3) uniform samplerBuffer lobe_plane;
layout(binding = 4) uniform samplerBuffer lobe_centre;
layout(binding = 5) uniform usamplerBuffer level_directory;
layout(binding = 6) uniform samplerBuffer record_position;
layout(binding = 7) uniform samplerBuffer record_normal;
layout(binding = 8) uniform usamplerBuffer block_first;
layout(binding = 9) uniform usamplerBuffer block_record;
layout(binding = 10) uniform samplerBuffer surfel_position;
layout(binding = 11) uniform samplerBuffer surfel_normal;
layout(binding = 12) buffer Record
{
	uint row_record[];
};
layout(binding = 13) buffer Weight
{
	float row_weight[];
};
layout(binding = 14) uniform samplerBuffer surfel_reach;
layout(binding = 15) uniform usamplerBuffer disc_tree;
layout(push_constant) uniform Push
{
	gw_lookup_push push;
};

uint row, used;

void use_record(uint record, float weight)
{
	uint at = row + used;
	if (used < GW_SURFEL_WEIGHTS) {
		used++;
	} else {
		at = row;
		for (uint w = row; w < row + GW_SURFEL_WEIGHTS; w++)
			at = row_weight[w] < row_weight[at] ? w : at;
		if (row_weight[at] >= weight)
			return;
	}
	row_record[at] = record;
	row_weight[at] = weight;
}

#include "octree/octree_tiles.glsl"
#include "octree/octree_trace.glsl"
#include "octree/disc_tree.glsl"
#include "light/record_lookup.glsl"

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	row = i * GW_SURFEL_WEIGHTS;
	used = 0u;
	int surfel = int(push.surfel_first + push.first + i);
	vec4 normal = texelFetch(surfel_normal, surfel);
	reach = push.own_reach != 0u ? texelFetch(surfel_reach, surfel).x : push.radius;
	if (reach > 0.0)
		find_records(texelFetch(surfel_position, surfel).xyz, normal.xyz, normal.w > 0.5);
	float sum = 0.0;
	for (uint w = 0u; w < used; w++)
		sum += row_weight[row + w];
	for (uint w = 0u; w < used; w++)
		row_weight[row + w] /= sum;
	if (used < GW_SURFEL_WEIGHTS)
		row_record[row + used] = GW_NONE;
}

/*
 * lobe_weights.comp - the records each lobe's irradiance is interpolated from, once for all
 * bounces: the GW_WEIGHTS heaviest, with weights that sum to 1.
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
layout(binding = 10) buffer Record
{
	uint lobe_record[];
};
layout(binding = 11) buffer Weight
{
	float lobe_weight[];
};
layout(binding = 12) uniform samplerBuffer lobe_reach;
layout(binding = 13) uniform usamplerBuffer disc_tree;
layout(push_constant) uniform Push
{
	gw_lookup_push push;
};

uint row;

/* Keeps the heaviest; the row was filled with GW_NONE and 0. */
void use_record(uint record, float weight)
{
	uint lightest = row;
	for (uint w = row; w < row + GW_WEIGHTS; w++) {
		if (lobe_weight[w] < lobe_weight[lightest])
			lightest = w;
	}
	if (weight > lobe_weight[lightest]) {
		lobe_weight[lightest] = weight;
		lobe_record[lightest] = record;
	}
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
	row = i * GW_WEIGHTS;
	int slot = int(push.first + i);
	reach = push.own_reach != 0u ? texelFetch(lobe_reach, slot).x : push.radius;
	if (reach == 0.0)
		return; /* the row stays */
	for (uint w = 0u; w < GW_WEIGHTS; w++) {
		lobe_weight[row + w] = 0.0;
		lobe_record[row + w] = GW_NONE;
	}
	vec4 centre = texelFetch(lobe_centre, slot);
	if (centre.w <= 0.0 || find_records(centre.xyz, texelFetch(lobe_plane, slot).xyz, false) <= 0.0)
		return;
	float sum = 0.0;
	for (uint w = 0u; w < GW_WEIGHTS; w++)
		sum += lobe_weight[row + w];
	for (uint w = 0u; w < GW_WEIGHTS; w++)
		lobe_weight[row + w] /= sum;
}

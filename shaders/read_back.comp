/*
 * read_back.comp - irradiance at each surfel, interpolated from the records: what reached them
 * unreflected and what was reflected before. w of the first is 0 where no record was found.
 */
#version 460

#include "octree_walk.glsl"

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
layout(binding = 10) uniform samplerBuffer record_first;
layout(binding = 11) uniform samplerBuffer record_indirect;
layout(binding = 12) readonly buffer Position
{
	vec4 surfel_position[];
};
layout(binding = 13) readonly buffer Normal
{
	vec4 surfel_normal[];
};
layout(binding = 14) writeonly buffer First
{
	vec4 surfel_first[];
};
layout(binding = 15) writeonly buffer Indirect
{
	vec4 surfel_indirect[];
};
layout(push_constant) uniform Push
{
	gw_lookup_push push;
};

vec3 first_sum = vec3(0.0), indirect_sum = vec3(0.0);

void use_record(uint record, float weight)
{
	first_sum += weight * texelFetch(record_first, int(record)).xyz;
	indirect_sum += weight * texelFetch(record_indirect, int(record)).xyz;
}

#include "octree_tiles.glsl"
#include "octree_trace.glsl"
#include "record_lookup.glsl"

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	vec4 normal = surfel_normal[i];
	float sum = find_records(surfel_position[i].xyz, normal.xyz, normal.w > 0.5);
	float scale = sum > 0.0 ? 1.0 / sum : 0.0;
	surfel_first[i] = vec4(first_sum * scale, sum);
	surfel_indirect[i] = vec4(indirect_sum * scale, 0.0);
}

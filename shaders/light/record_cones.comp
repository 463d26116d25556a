/*
 * record_cones.comp - trace and shade step by cones: gathers the radiance in the brick pools over
 * each record's hemisphere (Salm 4.4.3, Crassin). The hemisphere is cut into strata of equal
 * cosine-weighted size; each is a cone of half the stratum's aperture.
 */
#version 460

#include "octree/octree_numbers.glsl"
#include "octree/octree_walk.glsl"
#include "light/transport_layout.h"
#include "base/sampling.glsl"

layout(local_size_x_id = 0) in;
layout(binding = 0) uniform usamplerBuffer level_directory;
layout(binding = 1) uniform usamplerBuffer node;
layout(binding = 2) uniform sampler3D leaf_pool;
layout(binding = 3) uniform sampler3D mip_pool;
layout(binding = 4) readonly buffer Position
{
	vec4 record_position[];
};
layout(binding = 5) readonly buffer Normal
{
	vec4 record_normal[];
};
layout(binding = 6) writeonly buffer Gathered
{
	vec4 record_gathered[];
};
layout(binding = 7) uniform usamplerBuffer leaf_tile;
layout(binding = 8) uniform samplerBuffer facet_plane;
layout(binding = 9) uniform samplerBuffer facet_albedo;
layout(binding = 10) uniform usamplerBuffer record_mark; /* if push.apart */
layout(push_constant) uniform Push
{
	gw_cone_push push;
};

#include "light/brick_cones.glsl"

/* Does a record lie on a facet that lets light through? */
bool is_on_clear(vec3 place, vec3 normal)
{
	uvec3 cell = uvec3(clamp(place, vec3(0.0), vec3(exp2(float(depth)) - 1.0)));
	uint tile = dark_facet != 0u ? find_tile(cell >> 1, depth - 1u) : 0u;
	if (tile == 0u)
		return false;
	uint octant = (cell.x & 1u) | (cell.y & 1u) << 1 | (cell.z & 1u) << 2;
	uvec2 entry = texelFetch(leaf_tile, int(tile - 1u)).xy;
	uint first = first_facet(entry, octant);
	bool clear = false;
	for (uint s = 0u; s < 2u; s++) {
		int facet = int(first + s);
		bool there = ((entry.y >> (8u + 8u * s + octant)) & 1u) != 0u;
		if (there && dot(texelFetch(facet_plane, facet).xyz, normal) > 0.0)
			clear = clear || fract(texelFetch(facet_albedo, facet).w) > 0.0;
	}
	return clear;
}

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	vec3 normal = record_normal[i].xyz;
	float open = record_normal[i].w; /* less than 1 if buried */
	if (push.apart != 0u && texelFetch(record_mark, int(push.first + i)).x != push.mark)
		return;
	vec3 origin = record_position[i].xyz + 0.5 * normal;
	if (is_on_clear(record_position[i].xyz, normal))
		start_on_sheet(record_position[i].xyz, normal);
	float turn = unit_float(pcg_hash2(pcg_hash_place(record_position[i].xyz), push.seed));
	vec3 sum = vec3(0.0);
	for (uint c = 0u; c < push.cones; c++) {
		float cosine;
		vec3 direction = disc_to_hemisphere(spiral_disc(c, push.cones, 0.5, turn), normal, cosine);
		/* A stratum is pi / cones of projected solid angle. */
		float solid_angle = min(GW_PI / (float(push.cones) * max(cosine, 0.05)), 2.0 * GW_PI * 0.9);
		float c_half = 1.0 - solid_angle / (2.0 * GW_PI);
		float tangent = 0.5 * sqrt(max(0.0, 1.0 - c_half * c_half)) / c_half;
		float left;
		vec3 seen = trace_cone(origin, direction, tangent, left);
		sum += seen + left * push.sky.xyz;
	}
	record_gathered[i] = vec4(sum * open * (GW_PI / float(push.cones)), 0.0);
}

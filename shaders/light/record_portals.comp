/*
 * record_portals.comp - which of the samples that a record takes of the portals leave
 * the scene: a bit each. Like hits they serve every sky.
 */
#version 460

#include "light/transport_layout.h"
#include "octree/octree_walk.glsl"
#include "base/sampling.glsl"

layout(local_size_x_id = 0) in;
layout(binding = 0) uniform usamplerBuffer ray_directory;
layout(binding = 1) uniform usamplerBuffer node;
layout(binding = 2) uniform usamplerBuffer leaf_tile;
layout(binding = 3) uniform samplerBuffer facet_plane;
layout(binding = 4) uniform samplerBuffer facet_centre;
layout(binding = 5) uniform samplerBuffer record_position;
layout(binding = 6) uniform samplerBuffer record_normal;
layout(binding = 7) uniform samplerBuffer portal;
layout(binding = 8) writeonly buffer Through
{
	uint sky_seen[];
};
layout(binding = 9) uniform usamplerBuffer leaf_fragment;
layout(binding = 10) uniform usamplerBuffer fragment_surfel;
layout(binding = 11) uniform samplerBuffer surfel_place;
layout(binding = 12) uniform samplerBuffer surfel_facing;
layout(binding = 13) uniform samplerBuffer surfel_disc;
layout(binding = 14) uniform samplerBuffer surfel_clip;
layout(binding = 15) uniform usamplerBuffer disc_tree;
layout(binding = 16) uniform samplerBuffer facet_albedo;
layout(push_constant) uniform Push
{
	gw_record_push push;
};

#define TRACE_OPACITY
#include "octree/octree_discs.glsl"
#include "octree/trace.glsl"
#include "light/portals.glsl"

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	int record = int(push.first + i);
	vec3 g = texelFetch(record_position, record).xyz;
	vec3 normal = texelFetch(record_normal, record).xyz;
	float total = portals_weight(g, normal), passed = 0.0;
	uint own = portals_random(g), seen = 0u;
	int j = 0;
	for (uint m = 0u; m < GW_PORTAL_SAMPLES && total > 0.0; m++) {
		vec3 direction = portals_direction(g, normal, m, total, own, j, passed);
		Ray ray = { g, direction, normal, g, GW_FAR, false };
		float through, chance = stratified(pcg_hash2(own, GW_OPACITY_SEED), m);
		if (dot(direction, normal) > 0.0 && trace_through(ray, chance, through).facet == GW_NONE)
			seen |= 1u << m;
	}
	sky_seen[i] = seen;
}

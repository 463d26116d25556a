/*
 * record_rays.comp - trace step of the records: one gather ray an invocation, cosine-weighted over
 * the record's hemisphere. What was hit is kept; the hits of a record serve all bounces, because
 * geometry does not change between them.
 */
#version 460

#include "octree/octree_walk.glsl"
#include "light/transport_layout.h"
#include "base/sampling.glsl"

layout(local_size_x_id = 0) in;
layout(binding = 0) uniform usamplerBuffer ray_directory;
layout(binding = 1) uniform usamplerBuffer node;
layout(binding = 2) uniform usamplerBuffer leaf_tile;
layout(binding = 3) uniform samplerBuffer lobe_plane;
layout(binding = 4) uniform samplerBuffer lobe_centre;
layout(binding = 5) uniform samplerBuffer record_position;
layout(binding = 6) uniform samplerBuffer record_normal;
layout(binding = 7) writeonly buffer Lobe
{
	uint hit_lobe[];
};
layout(binding = 8) writeonly buffer Distance
{
	float hit_distance[];
};
layout(binding = 9) uniform usamplerBuffer leaf_fragment;
layout(binding = 10) uniform usamplerBuffer fragment_surfel;
layout(binding = 11) uniform samplerBuffer surfel_place;
layout(binding = 12) uniform samplerBuffer surfel_facing;
layout(binding = 13) uniform samplerBuffer surfel_disc;
layout(binding = 14) uniform samplerBuffer surfel_clip;
layout(binding = 15) uniform usamplerBuffer disc_tree;
layout(push_constant) uniform Push
{
	gw_record_push push;
};

#include "octree/octree_discs.glsl"
#include "octree/octree_trace.glsl"
#include "octree/disc_tree.glsl"
#include "light/record_ray.glsl"

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	uint ray = push.first + i;
	uint record = ray / push.rays;
	vec3 g = texelFetch(record_position, int(record)).xyz;
	vec3 normal = texelFetch(record_normal, int(record)).xyz;
	float cosine;
	vec3 direction = record_ray(g, normal, ray % push.rays, cosine);
	uint lobe;
	float t;
	bool behind;
	bool hit = trace(g, tangent_plane_at(g, normal), direction, 1e9, false, lobe, t, behind);
	hit_lobe[i] = hit ? lobe : GW_NONE;
	/* Negative: the ray passed the back of a surface on its way. */
	hit_distance[i] = (hit ? t : 1e9) * (behind ? -1.0 : 1.0);
}

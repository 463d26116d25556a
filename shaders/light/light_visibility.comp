/*
 * light_visibility.comp - which share of a light each surfel sees, by shadow rays.
 *
 * One invocation a surfel. A light without extent gets one ray; one with a radius gets
 * push.samples rays to points spread over the disc that it shows: first to its rim, and to the rest
 * of it only where some of these see it and some do not. GW_HIDDEN_BY_CREASE is added
 * where what hides the light ends at creases.
 */
#version 460

#include "octree/octree_layout.h"
#include "octree/octree_walk.glsl"
#include "light/transport_layout.h"
#include "base/sampling.glsl"

layout(local_size_x_id = 0) in;
layout(binding = 0) uniform usamplerBuffer ray_directory;
layout(binding = 1) uniform usamplerBuffer node;
layout(binding = 2) uniform usamplerBuffer leaf_tile;
layout(binding = 3) uniform samplerBuffer lobe_plane;
layout(binding = 4) uniform samplerBuffer lobe_centre;
layout(binding = 5) readonly buffer Position
{
	vec4 surfel_position[];
};
layout(binding = 6) readonly buffer Normal
{
	vec4 surfel_normal[];
};
layout(binding = 7) buffer Visibility
{
	float visibility[];
};
layout(binding = 8) uniform usamplerBuffer leaf_fragment;
layout(binding = 9) uniform usamplerBuffer fragment_surfel;
layout(binding = 10) uniform samplerBuffer surfel_place;
layout(binding = 11) uniform samplerBuffer surfel_facing;
layout(binding = 12) uniform samplerBuffer surfel_disc;
layout(binding = 13) uniform samplerBuffer surfel_clip;
layout(binding = 14) uniform usamplerBuffer disc_tree;
layout(push_constant) uniform Push
{
	gw_light_push push;
};

#include "octree/octree_discs.glsl"
#include "octree/octree_trace.glsl"
#include "octree/disc_tree.glsl"
#include "light/light.glsl"

/* Do most of the discs in the lobe's leaf that end there do so at a crease? */
bool ends_at_crease(uint lobe)
{
	uint last = texelFetch(leaf_fragment, int(lobe >> 1) + 1).x;
	int votes = 0;
	for (uint f = texelFetch(leaf_fragment, int(lobe >> 1)).x; f < last; f++) {
		int surfel = int(texelFetch(fragment_surfel, int(f)).x & GW_FRAGMENT_SURFEL);
		if (texelFetch(surfel_disc, surfel).zw != vec2(0.0))
			votes += texelFetch(surfel_facing, surfel).w < -0.5 ? 1 : -1;
	}
	return votes > 0;
}

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	vec3 g = surfel_position[i].xyz;
	vec4 normal = surfel_normal[i];
	float seen = 0.0, hidden = 0.0;
	float distance;
	vec3 towards;
	if (light_cosine(g, normal, light_irradiance(g, towards, distance), towards) > 0.0) {
		/* The ray leaves the surface behind the noise; the normal is the point's own. */
		vec3 facing = texelFetch(surfel_facing, int(push.first + i)).xyz;
		facing = dot(normal.xyz, towards) < 0.0 ? -facing : facing;
		float turn = unit_float(hash2(push.first + i, push.seed));
		vec3 t, b;
		tangent_frame(towards, t, b);
		uint rays = push.samples;
		for (uint s = 0u; s < rays; s++) {
			vec2 p = push.samples > 1u
						 ? spiral_disc(push.samples - 1u - s, push.samples, 0.5, turn)
						 : vec2(0.0);
			vec3 offset = (t * p.x + b * p.y) *
						  (push.type == GW_PUSH_SUN ? push.direction.w : push.position.w);
			vec3 to = push.type == GW_PUSH_SUN ? towards + offset : towards * distance + offset;
			float range = push.type == GW_PUSH_SUN ? 1e9 : length(to);
			uint lobe;
			float t_hit;
			bool behind;
			if (!trace(g, tangent_plane_at(g, facing), normalize(to), range, true, lobe, t_hit,
					   behind))
				seen += 1.0;
			else if (ends_at_crease(lobe))
				hidden = GW_HIDDEN_BY_CREASE;
			if (s + 1u == GW_LIGHT_RIM && (seen == 0.0 || seen == float(GW_LIGHT_RIM)))
				rays = GW_LIGHT_RIM;
		}
		seen /= float(rays);
	}
	visibility[i] = seen + hidden;
}

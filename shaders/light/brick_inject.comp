/*
 * brick_inject.comp - fills the leaf pool: one invocation a voxel of a brick, its redundant
 * positive boundary included (Salm 4.3.1, 4.4.1). Each facet shows area * max(0, n . face) to a
 * face; one-sided, so that a surface never darkens itself, but for what lets light through; `gain`
 * over-covers, so that a wall sampled by scattered points lets nothing through. What lets light
 * through also has a back, which nobody takes for the inside of something: dark, unless it is lit
 * from both sides.
 */
#version 460

#include "light/transport_layout.h"
#include "octree/octree_numbers.glsl"

layout(local_size_x_id = 0) in;
layout(binding = 0) uniform usamplerBuffer leaf_tile;
layout(binding = 1) uniform usamplerBuffer leaf_tile_neighbour;
layout(binding = 2) uniform samplerBuffer facet_plane;
layout(binding = 3) uniform samplerBuffer facet_centre;
layout(binding = 4) uniform samplerBuffer facet_radiance;
layout(binding = 5, rgba16f) uniform writeonly image3D leaf_pool;
layout(binding = 6) uniform samplerBuffer facet_albedo;
layout(binding = 7) uniform usamplerBuffer facet_mark; /* if push.apart */
layout(constant_id = 5) const uint dark_facet = 0u;
layout(push_constant) uniform Push
{
	gw_cone_push push;
};

#include "light/brick_pool.glsl"

bool lets_through(int facet)
{
	return fract(texelFetch(facet_albedo, facet).w) > 0.0;
}

bool is_lit_from_both(int facet)
{
	float sides = floor(texelFetch(facet_albedo, facet).w);
	return sides == 1.0 || sides == GW_FACET_FOLIAGE;
}

/* What of a facet a cone meets. Of one that lets light through exactly its covered share: it must
 * not be over-covered. Each face shows |n_k| of it, front or back, and so to a direction d the sum
 * of |n_k d_k|, where it covers |n . d|: for all directions together |n_x| + |n_y| + |n_z| times
 * too much. But no cone finds more than everything covered, so that the more a facet covers the
 * less of this is too much, and what is opaque needs none of it: of leaning sheets of opacities
 * from 0.1 to 0.9, the power that follows leaves within a tenth of what they cover. */
float shown_share(int facet)
{
	float clear = fract(texelFetch(facet_albedo, facet).w);
	vec3 leans = abs(texelFetch(facet_plane, facet).xyz);
	return clear > 0.0 ? (1.0 - clear) / push.gain * pow(leans.x + leans.y + leans.z, -sqrt(clear))
					   : 1.0;
}

/* What faces another compartment is met, but dark. */
bool is_dark(int facet)
{
	uint mark = push.apart != 0u ? texelFetch(facet_mark, facet).x : 0u;
	return mark != 0u && push.mark != 0u && mark != push.mark;
}

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	uint element = push.first + i;
	uint brick = element / 27u, v = element % 27u;
	uvec3 voxel = uvec3(v % 3u, v / 3u % 3u, v / 9u);
	uint side = (voxel.x >> 1) | (voxel.y >> 1) << 1 | (voxel.z >> 1) << 2;
	uint octant = (voxel.x & 1u) | (voxel.y & 1u) << 1 | (voxel.z & 1u) << 2;
	uint tile = texelFetch(leaf_tile_neighbour, int(8u * brick + side)).x;
	uvec2 entry = tile == 0u ? uvec2(0u) : texelFetch(leaf_tile, int(tile - 1u)).xy;
	bool exists = ((entry.y >> (8u + octant)) & 1u) != 0u;
	ivec3 corner = brick_corner(brick, push.leaf_bricks[0], push.leaf_bricks[1]) + ivec3(voxel);

	vec4 radiance[2], back[2];
	vec3 facing[2];
	for (uint s = 0u; s < 2u; s++) {
		int facet = int(first_facet(entry, octant) + s);
		bool there = exists && (s == 0u || has_second(entry, octant));
		vec3 sent = there && !is_dark(facet) ? texelFetch(facet_radiance, facet).xyz : vec3(0.0);
		radiance[s] = there ? vec4(sent * push.scale, 1.0) : vec4(0.0);
		facing[s] =
			there ? texelFetch(facet_plane, facet).xyz * texelFetch(facet_centre, facet).w
				  : vec3(0.0);
		back[s] = vec4(0.0);
		if (dark_facet == 0u || !there)
			continue;
		facing[s] *= shown_share(facet);
		if (lets_through(facet))
			back[s] = is_lit_from_both(facet) ? radiance[s] : vec4(0.0, 0.0, 0.0, 1.0);
	}
	for (int f = 0; f < 6; f++) {
		vec4 shown = vec4(0.0);
		for (uint s = 0u; s < 2u; s++) {
			float toward = dot(facing[s], FACE_NORMAL[f]);
			shown += toward > 0.0 ? toward * radiance[s] : -toward * back[s];
		}
		imageStore(leaf_pool, corner + ivec3(0, 0, f * int(push.leaf_face_depth)),
				   min(shown * push.gain, vec4(65504.0)));
	}
}

/*
 * brick_mipmap.comp - fills the mipmap pool for one level: one invocation a voxel of a brick, its
 * redundant boundary included (Salm 4.4.2). F and G are areas per cell area, so a voxel is the sum
 * of its eight children over four.
 */
#version 460

#include "light/transport_layout.h"

layout(local_size_x_id = 0) in;
layout(binding = 0) uniform usamplerBuffer node;
layout(binding = 1) uniform usamplerBuffer tile_neighbour;
layout(binding = 2, rgba16f) uniform readonly image3D leaf_pool;
layout(binding = 3, rgba16f) uniform image3D mip_pool;
layout(push_constant) uniform Push
{
	gw_cone_push push;
};

#include "light/brick_pool.glsl"

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	uint element = push.first + i;
	uint brick = push.tile_first + element / 27u, v = element % 27u;
	uvec3 voxel = uvec3(v % 3u, v / 3u % 3u, v / 9u);
	uint side = (voxel.x >> 1) | (voxel.y >> 1) << 1 | (voxel.z >> 1) << 2;
	uint octant = (voxel.x & 1u) | (voxel.y & 1u) << 1 | (voxel.z & 1u) << 2;
	uint tile = texelFetch(tile_neighbour, int(8u * brick + side)).x;
	uint child = tile == 0u ? 0u : texelFetch(node, int(8u * (tile - 1u) + octant)).x;
	ivec3 corner = brick_corner(brick, push.mip_bricks[0], push.mip_bricks[1]) + ivec3(voxel);

	bool leaves = push.from_leaves != 0u;
	ivec3 from = child == 0u ? ivec3(0)
				 : leaves    ? brick_corner(child - 1u, push.leaf_bricks[0], push.leaf_bricks[1])
							 : brick_corner(child - 1u, push.mip_bricks[0], push.mip_bricks[1]);
	for (int f = 0; f < 6; f++) {
		vec4 sum = vec4(0.0);
		if (child != 0u) {
			ivec3 face =
				from + ivec3(0, 0, f * int(leaves ? push.leaf_face_depth : push.mip_face_depth));
			for (int c = 0; c < 8; c++) {
				ivec3 at = face + ivec3(c & 1, (c >> 1) & 1, c >> 2);
				sum += leaves ? imageLoad(leaf_pool, at) : imageLoad(mip_pool, at);
			}
		}
		imageStore(mip_pool, corner + ivec3(0, 0, f * int(push.mip_face_depth)),
				   min(sum * 0.25, vec4(65504.0)));
	}
}

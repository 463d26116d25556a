/*
 * cell_bricks.comp - what one voxel of the brick pools shows to one side: one invocation a cell.
 * rgb is the mean radiance, w the area shown, in faces of the cell.
 */
#version 460

#include "octree/octree_walk.glsl"
#include "light/transport_layout.h"

layout(local_size_x_id = 0) in;
layout(binding = 0) uniform usamplerBuffer level_directory;
layout(binding = 1) uniform usamplerBuffer node;
layout(binding = 2) uniform sampler3D leaf_pool;
layout(binding = 3) uniform sampler3D mip_pool;
layout(binding = 4) readonly buffer Centre
{
	vec4 cell_centre[]; /* grid coordinates */
};
layout(binding = 5) writeonly buffer Shown
{
	vec4 cell_shown[];
};
layout(push_constant) uniform Push
{
	gw_cone_push push; /* level: how many above the leaves; eye: the side, a unit vector */
};

#include "light/brick_cones.glsl"

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	vec4 shown = sample_level(cell_centre[i].xyz, -push.eye.xyz, push.level);
	shown.w *= exp2(float(push.level));
	float scale = shown.w > 0.0 ? exp2(float(push.level)) / (shown.w * push.scale) : 0.0;
	cell_shown[i] = vec4(shown.xyz * scale, shown.w);
}

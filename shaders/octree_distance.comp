/*
 * octree_distance.comp - chessboard distance to the nearest marked cell, one axis a run.
 *
 * max(|dx|, |dy|, |dz|) is minimised one axis after the other: along x, the distance to the nearest
 * mark in the row; along y and z, the least of max(distance of a cell, steps to it). The last run
 * makes the directory of it: see ray_directory in lib/octree.h.
 */
#version 460
#extension GL_GOOGLE_include_directive : require

#include "octree_layout.h"

layout(local_size_x_id = 0) in;

layout(binding = 0) uniform usamplerBuffer before; /* axis 0: marks; else distances */
layout(binding = 1) uniform usamplerBuffer level_directory;
layout(binding = 2) writeonly buffer After { uint after[]; }; /* windowed */

layout(push_constant) uniform Push { gw_distance_push push; };

const uint FAR = 255u;

uint read(int cell)
{
	uint value = texelFetch(before, cell).x;
	return push.axis > 0u ? value : value != 0u ? 0u : FAR;
}

void main()
{
	uint local = gl_GlobalInvocationID.x, cell = push.first + local;
	if (local >= push.count)
		return;
	int stride = 1 << (push.level * push.axis), side = 1 << push.level;
	int at = int(cell >> (push.level * push.axis)) & (side - 1);
	uint best = read(int(cell));
	for (int step = 1; step < side && uint(step) < best; step++) {
		if (at >= step)
			best = min(best, max(uint(step), read(int(cell) - step * stride)));
		if (at + step < side)
			best = min(best, max(uint(step), read(int(cell) + step * stride)));
	}
	if (push.axis == 2u && best == 0u) {
		uint offset = ((1u << (3u * push.level)) - 1u) / 7u;
		best = 0x80000000u | (texelFetch(level_directory, int(offset + cell)).x - 1u);
	}
	after[local] = best;
}

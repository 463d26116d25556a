/*
 * record_lookup.glsl - read-back step: which records speak for a point, and how much.
 *
 * Records are listed by the octree cell ("block") they lie in; blocks within the point's reach are
 * looked at. A record's weight falls with its distance, the angle between the normals and
 * the distance of the point to the record's plane (after Ward); a record that a wall separates
 * from the point counts nothing, which is tested only where something is nearer to the record than
 * the point is.
 *
 * The including shader binds row_record and row_weight, of which ROW_WIDTH a point, and sets `row`,
 * the first of a point's, `used` to 0, and `reach`, at most push.radius.
 */
#ifndef RECORD_LOOKUP_GLSL
#define RECORD_LOOKUP_GLSL

#include "octree/octree_tiles.glsl"
#include "octree/trace.glsl"

/* What a buried record counts beside one that is not: one that lies in a crevice of noise says
 * nothing of the surface, and only where all around are buried there is something solid. */
#define BURIED_WEIGHT 1e-3f

uint row, used; /* how many of the row are filled */
float reach;    /* how far the point looks for records, leaf cells */

/* The point that looks. */
struct Seeker {
	vec3 g, normal;
	bool both_sides;
};

/* Where a record would go into the row: it has room, or else in place of the lightest. */
uint place_in_row()
{
	if (used < ROW_WIDTH)
		return row + used;
	uint at = row;
	for (uint w = row + 1u; w < row + ROW_WIDTH; w++)
		at = row_weight[w] < row_weight[at] ? w : at;
	return at;
}

float record_weight(IN(Seeker) seeker, vec3 off, vec3 facing)
{
	float alignment = dot(seeker.normal, facing);
	if (seeker.both_sides)
		alignment = abs(alignment);
	float squared = dot(off, off) / (reach * reach);
	float plane = abs(dot(off, facing)) / (0.3f * reach);
	if (squared >= 1.0f || plane >= 1.0f || alignment < 0.7f)
		return 0.0f;
	float near = (1.0f - squared) * (1.0f - squared);
	float aligned = alignment * alignment;
	aligned *= aligned;
	return near * aligned * aligned * (1.0f - plane);
}

bool record_visible(IN(Seeker) seeker, vec4 record, vec3 facing)
{
	vec3 from = seeker.g + seeker.normal * push.ray_offset;
	vec3 to = record.xyz + facing * push.ray_offset - from;
	float distance = length(to);
	if (push.visibility == 0u || distance < record.w || distance < 1e-4f)
		return true;
	Ray ray = { from, to * (1.0f / distance), seeker.normal, seeker.g, distance, true };
	return trace(ray).facet == GW_NONE;
}

/* First and last of the records of a block; none where the octree has no such block, or all of it
 * is farther from g than `limit`. */
uvec2 block_span(ivec3 cell, vec3 g, float size, float limit)
{
	int cells = 1 << push.block_level;
	vec3 off = g - (vec3(cell) + 0.5f) * size;
	vec3 outside = vec3(max(abs(off.x) - 0.5f * size, 0.0f), max(abs(off.y) - 0.5f * size, 0.0f),
						max(abs(off.z) - 0.5f * size, 0.0f));
	if (dot(outside, outside) >= limit * limit || min(cell.x, min(cell.y, cell.z)) < 0 ||
		max(cell.x, max(cell.y, cell.z)) >= cells)
		return uvec2(0u);
	uint pointer = find_tile(uvec3(cell), push.block_level);
	if (pointer == 0u)
		return uvec2(0u);
	int block = int(pointer - 1u - push.tile_first);
	return uvec2(texelFetch(block_first, block).x, texelFetch(block_first, block + 1).x);
}

void weigh_block(IN(Seeker) seeker, uvec2 span)
{
	for (uint r = span.x; r < span.y; r++) {
		uint record = texelFetch(block_record, int(r)).x;
		vec4 position = texelFetch(record_position, int(record));
		vec3 off = seeker.g - position.xyz;
		if (dot(off, off) >= reach * reach)
			continue;
		vec4 facing = texelFetch(record_normal, int(record));
		float weight = record_weight(seeker, off, facing.xyz);
		weight *= facing.w < 1.0f ? BURIED_WEIGHT : 1.0f;
		if (!(weight > 0.0f))
			continue;
		/* Whether something stands between is dear to find out. */
		uint at = place_in_row();
		if ((used == ROW_WIDTH && row_weight[at] >= weight) ||
			!record_visible(seeker, position, facing.xyz))
			continue;
		used = min(used + 1u, ROW_WIDTH);
		row_record[at] = record;
		row_weight[at] = weight;
	}
}

/* The nearest record, by a cost that grows with the angle between the normals, becomes the row's
 * first; its weight is that cost. */
void find_nearest(IN(Seeker) seeker, uvec2 span)
{
	for (uint r = span.x; r < span.y; r++) {
		uint record = texelFetch(block_record, int(r)).x;
		vec3 off = seeker.g - texelFetch(record_position, int(record)).xyz;
		vec3 facing = texelFetch(record_normal, int(record)).xyz;
		float cost = length(off) * (1.5f - dot(seeker.normal, facing));
		if (used == 0u ? cost < 1e30f : cost < row_weight[row]) {
			used = 1u;
			row_record[row] = record;
			row_weight[row] = cost;
		}
	}
}

/* Looks at the blocks that `within` reaches into, x first: weighs all records of those within
 * reach, or finds the nearest. */
void look_at_blocks(IN(Seeker) seeker, float within, bool nearest)
{
	float size = float(1u << (depth - push.block_level));
	ivec3 low = ivec3(floor((seeker.g - within) / size));
	ivec3 high = ivec3(floor((seeker.g + within) / size));
	for (int z = low.z; z <= high.z; z++)
		for (int y = low.y; y <= high.y; y++)
			for (int x = low.x; x <= high.x; x++) {
				uvec2 span = block_span(ivec3(x, y, z), seeker.g, size, nearest ? 1e9f : reach);
				if (nearest)
					find_nearest(seeker, span);
				else
					weigh_block(seeker, span);
			}
}

/* Fills the row, and makes its weights sum to 1; where no record qualifies, with the nearest in the
 * blocks within push.radius. */
void find_records(IN(Seeker) seeker)
{
	look_at_blocks(seeker, reach, false);
	if (used == 0u) {
		look_at_blocks(seeker, push.radius, true);
		if (used > 0u)
			row_weight[row] = 1.0f;
	}
	float sum = 0.0f;
	for (uint w = row; w < row + used; w++)
		sum += row_weight[w];
	for (uint w = row; w < row + used; w++)
		row_weight[w] /= sum;
}

#endif

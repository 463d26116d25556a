/*
 * record_lookup.glsl - read-back step: which records speak for a point, and how much.
 *
 * Records are listed by the octree cell ("block") they lie in; blocks within the point's reach are
 * looked at. A record's weight falls with its distance, the angle between the normals and
 * the distance of the point to the record's plane (after Ward); a record that a wall separates
 * from the point counts nothing, which is tested only where something is nearer to the record than
 * the point is.
 *
 * The including shader defines `void use_record(uint record, float weight)` and sets `reach`, at
 * most push.radius, for each point; find_records calls it for each record with a weight above 0 and
 * returns the sum of the weights. When no record qualifies it calls it for the nearest record of
 * the blocks within push.radius, with weight 1; when there is none it returns 0.
 */
#ifndef RECORD_LOOKUP_GLSL
#define RECORD_LOOKUP_GLSL

float reach; /* how far the point looks for records, leaf cells */

float record_weight(vec3 g, vec3 normal, bool both_sides, vec3 record, vec3 record_facing)
{
	vec3 off = g - record;
	float alignment = dot(normal, record_facing);
	if (both_sides)
		alignment = abs(alignment);
	float squared = dot(off, off) / (reach * reach);
	float plane = abs(dot(off, record_facing)) / (0.3 * reach);
	if (squared >= 1.0 || plane >= 1.0 || alignment < 0.7)
		return 0.0;
	float near = (1.0 - squared) * (1.0 - squared);
	float aligned = alignment * alignment;
	aligned *= aligned;
	return near * aligned * aligned * (1.0 - plane);
}

bool record_visible(vec3 g, vec3 normal, vec4 record, vec3 record_facing)
{
	vec3 to = record.xyz + record_facing * push.lift - (g + normal * push.lift);
	float distance = length(to);
	if (push.visibility == 0u || distance < record.w || distance < 1e-4)
		return true;
	uint lobe;
	float t;
	bool behind;
	return !trace(g + normal * push.lift, tangent_plane_at(g, normal), to / distance, distance,
				  true, lobe, t, behind);
}

/* First and last of the records of a block; none where the octree has no such block, or all of it
 * is farther from g than `limit`. */
uvec2 block_span(ivec3 cell, vec3 g, float size, float limit)
{
	int cells = 1 << push.block_level;
	vec3 outside = max(abs(g - (vec3(cell) + 0.5) * size) - 0.5 * size, 0.0);
	if (dot(outside, outside) >= limit * limit || any(lessThan(cell, ivec3(0))) ||
		any(greaterThanEqual(cell, ivec3(cells))))
		return uvec2(0u);
	uint pointer = find_tile(uvec3(cell), push.block_level);
	if (pointer == 0u)
		return uvec2(0u);
	int block = int(pointer - 1u - push.tile_first);
	return uvec2(texelFetch(block_first, block).x, texelFetch(block_first, block + 1).x);
}

/* The n-th block of those that `within` reaches into from g, x first; their number a side. */
ivec3 nth_block(vec3 g, float size, float within, int n, out int count)
{
	ivec3 low = ivec3(floor((g - within) / size));
	ivec3 side = ivec3(floor((g + within) / size)) - low + 1;
	count = side.x * side.y * side.z;
	return low + ivec3(n % side.x, n / side.x % side.y, n / (side.x * side.y));
}

uint nearest_record(vec3 g, vec3 normal, float size)
{
	uint nearest = GW_NONE;
	float nearest_cost = 1e30;
	int count;
	nth_block(g, size, push.radius, 0, count);
	for (int n = 0; n < count; n++) {
		uvec2 span = block_span(nth_block(g, size, push.radius, n, count), g, size, 1e9);
		for (uint r = span.x; r < span.y; r++) {
			uint record = texelFetch(block_record, int(r)).x;
			vec3 position = texelFetch(record_position, int(record)).xyz;
			vec3 facing = texelFetch(record_normal, int(record)).xyz;
			float cost = distance(g, position) * (1.5 - dot(normal, facing));
			if (cost < nearest_cost) {
				nearest_cost = cost;
				nearest = record;
			}
		}
	}
	return nearest;
}

float find_records(vec3 g, vec3 normal, bool both_sides)
{
	float size = exp2(float(depth - push.block_level)), sum = 0.0;
	int count;
	nth_block(g, size, reach, 0, count);
	for (int n = 0; n < count; n++) {
		uvec2 span = block_span(nth_block(g, size, reach, n, count), g, size, reach);
		for (uint r = span.x; r < span.y; r++) {
			uint record = texelFetch(block_record, int(r)).x;
			vec4 position = texelFetch(record_position, int(record));
			vec3 off = g - position.xyz;
			if (dot(off, off) >= reach * reach)
				continue;
			vec3 facing = texelFetch(record_normal, int(record)).xyz;
			float weight = record_weight(g, normal, both_sides, position.xyz, facing);
			if (weight > 0.0 && record_visible(g, normal, position, facing)) {
				use_record(record, weight);
				sum += weight;
			}
		}
	}
	if (sum == 0.0) {
		uint nearest = nearest_record(g, normal, size);
		if (nearest != GW_NONE) {
			use_record(nearest, 1.0);
			sum = 1.0;
		}
	}
	return sum;
}

#endif

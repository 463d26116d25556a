/*
 * record_lookup.glsl - read-back step: which records speak for a point, and how much.
 *
 * Records are listed by the octree cell ("block") they lie in; a block is at least two radii of
 * influence wide, so the 2x2x2 blocks around a point hold all that can matter. A record's weight
 * falls with its distance, the angle between the normals and the distance of the point to the
 * record's plane (after Ward); a record that a wall separates from the point counts nothing, which
 * is tested only where something is nearer to the record than the point is.
 *
 * The including shader defines `void use_record(uint record, float weight)`; find_records calls it
 * for each record with a weight above 0 and returns the sum of the weights. When no record
 * qualifies it calls it for the nearest record of the blocks, with weight 1; when there is none it
 * returns 0.
 */
#ifndef RECORD_LOOKUP_GLSL
#define RECORD_LOOKUP_GLSL

float record_weight(vec3 g, vec3 normal, bool both_sides, vec3 record, vec3 record_facing)
{
	vec3 off = g - record;
	float alignment = dot(normal, record_facing);
	if (both_sides)
		alignment = abs(alignment);
	float squared = dot(off, off) / (push.radius * push.radius);
	float plane = abs(dot(off, record_facing)) / (0.3 * push.radius);
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

float find_records(vec3 g, vec3 normal, bool both_sides)
{
	float size = exp2(float(depth - push.block_level));
	ivec3 base = ivec3(floor(g / size - 0.5));
	int cells = 1 << push.block_level;
	float sum = 0.0;
	uint nearest = GW_NONE;
	float nearest_cost = 1e30;
	for (int corner = 0; corner < 8; corner++) {
		ivec3 cell = base + ivec3(corner & 1, (corner >> 1) & 1, corner >> 2);
		if (any(lessThan(cell, ivec3(0))) || any(greaterThanEqual(cell, ivec3(cells))))
			continue;
		uint pointer = find_tile(uvec3(cell), push.block_level);
		if (pointer == 0u)
			continue;
		int block = int(pointer - 1u - push.tile_first);
		uint last = texelFetch(block_first, block + 1).x;
		for (uint r = texelFetch(block_first, block).x; r < last; r++) {
			uint record = texelFetch(block_record, int(r)).x;
			vec4 position = texelFetch(record_position, int(record));
			vec3 facing = texelFetch(record_normal, int(record)).xyz;
			float weight = record_weight(g, normal, both_sides, position.xyz, facing);
			if (weight > 0.0 && record_visible(g, normal, position, facing)) {
				use_record(record, weight);
				sum += weight;
			}
			float cost = distance(g, position.xyz) * (1.5 - dot(normal, facing));
			if (cost < nearest_cost) {
				nearest_cost = cost;
				nearest = record;
			}
		}
	}
	if (sum == 0.0 && nearest != GW_NONE) {
		use_record(nearest, 1.0);
		sum = 1.0;
	}
	return sum;
}

#endif

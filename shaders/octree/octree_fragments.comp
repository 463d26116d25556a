/*
 * octree_fragments.comp - the leaf cells to which each surfel contributes, and how much.
 *
 * RoI fragments (Salm 4.3.4): the cells which the cube of side s around the point overlaps. On a
 * surface whose samples are s apart, each stands for s^2 of it, so the opacity of a sample, which
 * is its density times s^3, has to be s^2: the density is 1/s, and a cell gets overlap volume / s.
 * A flat surface then gives each cell the opacity of the area it covers there, whatever s is.
 *
 * Disc fragments: the cells which the surfel's disc, bent as the surface is, overlaps get its area
 * by their shares of the disc. A small disc is looked at in 16 fixed points of equal area, a larger
 * one in a lattice of 4 x 4 points in each column of cells along the axis nearest to its normal.
 * One too large for that gives all its area to the cell of its centre; see disc_tree.h.
 *
 * The same shader counts and writes, so that both always agree. It writes keys first, which are
 * sorted, and then the rest of each fragment where its key went: what is not sorted takes no room
 * meanwhile.
 */
#version 460
#extension GL_GOOGLE_include_directive : require

#include "octree/octree_common.glsl"
#include "base/sampling.glsl"

layout(local_size_x_id = 0) in;

layout(binding = 0) uniform samplerBuffer surfel_position; /* grid coordinates, RoI */
layout(binding = 1) uniform samplerBuffer surfel_normal;
layout(binding = 2) uniform samplerBuffer surfel_disc; /* radius, area, first clip direction */
layout(binding = 3) uniform samplerBuffer surfel_clip; /* first clip distance, second clip */
layout(binding = 4) uniform samplerBuffer surfel_bend;
layout(binding = 5) buffer Offsets { uint offset[]; }; /* count, then first fragment; windowed */
layout(binding = 6) buffer Samples { uint samples[]; }; /* of the disc, that count; windowed */
layout(binding = 7) buffer KeysLow { uint key_low[]; }; /* GW_EMIT_REST: where each key went */
layout(binding = 8) writeonly buffer KeysHigh { uint key_high[]; };
layout(binding = 9) writeonly buffer Surfels { uint fragment_surfel[]; };
layout(binding = 10) writeonly buffer Weights { float fragment_weight[]; };
layout(binding = 11) writeonly buffer Centroids { uint fragment_centroid[]; };

layout(push_constant) uniform Push { gw_fragments_push push; };

const uint SMALL_POINTS = 16u;
/* Golden angle: the points (i + 1/2) / 16 of a Fibonacci spiral have equal shares of the disc. */
const vec2 GOLDEN_TURN = vec2(-0.73736888, 0.67549029);

struct Disc {
	vec3 place;  /* of the centre, from the corner of its cell */
	ivec3 cell;  /* of the centre */
	vec3 normal, tangent, bitangent;
	float radius, area;
	vec3 clip[2];
	vec3 bend;
};

uint surfel, fragments, inside_count;
uint place_to_write;

void add_fragment(ivec3 cell, uint kind, float weight, vec3 middle)
{
	if (push.emit == GW_EMIT_KEYS) {
		uint at = place_to_write + fragments;
		uvec2 key = morton_encode(uvec3(cell));
		key_low[at] = key.x;
		if (push.wide != 0u)
			key_high[at] = key.y;
	} else if (push.emit == GW_EMIT_REST) {
		uint at = key_low[place_to_write + fragments];
		fragment_surfel[at] = surfel | kind;
		fragment_weight[at] = weight;
		uvec3 c = uvec3(clamp(middle, vec3(0.0), vec3(1.0)) * 1023.0 + 0.5);
		fragment_centroid[at] = c.x | c.y << 10 | c.z << 20;
	}
	fragments++;
}

bool in_cube(ivec3 cell)
{
	return all(greaterThanEqual(cell, ivec3(0))) && all(lessThan(cell, ivec3(push.side)));
}

/* ---------------------------------------------------------------- regions of influence */

void add_roi(ivec3 cell, vec3 place, float side)
{
	/* The cube reaches into at most one other cell along each axis. Shares of its side there: */
	precise vec3 below = vec3(0.5) - place / side;
	precise vec3 above = vec3(0.5) - (vec3(1.0) - place) / side;
	precise vec3 beyond = max(vec3(0.0), max(below, above));
	precise vec3 within = vec3(1.0) - beyond;
	ivec3 way = ivec3(mix(vec3(1.0), vec3(-1.0), greaterThan(below, above)));
	for (int i = 0; i < 8; i++) {
		ivec3 step = ivec3(i, i >> 1, i >> 2) & 1;
		vec3 share = mix(within, beyond, equal(step, ivec3(1)));
		ivec3 other = cell + step * way;
		if (share.x > 0.0 && share.y > 0.0 && share.z > 0.0 && in_cube(other))
			add_fragment(other, GW_FRAGMENT_ROI, share.x * share.y * share.z * side * side,
			             vec3(0.0));
	}
}

/* --------------------------------------------------------------------------------- discs */

/* How steeply the bent disc rises from its plane, and how high it is there. */
vec2 bend_rise(Disc disc, vec2 at)
{
	return vec2(dot(disc.bend.xy, at), dot(disc.bend.yz, at));
}

float bend_height(Disc disc, vec2 at)
{
	return 0.5 * dot(bend_rise(disc, at), at);
}

bool is_cut(Disc disc, vec2 at)
{
	return dot(disc.clip[0].xy, at) > disc.clip[0].z || dot(disc.clip[1].xy, at) > disc.clip[1].z;
}

void add_small_disc(Disc disc)
{
	vec4 sum[27]; /* GW_EMIT_REST: of the points in each cell, and their number */
	uint used = 0u;
	vec2 turn = vec2(1.0, 0.0);
	for (uint i = 0u; i < SMALL_POINTS; i++) {
		vec2 at = turn * (disc.radius * sqrt((float(i) + 0.5) / float(SMALL_POINTS)));
		turn = vec2(turn.x * GOLDEN_TURN.x - turn.y * GOLDEN_TURN.y,
		            turn.x * GOLDEN_TURN.y + turn.y * GOLDEN_TURN.x);
		vec3 p = disc.place + disc.tangent * at.x + disc.bitangent * at.y +
				 disc.normal * bend_height(disc, at);
		ivec3 step = clamp(ivec3(floor(p)), ivec3(-1), ivec3(1));
		if (is_cut(disc, at) || !in_cube(disc.cell + step))
			continue;
		int k = step.x + 1 + 3 * (step.y + 1) + 9 * (step.z + 1);
		inside_count++;
		if (push.emit == GW_EMIT_REST) {
			vec4 before = (used >> k & 1u) != 0u ? sum[k] : vec4(0.0);
			sum[k] = before + vec4(p - vec3(step), 1.0);
		}
		used |= 1u << k;
	}
	if (push.emit == GW_EMIT_COUNTS) {
		fragments += uint(bitCount(used));
		return;
	}
	float share = disc.area / float(max(inside_count, 1u));
	for (; used != 0u; used &= used - 1u) {
		int k = findLSB(used);
		vec4 of_cell = push.emit == GW_EMIT_REST ? sum[k] : vec4(1.0);
		add_fragment(disc.cell + ivec3(k % 3, k / 3 % 3, k / 9) - 1, 0u, share * of_cell.w,
		             of_cell.xyz / of_cell.w);
	}
}

/* Turns axes so that z is the one along which columns are looked at, and back. */
vec3 turn_axes(vec3 v, int axis)
{
	return axis == 0 ? v.yzx : axis == 1 ? v.zxy : v;
}

vec3 turn_back(vec3 v, int axis)
{
	return axis == 0 ? v.zxy : axis == 1 ? v.yzx : v;
}

/* The lowest cell that a disc may meet in the column around `middle`. */
float lowest_level(Disc disc, vec3 n, vec3 tangent, vec3 bitangent, float height, vec2 middle)
{
	vec3 p = vec3(middle, -dot(n.xy, middle) / n.z);
	vec2 at = vec2(dot(tangent, p), dot(bitangent, p));
	vec2 rise = bend_rise(disc, at);
	vec2 slope = (rise.x * tangent.xy + rise.y * bitangent.xy - n.xy) / n.z;
	float there = height + p.z + bend_height(disc, at) / n.z;
	return floor(there - 0.5 * (abs(slope.x) + abs(slope.y)));
}

/*
 * One column of cells; slopes of the plane are at most 1 and what bends it adds little, so that at
 * most four cells of it are met. `from` is the column's corner relative to the disc's centre, in
 * turned axes as all here.
 */
void add_column(Disc disc, vec3 n, vec3 tangent, vec3 bitangent, float height, vec2 from,
                ivec2 column, int axis, float share)
{
	/* How near its points come to the centre: most columns at the corners are too far. */
	vec2 nearest = max(vec2(0.0), max(from + 0.125, -(from + 0.875)));
	if (dot(nearest, nearest) > disc.radius * disc.radius)
		return;
	vec2 slope = -n.xy / n.z;
	float lowest = lowest_level(disc, n, tangent, bitangent, height, from + 0.5);
	vec4 hits = vec4(0.0), sum_x = vec4(0.0), sum_y = vec4(0.0), sum_z = vec4(0.0);
	for (uint j = 0u; j < 4u; j++) {
		vec4 x = from.x + vec4(0.125, 0.375, 0.625, 0.875);
		float y = from.y + 0.125 + 0.25 * float(j);
		vec4 z = slope.x * x + slope.y * y;
		vec4 u = tangent.x * x + tangent.y * y + tangent.z * z;
		vec4 v = bitangent.x * x + bitangent.y * y + bitangent.z * z;
		vec4 bent = 0.5 * (disc.bend.x * u * u + disc.bend.z * v * v) + disc.bend.y * u * v;
		vec4 over = height + z + bent / n.z;
		vec4 level = clamp(floor(over) - lowest, 0.0, 3.0);
		vec4 kept = vec4(lessThanEqual(x * x + y * y + z * z, vec4(disc.radius * disc.radius))) *
		            vec4(lessThanEqual(disc.clip[0].x * u + disc.clip[0].y * v,
		                               vec4(disc.clip[0].z))) *
		            vec4(lessThanEqual(disc.clip[1].x * u + disc.clip[1].y * v,
		                               vec4(disc.clip[1].z)));
		for (int k = 0; k < 4; k++) {
			vec4 here = kept * vec4(equal(level, vec4(float(k))));
			float number = dot(here, vec4(1.0));
			hits[k] += number;
			if (push.emit != GW_EMIT_REST)
				continue;
			sum_x[k] += dot(here, x);
			sum_y[k] += number * y;
			sum_z[k] += dot(here, over);
		}
	}
	uvec4 met = uvec4(greaterThan(hits, vec4(0.0)));
	for (uint left = met.x | met.y << 1 | met.z << 2 | met.w << 3; left != 0u; left &= left - 1u) {
		int k = findLSB(left);
		ivec3 step = ivec3(turn_back(vec3(vec2(column), lowest + float(k)), axis));
		if (!in_cube(disc.cell + step))
			continue;
		vec3 middle = vec3(sum_x[k], sum_y[k], sum_z[k]) / hits[k] -
					  vec3(from, lowest + float(k));
		inside_count += uint(hits[k]);
		add_fragment(disc.cell + step, 0u, share * hits[k], turn_back(middle, axis));
	}
}

void add_large_disc(Disc disc, uint known)
{
	vec3 size = abs(disc.normal);
	int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
	vec3 n = turn_axes(disc.normal, axis), place = turn_axes(disc.place, axis);
	vec3 tangent = turn_axes(disc.tangent, axis), bitangent = turn_axes(disc.bitangent, axis);
	vec2 extent = disc.radius * sqrt(max(vec2(0.0), vec2(1.0) - n.xy * n.xy));
	ivec2 low = ivec2(floor(place.xy - extent)), high = ivec2(floor(place.xy + extent));
	float share = disc.area / float(max(known, 1u));
	for (int y = low.y; y <= high.y; y++)
		for (int x = low.x; x <= high.x; x++)
			add_column(disc, n, tangent, bitangent, place.z, vec2(x, y) - place.xy, ivec2(x, y),
			           axis, share);
}

void main()
{
	uint local = gl_GlobalInvocationID.x;
	if (local >= push.count)
		return;
	surfel = push.base + push.first + local;
	fragments = 0u;
	inside_count = 0u;
	place_to_write = push.emit != GW_EMIT_COUNTS ? offset[local] : 0u;
	uint known = push.emit != GW_EMIT_COUNTS ? samples[local] : 0u;

	vec4 position = texelFetch(surfel_position, int(surfel));
	vec4 size = texelFetch(surfel_disc, int(surfel)), clip = texelFetch(surfel_clip, int(surfel));
	Disc disc;
	disc.cell = clamp(ivec3(floor(position.xyz)), ivec3(0), ivec3(push.side) - 1);
	disc.place = position.xyz - vec3(disc.cell);
	disc.normal = texelFetch(surfel_normal, int(surfel)).xyz;
	tangent_frame(disc.normal, disc.tangent, disc.bitangent);
	disc.radius = size.x;
	disc.area = size.y;
	disc.clip[0] = vec3(size.zw, clip.x);
	disc.clip[1] = clip.yzw;
	disc.bend = texelFetch(surfel_bend, int(surfel)).xyz;

	/* What lies far off all the rest is outside the cube, and contributes to nothing. And backs are
	 * where their fronts are already. */
	if (texelFetch(surfel_normal, int(surfel)).w != GW_MARK_BACK &&
		all(greaterThanEqual(position.xyz, vec3(0.0))) &&
		all(lessThanEqual(position.xyz, vec3(push.side)))) {
		if (push.regions != 0u)
			add_roi(disc.cell, disc.place, position.w);
		if (disc.radius <= GW_DISC_SMALL)
			add_small_disc(disc);
		else if (disc.radius <= push.disc_most)
			add_large_disc(disc, known);
		if (inside_count == 0u)
			add_fragment(disc.cell, 0u, disc.area, disc.place);
	}
	if (push.emit == GW_EMIT_COUNTS) {
		offset[local] = fragments;
		samples[local] = inside_count;
	}
}

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
 * meanwhile. Counting notes for the keys which cells a larger disc meets, unless it is
 * one of the largest.
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
layout(binding = 7) uniform usamplerBuffer fragment_place; /* GW_EMIT_REST: where each key went */
/* GW_EMIT_KEYS: low and high words; GW_EMIT_REST: surfels and centroids */
layout(binding = 8, r32ui) writeonly uniform uimageBuffer low_or_surfel;
layout(binding = 9, r32ui) writeonly uniform uimageBuffer high_or_centroid;
layout(binding = 10, r32f) writeonly uniform imageBuffer fragment_weight; /* GW_EMIT_REST */
layout(binding = 11) buffer Notes { uint column_note[]; }; /* GW_COLUMN_WORDS a surfel; windowed */

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
		int at = int(place_to_write + fragments);
		uvec2 key = morton_encode(uvec3(cell));
		imageStore(low_or_surfel, at, uvec4(key.x));
		if (push.wide != 0u)
			imageStore(high_or_centroid, at, uvec4(key.y));
	} else if (push.emit == GW_EMIT_REST) {
		int at = int(texelFetch(fragment_place, int(place_to_write + fragments)).x);
		imageStore(low_or_surfel, at, uvec4(surfel | kind));
		imageStore(fragment_weight, at, vec4(weight));
		uvec3 c = uvec3(clamp(middle, vec3(0.0), vec3(1.0)) * 1023.0 + 0.5);
		imageStore(high_or_centroid, at, uvec4(c.x | c.y << 10 | c.z << 20));
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

/* The lowest cell that a disc may meet in the column around `middle`; the same wherever it is asked
 * for, so that keys go to the cells that were counted. */
float lowest_level(Disc disc, vec3 n, vec3 tangent, vec3 bitangent, float height, vec2 middle)
{
	precise float fall = n.x * middle.x + n.y * middle.y;
	precise vec3 p = vec3(middle, -fall / n.z);
	precise float u = tangent.x * p.x + tangent.y * p.y + tangent.z * p.z;
	precise float v = bitangent.x * p.x + bitangent.y * p.y + bitangent.z * p.z;
	precise float along = disc.bend.x * u + disc.bend.y * v;
	precise float across = disc.bend.y * u + disc.bend.z * v;
	precise vec2 slope = (along * tangent.xy + across * bitangent.xy - n.xy) / n.z;
	precise float bent = 0.5 * (along * u + across * v);
	precise float there = height + p.z + bent / n.z;
	precise float lowest = there - 0.5 * (abs(slope.x) + abs(slope.y));
	return floor(lowest);
}

/* What a disc is of a column of four cells, by 4 x 4 places in each. */
struct Column {
	float lowest;
	uint met;  /* a bit for each cell */
	uint hits; /* eight bits for each: its places that lie in the disc */
	vec4 sum_x, sum_y, sum_z; /* GW_EMIT_REST: of these */
};

uint hits_of(Column column, int k)
{
	return column.hits >> 8 * k & 0xffu;
}

/*
 * Looks at one column of cells; slopes of the plane are at most 1 and what bends it adds little, so
 * that at most four cells of it are met. `from` is the column's corner relative to the disc's
 * centre, in turned axes as all here.
 */
void look_at_column(Disc disc, vec3 n, vec3 tangent, vec3 bitangent, float height, vec2 from,
                    inout Column column)
{
	/* How near its points come to the centre: most columns at the corners are too far. */
	vec2 nearest = max(vec2(0.0), max(from + 0.125, -(from + 0.875)));
	if (dot(nearest, nearest) > disc.radius * disc.radius)
		return;
	vec2 slope = -n.xy / n.z;
	for (uint j = 0u; j < 4u; j++) {
		vec4 x = from.x + vec4(0.125, 0.375, 0.625, 0.875);
		float y = from.y + 0.125 + 0.25 * float(j);
		vec4 z = slope.x * x + slope.y * y;
		vec4 u = tangent.x * x + tangent.y * y + tangent.z * z;
		vec4 v = bitangent.x * x + bitangent.y * y + bitangent.z * z;
		vec4 bent = 0.5 * (disc.bend.x * u * u + disc.bend.z * v * v) + disc.bend.y * u * v;
		vec4 over = height + z + bent / n.z;
		vec4 level = clamp(floor(over) - column.lowest, 0.0, 3.0);
		vec4 kept = vec4(lessThanEqual(x * x + y * y + z * z, vec4(disc.radius * disc.radius))) *
		            vec4(lessThanEqual(disc.clip[0].x * u + disc.clip[0].y * v,
		                               vec4(disc.clip[0].z))) *
		            vec4(lessThanEqual(disc.clip[1].x * u + disc.clip[1].y * v,
		                               vec4(disc.clip[1].z)));
		uvec4 here = uvec4(kept) << 8u * uvec4(level);
		column.hits += here.x + here.y + here.z + here.w;
		if (push.emit != GW_EMIT_REST)
			continue;
		for (int k = 0; k < 4; k++) {
			vec4 there = kept * vec4(equal(level, vec4(float(k))));
			column.sum_x[k] += dot(there, x);
			column.sum_y[k] += dot(there, vec4(1.0)) * y;
			column.sum_z[k] += dot(there, over);
		}
	}
	for (int k = 0; k < 4; k++)
		column.met |= hits_of(column, k) > 0u ? 1u << k : 0u;
}

/* The cell of a disc's column that is `level` cells above its lowest. */
ivec3 cell_of(Disc disc, float lowest, int level, ivec2 place, int axis)
{
	return disc.cell + ivec3(turn_back(vec3(vec2(place), lowest + float(level)), axis));
}

/* A fragment for each cell of a column that is met. */
void add_column(Disc disc, Column column, vec2 from, ivec2 place, int axis, float share)
{
	for (uint left = column.met; left != 0u; left &= left - 1u) {
		int k = findLSB(left);
		ivec3 cell = cell_of(disc, column.lowest, k, place, axis);
		if (!in_cube(cell))
			continue;
		uint hits = hits_of(column, k);
		vec3 middle = vec3(column.sum_x[k], column.sum_y[k], column.sum_z[k]) / float(hits) -
					  vec3(from, column.lowest + float(k));
		inside_count += hits;
		add_fragment(cell, 0u, share * float(hits), turn_back(middle, axis));
	}
}

/* Leaves out what of a column lies outside of the cube. */
void keep_inside(Disc disc, inout Column column, ivec2 place, int axis)
{
	ivec3 reach = ivec3(int(disc.radius) + 5); /* four cells of a column, and rounding */
	if (in_cube(disc.cell - reach) && in_cube(disc.cell + reach))
		return;
	for (int k = 0; k < 4; k++)
		if (!in_cube(cell_of(disc, column.lowest, k, place, axis))) {
			column.met &= ~(1u << k);
			column.hits &= ~(0xffu << 8 * k);
		}
}

void count_column(Column column)
{
	uint pairs = (column.hits & 0xff00ffu) + (column.hits >> 8 & 0xff00ffu);
	inside_count += (pairs & 0xffffu) + (pairs >> 16);
	fragments += uint(bitCount(column.met));
}

/* How a disc that is larger than cells is looked at: axes turned, and which columns it may meet. */
struct Lattice {
	int axis;
	vec3 n, tangent, bitangent, place;
	ivec2 low, high;
};

Lattice lattice_of(Disc disc)
{
	vec3 size = abs(disc.normal);
	int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
	vec3 n = turn_axes(disc.normal, axis), place = turn_axes(disc.place, axis);
	vec2 extent = disc.radius * sqrt(max(vec2(0.0), vec2(1.0) - n.xy * n.xy));
	return Lattice(axis, n, turn_axes(disc.tangent, axis), turn_axes(disc.bitangent, axis), place,
	               ivec2(floor(place.xy - extent)), ivec2(floor(place.xy + extent)));
}

Column begin_column(Disc disc, Lattice l, vec2 from)
{
	float lowest = lowest_level(disc, l.n, l.tangent, l.bitangent, l.place.z, from + 0.5);
	return Column(lowest, 0u, 0u, vec4(0.0), vec4(0.0), vec4(0.0));
}

uint noted_at(uint word)
{
	return GW_COLUMN_WORDS * gl_GlobalInvocationID.x + word;
}

/* The keys of what counting noted: a bit for each cell, four a column, row by row. */
void add_noted(Disc disc, Lattice l, uint columns)
{
	uint width = uint(l.high.x - l.low.x) + 1u;
	for (uint word = 0u; word < (columns + 7u) / 8u; word++)
		for (uint left = column_note[noted_at(word)]; left != 0u; left &= left - 1u) {
			uint bit = uint(findLSB(left)), number = 8u * word + (bit >> 2);
			ivec2 place = l.low + ivec2(number % width, number / width);
			Column column = begin_column(disc, l, vec2(place) - l.place.xy);
			ivec3 cell = cell_of(disc, column.lowest, int(bit & 3u), place, l.axis);
			inside_count++;
			add_fragment(cell, 0u, 0.0, vec3(0.0));
		}
}

void add_large_disc(Disc disc, uint known)
{
	Lattice l = lattice_of(disc);
	ivec2 size = l.high - l.low + 1;
	bool noted = size.x * size.y <= int(8u * GW_COLUMN_WORDS), counts = push.emit == GW_EMIT_COUNTS;
	if (push.emit == GW_EMIT_KEYS && noted) {
		add_noted(disc, l, uint(size.x * size.y));
		return;
	}
	float share = disc.area / float(max(known, 1u));
	uint number = 0u, note = 0u;
	for (int y = l.low.y; y <= l.high.y; y++)
		for (int x = l.low.x; x <= l.high.x; x++, number++) {
			vec2 from = vec2(x, y) - l.place.xy;
			Column column = begin_column(disc, l, from);
			look_at_column(disc, l.n, l.tangent, l.bitangent, l.place.z, from, column);
			if (!counts) {
				add_column(disc, column, from, ivec2(x, y), l.axis, share);
				continue;
			}
			keep_inside(disc, column, ivec2(x, y), l.axis);
			count_column(column);
			note = ((number & 7u) == 0u ? 0u : note) | column.met << 4u * (number & 7u);
			if (noted)
				column_note[noted_at(number >> 3)] = note;
		}
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

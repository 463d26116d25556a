/*
 * volume_weights.comp - read-back step of a radiance volume, as far as the geometry goes: the cells
 * that a place on the surface takes light from, at most GW_VOLUME_WEIGHTS, with weights that sum to
 * 1. A row ends at GW_NONE.
 *
 * The place is moved half a cell along its normal; the eight cells around it count by trilinear
 * interpolation times the cosine at which they lie in front of the surface (Mavridis and
 * Papaioannou, section 3.4, equation 5). Cells that are buried, that lie in another compartment, or
 * that a surface hides from the place count nothing. Where none is left it looks further along the
 * normal, and in the end at cells that are hidden. Where the normal is not trusted, the cells
 * around the place itself count, on both sides.
 */
#include "light/transport_layout.h"
#include "octree/octree_walk.glsl"

TEXELS(0, uint, ray_directory);
TEXELS(1, uint, node);
TEXELS(2, uvec2, leaf_tile);
TEXELS(3, vec4, facet_plane);
TEXELS(4, vec4, facet_centre);
TEXELS(5, uint,
	   cell_slot); /* of each cell of the grid: its number among those with light, or GW_NONE */
TEXELS(6, vec4, cell_centre);
TEXELS(7, vec4, place_position);
TEXELS(8, vec4, place_normal);
TEXELS(9, uint, place_mark);
BUFFER(10, readwrite, uint, row_cell);
BUFFER(11, readwrite, float, row_weight);
TEXELS(12, uvec4, disc_tree);
PUSH(gw_volume_push);

#include "octree/trace.glsl"

/* Cells that count less do not at all. */
#define WEIGHT_LEAST 1e-4f

/* A ray towards a cell begins so far off the surface, leaf cells: half a disc's radius. */
#define RAY_OFFSET 0.65f

/* How often a place looks further along its normal, each time twice as far. */
#define STEPS 3u

/* A place that looks, and how. */
struct Looker {
	vec3 g, normal;
	uint mark;
	bool both_sides, through; /* through: cells that are hidden count as well */
};

/* The number of a cell with light, or GW_NONE. */
uint slot_at(ivec3 cell)
{
	if (min(cell.x, min(cell.y, cell.z)) < 0 || cell.x >= int(push.columns) ||
		cell.y >= int(push.rows) || cell.z >= int(push.layers))
		return GW_NONE;
	uint row = uint(cell.z) * push.rows + uint(cell.y);
	return texelFetch(cell_slot, int(row * push.columns + uint(cell.x))).x;
}

/* Does no surface hide a cell from the place? */
bool sees_cell(IN(Looker) looker, vec3 centre)
{
	vec3 from = looker.g + looker.normal * RAY_OFFSET, to = centre - from;
	float distance = length(to);
	if (distance < RAY_OFFSET)
		return true;
	Ray ray = { from, to * (1.0f / distance), looker.normal, looker.g, distance, true };
	return trace(ray).facet == GW_NONE;
}

/* What a cell counts by where it lies, and whether it is seen. */
float weight_of(IN(Looker) looker, vec4 centre)
{
	if (push.marked != 0u && looker.mark != 0u && uint(centre.w) != 0u &&
		looker.mark != uint(centre.w))
		return 0.0f;
	if (looker.both_sides)
		return 1.0f;
	vec3 off = centre.xyz - looker.g;
	float cosine = dot(looker.normal, off) * inversesqrt(max(dot(off, off), 1e-12f));
	return cosine > 0.0f && (looker.through || sees_cell(looker, centre.xyz)) ? cosine : 0.0f;
}

/* Fills a row with the cells around a place; returns how many. */
uint weigh_cells(IN(Looker) looker, vec3 at, uint row)
{
	vec3 from = (at - push.minimum.xyz) * (1.0f / push.minimum.w) - 0.5f;
	vec3 low = vec3(floor(from)), share = from - low;
	uint used = 0u;
	for (uint c = 0u; c < GW_VOLUME_WEIGHTS; c++) {
		ivec3 corner = ivec3(int(c & 1u), int(c >> 1 & 1u), int(c >> 2));
		float weight = (corner.x != 0 ? share.x : 1.0f - share.x) *
					   (corner.y != 0 ? share.y : 1.0f - share.y) *
					   (corner.z != 0 ? share.z : 1.0f - share.z);
		ivec3 cell = ivec3(int(low.x) + corner.x, int(low.y) + corner.y, int(low.z) + corner.z);
		uint slot = weight > WEIGHT_LEAST ? slot_at(cell) : GW_NONE;
		if (slot == GW_NONE)
			continue;
		weight *= weight_of(looker, texelFetch(cell_centre, int(slot)));
		if (weight <= WEIGHT_LEAST)
			continue;
		row_cell[row + used] = slot;
		row_weight[row + used] = weight;
		used++;
	}
	return used;
}

/* The row of a place that is lit from in front: nearer cells that are seen come first. */
uint look_along(IN(Looker) seer, uint row)
{
	Looker looker = seer;
	float distance = 0.5f * push.minimum.w;
	uint used = 0u;
	for (uint step = 0u; step < STEPS && used == 0u; step++) {
		used = weigh_cells(looker, looker.g + looker.normal * distance, row);
		distance *= 2.0f;
	}
	looker.through = true;
	return used > 0u ? used
					 : weigh_cells(looker, looker.g + looker.normal * (0.5f * push.minimum.w), row);
}

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	int place = int(push.place_first + push.first + i);
	uint row = i * GW_VOLUME_WEIGHTS;
	vec4 normal = texelFetch(place_normal, place);
	uint mark = push.marked != 0u ? texelFetch(place_mark, place).x : 0u;
	bool both_sides = push.both_sides != 0u && normal.w > 0.5f;
	Looker looker = { texelFetch(place_position, place).xyz, normal.xyz, mark, both_sides, false };
	uint used = both_sides ? weigh_cells(looker, looker.g, row) : look_along(looker, row);
	float sum = 0.0f;
	for (uint w = row; w < row + used; w++)
		sum += row_weight[w];
	for (uint w = row; w < row + used; w++)
		row_weight[w] = row_weight[w] / sum;
	if (used < GW_VOLUME_WEIGHTS)
		row_cell[row + used] = GW_NONE;
}

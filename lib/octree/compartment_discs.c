/*
 * compartment_discs.c - walls of surface that is sparser than leaves are wide; see compartments.h.
 *
 * There voids are many leaves across, and discs that are too large for leaves have no cells at all.
 * So each such disc makes walls of cells about as wide as itself, and a little beyond its rim.
 * Where finer surface has divided these, smaller ones; empty space is divided as far as it takes.
 */
#include "octree/compartments_steps.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Radii by which a disc reaches beyond its rim and its cuts. */
#define BEYOND 0.15f

/* Of a cube, over its width. */
#define DIAGONAL 1.7320508f

typedef struct disc {
	const float *place, *normal; /* leaf cells */
	float radius;
	float tangent[3], bitangent[3];
	float cut[2][3]; /* direction and distance, leaf cells */
	uint32_t level;  /* of its cells */
	float reach;     /* beyond which none of the cells that it makes has its middle */
} disc;

static float dot(const float a[3], const float b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static disc disc_of(const float *place, const float *normal, const float *size, const float *clip,
					uint32_t depth)
{
	disc d = { .place = place,
			   .normal = normal,
			   .radius = size[0],
			   .cut = { { size[2], size[3], clip[0] }, { clip[1], clip[2], clip[3] } } };
	int up = (int)floorf(log2f(fminf(d.radius, 1e6f)));
	d.level = (uint32_t)up < depth ? depth - (uint32_t)up : 1;
	d.reach = (1.0f + BEYOND) * d.radius + 0.5f * DIAGONAL * (float)(1u << (depth - d.level));
	gw_tangent_frame(normal, d.tangent, d.bitangent);
	return d;
}

/* How the children of a node lie to a disc: by axis and side, since eight of them share these. */
typedef struct children {
	float half; /* of their width */
	float low[3][2];
	float off[3][2];    /* of their middles from the place */
	float square[3][2]; /* of that */
	float height[3][2]; /* what it adds to the height over the disc */
	float reach_squared, height_most, beyond;
} children;

static children children_of(const disc *d, const float corner[3], float width)
{
	const float *n = d->normal;
	children c = { .half = 0.5f * width };
	for (int k = 0; k < 3; k++)
		for (int side = 0; side < 2; side++) {
			c.low[k][side] = corner[k] + (side ? width : 0.0f);
			c.off[k][side] = c.low[k][side] + c.half - d->place[k];
			c.square[k][side] = c.off[k][side] * c.off[k][side];
			c.height[k][side] = c.off[k][side] * n[k];
		}
	c.beyond = BEYOND * d->radius + DIAGONAL * c.half;
	c.reach_squared = (d->radius + c.beyond) * (d->radius + c.beyond);
	c.height_most = c.half * (fabsf(n[0]) + fabsf(n[1]) + fabsf(n[2]));
	return c;
}

static float sum_of(const float part[3][2], const uint32_t side[3])
{
	return part[0][side[0]] + part[1][side[1]] + part[2][side[2]];
}

/* Does a disc pass a child? */
static bool passes(const disc *d, const children *c, const uint32_t side[3])
{
	if (fabsf(sum_of(c->height, side)) > c->height_most ||
		sum_of(c->square, side) > c->reach_squared)
		return false;
	const float off[3] = { c->off[0][side[0]], c->off[1][side[1]], c->off[2][side[2]] };
	float u = dot(off, d->tangent), v = dot(off, d->bitangent);
	for (int i = 0; i < 2; i++)
		if (d->cut[i][0] * u + d->cut[i][1] * v - d->cut[i][2] > c->beyond)
			return false;
	return true;
}

/* May a child hold cells that a disc makes? Of wide ones those that the disc passes, or nearly, are
 * many more. */
static bool holds_reach(const disc *d, const children *c, const uint32_t side[3])
{
	float squared = 0.0f;
	for (int k = 0; k < 3; k++) {
		float beyond = fmaxf(fabsf(c->off[k][side[k]]) - c->half, 0.0f);
		squared += beyond * beyond;
	}
	return squared <= d->reach * d->reach;
}

static bool make_room(gw_walls *w)
{
	size_t room = w->room + w->room / 2 + 64;
	uint32_t *child =
		room < UINT32_MAX / 16 ? gw_resize_array(w->c->child, 8 * room, sizeof *child) : NULL;
	if (child == NULL)
		return false;
	w->c->child = child;
	uint8_t *neck = w->necks ? gw_resize_array(w->c->node_neck, room, 1) : NULL;
	if (w->necks && neck == NULL)
		return false;
	if (w->necks)
		w->c->node_neck = neck;
	w->room = room;
	return true;
}

/* A tile without anything below a node. */
static bool divide(gw_walls *w, uint32_t node)
{
	gw_compartments *c = w->c;
	size_t tiles = c->first / 8;
	w->failed = tiles == w->room && !make_room(w);
	if (w->failed)
		return false;
	if (w->necks)
		c->node_neck[tiles] = 0;
	memset(c->child + c->first, 0, 8 * sizeof *c->child);
	c->first += 8;
	c->child[node] = (uint32_t)tiles + 1;
	return true;
}

static void wall_below(gw_walls *w, const disc *d, uint32_t level, uint32_t tile,
					   const float corner[3]);

/* A node that a disc passes: a wall, or a neck, where it is no wider than the disc's cells, else
 * some of what is below it. */
static void wall_at(gw_walls *w, const disc *d, uint32_t level, uint32_t node,
					const float corner[3])
{
	uint32_t to = w->c->child[node];
	if (to == GW_WALL)
		return;
	if (to == 0 && level >= d->level) {
		if (w->necks)
			w->c->node_neck[node / 8] |= (uint8_t)(1u << node % 8);
		else
			w->c->child[node] = GW_WALL;
		return;
	}
	if (to == 0 && !divide(w, node))
		return;
	wall_below(w, d, level, w->c->child[node] - 1, corner);
}

/* The children of a node of a level, whose corner is given. */
static void wall_below(gw_walls *w, const disc *d, uint32_t level, uint32_t tile,
					   const float corner[3])
{
	const children c = children_of(d, corner, (float)(1u << (w->c->depth - level - 1)));
	for (uint32_t octant = 0; octant < 8 && !w->failed; octant++) {
		const uint32_t side[3] = { octant & 1u, octant >> 1 & 1u, octant >> 2 };
		if (!passes(d, &c, side) || (level + 1 < d->level && !holds_reach(d, &c, side)))
			continue;
		const float low[3] = { c.low[0][side[0]], c.low[1][side[1]], c.low[2][side[2]] };
		if (level + 1 < w->c->depth)
			wall_at(w, d, level + 1, 8 * tile + octant, low);
		else if (w->necks)
			w->c->leaf_neck[tile] |= (uint8_t)(1u << octant);
		else
			w->c->leaves[tile] |= (uint8_t)(1u << octant);
	}
}

void gw_wall_cell(gw_walls *w, uint32_t level, const int32_t at[3], const float *place,
				  const float *normal)
{
	disc plane = { .place = place, .normal = normal, .radius = INFINITY, .level = level };
	uint32_t tile = 0;
	for (uint32_t l = 1; l <= level; l++) {
		uint32_t shift = level - l;
		uint32_t octant = (uint32_t)(at[0] >> shift & 1) | (uint32_t)(at[1] >> shift & 1) << 1 |
						  (uint32_t)(at[2] >> shift & 1) << 2;
		uint32_t node = 8 * tile + octant, to = w->c->child[node];
		if (l == level && to == 0)
			w->c->child[node] = GW_WALL;
		if (to == GW_WALL || (to == 0 && (l == level || !divide(w, node))))
			return;
		tile = w->c->child[node] - 1;
	}
	float corner[3];
	for (int k = 0; k < 3; k++)
		corner[k] = (float)((uint32_t)at[k] << (w->c->depth - level));
	wall_below(w, &plane, level, tile, corner);
}

/* Discs that reach as far are of surface that is much sparser than leaves are wide: even at the rim
 * of a window, where half of the points around are missing, one in 3,000 random ones does. */
#define CUT_RADIUS 3.0f

static void wall_all(gw_walls *w, const gw_view *view, const gw_surfels *surfels)
{
	const float *place = view[0].bytes, *normal = view[1].bytes, *size = view[2].bytes,
				*clip = view[3].bytes;
	const float origin[3] = { 0.0f, 0.0f, 0.0f };
	const float *clear = surfels->transparency;
	const float least = w->necks ? CUT_RADIUS : GW_SPARSE_RADIUS;
	for (size_t i = 0; i < surfels->count && !w->failed; i++) {
		if (size[4 * i] < least || (clear && clear[i] > 0.0f))
			continue;
		disc d = disc_of(place + 4 * i, normal + 4 * i, size + 4 * i, clip + 4 * i, w->c->depth);
		if (w->necks)
			memset(d.cut, 0, sizeof d.cut);
		wall_below(w, &d, 0, 0, origin);
	}
}

static gw_status wall_with(gw_gpu *gpu, const gw_octree *octree, const gw_surfels *surfels,
						   gw_walls *w, gw_error *error)
{
	const gw_buffer *const buffer[4] = { &octree->surfel_position, &octree->surfel_normal,
										 &octree->surfel_disc, &octree->surfel_clip };
	gw_view view[4] = { 0 };
	gw_status status = GW_OK;
	for (int i = 0; i < 4 && status == GW_OK; i++)
		status = gw_view_open(gpu, buffer[i], 16 * (uint64_t)surfels->count, &view[i], error);
	if (status == GW_OK)
		wall_all(w, view, surfels);
	for (int i = 0; i < 4; i++)
		gw_view_close(&view[i]);
	return w->failed ? gw_fail(error, GW_ERROR_MEMORY, "no memory for walls of %zu surfels",
							   surfels->count)
					 : status;
}

gw_status gw_compartments_wall_discs(gw_gpu *gpu, const gw_octree *octree,
									 const gw_surfels *surfels, gw_compartments *c, gw_error *error)
{
	gw_walls w = { .c = c, .room = c->first / 8 };
	return wall_with(gpu, octree, surfels, &w, error);
}

gw_status gw_compartments_mark_discs(gw_gpu *gpu, const gw_octree *octree,
									 const gw_surfels *surfels, gw_compartments *c, gw_error *error)
{
	gw_walls w = { .c = c, .room = c->first / 8, .necks = true };
	return wall_with(gpu, octree, surfels, &w, error);
}

/*
 * compartment_sparse.c - closes the voids of surface that is sparser than leaves are wide; see
 * compartments.h.
 *
 * Discs cannot be relied upon there. Beside a denser patch they are narrow, since most points
 * around lie in it, and in creases some surfels have no disc to speak of. But cells tell by
 * themselves how sparse their surface is: where those around one hold about a point each, it is as
 * sparse as they are wide. What is a void among leaves of dense surface is one among such cells: as
 * narrow, with surface on both sides along two of the three axes.
 */
#include "octree/compartments_steps.h"

#include "octree/octree_layout.h"
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/* Surfels in the 27 cells around a cell as wide as its surface is sparse. A plane passes nine of
 * them, the width of cells goes by twos, and random points are fewer at times. */
#define POINTS_LEAST 5u
#define POINTS_MOST 36u

/* Of these cells so many have to hold some: along a wire there are fewer. */
#define HOLDING_LEAST 5u

/* Levels above that of leaves: as sparse as that, no leaf would do. */
#define LEVELS_ABOVE 2u

/* Cells from a sparse one to the voids that it closes. Beside denser surface cells do not tell that
 * theirs is sparse: others close what lies there. */
#define REACH 3

#define COUNT_MOST 255u

typedef struct cell {
	uint32_t level;
	int32_t at[3];
} cell;

/* A cell that is to be closed, and a surfel in whose plane it is, where it holds something. */
typedef struct closing {
	cell cell;
	uint32_t surfel;
} closing;

typedef struct sparse {
	gw_compartments *c;
	const float *place, *normal; /* 4 a surfel, leaf cells */
	uint8_t *count;              /* a node: surfels below it, COUNT_MOST at most */
	uint8_t *leaves;             /* a node: likewise of foliage */
	uint32_t *first;             /* a node: the first of these */
	closing *closing;
	size_t closings, room;
	bool failed;
} sparse;

static uint32_t octant_of(const cell *of, uint32_t level)
{
	uint32_t shift = of->level - level;
	return (uint32_t)(of->at[0] >> shift & 1) | (uint32_t)(of->at[1] >> shift & 1) << 1 |
		   (uint32_t)(of->at[2] >> shift & 1) << 2;
}

/* The node of a cell, or GW_COMPARTMENT_UNKNOWN where there is none: then wall says whether it lies
 * in one. */
static uint32_t node_of(const gw_compartments *c, const cell *of, bool *wall)
{
	uint32_t tile = 0;
	*wall = false;
	for (int k = 0; k < 3; k++)
		if (of->at[k] < 0 || of->at[k] >= 1 << of->level)
			return GW_COMPARTMENT_UNKNOWN;
	for (uint32_t level = 1; level < of->level; level++) {
		uint32_t to = c->child[8 * tile + octant_of(of, level)];
		*wall = to == GW_WALL;
		if (to == 0 || to == GW_WALL)
			return GW_COMPARTMENT_UNKNOWN;
		tile = to - 1;
	}
	return 8 * tile + octant_of(of, of->level);
}

/* Does a cell hold something, or lie in a wall? */
static bool holds(const gw_compartments *c, const cell *of)
{
	bool wall;
	uint32_t node = node_of(c, of, &wall);
	return wall || (node != GW_COMPARTMENT_UNKNOWN && c->child[node] != 0);
}

static cell beside(const cell *of, uint32_t axis, int32_t off)
{
	cell to = *of;
	to.at[axis] += off;
	return to;
}

static bool holds_beside(const gw_compartments *c, const cell *of, uint32_t axis, int32_t off)
{
	cell to = beside(of, axis, off);
	return holds(c, &to);
}

/* Does a cell have surface near it on both sides along an axis? */
static bool lies_between(const gw_compartments *c, const cell *of, uint32_t axis)
{
	bool below = holds_beside(c, of, axis, -1), above = holds_beside(c, of, axis, 1);
	return (below && above) || (below && holds_beside(c, of, axis, 2)) ||
		   (above && holds_beside(c, of, axis, -2));
}

/* In a sheet surface is near on both sides along two axes; in the crease of two along one, and on
 * one side of each of the others. */
static bool is_void(const gw_compartments *c, const cell *of)
{
	uint32_t axes = 0, sides = 0;
	for (uint32_t axis = 0; axis < 3; axis++) {
		axes += lies_between(c, of, axis);
		sides += holds_beside(c, of, axis, -1) || holds_beside(c, of, axis, 1);
	}
	return axes > 1 || (axes == 1 && sides == 3);
}

/* The cells that a surfel lies in, from the root on; false: there is none of the next level. */
static bool descend(const gw_compartments *c, const float *place, cell *of, uint32_t *node)
{
	uint32_t to = of->level == 0 ? 1 : c->child[*node];
	if (of->level == c->depth - LEVELS_ABOVE || to == 0 || to == GW_WALL)
		return false;
	of->level++;
	for (int k = 0; k < 3; k++)
		of->at[k] = (int32_t)place[k] >> (c->depth - of->level);
	*node = 8 * (to - 1) + octant_of(of, of->level);
	return true;
}

static bool is_within(const sparse *s, size_t i)
{
	bool within = true;
	for (size_t k = 0; k < 3; k++)
		within = within && s->place[4 * i + k] >= 0.0f &&
				 s->place[4 * i + k] < (float)(1u << s->c->depth);
	return within;
}

/* Does a surfel count? What lets light through is no wall, backs are where their fronts are, and
 * strays may lie beyond the grid. */
static bool is_wall(const sparse *s, const gw_surfels *surfels, size_t i)
{
	bool clear = surfels->transparency && surfels->transparency[i] > 0.0f;
	return is_within(s, i) && !clear && s->normal[4 * i + 3] != GW_MARK_BACK;
}

static void count_surfel(sparse *s, size_t i, uint8_t *count)
{
	uint32_t node = 0;
	for (cell of = { 0 }; descend(s->c, s->place + 4 * i, &of, &node);) {
		if (count == s->count && count[node] == 0)
			s->first[node] = (uint32_t)i;
		if (count[node] < COUNT_MOST)
			count[node]++;
	}
}

static void count_surfels(sparse *s, const gw_surfels *surfels)
{
	for (size_t i = 0; i < surfels->count; i++) {
		if (is_wall(s, surfels, i))
			count_surfel(s, i, s->count);
		else if (surfels->two_sided[i] == GW_SIDE_FOLIAGE && is_within(s, i))
			count_surfel(s, i, s->leaves);
	}
}

/* Is the surface in a cell about as sparse as it is wide? Single discs among leaves are none. */
static bool is_sparse(const sparse *s, const cell *of)
{
	uint32_t points = 0, leaves = 0, holding = 0;
	for (int32_t i = 0; i < 27 && points <= POINTS_MOST; i++) {
		cell near = *of;
		bool wall;
		near.at[0] += i % 3 - 1;
		near.at[1] += i / 3 % 3 - 1;
		near.at[2] += i / 9 - 1;
		uint32_t node = node_of(s->c, &near, &wall);
		if (node == GW_COMPARTMENT_UNKNOWN)
			continue;
		points += s->count[node];
		leaves += s->leaves[node];
		holding += s->count[node] > 0;
	}
	return points >= POINTS_LEAST && points <= POINTS_MOST && holding >= HOLDING_LEAST &&
		   leaves < points;
}

static void add_closing(sparse *s, const cell *of, uint32_t surfel)
{
	if (s->closings == s->room) {
		size_t room = s->room + s->room / 2 + 256;
		closing *more = gw_resize_array(s->closing, room, sizeof *more);
		s->failed = s->failed || more == NULL;
		if (more == NULL)
			return;
		s->closing = more;
		s->room = room;
	}
	s->closing[s->closings++] = (closing){ *of, surfel };
}

/* Does the plane of a surfel pass a cell? */
static bool passes(const sparse *s, uint32_t surfel, const cell *of)
{
	size_t at = 4 * (size_t)surfel;
	float reach, off = gw_cell_before_plane(s->place + at, s->normal + at, of->at,
											1u << (s->c->depth - of->level), &reach);
	return fabsf(off) <= reach;
}

/* A sparse cell's surface fills it, and so it does voids near it. */
static void close_around(sparse *s, const cell *of, uint32_t surfel)
{
	const int32_t wide = 2 * REACH + 1;
	add_closing(s, of, surfel);
	for (int32_t i = 0; i < wide * wide * wide; i++) {
		cell to = *of;
		to.at[0] += i % wide - REACH;
		to.at[1] += i / wide % wide - REACH;
		to.at[2] += i / wide / wide - REACH;
		if (passes(s, surfel, &to) && is_void(s->c, &to))
			add_closing(s, &to, surfel);
	}
}

/* The voids around all sparse cells among the children of a tile, and below them. */
static void find_voids(sparse *s, const cell *parent, uint32_t tile)
{
	for (uint32_t octant = 0; octant < 8 && !s->failed; octant++) {
		uint32_t node = 8 * tile + octant, to = s->c->child[node];
		cell of = { .level = parent->level + 1 };
		for (int k = 0; k < 3; k++)
			of.at[k] = 2 * parent->at[k] + (int32_t)(octant >> k & 1u);
		if (s->count[node] == 0)
			continue;
		if (s->count[node] <= POINTS_MOST && is_sparse(s, &of))
			close_around(s, &of, s->first[node]);
		if (to != 0 && to != GW_WALL && of.level < s->c->depth - LEVELS_ABOVE)
			find_voids(s, &of, to - 1);
	}
}

static bool close_all(sparse *s, const gw_surfels *surfels)
{
	gw_walls w = { .c = s->c, .room = s->c->first / 8 };
	const cell root = { 0 };
	s->count = gw_allocate_zeros(s->c->first, sizeof *s->count);
	s->leaves = gw_allocate_zeros(s->c->first, sizeof *s->leaves);
	s->first = gw_allocate_array(s->c->first, sizeof *s->first);
	if (!s->count || !s->leaves || !s->first)
		return false;
	count_surfels(s, surfels);
	find_voids(s, &root, 0);
	for (size_t i = 0; i < s->closings && !s->failed && !w.failed; i++) {
		const closing *close = s->closing + i;
		size_t j = close->surfel;
		gw_wall_cell(&w, close->cell.level, close->cell.at, s->place + 4 * j, s->normal + 4 * j);
	}
	return !s->failed && !w.failed;
}

gw_status gw_compartments_close_sparse(gw_gpu *gpu, const gw_octree *octree,
									   const gw_surfels *surfels, gw_compartments *c,
									   gw_error *error)
{
	sparse s = { .c = c };
	gw_view place = { 0 }, normal = { 0 };
	uint64_t bytes = 16 * (uint64_t)surfels->count;
	if (c->depth <= LEVELS_ABOVE)
		return GW_OK;
	gw_status status = gw_view_open(gpu, &octree->surfel_position, bytes, &place, error);
	if (status == GW_OK)
		status = gw_view_open(gpu, &octree->surfel_normal, bytes, &normal, error);
	s.place = place.bytes;
	s.normal = normal.bytes;
	if (status == GW_OK && !close_all(&s, surfels))
		status =
			gw_fail(error, GW_ERROR_MEMORY, "no memory for walls of %zu surfels", surfels->count);
	gw_view_close(&normal);
	gw_view_close(&place);
	free(s.count);
	free(s.leaves);
	free(s.first);
	free(s.closing);
	return status;
}

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
#include "glowworm_host.h"

#include <stdatomic.h>
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

typedef struct closings {
	closing *list;
	size_t count, room;
} closings;

/* What is below a cell of one level is looked at by itself. */
#define PARTS_LEVEL 4u

typedef struct void_part {
	cell cell;
	uint32_t tile;  /* of its children */
	size_t before;  /* closings of the cells above parts that come before its own */
	closings found; /* its own */
} void_part;

static cell child_of(const cell *parent, uint32_t octant)
{
	cell of = { .level = parent->level + 1 };
	for (int k = 0; k < 3; k++)
		of.at[k] = 2 * parent->at[k] + (int32_t)(octant >> k & 1u);
	return of;
}

/* Cells around a child of a tile that others are asked about: those whose points count, and those
 * that are looked at where voids are closed. */
#define AROUND_POINTS 1
#define AROUND_VOIDS (REACH + 2)
#define WIDEST (2 + 2 * AROUND_VOIDS)

/* What is in the cells of a level around the children of a tile, so that the tree is walked once
 * for all that is asked about them. */
typedef struct window {
	uint32_t level;
	int32_t low[3], wide; /* cells */
	/* wide^3, x first: the node, or GW_COMPARTMENT_UNKNOWN where there is none or it lies in a wall
	 * of a level above; does it hold something, or lie in a wall? */
	uint32_t node[WIDEST * WIDEST * WIDEST];
	bool holds[WIDEST * WIDEST * WIDEST];
} window;

/* The cells of a window that lie in one of a level at most that of the window. */
typedef struct window_part {
	int32_t first[3], last[3]; /* from low on; last is not one of them */
} window_part;

static window_part part_of(const window *w, const cell *of)
{
	window_part part;
	for (int k = 0; k < 3; k++) {
		int32_t first = of->at[k] * (1 << (w->level - of->level)) - w->low[k];
		int32_t last = first + (1 << (w->level - of->level));
		part.first[k] = first > 0 ? first : 0;
		part.last[k] = last < w->wide ? last : w->wide;
	}
	return part;
}

static size_t place_in(const window *w, int32_t x, int32_t y, int32_t z)
{
	return (size_t)(x + w->wide * (y + w->wide * z));
}

static size_t place_of(const window *w, const cell *of)
{
	return place_in(w, of->at[0] - w->low[0], of->at[1] - w->low[1], of->at[2] - w->low[2]);
}

static void fill_with_wall(window *w, const window_part *part)
{
	for (int32_t z = part->first[2]; z < part->last[2]; z++)
		for (int32_t y = part->first[1]; y < part->last[1]; y++)
			for (int32_t x = part->first[0]; x < part->last[0]; x++)
				w->holds[place_in(w, x, y, z)] = true;
}

/* Which children of a cell lie in the window, at least in part: along each axis from low to high, 0
 * or 1. */
typedef struct children_within {
	int32_t low[3], high[3];
} children_within;

static children_within children_of(const window *w, const cell *parent)
{
	children_within within;
	const uint32_t shift = w->level - parent->level - 1;
	for (int k = 0; k < 3; k++) {
		int32_t low = (w->low[k] >> shift) - 2 * parent->at[k];
		int32_t high = ((w->low[k] + w->wide - 1) >> shift) - 2 * parent->at[k];
		within.low[k] = low > 0 ? low : 0;
		within.high[k] = high < 1 ? high : 1;
	}
	return within;
}

static void look_below(const gw_compartments *c, const cell *parent, uint32_t tile, window *w);

/* Notes what a child of a tile has in the window, of which a part lies in it. */
static void look_into(const gw_compartments *c, const cell *of, uint32_t node, window *w)
{
	uint32_t to = c->child[node];
	if (of->level == w->level) {
		size_t i = place_of(w, of);
		w->node[i] = node;
		w->holds[i] = to != 0;
	} else if (to == GW_WALL) {
		const window_part part = part_of(w, of);
		fill_with_wall(w, &part);
	} else if (to != 0) {
		look_below(c, of, to - 1, w);
	}
}

static void look_below(const gw_compartments *c, const cell *parent, uint32_t tile, window *w)
{
	const children_within within = children_of(w, parent);
	cell of = { .level = parent->level + 1 };
	for (int32_t z = within.low[2]; z <= within.high[2]; z++)
		for (int32_t y = within.low[1]; y <= within.high[1]; y++)
			for (int32_t x = within.low[0]; x <= within.high[0]; x++) {
				of.at[0] = 2 * parent->at[0] + x;
				of.at[1] = 2 * parent->at[1] + y;
				of.at[2] = 2 * parent->at[2] + z;
				look_into(c, &of, 8 * tile + (uint32_t)(x + 2 * y + 4 * z), w);
			}
}

/* So many cells around the children of a cell. */
static void look_around(const gw_compartments *c, const cell *parent, int32_t around, window *w)
{
	const cell root = { 0 };
	w->level = parent->level + 1;
	w->wide = 2 + 2 * around;
	for (int k = 0; k < 3; k++)
		w->low[k] = 2 * parent->at[k] - around;
	size_t cells = place_in(w, 0, 0, w->wide);
	memset(w->node, 0xff, cells * sizeof *w->node);
	memset(w->holds, 0, cells * sizeof *w->holds);
	look_below(c, &root, 0, w);
}

/* In a sheet surface is near on both sides along two axes; in the crease of two along one, and on
 * one side of each of the others. */
static bool is_void(const window *w, size_t at)
{
	const size_t step[3] = { 1, (size_t)w->wide, (size_t)w->wide * (size_t)w->wide };
	uint32_t axes = 0, sides = 0;
	for (uint32_t axis = 0; axis < 3; axis++) {
		const bool *holds = w->holds + at;
		bool below = *(holds - step[axis]), above = holds[step[axis]];
		axes += (below && above) || (below && holds[2 * step[axis]]) ||
				(above && *(holds - 2 * step[axis]));
		sides += below || above;
	}
	return axes > 1 || (axes == 1 && sides == 3);
}

typedef struct sparse {
	gw_compartments *c;
	const float *place, *normal; /* 4 a surfel, leaf cells */
	uint8_t *count;              /* a node: surfels below it, COUNT_MOST at most */
	uint8_t *leaves;             /* a node: likewise of foliage */
	uint32_t *first;             /* a node: the first of these */
	closings all;                /* of the cells above parts, in the end all of them */
	void_part *part;
	size_t parts, part_room;
	atomic_bool failed;
} sparse;

/* One thread's search for voids. */
typedef struct void_search {
	sparse *of;
	bool above;      /* not below a part */
	closings *found; /* receives them */
	window *window;  /* one for the children of each level */
} void_search;

/* The cells that a surfel lies in, from the root on; false: there is none of the next level. */
static bool descend(const gw_compartments *c, const float *place, cell *of, uint32_t *node)
{
	uint32_t to = of->level == 0 ? 1 : c->child[*node];
	if (of->level == c->depth - LEVELS_ABOVE || to == 0 || to == GW_WALL)
		return false;
	of->level++;
	for (int k = 0; k < 3; k++)
		of->at[k] = (int32_t)place[k] >> (c->depth - of->level);
	*node = 8 * (to - 1) + gw_octant_above(of->at, 0);
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
static bool is_sparse(const sparse *s, const window *w, const cell *of)
{
	uint32_t points = 0, leaves = 0, holding = 0;
	for (int32_t i = 0; i < 27 && points <= POINTS_MOST; i++) {
		const cell near = {
			of->level, { of->at[0] + i % 3 - 1, of->at[1] + i / 3 % 3 - 1, of->at[2] + i / 9 - 1 }
		};
		uint32_t node = w->node[place_of(w, &near)];
		if (node == GW_COMPARTMENT_UNKNOWN)
			continue;
		points += s->count[node];
		leaves += s->leaves[node];
		holding += s->count[node] > 0;
	}
	return points >= POINTS_LEAST && points <= POINTS_MOST && holding >= HOLDING_LEAST &&
		   leaves < points;
}

static void add_closing(void_search *s, const cell *of, uint32_t surfel)
{
	closings *to = s->found;
	if (to->count == to->room) {
		size_t room = to->room + to->room / 2 + 256;
		closing *more = gw_resize_array(to->list, room, sizeof *more);
		if (more == NULL) {
			atomic_store(&s->of->failed, true);
			return;
		}
		to->list = more;
		to->room = room;
	}
	to->list[to->count++] = (closing){ *of, surfel };
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
static void close_around(void_search *s, const window *w, const cell *of, uint32_t surfel)
{
	const int32_t wide = 2 * REACH + 1;
	add_closing(s, of, surfel);
	for (int32_t i = 0; i < wide * wide * wide; i++) {
		cell to = *of;
		to.at[0] += i % wide - REACH;
		to.at[1] += i / wide % wide - REACH;
		to.at[2] += i / wide / wide - REACH;
		if (passes(s->of, surfel, &to) && is_void(w, place_of(w, &to)))
			add_closing(s, &to, surfel);
	}
}

/* Which children of a tile are sparse, a bit each. */
static uint32_t find_sparse(const sparse *s, const cell *parent, uint32_t tile, window *w)
{
	uint32_t candidates = 0, found = 0;
	for (uint32_t octant = 0; octant < 8; octant++) {
		uint8_t count = s->count[8 * tile + octant];
		candidates |= (uint32_t)(count > 0 && count <= POINTS_MOST) << octant;
	}
	if (candidates == 0)
		return 0;
	look_around(s->c, parent, AROUND_POINTS, w);
	for (uint32_t octant = 0; octant < 8; octant++) {
		const cell of = child_of(parent, octant);
		if ((candidates >> octant & 1u) != 0 && is_sparse(s, w, &of))
			found |= 1u << octant;
	}
	return found;
}

static void add_part(sparse *s, const cell *of, uint32_t tile)
{
	if (s->parts == s->part_room) {
		size_t room = s->part_room + s->part_room / 2 + 64;
		void_part *more = gw_resize_array(s->part, room, sizeof *more);
		if (more == NULL) {
			atomic_store(&s->failed, true);
			return;
		}
		s->part = more;
		s->part_room = room;
	}
	s->part[s->parts++] = (void_part){ .cell = *of, .tile = tile, .before = s->all.count };
}

/* The voids around all sparse cells among the children of a tile, and below them. */
static void find_voids(void_search *search, const cell *parent, uint32_t tile)
{
	sparse *s = search->of;
	window *w = search->window + parent->level;
	if (search->above && parent->level == PARTS_LEVEL) {
		add_part(s, parent, tile);
		return;
	}
	uint32_t sparse_ones = find_sparse(s, parent, tile, w);
	if (sparse_ones != 0)
		look_around(s->c, parent, AROUND_VOIDS, w);
	for (uint32_t octant = 0; octant < 8 && !atomic_load(&s->failed); octant++) {
		uint32_t node = 8 * tile + octant, to = s->c->child[node];
		const cell of = child_of(parent, octant);
		if (s->count[node] == 0)
			continue;
		if ((sparse_ones >> octant & 1u) != 0)
			close_around(search, w, &of, s->first[node]);
		if (to != 0 && to != GW_WALL && of.level < s->c->depth - LEVELS_ABOVE)
			find_voids(search, &of, to - 1);
	}
}

/* Those below a cell. */
static void search_below(sparse *s, const cell *of, uint32_t tile, closings *found)
{
	void_search one = { s, found == &s->all, found,
						gw_allocate_array(s->c->depth, sizeof *one.window) };
	if (one.window)
		find_voids(&one, of, tile);
	else
		atomic_store(&s->failed, true);
	free(one.window);
}

static void search_parts(void *user, size_t first, size_t last, uint32_t worker)
{
	sparse *s = user;
	(void)worker;
	for (size_t p = first; p < last; p++)
		search_below(s, &s->part[p].cell, s->part[p].tile, &s->part[p].found);
}

/* All closings as one search would have found them. */
static bool join_closings(sparse *s)
{
	closings joined = { .room = s->all.count };
	size_t above = 0;
	for (size_t p = 0; p < s->parts; p++)
		joined.room += s->part[p].found.count;
	joined.list = gw_allocate_array(joined.room, sizeof *joined.list);
	if (joined.list == NULL)
		return false;
	for (size_t p = 0; p < s->parts; p++) {
		closings *own = &s->part[p].found;
		for (; above < s->part[p].before; above++)
			joined.list[joined.count++] = s->all.list[above];
		for (size_t i = 0; i < own->count; i++)
			joined.list[joined.count++] = own->list[i];
		free(own->list);
		*own = (closings){ .count = 0 };
	}
	for (; above < s->all.count; above++)
		joined.list[joined.count++] = s->all.list[above];
	free(s->all.list);
	s->all = joined;
	return true;
}

static bool find_closings(sparse *s, const gw_surfels *surfels, uint32_t threads)
{
	const cell root = { 0 };
	s->count = gw_allocate_zeros(s->c->first, sizeof *s->count);
	s->leaves = gw_allocate_zeros(s->c->first, sizeof *s->leaves);
	s->first = gw_allocate_array(s->c->first, sizeof *s->first);
	if (!s->count || !s->leaves || !s->first)
		return false;
	count_surfels(s, surfels);
	search_below(s, &root, 0, &s->all);
	gw_parallel_for(threads, s->parts, 1, search_parts, s);
	return !atomic_load(&s->failed) && join_closings(s);
}

/* The plane of a closing. */
static bool shape_of(const void *user, size_t number, gw_wall_shape *shape)
{
	const sparse *s = user;
	const closing *close = s->all.list + number;
	size_t at = 4 * (size_t)close->surfel;
	*shape =
		gw_wall_shape_of_plane(s->place + at, s->normal + at, close->cell.level, close->cell.at);
	return true;
}

static gw_status close_all(sparse *s, const gw_surfels *surfels, uint32_t threads, gw_error *error)
{
	if (!find_closings(s, surfels, threads))
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for walls of %zu surfels",
					   surfels->count);
	const gw_wall_shapes shapes = {
		.count = s->all.count, .of = shape_of, .user = s, .planes = true
	};
	return gw_walls_make(s->c, &shapes, threads, error);
}

gw_status gw_compartments_close_sparse(gw_gpu *gpu, const gw_octree *octree,
									   const gw_surfels *surfels, uint32_t threads,
									   gw_compartments *c, gw_error *error)
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
	if (status == GW_OK)
		status = close_all(&s, surfels, threads, error);
	gw_view_close(&normal);
	gw_view_close(&place);
	free(s.count);
	free(s.leaves);
	free(s.first);
	for (size_t p = 0; p < s.parts; p++)
		free(s.part[p].found.list);
	free(s.part);
	free(s.all.list);
	return status;
}

/*
 * compartment_walls.c - makes walls, or necks, of the cells that discs and planes pass; see
 * gw_walls_make in compartments_steps.h.
 *
 * Whether an empty cell becomes a wall or is divided depends on what came before, so shapes come
 * one after the other. But what is below one cell of a level has nothing to do with what is below
 * another: each of these is a part, to which the shapes that pass it are given in their order, and
 * parts are taken by several threads. The tiles that a part adds are its own until all are done.
 */
#include "octree/compartments_steps.h"

#include "base/memory.h"
#include "glowworm_host.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* Radii by which a disc reaches beyond its rim and its cuts. */
#define BEYOND 0.15f

/* Of a cube, over its width. */
#define DIAGONAL 1.7320508f

/* The level of the cells that are parts, in octrees with some levels more. */
#define PARTS_LEVEL 4u
#define LEVELS_BELOW 2u

/* Tiles that a part adds have numbers from here on, until all parts are put together. */
#define OWN_TILE (1u << 28)
#define OWN_NODE (8u * OWN_TILE)

#define CHUNK 1024 /* shapes that a thread takes at a time */

/* A list of numbers that grows. */
typedef struct numbers {
	uint32_t *number;
	size_t count, room;
} numbers;

static bool add_number(numbers *list, uint32_t number)
{
	if (list->count == list->room) {
		size_t room = list->room + list->room / 2 + 64;
		uint32_t *more = gw_resize_array(list->number, room, sizeof *more);
		if (!more)
			return false;
		list->number = more;
		list->room = room;
	}
	list->number[list->count++] = number;
	return true;
}

static void free_numbers(numbers *list)
{
	free(list->number);
	*list = (numbers){ .count = 0 };
}

/* Tiles that are added to a tree. */
typedef struct own_tiles {
	uint32_t *child; /* 8 * room */
	uint8_t *neck;   /* room, where necks are made */
	size_t count, room;
	numbers linked; /* nodes of the tree whose children are among them */
} own_tiles;

/* What is below one cell of the parts' level. */
typedef struct part {
	uint32_t tile; /* of the cell's children */
	float corner[3];
	numbers shapes; /* that pass it */
	own_tiles own;
} part;

/* The nodes that the discs of a chunk pass: disc and node in turn. */
typedef struct passing {
	numbers pairs;
	bool failed;
} passing;

typedef struct walls {
	gw_compartments *c;
	const gw_wall_shapes *shapes;
	uint32_t level; /* of parts, 0: there are none */
	size_t parts;   /* 8^level, or 0 */
	part *part;
	passing *chunk; /* of discs */
	size_t chunks;
	atomic_bool failed;
} walls;

/* One thread's walk: through the tree as far as parts go, or within a part. */
typedef struct walk {
	walls *walls;
	part *part; /* NULL: not within one */
	own_tiles *own;
	uint32_t shape; /* that makes walls */
	bool failed;
} walk;

/* ----------------------------------------------------------------------------------- geometry */

static float dot(const float a[3], const float b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

gw_wall_shape gw_wall_shape_of_disc(const float *place, const float *normal, const float *size,
									const float *clip, uint32_t depth)
{
	gw_wall_shape d = { .place = place,
						.normal = normal,
						.radius = size[0],
						.cut = { { size[2], size[3], clip[0] }, { clip[1], clip[2], clip[3] } } };
	int up = (int)floorf(log2f(fminf(d.radius, 1e6f)));
	d.level = (uint32_t)up < depth ? depth - (uint32_t)up : 1;
	d.reach = (1.0f + BEYOND) * d.radius + 0.5f * DIAGONAL * (float)(1u << (depth - d.level));
	gw_tangent_frame(normal, d.tangent, d.bitangent);
	return d;
}

gw_wall_shape gw_wall_shape_of_plane(const float *place, const float *normal, uint32_t level,
									 const int32_t at[3])
{
	return (gw_wall_shape){ .place = place,
							.normal = normal,
							.radius = INFINITY,
							.level = level,
							.within = level,
							.at = { at[0], at[1], at[2] } };
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

static children children_of(const gw_wall_shape *d, const float corner[3], float width)
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

static float sum_of(const float by[3][2], const uint32_t side[3])
{
	return by[0][side[0]] + by[1][side[1]] + by[2][side[2]];
}

/* Does a disc pass a child? */
static bool passes(const gw_wall_shape *d, const children *c, const uint32_t side[3])
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
static bool holds_reach(const gw_wall_shape *d, const children *c, const uint32_t side[3])
{
	float squared = 0.0f;
	for (int k = 0; k < 3; k++) {
		float beyond = fmaxf(fabsf(c->off[k][side[k]]) - c->half, 0.0f);
		squared += beyond * beyond;
	}
	return squared <= d->reach * d->reach;
}

/* Whether a shape makes walls in or below a child, which is of a level. */
static bool is_in(const gw_wall_shape *d, const children *c, const uint32_t side[3], uint32_t level)
{
	return passes(d, c, side) && (level >= d->level || holds_reach(d, c, side));
}

/* --------------------------------------------------------------------------------------- tiles */

static uint32_t *child_at(walk *w, uint32_t node)
{
	return node < OWN_NODE ? w->walls->c->child + node : w->own->child + (node - OWN_NODE);
}

static void mark_neck(walk *w, uint32_t node)
{
	uint8_t *of =
		node < OWN_NODE ? w->walls->c->node_neck + node / 8 : w->own->neck + (node - OWN_NODE) / 8;
	*of |= (uint8_t)(1u << node % 8);
}

static bool make_room(own_tiles *t, bool necks)
{
	size_t room = t->room + t->room / 2 + 64;
	uint32_t *child = room < OWN_TILE ? gw_resize_array(t->child, 8 * room, sizeof *child) : NULL;
	if (!child)
		return false;
	t->child = child;
	uint8_t *neck = necks ? gw_resize_array(t->neck, room, 1) : NULL;
	if (necks && !neck)
		return false;
	t->neck = necks ? neck : t->neck;
	t->room = room;
	return true;
}

/* A tile without anything below a node. */
static bool divide(walk *w, uint32_t node)
{
	own_tiles *t = w->own;
	bool necks = w->walls->shapes->necks;
	w->failed = w->failed || (t->count == t->room && !make_room(t, necks)) ||
				(node < OWN_NODE && !add_number(&t->linked, node));
	if (w->failed)
		return false;
	memset(t->child + 8 * t->count, 0, 8 * sizeof *t->child);
	if (necks)
		t->neck[t->count] = 0;
	*child_at(w, node) = OWN_TILE + (uint32_t)t->count++ + 1;
	return true;
}

static uint32_t joined(uint32_t to, size_t base)
{
	return to > OWN_TILE && to != GW_WALL ? to - OWN_TILE + (uint32_t)base : to;
}

/* Room in the tree for so many tiles more. */
static bool reserve_tiles(gw_compartments *c, size_t more, bool necks)
{
	size_t tiles = c->first / 8 + more;
	uint32_t *child = tiles < OWN_TILE ? gw_resize_array(c->child, 8 * tiles, sizeof *child) : NULL;
	if (!child)
		return false;
	c->child = child;
	uint8_t *neck = necks ? gw_resize_array(c->node_neck, tiles, 1) : NULL;
	if (neck)
		c->node_neck = neck;
	return neck || !necks;
}

/* The tree takes tiles that were added to it, for which it has room. */
static void take_tiles(gw_compartments *c, const own_tiles *t)
{
	size_t base = c->first / 8;
	if (t->neck)
		memcpy(c->node_neck + base, t->neck, t->count);
	for (size_t i = 0; i < 8 * t->count; i++)
		c->child[8 * base + i] = joined(t->child[i], base);
	for (size_t i = 0; i < t->linked.count; i++)
		c->child[t->linked.number[i]] = joined(c->child[t->linked.number[i]], base);
	c->first += (uint32_t)(8 * t->count);
}

static void free_tiles(own_tiles *t)
{
	free(t->child);
	free(t->neck);
	free_numbers(&t->linked);
	*t = (own_tiles){ .count = 0 };
}

/* --------------------------------------------------------------------------------------- walls */

/* A node of the parts' level or above it, as one number. */
static uint32_t number_of(const walls *all, const float corner[3], uint32_t level)
{
	uint32_t shift = all->c->depth - level, number = level;
	for (int k = 2; k >= 0; k--)
		number = number << PARTS_LEVEL | (uint32_t)corner[k] >> shift;
	return number;
}

/* The part that begins at a corner. */
static part *part_at(const walls *all, const float corner[3])
{
	uint32_t number = number_of(all, corner, all->level);
	return all->part + (number & ((1u << 3 * PARTS_LEVEL) - 1));
}

/* Leaves what is below a node to the part that it is. */
static void leave_to_part(walk *w, uint32_t tile, const float corner[3])
{
	part *p = part_at(w->walls, corner);
	p->tile = tile;
	memcpy(p->corner, corner, sizeof p->corner);
	w->failed = w->failed || !add_number(&p->shapes, w->shape);
}

static void wall_below(walk *w, const gw_wall_shape *d, uint32_t level, uint32_t tile,
					   const float corner[3]);

/* What is below a node of a level, in this walk or later. */
static void go_below(walk *w, const gw_wall_shape *d, uint32_t level, uint32_t node,
					 const float corner[3])
{
	uint32_t tile = *child_at(w, node) - 1;
	if (!w->part && level == w->walls->level)
		leave_to_part(w, tile, corner);
	else
		wall_below(w, d, level, tile, corner);
}

/* A node that a shape passes: a wall, or a neck, where it is no wider than the shape's cells, else
 * some of what is below it. */
static void wall_at(walk *w, const gw_wall_shape *d, uint32_t level, uint32_t node,
					const float corner[3])
{
	uint32_t to = *child_at(w, node);
	if (to == GW_WALL)
		return;
	if (to == 0 && level >= d->level) {
		if (w->walls->shapes->necks)
			mark_neck(w, node);
		else
			*child_at(w, node) = GW_WALL;
		return;
	}
	if (to != 0 || divide(w, node))
		go_below(w, d, level, node, corner);
}

/* The children of a node of a level, whose corner is given. */
static void wall_below(walk *w, const gw_wall_shape *d, uint32_t level, uint32_t tile,
					   const float corner[3])
{
	gw_compartments *all = w->walls->c;
	const children c = children_of(d, corner, (float)(1u << (all->depth - level - 1)));
	for (uint32_t octant = 0; octant < 8 && !w->failed; octant++) {
		const uint32_t side[3] = { octant & 1u, octant >> 1 & 1u, octant >> 2 };
		if (!is_in(d, &c, side, level + 1))
			continue;
		const float low[3] = { c.low[0][side[0]], c.low[1][side[1]], c.low[2][side[2]] };
		if (level + 1 < all->depth)
			wall_at(w, d, level + 1, 8 * tile + octant, low);
		else if (w->walls->shapes->necks)
			all->leaf_neck[tile] |= (uint8_t)(1u << octant);
		else
			all->leaves[tile] |= (uint8_t)(1u << octant);
	}
}

static void corner_of(const gw_compartments *c, const int32_t at[3], uint32_t level,
					  float corner[3])
{
	for (int k = 0; k < 3; k++)
		corner[k] = (float)((uint32_t)at[k] << (c->depth - level));
}

/* Walls in the cell that a shape is within, which is below a tile of a level's nodes; what is on
 * the way to it is divided. */
static void wall_within(walk *w, const gw_wall_shape *d, uint32_t tile, uint32_t level)
{
	float corner[3];
	for (uint32_t l = level; l < d->within; l++) {
		uint32_t node = 8 * tile + gw_octant_above(d->at, d->within - l), to = *child_at(w, node);
		if (to == GW_WALL || (to == 0 && !divide(w, node)))
			return;
		tile = *child_at(w, node) - 1;
	}
	corner_of(w->walls->c, d->at, d->within, corner);
	wall_at(w, d, d->within, 8 * tile + gw_octant_above(d->at, 0), corner);
}

/* --------------------------------------------------------------------------------------- parts */

static void add_passing(passing *found, uint32_t shape, uint32_t number)
{
	found->failed =
		found->failed || !add_number(&found->pairs, shape) || !add_number(&found->pairs, number);
}

/* Notes the parts that a disc passes, of those below a node; or the node, if it passes that alone,
 * which divides it. */
static void find_parts(const walls *all, const gw_wall_shape *d, uint32_t shape, uint32_t level,
					   const float corner[3], passing *found)
{
	const children c = children_of(d, corner, (float)(1u << (all->c->depth - level - 1)));
	bool any = false;
	for (uint32_t octant = 0; octant < 8 && !found->failed; octant++) {
		const uint32_t side[3] = { octant & 1u, octant >> 1 & 1u, octant >> 2 };
		if (!is_in(d, &c, side, level + 1))
			continue;
		const float low[3] = { c.low[0][side[0]], c.low[1][side[1]], c.low[2][side[2]] };
		any = true;
		if (level + 1 < all->level)
			find_parts(all, d, shape, level + 1, low, found);
		else
			add_passing(found, shape, number_of(all, low, level + 1));
	}
	if (!any && level > 0)
		add_passing(found, shape, number_of(all, corner, level));
}

/* Does a shape make walls below parts alone? */
static bool is_below_parts(const walls *all, const gw_wall_shape *d)
{
	return all->level > 0 && d->level > all->level;
}

/* Notes the parts that discs pass; of a disc that makes walls above parts as well, UINT32_MAX. */
static void find_passing(void *user, size_t first, size_t last, uint32_t worker)
{
	walls *all = user;
	passing *found = all->chunk + first / CHUNK;
	const float origin[3] = { 0.0f, 0.0f, 0.0f };
	(void)worker;
	for (size_t i = first; i < last && !found->failed; i++) {
		gw_wall_shape d;
		if (!all->shapes->of(all->shapes->user, i, &d))
			continue;
		if (is_below_parts(all, &d))
			find_parts(all, &d, (uint32_t)i, 0, origin, found);
		else
			add_passing(found, (uint32_t)i, UINT32_MAX);
	}
	if (found->failed)
		atomic_store(&all->failed, true);
}

/* A node and those on the way to it are divided, unless one of them is a wall. If it is a part's, a
 * shape is left to that. */
static void enter(walk *w, uint32_t number)
{
	const uint32_t mask = (1u << PARTS_LEVEL) - 1, level = number >> 3 * PARTS_LEVEL;
	const int32_t at[3] = { (int32_t)(number & mask), (int32_t)(number >> PARTS_LEVEL & mask),
							(int32_t)(number >> 2 * PARTS_LEVEL & mask) };
	uint32_t tile = 0;
	for (uint32_t l = 1; l <= level; l++) {
		uint32_t node = 8 * tile + gw_octant_above(at, level - l), to = *child_at(w, node);
		if (to == GW_WALL || (to == 0 && !divide(w, node)))
			return;
		tile = *child_at(w, node) - 1;
	}
	float corner[3];
	corner_of(w->walls->c, at, level, corner);
	if (level == w->walls->level)
		leave_to_part(w, tile, corner);
}

/* What a shape does above the parts, and which of them it is left to. */
static void wall_shape(walk *w, const gw_wall_shape *d)
{
	const float origin[3] = { 0.0f, 0.0f, 0.0f };
	float corner[3];
	if (d->within == 0) {
		wall_below(w, d, 0, 0, origin);
	} else if (is_below_parts(w->walls, d)) {
		corner_of(w->walls->c, d->at, d->within, corner);
		enter(w, number_of(w->walls, corner, w->walls->level));
	} else {
		wall_within(w, d, 0, 1);
	}
}

static void planes_above(walk *w)
{
	const gw_wall_shapes *shapes = w->walls->shapes;
	for (size_t i = 0; i < shapes->count && !w->failed; i++) {
		gw_wall_shape d;
		w->shape = (uint32_t)i;
		if (shapes->of(shapes->user, i, &d))
			wall_shape(w, &d);
	}
}

static void discs_above(walk *w, const passing *chunk)
{
	const gw_wall_shapes *shapes = w->walls->shapes;
	for (size_t i = 0; i < chunk->pairs.count && !w->failed; i += 2) {
		gw_wall_shape d;
		w->shape = chunk->pairs.number[i];
		if (chunk->pairs.number[i + 1] != UINT32_MAX)
			enter(w, chunk->pairs.number[i + 1]);
		else if (shapes->of(shapes->user, w->shape, &d))
			wall_shape(w, &d);
	}
}

/* Of all shapes in their order what is above the parts. */
static bool wall_above(walls *all)
{
	own_tiles own = { .count = 0 };
	walk w = { .walls = all, .own = &own };
	if (all->shapes->planes)
		planes_above(&w);
	for (size_t k = 0; k < all->chunks; k++) {
		discs_above(&w, &all->chunk[k]);
		free_numbers(&all->chunk[k].pairs);
	}
	const uint32_t base = all->c->first / 8;
	bool good = !w.failed && reserve_tiles(all->c, own.count, all->shapes->necks);
	if (good)
		take_tiles(all->c, &own);
	for (size_t p = 0; p < all->parts; p++)
		if (all->part[p].tile >= OWN_TILE)
			all->part[p].tile = all->part[p].tile - OWN_TILE + base;
	free_tiles(&own);
	return good;
}

static void wall_part(walls *all, part *p)
{
	walk w = { .walls = all, .part = p, .own = &p->own };
	for (size_t i = 0; i < p->shapes.count && !w.failed; i++) {
		gw_wall_shape d;
		w.shape = p->shapes.number[i];
		if (!all->shapes->of(all->shapes->user, w.shape, &d))
			continue;
		if (d.within > all->level)
			wall_within(&w, &d, p->tile, all->level + 1);
		else
			wall_below(&w, &d, all->level, p->tile, p->corner);
	}
	free_numbers(&p->shapes);
	if (w.failed)
		atomic_store(&all->failed, true);
}

static void wall_parts(void *user, size_t first, size_t last, uint32_t worker)
{
	walls *all = user;
	(void)worker;
	for (size_t p = first; p < last; p++)
		wall_part(all, all->part + p);
}

/* ----------------------------------------------------------------------------------- all of it */

/* The tree takes what all parts have added. */
static bool join_parts(walls *all)
{
	size_t tiles = 0;
	for (size_t p = 0; p < all->parts; p++)
		tiles += all->part[p].own.count;
	if (!reserve_tiles(all->c, tiles, all->shapes->necks))
		return false;
	for (size_t p = 0; p < all->parts; p++)
		take_tiles(all->c, &all->part[p].own);
	return true;
}

static bool make_all(walls *all, uint32_t threads)
{
	const gw_wall_shapes *shapes = all->shapes;
	all->part = gw_allocate_zeros(all->parts, sizeof *all->part);
	all->chunk = gw_allocate_zeros(all->chunks, sizeof *all->chunk);
	if (!all->part || !all->chunk || shapes->count >= UINT32_MAX)
		return false;
	if (!shapes->planes)
		gw_parallel_for(threads, shapes->count, CHUNK, find_passing, all);
	if (atomic_load(&all->failed) || !wall_above(all))
		return false;
	gw_parallel_for(threads, all->parts, 1, wall_parts, all);
	return !atomic_load(&all->failed) && join_parts(all);
}

gw_status gw_walls_make(gw_compartments *c, const gw_wall_shapes *shapes, uint32_t threads,
						gw_error *error)
{
	uint32_t level = c->depth > PARTS_LEVEL + LEVELS_BELOW ? PARTS_LEVEL : 0;
	walls all = { .c = c,
				  .shapes = shapes,
				  .level = level,
				  .parts = level > 0 ? (size_t)1 << 3 * level : 0,
				  .chunks = shapes->planes ? 0 : (shapes->count + CHUNK - 1) / CHUNK };
	bool good = make_all(&all, threads);
	for (size_t p = 0; all.part && p < all.parts; p++) {
		free_numbers(&all.part[p].shapes);
		free_tiles(&all.part[p].own);
	}
	for (size_t k = 0; all.chunk && k < all.chunks; k++)
		free_numbers(&all.chunk[k].pairs);
	free(all.part);
	free(all.chunk);
	return good ? GW_OK
				: gw_fail(error, GW_ERROR_MEMORY, "no memory for walls of %zu shapes",
						  shapes->count);
}

/*
 * compartments_join.c - empty cells of all sizes that touch by a face are united while the octree
 * is walked from its root: of two cells beside each other their children that touch, and so on,
 * until both are empty or one of them is a wall. So nothing is searched for.
 *
 * First those are united that are wide, as leaves that touch no wall are, then with each narrow one
 * a wide one beside it, and so on. Where two compartments meet then, they meet in a neck that is no
 * wider than two cells. It may be a hole that points missed: the side of a stalactite has one where
 * its front has hundreds. Behind such a hole lies rock, to which all surface shows its back. So in
 * necks are united what surface faces and what it faces, and rock and rock, but not one and the
 * other. A slit between two rooms stays open, as does a window that is wider.
 */
#include "octree/compartments_steps.h"

#include "base/memory.h"
#include "glowworm_host.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* Surfels that show their back to rock, for one that faces it by mistake. */
#define BACKS_TO_ROCK 4

/* Leaf cells: how far from a surfel it is looked what lies before and behind it, in steps. */
#define STEP 0.5f
#define STEPS 6
#define CHUNK 4096 /* surfels that a thread takes at a time */

/* Of an empty cell. */
enum reached { WIDE, NARROW, REACHED, QUEUED };

/* Two cells that touch. */
typedef struct pair {
	uint32_t of[2];
} pair;

typedef struct joining {
	gw_compartments *c;
	uint8_t *reached; /* cells + 1 */
	uint32_t threads;
	bool first; /* is it the first walk? */
	/* What the second one finds: a cell of them is narrow still, or they are of two compartments.
	 */
	pair *pair;
	size_t pairs, room;
	bool failed;
} joining;

static uint32_t find(uint32_t *label, uint32_t i)
{
	while (label[i] != i) {
		label[i] = label[label[i]];
		i = label[i];
	}
	return i;
}

static void unite(uint32_t *label, uint32_t i, uint32_t j)
{
	i = find(label, i);
	j = find(label, j);
	if (i < j)
		label[j] = i;
	else
		label[i] = j;
}

static void remember(joining *j, uint32_t low, uint32_t high)
{
	if (j->pairs == j->room) {
		size_t room = j->room + j->room / 2 + 1024;
		pair *more = gw_resize_array(j->pair, room, sizeof *more);
		j->failed = j->failed || more == NULL;
		if (more == NULL)
			return;
		j->pair = more;
		j->room = room;
	}
	j->pair[j->pairs++] = (pair){ { low, high } };
}

/* Two empty cells touch. */
static void meet(joining *j, uint32_t low, uint32_t high)
{
	uint32_t *label = j->c->label;
	uint8_t *of_low = j->reached + low, *of_high = j->reached + high;
	bool narrow = *of_low == NARROW || *of_high == NARROW;
	if (!j->first) {
		if (narrow || find(label, low) != find(label, high))
			remember(j, low, high);
	} else if (*of_low == WIDE && (*of_high == WIDE || *of_high == NARROW)) {
		*of_high = *of_high == WIDE ? WIDE : REACHED;
		unite(label, low, high);
	} else if (*of_high == WIDE && *of_low == NARROW) {
		*of_low = REACHED;
		unite(label, low, high);
	}
}

/* Two cells that touch, the second one further along an axis. */
static void walk_faces(joining *j, gw_compartment_cell low, gw_compartment_cell high, uint32_t axis)
{
	if (low.tile == GW_WALL || high.tile == GW_WALL)
		return;
	if (low.tile == 0 && high.tile == 0) {
		meet(j, low.number, high.number);
		return;
	}
	for (uint32_t octant = 0; octant < 8; octant++) {
		if (octant >> axis & 1u)
			continue;
		walk_faces(j, low.tile ? gw_compartment_child(j->c, low, octant | 1u << axis) : low,
				   high.tile ? gw_compartment_child(j->c, high, octant) : high, axis);
	}
}

/* All faces within a cell. */
static void walk_within(joining *j, gw_compartment_cell of)
{
	gw_compartment_cell child[8];
	for (uint32_t octant = 0; octant < 8; octant++)
		child[octant] = gw_compartment_child(j->c, of, octant);
	for (uint32_t octant = 0; octant < 8; octant++) {
		if (child[octant].tile != 0 && child[octant].tile != GW_WALL)
			walk_within(j, child[octant]);
		for (uint32_t axis = 0; axis < 3; axis++)
			if ((octant >> axis & 1u) == 0)
				walk_faces(j, child[octant], child[octant | 1u << axis], axis);
	}
}

/* Empty cells at a side of the cube touch what lies around it. */
static void walk_outside(joining *j, gw_compartment_cell of, uint32_t axis, uint32_t side)
{
	if (of.tile == GW_WALL)
		return;
	if (of.tile == 0) {
		meet(j, of.number, j->c->cells);
		return;
	}
	for (uint32_t octant = 0; octant < 8; octant++)
		if ((octant >> axis & 1u) == side)
			walk_outside(j, gw_compartment_child(j->c, of, octant), axis, side);
}

static const gw_compartment_cell root = { GW_COMPARTMENT_UNKNOWN, 1, 0 };

static void walk(joining *j)
{
	walk_within(j, root);
	for (uint32_t axis = 0; axis < 3; axis++)
		for (uint32_t side = 0; side < 2; side++)
			walk_outside(j, root, axis, side);
}

/* The cells that pairs say touch each cell: those of cell i are cell[first[i]] to cell[first[i + 1]
 * - 1]. */
typedef struct touching {
	uint32_t *first, *cell;
	uint32_t *queue; /* cells from which others are to be reached */
} touching;

static bool list_touching(const joining *j, touching *t)
{
	size_t cells = (size_t)j->c->cells + 1, entries = 2 * j->pairs;
	*t = (touching){ 0 };
	if (entries >= UINT32_MAX)
		return false;
	t->first = gw_allocate_zeros(cells + 1, sizeof *t->first);
	t->cell = gw_allocate_array(entries, sizeof *t->cell);
	t->queue = gw_allocate_array(entries, sizeof *t->queue);
	if (!t->first || !t->cell || !t->queue)
		return false;
	for (size_t i = 0; i < entries; i++)
		t->first[j->pair[i / 2].of[i % 2]]++;
	for (size_t i = 1; i <= cells; i++)
		t->first[i] += t->first[i - 1];
	for (size_t i = entries; i-- > 0;)
		t->cell[--t->first[j->pair[i / 2].of[i % 2]]] = j->pair[i / 2].of[1 - i % 2];
	return true;
}

/* From cell to cell, the nearest first, so that compartments meet half way. */
static void reach(joining *j, const touching *t)
{
	size_t done = 0, queued = 0;
	for (size_t i = 0; i < 2 * j->pairs; i++) {
		uint32_t cell = j->pair[i / 2].of[i % 2];
		if (j->reached[cell] == NARROW || j->reached[cell] == QUEUED)
			continue;
		j->reached[cell] = QUEUED;
		t->queue[queued++] = cell;
	}
	while (done < queued) {
		uint32_t from = t->queue[done++];
		for (uint32_t k = t->first[from]; k < t->first[from + 1]; k++) {
			uint32_t to = t->cell[k];
			if (j->reached[to] != NARROW)
				continue;
			j->reached[to] = QUEUED;
			unite(j->c->label, from, to);
			t->queue[queued++] = to;
		}
	}
}

/* Cells that are never reached join each other. */
static bool join_narrow(joining *j)
{
	touching t;
	bool fits = list_touching(j, &t);
	if (fits)
		reach(j, &t);
	free(t.first);
	free(t.cell);
	free(t.queue);
	for (size_t i = 0; i < j->pairs; i++)
		if (j->reached[j->pair[i].of[0]] == NARROW && j->reached[j->pair[i].of[1]] == NARROW)
			unite(j->c->label, j->pair[i].of[0], j->pair[i].of[1]);
	return fits;
}

static void flatten(gw_compartments *c)
{
	for (uint32_t i = 0; i <= c->cells; i++)
		c->label[i] = find(c->label, i);
}

/* The first empty cell along a way, or GW_COMPARTMENT_UNKNOWN. */
static uint32_t look(const gw_compartments *c, const float *from, const float *way, float step)
{
	uint32_t label = GW_COMPARTMENT_UNKNOWN;
	for (int i = 1; i <= STEPS && label == GW_COMPARTMENT_UNKNOWN; i++) {
		int32_t at[3];
		for (int k = 0; k < 3; k++) {
			float place = from[k] + step * (float)i * way[k];
			at[k] = place >= 0.0f && place < (float)(1u << c->depth) ? (int32_t)place : -1;
		}
		label = gw_compartment_of_cell(c, at);
	}
	return label;
}

typedef struct looking {
	const gw_compartments *c;
	const float *place, *normal, *size;
	_Atomic uint32_t *looks; /* 2 a label */
} looking;

/* Counts the surfels that face a label, and those that show it their back. */
static void look_around(void *user, size_t first, size_t last, uint32_t worker)
{
	const looking *l = user;
	(void)worker;
	for (size_t i = first; i < last; i++) {
		const float *n = l->normal + 4 * i, back[3] = { -n[0], -n[1], -n[2] };
		float radius = l->size[4 * i];
		float step = STEP * (radius < GW_SPARSE_RADIUS ? 1.0f : exp2f(floorf(log2f(radius))));
		uint32_t before = look(l->c, l->place + 4 * i, n, step);
		uint32_t behind = look(l->c, l->place + 4 * i, back, step);
		if (before != GW_COMPARTMENT_UNKNOWN)
			atomic_fetch_add_explicit(&l->looks[2 * (size_t)before], 1, memory_order_relaxed);
		if (behind != GW_COMPARTMENT_UNKNOWN)
			atomic_fetch_add_explicit(&l->looks[2 * (size_t)behind + (n[3] > 0.5f ? 0 : 1)], 1,
									  memory_order_relaxed);
	}
}

static bool is_rock(const _Atomic uint32_t *looks, uint32_t label)
{
	return BACKS_TO_ROCK * looks[2 * (size_t)label] < looks[2 * (size_t)label + 1];
}

/* Joins what meets in necks, but for rock with anything else. */
static void join_necks(joining *j, const _Atomic uint32_t *looks)
{
	uint32_t *label = j->c->label;
	for (size_t i = 0; i < j->pairs; i++) {
		uint32_t low = find(label, j->pair[i].of[0]), high = find(label, j->pair[i].of[1]);
		if (low != high && is_rock(looks, low) == is_rock(looks, high))
			unite(label, low, high);
	}
	flatten(j->c);
}

static gw_status look_at_necks(gw_gpu *gpu, const gw_octree *o, size_t surfels, joining *j,
							   gw_error *error)
{
	const gw_buffer *const buffer[3] = { &o->surfel_position, &o->surfel_normal, &o->surfel_disc };
	gw_view view[3] = { 0 };
	_Atomic uint32_t *looks = gw_allocate_zeros((size_t)j->c->cells + 1, 2 * sizeof *looks);
	gw_status status =
		looks ? GW_OK
			  : gw_fail(error, GW_ERROR_MEMORY, "no memory for what %u cells face", j->c->cells);
	for (int i = 0; i < 3 && status == GW_OK; i++)
		status = gw_view_open(gpu, buffer[i], 16 * (uint64_t)surfels, &view[i], error);
	if (status == GW_OK) {
		looking l = { j->c, view[0].bytes, view[1].bytes, view[2].bytes, looks };
		gw_parallel_for(j->threads, surfels, CHUNK, look_around, &l);
		join_necks(j, looks);
	}
	for (int i = 0; i < 3; i++)
		gw_view_close(&view[i]);
	free(looks);
	return status;
}

/* Do two compartments meet in a neck? */
static bool has_necks(const joining *j)
{
	for (size_t i = 0; i < j->pairs; i++)
		if (j->c->label[j->pair[i].of[0]] != j->c->label[j->pair[i].of[1]])
			return true;
	return false;
}

static gw_status join_all(gw_gpu *gpu, const gw_octree *octree, size_t surfels, joining *j,
						  gw_error *error)
{
	for (int i = 0; i < 2; i++) {
		j->first = i == 0;
		walk(j);
	}
	if (j->failed || !join_narrow(j))
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu necks", j->pairs);
	flatten(j->c);
	return has_necks(j) ? look_at_necks(gpu, octree, surfels, j, error) : GW_OK;
}

/* Which cells are narrow. */
static void begin(joining *j)
{
	const gw_compartments *c = j->c;
	for (uint32_t i = 0; i <= c->cells; i++)
		c->label[i] = i;
	for (uint32_t i = 0; i < c->cells; i++) {
		uint8_t necks = i < c->first ? c->node_neck[i / 8] : c->leaf_neck[(i - c->first) / 8];
		j->reached[i] = necks >> i % 8 & 1 ? NARROW : WIDE;
	}
	j->reached[c->cells] = WIDE;
}

gw_status gw_compartments_join(gw_gpu *gpu, const gw_octree *octree, size_t surfels,
							   uint32_t threads, gw_compartments *c, gw_error *error)
{
	uint64_t cells = c->first + 8 * (uint64_t)octree->leaf_tile_count;
	joining j = { .c = c, .threads = threads };
	if (cells < GW_COMPARTMENT_UNKNOWN) {
		c->label = gw_allocate_array(cells + 1, sizeof *c->label);
		j.reached = gw_allocate_array(cells + 1, sizeof *j.reached);
	}
	c->cells = (uint32_t)cells;
	gw_status status = c->label && j.reached
						   ? GW_OK
						   : gw_fail(error, GW_ERROR_MEMORY, "no memory for %llu cells",
									 (unsigned long long)cells);
	if (status == GW_OK) {
		begin(&j);
		status = join_all(gpu, octree, surfels, &j, error);
	}
	gw_compartments_drop_necks(c);
	free(j.pair);
	free(j.reached);
	return status;
}

/*
 * check_tree.c - see check_tree.h. Discs are shared out by halving them along the widest side of
 * where they are, which does not care how unevenly they lie.
 */
#include "estimate/check_tree.h"

#include "base/memory.h"
#include "base/shader_math.h"
#include "glowworm_host.h"
#include "light/transport_layout.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LEAF_DISCS 4u

/* ------------------------------------------------------------------------------------ building */

typedef struct place {
	float at[3];
	uint32_t surfel;
} place;

typedef struct box {
	float low[3], high[3];
} box;

typedef struct building {
	const gw_surfels *surfels;
	float reach; /* of discs, in radii of the surfels */
	place *place;
	gw_check_node *node;
	struct branch *branch; /* branches, each after the one that it is of */
	size_t branches, done; /* those before `done` have their node */
} building;

/* The discs below a child of a node. */
typedef struct branch {
	size_t first, last;
	uint32_t number;       /* of their node, and those below it have the next ones */
	uint32_t parent, lane; /* whose box is theirs */
	box box;
} branch;

static box empty_box(void)
{
	return (box){ { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } };
}

static int widest_axis(const place *p, size_t first, size_t last)
{
	box b = empty_box();
	int axis = 0;
	for (size_t i = first; i < last; i++)
		for (int k = 0; k < 3; k++) {
			b.low[k] = gw_smaller(b.low[k], p[i].at[k]);
			b.high[k] = gw_larger(b.high[k], p[i].at[k]);
		}
	for (int k = 1; k < 3; k++)
		if (b.high[k] - b.low[k] > b.high[axis] - b.low[axis])
			axis = k;
	return axis;
}

/* Along an axis, and where they are level by number, so that the order is one. */
static bool before(const place *a, const place *b, int axis)
{
	return a->at[axis] < b->at[axis] || (a->at[axis] == b->at[axis] && a->surfel < b->surfel);
}

static void swap(place *a, place *b)
{
	place kept = *a;
	*a = *b;
	*b = kept;
}

/* Puts the places before `middle` that lie before those after it (Hoare's selection). */
static void select_half(place *p, size_t first, size_t last, size_t middle, int axis)
{
	while (last - first > 1) {
		size_t i = first, j = last - 1;
		place pivot = p[first + (last - first) / 2];
		while (true) {
			while (before(&p[i], &pivot, axis))
				i++;
			while (before(&pivot, &p[j], axis))
				j--;
			if (i >= j)
				break;
			swap(&p[i++], &p[j--]);
		}
		size_t cut = j + 1;
		if (cut <= first || cut >= last)
			cut = i == first ? first + 1 : i;
		if (middle < cut)
			last = cut;
		else
			first = cut;
	}
}

static size_t half_of(size_t first, size_t last)
{
	return first + (last - first) / 2;
}

static size_t halve(building *b, size_t first, size_t last)
{
	size_t middle = half_of(first, last);
	if (last - first > LEAF_DISCS)
		select_half(b->place, first, last, middle, widest_axis(b->place, first, last));
	return middle;
}

static box box_of_discs(const building *b, size_t first, size_t last)
{
	box all = empty_box();
	for (size_t i = first; i < last; i++) {
		size_t s = b->place[i].surfel;
		float radius = b->reach * b->surfels->radius[s];
		for (int k = 0; k < 3; k++) {
			float n = b->surfels->normal[3 * s + (size_t)k], at = b->place[i].at[k];
			float reach =
				radius * (sqrtf(gw_larger(0.0f, 1.0f - n * n)) + 1e-4f) + 1e-6f * fabsf(at);
			all.low[k] = gw_smaller(all.low[k], at - reach);
			all.high[k] = gw_larger(all.high[k], at + reach);
		}
	}
	return all;
}

static uint32_t leaf_of(size_t first, size_t last)
{
	return last > first ? GW_CHECK_LEAF | (uint32_t)(last - first - 1) << 28 | (uint32_t)first
						: GW_NONE;
}

static void join_box(box *all, const box *part)
{
	for (int k = 0; k < 3; k++) {
		all->low[k] = gw_smaller(all->low[k], part->low[k]);
		all->high[k] = gw_larger(all->high[k], part->high[k]);
	}
}

static void set_box(gw_check_node *node, size_t lane, const box *part)
{
	for (int k = 0; k < 3; k++) {
		node->low[k][lane] = part->low[k];
		node->high[k][lane] = part->high[k];
	}
}

/* Shares a range out to four. */
static void quarter(building *b, size_t first, size_t last, size_t from[5])
{
	from[0] = first;
	from[2] = halve(b, first, last);
	from[1] = halve(b, first, from[2]);
	from[3] = halve(b, from[2], last);
	from[4] = last;
}

static bool is_leaf(size_t first, size_t last)
{
	return last - first <= LEAF_DISCS;
}

/* Adds the node of a range, and those below it; returns its box.
 *   next   the number of the node, if there is one; receives the first that is free */
static box add_node(building *b, size_t first, size_t last, uint32_t *next)
{
	box all = empty_box();
	size_t from[5];
	if (is_leaf(first, last))
		return box_of_discs(b, first, last);
	gw_check_node *own = b->node + (*next)++;
	quarter(b, first, last, from);
	for (size_t c = 0; c < 4; c++) {
		own->child[c] = is_leaf(from[c], from[c + 1]) ? leaf_of(from[c], from[c + 1]) : *next;
		box part = add_node(b, from[c], from[c + 1], next);
		set_box(own, c, &part);
		join_box(&all, &part);
	}
	return all;
}

size_t gw_check_tree_nodes(size_t count)
{
	if (count <= LEAF_DISCS)
		return 0;
	size_t low = count / 2, high = count - low;
	return 1 + gw_check_tree_nodes(low / 2) + gw_check_tree_nodes(low - low / 2) +
		   gw_check_tree_nodes(high / 2) + gw_check_tree_nodes(high - high / 2);
}

/* Branches of some levels at the top are made on their own, those of a level side by side. */
#define TOP_LEVELS 3
#define BRANCHES_MOST (1 + 4 + 16 + 64)

/* Makes the node of a branch, of which four others come. */
static void fork_branch(building *b, const branch *own, branch *four)
{
	size_t from[5];
	uint32_t next = own->number + 1;
	quarter(b, own->first, own->last, from);
	for (uint32_t c = 0; c < 4; c++) {
		bool leaf = is_leaf(from[c], from[c + 1]);
		b->node[own->number].child[c] = leaf ? leaf_of(from[c], from[c + 1]) : next;
		four[c] = (branch){ from[c], from[c + 1], next, own->number, c, empty_box() };
		next += (uint32_t)gw_check_tree_nodes(from[c + 1] - from[c]);
	}
}

static void fork_branches(void *user, size_t first, size_t last, uint32_t worker)
{
	building *b = user;
	(void)worker;
	for (size_t i = first; i < last; i++)
		fork_branch(b, &b->branch[b->done + i], &b->branch[b->branches + 4 * i]);
}

static void fill_branches(void *user, size_t first, size_t last, uint32_t worker)
{
	building *b = user;
	(void)worker;
	for (size_t i = first; i < last; i++) {
		branch *own = &b->branch[b->done + i];
		uint32_t next = own->number;
		own->box = add_node(b, own->first, own->last, &next);
	}
}

/* The boxes of all branches, the last one first: each joins that of the branch that it is of. By
 * one thread, as four share a node. */
static void join_branches(building *b)
{
	for (size_t i = b->branches; i-- > 1;) {
		branch *own = &b->branch[i];
		set_box(&b->node[own->parent], own->lane, &own->box);
		join_box(&b->branch[(i - 1) / 4].box, &own->box);
	}
}

/* Adds all nodes of so many discs, more than a leaf takes. */
static void add_nodes(building *b, size_t count, uint32_t threads)
{
	branch branches[BRANCHES_MOST] = { { .last = count, .box = empty_box() } };
	b->branch = branches;
	b->branches = 1;
	for (int level = 0; level < TOP_LEVELS; level++) {
		size_t of_level = b->branches - b->done;
		if (is_leaf(0, count >> 2 * level))
			break;
		gw_parallel_for(threads, of_level, 1, fork_branches, b);
		b->done = b->branches;
		b->branches += 4 * of_level;
	}
	gw_parallel_for(threads, b->branches - b->done, 1, fill_branches, b);
	join_branches(b);
	b->branch = NULL;
}

static void list_places(const gw_surfels *s, place *p)
{
	for (size_t i = 0; i < s->count; i++) {
		p[i].surfel = (uint32_t)i;
		memcpy(p[i].at, s->position + 3 * i, sizeof p[i].at);
	}
}

gw_status gw_check_tree_make(const gw_surfels *s, float reach, uint32_t threads,
							 gw_check_tree *tree, gw_error *error)
{
	if (tree->surfel)
		return GW_OK;
	size_t nodes = gw_check_tree_nodes(s->count);
	building b = { .surfels = s,
				   .reach = reach,
				   .place = gw_allocate_array(s->count, sizeof *b.place) };
	tree->surfel = gw_allocate_array(s->count, sizeof *tree->surfel);
	tree->node = b.node = gw_allocate_array(nodes, sizeof *b.node);
	if (!b.place || !tree->surfel || !b.node || s->count > GW_CHECK_DISCS_MOST) {
		free(b.place);
		gw_check_tree_clear(tree);
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the discs of %zu points", s->count);
	}
	list_places(s, b.place);
	if (nodes > 0)
		add_nodes(&b, s->count, threads);
	tree->nodes = (uint32_t)nodes;
	for (size_t i = 0; i < s->count; i++)
		tree->surfel[i] = b.place[i].surfel;
	free(b.place);
	return GW_OK;
}

/* ------------------------------------------------------------------------------------ checking */

/* Whether a range has the node that add_node gives it, or the leaf. */
static bool node_fits(const gw_check_tree *tree, size_t first, size_t last, uint32_t *nodes,
					  uint32_t number)
{
	if (last - first <= LEAF_DISCS)
		return number == leaf_of(first, last);
	size_t middle = half_of(first, last);
	size_t from[5] = { first, half_of(first, middle), middle, half_of(middle, last), last };
	if (number != (*nodes)++)
		return false;
	for (size_t c = 0; c < 4; c++)
		if (!node_fits(tree, from[c], from[c + 1], nodes, tree->node[number].child[c]))
			return false;
	return true;
}

bool gw_check_tree_fits(const gw_check_tree *tree, size_t count)
{
	uint32_t nodes = 0;
	if (!tree->surfel || count <= LEAF_DISCS)
		return true;
	return count <= GW_CHECK_DISCS_MOST && tree->nodes == gw_check_tree_nodes(count) &&
		   node_fits(tree, 0, count, &nodes, 0);
}

void gw_check_tree_clear(gw_check_tree *tree)
{
	if (!tree->lent) {
		free(tree->surfel);
		free(tree->node);
	}
	*tree = (gw_check_tree){ 0 };
}

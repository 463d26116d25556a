/*
 * check_tree.c - see check_tree.h. Discs are shared out by halving them along the widest side of
 * where they are, which does not care how unevenly they lie.
 */
#include "estimate/check_tree.h"

#include "base/memory.h"
#include "base/shader_math.h"
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
	uint32_t nodes;
} building;

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

/* Adds the node of a range, and those below it; returns its box. */
static box add_node(building *b, size_t first, size_t last, uint32_t *number)
{
	box all = empty_box();
	if (last - first <= LEAF_DISCS) {
		*number = leaf_of(first, last);
		return box_of_discs(b, first, last);
	}
	size_t middle = halve(b, first, last);
	size_t from[5] = { first, halve(b, first, middle), middle, halve(b, middle, last), last };
	uint32_t own = *number = b->nodes++;
	for (size_t c = 0; c < 4; c++) {
		uint32_t child;
		box part = add_node(b, from[c], from[c + 1], &child);
		b->node[own].child[c] = child;
		for (int k = 0; k < 3; k++) {
			b->node[own].low[k][c] = part.low[k];
			b->node[own].high[k][c] = part.high[k];
			all.low[k] = gw_smaller(all.low[k], part.low[k]);
			all.high[k] = gw_larger(all.high[k], part.high[k]);
		}
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

static void list_places(const gw_surfels *s, place *p)
{
	for (size_t i = 0; i < s->count; i++) {
		p[i].surfel = (uint32_t)i;
		memcpy(p[i].at, s->position + 3 * i, sizeof p[i].at);
	}
}

gw_status gw_check_tree_make(const gw_surfels *s, float reach, gw_check_tree *tree, gw_error *error)
{
	if (tree->surfel)
		return GW_OK;
	building b = { .surfels = s,
				   .reach = reach,
				   .place = gw_allocate_array(s->count, sizeof *b.place) };
	tree->surfel = gw_allocate_array(s->count, sizeof *tree->surfel);
	tree->node = b.node = gw_allocate_array(gw_check_tree_nodes(s->count), sizeof *b.node);
	if (!b.place || !tree->surfel || !b.node || s->count > GW_CHECK_DISCS_MOST) {
		free(b.place);
		gw_check_tree_clear(tree);
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the discs of %zu points", s->count);
	}
	list_places(s, b.place);
	uint32_t root;
	add_node(&b, 0, s->count, &root);
	tree->nodes = b.nodes;
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

#include "las/copc_tree.h"
#include "files/growing_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define DEPTH 21     /* bits of a place along an axis: three fill a key */
#define DIGIT_BITS 9 /* by which keys are sorted */
#define CELL_BITS 7  /* of a place in a node, of which it holds one point */

/* Up to this many points are one node; fewer than these are no node by themselves. */
#define NODE_POINTS 25000
#define NODE_LEAST 2000

/* A point and its place on the Z-order curve. */
typedef struct item {
	uint64_t key;
	size_t index;
} item;

typedef struct growing {
	copc_tree *tree;
	item *items, *spare; /* owned; in the nodes' order as far as they are done, then by key */
	bool *kept;          /* owned; of a node's points: it holds them itself */
	const char *name;    /* of the file */
	gw_error *error;
} growing;

static gw_status fail_memory(const char *name, gw_error *error)
{
	return gw_fail(error, GW_ERROR_MEMORY, "no memory for the octree of %s", name);
}

/* ------------------------------------------------------------------------------------ places */

/* The smallest cube around what the grid holds; that of a single point has some size. */
static void find_cube(copc_tree *tree, const las_records *records)
{
	tree->half_size = 0.0;
	for (int k = 0; k < 3; k++) {
		const las_grid *grid = &records->grid[k];
		tree->center[k] = 0.5 * grid->minimum + 0.5 * grid->maximum;
		tree->half_size = fmax(tree->half_size, 0.5 * (grid->maximum - grid->minimum));
		tree->half_size = fmax(tree->half_size, fabs(grid->scale));
	}
	tree->spacing = 2.0 * tree->half_size / (1 << CELL_BITS);
}

/* Puts two zeros behind each of the 21 lowest bits. */
static uint64_t spread(uint64_t v)
{
	v = (v | v << 32) & 0x001f00000000ffff;
	v = (v | v << 16) & 0x001f0000ff0000ff;
	v = (v | v << 8) & 0x100f00f00f00f00f;
	v = (v | v << 4) & 0x10c30c30c30c30c3;
	return (v | v << 2) & 0x1249249249249249;
}

/* The other way: every third bit. */
static int32_t gather(uint64_t v)
{
	int32_t place = 0;
	for (int bit = 0; bit < DEPTH; bit++)
		place |= (int32_t)(v >> 3 * bit & 1) << bit;
	return place;
}

/* x is the lowest bit of each three. */
static uint64_t find_key(const copc_tree *tree, const las_records *records, size_t i)
{
	uint64_t key = 0;
	for (int k = 0; k < 3; k++) {
		const las_grid *grid = &records->grid[k];
		double value = scan_value(records->column[k], i);
		double stored = las_grid_place(grid, value) * grid->scale + grid->offset;
		double place = (stored - tree->center[k]) / tree->half_size * 0.5 + 0.5;
		double cell = fmin(fmax(floor(ldexp(place, DEPTH)), 0.0), ldexp(1.0, DEPTH) - 1.0);
		key |= spread((uint64_t)cell) << k;
	}
	return key;
}

/* One digit of the keys, in order; points of the same digit stay as they are. */
static void sort_by_digit(const item *from, item *to, size_t count, int shift)
{
	size_t start[1 << DIGIT_BITS] = { 0 }, sum = 0;
	for (size_t i = 0; i < count; i++)
		start[from[i].key >> shift & ((1 << DIGIT_BITS) - 1)]++;
	for (size_t d = 0; d < 1 << DIGIT_BITS; d++) {
		size_t of_digit = start[d];
		start[d] = sum;
		sum += of_digit;
	}
	for (size_t i = 0; i < count; i++)
		to[start[from[i].key >> shift & ((1 << DIGIT_BITS) - 1)]++] = from[i];
}

/* By key, the lowest digit first; then by index, as they are. */
static void sort_items(growing *g, size_t count)
{
	for (int shift = 0; shift < 3 * DEPTH; shift += DIGIT_BITS) {
		sort_by_digit(g->items, g->spare, count, shift);
		item *sorted = g->spare;
		g->spare = g->items;
		g->items = sorted;
	}
}

/* ------------------------------------------------------------------------------------- nodes */

static gw_status add_node(growing *g, int32_t level, size_t first, size_t count)
{
	copc_tree *tree = g->tree;
	copc_node *grown = growing_table_room(tree->node, tree->node_count, sizeof *grown);
	if (!grown)
		return fail_memory(g->name, g->error);
	tree->node = grown;
	copc_node *node = &tree->node[tree->node_count++];
	*node = (copc_node){ .level = level, .first = first, .count = count };
	uint64_t place = g->items[first].key >> 3 * (DEPTH - level);
	for (int k = 0; k < 3; k++)
		node->place[k] = gather(place >> k);
	return GW_OK;
}

/* The number of the child of a node in which a point is. */
static unsigned child_of(const copc_node *node, uint64_t key)
{
	return (unsigned)(key >> 3 * (DEPTH - node->level - 1)) & 7;
}

/* Where the points end that lie in the same cell of a node as the first of them. */
static size_t cell_end(const item *items, size_t first, size_t count, int shift)
{
	size_t last = first + 1;
	while (last < count && items[last].key >> shift == items[first].key >> shift)
		last++;
	return last;
}

/* How many points of each cell a node takes: more than one where few cells have any, as when a
 * stray is far from all others. */
static size_t points_of_cell(const item *items, size_t count, int shift)
{
	size_t cells = 0;
	for (size_t first = 0; first < count; first = cell_end(items, first, count, shift))
		cells++;
	return cells < NODE_LEAST ? NODE_LEAST / cells : 1;
}

/* Chooses what a node holds itself: of each cell's points those in the middle of equal parts, and
 * the others of children that would get few. */
static void choose(growing *g, const copc_node *node, size_t rest[8])
{
	int shift = 3 * (DEPTH - node->level - CELL_BITS);
	const item *items = g->items + node->first;
	size_t most = points_of_cell(items, node->count, shift);
	memset(g->kept, 0, node->count * sizeof *g->kept);
	for (size_t first = 0, last; first < node->count; first = last) {
		last = cell_end(items, first, node->count, shift);
		size_t all = last - first, taken = most < all ? most : all;
		for (size_t t = 0; t < taken; t++)
			g->kept[first + (2 * t + 1) * all / (2 * taken)] = true;
		rest[child_of(node, items[first].key)] += all - taken;
	}
	for (size_t i = 0; i < node->count; i++)
		g->kept[i] = g->kept[i] || rest[child_of(node, items[i].key)] < NODE_LEAST;
	for (int c = 0; c < 8; c++)
		rest[c] = rest[c] < NODE_LEAST ? 0 : rest[c];
}

/* Brings what a node holds to the front. Returns how many they are. */
static size_t part(growing *g, const copc_node *node)
{
	item *items = g->items + node->first;
	size_t kept = 0, others = 0;
	for (size_t i = 0; i < node->count; i++)
		if (g->kept[i])
			items[kept++] = items[i];
		else
			g->spare[others++] = items[i];
	memcpy(items + kept, g->spare, others * sizeof *items);
	return kept;
}

/* Gives a node's children what it does not hold itself. */
static gw_status split(growing *g, size_t number)
{
	copc_node node = g->tree->node[number];
	size_t rest[8] = { 0 };
	if (node.count <= NODE_POINTS || node.level + CELL_BITS >= DEPTH)
		return GW_OK;
	choose(g, &node, rest);
	size_t kept = part(g, &node), first = node.first + kept;
	g->tree->node[number].count = kept;
	for (int c = 0; c < 8; c++) {
		if (rest[c] > 0)
			GW_TRY(add_node(g, node.level + 1, first, rest[c]));
		first += rest[c];
	}
	return GW_OK;
}

/* ---------------------------------------------------------------------------------- the tree */

static gw_status grow(growing *g, const las_records *records)
{
	copc_tree *tree = g->tree;
	size_t count = records->cloud->count;
	g->items = reallocarray(NULL, count + 1, sizeof *g->items);
	g->spare = reallocarray(NULL, count + 1, sizeof *g->spare);
	g->kept = calloc(count + 1, sizeof *g->kept);
	tree->order = reallocarray(NULL, count + 1, sizeof *tree->order);
	if (!g->items || !g->spare || !g->kept || !tree->order)
		return fail_memory(g->name, g->error);
	for (size_t i = 0; i < count; i++)
		g->items[i] = (item){ find_key(tree, records, i), i };
	sort_items(g, count);
	if (count > 0)
		GW_TRY(add_node(g, 0, 0, count));
	for (size_t n = 0; n < tree->node_count; n++)
		GW_TRY(split(g, n));
	for (size_t i = 0; i < count; i++)
		tree->order[i] = g->items[i].index;
	return GW_OK;
}

gw_status copc_tree_make(copc_tree *tree, const las_records *records, gw_error *error)
{
	growing g = { .tree = tree, .name = records->name, .error = error };
	*tree = (copc_tree){ 0 };
	find_cube(tree, records);
	gw_status status = grow(&g, records);
	free(g.items);
	free(g.spare);
	free(g.kept);
	return status;
}

void copc_tree_clear(copc_tree *tree)
{
	free(tree->order);
	free(tree->node);
	*tree = (copc_tree){ 0 };
}

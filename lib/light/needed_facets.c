/*
 * needed_facets.c - see needed_facets.h. Leaves lie in Morton order, so that those of a node follow
 * each other.
 */
#include "light/needed_facets.h"

#include "base/memory.h"
#include "light/transport_layout.h"
#include "octree/octree_layout.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Facets of a node are needed unless they face away by more than this cosine from what was hit on
 * average: at an edge of a room hits on two walls face 45 degrees to either side of their mean, and
 * the outsides of these walls 135. */
#define FACES_LEAST -0.25f

static uint32_t levels_of(float cells)
{
	uint32_t levels = 0;
	while (levels < GW_DEPTH_MAX && (float)(1u << levels) < cells)
		levels++;
	return levels;
}

/* Numbers the nodes, 2^levels leaf cells a side, in the order of their leaves. key: NULL, or room
 * for leaves numbers, receives the Morton key of each. */
static size_t number_nodes(const uint32_t *cell, size_t leaves, uint32_t levels, uint32_t *node,
						   uint64_t *key)
{
	size_t nodes = 0;
	uint64_t last = 0;
	for (size_t i = 0; i < leaves; i++) {
		uint64_t own = gw_morton_encode(cell[4 * i] >> levels, cell[4 * i + 1] >> levels,
										cell[4 * i + 2] >> levels);
		if (i == 0 || own != last) {
			if (key)
				key[nodes] = own;
			nodes++;
		}
		last = own;
		node[i] = (uint32_t)nodes - 1;
	}
	return nodes;
}

static gw_status fill(gw_gpu *gpu, const gw_octree *octree, gw_needed_facets *n, gw_error *error)
{
	gw_view cell = { 0 };
	uint64_t leaves = octree->leaf_count, bytes = 16 * (uint64_t)n->facets;
	GW_TRY(gw_view_open(gpu, &octree->leaf_cell, 16 * leaves, &cell, error));
	n->nodes = number_nodes(cell.bytes, leaves, levels_of(GW_NEEDED_NODE), n->node, NULL);
	gw_view_close(&cell);
	for (size_t i = 0; i < n->facets; i++)
		n->spacing[i] = INFINITY;
	GW_TRY(gw_buffer_download(gpu, &octree->facet_leaf, 0, n->leaf, bytes / 4, error));
	GW_TRY(gw_buffer_download(gpu, &octree->facet_centre, 0, n->centre, bytes, error));
	return gw_buffer_download(gpu, &octree->facet_plane, 0, n->plane, bytes, error);
}

gw_status gw_needed_facets_make(gw_gpu *gpu, const gw_octree *octree, gw_needed_facets *needed,
								gw_error *error)
{
	size_t facets = octree->facet_count;
	*needed = (gw_needed_facets){ .facets = facets,
								  .centre = gw_allocate_array(facets, 4 * sizeof(float)),
								  .plane = gw_allocate_array(facets, 4 * sizeof(float)),
								  .leaf = gw_allocate_array(facets, sizeof(uint32_t)),
								  .node = gw_allocate_array(octree->leaf_count, sizeof(uint32_t)),
								  .spacing = gw_allocate_array(facets, sizeof(float)) };
	gw_status status =
		needed->centre && needed->plane && needed->leaf && needed->node && needed->spacing
			? fill(gpu, octree, needed, error)
			: gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu facets", facets);
	if (status != GW_OK)
		gw_needed_facets_clear(needed);
	return status;
}

void gw_needed_facets_clear(gw_needed_facets *needed)
{
	free(needed->centre);
	free(needed->plane);
	free(needed->leaf);
	free(needed->node);
	free(needed->spacing);
	*needed = (gw_needed_facets){ 0 };
}

static bool has_surface(const gw_needed_facets *n, size_t facet)
{
	return n->centre[4 * facet + 3] > 0.0f;
}

/* --------------------------------------------------------------------------------------- around */

/* Nodes as wide as the reach. */
typedef struct blocks {
	uint64_t *key; /* count, ascending */
	size_t count;
	uint32_t *of_leaf;
	bool *chosen; /* count: holds some of what is asked for */
	bool *near;   /* count: touches one that does */
} blocks;

/* The number of a node, or the count of all. */
static size_t find_block(const blocks *b, uint64_t key)
{
	size_t low = 0, high = b->count;
	while (low < high) {
		size_t middle = low + (high - low) / 2;
		if (b->key[middle] < key)
			low = middle + 1;
		else
			high = middle;
	}
	return low < b->count && b->key[low] == key ? low : b->count;
}

static void mark_around(const blocks *b, size_t block)
{
	uint32_t at[3];
	gw_morton_decode(b->key[block], at);
	for (uint32_t i = 0; i < 27; i++) {
		/* At the low end of the grid there are two free cells. */
		uint32_t x = at[0] + i % 3 - 1, y = at[1] + i / 3 % 3 - 1, z = at[2] + i / 9 - 1;
		if ((x | y | z) >> 20)
			continue;
		size_t found = find_block(b, gw_morton_encode(x, y, z));
		if (found < b->count)
			b->near[found] = true;
	}
}

static gw_status choose_blocks(gw_gpu *gpu, const gw_octree *octree, const bool *asked,
							   const blocks *b, gw_error *error)
{
	gw_view first = { 0 }, surfel = { 0 };
	size_t leaves = octree->leaf_count;
	gw_status status =
		gw_view_open(gpu, &octree->leaf_fragment, 4 * ((uint64_t)leaves + 1), &first, error);
	if (status == GW_OK)
		status = gw_view_open(gpu, &octree->fragment_surfel, 4 * (uint64_t)octree->fragment_count,
							  &surfel, error);
	const uint32_t *from = first.bytes, *word = surfel.bytes;
	for (size_t i = 0; i < leaves && status == GW_OK; i++)
		for (uint32_t f = from[i]; f < from[i + 1] && !b->chosen[b->of_leaf[i]]; f++)
			b->chosen[b->of_leaf[i]] = asked[word[f] & GW_FRAGMENT_SURFEL];
	gw_view_close(&surfel);
	gw_view_close(&first);
	return status;
}

static gw_status list_blocks(gw_gpu *gpu, const gw_octree *octree, float reach, blocks *b,
							 gw_error *error)
{
	size_t leaves = octree->leaf_count;
	gw_view cell = { 0 };
	b->key = gw_allocate_array(leaves, sizeof *b->key);
	b->of_leaf = gw_allocate_array(leaves, sizeof *b->of_leaf);
	b->chosen = gw_allocate_zeros(leaves, 2 * sizeof *b->chosen);
	if (!b->key || !b->of_leaf || !b->chosen)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu leaves", leaves);
	b->near = b->chosen + leaves;
	GW_TRY(gw_view_open(gpu, &octree->leaf_cell, 16 * (uint64_t)leaves, &cell, error));
	b->count = number_nodes(cell.bytes, leaves, levels_of(reach), b->of_leaf, b->key);
	gw_view_close(&cell);
	return GW_OK;
}

gw_status gw_needed_facets_around(gw_gpu *gpu, const gw_octree *octree, const bool *asked,
								  const gw_needed_reach *how, gw_needed_facets *needed,
								  gw_error *error)
{
	blocks b = { .count = 0 };
	gw_status status = list_blocks(gpu, octree, how->reach, &b, error);
	if (status == GW_OK)
		status = choose_blocks(gpu, octree, asked, &b, error);
	for (size_t i = 0; i < b.count && status == GW_OK; i++)
		if (b.chosen[i])
			mark_around(&b, i);
	for (size_t i = 0; i < needed->facets && status == GW_OK; i++)
		if (b.near[b.of_leaf[gw_facet_leaf(needed->leaf[i])]] && has_surface(needed, i))
			needed->spacing[i] = fminf(needed->spacing[i], how->spacing);
	free(b.key);
	free(b.of_leaf);
	free(b.chosen);
	return status;
}

/* ----------------------------------------------------------------------------------------- hits */

gw_status gw_needed_facets_hit(const uint32_t *hit, size_t hits, float spacing,
							   gw_needed_facets *needed, size_t *more, gw_error *error)
{
	float *facing = gw_allocate_zeros(needed->nodes, 3 * sizeof *facing);
	*more = 0;
	if (!facing)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu nodes", needed->nodes);
	for (size_t i = 0; i < hits; i++) {
		if (hit[i] == GW_NONE)
			continue;
		float *sum = facing + 3 * (size_t)needed->node[gw_facet_leaf(needed->leaf[hit[i]])];
		for (size_t k = 0; k < 3; k++)
			sum[k] += needed->plane[4 * (size_t)hit[i] + k];
	}
	for (size_t facet = 0; facet < needed->facets; facet++) {
		const float *sum = facing + 3 * (size_t)needed->node[gw_facet_leaf(needed->leaf[facet])];
		const float *own = needed->plane + 4 * facet;
		float length = sqrtf(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
		float along = sum[0] * own[0] + sum[1] * own[1] + sum[2] * own[2];
		if (!(length > 0.0f) || needed->spacing[facet] < INFINITY || !has_surface(needed, facet) ||
			along < FACES_LEAST * length)
			continue;
		needed->spacing[facet] = spacing;
		++*more;
	}
	free(facing);
	return GW_OK;
}

/* -------------------------------------------------------------------------------------- surfels */

/* The fragments of an octree on the host. */
typedef struct fragments {
	gw_view first, surfel, weight;
} fragments;

static void take_largest(const fragments *from, const gw_needed_facets *needed, float *largest,
						 uint32_t *facet)
{
	const uint32_t *first = from->first.bytes, *word = from->surfel.bytes;
	const float *weight = from->weight.bytes;
	for (uint32_t i = 0; i < needed->facets; i++) {
		size_t leaf = gw_facet_leaf(needed->leaf[i]);
		for (uint32_t f = first[leaf]; f < first[leaf + 1]; f++) {
			uint32_t own = word[f] & GW_FRAGMENT_SURFEL;
			if (!gw_facet_holds(needed->leaf[i], word[f]) || !(needed->spacing[i] < INFINITY) ||
				!(weight[f] > largest[own]))
				continue;
			largest[own] = weight[f];
			facet[own] = i;
		}
	}
}

static gw_status open_fragments(gw_gpu *gpu, const gw_octree *octree, fragments *from,
								gw_error *error)
{
	uint64_t words = 4 * (uint64_t)octree->fragment_count;
	GW_TRY(gw_view_open(gpu, &octree->leaf_fragment, 4 * ((uint64_t)octree->leaf_count + 1),
						&from->first, error));
	GW_TRY(gw_view_open(gpu, &octree->fragment_surfel, words, &from->surfel, error));
	return gw_view_open(gpu, &octree->fragment_weight, words, &from->weight, error);
}

static void close_fragments(fragments *from)
{
	gw_view_close(&from->weight);
	gw_view_close(&from->surfel);
	gw_view_close(&from->first);
}

/* The area of a facet, of that word, that is of the surfels, less all that is not. */
static float balance(const fragments *from, const bool *known, uint32_t of)
{
	const uint32_t *word = from->surfel.bytes;
	const uint32_t *first = (const uint32_t *)from->first.bytes + gw_facet_leaf(of);
	const float *weight = from->weight.bytes;
	float sum = 0.0f;
	for (uint32_t f = first[0]; f < first[1]; f++)
		if (gw_facet_holds(of, word[f]))
			sum += known[word[f] & GW_FRAGMENT_SURFEL] ? weight[f] : -weight[f];
	return sum;
}

gw_status gw_needed_facets_leave_out(gw_gpu *gpu, const gw_octree *octree, const bool *known,
									 gw_needed_facets *needed, gw_error *error)
{
	fragments from = { .first = { 0 } };
	gw_status status = open_fragments(gpu, octree, &from, error);
	for (size_t i = 0; i < needed->facets && status == GW_OK; i++)
		if (balance(&from, known, needed->leaf[i]) > 0.0f)
			needed->centre[4 * i + 3] = 0.0f;
	close_fragments(&from);
	return status;
}

gw_status gw_needed_facets_surfels(gw_gpu *gpu, const gw_octree *octree,
								   const gw_needed_facets *needed, size_t surfels, uint32_t *facet,
								   gw_error *error)
{
	fragments from = { .first = { 0 } };
	float *largest = gw_allocate_zeros(surfels, sizeof *largest);
	if (!largest)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu surfels", surfels);
	for (size_t i = 0; i < surfels; i++)
		facet[i] = GW_NONE;
	gw_status status = open_fragments(gpu, octree, &from, error);
	if (status == GW_OK)
		take_largest(&from, needed, largest, facet);
	close_fragments(&from);
	free(largest);
	return status;
}

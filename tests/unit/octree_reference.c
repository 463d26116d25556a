/*
 * octree_reference.c - see octree_reference.h. Sets of cells are sorted arrays of Morton keys, made
 * with qsort; nothing of it resembles the device's build.
 */
#include "octree_reference.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct key_set {
	uint64_t *key;
	uint32_t count, room;
} key_set;

static int compare_keys(const void *a, const void *b)
{
	uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
	return x < y ? -1 : x > y;
}

static bool add_key(key_set *set, uint64_t key)
{
	if (set->count == set->room) {
		uint32_t room = set->room * 2 + 64;
		uint64_t *grown = realloc(set->key, room * sizeof *grown);
		if (grown == NULL)
			return false;
		set->key = grown;
		set->room = room;
	}
	set->key[set->count++] = key;
	return true;
}

static void make_distinct(key_set *set)
{
	uint32_t kept = 0;
	if (set->count > 0)
		qsort(set->key, set->count, sizeof *set->key, compare_keys);
	for (uint32_t i = 0; i < set->count; i++)
		if (i == 0 || set->key[i] != set->key[i - 1])
			set->key[kept++] = set->key[i];
	set->count = kept;
}

/* Index plus one. */
static uint32_t find(const key_set *set, uint64_t key)
{
	const uint64_t *at = bsearch(&key, set->key, set->count, sizeof key, compare_keys);
	return at == NULL ? 0 : (uint32_t)(at - set->key) + 1;
}

/* All tiles that a cell which isn't empty needs for filtering: those that hold one of the 8 cells
 * at it and on its negative sides. */
static bool add_borders(key_set *parents, const uint32_t cell[3])
{
	for (uint32_t o = 0; o < 8; o++) {
		uint32_t x = o & 1, y = o >> 1 & 1, z = o >> 2;
		if (x > cell[0] || y > cell[1] || z > cell[2])
			continue;
		if (!add_key(parents,
					 gw_morton_encode((cell[0] - x) / 2, (cell[1] - y) / 2, (cell[2] - z) / 2)))
			return false;
	}
	return true;
}

/* The sets of cells whose children are a tile, by level; counts those that hold no leaf. */
static bool make_sets(uint32_t depth, const key_set *leaves, key_set *parent, uint32_t *border)
{
	*border = 0;
	for (uint32_t t = depth; t-- > 0;) {
		key_set real = { 0 };
		for (uint32_t i = 0; i < leaves->count; i++) {
			uint64_t key = leaves->key[i] >> 3 * (depth - 1 - t);
			uint32_t cell[3];
			gw_morton_decode(key, cell);
			if (!add_key(&real, key >> 3) || !add_borders(&parent[t], cell)) {
				free(real.key);
				return false;
			}
		}
		for (uint32_t i = 0; t + 1 < depth && i < parent[t + 1].count; i++)
			if (!add_key(&parent[t], parent[t + 1].key[i] >> 3)) {
				free(real.key);
				return false;
			}
		make_distinct(&real);
		make_distinct(&parent[t]);
		*border += parent[t].count - real.count;
		free(real.key);
	}
	return true;
}

static void link_level(octree_reference *r, const key_set *parent, uint32_t depth, uint32_t t)
{
	bool leaf = t + 1 == depth;
	uint32_t first = leaf ? 0 : r->tile_first[t + 1], side = 1u << t;
	uint32_t *key = leaf ? r->leaf_tile_key : r->tile_key;
	uint32_t *neighbour = leaf ? r->leaf_tile_neighbour : r->tile_neighbour;
	uint64_t entry = ((UINT64_C(1) << 3 * t) - 1) / 7;
	for (uint32_t i = 0; i < parent[t].count; i++) {
		uint64_t k = parent[t].key[i], tile = first + i;
		uint32_t at[3];
		gw_morton_decode(k, at);
		key[2 * tile] = (uint32_t)k;
		key[2 * tile + 1] = (uint32_t)(k >> 32);
		for (uint32_t o = 0; o < 8; o++) {
			uint32_t x = at[0] + (o & 1), y = at[1] + (o >> 1 & 1), z = at[2] + (o >> 2);
			uint32_t found =
				x < side && y < side && z < side ? find(&parent[t], gw_morton_encode(x, y, z)) : 0;
			neighbour[8 * tile + o] = found ? first + found : 0;
		}
		if (t > 0) {
			uint32_t above = r->tile_first[t] + find(&parent[t - 1], k >> 3) - 1;
			r->node[8 * above + (k & 7)] = (uint32_t)tile + 1;
		}
		uint64_t place = entry + at[0] + ((uint64_t)at[1] << t) + ((uint64_t)at[2] << 2 * t);
		if (t <= r->directory_level)
			r->level_directory[place] = (uint32_t)tile + 1;
	}
}

static void place_leaves(octree_reference *r, const key_set *leaves, const uint8_t *has_facet,
						 const key_set *tiles)
{
	for (uint32_t i = 0; i < leaves->count; i++) {
		uint32_t tile = find(tiles, leaves->key[i] >> 3) - 1, *entry = r->leaf_tile + 2 * tile;
		if (entry[1] == 0)
			entry[0] = i;
		entry[1] |= (has_facet[i] ? 0x101u : 1u) << (leaves->key[i] & 7);
		gw_morton_decode(leaves->key[i], r->leaf_cell + 4 * i);
		r->leaf_cell[4 * i + 3] = tile;
	}
}

/* Chessboard distance by growing: in step d, cells without one next to a cell of distance d - 1. */
static void grow_distances(octree_reference *r, const key_set *leaves, const uint8_t *has_facet,
						   uint32_t depth)
{
	uint32_t t = r->directory_level, side = 1u << t, far = 255;
	uint64_t entry = ((UINT64_C(1) << 3 * t) - 1) / 7;
	uint32_t *distance = r->ray_directory;
	for (uint64_t i = 0; i < r->ray_entries; i++)
		distance[i] = far;
	for (uint32_t i = 0; i < leaves->count; i++) {
		uint32_t c[3];
		if (!has_facet[i])
			continue;
		gw_morton_decode(leaves->key[i] >> 3 * (depth - t), c);
		distance[c[0] + ((uint64_t)c[1] << t) + ((uint64_t)c[2] << 2 * t)] = 0;
	}
	for (uint32_t d = 1; d < side; d++)
		for (uint64_t i = 0; i < r->ray_entries; i++) {
			if (distance[i] != d - 1)
				continue;
			for (int n = 0; n < 27; n++) {
				int64_t x = (int64_t)(i & (side - 1)) + n % 3 - 1;
				int64_t y = (int64_t)(i >> t & (side - 1)) + n / 3 % 3 - 1;
				int64_t z = (int64_t)(i >> 2 * t) + n / 9 - 1;
				if (x < 0 || y < 0 || z < 0 || x >= side || y >= side || z >= side)
					continue;
				uint32_t *other = distance + x + (y << t) + (z << 2 * t);
				if (*other > d)
					*other = d;
			}
		}
	for (uint64_t i = 0; i < r->ray_entries; i++)
		if (distance[i] == 0)
			distance[i] = 0x80000000u | (r->level_directory[entry + i] - 1);
}

static bool allocate(octree_reference *r, uint32_t leaves)
{
	r->level_entries = ((UINT64_C(8) << 3 * r->directory_level) - 1) / 7;
	r->ray_entries = UINT64_C(1) << 3 * r->directory_level;
	const struct {
		uint32_t **array;
		uint64_t words;
	} part[] = {
		{ &r->tile_key, 2 * (uint64_t)r->tile_count },
		{ &r->leaf_tile_key, 2 * (uint64_t)r->leaf_tile_count },
		{ &r->node, 8 * (uint64_t)r->tile_count },
		{ &r->tile_neighbour, 8 * (uint64_t)r->tile_count },
		{ &r->leaf_tile_neighbour, 8 * (uint64_t)r->leaf_tile_count },
		{ &r->leaf_tile, 2 * (uint64_t)r->leaf_tile_count },
		{ &r->leaf_cell, 4 * (uint64_t)leaves },
		{ &r->level_directory, r->level_entries },
		{ &r->ray_directory, r->ray_entries },
	};
	bool good = true;
	for (size_t i = 0; i < sizeof part / sizeof *part; i++) {
		*part[i].array = calloc(part[i].words + 1, sizeof(uint32_t));
		good = good && *part[i].array != NULL;
	}
	return good;
}

static bool make(uint32_t depth, const key_set *leaves, const uint8_t *has_facet, key_set *parent,
				 octree_reference *r)
{
	if (!make_sets(depth, leaves, parent, &r->border_tile_count))
		return false;
	r->directory_level = depth - 1 < GW_DIRECTORY_LEVEL_MAX ? depth - 1 : GW_DIRECTORY_LEVEL_MAX;
	for (uint32_t l = 1; l < depth; l++) {
		r->tile_first[l] = r->tile_count;
		r->tile_count += parent[l - 1].count;
	}
	r->tile_first[depth] = r->tile_count;
	r->leaf_tile_count = parent[depth - 1].count;
	if (!allocate(r, leaves->count))
		return false;
	for (uint32_t t = 0; t < depth; t++)
		link_level(r, parent, depth, t);
	place_leaves(r, leaves, has_facet, &parent[depth - 1]);
	grow_distances(r, leaves, has_facet, depth);
	return true;
}

bool octree_reference_make(uint32_t depth, const uint32_t *leaf_cell, const uint8_t *has_facet,
						   uint32_t leaf_count, octree_reference *r)
{
	key_set leaves = { 0 }, parent[GW_DEPTH_MAX] = { { 0 } };
	bool good = true;
	memset(r, 0, sizeof *r);
	for (uint32_t i = 0; i < leaf_count && good; i++) {
		const uint32_t *c = leaf_cell + 4 * i;
		good = add_key(&leaves, gw_morton_encode(c[0], c[1], c[2])) &&
			   (i == 0 || leaves.key[i] > leaves.key[i - 1]);
	}
	good = good && make(depth, &leaves, has_facet, parent, r);
	free(leaves.key);
	for (uint32_t t = 0; t < GW_DEPTH_MAX; t++)
		free(parent[t].key);
	if (!good)
		octree_reference_clear(r);
	return good;
}

void octree_reference_clear(octree_reference *r)
{
	uint32_t *array[] = { r->tile_key,       r->leaf_tile_key,       r->node,
						  r->tile_neighbour, r->leaf_tile_neighbour, r->leaf_tile,
						  r->leaf_cell,      r->level_directory,     r->ray_directory };
	for (size_t i = 0; i < sizeof array / sizeof *array; i++)
		free(array[i]);
	memset(r, 0, sizeof *r);
}

double octree_reference_roi(const gw_surfels *s, const float cube_minimum[3], double leaf_size,
							uint32_t surfel, const uint32_t cell[3])
{
	double side = fmin(1, (double)s->nearest[surfel] / leaf_size), volume = 1;
	for (uint32_t k = 0; k < 3; k++) {
		double g = ((double)s->position[3 * surfel + k] - (double)cube_minimum[k]) / leaf_size;
		double low = fmax(g - side / 2, cell[k]), high = fmin(g + side / 2, cell[k] + 1.0);
		volume *= fmax(0, high - low);
	}
	return side > 0 ? volume / side : 0;
}

/* Walls of the empty cells of an octree that discs and planes pass, made part by part. */
#include "octree/compartments_steps.h"

#include "glowworm_host.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* An octree of this depth is too small for parts: all its shapes come one after the other. One that
 * is a level deeper, with the same shapes in its first octant, has parts. */
#define SHALLOW 6u
#define DEEP (SHALLOW + 1u)

#define SHAPES 400u
#define FINE 60u /* leaf tiles */

static float place[SHAPES][4], normal[SHAPES][4], size[SHAPES][4], clip[SHAPES][4];
static uint32_t level[SHAPES]; /* of planes' cells, below that of the whole scene */
static int32_t at[SHAPES][3];

static float random_of(uint32_t *state, float low, float high)
{
	*state = *state * 1664525u + 1013904223u;
	return low + (high - low) * (float)(*state >> 8) * 0x1p-24f;
}

/* Discs of 2 to 10 leaf cells, some of them cut, so far within the octant that all they make is. */
static void make_shapes(void)
{
	uint32_t state = 7;
	for (size_t i = 0; i < SHAPES; i++) {
		float length = 0.0f;
		for (int k = 0; k < 3; k++) {
			place[i][k] = random_of(&state, 24.0f, 40.0f);
			normal[i][k] = random_of(&state, -1.0f, 1.0f);
			length += normal[i][k] * normal[i][k];
		}
		for (int k = 0; k < 3; k++)
			normal[i][k] /= sqrtf(length);
		size[i][0] = random_of(&state, 2.0f, i % 8 ? 4.0f : 10.0f);
		size[i][2] = i % 3 ? 0.0f : 1.0f;
		clip[i][0] = i % 3 ? 0.0f : 0.2f * size[i][0];
		level[i] = 2 + (uint32_t)random_of(&state, 0.0f, 2.99f);
		for (int k = 0; k < 3; k++)
			at[i][k] = (int32_t)random_of(&state, 0.0f, 0.99f + (float)((1u << level[i]) - 1));
	}
}

/* What the shapes are of: a tree of a depth. */
typedef struct shapes_of {
	uint32_t depth;
} shapes_of;

static bool disc_of(const void *user, size_t i, gw_wall_shape *shape)
{
	const shapes_of *of = user;
	*shape = gw_wall_shape_of_disc(place[i], normal[i], size[i], clip[i], of->depth);
	return i % 5 != 4;
}

static bool plane_of(const void *user, size_t i, gw_wall_shape *shape)
{
	const shapes_of *of = user;
	*shape = gw_wall_shape_of_plane(place[i], normal[i], level[i] + of->depth - SHALLOW, at[i]);
	return i % 5 != 4;
}

/* A tile without anything below a node. */
static uint32_t add_tile(gw_compartments *c, uint32_t node)
{
	if (c->child[node] == 0) {
		c->child = realloc(c->child, (c->first + 8) * sizeof *c->child);
		assert_non_null(c->child);
		memset(c->child + c->first, 0, 8 * sizeof *c->child);
		c->child[node] = c->first / 8 + 1;
		c->first += 8;
	}
	return c->child[node] - 1;
}

static void add_leaf(gw_compartments *c, const int32_t cell[3], uint32_t *leaf_tiles)
{
	uint32_t tile = 0;
	for (uint32_t l = 1; l < c->depth; l++) {
		uint32_t shift = c->depth - l, node = 8 * tile;
		for (int k = 0; k < 3; k++)
			node += (uint32_t)(cell[k] >> shift & 1) << k;
		if (l + 1 < c->depth)
			tile = add_tile(c, node);
		else if (c->child[node] == 0)
			c->child[node] = ++*leaf_tiles;
	}
}

/* A tree with leaves at some places, the same for every depth. */
static gw_compartments make_tree(uint32_t depth, bool necks)
{
	gw_compartments c = { .depth = depth, .first = 8 };
	uint32_t state = 3, leaf_tiles = 0;
	c.child = calloc(8, sizeof *c.child);
	c.leaves = calloc(FINE, 1);
	c.leaf_neck = calloc(FINE, 1);
	assert_true(c.child && c.leaves && c.leaf_neck);
	for (uint32_t i = 0; i < FINE; i++) {
		int32_t cell[3];
		for (int k = 0; k < 3; k++)
			cell[k] = (int32_t)random_of(&state, 20.0f, 44.0f);
		add_leaf(&c, cell, &leaf_tiles);
	}
	c.node_neck = necks ? calloc(c.first / 8, 1) : NULL;
	assert_true(c.node_neck || !necks);
	return c;
}

static void free_tree(gw_compartments *c)
{
	free(c->child);
	free(c->leaves);
	free(c->node_neck);
	free(c->leaf_neck);
}

static gw_compartments wall_tree(uint32_t depth, gw_wall_shape_of *of, bool necks, uint32_t threads)
{
	gw_compartments c = make_tree(depth, necks);
	const shapes_of user = { depth };
	const gw_wall_shapes shapes = { SHAPES, of, &user, of == plane_of, necks };
	gw_error error = { 0 };
	assert_int_equal(gw_walls_make(&c, &shapes, threads, &error), GW_OK);
	return c;
}

/* How many walls or necks there are below a tile, and that they are the same in another tree. */
static size_t compare(const gw_compartments *c, uint32_t tile, const gw_compartments *other,
					  uint32_t other_tile, uint32_t left)
{
	size_t found = 0;
	if (left == 0) {
		assert_int_equal(c->leaves[tile], other->leaves[other_tile]);
		assert_int_equal(c->leaf_neck[tile], other->leaf_neck[other_tile]);
		return c->leaves[tile] || c->leaf_neck[tile] ? 1 : 0;
	}
	uint8_t necks = c->node_neck ? c->node_neck[tile] : 0;
	assert_int_equal(necks, other->node_neck ? other->node_neck[other_tile] : 0);
	for (uint32_t octant = 0; octant < 8; octant++) {
		uint32_t to = c->child[8 * tile + octant];
		uint32_t other_to = other->child[8 * other_tile + octant];
		assert_true((to == 0) == (other_to == 0) && (to == GW_WALL) == (other_to == GW_WALL));
		found += to == GW_WALL;
		if (to != 0 && to != GW_WALL)
			found += compare(c, to - 1, other, other_to - 1, left - 1);
	}
	return found + (necks != 0);
}

static void check(gw_wall_shape_of *of, bool necks)
{
	make_shapes();
	gw_compartments one_by_one = wall_tree(SHALLOW, of, necks, 1);
	for (uint32_t threads = 1; threads <= 4; threads += 3) {
		gw_compartments in_parts = wall_tree(DEEP, of, necks, threads);
		assert_true(in_parts.child[0] != 0 && in_parts.child[0] != GW_WALL);
		size_t found = compare(&one_by_one, 0, &in_parts, in_parts.child[0] - 1, SHALLOW - 1);
		assert_true(found > SHAPES / 4);
		assert_int_equal(in_parts.first, one_by_one.first + 8);
		free_tree(&in_parts);
	}
	free_tree(&one_by_one);
}

static void discs_make_walls(void **state)
{
	(void)state;
	check(disc_of, false);
}

static void discs_make_necks(void **state)
{
	(void)state;
	check(disc_of, true);
}

static void planes_make_walls(void **state)
{
	(void)state;
	check(plane_of, false);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(discs_make_walls),
		cmocka_unit_test(discs_make_necks),
		cmocka_unit_test(planes_make_walls),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

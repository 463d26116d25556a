/*
 * test_check_tree.c - the tree of discs by which estimates check: that it holds all of them, in
 * boxes around them, and that one that was changed is told.
 */
#include "base/hash.h"
#include "estimate/check_tree.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

#define COUNT 1003
#define REACH 1.5f

typedef struct cloud {
	float position[3 * COUNT], normal[3 * COUNT], radius[COUNT];
	gw_surfels surfels;
} cloud;

/* Points all over a cube of one metre, whose normals are along axes. */
static void fill(cloud *c, size_t count)
{
	for (uint32_t i = 0; i < 3 * COUNT; i++) {
		c->position[i] = (float)(gw_hash(7, &i, sizeof i) % 10000) / 10000.0f;
		c->normal[i] = i % 3 == i / 3 % 3 ? 1.0f : 0.0f;
		c->radius[i / 3] = 0.02f;
	}
	c->surfels = (gw_surfels){
		.count = count, .position = c->position, .normal = c->normal, .radius = c->radius
	};
}

static gw_check_tree make_by(const cloud *c, uint32_t threads)
{
	gw_error error = { 0 };
	gw_check_tree tree = { .surfel = NULL };
	assert_int_equal(gw_check_tree_make(&c->surfels, REACH, threads, &tree, &error), GW_OK);
	assert_int_equal(tree.nodes, gw_check_tree_nodes(c->surfels.count));
	assert_true(gw_check_tree_fits(&tree, c->surfels.count));
	return tree;
}

static gw_check_tree make(const cloud *c)
{
	return make_by(c, 0);
}

/* Counts the discs below a child, whose middles its box holds. */
static size_t count_below(const cloud *c, const gw_check_tree *tree, const gw_check_node *node,
						  uint32_t lane)
{
	uint32_t child = node->child[lane];
	size_t count = 0;
	if (!(child & GW_CHECK_LEAF)) {
		for (uint32_t k = 0; k < 4; k++)
			count += count_below(c, tree, &tree->node[child], k);
		return count;
	}
	for (; count < (child >> 28 & 7u) + 1; count++) {
		const float *at = c->position + 3 * tree->surfel[(child & 0x0fffffffu) + count];
		for (int k = 0; k < 3; k++)
			assert_true(at[k] >= node->low[k][lane] && at[k] <= node->high[k][lane]);
	}
	return count;
}

/* Of as many discs as a branch at the top has, one less, and many. */
static void threads_change_no_bit(void **state)
{
	(void)state;
	static cloud c;
	const size_t count[] = { 5, 64, 63, 257, COUNT };
	for (size_t i = 0; i < sizeof count / sizeof *count; i++) {
		fill(&c, count[i]);
		gw_check_tree one = make_by(&c, 1), eight = make_by(&c, 8);
		assert_memory_equal(one.surfel, eight.surfel, count[i] * sizeof *one.surfel);
		assert_memory_equal(one.node, eight.node, one.nodes * sizeof *one.node);
		gw_check_tree_clear(&one);
		gw_check_tree_clear(&eight);
	}
}

static void it_holds_all_discs(void **state)
{
	(void)state;
	static cloud c;
	bool seen[COUNT] = { false };
	size_t count = 0;
	fill(&c, COUNT);
	gw_check_tree tree = make(&c);
	for (size_t i = 0; i < COUNT; i++) {
		assert_false(seen[tree.surfel[i]]);
		seen[tree.surfel[i]] = true;
	}
	for (uint32_t k = 0; k < 4; k++)
		count += count_below(&c, &tree, &tree.node[0], k);
	assert_int_equal(count, COUNT);
	gw_check_tree_clear(&tree);
	assert_null(tree.node);
}

static void few_discs_need_no_node(void **state)
{
	(void)state;
	static cloud c;
	fill(&c, 3);
	gw_check_tree tree = make(&c);
	assert_int_equal(tree.nodes, 0);
	gw_check_tree_clear(&tree);
}

/* Any child that is another one would make a walk leave the tree, or never end. */
static void one_that_was_changed_is_told(void **state)
{
	(void)state;
	static cloud c;
	fill(&c, COUNT);
	gw_check_tree tree = make(&c);
	for (uint32_t n = 0; n < tree.nodes; n++)
		for (int k = 0; k < 4; k++) {
			uint32_t kept = tree.node[n].child[k];
			tree.node[n].child[k] = kept & GW_CHECK_LEAF ? kept + 1 : 0;
			assert_false(gw_check_tree_fits(&tree, COUNT));
			tree.node[n].child[k] = kept;
		}
	assert_true(gw_check_tree_fits(&tree, COUNT));
	assert_false(gw_check_tree_fits(&tree, COUNT - 400));
	gw_check_tree_clear(&tree);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(it_holds_all_discs),
										cmocka_unit_test(threads_change_no_bit),
										cmocka_unit_test(few_discs_need_no_node),
										cmocka_unit_test(one_that_was_changed_is_told) };
	return cmocka_run_group_tests_name("check tree", tests, NULL, NULL);
}

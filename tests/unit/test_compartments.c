/* Compartments of empty space, in an octree that is much deeper than its points ask for: a coarser
 * one has them, of which no more stays in memory than is asked for later. */
#include "cloud/surfels.h"
#include "device/gpu_internal.h"
#include "expected.h"
#include "octree/compartments_kept.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define COUNT 3000u /* of each ball */
#define PI 3.14159265358979323846

static double position[3 * 2 * COUNT];
static float normal[3 * 2 * COUNT], albedo[3 * 2 * COUNT];

/* A ball of evenly spread points around a place, seen from outside, or from within by -1. */
static void make_ball(size_t first, double x, double side)
{
	for (size_t i = 0; i < COUNT; i++) {
		double z = 1.0 - (2.0 * (double)i + 1.0) / COUNT, wide = sqrt(1.0 - z * z);
		double turn = PI * (3.0 - sqrt(5.0)) * (double)i;
		const double at[3] = { wide * cos(turn), wide * sin(turn), z };
		for (size_t k = 0; k < 3; k++) {
			position[3 * (first + i) + k] = at[k] + (k == 0 ? x : 0.0);
			normal[3 * (first + i) + k] = (float)(side * at[k]);
		}
	}
}

/* Surfels of so many balls, the first one seen from outside, and their octree, so many levels
 * deeper than they ask for. */
static void build(gw_gpu *gpu, size_t balls, uint32_t deeper, gw_surfels *surfels,
				  gw_octree *octree)
{
	gw_error error;
	make_ball(0, 0.0, 1.0);
	make_ball(COUNT, 3.0, -1.0);
	const gw_points points = {
		.count = balls * COUNT, .position = position, .normal = normal, .albedo = albedo
	};
	const gw_surfels_options options = { .threads = 2, .normals = GW_NORMALS_GIVEN };
	assert_ok(gw_surfels_make(&points, &options, surfels, &error), &error);
	assert_ok(gw_octree_build(gpu, surfels, gw_octree_auto_depth(surfels) + deeper, octree, &error),
			  &error);
	assert_int_equal(gw_compartments_are_coarser(octree, surfels), deeper > 1);
}

/* Of the octree and all else, but for what copies go through. */
static uint64_t bytes_of(gw_gpu *gpu)
{
	return gw_gpu_read_account(gpu).bytes - gpu->staging.bytes;
}

/* Where all look out, nothing of the coarser octree stays on the device. */
static void one_compartment_takes_no_memory(void **state)
{
	(void)state;
	gw_gpu *gpu = open_gpu((gw_gpu_options){ 0 });
	gw_surfels surfels;
	gw_octree octree;
	gw_error error;
	build(gpu, 1, 2, &surfels, &octree);
	uint64_t before = bytes_of(gpu);
	assert_ok(gw_compartments_find(gpu, &surfels, 2, &octree, &error), &error);
	assert_non_null(octree.coarser);
	assert_false(gw_compartments_several(&octree));
	assert_int_equal(bytes_of(gpu), before);
	gw_octree_destroy(gpu, &octree);
	gw_surfels_clear(&surfels);
	gw_gpu_destroy(&gpu);
}

/* What the points of both balls look into, asked for as places. */
static void assert_sides(gw_gpu *gpu, const gw_octree *octree, const gw_surfels *surfels)
{
	gw_error error;
	uint32_t *label = calloc(surfels->count, sizeof *label);
	uint32_t outside = gw_compartment_outside(octree);
	gw_view place, facing;
	assert_non_null(label);
	assert_ok(gw_view_open(gpu, &octree->surfel_position, 16 * surfels->count, &place, &error),
			  &error);
	assert_ok(gw_view_open(gpu, &octree->surfel_normal, 16 * surfels->count, &facing, &error),
			  &error);
	const gw_surface_places places = { surfels->count, place.bytes, facing.bytes };
	const gw_passes passes = { .gpu = gpu, .threads = 3 };
	assert_ok(gw_compartments_of_places(&passes, octree, &places, label, &error), &error);
	for (size_t i = 0; i < 2 * (size_t)COUNT; i++) {
		uint32_t surfel = surfels->surfel_of_point[i];
		assert_int_equal(gw_compartments_apart(label[surfel], outside), i >= COUNT);
		assert_int_not_equal(label[surfel], GW_COMPARTMENT_UNKNOWN);
	}
	gw_view_close(&facing);
	gw_view_close(&place);
	free(label);
}

/* Where some look into a ball and some out, what is read for the labels of places stays: no other
 * buffers, and no labels of its own facets. */
static void several_take_what_places_are_found_by(void **state)
{
	(void)state;
	gw_gpu *gpu = open_gpu((gw_gpu_options){ 0 });
	gw_surfels surfels;
	gw_octree octree;
	gw_error error;
	build(gpu, 2, 2, &surfels, &octree);
	uint64_t before = bytes_of(gpu);
	assert_ok(gw_compartments_find(gpu, &surfels, 2, &octree, &error), &error);
	assert_true(gw_compartments_several(&octree));
	assert_non_null(octree.facet_compartment);
	const gw_octree *c = octree.coarser;
	assert_non_null(c);
	assert_null(c->facet_compartment);
	uint64_t kept = c->surfel_position.allocated + c->surfel_normal.allocated +
					c->surfel_disc.allocated + c->facet_plane.allocated + c->leaf_tile.allocated +
					c->facet_leaf.allocated + c->leaf_fragment.allocated +
					c->fragment_surfel.allocated;
	assert_int_equal(bytes_of(gpu), before + kept);
	assert_sides(gpu, &octree, &surfels);
	gw_octree_destroy(gpu, &octree);
	gw_surfels_clear(&surfels);
	gw_gpu_destroy(&gpu);
}

static void assert_fit(const gw_octree *octree, bool expected)
{
	gw_error error;
	bool fit;
	assert_ok(gw_compartments_fit(octree, &fit, &error), &error);
	assert_int_equal(fit, expected);
}

/* Puts a word in place of another one, with which the arrays must not fit. */
static void assert_refused(const gw_octree *octree, uint32_t *word, uint32_t wrong)
{
	uint32_t right = *word;
	*word = wrong;
	assert_fit(octree, false);
	*word = right;
	assert_fit(octree, true);
}

/* What a transport keeps of an octree's own compartments makes the same ones again; and arrays that
 * do not hang together are told before anything walks through them. */
static void kept_ones_are_the_same(void **state)
{
	(void)state;
	gw_gpu *gpu = open_gpu((gw_gpu_options){ 0 });
	gw_compartments_array own[GW_COMPARTMENTS_ARRAYS], again[GW_COMPARTMENTS_ARRAYS];
	gw_surfels surfels;
	gw_octree octree;
	gw_error error;
	build(gpu, 2, 0, &surfels, &octree);
	assert_int_equal(gw_compartments_numbers_of(&octree).known, GW_COMPARTMENTS_NOT_FOUND);
	assert_ok(gw_compartments_find(gpu, &surfels, 2, &octree, &error), &error);
	const gw_compartments_numbers n = gw_compartments_numbers_of(&octree);
	assert_int_equal(n.known, GW_COMPARTMENTS_SEVERAL);
	assert_true(gw_compartments_numbers_fit(&n, octree.tile_count, octree.leaf_tile_count));
	gw_octree kept = octree;
	kept.facet_compartment = NULL;
	assert_ok(gw_compartments_restore(&n, &kept, &error), &error);
	gw_compartments_list(&octree, surfels.count, own);
	gw_compartments_list(&kept, surfels.count, again);
	for (size_t i = 0; i < GW_COMPARTMENTS_ARRAYS; i++) {
		assert_int_equal(again[i].bytes, own[i].bytes);
		void *copy = malloc(again[i].bytes);
		assert_non_null(copy);
		memcpy(copy, *(void **)own[i].array, own[i].bytes);
		*(void **)again[i].array = copy;
	}
	assert_fit(&kept, true);
	assert_sides(gpu, &kept, &surfels);
	uint32_t *tree = *(void **)again[0].array, *label = *(void **)again[2].array;
	uint32_t child = 0;
	while (tree[child] == 0)
		child++;
	assert_refused(&kept, &tree[child], 1);           /* the root: round and round */
	assert_refused(&kept, &tree[child], n.tiles + 1); /* there is no such tile */
	assert_refused(&kept, &label[again[2].bytes / 4 - 1], 1);
	gw_compartments_destroy(&kept.compartments);
	free(kept.facet_compartment);
	gw_octree_destroy(gpu, &octree);
	gw_surfels_clear(&surfels);
	gw_gpu_destroy(&gpu);
}

/* Numbers that no octree of 5 tiles and 9 leaf tiles has. */
static void other_numbers_are_refused(void **state)
{
	(void)state;
	const gw_compartments_numbers wrong[] = {
		{ .known = GW_COMPARTMENTS_SEVERAL + 1 },
		{ .known = GW_COMPARTMENTS_ONE, .count = 1 },
		{ .known = GW_COMPARTMENTS_SEVERAL, .tiles = 4, .count = 2 },
		{ .known = GW_COMPARTMENTS_SEVERAL, .tiles = 5 },
		{ .known = GW_COMPARTMENTS_SEVERAL, .tiles = 5, .count = 8 * (5 + 9) + 2 },
		{ .known = GW_COMPARTMENTS_SEVERAL, .tiles = UINT32_MAX / 8, .count = 2 },
	};
	for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
		assert_false(gw_compartments_numbers_fit(&wrong[i], 5, 9));
	const gw_compartments_numbers right = { .known = GW_COMPARTMENTS_SEVERAL,
											.tiles = 5,
											.count = 8 * (5 + 9) + 1 };
	assert_true(gw_compartments_numbers_fit(&right, 5, 9));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(one_compartment_takes_no_memory),
		cmocka_unit_test(several_take_what_places_are_found_by),
		cmocka_unit_test(kept_ones_are_the_same),
		cmocka_unit_test(other_numbers_are_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

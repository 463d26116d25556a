/*
 * test_octree.c - the octree and what builds it: Morton keys, prefix sums, the sort, topology
 * against a simple build on the host, fragments and lobes against double precision.
 *
 * Leaves are taken from the device and compared with the host within rounding; everything above
 * them follows from their keys in integers and is compared exactly.
 */
#include "octree.h"
#include "octree_points.h"
#include "octree_reference.h"
#include "prefix_sum.h"
#include "radix_sort.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* Opens a device. Without one the test is skipped; under CI it fails instead. */
static gw_gpu *open_gpu(gw_gpu_options options)
{
	gw_gpu *gpu = NULL;
	gw_error error = { 0 };
	gw_status status = gw_gpu_create(&options, &gpu, &error);
	if (status == GW_OK)
		return gpu;
	print_message("no device: %s\n", error.text);
	if (getenv("CI") != NULL || (status != GW_ERROR_NO_DEVICE && status != GW_ERROR_USAGE))
		fail_msg("%s", error.text);
	skip();
	return NULL;
}

static const gw_gpu_options validated = { .validate = true, .validate_synchronization = true };

static void assert_ok(gw_status status, const gw_error *error)
{
	if (status != GW_OK)
		fail_msg("%s", error->text);
}

/* Also says that validation found nothing. */
static void close_gpu(gw_gpu *gpu)
{
	const char *first;
	if (gw_gpu_validation_messages(gpu, &first) != 0)
		fail_msg("%s", first);
	assert_int_equal(gw_gpu_read_account(gpu).bytes, 0);
	gw_gpu_destroy(&gpu);
}

static void *download(gw_gpu *gpu, gw_buffer *buffer)
{
	gw_error error = { 0 };
	void *data = malloc(buffer->bytes + 1);
	assert_non_null(data);
	assert_ok(gw_buffer_download(gpu, buffer, 0, data, buffer->bytes, &error), &error);
	return data;
}

/* ----------------------------------------------------------------------------------- keys */

static void test_morton(void **state)
{
	(void)state;
	assert_true(gw_morton_encode(1, 0, 0) == 1);
	assert_true(gw_morton_encode(0, 1, 0) == 2);
	assert_true(gw_morton_encode(0, 0, 1) == 4);
	assert_true(gw_morton_encode(0x1fffff, 0x1fffff, 0x1fffff) == UINT64_C(0x7fffffffffffffff));
	uint64_t seed = 7;
	for (int i = 0; i < 1000; i++) {
		uint32_t in[3], out[3];
		uint64_t naive = 0;
		for (uint32_t k = 0; k < 3; k++) {
			in[k] = (uint32_t)(octree_points_random(&seed) * 0x200000);
			for (uint32_t bit = 0; bit < 21; bit++)
				naive |= (uint64_t)(in[k] >> bit & 1) << (3 * bit + k);
		}
		assert_true(gw_morton_encode(in[0], in[1], in[2]) == naive);
		gw_morton_decode(naive, out);
		assert_memory_equal(in, out, sizeof in);
	}
}

static void test_auto_depth(void **state)
{
	(void)state;
	gw_surfels s = { .spacing = 0.01f, .maximum = { 1, 0.5f, 0.1f } };
	/* 1 m / 0.0125 m = 80 cells: 64 is nearer by ratio than 128. */
	assert_int_equal(gw_octree_auto_depth(&s), 6);
	s.maximum[2] = 1.2f; /* 96 cells */
	assert_int_equal(gw_octree_auto_depth(&s), 7);
	s.spacing = 0;
	assert_int_equal(gw_octree_auto_depth(&s), GW_DEPTH_MAX);
	s = (gw_surfels){ .spacing = 1 };
	assert_int_equal(gw_octree_auto_depth(&s), 1);
	s.spacing = NAN;
	assert_int_equal(gw_octree_auto_depth(&s), 1);
}

/* -------------------------------------------------------------------- prefix sum and sort */

static const uint32_t awkward[] = { 0, 1, 2, 127, 128, 129, 255, 256, 257, 16385, 100003 };
#define AWKWARD (sizeof awkward / sizeof *awkward)

static void sum_and_compare(gw_gpu *gpu, gw_prefix_sum *prefix, uint32_t count)
{
	gw_error error = { 0 };
	gw_buffer words;
	assert_ok(gw_buffer_create(gpu, GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED, 4 * (uint64_t)count,
	                           "words", &words, &error),
	          &error);
	uint32_t *value = calloc(count + 1u, sizeof *value);
	assert_non_null(value);
	uint64_t seed = count, sum = 0;
	for (uint32_t i = 0; i < count; i++)
		value[i] = (uint32_t)(octree_points_random(&seed) * 100);
	assert_ok(gw_buffer_upload(gpu, &words, 0, value, 4 * (uint64_t)count, &error), &error);
	uint64_t total = 99;
	assert_ok(gw_prefix_sum_run(gpu, prefix, &words, count, &total, &error), &error);
	uint32_t *got = download(gpu, &words);
	for (uint32_t i = 0; i < count; i++) {
		if (got[i] != sum)
			fail_msg("sum %u of %u is %u, not %llu", i, count, got[i], (unsigned long long)sum);
		sum += value[i];
	}
	assert_true(total == sum);
	free(got);
	free(value);
	gw_buffer_destroy(gpu, &words);
}

static void test_prefix_sum(void **state)
{
	(void)state;
	const uint32_t size[] = { 0, 8 };
	for (int s = 0; s < 2; s++) {
		gw_gpu_options options = validated;
		options.workgroup_size = size[s];
		gw_gpu *gpu = open_gpu(options);
		gw_error error = { 0 };
		gw_prefix_sum prefix;
		assert_ok(gw_prefix_sum_create(gpu, &prefix, &error), &error);
		for (size_t i = 0; i < AWKWARD; i++)
			sum_and_compare(gpu, &prefix, awkward[i]);
		gw_prefix_sum_destroy(gpu, &prefix);
		close_gpu(gpu);
	}
}

/* A total beyond 32 bits is told. */
static void test_large_total(void **state)
{
	(void)state;
	gw_gpu *gpu = open_gpu(validated);
	gw_error error = { 0 };
	gw_prefix_sum prefix;
	gw_buffer words;
	assert_ok(gw_prefix_sum_create(gpu, &prefix, &error), &error);
	assert_ok(gw_buffer_create(gpu, GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED, 4 * 1000, "words",
	                           &words, &error),
	          &error);
	assert_ok(gw_buffer_fill(gpu, &words, 0x01000000, &error), &error);
	uint64_t total;
	assert_ok(gw_prefix_sum_run(gpu, &prefix, &words, 1000, &total, &error), &error);
	assert_true(total == UINT64_C(1000) * 0x01000000);
	gw_buffer_destroy(gpu, &words);
	gw_prefix_sum_destroy(gpu, &prefix);
	close_gpu(gpu);
}

typedef struct keyed {
	uint64_t key;
	uint32_t index;
} keyed;

static int compare_keyed(const void *a, const void *b)
{
	const keyed *x = a, *y = b;
	if (x->key != y->key)
		return x->key < y->key ? -1 : 1;
	return x->index < y->index ? -1 : 1;
}

static void sort_and_compare(gw_gpu *gpu, gw_radix_sort *sort, uint32_t count, uint32_t bits)
{
	gw_error error = { 0 };
	bool wide = bits > 32;
	gw_sort_list list;
	assert_ok(gw_sort_list_create(gpu, count, wide, &list, &error), &error);
	keyed *key = calloc(count + 1u, sizeof *key);
	uint32_t *word = calloc(2 * count + 1u, sizeof *word);
	assert_true(key != NULL && word != NULL);
	uint64_t seed = count + bits;
	for (uint32_t i = 0; i < count; i++) {
		/* Many equal keys, and some that differ in one end only. */
		uint64_t r = (uint64_t)(octree_points_random(&seed) * 0x1p53);
		uint64_t k = i % 3 == 0 ? r << 11 : i % 3 == 1 ? r & 15 : (r & 3) << (bits - 2);
		k &= bits < 64 ? (UINT64_C(1) << bits) - 1 : UINT64_MAX;
		key[i] = (keyed){ k, i };
		word[i] = (uint32_t)k;
		word[count + i] = (uint32_t)(k >> 32);
	}
	assert_ok(gw_buffer_upload(gpu, &list.low, 0, word, 4 * (uint64_t)count, &error), &error);
	if (wide)
		assert_ok(gw_buffer_upload(gpu, &list.high, 0, word + count, 4 * (uint64_t)count, &error),
		          &error);
	assert_ok(gw_radix_sort_run(gpu, sort, &list, bits, &error), &error);
	qsort(key, count, sizeof *key, compare_keyed);
	uint32_t *low = download(gpu, &list.low), *index = download(gpu, &list.payload);
	uint32_t *high = wide ? download(gpu, &list.high) : NULL;
	for (uint32_t i = 0; i < count; i++) {
		uint64_t got = low[i] | (wide ? (uint64_t)high[i] << 32 : 0);
		if (got != key[i].key || index[i] != key[i].index)
			fail_msg("%u keys of %u bits: element %u is wrong", count, bits, i);
	}
	free(low);
	free(high);
	free(index);
	free(key);
	free(word);
	gw_sort_list_destroy(gpu, &list);
}

static void test_sort(void **state)
{
	(void)state;
	const uint32_t size[] = { 0, 8 }, bits[] = { 3, 24, 30, 48 };
	for (int s = 0; s < 2; s++) {
		gw_gpu_options options = validated;
		options.workgroup_size = size[s];
		gw_gpu *gpu = open_gpu(options);
		gw_error error = { 0 };
		gw_radix_sort sort;
		assert_ok(gw_radix_sort_create(gpu, &sort, &error), &error);
		for (size_t i = 0; i < AWKWARD; i++)
			for (int b = 0; b < 4; b++)
				sort_and_compare(gpu, &sort, awkward[i], bits[b]);
		gw_radix_sort_destroy(gpu, &sort);
		close_gpu(gpu);
	}
}

/* -------------------------------------------------------------------------------- topology */

static void compare_words(const char *what, const uint32_t *got, const uint32_t *expected,
                          uint64_t words)
{
	for (uint64_t i = 0; i < words; i++)
		if (got[i] != expected[i])
			fail_msg("%s: word %llu is %u, not %u", what, (unsigned long long)i, got[i],
			         expected[i]);
}

static void compare_buffer(gw_gpu *gpu, const char *what, gw_buffer *buffer,
                           const uint32_t *expected, uint64_t words)
{
	assert_true(buffer->bytes == 4 * words);
	uint32_t *got = download(gpu, buffer);
	compare_words(what, got, expected, words);
	free(got);
}

/* Whether each leaf has a disc fragment. */
static uint8_t *find_lobed(gw_gpu *gpu, gw_octree *octree)
{
	uint32_t *first = download(gpu, &octree->leaf_fragment);
	uint32_t *surfel = download(gpu, &octree->fragment_surfel);
	uint8_t *lobed = calloc(octree->leaf_count, 1);
	assert_non_null(lobed);
	for (uint32_t i = 0; i < octree->leaf_count; i++)
		for (uint32_t f = first[i]; f < first[i + 1]; f++)
			lobed[i] |= surfel[f] >> 31 == 0;
	free(first);
	free(surfel);
	return lobed;
}

/* Everything that follows from the keys of the leaves. */
static void compare_topology(gw_gpu *gpu, gw_octree *octree)
{
	uint32_t *cell = download(gpu, &octree->leaf_cell);
	uint8_t *lobed = find_lobed(gpu, octree);
	octree_reference r;
	assert_true(octree_reference_make(octree->depth, cell, lobed, octree->leaf_count, &r));
	assert_int_equal(octree->leaf_tile_count, r.leaf_tile_count);
	assert_int_equal(octree->tile_count, r.tile_count);
	assert_int_equal(octree->border_tile_count, r.border_tile_count);
	assert_int_equal(octree->directory_level, r.directory_level);
	compare_words("tile_first", octree->tile_first, r.tile_first, GW_DEPTH_MAX + 2);
	compare_words("leaf_cell", cell, r.leaf_cell, 4 * (uint64_t)octree->leaf_count);
	uint64_t tiles = r.tile_count, leaf_tiles = r.leaf_tile_count;
	compare_buffer(gpu, "tile_key", &octree->tile_key, r.tile_key, 2 * tiles);
	compare_buffer(gpu, "leaf_tile_key", &octree->leaf_tile_key, r.leaf_tile_key, 2 * leaf_tiles);
	compare_buffer(gpu, "node", &octree->node, r.node, 8 * tiles);
	compare_buffer(gpu, "tile_neighbour", &octree->tile_neighbour, r.tile_neighbour, 8 * tiles);
	compare_buffer(gpu, "leaf_tile_neighbour", &octree->leaf_tile_neighbour,
	               r.leaf_tile_neighbour, 8 * leaf_tiles);
	compare_buffer(gpu, "level_directory", &octree->level_directory, r.level_directory,
	               r.level_entries);
	compare_buffer(gpu, "ray_directory", &octree->ray_directory, r.ray_directory, r.ray_entries);
	uint32_t *leaf_tile = download(gpu, &octree->leaf_tile);
	for (uint64_t i = 0; i < leaf_tiles; i++) {
		assert_int_equal(leaf_tile[2 * i], r.leaf_tile[2 * i]);
		assert_int_equal(leaf_tile[2 * i + 1] & 0xffffu, r.leaf_tile[2 * i + 1]);
	}
	free(leaf_tile);
	free(lobed);
	free(cell);
	octree_reference_clear(&r);
}

/* Each disc leaves its area, and each leaf its fragments, in the order of surfels. */
static void compare_fragments(gw_gpu *gpu, const gw_surfels *s, gw_octree *octree)
{
	uint32_t *first = download(gpu, &octree->leaf_fragment);
	uint32_t *surfel = download(gpu, &octree->fragment_surfel);
	float *weight = download(gpu, &octree->fragment_weight);
	uint32_t *cell = download(gpu, &octree->leaf_cell);
	double *area = calloc(s->count, sizeof *area), *volume = calloc(s->count, sizeof *volume);
	assert_true(area != NULL && volume != NULL);
	double leaf = (double)octree->leaf_size;
	assert_int_equal(first[0], 0);
	assert_int_equal(first[octree->leaf_count], octree->fragment_count);
	for (uint32_t i = 0; i < octree->leaf_count; i++) {
		assert_true(first[i] < first[i + 1]);
		for (uint32_t f = first[i]; f < first[i + 1]; f++) {
			uint32_t id = surfel[f] & 0x3fffffffu;
			assert_true(id < s->count && weight[f] >= 0);
			if (f > first[i]) {
				uint32_t before = surfel[f - 1] & 0x3fffffffu;
				/* The RoI fragment of a surfel comes before that of its disc. */
				assert_true(before < id || (before == id && surfel[f - 1] >> 31 && !(surfel[f] >> 31)));
			}
			if (surfel[f] >> 31) {
				double expected = octree_reference_roi(s, octree->cube_minimum, leaf, id,
				                                       cell + 4 * i);
				/* Grid coordinates are float32: half a unit in the last place of the side, for
				 * each of six faces, and as much again for the arithmetic. */
				double tolerance = 12 * 0x1p-24 * (double)(1u << octree->depth) + 1e-6;
				if (!(fabs((double)weight[f] - expected) <= tolerance))
					fail_msg("RoI of surfel %u: %g, not %g", id, (double)weight[f], expected);
				volume[id] += (double)weight[f];
			} else {
				area[id] += (double)weight[f];
			}
		}
	}
	for (size_t i = 0; i < s->count; i++) {
		double expected = (double)s->area[i] / (leaf * leaf);
		/* A thousand float32 weights at most. */
		if (!(fabs(area[i] - expected) <= 1e-5 * expected))
			fail_msg("disc %zu has area %g in leaves, not %g", i, area[i], expected);
		double roi = fmin(1, (double)s->nearest[i] / leaf);
		assert_true(fabs(volume[i] - roi * roi) <= 1e-5 * roi * roi + 1e-30);
	}
	free(first);
	free(surfel);
	free(weight);
	free(cell);
	free(area);
	free(volume);
}

/* Random points in a box, random normals and radii, some two-sided, some clipped. */
static void make_scattered(size_t count, uint64_t seed, float radius, gw_surfels *s)
{
	assert_true(octree_points_make(count, seed % 2 == 0, s));
	for (size_t i = 0; i < count; i++) {
		double n[3], length = 0;
		for (size_t k = 0; k < 3; k++) {
			s->position[3 * i + k] = (float)(octree_points_random(&seed) * (k == 2 ? 0.3 : 1.0));
			s->albedo[3 * i + k] = (float)octree_points_random(&seed);
			if (s->emission != NULL && i % 10 == 0)
				s->emission[3 * i + k] = 5;
			n[k] = octree_points_random(&seed) - 0.5;
			length += n[k] * n[k];
		}
		for (size_t k = 0; k < 3; k++)
			s->normal[3 * i + k] = (float)(n[k] / sqrt(length));
		s->radius[i] = (float)(octree_points_random(&seed) * (double)radius);
		s->nearest[i] = (float)(octree_points_random(&seed) * 0.1);
		s->area[i] = s->radius[i] * s->radius[i] * 0.7f + 1e-9f;
		s->two_sided[i] = i % 7 == 0;
		if (i % 3 == 0) {
			s->clip[6 * i] = 1;
			s->clip[6 * i + 2] = s->radius[i] * 0.3f;
		}
		if (i % 50 == 0) { /* all is cut */
			s->clip[6 * i + 4] = 1;
			s->clip[6 * i + 5] = -2 * s->radius[i];
		}
	}
	s->spacing = radius;
	octree_points_bound(s);
}

static void build_and_compare(gw_gpu *gpu, const gw_surfels *s, uint32_t depth)
{
	gw_error error = { 0 };
	gw_octree octree;
	assert_ok(gw_octree_build(gpu, s, depth, &octree, &error), &error);
	assert_int_equal(octree.depth, depth);
	compare_topology(gpu, &octree);
	compare_fragments(gpu, s, &octree);
	gw_octree_destroy(gpu, &octree);
}

static void test_topology(void **state)
{
	(void)state;
	gw_gpu *gpu = open_gpu(validated);
	const struct {
		uint32_t depth;
		size_t count;
		float radius;
	} row[] = {
		{ 1, 1000, 0.1f }, { 2, 1000, 0.1f },  { 3, 1000, 0.1f },   { 5, 2000, 0.05f },
		{ 8, 300, 0.05f }, { 10, 50, 0.004f }, { 11, 20, 0.001f }, { 14, 20, 0.0002f },
		{ 16, 1, 0.1f },
	};
	for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
		gw_surfels s;
		make_scattered(row[i].count, i + 1, row[i].radius, &s);
		build_and_compare(gpu, &s, row[i].depth);
		gw_surfels_clear(&s);
	}
	close_gpu(gpu);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_morton),
		cmocka_unit_test(test_auto_depth),
		cmocka_unit_test(test_prefix_sum),
		cmocka_unit_test(test_large_total),
		cmocka_unit_test(test_sort),
		cmocka_unit_test(test_topology),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

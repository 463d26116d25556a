/*
 * test_octree.c - the octree and what builds it: Morton keys, prefix sums, the sort, topology
 * against a simple build on the CPU, fragments and facets against double precision.
 *
 * Leaves are taken from the device and compared with the host within rounding; everything above
 * them follows from their keys in integers and is compared exactly.
 */
#include "device/gpu_internal.h"
#include "octree/octree.h"
#include "octree_points.h"
#include "octree_reference.h"
#include "device/prefix_sum.h"
#include "device/radix_sort.h"
#include "expected.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* The same, with shaders alone. */
static gw_gpu *open_gpu_of_shaders(gw_gpu_options options)
{
	options.passes = GW_PASSES_DEVICE;
	return open_gpu(options);
}

static const gw_gpu_options validated = { .validate = true, .validate_synchronization = true };

/* Also says that validation found nothing. */
static void close_gpu(gw_gpu *gpu)
{
	const char *first;
	if (gw_gpu_validation_messages(gpu, &first) != 0)
		fail_msg("%s", first);
	assert_int_equal(gw_gpu_read_account(gpu).bytes, gpu->staging.bytes);
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
	/* 1 m / 0.0125 m = 80 cells, and two free ones on each side: 64 are too few. */
	assert_int_equal(gw_octree_auto_depth(&s), 7);
	/* 16 times as many points as have the narrowest: leaves twice as wide, 40 cells */
	s.count = 4000000;
	assert_int_equal(gw_octree_auto_depth(&s), 6);
	s.count = 0;
	s.spacing = 0.02f; /* 50 cells */
	assert_int_equal(gw_octree_auto_depth(&s), 6);
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

static void sum_and_compare(gw_passes *passes, gw_prefix_sum *prefix, uint32_t count)
{
	gw_gpu *gpu = passes->gpu;
	gw_error error = { 0 };
	gw_buffer words;
	assert_ok(gw_buffer_create(gpu,
							   &(gw_buffer_description){ GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED,
														 4 * (uint64_t)count, "words" },
							   &words, &error),
			  &error);
	uint32_t *value = calloc(count + 1u, sizeof *value);
	assert_non_null(value);
	uint64_t seed = count, sum = 0;
	for (uint32_t i = 0; i < count; i++)
		value[i] = (uint32_t)(octree_points_random(&seed) * 100);
	assert_ok(gw_buffer_upload(gpu, &words, 0, value, 4 * (uint64_t)count, &error), &error);
	uint64_t total = 99;
	assert_ok(gw_prefix_sum_run(passes, prefix, &words, count, &total, &error), &error);
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
	const uint32_t size[] = { 0, 8, 0 };
	for (int s = 0; s < 3; s++) {
		gw_gpu_options options = validated;
		options.workgroup_size = size[s];
		gw_gpu *gpu = s < 2 ? open_gpu_of_shaders(options) : open_gpu(options);
		gw_passes passes = { .gpu = gpu };
		gw_prefix_sum prefix = { 0 };
		for (size_t i = 0; i < AWKWARD; i++)
			sum_and_compare(&passes, &prefix, awkward[i]);
		gw_prefix_sum_destroy(gpu, &prefix);
		gw_passes_destroy(&passes);
		close_gpu(gpu);
	}
}

static void sum_much(gw_gpu *gpu)
{
	gw_error error = { 0 };
	gw_passes own = { .gpu = gpu }, *passes = &own;
	gw_prefix_sum prefix = { 0 };
	gw_buffer words;
	assert_ok(gw_buffer_create(gpu,
							   &(gw_buffer_description){ GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED,
														 4 * 1000, "words" },
							   &words, &error),
			  &error);
	assert_ok(gw_buffer_fill(gpu, &words, 0x01000000, &error), &error);
	uint64_t total;
	assert_ok(gw_prefix_sum_run(passes, &prefix, &words, 1000, &total, &error), &error);
	assert_true(total == UINT64_C(1000) * 0x01000000);
	gw_buffer_destroy(gpu, &words);
	gw_prefix_sum_destroy(gpu, &prefix);
	gw_passes_destroy(passes);
	close_gpu(gpu);
}

/* A total beyond 32 bits is told. */
static void test_large_total(void **state)
{
	(void)state;
	sum_much(open_gpu(validated));
	sum_much(open_gpu_of_shaders(validated));
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

static void sort_and_compare(gw_passes *passes, gw_radix_sort *sort, uint32_t count, uint32_t bits)
{
	gw_gpu *gpu = passes->gpu;
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
	assert_ok(gw_radix_sort_run(passes, sort, &list, bits, &error), &error);
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
	const uint32_t size[] = { 0, 8, 0 }, bits[] = { 3, 24, 30, 48 };
	for (int s = 0; s < 3; s++) {
		gw_gpu_options options = validated;
		options.workgroup_size = size[s];
		gw_gpu *gpu = s < 2 ? open_gpu_of_shaders(options) : open_gpu(options);
		gw_passes passes = { .gpu = gpu };
		gw_radix_sort sort = { 0 };
		for (size_t i = 0; i < AWKWARD; i++)
			for (int b = 0; b < 4; b++)
				sort_and_compare(&passes, &sort, awkward[i], bits[b]);
		gw_radix_sort_destroy(gpu, &sort);
		gw_passes_destroy(&passes);
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
static uint8_t *find_faceted(gw_gpu *gpu, gw_octree *octree)
{
	uint32_t *first = download(gpu, &octree->leaf_fragment);
	uint32_t *surfel = download(gpu, &octree->fragment_surfel);
	uint8_t *faceted = calloc(octree->leaf_count, 1);
	assert_non_null(faceted);
	for (uint32_t i = 0; i < octree->leaf_count; i++)
		for (uint32_t f = first[i]; f < first[i + 1]; f++)
			faceted[i] |= surfel[f] >> 31 == 0;
	free(first);
	free(surfel);
	return faceted;
}

/* Everything that follows from the keys of the leaves. */
static void compare_topology(gw_gpu *gpu, gw_octree *octree)
{
	uint32_t *cell = download(gpu, &octree->leaf_cell);
	uint8_t *faceted = find_faceted(gpu, octree);
	octree_reference r;
	assert_true(octree_reference_make(octree->depth, cell, faceted, octree->leaf_count, &r));
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
	compare_buffer(gpu, "leaf_tile_neighbour", &octree->leaf_tile_neighbour, r.leaf_tile_neighbour,
				   8 * leaf_tiles);
	compare_buffer(gpu, "level_directory", &octree->level_directory, r.level_directory,
				   r.level_entries);
	compare_buffer(gpu, "ray_directory", &octree->ray_directory, r.ray_directory, r.ray_entries);
	uint32_t *leaf_tile = download(gpu, &octree->leaf_tile);
	uint32_t *facet_leaf = download(gpu, &octree->facet_leaf);
	for (uint64_t i = 0; i < leaf_tiles; i++) {
		bool any = r.leaf_tile[2 * i + 1] != 0;
		if (any)
			assert_int_equal(facet_leaf[leaf_tile[2 * i]], r.leaf_tile[2 * i]);
		else
			assert_int_equal(leaf_tile[2 * i], 0);
		assert_int_equal(leaf_tile[2 * i + 1] & 0xffffu, r.leaf_tile[2 * i + 1]);
	}
	free(facet_leaf);
	free(leaf_tile);
	free(faceted);
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
				bool roi_first = surfel[f - 1] >> 31 == 1 && surfel[f] >> 31 == 0;
				assert_true(before < id || (before == id && roi_first));
			}
			if (surfel[f] >> 31) {
				double expected =
					octree_reference_roi(s, octree->cube_minimum, leaf, id, cell + 4 * i);
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
		/* No disc is larger than one of 16 cells' radius. */
		double expected = fmin((double)s->area[i] / (leaf * leaf), 3.14159265358979 * 256);
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
		{ 1, 1000, 0.1f },  { 2, 1000, 0.1f },   { 3, 1000, 0.1f },
		{ 5, 2000, 0.05f }, { 8, 300, 0.05f },   { 10, 50, 0.004f },
		{ 11, 20, 0.001f }, { 14, 20, 0.0002f }, { 16, 1, 0.1f },
	};
	for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
		gw_surfels s;
		make_scattered(row[i].count, i + 1, row[i].radius, &s);
		build_and_compare(gpu, &s, row[i].depth);
		gw_surfels_clear(&s);
	}
	close_gpu(gpu);
}

/* ------------------------------------------------------------------------- discs in leaves */

/* Shares of a disc in cells. */
typedef struct share {
	uint64_t key;
	double reference, got;
} share;

static share *share_of(share *list, uint32_t *count, uint64_t key)
{
	for (uint32_t i = 0; i < *count; i++)
		if (list[i].key == key)
			return list + i;
	assert_true(*count < 4096);
	list[*count] = (share){ key, 0, 0 };
	return list + (*count)++;
}

#define DENSE 160

/* Looks at a disc in a dense lattice of its own plane. */
static void look_at_disc(const gw_surfels *s, const gw_octree *octree, size_t i, share *list,
						 uint32_t *count)
{
	float t[3], b[3];
	const float *clip = s->clip + 6 * i;
	gw_tangent_frame(s->normal + 3 * i, t, b);
	double radius = (double)s->radius[i], total = 0;
	for (int k = 0; k < DENSE * DENSE; k++) {
		double u = (2 * (k % DENSE + 0.5) / DENSE - 1) * radius;
		double v = (2 * (k / DENSE + 0.5) / DENSE - 1) * radius;
		uint32_t cell[3];
		if (u * u + v * v > radius * radius ||
			(double)clip[0] * u + (double)clip[1] * v > (double)clip[2] ||
			(double)clip[3] * u + (double)clip[4] * v > (double)clip[5])
			continue;
		for (size_t a = 0; a < 3; a++) {
			double p = (double)s->position[3 * i + a] + u * (double)t[a] + v * (double)b[a];
			cell[a] = (uint32_t)((p - (double)octree->cube_minimum[a]) / (double)octree->leaf_size);
		}
		share_of(list, count, gw_morton_encode(cell[0], cell[1], cell[2]))->reference++;
		total++;
	}
	for (uint32_t k = 0; k < *count && total > 0; k++)
		list[k].reference /= total;
}

static void test_discs(void **state)
{
	(void)state;
	gw_gpu *gpu = open_gpu(validated);
	gw_error error = { 0 };
	gw_surfels s;
	gw_octree octree;
	/* Radii up to 5 leaf cells, inside the cube. */
	make_scattered(150, 3, 0.08f, &s);
	for (size_t i = 0; i < s.count; i++)
		for (size_t k = 0; k < 3; k++)
			s.position[3 * i + k] *= 0.8f;
	s.minimum[2] = -0.1f;
	s.maximum[2] = 0.5f;
	s.minimum[0] = s.minimum[1] = -0.1f;
	s.maximum[0] = s.maximum[1] = 0.9f;
	assert_ok(gw_octree_build(gpu, &s, 6, &octree, &error), &error);
	uint32_t *first = download(gpu, &octree.leaf_fragment);
	uint32_t *cell = download(gpu, &octree.leaf_cell);
	uint32_t *surfel = download(gpu, &octree.fragment_surfel);
	float *weight = download(gpu, &octree.fragment_weight);
	static share list[4096];
	for (size_t i = 0; i < s.count; i++) {
		uint32_t count = 0;
		double leaf = (double)octree.leaf_size, cells = (double)s.area[i] / (leaf * leaf);
		double radius = (double)s.radius[i] / leaf;
		if (i % 50 == 0)
			continue; /* all of it is cut */
		look_at_disc(&s, &octree, i, list, &count);
		for (uint32_t l = 0; l < octree.leaf_count; l++)
			for (uint32_t f = first[l]; f < first[l + 1]; f++)
				if (surfel[f] >> 31 == 0 && (surfel[f] & 0x3fffffffu) == i)
					share_of(list, &count,
							 gw_morton_encode(cell[4 * l], cell[4 * l + 1], cell[4 * l + 2]))
						->got += (double)weight[f] / cells;
		/* Small discs: 16 points of which those near a border, and of those near a clip, may be
		 * on the wrong side: 3 of the least 8 that clips leave. Large: in a column, of 16 points
		 * those along up to two lines; relative to the part that clips leave, at least half. */
		double left = 0.5 * 3.14159 * radius * radius;
		double tolerance = radius <= 1 ? 3.0 / 8 : 0.5 * 1.7321 / left;
		for (uint32_t k = 0; k < count; k++)
			if (!(fabs(list[k].got - list[k].reference) <= tolerance))
				fail_msg("disc %zu, radius %g: share %g, not %g", i, radius, list[k].got,
						 list[k].reference);
	}
	free(first);
	free(cell);
	free(surfel);
	free(weight);
	gw_octree_destroy(gpu, &octree);
	gw_surfels_clear(&s);
	close_gpu(gpu);
}

/* ---------------------------------------------------------------------------------- leaves */

/* Sums over the fragments of one leaf, in double. */
typedef struct leaf_sums {
	double geometry[7]; /* opacity times albedo, opacity, opacity times normal */
	double area[2], normal[2][3], albedo[2][3], emission[2][3], two_sided[2];
	uint32_t seed;
	bool facet[2];
} leaf_sums;

static double dot(const float *a, const float *b)
{
	return (double)a[0] * (double)b[0] + (double)a[1] * (double)b[1] + (double)a[2] * (double)b[2];
}

typedef struct downloaded {
	uint32_t *first, *surfel, *tile, *cell, *leaf;
	float *weight, *geometry, *plane, *centre, *albedo, *emission;
} downloaded;

static downloaded download_leaves(gw_gpu *gpu, gw_octree *o)
{
	return (downloaded){
		.first = download(gpu, &o->leaf_fragment),
		.surfel = download(gpu, &o->fragment_surfel),
		.tile = download(gpu, &o->leaf_tile),
		.cell = download(gpu, &o->leaf_cell),
		.leaf = download(gpu, &o->facet_leaf),
		.weight = download(gpu, &o->fragment_weight),
		.geometry = download(gpu, &o->leaf_geometry),
		.plane = download(gpu, &o->facet_plane),
		.centre = download(gpu, &o->facet_centre),
		.albedo = download(gpu, &o->facet_albedo),
		.emission = download(gpu, &o->facet_emission),
	};
}

static void free_leaves(downloaded *d)
{
	void *array[] = { d->first,    d->surfel, d->tile,   d->cell,   d->leaf,    d->weight,
					  d->geometry, d->plane,  d->centre, d->albedo, d->emission };
	for (size_t i = 0; i < sizeof array / sizeof *array; i++)
		free(array[i]);
}

static void add_facet(leaf_sums *sums, const gw_surfels *s, uint32_t id, double area, int facet)
{
	sums->facet[facet] = true;
	sums->area[facet] += area;
	sums->two_sided[facet] += s->two_sided[id] ? area : 0;
	for (size_t k = 0; k < 3; k++) {
		sums->normal[facet][k] += area * (double)s->normal[3 * id + k];
		sums->albedo[facet][k] += area * (double)s->albedo[3 * id + k];
		if (s->emission != NULL)
			sums->emission[facet][k] += area * (double)s->emission[3 * id + k];
	}
}

/* Also checks the bit that says which facet a fragment joined. */
static leaf_sums sum_leaf(const gw_surfels *s, const downloaded *d, uint32_t leaf)
{
	leaf_sums sums = { .seed = UINT32_MAX };
	for (uint32_t f = d->first[leaf]; f < d->first[leaf + 1]; f++)
		if (d->surfel[f] >> 31 == 0 &&
			(sums.seed == UINT32_MAX || d->weight[f] > d->weight[sums.seed]))
			sums.seed = f;
	for (uint32_t f = d->first[leaf]; f < d->first[leaf + 1]; f++) {
		uint32_t id = d->surfel[f] & 0x3fffffffu;
		double weight = (double)d->weight[f];
		if (d->surfel[f] >> 31) {
			for (size_t k = 0; k < 3; k++) {
				sums.geometry[k] += weight * (double)s->albedo[3 * id + k];
				sums.geometry[4 + k] += weight * (double)s->normal[3 * id + k];
			}
			sums.geometry[3] += weight;
			continue;
		}
		double cosine =
			dot(s->normal + 3 * id, s->normal + 3 * (d->surfel[sums.seed] & 0x3fffffffu));
		int facet = d->surfel[f] >> 30 & 1;
		/* On the border between the facets, rounding of a dot product of float32 decides. */
		if (fabs(cosine - 0.5) > 4 * 0x1p-23)
			assert_int_equal(facet, cosine < 0.5);
		add_facet(&sums, s, id, weight, facet);
	}
	return sums;
}

/*
 * Sums of positive float32 values, in two stages of at most 2048: about 2048 half units in the last
 * place if all rounded the same way, in practice its square root.
 */
#define SUM_TOLERANCE (2048 * 0x1p-24)

static void assert_near(const char *what, uint32_t leaf, double got, double expected,
						double tolerance)
{
	if (!(fabs(got - expected) <= tolerance))
		fail_msg("%s of leaf %u is %.9g, not %.9g", what, leaf, got, expected);
}

/* What tells of the leaf's tile. */
static uint32_t octant_of(const downloaded *d, size_t leaf)
{
	const uint32_t *c = d->cell + 4 * leaf;
	return (c[0] & 1) | (c[1] & 1) << 1 | (c[2] & 1) << 2;
}

/* The number of its first facet. */
static size_t first_facet(const downloaded *d, size_t leaf)
{
	return gw_facet_first(d->tile + 2 * (size_t)d->cell[4 * leaf + 3], octant_of(d, leaf));
}

static bool has_second(const downloaded *d, size_t leaf)
{
	return (d->tile[2 * d->cell[4 * leaf + 3] + 1] >> (16 + octant_of(d, leaf)) & 1) != 0;
}

static void compare_facet(const gw_surfels *s, const downloaded *d, const leaf_sums *sums,
						  uint32_t leaf, int facet)
{
	size_t number = first_facet(d, leaf) + (size_t)facet;
	const float *plane = d->plane + 4 * number, *centre = d->centre + 4 * number;
	double area = sums->area[facet], length = 0, offset = 0;
	if (!sums->facet[facet]) {
		for (int k = 0; k < 4; k++)
			assert_true(plane[k] == 0 && centre[k] == 0 && d->albedo[4 * number + (size_t)k] == 0);
		return;
	}
	assert_near("area", leaf, (double)centre[3], area, SUM_TOLERANCE * area);
	for (int k = 0; k < 3; k++)
		length += sums->normal[facet][k] * sums->normal[facet][k];
	length = sqrt(length);
	assert_near("normal's length", leaf, dot(plane, plane), 1, 1e-6);
	for (size_t k = 0; k < 3; k++) {
		size_t at = 4 * number + k;
		if (length > 0.01 * area)
			assert_near("normal", leaf, (double)plane[k], sums->normal[facet][k] / length,
						2 * SUM_TOLERANCE * area / length);
		assert_near("albedo", leaf, (double)d->albedo[at], sums->albedo[facet][k] / area,
					2 * SUM_TOLERANCE);
		if (s->emission != NULL)
			assert_near("emission", leaf, (double)d->emission[at], sums->emission[facet][k] / area,
						2 * SUM_TOLERANCE * 5);
		double from_middle = (double)centre[k] - (double)d->cell[4 * leaf + k] - 0.5;
		/* Grid coordinates of centres are float32. */
		assert_true(fabs(from_middle) <= 0.5 + 1e-4);
		offset += from_middle * (double)plane[k];
	}
	if (fabs(offset) < 0.49) /* else the centre may have been moved into the cell */
		assert_near("offset", leaf, (double)plane[3], offset, 3e-4);
	if (fabs(sums->two_sided[facet] - 0.5 * area) > 1e-3 * area)
		assert_true((d->albedo[4 * number + 3] == 1) == (sums->two_sided[facet] > 0.5 * area));
}

/* Returns the area of all facets. */
static double compare_leaves(gw_gpu *gpu, const gw_surfels *s, gw_octree *octree)
{
	downloaded d = download_leaves(gpu, octree);
	double area = 0;
	for (uint32_t leaf = 0; leaf < octree->leaf_count; leaf++) {
		leaf_sums sums = sum_leaf(s, &d, leaf);
		uint32_t flags = d.tile[2 * d.cell[4 * leaf + 3] + 1] >> octant_of(&d, leaf);
		assert_int_equal(flags & 1, 1);
		assert_int_equal(flags >> 8 & 1, sums.facet[0]);
		assert_int_equal(flags >> 16 & 1, sums.facet[1]);
		for (size_t k = 0; k < 7; k++)
			assert_near("geometry", leaf, (double)d.geometry[8 * leaf + k], sums.geometry[k],
						SUM_TOLERANCE * sums.geometry[3] + 1e-30);
		for (int facet = 0; facet < (sums.facet[1] ? 2 : 1); facet++) {
			compare_facet(s, &d, &sums, leaf, facet);
			area += (double)d.centre[4 * (first_facet(&d, leaf) + (size_t)facet) + 3];
		}
	}
	free_leaves(&d);
	return area;
}

static void test_leaves(void **state)
{
	(void)state;
	gw_gpu *gpu = open_gpu(validated);
	const struct {
		size_t count;
		uint32_t depth;
	} row[] = { { 500, 7 }, { 5000, 5 }, { 20000, 1 } }; /* the last: many runs a leaf */
	for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
		gw_error error = { 0 };
		gw_surfels s;
		gw_octree octree;
		make_scattered(row[i].count, i + 5, 0.03f, &s); /* with emission, and without */
		assert_ok(gw_octree_build(gpu, &s, row[i].depth, &octree, &error), &error);
		assert_int_equal(octree.facet_emission.bytes,
						 s.emission != NULL ? 16 * octree.facet_count : 16);
		compare_leaves(gpu, &s, &octree);
		gw_octree_destroy(gpu, &octree);
		gw_surfels_clear(&s);
	}
	close_gpu(gpu);
}

/* A sphere: areas add up, and facets look outwards. */
static void test_sphere(void **state)
{
	(void)state;
	gw_gpu *gpu = open_gpu(validated);
	gw_error error = { 0 };
	gw_surfels s;
	gw_octree octree;
	assert_true(octree_points_sphere(20000, 11, &s));
	assert_ok(gw_octree_build(gpu, &s, 6, &octree, &error), &error);
	double leaf = (double)octree.leaf_size, area = compare_leaves(gpu, &s, &octree) * leaf * leaf;
	/* The surfels' areas, in float32. */
	assert_true(fabs(area - 4 * 3.14159265) < 1e-4 * area);
	downloaded d = download_leaves(gpu, &octree);
	double worst = 0, sum = 0, opacity = 0;
	assert_int_equal(octree.facet_count, octree.leaf_count + 1); /* nothing is 60 degrees apart */
	for (uint32_t i = 0; i < octree.leaf_count; i++) {
		double r = 0, cosine = 0;
		opacity += (double)d.geometry[8 * i + 3];
		const float *centre = d.centre + 4 * first_facet(&d, i);
		if (centre[3] == 0)
			continue;
		for (size_t k = 0; k < 3; k++) {
			double p = (double)centre[k] * leaf + (double)octree.cube_minimum[k];
			r += p * p;
			cosine += p * (double)d.plane[4 * first_facet(&d, i) + k];
		}
		double angle = acos(fmin(1, cosine / sqrt(r)));
		worst = fmax(worst, angle);
		sum += angle * (double)centre[3];
	}
	/* A patch has the normal of its surfel, which is up to a disc's radius away. */
	assert_true(worst < (double)s.radius[0]);
	double mean = sum * leaf * leaf / area;
	print_message("normals off by %.3f degrees on average, %.3f at worst\n", mean * 57.29578,
				  worst * 57.29578);
	/* RoI is half a spacing here, and so a quarter of the area is opaque. */
	assert_true(fabs(opacity * leaf * leaf / area - 0.25) < 1e-3);
	free_leaves(&d);
	gw_octree_destroy(gpu, &octree);
	gw_surfels_clear(&s);
	close_gpu(gpu);
}

/* A slanted plane: each facet lies in it, wherever its cell cuts it. */
static void test_plane(void **state)
{
	(void)state;
	gw_gpu *gpu = open_gpu(validated);
	gw_error error = { 0 };
	gw_surfels s;
	gw_octree octree;
	assert_true(octree_points_make(3000, false, &s));
	const float normal[3] = { 0.36f, 0.48f, 0.8f };
	uint64_t seed = 21;
	for (size_t i = 0; i < s.count; i++) {
		float *p = s.position + 3 * i;
		p[0] = (float)octree_points_random(&seed);
		p[1] = (float)octree_points_random(&seed);
		p[2] = -(0.36f * p[0] + 0.48f * p[1]) / 0.8f;
		memcpy(s.normal + 3 * i, normal, sizeof normal);
		s.radius[i] = i % 2 ? 0.01f : 0.05f; /* small ones, and large ones */
		s.area[i] = 1e-3f;
		s.nearest[i] = 0.01f;
	}
	octree_points_bound(&s);
	assert_ok(gw_octree_build(gpu, &s, 6, &octree, &error), &error);
	downloaded d = download_leaves(gpu, &octree);
	double leaf = (double)octree.leaf_size;
	for (uint32_t i = 0; i < octree.leaf_count; i++) {
		const float *plane = d.plane + 4 * first_facet(&d, i);
		double height = 0;
		if (d.centre[4 * first_facet(&d, i) + 3] == 0)
			continue;
		for (size_t k = 0; k < 3; k++) {
			assert_true(fabsf(plane[k] - normal[k]) < 1e-5f);
			height += (double)normal[k] *
					  (((double)d.cell[4 * i + k] + 0.5) * leaf + (double)octree.cube_minimum[k]);
		}
		/* height + c = 0; grid coordinates up to 64 are float32: 2^-19 each, and as much again for
		 * the surfels' own positions, in cells. */
		if (!(fabs(height / leaf + (double)plane[3]) < 2e-5))
			fail_msg("leaf %u is %g cells off the plane", i, height / leaf + (double)plane[3]);
	}
	free_leaves(&d);
	gw_octree_destroy(gpu, &octree);
	gw_surfels_clear(&s);
	close_gpu(gpu);
}

/* The leaf of a cell, or UINT32_MAX. */
static uint32_t leaf_at(const gw_octree *o, const downloaded *d, const uint32_t *cell)
{
	for (uint32_t leaf = 0; leaf < o->leaf_count; leaf++)
		if (memcmp(d->cell + 4 * leaf, cell, 3 * sizeof *cell) == 0)
			return leaf;
	return UINT32_MAX;
}

static bool has_facet(const downloaded *d, uint32_t leaf)
{
	return (d->tile[2 * d->cell[4 * leaf + 3] + 1] >> (8 + octant_of(d, leaf)) & 1) != 0;
}

/* An octree without regions has just the leaves with facets, and these to the last bit. */
static void test_without_regions(void **state)
{
	(void)state;
	gw_gpu *gpu = open_gpu((gw_gpu_options){ 0 });
	gw_error error = { 0 };
	gw_surfels s;
	gw_octree whole, bare;
	make_scattered(2000, 9, 0.2f, &s);
	const gw_octree_task task = { .surfels = &s, .depth = 6 };
	assert_ok(gw_octree_build(gpu, &s, 6, &whole, &error), &error);
	assert_ok(gw_octree_build_task(gpu, &task, &bare, &error), &error);
	downloaded all = download_leaves(gpu, &whole),
			   some = { .cell = download(gpu, &bare.leaf_cell),
						.tile = download(gpu, &bare.leaf_tile) };
	some.plane = download(gpu, &bare.facet_plane);
	some.surfel = download(gpu, &bare.fragment_surfel);
	uint32_t facets = 0;
	for (uint32_t leaf = 0; leaf < whole.leaf_count; leaf++) {
		uint32_t own = leaf_at(&bare, &some, all.cell + 4 * leaf);
		assert_int_equal(own != UINT32_MAX, has_facet(&all, leaf));
		facets += own != UINT32_MAX;
		if (own == UINT32_MAX)
			continue;
		assert_int_equal(has_second(&some, own), has_second(&all, leaf));
		assert_memory_equal(some.plane + 4 * first_facet(&some, own),
							all.plane + 4 * first_facet(&all, leaf),
							(has_second(&all, leaf) ? 32 : 16));
	}
	assert_int_equal(facets, bare.leaf_count);
	assert_true(facets < whole.leaf_count);
	for (uint32_t f = 0; f < bare.fragment_count; f++)
		assert_int_equal(some.surfel[f] >> 31, 0);
	assert_true(whole.border_tile_count > 0 && bare.border_tile_count == 0);
	assert_true(bare.leaf_geometry.handle == VK_NULL_HANDLE);
	free_leaves(&all);
	free_leaves(&some);
	gw_octree_destroy(gpu, &whole);
	gw_octree_destroy(gpu, &bare);
	gw_surfels_clear(&s);
	close_gpu(gpu);
}

/* --------------------------------------------------------------------------------- numbering */

/* The octree's numbers are these: no gaps, every facet's leaf and back, the empty one first.
 * Returns how many leaves have two facets. */
static uint32_t check_numbers(const gw_octree *o, const downloaded *d)
{
	uint32_t next = GW_FACET_EMPTY + 1, seconds = 0;
	for (uint32_t leaf = 0; leaf < o->leaf_count; leaf++) {
		bool joined = false;
		for (uint32_t f = d->first[leaf]; f < d->first[leaf + 1]; f++)
			joined |= (d->surfel[f] & GW_FRAGMENT_FACET) != 0;
		assert_int_equal(has_second(d, leaf), joined);
		assert_int_equal(first_facet(d, leaf), next);
		assert_int_equal(d->leaf[next], leaf);
		if (joined)
			assert_int_equal(d->leaf[next + 1], leaf | GW_FACET_SECOND);
		next += joined ? 2 : 1;
		seconds += joined;
	}
	assert_int_equal(next, o->facet_count);
	assert_true(gw_facet_is_second(d->leaf[GW_FACET_EMPTY]));
	size_t empty_of = gw_facet_leaf(d->leaf[GW_FACET_EMPTY]);
	assert_true(empty_of < o->leaf_count);
	assert_true(seconds == o->leaf_count || !has_second(d, empty_of));
	for (size_t k = 4 * GW_FACET_EMPTY; k < 4 * GW_FACET_EMPTY + 4; k++)
		assert_true(d->plane[k] == 0 && d->centre[k] == 0 && d->albedo[k] == 0);
	assert_true(gw_octree_numbers_fit(o, d->leaf, d->tile));
	return seconds;
}

/* Puts a word in place of another one, with which the numbers must not fit. */
static void assert_refused(const gw_octree *o, const downloaded *d, uint32_t *word, uint32_t wrong)
{
	uint32_t right = *word;
	*word = wrong;
	assert_false(gw_octree_numbers_fit(o, d->leaf, d->tile));
	*word = right;
	assert_true(gw_octree_numbers_fit(o, d->leaf, d->tile));
}

static void check_refusals(const gw_octree *o, const downloaded *d)
{
	uint32_t leaf = o->leaf_count / 2, one = 0, two = 0;
	while (has_second(d, one))
		one++;
	while (!has_second(d, two))
		two++;
	size_t facet = first_facet(d, leaf), of_one = first_facet(d, one), of_two = first_facet(d, two);
	assert_refused(o, d, &d->leaf[facet], leaf + 1);
	assert_refused(o, d, &d->leaf[facet], leaf | GW_FACET_SECOND);
	assert_refused(o, d, &d->leaf[of_one], one | GW_FACET_SECOND);
	assert_refused(o, d, &d->leaf[of_two + 1], two);
	assert_refused(o, d, &d->leaf[of_two + 1], (two + 1) | GW_FACET_SECOND);
	assert_refused(o, d, &d->leaf[GW_FACET_EMPTY], 0);
	assert_refused(o, d, &d->leaf[GW_FACET_EMPTY], o->leaf_count | GW_FACET_SECOND);
	uint32_t *tile = d->tile + 2 * (size_t)d->cell[4 * one + 3];
	assert_refused(o, d, &tile[0], o->facet_count);
	assert_refused(o, d, &tile[1], tile[1] | 1u << (16 + octant_of(d, one)));
	assert_refused(o, d, &tile[1], tile[1] & ~(1u << octant_of(d, one)));
}

/* Surfels so small that each lies in the leaf of its place alone: of every n-th place there is a
 * second one, which faces along x; 0: of none. */
static void make_crossed(size_t places, size_t n, gw_surfels *s)
{
	size_t count = places;
	for (size_t i = 0; i < places; i++)
		count += n > 0 && i % n == 0;
	assert_true(octree_points_make(count, false, s));
	uint64_t seed = 5;
	for (size_t i = 0, at = 0; i < places; i++) {
		float *p = s->position + 3 * at++;
		for (int k = 0; k < 3; k++)
			p[k] = (float)octree_points_random(&seed);
		if (n == 0 || i % n != 0)
			continue;
		memcpy(s->position + 3 * at, p, 3 * sizeof *p);
		s->normal[3 * at] = 1.0f;
		s->normal[3 * at++ + 2] = 0.0f;
	}
	for (size_t i = 0; i < count; i++) {
		s->radius[i] = s->nearest[i] = 1e-9f;
		s->area[i] = 1e-18f;
	}
	octree_points_bound(s);
}

/* Leaves without second facets, some that have one, and none without. */
static void test_numbers(void **state)
{
	(void)state;
	gw_gpu *gpu = open_gpu((gw_gpu_options){ 0 });
	const size_t every[] = { 0, 3, 1 };
	for (size_t i = 0; i < sizeof every / sizeof *every; i++) {
		gw_error error = { 0 };
		gw_surfels s;
		gw_octree octree;
		make_crossed(4000, every[i], &s);
		if (every[i] > 0)
			s.transparency = calloc(s.count, sizeof *s.transparency);
		assert_ok(gw_octree_build(gpu, &s, 5, &octree, &error), &error);
		downloaded d = download_leaves(gpu, &octree);
		uint32_t seconds = check_numbers(&octree, &d);
		assert_true(octree.leaf_count > 3000);
		if (every[i] == 0)
			assert_int_equal(seconds, 0);
		else if (every[i] == 1)
			assert_int_equal(seconds, octree.leaf_count);
		else
			assert_in_range(seconds, 1000, octree.leaf_count - 1000);
		assert_int_equal(octree.dark_facet, every[i] > 0 ? GW_FACET_EMPTY + 1 : 0);
		if (every[i] == 3)
			check_refusals(&octree, &d);
		free_leaves(&d);
		gw_octree_destroy(gpu, &octree);
		gw_surfels_clear(&s);
	}
	close_gpu(gpu);
}

/* ------------------------------------------------------------------------------ circumstances */

#define BUFFERS 20

static void list_buffers(gw_octree *o, gw_buffer *list[BUFFERS])
{
	gw_buffer *all[BUFFERS] = {
		&o->node,
		&o->tile_key,
		&o->tile_neighbour,
		&o->leaf_tile_key,
		&o->leaf_tile,
		&o->leaf_cell,
		&o->leaf_tile_neighbour,
		&o->level_directory,
		&o->ray_directory,
		&o->leaf_geometry,
		&o->facet_leaf,
		&o->facet_plane,
		&o->facet_centre,
		&o->facet_albedo,
		&o->facet_emission,
		&o->leaf_fragment,
		&o->fragment_surfel,
		&o->surfel_normal,
		&o->surfel_position,
		&o->fragment_weight,
	};
	memcpy(list, all, sizeof all);
}

static void compare_buffers(gw_gpu *gpu, gw_octree *octree, gw_gpu *other_gpu, gw_octree *other)
{
	gw_buffer *a[BUFFERS], *b[BUFFERS];
	list_buffers(octree, a);
	list_buffers(other, b);
	for (int i = 0; i < BUFFERS; i++) {
		void *x = download(gpu, a[i]), *y = download(other_gpu, b[i]);
		assert_true(a[i]->bytes == b[i]->bytes);
		if (memcmp(x, y, a[i]->bytes) != 0)
			fail_msg("\"%s\" differs between two builds", a[i]->name);
		free(x);
		free(y);
	}
}

/* The same bytes, however the work is cut, and whoever does it. */
static void test_repeatable(void **state)
{
	(void)state;
	const gw_gpu_options options[] = { { 0 },
									   { .slice_seconds = 1e-4, .workgroup_size = 8 },
									   { 0 } };
	gw_error error = { 0 };
	gw_surfels s;
	gw_octree octree[3];
	gw_gpu *gpu[3];
	make_scattered(20000, 4, 0.02f, &s);
	for (int i = 0; i < 3; i++) {
		gpu[i] = i < 2 ? open_gpu_of_shaders(options[i]) : open_gpu(options[i]);
		assert_ok(gw_octree_build(gpu[i], &s, 7, &octree[i], &error), &error);
	}
	compare_buffers(gpu[0], &octree[0], gpu[1], &octree[1]);
	compare_buffers(gpu[0], &octree[0], gpu[2], &octree[2]);
	for (int i = 0; i < 3; i++) {
		gw_octree_destroy(gpu[i], &octree[i]);
		close_gpu(gpu[i]);
	}
	gw_surfels_clear(&s);
}

/* Lists that are larger than what the device binds as storage are written as texels; what is sorted
 * then is the processor's. */
static void test_lists_beyond_storage(void **state)
{
	(void)state;
	gw_gpu *gpu = open_gpu(validated);
	gw_error error = { 0 };
	gw_surfels s;
	gw_octree whole, written;
	make_scattered(20000, 4, 0.02f, &s);
	assert_ok(gw_octree_build(gpu, &s, 7, &whole, &error), &error);
	uint64_t range = gpu->storage_range;
	gpu->storage_range = 4 << 3 * 6; /* what the directory of level 6 takes, whatever the points */
	assert_true(4 * (uint64_t)whole.fragment_count > gpu->storage_range);
	assert_true(16 * (uint64_t)whole.leaf_count > gpu->storage_range);
	assert_ok(gw_octree_build(gpu, &s, 7, &written, &error), &error);
	gpu->storage_range = range;
	compare_buffers(gpu, &whole, gpu, &written);
	gw_octree_destroy(gpu, &whole);
	gw_octree_destroy(gpu, &written);
	gw_surfels_clear(&s);
	close_gpu(gpu);
}

/* Points that are hard: one alone, tiny and huge discs and regions. */
static void test_odd_surfels(void **state)
{
	(void)state;
	gw_gpu *gpu = open_gpu(validated);
	gw_error error = { 0 };
	for (int i = 0; i < 4; i++) {
		gw_surfels s;
		gw_octree octree;
		size_t count = i == 0 ? 1 : 3;
		assert_true(octree_points_make(count, false, &s));
		for (size_t k = 0; k < count; k++) {
			s.position[3 * k] = (float)k;
			s.nearest[k] = i == 0 ? INFINITY : i == 1 ? 1e-30f : 1;
			s.radius[k] = i == 2 ? 1e30f : i == 3 ? 1e-38f : 0.1f;
			s.area[k] = i == 2 ? 1e30f : i == 3 ? 1.2e-38f : 0.01f;
		}
		s.spacing = 0.1f;
		octree_points_bound(&s);
		const uint32_t depth[] = { 1, 6, 16 };
		for (int k = 0; k < 3; k++) {
			assert_ok(gw_octree_build(gpu, &s, depth[k], &octree, &error), &error);
			bool clamped = i == 2 || (i == 1 && depth[k] == 16);
			assert_int_equal(octree.tree_discs, clamped ? count : 0);
			compare_topology(gpu, &octree);
			float *plane = download(gpu, &octree.facet_plane);
			for (uint64_t f = 0; f < octree.facet_plane.bytes / 4; f++)
				assert_true(isfinite(plane[f]));
			free(plane);
			gw_octree_destroy(gpu, &octree);
		}
		gw_surfels_clear(&s);
	}
	close_gpu(gpu);
}

static void test_refusals(void **state)
{
	(void)state;
	gw_gpu *gpu = open_gpu_of_shaders((gw_gpu_options){ 0 });
	gw_error error = { 0 };
	gw_surfels s, none = { 0 };
	gw_octree octree;
	make_scattered(2000, 9, 0.2f, &s);
	assert_int_equal(gw_octree_build(gpu, &s, GW_DEPTH_MAX + 1, &octree, &error), GW_ERROR_USAGE);
	assert_int_equal(gw_octree_build(gpu, &none, 5, &octree, &error), GW_ERROR_DATA);

	/* A device that binds little: the sentence names a depth, and that depth is right. */
	gpu->device.properties.limits.maxStorageBufferRange = 200000;
	assert_int_equal(gw_octree_build(gpu, &s, 7, &octree, &error), GW_ERROR_MEMORY);
	const char *advice = strstr(error.text, "depth of ");
	assert_non_null(advice);
	uint32_t fitting = (uint32_t)strtoul(advice + 9, NULL, 10);
	assert_in_range(fitting, 1, 6);
	assert_ok(gw_octree_build(gpu, &s, fitting, &octree, &error), &error);
	assert_true(4 * (uint64_t)octree.fragment_count <= 200000);
	gw_octree_destroy(gpu, &octree);
	assert_int_equal(gw_octree_build(gpu, &s, fitting + 1, &octree, &error), GW_ERROR_MEMORY);
	gpu->device.properties.limits.maxStorageBufferRange = 8000;
	assert_int_equal(gw_octree_build(gpu, &s, 7, &octree, &error), GW_ERROR_MEMORY);
	assert_non_null(strstr(error.text, "fewer points"));
	assert_null(octree.node.handle);
	gw_surfels_clear(&s);
	close_gpu(gpu);
}

/* Where the device binds little, leaves get wider by the root of 2 until their fragments fit, and
 * not once more; those that are known to be too many are not tried: points go up once a try. */
static void test_wider_leaves(void **state)
{
	(void)state;
	gw_gpu *gpu = open_gpu_of_shaders((gw_gpu_options){ 0 });
	gw_error error = { 0 };
	gw_surfels s;
	gw_octree octree;
	gw_octree_task task = { .surfels = &s, .leaf_spacing = 0.125f, .regions = true };
	make_scattered(2000, 9, 0.2f, &s);
	assert_ok(gw_octree_build_task(gpu, &task, &octree, &error), &error);
	uint32_t fine = octree.fragment_count, most = fine / 6, steps = 0;
	gw_octree_destroy(gpu, &octree);
	uint64_t before = gw_gpu_read_account(gpu).uploaded_bytes;
	gpu->device.properties.limits.maxStorageBufferRange = 4 * most;
	assert_ok(gw_octree_build_task(gpu, &task, &octree, &error), &error);
	uint64_t uploaded = gw_gpu_read_account(gpu).uploaded_bytes - before;
	uint64_t numbers = 4 * (uint64_t)octree.facet_count + 8 * (uint64_t)octree.leaf_tile_count;
	assert_true(octree.fragment_count <= most && octree.wanted_leaf_size > 0.0f);
	gw_octree_destroy(gpu, &octree);
	gpu->device.properties.limits.maxStorageBufferRange = UINT32_MAX;
	for (uint32_t count = fine; count > most; steps++) {
		task.leaf_spacing = 0.125f * exp2f(0.5f * (float)(steps + 1));
		assert_ok(gw_octree_build_task(gpu, &task, &octree, &error), &error);
		count = octree.fragment_count;
		gw_octree_destroy(gpu, &octree);
	}
	/* Of 6 times as many, one step and two are too few for certain. A try takes 80 bytes a point,
	 * what is built 48 more for colours and discs, numbers of facets, which come from the host, and
	 * a page for what is no point's. */
	assert_true(steps >= 3);
	assert_in_range(uploaded, 1, s.count * (80 * (uint64_t)(steps - 1) + 48) + numbers + 4096);
	gw_surfels_clear(&s);
	close_gpu(gpu);
}

/* Whichever allocation fails, everything is given back. */
static void test_short_memory(void **state)
{
	(void)state;
	gw_gpu *gpu = open_gpu((gw_gpu_options){ 0 });
	gw_error error = { 0 };
	gw_surfels s;
	gw_octree octree;
	make_scattered(500, 2, 0.05f, &s);
	assert_ok(gw_octree_build(gpu, &s, 5, &octree, &error), &error);
	gw_octree_destroy(gpu, &octree);
	uint64_t peak = gw_gpu_read_account(gpu).peak_bytes;
	int failed = 0;
	for (uint64_t budget = 0; budget < peak; budget += peak / 40 + 1, failed++) {
		gpu->budget = budget;
		assert_int_equal(gw_octree_build(gpu, &s, 5, &octree, &error), GW_ERROR_MEMORY);
		assert_int_equal(gw_gpu_read_account(gpu).bytes, 0);
		assert_null(octree.facet_plane.handle);
	}
	assert_in_range(failed, 39, 40);
	gw_surfels_clear(&s);
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
		cmocka_unit_test(test_discs),
		cmocka_unit_test(test_leaves),
		cmocka_unit_test(test_sphere),
		cmocka_unit_test(test_plane),
		cmocka_unit_test(test_without_regions),
		cmocka_unit_test(test_numbers),
		cmocka_unit_test(test_repeatable),
		cmocka_unit_test(test_lists_beyond_storage),
		cmocka_unit_test(test_odd_surfels),
		cmocka_unit_test(test_refusals),
		cmocka_unit_test(test_wider_leaves),
		cmocka_unit_test(test_short_memory),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

/* Clouds that are lit tile by tile: which points belong to which, and that their light is that of a
 * bake of the whole, without seams. */
#include "base/hash.h"
#include "base/luminance.h"
#include "expected.h"
#include "glowworm_parts.h"
#include "scenes.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* One point in so many is kept of the whole cloud, by chance. */
#define KEPT 8u

/* A cloud in tiles: the parts that it is counted in are of 1000 points. */
typedef struct tiled {
	const scene *scene;
	scene kept_scene;
	gw_points all, kept;
	gw_tiling *tiling;
	gw_tile_members members, kept_members;
} tiled;

static gw_points part_of(const gw_points *all, size_t first, size_t count)
{
	gw_points part = *all;
	part.count = count;
	part.position += 3 * first;
	return part;
}

/* Some of the points, as a cloud of their own. */
static gw_points taken(const scene *s, const uint32_t *point, size_t count, scene *into)
{
	for (size_t i = 0; i < count; i++) {
		size_t from = point[i];
		const double normal[3] = { (double)s->normal[3 * from], (double)s->normal[3 * from + 1],
								   (double)s->normal[3 * from + 2] };
		size_t k = scene_add(into, s->position + 3 * from, normal, s->albedo[3 * from]);
		if (s->emits)
			scene_emit(into, k, s->emission + 3 * from);
	}
	return scene_points(into);
}

static void form(tiled *t, const scene *s, double width, uint64_t most, uint32_t least)
{
	gw_error error = { 0 };
	*t = (tiled){ .scene = s, .all = scene_points(s) };
	uint32_t *kept = calloc(s->count, sizeof *kept);
	size_t count = 0;
	assert_non_null(kept);
	for (size_t i = 0; i < s->count; i++)
		if (gw_hash(1, &i, sizeof i) % KEPT == 0)
			kept[count++] = (uint32_t)i;
	t->kept = taken(s, kept, count, &t->kept_scene);
	free(kept);
	assert_ok(gw_tiling_begin(&t->kept, width, &t->tiling, &error), &error);
	for (size_t i = 0; i < s->count; i += 1000) {
		gw_points part = part_of(&t->all, i, s->count - i < 1000 ? s->count - i : 1000);
		assert_ok(gw_tiling_count(t->tiling, &part, &error), &error);
	}
	assert_ok(gw_tiling_form(t->tiling, most, least, &error), &error);
	assert_ok(gw_tiling_members(t->tiling, &t->all, &t->members, &error), &error);
	assert_ok(gw_tiling_members(t->tiling, &t->kept, &t->kept_members, &error), &error);
}

static void clear(tiled *t)
{
	gw_tile_members_clear(&t->members);
	gw_tile_members_clear(&t->kept_members);
	gw_tiling_end(&t->tiling);
	scene_clear(&t->kept_scene);
}

/* The tile whose core each point is in; each is in one. */
static uint32_t *tiles_of(const tiled *t)
{
	uint32_t *tile = calloc(t->all.count, sizeof *tile);
	assert_non_null(tile);
	for (size_t i = 0; i < t->all.count; i++)
		tile[i] = UINT32_MAX;
	for (uint32_t k = 0; k < gw_tiling_tiles(t->tiling); k++)
		for (uint64_t m = t->members.first[k]; m < t->members.first[k + 1]; m++)
			if (t->members.core[m]) {
				assert_int_equal(tile[t->members.point[m]], UINT32_MAX);
				tile[t->members.point[m]] = k;
			}
	for (size_t i = 0; i < t->all.count; i++)
		assert_true(tile[i] < gw_tiling_tiles(t->tiling));
	return tile;
}

static double distance_between(const double *a, const double *b)
{
	return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

/* Two cubes wide is the halo: all points are in it that are nearer to the tile than that, and none
 * that is farther than three diagonals. */
static void halos_are_what_is_around(void **state)
{
	(void)state;
	const double width = 0.06;
	scene s = { 0 };
	tiled t;
	scene_add_box(&s, (double[3]){ 0, 0, 0 }, (double[3]){ 1, 1, 1 }, 20, 0.5f);
	form(&t, &s, width, 900, 5);
	uint32_t tiles = gw_tiling_tiles(t.tiling), *tile = tiles_of(&t);
	assert_true(tiles >= 5);
	for (uint32_t k = 0; k < tiles; k++) {
		bool *in = calloc(s.count, sizeof *in);
		uint64_t first = t.members.first[k], last = t.members.first[k + 1];
		assert_non_null(in);
		assert_true(last - first <= 900);
		for (uint64_t m = first; m < last; m++)
			in[t.members.point[m]] = true;
		for (size_t i = 0; i < s.count; i++) {
			double nearest = INFINITY;
			for (size_t j = 0; j < s.count; j++)
				if (tile[j] == k)
					nearest =
						fmin(nearest, distance_between(s.position + 3 * i, s.position + 3 * j));
			assert_true(in[i] || nearest > 2 * width);
			assert_true(!in[i] || nearest < 3 * sqrt(3.0) * width);
		}
		free(in);
	}
	free(tile);
	clear(&t);
	scene_clear(&s);
}

/* One cube cannot be cut: where it has more points than a tile is to have, it is one. And what has
 * no place is in one with others. */
static void a_cube_is_not_cut(void **state)
{
	(void)state;
	scene s = { 0 };
	tiled t;
	scene_add_box(&s, (double[3]){ 0, 0, 0 }, (double[3]){ 1, 1, 1 }, 10, 0.5f);
	s.position[3] = NAN;
	form(&t, &s, 10.0, 50, 7);
	assert_true(gw_tiling_tiles(t.tiling) <= 8); /* the cubes that meet within the box */
	free(tiles_of(&t));
	clear(&t);
	scene_clear(&s);
}

static void expect_filled(const tiled *t, uint64_t most)
{
	uint32_t tiles = gw_tiling_tiles(t->tiling);
	assert_true(tiles > 1);
	for (uint32_t k = 0; k < tiles; k++) {
		const uint64_t *first = t->members.first + k;
		assert_true(first[1] - first[0] <= most);
		assert_true(k + 1 == tiles || first[2] - first[0] > most);
	}
}

/* Tiles take in what they may have, though one place is so dense that its tile is small: two that
 * follow each other never have room in one. */
static void tiles_are_filled(void **state)
{
	(void)state;
	const uint64_t most = 4500;
	const double corner[3] = { 0.4, 0.4, 0.0 }, u[3] = { 0.2, 0.0, 0.0 }, v[3] = { 0.0, 0.2, 0.0 };
	scene s = { 0 };
	tiled t;
	scene_add_box(&s, (double[3]){ 0, 0, 0 }, (double[3]){ 2, 2, 2 }, 20, 0.5f);
	scene_add_patch(&s, &(scene_patch){ corner, u, v, 60, 60 }, 0.5f);
	form(&t, &s, 0.1, most, 1);
	expect_filled(&t, most);
	clear(&t);
	/* One cube of the dense place, which is not cut, has more: then the others may, too. */
	form(&t, &s, 0.1, 1, 1);
	uint64_t fullest = 0;
	for (uint32_t k = 0; k < gw_tiling_tiles(t.tiling); k++) {
		uint64_t points = t.members.first[k + 1] - t.members.first[k];
		fullest = points > fullest ? points : fullest;
	}
	expect_filled(&t, fullest);
	clear(&t);
	scene_clear(&s);
}

/* In the room hangs one; the furnace glows by itself. */
static const gw_light lamp = { .type = GW_LIGHT_POINT,
							   .position = { 0.45, 0.55, 0.7 },
							   .intensity = { 1.0f, 1.0f, 1.0f } };

static gw_bake_result *bake(const gw_points *points, const gw_bake_options *options)
{
	gw_bake_result *light = NULL;
	gw_error error = { 0 };
	const gw_scene_description from = { points, &lamp, points->emission ? 0 : 1 };
	assert_ok(gw_bake(&from, options, NULL, &light, &error), &error);
	return light;
}

/* Lights a tile; puts the luminance of its points into `radiance`. */
static void light_tile(const tiled *t, uint32_t k, const gw_bake_options *options,
					   const gw_bake_result *kept_light, gw_tile_share *share, double *radiance)
{
	scene near = { 0 };
	gw_error error = { 0 };
	gw_bake_result *light = NULL;
	uint64_t first = t->members.first[k], count = t->members.first[k + 1] - first;
	uint64_t kept = t->kept_members.first[k];
	gw_points points = taken(t->scene, t->members.point + first, (size_t)count, &near);
	const gw_tile tile = { .near = &points,
						   .core = t->members.core + first,
						   .kept = &t->kept,
						   .light = kept_light,
						   .replaced = t->kept_members.point + kept,
						   .replaced_count = (size_t)(t->kept_members.first[k + 1] - kept),
						   .checked = k == 0 };
	const gw_tile_lighting lighting = { &lamp, t->scene->emits ? 0 : 1, options, NULL, NULL };
	assert_ok(gw_tile_light(&tile, &lighting, share, &light, &error), &error);
	assert_int_equal(light->count, count);
	for (uint64_t m = 0; m < count; m++) {
		if (t->members.core[first + m])
			radiance[t->members.point[first + m]] = gw_luminance(light->radiance + 3 * m);
		else
			assert_true(gw_luminance(light->radiance + 3 * m) == 0.0);
	}
	gw_bake_result_destroy(&light);
	scene_clear(&near);
}

/* Lights all tiles; the report of what was kept becomes theirs. */
static double *light_all(const tiled *t, const gw_bake_options *options, gw_report *report)
{
	uint32_t tiles = gw_tiling_tiles(t->tiling);
	gw_bake_result *kept = bake(&t->kept, options);
	gw_tile_share *share = calloc(tiles, sizeof *share);
	double *radiance = calloc(t->all.count, sizeof *radiance);
	assert_true(share && radiance);
	for (uint32_t k = 0; k < tiles; k++)
		light_tile(t, k, options, kept, &share[k], radiance);
	gw_tiles_report(share, tiles, 0.0, &kept->report);
	*report = kept->report;
	report->bounce = NULL;
	gw_bake_result_destroy(&kept);
	free(share);
	return radiance;
}

/* Walls that send out 1 W/(sr m^2) and reflect 0.7 of what they get, all around: each point sends
 * out 1 / (1 - 0.7), whatever the tiles. Bounces end where the rest is under a thousandth, and what
 * leaks at edges of a box of 20 points a metre is under 1 % (test_furnace.c). */
static void a_furnace_has_no_tiles(void **state)
{
	(void)state;
	const float white[3] = { 1.0f, 1.0f, 1.0f };
	scene s = { 0 };
	tiled t;
	gw_report report;
	scene_add_box(&s, (double[3]){ 0, 0, 0 }, (double[3]){ 1, 1, 1 }, 24, 0.7f);
	for (size_t i = 0; i < s.count; i++)
		scene_emit(&s, i, white);
	form(&t, &s, 0.15, s.count, 4);
	gw_bake_options options = gw_bake_options_default();
	double *radiance = light_all(&t, &options, &report), sum = 0.0, largest = 0.0;
	for (size_t i = 0; i < s.count; i++) {
		sum += radiance[i] * 0.3 / (double)s.count;
		largest = fmax(largest, fabs(radiance[i] * 0.3 - 1.0));
	}
	print_message("mean %.5f, largest off %.5f\n", sum, largest);
	assert_true(fabs(sum - 1.0) < 0.01);
	free(radiance);
	clear(&t);
	scene_clear(&s);
}

/* Steps of light between neighbours, of the same tile and of two. */
typedef struct steps {
	double square[2], count[2];
} steps;

static void add_steps(const scene *s, const uint32_t *tile, const double *radiance, steps *sum)
{
	for (size_t i = 0; i < s->count; i++)
		for (size_t j = i + 1; j < s->count; j++) {
			const float *n = s->normal + 3 * i, *m = s->normal + 3 * j;
			bool alike = n[0] * m[0] + n[1] * m[1] + n[2] * m[2] > 0.9f;
			if (!alike || distance_between(s->position + 3 * i, s->position + 3 * j) > 0.06)
				continue;
			double step = radiance[i] - radiance[j];
			sum->square[tile[i] != tile[j]] += step * step;
			sum->count[tile[i] != tile[j]] += 1.0;
		}
}

/* A box with a lamp in it: the light is that of a bake of all points, within
 * what the two state; and where tiles meet, two estimates of the same light do, which differ by no
 * more than either states. */
static void a_room_has_no_seams(void **state)
{
	(void)state;
	scene s = { 0 };
	tiled t;
	gw_report report;
	scene_add_box(&s, (double[3]){ 0, 0, 0 }, (double[3]){ 1, 1, 1 }, 32, 0.6f);
	form(&t, &s, 0.12, s.count, 6);
	gw_bake_options options = gw_bake_options_default();
	gw_bake_result *whole = bake(&t.all, &options);
	double *radiance = light_all(&t, &options, &report), square = 0.0, mean = 0.0, count = 0.0;
	uint32_t *tile = tiles_of(&t);
	steps sum = { { 0 }, { 0 } };
	for (size_t i = 0; i < s.count; i++) {
		double truth = gw_luminance(whole->radiance + 3 * i);
		square += (radiance[i] - truth) * (radiance[i] - truth);
		mean += truth;
		count += 1.0;
	}
	add_steps(&s, tile, radiance, &sum);
	mean /= count;
	double off = sqrt(square / count) / mean;
	double within = sqrt(sum.square[0] / sum.count[0]) / mean;
	double across = sqrt(sum.square[1] / sum.count[1]) / mean;
	print_message("off %.4f; stated %.4f and %.4f; steps %.4f within, %.4f across\n", off,
				  report.error.relative_rms, whole->report.error.relative_rms, within, across);
	assert_true(off <= hypot(report.error.relative_rms, whole->report.error.relative_rms));
	assert_true(across <= hypot(within, report.error.relative_rms));
	assert_true(sum.count[1] > 100.0);
	free(tile);
	free(radiance);
	gw_bake_result_destroy(&whole);
	clear(&t);
	scene_clear(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(halos_are_what_is_around), cmocka_unit_test(a_cube_is_not_cut),
		cmocka_unit_test(tiles_are_filled),         cmocka_unit_test(a_furnace_has_no_tiles),
		cmocka_unit_test(a_room_has_no_seams),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

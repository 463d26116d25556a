/* What lies beyond a tile is taken together with distance, and sends the tile the same light. */
#include "bake/far_points.h"
#include "base/hash.h"
#include "expected.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* A floor of points a metre apart, of which the tile has a corner, and its halo some more. */
#define SIDE 80
#define COUNT ((size_t)SIDE * SIDE)
#define TILE 4
#define NEAR 12

typedef struct floor_scene {
	double position[3 * COUNT];
	float normal[3 * COUNT], albedo[3 * COUNT], emission[3 * COUNT];
	float direct[3 * COUNT], indirect[3 * COUNT];
	uint32_t replaced[COUNT];
	uint8_t core[COUNT];
	gw_points kept, near;
	gw_bake_result light;
	gw_tile tile;
	gw_bake_options options;
} floor_scene;

static float random_number(uint64_t seed, size_t i)
{
	return (float)(gw_hash(seed, &i, sizeof i) % 1000) / 1000.0f;
}

static void place(floor_scene *s, size_t i)
{
	size_t x = i % SIDE, y = i / SIDE;
	s->position[3 * i] = (double)x + 0.5;
	s->position[3 * i + 1] = (double)y + 0.5;
	s->normal[3 * i + 2] = 1.0f;
	for (size_t c = 0; c < 3; c++) {
		s->albedo[3 * i + c] = 0.1f + 0.8f * random_number(c, i);
		s->direct[3 * i + c] = random_number(3 + c, i);
		s->indirect[3 * i + c] = random_number(6 + c, i);
	}
	if (x < NEAR && y < NEAR)
		s->replaced[s->tile.replaced_count++] = (uint32_t)i;
}

static floor_scene *make_floor(void)
{
	floor_scene *s = calloc(1, sizeof *s);
	assert_non_null(s);
	for (size_t i = 0; i < COUNT; i++)
		place(s, i);
	/* The first points of the first rows are the tile. */
	for (size_t i = 0; i < COUNT; i++)
		s->core[i] = i % SIDE < TILE && i / SIDE < TILE;
	s->kept = (gw_points){
		.count = COUNT, .position = s->position, .normal = s->normal, .albedo = s->albedo
	};
	s->near = s->kept;
	s->near.count = (size_t)NEAR * SIDE;
	s->light.count = COUNT;
	s->light.normal = s->normal;
	s->light.albedo = s->albedo;
	s->light.direct_irradiance = s->direct;
	s->light.indirect_irradiance = s->indirect;
	s->light.report.spacing = 1.0;
	s->options = gw_bake_options_default();
	s->tile.near = &s->near;
	s->tile.core = s->core;
	s->tile.kept = &s->kept;
	s->tile.light = &s->light;
	s->tile.replaced = s->replaced;
	return s;
}

static gw_far_points far_of(floor_scene *s, const gw_light *light, size_t lights)
{
	gw_far_points far;
	gw_error error = { 0 };
	const gw_tile_lighting lighting = { light, lights, &s->options, NULL, NULL };
	assert_ok(gw_far_points_make(&s->tile, &lighting, &far, &error), &error);
	return far;
}

/* From the box of the tile's points. */
static double distance_of(const floor_scene *s, size_t i)
{
	double x = fmax(s->position[3 * i] - (TILE - 0.5), 0.0);
	double y = fmax(s->position[3 * i + 1] - (TILE - 0.5), 0.0);
	return hypot(x, y);
}

/* Cubes of 2^k metres begin 16 * 2^k metres away, the first ones of two. */
static int level_of(const floor_scene *s, size_t i)
{
	return (int)floor(log2(fmax(distance_of(s, i) / 16.0, 1.0)));
}

static bool is_near(const floor_scene *s, size_t i)
{
	return s->position[3 * i] < NEAR && s->position[3 * i + 1] < NEAR;
}

/* Of the grid's points 4^k are in each cube of level k that no border of levels cuts: those are
 * some 4 % of the points of a level, of which each cut cube has one more at most. */
static void farther_is_coarser(void **state)
{
	(void)state;
	floor_scene *s = make_floor();
	gw_far_points far = far_of(s, NULL, 0);
	double due = 0.0, alone = 0.0, found = 0.0;
	for (size_t i = 0; i < COUNT; i++) {
		if (is_near(s, i))
			continue;
		due += ldexp(1.0, -2 * level_of(s, i));
		alone += level_of(s, i) == 0;
	}
	for (size_t k = 0; k < far.subset.points.count; k++) {
		assert_false(is_near(s, far.subset.from[k]));
		found += distance_of(s, far.subset.from[k]) < 32.0;
	}
	print_message("%zu of %zu, %.0f due\n", far.subset.points.count, COUNT, due);
	assert_true(found == alone);
	assert_true((double)far.subset.points.count >= due - 0.5);
	assert_true((double)far.subset.points.count < 1.1 * due);
	gw_far_points_clear(&far);
	free(s);
}

/* Points that a point stands for: those of its level in its cube. */
static double points_of(const floor_scene *s, size_t point)
{
	double width = ldexp(1.0, level_of(s, point)), points = 0.0;
	for (size_t i = 0; i < COUNT; i++) {
		const double *a = s->position + 3 * i, *b = s->position + 3 * point;
		points += !is_near(s, i) && level_of(s, i) == level_of(s, point) &&
				  floor(a[0] / width) == floor(b[0] / width) &&
				  floor(a[1] / width) == floor(b[1] / width);
	}
	return points;
}

/* What all reflect together is what those that are left stand for: sums of 19,000 numbers below 2,
 * of which each is right to 24 bits. */
static void the_light_is_the_same(void **state)
{
	(void)state;
	floor_scene *s = make_floor();
	gw_far_points far = far_of(s, NULL, 0);
	double sent = 0.0, received = 0.0;
	for (size_t i = 0; i < 3 * COUNT; i++)
		sent += is_near(s, i / 3) ? 0.0
								  : (double)s->albedo[i] * (double)(s->direct[i] + s->indirect[i]);
	for (size_t i = 0; i < 3 * far.subset.points.count; i++)
		received += points_of(s, far.subset.from[i / 3]) * (double)far.subset.albedo[i] *
					(double)far.all[i];
	assert_true(fabs(received / sent - 1.0) < 1e-6);
	gw_far_points_clear(&far);
	free(s);
}

/* How many of those points are left that a condition holds for, of how many. */
static void assert_all_left(const floor_scene *s, const gw_far_points *far,
							bool (*asked)(const floor_scene *s, size_t i))
{
	size_t wanted = 0, left = 0;
	for (size_t i = 0; i < COUNT; i++)
		wanted += !is_near(s, i) && asked(s, i);
	for (size_t k = 0; k < far->subset.points.count; k++)
		left += asked(s, far->subset.from[k]);
	assert_true(wanted > 0);
	assert_int_equal(left, wanted);
}

/* Between the tile and a lamp at the far corner. */
static bool is_on_diagonal(const floor_scene *s, size_t i)
{
	(void)s;
	return i % SIDE == i / SIDE && i % SIDE < 64;
}

static bool is_in_first_rows(const floor_scene *s, size_t i)
{
	(void)s;
	return i / SIDE < TILE;
}

static void what_shades_stays(void **state)
{
	(void)state;
	floor_scene *s = make_floor();
	const gw_light lamp = { .type = GW_LIGHT_POINT, .position = { 75.0, 75.0, 1.0 } };
	const gw_light sun = { .type = GW_LIGHT_SUN, .direction = { -1.0, 0.0, -0.01 } };
	gw_far_points plain = far_of(s, NULL, 0), far = far_of(s, &lamp, 1);
	assert_all_left(s, &far, is_on_diagonal);
	assert_true(far.subset.points.count < plain.subset.points.count + COUNT / 4);
	gw_far_points_clear(&far);
	far = far_of(s, &sun, 1);
	assert_all_left(s, &far, is_in_first_rows);
	assert_true(far.subset.points.count < plain.subset.points.count + COUNT / 4);
	gw_far_points_clear(&far);
	gw_far_points_clear(&plain);
	free(s);
}

static bool is_lamp(const floor_scene *s, size_t i)
{
	return s->emission[3 * i] > 0.0f;
}

/* Lamps that are made of points stay as they are; where everything glows it is taken together. */
static void few_that_glow_stay(void **state)
{
	(void)state;
	floor_scene *s = make_floor();
	gw_far_points plain = far_of(s, NULL, 0);
	s->kept.emission = s->emission;
	s->light.rest = s->indirect;
	for (size_t i = 60; i < 70; i++)
		s->emission[3 * (i * SIDE + i)] = s->emission[3 * (i * SIDE + i + 1)] = 5.0f;
	gw_far_points far = far_of(s, NULL, 0);
	assert_all_left(s, &far, is_lamp);
	assert_non_null(far.rest);
	gw_far_points_clear(&far);
	for (size_t i = 0; i < 3 * COUNT; i++)
		s->emission[i] = 1.0f;
	far = far_of(s, NULL, 0);
	assert_int_equal(far.subset.points.count, plain.subset.points.count);
	assert_true(far.subset.emission[3 * (far.subset.points.count - 1)] == 1.0f);
	gw_far_points_clear(&far);
	gw_far_points_clear(&plain);
	free(s);
}

/* One point whose albedo is no number takes nothing from those that it is taken together with. */
static void numbers_stay(void **state)
{
	(void)state;
	floor_scene *s = make_floor();
	float lost = s->albedo[3 * (COUNT - 1)];
	gw_far_points whole = far_of(s, NULL, 0);
	s->albedo[3 * (COUNT - 1)] = NAN;
	s->light.albedo = calloc(3 * COUNT, sizeof *s->light.albedo);
	assert_non_null(s->light.albedo);
	memcpy(s->light.albedo, s->albedo, 3 * COUNT * sizeof *s->albedo);
	s->light.albedo[3 * (COUNT - 1)] = lost; /* as a bake repairs it */
	gw_far_points far = far_of(s, NULL, 0);
	assert_int_equal(far.subset.points.count, whole.subset.points.count);
	for (size_t i = 0; i < 3 * far.subset.points.count; i++) {
		assert_true(far.subset.albedo[i] >= 0.0f && far.subset.albedo[i] < 1.0f);
		assert_true(far.all[i] == whole.all[i]);
	}
	gw_far_points_clear(&far);
	gw_far_points_clear(&whole);
	free(s->light.albedo);
	free(s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(farther_is_coarser), cmocka_unit_test(the_light_is_the_same),
		cmocka_unit_test(what_shades_stays),  cmocka_unit_test(few_that_glow_stay),
		cmocka_unit_test(numbers_stay),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

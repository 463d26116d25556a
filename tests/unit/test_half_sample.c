/* Half of a cloud: which points it takes, and what its light says of the whole. */
#include "bake/half_sample.h"
#include "expected.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define COUNT 4000
#define COLUMNS 31
#define ROWS 40

static double position[3 * COUNT];
static float albedo[3 * COUNT];

static gw_points cloud(void)
{
	uint64_t state = 1;
	for (size_t i = 0; i < 3 * (size_t)COUNT; i++) {
		state = state * 6364136223846793005u + 1442695040888963407u;
		position[i] = (double)(state >> 40) * 0x1p-20;
		albedo[i] = (float)i;
	}
	return (gw_points){ .count = COUNT, .position = position, .albedo = albedo };
}

static void make(const gw_points *points, uint32_t level, gw_point_subset *half)
{
	gw_error error;
	assert_ok(gw_half_sample_make(points, level, half, &error), &error);
}

static gw_half_difference difference(const gw_point_subset *half, const gw_bake_result *of_half,
									 const gw_bake_result *of_all)
{
	gw_half_difference d = { 0 };
	gw_error error;
	assert_ok(gw_half_sample_difference(half, of_half, of_all, &d, &error), &error);
	return d;
}

/* About half, each with all that is its own, and half of these again. */
static void takes_half_and_half_of_it(void **state)
{
	(void)state;
	gw_points points = cloud();
	gw_point_subset half, quarter;
	make(&points, 0, &half);
	make(&half.points, 1, &quarter);
	assert_in_range(half.points.count, 9 * COUNT / 20, 11 * COUNT / 20);
	assert_in_range(quarter.points.count, COUNT / 5, 3 * COUNT / 10);
	for (size_t i = 0; i < half.points.count; i++) {
		size_t from = half.from[i];
		assert_memory_equal(half.points.position + 3 * i, position + 3 * from, 3 * sizeof(double));
		assert_memory_equal(half.points.albedo + 3 * i, albedo + 3 * from, 3 * sizeof(float));
		assert_true(i == 0 || from > half.from[i - 1]);
	}
	assert_null(half.points.normal);
	gw_point_subset_clear(&quarter);
	gw_point_subset_clear(&half);
}

/* Which points are taken goes by where they are, not by their order. */
static void does_not_care_for_the_order(void **state)
{
	(void)state;
	gw_points points = cloud();
	gw_point_subset half, other;
	double *turned = malloc(sizeof position);
	assert_non_null(turned);
	for (size_t i = 0; i < COUNT; i++)
		memcpy(turned + 3 * i, position + 3 * (COUNT - 1 - i), 3 * sizeof *turned);
	make(&points, 0, &half);
	points.position = turned;
	make(&points, 0, &other);
	assert_int_equal(half.points.count, other.points.count);
	for (size_t i = 0; i < half.points.count; i++)
		assert_int_equal(half.from[i], COUNT - 1 - other.from[half.points.count - 1 - i]);
	gw_point_subset_clear(&other);
	gw_point_subset_clear(&half);
	free(turned);
}

/* Rows and columns stay such: two images with some cells empty, and points of none between them. */
static void leaves_every_other_column(void **state)
{
	(void)state;
	gw_points points = cloud();
	uint32_t *cell = calloc(COUNT, sizeof *cell);
	const gw_range_image image[2] = { { 100, 900, COLUMNS, ROWS, { 1, 2, 3 } },
									  { 1500, 1000, COLUMNS + 1, ROWS, { 4, 5, 6 } } };
	gw_point_subset half;
	assert_non_null(cell);
	for (size_t k = 0; k < 2; k++)
		for (size_t i = 0; i < image[k].count; i++)
			cell[image[k].first + i] = (uint32_t)i;
	points.image = image;
	points.image_count = 2;
	points.image_cell = cell;
	make(&points, 0, &half);
	for (size_t k = 0; k < 2; k++) {
		const gw_range_image *left = &half.points.image[k];
		assert_int_equal(left->columns, 16);
		assert_int_equal(left->rows, ROWS);
		for (size_t i = left->first; i < left->first + left->count; i++) {
			uint32_t from = cell[half.from[i]], to = half.points.image_cell[i];
			assert_in_range(half.from[i], image[k].first, image[k].first + image[k].count - 1);
			assert_int_equal(to / left->columns, from / image[k].columns);
			assert_int_equal(2 * (to % left->columns), from % image[k].columns);
		}
	}
	assert_int_equal(half.points.image[1].count, 500); /* 31 rows of 16 and 4 */
	gw_point_subset_clear(&half);
	free(cell);
}

/* Of what differs: emitters and strays do not count. */
static void compares_what_is_lit(void **state)
{
	(void)state;
	gw_points points = cloud();
	gw_point_subset half;
	make(&points, 0, &half);
	size_t count = half.points.count;
	gw_bake_result all = { .count = COUNT, .radiance = calloc(3 * COUNT, sizeof(float)) };
	gw_bake_result of_half = { .count = count, .radiance = calloc(3 * count, sizeof(float)) };
	all.stray = calloc(COUNT, 1);
	assert_true(all.radiance && of_half.radiance && all.stray);
	for (size_t i = 0; i < 3 * (size_t)COUNT; i++)
		all.radiance[i] = 2.0f;
	for (size_t i = 0; i < 3 * count; i++)
		of_half.radiance[i] = i / 3 % 2 ? 2.5f : 1.5f;
	all.stray[half.from[7]] = 1;
	of_half.radiance[3 * 7] = 1e6f;
	gw_half_difference d = difference(&half, &of_half, &all);
	assert_float_equal(d.rest, 0.25, 1e-6);
	assert_float_equal(d.turned, 0.0, 1e-12);
	/* Those of a quarter of the half show the other side there. */
	all.normal = calloc(3 * COUNT, sizeof(float));
	of_half.normal = calloc(3 * count, sizeof(float));
	assert_true(all.normal && of_half.normal);
	for (size_t i = 0; i < COUNT; i++)
		all.normal[3 * i + 2] = 1.0f;
	for (size_t i = 0; i < count; i++)
		of_half.normal[3 * i + 2] = i % 4 == 0 ? -1.0f : 1.0f;
	d = difference(&half, &of_half, &all);
	assert_float_equal(d.turned, 0.125, 1e-3);
	assert_float_equal(gw_half_difference_all(&d), 0.25, 1e-6);
	/* Light that only the half lets in counts as much as all that it has. */
	for (size_t i = 0; i < 3 * count; i++)
		of_half.radiance[i] = 200.0f;
	d = difference(&half, &of_half, &all);
	assert_float_equal(gw_half_difference_all(&d), 0.99, 1e-6);
	free(all.normal);
	free(of_half.normal);
	free(all.radiance);
	free(all.stray);
	free(of_half.radiance);
	gw_point_subset_clear(&half);
}

/* A row of points 1 m apart, the first of which is nowhere and the next 40 turn, with records 5 m
 * apart: the light of the next five comes from the same ones. */
static void beside_what_turns_is_known(void **state)
{
	(void)state;
	enum { ROW = 401, TURNED = 41 };
	double *at = calloc(3 * ROW, sizeof *at);
	float *up = calloc(3 * ROW, sizeof *up), *other = calloc(3 * ROW, sizeof *other);
	float *one = calloc(3 * ROW, sizeof *one), *two = calloc(3 * ROW, sizeof *two);
	size_t *from = calloc(ROW, sizeof *from);
	assert_true(at && up && other && one && two && from);
	for (size_t i = 0; i < ROW; i++) {
		from[i] = i;
		at[3 * i] = 4e6 + (double)i; /* as in a map's coordinates */
		up[3 * i + 2] = 1.0f;
		other[3 * i + 2] = i < TURNED ? -1.0f : 1.0f;
		for (size_t k = 0; k < 3; k++) {
			one[3 * i + k] = 1.0f;
			two[3 * i + k] = i < TURNED + 5 ? 0.0f : 1.0f;
		}
	}
	at[0] = NAN;
	const gw_point_subset half = { .points = { .count = ROW }, .position = at, .from = from };
	const gw_bake_result all = { .count = ROW, .radiance = one, .normal = up };
	gw_bake_result of_half = { .count = ROW, .radiance = two, .normal = other };
	of_half.report = (gw_report){ .records = 100, .record_spacing = 2.5f, .leaf_size = 2.0 };
	of_half.report.error = (gw_error_estimate){ .points = 64, .sides = 0.3 };
	gw_half_difference d = difference(&half, &of_half, &all);
	assert_float_equal(d.turned, sqrt(0.1), 1e-6);
	assert_float_equal(d.near, sqrt(5.0 / 400.0), 1e-6);
	assert_float_equal(d.rest, 0.0, 1e-12);
	assert_float_equal(d.turned_share, 0.1, 1e-12);
	assert_true(d.sides_asked && d.sides == 0.3);
	/* What all others differ by, those beside differ by as well: only the rest of it is theirs. */
	for (size_t i = 3 * (TURNED + 5); i < 3 * (size_t)ROW; i++)
		two[i] = 0.5f;
	d = difference(&half, &of_half, &all);
	assert_float_equal(d.near, sqrt(5.0 * (1.0 - 0.25) / 400.0), 1e-6);
	assert_float_equal(d.rest, sqrt(0.25 * 360.0 / 400.0), 1e-6);
	assert_float_equal(gw_half_difference_all(&d), sqrt((45.0 + 0.25 * 355.0) / 400.0), 1e-6);
	for (size_t i = 3 * (TURNED + 5); i < 3 * (size_t)ROW; i++)
		two[i] = 1.0f;
	of_half.report = (gw_report){ .records = 0 }; /* lamps alone: each point has its own light */
	d = difference(&half, &of_half, &all);
	assert_float_equal(d.near, 0.0, 1e-12);
	assert_float_equal(d.rest, sqrt(5.0 / 400.0), 1e-6);
	assert_false(d.sides_asked);
	free(at), free(up), free(other), free(one), free(two), free(from);
}

static gw_error_estimate added(double first, double second, double gathered, double stated)
{
	gw_error_estimate e = { .relative_rms = stated, .gathered = gathered };
	gw_half_sample_add(&(gw_half_difference){ .rest = first },
					   &(gw_half_difference){ .rest = second }, gathered, &e);
	return e;
}

static double of_turned(double first, double second)
{
	gw_error_estimate e = { 0 };
	gw_half_sample_add(&(gw_half_difference){ .turned = first },
					   &(gw_half_difference){ .turned = second }, 0.0, &e);
	return e.halves;
}

/* Both guess: of as many wrong sides in both half is that of all, of more in fewer points less. */
static void sides_are_wrong_in_both(void **state)
{
	(void)state;
	assert_float_equal(of_turned(0.1, 0.0), 0.0707106781, 1e-7);
	assert_float_equal(of_turned(0.1, 0.05), 0.0707106781, 1e-7);
	assert_float_equal(of_turned(0.1, 0.2), 0.0447213595, 1e-7);
}

/* What rays say of sides comes on top of the rest, unless halves say more of them: 3, 4 and 5. */
static void sides_guessed_alike_are_known_by_rays(void **state)
{
	(void)state;
	const gw_half_difference first = { .rest = 0.03, .turned = 0.04 * M_SQRT2 }, second = { 0 };
	gw_error_estimate alike = { .relative_rms = 0.041, .sides = 0.04 };
	gw_half_sample_add(&(gw_half_difference){ .rest = 0.03 }, &second, 0.0, &alike);
	assert_float_equal(alike.halves, 0.03, 1e-12);
	assert_float_equal(alike.relative_rms, 0.05, 1e-12);
	gw_error_estimate other = { .relative_rms = 0.02, .sides = 0.01 };
	gw_half_sample_add(&first, &second, 0.0, &other);
	assert_float_equal(other.relative_rms, 0.05, 1e-12);
}

/* Rays find three times as much wrong with the half's sides: a tenth of the square difference is
 * that of all points, also beside what turns. Where few points turn rays may have missed
 * them, which makes the two less unlike. */
static void sides_are_worse_in_the_half(void **state)
{
	(void)state;
	const gw_half_difference none = { 0 };
	const double huge = 1e9; /* of the points: none is missed */
	gw_half_difference first = { .turned = 0.1, .turned_share = huge, .sides_asked = true };
	gw_error_estimate e = { .sides = 0.02 };
	first.sides = 0.06;
	gw_half_sample_add(&first, &none, 0.0, &e);
	assert_float_equal(e.halves, 0.0316227766, 1e-9);
	first.turned = 0.0;
	first.near = 0.1;
	e = (gw_error_estimate){ .sides = 0.02 };
	gw_half_sample_add(&first, &none, 0.0, &e);
	assert_float_equal(e.halves, 0.0316227766, 1e-9);
	first = (gw_half_difference){ .turned = 0.1, .turned_share = 2.0 / 384.0, .sides_asked = true };
	first.sides = 0.1; /* (0.01 + u) / u = 3, with u = 0.005 */
	e = (gw_error_estimate){ .sides = 0.0 };
	gw_half_sample_add(&first, &none, 0.0, &e);
	assert_float_equal(e.halves, 0.05, 1e-9);
	first.sides_asked = false;
	e = (gw_error_estimate){ .sides = 0.0 };
	gw_half_sample_add(&first, &none, 0.0, &e);
	assert_float_equal(e.halves, 0.0707106781, 1e-8);
}

/* Errors that fall as 1 / sqrt(n) show as they are, those that fall as 1 / n by more. */
static void says_how_wrong_all_points_are(void **state)
{
	(void)state;
	assert_float_equal(added(0.1, 0.0, 0.0, 0.02).halves, 0.1, 1e-12);
	assert_float_equal(added(0.1, 0.1, 0.0, 0.02).relative_rms, 0.1, 1e-12);
	assert_float_equal(added(0.1, 0.14142, 0.0, 0.02).halves, 0.1, 1e-9);
	assert_float_equal(added(0.1, 0.2, 0.0, 0.02).halves, 0.0577350269, 1e-9);
	/* What else is known is no less. */
	assert_float_equal(added(0.1, 0.2, 0.0, 0.5).relative_rms, 0.5, 1e-12);
	/* Noise of both bakes is no fault of the surface. */
	assert_float_equal(added(0.05, 0.0, 0.03, 0.03).halves, 0.0264575131, 1e-9);
	assert_float_equal(added(0.04, 0.0, 0.03, 0.03).relative_rms, 0.03, 1e-12);
}

/* Where normals are given and nothing strays, half is asked for only of points that are much
 * further apart in some places than in others, as far off a scanner; and never where no error is.
 */
static void uneven_points_are_doubted(void **state)
{
	(void)state;
	float normal[3] = { 0 };
	gw_points points = cloud();
	points.normal = normal;
	gw_bake_options options = gw_bake_options_default();
	gw_report report = { .spacing_ratio = 1.3 };
	assert_false(gw_half_sample_is_wanted(&points, &options, &report));
	report.spacing_ratio = 6.0;
	assert_true(gw_half_sample_is_wanted(&points, &options, &report));
	report = (gw_report){ .spacing_ratio = 1.3, .narrow_share = 0.01 };
	assert_false(gw_half_sample_is_wanted(&points, &options, &report));
	report.narrow_share = 0.05;
	assert_false(gw_half_sample_is_wanted(&points, &options, &report)); /* of few, rims are many */
	points.count = 10 * COUNT;
	assert_true(gw_half_sample_is_wanted(&points, &options, &report));
	options.estimate_points = 0;
	assert_false(gw_half_sample_is_wanted(&points, &options, &report));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(takes_half_and_half_of_it),
		cmocka_unit_test(does_not_care_for_the_order),
		cmocka_unit_test(leaves_every_other_column),
		cmocka_unit_test(compares_what_is_lit),
		cmocka_unit_test(beside_what_turns_is_known),
		cmocka_unit_test(sides_are_wrong_in_both),
		cmocka_unit_test(sides_are_worse_in_the_half),
		cmocka_unit_test(sides_guessed_alike_are_known_by_rays),
		cmocka_unit_test(says_how_wrong_all_points_are),
		cmocka_unit_test(uneven_points_are_doubted),
	};
	return cmocka_run_group_tests_name("half_sample", tests, NULL, NULL);
}

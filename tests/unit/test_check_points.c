/* Which points are solved again, and how much each of them counts. */
#include "estimate/error_estimate.h"
#include "estimate/check_point_choice.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define POINTS 20000u
#define DRAWS 500u
#define SEEDS 200u

/* Square errors as bakes have them: small ones everywhere, and one point in a hundred that is off
 * by thirty times as much; and a prediction that knows half of those, and is wrong by up to a
 * factor of four everywhere. */
typedef struct field {
	bool counts[POINTS];
	double square[POINTS], predicted[POINTS], mean;
} field;

static void make_field(field *f)
{
	size_t counted = 0;
	double sum = 0.0;
	srand(7);
	for (size_t i = 0; i < POINTS; i++) {
		bool large = rand() % 100 == 17, known = rand() % 2 == 0;
		double off = (large ? 30.0 : 1.0) * (double)(rand() % 1000 + 1) / 1000.0;
		f->counts[i] = i % 7 != 3;
		f->square[i] = off * off;
		f->predicted[i] =
			(known || !large ? off * off : 0.3) * pow(4.0, (double)(rand() % 2001 - 1000) / 1000.0);
		sum += f->counts[i] ? f->square[i] : 0.0;
		counted += f->counts[i];
	}
	f->mean = sum / (double)counted;
}

static gw_check_point_mean average(const field *f, const gw_check_point_choice *c)
{
	double *value = malloc(c->count * sizeof *value);
	assert_non_null(value);
	for (uint32_t i = 0; i < c->count; i++)
		value[i] = f->square[c->point[i]];
	gw_check_point_mean mean = gw_check_point_average(c, value);
	free(value);
	return mean;
}

typedef struct trials {
	double mean, variance,
		said; /* of the estimates; what they said of their variance, on average */
} trials;

static trials try_seeds(const field *f, size_t parts)
{
	const double *const part[1] = { f->predicted };
	double sum = 0.0, square = 0.0, said = 0.0;
	for (uint64_t seed = 1; seed <= SEEDS; seed++) {
		gw_check_point_choice c;
		gw_error error;
		assert_int_equal(
			gw_check_point_choose(&(gw_check_point_shares){ POINTS, f->counts, part, parts, NULL },
								  DRAWS, seed, &c, &error),
			GW_OK);
		assert_int_equal(c.count, DRAWS);
		for (uint32_t i = 0; i < c.count; i++)
			assert_true(f->counts[c.point[i]] && (i == 0 || c.point[i] > c.point[i - 1]));
		gw_check_point_mean found = average(f, &c);
		sum += found.mean;
		square += found.mean * found.mean;
		said += found.variance;
		gw_check_point_choice_clear(&c);
	}
	double mean = sum / SEEDS;
	return (trials){ mean, (square / SEEDS - mean * mean) * SEEDS / (SEEDS - 1.0), said / SEEDS };
}

/* Over many draws the mean is that of the field, within four standard errors of a mean of so many
 * (one in 16,000 would fail; the seeds are fixed), for any shares; and shares that know where
 * errors are make it far steadier. */
static void weighted_mean_is_right(void **state)
{
	(void)state;
	field *f = malloc(sizeof *f);
	assert_non_null(f);
	make_field(f);
	trials even = try_seeds(f, 0), mixed = try_seeds(f, 1);
	assert_true(fabs(even.mean - f->mean) < 4.0 * sqrt(even.variance / SEEDS));
	assert_true(fabs(mixed.mean - f->mean) < 4.0 * sqrt(mixed.variance / SEEDS));
	/* Half of the large ones are unknown, and drawn half as often as before, so that nothing is
	 * won; it is as soon as they are known to be larger than what is small. */
	for (size_t i = 0; i < POINTS; i++)
		f->predicted[i] = fmax(f->predicted[i], 0.06 * f->square[i]);
	mixed = try_seeds(f, 1);
	assert_true(fabs(mixed.mean - f->mean) < 4.0 * sqrt(mixed.variance / SEEDS));
	assert_true(mixed.variance < 0.4 * even.variance);
	/* What it says of its own variance is as if each draw were from all points: draws that are
	 * spread evenly, of which some are certain, are steadier, here by up to 1.6 times. A variance
	 * of 200 trials is known to 10 % and, with the tail of this field, twice that. */
	assert_true(even.said > 0.8 * even.variance && even.said < 3.2 * even.variance);
	assert_true(mixed.said > 0.8 * mixed.variance && mixed.said < 3.2 * mixed.variance);
	free(f);
}

/* Values in proportion to the probabilities have no variance at all: with the even third, values
 * 1 + c x of a part that is x on average 1. */
static void known_errors_need_no_luck(void **state)
{
	(void)state;
	enum { COUNT = 3000 };
	bool counts[COUNT];
	double x[COUNT], value[100];
	for (size_t i = 0; i < COUNT; i++) {
		counts[i] = true;
		x[i] = i % 3 == 0 ? 2.0 : 0.5; /* on average 1 */
	}
	gw_check_point_choice c;
	gw_error error;
	assert_int_equal(
		gw_check_point_choose(
			&(gw_check_point_shares){ COUNT, counts, (const double *const[]){ x }, 1, NULL }, 100,
			5, &c, &error),
		GW_OK);
	for (uint32_t i = 0; i < c.count; i++)
		value[i] = 1.0 + x[c.point[i]];
	gw_check_point_mean found = gw_check_point_average(&c, value);
	/* Sums of 3000 doubles. */
	assert_true(fabs(found.mean - 2.0) < 1e-10 && found.variance < 1e-18);
	gw_check_point_choice_clear(&c);
}

static void few_points_are_all_taken(void **state)
{
	(void)state;
	const bool counts[5] = { true, false, true, true, false };
	const double part[5] = { 0.0, 9.0, 1.0, 5.0, 1.0 };
	gw_check_point_choice c;
	gw_error error;
	assert_int_equal(
		gw_check_point_choose(
			&(gw_check_point_shares){ 5, counts, (const double *const[]){ part }, 1, NULL }, 3, 1,
			&c, &error),
		GW_OK);
	assert_int_equal(c.count, 3);
	assert_true(c.point[0] == 0 && c.point[1] == 2 && c.point[2] == 3);
	assert_true(c.weight[0] == 1.0 / 3.0 && c.weight[2] == 1.0 / 3.0);
	gw_check_point_choice_clear(&c);
	assert_int_equal(gw_check_point_choose(
						 &(gw_check_point_shares){ 5, (const bool[5]){ false }, NULL, 0, NULL }, 3,
						 1, &c, &error),
					 GW_OK);
	assert_int_equal(c.count, 0);
	gw_check_point_choice_clear(&c);
}

/* One point that holds nearly all of a part is not drawn again and again. */
static void one_point_is_not_all(void **state)
{
	(void)state;
	enum { COUNT = 5000 };
	static bool counts[COUNT];
	static double part[COUNT];
	uint32_t times = 0;
	for (size_t i = 0; i < COUNT; i++) {
		counts[i] = true;
		part[i] = i == 1234 ? 1e9 : 1.0;
	}
	gw_check_point_choice c;
	gw_error error;
	assert_int_equal(
		gw_check_point_choose(
			&(gw_check_point_shares){ COUNT, counts, (const double *const[]){ part }, 1, NULL },
			200, 3, &c, &error),
		GW_OK);
	for (uint32_t i = 0; i < c.count; i++)
		times += c.point[i] == 1234;
	assert_true(times <= 1);
	gw_check_point_choice_clear(&c);
}

/* A part of fewer points than draws: none of them counts for more than one draw, so that each is
 * drawn with a probability of at least 1 / (1 + few / draws), and counts by its inverse. What draws
 * they can't take are the others': the mean of a value that is 1 everywhere is 1, as both draw
 * evenly, but for one or two that rounding takes, of hundreds. */
static void few_points_leave_the_rest(void **state)
{
	(void)state;
	enum { COUNT = 100000, WANTED = 768 };
	static bool counts[COUNT];
	static double part[COUNT];
	memset(counts, true, sizeof counts);
	for (size_t few = 1; few <= 100; few *= 10) {
		double sum = 0.0, most = 1.0 + (double)few / WANTED;
		size_t drawn = 0;
		for (size_t i = 0; i < few; i++)
			part[COUNT / 2 + 17 * i] = 0.5 + (double)i;
		gw_check_point_choice c;
		gw_error error;
		const gw_check_point_shares shares = { COUNT, counts, (const double *const[]){ part }, 1,
											   NULL };
		assert_int_equal(gw_check_point_choose(&shares, WANTED, 9, &c, &error), GW_OK);
		assert_int_equal(c.count, WANTED);
		for (uint32_t i = 0; i < c.count; i++) {
			double points = c.weight[i] * COUNT;
			sum += c.weight[i];
			if (part[c.point[i]] > 0.0) {
				assert_true(points >= 1.0 && points <= most);
				drawn++;
			}
		}
		assert_true((double)drawn > (double)few / most - 2.0);
		assert_true(fabs(sum - 1.0) < 3.0 / (WANTED - 100));
		gw_check_point_choice_clear(&c);
	}
}

/* Where it may write over the first part, it draws the same. */
static void room_of_a_part_will_do(void **state)
{
	(void)state;
	field *f = malloc(sizeof *f);
	double *other = malloc(POINTS * sizeof *other);
	assert_true(f && other);
	make_field(f);
	for (size_t i = 0; i < POINTS; i++)
		other[i] = (double)(i % 13);
	for (size_t parts = 1; parts <= 2; parts++) {
		const double *const part[2] = { f->predicted, other };
		gw_check_point_choice apart, within;
		gw_error error;
		gw_check_point_shares from = { POINTS, f->counts, part, parts, NULL };
		assert_int_equal(gw_check_point_choose(&from, DRAWS, 3, &apart, &error), GW_OK);
		from.room = f->predicted;
		assert_int_equal(gw_check_point_choose(&from, DRAWS, 3, &within, &error), GW_OK);
		assert_int_equal(apart.count, within.count);
		assert_memory_equal(apart.point, within.point, apart.count * sizeof *apart.point);
		assert_memory_equal(apart.weight, within.weight, apart.count * sizeof *apart.weight);
		gw_check_point_choice_clear(&apart);
		gw_check_point_choice_clear(&within);
		make_field(f);
	}
	free(other);
	free(f);
}

/* A floor along x in Morton order, dark before its middle: light changes there and nowhere else. */
static void contrast_is_where_light_changes(void **state)
{
	(void)state;
	enum { COUNT = 1000 };
	static float position[3 * COUNT], normal[3 * COUNT], radius[COUNT], light[COUNT];
	static double contrast[COUNT], again[COUNT];
	for (size_t i = 0; i < COUNT; i++) {
		position[3 * i] = (float)i;
		normal[3 * i + 2] = 1.0f;
		radius[i] = 3.5f;
		light[i] = i < COUNT / 2 ? 1.0f : 3.0f;
	}
	const gw_surfels s = {
		.count = COUNT, .position = position, .normal = normal, .radius = radius
	};
	gw_check_point_contrast(&s, light, 1, contrast);
	gw_check_point_contrast(&s, light, 3, again);
	assert_memory_equal(contrast, again, sizeof contrast);
	for (size_t i = 0; i < COUNT; i++) {
		/* Of six neighbours so many are on the other side, at a difference of 2. */
		size_t away = i < COUNT / 2 ? COUNT / 2 - 1 - i : i - COUNT / 2;
		double others = away < 3 ? 3.0 - (double)away : 0.0;
		assert_true(fabs(contrast[i] - 4.0 * others / 6.0) < 1e-12);
	}
	/* Another surface is no neighbour. */
	for (size_t i = COUNT / 2; i < COUNT; i++) {
		normal[3 * i] = 1.0f;
		normal[3 * i + 2] = 0.0f;
	}
	gw_check_point_contrast(&s, light, 2, contrast);
	for (size_t i = 0; i < COUNT; i++)
		assert_true(contrast[i] == 0.0);
}

/* One for 20 records, within one and four times what is asked for. */
static void fine_bakes_draw_more(void **state)
{
	(void)state;
	assert_int_equal(gw_estimate_points(500, 6000), 500);
	assert_int_equal(gw_estimate_points(500, 30000), 1500);
	assert_int_equal(gw_estimate_points(500, 1000000), 2000);
	assert_int_equal(gw_estimate_points(0, 1000000), 0);
	assert_int_equal(gw_estimate_points(UINT32_MAX, UINT32_MAX), UINT32_MAX);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(weighted_mean_is_right),
		cmocka_unit_test(known_errors_need_no_luck),
		cmocka_unit_test(few_points_are_all_taken),
		cmocka_unit_test(one_point_is_not_all),
		cmocka_unit_test(few_points_leave_the_rest),
		cmocka_unit_test(room_of_a_part_will_do),
		cmocka_unit_test(contrast_is_where_light_changes),
		cmocka_unit_test(fine_bakes_draw_more),
	};
	return cmocka_run_group_tests_name("check points", tests, NULL, NULL);
}

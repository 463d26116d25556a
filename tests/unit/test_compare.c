/* Error figures against sums done by hand, matching of points, and the worst points. */
#include "glowworm_picture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* A dozen roundings of double behind one another. */
#define ROUNDING 0x1p-49

static void assert_near(double found, double expected)
{
	if (!(fabs(found - expected) <= ROUNDING * fmax(1.0, fabs(expected))))
		fail_msg("%.17g is not %.17g", found, expected);
}

/* Differences 0, 1, -1, 3 over a mean of 2. */
static void figures_by_hand(void **state)
{
	(void)state;
	const double truth[] = { 1, 1, 3, 3 }, found[] = { 1, 2, 2, 6 };
	gw_comparison c;
	assert_int_equal(gw_compare(found, truth, 4, &c, NULL), GW_OK);
	assert_int_equal(c.points, 4);
	assert_near(c.truth_mean, 2.0);
	assert_near(c.mean, 2.75);
	assert_near(c.rel_rmse, sqrt(11.0 / 4.0) / 2.0);
	assert_near(c.best_99, c.rel_rmse); /* a hundredth of 4 points is none */
	assert_near(c.bias, 0.375);
	assert_near(c.percentile_50, 0.5);
	assert_near(c.percentile_95, 1.5);
	assert_near(c.percentile_99, 1.5);
	assert_near(c.maximum, 1.5);
}

/* 200 points, of which two are off by 10 and the others by 0.1 to both sides. */
static void best_99_leaves_out_the_worst_hundredth(void **state)
{
	(void)state;
	double truth[200], found[200];
	for (size_t i = 0; i < 200; i++) {
		truth[i] = 1.0;
		found[i] = i == 7 || i == 130 ? 11.0 : i % 2 ? 1.125 : 0.875;
	}
	gw_comparison c;
	assert_int_equal(gw_compare(found, truth, 200, &c, NULL), GW_OK);
	assert_near(c.best_99, 0.125);
	assert_near(c.rel_rmse, sqrt((198.0 * 0.125 * 0.125 + 2.0 * 100.0) / 200.0));
	assert_near(c.percentile_99, 0.125);
	assert_near(c.maximum, 10.0);
}

/* Squares that overflow, a truth that is dark, sums that a plain loop would lose. */
static void figures_hold_in_extremes(void **state)
{
	(void)state;
	gw_comparison c;
	const double huge[] = { 1e200, 3e200 }, bright[] = { 2e200, 2e200 };
	assert_int_equal(gw_compare(bright, huge, 2, &c, NULL), GW_OK);
	assert_near(c.rel_rmse, 0.5);
	const double dark[] = { 0, 0 }, lit[] = { 0, 1 };
	assert_int_equal(gw_compare(lit, dark, 2, &c, NULL), GW_OK);
	assert_true(isinf(c.rel_rmse) && isinf(c.bias));
	assert_int_equal(gw_compare(dark, dark, 2, &c, NULL), GW_OK);
	assert_true(c.rel_rmse == 0.0 && c.bias == 0.0 && c.maximum == 0.0);
	const double large[] = { 1e16, 1, -1e16, 1 }, one[] = { 1, 1, 1, 1 };
	assert_int_equal(gw_compare(large, one, 4, &c, NULL), GW_OK);
	assert_near(c.mean, 0.5);
}

static void what_is_not_finite_is_refused(void **state)
{
	(void)state;
	gw_error error = { 0 };
	gw_comparison c;
	const double bad[] = { 1, NAN }, good[] = { 1, 1 }, endless[] = { INFINITY, 1 };
	assert_int_equal(gw_compare(bad, good, 2, &c, &error), GW_ERROR_DATA);
	assert_int_equal(gw_compare(good, bad, 2, &c, &error), GW_ERROR_DATA);
	assert_int_equal(gw_compare(endless, endless, 2, &c, &error), GW_ERROR_DATA);
	assert_int_equal(gw_compare(good, good, 0, &c, &error), GW_ERROR_DATA);
}

/* ---------------------------------------------------------------------------------- order */

static void any_order_becomes_one(void **state)
{
	(void)state;
	enum { COUNT = 5000 };
	static double key[3 * COUNT];
	static size_t order[COUNT];
	size_t count;
	for (size_t i = 0; i < COUNT; i++) {
		size_t j = i * 1999 % COUNT;
		/* A last digit of the double apart along x, few values along y: ties everywhere. */
		key[3 * i] = 500000.0 + (double)(j / 7) * 0x1p-34;
		key[3 * i + 1] = (double)(j % 7) * 0.1;
		key[3 * i + 2] = j % 2 == 0 ? 0.0 : -0.0;
	}
	assert_int_equal(gw_compare_order((gw_compare_keys){ key, COUNT }, 3, order, &count, NULL),
					 GW_OK);
	assert_int_equal(count, COUNT);
	for (size_t i = 0; i < COUNT; i++)
		assert_int_equal(order[i] * 1999 % COUNT, i);
}

static void equal_ones_stay_as_they_stood(void **state)
{
	(void)state;
	const double key[] = { 4, NAN, -0.0, 3, 0, 4, 1 };
	size_t order[7], count;
	assert_int_equal(gw_compare_order((gw_compare_keys){ key, 7 }, 1, order, &count, NULL), GW_OK);
	const size_t expected[] = { 2, 4, 6, 3, 0, 5 };
	assert_int_equal(count, 6);
	assert_memory_equal(order, expected, sizeof expected);
	assert_int_equal(gw_compare_order((gw_compare_keys){ key, 0 }, 1, order, &count, NULL), GW_OK);
	assert_int_equal(count, 0);
}

static void worst_come_first(void **state)
{
	(void)state;
	const double value[] = { 0.5, -3, 2, 3, 0 };
	size_t place[5];
	assert_int_equal(gw_compare_worst(value, 5, 3, place, NULL), GW_OK);
	assert_int_equal(place[0], 1);
	assert_int_equal(place[1], 3);
	assert_int_equal(place[2], 2);
	assert_int_equal(gw_compare_worst(value, 5, 99, place, NULL), GW_OK);
	assert_int_equal(place[4], 4);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(figures_by_hand),
		cmocka_unit_test(best_99_leaves_out_the_worst_hundredth),
		cmocka_unit_test(figures_hold_in_extremes),
		cmocka_unit_test(what_is_not_finite_is_refused),
		cmocka_unit_test(any_order_becomes_one),
		cmocka_unit_test(equal_ones_stay_as_they_stood),
		cmocka_unit_test(worst_come_first),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

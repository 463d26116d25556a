/*
 * Pages: the order of their points, and what is left of them when they are packed.
 */
#include "page/page_order.h"
#include "page/page_points.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { POINTS = 3000 };

/* Numbers in [0, 1), the same in every run. */
static double next(uint32_t *state)
{
	*state = *state * 1664525u + 1013904223u;
	return (double)(*state >> 8) * 0x1p-24;
}

/* Denser towards a corner, and each tenth point where the one before stands. */
static void make_places(float position[3 * POINTS])
{
	uint32_t state = 1;
	for (size_t i = 0; i < POINTS; i++)
		for (size_t k = 0; k < 3; k++)
			position[3 * i + k] = (float)(pow(next(&state), 3.0) * (k == 2 ? 0.1 : 4.0));
	for (size_t i = 10; i < POINTS; i += 10)
		memcpy(position + 3 * i, position + 3 * (i - 1), 3 * sizeof *position);
}

/* The cell of a point among 2^level along the longest side, as one number. */
static uint64_t cell_of(const float *place, const float least[3], double side, unsigned level)
{
	uint64_t cell = 0;
	for (size_t k = 0; k < 3; k++) {
		double at = ldexp(((double)place[k] - (double)least[k]) / side, PAGE_ORDER_LEVELS - 1);
		uint64_t finest = (uint64_t)fmin(at, ldexp(1.0, PAGE_ORDER_LEVELS - 1) - 1.0);
		cell = cell << 21 | finest >> (PAGE_ORDER_LEVELS - 1 - level);
	}
	return cell;
}

static int compare_cells(const void *a, const void *b)
{
	const uint64_t *one = a, *other = b;
	return *one < *other ? -1 : *one > *other;
}

/* How many cells the first points of an order stand in. */
static size_t count_cells(const float *position, const page_order *order, size_t count,
						  unsigned level)
{
	float least[3] = { HUGE_VALF, HUGE_VALF, HUGE_VALF };
	uint64_t *cell = reallocarray(NULL, count, sizeof *cell);
	size_t different = 0;
	for (size_t i = 0; i < POINTS; i++)
		for (size_t k = 0; k < 3; k++)
			least[k] = fminf(least[k], position[3 * i + k]);
	for (size_t i = 0; i < count; i++)
		cell[i] = cell_of(position + 3 * order->point[i], least, order->side, level);
	qsort(cell, count, sizeof *cell, compare_cells);
	for (size_t i = 0; i < count; i++)
		different += i == 0 || cell[i] != cell[i - 1];
	free(cell);
	return different;
}

/* The points up to the end of a level are one for each cell of it, and each point comes once. */
static void test_order(void **state)
{
	(void)state;
	static float position[3 * POINTS];
	gw_error error = { 0 };
	page_order order;
	uint8_t seen[POINTS] = { 0 };
	make_places(position);
	assert_int_equal(page_order_make(position, POINTS, &order, &error), GW_OK);
	for (size_t i = 0; i < POINTS; i++)
		seen[order.point[i]]++;
	for (size_t i = 0; i < POINTS; i++)
		assert_int_equal(seen[i], 1);
	for (unsigned level = 0; level < PAGE_ORDER_LEVELS - 1; level++) {
		size_t cells = count_cells(position, &order, POINTS, level);
		assert_int_equal(order.end[level], cells);
		assert_int_equal(count_cells(position, &order, cells, level), cells);
	}
	assert_int_equal(order.end[PAGE_ORDER_LEVELS - 1], POINTS);
	page_order_cut(&order, 100);
	assert_int_equal(order.count, 100);
	assert_int_equal(order.end[PAGE_ORDER_LEVELS - 1], 100);
	page_order_clear(&order);
}

/* All at one place, one point, and none. */
static void test_order_of_few(void **state)
{
	(void)state;
	const float same[9] = { 1, 2, 3, 1, 2, 3, 1, 2, 3 };
	gw_error error = { 0 };
	page_order order;
	for (size_t count = 0; count <= 3; count++) {
		assert_int_equal(page_order_make(same, count, &order, &error), GW_OK);
		assert_int_equal(order.end[PAGE_ORDER_LEVELS - 1], count);
		assert_int_equal(order.end[0], count > 0);
		page_order_clear(&order);
	}
}

/* OpenGL ES 3.0, 3.8.3.2: the largest mantissa is 256 to 511, so that rounding is off by 1/512 of
 * the largest channel at most, or of 512 where that is 511.5; and by half a step of the least
 * exponent. */
static void test_rgb9e5(void **state)
{
	(void)state;
	uint32_t random = 7;
	for (int i = 0; i < 20000; i++) {
		double rgb[3], most = 0.0, scale = ldexp(1.0, (int)(next(&random) * 40.0) - 25);
		for (int k = 0; k < 3; k++) {
			rgb[k] = fmin(next(&random) * scale, 65408.0);
			most = fmax(most, rgb[k]);
		}
		uint32_t word = page_points_rgb9e5(rgb);
		for (int k = 0; k < 3; k++) {
			double value = ldexp((double)(word >> (9 * k) & 511u), (int)(word >> 27) - 24);
			assert_true(fabs(value - rgb[k]) <= fmax(most / 511.0, 0x1p-25));
		}
	}
	assert_int_equal(page_points_rgb9e5((double[3]){ 0 }), 0);
	assert_int_equal(page_points_rgb9e5((double[3]){ 65408.0, 0, 0 }), 31u << 27 | 511u);
	/* What rounds up to 512 takes the next exponent. */
	assert_int_equal(page_points_rgb9e5((double[3]){ 511.9, 0, 0 }), 25u << 27 | 256u);
}

typedef struct packed {
	const uint8_t *bytes;
	size_t count;
} packed;

static uint32_t word_at(const packed *p, size_t plane, size_t i)
{
	uint32_t word = 0;
	for (size_t b = 0; b < 4; b++)
		word |= (uint32_t)p->bytes[(plane + b) * p->count + i] << 8 * b;
	return word;
}

/* A few discs with all that can be said of one. */
typedef struct discs {
	gw_surfels surfels;
	float position[9], normal[9], radius[3], clip[18], albedo[9];
	uint8_t two_sided[3], glows[3];
	uint32_t order[3], light[3];
} discs;

static void make_discs(discs *d)
{
	*d = (discs){ .position = { 0, 0, 0, 1, 2, 3, 0.25f, 0.5f, 0.125f },
				  .normal = { 0, 0, 1, 0, -0.6f, -0.8f, 1, 0, 0 },
				  .radius = { 0.5f, 0.125f, 0.25f },
				  .clip = { [6] = 0, [7] = 1, [8] = 0.0625f },
				  .albedo = { 0.25f, 0.5f, 1.0f, 0, 0, 0, 0.99f, 0.01f, 0.5f },
				  .two_sided = { 0, 1, 0 },
				  .glows = { 1, 0, 0 },
				  .order = { 2, 0, 1 },
				  .light = { 10, 20, 0xffffffffu } };
	d->surfels = (gw_surfels){ .count = 3,
							   .maximum = { 1, 2, 3 },
							   .position = d->position,
							   .normal = d->normal,
							   .radius = d->radius,
							   .clip = d->clip,
							   .albedo = d->albedo,
							   .two_sided = d->two_sided };
}

/* What the scripts of a page make of the bytes. */
static void test_packing(void **state)
{
	(void)state;
	discs d;
	make_discs(&d);
	const uint32_t *light[1] = { d.light };
	page_points points = { &d.surfels, d.glows, d.order, 3, 0.0, 0.0, light, 1 };
	page_points_scale(&points);
	assert_true(points.radius == 0.5);
	/* All discs are 2^-3 wide or wider, of which a 64th. */
	assert_true(points.step == 0x1p-9);
	assert_int_equal(page_points_bytes(&points, 3), 3 * (PAGE_PLANES + PAGE_LAMP_PLANES));
	uint8_t bytes[3 * (PAGE_PLANES + PAGE_LAMP_PLANES)];
	page_points_pack(&points, 0, 3, bytes);
	const packed p = { bytes, 3 };
	for (size_t k = 0; k < 3; k++) {
		int64_t at = 0;
		for (size_t i = 0; i < 3; i++) {
			uint32_t off = word_at(&p, 4 * k, i);
			at += off & 1u ? -(int64_t)(off >> 1) - 1 : (int64_t)(off >> 1);
			assert_true((double)at * points.step == (double)d.position[3 * d.order[i] + k]);
		}
	}
	for (size_t i = 0; i < 3; i++) {
		double radius = points.radius * exp2((bytes[14 * 3 + i] - 255.0) / 12.0);
		assert_true(radius == (double)d.radius[d.order[i]]); /* powers of two */
		assert_int_equal(word_at(&p, PAGE_PLANES, i), d.light[d.order[i]]);
		assert_int_equal(bytes[15 * 3 + i], i == 1 ? PAGE_GLOWS : i == 2 ? PAGE_TWO_SIDED : 0);
		assert_int_equal(bytes[17 * 3 + i], i == 1 || i == 0 ? 255 : 191);
		assert_int_equal(bytes[19 * 3 + i], 255);
	}
	/* sqrt(1/4) of 255; the x axis in octahedral form; the z axis. */
	assert_int_equal(bytes[20 * 3 + 1], 128);
	assert_int_equal(bytes[12 * 3], 254);
	assert_int_equal(bytes[13 * 3], 127);
	assert_int_equal(bytes[12 * 3 + 1], 127);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_order),
		cmocka_unit_test(test_order_of_few),
		cmocka_unit_test(test_rgb9e5),
		cmocka_unit_test(test_packing),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

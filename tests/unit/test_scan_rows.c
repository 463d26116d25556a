/* Rows and columns of a scanner's picture are found in the bare list of its points. */
#include "points/scan_rows.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define COLUMNS 90u
#define ROWS 70u
#define CELLS (COLUMNS * ROWS)

/* What becomes of the points before they are written. */
typedef struct treatment {
	bool turns;     /* a scanner about z; else a camera along z */
	bool shuffled;  /* in no order */
	bool uneven;    /* columns are off by up to 0.3 of their width, and all is written twice */
	bool rings;     /* rows are off by as much */
	bool blank;     /* one in fifty has no depth, and is written as 0, 0, 0 */
	bool above;     /* a part of a picture, all of it above the camera */
	bool columns;   /* one column after the other */
	double rounded; /* to multiples of that; 0: not */
	double shift;   /* along x, metres */
} treatment;

static bool is_blank(const treatment *t, uint32_t cell)
{
	return t->blank && cell % 50 == 7;
}

/* A room's corner at a depth that goes in steps, as depth cameras measure it. */
static double depth_of(double u, double v)
{
	double depth = fmin(3.0 + u, 2.0 / fmax(v, 0.1));
	return 1.0 / (round(200.0 / depth) / 200.0);
}

/* Which cell's point is at a place of the list. */
static uint32_t cell_at(const treatment *t, uint32_t i)
{
	if (t->columns)
		return i % ROWS * COLUMNS + i / ROWS;
	return t->shuffled ? (uint32_t)(i * 4001ull % CELLS) : i; /* 4001 is prime */
}

static void place(const treatment *t, uint32_t cell, double p[3])
{
	double u = (cell % COLUMNS - 44.0) / 100.0, v = (cell / COLUMNS - 30.0) / 100.0;
	v -= t->above ? 0.5 : 0.0;
	u += t->uneven ? 0.003 * sin(7.0 * (cell % COLUMNS)) : 0.0;
	v += t->rings ? 0.003 * sin(7.0 * (cell / COLUMNS)) : 0.0;
	double depth = depth_of(u, v);
	if (t->turns) {
		p[0] = depth * cos(u) * cos(v);
		p[1] = depth * sin(u) * cos(v);
		p[2] = depth * sin(v);
	} else {
		p[0] = u * depth;
		p[1] = v * depth;
		p[2] = depth;
	}
	p[0] += t->shift;
	if (is_blank(t, cell))
		p[0] = p[1] = p[2] = 0.0;
	for (int k = 0; k < 3 && t->rounded > 0.0; k++)
		p[k] = round(p[k] / t->rounded) * t->rounded;
}

static scan take(const treatment *t)
{
	static const char *const name[3] = { "x", "y", "z" };
	scan cloud = { .count = t->uneven ? 2 * CELLS : CELLS, .up = 'z' };
	gw_error error = { 0 };
	for (int k = 0; k < 3; k++)
		assert_non_null(scan_add_column(&cloud, name[k], SCAN_FLOAT32, &error));
	for (uint32_t k = 0; k < cloud.count; k++) {
		uint32_t i = k % CELLS;
		double p[3];
		place(t, cell_at(t, i), p);
		for (int axis = 0; axis < 3; axis++)
			((float *)cloud.column[axis].data)[k] = (float)p[axis];
	}
	return cloud;
}

static void find(scan *cloud)
{
	gw_error error = { 0 };
	assert_int_equal(scan_find_rows(cloud, false, &error), GW_OK);
}

static void expect_cells(const treatment *t)
{
	scan cloud = take(t);
	find(&cloud);
	assert_int_equal(cloud.image_count, 1);
	assert_int_equal(cloud.image[0].columns, COLUMNS);
	assert_int_equal(cloud.image[0].rows, ROWS);
	assert_int_equal(cloud.scanner_count, 1);
	assert_true(cloud.scanner[0] == 0.0 && cloud.scanner[1] == 0.0 && cloud.scanner[2] == 0.0);
	for (uint32_t i = 0; i < CELLS; i++) {
		uint32_t cell = cell_at(t, i);
		assert_int_equal(cloud.image_cell[i], is_blank(t, cell) ? UINT32_MAX : cell);
	}
	assert_int_equal(cloud.comment_count, 1);
	assert_int_equal(cloud.up, t->turns || t->shuffled ? 'z' : 'Y');
	scan_clear(&cloud);
}

static void expect_none(const treatment *t)
{
	scan cloud = take(t);
	find(&cloud);
	assert_int_equal(cloud.image_count + cloud.scanner_count + cloud.comment_count, 0);
	assert_int_equal(cloud.up, 'z');
	scan_clear(&cloud);
}

static void cells_are_found_again(void **state)
{
	(void)state;
	expect_cells(&(treatment){ .turns = false });
	expect_cells(&(treatment){ .turns = true });
	expect_cells(&(treatment){ .shuffled = true });
	expect_cells(&(treatment){ .turns = true, .shuffled = true });
	expect_cells(&(treatment){ .blank = true });
	expect_cells(&(treatment){ .turns = true, .blank = true });
	expect_cells(&(treatment){ .columns = true });
	expect_cells(&(treatment){ .above = true });
	expect_cells(&(treatment){ .above = true, .columns = true });
	/* A hundredth of a cell, which is a hundredth wide, at 2 m: rounded by half of that. */
	expect_cells(&(treatment){ .rounded = 2e-4 });
}

/* A laser that turns up and down evenly, on a head that does not, stood at the origin. Where rows
 * are uneven it may be anything that is round, as if it were turned on a lathe. */
static void uneven_columns_tell_of_a_scanner(void **state)
{
	(void)state;
	const treatment head = { .turns = true, .uneven = true };
	scan cloud = take(&head);
	find(&cloud);
	assert_int_equal(cloud.image_count, 0);
	assert_int_equal(cloud.scanner_count, 1);
	assert_true(cloud.scanner[0] == 0.0 && cloud.scanner[1] == 0.0 && cloud.scanner[2] == 0.0);
	assert_int_equal(cloud.comment_count, 1);
	scan_clear(&cloud);
	expect_none(&(treatment){ .turns = true, .uneven = true, .shift = 0.7 });
	expect_none(&(treatment){ .turns = true, .rings = true });
}

/* Where a matrix takes the points to, y need not go down. */
static void moved_points_say_nothing_of_up(void **state)
{
	(void)state;
	gw_error error = { 0 };
	scan cloud = take(&(treatment){ .turns = false });
	assert_int_equal(scan_find_rows(&cloud, true, &error), GW_OK);
	assert_int_equal(cloud.image_count, 1);
	assert_int_equal(cloud.up, 'z');
	scan_clear(&cloud);
}

/* Seen from elsewhere, or rounded to half a cell and more, they are no rows. */
static void others_have_none(void **state)
{
	(void)state;
	expect_none(&(treatment){ .shift = 0.7 });
	expect_none(&(treatment){ .turns = true, .shift = 0.7 });
	expect_none(&(treatment){ .rounded = 2e-2 });
	expect_none(&(treatment){ .turns = true, .rounded = 2e-2 });
}

/* Floors drawn as a grid, one or two of them above the origin, are no picture taken from there: one
 * has a single depth; of two, points have cells in common. Both lie within a camera's view. */
static void grids_of_points_are_no_picture(void **state)
{
	(void)state;
	for (int floors = 1; floors <= 2; floors++) {
		scan cloud = take(&(treatment){ .turns = false });
		for (uint32_t i = 0; i < CELLS; i++) {
			((float *)cloud.column[0].data)[i] = (float)(i % COLUMNS) * 0.1f - 4.5f;
			((float *)cloud.column[1].data)[i] = (float)(i / COLUMNS) * 0.1f - 3.5f;
			((float *)cloud.column[2].data)[i] = floors == 2 && i % 2 ? 6.0f : 3.0f;
		}
		find(&cloud);
		assert_int_equal(cloud.image_count + cloud.scanner_count, 0);
		scan_clear(&cloud);
	}
}

/* What a file says goes before. */
static void files_know_better(void **state)
{
	(void)state;
	gw_error error = { 0 };
	scan cloud = take(&(treatment){ .turns = true });
	for (int k = 0; k < 2; k++)
		assert_int_equal(
			scan_add_scanner(&cloud, (const double[3]){ k, 1, 2 }, 0, cloud.count, &error), GW_OK);
	find(&cloud);
	assert_int_equal(cloud.image_count, 0);
	scan_clear(&cloud);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(cells_are_found_again),
		cmocka_unit_test(moved_points_say_nothing_of_up),
		cmocka_unit_test(uneven_columns_tell_of_a_scanner),
		cmocka_unit_test(others_have_none),
		cmocka_unit_test(grids_of_points_are_no_picture),
		cmocka_unit_test(files_know_better),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

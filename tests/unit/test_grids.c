/* Rows and columns of E57, PTX and PCD files: which cell each point has, and where the scanner
 * stood, when the file says so and when only the points do. */
#include "points/format.h"
#include "sample_scans.h"
#include "table/format_table.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#define ROWS 30
#define COLUMNS 72
#define PI 3.14159265358979323846

/* How the file is to be. */
typedef enum pose { POSE_GIVEN, POSE_MISSING } pose;

static uint32_t random_state;

static double random_number(void)
{
	random_state = random_state * 1664525u + 1013904223u;
	return (double)(random_state >> 8) / 16777216.0;
}

static bool is_hole(size_t column, size_t row)
{
	return column % 7 == 3 && row % 5 == 2;
}

/* What a scanner, or a camera, sees of a hall of 8 by 6 by 3 m from (3, 2, 1.5), ranges with 5 mm
 * of noise and one in fifty anywhere along its ray; in its own frame. */
static void see(bool camera, size_t column, size_t row, double own[3])
{
	static const double place[3] = { 3, 2, 1.5 }, size[3] = { 8, 6, 3 };
	double turn = ((double)column + 0.5) * 2.0 * PI / COLUMNS;
	double rise = ((double)row - 12.0) * 0.09;
	double d[3] = { cos(rise) * cos(turn), cos(rise) * sin(turn), sin(rise) };
	if (camera) {
		d[0] = 1.0;
		d[1] = ((double)column - 35.5) * 0.025;
		d[2] = ((double)row - 14.5) * 0.025;
	}
	double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]), range = INFINITY;
	for (int k = 0; k < 3; k++) {
		d[k] /= length;
		if (fabs(d[k]) > 1e-9)
			range = fmin(range, ((d[k] > 0.0 ? size[k] : 0.0) - place[k]) / d[k]);
	}
	range += 0.005 * (random_number() + random_number() - 1.0);
	if (random_number() < 0.02)
		range *= 0.3 + 0.7 * random_number();
	for (int k = 0; k < 3; k++)
		own[k] = range * d[k];
}

/* A scanner that leans a little and stands at a place in metres of some map. */
static sample_scan make_scan(double east, double lean)
{
	sample_scan made = { .name = "hall", .columns = COLUMNS, .rows = ROWS };
	const double rotation[9] = { cos(lean), 0, sin(lean), 0, 1, 0, -sin(lean), 0, cos(lean) };
	memcpy(made.rotation, rotation, sizeof rotation);
	made.translation[0] = east;
	made.translation[1] = 2.0 * east;
	made.translation[2] = 1.5;
	made.cell = calloc(COLUMNS * ROWS, sizeof *made.cell);
	assert_non_null(made.cell);
	random_state = 7;
	for (size_t i = 0; i < (size_t)COLUMNS * ROWS; i++) {
		see(false, i / ROWS, i % ROWS, made.cell[i].position);
		made.cell[i].hole = is_hole(i / ROWS, i % ROWS);
		made.cell[i].color[0] = (uint8_t)(i % 251);
	}
	return made;
}

/* Takes the pose from a scan to its points, as programs do that align scans. */
static void move_to_world(sample_scan *made)
{
	for (size_t i = 0; i < made->columns * made->rows; i++) {
		double own[3], *p = made->cell[i].position;
		memcpy(own, p, sizeof own);
		for (size_t k = 0; k < 3; k++)
			p[k] = made->rotation[3 * k] * own[0] + made->rotation[3 * k + 1] * own[1] +
				   made->rotation[3 * k + 2] * own[2] + made->translation[k];
	}
	memset(made->translation, 0, sizeof made->translation);
	for (size_t k = 0; k < 9; k++)
		made->rotation[k] = k % 4 == 0;
}

static scan read_and_remove(const char *path)
{
	scan cloud;
	gw_error error = { 0 };
	if (format_read(path, NULL, &cloud, &error) != GW_OK)
		fail_msg("%s", error.text);
	unlink(path);
	return cloud;
}

/* Each point is in the cell that it was written in, which its red tells, and the scanner is known
 * to some millimetres. */
static void check_cloud(const scan *cloud, const double place[3], bool from_above)
{
	const scan_column *red = scan_find(cloud, "red");
	assert_int_equal(cloud->image_count, 1);
	assert_int_equal(cloud->image[0].columns, COLUMNS);
	assert_int_equal(cloud->image[0].rows, ROWS);
	assert_int_equal(cloud->image[0].count, cloud->count);
	assert_non_null(red);
	for (size_t i = 0; i < cloud->count; i++) {
		size_t cell = cloud->image_cell[i], row = cell / COLUMNS, column = cell % COLUMNS;
		assert_true(row < ROWS && !is_hole(column, from_above ? ROWS - 1 - row : row));
		assert_int_equal((column * ROWS + (from_above ? ROWS - 1 - row : row)) % 251,
						 scan_value(red, i));
	}
	assert_int_equal(cloud->scanner_count, 1);
	const double *found[2] = { cloud->scanner, cloud->image[0].scanner };
	for (int i = 0; i < 2; i++)
		for (size_t k = 0; k < 3; k++)
			if (!(fabs(found[i][k] - place[k]) < 2e-3))
				fail_msg("the scanner stands at %g %g %g, not at %g %g %g", found[i][0],
						 found[i][1], found[i][2], place[0], place[1], place[2]);
}

static void check_format(const char *path, int (*write)(const sample_scan *, const char *),
						 pose how)
{
	static const double east[3] = { 0.0, 3.0, 412345.5 };
	for (int i = 0; i < 6; i++) {
		sample_scan scanned = make_scan(east[i / 2], i % 2 ? 0.05 : 0.0);
		double place[3];
		memcpy(place, scanned.translation, sizeof place);
		if (how == POSE_MISSING)
			move_to_world(&scanned);
		assert_int_equal(write(&scanned, path), 0);
		scan cloud = read_and_remove(path);
		assert_int_equal(cloud.left_out, 60);
		check_cloud(&cloud, place, false);
		scan_clear(&cloud);
		sample_scans_clear(&scanned, 1);
	}
}

static int write_e57(const sample_scan *scanned, const char *path)
{
	return sample_write_e57(scanned, 1, path, "test");
}

static int write_ptx(const sample_scan *scanned, const char *path)
{
	return sample_write_ptx(scanned, 1, path);
}

static void e57_with_poses(void **state)
{
	(void)state;
	check_format("test_grids.e57", write_e57, POSE_GIVEN);
}

static void e57_in_the_world(void **state)
{
	(void)state;
	check_format("test_grids.e57", write_e57, POSE_MISSING);
}

static void ptx_with_poses(void **state)
{
	(void)state;
	check_format("test_grids.ptx", write_ptx, POSE_GIVEN);
}

static void ptx_in_the_world(void **state)
{
	(void)state;
	check_format("test_grids.ptx", write_ptx, POSE_MISSING);
}

/* An organised PCD of a camera that stands at a place, and says so, or not. */
static void write_pcd(const char *path, const double place[3], pose how)
{
	FILE *file = fopen(path, "w");
	const double none[3] = { 0 }, *said = how == POSE_GIVEN ? place : none;
	assert_non_null(file);
	fprintf(file,
			"# .PCD v0.7\nVERSION 0.7\nFIELDS x y z red\nSIZE 8 8 8 1\nTYPE F F F U\n"
			"COUNT 1 1 1 1\nWIDTH %d\nHEIGHT %d\nVIEWPOINT %.9g %.9g %.9g 1 0 0 0\nPOINTS %d\n"
			"DATA ascii\n",
			COLUMNS, ROWS, said[0], said[1], said[2], ROWS * COLUMNS);
	random_state = 7;
	for (size_t i = 0; i < (size_t)ROWS * COLUMNS; i++) {
		double own[3];
		size_t column = i % COLUMNS, row = i / COLUMNS;
		see(true, column, ROWS - 1 - row, own);
		if (is_hole(column, row))
			fprintf(file, "nan nan nan 0\n");
		else
			fprintf(file, "%.6f %.6f %.6f %d\n", own[0] + place[0], own[1] + place[1],
					own[2] + place[2], (int)((column * ROWS + row) % 251));
	}
	assert_int_equal(fclose(file), 0);
}

static void pcd_of_cameras(void **state)
{
	(void)state;
	const double place[3][3] = { { 0, 0, 0 }, { 5, -3, 1 }, { 412345.5, 5300000, 100 } };
	for (int i = 0; i < 6; i++) {
		write_pcd("test_grids.pcd", place[i / 2], i % 2 ? POSE_GIVEN : POSE_MISSING);
		scan cloud = read_and_remove("test_grids.pcd");
		assert_int_equal(cloud.image_count, 1);
		assert_int_equal(cloud.image[0].columns, COLUMNS);
		assert_int_equal(cloud.image[0].rows, ROWS);
		assert_int_equal(cloud.scanner_count, 1);
		for (size_t n = 0; n < cloud.count; n++)
			assert_int_equal(cloud.image_cell[n], n);
		for (size_t k = 0; k < 3; k++)
			if (!(fabs(cloud.scanner[k] - place[i / 2][k]) < 2e-3))
				fail_msg("case %d: the camera stands at %g %g %g", i, cloud.scanner[0],
						 cloud.scanner[1], cloud.scanner[2]);
		scan_clear(&cloud);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(e57_with_poses), cmocka_unit_test(e57_in_the_world),
		cmocka_unit_test(ptx_with_poses), cmocka_unit_test(ptx_in_the_world),
		cmocka_unit_test(pcd_of_cameras),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

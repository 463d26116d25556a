/* The camera and the automatic viewpoint against their definitions. */
#include "glowworm_picture.h"
#include "pictures/render_cameras.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const double z_up[3] = { 0, 0, 1 };

/* A dozen operations in double on numbers up to 10. */
#define ROUNDING 1e-13

static void assert_near(double a, double b, double tolerance)
{
	if (!(fabs(a - b) <= tolerance))
		fail_msg("%.17g is not %.17g", a, b);
}

/* Looking along y with z up, x is to the right. */
static void test_axes(void **state)
{
	(void)state;
	const double at[3] = { 1, 2, 3 }, to[3] = { 1, 7, 3 };
	gw_camera c;
	assert_int_equal(gw_camera_look(&c, at, to, z_up, 90, NULL), GW_OK);
	assert_near(c.right[0], 1, ROUNDING);
	assert_near(c.up[2], 1, ROUNDING);
	assert_near(c.forward[1], 1, ROUNDING);
	assert_near(c.tangent, 1, ROUNDING);
	const double world[3] = { 4, 5, 6 };
	double view[3];
	gw_camera_turn(&c, world, view);
	assert_near(view[0], 4, ROUNDING);
	assert_near(view[1], 6, ROUNDING);
	assert_near(view[2], 5, ROUNDING);
}

/* Of a picture twice as wide as high, 90 degrees high, the sides are planes at 45 degrees above and
 * below, and at an angle of tangent 2 to the left and right. A ball 1 beside such a plane is in
 * view from radius 1 on, and one behind the camera never. */
static void test_balls_in_view(void **state)
{
	(void)state;
	const double at[3] = { 1, 2, 3 }, to[3] = { 1, 7, 3 };
	gw_camera c;
	assert_int_equal(gw_camera_look(&c, at, to, z_up, 90, NULL), GW_OK);
	c.near = 0.5;
	for (int side = -1; side <= 1; side += 2) {
		double above[3] = { 1, 12, 3 + side * (10 + sqrt(2.0)) };
		double beside[3] = { 1 + side * (20 + sqrt(5.0)), 12, 3 };
		assert_true(gw_camera_sees(&c, 2, above, 1.001));
		assert_false(gw_camera_sees(&c, 2, above, 0.999));
		assert_true(gw_camera_sees(&c, 2, beside, 1.001));
		assert_false(gw_camera_sees(&c, 2, beside, 0.999));
	}
	const double ahead[3] = { 1, 9, 3 }, behind[3] = { 1, 1, 3 };
	assert_true(gw_camera_sees(&c, 2, ahead, 0));
	assert_false(gw_camera_sees(&c, 2, behind, 1.4));
}

/* A quarter turn about z takes a camera south of the centre to the east of it. */
static void test_orbit(void **state)
{
	(void)state;
	const double at[3] = { 10, 5, 1 }, to[3] = { 10, 10, 1 };
	gw_camera c;
	assert_int_equal(gw_camera_look(&c, at, to, z_up, 40, NULL), GW_OK);
	gw_camera_orbit(&c, to, z_up, acos(-1.0) / 2);
	assert_near(c.position[0], 15, 1e-12);
	assert_near(c.position[1], 10, 1e-12);
	assert_near(c.forward[0], -1, ROUNDING);
	assert_near(c.up[2], 1, ROUNDING);
}

static void expect_refused(const double at[3], const double to[3], const double up[3], double angle,
						   const char *word)
{
	gw_camera c;
	gw_error error = { 0 };
	assert_int_equal(gw_camera_look(&c, at, to, up, angle, &error), GW_ERROR_USAGE);
	if (!strstr(error.text, word))
		fail_msg("'%s' does not say '%s'", error.text, word);
}

static void test_bad_cameras(void **state)
{
	(void)state;
	const double at[3] = { 500000, 4000000, 10 }, to[3] = { 500001, 4000000, 10 };
	const double above[3] = { 500000, 4000000, 20 }, bad[3] = { 0, NAN, 0 }, none[3] = { 0 };
	expect_refused(at, to, z_up, 0, "angle");
	expect_refused(at, to, z_up, -5, "angle");
	expect_refused(at, to, z_up, 180, "angle");
	expect_refused(at, to, z_up, NAN, "angle");
	expect_refused(at, at, z_up, 40, "where it looks");
	expect_refused(at, above, z_up, 40, "straight along");
	expect_refused(at, to, none, 40, "straight along");
	expect_refused(bad, to, z_up, 40, "finite");
}

/* ---------------------------------------------------------------------------- viewpoints */

/* A cube of side 2 around (100, 200, 5), 20 x 20 points a face, normals outwards or inwards. */
static void make_cube(double inwards, gw_surfels *surfels)
{
	const double centre[3] = { 100, 200, 5 };
	size_t count = 6 * 400, n = 0;
	double *position = malloc(3 * count * sizeof *position);
	float *normal = calloc(3 * count, sizeof *normal);
	for (int face = 0; face < 6; face++)
		for (int i = 0; i < 400; i++, n++) {
			size_t axis = (size_t)face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
			double side = face % 2 ? 1 : -1;
			position[3 * n + axis] = centre[axis] + side;
			position[3 * n + u] = centre[u] - 0.95 + 0.1 * (i % 20);
			position[3 * n + v] = centre[v] - 0.95 + 0.1 * (i / 20);
			normal[3 * n + axis] = (float)(-inwards * side);
		}
	gw_points points = { .count = count, .position = position, .normal = normal };
	gw_surfels_options options = { .threads = 1 };
	assert_int_equal(gw_surfels_make(&points, &options, surfels, NULL), GW_OK);
	free(position);
	free(normal);
}

/* By the divergence theorem: exactly 1 and -1, as all terms have one sign. */
static void test_enclosure(void **state)
{
	(void)state;
	gw_surfels s;
	make_cube(1, &s);
	assert_near(gw_viewpoint_enclosure(&s), 1, 1e-6);
	gw_surfels_clear(&s);
	make_cube(-1, &s);
	assert_near(gw_viewpoint_enclosure(&s), -1, 1e-6);
	gw_surfels_clear(&s);
}

/* A room is seen from inside it, a box from outside, and all of that in the picture. */
static void test_inside_and_outside(void **state)
{
	(void)state;
	gw_surfels s;
	gw_viewpoint v;
	make_cube(1, &s);
	assert_int_equal(
		gw_viewpoint_find(
			&s, &(gw_viewpoint_wish){ .kind = GW_VIEWPOINT_AUTO, .up = 'z', .aspect = 1.5 }, &v,
			NULL),
		GW_OK);
	assert_true(v.inside);
	assert_true(fabs(v.at[0] - 100) < 1 && fabs(v.at[1] - 200) < 1 && fabs(v.at[2] - 5) < 1);
	gw_surfels_clear(&s);

	make_cube(-1, &s);
	assert_int_equal(
		gw_viewpoint_find(
			&s, &(gw_viewpoint_wish){ .kind = GW_VIEWPOINT_AUTO, .up = 'z', .aspect = 1.5 }, &v,
			NULL),
		GW_OK);
	assert_false(v.inside);
	gw_camera c;
	assert_int_equal(gw_camera_look(&c, v.at, v.to, z_up, v.angle, NULL), GW_OK);
	double widest = 0;
	for (size_t i = 0; i < s.count; i++) {
		double world[3], view[3];
		for (size_t k = 0; k < 3; k++)
			world[k] = s.origin[k] + (double)s.position[3 * i + k] - v.at[k];
		gw_camera_turn(&c, world, view);
		assert_true(view[2] > 0);
		widest = fmax(widest, fabs(view[0]) / view[2] / (1.5 * c.tangent));
		widest = fmax(widest, fabs(view[1]) / view[2] / c.tangent);
	}
	/* Within the margin of 5 %, and of the discs' radius of a tenth of the cube. */
	if (!(widest < 1 && widest > 0.75))
		fail_msg("the cube reaches to %g of the picture", widest);
	gw_surfels_clear(&s);
}

/* ------------------------------------------------------------------- rooms, things, strays */

#define SIDE_POINTS 40

/* A box without normals, the corner at the origin; with `open`, the side of least y is missing. */
static size_t fill_box(const double size[3], bool open, double *position)
{
	size_t n = 0;
	for (int face = 0; face < 6; face++) {
		size_t axis = (size_t)face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
		for (int i = 0; i < SIDE_POINTS * SIDE_POINTS && !(open && face == 2); i++, n++) {
			position[3 * n + axis] = face % 2 ? size[axis] : 0;
			position[3 * n + u] = size[u] * (i % SIDE_POINTS + 0.5) / SIDE_POINTS;
			position[3 * n + v] = size[v] * ((double)(i / SIDE_POINTS) + 0.5) / SIDE_POINTS;
		}
	}
	return n;
}

static gw_viewpoint find_view(const double *position, size_t count, gw_viewpoint_wish wish)
{
	gw_points points = { .count = count, .position = position };
	gw_surfels_options options = { .threads = 1 };
	gw_surfels s;
	gw_viewpoint v;
	wish.up = wish.up ? wish.up : 'z';
	wish.aspect = 1.5;
	assert_int_equal(gw_surfels_make(&points, &options, &s, NULL), GW_OK);
	assert_int_equal(gw_viewpoint_find(&s, &wish, &v, NULL), GW_OK);
	gw_surfels_clear(&s);
	return v;
}

/* Nobody says which side is which: a box of 20 cm is a thing. One of 8 x 4 x 3 m is a room, where
 * eyes are 1.6 m high (EYE_HEIGHT) and look along its length. */
static void test_size_for_people(void **state)
{
	(void)state;
	double *position = malloc(6 * SIDE_POINTS * SIDE_POINTS * 3 * sizeof *position);
	const double carton[3] = { 0.2, 0.1, 0.1 }, room[3] = { 8, 4, 3 };
	size_t count = fill_box(carton, false, position);
	assert_false(find_view(position, count, (gw_viewpoint_wish){ 0 }).inside);
	count = fill_box(room, false, position);
	gw_viewpoint v = find_view(position, count, (gw_viewpoint_wish){ 0 });
	assert_true(v.inside);
	/* The floor is known to the float32 of a cell's mean. */
	assert_near(v.at[2], 1.6, 1e-3);
	assert_true(fabs(v.to[0] - v.at[0]) > 2 * fabs(v.to[1] - v.at[1]));
	assert_true(v.at[1] > 0 && v.at[1] < 4);
	/* The same with -y up, turned about x: z goes along -y. */
	for (size_t i = 0; i < count; i++) {
		double *p = position + 3 * i, z = p[2];
		p[2] = p[1];
		p[1] = -z;
	}
	v = find_view(position, count, (gw_viewpoint_wish){ .up = 'Y' });
	assert_true(v.inside);
	assert_near(v.at[1], -1.6, 1e-3);
	free(position);
}

/* A ball of 10 m has no corners and no flat floor: whoever sees it stands outside. */
static void test_ball(void **state)
{
	(void)state;
	size_t count = 8000;
	double *position = malloc(3 * count * sizeof *position);
	for (size_t i = 0; i < count; i++) {
		double z = 1 - (2 * (double)i + 1) / (double)count, r = sqrt(1 - z * z);
		position[3 * i] = 5 * r * cos(2.39996323 * (double)i);
		position[3 * i + 1] = 5 * r * sin(2.39996323 * (double)i);
		position[3 * i + 2] = 5 * z;
	}
	assert_false(find_view(position, count, (gw_viewpoint_wish){ 0 }).inside);
	free(position);
}

/* A room without its front is a stage: seen from outside, through the front. */
static void test_stage(void **state)
{
	(void)state;
	double *position = malloc(6 * SIDE_POINTS * SIDE_POINTS * 3 * sizeof *position);
	float *normal = malloc(6 * SIDE_POINTS * SIDE_POINTS * 3 * sizeof *normal);
	const double room[3] = { 4, 4, 3 };
	size_t count = fill_box(room, true, position);
	for (size_t i = 0; i < 3 * count; i++) {
		bool low = position[i] <= 0, high = position[i] >= room[i % 3];
		normal[i] = low ? 1.0f : high ? -1.0f : 0.0f;
	}
	gw_points points = { .count = count, .position = position, .normal = normal };
	gw_surfels_options options = { .threads = 1 };
	gw_surfels s;
	gw_viewpoint v;
	assert_int_equal(gw_surfels_make(&points, &options, &s, NULL), GW_OK);
	gw_viewpoint_wish wish = { .up = 'z', .aspect = 1 };
	assert_int_equal(gw_viewpoint_find(&s, &wish, &v, NULL), GW_OK);
	assert_false(v.inside);
	assert_true(v.at[1] < 0 && fabs(v.at[0] - 2) < 2 - v.at[1]);
	gw_surfels_clear(&s);
	free(position);
	free(normal);
}

/* A cellar with its normals inwards, below a meadow of 40 by 40 m; the view with that light on
 * both.
 */
static gw_viewpoint view_cellar(float cellar, float meadow)
{
	const double room[3] = { 4, 4, 3 };
	double *position = calloc(7 * SIDE_POINTS * SIDE_POINTS * 3, sizeof *position);
	float *normal = calloc(7 * SIDE_POINTS * SIDE_POINTS * 3, sizeof *normal);
	size_t in = fill_box(room, false, position), count = in + SIDE_POINTS * SIDE_POINTS;
	for (size_t i = 0; i < 3 * in; i++) {
		bool low = position[i] <= 0, high = position[i] >= room[i % 3];
		normal[i] = low ? 1.0f : high ? -1.0f : 0.0f;
	}
	for (size_t i = in; i < count; i++) {
		position[3 * i] = (double)((i - in) % SIDE_POINTS) - 18;
		position[3 * i + 1] = (double)((i - in) / SIDE_POINTS) - 18;
		position[3 * i + 2] = 5;
		normal[3 * i + 2] = 1;
	}
	gw_points points = { .count = count, .position = position, .normal = normal };
	gw_surfels_options options = { .threads = 1 };
	gw_surfels s;
	gw_viewpoint v;
	assert_int_equal(gw_surfels_make(&points, &options, &s, NULL), GW_OK);
	float *light = calloc(s.count, sizeof *light);
	for (size_t i = 0; i < s.count; i++)
		light[i] = s.origin[2] + (double)s.position[3 * i + 2] > 4 ? meadow : cellar;
	gw_viewpoint_wish wish = { .up = 'z', .aspect = 1.5, .luminance = light };
	assert_int_equal(gw_viewpoint_find(&s, &wish, &v, NULL), GW_OK);
	gw_surfels_clear(&s);
	free(position);
	free(normal);
	free(light);
	return v;
}

/* Nearly all surface is the meadow, and is looked at from above; but not to show it in the dark
 * when a lamp lights the cellar. The meadow is 16 times as large: as bright, it has most light. */
static void test_lit_within(void **state)
{
	(void)state;
	gw_viewpoint v = view_cellar(1, 0.001f);
	assert_true(v.inside);
	assert_true(v.at[2] > 0 && v.at[2] < 3);
	assert_false(view_cellar(1, 1).inside);
	assert_false(view_cellar(0.001f, 1).inside);
	assert_false(view_cellar(0, 0).inside);
}

#define MOUNT_POINTS 20 /* a side */

/* What carried a scanner, as it saw it itself: a square of half a metre, 10 cm below it. */
static void fill_mount(const double scanner[3], double *position)
{
	for (size_t i = 0; i < MOUNT_POINTS * MOUNT_POINTS; i++) {
		position[3 * i] = scanner[0] - 0.25 + 0.5 * (double)(i % MOUNT_POINTS) / MOUNT_POINTS;
		position[3 * i + 1] = scanner[1] - 0.25 + 0.5 * (double)(i / MOUNT_POINTS) / MOUNT_POINTS;
		position[3 * i + 2] = scanner[2] - 0.1;
	}
}

/* A box of which one in so many patches was not scanned; how many points it has. */
static size_t scan_in_patches(const double box[3], size_t every, double *position)
{
	size_t count = fill_box(box, false, position), kept = 0;
	for (size_t i = 0; i < count; i++) {
		size_t column = i % SIDE_POINTS / 8, row = i / SIDE_POINTS % SIDE_POINTS / 8;
		if ((column + 2 * row) % every == 0)
			continue;
		memmove(position + 3 * kept++, position + 3 * i, 3 * sizeof *position);
	}
	return kept;
}

/* A room of which a quarter was not scanned, in patches, is one to be in when it is known where the
 * scanner stood; and the picture is taken from there, as no hole is seen by it, whatever it stood
 * on. */
static void test_scanned_room(void **state)
{
	(void)state;
	size_t most = 6 * SIDE_POINTS * SIDE_POINTS + MOUNT_POINTS * MOUNT_POINTS;
	double *position = malloc(most * 3 * sizeof *position);
	const double room[3] = { 8, 4, 3 }, scanner[3] = { 2.1, 1.9, 1.4 };
	size_t kept = scan_in_patches(room, 4, position);
	gw_viewpoint_wish wish = { .scanner = scanner, .scanner_count = 1 };
	gw_viewpoint v = find_view(position, kept, wish);
	assert_true(v.inside);
	assert_memory_equal(v.at, scanner, sizeof scanner);
	assert_true(v.to[0] > 4);
	fill_mount(scanner, position + 3 * kept);
	v = find_view(position, kept + MOUNT_POINTS * MOUNT_POINTS, wish);
	assert_memory_equal(v.at, scanner, sizeof scanner);
	assert_true(v.to[0] > 4);
	free(position);
}

/* A room of which half was scanned is one to be in; it is none where a quarter of what is seen are
 * backs, in pieces of a metre, as between the wires of a fence: it is seen from outside. */
static void test_fence_is_no_room(void **state)
{
	(void)state;
	double *position = malloc(6 * SIDE_POINTS * SIDE_POINTS * 3 * sizeof *position);
	float *normal = malloc(6 * SIDE_POINTS * SIDE_POINTS * 3 * sizeof *normal);
	const double room[3] = { 8, 4, 3 };
	bool inside[2];
	for (size_t backs = 0; backs < 2; backs++) {
		size_t count = scan_in_patches(room, 2, position);
		for (size_t i = 0; i < 3 * count; i++) {
			bool low = position[i] <= 0, high = position[i] >= room[i % 3];
			const double *p = position + i / 3 * 3;
			bool back = backs && ((int)p[0] + (int)p[1] + (int)p[2]) % 4 == 0;
			float front = back ? -1.0f : 1.0f;
			normal[i] = low ? front : high ? -front : 0.0f;
		}
		gw_points points = { .count = count, .position = position, .normal = normal };
		gw_surfels_options options = { .threads = 1, .normals = GW_NORMALS_GIVEN };
		gw_viewpoint_wish wish = { .up = 'z', .aspect = 1 };
		gw_surfels s;
		gw_viewpoint v;
		assert_int_equal(gw_surfels_make(&points, &options, &s, NULL), GW_OK);
		assert_int_equal(gw_viewpoint_find(&s, &wish, &v, NULL), GW_OK);
		inside[backs] = v.inside;
		gw_surfels_clear(&s);
	}
	assert_true(inside[0]);
	assert_false(inside[1]);
	free(position);
	free(normal);
}

/* One point 300 m away, and one before the camera, change the distance of the camera by no more
 * than a disc's width, and nearer than `near` there is only the latter. */
static void test_strays(void **state)
{
	(void)state;
	size_t most = 6 * SIDE_POINTS * SIDE_POINTS + 2;
	double *position = malloc(most * 3 * sizeof *position);
	const double carton[3] = { 0.2, 0.1, 0.1 };
	size_t count = fill_box(carton, false, position);
	gw_viewpoint clean = find_view(position, count, (gw_viewpoint_wish){ 0 });
	double way = 0;
	for (size_t k = 0; k < 3; k++) {
		position[3 * count + k] = k == 0 ? 300 : 0;
		position[3 * count + 3 + k] = clean.at[k] + 0.05 * (clean.to[k] - clean.at[k]);
		way += (clean.to[k] - clean.at[k]) * (clean.to[k] - clean.at[k]);
	}
	gw_viewpoint v = find_view(position, count + 2, (gw_viewpoint_wish){ 0 });
	assert_false(v.inside);
	for (int k = 0; k < 3; k++)
		assert_near(v.at[k], clean.at[k], 0.02);
	assert_true(v.near > 0.05 * sqrt(way) && v.near < sqrt(way) - 0.1);
	free(position);
}

/* How far ahead a point lies that a picture of 3:2 holds; the test fails where it does not. */
static double view_point(const gw_camera *camera, const double point[3])
{
	double world[3], view[3];
	for (size_t k = 0; k < 3; k++)
		world[k] = point[k] - camera->position[k];
	gw_camera_turn(camera, world, view);
	assert_true(fabs(view[0]) < 1.5 * camera->tangent * view[2]);
	assert_true(fabs(view[1]) < camera->tangent * view[2]);
	return view[2];
}

/* From all sides of a turn, all of a thing is in the picture. */
static void test_around(void **state)
{
	(void)state;
	double *position = malloc(6 * SIDE_POINTS * SIDE_POINTS * 3 * sizeof *position);
	const double plank[3] = { 2, 0.2, 0.3 };
	size_t count = fill_box(plank, false, position);
	gw_viewpoint v = find_view(position, count, (gw_viewpoint_wish){ .around = true });
	assert_false(v.inside);
	for (int turn = 0; turn < 7; turn++) {
		gw_camera c;
		assert_int_equal(gw_camera_look(&c, v.at, v.to, z_up, v.angle, NULL), GW_OK);
		gw_camera_orbit(&c, v.to, z_up, 2 * M_PI * turn / 7);
		for (size_t i = 0; i < count; i++) {
			assert_true(view_point(&c, position + 3 * i) > v.near);
		}
	}
	free(position);
}

/* Without normals, a sheet is looked at from where the scanner stood. */
static void test_scanner_side(void **state)
{
	(void)state;
	double position[1200];
	for (size_t i = 0; i < 400; i++) {
		position[3 * i] = 0.1 * (double)(i % 20);
		position[3 * i + 1] = 0;
		position[3 * i + 2] = 0.1 * (double)(i / 20);
	}
	double scanner[3] = { 1, 3, 1 };
	gw_viewpoint_wish wish = { .scanner = scanner, .scanner_count = 1 };
	assert_true(find_view(position, 400, wish).at[1] > 0);
	scanner[1] = -3;
	assert_true(find_view(position, 400, wish).at[1] < 0);
}

/* A corner of a room as a depth camera saw it is looked at from there: all of it but one in a
 * hundred (BEYOND) is in the picture. One that turned around saw a room all
 * around it, and a turn of pictures goes around the corner. */
static void test_depth_camera(void **state)
{
	(void)state;
	double position[3 * 3 * 400];
	for (size_t i = 0; i < 400; i++)
		for (size_t face = 0; face < 3; face++) {
			double *p = position + 3 * (400 * face + i);
			p[face] = face == 0 ? -1 : face == 1 ? 1 : 4;
			p[(face + 1) % 3] = 0.1 * (double)(i % 20) + (face == 1 ? 2 : -1);
			p[(face + 2) % 3] = 0.1 * (double)(i / 20) + (face == 0 ? 2 : -1);
		}
	double scanner[6] = { 0 };
	gw_viewpoint_wish wish = { .scanner = scanner, .scanner_count = 1, .up = 'Y' };
	gw_viewpoint v = find_view(position, 1200, wish);
	gw_camera c;
	double up[3];
	assert_true(v.from_scanner);
	assert_memory_equal(v.at, scanner, sizeof v.at);
	gw_camera_up('Y', up);
	assert_int_equal(gw_camera_look(&c, v.at, v.to, up, v.angle, NULL), GW_OK);
	size_t beyond = 0;
	for (size_t i = 0; i < 1200; i++) {
		double view[3];
		gw_camera_turn(&c, position + 3 * i, view);
		assert_true(view[2] > v.near);
		beyond += !(fabs(view[0]) < 1.5 * c.tangent * view[2]);
		beyond += !(fabs(view[1]) < c.tangent * view[2]);
	}
	assert_true(beyond <= 1200 / 100);
	wish.around = true;
	assert_false(find_view(position, 1200, wish).from_scanner);
	wish.around = false;
	wish.scanner_count = 2;
	assert_false(find_view(position, 1200, wish).from_scanner);
}

/* One that looks straight down says nothing of a way to face: a floor around the place below it is
 * looked at as other things are. */
static void test_scanner_above(void **state)
{
	(void)state;
	double position[3 * 21 * 21];
	const double scanner[3] = { 0, 0, 1 };
	for (size_t i = 0; i < 21 * 21; i++) {
		position[3 * i] = 0.05 * ((double)(i % 21) - 10.0);
		position[3 * i + 1] = 0.05 * ((double)(i / 21) - 10.0);
		position[3 * i + 2] = 0.0;
	}
	gw_viewpoint_wish wish = { .scanner = scanner, .scanner_count = 1, .up = 'z' };
	gw_viewpoint v = find_view(position, 21 * 21, wish);
	assert_false(v.from_scanner);
	for (int k = 0; k < 3; k++)
		assert_true(isfinite(v.at[k]) && isfinite(v.to[k]));
}

/* What a scanner saw from high above, at a sine of .96, would be a line at the edge of a picture
 * that is level enough: a strip of ground, all of which a picture from elsewhere shows. From a
 * slope of 45 degrees it lies in the middle of the scanner's own. */
static void test_airborne(void **state)
{
	(void)state;
	double position[3 * 400];
	for (size_t i = 0; i < 400; i++) {
		position[3 * i] = 300 + 4 * (double)(i % 5);
		position[3 * i + 1] = 10 * ((double)(i / 5) - 39.5);
		position[3 * i + 2] = 0;
	}
	double scanner[3] = { 0, 0, 1100 };
	gw_viewpoint_wish wish = { .scanner = scanner, .scanner_count = 1 };
	gw_viewpoint v = find_view(position, 400, wish);
	gw_camera c;
	assert_false(v.from_scanner);
	assert_int_equal(gw_camera_look(&c, v.at, v.to, z_up, v.angle, NULL), GW_OK);
	for (size_t i = 0; i < 400; i++)
		view_point(&c, position + 3 * i);
	scanner[2] = 300;
	assert_true(find_view(position, 400, wish).from_scanner);
}

/* Right-handed for every axis; that of depth cameras is right, down and ahead. */
static void test_stand(void **state)
{
	(void)state;
	for (const char *axis = "xyzXYZ"; *axis; axis++) {
		double r[3], b[3], u[3];
		gw_camera_stand(*axis, r, b, u);
		for (int k = 0; k < 3; k++)
			assert_near(r[(k + 1) % 3] * b[(k + 2) % 3] - r[(k + 2) % 3] * b[(k + 1) % 3], u[k],
						ROUNDING);
	}
	double r[3], b[3], u[3];
	gw_camera_stand('Y', r, b, u);
	assert_true(r[0] == 1 && b[2] == 1 && u[1] == -1);
}

/* Nothing encloses a lone plane, so it is looked at from outside even when inside was asked for. */
static void test_plane(void **state)
{
	(void)state;
	double position[300];
	float normal[300] = { 0 };
	for (size_t i = 0; i < 100; i++) {
		position[3 * i] = (double)(i % 10);
		position[3 * i + 1] = (double)(i / 10);
		position[3 * i + 2] = 0;
		normal[3 * i + 2] = 1;
	}
	gw_points points = { .count = 100, .position = position, .normal = normal };
	gw_surfels_options options = { .threads = 1 };
	gw_surfels s;
	gw_viewpoint v;
	assert_int_equal(gw_surfels_make(&points, &options, &s, NULL), GW_OK);
	assert_int_equal(
		gw_viewpoint_find(
			&s, &(gw_viewpoint_wish){ .kind = GW_VIEWPOINT_INSIDE, .up = 'z', .aspect = 1 }, &v,
			NULL),
		GW_OK);
	assert_false(v.inside);
	assert_true(v.at[2] > 0);
	gw_surfels_clear(&s);
}

/*
 * A camera at the origin looks along y, 90 degrees each way: x = y is the right border of what is
 * seen. A wide disc a metre beyond it counts (4 radii), and so do the narrow ones around it, which
 * are its neighbours; narrow ones elsewhere beyond the border do not.
 */
static void test_choice(void **state)
{
	(void)state;
	float position[] = { 5.4f, 4, 0, 6, 4, 0, 6, 4.2f, 0, 0, 9, 0, 9, -9, 0, 60, 0, 0 };
	float radius[] = { 1, 0.01f, 0.01f, 0.01f, 0.01f, 0.01f };
	const uint8_t expected[] = { 1, 1, 1, 1, 0, 0 };
	const gw_surfels s = { .count = 6,
						   .position = position,
						   .radius = radius,
						   .minimum = { 0, -9, 0 },
						   .maximum = { 60, 9, 0 } };
	gw_viewpoint view = { .to = { 0, 1, 0 }, .angle = 90 };
	const camera_plan plan = { .view = &view, .text_count = 1, .orbit = 1, .up = 'z' };
	uint8_t chosen[6] = { 0 };
	assert_int_equal(camera_plan_choose(&plan, &s, 1.0, chosen, NULL), GW_OK);
	assert_memory_equal(chosen, expected, sizeof expected);
}

/* Points on the six sides of a box, or on those that `sides` names by bits: low and high x, y, z.
 */
static size_t add_sides(double *at, size_t count, const double size[3], unsigned sides)
{
	uint64_t state = 7;
	size_t added = 0;
	for (size_t i = 0; i < count; i++) {
		unsigned side = (unsigned)(i % 6);
		if (!(sides >> side & 1))
			continue;
		for (size_t k = 0; k < 3; k++) {
			state = state * 6364136223846793005u + 1442695040888963407u;
			at[3 * added + k] = size[k] * (double)(state >> 40) * 0x1p-24;
		}
		at[3 * added++ + side / 2] = side % 2 ? size[side / 2] : 0.0;
	}
	return added;
}

/* A statue: a bumpy body above a flat base across an axis. */
static size_t add_statue(double *at, size_t count, size_t axis)
{
	for (size_t i = 0; i < count; i++) {
		double turn = 2.4 * (double)i, height = (double)i / (double)count;
		bool base = i % 12 == 0;
		double radius = base ? 0.3 * height : 0.3 * (1.0 - height * height) + 0.1 * height;
		at[3 * i + axis] = base ? 0.0 : height;
		at[3 * i + (axis + 1) % 3] = radius * cos(turn);
		at[3 * i + (axis + 2) % 3] = 0.8 * radius * sin(turn);
	}
	return count;
}

/* Half of an egg, open across an axis, and a chimney on it. */
static size_t add_half_egg(double *at, size_t count, size_t axis)
{
	for (size_t i = 0; i < count; i++) {
		double turn = 2.4 * (double)i, height = 1.3 * (double)i / (double)count;
		double radius = height < 0.99 ? 0.6 * sqrt(1.0 - height * height) : 0.08;
		at[3 * i + axis] = height;
		at[3 * i + (axis + 1) % 3] = radius * cos(turn);
		at[3 * i + (axis + 2) % 3] = 0.8 * radius * sin(turn);
	}
	return count;
}

/* A box of side 2 of which those sides are there that add_sides names so, and two blocks in it that
 * stand or hang on side `on`, off all others: their ends are as far from it as their height, and
 * off the middle. A fifth of the points is theirs. */
static size_t add_stage(double *at, size_t count, unsigned sides, unsigned on)
{
	const double side[3] = { 2, 2, 2 }, block[2][3] = { { 0.6, 0.6, 0.6 }, { 0.6, 1.2, 0.6 } };
	const double place[2][2] = { { 0.4, 0.5 }, { 1.1, 0.8 } };
	size_t total = add_sides(at, count * 4 / 5, side, sides), up = on / 2;
	for (size_t b = 0; b < 2; b++) {
		double *own = at + 3 * total;
		size_t added = add_sides(own, count / 10, block[b], 0x3f);
		for (size_t i = 0; i < added; i++) {
			double p[3] = { own[3 * i], own[3 * i + 1], own[3 * i + 2] };
			own[3 * i + up] = on % 2 ? 2.0 - p[1] : p[1];
			own[3 * i + (up + 1) % 3] = p[0] + place[b][0];
			own[3 * i + (up + 2) % 3] = p[2] + place[b][1];
		}
		total += added;
	}
	return total;
}

static char likely_up(const double *at, size_t count, bool wanted)
{
	bool sure;
	char up = gw_likely_up(at, count, &sure);
	assert_int_equal(sure, wanted);
	return up;
}

static void test_likely_up(void **state)
{
	(void)state;
	enum { COUNT = 6000 };
	static double at[3 * COUNT];
	const double y_room[3] = { 12, 3, 8 }, z_room[3] = { 12, 8, 3 }, cube[3] = { 2, 2, 2 };
	assert_int_equal(likely_up(at, add_statue(at, COUNT, 1), true), 'y');
	assert_int_equal(likely_up(at, add_statue(at, COUNT, 2), false), 0);
	assert_int_equal(likely_up(at, add_statue(at, COUNT, 0), false), 0);
	assert_int_equal(likely_up(at, add_half_egg(at, COUNT, 1), false), 'y');
	assert_int_equal(likely_up(at, add_half_egg(at, COUNT, 2), false), 0);
	assert_int_equal(likely_up(at, add_half_egg(at, COUNT, 0), false), 0);
	/* All floor and ceiling, and one wall of each pair, as where rooms are large. */
	size_t count = add_sides(at, COUNT / 2, y_room, 0x0c);
	count += add_sides(at + 3 * count, COUNT / 6, y_room, 0x33);
	assert_int_equal(likely_up(at, count, false), 'y');
	count = add_sides(at, COUNT / 2, z_room, 0x30);
	count += add_sides(at + 3 * count, COUNT / 6, z_room, 0x0f);
	assert_int_equal(likely_up(at, count, false), 0);
	assert_int_equal(likely_up(at, add_sides(at, COUNT, cube, 0x3f), false), 0);
	/* A wall is what ground is from above: nothing is said of it, alone or on its ground. */
	assert_int_equal(likely_up(at, add_sides(at, COUNT, z_room, 0x04), false), 0);
	assert_int_equal(likely_up(at, add_sides(at, COUNT, z_room, 0x14), false), 0);
	assert_int_equal(likely_up(at, 10, false), 0);
	at[4] = INFINITY;
	at[8] = NAN;
	assert_int_equal(likely_up(at, COUNT, false), 0);
	memset(at, 0, sizeof at);
	assert_int_equal(likely_up(at, COUNT, false), 0);
}

/* What stands in a box tells where its floor is, whichever side is open; not what hangs below the
 * ceiling, or stands nowhere near a side, or near several of them. */
static void test_up_of_stage(void **state)
{
	(void)state;
	enum { COUNT = 6000, LOW_Y = 2 };
	static double at[3 * COUNT];
	for (unsigned open = 0; open < 6; open++)
		for (unsigned on = 0; on < 6; on++)
			if (open != on)
				assert_int_equal(
					likely_up(at, add_stage(at, COUNT, 0x3f & ~(1u << open), on), false),
					on == LOW_Y ? 'y' : 0);
	const double side[3] = { 2, 2, 2 };
	assert_int_equal(likely_up(at, add_sides(at, COUNT, side, 0x2f), false), 0);
	/* Two walls, a floor and a ceiling are no box: such floors may be the walls of a corridor. */
	assert_int_equal(likely_up(at, add_stage(at, COUNT, 0x0f, LOW_Y), false), 0);
	size_t count = add_stage(at, COUNT, 0x1f, LOW_Y);
	for (size_t i = count - COUNT / 10; i < count; i++)
		at[3 * i + 2] -= 1.1;
	assert_int_equal(likely_up(at, count, false), 0);
	count = add_stage(at, COUNT, 0x1f, LOW_Y);
	for (size_t i = count - 2 * (COUNT / 10); i < count; i++)
		at[3 * i + 1] += 0.4;
	assert_int_equal(likely_up(at, count, false), 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_likely_up),
		cmocka_unit_test(test_up_of_stage),
		cmocka_unit_test(test_axes),
		cmocka_unit_test(test_orbit),
		cmocka_unit_test(test_bad_cameras),
		cmocka_unit_test(test_balls_in_view),
		cmocka_unit_test(test_enclosure),
		cmocka_unit_test(test_inside_and_outside),
		cmocka_unit_test(test_plane),
		cmocka_unit_test(test_size_for_people),
		cmocka_unit_test(test_ball),
		cmocka_unit_test(test_stage),
		cmocka_unit_test(test_lit_within),
		cmocka_unit_test(test_scanned_room),
		cmocka_unit_test(test_fence_is_no_room),
		cmocka_unit_test(test_strays),
		cmocka_unit_test(test_around),
		cmocka_unit_test(test_scanner_side),
		cmocka_unit_test(test_depth_camera),
		cmocka_unit_test(test_scanner_above),
		cmocka_unit_test(test_airborne),
		cmocka_unit_test(test_stand),
		cmocka_unit_test(test_choice),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

/* The rasteriser against closed forms: areas, depths, order, holes, and bytes of several threads.
 */
#include "glowworm_picture.h"
#include "picture/raster_steps.h"
#include "cloud/surfels.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const double pi = 3.14159265358979323846;

/* A scene of discs with one channel, in a frame far from 0. */
typedef struct discs {
	float *position, *normal, *radius, *channel;
	gw_raster_scene scene;
} discs;

static discs make_discs(size_t count)
{
	discs d = { calloc(3 * count, sizeof(float)),
				calloc(3 * count, sizeof(float)),
				calloc(count, sizeof(float)),
				calloc(count, sizeof(float)),
				{ .origin = { 0 } } };
	d.scene = (gw_raster_scene){ .origin = { 500000, 4000000, 100 },
								 .discs = { .count = count,
											.position = d.position,
											.normal = d.normal,
											.radius = d.radius,
											.channel = d.channel },
								 .channel_count = 1 };
	return d;
}

static void free_discs(discs *d)
{
	free(d->position);
	free(d->normal);
	free(d->radius);
	free(d->channel);
}

static void set_disc(discs *d, size_t i, const float place[3], float radius, float value)
{
	for (size_t k = 0; k < 3; k++)
		d->position[3 * i + k] = place[k];
	d->normal[3 * i + 1] = -1; /* towards the camera, which looks along y */
	d->radius[i] = radius;
	d->channel[i] = value;
}

/* Stands at the frame's origin and looks along y; 90 degrees, so that the picture's half height is
 * 1 at distance 1. */
static gw_camera look_along_y(void)
{
	const double at[3] = { 500000, 4000000, 100 }, to[3] = { 500000, 4000001, 100 };
	const double up[3] = { 0, 0, 1 };
	gw_camera c;
	assert_int_equal(gw_camera_look(&c, at, to, up, 90, NULL), GW_OK);
	c.near = 1e-3;
	return c;
}

static gw_gbuffer draw(const gw_raster_scene *scene, uint32_t side, uint32_t samples,
					   uint32_t threads, bool cull)
{
	gw_camera camera = look_along_y();
	gw_raster_options options = { .width = side,
								  .height = side,
								  .samples = samples,
								  .radius_scale = 1,
								  .cull = cull,
								  .threads = threads };
	gw_gbuffer g;
	gw_error error = { 0 };
	if (gw_raster_draw(scene, &camera, &options, &g, &error) != GW_OK)
		fail_msg("%s", error.text);
	return g;
}

static double covered_area(const gw_gbuffer *g)
{
	double sum = 0;
	for (size_t i = 0; i < (size_t)g->width * g->height; i++)
		sum += (double)g->coverage[i];
	return sum;
}

/* A disc of radius 0.5 at distance 2 has a radius of 50 of 200 / 2 pixels * 0.25. The error of
 * counting the points of a grid in a circle is below 2 sqrt(2) pi r (Gauss), in units of a sample's
 * area; for 3 x 3 samples the circle is 3 times as large and a sample 1/9. */
static void test_area_of_disc(void **state)
{
	(void)state;
	for (uint32_t samples = 1; samples <= 3; samples += 2) {
		discs d = make_discs(1);
		set_disc(&d, 0, (float[]){ 0.013f, 2, 0.007f }, 0.5f, 3);
		gw_gbuffer g = draw(&d.scene, 400, samples, 1, false);
		double r = 50 * samples, bound = 2 * sqrt(2.0) * pi * r / (samples * samples);
		double area = covered_area(&g);
		if (!(fabs(area - pi * 50 * 50) <= bound))
			fail_msg("%g pixels, not %g +- %g", area, pi * 50 * 50, bound);
		size_t middle = 200 * 400 + 200;
		assert_true(fabs((double)g.depth[middle] - 2) < 1e-6);
		assert_true(fabs((double)g.channel[middle] - 3) < 1e-5);
		assert_true(fabs((double)g.normal[3 * middle + 1] + 1) < 1e-6);
		assert_int_equal(g.id[middle], 0);
		assert_int_equal(g.id[0], GW_RASTER_NOTHING);
		assert_true(isinf(g.depth[0]));
		gw_gbuffer_clear(&g);
		free_discs(&d);
	}
}

/* Turned by 60 degrees about the vertical it covers about half as much: the outline of a small disc
 * is an ellipse of area pi r^2 cos 60, but for perspective, which is of second order in r / z. */
static void test_area_of_tilted_disc(void **state)
{
	(void)state;
	discs d = make_discs(1);
	set_disc(&d, 0, (float[]){ 0, 4, 0 }, 0.4f, 1);
	d.normal[0] = sinf((float)pi / 3);
	d.normal[1] = -0.5f;
	gw_gbuffer g = draw(&d.scene, 1000, 1, 1, false);
	double r = 0.4 / 4 * 500, expected = 0.5 * pi * r * r;
	double bound = 2 * sqrt(2.0) * pi * r + expected * 0.1 * 0.1 * 3;
	if (!(fabs(covered_area(&g) - expected) <= bound))
		fail_msg("%g pixels, not %g +- %g", covered_area(&g), expected, bound);
	gw_gbuffer_clear(&g);
	free_discs(&d);
}

/* The nearer one is seen, in whichever order they come; what is beside it is seen behind it. */
static void test_depth_order(void **state)
{
	(void)state;
	for (size_t near = 0; near < 2; near++) {
		discs d = make_discs(2);
		set_disc(&d, near, (float[]){ 0, 2, 0 }, 0.2f, 7);
		set_disc(&d, 1 - near, (float[]){ 0, 3, 0 }, 1, 5);
		gw_gbuffer g = draw(&d.scene, 100, 2, 1, false);
		assert_int_equal(g.id[50 * 100 + 50], near);
		assert_true(fabs((double)g.channel[50 * 100 + 50] - 7) < 1e-4);
		assert_int_equal(g.id[50 * 100 + 62], 1 - near);
		assert_true(fabs((double)g.channel[50 * 100 + 62] - 5) < 1e-4);
		gw_gbuffer_clear(&g);
		free_discs(&d);
	}
}

#define PLATE 41 /* discs a side of a plate */

/* Plates one behind the other, each of overlapping discs that scatter about it by less than they
 * are one surface, in any order; the last one is half as wide, and its edge in the picture. */
static discs make_plates(size_t plates, const float *opacity, const float *value, float *clear)
{
	discs d = make_discs(plates * PLATE * PLATE);
	uint32_t random = 7;
	for (size_t i = 0; i < d.scene.discs.count; i++) {
		size_t plate = i % plates, at = i / plates;
		random = random * 1664525u + 1013904223u;
		float shift = ((float)(random >> 8) / 16777216.0f - 0.5f) * 0.01f;
		float step = plate + 1 == plates ? 0.05f : 0.1f;
		set_disc(&d, i,
				 (float[]){ ((float)(at % PLATE) - PLATE / 2) * step,
							2 + 0.3f * (float)plate + shift,
							((float)(at / PLATE) - PLATE / 2) * step },
				 1.6f * step, value[plate]);
		clear[i] = 1 - opacity[plate];
	}
	d.scene.discs.transparency = clear;
	return d;
}

/* One plate over a background, two and three: front to back, each once. At the picture's edge there
 * are all but the last. Weighted means cancel to some rounding. */
static void test_plates_blend(void **state)
{
	(void)state;
	const float opacity[] = { 0.5f, 0.3f, 0.8f }, value[] = { 4, 10, 2 };
	for (size_t plates = 1; plates <= 3; plates++) {
		float *clear = malloc(plates * PLATE * PLATE * sizeof *clear);
		discs d = make_plates(plates, opacity, value, clear);
		gw_gbuffer g = draw(&d.scene, 120, 2, 1, false), again = draw(&d.scene, 120, 2, 3, false);
		double alpha[2] = { 0, 0 }, sum[2] = { 0, 0 }, left = 1;
		for (size_t i = 0; i < plates; i++) {
			for (size_t at = 0; at < 2 && (at == 0 || i + 1 < plates); at++) {
				alpha[at] += left * (double)opacity[i];
				sum[at] += left * (double)(opacity[i] * value[i]);
			}
			left *= 1 - (double)opacity[i];
		}
		for (size_t at = 0; at < (plates > 1 ? 2u : 1u); at++)
			for (size_t y = 52; y < 68; y++)
				for (size_t x = at ? 4 : 52; x < (at ? 10 : 68); x++) {
					size_t i = y * 120 + x;
					assert_true(fabs((double)g.coverage[i] - alpha[at]) < 1e-5);
					assert_true(fabs((double)g.channel[i] - sum[at] / alpha[at]) < 1e-4);
					assert_true(fabs((double)g.depth[i] - 2) < 0.01);
				}
		assert_memory_equal(g.coverage, again.coverage, 120 * 120 * sizeof(float));
		assert_memory_equal(g.channel, again.channel, 120 * 120 * sizeof(float));
		gw_gbuffer_clear(&g);
		gw_gbuffer_clear(&again);
		free_discs(&d);
		free(clear);
	}
}

/* All opaque, the same picture as without transparencies, but for roundings of means. */
static void test_opaque_is_opaque(void **state)
{
	(void)state;
	const float opacity[] = { 1, 1 }, value[] = { 4, 10 };
	float *clear = malloc(2 * PLATE * PLATE * sizeof *clear);
	discs d = make_plates(2, opacity, value, clear);
	gw_gbuffer with = draw(&d.scene, 90, 2, 1, false);
	d.scene.discs.transparency = NULL;
	gw_gbuffer without = draw(&d.scene, 90, 2, 1, false);
	for (size_t i = 0; i < 90 * 90; i++) {
		assert_true(fabs((double)(with.channel[i] - without.channel[i])) < 1e-5);
		assert_true(with.coverage[i] == without.coverage[i] && with.id[i] == without.id[i]);
	}
	gw_gbuffer_clear(&with);
	gw_gbuffer_clear(&without);
	free_discs(&d);
	free(clear);
}

/* A plane of 101 x 101 discs, 0.05 apart, each with the radius of a spacing, which the outermost
 * ones reach over the picture's edge; and one channel that is constant. */
static discs make_plane(float distance, float jitter)
{
	discs d = make_discs(101 * 101);
	uint32_t random = 1;
	for (size_t i = 0; i < 101 * 101; i++) {
		random = random * 1664525u + 1013904223u;
		float shift = ((float)(random >> 8) / 16777216.0f - 0.5f) * jitter;
		set_disc(&d, i,
				 (float[]){ ((float)(i % 101) - 50) * 0.05f, distance + shift,
							((float)(i / 101) - 50) * 0.05f },
				 0.05f, 2);
	}
	return d;
}

/* No holes, and no seams in what is constant: weights cancel to some rounding. */
static void test_plane_has_no_holes(void **state)
{
	(void)state;
	discs d = make_plane(2, 0);
	gw_gbuffer g = draw(&d.scene, 300, 2, 2, false);
	for (size_t i = 0; i < 300 * 300; i++) {
		if (!(g.coverage[i] == 1.0f && fabsf(g.channel[i] - 2) < 1e-5f &&
			  fabsf(g.depth[i] - 2) < 1e-5f))
			fail_msg("pixel %zu: coverage %g, channel %g, depth %g", i, (double)g.coverage[i],
					 (double)g.channel[i], (double)g.depth[i]);
	}
	gw_gbuffer_clear(&g);
	free_discs(&d);
}

/* How much of a picture is open where discs of rows and columns are missing from the plane, which
 * from the last such row on lies further off by a step. */
static double open_area(size_t rows, size_t columns, float step, float radius_scale)
{
	discs d = make_plane(2, 0);
	for (size_t i = 0; i < 101 * 101; i++) {
		size_t row = i / 101, column = i % 101;
		d.position[3 * i + 1] += row >= 40 + rows ? step : 0.0f;
		if (row >= 40 && row < 40 + rows && column >= 50 - columns / 2 && column < 50 + columns / 2)
			d.position[3 * i + 1] = -2;
	}
	gw_camera camera = look_along_y();
	gw_raster_options options = {
		.width = 300, .height = 300, .samples = 1, .radius_scale = radius_scale, .threads = 1
	};
	gw_gbuffer g;
	assert_int_equal(gw_raster_draw(&d.scene, &camera, &options, &g, NULL), GW_OK);
	double area = 300.0 * 300.0 - covered_area(&g);
	for (size_t i = 0; i < 300 * 300; i++)
		assert_true(g.coverage[i] == 0.0f || step > 0.0f ||
					(fabsf(g.channel[i] - 2) < 1e-5f && fabsf(g.depth[i] - 2) < 1e-5f &&
					 fabsf(g.normal[3 * i + 1] + 1) < 1e-5f));
	gw_gbuffer_clear(&g);
	free_discs(&d);
	return area;
}

/* Between lines of points 3 radii off each other the surface goes on. It does not in a window of
 * some 7 radii, nor where it goes on elsewhere; and discs that are drawn smaller than the surface
 * are to be seen apart. A radius is 3.75 pixels. */
static void test_lines_of_points(void **state)
{
	(void)state;
	assert_true(open_area(4, 60, 0, 1) == 0.0);
	assert_true(open_area(8, 8, 0, 1) > 6 * 6 * 3.75 * 3.75);
	assert_true(open_area(4, 60, 0.3f, 1) > 60 * 2 * 3.75 * 3.75);
	assert_true(open_area(4, 60, 0, 0.4f) > 60 * 3 * 3.75 * 3.75);
}

/* How many pixels show anything of a plane that lies behind a square hole, so many discs wide, in
 * the one before it. */
static size_t pixels_behind(size_t hole, uint32_t samples)
{
	discs near = make_plane(2, 0), d = make_discs(2 * 101 * 101);
	for (size_t i = 0; i < 101 * 101; i++) {
		const float *p = near.position + 3 * i;
		size_t row = i / 101, column = i % 101, first = 50 - hole / 2;
		bool missing =
			row >= first && row < first + hole && column >= first && column < first + hole;
		set_disc(&d, i, (float[]){ p[0], missing ? -2 : p[1], p[2] }, 0.05f, 2);
		set_disc(&d, 101 * 101 + i, (float[]){ 2 * p[0], 4, 2 * p[2] }, 0.1f, 5);
	}
	gw_gbuffer g = draw(&d.scene, 300, samples, 1, false);
	size_t count = 0;
	for (size_t i = 0; i < 300 * 300; i++) {
		assert_true(g.coverage[i] == 1.0f);
		count += fabsf(g.channel[i] - 2) >= 1e-5f;
	}
	gw_gbuffer_clear(&g);
	free_discs(&near);
	free_discs(&d);
	return count;
}

/* What lies behind holes up to 3 radii wide is not seen, nor in pixels at their rims that show some
 * of both; that behind a window of 7 radii is. */
static void test_specks(void **state)
{
	(void)state;
	for (size_t hole = 2; hole <= 4; hole++)
		for (uint32_t samples = 1; samples <= 2; samples++)
			assert_int_equal(pixels_behind(hole, samples), 0);
	assert_true((double)pixels_behind(8, 1) > 6 * 6 * 3.75 * 3.75);
}

/* Of half a spacing's noise nothing is seen through either. */
static void test_noisy_plane_has_no_holes(void **state)
{
	(void)state;
	discs d = make_plane(2, 0.025f);
	gw_gbuffer g = draw(&d.scene, 300, 1, 1, false);
	assert_true(covered_area(&g) == 300.0 * 300.0);
	gw_gbuffer_clear(&g);
	free_discs(&d);
}

/* Discs that are cut where the surface goes on leave holes, which are filled from beyond the cut;
 * but with nothing on the other side the cut is the surface's edge. */
static void test_holes_are_filled(void **state)
{
	(void)state;
	discs d = make_plane(2, 0);
	float *clip = calloc(6 * 101 * 101, sizeof *clip);
	for (size_t i = 0; i < 101 * 101; i++)
		if (i % 101 >= 48 && i % 101 <= 52 && i / 101 >= 48 && i / 101 <= 52) {
			clip[6 * i] = 1;
			clip[6 * i + 2] = -0.04f;
		}
	d.scene.discs.clip = clip;
	gw_gbuffer g = draw(&d.scene, 300, 1, 1, false);
	assert_true(covered_area(&g) == 300.0 * 300.0);
	gw_gbuffer_clear(&g);
	/* Without the others, nothing is seen to the right of what is left of the 25. */
	for (size_t i = 0; i < 101 * 101; i++)
		if (clip[6 * i] == 0.0f)
			d.position[3 * i + 1] = -2;
	g = draw(&d.scene, 300, 1, 1, false);
	double area = covered_area(&g);
	assert_true(area > 0 && area < 0.5 * 25 * pi * 3.75 * 3.75);
	gw_gbuffer_clear(&g);
	free(clip);
	free_discs(&d);
}

#define SLOT_SIDE 161

/* What is missing of a solid surface: a slot 24 wide and 60 long, one end of which leads out into
 * the open, or all that lies between two edges at a right angle. */
typedef struct gap {
	double angle; /* by which all of it is turned */
	bool corner;
} gap;

static void lay_gap(const gap *what, double x, double y, gw_raster_cover *cover)
{
	double along = x * cos(what->angle) + y * sin(what->angle);
	double across = y * cos(what->angle) - x * sin(what->angle);
	bool missing = what->corner ? along > -20 && across > -20
								: fabs(across) < 12 && along > -30 && along <= 30;
	bool open = what->corner ? missing && hypot(along, across) > 60 : !missing && along > 30;
	bool outside = hypot(along, across) > 75;
	cover->sure = !missing && !open && !outside;
	cover->beyond = missing && !open;
}

/* How many pixels of it are closed, of how many. */
static size_t close_gap(gap what, size_t *missing)
{
	size_t pixels = SLOT_SIDE * SLOT_SIDE, closed = 0;
	gw_raster_cover *cover = calloc(pixels, sizeof *cover);
	gw_gbuffer g = { .width = SLOT_SIDE, .height = SLOT_SIDE };
	g.coverage = calloc(pixels, sizeof *g.coverage);
	g.depth = calloc(pixels, sizeof *g.depth);
	g.facing = calloc(pixels, sizeof *g.facing);
	g.id = calloc(pixels, sizeof *g.id);
	g.normal = calloc(3 * pixels, sizeof *g.normal);
	for (size_t i = 0; i < pixels; i++)
		lay_gap(&what, (double)(i % SLOT_SIDE) - 80, (double)(i / SLOT_SIDE) - 80, cover + i);
	for (size_t i = 0; i < pixels; i++)
		g.coverage[i] = 1.0f;
	const gw_raster_options options = { .samples = 1 };
	const gw_raster_view view = { .options = &options };
	assert_int_equal(gw_raster_holes_close(&view, cover, &g, NULL), GW_OK);
	*missing = 0;
	for (size_t i = 0; i < pixels; i++) {
		*missing += cover[i].beyond;
		closed += cover[i].beyond && g.coverage[i] > 0.0f;
	}
	free(cover);
	gw_gbuffer_clear(&g);
	return closed;
}

/* Which holes are closed does not depend on how they lie to rows and columns: of a slot the inner
 * part is, more than half; between two edges at a right angle, which no five of eight lines cross,
 * nothing but what roundings of the edges to pixels make. */
static void test_holes_are_no_boxes(void **state)
{
	(void)state;
	for (int turn = 0; turn < 32; turn++) {
		size_t missing, closed = close_gap((gap){ pi * turn / 16, false }, &missing);
		if (!(2 * closed > missing))
			fail_msg("turn %d: %zu of %zu of a slot are closed", turn, closed, missing);
		closed = close_gap((gap){ pi * turn / 16, true }, &missing);
		if (!(50 * closed < missing))
			fail_msg("turn %d: %zu of %zu of a corner are closed", turn, closed, missing);
	}
}

/* Where a surface ends and nothing follows, what discs reach beyond their cuts stays out, wherever
 * the picture's tiles begin: the cut is at pixel 188.25, the discs end at 193.5, and a tile at 192.
 * Only pixels whose middle is inside are covered. */
static void test_edges_end_within_tiles(void **state)
{
	(void)state;
	discs d = make_plane(2, 0);
	float *clip = calloc(6 * 101 * 101, sizeof *clip);
	for (size_t i = 0; i < 101 * 101; i++) {
		d.radius[i] = 0.08f;
		float tangent[3], bitangent[3], x = ((float)(i % 101) - 50) * 0.05f;
		gw_tangent_frame(d.normal + 3 * i, tangent, bitangent);
		clip[6 * i] = tangent[0];
		clip[6 * i + 1] = bitangent[0];
		clip[6 * i + 2] = 0.51f - x;
		if (x > 0.51f)
			d.position[3 * i + 1] = -2;
	}
	d.scene.discs.clip = clip;
	gw_gbuffer g = draw(&d.scene, 300, 1, 1, false);
	for (size_t i = 0; i < 300 * 300; i++) {
		bool inside = i % 300 < 188;
		if ((g.coverage[i] > 0.0f) != inside)
			fail_msg("pixel %zu, %zu has coverage %g", i % 300, i / 300, (double)g.coverage[i]);
		assert_true((g.id[i] == GW_RASTER_NOTHING) != inside);
	}
	gw_gbuffer_clear(&g);
	free(clip);
	free_discs(&d);
}

/* Of a box that stands on a floor, the floor is seen and not the box's bottom, though they lie at
 * the same place but for noise of a fifth of a radius; seen from behind, a surface keeps its depth.
 */
static void test_fronts_hide_backs(void **state)
{
	(void)state;
	discs d = make_discs(2 * 101 * 101), floor = make_plane(2, 0.01f),
		  bottom = make_plane(2, 0.02f);
	for (size_t i = 0; i < 101 * 101; i++) {
		for (size_t k = 0; k < 3; k++) {
			d.position[6 * i + k] = floor.position[3 * i + k];
			d.position[6 * i + 3 + k] = bottom.position[3 * i + k];
		}
		d.normal[6 * i + 1] = -1;
		d.normal[6 * i + 4] = 1;
		d.radius[2 * i] = d.radius[2 * i + 1] = 0.05f;
		d.channel[2 * i] = 2;
		d.channel[2 * i + 1] = 9;
	}
	gw_gbuffer g = draw(&d.scene, 300, 1, 1, false);
	for (size_t i = 0; i < 300 * 300; i++)
		if (!(fabsf(g.channel[i] - 2) < 1e-5f))
			fail_msg("pixel %zu shows %g", i, (double)g.channel[i]);
	gw_gbuffer_clear(&g);
	for (size_t i = 0; i < 101 * 101; i++)
		floor.normal[3 * i + 1] = 1;
	g = draw(&floor.scene, 300, 1, 1, false);
	for (size_t i = 0; i < 300 * 300; i++)
		assert_true(fabsf(g.depth[i] - 2) <= 0.0051f);
	gw_gbuffer_clear(&g);
	free_discs(&d);
	free_discs(&floor);
	free_discs(&bottom);
}

/* A ridge towards the camera, whose sides are turned by 60 degrees: both are seen at a cosine of
 * 1/2, and so is the pixel in which they meet, where the mean normal looks straight at the camera.
 * Rays are up to half a pixel, 1 / 201, beside the axis, which changes a cosine by at most that. */
static void test_facing_of_a_ridge(void **state)
{
	(void)state;
	const float t = sqrtf(3);
	const float position[18] = { 0, 2, -1, 0, 2, 1, -1, 2 + t, 0, 0, 2, -1, 1, 2 + t, 0, 0, 2, 1 };
	const float channel[6] = { 1, 1, 1, 1, 1, 1 };
	const uint32_t index[6] = { 0, 1, 2, 3, 4, 5 };
	gw_raster_scene scene = { .origin = { 500000, 4000000, 100 },
							  .triangles = { .count = 2,
											 .vertex_count = 6,
											 .index = index,
											 .position = position,
											 .channel = channel },
							  .channel_count = 1 };
	gw_gbuffer g = draw(&scene, 201, 2, 1, false);
	size_t middle = 100 * 201 + 100;
	assert_true(g.coverage[middle] == 1.0f);
	assert_true(g.normal[3 * middle + 1] < -0.99f);
	assert_true(fabs((double)g.facing[middle] - 0.5) < 1.0 / 201);
	gw_gbuffer_clear(&g);
}

/* Nearer than the near plane, behind the camera, and through the near plane: a floor 0.1 below the
 * camera, one disc of radius 50 around it, fills the lower half of the picture and no more. */
static void test_near_plane(void **state)
{
	(void)state;
	discs d = make_discs(3);
	set_disc(&d, 0, (float[]){ 0, 0, -0.1f }, 50, 1);
	d.normal[1] = 0;
	d.normal[2] = 1;
	set_disc(&d, 1, (float[]){ 0, -2, 0 }, 0.5f, 9);
	set_disc(&d, 2, (float[]){ 0, 0.0005f, 0 }, 0.0001f, 9);
	gw_gbuffer g = draw(&d.scene, 200, 1, 1, false);
	/* The horizon of the disc is 0.1 / 50 below the middle, a fifth of a pixel. */
	for (size_t y = 0; y < 200; y++)
		for (size_t x = 0; x < 200; x++) {
			bool floor = y >= 100;
			assert_true((g.coverage[y * 200 + x] == 1.0f) == floor);
			assert_true(g.id[y * 200 + x] == (floor ? 0 : GW_RASTER_NOTHING));
			if (floor) {
				double depth = 0.1 / (((double)y + 0.5 - 100) / 100);
				assert_true(fabs((double)g.depth[y * 200 + x] / depth - 1) < 1e-4);
			}
		}
	gw_gbuffer_clear(&g);
	free_discs(&d);
}

/* Discs a hundredth of a pixel large do not vanish: each covers at least one sample, and at most
 * the four that a circle of the widened radius can hold. */
static void test_small_discs_stay(void **state)
{
	(void)state;
	discs d = make_discs(100);
	for (size_t i = 0; i < 100; i++)
		set_disc(
			&d, i,
			(float[]){ ((float)(i % 10) - 4.37f) * 0.17f, 1, ((float)(i / 10) - 4.61f) * 0.173f },
			0.0001f, 1);
	gw_gbuffer g = draw(&d.scene, 200, 2, 1, false);
	double area = covered_area(&g);
	if (!(area >= 100 * 0.25 && area <= 100))
		fail_msg("100 small discs cover %g pixels", area);
	assert_int_equal(g.drawn, 100);
	gw_gbuffer_clear(&g);
	free_discs(&d);
}

/* Of two small discs in one sample each counts by its area: 1 to 9. */
static void test_small_discs_are_weighted(void **state)
{
	(void)state;
	discs d = make_discs(2);
	set_disc(&d, 0, (float[]){ 0.005f, 1, 0.005f }, 0.0001f, 0);
	set_disc(&d, 1, (float[]){ 0.005f, 1, 0.005f }, 0.0003f, 1);
	gw_gbuffer g = draw(&d.scene, 200, 1, 1, false);
	size_t pixel = 99 * 200 + 100;
	if (!(fabsf(g.channel[pixel] - 0.9f) < 1e-4f))
		fail_msg("mean %g, coverage %g", (double)g.channel[pixel], (double)g.coverage[pixel]);
	gw_gbuffer_clear(&g);
	free_discs(&d);
}

/* The rim of a lone disc gives way to a solid surface behind it, but not to nothing. */
static void test_thin_rims(void **state)
{
	(void)state;
	discs d = make_plane(3, 0);
	set_disc(&d, 0, (float[]){ 0, 2, 0 }, 0.5f, 9);
	gw_gbuffer g = draw(&d.scene, 200, 1, 1, false);
	assert_true(fabsf(g.channel[100 * 200 + 100] - 9) < 1e-3f);
	assert_true(fabsf(g.channel[100 * 200 + 124] - 2) < 1e-3f); /* 0.97 of the radius of 25 */
	gw_gbuffer_clear(&g);
	d.scene.discs.count = 1;
	g = draw(&d.scene, 200, 1, 1, false);
	assert_true(fabsf(g.channel[100 * 200 + 124] - 9) < 1e-3f);
	gw_gbuffer_clear(&g);
	free_discs(&d);
}

/* A half-plane clips a disc to half of its area. */
static void test_clip(void **state)
{
	(void)state;
	discs d = make_discs(1);
	float clip[6] = { 1, 0, 0, 0, 0, 0 };
	set_disc(&d, 0, (float[]){ 0, 2, 0 }, 0.5f, 3);
	d.scene.discs.clip = clip;
	gw_gbuffer g = draw(&d.scene, 400, 1, 1, false);
	double expected = 0.5 * pi * 50 * 50;
	if (!(fabs(covered_area(&g) - expected) <= 2 * sqrt(2.0) * pi * 50))
		fail_msg("%g pixels, not %g", covered_area(&g), expected);
	gw_gbuffer_clear(&g);
	free_discs(&d);
}

/* Seen from behind it is left out on request, unless its two sides are the same. */
static void test_cull(void **state)
{
	(void)state;
	discs d = make_discs(1);
	const uint8_t both[1] = { 1 };
	set_disc(&d, 0, (float[]){ 0, 2, 0 }, 0.5f, 3);
	d.normal[1] = 1;
	gw_gbuffer g = draw(&d.scene, 50, 1, 1, false);
	assert_int_equal(g.id[25 * 50 + 25], 0);
	assert_true(g.normal[3 * (25 * 50 + 25) + 1] > 0.999f);
	gw_gbuffer_clear(&g);
	g = draw(&d.scene, 50, 1, 1, true);
	assert_int_equal(g.drawn, 0);
	gw_gbuffer_clear(&g);
	d.scene.discs.two_sided = both;
	g = draw(&d.scene, 50, 1, 1, true);
	assert_true(g.normal[3 * (25 * 50 + 25) + 1] < -0.999f);
	gw_gbuffer_clear(&g);
	free_discs(&d);
}

/* A square of two triangles at distance 2, from -1 to 1, with a linear channel: area exactly that
 * of the samples inside, channel linear in space although the square is tilted, no seam. */
static void test_triangles(void **state)
{
	(void)state;
	const float position[12] = { -1, 2, -1, 1, 4, -1, 1, 4, 1, -1, 2, 1 };
	const float channel[4] = { -1, 1, 1, -1 };
	const uint32_t index[6] = { 0, 1, 2, 0, 2, 3 };
	gw_raster_scene scene = { .origin = { 500000, 4000000, 100 },
							  .triangles = { .count = 2,
											 .vertex_count = 4,
											 .index = index,
											 .position = position,
											 .channel = channel },
							  .channel_count = 1 };
	gw_gbuffer g = draw(&scene, 200, 1, 2, false);
	for (size_t y = 0; y < 200; y++)
		for (size_t x = 0; x < 200; x++) {
			/* The ray (s, 1, t) meets y = 3 + x at depth 3 / (1 - s), x = s depth. */
			double s = ((double)x + 0.5 - 100) / 100, t = (100 - (double)y - 0.5) / 100;
			double depth = 3 / (1 - s), at_x = s * depth, at_z = t * depth;
			size_t i = y * 200 + x;
			double edge = fmax(fabs(at_x), fabs(at_z));
			/* Nobody knows on which side of an edge rounding puts a sample that lies on it. */
			if (fabs(edge - 1) < 1e-5)
				continue;
			assert_true((g.coverage[i] > 0) == (edge < 1));
			if (edge < 1) {
				assert_true(fabs((double)g.channel[i] - at_x) < 1e-5);
				assert_true(fabs((double)g.depth[i] - depth) < 1e-5);
				/* The front is where corners run counterclockwise: towards the camera. */
				assert_true(g.normal[3 * i + 1] < 0);
			}
		}
	gw_gbuffer_clear(&g);
	g = draw(&scene, 200, 1, 1, true);
	assert_int_equal(g.drawn, 2);
	gw_gbuffer_clear(&g);
}

/* A triangle hides a disc behind it, and is hidden by one before it. */
static void test_triangle_and_discs(void **state)
{
	(void)state;
	discs d = make_discs(2);
	set_disc(&d, 0, (float[]){ -0.5f, 2, 0 }, 0.1f, 1);
	set_disc(&d, 1, (float[]){ 0.5f, 4, 0 }, 0.1f, 2);
	const float position[9] = { -9, 3, -9, 9, 3, -9, 0, 3, 9 }, channel[3] = { 5, 5, 5 };
	const uint32_t index[3] = { 0, 1, 2 };
	d.scene.triangles = (gw_raster_triangles){ 1, 3, index, position, NULL, channel };
	gw_gbuffer g = draw(&d.scene, 200, 1, 1, false);
	assert_int_equal(g.id[100 * 200 + 75], 0);
	assert_int_equal(g.id[100 * 200 + 112], 2);
	assert_true(g.channel[100 * 200 + 112] == 5.0f);
	gw_gbuffer_clear(&g);
	free_discs(&d);
}

/* The same bytes for one thread, two and five. */
static void test_threads(void **state)
{
	(void)state;
	discs d = make_plane(2, 0.2f);
	gw_gbuffer one = draw(&d.scene, 233, 2, 1, false);
	for (uint32_t threads = 2; threads <= 5; threads += 3) {
		gw_gbuffer g = draw(&d.scene, 233, 2, threads, false);
		size_t pixels = 233 * 233;
		assert_memory_equal(g.coverage, one.coverage, pixels * sizeof(float));
		assert_memory_equal(g.depth, one.depth, pixels * sizeof(float));
		assert_memory_equal(g.normal, one.normal, pixels * 3 * sizeof(float));
		assert_memory_equal(g.channel, one.channel, pixels * sizeof(float));
		assert_memory_equal(g.id, one.id, pixels * sizeof(uint32_t));
		gw_gbuffer_clear(&g);
	}
	gw_gbuffer_clear(&one);
	free_discs(&d);
}

static void expect_refused(const gw_raster_scene *scene, uint32_t width, uint32_t samples)
{
	gw_camera camera = look_along_y();
	gw_raster_options options = {
		.width = width, .height = 10, .samples = samples, .radius_scale = 1, .threads = 1
	};
	gw_gbuffer g;
	assert_int_equal(gw_raster_draw(scene, &camera, &options, &g, NULL), GW_ERROR_USAGE);
	assert_null(g.depth);
}

/* Sizes outside of the limits are refused; a scene of nothing is an empty picture. */
static void test_limits(void **state)
{
	(void)state;
	gw_raster_scene nothing = { .channel_count = 0 };
	expect_refused(&nothing, 0, 1);
	expect_refused(&nothing, GW_RASTER_SIZE_MAX + 1, 1);
	expect_refused(&nothing, 10, 0);
	expect_refused(&nothing, 10, GW_RASTER_SAMPLES_MAX + 1);
	gw_gbuffer g = draw(&nothing, 10, GW_RASTER_SAMPLES_MAX, 1, false);
	assert_true(covered_area(&g) == 0.0);
	gw_gbuffer_clear(&g);
}

/* Two discs side by side, one of which glows: where both are, the nearer one's value stands alone,
 * so that the border lies in the middle. Neither is blended into the other. */
static void test_glowing_discs_end(void **state)
{
	(void)state;
	const uint8_t glows[2] = { 1, 0 };
	discs d = make_discs(2);
	set_disc(&d, 0, (float[]){ -0.25f, 2, 0 }, 0.5f, 10);
	set_disc(&d, 1, (float[]){ 0.25f, 2, 0 }, 0.5f, 1);
	d.scene.discs.glows = glows;
	gw_gbuffer g = draw(&d.scene, 200, 1, 1, false);
	size_t found[2] = { 0 };
	for (size_t i = 0; i < (size_t)200 * 200; i++) {
		if (!(g.coverage[i] > 0))
			continue;
		bool left = i % 200 < 100;
		assert_true(fabs((double)g.channel[i] - (left ? 10 : 1)) < 1e-5);
		found[left]++;
	}
	assert_int_equal(found[0], found[1]);
	assert_true(found[0] > 1000);
	gw_gbuffer_clear(&g);
	free_discs(&d);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_area_of_disc),
		cmocka_unit_test(test_area_of_tilted_disc),
		cmocka_unit_test(test_depth_order),
		cmocka_unit_test(test_plates_blend),
		cmocka_unit_test(test_opaque_is_opaque),
		cmocka_unit_test(test_plane_has_no_holes),
		cmocka_unit_test(test_noisy_plane_has_no_holes),
		cmocka_unit_test(test_holes_are_filled),
		cmocka_unit_test(test_lines_of_points),
		cmocka_unit_test(test_specks),
		cmocka_unit_test(test_holes_are_no_boxes),
		cmocka_unit_test(test_edges_end_within_tiles),
		cmocka_unit_test(test_fronts_hide_backs),
		cmocka_unit_test(test_facing_of_a_ridge),
		cmocka_unit_test(test_near_plane),
		cmocka_unit_test(test_small_discs_stay),
		cmocka_unit_test(test_small_discs_are_weighted),
		cmocka_unit_test(test_thin_rims),
		cmocka_unit_test(test_glowing_discs_end),
		cmocka_unit_test(test_clip),
		cmocka_unit_test(test_cull),
		cmocka_unit_test(test_triangles),
		cmocka_unit_test(test_triangle_and_discs),
		cmocka_unit_test(test_threads),
		cmocka_unit_test(test_limits),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

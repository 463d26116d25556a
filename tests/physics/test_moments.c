/* Records that know from where their light comes, against closed forms, and what follows from light
 * being a sum. */
#include "light/moments.h"
#include "light/transport_layout.h"
#include "expected.h"
#include "scenes.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define W 64
#define H 32
#define SIDE 150 /* points along each side of the floor */

/* Normals lean by this to the east or to the west, radians: 10 degrees. */
#define LEAN 0.17453292519943295

/* Leaves are so many points wide: of a facet one that leans is a small part. */
#define LEAF 6.0f

/* Rays and samples of a record. */
#define RAYS 256

static float pixels[3 * W * H];

/* 1 for points that lean to the east, -1 for as many that do to the west. */
static int lean_of(size_t i)
{
	return i % 11 == 0 ? 1 : i % 11 == 5 ? -1 : 0;
}

/* A floor of 1.25 m. Few of its points lean, so that the facets, and the records on them, face up.
 */
static void make_floor(scene *s)
{
	scene_add_patch(s,
					&(scene_patch){ (double[3]){ 0, 0, 0 }, (double[3]){ 1.25, 0, 0 },
									(double[3]){ 0, 1.25, 0 }, SIDE, SIDE },
					0.5f);
	for (size_t i = 0; i < s->count; i++) {
		s->normal[3 * i] = (float)(lean_of(i) * sin(LEAN));
		s->normal[3 * i + 2] = lean_of(i) ? (float)cos(LEAN) : 1.0f;
	}
}

/* A sky with radiance 1 in the east, x > 0, and that one in the west. */
static gw_light sky(float west)
{
	for (size_t i = 0; i < (size_t)W * H; i++)
		for (size_t c = 0; c < 3; c++)
			pixels[3 * i + c] = i % W >= W / 2 ? 1.0f : west;
	return (gw_light){ .type = GW_LIGHT_ENVIRONMENT,
					   .radiance = { 1, 1, 1 },
					   .map = pixels,
					   .map_width = W,
					   .map_height = H };
}

/* Mean irradiance of the points that lean to the east, and of those that do to the west. */
static void bake(const scene *s, const gw_light *light, gw_basis basis, double east_west[2])
{
	gw_points points = scene_points(s);
	gw_bake_options options = gw_bake_options_default();
	double sum[2] = { 0 }, count[2] = { 0 };
	options.basis = basis;
	options.bounces = 1;
	options.rays = options.light_samples = RAYS;
	options.leaf_spacing = LEAF;
	options.normals = GW_NORMALS_GIVEN;
	options.estimate_points = 0;
	gw_bake_result *result = scene_bake(&points, light, 1, &options);
	for (size_t i = 0; i < s->count; i++) {
		if (lean_of(i) == 0)
			continue;
		sum[lean_of(i) < 0] += (double)result->direct_irradiance[3 * i];
		count[lean_of(i) < 0]++;
	}
	for (int side = 0; side < 2; side++)
		east_west[side] = sum[side] / count[side];
	gw_bake_result_destroy(&result);
}

/* How much more points that lean get of records that know from where their light comes than of
 * others, whose rays are the same and lose the same near the horizon. */
static void find_more(const gw_light *light, double more[2])
{
	scene s = { 0 };
	double directional[2], scalar[2];
	make_floor(&s);
	bake(&s, light, GW_BASIS_DIRECTIONAL, directional);
	bake(&s, light, GW_BASIS_SCALAR, scalar);
	for (int side = 0; side < 2; side++)
		more[side] = directional[side] - scalar[side];
	scene_clear(&s);
}

/*
 * Under a sky that shines from the east alone the moment is the integral of cosine min(tangent, T)
 * over the east, which is a - sin a cos a + T cos^2 a with tan a = T, and that is a. A surface that
 * leans by an angle gets its sine times this more, or less. Each record finds it by 2 * 256 samples
 * that vary by less than T times pi / 2, to 0.14, of which the sine is read; more than 200 points
 * read several each, not all the same: 0.025 / sqrt(100), times three. Facets lean with the points
 * on them by a 36th.
 */
static void leaning_points_see_more_of_one_side(void **state)
{
	(void)state;
	const gw_light east = sky(0.0f);
	double more[2], expected = sin(LEAN) * atan((double)GW_TANGENT_MOST);
	find_more(&east, more);
	double tolerance = 0.0075 + expected / (double)(LEAF * LEAF);
	if (!(fabs(more[0] - expected) <= tolerance) || !(fabs(more[1] + expected) <= tolerance))
		fail_msg("%.4f more to the east and %.4f to the west, not %.4f", more[0], more[1],
				 expected);
}

/* Under an even sky it does not matter how a point leans: moments are 0 but for noise, by samples
 * as above. */
static void even_sky_has_no_moment(void **state)
{
	(void)state;
	const gw_light even = sky(1.0f);
	double more[2];
	find_more(&even, more);
	if (!(fabs(more[0]) <= 0.01) || !(fabs(more[1]) <= 0.01))
		fail_msg("%.4f more to the east and %.4f to the west, not 0", more[0], more[1]);
}

/* ------------------------------------------------------------------------------------- lamps */

/* The largest radiance of all, and how far the lamps' columns are from the whole, as a share of
 * it. */
static double off_the_whole(const gw_bake_result *r, size_t count, double *largest)
{
	double off = 0.0;
	*largest = 0.0;
	for (size_t i = 0; i < 3 * count; i++) {
		double sum = (double)r->lamp[0][i] + (double)r->lamp[1][i] + (double)r->lamp[2][i];
		off = fmax(off, fabs(sum - (double)r->radiance[i]));
		*largest = fmax(*largest, (double)r->radiance[i]);
	}
	return off / *largest;
}

/* In a sphere two lamps shine and one outside of it does not, whose column is black. The columns
 * add up to the whole, and light is at least direct light, wherever bounces end: after the first or
 * the second that is gathered, when the rest does not matter, or at once because any rest may be
 * left out. Light is added up in float32, of some thousand terms at most, all of which are at least
 * 0 but for the last reflection's, taken off again. */
static void lamps_add_up(void **state)
{
	(void)state;
	static const struct {
		uint32_t bounces;
		float tolerance;
	} ends[] = {
		{ 2, 1e-3f }, { 3, 1e-3f }, { GW_BOUNCES_AUTO, 1e-3f }, { GW_BOUNCES_AUTO, 0.9f }
	};
	const gw_light lights[] = { scene_point_light(0.3, 0.2, 0.1, 2.0f),
								scene_point_light(-0.4, 0.1, 0.3, 1.0f),
								scene_point_light(8.0, 8.0, 8.0, 40.0f) };
	scene s = { 0 };
	scene_add_sphere(&s, (double[3]){ 0, 0, 0 }, 1.0, 3000, -1, 0.3f);
	gw_points points = scene_points(&s);
	for (size_t e = 0; e < sizeof ends / sizeof *ends; e++) {
		gw_bake_options options = gw_bake_options_default();
		options.basis = GW_BASIS_DIRECTIONAL;
		options.bounces = ends[e].bounces;
		options.tolerance = ends[e].tolerance;
		options.lamps = true;
		options.estimate_points = 0;
		gw_bake_result *r = scene_bake(&points, lights, 3, &options);
		double largest, off = off_the_whole(r, s.count, &largest);
		if (!(off <= 4096.0 * 0x1p-24))
			fail_msg("end %zu: lamps are off the whole by %.3g of its largest", e, off);
		for (size_t i = 0; i < 3 * s.count; i++)
			assert_true(r->lamp[2][i] == 0.0f);
		if (ends[e].tolerance > 0.5f)
			assert_true(scene_mean(r->indirect_irradiance, s.count, 0) == 0.0);
		gw_bake_result_destroy(&r);
	}
	scene_clear(&s);
}

/* ------------------------------------------------------------------------------------- reading */

/* One record that faces up, read by a surfel that leans to x by an angle. */
static double read_one(const float irradiance[4], const float moment[8], double angle)
{
	uint32_t first[2] = { 0, 1 }, record = 0;
	float weight = 1.0f, surfel[4];
	const float up[4] = { 0, 0, 1, 1 };
	const float normal[3] = { (float)sin(angle), 0, (float)cos(angle) };
	const gw_read_back rows = { .count = 1, .first = first, .record = &record, .weight = &weight };
	const gw_directed_light light = { irradiance, moment, up, normal, 1 };
	gw_error error = { 0 };
	assert_int_equal(gw_read_back_apply_directed(&rows, &light, 1, surfel, &error), GW_OK);
	return (double)surfel[0];
}

/* Tangents of a normal that points up are x and y. What is read is irradiance + sine * moment, to
 * float32's rounding of three terms; as if by 30 degrees from there on; and never below 0, as the
 * moment is at most GW_TANGENT_MOST times the irradiance. */
static void normals_read_by_their_sine(void **state)
{
	(void)state;
	const float irradiance[4] = { 3, 3, 3, 0 };
	const float moment[8] = { 3 * GW_TANGENT_MOST, 0, 0, 0, 1, 0, 0, 0 };
	for (int degrees = -80; degrees <= 80; degrees += 5) {
		double angle = degrees * SCENE_PI / 180.0;
		double sine = fmin(fmax(sin(angle), -0.5), 0.5);
		double expected = 3.0 + sine * 3.0 * (double)GW_TANGENT_MOST;
		double is = read_one(irradiance, moment, angle);
		if (!(fabs(is - expected) <= 4.0 * 6.0 * 0x1p-24) || is < 0.0)
			fail_msg("%d degrees: %.8f, not %.8f", degrees, is, expected);
	}
}

/* Surfels that are turned as their record by nothing, and by 60 degrees. */
static void turn_is_the_root_of_the_mean_square(void **state)
{
	(void)state;
	const float up[4] = { 0, 0, 1, 1 };
	const float normal[6] = { 0, 0, 1, sqrtf(0.75f), 0, 0.5f };
	uint32_t first[3] = { 0, 1, 2 }, record[2] = { 0, 0 };
	float weight[2] = { 1, 1 };
	const gw_read_back rows = { .count = 2, .first = first, .record = record, .weight = weight };
	double turn = gw_read_back_turn(&rows, up, normal, 1);
	assert_true(fabs(turn - sqrt(0.75 / 2.0)) <= 0x1p-22);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(leaning_points_see_more_of_one_side),
		cmocka_unit_test(even_sky_has_no_moment),
		cmocka_unit_test(lamps_add_up),
		cmocka_unit_test(normals_read_by_their_sine),
		cmocka_unit_test(turn_is_the_root_of_the_mean_square),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

/*
 * test_foliage.c - small things that fill space, such as leaves, against Beer and Lambert's law.
 *
 * Leaves that lie at random show half of their area from everywhere. Where so many lie at random
 * places that half of it is tau times the ground's, exp(-tau / cos) of a sun's light gets through.
 */
#include "scenes.h"

#include "glowworm_picture.h"
#include "octree/trace_constants.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

#define FLOOR 60 /* points a side of the floor, 6 m wide */
#define LEAVES 4000
#define LEAVES_OF_THREE 900
#define SPACING (6.0 / FLOOR)
#define WIDTH 5.0 /* of what they fill, metres */
#define LOW 0.5
#define HIGH 2.0
#define INNER 2.3 /* half of the floor below them, without their rim */

#define PULSES 4000
#define FOOTPRINT 0.1 /* metres, of a pulse */

typedef struct wood {
	scene scene;
	float *own_area;
} wood;

static void add_floor(scene *s)
{
	scene_add_patch(s,
					&(scene_patch){ (double[]){ -3, -3, 0 }, (double[]){ 6, 0, 0 },
									(double[]){ 0, 6, 0 }, FLOOR, FLOOR },
					0.5f);
}

/* A random place in the crown. */
static void place_leaf(scene *s, double p[3])
{
	for (int k = 0; k < 3; k++)
		p[k] = scene_random(s);
	for (int k = 0; k < 2; k++)
		p[k] = WIDTH * (p[k] - 0.5);
	p[2] = LOW + (HIGH - LOW) * p[2];
}

static void make_wood(wood *w, double tau, uint64_t seed)
{
	double leaf = 2.0 * tau * WIDTH * WIDTH / LEAVES;
	*w = (wood){ .scene.state = seed };
	add_floor(&w->scene);
	for (int i = 0; i < LEAVES; i++) {
		double p[3];
		place_leaf(&w->scene, p);
		scene_add(&w->scene, p, (double[]){ 0, 0, 0 }, 0.3f);
	}
	w->own_area = calloc(w->scene.count, sizeof *w->own_area);
	assert_non_null(w->own_area);
	for (size_t i = FLOOR * FLOOR; i < w->scene.count; i++)
		w->own_area[i] = (float)(0.5 * leaf); /* as scanners see it, on average */
}

static void clear(wood *w)
{
	scene_clear(&w->scene);
	free(w->own_area);
}

static gw_points points_of(const wood *w)
{
	gw_points points = scene_points(&w->scene);
	points.own_area = w->own_area;
	return points;
}

/* The share of a sun's light that gets to the floor below the leaves. */
static double share_of_ground(const gw_points *points, size_t ground, double degrees)
{
	gw_bake_options options = gw_bake_options_default();
	double turn = degrees * SCENE_PI / 180.0, sum = 0.0, count = 0.0;
	const gw_light sun = { .type = GW_LIGHT_SUN,
						   .direction = { sin(turn), 0, -cos(turn) },
						   .irradiance = { 1.0f, 1.0f, 1.0f } };
	options.bounces = 1;
	options.estimate_points = 0;
	gw_bake_result *result = scene_bake(points, &sun, 1, &options);
	for (size_t i = 0; i < ground; i++) {
		const double *p = points->position + 3 * i;
		if (fabs(p[1]) > INNER || fabs(p[0] - LOW * tan(turn)) > INNER ||
			fabs(p[0] - HIGH * tan(turn)) > INNER)
			continue;
		sum += (double)result->direct_irradiance[3 * i] / cos(turn);
		count += 1.0;
	}
	gw_bake_result_destroy(&result);
	assert_true(count > 400.0);
	return sum / count;
}

static double share_below(const wood *w, double degrees)
{
	gw_points points = points_of(w);
	return share_of_ground(&points, (size_t)FLOOR * FLOOR, degrees);
}

/* The optical depth, not the light, is compared, so that dense leaves count as well. Leaves of a
 * cell hide each other no less than those of others: that takes up to 3 %, and at 1.5 and more
 * gives 1 back. Chance, by where 4000 leaves are, has a standard deviation of 2 % (ten woods), of
 * which three are allowed. */
static void beer_and_lambert(void **state)
{
	(void)state;
	const double depth[] = { 0.3, 0.7, 1.5 }, degrees[] = { 0.0, 50.0 };
	for (int d = 0; d < 3; d++)
		for (int a = 0; a < 2; a++) {
			wood w;
			make_wood(&w, depth[d], 1 + (uint64_t)(a + d) % 2);
			double along = depth[d] / cos(degrees[a] * SCENE_PI / 180.0);
			double met = -log(share_below(&w, degrees[a]));
			assert_true(met > 0.93 * along && met < 1.09 * along);
			clear(&w);
		}
}

/* A leaf that scanners met three times, as often for its area as the floor. */
static void add_leaf_of_three(scene *s, const double middle[3])
{
	double n[3], z = 2.0 * scene_random(s) - 1.0, turn = 2.0 * SCENE_PI * scene_random(s);
	n[0] = sqrt(1.0 - z * z) * cos(turn);
	n[1] = sqrt(1.0 - z * z) * sin(turn);
	n[2] = z;
	const double u[3] = { -sin(turn), cos(turn), 0.0 };
	const double v[3] = { -z * cos(turn), -z * sin(turn), sqrt(1.0 - z * z) };
	for (int corner = 0; corner < 3; corner++) {
		double at = 2.0 * SCENE_PI * corner / 3.0, p[3];
		for (int k = 0; k < 3; k++)
			p[k] = middle[k] + SPACING / sqrt(3.0) * (cos(at) * u[k] + sin(at) * v[k]);
		scene_add(s, p, n, 0.3f);
	}
}

/*
 * Leaves that have a few points each, with normals. Their neighbours are on other leaves: discs as
 * wide as to these would be plates of several times their area, and the depth five times what it
 * is.
 *
 * A leaf shows the union of its three discs, of radius r, SPACING apart: their areas but for where
 * two of them lie over each other, 2 r^2 acos(SPACING / 2r) - SPACING / 2 sqrt(4 r^2 - SPACING^2),
 * for three pairs. Where cells of the octree are about as wide as a leaf, rays meet planes of cells
 * that leaves' discs cover with a rim of GW_DISC_OVERLAP cells, and where leaves meet in a cell one
 * plane shows their discs side by side: their whole areas, with that rim, at most. In smaller cells
 * both become less. So the depth is between these two.
 *
 * Chance: a leaf whose cosine is even shows half of its area on average and a third of the square
 * of it, so that the depth of N leaves at random places is off by sqrt(4 / (3 N)), 4.2 % of it. The
 * floor has n = 46^2 points below them, each of which is in the light or not, which makes
 * sqrt((1 - q) / (q n)) where q is the share in the light, 1.8 % of 1 or 3.4 % of the depth.
 * Three standard deviations of a mean over WOODS are allowed.
 */
#define WOODS 4

static double chance_of_few(double depth)
{
	const double inner = 4.0 * INNER * INNER, q = exp(-depth);
	double leaves = LEAVES_OF_THREE * inner / (WIDTH * WIDTH), n = inner / (SPACING * SPACING);
	return sqrt(4.0 / (3.0 * leaves) + (1.0 - q) / (q * n * depth * depth));
}

/* What a leaf of three shows, of its area: between its discs' union and their areas with a rim. */
static double least_shown(void)
{
	double square = SPACING * SPACING, r = SPACING / sqrt(SCENE_PI);
	double lens =
		2.0 * r * r * acos(0.5 * SPACING / r) - 0.5 * SPACING * sqrt(4.0 * r * r - square);
	return 1.0 - lens / square;
}

static double most_shown(double cell)
{
	double rim = (double)GW_DISC_OVERLAP * cell / (SPACING / sqrt(SCENE_PI));
	return (1.0 + rim) * (1.0 + rim);
}

static void make_wood_of_three(scene *s, uint64_t seed)
{
	*s = (scene){ .state = seed };
	add_floor(s);
	for (int i = 0; i < LEAVES_OF_THREE; i++) {
		double p[3];
		place_leaf(s, p);
		add_leaf_of_three(s, p);
	}
}

static void leaves_of_a_few_points(void **state)
{
	(void)state;
	double depth = 0.5 * 3.0 * SPACING * SPACING * LEAVES_OF_THREE / (WIDTH * WIDTH), met = 0.0;
	for (uint64_t seed = 1; seed <= WOODS; seed++) {
		scene s;
		make_wood_of_three(&s, seed);
		gw_points points = scene_points(&s);
		met -= log(share_of_ground(&points, (size_t)FLOOR * FLOOR, 0.0)) / depth / WOODS;
		scene_clear(&s);
	}
	double least = least_shown(), most = most_shown((double)GW_LEAF_SPACING * SPACING);
	double chance = 3.0 * chance_of_few(depth) / sqrt(WOODS);
	print_message("%.3f of the depth, %.3f to %.3f, by chance %.3f\n", met, least, most, chance);
	if (!(met > least - chance && met < most + chance))
		fail_msg("%.3f of the depth, %.3f to %.3f, by chance %.3f", met, least, most, chance);
}

static size_t count_foliage(const gw_points *points)
{
	gw_surfels surfels;
	gw_error error;
	size_t count = 0;
	assert_int_equal(
		gw_surfels_make(points, &(gw_surfels_options){ .threads = 1 }, &surfels, &error), GW_OK);
	for (size_t i = 0; i < surfels.count; i++)
		count += surfels.two_sided[i] == GW_SIDE_FOLIAGE;
	gw_surfels_clear(&surfels);
	return count;
}

/* Points that fill a box are foliage but for its rim, and light fades within: the upper half of it
 * hides the lower one, and what lies in its middle has some of the light. */
static void bare_points(void **state)
{
	(void)state;
	wood w;
	make_wood(&w, 1.0, 3);
	gw_points points = scene_points(&w.scene);
	assert_true(count_foliage(&points) > LEAVES * 6 / 10);
	gw_bake_options options = gw_bake_options_default();
	options.bounces = 1;
	options.estimate_points = 0;
	const gw_light sun = { .type = GW_LIGHT_SUN,
						   .direction = { 0, 0, -1 },
						   .irradiance = { 1.0f, 1.0f, 1.0f } };
	gw_bake_result *result = scene_bake(&points, &sun, 1, &options);
	double sum[3] = { 0.0 }, count[3] = { 0.0 };
	for (size_t i = FLOOR * FLOOR; i < points.count; i++) {
		int layer = (int)(3.0 * (points.position[3 * i + 2] - LOW) / (HIGH - LOW));
		sum[layer < 3 ? layer : 2] += (double)result->direct_irradiance[3 * i];
		count[layer < 3 ? layer : 2] += 1.0;
	}
	gw_bake_result_destroy(&result);
	for (int i = 0; i < 2; i++)
		assert_true(sum[i] / count[i] < 0.7 * sum[i + 1] / count[i + 1]);
	assert_true(sum[0] > 0.0);
	clear(&w);
}

/* The same leaves as a laser from above sees them: of each pulse a third goes its own way, and
 * stops after a free path of its own, or at the ground. Returns how many points are on the ground,
 * which come first. */
static size_t scan_from_above(wood *w, double tau, uint64_t seed)
{
	const size_t parts = 3;
	*w = (wood){ .scene.state = seed };
	size_t ground = 0;
	for (int on_ground = 1; on_ground >= 0; on_ground--) {
		w->scene.state = seed;
		for (size_t i = 0; i < PULSES * parts; i++) {
			static double x, y;
			if (i % parts == 0) {
				x = WIDTH * (scene_random(&w->scene) - 0.5);
				y = WIDTH * (scene_random(&w->scene) - 0.5);
			}
			double dx = scene_random(&w->scene) - 0.5, dy = scene_random(&w->scene) - 0.5;
			double z = HIGH + (HIGH - LOW) / tau * log(1.0 - scene_random(&w->scene));
			const double at[3] = { x + FOOTPRINT * dx, y + FOOTPRINT * dy, z < LOW ? 0.0 : z };
			if ((z < LOW) == on_ground)
				scene_add(&w->scene, at, (double[]){ 0, 0, 0 }, 0.3f);
		}
		ground = on_ground ? w->scene.count : ground;
	}
	return ground;
}

/* As many leaves are found as there have to be: what gets down is what beams got down. Of a column
 * of 16 pulses chance takes and adds: a mean of exponentials is above the exponential of the mean.
 * And a tenth of the leaves, above all those that are highest, pass for small plates. */
static void scanned_from_above(void **state)
{
	(void)state;
	const double depth[] = { 0.4, 0.8, 1.2 }, degrees[] = { 0.0, 40.0 };
	for (int d = 0; d < 3; d++) {
		wood w;
		size_t ground = scan_from_above(&w, depth[d], 5 + (uint64_t)d);
		gw_points points = scene_points(&w.scene);
		float *share = malloc(points.count * sizeof *share);
		assert_non_null(share);
		for (size_t i = 0; i < points.count; i++)
			share[i] = 1.0f / 3.0f;
		points.beam_share = share;
		assert_true(count_foliage(&points) > (points.count - ground) * 8 / 10);
		for (int a = 0; a < 2; a++) {
			double along = depth[d] / cos(degrees[a] * SCENE_PI / 180.0);
			double met = -log(share_of_ground(&points, ground, degrees[a]));
			assert_true(met > 0.75 * along && met < 1.03 * along);
		}
		free(share);
		scene_clear(&w.scene);
	}
}

/* What scatters about a surface by half a spacing, and the edges of a box, are none. */
static void surfaces_are_none(void **state)
{
	(void)state;
	for (int noisy = 0; noisy < 2; noisy++) {
		scene s = { 0 };
		scene_add_box(&s, (double[]){ 0, 0, 0 }, (double[]){ 1, 1, 1 }, 24, 0.5f);
		for (size_t i = 0; i < 3 * s.count; i++) {
			double noise = 2.0 * (scene_random(&s) + scene_random(&s) - 1.0) * sqrt(1.5);
			s.position[i] += noisy ? 0.5 / 24 * noise * fabs((double)s.normal[i]) : 0.0;
			s.normal[i] = 0.0f;
		}
		gw_points points = scene_points(&s);
		assert_int_equal(count_foliage(&points), 0);
		scene_clear(&s);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(beer_and_lambert),  cmocka_unit_test(leaves_of_a_few_points),
		cmocka_unit_test(bare_points),       cmocka_unit_test(scanned_from_above),
		cmocka_unit_test(surfaces_are_none),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

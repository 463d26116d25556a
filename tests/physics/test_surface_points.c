/*
 * test_surface_points.c - a surface of some of the points: which make it, and what light the others
 * get by it.
 */
#include "bake/surface_points.h"
#include "expected.h"
#include "glowworm_parts.h"
#include "glowworm_picture.h"
#include "scenes.h"
#include "surfels/surfel_parts.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void choose(const gw_points *points, size_t most, gw_point_subset *surface)
{
	gw_error error;
	assert_ok(gw_surface_points_choose(points, most, 2, surface, &error), &error);
}

/* A square of 1 m, of `count` points at random places; every other one of them lies within the
 * tenth of its width beside x = 0. */
static scene uneven_square(size_t count)
{
	static const double up[3] = { 0, 0, 1 };
	scene s = { .state = 3 };
	for (size_t i = 0; i < count; i++) {
		double width = i % 2 ? 0.1 : 1.0;
		const double place[3] = { width * scene_random(&s), scene_random(&s), 0 };
		scene_add(&s, place, up, 0.5f);
	}
	return s;
}

/* As many as were asked for, but for what the last try of a grid leaves; and evenly: cubes hold one
 * each, so that the dense tenth has as many as any other, up to cubes on its border. */
static void evenly_thinned(void **state)
{
	(void)state;
	scene s = uneven_square(40000);
	const gw_points points = scene_points(&s);
	gw_point_subset surface;
	choose(&points, 2000, &surface);
	size_t count = surface.points.count, dense = 0;
	assert_in_range(count, 1860, 2010);
	for (size_t k = 0; k < count; k++) {
		dense += surface.position[3 * k] < 0.1;
		assert_memory_equal(surface.position + 3 * k, s.position + 3 * surface.from[k],
							3 * sizeof(double));
	}
	/* Columns of 1 / sqrt(2000) m: 4.5 of them, or 4 to 6 with those that are cut. */
	assert_in_range(dense, 4 * count / 45, 6 * count / 42);
	gw_point_subset_clear(&surface);
	scene_clear(&s);
}

static int by_place(const void *a, const void *b)
{
	return memcmp(a, b, 3 * sizeof(double));
}

/* The same places are taken in whatever order points come, and by however many threads. */
static void order_is_no_matter(void **state)
{
	(void)state;
	scene s = uneven_square(5000), turned = { .state = 1 };
	for (size_t i = s.count; i-- > 0;)
		scene_add(&turned, s.position + 3 * i, (double[3]){ 0, 0, 1 }, 0.5f);
	const gw_points points = scene_points(&s), other = scene_points(&turned);
	gw_point_subset one, two;
	gw_error error;
	assert_ok(gw_surface_points_choose(&points, 700, 1, &one, &error), &error);
	choose(&other, 700, &two);
	assert_int_equal(one.points.count, two.points.count);
	qsort(one.position, one.points.count, 3 * sizeof(double), by_place);
	qsort(two.position, two.points.count, 3 * sizeof(double), by_place);
	assert_memory_equal(one.position, two.position, 3 * one.points.count * sizeof(double));
	gw_point_subset_clear(&one);
	gw_point_subset_clear(&two);
	scene_clear(&s);
	scene_clear(&turned);
}

/* Points far off all others make no difference to the grid; where all are at one place there is one
 * cube. */
static void strays_widen_no_cubes(void **state)
{
	(void)state;
	static const double up[3] = { 0, 0, 1 };
	scene s = uneven_square(20000);
	scene_add(&s, (double[3]){ 1e9, 0, 0 }, up, 0.5f);
	scene_add(&s, (double[3]){ 1e30, -1e30, 0 }, up, 0.5f);
	gw_points points = scene_points(&s);
	gw_point_subset surface;
	choose(&points, 2000, &surface);
	assert_in_range(surface.points.count, 1860, 2010);
	gw_point_subset_clear(&surface);
	for (size_t i = 0; i < 3 * s.count; i++)
		s.position[i] = 7.0;
	points = scene_points(&s);
	choose(&points, 2000, &surface);
	assert_int_equal(surface.points.count, 1);
	gw_point_subset_clear(&surface);
	scene_clear(&s);
}

/* A cube's point stands for all in it: of points of which every other one emits 10, ten a cube,
 * each that is taken has the mean of its own, 5 with a standard deviation of 5 / sqrt(10) = 1.6.
 * Cubes have ten points only on average, and fewer where the border cuts them, so that it is more
 * than that; of the points as they are it is 5. Half of that is in between. The mean of all is 5 to
 * within four deviations of a mean. */
static void means_are_kept(void **state)
{
	(void)state;
	static const double up[3] = { 0, 0, 1 };
	scene s = { .state = 5 };
	for (size_t i = 0; i < 20000; i++) {
		const double place[3] = { scene_random(&s), scene_random(&s), 0 };
		size_t at = scene_add(&s, place, up, i % 2 ? 0.75f : 0.25f);
		for (size_t c = 0; c < 3 && i % 2; c++)
			s.emission[3 * at + c] = 10.0f;
	}
	s.emits = true;
	const gw_points points = scene_points(&s);
	gw_point_subset surface;
	choose(&points, 2000, &surface);
	size_t count = surface.points.count;
	double square = 0.0, within = 4.0 * 2.5 / sqrt((double)count);
	for (size_t k = 0; k < count; k++) {
		double e = (double)surface.emission[3 * k], albedo = (double)surface.albedo[3 * k];
		square += (e - 5.0) * (e - 5.0);
		assert_true(fabs(albedo - (0.25 + 0.05 * e)) < 1e-6); /* roundings of two means */
	}
	assert_true(sqrt(square / (double)count) < 2.5);
	assert_true(fabs(scene_mean(surface.emission, count, 0) - 5.0) < within);
	gw_point_subset_clear(&surface);
	scene_clear(&s);
}

/* Rows and columns stay such: of 60 x 80 cells, for a fifth of them, every third column and every
 * second row. */
static void images_stay_images(void **state)
{
	(void)state;
	enum { ROWS = 60, COLUMNS = 80 };
	static double position[3 * ROWS * COLUMNS];
	static uint32_t cell[ROWS * COLUMNS];
	for (uint32_t i = 0; i < ROWS * COLUMNS; i++) {
		position[3 * i] = i % COLUMNS;
		position[3 * i + 1] = (double)(i / COLUMNS);
		cell[i] = i;
	}
	const gw_range_image image = { .count = ROWS * COLUMNS, .columns = COLUMNS, .rows = ROWS };
	const gw_points points = { .count = ROWS * COLUMNS,
							   .position = position,
							   .image = &image,
							   .image_count = 1,
							   .image_cell = cell };
	gw_point_subset surface;
	choose(&points, ROWS * COLUMNS / 5, &surface);
	assert_int_equal(surface.points.count, 27 * 30);
	assert_int_equal(surface.image[0].columns, 27);
	assert_int_equal(surface.image[0].rows, 30);
	for (size_t k = 0; k < surface.points.count; k++) {
		assert_int_equal(surface.image_cell[k] % 27 * 3, (int)surface.position[3 * k]);
		assert_int_equal(surface.image_cell[k] / 27 * 2, (int)surface.position[3 * k + 1]);
	}
	gw_point_subset_clear(&surface);
}

/* A lamp of 3 x 3 cells that lies between those that are kept, every fifth column and row: those
 * nearest to it emit for it, each for 25 cells. */
static void images_keep_their_lamps(void **state)
{
	(void)state;
	enum { ROWS = 60, COLUMNS = 80, COUNT = ROWS * COLUMNS };
	static double position[3 * COUNT];
	static float emission[3 * COUNT];
	static uint32_t cell[COUNT];
	for (uint32_t i = 0; i < COUNT; i++) {
		position[3 * i] = i % COLUMNS;
		position[3 * i + 1] = (double)(i / COLUMNS);
		cell[i] = i;
		bool lamp = i % COLUMNS / 3 == 12 && (i / COLUMNS + 1) / 3 == 14;
		for (uint32_t c = 0; c < 3; c++)
			emission[3 * i + c] = lamp ? 25.0f : 0.0f;
	}
	const gw_range_image image = { .count = COUNT, .columns = COLUMNS, .rows = ROWS };
	const gw_points points = { .count = COUNT,
							   .position = position,
							   .emission = emission,
							   .image = &image,
							   .image_count = 1,
							   .image_cell = cell };
	gw_point_subset surface;
	double sum = 0.0;
	choose(&points, COUNT / 25, &surface);
	assert_int_equal(surface.points.count, 16 * 12);
	for (size_t k = 0; k < surface.points.count; k++) {
		assert_true(emission[3 * surface.from[k]] == 0.0f);
		sum += (double)surface.emission[3 * k];
	}
	assert_true(sum == 9.0);
	gw_point_subset_clear(&surface);
}

enum { ROOM_POINTS = 20000, LAMP_POINTS = 40 };

/* A room of 2 m that is all but black, of points at random places, in whose ceiling a square emits
 * 1 on which 40 of them lie, give or take what they do at random; or twice as large a one, of which
 * every other of 2 x 2 squares does. */
static scene room_with_lamp(uint64_t seed, bool checkered)
{
	scene s = { .state = seed };
	double side = sqrt(24.0 * LAMP_POINTS / ROOM_POINTS),
		   half = checkered ? side * M_SQRT1_2 : 0.5 * side;
	scene_make_random_room(&s, ROOM_POINTS, 0.01f);
	for (size_t i = 0; i < s.count; i++) {
		const double *p = s.position + 3 * i;
		bool within = fabs(p[0]) < half && fabs(p[1]) < half && s.normal[3 * i + 2] < -0.5f;
		for (size_t c = 0; c < 3 && within && (!checkered || p[0] * p[1] > 0.0); c++)
			s.emission[3 * i + c] = 1.0f;
	}
	s.emits = true;
	return s;
}

static double power_of(const gw_points *points)
{
	gw_surfels surfels;
	gw_error error;
	double power = 0.0;
	assert_ok(
		gw_placed_surfels_make(points, &(gw_surfels_options){ .threads = 2 }, &surfels, &error),
		&error);
	for (size_t i = 0; i < surfels.count && surfels.emission; i++)
		power += (double)surfels.area[i] * (double)surfels.emission[3 * i];
	gw_surfels_clear(&surfels);
	return power;
}

/* Area times emission of lamps of few points stays, by a quarter and a sixteenth of all, of which
 * 10 and 3 are on a lamp. How many of all lie on it scatters by their root, and what surfaces make
 * of them by no more: 7 to 14 % here. The mean of eight lamps is right to within three times that
 * over root 8. By the means of cubes they scatter by 12 to 17 %, and by what each point of the
 * surface emits by itself by 14 to more than 30. */
static void lamps_keep_their_power(void **state)
{
	(void)state;
	enum { LAMPS = 8 };
	for (int kind = 0; kind < 4; kind++) {
		double sum = 0.0, squares = 0.0, area = 24.0 * LAMP_POINTS / ROOM_POINTS;
		for (uint64_t seed = 1; seed <= LAMPS; seed++) {
			scene s = room_with_lamp(seed, kind % 2);
			const gw_points points = scene_points(&s);
			gw_point_subset surface;
			choose(&points, ROOM_POINTS / (kind < 2 ? 4u : 16u), &surface);
			double power = power_of(&surface.points) / area;
			sum += power;
			squares += (power - 1.0) * (power - 1.0);
			gw_point_subset_clear(&surface);
			scene_clear(&s);
		}
		print_message("power %.3f, scatters by %.3f\n", sum / LAMPS, sqrt(squares / LAMPS));
		assert_true(fabs(sum / LAMPS - 1.0) < 3.0 / sqrt(LAMPS * LAMP_POINTS));
		assert_true(sqrt(squares / LAMPS) < 1.0 / sqrt(LAMP_POINTS));
	}
}

static gw_bake_options thinned(uint32_t most)
{
	gw_bake_options o = gw_bake_options_default();
	o.surface_points = most;
	return o;
}

/* Under a sun alone every point of a square has irradiance 1, and reflects it by its own albedo;
 * what is no number, or clear, is left dark; what is known to be no surface is lit and marked. */
static void each_has_its_albedo(void **state)
{
	(void)state;
	enum { COUNT = 12000, NOT_A_NUMBER = 7, CLEAR = 8, STRAY = 9, FAR = 10 };
	const gw_light sun = { .type = GW_LIGHT_SUN,
						   .direction = { 0, 0, -1 },
						   .irradiance = { 1, 1, 1 } };
	scene s = uneven_square(COUNT);
	uint8_t *stray = calloc(COUNT, 1);
	float *opacity = malloc(COUNT * sizeof *opacity);
	assert_non_null(stray);
	assert_non_null(opacity);
	for (size_t i = 0; i < COUNT; i++) {
		opacity[i] = i == CLEAR ? 0.0f : 1.0f;
		for (size_t c = 0; c < 3; c++)
			s.albedo[3 * i + c] = (float)(i % 10) / 10.0f;
	}
	s.position[3 * NOT_A_NUMBER] = NAN;
	s.position[3 * FAR] = 1e30;
	stray[STRAY] = 1 + GW_STRAY_ALONE;
	gw_points points = scene_points(&s);
	points.opacity = opacity;
	points.stray = stray;
	const gw_bake_options options = thinned(1500);
	gw_bake_result *r = scene_bake(&points, &sun, 1, &options);
	assert_int_equal(r->count, COUNT);
	assert_in_range(r->report.surface_points, 1350, 1510);
	for (size_t i = 0; i < COUNT; i++) {
		bool dark = i == NOT_A_NUMBER || i == CLEAR;
		/* Roundings: of a dozen sums and products of single precision. */
		double e = dark ? 0.0 : 1.0, near = 12 * 0x1p-23;
		assert_true(fabs((double)r->direct_irradiance[3 * i] - e) <= near);
		assert_true(fabs((double)r->radiance[3 * i] - e * (double)s.albedo[3 * i] / SCENE_PI) <=
					near);
	}
	assert_non_null(r->stray);
	assert_int_equal(r->stray[STRAY], 1 + GW_STRAY_ALONE);
	gw_bake_result_destroy(&r);
	free(stray);
	free(opacity);
	scene_clear(&s);
}

/* Two sheets half a spacing of the surface apart, lit from above: the lower one, which faces down,
 * takes nothing from the upper one. */
static void sheets_keep_their_sides(void **state)
{
	(void)state;
	enum { COUNT = 20000 };
	const gw_light sun = { .type = GW_LIGHT_SUN,
						   .direction = { 0, 0, -1 },
						   .irradiance = { 1, 1, 1 } };
	scene s = { .state = 4 };
	for (size_t i = 0; i < COUNT; i++) {
		const double place[3] = { scene_random(&s), scene_random(&s), i % 2 ? 0.01 : 0.0 };
		scene_add(&s, place, (double[3]){ 0, 0, i % 2 ? 1 : -1 }, 0.5f);
	}
	const gw_points points = scene_points(&s);
	const gw_bake_options options = thinned(4000);
	gw_bake_result *r = scene_bake(&points, &sun, 1, &options);
	for (size_t i = 0; i < COUNT; i++) {
		bool bright = r->direct_irradiance[3 * i] > 0.5f;
		assert_int_equal(bright, i % 2);
		assert_true((i % 2 ? 1.0f : -1.0f) * r->normal[3 * i + 2] > 0.0f);
	}
	gw_bake_result_destroy(&r);
	scene_clear(&s);
}

static double luminance(const float *rgb)
{
	return gw_relative_luminance((double)rgb[0], (double)rgb[1], (double)rgb[2]);
}

/* Root mean square difference over the mean, at points that do not emit. */
static double difference(const scene *s, const gw_bake_result *a, const gw_bake_result *b)
{
	double square = 0.0, sum = 0.0, used = 0.0;
	for (size_t i = 0; i < s->count; i++) {
		if (s->emission[3 * i] > 0.0f)
			continue;
		double off = luminance(a->radiance + 3 * i) - luminance(b->radiance + 3 * i);
		square += off * off;
		sum += luminance(b->radiance + 3 * i);
		used++;
	}
	return sqrt(square / used) / (sum / used);
}

/*
 * The hall, with a lamp, what glows, and a sky, by all of its points and by a third of them. The
 * two differ by what each is wrong by, and the estimates of both say how much that is: within the
 * factor of 1.5 that holds for scans, and no more than twice as much, because what a bake differs
 * by from one of half of its points holds the noise of both, sqrt(2), and so does what points are
 * off from those around them.
 */
static void the_error_is_known(void **state)
{
	(void)state;
	const gw_light lights[] = { scene_point_light(1.5, 1.0, 1.5, 3.0f),
								{ .type = GW_LIGHT_ENVIRONMENT,
								  .radiance = { 0.5f, 0.6f, 0.8f } } };
	scene s = { .state = 1 };
	scene_make_hall(&s);
	const gw_points points = scene_points(&s);
	gw_bake_options all = gw_bake_options_default(), some = thinned((uint32_t)s.count / 3);
	all.lamps = some.lamps = true;
	gw_bake_result *whole = scene_bake(&points, lights, 2, &all);
	gw_bake_result *part = scene_bake(&points, lights, 2, &some);
	double differ = difference(&s, part, whole);
	double stated = hypot(part->report.error.relative_rms, whole->report.error.relative_rms);
	print_message("differ by %.3f, stated %.3f (between points %.3f)\n", differ, stated,
				  part->report.error.between);
	assert_true(part->report.error.between > 0.0);
	assert_true(differ < 1.5 * stated);
	assert_true(stated < 2.0 * differ);
	for (size_t i = 0; i < s.count; i++) {
		double sum = part->rest ? (double)part->rest[3 * i] : 0.0;
		for (size_t k = 0; k < part->lamp_count; k++)
			sum += (double)part->lamp[k][3 * i];
		/* Roundings, and lights solved one by one: those of all together stop when what is left is
		 * below the tolerance, each of these likewise. */
		assert_true(fabs(sum - (double)part->radiance[3 * i]) <=
					(double)some.tolerance * 3.0 * (sum + 1.0));
	}
	gw_bake_result_destroy(&whole);
	gw_bake_result_destroy(&part);
	scene_clear(&s);
}

/* The same bytes whatever the threads; and of a region that region alone. */
static void same_by_any_threads(void **state)
{
	(void)state;
	const gw_light lamp = scene_point_light(1.5, 1.0, 1.5, 3.0f);
	scene s = { .state = 1 };
	scene_make_small_hall(&s);
	const gw_points points = scene_points(&s);
	uint8_t *asked = calloc(s.count, 1);
	assert_non_null(asked);
	for (size_t i = 0; i < s.count; i++)
		asked[i] = s.position[3 * i] < 2.0;
	const gw_region region = { .point = asked };
	gw_bake_options options = thinned(1000), parallel = thinned(1000), part = thinned(1000);
	options.threads = 1;
	parallel.threads = 3;
	part.region = &region;
	gw_bake_result *one = scene_bake(&points, &lamp, 1, &options);
	gw_bake_result *three = scene_bake(&points, &lamp, 1, &parallel);
	gw_bake_result *some = scene_bake(&points, &lamp, 1, &part);
	assert_memory_equal(one->radiance, three->radiance, 3 * s.count * sizeof(float));
	assert_non_null(some->asked);
	for (size_t i = 0; i < s.count; i++) {
		assert_int_equal(some->asked[i], asked[i]);
		if (!asked[i])
			assert_true(some->radiance[3 * i] == 0.0f && some->normal[3 * i + 2] == 0.0f);
	}
	gw_bake_result_destroy(&one);
	gw_bake_result_destroy(&three);
	gw_bake_result_destroy(&some);
	free(asked);
	scene_clear(&s);
}

static size_t most_of(const gw_points *points, const gw_bake_options *options)
{
	const gw_light sky = { .type = GW_LIGHT_ENVIRONMENT, .radiance = { 1, 1, 1 } };
	const gw_scene_description all = { points, &sky, 1 };
	return gw_surface_points_most(&all, options, gw_surface_points_memory(points, options));
}

/* As many as memory holds, where it holds some, and never fewer than the least. */
static void memory_says_how_many(void **state)
{
	(void)state;
	scene s = uneven_square(40000);
	const gw_points points = scene_points(&s);
	gw_bake_options options = gw_bake_options_default();
	assert_int_equal(most_of(&points, &options), s.count);
	options.memory = UINT64_C(1) << 40;
	assert_int_equal(most_of(&points, &options), s.count);
	options.memory = UINT64_C(1) << 20;
	assert_int_equal(most_of(&points, &options), 10000);
	size_t least = s.count, fewer = 0;
	for (options.memory = UINT64_C(100) << 20; options.memory < UINT64_C(2) << 30;
		 options.memory += UINT64_C(1) << 20) {
		size_t most = most_of(&points, &options);
		least = most < least ? most : least;
		fewer += most < s.count;
	}
	assert_true(fewer > 0);
	/* A step of memory is 1411 points of the surface, of 743 bytes each. */
	assert_in_range(least, 10000, 11411);
	scene_clear(&s);
}

/* Of so many times as many points. Where leaves get wider, as by the fourth root of the points
 * beyond 250,000, facets grow less. */
static gw_memory_facts facts_times(const gw_memory_facts *f, double times)
{
	gw_memory_facts other = *f;
	double before = fmax(1.0, (double)f->surfels / 250000.0);
	double after = fmax(1.0, times * (double)f->surfels / 250000.0);
	other.points = (uint64_t)(times * (double)f->points);
	other.surfels = (uint64_t)(times * (double)f->surfels);
	other.facets =
		(uint64_t)(times * (double)f->facets * (f->widening ? sqrt(before / after) : 1.0));
	return other;
}

/* What fits takes no more than there is, and one in a hundred more points take more, whatever a
 * point takes; and records grow by what is left. */
static void memory_is_foretold(void **state)
{
	(void)state;
	for (int bits = 0; bits < 32; bits++) {
		gw_memory_facts f = { .points = 1000000,
							  .surfels = bits & 1 ? 1900000 : 1000000,
							  /* of the last so few that what comes before them is the most */
							  .facets = bits & 16  ? 100000
										: bits & 2 ? 3000000
												   : 700000,
							  .subset = bits & 4,
							  .lamps = bits & 2,
							  .estimated = bits & 1,
							  .widening = bits & 8 };
		const uint64_t bytes = UINT64_C(500) << 20;
		double all = (double)f.points, share = (double)gw_bake_memory_points(&f, bytes, 0.0) / all;
		const gw_memory_facts fit = facts_times(&f, share), more = facts_times(&f, 1.01 * share);
		assert_true(gw_bake_memory(&fit) <= bytes && gw_bake_memory(&more) > bytes);
		assert_int_equal(gw_bake_memory_points(&f, 1000, 0.0), 0);
	}
	assert_true(gw_bake_memory_growth(1000, 900, 100) == 1.0);
	assert_true(gw_bake_memory_growth(1000, 2000, 100) > 5.0);
}

/* Points that fill a cube, each of which faces where it will: three facets a point, where memory
 * was said to hold all by as many as most scenes have. So their number is chosen again, by what the
 * octree of all turned out to take, and the bake of these is the one that is returned, as it is
 * planned. */
static void points_that_take_more_are_fewer(void **state)
{
	(void)state;
	const size_t count = 40000;
	const gw_light sky = { .type = GW_LIGHT_ENVIRONMENT, .radiance = { 1, 1, 1 } };
	scene s = { .state = 5 };
	scene_add_box(&s, (double[3]){ 0, 0, 0 }, (double[3]){ 1, 1, 1 }, 85.0, 0.5f);
	assert_true(s.count >= count);
	for (size_t i = 0; i < 3 * count; i++) {
		s.position[i] = scene_random(&s);
		s.normal[i] = (float)(scene_random(&s) - 0.5);
	}
	s.count = count;
	const gw_points points = scene_points(&s);
	gw_bake_options options = gw_bake_options_default();
	options.rays = 16;
	options.estimate_points = 0;
	options.memory = (UINT64_C(166) << 20) + 150 * count;
	assert_int_equal(most_of(&points, &options), count);
	gw_bake_result *fewer = scene_bake(&points, &sky, 1, &options), *plan;
	assert_in_range(fewer->report.surface_points, 10000, count * 6 / 10);
	assert_int_equal(fewer->count, count);
	assert_true(scene_has_stage(&fewer->report, "larger surfaces"));
	gw_error error;
	assert_int_equal(
		gw_plan_bake(&(gw_scene_description){ &points, &sky, 1 }, &options, NULL, &plan, &error),
		GW_OK);
	assert_int_equal(plan->report.surface_points, fewer->report.surface_points);
	gw_bake_result_destroy(&plan);
	/* By twice the memory all fit; without a limit by that of the machine. */
	options.memory *= 2;
	gw_bake_result *all = scene_bake(&points, &sky, 1, &options);
	assert_int_equal(all->report.surface_points, 0);
	assert_false(scene_has_stage(&all->report, "larger surfaces"));
	gw_bake_result_destroy(&all);
	gw_bake_result_destroy(&fewer);
	scene_clear(&s);
}

/* Few at first; sixteen times as many where that may do; and all where it cannot, or where there
 * are hardly more. */
static void an_error_asks_for_more(void **state)
{
	(void)state;
	assert_int_equal(gw_surface_points_next(0, 0.0, 0.05, 100000000), 50000);
	assert_int_equal(gw_surface_points_next(50000, 0.15, 0.05, 100000000), 800000);
	assert_int_equal(gw_surface_points_next(50000, 0.3, 0.05, 100000000), 100000000);
	assert_int_equal(gw_surface_points_next(50000, 0.06, 0.05, 10000000), 10000000);
	/* One that missed it by its spread alone is not tried again. */
	assert_int_equal(gw_surface_points_next(50000, 0.04, 0.05, 100000000), 800000);
	assert_int_equal(gw_surface_points_next(0, 0.0, 0.05, 700000), 700000);
	assert_int_equal(gw_surface_points_next(0, 0.0, 0.05, 3000), 3000);
}

/* A grey box of 810,000 points, lit from its middle: a surface of 50,000 is enough for 10 %. All of
 * its light, 4 pi W of the lamp, is reflected by half each time; and what is stated bounds what the
 * means are off. */
static void an_error_takes_few_points(void **state)
{
	(void)state;
	const gw_light lamp = scene_point_light(0.5, 0.5, 0.5, 1.0f);
	scene s = { .state = 2 };
	scene_add_box(&s, (double[3]){ 0, 0, 0 }, (double[3]){ 1, 1, 1 }, 367.5, 0.5f);
	const gw_points points = scene_points(&s);
	gw_bake_options options = gw_bake_options_default();
	gw_bake_options_set_start(&options);
	options.max_error = 0.1f;
	gw_bake_result *r = scene_bake(&points, &lamp, 1, &options);
	double direct = scene_mean(r->direct_irradiance, r->count, 0);
	double all = direct + scene_mean(r->indirect_irradiance, r->count, 0);
	double stated = r->report.error.relative_rms;
	assert_in_range(r->report.surface_points, 45000, 51000);
	assert_false(r->report.missed);
	assert_true(stated > 0.0 && stated <= 0.1);
	assert_true(scene_has_stage(&r->report, "points beside"));
	assert_true(fabs(direct / (4.0 * SCENE_PI / 6.0) - 1.0) < stated);
	assert_true(fabs(all / (8.0 * SCENE_PI / 6.0) - 1.0) < stated);
	gw_bake_result_destroy(&r);
	scene_clear(&s);
}

/* Mean irradiance of a room's floor. */
static double light_of_floor(const scene *s, const gw_bake_result *r)
{
	double sum = 0.0, points = 0.0;
	for (size_t i = 0; i < s->count; i++) {
		if (s->normal[3 * i + 2] < 0.5f)
			continue;
		sum += (double)r->direct_irradiance[3 * i] + (double)r->indirect_irradiance[3 * i];
		points++;
	}
	return sum / points;
}

/* Of what a small square amid the ceiling sends out, 0.2394 gets to a floor that is as wide as it
 * is far off (Howell, configuration factor B-4, four times), spread over its 4 m^2. By all points,
 * a quarter and a sixteenth of them two lamps together are as right as the number of points on
 * them, as above; and each differs from that of all points by no more than is stated, within the
 * factor of 1.5 that holds for scans. */
static void lamps_light_what_is_far(void **state)
{
	(void)state;
	enum { LAMPS = 2 };
	const double area = 24.0 * LAMP_POINTS / ROOM_POINTS, known = SCENE_PI * 0.2394 * area / 4.0;
	for (int kind = 0; kind < 2; kind++) {
		double sum[3] = { 0 };
		for (uint64_t seed = 1; seed <= LAMPS; seed++) {
			scene s = room_with_lamp(seed, kind == 1);
			const gw_points points = scene_points(&s);
			double whole = 0.0, whole_off = 0.0;
			for (uint32_t k = 0; k < 3; k++) {
				gw_bake_options options = thinned(ROOM_POINTS >> 2 * k);
				options.surface_points = k > 0 ? options.surface_points : 0;
				options.rays = 64;
				gw_bake_result *r = scene_bake(&points, NULL, 0, &options);
				double light = light_of_floor(&s, r) / known, off = r->report.error.relative_rms;
				print_message("%.3f of what it is, stated %.3f\n", light, off);
				sum[k] += light / LAMPS;
				whole = k == 0 ? light : whole;
				whole_off = k == 0 ? off : whole_off;
				assert_true(fabs(light - whole) <= 1.5 * whole * hypot(off, whole_off));
				gw_bake_result_destroy(&r);
			}
			scene_clear(&s);
		}
		for (int k = 0; k < 3; k++)
			assert_true(fabs(sum[k] - 1.0) < 3.0 / sqrt(LAMPS * LAMP_POINTS));
	}
}

static void expect_refusal(const scene *s, const gw_bake_options *options, const char *text)
{
	const gw_points points = scene_points(s);
	const gw_light lamp = scene_point_light(0.5, 0.5, 1.0, 1.0f);
	const gw_scene_description description = { &points, &lamp, 1 };
	gw_bake_result *result = NULL;
	gw_error error;
	assert_int_equal(gw_bake(&description, options, NULL, &result, &error), GW_ERROR_USAGE);
	assert_non_null(strstr(error.text, text));
}

static void what_cannot_be_is_refused(void **state)
{
	(void)state;
	const gw_camera camera = { .tangent = 1.0 };
	const gw_region seen = { .camera = &camera, .aspect = 1.0 };
	const gw_transport transport = { 0 };
	scene s = uneven_square(2000);
	gw_bake_options options = thinned(1000);
	options.region = &seen;
	expect_refusal(&s, &options, "camera");
	options = thinned(1000);
	options.transport = &transport;
	expect_refusal(&s, &options, "transport");
	const gw_points points = scene_points(&s);
	const gw_scene_description description = { &points, NULL, 0 };
	gw_scene *prepared = NULL;
	gw_error error;
	options = thinned(1000);
	assert_int_equal(gw_scene_create(&description, &options, NULL, &prepared, &error),
					 GW_ERROR_USAGE);
	scene_clear(&s);
}

/* A part of the points of a hall; light that they got by the surface. */
static gw_bake_result *light_of(gw_lit_surface *surface, const gw_points *all, size_t first,
								size_t count)
{
	gw_error error;
	gw_bake_result *light;
	const gw_points part = { .count = count,
							 .position = all->position + 3 * first,
							 .normal = all->normal + 3 * first,
							 .albedo = all->albedo + 3 * first,
							 .emission = all->emission ? all->emission + 3 * first : NULL };
	assert_ok(gw_lit_surface_light(surface, &part, &light, &error), &error);
	assert_int_equal(light->count, count);
	return light;
}

/* A surface that was baked lights others part by part, whatever the parts, as it does when all
 * points are given at once; its own points get the light that they have, but for what those around
 * them add: the nearest counts by the square of its distance, which is none. */
static void lights_in_parts(void **state)
{
	(void)state;
	enum { PART = 777 };
	const gw_light lamp = scene_point_light(1.5, 1.0, 1.5, 3.0f);
	scene s = { .state = 1 };
	gw_error error;
	scene_make_small_hall(&s);
	const gw_points all = scene_points(&s);
	const gw_bake_options options = thinned(1500);
	gw_point_subset surface;
	choose(&all, 1500, &surface);
	gw_bake_result *lit = scene_bake(&surface.points, &lamp, 1, &options);
	gw_bake_result *thin = scene_bake(&all, &lamp, 1, &options);
	gw_lit_surface *by;
	assert_ok(gw_lit_surface_open(&surface.points, lit, &options, &by, &error), &error);
	gw_bake_result *whole = light_of(by, &all, 0, s.count);
	for (size_t first = 0; first < s.count; first += PART) {
		size_t left = s.count - first, count = left < PART ? left : PART;
		gw_bake_result *part = light_of(by, &all, first, count);
		assert_memory_equal(part->radiance, whole->radiance + 3 * first,
							3 * count * sizeof *part->radiance);
		assert_memory_equal(part->normal, whole->normal + 3 * first,
							3 * count * sizeof *part->normal);
		gw_bake_result_destroy(&part);
	}
	for (size_t i = 0; i < 3 * s.count; i++)
		assert_true(whole->radiance[i] == thin->radiance[i]);
	for (size_t k = 0; k < surface.points.count; k++)
		for (size_t c = 0; c < 3; c++) {
			double own = (double)lit->direct_irradiance[3 * k + c];
			double got = (double)whole->direct_irradiance[3 * surface.from[k] + c];
			/* 1e-6 of the reach counts as no distance; up to eight others around. */
			assert_true(fabs(got - own) <= 1e-4 * (own + 1.0));
		}
	double before = lit->report.error.relative_rms;
	gw_lit_surface_report(by, s.count, &lit->report);
	assert_int_equal(lit->report.surface_points, surface.points.count);
	assert_true(lit->report.error.between > 0.0 && lit->report.error.relative_rms > before);
	gw_lit_surface_close(&by);
	gw_lit_surface_close(&by);
	gw_bake_result_destroy(&whole);
	gw_bake_result_destroy(&thin);
	gw_bake_result_destroy(&lit);
	gw_point_subset_clear(&surface);
	scene_clear(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(evenly_thinned),
		cmocka_unit_test(order_is_no_matter),
		cmocka_unit_test(strays_widen_no_cubes),
		cmocka_unit_test(means_are_kept),
		cmocka_unit_test(images_stay_images),
		cmocka_unit_test(images_keep_their_lamps),
		cmocka_unit_test(lamps_keep_their_power),
		cmocka_unit_test(each_has_its_albedo),
		cmocka_unit_test(sheets_keep_their_sides),
		cmocka_unit_test(the_error_is_known),
		cmocka_unit_test(lamps_light_what_is_far),
		cmocka_unit_test(same_by_any_threads),
		cmocka_unit_test(memory_says_how_many),
		cmocka_unit_test(memory_is_foretold),
		cmocka_unit_test(points_that_take_more_are_fewer),
		cmocka_unit_test(an_error_asks_for_more),
		cmocka_unit_test(an_error_takes_few_points),
		cmocka_unit_test(what_cannot_be_is_refused),
		cmocka_unit_test(lights_in_parts),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

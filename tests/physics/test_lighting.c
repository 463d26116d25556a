/* One scene lit many times: by the parts of its light, and from what an earlier bake kept; and what
 * its records say besides light. */
#include "scenes.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define LIGHTS 3u

static void make_lights(gw_light lights[LIGHTS])
{
	lights[0] = scene_point_light(1.0, 1.0, 1.2, 2.0f);
	lights[1] = (gw_light){ .type = GW_LIGHT_SUN,
							.direction = { 0.2, 1.0, -0.4 },
							.irradiance = { 3.0f, 2.5f, 2.0f } };
	lights[2] = (gw_light){ .type = GW_LIGHT_ENVIRONMENT, .radiance = { 0.2f, 0.3f, 0.5f } };
}

static gw_bake_options options_of(gw_method method)
{
	gw_bake_options options = gw_bake_options_default();
	options.method = method;
	options.rays = options.light_samples = 16; /* bakes are compared with each other */
	options.cones = 4;
	options.estimate_points = 20;
	return options;
}

/* ------------------------------------------------------------------------------------- parts */

/* RMS of the sum of all parts less the whole, relative to the whole's. */
static double difference_of_sum(const gw_bake_result *r)
{
	double squares = 0.0, own = 0.0;
	for (size_t i = 0; i < 3 * r->count; i++) {
		double sum = r->rest ? (double)r->rest[i] : 0.0;
		for (size_t l = 0; l < r->lamp_count; l++)
			sum += (double)r->lamp[l][i];
		squares += (sum - (double)r->radiance[i]) * (sum - (double)r->radiance[i]);
		own += (double)r->radiance[i] * (double)r->radiance[i];
	}
	return sqrt(squares / own);
}

static void check_parts(void (*make)(scene *s), gw_method method, double tolerance)
{
	scene lit = { 0 };
	gw_light lights[LIGHTS];
	make_lights(lights);
	make(&lit);
	const gw_points points = scene_points(&lit);
	gw_bake_options options = options_of(method);
	gw_bake_result *plain = scene_bake(&points, lights, LIGHTS, &options);
	options.lamps = true;
	gw_bake_result *r = scene_bake(&points, lights, LIGHTS, &options);
	assert_memory_equal(plain->radiance, r->radiance, 3 * r->count * sizeof(float));
	assert_int_equal(r->lamp_count, LIGHTS);
	assert_true((r->rest != NULL) == lit.emits);
	for (size_t l = 0; l < LIGHTS; l++)
		assert_true(scene_mean(r->lamp[l], r->count, 0) > 0.0);
	double off = difference_of_sum(r);
	if (!(off <= tolerance))
		fail_msg("the parts differ from the whole by %g of it", off);
	gw_bake_result_destroy(&plain);
	gw_bake_result_destroy(&r);
	scene_clear(&lit);
}

/* Numbers of 24 bits: each is rounded by 2^-25 of itself some dozens of times on its way, by chance
 * up and down, so 2^-25 * sqrt(100) and as much for the whole; 16 times as much cannot be that. */
static void parts_make_the_whole(void **state)
{
	(void)state;
	check_parts(scene_make_small_hall, GW_METHOD_RAYS, 1e-5);
}

static void parts_through_an_opening(void **state)
{
	(void)state;
	check_parts(scene_make_cellar, GW_METHOD_RAYS, 1e-5);
}

/* Cones read numbers of 11 bits: each part is rounded by 2^-12 of itself at each voxel, and means
 * over many voxels are better than that. */
static void parts_by_cones(void **state)
{
	(void)state;
	check_parts(scene_make_small_hall, GW_METHOD_CONES, 0x1p-12);
}

/* A small patch is lit so brightly that it is sampled: parts must be by the samples of the whole.
 */
static void parts_of_a_patch(void **state)
{
	(void)state;
	scene hall = { 0 };
	gw_light lights[2] = { scene_point_light(1.0, 1.0, 0.02, 1.0f),
						   scene_point_light(3.0, 1.5, 0.02, 2.0f) };
	scene_make_small_hall(&hall);
	gw_points points = scene_points(&hall);
	points.emission = NULL;
	gw_bake_options options = options_of(GW_METHOD_RAYS);
	options.lamps = true;
	gw_bake_result *r = scene_bake(&points, lights, 2, &options);
	assert_null(r->rest);
	double off = difference_of_sum(r);
	if (!(off <= 1e-5))
		fail_msg("the parts differ from the whole by %g of it", off);
	gw_bake_result_destroy(&r);
	scene_clear(&hall);
}

/* -------------------------------------------------------------------------------- transports */

/* A scene and its transport. */
typedef struct fixture {
	scene scene;
	gw_points points;
	gw_light lights[LIGHTS];
	gw_bake_options options;
	scene_bytes kept;
	gw_bake_result *first;
} fixture;

static void set_up_with(fixture *f, void (*make)(scene *s), const gw_bake_options *own)
{
	*f = (fixture){ .options = *own, .kept = { .limit = SIZE_MAX } };
	make_lights(f->lights);
	make(&f->scene);
	f->points = scene_points(&f->scene);
	gw_bake_options options = f->options;
	const gw_transport transport = { .name = "kept", .write = scene_keep_bytes, .user = &f->kept };
	options.transport = &transport;
	f->first = scene_bake(&f->points, f->lights, LIGHTS, &options);
}

static void set_up(fixture *f, void (*make)(scene *s), gw_method method)
{
	const gw_bake_options options = options_of(method);
	set_up_with(f, make, &options);
}

static void tear_down(fixture *f)
{
	gw_bake_result_destroy(&f->first);
	free(f->kept.data);
	scene_clear(&f->scene);
}

static gw_bake_result *relight(const fixture *f, const gw_points *points)
{
	gw_bake_options options = f->options;
	const gw_transport transport = { .name = "kept",
									 .data = f->kept.data,
									 .length = f->kept.length };
	options.transport = &transport;
	gw_bake_result *r = scene_bake(points, f->lights, LIGHTS, &options);
	assert_false(scene_has_stage(&r->report, "octree"));
	return r;
}

static void assert_same_bytes(const gw_bake_result *a, const gw_bake_result *b)
{
	size_t bytes = 3 * a->count * sizeof(float);
	assert_int_equal(a->count, b->count);
	assert_memory_equal(a->radiance, b->radiance, bytes);
	assert_memory_equal(a->direct_irradiance, b->direct_irradiance, bytes);
	assert_memory_equal(a->indirect_irradiance, b->indirect_irradiance, bytes);
	assert_memory_equal(a->normal, b->normal, bytes);
	assert_memory_equal(a->roi, b->roi, a->count * sizeof(float));
	assert_memory_equal(&a->report.error, &b->report.error, sizeof a->report.error);
}

static void same_and_other_lights(void (*make)(scene *s), gw_method method)
{
	fixture f;
	set_up(&f, make, method);
	gw_bake_result *again = relight(&f, &f.points);
	assert_same_bytes(f.first, again);
	gw_bake_result_destroy(&again);
	/* Lamps moved: as a bake from the start. */
	f.lights[0].position[0] += 1.0;
	f.lights[2].radiance[0] = 2.0f;
	f.options.bounces = 4;
	gw_bake_result *fresh = scene_bake(&f.points, f.lights, LIGHTS, &f.options);
	again = relight(&f, &f.points);
	assert_same_bytes(fresh, again);
	gw_bake_result_destroy(&again);
	gw_bake_result_destroy(&fresh);
	tear_down(&f);
}

static void lit_again_by_rays(void **state)
{
	(void)state;
	same_and_other_lights(scene_make_small_hall, GW_METHOD_RAYS);
}

static void lit_again_through_an_opening(void **state)
{
	(void)state;
	same_and_other_lights(scene_make_cellar, GW_METHOD_RAYS);
}

/* A room that is lit and one beside it into which nothing gets: what rock keeps apart is not found
 * again, but kept. */
static void make_shut_rooms(scene *s)
{
	scene_add_box(s, (double[3]){ 0.0, 0.0, 0.0 }, (double[3]){ 3.0, 2.0, 2.0 }, 10.0, 0.5f);
	scene_add_box(s, (double[3]){ 3.1, 0.0, 0.0 }, (double[3]){ 2.0, 2.0, 2.0 }, 10.0, 0.5f);
}

static void lit_again_amid_rock(void **state)
{
	(void)state;
	same_and_other_lights(make_shut_rooms, GW_METHOD_RAYS);
	same_and_other_lights(make_shut_rooms, GW_METHOD_CONES);
}

static void lit_again_by_cones(void **state)
{
	(void)state;
	same_and_other_lights(scene_make_small_hall, GW_METHOD_CONES);
}

/* A coarse room about a ball whose points are much denser, so that discs of the walls are too large
 * for leaves: lamps shine on them by themselves. They are too few for bakes of halves, which are
 * not made with a transport. */
static void make_uneven(scene *s)
{
	*s = (scene){ 0 };
	scene_add_box(s, (double[3]){ 0, 0, 0 }, (double[3]){ 2, 2, 2 }, 3, 0.5f);
	scene_add_sphere(s, (double[3]){ 1, 1, 0.5 }, 0.05, 280, 1, 0.5f);
}

static void lit_again_on_large_discs(void **state)
{
	(void)state;
	same_and_other_lights(make_uneven, GW_METHOD_RAYS);
}

/* Means over facets are taken in another order than the octree's: 24 bits each, some hundred terms;
 * samples follow shares of power, which a rounding can turn from one facet to its neighbour. */
static void other_emission(void **state)
{
	(void)state;
	fixture f;
	set_up(&f, scene_make_small_hall, GW_METHOD_RAYS);
	float *emission = calloc(f.points.count, 3 * sizeof *emission);
	assert_non_null(emission);
	for (size_t i = 0; i < 3 * f.points.count; i++)
		emission[i] = 3.0f * f.points.emission[i];
	gw_points other = f.points;
	other.emission = emission;
	gw_bake_result *fresh = scene_bake(&other, f.lights, LIGHTS, &f.options);
	gw_bake_result *again = relight(&f, &other);
	for (size_t k = 0; k < 3; k++) {
		double a = scene_mean(fresh->radiance, fresh->count, k);
		double b = scene_mean(again->radiance, again->count, k);
		if (!(fabs(a - b) <= 1e-3 * a))
			fail_msg("means %g and %g", a, b);
	}
	gw_bake_result_destroy(&fresh);
	gw_bake_result_destroy(&again);
	/* None at all. */
	other.emission = NULL;
	fresh = scene_bake(&other, f.lights, LIGHTS, &f.options);
	again = relight(&f, &other);
	assert_same_bytes(fresh, again);
	gw_bake_result_destroy(&fresh);
	gw_bake_result_destroy(&again);
	free(emission);
	tear_down(&f);
}

/* Few records, to which the next light adds some: as if all had begun with it; and the transport
 * that has these, too, needs none more. */
static void records_are_added(void **state)
{
	(void)state;
	fixture f;
	gw_bake_options few = options_of(GW_METHOD_RAYS);
	few.most_records = 100;
	few.gathered_error = 1.0f; /* of anything */
	set_up_with(&f, scene_make_small_hall, &few);
	f.options.gathered_error = 1e-3f; /* which 16 rays a record never reach */
	gw_bake_options options = f.options;
	scene_bytes more = { .limit = SIZE_MAX };
	const gw_transport transport = { .name = "kept",
									 .data = f.kept.data,
									 .length = f.kept.length,
									 .write = scene_keep_bytes,
									 .user = &more };
	options.transport = &transport;
	gw_bake_result *again = scene_bake(&f.points, f.lights, LIGHTS, &options);
	gw_bake_result *fresh = scene_bake(&f.points, f.lights, LIGHTS, &f.options);
	assert_true(again->report.records > f.first->report.records);
	assert_int_equal(again->report.records, fresh->report.records);
	assert_same_bytes(fresh, again);
	f.options.gathered_error = few.gathered_error;
	free(f.kept.data);
	f.kept = more;
	gw_bake_result *third = relight(&f, &f.points);
	assert_int_equal(third->report.records, again->report.records);
	assert_same_bytes(again, third);
	gw_bake_result_destroy(&again);
	gw_bake_result_destroy(&fresh);
	gw_bake_result_destroy(&third);
	tear_down(&f);
}

/* ------------------------------------------------------------------- points of one place */

#define DOUBLES 50u

/* A hall with points at the place of others, as black as can be; they are its last. */
static void make_doubled(scene *s)
{
	scene_make_small_hall(s);
	size_t count = s->count;
	for (size_t i = 0; i < DOUBLES; i++) {
		size_t of = i * (count / DOUBLES);
		const double position[3] = { s->position[3 * of], s->position[3 * of + 1],
									 s->position[3 * of + 2] };
		const float *n = s->normal + 3 * of;
		scene_add(s, position, (double[]){ (double)n[0], (double)n[1], (double)n[2] }, 0.0f);
	}
}

/* One irradiance, and each point's own albedo: to the last bit. */
static void assert_own_albedo(const scene *s, const gw_bake_result *r)
{
	size_t count = s->count - DOUBLES, lit = 0;
	for (size_t i = 0; i < DOUBLES; i++) {
		size_t of = i * (count / DOUBLES), at = count + i;
		for (size_t c = 0; c < 3; c++) {
			assert_true(r->direct_irradiance[3 * at + c] == r->direct_irradiance[3 * of + c]);
			assert_true(r->indirect_irradiance[3 * at + c] == r->indirect_irradiance[3 * of + c]);
			assert_true(r->albedo[3 * at + c] == 0.0f && r->albedo[3 * of + c] > 0.0f);
			assert_true(r->albedo[3 * of + c] == s->albedo[3 * of + c]);
			/* Above the lamp, whose back is rock, it is dark. */
			bool dark = r->direct_irradiance[3 * of + c] + r->indirect_irradiance[3 * of + c] == 0;
			lit += !dark;
			assert_true(dark || r->radiance[3 * at + c] < r->radiance[3 * of + c]);
		}
	}
	assert_true(lit >= 3 * (DOUBLES - 2));
}

static void points_of_one_place_keep_their_albedo(void **state)
{
	(void)state;
	fixture f;
	set_up(&f, make_doubled, GW_METHOD_RAYS);
	assert_own_albedo(&f.scene, f.first);
	gw_bake_result *again = relight(&f, &f.points);
	assert_same_bytes(f.first, again);
	gw_bake_result_destroy(&again);
	/* As parts of its light, and in frames. */
	f.options.lamps = true;
	again = scene_bake(&f.points, f.lights, LIGHTS, &f.options);
	assert_true(difference_of_sum(again) <= 1e-5); /* as in parts_make_the_whole */
	gw_bake_result_destroy(&again);
	f.options.lamps = false;
	const gw_mover mover = { .first = 0, .count = 100 };
	const double still[16] = { [0] = 1, [5] = 1, [10] = 1, [15] = 1 };
	const gw_motion motion = {
		.mover = &mover, .mover_count = 1, .frame_count = 1, .matrix = still
	};
	const gw_frames_options in_frames = { .rebuild = false };
	gw_frames *frames = NULL;
	gw_error error;
	assert_int_equal(gw_frames_open(&(gw_moving_scene){ { &f.points, f.lights, LIGHTS }, &motion },
									&f.options, &in_frames, NULL, &frames, &error),
					 GW_OK);
	assert_int_equal(gw_frames_bake(frames, 0, f.lights, LIGHTS, &again, &error), GW_OK);
	assert_true(again->albedo[3 * (f.scene.count - 1)] == 0.0f);
	gw_bake_result_destroy(&again);
	gw_frames_close(&frames);
	tear_down(&f);
}

/* A bake that must fail: its class, with a sentence that names the transport. */
static void refuse(const fixture *f, const gw_points *points, const gw_bake_options *options,
				   const void *data, size_t length, gw_status expected)
{
	gw_bake_options own = *options;
	const gw_transport transport = { .name = "kept", .data = data, .length = length };
	gw_bake_result *result = NULL;
	gw_error error = { 0 };
	own.transport = &transport;
	gw_status status =
		gw_bake(&(gw_scene_description){ points, f->lights, LIGHTS }, &own, NULL, &result, &error);
	if (status != expected || result != NULL || strstr(error.text, "kept") == NULL)
		fail_msg("status %d: %s", (int)status, error.text);
}

static void damaged_ones_are_refused(void **state)
{
	(void)state;
	fixture f;
	set_up(&f, scene_make_small_hall, GW_METHOD_RAYS);
	unsigned char *copy = malloc(f.kept.length + 8);
	assert_non_null(copy);
	/* Cut short, in memory of that length, and with bytes too many. */
	for (size_t k = 0; k < 24; k++) {
		size_t length = k < 12 ? k * 97 : f.kept.length / 12 * (k - 12) + (k & 7u);
		unsigned char *cut = malloc(length ? length : 1);
		assert_non_null(cut);
		memcpy(cut, f.kept.data, length);
		refuse(&f, &f.points, &f.options, cut, length, GW_ERROR_DATA);
		free(cut);
	}
	memcpy(copy, f.kept.data, f.kept.length);
	memset(copy + f.kept.length, 0, 8);
	refuse(&f, &f.points, &f.options, copy, f.kept.length + 8, GW_ERROR_DATA);
	/* One bit turned, in the head and anywhere. */
	for (size_t k = 0; k < 60; k++) {
		size_t at = k < 20 ? 24 + 17 * k : (size_t)(scene_random(&f.scene) * (double)f.kept.length);
		copy[at] ^= (unsigned char)(1u << k % 8);
		refuse(&f, &f.points, &f.options, copy, f.kept.length, GW_ERROR_DATA);
		copy[at] = f.kept.data[at];
	}
	free(copy);
	tear_down(&f);
}

static void others_are_refused(void **state)
{
	(void)state;
	fixture f;
	set_up(&f, scene_make_small_hall, GW_METHOD_RAYS);
	gw_points other = f.points;
	double old = f.scene.position[7];
	other.count--;
	refuse(&f, &other, &f.options, f.kept.data, f.kept.length, GW_ERROR_DATA);
	f.scene.position[7] += 0x1p-20;
	refuse(&f, &f.points, &f.options, f.kept.data, f.kept.length, GW_ERROR_DATA);
	f.scene.position[7] = old;
	other = f.points;
	other.normal = NULL;
	refuse(&f, &other, &f.options, f.kept.data, f.kept.length, GW_ERROR_DATA);
	other = f.points;
	other.albedo = NULL;
	refuse(&f, &other, &f.options, f.kept.data, f.kept.length, GW_ERROR_DATA);
	gw_bake_options options[5];
	for (size_t i = 0; i < 5; i++)
		options[i] = f.options;
	options[0].rays = 63;
	options[1].record_spacing = 2.0f;
	options[2].seed = 1;
	options[3].depth = 5;
	options[4].method = GW_METHOD_CONES;
	for (size_t i = 0; i < 5; i++)
		refuse(&f, &f.points, &options[i], f.kept.data, f.kept.length, GW_ERROR_USAGE);
	tear_down(&f);
}

static void writes_may_fail(void **state)
{
	(void)state;
	fixture f;
	set_up(&f, scene_make_small_hall, GW_METHOD_RAYS);
	const size_t limits[] = { 0, 100, f.kept.length / 2, f.kept.length - 1 };
	for (size_t i = 0; i < 4; i++) {
		scene_bytes full = { .limit = limits[i] };
		const gw_transport transport = { .name = "kept", .write = scene_keep_bytes, .user = &full };
		gw_bake_options options = f.options;
		gw_bake_result *result = NULL;
		gw_error error = { 0 };
		options.transport = &transport;
		assert_int_equal(gw_bake(&(gw_scene_description){ &f.points, f.lights, LIGHTS }, &options,
								 NULL, &result, &error),
						 GW_STATUS_OF_CALLER);
		assert_string_equal(error.text, "the disk of this test is full");
		assert_null(result);
		free(full.data);
	}
	tear_down(&f);
}

/* ------------------------------------------------------------------------- what records know */

/* Form factor from a small floor to a wall of width 2 * half that begins at it and is `height`
 * high, at a distance before its middle: twice that of a rectangle at right angles. */
static double wall_share(double distance, double half, double height)
{
	double x = height / half, y = distance / half, r = sqrt(x * x + y * y);
	return (atan(1.0 / y) - y / r * atan(1.0 / r)) / SCENE_PI;
}

static void make_wall(scene *s)
{
	*s = (scene){ .state = 11 };
	scene_add_patch(s,
					&(scene_patch){ (double[]){ 0, -2, 0 }, (double[]){ 2, 0, 0 },
									(double[]){ 0, 4, 0 }, 100, 200 },
					0.5f);
	scene_add_patch(s,
					&(scene_patch){ (double[]){ 0, -2, 0 }, (double[]){ 0, 4, 0 },
									(double[]){ 0, 0, 1 }, 200, 50 },
					0.5f);
}

static gw_bake_result *bake_ambient_occlusion(const scene *s, float distance)
{
	const gw_points points = scene_points(s);
	gw_bake_options options = gw_bake_options_default();
	options.ambient_occlusion = true;
	options.ambient_occlusion_distance = distance;
	return scene_bake(&points, NULL, 0, &options);
}

/* 64 rays a record, at most half of them at the wall, and at least 3 records a point: the standard
 * error is sqrt(0.5 * 0.5 / 64 / 3) = 0.036 if directions were drawn at random; they are spread
 * evenly, which is better. Points of the floor in the middle third, where the wall's ends are far.
 */
static void ambient_occlusion_beside_a_wall(void **state)
{
	(void)state;
	scene s;
	make_wall(&s);
	gw_bake_result *r = bake_ambient_occlusion(&s, 0.0f);
	double squares = 0.0, sum = 0.0, n = 0.0;
	for (size_t i = 0; i < s.count; i++) {
		const double *p = s.position + 3 * i;
		assert_true(r->ambient_occlusion[i] >= 0.0f && r->ambient_occlusion[i] <= 1.00001f);
		if (p[2] > 0.0 || p[0] < 0.05 || fabs(p[1]) > 0.02)
			continue;
		double off = (double)r->ambient_occlusion[i] - (1.0 - wall_share(p[0], 2.0, 1.0));
		squares += off * off;
		sum += off;
		n += 1.0;
	}
	assert_true(n > 100.0);
	if (!(sqrt(squares / n) <= 0.036 && fabs(sum / n) <= 0.018))
		fail_msg("RMS %g, mean %g over %g points", sqrt(squares / n), sum / n, n);
	gw_bake_result_destroy(&r);
	scene_clear(&s);
}

/* The light that would come from such a wall, as a vector: of each direction the cosine at the
 * floor, summed over the wall by its solid angle. */
static void wall_vector(double distance, double half, double height, double sum[3])
{
	const int columns = 200, rows = 100;
	double area = 2.0 * half / columns * height / rows;
	for (int k = 0; k < 3; k++)
		sum[k] = 0.0;
	for (int i = 0; i < columns * rows; i++) {
		double y = half * (2.0 * (i % columns + 0.5) / columns - 1.0);
		double z = height * (i / columns + 0.5) / rows;
		double way[3] = { -distance, y, z }, r = sqrt(distance * distance + y * y + z * z);
		double share = z / r * distance / r * area / (r * r);
		for (int k = 0; k < 3; k++)
			sum[k] += share * way[k] / r;
	}
}

/* Of the open hemisphere the same sum is 2 pi / 3 along the normal, so a bent normal leans away
 * from the wall by a known angle. Rays that are drawn at random have a variance of 0.25 across; of
 * 64 rays of 3 records that is 0.036 of a mean that is at least 0.5 long. */
static void bent_normals_beside_a_wall(void **state)
{
	(void)state;
	scene s;
	make_wall(&s);
	const gw_points points = scene_points(&s);
	gw_bake_options options = gw_bake_options_default();
	options.bent_normals = true;
	gw_bake_result *r = scene_bake(&points, NULL, 0, &options);
	assert_null(r->ambient_occlusion);
	double squares = 0.0, sum = 0.0, n = 0.0, most = 0.0;
	for (size_t i = 0; i < s.count; i++) {
		const double *p = s.position + 3 * i;
		const float *bent = r->bent_normal + 3 * i;
		double wall[3], length = 0.0;
		for (int k = 0; k < 3; k++)
			length += (double)bent[k] * (double)bent[k];
		assert_true(fabs(length - 1.0) < 1e-5);
		if (p[2] > 0.0 || p[0] < 0.05 || fabs(p[1]) > 0.02)
			continue;
		wall_vector(p[0], 2.0, 1.0, wall);
		double lean = atan2(-wall[0], SCENE_PI * 2.0 / 3.0 - wall[2]);
		double off = atan2((double)bent[0], (double)bent[2]) - lean;
		squares += off * off + (double)bent[1] * (double)bent[1];
		sum += off;
		n += 1.0;
		most = fmax(most, lean);
	}
	assert_true(n > 100.0 && most > 0.4);
	if (!(sqrt(squares / n) <= 0.072 && fabs(sum / n) <= 0.018))
		fail_msg("RMS %g, mean %g over %g points", sqrt(squares / n), sum / n, n);
	gw_bake_result_destroy(&r);
	scene_clear(&s);
}

/* Farther away than the distance and the reach of interpolation, the wall is not there. */
static void ambient_occlusion_within_a_distance(void **state)
{
	(void)state;
	scene s;
	make_wall(&s);
	gw_bake_result *r = bake_ambient_occlusion(&s, 0.25f);
	double reach = 0.25 + 4.0 * r->report.leaf_size, near = 0.0, n = 0.0;
	for (size_t i = 0; i < s.count; i++) {
		const double *p = s.position + 3 * i;
		if (p[2] == 0.0 && p[0] > reach)
			assert_true(r->ambient_occlusion[i] > 0.9999f);
		if (p[2] == 0.0 && p[0] < 0.1) {
			near += (double)r->ambient_occlusion[i];
			n += 1.0;
		}
	}
	assert_true(near / n < 0.9);
	gw_bake_result_destroy(&r);
	scene_clear(&s);
}

/* Sixteen times the rays are a quarter of the noise. What light changes within the reach of a
 * record stays, and in this coarse scene it is most: noise that is 15 % of the first figure is
 * enough. */
static void errors_fall_with_rays(void **state)
{
	(void)state;
	scene hall = { 0 };
	gw_light lights[LIGHTS];
	make_lights(lights);
	scene_make_small_hall(&hall);
	const gw_points points = scene_points(&hall);
	double mean[2];
	for (int i = 0; i < 2; i++) {
		gw_bake_options options = options_of(GW_METHOD_RAYS);
		options.errors = true;
		options.rays = options.light_samples = i ? 256 : 16;
		gw_bake_result *r = scene_bake(&points, lights, LIGHTS, &options);
		mean[i] = 0.0;
		for (size_t p = 0; p < r->count; p++) {
			assert_true(isfinite(r->error[p]) && r->error[p] >= 0.0f);
			mean[i] += (double)r->error[p] / (double)r->count;
		}
		gw_bake_result_destroy(&r);
	}
	if (!(mean[1] > 0.0 && mean[1] < 0.9 * mean[0]))
		fail_msg("%g with few rays, %g with many", mean[0], mean[1]);
	scene_clear(&hall);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(parts_make_the_whole),
		cmocka_unit_test(parts_through_an_opening),
		cmocka_unit_test(parts_by_cones),
		cmocka_unit_test(parts_of_a_patch),
		cmocka_unit_test(lit_again_by_rays),
		cmocka_unit_test(lit_again_through_an_opening),
		cmocka_unit_test(lit_again_by_cones),
		cmocka_unit_test(lit_again_amid_rock),
		cmocka_unit_test(lit_again_on_large_discs),
		cmocka_unit_test(other_emission),
		cmocka_unit_test(records_are_added),
		cmocka_unit_test(damaged_ones_are_refused),
		cmocka_unit_test(others_are_refused),
		cmocka_unit_test(writes_may_fail),
		cmocka_unit_test(points_of_one_place_keep_their_albedo),
		cmocka_unit_test(ambient_occlusion_beside_a_wall),
		cmocka_unit_test(ambient_occlusion_within_a_distance),
		cmocka_unit_test(bent_normals_beside_a_wall),
		cmocka_unit_test(errors_fall_with_rays),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

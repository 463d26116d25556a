/* Frames of scenes in which objects and lamps move: each must be what a bake of that frame from
 * scratch is, and when everything is back where it was, so must the light be. */
#include "scenes.h"
#include "expected.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define FRAMES 4u

/* A room with a cube that travels through it, and where it is. */
typedef struct stage_play {
	scene scene;
	gw_points points;
	gw_mover mover;
	double matrix[16 * FRAMES];
	gw_motion motion;
	gw_light light[FRAMES];
} stage_play;

static void add_cube(scene *s, double side, size_t n, float albedo)
{
	const double low = -0.5 * side, high = 0.5 * side;
	const double u[3] = { side, 0, 0 }, v[3] = { 0, side, 0 }, w[3] = { 0, 0, side };
	scene_add_patch(s, &(scene_patch){ (double[3]){ low, low, high }, u, v, n, n }, albedo);
	scene_add_patch(s, &(scene_patch){ (double[3]){ low, low, low }, v, u, n, n }, albedo);
	scene_add_patch(s, &(scene_patch){ (double[3]){ high, low, low }, v, w, n, n }, albedo);
	scene_add_patch(s, &(scene_patch){ (double[3]){ low, low, low }, w, v, n, n }, albedo);
	scene_add_patch(s, &(scene_patch){ (double[3]){ low, low, low }, u, w, n, n }, albedo);
	scene_add_patch(s, &(scene_patch){ (double[3]){ low, high, low }, w, u, n, n }, albedo);
}

/* Turned about z, scaled, and put somewhere. */
static void place(double m[16], double degrees, double scale, double x, double y, double z)
{
	double c = scale * cos(degrees * SCENE_PI / 180), s = scale * sin(degrees * SCENE_PI / 180);
	const double rows[16] = { c, -s, 0, x, s, c, 0, y, 0, 0, scale, z, 0, 0, 0, 1 };
	memcpy(m, rows, sizeof rows);
}

/* The cube is at its start in frames 0 and 3, beside the wall in 1, smaller and turned in 2; the
 * lamp moves with `lamp`. */
static void make_play(stage_play *p, double per_metre, bool lamp)
{
	memset(p, 0, sizeof *p);
	scene_add_box(&p->scene, (double[3]){ 0, 0, 0 }, (double[3]){ 4, 3, 2.5 }, per_metre, 0.6f);
	p->mover.first = p->scene.count;
	add_cube(&p->scene, 0.6, (size_t)(0.6 * per_metre), 0.7f);
	p->mover.count = p->scene.count - p->mover.first;
	p->points = scene_points(&p->scene);
	place(p->matrix, 10, 1, 1.2, 1.1, 0.31);
	place(p->matrix + 16, 50, 1, 3.4, 2.3, 0.31);
	place(p->matrix + 32, 33, 0.7, 2.1, 1.4, 1.2);
	memcpy(p->matrix + 48, p->matrix, 16 * sizeof(double));
	p->motion = (gw_motion){
		.mover = &p->mover, .mover_count = 1, .frame_count = FRAMES, .matrix = p->matrix
	};
	for (size_t f = 0; f < FRAMES; f++)
		p->light[f] = scene_point_light(2 + (lamp && f < 3 ? 0.4 * (double)f : 0), 1.5, 2.2, 10);
}

static gw_bake_options options_of(void)
{
	gw_bake_options options = gw_bake_options_default();
	options.estimate_points = 0;
	scene_choose_passes(&options.passes, &options.validate);
	return options;
}

/* Bakes the frames that `order` lists, into `result`, which the caller destroys. */
static void play(stage_play *p, gw_frames_options how, const size_t *order, size_t count,
				 gw_bake_result **result)
{
	gw_error error = { 0 };
	gw_frames *frames;
	gw_bake_options options = options_of();
	if (gw_frames_open(&(gw_moving_scene){ { &p->points, p->light, 1 }, &p->motion }, &options,
					   &how, NULL, &frames, &error) != GW_OK)
		fail_msg("%s", error.text);
	for (size_t i = 0; i < count; i++) {
		assert_ok(gw_frames_bake(frames, order[i], &p->light[order[i]], 1, &result[i], &error),
				  &error);
	}
	gw_frames_close(&frames);
}

/* RMS of the differences of two lightings, relative to the mean radiance. */
static double difference(const gw_bake_result *a, const gw_bake_result *b, double *largest)
{
	double sum = 0, squares = 0;
	size_t n = 3 * a->count;
	assert_int_equal(a->count, b->count);
	*largest = 0;
	for (size_t i = 0; i < n; i++) {
		double d = (double)a->radiance[i] - (double)b->radiance[i];
		sum += (double)b->radiance[i];
		squares += d * d;
		*largest = fmax(*largest, fabs(d));
	}
	double mean = sum / (double)n;
	*largest /= mean;
	return sqrt(squares / (double)n) / mean;
}

static void destroy_all(gw_bake_result **result, size_t count)
{
	for (size_t i = 0; i < count; i++)
		gw_bake_result_destroy(&result[i]);
}

static const size_t in_order[FRAMES] = { 0, 1, 2, 3 };

/*
 * Only rays that pass the edge of a cell by less than the walk's steps of 1e-5 to 1e-4 cells may
 * hit something else than from scratch: at most 1e-4 of 64 rays a record times the cells on their
 * way, each worth 1/64 of the light there. Half a thousandth leaves room; what a cube changes in
 * these rooms is a hundred times as much, which is looked at, too.
 */
static void test_equals_scratch(void **state)
{
	stage_play p;
	gw_bake_result *shared[FRAMES], *scratch[FRAMES];
	(void)state;
	make_play(&p, 25, true);
	play(&p, (gw_frames_options){ .independent = true }, in_order, FRAMES, shared);
	play(&p, (gw_frames_options){ .rebuild = true }, in_order, FRAMES, scratch);
	for (size_t f = 0; f < FRAMES; f++) {
		double largest, rms = difference(shared[f], scratch[f], &largest);
		print_message("frame %zu: RMS %.2e, largest %.2e of the mean\n", f, rms, largest);
		assert_true(rms < 5e-4);
	}
	double largest;
	assert_true(difference(scratch[0], scratch[1], &largest) > 0.05);
	destroy_all(shared, FRAMES);
	destroy_all(scratch, FRAMES);
	scene_clear(&p.scene);
}

/* Back at the start, and in another order: the same bytes. */
static void test_comes_back(void **state)
{
	static const size_t other_order[FRAMES] = { 2, 3, 0, 1 };
	stage_play p;
	gw_bake_result *first[FRAMES], *second[FRAMES];
	(void)state;
	make_play(&p, 20, true);
	play(&p, (gw_frames_options){ .independent = true }, in_order, FRAMES, first);
	play(&p, (gw_frames_options){ .independent = true }, other_order, FRAMES, second);
	size_t bytes = 3 * p.scene.count * sizeof(float);
	assert_memory_equal(first[0]->radiance, first[3]->radiance, bytes);
	for (size_t i = 0; i < FRAMES; i++)
		assert_memory_equal(second[i]->radiance, first[other_order[i]]->radiance, bytes);
	destroy_all(first, FRAMES);
	destroy_all(second, FRAMES);
	scene_clear(&p.scene);
}

/* Bounces stop when what is left is below the tolerance, 0.001 of the light: two solutions differ
 * by at most twice that on average, and by their RMS a little more where light is concentrated. */
static void test_carries_light(void **state)
{
	stage_play p;
	gw_bake_result *carried[FRAMES], *scratch[FRAMES];
	(void)state;
	make_play(&p, 25, true);
	play(&p, (gw_frames_options){ .independent = false }, in_order, FRAMES, carried);
	play(&p, (gw_frames_options){ .independent = true }, in_order, FRAMES, scratch);
	for (size_t f = 0; f < FRAMES; f++) {
		double largest, rms = difference(carried[f], scratch[f], &largest);
		print_message("frame %zu: RMS %.2e, largest %.2e of the mean, %u bounces for %u\n", f, rms,
					  largest, carried[f]->report.bounce_count, scratch[f]->report.bounce_count);
		assert_true(rms < 3e-3);
		assert_true(f == 0 || carried[f]->report.bounce_count < scratch[f]->report.bounce_count);
		assert_true(carried[f]->report.remaining <= 0.001);
	}
	destroy_all(carried, FRAMES);
	destroy_all(scratch, FRAMES);
	scene_clear(&p.scene);
}

/* Without movers, frames are lightings of one geometry: the very bytes of bakes of their own. */
static void test_lamps_alone(void **state)
{
	stage_play p;
	gw_bake_result *frame[FRAMES];
	(void)state;
	make_play(&p, 20, true);
	p.motion.mover_count = 0;
	play(&p, (gw_frames_options){ .independent = true }, in_order, FRAMES, frame);
	for (size_t f = 0; f < FRAMES; f++) {
		gw_bake_options options = options_of();
		gw_bake_result *alone = scene_bake(&p.points, &p.light[f], 1, &options);
		assert_memory_equal(frame[f]->radiance, alone->radiance, 3 * alone->count * sizeof(float));
		gw_bake_result_destroy(&alone);
	}
	destroy_all(frame, FRAMES);
	scene_clear(&p.scene);
}

/* A cube that touches the floor leaves the floor's regions of influence as they are. */
static void test_parts_leave_each_other_alone(void **state)
{
	stage_play p;
	gw_bake_result *frame[2];
	(void)state;
	make_play(&p, 20, false);
	place(p.matrix + 16, 0, 1, 2, 1.5, 0.3);
	play(&p, (gw_frames_options){ .rebuild = true }, in_order, 2, frame);
	assert_memory_equal(frame[0]->roi, frame[1]->roi, p.mover.first * sizeof(float));
	destroy_all(frame, 2);
	scene_clear(&p.scene);
}

/* Where nothing is traced there is no octree in frames either, and the light is the same. */
static void test_no_octree_without_need(void **state)
{
	stage_play p;
	gw_error error = { 0 };
	(void)state;
	make_play(&p, 10, true);
	const gw_moving_scene moving = { { &p.points, p.light, 1 }, &p.motion };
	for (size_t frame = 0; frame < 2; frame++) {
		gw_bake_result *result[2] = { NULL };
		for (int forced = 0; forced < 2; forced++) {
			gw_frames *frames;
			gw_bake_options options = options_of();
			options.effects_forbidden =
				1u << GW_EFFECT_SHADOWS | 1u << GW_EFFECT_BOUNCES | 1u << GW_EFFECT_EMITTERS;
			options.effects_forced = forced ? 1u << GW_EFFECT_OCTREE : 0;
			assert_ok(
				gw_frames_open(&moving, &options, &(gw_frames_options){ 0 }, NULL, &frames, &error),
				&error);
			assert_ok(gw_frames_bake(frames, frame, p.light, 1, &result[forced], &error), &error);
			gw_frames_close(&frames);
			assert_true((result[forced]->report.leaves > 0) == (forced != 0));
			assert_false(scene_has_stage(&result[forced]->report, "gaps"));
		}
		assert_memory_equal(result[0]->radiance, result[1]->radiance,
							3 * result[0]->count * sizeof *result[0]->radiance);
		destroy_all(result, 2);
	}
	scene_clear(&p.scene);
}

/* Whoever plans frames and bakes them afterwards has the same bytes; and what is counted is
 * foretold as it comes: records to the last one, and memory to a fifth of it, as for one bake. */
static void test_plan(void **state)
{
	stage_play p;
	gw_bake_result *plain[2], *planned, *plan;
	gw_frames *frames;
	gw_error error = { 0 };
	const size_t frame[2] = { 0, 1 };
	const gw_bake_options options = options_of();
	(void)state;
	make_play(&p, 15, true);
	play(&p, (gw_frames_options){ .independent = true }, in_order, 2, plain);
	const gw_moving_scene moving = { { &p.points, p.light, 1 }, &p.motion };
	const gw_light *const lights[2] = { &p.light[0], &p.light[1] };
	assert_ok(gw_frames_open(&moving, &options, &(gw_frames_options){ .independent = true }, NULL,
							 &frames, &error),
			  &error);
	assert_ok(gw_frames_plan(frames, frame, lights, 1, &plan, &error), &error);
	for (size_t i = 0; i < 2; i++) {
		assert_ok(gw_frames_bake(frames, i, &p.light[i], 1, &planned, &error), &error);
		assert_memory_equal(planned->radiance, plain[i]->radiance,
							3 * planned->count * sizeof *planned->radiance);
		gw_bake_result_destroy(&planned);
	}
	const gw_forecast *f = &plan->report.forecast;
	double most = fmax((double)plain[0]->report.peak_bytes, (double)plain[1]->report.peak_bytes);
	assert_int_equal(f->records, plain[0]->report.records);
	assert_true(f->seconds > 0.0 && f->frame_seconds > 0.0);
	assert_true(fabs((double)f->device_bytes - most) < 0.2 * most);
	assert_int_equal(plan->given_count, 1);
	const size_t beyond[2] = { 0, FRAMES };
	assert_int_equal(gw_frames_plan(frames, beyond, lights, 1, &planned, &error), GW_ERROR_USAGE);
	gw_frames_close(&frames);
	gw_bake_result_destroy(&plan);
	destroy_all(plain, 2);
	scene_clear(&p.scene);
}

static void expect(const stage_play *p, gw_status status, const char *words)
{
	gw_error error = { 0 };
	gw_frames *frames;
	gw_bake_options options = options_of();
	gw_frames_options how = { .rebuild = false };
	assert_int_equal(gw_frames_open(&(gw_moving_scene){ { &p->points, p->light, 1 }, &p->motion },
									&options, &how, NULL, &frames, &error),
					 status);
	assert_null(frames);
	assert_non_null(strstr(error.text, words));
}

static void test_refuses(void **state)
{
	stage_play p;
	(void)state;
	make_play(&p, 5, false);
	p.matrix[16] *= 1.01;
	expect(&p, GW_ERROR_DATA, "frame 1");
	memset(p.matrix + 16, 0, 12 * sizeof(double));
	expect(&p, GW_ERROR_DATA, "flattened");
	p.matrix[16] = NAN;
	expect(&p, GW_ERROR_DATA, "frame 1");
	make_play(&p, 5, false);
	p.mover.count++;
	expect(&p, GW_ERROR_USAGE, "movers need points of their own");
	p.mover.count--;
	p.motion.frame_count = 0;
	expect(&p, GW_ERROR_USAGE, "no frames");
	scene_clear(&p.scene);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_equals_scratch),
		cmocka_unit_test(test_comes_back),
		cmocka_unit_test(test_carries_light),
		cmocka_unit_test(test_lamps_alone),
		cmocka_unit_test(test_parts_leave_each_other_alone),
		cmocka_unit_test(test_no_octree_without_need),
		cmocka_unit_test(test_plan),
		cmocka_unit_test(test_refuses),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

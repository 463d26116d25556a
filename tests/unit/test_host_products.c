/*
 * test_host_products.c - loops of the host that stand in for passes, against these passes; and
 * views of buffers, in place and as copies.
 *
 * Both add the same numbers, none of them negative, in any order: a sum of n terms is rounded by
 * n * 2^-24 of itself at most.
 */
#include "bounces.h"
#include "direct_light.h"
#include "gpu_internal.h"
#include "relight.h"
#include "scenes.h"
#include "transport_layout.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* Multiplications and a division besides the sum. */
#define ROUNDINGS 8.0

/* A hall with its records, and its lights. */
typedef struct fixture {
	scene hall;
	gw_points points;
	gw_light light;
	gw_report report;
	gw_solver solver;
} fixture;

static void assert_ok(gw_status status, const gw_error *error)
{
	if (status != GW_OK)
		fail_msg("%s", error->text);
}

static void set_up(fixture *f)
{
	*f = (fixture){ .light = scene_point_light(1.0, 1.0, 1.2, 2.0f) };
	gw_solver *s = &f->solver;
	gw_error error = { 0 };
	scene_make_hall(&f->hall);
	f->points = scene_points(&f->hall);
	s->options = GW_BAKE_OPTIONS_DEFAULT;
	s->options.estimate_points = 0;
	s->report = &f->report;
	gw_status status = gw_solver_open_device(s, &error);
	if (status == GW_ERROR_NO_DEVICE && getenv("CI") == NULL)
		skip();
	assert_ok(status, &error);
	if (!gw_gpu_is_host(s->gpu)) {
		print_message("this device is not the host\n");
		skip();
	}
	assert_ok(gw_solver_make_surfels(s, &f->points, &f->light, 1, &error), &error);
	assert_ok(gw_solver_build_octree(s, &error), &error);
	assert_ok(gw_solver_place_records(s, &error), &error);
}

static void tear_down(fixture *f)
{
	gw_solver_close(&f->solver);
	free(f->report.bounce);
	scene_clear(&f->hall);
}

static gw_buffer random_vectors(fixture *f, uint64_t count)
{
	gw_error error = { 0 };
	gw_buffer buffer;
	float *values = calloc(count, 4 * sizeof *values);
	assert_non_null(values);
	for (size_t i = 0; i < 4 * count; i++)
		values[i] = i % 4 < 3 ? (float)scene_random(&f->hall) : 0.0f;
	assert_ok(gw_buffer_create(f->solver.gpu, GW_BUFFER_TEXEL, VK_FORMAT_R32G32B32A32_SFLOAT,
							   16 * count, "random vectors", &buffer, &error),
			  &error);
	assert_ok(gw_buffer_upload(f->solver.gpu, &buffer, 0, values, 16 * count, &error), &error);
	free(values);
	return buffer;
}

static float *contents(fixture *f, const gw_buffer *buffer)
{
	gw_error error = { 0 };
	float *values = malloc((size_t)buffer->bytes);
	assert_non_null(values);
	assert_ok(gw_buffer_download(f->solver.gpu, buffer, 0, values, buffer->bytes, &error), &error);
	return values;
}

/* Fails when arrays of floats differ by more than sums of so many terms can; frees both. */
static void compare(float *a, float *b, size_t count, double terms)
{
	double tolerance = (terms + ROUNDINGS) * 0x1p-24, sum = 0.0;
	for (size_t i = 0; i < count; i++) {
		double off = fabs((double)a[i] - (double)b[i]);
		if (!(off <= tolerance * fabs((double)b[i])))
			fail_msg("number %zu of %zu is %.9g and %.9g", i, count, (double)a[i], (double)b[i]);
		sum += (double)a[i];
	}
	assert_true(sum > 0.0);
	free(a);
	free(b);
}

/* ---------------------------------------------------------------------------------- products */

/* One product of one or two inputs. */
typedef gw_status product(fixture *f, const gw_buffer *one, const gw_buffer *other, gw_buffer *out,
						  gw_error *error);

/* Makes a product of `count` vectors by passes and on the host, over other numbers each time, and
 * fails when they differ by more than sums of so many terms can. */
static void make_alike(fixture *f, product *make, const gw_buffer *one, const gw_buffer *other,
					   uint64_t count, double terms)
{
	gw_gpu *gpu = f->solver.gpu;
	gw_error error = { 0 };
	float *found[2];
	for (int host = 0; host < 2; host++) {
		gw_buffer out = random_vectors(f, count);
		gpu->may_map = host;
		assert_ok(make(f, one, other, &out, &error), &error);
		gpu->may_map = true;
		found[host] = contents(f, &out);
		gw_buffer_destroy(gpu, &out);
	}
	compare(found[1], found[0], 4 * (size_t)count, terms);
}

static gw_status shade(fixture *f, const gw_buffer *irradiance, const gw_buffer *direct,
					   gw_buffer *radiance, gw_error *error)
{
	gw_solver *s = &f->solver;
	return gw_lobes_shade(&s->passes, &s->octree, &s->records, irradiance, direct, 0.5f, radiance,
						  error);
}

static gw_status shade_undirected(fixture *f, const gw_buffer *irradiance, const gw_buffer *direct,
								  gw_buffer *radiance, gw_error *error)
{
	gw_solver *s = &f->solver;
	return gw_lobes_shade(&s->passes, &s->octree, &s->records, irradiance, direct, 0.0f, radiance,
						  error);
}

static void shade_alike(void **state)
{
	(void)state;
	fixture f;
	set_up(&f);
	uint64_t slots = 2 * (uint64_t)f.solver.octree.leaf_count;
	gw_buffer irradiance = random_vectors(&f, f.solver.records.count);
	gw_buffer direct = random_vectors(&f, slots);
	make_alike(&f, shade, &irradiance, &direct, slots, GW_WEIGHTS + 1.0);
	make_alike(&f, shade_undirected, &irradiance, &direct, slots, GW_WEIGHTS + 1.0);
	gw_buffer_destroy(f.solver.gpu, &irradiance);
	gw_buffer_destroy(f.solver.gpu, &direct);
	tear_down(&f);
}

/* What is gathered is the records' own; `out` trades places with it. */
static gw_status gather(fixture *f, const gw_buffer *radiance, const gw_buffer *none,
						gw_buffer *out, gw_error *error)
{
	gw_solver *s = &f->solver;
	gw_buffer before = s->records.gathered;
	(void)none;
	s->records.gathered = *out;
	gw_status status = gw_ray_gather_bounce(&s->passes, &s->rays, radiance, &s->records, error);
	s->records.gathered = before;
	return status;
}

static void gather_alike(void **state)
{
	(void)state;
	fixture f;
	set_up(&f);
	gw_buffer radiance = random_vectors(&f, 2 * (uint64_t)f.solver.octree.leaf_count);
	make_alike(&f, gather, &radiance, NULL, f.solver.records.count, f.solver.rays.rays);
	gw_buffer_destroy(f.solver.gpu, &radiance);
	tear_down(&f);
}

static gw_status average(fixture *f, const gw_buffer *surfels, const gw_buffer *none,
						 gw_buffer *lobes, gw_error *error)
{
	(void)none;
	return gw_average_lobes(&f->solver.passes, &f->solver.octree, surfels, lobes, error);
}

/* Of a leaf, up to 2047 fragments count: one in `fragments / 1024`. */
static void average_alike(void **state)
{
	(void)state;
	fixture f;
	set_up(&f);
	gw_buffer surfels = random_vectors(&f, f.solver.surfels.count);
	make_alike(&f, average, &surfels, NULL, 2 * (uint64_t)f.solver.octree.leaf_count, 2047.0);
	gw_buffer_destroy(f.solver.gpu, &surfels);
	tear_down(&f);
}

static void add_alike(void **state)
{
	(void)state;
	fixture f;
	gw_error error = { 0 };
	set_up(&f);
	gw_solver *s = &f.solver;
	gw_buffer from = random_vectors(&f, 5000), to = random_vectors(&f, 5000);
	float *a = contents(&f, &from), *b = contents(&f, &to);
	assert_ok(gw_light_add(&s->passes, &from, &to, 5000, &error), &error);
	float *once = contents(&f, &to);
	s->gpu->may_map = false;
	assert_ok(gw_light_add(&s->passes, &from, &to, 5000, &error), &error);
	s->gpu->may_map = true;
	float *twice = contents(&f, &to);
	for (size_t i = 0; i < 4 * 5000; i++) {
		assert_true(once[i] == b[i] + a[i]);
		assert_true(twice[i] == once[i] + a[i]);
	}
	free(a);
	free(b);
	free(once);
	free(twice);
	gw_buffer_destroy(s->gpu, &from);
	gw_buffer_destroy(s->gpu, &to);
	tear_down(&f);
}

/* ------------------------------------------------------------------------------------ wholes */

/* All bounces, with as many threads; the caller frees what is returned. */
static float *light(fixture *f, bool host, uint32_t threads, uint32_t *bounces)
{
	gw_error error = { 0 };
	gw_solver *s = &f->solver;
	gw_relight relight = { .solver = s, .lights = &f->light, .light_count = 1 };
	s->gpu->may_map = host;
	s->passes.threads = threads;
	gw_relight_plan(&relight);
	assert_ok(gw_relight_run(&relight, &error), &error);
	s->gpu->may_map = true;
	*bounces = f->report.bounce_count;
	float *indirect = relight.surfel_indirect;
	relight.surfel_indirect = NULL;
	gw_relight_clear(&relight);
	return indirect;
}

/* Sums of at most `rays` terms are rounded bounce by bounce; each bounce is smaller than the one
 * before, by half or more in this hall, so that what is rounded in all is twice that of one. What a
 * rounding may also do is to turn a sample of a lit patch from one lobe to its neighbour, but light
 * of the hall's wide walls is not sampled. */
static void bounce_alike(void **state)
{
	(void)state;
	fixture f;
	uint32_t bounces[3];
	set_up(&f);
	size_t count = 4 * f.solver.surfels.count;
	float *passes = light(&f, false, 0, &bounces[0]);
	float *host = light(&f, true, 0, &bounces[1]), *alone = light(&f, true, 1, &bounces[2]);
	assert_true(bounces[0] == bounces[1] && bounces[0] == bounces[2] && bounces[0] > 3);
	assert_memory_equal(host, alone, count * sizeof *host);
	free(alone);
	compare(host, passes, count, 2.0 * (f.solver.rays.rays + GW_WEIGHTS + GW_SURFEL_WEIGHTS));
	tear_down(&f);
}

static void views(void **state)
{
	(void)state;
	fixture f;
	gw_error error = { 0 };
	set_up(&f);
	gw_gpu *gpu = f.solver.gpu;
	gw_buffer buffer = random_vectors(&f, 100);
	float *expected = contents(&f, &buffer);
	for (int host = 0; host < 2; host++) {
		gw_view view;
		gpu->may_map = host;
		assert_ok(gw_view_open(gpu, &buffer, 1600, &view, &error), &error);
		assert_memory_equal(view.bytes, expected, 1600);
		assert_true((view.copy == NULL) == (host == 1));
		gw_view_close(&view);
		assert_null(view.bytes);
		gw_view_close(&view);
		assert_int_not_equal(gw_view_open(gpu, &buffer, 1604, &view, &error), GW_OK);
		gw_view_close(&view);
	}
	gpu->may_map = true;
	free(expected);
	gw_buffer_destroy(gpu, &buffer);
	tear_down(&f);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(shade_alike),   cmocka_unit_test(gather_alike),
		cmocka_unit_test(average_alike), cmocka_unit_test(add_alike),
		cmocka_unit_test(bounce_alike),  cmocka_unit_test(views),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

/* What bounces ask of a device: one submission each and a few bytes down, and that what is added up
 * there is what the processor adds up of the same light. */
#include "bake/lighting.h"
#include "bake/record_steps.h"
#include "base/luminance.h"
#include "device/gpu_internal.h"
#include "expected.h"
#include "light/light_sums.h"
#include "scenes.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void make_box(scene *s, double per_metre)
{
	const float lamp[3] = { 2.0f, 1.0f, 0.5f };
	scene_add_box(s, (double[3]){ 0, 0, 0 }, (double[3]){ 1, 1, 1 }, per_metre, 0.7f);
	for (size_t i = 0; i < 24; i++)
		scene_emit(s, i, lamp);
}

static gw_bake_options options_of(uint32_t bounces)
{
	gw_bake_options options = gw_bake_options_default();
	options.passes = GW_PASSES_DEVICE;
	options.rays = 16;
	options.estimate_points = 0;
	options.bounces = bounces;
	return options;
}

/* What the stage of the bounces asked for, where no run is too long for one submission. */
static gw_stage bounce_stage(const gw_points *points, uint32_t bounces, gw_method method)
{
	const gw_scene_description description = { points, NULL, 0 };
	gw_bake_options options = options_of(bounces);
	gw_scene *made = NULL;
	gw_lighting *lighting = NULL;
	gw_stage stage = { .name = "" };
	gw_error error = { 0 };
	options.method = method;
	assert_ok(gw_scene_create(&description, &options, NULL, &made, &error), &error);
	made->gpu->slice_seconds = 1000.0;
	assert_ok(gw_lighting_create(made, NULL, 0, &lighting, &error), &error);
	for (uint32_t i = 0; i < made->report->stage_count; i++)
		if (strcmp(made->report->stage[i].name, "bounces") == 0)
			stage = made->report->stage[i];
	assert_string_equal(stage.name, "bounces");
	assert_int_equal(made->report->bounce_count, bounces);
	gw_lighting_destroy(&lighting);
	gw_scene_destroy(&made);
	return stage;
}

/* Three bounces more, by rays and by cones: three submissions of several dispatches each, nothing
 * up, and two sums of four floats down for each. The first bounces are left out: speeds are not
 * known there, and lit patches may be sampled. */
static void a_bounce_is_one_submission(void **state)
{
	(void)state;
	static const gw_method methods[] = { GW_METHOD_RAYS, GW_METHOD_CONES, GW_METHOD_VOLUME };
	scene s = { 0 };
	make_box(&s, 24);
	const gw_points points = scene_points(&s);
	for (size_t i = 0; i < sizeof methods / sizeof *methods; i++) {
		gw_stage few = bounce_stage(&points, 3, methods[i]);
		gw_stage many = bounce_stage(&points, 6, methods[i]);
		assert_int_equal(many.submissions - few.submissions, 3);
		assert_int_equal(many.downloaded_bytes - few.downloaded_bytes, 3 * 32);
		assert_int_equal(many.uploaded_bytes, few.uploaded_bytes);
		assert_true(many.dispatches - few.dispatches >= 3 * 5);
	}
	scene_clear(&s);
}

/* ---------------------------------------------------------------------------------------- sums */

/* Of a product of an area, an opacity and a luminance: eight roundings at most, and one of the
 * luminance's three parts against all, whatever their signs. */
#define ROUNDED (8 * 0x1p-24)

typedef struct sums_of_device {
	gw_scene scene;
	gw_report report;
	gw_lighting lighting;
	gw_record_context on;
	float *light; /* 4 a facet, or a record if these are more */
} sums_of_device;

static void prepare(sums_of_device *d, const gw_points *points)
{
	gw_error error;
	*d = (sums_of_device){ .scene = { .options = options_of(1) } };
	d->scene.report = &d->report;
	d->scene.options.record_spacing = 0.0f; /* one a facet */
	assert_ok(gw_scene_open_device(&d->scene, &error), &error);
	assert_ok(gw_scene_make_surfels(&d->scene, &(gw_scene_description){ .points = points }, &error),
			  &error);
	assert_ok(gw_scene_build_octree(&d->scene, &error), &error);
	assert_ok(gw_scene_place_records(&d->scene, &error), &error);
	d->on = gw_scene_context(&d->scene, &d->scene.records);
	size_t facets = d->scene.octree.facet_count;
	assert_true(facets > GW_STEPS_MAX * GW_STEPS_MAX && d->scene.records.count > 500);
	d->light = calloc(facets, 4 * sizeof *d->light);
	assert_non_null(d->light);
}

static gw_buffer upload(sums_of_device *d, const float *values, size_t count)
{
	gw_buffer buffer;
	gw_error error;
	const gw_buffer_description description = { GW_BUFFER_TEXEL, VK_FORMAT_R32G32B32A32_SFLOAT,
												16 * count, "light" };
	assert_ok(gw_buffer_create(d->scene.gpu, &description, &buffer, &error), &error);
	assert_ok(gw_buffer_upload(d->scene.gpu, &buffer, 0, values, 16 * count, &error), &error);
	return buffer;
}

/* Light of both signs, of all sizes. */
static void draw_light(sums_of_device *d, size_t count)
{
	scene random = { 0 };
	for (size_t i = 0; i < 4 * count; i++) {
		double value = scene_random(&random);
		d->light[i] = (float)(i % 7 == 0 ? -value : ldexp(value, -(int)(i % 13)));
	}
}

static float *bytes_of(sums_of_device *d, const gw_buffer *buffer, size_t count)
{
	gw_error error;
	float *values = calloc(count, 4 * sizeof *values);
	assert_non_null(values);
	assert_ok(gw_buffer_download(d->scene.gpu, buffer, 0, values, 16 * count, &error), &error);
	return values;
}

static void compare_facets(sums_of_device *d, const gw_light_sum *found)
{
	const gw_octree *o = &d->scene.octree;
	size_t facets = o->facet_count;
	float *centre = bytes_of(d, &o->facet_centre, facets),
		  *albedo = bytes_of(d, &o->facet_albedo, facets), largest = 0.0f;
	double power = 0.0, squares = 0.0, bound = 0.0;
	for (size_t i = 0; i < facets; i++) {
		const float *l = d->light + 4 * i;
		double area = (double)centre[4 * i + 3] * (double)gw_facet_opacity(albedo[4 * i + 3]);
		double part = area * fabs(gw_luminance(l));
		const float size[3] = { fabsf(l[0]), fabsf(l[1]), fabsf(l[2]) };
		power += part;
		squares += part * part;
		bound += area * gw_luminance(size) * ROUNDED;
		for (size_t c = 0; c < 3; c++)
			largest = fmaxf(largest, l[c]);
	}
	assert_true(power > 1.0 && fabs(found->power - power) <= bound);
	/* Of squares each part is rounded twice as much, and sums of 64 on three levels are. */
	assert_true(fabs(found->squares - squares) <= (16 + 3 * 64) * 0x1p-24 * squares + 2 * bound);
	assert_true(found->largest == largest);
	free(centre);
	free(albedo);
}

static void compare_records(sums_of_device *d, const float *weight, const gw_light_sum *found)
{
	double power = 0.0;
	float largest = 0.0f;
	for (size_t i = 0; i < d->scene.records.count; i++)
		for (size_t c = 0; c < 3; c++) {
			float size = fabsf(d->light[4 * i + c]);
			power += (double)weight[4 * i + c] * (double)size;
			largest = fmaxf(largest, size);
		}
	assert_true(power > 1.0 && fabs(found->power - power) <= ROUNDED * power);
	assert_true(found->largest == largest);
}

/* Light that is drawn: the sums over it are those in doubles, but for the rounding of each part;
 * and made again they are the same to the last bit. */
static void sums_are_right(void **state)
{
	(void)state;
	sums_of_device d;
	gw_light_sums sums = { 0 };
	gw_light_sum facets[2], records[2];
	gw_error error;
	scene s = { 0 };
	make_box(&s, 36);
	const gw_points points = scene_points(&s);
	prepare(&d, &points);
	gw_gpu *gpu = d.scene.gpu;
	size_t numbers = d.scene.octree.facet_count, count = d.scene.records.count;
	draw_light(&d, numbers);
	gw_buffer light = upload(&d, d.light, numbers);
	float *weight =
		bytes_of(&d, &d.scene.octree.facet_centre, count); /* any that are not below 0 */
	gw_buffer power = upload(&d, weight, count);
	assert_ok(gw_buffer_upload(gpu, &d.scene.records.gathered, 0, d.light, 16 * count, &error),
			  &error);
	assert_ok(gw_light_sums_create(&d.on, &sums, &error), &error);
	for (int i = 0; i < 2; i++) {
		assert_ok(gw_light_sums_facets(&d.on, &sums, &light, &error), &error);
		assert_ok(gw_light_sums_records(&d.on, &sums, &power, &error), &error);
		assert_ok(gw_light_sums_read(gpu, &sums, &facets[i], &records[i], &error), &error);
		assert_true(facets[i].power == facets[0].power && records[i].power == records[0].power);
		assert_true(facets[i].squares == facets[0].squares);
	}
	compare_facets(&d, &facets[0]);
	compare_records(&d, weight, &records[0]);
	gw_light_sums_destroy(gpu, &sums);
	gw_buffer_destroy(gpu, &light);
	gw_buffer_destroy(gpu, &power);
	free(weight);
	free(d.light);
	gw_scene_close(&d.scene);
	scene_clear(&s);
}

/* A bake by shaders tells the same of its bounces as one whose sums the processor makes: as many,
 * with the same energy but for their rounding and what rays that go another way bring, see
 * choices_alike of test_passes.c. */
static void bounces_tell_the_same(void **state)
{
	(void)state;
	scene s = { 0 };
	make_box(&s, 24);
	const gw_points points = scene_points(&s);
	gw_bake_options options = options_of(6);
	gw_bake_result *device = scene_bake(&points, NULL, 0, &options);
	options.passes = GW_PASSES_AUTO;
	gw_bake_result *host = scene_bake(&points, NULL, 0, &options);
	const gw_report *a = &device->report, *b = &host->report;
	assert_true(a->bounce_count == 6 && b->bounce_count == 6);
	for (uint32_t i = 0; i < 6; i++) {
		const gw_bounce *x = &a->bounce[i], *y = &b->bounce[i];
		assert_true(x->energy > 0.0 && fabs(x->energy - y->energy) <= 0.01 * y->energy);
		assert_true(fabs(x->carriers - y->carriers) <= 0.01 * y->carriers);
	}
	gw_bake_result_destroy(&device);
	gw_bake_result_destroy(&host);
	scene_clear(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_bounce_is_one_submission),
		cmocka_unit_test(sums_are_right),
		cmocka_unit_test(bounces_tell_the_same),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

/*
 * scenes.c - see scenes.h.
 */
#include "scenes.h"

#include "cloud/surfels.h"
#include "expected.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

double scene_random(scene *s)
{
	/* SplitMix64 (Steele et al. 2014). */
	uint64_t z = s->state += 0x9e3779b97f4a7c15u;
	z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
	z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
	return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static void *grown(void *array, size_t count, size_t size)
{
	void *larger = realloc(array, count * size);
	assert_non_null(larger);
	return larger;
}

size_t scene_add(scene *s, const double position[3], const double normal[3], float albedo)
{
	if (s->count == s->capacity) {
		s->capacity = s->capacity ? 2 * s->capacity : 1024;
		s->position = grown(s->position, s->capacity, 3 * sizeof(double));
		s->normal = grown(s->normal, s->capacity, 3 * sizeof(float));
		s->albedo = grown(s->albedo, s->capacity, 3 * sizeof(float));
		s->emission = grown(s->emission, s->capacity, 3 * sizeof(float));
	}
	for (size_t k = 0; k < 3; k++) {
		s->position[3 * s->count + k] = nearbyint(position[k] * 0x1p20) * 0x1p-20;
		s->normal[3 * s->count + k] = (float)normal[k];
		s->albedo[3 * s->count + k] = albedo;
		s->emission[3 * s->count + k] = 0.0f;
	}
	return s->count++;
}

void scene_add_patch(scene *s, const scene_patch *patch, float albedo)
{
	const double *u = patch->u, *v = patch->v;
	double normal[3] = { u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2],
						 u[0] * v[1] - u[1] * v[0] };
	double length = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
	for (size_t k = 0; k < 3; k++)
		normal[k] /= length;
	for (size_t j = 0; j < patch->m; j++) {
		for (size_t i = 0; i < patch->n; i++) {
			double a = ((double)i + scene_random(s)) / (double)patch->n;
			double b = ((double)j + scene_random(s)) / (double)patch->m;
			double p[3];
			for (size_t k = 0; k < 3; k++)
				p[k] = patch->corner[k] + a * u[k] + b * v[k];
			scene_add(s, p, normal, albedo);
		}
	}
}

void scene_add_sphere(scene *s, const double centre[3], double radius, size_t count, int facing,
					  float albedo)
{
	for (size_t i = 0; i < count; i++) {
		double z = 1.0 - (2.0 * (double)i + 1.0) / (double)count;
		double r = sqrt(1.0 - z * z), turn = 2.399963229728653 * (double)i;
		double out[3] = { r * cos(turn), r * sin(turn), z }, p[3], normal[3];
		for (size_t k = 0; k < 3; k++) {
			p[k] = centre[k] + radius * out[k];
			normal[k] = facing * out[k];
		}
		scene_add(s, p, normal, albedo);
	}
}

void scene_add_box(scene *s, const double corner[3], const double size[3], double per_metre,
				   float albedo)
{
	for (size_t axis = 0; axis < 3; axis++) {
		size_t a = (axis + 1) % 3, b = (axis + 2) % 3;
		size_t n = (size_t)lround(size[a] * per_metre), m = (size_t)lround(size[b] * per_metre);
		double low[3], high[3], u[3] = { 0 }, v[3] = { 0 };
		memcpy(low, corner, sizeof low);
		memcpy(high, corner, sizeof high);
		high[axis] += size[axis];
		u[a] = size[a];
		v[b] = size[b];
		scene_add_patch(s, &(scene_patch){ low, u, v, n, m }, albedo); /* u x v is +axis: inwards */
		scene_add_patch(s, &(scene_patch){ high, v, u, m, n },
						albedo); /* v x u is -axis: inwards */
	}
}

void scene_make_cellar(scene *s)
{
	const struct {
		double corner[3], u[3], v[3]; /* inwards is along u x v */
	} patch[] = {
		{ { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 } }, /* floor */
		{ { 0, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }, /* walls */
		{ { 1, 0, 0 }, { 0, 0, 1 }, { 0, 1, 0 } },
		{ { 0, 0, 0 }, { 0, 0, 1 }, { 1, 0, 0 } },
		{ { 0, 1, 0 }, { 1, 0, 0 }, { 0, 0, 1 } },
		{ { 0, 0, 1 }, { 0, 1, 0 }, { 0.375, 0, 0 } }, /* ceiling, around the hole */
		{ { 0.625, 0, 1 }, { 0, 1, 0 }, { 0.375, 0, 0 } },
		{ { 0.375, 0, 1 }, { 0, 0.375, 0 }, { 0.25, 0, 0 } },
		{ { 0.375, 0.625, 1 }, { 0, 0.375, 0 }, { 0.25, 0, 0 } },
	};
	for (size_t i = 0; i < sizeof patch / sizeof *patch; i++) {
		const double *u = patch[i].u, *v = patch[i].v;
		scene_add_patch(s,
						&(scene_patch){ patch[i].corner, u, v,
										(size_t)lround(32 * (u[0] + u[1] + u[2])),
										(size_t)lround(32 * (v[0] + v[1] + v[2])) },
						0.5f);
	}
}

static void colour(scene *s, size_t first, float red, float green, float blue)
{
	for (size_t i = first; i < s->count; i++) {
		s->albedo[3 * i] = red;
		s->albedo[3 * i + 1] = green;
		s->albedo[3 * i + 2] = blue;
	}
}

void scene_emit(scene *s, size_t first, const float radiance[3])
{
	s->emits = true;
	for (size_t i = first; i < s->count; i++)
		memcpy(&s->emission[3 * i], radiance, 3 * sizeof(float));
}

/* So many points a metre along each edge of the walls, as near as comes. */
static void make_hall(scene *s, size_t per_metre)
{
	const double origin[3] = { 0, 0, 0 }, right[3] = { 4, 0, 0 }, back[3] = { 0, 3, 0 };
	const double top[3] = { 0, 0, 2.5 }, lamp[3] = { 1, 1, 2.25 };
	const double x[3] = { 4, 0, 0 }, y[3] = { 0, 3, 0 }, z[3] = { 0, 0, 2.5 };
	const size_t nx = 4 * per_metre, ny = 3 * per_metre, nz = 5 * per_metre / 2;
	scene_add_patch(s, &(scene_patch){ origin, x, y, nx, ny }, 0.5f);
	scene_add_patch(s, &(scene_patch){ top, y, x, ny, nx }, 0.7f);
	scene_add_patch(s, &(scene_patch){ back, x, z, nx, nz }, 0.6f);
	size_t first = s->count;
	scene_add_patch(s, &(scene_patch){ origin, y, z, ny, nz }, 0.5f);
	colour(s, first, 0.7f, 0.1f, 0.1f);
	first = s->count;
	scene_add_patch(s, &(scene_patch){ right, z, y, nz, ny }, 0.5f);
	colour(s, first, 0.1f, 0.7f, 0.2f);
	const size_t ball = 25 * per_metre * per_metre / 8; /* pi a square metre */
	scene_add_sphere(s, (double[3]){ 2.5, 1.75, 0.75 }, 0.5, ball, 1, 0.8f);
	first = s->count;
	const double u[3] = { 0, 0.5, 0 }, v[3] = { 0.5, 0, 0 };
	scene_add_patch(s, &(scene_patch){ lamp, u, v, per_metre / 2, per_metre / 2 }, 0.2f);
	scene_emit(s, first, (float[3]){ 8.0f, 7.0f, 5.0f });
}

void scene_make_hall(scene *s)
{
	make_hall(s, 12);
}

void scene_make_small_hall(scene *s)
{
	make_hall(s, 8);
}

void scene_make_random_room(scene *s, size_t count, float albedo)
{
	for (size_t i = 0; i < count; i++) {
		size_t axis = i % 3;
		double side = i % 6 < 3 ? -1.0 : 1.0, place[3], normal[3] = { 0.0, 0.0, 0.0 };
		for (int k = 0; k < 3; k++)
			place[k] = 2.0 * scene_random(s) - 1.0;
		place[axis] = side;
		normal[axis] = -side;
		scene_add(s, place, normal, albedo);
	}
}

gw_points scene_points(const scene *s)
{
	return (gw_points){ .count = s->count,
						.position = s->position,
						.normal = s->normal,
						.albedo = s->albedo,
						.emission = s->emits ? s->emission : NULL };
}

void scene_clear(scene *s)
{
	free(s->position);
	free(s->normal);
	free(s->albedo);
	free(s->emission);
	*s = (scene){ 0 };
}

void scene_choose_passes(gw_pass_choice *passes, gw_validation *validate)
{
	const char *way = getenv("GLOWWORM_TEST_PASSES"), *kind = getenv("GLOWWORM_TEST_VALIDATE");
	for (int i = 0; way != NULL && i < GW_PASSES_COUNT; i++)
		if (strcmp(way, gw_pass_choice_name((gw_pass_choice)i)) == 0)
			*passes = (gw_pass_choice)i;
	for (int i = 0; kind != NULL && i < GW_VALIDATION_COUNT; i++)
		if (strcmp(kind, gw_validation_name((gw_validation)i)) == 0)
			*validate = (gw_validation)i;
}

bool scene_by_shaders(void)
{
	gw_pass_choice passes = GW_PASSES_AUTO;
	gw_validation validate = GW_VALIDATE_NOTHING;
	scene_choose_passes(&passes, &validate);
	return passes == GW_PASSES_DEVICE;
}

gw_bake_result *scene_bake(const gw_points *points, const gw_light *lights, size_t light_count,
						   const gw_bake_options *options)
{
	gw_bake_result *result;
	gw_error error = { 0 };
	gw_bake_options own = *options;
	scene_choose_passes(&own.passes, &own.validate);
	assert_ok(gw_bake(&(gw_scene_description){ points, lights, light_count }, &own, NULL, &result,
					  &error),
			  &error);
	return result;
}

void scene_bake_hall_twice(const gw_bake_options *options, gw_bake_result *result[2])
{
	scene s = { 0 };
	const gw_light lamp = scene_point_light(2.0, 1.5, 1.2, 3.0f);
	gw_bake_options own = *options;
	scene_make_small_hall(&s);
	const gw_points points = scene_points(&s);
	for (size_t i = 0; i < 2; i++) {
		result[i] = scene_bake(&points, &lamp, 1, &own);
		own.threads = 3;
	}
	assert_memory_equal(result[0]->radiance, result[1]->radiance,
						3 * s.count * sizeof *result[0]->radiance);
	scene_clear(&s);
}

double *scene_areas(const gw_points *points)
{
	gw_surfels surfels;
	gw_error error = { 0 };
	if (gw_surfels_make(points, &(gw_surfels_options){ 0 }, &surfels, &error) != GW_OK)
		fail_msg("%s", error.text);
	double *area = calloc(points->count, sizeof *area);
	assert_non_null(area);
	for (size_t i = 0; i < points->count; i++)
		area[i] = (double)surfels.area[surfels.surfel_of_point[i]];
	gw_surfels_clear(&surfels);
	return area;
}

double scene_mean(const float *values, size_t count, size_t channel)
{
	double sum = 0.0;
	for (size_t i = 0; i < count; i++)
		sum += (double)values[3 * i + channel];
	return sum / (double)count;
}

bool scene_has_stage(const gw_report *report, const char *name)
{
	for (uint32_t i = 0; i < report->stage_count; i++) {
		if (strcmp(report->stage[i].name, name) == 0)
			return true;
	}
	return false;
}

const gw_effect *scene_effect(const gw_report *report, const char *name)
{
	for (uint32_t i = 0; i < report->effect_count; i++)
		if (strcmp(report->effect[i].name, name) == 0)
			return &report->effect[i];
	fail_msg("the report has no effect %s", name);
	return NULL;
}

gw_status scene_keep_bytes(void *user, const void *bytes, size_t length, gw_error *error)
{
	scene_bytes *kept = user;
	if (kept->length + length > kept->limit)
		return gw_fail(error, GW_STATUS_OF_CALLER, "the disk of this test is full");
	unsigned char *grown = realloc(kept->data, kept->length + length + 1);
	assert_non_null(grown);
	memcpy(grown + kept->length, bytes, length);
	kept->data = grown;
	kept->length += length;
	return GW_OK;
}

gw_light scene_point_light(double x, double y, double z, float intensity)
{
	return (gw_light){ .type = GW_LIGHT_POINT,
					   .position = { x, y, z },
					   .intensity = { intensity, intensity, intensity } };
}

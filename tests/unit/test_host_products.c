/*
 * test_host_products.c - loops of the host that stand in for passes, against these passes; and
 * views of buffers, in place and as copies.
 *
 * Products add the same numbers, none of them negative, in any order: a sum of n terms is rounded
 * by n * 2^-24 of itself at most. Rays go the same way but for roundings, see STRAYED.
 */
#include "light/bounces.h"
#include "light/direct_light.h"
#include "device/gpu_internal.h"
#include "light/host_rays.h"
#include "bake/lighting.h"
#include "scenes.h"
#include "light/transport_layout.h"
#include "expected.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* Multiplications and a division besides the sum. */
#define ROUNDINGS 8.0

/* Share of the rays that may hit something else: a ray of the hall goes up to 64 cells, where its
 * place is rounded by some 2^-17 cells, and passes at most some 200 edges of cells and discs on its
 * way: the chance that one of them is nearer than that is 200 * 2 * 2^-17. */
#define STRAYED 0.003

#define LAMPS 4

/* A hall with its records, and its lights. */
typedef struct fixture {
	scene hall;
	gw_points points;
	gw_light light;
	gw_report report;
	gw_scene scene;
} fixture;

/* Of the octree; one that is too deep has all discs in its tree. */
static uint32_t depth = GW_DEPTH_AUTO;

static int use_great_depth(void **state)
{
	(void)state;
	depth = 11;
	return 0;
}

static void set_up(fixture *f)
{
	*f = (fixture){ .light = scene_point_light(1.0, 1.0, 1.2, 2.0f) };
	gw_scene *s = &f->scene;
	gw_error error = { 0 };
	scene_make_hall(&f->hall);
	f->points = scene_points(&f->hall);
	s->options = gw_bake_options_default();
	s->options.estimate_points = 0;
	s->options.depth = depth;
	s->report = &f->report;
	assert_ok(gw_scene_open_device(s, &error), &error);
	if (!gw_gpu_is_host(s->gpu)) {
		print_message("this device is not the host\n");
		skip();
	}
	assert_ok(gw_scene_make_surfels(s, &f->points, &f->light, 1, &error), &error);
	assert_ok(gw_scene_build_octree(s, &error), &error);
	assert_ok(gw_scene_place_records(s, &error), &error);
}

static void tear_down(fixture *f)
{
	gw_scene_close(&f->scene);
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
	assert_ok(gw_buffer_create(f->scene.gpu, GW_BUFFER_TEXEL, VK_FORMAT_R32G32B32A32_SFLOAT,
							   16 * count, "random vectors", &buffer, &error),
			  &error);
	assert_ok(gw_buffer_upload(f->scene.gpu, &buffer, 0, values, 16 * count, &error), &error);
	free(values);
	return buffer;
}

static gw_buffer dark_vectors(fixture *f, size_t count)
{
	gw_buffer buffer;
	gw_error error = { 0 };
	assert_ok(gw_buffer_create(f->scene.gpu, GW_BUFFER_TEXEL, VK_FORMAT_R32G32B32A32_SFLOAT,
							   16 * (uint64_t)count, "dark", &buffer, &error),
			  &error);
	return buffer;
}

static float *contents(fixture *f, const gw_buffer *buffer)
{
	gw_error error = { 0 };
	float *values = malloc((size_t)buffer->bytes);
	assert_non_null(values);
	assert_ok(gw_buffer_download(f->scene.gpu, buffer, 0, values, buffer->bytes, &error), &error);
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
	gw_gpu *gpu = f->scene.gpu;
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
	gw_scene *s = &f->scene;
	return gw_lobes_shade(&s->passes, &s->octree, &s->records, irradiance, direct, 0.5f, radiance,
						  error);
}

static gw_status shade_undirected(fixture *f, const gw_buffer *irradiance, const gw_buffer *direct,
								  gw_buffer *radiance, gw_error *error)
{
	gw_scene *s = &f->scene;
	return gw_lobes_shade(&s->passes, &s->octree, &s->records, irradiance, direct, 0.0f, radiance,
						  error);
}

static void shade_alike(void **state)
{
	(void)state;
	fixture f;
	set_up(&f);
	uint64_t slots = 2 * (uint64_t)f.scene.octree.leaf_count;
	gw_buffer irradiance = random_vectors(&f, f.scene.records.count);
	gw_buffer direct = random_vectors(&f, slots);
	make_alike(&f, shade, &irradiance, &direct, slots, GW_WEIGHTS + 1.0);
	make_alike(&f, shade_undirected, &irradiance, &direct, slots, GW_WEIGHTS + 1.0);
	gw_buffer_destroy(f.scene.gpu, &irradiance);
	gw_buffer_destroy(f.scene.gpu, &direct);
	tear_down(&f);
}

/* What is gathered is the records' own; `out` trades places with it. */
static gw_status gather(fixture *f, const gw_buffer *radiance, const gw_buffer *none,
						gw_buffer *out, gw_error *error)
{
	gw_scene *s = &f->scene;
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
	gw_buffer radiance = random_vectors(&f, 2 * (uint64_t)f.scene.octree.leaf_count);
	make_alike(&f, gather, &radiance, NULL, f.scene.records.count, f.scene.rays.rays);
	gw_buffer_destroy(f.scene.gpu, &radiance);
	tear_down(&f);
}

static gw_status average(fixture *f, const gw_buffer *surfels, const gw_buffer *none,
						 gw_buffer *lobes, gw_error *error)
{
	(void)none;
	return gw_average_lobes(&f->scene.passes, &f->scene.octree, surfels, lobes, error);
}

/* Of a leaf, up to 2047 fragments count: one in `fragments / 1024`. */
static void average_alike(void **state)
{
	(void)state;
	fixture f;
	set_up(&f);
	gw_buffer surfels = random_vectors(&f, f.scene.surfels.count);
	make_alike(&f, average, &surfels, NULL, 2 * (uint64_t)f.scene.octree.leaf_count, 2047.0);
	gw_buffer_destroy(f.scene.gpu, &surfels);
	tear_down(&f);
}

static void add_alike(void **state)
{
	(void)state;
	fixture f;
	gw_error error = { 0 };
	set_up(&f);
	gw_scene *s = &f.scene;
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

/* -------------------------------------------------------------------------------------- rays */

static gw_ray_gather trace_rays(fixture *f, bool host, uint32_t threads)
{
	gw_scene *s = &f->scene;
	gw_error error = { 0 };
	gw_ray_gather rays;
	s->gpu->may_map = host;
	s->passes.threads = threads;
	assert_ok(gw_ray_gather_trace(&s->passes, &s->octree, &s->records, 64, 7, &rays, &error),
			  &error);
	s->gpu->may_map = true;
	return rays;
}

/* Rays whose hits differ, by lobe or by a hundredth of a cell, or that one has seen a back. */
static size_t count_strayed(fixture *f, const gw_ray_gather *a, const gw_ray_gather *b)
{
	size_t count = 64 * (size_t)f->scene.records.count, strayed = 0, hits = 0;
	uint32_t *lobe[2] = { (uint32_t *)contents(f, &a->lobe), (uint32_t *)contents(f, &b->lobe) };
	float *distance[2] = { contents(f, &a->distance), contents(f, &b->distance) };
	for (size_t i = 0; i < count; i++) {
		hits += lobe[0][i] != GW_NONE;
		strayed += lobe[0][i] != lobe[1][i] || !(fabsf(distance[0][i] - distance[1][i]) < 0.01f);
	}
	assert_true(hits > count / 2 && hits < count); /* the hall is open */
	for (int k = 0; k < 2; k++) {
		free(lobe[k]);
		free(distance[k]);
	}
	return strayed;
}

static void rays_alike(void **state)
{
	(void)state;
	fixture f;
	set_up(&f);
	gw_gpu *gpu = f.scene.gpu;
	gw_ray_gather passes = trace_rays(&f, false, 0);
	gw_ray_gather host = trace_rays(&f, true, 3), alone = trace_rays(&f, true, 1);
	size_t strayed = count_strayed(&f, &passes, &host);
	if ((double)strayed > STRAYED * 64.0 * f.scene.records.count)
		fail_msg("%zu rays of %u records go another way", strayed, f.scene.records.count);
	assert_int_equal(count_strayed(&f, &alone, &host), 0);
	gw_ray_gather_destroy(gpu, &passes);
	gw_ray_gather_destroy(gpu, &host);
	gw_ray_gather_destroy(gpu, &alone);
	tear_down(&f);
}

/* Rays that are listed are traced as the others are, and no others are. */
static void listed_rays(void **state)
{
	(void)state;
	fixture f;
	gw_error error = { 0 };
	set_up(&f);
	gw_scene *s = &f.scene;
	gw_ray_gather all = trace_rays(&f, true, 0), some;
	uint32_t count = 64 * s->records.count, listed = count / 3;
	gw_buffer list;
	assert_ok(gw_ray_gather_create(s->gpu, &s->records, 64, 7, &some, &error), &error);
	assert_ok(gw_buffer_create(s->gpu, GW_BUFFER_TEXEL, VK_FORMAT_R32_UINT, 4 * (listed + 1u),
							   "list", &list, &error),
			  &error);
	uint32_t *number = list.mapped;
	number[0] = listed;
	for (uint32_t i = 0; i < listed; i++)
		number[i + 1] = count - 1 - 3 * i;
	gw_host_record_again(&s->passes, &s->octree, &s->records, &list, listed, &some);
	const float *expected = all.distance.mapped, *distance = some.distance.mapped;
	const uint32_t *expected_lobe = all.lobe.mapped, *lobe = some.lobe.mapped;
	for (uint32_t i = 0; i < count; i++) {
		bool in_list = (count - 1 - i) % 3 == 0 && (count - 1 - i) / 3 < listed;
		assert_true(distance[i] == (in_list ? expected[i] : 0.0f));
		assert_int_equal(lobe[i], in_list ? expected_lobe[i] : 0);
	}
	gw_buffer_destroy(s->gpu, &list);
	gw_ray_gather_destroy(s->gpu, &all);
	gw_ray_gather_destroy(s->gpu, &some);
	tear_down(&f);
}

/* Fails when light differs by more than rays that go another way can bring; frees both. All of a
 * source's rays bring the same or less to each place, so that their share is that of the light. */
static void compare_light(float *a, float *b, size_t count)
{
	double off = 0.0, sum = 0.0;
	for (size_t i = 0; i < count; i++) {
		off += fabs((double)a[i] - (double)b[i]);
		sum += fabs((double)b[i]);
	}
	assert_true(sum > 0.0);
	if (!(off <= STRAYED * sum))
		fail_msg("light differs by %.3g of itself", off / sum);
	free(a);
	free(b);
}

/* What records gather of the lamp in the ceiling and of a sky with a map. */
static float *sampled(fixture *f, const gw_emitters *emitters, const gw_sky_map *map, bool host)
{
	gw_scene *s = &f->scene;
	gw_error error = { 0 };
	const float sky[3] = { 0.1f, 0.2f, 0.4f };
	gw_buffer irradiance = random_vectors(f, s->records.count);
	const gw_sampled_sources sources = { .emitters = emitters,
										 .samples = 64,
										 .use_hits = true,
										 .sky = sky,
										 .map = map,
										 .map_samples = 64,
										 .map_hits = true,
										 .looked = true,
										 .seed = 5 };
	s->gpu->may_map = host;
	assert_ok(gw_ray_gather_sampled(&s->passes, &s->octree, &s->records, &s->rays, &sources,
									&irradiance, &error),
			  &error);
	s->gpu->may_map = true;
	float *values = contents(f, &irradiance);
	gw_buffer_destroy(s->gpu, &irradiance);
	return values;
}

static void samples_alike(void **state)
{
	(void)state;
	fixture f;
	gw_error error = { 0 };
	set_up(&f);
	gw_scene *s = &f.scene;
	float pixel[32 * 16 * 3];
	for (size_t i = 0; i < 32 * 16 * 3; i++)
		pixel[i] = (float)scene_random(&f.hall);
	gw_light light = { .type = GW_LIGHT_ENVIRONMENT,
					   .radiance = { 1.0f, 1.0f, 1.0f },
					   .map = pixel,
					   .map_width = 32,
					   .map_height = 16 };
	gw_sky_map map = { 0 }, no_map = { 0 };
	gw_emitters emitters, none = { .radiance = &s->octree.lobe_emission };
	assert_ok(gw_sky_map_make(s->gpu, &light, &map, &error), &error);
	assert_ok(
		gw_emitters_make(s->gpu, &s->octree, &s->octree.lobe_emission, true, &emitters, &error),
		&error);
	size_t count = 4 * (size_t)s->records.count;
	compare_light(sampled(&f, &emitters, &no_map, true), sampled(&f, &emitters, &no_map, false),
				  count);
	compare_light(sampled(&f, &none, &map, true), sampled(&f, &none, &map, false), count);
	map.y_up = 1;
	compare_light(sampled(&f, &none, &map, true), sampled(&f, &none, &map, false), count);
	gw_emitters_destroy(s->gpu, &emitters);
	gw_sky_map_destroy(s->gpu, &map);
	tear_down(&f);
}

/* What lies nearest to each record, and which are buried, all of it by the same hits. */
static void looks_alike(void **state)
{
	(void)state;
	fixture f;
	gw_error error = { 0 };
	float *place[2], *facing[2];
	set_up(&f);
	gw_scene *s = &f.scene;
	for (int host = 0; host < 2; host++) {
		s->gpu->may_map = host;
		assert_ok(gw_ray_gather_look(&s->passes, &s->octree, &s->records, &s->rays, &error),
				  &error);
		s->gpu->may_map = true;
		place[host] = contents(&f, &s->records.position);
		facing[host] = contents(&f, &s->records.normal);
		assert_ok(gw_buffer_fill(s->gpu, &s->records.position, 0, &error), &error);
		assert_ok(gw_buffer_fill(s->gpu, &s->records.normal, 0, &error), &error);
	}
	for (size_t i = 3; i < 4 * (size_t)s->records.count; i += 4) {
		assert_true(place[0][i] == place[1][i] && facing[0][i] == facing[1][i]);
		assert_true(place[0][i] > 0.0f);
	}
	for (int host = 0; host < 2; host++) {
		free(place[host]);
		free(facing[host]);
	}
	tear_down(&f);
}

/* Lamps of all kinds, one of them with an extent. */
static void make_lamps(const fixture *f, gw_light light[LAMPS])
{
	for (size_t i = 0; i < LAMPS; i++)
		light[i] = i + 1 < LAMPS ? f->light : (gw_light){ .type = GW_LIGHT_SUN };
	light[1].radius = 0.2f;
	light[2].type = GW_LIGHT_SPOT;
	light[2].direction[2] = -1.0;
	light[2].inner_angle = 20.0f;
	light[2].outer_angle = 50.0f;
	light[3].direction[1] = 1.0;
	light[3].direction[2] = -0.4;
	light[3].angle = 2.0f;
	light[3].irradiance[0] = 1.0f;
}

/* Share of a light that each surfel sees, where lamps have an extent and where they have none. */
static void shadows_alike(void **state)
{
	(void)state;
	fixture f;
	gw_error error = { 0 };
	set_up(&f);
	gw_scene *s = &f.scene;
	gw_light light[LAMPS];
	make_lamps(&f, light);
	for (int i = 0; i < LAMPS; i++) {
		float *share[2];
		for (int host = 0; host < 2; host++) {
			share[host] = calloc(s->surfels.count, sizeof **share);
			assert_non_null(share[host]);
			s->gpu->may_map = host;
			assert_ok(gw_light_share(&s->passes, &s->octree, &s->surfels, &light[i], &s->options,
									 share[host], &error),
					  &error);
			s->gpu->may_map = true;
		}
		compare_light(share[1], share[0], s->surfels.count);
	}
	tear_down(&f);
}

/* What all of them bring to each surfel and each lobe. */
static void lamps_alike(void **state)
{
	(void)state;
	fixture f;
	gw_error error = { 0 };
	set_up(&f);
	gw_scene *s = &f.scene;
	gw_light light[LAMPS];
	float *surfels[2], *lobes[2];
	make_lamps(&f, light);
	size_t slots = 2 * (size_t)s->octree.leaf_count;
	for (int host = 0; host < 2; host++) {
		gw_buffer own = dark_vectors(&f, s->surfels.count), mean = dark_vectors(&f, slots);
		s->gpu->may_map = host;
		assert_ok(gw_direct_light(&s->passes, &s->octree, &s->surfels, light, LAMPS, &s->options,
								  &own, &mean, NULL, &error),
				  &error);
		s->gpu->may_map = true;
		surfels[host] = contents(&f, &own);
		lobes[host] = contents(&f, &mean);
		gw_buffer_destroy(s->gpu, &own);
		gw_buffer_destroy(s->gpu, &mean);
	}
	compare_light(surfels[1], surfels[0], 4 * s->surfels.count);
	compare_light(lobes[1], lobes[0], 4 * slots);
	tear_down(&f);
}

/* ----------------------------------------------------------------------------------- lookups */

/* Rows of records and weights, at most `width` of each. */
typedef struct rows {
	uint32_t *record;
	float *weight;
	size_t count, width;
} rows;

/* Rows that a ray which went another way has changed; frees both. */
static size_t count_changed(rows *a, rows *b)
{
	size_t changed = 0, used = 0;
	for (size_t i = 0; i < a->count; i++) {
		bool same = true;
		for (size_t k = i * a->width; same && k < (i + 1) * a->width; k++) {
			same = a->record[k] == b->record[k];
			if (a->record[k] == GW_NONE)
				break;
			same = same && fabsf(a->weight[k] - b->weight[k]) < 1e-4f;
			used++;
		}
		changed += !same;
	}
	assert_true(used > a->count / 2);
	free(a->record);
	free(a->weight);
	free(b->record);
	free(b->weight);
	return changed;
}

static rows lobe_rows(fixture *f, const gw_buffer *reach, bool host)
{
	gw_scene *s = &f->scene;
	gw_error error = { 0 };
	s->gpu->may_map = host;
	assert_ok(gw_records_weigh_lobes(&s->passes, &s->octree, &s->records, NULL, &error), &error);
	assert_ok(gw_records_weigh_lobes(&s->passes, &s->octree, &s->records, reach, &error), &error);
	s->gpu->may_map = true;
	return (rows){ (uint32_t *)contents(f, &s->records.lobe_record),
				   contents(f, &s->records.lobe_weight), 2 * (size_t)s->octree.leaf_count,
				   GW_WEIGHTS };
}

static rows surfel_rows(fixture *f, const gw_buffer *reach, bool host)
{
	gw_scene *s = &f->scene;
	gw_error error = { 0 };
	uint64_t first = 100, count = s->surfels.count - first;
	gw_buffer record, weight;
	assert_ok(gw_buffer_create(s->gpu, GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED,
							   4 * GW_SURFEL_WEIGHTS * count, "records", &record, &error),
			  &error);
	assert_ok(gw_buffer_create(s->gpu, GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED,
							   4 * GW_SURFEL_WEIGHTS * count, "weights", &weight, &error),
			  &error);
	s->gpu->may_map = host;
	assert_ok(gw_records_weigh_surfels(&s->passes, &s->octree, &s->records, reach, first, count,
									   &record, &weight, &error),
			  &error);
	s->gpu->may_map = true;
	rows found = { (uint32_t *)contents(f, &record), contents(f, &weight), (size_t)count,
				   GW_SURFEL_WEIGHTS };
	gw_buffer_destroy(s->gpu, &record);
	gw_buffer_destroy(s->gpu, &weight);
	return found;
}

/* Every third place looks as far as all records reach, every third less far, the others not at all.
 */
static gw_buffer uneven_reach(fixture *f, size_t count)
{
	gw_error error = { 0 };
	gw_buffer reach;
	float *value = calloc(count, sizeof *value);
	assert_non_null(value);
	for (size_t i = 0; i < count; i++)
		value[i] = 0.5f * (float)(i % 3) * f->scene.records.radius;
	assert_ok(gw_buffer_create(f->scene.gpu, GW_BUFFER_TEXEL, VK_FORMAT_R32_SFLOAT, 4 * count,
							   "reach", &reach, &error),
			  &error);
	assert_ok(gw_buffer_upload(f->scene.gpu, &reach, 0, value, 4 * count, &error), &error);
	free(value);
	return reach;
}

/* A row asks for at most some ten rays, short ones, and a rounding may decide whether one is. */
static void lookups_alike(void **state)
{
	(void)state;
	fixture f;
	set_up(&f);
	gw_scene *s = &f.scene;
	gw_buffer lobes = uneven_reach(&f, 2 * (size_t)s->octree.leaf_count);
	gw_buffer surfels = uneven_reach(&f, s->surfels.count);
	const struct {
		rows (*find)(fixture *f, const gw_buffer *reach, bool host);
		const gw_buffer *reach;
	} way[] = {
		{ lobe_rows, NULL }, { lobe_rows, &lobes }, { surfel_rows, NULL }, { surfel_rows, &surfels }
	};
	for (size_t i = 0; i < sizeof way / sizeof *way; i++) {
		rows host = way[i].find(&f, way[i].reach, true);
		rows passes = way[i].find(&f, way[i].reach, false);
		size_t changed = count_changed(&host, &passes);
		if ((double)changed > 10.0 * STRAYED * (double)host.count)
			fail_msg("way %zu: %zu of %zu rows differ", i, changed, host.count);
	}
	gw_buffer_destroy(s->gpu, &lobes);
	gw_buffer_destroy(s->gpu, &surfels);
	tear_down(&f);
}

/* ------------------------------------------------------------------------------------ wholes */

/* All bounces, with as many threads; the caller frees what is returned. */
static float *light(fixture *f, bool host, uint32_t threads, uint32_t *bounces)
{
	gw_error error = { 0 };
	gw_scene *s = &f->scene;
	gw_lighting lighting = { .scene = s, .lights = &f->light, .light_count = 1 };
	s->gpu->may_map = host;
	s->passes.threads = threads;
	gw_lighting_plan(&lighting);
	assert_ok(gw_lighting_run(&lighting, &error), &error);
	s->gpu->may_map = true;
	*bounces = f->report.bounce_count;
	float *indirect = lighting.surfel_indirect;
	lighting.surfel_indirect = NULL;
	gw_lighting_clear(&lighting);
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
	size_t count = 4 * f.scene.surfels.count;
	float *passes = light(&f, false, 0, &bounces[0]);
	float *host = light(&f, true, 0, &bounces[1]), *alone = light(&f, true, 1, &bounces[2]);
	assert_true(bounces[0] == bounces[1] && bounces[0] == bounces[2] && bounces[0] > 3);
	assert_memory_equal(host, alone, count * sizeof *host);
	free(alone);
	compare(host, passes, count, 2.0 * (f.scene.rays.rays + GW_WEIGHTS + GW_SURFEL_WEIGHTS));
	tear_down(&f);
}

static void views(void **state)
{
	(void)state;
	fixture f;
	gw_error error = { 0 };
	set_up(&f);
	gw_gpu *gpu = f.scene.gpu;
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
		cmocka_unit_test(rays_alike),    cmocka_unit_test(listed_rays),
		cmocka_unit_test(looks_alike),   cmocka_unit_test(samples_alike),
		cmocka_unit_test(shadows_alike), cmocka_unit_test(lamps_alike),
		cmocka_unit_test(lookups_alike), cmocka_unit_test(bounce_alike),
		cmocka_unit_test(views),
	};
	const struct CMUnitTest large[] = {
		cmocka_unit_test(rays_alike),
		cmocka_unit_test(samples_alike),
		cmocka_unit_test(shadows_alike),
	};
	int failed = cmocka_run_group_tests(tests, NULL, NULL);
	return failed + cmocka_run_group_tests_name("discs in a tree", large, use_great_depth, NULL);
}

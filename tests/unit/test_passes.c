/*
 * test_passes.c - the table of passes: each that has a shader and a CPU kernel goes both ways.
 *
 * Whole bakes are made with --wrap=gw_passes_run: whatever pass they run by its kernel is run by
 * its shader first, on the same bytes, and by one thread and by three. So there is one test for all
 * passes that there will ever be, on inputs as bakes have them; the last one asks that every kernel
 * of the table was met. What may differ:
 *
 *   integers do not; nor does what one multiplication or addition makes of the same numbers
 *   sums add the same numbers, none of them negative, in any order: a sum of n terms is rounded by
 *   n * 2^-24 of itself at most, and ROUNDINGS more
 *   rays go the same way but for roundings, see STRAYED; and so does the light that they bring
 */
#include "device/gpu_internal.h"
#include "device/passes.h"
#include "device/prefix_sum.h"
#include "glowworm_picture.h"
#include "picture/render_octree.h"
#include "glowworm_probes.h"
#include "expected.h"
#include "scenes.h"
#include "light/transport_layout.h"

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

/* Numbers that a few rays may make: a pass is called with few elements, too. */
#define STRAYED_AT_LEAST 2.0

/* Rays that a row of weights asks for, short ones. */
#define RAYS_OF_A_ROW 10.0

/* ------------------------------------------------------------------------------------ the list */

/* How the outputs of a pass are compared: a letter for each storage buffer, in binding order.
 *   =  the same bytes
 *   +  floats, sums of `terms`
 *   l  floats, light that rays bring: all together may be off by the share that strayed
 *   v  the same, but for what is marked as hidden by a crease
 *   b  bits, each what a ray says
 *   h  what a ray hit, and d how far that is, negative if a back was seen on the way
 *   r  rows of `terms` records, up to GW_NONE, and w their weights */
static const struct {
	const char *outputs;
	double terms;
} list[GW_PASS_COUNT] = {
	[GW_PASS_PREFIX_SUM] = { "==", 0 },
	[GW_PASS_RADIX_COUNT] = { "=", 0 },
	[GW_PASS_RADIX_SCATTER] = { "====", 0 },
	[GW_PASS_LIGHT_VISIBILITY] = { "==v==", 0 },
	[GW_PASS_LIGHT_IRRADIANCE] = { "===l=", 0 },
	[GW_PASS_FACET_DIRECT] = { "+", 2047 }, /* of a leaf, so many fragments count at most */
	[GW_PASS_RECORD_RAYS] = { "hd=", 0 },
	[GW_PASS_RECORD_AGAIN] = { "hd=", 0 },
	[GW_PASS_RECORD_EMITTERS] = { "==ll=", 0 },
	[GW_PASS_RECORD_SKY] = { "==ll=", 0 },
	[GW_PASS_RECORD_PORTALS] = { "b=", 0 },
	[GW_PASS_PORTAL_LIGHT] = { "==ll", 0 },
	[GW_PASS_RECORD_FIRST] = { "===ll", 0 },
	[GW_PASS_RECORD_GATHER] = { "=+", 64 }, /* rays of a record */
	[GW_PASS_RECORD_MOMENTS] = { "==l", 0 },
	[GW_PASS_RECORD_SHARE] = { "=llll", 0 },
	[GW_PASS_RECORD_ADD] = { "==", 0 },
	[GW_PASS_FACET_WEIGHTS] = { "rw=", GW_WEIGHTS },
	[GW_PASS_FACET_SHADE] = { "==+=", GW_WEIGHTS + 1 },
	[GW_PASS_READ_BACK] = { "rw", GW_SURFEL_WEIGHTS },
	[GW_PASS_VOLUME_RAYS] = { "h=", 0 },
	[GW_PASS_VOLUME_FILL] = { "=l", 0 },
	[GW_PASS_VOLUME_WEIGHTS] = { "rw", GW_VOLUME_WEIGHTS },
	[GW_PASS_VOLUME_READ] = { "==l", 0 },
	[GW_PASS_VOLUME_FACES] = { "l=", 0 },
	[GW_PASS_VOLUME_INJECT] = { "ll", 0 },
	[GW_PASS_VOLUME_SPREAD] = { "ll", 0 },
	[GW_PASS_PROBE_SIGHT] = { "l=", 0 },
	[GW_PASS_PROBE_RAYS] = { "hd=", 0 },
	[GW_PASS_GIVEN_RAYS] = { "==l=", 0 },
	[GW_PASS_CACHE_RAYS] = { "l=", 0 },
	[GW_PASS_CACHE_MIPS] = { "+", 4 },
	[GW_PASS_PIXEL_CACHES] = { "==l", 0 },
};

/* Elements that went both ways so far, and of those the ones with portals, or a map for rays. */
static uint64_t met[GW_PASS_COUNT], met_portals, met_maps;

/* -------------------------------------------------------------------------------- comparisons */

/* One output, as each way left it. */
typedef struct pair {
	const char *name;    /* of the pass */
	const float *a, *b;  /* shader, kernel */
	const float *before; /* either of them */
	size_t count;        /* words */
} pair;

static uint32_t word_of(float value)
{
	uint32_t word;
	memcpy(&word, &value, sizeof word);
	return word;
}

static void compare_sums(const pair *p, double terms)
{
	double tolerance = (terms + ROUNDINGS) * 0x1p-24;
	for (size_t i = 0; i < p->count; i++) {
		double off = fabs((double)p->a[i] - (double)p->b[i]);
		if (!(off <= tolerance * fabs((double)p->a[i])))
			fail_msg("%s: number %zu of %zu is %.9g by its shader and %.9g by its kernel", p->name,
					 i, p->count, (double)p->a[i], (double)p->b[i]);
	}
}

static double without_crease(float visibility, bool creases)
{
	return (double)(creases && visibility >= GW_HIDDEN_BY_CREASE ? visibility - GW_HIDDEN_BY_CREASE
																 : visibility);
}

/* Neither way wrote it: memory of new buffers is whatever was there. */
static bool is_as_before(const pair *p, size_t i)
{
	return word_of(p->a[i]) == word_of(p->before[i]) && word_of(p->b[i]) == word_of(p->before[i]);
}

static void compare_light(const pair *p, bool creases)
{
	double off = 0.0, sum = 0.0, most = 0.0;
	for (size_t i = 0; i < p->count; i++) {
		if (is_as_before(p, i))
			continue;
		double a = without_crease(p->a[i], creases), b = without_crease(p->b[i], creases);
		off += fabs(a - b);
		sum += fabs(a);
		most = fmax(most, fabs(a));
	}
	if (!(off <= STRAYED * sum + STRAYED_AT_LEAST * most))
		fail_msg("%s: light differs by %.3g of itself", p->name, off / sum);
}

static void compare_shares(const pair *p, size_t strayed, size_t count, double rays)
{
	if ((double)strayed > STRAYED * rays * (double)count + STRAYED_AT_LEAST)
		fail_msg("%s: %zu of %zu rays or rows go another way", p->name, strayed, count);
}

static void compare_hits(const pair *p)
{
	size_t strayed = 0;
	for (size_t i = 0; i < p->count; i++)
		strayed += word_of(p->a[i]) != word_of(p->b[i]);
	compare_shares(p, strayed, p->count, 1.0);
}

static void compare_bits(const pair *p)
{
	size_t strayed = 0;
	for (size_t i = 0; i < p->count; i++)
		strayed += (size_t)__builtin_popcount(word_of(p->a[i]) ^ word_of(p->b[i]));
	compare_shares(p, strayed, p->count, 32.0);
}

static void compare_distances(const pair *p)
{
	size_t strayed = 0;
	for (size_t i = 0; i < p->count; i++)
		strayed += !(fabsf(p->a[i] - p->b[i]) < 0.01f || p->a[i] == p->b[i]);
	compare_shares(p, strayed, p->count, 1.0);
}

/* Whether both have the same records in a row, with weights that differ by no more than roundings
 * of a distance can make them: 2^-17 cells of one that is a cell at least. */
static bool same_row(const pair *records, const pair *weights, size_t at, size_t width)
{
	for (size_t k = at; k < at + width; k++) {
		uint32_t a = word_of(records->a[k]), b = word_of(records->b[k]);
		if (a != b)
			return false;
		if (a == GW_NONE)
			break;
		if (!(fabsf(weights->a[k] - weights->b[k]) < 1e-4f))
			return false;
	}
	return true;
}

static void compare_rows(const pair *records, const pair *weights, size_t width)
{
	size_t changed = 0, rows = records->count / width;
	for (size_t row = 0; row < rows; row++)
		changed += !same_row(records, weights, row * width, width);
	compare_shares(records, changed, rows, RAYS_OF_A_ROW);
}

static void compare_output(char letter, const pair *p, const pair *last, double terms)
{
	switch (letter) {
	case '+':
		compare_sums(p, terms);
		break;
	case 'l':
	case 'v':
		compare_light(p, letter == 'v');
		break;
	case 'b':
		compare_bits(p);
		break;
	case 'h':
		compare_hits(p);
		break;
	case 'd':
		compare_distances(p);
		break;
	case 'r':
		break; /* with the weights */
	case 'w':
		compare_rows(last, p, (size_t)terms);
		break;
	default:
		if (memcmp(p->a, p->b, p->count * sizeof *p->a) != 0)
			fail_msg("%s: shader and kernel leave other bytes", p->name);
	}
}

/* ---------------------------------------------------------------------------------- both ways */

#define OUTPUTS 5

/* What a pass writes to: the same buffers, and their bytes at four moments. */
typedef struct outputs {
	size_t count;
	gw_buffer *buffer[OUTPUTS];
	unsigned char *before[OUTPUTS], *shader[OUTPUTS], *alone[OUTPUTS];
} outputs;

static void keep(const outputs *o, unsigned char *const to[OUTPUTS])
{
	for (size_t i = 0; i < o->count; i++)
		memcpy(to[i], o->buffer[i]->mapped, (size_t)o->buffer[i]->bytes);
}

static void restore(const outputs *o)
{
	for (size_t i = 0; i < o->count; i++)
		memcpy(o->buffer[i]->mapped, o->before[i], (size_t)o->buffer[i]->bytes);
}

static outputs outputs_of(const gw_pass_row *row, const gw_binding *bindings)
{
	outputs o = { 0 };
	for (size_t i = 0; row->bindings[i] != '\0'; i++)
		if (row->bindings[i] == 's') {
			assert_true(o.count < OUTPUTS);
			o.buffer[o.count++] = bindings[i].buffer;
		}
	for (size_t i = 0; i < o.count; i++) {
		size_t bytes = (size_t)o.buffer[i]->bytes + 1;
		o.before[i] = malloc(bytes);
		o.shader[i] = malloc(bytes);
		o.alone[i] = malloc(bytes);
		assert_true(o.before[i] && o.shader[i] && o.alone[i]);
	}
	return o;
}

static void forget(outputs *o)
{
	for (size_t i = 0; i < o->count; i++) {
		free(o->before[i]);
		free(o->shader[i]);
		free(o->alone[i]);
	}
}

static void compare_all(gw_pass_id id, const outputs *o)
{
	pair last = { 0 };
	const char *letters = list[id].outputs;
	if (letters == NULL || strlen(letters) != o->count)
		fail_msg("%s: the list does not say how its outputs are compared",
				 gw_pass_row_of(id)->shader);
	for (size_t i = 0; i < o->count; i++) {
		const pair p = { .name = gw_pass_row_of(id)->shader,
						 .a = (const float *)(const void *)o->shader[i],
						 .b = o->buffer[i]->mapped,
						 .before = (const float *)(const void *)o->before[i],
						 .count = (size_t)(o->buffer[i]->bytes / sizeof(float)) };
		compare_output(letters[i], &p, &last, list[id].terms);
		assert_memory_equal(o->alone[i], o->buffer[i]->mapped, o->buffer[i]->bytes);
		last = p;
	}
}

static gw_status run_both(gw_passes *passes, gw_pass_id id, const gw_binding *bindings,
						  const void *push, uint64_t count, gw_error *error)
{
	uint32_t threads = passes->threads;
	outputs o = outputs_of(gw_pass_row_of(id), bindings);
	GW_TRY(gw_gpu_finish(passes->gpu, error)); /* buffers are looked at where they lie */
	keep(&o, o.before);
	GW_TRY(gw_passes_run_shader(passes, id, bindings, push, count, error));
	GW_TRY(gw_gpu_finish(passes->gpu, error));
	keep(&o, o.shader);
	restore(&o);
	passes->threads = 1;
	gw_passes_run_kernel(passes, id, bindings, push, count);
	keep(&o, o.alone);
	restore(&o);
	passes->threads = 3;
	gw_passes_run_kernel(passes, id, bindings, push, count);
	passes->threads = threads;
	compare_all(id, &o);
	forget(&o);
	met[id] += count;
	if (id == GW_PASS_RECORD_SKY && ((const gw_record_push *)push)->portals > 0)
		met_portals += count;
	if (id == GW_PASS_RECORD_FIRST && ((const gw_record_push *)push)->sky_hits > 0)
		met_maps += count;
	return GW_OK;
}

static bool both_ways = true;
static uint64_t by_kernel; /* runs */

gw_status __wrap_gw_passes_run(gw_passes *passes, gw_pass_id id, const gw_binding *bindings,
							   const void *push, uint64_t count, gw_error *error);
gw_status __wrap_gw_passes_run(gw_passes *passes, gw_pass_id id, const gw_binding *bindings,
							   const void *push, uint64_t count, gw_error *error)
{
	gw_pass_way way = gw_passes_way(passes, id);
	by_kernel += way == GW_WAY_CPU;
	if (both_ways && way == GW_WAY_CPU && count > 0)
		return run_both(passes, id, bindings, push, count, error);
	if (way == GW_WAY_DEVICE)
		return gw_passes_run_shader(passes, id, bindings, push, count, error);
	gw_passes_run_kernel(passes, id, bindings, push, count);
	return GW_OK;
}

/* --------------------------------------------------------------------------------------- bakes */

#define LAMPS 8

/* Lamps of all kinds, two of them with an extent. */
static void make_lamps(gw_light light[LAMPS])
{
	/* Angles from the axis, around it, and shares in five planes. */
	static const float luminaire[] = { 0, 40,   120, 0,    90,   180, 270, 360,  1, 0.5f, 0, 1,
									   1, 0.2f, 1,   0.7f, 0.1f, 1,   0,   0.3f, 1, 0.5f, 0 };
	for (size_t i = 0; i < LAMPS; i++)
		light[i] = i + 1 < LAMPS ? scene_point_light(1.0, 1.0, 1.2, 2.0f)
								 : (gw_light){ .type = GW_LIGHT_SUN };
	light[1].radius = 0.2f;
	light[2].type = GW_LIGHT_SPOT;
	light[2].direction[2] = -1.0;
	light[2].inner_angle = 20.0f;
	light[2].outer_angle = 50.0f;
	light[3].direction[1] = 0.5;
	light[3].direction[2] = -1.0;
	light[3].across[0] = 1.0;
	light[3].distribution = luminaire;
	light[3].vertical_count = 3;
	light[3].horizontal_count = 5;
	for (size_t i = 4; i < 7; i++) {
		light[i].type = i == 4 ? GW_LIGHT_SPHERE : i == 5 ? GW_LIGHT_DISC : GW_LIGHT_RECTANGLE;
		light[i].direction[1] = 0.25;
		light[i].direction[2] = -1.0;
		light[i].across[0] = 1.0;
		light[i].radius = 0.2f;
		light[i].size[0] = 0.5f;
		light[i].size[1] = 0.25f;
	}
	light[7].direction[1] = 1.0;
	light[7].direction[2] = -0.4;
	light[7].angle = 2.0f;
	light[7].irradiance[0] = 1.0f;
}

static gw_bake_result *bake_hall(const gw_light *light, size_t lights,
								 const gw_bake_options *options)
{
	scene hall = { 0 };
	scene_make_small_hall(&hall);
	const gw_points points = scene_points(&hall);
	gw_bake_result *result = scene_bake(&points, light, lights, options);
	scene_clear(&hall);
	return result;
}

/* Lamps, points that emit, bounces, an estimate of the error. */
static void lamps_both_ways(void **state)
{
	gw_light light[LAMPS];
	gw_bake_options options = gw_bake_options_default();
	(void)state;
	make_lamps(light);
	options.rays = options.light_samples = 16;
	options.estimate_points = 100;
	gw_bake_result *result = bake_hall(light, LAMPS, &options);
	gw_bake_result_destroy(&result);
}

/* An octree so deep that all discs are in its tree. */
static void large_discs_both_ways(void **state)
{
	gw_light light[LAMPS];
	gw_bake_options options = gw_bake_options_default();
	(void)state;
	make_lamps(light);
	options.depth = 11;
	options.rays = options.light_samples = 16;
	options.bounces = 1;
	options.estimate_points = 0;
	gw_bake_result *result = bake_hall(light, 2, &options);
	gw_bake_result_destroy(&result);
}

static void bake_by_cells(gw_method method)
{
	gw_light light[LAMPS];
	gw_bake_options options = gw_bake_options_default();
	make_lamps(light);
	options.method = method;
	options.volume_cells = 12;
	options.rays = options.light_samples = 16;
	options.bounces = 2;
	options.estimate_points = 0;
	gw_bake_result *result = bake_hall(light, 2, &options);
	gw_bake_result_destroy(&result);
}

/* A volume in the place of rays; light that goes from cell to cell. */
static void volume_both_ways(void **state)
{
	(void)state;
	bake_by_cells(GW_METHOD_VOLUME);
}

static void propagation_both_ways(void **state)
{
	(void)state;
	bake_by_cells(GW_METHOD_LPV);
}

/* Under a map of the sky, as it is and turned. */
static void bake_under_map(scene *s)
{
	float pixel[32 * 16 * 3];
	gw_bake_options options = gw_bake_options_default();
	options.rays = options.light_samples = 16;
	options.estimate_points = 0;
	for (size_t i = 0; i < sizeof pixel / sizeof *pixel; i++)
		pixel[i] = (float)scene_random(s);
	gw_light light = { .type = GW_LIGHT_ENVIRONMENT,
					   .radiance = { 1.0f, 1.0f, 1.0f },
					   .map = pixel,
					   .map_width = 32,
					   .map_height = 16 };
	const gw_points points = scene_points(s);
	for (int y_up = 0; y_up < 2; y_up++) {
		light.map_y_up = y_up;
		options.bounces = 1;
		gw_bake_result *result = scene_bake(&points, &light, 1, &options);
		gw_bake_result_destroy(&result);
	}
	scene_clear(s);
}

/* A floor with a ball, from which rays leave by no portal: they see the map themselves. */
static void sky_both_ways(void **state)
{
	scene s = { 0 };
	(void)state;
	scene_add_patch(
		&s,
		&(scene_patch){ (double[3]){ 0 }, (double[3]){ 2, 0, 0 }, (double[3]){ 0, 2, 0 }, 40, 40 },
		0.5f);
	scene_add_sphere(&s, (double[3]){ 1, 1, 0.4 }, 0.3, 500, 1, 0.5f);
	bake_under_map(&s);
	assert_true(met_maps > 0 || met[GW_PASS_RECORD_FIRST] == 0);
}

/* A cellar with a hole, which is a portal. */
static void portals_both_ways(void **state)
{
	scene s = { 0 };
	(void)state;
	scene_make_cellar(&s);
	bake_under_map(&s);
	assert_true(met_portals > 0 || met[GW_PASS_RECORD_SKY] == 0);
}

/* Probes in a box with a ball. */
static void probes_both_ways(void **state)
{
	scene s = { 0 };
	const gw_light light = scene_point_light(0.2, 0.2, 0.8, 1.0f);
	gw_bake_options options = gw_bake_options_default();
	gw_probes_options few = gw_probes_options_default();
	gw_scene *prepared = NULL;
	gw_lighting *lighting = NULL;
	gw_probes *probes = NULL;
	gw_error error = { 0 };
	(void)state;
	few.size = 16;
	few.moves = 4;
	options.estimate_points = 0;
	scene_add_box(&s, (double[3]){ 0, 0, 0 }, (double[3]){ 1, 1, 1 }, 10, 0.5f);
	scene_add_sphere(&s, (double[3]){ 0.6, 0.6, 0.4 }, 0.2, 100, 1, 0.5f);
	const gw_points points = scene_points(&s);
	const gw_scene_description description = { &points, &light, 1 };
	scene_choose_passes(&options.passes, &options.validate);
	assert_ok(gw_scene_create(&description, &options, NULL, &prepared, &error), &error);
	assert_ok(gw_lighting_create(prepared, &light, 1, &lighting, &error), &error);
	assert_ok(gw_probes_make(lighting, &few, &probes, &error), &error);
	gw_probes_destroy(&probes);
	gw_lighting_destroy(&lighting);
	gw_scene_destroy(&prepared);
	scene_clear(&s);
}

/* A ball in the hall moves: rays that may meet it are traced again. */
static void frames_both_ways(void **state)
{
	enum { FRAMES = 2 };
	scene s = { 0 };
	double matrix[16 * FRAMES] = { 0 };
	const gw_light light = scene_point_light(1.0, 1.0, 1.2, 2.0f);
	gw_bake_options options = gw_bake_options_default();
	gw_frames *frames = NULL;
	gw_error error = { 0 };
	(void)state;
	scene_make_small_hall(&s);
	const gw_mover ball = { .first = s.count, .count = 300 };
	scene_add_sphere(&s, (double[3]){ 1, 2, 1 }, 0.25, ball.count, 1, 0.5f);
	for (size_t i = 0; i < FRAMES; i++) {
		for (size_t k = 0; k < 4; k++)
			matrix[16 * i + 5 * k] = 1.0;
		matrix[16 * i + 3] = 1.5 * (double)i;
	}
	const gw_points points = scene_points(&s);
	const gw_motion motion = { &ball, 1, FRAMES, matrix };
	const gw_frames_options how = { .independent = true };
	options.rays = options.light_samples = 16;
	options.estimate_points = 0;
	assert_ok(gw_frames_open(&(gw_moving_scene){ { &points, &light, 1 }, &motion }, &options, &how,
							 NULL, &frames, &error),
			  &error);
	for (size_t i = 0; i < FRAMES; i++) {
		gw_bake_result *result = NULL;
		assert_ok(gw_frames_bake(frames, i, &light, 1, &result, &error), &error);
		gw_bake_result_destroy(&result);
	}
	gw_frames_close(&frames);
	scene_clear(&s);
}

/* A ray from each of the pixels, upwards and to a side. */
static void trace_upwards(gw_render_octree *octree, const gw_pixels *pixels)
{
	gw_error error = { 0 };
	float *way = calloc(pixels->count, 4 * sizeof *way);
	float *light = calloc(pixels->count, 4 * sizeof *light);
	assert_true(way && light);
	for (size_t i = 0; i < pixels->count; i++) {
		way[4 * i + i % 2] = 0.6f;
		way[4 * i + 2] = 0.8f;
	}
	const gw_given_rays rays = { *pixels, way };
	assert_ok(gw_given_rays_trace(octree, &rays, &(gw_reflection){ .rays = 1 }, light, &error),
			  &error);
	free(way);
	free(light);
}

/* Glossy pixels on the floor of a box, which share caches, and rays from them. */
static void caches_both_ways(void **state)
{
	enum { PIXELS = 32 * 32 };
	scene s = { 0 };
	gw_surfels surfels;
	gw_render_octree *octree = NULL;
	gw_error error = { 0 };
	gw_render_octree_options how = { .depth = GW_DEPTH_AUTO, .leaf_spacing = GW_LEAF_SPACING };
	const gw_reflection reflection = { .rays = 1, .caches = true };
	float position[4 * PIXELS], normal[4 * PIXELS], reflected[4 * PIXELS];
	uint32_t place[PIXELS];
	(void)state;
	scene_add_box(&s, (double[3]){ 0, 0, 0 }, (double[3]){ 1, 1, 1 }, 20, 0.5f);
	const gw_points points = scene_points(&s);
	assert_ok(gw_surfels_make(&points, &(gw_surfels_options){ 0 }, &surfels, &error), &error);
	gw_pixels pixels = { .count = PIXELS,
						 .position = position,
						 .normal = normal,
						 .place = place,
						 .width = 32,
						 .height = 32,
						 .step = 1.0f / 32.0f };
	for (size_t k = 0; k < 3; k++)
		pixels.eye[k] = (float)((k == 2 ? 0.9 : 0.5) - surfels.origin[k]);
	for (uint32_t i = 0; i < PIXELS; i++) {
		const double at[3] = { 0.1 + 0.025 * (i % 32), 0.1 + 0.025 * (double)(i / 32), 0.0 };
		for (size_t k = 0; k < 3; k++) {
			position[4 * i + k] = (float)(at[k] - surfels.origin[k]);
			normal[4 * i + k] = k == 2 ? 1.0f : 0.0f;
		}
		position[4 * i + 3] = 0.5f;
		normal[4 * i + 3] = 0.5f;
		place[i] = i;
	}
	scene_choose_passes(&how.passes, &how.validate);
	/* Their positions are as good as random numbers. */
	assert_ok(gw_render_octree_create(&surfels, surfels.position, &how, &octree, &error), &error);
	assert_ok(gw_render_octree_reflect(octree, &pixels, &reflection, reflected, &error), &error);
	trace_upwards(octree, &pixels);
	gw_render_octree_destroy(&octree);
	gw_surfels_clear(&surfels);
	scene_clear(&s);
}

/* All kernels of the table were met; on a device that has memory of its own there is nothing to
 * meet. */
static void none_left_out(void **state)
{
	uint64_t sum = 0;
	(void)state;
	for (int id = 0; id < GW_PASS_COUNT; id++)
		sum += met[id];
	if (sum == 0)
		skip();
	for (int id = 0; id < GW_PASS_COUNT; id++) {
		const gw_pass_row *row = gw_pass_row_of((gw_pass_id)id);
		if (row->cpu != NULL && met[id] == 0)
			fail_msg("%s has a kernel that no bake here has called", row->shader);
		assert_true((list[id].outputs != NULL) == (row->cpu != NULL));
	}
}

/* ----------------------------------------------------------------------------------- the table */

/* Each row has a shader, and either a kernel or a reason. */
static void rows_are_whole(void **state)
{
	(void)state;
	for (int id = 0; id < GW_PASS_COUNT; id++) {
		const gw_pass_row *row = gw_pass_row_of((gw_pass_id)id);
		assert_non_null(row->shader);
		assert_non_null(gw_shader_find(row->shader));
		assert_true((row->why != NULL) == (row->cpu == NULL));
		assert_true(row->push_bytes % 4 == 0 && row->push_bytes <= GW_PUSH_BYTES_MAX);
		assert_true(row->batch == 0 || row->batch_at + 8 <= row->push_bytes);
		for (int other = 0; other < id; other++)
			assert_string_not_equal(row->shader, gw_pass_row_of((gw_pass_id)other)->shader);
	}
}

/* Each shader that is no test's is in it. */
static void shaders_are_rows(void **state)
{
	const gw_shader *shader;
	(void)state;
	for (size_t i = 0; (shader = gw_shader_at(i)) != NULL; i++) {
		bool found = strncmp(shader->name, "test_", 5) == 0 ||
					 strcmp(shader->name, "loop_canary") == 0; /* of gpu_trial.c */
		for (int id = 0; id < GW_PASS_COUNT && !found; id++)
			found = strcmp(gw_pass_row_of((gw_pass_id)id)->shader, shader->name) == 0;
		if (!found)
			fail_msg("shaders/%s.comp is in no row of the table", shader->name);
	}
}

/* ----------------------------------------------------------------------------------- the choice */

static gw_bake_result *bake_by(gw_pass_choice choice)
{
	gw_light light[LAMPS];
	gw_bake_options options = gw_bake_options_default();
	make_lamps(light);
	options.rays = options.light_samples = 16;
	options.estimate_points = 0; /* the light is compared, not its error */
	options.passes = choice;
	by_kernel = 0;
	return bake_hall(light, LAMPS, &options);
}

/* By shaders alone, and by kernels: the same light. Lamps' rays stray by a share of STRAYED, and so
 * do the rays of each bounce: light that was reflected n times by n + 1 of them, which in this
 * hall, where half is lost with each bounce, makes two in the mean. As much may come of rows of
 * weights, of which ten times as many change, by one of some seven records, in second order of its
 * distance.
 */
static void choices_alike(void **state)
{
	(void)state;
	both_ways = false;
	gw_bake_result *device = bake_by(GW_PASSES_DEVICE);
	assert_int_equal(by_kernel, 0);
	gw_bake_result *automatic = bake_by(GW_PASSES_AUTO);
	uint64_t kernels = by_kernel;
	both_ways = true;
	double off = 0.0, sum = 0.0;
	for (size_t i = 0; i < 3 * device->count; i++) {
		off += fabs((double)device->radiance[i] - (double)automatic->radiance[i]);
		sum += (double)device->radiance[i];
	}
	print_message("radiance differs by %.2g of itself\n", off / sum);
	assert_true(sum > 0.0);
	if (!(off <= 4.0 * STRAYED * sum))
		fail_msg("radiance differs by %.3g of itself", off / sum);
	size_t bytes = 3 * device->count * sizeof *device->radiance;
	if (kernels > 0) {
		both_ways = false;
		gw_bake_result *cpu = bake_by(GW_PASSES_CPU);
		both_ways = true;
		assert_int_equal(by_kernel, kernels);
		assert_memory_equal(cpu->radiance, automatic->radiance, bytes);
		assert_memory_not_equal(device->radiance, automatic->radiance, bytes);
		gw_bake_result_destroy(&cpu);
	}
	gw_bake_result_destroy(&device);
	gw_bake_result_destroy(&automatic);
}

/* Kernels need a device that shares memory, and the sentence says so. */
static void kernels_refused(void **state)
{
	(void)state;
	gw_gpu *gpu = NULL;
	gw_gpu_options options = { .passes = GW_PASSES_CPU };
	gw_error error = { 0 };
	gw_status status = gw_gpu_create(&options, &gpu, &error);
	if (status == GW_ERROR_USAGE) {
		assert_non_null(strstr(error.text, "memory of its own"));
		return;
	}
	assert_ok(status, &error);
	assert_true(gw_gpu_shares_memory(gpu));
	gw_gpu_destroy(&gpu);
}

/* Runs a pass that has none of the constants but the first, which is the workgroup's size. */
static void sum_with(gw_gpu *gpu, uint32_t depth)
{
	gw_passes passes = { .gpu = gpu, .constant = { depth } };
	gw_prefix_sum prefix = { 0 };
	gw_error error = { 0 };
	gw_buffer words;
	uint64_t total;
	const gw_buffer_description description = { GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED, 4 * 100,
												"words" };
	assert_ok(gw_buffer_create(gpu, &description, &words, &error), &error);
	assert_ok(gw_buffer_fill(gpu, &words, 3, &error), &error);
	assert_ok(gw_prefix_sum_run(&passes, &prefix, &words, 100, &total, &error), &error);
	assert_int_equal(total, 300);
	gw_prefix_sum_destroy(gpu, &prefix);
	gw_buffer_destroy(gpu, &words);
	gw_passes_destroy(&passes);
}

/* Passes that are kept are not made again, whatever the constants that their shaders lack; others
 * are. Who begins again finds an account as of a device just opened. */
static void passes_are_kept(void **state)
{
	(void)state;
	for (uint32_t kept = 0; kept < 2; kept++) {
		gw_gpu *gpu = NULL;
		const gw_gpu_options options = { .passes = GW_PASSES_DEVICE };
		gw_error error = { 0 };
		uint32_t compiled;
		assert_ok(gw_gpu_create(&options, &gpu, &error), &error);
		if (kept)
			gw_gpu_keep_passes(gpu);
		sum_with(gpu, 5);
		uint64_t runs = gw_passes_runs(gpu, GW_PASS_PREFIX_SUM, &compiled);
		assert_true(runs > 0 && compiled == 1);
		gw_gpu_begin_again(gpu, &options);
		assert_int_equal(gw_passes_runs(gpu, GW_PASS_PREFIX_SUM, &compiled), 0);
		assert_true(gw_gpu_read_account(gpu).dispatches == 0);
		sum_with(gpu, 6);
		assert_int_equal(gw_passes_runs(gpu, GW_PASS_PREFIX_SUM, &compiled), runs);
		assert_int_equal(compiled, 1 - kept);
		gw_gpu_destroy(&gpu);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(rows_are_whole),   cmocka_unit_test(shaders_are_rows),
		cmocka_unit_test(lamps_both_ways),  cmocka_unit_test(large_discs_both_ways),
		cmocka_unit_test(volume_both_ways), cmocka_unit_test(propagation_both_ways),
		cmocka_unit_test(sky_both_ways),    cmocka_unit_test(portals_both_ways),
		cmocka_unit_test(probes_both_ways), cmocka_unit_test(frames_both_ways),
		cmocka_unit_test(caches_both_ways), cmocka_unit_test(none_left_out),
		cmocka_unit_test(choices_alike),    cmocka_unit_test(kernels_refused),
		cmocka_unit_test(passes_are_kept),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

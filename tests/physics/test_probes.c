/* Probes: what they see in a furnace and of half of one, how many it takes to see rooms, and that
 * it is the same every time, and in other light. */
#include "expected.h"
#include "glowworm_probes.h"
#include "scenes.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* Rays that slip between the planes of a closed sphere's leaves are put right: nothing is lost.
 * What is left of sums over 4096 texels are their roundings, and how unlike a sphere a map of them
 * is: harmonics at the middles of texels 2 / 64 wide are off by the square of that. */
#define SUMMED 0.002

#define SPHERE_POINTS 20000

static gw_bake_options bake_options(uint32_t bounces)
{
	gw_bake_options options = gw_bake_options_default();
	options.bounces = bounces;
	options.estimate_points = 0;
	options.effects_forced |= 1u << GW_EFFECT_OCTREE;
	scene_choose_passes(&options.passes, &options.validate);
	return options;
}

/* Probes of a scene in the light of its own emission and of lights. */
typedef struct made {
	gw_probes *probes;
	double leaf_size; /* metres */
	gw_status status;
	gw_error error;
} made;

static made make_probes(const scene *s, const gw_bake_options *bake, const gw_light *light,
						const gw_probes_options *options)
{
	gw_points points = scene_points(s);
	const gw_scene_description description = { &points, light, light ? 1 : 0 };
	gw_scene *prepared = NULL;
	gw_lighting *lighting = NULL;
	made m = { .probes = NULL };
	assert_ok(gw_scene_create(&description, bake, NULL, &prepared, &m.error), &m.error);
	assert_ok(gw_lighting_create(prepared, light, light ? 1 : 0, &lighting, &m.error), &m.error);
	m.leaf_size = gw_scene_report(prepared)->leaf_size;
	m.status = gw_probes_make(lighting, options, &m.probes, &m.error);
	gw_lighting_destroy(&lighting);
	gw_scene_destroy(&prepared);
	return m;
}

static made make_good(const scene *s, const gw_bake_options *bake, const gw_light *light,
					  const gw_probes_options *options)
{
	made m = make_probes(s, bake, light, options);
	if (m.status != GW_OK)
		fail_msg("%s", m.error.text);
	return m;
}

static void assert_near(const char *what, double found, double expected, double allowed)
{
	if (!(fabs(found - expected) <= allowed))
		fail_msg("%s: %.6g, not %.6g: off by %.3g, allowed %.3g", what, found, expected,
				 fabs(found - expected), allowed);
}

/* A sphere of radius 1 that is seen from inside. */
static scene make_sphere(float albedo)
{
	scene s = { 0 };
	scene_add_sphere(&s, (double[3]){ 0, 0, 0 }, 1.0, SPHERE_POINTS, -1, albedo);
	return s;
}

/* Direction of the middle of a texel, as the header says it. */
static void direction_of(uint32_t size, size_t texel, double d[3])
{
	double u = ((double)(texel % size) + 0.5) * 2.0 / size - 1.0;
	double v = ((double)(texel / size) + 0.5) * 2.0 / size - 1.0;
	d[0] = u;
	d[1] = v;
	d[2] = 1.0 - fabs(u) - fabs(v);
	if (d[2] < 0.0) {
		d[0] = (1.0 - fabs(v)) * (u < 0.0 ? -1.0 : 1.0);
		d[1] = (1.0 - fabs(u)) * (v < 0.0 ? -1.0 : 1.0);
	}
	double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
	for (int k = 0; k < 3; k++)
		d[k] /= length;
}

/* Surface is planes in leaf cells: they are off a sphere of radius 1 by the square of a cell's
 * diagonal over 8, and points of a cell by half a cell at its rim. */
static void assert_on_sphere(const made *m, size_t texel)
{
	const gw_probes *p = m->probes;
	const size_t texels = (size_t)p->size * p->size;
	const double *at = p->probe[texel / texels].position;
	double d[3], r = 0.0, facing = 0.0;
	direction_of(p->size, texel % texels, d);
	for (int k = 0; k < 3; k++) {
		double place = at[k] + (double)p->distance[texel] * d[k];
		r += place * place;
		facing += d[k] * (double)p->normal[3 * texel + (size_t)k];
	}
	assert_near("distance from the middle", sqrt(r), 1.0, m->leaf_size);
	assert_true(facing < 0.0);
}

/* Cells whose middle lies in the sphere are those that its only probe serves, and no others but at
 * its rim: by half the diagonal of a cell for what lies in the cell itself, by a leaf for the
 * planes in the leaves, and by a texel's half where that is seen at a slant. */
static void assert_cells(const made *m)
{
	const gw_probe_cells *c = &m->probes->cells;
	const double rim = 0.87 * c->size + m->leaf_size + 2.0 / m->probes->size;
	size_t within = 0, all = 0, beyond = 0;
	for (size_t i = 0; i < c->count; i++) {
		double r = 0.0;
		for (int k = 0; k < 3; k++) {
			double at = c->origin[k] + (c->cell[3 * i + (size_t)k] + 0.5) * c->size;
			r += at * at;
		}
		within += sqrt(r) < 1.0 - rim;
		beyond += sqrt(r) > 1.0 + rim;
		assert_int_equal(c->probe[GW_PROBES_OF_CELL * i], 0);
		assert_int_equal(c->probe[GW_PROBES_OF_CELL * i + 1], -1);
	}
	for (int x = 0; x < 64; x++)
		for (int y = 0; y < 64; y++)
			for (int z = 0; z < 64; z++) {
				const double at[3] = { c->origin[0] + (x + 0.5) * c->size,
									   c->origin[1] + (y + 0.5) * c->size,
									   c->origin[2] + (z + 0.5) * c->size };
				all += sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]) < 1.0 - rim;
			}
	assert_true(all > 10000);
	assert_int_equal(within, all);
	assert_int_equal(beyond, 0);
}

/* Radiance is 1 in all directions; of all harmonics the first alone is there, L sqrt(4 pi). */
static void furnace(void **state)
{
	(void)state;
	scene s = make_sphere(0.0f);
	scene_emit(&s, 0, (float[3]){ 1, 2, 4 });
	const gw_bake_options bake = bake_options(1);
	made m = make_good(&s, &bake, NULL, NULL);
	const gw_probes *p = m.probes;
	const size_t texels = p->count * p->size * p->size;
	assert_int_equal(p->count, 1);
	assert_int_equal(p->size, 64);
	for (size_t i = 0; i < texels; i++) {
		/* Means of equal numbers: but for a few roundings. */
		for (size_t c = 0; c < 3; c++)
			assert_near("radiance", (double)p->radiance[3 * i + c], (double)(1 << c), 1e-5 * 4);
		assert_on_sphere(&m, i);
	}
	for (size_t h = 0; h < GW_PROBE_HARMONICS; h++)
		for (size_t c = 0; c < 3; c++)
			assert_near("harmonic", (double)p->probe->harmonic[h][c] / (double)(1 << c),
						h == 0 ? sqrt(4.0 * SCENE_PI) : 0.0, SUMMED);
	assert_true(p->seen > 0.999 && p->seeable > 0.999);
	assert_cells(&m);
	gw_probes_destroy(&m.probes);
	assert_null(m.probes);
	scene_clear(&s);
}

/* In a white furnace light is reflected until it is 1 / (1 - albedo) of what is sent out: within
 * 1 % in the mean, as test_furnace.c has it. */
static void white_furnace(void **state)
{
	(void)state;
	scene s = make_sphere(0.5f);
	scene_emit(&s, 0, (float[3]){ 1, 1, 1 });
	const gw_bake_options bake = bake_options(GW_BOUNCES_AUTO);
	made m = make_good(&s, &bake, NULL, NULL);
	for (size_t k = 0; k < m.probes->count; k++)
		assert_near("first harmonic", (double)m.probes->probe[k].harmonic[0][1],
					2.0 * sqrt(4.0 * SCENE_PI), 0.01 * 2.0 * sqrt(4.0 * SCENE_PI));
	gw_probes_destroy(&m.probes);
	scene_clear(&s);
}

/*
 * The upper half of the sphere sends out 1, seen from its middle: by the integrals of the harmonics
 * over a half sphere c0 = sqrt(pi), cz = sqrt(3 pi) / 2, all others 0. On the rim facets have the
 * mean of both halves: of half a cell, and as much for the place of the probe and for texels, of a
 * rim of 2 pi, times the largest value of a harmonic, which is below 0.7.
 */
static void half_furnace(void **state)
{
	(void)state;
	scene s = make_sphere(0.0f);
	for (size_t i = 0; i < s.count; i++)
		if (s.position[3 * i + 2] > 0.0)
			for (size_t c = 0; c < 3; c++)
				s.emission[3 * i + c] = 1.0f;
	s.emits = true;
	const gw_bake_options bake = bake_options(0);
	gw_probes_options options = gw_probes_options_default();
	options.moves = 0;
	made m = make_good(&s, &bake, NULL, &options);
	const gw_probe *probe = m.probes->probe;
	double off =
		fmax(fabs(probe->position[0]), fmax(fabs(probe->position[1]), fabs(probe->position[2])));
	double allowed = 0.7 * 2.0 * SCENE_PI * (m.leaf_size + off + 1.0 / 64.0);
	assert_int_equal(m.probes->count, 1);
	assert_true(allowed < 0.3);
	for (size_t h = 0; h < GW_PROBE_HARMONICS; h++) {
		double expected = h == 0 ? sqrt(SCENE_PI) : h == 2 ? sqrt(3.0 * SCENE_PI) / 2.0 : 0.0;
		assert_near("harmonic", (double)probe->harmonic[h][0], expected, allowed);
	}
	gw_probes_destroy(&m.probes);
	scene_clear(&s);
}

/* Over a black floor all that is above its horizon is sky, exactly; and nothing is met there. */
static void sky(void **state)
{
	(void)state;
	scene s = { 0 };
	scene_add_patch(&s,
					&(scene_patch){ (double[3]){ -1, -1, 0 }, (double[3]){ 2, 0, 0 },
									(double[3]){ 0, 2, 0 }, 64, 64 },
					0.0f);
	const gw_light even = { .type = GW_LIGHT_ENVIRONMENT, .radiance = { 3, 2, 1 } };
	const gw_bake_options bake = bake_options(1);
	gw_probes_options options = gw_probes_options_default();
	options.margin = 1.0f;
	made m = make_good(&s, &bake, &even, &options);
	const gw_probes *p = m.probes;
	const size_t texels = (size_t)p->size * p->size;
	for (size_t i = 0; i < p->count * texels; i++) {
		double d[3];
		direction_of(p->size, i % texels, d);
		bool open = p->distance[i] >= GW_PROBE_FAR;
		assert_true(open || d[2] < 0.0);
		for (size_t c = 0; c < 3; c++)
			assert_true(p->radiance[3 * i + c] == (open ? even.radiance[c] : 0.0f));
	}
	for (size_t k = 0; k < p->count; k++)
		assert_true(p->probe[k].position[2] > 0.0 && p->probe[k].position[2] <= 1.0 + 1e-6);
	gw_probes_destroy(&m.probes);
	/* Without a margin there is no room over it. */
	options.margin = 0.0f;
	m = make_probes(&s, &bake, &even, &options);
	assert_int_equal(m.status, GW_ERROR_DATA);
	assert_non_null(strstr(m.error.text, "no free space"));
	assert_null(m.probes);
	scene_clear(&s);
}

/* The solid angle and the form factor (its cosines over pi) of a floor's quarter, from x = y = 0 to
 * a and b, seen from a height h over its corner (Howell's catalogue B-4). */
static void add_quarter(double a, double b, double h, double *angle, double *factor)
{
	const double s = fabs(a) / h, t = fabs(b) / h, u = sqrt(1.0 + s * s), v = sqrt(1.0 + t * t);
	const double sign = a * b < 0.0 ? -1.0 : 1.0;
	*angle += sign * atan(s * t / sqrt(1.0 + s * s + t * t));
	*factor += sign * (s / u * atan(t / u) + t / v * atan(s / v)) / (2.0 * SCENE_PI);
}

/*
 * Under an even sky L over a black floor, which a probe sees under the solid angle A with the form
 * factor F: the first harmonic is (4 pi - A) / sqrt(4 pi) L and that of z, whose integral over the
 * sphere is 0 and over the floor -pi F, pi F sqrt(3 / 4 pi) L. Where the floor ends is known to a
 * leaf, seen from a probe over it at no less than its height, and to a texel; its rim, that of a
 * convex polygon, is no longer than 2 pi.
 */
static void half_sky(void **state)
{
	(void)state;
	scene s = { 0 };
	const double corner[3] = { -2, -2, 0 }, x[3] = { 4, 0, 0 }, y[3] = { 0, 4, 0 };
	scene_add_patch(&s, &(scene_patch){ corner, x, y, 128, 128 }, 0.0f);
	const gw_light even = { .type = GW_LIGHT_ENVIRONMENT, .radiance = { 1, 2, 4 } };
	const gw_bake_options bake = bake_options(1);
	gw_probes_options options = gw_probes_options_default();
	options.margin = 0.5f;
	made m = make_good(&s, &bake, &even, &options);
	for (size_t k = 0; k < m.probes->count; k++) {
		const gw_probe *probe = &m.probes->probe[k];
		const double *at = probe->position;
		double angle = 0.0, factor = 0.0;
		for (int i = 0; i < 4; i++)
			add_quarter(i & 1 ? 2.0 - at[0] : 2.0 + at[0], i & 2 ? 2.0 - at[1] : 2.0 + at[1], at[2],
						&angle, &factor);
		const double rim = 2.0 * SCENE_PI * (m.leaf_size / at[2] + 1.0 / 64.0);
		const double first = (4.0 * SCENE_PI - angle) / sqrt(4.0 * SCENE_PI);
		const double up = SCENE_PI * factor * sqrt(3.0 / (4.0 * SCENE_PI));
		assert_true(rim < 1.0 && angle > SCENE_PI);
		for (size_t c = 0; c < 3; c++) {
			const double l = (double)even.radiance[c];
			assert_near("first harmonic", (double)probe->harmonic[0][c] / l, first, 0.2821 * rim);
			assert_near("harmonic of z", (double)probe->harmonic[2][c] / l, up, 0.4887 * rim);
		}
	}
	gw_probes_destroy(&m.probes);
	scene_clear(&s);
}

/* In a closed box nothing is farther off than its corner, and all that is seen sends out light. */
static void assert_closed(const gw_probes *p, double leaf_size)
{
	const size_t texels = p->count * p->size * p->size;
	for (size_t i = 0; i < texels; i++) {
		assert_true((double)p->distance[i] <= sqrt(3.0) + leaf_size);
		assert_true(p->radiance[3 * i] > 0.0f);
	}
}

/* From any place in a box all of it is seen: one probe does. Two boxes beside each other, each
 * shut, take one each, and one sees half of them. Facets at edges, a leaf wide, may hide behind
 * others: of a box of 1 m with 32 points a metre less than 2 % of the area. */
static void boxes(void **state)
{
	(void)state;
	scene s = { 0 };
	scene_add_box(&s, (double[3]){ 0, 0, 0 }, (double[3]){ 1, 1, 1 }, 32, 0.5f);
	const gw_light lamp = scene_point_light(0.5, 0.5, 0.7, 1.0f);
	const gw_bake_options bake = bake_options(2);
	gw_probes_options options = gw_probes_options_default();
	options.size = 16;
	made m = make_good(&s, &bake, &lamp, &options);
	assert_int_equal(m.probes->count, 1);
	assert_true(m.probes->seen > 0.98 && m.probes->seeable > 0.98);
	assert_closed(m.probes, m.leaf_size);
	gw_probes_destroy(&m.probes);
	scene_add_box(&s, (double[3]){ 1.5, 0, 0 }, (double[3]){ 1, 1, 1 }, 32, 0.5f);
	m = make_good(&s, &bake, &lamp, &options);
	assert_int_equal(m.probes->count, 2);
	assert_true(m.probes->seen > 0.98);
	gw_probes_destroy(&m.probes);
	options.count = 1;
	m = make_good(&s, &bake, &lamp, &options);
	assert_int_equal(m.probes->count, 1);
	assert_near("seen by one", m.probes->seen, 0.5, 0.01);
	gw_probes_destroy(&m.probes);
	scene_clear(&s);
}

/* A block that stands on the floor of a room, 1 mm over it, as in models of rooms. The floor goes
 * on below, and what is in front of it there is within the block; what is in front of the block's
 * bottom is under the floor. Neither is free. */
static void none_within_a_block(void **state)
{
	(void)state;
	scene s = { 0 };
	scene_add_box(&s, (double[3]){ 0, 0, 0 }, (double[3]){ 1, 1, 1 }, 32, 0.5f);
	const size_t room = 3 * s.count;
	scene_add_box(&s, (double[3]){ 0.3, 0.3, 0.001 }, (double[3]){ 0.4, 0.4, 0.4 }, 32, 0.5f);
	for (size_t i = room; i < 3 * s.count; i++)
		s.normal[i] = -s.normal[i];
	const gw_light lamp = scene_point_light(0.5, 0.5, 0.7, 1.0f);
	gw_bake_options bake = bake_options(1);
	gw_probes_options options = gw_probes_options_default();
	options.size = 16;
	options.margin = 0.3f;
	bake.normals = GW_NORMALS_GIVEN;
	made m = make_good(&s, &bake, &lamp, &options);
	for (size_t k = 0; k < m.probes->count; k++) {
		const double *at = m.probes->probe[k].position;
		bool in_room = true, in_block = at[2] < 0.4;
		for (int c = 0; c < 3; c++)
			in_room = in_room && at[c] > 0.0 && at[c] < 1.0;
		for (int c = 0; c < 2; c++)
			in_block = in_block && at[c] > 0.3 && at[c] < 0.7;
		if (!in_room || in_block)
			fail_msg("probe %zu at %g, %g, %g is in no free space", k, at[0], at[1], at[2]);
	}
	assert_true(m.probes->seen > 0.9);
	gw_probes_destroy(&m.probes);
	scene_clear(&s);
}

/* How far it is from a place in a box of side 1 to its wall. */
static double way_out(const double from[3], const float way[3])
{
	double least = 10.0;
	for (int k = 0; k < 3; k++)
		if (way[k] != 0.0f)
			least = fmin(least, ((way[k] > 0.0f ? 1.0 : 0.0) - from[k]) / (double)way[k]);
	return least;
}

/* What is seen of a box by the maps of a probe, with smaller maps and without. */
typedef struct looks {
	size_t rays, near, same; /* near: met within a leaf of the wall; same: by both ways */
	double steps[2];
} looks;

static void look_around(const gw_probes *p, double leaf_size, looks *sum)
{
	uint32_t state = 12345;
	for (sum->rays = 0; sum->rays < 4000; sum->rays++) {
		double from[3], length = 0.0;
		float way[3];
		for (int k = 0; k < 3; k++) {
			state = state * 1664525u + 1013904223u;
			from[k] = 0.02 + 0.96 * (state >> 8) / 16777216.0;
			state = state * 1664525u + 1013904223u;
			way[k] = (float)(state >> 8) / 8388608.0f - 1.0f;
			length += (double)(way[k] * way[k]);
		}
		for (int k = 0; k < 3; k++)
			way[k] /= (float)sqrt(length);
		gw_probe_look look[2];
		for (int i = 0; i < 2; i++) {
			gw_probes_look(p, from, way, i == 0, &look[i]);
			sum->steps[i] += look[i].steps;
			assert_true(look[i].radiance[0] > 0.0f);
		}
		sum->near += fabs(look[0].distance - way_out(from, way)) < leaf_size;
		sum->same +=
			look[0].probe == look[1].probe && fabs(look[0].distance - look[1].distance) < 1e-6;
	}
}

/*
 * Any ray in an empty box ends at its wall, which one probe sees all of. Walls are flat, and so are
 * texels: exact but where a texel shows two walls, along edges that are 12 times less than 1.6 wide
 * (an edge from its side's middle is 2 asin(sqrt(1/3)) = 1.23), by 2 texels of up to 3.5 / 64: a
 * tenth of 4 pi. Smaller maps skip what is not there, and nothing else.
 */
static void looks_in_a_box(void **state)
{
	(void)state;
	scene s = { 0 };
	scene_add_box(&s, (double[3]){ 0, 0, 0 }, (double[3]){ 1, 1, 1 }, 32, 0.5f);
	const gw_light lamp = scene_point_light(0.5, 0.5, 0.7, 1.0f);
	const gw_bake_options bake = bake_options(2);
	gw_probes_options options = gw_probes_options_default();
	looks sum = { 0 };
	made m = make_good(&s, &bake, &lamp, &options);
	look_around(m.probes, m.leaf_size, &sum);
	if (!((double)sum.near > 0.9 * (double)sum.rays && (double)sum.same > 0.999 * (double)sum.rays))
		fail_msg("of %zu rays %zu meet the wall, %zu alike", sum.rays, sum.near, sum.same);
	if (!(sum.steps[0] < sum.steps[1]))
		fail_msg("%g steps, %g without smaller maps", sum.steps[0] / 4000, sum.steps[1] / 4000);
	gw_probes_destroy(&m.probes);
	scene_clear(&s);
}

/* A regular grid: two a side of a box are eight, at the middles of its eighths.
 * The points' bounds are those of the box but for half a step of theirs, 1 / 64. */
static void grids(void **state)
{
	(void)state;
	scene s = { 0 };
	scene_add_box(&s, (double[3]){ 0, 0, 0 }, (double[3]){ 1, 1, 1 }, 32, 0.5f);
	const gw_light lamp = scene_point_light(0.5, 0.5, 0.7, 1.0f);
	const gw_bake_options bake = bake_options(1);
	gw_probes_options options = gw_probes_options_default();
	options.grid = 2;
	options.size = 8;
	made m = make_good(&s, &bake, &lamp, &options);
	assert_int_equal(m.probes->count, 8);
	for (size_t i = 0; i < 8; i++)
		for (int k = 0; k < 3; k++)
			assert_near("place", m.probes->probe[i].position[k], i >> k & 1 ? 0.75 : 0.25, 0.02);
	assert_true(m.probes->seen > 0.98 && m.probes->seeable == m.probes->seen);
	gw_probes_destroy(&m.probes);
	options.grid = GW_PROBE_GRID_MOST + 1;
	m = make_probes(&s, &bake, &lamp, &options);
	assert_int_equal(m.status, GW_ERROR_USAGE);
	scene_clear(&s);
}

static void assert_same(const gw_probes *a, const gw_probes *b)
{
	const size_t texels = a->count * a->size * a->size;
	assert_int_equal(a->count, b->count);
	assert_memory_equal(a->probe, b->probe, a->count * sizeof *a->probe);
	assert_memory_equal(a->radiance, b->radiance, 3 * texels * sizeof(float));
	assert_memory_equal(a->normal, b->normal, 3 * texels * sizeof(float));
	assert_memory_equal(a->distance, b->distance, texels * sizeof(float));
	assert_true(a->seen == b->seen && a->seeable == b->seeable);
	assert_int_equal(a->cells.count, b->cells.count);
	assert_memory_equal(a->cells.probe, b->cells.probe,
						GW_PROBES_OF_CELL * a->cells.count * sizeof *a->cells.probe);
}

static void same_every_time(void **state)
{
	(void)state;
	scene s = { 0 };
	scene_make_small_hall(&s);
	gw_bake_options bake = bake_options(2);
	gw_probes_options options = gw_probes_options_default();
	options.size = 16;
	options.moves = 20;
	bake.threads = 1;
	made one = make_good(&s, &bake, NULL, &options);
	bake.threads = 3;
	made other = make_good(&s, &bake, NULL, &options);
	assert_same(one.probes, other.probes);
	gw_probes_destroy(&one.probes);
	gw_probes_destroy(&other.probes);
	scene_clear(&s);
}

/* ----------------------------------------------------------------------------- in other light */

/* The hall in the light of a lamp, then of another one beneath a sky; and options of its probes. */
typedef struct relit {
	scene scene;
	gw_points points;
	gw_light first[2], second[2];
	gw_bake_options bake;
	gw_probes_options options;
	scene_bytes kept;
} relit;

static void set_up(relit *r)
{
	*r = (relit){ .bake = bake_options(2),
				  .options = gw_probes_options_default(),
				  .kept = { .limit = SIZE_MAX } };
	scene_make_small_hall(&r->scene);
	r->points = scene_points(&r->scene);
	r->first[0] = r->first[1] = scene_point_light(1.0, 1.0, 1.2, 2.0f);
	r->second[0] = scene_point_light(2.0, 1.5, 1.0, 3.0f);
	r->second[1] = (gw_light){ .type = GW_LIGHT_ENVIRONMENT, .radiance = { 0.2f, 0.3f, 0.5f } };
	r->options.size = 16;
	r->options.moves = 10;
}

/* Probes in the second light, of a scene that begins with bytes if there are any. */
static made make_second(const relit *r, const void *data, size_t length)
{
	const gw_transport transport = { .name = "kept", .data = data, .length = length };
	const gw_scene_description description = { &r->points, r->second, 2 };
	gw_bake_options bake = r->bake;
	gw_scene *prepared = NULL;
	gw_lighting *lighting = NULL;
	made m = { .probes = NULL };
	bake.transport = data ? &transport : NULL;
	m.status = gw_scene_create(&description, &bake, NULL, &prepared, &m.error);
	if (m.status == GW_OK)
		m.status = gw_lighting_create(prepared, r->second, 2, &lighting, &m.error);
	if (m.status == GW_OK)
		m.status = gw_probes_make(lighting, &r->options, &m.probes, &m.error);
	if (m.status == GW_OK)
		assert_int_equal(scene_has_stage(gw_scene_report(prepared), "octree"), data == NULL);
	gw_lighting_destroy(&lighting);
	gw_scene_destroy(&prepared);
	return m;
}

static void refuse_second(const relit *r, const void *data, size_t length, gw_status expected)
{
	made m = make_second(r, data, length);
	if (m.status != expected || m.probes != NULL || strstr(m.error.text, "kept") == NULL)
		fail_msg("status %d: %s", (int)m.status, m.error.text);
}

/* Probes of one scene in one light and in another one, which takes no rays; the scene is kept. */
static gw_probes *light_twice(relit *r)
{
	const gw_transport transport = { .name = "kept", .write = scene_keep_bytes, .user = &r->kept };
	const gw_scene_description description = { &r->points, r->first, 2 };
	gw_bake_options bake = r->bake;
	gw_scene *prepared = NULL;
	gw_lighting *lighting = NULL;
	gw_probes *probes = NULL;
	gw_error error;
	bake.transport = &transport;
	assert_ok(gw_scene_create(&description, &bake, NULL, &prepared, &error), &error);
	assert_ok(gw_lighting_create(prepared, r->first, 2, &lighting, &error), &error);
	assert_ok(gw_probes_make(lighting, &r->options, &probes, &error), &error);
	gw_probes_destroy(&probes);
	const size_t length = r->kept.length;
	assert_true(length > 0);
	assert_ok(gw_lighting_change(lighting, r->second, 2, &error), &error);
	assert_ok(gw_probes_make(lighting, &r->options, &probes, &error), &error);
	assert_int_equal(r->kept.length, length); /* it is written once */
	gw_lighting_destroy(&lighting);
	gw_scene_destroy(&prepared);
	return probes;
}

/* The same sums of the same terms in the same order: to the last bit. */
static void lit_again(void **state)
{
	(void)state;
	relit r;
	set_up(&r);
	gw_probes *again = light_twice(&r);
	made fresh = make_second(&r, NULL, 0);
	assert_ok(fresh.status, &fresh.error);
	made kept = make_second(&r, r.kept.data, r.kept.length);
	assert_ok(kept.status, &kept.error);
	assert_same(fresh.probes, again);
	assert_same(fresh.probes, kept.probes);
	gw_probes_destroy(&again);
	gw_probes_destroy(&fresh.probes);
	gw_probes_destroy(&kept.probes);
	free(r.kept.data);
	scene_clear(&r.scene);
}

static void other_transports_are_refused(void **state)
{
	(void)state;
	relit r;
	set_up(&r);
	gw_probes *probes = light_twice(&r);
	gw_probes_destroy(&probes);
	const gw_probes_options own = r.options;
	for (int i = 0; i < 6; i++) {
		r.options = own;
		r.options.size = i == 0 ? 32 : 16;
		r.options.count = i == 1 ? 1 : 0;
		r.options.moves = i == 2 ? 11 : 10;
		r.options.grid = i == 3 ? 2 : 0;
		r.options.margin = i == 4 ? 0.5f : 0.0f;
		r.options.seed = i == 5 ? 7 : own.seed;
		refuse_second(&r, r.kept.data, r.kept.length, GW_ERROR_USAGE);
	}
	r.options = own;
	/* Bits among what probes see, which is at the end; and an end that is missing. */
	for (size_t i = 0; i < 8; i++) {
		r.kept.data[r.kept.length - 1000 * (i + 1)] ^= (unsigned char)(1u << i);
		refuse_second(&r, r.kept.data, r.kept.length, GW_ERROR_DATA);
		r.kept.data[r.kept.length - 1000 * (i + 1)] ^= (unsigned char)(1u << i);
	}
	refuse_second(&r, r.kept.data, r.kept.length - 4096, GW_ERROR_DATA);
	/* That of another cloud. */
	r.scene.position[7] += 0x1p-20;
	refuse_second(&r, r.kept.data, r.kept.length, GW_ERROR_DATA);
	free(r.kept.data);
	scene_clear(&r.scene);
}

/* A solid cube: its surface looks out of its own bounds, so there is no place for a probe. */
static void solid(void **state)
{
	(void)state;
	scene s = { 0 };
	scene_add_box(&s, (double[3]){ 0, 0, 0 }, (double[3]){ 1, 1, 1 }, 16, 0.5f);
	for (size_t i = 0; i < 3 * s.count; i++)
		s.normal[i] = -s.normal[i];
	const gw_light even = { .type = GW_LIGHT_ENVIRONMENT, .radiance = { 1, 1, 1 } };
	gw_bake_options bake = bake_options(1);
	bake.normals = GW_NORMALS_GIVEN;
	made m = make_probes(&s, &bake, &even, NULL);
	assert_int_equal(m.status, GW_ERROR_DATA);
	assert_non_null(strstr(m.error.text, "no free space"));
	/* Nor is there over a floor in it, around which all is seen from behind. */
	scene_add_patch(&s,
					&(scene_patch){ (double[3]){ 0.2, 0.2, 0.1 }, (double[3]){ 0.2, 0, 0 },
									(double[3]){ 0, 0.2, 0 }, 8, 8 },
					0.5f);
	m = make_probes(&s, &bake, &even, NULL);
	assert_int_equal(m.status, GW_ERROR_DATA);
	assert_non_null(strstr(m.error.text, "look at the normals"));
	scene_clear(&s);
}

static void refused(void **state)
{
	(void)state;
	scene s = { 0 };
	scene_add_box(&s, (double[3]){ 0, 0, 0 }, (double[3]){ 1, 1, 1 }, 8, 0.5f);
	const gw_light lamp = scene_point_light(0.5, 0.5, 0.7, 1.0f);
	const gw_bake_options bake = bake_options(1);
	for (int i = 0; i < 5; i++) {
		gw_probes_options options = gw_probes_options_default();
		options.size = i == 0 ? 0 : i == 1 ? 48 : i == 2 ? 2048 : 64;
		options.margin = i == 3 ? -1.0f : i == 4 ? NAN : 0.0f;
		made m = make_probes(&s, &bake, &lamp, &options);
		assert_int_equal(m.status, GW_ERROR_USAGE);
		assert_null(m.probes);
	}
	scene_clear(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(furnace),
		cmocka_unit_test(white_furnace),
		cmocka_unit_test(half_furnace),
		cmocka_unit_test(sky),
		cmocka_unit_test(half_sky),
		cmocka_unit_test(boxes),
		cmocka_unit_test(none_within_a_block),
		cmocka_unit_test(grids),
		cmocka_unit_test(looks_in_a_box),
		cmocka_unit_test(same_every_time),
		cmocka_unit_test(solid),
		cmocka_unit_test(refused),
		cmocka_unit_test(lit_again),
		cmocka_unit_test(other_transports_are_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

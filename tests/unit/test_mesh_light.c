/* Meshes in pictures: triangles cut into smaller ones, and these in the light of the points on
 * them. */
#include "glowworm_picture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const float up[9] = { 0, 0, 1, 0, 0, 1, 0, 0, 1 };

/* None yet, of that size, within 10 m of the middle. */
static gw_tessellation cut_into(float longest)
{
	return (gw_tessellation){
		.longest = longest, .minimum = { -10, -10, -10 }, .maximum = { 10, 10, 10 }, .most = 100000
	};
}

static float length_of_edge(const gw_tessellation *p, size_t triangle, size_t edge)
{
	const float *a = p->position + 9 * triangle + 3 * edge;
	const float *b = p->position + 9 * triangle + 3 * ((edge + 1) % 3);
	return hypotf(hypotf(b[0] - a[0], b[1] - a[1]), b[2] - a[2]);
}

static double area_of(const gw_tessellation *p)
{
	double sum = 0;
	for (size_t i = 0; i < p->count; i++) {
		const float *c = p->position + 9 * i;
		sum += 0.5 * fabs((double)((c[3] - c[0]) * (c[7] - c[1]) - (c[4] - c[1]) * (c[6] - c[0])));
	}
	return sum;
}

/* A triangle at height 0; at has x and y of its corners. */
static void add(gw_tessellation *p, const float at[6])
{
	const float corner[9] = { at[0], at[1], 0, at[2], at[3], 0, at[4], at[5], 0 };
	assert_int_equal(gw_tessellation_add(p, corner, up, NULL), GW_OK);
}

/* No edge is longer than asked, and no area is lost but by rounding: 24 bits, over a thousand
 * triangles that halve ten times. */
static void triangles_are_small_and_whole(void **state)
{
	(void)state;
	gw_tessellation p = cut_into(0.1f);
	add(&p, (float[]){ 0, 0, 2, 0, 0, 1 });
	add(&p, (float[]){ 0, 0, 3, 0, 0, 1e-4f }); /* a sliver costs its length, not its square */
	assert_true(fabs(area_of(&p) - 1 - 1.5e-4) < 1e-5);
	for (size_t i = 0; i < p.count; i++)
		for (size_t e = 0; e < 3; e++)
			assert_true(length_of_edge(&p, i, e) <= 0.1f);
	size_t all = p.count;
	gw_tessellation_clear(&p);
	p = cut_into(0.1f);
	add(&p, (float[]){ 0, 0, 3, 0, 0, 1e-4f });

	assert_true(p.count <= 2 * 4 * 32 &&
				all > p.count); /* 3 / 32 < 0.1; four a part of each side */
	gw_tessellation_clear(&p);
}

/* Of a triangle that is larger than the world only what is within the bounds is cut: a square of 20
 * m and triangles that stick out of it, none of which costs more than its halvings. And never more
 * than the most. */
static void far_triangles_cost_nothing(void **state)
{
	(void)state;
	gw_tessellation p = cut_into(1);
	add(&p, (float[]){ -1e30f, -1e30f, 1e30f, -1e30f, 0, 1e30f });
	assert_true(p.count > 400 && p.count < 8 * 400);
	gw_tessellation_clear(&p);
	p = cut_into(1);
	p.most = 100;
	add(&p, (float[]){ -1e30f, -1e30f, 1e30f, -1e30f, 0, 1e30f });
	assert_int_equal(p.count, 100);
	gw_tessellation_clear(&p);
}

/* Corners of the triangles on the line x = y, one bit for each of 64ths. */
static uint64_t on_diagonal(const gw_tessellation *p)
{
	uint64_t bits = 0;
	for (size_t i = 0; i < 3 * p->count; i++) {
		const float *c = p->position + 3 * i;
		if (c[0] == c[1])
			bits |= (uint64_t)1 << (int)(c[0] * 63.0f);
	}
	return bits;
}

/* The two halves of a rectangle are cut at the same places of their common edge. */
static void neighbours_share_corners(void **state)
{
	(void)state;
	gw_tessellation a = cut_into(0.15f), b = cut_into(0.15f);
	add(&a, (float[]){ 0, 0, 1, 0, 1, 1 });
	add(&b, (float[]){ 0, 0, 1, 1, -3, 2 });
	assert_true(on_diagonal(&a) == on_diagonal(&b));
	assert_int_equal(__builtin_popcountll(on_diagonal(&a)), 17); /* 1.41 / 16 < 0.15 < 1.41 / 8 */
	gw_tessellation_clear(&a);
	gw_tessellation_clear(&b);
}

#define SIDE 40u
#define POINTS (SIDE * SIDE)

/* Points 0.025 apart on the square from 0 to 1 at z = 0, facing up, and as many at z = -0.001 that
 * face down, as of a thin plate; and some above it. One channel: x on the upper side, 9 below. */
typedef struct plate {
	float position[3 * (2 * POINTS + SIDE)], normal[3 * (2 * POINTS + SIDE)];
	float radius[2 * POINTS + SIDE], channel[2 * POINTS + SIDE];
	uint8_t on_mesh[2 * POINTS + SIDE];
	gw_surfels surfels;
} plate;

static plate *make_plate(void)
{
	plate *p = calloc(1, sizeof *p);
	assert_non_null(p);
	for (size_t i = 0; i < 2 * POINTS + SIDE; i++) {
		bool below = i >= POINTS && i < 2 * POINTS, above = i >= 2 * POINTS;
		p->position[3 * i] = ((float)(i % SIDE) + 0.5f) / SIDE;
		p->position[3 * i + 1] = ((float)(i / SIDE % SIDE) + 0.5f) / SIDE;
		p->position[3 * i + 2] = below ? -0.001f : above ? 0.03f : 0.0f;
		p->normal[3 * i + 2] = below ? -1 : 1;
		p->radius[i] = 0.04f;
		p->channel[i] = below ? 9 : above ? 5 : p->position[3 * i];
	}
	p->surfels = (gw_surfels){ .count = 2 * POINTS + SIDE,
							   .position = p->position,
							   .normal = p->normal,
							   .radius = p->radius,
							   .spacing = 1.0f / SIDE };
	return p;
}

/* Corners take the light of their side: x, to within half the reach of eight points, 1.6 spacings,
 * which is how far their middle can be on one side at an edge. What is no part of the mesh is not
 * on it, and a triangle without points is left out. */
static void corners_take_the_light_of_their_side(void **state)
{
	(void)state;
	plate *p = make_plate();
	for (uint32_t threads = 1; threads <= 2; threads++) {
		gw_tessellation m = cut_into(1.5f / SIDE);
		add(&m, (float[]){ 0, 0, 1, 0, 1, 1 });
		add(&m, (float[]){ 0, 0, 1, 1, 0, 1 });
		size_t count = m.count;
		add(&m, (float[]){ 5, 5, 6, 5, 6, 6 });
		assert_true(m.count > count);
		assert_int_equal(gw_mesh_light(&m, &p->surfels, (gw_surfel_channels){ p->channel, 1 },
									   threads, p->on_mesh, NULL),
						 GW_OK);
		assert_int_equal(m.count, count);
		for (size_t i = 0; i < 3 * m.count; i++)
			assert_true(fabsf(m.channel[i] - m.position[3 * i]) <= 1.6f / SIDE);
		for (size_t i = 0; i < 2 * POINTS + SIDE; i++)
			assert_int_equal(p->on_mesh[i], i < 2 * POINTS);
		gw_tessellation_clear(&m);
	}
	free(p);
}

/* Without points on it nothing of a mesh is left; without a mesh there are no points on it. */
static void nothing_is_lit_by_nothing(void **state)
{
	(void)state;
	plate *p = make_plate();
	gw_tessellation m = cut_into(0.1f);
	memset(p->on_mesh, 1, sizeof p->on_mesh);
	assert_int_equal(
		gw_mesh_light(&m, &p->surfels, (gw_surfel_channels){ p->channel, 1 }, 1, p->on_mesh, NULL),
		GW_OK);
	assert_int_equal(p->on_mesh[0], 0);
	add(&m, (float[]){ 5, 5, 6, 5, 6, 6 });
	assert_int_equal(
		gw_mesh_light(&m, &p->surfels, (gw_surfel_channels){ p->channel, 1 }, 1, p->on_mesh, NULL),
		GW_OK);
	assert_int_equal(m.count, 0);
	gw_tessellation_clear(&m);
	free(p);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(triangles_are_small_and_whole),
		cmocka_unit_test(far_triangles_cost_nothing),
		cmocka_unit_test(neighbours_share_corners),
		cmocka_unit_test(corners_take_the_light_of_their_side),
		cmocka_unit_test(nothing_is_lit_by_nothing),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

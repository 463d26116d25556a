/* Rays against a tree of discs: brute force over all discs in double precision, a ball of bent
 * discs that lets nothing out, the surface that a ray leaves, and trees that are damaged. */
#include "normals/disc_tree.h"
#include "octree/trace_constants.h"
#include "light/transport_layout.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define DISCS 700u
#define RAYS 4000u

static uint64_t random_state = 12;

/* Random in [0, 1), the same numbers every run (splitmix64). */
static float uniform(void)
{
	uint64_t z = random_state += 0x9e3779b97f4a7c15u;
	z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
	z = (z ^ z >> 27) * 0x94d049bb133111ebu;
	return (float)((z ^ z >> 31) >> 40) * 0x1p-24f;
}

static gw_vec3 direction(void)
{
	float z = 2.0f * uniform() - 1.0f, turn = 6.2831853f * uniform(), r = sqrtf(1 - z * z);
	return (gw_vec3){ r * cosf(turn), r * sinf(turn), z };
}

static gw_vec3 place_within(float size)
{
	return (gw_vec3){ size * uniform(), size * uniform(), size * uniform() };
}

/* Flat discs of radii from 0.001 to 1 anywhere in a box 10 wide, a third of them cut. */
static void scatter(gw_disc *disc)
{
	for (uint32_t i = 0; i < DISCS; i++) {
		disc[i] = (gw_disc){ .place = place_within(10.0f),
							 .normal = direction(),
							 .radius = powf(10.0f, -3.0f * uniform()),
							 .facet = 3 * i };
		if (i % 3 == 0) {
			float turn = 6.2831853f * uniform();
			disc[i].clip[0] = cosf(turn);
			disc[i].clip[1] = sinf(turn);
			disc[i].clip[2] = disc[i].radius * uniform();
		}
	}
}

/* Distance to where a ray meets a flat disc, or infinity, and from where on finer surface does not
 * matter, by which discs are compared; `edge` becomes true where that is so near
 * to an edge that rounding decides. */
static double meet(const gw_disc *d, const gw_disc_ray *ray, double *yields, bool *edge)
{
	float t[3], b[3], n[3] = { d->normal.x, d->normal.y, d->normal.z };
	double w[3] = { (double)ray->direction.x, (double)ray->direction.y, (double)ray->direction.z };
	double off[3] = { (double)ray->origin.x - (double)d->place.x,
					  (double)ray->origin.y - (double)d->place.y,
					  (double)ray->origin.z - (double)d->place.z };
	double approach = 0, height = 0, x = 0, y = 0, radius = (double)d->radius;
	gw_tangent_frame(n, t, b);
	for (int k = 0; k < 3; k++) {
		approach += w[k] * (double)n[k];
		height += off[k] * (double)n[k];
	}
	double distance = -height / approach;
	for (int k = 0; k < 3; k++) {
		x += (off[k] + distance * w[k]) * (double)t[k];
		y += (off[k] + distance * w[k]) * (double)b[k];
	}
	double over = (double)d->clip[0] * x + (double)d->clip[1] * y - (double)d->clip[2] -
				  (double)GW_CUT_OVERLAP * radius;
	double beyond = fmax(hypot(x, y) - radius, over);
	double doubt = 1e-5 * (radius + 1) / fmax(fabs(approach), 1e-3);
	if (distance < 0 || beyond > doubt || (!ray->both_sides && approach > 0))
		return INFINITY;
	*edge |= fabs(beyond) <= doubt || distance < doubt;
	double dish = (double)GW_DISC_DISH * (x * x + y * y) / radius + (double)GW_DISC_YIELD * radius;
	*yields = distance + dish / fmax(fabs(approach), (double)GW_DISC_GRAZING);
	return distance;
}

static void test_brute_force(void **state)
{
	static gw_disc disc[DISCS];
	gw_disc_tree tree;
	uint32_t hits = 0, compared = 0;
	(void)state;
	scatter(disc);
	assert_int_equal(gw_disc_tree_build(disc, DISCS, &tree, NULL), GW_OK);
	assert_true(tree.nodes < DISCS && tree.nodes >= DISCS / 3);
	assert_true(gw_disc_tree_fits(tree.word, DISCS, tree.nodes, 3 * DISCS));
	for (uint32_t r = 0; r < RAYS; r++) {
		gw_disc_ray ray = { .origin = place_within(10.0f),
							.direction = direction(),
							.t_max = 1e9f,
							.both_sides = r % 2 };
		/* A surface far below: nothing is one of it but by being near and seen from behind. */
		ray.facing = ray.direction;
		ray.foot = gw_minus(ray.origin, gw_times(ray.direction, 100.0f));
		double nearest = INFINITY, least = INFINITY, yields;
		uint32_t which = GW_NONE;
		bool edge = false;
		for (uint32_t i = 0; i < DISCS; i++) {
			double t = meet(disc + i, &ray, &yields, &edge);
			edge |= isfinite(t) && t < 1.3 * (double)disc[i].radius;
			if (!isfinite(t) || yields >= least)
				continue;
			which = i;
			nearest = t;
			least = yields;
		}
		if (edge)
			continue;
		gw_disc_hit hit = gw_disc_tree_trace(&tree, &ray);
		compared++;
		hits += which != GW_NONE;
		assert_int_equal(hit.disc, which);
		assert_int_equal(hit.facet, which == GW_NONE ? GW_NONE : 3 * which);
		if (which != GW_NONE)
			assert_true(fabs((double)hit.t - nearest) < 1e-4 * (1 + nearest));
	}
	assert_true(compared > RAYS / 2 && hits > RAYS / 10);
	gw_disc_tree_clear(&tree);
	assert_null(tree.word);
}

/* Discs on a ball, bent as it is, that face its middle. */
static void make_ball(gw_disc *disc, uint32_t count, float size, gw_vec3 middle)
{
	for (uint32_t i = 0; i < count; i++) {
		float z = 1.0f - 2.0f * ((float)i + 0.5f) / (float)count, r = sqrtf(1 - z * z);
		float turn = 2.3999632f * (float)i;
		gw_vec3 out = { r * cosf(turn), r * sinf(turn), z };
		disc[i] = (gw_disc){ .place = gw_plus(middle, gw_times(out, size)),
							 .normal = gw_times(out, -1.0f),
							 .radius = size * sqrtf(32.0f / (float)count),
							 .bend = { 1 / size, 0, 1 / size },
							 .facet = i };
	}
}

/* Bent discs follow the ball: rays from its surface inwards end at its other side, where a circle
 * says, but for what a parabola is off it; none leaves. Thousands of its radii from 0, too. */
static void test_closed_ball(void **state)
{
	enum { COUNT = 400 };
	static gw_disc disc[COUNT];
	(void)state;
	for (int far = 0; far < 2; far++) {
		gw_disc_tree tree;
		gw_vec3 middle = { far ? 2e4f : 0.0f, far ? 1e4f : 0.0f, 0 };
		make_ball(disc, COUNT, 3.0f, middle);
		assert_int_equal(gw_disc_tree_build(disc, COUNT, &tree, NULL), GW_OK);
		for (uint32_t r = 0; r < RAYS; r++) {
			const gw_disc *from = disc + r % COUNT;
			gw_vec3 w = direction();
			float cosine = gw_dot(w, from->normal);
			w = gw_times(w, cosine < 0 ? -1.0f : 1.0f);
			cosine = fabsf(cosine);
			gw_disc_ray ray = { .origin = from->place,
								.direction = w,
								.facing = from->normal,
								.foot = from->place,
								.t_max = 1e9f };
			gw_disc_hit hit = gw_disc_tree_trace(&tree, &ray);
			if (cosine < 0.05f)
				continue; /* ends on the surface that it leaves */
			assert_int_not_equal(hit.disc, GW_NONE);
			assert_true(fabsf(hit.t - 6.0f * cosine) < 0.1f);
			assert_true(hit.nearest_back_face == hit.t || hit.nearest_back_face >= 1e9f);
		}
		gw_disc_tree_clear(&tree);
	}
}

/* A plane of discs, some of them tilted as by noise, does not shade itself; a wall on it does. */
static void test_own_surface(void **state)
{
	enum { SIDE = 12 };
	static gw_disc disc[SIDE * SIDE + 1];
	gw_disc_tree tree;
	(void)state;
	for (uint32_t i = 0; i < SIDE * SIDE; i++) {
		gw_vec3 tilted = { 0.1f * (uniform() - 0.5f), 0.1f * (uniform() - 0.5f), 1 };
		disc[i] = (gw_disc){ .place = { (float)(i % SIDE), (float)(i / SIDE), 0 },
							 .normal = gw_unit(tilted),
							 .radius = 1.6f,
							 .facet = i };
	}
	disc[SIDE * SIDE] = (gw_disc){
		.place = { 6.7f, 6, 0.5f }, .normal = { -1, 0, 0 }, .radius = 1.6f, .facet = SIDE * SIDE
	};
	assert_int_equal(gw_disc_tree_build(disc, SIDE * SIDE + 1, &tree, NULL), GW_OK);
	gw_disc_ray ray = { .origin = disc[6 * SIDE + 6].place,
						.direction = gw_unit((gw_vec3){ -1, 0, 0.2f }),
						.facing = { 0, 0, 1 },
						.t_max = 1e9f,
						.both_sides = true };
	ray.foot = ray.origin;
	assert_int_equal(gw_disc_tree_trace(&tree, &ray).disc, GW_NONE);
	ray.direction.x = -ray.direction.x;
	assert_int_equal(gw_disc_tree_trace(&tree, &ray).disc, SIDE * SIDE);
	gw_disc_tree_clear(&tree);
}

/* None, one, and many at one place: the tree is made all the same. */
static void test_degenerate(void **state)
{
	gw_disc disc[50] = { 0 };
	gw_disc_tree tree;
	(void)state;
	assert_int_equal(gw_disc_tree_build(disc, 0, &tree, NULL), GW_OK);
	assert_int_equal(tree.nodes, 0);
	gw_disc_ray ray = { .origin = { 0, 0, 5 },
						.direction = { 0, 0, -1 },
						.facing = { 0, 0, -1 },
						.foot = { 0, 0, 9 },
						.t_max = 1e9f };
	assert_int_equal(gw_disc_tree_trace(&tree, &ray).disc, GW_NONE);
	for (uint32_t i = 0; i < 50; i++)
		disc[i] = (gw_disc){ .normal = { 0, 0, 1 }, .radius = 1 };
	for (size_t count = 1; count <= 50; count += 49) {
		assert_int_equal(gw_disc_tree_build(disc, count, &tree, NULL), GW_OK);
		assert_int_equal(gw_disc_tree_trace(&tree, &ray).disc, 0);
		ray.t_max = 4.9f;
		assert_int_equal(gw_disc_tree_trace(&tree, &ray).disc, GW_NONE);
		ray.t_max = 1e9f;
		gw_disc_tree_clear(&tree);
	}
}

/* Levels of nodes from one on; counts the discs that are reached, each of which is seen once. */
static uint32_t levels_below(const gw_disc_tree *tree, uint32_t node, uint8_t *seen,
							 uint32_t *reached)
{
	uint32_t most = 0;
	const uint32_t *child = tree->word + 4 * (1 + GW_DISC_TEXELS * (size_t)tree->discs +
											  GW_DISC_NODE_TEXELS * (size_t)node + 6);
	for (int k = 0; k < 4; k++) {
		if (child[k] == GW_NONE)
			continue;
		if (child[k] >= GW_DISC_LEAF) {
			uint32_t disc = (child[k] - GW_DISC_LEAF - 1) / GW_DISC_TEXELS;
			assert_false(seen[disc]);
			seen[disc] = 1;
			++*reached;
			continue;
		}
		uint32_t levels = levels_below(tree, child[k], seen, reached);
		most = levels > most ? levels : most;
	}
	return most + 1;
}

/* Discs each 16 times nearer to a corner than the one before, along each axis: the best cuts take
 * few of them off, as often as there are such steps, which would be more levels than a walk has
 * room for. */
static void test_uneven(void **state)
{
	enum { STEPS = 30, COUNT = STEPS * STEPS * STEPS };
	static gw_disc disc[COUNT];
	static uint8_t seen[COUNT];
	gw_disc_tree tree;
	uint32_t reached = 0;
	(void)state;
	for (int i = 0; i < COUNT; i++)
		disc[i] = (gw_disc){ .place = { ldexpf(1.0f, -4 * (i % STEPS)),
										ldexpf(1.0f, -4 * (i / STEPS % STEPS)),
										ldexpf(1.0f, -4 * (i / STEPS / STEPS)) },
							 .normal = { 0, 0, 1 },
							 .radius = ldexpf(1.0f, -4 * STEPS),
							 .facet = (uint32_t)i };
	assert_int_equal(gw_disc_tree_build(disc, COUNT, &tree, NULL), GW_OK);
	uint32_t levels = levels_below(&tree, 0, seen, &reached);
	assert_int_equal(reached, COUNT);
	assert_true(levels > 10 && 2 * levels <= GW_DISC_HALVINGS && 3 * levels <= GW_DISC_WAITING);
	gw_disc_tree_clear(&tree);
}

/* Discs that are nowhere, or without end, hide none of the others from rays. */
static void test_not_finite(void **state)
{
	enum { SIDE = 12 };
	static gw_disc disc[SIDE * SIDE];
	gw_disc_tree tree;
	(void)state;
	for (uint32_t i = 0; i < SIDE * SIDE; i++) {
		disc[i] = (gw_disc){ .place = { (float)(i % SIDE), (float)(i / SIDE), 0 },
							 .normal = { 0, 0, 1 },
							 .radius = 0.4f,
							 .facet = i };
		if (i % 7 == 3)
			disc[i].place.x = i % 2 ? NAN : -INFINITY;
		if (i % 11 == 5)
			disc[i].normal = (gw_vec3){ NAN, NAN, NAN };
	}
	assert_int_equal(gw_disc_tree_build(disc, SIDE * SIDE, &tree, NULL), GW_OK);
	assert_true(gw_disc_tree_fits(tree.word, SIDE * SIDE, tree.nodes, SIDE * SIDE));
	for (uint32_t i = 0; i < SIDE * SIDE; i++) {
		gw_disc_ray ray = { .origin = { (float)(i % SIDE), (float)(i / SIDE), 5 },
							.direction = { 0, 0, -1 },
							.facing = { 0, 0, -1 },
							.foot = { 0, 0, 9 },
							.t_max = 1e9f };
		bool there = i % 7 != 3 && i % 11 != 5;
		assert_int_equal(gw_disc_tree_trace(&tree, &ray).disc, there ? i : GW_NONE);
	}
	gw_disc_tree_clear(&tree);
}

/* Whether a tree still fits with another word in one place. */
static bool fits_with(gw_disc_tree *tree, size_t at, uint32_t value)
{
	uint32_t own = tree->word[at];
	tree->word[at] = value;
	bool fits = gw_disc_tree_fits(tree->word, tree->discs, tree->nodes, 3 * DISCS);
	tree->word[at] = own;
	return fits;
}

/* Words from a file that would lead a walk out of the tree, or back, are none. */
static void test_damaged_words(void **state)
{
	static gw_disc disc[DISCS];
	gw_disc_tree tree;
	(void)state;
	scatter(disc);
	assert_int_equal(gw_disc_tree_build(disc, DISCS, &tree, NULL), GW_OK);
	assert_true(fits_with(&tree, 0, tree.nodes));
	assert_false(fits_with(&tree, 0, tree.nodes + 1) || fits_with(&tree, 1, DISCS - 1));
	assert_false(gw_disc_tree_fits(tree.word, DISCS, 1u << 27, 3 * DISCS));
	assert_false(gw_disc_tree_fits(tree.word, 1u << 27, tree.nodes, 3 * DISCS));
	size_t last = 4 * (tree.texels - 1); /* the children of the last node: discs, or none */
	const uint32_t end = GW_DISC_LEAF | (1 + GW_DISC_TEXELS * DISCS);
	const uint32_t wrong[] = {
		0,   tree.nodes - 1, tree.nodes, GW_DISC_LEAF - 1, GW_DISC_LEAF, GW_DISC_LEAF | 2,
		end, GW_NONE - 1
	};
	for (size_t k = 0; k < 4; k++) {
		assert_true(tree.word[last + k] >= GW_DISC_LEAF);
		assert_true(fits_with(&tree, last + k, GW_NONE));
		assert_true(fits_with(&tree, last + k, end - GW_DISC_TEXELS));
		for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
			assert_false(fits_with(&tree, last + k, wrong[i]));
	}
	for (size_t i = 0; i < DISCS; i++) {
		size_t facet = 4 * (1 + GW_DISC_TEXELS * i) + 7;
		assert_true(fits_with(&tree, facet, 3 * DISCS - 1));
		assert_false(fits_with(&tree, facet, 3 * DISCS));
	}
	gw_disc_tree_clear(&tree);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_brute_force),   cmocka_unit_test(test_closed_ball),
		cmocka_unit_test(test_own_surface),   cmocka_unit_test(test_degenerate),
		cmocka_unit_test(test_uneven),        cmocka_unit_test(test_not_finite),
		cmocka_unit_test(test_damaged_words),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

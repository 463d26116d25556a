/* Where records go: every facet has one near, none are crowded, and the choice is always the same.
 * Compared with brute force over all pairs. Where more go: as many as lessen the error most. */
#include "bake/record_density.h"
#include "light/record_places.h"
#include "scenes.h"
#include "expected.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* What record_places.c promises: facets share a record when their normals' cosine is above this and
 * they are nearer to its plane than this share of the radius. */
#define LIKE_NORMAL 0.7f
#define OFF_PLANE 0.3f

/* Facets of a made-up octree: as gw_octree.facet_centre and facet_plane. */
typedef struct facets {
	size_t count;
	float *centre, *plane; /* 4 * count */
} facets;

static uint64_t random_state;

/* Random in [0, 1), the same numbers every run (splitmix64). */
static float uniform(void)
{
	uint64_t z = random_state += 0x9e3779b97f4a7c15u;
	z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
	z = (z ^ z >> 27) * 0x94d049bb133111ebu;
	return (float)((z ^ z >> 31) >> 40) * 0x1p-24f;
}

static facets make_facets(size_t count)
{
	random_state = count;
	facets l = { .count = count,
				 .centre = calloc(4 * count, sizeof(float)),
				 .plane = calloc(4 * count, sizeof(float)) };
	assert_non_null(l.centre);
	assert_non_null(l.plane);
	return l;
}

static void clear_facets(facets *l)
{
	free(l->centre);
	free(l->plane);
}

/* A ball, floors 1.5 cells apart and facets anywhere; every seventh has no area. */
static facets make_mixed(void)
{
	facets l = make_facets(6000);
	for (size_t i = 0; i < l.count; i++) {
		float *c = &l.centre[4 * i], *n = &l.plane[4 * i];
		float z = 2.0f * uniform() - 1.0f, turn = 6.2831853f * uniform();
		float direction[3] = { sqrtf(1 - z * z) * cosf(turn), sqrtf(1 - z * z) * sinf(turn), z };
		memcpy(n, direction, sizeof direction);
		for (size_t k = 0; k < 3; k++)
			c[k] = i % 3 == 0 ? 40 + 9 * direction[k] : 64 * uniform();
		if (i % 3 == 1) {
			memcpy(n, (float[3]){ 0, 0, i % 2 ? 1.0f : -1.0f }, 3 * sizeof *n);
			c[2] = 8.0f + 1.5f * (float)(i / 3 % 4);
		}
		c[3] = i % 7 == 6 ? 0.0f : 0.5f + uniform();
	}
	return l;
}

/* A floor of facets that all face up: conflicts are symmetric. */
static facets make_floor(void)
{
	facets l = make_facets(64 * 64);
	for (size_t i = 0; i < l.count; i++) {
		float c[4] = { (float)(i % 64) + uniform(), (float)(i / 64) + uniform(), 10.25f, 1.0f };
		memcpy(&l.centre[4 * i], c, sizeof c);
		l.plane[4 * i + 2] = 1.0f;
	}
	return l;
}

/* Does a record at b speak for a facet at a? */
static bool covers(const facets *l, size_t a, size_t b, float spacing, float radius)
{
	float squared = 0, alignment = 0, height = 0;
	for (size_t k = 0; k < 3; k++) {
		float off = l->centre[4 * a + k] - l->centre[4 * b + k];
		squared += off * off;
		alignment += l->plane[4 * a + k] * l->plane[4 * b + k];
		height += off * l->plane[4 * b + k];
	}
	return squared < spacing * spacing && alignment > LIKE_NORMAL &&
		   fabsf(height) < OFF_PLANE * radius;
}

static size_t place(const facets *l, float spacing, float radius, uint64_t seed, uint32_t **chosen)
{
	size_t count = 0;
	gw_error error = { 0 };
	const gw_place_task task = { .centre = l->centre,
								 .plane = l->plane,
								 .facets = l->count,
								 .spacing = spacing,
								 .radius = radius,
								 .seed = seed };
	if (gw_place_records(&task, chosen, &count, &error) != GW_OK)
		fail_msg("%s", error.text);
	for (size_t i = 0; i < count; i++) {
		assert_true((*chosen)[i] < l->count);
		assert_true(i == 0 || (*chosen)[i] > (*chosen)[i - 1]);
		assert_true(l->centre[4 * (size_t)(*chosen)[i] + 3] > 0.0f);
	}
	return count;
}

/* Facets that were put in order once are chosen as each spacing by itself chooses them. */
static void one_order_for_all_spacings(void **state)
{
	(void)state;
	const float spacings[] = { 0.8f, 2.0f, 6.0f };
	facets l = make_mixed();
	gw_dart_order order;
	gw_place_task task = { .centre = l.centre, .plane = l.plane, .facets = l.count, .seed = 9 };
	task.spacing = 1.0f;
	assert_int_equal(gw_dart_order_make(&task, &order, NULL), GW_OK);
	assert_true(order.count > 0 && order.count <= l.count);
	task.order = &order;
	for (int i = 0; i < 3; i++) {
		uint32_t *alone, *chosen;
		size_t expected = place(&l, spacings[i], 1.6f * spacings[i], 9, &alone), count;
		task.spacing = spacings[i];
		task.radius = 1.6f * spacings[i];
		assert_int_equal(gw_place_records(&task, &chosen, &count, NULL), GW_OK);
		assert_int_equal(count, expected);
		assert_memory_equal(chosen, alone, count * sizeof *chosen);
		free(alone);
		free(chosen);
	}
	gw_dart_order_clear(&order);
	clear_facets(&l);
}

/* Every facet is chosen or covered; no two chosen ones cover each other. Returns how many. */
static size_t check_places(const facets *l, float spacing, float radius, uint64_t seed)
{
	uint32_t *chosen;
	size_t count = place(l, spacing, radius, seed, &chosen), next = 0;
	for (size_t i = 0; i < l->count; i++) {
		if (next < count && chosen[next] == i) {
			for (size_t j = 0; j < next; j++)
				assert_false(covers(l, i, chosen[j], spacing, radius) &&
							 covers(l, chosen[j], i, spacing, radius));
			next++;
			continue;
		}
		bool covered = !(l->centre[4 * i + 3] > 0.0f);
		for (size_t j = 0; j < count && !covered; j++)
			covered = covers(l, i, chosen[j], spacing, radius);
		if (!covered)
			fail_msg("spacing %g: facet %zu has no record near", (double)spacing, i);
	}
	assert_int_equal(next, count);
	free(chosen);
	return count;
}

static void every_facet_has_a_record(void **state)
{
	(void)state;
	const float spacings[] = { 0.5f, 1.0f, 2.5f, 7.0f, 64.0f };
	facets l = make_mixed();
	size_t before = l.count;
	for (size_t i = 0; i < sizeof spacings / sizeof *spacings; i++) {
		size_t count = check_places(&l, spacings[i], 1.6f * spacings[i], 5);
		assert_true(count < before);
		before = count;
	}
	clear_facets(&l);
}

/*
 * On a floor, discs of half the spacing do not overlap and those of the spacing cover all facets,
 * so with a cell's diagonal more the floor: the number lies between area / (pi (s + sqrt 2)^2) and,
 * with a rim of s / 2, the densest packing of the plane.
 */
static void density_on_a_floor(void **state)
{
	(void)state;
	const double s = 4.0, side = 64.0, pi = 3.14159265358979;
	facets l = make_floor();
	double count = (double)check_places(&l, (float)s, 6.4f, 1);
	assert_true(count >= side * side / (pi * pow(s + sqrt(2.0), 2.0)));
	assert_true(count <= (side + s) * (side + s) * 2.0 / (sqrt(3.0) * s * s));
	clear_facets(&l);
}

/* Spacing 0 puts a record on every facet. */
static void one_on_every_facet(void **state)
{
	(void)state;
	facets l = make_mixed();
	uint32_t *chosen;
	size_t count = place(&l, 0.0f, 1.6f, 3, &chosen), facet_count = 0;
	for (size_t i = 0; i < l.count; i++)
		facet_count += l.centre[4 * i + 3] > 0.0f;
	assert_int_equal(count, facet_count);
	free(chosen);
	clear_facets(&l);
}

static void the_seed_decides(void **state)
{
	(void)state;
	facets l = make_mixed();
	uint32_t *a, *b, *c;
	size_t count_a = place(&l, 2.5f, 4.0f, 11, &a), count_b = place(&l, 2.5f, 4.0f, 11, &b);
	size_t count_c = place(&l, 2.5f, 4.0f, 12, &c);
	assert_int_equal(count_a, count_b);
	assert_memory_equal(a, b, count_a * sizeof *a);
	assert_true(count_a != count_c || memcmp(a, c, count_a * sizeof *a) != 0);
	free(a);
	free(b);
	free(c);
	clear_facets(&l);
}

/* Two sides of a thin wall, and the steps of a stair, need records of their own. */
static void separate_surfaces(void **state)
{
	(void)state;
	facets l = make_facets(3);
	for (size_t i = 0; i < 3; i++) {
		memcpy(&l.centre[4 * i], (float[4]){ 5, 5, 5, 1 }, 4 * sizeof(float));
		l.plane[4 * i + 2] = i == 1 ? -1.0f : 1.0f;
	}
	l.centre[4 * 2 + 2] = 5.0f + 1.01f * OFF_PLANE * 4.0f;
	assert_int_equal(check_places(&l, 2.5f, 4.0f, 0), 3);
	l.centre[4 * 2 + 2] = 5.0f + 0.99f * OFF_PLANE * 4.0f;
	assert_int_equal(check_places(&l, 2.5f, 4.0f, 0), 2);
	clear_facets(&l);
}

/* Where a facet's own spacing is smaller, further records are put until each facet has one within
 * its own; those that were there stay, in front, and elsewhere none is put. */
static void closer_in_places(void **state)
{
	(void)state;
	const float spacing = 6.0f, radius = 9.6f;
	facets l = make_mixed();
	uint32_t *first, *chosen;
	size_t kept = place(&l, spacing, radius, 5, &first), count = 0;
	float *closer = calloc(l.count, sizeof *closer);
	assert_non_null(closer);
	for (size_t i = 0; i < l.count; i++)
		closer[i] = l.centre[4 * i] < 32.0f ? 2.0f : spacing;
	gw_place_task task = { .centre = l.centre,
						   .plane = l.plane,
						   .facets = l.count,
						   .spacing = spacing,
						   .radius = radius,
						   .closer = closer,
						   .kept = first,
						   .kept_count = kept,
						   .seed = 5 };
	assert_int_equal(gw_place_records(&task, &chosen, &count, NULL), GW_OK);
	assert_true(count > kept);
	assert_memory_equal(chosen, first, kept * sizeof *first);
	for (size_t i = kept; i < count; i++) {
		assert_true(l.centre[4 * (size_t)chosen[i]] < 32.0f);
		assert_true(i == kept || chosen[i] > chosen[i - 1]);
		for (size_t j = 0; j < kept; j++)
			assert_false(covers(&l, chosen[i], first[j], 2.0f, radius / 3.0f));
	}
	for (size_t i = 0; i < l.count; i++) {
		bool covered = !(l.centre[4 * i + 3] > 0.0f);
		for (size_t j = 0; j < count && !covered; j++)
			covered = covers(&l, i, chosen[j], closer[i], radius * closer[i] / spacing);
		assert_true(covered);
	}
	free(first);
	free(chosen);
	free(closer);
	clear_facets(&l);
}

/* ------------------------------------------------------------------------------------- density */

/* What is left of the mass, by the factors. */
static double left_of(const double *mass, const float *factor, size_t count)
{
	double left = 0.0, sum = 0.0;
	for (size_t i = 0; i < count; i++) {
		left += mass[i] / (double)factor[i];
		sum += mass[i];
	}
	return left / sum;
}

/*
 * Without limits at work, factors are sqrt(m / level), which leave sqrt(level) sum sqrt(m): the
 * level follows, and with it all factors. Factors are floats, of 6e-8 each.
 */
static void factors_follow_the_root(void **state)
{
	(void)state;
	enum { COUNT = 100 };
	double mass[COUNT], roots = 0.0, sum = 0.0;
	float most[COUNT], factor[COUNT];
	for (int i = 0; i < COUNT; i++) {
		mass[i] = 1.0 + i % 10;
		most[i] = 1e6f;
		roots += sqrt(mass[i]);
		sum += mass[i];
	}
	/* The smallest factor, of mass 1, is above 1 for shares below roots / sum. */
	const gw_density_wish wish = { .share = 0.1, .most_growth = 1e6 };
	double left = gw_density_factors(mass, most, COUNT, &wish, factor);
	assert_true(fabs(left - 0.1) < 1e-6 && fabs(left_of(mass, factor, COUNT) - 0.1) < 1e-6);
	for (int i = 0; i < COUNT; i++) {
		double expected = sqrt(mass[i]) * roots / (0.1 * sum);
		assert_true(fabs((double)factor[i] / expected - 1.0) < 1e-6);
	}
}

/* No factor is below 1 or above its limit, and all together are no more than what may be. */
static void factors_keep_their_limits(void **state)
{
	(void)state;
	enum { COUNT = 1000 };
	double mass[COUNT], sum = 0.0;
	float most[COUNT], factor[COUNT];
	random_state = 1;
	for (int i = 0; i < COUNT; i++) {
		mass[i] = i % 5 == 0 ? 0.0 : pow((double)uniform(), 8.0);
		most[i] = i % 3 == 0 ? 1.0f : 4.0f;
	}
	const gw_density_wish wish = { .share = 1e-6, .most_growth = 1.5 };
	double left = gw_density_factors(mass, most, COUNT, &wish, factor);
	for (int i = 0; i < COUNT; i++) {
		assert_true(factor[i] >= 1.0f && factor[i] <= most[i]);
		assert_true(mass[i] > 0.0 || factor[i] == 1.0f);
		sum += (double)factor[i];
	}
	assert_true(sum <= 1.5 * COUNT && sum > 1.49 * COUNT);
	assert_true(left < 1.0 && fabs(left - left_of(mass, factor, COUNT)) < 1e-6);
	/* Nothing to lessen, and nothing asked for. */
	const gw_density_wish none = { .share = 1.0, .most_growth = 100.0 };
	assert_true(gw_density_factors(mass, most, COUNT, &none, factor) == 1.0);
	memset(mass, 0, sizeof mass);
	assert_true(gw_density_factors(mass, most, COUNT, &wish, factor) == 1.0);
	for (int i = 0; i < COUNT; i++)
		assert_true(factor[i] == 1.0f);
}

static void nothing_to_place(void **state)
{
	(void)state;
	facets l = make_facets(5);
	uint32_t *chosen;
	assert_int_equal(place(&l, 2.5f, 4.0f, 0, &chosen), 0);
	free(chosen);
	assert_int_equal(place(&l, 0.0f, 1.6f, 0, &chosen), 0);
	free(chosen);
	clear_facets(&l);
}

/* ------------------------------------------------------------------------------------- listing */

static uint32_t *words_of(gw_scene *s, const gw_buffer *buffer)
{
	gw_error error = { 0 };
	uint32_t *words = malloc((size_t)buffer->bytes);
	assert_non_null(words);
	assert_ok(gw_buffer_download(s->gpu, buffer, 0, words, buffer->bytes, &error), &error);
	return words;
}

/* Points anywhere in a cube that face anywhere: planes of facets lead far away from their leaves.
 */
static void make_cloud(scene *s, size_t count)
{
	*s = (scene){ .state = 1 };
	for (size_t i = 0; i < count; i++) {
		double place[3], normal[3];
		for (int k = 0; k < 3; k++)
			place[k] = 2.0 * scene_random(s);
		double z = 2.0 * scene_random(s) - 1.0, turn = 2.0 * SCENE_PI * scene_random(s);
		normal[0] = sqrt(1.0 - z * z) * cos(turn);
		normal[1] = sqrt(1.0 - z * z) * sin(turn);
		normal[2] = z;
		scene_add(s, place, normal, 0.5f);
	}
}

/* The scene of a cloud, up to its records, so many leaf cells apart. */
static void place_records(gw_scene *built, const scene *cloud, float spacing)
{
	gw_error error = { 0 };
	gw_points points = scene_points(cloud);
	gw_light light = scene_point_light(1.0, 1.0, 1.2, 2.0f);
	built->options = gw_bake_options_default();
	built->options.estimate_points = 0;
	built->options.rays = built->options.light_samples = 1; /* which go where records are */
	built->options.depth = 7;
	built->options.record_spacing = spacing;
	built->options.least_records = 0;
	assert_ok(gw_scene_open_device(built, &error), &error);
	assert_ok(gw_scene_make_surfels(built, &(gw_scene_description){ &points, &light, 1 }, &error),
			  &error);
	assert_ok(gw_scene_build_octree(built, &error), &error);
	assert_ok(gw_scene_place_records(built, &error), &error);
}

/* How many records a scene gets, and how far they are apart, leaf cells. */
static uint32_t count_wished(gw_scene *built, const gw_record_wish *wish, float *apart)
{
	gw_error error = { 0 };
	const gw_record_context on = gw_scene_context(built, &built->records);
	gw_records_destroy(built->gpu, &built->records);
	assert_ok(gw_records_place(&on, wish, &error), &error);
	*apart = built->records.spacing;
	return built->records.count;
}

static uint32_t count_records(gw_scene *built, float spacing, uint32_t least, float *apart)
{
	const gw_record_wish wish = { .spacing = spacing, .least = least };
	return count_wished(built, &wish, apart);
}

static void make_room(scene *cloud, gw_scene *built)
{
	*cloud = (scene){ 0 };
	scene_add_box(cloud, (double[3]){ 0, 0, 0 }, (double[3]){ 2, 2, 2 }, 20, 0.5f);
	place_records(built, cloud, 64.0f);
}

/* Their spacing is halved until they are so many, or 0.8 leaf cells apart;
 * where they are enough, nothing changes, nor where each facet has one. */
static void few_records_come_closer(void **state)
{
	(void)state;
	float apart;
	scene cloud;
	gw_report report = { 0 };
	gw_scene room = { .report = &report };
	make_room(&cloud, &room);
	uint32_t wide = count_records(&room, 8.0f, 0, &apart);
	assert_true(apart == 8.0f);
	assert_int_equal(count_records(&room, 8.0f, wide, &apart), wide);
	assert_true(apart == 8.0f);
	uint32_t more = count_records(&room, 8.0f, 2 * wide, &apart);
	assert_true(more >= 2 * wide && more <= 4 * wide);
	assert_true(apart == 4.0f);
	uint32_t most = count_records(&room, 8.0f, UINT32_MAX, &apart);
	assert_true(most > more && apart == GW_RECORD_SPACING_LEAST);
	assert_true(count_records(&room, 0.0f, UINT32_MAX, &apart) >= most && apart == 0.0f);
	gw_scene_close(&room);
	scene_clear(&cloud);
}

/* Where they would be too many, their spacing is doubled until they are not, or it is as wide as
 * can be; where they are not, nothing changes. */
static void many_records_stand_apart(void **state)
{
	(void)state;
	float apart;
	scene cloud;
	gw_report report = { 0 };
	gw_scene room = { .report = &report };
	make_room(&cloud, &room);
	uint32_t close = count_records(&room, 2.0f, 0, &apart);
	gw_record_wish wish = { .spacing = 2.0f, .most = close };
	assert_int_equal(count_wished(&room, &wish, &apart), close);
	assert_true(apart == 2.0f);
	wish.most = close - 1;
	uint32_t fewer = count_wished(&room, &wish, &apart);
	assert_true(apart == 4.0f);
	assert_int_equal(fewer, count_records(&room, 4.0f, 0, &apart));
	wish.most = 1; /* each of the walls has one at least */
	assert_in_range(count_wished(&room, &wish, &apart), 6, fewer - 1);
	assert_true(apart == 64.0f);
	gw_scene_close(&room);
	scene_clear(&cloud);
}

static void every_record_is_listed_once(void **state)
{
	(void)state;
	scene cloud;
	gw_report report = { 0 };
	gw_scene built = { .report = &report };
	make_cloud(&cloud, 3000);
	place_records(&built, &cloud, 0.5f);
	uint32_t count = built.records.count, blocks = built.records.block_count, listed = 0;
	uint32_t *first = words_of(&built, &built.records.block_first);
	uint32_t *record = words_of(&built, &built.records.block_record);
	bool *seen = calloc(count, sizeof *seen);
	assert_non_null(seen);
	assert_true(count > 1000);
	assert_int_equal(first[blocks], count);
	for (uint32_t i = 0; i < count; i++) {
		if (record[i] < count && !seen[record[i]]) {
			seen[record[i]] = true;
			listed++;
		}
	}
	assert_int_equal(listed, count);
	free(seen);
	free(first);
	free(record);
	gw_scene_close(&built);
	free(report.bounce);
	scene_clear(&cloud);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_facet_has_a_record),    cmocka_unit_test(density_on_a_floor),
		cmocka_unit_test(one_on_every_facet),          cmocka_unit_test(the_seed_decides),
		cmocka_unit_test(separate_surfaces),           cmocka_unit_test(nothing_to_place),
		cmocka_unit_test(one_order_for_all_spacings),  cmocka_unit_test(closer_in_places),
		cmocka_unit_test(factors_follow_the_root),     cmocka_unit_test(factors_keep_their_limits),
		cmocka_unit_test(few_records_come_closer),     cmocka_unit_test(many_records_stand_apart),
		cmocka_unit_test(every_record_is_listed_once),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

/* Objects that stand in several places: their surfels are made once, by themselves, and placed. */
#include "bake/point_subset.h"
#include "bake/scaled_scene.h"
#include "surfels/surfel_parts.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define FLOOR 400u /* 20 x 20 points */
#define BALL 300u
#define PLACES 3u
#define COUNT (FLOOR + PLACES * BALL)

/* A ball of radius 0.5 that touches a floor, and the same turned and larger, and mirrored. */
typedef struct place {
	double position[3 * COUNT];
	gw_object_instance instance[PLACES];
	gw_points points;
} place;

static const double unturned[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };
static const double larger[16] = { 0, -2, 0, 3, 2, 0, 0, 1, 0, 0, 2, 0, 0, 0, 0, 1 };
static const double mirrored[16] = { -1, 0, 0, -3, 0, 1, 0, 0, 0, 0, 1, 0.5, 0, 0, 0, 1 };

static void apply(const double m[16], const double from[3], double to[3])
{
	for (size_t row = 0; row < 3; row++)
		to[row] = m[4 * row] * from[0] + m[4 * row + 1] * from[1] + m[4 * row + 2] * from[2] +
				  m[4 * row + 3];
}

/* Points spread evenly over a ball, by the golden angle. */
static void place_on_ball(size_t i, double at[3])
{
	double z = 1 - (2 * (double)i + 1) / BALL, r = sqrt(1 - z * z), turn = 2.39996323 * (double)i;
	at[0] = 0.5 * r * cos(turn);
	at[1] = 0.5 * r * sin(turn);
	at[2] = 0.5 + 0.5 * z;
}

static void make_place(place *p)
{
	const double *matrix[PLACES] = { unturned, larger, mirrored };
	memset(p, 0, sizeof *p);
	for (size_t i = 0; i < FLOOR; i++) {
		p->position[3 * i] = 0.1 * (double)(i % 20) - 0.95;
		p->position[3 * i + 1] = 0.1 * (double)(i / 20) - 0.95;
	}
	for (size_t k = 0; k < PLACES; k++) {
		gw_object_instance *own = &p->instance[k];
		*own = (gw_object_instance){ FLOOR + k * BALL, BALL, 0, { 0 } };
		memcpy(own->matrix, matrix[k], sizeof own->matrix);
		for (size_t i = 0; i < BALL; i++) {
			double at[3];
			place_on_ball(i, at);
			apply(own->matrix, at, p->position + 3 * (own->first + i));
		}
	}
	p->points = (gw_points){
		.count = COUNT, .position = p->position, .instance = p->instance, .instance_count = PLACES
	};
}

static gw_surfels make(const gw_points *points)
{
	gw_surfels s;
	gw_error error = { 0 };
	if (gw_placed_surfels_make(points, &(gw_surfels_options){ .threads = 2 }, &s, &error) != GW_OK)
		fail_msg("%s", error.text);
	return s;
}

static void assert_near(double a, double b, double tolerance)
{
	if (!(fabs(a - b) <= tolerance))
		fail_msg("%.9g is not %.9g within %.3g", a, b, tolerance);
}

/* Positions are float32 of up to 4 m, and so are the others' numbers. */
#define ROUNDING 1e-6

static void expect_moved(const gw_surfels *s, uint32_t from, uint32_t to, const double m[16],
						 double scale)
{
	double at[3], normal[3], zero[3], moved[3];
	for (size_t k = 0; k < 3; k++) {
		at[k] = (double)s->position[3 * from + k] + s->origin[k];
		normal[k] = (double)s->normal[3 * from + k];
	}
	apply(m, at, moved);
	for (size_t k = 0; k < 3; k++)
		assert_near((double)s->position[3 * to + k] + s->origin[k], moved[k], ROUNDING);
	apply(m, (double[3]){ 0, 0, 0 }, zero);
	apply(m, normal, moved);
	for (size_t k = 0; k < 3; k++)
		assert_near((double)s->normal[3 * to + k], (moved[k] - zero[k]) / scale, ROUNDING);
	assert_near((double)s->radius[to], scale * (double)s->radius[from], ROUNDING);
	assert_near((double)s->area[to], scale * scale * (double)s->area[from], ROUNDING);
	assert_near((double)s->noise[to], scale * (double)s->noise[from], ROUNDING);
	assert_int_equal(s->two_sided[to], s->two_sided[from]);
}

/* Each place has the first one's surfels, moved; bounds hold them all. */
static void surfels_are_those_of_the_first(void **state)
{
	(void)state;
	static place p;
	make_place(&p);
	gw_surfels s = make(&p.points);
	assert_int_equal(s.count, COUNT);
	const double scale[PLACES] = { 1, 2, 1 };
	for (size_t k = 1; k < PLACES; k++)
		for (size_t i = 0; i < BALL; i++)
			expect_moved(&s, s.surfel_of_point[FLOOR + i],
						 s.surfel_of_point[p.instance[k].first + i], p.instance[k].matrix,
						 scale[k]);
	/* A ball of twice the radius has four times the area. */
	double floor = 0.0, ball = 0.0;
	for (size_t i = 0; i < FLOOR + BALL; i++)
		*(i < FLOOR ? &floor : &ball) += (double)s.area[s.surfel_of_point[i]];
	assert_near(s.given_area, floor + 6 * ball, 1e-5 * s.given_area);
	for (size_t i = 0; i < 3 * s.count; i++)
		assert_true(s.position[i] >= s.minimum[i % 3] && s.position[i] <= s.maximum[i % 3]);
	gw_surfels_clear(&s);
}

/* What touches something has the surfels that it has by itself: to the last bit of what is no
 * place, which is told from another origin. */
static void what_touches_is_left_alone(void **state)
{
	(void)state;
	static place p;
	make_place(&p);
	gw_points floor = { .count = FLOOR, .position = p.position };
	gw_points ball = { .count = BALL, .position = p.position + (size_t)3 * FLOOR };
	gw_surfels all = make(&p.points), under = make(&floor), above = make(&ball);
	for (size_t i = 0; i < FLOOR; i++) {
		uint32_t a = all.surfel_of_point[i], b = under.surfel_of_point[i];
		assert_memory_equal(&all.area[a], &under.area[b], sizeof(float));
		assert_memory_equal(all.clip + 6 * a, under.clip + 6 * b, 6 * sizeof(float));
	}
	for (size_t i = 0; i < BALL; i++) {
		uint32_t a = all.surfel_of_point[FLOOR + i], b = above.surfel_of_point[i];
		assert_near((double)all.area[a], (double)above.area[b], ROUNDING);
		/* Outward, which the floor below says nothing of. */
		const double *at = ball.position + 3 * i;
		const float *n = all.normal + 3 * a;
		assert_true((double)n[0] * at[0] + (double)n[1] * at[1] + (double)n[2] * (at[2] - 0.5) > 0);
	}
	gw_surfels_clear(&all);
	gw_surfels_clear(&under);
	gw_surfels_clear(&above);
}

static bool takes_some(const void *user, size_t point)
{
	(void)user;
	return point % 3 == 0;
}

/* Of some of the points each place has the same. */
static void some_of_the_points(void **state)
{
	(void)state;
	static place p;
	make_place(&p);
	gw_point_subset some;
	gw_error error = { 0 };
	gw_subset_choice choice = { 1, 1, takes_some, NULL, true };
	assert_int_equal(gw_point_subset_make(&p.points, &choice, &some, &error), GW_OK);
	assert_int_equal(some.points.instance_count, PLACES);
	for (size_t k = 0; k < PLACES; k++) {
		const gw_object_instance *own = &some.points.instance[k], *first = some.points.instance;
		assert_int_equal(own->count, first->count);
		for (size_t i = 0; i < own->count; i++)
			assert_int_equal(some.from[own->first + i] - p.instance[k].first,
							 some.from[first->first + i] - FLOOR);
	}
	gw_surfels s = make(&some.points);
	assert_int_equal(s.count, some.points.count);
	gw_surfels_clear(&s);
	gw_point_subset_clear(&some);
	/* Or those that are chosen by themselves, which repeat nothing. */
	choice.instances = false;
	assert_int_equal(gw_point_subset_make(&p.points, &choice, &some, &error), GW_OK);
	assert_int_equal(some.points.instance_count, 0);
	for (size_t i = 0; i < some.points.count; i++)
		assert_int_equal(some.from[i], 3 * i);
	gw_point_subset_clear(&some);
}

static void expect_refused(const place *p, gw_status status, const char *words)
{
	gw_surfels s;
	gw_error error = { 0 };
	const gw_surfels_options options = { .threads = 1 };
	assert_int_equal(gw_placed_surfels_make(&p->points, &options, &s, &error), status);
	if (!strstr(error.text, words))
		fail_msg("'%s' says nothing of '%s'", error.text, words);
	assert_int_equal(s.count, 0);
}

static void wrong_instances_are_refused(void **state)
{
	(void)state;
	static place p;
	make_place(&p);
	p.instance[0].of = 1; /* which comes after it */
	expect_refused(&p, GW_ERROR_USAGE, "instance 1 has the surfels of instance 2");
	make_place(&p);
	p.instance[2].of = 1; /* which has those of another */
	expect_refused(&p, GW_ERROR_USAGE, "instance 3 has the surfels of instance 2");
	make_place(&p);
	p.instance[2].count--;
	expect_refused(&p, GW_ERROR_USAGE, "as many points");
	make_place(&p);
	p.instance[2].first++;
	expect_refused(&p, GW_ERROR_USAGE, "instances need points of their own");
	make_place(&p);
	p.instance[1].matrix[0] = 0.3;
	expect_refused(&p, GW_ERROR_DATA, "instance 2 is stretched, skewed or flattened");
}

/* In other units places move by as many more of them. */
static void units_change_shifts(void **state)
{
	(void)state;
	static place p;
	make_place(&p);
	for (size_t i = 0; i < 3 * COUNT; i++)
		p.position[i] = ldexp(p.position[i], -60);
	for (size_t k = 0; k < PLACES; k++)
		for (size_t row = 0; row < 3; row++)
			p.instance[k].matrix[4 * row + 3] = ldexp(p.instance[k].matrix[4 * row + 3], -60);
	gw_scaled_scene scaled;
	gw_error error = { 0 };
	const gw_scene_description scene = { &p.points, NULL, 0 };
	const gw_bake_options options = gw_bake_options_default();
	assert_int_equal(gw_scaled_scene_make(&scene, &options, 0.0, &scaled, &error), GW_OK);
	assert_true(scaled.length > 0);
	gw_surfels s = make(scaled.scene.points);
	for (size_t k = 0; k < 3; k++) {
		size_t last = 3 * (COUNT - 1) + k, at = 3 * s.surfel_of_point[COUNT - 1] + k;
		double wanted = ldexp(p.position[last], scaled.length);
		assert_near((double)s.position[at] + s.origin[k], wanted,
					ldexp(ROUNDING, scaled.length - 60));
	}
	gw_surfels_clear(&s);
	gw_scaled_scene_clear(&scaled);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(surfels_are_those_of_the_first),
		cmocka_unit_test(what_touches_is_left_alone),
		cmocka_unit_test(some_of_the_points),
		cmocka_unit_test(wrong_instances_are_refused),
		cmocka_unit_test(units_change_shifts),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

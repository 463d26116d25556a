/* Presets of quality, and what a bake that has a target tries next. */
#include "refine.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

static gw_refine_state state_of(const gw_bake_options *options, double rms, double noise)
{
	return (gw_refine_state){ .options = options,
							  .error = { .points = 1000,
										 .relative_rms = rms,
										 .gathered = rms,
										 .noise = noise },
							  .round_seconds = 1.0,
							  .octree_seconds = 1.0,
							  .seconds_left = INFINITY };
}

static void presets_get_finer(void **state)
{
	(void)state;
	gw_bake_options last = GW_BAKE_OPTIONS_DEFAULT, normal = GW_BAKE_OPTIONS_DEFAULT;
	gw_bake_options_set_quality(&normal, GW_QUALITY_NORMAL);
	assert_memory_equal(&last, &normal, sizeof last);
	gw_bake_options_set_quality(&last, GW_QUALITY_DRAFT);
	for (int q = GW_QUALITY_NORMAL; q < GW_QUALITY_COUNT; q++) {
		gw_bake_options o = GW_BAKE_OPTIONS_DEFAULT;
		gw_bake_options_set_quality(&o, (gw_quality)q);
		assert_true(o.rays > last.rays && o.light_samples > last.light_samples);
		assert_true(o.cones > last.cones);
		assert_true(o.record_spacing * o.leaf_spacing < last.record_spacing * last.leaf_spacing);
		assert_true(strcmp(gw_quality_name((gw_quality)q), gw_quality_name(GW_QUALITY_DRAFT)) != 0);
		last = o;
	}
}

static void target_counts_the_spread(void **state)
{
	(void)state;
	gw_bake_options o = GW_BAKE_OPTIONS_DEFAULT;
	gw_error_estimate e = { .points = 10, .relative_rms = 0.04, .gathered = 0.04, .spread = 0.005 };
	assert_false(gw_refine_reached(&o, &e));
	o.max_error = 0.05f;
	assert_true(gw_refine_reached(&o, &e));
	e.spread = 0.011;
	assert_false(gw_refine_reached(&o, &e));
	e = (gw_error_estimate){ 0 };
	assert_false(gw_refine_reached(&o, &e));
}

static void noise_asks_for_rays(void **state)
{
	(void)state;
	char why[96];
	gw_bake_options o = GW_BAKE_OPTIONS_DEFAULT, next;
	o.max_error = 0.01f;
	gw_refine_state all_noise = state_of(&o, 0.02, 0.02);
	assert_int_equal(gw_refine_next(&all_noise, &next, why), GW_REFINE_ROUND);
	/* Half the noise takes four times the rays. */
	assert_in_range(next.rays, 4 * o.rays - 2, 4 * o.rays + 2);
	assert_int_equal(next.rays, next.light_samples);
	assert_true(next.record_spacing == o.record_spacing && next.leaf_spacing == o.leaf_spacing);
	o.method = GW_METHOD_CONES;
	assert_int_equal(gw_refine_next(&all_noise, &next, why), GW_REFINE_ROUND);
	assert_true(next.cones > o.cones && next.rays == o.rays);
}

static void the_rest_asks_for_records_then_leaves(void **state)
{
	(void)state;
	char why[96];
	gw_bake_options o = GW_BAKE_OPTIONS_DEFAULT, next;
	o.max_error = 0.01f;
	gw_refine_state no_noise = state_of(&o, 0.02, 0.0);
	assert_int_equal(gw_refine_next(&no_noise, &next, why), GW_REFINE_ROUND);
	assert_true(next.record_spacing < o.record_spacing && next.leaf_spacing == o.leaf_spacing);
	assert_int_equal(next.rays, o.rays);
	o = next;
	assert_int_equal(gw_refine_next(&no_noise, &next, why), GW_REFINE_ROUND);
	assert_true(next.record_spacing == o.record_spacing && next.leaf_spacing < o.leaf_spacing);
	/* A depth that was given is kept. */
	o.depth = 5;
	assert_int_equal(gw_refine_next(&no_noise, &next, why), GW_REFINE_ROUND);
	assert_true(next.leaf_spacing == o.leaf_spacing && next.rays > o.rays);
}

/* Round after round, settings only get finer, and it ends. */
static void it_ends(void **state)
{
	(void)state;
	for (int method = 0; method < GW_METHOD_COUNT; method++) {
		char why[96];
		gw_bake_options o = GW_BAKE_OPTIONS_DEFAULT, next;
		o.method = (gw_method)method;
		o.max_error = 1e-6f;
		gw_refine_state s = state_of(&o, 0.1, 0.07);
		int rounds = 0;
		while (gw_refine_next(&s, &next, why) == GW_REFINE_ROUND) {
			assert_true(next.rays >= o.rays && next.cones >= o.cones);
			assert_true(next.record_spacing <= o.record_spacing);
			assert_true(next.leaf_spacing <= o.leaf_spacing);
			o = next;
			assert_true(++rounds < 40);
		}
		assert_int_equal(gw_refine_next(&s, &next, why), GW_REFINE_EXHAUSTED);
		assert_true(method == GW_METHOD_RAYS ? o.rays == 4096 : o.cones == 256);
	}
}

/* A round that did not help makes the next one pull both ways, a second one ends it, unless time is
 * all that was asked for. */
static void what_does_not_help_ends(void **state)
{
	(void)state;
	char why[96];
	gw_bake_options o = GW_BAKE_OPTIONS_DEFAULT, next;
	o.max_error = 0.01f;
	gw_round round[3] = { { .error = { .relative_rms = 0.05 } },
						  { .error = { .relative_rms = 0.02 } },
						  { .error = { .relative_rms = 0.0199 } } };
	gw_refine_state s = state_of(&o, 0.02, 0.02);
	s.round = round;
	s.round_count = 2;
	assert_int_equal(gw_refine_next(&s, &next, why), GW_REFINE_ROUND);
	assert_true(next.rays > o.rays && next.record_spacing == o.record_spacing);
	s.round_count = 3;
	assert_int_equal(gw_refine_next(&s, &next, why), GW_REFINE_ROUND);
	assert_true(next.rays > o.rays && next.record_spacing < o.record_spacing);
	round[0].error.relative_rms = 0.0201;
	assert_int_equal(gw_refine_next(&s, &next, why), GW_REFINE_STALLED);
	/* The spread is part of what has to fall. */
	round[0].error.spread = 0.01;
	assert_int_equal(gw_refine_next(&s, &next, why), GW_REFINE_ROUND);
	round[0].error.spread = 0.0;
	o.max_error = 0.0f;
	assert_int_equal(gw_refine_next(&s, &next, why), GW_REFINE_ROUND);
}

static void time_makes_steps_smaller(void **state)
{
	(void)state;
	char why[96];
	gw_bake_options o = GW_BAKE_OPTIONS_DEFAULT, free_choice, bound;
	gw_refine_state s = state_of(&o, 0.02, 0.02);
	assert_int_equal(gw_refine_next(&s, &free_choice, why), GW_REFINE_ROUND);
	s.seconds_left = 2.5;
	assert_int_equal(gw_refine_next(&s, &bound, why), GW_REFINE_ROUND);
	assert_true(bound.rays > o.rays && bound.rays < free_choice.rays);
	/* One second was one round of so many rays. */
	assert_true((double)bound.rays / (double)o.rays <= s.seconds_left);
	s.seconds_left = 0.9;
	assert_int_equal(gw_refine_next(&s, &bound, why), GW_REFINE_NO_TIME);
}

/* Records are added first: so many that by the estimate the error would be a tenth under what is
 * asked, and as many as there is time for. */
static void records_come_first(void **state)
{
	(void)state;
	char why[96];
	gw_density_wish wish;
	gw_bake_options o = GW_BAKE_OPTIONS_DEFAULT;
	o.max_error = 0.02f;
	gw_refine_state s = state_of(&o, 0.06, 0.01);
	assert_int_equal(gw_refine_records(&s, &wish, why), GW_REFINE_ROUND);
	/* Squares of a third; 0.02f is 0.02 within 1e-8. */
	assert_true(fabs(wish.share - 0.9 * 0.9 / 9.0) < 1e-6);
	assert_true(wish.most_growth > 4.0 && wish.most_growth < 100.0);
	/* Cones go in small steps. */
	o.method = GW_METHOD_CONES;
	assert_int_equal(gw_refine_records(&s, &wish, why), GW_REFINE_ROUND);
	assert_true(wish.most_growth <= 2.0);
	o.method = GW_METHOD_RAYS;
	s.seconds_left = 2.5;
	assert_int_equal(gw_refine_records(&s, &wish, why), GW_REFINE_ROUND);
	assert_true(wish.most_growth == 2.5);
	s.seconds_left = 1.0;
	assert_int_equal(gw_refine_records(&s, &wish, why), GW_REFINE_NO_TIME);
	s.seconds_left = INFINITY;
	/* Nearly there: still a step that is worth its fixed costs. */
	s.error.relative_rms = s.error.gathered = 0.0201;
	assert_int_equal(gw_refine_records(&s, &wish, why), GW_REFINE_ROUND);
	assert_true(wish.share < 0.7);
	/* Settings have to help where no record can be added. */
	s.crowded = true;
	assert_int_equal(gw_refine_records(&s, &wish, why), GW_REFINE_EXHAUSTED);
	s.crowded = false;
	o.record_spacing = 0.0f;
	assert_int_equal(gw_refine_records(&s, &wish, why), GW_REFINE_EXHAUSTED);
	o.record_spacing = 2.5f;
	gw_round round[3] = { { .error = { .relative_rms = 0.0203 } },
						  { .error = { .relative_rms = 0.0202 } },
						  { .error = { .relative_rms = 0.0201 } } };
	s.round = round;
	s.round_count = 3;
	assert_int_equal(gw_refine_records(&s, &wish, why), GW_REFINE_STALLED);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(presets_get_finer),
		cmocka_unit_test(target_counts_the_spread),
		cmocka_unit_test(noise_asks_for_rays),
		cmocka_unit_test(the_rest_asks_for_records_then_leaves),
		cmocka_unit_test(it_ends),
		cmocka_unit_test(what_does_not_help_ends),
		cmocka_unit_test(time_makes_steps_smaller),
		cmocka_unit_test(records_come_first),
	};
	return cmocka_run_group_tests_name("refine", tests, NULL, NULL);
}

/* Presets of quality, what a bake that has a target tries next, and what it would cost. */
#include "bake/error_price.h"
#include "bake/refine.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

static gw_refine_state state_of(const gw_bake_options *options, double rms, double noise)
{
	return (gw_refine_state){
		.options = options,
		.error = { .points = 1000, .relative_rms = rms, .gathered = rms, .noise = noise },
		.round_seconds = 1.0,
		.octree_seconds = 1.0,
		.seconds_left = INFINITY
	};
}

/* The default, and the width of leaves that auto stands for in clouds of few points. */
static gw_bake_options settled(void)
{
	gw_bake_options options = gw_bake_options_default();
	options.leaf_spacing = GW_LEAF_SPACING;
	return options;
}

static double narrowness(const gw_bake_options *o)
{
	float leaves = o->leaf_spacing == GW_LEAF_SPACING_AUTO ? GW_LEAF_SPACING : o->leaf_spacing;
	return (double)(o->record_spacing * leaves);
}

static void presets_get_finer(void **state)
{
	(void)state;
	gw_bake_options last = gw_bake_options_default(), normal = gw_bake_options_default();
	gw_bake_options_set_quality(&normal, GW_QUALITY_NORMAL);
	assert_memory_equal(&last, &normal, sizeof last);
	gw_bake_options_set_quality(&last, GW_QUALITY_DRAFT);
	for (int q = GW_QUALITY_NORMAL; q < GW_QUALITY_COUNT; q++) {
		gw_bake_options o = gw_bake_options_default();
		gw_bake_options_set_quality(&o, (gw_quality)q);
		assert_true(o.rays > last.rays && o.light_samples > last.light_samples);
		assert_true(o.cones > last.cones);
		assert_true(narrowness(&o) < narrowness(&last));
		assert_true(o.most_records > last.most_records && o.gathered_error < last.gathered_error);
		assert_true(strcmp(gw_quality_name((gw_quality)q), gw_quality_name(GW_QUALITY_DRAFT)) != 0);
		last = o;
	}
}

static void target_counts_the_spread(void **state)
{
	(void)state;
	gw_bake_options o = gw_bake_options_default();
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
	gw_bake_options o = gw_bake_options_default(), next;
	o.max_error = 0.01f;
	gw_refine_state all_noise = state_of(&o, 0.02, 0.02);
	assert_int_equal(gw_refine_next(&all_noise, &next, why), GW_REFINE_ROUND);
	/* Half the noise takes four times the rays, and nine tenths of that is aimed at. */
	assert_in_range(next.rays, (uint32_t)(4 * o.rays / 0.81) - 2,
					(uint32_t)(4 * o.rays / 0.81) + 2);
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
	gw_bake_options o = settled(), next;
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

/* Without a target records are added for gathered light alone, until it is right enough; where
 * rays are what is wrong with it, or the last ones have not helped, none are. */
static void gathered_light_asks_for_records(void **state)
{
	(void)state;
	char why[96];
	gw_density_wish wish;
	gw_bake_options o = gw_bake_options_default();
	o.gathered_error = 0.03f;
	gw_refine_state s = state_of(&o, 0.06, 0.0);
	s.least_spacing = 2.5f;
	s.error.shadows = 0.2; /* and so all of it is 0.21 */
	s.error.relative_rms = hypot(0.06, 0.2);
	assert_int_equal(gw_refine_gathered(&s, &wish, why), GW_REFINE_ROUND);
	assert_true(wish.least == 2.5f);
	assert_true(wish.most_growth == 2.0); /* it is estimated again before they are more */
	/* Half of the error is a quarter of its square, and nine tenths of that are aimed at. */
	assert_float_equal(wish.share, 0.81 * 0.25, 1e-6);
	s.error.spread = 0.01; /* does not matter */
	assert_int_equal(gw_refine_gathered(&s, &wish, why), GW_REFINE_ROUND);
	assert_float_equal(wish.share, 0.81 * 0.25, 1e-6);
	gw_round round[2] = { { .records = 2000, .error = { .gathered = 0.061 } },
						  { .records = 4000, .error = { .gathered = 0.06 } } };
	s.round = round;
	s.round_count = 2;
	assert_int_equal(gw_refine_gathered(&s, &wish, why), GW_REFINE_STALLED);
	round[0].error.gathered = 0.07;
	assert_int_equal(gw_refine_gathered(&s, &wish, why), GW_REFINE_ROUND);
	s.crowded = true;
	assert_int_equal(gw_refine_gathered(&s, &wish, why), GW_REFINE_EXHAUSTED);
	s.crowded = false;
	s.error.noise = 0.06;
	assert_int_equal(gw_refine_gathered(&s, &wish, why), GW_REFINE_EXHAUSTED);
	s.error.noise = 0.0;
	s.error.gathered = 0.0299;
	assert_int_equal(gw_refine_gathered(&s, &wish, why), GW_REFINE_EXHAUSTED);
}

/* What is said of few records proves neither that more would be in vain nor that all is noise. */
static void few_records_prove_nothing(void **state)
{
	(void)state;
	char why[96];
	gw_density_wish wish;
	gw_bake_options o = gw_bake_options_default();
	gw_round round[2] = { { .records = 700, .error = { .gathered = 0.06 } },
						  { .records = 1300, .error = { .gathered = 0.06 } } };
	gw_refine_state s = state_of(&o, 0.06, 0.0);
	s.round = round;
	s.round_count = 2;
	assert_int_equal(gw_refine_gathered(&s, &wish, why), GW_REFINE_ROUND);
	s.error.noise = 0.05;
	assert_int_equal(gw_refine_gathered(&s, &wish, why), GW_REFINE_EXHAUSTED);
	round[0].records = 600;
	round[1].records = 1200;
	assert_int_equal(gw_refine_gathered(&s, &wish, why), GW_REFINE_ROUND);
	s.crowded = true;
	assert_int_equal(gw_refine_gathered(&s, &wish, why), GW_REFINE_EXHAUSTED);
}

/* Round after round, settings only get finer, and it ends. */
static void it_ends(void **state)
{
	(void)state;
	for (int method = 0; method < GW_METHOD_COUNT; method++) {
		char why[96];
		gw_bake_options o = gw_bake_options_default(), next;
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
	gw_bake_options o = gw_bake_options_default(), next;
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

/* What stays is more than what is asked for: gathered light becomes as right as the quality asks
 * for, while that is missed, and no more. */
static void a_target_out_of_reach_is_not_chased(void **state)
{
	(void)state;
	char why[96];
	gw_density_wish wish;
	gw_bake_options o = gw_bake_options_default(), next;
	o.max_error = 0.1f;
	gw_refine_state s = state_of(&o, 0.08, 0.02);
	s.error.shadows = 0.13;
	s.error.relative_rms = hypot(0.08, 0.13);
	assert_int_equal(gw_refine_records(&s, &wish, why), GW_REFINE_ROUND);
	/* Nine tenths of 0.03 are aimed at, of whose square noise leaves less than half; 0.03f is 0.03
	 * within 1e-9. By records of the normal quality at the closest. */
	double left = 0.5 * 0.81 * 0.03 * 0.03, rest = 0.08 * 0.08 - 0.02 * 0.02;
	assert_true(fabs(wish.share - left / rest) < 1e-6);
	assert_true(wish.least == o.record_spacing);
	assert_int_equal(gw_refine_next(&s, &next, why), GW_REFINE_OUT_OF_REACH);
	s.trial = true; /* and not even that where nobody wants light that misses it */
	assert_int_equal(gw_refine_records(&s, &wish, why), GW_REFINE_OUT_OF_REACH);
	s.trial = false;
	s.crowded = true;
	assert_int_equal(gw_refine_records(&s, &wish, why), GW_REFINE_OUT_OF_REACH);
	s.crowded = false;
	s.error.noise = 0.079; /* rays would have to help, and it is less than what stays */
	assert_int_equal(gw_refine_records(&s, &wish, why), GW_REFINE_OUT_OF_REACH);
	s.error.noise = 0.02;
	/* Far more wrong than what stays: as little is aimed at as makes 0.13 of 0.95 parts of all, by
	 * records that come closer; and once it is less than what stays, that was enough. */
	s.error.gathered = 0.2;
	s.error.relative_rms = hypot(0.2, 0.13);
	s.error.noise = 0.0;
	double hidden = 0.13 * 0.13 * (1.0 / (0.95 * 0.95) - 1.0);
	assert_int_equal(gw_refine_records(&s, &wish, why), GW_REFINE_ROUND);
	assert_true(fabs(wish.share - 0.81 * hidden / (0.2 * 0.2)) < 1e-6);
	assert_true(wish.least == s.least_spacing);
	gw_round round[2] = { { .records = 100, .error = s.error }, { .records = 400 } };
	s.error.gathered = 0.08;
	s.error.relative_rms = hypot(0.08, 0.13);
	round[1].error = s.error;
	s.round = round;
	s.round_count = 2;
	assert_int_equal(gw_refine_records(&s, &wish, why), GW_REFINE_OUT_OF_REACH);
	s.round_count = 0;
	/* What is more than stays, but noise, asks for rays. */
	s.error.gathered = 0.2;
	s.error.noise = 0.19;
	s.error.relative_rms = hypot(0.2, 0.13);
	assert_int_equal(gw_refine_records(&s, &wish, why), GW_REFINE_EXHAUSTED);
	assert_int_equal(gw_refine_next(&s, &next, why), GW_REFINE_ROUND);
	assert_true(next.rays > o.rays);
	s.error.noise = 0.02;
	s.error.gathered = 0.04; /* of 0.136, from which nothing would take more than a twentieth */
	s.error.relative_rms = hypot(0.04, 0.13);
	assert_int_equal(gw_refine_records(&s, &wish, why), GW_REFINE_OUT_OF_REACH);
	assert_int_equal(gw_refine_next(&s, &next, why), GW_REFINE_OUT_OF_REACH);
	s.error.shadows = 0.09; /* within reach, but for 0.001 */
	s.error.gathered = 0.045;
	s.error.relative_rms = hypot(0.045, 0.09);
	assert_int_equal(gw_refine_records(&s, &wish, why), GW_REFINE_ROUND);
	o.max_error = 0.0f; /* time alone */
	s.error.shadows = 0.13;
	s.error.relative_rms = 0.13;
	assert_int_equal(gw_refine_next(&s, &next, why), GW_REFINE_ROUND);
}

static void time_makes_steps_smaller(void **state)
{
	(void)state;
	char why[96];
	gw_bake_options o = settled(), free_choice, bound;
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
	gw_bake_options o = gw_bake_options_default();
	o.max_error = 0.02f;
	gw_refine_state s = state_of(&o, 0.06, 0.01);
	assert_int_equal(gw_refine_records(&s, &wish, why), GW_REFINE_ROUND);
	/* Squares, and noise stays; 0.02f is 0.02 within 1e-8. */
	double left = 0.81 * 0.02 * 0.02 - 0.01 * 0.01, rest = 0.06 * 0.06 - 0.01 * 0.01;
	assert_true(fabs(wish.share - left / rest) < 1e-6);
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
	/* After a round that added, steps are smaller. */
	gw_round added[2] = { { .records = 100, .rays = 64, .error = { .relative_rms = 0.1 } },
						  { .records = 400, .rays = 64, .error = { .relative_rms = 0.06 } } };
	s.round = added;
	s.round_count = 2;
	assert_int_equal(gw_refine_records(&s, &wish, why), GW_REFINE_ROUND);
	assert_true(wish.most_growth == 2.0);
	s.round_count = 0;
	s.round = NULL;
	/* Nearly there: still a step that is worth its fixed costs. */
	s.error.relative_rms = s.error.gathered = 0.0201;
	assert_int_equal(gw_refine_records(&s, &wish, why), GW_REFINE_ROUND);
	assert_true(wish.share < 0.8);
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

/* Noise that alone is too much asks for rays before records are many, as no record lessens it. */
static void rays_come_before_records(void **state)
{
	(void)state;
	char why[96];
	gw_density_wish wish;
	gw_bake_options o = gw_bake_options_default(), next;
	o.max_error = 0.01f;
	gw_refine_state s = state_of(&o, 0.03, 0.011);
	assert_int_equal(gw_refine_records(&s, &wish, why), GW_REFINE_EXHAUSTED);
	assert_int_equal(gw_refine_next(&s, &next, why), GW_REFINE_ROUND);
	/* The rest is large, so noise is left 0.4 of what is wanted: 1.21 / 0.4 times the rays. */
	assert_in_range(next.rays, (uint32_t)(3.025 * o.rays) - 1, (uint32_t)(3.025 * o.rays) + 2);
	assert_true(next.record_spacing == o.record_spacing);
	s.error.noise = 0.007;
	assert_int_equal(gw_refine_records(&s, &wish, why), GW_REFINE_ROUND);
	/* No more than there can be. */
	s.error.noise = 0.011;
	o.rays = 4096;
	assert_int_equal(gw_refine_records(&s, &wish, why), GW_REFINE_ROUND);
	o.rays = 64;
	o.method = GW_METHOD_CONES;
	assert_int_equal(gw_refine_records(&s, &wish, why), GW_REFINE_ROUND);
}

static gw_price_task priced(double gathered, double noise, double shadows)
{
	return (gw_price_task){ .error = { .points = 1000,
									   .relative_rms = hypot(gathered, shadows),
									   .gathered = gathered,
									   .noise = noise,
									   .shadows = shadows },
							.rays = 64,
							.records = 8000,
							.spacing = 5.0,
							.fixed_seconds = 3.0,
							.round_seconds = 0.5,
							.ray_seconds = 1e-6 };
}

/* Where all is noise of 64 rays, half of it takes 2^2 times as many, and twice that and a little
 * because the rest is to have its share; one round finds that out. */
static void price_of_noise(void **state)
{
	(void)state;
	gw_price_task t = priced(0.02, 0.02, 0.0);
	gw_price price = gw_price_of_less(&t);
	assert_true(price.error == 0.01);
	double rays = 64 * 4 / (0.5 * 0.85 * 0.85);
	double seconds = 3.0 + 2 * 0.5 + 1e-6 * 8000 * (rays + 64);
	/* Sums and products of a few doubles. */
	assert_true(fabs(price.seconds - seconds) < 1e-9);
	/* Denser records to begin with are not needed for it. */
	t.spacing = 2.5;
	assert_true(gw_price_of_less(&t).seconds < price.seconds);
	/* More rays than there can be. */
	assert_true(gw_price_of(&t, 0.02 / 12).seconds == 0.0);
}

static void less_error_costs_more(void **state)
{
	(void)state;
	gw_price_task t = priced(0.04, 0.01, 0.002);
	double last = 0.0;
	for (double error = 0.04; error > 0.008; error *= 0.8) {
		gw_price price = gw_price_of(&t, error);
		assert_true(price.error == error && price.seconds > last);
		last = price.seconds;
	}
	/* What was refined has no more to win by putting records where they are needed. */
	double even = gw_price_of(&t, 0.015).seconds;
	t.refined = true;
	assert_true(gw_price_of(&t, 0.015).seconds > even);
}

/* Edges of shadows are a floor: half of 3.2 % is below 3 %, and so is all that can be had. */
static void shadows_are_a_floor(void **state)
{
	(void)state;
	gw_price_task t = priced(0.011, 0.008, 0.03);
	gw_price price = gw_price_of_less(&t);
	assert_true(price.error == 0.0 && price.seconds == 0.0);
	assert_true(gw_price_of(&t, 0.03).seconds == 0.0);
	/* With more besides, half of that can go; two digits, never less than it is. */
	t = priced(0.04, 0.008, 0.02);
	price = gw_price_of_less(&t);
	assert_true(price.error >= hypot(0.02 / 0.85, 0.02) && price.error < 0.0321);
	assert_true(fabs(price.error * 1000 - round(price.error * 1000)) < 1e-9);
	assert_true(price.seconds > 0.0);
	t = priced(0.0, 0.0, 0.05);
	assert_true(gw_price_of_less(&t).error == 0.0);
}

/* So is each other part that no finer setting lessens: of 38 % that are 36 % for want of scans,
 * half is not to be had, nor is anything that would not be asked for beside these. */
static void what_stays_is_a_floor(void **state)
{
	(void)state;
	gw_price_task t = priced(0.08, 0.01, 0.0);
	double *const stays[] = { &t.error.normals, &t.error.emission, &t.error.geometry, &t.error.gaps,
							  &t.error.sides,   &t.error.narrow,   &t.error.between };
	for (size_t i = 0; i < sizeof stays / sizeof *stays; i++) {
		*stays[i] = 0.36;
		t.error.relative_rms = hypot(0.08, 0.36);
		assert_true(gw_price_of_less(&t).error == 0.0);
		assert_true(gw_price_of(&t, 0.36).seconds == 0.0);
		*stays[i] = 0.0;
	}
}

/* Where the error is more than all light, half of it may be more than can be asked for. */
static void price_of_more_than_all_light(void **state)
{
	(void)state;
	gw_price_task t = priced(14.0, 1.0, 0.5);
	gw_price price = gw_price_of_less(&t);
	assert_true(price.error == 0.99 && price.seconds == gw_price_of(&t, 0.99).seconds);
	assert_true(price.seconds > 0.0);
	t.error.shadows = 1.0;
	assert_true(gw_price_of_less(&t).error == 0.0);
	/* Nor is an error named that no number of rays would bring. */
	t = priced(20.0, 20.0, 0.0);
	assert_true(gw_price_of(&t, 0.99).seconds == 0.0);
	assert_true(gw_price_of_less(&t).error == 0.0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(presets_get_finer),
		cmocka_unit_test(target_counts_the_spread),
		cmocka_unit_test(noise_asks_for_rays),
		cmocka_unit_test(the_rest_asks_for_records_then_leaves),
		cmocka_unit_test(gathered_light_asks_for_records),
		cmocka_unit_test(few_records_prove_nothing),
		cmocka_unit_test(a_target_out_of_reach_is_not_chased),
		cmocka_unit_test(it_ends),
		cmocka_unit_test(what_does_not_help_ends),
		cmocka_unit_test(time_makes_steps_smaller),
		cmocka_unit_test(records_come_first),
		cmocka_unit_test(rays_come_before_records),
		cmocka_unit_test(price_of_noise),
		cmocka_unit_test(less_error_costs_more),
		cmocka_unit_test(shadows_are_a_floor),
		cmocka_unit_test(what_stays_is_a_floor),
		cmocka_unit_test(price_of_more_than_all_light),
	};
	return cmocka_run_group_tests_name("refine", tests, NULL, NULL);
}

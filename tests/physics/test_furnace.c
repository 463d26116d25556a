/* Interreflection against closed forms: the white furnace bounce by bounce, and the integrating
 * sphere. Every point of a sphere sees every other alike, so all bounces are known exactly. */
#include "scenes.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#define POINTS 20000

/* Where only the mean is asked for, in which each point counts alike. */
#define POINTS_OF_MEANS 6000

/*
 * Allowed error of a mean, relative. Rays find the planes in the leaves or slip between two at a
 * crease of the sphere: under 1 %. Cones blur a voxel over its neighbours: 3 %.
 */
static double allowed(gw_method method)
{
	return method == GW_METHOD_RAYS ? 0.01 : 0.03;
}

static gw_bake_options options_of(gw_method method, uint32_t bounces)
{
	gw_bake_options options = gw_bake_options_default();
	options.method = method;
	options.bounces = bounces;
	options.estimate_points = 0;
	return options;
}

/* A sphere of radius 1 seen from inside; Le = 1 everywhere if it emits. */
static scene make_sphere(float albedo, bool emits)
{
	scene s = { 0 };
	scene_add_sphere(&s, (double[3]){ 0, 0, 0 }, 1.0, emits ? POINTS_OF_MEANS : POINTS, -1, albedo);
	if (emits)
		scene_emit(&s, 0, (float[3]){ 1, 1, 1 });
	return s;
}

static void assert_mean(const char *what, double found, double expected, double relative)
{
	if (!(fabs(found / expected - 1.0) <= relative))
		fail_msg("%s: %.6g, not %.6g: off by %.2f %%, allowed %.2f %%", what, found, expected,
				 100.0 * (found / expected - 1.0), 100.0 * relative);
}

/* Successive reflections never gain energy: their ratio is at most the albedo, and 0.001 for the
 * float32 sums (hard bound: the Neumann series converges). */
static void assert_decay(const gw_report *report, double albedo)
{
	for (uint32_t n = 1; n < report->bounce_count; n++) {
		double before = report->bounce[n - 1].energy, now = report->bounce[n].energy;
		if (!(now <= before && now <= before * (albedo + 1e-3)))
			fail_msg("bounce %u has %.6g W after %.6g W: ratio %.5f, albedo %g", n + 1, now, before,
					 now / before, albedo);
	}
}

/* No record gathers more than the brightest of the bounce before reflects: it is a mean over 64
 * rays, of floats of 24 bits. And in a sphere that glows evenly all of them carry the light: by
 * Cauchy-Schwarz at most as many as there are, and as their shares of the surface differ by less
 * than their mean, at least half. */
static void assert_records_lose(const gw_report *report, double albedo)
{
	double records = (double)report->records;
	for (uint32_t n = 1; n < report->bounce_count; n++) {
		const gw_bounce *now = &report->bounce[n];
		double most = now[-1].largest_irradiance * albedo * (1.0 + 64 * 6e-8);
		if (n > 1 && !(now->largest_irradiance <= most))
			fail_msg("bounce %u: a record gathers %.9g, at most %.9g", n + 1,
					 now->largest_irradiance, most);
		if (!(now->carriers >= 0.5 * records && now->carriers <= records * 1.0001))
			fail_msg("bounce %u comes by %g of %g records", n + 1, now->carriers, records);
	}
}

/*
 * Nor do they lose any in a closed scene. 1 % of the mean at albedo 0.8, where all bounces after
 * the first are 4 times the first, allows each to lose 0.25 %.
 */
static void assert_no_leak(const gw_report *report, double albedo)
{
	for (uint32_t n = 1; n < report->bounce_count; n++) {
		double ratio = report->bounce[n].energy / report->bounce[n - 1].energy;
		if (!(ratio >= albedo * (1.0 - 0.0025)))
			fail_msg("bounce %u keeps %.5f of the one before, albedo %g", n + 1, ratio, albedo);
	}
}

/* After N bounces L = Le (1 - rho^(N+1)) / (1 - rho). */
static void check_bounces(gw_method method, float albedo, uint32_t bounces)
{
	scene s = make_sphere(albedo, true);
	gw_points points = scene_points(&s);
	gw_bake_options options = options_of(method, bounces);
	gw_bake_result *result = scene_bake(&points, NULL, 0, &options);
	double rho = (double)albedo;
	double expected = (1.0 - pow(rho, bounces + 1.0)) / (1.0 - rho);
	char what[64];
	snprintf(what, sizeof what, "%s, albedo %g, %u bounces", gw_method_name(method), rho, bounces);
	for (size_t c = 0; c < 3; c++)
		assert_mean(what, scene_mean(result->radiance, s.count, c), expected,
					bounces == 0 ? 0.0 : allowed(method));
	assert_int_equal(result->report.bounce_count, bounces);
	assert_decay(&result->report, rho);
	gw_bake_result_destroy(&result);
	scene_clear(&s);
}

static void furnace_by_rays(void **state)
{
	(void)state;
	const uint32_t bounces[] = { 0, 1, 2, 3, 8 };
	for (size_t i = 0; i < 5; i++)
		check_bounces(GW_METHOD_RAYS, 0.5f, bounces[i]);
	check_bounces(GW_METHOD_RAYS, 0.8f, 3);
	check_bounces(GW_METHOD_RAYS, 0.8f, 8);
}

static void furnace_by_cones(void **state)
{
	(void)state;
	const uint32_t bounces[] = { 0, 1, 2, 3, 8 };
	for (size_t i = 0; i < 5; i++)
		check_bounces(GW_METHOD_CONES, 0.5f, bounces[i]);
	check_bounces(GW_METHOD_CONES, 0.8f, 3);
}

/* Automatic bounces reach Le / (1 - rho) but for the tolerance, which they promise to keep and
 * which counts in the error that is stated: within a factor of two, as any fault is to be. */
static void furnace_until_tolerance(void **state)
{
	(void)state;
	const float albedo[] = { 0.5f, 0.8f, 0.98f };
	for (size_t i = 0; i < 3; i++) {
		double rho = (double)albedo[i];
		scene s = make_sphere(albedo[i], true);
		gw_points points = scene_points(&s);
		gw_bake_options options = options_of(GW_METHOD_RAYS, GW_BOUNCES_AUTO);
		options.estimate_points = gw_bake_options_default().estimate_points;
		gw_bake_result *result = scene_bake(&points, NULL, 0, &options);
		assert_true(result->report.remaining <= (double)options.tolerance);
		double off = fabs((1.0 - rho) * scene_mean(result->radiance, s.count, 0) - 1.0);
		double stated = result->report.error.relative_rms;
		if (!(2.0 * stated >= off))
			fail_msg("albedo %g: %.3f %% off, stated %.3f", rho, 100 * off, 100 * stated);
		/* What every bounce may lose (see assert_no_leak) adds up to this over all of them. */
		double leak = 0.0025 * rho / (1.0 - rho);
		assert_mean("automatic", scene_mean(result->radiance, s.count, 0), 1.0 / (1.0 - rho),
					fmax(allowed(GW_METHOD_RAYS), leak) + (double)options.tolerance);
		assert_no_leak(&result->report, rho);
		assert_decay(&result->report, rho);
		gw_bake_result_destroy(&result);
		scene_clear(&s);
	}
}

/* Who asks for an error below the tolerance gets it, by as many bounces as that takes; the mean is
 * within two of what is stated. */
static void errors_below_the_tolerance(void **state)
{
	(void)state;
	scene s = make_sphere(0.8f, true);
	gw_points points = scene_points(&s);
	gw_bake_options options = options_of(GW_METHOD_RAYS, GW_BOUNCES_AUTO);
	options.estimate_points = gw_bake_options_default().estimate_points;
	options.max_error = 0.2f * options.tolerance;
	gw_bake_result *result = scene_bake(&points, NULL, 0, &options);
	const gw_report *r = &result->report;
	assert_true(r->remaining <= 0.25 * (double)options.max_error);
	assert_int_equal(r->goal, GW_GOAL_REACHED);
	assert_mean("asked for", scene_mean(result->radiance, s.count, 0), 5.0,
				2.0 * (double)options.max_error);
	gw_bake_result_destroy(&result);
	scene_clear(&s);
}

/* One reflection among few points that all emit: L = Le (1 + rho). Of the half that is reflected,
 * rays that slip between planes lose 0.3 %. */
static void few_points_that_glow(void **state)
{
	(void)state;
	scene s = { 0 };
	scene_add_sphere(&s, (double[3]){ 0, 0, 0 }, 1.0, 3000, -1, 0.98f);
	scene_emit(&s, 0, (float[3]){ 1, 1, 1 });
	gw_points points = scene_points(&s);
	gw_bake_options options = options_of(GW_METHOD_RAYS, 1);
	gw_bake_result *result = scene_bake(&points, NULL, 0, &options);
	assert_mean("few points", scene_mean(result->radiance, s.count, 0), 1.98, 0.5 * 0.003);
	gw_bake_result_destroy(&result);
	scene_clear(&s);
}

/* Among walls of the highest albedo there is light for 2,000 bounces: each has at most the albedo's
 * share of the one before, which float32 sums bear out to 1e-5, so that the sum is bounded by
 * Le / (1 - rho). Below, it may miss what rays lose (see assert_no_leak), not more. */
static void two_thousand_bounces(void **state)
{
	(void)state;
	const double rho = 0.99, most = 1.0 / (1.0 - rho);
	scene s = { 0 };
	scene_add_sphere(&s, (double[3]){ 0, 0, 0 }, 1.0, 3000, -1, 0.99f);
	scene_emit(&s, 0, (float[3]){ 1, 1, 1 });
	gw_points points = scene_points(&s);
	gw_bake_options options = options_of(GW_METHOD_RAYS, 2000);
	gw_bake_result *result = scene_bake(&points, NULL, 0, &options);
	const gw_report *r = &result->report;
	double mean = scene_mean(result->radiance, s.count, 0);
	assert_int_equal(r->bounce_count, 2000);
	for (uint32_t n = 1; n < r->bounce_count; n++)
		if (!(r->bounce[n].energy <= r->bounce[n - 1].energy * rho * (1.0 + 1e-5)))
			fail_msg("bounce %u has %.9g W after %.9g W", n + 1, r->bounce[n].energy,
					 r->bounce[n - 1].energy);
	assert_records_lose(r, rho);
	if (!(mean <= most * 1.0001 && mean >= 1.0 / (1.0 - rho * (1.0 - 0.0025))))
		fail_msg("radiance is %.4g, at most %.4g", mean, most);
	gw_bake_result_destroy(&result);
	scene_clear(&s);
}

/*
 * Spread that Monte Carlo alone gives the indirect irradiance: a record's rays fall evenly on the
 * sphere whatever the record's place, so its first gather has the variance of the reflected light
 * over the sphere, divided by the number of rays. Later bounces gather what is already even.
 */
static double record_spread(const gw_bake_result *result, double rho, double samples)
{
	double sum = 0.0, squares = 0.0, n = (double)result->count;
	for (size_t i = 0; i < result->count; i++) {
		double e = rho * (double)result->direct_irradiance[3 * i];
		sum += e;
		squares += e * e;
	}
	return sqrt(fmax(0.0, squares / n - sum / n * (sum / n)) / samples);
}

/* E_ind = rho Phi / (4 pi R^2 (1 - rho)), the same at every point wherever the lamp is. */
static void check_integrating_sphere(gw_method method, float albedo)
{
	double rho = (double)albedo;
	scene s = make_sphere(albedo, false);
	gw_points points = scene_points(&s);
	gw_light light = scene_point_light(0.3, 0.2, -0.1, 2.0f);
	gw_bake_options options = options_of(method, GW_BOUNCES_AUTO);
	options.tolerance = 0.001f;
	gw_bake_result *result = scene_bake(&points, &light, 1, &options);
	double expected = rho * 2.0 / (1.0 - rho);
	assert_mean(gw_method_name(method), scene_mean(result->indirect_irradiance, s.count, 0),
				expected, allowed(method));
	double squares = 0.0;
	for (size_t i = 0; i < s.count; i++) {
		double off = (double)result->indirect_irradiance[3 * i] - expected;
		squares += off * off;
	}
	double samples = method == GW_METHOD_RAYS ? options.rays : options.cones;
	double spread = sqrt(squares / (double)s.count);
	double bound = record_spread(result, rho, samples) + allowed(method) * expected;
	if (!(spread <= bound))
		fail_msg("%s, albedo %g: indirect light spreads by %.4g of %.4g, allowed %.4g",
				 gw_method_name(method), rho, spread, expected, bound);
	assert_decay(&result->report, rho);
	gw_bake_result_destroy(&result);
	scene_clear(&s);
}

static void integrating_sphere(void **state)
{
	(void)state;
	check_integrating_sphere(GW_METHOD_RAYS, 0.5f);
	check_integrating_sphere(GW_METHOD_RAYS, 0.8f);
	check_integrating_sphere(GW_METHOD_CONES, 0.5f);
}

/* Share of the sky that shines into a closed scene: what its surface lets through. */
static double sky_let_in(const gw_points *points, gw_method method)
{
	gw_light sky = { .type = GW_LIGHT_ENVIRONMENT, .radiance = { 1, 1, 1 } };
	gw_bake_options options = options_of(method, 1);
	gw_bake_result *result = scene_bake(points, &sky, 1, &options);
	double share = scene_mean(result->direct_irradiance, points->count, 0) / SCENE_PI;
	gw_bake_result_destroy(&result);
	return share;
}

/* Share of what the walls of a closed cube send out that cones do not find again. The sky does not
 * get in where it gets out: it is shut out by the space that is closed, not by cones. */
static double lost_by_cones(double per_metre)
{
	scene s = { 0 };
	scene_add_box(&s, (double[3]){ 0, 0, 0 }, (double[3]){ 2, 2, 2 }, per_metre, 0.5f);
	scene_emit(&s, 0, (float[3]){ 1, 1, 1 });
	gw_points points = scene_points(&s);
	gw_bake_options options = options_of(GW_METHOD_CONES, 1);
	gw_bake_result *result = scene_bake(&points, NULL, 0, &options);
	double found = scene_mean(result->direct_irradiance, s.count, 0) / SCENE_PI;
	gw_bake_result_destroy(&result);
	scene_clear(&s);
	return 1.0 - found;
}

/*
 * The lamp of a closed cube of side a: mean indirect irradiance rho Phi / (6 a^2 (1 - rho)), by
 * energy, whatever the shape (CIE 171, 5.8). Points per area are even, so the mean is over area.
 * What the walls let in from outside they let out in every bounce.
 */
static void check_cube(gw_method method, double per_metre, double let_in)
{
	scene s = { 0 };
	scene_add_box(&s, (double[3]){ 0, 0, 0 }, (double[3]){ 2, 2, 2 }, per_metre, 0.5f);
	gw_points points = scene_points(&s);
	gw_light light = scene_point_light(1, 1, 1, 2.0f);
	gw_bake_options options = options_of(method, GW_BOUNCES_AUTO);
	options.tolerance = 0.001f;
	double open = sky_let_in(&points, method);
	if (!(open <= let_in))
		fail_msg("%s: %.3f %% of the sky shines into a closed cube, allowed %.3f %%",
				 gw_method_name(method), 100 * open, 100 * let_in);
	gw_bake_result *result = scene_bake(&points, &light, 1, &options);
	double lost = method == GW_METHOD_CONES ? lost_by_cones(per_metre) : open;
	if (!(lost <= let_in))
		fail_msg("%s: %.3f %% of the light is lost in a closed cube, allowed %.3f %%",
				 gw_method_name(method), 100 * lost, 100 * let_in);
	double kept = 0.5 * (1 - lost);
	assert_mean(gw_method_name(method), scene_mean(result->indirect_irradiance, s.count, 0),
				2 * SCENE_PI / 3 * kept / (2 * (1 - kept)), allowed(method));
	/* Cones may brighten by their allowed error; rays may not. */
	assert_decay(&result->report, method == GW_METHOD_CONES ? 0.5 * (1 + allowed(method)) : 0.5);
	gw_bake_result_destroy(&result);
	scene_clear(&s);
}

static void closed_cube(void **state)
{
	(void)state;
	/* Of the leaves only those at edges could leave a crack, 4 of 120 along a wall, and of their
	 * width a plane's overlap closes all but the worst 1 %. */
	check_cube(GW_METHOD_RAYS, 60, 4.0 / 120 * 0.01);
	/* Far away a cone looks at voxels a quarter of the room wide. Those that a wall ends in are
	 * half empty along the edge, and the gain of 1.5 makes up for a third. On average over a strip
	 * of half a voxel along 4 edges: 4 * 0.125 * (1/2 - 1/3) = 8 % of the light,
	 * however many points there are. */
	check_cube(GW_METHOD_CONES, 30, 0.08);
}

/* Mean light of a cube of random points by a lamp that sends out 4 pi I, of rho I / (6 pi (1 -
 * rho)), which it has by energy: of each watt the walls, 24 m2, keep 1 - rho. */
static double white_room_mean(uint64_t seed, size_t count, float albedo)
{
	double rho = (double)albedo;
	scene s = { .state = 7919u * seed };
	scene_make_random_room(&s, count, albedo);
	gw_points points = scene_points(&s);
	gw_light light = scene_point_light(0.3, 0.2, -0.25, 10.0f);
	gw_bake_options options = options_of(GW_METHOD_RAYS, GW_BOUNCES_AUTO);
	gw_bake_result *result = scene_bake(&points, &light, 1, &options);
	double mean = scene_mean(result->radiance, s.count, 0);
	gw_bake_result_destroy(&result);
	scene_clear(&s);
	return mean / (rho * 10.0 / (6.0 * (1.0 - rho)));
}

/*
 * What the first reflections lose stays lost, however many follow: a record speaks for its
 * surroundings as if light were even there, and of 3,000 points 230 records lose 0.8 to 1.5 %. Five
 * times as many are within 0.3 %, as 64 rays from each are; bars are what is promised.
 */
static void white_rooms_of_few_points(void **state)
{
	(void)state;
	const struct {
		size_t count;
		float albedo;
		double bar;
	} row[] = { { 3000, 0.95f, 0.005 }, { 3000, 0.98f, 0.01 }, { 20000, 0.95f, 0.005 } };
	for (size_t i = 0; i < 3 * sizeof row / sizeof *row; i++) {
		double mean = white_room_mean(i % 3, row[i / 3].count, row[i / 3].albedo);
		print_message("%zu points, albedo %g: %+.2f %%\n", row[i / 3].count,
					  (double)row[i / 3].albedo, 100 * (mean - 1));
		assert_mean("white room", mean, 1, row[i / 3].bar);
	}
}

/*
 * Two closed rooms 1.2 leaf cells apart, a lamp in one: the other stays dark. A ray has to slip
 * through cracks of two walls, of which each lets under 0.1 % through (see PLANE_OVERLAP): that a
 * tenth of those finds another crack within a cell and a half allows 0.05 %, with the five bounces
 * that albedo 0.5 makes of one. Interpolating from records beyond the wall would show as 0.15 %.
 */
static void thin_wall_keeps_light_in(void **state)
{
	(void)state;
	scene s = { 0 };
	scene_add_box(&s, (double[3]){ 0, 0, 0 }, (double[3]){ 2, 2, 2 }, 30, 0.5f);
	size_t first = s.count;
	scene_add_box(&s, (double[3]){ 2.05, 0, 0 }, (double[3]){ 2, 2, 2 }, 30, 0.5f);
	gw_points points = scene_points(&s);
	gw_light light = scene_point_light(1.2, 0.9, 1.1, 2.0f);
	gw_bake_options options = options_of(GW_METHOD_RAYS, GW_BOUNCES_AUTO);
	gw_bake_result *result = scene_bake(&points, &light, 1, &options);
	double lit = scene_mean(result->radiance, first, 1);
	double dark = scene_mean(result->radiance + 3 * first, s.count - first, 1);
	if (!(dark <= 0.0005 * lit))
		fail_msg("%.4f %% of the light is in the other room", 100 * dark / lit);
	gw_bake_result_destroy(&result);
	scene_clear(&s);
}

/*
 * A half-lit sphere whose records gather with 8 rays: the bake's own estimate of its error against
 * its true one, of which every value is known. Both are of some 1000 samples of a distribution that
 * is near normal, so 1 / sqrt(2 * 1000) = 2.2 % of either is chance; three times that, and what the
 * estimate cannot see of the octree's planes, under 15 % on scenes with known answers. Its spread
 * has a tenth for that, and beside it what 1000 points leave.
 */
static void error_is_estimated(void **state)
{
	(void)state;
	scene s = make_sphere(0.5f, false);
	gw_points points = scene_points(&s);
	gw_light light = scene_point_light(0.5, 0.3, -0.2, 2.0f);
	gw_bake_options options = options_of(GW_METHOD_RAYS, GW_BOUNCES_AUTO);
	options.rays = 8;
	options.estimate_points = 1000;
	gw_bake_result *result = scene_bake(&points, &light, 1, &options);
	double squares = 0.0, sum = 0.0;
	for (size_t i = 0; i < s.count; i++) {
		double off = (double)result->indirect_irradiance[3 * i] - 2.0;
		squares += off * off;
		sum += 2.0 + (double)result->direct_irradiance[3 * i];
	}
	double n = (double)s.count, true_error = sqrt(squares / n) / (sum / n);
	const gw_error_estimate *e = &result->report.error;
	assert_true(e->points > 900 && e->points <= 1000);
	assert_true(e->spread >= 0.1 * e->gathered && e->spread < 0.15 * e->relative_rms);
	if (!(fabs(e->relative_rms / true_error - 1.0) <= 3 * 0.022 + 0.15))
		fail_msg("estimated %.3f %% +- %.3f %%, truly %.3f %%", 100 * e->relative_rms,
				 100 * e->spread, 100 * true_error);
	gw_bake_result_destroy(&result);
	options.estimate_points = 0;
	result = scene_bake(&points, &light, 1, &options);
	assert_int_equal(result->report.error.points, 0);
	assert_false(scene_has_stage(&result->report, "estimate"));
	gw_bake_result_destroy(&result);
	scene_clear(&s);
}

#define PLATE_SIDE 1.0
#define PLATE_BELOW 0.25
#define PLATE_PER_METRE 30

/* Form factor of a square of that side, by a place `below` of it, which looks at it straight, x and
 * y off its middle (Hottel and Sarofim 1967). */
static double square_seen(double side, double below, double x, double y)
{
	double sum = 0.0;
	for (int i = 0; i < 4; i++) {
		double a = (0.5 * side + (i % 2 ? x : -x)) / below;
		double b = (0.5 * side + (i / 2 ? y : -y)) / below;
		double ra = sqrt(1.0 + a * a), rb = sqrt(1.0 + b * b);
		sum += a / ra * atan(b / ra) + b / rb * atan(a / rb);
	}
	return sum / (2.0 * SCENE_PI);
}

/* Mean irradiance of the ceiling's points above the middle of the plate, one that came straight and
 * one that was reflected; and what all around sends there, were the plate of another side. */
static double above_plate(const gw_points *points, const float *irradiance, double side)
{
	double sum = 0.0, n = 0.0;
	for (size_t i = 0; i < points->count; i++) {
		const double *p = points->position + 3 * i;
		double x = p[0] - 1.0, y = p[1] - 1.0;
		if (p[2] < 2.0 - 1e-6 || fmax(fabs(x), fabs(y)) > 0.5 * PLATE_BELOW)
			continue;
		sum += irradiance ? (double)irradiance[3 * i]
						  : SCENE_PI * (1.0 - square_seen(side, PLATE_BELOW, x, y));
		n += 1.0;
	}
	return sum / n;
}

/*
 * A black plate that faces the floor hangs under the ceiling of a room whose walls glow. Most of
 * what the ceiling sees above it is the plate's back, which is black, and the rest is the walls'
 * light: closed form. Where the plate ends is known to the distance between points, to either side;
 * the light that was reflected once is the albedo's share of that which came straight, but for what
 * the plate keeps from the walls: from 0.5 to 1.5 m away, at most the integral of 1 / (2 pi d^2).
 */
static void ceiling_above_a_plate(void **state)
{
	const double side = PLATE_SIDE, spacing = 1.0 / PLATE_PER_METRE, low = 1.0 - 0.5 * side;
	scene s = { 0 };
	(void)state;
	scene_add_box(&s, (double[3]){ 0, 0, 0 }, (double[3]){ 2, 2, 2 }, PLATE_PER_METRE, 0.5f);
	scene_emit(&s, 0, (float[3]){ 1, 1, 1 });
	size_t walls = s.count, n = (size_t)(side * PLATE_PER_METRE);
	scene_add_patch(&s,
					&(scene_patch){ (double[3]){ low, low, 2.0 - PLATE_BELOW },
									(double[3]){ 0, side, 0 }, (double[3]){ side, 0, 0 }, n, n },
					0.0f);
	gw_points points = scene_points(&s);
	gw_bake_options options = options_of(GW_METHOD_RAYS, 2);
	gw_bake_result *result = scene_bake(&points, NULL, 0, &options);
	double straight = above_plate(&points, result->direct_irradiance, side);
	double reflected = above_plate(&points, result->indirect_irradiance, side);
	if (!(straight >= above_plate(&points, NULL, side + 2 * spacing) &&
		  straight <= above_plate(&points, NULL, side - 2 * spacing)))
		fail_msg("above the plate: %.4g, not %.4g", straight, above_plate(&points, NULL, side));
	assert_mean("reflected", reflected, 0.5 * straight, 0.21);
	for (size_t i = 0; i < walls; i++)
		assert_true(result->direct_irradiance[3 * i] > 0.0f);
	gw_bake_result_destroy(&result);
	scene_clear(&s);
}

#define RINGS 200
#define GAP_POINTS 2000 /* of each plate */
#define GAP_RADIUS 10.0
#define GAP_ALBEDO 0.9
#define GAP_WIDE 4.0
#define GAP_MIDDLE 3.0 /* what is looked at: points so near to the axis */

/*
 * Two discs, one above the other, the lower one emits 1: mean radiance of the middle of the upper
 * one. What a point at r of one gets from the ring at s of the other is 2 h^2 a s ds / (a^2 -
 * b^2)^1.5, with h their distance, a = h^2 + r^2 + s^2, b = 2 r s: the radiosity equation in one
 * variable, solved by reflecting until nothing changes.
 */
static double above_glowing_plate(double rho, double radius, double h)
{
	static double kernel[RINGS][RINGS];
	double light[2][RINGS], step = radius / RINGS, sum = 0.0, area = 0.0;
	for (int i = 0; i < RINGS; i++)
		light[0][i] = 1.0;
	for (int i = 0; i < RINGS; i++)
		for (int k = 0; k < RINGS; k++) {
			double r = (i + 0.5) * step, s = (k + 0.5) * step;
			double a = h * h + r * r + s * s, b = 2.0 * r * s;
			kernel[i][k] = 2.0 * h * h * a * s * step / pow(a * a - b * b, 1.5);
		}
	for (int bounce = 0; bounce < 200; bounce++) {
		const double *from = light[bounce % 2];
		for (int i = 0; i < RINGS; i++) {
			double gathered = 0.0;
			for (int k = 0; k < RINGS; k++)
				gathered += kernel[i][k] * from[k];
			light[1 - bounce % 2][i] = (bounce % 2 ? 1.0 : 0.0) + rho * gathered;
		}
	}
	for (int i = 0; (i + 0.5) * step < GAP_MIDDLE; i++) {
		sum += light[1][i] * (i + 0.5);
		area += i + 0.5;
	}
	return sum / area;
}

static void add_disc(scene *s, double radius, double z, float rho)
{
	const double up[3] = { 0, 0, z > 0.0 ? -1 : 1 };
	for (int i = 0; i < GAP_POINTS; i++) {
		double r = radius * sqrt(scene_random(s)), angle = 2.0 * SCENE_PI * scene_random(s);
		scene_add(s, (double[3]){ r * cos(angle), r * sin(angle), z }, up, rho);
	}
}

static double spacing_of_discs(void)
{
	return GAP_RADIUS * sqrt(SCENE_PI / GAP_POINTS);
}

/* Bakes two discs of albedo 0.9, that far apart, of which the lower one glows; the mean radiance of
 * the middle of the upper one. */
static double bake_in_gap(double gap)
{
	const float rho = (float)GAP_ALBEDO;
	scene s = { 0 };
	add_disc(&s, GAP_RADIUS, 0.0, rho);
	scene_emit(&s, 0, (float[3]){ 1, 1, 1 });
	add_disc(&s, GAP_RADIUS, gap, rho);
	gw_points points = scene_points(&s);
	gw_bake_options options = options_of(GW_METHOD_RAYS, GW_BOUNCES_AUTO);
	gw_bake_result *result = scene_bake(&points, NULL, 0, &options);
	double sum = 0.0, n = 0.0;
	for (size_t i = GAP_POINTS; i < points.count; i++) {
		const double *p = points.position + 3 * i;
		bool counts = p[0] * p[0] + p[1] * p[1] < GAP_MIDDLE * GAP_MIDDLE;
		sum += counts ? (double)result->radiance[3 * i] : 0.0;
		n += counts;
	}
	gw_bake_result_destroy(&result);
	scene_clear(&s);
	return sum / n;
}

/*
 * A gap of three spacings is open at its rim: light gets out of it. 0.5 % is what the furnaces may
 * be off, and where the plates end is known to the distance between points.
 */
static void gap_of_three_spacings(void **state)
{
	const double spacing = spacing_of_discs(), gap = 3.0 * spacing;
	(void)state;
	double known = above_glowing_plate(GAP_ALBEDO, GAP_RADIUS, gap);
	double wider = above_glowing_plate(GAP_ALBEDO, GAP_RADIUS + spacing, gap);
	assert_mean("in the gap", bake_in_gap(gap), known, 0.005 + wider / known - 1.0);
}

/*
 * Rays from the middle come flat to the surface near the rim, where light falls off. It is that of
 * the place where they meet it, as bright as the closed form says, to what the furnaces may be off:
 * found in a cell before that, as planes reach beyond theirs, it was 2.6 % too much.
 */
static void flat_rays_find_the_light_of_their_place(void **state)
{
	const double gap = GAP_WIDE * spacing_of_discs();
	(void)state;
	double known = above_glowing_plate(GAP_ALBEDO, GAP_RADIUS, gap);
	assert_mean("in a wide gap", bake_in_gap(gap), known, 0.005);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(furnace_by_rays),
		cmocka_unit_test(furnace_by_cones),
		cmocka_unit_test(furnace_until_tolerance),
		cmocka_unit_test(errors_below_the_tolerance),
		cmocka_unit_test(few_points_that_glow),
		cmocka_unit_test(two_thousand_bounces),
		cmocka_unit_test(integrating_sphere),
		cmocka_unit_test(closed_cube),
		cmocka_unit_test(white_rooms_of_few_points),
		cmocka_unit_test(thin_wall_keeps_light_in),
		cmocka_unit_test(error_is_estimated),
		cmocka_unit_test(ceiling_above_a_plate),
		cmocka_unit_test(gap_of_three_spacings),
		cmocka_unit_test(flat_rays_find_the_light_of_their_place),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

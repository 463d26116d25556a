/* Records that see by the rays of their neighbours as well, against a closed form. */
#include "light/shared_rays.h"
#include "scenes.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

/* The lower half of a sphere of radius 1, which is lit from within. */
static void make_bowl(scene *s)
{
	size_t kept = 0;
	scene_add_sphere(s, (double[3]){ 0, 0, 0 }, 1.0, 20000, -1, 0.5f);
	for (size_t i = 0; i < s->count; i++) {
		if (s->position[3 * i + 2] > 0.0)
			continue;
		memcpy(s->position + 3 * kept, s->position + 3 * i, 3 * sizeof *s->position);
		memcpy(s->normal + 3 * kept, s->normal + 3 * i, 3 * sizeof *s->normal);
		kept++; /* all have the same albedo */
	}
	s->count = kept;
}

/* Root of the mean square of what points are off the closed form, as a share of that. */
static double spread(const float *irradiance, size_t count, double expected)
{
	double squares = 0.0;
	for (size_t i = 0; i < count; i++) {
		double off = (double)irradiance[3 * i] / expected - 1.0;
		squares += off * off;
	}
	return sqrt(squares / (double)count);
}

/* From each place on a sphere the missing half is half of what it sees: of a sky of radiance 1 it
 * gets pi / 2, of which half is reflected to all, and half of what arrives there meets the bowl:
 * pi / 2 * (1/4 + 1/16 + ...) = pi / 6. */
static void bake_bowl(const scene *s, uint32_t rays, double *sky, double *reflected)
{
	const gw_light light = { .type = GW_LIGHT_ENVIRONMENT, .radiance = { 1, 1, 1 } };
	gw_points points = scene_points(s);
	gw_bake_options options = gw_bake_options_default();
	options.normals = GW_NORMALS_GIVEN;
	options.estimate_points = 0;
	options.rays = rays;
	gw_bake_result *result = scene_bake(&points, &light, 1, &options);
	*sky = spread(result->direct_irradiance, s->count, SCENE_PI / 2.0);
	*reflected = spread(result->indirect_irradiance, s->count, SCENE_PI / 6.0);
	gw_bake_result_destroy(&result);
}

/*
 * Of stratified rays to something with an edge, as the sky has here, twice as many leave 2^-0.75 of
 * the noise (D. Mitchell, Consequences of Stratified Sampling in Graphics, 1996), so that half as
 * many leave 1.68 times as much. Neighbours share several times as many with a record as it has; so
 * the most that are shared are to be worth at least half of the step to twice as many, which are
 * not: less than the root of 1.68 is left.
 */
static void neighbours_rays_are_worth_as_many_more(void **state)
{
	(void)state;
	double sky[2], reflected[2];
	const double most = pow(2.0, 0.375);
	scene s = { 0 };
	make_bowl(&s);
	bake_bowl(&s, GW_SHARED_RAYS_MOST, &sky[0], &reflected[0]);
	bake_bowl(&s, 2 * GW_SHARED_RAYS_MOST, &sky[1], &reflected[1]);
	if (!(sky[0] < most * sky[1] && reflected[0] < most * reflected[1]))
		fail_msg("sky %.3g, reflected %.3g; by twice as many rays %.3g and %.3g", sky[0],
				 reflected[0], sky[1], reflected[1]);
	scene_clear(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(neighbours_rays_are_worth_as_many_more),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

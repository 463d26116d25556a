/* The glossy bounce against closed forms: surroundings of one radiance, a mirror in a sphere whose
 * radiance is linear, by rays, cones and probes, and radiance read back from the octree's bricks.
 */
#include "scenes.h"
#include "picture/render_octree.h"
#include "glowworm_probes.h"
#include "expected.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define OUTER 20000 /* points of the sphere of radius 1, seen from inside */
#define INNER 4000  /* of the one of radius 0.3 in its middle, seen from outside */
#define RADIUS 0.3
#define PIXELS 2000

/* What a place of the scene sends out: mean + slope * z. */
typedef struct field {
	double mean, slope;
} field;

typedef struct world {
	scene scene;
	gw_surfels surfels;
	gw_render_octree *octree;
	float *radiance; /* 3 a surfel */
} world;

static void make_octree(world *w, field f, bool bricks)
{
	gw_error error = { 0 };
	gw_points points = scene_points(&w->scene);
	gw_surfels_options options = { .threads = 0 };
	assert_int_equal(gw_surfels_make(&points, &options, &w->surfels, &error), GW_OK);
	w->radiance = calloc(w->surfels.count, 3 * sizeof *w->radiance);
	assert_non_null(w->radiance);
	for (size_t i = 0; i < 3 * w->surfels.count; i++) {
		double z = (double)w->surfels.position[i / 3 * 3 + 2] + w->surfels.origin[2];
		w->radiance[i] = (float)(f.mean + f.slope * z);
	}
	gw_render_octree_options how = { .leaf_spacing = GW_LEAF_SPACING, .bricks = bricks };
	scene_choose_passes(&how.passes, &how.validate);
	assert_ok(gw_render_octree_create(&w->surfels, w->radiance, &how, &w->octree, &error), &error);
}

static void open_world(world *w, field f, bool bricks)
{
	*w = (world){ .octree = NULL };
	scene_add_sphere(&w->scene, (double[3]){ 0, 0, 0 }, 1.0, OUTER, -1, 0.5f);
	scene_add_sphere(&w->scene, (double[3]){ 0, 0, 0 }, RADIUS, INNER, 1, 0.5f);
	make_octree(w, f, bricks);
}

static void close_world(world *w)
{
	gw_render_octree_destroy(&w->octree);
	gw_surfels_clear(&w->surfels);
	scene_clear(&w->scene);
	free(w->radiance);
}

/* A sphere about the middle. */
typedef struct ball {
	double radius;
	float facing, roughness, reflectance; /* facing 1: outwards */
} ball;

/* Places on it, on the side that the eye at (0.8, 0, 0) sees. */
static void place_pixels(const world *w, const ball *b, float *position, float *normal)
{
	scene sphere = { 0 };
	scene_add_sphere(&sphere, (double[3]){ 0, 0, 0 }, 1.0, 4 * PIXELS, 1, 0.5f);
	size_t used = 0;
	for (size_t i = 0; i < sphere.count && used < PIXELS; i++) {
		const double *n = sphere.position + 3 * i;
		if (n[0] < 0.45)
			continue;
		for (size_t k = 0; k < 3; k++) {
			position[4 * used + k] = (float)(b->radius * n[k] - w->surfels.origin[k]);
			normal[4 * used + k] = b->facing * (float)n[k];
		}
		position[4 * used + 3] = b->roughness;
		normal[4 * used++ + 3] = b->reflectance;
	}
	assert_int_equal(used, PIXELS);
	scene_clear(&sphere);
}

static void set_eye(const world *w, gw_pixels *pixels)
{
	pixels->eye[0] = (float)(0.8 - w->surfels.origin[0]);
	pixels->eye[1] = (float)(0.0 - w->surfels.origin[1]);
	pixels->eye[2] = (float)(0.0 - w->surfels.origin[2]);
}

/*
 * A sphere of radiance 1 around a glossy one: what is reflected is the share of light that is, so
 * that together with the rest, which the diffuse surface sends out, every pixel has radiance 1.
 * Rays lose what slips between planes: 0.1 % of them (see passes.c); of a pixel's 32 or more no
 * more than three in 32. Cones are not full where their last step ends: 3 %, as in test_furnace.c.
 */
static void check_furnace(world *w, float roughness, float reflectance, uint32_t rays, bool cone)
{
	static float position[4 * PIXELS], normal[4 * PIXELS], reflected[4 * PIXELS];
	gw_error error = { 0 };
	gw_pixels pixels = { .count = PIXELS, .position = position, .normal = normal };
	const gw_reflection how = { .rays = rays, .cone = cone };
	place_pixels(w, &(ball){ RADIUS, 1.0f, roughness, reflectance }, position, normal);
	set_eye(w, &pixels);
	if (gw_render_octree_reflect(w->octree, &pixels, &how, reflected, &error) != GW_OK)
		fail_msg("%s", error.text);
	double mean = 0.0, least = INFINITY, most = 0.0;
	for (size_t i = 0; i < PIXELS; i++) {
		double share = (double)reflected[4 * i + 3];
		/* Schlick's F is between the reflectance and 1, up to rounding. */
		assert_true(share >= (double)reflectance - 1e-6 && share <= 1.0 + 1e-6);
		for (size_t k = 0; k < 3; k++) {
			double sum = (double)reflected[4 * i + k] + (1.0 - share);
			mean += sum / (3.0 * PIXELS);
			least = fmin(least, sum);
			most = fmax(most, sum);
		}
	}
	double allowed = cone ? 0.03 : 0.001;
	bool mirror = roughness * roughness < 1e-3f;
	printf("furnace roughness %g reflectance %g %s: mean %.5f, %.5f to %.5f\n", (double)roughness,
		   (double)reflectance, cone ? "cone" : "rays", mean, least, most);
	assert_true(fabs(mean - 1.0) <= allowed);
	assert_true(most <= 1.0 + (cone ? 0.03 : 1e-5));
	if (!cone && !mirror)
		assert_true(least >= 1.0 - 3.0 / 32.0 - 1e-5);
}

static void furnace_stays_white(void **state)
{
	(void)state;
	static const float roughness[] = { 0.0f, 0.3f, 0.6f, 1.0f };
	world w;
	open_world(&w, (field){ 1.0, 0.0 }, true);
	for (size_t r = 0; r < 4; r++)
		for (int cone = 0; cone < 2; cone++) {
			check_furnace(&w, roughness[r], 0.04f, 32, cone == 1);
			check_furnace(&w, roughness[r], 1.0f, 32, cone == 1);
		}
	/* More iterations than the software driver allows in one invocation: none may be lost. */
	check_furnace(&w, 0.5f, 0.5f, 512, false);
	close_world(&w);
}

/* Where a ray from `from` leaves the unit sphere: its z. */
static double exit_z(const double from[3], const double d[3])
{
	double b = 0.0, c = -1.0;
	for (int k = 0; k < 3; k++) {
		b += from[k] * d[k];
		c += from[k] * from[k];
	}
	return from[2] + d[2] * (sqrt(b * b - c) - b);
}

/* Probes of the same points, which glow; maps of 64 x 64 texels. */
static gw_probes *make_probes(const world *w, field f, const gw_probes_options *how)
{
	gw_points points = scene_points(&w->scene);
	float *emission = calloc(points.count, 3 * sizeof *emission);
	gw_error error = { 0 };
	gw_scene *prepared = NULL;
	gw_lighting *lighting = NULL;
	gw_probes *probes = NULL;
	gw_bake_options options = gw_bake_options_default();
	assert_non_null(emission);
	for (size_t i = 0; i < 3 * points.count; i++)
		emission[i] = (float)(f.mean + f.slope * points.position[i / 3 * 3 + 2]);
	points.emission = emission;
	points.albedo = NULL;
	options.bounces = 0;
	options.estimate_points = 0;
	options.effects_forced = 1u << GW_EFFECT_OCTREE;
	scene_choose_passes(&options.passes, &options.validate);
	const gw_scene_description description = { &points, NULL, 0 };
	assert_ok(gw_scene_create(&description, &options, NULL, &prepared, &error), &error);
	assert_ok(gw_lighting_create(prepared, NULL, 0, &lighting, &error), &error);
	assert_ok(gw_probes_make(lighting, how, &probes, &error), &error);
	gw_lighting_destroy(&lighting);
	gw_scene_destroy(&prepared);
	free(emission);
	return probes;
}

/* Where all has radiance 1, all that probes see has: together with the rest of the light every
 * pixel has radiance 1, up to roundings of so many rays. Rays leave as others do: the share is the
 * same.
 */
static void probes_keep_the_furnace_white(void **state)
{
	(void)state;
	static float position[4 * PIXELS], normal[4 * PIXELS], seen[4 * PIXELS], traced[4 * PIXELS];
	gw_error error = { 0 };
	world w;
	const field one = { 1.0, 0.0 };
	open_world(&w, one, false);
	gw_probes *probes = make_probes(&w, one, NULL);
	gw_pixels pixels = { .count = PIXELS, .position = position, .normal = normal };
	const gw_reflection how = { .rays = 32 };
	place_pixels(&w, &(ball){ RADIUS, 1.0f, 0.4f, 0.5f }, position, normal);
	set_eye(&w, &pixels);
	assert_ok(gw_probes_reflect(probes, w.surfels.origin, &pixels, &how, seen, &error), &error);
	assert_ok(gw_render_octree_reflect(w.octree, &pixels, &how, traced, &error), &error);
	for (size_t i = 0; i < PIXELS; i++) {
		for (size_t k = 0; k < 3; k++)
			assert_true(fabsf(seen[4 * i + k] - seen[4 * i + 3]) <= 1e-5f);
		if (!(fabsf(seen[4 * i + 3] - traced[4 * i + 3]) <= 1e-5f))
			fail_msg("pixel %zu: a share of %g, not %g", i, (double)seen[4 * i + 3],
					 (double)traced[4 * i + 3]);
	}
	gw_probes_destroy(&probes);
	close_world(&w);
}

/* The way of a ray from an eye that a mirror turns; returns the cosine at which it is met. */
static double mirror(const double eye[3], const double at[3], const float normal[3], double way[3])
{
	double length = 0.0, along = 0.0;
	for (size_t k = 0; k < 3; k++) {
		way[k] = at[k] - eye[k];
		length += way[k] * way[k];
		along += way[k] * (double)normal[k];
	}
	for (size_t k = 0; k < 3; k++)
		way[k] = (way[k] - 2.0 * along * (double)normal[k]) / sqrt(length);
	return -along / sqrt(length);
}

/* RMS of what mirrors on the ball show against 2 + z where the mirrored ray leaves the sphere. */
static double mirror_error(const world *w, const float *position, const float *normal,
						   const float *reflected)
{
	double square = 0.0;
	for (size_t i = 0; i < PIXELS; i++) {
		double from[3], d[3];
		for (size_t k = 0; k < 3; k++)
			from[k] = (double)position[4 * i + k] + w->surfels.origin[k];
		mirror((double[3]){ 0.8, 0, 0 }, from, normal + 4 * i, d);
		double off = (double)reflected[4 * i] - (2.0 + exit_z(from, d));
		square += off * off / PIXELS;
	}
	return sqrt(square);
}

/*
 * A mirror in a sphere of radiance 2 + z shows 2 + z where the mirrored ray meets the sphere. Of
 * what a ray finds there the discs within their radius are blended, whose radius is about 1.5
 * spacings of 0.025 m; that the sphere is made of planes moves the place where a grazing ray
 * meets it by no more than that. So the RMS error is below one radius, 0.04, of a radiance between
 * 1 and 3.
 */
static void mirror_shows_the_place(void **state)
{
	(void)state;
	static float position[4 * PIXELS], normal[4 * PIXELS], reflected[4 * PIXELS];
	gw_error error = { 0 };
	world w;
	open_world(&w, (field){ 2.0, 1.0 }, false);
	gw_pixels pixels = { .count = PIXELS, .position = position, .normal = normal };
	const gw_reflection how = { .rays = 1 };
	place_pixels(&w, &(ball){ RADIUS, 1.0f, 0.0f, 1.0f }, position, normal);
	set_eye(&w, &pixels);
	if (gw_render_octree_reflect(w.octree, &pixels, &how, reflected, &error) != GW_OK)
		fail_msg("%s", error.text);
	double rms = mirror_error(&w, position, normal, reflected);
	printf("mirror: RMS %.5f\n", rms);
	assert_true(rms < 0.04);
	close_world(&w);
}

/*
 * By probes it shows a texel of a map there. A map of 64 x 64 has texels of 4 pi / 64^2 sr, 0.055
 * rad wide, and probes see the sphere from no further than 2: the place is off by half a texel's
 * diagonal at most, 0.08, and by its RMS, a texel over the root of 6, 0.045, added to what rays are
 * off.
 */
static void probes_show_the_place(void **state)
{
	(void)state;
	static float position[4 * PIXELS], normal[4 * PIXELS], reflected[4 * PIXELS];
	gw_error error = { 0 };
	world w;
	const field linear = { 2.0, 1.0 };
	open_world(&w, linear, false);
	gw_probes *probes = make_probes(&w, linear, NULL);
	gw_pixels pixels = { .count = PIXELS, .position = position, .normal = normal };
	const gw_reflection how = { .rays = 1 };
	place_pixels(&w, &(ball){ RADIUS, 1.0f, 0.0f, 1.0f }, position, normal);
	set_eye(&w, &pixels);
	assert_ok(gw_probes_reflect(probes, w.surfels.origin, &pixels, &how, reflected, &error),
			  &error);
	double rms = mirror_error(&w, position, normal, reflected);
	printf("mirror, by %zu probes: RMS %.5f\n", probes->count, rms);
	assert_true(rms < 0.06);
	gw_probes_destroy(&probes);
	close_world(&w);
}

/*
 * One probe sees half of the space around the ball. Where a ray leaves what it sees, the octree
 * counts, so that all places are as near to the truth as where probes see all; without it many are
 * far off.
 */
static void what_no_probe_sees_is_traced(void **state)
{
	(void)state;
	static float position[4 * PIXELS], normal[4 * PIXELS], reflected[4 * PIXELS];
	static float again[4 * PIXELS];
	gw_error error = { 0 };
	world w;
	const field linear = { 2.0, 1.0 };
	gw_probes_options one = gw_probes_options_default();
	one.count = 1;
	open_world(&w, linear, false);
	gw_probes *probes = make_probes(&w, linear, &one);
	gw_pixels pixels = { .count = PIXELS, .position = position, .normal = normal };
	gw_reflection how = { .rays = 1 };
	assert_int_equal(probes->count, 1);
	place_pixels(&w, &(ball){ RADIUS, 1.0f, 0.0f, 1.0f }, position, normal);
	set_eye(&w, &pixels);
	assert_ok(gw_probes_reflect(probes, w.surfels.origin, &pixels, &how, reflected, &error),
			  &error);
	double without = mirror_error(&w, position, normal, reflected);
	how.octree = w.octree;
	assert_ok(gw_probes_reflect(probes, w.surfels.origin, &pixels, &how, reflected, &error),
			  &error);
	double rms = mirror_error(&w, position, normal, reflected);
	const gw_lost_rays sent = gw_render_octree_lost_rays(w.octree);
	printf("mirror, by one probe: RMS %.5f, %.5f where the %.1f %% that it loses are traced\n",
		   without, rms, 100.0 * (double)sent.traced / PIXELS);
	assert_int_equal(sent.rays, PIXELS);
	assert_true(sent.traced > 0 && sent.traced < PIXELS);
	assert_true(rms < 0.06 && without > 2.0 * rms);
	assert_ok(gw_probes_reflect(probes, w.surfels.origin, &pixels, &how, again, &error), &error);
	assert_memory_equal(reflected, again, sizeof again);
	gw_probes_destroy(&probes);
	close_world(&w);
}

#define MAP_WIDTH 64u
#define MAP_HEIGHT 32u

/* A sky whose radiance is linear in the direction that it is seen in: 2 plus each component. */
static void fill_sky(float *map, double turn, bool y_up)
{
	for (size_t i = 0; i < MAP_WIDTH * MAP_HEIGHT; i++) {
		double down = SCENE_PI * ((double)(i / MAP_WIDTH) + 0.5) / MAP_HEIGHT;
		double azimuth =
			2.0 * SCENE_PI * (((double)(i % MAP_WIDTH) + 0.5) / MAP_WIDTH - 0.5 + turn);
		double east = sin(down) * sin(azimuth), north = sin(down) * cos(azimuth);
		const double way[3] = { east, y_up ? cos(down) : north, y_up ? -north : cos(down) };
		for (size_t k = 0; k < 3; k++)
			map[3 * i + k] = (float)(2.0 + way[k]);
	}
}

/* What mirrors on a sphere that stands alone show of such a sky. Linear blending between texels 0.1
 * apart is off by at most 0.1^2 / 8 a component, and half a texel, 0.05, beside the poles. A cone
 * meets voxels of the sphere's own rim where it leaves at a grazing angle; those are left out. */
static void check_sky(world *w, double turn, bool y_up, bool cone)
{
	static float position[4 * PIXELS], normal[4 * PIXELS], reflected[4 * PIXELS];
	static float map[3 * MAP_WIDTH * MAP_HEIGHT];
	gw_error error = { 0 };
	gw_pixels pixels = { .count = PIXELS, .position = position, .normal = normal };
	const gw_reflection how = { .rays = 1, .cone = cone, .sky = { 1, 0, 0 } };
	const gw_light sky = { .type = GW_LIGHT_ENVIRONMENT,
						   .radiance = { 2, 2, 2 },
						   .map = map,
						   .map_width = MAP_WIDTH,
						   .map_height = MAP_HEIGHT,
						   .rotation = (float)(360.0 * turn),
						   .map_y_up = y_up };
	fill_sky(map, turn, y_up);
	assert_ok(gw_render_octree_set_sky(w->octree, &sky, &error), &error);
	place_pixels(w, &(ball){ RADIUS, 1.0f, 0.0f, 1.0f }, position, normal);
	set_eye(w, &pixels);
	assert_ok(gw_render_octree_reflect(w->octree, &pixels, &how, reflected, &error), &error);
	double square = 0.0, count = 0.0;
	for (size_t i = 0; i < PIXELS; i++) {
		double d[3], at[3], eye[3];
		for (size_t k = 0; k < 3; k++) {
			at[k] = (double)position[4 * i + k];
			eye[k] = (double)pixels.eye[k];
		}
		if (mirror(eye, at, normal + 4 * i, d) < 0.5)
			continue;
		for (size_t k = 0; k < 3; k++) {
			double off = (double)reflected[4 * i + k] - (k == 0 ? 1.0 : 0.0) - 2.0 * (2.0 + d[k]);
			square += off * off;
			if (!cone && !(fabs(off) < 0.11))
				fail_msg("pixel %zu is off by %g", i, off);
		}
		count += 3.0;
	}
	printf("sky turned by %g%s, %s: RMS %.5f\n", turn, y_up ? ", y up" : "", cone ? "cone" : "rays",
		   sqrt(square / count));
	assert_true(count > 1000.0 && sqrt(square / count) < 0.02);
}

static void mirror_shows_the_sky(void **state)
{
	(void)state;
	world w = { .octree = NULL };
	gw_error error = { 0 };
	scene_add_sphere(&w.scene, (double[3]){ 0, 0, 0 }, RADIUS, INNER, 1, 0.5f);
	make_octree(&w, (field){ 1.0, 0.0 }, true);
	for (int cone = 0; cone < 2; cone++) {
		check_sky(&w, 0.0, false, cone == 1);
		check_sky(&w, 0.3, false, cone == 1);
		check_sky(&w, 0.3, true, cone == 1);
	}
	assert_ok(gw_render_octree_set_sky(w.octree, NULL, &error), &error);
	close_world(&w);
}

/*
 * Both kinds of sampling reproduce a radiance linear in z. A voxel holds the mean over its own
 * leaf, whose discs reach beyond it by up to a radius, and is taken for its centre: at most half a
 * leaf off, 0.016 m, beside that half floats, 2^-11 of 3. The weights of a voxel are its area,
 * which changes where the surface cuts a corner of it: once more half a leaf. So the RMS error is
 * below a quarter of one.
 */
static void bricks_hold_a_linear_field(void **state)
{
	(void)state;
	static float position[4 * PIXELS], normal[4 * PIXELS], radiance[4 * PIXELS];
	gw_error error = { 0 };
	world w;
	open_world(&w, (field){ 2.0, 1.0 }, true);
	gw_pixels pixels = { .count = PIXELS, .position = position, .normal = normal };
	place_pixels(&w, &(ball){ 1.0, -1.0f, 0.0f, 0.0f }, position, normal);
	for (int k = 0; k < 3; k++)
		pixels.eye[k] = (float)-w.surfels.origin[k];
	for (int cubic = 0; cubic < 2; cubic++) {
		if (gw_render_octree_read(w.octree, &pixels, cubic == 1, radiance, &error) != GW_OK)
			fail_msg("%s", error.text);
		double square = 0.0, most = 0.0;
		for (size_t i = 0; i < PIXELS; i++) {
			double z = (double)position[4 * i + 2] + w.surfels.origin[2];
			double off = fabs((double)radiance[4 * i] - (2.0 + z));
			assert_true(radiance[4 * i + 3] > 0.0f);
			square += off * off / PIXELS;
			most = fmax(most, off);
		}
		printf("%s: RMS %.5f, largest %.5f, leaf %.4f m\n", cubic ? "tricubic" : "trilinear",
			   sqrt(square), most, (double)w.octree->octree.leaf_size);
		assert_true(sqrt(square) < 0.008 && most < 0.016);
	}
	close_world(&w);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(furnace_stays_white),           cmocka_unit_test(mirror_shows_the_place),
		cmocka_unit_test(probes_keep_the_furnace_white), cmocka_unit_test(probes_show_the_place),
		cmocka_unit_test(what_no_probe_sees_is_traced),  cmocka_unit_test(mirror_shows_the_sky),
		cmocka_unit_test(bricks_hold_a_linear_field),
	};
	/* How probes are traced by shaders is in test_shaders.c; they are read on the CPU. */
	const struct CMUnitTest by_shaders[] = {
		cmocka_unit_test(furnace_stays_white),
		cmocka_unit_test(mirror_shows_the_place),
		cmocka_unit_test(mirror_shows_the_sky),
		cmocka_unit_test(bricks_hold_a_linear_field),
	};
	if (scene_by_shaders())
		return cmocka_run_group_tests(by_shaders, NULL, NULL);
	return cmocka_run_group_tests(tests, NULL, NULL);
}

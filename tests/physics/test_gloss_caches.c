/* The glossy bounce by caches that pixels share: how pixels are clustered, surroundings of one
 * radiance, of which one half is dark, and rays. */
#include "scenes.h"
#include "picture/gloss_clusters.h"
#include "picture/render_octree.h"
#include "expected.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* Pictures of as many pixels, which all show something glossy. */
#define SIDE 48u
#define PIXELS (SIDE * SIDE)
#define STEP (1.0 / SIDE) /* they see 53 degrees */

/* A picture: its eye looks along -x. */
typedef struct picture {
	gw_pixels pixels;
	float position[4 * PIXELS], normal[4 * PIXELS];
	uint32_t place[PIXELS];
	double eye[3];
} picture;

static void open_picture(picture *p, const double eye[3], const double origin[3])
{
	memset(p, 0, sizeof *p);
	p->pixels = (gw_pixels){ .count = 0,
							 .position = p->position,
							 .normal = p->normal,
							 .place = p->place,
							 .width = SIDE,
							 .height = SIDE,
							 .step = (float)STEP };
	for (size_t k = 0; k < 3; k++) {
		p->eye[k] = eye[k];
		p->pixels.eye[k] = (float)(eye[k] - origin[k]);
	}
}

/* The way that a pixel looks, of length 1 along -x. */
static void way_of(uint32_t place, double way[3])
{
	way[0] = -1.0;
	way[1] = ((double)(place % SIDE) + 0.5 - 0.5 * SIDE) * STEP;
	way[2] = (0.5 * SIDE - (double)(place / SIDE) - 0.5) * STEP;
}

/* The pixel shows what is `depth` along x before the eye. */
static void add_pixel(picture *p, uint32_t place, double depth, const double normal[3],
					  const double origin[3])
{
	double way[3];
	size_t i = p->pixels.count++;
	way_of(place, way);
	for (size_t k = 0; k < 3; k++) {
		p->position[4 * i + k] = (float)(p->eye[k] + depth * way[k] - origin[k]);
		p->normal[4 * i + k] = (float)normal[k];
	}
	p->place[i] = place;
}

static void set_surface(picture *p, float roughness, float reflectance)
{
	for (size_t i = 0; i < p->pixels.count; i++) {
		p->position[4 * i + 3] = roughness;
		p->normal[4 * i + 3] = reflectance;
	}
}

/* ------------------------------------------------------------------------------------ clusters */

static const double zero[3] = { 0 }, towards[3] = { 1, 0, 0 };

static gw_gloss_clusters cluster(const picture *p)
{
	gw_gloss_clusters clusters;
	gw_error error = { 0 };
	assert_ok(gw_gloss_clusters_make(&p->pixels, 100000, &clusters, &error), &error);
	assert_int_equal(clusters.columns, (SIDE + GW_GLOSS_TILE - 1) / GW_GLOSS_TILE);
	const uint32_t *first = clusters.tile_first;
	assert_int_equal(first[0], 0);
	assert_int_equal(first[clusters.columns * clusters.rows], clusters.count);
	/* Each pixel is in a cluster of its tile, and so is who speaks for it. */
	for (size_t i = 0; i < p->pixels.count; i++) {
		uint32_t x = p->place[i] % SIDE / clusters.tile, y = p->place[i] / SIDE / clusters.tile;
		uint32_t tile = y * clusters.columns + x, own = clusters.cluster_of[i];
		assert_true(own >= first[tile] && own < first[tile + 1]);
		assert_int_equal(clusters.cluster_of[clusters.representative[own]], own);
	}
	return clusters;
}

/* A wall that is looked at is one cluster a tile; of two that meet in the middle tile's middle,
 * that tile has two; and so it has where one ends before the other. Nothing has none, one pixel
 * one. */
static void clusters_follow_surface(void **state)
{
	static picture p;
	const double left[3] = { M_SQRT1_2, M_SQRT1_2, 0 }, right[3] = { M_SQRT1_2, -M_SQRT1_2, 0 };
	const double eye[3] = { 1, 0, 0 };
	(void)state;
	for (int what = 0; what < 5; what++) {
		size_t tiles = (SIDE / GW_GLOSS_TILE) * (SIDE / GW_GLOSS_TILE);
		size_t column = SIDE / GW_GLOSS_TILE;
		const size_t expected[] = { tiles, tiles + column, tiles + column, 0, 1 };
		open_picture(&p, eye, zero);
		for (uint32_t i = 0; i < PIXELS && what != 3; i++) {
			bool first = i % SIDE < SIDE / 2;
			const double *normal = what != 1 ? towards : first ? left : right;
			add_pixel(&p, i, what == 2 && first ? 0.3 : 1.0, normal, zero);
			if (what == 4)
				break;
		}
		set_surface(&p, 0.5f, 0.5f);
		gw_gloss_clusters clusters = cluster(&p);
		assert_int_equal(clusters.count, expected[what]);
		gw_gloss_clusters_clear(&clusters);
	}
}

/* --------------------------------------------------------------------------------------- light */

#define OUTER 20000 /* points of the sphere of radius 1, seen from inside */

typedef struct world {
	scene scene;
	gw_surfels surfels;
	gw_render_octree *octree;
} world;

/* A sphere whose radiance is mean + slope * z; or 1 above, and 0 below, for a slope of infinity. */
static void open_world(world *w, double mean, double slope)
{
	gw_error error = { 0 };
	gw_surfels_options options = { .threads = 0 };
	gw_render_octree_options how = { .depth = GW_DEPTH_AUTO, .leaf_spacing = GW_LEAF_SPACING };
	*w = (world){ .octree = NULL };
	scene_add_sphere(&w->scene, (double[3]){ 0, 0, 0 }, 1.0, OUTER, -1, 0.5f);
	const gw_points points = scene_points(&w->scene);
	assert_ok(gw_surfels_make(&points, &options, &w->surfels, &error), &error);
	float *radiance = calloc(w->surfels.count, 3 * sizeof *radiance);
	assert_non_null(radiance);
	for (size_t i = 0; i < 3 * w->surfels.count; i++) {
		double z = (double)w->surfels.position[i / 3 * 3 + 2] + w->surfels.origin[2];
		radiance[i] = (float)(isinf(slope) ? z > 0.0 : mean + slope * z);
	}
	scene_choose_passes(&how.passes, &how.validate);
	assert_ok(gw_render_octree_create(&w->surfels, radiance, &how, &w->octree, &error), &error);
	free(radiance);
}

static void close_world(world *w)
{
	gw_render_octree_destroy(&w->octree);
	gw_surfels_clear(&w->surfels);
	scene_clear(&w->scene);
}

/* A picture of a small plane in the middle, at right angles to the eye's way. */
static void show_plane(const world *w, picture *p, float roughness, float reflectance)
{
	open_picture(p, (double[3]){ 0.5, 0, 0 }, w->surfels.origin);
	for (uint32_t i = 0; i < PIXELS; i++)
		add_pixel(p, i, 0.5, towards, w->surfels.origin);
	set_surface(p, roughness, reflectance);
}

static void reflect(const world *w, const picture *p, const gw_reflection *how, float *reflected)
{
	gw_error error = { 0 };
	assert_ok(gw_render_octree_reflect(w->octree, &p->pixels, how, reflected, &error), &error);
}

static const gw_reflection by_caches = { .rays = 32, .caches = true };

/*
 * In a sphere of radiance 1 each pixel reflects the share of light that is reflected. Of the rays
 * 0.1 % slip between planes (see passes.c), which see black, and a look reads four texels of six
 * caches at least: no more than a few in a hundred are missing anywhere.
 */
static void furnace_stays_white(void **state)
{
	static picture p;
	static float reflected[4 * PIXELS];
	static const float roughness[] = { 0.3f, 0.5f, 0.8f, 1.0f };
	world w;
	(void)state;
	open_world(&w, 1.0, 0.0);
	for (size_t r = 0; r < 8; r++) {
		float reflectance = r < 4 ? 0.04f : 1.0f;
		show_plane(&w, &p, roughness[r % 4], reflectance);
		reflect(&w, &p, &by_caches, reflected);
		double mean = 0.0;
		for (size_t i = 0; i < PIXELS; i++) {
			float share = reflected[4 * i + 3];
			assert_true(share >= reflectance - 1e-6f && share <= 1.0f + 1e-6f);
			assert_true(fabsf(reflected[4 * i] - share) <= 0.05f * share);
			mean += (double)(reflected[4 * i] / share) / PIXELS;
		}
		print_message("furnace, roughness %g, reflectance %g: %.5f\n", (double)roughness[r % 4],
					  (double)reflectance, mean);
		assert_true(fabs(mean - 1.0) <= 0.001 + 1e-5);
	}
	close_world(&w);
}

/*
 * Where the upper half is bright, the picture, which is the same turned upside down, has half of
 * the share in the mean, however rough. The edge of the light is a spacing of the points wide,
 * 0.025; its place is off by no more than that, of the half turn that is seen, at the narrowest
 * lobe, whose density there is the sine's half width 0.2: 0.025 / 0.2 / 2 / sqrt(48) rows of
 * pixels.
 */
static void half_is_half(void **state)
{
	static picture p;
	static float reflected[4 * PIXELS];
	world w;
	(void)state;
	open_world(&w, 0.0, INFINITY);
	for (float roughness = 0.3f; roughness < 1.1f; roughness += 0.35f) {
		show_plane(&w, &p, roughness, 1.0f);
		reflect(&w, &p, &by_caches, reflected);
		double mean = 0.0, upper = 0.0;
		for (size_t i = 0; i < PIXELS; i++) {
			mean += (double)reflected[4 * i] / PIXELS;
			upper += i < PIXELS / 2 ? (double)reflected[4 * i] * 2.0 / PIXELS : 0.0;
		}
		print_message("half bright, roughness %g: %.4f, upper half %.4f\n", (double)roughness, mean,
					  upper);
		assert_true(fabs(mean - 0.5) < 0.025 / 0.2 / 2.0 / sqrt(48.0));
		assert_true(upper > 0.55); /* what is seen from above the middle looks up */
	}
	close_world(&w);
}

static double rms(const float *a, const float *b)
{
	double square = 0.0;
	for (size_t i = 0; i < PIXELS; i++)
		square += pow((double)a[4 * i] - (double)b[4 * i], 2.0) / PIXELS;
	return sqrt(square);
}

/*
 * In the half-bright sphere caches are nearer to many rays than 32 rays are, at every roughness, by
 * a quarter at least.
 * The reference itself is off by what 32 rays are over the root of how many times more it has.
 */
static void nearer_than_rays(void **state)
{
	enum { MANY = 256 };
	static picture p;
	static float caches[4 * PIXELS], few[4 * PIXELS], many[4 * PIXELS];
	const gw_reflection by_rays = { .rays = 32, .seed = 1 }, reference = { .rays = MANY };
	world w;
	(void)state;
	open_world(&w, 0.0, INFINITY);
	for (float roughness = 0.35f; roughness < 1.1f; roughness += 0.65f) {
		show_plane(&w, &p, roughness, 1.0f);
		for (size_t i = 0; i < PIXELS; i += 5) /* some of them */
			p.pixels.count = i / 5 + 1;
		for (size_t i = 0; i < p.pixels.count; i++) {
			memmove(p.position + 4 * i, p.position + 20 * i, 4 * sizeof(float));
			memmove(p.normal + 4 * i, p.normal + 20 * i, 4 * sizeof(float));
			p.place[i] = p.place[5 * i];
		}
		reflect(&w, &p, &by_caches, caches);
		reflect(&w, &p, &by_rays, few);
		reflect(&w, &p, &reference, many);
		double off = rms(caches, many), noise = rms(few, many);
		print_message("roughness %g: caches %.4f, 32 rays %.4f\n", (double)roughness, off, noise);
		assert_true(off < 0.75 * noise);
	}
	close_world(&w);
}

/* Mirrors take rays, whatever else is asked for; and who has no picture is told so. */
static void mirrors_take_rays(void **state)
{
	static picture p;
	static float caches[4 * PIXELS], rays[4 * PIXELS];
	const gw_reflection by_rays = { .rays = 32 };
	gw_error error = { 0 };
	world w;
	(void)state;
	open_world(&w, 2.0, 1.0);
	show_plane(&w, &p, 0.0f, 0.5f);
	reflect(&w, &p, &by_caches, caches);
	reflect(&w, &p, &by_rays, rays);
	assert_memory_equal(caches, rays, sizeof rays);
	/* Every other pixel is rough: the others still show what they did, whatever lies between. */
	for (size_t i = 0; i < PIXELS; i += 2)
		p.position[4 * i + 3] = 0.6f;
	reflect(&w, &p, &by_caches, caches);
	for (size_t i = 0; i < PIXELS; i++)
		if (i % 2 != 0)
			assert_memory_equal(caches + 4 * i, rays + 4 * i, 4 * sizeof *rays);
		else
			assert_true(caches[4 * i] != rays[4 * i]);
	p.pixels.place = NULL;
	assert_int_equal(gw_render_octree_reflect(w.octree, &p.pixels, &by_caches, caches, &error),
					 GW_ERROR_USAGE);
	close_world(&w);
}

/* None, and one; and any number of threads gives the same bytes. */
static void few_pixels_and_threads(void **state)
{
	static picture p;
	static float one[4 * PIXELS], three[4 * PIXELS];
	world w;
	(void)state;
	open_world(&w, 1.0, 0.0);
	show_plane(&w, &p, 0.5f, 0.5f);
	w.octree->passes.threads = 1;
	reflect(&w, &p, &by_caches, one);
	w.octree->passes.threads = 3;
	reflect(&w, &p, &by_caches, three);
	assert_memory_equal(one, three, sizeof one);
	p.pixels.count = 1;
	reflect(&w, &p, &by_caches, one);
	assert_true(fabsf(one[0] - one[3]) <= 0.05f * one[3]);
	p.pixels.count = 0;
	one[0] = 7.0f;
	reflect(&w, &p, &by_caches, one);
	assert_true(one[0] == 7.0f);
	close_world(&w);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(clusters_follow_surface),
		cmocka_unit_test(furnace_stays_white),
		cmocka_unit_test(half_is_half),
		cmocka_unit_test(nearer_than_rays),
		cmocka_unit_test(mirrors_take_rays),
		cmocka_unit_test(few_pixels_and_threads),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

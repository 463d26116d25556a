/*
 * bench_probes.c - chosen probes beside regular grids: how many, how much of the surface they see,
 * and how far reflections read from their maps are from traced ones.
 *
 *   bench_probes [-s SIZE] SCENE...
 *
 * Prints a line of a table for each arrangement: probes; percent of the surface that they see;
 * the RMS difference of mirror reflections at 32,000 places relative to their mean, over all and
 * without the worst hundredth, percent; texels that a ray looks at with smaller maps and without;
 * percent of the rays that every probe loses.
 */
#include "glowworm_picture.h"
#include "glowworm_probes.h"
#include "options/settings.h"
#include "scene/loaded_scene.h"
#include "scene/scene_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define EYES 8u      /* from which mirrors are looked at */
#define PLACES 4000u /* mirrors for each */

/* All that lasts as long as a scene is measured. */
typedef struct bench {
	const char *name;
	uint32_t size; /* texels a side of the maps */
	settings settings;
	loaded_scene loaded;
	gw_light *light;
	gw_scene *scene;
	gw_lighting *lighting;
	gw_surfels surfels;
	gw_render_octree *octree;
	gw_probes *eyes;
	size_t *surfel;   /* EYES * PLACES */
	float *reflected; /* 4 a place: traced */
	gw_error error;
} bench;

/* ---------------------------------------------------------------------------------- the scene */

static gw_status load(bench *b)
{
	settings_input input = { .path = (char *)(uintptr_t)b->name };
	b->settings = settings_default();
	GW_TRY(settings_add_input(&b->settings, &input, &b->error));
	GW_TRY(scene_read_all(&b->settings, &b->error));
	GW_TRY(loaded_scene_read(&b->settings, &b->loaded, &b->error));
	return loaded_scene_lights(&b->loaded, &b->settings, &b->light, &b->error);
}

static gw_status light(bench *b)
{
	gw_bake_options options = gw_bake_options_default();
	const gw_scene_description description = { &b->loaded.points.points, b->light,
											   b->settings.light_count };
	options.estimate_points = 0;
	options.effects_forced |= 1u << GW_EFFECT_OCTREE;
	GW_TRY(gw_scene_create(&description, &options, NULL, &b->scene, &b->error));
	return gw_lighting_create(b->scene, b->light, b->settings.light_count, &b->lighting, &b->error);
}

/* The octree that mirrors are traced in, with the light of the points. */
static gw_status grow_octree(bench *b)
{
	const gw_surfels_options how = { .rough_area = false };
	const gw_render_octree_options options = { .leaf_spacing = b->settings.bake.leaf_spacing };
	GW_TRY(gw_surfels_make(&b->loaded.points.points, &how, &b->surfels, &b->error));
	float *of_points = calloc(b->surfels.point_count, 3 * sizeof *of_points);
	float *radiance = calloc(b->surfels.count, 3 * sizeof *radiance);
	gw_status status = of_points && radiance
						   ? gw_lighting_radiance(b->lighting, of_points, &b->error)
						   : gw_fail(&b->error, GW_ERROR_MEMORY, "no memory for the light");
	for (size_t i = 0; status == GW_OK && i < b->surfels.point_count; i++)
		if (b->surfels.surfel_of_point[i] != UINT32_MAX)
			memcpy(radiance + 3 * (size_t)b->surfels.surfel_of_point[i], of_points + 3 * i,
				   3 * sizeof *radiance);
	if (status == GW_OK)
		status = gw_render_octree_create(&b->surfels, radiance, &options, &b->octree, &b->error);
	free(of_points);
	free(radiance);
	return status;
}

/* -------------------------------------------------------------------------------- the mirrors */

/* The normal of a mirror, towards the eye; false where it is seen from behind or edge-on. */
static bool faces(const bench *b, size_t surfel, const double eye[3], float way[3])
{
	const float *n = b->surfels.normal + 3 * surfel;
	double to[3], length = 0.0, cosine = 0.0;
	for (size_t k = 0; k < 3; k++) {
		to[k] = eye[k] - b->surfels.origin[k] - (double)b->surfels.position[3 * surfel + k];
		length += to[k] * to[k];
		cosine += to[k] * (double)n[k];
	}
	cosine /= sqrt(length);
	for (size_t k = 0; k < 3; k++)
		way[k] = (float)(2.0 * cosine * (double)n[k] - to[k] / sqrt(length));
	return cosine > 0.1;
}

/* Mirrors all over the surface that face one eye, and what they reflect. */
static gw_status trace_mirrors(bench *b, size_t e, uint32_t *state)
{
	const double *eye = b->eyes->probe[e % b->eyes->count].position;
	const gw_reflection mirror = { .rays = 1 };
	float position[4 * PLACES], normal[4 * PLACES], way[3];
	gw_pixels pixels = { .count = PLACES, .position = position, .normal = normal };
	for (int k = 0; k < 3; k++)
		pixels.eye[k] = (float)(eye[k] - b->surfels.origin[k]);
	for (size_t i = 0; i < PLACES;) {
		*state = *state * 1664525u + 1013904223u;
		const size_t surfel = (size_t)((double)*state / 4294967296.0 * (double)b->surfels.count);
		if (!faces(b, surfel, eye, way))
			continue;
		b->surfel[e * PLACES + i] = surfel;
		memcpy(position + 4 * i, b->surfels.position + 3 * surfel, 3 * sizeof *position);
		memcpy(normal + 4 * i, b->surfels.normal + 3 * surfel, 3 * sizeof *normal);
		position[4 * i + 3] = 0.0f;
		normal[4 * i++ + 3] = 1.0f;
	}
	return gw_render_octree_reflect(b->octree, &pixels, &mirror, b->reflected + 4 * e * PLACES,
									&b->error);
}

static gw_status make_mirrors(bench *b)
{
	gw_probes_options options = gw_probes_options_default();
	uint32_t state = 1;
	options.grid = 2;
	options.size = 8;
	b->surfel = calloc(EYES * PLACES, sizeof *b->surfel);
	b->reflected = calloc(EYES * PLACES, 4 * sizeof *b->reflected);
	if (!b->surfel || !b->reflected)
		return gw_fail(&b->error, GW_ERROR_MEMORY, "no memory for mirrors");
	GW_TRY(gw_probes_make(b->lighting, &options, &b->eyes, &b->error));
	for (size_t e = 0; e < EYES; e++)
		GW_TRY(trace_mirrors(b, e, &state));
	return GW_OK;
}

/* -------------------------------------------------------------------------------- the figures */

static double luminance(const float rgb[3])
{
	return 0.2126 * (double)rgb[0] + 0.7152 * (double)rgb[1] + 0.0722 * (double)rgb[2];
}

static gw_status tell(bench *b, const gw_probes *p, const char *what)
{
	double *found = calloc(EYES * PLACES, 2 * sizeof *found), *truth = found + EYES * PLACES;
	double steps[2] = { 0.0 }, lost = 0.0;
	gw_comparison c;
	if (!found)
		return gw_fail(&b->error, GW_ERROR_MEMORY, "no memory for %u mirrors", EYES * PLACES);
	for (size_t i = 0; i < EYES * PLACES; i++) {
		gw_probe_look look;
		double from[3];
		float way[3];
		faces(b, b->surfel[i], b->eyes->probe[i / PLACES % b->eyes->count].position, way);
		for (size_t k = 0; k < 3; k++)
			from[k] = b->surfels.origin[k] + (double)b->surfels.position[3 * b->surfel[i] + k];
		gw_probes_look(p, from, way, false, &look);
		steps[1] += look.steps;
		gw_probes_look(p, from, way, true, &look);
		steps[0] += look.steps;
		lost += look.probe < 0;
		found[i] = luminance(look.radiance);
		truth[i] = luminance(b->reflected + 4 * i);
	}
	gw_status status = gw_compare(found, truth, EYES * PLACES, &c, &b->error);
	if (status == GW_OK)
		printf("| %s | %zu | %.1f | %.1f, %.1f | %.1f | %.1f | %.1f |\n", what, p->count,
			   100.0 * p->seen, 100.0 * c.rel_rmse, 100.0 * c.best_99, steps[0] / (EYES * PLACES),
			   steps[1] / (EYES * PLACES), 100.0 * lost / (EYES * PLACES));
	fflush(stdout);
	free(found);
	return status;
}

static gw_status arrange(bench *b, uint32_t grid)
{
	gw_probes_options options = gw_probes_options_default();
	gw_probes *probes = NULL;
	char what[64] = "chosen";
	options.grid = grid;
	options.size = b->size;
	if (grid > 0)
		snprintf(what, sizeof what, "grid %u x %u x %u", grid, grid, grid);
	gw_status status = gw_probes_make(b->lighting, &options, &probes, &b->error);
	if (status == GW_OK)
		status = tell(b, probes, what);
	gw_probes_destroy(&probes);
	return status;
}

static gw_status run(bench *b)
{
	GW_TRY(load(b));
	GW_TRY(light(b));
	GW_TRY(grow_octree(b));
	GW_TRY(make_mirrors(b));
	const char *slash = strrchr(b->name, '/');
	printf(
		"%s\n\n| | probes | seen | gloss | steps | without | lost |\n|---|---|---|---|---|---|---|"
		"\n",
		slash ? slash + 1 : b->name);
	for (uint32_t grid = 0; grid <= 4; grid++)
		if (grid != 1)
			GW_TRY(arrange(b, grid));
	printf("\n");
	return GW_OK;
}

static void clear(bench *b)
{
	gw_probes_destroy(&b->eyes);
	gw_render_octree_destroy(&b->octree);
	gw_surfels_clear(&b->surfels);
	gw_lighting_destroy(&b->lighting);
	gw_scene_destroy(&b->scene);
	loaded_scene_clear(&b->loaded);
	settings_clear(&b->settings);
	free(b->light);
	free(b->surfel);
	free(b->reflected);
}

int main(int argc, char **argv)
{
	int failed = 0, first = 1;
	uint32_t size = gw_probes_options_default().size;
	if (argc > 2 && strcmp(argv[1], "-s") == 0) {
		size = (uint32_t)strtoul(argv[2], NULL, 10);
		first = 3;
	}
	for (int i = first; i < argc; i++) {
		bench b = { .name = argv[i], .size = size };
		if (run(&b) != GW_OK) {
			fprintf(stderr, "bench_probes: %s: %s\n", argv[i], b.error.text);
			failed++;
		}
		clear(&b);
	}
	return failed > 0;
}

#include "pictures/lit_probes.h"
#include "pictures/scene_octree.h"
#include "program/signals.h"

#include <math.h>
#include <stdlib.h>

/* Share of the longest side by which probes may stand outside the bounds: beside what is open. */
#define MARGIN 0.25f

/* Leaf cells between places where light is gathered that nothing reflects. */
#define WIDEST_SPACING 64.0f

/* The surfels as points of their own that glow as they are lit, and reflect nothing. */
typedef struct glowing_points {
	gw_points points;
	double *position;
	float *albedo, *emission;
} glowing_points;

static bool is_cancelled(void *user)
{
	(void)user;
	return signals_pending() != 0;
}

static gw_status make_points(const render_scene *scene, glowing_points *g, gw_error *error)
{
	const gw_surfels *s = &scene->surfels;
	*g = (glowing_points){ .position = calloc(s->count, 3 * sizeof *g->position),
						   .albedo = calloc(s->count, 3 * sizeof *g->albedo),
						   .emission = scene_octree_radiance(scene) };
	if (!g->position || !g->albedo || !g->emission)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the light of %zu points", s->count);
	for (size_t i = 0; i < 3 * s->count; i++)
		g->position[i] = s->origin[i % 3] + (double)s->position[i];
	g->points = (gw_points){ .count = s->count,
							 .position = g->position,
							 .normal = s->normal,
							 .albedo = g->albedo,
							 .emission = g->emission };
	return GW_OK;
}

static void clear_points(glowing_points *g)
{
	free(g->position);
	free(g->albedo);
	free(g->emission);
}

/* Skies as lights: the map, or what all even ones send together. */
static size_t list_skies(const sky_light *sky, gw_light light[1])
{
	light[0] = sky->light;
	if (!sky->has_map)
		light[0] = (gw_light){ .type = GW_LIGHT_ENVIRONMENT };
	bool even = false;
	for (int c = 0; c < 3 && !sky->has_map; c++) {
		light[0].radiance[c] = sky->radiance[c];
		even = even || sky->radiance[c] > 0.0f;
	}
	return sky->has_map || even;
}

static gw_status place(gw_scene *scene, const gw_light *light, size_t count,
					   const gw_probes_options *options, gw_probes **probes, gw_error *error)
{
	gw_lighting *lighting = NULL;
	GW_TRY(gw_lighting_create(scene, light, count, &lighting, error));
	gw_status status = gw_probes_make(lighting, options, probes, error);
	gw_lighting_destroy(&lighting);
	return status;
}

/* A bake in which probes see the sky, since something may reflect it, but as little as can be is
 * gathered: nothing reflects here. */
static gw_bake_options light_nothing(const settings *s)
{
	gw_bake_options options = s->bake;
	options.bounces = 1;
	options.rays = 1;
	options.record_spacing = WIDEST_SPACING;
	options.least_records = 0;
	options.estimate_points = 0;
	options.method = GW_METHOD_RAYS;
	options.normals = GW_NORMALS_GIVEN;
	options.effects_forced |= 1u << GW_EFFECT_OCTREE;
	return options;
}

static gw_probes_options choose_options(const settings *s, const gw_surfels *surfels)
{
	gw_probes_options options = gw_probes_options_default();
	float longest = 0.0f;
	for (int k = 0; k < 3; k++)
		longest = fmaxf(longest, surfels->maximum[k] - surfels->minimum[k]);
	options.size = s->bake.probe_size;
	options.margin = MARGIN * longest;
	return options;
}

gw_status lit_probes_make(const settings *s, const render_scene *scene, const sky_light *sky,
						  gw_probes **probes, gw_error *error)
{
	const gw_bake_options options = light_nothing(s);
	const gw_probes_options placing = choose_options(s, &scene->surfels);
	const gw_bake_callbacks callbacks = { NULL, is_cancelled, NULL, NULL };
	glowing_points glowing;
	gw_light light[1];
	gw_scene *prepared = NULL;
	size_t count = list_skies(sky, light);
	*probes = NULL;
	gw_status status = make_points(scene, &glowing, error);
	const gw_scene_description description = { &glowing.points, light, count };
	if (status == GW_OK)
		status = gw_scene_create(&description, &options, &callbacks, &prepared, error);
	if (status == GW_OK)
		status = place(prepared, light, count, &placing, probes, error);
	gw_scene_destroy(&prepared);
	clear_points(&glowing);
	return status;
}

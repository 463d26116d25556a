/*
 * scaled_scene.c - see scaled_scene.h.
 */
#include "bake/scaled_scene.h"
#include "glowworm_host.h"

#include "base/memory.h"
#include "cloud/cloud_units.h"
#include "cloud/frame.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

/* Light beyond these is brought to about 1. */
#define LIGHT_LEAST 0x1p-60
#define LIGHT_MOST 0x1p60

/* Squares of a lamp's widths beyond these, and flux over them, are more than float32 holds. */
#define LAMP_LEAST 1e-6
#define LAMP_MOST 1e12

/* Lamps farther off than 2^24 times a scaled scene's extent are brought to about there: they move
 * by less than a float32 tells directions to all of its points apart. */
#define FAR 24

/* Largest distance that options take, metres. */
#define DISTANCE_MOST 1e9f

typedef struct box {
	double low[3], high[3], extent;
} box;

static double largest(const float color[3])
{
	double most = 0.0;
	for (int k = 0; k < 3; k++)
		if (isfinite(color[k]))
			most = fmax(most, (double)color[k]);
	return most;
}

static double squared_distance(const box *b, const double place[3])
{
	double squared = 0.0;
	for (int k = 0; k < 3; k++) {
		double off = fmax(fmax(b->low[k] - place[k], place[k] - b->high[k]), 0.0);
		squared += off * off;
	}
	return squared;
}

/* About the most irradiance that a light can bring. */
static double brightness(const gw_light *light, const box *b)
{
	switch (light->type) {
	case GW_LIGHT_POINT:
	case GW_LIGHT_SPOT:
	case GW_LIGHT_SPHERE:
	case GW_LIGHT_DISC:
	case GW_LIGHT_RECTANGLE:
		/* Divided in two steps: squares of small extents are 0. */
		return largest(light->intensity) /
			   fmax(sqrt(squared_distance(b, light->position)), b->extent) /
			   fmax(sqrt(squared_distance(b, light->position)), b->extent);
	case GW_LIGHT_SUN:
		return largest(light->irradiance);
	case GW_LIGHT_ENVIRONMENT:
		return largest(light->radiance);
	default:
		return 0.0;
	}
}

static double brightest(const gw_scene_description *scene, const box *b)
{
	const gw_points *points = scene->points;
	double most = 0.0;
	for (size_t i = 0; i < scene->light_count; i++)
		most = fmax(most, brightness(&scene->lights[i], b));
	for (size_t i = 0; points->emission && i < points->count; i++)
		most = fmax(most, largest(points->emission + 3 * i));
	return most;
}

static void choose_units(const gw_scene_description *scene, double reach, gw_scaled_scene *scaled)
{
	box b = { .extent = 0.0 };
	if (gw_finite_bounds(scene->points, b.low, b.high) == 0)
		return;
	b.extent = fmax(gw_cloud_extent(scene->points), reach);
	if (!(b.extent > 0.0))
		return;
	scaled->length = gw_length_exponent(b.extent);
	scaled->extent = ilogb(b.extent);
	for (int k = 0; k < 3; k++)
		scaled->middle[k] = 0.5 * b.low[k] + 0.5 * b.high[k];
	double most = brightest(scene, &b);
	if (!isfinite(most)) /* more than a double holds */
		scaled->light = -1024;
	else if (most > LIGHT_MOST || (most > 0.0 && most < LIGHT_LEAST))
		scaled->light = -ilogb(most);
}

static float *scaled_light(const float *color, size_t count, int exponent)
{
	float *copy = gw_allocate_array(3 * count, sizeof *copy);
	for (size_t i = 0; copy && i < 3 * count; i++)
		copy[i] = ldexpf(color[i], exponent);
	return copy;
}

/* Areas; of those too small for a float32, which only a thing by itself has, the least that is. */
static float *scaled_areas(const float *area, size_t count, int exponent)
{
	float *copy = gw_allocate_array(count, sizeof *copy);
	for (size_t i = 0; copy && i < count; i++)
		copy[i] = area[i] > 0.0f ? fmaxf(ldexpf(area[i], exponent), FLT_MIN) : 0.0f;
	return copy;
}

/* Instances, whose matrices move by lengths. */
static gw_object_instance *scaled_instances(const gw_object_instance *instance, size_t count,
											int exponent)
{
	gw_object_instance *copy = gw_allocate_array(count, sizeof *copy);
	for (size_t i = 0; copy && i < count; i++) {
		copy[i] = instance[i];
		for (size_t row = 0; row < 3; row++)
			copy[i].matrix[4 * row + 3] = ldexp(instance[i].matrix[4 * row + 3], exponent);
	}
	return copy;
}

/* The power of two by which a lamp is too far off. */
static int excess_of_distance(const gw_light *light, const gw_scaled_scene *scaled)
{
	double distance = 0.0;
	for (int k = 0; k < 3; k++)
		distance = fmax(distance, fabs(light->position[k] - scaled->middle[k]));
	if (scaled->length == 0 || !(distance > 0.0) || !isfinite(distance))
		return 0;
	int excess = ilogb(distance) - scaled->extent - FAR;
	return excess > 0 ? excess : 0;
}

static void scale_light(gw_light *light, const gw_scaled_scene *scaled)
{
	int nearer = excess_of_distance(light, scaled), length = scaled->length - nearer;
	light->radius = ldexpf(light->radius, length);
	for (int k = 0; k < 2; k++)
		light->size[k] = ldexpf(light->size[k], length);
	for (int k = 0; k < 3; k++) {
		double middle = nearer > 0 ? scaled->middle[k] : 0.0;
		light->position[k] =
			ldexp(light->position[k] - middle, length) + ldexp(middle, scaled->length);
		light->intensity[k] = ldexpf(light->intensity[k], 2 * length + scaled->light);
		light->irradiance[k] = ldexpf(light->irradiance[k], scaled->light);
		light->radiance[k] = ldexpf(light->radiance[k], scaled->light);
	}
}

static gw_status fail_bright(gw_error *error)
{
	return gw_fail(error, GW_ERROR_DATA,
				   "the light on the points is more than 3.4e38, which is all that a 32-bit "
				   "number holds: use weaker lamps, or check the unit of lengths");
}

/* Lamps that shine on things of 1e-300 m from as near are beyond all numbers. */
static bool is_finite_light(const gw_light *light)
{
	const float *color = light->type == GW_LIGHT_SUN           ? light->irradiance
						 : light->type == GW_LIGHT_ENVIRONMENT ? light->radiance
															   : light->intensity;
	return isfinite(color[0]) && isfinite(color[1]) && isfinite(color[2]);
}

static bool is_width(float width)
{
	return (double)width >= LAMP_LEAST && (double)width <= LAMP_MOST;
}

/* A lamp that is a point has none. */
static bool has_sound_width(const gw_light *light)
{
	if (light->type == GW_LIGHT_RECTANGLE)
		return is_width(light->size[0]) && is_width(light->size[1]);
	bool lamp = light->type != GW_LIGHT_SUN && light->type != GW_LIGHT_ENVIRONMENT;
	return !lamp || light->radius == 0.0f || is_width(light->radius);
}

static gw_status check_widths(const gw_light *lights, size_t count, gw_error *error)
{
	for (size_t i = 0; i < count; i++)
		if (!has_sound_width(&lights[i]))
			return gw_fail(error, GW_ERROR_USAGE,
						   "light %zu is so narrow or so wide beside the scene that 32-bit numbers "
						   "do not hold both: give it another radius or size, or none",
						   i + 1);
	return GW_OK;
}

gw_status gw_scaled_lights(const gw_scaled_scene *scaled, const gw_light *lights, size_t count,
						   gw_light **copy, gw_error *error)
{
	bool fit = true;
	gw_light *own = gw_allocate_array(count, sizeof *own);
	*copy = NULL;
	if (!own)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu lights", count);
	for (size_t i = 0; i < count; i++) {
		own[i] = lights[i];
		scale_light(&own[i], scaled);
		fit = fit && is_finite_light(&own[i]);
	}
	gw_status status = fit ? check_widths(own, count, error) : fail_bright(error);
	if (status != GW_OK) {
		free(own);
		return status;
	}
	*copy = own;
	return GW_OK;
}

float *gw_scaled_emission(const gw_scaled_scene *scaled, const float *emission, size_t count)
{
	return scaled_light(emission, count, scaled->light);
}

/* Counts the points that are invisible, and those that are less than opaque. */
static gw_status count_clear(const gw_points *points, size_t *invisible, size_t *clear,
							 gw_error *error)
{
	*invisible = *clear = 0;
	for (size_t i = 0; points->opacity && i < points->count; i++) {
		float opacity = points->opacity[i];
		if (!(opacity >= 0.0f && opacity <= 1.0f))
			return gw_fail(error, GW_ERROR_DATA,
						   "the opacity of point %zu is %s: it is a share, from 0 to 1", i,
						   GW_SAID((double)opacity, 6));
		*invisible += !(opacity > 0.0f);
		*clear += opacity < 1.0f;
	}
	if (points->count > 0 && *invisible == points->count)
		return gw_fail(error, GW_ERROR_DATA,
					   "all %zu points are invisible, of opacity 0: there is nothing to light",
					   points->count);
	return GW_OK;
}

/* Leaves out what is invisible, and opacities where all is opaque. */
static gw_status take_opacity(gw_scaled_scene *scaled, gw_error *error)
{
	gw_points *p = &scaled->points;
	size_t invisible, clear;
	GW_TRY(count_clear(p, &invisible, &clear, error));
	if (clear == 0 && p->opacity)
		p->opacity = NULL;
	if (invisible == 0)
		return GW_OK;
	scaled->visible = gw_allocate_array(3 * p->count, sizeof *scaled->visible);
	if (!scaled->visible)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu points", p->count);
	for (size_t i = 0; i < 3 * p->count; i++)
		scaled->visible[i] = p->opacity[i / 3] > 0.0f ? p->position[i] : (double)NAN;
	p->position = scaled->visible;
	return GW_OK;
}

/* The camera of a region, where there is one. */
static void scale_camera(gw_scaled_scene *scaled)
{
	const gw_region *region = scaled->options.region;
	if (!region || !region->camera)
		return;
	scaled->camera = *region->camera;
	for (int k = 0; k < 3; k++)
		scaled->camera.position[k] = ldexp(scaled->camera.position[k], scaled->length);
	scaled->camera.near = ldexp(scaled->camera.near, scaled->length);
	scaled->region = *region;
	scaled->region.camera = &scaled->camera;
	scaled->options.region = &scaled->region;
}

gw_status gw_scaled_scene_make(const gw_scene_description *scene, const gw_bake_options *options,
							   double reach, gw_scaled_scene *scaled, gw_error *error)
{
	*scaled = (gw_scaled_scene){ .scene = *scene, .points = *scene->points, .options = *options };
	if (scaled->points.opacity) {
		if (options->effects_forbidden & 1u << GW_EFFECT_TRANSMISSION)
			scaled->points.opacity = NULL;
		else
			GW_TRY(take_opacity(scaled, error));
		scaled->scene.points = &scaled->points;
	}
	const gw_points given = scaled->points, *points = &given;
	choose_units(&scaled->scene, reach, scaled);
	if (scaled->length == 0 && scaled->light == 0)
		return check_widths(scene->lights, scene->light_count, error);
	gw_points *p = &scaled->points;
	GW_TRY(gw_scaled_lights(scaled, scene->lights, scene->light_count, &scaled->lights, error));
	scaled->scene = (gw_scene_description){ p, scaled->lights, scene->light_count };
	p->position = scaled->position =
		gw_scaled_places(points->position, points->count, scaled->length);
	if (points->scanner)
		p->scanner = scaled->scanner =
			gw_scaled_places(points->scanner, points->scanner_count, scaled->length);
	if (points->emission)
		p->emission = scaled->emission =
			scaled_light(points->emission, points->count, scaled->light);
	if (points->own_area)
		p->own_area = scaled->own_area =
			scaled_areas(points->own_area, points->count, 2 * scaled->length);
	if (points->instance_count > 0)
		p->instance = scaled->instance =
			scaled_instances(points->instance, points->instance_count, scaled->length);
	if (!p->position || (points->instance_count > 0 && !p->instance) ||
		(points->scanner && !p->scanner) || (points->emission && !p->emission) ||
		(points->own_area && !p->own_area))
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu points in other units",
					   points->count);
	scaled->options.ambient_occlusion_distance =
		fminf(ldexpf(options->ambient_occlusion_distance, scaled->length), DISTANCE_MOST);
	scaled->options.gap_radiance = ldexpf(options->gap_radiance, scaled->light);
	scale_camera(scaled);
	return GW_OK;
}

void gw_scaled_scene_let_go(gw_scaled_scene *scaled)
{
	gw_scaled_scene units = { .length = scaled->length,
							  .light = scaled->light,
							  .middle = { scaled->middle[0], scaled->middle[1], scaled->middle[2] },
							  .extent = scaled->extent };
	gw_scaled_scene_clear(scaled);
	*scaled = units;
}

void gw_scaled_scene_clear(gw_scaled_scene *scaled)
{
	free(scaled->lights);
	free(scaled->position);
	free(scaled->visible);
	free(scaled->scanner);
	free(scaled->emission);
	free(scaled->own_area);
	free(scaled->instance);
	*scaled = (gw_scaled_scene){ .length = 0 };
}

/* -------------------------------------------------------------------------------- bringing back */

/* False when a number has become too large. */
static bool undo_light(float *values, size_t count, int exponent)
{
	bool fits = true;
	for (size_t i = 0; values && i < count; i++) {
		values[i] = ldexpf(values[i], -exponent);
		fits = fits && isfinite(values[i]);
	}
	return fits;
}

static void undo_report(const gw_scaled_scene *scaled, gw_report *r)
{
	r->leaf_size = ldexp(r->leaf_size, -scaled->length);
	r->wanted_leaf_size = ldexp(r->wanted_leaf_size, -scaled->length);
	r->spacing = ldexp(r->spacing, -scaled->length);
	r->gaps.hole_width = ldexp(r->gaps.hole_width, -scaled->length);
	for (int k = 0; k < 3; k++) {
		r->origin[k] = ldexp(r->origin[k], -scaled->length);
		r->gaps.hole_place[k] = ldexp(r->gaps.hole_place[k], -scaled->length);
		r->unlit_place[k] = ldexp(r->unlit_place[k], -scaled->length);
	}
	for (uint32_t i = 0; i < r->bounce_count; i++)
		r->bounce[i].energy = ldexp(r->bounce[i].energy, -scaled->light - 2 * scaled->length);
}

gw_status gw_scaled_scene_undo(const gw_scaled_scene *scaled, gw_bake_result *result,
							   gw_error *error)
{
	gw_voxels *v = &result->voxels;
	gw_volume *u = &result->volume;
	size_t n = result->count;
	bool fits = true;
	if (scaled->length == 0 && scaled->light == 0)
		return GW_OK;
	float *const lit[] = { result->radiance, result->direct_irradiance, result->indirect_irradiance,
						   result->rest };
	for (size_t i = 0; i < sizeof lit / sizeof *lit; i++)
		fits &= undo_light(lit[i], 3 * n, scaled->light);
	for (size_t i = 0; result->lamp && i < result->lamp_count; i++)
		fits &= undo_light(result->lamp[i], 3 * n, scaled->light);
	fits &= undo_light(result->error, n, scaled->light);
	fits &= undo_light(v->radiance, 3 * v->count, scaled->light);
	fits &= undo_light(v->emission, 3 * v->count, scaled->light);
	fits &= undo_light(u->radiance, 3 * (size_t)u->harmonics * u->count, scaled->light);
	v->size = ldexp(v->size, -scaled->length);
	u->size = ldexp(u->size, -scaled->length);
	for (int k = 0; k < 3; k++) {
		v->origin[k] = ldexp(v->origin[k], -scaled->length);
		u->origin[k] = ldexp(u->origin[k], -scaled->length);
	}
	undo_report(scaled, &result->report);
	return fits ? GW_OK : fail_bright(error);
}

gw_status gw_scaled_scene_undo_radiance(const gw_scaled_scene *scaled, float *radiance,
										size_t count, gw_error *error)
{
	return scaled->light == 0 || undo_light(radiance, 3 * count, scaled->light)
			   ? GW_OK
			   : fail_bright(error);
}

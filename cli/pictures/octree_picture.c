#include "pictures/octree_picture.h"
#include "glowworm_host.h"
#include "pictures/gloss_filter.h"
#include "pictures/scene_octree.h"
#include "pictures/lit_probes.h"
#include "scene/glossy_points.h"
#include "scene/sky_light.h"
#include "program/signals.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Pixels of a picture that are asked about. */
typedef struct asked {
	gw_pixels pixels;
	float *position, *normal, *answer; /* 4 a pixel */
	uint32_t *place;                   /* of each in the picture */
} asked;

uint32_t octree_picture_channels(const settings *s)
{
	if (!settings_shows_gloss(s))
		return 0;
	return 1u << RENDER_SPECULAR | 1u << RENDER_ROUGHNESS | 1u << RENDER_ALBEDO |
		   1u << RENDER_EMISSION;
}

static bool is_cancelled(void *user)
{
	(void)user;
	return signals_pending() != 0;
}

static bool is_glossy(const render_scene *scene)
{
	int offset = scene->offset[RENDER_SPECULAR];
	size_t stride = scene->raster.channel_count;
	for (size_t i = 0; i < scene->surfels.count && offset >= 0; i++)
		if (scene->channel[stride * i + (size_t)offset] > 0.0f)
			return true;
	return false;
}

/* Where there is no room for a probe all rays are traced. */
static gw_status place_probes(const settings *s, const render_scene *scene, const sky_light *sky,
							  octree_picture *p, gw_error *error)
{
	gw_status status = lit_probes_make(s, scene, sky, &p->probes, error);
	if (status != GW_ERROR_DATA)
		return status;
	if (!s->quiet)
		fprintf(stderr, "glowworm: note: there is no free space for a probe; what glossy points "
						"reflect is traced by rays\n");
	return GW_OK;
}

/* Probes, where they are to show what is reflected, and the octree, in which rays are traced that
 * none of them serves; the probes first, whose own octree is gone by then. */
static gw_status build(const settings *s, const render_scene *scene, const sky_light *sky,
					   octree_picture *p, gw_error *error)
{
	bool bricks = p->voxels || p->reflection.cone;
	if (p->glossy && s->render.glossy == SETTINGS_GLOSSY_PROBES)
		GW_TRY(place_probes(s, scene, sky, p, error));
	GW_TRY(scene_octree_create(s, scene, bricks ? SCENE_OCTREE_BRICKS : SCENE_OCTREE_RAYS,
							   &p->octree, error));
	p->reflection.octree = p->octree;
	return sky->has_map ? gw_render_octree_set_sky(p->octree, &sky->light, error) : GW_OK;
}

/* What glossy points reflect where rays meet no surface: what the lights say of the sky. */
static gw_status build_below_sky(const settings *s, const render_scene *scene, octree_picture *p,
								 gw_error *error)
{
	sky_light sky = { .has_map = false };
	GW_TRY(p->glossy ? sky_light_find(s, scene->up, &sky, error) : GW_OK);
	memcpy(p->reflection.sky, sky.radiance, sizeof p->reflection.sky);
	gw_status status = build(s, scene, &sky, p, error);
	sky_light_clear(&sky);
	return status;
}

gw_status octree_picture_open(const settings *s, const render_scene *scene, octree_picture *p,
							  gw_error *error)
{
	*p = (octree_picture){ .octree = NULL,
						   .voxels = s->render.radiance != SETTINGS_RADIANCE_POINTS,
						   .cubic = s->render.radiance == SETTINGS_RADIANCE_TRICUBIC,
						   .reflection = { .rays = s->render.glossy_rays,
										   .cancelled = is_cancelled,
										   .cone = s->render.glossy == SETTINGS_GLOSSY_CONES,
										   .caches = s->render.glossy == SETTINGS_GLOSSY_CACHES } };
	p->glossy = settings_shows_gloss(s) && is_glossy(scene);
	p->reflection.cone = p->reflection.cone && p->glossy;
	if (!p->glossy && !p->voxels)
		return GW_OK;
	double start = gw_seconds();
	gw_status status = build_below_sky(s, scene, p, error);
	if (status == GW_ERROR_NO_DEVICE && !p->voxels && error)
		snprintf(error->text + strlen(error->text), sizeof error->text - strlen(error->text),
				 "; --glossy off needs none");
	p->build_seconds = gw_seconds() - start;
	return status;
}

void octree_picture_clear(octree_picture *p)
{
	gw_render_octree_destroy(&p->octree);
	gw_probes_destroy(&p->probes);
	*p = (octree_picture){ .octree = NULL };
}

/* -------------------------------------------------------------------------------- pixels */

static void asked_clear(asked *a)
{
	free(a->position);
	free(a->normal);
	free(a->answer);
	free(a->place);
}

static float channel_of(const render_scene *scene, const gw_gbuffer *g, size_t pixel,
						render_channel channel, size_t k, float otherwise)
{
	int offset = scene->offset[channel];
	return offset < 0 ? otherwise : g->channel[pixel * g->channel_count + (size_t)offset + k];
}

/* Where the middle of a pixel lies on the surface that it shows, in the surfels' frame. */
static void place_of(const render_scene *scene, const gw_camera *camera, const gw_gbuffer *g,
					 size_t pixel, float place[3])
{
	double step = 2.0 * camera->tangent / (double)g->height, depth = (double)g->depth[pixel];
	double x = ((double)(pixel % g->width) + 0.5 - 0.5 * (double)g->width) * step;
	double y = (0.5 * (double)g->height - (double)(pixel / g->width) - 0.5) * step;
	for (int k = 0; k < 3; k++) {
		double ray = x * camera->right[k] + y * camera->up[k] + camera->forward[k];
		place[k] = (float)(camera->position[k] + depth * ray - scene->surfels.origin[k]);
	}
}

/* Lists the pixels that show something, or only those that are glossy. */
static gw_status ask(const render_scene *scene, const gw_camera *camera, const gw_gbuffer *g,
					 bool glossy, asked *a, gw_error *error)
{
	size_t pixels = (size_t)g->width * g->height, count = 0;
	*a = (asked){ .place = NULL };
	a->place = reallocarray(NULL, pixels, sizeof *a->place);
	for (size_t i = 0; a->place && i < pixels; i++)
		if (g->coverage[i] > 0.0f &&
			(!glossy || channel_of(scene, g, i, RENDER_SPECULAR, 0, 0.0f) > 0.0f))
			a->place[count++] = (uint32_t)i;
	a->position = calloc(count + 1, 4 * sizeof *a->position);
	a->normal = calloc(count + 1, 4 * sizeof *a->normal);
	a->answer = calloc(count + 1, 4 * sizeof *a->answer);
	if (!a->place || !a->position || !a->normal || !a->answer)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a picture");
	for (size_t j = 0; j < count; j++) {
		size_t i = a->place[j];
		place_of(scene, camera, g, i, a->position + 4 * j);
		for (size_t k = 0; k < 3; k++)
			a->normal[4 * j + k] = g->normal[3 * i + k];
		a->position[4 * j + 3] =
			glossy_points_share((double)channel_of(scene, g, i, RENDER_ROUGHNESS, 0, 1.0f), 1.0f);
		a->normal[4 * j + 3] =
			glossy_points_share((double)channel_of(scene, g, i, RENDER_SPECULAR, 0, 0.0f), 0.0f);
	}
	a->pixels = (gw_pixels){ .count = count,
							 .position = a->position,
							 .normal = a->normal,
							 .place = a->place,
							 .width = g->width,
							 .height = g->height,
							 .step = (float)(2.0 * camera->tangent / (double)g->height) };
	for (int k = 0; k < 3; k++)
		a->pixels.eye[k] = (float)(camera->position[k] - scene->surfels.origin[k]);
	return GW_OK;
}

static gw_status read_voxels(octree_picture *p, const render_scene *scene, const gw_camera *camera,
							 const gw_gbuffer *g, float *values, gw_error *error)
{
	asked a;
	gw_status status = ask(scene, camera, g, false, &a, error);
	if (status == GW_OK)
		status = gw_render_octree_read(p->octree, &a.pixels, p->cubic, a.answer, error);
	/* Where the voxels hold nothing, the points' light stays. */
	for (size_t j = 0; status == GW_OK && j < a.pixels.count; j++)
		for (size_t k = 0; k < 3 && a.answer[4 * j + 3] > 0.0f; k++)
			values[3 * a.place[j] + k] = a.answer[4 * j + k];
	asked_clear(&a);
	return status;
}

/* Pixels around one that shows two materials in which one of them is looked for. */
#define NEAR_BY 2

/* Differences in reflectance that are none. */
#define SAME_GLOSS 0.01f

/* Whether a pixel shows one material alone: its reflectance is then that of what is nearest. */
static bool is_pure(const render_scene *scene, const gw_gbuffer *g, size_t pixel)
{
	uint32_t id = g->id[pixel];
	if (!(g->coverage[pixel] > 0.0f) || id >= scene->surfels.count)
		return false;
	float nearest = scene->channel[(size_t)id * scene->raster.channel_count +
								   (size_t)scene->offset[RENDER_SPECULAR]];
	return fabsf(channel_of(scene, g, pixel, RENDER_SPECULAR, 0, 0.0f) - nearest) < SAME_GLOSS;
}

/* The mean of the pure pixels near by that are glossier than one, or less glossy: their light, and
 * behind it their reflectance. False when there are none. */
static bool average_side(const render_scene *scene, const gw_gbuffer *g, const float *values,
						 size_t pixel, bool glossier, float mean[4])
{
	int x = (int)(pixel % g->width), y = (int)(pixel / g->width);
	float own = channel_of(scene, g, pixel, RENDER_SPECULAR, 0, 0.0f), count = 0.0f;
	memset(mean, 0, 4 * sizeof *mean);
	for (int v = y - NEAR_BY; v <= y + NEAR_BY; v++)
		for (int u = x - NEAR_BY; u <= x + NEAR_BY; u++) {
			if (u < 0 || v < 0 || u >= (int)g->width || v >= (int)g->height)
				continue;
			size_t other = (size_t)v * g->width + (size_t)u;
			float gloss = channel_of(scene, g, other, RENDER_SPECULAR, 0, 0.0f);
			if (!(glossier ? gloss > own : gloss < own) || !is_pure(scene, g, other))
				continue;
			for (size_t k = 0; k < 3; k++)
				mean[k] += values[3 * other + k];
			mean[3] += gloss;
			count += 1.0f;
		}
	for (size_t k = 0; k < 4 && count > 0.0f; k++)
		mean[k] /= count;
	return count > 0.0f;
}

/* A pixel at the rim of something glossy has a normal between those of two surfaces and would
 * reflect what neither does: it gets the light of both sides instead, by the share of each. */
static void mend_rims(const render_scene *scene, const gw_gbuffer *g, const asked *a, float *values)
{
	for (size_t j = 0; j < a->pixels.count; j++) {
		size_t i = a->place[j];
		float more[4], less[4];
		if (is_pure(scene, g, i) || !average_side(scene, g, values, i, true, more) ||
			!average_side(scene, g, values, i, false, less))
			continue;
		float share = (a->normal[4 * j + 3] - less[3]) / (more[3] - less[3]);
		for (size_t k = 0; k < 3; k++)
			values[3 * i + k] = share * more[k] + (1.0f - share) * less[k];
	}
}

/* Baked light is what the albedo of all reflected light makes of it; the diffuse surface's is less,
 * and less again by what the gloss takes on the way to this eye. */
static gw_status reflect(octree_picture *p, const render_scene *scene, const gw_camera *camera,
						 const gw_gbuffer *g, float *values, gw_error *error)
{
	asked a;
	gw_status status = ask(scene, camera, g, true, &a, error);
	if (status == GW_OK)
		status = p->probes ? gw_probes_reflect(p->probes, scene->surfels.origin, &a.pixels,
											   &p->reflection, a.answer, error)
						   : gw_render_octree_reflect(p->octree, &a.pixels, &p->reflection,
													  a.answer, error);
	if (status == GW_OK && !p->reflection.cone)
		status = gloss_filter_apply(&a.pixels, &p->reflection, a.answer, error);
	for (size_t j = 0; status == GW_OK && j < a.pixels.count; j++) {
		size_t i = a.place[j];
		float specular = a.normal[4 * j + 3], left = 1.0f - a.answer[4 * j + 3];
		for (size_t k = 0; k < 3; k++) {
			float albedo = channel_of(scene, g, i, RENDER_ALBEDO, k, GW_ALBEDO_DEFAULT);
			float own = channel_of(scene, g, i, RENDER_EMISSION, k, 0.0f);
			float all = glossy_points_albedo(albedo, specular);
			float diffuse = all > 0.0f ? (values[3 * i + k] - own) * albedo / all : 0.0f;
			values[3 * i + k] =
				own + left * (diffuse > 0.0f ? diffuse : 0.0f) + a.answer[4 * j + k];
		}
	}
	if (status == GW_OK)
		mend_rims(scene, g, &a, values);
	p->pixels += a.pixels.count;
	asked_clear(&a);
	return status;
}

gw_status octree_picture_shade(octree_picture *p, const render_scene *scene,
							   const gw_camera *camera, const gw_gbuffer *g, float *values,
							   gw_error *error)
{
	double start = gw_seconds();
	GW_TRY(p->voxels ? read_voxels(p, scene, camera, g, values, error) : GW_OK);
	if (p->glossy)
		GW_TRY(reflect(p, scene, camera, g, values, error));
	p->seconds += gw_seconds() - start;
	return GW_OK;
}

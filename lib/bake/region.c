/*
 * region.c - see region.h.
 */
#include "bake/region.h"

#include "base/memory.h"
#include "base/nth_element.h"
#include "surfels/surfel_backs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Rows of the picture in which is looked what a camera sees. */
#define PICTURE_ROWS 1080.0

/* How far behind what a picture shows a point may lie that is still seen: its disc's radius, and
 * pixels, of what lies aslant. */
#define BEHIND_RADII 2.0
#define BEHIND_PIXELS 4.0

/* Radius in leaf cells of the largest discs that leaves hold where the region is dense and the rest
 * is not: a cave of which a third was dense, the rest 8 and 32 times as sparse, has half and 4 / 10
 * of the leaves that it has with discs up to 8, and the same light. Discs of the region itself are
 * about one leaf wide. */
#define DISC_MOST 2.0f

static gw_status draw_depth(const gw_scene *scene, gw_gbuffer *picture, gw_error *error)
{
	const gw_surfels *s = &scene->surfels;
	const gw_region *region = scene->options.region;
	gw_raster_scene shown = { .discs = { .count = s->count,
										 .position = s->position,
										 .normal = s->normal,
										 .radius = s->radius,
										 .clip = s->clip,
										 .two_sided = s->two_sided,
										 .transparency = s->transparency } };
	double columns = fmin(fmax(PICTURE_ROWS * region->aspect, 1.0), (double)GW_RASTER_SIZE_MAX);
	const gw_raster_options how = { .width = (uint32_t)columns,
									.height = (uint32_t)fmax(columns / region->aspect, 1.0),
									.samples = 1,
									.radius_scale = 1.0f,
									.threads = scene->options.threads,
									.cancelled = gw_scene_stopped,
									.user = (void *)(uintptr_t)scene };
	memcpy(shown.origin, s->origin, sizeof shown.origin);
	return gw_raster_draw(&shown, region->camera, &how, picture, error);
}

/* The farthest that is seen around a pixel, so that an edge hides nothing that it only touches. */
static double depth_around(const gw_gbuffer *picture, double x, double y)
{
	double farthest = 0.0;
	for (int k = 0; k < 9; k++) {
		double column = floor(x) + k % 3 - 1, row = floor(y) + k / 3 - 1;
		if (column < 0.0 || row < 0.0 || column >= picture->width || row >= picture->height)
			continue;
		size_t pixel = (size_t)row * picture->width + (size_t)column;
		farthest = fmax(farthest, (double)picture->depth[pixel]);
	}
	return farthest;
}

/* Moves what is less than `reach` outside of 0 to `size` to the border; false if it is farther. */
static bool bring_inside(double *at, double size, double reach)
{
	if (!(*at > -reach && *at < size + reach))
		return false;
	*at = fmin(fmax(*at, 0.0), size - 1.0);
	return true;
}

/* Whether a point is in the picture, or next to it with a disc that is, and nothing before it. */
static bool is_seen(const gw_scene *scene, const gw_gbuffer *picture, size_t surfel)
{
	const gw_surfels *s = &scene->surfels;
	const gw_camera *camera = scene->options.region->camera;
	double off[3], view[3];
	for (size_t k = 0; k < 3; k++)
		off[k] = (double)s->position[3 * surfel + k] + s->origin[k] - camera->position[k];
	gw_camera_turn(camera, off, view);
	if (!(view[2] > camera->near))
		return false;
	double pixel = 2.0 * camera->tangent / picture->height; /* at distance 1 */
	double x = 0.5 * picture->width + view[0] / view[2] / pixel;
	double y = 0.5 * picture->height - view[1] / view[2] / pixel;
	double reach = (double)s->radius[surfel] / (view[2] * pixel);
	if (!bring_inside(&x, picture->width, reach) || !bring_inside(&y, picture->height, reach))
		return false;
	double behind = BEHIND_RADII * (double)s->radius[surfel] + BEHIND_PIXELS * pixel * view[2];
	return view[2] <= depth_around(picture, x, y) + behind;
}

static gw_status leave_seen(gw_scene *scene, gw_error *error)
{
	gw_gbuffer picture;
	if (!scene->options.region->camera)
		return GW_OK;
	GW_TRY(draw_depth(scene, &picture, error));
	for (size_t i = 0; i < scene->surfels.count; i++)
		scene->region.asked[i] = scene->region.asked[i] && is_seen(scene, &picture, i);
	gw_gbuffer_clear(&picture);
	return GW_OK;
}

static bool is_chosen(const gw_scene *scene, size_t point)
{
	const gw_region *region = scene->options.region;
	return !region->point || region->point[point];
}

static void choose_points(const gw_scene *scene, bool *asked)
{
	const gw_surfels *s = &scene->surfels;
	for (size_t i = 0; i < s->point_count; i++)
		if (s->surfel_of_point[i] != UINT32_MAX && is_chosen(scene, i))
			asked[s->surfel_of_point[i]] = true;
	for (size_t j = 0; j < s->stray_count; j++)
		if (s->stray[j].surfel != UINT32_MAX && is_chosen(scene, s->stray[j].point))
			asked[s->stray[j].surfel] = true;
}

/* Of surface that has both sides one is shown, whichever is brighter. */
static gw_status choose_backs(const gw_surfels *s, bool *asked, gw_error *error)
{
	uint32_t *back;
	GW_TRY(gw_surfel_backs_find(s, &back, error));
	for (size_t i = 0; back && i < s->count; i++)
		if (asked[i] && back[i] != UINT32_MAX)
			asked[back[i]] = true;
	free(back);
	return GW_OK;
}

/* Those whose surfels are asked for, and which are so themselves. */
static gw_status list_points(gw_scene *scene, gw_error *error)
{
	const gw_surfels *s = &scene->surfels;
	gw_region_needs *r = &scene->region;
	r->point = gw_allocate_zeros(s->point_count, sizeof *r->point);
	if (!r->point)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu points", s->point_count);
	for (size_t i = 0; i < s->point_count; i++)
		r->point[i] = s->surfel_of_point[i] != UINT32_MAX && r->asked[s->surfel_of_point[i]] &&
					  is_chosen(scene, i);
	for (size_t j = 0; j < s->stray_count; j++)
		if (s->stray[j].surfel != UINT32_MAX && r->asked[s->stray[j].surfel])
			r->point[s->stray[j].point] = is_chosen(scene, s->stray[j].point);
	scene->report->region_points = 0;
	for (size_t i = 0; i < s->point_count; i++)
		scene->report->region_points += r->point[i];
	return GW_OK;
}

gw_status gw_region_set_width(gw_scene *scene, gw_error *error)
{
	gw_surfels *s = &scene->surfels;
	size_t asked = 0;
	float *area = gw_allocate_array(scene->region.count, sizeof *area);
	if (!area)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu areas", scene->region.count);
	for (size_t i = 0; i < s->count; i++)
		if (scene->region.asked[i])
			area[asked++] = s->area[i];
	s->spacing = sqrtf(gw_nth_element(area, asked, asked / 2));
	s->disc_most = DISC_MOST;
	free(area);
	return GW_OK;
}

gw_status gw_region_ask(gw_scene *scene, gw_error *error)
{
	const gw_surfels *s = &scene->surfels;
	gw_region_needs *r = &scene->region;
	if (!scene->options.region)
		return GW_OK;
	r->asked = gw_allocate_zeros(s->count, sizeof *r->asked);
	if (!r->asked)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu surfels", s->count);
	choose_points(scene, r->asked);
	GW_TRY(leave_seen(scene, error));
	GW_TRY(choose_backs(s, r->asked, error));
	for (size_t i = 0; i < s->count; i++)
		r->count += r->asked[i];
	if (r->count == 0)
		return gw_fail(error, GW_ERROR_DATA,
					   "none of the %zu points lies in the region that is asked for%s",
					   s->point_count,
					   scene->options.region->camera ? ", or its camera sees none of them" : "");
	GW_TRY(list_points(scene, error));
	scene->options.region = NULL; /* the caller's, and needed no more */
	return GW_OK;
}

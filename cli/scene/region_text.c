#include "scene/region_text.h"
#include "program/words.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define OPTION "--region"

/* Width by height of the pictures that `render` makes. */
#define PICTURE_ASPECT (16.0 / 9.0)

/* What is nearer to a camera than this share of the way to where it looks is not seen. */
#define NEAR 1e-4

static gw_status read_box(words *w, region_text *region)
{
	double corner[2][3];
	for (int i = 0; i < 2; i++)
		if (!words_next(w) || words_numbers(w->word, corner[i]) != 3 || !isfinite(corner[i][0]) ||
			!isfinite(corner[i][1]) || !isfinite(corner[i][2]))
			return words_fail(w, "'box' wants two opposite corners, X,Y,Z X,Y,Z");
	if (words_next(w))
		return words_fail(w, "a box has two corners, and nothing else");
	for (int k = 0; k < 3; k++) {
		region->low[k] = fmin(corner[0][k], corner[1][k]);
		region->high[k] = fmax(corner[0][k], corner[1][k]);
	}
	return GW_OK;
}

gw_status region_text_read(const char *text, region_text *region, gw_error *error)
{
	words w = words_of(OPTION, text, error);
	*region = (region_text){ .by_camera = false };
	bool any = words_next(&w);
	if (any && strcmp(w.word, "box") == 0)
		return read_box(&w, region);
	if (!any || strcmp(w.word, "camera") != 0)
		return words_fail(&w, "a region is 'box X,Y,Z X,Y,Z', two opposite corners, or 'camera at "
							  "X,Y,Z to X,Y,Z fov DEGREES', what that sees");
	region->by_camera = true;
	GW_TRY(
		camera_text_read(OPTION " camera", w.at + strspn(w.at, " \t\n"), &region->camera, error));
	return region->camera.placed
			   ? GW_OK
			   : words_fail(&w, "a region's camera has to be placed: 'at X,Y,Z to X,Y,Z'; `render` "
								"prints those that it chooses");
}

gw_status region_text_check(const settings *s, gw_error *error)
{
	const struct {
		const char *name;
		bool given;
		const char *why;
	} rows[] = {
		{ "vdb", s->vdb != NULL, "grids are of the whole scene" },
		{ "vdb-sh", s->vdb_sh != NULL, "grids are of the whole scene" },
		{ "transport", s->transport != NULL, "it is of the whole scene" },
		{ "save-transport", s->save_transport != NULL, "it is of the whole scene" },
		{ "frames", s->frames != NULL, "frames are of the whole scene" },
		{ "explain", s->explain, "what a region takes is not foretold" },
	};
	region_text region;
	if (!s->region)
		return GW_OK;
	GW_TRY(region_text_read(s->region, &region, error));
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
		if (rows[i].given)
			return gw_fail(error, GW_ERROR_USAGE, "--region and --%s do not go together: %s",
						   rows[i].name, rows[i].why);
	return GW_OK;
}

static bool is_within(const region_text *region, const double place[3])
{
	bool within = true;
	for (int k = 0; k < 3; k++)
		within = within && place[k] >= region->low[k] && place[k] <= region->high[k];
	return within;
}

static gw_status find_in_box(const loaded_scene *scene, const region_text *region,
							 region_points *points, gw_error *error)
{
	size_t count = scene->points.points.count, found = 0;
	points->point = calloc(count + 1, 1);
	if (!points->point)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to mark %zu points", count);
	for (size_t i = 0; i < count; i++) {
		double place[3];
		memcpy(place, scene->points.points.position + 3 * i, sizeof place);
		coordinates_from_metres(&scene->place, place);
		points->point[i] = is_within(region, place);
		found += points->point[i];
	}
	if (found == 0)
		return gw_fail(error, GW_ERROR_DATA,
					   "none of the %zu points lies in the box of --region; `glowworm info` tells "
					   "where they are",
					   count);
	points->region.point = points->point;
	return GW_OK;
}

static gw_status place_camera(const loaded_scene *scene, const camera_text *text,
							  region_points *points, gw_error *error)
{
	double at[3], to[3], up[3], way = 0.0;
	memcpy(at, text->at, sizeof at);
	memcpy(to, text->to, sizeof to);
	coordinates_to_metres(&scene->place, at);
	coordinates_to_metres(&scene->place, to);
	gw_camera_up(scene->up, up);
	GW_TRY(gw_camera_look(&points->camera, at, to, up,
						  text->angle > 0.0 ? text->angle : CAMERA_TEXT_ANGLE, error));
	for (int k = 0; k < 3; k++)
		way += (to[k] - at[k]) * (to[k] - at[k]);
	points->camera.near = NEAR * sqrt(way);
	points->region.camera = &points->camera;
	points->region.aspect = PICTURE_ASPECT;
	return GW_OK;
}

gw_status region_points_find(const settings *from, const loaded_scene *scene, region_points *points,
							 gw_error *error)
{
	region_text region;
	*points = (region_points){ .point = NULL };
	GW_TRY(region_text_read(from->region, &region, error));
	gw_status status = region.by_camera ? place_camera(scene, &region.camera, points, error)
										: find_in_box(scene, &region, points, error);
	if (status != GW_OK)
		region_points_clear(points);
	return status;
}

void region_points_clear(region_points *points)
{
	free(points->point);
	*points = (region_points){ .point = NULL };
}

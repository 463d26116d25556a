#include "pictures/render_scene.h"
#include "result/bake_columns.h"
#include "glowworm_host.h"
#include "scene/thinned_scene.h"
#include "options/preview.h"
#include "pictures/render_mesh.h"
#include "points/scan_color.h"
#include "program/text_quote.h"
#include "program/signals.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The narrowest cloud in a picture, metres. Triangles of cells have squares of areas, fourth powers
 * of lengths: they are drawn at 1e-10 m and lost at 1e-12. */
#define WIDTH_LEAST 1e-9

/* Columns of a channel that a bake writes. */
static const char *const column_name[RENDER_CHANNEL_COUNT][3] = {
	[RENDER_RADIANCE] = { "radiance_r", "radiance_g", "radiance_b" },
	[RENDER_DIRECT] = { "direct_r", "direct_g", "direct_b" },
	[RENDER_INDIRECT] = { "indirect_r", "indirect_g", "indirect_b" },
	[RENDER_IRRADIANCE] = { "irradiance_r", "irradiance_g", "irradiance_b" },
	[RENDER_ILLUMINANCE] = { "illuminance" },
	[RENDER_SPECULAR] = { "specular" },
	[RENDER_ROUGHNESS] = { "roughness" },
	[RENDER_ERROR] = { "error" },
	[RENDER_UNKNOWN] = { "unknown" },
};

uint32_t render_channel_width(render_channel channel)
{
	static const bool is_number[RENDER_CHANNEL_COUNT] = {
		[RENDER_NDF] = true,       [RENDER_ROI] = true,        [RENDER_SPECULAR] = true,
		[RENDER_ROUGHNESS] = true, [RENDER_ERROR] = true,      [RENDER_UNKNOWN] = true,
		[RENDER_SHADOW] = true,    [RENDER_ILLUMINANCE] = true
	};
	return is_number[channel] ? 1 : 3;
}

const char *render_channel_name(render_channel channel)
{
	static const char *const name[] = { "albedo",     "radiance",    "direct",    "indirect",
										"irradiance", "illuminance", "emission",  "ndf",
										"roi",        "specular",    "roughness", "error",
										"unknown",    "shadow" };
	return name[channel];
}

static bool is_cancelled(void *user)
{
	(void)user;
	return signals_pending() != 0;
}

static bool find_own_columns(const scan *cloud, render_channel channel,
							 const scan_column *column[3])
{
	const char *const *name = column_name[channel];
	bool all = name[0] != NULL;
	column[0] = column[1] = column[2] = NULL;
	for (uint32_t k = 0; k < 3 && all && name[k]; k++)
		all = (column[k] = scan_find_scalar(cloud, name[k])) != NULL;
	return all;
}

/* Is its light in cd/m^2 and lx? */
static bool is_photometric(const scan *cloud)
{
	return bake_columns_photometric(cloud) ||
		   scan_find_scalar(cloud, column_name[RENDER_ILLUMINANCE][0]) != NULL;
}

/* The columns of a channel; three for an illuminance that has none of its own. */
static bool find_columns(const scan *cloud, render_channel channel, const scan_column *column[3])
{
	return find_own_columns(cloud, channel, column) ||
		   (channel == RENDER_ILLUMINANCE && is_photometric(cloud) &&
			find_own_columns(cloud, RENDER_IRRADIANCE, column));
}

/* Which channels there are, and where they stand. */
static void lay_out(render_scene *scene, const scan *cloud, uint32_t wanted)
{
	const scan_column *column[3];
	for (int c = 0; c < RENDER_CHANNEL_COUNT; c++) {
		bool there = c == RENDER_EMISSION
						 ? scene->surfels.emission != NULL
						 : !column_name[c][0] || find_columns(cloud, (render_channel)c, column);
		scene->offset[c] = -1;
		if (!there || !(wanted & 1u << c))
			continue;
		scene->offset[c] = (int)scene->raster.channel_count;
		scene->raster.channel_count += render_channel_width((render_channel)c);
	}
}

/* The mean of columns over the points that each surfel stands for; bad values count as 0, and
 * errors by their size. */
static void average_columns(const gw_surfels *s, const scan_column *column[3],
							render_channel channel, const uint32_t *points, float *to,
							size_t stride)
{
	uint32_t width = render_channel_width(channel);
	bool luminance = width == 1 && column[1];
	for (size_t i = 0; i < s->point_count; i++) {
		size_t surfel = s->surfel_of_point[i];
		if (surfel == UINT32_MAX)
			continue;
		for (size_t k = 0; k < width; k++) {
			double value = luminance ? gw_relative_luminance(scan_value(column[0], i),
															 scan_value(column[1], i),
															 scan_value(column[2], i))
									 : scan_value(column[k], i);
			value = channel == RENDER_ERROR ? fabs(value) : value;
			if (isfinite((float)value) && value > 0.0)
				to[surfel * stride + k] += (float)value / (float)points[surfel];
		}
	}
}

/* The others are the surfels' own. */
static void copy_own(render_scene *scene)
{
	const gw_surfels *s = &scene->surfels;
	uint32_t stride = scene->raster.channel_count;
	for (size_t i = 0; i < s->count; i++) {
		float *to = scene->channel + i * stride;
		for (int k = 0; k < 3 && scene->offset[RENDER_ALBEDO] >= 0; k++)
			to[scene->offset[RENDER_ALBEDO] + k] = s->albedo[3 * i + (size_t)k];
		for (int k = 0; k < 3 && scene->offset[RENDER_EMISSION] >= 0; k++)
			to[scene->offset[RENDER_EMISSION] + k] = s->emission[3 * i + (size_t)k];
		if (scene->offset[RENDER_NDF] >= 0)
			to[scene->offset[RENDER_NDF]] = s->normal_length[i];
		if (scene->offset[RENDER_ROI] >= 0)
			to[scene->offset[RENDER_ROI]] = isfinite(s->nearest[i]) ? s->nearest[i] : 0.0f;
	}
}

/* How many points each surfel stands for; NULL when memory is short. For free(). */
static uint32_t *count_points(const gw_surfels *s)
{
	uint32_t *points = calloc(s->count + 1, sizeof *points); /* of no surfels some memory, too */
	for (size_t i = 0; points && i < s->point_count; i++)
		if (s->surfel_of_point[i] != UINT32_MAX)
			points[s->surfel_of_point[i]]++;
	return points;
}

gw_status render_scene_means(const gw_surfels *s, const scan_column *const column[3], float *to,
							 gw_error *error)
{
	const scan_column *of[3] = { column[0], column[1], column[2] };
	uint32_t *points = count_points(s);
	if (!points)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the light of %zu points", s->count);
	memset(to, 0, s->count * sizeof(float[3]));
	average_columns(s, of, RENDER_RADIANCE, points, to, 3);
	free(points);
	return GW_OK;
}

static gw_status fill_channels(render_scene *scene, const scan *cloud, gw_error *error)
{
	const gw_surfels *s = &scene->surfels;
	const scan_column *column[3];
	uint32_t *points = count_points(s);
	uint32_t stride = scene->raster.channel_count;
	scene->channel = calloc(s->count, (stride ? stride : 1) * sizeof *scene->channel);
	bool good = points && scene->channel;
	for (int c = 0; c < RENDER_CHANNEL_COUNT && good; c++)
		if (scene->offset[c] >= 0 && find_columns(cloud, (render_channel)c, column))
			average_columns(s, column, (render_channel)c, points, scene->channel + scene->offset[c],
							stride);
	if (good)
		copy_own(scene);
	free(points);
	return good
			   ? GW_OK
			   : gw_fail(error, GW_ERROR_MEMORY, "no memory for the light of %zu points", s->count);
}

/* The luminance of each surfel, while it is needed. */
static gw_status fill_luminance(render_scene *scene, const scan *cloud, const gw_surfels *s,
								gw_error *error)
{
	const scan_column *column[3];
	if (!find_columns(cloud, RENDER_RADIANCE, column))
		return GW_OK;
	uint32_t *points = count_points(s);
	float *radiance = calloc(s->count, 3 * sizeof *radiance);
	scene->luminance = calloc(s->count, sizeof *scene->luminance);
	bool good = points && radiance && scene->luminance;
	if (good)
		average_columns(s, column, RENDER_RADIANCE, points, radiance, 3);
	for (size_t i = 0; i < s->count && good; i++)
		scene->luminance[i] = (float)preview_luminance(radiance + 3 * i);
	free(points);
	free(radiance);
	return good
			   ? GW_OK
			   : gw_fail(error, GW_ERROR_MEMORY, "no memory for the light of %zu points", s->count);
}

/* What sends out more light of its own than it reflects glows, if that is more than this share of
 * what the brightest one sends. */
#define GLOW 0.01

static gw_status find_glowing(render_scene *scene, gw_error *error)
{
	const gw_surfels *s = &scene->surfels;
	int radiance = scene->offset[RENDER_RADIANCE];
	size_t stride = scene->raster.channel_count, count = 0;
	double brightest = 0.0;
	if (!s->emission || radiance < 0)
		return GW_OK;
	scene->glows = calloc(s->count, 1);
	if (!scene->glows)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu points", s->count);
	for (size_t i = 0; i < s->count; i++)
		brightest = fmax(brightest, preview_luminance(s->emission + 3 * i));
	for (size_t i = 0; i < s->count; i++) {
		const float *all = scene->channel + i * stride + radiance;
		double own = preview_luminance(s->emission + 3 * i);
		scene->glows[i] = own > 0.5 * preview_luminance(all) && own > GLOW * brightest;
		count += scene->glows[i];
	}
	if (count == 0 || count == s->count) {
		free(scene->glows);
		scene->glows = NULL;
	}
	return GW_OK;
}

static void point_to_surfels(render_scene *scene)
{
	const gw_surfels *s = &scene->surfels;
	memcpy(scene->raster.origin, s->origin, sizeof s->origin);
	scene->raster.discs = (gw_raster_discs){ .count = s->count,
											 .position = s->position,
											 .normal = s->normal,
											 .radius = s->radius,
											 .clip = s->clip,
											 .two_sided = s->two_sided,
											 .glows = scene->glows,
											 .transparency = s->transparency,
											 .channel = scene->channel };
}

/* Who chooses the surfels, and what that takes. */
typedef struct choosing {
	render_scene *scene;
	const scan *cloud;
	render_scene_chooser *choose;
	bool all; /* whatever it says */
	void *user;
} choosing;

/* Pictures are made in the lengths that were given. */
static gw_status check_width(const gw_surfels *surfels, gw_error *error)
{
	double width = 0.0;
	for (int k = 0; k < 3; k++)
		width = fmax(width, (double)surfels->maximum[k] - (double)surfels->minimum[k]);
	if (surfels->count == 1)
		return gw_fail(error, GW_ERROR_DATA,
					   "all points stand at one place, %s, %s, %s, so there is nothing to see: the "
					   "file has no other coordinates, or the program that wrote it lost them",
					   GW_SAID_PLACE(surfels->origin[0] + (double)surfels->position[0]),
					   GW_SAID_PLACE(surfels->origin[1] + (double)surfels->position[1]),
					   GW_SAID_PLACE(surfels->origin[2] + (double)surfels->position[2]));
	if (surfels->count < 2 || width >= WIDTH_LEAST)
		return GW_OK;
	return gw_fail(error, GW_ERROR_DATA,
				   "the points lie within %s m, and pictures need %s m at least: check the unit "
				   "of their coordinates, or scale them up",
				   GW_SAID(width, 3), GW_SAID(WIDTH_LEAST, 3));
}

static gw_status choose(void *user, const gw_surfels *surfels, uint8_t *chosen, gw_error *error)
{
	choosing *c = user;
	double start = gw_seconds();
	GW_TRY(check_width(surfels, error));
	gw_status status = fill_luminance(c->scene, c->cloud, surfels, error);
	if (status == GW_OK)
		status = c->choose(c->user, c->scene, surfels, chosen, error);
	if (c->all)
		memset(chosen, 1, surfels->count);
	free(c->scene->luminance);
	c->scene->luminance = NULL;
	c->scene->choose_seconds = gw_seconds() - start;
	return status;
}

static bool is_enclosed(const scan *cloud)
{
	bool enclosed = false;
	for (size_t c = 0; c < cloud->comment_count; c++)
		enclosed = enclosed || strcmp(cloud->comment[c], SCAN_ENCLOSED) == 0;
	return enclosed;
}

static gw_status make(const settings *s, loaded_scene *loaded, uint32_t wanted, choosing *c,
					  gw_error *error)
{
	render_scene *scene = c->scene;
	gw_surfels_options options = { .threads = s->bake.threads,
								   .normals = s->bake.normals,
								   .choose = choose,
								   .chooser = c,
								   .rough_area = !c->all,
								   .cancelled = is_cancelled };
	scene->up = loaded->up;
	scene->place = loaded->place;
	loaded->place = coordinates_metres();
	scene->scanner = loaded->points.points.scanner;
	scene->scanner_count = loaded->points.points.scanner_count;
	scene->photometric = is_photometric(&loaded->cloud);
	scene->enclosed = is_enclosed(&loaded->cloud);
	double start = gw_seconds();
	GW_TRY(gw_surfels_make(&loaded->points.points, &options, &scene->surfels, error));
	scene->scanner = NULL;
	scene->scanner_count = 0;
	lay_out(scene, &loaded->cloud, wanted);
	GW_TRY(fill_channels(scene, &loaded->cloud, error));
	GW_TRY(find_glowing(scene, error));
	point_to_surfels(scene);
	GW_TRY(render_mesh_add(s, scene, error));
	scene->surface_seconds = gw_seconds() - start - scene->choose_seconds;
	return GW_OK;
}

void render_scene_print_notes(const scan *cloud)
{
	for (size_t c = 0; c < cloud->comment_count; c++)
		if (strncmp(cloud->comment[c], SCAN_NOTE, strlen(SCAN_NOTE)) == 0)
			text_message(stderr, "glowworm: %s\n", cloud->comment[c]);
}

gw_status render_scene_make(const settings *s, loaded_scene *loaded, const render_scene_wish *wish,
							render_scene *scene, gw_error *error)
{
	choosing c = { scene, &loaded->cloud, wish->choose, false, wish->user };
	bool glossy = scan_find_scalar(&loaded->cloud, column_name[RENDER_SPECULAR][0]) != NULL;
	*scene = (render_scene){ .place = coordinates_metres() };
	c.all = wish->octree == RENDER_OCTREE_YES || (wish->octree == RENDER_OCTREE_GLOSSY && glossy);
	gw_status status = make(s, loaded, wish->channels, &c, error);
	if (status != GW_OK)
		render_scene_clear(scene);
	return status;
}

gw_status render_scene_read(const settings *s, const render_scene_wish *wish, render_scene *scene,
							gw_error *error)
{
	const char *glossy =
		wish->octree == RENDER_OCTREE_GLOSSY ? column_name[RENDER_SPECULAR][0] : NULL;
	const parted_cloud_look look = { wish->octree == RENDER_OCTREE_YES ? THINNED_SCENE_TRACED_BYTES
																	   : THINNED_SCENE_SEEN_BYTES,
									 glossy, THINNED_SCENE_TRACED_BYTES };
	thinned_scene thinned;
	double start = gw_seconds(), seconds = 0.0;
	*scene = (render_scene){ .place = coordinates_metres() };
	gw_status status = thinned_scene_read(s, &look, "drawn", &thinned, error);
	if (status == GW_OK) {
		seconds = gw_seconds() - start;
		if (!s->quiet)
			render_scene_print_notes(&thinned.loaded.cloud);
		status = render_scene_make(s, &thinned.loaded, wish, scene, error);
		scene->read_seconds = seconds;
	}
	thinned_scene_clear(&thinned);
	return status;
}

void render_scene_clear(render_scene *scene)
{
	gw_surfels_clear(&scene->surfels);
	free(scene->channel);
	free(scene->glows);
	free(scene->luminance);
	coordinates_clear(&scene->place);
	gw_tessellation_clear(&scene->triangles);
	free(scene->index);
	*scene = (render_scene){ .place = coordinates_metres() };
}

/*
 * probe_picture.c - see probe_picture.h.
 */
#include "pictures/probe_picture.h"

#include "glowworm_host.h"
#include "options/preview.h"
#include "pictures/render_cameras.h"
#include "pictures/render_picture.h"
#include "program/signals.h"
#include "result/bake_columns.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WIDTH 1600u
#define HEIGHT 900u
#define SAMPLES 3u /* a pixel's side, of balls as well as of points */

/* A ball's radius at most, in radii of free space and in diagonals of the scene. */
#define OF_FREE 0.25
#define OF_SCENE 0.01

/* Radii around a camera within which no ball may be. */
#define TOO_NEAR 3.0

/* From how far off a probe is looked at that stands alone, in radii of its free space: more than
 * TOO_NEAR * OF_FREE. */
#define BESIDE 0.9

/* How steeply a view turns to a probe at most, as a sine: straight up no side of a picture is. */
#define STEEPEST 0.98

#define ROWS 4u /* that a thread takes at a time */

/* A ball, in the camera's frame. */
typedef struct ball {
	double centre[3], radius;
	const gw_probe *probe;
} ball;

/* All that lasts as long as a picture is drawn. */
typedef struct drawing {
	probe_picture *picture;
	render_scene scene;
	camera_plan plan;
	gw_camera camera;
	gw_gbuffer g;
	float *values; /* 3 a pixel */
	ball *balls;
	uint8_t *seen; /* a ball */
	size_t count;
} drawing;

static bool is_cancelled(void *user)
{
	(void)user;
	return signals_pending() != 0;
}

/* --------------------------------------------------------------------------------- the scene */

/* The light as columns, as a bake would write it. */
static gw_status put_light(const probe_picture *p, loaded_scene *loaded, gw_error *error)
{
	static const char *const name[3] = { "scalar_radiance_r", "scalar_radiance_g",
										 "scalar_radiance_b" };
	bake_columns_remove(&loaded->cloud, BAKE_COLUMNS_ALL);
	for (size_t k = 0; k < 3; k++) {
		scan_column *column = scan_add_column(&loaded->cloud, name[k], SCAN_FLOAT32, error);
		if (!column)
			return GW_ERROR_MEMORY;
		for (size_t i = 0; i < loaded->cloud.count; i++)
			((float *)column->data)[i] = p->radiance[3 * i + k];
	}
	return GW_OK;
}

static double radius_of(const gw_probe *probe, const gw_surfels *s)
{
	double diagonal = 0.0;
	for (int k = 0; k < 3; k++)
		diagonal = hypot(diagonal, (double)s->maximum[k] - (double)s->minimum[k]);
	return fmin(OF_FREE * (double)probe->radius, OF_SCENE * diagonal);
}

static double distance_between(const double a[3], const double b[3])
{
	return hypot(hypot(b[0] - a[0], b[1] - a[1]), b[2] - a[2]);
}

/* Does no surfel's disc stand between two places? */
static bool is_open_way(const gw_surfels *s, const double from[3], const double to[3])
{
	for (size_t i = 0; i < s->count; i++) {
		const float *n = s->normal + 3 * i, *p = s->position + 3 * i;
		double along = 0.0, before = 0.0, square = 0.0;
		for (int k = 0; k < 3; k++) {
			along += (double)n[k] * (to[k] - from[k]);
			before += (double)n[k] * ((double)p[k] + s->origin[k] - from[k]);
		}
		double t = before / along;
		if (!(t > 0.0 && t < 1.0))
			continue;
		for (int k = 0; k < 3; k++) {
			double off = from[k] + t * (to[k] - from[k]) - (double)p[k] - s->origin[k];
			square += off * off;
		}
		if (square < (double)s->radius[i] * (double)s->radius[i])
			return false;
	}
	return true;
}

/* Is a probe within the edges of a camera's picture? */
static bool is_framed(const gw_camera *camera, const gw_probe *probe)
{
	double to[3], at[3];
	for (int k = 0; k < 3; k++)
		to[k] = probe->position[k] - camera->position[k];
	gw_camera_turn(camera, to, at);
	return at[2] > camera->near && fabs(at[1]) < camera->tangent * at[2] &&
		   fabs(at[0]) < camera->tangent * at[2] * WIDTH / HEIGHT;
}

/* Would a picture from one place towards another one hardly have an upper side? */
static bool is_too_steep(const drawing *d, const double from[3], const double to[3])
{
	double up[3], rise = 0.0;
	gw_camera_up(d->plan.up, up);
	for (int k = 0; k < 3; k++)
		rise += up[k] * (to[k] - from[k]);
	return fabs(rise) > STEEPEST * distance_between(from, to);
}

/* Which probe a view is to show: one that it has in sight amid the picture or, failing that, the
 * nearest one in sight; NULL: none is. */
static const gw_probe *find_in_sight(const drawing *d, const gw_surfels *s, const gw_camera *camera)
{
	const gw_probes *all = d->picture->probes;
	const double *eye = d->plan.view[0].at;
	const gw_probe *best = NULL;
	for (size_t i = 0; i < all->count; i++) {
		const gw_probe *probe = &all->probe[i];
		double far = distance_between(eye, probe->position);
		bool framed = is_framed(camera, probe);
		if (far <= TOO_NEAR * radius_of(probe, s) ||
			(!framed && is_too_steep(d, eye, probe->position)) ||
			(!framed && best && far >= distance_between(eye, best->position)))
			continue;
		if (!is_open_way(s, eye, probe->position))
			continue;
		best = probe;
		if (framed)
			break;
	}
	return best;
}

/* The one with the most space around it. */
static const gw_probe *find_freest(const gw_probes *all)
{
	const gw_probe *best = &all->probe[0];
	for (size_t i = 1; i < all->count; i++)
		best = all->probe[i].radius > best->radius ? &all->probe[i] : best;
	return best;
}

/* A view that was found for the scene turns to a probe if it has none in it; from where no probe is
 * in sight, it goes into the free space of one, with the scene behind it as it was. */
static gw_status turn_to_probes(drawing *d, const gw_surfels *s, gw_error *error)
{
	gw_viewpoint *view = &d->plan.view[0];
	gw_camera camera;
	if (d->plan.text[0].placed || d->picture->probes->count == 0)
		return GW_OK;
	GW_TRY(camera_plan_camera(&d->plan, (double)s->spacing, 0, &camera, error));
	const gw_probe *probe = find_in_sight(d, s, &camera);
	if (probe && is_framed(&camera, probe))
		return GW_OK;
	if (!probe) {
		probe = find_freest(d->picture->probes);
		view->near = 0.0;
		for (int k = 0; k < 3; k++)
			view->at[k] = probe->position[k] - BESIDE * (double)probe->radius * camera.forward[k];
	}
	memcpy(view->to, probe->position, sizeof view->to);
	return GW_OK;
}

static gw_status choose_points(void *user, const render_scene *scene, const gw_surfels *surfels,
							   uint8_t *chosen, gw_error *error)
{
	drawing *d = user;
	const double aspect = (double)WIDTH / (double)HEIGHT;
	GW_TRY(camera_plan_place(&d->plan, scene, surfels, aspect, error));
	GW_TRY(turn_to_probes(d, surfels, error));
	return camera_plan_choose(&d->plan, surfels, aspect, chosen, error);
}

static gw_status draw_points(drawing *d, gw_error *error)
{
	const gw_raster_options raster = { .width = WIDTH,
									   .height = HEIGHT,
									   .samples = SAMPLES,
									   .radius_scale = 1.0f,
									   .threads = d->picture->settings->bake.threads,
									   .cancelled = is_cancelled };
	GW_TRY(camera_plan_camera(&d->plan, (double)d->scene.surfels.spacing, 0, &d->camera, error));
	GW_TRY(gw_raster_draw(&d->scene.raster, &d->camera, &raster, &d->g, error));
	d->values = calloc((size_t)WIDTH * HEIGHT, 3 * sizeof *d->values);
	if (!d->values)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a picture");
	render_view_values(&d->scene, &d->g, SETTINGS_VIEW_RADIANCE, d->values);
	return GW_OK;
}

/* --------------------------------------------------------------------------------- the balls */

static gw_status place_balls(drawing *d, gw_error *error)
{
	const gw_probes *p = d->picture->probes;
	const gw_surfels *s = &d->scene.surfels;
	d->balls = calloc(p->count, sizeof *d->balls);
	d->seen = calloc(p->count, 1);
	if (!d->balls || !d->seen)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu balls", p->count);
	for (size_t i = 0; i < p->count; i++) {
		const gw_probe *probe = &p->probe[i];
		const double to[3] = { probe->position[0] - d->camera.position[0],
							   probe->position[1] - d->camera.position[1],
							   probe->position[2] - d->camera.position[2] };
		ball *b = &d->balls[d->count];
		b->probe = probe;
		b->radius = radius_of(probe, s);
		gw_camera_turn(&d->camera, to, b->centre);
		d->count += sqrt(to[0] * to[0] + to[1] * to[1] + to[2] * to[2]) > TOO_NEAR * b->radius;
	}
	return GW_OK;
}

/* What a white diffuse surface sends out in the light of a probe's harmonics: the cosine takes pi,
 * 2 pi / 3 and pi / 4 of the bands (Ramamoorthi and Hanrahan 2001), divided by pi. */
static void shade(const gw_probe *probe, const double n[3], double radiance[3])
{
	const double x = n[0], y = n[1], z = n[2], one = 2.0 / 3.0 * 0.4886025, two = 0.25 * 1.0925484;
	const double value[GW_PROBE_HARMONICS] = { 0.2820948,
											   one * y,
											   one * z,
											   one * x,
											   two * x * y,
											   two * y * z,
											   0.25 * 0.3153916 * (3.0 * z * z - 1.0),
											   two * x * z,
											   0.25 * 0.5462742 * (x * x - y * y) };
	for (size_t c = 0; c < 3; c++) {
		radiance[c] = 0.0;
		for (size_t h = 0; h < GW_PROBE_HARMONICS; h++)
			radiance[c] += value[h] * (double)probe->harmonic[h][c];
		radiance[c] = fmax(radiance[c], 0.0);
	}
}

/* How far along a way, as a multiple of it, a ball is met; infinity: it is not. */
static double meet(const ball *b, const double way[3])
{
	double square = 0.0, along = 0.0, off = 0.0;
	for (int k = 0; k < 3; k++) {
		square += way[k] * way[k];
		along += way[k] * b->centre[k];
		off += b->centre[k] * b->centre[k];
	}
	double root = along * along - square * (off - b->radius * b->radius);
	return root > 0.0 && along > 0.0 ? (along - sqrt(root)) / square : INFINITY;
}

/* The nearest ball in a direction of the camera's frame whose z is 1, before `depth`; or NULL. Adds
 * what it sends out. */
static const ball *look(const drawing *d, const double way[3], double depth, double sum[3])
{
	const double *const axis[3] = { d->camera.right, d->camera.up, d->camera.forward };
	const ball *nearest = NULL;
	double normal[3] = { 0.0 }, radiance[3];
	for (size_t i = 0; i < d->count; i++) {
		double at = meet(&d->balls[i], way);
		if (at < depth) {
			depth = at;
			nearest = &d->balls[i];
		}
	}
	if (!nearest)
		return NULL;
	for (int k = 0; k < 3; k++) {
		const double part = (depth * way[k] - nearest->centre[k]) / nearest->radius;
		for (int i = 0; i < 3; i++)
			normal[i] += part * axis[k][i];
	}
	shade(nearest->probe, normal, radiance);
	for (int k = 0; k < 3; k++)
		sum[k] += radiance[k];
	return nearest;
}

/* Lays the balls over a pixel, by the share of its samples in which they are seen. */
static void lay_over(const drawing *d, uint32_t x, uint32_t y)
{
	const size_t pixel = (size_t)y * WIDTH + x;
	const double step = 2.0 * d->camera.tangent / (double)(HEIGHT * SAMPLES);
	double sum[3] = { 0.0 };
	uint32_t hits = 0;
	for (uint32_t i = 0; i < SAMPLES * SAMPLES; i++) {
		const double column = x * SAMPLES + i % SAMPLES + 0.5,
					 row = y * SAMPLES + i / SAMPLES + 0.5;
		const double way[3] = { (column - 0.5 * WIDTH * SAMPLES) * step,
								(0.5 * HEIGHT * SAMPLES - row) * step, 1.0 };
		const ball *b = look(d, way, (double)d->g.depth[pixel], sum);
		if (b)
			d->seen[b - d->balls] = 1;
		hits += b != NULL;
	}
	if (hits == 0)
		return;
	const double share = hits / (double)(SAMPLES * SAMPLES);
	const double behind = (1.0 - share) * (double)d->g.coverage[pixel], all = share + behind;
	for (int k = 0; k < 3; k++) {
		float *value = &d->values[3 * pixel + (size_t)k];
		*value = (float)((sum[k] / hits * share + (double)*value * behind) / all);
	}
	d->g.coverage[pixel] = (float)all;
}

static void lay_rows(void *user, size_t first, size_t last, uint32_t worker)
{
	const drawing *d = user;
	(void)worker;
	for (size_t y = first; y < last; y++)
		for (uint32_t x = 0; x < WIDTH; x++)
			lay_over(d, x, (uint32_t)y);
}

/* ------------------------------------------------------------------------------- the picture */

/* As pictures of lit points have it: by what is seen, without what surfaces make themselves. */
static gw_status choose_exposure(const drawing *d, double *exposure, gw_error *error)
{
	const size_t pixels = (size_t)WIDTH * HEIGHT;
	const int own = d->scene.offset[RENDER_EMISSION];
	float *light = calloc(2 * pixels, 3 * sizeof *light), *emission = light + 3 * pixels;
	size_t count = 0;
	if (!light)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to meter the light");
	for (size_t i = 0; i < pixels; i++) {
		if (!(d->g.coverage[i] > 0.0f))
			continue;
		memcpy(light + 3 * count, d->values + 3 * i, 3 * sizeof *light);
		if (own >= 0)
			memcpy(emission + 3 * count, d->g.channel + d->g.channel_count * i + own,
				   3 * sizeof *light);
		count++;
	}
	*exposure = preview_exposure(light, emission, count);
	free(light);
	return GW_OK;
}

static gw_status write(drawing *d, output_file *out, gw_error *error)
{
	render_look look = { .view = SETTINGS_VIEW_RADIANCE,
						 .tone = PREVIEW_TONE_PBR_NEUTRAL,
						 .command = d->picture->settings->command };
	GW_TRY(choose_exposure(d, &look.exposure, error));
	return render_write_png(out, &d->scene, &look, &d->g, d->values, error);
}

/* Says which camera was found, so that the same picture can be taken again. */
static void put_camera(drawing *d)
{
	gw_viewpoint v = d->plan.view[0];
	coordinates_from_metres(&d->scene.place, v.at);
	coordinates_from_metres(&d->scene.place, v.to);
	if (!d->plan.text[0].placed)
		snprintf(d->picture->camera, sizeof d->picture->camera,
				 "at " CAMERA_TEXT_NUMBER "," CAMERA_TEXT_NUMBER "," CAMERA_TEXT_NUMBER
				 " to " CAMERA_TEXT_NUMBER "," CAMERA_TEXT_NUMBER "," CAMERA_TEXT_NUMBER " fov %g",
				 v.at[0], v.at[1], v.at[2], v.to[0], v.to[1], v.to[2], v.angle);
}

static gw_status draw(drawing *d, loaded_scene *loaded, output_file *out, gw_error *error)
{
	const render_scene_wish wish = { 1u << RENDER_RADIANCE | 1u << RENDER_EMISSION,
									 RENDER_OCTREE_NO, choose_points, d };
	GW_TRY(camera_plan_read(d->picture->settings, &d->plan, error));
	GW_TRY(put_light(d->picture, loaded, error));
	GW_TRY(render_scene_make(d->picture->settings, loaded, &wish, &d->scene, error));
	GW_TRY(draw_points(d, error));
	GW_TRY(place_balls(d, error));
	if (d->g.drawn == 0)
		return gw_fail(error, GW_ERROR_DATA,
					   "no point is in view; --camera auto finds a camera that sees some");
	gw_parallel_for(d->picture->settings->bake.threads, HEIGHT, ROWS, lay_rows, d);
	for (size_t i = 0; i < d->count; i++)
		d->picture->shown += d->seen[i];
	put_camera(d);
	return write(d, out, error);
}

gw_status probe_picture_write(probe_picture *picture, loaded_scene *loaded, output_file *out,
							  gw_error *error)
{
	drawing d = { .picture = picture, .scene = { .place = coordinates_metres() } };
	gw_status status = draw(&d, loaded, out, error);
	render_scene_clear(&d.scene);
	camera_plan_clear(&d.plan);
	gw_gbuffer_clear(&d.g);
	free(d.values);
	free(d.balls);
	free(d.seen);
	return status;
}

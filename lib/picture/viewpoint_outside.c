/* viewpoint_outside.c - things, terrain, and rooms without a side: from where to look at them. */
#include "picture/viewpoint_steps.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

#define AZIMUTHS 16
#define ELEVATIONS 3
#define SCANNERS 8   /* from which a view is tried */
#define SCANNED 1.1  /* what that is worth: from elsewhere, what they did not see is missing */
#define OWN_CELLS 2  /* around a surface that do not hide it */
#define DARK 0.15    /* what an unlit surface in view is worth */
#define FULL 1.5     /* times the cosine: surface counts as whole before it is seen straight on */
#define BACK 0.3     /* what a back is worth */
#define BLURRED 0.2  /* what is worth a surface whose normals cancel, such as leaves */
#define BETTER 1.001 /* times the value, so that equal views are seen from the front */
#define MARGIN 1.05  /* of a picture that holds all */
#define CLEAR 0.9    /* of the way to what counts: nearer, there are only strays */

/* What elevations are worth: low ones look natural, high ones show flat ground. */
static const double elevation_of[ELEVATIONS] = { 20, 35, 50 };
static const double worth_of[ELEVATIONS] = { 1.0, 0.95, 0.8 };

/* Surface that a far camera sees, by how well it does. */
static double value_direction(const view_space *v, const double d[3])
{
	double sum = 0;
	for (size_t i = 0; i < v->count; i++) {
		const view_cell *c = v->cell + i;
		int32_t at[3];
		if (!(c->area > 0.0f))
			continue;
		double facing = gw_view_space_facing(v, i, d);
		double worth = fmin(1, FULL * fabs(facing)) * (facing < 0 ? BACK : 1);
		gw_view_space_place(v, i, at);
		if (!(gw_view_space_look(v, at, d, OWN_CELLS).depth > 0))
			sum += (double)c->area * (BLURRED + (1 - BLURRED) * worth) *
				   (DARK + gw_view_space_lit(v, i));
	}
	return sum;
}

/* Keeps a direction that is better than the best one. */
static void try_direction(const view_space *v, const double d[3], double worth, double best[3],
						  double *most)
{
	double value = worth * value_direction(v, d);
	if (!(value > *most * BETTER))
		return;
	*most = value;
	for (int k = 0; k < 3; k++)
		best[k] = d[k];
}

static void try_scanners(const view_space *v, double best[3], double *most)
{
	size_t count = v->wish->scanner_count;
	for (size_t i = 0; i < count; i += count / SCANNERS + 1) {
		double d[3], length = 0;
		for (size_t k = 0; k < 3; k++) {
			d[k] = v->wish->scanner[3 * i + k] - v->surfels->origin[k] -
				   0.5 * (v->low[k] + v->high[k]);
			length += d[k] * d[k];
		}
		double steep = view_dot(d, v->up) / sqrt(length);
		for (int k = 0; k < 3; k++)
			d[k] /= sqrt(length);
		if (length > 0 && fabs(steep) < 0.98)
			try_direction(v, d, SCANNED, best, most);
	}
}

static void find_direction(const view_space *v, double best[3])
{
	double most = -1;
	try_scanners(v, best, &most);
	for (int e = 0; e < ELEVATIONS; e++)
		for (int a = 0; a < AZIMUTHS; a++) {
			double d[3];
			/* Starting at the front right, where equal views are drawn from. */
			gw_view_space_direction(v, M_PI * (2 * a + 3) / AZIMUTHS, elevation_of[e] * M_PI / 180,
									d);
			try_direction(v, d, worth_of[e], best, &most);
		}
}

/*
 * Where a camera has to stand to see all that counts, as near as it can. In the camera's frame
 * around the middle of the bounds, a point (x, y, z) is in the picture of a camera at (s, ., -d)
 * when |x - s| <= t (d + z). Over all points that is d >= a - s / t and d >= b + s / t with the
 * largest a = x / t - z and b = -x / t - z, so d = (a + b) / 2 and s = t (a - b) / 2; y likewise.
 * To see all from around, s is 0.
 */
typedef struct fit {
	double middle[3];
	double distance, shift[2];
	double nearest; /* of what counts, along the way the camera looks, from the middle */
} fit;

static void fit_picture(const view_space *v, const gw_camera *camera, fit *f)
{
	const gw_surfels *s = v->surfels;
	double tangent[2] = { camera->tangent * v->wish->aspect / MARGIN, camera->tangent / MARGIN };
	double a[2] = { -INFINITY, -INFINITY }, b[2] = { -INFINITY, -INFINITY };
	f->nearest = INFINITY;
	for (size_t i = 0; i < s->count; i++) {
		double world[3], view[3], radius = (double)s->radius[i];
		if (!gw_view_space_holds(v, s->position + 3 * i))
			continue;
		for (size_t k = 0; k < 3; k++)
			world[k] = (double)s->position[3 * i + k] - f->middle[k];
		gw_camera_turn(camera, world, view);
		radius = fmin(radius, v->width);
		f->nearest = fmin(f->nearest, view[2] - radius);
		for (int k = 0; k < 2; k++) {
			a[k] = fmax(a[k], (radius + view[k]) / tangent[k] - view[2]);
			b[k] = fmax(b[k], (radius - view[k]) / tangent[k] - view[2]);
		}
	}
	f->distance = fmax(a[0] + b[0], a[1] + b[1]) / 2;
	if (v->wish->around)
		f->distance = fmax(fmax(a[0], b[0]), fmax(a[1], b[1]));
	for (int k = 0; k < 2; k++)
		f->shift[k] = v->wish->around ? 0 : tangent[k] * (a[k] - b[k]) / 2;
}

/* The camera that looks from a direction at the middle, which is its place for fit_picture. */
static gw_status aim(const view_space *v, const double from[3], double angle, gw_camera *camera,
					 gw_error *error)
{
	const double nowhere[3] = { 0, 0, 0 }, backwards[3] = { -from[0], -from[1], -from[2] };
	return gw_camera_look(camera, nowhere, backwards, v->up, angle, error);
}

/* The largest distance and the nearest surface of a turn around what counts. */
static gw_status fit_around(const view_space *v, const double from[3], double angle, fit *f,
							gw_error *error)
{
	double height = view_dot(from, v->up), distance = f->distance, nearest = f->nearest;
	gw_status status = GW_OK;
	for (int a = 0; a < AZIMUTHS && status == GW_OK; a++) {
		double d[3];
		gw_camera camera;
		gw_view_space_direction(v, 2 * M_PI * a / AZIMUTHS, asin(height), d);
		status = aim(v, d, angle, &camera, error);
		if (status != GW_OK)
			break;
		fit_picture(v, &camera, f);
		distance = fmax(distance, f->distance);
		nearest = fmin(nearest, f->nearest);
	}
	f->distance = distance;
	f->nearest = nearest;
	return status;
}

gw_status gw_viewpoint_without(const view_space *v, gw_viewpoint *to, gw_error *error)
{
	double from[3] = { 0, 0, 1 };
	gw_camera camera;
	fit f = { .distance = 0 };
	find_direction(v, from);
	for (int k = 0; k < 3; k++)
		f.middle[k] = 0.5 * (v->low[k] + v->high[k]);
	to->angle = v->wish->angle > 0 ? v->wish->angle : GW_VIEWPOINT_ANGLE_OUTSIDE;
	GW_TRY(aim(v, from, to->angle, &camera, error));
	fit_picture(v, &camera, &f);
	if (v->wish->around)
		GW_TRY(fit_around(v, from, to->angle, &f, error));
	for (int k = 0; k < 3; k++) {
		to->to[k] = v->surfels->origin[k] + f.middle[k] + f.shift[0] * camera.right[k] +
					f.shift[1] * camera.up[k];
		to->at[k] = to->to[k] + f.distance * from[k];
	}
	to->near = fmax(0, CLEAR * (f.distance + f.nearest));
	to->inside = false;
	return GW_OK;
}

/* viewpoint_scanner.c - what one scanner saw that did not turn around: seen from its place, where
 * nothing of it is missing. */
#include "picture/viewpoint_steps.h"

#include "base/memory.h"
#include "base/nth_element.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TURNED 0.6    /* length of the mean direction to the points, below which it turned around */
#define STEEPEST 0.6  /* sine of the steepest view, 37 degrees: steeper ones look odd */
#define UPRIGHT 0.98  /* of the sine, too, 79 degrees: whoever looks down or up faces no way */
#define WIDEST 75.0   /* degrees, of a picture; what is beyond is left out */
#define NARROWEST 1.0 /* degrees */
#define CENTRAL 0.667 /* of the way to the picture's edge, where the middle of all may be */
#define MARGIN 1.05   /* of a picture that holds all */
#define BEYOND 100    /* one in so many points may lie beyond the picture */
#define CLEAR 0.9     /* of the way to what counts: nearer, there are only strays */

/* The mean of the unit vectors from a scanner to what counts, and its length. */
static double mean_direction(const view_space *v, const double scanner[3], double mean[3])
{
	const gw_surfels *s = v->surfels;
	double sum[3] = { 0, 0, 0 }, count = 0;
	for (size_t i = 0; i < s->count; i++) {
		double way[3], squared = 0;
		if (!gw_view_space_holds(v, s->position + 3 * i) || s->two_sided[i] == GW_SIDE_BACK)
			continue;
		for (size_t k = 0; k < 3; k++) {
			way[k] = s->origin[k] + (double)s->position[3 * i + k] - scanner[k];
			squared += way[k] * way[k];
		}
		for (int k = 0; k < 3 && squared > 0; k++)
			sum[k] += way[k] / sqrt(squared);
		count++;
	}
	double length = sqrt(view_dot(sum, sum));
	for (int k = 0; k < 3; k++)
		mean[k] = sum[k] / length;
	return count > 0 ? length / count : 0;
}

/* Turns a direction towards the horizon until it is not too steep. */
static void level(const view_space *v, double d[3])
{
	double steep = view_dot(d, v->up), flat = sqrt(fmax(1 - steep * steep, 0));
	double wanted = fmin(fmax(steep, -STEEPEST), STEEPEST);
	if (fabs(steep) <= STEEPEST)
		return;
	for (int k = 0; k < 3; k++)
		d[k] = (d[k] - steep * v->up[k]) / flat * sqrt(1 - wanted * wanted) + wanted * v->up[k];
}

/* Half the height of the picture that holds what counts but for a few, on the plane one metre in
 * front of the camera; slope is of count. */
static double fit(const view_space *v, const gw_camera *camera, float *slope, double *nearest)
{
	const gw_surfels *s = v->surfels;
	size_t count = 0;
	*nearest = INFINITY;
	for (size_t i = 0; i < s->count; i++) {
		double world[3], view[3];
		if (!gw_view_space_holds(v, s->position + 3 * i))
			continue;
		for (size_t k = 0; k < 3; k++)
			world[k] = s->origin[k] + (double)s->position[3 * i + k] - camera->position[k];
		gw_camera_turn(camera, world, view);
		double side = fmax(fabs(view[0]) / v->wish->aspect, fabs(view[1]));
		slope[count++] = view[2] > 0 ? (float)fmin(side / view[2], 1e6) : 1e6f;
		if (view[2] > 0)
			*nearest = fmin(*nearest, view[2]);
	}
	return (double)gw_nth_element(slope, count, count - 1 - count / BEYOND);
}

/* Stands there and looks `way`, unless what the scanner saw, on the mean in the direction of
 * `mean`, would lie at the picture's edge: as the ground does below an aeroplane, of which a level
 * view shows a line. */
static gw_status stand(const view_space *v, const double mean[3], const double way[3], float *slope,
					   gw_viewpoint *to, gw_error *error)
{
	const double *scanner = v->wish->scanner;
	gw_camera camera;
	double ahead[3], nearest, distance = 0;
	for (int k = 0; k < 3; k++) {
		double middle = v->surfels->origin[k] + 0.5 * (v->low[k] + v->high[k]) - scanner[k];
		ahead[k] = scanner[k] + way[k];
		distance += middle * way[k];
	}
	GW_TRY(gw_camera_look(&camera, scanner, ahead, v->up, WIDEST, error));
	double tangent = MARGIN * fit(v, &camera, slope, &nearest);
	double angle = fmin(fmax(atan(tangent) * 360 / M_PI, NARROWEST), WIDEST);
	double turned = fmax(view_dot(mean, way), 0);
	if (!(sqrt(1 - fmin(turned * turned, 1)) < CENTRAL * tan(angle * M_PI / 360) * turned))
		return GW_OK;
	to->angle = v->wish->angle > 0 ? v->wish->angle : angle;
	for (int k = 0; k < 3; k++) {
		to->at[k] = scanner[k];
		to->to[k] = scanner[k] + fmax(distance, nearest) * way[k];
	}
	to->near = CLEAR * nearest;
	to->from_scanner = true;
	return GW_OK;
}

gw_status gw_viewpoint_of_scanner(const view_space *v, gw_viewpoint *to, gw_error *error)
{
	double mean[3], way[3];
	if (v->wish->scanner_count != 1 || mean_direction(v, v->wish->scanner, mean) < TURNED)
		return GW_OK;
	if (fabs(view_dot(mean, v->up)) > UPRIGHT)
		return GW_OK;
	memcpy(way, mean, sizeof way);
	level(v, way);
	float *slope = gw_allocate_array(v->surfels->count, sizeof *slope);
	if (!slope)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to look for a viewpoint");
	gw_status status = stand(v, mean, way, slope, to, error);
	free(slope);
	return status;
}

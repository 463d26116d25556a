/* camera.c - setting up and turning a pinhole camera; see glowworm_picture.h. */
#include "glowworm_picture.h"
#include "glowworm_host.h"

#include "base/up_axis.h"

#include <math.h>

/* Least sine of the angle between view direction and up. */
#define PARALLEL 1e-6

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double c[3])
{
	c[0] = a[1] * b[2] - a[2] * b[1];
	c[1] = a[2] * b[0] - a[0] * b[2];
	c[2] = a[0] * b[1] - a[1] * b[0];
}

/* Makes a vector a unit one and returns the length it had. */
static double normalize(double v[3])
{
	double length = sqrt(dot(v, v));
	for (int k = 0; k < 3 && length > 0; k++)
		v[k] /= length;
	return length;
}

static bool is_finite(const double v[3])
{
	return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

gw_status gw_camera_look(gw_camera *camera, const double at[3], const double to[3],
						 const double up[3], double angle, gw_error *error)
{
	if (!(angle > 0 && angle <= GW_CAMERA_ANGLE_MAX))
		return gw_fail(error, GW_ERROR_USAGE,
					   "the camera's angle of view is %s degrees; it must be above 0 and at most "
					   "%s",
					   GW_SAID(angle, 6), GW_SAID(GW_CAMERA_ANGLE_MAX, 6));
	if (!is_finite(at) || !is_finite(to) || !is_finite(up))
		return gw_fail(error, GW_ERROR_USAGE, "a coordinate of the camera is not finite");
	gw_camera c = { .tangent = tan(angle * M_PI / 360) };
	double upright[3], size = 0;
	for (int k = 0; k < 3; k++) {
		c.position[k] = at[k];
		c.forward[k] = to[k] - at[k];
		upright[k] = up[k];
		size = fmax(size, fmax(fabs(at[k]), fabs(to[k])));
	}
	/* Coordinates have 53 bits: a shorter way between them has no direction left. */
	double distance = normalize(c.forward);
	if (!(distance > size * 0x1p-48) || !is_finite(c.forward))
		return gw_fail(error, GW_ERROR_USAGE,
					   "the camera stands at %s,%s,%s, which is where it looks; give it another "
					   "'at' or 'to'",
					   GW_SAID_PLACE(at[0]), GW_SAID_PLACE(at[1]), GW_SAID_PLACE(at[2]));
	normalize(upright);
	cross(c.forward, upright, c.right);
	if (!(normalize(c.right) > PARALLEL))
		return gw_fail(
			error, GW_ERROR_USAGE,
			"the camera looks straight along the up axis, so that no side of the "
			"picture is up; move 'at' or 'to' a little, or choose another axis to be up");
	cross(c.right, c.forward, c.up);
	*camera = c;
	return GW_OK;
}

void gw_camera_up(char up, double axis[3])
{
	gw_up_axis(up, axis);
}

void gw_camera_stand(char axis, double right[3], double back[3], double up[3])
{
	gw_camera_up(axis, up);
	for (int k = 0; k < 3; k++)
		right[k] = k == (up[0] != 0.0 ? 1 : 0);
	cross(up, right, back);
}

void gw_camera_turn(const gw_camera *camera, const double world[3], double view[3])
{
	double v[3] = { dot(camera->right, world), dot(camera->up, world),
					dot(camera->forward, world) };
	for (int k = 0; k < 3; k++)
		view[k] = v[k];
}

/* The sides of the picture are planes x = t z and y = t z; a ball's distance from one is
 * (x - t z) / sqrt(1 + t^2). */
bool gw_camera_sees(const gw_camera *camera, double aspect, const double centre[3], double radius)
{
	double way[3], view[3];
	for (int k = 0; k < 3; k++)
		way[k] = centre[k] - camera->position[k];
	gw_camera_turn(camera, way, view);
	double tangent[2] = { camera->tangent * aspect, camera->tangent };
	for (int k = 0; k < 2; k++)
		if (fabs(view[k]) - tangent[k] * view[2] > radius * sqrt(1 + tangent[k] * tangent[k]))
			return false;
	return view[2] + radius >= camera->near;
}

/* Rodrigues' formula. */
static void rotate(double v[3], const double axis[3], double radians)
{
	double c = cos(radians), s = sin(radians), side[3], along = dot(axis, v);
	cross(axis, v, side);
	for (int k = 0; k < 3; k++)
		v[k] = c * v[k] + s * side[k] + (1 - c) * along * axis[k];
}

void gw_camera_orbit(gw_camera *camera, const double centre[3], const double axis[3],
					 double radians)
{
	double arm[3];
	for (int k = 0; k < 3; k++)
		arm[k] = camera->position[k] - centre[k];
	rotate(arm, axis, radians);
	rotate(camera->right, axis, radians);
	rotate(camera->up, axis, radians);
	rotate(camera->forward, axis, radians);
	for (int k = 0; k < 3; k++)
		camera->position[k] = centre[k] + arm[k];
}

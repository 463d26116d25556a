/*
 * camera.h - a pinhole camera: where it stands, where it looks, and how wide.
 *
 * A camera is in double precision and in the coordinates of gw_points.position. In its own frame x
 * points right, y up and z the way it looks; a point (x, y, z) there is seen at (x / z, y / z) on
 * the image plane, whose half height is `tangent`.
 */
#ifndef CAMERA_H
#define CAMERA_H

#include "glowworm.h"

typedef struct gw_camera {
	double position[3];                 /* metres */
	double right[3], up[3], forward[3]; /* unit, orthogonal */
	double tangent;                     /* of half the vertical angle of view, above 0 */
	double near;                        /* metres along `forward`; nothing nearer is seen */
} gw_camera;

/* The widest vertical angle of view, degrees: a pinhole's picture grows without bound to 180. */
#define GW_CAMERA_ANGLE_MAX 175.0

/*
 * Sets a camera up.
 *   camera   receives it; its near distance is 0, to be set by the caller
 *   at, to   metres; where it stands and a point in the middle of its picture
 *   up       which way is up in the picture; any length above 0
 *   angle    degrees, vertical angle of view, above 0 and at most GW_CAMERA_ANGLE_MAX
 * Fails with GW_ERROR_USAGE when the angle is outside of that, a number is not finite, `at` is `to`
 * or so near to it that doubles cannot tell the direction, or it looks straight along `up`.
 */
gw_status gw_camera_look(gw_camera *camera, const double at[3], const double to[3],
						 const double up[3], double angle, gw_error *error);

/* Turns a vector from the world's axes to the camera's. */
void gw_camera_turn(const gw_camera *camera, const double world[3], double view[3]);

/*
 * Whether something of a ball may be in the picture; also true for some that are just outside.
 *   aspect   width of the picture by its height
 *   centre   metres
 *   radius   metres, 0 or more
 */
bool gw_camera_sees(const gw_camera *camera, double aspect, const double centre[3], double radius);

/*
 * Turns a camera by an angle around an axis through a point, counterclockwise as seen from the
 * tip of the axis.
 *   centre   metres
 *   axis     unit
 *   radians  any
 */
void gw_camera_orbit(gw_camera *camera, const double centre[3], const double axis[3],
					 double radians);

#endif

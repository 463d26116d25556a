/*
 * viewpoint.h - from where to look at a cloud when nobody says it.
 */
#ifndef VIEWPOINT_H
#define VIEWPOINT_H

#include "surfels/surfels.h"

/* What is asked of a viewpoint. */
typedef enum gw_viewpoint_kind {
	GW_VIEWPOINT_AUTO,    /* inside when the surface encloses a space, else outside */
	GW_VIEWPOINT_INSIDE,  /* from within the space that the surface encloses */
	GW_VIEWPOINT_OUTSIDE, /* from without, all of the cloud in the picture */
	GW_VIEWPOINT_COUNT
} gw_viewpoint_kind;

/* Vertical angles of view that suit them, degrees. */
#define GW_VIEWPOINT_ANGLE_INSIDE 55.0
#define GW_VIEWPOINT_ANGLE_OUTSIDE 40.0

typedef struct gw_viewpoint {
	double at[3], to[3]; /* metres, in the coordinates of gw_points.position */
	double angle;        /* degrees, vertical angle of view */
	bool inside;
} gw_viewpoint;

/*
 * How much of the surface looks inwards, -1 (a closed object seen from outside) to 1 (a closed room
 * with normals into it): by the divergence theorem the sum of area * normal * position is three
 * times the volume that the surface encloses; it is divided by the sum of its terms' magnitudes.
 * Surfels whose normals cannot be trusted do not count. About 0 for terrain.
 */
double gw_viewpoint_enclosure(const gw_surfels *surfels);

/*
 * Finds a viewpoint.
 *
 * Outside: slightly from above, at that of eight azimuths from which most light is seen, as near as
 * the picture holds all surfels. Inside: space is cut into coarse cells; from each free one (or
 * some thousand of them) rays go out in all directions. Where most of them meet the front of a
 * surface the cell is inside; the view is best that sees far, and lit surfaces. Unless inside was
 * asked for, a space that is open on a side, such as a stage, is looked at from outside.
 *
 *   luminance   count of the surfels, or NULL: all count as lit
 *   up          'y' or 'z'
 *   kind        GW_VIEWPOINT_INSIDE falls back to outside when no cell is enclosed
 *   angle       degrees, vertical angle of view; 0: the one that suits
 *   aspect      width of the picture by its height
 * Fails with GW_ERROR_MEMORY.
 */
gw_status gw_viewpoint_find(const gw_surfels *surfels, const float *luminance, char up,
							gw_viewpoint_kind kind, double angle, double aspect,
							gw_viewpoint *viewpoint, gw_error *error);

#endif

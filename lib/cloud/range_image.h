/*
 * range_image.h - what rows and columns of a scan tell of its surface, before anything is made of
 * the points. Internal to lib/.
 *
 * Neighbours in the grid were seen in neighbouring directions, so that the surface between them is
 * known without a search: the range is smooth along it and jumps where it ends. On a plane
 * the inverse of the range is linear in the direction, whatever the grid; and noise and steps of
 * the range are along the rays. So each point gets the largest window of the grid, around it or
 * beside it, whose points are on one plane but for the noise. Its normal is that plane's, and where
 * there is noise its range is. What no plane holds, and lies between something nearer and something
 * further off that planes do hold, is a mixed pixel: the mean of two ranges, and no surface.
 *
 * Steps: range_steps.h.
 */
#ifndef RANGE_IMAGE_H
#define RANGE_IMAGE_H

#include "glowworm_picture.h"

/* Points with what their range images tell. */
typedef struct gw_ranged_points {
	gw_points points; /* those that came, with what follows in place, and without images */
	gw_surfels_options options; /* that came, but for what is to be done with normals: those of
								   images count as given */
	double *position;           /* NULL or owned: with less noise */
	float *normal;              /* NULL or owned: those that were missing */
	size_t normals;             /* how many of those */
	float *own_area;            /* NULL or owned: that of things as thin as a cell */
	uint8_t *stray;             /* NULL or owned: those that came, and those found */
} gw_ranged_points;

/*
 * Looks at all range images of some points. Those of which rays do not begin at their scanner, or
 * of which most cells are empty, tell nothing. The outcome is the same for any number of threads.
 *
 *   points   must live as long as the outcome, which is the same where there are no images
 *   ranged   on success to be cleared with gw_ranged_points_clear
 *
 * Fails with GW_ERROR_MEMORY.
 */
gw_status gw_range_images_use(const gw_points *points, const gw_surfels_options *options,
							  gw_ranged_points *ranged, gw_error *error);
void gw_ranged_points_clear(gw_ranged_points *ranged);

#endif

/*
 * filled_space.h - points that fill space, such as leaves, and lie on no surface with those around
 * them. Internal to lib/.
 *
 * A disc that reached to its neighbours would be a plate in the air there, and what is noise on a
 * surface is none: such points stay where they are, and each stands for a small disc by itself.
 */
#ifndef FILLED_SPACE_H
#define FILLED_SPACE_H

#include "cloud/neighbours.h"

/* Points that stand by themselves. */
typedef struct gw_lone_points {
	uint8_t *filled;  /* count, owned, 1: it is such a point */
	uint8_t *foliage; /* count, owned, 1: and most of those around it are, too */
	float *area;      /* count or NULL, owned, m^2: what its disc has to have; 0: as those around it
						 leave */
	bool sides_known; /* normals that were missing face the scanner */
} gw_lone_points;

/*
 * Finds them. Near creases and in corners neighbours fill space, too, but not those of most
 * neighbours; noise of half a spacing is thinner.
 *   points    those of the surfels; with beam_share, those of leaves have the area that beams tell
 *             (beam_area.h); with own_area, these stand by themselves, too, with the area
 *             that is left to each when all scanners that saw the thing are taken together
 *   search    of the surfels, where points say that they are
 *   surfels   with normals
 *   lone      on success receives them, to be cleared with gw_lone_points_clear
 * Fails with GW_ERROR_MEMORY or GW_ERROR_CANCELLED.
 */
gw_status gw_filled_space_find(const gw_points *points, gw_neighbours *search,
							   const gw_surfels *surfels, gw_lone_points *lone, gw_error *error);
void gw_lone_points_clear(gw_lone_points *lone);

/*
 * The least share that a direction has in the squares of the distances of a place and its
 * neighbours from their middle: 0 where they lie in a plane, a third where they fill a ball.
 */
double gw_filled_space_thickness(const gw_surfels *surfels, const double place[3],
								 const gw_neighbour_list *list);

/* The disc of such a point: metres from it to where what is around begins, about. Evenly filled
 * space is seen through for some three times the distance between points. */
float gw_filled_space_radius(const gw_neighbour_list *list);

#endif

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

/*
 * Finds them. Near creases and in corners neighbours fill space, too, but not those of most
 * neighbours; noise of half a spacing is thinner.
 *   search    of the surfels, where points say that they are
 *   surfels   with normals
 *   filled    on success receives one a surfel, 1: it is such a point; for free()
 * Fails with GW_ERROR_MEMORY or GW_ERROR_CANCELLED.
 */
gw_status gw_filled_space_find(gw_neighbours *search, const gw_surfels *surfels, uint8_t **filled,
							   gw_error *error);

/* The disc of such a point: metres from it to where what is around begins, about. Evenly filled
 * space is seen through for some three times the distance between points. */
float gw_filled_space_radius(const gw_neighbour_list *list);

#endif

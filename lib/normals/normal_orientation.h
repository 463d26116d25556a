/*
 * normal_orientation.h - which of its two sides a surface shows, where normals were estimated and
 * nobody knows where the scanner stood. Internal to lib/.
 *
 * A normal from a fitted plane has no sign. Signs are carried from neighbour to neighbour along
 * smooth surface to patches of some dozens of surfels, and across the patches' borders by the sum
 * of the pairs that meet there (patch_signs.h). Of what hangs together one sign is open then, and
 * that is the one with which
 *
 *   normals given   most agree, if there are any
 *   scanners        see more of it, if it is known where some stood
 *   light           more falls on the front than on the back (side_light.h), rooms before others:
 *                   that of a sky, unless its fronts get hardly any light of this bake
 *
 * Of what hangs together and emits for the most part the front is the side from which its light
 * gets farther, to what does not emit.
 *
 * What a sky would choose and this light does not get to is lit from both sides, so that it is not
 * black, unless a lamp stands within; and so is what is closed, large enough to stand in, and lit
 * from outside alone, since a room looks the same as a thing from there.
 *
 * What others lie within, from which they see hardly anything else, is a room and shows its inside
 * in any light (shells.h).
 *
 * Of ground that was seen from above alone (seen_from_above.h) all has its front up, but walls.
 *
 * Parts that touch the rest in a few places, as a thing does the floor that it stands on, are
 * turned against it where their light says so and their borders say less.
 *
 * Source: Hoppe et al., Surface Reconstruction from Unorganized Points, SIGGRAPH 1992, section 3.3
 * (signs carried along a tree of neighbours); the sign across a crease by reflection is that of
 * Koenig and Gumhold, Consistent Propagation of Normal Orientations in Point Clouds, VMV 2009.
 */
#ifndef NORMAL_ORIENTATION_H
#define NORMAL_ORIENTATION_H

#include "cloud/neighbours.h"

/* What is known of sides. */
typedef struct gw_known_sides {
	const uint8_t *estimated; /* surfels->count: 1 where the normal may be turned, 0 where it was
								 given */
	const double *scanner; /* 3 * scanner_count, metres as surfels->position: where some stood, of
							  which nobody knows what they saw */
	size_t scanner_count;
} gw_known_sides;

/*
 * Turns estimated normals to the front of their surface.
 *   options    whose lights are asked; those without power count as absent
 *   search     over the surfels
 *   surfels    normals of all, unit length; emission where there is some
 *   doubtful   surfels->count, receives GW_SIDE_UNCLEAR where about as much light falls on both
 *              sides, or ways to decide dispute the side; 1 where it does, but one side is more
 *              like a room's; else 0
 * The result depends on the surfels' order in the arrays, which is canonical, and not on threads.
 * Fails with GW_ERROR_MEMORY or GW_ERROR_CANCELLED.
 */
gw_status gw_orient_normals(const gw_surfels_options *options, gw_neighbours *search,
							gw_surfels *surfels, const gw_known_sides *known, uint8_t *doubtful,
							gw_error *error);

#endif

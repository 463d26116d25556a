/*
 * normal_orientation.h - which of its two sides a surface shows, where normals were estimated and
 * nobody knows where the scanner stood. Internal to lib/.
 *
 * A normal from a fitted plane has no sign. Signs are carried from neighbour to neighbour along
 * smooth surface, then across creases by the majority of the pairs that meet there; what is joined
 * is one component, of which only one bit is open. That bit is decided for the component as a
 * whole:
 *
 *   normals given     by most of those in the component
 *   lamps, emitters   free space is where they are: their light falls on the front. From a lamp
 *                     inside a closed component the fronts fill 4 pi, from one outside it 0
 *   up                where there is no lamp: ground is seen from above, unless as much of the
 * component looks down, as a ceiling does sun               likewise: the sun shines on the front
 * room what encloses space was seen from inside, if it spans most of the scene; else it is a body,
 * seen from outside middle            what is left faces the middle of the scene
 *
 * Source: Hoppe et al., Surface Reconstruction from Unorganized Points, SIGGRAPH 1992, section 3.3
 * (signs carried along a tree of neighbours); the sign across a crease by reflection is that of
 * Koenig and Gumhold, Consistent Propagation of Normal Orientations in Point Clouds, VMV 2009.
 */
#ifndef NORMAL_ORIENTATION_H
#define NORMAL_ORIENTATION_H

#include "surfels/surfel_steps.h"

/*
 * Turns estimated normals to the front of their surface.
 *   options    whose lights are asked; those without power count as absent
 *   search     over the surfels
 *   surfels    normals of all, unit length; emission where there is some
 *   estimated  surfels->count: 1 where the normal may be turned, 0 where it was given
 *   doubtful   surfels->count, receives 1 where a component's side is but a guess, else 0
 * The result depends on the surfels' order in the arrays, which is canonical, and not on threads.
 * Fails with GW_ERROR_MEMORY or GW_ERROR_CANCELLED.
 */
gw_status gw_orient_normals(const gw_surfels_options *options, gw_neighbours *search,
							gw_surfels *surfels, const uint8_t *estimated, uint8_t *doubtful,
							gw_error *error);

#endif

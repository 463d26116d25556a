/*
 * plane_doubt.h - where it is in doubt whether there is a surface between points at all. Internal
 * to lib/.
 *
 * Where things are as narrow as points are apart, as leaves and wires, the neighbours of a point
 * lie on several of them, and the plane through all is that of none. The nearest few lie on one, so
 * that the two planes have nothing to do with each other; where there is a surface both are its
 * own, and in creases most are. Of the mean square angle between directions at random, pi - 2, that
 * between the two is what says that the point's plane is one at random. Its mean over the point and
 * its neighbours is the chance that the discs there are plates in the air, whose extent nobody
 * knows: a ray meets several that overlap, which are all of them or none.
 *
 * Rows and columns, and what beams leave behind, tell how much surface such points stand for; given
 * normals do, too, since discs of few alike are small.
 */
#ifndef PLANE_DOUBT_H
#define PLANE_DOUBT_H

#include "surfels/filled_space.h"

/*
 * Fills surfels->doubt where there is any.
 *   points    those of the surfels
 *   search    of the surfels, at their given places
 *   surfels   with normals; shading_normal_off is above 0 where they were missing
 *   lone      points that stand by themselves: their discs reach to no others
 * Fails with GW_ERROR_MEMORY or GW_ERROR_CANCELLED.
 */
gw_status gw_plane_doubt_find(const gw_points *points, gw_neighbours *search,
							  const gw_lone_points *lone, gw_surfels *surfels, gw_error *error);

#endif

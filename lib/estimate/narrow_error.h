/*
 * narrow_error.h - how wrong the light is because nobody knows how much of narrow things is there.
 *
 * Leaves and wires that are as narrow as points are apart become plates in the air, which shade too
 * much, whatever points are left out: those of half of the points are as much wider as they are
 * fewer. How likely it is of a disc that it is one plane_doubt.h says. A point of such a thing
 * stands for some surface at least, however little, and for the whole disc at most. Where nothing
 * tells more, one share is as likely as another. With d what a point's light gains where none of
 * these discs is there, and that gain in proportion to the share that is not, the bake, which has
 * all of them, is off by a mean square of d^2 / 3.
 *
 * Discs of one thing overlap, and a ray meets several. They are all plates or none, so each point
 * that is looked from has one number between 0 and 1, and all discs are gone for it whose chance is
 * no less than that. Rays to the lamps and all around, through the points' discs by themselves
 * (check_discs.h), say what it sees with and without them.
 */
#ifndef NARROW_ERROR_H
#define NARROW_ERROR_H

#include "estimate/side_error.h"

/*
 *   task     as sides are asked for; its surfels' doubt, its discs, light and seed are looked at
 *   counts   one a surfel: whether its error counts
 *   rms      receives the root mean square error of these, luminance of radiance; 0 where no disc
 *            is in doubt
 * Fails with GW_ERROR_MEMORY or GW_ERROR_CANCELLED.
 */
gw_status gw_narrow_error(const gw_side_task *task, const bool *counts, double *rms,
						  gw_error *error);

#endif

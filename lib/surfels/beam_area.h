/*
 * beam_area.h - what area points stand for through which their beams went on. Internal to lib/.
 *
 * A laser from above that meets a crown is split: some of it stops at each of several leaves, the
 * rest at the ground. In a column of the cloud the beams that stop in a layer, over those that get
 * there, are the share of it that leaves cover (MacArthur and Horn 1969, Foliage profile by
 * vertical measurements, Ecology 50), and of what comes straight down as much gets to the ground as
 * has its points there. So what a point covers is known, however far apart leaves are.
 */
#ifndef BEAM_AREA_H
#define BEAM_AREA_H

#include "cloud/surfels.h"

/*
 * How much each point covers as seen from above.
 *   points   with beam_share
 *   share    count of surfels, receives how much of a beam stopped there, 1 where nobody said
 *   area     count of surfels, receives it, m^2
 * Fails with GW_ERROR_MEMORY.
 */
gw_status gw_beam_areas(const gw_points *points, const gw_surfels *surfels, float *share,
						float *area, gw_error *error);

#endif

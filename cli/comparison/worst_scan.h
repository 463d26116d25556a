/*
 * worst_scan.h - the points with the largest errors, as a cloud.
 */
#ifndef WORST_SCAN_H
#define WORST_SCAN_H

#include "comparison/compare_figures.h"

/*
 * Picks the points where the luminance of the radiance is furthest from the truth, worst first.
 * They have all columns of the compared cloud, then scalar_error (difference divided by the mean
 * of the truth, above 0 where the result is too bright) and scalar_truth_radiance_*.
 *
 *   wanted  how many points, if there are as many
 *   worst   on success owned by the caller, freed with scan_clear; empty on failure
 */
gw_status worst_scan_make(const compare_figures *figures, size_t wanted, scan *worst,
						  gw_error *error);

#endif

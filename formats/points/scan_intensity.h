/*
 * scan_intensity.h - what a laser's echo says of the surface, without what distance and angle do to
 * it.
 */
#ifndef SCAN_INTENSITY_H
#define SCAN_INTENSITY_H

#include "points/scan.h"

/*
 * The intensity of each point. Where the scanners' places are known, the power of the range with
 * which it falls, 2 at most, and that of the cosine between beam and normal, 1 at most, are fitted
 * and divided out. Intensities that were corrected before show little of either and stay as they
 * are. Normals are the scan's, or estimated.
 *   threads  0: one a core
 *   value    on success scan->count values, freed by the caller; those that are not finite stay
 *   how      a phrase that says what was done, or ""
 * GW_ERROR_USAGE when there is no intensity; GW_ERROR_MEMORY.
 */
gw_status scan_intensity_make(const scan *scan, uint32_t threads, float **value, char how[120],
							  gw_error *error);

/* The value with a hundredth of all finite ones above it; 0 when there are none. Changes their
 * order. */
float scan_intensity_full(float *value, size_t count);

#endif

/*
 * shading_normals.h - normals without their noise, for lamps to shine on, and how far off they are.
 *
 * The mean of all normals around a point has little noise left but no edges either. So each normal
 * becomes the mean of those around it that are alike (a bilateral filter); what is alike is judged
 * by the given normals first, and once more by the means that this made, which differ by less
 * noise. That is mixed with the mean of all, in the shares that leave the least error.
 *
 * That error is known without knowing the truth (Stein 1981, "Estimation of the mean of a
 * multivariate normal distribution"): for normals y with noise of variance v, made f(y), the mean
 * of |f - y|^2 - v + v trace(df/dy) is that of |f - truth|^2. It counts both what is left of noise
 * and what was blurred.
 */
#ifndef SHADING_NORMALS_H
#define SHADING_NORMALS_H

#include "normals/normal_noise.h"

/* Normals with noise in them, and what is known of it. */
typedef struct gw_noisy_normals {
	const float *smooth; /* 3 * count, the mean normals, and */
	const float *own;    /* count, the share of each given normal in its mean */
	float *noise;        /* GW_NOISE_REGION surfels an element, variance of the given normals by
							noise, rad^2 */
	float *spare;        /* 3 * count floats to work in */
} gw_noisy_normals;

/*
 * Takes noise out of the given normals.
 *   search     of the surfels at their given positions
 *   surfels    normal is replaced
 *   off        count, receives the RMS angle by which the new normals are off, radians: one value a
 *              region
 * Fails with GW_ERROR_MEMORY or GW_ERROR_CANCELLED.
 */
gw_status gw_shading_normals_make(gw_neighbours *search, gw_surfels *surfels,
								  const gw_noisy_normals *normals, float *off, gw_error *error);

#endif

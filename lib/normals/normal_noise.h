/*
 * normal_noise.h - how much noise the given normals have.
 *
 * The squared difference of two normals next to each other, of the same piece of surface, is noise
 * twice; its two axes make its distribution exponential. Over an edge it is larger. So what is seen
 * is taken for a mixture of two exponential distributions, whose parameters follow by expectation
 * maximisation (Dempster, Laird and Rubin 1977); the narrow one is noise. Normals of a curved
 * surface differ too, by the square of the distance: that is found by doing it for neighbours next
 * to the point and further away, and taking off what the distance makes.
 */
#ifndef NORMAL_NOISE_H
#define NORMAL_NOISE_H

#include "cloud/neighbours.h"

/* Surfels, next to each other in Morton order, that have their noise in common. */
#define GW_NOISE_REGION 4096u

/*
 * Squared difference of the normals of two surfels; NAN where their surfaces are different.
 *   sign   receives -1 where the other's normal is to be turned round to fit, as that of points
 *          lit from both sides may be, else 1
 */
double gw_normal_difference(const gw_surfels *surfels, size_t surfel, size_t other, double *sign);

/*
 * Finds the variance of the given normals by noise, both axes together.
 *   noise   (count - 1) / GW_NOISE_REGION + 1, receives it, rad^2, of each region
 *   spare   3 * count floats to work in
 * Fails with GW_ERROR_MEMORY or GW_ERROR_CANCELLED.
 */
gw_status gw_normal_noise(gw_neighbours *search, const gw_surfels *surfels, float *noise,
						  float *spare, gw_error *error);

#endif

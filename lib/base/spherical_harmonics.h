/*
 * spherical_harmonics.h - real spherical harmonics, for directional quantities kept as few numbers.
 */
#ifndef SPHERICAL_HARMONICS_H
#define SPHERICAL_HARMONICS_H

#ifdef __cplusplus
extern "C" {
#endif

/*
 * Real spherical harmonics of `order` 1..3 (bands 0..order-1: order*order values) in the unit
 * direction, orthonormal over the sphere (Ramamoorthi and Hanrahan 2001, equation 3).
 *   direction   3, unit
 *   value       receives order * order values. Band 0: one; band 1: m = -1, 0, 1, which are y, z,
 * x, with the signs sqrt(3/4pi) * (+y, +z, +x); band 2: m = -2..2, which are xy, yz, 3z^2-1, xz,
 * x^2-y^2
 */
void gw_spherical_harmonics(const float direction[3], int order, float *value);

#ifdef __cplusplus
}
#endif

#endif

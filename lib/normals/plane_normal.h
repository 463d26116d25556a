/*
 * plane_normal.h - the plane through a few points, by PCL.
 */
#ifndef PLANE_NORMAL_H
#define PLANE_NORMAL_H

#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum gw_plane { GW_PLANE_FOUND, GW_PLANE_NONE, GW_PLANE_NO_MEMORY } gw_plane;

/*
 * Unit normal of the least-squares plane through points.
 *   point      3 * count, around the origin and of about unit size
 *   normal     receives the normal, its sign is arbitrary
 *   curvature  receives the smallest eigenvalue of the covariance over the sum of all three
 * Returns GW_PLANE_NONE when the points give no plane (fewer than 3, not finite). Thread-safe.
 */
gw_plane gw_plane_normal(const float *point, size_t count, float normal[3], float *curvature);

/*
 * The same of a covariance: xx, xy, xz, yy, yz, zz.
 *   least   receives its smallest eigenvalue
 * Returns false where it is not finite. Thread-safe.
 */
bool gw_plane_of_covariance(const double covariance[6], double normal[3], double *least);

#ifdef __cplusplus
}
#endif

#endif

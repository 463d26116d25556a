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

/*
 * Unit normal of the least-squares plane through points.
 *   point      3 * count, around the origin and of about unit size
 *   normal     receives the normal, its sign is arbitrary
 *   curvature  receives the smallest eigenvalue of the covariance over the sum of all three
 * Returns false when the points give no plane (fewer than 3, not finite) or memory is short.
 * Thread-safe.
 */
bool gw_plane_normal(const float *point, size_t count, float normal[3], float *curvature);

#ifdef __cplusplus
}
#endif

#endif

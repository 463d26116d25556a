/*
 * glowworm_parts.h - public interface of libglowworm for clouds that memory does not hold: some of
 * their points, few enough, are baked as a surface, and all others are lit by it, part by part.
 *
 * It reads and writes no files either. What is not said otherwise is as in glowworm.h.
 */
#ifndef GLOWWORM_PARTS_H
#define GLOWWORM_PARTS_H

#include "glowworm.h"

#ifdef __cplusplus
extern "C" {
#endif

#ifdef __GNUC__
#pragma GCC visibility push(default)
#endif

typedef struct gw_lit_surface gw_lit_surface;

/*
 * Makes a surface ready to light points beside it.
 *   points    of the surface; they are referred to until it is closed, as is lit
 *   lit       what gw_bake made of them
 *   options   it was baked with: of these normals, threads and max_error are
 *             looked at
 *   surface   receives it, to be given back with gw_lit_surface_close; NULL on failure
 * Fails with GW_ERROR_MEMORY.
 */
gw_status gw_lit_surface_open(const gw_points *points, const gw_bake_result *lit,
							  const gw_bake_options *options, gw_lit_surface **surface,
							  gw_error *error);

/*
 * Lights points by the surface: each takes the irradiance of the points of the surface around it
 * that face its way, weighed by how near they are (modified Shepard interpolation, Franke and
 * Nielson 1980), and reflects it by its own albedo.
 *   part     any number of points, in any order; of them position, normal, albedo, emission,
 *            opacity and stray are looked at
 *   light    receives their light, to be given back with gw_bake_result_destroy; NULL on failure.
 *            Its report has the numbers of that of the surface
 * Fails with GW_ERROR_MEMORY. The light does not depend on how points are parted. Not to be called
 * by two threads with the same surface; it uses threads of its own.
 */
gw_status gw_lit_surface_light(gw_lit_surface *surface, const gw_points *part,
							   gw_bake_result **light, gw_error *error);

/*
 * Completes the report of the surface's light: how many of all points are lit by it, what lies
 * between its points, as far as the parts tell that were lit so far (gw_error_estimate.between),
 * and whether that misses gw_bake_options.max_error. To be called once.
 *   all   points of the cloud, those of the surface among them
 */
void gw_lit_surface_report(const gw_lit_surface *surface, uint64_t all, gw_report *report);

/* Frees it; *surface becomes NULL. NULL is accepted. */
void gw_lit_surface_close(gw_lit_surface **surface);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#ifdef __cplusplus
}
#endif

#endif

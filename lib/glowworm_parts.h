/*
 * glowworm_parts.h - public interface of libglowworm for clouds that memory does not hold: some of
 * their points, few enough, are baked as a surface, and all others are lit by it, part by part; by
 * other processes too, to which the light goes as bytes.
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

/* Where bytes go, and where they come from, in order; what the calls return is handed on. */
typedef struct gw_byte_sink {
	gw_status (*write)(void *user, const void *bytes, size_t length, gw_error *error);
	void *user;
} gw_byte_sink;

typedef struct gw_byte_source {
	gw_status (*read)(void *user, void *bytes, size_t length, gw_error *error);
	void *user;
} gw_byte_source;

/*
 * Hands on the light of points as bytes, for another process of the same version on the same kind
 * of machine: that of gw_bake, or of a surface, with its report, but without voxels and volume.
 */
gw_status gw_bake_result_save(const gw_bake_result *result, const gw_byte_sink *to,
							  gw_error *error);

/*
 * Makes of such bytes the result that they were. Whether they are whole is for the caller to know,
 * who keeps a checksum of them: of numbers of points only the sizes are looked at.
 *   result   to be given back with gw_bake_result_destroy; NULL on failure
 * Fails with GW_ERROR_DATA where they are of another version, with GW_ERROR_MEMORY.
 */
gw_status gw_bake_result_load(const gw_byte_source *from, gw_bake_result **result, gw_error *error);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#ifdef __cplusplus
}
#endif

#endif

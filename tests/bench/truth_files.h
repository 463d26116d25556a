/*
 * truth_files.h - files of a scene of known light: a cloud's lamps as PREFIX.scene.json, and the
 * traced light of some of its points as PREFIX.truth.ply. What make_truth and make_scan share.
 */
#ifndef TRUTH_FILES_H
#define TRUTH_FILES_H

#include "points/scan.h"
#include "reference_tracer.h"

/* Points of a cloud whose light is to be known; all arrays owned, count each. */
typedef struct truth_places {
	size_t count;
	uint32_t *index;    /* of the point in the cloud */
	double *position;   /* 3 each: where the cloud has it */
	double *surface;    /* 3 each: the place on the triangle */
	uint32_t *triangle; /* that it is on */
	reference_light *light;
} truth_places;

/* Room for `count` places, freed with truth_places_clear. GW_ERROR_MEMORY. */
gw_status truth_places_make(truth_places *places, size_t count, gw_error *error);
void truth_places_clear(truth_places *places);

/* How to trace. */
typedef struct truth_tracing {
	uint32_t paths, threads; /* paths a point, in all; 0 threads mean one a processor */
	uint64_t seed;
} truth_tracing;

/* Traces the light of all places and says on standard error how well it is known. */
gw_status truth_trace(const mesh_scene *scene, const truth_tracing *how, const char *name,
					  truth_places *places, gw_error *error);

/* Adds scalar_radiance_*, scalar_direct_irradiance_*, scalar_indirect_irradiance_* and
 * scalar_stderr (standard error of the luminance) of the places to a cloud that has as many
 * points. */
gw_status truth_add_light(const mesh_scene *scene, const truth_places *places, scan *cloud,
						  gw_error *error);

/* Does anything of a scene emit? */
bool truth_has_emission(const mesh_scene *scene);

/* Adds emission_* of the triangles that points are on. */
gw_status truth_add_emission(const mesh_scene *scene, const uint32_t *triangle, scan *cloud,
							 gw_error *error);

/* Writes a cloud under PREFIX and a suffix, in a format by its name, and empties it. */
gw_status truth_write_cloud(const char *prefix, const char *suffix, const char *format_name,
							scan *cloud, gw_error *error);

/*
 * Writes PREFIX.scene.json: the clouds and the scene's lamps.
 *   suffix   of the clouds' files behind PREFIX, `count` of them
 *   origin   what was added to all coordinates
 */
gw_status truth_write_scene(const char *prefix, const char *const *suffix, size_t count,
							const mesh_scene *scene, const double origin[3], gw_error *error);

#endif

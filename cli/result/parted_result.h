/*
 * parted_result.h - all points of a cloud that memory does not hold, lit by those of them that were
 * baked and written part by part.
 */
#ifndef PARTED_RESULT_H
#define PARTED_RESULT_H

#include "files/output_file.h"
#include "glowworm_parts.h"
#include "options/progress.h"
#include "program/ranks.h"
#include "scene/loaded_scene.h"

typedef struct parted_result {
	const settings *settings;
	const loaded_scene *scene; /* that was baked: of scene->parted */
	gw_bake_result *light;     /* of it */
	const format *format;      /* of the results */
	progress *progress;
	gw_lit_surface *surface; /* NULL; of parted_result_open */
	bool loaded;             /* the light is that of parted_result_load */
	ranks ranks;             /* who share the parts */
} parted_result;

/* The light of the points that were baked, where the journal of the scene's cloud has it; else
 * NULL. Fails like journal_file_begin and gw_bake_result_load. */
gw_status parted_result_load(const loaded_scene *scene, gw_bake_result **light, gw_error *error);

/* Makes ready to light all points, and completes the report: how many there are, and the error of
 * what lies between those that were baked, as some parts of the cloud, spread over the file, tell.
 * A journal then has the light. Light that was loaded is complete.
 *   result   to be given back with parted_result_close, also on failure */
gw_status parted_result_open(parted_result *result, gw_error *error);
void parted_result_close(parted_result *result);

/* A part with its light, as it is written, by settings with an exposure.
 *   lit   to be freed with scan_clear; empty on failure */
gw_status parted_result_light_part(const parted_result *result, uint64_t number,
								   const settings *settings, scan *lit, gw_error *error);

/*
 * Lights all points and writes them in the order of the file.
 *   exposure   receives the exposure value of the preview
 */
gw_status parted_result_write(const parted_result *result, output_file *out, double *exposure,
							  gw_error *error);

/*
 * The same where a journal keeps account: parts that it says are written, and are, stay. The others
 * are written by the ranks in turn, each of which waits for all in the end.
 *   out   of output_file_create_lasting
 */
gw_status parted_result_go_on(const parted_result *result, output_file *out, double *exposure,
							  gw_error *error);

#endif

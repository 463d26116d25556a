/*
 * parted_result.h - all points of a cloud that memory does not hold, lit by those of them that were
 * baked and written part by part.
 */
#ifndef PARTED_RESULT_H
#define PARTED_RESULT_H

#include "files/output_file.h"
#include "options/progress.h"
#include "scene/loaded_scene.h"

typedef struct parted_result {
	const settings *settings;
	const loaded_scene *scene; /* that was baked: of scene->parted */
	gw_bake_result *light;     /* of it */
	const format *format;      /* of the results */
	progress *progress;
} parted_result;

/* Completes the report: all points, and the error of what lies between those that were baked, as
 * some parts of the cloud, spread over the file, tell. */
gw_status parted_result_measure(const parted_result *result, gw_error *error);

/*
 * Lights all points and writes them in the order of the file.
 *   exposure   receives the exposure value of the preview
 */
gw_status parted_result_write(const parted_result *result, output_file *out, double *exposure,
							  gw_error *error);

#endif

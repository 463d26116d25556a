/*
 * lit_scan.h - the table of points that a bake writes: the columns that came in, in an order that
 * no reader trips over, and ours.
 *
 * x y z, nx ny nz, red green blue (the preview), albedo_r albedo_g albedo_b, the input's others,
 * quality (luminance), scalar_radiance_*, then those on request. Columns of an earlier bake are
 * replaced. The header says how it was made. With --las-radiance and --las-step values are rounded.
 */
#ifndef LIT_SCAN_H
#define LIT_SCAN_H

#include "scene/loaded_scene.h"

/*
 * Turns the scene's cloud into the lit one. Takes its columns: scene->cloud is empty afterwards.
 *   lit       on success owned by the caller, freed with scan_clear
 *   exposure  receives the exposure value of the preview
 */
gw_status lit_scan_make(loaded_scene *scene, const gw_bake_result *result, const settings *settings,
						scan *lit, double *exposure, gw_error *error);

/* The exposure value of the preview: as asked for, or by the light of the points. */
gw_status lit_scan_meter(const loaded_scene *scene, const gw_bake_result *result,
						 const settings *settings, double *exposure, gw_error *error);

/* The bytes that the columns of a lit point take together at least, and how many these are. */
size_t lit_scan_row_bytes(const loaded_scene *scene, const settings *settings, size_t *columns);

#endif

/*
 * tiled_result.h - all points of a cloud that memory does not hold, lit tile after tile by surfaces
 * of all of them (gw_tile in glowworm_parts.h).
 *
 * The cloud is read once to choose the points that are kept, once to form tiles, once to sort its
 * points by them, and once more to know the columns of the result. Tiles are lit one after the
 * other, by several ranks each their own, and kept in a file beside the output; from there the
 * result is put together in the order of the input.
 */
#ifndef TILED_RESULT_H
#define TILED_RESULT_H

#include "result/parted_result.h"
#include "scene/tile_file.h"

typedef struct tiled_result {
	const parted_result *kept; /* the points that were kept, and their light */
	const gw_light *light;     /* settings.light_count: as the kept ones were lit by */
	const gw_bake_options *options;
	tile_file file;
	uint32_t under_way; /* the tile that is being lit */
	double seconds;     /* that tiles took; of this process */
} tiled_result;

/* Whether settings with tiles ask for nothing that takes all points at once, or that only one bake
 * of them can tell. GW_ERROR_USAGE. */
gw_status tiled_result_check(const settings *settings, gw_error *error);

/*
 * Forms tiles and sorts the points by them; or takes those that the journal of the scene's cloud
 * tells of.
 *   result   its kept, light and options are set; to be given back with
 *            tiled_result_close, also on failure
 */
gw_status tiled_result_open(tiled_result *result, gw_error *error);
void tiled_result_close(tiled_result *result);

/*
 * Lights all tiles and writes all points in the order of the file; completes the report of the
 * points that were kept. Where a journal keeps account, tiles that it says are lit, and are, stay,
 * and ranks share the others; the first one writes.
 *   exposure   receives the exposure value of the preview
 */
gw_status tiled_result_write(tiled_result *result, output_file *out, double *exposure,
							 gw_error *error);

#endif

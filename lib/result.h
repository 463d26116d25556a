/*
 * result.h - from the light of surfels to that of points.
 */
#ifndef RESULT_H
#define RESULT_H

#include "relight.h"

/* Irradiance of surfels on the host, 4 floats each; NULL where nothing of the kind was computed. */
typedef struct gw_surfel_light {
	float *direct;   /* from lamps */
	float *first;    /* straight from emitters and sky; w is 0 where no record was near */
	float *indirect; /* reflected */
} gw_surfel_light;

/* Brings the light of a lighting to the host; light is zeroed on failure. */
gw_status gw_surfel_light_download(const gw_relight *relight, gw_surfel_light *light,
								   gw_error *error);
void gw_surfel_light_clear(gw_surfel_light *light);

/* Fills in the arrays of points, and counts those without light. */
gw_status gw_result_collect(const gw_relight *relight, gw_bake_result *result, gw_error *error);

/* Fills in the voxels; afterwards the records' indirect light holds all gathered light. */
gw_status gw_result_collect_voxels(gw_relight *relight, gw_bake_result *result, gw_error *error);

#endif

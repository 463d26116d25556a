/*
 * moments.h - records that know from where their light comes: beside the irradiance on its own
 * normal each keeps the irradiance's moment (record_moment.glsl), by which surfels read it for
 * theirs. Where normals differ within a record's reach, as on rough rock and at rounded edges, the
 * light then differs with them; it is as Ward and Heckbert's rotational gradient (1992), and linear
 * in the light, so that parts of it add up.
 */
#ifndef MOMENTS_H
#define MOMENTS_H

#include "glowworm_picture.h"
#include "light/read_back.h"

/*
 * How far surfels' normals are turned from those of the records that light them: the root of the
 * mean square of the angle's sine, by the weights of the rows.
 *   record_normal   4 a record
 *   surfel_normal   3 a surfel
 *   threads         0 means one a core; the result is the same for any number
 */
double gw_read_back_turn(const gw_read_back *read_back, const float *record_normal,
						 const float *surfel_normal, uint32_t threads);

/* Irradiance of records, and how it changes where the normal turns. */
typedef struct gw_directed_light {
	const float *irradiance;    /* 4 a record; of the fourth nothing is read */
	const float *moment;        /* 8 a record: along both tangents of its normal */
	const float *record_normal; /* 4 a record */
	const float *surfel_normal; /* 3 a surfel */
	uint32_t count;             /* records */
} gw_directed_light;

/*
 * Interpolates, for each surfel's own normal. Normals that are turned from a record's by more than
 * 30 degrees read it as if by 30, so that nothing is below 0.
 *   surfels   receives 4 floats a surfel, the fourth 0
 * GW_ERROR_MEMORY.
 */
gw_status gw_read_back_apply_directed(const gw_read_back *read_back, const gw_directed_light *light,
									  uint32_t threads, float *surfels, gw_error *error);

#endif

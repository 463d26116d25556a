/*
 * volume_places.h - read-back step of a radiance volume: from its cells to places on the surface
 * (Mavridis and Papaioannou, section 3.4).
 */
#ifndef VOLUME_PLACES_H
#define VOLUME_PLACES_H

#include "light/radiance_volume.h"

/* Some places, and the cells that light them: see volume_weights.comp. */
typedef struct gw_volume_rows {
	uint32_t count;
	gw_buffer cell, weight; /* storage buffers, GW_VOLUME_WEIGHTS words a place */
} gw_volume_rows;

/* Places that see the cells in front of them. */
typedef struct gw_volume_viewers {
	const gw_buffer *position, *normal; /* texel buffers, vec4 each: grid coordinates; unit */
	uint32_t count;
	uint32_t *label; /* NULL, or their compartments; turned into marks */
} gw_volume_viewers;

/* Finds the cells that light such places or, the other way round, are lit by them. On success *rows
 * is the caller's. */
gw_status gw_volume_weigh(const gw_record_context *on, const gw_radiance_volume *volume,
						  const gw_volume_viewers *viewers, gw_volume_rows *rows, gw_error *error);

/* Finds the cells that light the records, once for all lights. On success *rows is the caller's. */
gw_status gw_volume_weigh_records(const gw_record_context *on, const gw_radiance_volume *volume,
								  gw_volume_rows *rows, gw_error *error);
void gw_volume_rows_destroy(gw_gpu *gpu, gw_volume_rows *rows); /* empty ones are accepted */

/*
 * Irradiance of the records.
 *   rows         of these records
 *   largest      the largest component of the radiance that was filled in: no record can have more
 *                than pi times as much, which few harmonics do not know
 *   irradiance   receives it, records->count vec4
 */
gw_status gw_volume_read_records(const gw_record_context *on, const gw_radiance_volume *volume,
								 const gw_volume_rows *rows, float largest, gw_buffer *irradiance,
								 gw_error *error);

/*
 * Irradiance of all surfels, of volume->sum.
 *   irradiance   receives 4 floats a surfel, the fourth 0
 */
gw_status gw_volume_read_surfels(const gw_record_context *on, const gw_radiance_volume *volume,
								 size_t surfels, float *irradiance, gw_error *error);

#endif

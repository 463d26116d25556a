/*
 * gap_light.h - what records see through gaps, where no scanner ever looked (scanned_space.h).
 */
#ifndef GAP_LIGHT_H
#define GAP_LIGHT_H

#include "light/gather_rays.h"
#include "surfels/scanned_space.h"

typedef struct gw_gap_task {
	const gw_record_context *on;
	const gw_ray_gather *rays; /* what theirs hit */
	const gw_scanned_space *space;
	const float *sky;      /* 3, radiance of the environment */
	const gw_sky_map *map; /* of it, or NULL */
	uint32_t threads;
	const gw_surfels *surfels; /* NULL, or those that emit: what of their light hangs on gaps */
} gw_gap_task;

/* What a record sees through gaps, as means over all of its rays. */
typedef struct gw_gap_sight {
	float sky[3]; /* radiance of the sky */
	float share;  /* of the rays */
	float all;    /* luminance of all that it sees of the sky, through gaps or not */
	float pane;   /* share of its rays that leave through panes where the sky is black: a window, or
					 a surface that sent no beam back */
	float glow; /* where surfels were given: luminance of what holes would emit if they did as what
				   is around them does */
} gw_gap_sight;

/* Finds how much of what the records see lies behind gaps.
 *   gap   on success one a record, for free() */
gw_status gw_gap_light_find(const gw_gap_task *task, gw_gap_sight **gap, gw_error *error);

/*
 * Closes the gaps: what came through them is taken off what records gathered from emitters and sky,
 * and something else put there.
 *   gap     as found
 *   fill    radiance of what closes them; NULL: as bright as what else the record sees of this
 *           light
 *   alone   nothing emits but the sky: then it is a share that is taken off, so that portals, which
 *           were sampled beside the rays, do not matter
 *   to      vec4 a record: what they gathered
 */
gw_status gw_gap_light_close(const gw_record_context *on, const gw_gap_sight *gap,
							 const float *fill, bool alone, gw_buffer *to, gw_error *error);

/* What records gathered from surfaces, as if gaps were as bright as these: by the share of their
 * rays that met some. gathered   vec4 a record */
gw_status gw_gap_light_fill(const gw_record_context *on, const gw_gap_sight *gap,
							gw_buffer *gathered, gw_error *error);

#endif

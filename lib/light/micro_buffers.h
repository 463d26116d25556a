/*
 * micro_buffers.h - trace step by micro-buffers (Harada, section 4; Ritschel and others 2009): each
 * record draws a cut of the hierarchy of surface into a small picture of its hemisphere, in which
 * every texel keeps how far away what it shows is, and the number of that.
 *
 * The picture is a paraboloid's. A piece is fine enough for the cut when it covers no more than a
 * texel and its normals lie in a narrow cone; so walls that are thin, edges and what is near are
 * drawn facet by facet, and nothing leaks.
 * A piece covers the texels whose directions meet its plane in its cell.
 *
 * The gather rays of the record then look their hits up in the texels, in place of being traced:
 * the same stored hits, the same sparse products, but that hits may be nodes. Lamps and openings
 * that are smaller than a texel it does not see: they have to be sampled.
 */
#ifndef MICRO_BUFFERS_H
#define MICRO_BUFFERS_H

#include "light/gather_rays.h"
#include "light/surface_tree.h"

/* Texels a side. */
#define GW_BUFFER_SIDE_LEAST 4u
#define GW_BUFFER_SIDE_MOST 64u

typedef struct gw_micro_buffers {
	gw_surface_tree tree;
	gw_ray_gather hits; /* of pieces of the tree */
	gw_buffer radiance; /* R32G32B32A32_SFLOAT, of all pieces, of the last bounce */
	uint32_t side;      /* texels a side of each buffer */
	uint64_t drawn;     /* pieces, of all records */
} gw_micro_buffers;

/* Texels a side of buffers in which so many rays look up what they hit, within the limits above:
 * four a ray, as many of them lie near the horizon, where few rays go. 64 have 16, 16 have 8. */
uint32_t gw_micro_buffers_side(uint32_t rays);

/*
 * Draws a buffer for each record, and looks its rays up.
 *   rays, seed   as of gw_ray_gather_trace: the same directions
 *   buffers      on success to be destroyed by the caller; empty on failure
 */
gw_status gw_micro_buffers_make(const gw_record_context *on, uint32_t rays, uint32_t seed,
								gw_micro_buffers *buffers, gw_error *error);
void gw_micro_buffers_destroy(gw_gpu *gpu, gw_micro_buffers *buffers);

/* Turns hits on surface that rock keeps apart from their records, as gw_ray_gather_shut_out. */
gw_status gw_micro_buffers_shut_out(const gw_record_context *on, gw_micro_buffers *buffers,
									gw_error *error);

/* One bounce: radiance pulled up, and irradiance from what the rays hit, into records->gathered. */
gw_status gw_micro_buffers_bounce(const gw_record_context *on, gw_micro_buffers *buffers,
								  const gw_buffer *facet_radiance, gw_error *error);

#endif

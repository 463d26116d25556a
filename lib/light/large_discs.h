/*
 * large_discs.h - light of lamps on discs that are too large for leaves (disc_tree.h).
 *
 * A ray that meets such a disc finds the light of one facet all over the disc. Light at its centre
 * would be a nearest neighbour's: where surface ends in a crease the points next to that stand for
 * it, which are nearer to the lamp than the strip beside the crease, and the surface as a whole
 * would send out more than the lamp sends in, by about 0.3 |dE/dn| of the mean area of a point for
 * each metre of crease. So the facet has the mean of the light where rays meet the disc, as the
 * lamp sends it; what hides the lamp is that of the centre. Discs on which finer surface lies, too,
 * keep the light of their centre.
 */
#ifndef LARGE_DISCS_H
#define LARGE_DISCS_H

#include "light/shader_functions.h"
#include "light/shadow_map.h"

typedef struct gw_large_discs {
	size_t count;     /* of discs; 0: none, or so many that each is as good as its centre */
	uint32_t *surfel; /* count */
	uint32_t *first;  /* count + 1: of its places */
	gw_vec3 *place;   /* in grid coordinates; and by what the disc's bend turns the normal there */
	gw_vec3 *turn;
	float *more; /* 3 * count: irradiance beyond that of the centre, of all lamps so far */
} gw_large_discs;

/*
 * Finds where rays meet the large discs of an octree.
 *   discs   on success to be cleared by the caller; on failure it is empty
 */
gw_status gw_large_discs_find(const gw_lit_cloud *cloud, gw_large_discs *discs, gw_error *error);
void gw_large_discs_clear(gw_large_discs *discs);

/*
 * Adds one lamp.
 *   normal, visibility   of surfels, as light_irradiance.comp reads them
 */
gw_status gw_large_discs_light(const gw_lit_cloud *cloud, const gw_lamp *lamp,
							   const gw_buffer *normal, const gw_buffer *visibility,
							   gw_large_discs *discs, gw_error *error);

/*
 * The mean irradiance over discs, and of all other surfels their own.
 *   surfels   irradiance of surfels, R32G32B32A32_SFLOAT
 *   means     receives the same with the discs' means; to be destroyed by the caller
 */
gw_status gw_large_discs_mean(const gw_lit_cloud *cloud, const gw_large_discs *discs,
							  const gw_buffer *surfels, gw_buffer *means, gw_error *error);

#endif

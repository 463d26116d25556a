/*
 * patch_borders.h - what neighbouring surfels say about the patches that they belong to. Internal
 * to lib/.
 */
#ifndef PATCH_BORDERS_H
#define PATCH_BORDERS_H

#include "cloud/neighbours.h"
#include "normals/patch_signs.h"

/* The agreement of two normals is stored in 1 / GW_AGREED. */
#define GW_AGREED 127

/* Surfels, their neighbours and their patches. */
typedef struct gw_patch_pairs {
	size_t count;            /* surfels */
	const uint32_t *near;    /* GW_NEIGHBOURS * count; the surfel itself where there is none */
	const int8_t *agreement; /* GW_NEIGHBOURS * count: whether both show the same side, -GW_AGREED
								to GW_AGREED */
	const uint32_t *patch;   /* count */
	const uint8_t *opposite; /* count: sign against that of the patch */
	bool alike;              /* what pairs at creases say is made more like what others say */
} gw_patch_pairs;

/*
 * Sums what pairs say whose surfels are of two patches.
 *   threads   0 means one a processor; their number changes nothing
 *   borders   receives one of each two patches that touch, in order of a, then b, to be freed by
 *             the caller; NULL on failure
 *   count     receives how many
 * Returns false when memory is short.
 */
bool gw_patch_borders_find(const gw_patch_pairs *pairs, uint32_t threads, gw_patch_border **borders,
						   size_t *count);

#endif

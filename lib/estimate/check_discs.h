/*
 * check_discs.h - the points' discs by themselves, for rays that check what the octree says.
 *
 * An octree that is wrong is wrong for every ray through it, also for those that look for its
 * errors. So these rays meet nothing of it: no cells, planes or leaves, but the discs around the
 * points, in a tree of boxes. Discs have faults of their own: small ones leave holes between points
 * that lie unevenly, large ones stick out over edges. A ray is told what it meets among discs of
 * both sizes, and whoever asks counts only what both say.
 */
#ifndef CHECK_DISCS_H
#define CHECK_DISCS_H

#include "base/shader_math.h"
#include "device/passes.h"
#include "estimate/check_tree.h"
#include "octree/octree.h"

#include <stdbool.h>

typedef struct gw_check_discs {
	const gw_surfels *surfels;
	gw_check_tree *tree; /* in which they are; not owned */
	size_t count;        /* discs; 0: it is not open */
	gw_view size, clip;  /* gw_octree.surfel_disc and .surfel_clip, which have the cuts */
	float cell;          /* metres, the unit of these: width of the octree's leaves */
	float sheet;         /* metres: so near at least discs of one sheet lie; 0: all are opaque */
} gw_check_discs;

/*
 * Opens the discs of surfels, of which the octree has the cuts, unless they are open already. Makes
 * their tree, unless it is made.
 *   octree  and surfels must outlive discs
 *   discs   closed, with a tree that is empty or of these surfels; or from an earlier call with the
 *           same of these. On success to be closed by the caller; on failure it is closed
 */
gw_status gw_check_discs_open(const gw_passes *passes, const gw_octree *octree,
							  const gw_surfels *surfels, gw_check_discs *discs, gw_error *error);
void gw_check_discs_close(gw_check_discs *discs); /* not the tree */

/* One ray, in the local frame of the surfels. */
typedef struct gw_check_ray {
	gw_vec3 origin, direction; /* metres; unit */
	gw_vec3 facing;            /* normal of the surface that it leaves */
	/* Metres. So near, discs that face alike are of the surface that it leaves: their backs are not
	 * met, nor, by rays that backs stop, fronts that hardly rise above it, nor backs of small discs
	 * whose radius it starts within: they stick out over the edge that it starts beside. */
	float own;
	float t_max;     /* metres */
	bool both_sides; /* backs of discs stop it */
	bool whole;      /* small discs are as large as the surfels' */
	float unless;    /* above 0: discs that are in doubt by so much or more are not there */
} gw_check_ray;

/* Surfels that the ray meets first, or GW_NONE: among small discs and among large ones. */
typedef struct gw_check_hit {
	uint32_t small, large;
	float through[2]; /* how much of its light gets there: to the small one, and to the large one */
	bool passed_back_face; /* the ray passed the back of a small disc before it met one */
} gw_check_hit;

/* Thread-safe. What lets light through stops the ray where no more than `until` of that is left, as
 * in trace.glsl; at GW_THROUGH_LEAST, where nothing is. */
gw_check_hit gw_check_discs_trace(const gw_check_discs *discs, const gw_check_ray *ray,
								  float until);

#endif

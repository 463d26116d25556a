/*
 * kept_hits.h - what the records of a scene saw before something moved in, so that only those rays
 * are traced again whose way has changed (Salm 4.5).
 */
#ifndef KEPT_HITS_H
#define KEPT_HITS_H

#include "light/gather_rays.h"

/* Records of an octree of all that stands still, with their hits. */
typedef struct gw_kept_hits {
	gw_ray_gather rays;
	uint32_t record_count;
	float *place;        /* 6 * record_count: position and normal */
	uint32_t *bucket;    /* hash table over them: record plus one */
	uint32_t mask;       /* of it */
	uint64_t *facet_key; /* facet_count - 1: see kept_hits.c; without that of the empty one */
	uint32_t facet_count;
} gw_kept_hits;

/* A part of the octree in which something may have changed, grid coordinates. */
typedef struct gw_changed_box {
	float low[4], high[4]; /* the fourth is unused */
} gw_changed_box;

/* At most so many boxes. */
#define GW_CHANGED_BOXES 1024u

typedef struct gw_changed_boxes {
	const gw_changed_box *box; /* count */
	uint32_t count;
} gw_changed_boxes;

/*
 * Keeps what the records of an octree saw.
 *   rays   theirs; on success they belong to *kept, and *rays is empty
 *   kept   to be destroyed with gw_kept_hits_destroy
 */
gw_status gw_kept_hits_take(gw_gpu *gpu, const gw_octree *octree, const gw_records *records,
							gw_ray_gather *rays, gw_kept_hits *kept, gw_error *error);
void gw_kept_hits_destroy(gw_gpu *gpu, gw_kept_hits *kept);

/*
 * As gw_ray_gather_trace, for an octree that is the old one and more, of the same cube: outside of
 * the boxes, its leaves are the same.
 *   traced   receives how many rays were traced
 */
gw_status gw_kept_hits_trace(const gw_record_context *on, const gw_kept_hits *kept,
							 gw_changed_boxes boxes, gw_ray_gather *gather, uint64_t *traced,
							 gw_error *error);

#endif

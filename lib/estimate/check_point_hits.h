/*
 * check_point_hits.h - what the points see at which an estimate of the error gathers
 * (error_estimate.h), kept for the next one: whatever shines, a point sees the same.
 */
#ifndef CHECK_POINT_HITS_H
#define CHECK_POINT_HITS_H

#include "light/gather_rays.h"
#include "cloud/surfels.h"

/* Each point gathers twice, by rays of other directions. */
#define GW_CHECK_POINT_GATHERS 2u

/* All zero: nothing is known. All are of one seed. */
typedef struct gw_check_point_hits {
	uint32_t count;  /* points */
	uint32_t rays;   /* of one gather of a point */
	uint32_t *point; /* count: surfels, ascending */
	uint32_t *facet; /* by gather, point and ray: what it hit, GW_NONE for nothing */
	float *distance; /* likewise, as in gw_ray_gather */
	float *emitted;  /* NULL, or 4 by gather and point: irradiance from emitters alone */
	uint64_t traced; /* rays so far, also for points that are not among these any more */
} gw_check_point_hits;

/* Where points gather, and from which emitters. */
typedef struct gw_check_point_task {
	gw_passes *passes;
	const gw_octree *octree;
	const gw_surfels *surfels;
	const gw_emitters *emitters; /* NULL, or count 0: what they bring is not asked for */
	uint32_t rays, seed;
} gw_check_point_task;

/*
 * Makes *hits those of these points: takes over what it holds of them, and traces what it lacks.
 *   point   count surfels, ascending, each once
 *   hits    on failure as it was
 */
gw_status gw_check_point_hits_find(const gw_check_point_task *task, const uint32_t *point,
								   uint32_t count, gw_check_point_hits *hits, gw_error *error);

/* Records at the places of these surfels. */
gw_status gw_check_point_hits_place(const gw_check_point_task *task, const uint32_t *point,
									uint32_t count, gw_records *place, gw_error *error);

/* What all points see in one gather, on the device. */
typedef struct gw_check_point_view {
	gw_ray_gather rays;
	gw_buffer emitted; /* what emitters brought, where that is known */
} gw_check_point_view;

/* Brings what is known of one gather of all points to the device, those records' being *place. It
 * is the caller's on success, to be destroyed with gw_check_point_view_destroy. */
gw_status gw_check_point_hits_gather(const gw_check_point_task *task,
									 const gw_check_point_hits *hits, const gw_records *place,
									 uint32_t gather, gw_check_point_view *view, gw_error *error);
void gw_check_point_view_destroy(gw_gpu *gpu, gw_check_point_view *view);

/* Forgets what emitters brought, as when their emission changes; all. */
void gw_check_point_hits_forget_emitted(gw_check_point_hits *hits);
/* Forgets what points see, as when the seed of their rays changes; not how many were traced. */
void gw_check_point_hits_forget(gw_check_point_hits *hits);
void gw_check_point_hits_clear(gw_check_point_hits *hits);

#endif

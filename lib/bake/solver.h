/*
 * solver.h - what of a bake depends on the geometry alone, so that one solver can be lit many times
 * (relight.h).
 *
 * The steps, in this order; each needs the ones before:
 *
 *   open device -> surfels -> octree -> records, with what their rays hit and the weights by which
 *   lobes and surfels interpolate between them
 *
 * A solver's light lies in a gw_relight; gathering also uses work space of the records here.
 * Thread-safety: one thread at a time.
 */
#ifndef SOLVER_H
#define SOLVER_H

#include "estimate/error_estimate.h"
#include "light/gather_cones.h"
#include "light/kept_hits.h"
#include "light/read_back.h"

/* Where records are to stand closer than the spacing with which they were placed, leaf cells. */
typedef struct gw_record_density {
	float *lobe_spacing;               /* 2 * leaf_count */
	float *surfel_spacing;             /* surfel count */
	bool *lobe_closer, *surfel_closer; /* likewise: whose spacing has become less */
} gw_record_density;

typedef struct gw_solver {
	gw_bake_options options;
	gw_report *report;             /* receives what the steps find out; not owned */
	bool (*cancelled)(void *user); /* NULL or asked between steps */
	void *user;

	gw_gpu *gpu;
	gw_surfels surfels;
	gw_octree octree;
	gw_passes passes;
	gw_records records;
	gw_ray_gather rays;   /* hits that serve every bounce; of a few rays where cones gather */
	gw_cone_gather cones; /* empty for GW_METHOD_RAYS */
	gw_read_back read_back;
	/* What the points that emit brought to the records, once it is known: it depends on
	 * their emission, but not on lamps. */
	gw_buffer sampled;
	gw_probe_hits probed;       /* what the points see that estimates solve again */
	gw_openings openings;       /* looked for when a sky first shines */
	gw_records further;         /* places of records that were added and are not in it yet */
	gw_ray_gather further_rays; /* and their hits */

	/* For scenes in which some surfels move. */
	bool keeps;                  /* the octree is built with what builds before it left */
	size_t still;                /* so many surfels stay where they are */
	gw_octree_kept *kept_octree; /* owned */
	const gw_kept_hits *kept;    /* NULL, or what records saw without what moves; not owned */
	const gw_changed_box *box;   /* box_count, where that is; not owned */
	uint32_t box_count;
	uint64_t traced; /* rays of records that were traced, the last time */
} gw_solver;

/* GW_ERROR_USAGE when options or lights make no sense, GW_ERROR_DATA when there are no points. */
gw_status gw_options_check(const gw_bake_options *options, size_t point_count,
						   const gw_light *lights, size_t light_count, gw_error *error);

/* Whether the options ask to refine until an error or a time is reached. */
bool gw_options_refine(const gw_bake_options *options);

/* Opens the device that the options name. */
gw_status gw_solver_open_device(gw_solver *solver, gw_error *error);

/*
 * Makes the surfels of the points.
 *   lights   light_count; they orient estimated normals when nobody knows where the scanner stood
 */
gw_status gw_solver_make_surfels(gw_solver *solver, const gw_points *points, const gw_light *lights,
								 size_t light_count, gw_error *error);

/* Writes what was repaired into a report. */
void gw_report_surfels(gw_report *report, const gw_surfels *surfels, const gw_points *points);

gw_status gw_solver_build_octree(gw_solver *solver, gw_error *error);

/* Writes what the octree is into the report; building it does so, too. */
void gw_solver_report_octree(const gw_solver *solver);

/* Places the records, finds what they see, and which of them light each lobe and each surfel. */
gw_status gw_solver_place_records(gw_solver *solver, gw_error *error);

/*
 * Adds records where the density says, finds what they see, and which records light each lobe and
 * each surfel then. What others saw stays. On failure the records are to be dropped.
 */
gw_status gw_solver_add_records(gw_solver *solver, const gw_record_density *density,
								gw_error *error);

/* Sees to it that narrow openings to the sky are known and sampled from all records. */
gw_status gw_solver_open_to_sky(gw_solver *solver, gw_error *error);

/* Makes the work space, and reports, where all of these came from a transport (transport.h). */
gw_status gw_solver_complete(gw_solver *solver, const gw_points *points, gw_error *error);

/* To be called when the emission of surfels changes. */
void gw_solver_forget_samples(gw_solver *solver);
/* What the added records are, once they are among the others in all that is kept. */
void gw_solver_forget_further(gw_solver *solver);

/* Places records only to find what they see, as solver.kept; they are dropped again. */
gw_status gw_solver_keep_hits(gw_solver *solver, gw_kept_hits *kept, gw_error *error);

/* Forget the records; the octree and the records; everything. Options and callbacks stay. */
void gw_solver_drop_records(gw_solver *solver);
void gw_solver_drop_octree(gw_solver *solver);
void gw_solver_close(gw_solver *solver);

#endif

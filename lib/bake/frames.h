/*
 * frames.h - what a gw_frames is, and its steps, for plans of frames (frames_plan.c).
 */
#ifndef FRAMES_H
#define FRAMES_H

#include "bake/lighting.h"
#include "bake/scaled_scene.h"
#include "surfels/surfel_parts.h"

struct gw_frames {
	gw_scaled_scene units; /* that all below is in */
	const gw_points *points;
	gw_motion own_motion; /* in these units; without a matrix where they are metres */
	double *matrix;       /* of it */
	const gw_motion *motion;
	const gw_light *first_lights; /* first_light_count: they orient normals */
	size_t first_light_count;
	gw_frames_options how;
	gw_scene scene;
	gw_lighting light;
	gw_surfel_parts parts;
	bool alone;    /* frames are baked by themselves: nothing is prepared for others */
	bool made;     /* the surfels are there */
	bool looked;   /* gaps have been looked for */
	bool prepared; /* what stands still is; of its hits, when records were called for */
	gw_kept_hits hits;
	gw_changed_box *box; /* of each mover, GW_CHANGED_BOXES at most */
	bool built;          /* the octree is that of built_frame, */
	bool tree;           /* and has a tree; where nothing is traced, it has none */
	bool placed;         /* and so are the records */
	size_t built_frame;
	float *carried; /* NULL, or 4 a surfel: reflected light of the last frame */
	double shared_seconds;
};

/* Of a frame: all until its lamps have been lit; the rest after that; and both. The report is the
 * scene's, lights are set. */
gw_status gw_frames_light(gw_frames *frames, size_t frame, gw_error *error);
gw_status gw_frames_solve(gw_frames *frames, size_t frame, gw_bake_result *result, gw_error *error);

/* Forgets the octree of a frame; or all but what was asked for. */
void gw_frames_drop_geometry(gw_frames *frames);
void gw_frames_forget(gw_frames *frames);

#endif

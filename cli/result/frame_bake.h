/*
 * frame_bake.h - bakes of scenes in which something moves: the frames that were asked for, each in
 * a file of its own; or the first one alone.
 */
#ifndef FRAME_BAKE_H
#define FRAME_BAKE_H

#include "result/bake_report.h"
#include "options/progress.h"

/* GW_ERROR_USAGE when --frames and what else was given do not go together, or a file exists that
 * would be overwritten. To be called before anything is read. */
gw_status frame_bake_check(const settings *settings, gw_error *error);

/* Where frames go. */
typedef struct frame_outputs {
	const format *written_as;
	output_file *report; /* NULL or where the report of all frames goes */
	progress *shown;
} frame_outputs;

/*
 * Bakes and writes all frames that settings->frames names.
 *   facts    what was read; the exposure of the first frame serves all
 *   scene    whose points are used up
 */
gw_status frame_bake_all(bake_facts *facts, settings *settings, loaded_scene *scene,
						 const frame_outputs *to, gw_error *error);

/*
 * Says what frame_bake_all, or without settings->frames frame_bake_first, would take.
 *   plan   as of gw_frames_plan
 */
gw_status frame_bake_plan(const settings *settings, const loaded_scene *scene,
						  const gw_bake_callbacks *callbacks, gw_bake_result **plan,
						  gw_error *error);

/* How many frames follow the first that is baked. */
uint32_t frame_bake_following(const settings *settings);

/* Bakes frame 0 as gw_bake bakes a scene that stands still, and moves the scene's points there. */
gw_status frame_bake_first(settings *settings, loaded_scene *scene, const gw_bake_options *options,
						   const gw_bake_callbacks *callbacks, gw_bake_result **result,
						   gw_error *error);

#endif

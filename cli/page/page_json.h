/*
 * page_json.h - what a page's scripts have to know beside the points, as JSON.
 */
#ifndef PAGE_JSON_H
#define PAGE_JSON_H

#include "page/page_scene.h"

/*
 * The scene as text that may stand within a script element: without a less-than sign.
 *   points   of the page, scaled
 *   text     on success the caller's, for free(); NULL on failure
 * Fails with GW_ERROR_MEMORY, or as camera_plan_camera.
 */
gw_status page_json_make(const settings *settings, const page_scene *page,
						 const page_points *points, const char *title, char **text,
						 gw_error *error);

#endif

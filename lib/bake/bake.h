/*
 * bake.h - one bake, from points to lit points. Internal to lib/.
 */
#ifndef BAKE_H
#define BAKE_H

#include "glowworm.h"

/*
 * Bakes points as they are given, all of them; or only plans to, and then the result holds a report
 * alone.
 *   options    checked, and effective (scene.h)
 *   planning   what comes after the forecast is left out
 *   callbacks  or NULL
 *   result     on success to be destroyed by the caller, else NULL
 */
gw_status gw_bake_once(const gw_scene_description *scene, const gw_bake_options *options,
					   bool planning, const gw_bake_callbacks *callbacks, gw_bake_result **result,
					   gw_error *error);

#endif

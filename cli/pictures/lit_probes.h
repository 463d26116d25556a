/*
 * lit_probes.h - probes of a lit cloud, for its glossy points.
 */
#ifndef LIT_PROBES_H
#define LIT_PROBES_H

#include "glowworm_probes.h"
#include "pictures/render_scene.h"
#include "scene/sky_light.h"

/*
 * Places probes, as many as see all that can be seen, and traces what they see: the radiance of the
 * points, and the sky.
 *   scene    lit
 *   probes   on success freed with gw_probes_destroy; NULL on failure
 * GW_ERROR_MEMORY, GW_ERROR_CANCELLED; fails as gw_scene_create and gw_probes_make.
 */
gw_status lit_probes_make(const settings *settings, const render_scene *scene, const sky_light *sky,
						  gw_probes **probes, gw_error *error);

#endif

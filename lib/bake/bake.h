/*
 * bake.h - one bake, from points to lit points. Internal to lib/.
 */
#ifndef BAKE_H
#define BAKE_H

#include "glowworm.h"

struct gw_gpu;
struct gw_memory_ceiling;

/* How a bake is to be done; all zero: as one by itself. */
typedef struct gw_bake_manner {
	bool planning; /* what comes after the forecast is left out */
	bool trial;    /* where the target is missed, nobody wants the light, nor how wrong it
					  is: it ends when that is known */
	const struct gw_known_light *known; /* NULL; or of points beyond the region, which are far
										   sparser than those of it: the octree is as fine as
										   these, and coarser ones are in the tree of large discs */
	struct gw_memory_ceiling *ceiling;  /* NULL, or how much it may take (bake_memory.h) */
	struct gw_gpu **device; /* NULL, or where a device is left for those who come after, to be
							   destroyed by the caller; what is there is used */
} gw_bake_manner;

/*
 * Bakes points as they are given, all of them; or only plans to, and then the result holds a report
 * alone.
 *   options    checked, and effective (scene.h)
 *   callbacks  or NULL
 *   result     on success to be destroyed by the caller, else NULL
 */
gw_status gw_bake_once(const gw_scene_description *scene, const gw_bake_options *options,
					   gw_bake_manner manner, const gw_bake_callbacks *callbacks,
					   gw_bake_result **result, gw_error *error);

/*
 * A bake, and where the surface is in doubt, bakes of half of the points and of half of these, by
 * which its error is estimated (half_sample.h).
 *   options    checked, and effective (scene.h); surface_points above 0 says that the points given
 *              are some of more
 *   manner     not planning; without a device, one is opened for these bakes
 *   result     on success to be destroyed by the caller, else NULL
 */
gw_status gw_bake_checked(const gw_scene_description *scene, const gw_bake_options *options,
						  gw_bake_manner manner, const gw_bake_callbacks *callbacks,
						  gw_bake_result **result, gw_error *error);

/* gw_bake_once by itself on a device, as in the manner: a gw_half_bake. */
gw_status gw_bake_on_device(const gw_scene_description *scene, const gw_bake_options *options,
							struct gw_gpu **device, const gw_bake_callbacks *callbacks,
							gw_bake_result **result, gw_error *error);

#endif

/*
 * probes.h - probes in a lit scene: places in its free space, and maps of what is seen from there.
 */
#ifndef PROBES_H
#define PROBES_H

#include "bake/lighting.h"
#include "glowworm_probes.h"
#include "light/gather_probes.h"

/* GW_ERROR_USAGE when options make no sense. */
gw_status gw_probes_options_check(const gw_probes_options *options, gw_error *error);

/*
 * Places probes and traces what they see, in the units that were given.
 *   lighting   lit
 *   options    checked
 *   probes     empty; receives them, also in part on failure
 */
gw_status gw_lighting_probes(gw_lighting *lighting, const gw_probes_options *options,
							 gw_probes *probes, gw_error *error);

/* Places probes for the rays of records: as many as see what any place sees, with maps of the
 * scene's probe_size. Where there is no free space within the bounds they stand outside.
 *   maps   on success to be cleared by the caller; empty on failure */
gw_status gw_scene_probe_maps(gw_scene *scene, gw_probe_maps *maps, gw_error *error);

#endif

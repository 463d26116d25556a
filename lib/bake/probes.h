/*
 * probes.h - probes in a lit scene: places in its free space, and maps of what is seen from there.
 */
#ifndef PROBES_H
#define PROBES_H

#include "bake/lighting.h"
#include "glowworm_probes.h"

/*
 * Places probes and traces what they see, in the units that were given.
 *   lighting   lit
 *   options    checked
 *   probes     empty; receives them, also in part on failure
 */
gw_status gw_lighting_probes(gw_lighting *lighting, const gw_probes_options *options,
							 gw_probes *probes, gw_error *error);

#endif

/*
 * region.h - bakes of a part of a scene: which surfels are asked for, and what their light depends
 * on (needed_facets.h).
 *
 * Records of the region stand as close as in a bake of the whole, and where they do. Those that
 * their rays depend on, and those that these depend on, stand four times as far apart: they add to
 * the region's light what many rays bring together, each of which counts little. What nothing
 * depends on gets neither records nor the light of lamps.
 */
#ifndef REGION_H
#define REGION_H

#include "bake/scene.h"

/* Which surfels are asked for by the scene's options, once surfels are made; nothing without a
 * region. GW_ERROR_DATA when no point lies in it. */
gw_status gw_region_ask(gw_scene *scene, gw_error *error);

/* Where what lies beyond the region is far sparser: octrees are made for the spacing of what is
 * asked for, which the surfels have for theirs then, and hold coarse discs in a tree of their own.
 * After gw_region_ask, of a scene with a region. GW_ERROR_MEMORY. */
gw_status gw_region_set_width(gw_scene *scene, gw_error *error);

/* Whether a point is asked for. */
static inline bool gw_region_has(const gw_scene *scene, size_t point)
{
	return !scene->region.point || scene->region.point[point];
}

#endif

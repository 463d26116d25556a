/*
 * sampled_light.h - the light that a lighting's records get from what is sampled: small emitters,
 * the map of the sky, portals.
 */
#ifndef SAMPLED_LIGHT_H
#define SAMPLED_LIGHT_H

#include "bake/lighting.h"

/* Where moments of what is gathered go: moment, if the scene's records keep them, else NULL. */
gw_buffer *gw_scene_moment_of(const gw_scene *scene, gw_buffer *moment);

/* What is sampled beside what is traced. */
gw_sampled_sources gw_lighting_sources(gw_lighting *lighting);

/* Emitters that cover less of the surface than this are sampled; more are light of the voxels, or
 * of the cells of a volume. */
#define GW_SAMPLED_SHARE 0.1

/* Where cones or a volume gather: what they would miss is sampled from the records, into their
 * first light: small emitters and the map of the sky. *large: emitters are left to them. */
gw_status gw_lighting_sample_small(gw_lighting *lighting, bool *large, gw_error *error);

#endif

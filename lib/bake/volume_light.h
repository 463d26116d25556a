/*
 * volume_light.h - lightings whose records read a radiance volume (GW_METHOD_VOLUME,
 * GW_METHOD_LPV), and radiance in free space as a result of any bake.
 */
#ifndef VOLUME_LIGHT_H
#define VOLUME_LIGHT_H

#include "bake/lighting.h"

/* Light straight from emitters and sky, into the records' first light: as cones, rays of the volume
 * see the even sky and large emitters. */
gw_status gw_volume_light_first(gw_lighting *lighting, gw_error *error);

/* Trace steps of bounces.h; self: the gw_lighting. What is gathered is added up in the volume,
 * unless apart. */
gw_status gw_volume_light_gather(void *self, const gw_buffer *facet_radiance, float largest,
								 gw_error *error);
gw_status gw_volume_light_gather_apart(void *self, const gw_buffer *facet_radiance, float largest,
									   gw_error *error);

/* Reflected light at every surfel, from the volume itself instead of from records. */
gw_status gw_volume_light_read_back(gw_lighting *lighting, gw_error *error);

/* What the cells of a volume see in the end: fills in result->volume. Before
 * gw_result_collect_voxels. */
gw_status gw_volume_light_collect(gw_lighting *lighting, gw_bake_result *result, gw_error *error);

#endif

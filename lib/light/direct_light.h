/*
 * direct_light.h - light of point, spot and sun lights at every surfel (Salm 4.2): analytic, with
 * shadows traced at every surfel or looked up in shadow maps; and its mean in every facet.
 */
#ifndef DIRECT_LIGHT_H
#define DIRECT_LIGHT_H

#include "base/distribution.h"
#include "light/shadow_map.h"
#include "light/shader_functions.h"
#include "light/transport_layout.h"

/* Checks that lights make sense: finite numbers, nothing negative, angles in order, a direction.
 * The sentence names the light by its number or name and the value at fault; GW_ERROR_USAGE. */
gw_status gw_lights_check(const gw_light *lights, size_t count, gw_error *error);

/* A light in grid coordinates: an intensity in W/sr becomes one per leaf cell squared. */
gw_lamp gw_lamp_of(const gw_light *light, const gw_octree *octree, const gw_surfels *surfels,
				   const gw_bake_options *options);

/* The straight way from a surfel to the middle of a light. */
gw_way gw_light_way(const gw_light_push *light, const gw_octree *octree, const gw_surfels *surfels,
					size_t surfel);

/* Where the light of lamps goes. */
typedef struct gw_direct_irradiance {
	gw_buffer *surfels; /* texel buffer R32G32B32A32_SFLOAT, surfel count, zeroed by the caller */
	gw_buffer *facets;  /* storage buffer, facet_count vec4; receives the mean over each facet;
						   none where there are no leaves */
	gw_light_given *given; /* NULL, or light_count: what gw_given_book says of each lamp */
	gw_buffer *turned; /* NULL, or like surfels: receives what it would be if each normal were off
						  as shading_normal_off says, which has to be there (normal_error.h) */
} gw_direct_irradiance;

/* Adds the irradiance of every such light. */
gw_status gw_direct_light(const gw_lit_cloud *cloud, const gw_light *lights, size_t light_count,
						  const gw_direct_irradiance *to, gw_error *error);

/*
 * The share of one light that each surfel sees, whichever way it faces.
 *   share   surfel count, 0..1, on the CPU
 */
gw_status gw_light_share(const gw_lit_cloud *cloud, const gw_light *light, float *share,
						 gw_error *error);

/*
 * Area-weighted means over the facets.
 *   surfels   texel buffer R32G32B32A32_SFLOAT, surfel count
 *   facets     facet_count vec4, receives them; w is 0
 */
gw_status gw_average_facets(gw_passes *passes, const gw_octree *octree, const gw_buffer *surfels,
							gw_buffer *facets, gw_error *error);

#endif

/*
 * given_rays.comp - the light along rays that leave surfaces, one an invocation: where one meets a
 * plane, that of the discs there, as in pixel_rays.comp, and where it meets none, the sky.
 */
#include "light/transport_layout.h"
#include "octree/octree_walk.glsl"

TEXELS(0, uint, ray_directory);
TEXELS(1, uint, node);
TEXELS(2, uvec2, leaf_tile);
TEXELS(3, vec4, facet_plane);
TEXELS(4, vec4, facet_centre);
TEXELS(5, uint, leaf_fragment);
TEXELS(6, uint, fragment_surfel);
TEXELS(7, vec4, surfel_place);
TEXELS(8, vec4, surfel_facing);
TEXELS(9, vec4, surfel_disc);
TEXELS(10, vec4, surfel_clip);
TEXELS(11, vec4, surfel_radiance);
BUFFER(12, readonly, vec4, ray_place);  /* grid coordinates, until how much of it is left */
BUFFER(13, readonly, vec4, ray_facing); /* unit: of the surface there */
BUFFER(14, readwrite, vec4, ray_light); /* direction, unit; then radiance */
TEXELS(15, uvec4, disc_tree);
TEXELS(16, vec4, sky_texel);
TEXELS(17, vec4, facet_albedo);
BUFFER(18, readonly, uint, facet_leaf);
PUSH(gw_pixel_push);

#define TRACE_OPACITY
#include "octree/octree_discs.glsl"
#include "octree/trace.glsl"
#include "picture/disc_light.glsl"
#include "picture/sky_seen.glsl"

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	vec3 g = ray_place[i].xyz, direction = ray_light[i].xyz;
	Ray ray = { g, direction, ray_facing[i].xyz, g, GW_FAR, false };
	float through;
	Hit hit = trace_through(ray, ray_place[i].w, through);
	vec3 seen =
		hit.facet != GW_NONE ? radiance_at(hit.facet, g + direction * hit.t) : sky_seen(direction);
	ray_light[i] = vec4(seen, 0.0f);
}

/*
 * probe_rays.comp - what probes see: one ray an invocation, from a probe in one of the directions
 * that all probes have in common. Fronts of surface stop it; where surface lets light through, it
 * stops it as often as that does.
 */
#include "light/transport_layout.h"
#include "octree/octree_walk.glsl"

TEXELS(0, uint, ray_directory);
TEXELS(1, uint, node);
TEXELS(2, uvec2, leaf_tile);
TEXELS(3, vec4, facet_plane);
TEXELS(4, vec4, facet_centre);
TEXELS(5, vec4, probe_position);
TEXELS(6, vec4, ray_direction);
BUFFER(7, writeonly, uint, hit_facet);
BUFFER(8, writeonly, float, hit_distance);
TEXELS(9, uint, leaf_fragment);
TEXELS(10, uint, fragment_surfel);
TEXELS(11, vec4, surfel_place);
TEXELS(12, vec4, surfel_facing);
TEXELS(13, vec4, surfel_disc);
TEXELS(14, vec4, surfel_clip);
TEXELS(15, uvec4, disc_tree);
TEXELS(16, vec4, facet_albedo);
BUFFER(17, readonly, uint, facet_leaf);
PUSH(gw_probe_push);

#define TRACE_OPACITY
#include "octree/octree_discs.glsl"
#include "octree/trace.glsl"
#include "base/sampling.glsl"

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	uint number = push.first + i, k = number % push.rays;
	vec3 g = texelFetch(probe_position, int(number / push.rays)).xyz;
	vec3 direction = texelFetch(ray_direction, int(k)).xyz;
	/* It leaves no surface: all that lies ahead rises over a plane across it. */
	Ray ray = { g, direction, direction, g - direction, GW_FAR, false };
	uint own = pcg_hash2(pcg_hash_place(g), push.seed ^ GW_OPACITY_SEED);
	float through, chance = stratified(own, k);
	Hit hit = trace_through(ray, chance, through);
	hit_facet[i] = hit.facet;
	hit_distance[i] = hit.passed_back_face ? -hit.t : hit.t;
}

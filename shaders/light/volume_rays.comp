/*
 * volume_rays.comp - trace step of a radiance volume (Mavridis and Papaioannou, section 3.3): one
 * ray of a cell an invocation, from its centre, over the whole sphere. What was hit is kept and
 * serves all bounces. With push.looking, whether the first surface that the ray met showed its
 * back, by which cells are known that lie in something solid, or which facet's front it was.
 */
#include "light/transport_layout.h"
#include "octree/octree_walk.glsl"

TEXELS(0, uint, ray_directory);
TEXELS(1, uint, node);
TEXELS(2, uvec2, leaf_tile);
TEXELS(3, vec4, facet_plane);
TEXELS(4, vec4, facet_centre);
TEXELS(5, vec4, cell_centre);
TEXELS(6, vec4, pattern);
BUFFER(7, writeonly, uint, cell_hit);
TEXELS(8, uint, leaf_fragment);
TEXELS(9, uint, fragment_surfel);
TEXELS(10, vec4, surfel_place);
TEXELS(11, vec4, surfel_facing);
TEXELS(12, vec4, surfel_disc);
TEXELS(13, vec4, surfel_clip);
TEXELS(14, uvec4, disc_tree);
TEXELS(15, vec4, facet_albedo);
BUFFER(16, readonly, uint, facet_leaf);
PUSH(gw_volume_push);

#define TRACE_OPACITY
#include "octree/octree_discs.glsl"
#include "octree/trace.glsl"
#include "light/volume_ray.glsl"

/* The ray begins in free space and leaves no surface: one far behind it. */
#define BEHIND 16.0f

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	uint number = push.first + i;
	vec3 g = texelFetch(cell_centre, int(number / push.rays)).xyz;
	uint k = number % push.rays;
	vec3 direction = turned(turn_of_cell(g), texelFetch(pattern, int(k)).xyz);
	Ray ray = { g, direction, direction, g - direction * BEHIND, GW_FAR, false };
	float chance = stratified(pcg_hash2(pcg_hash_place(g), push.seed ^ GW_OPACITY_SEED), k);
	float through;
	Hit hit = trace_through(ray, chance, through);
	uint met = hit.passed_back_face   ? GW_VOLUME_MET_BACK
			   : hit.facet != GW_NONE ? hit.facet
									  : GW_VOLUME_MET_NOTHING;
	cell_hit[i] = push.looking != 0u ? met : hit.facet;
}

/*
 * record_portals.comp - which of the samples that a record takes of the portals leave
 * the scene: a bit each. Like hits they serve every sky.
 */
#include "light/transport_layout.h"
#include "octree/octree_walk.glsl"

TEXELS(0, uint, ray_directory);
TEXELS(1, uint, node);
TEXELS(2, uvec2, leaf_tile);
TEXELS(3, vec4, facet_plane);
TEXELS(4, vec4, facet_centre);
TEXELS(5, vec4, record_position);
TEXELS(6, vec4, record_normal);
TEXELS(7, vec4, portal);
BUFFER(8, writeonly, uint, sky_seen);
TEXELS(9, uint, leaf_fragment);
TEXELS(10, uint, fragment_surfel);
TEXELS(11, vec4, surfel_place);
TEXELS(12, vec4, surfel_facing);
TEXELS(13, vec4, surfel_disc);
TEXELS(14, vec4, surfel_clip);
TEXELS(15, uvec4, disc_tree);
TEXELS(16, vec4, facet_albedo);
BUFFER(17, readonly, uint, facet_leaf);
PUSH(gw_record_push);

#define TRACE_OPACITY
#include "octree/octree_discs.glsl"
#include "octree/trace.glsl"
#include "light/portals.glsl"

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	int record = int(push.first + i);
	vec3 g = texelFetch(record_position, record).xyz;
	vec3 normal = texelFetch(record_normal, record).xyz;
	PortalsTurn turn = portals_begin(g, normal);
	uint seen = 0u;
	for (uint m = 0u; m < GW_PORTAL_SAMPLES && turn.total > 0.0f; m++) {
		vec3 direction = portals_direction(g, normal, m, turn);
		Ray ray = { g, direction, normal, g, GW_FAR, false };
		float through, chance = stratified(pcg_hash2(turn.own, GW_OPACITY_SEED), m);
		if (dot(direction, normal) > 0.0f && trace_through(ray, chance, through).facet == GW_NONE)
			seen |= 1u << m;
	}
	sky_seen[i] = seen;
}

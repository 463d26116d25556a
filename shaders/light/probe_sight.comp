/*
 * probe_sight.comp - how well a probe sees a place on the surface (Wang 2018, section 3.2.1 and
 * equation 3.2): one invocation a pair of a viewer and a place. 0 where the place is hidden or
 * faces away, else a weighted sum of the cosine at which it is seen and of its distance.
 */
#include "light/transport_layout.h"
#include "octree/octree_walk.glsl"

TEXELS(0, uint, ray_directory);
TEXELS(1, uint, node);
TEXELS(2, uvec2, leaf_tile);
TEXELS(3, vec4, facet_plane);
TEXELS(4, vec4, facet_centre);
TEXELS(5, vec4, viewer);
TEXELS(6, vec4, place_position); /* w: 1 where it is seen from both sides */
TEXELS(7, vec4, place_normal);
BUFFER(8, writeonly, float, sight);
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

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	uint number = push.first + i;
	int place = int(number % push.rays);
	vec4 g = texelFetch(place_position, place);
	vec3 normal = texelFetch(place_normal, place).xyz;
	vec3 towards = texelFetch(viewer, int(number / push.rays)).xyz - g.xyz;
	float distance = sqrt(dot(towards, towards));
	towards = towards / max(distance, 1e-6f);
	float cosine = dot(normal, towards);
	if (cosine < 0.0f && g.w > 0.5f) {
		cosine = -cosine;
		normal = -normal;
	}
	sight[i] = 0.0f;
	if (!(cosine > 0.0f))
		return;
	Ray ray = { g.xyz, towards, normal, g.xyz, distance, true };
	float through;
	if (trace_through(ray, GW_THROUGH_LEAST, through).facet == GW_NONE)
		sight[i] = through * (push.orientation * cosine +
							  push.distance * min(1.0f, distance / push.reach));
}

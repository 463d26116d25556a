/*
 * record_again.comp - traces the rays that record_keep.comp lists, as record_rays.comp does.
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
TEXELS(7, uint, list);
BUFFER(8, writeonly, uint, hit_facet);
BUFFER(9, writeonly, float, hit_distance);
TEXELS(10, uint, leaf_fragment);
TEXELS(11, uint, fragment_surfel);
TEXELS(12, vec4, surfel_place);
TEXELS(13, vec4, surfel_facing);
TEXELS(14, vec4, surfel_disc);
TEXELS(15, vec4, surfel_clip);
TEXELS(16, uvec4, disc_tree);
TEXELS(17, vec4, facet_albedo);
BUFFER(18, readonly, uint, facet_leaf);
PUSH(gw_keep_push);

#define TRACE_OPACITY
#include "octree/octree_discs.glsl"
#include "octree/trace.glsl"
#include "light/record_ray.glsl"

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	uint number = texelFetch(list, int(1u + push.first + i)).x;
	int record = int(number / push.rays);
	vec3 g = texelFetch(record_position, record).xyz,
		 normal = texelFetch(record_normal, record).xyz;
	uint k = number % push.rays;
	float through;
	Hit hit = trace_through(gather_ray(g, normal, k), record_chance(g, k), through);
	hit_facet[number] = hit.facet;
	hit_distance[number] = hit.passed_back_face ? -hit.t : hit.t;
}

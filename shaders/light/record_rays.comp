/*
 * record_rays.comp - trace step of the records: one gather ray an invocation, cosine-weighted over
 * the record's hemisphere. What was hit is kept; the hits of a record serve all bounces, because
 * geometry does not change between them.
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
PUSH(gw_record_push);

#define TRACE_OPACITY
#include "octree/octree_discs.glsl"
#include "octree/trace.glsl"
#include "light/record_ray.glsl"

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	uint number = push.first + i;
	int record = int(number / push.rays);
	vec3 g = texelFetch(record_position, record).xyz,
		 normal = texelFetch(record_normal, record).xyz;
	uint k = number % push.rays;
	float through;
	Hit hit = trace_through(gather_ray(g, normal, k), record_chance(g, k), through);
	hit_facet[i] = hit.facet;
	/* Negative: the ray passed the back of a surface on its way. */
	hit_distance[i] = hit.passed_back_face ? -hit.t : hit.t;
}

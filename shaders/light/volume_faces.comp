/*
 * volume_faces.comp - light propagation volumes, as far as the geometry goes: the share of light
 * that gets from the centre of a cell to that of the next one through one of its faces, an
 * invocation each. Kaplanyan and Dachsbacher estimate it from the surfels in the cell; a ray
 * between the centres finds the same wall however thin it is, so that what surface closes off stays
 * dark.
 */
#include "light/transport_layout.h"
#include "octree/octree_walk.glsl"

TEXELS(0, uint, ray_directory);
TEXELS(1, uint, node);
TEXELS(2, uvec2, leaf_tile);
TEXELS(3, vec4, facet_plane);
TEXELS(4, vec4, facet_centre);
TEXELS(5, vec4, cell_centre);
BUFFER(6, writeonly, float, face_through);
TEXELS(7, uint, leaf_fragment);
TEXELS(8, uint, fragment_surfel);
TEXELS(9, vec4, surfel_place);
TEXELS(10, vec4, surfel_facing);
TEXELS(11, vec4, surfel_disc);
TEXELS(12, vec4, surfel_clip);
TEXELS(13, uvec4, disc_tree);
TEXELS(14, vec4, facet_albedo);
BUFFER(15, readonly, uint, facet_leaf);
PUSH(gw_volume_push);

#define TRACE_OPACITY
#include "octree/octree_discs.glsl"
#include "octree/trace.glsl"

/* The ray begins in free space and leaves no surface: one far behind it. */
#define BEHIND 16.0f

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	uint number = push.first + i, face = number % GW_CELL_FACES, axis = face >> 1;
	vec3 g = texelFetch(cell_centre, int(number / GW_CELL_FACES)).xyz;
	float way = (face & 1u) != 0u ? 1.0f : -1.0f;
	vec3 direction =
		vec3(axis == 0u ? way : 0.0f, axis == 1u ? way : 0.0f, axis == 2u ? way : 0.0f);
	Ray ray = { g, direction, direction, g - direction * BEHIND, push.minimum.w, true };
	float through;
	Hit hit = trace_through(ray, GW_THROUGH_LEAST, through);
	face_through[i] = hit.facet == GW_NONE ? through : 0.0f;
}

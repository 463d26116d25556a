/*
 * record_place.comp - place step: where on its facet a record stands.
 *
 * The centroid of a facet can lie beyond the end of the surface, where discs stick out over an
 * edge, and a record there would see what no point sees. So a record stands where the facet's plane
 * is nearest to the surfel nearest to the centroid; where surfels are further apart than that, at
 * the centroid, unless the facet is but a sliver: that may lie in the rock behind a crease that its
 * disc does not know of. Of leaves with very many fragments every n-th is looked at.
 */
#version 460

#include "light/transport_layout.h"
#include "octree/octree_numbers.glsl"

layout(local_size_x_id = 0) in;
layout(binding = 0) uniform usamplerBuffer leaf_fragment;
layout(binding = 1) uniform usamplerBuffer fragment_surfel;
layout(binding = 2) uniform samplerBuffer surfel_position;
layout(binding = 3) uniform samplerBuffer facet_plane;
layout(binding = 4) uniform samplerBuffer facet_centre;
layout(binding = 5) readonly buffer Facet
{
	uint record_facet[];
};
layout(binding = 6) writeonly buffer Position
{
	vec4 record_position[];
};
layout(binding = 7) writeonly buffer Normal
{
	vec4 record_normal[];
};
layout(binding = 8) uniform usamplerBuffer facet_leaf;
layout(push_constant) uniform Push
{
	gw_record_push push;
};

const uint FRAGMENTS = 1024u;
const float APART = 1.5, APART_OF_SLIVERS = 4.0; /* leaf cells */
const float SLIVER = 0.25;                       /* leaf cells^2 */

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	uint facet = record_facet[i] & ~GW_RECORD_BACK;
	vec3 normal = texelFetch(facet_plane, int(facet)).xyz;
	vec4 middle = texelFetch(facet_centre, int(facet));
	vec3 centre = middle.xyz;
	uint own = texelFetch(facet_leaf, int(facet)).x, leaf = leaf_of(own);
	uint first = texelFetch(leaf_fragment, int(leaf)).x;
	uint last = texelFetch(leaf_fragment, int(leaf + 1u)).x;
	uint stride = max(1u, (last - first) / FRAGMENTS);
	vec3 place = centre;
	float apart = middle.w < SLIVER ? APART_OF_SLIVERS : APART, nearest = apart * apart;
	for (uint f = first; f < last; f += stride) {
		uint word = texelFetch(fragment_surfel, int(f)).x;
		if (!is_disc_of(own, word))
			continue;
		vec3 off = texelFetch(surfel_position, int(word & GW_FRAGMENT_SURFEL)).xyz - centre;
		if (dot(off, off) < nearest) {
			nearest = dot(off, off);
			place = centre + off - normal * dot(normal, off);
		}
	}
	record_position[i] = vec4(place, 0.0);
	record_normal[i] = vec4(facet == record_facet[i] ? normal : -normal, 0.0);
}

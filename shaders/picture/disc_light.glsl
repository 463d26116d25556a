/*
 * disc_light.glsl - the light of the points where a ray meets a plane. Uses the texel buffers
 * leaf_fragment, fragment_surfel, surfel_place, surfel_facing, surfel_disc (octree.h) and
 * surfel_radiance, and the storage buffer facet_leaf.
 */
#ifndef DISC_LIGHT_GLSL
#define DISC_LIGHT_GLSL

#include "octree/octree_numbers.glsl"

/* The discs of a facet at a place, blended with a weight that falls to nothing at the rim. Where
 * none reaches, all of them alike. */
vec3 radiance_at(uint facet, vec3 at)
{
	uint own = facet_leaf[facet], leaf = leaf_of(own);
	uint first = texelFetch(leaf_fragment, int(leaf)).x;
	uint last = texelFetch(leaf_fragment, int(leaf) + 1).x;
	vec3 near = vec3(0.0f), all = vec3(0.0f);
	float near_weight = 0.0f, all_weight = 0.0f;
	for (uint f = first; f < last; f++) {
		uint word = texelFetch(fragment_surfel, int(f)).x;
		if (!is_disc_of(own, word))
			continue;
		int surfel = int(word & GW_FRAGMENT_SURFEL);
		vec3 off = at - texelFetch(surfel_place, surfel).xyz;
		vec3 facing = texelFetch(surfel_facing, surfel).xyz;
		off -= facing * dot(facing, off);
		float radius = texelFetch(surfel_disc, surfel).x;
		float weight = max(0.0f, 1.0f - dot(off, off) / (radius * radius));
		vec3 radiance = texelFetch(surfel_radiance, surfel).xyz;
		near += radiance * (weight * weight);
		near_weight += weight * weight;
		all += radiance;
		all_weight += 1.0f;
	}
	return near_weight > 1e-6f ? near / near_weight : all / max(all_weight, 1.0f);
}

#endif

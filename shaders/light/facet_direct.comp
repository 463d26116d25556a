/*
 * facet_direct.comp - irradiance of each facet from point, spot and sun lights: the area-weighted
 * mean over the surfels that lie in it. Of leaves with very many fragments every n-th counts, so
 * that no invocation loops long.
 */
#include "base/pass.glsl"
#include "light/transport_layout.h"
#include "octree/octree_numbers.glsl"

TEXELS(0, uint, leaf_fragment);
TEXELS(1, uint, fragment_surfel);
TEXELS(2, float, fragment_weight);
TEXELS(3, vec4, surfel_irradiance);
BUFFER(4, writeonly, vec4, facet_direct);
TEXELS(5, uint, facet_leaf);
PUSH(gw_record_push);

#define FRAGMENTS 1024u

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	uint own = texelFetch(facet_leaf, int(push.first + i)).x, leaf = leaf_of(own);
	uint first = texelFetch(leaf_fragment, int(leaf)).x;
	uint last = texelFetch(leaf_fragment, int(leaf + 1u)).x;
	uint stride = max(1u, (last - first) / FRAGMENTS);
	vec3a sum = vec3a(0.0f);
	float area = 0.0f;
	for (uint f = first; f < last; f += stride) {
		uint surfel = texelFetch(fragment_surfel, int(f)).x;
		if (!is_disc_of(own, surfel))
			continue;
		float weight = texelFetch(fragment_weight, int(f)).x;
		sum += weight * vec3a(texelFetch(surfel_irradiance, int(surfel & GW_FRAGMENT_SURFEL)));
		area += weight;
	}
	facet_direct[i] = vec4(area > 0.0f ? vec3(sum / area) : vec3(0.0f), 0.0f);
}

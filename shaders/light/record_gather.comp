/*
 * record_gather.comp - one bounce at the records: mean radiance of what their rays hit, a sparse
 * product over the stored hits. E = pi/K sum L(hit). Of a buried record only hits before any back
 * of a surface count.
 */
#include "base/pass.glsl"
#include "base/shared_math.h"
#include "light/transport_layout.h"

TEXELS(0, uint, hit_facet);
TEXELS(1, vec4, facet_radiance);
BUFFER(2, readonly, vec4, record_normal); /* w: below 1 if buried */
BUFFER(3, writeonly, vec4, record_gathered);
TEXELS(4, float, hit_distance);
PUSH(gw_record_push);

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	uint first = (push.first + i) * push.rays;
	bool buried = record_normal[i].w < 1.0f;
	vec3a sum = vec3a(0.0f);
	for (uint k = first; k < first + push.rays; k++) {
		uint facet = texelFetch(hit_facet, int(k)).x;
		if (facet != GW_NONE && !(buried && texelFetch(hit_distance, int(k)).x < 0.0f))
			sum += vec3a(texelFetch(facet_radiance, int(facet)));
	}
	sum = sum * (GW_PI / float(push.rays));
	record_gathered[i] = vec4(vec3(sum), 0.0f);
}

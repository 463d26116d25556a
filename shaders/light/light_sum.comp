/*
 * light_sum.comp - adds up light, over all facets or all records, as a tree: each invocation makes
 * one part of GW_SUM_RUN elements or parts, which lie apart, so that neighbours read neighbours.
 * What a sum of floats would round away is kept beside it (Knuth's two-sum), since millions of
 * small parts are added.
 */
#include "base/pass.glsl"
#include "base/sampling.glsl"
#include "light/transport_layout.h"

TEXELS(0, vec4, light);        /* radiance of facets, irradiance of records */
TEXELS(1, vec4, weight);       /* w: area of a facet; xyz: power of a record (record_powers.h) */
TEXELS(2, vec4, facet_albedo); /* the fraction of w: transparency */
BUFFER(3, readwrite, vec4, part); /* sum, what it lacks, sum of squares, largest component */
PUSH(gw_sum_push);

vec4 part_of(uint i)
{
	if (push.kind == GW_SUM_PARTS)
		return part[push.source + i];
	vec3 l = texelFetch(light, int(i)).xyz;
	vec4 w = texelFetch(weight, int(i));
	float most = max(max(l.x, l.y), l.z), amount;
	if (push.kind == GW_SUM_FACETS) {
		float area = w.w * (1.0 - fract(texelFetch(facet_albedo, int(i)).w));
		amount = area * abs(luminance(l));
	} else {
		l = abs(l);
		most = max(max(l.x, l.y), l.z);
		amount = dot(w.xyz, l);
	}
	return vec4(amount, 0.0, amount * amount, most);
}

void main()
{
	if (gl_GlobalInvocationID.x >= push.count)
		return;
	uint own = push.first + gl_GlobalInvocationID.x;
	precise vec4 sum = vec4(0.0);
	for (uint i = own; i < push.total; i += push.parts) {
		vec4 more = part_of(i);
		precise float both = sum.x + more.x;
		precise float added = both - sum.x;
		precise float lacking = (sum.x - (both - added)) + (more.x - added);
		sum = vec4(both, sum.y + more.y + lacking, sum.z + more.z, max(sum.w, more.w));
	}
	part[push.target + own] = sum;
}

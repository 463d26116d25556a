/*
 * facet_shade.comp - shade step: radiance that each facet reflects of one bounce's irradiance,
 * which is interpolated from the records (and, for the first reflection, of the lights' direct
 * irradiance).
 */
#include "base/pass.glsl"
#include "base/shared_math.h"
#include "light/transport_layout.h"

BUFFER(0, readonly, vec4, facet_albedo);
BUFFER(1, readonly, vec4, facet_direct);
TEXELS(2, uvec4, facet_record); /* four a texel, GW_WEIGHTS a row */
TEXELS(3, vec4, facet_weight);
TEXELS(4, vec4, record_irradiance);
BUFFER(5, writeonly, vec4, facet_radiance);
BUFFER(6, readonly, uint, facet_row);
PUSH(gw_record_push);

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	vec3a e = vec3a(0.0f);
	if (push.direct_share != 0.0f)
		e = push.direct_share * vec3a(facet_direct[i]);
	int row = int(facet_row[i]) * int(GW_WEIGHTS / 4u);
	for (int t = row; t < row + int(GW_WEIGHTS / 4u); t++) {
		uvec4 record = texelFetch(facet_record, t);
		if (record.x == GW_NONE)
			break;
		vec4 weight = texelFetch(facet_weight, t);
		for (int k = 0; k < 4 && record[k] != GW_NONE; k++)
			e += weight[k] * vec3a(texelFetch(record_irradiance, int(record[k])));
	}
	facet_radiance[i] = vec4(vec3(vec3a(facet_albedo[i]) * e / GW_PI), 0.0f);
}

/*
 * record_moments.comp - how irradiance that records gather from what their rays hit changes where
 * their normals turn, added to what is there. Of a buried record only hits before
 * any back of a surface count, as in record_gather.comp.
 */
#include "base/pass.glsl"
#include "light/transport_layout.h"

TEXELS(0, uint, hit_facet);
TEXELS(1, vec4, facet_radiance);
BUFFER(2, readonly, vec4, record_position);
BUFFER(3, readonly, vec4, record_normal); /* w: below 1 if buried */
BUFFER(4, readwrite, vec4, record_moment); /* 2 a record */
TEXELS(5, float, hit_distance);
PUSH(gw_record_push);

#include "light/record_moment.glsl"

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	uint hit = (push.first + i) * push.rays;
	bool buried = record_normal[i].w < 1.0f;
	vec3 g = record_position[i].xyz;
	vec3 first = vec3(0.0f), second = vec3(0.0f);
	for (uint k = 0u; k < push.rays; k++) {
		uint facet = texelFetch(hit_facet, int(hit + k)).x;
		if (facet == GW_NONE || (buried && texelFetch(hit_distance, int(hit + k)).x < 0.0f))
			continue;
		vec3 radiance = texelFetch(facet_radiance, int(facet)).xyz;
		vec2 share = moment_share_of_ray(g, k);
		first += radiance * share.x;
		second += radiance * share.y;
	}
	float each = GW_PI / float(push.rays);
	record_moment[2u * i].xyz += first * each;
	record_moment[2u * i + 1u].xyz += second * each;
}

/*
 * record_keep.comp - which rays still hit what they hit before something moved in (Salm 4.5).
 *
 * A ray of a record that was there before keeps its hit when nothing on its way has changed: when
 * the way to the hit passes none of the boxes around what moves. Facets have other numbers now. The
 * other rays are listed, in any order; record_again.comp traces them.
 */
#version 460

#include "base/sampling.glsl"
#include "light/transport_layout.h"

layout(local_size_x_id = 0) in;
layout(binding = 0) uniform usamplerBuffer known_facet; /* of the records as they were */
layout(binding = 1) uniform samplerBuffer known_distance;
layout(binding = 2) uniform usamplerBuffer known_record; /* of each record: which it was, or NONE */
layout(binding = 3) uniform usamplerBuffer facet_now;    /* of each facet as it was */
layout(binding = 4) uniform samplerBuffer record_position;
layout(binding = 5) uniform samplerBuffer record_normal;
layout(binding = 6) uniform samplerBuffer box; /* two corners each */
layout(binding = 7) writeonly buffer Facet
{
	uint hit_facet[];
};
layout(binding = 8) writeonly buffer Distance
{
	float hit_distance[];
};
layout(binding = 9) buffer List
{
	uint list[]; /* [0]: how many, then these */
};
layout(push_constant) uniform Push
{
	gw_keep_push push;
};

#include "light/record_ray.glsl"

bool passes_box(vec3 origin, vec3 inverse, float t)
{
	for (uint b = 0u; b < push.boxes; b++) {
		vec3 low = (texelFetch(box, int(2u * b)).xyz - origin) * inverse;
		vec3 high = (texelFetch(box, int(2u * b + 1u)).xyz - origin) * inverse;
		vec3 near = min(low, high), far = max(low, high);
		float enter = max(0.0, max(near.x, max(near.y, near.z)));
		if (enter <= min(t, min(far.x, min(far.y, far.z))))
			return true;
	}
	return false;
}

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	uint ray = push.first + i;
	uint record = ray / push.rays, k = ray % push.rays;
	uint before = texelFetch(known_record, int(record)).x;
	if (before != GW_NONE) {
		vec3 g = texelFetch(record_position, int(record)).xyz;
		float cosine;
		vec3 way = record_ray(g, texelFetch(record_normal, int(record)).xyz, k, cosine);
		vec3 away = mix(vec3(-1.0), vec3(1.0), greaterThanEqual(way, vec3(0.0)));
		vec3 inverse = away / max(abs(way), vec3(1e-20));
		uint facet = texelFetch(known_facet, int(before * push.rays + k)).x;
		float t = texelFetch(known_distance, int(before * push.rays + k)).x;
		if (!passes_box(g, inverse, abs(t))) {
			hit_facet[i] = facet == GW_NONE ? GW_NONE : texelFetch(facet_now, int(facet)).x;
			hit_distance[i] = t;
			return;
		}
	}
	list[1u + atomicAdd(list[0], 1u)] = ray;
}

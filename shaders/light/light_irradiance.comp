/*
 * light_irradiance.comp - adds one light's irradiance at each surfel: analytic, times the
 * visibility that light_visibility.comp or shadow_map_visibility.comp found. The fourth component
 * is luminance that was hidden: above 0 by surface of which nobody knows exactly where it ends,
 * below 0 by what ends at a crease; not there where the lamp has an extent, whose penumbra is far
 * wider than what is unknown of a crease.
 */
#include "base/pass.glsl"
#include "light/transport_layout.h"

BUFFER(0, readonly, vec4, surfel_position);
BUFFER(1, readonly, vec4, surfel_normal);
BUFFER(2, readonly, float, visibility);
BUFFER(3, readwrite, vec4, irradiance);
BUFFER(4, readonly, float, distribution);
PUSH(gw_light_push);

#include "light/light.glsl"

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	float distance;
	vec3 towards, power = push.intensity.xyz;
	float e = light_received(surfel_position[i].xyz, surfel_normal[i], towards, distance);
	float told = push.shadows != 0u ? visibility[i] : 1.0f, seen = GW_SHARE_SEEN(told);
	float sign = told < 0.0f ? -told : 1.0f;
	if (told >= GW_HIDDEN_BY_CREASE)
		sign = push.samples > 1u ? 0.0f : -1.0f;
	irradiance[i] += vec4(e * power * seen, e * luminance(power) * (sign * (1.0f - seen)));
}

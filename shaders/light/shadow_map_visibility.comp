/*
 * shadow_map_visibility.comp - which share of a light each surfel sees, by a shadow map: the
 * minimum of a variance and an exponential shadow map (Salm 2.3, 4.2) under a disc of 5 texels.
 *
 * One invocation a surfel; those that lie outside the window keep their value. The thesis filters
 * the map first. Filtering where a surfel looks gives the same moments, needs one map instead of
 * three, and lets depths be taken relative to the receiver:
 *   - what lies behind the receiver counts as lying on it, which removes the light that both
 *     kinds of map leak behind an occluder with an open background;
 *   - at taps where the receiver's plane comes nearer, that plane is the receiver, so that a
 *     slanted surface does not shade itself;
 *   - exponents are never above 0: they cannot overflow, however sharp the exponential is.
 */
#version 460

#include "light/shadow_layout.h"

layout(local_size_x_id = 0) in;
layout(binding = 0) uniform samplerBuffer shadow_map;
layout(binding = 1) readonly buffer Position { vec4 surfel_position[]; };
layout(binding = 2) readonly buffer Normal { vec4 surfel_normal[]; };
layout(binding = 3) buffer Visibility { float visibility[]; };
layout(push_constant) uniform Push { gw_shadow_push push; };

#include "light/shadow_ray.glsl"

const float FILTER_RADIUS = 2.5; /* texels */
const float RAY_OFFSET = 0.15;   /* leaf cells: scatter of surfels about the planes in the leaves */
const float TEXEL_OFFSET = 0.5;  /* texels: a map's plane is known at texel centres */
const float SHARPNESS = 4.0;     /* of the exponential, per leaf cell */
const float VARIANCE_MIN = 0.01; /* leaf cells squared: that scatter again */

/* Whether this window answers for a place, and where in it the place lies. */
bool in_window(vec3 place, out vec2 texel)
{
	if (place.z <= 0.0)
		return false;
	texel = shadow_texel(place);
	vec2 corner = vec2(push.first_x, push.first_y);
	vec2 whole = texel - float(GW_SHADOW_BORDER) + corner;
	float last = push.forward.w;
	/* A rounding beyond the map's rim still belongs to it. */
	if (any(lessThan(whole, vec2(-0.01))) || any(greaterThan(whole, vec2(last + 0.01))))
		return false;
	whole = clamp(whole, vec2(0.0), vec2(last - 0.001));
	texel = whole - corner + float(GW_SHADOW_BORDER);
	float first = float(GW_SHADOW_BORDER), beyond = float(push.side - GW_SHADOW_BORDER);
	return all(greaterThanEqual(texel, vec2(first))) && all(lessThan(texel, vec2(beyond)));
}

/* Moments of how far what the light sees lies before the receiver at g: mean, mean square, mean
 * exponential. */
vec3 filter_map(vec2 texel, vec3 g, float t, vec3 normal)
{
	ivec2 corner = ivec2(floor(texel - 0.5)) - 2;
	vec4 sum = vec4(0.0);
	for (int k = 0; k < 36; k++) {
		ivec2 at = corner + ivec2(k % 6, k / 6);
		vec2 centre = vec2(at) + 0.5;
		float weight = clamp(FILTER_RADIUS + 0.5 - distance(centre, texel), 0.0, 1.0);
		vec3 origin, direction;
		shadow_ray(centre, origin, direction);
		direction = normalize(direction);
		float receiver = min(t, dot(normal, g - origin) / min(dot(normal, direction), -0.02));
		float seen = texelFetch(shadow_map, at.y * int(push.side) + at.x).x * push.up.w;
		float before = min(seen - receiver, 0.0);
		sum += weight * vec4(before, before * before, exp(SHARPNESS * before), 1.0);
	}
	return sum.xyz / sum.w;
}

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	vec3 g = surfel_position[i].xyz;
	vec3 place = shadow_place(g);
	vec2 texel;
	if (!in_window(place, texel))
		return;
	bool sun = push.origin.w > 0.5;
	vec3 normal = surfel_normal[i].xyz;
	if (dot(normal, sun ? push.forward.xyz : g - push.origin.xyz) > 0.0)
		normal = -normal;
	g += normal * (RAY_OFFSET + TEXEL_OFFSET * (sun ? 1.0 : place.z) / push.right.w);
	float t = sun ? dot(push.forward.xyz, g - push.origin.xyz) : length(g - push.origin.xyz);
	vec3 moments = filter_map(texel, g, t, normal);
	float variance = max(moments.y - moments.x * moments.x, VARIANCE_MIN);
	float chebyshev = variance / (variance + moments.x * moments.x);
	visibility[i] = min(chebyshev, moments.z);
}

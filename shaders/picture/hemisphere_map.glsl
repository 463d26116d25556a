/*
 * hemisphere_map.glsl - a square as a hemisphere, equal areas as equal solid angles: the square as
 * a disc by Shirley and Chiu's concentric map (1997), and the disc as the hemisphere above it.
 */
#ifndef HEMISPHERE_MAP_GLSL
#define HEMISPHERE_MAP_GLSL

#include "base/sampling.glsl"

/* The direction, z up, of a place in [0, 1]^2. */
vec3 hemisphere_direction(vec2 place)
{
	float a = 2.0f * place.x - 1.0f, b = 2.0f * place.y - 1.0f;
	bool across = abs(a) > abs(b);
	float r = across ? a : b, other = across ? b : a;
	float phi = r == 0.0f ? 0.0f : 0.25f * GW_PI * other / r;
	float along = r * cos(phi), aside = r * sin(phi), stretch = sqrt(2.0f - r * r);
	return vec3(across ? along : aside, across ? aside : along, 0.0f) * stretch +
		   vec3(0.0f, 0.0f, 1.0f - r * r);
}

/* The place of a direction; of one below the horizon that of the horizon under it. */
vec2 hemisphere_place(vec3 d)
{
	float x = abs(d.x), y = abs(d.y), more = max(x, y);
	float r = sqrt(max(0.0f, 1.0f - max(d.z, 0.0f)));
	float other = more > 0.0f ? r * (4.0f / GW_PI) * atan(min(x, y), more) : 0.0f;
	float a = x > y ? r : other, b = x > y ? other : r;
	return vec2(0.5f + (d.x < 0.0f ? -0.5f : 0.5f) * a, 0.5f + (d.y < 0.0f ? -0.5f : 0.5f) * b);
}

#endif

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

/* The arc tangent of 0 to 1, to 1e-5 (Abramowitz and Stegun, Handbook of Mathematical Functions,
 * 4.4.49): a pixel asks for some 100, which otherwise take much of its time. */
float arc_tangent(float t)
{
	float t2 = t * t;
	return t * (0.9998660f +
				t2 * (-0.3302995f + t2 * (0.1801410f + t2 * (-0.0851330f + t2 * 0.0208351f))));
}

/* The place of a direction; of one below the horizon that of the horizon under it. */
vec2 hemisphere_place(vec3 d)
{
	float x = abs(d.x), y = abs(d.y), more = max(x, y);
	float r = sqrt(max(0.0f, 1.0f - max(d.z, 0.0f)));
	float other = more > 0.0f ? r * (4.0f / GW_PI) * arc_tangent(min(x, y) / more) : 0.0f;
	float a = x > y ? r : other, b = x > y ? other : r;
	return vec2(0.5f + (d.x < 0.0f ? -0.5f : 0.5f) * a, 0.5f + (d.y < 0.0f ? -0.5f : 0.5f) * b);
}

#endif

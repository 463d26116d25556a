/*
 * sampling.glsl - directions and frames, and random numbers for places.
 */
#ifndef SAMPLING_GLSL
#define SAMPLING_GLSL

#include "base/pass.glsl"
#include "base/shared_math.h"

/* A word for a place: what is random there then does not depend on what else is in the scene. */
uint pcg_hash_place(vec3 g)
{
	return pcg_hash2(floatBitsToUint(g.x), pcg_hash2(floatBitsToUint(g.y), floatBitsToUint(g.z)));
}

/* The i-th of numbers in [0, 1) that fill it evenly from the first on, shifted by a word (van der
 * Corput's). */
float stratified(uint shift, uint i)
{
	return unit_float(shift + bitfieldReverse(i));
}

/* Tangents of a unit normal (Duff et al. 2017). */
void tangent_frame(vec3 n, OUT(vec3) t, OUT(vec3) b)
{
	float s = n.z >= 0.0f ? 1.0f : -1.0f;
	float a = -1.0f / (s + n.z);
	float c = n.x * n.y * a;
	t = vec3(1.0f + s * n.x * n.x * a, s * c, -s * n.x);
	b = vec3(c, s + n.y * n.y * a, -n.y);
}

/* The i-th of n points that share the unit disc evenly: rings of a golden-angle spiral. u in [0, 1)
 * moves the point within its ring, turn rotates all of them. */
vec2 spiral_disc(uint i, uint n, float u, float turn)
{
	float r = sqrt((float(i) + u) / float(n));
	float phi = 2.0f * GW_PI * fract(float(i) * 0.618033988749895f + turn);
	return r * vec2(cos(phi), sin(phi));
}

/* Direction about n whose projection on the surface is the disc point: cosine-weighted. */
vec3 disc_to_hemisphere(vec2 p, vec3 n, OUT(float) cosine)
{
	vec3 t, b;
	tangent_frame(n, t, b);
	cosine = sqrt(max(0.0f, 1.0f - dot(p, p)));
	return normalize(t * p.x + b * p.y + n * cosine);
}

float luminance(vec3 c)
{
	return dot(c, vec3(float(GW_LUMINANCE_RED), float(GW_LUMINANCE_GREEN),
					   float(GW_LUMINANCE_BLUE)));
}

#endif

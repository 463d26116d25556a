/*
 * shader_math.h - what shaders/base/sampling.glsl and GLSL itself have, for loops of the host that
 * stand in for passes. Names are those of the shaders.
 */
#ifndef SHADER_MATH_H
#define SHADER_MATH_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#define GW_PI 3.14159265358979f

typedef struct gw_vec3 {
	float x, y, z;
} gw_vec3;

/* The first three of four floats. */
static inline gw_vec3 gw_xyz(const float *four)
{
	return (gw_vec3){ four[0], four[1], four[2] };
}

static inline gw_vec3 gw_plus(gw_vec3 a, gw_vec3 b)
{
	return (gw_vec3){ a.x + b.x, a.y + b.y, a.z + b.z };
}

static inline gw_vec3 gw_minus(gw_vec3 a, gw_vec3 b)
{
	return (gw_vec3){ a.x - b.x, a.y - b.y, a.z - b.z };
}

static inline gw_vec3 gw_times(gw_vec3 a, float factor)
{
	return (gw_vec3){ a.x * factor, a.y * factor, a.z * factor };
}

static inline float gw_dot(gw_vec3 a, gw_vec3 b)
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline float gw_smaller(float a, float b)
{
	return a < b ? a : b;
}

static inline float gw_larger(float a, float b)
{
	return a > b ? a : b;
}

static inline gw_vec3 gw_unit(gw_vec3 a)
{
	return gw_times(a, 1.0f / sqrtf(gw_dot(a, a)));
}

static inline float gw_float_of(uint32_t bits)
{
	float value;
	memcpy(&value, &bits, sizeof value);
	return value;
}

static inline uint32_t gw_bits_of(float value)
{
	uint32_t bits;
	memcpy(&bits, &value, sizeof bits);
	return bits;
}

/* ------------------------------------------------------------------------------ random numbers */

/* PCG hash (Jarzynski and Olano 2020): one well-mixed word from one word. */
static inline uint32_t gw_mix(uint32_t v)
{
	uint32_t state = v * 747796405u + 2891336453u;
	uint32_t word = ((state >> ((state >> 28) + 4u)) ^ state) * 277803737u;
	return (word >> 22) ^ word;
}

static inline uint32_t gw_mix2(uint32_t a, uint32_t b)
{
	return gw_mix(a ^ gw_mix(b + 0x9e3779b9u));
}

/* A word for a place. */
static inline uint32_t gw_mix_place(gw_vec3 g)
{
	return gw_mix2(gw_bits_of(g.x), gw_mix2(gw_bits_of(g.y), gw_bits_of(g.z)));
}

/* [0, 1), from the upper 24 bits. */
static inline float gw_unit_float(uint32_t word)
{
	return (float)(word >> 8) * (1.0f / 16777216.0f);
}

/* ---------------------------------------------------------------------- frames and directions */

/* Tangents of a unit normal. */
static inline void gw_frame_of(gw_vec3 n, gw_vec3 *t, gw_vec3 *b)
{
	float s = n.z >= 0.0f ? 1.0f : -1.0f;
	float a = -1.0f / (s + n.z);
	float c = n.x * n.y * a;
	*t = (gw_vec3){ 1.0f + s * n.x * n.x * a, s * c, -s * n.x };
	*b = (gw_vec3){ c, s + n.y * n.y * a, -n.y };
}

/* The i-th of n points that share the unit disc evenly, see sampling.glsl. */
static inline void gw_spiral_disc(uint32_t i, uint32_t n, float u, float turn, float p[2])
{
	float r = sqrtf(((float)i + u) / (float)n);
	float turns = (float)i * 0.618033988749895f + turn;
	float phi = 2.0f * GW_PI * (turns - floorf(turns));
	p[0] = r * cosf(phi);
	p[1] = r * sinf(phi);
}

/* a x + b y + n z */
static inline gw_vec3 gw_along(gw_vec3 a, float x, gw_vec3 b, float y, gw_vec3 n, float z)
{
	return gw_plus(gw_plus(gw_times(a, x), gw_times(b, y)), gw_times(n, z));
}

/* Direction about n whose projection on the surface is the disc point: cosine-weighted. */
static inline gw_vec3 gw_disc_to_hemisphere(const float p[2], gw_vec3 n)
{
	gw_vec3 t, b;
	gw_frame_of(n, &t, &b);
	float cosine = sqrtf(gw_larger(0.0f, 1.0f - (p[0] * p[0] + p[1] * p[1])));
	return gw_unit(gw_along(t, p[0], b, p[1], n, cosine));
}

/* Direction of the k-th of a record's gather rays: record_ray.glsl. */
static inline gw_vec3 gw_record_ray(gw_vec3 g, gw_vec3 normal, uint32_t k, uint32_t rays,
									uint32_t seed)
{
	float p[2];
	uint32_t own = gw_mix2(gw_mix_place(g), seed);
	gw_spiral_disc(k, rays, gw_unit_float(gw_mix2(own, k)), gw_unit_float(own), p);
	return gw_disc_to_hemisphere(p, normal);
}

static inline float gw_luminance_of(gw_vec3 c)
{
	return gw_dot(c, (gw_vec3){ 0.2126f, 0.7152f, 0.0722f });
}

#endif

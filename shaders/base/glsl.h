/*
 * glsl.h - GLSL for C++: the vectors, functions and declarations that the texts in shaders/ are
 * written with, as far as they use them. shaders/README.md has the rules for these texts.
 */
#ifndef GLSL_H
#define GLSL_H

#include <math.h>
#include <stdint.h>
#include <string.h>

typedef uint32_t uint;

/* How parameters are passed. */
#define IN(type) const type &
#define OUT(type) type &
#define INOUT(type) type &

/* A namespace, since C has some of these names for doubles. */
namespace glsl
{

/* ------------------------------------------------------------------------------------- vectors */

template <typename number> struct two {
	number x, y;
	two() = default;
	explicit two(number all) : x(all), y(all)
	{
	}
	two(number x, number y) : x(x), y(y)
	{
	}
};

typedef two<float> vec2;
typedef two<uint> uvec2;

struct vec3 {
	float x, y, z;
	vec3() = default;
	explicit vec3(float all) : x(all), y(all), z(all)
	{
	}
	vec3(float x, float y, float z) : x(x), y(y), z(z)
	{
	}
	inline explicit vec3(struct ivec3 v);
	inline explicit vec3(struct vec3a v);
};

/* Two of the four. */
struct vec2_part {
	float x, y;
	operator vec2() const
	{
		return vec2(x, y);
	}
};

/* Its parts have the names that GLSL has for them. */
struct alignas(16) vec4 {
	union {
		struct {
			float x, y, z, w;
		};
		vec3 xyz;
		struct {
			float before_yz;
			vec2_part yz;
		};
		struct {
			vec2_part xy, zw;
		};
		float at[4];
	};
	vec4() = default;
	vec4(float x, float y, float z, float w) : x(x), y(y), z(z), w(w)
	{
	}
	vec4(vec3 v, float w) : x(v.x), y(v.y), z(v.z), w(w)
	{
	}
	float operator[](int i) const
	{
		return at[i];
	}
};

struct uvec3 {
	uint x, y, z;
	uvec3() = default;
	uvec3(uint x, uint y, uint z) : x(x), y(y), z(z)
	{
	}
	inline explicit uvec3(struct ivec3 v);
};

struct ivec3 {
	int x, y, z;
	ivec3() = default;
	explicit ivec3(int all) : x(all), y(all), z(all)
	{
	}
	ivec3(int x, int y, int z) : x(x), y(y), z(z)
	{
	}
	explicit ivec3(vec3 v) : x((int)v.x), y((int)v.y), z((int)v.z)
	{
	}
	inline explicit ivec3(struct ivec3a v);
};

inline vec3::vec3(ivec3 v) : x((float)v.x), y((float)v.y), z((float)v.z)
{
}

inline uvec3::uvec3(ivec3 v) : x((uint)v.x), y((uint)v.y), z((uint)v.z)
{
}

struct alignas(16) uvec4 {
	union {
		struct {
			uint x, y, z, w;
		};
		uvec2 xy;
		uvec3 xyz;
		uint at[4];
	};
	uvec4() = default;
	uvec4(uint x, uint y, uint z, uint w) : x(x), y(y), z(z), w(w)
	{
	}
	uint operator[](int i) const
	{
		return at[i];
	}
};

#define GLSL_OPERATORS(op)                                                                         \
	inline vec2 operator op(vec2 a, vec2 b)                                                        \
	{                                                                                              \
		return vec2(a.x op b.x, a.y op b.y);                                                       \
	}                                                                                              \
	inline vec3 operator op(vec3 a, vec3 b)                                                        \
	{                                                                                              \
		return vec3(a.x op b.x, a.y op b.y, a.z op b.z);                                           \
	}                                                                                              \
	inline vec4 operator op(vec4 a, vec4 b)                                                        \
	{                                                                                              \
		return vec4(a.x op b.x, a.y op b.y, a.z op b.z, a.w op b.w);                               \
	}                                                                                              \
	inline vec2 operator op(vec2 a, float b)                                                       \
	{                                                                                              \
		return a op vec2(b);                                                                       \
	}                                                                                              \
	inline vec3 operator op(vec3 a, float b)                                                       \
	{                                                                                              \
		return a op vec3(b);                                                                       \
	}                                                                                              \
	inline vec4 operator op(vec4 a, float b)                                                       \
	{                                                                                              \
		return a op vec4(b, b, b, b);                                                              \
	}                                                                                              \
	inline vec2 operator op(float a, vec2 b)                                                       \
	{                                                                                              \
		return vec2(a) op b;                                                                       \
	}                                                                                              \
	inline vec3 operator op(float a, vec3 b)                                                       \
	{                                                                                              \
		return vec3(a) op b;                                                                       \
	}                                                                                              \
	inline vec2 &operator op##=(vec2 &a, vec2 b)                                                   \
	{                                                                                              \
		return a = a op b;                                                                         \
	}                                                                                              \
	inline vec3 &operator op##=(vec3 &a, vec3 b)                                                   \
	{                                                                                              \
		return a = a op b;                                                                         \
	}                                                                                              \
	inline vec4 &operator op##=(vec4 &a, vec4 b)                                                   \
	{                                                                                              \
		return a = a op b;                                                                         \
	}
GLSL_OPERATORS(+)
GLSL_OPERATORS(-)
GLSL_OPERATORS(*)
GLSL_OPERATORS(/)
#undef GLSL_OPERATORS

inline vec3 operator-(vec3 v)
{
	return vec3(-v.x, -v.y, -v.z);
}

inline uvec3 operator>>(uvec3 v, uint bits)
{
	return uvec3(v.x >> bits, v.y >> bits, v.z >> bits);
}

inline uvec3 operator&(uvec3 v, uint bits)
{
	return uvec3(v.x & bits, v.y & bits, v.z & bits);
}

/* A vec3 in one register of four: steps along a ray are quicker so. */
struct vec3a {
	typedef float lanes __attribute__((vector_size(16)));
	lanes v;
	vec3a() = default;
	vec3a(lanes v) : v(v)
	{
	}
	explicit vec3a(float all) : v{ all, all, all, all }
	{
	}
	explicit vec3a(vec3 v) : v{ v.x, v.y, v.z, 0.0f }
	{
	}
	explicit vec3a(IN(vec4) v)
	{
		memcpy(&this->v, &v, sizeof this->v);
	}
	vec3a(float x, float y, float z) : v{ x, y, z, 0.0f }
	{
	}
	inline explicit vec3a(struct ivec3a v);
};

struct ivec3a {
	typedef int32_t lanes __attribute__((vector_size(16)));
	lanes v;
	ivec3a() = default;
	explicit ivec3a(int all) : v{ all, all, all, all }
	{
	}
	explicit ivec3a(lanes v) : v(v)
	{
	}
	explicit ivec3a(vec3a f) : v(__builtin_convertvector(f.v, lanes))
	{
	}
};

inline vec3::vec3(vec3a v) : x(v.v[0]), y(v.v[1]), z(v.v[2])
{
}

inline ivec3::ivec3(ivec3a v) : x(v.v[0]), y(v.v[1]), z(v.v[2])
{
}

inline vec3a::vec3a(ivec3a v) : v(__builtin_convertvector(v.v, lanes))
{
}

inline vec3a operator+(vec3a a, vec3a b)
{
	return a.v + b.v;
}

inline vec3a operator+(vec3a a, float b)
{
	return a.v + b;
}

inline vec3a operator-(vec3a a, vec3a b)
{
	return a.v - b.v;
}

inline vec3a operator-(float a, vec3a b)
{
	return a - b.v;
}

inline vec3a operator*(vec3a a, vec3a b)
{
	return a.v * b.v;
}

inline vec3a operator*(vec3a a, float b)
{
	return a.v * b;
}

inline vec3a operator*(float a, vec3a b)
{
	return a * b.v;
}

inline vec3a operator/(vec3a a, float b)
{
	return a.v / b;
}

inline vec3a &operator+=(vec3a &a, vec3a b)
{
	return a = a + b;
}

inline ivec3a operator>>(ivec3a a, int bits)
{
	return ivec3a(a.v >> bits);
}

inline ivec3a operator&(ivec3a a, int bits)
{
	return ivec3a(a.v & bits);
}

inline ivec3a clamp(ivec3a v, ivec3a low, ivec3a high)
{
	ivec3a::lanes above = v.v > high.v, below = v.v < low.v;
	return ivec3a((v.v & ~above & ~below) | (high.v & above) | (low.v & below));
}

/* A vec4 in one register. */
struct vec4a {
	typedef float lanes __attribute__((vector_size(16)));
	lanes v;
	vec4a() = default;
	vec4a(lanes v) : v(v)
	{
	}
	explicit vec4a(float all) : v{ all, all, all, all }
	{
	}
	explicit vec4a(IN(vec4) v)
	{
		memcpy(&this->v, &v, sizeof this->v);
	}
	float operator[](int i) const
	{
		return v[i];
	}
};

inline vec4a operator-(vec4a a, float b)
{
	return a.v - b;
}

inline vec4a operator*(vec4a a, float b)
{
	return a.v * b;
}

inline vec4a operator+(vec4a a, vec4a b)
{
	return a.v + b.v;
}

inline vec4a operator*(vec4a a, vec4a b)
{
	return a.v * b.v;
}

inline vec4a operator/(vec4a a, vec4a b)
{
	return a.v / b.v;
}

inline vec4a min(vec4a a, vec4a b)
{
	return a.v < b.v ? a.v : b.v;
}

inline vec4a max(vec4a a, vec4a b)
{
	return a.v > b.v ? a.v : b.v;
}

/* ----------------------------------------------------------------------------------- functions */

inline float min(float a, float b)
{
	return a < b ? a : b;
}

inline float max(float a, float b)
{
	return a > b ? a : b;
}

inline int min(int a, int b)
{
	return a < b ? a : b;
}

inline int max(int a, int b)
{
	return a > b ? a : b;
}

inline uint min(uint a, uint b)
{
	return a < b ? a : b;
}

inline uint max(uint a, uint b)
{
	return a > b ? a : b;
}

inline vec3 min(vec3 a, vec3 b)
{
	return vec3(min(a.x, b.x), min(a.y, b.y), min(a.z, b.z));
}

inline vec3 max(vec3 a, vec3 b)
{
	return vec3(max(a.x, b.x), max(a.y, b.y), max(a.z, b.z));
}

inline float clamp(float v, float low, float high)
{
	return min(max(v, low), high);
}

inline float abs(float v)
{
	return fabsf(v);
}

inline float sqrt(float v)
{
	return sqrtf(v);
}

inline float inversesqrt(float v)
{
	return 1.0f / sqrtf(v);
}

inline float floor(float v)
{
	return floorf(v);
}

inline vec3 floor(vec3 v)
{
	return vec3(floorf(v.x), floorf(v.y), floorf(v.z));
}

inline float fract(float v)
{
	return v - floorf(v);
}

inline vec2 fract(vec2 v)
{
	return vec2(fract(v.x), fract(v.y));
}

inline float ceil(float v)
{
	return ceilf(v);
}

inline float exp2(float v)
{
	return exp2f(v);
}

inline float log2(float v)
{
	return log2f(v);
}

inline float sin(float v)
{
	return sinf(v);
}

inline float cos(float v)
{
	return cosf(v);
}

inline float acos(float v)
{
	return acosf(v);
}

inline float mix(float a, float b, float share)
{
	return a * (1.0f - share) + b * share;
}

inline vec3 mix(vec3 a, vec3 b, float share)
{
	return a * (1.0f - share) + b * share;
}

inline vec4 mix(vec4 a, vec4 b, float share)
{
	return a * (1.0f - share) + b * share;
}

inline float atan(float y, float x)
{
	return atan2f(y, x);
}

inline float dot(vec2 a, vec2 b)
{
	return a.x * b.x + a.y * b.y;
}

inline float dot(vec3 a, vec3 b)
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}

inline vec3 cross(vec3 a, vec3 b)
{
	return vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

inline float length(vec3 v)
{
	return sqrtf(dot(v, v));
}

inline vec3 normalize(vec3 v)
{
	return v * inversesqrt(dot(v, v));
}

inline int bitCount(uint v)
{
	/* Not by the compiler's, which is a call, since not every x86 counts bits. */
	v -= v >> 1 & 0x55555555u;
	v = (v & 0x33333333u) + (v >> 2 & 0x33333333u);
	return (int)(((v + (v >> 4)) & 0x0f0f0f0fu) * 0x01010101u >> 24);
}

inline uint bitfieldReverse(uint v)
{
	v = (v >> 1 & 0x55555555u) | (v & 0x55555555u) << 1;
	v = (v >> 2 & 0x33333333u) | (v & 0x33333333u) << 2;
	v = (v >> 4 & 0x0f0f0f0fu) | (v & 0x0f0f0f0fu) << 4;
	return __builtin_bswap32(v);
}

inline uint floatBitsToUint(float v)
{
	uint bits;
	memcpy(&bits, &v, sizeof bits);
	return bits;
}

inline float uintBitsToFloat(uint bits)
{
	float v;
	memcpy(&v, &bits, sizeof v);
	return v;
}

inline vec3 uintBitsToFloat(uvec3 bits)
{
	return vec3(uintBitsToFloat(bits.x), uintBitsToFloat(bits.y), uintBitsToFloat(bits.z));
}

inline vec4 uintBitsToFloat(IN(uvec4) bits)
{
	vec4 v;
	memcpy(&v, &bits, sizeof v);
	return v;
}

/* --------------------------------------------------------------------------------- texel buffers
 */

template <class Texel> struct texels {
	const Texel *at;
	explicit texels(const void *bytes) : at(static_cast<const Texel *>(bytes))
	{
	}
};

inline vec4 texelFetch(texels<vec4> buffer, int i)
{
	return buffer.at[(uint)i];
}

inline vec4 texelFetch(texels<float> buffer, int i)
{
	return vec4(buffer.at[(uint)i], 0.0f, 0.0f, 1.0f);
}

inline uvec4 texelFetch(texels<uvec4> buffer, int i)
{
	return buffer.at[(uint)i];
}

inline uvec4 texelFetch(texels<uvec2> buffer, int i)
{
	return uvec4(buffer.at[(uint)i].x, buffer.at[(uint)i].y, 0u, 1u);
}

inline uvec4 texelFetch(texels<uint> buffer, int i)
{
	return uvec4(buffer.at[(uint)i], 0u, 0u, 1u);
}

} // namespace glsl

using glsl::vec4;

#endif

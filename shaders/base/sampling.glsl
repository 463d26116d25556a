/*
 * sampling.glsl - random numbers, directions and frames.
 */
#ifndef SAMPLING_GLSL
#define SAMPLING_GLSL

const float PI = 3.14159265358979;

/* PCG hash (Jarzynski and Olano 2020): one well-mixed word from one word. */
uint hash(uint v)
{
	uint state = v * 747796405u + 2891336453u;
	uint word = ((state >> ((state >> 28) + 4u)) ^ state) * 277803737u;
	return (word >> 22) ^ word;
}

uint hash2(uint a, uint b)
{
	return hash(a ^ hash(b + 0x9e3779b9u));
}

/* A word for a place: what is random there then does not depend on what else is in the scene. */
uint hash_place(vec3 g)
{
	uvec3 bits = floatBitsToUint(g);
	return hash2(bits.x, hash2(bits.y, bits.z));
}

/* [0, 1), from the upper 24 bits. */
float unit_float(uint word)
{
	return float(word >> 8) * (1.0 / 16777216.0);
}

/* Tangents of a unit normal; the same formula as gw_tangent_frame in lib/ (Duff et al. 2017). */
void tangent_frame(vec3 n, out vec3 t, out vec3 b)
{
	float s = n.z >= 0.0 ? 1.0 : -1.0;
	float a = -1.0 / (s + n.z);
	float c = n.x * n.y * a;
	t = vec3(1.0 + s * n.x * n.x * a, s * c, -s * n.x);
	b = vec3(c, s + n.y * n.y * a, -n.y);
}

/* The i-th of n points that share the unit disc evenly: rings of a golden-angle spiral. u in [0, 1)
 * moves the point within its ring, turn rotates all of them. */
vec2 spiral_disc(uint i, uint n, float u, float turn)
{
	float r = sqrt((float(i) + u) / float(n));
	float phi = 2.0 * PI * fract(float(i) * 0.618033988749895 + turn);
	return r * vec2(cos(phi), sin(phi));
}

/* Direction about n whose projection on the surface is the disc point: cosine-weighted. */
vec3 disc_to_hemisphere(vec2 p, vec3 n, out float cosine)
{
	vec3 t, b;
	tangent_frame(n, t, b);
	cosine = sqrt(max(0.0, 1.0 - dot(p, p)));
	return normalize(t * p.x + b * p.y + n * cosine);
}

float luminance(vec3 c)
{
	return dot(c, vec3(0.2126, 0.7152, 0.0722));
}

#endif

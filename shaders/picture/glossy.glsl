/*
 * glossy.glsl - light that a glossy surface reflects towards the eye: which way, and how much.
 *
 * A surface is a rough dielectric or metal over a diffuse one. Its microfacets are GGX with
 * alpha = roughness^2; those that the eye sees are drawn by the method of Dupuy and Benyoub 2023.
 * Each reflects the Fresnel share F (Schlick's, of the reflectance at normal incidence), and the
 * rest goes into the diffuse surface below, so that the two never add up to more than 1. What a
 * facet throws into the surface is taken to leave it again, mirrored at the surface, not lost.
 */
#ifndef GLOSSY_GLSL
#define GLOSSY_GLSL

#include "base/sampling.glsl"

/* Below this alpha, all facets lie within the surface: a mirror. */
#define MIRROR_ALPHA 1e-3f

/* Cosine below which the eye counts as grazing. */
#define GRAZING 1e-3f

float fresnel(float reflectance, float cosine)
{
	float c = 1.0f - clamp(cosine, 0.0f, 1.0f);
	float c2 = c * c;
	return reflectance + (1.0f - reflectance) * c2 * c2 * c;
}

/* A facet's normal. All in the surface's frame, whose z is the normal; u in [0, 1)^2. */
vec3 visible_facet(vec3 eye, float alpha, vec2 u)
{
	vec3 stretched = normalize(vec3(alpha * eye.x, alpha * eye.y, eye.z));
	float phi = 2.0f * GW_PI * u.x;
	float z = (1.0f - u.y) * (1.0f + stretched.z) - stretched.z;
	float s = sqrt(max(0.0f, 1.0f - z * z));
	vec3 h = vec3(s * cos(phi), s * sin(phi), z) + stretched;
	return normalize(vec3(alpha * h.x, alpha * h.y, max(h.z, 1e-6f)));
}

/* How densely these facets throw the light's directions, a steradian; z: of the facet's normal. */
float facet_density(vec3 eye, float alpha, float z)
{
	float a2 = alpha * alpha, spread = z * z * (a2 - 1.0f) + 1.0f;
	float seen = eye.z + sqrt(a2 + (1.0f - a2) * eye.z * eye.z);
	return a2 / (GW_PI * spread * spread * 2.0f * seen);
}

/* Where a facet throws light from, mirrored at the surface if that is below. */
vec3 thrown_by(vec3 eye, vec3 facet)
{
	vec3 light = facet * (2.0f * dot(eye, facet)) - eye;
	light.z = max(abs(light.z), GRAZING);
	return normalize(light);
}

/* Normals that turn away from the eye by up to the arc sine of this are those of a rim, rough in
 * the blended normals; by more, those of a surface seen from behind. */
#define RIM 0.4f

/* The surface's normal on the eye's side, and not quite edge-on. */
vec3 face_eye(vec3 normal, vec3 to_eye)
{
	vec3 n = dot(normal, to_eye) < -RIM ? -normal : normal;
	float cosine = dot(n, to_eye);
	return cosine < GRAZING ? normalize(n + to_eye * (GRAZING - cosine)) : n;
}

/* The k-th direction that light comes from; share: how much of it is reflected. */
vec3 reflected_direction(vec3 normal, vec3 to_eye, float roughness, float reflectance, vec2 u,
						 OUT(float) share)
{
	float alpha = roughness * roughness;
	vec3 t, b;
	tangent_frame(normal, t, b);
	vec3 eye = vec3(dot(t, to_eye), dot(b, to_eye), dot(normal, to_eye));
	vec3 facet = alpha < MIRROR_ALPHA ? vec3(0.0f, 0.0f, 1.0f) : visible_facet(eye, alpha, u);
	float cosine = dot(eye, facet);
	vec3 light = facet * (2.0f * cosine) - eye;
	light.z = max(abs(light.z), GRAZING);
	share = fresnel(reflectance, cosine);
	return normalize(t * light.x + b * light.y + normal * light.z);
}

/* Share of the light reflected from which on a pixel takes all its rays, and the fewest that a
 * rough one takes. */
#define STRONG_GLOSS 0.3f
#define LEAST_GLOSS_RAYS 8u

/* Rays that a pixel takes, of so many at most: what is hardly reflected may be noisy, as the rest
 * of the light hides it. */
uint gloss_rays(float roughness, float share, uint most)
{
	if (roughness * roughness < MIRROR_ALPHA)
		return 1u;
	float part = min(1.0f, share / STRONG_GLOSS);
	uint least = min(most, LEAST_GLOSS_RAYS);
	return clamp(uint(ceil(part * float(most))), least, most);
}

/* Where in the unit square the k-th of them lies, of the pixel with this word. Multiples of the
 * powers of the plastic number fill the square evenly (Roberts 2018). */
vec2 gloss_place(uint own, uint k)
{
	vec2 turn = vec2(unit_float(own), unit_float(pcg_hash(own)));
	return fract(turn + float(k) * vec2(0.7548776662f, 0.5698402910f));
}

#endif

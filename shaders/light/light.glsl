/*
 * light.glsl - what a light other than the sky sends to a place, without shadow. Uses `push`, a
 * gw_light_push, and `distribution` of a light that has one.
 */
#ifndef LIGHT_GLSL
#define LIGHT_GLSL

#include "octree/ray.glsl"
#include "base/sampling.glsl"
#include "base/distribution.glsl"
#include "light/transport_layout.h"
#include "light/area_light.glsl"

/* Share of its power that the light sends towards a place, where it is from there, and how far in
 * leaf cells. Spot lights fall off by smoothstep in the cosine. */
float light_share(vec3 g, OUT(vec3) towards, OUT(float) distance)
{
	if (push.type == GW_PUSH_SUN) {
		towards = -push.direction.xyz;
		distance = GW_FAR;
		return 1.0f;
	}
	vec3 to = push.position.xyz - g;
	float squared = dot(to, to), inner = push.cos_inner, outer = push.cos_outer;
	/* Nearer than the light's own radius, or on the light itself, the distance stops falling. */
	distance = sqrt(max(squared, max(push.position.w * push.position.w, 1e-12f)));
	towards = to * (squared > 0.0f ? 1.0f / sqrt(squared) : 0.0f);
	if (push.verticals > 0u && squared > 0.0f) {
		vec3 axis = push.direction.xyz, across = push.across.xyz;
		vec3 up = cross(across, axis), way = towards * -1.0f;
		return distribution_share(push.verticals, push.horizontals,
								  vec3(dot(way, across), dot(way, up), dot(way, axis)));
	}
	if (push.type != GW_PUSH_SPOT)
		return 1.0f;
	float cosine = -dot(towards, push.direction.xyz);
	if (!(inner > outer))
		return cosine >= outer ? 1.0f : 0.0f;
	float x = clamp((cosine - outer) / (inner - outer), 0.0f, 1.0f);
	return x * x * (3.0f - 2.0f * x);
}

/* Cosine at which light comes in; a surfel whose normal is not trusted (w = 1) is lit from both
 * sides. */
float light_cosine(vec4 normal, vec3 towards)
{
	float cosine = dot(normal.xyz, towards);
	return normal.w > 0.5f ? abs(cosine) : max(cosine, 0.0f);
}

/* Irradiance at a place over the light's power, its intensity or irradiance; where the light is
 * from there, or its middle, and how far in leaf cells. */
float light_received(vec3 g, vec4 normal, OUT(vec3) towards, OUT(float) distance)
{
	float share = light_share(g, towards, distance);
	if (is_area_light())
		return area_received(g, normal);
	float e = share * light_cosine(normal, towards);
	return push.type == GW_PUSH_SUN ? e : e / (distance * distance);
}

/* Aims the s-th ray, of push.samples, at a place of the disc that the light shows, whose middle is
 * `towards` at that distance; `turn` is by how much the places are turned, in turns. */
void aim_at_light(uint s, float turn, vec3 towards, float distance, INOUT(Ray) ray)
{
	vec2 p = vec2(0.0f, 0.0f);
	vec3 t, b;
	bool sun = push.type == GW_PUSH_SUN;
	tangent_frame(towards, t, b);
	if (push.samples > 1u)
		p = spiral_disc(s, push.samples, 0.5f, turn) * (sun ? push.direction.w : push.position.w);
	vec3 to = t * p.x + b * p.y + towards * (sun ? 1.0f : distance);
	ray.direction = normalize(to);
	ray.t_max = sun ? GW_FAR : length(to);
}

#endif

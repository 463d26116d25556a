/*
 * light.glsl - what a point, spot or sun light sends to a place, without shadow. Uses `push`, a
 * gw_light_push.
 */
#ifndef LIGHT_GLSL
#define LIGHT_GLSL

/* Irradiance on a plane that faces the light, at grid position g; also the unit direction towards
 * the light and the distance to it in leaf cells. Spot lights fall off by smoothstep in the cosine.
 */
float light_irradiance(vec3 g, out vec3 towards, out float distance)
{
	if (push.type == GW_PUSH_SUN) {
		towards = -push.direction.xyz;
		distance = 1e9;
		return 1.0;
	}
	vec3 to = push.position.xyz - g;
	float squared = dot(to, to);
	/* Nearer than the light's own radius, or on the light itself, the distance stops falling. */
	float nearest = max(push.position.w * push.position.w, 1e-12);
	distance = sqrt(max(squared, nearest));
	towards = squared > 0.0 ? to * inversesqrt(squared) : vec3(0.0);
	float share = 1.0;
	if (push.type == GW_PUSH_SPOT) {
		float cosine = -dot(towards, push.direction.xyz);
		float x =
			push.cos_inner > push.cos_outer
				? clamp((cosine - push.cos_outer) / (push.cos_inner - push.cos_outer), 0.0, 1.0)
				: (cosine >= push.cos_outer ? 1.0 : 0.0);
		share = x * x * (3.0 - 2.0 * x);
	}
	return share / max(squared, nearest);
}

/* That irradiance on the surface; a surfel whose normal is not trusted (w = 1) is lit from both
 * sides. */
float light_cosine(vec3 g, vec4 normal, float facing, vec3 towards)
{
	float cosine = dot(normal.xyz, towards);
	return facing * (normal.w > 0.5 ? abs(cosine) : max(cosine, 0.0));
}

#endif

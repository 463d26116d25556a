/*
 * shadow_ray.glsl - where a texel of a shadow map looks. Uses `push`, a gw_shadow_push.
 */
#ifndef SHADOW_RAY_GLSL
#define SHADOW_RAY_GLSL

/* The ray through a point of the window, in texels; its direction is of length 1 or more. */
void shadow_ray(vec2 texel, out vec3 origin, out vec3 direction)
{
	vec2 p = (texel - vec2(push.centre_x, push.centre_y)) / push.right.w;
	vec3 across = push.right.xyz * p.x + push.up.xyz * p.y;
	bool sun = push.origin.w > 0.5;
	origin = sun ? push.origin.xyz + across : push.origin.xyz;
	direction = sun ? push.forward.xyz : push.forward.xyz + across;
}

/* Coordinates of a place along right, up and forward. */
vec3 shadow_place(vec3 g)
{
	vec3 p = g - push.origin.xyz;
	return vec3(dot(push.right.xyz, p), dot(push.up.xyz, p), dot(push.forward.xyz, p));
}

/* Where such a place lies in the window, in texels; its third coordinate is above 0. */
vec2 shadow_texel(vec3 place)
{
	float along = push.origin.w > 0.5 ? 1.0 : place.z;
	return place.xy / along * push.right.w + vec2(push.centre_x, push.centre_y);
}

#endif

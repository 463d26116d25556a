/*
 * pixel_cone.comp - the glossy bounce by one cone a pixel, as in Salm 4.6: along the mirrored ray,
 * as wide as the roughness says. rgb is the light reflected, w the share of all light that is.
 */
#version 460

#include "octree/octree_walk.glsl"
#include "light/transport_layout.h"
#include "picture/glossy.glsl"

layout(local_size_x_id = 0) in;
layout(binding = 0) uniform usamplerBuffer level_directory;
layout(binding = 1) uniform usamplerBuffer node;
layout(binding = 2) uniform sampler3D leaf_pool;
layout(binding = 3) uniform sampler3D mip_pool;
layout(binding = 4) readonly buffer Position
{
	vec4 pixel_position[]; /* grid coordinates, roughness */
};
layout(binding = 5) readonly buffer Normal
{
	vec4 pixel_normal[]; /* unit, reflectance */
};
layout(binding = 6) writeonly buffer Reflected
{
	vec4 pixel_reflected[];
};
layout(binding = 7) uniform samplerBuffer sky_texel;
layout(push_constant) uniform Push
{
	gw_cone_push push; /* eye: where the eye is */
};

#include "light/brick_cones.glsl"
#include "picture/sky_seen.glsl"

/* Directions that the sky is looked up in, of a rough pixel. */
const uint SKY_LOOKS = 32u;

/* What of the sky a pixel reflects: of its rough surface the mean over all that it mirrors. */
vec3 reflected_sky(vec3 normal, vec3 to_eye, float roughness, float reflectance)
{
	uint looks = push.sky_width == 0u || roughness * roughness < MIRROR_ALPHA ? 1u : SKY_LOOKS;
	vec3 sum = vec3(0.0);
	float shares = 0.0;
	for (uint k = 0u; k < looks; k++) {
		/* As in pixel_rays.comp; the middle of the first keeps mirrors where they are. */
		vec2 u = fract(vec2(0.5) + float(k) * vec2(0.7548776662, 0.5698402910));
		float share;
		vec3 way = reflected_direction(normal, to_eye, roughness, reflectance, u, share);
		sum += share * sky_seen(way);
		shares += share;
	}
	return sum / max(shares, 1e-6);
}

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	vec3 g = pixel_position[i].xyz;
	float roughness = pixel_position[i].w, reflectance = pixel_normal[i].w, share;
	vec3 to_eye = normalize(push.eye.xyz - g);
	vec3 normal = face_eye(pixel_normal[i].xyz, to_eye);
	vec3 direction = reflected_direction(normal, to_eye, 0.0, reflectance, vec2(0.0), share);
	/* Half of what GGX reflects of a ray that meets it squarely leaves within twice the angle whose
	 * tangent is alpha; a cone with the cross-section of all of it. */
	float tangent = min(roughness * roughness, 1.0);
	float open;
	vec3 seen = trace_cone(g + normal, direction, tangent, open);
	if (open > 0.0)
		seen += open * reflected_sky(normal, to_eye, roughness, reflectance);
	pixel_reflected[i] = share * vec4(seen, 1.0);
}

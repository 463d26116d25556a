/*
 * pixel_rays.comp - the glossy bounce by rays: one invocation a pixel. Rays go against the planes
 * in the leaves; where one meets a plane, the radiance is that of the discs there, blended as in
 * the picture itself, so that a mirror shows the surface as sharp as the eye sees it. rgb is the
 * light reflected, w the share of all light that is. One run adds one ray, because all loops of an
 * invocation count together towards what the software driver allows.
 */
#version 460

#include "light/transport_layout.h"
#include "octree/octree_walk.glsl"
#include "picture/glossy.glsl"

layout(local_size_x_id = 0) in;
layout(binding = 0) uniform usamplerBuffer ray_directory;
layout(binding = 1) uniform usamplerBuffer node;
layout(binding = 2) uniform usamplerBuffer leaf_tile;
layout(binding = 3) uniform samplerBuffer facet_plane;
layout(binding = 4) uniform samplerBuffer facet_centre;
layout(binding = 5) uniform usamplerBuffer leaf_fragment;
layout(binding = 6) uniform usamplerBuffer fragment_surfel;
layout(binding = 7) uniform samplerBuffer surfel_place;
layout(binding = 8) uniform samplerBuffer surfel_facing;
layout(binding = 9) uniform samplerBuffer surfel_disc;
layout(binding = 10) uniform samplerBuffer surfel_clip;
layout(binding = 11) uniform samplerBuffer surfel_radiance;
layout(binding = 12) readonly buffer Position
{
	vec4 pixel_position[]; /* grid coordinates, roughness */
};
layout(binding = 13) readonly buffer Normal
{
	vec4 pixel_normal[]; /* unit, reflectance */
};
layout(binding = 14) buffer Reflected
{
	vec4 pixel_reflected[];
};
layout(binding = 15) uniform usamplerBuffer disc_tree;
layout(binding = 16) uniform samplerBuffer sky_texel;
layout(binding = 17) uniform samplerBuffer facet_albedo;
layout(binding = 18) readonly buffer FacetLeaf
{
	uint facet_leaf[];
};
layout(push_constant) uniform Push
{
	gw_pixel_push push;
};

#define TRACE_OPACITY
#include "octree/octree_discs.glsl"
#include "octree/trace.glsl"
#include "picture/disc_light.glsl"
#include "picture/sky_seen.glsl"

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	vec3 g = pixel_position[i].xyz;
	float roughness = pixel_position[i].w, reflectance = pixel_normal[i].w;
	vec3 to_eye = normalize(push.eye.xyz - g);
	vec3 normal = face_eye(pixel_normal[i].xyz, to_eye);
	uint own = pcg_hash2(push.pixel_first + push.first + i, push.seed);
	uint rays = gloss_rays(roughness, fresnel(reflectance, dot(normal, to_eye)), push.rays);
	if (push.ray >= rays)
		return;
	float share;
	vec3 direction = reflected_direction(normal, to_eye, roughness, reflectance,
										 gloss_place(own, push.ray), share);
	Ray ray = { g, direction, normal, g, GW_FAR, false };
	float through, chance = stratified(pcg_hash2(own, GW_OPACITY_SEED), push.ray);
	Hit hit = trace_through(ray, chance, through);
	vec3 seen =
		hit.facet != GW_NONE ? radiance_at(hit.facet, g + direction * hit.t) : sky_seen(direction);
	vec4 before = push.ray > 0u ? pixel_reflected[i] : vec4(0.0);
	pixel_reflected[i] = before + share * vec4(seen, 1.0) / float(rays);
}

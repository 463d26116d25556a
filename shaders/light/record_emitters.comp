/*
 * record_emitters.comp - irradiance of the records from emitters, by points sampled on them.
 *
 * An emitter is chosen by its power (alias table), a point on the disc of its area; the sample is
 * combined with the gather rays by the balance heuristic (Veach): weight M p_area / (M p_area + K
 * p_ray), both as densities of solid angle. One invocation takes a batch of a record's samples.
 */
#version 460

#include "octree/octree_walk.glsl"
#include "light/transport_layout.h"
#include "base/sampling.glsl"

layout(local_size_x_id = 0) in;
layout(binding = 0) uniform usamplerBuffer ray_directory;
layout(binding = 1) uniform usamplerBuffer node;
layout(binding = 2) uniform usamplerBuffer leaf_tile;
layout(binding = 3) uniform samplerBuffer lobe_plane;
layout(binding = 4) uniform samplerBuffer lobe_centre;
layout(binding = 5) uniform samplerBuffer lobe_emission;
layout(binding = 6) uniform usamplerBuffer emitter; /* lobe, alias, probability (float bits), 0 */
layout(binding = 7) readonly buffer Position
{
	vec4 record_position[];
};
layout(binding = 8) readonly buffer Normal
{
	vec4 record_normal[];
};
layout(binding = 9) buffer Sum
{
	vec4 record_sampled[];
};
layout(binding = 10) uniform samplerBuffer lobe_part; /* of lobe_emission: what is gathered */
layout(binding = 11) uniform usamplerBuffer leaf_fragment;
layout(binding = 12) uniform usamplerBuffer fragment_surfel;
layout(binding = 13) uniform samplerBuffer surfel_place;
layout(binding = 14) uniform samplerBuffer surfel_facing;
layout(binding = 15) uniform samplerBuffer surfel_disc;
layout(binding = 16) uniform samplerBuffer surfel_clip;
layout(binding = 17) uniform usamplerBuffer disc_tree;
layout(push_constant) uniform Push
{
	gw_record_push push;
};

#include "octree/octree_discs.glsl"
#include "octree/octree_trace.glsl"
#include "octree/disc_tree.glsl"

/* Sample m of push.light_samples. The emitters lie in Morton order, so that a stretch of the table
 * for each sample spreads the samples over them. */
vec3 sample_emitter(vec3 g, vec3 normal, uint m, uint random)
{
	float choice =
		(float(m) + unit_float(random)) / float(push.light_samples) * float(push.emitters);
	uint entry = min(uint(choice), push.emitters - 1u);
	uvec4 row = texelFetch(emitter, int(entry));
	if (choice - float(entry) >= uintBitsToFloat(row.z))
		row = texelFetch(emitter, int(row.y));
	int lobe = int(row.x);
	vec4 plane = texelFetch(lobe_plane, lobe);
	vec4 centre = texelFetch(lobe_centre, lobe);
	vec3 emission = texelFetch(lobe_emission, lobe).xyz;

	vec3 t, b;
	tangent_frame(plane.xyz, t, b);
	float u = unit_float(hash2(random, 1u)), v = unit_float(hash2(random, 2u));
	vec2 p = sqrt(u * centre.w / PI) * vec2(cos(2.0 * PI * v), sin(2.0 * PI * v));
	vec3 to = centre.xyz + t * p.x + b * p.y - g;
	float squared = dot(to, to);
	vec3 direction = to * inversesqrt(max(squared, 1e-12));
	float cosine = dot(normal, direction);
	float cosine_emitter = -dot(plane.xyz, direction);
	if (cosine <= 0.0 || cosine_emitter <= 1e-4 || squared < 1e-8)
		return vec3(0.0);

	/* The emitter's own plane, or one within a cell of the point, does not shadow it; of a large
	 * one, what lies within its extent. */
	float extent = centre.w > GW_LOBE_LARGE ? sqrt(centre.w / PI) : 1.0;
	uint seen;
	float t_hit;
	bool behind;
	float distance = sqrt(squared);
	if (trace(g, tangent_plane_at(g, normal), direction, distance - extent, false, seen,
			  t_hit, behind) &&
		seen != uint(lobe))
		return vec3(0.0);

	float density = luminance(emission) / push.emitter_power * squared / cosine_emitter;
	float by_samples = float(push.light_samples) * density;
	float by_rays = push.use_hits != 0u ? float(push.rays) * cosine / PI : 0.0;
	return texelFetch(lobe_part, lobe).xyz * (cosine / density) *
		   (by_samples / (by_samples + by_rays));
}

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	vec3 g = record_position[i].xyz;
	vec3 normal = record_normal[i].xyz;
	uint own = hash2(hash_place(g), push.seed ^ GW_EMITTER_SEED);
	vec3 sum = vec3(0.0);
	for (uint m = 0u; m < push.batch_count; m++)
		sum += sample_emitter(g, normal, push.batch_first + m, hash2(own, push.batch_first + m));
	record_sampled[i].xyz += sum / float(push.light_samples);
}

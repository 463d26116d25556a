/*
 * record_emitters.comp - irradiance of the records from emitters, by points sampled on them.
 *
 * An emitter is chosen by its power (alias table), a point on the disc of its area; the sample is
 * combined with the gather rays by the balance heuristic (Veach): weight M p_area / (M p_area + K
 * p_ray), both as densities of solid angle. One invocation takes a batch of a record's samples.
 */
#include "light/transport_layout.h"
#include "octree/octree_walk.glsl"

TEXELS(0, uint, ray_directory);
TEXELS(1, uint, node);
TEXELS(2, uvec2, leaf_tile);
TEXELS(3, vec4, facet_plane);
TEXELS(4, vec4, facet_centre);
TEXELS(5, vec4, facet_emission);
TEXELS(6, uvec4, emitter); /* facet, alias, probability (float bits), mark of its compartment */
BUFFER(7, readonly, vec4, record_position);
BUFFER(8, readonly, vec4, record_normal);
BUFFER(9, readwrite, vec4, record_sampled); /* w: mark of the record's compartment */
TEXELS(10, vec4, facet_part); /* of facet_emission: what is gathered */
TEXELS(11, uint, leaf_fragment);
TEXELS(12, uint, fragment_surfel);
TEXELS(13, vec4, surfel_place);
TEXELS(14, vec4, surfel_facing);
TEXELS(15, vec4, surfel_disc);
TEXELS(16, vec4, surfel_clip);
TEXELS(17, uvec4, disc_tree);
TEXELS(18, vec4, facet_albedo);
BUFFER(19, readwrite, vec4, record_moment); /* 2 a record */
BUFFER(20, readonly, uint, facet_leaf);
PUSH(gw_record_push);

#define TRACE_OPACITY
#include "octree/octree_discs.glsl"
#include "octree/trace.glsl"
#include "light/record_moment.glsl"

/* Facets that a sample finds less densely have no light to speak of beside the others, and numbers
 * that nothing can be divided by. */
#define DENSITY_LEAST 1e-30f

/* The row of the facet that sample m of push.light_samples stands for. The emitters lie in Morton
 * order, so that a stretch of the table for each sample spreads the samples over them. */
uvec4 choose_emitter(uint m, uint random)
{
	float choice =
		(float(m) + unit_float(random)) / float(push.light_samples) * float(push.emitters);
	uint entry = min(uint(choice), push.emitters - 1u);
	uvec4 row = texelFetch(emitter, int(entry));
	if (choice - float(entry) >= uintBitsToFloat(row.z))
		row = texelFetch(emitter, int(row.y));
	return row;
}

/* What rock keeps apart from the record is not asked: rays find the way through it at times. */
bool is_apart(uint mark, uint other)
{
	return mark != other && mark != 0u && other != 0u;
}

/* What sample m brings, and from where. */
vec3 sample_emitter(vec3 g, vec3 normal, uint mark, uint m, uint random, OUT(vec3) direction)
{
	direction = normal;
	uvec4 row = choose_emitter(m, random);
	int facet = int(row.x);
	if (is_apart(mark, row.w))
		return vec3(0.0f);
	vec4 centre = texelFetch(facet_centre, facet);
	vec3 plane = texelFetch(facet_plane, facet).xyz, t, b;
	tangent_frame(plane, t, b);
	float radius = sqrt(unit_float(pcg_hash2(random, 1u)) * centre.w / GW_PI);
	float turn = 2.0f * GW_PI * unit_float(pcg_hash2(random, 2u));
	vec3 to = t * (radius * cos(turn)) + b * (radius * sin(turn)) + (centre.xyz - g);
	float squared = dot(to, to);
	direction = to * inversesqrt(max(squared, 1e-12f));
	float cosine = dot(normal, direction), cosine_emitter = -dot(plane, direction);
	if (cosine <= 0.0f || cosine_emitter <= 1e-4f || squared < 1e-8f)
		return vec3(0.0f);
	/* The emitter's own plane, or one within a cell of the point, does not shadow it; of a large
	 * one, what lies within its extent. */
	float extent = centre.w > GW_FACET_LARGE ? sqrt(centre.w / GW_PI) : 1.0f;
	Ray ray = { g, direction, normal, g, sqrt(squared) - extent, false };
	float through;
	uint seen = trace_through(ray, GW_THROUGH_LEAST, through).facet;
	if (seen != GW_NONE && seen != uint(facet))
		return vec3(0.0f);
	float emission = luminance(texelFetch(facet_emission, facet).xyz);
	float density = emission / push.emitter_power * squared / cosine_emitter;
	if (density < DENSITY_LEAST)
		return vec3(0.0f);
	float by_samples = float(push.light_samples) * density;
	float by_rays = push.use_hits != 0u ? float(push.rays) * cosine / GW_PI : 0.0f;
	return texelFetch(facet_part, facet).xyz *
		   (through * opacity_of(uint(facet)) * cosine / density *
			(by_samples / (by_samples + by_rays)));
}

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	vec3 g = record_position[i].xyz, normal = record_normal[i].xyz;
	vec3 sum = vec3(0.0f), first = vec3(0.0f), second = vec3(0.0f);
	uint own = pcg_hash2(pcg_hash_place(g), push.seed ^ GW_EMITTER_SEED);
	uint mark = uint(record_sampled[i].w);
	for (uint m = push.batch_first; m < push.batch_first + push.batch_count; m++) {
		vec3 direction;
		vec3 irradiance = sample_emitter(g, normal, mark, m, pcg_hash2(own, m), direction);
		sum += irradiance;
		if (push.moments == 0u)
			continue;
		vec2 share = moment_share_of(normal, direction);
		first += irradiance * share.x;
		second += irradiance * share.y;
	}
	record_sampled[i].xyz += sum / float(push.light_samples);
	if (push.moments != 0u) {
		record_moment[2u * i].xyz += first / float(push.light_samples);
		record_moment[2u * i + 1u].xyz += second / float(push.light_samples);
	}
}

/*
 * record_emitters.comp - irradiance of the records from emitters, by points sampled on them.
 *
 * An emitter is chosen by its power (alias table), a point on the disc of its area; the sample is
 * combined with the gather rays by the balance heuristic (Veach): weight M p_area / (M p_area + K
 * p_ray), both as densities of solid angle. One invocation takes a batch of a record's samples.
 *
 * Most of them, far away or seen at a flat angle, would bring next to nothing, and what takes the
 * time is to find out whether they are seen. So a sample is asked the less often the less it would
 * bring, and counts as many times as much (systematic sampling, Madow 1949).
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

/* Samples that bring so many times as much as the mean one are always asked. Of a Cornell box and a
 * cave of 100,000 points the best 99 % are as far off with 1 as where all are asked, to one part in
 * a hundred; with 2 a fiftieth farther, with 4 a twentieth. */
#define OFTEN 1.0f

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

/* A point on an emitter. */
struct Sample {
	uint facet;
	vec3 direction;  /* where it is */
	float reach;     /* where a ray to it ends, leaf cells */
	vec3 irradiance; /* that it brings if nothing is in between */
	float bright;    /* the same of all that is sent, whatever part of it is gathered */
};

/* Sample m; false where it brings nothing, whatever is in between. */
bool choose_sample(vec3 g, vec3 normal, uint mark, uint m, uint random, OUT(Sample) to)
{
	uvec4 row = choose_emitter(m, random);
	int facet = int(row.x);
	if (is_apart(mark, row.w))
		return false;
	vec4 centre = texelFetch(facet_centre, facet);
	vec3 plane = texelFetch(facet_plane, facet).xyz, t, b;
	tangent_frame(plane, t, b);
	float radius = sqrt(unit_float(pcg_hash2(random, 1u)) * centre.w / GW_PI);
	float turn = 2.0f * GW_PI * unit_float(pcg_hash2(random, 2u));
	vec3 off = t * (radius * cos(turn)) + b * (radius * sin(turn)) + (centre.xyz - g);
	float squared = dot(off, off);
	to.facet = row.x;
	to.direction = off * inversesqrt(max(squared, 1e-12f));
	float cosine = dot(normal, to.direction), cosine_emitter = -dot(plane, to.direction);
	if (cosine <= 0.0f || cosine_emitter <= 1e-4f || squared < 1e-8f)
		return false;
	float emission = luminance(texelFetch(facet_emission, facet).xyz);
	float density = emission / push.emitter_power * squared / cosine_emitter;
	if (density < DENSITY_LEAST)
		return false;
	/* The emitter's own plane, or one within a cell of the point, does not shadow it; of a large
	 * one, what lies within its extent. */
	to.reach = sqrt(squared) - (centre.w > GW_FACET_LARGE ? sqrt(centre.w / GW_PI) : 1.0f);
	float by_samples = float(push.light_samples) * density;
	float by_rays = push.use_hits != 0u ? float(push.rays) * cosine / GW_PI : 0.0f;
	float weight = opacity_of(row.x) * cosine / density * (by_samples / (by_samples + by_rays));
	to.irradiance = texelFetch(facet_part, facet).xyz * weight;
	to.bright = emission * weight;
	return true;
}

/* How much of what a sample sends gets to the record. */
float share_seen_of(vec3 g, vec3 normal, IN(Sample) from)
{
	Ray ray = { g, from.direction, normal, g, from.reach, false };
	float through;
	uint seen = trace_through(ray, GW_THROUGH_LEAST, through).facet;
	return seen == GW_NONE || seen == from.facet ? through : 0.0f;
}

/* What a record's samples bring. */
struct Brought {
	vec3 sum, first, second; /* irradiance, and its moments */
};

/* Adds so many samples from `from` on, at most GW_EMITTER_BATCH of them. */
void add_samples(vec3 g, vec3 normal, uint mark, uint from, uint count, INOUT(Brought) brought)
{
	uint own = pcg_hash2(pcg_hash_place(g), push.seed ^ GW_EMITTER_SEED);
	float bright[GW_EMITTER_BATCH], all = 0.0f;
	Sample to;
	for (uint k = 0u; k < count; k++) {
		bool brings = choose_sample(g, normal, mark, from + k, pcg_hash2(own, from + k), to);
		bright[k] = brings ? to.bright : 0.0f;
		all += bright[k];
	}
	/* What brings at least that is always asked. */
	float always = max(OFTEN * all / float(count), DENSITY_LEAST);
	float turn = unit_float(pcg_hash2(own, from ^ GW_ROULETTE_SEED));
	for (uint k = 0u; k < count; k++) {
		float often = min(bright[k] / always, 1.0f);
		turn += often;
		if (turn < 1.0f)
			continue;
		turn -= 1.0f;
		if (!choose_sample(g, normal, mark, from + k, pcg_hash2(own, from + k), to))
			continue;
		vec3 irradiance = to.irradiance * (share_seen_of(g, normal, to) / often);
		brought.sum += irradiance;
		if (push.moments == 0u)
			continue;
		vec2 share = moment_share_of(normal, to.direction);
		brought.first += irradiance * share.x;
		brought.second += irradiance * share.y;
	}
}

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	vec3 g = record_position[i].xyz, normal = record_normal[i].xyz;
	uint mark = uint(record_sampled[i].w), end = push.batch_first + push.batch_count;
	Brought brought = { vec3(0.0f), vec3(0.0f), vec3(0.0f) };
	for (uint from = push.batch_first; from < end; from += GW_EMITTER_BATCH)
		add_samples(g, normal, mark, from, min(end - from, GW_EMITTER_BATCH), brought);
	record_sampled[i].xyz += brought.sum / float(push.light_samples);
	if (push.moments != 0u) {
		record_moment[2u * i].xyz += brought.first / float(push.light_samples);
		record_moment[2u * i + 1u].xyz += brought.second / float(push.light_samples);
	}
}

/*
 * host_rays.c - see host_rays.h; what is done, and why, the shaders say.
 */
#include "light/host_rays.h"

#include "light/host_loop.h"
#include "light/host_trace.h"
#include "octree/trace_constants.h"
#include "light/transport_layout.h"

#define CHUNK_RAYS 4096u /* that a thread follows at a time */
#define FAR 1e9f         /* leaf cells */

/* --------------------------------------------------------------------------------- gather rays */

typedef struct gathering {
	gw_tracer tracer;
	const float *position, *normal;
	const uint32_t *list; /* NULL: all rays */
	uint32_t rays, seed;
	uint32_t *lobe;
	float *distance;
} gathering;

static void follow(const gathering *job, uint32_t number)
{
	size_t record = number / job->rays;
	gw_ray ray = { .origin = gw_xyz(job->position + 4 * record),
				   .facing = gw_xyz(job->normal + 4 * record),
				   .t_max = FAR,
				   .discs = true };
	ray.foot = ray.origin;
	ray.direction = gw_record_ray(ray.origin, ray.facing, number % job->rays, job->rays, job->seed);
	gw_ray_hit hit = gw_trace(&job->tracer, &ray);
	job->lobe[number] = hit.lobe;
	job->distance[number] = hit.behind ? -hit.t : hit.t;
}

static void follow_all(void *user, size_t first, size_t last, uint32_t worker)
{
	const gathering *job = user;
	(void)worker;
	for (size_t i = first; i < last; i++)
		follow(job, job->list ? job->list[i] : (uint32_t)i);
}

static gathering gathering_of(const gw_passes *passes, const gw_octree *octree,
							  const gw_records *records, gw_ray_gather *gather)
{
	return (gathering){ .tracer = gw_tracer_of(passes, octree),
						.position = records->position.mapped,
						.normal = records->normal.mapped,
						.rays = gather->rays,
						.seed = gather->seed,
						.lobe = gather->lobe.mapped,
						.distance = gather->distance.mapped };
}

void gw_host_record_rays(gw_passes *passes, const gw_octree *octree, const gw_records *records,
						 gw_ray_gather *gather)
{
	gathering job = gathering_of(passes, octree, records, gather);
	size_t count = (size_t)gather->rays * records->count;
	gw_host_loop(passes, GW_PASS_RECORD_RAYS, count, CHUNK_RAYS, follow_all, &job);
}

void gw_host_record_again(gw_passes *passes, const gw_octree *octree, const gw_records *records,
						  const gw_buffer *list, uint32_t count, gw_ray_gather *gather)
{
	gathering job = gathering_of(passes, octree, records, gather);
	job.list = (const uint32_t *)list->mapped + 1;
	gw_host_loop(passes, GW_PASS_RECORD_AGAIN, count, CHUNK_RAYS, follow_all, &job);
}

/* ------------------------------------------------------------------------------------- samples */

typedef struct sampling {
	gw_tracer tracer;
	gw_record_push push;
	const float *position, *normal;
	const uint32_t *table; /* alias table of the emitters, or of the map */
	const float *radiance; /* of lobes, or of texels */
	const float *part;     /* of the lobes' radiance: what is gathered */
	float *sampled;
} sampling;

/* One sample: its light, from the record at the ray's origin. */
typedef gw_vec3 sample(const sampling *job, gw_ray *ray, uint32_t m, uint32_t random);

/* The sum of the samples of a record, batch by batch as passes make it. */
static void sample_record(const sampling *job, size_t record, sample *take, uint32_t samples,
						  uint32_t seed)
{
	gw_ray ray = { .origin = gw_xyz(job->position + 4 * record),
				   .facing = gw_xyz(job->normal + 4 * record),
				   .discs = true };
	ray.foot = ray.origin;
	uint32_t own = gw_mix2(gw_mix_place(ray.origin), seed);
	float *total = job->sampled + 4 * record;
	gw_vec3 sum = { 0 };
	for (uint32_t m = 0; m < samples; m++)
		sum = gw_plus(sum, take(job, &ray, m, gw_mix2(own, m)));
	total[0] += sum.x / (float)samples;
	total[1] += sum.y / (float)samples;
	total[2] += sum.z / (float)samples;
}

/* The lobe that sample m stands for. */
static uint32_t choose_emitter(const sampling *job, uint32_t m, uint32_t random)
{
	const gw_record_push *push = &job->push;
	float choice =
		((float)m + gw_unit_float(random)) / (float)push->light_samples * (float)push->emitters;
	uint32_t entry = (uint32_t)choice;
	entry = entry < push->emitters - 1 ? entry : push->emitters - 1;
	const uint32_t *row = job->table + 4 * (size_t)entry;
	if (choice - (float)entry >= gw_float_of(row[2]))
		row = job->table + 4 * (size_t)row[1];
	return row[0];
}

static gw_vec3 sample_emitter(const sampling *job, gw_ray *ray, uint32_t m, uint32_t random)
{
	const gw_record_push *push = &job->push;
	const gw_vec3 none = { 0 };
	size_t lobe = choose_emitter(job, m, random);
	const float *centre = job->tracer.lobe_centre + 4 * lobe;
	gw_vec3 plane = gw_xyz(job->tracer.lobe_plane + 4 * lobe), t, b;
	gw_frame_of(plane, &t, &b);
	float radius = sqrtf(gw_unit_float(gw_mix2(random, 1)) * centre[3] / GW_PI);
	float turn = 2.0f * GW_PI * gw_unit_float(gw_mix2(random, 2));
	gw_vec3 to = gw_along(t, radius * cosf(turn), b, radius * sinf(turn),
						  gw_minus(gw_xyz(centre), ray->origin), 1.0f);
	float squared = gw_dot(to, to);
	ray->direction = gw_times(to, 1.0f / sqrtf(gw_larger(squared, 1e-12f)));
	float cosine = gw_dot(ray->facing, ray->direction);
	float cosine_emitter = -gw_dot(plane, ray->direction);
	if (cosine <= 0.0f || cosine_emitter <= 1e-4f || squared < 1e-8f)
		return none;
	/* The emitter's own plane, or one within a cell of the point, does not shadow it; of a large
	 * one, what lies within its extent. */
	float extent = centre[3] > GW_LOBE_LARGE ? sqrtf(centre[3] / GW_PI) : 1.0f;
	ray->t_max = sqrtf(squared) - extent;
	uint32_t seen = gw_trace(&job->tracer, ray).lobe;
	if (seen != GW_NONE && seen != lobe)
		return none;
	float density = gw_luminance_of(gw_xyz(job->radiance + 4 * lobe)) / push->emitter_power *
					squared / cosine_emitter;
	float by_samples = (float)push->light_samples * density;
	float by_rays = push->use_hits ? (float)push->rays * cosine / GW_PI : 0.0f;
	return gw_times(gw_xyz(job->part + 4 * lobe),
					cosine / density * (by_samples / (by_samples + by_rays)));
}

static void sample_emitters(void *user, size_t first, size_t last, uint32_t worker)
{
	const sampling *job = user;
	(void)worker;
	for (size_t i = first; i < last; i++)
		sample_record(job, i, sample_emitter, job->push.light_samples,
					  job->push.seed ^ GW_EMITTER_SEED);
}

static size_t chunk_of(uint32_t samples)
{
	return CHUNK_RAYS / samples + 1;
}

void gw_host_record_emitters(gw_passes *passes, const gw_octree *octree, const gw_records *records,
							 const gw_sampled_sources *sources, const gw_record_push *push,
							 gw_buffer *sampled)
{
	const gw_emitters *emitters = sources->emitters;
	if (push->light_samples == 0)
		return;
	sampling job = { .tracer = gw_tracer_of(passes, octree),
					 .push = *push,
					 .position = records->position.mapped,
					 .normal = records->normal.mapped,
					 .table = emitters->table.mapped,
					 .radiance = emitters->radiance->mapped,
					 .part = (sources->part ? sources->part : emitters->radiance)->mapped,
					 .sampled = sampled->mapped };
	gw_host_loop(passes, GW_PASS_RECORD_EMITTERS, records->count, chunk_of(push->light_samples),
				 sample_emitters, &job);
}

/* A direction in a texel of the map: sky_map.glsl. */
static gw_vec3 sky_direction(const gw_record_push *push, uint32_t texel, float a, float b)
{
	uint32_t row = texel / push->sky_width;
	float u = ((float)(texel % push->sky_width) + a) / (float)push->sky_width;
	float above = cosf(GW_PI * (float)row / (float)push->sky_height);
	float below = cosf(GW_PI * (float)(row + 1) / (float)push->sky_height);
	float height = above * (1.0f - b) + below * b;
	float azimuth = 2.0f * GW_PI * (u - 0.5f + push->sky_turn);
	float level = sqrtf(gw_larger(0.0f, 1.0f - height * height));
	float east = level * sinf(azimuth), north = level * cosf(azimuth);
	return push->sky_y_up ? (gw_vec3){ east, height, -north } : (gw_vec3){ east, north, height };
}

static gw_vec3 sample_sky(const sampling *job, gw_ray *ray, uint32_t m, uint32_t random)
{
	const gw_record_push *push = &job->push;
	uint32_t texels = push->sky_width * push->sky_height;
	float choice = ((float)m + gw_unit_float(random)) / (float)push->sky_samples;
	uint32_t texel = (uint32_t)(choice * (float)texels);
	texel = texel < texels - 1 ? texel : texels - 1;
	const uint32_t *row = job->table + 2 * (size_t)texel;
	if (gw_unit_float(gw_mix2(random, 3)) >= gw_float_of(row[1]))
		texel = row[0];
	ray->direction = sky_direction(push, texel, gw_unit_float(gw_mix2(random, 1)),
								   gw_unit_float(gw_mix2(random, 2)));
	float cosine = gw_dot(ray->facing, ray->direction);
	if (cosine <= 0.0f)
		return (gw_vec3){ 0 };
	ray->t_max = FAR;
	if (gw_trace(&job->tracer, ray).lobe != GW_NONE)
		return (gw_vec3){ 0 };
	gw_vec3 radiance = gw_xyz(job->radiance + 4 * (size_t)texel);
	float density = gw_luminance_of(radiance) / push->sky_total;
	float by_samples = (float)push->sky_samples * density;
	float by_rays = push->sky_hits ? (float)push->rays * cosine / GW_PI : 0.0f;
	return gw_times(radiance,
					cosine / gw_larger(density, 1e-30f) * (by_samples / (by_samples + by_rays)));
}

static void sample_skies(void *user, size_t first, size_t last, uint32_t worker)
{
	const sampling *job = user;
	(void)worker;
	for (size_t i = first; i < last; i++)
		sample_record(job, i, sample_sky, job->push.sky_samples, job->push.seed ^ GW_SKY_SEED);
}

void gw_host_record_sky(gw_passes *passes, const gw_octree *octree, const gw_records *records,
						const gw_sky_map *map, const gw_record_push *push, gw_buffer *sampled)
{
	if (push->sky_samples == 0)
		return;
	sampling job = { .tracer = gw_tracer_of(passes, octree),
					 .push = *push,
					 .position = records->position.mapped,
					 .normal = records->normal.mapped,
					 .table = map->alias.mapped,
					 .radiance = map->texel.mapped,
					 .sampled = sampled->mapped };
	gw_host_loop(passes, GW_PASS_RECORD_SKY, records->count, chunk_of(push->sky_samples),
				 sample_skies, &job);
}

/* -------------------------------------------------------------------------------- first light */

typedef struct first_light {
	gw_record_push push;
	const uint32_t *lobe;
	const float *distance, *plane, *radiance, *part, *sampled;
	float *position, *normal, *irradiance;
} first_light;

/* Share of an emitter's light that the hit of gather ray k stands for. */
static float hit_share(const first_light *job, size_t record, uint32_t k, size_t lobe, float t)
{
	const gw_record_push *push = &job->push;
	gw_vec3 g = gw_xyz(job->position + 4 * record), normal = gw_xyz(job->normal + 4 * record);
	gw_vec3 direction = gw_record_ray(g, normal, k, push->rays, push->seed);
	float cosine = gw_larger(0.0f, gw_dot(normal, direction));
	float cosine_emitter = gw_larger(1e-4f, -gw_dot(gw_xyz(job->plane + 4 * lobe), direction));
	float emission = gw_luminance_of(gw_xyz(job->radiance + 4 * lobe));
	float density = emission / push->emitter_power * t * t / cosine_emitter;
	float by_rays = (float)push->rays * cosine / GW_PI;
	return by_rays / (by_rays + (float)push->light_samples * density);
}

/* What ray k brings. */
static gw_vec3 light_of_ray(const first_light *job, size_t record, uint32_t k)
{
	const gw_record_push *push = &job->push;
	size_t ray = record * push->rays + k, lobe = job->lobe[ray];
	if (lobe == GW_NONE)
		return gw_xyz(&push->sky.x);
	if (!push->use_hits || !(gw_luminance_of(gw_xyz(job->radiance + 4 * lobe)) > 0.0f))
		return (gw_vec3){ 0 };
	float share =
		push->light_samples ? hit_share(job, record, k, lobe, fabsf(job->distance[ray])) : 1.0f;
	return gw_times(gw_xyz(job->part + 4 * lobe), share);
}

/* The nearest thing that a record sees, and whether it lies inside something solid. */
static void look_around(const first_light *job, size_t record)
{
	const float *distance = job->distance + record * job->push.rays;
	float nearest = FAR;
	uint32_t behind = 0;
	for (uint32_t k = 0; k < job->push.rays; k++) {
		behind += distance[k] < 0.0f;
		nearest = gw_smaller(nearest, fabsf(distance[k]));
	}
	job->position[4 * record + 3] = nearest;
	job->normal[4 * record + 3] = 2 * behind > job->push.rays ? 0.0f : 1.0f;
}

static void add_first(void *user, size_t first, size_t last, uint32_t worker)
{
	const first_light *job = user;
	(void)worker;
	for (size_t i = first; i < last; i++) {
		gw_vec3 sum = { 0 };
		float *own = job->irradiance + 4 * i;
		for (uint32_t k = 0; k < job->push.rays; k++)
			sum = gw_plus(sum, light_of_ray(job, i, k));
		if (!job->push.looked)
			look_around(job, i);
		sum = gw_times(sum, GW_PI / (float)job->push.rays);
		sum = gw_times(gw_plus(sum, gw_xyz(job->sampled + 4 * i)), job->normal[4 * i + 3]);
		own[0] = sum.x;
		own[1] = sum.y;
		own[2] = sum.z;
		own[3] = 0.0f;
	}
}

void gw_host_record_first(gw_passes *passes, const gw_octree *octree, gw_records *records,
						  const gw_ray_gather *gather, const gw_sampled_sources *sources,
						  const gw_record_push *push, const gw_buffer *sampled,
						  gw_buffer *irradiance)
{
	const gw_buffer *radiance = sources->emitters->radiance;
	first_light job = { .push = *push,
						.lobe = gather->lobe.mapped,
						.distance = gather->distance.mapped,
						.plane = octree->lobe_plane.mapped,
						.radiance = radiance->mapped,
						.part = (sources->part ? sources->part : radiance)->mapped,
						.sampled = sampled->mapped,
						.position = records->position.mapped,
						.normal = records->normal.mapped,
						.irradiance = irradiance->mapped };
	gw_host_loop(passes, GW_PASS_RECORD_FIRST, records->count, chunk_of(push->rays), add_first,
				 &job);
}

/* ------------------------------------------------------------------------------- shadow rays */

typedef struct shadows {
	gw_tracer tracer;
	gw_light_push push;
	const float *normal;
	float *visibility;
} shadows;

float gw_lamp_share(const gw_light_push *push, gw_vec3 g, gw_vec3 *towards, float *distance)
{
	if (push->type == GW_PUSH_SUN) {
		*towards = (gw_vec3){ -push->direction.x, -push->direction.y, -push->direction.z };
		*distance = FAR;
		return 1.0f;
	}
	const gw_vec3 axis = { push->direction.x, push->direction.y, push->direction.z };
	gw_vec3 to = gw_minus((gw_vec3){ push->position.x, push->position.y, push->position.z }, g);
	float squared = gw_dot(to, to), inner = push->cos_inner, outer = push->cos_outer;
	/* Nearer than the light's own radius, or on the light itself, the distance stops falling. */
	*distance = sqrtf(gw_larger(squared, gw_larger(push->position.w * push->position.w, 1e-12f)));
	*towards = gw_times(to, squared > 0.0f ? 1.0f / sqrtf(squared) : 0.0f);
	if (push->type != GW_PUSH_SPOT)
		return 1.0f;
	float cosine = -gw_dot(*towards, axis);
	if (!(inner > outer))
		return cosine >= outer ? 1.0f : 0.0f;
	float x = gw_smaller(gw_larger((cosine - outer) / (inner - outer), 0.0f), 1.0f);
	return x * x * (3.0f - 2.0f * x);
}

/* Do most of the discs in the lobe's leaf that end there do so at a crease? */
static bool ends_at_crease(const gw_tracer *tracer, uint32_t lobe)
{
	int votes = 0;
	uint32_t last = tracer->leaf_fragment[(lobe >> 1) + 1];
	for (uint32_t f = tracer->leaf_fragment[lobe >> 1]; f < last; f++) {
		size_t surfel = tracer->fragment_surfel[f] & 0x3fffffffu;
		const float *disc = tracer->disc + 4 * surfel;
		if (disc[2] != 0.0f || disc[3] != 0.0f)
			votes += tracer->facing[4 * surfel + 3] < -0.5f ? 1 : -1;
	}
	return votes > 0;
}

void gw_lamp_aim(const gw_light_push *push, uint32_t s, float turn, gw_vec3 towards, float distance,
				 gw_ray *ray)
{
	float p[2] = { 0 };
	gw_vec3 t, b;
	bool sun = push->type == GW_PUSH_SUN;
	float radius = sun ? push->direction.w : push->position.w;
	gw_frame_of(towards, &t, &b);
	if (push->samples > 1)
		gw_spiral_disc(s, push->samples, 0.5f, turn, p);
	gw_vec3 to = gw_along(t, p[0] * radius, b, p[1] * radius, towards, sun ? 1.0f : distance);
	ray->direction = gw_unit(to);
	ray->t_max = sun ? FAR : sqrtf(gw_dot(to, to));
}

static float share_seen(const shadows *job, size_t surfel)
{
	const gw_light_push *push = &job->push;
	const float *own = job->normal + 4 * surfel;
	float distance, seen = 0.0f, hidden = 0.0f;
	gw_vec3 towards, facing = gw_xyz(job->tracer.facing + 4 * surfel), normal = gw_xyz(own);
	gw_ray ray = { .origin = gw_xyz(job->tracer.place + 4 * surfel),
				   .both_sides = true,
				   .discs = true };
	if (!(gw_lamp_share(push, ray.origin, &towards, &distance) > 0.0f))
		return 0.0f;
	float cosine = gw_dot(normal, towards);
	if (!((own[3] > 0.5f ? fabsf(cosine) : cosine) > 0.0f))
		return 0.0f;
	/* The ray leaves the surface behind the noise; the normal is the point's own. */
	ray.facing = cosine < 0.0f ? gw_times(facing, -1.0f) : facing;
	ray.foot = ray.origin;
	float turn = gw_unit_float(gw_mix2((uint32_t)surfel, push->seed));
	uint32_t rays = push->samples;
	for (uint32_t s = 0; s < rays; s++) {
		gw_lamp_aim(push, push->samples - 1 - s, turn, towards, distance, &ray);
		uint32_t lobe = gw_trace(&job->tracer, &ray).lobe;
		if (lobe == GW_NONE)
			seen += 1.0f;
		else if (ends_at_crease(&job->tracer, lobe))
			hidden = GW_HIDDEN_BY_CREASE;
		if (s + 1 == GW_LIGHT_RIM && (seen == 0.0f || seen == (float)GW_LIGHT_RIM))
			rays = GW_LIGHT_RIM;
	}
	return seen / (float)rays + hidden;
}

static void look_at_light(void *user, size_t first, size_t last, uint32_t worker)
{
	const shadows *job = user;
	(void)worker;
	for (size_t i = first; i < last; i++)
		job->visibility[i] = share_seen(job, i);
}

void gw_host_light_visibility(gw_passes *passes, const gw_octree *octree, const gw_light_push *push,
							  const gw_buffer *normal, size_t count, gw_buffer *visibility)
{
	shadows job = { .tracer = gw_tracer_of(passes, octree),
					.push = *push,
					.normal = normal->mapped,
					.visibility = visibility->mapped };
	gw_host_loop(passes, GW_PASS_LIGHT_VISIBILITY, count, chunk_of(push->samples), look_at_light,
				 &job);
}

/* --------------------------------------------------------------------------- light of a lamp */

typedef struct lamp_light {
	gw_light_push push;
	const float *place, *normal, *visibility;
	float *irradiance;
} lamp_light;

static void add_lamp(const lamp_light *job, size_t surfel)
{
	const gw_light_push *push = &job->push;
	const float *own = job->normal + 4 * surfel;
	float distance, seen = push->shadows ? job->visibility[surfel] : 1.0f, sign = 1.0f;
	gw_vec3 towards, power = gw_xyz(&push->power.x);
	float share = gw_lamp_share(push, gw_xyz(job->place + 4 * surfel), &towards, &distance);
	float cosine = gw_dot(gw_xyz(own), towards);
	float e = share * (own[3] > 0.5f ? fabsf(cosine) : gw_larger(cosine, 0.0f));
	if (push->type != GW_PUSH_SUN)
		e /= distance * distance;
	if (seen >= GW_HIDDEN_BY_CREASE) {
		seen -= GW_HIDDEN_BY_CREASE;
		sign = push->samples > 1 ? 0.0f : -1.0f;
	}
	float *sum = job->irradiance + 4 * surfel;
	sum[0] += e * power.x * seen;
	sum[1] += e * power.y * seen;
	sum[2] += e * power.z * seen;
	sum[3] += e * gw_luminance_of(power) * (sign * (1.0f - seen));
}

static void add_lamps(void *user, size_t first, size_t last, uint32_t worker)
{
	(void)worker;
	for (size_t i = first; i < last; i++)
		add_lamp(user, i);
}

void gw_host_light_irradiance(gw_passes *passes, const gw_octree *octree, const gw_light_push *push,
							  const gw_buffer *normal, const gw_buffer *visibility, size_t count,
							  gw_buffer *irradiance)
{
	lamp_light job = { .push = *push,
					   .place = octree->surfel_position.mapped,
					   .normal = normal->mapped,
					   .visibility = visibility->mapped,
					   .irradiance = irradiance->mapped };
	gw_host_loop(passes, GW_PASS_LIGHT_IRRADIANCE, count, CHUNK_RAYS, add_lamps, &job);
}

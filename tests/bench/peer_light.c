#include "peer_light.h"

#include "base/memory.h"
#include "base/parallel.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265f
#define CHUNK 256u

/* Paths from here on end by chance. */
#define FIRST_ROULETTE 2u

/* Fractions of the plastic number and its kin in three dimensions (Roberts 2018), times 2^32: a
 * sequence that fills square and cube evenly. */
static const uint32_t step_square[2] = { 3242174889u, 2447445414u };
static const uint32_t step_cube[3] = { 3518319155u, 2882110345u, 2360945575u };

static uint64_t hash(uint64_t z)
{
	z += 0x9e3779b97f4a7c15u;
	z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
	z = (z ^ z >> 27) * 0x94d049bb133111ebu;
	return z ^ z >> 31;
}

/* Coordinate of a sample in a surfel's own shift of the sequence. */
static float fraction(uint32_t surfel, uint32_t dimension, uint32_t step, uint32_t sample)
{
	uint32_t shift = (uint32_t)hash((uint64_t)surfel << 8 | dimension);
	return (float)((shift + sample * step) >> 8) * 0x1p-24f;
}

static void first_direction(const peer_discs *d, uint32_t surfel, uint32_t sample, float out[3])
{
	peer_cosine_direction(d, surfel, fraction(surfel, 0, step_square[0], sample),
						  fraction(surfel, 1, step_square[1], sample), out);
}

static void first_emitter(const peer_discs *d, uint32_t surfel, uint32_t sample, float sum[3])
{
	float drawn[3];
	for (uint32_t k = 0; k < 3; k++)
		drawn[k] = fraction(surfel, 2 + k, step_cube[k], sample);
	peer_add_emitter(d, surfel, drawn, 1.0f, sum);
}

static const float *albedo_of(const peer_discs *d, uint32_t surfel)
{
	return d->surfels.albedo + 3 * (size_t)surfel;
}

/* A ray from one surfel that met another one by chance. */
typedef struct meeting {
	uint32_t from, met;
	const float *direction; /* 3 */
	float distance;
} meeting;

/* What emits there, as irradiance of the ray's surfel. */
static void add_met(const peer_discs *d, const meeting *m, const float throughput[3], float sum[3])
{
	if (d->emitter_count == 0 || d->density[m->met] <= 0.0f)
		return;
	float weight = PI * peer_met_weight(d, m->from, m->met, m->direction, m->distance, 1.0f);
	for (size_t k = 0; k < 3; k++)
		sum[k] += throughput[k] * weight * d->surfels.emission[3 * (size_t)m->met + k];
}

/* ----------------------------------------------------------------------------------- lamps */

typedef struct lamp_loop {
	const peer_discs *discs;
	uint32_t samples;
	float *irradiance;
} lamp_loop;

static void light_some(void *user, size_t first, size_t last, uint32_t worker)
{
	lamp_loop *l = user;
	(void)worker;
	uint32_t samples = l->discs->soft ? l->samples : 1;
	for (size_t i = first; i < last; i++) {
		peer_random random = { hash(i) };
		float *sum = l->irradiance + 3 * i;
		memset(sum, 0, 3 * sizeof *sum);
		for (uint32_t s = 0; s < samples; s++)
			peer_add_lamps(l->discs, (uint32_t)i, &random, sum);
		for (int k = 0; k < 3; k++)
			sum[k] /= (float)samples;
	}
}

void peer_light_lamps(const peer_discs *discs, uint32_t samples, float *irradiance)
{
	lamp_loop loop = { discs, samples, irradiance };
	gw_parallel_for(0, discs->surfels.count, CHUNK, light_some, &loop);
}

/* ----------------------------------------------------------------------------------- paths */

typedef struct path_loop {
	const peer_discs *discs;
	uint32_t first, samples;
	float *sum;
} path_loop;

/* Light at a vertex that is not the first, straight from lamps and emitters. */
static void add_vertex(const peer_discs *d, uint32_t surfel, peer_random *random,
					   const float throughput[3], float sum[3])
{
	float here[3] = { 0 };
	peer_add_lamps(d, surfel, random, here);
	float drawn[3] = { 0 };
	for (int k = 0; k < 3 && d->emitter_count > 0; k++)
		drawn[k] = peer_random_next(random);
	peer_add_emitter(d, surfel, drawn, 1.0f, here);
	for (int k = 0; k < 3; k++)
		sum[k] += throughput[k] * here[k];
}

/* False when the path ends here. */
static bool survive(uint32_t vertex, peer_random *random, float throughput[3])
{
	float most = fmaxf(throughput[0], fmaxf(throughput[1], throughput[2]));
	if (vertex < FIRST_ROULETTE)
		return most > 0.0f;
	if (peer_random_next(random) >= fminf(most, 1.0f))
		return false;
	for (int k = 0; k < 3; k++)
		throughput[k] /= fminf(most, 1.0f);
	return true;
}

/* Cosine-distributed directions cancel the cosine and leave pi; a surface's albedo / pi cancels
 * that, so that irradiance is passed on by the albedo alone. */
static void trace_path(const peer_discs *d, uint32_t surfel, uint32_t sample, peer_random *random,
					   float sum[3])
{
	float throughput[3] = { 1.0f, 1.0f, 1.0f }, direction[3], distance;
	uint32_t at = surfel;
	first_emitter(d, surfel, sample, sum);
	for (uint32_t vertex = 0; survive(vertex, random, throughput); vertex++) {
		if (vertex == 0)
			first_direction(d, at, sample, direction);
		else
			peer_cosine_direction(d, at, peer_random_next(random), peer_random_next(random),
								  direction);
		uint32_t met = peer_trace(d, at, direction, &distance);
		for (int k = 0; k < 3 && met == PEER_NOTHING; k++)
			sum[k] += throughput[k] * PI * d->sky[k];
		if (met >= PEER_BACK)
			return;
		add_met(d, &(meeting){ at, met, direction, distance }, throughput, sum);
		for (int k = 0; k < 3; k++)
			throughput[k] *= albedo_of(d, met)[k];
		add_vertex(d, met, random, throughput, sum);
		at = met;
	}
}

static void trace_some(void *user, size_t first, size_t last, uint32_t worker)
{
	path_loop *p = user;
	(void)worker;
	for (size_t i = first; i < last; i++) {
		peer_random random = { hash((uint64_t)p->first << 32 ^ i) };
		for (uint32_t s = 0; s < p->samples; s++)
			trace_path(p->discs, (uint32_t)i, p->first + s, &random, p->sum + 3 * i);
	}
}

void peer_light_paths(const peer_discs *discs, uint32_t first, uint32_t samples, float *sum)
{
	path_loop loop = { discs, first, samples, sum };
	gw_parallel_for(0, discs->surfels.count, CHUNK, trace_some, &loop);
}

/* ----------------------------------------------------------------------------------- cache */

typedef struct cache {
	const peer_discs *discs;
	const float *lamps;
	uint32_t rays;
	uint32_t *met;   /* rays a surfel */
	float *first;    /* 3 a surfel: irradiance from emitters and sky */
	float *radiated; /* 3 a surfel: albedo times irradiance, of the bounce before */
	float *irradiance;
	double change[GW_THREADS_MAX], total[GW_THREADS_MAX];
} cache;

static void gather_some(void *user, size_t first, size_t last, uint32_t worker)
{
	cache *c = user;
	const float one[3] = { 1.0f, 1.0f, 1.0f };
	const peer_discs *d = c->discs;
	(void)worker;
	for (size_t i = first; i < last; i++) {
		float *sum = c->first + 3 * i;
		for (uint32_t r = 0; r < c->rays; r++) {
			float direction[3], distance;
			first_emitter(d, (uint32_t)i, r, sum);
			first_direction(d, (uint32_t)i, r, direction);
			uint32_t met = peer_trace(d, (uint32_t)i, direction, &distance);
			c->met[i * c->rays + r] = met;
			for (int k = 0; k < 3 && met == PEER_NOTHING; k++)
				sum[k] += PI * d->sky[k];
			if (met < PEER_BACK)
				add_met(d, &(meeting){ (uint32_t)i, met, direction, distance }, one, sum);
		}
		for (int k = 0; k < 3; k++)
			sum[k] /= (float)c->rays;
	}
}

static void radiate_some(void *user, size_t first, size_t last, uint32_t worker)
{
	cache *c = user;
	(void)worker;
	for (size_t i = 3 * first; i < 3 * last; i++)
		c->radiated[i] = c->discs->surfels.albedo[i] * (c->lamps[i] + c->irradiance[i]);
}

static void bounce_some(void *user, size_t first, size_t last, uint32_t worker)
{
	cache *c = user;
	for (size_t i = first; i < last; i++) {
		float sum[3] = { 0 };
		const uint32_t *met = c->met + i * c->rays;
		for (uint32_t r = 0; r < c->rays; r++)
			for (size_t k = 0; k < 3 && met[r] < PEER_BACK; k++)
				sum[k] += c->radiated[3 * (size_t)met[r] + k];
		for (size_t k = 0; k < 3; k++) {
			float now = c->first[3 * i + k] + sum[k] / (float)c->rays;
			c->change[worker] += (double)(now - c->irradiance[3 * i + k]);
			c->total[worker] += (double)(now + c->lamps[3 * i + k]);
			c->irradiance[3 * i + k] = now;
		}
	}
}

/* Whether a bounce still added something. */
static bool bounce(cache *c)
{
	size_t count = c->discs->surfels.count;
	double change = 0.0, total = 0.0;
	memset(c->change, 0, sizeof c->change);
	memset(c->total, 0, sizeof c->total);
	gw_parallel_for(0, count, CHUNK, radiate_some, c);
	gw_parallel_for(0, count, CHUNK, bounce_some, c);
	for (size_t i = 0; i < GW_THREADS_MAX; i++) {
		change += c->change[i];
		total += c->total[i];
	}
	return change > 1e-3 * total;
}

gw_status peer_light_cached(const peer_discs *d, uint32_t rays, const float *lamps,
							float *irradiance, gw_error *error)
{
	size_t count = d->surfels.count;
	cache c = { .discs = d, .lamps = lamps, .rays = rays, .irradiance = irradiance };
	gw_status status = GW_OK;
	c.met = gw_allocate_array(count, rays * sizeof *c.met);
	c.first = gw_allocate_zeros(count, 3 * sizeof *c.first);
	c.radiated = gw_allocate_array(count, 3 * sizeof *c.radiated);
	if (c.met && c.first && c.radiated) {
		gw_parallel_for(0, count, CHUNK, gather_some, &c);
		memcpy(irradiance, c.first, count * 3 * sizeof *irradiance);
		while (bounce(&c))
			;
	} else {
		status =
			gw_fail(error, GW_ERROR_MEMORY, "no memory for %u rays of %zu surfels", rays, count);
	}
	free(c.met);
	free(c.first);
	free(c.radiated);
	return status;
}

/* ---------------------------------------------------------------------------------- filter */

typedef struct filter_loop {
	const peer_discs *discs;
	const float *from;
	float *to;
} filter_loop;

static float likeness(const gw_surfels *s, size_t i, size_t j, float reach)
{
	const float *p = s->position + 3 * i, *q = s->position + 3 * j;
	const float *n = s->normal + 3 * i, *m = s->normal + 3 * j;
	const float to[3] = { q[0] - p[0], q[1] - p[1], q[2] - p[2] };
	float off = to[0] * n[0] + to[1] * n[1] + to[2] * n[2];
	float square = to[0] * to[0] + to[1] * to[1] + to[2] * to[2];
	float alike = fmaxf(0.0f, n[0] * m[0] + n[1] * m[1] + n[2] * m[2]);
	float power = alike * alike;
	power *= power;
	power *= power;
	/* Half of the reach is the standard deviation, a quarter of a spacing that off the plane. */
	float plane = off / (0.25f * s->spacing);
	return power * expf(-2.0f * square / reach - 0.5f * plane * plane);
}

static void filter_some(void *user, size_t first, size_t last, uint32_t worker)
{
	filter_loop *f = user;
	const gw_surfels *s = &f->discs->surfels;
	(void)worker;
	for (size_t i = first; i < last; i++) {
		const uint32_t *near = f->discs->neighbour + i * f->discs->neighbours;
		const float *p = s->position + 3 * i;
		const float *q = s->position + 3 * (size_t)near[f->discs->neighbours - 1];
		float reach = (p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) +
					  (p[2] - q[2]) * (p[2] - q[2]) + 1e-12f;
		float sum[3] = { 0 }, weights = 0.0f;
		for (size_t k = 0; k < f->discs->neighbours; k++) {
			float weight = likeness(s, i, near[k], reach);
			weights += weight;
			for (size_t c = 0; c < 3; c++)
				sum[c] += weight * f->from[3 * (size_t)near[k] + c];
		}
		for (size_t c = 0; c < 3; c++)
			f->to[3 * i + c] = weights > 0.0f ? sum[c] / weights : f->from[3 * i + c];
	}
}

gw_status peer_light_filter(const peer_discs *d, float *irradiance, gw_error *error)
{
	size_t bytes = d->surfels.count * 3 * sizeof(float);
	float *before = gw_allocate_array(d->surfels.count, 3 * sizeof *before);
	if (!before)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to filter");
	memcpy(before, irradiance, bytes);
	filter_loop loop = { d, before, irradiance };
	gw_parallel_for(0, d->surfels.count, CHUNK, filter_some, &loop);
	free(before);
	return GW_OK;
}

/*
 * error_estimate.c - see error_estimate.h.
 */
#include "error_estimate.h"

#include "bounces.h"
#include "luminance.h"
#include "memory.h"
#include "normal_error.h"
#include "parallel.h"
#include "shadow_error.h"
#include "transport_layout.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Rays, and samples of the emitters, in each of the two gathers of a point. */
#define HALF_RAYS 64u

/* Records that light a point, by their weights: 1 / sum w^2. */
#define RECORDS_A_POINT 3.0

static const double reciprocal_pi = 0.31830988618379067;

/* What the estimate of one lighting needs. */
typedef struct estimate {
	bool *counts;   /* one a surfel: whether its error counts */
	float *half[2]; /* 4 a probe, irradiance that the first and the second gather found */
} estimate;

static uint64_t next_random(uint64_t *state)
{
	uint64_t z = *state += 0x9e3779b97f4a7c15u;
	z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
	z = (z ^ z >> 27) * 0x94d049bb133111ebu;
	return z ^ z >> 31;
}

static bool emits(const gw_surfels *surfels, size_t i)
{
	const float *e = surfels->emission ? surfels->emission + 3 * i : NULL;
	return e && (e[0] > 0.0f || e[1] > 0.0f || e[2] > 0.0f);
}

/* Points whose error counts: emitters outshine theirs, so they do not unless there is nothing else;
 * and of points that are lit from both sides it is not known which side a gather is to look from.
 */
static void choose_points(const gw_surfels *surfels, bool *counts)
{
	size_t dark = 0;
	for (size_t i = 0; i < surfels->count; i++)
		dark += counts[i] = !surfels->two_sided[i] && !emits(surfels, i);
	for (size_t i = 0; i < surfels->count && dark == 0; i++)
		counts[i] = !surfels->two_sided[i];
}

/* One random surfel in each of `points` equal stretches of the surfels. */
static gw_status draw(const gw_surfels *surfels, uint32_t points, uint32_t seed, gw_probes *p,
					  gw_error *error)
{
	size_t count = surfels->count, wanted = points < count ? points : count;
	uint64_t state = seed;
	p->surfel = gw_allocate_array(wanted, sizeof *p->surfel);
	if (!p->surfel)
		return gw_fail(error, GW_ERROR_MEMORY, "no host memory to draw from %zu points", count);
	for (size_t i = 0; i < wanted; i++) {
		size_t first = i * count / wanted, last = (i + 1) * count / wanted;
		size_t surfel = first + next_random(&state) % (last - first);
		if (!surfels->two_sided[surfel])
			p->surfel[p->count++] = (uint32_t)surfel;
	}
	return GW_OK;
}

static gw_status place(gw_gpu *gpu, const gw_octree *octree, const gw_surfels *s, gw_probes *p,
					   gw_error *error)
{
	float *rows = gw_allocate_zeros(p->count, 8 * sizeof *rows);
	if (!rows)
		return gw_fail(error, GW_ERROR_MEMORY, "no host memory for %u points", p->count);
	float *normal = rows + 4 * (size_t)p->count;
	for (size_t i = 0; i < p->count; i++) {
		size_t surfel = p->surfel[i];
		for (size_t k = 0; k < 3; k++)
			rows[4 * i + k] =
				(s->position[3 * surfel + k] - octree->cube_minimum[k]) / octree->leaf_size;
		memcpy(normal + 4 * i, s->normal + 3 * surfel, 3 * sizeof *normal);
	}
	gw_status status = gw_records_put(gpu, rows, normal, p->count, &p->place, error);
	free(rows);
	return status;
}

gw_ray_gather gw_probes_rays(uint32_t seed, int half)
{
	return (gw_ray_gather){ .rays = HALF_RAYS, .seed = seed ^ (half ? 0xb5297a4du : 0x68e31da4u) };
}

gw_status gw_probes_make(gw_passes *passes, const gw_octree *octree, const gw_surfels *surfels,
						 uint32_t points, uint32_t seed, gw_probes *probes, gw_error *error)
{
	*probes = (gw_probes){ .points = points, .seed = seed };
	gw_status status = draw(surfels, points, seed, probes, error);
	if (status == GW_OK && probes->count > 0)
		status = place(passes->gpu, octree, surfels, probes, error);
	for (int half = 0; half < 2 && status == GW_OK && probes->count > 0; half++)
		status = gw_ray_gather_trace(passes, octree, &probes->place, HALF_RAYS,
									 gw_probes_rays(seed, half).seed, &probes->rays[half], error);
	if (status != GW_OK)
		gw_probes_destroy(passes->gpu, probes);
	return status;
}

void gw_probes_destroy(gw_gpu *gpu, gw_probes *probes)
{
	for (int half = 0; half < 2; half++) {
		gw_ray_gather_destroy(gpu, &probes->rays[half]);
		gw_buffer_destroy(gpu, &probes->sampled[half]);
	}
	gw_records_destroy(gpu, &probes->place);
	free(probes->surfel);
	*probes = (gw_probes){ 0 };
}

/* What the lobes send out in the end, their own emission left out. */
static gw_status shade_all(const gw_estimate_task *task, gw_buffer *radiance, gw_error *error)
{
	gw_gpu *gpu = task->passes->gpu;
	const gw_records *records = task->records;
	gw_buffer total = { 0 };
	gw_status status =
		gw_buffer_create(gpu, GW_BUFFER_TEXEL, VK_FORMAT_R32G32B32A32_SFLOAT,
						 16 * (uint64_t)records->count, "record irradiance", &total, error);
	const gw_buffer *parts[2] = { &records->first, &records->indirect };
	for (int i = 0; i < 2 && status == GW_OK; i++) {
		const gw_binding bindings[] = { gw_window(parts[i], 16), gw_window(&total, 16) };
		status = gw_passes_run(task->passes, GW_PASS_RECORD_ADD, bindings, &(gw_record_push){ 0 },
							   records->count, error);
	}
	if (status == GW_OK)
		status = gw_buffer_create(gpu, GW_BUFFER_TEXEL, VK_FORMAT_R32G32B32A32_SFLOAT,
								  32 * (uint64_t)task->octree->leaf_count, "final lobe radiance",
								  radiance, error);
	if (status == GW_OK)
		status = gw_lobes_shade(task->passes, task->octree, records, &total, task->lobe_direct,
								1.0f, radiance, error);
	gw_buffer_destroy(gpu, &total);
	return status;
}

static gw_status download_added(gw_gpu *gpu, gw_buffer *buffer, float *sum, uint32_t count,
								gw_error *error)
{
	float *values = gw_allocate_array(count, 4 * sizeof *values);
	if (!values)
		return gw_fail(error, GW_ERROR_MEMORY, "no host memory for %u points", count);
	gw_status status = gw_buffer_download(gpu, buffer, 0, values, 16 * (uint64_t)count, error);
	for (size_t i = 0; i < 4 * (size_t)count && status == GW_OK; i++)
		sum[i] += values[i];
	free(values);
	return status;
}

/* Light straight from some emitters, or from what lobes reflect, added to e->half[half]. */
static gw_status gather_from(const gw_estimate_task *task, int half,
							 const gw_sampled_sources *sources, estimate *e, gw_error *error)
{
	gw_probes *p = task->probes;
	gw_status status = gw_ray_gather_sampled(task->passes, task->octree, &p->place, &p->rays[half],
											 sources, &p->place.gathered, error);
	if (status == GW_OK)
		status =
			download_added(task->passes->gpu, &p->place.gathered, e->half[half], p->count, error);
	return status;
}

/* Samples the openings to the sky, where records did. */
static gw_status open_probes(const gw_estimate_task *task, int half, gw_error *error)
{
	gw_probes *p = task->probes;
	if (!task->openings)
		return GW_OK;
	return gw_ray_gather_open(task->passes, task->octree, &p->place, task->openings, &p->rays[half],
							  error);
}

/* All that reaches the points, into e->half[half]. */
static gw_status gather_half(const gw_estimate_task *task, int half, const gw_emitters *reflectors,
							 estimate *e, gw_error *error)
{
	const float black[3] = { 0 };
	uint32_t seed = task->probes->rays[half].seed;
	const gw_sampled_sources emitters = { .emitters = task->emitters,
										  .samples = HALF_RAYS,
										  .use_hits = true,
										  .sky = task->sky,
										  .map = task->map,
										  .map_samples = HALF_RAYS,
										  .map_hits = true,
										  .openings = task->openings,
										  .seed = seed,
										  .kept = task->emitters->count > 0
													  ? &task->probes->sampled[half]
													  : NULL };
	const gw_sampled_sources reflected = { .emitters = reflectors,
										   .samples =
											   gw_emitters_are_small(reflectors) ? HALF_RAYS : 0,
										   .use_hits = true,
										   .sky = black,
										   .seed = seed };
	e->half[half] = gw_allocate_zeros(task->probes->count, 4 * sizeof(float));
	if (!e->half[half])
		return gw_fail(error, GW_ERROR_MEMORY, "no host memory for %u points", task->probes->count);
	gw_status status = open_probes(task, half, error);
	if (status == GW_OK)
		status = gather_from(task, half, &emitters, e, error);
	if (status == GW_OK && task->bounces)
		status = gather_from(task, half, &reflected, e, error);
	return status;
}

/* Radiance that a surfel reflects of an irradiance. */
static double reflected(const gw_surfels *surfels, size_t surfel, const float irradiance[3])
{
	const float *rho = surfels->albedo + 3 * surfel;
	const float c[3] = { rho[0] * irradiance[0], rho[1] * irradiance[1], rho[2] * irradiance[2] };
	return reciprocal_pi * gw_luminance(c);
}

static double mean_radiance(const gw_estimate_task *task, const bool *counts)
{
	const gw_surfels *s = task->surfels;
	double sum = 0.0;
	size_t used = 0;
	for (size_t i = 0; i < s->count; i++) {
		if (!counts[i])
			continue;
		sum += reflected(s, i, task->first + 4 * i) + reflected(s, i, task->indirect + 4 * i);
		sum += task->direct ? reflected(s, i, task->direct + 4 * i) : 0.0;
		sum += s->emission ? gw_luminance(s->emission + 3 * i) : 0.0;
		used++;
	}
	return used ? sum / (double)used : 0.0;
}

static void compare(const gw_estimate_task *task, const estimate *e, double mean,
					gw_error_estimate *result)
{
	const gw_probes *p = task->probes;
	double n = 0.0;
	double sum = 0.0, square = 0.0, fourth = 0.0, half = 0.0;
	for (size_t i = 0; i < p->count && mean > 0.0; i++) {
		size_t s = p->surfel[i];
		if (!e->counts[s])
			continue;
		double a = reflected(task->surfels, s, e->half[0] + 4 * i);
		double b = reflected(task->surfels, s, e->half[1] + 4 * i);
		double found = reflected(task->surfels, s, task->first + 4 * s) +
					   reflected(task->surfels, s, task->indirect + 4 * s);
		double off = (found - 0.5 * (a + b)) / mean, noise = 0.5 * (a - b) / mean;
		double excess = off * off - noise * noise;
		sum += off;
		square += excess;
		fourth += excess * excess;
		half += 2.0 * noise * noise;
		n += 1.0;
	}
	if (n < 2.0)
		return;
	double variance = fmax(fourth / n - square / n * (square / n), 0.0) / (n - 1.0);
	double rms = sqrt(fmax(square / n, 0.0));
	result->points = (uint32_t)n;
	result->relative_rms = result->gathered = rms;
	/* d sqrt(x) = dx / (2 sqrt(x)); at 0 the spread of x is all that is known. */
	result->spread = fmin(sqrt(variance) / (2.0 * rms), sqrt(sqrt(variance)));
	result->bias = sum / n;
	/* A point's light is a mean over records, each of which gathers like a half does. */
	double samples = fmin(task->rays, task->light_samples);
	result->noise = fmin(sqrt(half / n * (double)HALF_RAYS / samples / RECORDS_A_POINT), rms);
}

/* What the edges of lamps' shadows add, and noise of the normals. */
static gw_status add_lamps(const gw_estimate_task *task, const estimate *e, double mean,
						   gw_error_estimate *result, gw_error *error)
{
	double square;
	if (!task->direct || !(mean > 0.0))
		return GW_OK;
	gw_status status = gw_shadow_error(task->surfels, task->direct, e->counts,
									   gw_thread_count(task->threads), &square, error);
	result->shadows = status == GW_OK ? sqrt(square) / mean : 0.0;
	if (status == GW_OK && task->turned)
		result->normals =
			sqrt(gw_normal_error(task->surfels, task->direct, task->turned, e->counts)) / mean;
	result->relative_rms = hypot(result->gathered, hypot(result->shadows, result->normals));
	return status;
}

gw_status gw_estimate_error(const gw_estimate_task *task, gw_error_estimate *result,
							gw_error *error)
{
	estimate e = { 0 };
	gw_buffer radiance = { 0 };
	gw_emitters reflectors = { 0 };
	gw_status status = GW_OK;
	*result = (gw_error_estimate){ 0 };
	if (task->probes->count == 0)
		return GW_OK;
	e.counts = gw_allocate_array(task->surfels->count, sizeof *e.counts);
	if (!e.counts)
		return gw_fail(error, GW_ERROR_MEMORY, "no host memory for %zu points",
					   task->surfels->count);
	choose_points(task->surfels, e.counts);
	if (task->bounces)
		status = shade_all(task, &radiance, error);
	if (status == GW_OK && task->bounces)
		status =
			gw_emitters_make(task->passes->gpu, task->octree, &radiance, false, &reflectors, error);
	for (int half = 0; half < 2 && status == GW_OK; half++)
		status = gather_half(task, half, &reflectors, &e, error);
	double mean = status == GW_OK ? mean_radiance(task, e.counts) : 0.0;
	if (status == GW_OK)
		compare(task, &e, mean, result);
	if (status == GW_OK && result->points > 0)
		status = add_lamps(task, &e, mean, result, error);
	gw_emitters_destroy(task->passes->gpu, &reflectors);
	gw_buffer_destroy(task->passes->gpu, &radiance);
	free(e.half[0]);
	free(e.half[1]);
	free(e.counts);
	return status;
}

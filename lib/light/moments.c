/*
 * moments.c - see moments.h.
 */
#include "light/moments.h"

#include "base/memory.h"
#include "base/parallel.h"
#include "cloud/surfels.h"
#include "light/transport_layout.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define CHUNK 16384u /* surfels, or records, that a thread takes at a time */

static float dot(const float *a, const float *b)
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* ------------------------------------------------------------------- how far normals turn */

typedef struct turn {
	const gw_read_back *rows;
	const float *record_normal, *surfel_normal;
	double *sum; /* one a chunk: of squared sines */
} turn;

static void add_turns(void *user, size_t first, size_t last, uint32_t worker)
{
	const turn *t = user;
	const gw_read_back *rows = t->rows;
	double sum = 0.0;
	(void)worker;
	for (size_t i = first; i < last; i++) {
		for (uint32_t e = rows->first[i]; e < rows->first[i + 1]; e++) {
			float cosine =
				dot(t->surfel_normal + 3 * i, t->record_normal + 4 * (size_t)rows->record[e]);
			sum += (double)rows->weight[e] * fmax(0.0, 1.0 - (double)cosine * (double)cosine);
		}
	}
	t->sum[first / CHUNK] = sum;
}

double gw_read_back_turn(const gw_read_back *read_back, const float *record_normal,
						 const float *surfel_normal, uint32_t threads)
{
	size_t chunks = read_back->count / CHUNK + 1;
	double *sums = gw_allocate_zeros(chunks, sizeof *sums), sum = 0.0;
	turn t = { read_back, record_normal, surfel_normal, sums };
	if (!sums || read_back->count == 0) {
		free(sums);
		return 0.0;
	}
	gw_parallel_for(gw_thread_count(threads), read_back->count, CHUNK, add_turns, &t);
	for (size_t i = 0; i < chunks; i++)
		sum += sums[i];
	free(sums);
	return sqrt(sum / (double)read_back->count);
}

/* ------------------------------------------------------------------------------ read back */

/* A record's light, and its moment of each colour as a vector in the axes of the grid. */
typedef struct directed {
	float irradiance[3], normal[3], moment[3][3];
} directed;

typedef struct product {
	const gw_read_back *rows;
	const gw_directed_light *light;
	directed *record;
	float *surfels;
} product;

static void unfold(void *user, size_t first, size_t last, uint32_t worker)
{
	const product *p = user;
	const gw_directed_light *light = p->light;
	(void)worker;
	for (size_t r = first; r < last; r++) {
		directed *to = &p->record[r];
		const float *along = light->moment + 8 * r, *across = along + 4;
		float t[3], b[3];
		memcpy(to->irradiance, light->irradiance + 4 * r, sizeof to->irradiance);
		memcpy(to->normal, light->record_normal + 4 * r, sizeof to->normal);
		gw_tangent_frame(to->normal, t, b);
		for (int c = 0; c < 3; c++)
			for (int k = 0; k < 3; k++)
				to->moment[c][k] = along[c] * t[k] + across[c] * b[k];
	}
}

/* Adds what a record brings to a surfel of that normal. */
static void add_record(const directed *record, const float *normal, float weight, float sum[3])
{
	float cosine = dot(normal, record->normal);
	float sine = sqrtf(fmaxf(0.0f, 1.0f - cosine * cosine));
	float turned = fminf(1.0f, 1.0f / (GW_TANGENT_MOST * fmaxf(sine, 1e-6f)));
	if (cosine < 0.0f)
		turned = -turned;
	for (int c = 0; c < 3; c++)
		sum[c] += weight * (record->irradiance[c] + turned * dot(normal, record->moment[c]));
}

static void multiply(void *user, size_t first, size_t last, uint32_t worker)
{
	const product *p = user;
	const gw_read_back *rows = p->rows;
	(void)worker;
	for (size_t i = first; i < last; i++) {
		float sum[3] = { 0 };
		for (uint32_t e = rows->first[i]; e < rows->first[i + 1]; e++)
			add_record(&p->record[rows->record[e]], p->light->surfel_normal + 3 * i,
					   rows->weight[e], sum);
		for (int c = 0; c < 3; c++)
			p->surfels[4 * i + (size_t)c] = fmaxf(0.0f, sum[c]); /* of what rounding leaves */
		p->surfels[4 * i + 3] = 0.0f;
	}
}

gw_status gw_read_back_apply_directed(const gw_read_back *read_back, const gw_directed_light *light,
									  uint32_t threads, float *surfels, gw_error *error)
{
	product p = { read_back, light, gw_allocate_array(light->count, sizeof *p.record), surfels };
	if (!p.record)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the moments of %u records",
					   light->count);
	gw_parallel_for(gw_thread_count(threads), light->count, CHUNK, unfold, &p);
	gw_parallel_for(gw_thread_count(threads), read_back->count, CHUNK, multiply, &p);
	free(p.record);
	return GW_OK;
}

/*
 * shading_normals.c - see shading_normals.h.
 */
#include "normals/shading_normals.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

/* Variances of the noise by which normals that are alike differ: by the given ones, and by means of
 * those. Narrower keeps more noise, wider less detail; measured on a cave of facets of four points.
 */
#define GIVEN_WIDTH 3.0
#define MEAN_WIDTH 1.0

typedef struct lamp_step {
	const gw_surfels *surfels; /* with the normals that were given */
	const float *noise;        /* of each region */
	float *first, *second; /* 3 * count, means of those alike, by the given normals and by first */
	float *trace;          /* count, of the derivative of second by the normals */
	const gw_noisy_normals *given;
} lamp_step;

/* The normals around one, and how much each counts. */
typedef struct kernel {
	uint32_t count;
	const float *normal[GW_NEIGHBOURS + 1]; /* the given ones, its own first */
	uint32_t index[GW_NEIGHBOURS + 1];
	double sign[GW_NEIGHBOURS + 1], weight[GW_NEIGHBOURS + 1], total;
	double mean[3]; /* not of unit length */
} kernel;

static void weigh(const lamp_step *step, const float *normals, double width, size_t surfel,
				  const gw_neighbour_list *list, kernel *k)
{
	const gw_surfels *s = step->surfels;
	double reach = list->count ? (double)list->distance[list->count - 1] : 0;
	*k = (kernel){ 1, { s->normal + 3 * surfel }, { (uint32_t)surfel }, { 1 }, { 1 }, 1, { 0 } };
	for (uint32_t j = 0; j < list->count; j++) {
		size_t other = list->index[j];
		double sign, squared = 0, near = (double)list->distance[j] / reach;
		if (isnan(gw_normal_difference(s, surfel, other, &sign)))
			continue;
		for (size_t c = 0; c < 3; c++) {
			double d = sign * (double)normals[3 * other + c] - (double)normals[3 * surfel + c];
			squared += d * d;
		}
		k->normal[k->count] = s->normal + 3 * other;
		k->index[k->count] = list->index[j];
		k->sign[k->count] = sign;
		k->weight[k->count] = exp(-0.5 * squared / width - 2 * near * near);
		k->total += k->weight[k->count++];
	}
	for (uint32_t j = 0; j < k->count; j++)
		for (size_t c = 0; c < 3; c++)
			k->mean[c] += k->weight[j] * k->sign[j] * (double)k->normal[j][c] / k->total;
}

static void put_unit(const double from[3], float to[3])
{
	double length = sqrt(from[0] * from[0] + from[1] * from[1] + from[2] * from[2]);
	for (size_t c = 0; c < 3 && length > 0; c++)
		to[c] = (float)(from[c] / length);
}

static void join_alike(void *user, size_t surfel, const gw_neighbour_list *list)
{
	const lamp_step *step = user;
	double noise = (double)step->noise[surfel / GW_NOISE_REGION];
	for (size_t c = 0; c < 3; c++)
		step->first[3 * surfel + c] = step->surfels->normal[3 * surfel + c];
	if (!(noise > 0))
		return;
	kernel k;
	weigh(step, step->surfels->normal, GIVEN_WIDTH * noise, surfel, list, &k);
	put_unit(k.mean, step->first + 3 * surfel);
}

/*
 * Trace of the derivative of a mean by the surfel's own normal. That changes its own part in the
 * mean, 2 / total, and all weights, through the first mean a of itself: with a width h, weights w_j
 * and normals y_j, by sum (y_j - mean) (a_j - a)^T w_j / (total h) times da/dy, which is likewise
 * 1 / total + sum (y_j - a) (y_j - a)^T w_j / (total h) of the first kernel.
 */
static double trace_of(const lamp_step *step, double noise, const kernel *first,
					   const kernel *second)
{
	double turn[3][3] = { { 0 } }, change[3][3] = { { 0 } }, trace = 0;
	const float *own = step->first + 3 * (size_t)second->index[0];
	for (uint32_t j = 0; j < second->count; j++) {
		const float *a = step->first + 3 * (size_t)second->index[j];
		for (size_t r = 0; r < 3; r++) {
			double y = second->sign[j] * (double)second->normal[j][r];
			for (size_t c = 0; c < 3; c++) {
				double x = second->sign[j] * (double)second->normal[j][c];
				change[r][c] += first->weight[j] * (y - first->mean[r]) * (x - first->mean[c]);
				turn[r][c] += second->weight[j] * (y - second->mean[r]) *
							  (second->sign[j] * (double)a[c] - (double)own[c]);
			}
		}
	}
	for (size_t r = 0; r < 3; r++) {
		for (size_t c = 0; c < 3; c++)
			trace += turn[r][c] * change[c][r] / (first->total * GIVEN_WIDTH * noise);
		trace += turn[r][r] / first->total;
	}
	return (2 + trace / (MEAN_WIDTH * noise)) / second->total;
}

static void join_again(void *user, size_t surfel, const gw_neighbour_list *list)
{
	const lamp_step *step = user;
	double noise = (double)step->noise[surfel / GW_NOISE_REGION];
	kernel first, second;
	for (size_t c = 0; c < 3; c++)
		step->second[3 * surfel + c] = step->surfels->normal[3 * surfel + c];
	step->trace[surfel] = 2;
	if (!(noise > 0))
		return;
	weigh(step, step->surfels->normal, GIVEN_WIDTH * noise, surfel, list, &first);
	weigh(step, step->first, MEAN_WIDTH * noise, surfel, list, &second);
	put_unit(second.mean, step->second + 3 * surfel);
	step->trace[surfel] = (float)trace_of(step, noise, &first, &second);
}

/* Sums over a region, of squared differences unless said otherwise. */
typedef struct mixture {
	double noise; /* of the given normals, summed too */
	double smooth_trace, second_trace;
	double smooth, second, apart; /* mean and given, second and given, second and mean */
} mixture;

/* The share of the second mean in the mixture that leaves the least error, and that error. */
static double best_share(const mixture *m, size_t count, double *error)
{
	double v = m->noise / (double)count;
	/* |smooth + t (second - smooth) - y|^2 is a parabola in t. */
	double product = 0.5 * (m->second - m->smooth - m->apart);
	double slope = product + 0.5 * v * (m->second_trace - m->smooth_trace);
	double t = m->apart > 0 ? fmin(fmax(-slope / m->apart, 0), 1) : 0;
	double squared = m->smooth - m->noise + v * m->smooth_trace + t * (2 * slope + t * m->apart);
	*error = fmax(squared / (double)count, 0);
	return t;
}

static double squared_distance(const float *a, const float *b)
{
	double sum = 0;
	for (size_t c = 0; c < 3; c++)
		sum += ((double)a[c] - (double)b[c]) * ((double)a[c] - (double)b[c]);
	return sum;
}

static void mix_region(const lamp_step *step, size_t first, size_t last, float *normal, float *off)
{
	const float *smooth = step->given->smooth, *own = step->given->own;
	mixture m = { .noise = (double)step->noise[first / GW_NOISE_REGION] * (double)(last - first) };
	double error;
	for (size_t i = first; i < last; i++) {
		m.smooth_trace += 2 * (double)own[i];
		m.second_trace += (double)step->trace[i];
		m.smooth += squared_distance(smooth + 3 * i, normal + 3 * i);
		m.second += squared_distance(step->second + 3 * i, normal + 3 * i);
		m.apart += squared_distance(smooth + 3 * i, step->second + 3 * i);
	}
	double share = best_share(&m, last - first, &error);
	for (size_t i = first; i < last; i++) {
		double n[3];
		for (size_t c = 0; c < 3; c++)
			n[c] =
				share * (double)step->second[3 * i + c] + (1 - share) * (double)smooth[3 * i + c];
		put_unit(n, normal + 3 * i);
		off[i] = (float)sqrt(error);
	}
}

gw_status gw_shading_normals_make(gw_neighbours *search, gw_surfels *surfels,
								  const gw_noisy_normals *normals, float *off, gw_error *error)
{
	size_t n = surfels->count;
	float *second = gw_allocate_array(n, 3 * sizeof *second);
	lamp_step step = { surfels, normals->noise, normals->spare, second, off, normals };
	if (!second)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the normals of %zu noisy points", n);
	gw_status status = gw_neighbours_visit(search, join_alike, &step, error);
	if (status == GW_OK)
		status = gw_neighbours_visit(search, join_again, &step, error);
	for (size_t first = 0; first < n && status == GW_OK; first += GW_NOISE_REGION)
		mix_region(&step, first, n - first < GW_NOISE_REGION ? n : first + GW_NOISE_REGION,
				   surfels->normal, off);
	free(second);
	return status;
}

/*
 * normal_noise.c - see normal_noise.h.
 */
#include "normals/normal_noise.h"

#include "base/memory.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NEAR_RANKS 2u /* of the nearest neighbours, the first so many are near, */
#define FAR_RANK 5u   /* and this one, counted from 0, is far */
#define APART 4.0     /* least ratio of the means of both distributions */
#define ROUNDS 32     /* of expectation maximisation */

/* Differences are counted in bins of an eighth of an octave: the first bits of the float. */
#define BIN_SHIFT 20u
#define LEAST 0x1p-24f /* of a squared difference; rounding makes more than that */
#define BINS ((size_t)(26u << 3))

/* Of a surfel: squared differences of normals to near neighbours and a far one; below 0: none. */
typedef struct differences {
	float of[NEAR_RANKS + 1];
} differences;

typedef struct noise_step {
	const gw_surfels *surfels;
	differences *difference;
	float *near, *far; /* count, squared distances of these neighbours */
} noise_step;

typedef struct histogram {
	double count[BINS], sum[BINS];
} histogram;

double gw_normal_difference(const gw_surfels *s, size_t surfel, size_t other, double *sign)
{
	const float *n = s->normal + 3 * surfel, *m = s->normal + 3 * other;
	double cosine = 0, squared = 0;
	for (size_t k = 0; k < 3; k++)
		cosine += (double)n[k] * (double)m[k];
	*sign = cosine < 0 && (s->two_sided[surfel] || s->two_sided[other]) ? -1 : 1;
	for (size_t k = 0; k < 3; k++) {
		double d = (double)n[k] - *sign * (double)m[k];
		squared += d * d;
	}
	return *sign * cosine > GW_SAME_SURFACE ? squared : NAN;
}

static void compare_normals(void *user, size_t surfel, const gw_neighbour_list *list)
{
	const noise_step *step = user;
	float *of = step->difference[surfel].of;
	uint32_t count = 0;
	double sign;
	step->near[surfel] = step->far[surfel] = 0;
	of[0] = of[NEAR_RANKS] = -1;
	for (uint32_t j = 0; j < list->count && count <= FAR_RANK; j++) {
		double squared = gw_normal_difference(step->surfels, surfel, list->index[j], &sign);
		float distance = list->distance[j] * list->distance[j];
		if (isnan(squared))
			continue;
		if (count < NEAR_RANKS) {
			of[count] = (float)squared;
			step->near[surfel] += distance / NEAR_RANKS;
		} else if (count == FAR_RANK) {
			of[NEAR_RANKS] = (float)squared;
			step->far[surfel] = distance;
		}
		count++;
	}
}

static void add_to(histogram *h, float squared)
{
	uint32_t bits, least;
	const float start = LEAST;
	squared = fmaxf(squared, LEAST);
	memcpy(&bits, &squared, sizeof bits);
	memcpy(&least, &start, sizeof least);
	size_t bin = (bits - least) >> BIN_SHIFT;
	bin = bin < BINS ? bin : BINS - 1;
	h->count[bin] += 1;
	h->sum[bin] += (double)squared;
}

/* Mean of the narrower of the two exponential distributions that make up a histogram. */
static double narrow_mean(const histogram *h)
{
	double count = 0, sum = 0;
	for (size_t b = 0; b < BINS; b++) {
		count += h->count[b];
		sum += h->sum[b];
	}
	double share = 0.5, narrow = 0.25 * sum / count, wide = 2 * sum / count;
	for (int round = 0; round < ROUNDS && count > 0; round++) {
		double weight = 0, of_narrow = 0;
		for (size_t b = 0; b < BINS; b++) {
			if (h->count[b] == 0)
				continue;
			double x = h->sum[b] / h->count[b];
			double a = share / narrow * exp(-x / narrow);
			double part = a / (a + (1 - share) / wide * exp(-x / wide));
			weight += part * h->count[b];
			of_narrow += part * h->sum[b];
		}
		share = fmin(weight / count, 1 - DBL_EPSILON);
		narrow = of_narrow / weight;
		wide = fmax((sum - of_narrow) / fmax(count - weight, DBL_MIN), APART * narrow);
	}
	return count > 0 ? narrow : 0;
}

/* Where all is flat, both distances say the same. */
static float noise_of(const noise_step *step, size_t first, size_t last)
{
	histogram near = { 0 }, far = { 0 };
	double near_distance = 0, far_distance = 0;
	for (size_t i = first; i < last; i++) {
		const float *of = step->difference[i].of;
		if (of[0] < 0 || of[NEAR_RANKS] < 0)
			continue;
		for (uint32_t j = 0; j < NEAR_RANKS; j++)
			add_to(&near, of[j]);
		add_to(&far, of[NEAR_RANKS]);
		near_distance += (double)step->near[i];
		far_distance += (double)step->far[i];
	}
	double a = narrow_mean(&near), b = narrow_mean(&far);
	double shape =
		far_distance > near_distance ? fmax(b - a, 0) / (far_distance - near_distance) : 0;
	return (float)(0.5 * fmax(a - shape * near_distance, 0));
}

gw_status gw_normal_noise(gw_neighbours *search, const gw_surfels *surfels, float *noise,
						  float *spare, gw_error *error)
{
	size_t n = surfels->count;
	float *distance = gw_allocate_array(n, 2 * sizeof *distance);
	static_assert(sizeof(differences) == 3 * sizeof(float), "spare has room for these");
	if (!distance)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to compare the normals of %zu points", n);
	noise_step step = { surfels, (differences *)spare, distance, distance + n };
	gw_status status = gw_neighbours_visit(search, compare_normals, &step, error);
	for (size_t first = 0; first < n && status == GW_OK; first += GW_NOISE_REGION)
		noise[first / GW_NOISE_REGION] =
			noise_of(&step, first, n - first < GW_NOISE_REGION ? n : first + GW_NOISE_REGION);
	/* What is left over may be too few to tell. */
	if (n > GW_NOISE_REGION && n % GW_NOISE_REGION > 0 && n % GW_NOISE_REGION < GW_NOISE_REGION / 8)
		noise[n / GW_NOISE_REGION] = noise[n / GW_NOISE_REGION - 1];
	free(distance);
	return status;
}

/*
 * surfel_smooth.c - the surface behind noisy points.
 *
 * A scanner's noise moves points along the normal, and what rays are to meet is the surface that
 * they scatter around: each normal becomes the mean of the normals around it, and each point moves
 * along that to the mean height of the points around it. Heights are taken along the mean of both
 * points' normals; they are 0 between any two points of a circle, so that curved surfaces neither
 * shrink nor count as noise.
 *
 * What lamps shine on is finer than that surface: shading_normals.c.
 */
#include "surfels/surfel_smooth.h"

#include "base/memory.h"
#include "base/nth_element.h"
#include "normals/shading_normals.h"

#include <math.h>
#include <stdlib.h>

#define NOISE_RANK 6     /* of so many nearest neighbours, the median height tells the noise */
#define NOISE_SHARE 0.75 /* that median of Gaussian noise, in standard deviations (measured) */
#define NOISE_LEAST 0.05 /* spacings of noise up to which points stay where they are */
#define NOISE_MUCH 0.1   /* spacings from which on they are moved all the way */
#define SPREAD 0.443     /* sqrt(pi / 16): spacings in the distance to the 16th neighbour */
#define SLAB 5.0         /* most height of a neighbour, in standard deviations of the noise */
#define ROUNDS 2         /* of moving points; each reaches further */
#define REGION GW_NOISE_REGION

typedef struct smooth_step {
	gw_surfels *surfels;
	const float *position, *normal; /* as they are */
	const float *level;             /* noise of each region, in spacings */
	const uint8_t *filled; /* 1: a point that fills space, which has no surface behind it */
	float *out;            /* what the step makes of them */
	float *noise;          /* NULL or count, metres, RMS distance to the mean height */
	float *own;            /* count, share of the surfel's own normal in the mean normal */
} smooth_step;

/*
 * Height of a neighbour over the surface at the surfel, metres; NAN when their normals are too
 * different. The sign of an unoriented neighbour's normal is made to fit.
 */
static double height_of(const smooth_step *step, size_t surfel, size_t other, double *sign)
{
	const float *n = step->normal + 3 * surfel, *m = step->normal + 3 * other;
	const uint8_t *two_sided = step->surfels->two_sided;
	double cosine = 0, height = 0;
	for (size_t k = 0; k < 3; k++)
		cosine += (double)n[k] * (double)m[k];
	*sign = cosine < 0 && (two_sided[surfel] || two_sided[other]) ? -1 : 1;
	if (!(*sign * cosine > GW_SAME_SURFACE))
		return NAN;
	for (size_t k = 0; k < 3; k++) {
		double d = (double)step->position[3 * other + k] - (double)step->position[3 * surfel + k];
		height += 0.5 * ((double)n[k] + *sign * (double)m[k]) * d;
	}
	return height;
}

static double reach_of(const gw_neighbour_list *list)
{
	return list->count ? (double)list->distance[list->count - 1] : 0;
}

/* Share by which a surfel is moved; 0 where it is clean. */
static double share_of(const smooth_step *step, size_t surfel)
{
	double level = step->filled[surfel] ? 0 : (double)step->level[surfel / REGION];
	return fmin(fmax((level - NOISE_LEAST) / (NOISE_MUCH - NOISE_LEAST), 0), 1);
}

static double slab_of(const smooth_step *step, size_t surfel, const gw_neighbour_list *list)
{
	return SLAB * (double)step->level[surfel / REGION] * SPREAD * reach_of(list);
}

/* Noise at one surfel in spacings, from its few nearest neighbours on the surface: further away
 * heights come from the surface's shape too. */
static void measure_noise(void *user, size_t surfel, const gw_neighbour_list *list)
{
	const smooth_step *step = user;
	double nearest[NOISE_RANK], sign;
	uint32_t count = 0;
	for (uint32_t j = 0; j < list->count && count < NOISE_RANK; j++) {
		double height = fabs(height_of(step, surfel, list->index[j], &sign));
		if (isnan(height))
			continue;
		uint32_t at = count++;
		for (; at > 0 && height < nearest[at - 1]; at--)
			nearest[at] = nearest[at - 1];
		nearest[at] = height;
	}
	bool known = count == NOISE_RANK && list->count == GW_NEIGHBOURS && !step->filled[surfel];
	double height = known ? nearest[(NOISE_RANK - 1) / 2] : 0;
	step->out[surfel] = height > 0 ? (float)(height / (NOISE_SHARE * SPREAD * reach_of(list))) : 0;
}

static void turn_normal(void *user, size_t surfel, const gw_neighbour_list *list)
{
	const smooth_step *step = user;
	const float *n = step->normal + 3 * surfel;
	double sum[3] = { (double)n[0], (double)n[1], (double)n[2] }, sign;
	double share = share_of(step, surfel), slab = slab_of(step, surfel, list), weight = 1;
	for (uint32_t j = 0; j < list->count && share > 0; j++) {
		size_t other = list->index[j];
		if (!(fabs(height_of(step, surfel, other, &sign)) <= slab))
			continue;
		weight += share;
		for (size_t k = 0; k < 3; k++)
			sum[k] += share * sign * (double)step->normal[3 * other + k];
	}
	double length = sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
	for (size_t k = 0; k < 3; k++)
		step->out[3 * surfel + k] = share > 0 ? (float)(sum[k] / length) : n[k];
	step->own[surfel] = (float)(1 / weight);
}

static void move_point(void *user, size_t surfel, const gw_neighbour_list *list)
{
	const smooth_step *step = user;
	const float *p = step->position + 3 * surfel, *n = step->normal + 3 * surfel;
	double share = share_of(step, surfel), slab = slab_of(step, surfel, list), sign;
	double sum = 0, squares = 0;
	uint32_t count = 1; /* itself, at 0 */
	for (uint32_t j = 0; j < list->count; j++) {
		double height = height_of(step, surfel, list->index[j], &sign);
		if (!(fabs(height) <= slab))
			continue;
		sum += height;
		squares += height * height;
		count++;
	}
	if (step->noise)
		step->noise[surfel] = (float)sqrt((squares - sum * sum / count) / fmax(count - 1, 1));
	/* Bounds stay those of the points as they were. */
	double way = share > 0 ? share * sum / count : 0;
	const float *low = step->surfels->minimum, *high = step->surfels->maximum;
	for (size_t k = 0; k < 3; k++) {
		float moved = (float)((double)p[k] + way * (double)n[k]);
		step->out[3 * surfel + k] = way != 0 ? fminf(fmaxf(moved, low[k]), high[k]) : p[k];
	}
}

/* Medians of the surfels' noise by region; returns whether any calls for smoothing. */
static bool find_levels(const float *noise, size_t count, float *level)
{
	bool noisy = false;
	for (size_t first = 0; first < count; first += REGION) {
		size_t length = count - first < REGION ? count - first : REGION;
		level[first / REGION] = gw_nth_element(noise + first, length, length / 2);
		noisy = noisy || (double)level[first / REGION] > NOISE_LEAST;
	}
	return noisy;
}

/* --------------------------------------------------------------------------------- all of it */

/* `a` and `b` are 3 * count floats to work in; both stay the caller's. */
static gw_status smooth(gw_neighbours *search, smooth_step *step, float **a, float **b,
						float *normal, gw_error *error)
{
	step->out = normal;
	GW_TRY(gw_neighbours_visit_reach(search, turn_normal, step, error));
	step->normal = normal;
	for (int round = 0; round < ROUNDS; round++) {
		float *swap = *a;
		step->out = *b;
		GW_TRY(gw_neighbours_visit_reach(search, move_point, step, error));
		step->position = *b;
		step->noise = NULL;
		*a = *b;
		*b = swap;
	}
	return GW_OK;
}

/*
 * What lamps shine on, into surfels->normal and shading_normal_off; `level` and `spare` are to work
 * in. What is known of estimated normals stays: their noise is not their own, so that means of them
 * do not lessen it.
 */
static gw_status clean_normals(gw_neighbours *search, gw_surfels *s,
							   const gw_noisy_normals *normals, gw_error *error)
{
	float *off = gw_allocate_array(s->count, sizeof *off);
	if (!off)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the noise of %zu points", s->count);
	gw_status status = gw_normal_noise(search, s, normals->noise, normals->spare, error);
	if (status == GW_OK)
		status = gw_shading_normals_make(search, s, normals, off, error);
	for (size_t i = 0; i < s->count && s->shading_normal_off; i++)
		off[i] = s->shading_normal_off[i] > 0 ? s->shading_normal_off[i] : off[i];
	free(s->shading_normal_off);
	s->shading_normal_off = off;
	return status;
}

gw_status gw_surfels_smooth(const gw_surfels_options *options, gw_neighbours *search,
							const uint8_t *filled, gw_surfels *surfels, bool *smoothed,
							gw_error *error)
{
	const uint32_t effect = 1u << GW_EFFECT_NOISE;
	size_t n = surfels->count;
	*smoothed = false;
	if (options->effects_forbidden & effect)
		return GW_OK;
	float *position = gw_allocate_array(n, 3 * sizeof *position), *spare = NULL, *normal = NULL;
	float *level = gw_allocate_array(n / REGION + 1, sizeof *level);
	smooth_step step = { .surfels = surfels,
						 .position = surfels->position,
						 .normal = surfels->normal,
						 .level = level,
						 .filled = filled,
						 .out = position };
	gw_status status = GW_OK;
	if (!position || !level)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory for the noise of %zu points", n);
	if (status == GW_OK)
		status = gw_neighbours_visit_reach(search, measure_noise, &step, error);
	if (status == GW_OK && (find_levels(position, n, level) || options->effects_forced & effect)) {
		spare = gw_allocate_array(n, 3 * sizeof *spare);
		normal = gw_allocate_array(n, 3 * sizeof *normal);
		step.own = gw_allocate_array(n, sizeof *step.own);
		step.noise = surfels->noise = gw_allocate_array(n, sizeof *surfels->noise);
		status = spare && normal && step.own && surfels->noise
					 ? smooth(search, &step, &position, &spare, normal, error)
					 : gw_fail(error, GW_ERROR_MEMORY, "no memory to smooth %zu points", n);
		const gw_noisy_normals normals = { normal, step.own, level, spare };
		if (status == GW_OK)
			status = clean_normals(search, surfels, &normals, error);
		*smoothed = status == GW_OK;
	}
	if (*smoothed) {
		surfels->shading_normal = surfels->normal;
		surfels->normal = normal;
		normal = surfels->position;
		surfels->position = position;
		position = NULL;
	}
	free(level);
	free(step.own);
	free(position);
	free(spare);
	free(normal);
	return status;
}

/*
 * surfel_smooth.c - the surface behind noisy points; see surfel_steps.h.
 *
 * A scanner's noise moves points along the normal, and what rays are to meet is the surface that
 * they scatter around: each normal becomes the mean of the normals around it, and each point moves
 * along that to the mean height of the points around it. Heights are taken along the mean of both
 * points' normals; they are 0 between any two points of a circle, so that curved surfaces neither
 * shrink nor count as noise.
 *
 * What lamps shine on is finer than that surface: each normal is replaced by the mean of those
 * around it that differ by no more than noise may, as far as that is not noise itself.
 */
#include "surfel_steps.h"

#include "memory.h"

#include <math.h>
#include <stdlib.h>

#define SAME_SURFACE 0.6 /* least cosine between normals */
#define NOISE_RANK 6     /* of so many nearest neighbours, the median height tells the noise */
#define NOISE_SHARE 0.75 /* that median of Gaussian noise, in standard deviations (measured) */
#define NOISE_LEAST 0.05 /* spacings of noise up to which points stay where they are */
#define NOISE_MUCH 0.1   /* spacings from which on they are moved all the way */
#define SPREAD 0.443     /* sqrt(pi / 16): spacings in the distance to the 16th neighbour */
#define SLAB 5.0         /* most height of a neighbour, in standard deviations of the noise */
#define ROUNDS 2         /* of moving points; each reaches further */
#define ALIKE_NOISE                                                                                \
	0.165            /* of normals that differ by noise alone: variance of the mean of those       \
						alike around the mean of all 17, in variances of one (measured) */
#define REGION 4096u /* surfels, next to each other in Morton order, with noise in common */

typedef struct smooth_step {
	gw_surfels *surfels;
	const float *position, *normal; /* as they are */
	const float *level;             /* noise of each region, in spacings */
	float *out;                     /* what the step makes of them */
	float *noise;                   /* NULL or count, metres, RMS distance to the mean height */
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
	if (!(*sign * cosine > SAME_SURFACE))
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
	double level = (double)step->level[surfel / REGION];
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
	bool known = count == NOISE_RANK && list->count == GW_NEIGHBOURS;
	double height = known ? nearest[(NOISE_RANK - 1) / 2] : 0;
	step->out[surfel] = height > 0 ? (float)(height / (NOISE_SHARE * SPREAD * reach_of(list))) : 0;
}

static void turn_normal(void *user, size_t surfel, const gw_neighbour_list *list)
{
	const smooth_step *step = user;
	const float *n = step->normal + 3 * surfel;
	double sum[3] = { (double)n[0], (double)n[1], (double)n[2] }, sign;
	double share = share_of(step, surfel), slab = slab_of(step, surfel, list);
	for (uint32_t j = 0; j < list->count && share > 0; j++) {
		size_t other = list->index[j];
		if (!(fabs(height_of(step, surfel, other, &sign)) <= slab))
			continue;
		for (size_t k = 0; k < 3; k++)
			sum[k] += share * sign * (double)step->normal[3 * other + k];
	}
	double length = sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
	for (size_t k = 0; k < 3; k++)
		step->out[3 * surfel + k] = share > 0 ? (float)(sum[k] / length) : n[k];
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
		level[first / REGION] = gw_rank_float(noise + first, length, length / 2);
		noisy = noisy || (double)level[first / REGION] > NOISE_LEAST;
	}
	return noisy;
}

/* ----------------------------------------------------------------------------- lamps' normals */

typedef struct normal_step {
	const gw_surfels *surfels; /* with the normals that were given */
	const float *smooth;       /* 3 * count, the mean normals */
	float *noise;              /* of each surfel, then of each region: variance of the given normals
								  by noise, rad^2; of a surfel any sign */
	float *alike;              /* 3 * count, the mean of the normals that differ by little */
} normal_step;

/* Squared difference of two normals; NAN where the surfaces are different. The sign of an
 * unoriented neighbour's normal is made to fit. */
static double difference_of(const gw_surfels *s, size_t surfel, size_t other, double *sign)
{
	const float *n = s->normal + 3 * surfel, *m = s->normal + 3 * other;
	double cosine = 0;
	for (size_t k = 0; k < 3; k++)
		cosine += (double)n[k] * (double)m[k];
	*sign = cosine < 0 && (s->two_sided[surfel] || s->two_sided[other]) ? -1 : 1;
	return *sign * cosine > SAME_SURFACE ? 2 - 2 * *sign * cosine : NAN;
}

/*
 * Squared differences between a normal and those around it, by distance: what is left of them at no
 * distance is noise, twice. A line through them finds it; where normals turn steadily, as they do
 * on curved surfaces, that is too little rather than too much.
 */
static void compare_normals(void *user, size_t surfel, const gw_neighbour_list *list)
{
	const normal_step *step = user;
	double count = 0, x = 0, y = 0, xx = 0, xy = 0, sign;
	for (uint32_t j = 0; j < list->count; j++) {
		double distance = (double)list->distance[j] / reach_of(list);
		double difference = difference_of(step->surfels, surfel, list->index[j], &sign);
		if (isnan(difference))
			continue;
		count += 1;
		x += distance;
		y += difference;
		xx += distance * distance;
		xy += distance * difference;
	}
	double determinant = count * xx - x * x;
	bool known = count == GW_NEIGHBOURS && determinant > 0;
	step->noise[surfel] = known ? (float)(0.5 * (y * xx - x * xy) / determinant) : 0;
}

/* The mean of the normals around one, those that differ by more than noise counting little: it
 * keeps edges and small shapes (a bilateral filter). */
static void join_alike(void *user, size_t surfel, const gw_neighbour_list *list)
{
	const normal_step *step = user;
	const float *n = step->surfels->normal + 3 * surfel;
	double noise = (double)step->noise[surfel / REGION];
	double sum[3] = { (double)n[0], (double)n[1], (double)n[2] }, sign;
	for (uint32_t j = 0; j < list->count && noise > 0; j++) {
		const float *m = step->surfels->normal + 3 * (size_t)list->index[j];
		double difference = difference_of(step->surfels, surfel, list->index[j], &sign);
		double weight = isnan(difference) ? 0 : sign * exp(-0.5 * difference / noise);
		for (size_t k = 0; k < 3; k++)
			sum[k] += weight * (double)m[k];
	}
	double length = sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
	for (size_t k = 0; k < 3; k++)
		step->alike[3 * surfel + k] = (float)(sum[k] / length);
}

/* The share of the difference between both means that is not noise, in a region. */
static double share_of_detail(const normal_step *step, size_t first, size_t last)
{
	double spread = 0, noise = ALIKE_NOISE * (double)step->noise[first / REGION];
	for (size_t i = 3 * first; i < 3 * last; i++) {
		double difference = (double)step->alike[i] - (double)step->smooth[i];
		spread += difference * difference;
	}
	spread /= (double)(last - first);
	return spread > noise ? 1 - noise / spread : 0;
}

/*
 * Takes noise out of the given normals.
 *   smooth   the mean normals
 *   level    one a region to work in
 *   work     3 * count floats to work in
 */
static gw_status clean_normals(gw_neighbours *search, gw_surfels *s, const float *smooth,
							   float *level, float *work, gw_error *error)
{
	normal_step step = { s, smooth, work, work };
	gw_status status = gw_neighbours_visit(search, compare_normals, &step, error);
	for (size_t first = 0; first < s->count && status == GW_OK; first += REGION) {
		size_t last = first + REGION < s->count ? first + REGION : s->count;
		double sum = 0;
		for (size_t i = first; i < last; i++)
			sum += (double)step.noise[i];
		level[first / REGION] = (float)fmax(sum / (double)(last - first), 0);
	}
	step.noise = level;
	if (status == GW_OK)
		status = gw_neighbours_visit(search, join_alike, &step, error);
	for (size_t first = 0; first < s->count && status == GW_OK; first += REGION) {
		size_t last = first + REGION < s->count ? first + REGION : s->count;
		double detail = share_of_detail(&step, first, last);
		for (size_t i = first; i < last; i++) {
			double n[3];
			for (size_t k = 0; k < 3; k++)
				n[k] = detail * (double)step.alike[3 * i + k] +
					   (1 - detail) * (double)smooth[3 * i + k];
			double size = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
			for (size_t k = 0; k < 3 && size > 0; k++)
				s->normal[3 * i + k] = (float)(n[k] / size);
		}
	}
	return status;
}

/* --------------------------------------------------------------------------------- all of it */

/* `a` and `b` are 3 * count floats to work in; both stay the caller's. */
static gw_status smooth(gw_neighbours *search, smooth_step *step, float **a, float **b,
						float *normal, gw_error *error)
{
	step->out = normal;
	gw_status status = gw_neighbours_visit(search, turn_normal, step, error);
	step->normal = normal;
	for (int round = 0; round < ROUNDS && status == GW_OK; round++) {
		float *swap = *a;
		step->out = *b;
		status = gw_neighbours_visit(search, move_point, step, error);
		step->position = *b;
		step->noise = NULL;
		*a = *b;
		*b = swap;
	}
	return status;
}

gw_status gw_surfels_smooth(gw_neighbours *search, gw_surfels *surfels, bool *smoothed,
							gw_error *error)
{
	size_t n = surfels->count;
	float *position = gw_allocate_array(n, 3 * sizeof *position), *spare = NULL, *normal = NULL;
	float *level = gw_allocate_array(n / REGION + 1, sizeof *level);
	smooth_step step = { surfels, surfels->position, surfels->normal, level, position, NULL };
	gw_status status = GW_OK;
	*smoothed = false;
	if (!position || !level)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory for the noise of %zu points", n);
	if (status == GW_OK)
		status = gw_neighbours_visit(search, measure_noise, &step, error);
	if (status == GW_OK && find_levels(position, n, level)) {
		spare = gw_allocate_array(n, 3 * sizeof *spare);
		normal = gw_allocate_array(n, 3 * sizeof *normal);
		step.noise = surfels->noise = gw_allocate_array(n, sizeof *surfels->noise);
		status = spare && normal && surfels->noise
					 ? smooth(search, &step, &position, &spare, normal, error)
					 : gw_fail(error, GW_ERROR_MEMORY, "no memory to smooth %zu points", n);
		if (status == GW_OK)
			status = clean_normals(search, surfels, normal, level, spare, error);
		*smoothed = status == GW_OK;
	}
	if (*smoothed) {
		surfels->lamp_normal = surfels->normal;
		surfels->normal = normal;
		normal = surfels->position;
		surfels->position = position;
		position = NULL;
	}
	free(level);
	free(position);
	free(spare);
	free(normal);
	return status;
}

/* scan_intensity.c - range and angle taken out of a laser's intensity; see scan_intensity.h. */
#include "points/scan_intensity.h"

#include "glowworm_picture.h"
#include "points/scan_color.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BINS 48           /* of the logarithm of what intensity may depend on */
#define BINS_A_DOUBLING 4 /* of a range */
#define BIN_LEAST 0.005   /* share of the points that a bin needs to count */
#define SLOPE_LEAST 0.3   /* powers below this are the surface's own */
#define RANGE_MOST 2.0    /* power with which light falls */
#define ANGLE_MOST 1.0    /* of a matt surface */
#define COSINE_LEAST 0.1  /* flatter beams are taken as this */

static void swap_floats(float *a, float *b)
{
	float kept = *a;
	*a = *b;
	*b = kept;
}

/* The value that would stand at `rank` if the values were sorted (Hoare's selection, without NaN).
 */
static float select_rank(float *value, ptrdiff_t count, ptrdiff_t rank)
{
	ptrdiff_t low = 0, high = count - 1;
	while (low < high) {
		float pivot = value[rank];
		ptrdiff_t i = low, j = high;
		while (i <= j) {
			while (value[i] < pivot)
				i++;
			while (value[j] > pivot)
				j--;
			if (i <= j)
				swap_floats(&value[i++], &value[j--]);
		}
		if (j < rank)
			low = i;
		if (rank < i)
			high = j;
	}
	return value[rank];
}

float scan_intensity_full(float *value, size_t count)
{
	ptrdiff_t finite = 0;
	for (size_t i = 0; i < count; i++)
		if (isfinite(value[i]))
			value[finite++] = value[i];
	return finite > 0 ? select_rank(value, finite, finite - 1 - finite / 100) : 0.0f;
}

/* ------------------------------------------------------------------------------------- powers */

/*
 * The power with which values go with x, by the means of logarithms in bins of log2 x: each bin
 * counts the same, so that where most points are does not decide it.
 */
static double fit_power(const float *value, const float *x, size_t count, double per_doubling)
{
	double number[BINS] = { 0 }, mean[BINS] = { 0 }, place[BINS] = { 0 }, all = 0;
	for (size_t i = 0; i < count; i++) {
		if (!(value[i] > 0.0f) || !(x[i] > 0.0f) || !isfinite(value[i]) || !isfinite(x[i]))
			continue;
		double doublings = log2((double)x[i]);
		int bin = (int)fmin(fmax(doublings * per_doubling + BINS / 2.0, 0), BINS - 1);
		number[bin]++;
		mean[bin] += log2((double)value[i]);
		place[bin] += doublings;
		all++;
	}
	double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
	for (int b = 0; b < BINS; b++) {
		if (!(number[b] > BIN_LEAST * all))
			continue;
		double px = place[b] / number[b], py = mean[b] / number[b];
		n++;
		sx += px;
		sy += py;
		sxx += px * px;
		sxy += px * py;
	}
	double spread = n * sxx - sx * sx;
	/* Two bins are no line. */
	return n >= 3 && spread > 0 ? (n * sxy - sx * sy) / spread : 0;
}

/* Divides a power of x out; x of 1 stays. */
static void take_out(float *value, const float *x, size_t count, double power)
{
	for (size_t i = 0; i < count; i++)
		if (x[i] > 0.0f && isfinite(x[i]))
			value[i] = (float)((double)value[i] / pow((double)x[i], power));
}

/* ------------------------------------------------------------------------------ range and angle */

typedef struct beams {
	const scan *cloud;
	double *position; /* 3 * count */
	float *normal;    /* 3 * count; zeros where unknown */
	float *range;     /* in the middle one */
	float *cosine;    /* NAN where unknown */
} beams;

static bool direction_of(const beams *b, size_t i, double way[3])
{
	const scan *cloud = b->cloud;
	uint32_t scanner = cloud->scanner_of ? cloud->scanner_of[i] : 0;
	for (size_t k = 0; k < 3 && scanner < cloud->scanner_count; k++)
		way[k] = cloud->scanner[3 * (size_t)scanner + k] - b->position[3 * i + k];
	return scanner < cloud->scanner_count;
}

static gw_status find_normals(beams *b, uint32_t threads, gw_error *error)
{
	static const char *const names[3] = { "nx", "ny", "nz" };
	const scan_column *column[3];
	size_t count = b->cloud->count;
	if (scan_find_triple(b->cloud, names, column)) {
		for (size_t i = 0; i < 3 * count; i++)
			b->normal[i] = (float)scan_value(column[i % 3], i / 3);
		return GW_OK;
	}
	gw_points points = { .count = count, .position = b->position };
	gw_surfels_options options = { .threads = threads };
	gw_surfels s;
	gw_status status = gw_surfels_make(&points, &options, &s, error);
	for (size_t i = 0; i < count && status == GW_OK; i++)
		for (size_t k = 0; k < 3 && s.surfel_of_point[i] != UINT32_MAX; k++)
			b->normal[3 * i + k] = s.normal[3 * (size_t)s.surfel_of_point[i] + k];
	if (status == GW_OK)
		gw_surfels_clear(&s);
	return status;
}

static void measure_beams(beams *b)
{
	double sum = 0;
	size_t count = b->cloud->count, known = 0;
	for (size_t i = 0; i < count; i++) {
		double way[3] = { 0 }, along = 0, length = 0, size = 0;
		b->range[i] = b->cosine[i] = NAN;
		if (!direction_of(b, i, way))
			continue;
		for (size_t k = 0; k < 3; k++) {
			double n = (double)b->normal[3 * i + k];
			along += way[k] * n;
			length += way[k] * way[k];
			size += n * n;
		}
		if (!(length > 0) || !isfinite(length))
			continue;
		b->range[i] = (float)sqrt(length);
		if (size > 0)
			b->cosine[i] = (float)fmax(fabs(along) / sqrt(length * size), COSINE_LEAST);
		sum += log(sqrt(length));
		known++;
	}
	float middle = known ? (float)exp(sum / (double)known) : 1.0f;
	for (size_t i = 0; i < count; i++)
		b->range[i] /= middle;
}

/* Of range and angle what the intensity falls by; nothing where it falls by neither. */
static void say_fall(double range, double angle, char how[120])
{
	char of_range[48] = "", of_angle[48] = "";
	if (range > 0)
		snprintf(of_range, sizeof of_range, "the power %.2g of range", range);
	if (angle > 0)
		snprintf(of_angle, sizeof of_angle, "the power %.2g of cosine", angle);
	if (range > 0 || angle > 0)
		snprintf(how, 120, "without its fall by %s%s%s", of_range,
				 range > 0 && angle > 0 ? " and " : "", of_angle);
}

static void correct(const beams *b, float *value, char how[120])
{
	size_t count = b->cloud->count;
	double range = fit_power(value, b->range, count, BINS_A_DOUBLING);
	range = range < -SLOPE_LEAST ? fmax(range, -RANGE_MOST) : 0;
	take_out(value, b->range, count, range);
	double angle = fit_power(value, b->cosine, count, 2.0 * BINS_A_DOUBLING);
	angle = angle > SLOPE_LEAST ? fmin(angle, ANGLE_MOST) : 0;
	take_out(value, b->cosine, count, angle);
	say_fall(-range, angle, how);
}

static gw_status see_beams(beams *b, const scan_column *const place[3], uint32_t threads,
						   float *value, char how[120], gw_error *error)
{
	size_t count = b->cloud->count;
	if (!b->position || !b->normal || !b->range || !b->cosine)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu intensities", count);
	for (size_t i = 0; i < 3 * count; i++)
		b->position[i] = scan_value(place[i % 3], i / 3);
	GW_TRY(find_normals(b, threads, error));
	measure_beams(b);
	correct(b, value, how);
	return GW_OK;
}

gw_status scan_intensity_make(const scan *cloud, uint32_t threads, float **value, char how[120],
							  gw_error *error)
{
	static const char *const names[3] = { "x", "y", "z" };
	const scan_column *column = scan_find_scalar(cloud, "intensity"), *place[3];
	size_t count = cloud->count;
	how[0] = '\0';
	*value = NULL;
	if (!column)
		return gw_fail(error, GW_ERROR_USAGE,
					   "the albedo shall come from the intensity, but the points have none");
	*value = reallocarray(NULL, count, sizeof **value);
	if (!*value)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu intensities", count);
	for (size_t i = 0; i < count; i++)
		(*value)[i] = (float)scan_value(column, i);
	if (cloud->scanner_count == 0 || !scan_find_triple(cloud, names, place))
		return GW_OK;
	beams b = { cloud, reallocarray(NULL, count, 3 * sizeof *b.position),
				calloc(count, 3 * sizeof *b.normal), reallocarray(NULL, count, sizeof *b.range),
				reallocarray(NULL, count, sizeof *b.cosine) };
	gw_status status = see_beams(&b, place, threads, *value, how, error);
	free(b.position);
	free(b.normal);
	free(b.range);
	free(b.cosine);
	return status;
}

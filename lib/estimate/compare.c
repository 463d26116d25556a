#include "glowworm_picture.h"
#include "glowworm_host.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---------------------------------------------------------------------------------- figures */

static int by_value(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

/* Sum with the rounding errors of each step carried along (Neumaier 1974), so that millions of
 * points lose nothing. */
typedef struct exact_sum {
	double sum, rest;
} exact_sum;

static void add(exact_sum *s, double value)
{
	double total = s->sum + value;
	bool larger = fabs(s->sum) >= fabs(value);
	s->rest += larger ? (s->sum - total) + value : (value - total) + s->sum;
	s->sum = total;
}

static double mean_of(const double *value, size_t count)
{
	exact_sum s = { 0 };
	for (size_t i = 0; i < count; i++)
		add(&s, value[i]);
	return (s.sum + s.rest) / (double)count;
}

/* Root of the mean square of the first `count` values, which are sorted: the largest scales the
 * others, so that no square overflows. */
static double root_mean_square(const double *sorted, size_t count)
{
	double largest = sorted[count - 1];
	exact_sum s = { 0 };
	if (!(largest > 0.0))
		return 0.0;
	for (size_t i = 0; i < count; i++)
		add(&s, sorted[i] / largest * (sorted[i] / largest));
	return largest * sqrt((s.sum + s.rest) / (double)count);
}

/* The smallest value that at least `share` of all do not exceed. */
static double percentile(const double *sorted, size_t count, double share)
{
	double rank = ceil(share * (double)count);
	return sorted[rank < 1.0 ? 0 : (size_t)rank - 1];
}

/* A difference as a share of the truth's mean. */
static double share_of(double difference, double mean)
{
	return difference == 0.0 ? 0.0 : difference / fabs(mean);
}

static void fill(const double *sorted, gw_comparison *c)
{
	size_t n = (size_t)c->points;
	double mean = c->truth_mean;
	c->rel_rmse = share_of(root_mean_square(sorted, n), mean);
	c->best_99 = share_of(root_mean_square(sorted, n - n / GW_COMPARE_WORST), mean);
	c->bias = share_of(c->mean - mean, mean);
	c->percentile_50 = share_of(percentile(sorted, n, 0.50), mean);
	c->percentile_95 = share_of(percentile(sorted, n, 0.95), mean);
	c->percentile_99 = share_of(percentile(sorted, n, 0.99), mean);
	c->maximum = share_of(sorted[n - 1], mean);
}

gw_status gw_compare(const double *found, const double *truth, size_t count,
					 gw_comparison *comparison, gw_error *error)
{
	if (count == 0)
		return gw_fail(error, GW_ERROR_DATA, "there are no points to compare");
	double *difference = gw_allocate_array(count, sizeof *difference);
	if (!difference)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to compare %zu points", count);
	gw_status status = GW_OK;
	for (size_t i = 0; i < count && status == GW_OK; i++) {
		difference[i] = fabs(found[i] - truth[i]);
		if (!isfinite(difference[i]))
			status =
				gw_fail(error, GW_ERROR_DATA, "%s and %s cannot be compared: values must be finite",
						GW_SAID(found[i], 6), GW_SAID(truth[i], 6));
	}
	if (status == GW_OK) {
		qsort(difference, count, sizeof *difference, by_value);
		*comparison = (gw_comparison){ .points = count,
									   .mean = mean_of(found, count),
									   .truth_mean = mean_of(truth, count) };
		fill(difference, comparison);
	}
	free(difference);
	return status;
}

/* ------------------------------------------------------------------------------------ order */

/* A key and where it stood. */
typedef struct placed_key {
	double key[3];
	size_t place;
} placed_key;

static int by_key(const void *a, const void *b)
{
	const placed_key *x = a, *y = b;
	for (int k = 0; k < 3; k++)
		if (x->key[k] != y->key[k])
			return x->key[k] < y->key[k] ? -1 : 1;
	return (x->place > y->place) - (x->place < y->place);
}

gw_status gw_compare_order(gw_compare_keys keys, size_t width, size_t *order, size_t *count,
						   gw_error *error)
{
	placed_key *sorted = gw_allocate_array(keys.count, sizeof *sorted);
	size_t n = 0;
	if (!sorted)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to match %zu points", keys.count);
	for (size_t i = 0; i < keys.count; i++) {
		bool number = true;
		sorted[n] = (placed_key){ .place = i };
		for (size_t k = 0; k < width; k++) {
			sorted[n].key[k] = keys.key[width * i + k];
			number = number && !isnan(sorted[n].key[k]);
		}
		n += number;
	}
	qsort(sorted, n, sizeof *sorted, by_key);
	for (size_t i = 0; i < n; i++)
		order[i] = sorted[i].place;
	free(sorted);
	*count = n;
	return GW_OK;
}

/* ------------------------------------------------------------------------------------ worst */

/* Largest magnitude first. */
static int by_magnitude(const void *a, const void *b)
{
	const placed_key *x = a, *y = b;
	int order = (x->key[0] < y->key[0]) - (x->key[0] > y->key[0]);
	return order ? order : (x->place > y->place) - (x->place < y->place);
}

gw_status gw_compare_worst(const double *value, size_t count, size_t wanted, size_t *place,
						   gw_error *error)
{
	placed_key *sorted = gw_allocate_array(count, sizeof *sorted);
	if (!sorted)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to sort %zu errors", count);
	for (size_t i = 0; i < count; i++)
		sorted[i] = (placed_key){ .key = { fabs(value[i]) }, .place = i };
	qsort(sorted, count, sizeof *sorted, by_magnitude);
	for (size_t i = 0; i < count && i < wanted; i++)
		place[i] = sorted[i].place;
	free(sorted);
	return GW_OK;
}

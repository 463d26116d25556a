#include "result/albedo_places.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PLACE_POINTS 30.0

/* So many points tell where the bulk of all is: what lies between two quantiles that leave out this
 * share at either end, and strays with it. */
#define BULK_POINTS 10000
#define BULK_LEFT 0.02

static int compare_coordinates(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

/* From where to where the points reach along an axis, as if the bulk of them went on evenly. */
static void find_bulk(const gw_points *p, size_t axis, double *low, double *extent)
{
	double sample[BULK_POINTS];
	size_t used = 0, step = (p->count + BULK_POINTS - 1) / BULK_POINTS;
	for (size_t i = 0; i < p->count; i += step) {
		sample[used] = p->position[3 * i + axis];
		used += isfinite(sample[used]);
	}
	if (used == 0)
		return;
	qsort(sample, used, sizeof *sample, compare_coordinates);
	size_t left = (size_t)(BULK_LEFT * (double)used);
	*low = sample[left];
	*extent = (sample[used - 1 - left] - *low) / (1.0 - 2.0 * BULK_LEFT);
}

double albedo_place_width(const gw_points *p, double low[3])
{
	double diagonal = 0.0;
	for (size_t k = 0; k < 3; k++) {
		double extent = 0.0;
		low[k] = 0.0;
		find_bulk(p, k, &low[k], &extent);
		diagonal += extent * extent;
	}
	return sqrt(diagonal * M_PI * PLACE_POINTS / (double)p->count);
}

bool albedo_place_find(const double p[3], const double low[3], double width, int32_t at[3])
{
	for (int k = 0; k < 3; k++) {
		double cell = floor((p[k] - low[k]) / width);
		if (!(fabs(cell) < 0x1p30))
			return false;
		at[k] = (int32_t)cell;
	}
	return true;
}

bool albedo_level_known(const float level[3])
{
	for (int k = 0; k < 3; k++)
		if (!(isfinite(level[k]) && level[k] > 0.0f))
			return false;
	return true;
}

static int compare(const void *a, const void *b)
{
	const albedo_member *x = a, *y = b;
	for (int k = 0; k < 3; k++)
		if (x->at[k] != y->at[k])
			return x->at[k] < y->at[k] ? -1 : 1;
	if (x->group != y->group)
		return x->group < y->group ? -1 : 1;
	return (x->point > y->point) - (x->point < y->point);
}

void albedo_members_sort(albedo_member *list, size_t count)
{
	qsort(list, count, sizeof *list, compare);
}

size_t albedo_members_end(const albedo_member *list, size_t first, size_t count)
{
	size_t last = first + 1;
	while (last < count && memcmp(list[first].at, list[last].at, sizeof list->at) == 0)
		last++;
	return last;
}

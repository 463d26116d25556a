#include "result/albedo_places.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PLACE_POINTS 30.0

double albedo_place_width(const gw_points *p, double low[3])
{
	double high[3] = { -INFINITY, -INFINITY, -INFINITY }, diagonal = 0;
	for (int k = 0; k < 3; k++)
		low[k] = INFINITY;
	for (size_t i = 0; i < 3 * p->count; i++)
		if (isfinite(p->position[i])) {
			low[i % 3] = fmin(low[i % 3], p->position[i]);
			high[i % 3] = fmax(high[i % 3], p->position[i]);
		}
	for (int k = 0; k < 3; k++)
		diagonal += (high[k] - low[k]) * (high[k] - low[k]);
	return sqrt(diagonal * M_PI * PLACE_POINTS / (double)p->count);
}

bool albedo_place_find(const double p[3], const double low[3], double width, int32_t at[3])
{
	for (int k = 0; k < 3; k++) {
		double cell = (p[k] - low[k]) / width;
		if (!(cell >= 0.0 && cell < 0x1p30))
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

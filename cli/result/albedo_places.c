#include "result/albedo_places.h"

#include <math.h>

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

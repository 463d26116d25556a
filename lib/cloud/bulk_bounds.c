/* bulk_bounds.c - see bulk_bounds.h. */
#include "cloud/bulk_bounds.h"

#include <math.h>
#include <stdint.h>

#define BINS 1024          /* along an axis */
#define GAP (BINS * 3 / 4) /* bins without a point */
#define ROUNDS 64          /* each makes an axis four times shorter, and doubles have 2^2098 */

/* How many points lie where along an axis. */
typedef struct profile {
	uint64_t bin[3][BINS];
	size_t count; /* within the bounds */
} profile;

static size_t bin_of(double x, double minimum, double maximum)
{
	/* Halves, because the difference of two finite numbers may not be one. */
	double share = (0.5 * x - 0.5 * minimum) / (0.5 * maximum - 0.5 * minimum);
	return share < 1 ? (size_t)(share * BINS) : BINS - 1;
}

static void take_profile(const gw_points *points, const double minimum[3], const double maximum[3],
						 profile *p)
{
	*p = (profile){ .count = 0 };
	for (size_t i = 0; i < points->count; i++) {
		const double *place = points->position + 3 * i;
		if (!gw_within(place, minimum, maximum))
			continue;
		p->count++;
		for (int k = 0; k < 3; k++)
			if (maximum[k] > minimum[k])
				p->bin[k][bin_of(place[k], minimum[k], maximum[k])]++;
	}
}

/* The bins that the bulk takes of an axis, when few points lie beyond a gap at either end. */
static bool find_bulk(const uint64_t *bin, size_t count, size_t few, size_t *first, size_t *last)
{
	size_t before = 0, empty = 0;
	for (size_t b = 0; b < BINS; b++) {
		if (bin[b] == 0) {
			empty++;
			continue;
		}
		if (empty >= GAP && before <= few) {
			*first = b;
			*last = BINS - 1;
			return true;
		}
		if (empty >= GAP && count - before <= few) {
			*first = 0;
			*last = b - empty - 1;
			return true;
		}
		before += bin[b];
		empty = 0;
	}
	return false;
}

/* Bounds of the points in some bins of an axis. */
static void tighten(const gw_points *points, int axis, size_t first, size_t last, double minimum[3],
					double maximum[3])
{
	double low[3], high[3];
	for (int k = 0; k < 3; k++) {
		low[k] = INFINITY;
		high[k] = -INFINITY;
	}
	for (size_t i = 0; i < points->count; i++) {
		const double *place = points->position + 3 * i;
		if (!gw_within(place, minimum, maximum))
			continue;
		size_t bin = bin_of(place[axis], minimum[axis], maximum[axis]);
		if (bin < first || bin > last)
			continue;
		for (int k = 0; k < 3; k++) {
			low[k] = fmin(low[k], place[k]);
			high[k] = fmax(high[k], place[k]);
		}
	}
	for (int k = 0; k < 3; k++) {
		minimum[k] = low[k];
		maximum[k] = high[k];
	}
}

size_t gw_bulk_bounds(const gw_points *points, double minimum[3], double maximum[3])
{
	size_t finite = 0, few = 0;
	profile p;
	for (int round = 0; round < ROUNDS; round++) {
		bool cut = false;
		take_profile(points, minimum, maximum, &p);
		if (round == 0) {
			finite = p.count;
			few = finite / 1000 > 3 ? finite / 1000 : 3;
			few = few < finite / 16 ? few : finite / 16;
		}
		for (int k = 0; k < 3 && !cut; k++) {
			size_t first, last, out = finite - p.count;
			if (maximum[k] > minimum[k] && out < few &&
				find_bulk(p.bin[k], p.count, few - out, &first, &last)) {
				tighten(points, k, first, last, minimum, maximum);
				cut = true;
			}
		}
		if (!cut)
			break;
	}
	return finite - p.count;
}

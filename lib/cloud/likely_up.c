/*
 * likely_up.c - gw_likely_up, see glowworm_picture.h.
 *
 * Levels show as slabs that hold many of the points: thin ones where a thing's base ends, wide ones
 * where a floor or a ceiling is not quite level. One wall says nothing: seen from the side it is
 * what ground is from above.
 */
#include "glowworm_picture.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

/* Points that are looked at, at most, and at least. */
#define POINTS_MOST 30000u
#define POINTS_LEAST 300u

/* Share of the points beyond each end, which may be strays. */
#define BEYOND 0.001

/* A base: so wide, of the longest extent; so near the end, of its axis' own; at least this share of
 * the points, and so many times that of any other end; no more, or it is a wall or ground by
 * itself; on an axis at least so long. */
#define BASE_WIDTH 0.004
#define BASE_END 0.04
#define BASE_LEAST 0.02
#define BASE_MOST 0.3
#define BASE_TIMES 3.0
#define BASE_EXTENT 0.25

/* A floor and a ceiling: so wide, within so much of the ends; each at least this share, both
 * together so many times what another axis has. */
#define LEVEL_WIDTH 0.02
#define LEVEL_END 0.35
#define LEVEL_LEAST 0.1
#define LEVEL_TIMES 2.0
#define LEVEL_APART 0.1 /* of the longest extent: between the two, at least */

/* One axis: its points in order, and between which of them lies all but strays. */
typedef struct axis_points {
	double *at;
	size_t count;
	double low, high;
} axis_points;

static int compare(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

/* The largest share of the points that lies within `width` of one that is so near to an end. */
static double share_at_end(const axis_points *a, double width, double end, bool high)
{
	double reach = end * (a->high - a->low), most = 0.0;
	double from = high ? a->high - reach : a->low;
	double to = high ? a->high : a->low + reach;
	size_t last = 0;
	for (size_t i = 0; i < a->count; i++) {
		if (a->at[i] < from || a->at[i] > to)
			continue;
		last = last > i ? last : i;
		while (last < a->count && a->at[last] <= a->at[i] + width)
			last++;
		most = fmax(most, (double)(last - i) / (double)a->count);
	}
	return most;
}

static bool list_axis(const double *position, size_t count, int axis, axis_points *a)
{
	size_t step = count / POINTS_MOST + 1;
	a->at = gw_allocate_array(count / step + 1, sizeof *a->at);
	for (size_t i = 0; a->at && i < count; i += step)
		if (isfinite(position[3 * i]) && isfinite(position[3 * i + 1]) &&
			isfinite(position[3 * i + 2]))
			a->at[a->count++] = position[3 * i + (size_t)axis];
	if (!a->at || a->count < POINTS_LEAST)
		return false;
	qsort(a->at, a->count, sizeof *a->at, compare);
	size_t beyond = (size_t)(BEYOND * (double)a->count);
	a->low = a->at[beyond];
	a->high = a->at[a->count - 1 - beyond];
	return true;
}

/* Does the thing stand on an end of y, and on no other? */
static bool has_base(const axis_points a[3], double longest)
{
	double base = share_at_end(&a[1], BASE_WIDTH * longest, BASE_END, false);
	double others = share_at_end(&a[1], BASE_WIDTH * longest, BASE_END, true);
	for (int k = 0; k < 3; k += 2)
		for (int high = 0; high < 2; high++)
			others = fmax(others, share_at_end(&a[k], BASE_WIDTH * longest, BASE_END, high != 0));
	return base >= BASE_LEAST && base <= BASE_MOST && base >= BASE_TIMES * others &&
		   a[1].high - a[1].low >= BASE_EXTENT * longest;
}

/* Are a floor and a ceiling across y, and it is shorter than the others? */
static bool has_levels(const axis_points a[3], double longest)
{
	double level[3][2];
	for (int k = 0; k < 3; k++)
		for (int high = 0; high < 2; high++)
			level[k][high] = share_at_end(&a[k], LEVEL_WIDTH * longest, LEVEL_END, high != 0);
	double height = a[1].high - a[1].low;
	double most = fmax(level[0][0] + level[0][1], level[2][0] + level[2][1]);
	return level[1][0] >= LEVEL_LEAST && level[1][1] >= LEVEL_LEAST &&
		   level[1][0] + level[1][1] >= LEVEL_TIMES * most && height > LEVEL_APART * longest &&
		   height < a[0].high - a[0].low && height < a[2].high - a[2].low;
}

char gw_likely_up(const double *position, size_t count, bool *sure)
{
	axis_points a[3] = { { .at = NULL } };
	double longest = 0.0;
	bool listed = true, found = false;
	*sure = false;
	for (int k = 0; k < 3 && listed; k++) {
		listed = list_axis(position, count, k, &a[k]);
		longest = listed ? fmax(longest, a[k].high - a[k].low) : 0.0;
	}
	if (listed && longest > 0.0) {
		*sure = has_base(a, longest);
		found = *sure || has_levels(a, longest);
	}
	for (int k = 0; k < 3; k++)
		free(a[k].at);
	return found ? 'y' : 0;
}

/*
 * likely_up.c - gw_likely_up, see glowworm_picture.h.
 *
 * Levels show as slabs that hold many of the points: thin ones where a thing's base ends, wide ones
 * where a floor or a ceiling is not quite level. One wall says nothing: seen from the side it is
 * what ground is from above. Of a thing whose base was not scanned most lines along the axis that
 * it stood on meet one sheet, and along the others two. A box that one looks into from the side, as
 * a stage or the Cornell box, has as many sides along y as along z, but what is in it stands on
 * one.
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

/* A thing that is open below: at least so many of the columns along y hold one sheet, and at most
 * this share of that along the others. */
#define OPEN_LEAST 0.35
#define OPEN_OTHERS 0.5

/* A box: so many sides, each with at least this share of the points within so much of an end. A
 * sixth is what a side of a cube has; half as much where what stands in it has as many points, and
 * half of that where it is long; a ball has less near its ends. What stands in it has at least
 * BASE_LEAST of the points within so much of the floor, of the longest extent. */
#define BOX_SIDES 5
#define BOX_SIDE (1.0 / 24.0)
#define BOX_WIDTH 0.02
#define STANDS_WITHIN 0.1

/* Points that are looked at in columns, at most; how many are in one, and what counts at least;
 * sheets are so many widths of a column apart. */
#define COLUMN_MOST 60000u
#define COLUMN_POINTS 20.0
#define COLUMN_LEAST 4
#define SHEETS_APART 3.0

/* The width of a column is more than this part of the longer extent: their numbers have 32 bits. */
#define COLUMN_WIDTH 0x1p-31

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

static bool is_finite(const double *p)
{
	return isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]);
}

static bool list_axis(const double *position, size_t count, int axis, axis_points *a)
{
	size_t step = count / POINTS_MOST + 1;
	a->at = gw_allocate_array(count / step + 1, sizeof *a->at);
	for (size_t i = 0; a->at && i < count; i += step)
		if (is_finite(position + 3 * i))
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

/* ------------------------------------------------------------------------------------------ box */

/* Of the low and high end of each axis: shares of the points that lie in it, and that lie near it
 * but in no end. */
typedef struct box_ends {
	double side[3][2], near[3][2];
} box_ends;

static void add_to_ends(const double *p, const axis_points a[3], double longest, box_ends *ends)
{
	double depth[3][2], least = INFINITY;
	for (int k = 0; k < 3; k++) {
		depth[k][0] = p[k] - a[k].low;
		depth[k][1] = a[k].high - p[k];
		least = fmin(least, fmin(depth[k][0], depth[k][1]));
	}
	for (int k = 0; k < 3; k++)
		for (int high = 0; high < 2; high++) {
			ends->side[k][high] += fabs(depth[k][high]) <= BOX_WIDTH * longest;
			ends->near[k][high] +=
				least > BOX_WIDTH * longest && depth[k][high] <= STANDS_WITHIN * longest;
		}
}

/* Is it a box, of which a side may be open, and all that is in it stands on the low end of y? */
static bool has_things_on_floor(const double *position, size_t count, const axis_points a[3],
								double longest)
{
	box_ends ends = { .side = { { 0 } } };
	for (size_t i = 0; i < count; i += count / POINTS_MOST + 1)
		if (is_finite(position + 3 * i))
			add_to_ends(position + 3 * i, a, longest, &ends);
	int sides = 0;
	double on_floor = ends.near[1][0], others = 0.0, all = (double)a[1].count;
	ends.near[1][0] = 0.0;
	for (int k = 0; k < 3; k++)
		for (int high = 0; high < 2; high++) {
			sides += ends.side[k][high] >= BOX_SIDE * all;
			others = fmax(others, ends.near[k][high]);
		}
	return sides >= BOX_SIDES && ends.side[1][0] >= BOX_SIDE * all &&
		   on_floor >= BASE_LEAST * all && on_floor >= BASE_TIMES * others;
}

/* -------------------------------------------------------------------------------------- columns */

typedef struct column_point {
	uint64_t column;
	double height;
} column_point;

static int by_column(const void *left, const void *right)
{
	const column_point *a = left, *b = right;
	return a->column != b->column ? (a->column > b->column) - (a->column < b->column)
								  : (a->height > b->height) - (a->height < b->height);
}

/* The points within what has no strays, by the columns along an axis that they lie in. Returns how
 * many, 0 where they lie on a line across it; *width receives a column's. */
static size_t list_columns(const double *position, size_t count, const axis_points a[3], int axis,
						   column_point *point, double *width)
{
	int u = (axis + 1) % 3, v = (axis + 2) % 3;
	size_t step = count / COLUMN_MOST + 1, kept = 0;
	const double extent[2] = { a[u].high - a[u].low, a[v].high - a[v].low };
	*width = sqrt(extent[0] * extent[1] * COLUMN_POINTS * (double)step / (double)count);
	if (!(*width > COLUMN_WIDTH * fmax(extent[0], extent[1]) && isfinite(*width)))
		return 0;
	for (size_t i = 0; i < count; i += step) {
		const double *p = position + 3 * i;
		bool within = true;
		for (int k = 0; k < 3; k++)
			within = within && p[k] >= a[k].low && p[k] <= a[k].high;
		if (within)
			point[kept++] = (column_point){
				(uint64_t)((p[u] - a[u].low) / *width) << 32 |
					(uint64_t)((p[v] - a[v].low) / *width),
				p[axis],
			};
	}
	qsort(point, kept, sizeof *point, by_column);
	return kept;
}

/* The share of the columns along an axis that hold a single sheet. */
static double single_share(const double *position, size_t count, const axis_points a[3], int axis,
						   column_point *point)
{
	double width;
	size_t kept = list_columns(position, count, a, axis, point, &width);
	size_t columns = 0, single = 0;
	for (size_t first = 0, last = 0; first < kept; first = last) {
		bool apart = false;
		for (last = first + 1; last < kept && point[last].column == point[first].column; last++)
			apart |= point[last].height - point[last - 1].height > SHEETS_APART * width;
		columns += last - first >= COLUMN_LEAST;
		single += last - first >= COLUMN_LEAST && !apart;
	}
	return columns > 0 ? (double)single / (double)columns : 0.0;
}

/* Is it open below along y alone, and nothing stands on an end of z? */
static bool has_open_base(const double *position, size_t count, const axis_points a[3],
						  double longest)
{
	for (int high = 0; high < 2; high++)
		if (share_at_end(&a[2], BASE_WIDTH * longest, BASE_END, high != 0) >= BASE_LEAST)
			return false;
	column_point *point = gw_allocate_array(count / (count / COLUMN_MOST + 1) + 1, sizeof *point);
	double single = point ? single_share(position, count, a, 1, point) : 0.0;
	bool open = single >= OPEN_LEAST && a[1].high - a[1].low >= BASE_EXTENT * longest;
	for (int k = 0; open && k < 3; k += 2)
		open = single_share(position, count, a, k, point) <= OPEN_OTHERS * single;
	free(point);
	return open;
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
		found = *sure || has_levels(a, longest) ||
				has_things_on_floor(position, count, a, longest) ||
				has_open_base(position, count, a, longest);
	}
	for (int k = 0; k < 3; k++)
		free(a[k].at);
	return found ? 'y' : 0;
}

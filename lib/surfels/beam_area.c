/* beam_area.c - see beam_area.h. */
#include "surfels/beam_area.h"

#include "base/memory.h"
#include "base/up_axis.h"

#include <math.h>
#include <stdlib.h>

/* Beams in a column, on average. */
#define BEAMS 16.0

/* Of a column at the rim of the cloud, or over water, only a part has beams: each of them has at
 * most so many times the ground of others. */
#define RIM_MOST 2.0

/* The lowest point of a column stops all that gets there, which would take endless leaves. Few
 * beams may get to the lower ones; those tell little: none covers more than so many times the part
 * of the ground that its beam has. */
#define STOPPED_MOST 0.95
#define COVER_MOST 3.0

/* Shares are taken in such parts, of which sums of floats are exact: points that share a place
 * count the same in any order. */
#define SHARE_PARTS 65536.0f

/* A point in its column; sorted by column, then from below. */
typedef struct placed {
	uint64_t column;
	float height;
	uint32_t surfel;
} placed;

static int by_column(const void *a, const void *b)
{
	const placed *p = a, *q = b;
	if (p->column != q->column)
		return p->column < q->column ? -1 : 1;
	if (p->height != q->height)
		return p->height < q->height ? -1 : 1;
	return (p->surfel > q->surfel) - (p->surfel < q->surfel);
}

/* The width of columns, from the ground that the cloud's bounds cover. */
static double choose_width(const gw_surfels *s, const double up[3], double beams)
{
	double ground = 1.0, height = 0.0;
	for (int k = 0; k < 3; k++) {
		double extent = (double)s->maximum[k] - (double)s->minimum[k];
		if (up[k] == 0.0)
			ground *= extent;
		else
			height = extent;
	}
	double width = sqrt(BEAMS * ground / beams);
	return width > 0.0 ? width : fmax(height, 1.0);
}

/* Columns are numbered from the bounds; what lies beyond them is in those at the rim. */
static uint64_t column_of(const gw_surfels *s, const double up[3], double width, size_t i)
{
	uint64_t column = 0;
	for (size_t k = 0; k < 3; k++) {
		double at = ((double)s->position[3 * i + k] - (double)s->minimum[k]) / width;
		if (up[k] == 0.0)
			column = column << 32 | (uint32_t)fmin(fmax(at, 0.0), (double)UINT32_MAX);
	}
	return column;
}

/* One column, from below: what is at or below a point has got there. */
static void cover_column(const placed *at, size_t count, const float *share, double ground,
						 float *area)
{
	double there = 0.0, all = 0.0;
	for (size_t i = 0; i < count; i++)
		all += (double)share[at[i].surfel];
	ground = fmin(ground, all * RIM_MOST * ground / BEAMS);
	for (size_t i = 0; i < count; i++) {
		double own = (double)share[at[i].surfel];
		there += own;
		double covered = -log1p(-fmin(own / there, STOPPED_MOST));
		area[at[i].surfel] = (float)(fmin(covered, COVER_MOST * own / all) * ground);
	}
}

static void find_shares(const gw_points *points, const gw_surfels *s, float *share)
{
	for (size_t i = 0; i < s->count; i++)
		share[i] = 0.0f;
	for (size_t i = 0; i < s->point_count; i++) {
		uint32_t surfel = s->surfel_of_point[i];
		if (surfel == UINT32_MAX)
			continue;
		float part = points->beam_share[i];
		share[surfel] +=
			part > 0.0f && part < 1.0f ? ceilf(part * SHARE_PARTS) / SHARE_PARTS : 1.0f;
	}
	for (size_t i = 0; i < s->count; i++)
		share[i] = share[i] > 0.0f ? share[i] : 1.0f;
}

gw_status gw_beam_areas(const gw_points *points, const gw_surfels *surfels, float *share,
						float *area, gw_error *error)
{
	size_t n = surfels->count;
	double up[3], beams = 0.0;
	placed *at = gw_allocate_array(n, sizeof *at);
	if (!at)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the columns of %zu points", n);
	gw_up_axis(points->up, up);
	find_shares(points, surfels, share);
	for (size_t i = 0; i < n; i++)
		beams += (double)share[i];
	double width = choose_width(surfels, up, beams);
	for (size_t i = 0; i < n; i++) {
		const float *p = surfels->position + 3 * i;
		double height = up[0] * (double)p[0] + up[1] * (double)p[1] + up[2] * (double)p[2];
		at[i] = (placed){ column_of(surfels, up, width, i), (float)height, (uint32_t)i };
	}
	qsort(at, n, sizeof *at, by_column);
	for (size_t first = 0, last; first < n; first = last) {
		for (last = first; last < n && at[last].column == at[first].column;)
			last++;
		cover_column(at + first, last - first, share, width * width, area);
	}
	free(at);
	return GW_OK;
}

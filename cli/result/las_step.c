/* las_step.c - see las_step.h. */
#include "result/las_step.h"

#include "glowworm_host.h"
#include "las/las_grid.h"
#include "las/las_notes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* A tenth of a millimetre. */
#define DEGREES_STEP 1e-9

/* Of the distance between neighbours, by which a point is moved at most: by half a step on each of
 * three axes. */
#define SHARE 0.01

static bool is_wanted(const settings *s)
{
	return s->las_step < 0.0f;
}

/* The finest of the three steps that a LAS file had, or 0. */
static double own_step(const scan *said)
{
	double scale[3], least = INFINITY;
	for (size_t c = 0; c < said->comment_count; c++) {
		if (las_note_read(said->comment[c], "scale", scale, 3) != 3)
			continue;
		for (int k = 0; k < 3; k++)
			least = fmin(least, fabs(scale[k]));
		return least > 0.0 && isfinite(least) ? least : 0.0;
	}
	return 0.0;
}

bool las_step_needs_all(const settings *s, const scan *said)
{
	return is_wanted(s) && !(own_step(said) > 0.0);
}

/* ------------------------------------------------------------------------------- neighbours */

/* Points whose neighbours are looked for, and how many others are looked at on either side of each,
 * which is enough but where very many have the same coordinate. */
#define ASKED ((size_t)2000)
#define LOOKED_AT ((size_t)200000)

/* A finite point, by its coordinate along one axis. */
typedef struct place {
	double along;
	const double *at;
} place;

static int by_along(const void *left, const void *right)
{
	const place *a = left, *b = right;
	return a->along < b->along ? -1 : a->along > b->along;
}

static int by_value(const void *left, const void *right)
{
	const double *a = left, *b = right;
	return *a < *b ? -1 : *a > *b;
}

/* How wide nine tenths of the points are along an axis. */
static double width_of(const place *all, size_t count, size_t axis)
{
	double some[ASKED];
	size_t stride = 1 + count / ASKED, found = 0;
	for (size_t i = 0; i < count; i += stride)
		some[found++] = all[i].at[axis];
	qsort(some, found, sizeof *some, by_value);
	return some[found - 1 - found / 20] - some[found / 20];
}

/* Along the axis on which they are the widest. */
static void sort_places(place *all, size_t count)
{
	size_t widest = 0;
	double width[3];
	for (size_t k = 0; k < 3; k++) {
		width[k] = width_of(all, count, k);
		widest = width[k] > width[widest] ? k : widest;
	}
	for (size_t i = 0; i < count; i++)
		all[i].along = all[i].at[widest];
	qsort(all, count, sizeof *all, by_along);
}

/* The squared distance to another place, if it is less; points at the same place are one. */
static double nearer(const place *from, const place *to, double best)
{
	double squared = 0.0;
	for (int k = 0; k < 3; k++)
		squared += (to->at[k] - from->at[k]) * (to->at[k] - from->at[k]);
	return squared > 0.0 && squared < best ? squared : best;
}

static double find_gap(const place *all, size_t count, size_t i)
{
	double best = INFINITY;
	size_t low = i > LOOKED_AT ? i - LOOKED_AT : 0;
	size_t high = count - i > LOOKED_AT ? i + LOOKED_AT : count;
	for (size_t j = i; j-- > low;) {
		double along = all[i].along - all[j].along;
		if (along * along >= best)
			break;
		best = nearer(&all[i], &all[j], best);
	}
	for (size_t j = i + 1; j < high; j++) {
		double along = all[j].along - all[i].along;
		if (along * along >= best)
			break;
		best = nearer(&all[i], &all[j], best);
	}
	return sqrt(best);
}

static double median_gap(place *all, size_t count)
{
	double gap[ASKED];
	size_t stride = 1 + count / ASKED, found = 0;
	sort_places(all, count);
	for (size_t i = 0; i < count; i += stride) {
		gap[found] = find_gap(all, count, i);
		found += isfinite(gap[found]);
	}
	qsort(gap, found, sizeof *gap, by_value);
	return found > 0 ? gap[found / 2] : 0.0;
}

/* The median distance between neighbours, in units of the points. */
static gw_status measure(const gw_points *points, double *spacing, gw_error *error)
{
	place *all = reallocarray(NULL, points->count + 1, sizeof *all);
	size_t count = 0;
	*spacing = 0.0;
	if (!all)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the neighbours of %zu points",
					   points->count);
	for (size_t i = 0; i < points->count; i++) {
		const double *at = points->position + 3 * i;
		all[count].at = at;
		count += isfinite(at[0]) && isfinite(at[1]) && isfinite(at[2]);
	}
	if (count > 1)
		*spacing = median_gap(all, count);
	free(all);
	return GW_OK;
}

static gw_status measure_scan(const scan *cloud, double *spacing, gw_error *error)
{
	static const char *const name[3] = { "x", "y", "z" };
	*spacing = 0.0;
	double *position = reallocarray(NULL, cloud->count + 1, 3 * sizeof *position);
	if (!position)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the places of %zu points",
					   cloud->count);
	bool all = true;
	for (size_t k = 0; k < 3; k++) {
		const scan_column *column = scan_find(cloud, name[k]);
		all = all && column;
		for (size_t i = 0; column && i < cloud->count; i++)
			position[3 * i + k] = scan_value(column, i);
	}
	gw_status status = GW_OK;
	if (all)
		status =
			measure(&(gw_points){ .count = cloud->count, .position = position }, spacing, error);
	free(position);
	return status;
}

static bool is_of_some(const las_step_points *by)
{
	return by->points && by->all > by->points->count;
}

/* In the coordinates of the file. Of a cloud of which some points are kept, these lie evenly; all
 * may, at random, be half as far apart as they would be then. */
static gw_status find_spacing(const las_step_points *by, double *spacing, gw_error *error)
{
	GW_TRY(by->points ? measure(by->points, spacing, error)
					  : measure_scan(by->said, spacing, error));
	if (by->points && by->place)
		*spacing /= by->place->scale[0];
	if (is_of_some(by))
		*spacing *= 0.5 * sqrt((double)by->points->count / (double)by->all);
	return GW_OK;
}

static gw_status is_degrees(const las_step_points *by, bool *degrees, gw_error *error)
{
	*degrees = by->place && by->place->projected;
	return by->place ? GW_OK : coordinates_say_degrees(by->said, NULL, NULL, degrees, error);
}

static void note(const las_step_points *by, double step, double spacing)
{
	if (!(step > 0.0))
		fprintf(stderr, "glowworm: note: coordinates get no step: nothing says how far points are "
						"apart\n");
	else if (is_of_some(by))
		fprintf(
			stderr,
			"glowworm: note: coordinates get a step of up to %s, by how far the points that are "
			"kept are apart\n",
			GW_SAID(step, 6));
	else
		fprintf(
			stderr,
			"glowworm: note: coordinates get a step of up to %s; points are %s apart from their "
			"neighbours, the median\n",
			GW_SAID(step, 6), GW_SAID(spacing, 2));
}

gw_status las_step_settle(settings *s, const las_step_points *by, gw_error *error)
{
	double own = own_step(by->said), spacing = 0.0, step = own;
	bool degrees = false;
	if (!is_wanted(s))
		return GW_OK;
	if (!(own > 0.0)) {
		GW_TRY(is_degrees(by, &degrees, error));
		GW_TRY(find_spacing(by, &spacing, error));
		double most = spacing * SHARE * 2.0 / sqrt(3.0);
		step = degrees ? DEGREES_STEP : most > 0.0 ? pow(10.0, floor(log10(most))) : 0.0;
	}
	step = fmin(step, LAS_GRID_COARSEST);
	s->las_step = (float)step;
	if (s->quiet)
		return GW_OK;
	if (own > 0.0)
		fprintf(stderr, "glowworm: note: coordinates keep the input's step of %s\n",
				GW_SAID(own, 6));
	else if (degrees)
		fprintf(stderr, "glowworm: note: coordinates, which are degrees, get a step of 1e-9\n");
	else
		note(by, step, spacing);
	return GW_OK;
}

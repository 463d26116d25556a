/*
 * plane_doubt.c - see plane_doubt.h.
 */
#include "surfels/plane_doubt.h"

#include "base/memory.h"
#include "normals/nearest_plane.h"

#include <math.h>
#include <stdlib.h>

/* Mean square angle between two lines at random, radians: the integral of x^2 sin x to pi / 2. */
#define AT_RANDOM (M_PI - 2.0)

typedef struct doubt_step {
	gw_neighbours *search;
	const gw_surfels *surfels;
	bool all;             /* no normal was given */
	float *single, *mean; /* count: of each point by itself, and with its neighbours */
} doubt_step;

/* Of two planes by their normals. */
static float how_random(const float n[3], const float m[3])
{
	double cosine = (double)(n[0] * m[0] + n[1] * m[1] + n[2] * m[2]);
	double angle = acos(fmin(fabs(cosine), 1.0));
	return (float)fmin(angle * angle / AT_RANDOM, 1.0);
}

/* How far the plane of the nearest few is from that of all alike. Where there is none, nothing says
 * that there is one. */
static float doubt_of(const float *point, size_t count, gw_neighbours *search)
{
	float few[4], all[4];
	gw_plane of_few = gw_nearest_plane(point, count, INFINITY, few);
	gw_plane of_all = gw_plane_normal(point, count, all, all + 3);
	if (of_few == GW_PLANE_NO_MEMORY || of_all == GW_PLANE_NO_MEMORY)
		gw_neighbours_run_short(search);
	return of_few == GW_PLANE_FOUND && of_all == GW_PLANE_FOUND ? how_random(all, few) : 1.0f;
}

/* Where all lie near one plane, it is theirs. */
static void measure(void *user, size_t surfel, const gw_neighbour_list *list)
{
	const doubt_step *step = user;
	const gw_surfels *s = step->surfels;
	const float *at = s->position + 3 * surfel;
	const double place[3] = { (double)at[0], (double)at[1], (double)at[2] };
	float point[3 * (GW_NEIGHBOURS + 1)];
	bool estimated = step->all || s->shading_normal_off[surfel] > 0.0f;
	if (!estimated || list->count < GW_NEIGHBOURS ||
		!(gw_filled_space_thickness(s, place, list) > (double)GW_PLANE_UNEVEN))
		return;
	size_t count = gw_places_around(s, surfel, list, point);
	step->single[surfel] = doubt_of(point, count, step->search);
}

static void average(void *user, size_t surfel, const gw_neighbour_list *list)
{
	const doubt_step *step = user;
	double sum = (double)step->single[surfel];
	for (uint32_t j = 0; j < list->count; j++)
		sum += (double)step->single[list->index[j]];
	step->mean[surfel] = (float)(sum / (double)(list->count + 1));
}

static gw_status find(doubt_step *step, const gw_lone_points *lone, bool *any, gw_error *error)
{
	size_t n = step->surfels->count;
	if (!step->single || !step->mean)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the doubts of %zu points", n);
	GW_TRY(gw_neighbours_visit_reach(step->search, measure, step, error));
	for (size_t i = 0; i < n; i++)
		*any = *any || step->single[i] > 0.0f;
	if (*any)
		GW_TRY(gw_neighbours_visit_reach(step->search, average, step, error));
	for (size_t i = 0; i < n && *any; i++)
		step->mean[i] = lone->filled[i] ? 0.0f : step->mean[i];
	return GW_OK;
}

gw_status gw_plane_doubt_find(const gw_points *points, gw_neighbours *search,
							  const gw_lone_points *lone, gw_surfels *surfels, gw_error *error)
{
	size_t n = surfels->count;
	doubt_step step = { .search = search, .surfels = surfels, .all = !points->normal };
	bool any = false;
	if (points->own_area || points->beam_share || !surfels->shading_normal_off)
		return GW_OK;
	step.single = gw_allocate_zeros(n, sizeof *step.single);
	step.mean = gw_allocate_array(n, sizeof *step.mean);
	gw_status status = find(&step, lone, &any, error);
	free(step.single);
	if (status == GW_OK && any)
		surfels->doubt = step.mean;
	else
		free(step.mean);
	return status;
}

/* measure.c - what a cloud looks like before it is baked; see gw_measure in glowworm.h. */
#include "bake/surface_points.h"
#include "octree/octree.h"
#include "cloud/cloud_units.h"
#include "cloud/frame.h"
#include "cloud/strays.h"
#include "surfels/surfel_making.h"
#include "base/nth_element.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of clouds with more surfels than this, about as many are looked at, in stretches of Morton order:
 * patches of surface in which all but those at their borders, 3 in 100, have all their neighbours.
 */
#define LOOKED_AT 1048576u
#define STRETCH 65536u

static gw_status choose_stretches(void *user, const gw_surfels *surfels, uint8_t *chosen,
								  gw_error *error)
{
	size_t stretches = (surfels->count + STRETCH - 1) / STRETCH;
	size_t most = LOOKED_AT / STRETCH, wanted = stretches < most ? stretches : most;
	(void)user;
	(void)error;
	for (size_t i = 0; i < wanted; i++) {
		size_t first = i * stretches / wanted * STRETCH, left = surfels->count - first;
		memset(chosen + first, 1, left < STRETCH ? left : STRETCH);
	}
	return GW_OK;
}

static void count_normals(const gw_points *points, gw_statistics *statistics)
{
	for (size_t i = 0; points->normal && i < points->count; i++) {
		if (gw_normal_length(points->normal + 3 * i) > 0)
			statistics->normals_given++;
		else
			statistics->normals_bad++;
	}
}

static void measure_spacing(const gw_surfels *surfels, const float *gap, gw_statistics *statistics)
{
	static const double share[3] = { 0.05, 0.5, 0.95 };
	size_t n = surfels->count;
	for (int k = 0; k < 3 && n > 1; k++)
		statistics->spacing[k] =
			(double)gw_nth_element(gap, n, (size_t)(share[k] * (double)(n - 1)));
	double area = (double)gw_nth_element(surfels->area, n, n / 2);
	statistics->density = 1 / area;
}

/* Points whose lengths are those given, multiplied by 2^exponent. */
static gw_status measure(const gw_points *points, const gw_points *given, int exponent,
						 uint32_t threads, gw_statistics *statistics, gw_error *error)
{
	gw_surfels_options options = { .threads = threads,
								   .normals = GW_NORMALS_GIVEN,
								   .choose = choose_stretches,
								   .choose_by_place = true };
	gw_surfels surfels;
	float *gap = NULL;
	GW_TRY(gw_surfels_make_with_gaps(points, &options, &surfels, &gap, error));
	statistics->duplicates = surfels.duplicates;
	gw_strays_count(&surfels, given, statistics->stray);
	count_normals(points, statistics);
	measure_spacing(&surfels, gap, statistics);
	for (int k = 0; k < 3; k++)
		statistics->spacing[k] = ldexp(statistics->spacing[k], -exponent);
	statistics->density = ldexp(statistics->density, 2 * exponent);
	statistics->depth = gw_octree_auto_depth(&surfels);
	const gw_bake_options usual = gw_bake_options_default();
	statistics->memory =
		gw_memory_of_points(statistics->finite, statistics->normals_given > 0, true, &usual);
	free(gap);
	gw_surfels_clear(&surfels);
	return GW_OK;
}

gw_status gw_measure(const gw_points *points, uint32_t threads, gw_statistics *statistics,
					 gw_error *error)
{
	*statistics = (gw_statistics){ .points = points->count };
	statistics->finite = gw_finite_bounds(points, statistics->minimum, statistics->maximum);
	int exponent = gw_length_exponent(gw_cloud_extent(points));
	if (exponent == 0)
		return measure(points, points, 0, threads, statistics, error);
	gw_points scaled = *points;
	double *place = gw_scaled_places(points->position, points->count, exponent);
	if (!place)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu points in other units",
					   points->count);
	scaled.position = place;
	scaled.scanner = NULL; /* given normals are taken as they are */
	scaled.scanner_count = 0;
	scaled.scanner_of = NULL;
	gw_status status = measure(&scaled, points, exponent, threads, statistics, error);
	free(place);
	return status;
}

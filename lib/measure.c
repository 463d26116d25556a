/* measure.c - what a cloud looks like before it is baked; see gw_measure in glowworm.h. */
#include "octree.h"
#include "surfel_steps.h"

#include <math.h>
#include <stdlib.h>

/*
 * Bytes that a bake holds at its peak, by what they grow with. A point: input, map and result, 140.
 * A surfel: its own arrays, 100, about one leaf with two lobes, 190, and 16 fragments of 16 bytes
 * in two buffers while they are sorted, 512. Both directories of the octree: 16 MiB at most.
 */
#define POINT_BYTES 140u
#define SURFEL_BYTES 802u
#define FIXED_BYTES (64u << 20)

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
			(double)gw_rank_float(gap, n, (size_t)(share[k] * (double)(n - 1)));
	double area = (double)gw_rank_float(surfels->area, n, n / 2);
	statistics->density = 1 / area;
}

gw_status gw_measure(const gw_points *points, uint32_t threads, gw_statistics *statistics,
					 gw_error *error)
{
	gw_surfels_options options = { .threads = threads };
	gw_surfels surfels;
	float *gap = NULL;
	*statistics = (gw_statistics){ .points = points->count };
	gw_status status = gw_surfels_make_with_gaps(points, &options, &surfels, &gap, error);
	if (status != GW_OK)
		return status;
	statistics->finite = gw_finite_bounds(points, statistics->minimum, statistics->maximum);
	statistics->duplicates = surfels.duplicates;
	count_normals(points, statistics);
	measure_spacing(&surfels, gap, statistics);
	statistics->depth = gw_octree_auto_depth(&surfels);
	statistics->memory = FIXED_BYTES + (uint64_t)points->count * POINT_BYTES +
						 (uint64_t)surfels.count * SURFEL_BYTES;
	free(gap);
	gw_surfels_clear(&surfels);
	return GW_OK;
}

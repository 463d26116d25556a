/*
 * bench_octree.c - how long the octree takes to build: 1.4 million random points at depth 8.
 *
 *   bench_octree [POINTS [DEPTH]]
 */
#include "octree/octree.h"
#include "octree_points.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static double seconds(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Builds once and prints; the first build of a process also compiles the passes. */
static gw_status measure(gw_gpu *gpu, const gw_surfels *surfels, uint32_t depth, gw_error *error)
{
	gw_gpu_account before = gw_gpu_read_account(gpu);
	double start = seconds();
	gw_octree octree;
	GW_TRY(gw_octree_build(gpu, surfels, depth, &octree, error));
	gw_gpu_account after = gw_gpu_read_account(gpu);
	printf("%zu points, depth %u: %u fragments, %u leaves, %u leaf tiles, %u tiles, %u border\n",
		   surfels->count, depth, octree.fragment_count, octree.leaf_count, octree.leaf_tile_count,
		   octree.tile_count, octree.border_tile_count);
	printf("  %.3f s, of it %.3f s on the device and %.3f s compiling; %.1f MB kept, %.1f MB "
		   "peak\n",
		   seconds() - start, after.device_seconds - before.device_seconds,
		   after.compile_seconds - before.compile_seconds,
		   (double)(after.bytes - before.bytes) * 1e-6, (double)after.peak_bytes * 1e-6);
	gw_octree_destroy(gpu, &octree);
	return GW_OK;
}

int main(int argc, char **argv)
{
	size_t count = argc > 1 ? strtoull(argv[1], NULL, 10) : 1400000;
	uint32_t depth = argc > 2 ? (uint32_t)strtoul(argv[2], NULL, 10) : 8;
	gw_error error = { 0 };
	gw_gpu *gpu = NULL;
	gw_gpu_options options = { 0 };
	gw_surfels surfels;
	if (!octree_points_sphere(count, 1, &surfels) ||
		gw_gpu_create(&options, &gpu, &error) != GW_OK) {
		fprintf(stderr, "bench_octree: %s\n", error.text[0] ? error.text : "out of memory");
		return 1;
	}
	gw_status status = GW_OK;
	for (int i = 0; i < 2 && status == GW_OK; i++)
		status = measure(gpu, &surfels, depth, &error);
	if (status != GW_OK)
		fprintf(stderr, "bench_octree: %s\n", error.text);
	gw_surfels_clear(&surfels);
	gw_gpu_destroy(&gpu);
	return status == GW_OK ? 0 : 1;
}

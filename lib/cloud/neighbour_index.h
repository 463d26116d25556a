/*
 * neighbour_index.h - FLANN's exact k-d trees, behind functions that throw nothing.
 */
#ifndef NEIGHBOUR_INDEX_H
#define NEIGHBOUR_INDEX_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct gw_neighbour_index gw_neighbour_index;

/*
 * Builds trees over count (1..2^30) finite points of about unit size.
 *   position  3 * count; not used any more when this returns
 *   threads   0 means one a processor; what is found does not depend on it
 * Returns NULL when memory is short, or points are not finite after all.
 */
gw_neighbour_index *gw_neighbour_index_build(const float *position, size_t count, uint32_t threads);
void gw_neighbour_index_free(gw_neighbour_index *index);

/*
 * From now on some points are not found any more.
 *   gone  one a point: 1 where it is left out. Referred to until the index is freed; may change
 *         between searches
 */
void gw_neighbour_index_leave_out(gw_neighbour_index *index, const uint8_t *gone);

/*
 * Finds the k points nearest to each of query_count queries, nearest first, and of points that are
 * equally far those of the lowest numbers. Several threads may search one index at the same time.
 *   k         1..number of points in the tree that are not left out
 *   found     k * query_count indices
 *   squared   k * query_count squared distances
 * Returns false when memory is short, or a query is not finite.
 */
bool gw_neighbour_index_search(const gw_neighbour_index *index, const float *query,
							   size_t query_count, size_t k, int *found, float *squared);

#ifdef __cplusplus
}
#endif

#endif

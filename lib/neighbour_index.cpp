/* neighbour_index.cpp - see neighbour_index.h. C++ because FLANN's C interface lets std::bad_alloc
 * through, which only C++ can stop. */
#include "neighbour_index.h"

#include <flann/flann.h>

#include <new>

struct gw_neighbour_index {
	flann_index_t tree;
	FLANNParameters parameters;
};

/* One thread a call: parallel work is up to the caller. Leaves of 24 points searched fastest. */
static FLANNParameters exact_search(void)
{
	FLANNParameters parameters = DEFAULT_FLANN_PARAMETERS;
	parameters.algorithm = FLANN_INDEX_KDTREE_SINGLE;
	parameters.leaf_max_size = 24;
	parameters.checks = FLANN_CHECKS_UNLIMITED;
	parameters.eps = 0.0f;
	parameters.sorted = 1;
	parameters.cores = 1;
	parameters.log_level = FLANN_LOG_NONE;
	parameters.random_seed = 0; /* nothing here is random: leave the process's generator alone */
	return parameters;
}

extern "C" gw_neighbour_index *gw_neighbour_index_build(float *position, size_t count)
{
	gw_neighbour_index *index = new (std::nothrow) gw_neighbour_index;
	if (!index)
		return nullptr;
	try {
		float speedup = 0.0f;
		index->parameters = exact_search();
		index->tree = flann_build_index_float(position, static_cast<int>(count), 3, &speedup,
											  &index->parameters);
	} catch (...) {
		index->tree = nullptr;
	}
	if (!index->tree) {
		delete index;
		return nullptr;
	}
	return index;
}

extern "C" void gw_neighbour_index_free(gw_neighbour_index *index)
{
	if (!index)
		return;
	try {
		flann_free_index_float(index->tree, &index->parameters);
	} catch (...) {
		/* Nothing is left to be done with a tree that cannot be freed. */
	}
	delete index;
}

extern "C" bool gw_neighbour_index_search(const gw_neighbour_index *index, float *query,
										  size_t query_count, size_t k, int *found, float *squared)
{
	try {
		FLANNParameters parameters = index->parameters;
		return flann_find_nearest_neighbors_index_float(
				   index->tree, query, static_cast<int>(query_count), found, squared,
				   static_cast<int>(k), &parameters) == 0;
	} catch (...) {
		return false;
	}
}

/*
 * neighbour_index.cpp - see neighbour_index.h. FLANN's templates are compiled here: its library
 * runs them in parallel regions of OpenMP, and an exception that would leave one, as when memory is
 * short, ends the program.
 */
#include "cloud/neighbour_index.h"

#include <cmath>
#include <limits>
#include <stdio.h>
#include <stdlib.h>
#include <new>
#include <vector>

/* FLANN's pool of nodes goes on with NULL when there is no memory: it is given a malloc that throws
 * instead. */
static void *malloc_or_throw(size_t bytes)
{
	void *memory = std::malloc(bytes);
	if (!memory)
		throw std::bad_alloc();
	return memory;
}
#define malloc malloc_or_throw
#include <flann/util/allocator.h>
#undef malloc

/* Of points that are equally far the first ones count, as in the library. */
#define FLANN_FIRST_MATCH
#include <flann/algorithms/dist.h>
#include <flann/algorithms/kdtree_single_index.h>

namespace
{

typedef flann::KDTreeSingleIndex<flann::L2<float>> tree_of_points;

/* So many results are kept in a sorted list, more in a heap: what FLANN does. */
const size_t LIST_MOST = KNN_HEAP_THRESHOLD;

/* The nearest ones so far, nearest first and of equally far ones in the order of their numbers: as
 * FLANN's KNNSimpleResultSet keeps them, but where they are to go, and half as many bytes each. */
class sorted_list final : public flann::ResultSet<float>
{
  public:
	sorted_list(size_t most, int *index_to, float *distance_to)
		: index(index_to), distance(distance_to), capacity(most), count(0),
		  worst(std::numeric_limits<float>::max())
	{
	}

	bool full() const override
	{
		return count == capacity;
	}

	float worstDist() const override
	{
		return worst;
	}

	void addPoint(float far, size_t number) override
	{
		const int own = static_cast<int>(number);
		if (far >= worst)
			return;
		size_t at = count < capacity ? count++ : capacity - 1;
		for (; at > 0 && comes_after(at - 1, far, own); at--) {
			distance[at] = distance[at - 1];
			index[at] = index[at - 1];
		}
		distance[at] = far;
		index[at] = own;
		if (full())
			worst = distance[capacity - 1];
	}

  private:
	int *index;
	float *distance;
	size_t capacity, count;
	float worst;

	bool comes_after(size_t at, float far, int number) const
	{
		return distance[at] > far || (distance[at] == far && index[at] > number);
	}
};

/* The neighbours of all queries; false when there are fewer than k, as of a query that is not
 * finite. */
bool search_few(const tree_of_points &tree, const float *query, size_t query_count, size_t k,
				int *found, float *squared)
{
	const flann::SearchParams parameters(flann::FLANN_CHECKS_UNLIMITED, 0.0f, true);
	for (size_t i = 0; i < query_count; i++) {
		sorted_list nearest(k, found + k * i, squared + k * i);
		tree.findNeighbors(nearest, query + 3 * i, parameters);
		if (!nearest.full())
			return false;
	}
	return true;
}

/* The same of so many that they are kept in a heap. */
bool search_many(const tree_of_points &tree, const float *query, size_t query_count, size_t k,
				 int *found, float *squared)
{
	const flann::SearchParams parameters(flann::FLANN_CHECKS_UNLIMITED, 0.0f, true);
	flann::KNNResultSet2<float> nearest(k);
	std::vector<size_t> index(k);
	for (size_t i = 0; i < query_count; i++) {
		nearest.clear();
		tree.findNeighbors(nearest, query + 3 * i, parameters);
		if (nearest.size() < k)
			return false;
		nearest.copy(index.data(), squared + k * i, k, true);
		for (size_t j = 0; j < k; j++)
			found[k * i + j] = static_cast<int>(index[j]);
	}
	return true;
}

} // namespace

struct gw_neighbour_index {
	tree_of_points tree;

	/* Leaves of 24 points searched fastest. */
	gw_neighbour_index(float *position, size_t count)
		: tree(flann::Matrix<float>(position, count, 3), flann::KDTreeSingleIndexParams(24))
	{
		tree.buildIndex();
	}
};

extern "C" gw_neighbour_index *gw_neighbour_index_build(float *position, size_t count)
{
	/* Trees of numbers that are not finite have no end. */
	for (size_t i = 0; i < 3 * count; i++)
		if (!std::isfinite(position[i]))
			return nullptr;
	try {
		return new gw_neighbour_index(position, count);
	} catch (...) {
		return nullptr;
	}
}

extern "C" void gw_neighbour_index_free(gw_neighbour_index *index)
{
	delete index;
}

extern "C" bool gw_neighbour_index_search(const gw_neighbour_index *index, const float *query,
										  size_t query_count, size_t k, int *found, float *squared)
{
	try {
		if (k > LIST_MOST)
			return search_many(index->tree, query, query_count, k, found, squared);
		return search_few(index->tree, query, query_count, k, found, squared);
	} catch (...) {
		return false;
	}
}

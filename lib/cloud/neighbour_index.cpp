/*
 * neighbour_index.cpp - see neighbour_index.h. FLANN's templates are compiled here: its library
 * runs them in parallel regions of OpenMP, and an exception that would leave one, as when memory is
 * short, ends the program.
 *
 * FLANN builds a tree on one thread. So space is halved, and halved again, until there are some
 * parts with as many points each, which have a tree each; a search asks those whose bounds are near
 * enough, and seldom more than one are.
 */
#include "cloud/neighbour_index.h"

#include "base/memory.h"
#include "glowworm_host.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <numeric>
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

#include <flann/algorithms/dist.h>
#include <flann/algorithms/kdtree_single_index.h>

namespace
{

/* Space is halved while trees keep so many points, so often at most: searches look at the bounds of
 * all trees. */
const size_t TREE_LEAST = 16384;
const size_t HALVINGS_MOST = 6;

/* Points of an index whose memory is worth giving back at once. */
const size_t LARGE = 1 << 17;

/* Leaves of so many points searched fastest. */
const int LEAF_POINTS = 24;

/* FLANN keeps more results than this in a heap. */
const size_t LIST_MOST = KNN_HEAP_THRESHOLD;

/* The nearest ones so far, and of equally far ones those of the lowest numbers: which they are does
 * not depend on the order in which they are found. `most` above 0. */
class nearest_points : public flann::ResultSet<float>
{
  public:
	nearest_points(size_t most, int *index_to, float *distance_to)
		: index(index_to), distance(distance_to), capacity(most), count(0),
		  beyond(std::numeric_limits<float>::max())
	{
	}

	/* Of the tree that is searched: the numbers of its points. */
	const int *number = nullptr;

	/* Which of all points are left out, or none. */
	const uint8_t *gone = nullptr;

	bool full() const override
	{
		return count == capacity;
	}

	/* What is as far as this need not be looked at. */
	float worstDist() const override
	{
		return beyond;
	}

  protected:
	int *index;
	float *distance;
	size_t capacity, count;
	float beyond;

	/* To be called after each addition; `at` is where the furthest one is. FLANN looks no further
	 * than a few numbers beyond it: by so much its sums of distances from planes are off. */
	void note_furthest(size_t at)
	{
		const uint32_t room = 8, largest = 0x7f7fffff;
		uint32_t bits;
		if (!full())
			return;
		std::memcpy(&bits, distance + at, sizeof bits);
		bits = std::min(bits + room, largest);
		std::memcpy(&beyond, &bits, sizeof bits);
	}

	bool comes_after(size_t at, float far, int number) const
	{
		return distance[at] > far || (distance[at] == far && index[at] > number);
	}
};

/* Kept nearest first. */
class sorted_list final : public nearest_points
{
  public:
	using nearest_points::nearest_points;

	void addPoint(float far, size_t of_tree) override
	{
		const int own = number[of_tree];
		size_t at = count;
		if (gone && gone[own])
			return;
		if (!full())
			count++;
		else if (comes_after(capacity - 1, far, own))
			at = capacity - 1;
		else
			return;
		for (; at > 0 && comes_after(at - 1, far, own); at--) {
			distance[at] = distance[at - 1];
			index[at] = index[at - 1];
		}
		distance[at] = far;
		index[at] = own;
		note_furthest(capacity - 1);
	}
};

/* Kept in a heap until all are found. */
class heap final : public nearest_points
{
  public:
	heap(size_t most, int *index_to, float *distance_to)
		: nearest_points(most, index_to, distance_to)
	{
		kept.reserve(most);
	}

	void addPoint(float far, size_t of_tree) override
	{
		const entry own = { far, number[of_tree] };
		if (gone && gone[own.index])
			return;
		if (full()) {
			if (!(own < kept.front()))
				return;
			std::pop_heap(kept.begin(), kept.end());
			kept.back() = own;
		} else {
			kept.push_back(own);
			count++;
		}
		std::push_heap(kept.begin(), kept.end());
		distance[0] = kept.front().distance;
		note_furthest(0);
	}

	void write()
	{
		std::sort_heap(kept.begin(), kept.end());
		for (size_t i = 0; i < kept.size(); i++) {
			distance[i] = kept[i].distance;
			index[i] = kept[i].index;
		}
	}

  private:
	struct entry {
		float distance;
		int index;

		bool operator<(const entry &other) const
		{
			return distance < other.distance || (distance == other.distance && index < other.index);
		}
	};

	std::vector<entry> kept;
};

/* FLANN's list of pointers to the points, which its trees keep to themselves. */
struct pointers_to_points : flann::NNIndex<flann::L2<float>> {
	static auto member()
	{
		return &pointers_to_points::points_;
	}
};

/* FLANN's tree over a copy of the points, in the order of its leaves, without the list of pointers
 * to them by which it was built. */
class tree_of_points final : public flann::KDTreeSingleIndex<flann::L2<float>>
{
  public:
	tree_of_points(float *position, size_t count)
		: flann::KDTreeSingleIndex<flann::L2<float>>(flann::Matrix<float>(position, count, 3),
													 flann::KDTreeSingleIndexParams(LEAF_POINTS))
	{
		buildIndex();
		std::vector<float *>().swap(this->*pointers_to_points::member());
	}
};

/* Of two halves one has the points up to it, the other those from it on. */
struct plane {
	size_t axis;
	float at;
};

/* A part of the points: their numbers, in no order, and a tree over them. */
struct part {
	int *number;
	size_t count;
	float low[3], high[3];
	std::unique_ptr<tree_of_points> tree;

	/* The squared distance of a query from the bounds: never above FLANN's of a point within. */
	float squared_distance(const float *query) const
	{
		float sum = 0;
		for (int k = 0; k < 3; k++) {
			float off = std::max(std::max(low[k] - query[k], query[k] - high[k]), 0.0f);
			sum += off * off;
		}
		return sum;
	}

	void bound(const float *position)
	{
		for (int k = 0; k < 3; k++)
			low[k] = high[k] = position[3 * static_cast<size_t>(number[0]) + k];
		for (size_t i = 0; i < count; i++) {
			const float *point = position + 3 * static_cast<size_t>(number[i]);
			for (int k = 0; k < 3; k++) {
				low[k] = std::min(low[k], point[k]);
				high[k] = std::max(high[k], point[k]);
			}
		}
	}

	/* Leaves half of the points to another part, those beyond a plane across the longest side. */
	plane halve(const float *position, part &other)
	{
		size_t axis = 0, kept = count / 2;
		bound(position);
		for (size_t k = 1; k < 3; k++)
			axis = high[k] - low[k] > high[axis] - low[axis] ? k : axis;
		auto along = [=](int i) { return position[3 * static_cast<size_t>(i) + axis]; };
		std::nth_element(number, number + kept, number + count,
						 [=](int a, int b) { return along(a) < along(b); });
		other.number = number + kept;
		other.count = count - kept;
		count = kept;
		return { axis, along(other.number[0]) };
	}

	void build(const float *position)
	{
		std::vector<float> own(3 * count);
		bound(position);
		for (size_t i = 0; i < count; i++)
			std::copy_n(position + 3 * static_cast<size_t>(number[i]), 3, own.data() + 3 * i);
		tree.reset(new tree_of_points(own.data(), count));
	}
};

} // namespace

struct gw_neighbour_index {
	const float *position;   /* while it is built */
	std::vector<int> number; /* of all points, part by part */
	std::vector<part> parts;
	std::vector<plane> planes; /* of part i, once there were n: the (n + i)-th */
	const uint8_t *gone = nullptr;
	size_t halved = 0; /* so many parts there are yet */
	std::atomic<bool> failed{ false };
};

/* The part that a query lies in, and how far the planes are that bound it, squared: never above
 * FLANN's distance of a point beyond. */
static size_t part_of(const gw_neighbour_index &index, const float *query, float *within)
{
	size_t own = 0;
	*within = std::numeric_limits<float>::infinity();
	for (size_t n = 1; n < index.parts.size(); n *= 2) {
		const plane &between = index.planes[n + own];
		float off = query[between.axis] - between.at;
		*within = std::min(*within, off * off);
		own += off >= 0.0f ? n : 0;
	}
	return own;
}

static void find_in(const part &own, const float *query, nearest_points &nearest)
{
	const flann::SearchParams parameters(flann::FLANN_CHECKS_UNLIMITED, 0.0f, true);
	nearest.number = own.number;
	own.tree->findNeighbors(nearest, query, parameters);
}

static void find(const gw_neighbour_index &index, const float *query, nearest_points &nearest)
{
	float within;
	size_t own = part_of(index, query, &within);
	nearest.gone = index.gone;
	find_in(index.parts[own], query, nearest);
	for (size_t i = 0; i < index.parts.size() && within < nearest.worstDist(); i++)
		if (i != own && index.parts[i].squared_distance(query) < nearest.worstDist())
			find_in(index.parts[i], query, nearest);
}

/* Calls a function of the index and a part, on several threads. */
template <void (*work)(gw_neighbour_index &, size_t)>
static void for_parts(gw_neighbour_index &index, size_t count, uint32_t threads)
{
	gw_parallel_for(
		threads, count, 1,
		[](void *user, size_t first, size_t last, uint32_t) {
			gw_neighbour_index &all = *static_cast<gw_neighbour_index *>(user);
			try {
				for (size_t i = first; i < last && !all.failed; i++)
					work(all, i);
			} catch (...) {
				all.failed = true;
			}
		},
		&index);
}

/* The other half of a part comes as far behind it as there were parts. */
static void halve_part(gw_neighbour_index &index, size_t i)
{
	index.planes[index.halved + i] =
		index.parts[i].halve(index.position, index.parts[index.halved + i]);
}

static void build_part(gw_neighbour_index &index, size_t i)
{
	index.parts[i].build(index.position);
}

/* Trees of numbers that are not finite have no end. */
static bool all_finite(const float *position, size_t count)
{
	for (size_t i = 0; i < 3 * count; i++)
		if (!std::isfinite(position[i]))
			return false;
	return true;
}

extern "C" gw_neighbour_index *gw_neighbour_index_build(const float *position, size_t count,
														uint32_t threads)
{
	size_t halvings = 0;
	while (halvings < HALVINGS_MOST && count >> (halvings + 1) >= TREE_LEAST)
		halvings++;
	if (!all_finite(position, count))
		return nullptr;
	try {
		std::unique_ptr<gw_neighbour_index> index(new gw_neighbour_index);
		index->position = position;
		index->number.resize(count);
		std::iota(index->number.begin(), index->number.end(), 0);
		index->parts.resize(size_t(1) << halvings);
		index->planes.resize(index->parts.size());
		index->parts[0].number = index->number.data();
		index->parts[0].count = count;
		for (index->halved = 1; index->halved < index->parts.size(); index->halved *= 2)
			for_parts<halve_part>(*index, index->halved, threads);
		for_parts<build_part>(*index, index->parts.size(), threads);
		index->position = nullptr;
		return index->failed ? nullptr : index.release();
	} catch (...) {
		return nullptr;
	}
}

/* Trees are of many blocks, which threads take from heaps of their own and which the C library
 * would keep for others. */
extern "C" void gw_neighbour_index_free(gw_neighbour_index *index)
{
	bool large = index && index->number.size() >= LARGE;
	delete index;
	if (large)
		gw_give_back_memory();
}

extern "C" void gw_neighbour_index_leave_out(gw_neighbour_index *index, const uint8_t *gone)
{
	index->gone = gone;
}

/* False when there are fewer than k, as of a query that is not finite. */
extern "C" bool gw_neighbour_index_search(const gw_neighbour_index *index, const float *query,
										  size_t query_count, size_t k, int *found, float *squared)
{
	try {
		for (size_t i = 0; i < query_count; i++) {
			if (k > LIST_MOST) {
				heap nearest(k, found + k * i, squared + k * i);
				find(*index, query + 3 * i, nearest);
				nearest.write();
				if (!nearest.full())
					return false;
			} else {
				sorted_list nearest(k, found + k * i, squared + k * i);
				find(*index, query + 3 * i, nearest);
				if (!nearest.full())
					return false;
			}
		}
		return true;
	} catch (...) {
		return false;
	}
}

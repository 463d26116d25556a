/* neighbours.c - the nearest neighbours of all surfels, chunk by chunk; see surfel_steps.h. */
#include "surfel_steps.h"

#include "memory.h"
#include "neighbour_index.h"
#include "parallel.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

#define CHUNK 1024u        /* surfels searched by one call */
#define BLOCK (256u * CHUNK) /* surfels between two looks at `cancelled` */
#define SEARCHED (GW_NEIGHBOURS + 1) /* a point is its own nearest neighbour */

/* Bytes a surfel that the tree takes: scaled positions, FLANN's copy, row pointers, order, nodes. */
#define INDEX_BYTES 56u

/* Results of one chunk's search. */
typedef struct chunk_result {
	int found[CHUNK * SEARCHED];
	float squared[CHUNK * SEARCHED];
} chunk_result;

struct gw_neighbours {
	const gw_surfels *surfels;
	const gw_surfels_options *options;
	gw_neighbour_index *index;
	float *scaled;          /* 3 * count, positions times a power of two: about unit size */
	uint32_t per_surfel;    /* neighbours of each surfel: min(GW_NEIGHBOURS, count - 1) */
	uint32_t *stored;       /* NULL or per_surfel * count, lists found by the first visit */
	bool is_stored;         /* whether the first visit has filled it */
	chunk_result *scratch;  /* one a thread */
	uint32_t threads;
	atomic_bool out_of_memory;
};

/* One visit. */
typedef struct visit {
	gw_neighbours *search;
	gw_neighbours_visitor *function;
	void *user;
	size_t first; /* of the block */
} visit;

static double distance_between(const gw_surfels *s, size_t a, size_t b)
{
	double d[3];
	for (size_t k = 0; k < 3; k++)
		d[k] = (double)s->position[3 * a + k] - (double)s->position[3 * b + k];
	return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

static double maximum_norm_between(const gw_surfels *s, size_t a, size_t b)
{
	double largest = 0;
	for (size_t k = 0; k < 3; k++)
		largest = fmax(largest, fabs((double)s->position[3 * a + k] - (double)s->position[3 * b + k]));
	return largest;
}

/* Positions times a power of two: nothing is rounded, and squares neither overflow nor underflow. */
static void scale_positions(gw_neighbours *search)
{
	const gw_surfels *s = search->surfels;
	float extent = 0;
	for (int k = 0; k < 3; k++)
		extent = fmaxf(extent, s->maximum[k] - s->minimum[k]);
	double scale = extent > 0 ? ldexp(1, -ilogb((double)extent)) : 1;
	for (size_t i = 0; i < 3 * s->count; i++)
		search->scaled[i] = (float)((double)s->position[i] * scale);
}

gw_status gw_neighbours_open(const gw_surfels *surfels, const gw_surfels_options *options,
                             bool keep, gw_neighbours **search, gw_error *error)
{
	size_t count = surfels->count;
	uint64_t index_bytes = count * (uint64_t)INDEX_BYTES;
	if (options->memory && index_bytes > options->memory)
		return gw_fail(error, GW_ERROR_MEMORY,
		               "the search tree of %zu points takes %llu bytes, %llu may be used; allow "
		               "more memory or use fewer points",
		               count, (unsigned long long)index_bytes,
		               (unsigned long long)options->memory);
	gw_neighbours *s = gw_allocate_zeros(1, sizeof *s);
	if (!s)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the neighbours");
	s->surfels = surfels;
	s->options = options;
	s->threads = gw_thread_count(options->threads);
	s->per_surfel = count > GW_NEIGHBOURS ? GW_NEIGHBOURS : (uint32_t)count - 1;
	s->scratch = gw_allocate_array(s->threads, sizeof *s->scratch);
	s->scaled = gw_allocate_array(count, 3 * sizeof *s->scaled);
	uint64_t stored_bytes = count * (uint64_t)(GW_NEIGHBOURS * sizeof *s->stored);
	if (keep && (!options->memory || stored_bytes <= options->memory - index_bytes))
		s->stored = gw_allocate_array(count, GW_NEIGHBOURS * sizeof *s->stored);
	if (s->scratch && s->scaled) {
		scale_positions(s);
		s->index = gw_neighbour_index_build(s->scaled, count);
	}
	if (!s->index) {
		gw_neighbours_close(s);
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the search tree of %zu points", count);
	}
	*search = s;
	return GW_OK;
}

void gw_neighbours_close(gw_neighbours *search)
{
	if (!search)
		return;
	gw_neighbour_index_free(search->index);
	free(search->scaled);
	free(search->stored);
	free(search->scratch);
	free(search);
}

/* Inserts a neighbour where (distance, index) belongs. */
static void insert_neighbour(gw_neighbour_list *list, uint32_t index, float distance)
{
	uint32_t at = list->count++;
	for (; at > 0 && (distance < list->distance[at - 1] ||
	                  (distance == list->distance[at - 1] && index < list->index[at - 1]));
	     at--) {
		list->index[at] = list->index[at - 1];
		list->distance[at] = list->distance[at - 1];
	}
	list->index[at] = index;
	list->distance[at] = distance;
}

static void fill_list(const gw_neighbours *search, size_t surfel, const int *found,
                      gw_neighbour_list *list)
{
	list->count = 0;
	for (uint32_t j = 0; j <= search->per_surfel && list->count < search->per_surfel; j++) {
		uint32_t other = (uint32_t)found[j];
		if (other != surfel)
			insert_neighbour(list, other, (float)distance_between(search->surfels, surfel, other));
	}
}

static void restore_list(const gw_neighbours *search, size_t surfel, gw_neighbour_list *list)
{
	const uint32_t *stored = search->stored + surfel * search->per_surfel;
	list->count = search->per_surfel;
	for (uint32_t j = 0; j < list->count; j++) {
		list->index[j] = stored[j];
		list->distance[j] = (float)distance_between(search->surfels, surfel, stored[j]);
	}
}

static void visit_chunk(void *user, size_t first, size_t last, uint32_t worker)
{
	const visit *v = user;
	gw_neighbours *search = v->search;
	chunk_result *result = search->scratch + worker;
	size_t k = search->per_surfel + 1u;
	bool searching = !search->stored || !search->is_stored;
	first += v->first;
	last += v->first;
	if (searching && !gw_neighbour_index_search(search->index, search->scaled + 3 * first,
	                                            last - first, k, result->found, result->squared)) {
		atomic_store(&search->out_of_memory, true);
		return;
	}
	for (size_t i = first; i < last; i++) {
		gw_neighbour_list list;
		if (searching)
			fill_list(search, i, result->found + (i - first) * k, &list);
		else
			restore_list(search, i, &list);
		if (searching && search->stored)
			for (uint32_t j = 0; j < list.count; j++)
				search->stored[i * search->per_surfel + j] = list.index[j];
		v->function(v->user, i, &list);
	}
}

gw_status gw_neighbours_visit(gw_neighbours *search, gw_neighbours_visitor *function, void *user,
                              gw_error *error)
{
	const gw_surfels_options *options = search->options;
	visit v = { .search = search, .function = function, .user = user };
	for (; v.first < search->surfels->count; v.first += BLOCK) {
		if (options->cancelled && options->cancelled(options->user))
			return gw_fail(error, GW_ERROR_CANCELLED, "stopped while describing the surface");
		size_t left = search->surfels->count - v.first;
		gw_parallel_for(search->threads, left < BLOCK ? left : BLOCK, CHUNK, visit_chunk, &v);
		if (atomic_load(&search->out_of_memory))
			return gw_fail(error, GW_ERROR_MEMORY, "no memory to search for neighbours");
	}
	search->is_stored = true;
	return GW_OK;
}

/* Searches k neighbours of one surfel; the least distance in the maximum norm goes to *nearest and
 * the Euclidean distance of the last one to *reach. */
static bool search_further(gw_neighbours *search, size_t surfel, size_t k, double *nearest,
                           double *reach)
{
	int *found = gw_allocate_array(k, sizeof *found);
	float *squared = gw_allocate_array(k, sizeof *squared);
	bool good = found && squared &&
	            gw_neighbour_index_search(search->index, search->scaled + 3 * surfel, 1, k, found,
	                                      squared);
	*reach = 0;
	for (size_t j = 0; good && j < k; j++) {
		size_t other = (size_t)found[j];
		if (other == surfel)
			continue;
		*nearest = fmin(*nearest, maximum_norm_between(search->surfels, surfel, other));
		*reach = fmax(*reach, distance_between(search->surfels, surfel, other));
	}
	free(found);
	free(squared);
	return good;
}

/*
 * FLANN's trees do not take the maximum norm |.|m, but |d|m <= |d| <= sqrt(3) |d|m. Let m be the
 * least maximum-norm distance among the k Euclidean neighbours. A point with |d|m < m has
 * |d| < sqrt(3) m; so when the k-th neighbour is sqrt(3) m or more away, such a point would be one
 * of the k, and m is exact. Otherwise more neighbours are searched until that holds. A margin of
 * 1e-5 covers the rounding of FLANN's float32 distances.
 */
float gw_neighbours_nearest(gw_neighbours *search, size_t surfel, const gw_neighbour_list *list)
{
	const double bound = 1.7320508 * (1 + 1e-5);
	if (list->count == 0)
		return INFINITY;
	double nearest = INFINITY, reach = (double)list->distance[list->count - 1];
	for (uint32_t j = 0; j < list->count; j++)
		nearest = fmin(nearest, maximum_norm_between(search->surfels, surfel, list->index[j]));
	size_t count = search->surfels->count;
	for (size_t k = SEARCHED; k < count && reach < bound * nearest;) {
		k = k < count / 2 ? 2 * k : count;
		if (!search_further(search, surfel, k, &nearest, &reach)) {
			atomic_store(&search->out_of_memory, true);
			break;
		}
	}
	return (float)nearest;
}

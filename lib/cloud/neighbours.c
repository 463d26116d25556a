/* neighbours.c - the nearest neighbours of all surfels, chunk by chunk. */
#include "cloud/neighbours.h"

#include "base/memory.h"
#include "cloud/neighbour_index.h"
#include "cloud/neighbour_scales.h"
#include "cloud/unit_places.h"
#include "base/parallel.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#define CHUNK 1024u                  /* surfels searched by one call, or numbers of a loop */
#define SEARCHED (GW_NEIGHBOURS + 1) /* a point is its own nearest neighbour */

/* Neighbours lie on a line when their squared distances from it are below this share of all squared
 * distances: for half of the list, which random points on a surface hardly ever are, and for all.
 */
#define LINE_SHARE_NEAREST 0.02
#define LINE_SHARE 0.06

/*
 * A line that noise has made wide holds more of them. Noise along one direction makes a strip of it
 * that looks like narrow surface across. But what lies beside narrow surface are the faces at its
 * edges, half its width off its middle, so that their variance is 3 times its own; and beside a
 * noisy line are more points of the same surface, with the same noise. It matters where a plane is
 * to be found; where all normals are given, twigs and wires are the more likely strips.
 */
#define STRIP_SHARE 0.25
#define STRIP_NOISE 2.0
#define STRIP_ACROSS 0.5 /* of the variance across a strip: as much is along the normal */

/*
 * Points lie in rows, as those of a scanner with some dozens of beams, where a third of a chunk's
 * lists, of so many, are strips, as hardly one in ten is on an even surface. There noise may be as
 * large as half of a list is long, and where beams graze the surface little of it is along the
 * normal.
 */
#define ROW_PLACES 64u
#define ROW_SHARE 0.45 /* as STRIP_SHARE there */
#define ROW_ACROSS 0.1 /* as STRIP_ACROSS */

/* With normals lists that are no strips are widened, too, where so many times their reach are
 * GW_NEIGHBOURS_WIDE surfels: on an even surface these reach 2.8 times as far, along a row 8. A
 * row's surface goes on where so many neighbours beside it, three quarters of them, face alike and
 * lie no further off its plane for their distance. */
#define ROW_REACH 3.4
#define BESIDE_LEAST 4u
#define ROW_SLOPE 0.35

#define AXIS_ROUNDS 6 /* of power iteration: each leaves below a third of what an axis is off */

/* Of a list that was widened: how many are the nearest; and the least distance between the others,
 * relative to the reach of the wide search, with which some ten of them fit. */
#define NEAREST_KEPT (GW_NEIGHBOURS / 2)
#define SPREAD 0.37

/* Marks the first index of a stored list that was widened, the second one where that was done to
 * the surfel's own scale, and the third one where points lie in rows; indices are below 2^30. */
#define WIDENED (1u << 31)
#define NO_NEIGHBOUR (UINT32_MAX & ~WIDENED)

/* One wide search serves the surfels around its centre, up to this share of its reach away. */
#define WIDE_SHARED 0.25

/* The surfels around one, itself included. */
typedef struct wide_search {
	size_t centre;
	double reach;   /* distance of the furthest */
	uint32_t count; /* 0: nothing was searched yet */
	uint32_t index[GW_NEIGHBOURS_WIDE];
} wide_search;

/* A thread's memory: the results of one chunk's search. */
typedef struct chunk_result {
	float query[3 * CHUNK];
	int found[CHUNK * SEARCHED];
	float squared[CHUNK * SEARCHED];
	wide_search wide; /* starts anew with every chunk, so that threads make no difference */
} chunk_result;

struct gw_neighbours {
	const gw_surfels *surfels;
	const gw_surfels_options *options;
	gw_neighbour_index *index;
	gw_neighbour_scales *scales;
	double scale;          /* a power of two; positions times it are of about unit size */
	uint32_t per_surfel;   /* neighbours of each surfel: min(GW_NEIGHBOURS, count - 1) */
	uint32_t *stored;      /* NULL or per_surfel * count, lists found by the first visit */
	bool is_stored;        /* whether the first visit has filled it */
	chunk_result *scratch; /* one a thread */
	uint32_t threads;
	atomic_bool out_of_memory, stopped;
};

/* One visit. */
typedef struct visit {
	gw_neighbours *search;
	gw_neighbours_visitor *function;
	void *user;
	bool measured; /* with all distances */
} visit;

static double distance_between(const gw_surfels *s, size_t a, size_t b)
{
	const float *p = s->position + 3 * a, *q = s->position + 3 * b;
	double x = (double)p[0] - (double)q[0];
	double y = (double)p[1] - (double)q[1];
	double z = (double)p[2] - (double)q[2];
	return sqrt(x * x + y * y + z * z);
}

static double maximum_norm_between(const gw_surfels *s, size_t a, size_t b)
{
	double largest = 0;
	for (size_t k = 0; k < 3; k++)
		largest =
			fmax(largest, fabs((double)s->position[3 * a + k] - (double)s->position[3 * b + k]));
	return largest;
}

static void scale_positions(const gw_neighbours *search, size_t first, size_t last, float *scaled)
{
	for (size_t i = first; i < last; i++)
		gw_unit_place(search->surfels, i, search->scale, scaled + 3 * (i - first));
}

/* False when memory is short. */
static bool build_index(gw_neighbours *search)
{
	const gw_surfels *s = search->surfels;
	search->scale = gw_unit_scale(s);
	float *scaled = gw_allocate_array(s->count, 3 * sizeof *scaled);
	if (scaled) {
		scale_positions(search, 0, s->count, scaled);
		search->index = gw_neighbour_index_build(scaled, s->count, search->threads);
	}
	free(scaled);
	return search->index;
}

static bool search_one(const gw_neighbours *search, size_t surfel, size_t k, int *found,
					   float *squared)
{
	float query[3];
	scale_positions(search, surfel, surfel + 1, query);
	return gw_neighbour_index_search(search->index, query, 1, k, found, squared);
}

gw_status gw_neighbours_open(const gw_surfels *surfels, const gw_surfels_options *options,
							 gw_neighbours **search, gw_error *error)
{
	size_t count = surfels->count;
	uint64_t index_bytes = count * (uint64_t)GW_NEIGHBOURS_TREE_BYTES;
	if (options->memory && index_bytes > options->memory)
		return gw_fail(error, GW_ERROR_MEMORY,
					   "the search tree of %zu points takes %llu bytes, %llu may be used; allow "
					   "more memory or use fewer points",
					   count, (unsigned long long)index_bytes, (unsigned long long)options->memory);
	gw_neighbours *s = gw_allocate_zeros(1, sizeof *s);
	if (!s)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the neighbours");
	s->surfels = surfels;
	s->options = options;
	s->threads = gw_thread_count(options->threads);
	s->per_surfel = count > GW_NEIGHBOURS ? GW_NEIGHBOURS : (uint32_t)count - 1;
	s->scratch = gw_allocate_array(s->threads, sizeof *s->scratch);
	uint64_t stored_bytes = count * (uint64_t)(GW_NEIGHBOURS * sizeof *s->stored);
	if (!options->memory || stored_bytes <= options->memory - index_bytes)
		s->stored = gw_allocate_array(count, GW_NEIGHBOURS * sizeof *s->stored);
	if (s->scratch && build_index(s))
		s->scales = gw_neighbour_scales_open(surfels, s->index, s->scale, s->threads);
	if (!s->scales) {
		gw_neighbours_close(s);
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the search tree of %zu points",
					   count);
	}
	*search = s;
	return GW_OK;
}

void gw_neighbours_close(gw_neighbours *search)
{
	if (!search)
		return;
	gw_neighbour_index_free(search->index);
	gw_neighbour_scales_close(search->scales);
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
	list->complete = list->count;
	list->in_rows = false;
}

/* A surfel that may become a neighbour. */
typedef struct neighbour {
	uint32_t index;
	float distance;
} neighbour;

static void offset_of(const gw_surfels *s, size_t surfel, size_t other, double d[3])
{
	for (size_t k = 0; k < 3; k++)
		d[k] = (double)s->position[3 * other + k] - (double)s->position[3 * surfel + k];
}

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Whether the first `count` neighbours lie on a line through the surfel. */
static bool lies_on_line(const gw_surfels *s, size_t surfel, const gw_neighbour_list *list,
						 uint32_t count, double share)
{
	double axis[3], d[3], along = 0, total = 0;
	offset_of(s, surfel, list->index[count - 1], axis);
	for (uint32_t j = 0; j < count; j++) {
		offset_of(s, surfel, list->index[j], d);
		along += dot(d, axis) * dot(d, axis) / dot(axis, axis);
		total += dot(d, d);
	}
	return total - along < share * total;
}

static bool search_wide(gw_neighbours *search, size_t surfel, wide_search *wide)
{
	int found[GW_NEIGHBOURS_WIDE];
	float squared[GW_NEIGHBOURS_WIDE];
	size_t count = search->surfels->count;
	size_t k = count < GW_NEIGHBOURS_WIDE ? count : GW_NEIGHBOURS_WIDE;
	if (wide->count > 0 &&
		distance_between(search->surfels, surfel, wide->centre) <= WIDE_SHARED * wide->reach)
		return true;
	if (!search_one(search, surfel, k, found, squared)) {
		atomic_store(&search->out_of_memory, true);
		return false;
	}
	*wide = (wide_search){ .centre = surfel, .count = (uint32_t)k };
	for (size_t j = 0; j < k; j++) {
		wide->index[j] = (uint32_t)found[j];
		wide->reach = fmax(wide->reach, distance_between(search->surfels, surfel, wide->index[j]));
	}
	return true;
}

/* How surfels are spread about their middle: variances, m^2. */
typedef struct spread {
	double mean[3]; /* off the surfel that they are around */
	double matrix[3][3];
} spread;

static spread find_spread(const gw_surfels *s, size_t surfel, const uint32_t *index, uint32_t count)
{
	spread of = { .mean = { 0 } };
	double d[3];
	for (uint32_t j = 0; j < count; j++) {
		offset_of(s, surfel, index[j], d);
		for (int k = 0; k < 9; k++)
			of.matrix[k / 3][k % 3] += d[k / 3] * d[k % 3] / count;
		for (int k = 0; k < 3; k++)
			of.mean[k] += d[k] / count;
	}
	for (int k = 0; k < 9; k++)
		of.matrix[k / 3][k % 3] -= of.mean[k / 3] * of.mean[k % 3];
	return of;
}

static double spread_along(const spread *of, const double axis[3])
{
	double sum = 0;
	for (int k = 0; k < 3; k++)
		sum += axis[k] * dot(of->matrix[k], axis);
	return sum;
}

/* The axis along which a spread is largest, unit, and how large it is; taken out of it. */
static double take_largest(spread *of, double axis[3])
{
	int column = of->matrix[1][1] > of->matrix[0][0] ? 1 : 0;
	column = of->matrix[2][2] > of->matrix[column][column] ? 2 : column;
	memcpy(axis, of->matrix[column], 3 * sizeof *axis);
	double value = 0;
	for (int round = 0; round < AXIS_ROUNDS; round++) {
		double next[3];
		for (int k = 0; k < 3; k++)
			next[k] = dot(of->matrix[k], axis);
		value = sqrt(dot(next, next));
		for (int k = 0; k < 3 && value > 0; k++)
			axis[k] = next[k] / value;
	}
	double along = spread_along(of, axis);
	for (int k = 0; k < 9; k++)
		of->matrix[k / 3][k % 3] -= along * axis[k / 3] * axis[k % 3];
	return along;
}

static double trace_of(const spread *of)
{
	return of->matrix[0][0] + of->matrix[1][1] + of->matrix[2][2];
}

/* Whether the neighbours of a list are a strip, narrower than it is long. */
static bool is_strip(const spread *list, double share)
{
	spread rest = *list;
	double axis[3];
	take_largest(&rest, axis);
	return trace_of(&rest) < share * trace_of(list);
}

/* The least direction of a spread, not of unit length, out of its two largest. */
static void take_normal(const spread *of, double normal[3])
{
	spread rest = *of;
	double a[3], b[3];
	take_largest(&rest, a);
	take_largest(&rest, b);
	for (int k = 0; k < 3; k++)
		normal[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* Whether what lies around a strip is flat, the strip across it, and no thinner than all of it.
 *   across_least   share of the variance across the strip that is along the normal */
static bool is_noise_across(const spread *strip, const spread *around, double across_least)
{
	spread across = *strip;
	double normal[3], axis[3], own;
	take_normal(around, normal);
	take_largest(&across, axis);
	own = spread_along(strip, normal);
	return own > across_least * dot(normal, normal) * trace_of(&across) &&
		   spread_along(around, normal) < STRIP_NOISE * own;
}

/*
 * Where all that a wide search found is a strip as well, such as one ring of a scanner with few,
 * searches the cloud thinned to cells as wide as half of the list's reach. False where it is none.
 */
static bool search_wider(gw_neighbours *search, size_t surfel, double reach,
						 const wide_search *wide, wide_search *wider)
{
	const gw_surfels *s = search->surfels;
	const spread all = find_spread(s, surfel, wide->index, wide->count);
	if (!is_strip(&all, STRIP_SHARE))
		return false;
	*wider = (wide_search){ .centre = surfel };
	if (!gw_neighbour_scales_around(search->scales, surfel, 0.5 * reach, wider->index,
									&wider->count)) {
		atomic_store(&search->out_of_memory, true);
		return false;
	}
	for (uint32_t j = 0; j < wider->count; j++)
		wider->reach = fmax(wider->reach, distance_between(s, surfel, wider->index[j]));
	return wider->count > 0;
}

/* The candidates that are seen at 30 degrees or more from the line along which the nearest lie. */
static uint32_t leave_line(const gw_surfels *s, size_t surfel, const gw_neighbour_list *list,
						   const double axis[3], const wide_search *wide, neighbour *candidate)
{
	double d[3];
	uint32_t count = 0;
	for (uint32_t j = 0; j < wide->count; j++) {
		uint32_t other = wide->index[j];
		offset_of(s, surfel, other, d);
		bool near_line = dot(d, axis) * dot(d, axis) > 0.75 * dot(d, d) * dot(axis, axis);
		for (uint32_t i = 0; i < NEAREST_KEPT; i++)
			near_line |= other == list->index[i];
		if (other != surfel && !near_line)
			candidate[count++] = (neighbour){ other, (float)sqrt(dot(d, d)) };
	}
	return count;
}

static uint32_t nearest_candidate(const neighbour *candidate, uint32_t count)
{
	uint32_t best = 0;
	for (uint32_t j = 1; j < count; j++)
		if (candidate[j].distance < candidate[best].distance ||
			(candidate[j].distance == candidate[best].distance &&
			 candidate[j].index < candidate[best].index))
			best = j;
	return best;
}

/*
 * Replaces the second half of a list by the nearest candidates beside a line that are `apart` or
 * more from each other. False where there are none.
 */
static bool take_beside(const gw_surfels *s, size_t surfel, const double axis[3],
						const wide_search *wide, gw_neighbour_list *list)
{
	neighbour candidate[GW_NEIGHBOURS_WIDE];
	uint32_t count = leave_line(s, surfel, list, axis, wide, candidate);
	double apart = SPREAD * wide->reach;
	if (count == 0)
		return false;
	list->count = list->complete = NEAREST_KEPT;
	while (count > 0 && list->count < GW_NEIGHBOURS) {
		neighbour taken = candidate[nearest_candidate(candidate, count)];
		list->index[list->count] = taken.index;
		list->distance[list->count++] = taken.distance;
		uint32_t left = 0;
		for (uint32_t j = 0; j < count; j++)
			if (distance_between(s, candidate[j].index, taken.index) >= apart)
				candidate[left++] = candidate[j];
		count = left;
	}
	return true;
}

/* Whether a surfel's surface goes on, by its normals, where its widened list has neighbours beside
 * the line. */
static bool goes_on_beside(const gw_surfels *s, size_t surfel, const gw_neighbour_list *list)
{
	const float *n = s->normal + 3 * surfel;
	uint32_t beside = list->count - list->complete, level = 0;
	double d[3];
	for (uint32_t j = list->complete; j < list->count; j++) {
		const float *m = s->normal + 3 * (size_t)list->index[j];
		double cosine = (double)(n[0] * m[0] + n[1] * m[1] + n[2] * m[2]);
		offset_of(s, surfel, list->index[j], d);
		double height = d[0] * (double)n[0] + d[1] * (double)n[1] + d[2] * (double)n[2];
		level += cosine > GW_SAME_SURFACE && fabs(height) < ROW_SLOPE * sqrt(dot(d, d));
	}
	return beside >= BESIDE_LEAST && 4 * level >= 3 * beside;
}

/* Widens the list of a strip in a cloud in rows, if what is found beside it shows that it is one of
 * noise. */
static bool widen_strip(const gw_surfels *s, size_t surfel, const spread *strip,
						const wide_search *wide, gw_neighbour_list *list)
{
	gw_neighbour_list wider = *list;
	spread rest = *strip;
	double axis[3];
	take_largest(&rest, axis);
	if (!take_beside(s, surfel, axis, wide, &wider))
		return false;
	bool good = false;
	if (s->normals_given == s->count) {
		good = goes_on_beside(s, surfel, &wider);
	} else {
		const spread around = find_spread(s, surfel, wider.index, wider.count);
		good = is_noise_across(strip, &around, ROW_ACROSS);
	}
	if (good)
		*list = wider;
	return good;
}

/*
 * Widens a list where the nearest neighbours lie on a line, or on a strip that noise has made of
 * one. What is a line even then, such as a wire, keeps its list.
 */
static void widen_list(gw_neighbours *search, size_t surfel, wide_search *wide,
					   gw_neighbour_list *list)
{
	const gw_surfels *s = search->surfels;
	wide_search wider;
	double axis[3];
	if (list->count < GW_NEIGHBOURS)
		return;
	const spread own = find_spread(s, surfel, list->index, list->count);
	bool line = lies_on_line(s, surfel, list, NEAREST_KEPT, LINE_SHARE_NEAREST) ||
				lies_on_line(s, surfel, list, list->count, LINE_SHARE);
	double share = list->in_rows ? ROW_SHARE : STRIP_SHARE;
	bool given = s->normals_given == s->count;
	double reach = (double)list->distance[list->count - 1];
	if (!line && given && !list->in_rows)
		return;
	bool strip = is_strip(&own, share);
	if (!line && !given && !strip)
		return;
	if (!search_wide(search, surfel, wide))
		return;
	if (!line && !strip && !(wide->reach > ROW_REACH * reach))
		return;
	if (!line && list->in_rows) {
		if (!widen_strip(s, surfel, &own, wide, list) &&
			search_wider(search, surfel, reach, wide, &wider))
			widen_strip(s, surfel, &own, &wider, list);
		return;
	}
	const spread all = find_spread(s, surfel, wide->index, wide->count);
	offset_of(s, surfel, list->index[NEAREST_KEPT - 1], axis);
	if (line || is_noise_across(&own, &all, STRIP_ACROSS))
		take_beside(s, surfel, axis, wide, list);
}

static void store_list(gw_neighbours *search, size_t surfel, const gw_neighbour_list *list)
{
	uint32_t *stored = search->stored + surfel * search->per_surfel;
	for (uint32_t j = 0; j < search->per_surfel; j++)
		stored[j] = j < list->count ? list->index[j] : NO_NEIGHBOUR;
	if (list->complete < list->count)
		stored[0] |= WIDENED;
	if (list->complete == GW_SCALED_NEAREST && list->count > GW_SCALED_NEAREST)
		stored[1] |= WIDENED;
	if (list->in_rows)
		stored[2] |= WIDENED;
}

static void restore_list(const gw_neighbours *search, size_t surfel, gw_neighbour_list *list)
{
	const uint32_t *stored = search->stored + surfel * search->per_surfel;
	uint32_t count = search->per_surfel;
	while (count > 0 && stored[count - 1] == NO_NEIGHBOUR)
		count--;
	memcpy(list->index, stored, count * sizeof *stored);
	list->in_rows = count > 2 && (stored[2] & WIDENED);
	for (uint32_t j = 0; j < 3 && j < count; j++)
		list->index[j] &= ~WIDENED;
	list->count = count;
	bool widened = list->count > 0 && (stored[0] & WIDENED);
	bool scaled = widened && (stored[1] & WIDENED);
	list->complete = scaled ? GW_SCALED_NEAREST : widened ? NEAREST_KEPT : list->count;
}

/* The distances of the neighbours from number `first` on. */
static void measure_list(const gw_surfels *s, size_t surfel, uint32_t first,
						 gw_neighbour_list *list)
{
	for (uint32_t j = first; j < list->count; j++)
		list->distance[j] = (float)distance_between(s, surfel, list->index[j]);
}

/* To be called on the thread that called the library. */
static bool asks_to_stop(gw_neighbours *search)
{
	const gw_surfels_options *o = search->options;
	return atomic_load(&search->stopped) || (o->cancelled && o->cancelled(o->user));
}

/* Whether many lists of a chunk are lines or strips. */
static bool lies_in_rows(const gw_neighbours *search, size_t first, size_t last,
						 const chunk_result *result)
{
	const gw_surfels *s = search->surfels;
	size_t k = search->per_surfel + 1u, places = 0, strips = 0;
	if (search->per_surfel < GW_NEIGHBOURS)
		return false;
	for (size_t i = first; i < last; i += CHUNK / ROW_PLACES, places++) {
		gw_neighbour_list list;
		fill_list(search, i, result->found + (i - first) * k, &list);
		const spread own = find_spread(s, i, list.index, list.count);
		strips += is_strip(&own, STRIP_SHARE);
	}
	return 3 * strips > places;
}

static bool search_chunk(const gw_neighbours *search, size_t first, size_t last,
						 chunk_result *result)
{
	scale_positions(search, first, last, result->query);
	return gw_neighbour_index_search(search->index, result->query, last - first,
									 search->per_surfel + 1u, result->found, result->squared);
}

static void visit_chunk(void *user, size_t first, size_t last, uint32_t worker)
{
	const visit *v = user;
	gw_neighbours *search = v->search;
	chunk_result *result = search->scratch + worker;
	if (worker == 0 && asks_to_stop(search))
		atomic_store(&search->stopped, true);
	if (atomic_load(&search->stopped) || atomic_load(&search->out_of_memory))
		return;
	size_t k = search->per_surfel + 1u;
	bool searching = !search->stored || !search->is_stored;
	result->wide.count = 0;
	if (searching && !search_chunk(search, first, last, result)) {
		atomic_store(&search->out_of_memory, true);
		return;
	}
	bool in_rows = searching && lies_in_rows(search, first, last, result);
	for (size_t i = first; i < last; i++) {
		gw_neighbour_list list;
		if (searching) {
			fill_list(search, i, result->found + (i - first) * k, &list);
			if (!gw_neighbour_scales_widen(search->scales, i, &list))
				atomic_store(&search->out_of_memory, true);
			list.in_rows = in_rows && list.count == GW_NEIGHBOURS;
			if (list.complete == list.count)
				widen_list(search, i, &result->wide, &list);
		} else {
			restore_list(search, i, &list);
			measure_list(search->surfels, i, v->measured || list.count == 0 ? 0 : list.count - 1,
						 &list);
		}
		if (searching && search->stored)
			store_list(search, i, &list);
		v->function(v->user, i, &list);
	}
}

void gw_neighbours_run_short(gw_neighbours *search)
{
	atomic_store(&search->out_of_memory, true);
}

static gw_status fail_stopped(gw_error *error)
{
	return gw_fail(error, GW_ERROR_CANCELLED, "stopped while describing the surface");
}

static gw_status visit_all(gw_neighbours *search, visit v, gw_error *error)
{
	v.search = search;
	atomic_store(&search->stopped, asks_to_stop(search));
	gw_parallel_for(search->threads, search->surfels->count, CHUNK, visit_chunk, &v);
	if (atomic_load(&search->stopped))
		return fail_stopped(error);
	if (atomic_load(&search->out_of_memory))
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to search for neighbours");
	search->is_stored = true;
	return GW_OK;
}

gw_status gw_neighbours_visit(gw_neighbours *search, gw_neighbours_visitor *function, void *user,
							  gw_error *error)
{
	return visit_all(search, (visit){ .function = function, .user = user, .measured = true },
					 error);
}

gw_status gw_neighbours_visit_reach(gw_neighbours *search, gw_neighbours_visitor *function,
									void *user, gw_error *error)
{
	return visit_all(search, (visit){ .function = function, .user = user }, error);
}

/* A loop that can be stopped. */
typedef struct stoppable_loop {
	gw_neighbours *search;
	gw_parallel_work *work;
	void *user;
} stoppable_loop;

static void work_on_chunk(void *user, size_t first, size_t last, uint32_t worker)
{
	const stoppable_loop *l = user;
	if (worker == 0 && asks_to_stop(l->search))
		atomic_store(&l->search->stopped, true);
	if (!atomic_load(&l->search->stopped))
		l->work(l->user, first, last, worker);
}

gw_status gw_neighbours_loop(gw_neighbours *search, size_t count, gw_parallel_work *work,
							 void *user, gw_error *error)
{
	stoppable_loop l = { search, work, user };
	atomic_store(&search->stopped, asks_to_stop(search));
	gw_parallel_for(search->threads, count, CHUNK, work_on_chunk, &l);
	return atomic_load(&search->stopped) ? fail_stopped(error) : GW_OK;
}

/* Searches k neighbours of one surfel; the least distance in the maximum norm goes to *nearest and
 * the Euclidean distance of the last one to *reach. */
static bool search_further(gw_neighbours *search, size_t surfel, size_t k, double *nearest,
						   double *reach)
{
	int *found = gw_allocate_array(k, sizeof *found);
	float *squared = gw_allocate_array(k, sizeof *squared);
	bool good = found && squared && search_one(search, surfel, k, found, squared);
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
 * |d| < sqrt(3) m; so when the k-th nearest is sqrt(3) m or more away, such a point would be one
 * of the k, and m is exact. Otherwise more neighbours are searched until that holds. A margin of
 * 1e-5 covers the rounding of FLANN's float32 distances.
 */
float gw_neighbours_nearest(gw_neighbours *search, size_t surfel, const gw_neighbour_list *list)
{
	const double bound = 1.7320508 * (1 + 1e-5);
	if (list->count == 0)
		return INFINITY;
	double nearest = INFINITY, reach = (double)list->distance[list->complete - 1];
	for (uint32_t j = 0; j < list->count; j++)
		nearest = fmin(nearest, maximum_norm_between(search->surfels, surfel, list->index[j]));
	size_t count = search->surfels->count;
	for (size_t k = list->complete + 1u; k < count && reach < bound * nearest;) {
		k = k < count / 2 ? 2 * k : count;
		if (!search_further(search, surfel, k, &nearest, &reach)) {
			atomic_store(&search->out_of_memory, true);
			break;
		}
	}
	return (float)nearest;
}

void gw_neighbours_at(gw_neighbours *search, const double place[3], gw_neighbour_list *list)
{
	float query[3];
	int found[GW_NEIGHBOURS_AT];
	float squared[GW_NEIGHBOURS_AT];
	size_t count = search->surfels->count;
	size_t k = count < GW_NEIGHBOURS_AT ? count : GW_NEIGHBOURS_AT;
	for (size_t axis = 0; axis < 3; axis++)
		query[axis] = (float)(place[axis] * search->scale);
	*list = (gw_neighbour_list){ .count = 0 };
	if (!gw_neighbour_index_search(search->index, query, 1, k, found, squared)) {
		atomic_store(&search->out_of_memory, true);
		return;
	}
	for (size_t j = 0; j < k; j++)
		insert_neighbour(list, (uint32_t)found[j],
						 (float)(sqrt((double)squared[j]) / search->scale));
	list->complete = list->count;
}

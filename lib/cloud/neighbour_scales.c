/* neighbour_scales.c - see neighbour_scales.h. */
#include "cloud/neighbour_scales.h"

#include "base/memory.h"
#include "cloud/unit_places.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#define LEVELS 22 /* of cells: 2^0 to 2^21 along the longest side */

/*
 * A list is one-sided when the mean of its offsets is more than this share of their mean length: of
 * a half-plane it is 0.64. That happens at boundaries, too, but there the neighbours are as far
 * from each other as the surfel is from them: distances between them, of the list's reach, are 0.16
 * on average there, in a corner 0.11. Those in a denser patch are nearer to each other: below
 * CLOSE, or below CLOSE_AND_OFF and so many times nearer than the surfel is to the nearest of them.
 * What passes that by chance does not the last test: the reach of a list there is less than this
 * share of the surfel's.
 */
#define ONE_SIDED 0.5
#define CLOSE 0.06
#define CLOSE_AND_OFF 0.1
#define OFF 2.5
#define DENSER 0.55

/* The first cells that are tried are this wide, of the list's reach. They become twice as wide
 * until the neighbours lie around the surfel, so often at most. */
#define FIRST_WIDTH 0.35
#define TRIES 5

/* A list is not wanted that is more one-sided than this: nothing of the surfel's own scale is
 * around it, at a corner of a surface either. Some points together far off all others are left to
 * what knows strays. */
#define STILL_ASIDE 0.85

/* One thinned cloud. */
typedef struct thinned {
	gw_neighbour_index *index;
	uint32_t *surfel; /* count */
	size_t count;
} thinned;

struct gw_neighbour_scales {
	const gw_surfels *surfels;
	const gw_neighbour_index *all;
	uint32_t threads;
	double scale, per_metre; /* cells of the finest level */
	pthread_mutex_t lock;
	thinned level[LEVELS];
};

gw_neighbour_scales *gw_neighbour_scales_open(const gw_surfels *surfels,
											  const gw_neighbour_index *all, double scale,
											  uint32_t threads)
{
	gw_neighbour_scales *scales = gw_allocate_zeros(1, sizeof *scales);
	double extent = 0;
	if (!scales)
		return NULL;
	for (int k = 0; k < 3; k++)
		extent = fmax(extent, (double)surfels->maximum[k] - (double)surfels->minimum[k]);
	scales->surfels = surfels;
	scales->all = all;
	scales->scale = scale;
	scales->threads = threads;
	/* The grid of the surfels' order, so that those of a cell are next to each other. */
	scales->per_metre = extent > 0 ? (double)((1 << 21) - 1) / extent : 0;
	pthread_mutex_init(&scales->lock, NULL);
	return scales;
}

void gw_neighbour_scales_close(gw_neighbour_scales *scales)
{
	if (!scales)
		return;
	for (int l = 0; l < LEVELS; l++) {
		gw_neighbour_index_free(scales->level[l].index);
		free(scales->level[l].surfel);
	}
	pthread_mutex_destroy(&scales->lock);
	free(scales);
}

static void cell_of(const gw_neighbour_scales *scales, int level, size_t surfel, int64_t cell[3])
{
	const gw_surfels *s = scales->surfels;
	double per_metre = ldexp(scales->per_metre, level - LEVELS + 1);
	for (size_t k = 0; k < 3; k++)
		cell[k] =
			(int64_t)(((double)s->position[3 * surfel + k] - (double)s->minimum[k]) * per_metre);
}

/* Of each run of surfels in one cell the first one. */
static bool thin(const gw_neighbour_scales *scales, int level, thinned *t)
{
	const gw_surfels *s = scales->surfels;
	int64_t before[3] = { -1, -1, -1 }, cell[3];
	t->surfel = gw_allocate_array(s->count, sizeof *t->surfel);
	for (size_t i = 0; i < s->count && t->surfel; i++) {
		cell_of(scales, level, i, cell);
		if (memcmp(cell, before, sizeof cell) != 0)
			t->surfel[t->count++] = (uint32_t)i;
		memcpy(before, cell, sizeof cell);
	}
	float *scaled = t->surfel ? gw_allocate_array(t->count, 3 * sizeof *scaled) : NULL;
	for (size_t i = 0; i < t->count && scaled; i++)
		gw_unit_place(s, t->surfel[i], scales->scale, scaled + 3 * i);
	t->index = scaled ? gw_neighbour_index_build(scaled, t->count, scales->threads) : NULL;
	free(scaled);
	return t->index != NULL;
}

/* A level, made if need be; NULL when memory is short. */
static const thinned *level_of(gw_neighbour_scales *scales, int level)
{
	thinned *t = &scales->level[level];
	pthread_mutex_lock(&scales->lock);
	bool good = t->index || (!t->surfel && thin(scales, level, t));
	pthread_mutex_unlock(&scales->lock);
	return good ? t : NULL;
}

static double offset_of(const gw_surfels *s, size_t surfel, size_t other, double d[3])
{
	for (size_t k = 0; k < 3; k++)
		d[k] = (double)s->position[3 * other + k] - (double)s->position[3 * surfel + k];
	return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

double gw_neighbours_one_sidedness(const gw_surfels *s, size_t surfel,
								   const gw_neighbour_list *list)
{
	double d[3], sum[3] = { 0 }, length = 0;
	for (uint32_t j = 0; j < list->count; j++) {
		length += offset_of(s, surfel, list->index[j], d);
		for (int k = 0; k < 3; k++)
			sum[k] += d[k];
	}
	return length > 0 ? sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]) / length : 0;
}

double gw_neighbours_median_gap(const gw_surfels *s, const gw_neighbour_list *list)
{
	double gap[GW_NEIGHBOURS], d[3]; /* sorted */
	for (uint32_t i = 0; i < list->count; i++) {
		double nearest = INFINITY;
		for (uint32_t j = 0; j < list->count; j++)
			if (j != i)
				nearest = fmin(nearest, offset_of(s, list->index[i], list->index[j], d));
		uint32_t at = i;
		for (; at > 0 && nearest < gap[at - 1]; at--)
			gap[at] = gap[at - 1];
		gap[at] = nearest;
	}
	return gap[list->count / 2];
}

static bool is_beside_patch(const gw_surfels *s, size_t surfel, const gw_neighbour_list *list)
{
	if (list->count < GW_NEIGHBOURS || gw_neighbours_one_sidedness(s, surfel, list) < ONE_SIDED)
		return false;
	double gap = gw_neighbours_median_gap(s, list), reach = (double)list->distance[list->count - 1];
	return gap < CLOSE * reach ||
		   (gap < CLOSE_AND_OFF * reach && OFF * gap < (double)list->distance[0]);
}

/* Is the cloud much denser at the neighbour in the middle of a list than at the surfel? */
static bool is_denser_there(const gw_neighbour_scales *scales, const gw_neighbour_list *list,
							bool *failed)
{
	int found[GW_NEIGHBOURS + 1];
	float squared[GW_NEIGHBOURS + 1], query[3];
	gw_unit_place(scales->surfels, list->index[list->count / 2], scales->scale, query);
	*failed = !gw_neighbour_index_search(scales->all, query, 1, GW_NEIGHBOURS + 1, found, squared);
	return !*failed && sqrt((double)squared[GW_NEIGHBOURS]) / scales->scale <
						   DENSER * (double)list->distance[list->count - 1];
}

/* The nearest neighbours that stay, and behind them those of a level that are further away. */
static bool list_level(gw_neighbour_scales *scales, int level, size_t surfel,
					   const gw_neighbour_list *nearest, gw_neighbour_list *list)
{
	const gw_surfels *s = scales->surfels;
	const thinned *t = level_of(scales, level);
	int found[GW_NEIGHBOURS + GW_SCALED_NEAREST + 1];
	float squared[GW_NEIGHBOURS + GW_SCALED_NEAREST + 1], query[3];
	size_t most = sizeof found / sizeof *found;
	size_t k = t && t->count < most ? t->count : most;
	double d[3];
	gw_unit_place(scales->surfels, surfel, scales->scale, query);
	if (!t || !gw_neighbour_index_search(t->index, query, 1, k, found, squared))
		return false;
	*list = *nearest;
	list->count = list->complete = GW_SCALED_NEAREST;
	for (size_t j = 0; j < k && list->count < GW_NEIGHBOURS; j++) {
		uint32_t other = t->surfel[found[j]];
		bool there = other == surfel;
		for (uint32_t i = 0; i < GW_SCALED_NEAREST; i++)
			there |= other == list->index[i];
		if (there)
			continue;
		list->index[list->count] = other;
		list->distance[list->count++] = (float)offset_of(s, surfel, other, d);
	}
	return true;
}

/* Of cells that wide, or a little narrower; below 0 where the cloud itself is smaller. */
static int level_of_width(const gw_neighbour_scales *scales, double width)
{
	return LEVELS - 1 - (int)floor(log2(fmax(width * scales->per_metre, 1)));
}

bool gw_neighbour_scales_around(gw_neighbour_scales *scales, size_t surfel, double width,
								uint32_t *index, uint32_t *count)
{
	int level = level_of_width(scales, width), found[GW_NEIGHBOURS_WIDE];
	float squared[GW_NEIGHBOURS_WIDE], query[3];
	*count = 0;
	if (!(scales->per_metre > 0) || level < 0)
		return true;
	const thinned *t = level_of(scales, level);
	size_t k = t && t->count < GW_NEIGHBOURS_WIDE ? t->count : GW_NEIGHBOURS_WIDE;
	gw_unit_place(scales->surfels, surfel, scales->scale, query);
	if (!t || !gw_neighbour_index_search(t->index, query, 1, k, found, squared))
		return false;
	for (; *count < k; (*count)++)
		index[*count] = t->surfel[found[*count]];
	return true;
}

bool gw_neighbour_scales_widen(gw_neighbour_scales *scales, size_t surfel, gw_neighbour_list *list)
{
	const gw_surfels *s = scales->surfels;
	if (!(scales->per_metre > 0) || !is_beside_patch(s, surfel, list))
		return true;
	const gw_neighbour_list nearest = *list;
	bool failed;
	if (!is_denser_there(scales, list, &failed))
		return !failed;
	double width = FIRST_WIDTH * (double)list->distance[list->count - 1], least = STILL_ASIDE;
	int level = level_of_width(scales, width);
	for (int tries = 0; tries < TRIES && level >= 0 && least > ONE_SIDED; tries++, level--) {
		gw_neighbour_list wider;
		if (!list_level(scales, level, surfel, &nearest, &wider))
			return false;
		double side = gw_neighbours_one_sidedness(s, surfel, &wider);
		if (wider.count == GW_NEIGHBOURS && side < least) {
			least = side;
			*list = wider;
		}
	}
	return true;
}

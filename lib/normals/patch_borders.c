/*
 * patch_borders.c - see patch_borders.h. Surfels are in Morton order, so that those of a chunk are
 * of few patches, and their many pairs come to few borders before all are put together.
 */
#include "normals/patch_borders.h"

#include "base/memory.h"
#include "glowworm_host.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#define CHUNK 8192 /* surfels that a thread takes at a time */

/* The borders that the surfels of a chunk know of. */
typedef struct part {
	gw_patch_border *borders;
	size_t count;
} part;

typedef struct collection {
	const gw_patch_pairs *pairs;
	part *part; /* a chunk */
	atomic_bool failed;
} collection;

/* What a pair across a border says, a whole number. Pairs at a crease agree less than those on
 * smooth surface, however sure they are: roots make what they say more alike, so that light does
 * less to tear things apart at their edges. */
static double border_says(const gw_patch_pairs *p, size_t surfel, size_t other, int agreement)
{
	double says = p->alike ? round(sqrt((double)(GW_AGREED * abs(agreement)))) : abs(agreement);
	return (p->opposite[surfel] != p->opposite[other]) != (agreement < 0) ? -says : says;
}

/* Adds a border to those of one surfel, of which there are few. */
static size_t add_border(gw_patch_border *of_surfel, size_t count, gw_patch_border border)
{
	for (size_t i = 0; i < count; i++)
		if (of_surfel[i].a == border.a && of_surfel[i].b == border.b) {
			of_surfel[i].says += border.says;
			of_surfel[i].weight += border.weight;
			return count;
		}
	of_surfel[count] = border;
	return count + 1;
}

/* The borders of one surfel's patch that its pairs lie across; returns how many. */
static size_t borders_of(const gw_patch_pairs *p, size_t surfel, gw_patch_border *borders)
{
	size_t count = 0;
	for (size_t j = 0; j < GW_NEIGHBOURS; j++) {
		size_t pair = GW_NEIGHBOURS * surfel + j, other = p->near[pair];
		uint32_t a = p->patch[surfel], b = p->patch[other];
		double says = a == b ? 0 : border_says(p, surfel, other, p->agreement[pair]);
		if (says != 0)
			count = add_border(borders, count,
							   (gw_patch_border){ a < b ? a : b, a < b ? b : a, says, fabs(says) });
	}
	return count;
}

static void collect_chunk(void *user, size_t first, size_t last, uint32_t worker)
{
	collection *all = user;
	part *own = &all->part[first / CHUNK];
	gw_patch_border *borders =
		gw_allocate_array((last - first) * GW_NEIGHBOURS, sizeof *own->borders);
	size_t count = 0;
	(void)worker;
	for (size_t i = first; borders && i < last; i++)
		count += borders_of(all->pairs, i, borders + count);
	own->count = gw_patch_borders_merge(borders, count);
	gw_patch_border *smaller = gw_resize_array(borders, own->count, sizeof *borders);
	own->borders = smaller ? smaller : borders;
	if (!own->borders)
		atomic_store(&all->failed, true);
}

/* Puts the borders of all chunks together; NULL when memory is short. */
static gw_patch_border *join_parts(const part *parts, size_t chunks, size_t *count)
{
	size_t sum = 0, at = 0;
	for (size_t i = 0; i < chunks; i++)
		sum += parts[i].count;
	gw_patch_border *borders = gw_allocate_array(sum, sizeof *borders);
	for (size_t i = 0; borders && i < chunks; i++) {
		if (parts[i].count > 0)
			memcpy(borders + at, parts[i].borders, parts[i].count * sizeof *borders);
		at += parts[i].count;
	}
	*count = borders ? gw_patch_borders_merge(borders, sum) : 0;
	return borders;
}

bool gw_patch_borders_find(const gw_patch_pairs *pairs, uint32_t threads, gw_patch_border **borders,
						   size_t *count)
{
	size_t chunks = (pairs->count + CHUNK - 1) / CHUNK;
	collection all = { .pairs = pairs, .part = gw_allocate_zeros(chunks, sizeof *all.part) };
	*borders = NULL;
	*count = 0;
	if (!all.part)
		return false;
	gw_parallel_for(threads, pairs->count, CHUNK, collect_chunk, &all);
	if (!atomic_load(&all.failed))
		*borders = join_parts(all.part, chunks, count);
	for (size_t i = 0; i < chunks; i++)
		free(all.part[i].borders);
	free(all.part);
	return *borders != NULL;
}

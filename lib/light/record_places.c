/*
 * record_places.c - see record_places.h.
 */
#include "light/record_places.h"

#include "base/memory.h"
#include "light/transport_layout.h"
#include "octree/octree_layout.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Facets whose normals are closer than this share a record. */
#define LIKE_NORMAL 0.7f

/* Darts that stuck, listed by cells of a hash table; a cell is one spacing wide. */
typedef struct dart_table {
	uint32_t *head; /* bucket -> chosen index + 1 */
	uint32_t *next; /* chosen index -> chosen index + 1 */
	uint32_t mask;
	float cell;
} dart_table;

typedef struct gw_dart {
	uint64_t turn;
	uint32_t facet;
} dart;

static uint64_t mix(uint64_t v)
{
	/* SplitMix64's finaliser (Steele et al. 2014). */
	v += 0x9e3779b97f4a7c15u;
	v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9u;
	v = (v ^ (v >> 27)) * 0x94d049bb133111ebu;
	return v ^ (v >> 31);
}

static int by_turn(const void *a, const void *b)
{
	const dart *x = a, *y = b;
	if (x->turn != y->turn)
		return x->turn < y->turn ? -1 : 1;
	return x->facet < y->facet ? -1 : x->facet > y->facet;
}

static int by_value(const void *a, const void *b)
{
	uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
	return x < y ? -1 : x > y;
}

static uint32_t bucket(const dart_table *table, int64_t x, int64_t y, int64_t z)
{
	uint64_t key =
		((uint64_t)x & 0x1fffff) | ((uint64_t)y & 0x1fffff) << 21 | ((uint64_t)z & 0x1fffff) << 42;
	return (uint32_t)mix(key) & table->mask;
}

/* Do two facets lie on the same piece of surface, nearer than the spacing? */
static bool conflict(const gw_place_task *task, uint32_t first, uint32_t second, float spacing,
					 float off_plane)
{
	size_t a = first & ~GW_RECORD_BACK, b = second & ~GW_RECORD_BACK;
	const float *centre = task->centre, *plane = task->plane;
	float squared = 0.0f, alignment = 0.0f, height = 0.0f;
	for (size_t axis = 0; axis < 3; axis++) {
		float d = centre[4 * a + axis] - centre[4 * b + axis];
		squared += d * d;
		alignment += plane[4 * a + axis] * plane[4 * b + axis];
		height += d * plane[4 * b + axis];
	}
	if ((first ^ second) & GW_RECORD_BACK)
		alignment = -alignment;
	return squared < spacing * spacing && alignment > LIKE_NORMAL && fabsf(height) < off_plane;
}

/* What a facet's own spacing is, and how far off its plane another surface begins. */
static float spacing_at(const gw_place_task *task, uint32_t facet, float *off_plane)
{
	float spacing = task->closer ? task->closer[facet & ~GW_RECORD_BACK] : task->spacing;
	*off_plane = 0.3f * task->radius * (task->closer ? spacing / task->spacing : 1.0f);
	return spacing;
}

static uint32_t bucket_of(const dart_table *table, const float *centre)
{
	return bucket(table, (int64_t)floorf(centre[0] / table->cell),
				  (int64_t)floorf(centre[1] / table->cell),
				  (int64_t)floorf(centre[2] / table->cell));
}

/* A cell and those around it, i % 3 - 1, i / 3 % 3 - 1 and i / 9 - 1 away: nearest first, because
 * most darts find that there is one already. */
static const int8_t around[27] = { 13, 4,  10, 12, 14, 16, 22, 1, 3, 5,  7,  9,  11, 15,
								   17, 19, 21, 23, 25, 0,  2,  6, 8, 18, 20, 24, 26 };

static bool crowded(const dart_table *table, const gw_place_task *task, const uint32_t *chosen,
					uint32_t facet)
{
	float off_plane, spacing = spacing_at(task, facet, &off_plane);
	int64_t cell[3];
	for (size_t axis = 0; axis < 3; axis++)
		cell[axis] = (int64_t)floorf(task->centre[4 * (size_t)(facet & ~GW_RECORD_BACK) + axis] /
									 table->cell);
	for (int n = 0; n < 27; n++) {
		int i = around[n];
		uint32_t b =
			bucket(table, cell[0] + i % 3 - 1, cell[1] + i / 3 % 3 - 1, cell[2] + i / 9 - 1);
		for (uint32_t at = table->head[b]; at != 0; at = table->next[at - 1]) {
			if (conflict(task, facet, chosen[at - 1], spacing, off_plane))
				return true;
		}
	}
	return false;
}

/* Enters chosen[at] into the table. */
static void stick(dart_table *table, const gw_place_task *task, const uint32_t *chosen, size_t at)
{
	uint32_t b = bucket_of(table, &task->centre[4 * (size_t)(chosen[at] & ~GW_RECORD_BACK)]);
	table->next[at] = table->head[b];
	table->head[b] = (uint32_t)at + 1;
}

/* Behind the kept ones. */
static size_t throw_darts(dart_table *table, const gw_place_task *task, const dart *darts,
						  size_t dart_count, uint32_t *chosen)
{
	size_t count = task->kept_count;
	for (size_t i = 0; i < count; i++)
		stick(table, task, chosen, i);
	for (size_t i = 0; i < dart_count && (task->most == 0 || count <= task->most); i++) {
		if (crowded(table, task, chosen, darts[i].facet))
			continue;
		chosen[count] = darts[i].facet;
		stick(table, task, chosen, count++);
	}
	return count;
}

/* A dart's turn follows from what its facet is, so that a facet far away does not change it. */
static uint64_t turn_of(const float *centre, const float *plane, size_t facet, uint64_t seed)
{
	uint64_t words[4];
	memcpy(words, centre + 4 * facet, 16);
	memcpy(words + 2, plane + 4 * facet, 16);
	for (int i = 0; i < 4; i++)
		seed = mix(words[i] ^ mix(seed));
	return seed;
}

static size_t list_darts(const gw_place_task *task, dart *darts)
{
	size_t count = 0;
	for (size_t facet = 0; facet < task->facets; facet++) {
		if (!(task->centre[4 * facet + 3] > 0.0f) || (task->closer && isinf(task->closer[facet])))
			continue;
		uint64_t turn = turn_of(task->centre, task->plane, facet, task->seed);
		darts[count++] = (dart){ turn, (uint32_t)facet };
		if (task->albedo && floorf(task->albedo[4 * facet + 3]) == GW_FACET_UNCLEAR)
			darts[count++] = (dart){ turn, (uint32_t)facet | GW_RECORD_BACK };
	}
	return count;
}

/* So many darts share a bucket on the average; their turns are random, so that few share more. */
#define BUCKET_DARTS 4

/* Sorts by turns: into buckets by their first bits, and within these. Without room, at once. */
static void sort_darts(dart *darts, size_t count)
{
	int bits = 1;
	while (bits < 30 && ((size_t)BUCKET_DARTS << bits) < count)
		bits++;
	size_t buckets = (size_t)1 << bits, *end = gw_allocate_zeros(buckets, sizeof *end);
	dart *sorted = gw_allocate_array(count, sizeof *sorted);
	if (!end || !sorted) {
		qsort(darts, count, sizeof *darts, by_turn);
	} else {
		for (size_t i = 0; i < count; i++)
			end[darts[i].turn >> (64 - bits)]++;
		for (size_t b = 0, sum = 0; b < buckets; b++) {
			size_t here = end[b];
			end[b] = sum;
			sum += here;
		}
		for (size_t i = 0; i < count; i++)
			sorted[end[darts[i].turn >> (64 - bits)]++] = darts[i];
		for (size_t b = 0; b < buckets; b++) {
			size_t first = b > 0 ? end[b - 1] : 0;
			if (end[b] - first > 1)
				qsort(sorted + first, end[b] - first, sizeof *sorted, by_turn);
		}
		memcpy(darts, sorted, count * sizeof *darts);
	}
	free(end);
	free(sorted);
}

gw_status gw_dart_order_make(const gw_place_task *task, gw_dart_order *order, gw_error *error)
{
	size_t most = task->albedo ? 2 * task->facets : task->facets;
	*order = (gw_dart_order){ .dart = gw_allocate_array(most, sizeof *order->dart) };
	if (!order->dart)
		return gw_fail(error, GW_ERROR_MEMORY,
					   "no memory for %zu candidates of records; bake at a smaller depth",
					   task->facets);
	order->count = list_darts(task, order->dart);
	if (task->spacing > 0.0f)
		sort_darts(order->dart, order->count);
	return GW_OK;
}

void gw_dart_order_clear(gw_dart_order *order)
{
	free(order->dart);
	*order = (gw_dart_order){ 0 };
}

/* All facets in a random order, as far as there is room; or all of them. */
static size_t choose(dart_table *table, const gw_place_task *task, uint32_t *chosen)
{
	const gw_dart_order *order = task->order;
	size_t count = order->count;
	if (task->spacing > 0.0f) {
		for (size_t i = 0; i < task->kept_count; i++)
			chosen[i] = task->kept[i];
		count = throw_darts(table, task, order->dart, count, chosen);
		qsort(chosen + task->kept_count, count - task->kept_count, sizeof *chosen, by_value);
	} else {
		for (size_t i = 0; i < count; i++)
			chosen[i] = order->dart[i].facet;
	}
	return count;
}

static gw_status place_in_order(const gw_place_task *task, uint32_t **chosen, size_t *count,
								gw_error *error)
{
	dart_table table = { .mask = 1, .cell = task->spacing };
	size_t most = task->kept_count + task->order->count;
	while (table.mask < task->facets && table.mask < UINT32_MAX / 2)
		table.mask = table.mask * 2 + 1;
	table.head = gw_allocate_zeros((size_t)table.mask + 1, sizeof *table.head);
	table.next = gw_allocate_array(most, sizeof *table.next);
	*chosen = gw_allocate_array(most, sizeof **chosen);
	gw_status status = GW_OK;
	if (!table.head || !table.next || !*chosen) {
		status = gw_fail(error, GW_ERROR_MEMORY,
						 "no memory for %zu candidates of records; bake at a smaller depth",
						 task->facets);
		free(*chosen);
		*chosen = NULL;
	} else {
		*count = choose(&table, task, *chosen);
	}
	free(table.head);
	free(table.next);
	return status;
}

gw_status gw_place_records(const gw_place_task *task, uint32_t **chosen, size_t *count,
						   gw_error *error)
{
	gw_dart_order own;
	gw_place_task ordered = *task;
	if (task->order)
		return place_in_order(task, chosen, count, error);
	*chosen = NULL;
	GW_TRY(gw_dart_order_make(task, &own, error));
	ordered.order = &own;
	gw_status status = place_in_order(&ordered, chosen, count, error);
	gw_dart_order_clear(&own);
	return status;
}

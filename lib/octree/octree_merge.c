/*
 * octree_merge.c - sorted fragments that are kept, and merging others into them; see
 * octree_steps.h.
 *
 * Equal keys are in the order of surfels, and those that stay come first: so a fragment that moves
 * goes behind all that stay of its leaf. What stays is copied in long runs, between the few places
 * where something is put in.
 */
#include "octree/octree_steps.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

enum { LOW, HIGH, SURFEL, WEIGHT, CENTROID };

void gw_fragment_list_clear(gw_fragment_list *list)
{
	for (size_t w = 0; w < GW_FRAGMENT_WORDS; w++)
		free(list->word[w]);
	*list = (gw_fragment_list){ 0 };
}

static gw_status allocate(uint32_t count, bool wide, gw_fragment_list *list, gw_error *error)
{
	*list = (gw_fragment_list){ .count = count };
	for (size_t w = 0; w < GW_FRAGMENT_WORDS; w++) {
		if (w == HIGH && !wide)
			continue;
		list->word[w] = gw_allocate_array(count, sizeof(uint32_t));
		if (list->word[w] == NULL) {
			gw_fragment_list_clear(list);
			return gw_fail(error, GW_ERROR_MEMORY, "not enough memory for %u fragments", count);
		}
	}
	return GW_OK;
}

/* Where each of the words is on the device. */
static void find_buffers(gw_octree_work *work, gw_buffer *buffer[GW_FRAGMENT_WORDS])
{
	buffer[LOW] = &work->keys.low;
	buffer[HIGH] = &work->keys.high;
	buffer[SURFEL] = &work->octree->fragment_surfel;
	buffer[WEIGHT] = &work->octree->fragment_weight;
	buffer[CENTROID] = &work->fragment_centroid;
}

gw_status gw_octree_fetch_fragments(gw_octree_work *work, gw_fragment_list *list, gw_error *error)
{
	gw_buffer *buffer[GW_FRAGMENT_WORDS];
	find_buffers(work, buffer);
	gw_status status = allocate(work->octree->fragment_count, gw_octree_is_wide(work), list, error);
	for (size_t w = 0; w < GW_FRAGMENT_WORDS && status == GW_OK; w++)
		if (list->word[w] != NULL)
			status = gw_buffer_download(work->gpu, buffer[w], 0, list->word[w],
										4 * (uint64_t)list->count, error);
	if (status != GW_OK)
		gw_fragment_list_clear(list);
	gw_sort_list_destroy(work->gpu, &work->keys);
	for (size_t w = SURFEL; w < GW_FRAGMENT_WORDS; w++)
		gw_buffer_destroy(work->gpu, buffer[w]);
	return status;
}

static uint64_t key_at(const gw_fragment_list *list, uint32_t i)
{
	return (list->word[HIGH] ? (uint64_t)list->word[HIGH][i] << 32 : 0) | list->word[LOW][i];
}

/* The first fragment at or after `from` whose key is larger. */
static uint32_t after_key(const gw_fragment_list *list, uint32_t from, uint64_t key)
{
	uint32_t end = list->count;
	while (from < end) {
		uint32_t middle = from + (end - from) / 2;
		if (key_at(list, middle) <= key)
			from = middle + 1;
		else
			end = middle;
	}
	return from;
}

static void copy(gw_fragment_list *to, uint32_t at, const gw_fragment_list *from, uint32_t first,
				 uint32_t count)
{
	for (size_t w = 0; w < GW_FRAGMENT_WORDS && count > 0; w++)
		if (to->word[w] != NULL)
			memcpy(to->word[w] + at, from->word[w] + first, 4 * (size_t)count);
}

static void merge(const gw_fragment_list *still, const gw_fragment_list *moving,
				  gw_fragment_list *all)
{
	uint32_t done = 0, last;
	for (uint32_t first = 0; first < moving->count; first = last) {
		uint64_t key = key_at(moving, first);
		last = after_key(moving, first, key);
		uint32_t place = after_key(still, done, key);
		copy(all, done + first, still, done, place - done);
		copy(all, place + first, moving, first, last - first);
		done = place;
	}
	copy(all, done + moving->count, still, done, still->count - done);
}

static gw_status upload(gw_octree_work *work, const gw_fragment_list *list, gw_error *error)
{
	static const char *const name[GW_FRAGMENT_WORDS] = { "keys", "high words of keys",
														 "surfels of fragments",
														 "weights of fragments",
														 "centroids of fragments" };
	gw_buffer *buffer[GW_FRAGMENT_WORDS];
	uint64_t bytes = 4 * (uint64_t)list->count, most = gw_octree_most_fragments(work->gpu);
	find_buffers(work, buffer);
	if (list->count > most)
		return gw_fail(
			error, GW_ERROR_MEMORY,
			"a frame's octree needs a list of %llu bytes, but \"%s\" binds at most %llu: "
			"use a larger leaf spacing, a smaller depth or fewer points",
			(unsigned long long)bytes, gw_gpu_device(work->gpu)->name,
			4 * (unsigned long long)most);
	work->keys = (gw_sort_list){ .count = list->count, .wide = gw_octree_is_wide(work) };
	work->octree->fragment_count = list->count;
	for (size_t w = 0; w < GW_FRAGMENT_WORDS; w++) {
		if (list->word[w] == NULL)
			continue;
		GW_TRY(gw_octree_buffer_unset(work, w == WEIGHT ? VK_FORMAT_R32_SFLOAT : VK_FORMAT_R32_UINT,
									  bytes, name[w], buffer[w], error));
		GW_TRY(gw_buffer_upload(work->gpu, buffer[w], 0, list->word[w], bytes, error));
	}
	return GW_OK;
}

gw_status gw_octree_merge_fragments(gw_octree_work *work, const gw_fragment_list *still,
									const gw_fragment_list *moving, gw_error *error)
{
	gw_fragment_list all;
	if ((uint64_t)still->count + moving->count > UINT32_MAX)
		return gw_fail(error, GW_ERROR_MEMORY, "a frame has more than 2^32 fragments");
	if (moving->count == 0)
		return upload(work, still, error);
	GW_TRY(allocate(still->count + moving->count, gw_octree_is_wide(work), &all, error));
	merge(still, moving, &all);
	gw_status status = upload(work, &all, error);
	gw_fragment_list_clear(&all);
	return status;
}

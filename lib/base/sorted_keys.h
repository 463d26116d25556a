/* sorted_keys.h - where keys are in a sorted array. */
#ifndef SORTED_KEYS_H
#define SORTED_KEYS_H

#include <stddef.h>
#include <stdint.h>

/* The first place whose key is not below one; count when all are. */
static inline size_t gw_lower_bound(const uint64_t *sorted, size_t count, uint64_t key)
{
	size_t first = 0, last = count;
	while (first < last) {
		size_t middle = first + (last - first) / 2;
		if (sorted[middle] < key)
			first = middle + 1;
		else
			last = middle;
	}
	return first;
}

#endif

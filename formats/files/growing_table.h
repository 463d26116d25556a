/*
 * growing_table.h - room in a table that grows one entry at a time.
 */
#ifndef GROWING_TABLE_H
#define GROWING_TABLE_H

#include <stdlib.h>

/*
 * Makes room for one entry more. The table grows by doubling, so it can only be full when its count
 * is a power of two. Returns the table, moved or not, for free(); or NULL when memory is short, and
 * the table is still the caller's.
 *   table   NULL at first, then only what this function returned
 *   count   entries in use
 *   size    bytes of an entry
 */
static inline void *growing_table_room(void *table, size_t count, size_t size)
{
	if (count > 0 && (count & (count - 1)) != 0)
		return table;
	return reallocarray(table, count ? 2 * count : 1, size);
}

#endif

/*
 * page_order.h - points in an order whose every beginning shows all of the cloud, more and more
 * finely.
 *
 * Along the Morton curve each cell of an octree has a first point. Those of the cells of level 0
 * come first, one, then those of level 1 that are not among them, and so on: the points up to the
 * end of a level lie about one of its cells apart. Within a level every 16th along the curve come
 * first, then the 16th after those in the middle between them, and so on, so that parts of a level
 * are even, too.
 */
#ifndef PAGE_ORDER_H
#define PAGE_ORDER_H

#include "glowworm.h"

#define PAGE_ORDER_LEVELS 22

typedef struct page_order {
	uint32_t *point; /* owned; count: which points come one after the other */
	size_t count;
	size_t end[PAGE_ORDER_LEVELS]; /* points before the end of each level */
	double side;                   /* metres, of the one cell of level 0; level l has 2^-l of it */
} page_order;

/*
 *   position   3 * count, metres
 *   count      below 2^32
 *   order      on success freed with page_order_clear; zeroed on failure
 * Fails with GW_ERROR_MEMORY.
 */
gw_status page_order_make(const float *position, size_t count, page_order *order, gw_error *error);

/* Keeps the first `most` points, if there are more. */
void page_order_cut(page_order *order, size_t most);
void page_order_clear(page_order *order);

#endif

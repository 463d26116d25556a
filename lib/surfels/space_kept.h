/*
 * space_kept.h - what is known of the space between surfels as numbers and arrays, for a transport:
 * it is of the points and their scanners alone, whatever shines. Internal to lib/.
 */
#ifndef SPACE_KEPT_H
#define SPACE_KEPT_H

#include "surfels/scanned_space.h"

/* The numbers of it, at fixed places and of fixed size. All 0: nothing is kept. */
typedef struct gw_space_numbers {
	uint32_t cells[3];
	float low[3], cell;
	uint32_t scanners, holes;
	float hole_width, hole_place[3], holes_low[3], holes_high[3];
	uint32_t closed, solid, hole_cells;
} gw_space_numbers;

gw_space_numbers gw_space_numbers_of(const gw_scanned_space *space);

/* Whether these numbers can be those of the space around surfels within these bounds, or of none:
 * no size overflows, and no walk through the cells takes too many steps. */
bool gw_space_numbers_fit(const gw_space_numbers *numbers, const float minimum[3],
						  const float maximum[3]);

/* Stores the numbers in a space without arrays. */
void gw_space_numbers_restore(const gw_space_numbers *numbers, gw_scanned_space *space);

/* Cells, and blocks of them, that these numbers speak of. */
uint64_t gw_space_cells_of(const gw_space_numbers *numbers);
uint64_t gw_space_blocks_of(const gw_space_numbers *numbers);

/* Whether a space that was read names no hole that it has not. */
bool gw_space_fits(const gw_scanned_space *space);

#endif

/*
 * space_kept.c - see space_kept.h.
 */
#include "surfels/space_kept.h"

#include <math.h>
#include <string.h>

/* More cells along a side than either way of finding out makes. */
#define CELLS_MOST 4096u

gw_space_numbers gw_space_numbers_of(const gw_scanned_space *space)
{
	gw_space_numbers n;
	memset(&n, 0, sizeof n);
	if (!space->state)
		return n;
	memcpy(n.cells, space->cells, sizeof n.cells);
	memcpy(n.low, space->low, sizeof n.low);
	n.cell = space->cell;
	n.scanners = space->scanners;
	n.holes = space->holes;
	n.hole_width = space->hole_width;
	memcpy(n.hole_place, space->hole_place, sizeof n.hole_place);
	memcpy(n.holes_low, space->holes_low, sizeof n.holes_low);
	memcpy(n.holes_high, space->holes_high, sizeof n.holes_high);
	n.closed = space->closed;
	n.solid = space->solid_block ? 1u + space->solid : 0;
	n.hole_cells = (uint32_t)space->hole_cells;
	return n;
}

bool gw_space_numbers_fit(const gw_space_numbers *n, const float minimum[3], const float maximum[3])
{
	static const gw_space_numbers none = { .cell = 0.0f };
	if (n->cells[0] == 0)
		return memcmp(n, &none, sizeof none) == 0;
	for (int k = 0; k < 3; k++) {
		float end = n->low[k] + n->cell * (float)n->cells[k];
		if (n->cells[k] == 0 || n->cells[k] > CELLS_MOST || !isfinite(end) ||
			!(n->low[k] <= minimum[k] && end >= maximum[k]))
			return false;
	}
	return n->cell > 0.0f && n->scanners <= GW_SPACE_SCANNERS && n->closed <= 1 && n->solid <= 2 &&
		   n->hole_cells <= gw_space_cells_of(n) && n->holes <= n->hole_cells;
}

void gw_space_numbers_restore(const gw_space_numbers *n, gw_scanned_space *space)
{
	*space = (gw_scanned_space){ .cell = n->cell,
								 .scanners = n->scanners,
								 .closed = n->closed == 1,
								 .holes = n->holes,
								 .hole_width = n->hole_width,
								 .solid = n->solid == 2,
								 .hole_cells = n->hole_cells };
	memcpy(space->cells, n->cells, sizeof n->cells);
	memcpy(space->low, n->low, sizeof n->low);
	memcpy(space->hole_place, n->hole_place, sizeof n->hole_place);
	memcpy(space->holes_low, n->holes_low, sizeof n->holes_low);
	memcpy(space->holes_high, n->holes_high, sizeof n->holes_high);
}

uint64_t gw_space_cells_of(const gw_space_numbers *n)
{
	return (uint64_t)n->cells[0] * n->cells[1] * n->cells[2];
}

uint64_t gw_space_blocks_of(const gw_space_numbers *n)
{
	uint64_t blocks = 1;
	for (int k = 0; k < 3; k++)
		blocks *= (n->cells[k] + GW_SPACE_BLOCK - 1) / GW_SPACE_BLOCK;
	return blocks;
}

bool gw_space_fits(const gw_scanned_space *space)
{
	for (size_t i = 0; i < space->hole_cells; i++)
		if ((uint32_t)space->hole_cell[i] >= space->holes)
			return false;
	return true;
}

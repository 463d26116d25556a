/*
 * solid_cells.c - see solid_cells.h.
 */
#include "surfels/solid_cells.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

/* Surfels from which it is walked, about, at most. */
#define WALKS_MOST 262144u

/* Cells between a surfel and where its walk begins, and a step of it. */
#define BEGIN 1.5f
#define STEP 0.5f

/* The sides that a surfel may face, a bit each: towards an axis' end, and towards its begin. */
#define TOWARDS_END 0x07u
#define SIDES 3

static uint8_t side_of(const float normal[3])
{
	int axis = 0;
	for (int k = 1; k < 3; k++)
		axis = fabsf(normal[k]) > fabsf(normal[axis]) ? k : axis;
	return (uint8_t)(1u << (normal[axis] > 0.0f ? axis : axis + SIDES));
}

/* Marks what lies behind a surfel, up to the next surface. */
static void walk(const gw_surfels *s, const gw_scanned_space *space, size_t i, uint8_t *behind)
{
	const float *p = s->position + 3 * i, *n = s->normal + 3 * i;
	uint8_t side = side_of(n);
	uint32_t at[3];
	for (float t = BEGIN;; t += STEP) {
		float place[3];
		for (int k = 0; k < 3; k++)
			place[k] = p[k] - t * space->cell * n[k];
		if (!gw_scanned_space_cell(space, place, at))
			return;
		size_t cell = ((size_t)at[2] * space->cells[1] + at[1]) * space->cells[0] + at[0];
		if (space->state[cell] == GW_SPACE_SURFACE || space->state[cell] == GW_SPACE_BOUNDARY)
			return;
		behind[cell] |= side;
	}
}

/* Marks the blocks that hold something solid. */
static bool mark_blocks(gw_scanned_space *space)
{
	size_t blocks = 1, cell = 0;
	for (int k = 0; k < 3; k++)
		blocks *= gw_scanned_space_blocks(space, k);
	space->solid_block = gw_allocate_zeros(blocks, sizeof *space->solid_block);
	if (!space->solid_block)
		return false;
	for (uint32_t z = 0; z < space->cells[2]; z++)
		for (uint32_t y = 0; y < space->cells[1]; y++)
			for (uint32_t x = 0; x < space->cells[0]; x++, cell++)
				if (space->state[cell] == GW_SPACE_SOLID)
					space->solid_block[gw_scanned_space_block(space,
															  (const uint32_t[]){ x, y, z })] = 1;
	return true;
}

gw_status gw_solid_cells_mark(const gw_surfels *surfels, gw_scanned_space *space, gw_error *error)
{
	size_t cells = (size_t)space->cells[0] * space->cells[1] * space->cells[2];
	size_t step = surfels->count / WALKS_MOST + 1;
	uint8_t *behind = gw_allocate_zeros(cells, sizeof *behind);
	if (!behind)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for what is solid in %zu cells", cells);
	for (size_t i = 0; i < surfels->count; i += step)
		if (!surfels->two_sided[i] && !(surfels->transparency && surfels->transparency[i] > 0.0f))
			walk(surfels, space, i, behind);
	for (size_t c = 0; c < cells; c++) {
		if (space->state[c] != GW_SPACE_FREE || !(behind[c] & TOWARDS_END & behind[c] >> SIDES))
			continue;
		space->state[c] = GW_SPACE_SOLID;
		space->solid = true;
	}
	free(behind);
	if (space->solid && !mark_blocks(space))
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for what is solid in %zu cells", cells);
	return GW_OK;
}

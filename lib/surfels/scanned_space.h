/*
 * scanned_space.h - what scanners saw of the space around the points, and what they did not.
 * Internal to lib/.
 *
 * A scanner's beam crossed all that lies between it and the point that it found. So a place is
 *
 *   free      if a beam crossed it, or a point lies there
 *   open      if a beam of a scanner went there and out of the scene without finding anything
 *   a pane    likewise, where all around such beams others found something
 *   unknown   otherwise: every scanner has something in front of it
 *
 * For this, each scanner's points are sorted by direction, into cells of equal angles that hold
 * about four of them; the depth of a cell is the second largest of its distances, so that no stray
 * decides. A cell without points among cells that have some was missed by chance; others are open,
 * but for those below all points of the scanner, where its own foot is. Where nobody knows which of
 * several scanners took a point, all that have it in sight saw it: none of them saw through it.
 * What that gives is kept for cells of a coarse grid.
 *
 * A ray that leaves the scene passes a gap if the last of the known places on its way was free, and
 * all behind it is unknown: nobody looked there, because something stood in front of it. Through
 * windows somebody looked: there the last known place is open, or a pane. But what is black, wet
 * or mirrors sends no beam back either, so that a pane may be a surface.
 */
#ifndef SCANNED_SPACE_H
#define SCANNED_SPACE_H

#include "base/shader_math.h"
#include "cloud/surfels.h"

/* Cells along the longest side. */
#define GW_SPACE_CELLS 96u

/* Scanners that are looked at: those with the most points, and such a number of them at least. */
#define GW_SPACE_SCANNERS 64u
#define GW_SPACE_POINTS_LEAST 1000u

/* What is known of a cell. The last three where no scanner is known (surface_holes.h). */
enum {
	GW_SPACE_UNKNOWN,
	GW_SPACE_FREE,
	GW_SPACE_PANE,
	GW_SPACE_OPEN,
	GW_SPACE_SURFACE,
	GW_SPACE_HOLE,
	GW_SPACE_BOUNDARY, /* a surface's cell beside a hole */
	GW_SPACE_SOLID     /* between backs of surfaces (solid_cells.h) */
};

typedef struct gw_scanned_space {
	uint32_t cells[3]; /* 0: nothing is known */
	float low[3];      /* corner of the grid, metres in the surfels' frame */
	float cell;        /* metres */
	uint8_t *state;    /* one a cell, as above */
	uint32_t scanners; /* that were looked at */
	bool closed;       /* hardly a place is open: a building from inside */
	/* Where no scanner is known: how many holes the surface has, and of the widest of them its
	 * extent and its middle, metres in the surfels' frame. */
	uint32_t holes;
	float hole_width, hole_place[3];
	float holes_low[3], holes_high[3]; /* around all of them, metres likewise */
	bool solid;                        /* some cells are */
	uint8_t *solid_block; /* one a block of GW_SPACE_BLOCK cells a side: whether some are */
	uint64_t *hole_cell;  /* hole_cells, ascending: a cell of one, shifted by 32 bits, and which */
	size_t hole_cells;
} gw_scanned_space;

/* Makes the grid around surfels, so many cells along its longest side or fewer of that width, all
 * of them GW_SPACE_UNKNOWN; false when memory is short. */
bool gw_scanned_space_grid(const gw_surfels *surfels, float most, float width,
						   gw_scanned_space *space);

/* Where the grid has a place; false outside of it. Here because it is asked of millions. */
static inline bool gw_scanned_space_cell(const gw_scanned_space *space, const float place[3],
										 uint32_t at[3])
{
	for (int k = 0; k < 3; k++) {
		float cell = (place[k] - space->low[k]) / space->cell;
		if (!(cell >= 0.0f && cell < (float)space->cells[k]))
			return false;
		at[k] = (uint32_t)cell;
	}
	return true;
}

/* Cells along the side of a block. */
#define GW_SPACE_BLOCK 8u

/* How many blocks there are along an axis, and which holds a cell. */
static inline uint32_t gw_scanned_space_blocks(const gw_scanned_space *space, int axis)
{
	return (space->cells[axis] + GW_SPACE_BLOCK - 1) / GW_SPACE_BLOCK;
}

static inline size_t gw_scanned_space_block(const gw_scanned_space *space, const uint32_t at[3])
{
	size_t row = (size_t)(at[2] / GW_SPACE_BLOCK) * gw_scanned_space_blocks(space, 1) +
				 at[1] / GW_SPACE_BLOCK;
	return row * gw_scanned_space_blocks(space, 0) + at[0] / GW_SPACE_BLOCK;
}

/* Whether anything is known of what lies between surfaces. */
static inline bool gw_scanned_space_known(const gw_scanned_space *space)
{
	return space->scanners > 0 || space->holes > 0;
}

/*
 * Finds out what the scanners of points saw.
 *   space   on success to be cleared by the caller; empty where no scanner is known or has enough
 *           points
 * The result does not depend on threads.
 */
gw_status gw_scanned_space_make(const gw_points *points, const gw_surfels *surfels,
								uint32_t threads, gw_scanned_space *space, gw_error *error);
void gw_scanned_space_clear(gw_scanned_space *space);

/* A straight way: from a place, metres in the surfels' frame, along a unit direction, so far. */
typedef struct gw_way {
	gw_vec3 from, direction;
	float length; /* metres; infinity for one that leaves the scene */
} gw_way;

/* Whether light along it comes through a gap. Of a way that ends, whether two cells of it in a row
 * or more are unknown. Where no scanner is known: whether it passes a hole of the surface. */
bool gw_scanned_space_is_gap(const gw_scanned_space *space, const gw_way *way);

/* Which hole a way passes, or whose boundary, where no scanner is known; GW_NO_HOLE for none.
 * where: NULL, or how far along it. */
#define GW_NO_HOLE UINT32_MAX
uint32_t gw_scanned_space_hole(const gw_scanned_space *space, const gw_way *way, float *where);

/* Whether a way leads through something solid, two cells of it in a row or more, where no scanner
 * is known: there surface is missing. where: NULL, or how far along it they begin. */
bool gw_scanned_space_is_solid(const gw_scanned_space *space, const gw_way *way, float *where);

/* Whose boundary a place is on, metres in the surfels' frame; GW_NO_HOLE for none. */
uint32_t gw_scanned_space_rim(const gw_scanned_space *space, const float place[3]);

/* Whether light along a way that leaves the scene, by no gap, comes through a pane; in a closed
 * scene, also through what is too narrow for the cells of directions to tell. */
bool gw_scanned_space_is_pane(const gw_scanned_space *space, const gw_way *way);

#endif

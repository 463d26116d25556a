/*
 * scanned_space.c - see scanned_space.h.
 */
#include "surfels/scanned_space.h"

#include "base/memory.h"
#include "normals/scanner_sight.h"
#include "base/parallel.h"
#include "base/sorted_keys.h"
#include "base/shared_math.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
	UNKNOWN = GW_SPACE_UNKNOWN,
	FREE = GW_SPACE_FREE,
	PANE = GW_SPACE_PANE,
	OPEN = GW_SPACE_OPEN
};

/* Points that a cell of directions holds on average, and most rows of them. */
#define CELL_POINTS 4.0
#define ROWS_LEAST 8u
#define ROWS_MOST 256u

/* Of its eight neighbours, so many with points make a cell without one a chance. */
#define NEIGHBOURS_LEAST 5u

#define NOTHING -1.0f  /* a beam that came back from nowhere */
#define BLIND -2.0f    /* no beam */
#define ENCLOSED -3.0f /* likewise, though all around it others came back from somewhere */

/* Share of all directions that an enclosed component has at most: beyond, it is the sky over a
 * yard. */
#define ENCLOSED_MOST 0.125

/* Share of the places that is open in a closed scene, at most. */
#define OPEN_MOST 0.1

/* Steps of a way in a cell. */
#define STEP 0.5f

/* Cells of a way that ends are unknown: so many steps in a row. */
#define UNKNOWN_STEPS 4u

/* Cells beside a surface that may be taken for a hole's. */
#define HOLE_MARGIN 3.0f

typedef struct scanner {
	float place[3]; /* in the surfels' frame */
	size_t points;
	uint32_t rows; /* from straight up to straight down; twice as many columns */
	float *depth;  /* rows * 2 rows: metres, NOTHING or BLIND */
	float *second; /* the largest while they are being found */
} scanner;

typedef struct work {
	const gw_points *points;
	const gw_surfels *surfels;
	scanner *scanner; /* scanners */
	size_t scanners;
	uint32_t *kept;       /* points->scanner_count: which of them, or UINT32_MAX */
	uint32_t *scanner_of; /* surfels->count: who saw each, of points->scanner; UINT32_MAX where
							 nobody knows */
	uint64_t *seen_by;    /* then those that may have, as gw_scanners_see has them; or NULL */
	gw_scanned_space *space;
} work;

/* --------------------------------------------------------------------------------- directions */

static float distance_to(const scanner *s, const float place[3], float way[3])
{
	float squared = 0.0f;
	for (int k = 0; k < 3; k++) {
		way[k] = place[k] - s->place[k];
		squared += way[k] * way[k];
	}
	return sqrtf(squared);
}

static size_t cell_of(const scanner *s, const float way[3], float distance)
{
	float height = distance > 0.0f ? way[2] / distance : 0.0f;
	float v = acosf(fmaxf(-1.0f, fminf(height, 1.0f))) / GW_PI;
	float u = atan2f(way[1], way[0]) / (2.0f * GW_PI) + 0.5f;
	uint32_t row = (uint32_t)(v * (float)s->rows), columns = 2 * s->rows;
	uint32_t column = (uint32_t)(u * (float)columns);
	row = row < s->rows ? row : s->rows - 1;
	column = column < columns ? column : columns - 1;
	return (size_t)row * columns + column;
}

/* The first scanner from a number on that saw the surfel of a point, as far as anybody knows, or
 * how many there are. */
static size_t next_to_see(const work *w, size_t point, size_t from)
{
	uint32_t surfel = w->surfels->surfel_of_point[point];
	size_t count = w->points->scanner_count;
	if (surfel == UINT32_MAX)
		return count;
	if (w->scanner_of[surfel] != UINT32_MAX)
		return from <= w->scanner_of[surfel] ? w->scanner_of[surfel] : count;
	size_t step = gw_sight_step(count);
	for (size_t i = (from + step - 1) / step; w->seen_by && i * step < count; i++)
		if (w->seen_by[surfel] >> i & 1)
			return i * step;
	return count;
}

static void add_point(const work *w, size_t point, scanner *s)
{
	const gw_points *p = w->points;
	float place[3], way[3];
	for (size_t k = 0; k < 3; k++)
		place[k] = (float)(p->position[3 * point + k] - w->surfels->origin[k]);
	float distance = distance_to(s, place, way);
	size_t cell = cell_of(s, way, distance);
	if (s->second[cell] < 0.0f) {
		s->depth[cell] = s->second[cell] = distance;
	} else if (distance > s->second[cell]) {
		s->depth[cell] = s->second[cell];
		s->second[cell] = distance;
	} else if (distance > s->depth[cell] || s->depth[cell] == s->second[cell]) {
		s->depth[cell] = distance;
	}
}

/* The depth of a cell without points, by its neighbours'. */
static float depth_of_hole(const scanner *s, uint32_t row, uint32_t column)
{
	uint32_t columns = 2 * s->rows, found = 0;
	float largest = NOTHING;
	for (uint32_t k = 0; k < 9; k++) {
		uint32_t r = row + k / 3, c = (column + columns + k % 3 - 1) % columns;
		if (r < 1 || r > s->rows)
			continue;
		float depth = s->second[(size_t)(r - 1) * columns + c];
		found += depth >= 0.0f;
		largest = fmaxf(largest, depth);
	}
	return found >= NEIGHBOURS_LEAST ? largest : NOTHING;
}

static void close_holes(scanner *s)
{
	uint32_t columns = 2 * s->rows, lowest = 0;
	for (uint32_t row = 0; row < s->rows; row++)
		for (uint32_t c = 0; c < columns; c++)
			lowest = s->second[(size_t)row * columns + c] >= 0.0f ? row : lowest;
	for (uint32_t row = 0; row < s->rows; row++)
		for (uint32_t c = 0; c < columns; c++) {
			float *depth = &s->depth[(size_t)row * columns + c];
			if (*depth < 0.0f)
				*depth = row > lowest ? BLIND : depth_of_hole(s, row, c);
		}
}

/* Puts a cell on the stack if nothing came back there and it is not there yet. */
static size_t push_cell(scanner *s, size_t cell, uint32_t *stack, size_t top)
{
	if (s->depth[cell] != NOTHING)
		return top;
	s->depth[cell] = ENCLOSED;
	stack[top] = (uint32_t)cell;
	return top + 1;
}

/* Marks the component of NOTHING around a cell as ENCLOSED. The stack keeps all of it, `count`
 * cells. False when it is large: a hole of the ceiling overhead or of the floor beside the
 * scanner's foot is one as well as that of a wall. */
static bool mark_component(scanner *s, size_t first, uint32_t *stack, size_t *count)
{
	uint32_t columns = 2 * s->rows;
	double share = 0.0;
	size_t top = push_cell(s, first, stack, 0);
	for (size_t i = 0; i < top; i++) {
		uint32_t row = stack[i] / columns, column = stack[i] % columns;
		size_t start = (size_t)row * columns;
		share += sin(M_PI * (row + 0.5) / s->rows);
		top = push_cell(s, start + (column + 1) % columns, stack, top);
		top = push_cell(s, start + (column + columns - 1) % columns, stack, top);
		if (row > 0)
			top = push_cell(s, start - columns + column, stack, top);
		if (row + 1 < s->rows)
			top = push_cell(s, start + columns + column, stack, top);
	}
	*count = top;
	return share * M_PI / (4.0 * s->rows * s->rows) <= ENCLOSED_MOST;
}

/* Finds the components of directions from which nothing came back, though all around them it did.
 */
static bool find_enclosed(scanner *s)
{
	size_t cells = 2 * (size_t)s->rows * s->rows, count;
	uint32_t *stack = gw_allocate_array(cells, sizeof *stack);
	if (!stack)
		return false;
	for (size_t c = 0; c < cells; c++)
		s->second[c] = 0.0f; /* whether it is known to be in none; holes are closed by now */
	for (size_t c = 0; c < cells; c++) {
		if (s->depth[c] != NOTHING || s->second[c] > 0.0f || mark_component(s, c, stack, &count))
			continue;
		for (size_t i = 0; i < count; i++) {
			s->depth[stack[i]] = NOTHING;
			s->second[stack[i]] = 1.0f;
		}
	}
	free(stack);
	return true;
}

/* ------------------------------------------------------------------------------------- scanners */

/* The scanners that are named; UINT32_MAX for surfels whose point names none. Whether there are
 * such. */
static bool take_named(const work *w)
{
	bool open = false;
	const gw_points *p = w->points;
	for (size_t i = 0; i < w->surfels->count; i++)
		w->scanner_of[i] = UINT32_MAX;
	for (size_t i = 0; i < p->count && p->scanner_of; i++) {
		uint32_t surfel = w->surfels->surfel_of_point[i];
		if (surfel != UINT32_MAX && p->scanner_of[i] < p->scanner_count)
			w->scanner_of[surfel] = p->scanner_of[i];
	}
	for (size_t i = 0; i < w->surfels->count && !open; i++)
		open = w->scanner_of[i] == UINT32_MAX;
	return open;
}

/* Which scanners have each surfel in sight. */
static gw_status look(work *w, const gw_scanner_places *places, const gw_surfels_options *options,
					  gw_error *error)
{
	gw_neighbours *search = NULL;
	w->seen_by = gw_allocate_zeros(w->surfels->count, sizeof *w->seen_by);
	if (!w->seen_by)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for what %zu scanners saw",
					   places->count);
	GW_TRY(gw_neighbours_open(w->surfels, options, &search, error));
	gw_status status = gw_scanners_see(search, w->surfels, places, options, w->seen_by, error);
	gw_neighbours_close(search);
	return status;
}

/* Who saw what: the scanners that are named, else all that have it in sight: whoever did not take
 * its points saw through nothing there. */
static gw_status assign(work *w, uint32_t threads, gw_error *error)
{
	const gw_points *p = w->points;
	size_t count = w->surfels->count;
	double *place = gw_allocate_array(p->scanner_count, 3 * sizeof *place);
	float *plane = gw_allocate_zeros(count, 4 * sizeof *plane);
	w->scanner_of = gw_allocate_array(count, sizeof *w->scanner_of);
	gw_status status = GW_OK;
	if (!place || !plane || !w->scanner_of)
		status =
			gw_fail(error, GW_ERROR_MEMORY, "no memory for the scanners of %zu surfels", count);
	const gw_scanner_places places = { place, p->scanner_count, plane };
	const gw_surfels_options options = { .threads = threads }; /* as long as the search */
	if (status == GW_OK) {
		for (size_t i = 0; i < 3 * p->scanner_count; i++)
			place[i] = p->scanner[i] - w->surfels->origin[i % 3];
		for (size_t i = 0; i < 3 * count; i++)
			plane[i / 3 * 4 + i % 3] = w->surfels->normal[i];
		if (take_named(w) && p->scanner_count > 1)
			status = look(w, &places, &options, error);
		for (size_t i = 0; i < count && p->scanner_count == 1; i++)
			w->scanner_of[i] = 0;
	}
	free(plane);
	free(place);
	return status;
}

static int by_points(const void *left, const void *right)
{
	const scanner *a = left, *b = right;
	return a->points != b->points ? (a->points < b->points ? 1 : -1)
								  : memcmp(a->place, b->place, sizeof a->place);
}

/* Counts the points of each, and keeps those that have many. */
static bool choose_scanners(work *w)
{
	const gw_points *p = w->points;
	size_t kept = 0;
	scanner *all = gw_allocate_zeros(p->scanner_count, sizeof *all);
	w->kept = gw_allocate_array(p->scanner_count, sizeof *w->kept);
	if (!all || !w->kept) {
		free(all);
		return false;
	}
	for (size_t s = 0; s < p->scanner_count; s++) {
		for (size_t k = 0; k < 3; k++)
			all[s].place[k] = (float)(p->scanner[3 * s + k] - w->surfels->origin[k]);
		all[s].rows = (uint32_t)s; /* its number, until the best are known */
		w->kept[s] = UINT32_MAX;
	}
	for (size_t i = 0; i < p->count; i++)
		for (size_t s = next_to_see(w, i, 0); s < p->scanner_count; s = next_to_see(w, i, s + 1))
			all[s].points++;
	qsort(all, p->scanner_count, sizeof *all, by_points);
	while (kept < p->scanner_count && kept < GW_SPACE_SCANNERS &&
		   all[kept].points >= GW_SPACE_POINTS_LEAST) {
		w->kept[all[kept].rows] = (uint32_t)kept;
		kept++;
	}
	w->scanner = all;
	w->scanners = kept;
	return true;
}

static bool make_depths(work *w)
{
	for (size_t i = 0; i < w->scanners; i++) {
		scanner *s = &w->scanner[i];
		double rows = sqrt((double)s->points / (2.0 * CELL_POINTS));
		s->rows = (uint32_t)fmin(fmax(rows, ROWS_LEAST), ROWS_MOST);
		size_t cells = 2 * (size_t)s->rows * s->rows;
		s->depth = gw_allocate_array(cells, 2 * sizeof *s->depth);
		if (!s->depth)
			return false;
		s->second = s->depth + cells;
		for (size_t c = 0; c < 2 * cells; c++)
			s->depth[c] = NOTHING;
	}
	size_t all = w->points->scanner_count;
	for (size_t i = 0; i < w->points->count; i++)
		for (size_t s = next_to_see(w, i, 0); s < all; s = next_to_see(w, i, s + 1))
			if (w->kept[s] != UINT32_MAX)
				add_point(w, i, &w->scanner[w->kept[s]]);
	bool good = true;
	for (size_t i = 0; i < w->scanners && good; i++) {
		close_holes(&w->scanner[i]);
		good = find_enclosed(&w->scanner[i]);
	}
	return good;
}

/* --------------------------------------------------------------------------------------- grid */

/* Two cells more than the points take on every side: the first of them may count as seen. */
bool gw_scanned_space_grid(const gw_surfels *surfels, float most, float width,
						   gw_scanned_space *space)
{
	float longest = 0.0f;
	for (int k = 0; k < 3; k++)
		longest = fmaxf(longest, surfels->maximum[k] - surfels->minimum[k]);
	space->cell = fmaxf(longest / most, width);
	size_t cells = 1;
	for (int k = 0; k < 3; k++) {
		float side = surfels->maximum[k] - surfels->minimum[k];
		space->low[k] = surfels->minimum[k] - 2.0f * space->cell;
		space->cells[k] = (uint32_t)(side / space->cell) + 5;
		cells *= space->cells[k];
	}
	space->state = gw_allocate_zeros(cells, sizeof *space->state);
	return space->state != NULL;
}

/* -------------------------------------------------------------------------------------- cells */

static size_t cell_at(const gw_scanned_space *space, const uint32_t at[3])
{
	return ((size_t)at[2] * space->cells[1] + at[1]) * space->cells[0] + at[0];
}

static uint8_t look_at(const work *w, const float place[3])
{
	uint8_t state = UNKNOWN;
	for (size_t i = 0; i < w->scanners && state != OPEN; i++) {
		float way[3], distance = distance_to(&w->scanner[i], place, way);
		float depth = w->scanner[i].depth[cell_of(&w->scanner[i], way, distance)];
		if (depth == NOTHING)
			state = OPEN;
		else if (depth == ENCLOSED)
			state = PANE;
		else if (state == UNKNOWN && distance < depth + 0.5f * w->space->cell)
			state = FREE;
	}
	return state;
}

static void look_at_layers(void *user, size_t first, size_t last, uint32_t worker)
{
	const work *w = user;
	gw_scanned_space *space = w->space;
	(void)worker;
	for (size_t z = first; z < last; z++)
		for (uint32_t y = 0; y < space->cells[1]; y++)
			for (uint32_t x = 0; x < space->cells[0]; x++) {
				const uint32_t at[3] = { x, y, (uint32_t)z };
				float place[3];
				for (int k = 0; k < 3; k++)
					place[k] = space->low[k] + ((float)at[k] + 0.5f) * space->cell;
				space->state[cell_at(space, at)] = look_at(w, place);
			}
}

static void mark_points(const work *w)
{
	uint32_t at[3];
	for (size_t i = 0; i < w->surfels->count; i++)
		if (gw_scanned_space_cell(w->space, w->surfels->position + 3 * i, at) &&
			w->space->state[cell_at(w->space, at)] == UNKNOWN)
			w->space->state[cell_at(w->space, at)] = FREE;
}

static void find_closed(gw_scanned_space *space)
{
	size_t cells = (size_t)space->cells[0] * space->cells[1] * space->cells[2], open = 0;
	for (size_t i = 0; i < cells; i++)
		open += space->state[i] == OPEN;
	space->closed = (double)open < OPEN_MOST * (double)cells;
}

gw_status gw_scanned_space_make(const gw_points *points, const gw_surfels *surfels,
								uint32_t threads, gw_scanned_space *space, gw_error *error)
{
	work w = { .points = points, .surfels = surfels, .space = space };
	*space = (gw_scanned_space){ .scanners = 0 };
	if (!points->scanner || points->scanner_count == 0 ||
		!(surfels->maximum[0] > surfels->minimum[0]))
		return GW_OK;
	gw_status status = assign(&w, threads, error);
	bool made = status == GW_OK && choose_scanners(&w);
	if (made && w.scanners > 0)
		made = make_depths(&w) && gw_scanned_space_grid(surfels, GW_SPACE_CELLS, 0.0f, space);
	if (made && w.scanners > 0) {
		gw_parallel_for(threads, space->cells[2], 1, look_at_layers, &w);
		mark_points(&w);
		find_closed(space);
		space->scanners = (uint32_t)w.scanners;
	}
	for (size_t i = 0; i < w.scanners; i++)
		free(w.scanner[i].depth);
	free(w.scanner);
	free(w.kept);
	free(w.scanner_of);
	free(w.seen_by);
	if (made)
		return GW_OK;
	gw_scanned_space_clear(space);
	return status != GW_OK ? status
						   : gw_fail(error, GW_ERROR_MEMORY, "no memory for what %zu scanners saw",
									 points->scanner_count);
}

void gw_scanned_space_clear(gw_scanned_space *space)
{
	free(space->state);
	free(space->hole_cell);
	free(space->solid_block);
	*space = (gw_scanned_space){ .scanners = 0 };
}

/* --------------------------------------------------------------------------------------- ways */

/* Ends of a way: what the last of its places is, and the last that is known. */
typedef struct way_end {
	uint8_t now, known;
	bool passed; /* so many unknown places that it is a gap */
} way_end;

static way_end follow(const gw_scanned_space *space, const gw_way *way)
{
	way_end end = { UNKNOWN, UNKNOWN, false };
	uint32_t at[3], unknown = 0;
	for (float t = space->cell; space->scanners > 0 && t < way->length; t += STEP * space->cell) {
		gw_vec3 place = gw_plus(way->from, gw_times(way->direction, t));
		if (!gw_scanned_space_cell(space, (const float[]){ place.x, place.y, place.z }, at))
			break;
		end.now = space->state[cell_at(space, at)];
		end.known = end.now != UNKNOWN ? end.now : end.known;
		unknown = end.now == UNKNOWN ? unknown + 1 : 0;
		end.passed = end.passed || unknown >= UNKNOWN_STEPS;
	}
	return end;
}

/* Where a way comes near holes, and where it leaves them. */
static void find_stretch(const gw_scanned_space *space, const gw_way *way, float *from, float *to)
{
	const float p[3] = { way->from.x, way->from.y, way->from.z };
	const float d[3] = { way->direction.x, way->direction.y, way->direction.z };
	*from = 0.0f;
	*to = way->length;
	for (int k = 0; k < 3; k++) {
		float a = (space->holes_low[k] - p[k]) / d[k];
		float b = (space->holes_high[k] - p[k]) / d[k];
		*from = fmaxf(*from, fminf(a, b));
		*to = fminf(*to, fmaxf(a, b));
	}
}

/* Where a way passes a hole. One that leaves the scene may pass its boundary, and one that ends is
 * looked at but for its ends, which may lie beside a hole. */
static bool find_hole(const gw_scanned_space *space, const gw_way *way, uint32_t at[3],
					  float *along)
{
	bool leaves = !isfinite(way->length);
	float margin = (leaves ? 1.0f : HOLE_MARGIN) * space->cell;
	float from, to;
	find_stretch(space, way, &from, &to);
	for (float t = margin; t <= to && (leaves || t < way->length - margin);
		 t += STEP * space->cell) {
		if (t > margin && t < from)
			continue;
		gw_vec3 place = gw_plus(way->from, gw_times(way->direction, t));
		if (!gw_scanned_space_cell(space, (const float[]){ place.x, place.y, place.z }, at))
			break;
		uint8_t state = space->state[cell_at(space, at)];
		*along = t;
		if (state == GW_SPACE_HOLE || (leaves && state == GW_SPACE_BOUNDARY))
			return true;
	}
	return false;
}

/* The hole that a cell is of or, of its boundary, one that it is beside. */
static uint32_t hole_at(const gw_scanned_space *space, const uint32_t at[3])
{
	for (uint32_t k = 0; k < 27; k++) {
		uint32_t turn = (k + 13) % 27; /* its own is the first */
		const uint32_t beside[3] = { at[0] + turn % 3 - 1, at[1] + turn / 3 % 3 - 1,
									 at[2] + turn / 9 - 1 };
		if (beside[0] >= space->cells[0] || beside[1] >= space->cells[1] ||
			beside[2] >= space->cells[2])
			continue;
		uint64_t cell = cell_at(space, beside);
		size_t found = gw_lower_bound(space->hole_cell, space->hole_cells, cell << 32);
		if (found < space->hole_cells && space->hole_cell[found] >> 32 == cell)
			return (uint32_t)space->hole_cell[found];
	}
	return GW_NO_HOLE;
}

uint32_t gw_scanned_space_hole(const gw_scanned_space *space, const gw_way *way, float *where)
{
	uint32_t at[3];
	float along;
	bool passes = space->scanners == 0 && space->holes > 0 && find_hole(space, way, at, &along);
	if (passes && where)
		*where = along;
	return passes ? hole_at(space, at) : GW_NO_HOLE;
}

/* So many steps on, the way is still in the block that holds the cell of a place. */
static uint32_t steps_in_block(const gw_scanned_space *space, const uint32_t at[3],
							   const float place[3], gw_vec3 direction)
{
	const float d[3] = { direction.x, direction.y, direction.z };
	float least = INFINITY;
	for (int k = 0; k < 3; k++) {
		uint32_t edge = at[k] / GW_SPACE_BLOCK + (d[k] > 0.0f ? 1 : 0);
		float to = space->low[k] + (float)(edge * GW_SPACE_BLOCK) * space->cell - place[k];
		float ahead = to / d[k]; /* along the edge infinite, or no number */
		least = ahead < least ? ahead : least;
	}
	/* One less, so that no rounding leads out of it; a way has a length in any case. */
	float steps = least / (STEP * space->cell) - 1.0f;
	return steps > 0.0f && steps < (float)(4 * GW_SPACE_BLOCK) ? (uint32_t)steps : 0;
}

bool gw_scanned_space_is_solid(const gw_scanned_space *space, const gw_way *way, float *where)
{
	uint32_t at[3], solid = 0;
	for (uint32_t step = 0; space->solid; step++) {
		float t = (1.0f + STEP * (float)step) * space->cell;
		gw_vec3 on = gw_plus(way->from, gw_times(way->direction, t));
		const float place[3] = { on.x, on.y, on.z };
		if (!(t < way->length) || !gw_scanned_space_cell(space, place, at))
			break;
		if (!space->solid_block[gw_scanned_space_block(space, at)]) {
			solid = 0;
			step += steps_in_block(space, at, place, way->direction);
			continue;
		}
		solid = space->state[cell_at(space, at)] == GW_SPACE_SOLID ? solid + 1 : 0;
		if (solid < UNKNOWN_STEPS)
			continue;
		if (where)
			*where = t - STEP * (float)(UNKNOWN_STEPS - 1) * space->cell;
		return true;
	}
	return false;
}

uint32_t gw_scanned_space_rim(const gw_scanned_space *space, const float place[3])
{
	uint32_t at[3];
	bool within = space->holes > 0 && gw_scanned_space_cell(space, place, at) &&
				  space->state[cell_at(space, at)] == GW_SPACE_BOUNDARY;
	return within ? hole_at(space, at) : GW_NO_HOLE;
}

bool gw_scanned_space_is_gap(const gw_scanned_space *space, const gw_way *way)
{
	uint32_t at[3];
	float along;
	if (space->scanners == 0)
		return space->holes > 0 && find_hole(space, way, at, &along);
	way_end end = follow(space, way);
	return isfinite(way->length) ? end.passed : end.now == UNKNOWN && end.known == FREE;
}

bool gw_scanned_space_is_pane(const gw_scanned_space *space, const gw_way *way)
{
	way_end end = follow(space, way);
	bool narrow = space->closed && end.known == FREE && end.now == FREE;
	return !isfinite(way->length) && (end.known == PANE || narrow);
}

/*
 * surface_holes.c - see surface_holes.h.
 */
#include "surfels/surface_holes.h"

#include "base/memory.h"
#include "base/parallel.h"
#include "base/shared_math.h"
#include "surfels/solid_cells.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* Places from which it is looked, and rows of directions from straight up to straight down. */
#define VIEWPOINTS 128u
#define ROWS 40u
#define COLUMNS (2u * ROWS)
#define DIRECTIONS (ROWS * COLUMNS)

/* Ways from a surfel that may lead across free space: along its normal, and aslant. */
#define VIEWPOINT_WAYS 5
#define SLANT 0.7f

/* Cells between a viewpoint and what it has before and behind it. */
#define VIEWPOINT_ROOM 3.0f

/* Share of all directions that finds nothing: beyond, a viewpoint is in the open. A hole has half
 * of that at most. */
#define OPEN_MOST 0.3

/* Extent of a boundary over the extent of what is seen, at most, and how much nearer one side of it
 * may be. */
#define BOUNDARY_MOST 0.5f
#define SLOPE_MOST 3.0f

/* Of a boundary: its directions, and its cells in extent, at least. */
#define BOUNDARY_LEAST 4u
#define BOUNDARY_CELLS 2.5f

/* Places on a boundary that are beside each other lie no further apart than this part of its
 * extent, or so many cells: else something is seen through the hole. */
#define JUMP_MOST 0.25f
#define JUMP_CELLS 4.0f

#define SWEEPS 64    /* of the membrane */
#define HOLE_CELLS 4 /* at least */
#define DISC_STEPS 48

/* Cells along the longest side at most, and the least width of one, in spacings of the points. */
#define GRID_CELLS 192.0f
#define CELL_SPACINGS 2.0f

/* Cells along the side of a block, a power of two; the most blocks that are known to be empty, and
 * how far a ray is moved over a border and ends before the last one, in cells. */
#define BLOCK_BITS 1
#define BLOCK (1 << BLOCK_BITS)
#define EMPTY_MOST 254u
#define GRID_NUDGE 1e-3f

/* A cell where some viewpoint has put a membrane, until it is known to be of a hole. */
#define SEEN 255u

/* What viewpoints put into cells: membranes of a boundary that is seen well, in so many directions
 * within it, and whole, and of others. */
#define BY_WHOLE_BOUNDARY 1u
#define BY_OTHERS 2u
#define SEEN_WELL 16u

/* Where more than one in so many viewpoints is in the open, only whole boundaries are those of
 * holes. */
#define OPEN_VIEWPOINTS 4u

typedef struct viewpoint {
	gw_vec3 place;
	float width;                   /* extent of what it sees, metres */
	bool open;                     /* hardly anything is around it */
	uint8_t mark;                  /* how membranes are marked now */
	float depth[DIRECTIONS];       /* metres to what is met; below 0: nothing */
	float inverse[DIRECTIONS];     /* of the depth, of the membrane too */
	uint8_t component[DIRECTIONS]; /* 1: of some component already, or its boundary */
	uint32_t stack[DIRECTIONS];    /* directions of the component */
} viewpoint;

/* Blocks of cells, and one more on each side of the grid. */
typedef struct empty_blocks {
	uint32_t blocks[3];
	uint8_t *empty; /* one a block: how many blocks it is to one with surface, or fewer; 0: here */
	int32_t stride[3], block_stride[3]; /* from one to the next along each axis */
} empty_blocks;

/* A direction through the grid. Along axes that it goes down the grid is mirrored, so that it goes
 * up along all of them. */
typedef struct grid_way {
	float direction[3], inverse[3];
	uint32_t down; /* a bit for each of these axes */
} grid_way;

typedef struct work {
	const gw_surfels *surfels;
	gw_scanned_space *space;
	empty_blocks empty_blocks;
	gw_vec3 *place;        /* VIEWPOINTS */
	gw_vec3 *way;          /* DIRECTIONS */
	grid_way *grid_way;    /* the same */
	_Atomic uint8_t *seen; /* cells: BY_WHOLE_BOUNDARY, BY_OTHERS, where one has put a membrane */
	_Atomic uint32_t *open_viewpoints;
	size_t cells, viewpoints;
} work;

static size_t cell_at(const gw_scanned_space *space, const uint32_t at[3])
{
	return ((size_t)at[2] * space->cells[1] + at[1]) * space->cells[0] + at[0];
}

static bool find_cell(const gw_scanned_space *space, gw_vec3 place, size_t *cell)
{
	const float p[3] = { place.x, place.y, place.z };
	uint32_t at[3];
	if (!gw_scanned_space_cell(space, p, at))
		return false;
	*cell = cell_at(space, at);
	return true;
}

/* ----------------------------------------------------------------------------------- the grid */

/* Marks the cells that a disc touches. */
static void mark_disc(gw_scanned_space *space, const gw_surfels *s, size_t i)
{
	float tangent[3], bitangent[3];
	gw_tangent_frame(s->normal + 3 * i, tangent, bitangent);
	gw_vec3 p = gw_xyz(s->position + 3 * i), u = gw_xyz(tangent), v = gw_xyz(bitangent);
	float steps = fminf(ceilf(2.0f * s->radius[i] / space->cell), DISC_STEPS);
	int n = (int)fmaxf(steps, 1.0f);
	float part[2 * DISC_STEPS + 1]; /* of the radius */
	for (int a = 0; a <= 2 * n; a++)
		part[a] = (float)(a - n) / (float)n;
	for (int a = 0; a <= 2 * n; a++)
		for (int b = 0; b <= 2 * n; b++) {
			float x = part[a], y = part[b];
			size_t cell;
			if (x * x + y * y > 1.0f)
				continue;
			gw_vec3 way = gw_plus(gw_times(u, x * s->radius[i]), gw_times(v, y * s->radius[i]));
			if (find_cell(space, gw_plus(p, way), &cell))
				space->state[cell] = GW_SPACE_SURFACE;
		}
}

/* One of the two passes of a chessboard distance transform (Rosenfeld and Pfaltz 1966): no block's
 * number is more than one above those beside it that come before it, or with -1 after it. What lies
 * beside a row's end is another row's: the number may become less than it should be, which does no
 * harm. */
static void spread(empty_blocks *h, ptrdiff_t sign)
{
	const ptrdiff_t row = (ptrdiff_t)h->blocks[0], layer = row * (ptrdiff_t)h->blocks[1];
	const ptrdiff_t count = layer * (ptrdiff_t)h->blocks[2], reach = layer + row + 1;
	ptrdiff_t before[13];
	for (ptrdiff_t k = 0; k < 13; k++)
		before[k] = -sign * ((1 - k / 9) * layer + (1 - k / 3 % 3) * row + (1 - k % 3));
	for (ptrdiff_t i = reach; i < count - reach; i++) {
		uint8_t *own = h->empty + (sign > 0 ? i : count - 1 - i);
		unsigned least = EMPTY_MOST;
		for (int k = 0; k < 13; k++)
			least = own[before[k]] < least ? own[before[k]] : least;
		*own = least + 1 < *own ? (uint8_t)(least + 1) : *own;
	}
}

static size_t block_of(const empty_blocks *h, const uint32_t at[3])
{
	return ((size_t)(at[2] / BLOCK + 1) * h->blocks[1] + (at[1] / BLOCK + 1)) * h->blocks[0] +
		   (at[0] / BLOCK + 1);
}

/* Finds out how far it is empty around each block. */
static bool find_empty_blocks(const gw_scanned_space *space, empty_blocks *h)
{
	size_t count = 1;
	for (int k = 0; k < 3; k++) {
		h->blocks[k] = (space->cells[k] + BLOCK - 1) / BLOCK + 2;
		h->stride[k] = k == 0 ? 1 : h->stride[k - 1] * (int32_t)space->cells[k - 1];
		h->block_stride[k] = (int32_t)count;
		count *= h->blocks[k];
	}
	h->empty = gw_allocate_array(count, 1);
	if (!h->empty)
		return false;
	memset(h->empty, EMPTY_MOST, count);
	size_t cell = 0;
	uint32_t at[3];
	for (at[2] = 0; at[2] < space->cells[2]; at[2]++)
		for (at[1] = 0; at[1] < space->cells[1]; at[1]++)
			for (at[0] = 0; at[0] < space->cells[0]; at[0]++, cell++)
				if (space->state[cell] == GW_SPACE_SURFACE)
					h->empty[block_of(h, at)] = 0;
	spread(h, 1);
	spread(h, -1);
	return true;
}

/* The grid from a place, for directions that go down along some axes, in cells. */
typedef struct grid_view {
	float origin[3];
	float next[3]; /* where rays leave their first cell */
	float room[3]; /* how far along each axis it is to where they leave the grid */
	const uint8_t *state, *empty;
	int32_t stride[3], block_stride[3]; /* of these */
} grid_view;

static grid_way grid_way_of(gw_vec3 way)
{
	grid_way w = { .direction = { way.x, way.y, way.z } };
	for (int k = 0; k < 3; k++) {
		bool up = w.direction[k] > 0.0f;
		float rise = up ? w.direction[k] : -w.direction[k];
		w.down |= up ? 0u : 1u << k;
		w.direction[k] = rise < 1e-9f ? 1e-9f : rise;
		w.inverse[k] = 1.0f / w.direction[k];
	}
	return w;
}

static void view_axis(const gw_scanned_space *space, const empty_blocks *h, int k, bool up,
					  grid_view *view)
{
	int32_t blocks = (int32_t)h->blocks[k] - 2, width = BLOCK * blocks;
	view->origin[k] = up ? view->origin[k] : (float)width - view->origin[k];
	view->next[k] = (float)((int32_t)view->origin[k] + 1);
	view->state += up ? 0 : (width - 1) * h->stride[k];
	view->stride[k] = up ? h->stride[k] : -h->stride[k];
	view->empty += (up ? 1 : blocks) * h->block_stride[k];
	view->block_stride[k] = up ? h->block_stride[k] : -h->block_stride[k];
	/* Short of the border, so that no rounding takes a place before it to a cell behind it. */
	view->room[k] = (float)(up ? (int32_t)space->cells[k] : width) - GRID_NUDGE - view->origin[k];
}

/* False where the place is outside of the grid. */
static bool view_grid(const work *w, gw_vec3 from, uint32_t down, grid_view *view)
{
	const gw_scanned_space *space = w->space;
	const float p[3] = { from.x, from.y, from.z };
	uint32_t at[3];
	if (!gw_scanned_space_cell(space, p, at))
		return false;
	*view = (grid_view){ .state = space->state, .empty = w->empty_blocks.empty };
	for (int k = 0; k < 3; k++) {
		view->origin[k] = (p[k] - space->low[k]) / space->cell;
		view_axis(space, &w->empty_blocks, k, (down >> k & 1u) == 0u, view);
	}
	return true;
}

static float least(float a, float b)
{
	return a < b ? a : b;
}

static float most(float a, float b)
{
	return a > b ? a : b;
}

static float leave_box(const grid_view *view, const grid_way *way, const float box[3])
{
	float x = (box[0] - view->origin[0]) * way->inverse[0];
	float y = (box[1] - view->origin[1]) * way->inverse[1];
	float z = (box[2] - view->origin[2]) * way->inverse[2];
	return least(least(x, y), z);
}

/* How far it is to a cell with surface; below 0: there is none. At least a cell is passed. From one
 * empty box to the next; a box is the cell itself in a block that is not empty. */
static float walk_to_surface(const grid_view *view, const grid_way *way)
{
	float t = leave_box(view, way, view->next), within;
	float end = least(least(view->room[0] * way->inverse[0], view->room[1] * way->inverse[1]),
					  view->room[2] * way->inverse[2]);
	while ((within = t + GRID_NUDGE) < end) {
		int32_t x = (int32_t)(view->origin[0] + way->direction[0] * within);
		int32_t y = (int32_t)(view->origin[1] + way->direction[1] * within);
		int32_t z = (int32_t)(view->origin[2] + way->direction[2] * within);
		int32_t a = x >> BLOCK_BITS, b = y >> BLOCK_BITS, c = z >> BLOCK_BITS;
		int32_t empty = view->empty[a * view->block_stride[0] + b * view->block_stride[1] +
									c * view->block_stride[2]];
		if (empty == 0 &&
			view->state[x * view->stride[0] + y * view->stride[1] + z * view->stride[2]] ==
				GW_SPACE_SURFACE)
			return t;
		bool own = empty == 0;
		const float box[3] = { (float)(own ? x + 1 : (a + empty) * BLOCK),
							   (float)(own ? y + 1 : (b + empty) * BLOCK),
							   (float)(own ? z + 1 : (c + empty) * BLOCK) };
		float leave = leave_box(view, way, box);
		t = leave > within ? leave : within;
	}
	return -1.0f;
}

/* The same in metres. */
static float look(const work *w, gw_vec3 from, gw_vec3 way)
{
	const grid_way through = grid_way_of(way);
	grid_view view;
	float t = view_grid(w, from, through.down, &view) ? walk_to_surface(&view, &through) : -1.0f;
	return t < 0.0f ? t : t * w->space->cell;
}

/* ----------------------------------------------------------------------------- the viewpoints */

/* Half way across the free space before a surfel. */
static bool place_viewpoint(const work *w, size_t surfel, gw_vec3 *place)
{
	const gw_surfels *s = w->surfels;
	float cell = w->space->cell, tangent[3], bitangent[3];
	gw_vec3 p = gw_xyz(s->position + 3 * surfel), n = gw_xyz(s->normal + 3 * surfel);
	gw_tangent_frame(s->normal + 3 * surfel, tangent, bitangent);
	gw_vec3 u = gw_xyz(tangent), v = gw_xyz(bitangent);
	gw_vec3 from = gw_plus(p, gw_times(n, 2.0f * cell));
	const float aslant[VIEWPOINT_WAYS][2] = {
		{ 0, 0 }, { SLANT, 0 }, { -SLANT, 0 }, { 0, SLANT }, { 0, -SLANT }
	};
	for (int i = 0; i < VIEWPOINT_WAYS; i++) {
		gw_vec3 way =
			gw_unit(gw_plus(n, gw_plus(gw_times(u, aslant[i][0]), gw_times(v, aslant[i][1]))));
		float free = look(w, from, way);
		*place = gw_plus(from, gw_times(way, 0.5f * free));
		if (free > 2.0f * VIEWPOINT_ROOM * cell)
			return true;
	}
	return false;
}

static size_t place_viewpoints(work *w)
{
	size_t count = w->surfels->count, placed = 0;
	for (size_t i = 0; i < VIEWPOINTS; i++)
		placed += place_viewpoint(w, (2 * i + 1) * count / (2 * VIEWPOINTS), &w->place[placed]);
	return placed;
}

static gw_vec3 direction_at(float row, float column)
{
	float polar = GW_PI * row / ROWS, around = 2.0f * GW_PI * column / COLUMNS;
	return (gw_vec3){ sinf(polar) * cosf(around), sinf(polar) * sinf(around), cosf(polar) };
}

static gw_vec3 direction_of(uint32_t number)
{
	return direction_at((float)(number / COLUMNS) + 0.5f, (float)(number % COLUMNS) + 0.5f);
}

static float share_of(uint32_t number)
{
	float row = (float)(number / COLUMNS) + 0.5f;
	return sinf(GW_PI * row / ROWS) * GW_PI / (4.0f * ROWS * ROWS);
}

typedef struct extent {
	gw_vec3 low, high;
} extent;

static const extent nowhere = { { INFINITY, INFINITY, INFINITY },
								{ -INFINITY, -INFINITY, -INFINITY } };

static void extend(extent *e, gw_vec3 p)
{
	e->low = (gw_vec3){ least(e->low.x, p.x), least(e->low.y, p.y), least(e->low.z, p.z) };
	e->high = (gw_vec3){ most(e->high.x, p.x), most(e->high.y, p.y), most(e->high.z, p.z) };
}

static void widen(extent *e, float by)
{
	const gw_vec3 off = { by, by, by };
	e->low = gw_minus(e->low, off);
	e->high = gw_plus(e->high, off);
}

static float width_of(const extent *e)
{
	gw_vec3 d = gw_minus(e->high, e->low);
	return sqrtf(gw_dot(d, d));
}

/* Looks around; false where a viewpoint is in the open, or sees no hole at all. */
static bool look_around(const work *w, viewpoint *v)
{
	extent all = nowhere;
	float open = 0.0f;
	grid_view view[8];
	bool within = true;
	for (uint32_t down = 0; down < 8; down++)
		within = view_grid(w, v->place, down, &view[down]) && within;
	for (uint32_t i = 0; i < DIRECTIONS && open < (float)OPEN_MOST; i++) {
		gw_vec3 way = w->way[i];
		const grid_way *through = &w->grid_way[i];
		float t = within ? walk_to_surface(&view[through->down], through) : -1.0f;
		v->depth[i] = t < 0.0f ? t : t * w->space->cell;
		v->inverse[i] = v->depth[i] > 0.0f ? 1.0f / v->depth[i] : 0.0f;
		v->component[i] = 0;
		if (v->depth[i] < 0.0f)
			open += share_of(i);
		else
			extend(&all, gw_plus(v->place, gw_times(way, v->depth[i])));
	}
	v->width = width_of(&all);
	v->open = open >= (float)OPEN_MOST;
	return open > 0.0f && !v->open;
}

/* -------------------------------------------------------------------------- seen through holes */

/* The directions beside one; across the poles, too. */
static void list_beside(uint32_t number, uint32_t beside[4])
{
	uint32_t row = number / COLUMNS, column = number % COLUMNS;
	uint32_t across = (column + ROWS) % COLUMNS;
	beside[0] = row * COLUMNS + (column + 1) % COLUMNS;
	beside[1] = row * COLUMNS + (column + COLUMNS - 1) % COLUMNS;
	beside[2] = row > 0 ? number - COLUMNS : across;
	beside[3] = row + 1 < ROWS ? number + COLUMNS : row * COLUMNS + across;
}

/* What is known of a component of directions that find nothing. */
typedef struct component {
	uint32_t count, boundary;
	float share, nearest, furthest, inverse;
	extent boundary_extent;
} component;

static void add_boundary(const viewpoint *v, gw_vec3 way, uint32_t number, component *p)
{
	float depth = v->depth[number];
	p->boundary++;
	p->nearest = fminf(p->nearest, depth);
	p->furthest = fmaxf(p->furthest, depth);
	p->inverse += v->inverse[number];
	extend(&p->boundary_extent, gw_plus(v->place, gw_times(way, depth)));
}

/* The component that a direction belongs to, on the viewpoint's stack. */
static component find_component(const work *w, viewpoint *v, uint32_t first)
{
	component p = { .nearest = INFINITY, .boundary_extent = nowhere };
	v->stack[p.count++] = first;
	v->component[first] = 1;
	for (uint32_t i = 0; i < p.count; i++) {
		uint32_t beside[4];
		list_beside(v->stack[i], beside);
		p.share += share_of(v->stack[i]);
		for (int k = 0; k < 4; k++) {
			if (v->depth[beside[k]] >= 0.0f) {
				add_boundary(v, w->way[beside[k]], beside[k], &p);
			} else if (!v->component[beside[k]]) {
				v->component[beside[k]] = 1;
				v->stack[p.count++] = beside[k];
			}
		}
	}
	return p;
}

static gw_vec3 seen_at(const work *w, const viewpoint *v, uint32_t number)
{
	return gw_times(w->way[number], v->depth[number]);
}

/* Whether two directions meet surface so far apart. */
static bool is_jump(const work *w, const viewpoint *v, const uint32_t number[2], float most)
{
	if (v->depth[number[0]] < 0.0f || v->depth[number[1]] < 0.0f)
		return false;
	gw_vec3 off = gw_minus(seen_at(w, v, number[0]), seen_at(w, v, number[1]));
	return gw_dot(off, off) > most * most;
}

/* Whether there is a jump within the boundary of the component on the stack. Of the eight
 * directions around one of its own, those in the corners are beside two others each. */
static bool has_jump(const work *w, const viewpoint *v, const component *p)
{
	float most = fmaxf(JUMP_MOST * width_of(&p->boundary_extent), JUMP_CELLS * w->space->cell);
	for (uint32_t i = 0; i < p->count; i++) {
		uint32_t row = v->stack[i] / COLUMNS, beside[4], corner[4];
		list_beside(v->stack[i], beside);
		if (row == 0 || row + 1 == ROWS)
			continue;
		for (int k = 0; k < 4; k++) {
			list_beside(beside[k % 2], corner);
			const uint32_t by_row[2] = { beside[k % 2], corner[2 + k / 2] };
			const uint32_t by_column[2] = { beside[2 + k / 2], corner[2 + k / 2] };
			if (is_jump(w, v, by_row, most) || is_jump(w, v, by_column, most))
				return true;
		}
	}
	return false;
}

static bool is_hole(const work *w, const viewpoint *v, const component *p)
{
	float width = width_of(&p->boundary_extent);
	return p->boundary >= BOUNDARY_LEAST && p->share < 0.5f * (float)OPEN_MOST &&
		   width < BOUNDARY_MOST * v->width && width > BOUNDARY_CELLS * w->space->cell &&
		   p->furthest < SLOPE_MOST * p->nearest;
}

static void stretch_membrane(viewpoint *v, const component *p)
{
	for (uint32_t i = 0; i < p->count; i++)
		v->inverse[v->stack[i]] = p->inverse / (float)p->boundary;
	for (int sweep = 0; sweep < SWEEPS; sweep++)
		for (uint32_t i = 0; i < p->count; i++) {
			uint32_t beside[4];
			list_beside(v->stack[i], beside);
			v->inverse[v->stack[i]] = 0.25f * (v->inverse[beside[0]] + v->inverse[beside[1]] +
											   v->inverse[beside[2]] + v->inverse[beside[3]]);
		}
}

/* Marks the membrane within a direction, two cells thick, where nothing is met in fact. */
static void mark_direction(const work *w, const viewpoint *v, uint32_t number)
{
	const gw_scanned_space *space = w->space;
	float depth = 1.0f / v->inverse[number];
	int n = (int)ceilf(1.5f * depth * GW_PI / (ROWS * space->cell));
	for (int a = 0; a < n * n; a++) {
		gw_vec3 way = direction_at((float)(number / COLUMNS) + ((float)(a / n) + 0.5f) / (float)n,
								   (float)(number % COLUMNS) + ((float)(a % n) + 0.5f) / (float)n);
		if (look(w, v->place, way) >= 0.0f)
			continue;
		for (int side = -1; side <= 1; side++) {
			size_t cell;
			float t = depth + 0.5f * (float)side * space->cell;
			if (find_cell(space, gw_plus(v->place, gw_times(way, t)), &cell) &&
				space->state[cell] != GW_SPACE_SURFACE)
				atomic_fetch_or(&w->seen[cell], v->mark);
		}
	}
}

/* What the middle of a boundary's direction meets, others in it may not. */
static void mark_with_boundary(const work *w, viewpoint *v, uint32_t number)
{
	uint32_t beside[4];
	mark_direction(w, v, number);
	list_beside(number, beside);
	for (int k = 0; k < 4; k++)
		if (v->depth[beside[k]] >= 0.0f && !v->component[beside[k]]) {
			v->component[beside[k]] = 1;
			mark_direction(w, v, beside[k]);
		}
}

static void mark_component(const work *w, viewpoint *v, const component *p)
{
	v->mark = p->count < SEEN_WELL || has_jump(w, v, p) ? BY_OTHERS : BY_WHOLE_BOUNDARY;
	stretch_membrane(v, p);
	for (uint32_t k = 0; k < p->count; k++)
		mark_with_boundary(w, v, v->stack[k]);
}

/* Whether a viewpoint is in the open. */
static bool look_from(const work *w, viewpoint *v)
{
	if (!look_around(w, v))
		return v->open;
	for (uint32_t i = 0; i < DIRECTIONS; i++) {
		if (v->depth[i] >= 0.0f || v->component[i])
			continue;
		component p = find_component(w, v, i);
		if (is_hole(w, v, &p))
			mark_component(w, v, &p);
	}
	return false;
}

static void look_from_all(void *user, size_t first, size_t last, uint32_t worker)
{
	const work *w = user;
	(void)worker;
	for (size_t i = first; i < last; i++) {
		viewpoint v;
		v.place = w->place[i];
		if (look_from(w, &v))
			atomic_fetch_add(w->open_viewpoints, 1);
	}
}

/* ---------------------------------------------------------------------------------- the holes */

/* Calls for the cells around one, of which there are 26 but for the grid's ends. */
typedef size_t around_work(gw_scanned_space *space, size_t cell, uint32_t *stack, size_t top);

static size_t go_around(gw_scanned_space *space, size_t cell, around_work *call, uint32_t *stack,
						size_t top)
{
	uint32_t x = (uint32_t)(cell % space->cells[0]);
	uint32_t y = (uint32_t)(cell / space->cells[0] % space->cells[1]);
	uint32_t z = (uint32_t)(cell / space->cells[0] / space->cells[1]);
	for (uint32_t k = 0; k < 27; k++) {
		const uint32_t at[3] = { x + k % 3 - 1, y + k / 3 % 3 - 1, z + k / 9 - 1 };
		if (k != 13 && at[0] < space->cells[0] && at[1] < space->cells[1] &&
			at[2] < space->cells[2])
			top = call(space, cell_at(space, at), stack, top);
	}
	return top;
}

static size_t push_hole(gw_scanned_space *space, size_t cell, uint32_t *stack, size_t top)
{
	if (space->state[cell] != SEEN)
		return top;
	space->state[cell] = GW_SPACE_HOLE;
	stack[top] = (uint32_t)cell;
	return top + 1;
}

static size_t make_boundary(gw_scanned_space *space, size_t cell, uint32_t *stack, size_t top)
{
	(void)stack;
	if (space->state[cell] == GW_SPACE_SURFACE)
		space->state[cell] = GW_SPACE_BOUNDARY;
	return top;
}

static gw_vec3 middle_of(const gw_scanned_space *space, size_t cell)
{
	size_t x = cell % space->cells[0], y = cell / space->cells[0] % space->cells[1];
	size_t z = cell / space->cells[0] / space->cells[1];
	const gw_vec3 at = { (float)x + 0.5f, (float)y + 0.5f, (float)z + 0.5f };
	return gw_plus(gw_xyz(space->low), gw_times(at, space->cell));
}

/* Cells of a hole, of which some may be known to be none. */
typedef struct hole {
	const uint32_t *cell;
	size_t cells;
	gw_vec3 middle;
	float width;
} hole;

static hole measure(const gw_scanned_space *space, const uint32_t *cell, size_t cells)
{
	hole h = { .cell = cell, .cells = cells };
	extent e = nowhere;
	for (size_t i = 0; i < cells; i++) {
		gw_vec3 p = middle_of(space, cell[i]);
		extend(&e, p);
		h.middle = gw_plus(h.middle, gw_times(p, 1.0f / (float)cells));
	}
	h.width = width_of(&e);
	return h;
}

/* Counts a hole, lists its cells and extends what all are in; one of too few cells is none. */
static void count_hole(gw_scanned_space *space, const hole *h, extent *all)
{
	if (h->cells < HOLE_CELLS || h->width < BOUNDARY_CELLS * space->cell) {
		for (size_t i = 0; i < h->cells; i++)
			space->state[h->cell[i]] = GW_SPACE_FREE;
		return;
	}
	for (size_t i = 0; i < h->cells; i++) {
		go_around(space, h->cell[i], make_boundary, NULL, 0);
		extend(all, middle_of(space, h->cell[i]));
		space->hole_cell[space->hole_cells++] = (uint64_t)h->cell[i] << 32 | space->holes;
	}
	space->holes++;
	if (h->width <= space->hole_width)
		return;
	space->hole_width = h->width;
	memcpy(space->hole_place, &h->middle, sizeof space->hole_place);
}

static int compare_cells(const void *a, const void *b)
{
	uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
	return (x > y) - (x < y);
}

/* Puts the holes' cells on a stack, one hole after the other. */
static bool count_holes(const work *w)
{
	gw_scanned_space *space = w->space;
	size_t seen = 0;
	uint8_t marks = OPEN_VIEWPOINTS * *w->open_viewpoints > w->viewpoints
						? BY_WHOLE_BOUNDARY
						: BY_WHOLE_BOUNDARY | BY_OTHERS;
	extent all = nowhere;
	for (size_t c = 0; c < w->cells; c++)
		if (space->state[c] != GW_SPACE_SURFACE) {
			bool own = (atomic_load(&w->seen[c]) & marks) != 0;
			space->state[c] = own ? SEEN : GW_SPACE_FREE;
			seen += own;
		}
	uint32_t *stack = gw_allocate_array(seen + 1, sizeof *stack);
	space->hole_cell = gw_allocate_array(seen + 1, sizeof *space->hole_cell);
	bool made = stack && space->hole_cell;
	for (size_t c = 0; c < w->cells && made; c++) {
		size_t top = push_hole(space, c, stack, 0);
		for (size_t i = 0; i < top; i++)
			top = go_around(space, stack[i], push_hole, stack, top);
		if (top == 0)
			continue;
		hole h = measure(space, stack, top);
		count_hole(space, &h, &all);
	}
	if (made)
		qsort(space->hole_cell, space->hole_cells, sizeof *space->hole_cell, compare_cells);
	widen(&all, 2.0f * space->cell); /* their boundaries are beside them */
	memcpy(space->holes_low, &all.low, sizeof all.low);
	memcpy(space->holes_high, &all.high, sizeof all.high);
	free(stack);
	return made;
}

gw_status gw_surface_holes_find(const gw_surfels *surfels, uint32_t threads,
								gw_scanned_space *space, gw_error *error)
{
	_Atomic uint32_t open_viewpoints = 0;
	work w = { .surfels = surfels, .space = space, .open_viewpoints = &open_viewpoints };
	*space = (gw_scanned_space){ .scanners = 0 };
	if (!(surfels->maximum[0] > surfels->minimum[0]))
		return GW_OK;
	bool made = gw_scanned_space_grid(surfels, GRID_CELLS, CELL_SPACINGS * surfels->spacing, space);
	w.cells = (size_t)space->cells[0] * space->cells[1] * space->cells[2];
	w.seen = made ? gw_allocate_zeros(w.cells, sizeof *w.seen) : NULL;
	w.place = gw_allocate_array(VIEWPOINTS, sizeof *w.place);
	w.way = gw_allocate_array(DIRECTIONS, sizeof *w.way);
	w.grid_way = gw_allocate_array(DIRECTIONS, sizeof *w.grid_way);
	made = made && w.seen && w.place && w.way && w.grid_way;
	for (uint32_t i = 0; i < DIRECTIONS && made; i++) {
		w.way[i] = direction_of(i);
		w.grid_way[i] = grid_way_of(w.way[i]);
	}
	if (made) {
		for (size_t i = 0; i < surfels->count; i++)
			mark_disc(space, surfels, i);
		made = find_empty_blocks(space, &w.empty_blocks);
	}
	if (made) {
		w.viewpoints = place_viewpoints(&w);
		gw_parallel_for(threads, w.viewpoints, 1, look_from_all, &w);
		made = count_holes(&w);
	}
	free(w.empty_blocks.empty);
	free(w.grid_way);
	free(w.way);
	free(w.place);
	free(w.seen);
	gw_status status = made ? GW_OK
							: gw_fail(error, GW_ERROR_MEMORY,
									  "no memory for the holes of %zu surfels", surfels->count);
	if (status == GW_OK && space->holes > 0)
		status = gw_solid_cells_mark(surfels, space, error);
	if (status != GW_OK || !gw_scanned_space_known(space))
		gw_scanned_space_clear(space);
	return status;
}

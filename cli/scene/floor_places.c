#include "scene/floor_places.h"

#include "glowworm_picture.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Cubes a decimetre wide, or wider by powers of two up to metres; what a foot climbs. */
#define CELL_LEAST 0.1
#define CELL_MOST 3.2
#define STEP 0.3

/* Free floor that is worth a place, square metres: it is what is left of it away from walls. */
#define AREA_LEAST 1.0

/* So many cubes at most of one point; of even surface that is three points in each of its cubes. */
#define SINGLES 0.15
#define WAY_LEAST 2.0

/* How often places may be chosen half as far again from each other: two metres become 250. */
#define TRIES 12

/* What lies above lower floor so near, metres, is its cover, or stands on it, where such a share of
 * it does. Looked for in so many steps to either side. */
#define COVER_REACH 3.0
#define COVER_SHARE 0.25
#define COVER_STEPS 8

/* Indices of cubes, from the middle of the points, are put into one number, the height last, so
 * that columns stand together when they are sorted. */
#define BITS 21
#define HALF ((int64_t)1 << (BITS - 1))

enum { FLOOR = 1, FREE = 2 };

/* A cube with points. */
typedef struct cube {
	uint64_t key;
	uint32_t points;
	uint32_t clearance; /* steps to where the free floor ends, from 1 */
	uint32_t region;    /* of free floor, from 1 */
	uint32_t mark;      /* of the last place from which there was a way */
	uint8_t kind;
} cube;

typedef struct grid {
	const double *position;
	size_t points;
	double axis[3][3]; /* right, back, up */
	double middle[3];  /* along these */
	double cell;       /* metres */
	uint64_t *key;     /* owned; of each point */
	cube *cube;        /* owned; count, by key */
	uint32_t *queue;   /* owned; count */
	size_t count;
	int64_t head, step, reach; /* cells */
} grid;

/* ------------------------------------------------------------------------------------- cubes */

static double along(const grid *g, int axis, const double *p)
{
	const double *a = g->axis[axis];
	return a[0] * p[0] + a[1] * p[1] + a[2] * p[2];
}

static int compare_doubles(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

static int compare_keys(const void *a, const void *b)
{
	uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
	return (x > y) - (x < y);
}

/* Strays far away move no median. */
static gw_status find_middle(grid *g, gw_error *error)
{
	double *value = reallocarray(NULL, g->points + 1, sizeof *value);
	if (!value)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu points", g->points);
	for (int axis = 0; axis < 3; axis++) {
		size_t count = 0;
		for (size_t i = 0; i < g->points; i++) {
			double v = along(g, axis, g->position + 3 * i);
			if (isfinite(v))
				value[count++] = v;
		}
		qsort(value, count, sizeof *value, compare_doubles);
		g->middle[axis] = count ? value[count / 2] : 0.0;
	}
	free(value);
	return GW_OK;
}

/* UINT64_MAX for what is too far away, or nowhere. */
static uint64_t key_of(const grid *g, const double *p)
{
	uint64_t key = 0;
	for (int axis = 0; axis < 3; axis++) {
		double v = floor((along(g, axis, p) - g->middle[axis]) / g->cell);
		if (!(fabs(v) < (double)HALF))
			return UINT64_MAX;
		key = key << BITS | (uint64_t)((int64_t)v + HALF);
	}
	return key;
}

/* Cubes of this width; whether most of those that have points have several. */
static bool fill_cubes(grid *g)
{
	g->count = 0;
	size_t single = 0;
	for (size_t i = 0; i < g->points; i++)
		g->key[i] = key_of(g, g->position + 3 * i);
	qsort(g->key, g->points, sizeof *g->key, compare_keys);
	for (size_t i = 0; i < g->points && g->key[i] != UINT64_MAX; i++) {
		if (g->count == 0 || g->cube[g->count - 1].key != g->key[i])
			g->cube[g->count++] = (cube){ .key = g->key[i] };
		g->cube[g->count - 1].points++;
	}
	for (size_t i = 0; i < g->count; i++)
		single += g->cube[i].points == 1;
	return (double)single <= SINGLES * (double)g->count;
}

static gw_status make_cubes(grid *g, gw_error *error)
{
	g->key = reallocarray(NULL, g->points + 1, sizeof *g->key);
	g->cube = reallocarray(NULL, g->points + 1, sizeof *g->cube);
	g->queue = reallocarray(NULL, g->points + 1, sizeof *g->queue);
	if (!g->key || !g->cube || !g->queue)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for cubes of %zu points", g->points);
	g->cell = CELL_LEAST;
	while (!fill_cubes(g) && g->cell < CELL_MOST)
		g->cell *= 2.0;
	/* One point in a cube may be a stray. */
	size_t kept = 0;
	for (size_t i = 0; i < g->count; i++)
		if (g->cube[i].points > 1)
			g->cube[kept++] = g->cube[i];
	g->count = kept;
	g->head = (int64_t)ceil(FLOOR_HEAD / g->cell);
	g->step = (int64_t)fmax(STEP / g->cell, 1.0);
	g->reach = (int64_t)fmax(ceil(FLOOR_REACH / g->cell), 1.0);
	return GW_OK;
}

static int64_t height_of(const cube *c)
{
	return (int64_t)(c->key & (((uint64_t)1 << BITS) - 1));
}

static uint64_t column_of(uint64_t key)
{
	return key >> BITS;
}

/* The key of a column some cells aside. It is never at the edge of what has keys. */
static uint64_t beside(uint64_t column, int64_t right, int64_t back)
{
	return column + ((uint64_t)right << BITS) + (uint64_t)back;
}

/* The first cube of a column, or of those behind it. */
static size_t find_column(const grid *g, uint64_t column)
{
	size_t low = 0, high = g->count;
	while (low < high) {
		size_t half = low + (high - low) / 2;
		if (column_of(g->cube[half].key) < column)
			low = half + 1;
		else
			high = half;
	}
	return low;
}

/* ------------------------------------------------------------------------------------- floor */

/* Marks what nothing stands on. */
static void mark_floor(grid *g)
{
	size_t lowest = 0;
	for (size_t i = 0; i < g->count; i++) {
		cube *c = &g->cube[i];
		bool last = i + 1 == g->count || column_of(c[1].key) != column_of(c->key);
		if (column_of(g->cube[lowest].key) != column_of(c->key))
			lowest = i;
		bool on_ground = height_of(c) - height_of(&g->cube[lowest]) <= g->step;
		if (last ? on_ground : height_of(&c[1]) - height_of(c) > g->head)
			c->kind |= FLOOR;
	}
}

/* Floor of a kind in a column within a step of a height, or NULL; *blocked: something else is in
 * the way there. */
static cube *floor_beside(const grid *g, uint64_t column, int64_t height, uint8_t kind,
						  bool *blocked)
{
	*blocked = false;
	for (size_t i = find_column(g, column); i < g->count; i++) {
		cube *c = &g->cube[i];
		int64_t over = height_of(c) - height;
		if (column_of(c->key) != column || over > g->head)
			break;
		if (c->kind & kind && llabs(over) <= g->step)
			return c;
		*blocked = *blocked || over > 0;
	}
	return NULL;
}

/* Whether all around a place is floor too; a quarter of it may have no points. */
static bool is_free(const grid *g, const cube *c)
{
	int64_t seen = 0, all = 0;
	bool blocked;
	for (int64_t x = -g->reach; x <= g->reach; x++)
		for (int64_t y = -g->reach; y <= g->reach; y++) {
			if (x * x + y * y > g->reach * g->reach)
				continue;
			uint64_t column = beside(column_of(c->key), x, y);
			all++;
			if (floor_beside(g, column, height_of(c), FLOOR, &blocked))
				seen++;
			else if (blocked)
				return false;
		}
	return 4 * seen >= 3 * all;
}

/* Free floor around free floor, eight at most. */
static size_t neighbours(const grid *g, const cube *c, cube *beside_it[8])
{
	size_t count = 0;
	bool blocked;
	for (int x = -1; x <= 1; x++)
		for (int y = -1; y <= 1; y++) {
			uint64_t column = beside(column_of(c->key), x, y);
			cube *other = x || y ? floor_beside(g, column, height_of(c), FREE, &blocked) : NULL;
			if (other)
				beside_it[count++] = other;
		}
	return count;
}

/* Gives all that hangs together with one cube the number of its region; how many cubes it has. */
static size_t mark_region(grid *g, cube *from, uint32_t region)
{
	size_t first = 0, last = 0;
	cube *other[8];
	from->region = region;
	g->queue[last++] = (uint32_t)(from - g->cube);
	while (first < last) {
		size_t count = neighbours(g, &g->cube[g->queue[first++]], other);
		for (size_t k = 0; k < count; k++)
			if (other[k]->region == 0) {
				other[k]->region = region;
				g->queue[last++] = (uint32_t)(other[k] - g->cube);
			}
	}
	return last;
}

/* A region of free floor. */
typedef struct region {
	size_t cells, covers;
} region;

/* Whether free floor that counts more is further down in a column. Below what is open above this is
 * all that is a head lower: that is the outside of a ceiling where the floor was not seen. Below
 * what has a ceiling it is a larger floor that is not a storey lower: that is furniture. */
static bool is_over_floor(const grid *g, const region *own, uint64_t column, const cube *c)
{
	bool open = c + 1 == g->cube + g->count || column_of(c[1].key) != column_of(c->key);
	for (size_t i = find_column(g, column); i < g->count; i++) {
		const cube *low = &g->cube[i];
		int64_t lower = height_of(c) - height_of(low);
		if (column_of(low->key) != column || lower <= g->step)
			return false;
		if (!(low->kind & FREE) || low->region == c->region)
			continue;
		if (open ? lower > g->head
				 : lower <= g->head && own[low->region].cells > own[c->region].cells)
			return true;
	}
	return false;
}

/* Whether that is so not far from a cube. */
static bool is_cover(const grid *g, const region *own, const cube *c)
{
	int64_t stride = (int64_t)ceil(COVER_REACH / COVER_STEPS / g->cell);
	bool found = false;
	for (int64_t x = -COVER_STEPS; x <= COVER_STEPS && !found; x++)
		for (int64_t y = -COVER_STEPS; y <= COVER_STEPS && !found; y++)
			found = is_over_floor(g, own, beside(column_of(c->key), x * stride, y * stride), c);
	return found;
}

static bool is_covering(const region *r)
{
	return (double)r->covers > COVER_SHARE * (double)r->cells;
}

static bool is_large(const grid *g, const region *r)
{
	return (double)r->cells * g->cell * g->cell >= AREA_LEAST && !is_covering(r);
}

/* Covers are no floor, nor are tables, ledges and the like where there is any that is larger. */
static gw_status drop_regions(grid *g, gw_error *error)
{
	region *own = calloc(g->count + 1, sizeof *own);
	uint32_t count = 0;
	bool any = false;
	if (!own)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu cubes", g->count);
	for (size_t i = 0; i < g->count; i++)
		if (g->cube[i].kind & FREE && g->cube[i].region == 0) {
			count++;
			own[count].cells = mark_region(g, &g->cube[i], count);
		}
	for (size_t i = 0; i < g->count; i++)
		if (g->cube[i].kind & FREE)
			own[g->cube[i].region].covers += is_cover(g, own, &g->cube[i]);
	for (uint32_t r = 1; r <= count; r++)
		any = any || is_large(g, &own[r]);
	for (size_t i = 0; i < g->count; i++) {
		const region *r = &own[g->cube[i].region];
		if (any ? !is_large(g, r) : is_covering(r))
			g->cube[i].kind &= (uint8_t)~FREE;
	}
	free(own);
	return GW_OK;
}

/* How many steps each region of free floor is from where it ends. */
static void measure_clearance(grid *g)
{
	size_t first = 0, last = 0;
	cube *other[8];
	for (size_t i = 0; i < g->count; i++)
		if (g->cube[i].kind & FREE && neighbours(g, &g->cube[i], other) < 8) {
			g->cube[i].clearance = 1;
			g->queue[last++] = (uint32_t)i;
		}
	while (first < last) {
		const cube *c = &g->cube[g->queue[first++]];
		size_t count = neighbours(g, c, other);
		for (size_t k = 0; k < count; k++)
			if (other[k]->clearance == 0) {
				other[k]->clearance = c->clearance + 1;
				g->queue[last++] = (uint32_t)(other[k] - g->cube);
			}
	}
}

static gw_status find_free_floor(grid *g, gw_error *error)
{
	mark_floor(g);
	for (size_t i = 0; i < g->count; i++)
		if (g->cube[i].kind & FLOOR && is_free(g, &g->cube[i]))
			g->cube[i].kind |= FREE;
	GW_TRY(drop_regions(g, error));
	measure_clearance(g);
	return GW_OK;
}

/* ------------------------------------------------------------------------------------ places */

/* The most open of what is left; of such that are alike the first by its place. */
static cube *find_next(grid *g)
{
	cube *best = NULL;
	for (size_t i = 0; i < g->count; i++) {
		cube *c = &g->cube[i];
		if (c->kind & FREE && c->mark == 0 && (!best || c->clearance > best->clearance))
			best = c;
	}
	return best;
}

/* Marks free floor to which there is a way of so many steps at most. mark: of each cube the steps
 * left when it was reached, and 1. */
static void mark_ways(grid *g, cube *from, uint32_t steps)
{
	size_t first = 0, last = 0;
	cube *other[8];
	from->mark = steps + 1;
	g->queue[last++] = (uint32_t)(from - g->cube);
	while (first < last) {
		const cube *c = &g->cube[g->queue[first++]];
		size_t count = c->mark > 1 ? neighbours(g, c, other) : 0;
		for (size_t k = 0; k < count; k++)
			if (other[k]->mark < c->mark - 1) {
				other[k]->mark = c->mark - 1;
				g->queue[last++] = (uint32_t)(other[k] - g->cube);
			}
	}
}

/* Places at least so far from each other, up to one more than there may be. */
static size_t choose(grid *g, double way, cube *chosen[FLOOR_PLACES_MAX + 1])
{
	size_t count = 0;
	cube *next;
	for (size_t i = 0; i < g->count; i++)
		g->cube[i].mark = 0;
	while (count <= FLOOR_PLACES_MAX && (next = find_next(g))) {
		chosen[count++] = next;
		mark_ways(g, next, (uint32_t)fmax(way / g->cell, 1.0));
	}
	return count;
}

/* In the middle of a cube, as high as its highest point. */
static void put_place(const grid *g, const cube *c, double place[3])
{
	double at[3], highest = -INFINITY;
	uint64_t key = c->key;
	for (size_t i = 0; i < g->points; i++)
		if (key_of(g, g->position + 3 * i) == key)
			highest = fmax(highest, along(g, 2, g->position + 3 * i));
	for (int axis = 2; axis >= 0; axis--) {
		int64_t cells = (int64_t)(key & (((uint64_t)1 << BITS) - 1)) - HALF;
		at[axis] = g->middle[axis] + ((double)cells + 0.5) * g->cell;
		key >>= BITS;
	}
	at[2] = highest;
	for (int k = 0; k < 3; k++)
		place[k] = at[0] * g->axis[0][k] + at[1] * g->axis[1][k] + at[2] * g->axis[2][k];
}

static gw_status find(grid *g, double *place, size_t *found, gw_error *error)
{
	cube *chosen[FLOOR_PLACES_MAX + 1];
	double way = WAY_LEAST;
	int tries = 0;
	GW_TRY(find_middle(g, error));
	GW_TRY(make_cubes(g, error));
	GW_TRY(find_free_floor(g, error));
	while ((*found = choose(g, way, chosen)) > FLOOR_PLACES_MAX && tries++ < TRIES)
		way *= 1.5;
	if (*found > FLOOR_PLACES_MAX) /* there are so many regions with no way between them */
		*found = FLOOR_PLACES_MAX;
	for (size_t i = 0; i < *found; i++)
		put_place(g, chosen[i], place + 3 * i);
	return GW_OK;
}

gw_status floor_places_find(const double *position, size_t count, char up,
							double place[3 * FLOOR_PLACES_MAX], size_t *found, gw_error *error)
{
	grid g = { .position = position, .points = count };
	*found = 0;
	gw_camera_stand(up, g.axis[0], g.axis[1], g.axis[2]);
	gw_status status = find(&g, place, found, error);
	free(g.key);
	free(g.cube);
	free(g.queue);
	return status;
}

/*
 * tiling.c - see tiling.h.
 */
#include "bake/tiling.h"

#include "base/memory.h"
#include "cloud/bulk_bounds.h"
#include "cloud/frame.h"
#include "glowworm_picture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Cubes along an axis; what lies beyond is in the outermost. */
#define CUBES 2097152
#define NO_CUBE UINT32_MAX

/* Cubes along an edge of a cube's surroundings. */
#define AROUND (2 * GW_TILE_HALO + 1)

typedef struct cube {
	uint64_t key; /* Morton key */
	uint64_t points;
	uint32_t tile;     /* whose core it is in */
	uint32_t halo;     /* first of those whose halo it is in, in gw_tiling.halo */
	uint32_t in_halos; /* how many */
} cube;

struct gw_tiling {
	double width, low[3];
	uint64_t home; /* key of the cube that points are in whose place is not finite */
	cube *cube;    /* count */
	uint32_t count, room;
	uint32_t *slot; /* mask + 1: NO_CUBE, or which cube is there */
	uint64_t mask;
	uint64_t points;
	uint32_t tiles; /* 0: not formed yet */
	uint32_t *halo; /* tiles, cube after cube */
	uint32_t halo_count, halo_room;
};

/* -------------------------------------------------------------------------------------- cubes */

static uint64_t mixed(uint64_t key)
{
	key ^= key >> 31;
	key *= UINT64_C(0x9e3779b97f4a7c15);
	return key ^ key >> 29;
}

static uint64_t slot_of(const gw_tiling *t, uint64_t key)
{
	uint64_t slot = mixed(key) & t->mask;
	while (t->slot[slot] != NO_CUBE && t->cube[t->slot[slot]].key != key)
		slot = (slot + 1) & t->mask;
	return slot;
}

static uint32_t find_cube(const gw_tiling *t, uint64_t key)
{
	return t->slot[slot_of(t, key)];
}

/* A table of slots for the cubes that there are, with room for as many. */
static bool make_slots(gw_tiling *t, uint64_t slots)
{
	uint32_t *slot = gw_allocate_array(slots, sizeof *slot);
	if (!slot)
		return false;
	memset(slot, 0xff, slots * sizeof *slot);
	free(t->slot);
	t->slot = slot;
	t->mask = slots - 1;
	for (uint32_t c = 0; c < t->count; c++)
		slot[slot_of(t, t->cube[c].key)] = c;
	return true;
}

/* Twice the room for an array, which stays the caller's where there is no memory: NULL. */
static void *more_room(void *array, uint32_t *room, size_t size)
{
	uint32_t wanted = *room < 512 ? 1024 : 2 * *room;
	void *grown = gw_resize_array(array, wanted, size);
	*room = grown ? wanted : *room;
	return grown;
}

static bool add_cube(gw_tiling *t, uint64_t key, uint32_t *added)
{
	if (t->count == t->room) {
		cube *grown = more_room(t->cube, &t->room, sizeof *grown);
		t->cube = grown ? grown : t->cube;
		if (!grown || !make_slots(t, 4 * (uint64_t)t->room))
			return false;
	}
	t->cube[t->count] = (cube){ .key = key };
	t->slot[slot_of(t, key)] = t->count;
	*added = t->count++;
	return true;
}

static uint32_t along(double place)
{
	return (uint32_t)fmin(fmax(floor(place) + CUBES / 2, 0.0), (double)(CUBES - 1));
}

static bool is_finite(const double place[3])
{
	return isfinite(place[0]) && isfinite(place[1]) && isfinite(place[2]);
}

/* The key of the cube around a place. */
static uint64_t key_of(const gw_tiling *t, const double place[3])
{
	uint32_t at[3];
	if (!is_finite(place))
		return t->home;
	for (int k = 0; k < 3; k++)
		at[k] = along((place[k] - t->low[k]) / t->width);
	return gw_morton_encode(at[0], at[1], at[2]);
}

/* That of a point which has a place: so no tile is made of others alone. */
static void find_home(gw_tiling *t, const gw_points *kept)
{
	for (size_t i = 0; i < kept->count; i++)
		if (is_finite(kept->position + 3 * i)) {
			t->home = key_of(t, kept->position + 3 * i);
			return;
		}
}

gw_status gw_tiling_begin(const gw_points *kept, double width, gw_tiling **tiling, gw_error *error)
{
	double high[3];
	gw_tiling *t = *tiling = gw_allocate_zeros(1, sizeof *t);
	if (!t)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for tiles");
	t->width = width;
	gw_finite_bounds(kept, t->low, high);
	gw_bulk_bounds(kept, t->low, high);
	find_home(t, kept);
	if (make_slots(t, 4096))
		return GW_OK;
	gw_tiling_end(tiling);
	return gw_fail(error, GW_ERROR_MEMORY, "no memory for tiles");
}

gw_status gw_tiling_count(gw_tiling *t, const gw_points *part, gw_error *error)
{
	for (size_t i = 0; i < part->count; i++) {
		uint64_t key = key_of(t, part->position + 3 * i);
		uint32_t c = find_cube(t, key);
		if (c == NO_CUBE && !add_cube(t, key, &c))
			return gw_fail(error, GW_ERROR_MEMORY, "no memory for %u cubes of tiles", t->count);
		t->cube[c].points++;
	}
	t->points += part->count;
	return GW_OK;
}

void gw_tiling_end(gw_tiling **tiling)
{
	gw_tiling *t = *tiling;
	if (t) {
		free(t->cube);
		free(t->slot);
		free(t->halo);
	}
	free(t);
	*tiling = NULL;
}

/* -------------------------------------------------------------------------------------- tiles */

static int compare_keys(const void *a, const void *b)
{
	uint64_t x = ((const cube *)a)->key, y = ((const cube *)b)->key;
	return (x > y) - (x < y);
}

/* What is done with a cube within a halo's width of another one. */
typedef bool cube_user(void *user, uint32_t beside);

/* Goes on to all such cubes that there are, the other one too, as long as it is told to. */
static bool use_around(const gw_tiling *t, const cube *of, cube_user *use, void *user)
{
	uint32_t at[3];
	gw_morton_decode(of->key, at);
	for (int k = 0; k < AROUND * AROUND * AROUND; k++) {
		int64_t x = (int64_t)at[0] + k % AROUND - GW_TILE_HALO;
		int64_t y = (int64_t)at[1] + k / AROUND % AROUND - GW_TILE_HALO;
		int64_t z = (int64_t)at[2] + k / (AROUND * AROUND) - GW_TILE_HALO;
		if (x < 0 || y < 0 || z < 0 || x >= CUBES || y >= CUBES || z >= CUBES)
			continue;
		uint32_t beside = find_cube(t, gw_morton_encode((uint32_t)x, (uint32_t)y, (uint32_t)z));
		if (beside != NO_CUBE && !use(user, beside))
			return false;
	}
	return true;
}

/* A tile that takes in one cube after the other. */
typedef struct growing {
	const gw_tiling *tiling;
	uint32_t *last;  /* of each cube: the last tile that has it in its core or halo, plus one */
	uint32_t tile;   /* this one, plus one */
	uint64_t points; /* of its core and halo */
	uint64_t more;   /* that the next cube would bring */
} growing;

static bool count_more(void *user, uint32_t beside)
{
	growing *g = user;
	g->more += g->last[beside] == g->tile ? 0 : g->tiling->cube[beside].points;
	return true;
}

static bool take_in(void *user, uint32_t beside)
{
	growing *g = user;
	g->last[beside] = g->tile;
	return true;
}

/* How many points a tile would have with one more cube. */
static uint64_t points_with(growing *g, const cube *next)
{
	g->more = 0;
	use_around(g->tiling, next, count_more, g);
	return g->points + g->more;
}

/* The most points that a cube has with its halo; g has not begun. A tile there has them, whatever
 * it was to have, so that less memory is used by no other one's being smaller. */
static uint64_t fullest_cube(growing *g)
{
	uint64_t most = 0;
	for (uint32_t c = 0; c < g->tiling->count; c++) {
		uint64_t points = points_with(g, &g->tiling->cube[c]);
		most = points > most ? points : most;
	}
	return most;
}

/*
 * Cuts the cubes into runs. A tile ends where another cube would give it more than `most` points,
 * or than one cube alone gives another tile, and where its share of the least number of tiles ends.
 */
static gw_status cut(gw_tiling *t, uint64_t most, double least, gw_error *error)
{
	uint64_t before = 0;
	uint32_t due = 0;
	double share = (double)t->points / least;
	growing g = { .tiling = t, .tile = 1 };
	g.last = gw_allocate_zeros(t->count, sizeof *g.last);
	if (!g.last)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %u cubes of tiles", t->count);
	uint64_t fullest = fullest_cube(&g);
	most = fullest > most ? fullest : most;
	for (uint32_t c = 0; c < t->count; c++) {
		cube *next = &t->cube[c];
		uint32_t now = (uint32_t)fmin((double)before / share, least - 1.0);
		uint64_t points = points_with(&g, next);
		if (c > 0 && (now > due || points > most)) {
			g.tile++;
			g.points = 0;
			due = now;
			points = points_with(&g, next);
		}
		g.points = points;
		use_around(t, next, take_in, &g);
		next->tile = g.tile - 1;
		before += next->points;
	}
	t->tiles = g.tile;
	free(g.last);
	return GW_OK;
}

static bool add_to_halo(gw_tiling *t, cube *of, uint32_t tile)
{
	for (uint32_t i = 0; i < of->in_halos; i++)
		if (t->halo[of->halo + i] == tile)
			return true;
	if (t->halo_count == t->halo_room) {
		uint32_t *grown = more_room(t->halo, &t->halo_room, sizeof *grown);
		if (!grown)
			return false;
		t->halo = grown;
	}
	t->halo[t->halo_count++] = tile;
	of->in_halos++;
	return true;
}

/* A cube whose halos are looked for. */
typedef struct haloed {
	gw_tiling *tiling;
	cube *cube;
} haloed;

static bool add_tile_of(void *user, uint32_t beside)
{
	const haloed *h = user;
	uint32_t tile = h->tiling->cube[beside].tile;
	return tile == h->cube->tile || add_to_halo(h->tiling, h->cube, tile);
}

/* In whose halos cubes are: the tiles of those around each, but its own. */
static gw_status find_halos(gw_tiling *t, gw_error *error)
{
	t->halo_count = 0;
	for (uint32_t c = 0; c < t->count; c++) {
		haloed h = { t, &t->cube[c] };
		h.cube->halo = t->halo_count;
		h.cube->in_halos = 0;
		if (!use_around(t, h.cube, add_tile_of, &h))
			return gw_fail(error, GW_ERROR_MEMORY, "no memory for %u tiles", t->tiles);
	}
	return GW_OK;
}

gw_status gw_tiling_form(gw_tiling *t, uint64_t most, uint32_t least, gw_error *error)
{
	if (t->count == 0)
		return gw_fail(error, GW_ERROR_DATA, "there are no points to make tiles of");
	qsort(t->cube, t->count, sizeof *t->cube, compare_keys);
	for (uint64_t slot = 0; slot <= t->mask; slot++)
		t->slot[slot] = NO_CUBE;
	for (uint32_t c = 0; c < t->count; c++)
		t->slot[slot_of(t, t->cube[c].key)] = c;
	GW_TRY(cut(t, most, fmin(fmax(least, 1.0), (double)t->count), error));
	return find_halos(t, error);
}

uint32_t gw_tiling_tiles(const gw_tiling *t)
{
	return t->tiles;
}

/* ------------------------------------------------------------------------------------ members */

/* Lists a point with its tile and those whose halo it is in, or only counts it. */
static void enter(const gw_tiling *t, const double place[3], uint32_t point, gw_tile_members *m,
				  uint64_t *next)
{
	uint32_t found = find_cube(t, key_of(t, place));
	if (found == NO_CUBE) /* of another cloud */
		return;
	const cube *of = &t->cube[found];
	for (uint32_t i = 0; i <= of->in_halos; i++) {
		uint32_t tile = i == 0 ? of->tile : t->halo[of->halo + i - 1];
		uint64_t at = next[tile]++;
		if (!m->point)
			continue;
		m->point[at] = point;
		m->core[at] = i == 0;
	}
}

gw_status gw_tiling_members(const gw_tiling *t, const gw_points *part, gw_tile_members *m,
							gw_error *error)
{
	*m = (gw_tile_members){ .first = gw_allocate_zeros(t->tiles + 1, sizeof *m->first) };
	uint64_t *next = gw_allocate_zeros(t->tiles, sizeof *next), all = 0;
	uint32_t *point = NULL;
	for (size_t i = 0; next && i < part->count; i++)
		enter(t, part->position + 3 * i, (uint32_t)i, m, next);
	for (uint32_t tile = 0; m->first && next && tile < t->tiles; tile++) {
		m->first[tile] = all;
		all += next[tile];
		next[tile] = m->first[tile];
	}
	if (m->first && next) {
		m->first[t->tiles] = all;
		m->core = gw_allocate_array(all, sizeof *m->core);
		point = gw_allocate_array(all, sizeof *point);
	}
	m->point = m->core ? point : NULL;
	for (size_t i = 0; m->point && i < part->count; i++)
		enter(t, part->position + 3 * i, (uint32_t)i, m, next);
	free(next);
	if (m->point)
		return GW_OK;
	free(point);
	gw_tile_members_clear(m);
	return gw_fail(error, GW_ERROR_MEMORY, "no memory for the tiles of %zu points", part->count);
}

void gw_tile_members_clear(gw_tile_members *m)
{
	free(m->first);
	free(m->point);
	free(m->core);
	*m = (gw_tile_members){ .first = NULL };
}

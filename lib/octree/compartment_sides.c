/*
 * compartment_sides.c - which compartments surfels look into; see compartments.h.
 *
 * First each surfel by itself: a step along its normal, out of the cells of its own surface, that
 * goes behind no other surface on the way. In creases such steps find nothing, and noise puts
 * single surfels behind their own wall or beyond its edge. In a slit most find nothing either, but
 * where its other side has a hole that points missed, one may look through it into rock: what a
 * surfel finds while most of its sheet find nothing is forgotten. Then labels are propagated: each
 * surfel takes the one that most of those beside it on the same sheet have, and those that have
 * none yet the one of most surfels in front of them. Single points of a spike no thicker than a
 * cell have nobody beside them, and lie behind each other's surface: these look again, past it.
 */
#include "octree/compartments_steps.h"

#include "base/memory.h"
#include "base/parallel.h"
#include "octree/octree_layout.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Leaf cells: how far the step goes at most, and how finely. Surface is up to three cells thick
 * where it lies askew. */
#define STEP_MOST 3.0f
#define STEP 0.5f
#define STEPS 6

/* And of surfels that get no label from neighbours either: amid walls of sparse surface. */
#define STEPS_FAR 32

/* Surfels that have to look into a compartment before it counts as one: noise leaves bubbles amid
 * surface, that few look into. */
#define LOOKING_LEAST 64u

/* Cosine between normals of surfels on one sheet. */
#define ALIKE 0.5f

/* Leaf cells: how far noise may put one of two surfels behind the other that it sees. */
#define BEHIND_MOST 0.25f

/* And how far from its sheet. */
#define SHEET_MOST 1.5f

/* Surfels follow a space-filling curve: others of a sheet are looked for among so many before and
 * after one; so far off it, radii, noise may put these. */
#define ORDER_REACH ((size_t)32)
#define DISC_SHEET 0.5f

/* Leaf cells: radius of a disc from which on none of its sheet is likely within the two cells
 * around, where votes come from. Of eight random points within it the nearest lies at its root of
 * an eighth, 0.35. */
#define ALONE_RADIUS 6.0f

/* Rounds of propagation; after the first ones only surfels without a label take part. */
#define SHEET_ROUNDS 3
#define ROUNDS 7

/* So many surfels of its sheet that look nowhere, for each that finds the same, cast doubt on what
 * one finds. Of six closed caves in which some were astray 2 and 3 leave none and 4 leaves two; at
 * 1 one point is lit of 24 rooms whose walls lie in each other's noise. */
#define LOST_MOST 2u

#define CHUNK 4096u
#define LABELS 6u /* of which one is chosen */

/* Which surfels vote on the label of a place. At first, for surfels, those around them on their
 * sheet, without themselves: where noise puts one beyond the edge of its wall, it looks past the
 * next one. For other places those of their cell that face like them. Where that gives no label,
 * of the cells around as well those that the place sees, or all, if they have one label. */
enum voters { SAME_SHEET, THOSE_ALIKE, THOSE_IN_SIGHT, ALL_NEAR };

typedef struct sight {
	gw_compartments *c;
	const float *position, *normal, *size; /* 4 a surfel */
	const float *plane;                    /* 4 a facet */
	const uint32_t *leaf_tile, *facet_leaf, *leaf_fragment, *fragment_surfel;
	const uint32_t *known; /* 2 a surfel */
	uint32_t *to;          /* likewise */
	uint32_t *leaf_label;  /* 2 a leaf: the label of all its surfels that have one, MANY, or NONE;
							* or NULL */
	enum voters voters;
	size_t leaves, surfels;
	uint32_t threads;
	int steps;        /* along normals */
	bool last_resort; /* surface that a way begins behind does not end it */
} sight;

#define MANY (GW_COMPARTMENT_UNKNOWN - 1u)
#define NONE GW_COMPARTMENT_UNKNOWN

typedef struct views {
	gw_view position, normal, size, plane, leaf_tile, facet_leaf, leaf_fragment, fragment_surfel;
} views;

static float dot(const float a[3], const float b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The leaves of the eight cells of a tile. */
typedef struct octet {
	uint32_t first, tile[2]; /* the first leaf; what leaf_tile says */
} octet;

/* Those of the tile of a cell. */
static octet octet_of(const sight *s, const int32_t cell[3])
{
	for (int k = 0; k < 3; k++)
		if (cell[k] < 0 || cell[k] >= 1 << s->c->depth)
			return (octet){ .first = 0 };
	uint32_t tile = gw_compartment_leaf_tile(s->c, cell);
	if (tile == 0)
		return (octet){ .first = 0 };
	const uint32_t *of = s->leaf_tile + 2 * (tile - 1);
	return (octet){ (uint32_t)gw_facet_leaf(s->facet_leaf[of[0]]), { of[0], of[1] } };
}

static uint32_t octant_of(const int32_t cell[3])
{
	return (uint32_t)((cell[0] & 1) | (cell[1] & 1) << 1 | (cell[2] & 1) << 2);
}

/* Is a cell of it a leaf? */
static bool is_leaf(const octet *o, const int32_t cell[3])
{
	return (o->tile[1] >> octant_of(cell) & 1u) != 0;
}

/* The leaf of a cell of it, or none. */
static uint32_t leaf_in(const octet *o, const int32_t cell[3])
{
	if (!is_leaf(o, cell))
		return GW_WALL;
	uint32_t before = o->tile[1] & ((1u << octant_of(cell)) - 1u);
	return o->first + (uint32_t)__builtin_popcount(before);
}

static uint32_t leaf_of(const sight *s, const int32_t cell[3])
{
	const octet o = octet_of(s, cell);
	return leaf_in(&o, cell);
}

/* Cells beyond the grid are as good as one next to it: strays lie 1e10 cells away. */
#define CELL_LEAST (-2.0f)
#define CELL_MOST ((float)(1u << (GW_DEPTH_MAX + 1)))

static void cell_of(const float place[3], int32_t cell[3])
{
	for (int k = 0; k < 3; k++) {
		float within = place[k] > CELL_LEAST ? place[k] : CELL_LEAST;
		within = within < CELL_MOST ? within : CELL_MOST;
		cell[k] = (int32_t)within - ((float)(int32_t)within > within);
	}
}

/* Moves a cell to that of a place; false: it is there already. */
static bool enter_cell(const float place[3], int32_t cell[3])
{
	int32_t to[3];
	cell_of(place, to);
	if (to[0] == cell[0] && to[1] == cell[1] && to[2] == cell[2])
		return false;
	memcpy(cell, to, sizeof to);
	return true;
}

/* Cosine between normals of the two sides of a wall. */
#define OPPOSITE (-0.7f)

/* Does a step along a normal go behind surface in a cell, other than that which faces the same
 * way? The other side of its own wall it is behind from the beginning. */
static bool goes_behind(const sight *s, const int32_t cell[3], const float normal[3],
						const float from[3], const float to[3])
{
	const octet o = octet_of(s, cell);
	if (!is_leaf(&o, cell))
		return false;
	uint32_t facet = gw_facet_first(o.tile, octant_of(cell));
	uint32_t end = facet + 1 + (o.tile[1] >> (16 + octant_of(cell)) & 1u);
	for (; facet < end; facet++) {
		const float *plane = s->plane + 4 * (size_t)facet;
		float before[3], after[3], facing = dot(plane, normal);
		for (int k = 0; k < 3; k++) {
			before[k] = from[k] - (float)cell[k] - 0.5f;
			after[k] = to[k] - (float)cell[k] - 0.5f;
		}
		bool apart = dot(plane, before) >= plane[3] || (facing > OPPOSITE && !s->last_resort);
		if (dot(plane, plane) > 0.5f && facing < 0.7f && apart && dot(plane, after) < plane[3])
			return true;
	}
	return false;
}

static void step_along(const float from[3], const float way[3], float t, float to[3])
{
	for (int k = 0; k < 3; k++)
		to[k] = from[k] + t * way[k];
}

/* Does a way of so many steps go behind surface? */
static bool passes_behind(const sight *s, const float from[3], const float normal[3], float step,
						  int steps)
{
	float place[3], passed[3];
	int32_t cell[3] = { INT32_MIN };
	step_along(from, normal, step * (float)steps, place);
	for (int i = 0; i < steps; i++) {
		step_along(from, normal, step * (float)i, passed);
		if (enter_cell(passed, cell) && goes_behind(s, cell, normal, from, place))
			return true;
	}
	return false;
}

/* The first empty cell along a normal. */
static uint32_t look_along(const sight *s, const float from[3], const float normal[3], float step)
{
	int32_t cell[3] = { INT32_MIN };
	for (int i = 0; i <= s->steps; i++) {
		float place[3];
		step_along(from, normal, step * (float)i, place);
		uint32_t label =
			enter_cell(place, cell) ? gw_compartment_of_cell(s->c, cell) : GW_COMPARTMENT_UNKNOWN;
		if (label != GW_COMPARTMENT_UNKNOWN)
			return passes_behind(s, from, normal, step, i) ? GW_COMPARTMENT_UNKNOWN : label;
	}
	return GW_COMPARTMENT_UNKNOWN;
}

/* The same for surfels, and for the backs of two-sided ones, but for what is known; steps are as
 * wide as the cells of their walls. */
static void look_some(void *user, size_t first, size_t last, uint32_t worker)
{
	const sight *s = user;
	(void)worker;
	for (size_t i = first; i < last; i++) {
		const float *n = s->normal + 4 * i, back[3] = { -n[0], -n[1], -n[2] };
		float radius = s->size[4 * i];
		float step = STEP * (radius < GW_SPARSE_RADIUS ? 1.0f : exp2f(floorf(log2f(radius))));
		if (s->to[2 * i] == GW_COMPARTMENT_UNKNOWN)
			s->to[2 * i] = look_along(s, s->position + 4 * i, n, step);
		if (n[3] > 0.5f && s->to[2 * i + 1] == GW_COMPARTMENT_UNKNOWN)
			s->to[2 * i + 1] = look_along(s, s->position + 4 * i, back, step);
	}
}

/* Votes for compartments. */
typedef struct votes {
	uint32_t label[LABELS], count[LABELS], used;
} votes;

static void vote(votes *v, uint32_t label, uint32_t times)
{
	uint32_t i = 0;
	if (label == GW_COMPARTMENT_UNKNOWN || times == 0)
		return;
	while (i < v->used && v->label[i] != label)
		i++;
	if (i == LABELS)
		return;
	if (i == v->used) {
		v->label[v->used++] = label;
		v->count[i] = 0;
	}
	v->count[i] += times;
}

static uint32_t winner(const votes *v)
{
	uint32_t best = GW_COMPARTMENT_UNKNOWN, most = 0;
	for (uint32_t i = 0; i < v->used; i++) {
		if (v->count[i] > most || (v->count[i] == most && v->label[i] < best)) {
			best = v->label[i];
			most = v->count[i];
		}
	}
	return best;
}

/* Do two places on surface see each other's front, or belong to the same sheet? */
static bool see_each_other(const float p[3], const float n[3], const float q[3], const float m[3])
{
	const float way[3] = { q[0] - p[0], q[1] - p[1], q[2] - p[2] };
	return dot(n, m) > -ALIKE && dot(way, n) > -BEHIND_MOST && dot(way, m) < BEHIND_MOST;
}

/* Do two places lie on the same sheet of surface, as far as noise lets tell? */
static bool same_sheet(const float p[3], const float n[3], const float q[3], const float m[3])
{
	const float way[3] = { q[0] - p[0], q[1] - p[1], q[2] - p[2] };
	return dot(n, m) > ALIKE && fabsf(dot(way, n)) < SHEET_MOST;
}

/* What surfels vote on. */
typedef struct ballot {
	const float *place, *normal;
	int side;
	bool walls; /* those vote that rise over the place's surface, too */
} ballot;

/* So many votes has a wall: of a sheet nobody knows on which side of it they lie. */
#define WALL_VOTES 4

/* How many votes a surfel beside a place has that is not of its sheet, where several compartments
 * are near: a floor may go on in the next room. Where it rises over the place's surface as a wall
 * does, and the place lies before it, both look into the same compartment. */
static uint32_t vote_of_wall(const float place[3], const float normal[3], const float q[3],
							 const float m[3])
{
	const float way[3] = { q[0] - place[0], q[1] - place[1], q[2] - place[2] };
	float facing = dot(normal, m), before = -dot(way, m);
	if (fabsf(facing) > ALIKE || !(dot(way, normal) > BEHIND_MOST))
		return 0;
	return before > 0.0f ? WALL_VOTES : 0;
}

/* Adds the votes of a leaf's surfels on a place; those of walls apart, where several compartments
 * are near. */
static void add_votes(const sight *s, uint32_t leaf, const ballot *on, votes *v, votes *walls)
{
	const float *place = on->place, *normal = on->normal;
	for (uint32_t f = s->leaf_fragment[leaf]; f < s->leaf_fragment[leaf + 1]; f++) {
		uint32_t j = s->fragment_surfel[f] & GW_FRAGMENT_SURFEL;
		uint32_t label = s->known[2 * (size_t)j + (size_t)on->side];
		if (label == GW_COMPARTMENT_UNKNOWN)
			continue;
		const float *q = s->position + 4 * (size_t)j, *m = s->normal + 4 * (size_t)j;
		bool is_voter = s->voters == THOSE_ALIKE  ? dot(normal, m) > ALIKE
						: s->voters == SAME_SHEET ? q != place && same_sheet(place, normal, q, m)
						: s->voters == THOSE_IN_SIGHT
							? on->side == 0 && see_each_other(place, normal, q, m)
							: on->side == 0;
		if (is_voter)
			vote(v, label, 1);
		else if (on->walls)
			vote(walls, label, vote_of_wall(place, normal, q, m));
	}
}

static uint32_t label_with(uint32_t label, uint32_t other)
{
	return other == NONE || label == other ? label : label == NONE ? other : MANY;
}

/* The eight tiles that the 27 cells around a place are of, and the label of all their surfels
 * together, as leaf_label of sight. Places beside each other have them in common. */
typedef struct tiles_around {
	bool known;
	int32_t low[3]; /* the tile with the least coordinates */
	octet of[8];
	uint32_t label;
} tiles_around;

static void find_tiles_around(const sight *s, const int32_t cell[3], int side, tiles_around *a)
{
	const int32_t low[3] = { (cell[0] - 1) >> 1, (cell[1] - 1) >> 1, (cell[2] - 1) >> 1 };
	if (a->known && memcmp(a->low, low, sizeof low) == 0)
		return;
	a->known = true;
	memcpy(a->low, low, sizeof low);
	a->label = s->leaf_label ? NONE : MANY;
	for (int32_t t = 0; t < 8; t++) {
		const int32_t at[3] = { 2 * low[0] + 2 * (t & 1), 2 * low[1] + (t & 2),
								2 * low[2] + (t >> 1 & 2) };
		const octet of = a->of[t] = octet_of(s, at);
		uint32_t leaves = (uint32_t)__builtin_popcount(of.tile[1] & 0xffu);
		for (uint32_t i = 0; s->leaf_label && i < leaves; i++)
			a->label =
				label_with(a->label, s->leaf_label[2 * (size_t)(of.first + i) + (size_t)side]);
	}
}

/* The leaves around a place whose surfels have labels, and the label of all of them together. */
typedef struct neighbourhood {
	uint32_t leaf[27], leaves, label;
} neighbourhood;

static void add_leaf(const sight *s, uint32_t leaf, int side, neighbourhood *n)
{
	uint32_t own = MANY;
	if (leaf == GW_WALL)
		return;
	if (s->leaf_label)
		own = s->leaf_label[2 * (size_t)leaf + (size_t)side];
	if (own == NONE)
		return;
	n->label = label_with(n->label, own);
	n->leaf[n->leaves++] = leaf;
}

/* Of a cell, or of those around it as well, of which tiles are given. */
static void find_neighbourhood(const sight *s, const int32_t cell[3], int side,
							   const tiles_around *around, neighbourhood *n)
{
	n->label = s->leaf_label ? NONE : MANY;
	n->leaves = 0;
	if (s->voters == THOSE_ALIKE) {
		add_leaf(s, leaf_of(s, cell), side, n);
		return;
	}
	for (int32_t i = 0; i < 27; i++) {
		const int32_t near[3] = { cell[0] - 1 + i % 3, cell[1] - 1 + i / 3 % 3,
								  cell[2] - 1 + i / 9 };
		int32_t tile = ((near[0] >> 1) - around->low[0]) | ((near[1] >> 1) - around->low[1]) << 1 |
					   ((near[2] >> 1) - around->low[2]) << 2;
		add_leaf(s, leaf_in(&around->of[tile], near), side, n);
	}
}

/* The label that a neighbourhood votes for. Where all of it has one label, the first vote decides.
 * Walls vote where surfels of the place's sheet disagree: those that agree know better than walls
 * whose two sides lie in each other's noise. */
static uint32_t vote_on(const sight *s, const neighbourhood *near, const float place[3],
						const float normal[3], int side)
{
	bool mixed = near->label == MANY;
	const ballot on = { place, normal, side, mixed && side == 0 && s->voters == SAME_SHEET };
	votes v = { .used = 0 }, walls = { .used = 0 };
	for (uint32_t i = 0; i < near->leaves && (mixed || v.used == 0); i++)
		add_votes(s, near->leaf[i], &on, &v, &walls);
	for (uint32_t i = 0; i < walls.used && v.used != 1; i++)
		vote(&v, walls.label[i], walls.count[i]);
	return s->voters == ALL_NEAR && v.used > 1 ? GW_COMPARTMENT_UNKNOWN : winner(&v);
}

/* Fills leaf_label. */
static void label_leaves(void *user, size_t first, size_t last, uint32_t worker)
{
	const sight *s = user;
	(void)worker;
	for (size_t leaf = first; leaf < last; leaf++) {
		uint32_t common[2] = { NONE, NONE };
		for (uint32_t f = s->leaf_fragment[leaf]; f < s->leaf_fragment[leaf + 1]; f++) {
			const uint32_t *label =
				s->known + 2 * (size_t)(s->fragment_surfel[f] & GW_FRAGMENT_SURFEL);
			for (int side = 0; side < 2; side++)
				if (label[side] != GW_COMPARTMENT_UNKNOWN)
					common[side] =
						common[side] == NONE || common[side] == label[side] ? label[side] : MANY;
		}
		memcpy(s->leaf_label + 2 * leaf, common, sizeof common);
	}
}

/* The next label of a side of a surfel; of backs only by their sheet. */
static uint32_t next_label(const sight *s, size_t surfel, int side, tiles_around *around)
{
	const float *place = s->position + 4 * surfel, *normal = s->normal + 4 * surfel;
	uint32_t own = s->known[2 * surfel + (size_t)side];
	if ((s->voters != SAME_SHEET && (own != GW_COMPARTMENT_UNKNOWN || side != 0)) ||
		(side != 0 && !(normal[3] > 0.5f)))
		return own;
	neighbourhood near;
	int32_t cell[3];
	cell_of(place, cell);
	find_tiles_around(s, cell, side, around);
	if (around->label == NONE || around->label == own)
		return own;
	find_neighbourhood(s, cell, side, around, &near);
	if (near.label == NONE || near.label == own)
		return own;
	uint32_t label = vote_on(s, &near, place, normal, side);
	return label == GW_COMPARTMENT_UNKNOWN ? own : label;
}

static void vote_some(void *user, size_t first, size_t last, uint32_t worker)
{
	const sight *s = user;
	tiles_around around[2] = { { .known = false }, { .known = false } };
	(void)worker;
	for (size_t i = first; i < last; i++)
		for (int side = 0; side < 2; side++)
			s->to[2 * i + (size_t)side] = next_label(s, i, side, &around[side]);
}

/* Of the surfels on the sheet of one, how many look into the same compartment, and how many into
 * none that is known. */
typedef struct mates {
	uint32_t same, unknown;
} mates;

/* Adds a leaf's; who has its disc in several leaves counts in each. */
static void add_mates(const sight *s, uint32_t leaf, size_t surfel, int side, mates *m)
{
	const float *p = s->position + 4 * surfel, *n = s->normal + 4 * surfel;
	for (uint32_t f = s->leaf_fragment[leaf]; f < s->leaf_fragment[leaf + 1]; f++) {
		size_t j = s->fragment_surfel[f] & GW_FRAGMENT_SURFEL;
		uint32_t label = s->known[2 * j + (size_t)side];
		if (j == surfel || !same_sheet(p, n, s->position + 4 * j, s->normal + 4 * j))
			continue;
		m->same += label == s->known[2 * surfel + (size_t)side];
		m->unknown += label == GW_COMPARTMENT_UNKNOWN;
	}
}

/* Do most surfels of a sheet look nowhere around one that does not? It may look across a slit and
 * through a hole that points missed in its other side, into rock. Where all in its cell agree it is
 * not asked any further. */
static bool is_doubtful(const sight *s, size_t surfel, int side)
{
	int32_t cell[3];
	mates m = { 0, 0 };
	cell_of(s->position + 4 * surfel, cell);
	for (int32_t i = 0; i < 27 && (i == 0 || m.same == 0 || m.unknown > 0); i++) {
		const int32_t k = (i + 13) % 27; /* its own cell first */
		const int32_t near[3] = { cell[0] - 1 + k % 3, cell[1] - 1 + k / 3 % 3,
								  cell[2] - 1 + k / 9 };
		uint32_t leaf = leaf_of(s, near);
		if (leaf != GW_WALL)
			add_mates(s, leaf, surfel, side, &m);
	}
	return m.unknown > LOST_MOST * m.same;
}

static void doubt_some(void *user, size_t first, size_t last, uint32_t worker)
{
	const sight *s = user;
	(void)worker;
	for (size_t i = 2 * first; i < 2 * last; i++)
		s->to[i] = s->known[i] != GW_COMPARTMENT_UNKNOWN && is_doubtful(s, i / 2, (int)(i % 2))
					   ? GW_COMPARTMENT_UNKNOWN
					   : s->known[i];
}

/* Forgets what is doubtful of what surfels look into. */
static void doubt_looks(sight *s, uint32_t *sides, uint32_t *other)
{
	s->known = sides;
	s->to = other;
	gw_parallel_for(s->threads, s->surfels, CHUNK, doubt_some, s);
	memcpy(sides, other, 2 * s->surfels * sizeof *sides);
}

/* Forgets bubbles: compartments that few look into, but for what lies around the scene. */
static void forget_bubbles(gw_compartments *c, const uint32_t *looking, uint32_t *sides,
						   size_t surfels)
{
	uint32_t outside = c->label[c->cells];
	for (size_t i = 0; i < 2 * surfels; i++)
		if (sides[i] != GW_COMPARTMENT_UNKNOWN && sides[i] != outside &&
			looking[sides[i]] < LOOKING_LEAST)
			sides[i] = GW_COMPARTMENT_UNKNOWN;
	for (uint32_t i = 0; i < c->cells; i++)
		if (c->label[i] != outside && looking[c->label[i]] > 0 &&
			looking[c->label[i]] < LOOKING_LEAST)
			c->label[i] = GW_COMPARTMENT_UNKNOWN;
}

/* How many compartments enough fronts look into, with what lies around the scene. */
static gw_status count_those_that_matter(gw_compartments *c, uint32_t *sides, size_t surfels,
										 uint32_t *several, gw_error *error)
{
	uint32_t *looking = gw_allocate_zeros((size_t)c->cells + 1, sizeof *looking);
	*several = 1;
	if (looking == NULL)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %u compartments", c->cells);
	for (size_t i = 0; i < surfels; i++)
		if (sides[2 * i] != GW_COMPARTMENT_UNKNOWN && sides[2 * i] != c->label[c->cells])
			*several += ++looking[sides[2 * i]] == LOOKING_LEAST;
	if (*several > 1)
		forget_bubbles(c, looking, sides, surfels);
	free(looking);
	return GW_OK;
}

/* Which surfels vote in a round. */
static enum voters voters_in(int round)
{
	return round < SHEET_ROUNDS ? SAME_SHEET : round < ROUNDS - 1 ? THOSE_IN_SIGHT : ALL_NEAR;
}

/* A round of votes. `sides` and `other` take turns; false: it changed nothing. */
static bool vote_once(sight *s, enum voters voters, uint32_t *sides, uint32_t *other)
{
	size_t bytes = 2 * s->surfels * sizeof *sides;
	s->known = sides;
	s->to = other;
	s->voters = voters;
	gw_parallel_for(s->threads, s->surfels, CHUNK, vote_some, s);
	bool changed = memcmp(sides, other, bytes) != 0;
	memcpy(sides, other, bytes);
	return changed;
}

/* Propagates labels. Where a round changes none of them, another round of the same votes changes
 * none either. The label of a leaf is worth finding while all surfels take part. */
static void propagate_labels(sight *s, uint32_t *sides, uint32_t *other)
{
	bool settled = false; /* with the voters of the last round */
	for (int round = 0; round < ROUNDS; round++) {
		if (settled && s->voters == voters_in(round))
			continue;
		s->known = sides;
		if (voters_in(round) == SAME_SHEET)
			gw_parallel_for(s->threads, s->leaves, CHUNK, label_leaves, s);
		else
			s->leaf_label = NULL;
		settled = !vote_once(s, voters_in(round), sides, other);
	}
}

static bool is_sparse(const sight *s, size_t surfel)
{
	return surfel < s->surfels && s->size[4 * surfel] >= ALONE_RADIUS;
}

/* Does a surfel lie on the sheet of another one, within the reach of the larger one's disc, if that
 * is of sparse surface? Beside an edge a disc may be much smaller than those around it. */
static bool is_of_disc(const sight *s, size_t surfel, size_t other)
{
	const float *p = s->position + 4 * surfel, *n = s->normal + 4 * surfel;
	const float *q = s->position + 4 * other;
	const float radius = fmaxf(s->size[4 * surfel], s->size[4 * other]);
	const float way[3] = { q[0] - p[0], q[1] - p[1], q[2] - p[2] };
	return radius >= ALONE_RADIUS && dot(n, s->normal + 4 * other) > ALIKE &&
		   dot(way, way) < 4.0f * radius * radius && fabsf(dot(way, n)) < DISC_SHEET * radius;
}

/* The label of most of those on a surfel's sheet; its own if it has one and is not alone with it.
 */
static uint32_t label_in_order(const sight *s, size_t surfel)
{
	uint32_t own = s->known[2 * surfel];
	votes v = { .used = 0 };
	size_t first = surfel > ORDER_REACH ? surfel - ORDER_REACH : 0;
	size_t last = s->surfels - surfel > ORDER_REACH ? surfel + ORDER_REACH : s->surfels;
	for (size_t j = first; j < last; j++) {
		if (j == surfel || s->known[2 * j] == GW_COMPARTMENT_UNKNOWN || !is_of_disc(s, surfel, j))
			continue;
		if (s->known[2 * j] == own)
			return own;
		vote(&v, s->known[2 * j], 1);
	}
	return v.used > 0 ? winner(&v) : own;
}

static void vote_in_order(void *user, size_t first, size_t last, uint32_t worker)
{
	const sight *s = user;
	(void)worker;
	for (size_t i = first; i < last; i++) {
		s->to[2 * i] = s->known[2 * i];
		s->to[2 * i + 1] = s->known[2 * i + 1];
		if (is_sparse(s, i) || is_sparse(s, i + 1) || (i > 0 && is_sparse(s, i - 1)))
			s->to[2 * i] = label_in_order(s, i);
	}
}

/* Surfels amid sparse ones, whose sheet is not in the cells around them, get its label if they have
 * none, or one that nobody of it has. */
static void ask_in_order(sight *s, uint32_t *sides, uint32_t *other)
{
	s->known = sides;
	s->to = other;
	gw_parallel_for(s->threads, s->surfels, CHUNK, vote_in_order, s);
	memcpy(sides, other, 2 * s->surfels * sizeof *sides);
}

/* What no votes gave a label looks further, and then past surface that it begins behind; what has
 * none even then takes that of all around. */
static void look_further(sight *s, uint32_t *sides, uint32_t *other)
{
	s->steps = STEPS_FAR;
	for (int i = 0; i < 2; i++) {
		s->to = sides;
		s->last_resort = i == 1;
		gw_parallel_for(s->threads, s->surfels, CHUNK, look_some, s);
	}
	vote_once(s, ALL_NEAR, sides, other);
}

/* All of it with what the octree holds at hand. `sides` and `other` take turns. */
static gw_status find(sight *s, uint32_t *sides, uint32_t *other, uint32_t *several,
					  gw_error *error)
{
	memset(sides, 0xff, 2 * s->surfels * sizeof *sides);
	s->to = sides;
	gw_parallel_for(s->threads, s->surfels, CHUNK, look_some, s);
	GW_TRY(count_those_that_matter(s->c, sides, s->surfels, several, error));
	if (*several < 2)
		return GW_OK;
	gw_parallel_for(s->threads, s->surfels, CHUNK, look_some, s); /* Through the bubbles. */
	doubt_looks(s, sides, other);
	propagate_labels(s, sides, other);
	ask_in_order(s, sides, other);
	look_further(s, sides, other);
	return GW_OK;
}

static gw_status open_views(gw_gpu *gpu, const gw_octree *o, views *v, gw_error *error)
{
	const struct {
		const gw_buffer *buffer;
		uint64_t bytes;
		gw_view *view;
	} rows[] = {
		{ &o->surfel_position, o->surfel_position.bytes, &v->position },
		{ &o->surfel_normal, o->surfel_normal.bytes, &v->normal },
		{ &o->surfel_disc, o->surfel_disc.bytes, &v->size },
		{ &o->facet_plane, 16 * (uint64_t)o->facet_count, &v->plane },
		{ &o->leaf_tile, 8 * (uint64_t)o->leaf_tile_count, &v->leaf_tile },
		{ &o->facet_leaf, 4 * (uint64_t)o->facet_count, &v->facet_leaf },
		{ &o->leaf_fragment, 4 * ((uint64_t)o->leaf_count + 1), &v->leaf_fragment },
		{ &o->fragment_surfel, 4 * (uint64_t)o->fragment_count, &v->fragment_surfel },
	};
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
		GW_TRY(gw_view_open(gpu, rows[i].buffer, rows[i].bytes, rows[i].view, error));
	return GW_OK;
}

void gw_compartments_drop_rest(gw_gpu *gpu, gw_octree *o)
{
	gw_buffer *const rest[] = { &o->node,          &o->tile_key,        &o->tile_neighbour,
								&o->leaf_tile_key, &o->leaf_cell,       &o->leaf_tile_neighbour,
								&o->ray_directory, &o->level_directory, &o->facet_centre,
								&o->leaf_geometry, &o->facet_albedo,    &o->facet_emission,
								&o->surfel_clip,   &o->fragment_weight, &o->disc_tree };
	gw_buffer *const of_views[] = { &o->surfel_position, &o->surfel_normal,  &o->surfel_disc,
									&o->facet_plane,     &o->leaf_tile,      &o->facet_leaf,
									&o->leaf_fragment,   &o->fragment_surfel };
	for (size_t i = 0; i < sizeof rest / sizeof *rest; i++)
		gw_buffer_destroy(gpu, rest[i]);
	for (size_t i = 0; i < sizeof of_views / sizeof *of_views && !gw_compartments_several(o); i++)
		gw_buffer_destroy(gpu, of_views[i]);
}

static void close_views(views *v)
{
	gw_view *const all[] = {
		&v->position,  &v->normal,     &v->size,          &v->plane,
		&v->leaf_tile, &v->facet_leaf, &v->leaf_fragment, &v->fragment_surfel
	};
	for (size_t i = 0; i < sizeof all / sizeof *all; i++)
		gw_view_close(all[i]);
}

static sight sight_of(gw_compartments *c, const gw_octree *octree, const views *v)
{
	return (sight){ .c = c,
					.leaves = octree->leaf_count,
					.position = v->position.bytes,
					.normal = v->normal.bytes,
					.size = v->size.bytes,
					.plane = v->plane.bytes,
					.leaf_tile = v->leaf_tile.bytes,
					.facet_leaf = v->facet_leaf.bytes,
					.leaf_fragment = v->leaf_fragment.bytes,
					.fragment_surfel = v->fragment_surfel.bytes,
					.steps = STEPS };
}

gw_status gw_compartments_find_sides(gw_gpu *gpu, const gw_octree *octree, size_t surfels,
									 uint32_t threads, gw_compartments *c, gw_error *error)
{
	views v = { 0 };
	uint32_t several = 0, *other = gw_allocate_array(surfels, 2 * sizeof *other);
	uint32_t *leaf_label =
		gw_allocate_array((size_t)octree->leaf_count + 1, 2 * sizeof *leaf_label);
	c->sides = gw_allocate_array(surfels, 2 * sizeof *c->sides);
	gw_status status =
		other && leaf_label && c->sides
			? open_views(gpu, octree, &v, error)
			: gw_fail(error, GW_ERROR_MEMORY, "no memory for the sides of %zu surfels", surfels);
	if (status == GW_OK) {
		sight s = sight_of(c, octree, &v);
		s.leaf_label = leaf_label;
		s.surfels = surfels;
		s.threads = threads;
		status = find(&s, c->sides, other, &several, error);
	}
	close_views(&v);
	free(leaf_label);
	free(other);
	if (status != GW_OK || several < 2) {
		free(c->sides);
		c->sides = NULL;
	}
	return status;
}

/* Places whose compartments are looked for. */
typedef struct place_search {
	sight sight;
	const gw_octree *octree;
	const gw_surface_places *of;
	uint32_t *label;
} place_search;

static void label_places(void *user, size_t first, size_t last, uint32_t worker)
{
	const place_search *p = user;
	sight s = p->sight;
	tiles_around around = { .known = false };
	(void)worker;
	for (size_t i = first; i < last; i++) {
		float place[3];
		int32_t cell[3];
		const float *normal = p->of->normal + 4 * i;
		gw_compartments_place(p->octree, p->of->place + 4 * i, place);
		cell_of(place, cell);
		uint32_t label = GW_COMPARTMENT_UNKNOWN;
		for (int a = THOSE_ALIKE; a <= ALL_NEAR && label == GW_COMPARTMENT_UNKNOWN; a++) {
			s.voters = (enum voters)a;
			neighbourhood near;
			if (a != THOSE_ALIKE)
				find_tiles_around(&s, cell, 0, &around);
			find_neighbourhood(&s, cell, 0, &around, &near);
			label = vote_on(&s, &near, place, normal, 0);
		}
		p->label[i] = label;
	}
}

gw_status gw_compartments_of_places(const gw_passes *passes, const gw_octree *octree,
									const gw_surface_places *of, uint32_t *label, gw_error *error)
{
	views v = { 0 };
	const gw_octree *has = gw_compartments_octree(octree);
	gw_status status = open_views(passes->gpu, has, &v, error);
	if (status == GW_OK) {
		place_search search = { sight_of(has->compartments, has, &v), octree, of, label };
		search.sight.known = has->compartments->sides;
		gw_parallel_for(passes->threads, of->count, CHUNK, label_places, &search);
	}
	close_views(&v);
	return status;
}

gw_status gw_compartments_label_facets(gw_gpu *gpu, gw_octree *octree, gw_error *error)
{
	views v = { 0 };
	uint32_t *label = gw_allocate_array(octree->facet_count, sizeof *label);
	if (label == NULL)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the compartments of %u facets",
					   octree->facet_count);
	gw_status status = open_views(gpu, octree, &v, error);
	const uint32_t *first = v.leaf_fragment.bytes, *fragment = v.fragment_surfel.bytes;
	const uint32_t *leaf_of_facet = v.facet_leaf.bytes;
	const float *normal = v.normal.bytes;
	label[GW_FACET_EMPTY] = GW_COMPARTMENT_UNKNOWN;
	for (size_t i = GW_FACET_EMPTY + 1; i < octree->facet_count && status == GW_OK; i++) {
		size_t leaf = gw_facet_leaf(leaf_of_facet[i]);
		votes of = { .used = 0 };
		for (uint32_t f = first[leaf]; f < first[leaf + 1]; f++) {
			size_t surfel = fragment[f] & GW_FRAGMENT_SURFEL;
			if (gw_facet_holds(leaf_of_facet[i], fragment[f]) && !(normal[4 * surfel + 3] > 0.5f))
				vote(&of, gw_compartment_of_surfel(octree, surfel, false), 1);
		}
		label[i] = winner(&of);
	}
	close_views(&v);
	if (status != GW_OK)
		free(label);
	else
		octree->facet_compartment = label;
	return status;
}

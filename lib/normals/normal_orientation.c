/* normal_orientation.c - see normal_orientation.h. */
#include "normals/normal_orientation.h"

#include "base/memory.h"
#include "base/nth_element.h"
#include "base/up_axis.h"
#include "cloud/frame.h"
#include "normals/patch_borders.h"
#include "normals/patch_signs.h"
#include "normals/seen_from_above.h"
#include "normals/shells.h"
#include "normals/side_light.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The agreement from which on a pair is smooth surface. Pairs are taken in steps, the surest first.
 */
#define SMOOTH 102
#define SMOOTH_STEP 8

/* A patch has at most so many surfels, and there are some so many patches. */
#define PATCH_LEAST 48
#define PATCHES 2000

/* Of the rays from a side that is in the open so many meet surface at most. */
#define OPEN_SIDE 0.9
/* A surfel's light from one side alone weighs as much as so many pairs of surfels that agree. */
#define LIGHT_WEIGHT 0.5
/* One that a scanner sees from one side: more, since no light is so sure, but less than a normal,
 * since discs let some ways through and stop others. Of simulated scans, four times as much turns
 * as many points to the right side. */
#define SEEN_WEIGHT 2.0
/* And a normal that was given. */
#define GIVEN_WEIGHT 8.0

/* Scanners tell the side of what they see for this share more from there than from behind. */
#define SEEN_LEAST 0.1

/* A patch is sure of its front to some degree where this many times the light of the back falls on
 * it, and wholly from so many times on. */
#define SURE_LEAST 4.0
#define SURE 30.0

/* A side counts as the front where this many times the light of the other falls on it. */
#define CLEAR 2.0

/* What a sky chooses as the front of something open holds while one part in so many of the light
 * that there is falls straight on it: as much gets into a cave by its mouth. */
#define REACHED 500.0

/* A side is closed where so many of its rays meet surface, and of those that go down. */
#define CLOSED 0.95

/* Somebody may have stood within so much surface, m^2, and distances across rooms and caves are
 * below ROOM_MOST metres, as a rule: larger models are things in other units. */
#define ROOM_AREA 8.0
#define ROOM_MOST 50.0

/* A point far from all others stands for no more than this many times what most do. */
#define AREA_MOST 16.0f

/* A lamp is what emits on at least this share of its area. */
#define LAMP_SHARE 0.5

/* A surfel is smooth where the pairs with its neighbours agree so much on average. What was seen
 * from above shows no smooth underside: of what is smooth in airborne scans less than one part in
 * a hundred faces down as light alone has it, of things and rooms that are as wide a tenth or more.
 */
#define UNDERSIDE_SMOOTH 0.9
#define UNDERSIDES_MOST 0.03
/* Normals that rise or fall by less than that are of walls, which do not face up. */
#define LEVEL 0.3

/* What is known of patches that hang together, with the signs that they have. */
typedef struct patch_group {
	gw_side_light light;
	double factor[2]; /* of its sides: gw_side_factor */
	double given;     /* normals that were given, for the sign less those against it */
	double area;      /* m^2, of all surfels */
	double emitting;  /* of that, what emits */
	bool doubtful;
	bool holds; /* others lie within it, on its front's side */
} patch_group;

/* Fronts of patches, chosen by some light; patch_count each. */
typedef struct choice {
	gw_side_light *light;
	int8_t *sign;
	bool *disputed; /* another way to choose says otherwise */
	patch_group *groups;
} choice;

typedef struct orientation_work {
	const gw_surfels_options *options;
	gw_surfels *surfels;
	uint32_t *near;              /* GW_NEIGHBOURS * count; the surfel itself where there is none */
	int8_t *agreement;           /* GW_NEIGHBOURS * count, in 1 / GW_AGREED */
	float *area;                 /* count, m^2, rough */
	uint32_t *parent;            /* count: of the trees of patches */
	uint32_t *size;              /* count: of a root's tree */
	uint8_t *opposite;           /* count: sign against that of the parent, then of the patch */
	uint32_t *patch;             /* count: number of a surfel's patch */
	gw_patch_border *borders[2]; /* border_count, NULL until they are asked for: as pairs say, and
									with what they say at creases made more like the rest */
	size_t border_count[2];
	size_t patch_count;
	gw_side_sight *sights; /* what rays from patches meet */
	size_t sight_count;
	choice now;               /* by the lamps, the sun and the sky that there are */
	choice by_sky;            /* the same if a sky shone alone */
	const gw_side_light *sky; /* patch_count: light of a sky alone, of now or by_sky */
	double *given;    /* patch_count: normals that were given, for its sign less those against it */
	double *own;      /* patch_count: what a patch says by itself */
	int8_t *other;    /* patch_count: another choice of signs */
	int8_t *by_angle; /* patch_count: that if creases say the less the sharper they are */
	bool from_above;  /* all of it was seen from above: it has its front up */
	double *ratio;    /* patch_count: of the group of that number, in the other choice */
	uint32_t *group;  /* patch_count */
} orientation_work;

/* ------------------------------------------------------------------------------------ agreement */

/*
 * Whether two normals show the same side, in [-1, 1]: one of them reflected as the surface turns
 * from one place to the other, against the other. Surface that lies across the normals rather than
 * along says nothing: it may be another sheet, or noise.
 */
static float agree(const float *p, const float *n, const float *q, const float *m)
{
	float d[3], length = 0, a = 0, b = 0, cosine = 0;
	for (int k = 0; k < 3; k++) {
		d[k] = q[k] - p[k];
		length += d[k] * d[k];
		a += n[k] * d[k];
		b += m[k] * d[k];
		cosine += n[k] * m[k];
	}
	if (!(length > 0))
		return 0;
	float across = fmaxf(a * a, b * b) / length;
	return (cosine - 2 * a * b / length) * fmaxf(1 - across, 0);
}

/* What a pair says, in 1 / GW_AGREED. Of a lamp's side it says nothing but where the lamp is a part
 * of smooth surface, as a screen is: one that hangs below a ceiling is no side of a plate. */
static int8_t pair_says(const gw_surfels *s, size_t surfel, size_t other)
{
	float both = agree(s->position + 3 * surfel, s->normal + 3 * surfel, s->position + 3 * other,
					   s->normal + 3 * other);
	long says = lrintf(GW_AGREED * fminf(fmaxf(both, -1), 1));
	return labs(says) < SMOOTH && gw_surfel_emits(s, surfel) != gw_surfel_emits(s, other)
			   ? 0
			   : (int8_t)says;
}

static void find_pairs(void *user, size_t surfel, const gw_neighbour_list *list)
{
	orientation_work *w = user;
	for (uint32_t j = 0; j < GW_NEIGHBOURS; j++) {
		size_t other = j < list->count ? list->index[j] : surfel, at = GW_NEIGHBOURS * surfel + j;
		w->near[at] = (uint32_t)other;
		w->agreement[at] = pair_says(w->surfels, surfel, other);
	}
	/* The circle to the last neighbour holds them all, if they lie on one surface. */
	float reach = list->count ? list->distance[list->count - 1] : 0;
	w->area[surfel] = 3.14159265f * reach * reach / (float)(list->count + 1);
}

/* -------------------------------------------------------------------------------------- patches */

/* The root of a surfel's tree; its sign against the root's goes to *opposite. Paths get short. */
static uint32_t find_root(orientation_work *w, uint32_t surfel, uint8_t *opposite)
{
	uint32_t root = surfel;
	uint8_t sign = 0;
	for (; w->parent[root] != root; root = w->parent[root])
		sign ^= w->opposite[root];
	*opposite = sign;
	while (w->parent[surfel] != root && surfel != root) {
		uint32_t next = w->parent[surfel];
		uint8_t own = w->opposite[surfel];
		w->parent[surfel] = root;
		w->opposite[surfel] = sign;
		sign ^= own;
		surfel = next;
	}
	return root;
}

/* Joins the trees of two surfels, whose signs are opposite or not, if that is not too large. */
static void join(orientation_work *w, uint32_t a, uint32_t b, bool opposite)
{
	size_t most = w->surfels->count / PATCHES;
	uint8_t of_a, of_b;
	uint32_t root_a = find_root(w, a, &of_a), root_b = find_root(w, b, &of_b);
	if (root_a == root_b ||
		w->size[root_a] + w->size[root_b] > (most > PATCH_LEAST ? most : PATCH_LEAST))
		return;
	uint32_t low = root_a < root_b ? root_a : root_b, high = root_a < root_b ? root_b : root_a;
	w->parent[high] = low;
	w->size[low] += w->size[high];
	w->opposite[high] = of_a ^ of_b ^ (uint8_t)opposite;
}

static void join_smooth(orientation_work *w)
{
	size_t pairs = GW_NEIGHBOURS * w->surfels->count;
	for (int least = GW_AGREED - SMOOTH_STEP; least >= SMOOTH; least -= SMOOTH_STEP)
		for (size_t i = 0; i < pairs; i++)
			if (abs(w->agreement[i]) >= least && abs(w->agreement[i]) < least + SMOOTH_STEP + 1)
				join(w, (uint32_t)(i / GW_NEIGHBOURS), w->near[i], w->agreement[i] < 0);
}

static void number_patches(orientation_work *w)
{
	size_t count = w->surfels->count;
	uint8_t opposite;
	for (uint32_t i = 0; i < count; i++)
		if (find_root(w, i, &opposite) == i)
			w->patch[i] = (uint32_t)w->patch_count++;
	for (uint32_t i = 0; i < count; i++) {
		w->patch[i] = w->patch[find_root(w, i, &opposite)];
		w->opposite[i] = opposite;
	}
}

/* -------------------------------------------------------------------------------------- borders */

static gw_status find_borders(orientation_work *w, bool alike, gw_error *error)
{
	const gw_patch_pairs pairs = { .count = w->surfels->count,
								   .near = w->near,
								   .agreement = w->agreement,
								   .patch = w->patch,
								   .opposite = w->opposite,
								   .alike = alike };
	if (w->borders[alike] || gw_patch_borders_find(&pairs, w->options->threads, &w->borders[alike],
												   &w->border_count[alike]))
		return GW_OK;
	return gw_fail(error, GW_ERROR_MEMORY, "no memory for the borders of %zu patches",
				   w->patch_count);
}

/* ------------------------------------------------------------------------------------- evidence */

static void limit_areas(orientation_work *w)
{
	size_t count = w->surfels->count;
	float most = AREA_MOST * gw_nth_element(w->area, count, count / 2);
	for (size_t i = 0; i < count; i++)
		w->area[i] = fminf(w->area[i], most);
}

/* by_sky: receives the light of a sky, or NULL where nobody asks for it. */
static gw_status find_light(orientation_work *w, const gw_known_sides *known, gw_side_light *by_sky,
							gw_error *error)
{
	gw_patches patches = { .patch_of = w->patch,
						   .opposite = w->opposite,
						   .area = w->area,
						   .count = w->patch_count,
						   .scanner = known->scanner,
						   .scanner_count = known->scanner_count };
	limit_areas(w);
	for (size_t i = 0; i < w->surfels->count; i++)
		w->given[w->patch[i]] += known->estimated[i] ? 0 : w->opposite[i] ? -1 : 1;
	gw_side_lights found = { .light = w->now.light, .by_sky = by_sky };
	gw_status status = gw_side_light_find(w->options, w->surfels, &patches, &found, error);
	w->sights = found.sights;
	w->sight_count = found.sight_count;
	return status;
}

static bool allocate_choice(choice *c, size_t count)
{
	c->light = gw_allocate_zeros(count, sizeof *c->light);
	c->sign = gw_allocate_array(count, sizeof *c->sign);
	c->disputed = gw_allocate_zeros(count, sizeof *c->disputed);
	c->groups = gw_allocate_zeros(count, sizeof *c->groups);
	return c->light && c->sign && c->disputed && c->groups;
}

static void free_choice(choice *c)
{
	free(c->light);
	free(c->sign);
	free(c->disputed);
	free(c->groups);
}

static bool allocate_patches(orientation_work *w)
{
	size_t count = w->patch_count;
	w->given = gw_allocate_zeros(count, sizeof *w->given);
	w->own = gw_allocate_zeros(count, sizeof *w->own);
	w->other = gw_allocate_array(count, sizeof *w->other);
	w->by_angle = gw_allocate_array(count, sizeof *w->by_angle);
	w->ratio = gw_allocate_array(count, sizeof *w->ratio);
	w->group = gw_allocate_array(count, sizeof *w->group);
	return allocate_choice(&w->now, count) && allocate_choice(&w->by_sky, count) && w->given &&
		   w->own && w->other && w->by_angle && w->ratio && w->group;
}

/* ------------------------------------------------------------------------------------- decision */

static void add_view(const gw_side_view *more, gw_side_view *sum)
{
	sum->light += more->light;
	sum->first += more->first;
	sum->shone += more->shone;
	sum->lit += more->lit;
	sum->seen += more->seen;
	sum->area += more->area;
	sum->met += more->met;
	sum->path += more->path;
	sum->dark_path += more->dark_path;
	sum->down += more->down;
	sum->down_met += more->down_met;
}

/* The light of a patch, with its group's factors, on its front or back by its sign. */
static double patch_light(const orientation_work *w, size_t patch, int side)
{
	int own = w->now.sign[patch] > 0 ? side : 1 - side;
	return w->now.light[patch].side[own].light * w->now.groups[w->group[patch]].factor[side];
}

/* By how much the front of a group is the brighter side. */
static double light_ratio(const patch_group *g)
{
	const gw_side_view *side = g->light.side;
	double back = side[1].light * g->factor[1];
	return side[0].light * g->factor[0] / fmax(back, 1e-30);
}

/* 1 where normals that were given or else scanners tell that a group's front is its front, -1 where
 * that it is its back, and 0 where neither tells. */
static int known_side(const patch_group *g)
{
	const gw_side_view *side = g->light.side;
	double seen = side[0].seen - side[1].seen;
	if (g->given != 0)
		return g->given > 0 ? 1 : -1;
	return fabs(seen) > SEEN_LEAST * side[0].area ? (seen > 0 ? 1 : -1) : 0;
}

/* What is known of all groups, with the signs as they are. Without rooms their factors are 1. */
static void sum_groups(orientation_work *w, bool rooms)
{
	for (size_t i = 0; i < w->patch_count; i++)
		w->now.groups[i] = (patch_group){ .factor = { 1, 1 } };
	for (size_t i = 0; i < w->patch_count; i++) {
		patch_group *g = w->now.groups + w->group[i];
		for (int side = 0; side < 2; side++)
			add_view(w->now.light[i].side + (w->now.sign[i] > 0 ? side : 1 - side),
					 g->light.side + side);
		g->given += w->given[i] * w->now.sign[i];
	}
	for (size_t i = 0; i < w->patch_count; i++) {
		patch_group *g = w->now.groups + i;
		for (int side = 0; rooms && side < 2; side++)
			g->factor[side] = gw_side_factor(g->light.side + side);
		g->doubtful = known_side(g) == 0 && !(light_ratio(g) > CLEAR);
	}
}

/* Turns whole groups whose back is the brighter side, or was seen, or that normals were given for.
 */
static void turn_whole(orientation_work *w, bool rooms)
{
	sum_groups(w, rooms);
	for (size_t i = 0; i < w->patch_count; i++) {
		const patch_group *g = w->now.groups + w->group[i];
		bool turn = known_side(g) != 0 ? known_side(g) < 0 : light_ratio(g) < 1;
		w->now.sign[i] = turn ? (int8_t)-w->now.sign[i] : w->now.sign[i];
	}
	sum_groups(w, rooms);
}

/* How sure a patch is of its front by itself, -1 to 1. */
static double find_certainty(const orientation_work *w, size_t patch)
{
	double front = patch_light(w, patch, 0), back = patch_light(w, patch, 1);
	double ratio = log(fmax(front, back) / fmin(front, back));
	if (!(ratio > log(SURE_LEAST)))
		return 0;
	double sure = fmin((ratio - log(SURE_LEAST)) / log(SURE / SURE_LEAST), 1);
	return (front > back) == (w->now.sign[patch] > 0) ? sure : -sure;
}

/* By how much more of a patch was seen from its normals' side, -1 to 1. */
static double find_seen(const orientation_work *w, size_t patch)
{
	const gw_side_view *side = w->now.light[patch].side;
	return side[0].area > 0 ? (side[0].seen - side[1].seen) / side[0].area : 0;
}

static void find_own(orientation_work *w)
{
	memset(w->own, 0, w->patch_count * sizeof *w->own);
	for (size_t i = 0; i < w->surfels->count; i++)
		w->own[w->patch[i]] += GW_AGREED;
	for (size_t i = 0; i < w->patch_count; i++) {
		w->own[i] *= LIGHT_WEIGHT * find_certainty(w, i) + SEEN_WEIGHT * find_seen(w, i);
		w->own[i] += GIVEN_WEIGHT * GW_AGREED * w->given[i];
	}
}

/* Turns whole groups and parts of them in turn. */
static void turn_parts(orientation_work *w, gw_patch_groups *groups, bool rooms)
{
	turn_whole(w, rooms);
	find_own(w);
	gw_patch_groups_turn(groups, w->own, w->now.sign);
	turn_whole(w, true);
}

/*
 * Which side is a room's can be told where the signs of a group agree, which needs its light where
 * borders tell little. So that is tried with rooms from the beginning, and with light alone at
 * first; of each group that is taken by which one side is the brighter more clearly.
 */
static void turn_best(orientation_work *w, gw_patch_groups *groups)
{
	size_t count = w->patch_count;
	memcpy(w->other, w->now.sign, count * sizeof *w->other);
	turn_parts(w, groups, false);
	turn_parts(w, groups, true);
	for (size_t i = 0; i < count; i++) {
		int8_t swap = w->other[i];
		w->other[i] = w->now.sign[i];
		w->now.sign[i] = swap;
		w->ratio[i] = light_ratio(w->now.groups + i);
	}
	turn_parts(w, groups, true);
	for (size_t i = 0; i < count; i++)
		if (w->ratio[w->group[i]] > light_ratio(w->now.groups + w->group[i]))
			w->now.sign[i] = w->other[i];
	sum_groups(w, true);
}

/* Signs by what patches and borders say; alike: creases say as much as smooth surface. */
static gw_status choose_signs(orientation_work *w, bool alike, gw_error *error)
{
	const gw_surfels_options *o = w->options;
	if (o->cancelled && o->cancelled(o->user))
		return gw_fail(error, GW_ERROR_CANCELLED, "stopped while choosing front sides");
	GW_TRY(find_borders(w, alike, error));
	gw_patch_groups *groups = gw_patch_groups_make(w->patch_count, w->borders[alike],
												   w->border_count[alike], w->now.sign, w->group);
	if (!groups)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu patches", w->patch_count);
	turn_best(w, groups);
	gw_patch_groups_free(groups);
	return GW_OK;
}

/*
 * Of what the two ways of choosing dispute. Within rooms light is on both sides of thin walls, and
 * borders are better to go by. In the open light is: there the front is the side that it falls on,
 * and that sees less surface.
 */
static void settle_disputed(orientation_work *w)
{
	for (size_t i = 0; i < w->patch_count; i++)
		w->now.groups[i] = (patch_group){ .factor = { 1, 1 } };
	for (size_t i = 0; i < w->patch_count; i++) {
		w->now.disputed[i] = w->by_angle[i] != w->now.sign[i];
		patch_group *g = w->now.groups + w->group[i];
		for (int side = 0; w->now.disputed[i] && side < 2; side++)
			add_view(w->now.light[i].side + (w->now.sign[i] > 0 ? side : 1 - side),
					 g->light.side + side);
	}
	for (size_t i = 0; i < w->patch_count; i++) {
		const gw_side_view *side = w->now.groups[w->group[i]].light.side;
		bool open = side[1].met < OPEN_SIDE * side[1].area && side[1].met < side[0].met;
		if (w->now.disputed[i] && open && side[1].light > side[0].light)
			w->now.sign[i] = w->by_angle[i];
	}
	sum_groups(w, true);
}

/* Signs by the light as it is. What depends on how much creases say is disputed: there the two ways
 * of it disagree. */
static gw_status decide(orientation_work *w, gw_error *error)
{
	GW_TRY(choose_signs(w, false, error));
	memcpy(w->by_angle, w->now.sign, w->patch_count * sizeof *w->now.sign);
	GW_TRY(choose_signs(w, true, error));
	settle_disputed(w);
	return GW_OK;
}

static void swap_choices(orientation_work *w)
{
	choice now = w->now;
	w->now = w->by_sky;
	w->by_sky = now;
}

/* The same as if a sky shone alone. */
static gw_status decide_by_sky(orientation_work *w, gw_error *error)
{
	swap_choices(w);
	gw_status status = decide(w, error);
	swap_choices(w);
	return status;
}

/* Which of the light that there is falls straight on the sides of groups as a sky chooses them. */
static void light_sky_groups(orientation_work *w)
{
	for (size_t i = 0; i < w->patch_count; i++)
		w->by_sky.groups[i].light.side[0].lit = w->by_sky.groups[i].light.side[1].lit = 0.0;
	for (size_t i = 0; i < w->patch_count; i++) {
		patch_group *g = w->by_sky.groups + w->group[i];
		int front = w->by_sky.sign[i] > 0 ? 0 : 1;
		g->light.side[0].lit += w->now.light[i].side[front].lit;
		g->light.side[1].lit += w->now.light[i].side[1 - front].lit;
	}
}

/*
 * A lamp or the sun lights half of a thing, and tells little of the rest; a sky tells of all of it.
 * So a group is as a sky chooses, unless that is in doubt and this light is not, or too little of
 * this light gets there. What the sky calls the outside has to get half as much as the inside
 * that this light chooses: a lamp stands inside of something on purpose. What it calls the inside
 * of a room, though, may well be lit from outside alone.
 */
static bool is_by_sky(const orientation_work *w, size_t group)
{
	const patch_group *g = w->now.groups + group, *sky = w->by_sky.groups + group;
	const gw_side_view *front = g->light.side, *sky_front = sky->light.side;
	double times = front->met > sky_front->met ? CLEAR : REACHED;
	return front->lit <= times * sky_front->lit && (g->doubtful || !sky->doubtful);
}

/* Does surface lie nearly all around a side, and below it? */
static bool is_closed(const gw_side_view *side)
{
	return side->met > CLOSED * side->area && side->down_met >= CLOSED * side->down;
}

/* Does a lamp stand within a group? It shows nothing else then. That is so where surface lies all
 * around, or more of it than around what a sky would choose, which gets next to none of the light:
 * scanned rooms have windows, and gaps where nobody looked. Where the sky cannot tell, it is enough
 * that clearly less of the light gets there: half of a room that lacks a wall would pass. */
static bool is_lit_within(const orientation_work *w, size_t group)
{
	const patch_group *sky = w->by_sky.groups + group;
	const gw_side_view *front = w->now.groups[group].light.side, *sky_front = sky->light.side;
	double times = sky->doubtful ? CLEAR : SURE;
	return is_closed(front) || (front->met > sky_front->met && front->lit > times * sky_front->lit);
}

/* Takes the sky's choice for the groups that go by it. Of the others, patches that the sky chooses
 * otherwise are seen from either side, but for what is lit from within. */
static void take_sky(orientation_work *w)
{
	light_sky_groups(w);
	for (size_t i = 0; i < w->patch_count; i++) {
		if (is_by_sky(w, w->group[i])) {
			w->now.sign[i] = w->by_sky.sign[i];
			w->now.disputed[i] = w->by_sky.disputed[i];
		} else if (!is_lit_within(w, w->group[i])) {
			w->now.disputed[i] |= w->now.sign[i] != w->by_sky.sign[i];
		}
	}
	for (size_t i = 0; i < w->patch_count; i++)
		if (is_by_sky(w, i))
			w->now.groups[i] = w->by_sky.groups[i];
}

/*
 * What is closed and as wide as a room or a cave may be one, or a thing: all the light may fall on
 * its outside, and still somebody stood within. There is no telling, so it is seen from both sides.
 */
static bool may_be_either(const patch_group *g)
{
	const gw_side_view *front = g->light.side, *back = front + 1;
	if (known_side(g) != 0 || g->holds)
		return false;
	if (is_closed(front))
		return front->lit * REACHED < back->lit;
	return is_closed(back) && back->area > ROOM_AREA && back->path < log(ROOM_MOST) * back->met;
}

static void doubt_closed(orientation_work *w)
{
	for (size_t i = 0; i < w->patch_count; i++)
		w->now.disputed[i] |= may_be_either(w->now.groups + w->group[i]);
}

/* Turns a group to the side on which others lie within it. */
static void turn_shell(patch_group *g, int8_t holds)
{
	g->holds = known_side(g) == 0 && holds != 0;
	if (!g->holds)
		return;
	g->doubtful = false;
	if (holds < 0) {
		gw_side_view front = g->light.side[0];
		double factor = g->factor[0];
		g->light.side[0] = g->light.side[1];
		g->light.side[1] = front;
		g->factor[0] = g->factor[1];
		g->factor[1] = factor;
	}
}

/* A shell that holds other pieces of surface is a room, whatever light it is in. */
static gw_status turn_shells(orientation_work *w, gw_error *error)
{
	size_t count = w->patch_count;
	int8_t *holds = w->other;
	for (size_t i = 0; i < count; i++)
		w->ratio[i] = w->now.groups[i].light.side[0].area;
	GW_TRY(gw_find_shells(&(gw_pieces){ count, w->group, w->now.sign, w->ratio }, w->sights,
						  w->sight_count, holds, error));
	for (size_t i = 0; i < count; i++)
		turn_shell(w->now.groups + i, holds[i]);
	for (size_t i = 0; i < count; i++) {
		if (!w->now.groups[w->group[i]].holds)
			continue;
		w->now.disputed[i] = false;
		w->now.sign[i] = holds[w->group[i]] < 0 ? (int8_t)-w->now.sign[i] : w->now.sign[i];
	}
	return GW_OK;
}

static void sum_emitting(orientation_work *w)
{
	const gw_surfels *s = w->surfels;
	for (size_t i = 0; i < s->count; i++) {
		patch_group *g = w->now.groups + w->group[w->patch[i]];
		g->area += (double)w->area[i];
		g->emitting += gw_surfel_emits(s, i) ? (double)w->area[i] : 0.0;
	}
}

/* Of a group that is a lamp, 1 where its light gets farther from its front, -1 from its back, and
 * 0 where neither is clear or it is no lamp. */
static int lamp_side(const patch_group *g)
{
	double front = g->light.side[0].dark_path, back = g->light.side[1].dark_path;
	if (known_side(g) != 0 || !(g->emitting >= LAMP_SHARE * g->area))
		return 0;
	return front > CLEAR * back ? 1 : back > CLEAR * front ? -1 : 0;
}

/*
 * Of a lamp that is made of points the light on its sides tells nothing: it shines by itself. Its
 * front is the side from which its light gets somewhere: to surface that does not emit, farther
 * away than on the other side, as the ground is below a panel, the room around a bulb, and the
 * street before a sign.
 */
static void turn_lamps(orientation_work *w)
{
	if (!w->surfels->emission)
		return;
	sum_emitting(w);
	for (size_t i = 0; i < w->patch_count; i++) {
		int side = lamp_side(w->now.groups + w->group[i]);
		w->now.sign[i] = side < 0 ? (int8_t)-w->now.sign[i] : w->now.sign[i];
		w->now.disputed[i] &= side == 0;
	}
	for (size_t i = 0; i < w->patch_count; i++)
		w->now.groups[i].doubtful &= lamp_side(w->now.groups + i) == 0;
}

/* ------------------------------------------------------------------------------------ from above
 */

/* By how much a surfel's front rises, in [-1, 1]. */
static double rise(const orientation_work *w, size_t surfel)
{
	double up[3], sum = 0;
	gw_up_axis(w->surfels->up, up);
	for (size_t k = 0; k < 3; k++)
		sum += up[k] * (double)w->surfels->normal[3 * surfel + k];
	return w->opposite[surfel] != (w->now.sign[w->patch[surfel]] < 0) ? -sum : sum;
}

static bool is_smooth(const orientation_work *w, size_t surfel)
{
	int sum = 0;
	for (size_t j = 0; j < GW_NEIGHBOURS; j++)
		sum += abs(w->agreement[GW_NEIGHBOURS * surfel + j]);
	return sum >= UNDERSIDE_SMOOTH * GW_AGREED * GW_NEIGHBOURS;
}

/* Does the sky shine on the back of a patch, and hardly on its front? Light from where nothing was
 * scanned is left out: below the ground of a deep court there is more of it than sky above. */
static bool is_lit_from_behind(const orientation_work *w, size_t patch)
{
	const gw_side_view *side = w->sky[patch].side;
	int front = w->now.sign[patch] > 0 ? 0 : 1;
	return side[1 - front].lit > CLEAR * side[front].lit;
}

/* Is so little of what is smooth an underside that it was put there by mistake? What the sky shines
 * on from above alone is none: it hangs on roofs by walls that are too sparse to tell. */
static bool has_no_underside(const orientation_work *w)
{
	size_t smooth = 0, down = 0;
	for (size_t i = 0; i < w->surfels->count; i++) {
		bool counts = is_smooth(w, i);
		smooth += counts;
		down += counts && rise(w, i) < -LEVEL && !is_lit_from_behind(w, w->patch[i]);
	}
	return (double)down <= UNDERSIDES_MOST * (double)smooth;
}

/* Does nobody but the light say which side of a patch is its front? */
static bool is_open_to_light(const orientation_work *w, size_t patch)
{
	const patch_group *g = w->now.groups + w->group[patch];
	return known_side(g) == 0 && (!w->surfels->emission || lamp_side(g) == 0);
}

/* Turns what hangs together and faces down for the most part. Where it is no wall as a whole that
 * settles its front, whatever the light said. */
static void turn_groups_up(orientation_work *w)
{
	double *up = w->own, *area = w->ratio;
	memset(up, 0, w->patch_count * sizeof *up);
	memset(area, 0, w->patch_count * sizeof *area);
	for (size_t i = 0; i < w->surfels->count; i++) {
		up[w->group[w->patch[i]]] += rise(w, i) * (double)w->area[i];
		area[w->group[w->patch[i]]] += (double)w->area[i];
	}
	for (size_t i = 0; i < w->patch_count; i++) {
		uint32_t group = w->group[i];
		if (!is_open_to_light(w, i))
			continue;
		w->now.sign[i] = up[group] < 0 ? (int8_t)-w->now.sign[i] : w->now.sign[i];
		w->now.disputed[i] &= fabs(up[group]) <= LEVEL * area[group];
		w->now.groups[group].doubtful &= fabs(up[group]) <= LEVEL * area[group];
	}
}

/* Of ground that was seen from above alone all has its front up: leaves and rims of roofs, whose
 * planes are so rough that neighbours do not tell, one by one; walls as what they hang on. */
static gw_status turn_up(orientation_work *w, gw_error *error)
{
	GW_TRY(gw_is_one_wide_layer(w->surfels, w->area, &w->from_above, error));
	w->from_above = w->from_above && has_no_underside(w);
	w->surfels->seen_from_above = w->from_above;
	if (w->from_above)
		turn_groups_up(w);
	return GW_OK;
}

static gw_status orient_patches(orientation_work *w, const gw_known_sides *known, gw_error *error)
{
	if (!allocate_patches(w))
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu patches", w->patch_count);
	bool lamps = !gw_side_light_is_sky(w->options, w->surfels);
	GW_TRY(find_light(w, known, lamps ? w->by_sky.light : NULL, error));
	w->sky = lamps ? w->by_sky.light : w->now.light;
	if (lamps)
		GW_TRY(decide_by_sky(w, error));
	GW_TRY(decide(w, error));
	if (lamps)
		take_sky(w);
	GW_TRY(turn_shells(w, error));
	doubt_closed(w);
	turn_lamps(w);
	return turn_up(w, error);
}

/* Was a side taken because it may be a room's? There the light of the other one is no substitute:
 * it is the day outside. */
static bool is_room(const orientation_work *w, size_t patch)
{
	const patch_group *g = w->now.groups + w->group[patch];
	return g->factor[0] > g->factor[1] && g->light.side[0].light < g->light.side[1].light;
}

static void turn_normals(orientation_work *w, const uint8_t *estimated, uint8_t *doubtful)
{
	gw_surfels *s = w->surfels;
	for (size_t i = 0; i < s->count; i++) {
		uint32_t patch = w->patch[i];
		double rises = w->from_above && is_open_to_light(w, patch) ? rise(w, i) : 0;
		bool against = w->opposite[i] != (w->now.sign[patch] < 0);
		doubtful[i] = 0;
		if (fabs(rises) > LEVEL)
			against ^= rises < 0;
		else if (estimated[i] &&
				 (w->now.groups[w->group[patch]].doubtful || w->now.disputed[patch]))
			doubtful[i] = is_room(w, patch) && !w->now.disputed[patch] ? 1 : GW_SIDE_UNCLEAR;
		for (size_t k = 0; estimated[i] && against && k < 3; k++)
			s->normal[3 * i + k] = -s->normal[3 * i + k];
	}
}

/* ----------------------------------------------------------------------------------- all of it */

static gw_status allocate(orientation_work *w, gw_error *error)
{
	size_t count = w->surfels->count;
	w->near = gw_allocate_array(count, GW_NEIGHBOURS * sizeof *w->near);
	w->agreement = gw_allocate_array(count, GW_NEIGHBOURS * sizeof *w->agreement);
	w->area = gw_allocate_array(count, sizeof *w->area);
	w->parent = gw_allocate_array(count, sizeof *w->parent);
	w->size = gw_allocate_array(count, sizeof *w->size);
	w->opposite = gw_allocate_zeros(count, sizeof *w->opposite);
	w->patch = gw_allocate_array(count, sizeof *w->patch);
	if (!w->near || !w->agreement || !w->area || !w->parent || !w->size || !w->opposite ||
		!w->patch)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to orient %zu normals", count);
	for (uint32_t i = 0; i < count; i++) {
		w->parent[i] = i;
		w->size[i] = 1;
	}
	return GW_OK;
}

static void release(orientation_work *w)
{
	free(w->near);
	free(w->agreement);
	free(w->area);
	free(w->parent);
	free(w->size);
	free(w->opposite);
	free(w->patch);
	free(w->borders[0]);
	free(w->borders[1]);
	free(w->sights);
	free_choice(&w->now);
	free_choice(&w->by_sky);
	free(w->given);
	free(w->own);
	free(w->other);
	free(w->by_angle);
	free(w->ratio);
	free(w->group);
}

static gw_status orient(orientation_work *w, gw_neighbours *search, const gw_known_sides *known,
						gw_error *error)
{
	GW_TRY(allocate(w, error));
	GW_TRY(gw_neighbours_visit_reach(search, find_pairs, w, error));
	join_smooth(w);
	number_patches(w);
	return orient_patches(w, known, error);
}

gw_status gw_orient_normals(const gw_surfels_options *options, gw_neighbours *search,
							gw_surfels *surfels, const gw_known_sides *known, uint8_t *doubtful,
							gw_error *error)
{
	orientation_work w = { .options = options, .surfels = surfels };
	gw_status status = orient(&w, search, known, error);
	if (status == GW_OK)
		turn_normals(&w, known->estimated, doubtful);
	release(&w);
	return status;
}

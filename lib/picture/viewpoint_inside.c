/* viewpoint_inside.c - rooms and caves: whether a cloud is one, and where to stand in it. */
#include "picture/viewpoint_steps.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

#define RAYS 192         /* from a free cell */
#define CANDIDATES 3000  /* free cells that are tried */
#define LEAST_DEPTH 1.5  /* cells, free around a viewpoint, but for the floor */
#define LEAST_HITS 0.7   /* share of rays that have to meet something */
#define CLOSED 0.93      /* the same, of the middle one among such places in a room or cave */
#define CLOSED_HOLES 0.8 /* the same when the rest are holes here and there */
#define CLOSED_SEEN 0.7  /* the same when its fronts are known, and are what is seen from there */
#define ONE_SIDE 0.6     /* length of the mean direction out, from which on a side is open */
#define LEAST_PLACES 5   /* fewer are a crack */
#define LEAST_SEEN 0.4   /* share of the surface that is seen from them */
#define LEAST_FRONTS 0.6 /* share of what the rays meet */
#define SURE_FRONTS 0.85 /* the same of a room of which much was not scanned, and of no fence */
#define PEOPLE_FIT 3.0   /* metres, least length of a space for people */
#define FLOOR_SLOPE 0.87 /* cosine of the steepest floor, 30 degrees */
#define LEAST_FLOOR 0.1  /* share of the surface that is floor */
#define FLAT 0.99        /* cosine of the slope of what is flat, 8 degrees */
#define LEAST_HIDDEN 0.1 /* share of the places that cannot be seen from each other */
#define KEPT 64          /* places of which that is found out */
#define EYE_HEIGHT 1.6   /* metres */
#define EYE_LOW 0.15     /* least and greatest share of the free height */
#define EYE_HIGH 0.6
#define DARK 0.15 /* what an unlit surface in view is worth */
#define NEAR 0.8  /* cells, in which only strays can be */
#define AZIMUTHS 16
#define PITCHES 3
#define PITCH (M_PI / 18)
#define PITCH_COST 0.05 /* of the value, for looking up or down */
#define FREE_WAY 0.3    /* what the way straight ahead counts beside all that is in view */
#define SCANNERS 8      /* from which a view is tried */
#define SCANNED                                                                                    \
	1.5 /* what the view of the only one is worth: elsewhere, what it did not see                  \
		   is missing */
#define SCANNED_MANY 1.1
#define MOUNT 3     /* cells, in which what carried a scanner may be */
#define OUTSIDE 0.5 /* of the longest side: scanners that are further outside stood elsewhere */

/* What is seen around one place. */
typedef struct panorama_view {
	view_hit hit[RAYS];
	bool front[RAYS];
	int hits, fronts;
} panorama_view;

/* Directions spread evenly over the sphere, on a spiral with the golden angle. */
static void make_rays(double (*ray)[3])
{
	for (int i = 0; i < RAYS; i++) {
		double z = 1 - (2 * i + 1) / (double)RAYS, r = sqrt(1 - z * z);
		double turn = M_PI * (3 - sqrt(5)) * i;
		ray[i][0] = r * cos(turn);
		ray[i][1] = r * sin(turn);
		ray[i][2] = z;
	}
}

/* Looks around; false when something is too near, but for what is within the first `skipped` cells.
 */
static bool look_around(const view_space *v, double (*ray)[3], const int32_t at[3], int skipped,
						panorama_view *p)
{
	p->hits = p->fronts = 0;
	for (int r = 0; r < RAYS; r++) {
		p->hit[r] = gw_view_space_look(v, at, ray[r], skipped);
		bool floor = view_dot(ray[r], v->up) < -0.5;
		if (skipped == 0 && p->hit[r].depth > 0 && p->hit[r].depth < LEAST_DEPTH && !floor)
			return false;
		const double back[3] = { -ray[r][0], -ray[r][1], -ray[r][2] };
		p->front[r] = p->hit[r].depth > 0 && gw_view_space_facing(v, p->hit[r].cell, back) >= 0;
		p->hits += p->hit[r].depth > 0;
		p->fronts += p->front[r];
	}
	return true;
}

/* ------------------------------------------------------------------------- is it a room? */

/* Sums over the enclosed places. */
typedef struct tally {
	size_t places, hits, fronts;
	double out[3];            /* sum of the rays that met nothing */
	size_t of_hits[RAYS + 1]; /* places with so many hits */
	size_t place[KEPT], kept; /* cells of some of them, each `step` places */
	size_t step;
	uint8_t *seen; /* owned; of each cell */
} tally;

/* Keeps every place, then every second one, and so on. */
static void keep_place(tally *t, size_t cell)
{
	if (t->places % t->step != 0)
		return;
	if (t->kept == KEPT) {
		t->kept /= 2;
		t->step *= 2;
		for (size_t i = 0; i < t->kept; i++)
			t->place[i] = t->place[2 * i];
	}
	t->place[t->kept++] = cell;
}

static void add_place(tally *t, double (*ray)[3], const panorama_view *p, size_t cell)
{
	if (p->hits < LEAST_HITS * RAYS)
		return;
	keep_place(t, cell);
	t->places++;
	t->hits += (size_t)p->hits;
	t->fronts += (size_t)p->fronts;
	t->of_hits[p->hits]++;
	for (int r = 0; r < RAYS; r++) {
		if (p->hit[r].depth > 0)
			t->seen[p->hit[r].cell] = 1;
		for (int k = 0; k < 3 && !(p->hit[r].depth > 0); k++)
			t->out[k] += ray[r][k];
	}
}

static size_t middle_hits(const tally *t)
{
	size_t hits = 0, places = t->of_hits[0];
	while (2 * places < t->places)
		places += t->of_hits[++hits];
	return hits;
}

/* Share of the surface that is seen from the places, and that people could stand on. */
static void share_surface(const view_space *v, const uint8_t *seen, double *visible, double *floor)
{
	*visible = *floor = 0;
	double middle = 0;
	for (size_t i = 0; i < v->count; i++)
		middle += (double)v->cell[i].height / v->area;
	for (size_t i = 0; i < v->count; i++) {
		const view_cell *c = v->cell + i;
		if (!(c->area > 0.0f))
			continue;
		double upright = 0;
		for (int k = 0; k < 3; k++)
			upright += v->up[k] * (double)(c->normal[k] / c->area);
		*visible += seen[i] ? (double)c->area / v->area : 0;
		if (fabs(upright) > FLOOR_SLOPE && (double)(c->height / c->area) < middle)
			*floor += (double)c->area / v->area;
	}
}

/* Whether most scanners, or most of some of them, stood in an enclosed place. */
static bool scanners_within(const view_space *v, double (*ray)[3])
{
	size_t within = 0, tried = 0, count = v->wish->scanner_count;
	for (size_t i = 0; i < count; i += count / 32 + 1) {
		int32_t at[3];
		bool inside = true;
		for (size_t k = 0; k < 3; k++) {
			double place = v->wish->scanner[3 * i + k] - v->surfels->origin[k] - v->least[k];
			inside = inside && place >= 0 && place < v->size[k] * v->width;
			at[k] = inside ? (int32_t)(place / v->width) : 0;
		}
		int hits = 0;
		for (int r = 0; r < RAYS && inside; r++)
			hits += gw_view_space_look(v, at, ray[r], 1).depth > 0;
		within += hits >= LEAST_HITS * RAYS;
		tried++;
	}
	return 2 * within > tried;
}

/* Whether fronts are known, and are what is seen from the places, so much of it. */
static bool see_fronts(const view_space *v, const tally *t, double share)
{
	return v->sided && (double)t->fronts >= share * (double)t->hits;
}

/* Whether the places are closed in, but for holes: a stage is open to one side. */
static bool is_closed(const view_space *v, const tally *t)
{
	double share = (double)middle_hits(t) / RAYS;
	double misses = (double)(t->places * RAYS - t->hits);
	bool holes = sqrt(view_dot(t->out, t->out)) < ONE_SIDE * misses;
	return t->places >= LEAST_PLACES &&
		   (share > CLOSED ||
			(holes && share > (see_fronts(v, t, SURE_FRONTS) ? CLOSED_SEEN : CLOSED_HOLES)));
}

/* Whether a space has corners to look around, or a floor that is flat; a ball has neither. */
static bool is_room(const view_space *v, const tally *t)
{
	double flat = 0;
	size_t pairs = 0, hidden = 0;
	for (size_t i = 0; i < v->count; i++) {
		double upright = 0;
		for (int k = 0; k < 3 && v->cell[i].area > 0.0f; k++)
			upright += v->up[k] * (double)(v->cell[i].normal[k] / v->cell[i].area);
		flat += fabs(upright) > FLAT ? (double)v->cell[i].area / v->area : 0;
	}
	for (size_t i = 0; i + 1 < t->kept; i++)
		for (size_t j = i + 1; j < t->kept; j++) {
			double way[3], length;
			int32_t from[3], to[3];
			gw_view_space_place(v, t->place[i], from);
			gw_view_space_place(v, t->place[j], to);
			for (int k = 0; k < 3; k++)
				way[k] = to[k] - from[k];
			length = sqrt(view_dot(way, way));
			for (int k = 0; k < 3; k++)
				way[k] /= length;
			view_hit hit = gw_view_space_look(v, from, way, 0);
			hidden += hit.depth > 0 && hit.depth < length - 1;
			pairs++;
		}
	return flat > LEAST_FLOOR || (double)hidden > LEAST_HIDDEN * (double)pairs;
}

static bool decide(const view_space *v, const tally *t, double (*ray)[3])
{
	double visible, floor, longest = 0;
	if (!is_closed(v, t))
		return false;
	share_surface(v, t->seen, &visible, &floor);
	if (visible < LEAST_SEEN)
		return false;
	if (v->given)
		return see_fronts(v, t, LEAST_FRONTS);
	if (v->wish->scanner_count > 0)
		return scanners_within(v, ray) || see_fronts(v, t, LEAST_FRONTS);
	for (int k = 0; k < 3; k++)
		longest = fmax(longest, v->high[k] - v->low[k]);
	return longest > PEOPLE_FIT && floor > LEAST_FLOOR && is_room(v, t);
}

static size_t count_free(const view_space *v)
{
	size_t count = 0;
	for (size_t i = 0; i < v->count; i++)
		count += !(v->cell[i].area > 0.0f);
	return count;
}

gw_status gw_viewpoint_is_inside(const view_space *v, bool *inside, gw_error *error)
{
	double ray[RAYS][3];
	panorama_view around;
	tally t = { .step = 1, .seen = gw_allocate_zeros(v->count, 1) };
	if (!t.seen)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to look for a viewpoint");
	make_rays(ray);
	size_t every = count_free(v) / CANDIDATES + 1, counter = 0;
	for (size_t i = 0; i < v->count; i++) {
		int32_t at[3];
		gw_view_space_place(v, i, at);
		if (!(v->cell[i].area > 0.0f) && counter++ % every == 0 &&
			look_around(v, ray, at, 0, &around))
			add_place(&t, ray, &around, i);
	}
	*inside = decide(v, &t, ray);
	free(t.seen);
	return GW_OK;
}

/* ------------------------------------------------------------------------ where to stand */

typedef struct search {
	const view_space *space;
	double ray[RAYS][3];
	double view[AZIMUTHS * PITCHES][3];
	bool level[AZIMUTHS * PITCHES];
	double cosine; /* of half the angle of view */
	double best;
	gw_viewpoint *viewpoint;
} search;

/* Height of the surface in a cell, along the up axis in the local frame. */
static double surface_height(const view_space *v, size_t cell)
{
	return (double)(v->cell[cell].height / v->cell[cell].area);
}

static double cell_height(const view_space *v, const int32_t at[3])
{
	double height = 0;
	for (int k = 0; k < 3; k++)
		height += v->up[k] * (v->least[k] + (at[k] + 0.5) * v->width);
	return height;
}

/* Whether a cell is where the eyes of somebody are who stands on what is below; how high those
 * are above the cell's middle. */
static bool stands(const view_space *v, const int32_t at[3], double *above)
{
	const double down[3] = { -v->up[0], -v->up[1], -v->up[2] };
	view_hit floor = gw_view_space_look(v, at, down, 0),
			 ceiling = gw_view_space_look(v, at, v->up, 0);
	if (!(floor.depth > 0))
		return false;
	double ground = surface_height(v, floor.cell), own = cell_height(v, at), eye = EYE_HEIGHT;
	if (ceiling.depth > 0) {
		double free = surface_height(v, ceiling.cell) - ground;
		eye = fmin(fmax(eye, EYE_LOW * free), EYE_HIGH * free);
	}
	*above = ground + eye - own;
	return fabs(*above) <= 0.5001 * v->width;
}

/* Mean value of what is in a view; how far its surfaces are, in cells. */
static double value_view(const search *s, const panorama_view *p, int view, double *depth)
{
	const view_space *v = s->space;
	double value = 0, inside = 0, straight = -1, ahead = 0;
	*depth = 0;
	for (int r = 0; r < RAYS; r++) {
		double cosine = view_dot(s->ray[r], s->view[view]);
		if (cosine < s->cosine)
			continue;
		inside++;
		if (cosine > straight) {
			straight = cosine;
			ahead = p->hit[r].depth;
		}
		if (!(p->hit[r].depth > 0))
			continue;
		double seen = log1p(p->hit[r].depth) * (DARK + gw_view_space_lit(v, p->hit[r].cell));
		value += p->front[r] ? seen : -seen;
		*depth += p->hit[r].depth;
	}
	*depth /= fmax(inside, 1);
	value = value / fmax(inside, 1) + FREE_WAY * log1p(ahead) * DARK;
	return value * (s->level[view] ? 1 : 1 - PITCH_COST);
}

/* Keeps the best view from a place, of what is seen around it, if it is better than those before.
 *   at      the place, metres, in the coordinates of the points
 *   worth   times the value */
static void keep_best(search *s, const panorama_view *around, const double at[3], double worth)
{
	gw_viewpoint *to = s->viewpoint;
	for (int d = 0; d < AZIMUTHS * PITCHES; d++) {
		double depth, value = worth * value_view(s, around, d, &depth);
		if (!(value > s->best))
			continue;
		s->best = value;
		for (int k = 0; k < 3; k++) {
			to->at[k] = at[k];
			to->to[k] = at[k] + depth * s->space->width * s->view[d][k];
		}
	}
}

static void try_place(search *s, const int32_t cell[3], double above)
{
	panorama_view around;
	const view_space *v = s->space;
	double at[3];
	if (!look_around(v, s->ray, cell, 0, &around) || around.hits < LEAST_HITS * RAYS)
		return;
	for (int k = 0; k < 3; k++)
		at[k] = v->surfels->origin[k] + v->least[k] + (cell[k] + 0.5) * v->width + above * v->up[k];
	keep_best(s, &around, at, 1.0);
}

/* Where scanners stood in what counts, or hardly outside of it: half of what is around one that
 * turned half around is empty, and no hole is in the other half. What is next to it carried it, and
 * hides nothing that it saw. */
static void try_scanners(search *s)
{
	const view_space *v = s->space;
	size_t count = v->wish->scanner_count;
	double reach = OUTSIDE * fmax(fmax(v->size[0], v->size[1]), v->size[2]);
	for (size_t i = 0; i < count; i += count / SCANNERS + 1) {
		panorama_view around;
		int32_t cell[3];
		bool near = true;
		for (size_t k = 0; k < 3; k++) {
			double place =
				(v->wish->scanner[3 * i + k] - v->surfels->origin[k] - v->least[k]) / v->width;
			near = near && place > -reach && place < v->size[k] + reach;
			cell[k] = near ? (int32_t)floor(place) : 0;
		}
		if (near && (look_around(v, s->ray, cell, 0, &around) ||
					 look_around(v, s->ray, cell, MOUNT, &around)))
			keep_best(s, &around, v->wish->scanner + 3 * i, count > 1 ? SCANNED_MANY : SCANNED);
	}
}

/* Tries free cells, so many of them; `standing`, those at the height of eyes above a floor. */
static void try_places(search *s, bool standing)
{
	const view_space *v = s->space;
	size_t fitting = 0, counter = 0, every = 1;
	for (int pass = 0; pass < 2; pass++) {
		every = fitting / CANDIDATES + 1;
		for (size_t i = 0; i < v->count; i++) {
			int32_t at[3];
			double above = 0;
			gw_view_space_place(v, i, at);
			if (v->cell[i].area > 0.0f || (standing && !stands(v, at, &above)))
				continue;
			fitting += pass == 0;
			if (pass == 1 && counter++ % every == 0)
				try_place(s, at, above);
		}
	}
}

void gw_viewpoint_within(const view_space *v, gw_viewpoint *viewpoint)
{
	search s = { .space = v, .viewpoint = viewpoint };
	make_rays(s.ray);
	for (int d = 0; d < AZIMUTHS * PITCHES; d++) {
		int pitch = d % PITCHES - 1;
		s.level[d] = pitch == 0;
		gw_view_space_direction(v, 2 * M_PI * (d / PITCHES) / AZIMUTHS, pitch * PITCH, s.view[d]);
	}
	viewpoint->angle = v->wish->angle > 0 ? v->wish->angle : GW_VIEWPOINT_ANGLE_INSIDE;
	/* A cone as wide as the mean of the picture's two angles. */
	double tangent = tan(viewpoint->angle * M_PI / 360);
	s.cosine = cos(0.5 * (atan(tangent) + atan(tangent * v->wish->aspect)));
	try_scanners(&s);
	try_places(&s, true);
	if (!(s.best > 0))
		try_places(&s, false);
	/* Nothing that counts is that near. */
	viewpoint->near = NEAR * v->width;
	viewpoint->inside = s.best > 0;
}

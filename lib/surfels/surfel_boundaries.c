/*
 * surfel_boundaries.c - where surfaces end that border on nothing.
 *
 * Random points leave voids, but hardly one that a circle of 2.5 spacings' radius fits into.
 * So in the plane of a surfel near a boundary, such a circle is rolled up to it from all around.
 * Where it comes nearest the disc is cut, across the way to the circle's centre: at the side of a
 * sheet as at the boundary of a hole, into whose corners a straight edge that all points are behind
 * would not reach. The circle dips between the outermost points. How far the surface goes on beyond
 * it does not depend much on how they are spread: regular points are half a spacing from the edge,
 * and between random points, of which the outermost lies nearer, it dips deeper.
 *
 * A surface that ends at a crease counts as going on behind it as its mirror image does. A boundary
 * is believed only where several surfels see one, and lies where they see it on average.
 */
#include "surfels/surfel_disc.h"

#include "base/memory.h"
#include "surfels/surfel_crease.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SUPPORT 3 /* surfels in a neighbourhood that have to see a boundary */

/* Radius of the circle: of the surfel's reach, and of the mean radius of the discs around it where
 * that is more, as in a cluster of points. In spacings about 2 inside a surface; from a straight
 * boundary 16 neighbours reach further. */
#define CIRCLE_OF_REACH 0.9
#define CIRCLE_OF_DISCS 1.4

/* Spacings, the mean ones around: the circle's radius at most. Hardly one place in a hundred
 * million is free for a circle as large, and a window that is twice as wide and a little has room
 * for it. */
#define CIRCLE_MOST 2.5

/* Of the circle's radius: distances that differ by less are the same. */
#define TIE 0.02

/* Random points leave one place in a hundred thousand free for smaller circles. Where the largest
 * finds no room then, a void ends, and no surface. Where surface surrounds a corner of a hole, it
 * stays behind by up to half as much; of the circle's radius. */
#define WIDER_BEHIND 0.5

/* How far the surface goes on beyond the circle, in spacings: with it sheets of random points end
 * where they do (measured, tests/physics/test_boundaries.c). Regular points are half their distance
 * from the edge. */
#define MARGIN 0.48

/* Boundaries of neighbours are the same when the cosine between them is at least the one, and they
 * lie as near to each other as the other, in reaches. */
#define ALIKE 0.85
#define APART 0.35

/* Of a disc's radius: boundaries further from a surfel are not told to others. They may be cut off
 * by another one, and bend around a corner. */
#define BESIDE 0.5f

/* Places that a circle has to avoid: a surfel, its neighbours, those seen from the circle, and
 * their mirror images behind two creases. */
#define PLACES_MOST (3 * (1 + GW_NEIGHBOURS + GW_NEIGHBOURS_AT))

typedef struct boundary_step {
	gw_neighbours *search;
	gw_surfels *surfels;
	const uint8_t *boundary;
	uint8_t *settled; /* count, a bit for each clip at a boundary that a circle found */
	float *clip;      /* 6 * count, receives the clips that surfels around agree on */
	float *area;      /* count, receives those of changed surfels */
	bool rough_area;
} boundary_step;

/* What surrounds a surfel in its plane. */
typedef struct surrounding {
	double place[PLACES_MOST][2];
	uint32_t count;
	gw_half_plane edge[2]; /* its creases, then the boundaries that were found */
	uint32_t creases, edges;
	uint32_t creases_found; /* among the edges, instead of boundaries */
	double widest;          /* radius of circles at most */
	double reach;           /* of the surfel's neighbours */
} surrounding;

/* Adds a place and its mirror images. */
static void add_place(surrounding *around, double x, double y)
{
	for (uint32_t e = 0; e <= around->creases; e++) {
		double *place = around->place[around->count++];
		const gw_half_plane *crease = around->edge + e - 1;
		double over = e > 0 ? 2 * (crease->offset - gw_distance_along(crease, x, y)) : 0;
		place[0] = x + (e > 0 ? over * crease->x : 0);
		place[1] = y + (e > 0 ? over * crease->y : 0);
	}
}

/* Fills the surrounding with the surfel's creases, itself and its neighbours on the surface. */
static void surround(const boundary_step *step, size_t surfel, const gw_flat_point *kept,
					 uint32_t count, surrounding *around)
{
	const float *clip = step->surfels->clip + 6 * surfel;
	around->count = around->creases = around->creases_found = 0;
	for (uint32_t e = 0; e < 2; e++) {
		bool cut = clip[3 * e] != 0 || clip[3 * e + 1] != 0;
		if (cut && !(step->boundary[surfel] >> e & 1))
			around->edge[around->creases++] =
				(gw_half_plane){ (double)clip[3 * e], (double)clip[3 * e + 1],
								 (double)clip[3 * e + 2] };
	}
	around->edges = around->creases;
	add_place(around, 0, 0);
	for (uint32_t j = 0; j < count; j++)
		add_place(around, kept[j].x, kept[j].y);
}

/* How far away in a direction a circle finds room that comes from there: the least distance of its
 * centre, or one above `most`. */
static double find_room(const surrounding *around, const double way[2], double radius, double most)
{
	double at = radius;
	for (bool moved = true; moved && at <= most;) {
		moved = false;
		for (uint32_t j = 0; j < around->count; j++) {
			const double *p = around->place[j];
			double along = way[0] * p[0] + way[1] * p[1], beside = way[0] * p[1] - way[1] * p[0];
			double half = sqrt(fmax(radius * radius - beside * beside, 0));
			/* Rounding must not move it on and on. */
			if (at - along > -half && at - along < half - 1e-9 * radius) {
				at = along + half;
				moved = true;
			}
		}
	}
	return at;
}

/* How much of a direction lies in that of an edge, of the one where that is most; -1: no edges. */
static double along_edges(const surrounding *around, int d)
{
	double most = -1;
	for (uint32_t e = 0; e < around->edges; e++)
		most =
			fmax(most, gw_distance_along(around->edge + e, gw_direction[d][0], gw_direction[d][1]));
	return most;
}

/*
 * The direction in which the circle comes nearest, of those that no edge is in; -1: there is none.
 * At a corner of the surface it comes as near in all directions of a fan: of these, one end, and
 * where there is an edge the one furthest off.
 */
static int find_nearest(const surrounding *around, const double *room, double circle)
{
	double least = INFINITY, score = INFINITY;
	int best = -1;
	for (int d = 0; d < GW_DIRECTIONS; d++)
		if (along_edges(around, d) <= GW_COS_60)
			least = fmin(least, room[d]);
	for (int d = 0; d < GW_DIRECTIONS; d++) {
		double along = along_edges(around, d);
		bool tied_before = room[(d + GW_DIRECTIONS - 1) % GW_DIRECTIONS] <= least + TIE * circle;
		if (along > GW_COS_60 || room[d] > least + TIE * circle)
			continue;
		double own = around->edges > 0 ? along : tied_before ? 1 : 0;
		if (own < score) {
			score = own;
			best = d;
		}
	}
	return best;
}

/* Adds the surfels at a distance, to which the surfel's own neighbours do not reach. Returns how
 * many there were before. */
static uint32_t add_far(const boundary_step *step, size_t surfel, const double way[2],
						double distance, surrounding *around)
{
	gw_neighbour_list list;
	gw_flat_point flat[GW_NEIGHBOURS];
	uint32_t before = around->count;
	gw_plane_look_at(step->search, step->surfels, surfel, distance * way[0], distance * way[1],
					 &list);
	uint32_t count = gw_plane_flatten_level(step->surfels, surfel, &list, around->reach, flat);
	for (uint32_t j = 0; j < count; j++)
		add_place(around, flat[j].x, flat[j].y);
	return before;
}

/* Does a circle stop at a distance only because it is small? */
static bool is_void(const boundary_step *step, size_t surfel, const double way[2], double distance,
					double circle, surrounding *around)
{
	double more = around->widest - circle;
	if (more <= 0)
		return false;
	uint32_t before = add_far(step, surfel, way, distance + more, around);
	double there = find_room(around, way, around->widest, INFINITY);
	around->count = before;
	return there > distance + more + WIDER_BEHIND * circle;
}

/* Does another surface begin where the circle stops? Then the edge becomes their crease. */
static bool is_crease(const boundary_step *step, size_t surfel, double reach, gw_half_plane *edge)
{
	gw_neighbour_list list;
	gw_plane_look_at(step->search, step->surfels, surfel, edge->offset * edge->x,
					 edge->offset * edge->y, &list);
	return gw_plane_meets_crease(step->surfels, surfel, &list, edge, reach);
}

/* Adds edges, up to two with the creases, where a circle comes nearer than the disc reaches. */
static void find_boundaries(const boundary_step *step, size_t surfel, double reach, double circle,
							double margin, surrounding *around)
{
	double most = circle + (double)step->surfels->radius[surfel] - margin, room[GW_DIRECTIONS];
	for (int d = 0; d < GW_DIRECTIONS; d++)
		room[d] = find_room(around, gw_direction[d], circle, most);
	while (around->edges < 2) {
		int d = find_nearest(around, room, circle);
		if (d < 0 || room[d] >= most)
			return;
		const double *way = gw_direction[d];
		/* Where its place is taken by surfels further away, the circle has to go further. */
		uint32_t before = add_far(step, surfel, way, room[d], around);
		double there = find_room(around, way, circle, most);
		around->count = before;
		if (there > room[d]) {
			room[d] = there;
			continue;
		}
		if (is_void(step, surfel, way, there, circle, around)) {
			room[d] = most;
			continue;
		}
		gw_half_plane *edge = around->edge + around->edges++;
		*edge = (gw_half_plane){ way[0], way[1], there - circle };
		if (is_crease(step, surfel, reach, edge)) {
			around->creases_found++;
		} else {
			edge->offset += margin;
			step->settled[surfel] |= (uint8_t)(1u << (around->edges - 1));
		}
	}
}

/* The area that the surfel's clips leave of its cell. */
static void measure_area(boundary_step *step, size_t surfel, const float *clip,
						 const gw_neighbour_list *list, const gw_flat_point *kept, uint32_t count)
{
	double radius = (double)step->surfels->radius[surfel];
	double reach = (double)list->distance[list->count - 1];
	gw_half_plane edge[2];
	uint32_t edges = 0;
	for (uint32_t e = 0; e < 2; e++)
		if (clip[3 * e] != 0 || clip[3 * e + 1] != 0)
			edge[edges++] = (gw_half_plane){ (double)clip[3 * e], (double)clip[3 * e + 1],
											 (double)clip[3 * e + 2] };
	step->area[surfel] =
		fmaxf((float)gw_plane_cell_area(kept, count, radius, reach, edge, edges), FLT_MIN);
}

/* How many surfels of a neighbourhood see a boundary. */
static uint32_t count_boundaries(const boundary_step *step, size_t surfel,
								 const gw_flat_point *kept, uint32_t count)
{
	uint32_t boundaries = step->boundary[surfel] != 0;
	for (uint32_t j = 0; j < count; j++)
		boundaries += step->boundary[kept[j].index] != 0;
	return boundaries;
}

/* What a neighbourhood is like. */
typedef struct likeness {
	double radius, spacing; /* means, of discs */
	double margin;          /* of a boundary */
} likeness;

static likeness describe(const gw_surfels *s, size_t surfel, const gw_flat_point *kept,
						 uint32_t count)
{
	float area[GW_NEIGHBOURS + 1]; /* sorted */
	double nearest = 0, radius = 0, mean_area = 0;
	for (uint32_t j = 0; j <= count; j++) {
		size_t other = j < count ? kept[j].index : surfel;
		uint32_t at = j;
		radius += (double)s->radius[other] / (count + 1);
		mean_area += (double)s->area[other] / (count + 1);
		nearest += (double)s->nearest[other] / (count + 1);
		for (; at > 0 && s->area[other] < area[at - 1]; at--)
			area[at] = area[at - 1];
		area[at] = s->area[other];
	}
	return (likeness){ radius, sqrt(mean_area),
					   fmax(MARGIN * sqrt((double)area[(count + 1) / 2]), 0.5 * nearest) };
}

/* Radius of the circle for a surfel of some reach, and the largest. */
static double circle_of(const likeness *like, double reach, double *widest)
{
	double least = CIRCLE_OF_DISCS * like->radius;
	*widest = fmax(CIRCLE_MOST * like->spacing, least);
	return fmin(fmax(CIRCLE_OF_REACH * reach, least), *widest);
}

static void settle(void *user, size_t surfel, const gw_neighbour_list *list)
{
	boundary_step *step = user;
	gw_surfels *s = step->surfels;
	gw_flat_point kept[GW_NEIGHBOURS];
	surrounding around;
	double noise;
	uint8_t near_boundary = step->boundary[surfel];
	step->area[surfel] = s->area[surfel];
	for (uint32_t j = 0; j < list->count; j++)
		near_boundary |= step->boundary[list->index[j]];
	uint32_t count = near_boundary ? gw_plane_surface(s, surfel, list, kept, &noise) : 0;
	uint32_t boundaries = count_boundaries(step, surfel, kept, count);
	if (count < 3 || boundaries == 0)
		return;
	double reach = kept[count - 1].distance;
	likeness like = describe(s, surfel, kept, count);
	surround(step, surfel, kept, count, &around);
	double circle = circle_of(&like, reach, &around.widest);
	around.reach = reach;
	if (boundaries >= SUPPORT)
		find_boundaries(step, surfel, reach, circle, like.margin, &around);
	gw_plane_store_clips(s, surfel, around.edge, around.edges);
	s->creased[surfel] =
		around.edges > 0 && around.edges == around.creases + around.creases_found &&
		(double)s->noise[surfel] < GW_CREASE_NOISE * (double)list->distance[list->count - 1];
	if (!step->rough_area)
		measure_area(step, surfel, s->clip + 6 * surfel, list, kept, count);
}

/* The sums of boundaries that are alike. */
typedef struct alike {
	double x, y;           /* of directions */
	double foot_x, foot_y; /* of the places nearest to the surfels that see them */
	uint32_t count;
} alike;

/* Adds the boundaries of a surfel that lie like one of `surfel`, both in its plane. */
static void add_alike(const boundary_step *step, size_t surfel, const gw_half_plane *boundary,
					  size_t other, double apart, alike *sum)
{
	const gw_surfels *s = step->surfels;
	float t[3], b[3], u[3], v[3];
	gw_tangent_frame(s->normal + 3 * surfel, t, b);
	gw_tangent_frame(s->normal + 3 * other, u, v);
	for (uint32_t e = 0; e < 2; e++) {
		const float *clip = s->clip + 6 * other + 3 * e;
		double x = 0, y = 0, foot_x = 0, foot_y = 0;
		if (!(step->settled[other] >> e & 1) || clip[2] > BESIDE * s->radius[other])
			continue;
		for (size_t k = 0; k < 3; k++) {
			double way = (double)(clip[0] * u[k] + clip[1] * v[k]);
			double foot = (double)s->position[3 * other + k] - (double)s->position[3 * surfel + k] +
						  way * (double)clip[2];
			x += way * (double)t[k];
			y += way * (double)b[k];
			foot_x += foot * (double)t[k];
			foot_y += foot * (double)b[k];
		}
		if (gw_distance_along(boundary, x, y) < ALIKE ||
			fabs(gw_distance_along(boundary, foot_x, foot_y) - boundary->offset) > apart)
			continue;
		sum->x += x;
		sum->y += y;
		sum->foot_x += foot_x;
		sum->foot_y += foot_y;
		sum->count++;
	}
}

/* Replaces boundaries by the mean of those around that are alike. */
static void agree(void *user, size_t surfel, const gw_neighbour_list *list)
{
	boundary_step *step = user;
	gw_surfels *s = step->surfels;
	gw_flat_point kept[GW_NEIGHBOURS];
	double noise;
	float *clip = step->clip + 6 * surfel;
	memcpy(clip, s->clip + 6 * surfel, 6 * sizeof *clip);
	if (!step->settled[surfel])
		return;
	uint32_t count = gw_plane_surface(s, surfel, list, kept, &noise);
	for (uint32_t e = 0; e < 2; e++) {
		if (!(step->settled[surfel] >> e & 1))
			continue;
		float *own = clip + 3 * e;
		gw_half_plane boundary = { (double)own[0], (double)own[1], (double)own[2] };
		alike sum = { boundary.x, boundary.y, boundary.x * boundary.offset,
					  boundary.y * boundary.offset, 1 };
		double apart = APART * kept[count - 1].distance;
		for (uint32_t j = 0; j < count; j++)
			add_alike(step, surfel, &boundary, kept[j].index, apart, &sum);
		double length = hypot(sum.x, sum.y);
		own[0] = (float)(sum.x / length);
		own[1] = (float)(sum.y / length);
		own[2] = (float)((sum.x * sum.foot_x + sum.y * sum.foot_y) / (length * sum.count));
	}
	if (!step->rough_area)
		measure_area(step, surfel, clip, list, kept, count);
}

gw_status gw_boundaries_settle(gw_neighbours *search, gw_surfels *surfels, bool rough_area,
							   const uint8_t *boundary, gw_error *error)
{
	boundary_step step = {
		.search = search, .surfels = surfels, .boundary = boundary, .rough_area = rough_area
	};
	size_t n = surfels->count;
	step.settled = gw_allocate_zeros(n, sizeof *step.settled);
	step.clip = gw_allocate_array(n, 6 * sizeof *step.clip);
	step.area = gw_allocate_array(n, sizeof *step.area);
	gw_status status = GW_OK;
	if (!step.settled || !step.clip || !step.area)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory for the edges of %zu points", n);
	if (status == GW_OK)
		status = gw_neighbours_visit_reach(search, settle, &step, error);
	if (status == GW_OK)
		status = gw_neighbours_visit_reach(search, agree, &step, error);
	free(step.settled);
	if (status != GW_OK) {
		free(step.clip);
		free(step.area);
		return status;
	}
	free(surfels->clip);
	free(surfels->area);
	surfels->clip = step.clip;
	surfels->area = step.area;
	return GW_OK;
}

/*
 * surfel_disc.c - the piece of surface that each point stands for.
 *
 * Neighbours on the same surface (like normals, near the plane) are projected to the plane of the
 * normal. There the surfel owns its Voronoi cell: cells share the surface out without gap or
 * overlap, so areas add up whatever the distribution of the points. Where another surface crosses
 * the plane in a crease, or the neighbours leave one side empty, the surface ends; the cell and the
 * disc are cut there, at an empty side once more by what surfel_boundaries.c finds. Where it
 * curves, the disc is bent to follow it, so that it does not stick out.
 */
#include "surfels/surfel_disc.h"

#include "base/memory.h"
#include "base/nth_element.h"
#include "cloud/frame.h"
#include "surfels/filled_space.h"
#include "surfels/loose_points.h"
#include "surfels/surfel_crease.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define VOID_STEP 0.75 /* how far behind an edge the surface is looked for, of the reach */
#define VOID_SLOPE 0.7
#define LONE_RADIUS 0.01f    /* metres, of a scene that is one point */
#define STRAY_SEEN 4         /* neighbours that tell */
#define STRAY_CONE 0.95      /* least share of their length that their offsets have in common */
#define STRAY_GAP 30         /* how many times further off than from each other they are */
#define STRAY_JUMP 8.0f      /* how many times further off than the neighbours before them */
#define STRAY_NEAREST 0.475f /* without any before them: how far, of the furthest */
#define BEND_POINTS 6        /* neighbours from which on a bend is looked for */
#define BEND_RIDGE 1e-5      /* keeps neighbours on a line from telling about the other direction */
#define BEND_MOST 0.5        /* slope of a disc's edge against its plane */

/* Neighbours spread at random have a second moment of that little extent across it that seldom:
 * 4 det / tr^2 of n of them is below w with a probability of w^((n - 1) / 2). Lines of a scanner,
 * of which there are several, are wider. */
#define ON_LINE_BY_CHANCE 1e-4
#define LINE_WIDTH 0.01
#define LINE_WIDER 2.0f /* than the median disc, from where on such a disc is none */

/*
 * How little extent in a direction, relative to the furthest neighbour, means that the surface ends
 * there, by number of neighbours: with 16 it is 0.45 (measured: less leaves discs that stick out
 * over edges, more cuts discs inside a surface). For fewer, the extent that as many points, spread
 * evenly over a disc, fall short of with the same probability (1.75 %); at least 0.15.
 */
static const double open_extent[GW_NEIGHBOURS + 1] = {
	0, 0, 0, 0, 0.15, 0.15, 0.15, 0.15, 0.16, 0.22, 0.27, 0.31, 0.34, 0.37, 0.40, 0.43, 0.45,
};

typedef struct disc_step {
	gw_neighbours *search;
	gw_surfels *surfels;
	const gw_lone_points *lone;
	float *gap;        /* NULL or count */
	uint8_t *isolated; /* count, 1 where there is too little surface to measure */
	uint8_t *amid;     /* count, 1 where that is so though others are all around */
	float *on_line;    /* count, half the distance to the next point of its line; 0: is on none */
	uint8_t *boundary; /* count, a bit for each clip that borders on nothing */
	bool measure_noise, rough_area;
} disc_step;

/* What a neighbour's height is made of: its products with a bend are the bent disc's height. */
static void bend_terms(const gw_flat_point *p, double reach, double term[3])
{
	double x = p->x / reach, y = p->y / reach;
	term[0] = 0.5 * x * x;
	term[1] = x * y;
	term[2] = 0.5 * y * y;
}

/* Solves m[.][0..2] x = m[.][3], positive definite, by Gauss-Jordan elimination; x replaces
 * m[.][3].
 */
static void solve_three(double m[3][4])
{
	for (int p = 0; p < 3; p++) {
		for (int r = 0; r < 3; r++) {
			double factor = m[r][p] / m[p][p];
			for (int c = p; c < 4 && r != p; c++)
				m[r][c] -= factor * m[p][c];
		}
		for (int c = 3; c >= p; c--)
			m[p][c] /= m[p][p];
	}
}

/* Sum of squares of what a bend leaves of the neighbours' heights. */
static double unexplained(const gw_flat_point *kept, uint32_t count, const double bend[3])
{
	double sum = 0, reach = kept[count - 1].distance, term[3];
	for (uint32_t j = 0; j < count; j++) {
		bend_terms(kept + j, reach, term);
		double rest = kept[j].height;
		for (int k = 0; k < 3; k++)
			rest -= bend[k] * term[k];
		sum += rest * rest;
	}
	return sum;
}

/*
 * How the surface curves away from the normal's plane: height = (a x^2 + 2 b x y + c y^2) / 2, by
 * least squares over the neighbours. Of what it explains that part is kept which is not noise, as
 * their variances tell.
 */
static void fit_bend(const gw_flat_point *kept, uint32_t count, double radius, float bend[3])
{
	double reach = kept[count - 1].distance, m[3][4] = { 0 }, term[3];
	if (count < BEND_POINTS)
		return;
	for (uint32_t j = 0; j < count; j++) {
		bend_terms(kept + j, reach, term);
		for (int r = 0; r < 3; r++) {
			for (int c = 0; c < 3; c++)
				m[r][c] += term[r] * term[c];
			m[r][3] += term[r] * kept[j].height;
		}
	}
	for (int k = 0; k < 3; k++)
		m[k][k] += BEND_RIDGE * count;
	solve_three(m);
	const double found[3] = { m[0][3], m[1][3], m[2][3] }, none[3] = { 0 };
	double left = unexplained(kept, count, found);
	double signal = (unexplained(kept, count, none) - left) / 3, noise = left / (count - 3);
	if (!(signal > noise))
		return;
	double slope = hypot(hypot(found[0], found[2]), sqrt(2) * found[1]) * radius / reach / reach;
	double share = fmin(1 - noise / signal, BEND_MOST / slope);
	for (int k = 0; k < 3; k++)
		bend[k] = (float)(share * found[k] / reach / reach);
}

/*
 * How far the surface goes on beyond its last point. On average this is half the distance between
 * points: for regular points the distance to the nearest, for random ones the mean distance to the
 * nearest is half a spacing and the last point of an edge a quarter of a spacing from it.
 */
static double edge_margin(const gw_flat_point *kept, double reach)
{
	return fmin(fmax(0.5 * kept[0].distance, 0.06 * reach), 0.25 * reach);
}

/* Do the surface's points lie all around a place in the surfel's plane? */
static bool is_surrounded(const disc_step *step, size_t surfel, double x, double y, double reach)
{
	gw_neighbour_list list;
	gw_flat_point flat[GW_NEIGHBOURS];
	gw_plane_look_at(step->search, step->surfels, surfel, x, y, &list);
	uint32_t count = gw_plane_flatten_level(step->surfels, surfel, &list, reach, flat), seen = 0;
	for (uint32_t j = 0; j < count; j++)
		for (int d = 0; d < GW_DIRECTIONS; d++)
			if (gw_direction[d][0] * (flat[j].x - x) + gw_direction[d][1] * (flat[j].y - y) > 0)
				seen |= 1u << d;
	return seen == (1u << GW_DIRECTIONS) - 1;
}

/*
 * Where points are spread at random they leave voids some three of their spacings wide; to the
 * points around one it looks as if the surface ended there. Is there more of it on the other side?
 *   list   what lies around the void
 */
static bool goes_on(const disc_step *step, size_t surfel, const gw_neighbour_list *list,
					const gw_half_plane *edge, double reach)
{
	gw_flat_point flat[GW_NEIGHBOURS];
	uint32_t count = gw_plane_flatten_level(step->surfels, surfel, list, reach, flat);
	for (uint32_t j = 0; j < count; j++) {
		double ahead = gw_distance_along(edge, flat[j].x, flat[j].y);
		double beside = fabs(edge->x * flat[j].y - edge->y * flat[j].x);
		if (ahead > edge->offset && ahead <= GW_VOID_WIDTH * reach && beside <= VOID_SLOPE * ahead)
			return is_surrounded(step, surfel, 0.5 * flat[j].x, 0.5 * flat[j].y, reach);
	}
	return false;
}

/* The direction, away from the edge that was found, in which the surface's points reach least far.
 * `extent` is theirs in all directions. */
static int find_open_side(const double *extent, const gw_half_plane *edge, uint32_t found)
{
	int best = -1;
	for (int d = 0; d < GW_DIRECTIONS; d++) {
		if (found == 1 &&
			gw_distance_along(edge, gw_direction[d][0], gw_direction[d][1]) > GW_COS_60)
			continue;
		if (best < 0 || extent[d] < extent[best])
			best = d;
	}
	return best;
}

/* Adds half-planes beyond which the surface has no points, up to two with those already found, from
 * which they are turned by 60 degrees or more.
 *   at_creases   how many there are already; those of them that lie at creases, too, are counted,
 *                and for the others bits are set in step->boundary */
static uint32_t find_edges(const disc_step *step, size_t surfel, const gw_flat_point *kept,
						   uint32_t count, gw_half_plane edge[2], uint32_t *at_creases)
{
	uint32_t found = *at_creases;
	double reach = kept[count - 1].distance, extent[GW_DIRECTIONS] = { 0 };
	for (uint32_t j = 0; j < count; j++)
		for (int d = 0; d < GW_DIRECTIONS / 2; d++) {
			double way = gw_direction[d][0] * kept[j].x + gw_direction[d][1] * kept[j].y;
			double *back = extent + GW_DIRECTIONS / 2; /* the opposite directions */
			extent[d] = way > extent[d] ? way : extent[d];
			back[d] = -way > back[d] ? -way : back[d];
		}
	while (found < 2) {
		int d = find_open_side(extent, edge, found);
		gw_half_plane side = { gw_direction[d][0], gw_direction[d][1], extent[d] };
		gw_neighbour_list behind;
		if (!(side.offset < open_extent[count] * reach))
			break;
		gw_plane_look_at(step->search, step->surfels, surfel, VOID_STEP * reach * side.x,
						 VOID_STEP * reach * side.y, &behind);
		if (goes_on(step, surfel, &behind, &side, reach)) {
			extent[d] = reach;
			continue;
		}
		edge[found] = side;
		if (gw_plane_meets_crease(step->surfels, surfel, &behind, edge + found, reach)) {
			(*at_creases)++;
		} else {
			edge[found].offset += edge_margin(kept, reach);
			step->boundary[surfel] |= (uint8_t)(1u << found);
		}
		found++;
	}
	return found;
}

/*
 * How many of the neighbours are near, where all others are far off: they lie in one direction, so
 * far that their distances from each other are nothing to that. A stray point has none near; a few
 * that are together have each other. Points beside a denser patch have some of their own scale
 * around (neighbour_scales.h).
 */
static uint32_t count_near(const gw_surfels *s, size_t surfel, const gw_neighbour_list *list)
{
	float last = list->count ? list->distance[list->count - 1] : 0;
	for (uint32_t near = 0; near + STRAY_SEEN <= list->count; near++) {
		float far = list->distance[near];
		if (near > 0 ? far < STRAY_JUMP * list->distance[near - 1] : far < STRAY_NEAREST * last)
			continue;
		gw_neighbour_list others = { .count = list->count - near };
		memcpy(others.index, list->index + near, others.count * sizeof *others.index);
		memcpy(others.distance, list->distance + near, others.count * sizeof *others.distance);
		if (gw_neighbours_one_sidedness(s, surfel, &others) > STRAY_CONE &&
			(double)far > STRAY_GAP * gw_neighbours_median_gap(s, &others))
			return near;
	}
	return list->count;
}

/* Do neighbours lie on a line with the surfel, as on a wire? Then nothing says how wide the surface
 * is across it. */
static bool lie_on_line(const gw_flat_point *kept, uint32_t count)
{
	double xx = 0, xy = 0, yy = 0;
	for (uint32_t j = 0; j < count; j++) {
		xx += kept[j].x * kept[j].x;
		xy += kept[j].x * kept[j].y;
		yy += kept[j].y * kept[j].y;
	}
	double round = 4 * (xx * yy - xy * xy) / ((xx + yy) * (xx + yy));
	return round < fmin(pow(ON_LINE_BY_CHANCE, 2.0 / (count - 1)), LINE_WIDTH);
}

/* A disc that shares no surface with others. */
static void store_alone(disc_step *step, size_t surfel, float radius)
{
	gw_surfels *s = step->surfels;
	s->radius[surfel] = radius = fmaxf(radius, FLT_MIN);
	s->area[surfel] = fmaxf((float)(M_PI * (double)radius * (double)radius), FLT_MIN);
}

static void store_isolated(disc_step *step, size_t surfel, const gw_neighbour_list *list)
{
	store_alone(step, surfel, list->count ? 0.5f * list->distance[0] : LONE_RADIUS);
	step->isolated[surfel] = 1;
}

static void make_disc(void *user, size_t surfel, const gw_neighbour_list *all)
{
	disc_step *step = user;
	gw_surfels *s = step->surfels;
	gw_neighbour_list near = *all;
	const gw_neighbour_list *list = &near;
	near.count = count_near(s, surfel, all);
	gw_flat_point flat[GW_NEIGHBOURS];
	double noise;
	/* Smoothing may bring points together. */
	s->nearest[surfel] = fmaxf(gw_neighbours_nearest(step->search, surfel, all), FLT_MIN);
	if (step->gap)
		step->gap[surfel] = all->count ? all->distance[0] : INFINITY;

	double reach = list->count ? (double)list->distance[list->count - 1] : 0;
	uint32_t kept = gw_plane_surface(s, surfel, list, flat, &noise);
	if (step->measure_noise)
		s->noise[surfel] = (float)noise;
	if (step->lone->area && step->lone->area[surfel] > 0) {
		store_alone(step, surfel, sqrtf(step->lone->area[surfel] / (float)M_PI));
		return;
	}
	step->amid[surfel] = near.count == GW_NEIGHBOURS;
	if (kept < 3 || !(flat[0].distance > 0)) {
		store_isolated(step, surfel, near.count > 0 ? list : all);
		return;
	}
	if (step->lone->filled[surfel]) {
		store_alone(step, surfel, gw_filled_space_radius(list));
		return;
	}
	gw_half_plane edge[2];
	/* Where the list was widened, half the reach closes the gaps between scan lines that are far
	 * apart. In others it is less than the 8th neighbour's distance but where that is by itself. */
	double radius = flat[kept < GW_DISC_RANK ? kept - 1 : GW_DISC_RANK - 1].distance;
	if (list->complete < list->count)
		radius = fmax(radius, 0.5 * flat[kept - 1].distance);
	uint32_t at_creases = gw_creases_find(s, surfel, list, reach, edge);
	uint32_t edges = find_edges(step, surfel, flat, kept, edge, &at_creases);
	double area = step->rough_area ? M_PI * radius * radius / GW_DISC_RANK
								   : gw_plane_cell_area(flat, kept, radius, reach, edge, edges);
	step->on_line[surfel] = lie_on_line(flat, kept) ? 0.5f * list->distance[0] : 0.0f;
	s->radius[surfel] = fmaxf((float)radius, FLT_MIN);
	s->area[surfel] = fmaxf((float)area, FLT_MIN);
	s->creased[surfel] =
		edges > 0 && edges == at_creases && (double)s->noise[surfel] < GW_CREASE_NOISE * reach;
	fit_bend(flat, kept, radius, s->bend + 3 * surfel);
	gw_plane_store_clips(s, surfel, edge, edges);
}

/* Isolates points on lines whose discs are much wider than is usual. Others may be of a scanner's
 * line at the end of a wall. */
static gw_status isolate_lines(disc_step *step, gw_error *error)
{
	gw_surfels *s = step->surfels;
	float *radius = gw_allocate_array(s->count, sizeof *radius);
	if (!radius)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the widths of %zu points", s->count);
	memcpy(radius, s->radius, s->count * sizeof *radius);
	float usual = s->count > 0 ? gw_nth_element(radius, s->count, s->count / 2) : 0.0f;
	free(radius);
	for (size_t i = 0; i < s->count; i++) {
		if (!(step->on_line[i] > 0.0f) || s->radius[i] <= LINE_WIDER * usual)
			continue;
		store_alone(step, i, step->on_line[i]);
		memset(s->clip + 6 * i, 0, 6 * sizeof *s->clip);
		memset(s->bend + 3 * i, 0, 3 * sizeof *s->bend);
		s->creased[i] = step->boundary[i] = 0;
		step->isolated[i] = 1;
	}
	return GW_OK;
}

/* Leaves whose sides nobody said, or which a beam told. Those that emit light are to be seen as
 * they are. */
static bool is_foliage(const disc_step *step, size_t surfel)
{
	const gw_surfels *s = step->surfels;
	bool told = step->lone->area && step->lone->area[surfel] > 0.0f;
	return step->lone->foliage[surfel] && !step->isolated[surfel] &&
		   (told || s->normals_given < s->count) && !gw_surfel_emits(s, surfel);
}

/* A leaf of an opacity is as much smaller. */
static void make_foliage(gw_surfels *s, size_t surfel)
{
	float larger = (1.0f - s->transparency[surfel]) / (1.0f - GW_FOLIAGE_TRANSPARENCY);
	s->two_sided[surfel] = GW_SIDE_FOLIAGE;
	s->transparency[surfel] = GW_FOLIAGE_TRANSPARENCY;
	s->radius[surfel] = fmaxf(s->radius[surfel] * sqrtf(larger), FLT_MIN);
	s->area[surfel] = fmaxf(s->area[surfel] * larger, FLT_MIN);
}

/* Makes room for it, where there is any. */
static gw_status find_foliage(const disc_step *step, gw_error *error)
{
	gw_surfels *s = step->surfels;
	size_t first = 0;
	while (first < s->count && !is_foliage(step, first))
		first++;
	if (first == s->count || s->transparency)
		return GW_OK;
	s->transparency = gw_allocate_zeros(s->count, sizeof *s->transparency);
	return s->transparency ? GW_OK
						   : gw_fail(error, GW_ERROR_MEMORY,
									 "no memory for the foliage of %zu points", s->count);
}

/* Isolated surfels are no larger than the median of the others. They are lit from both sides, but
 * for those whose normal was given and that have others all around: they lie in creases, and what
 * is behind them is rock. Leaves are lit from both sides, too, unless their sides were given, or
 * turned to the scanner that saw them: what lights the other side is of no use to this one. */
static gw_status finish(disc_step *step, gw_error *error)
{
	gw_surfels *s = step->surfels;
	bool given = s->normals_given == s->count;
	float *width = gw_allocate_array(s->count, sizeof *width);
	size_t measured = 0;
	if (!width)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the spacing of %zu points", s->count);
	for (size_t i = 0; i < s->count; i++)
		if (!step->isolated[i])
			width[measured++] = sqrtf(s->area[i]);
	float median = measured ? gw_nth_element(width, measured, measured / 2) : INFINITY;
	for (size_t i = 0; i < s->count; i++) {
		if (step->isolated[i]) {
			float radius = fminf(s->radius[i], median);
			s->radius[i] = radius;
			s->area[i] = fmaxf((float)(M_PI * (double)radius * (double)radius), FLT_MIN);
			if (!given || !step->amid[i])
				s->two_sided[i] = 1;
		}
		if (step->lone->filled[i] && s->normals_given < s->count && !step->lone->sides_known)
			s->two_sided[i] = 1;
		if (s->transparency && is_foliage(step, i))
			make_foliage(s, i);
		s->given_area += (double)s->area[i];
		width[i] = sqrtf(s->area[i]);
	}
	s->spacing = gw_nth_element(width, s->count, s->count / 2);
	free(width);
	return GW_OK;
}

static gw_status make_discs(disc_step *step, gw_error *error)
{
	gw_surfels *s = step->surfels;
	if (!s->nearest || !s->radius || !s->area || !s->clip || !s->bend || !s->creased || !s->noise ||
		!step->isolated || !step->amid || !step->on_line || !step->boundary)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the discs of %zu points", s->count);
	GW_TRY(gw_neighbours_visit(step->search, make_disc, step, error));
	GW_TRY(isolate_lines(step, error));
	GW_TRY(gw_disc_widths_bound(step->search, s, step->rough_area, error));
	GW_TRY(gw_boundaries_settle(step->search, s, step->rough_area, step->boundary, error));
	GW_TRY(gw_loose_points_bound(step->search, step->lone->filled, s, error));
	GW_TRY(find_foliage(step, error));
	return finish(step, error);
}

gw_status gw_discs_make(gw_neighbours *search, const gw_lone_points *lone, gw_surfels *surfels,
						bool rough_area, float *gap, gw_error *error)
{
	disc_step step = {
		.search = search, .surfels = surfels, .lone = lone, .gap = gap, .rough_area = rough_area
	};
	size_t n = surfels->count;
	surfels->nearest = gw_allocate_array(n, sizeof(float));
	surfels->radius = gw_allocate_array(n, sizeof(float));
	surfels->area = gw_allocate_array(n, sizeof(float));
	surfels->clip = gw_allocate_zeros(n, 6 * sizeof(float));
	surfels->bend = gw_allocate_zeros(n, 3 * sizeof(float));
	surfels->creased = gw_allocate_zeros(n, sizeof *surfels->creased);
	step.measure_noise = !surfels->noise;
	if (step.measure_noise)
		surfels->noise = gw_allocate_array(n, sizeof(float));
	step.isolated = gw_allocate_zeros(n, sizeof *step.isolated);
	step.amid = gw_allocate_zeros(n, sizeof *step.amid);
	step.on_line = gw_allocate_zeros(n, sizeof *step.on_line);
	step.boundary = gw_allocate_zeros(n, sizeof *step.boundary);
	gw_status status = make_discs(&step, error);
	free(step.isolated);
	free(step.amid);
	free(step.on_line);
	free(step.boundary);
	return status;
}

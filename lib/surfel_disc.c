/*
 * surfel_disc.c - the piece of surface that each point stands for; see surfel_steps.h.
 *
 * Neighbours on the same surface (like normals, near the plane) are projected to the plane of the
 * normal. There the surfel owns its Voronoi cell: cells share the surface out without gap or
 * overlap, so areas add up whatever the distribution of the points. Where another surface crosses
 * the plane in a crease, or the neighbours leave one side empty, the surface ends; the cell and the
 * disc are cut there. Where it curves, the disc is bent to follow it, so that it does not stick
 * out.
 */
#include "surfel_steps.h"

#include "memory.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define DIRECTIONS 16    /* in which the neighbours' extent is looked at */
#define DISC_RANK 8      /* the disc reaches to this neighbour on the surface */
#define SAME_SURFACE 0.6 /* least cosine between normals */
#define SLAB 0.35        /* half thickness of the plane, in distances of the furthest neighbour */
#define SLAB_MAX 0.8     /* the same with noise */
#define VOID_STEP 0.75   /* how far behind an edge the surface is looked for, of the reach */
#define VOID_WIDTH 1.8   /* most width of a void, of the reach */
#define VOID_SLOPE 0.7
#define FIT_SLAB 0.6      /* half thickness within which noise is measured */
#define CREASE_VOTES 3    /* neighbours that have to agree on a crease */
#define CREASE_NOISE 0.02 /* of the reach, up to which planes tell where their crease is */
#define CREASE_DOUBT 0.1  /* by how much a point may lie on the wrong side, of the reach */
#define LONE_RADIUS 0.01f /* metres, of a scene that is one point */
#define COS_60 0.5001     /* a little more, so that 60 degrees are enough */
#define BEND_POINTS 6     /* neighbours from which on a bend is looked for */
#define BEND_RIDGE 1e-5   /* keeps neighbours on a line from telling about the other direction */
#define BEND_MOST 0.5     /* slope of a disc's rim against its plane */
/* Cells end at this share of the distance of the furthest neighbour. A corner further out than half
 * of it may be nearer to a point that is no neighbour: without this limit cells of random points
 * overlap by 0.6 % of their area, and all that emits is as much too bright. With it they add up to
 * the surface's; those of regular points and of lines do not get as far. */
#define CELL_REACH 0.59
#define CORNERS 34 /* of a cell: DIRECTIONS, and one more for each of 16 + 2 cuts */

static const double pi = 3.14159265358979323846;

/* Cosine and sine of the directions. */
static const double direction_x[DIRECTIONS] = {
	1,  0.92387953251128674,  0.70710678118654752,  0.38268343236508977,
	0,  -0.38268343236508977, -0.70710678118654752, -0.92387953251128674,
	-1, -0.92387953251128674, -0.70710678118654752, -0.38268343236508977,
	0,  0.38268343236508977,  0.70710678118654752,  0.92387953251128674,
};
static const double direction_y[DIRECTIONS] = {
	0,  0.38268343236508977,  0.70710678118654752,  0.92387953251128674,
	1,  0.92387953251128674,  0.70710678118654752,  0.38268343236508977,
	0,  -0.38268343236508977, -0.70710678118654752, -0.92387953251128674,
	-1, -0.92387953251128674, -0.70710678118654752, -0.38268343236508977,
};

/*
 * How little extent in a direction, relative to the furthest neighbour, means that the surface ends
 * there, by number of neighbours: with 16 it is 0.45 (measured: less leaves discs that stick out
 * over edges, more cuts discs inside a surface). For fewer, the extent that as many points, spread
 * evenly over a disc, fall short of with the same probability (1.75 %); at least 0.15.
 */
static const double open_extent[GW_NEIGHBOURS + 1] = {
	0, 0, 0, 0, 0.15, 0.15, 0.15, 0.15, 0.16, 0.22, 0.27, 0.31, 0.34, 0.37, 0.40, 0.43, 0.45,
};

/* A neighbour in the plane of the surfel's normal. */
typedef struct flat_point {
	double x, y, height; /* along tangent, bitangent, normal, metres */
	double distance;     /* in the plane */
} flat_point;

typedef struct half_plane {
	double x, y, offset; /* unit direction; inside is x u + y v <= offset */
} half_plane;

/* Where the surfel's plane meets other surfaces: one line a neighbour on such a surface. */
typedef struct crease_lines {
	half_plane line[GW_NEIGHBOURS];
	uint32_t count;
} crease_lines;

typedef struct disc_step {
	gw_neighbours *search;
	gw_surfels *surfels;
	float *gap;        /* NULL or count */
	uint8_t *isolated; /* count, 1 where there is too little surface to measure */
	bool measure_noise, rough_area;
} disc_step;

/* Neighbours with a normal like the surfel's; unoriented normals may be opposite. */
static uint32_t flatten(const gw_surfels *s, size_t surfel, const gw_neighbour_list *list,
						flat_point *flat)
{
	const float *n = s->normal + 3 * surfel;
	float t[3], b[3];
	uint32_t count = 0;
	gw_tangent_frame(n, t, b);
	for (uint32_t j = 0; j < list->count; j++) {
		size_t other = list->index[j];
		const float *m = s->normal + 3 * other;
		double cosine = (double)(n[0] * m[0] + n[1] * m[1] + n[2] * m[2]);
		if (s->two_sided[surfel] || s->two_sided[other])
			cosine = fabs(cosine);
		if (!(cosine > SAME_SURFACE))
			continue;
		flat_point p = { 0, 0, 0, 0 };
		for (size_t k = 0; k < 3; k++) {
			double d = (double)s->position[3 * other + k] - (double)s->position[3 * surfel + k];
			p.x += d * (double)t[k];
			p.y += d * (double)b[k];
			p.height += d * (double)n[k];
		}
		p.distance = sqrt(p.x * p.x + p.y * p.y);
		flat[count++] = p;
	}
	return count;
}

/*
 * The line in the surfel's plane where that of a neighbour on another surface crosses it. In a
 * concave crease each point lies in front of the other's plane, in a convex one behind it; where
 * the two disagree by more than doubt allows, the surfaces do not meet there.
 */
static bool find_crease(const gw_surfels *s, size_t surfel, size_t other, double reach,
						half_plane *line)
{
	const float *n = s->normal + 3 * surfel, *m = s->normal + 3 * other;
	float t[3], b[3];
	double cosine = 0, x = 0, y = 0, ahead = 0, facing = 0;
	gw_tangent_frame(n, t, b);
	for (size_t k = 0; k < 3; k++) {
		double d = (double)s->position[3 * other + k] - (double)s->position[3 * surfel + k];
		cosine += (double)(n[k] * m[k]);
		x += (double)(m[k] * t[k]);
		y += (double)(m[k] * b[k]);
		ahead += (double)n[k] * d;
		facing -= (double)m[k] * d;
	}
	if (fabs(cosine) > SAME_SURFACE || s->two_sided[surfel] || s->two_sided[other])
		return false;
	double side = ahead + facing < 0 ? -1 : 1, slope = sqrt(x * x + y * y);
	if (fmin(side * ahead, side * facing) < -CREASE_DOUBT * reach)
		return false;
	*line = (half_plane){ -side * x / slope, -side * y / slope, fmax(side * facing, 0) / slope };
	return line->offset < reach;
}

static void find_creases(const gw_surfels *s, size_t surfel, const gw_neighbour_list *list,
						 double reach, crease_lines *creases)
{
	creases->count = 0;
	for (uint32_t j = 0; j < list->count; j++)
		creases->count +=
			find_crease(s, surfel, list->index[j], reach, creases->line + creases->count);
}

/* Sums of a least-squares plane height = c + a x + b y. */
typedef struct plane_fit {
	double n, x, y, xx, xy, yy, h, hx, hy, hh;
} plane_fit;

static void add_to_fit(plane_fit *fit, const flat_point *p)
{
	fit->n += 1;
	fit->x += p->x;
	fit->y += p->y;
	fit->xx += p->x * p->x;
	fit->xy += p->x * p->y;
	fit->yy += p->y * p->y;
	fit->h += p->height;
	fit->hx += p->height * p->x;
	fit->hy += p->height * p->y;
	fit->hh += p->height * p->height;
}

/*
 * Tilt of the neighbours' plane against the normal, and their RMS distance from it; three degrees
 * of freedom are the plane's own. Without enough neighbours, or when they lie on a line, the plane
 * is the normal's.
 */
static double measure_noise(const flat_point *flat, uint32_t count, double reach, double tilt[2])
{
	plane_fit f = { .n = 1 }; /* the surfel itself, at 0 */
	for (uint32_t j = 0; j < count; j++)
		if (fabs(flat[j].height) <= FIT_SLAB * reach)
			add_to_fit(&f, flat + j);
	tilt[0] = tilt[1] = 0;
	if (f.n < 6)
		return 0;
	double xx = f.xx - f.x * f.x / f.n, yy = f.yy - f.y * f.y / f.n, xy = f.xy - f.x * f.y / f.n;
	double hx = f.hx - f.h * f.x / f.n, hy = f.hy - f.h * f.y / f.n, hh = f.hh - f.h * f.h / f.n;
	double determinant = xx * yy - xy * xy;
	if (!(determinant > 1e-3 * (xx + yy) * (xx + yy)))
		return sqrt(fmax(hh, 0) / (f.n - 1));
	double a = (hx * yy - hy * xy) / determinant, b = (hy * xx - hx * xy) / determinant;
	if (a * a + b * b > 1)
		return sqrt(fmax(hh, 0) / (f.n - 1));
	tilt[0] = a;
	tilt[1] = b;
	double rest = hh - a * hx - b * hy;
	return sqrt(fmax(rest, 0) / ((f.n - 3) * (1 + a * a + b * b)));
}

/* What a neighbour's height is made of: its products with a bend are the bent disc's height. */
static void bend_terms(const flat_point *p, double reach, double term[3])
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
static double unexplained(const flat_point *kept, uint32_t count, const double bend[3])
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
static void fit_bend(const flat_point *kept, uint32_t count, double radius, float bend[3])
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
	double rim = hypot(hypot(found[0], found[2]), sqrt(2) * found[1]) * radius / reach / reach;
	double share = fmin(1 - noise / signal, BEND_MOST / rim);
	for (int k = 0; k < 3; k++)
		bend[k] = (float)(share * found[k] / reach / reach);
}

/* Keeps the neighbours near the plane, nearest in the plane first; returns how many. */
static uint32_t keep_surface(flat_point *flat, uint32_t count, double slab, const double tilt[2])
{
	uint32_t kept = 0;
	for (uint32_t j = 0; j < count; j++) {
		flat_point p = flat[j];
		if (fabs(p.height - tilt[0] * p.x - tilt[1] * p.y) > slab)
			continue;
		uint32_t at = kept++;
		for (; at > 0 && p.distance < flat[at - 1].distance; at--)
			flat[at] = flat[at - 1];
		flat[at] = p;
	}
	return kept;
}

/*
 * How far the surface goes on beyond its last point. On average this is half the distance between
 * points: for regular points the distance to the nearest, for random ones the mean distance to the
 * nearest is half a spacing and the last point of an edge a quarter of a spacing from it.
 */
static double edge_margin(const flat_point *kept, double reach)
{
	return fmin(fmax(0.5 * kept[0].distance, 0.06 * reach), 0.25 * reach);
}

static double along(const half_plane *h, double x, double y)
{
	return h->x * x + h->y * y;
}

/* The mean of the lines that agree with the nearest one, which are then taken off the list. */
static uint32_t merge_lines(crease_lines *creases, double reach, half_plane *mean)
{
	uint32_t left = 0, votes = 0;
	half_plane nearest = creases->line[0];
	*mean = (half_plane){ 0, 0, 0 };
	for (uint32_t j = 1; j < creases->count; j++)
		if (creases->line[j].offset < nearest.offset)
			nearest = creases->line[j];
	for (uint32_t j = 0; j < creases->count; j++) {
		half_plane line = creases->line[j];
		if (along(&nearest, line.x, line.y) < 0.7 || line.offset - nearest.offset > 0.35 * reach) {
			creases->line[left++] = line;
			continue;
		}
		votes++;
		mean->x += line.x;
		mean->y += line.y;
		mean->offset += line.offset;
	}
	creases->count = left;
	double length = hypot(mean->x, mean->y);
	*mean = (half_plane){ mean->x / length, mean->y / length, mean->offset / votes };
	return votes;
}

/* At most two creases, the nearest ones on which enough neighbours agree. */
static uint32_t take_creases(crease_lines *creases, double reach, half_plane edge[2])
{
	uint32_t found = 0;
	while (creases->count > 0 && found < 2) {
		if (merge_lines(creases, reach, edge + found) >= CREASE_VOTES)
			found++;
	}
	return found;
}

/* The surfels nearest to a place in the surfel's plane. */
static void look_at(const disc_step *step, size_t surfel, double x, double y,
					gw_neighbour_list *list)
{
	const gw_surfels *s = step->surfels;
	double place[3];
	float t[3], b[3];
	gw_tangent_frame(s->normal + 3 * surfel, t, b);
	for (size_t k = 0; k < 3; k++)
		place[k] = (double)s->position[3 * surfel + k] + x * (double)t[k] + y * (double)b[k];
	gw_neighbours_at(step->search, place, list);
}

/* Do the surface's points lie all around a place in the surfel's plane? */
static bool is_surrounded(const disc_step *step, size_t surfel, double x, double y)
{
	gw_neighbour_list list;
	flat_point flat[GW_NEIGHBOURS];
	look_at(step, surfel, x, y, &list);
	uint32_t count = flatten(step->surfels, surfel, &list, flat), seen = 0;
	for (uint32_t j = 0; j < count; j++)
		for (int d = 0; d < DIRECTIONS; d++)
			if (direction_x[d] * (flat[j].x - x) + direction_y[d] * (flat[j].y - y) > 0)
				seen |= 1u << d;
	return seen == (1u << DIRECTIONS) - 1;
}

/*
 * Where points are spread at random they leave voids some three of their spacings wide; to the
 * points around one it looks as if the surface ended there. Is there more of it on the other side?
 *   list   what lies around the void
 */
static bool goes_on(const disc_step *step, size_t surfel, const gw_neighbour_list *list,
					const half_plane *edge, double reach)
{
	flat_point flat[GW_NEIGHBOURS];
	uint32_t count = flatten(step->surfels, surfel, list, flat);
	for (uint32_t j = 0; j < count; j++) {
		double ahead = along(edge, flat[j].x, flat[j].y);
		double beside = fabs(edge->x * flat[j].y - edge->y * flat[j].x);
		if (ahead > edge->offset && ahead <= VOID_WIDTH * reach && beside <= VOID_SLOPE * ahead)
			return is_surrounded(step, surfel, 0.5 * flat[j].x, 0.5 * flat[j].y);
	}
	return false;
}

/* Does the surface end where it meets another one behind such a void? Then that is its edge. */
static bool meets_crease(const disc_step *step, size_t surfel, const gw_neighbour_list *list,
						 half_plane *edge, double reach)
{
	crease_lines creases;
	half_plane line;
	find_creases(step->surfels, surfel, list, VOID_WIDTH * reach, &creases);
	while (creases.count > 0)
		if (merge_lines(&creases, reach, &line) >= CREASE_VOTES &&
			along(edge, line.x, line.y) > 0.7 && line.offset > edge->offset) {
			*edge = line;
			return true;
		}
	return false;
}

/* The direction, away from the edge that was found, in which the surface's points reach least far.
 * `extent` is theirs in all directions. */
static int find_open_side(const double *extent, const half_plane *edge, uint32_t found)
{
	int best = -1;
	for (int d = 0; d < DIRECTIONS; d++) {
		if (found == 1 && along(edge, direction_x[d], direction_y[d]) > COS_60)
			continue;
		if (best < 0 || extent[d] < extent[best])
			best = d;
	}
	return best;
}

/* Adds half-planes beyond which the surface has no points, up to two with those already found, from
 * which they are turned by 60 degrees or more.
 *   at_creases   how many there are already; those of them that lie at creases, too, are counted */
static uint32_t find_edges(const disc_step *step, size_t surfel, const flat_point *kept,
						   uint32_t count, half_plane edge[2], uint32_t *at_creases)
{
	uint32_t found = *at_creases;
	double reach = kept[count - 1].distance, extent[DIRECTIONS] = { 0 };
	for (uint32_t j = 0; j < count; j++)
		for (int d = 0; d < DIRECTIONS / 2; d++) {
			double way = direction_x[d] * kept[j].x + direction_y[d] * kept[j].y;
			double *back = extent + DIRECTIONS / 2; /* the opposite directions */
			extent[d] = way > extent[d] ? way : extent[d];
			back[d] = -way > back[d] ? -way : back[d];
		}
	while (found < 2) {
		int d = find_open_side(extent, edge, found);
		half_plane side = { direction_x[d], direction_y[d], extent[d] };
		gw_neighbour_list behind;
		if (!(side.offset < open_extent[count] * reach))
			break;
		look_at(step, surfel, VOID_STEP * reach * side.x, VOID_STEP * reach * side.y, &behind);
		if (goes_on(step, surfel, &behind, &side, reach)) {
			extent[d] = reach;
			continue;
		}
		edge[found] = side;
		if (meets_crease(step, surfel, &behind, edge + found, reach))
			(*at_creases)++;
		else
			edge[found].offset += edge_margin(kept, reach);
		found++;
	}
	return found;
}

/* Cuts a convex polygon by a half-plane; returns its number of corners. */
static int cut_polygon(double (*corner)[2], int count, const half_plane *h)
{
	double cut[2 * CORNERS][2]; /* rounding may add corners to thin slivers */
	int left = 0;
	for (int i = 0; i < count; i++) {
		const double *a = corner[i], *b = corner[(i + 1) % count];
		double over_a = h->x * a[0] + h->y * a[1] - h->offset;
		double over_b = h->x * b[0] + h->y * b[1] - h->offset;
		if (over_a <= 0) {
			cut[left][0] = a[0];
			cut[left++][1] = a[1];
		}
		if ((over_a < 0 && over_b > 0) || (over_a > 0 && over_b < 0)) {
			double at = over_a / (over_a - over_b);
			cut[left][0] = a[0] + at * (b[0] - a[0]);
			cut[left++][1] = a[1] + at * (b[1] - a[1]);
		}
	}
	if (left > CORNERS)
		left = CORNERS;
	memcpy(corner, cut, (size_t)left * sizeof *cut);
	return left;
}

static double polygon_radius(double (*corner)[2], int count)
{
	double squared = 0;
	for (int i = 0; i < count; i++) {
		double own = corner[i][0] * corner[i][0] + corner[i][1] * corner[i][1];
		squared = own > squared ? own : squared;
	}
	return sqrt(squared);
}

/* Area of the Voronoi cell, within the disc, the edges and where the furthest neighbour, `reach`
 * away, lets it be known. */
static double cell_area(const flat_point *kept, uint32_t count, double radius, double reach,
						const half_plane *edge, uint32_t edges)
{
	double corner[CORNERS][2], area = 0;
	/* A regular polygon of the disc's area: n/2 sin(2 pi/n) R^2 = pi r^2, for 16 corners. */
	double outer = 1.0130112 * fmin(radius, CELL_REACH * reach);
	int corners = DIRECTIONS;
	for (int d = 0; d < DIRECTIONS; d++) {
		corner[d][0] = outer * direction_x[d];
		corner[d][1] = outer * direction_y[d];
	}
	for (uint32_t e = 0; e < edges; e++)
		corners = cut_polygon(corner, corners, edge + e);
	for (uint32_t j = 0; j < count; j++) {
		if (0.5 * kept[j].distance >= polygon_radius(corner, corners))
			break;
		if (!(kept[j].distance > 0))
			continue;
		half_plane bisector = { kept[j].x / kept[j].distance, kept[j].y / kept[j].distance,
								0.5 * kept[j].distance };
		corners = cut_polygon(corner, corners, &bisector);
	}
	for (int i = 0; i < corners; i++) {
		const double *a = corner[i], *b = corner[(i + 1) % corners];
		area += 0.5 * (a[0] * b[1] - a[1] * b[0]);
	}
	return area;
}

static void store_isolated(disc_step *step, size_t surfel, const gw_neighbour_list *list)
{
	gw_surfels *s = step->surfels;
	float radius = list->count ? fmaxf(0.5f * list->distance[0], FLT_MIN) : LONE_RADIUS;
	s->radius[surfel] = radius;
	s->area[surfel] = fmaxf((float)(pi * (double)radius * (double)radius), FLT_MIN);
	step->isolated[surfel] = 1;
}

static void make_disc(void *user, size_t surfel, const gw_neighbour_list *list)
{
	disc_step *step = user;
	gw_surfels *s = step->surfels;
	flat_point flat[GW_NEIGHBOURS];
	double tilt[2];
	/* Smoothing may bring points together. */
	s->nearest[surfel] = fmaxf(gw_neighbours_nearest(step->search, surfel, list), FLT_MIN);
	if (step->gap)
		step->gap[surfel] = list->count ? list->distance[0] : INFINITY;

	double reach = list->count ? (double)list->distance[list->count - 1] : 0;
	uint32_t count = flatten(s, surfel, list, flat);
	double noise = measure_noise(flat, count, reach, tilt);
	double slab = fmin(SLAB * reach + 2 * noise, SLAB_MAX * reach);
	uint32_t kept = keep_surface(flat, count, slab, tilt);
	if (step->measure_noise)
		s->noise[surfel] = (float)noise;
	if (kept < 3 || !(flat[0].distance > 0)) {
		store_isolated(step, surfel, list);
		return;
	}
	half_plane edge[2];
	/* Half the reach is less than the 8th neighbour's distance but where scan lines are far apart:
	 * there it closes the gaps between them. */
	double radius = flat[kept < DISC_RANK ? kept - 1 : DISC_RANK - 1].distance;
	radius = fmax(radius, 0.5 * flat[kept - 1].distance);
	crease_lines creases;
	find_creases(s, surfel, list, reach, &creases);
	uint32_t at_creases = take_creases(&creases, reach, edge);
	uint32_t edges = find_edges(step, surfel, flat, kept, edge, &at_creases);
	double area = step->rough_area ? pi * radius * radius / DISC_RANK
								   : cell_area(flat, kept, radius, reach, edge, edges);
	s->radius[surfel] = fmaxf((float)radius, FLT_MIN);
	s->area[surfel] = fmaxf((float)area, FLT_MIN);
	s->creased[surfel] =
		edges > 0 && edges == at_creases && (double)s->noise[surfel] < CREASE_NOISE * reach;
	fit_bend(flat, kept, radius, s->bend + 3 * surfel);
	for (uint32_t e = 0; e < edges; e++) {
		s->clip[6 * surfel + 3 * e] = (float)edge[e].x;
		s->clip[6 * surfel + 3 * e + 1] = (float)edge[e].y;
		s->clip[6 * surfel + 3 * e + 2] = (float)edge[e].offset;
	}
}

/* Isolated surfels are lit from both sides and no larger than the median of the others. */
static gw_status finish(disc_step *step, gw_error *error)
{
	gw_surfels *s = step->surfels;
	float *width = gw_allocate_array(s->count, sizeof *width);
	size_t measured = 0;
	if (!width)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the spacing of %zu points", s->count);
	for (size_t i = 0; i < s->count; i++)
		if (!step->isolated[i])
			width[measured++] = sqrtf(s->area[i]);
	float median = measured ? gw_rank_float(width, measured, measured / 2) : INFINITY;
	for (size_t i = 0; i < s->count; i++) {
		if (step->isolated[i]) {
			float radius = fminf(s->radius[i], median);
			s->radius[i] = radius;
			s->area[i] = fmaxf((float)(pi * (double)radius * (double)radius), FLT_MIN);
			s->two_sided[i] = 1;
		}
		s->given_area += (double)s->area[i];
		width[i] = sqrtf(s->area[i]);
	}
	s->spacing = gw_rank_float(width, s->count, s->count / 2);
	free(width);
	return GW_OK;
}

gw_status gw_discs_make(gw_neighbours *search, gw_surfels *surfels, bool rough_area, float *gap,
						gw_error *error)
{
	disc_step step = { .search = search, .surfels = surfels, .gap = gap, .rough_area = rough_area };
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
	gw_status status = GW_OK;
	if (!surfels->nearest || !surfels->radius || !surfels->area || !surfels->clip ||
		!surfels->bend || !surfels->creased || !surfels->noise || !step.isolated)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory for the discs of %zu points", n);
	if (status == GW_OK)
		status = gw_neighbours_visit(search, make_disc, &step, error);
	if (status == GW_OK)
		status = finish(&step, error);
	free(step.isolated);
	return status;
}

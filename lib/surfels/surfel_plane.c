/* surfel_plane.c - see surfel_plane.h. */
#include "surfels/surfel_plane.h"

#include <math.h>
#include <string.h>

#define SLAB 0.35    /* half thickness of the plane, in distances of the furthest neighbour */
#define SLAB_MAX 0.8 /* the same with noise */
#define FIT_SLAB 0.6 /* half thickness within which noise is measured */
/* Cells end at this share of the distance of the furthest neighbour. A corner further out than half
 * of it may be nearer to a point that is no neighbour: without this limit cells of random points
 * overlap by 0.6 % of their area, and all that emits is as much too bright. With it they add up to
 * the surface's; those of regular points and of lines do not get as far. */
#define CELL_REACH 0.59
#define CORNERS 34 /* of a cell: GW_DIRECTIONS, and one more for each of 16 + 2 cuts */

const double gw_direction[GW_DIRECTIONS][2] = {
	{ 1, 0 },
	{ 0.92387953251128674, 0.38268343236508977 },
	{ 0.70710678118654752, 0.70710678118654752 },
	{ 0.38268343236508977, 0.92387953251128674 },
	{ 0, 1 },
	{ -0.38268343236508977, 0.92387953251128674 },
	{ -0.70710678118654752, 0.70710678118654752 },
	{ -0.92387953251128674, 0.38268343236508977 },
	{ -1, 0 },
	{ -0.92387953251128674, -0.38268343236508977 },
	{ -0.70710678118654752, -0.70710678118654752 },
	{ -0.38268343236508977, -0.92387953251128674 },
	{ 0, -1 },
	{ 0.38268343236508977, -0.92387953251128674 },
	{ 0.70710678118654752, -0.70710678118654752 },
	{ 0.92387953251128674, -0.38268343236508977 },
};

uint32_t gw_plane_flatten(const gw_surfels *s, size_t surfel, const gw_neighbour_list *list,
						  gw_flat_point *flat)
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
		if (!(cosine > GW_SAME_SURFACE))
			continue;
		gw_flat_point p = { .index = list->index[j] };
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

/* How far off the plane a neighbour may be because the surface is bent: an arc ends off its tangent
 * by the distance times the tangent of half the angle between the normals. Twice that, since bends
 * are not even. */
static double bent_off(const gw_surfels *s, size_t surfel, const gw_flat_point *p)
{
	const float *n = s->normal + 3 * surfel, *m = s->normal + 3 * (size_t)p->index;
	double cosine = fabs((double)(n[0] * m[0] + n[1] * m[1] + n[2] * m[2]));
	return 2.0 * p->distance * sqrt(fmax(1.0 - cosine, 0.0) / (1.0 + cosine));
}

uint32_t gw_plane_flatten_level(const gw_surfels *s, size_t surfel, const gw_neighbour_list *list,
								double reach, gw_flat_point *flat)
{
	uint32_t count = gw_plane_flatten(s, surfel, list, flat), level = 0;
	for (uint32_t j = 0; j < count; j++)
		if (fabs(flat[j].height) <= FIT_SLAB * reach + bent_off(s, surfel, &flat[j]))
			flat[level++] = flat[j];
	return level;
}

/* Sums of a least-squares plane height = c + a x + b y. */
typedef struct plane_fit {
	double n, x, y, xx, xy, yy, h, hx, hy, hh;
} plane_fit;

static void add_to_fit(plane_fit *fit, const gw_flat_point *p)
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
static double measure_noise(const gw_flat_point *flat, uint32_t count, double reach, double tilt[2])
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

/* Keeps the neighbours near the plane, nearest in the plane first; returns how many. */
static uint32_t keep_surface(gw_flat_point *flat, uint32_t count, double slab, const double tilt[2])
{
	uint32_t kept = 0;
	for (uint32_t j = 0; j < count; j++) {
		gw_flat_point p = flat[j];
		if (fabs(p.height - tilt[0] * p.x - tilt[1] * p.y) > slab)
			continue;
		uint32_t at = kept++;
		for (; at > 0 && p.distance < flat[at - 1].distance; at--)
			flat[at] = flat[at - 1];
		flat[at] = p;
	}
	return kept;
}

uint32_t gw_plane_surface(const gw_surfels *s, size_t surfel, const gw_neighbour_list *list,
						  gw_flat_point *flat, double *noise)
{
	double reach = list->count ? (double)list->distance[list->count - 1] : 0, tilt[2];
	uint32_t count = gw_plane_flatten(s, surfel, list, flat);
	*noise = measure_noise(flat, count, reach, tilt);
	return keep_surface(flat, count, fmin(SLAB * reach + 2 * *noise, SLAB_MAX * reach), tilt);
}

void gw_plane_look_at(gw_neighbours *search, const gw_surfels *s, size_t surfel, double x, double y,
					  gw_neighbour_list *list)
{
	double place[3];
	float t[3], b[3];
	gw_tangent_frame(s->normal + 3 * surfel, t, b);
	for (size_t k = 0; k < 3; k++)
		place[k] = (double)s->position[3 * surfel + k] + x * (double)t[k] + y * (double)b[k];
	gw_neighbours_at(search, place, list);
}

/* Cuts a convex polygon by a half-plane; returns its number of corners. */
static int cut_polygon(double (*corner)[2], int count, const gw_half_plane *h)
{
	double cut[2 * CORNERS][2]; /* rounding may add corners to thin slivers */
	double over[CORNERS + 1];
	bool any = false;
	int left = 0;
	for (int i = 0; i < count; i++) {
		over[i] = h->x * corner[i][0] + h->y * corner[i][1] - h->offset;
		any |= !(over[i] <= 0);
	}
	if (!any)
		return count;
	over[count] = over[0];
	for (int i = 0; i < count; i++) {
		const double *a = corner[i], *b = corner[i + 1 < count ? i + 1 : 0];
		double over_a = over[i], over_b = over[i + 1];
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

double gw_plane_cell_area(const gw_flat_point *kept, uint32_t count, double radius, double reach,
						  const gw_half_plane *edge, uint32_t edges)
{
	double corner[CORNERS][2], area = 0;
	/* A regular polygon of the disc's area: n/2 sin(2 pi/n) R^2 = pi r^2, for 16 corners. */
	double outer = 1.0130112 * fmin(radius, CELL_REACH * reach);
	int corners = GW_DIRECTIONS;
	for (int d = 0; d < GW_DIRECTIONS; d++) {
		corner[d][0] = outer * gw_direction[d][0];
		corner[d][1] = outer * gw_direction[d][1];
	}
	for (uint32_t e = 0; e < edges; e++)
		corners = cut_polygon(corner, corners, edge + e);
	for (uint32_t j = 0; j < count; j++) {
		if (0.5 * kept[j].distance >= polygon_radius(corner, corners))
			break;
		if (!(kept[j].distance > 0))
			continue;
		gw_half_plane bisector = { kept[j].x / kept[j].distance, kept[j].y / kept[j].distance,
								   0.5 * kept[j].distance };
		corners = cut_polygon(corner, corners, &bisector);
	}
	for (int i = 0; i < corners; i++) {
		const double *a = corner[i], *b = corner[(i + 1) % corners];
		area += 0.5 * (a[0] * b[1] - a[1] * b[0]);
	}
	return area;
}

void gw_plane_store_clips(gw_surfels *s, size_t surfel, const gw_half_plane *edge, uint32_t edges)
{
	float *clip = s->clip + 6 * surfel;
	memset(clip, 0, 6 * sizeof *clip);
	for (uint32_t e = 0; e < edges; e++) {
		clip[3 * e] = (float)edge[e].x;
		clip[3 * e + 1] = (float)edge[e].y;
		clip[3 * e + 2] = (float)edge[e].offset;
	}
}

uint32_t gw_plane_load_clips(const gw_surfels *s, size_t surfel, gw_half_plane edge[2])
{
	const float *clip = s->clip + 6 * surfel;
	uint32_t edges = 0;
	for (uint32_t e = 0; e < 2; e++, clip += 3)
		if (clip[0] != 0 || clip[1] != 0)
			edge[edges++] = (gw_half_plane){ (double)clip[0], (double)clip[1], (double)clip[2] };
	return edges;
}

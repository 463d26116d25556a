/*
 * probe_look.c - see probe_look.h, and gw_probes_look of glowworm_probes.h.
 */
#include "light/probe_look.h"

#include "light/octahedral.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* How far a ray goes, in lengths of all that a probe sees: in the map, to its own direction. */
#define ENDLESS 1e6

/* Share of a way across an octant by which a step goes into the next texel. */
#define NUDGE 1e-7

/* Texels by which a ray may be behind a plane and still meet it: planes of texels beside each other
 * do not close. */
#define CRACK 2.0

typedef enum outcome { LOOK_MET, LOOK_LOST, LOOK_OPEN } outcome;

/* A ray as a probe sees it. */
typedef struct ray {
	const gw_probes *probes;
	size_t probe;
	double from[3], way[3]; /* metres, from the probe; unit */
	double last;            /* metres along it: where it ends */
	int top;                /* level of the smallest map that is used; 0: the largest */
	gw_probe_texel *look;
} ray;

/* A piece of a ray within one octant, a straight line on the map. */
typedef struct piece {
	double sign[3];
	double first, last;     /* metres along the ray */
	double norm[2];         /* |x| + |y| + |z| at both ends */
	double start[2], to[2]; /* place on the map, in texels of the largest one; to: relative */
} piece;

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void at(const ray *r, double t, double place[3])
{
	for (int k = 0; k < 3; k++)
		place[k] = r->from[k] + t * r->way[k];
}

static double radius_at(const ray *r, double t)
{
	double place[3];
	at(r, t, place);
	return sqrt(dot(place, place));
}

/* Where a place within the octant of a piece lies on the map, in texels. Returns its norm. */
static double project(const ray *r, const double sign[3], double t, double texel[2])
{
	double place[3], uv[2];
	at(r, t, place);
	const double norm = fmax(dot(sign, place), 1e-300);
	for (int k = 0; k < 2; k++)
		uv[k] =
			sign[2] >= 0.0 ? place[k] / norm : sign[k] * (1.0 - sign[1 - k] * place[1 - k] / norm);
	for (int k = 0; k < 2; k++)
		texel[k] = (uv[k] + 1.0) * 0.5 * r->probes->size;
	return norm;
}

static piece cut(const ray *r, double first, double last)
{
	piece p = { .first = first, .last = last };
	double middle[3], end[2];
	at(r, 0.5 * (first + last), middle);
	for (int k = 0; k < 3; k++)
		p.sign[k] = middle[k] < 0.0 ? -1.0 : 1.0;
	p.norm[0] = project(r, p.sign, first, p.start);
	p.norm[1] = project(r, p.sign, last, end);
	for (int k = 0; k < 2; k++)
		p.to[k] = end[k] - p.start[k];
	return p;
}

/* Metres along the ray at a share of the way across the map. */
static double along(const piece *p, double share)
{
	const double below = p->norm[1] - share * (p->norm[1] - p->norm[0]);
	return p->first + (p->last - p->first) * share * p->norm[0] / below;
}

/* ---------------------------------------------------------------------------------- one texel */

/* A texel of any level: level 0 is the largest map. */
typedef struct texel {
	int level;
	size_t column, row;
	double first, last; /* shares of the piece within it */
} texel;

static texel texel_at(const ray *r, const piece *p, double share, int level)
{
	const double wide = (double)(1u << level), most = r->probes->size / wide - 1.0;
	double place[2], leave = 1.0;
	texel x = { .level = level, .first = share };
	for (int k = 0; k < 2; k++) {
		place[k] = floor((p->start[k] + (share + NUDGE) * p->to[k]) / wide);
		place[k] = fmin(fmax(place[k], 0.0), most);
		const double edge = (place[k] + (p->to[k] > 0.0 ? 1.0 : 0.0)) * wide;
		if (p->to[k] != 0.0)
			leave = fmin(leave, fmax((edge - p->start[k]) / p->to[k], share + NUDGE));
	}
	x.column = (size_t)place[0];
	x.row = (size_t)place[1];
	x.last = leave;
	return x;
}

/* Where a texel of a smaller map stands among those of its probe. */
static size_t mip_of(const gw_probes *p, size_t probe, const texel *x)
{
	size_t place = probe * (size_t)gw_octahedral_mip_texels(p->size);
	for (int level = 1; level < x->level; level++)
		place += (size_t)(p->size >> level) * (p->size >> level);
	return place + x->row * (p->size >> x->level) + x->column;
}

static void meet(ray *r, size_t at_texel, double distance)
{
	r->look->texel = at_texel;
	r->look->distance = distance;
	r->look->probe = (int32_t)r->probe;
}

/* Is the ray there lost, met (then at *t), or does it go on? */
static outcome test(ray *r, const piece *p, const texel *x, double *t)
{
	const gw_probes *of = r->probes;
	const size_t number = x->row * of->size + x->column;
	const size_t place = r->probe * of->size * of->size + number;
	const double distance = (double)of->distance[place], first = along(p, x->first);
	const double last = along(p, x->last);
	const gw_vec3 seen = gw_octahedral_texel(of->size, (uint32_t)number);
	const double normal[3] = { (double)of->normal[3 * place], (double)of->normal[3 * place + 1],
							   (double)of->normal[3 * place + 2] };
	const double middle[3] = { distance * (double)seen.x, distance * (double)seen.y,
							   distance * (double)seen.z };
	const double towards = dot(normal, r->way);
	double enters[3], leaves[3];
	if (distance >= (double)GW_PROBE_FAR)
		return LOOK_OPEN;
	at(r, first, enters);
	at(r, last, leaves);
	const double before = dot(normal, enters) - dot(normal, middle);
	const double behind = dot(normal, leaves) - dot(normal, middle);
	const double crack = CRACK * 2.0 / of->size * distance;
	if (before < -crack) {
		*t = first;
		return LOOK_LOST;
	}
	if (!(towards < 0.0) || behind > 0.0)
		return LOOK_OPEN;
	*t = fmax(first - before / towards, r->look->distance);
	meet(r, place, *t);
	return LOOK_MET;
}

/* -------------------------------------------------------------------------------- one probe */

/* May a texel of a smaller map be stepped over: is all that it holds beyond the ray? */
static bool is_clear(const ray *r, const piece *p, const texel *x)
{
	const double most = fmax(radius_at(r, along(p, x->first)), radius_at(r, along(p, x->last)));
	return most < (double)r->probes->least[mip_of(r->probes, r->probe, x)];
}

static outcome follow(ray *r, const piece *p, double *t)
{
	double share = 0.0;
	int level = 0;
	while (share < 1.0 - NUDGE) {
		const texel x = texel_at(r, p, share, level);
		r->look->steps++;
		if (level > 0 && !is_clear(r, p, &x)) {
			level--;
			continue;
		}
		const outcome found = level > 0 ? LOOK_OPEN : test(r, p, &x, t);
		if (found != LOOK_OPEN)
			return found;
		share = x.last;
		level = level < r->top ? level + 1 : level;
	}
	return LOOK_OPEN;
}

static int compare(const void *left, const void *right)
{
	const double a = *(const double *)left, b = *(const double *)right;
	return a < b ? -1 : a > b;
}

/* Follows a ray from `t` on through the octants of a probe's map. */
static outcome march(ray *r, double *t)
{
	double end[5] = { *t, r->last, r->last, r->last, r->last };
	for (int k = 0; k < 3; k++) {
		const double crossing = -r->from[k] / r->way[k];
		if (r->way[k] != 0.0 && crossing > *t && crossing < r->last)
			end[k + 1] = crossing;
	}
	qsort(end, 5, sizeof *end, compare);
	for (int i = 0; i < 4; i++) {
		if (!(end[i + 1] > end[i]))
			continue;
		const piece p = cut(r, end[i], end[i + 1]);
		const outcome found = follow(r, &p, t);
		if (found != LOOK_OPEN)
			return found;
	}
	return LOOK_OPEN;
}

/* ------------------------------------------------------------------------------- all of them */

/* The probes that serve a place, or NULL: its cell, by bisection; cells are sorted by z, y, x. */
static const int32_t *serving(const gw_probes *p, const double from[3])
{
	size_t low = 0, high = p->cells.count;
	double cell[3];
	for (int k = 0; k < 3; k++)
		cell[k] = floor((from[k] - p->cells.origin[k]) / p->cells.size);
	while (low < high) {
		const size_t middle = low + (high - low) / 2;
		const int32_t *at_middle = p->cells.cell + 3 * middle;
		int order = 0;
		for (int k = 2; k >= 0 && order == 0; k--)
			order = cell[k] < at_middle[k] ? -1 : cell[k] > at_middle[k];
		if (order == 0)
			return p->cells.probe + GW_PROBES_OF_CELL * middle;
		if (order < 0)
			high = middle;
		else
			low = middle + 1;
	}
	return NULL;
}

/* The nearest probes, by insertion; of equal ones the first. */
static void find_nearest(const gw_probes *p, const double from[3], int32_t best[GW_PROBES_OF_CELL])
{
	double near[GW_PROBES_OF_CELL];
	for (int i = 0; i < GW_PROBES_OF_CELL; i++) {
		near[i] = INFINITY;
		best[i] = -1;
	}
	for (size_t k = 0; k < p->count; k++) {
		double off[3];
		for (int i = 0; i < 3; i++)
			off[i] = p->probe[k].position[i] - from[i];
		double distance = dot(off, off);
		int place = GW_PROBES_OF_CELL;
		for (; place > 0 && near[place - 1] > distance; place--)
			if (place < GW_PROBES_OF_CELL) {
				near[place] = near[place - 1];
				best[place] = best[place - 1];
			}
		if (place < GW_PROBES_OF_CELL) {
			near[place] = distance;
			best[place] = (int32_t)k;
		}
	}
}

/* The texel that a probe sees in a direction. */
static size_t texel_of(const gw_probes *p, size_t probe, const float direction[3])
{
	float u, v;
	gw_octahedral_place(gw_xyz(direction), &u, &v);
	const float half = 0.5f * (float)p->size, last = (float)(p->size - 1);
	const size_t column = (size_t)gw_smaller(gw_larger((u + 1.0f) * half, 0.0f), last);
	const size_t row = (size_t)gw_smaller(gw_larger((v + 1.0f) * half, 0.0f), last);
	return (probe * p->size + row) * p->size + column;
}

static ray see(const gw_probes *p, int32_t probe, const double from[3], const float way[3])
{
	ray r = { .probes = p, .probe = (size_t)probe };
	for (int k = 0; k < 3; k++) {
		r.from[k] = from[k] - p->probe[probe].position[k];
		r.way[k] = (double)way[k];
	}
	r.last = ENDLESS * ((double)p->probe[probe].farthest + sqrt(dot(r.from, r.from)));
	return r;
}

void gw_probes_find(const gw_probes *probes, const double from[3], const float direction[3],
					bool mips, gw_probe_texel *look)
{
	int32_t nearest[GW_PROBES_OF_CELL];
	const int32_t *best = serving(probes, from);
	outcome found = LOOK_LOST;
	double t = 0.0;
	int i = 0;
	*look = (gw_probe_texel){ .probe = -1 };
	if (!best) {
		find_nearest(probes, from, nearest);
		best = nearest;
	}
	for (; i < GW_PROBES_OF_CELL && best[i] >= 0 && found == LOOK_LOST; i++) {
		ray r = see(probes, best[i], from, direction);
		r.look = look;
		for (uint32_t size = probes->size; mips && size > 1; size /= 2)
			r.top++;
		look->distance = t;
		found = march(&r, &t);
	}
	if (found == LOOK_MET)
		return;
	look->texel = texel_of(probes, (size_t)best[found == LOOK_OPEN ? i - 1 : 0], direction);
	look->probe = found == LOOK_OPEN ? best[i - 1] : -1;
	look->distance =
		found == LOOK_OPEN ? (double)GW_PROBE_FAR : (double)probes->distance[look->texel];
}

void gw_probes_look(const gw_probes *probes, const double from[3], const float direction[3],
					bool mips, gw_probe_look *look)
{
	gw_probe_texel found;
	gw_probes_find(probes, from, direction, mips, &found);
	*look =
		(gw_probe_look){ .distance = found.distance, .probe = found.probe, .steps = found.steps };
	memcpy(look->radiance, probes->radiance + 3 * found.texel, sizeof look->radiance);
}

/*
 * density_origin.c - where a cloud was scanned from, told by how densely its points lie; see
 * gw_points_find_scanner.
 *
 * A scanner's beams are spread evenly over directions. So each point has a piece of surface that
 * grows with the square of its distance from there, and with the slope at which it is seen: area ~
 * r^2 / cos. The beams of one that turns about an axis crowd towards its poles besides: area ~
 * r^2 sin / cos, with the angle from the axis; and those of a depth camera towards the edges of its
 * picture: area ~ r^2 cos^3 / cos, with the angle from where it looks. Seen from where the points
 * were taken, what is left of the areas is noise; from anywhere else they spread as widely as they
 * do by themselves. Those of a mesh that was sampled, of several scans that were joined, and of a
 * cloud that was thinned by a grid follow no place at all.
 */
#include "glowworm_picture.h"

#include "base/hash.h"
#include "base/memory.h"
#include "base/nth_element.h"
#include "base/up_axis.h"
#include "cloud/frame.h"
#include "cloud/neighbour_index.h"
#include "normals/plane_normal.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define POINTS_MOST 250000u /* that are looked at */
#define PLACES_MOST 1500u   /* of these, where the density is measured */
#define PLACES_LEAST 200u   /* that say anything, and which share of them has to */
#define PLACES_SHARE 0.2
#define NEIGHBOURS 13u /* the point itself among them */
#define FLAT 0.05      /* of the next eigenvalue: less is flat; more is no line */
#define COSINE_LEAST 0.05
#define SINE_LEAST 0.03
#define AHEAD_LEAST 0.3

#define TRIED_NEAR 2000u /* origins within the bounds, and as many around them */
#define NEAREST 0.3      /* half diagonals of the bounds from the middle, and up to */
#define FURTHEST 8.0
#define QUICK 64u /* places that tell which of these are worth a second look, so many of them */
#define SECOND 48u
#define REFINED 6u
#define FINEST 1e-3   /* of an origin's distance */
#define COARSE 1e-2   /* and until then by every fourth place */
#define HOPELESS 0.75 /* of what areas spread by themselves, from the best of those tried */

/* Of what the areas spread by themselves, what they may from there: measured are 0.02 to 0.19 from
 * the scanners of single scans, simulated and real, and 0.33 and more from the best place of
 * others: two stations 0.43, gentle ground seen from the air 0.33, things sampled evenly 0.56. */
#define SPREAD_LEFT 0.25

/* One scanner explains each of so many parts of the points, in their order: at most this share of
 * areas is off by more than so many times what they spread, and so much as a logarithm. Another one
 * saw what it does not explain. */
#define PARTS 16u
#define PART_OFF 0.5
#define AREA_OFF 4.0
#define AREA_OFF_LEAST 0.15

/* Rings of one elevation, seen from an origin, and of what the areas in them spread by themselves,
 * what they may from there. Vertices of a ball or a cone in meridians and parallels are as dense as
 * what a scanner in its axis sees, but in such a ring all are alike. */
#define RINGS 16u
#define RINGS_LEFT 0.5

/* Of what areas spread by themselves: no other way to spread beams is looked at. */
#define CERTAIN 0.1

#define SHIFT 64.0 /* makes logarithms of areas positive */

/* A piece of surface: its place, its normal and how much of it a point has. */
typedef struct place {
	double at[3], normal[3], log_area;
} place;

/* How beams are spread over directions. */
typedef enum beams { BEAMS_TURNING, BEAMS_EVEN, BEAMS_OF_PICTURE } beams;

/* A way to spread beams; axis: how many from up, of x, y and z in a circle. Scanners turn about the
 * vertical, as a rule; lasers of robots nod, and fans that are carried roll, about a level axis. */
typedef struct beam_way {
	beams beams;
	size_t axis;
} beam_way;

static const beam_way ways[] = {
	{ BEAMS_TURNING, 0 }, { BEAMS_TURNING, 1 },    { BEAMS_TURNING, 2 },
	{ BEAMS_EVEN, 0 },    { BEAMS_OF_PICTURE, 0 },
};

/* In a frame of its own, of half diagonal 1. */
typedef struct density {
	double middle[3], scale;
	place *place;
	size_t count;
	float *rest; /* count */
	beams beams;
	double axis[3]; /* about which it turned */
} density;

typedef struct origin {
	double at[3], spread;
} origin;

/* ------------------------------------------------------------------------------------ measuring */

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Half of what the middle two thirds spread over: a standard deviation, if they were normal. */
static double spread_of(const float *value, size_t count)
{
	size_t low = (size_t)(0.16 * (double)(count - 1)), high = (size_t)(0.84 * (double)(count - 1));
	return 0.5 *
		   ((double)gw_nth_element(value, count, high) - (double)gw_nth_element(value, count, low));
}

/* The way to a place, of length 1; returns its length, and 0 where there is none. */
static double find_way(const place *p, const double at[3], double way[3])
{
	for (size_t k = 0; k < 3; k++)
		way[k] = p->at[k] - at[k];
	double length = sqrt(dot(way, way));
	for (size_t k = 0; k < 3 && length > 0.0; k++)
		way[k] /= length;
	return length;
}

/* The middle of all directions is where a camera looks. */
static void find_view(const density *d, const double at[3], size_t step, double view[3])
{
	double way[3], sum[3] = { 0 };
	for (size_t i = 0; i < d->count; i += step)
		if (find_way(&d->place[i], at, way) > 0.0)
			for (size_t k = 0; k < 3; k++)
				sum[k] += way[k];
	double length = sqrt(dot(sum, sum));
	for (size_t k = 0; k < 3; k++)
		view[k] = length > 0.0 ? sum[k] / length : 0.0;
}

/* Solid angle of a beam, but for a factor. axis: that it turns about, or where it looks */
static double beam_width(beams spread, const double axis[3], const double way[3])
{
	double along = dot(axis, way);
	if (spread == BEAMS_EVEN)
		return 1.0;
	if (spread == BEAMS_TURNING)
		return sqrt(fmax(1.0 - along * along, SINE_LEAST * SINE_LEAST));
	along = fmax(along, AHEAD_LEAST);
	return along * along * along;
}

/* How widely areas spread that an origin does not explain, as logarithms, by every step-th place.
 */
static double spread_from(const density *d, const double at[3], size_t step)
{
	size_t count = 0;
	double view[3], way[3];
	memcpy(view, d->axis, sizeof view);
	if (d->beams == BEAMS_OF_PICTURE)
		find_view(d, at, step, view);
	for (size_t i = 0; i < d->count; i += step) {
		const place *p = &d->place[i];
		double length = find_way(p, at, way), cosine = fabs(dot(way, p->normal));
		double explained =
			length * length * beam_width(d->beams, view, way) / fmax(cosine, COSINE_LEAST);
		d->rest[count++] = (float)(SHIFT + p->log_area - log(fmax(explained, 1e-20)));
	}
	return spread_of(d->rest, count);
}

static double spread_alone(const density *d)
{
	for (size_t i = 0; i < d->count; i++)
		d->rest[i] = (float)(SHIFT + d->place[i].log_area);
	return spread_of(d->rest, d->count);
}

/* -------------------------------------------------------------------------------------- places */

/* Whether a point is one of about `most` of `count`, in no order that files have. */
static bool is_chosen(size_t i, size_t count, size_t most, uint64_t seed)
{
	uint64_t number = i;
	return count <= most || (double)(gw_hash(seed, &number, sizeof number) >> 11) * 0x1p-53 <
								(double)most / (double)count;
}

static bool is_finite(const double *position)
{
	return fabs(position[0]) < GW_COORDINATE_MAX && fabs(position[1]) < GW_COORDINATE_MAX &&
		   fabs(position[2]) < GW_COORDINATE_MAX;
}

static int compare_reals(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

/* The frame that holds nearly all of the points. False where they have no extent. */
static bool find_frame(const gw_points *points, density *d)
{
	double *value = gw_allocate_array(4 * PLACES_MOST, sizeof *value), squared = 0.0;
	for (size_t k = 0; k < 3 && value; k++) {
		size_t n = 0;
		for (size_t i = 0; i < points->count && n < 4 * PLACES_MOST; i++)
			if (is_chosen(i, points->count, 2 * PLACES_MOST, 1) &&
				is_finite(points->position + 3 * i))
				value[n++] = points->position[3 * i + k];
		if (n < PLACES_LEAST)
			break;
		qsort(value, n, sizeof *value, compare_reals);
		double low = value[n / 100], high = value[n - 1 - n / 100];
		d->middle[k] = 0.5 * (low + high);
		squared += 0.25 * (high - low) * (high - low);
	}
	free(value);
	d->scale = squared > 0.0 ? 1.0 / sqrt(squared) : 0.0;
	return isfinite(d->scale) && d->scale > 0.0;
}

/* Those of the points that are looked at, in the frame; returns how many. */
static size_t take_points(const gw_points *points, const density *d, float *local, size_t most)
{
	size_t n = 0;
	for (size_t i = 0; i < points->count && n < most; i++) {
		const double *at = points->position + 3 * i;
		if (!is_finite(at) || !is_chosen(i, points->count, POINTS_MOST, 0))
			continue;
		bool near = true;
		for (size_t k = 0; k < 3; k++) {
			local[3 * n + k] = (float)((at[k] - d->middle[k]) * d->scale);
			near = near && fabsf(local[3 * n + k]) < 100.0f;
		}
		n += near;
	}
	return n;
}

/* The area of a point of a flat piece of surface: 1 / density, but for a factor that is the same
 * everywhere. False where neighbours lie in no plane, or on a line. */
static bool measure_area(float *near, size_t count, place *p)
{
	double m[6] = { 0 }, mean[3] = { 0 };
	float normal[3], curvature;
	for (size_t i = 0; i < 3 * count; i++)
		mean[i % 3] += near[i] / (double)count;
	for (size_t i = 0; i < count; i++) {
		double v[3];
		for (size_t k = 0; k < 3; k++)
			v[k] = near[3 * i + k] - mean[k];
		for (size_t k = 0; k < 3; k++) {
			m[k] += v[k] * v[k];
			m[3 + k] += v[k] * v[(k + 1) % 3];
		}
	}
	if (gw_plane_normal(near, count, normal, &curvature) != GW_PLANE_FOUND)
		return false;
	/* The eigenvalues' sum and the sum of their products give those that lie in the plane. */
	double trace = m[0] + m[1] + m[2], least = curvature * trace, sum = trace - least;
	double products = m[0] * m[1] + m[1] * m[2] + m[2] * m[0] - m[3] * m[3] - m[4] * m[4] -
					  m[5] * m[5] - least * sum;
	double root = sqrt(fmax(0.25 * sum * sum - products, 0.0));
	double greater = 0.5 * sum + root, smaller = 0.5 * sum - root;
	if (!(smaller > FLAT * greater && least < FLAT * smaller))
		return false;
	p->log_area = 0.5 * log(products);
	for (size_t k = 0; k < 3; k++)
		p->normal[k] = normal[k];
	return isfinite(p->log_area);
}

static void measure_place(const float *local, size_t point, const int *found, density *d)
{
	float near[3 * NEIGHBOURS], widest = 0.0f;
	place *p = &d->place[d->count];
	for (size_t i = 0; i < 3 * NEIGHBOURS; i++) {
		near[i] = local[3 * (size_t)found[i / 3] + i % 3] - local[3 * point + i % 3];
		widest = fmaxf(widest, fabsf(near[i]));
	}
	for (size_t i = 0; i < 3 * NEIGHBOURS && widest > 0.0f; i++)
		near[i] /= widest;
	for (size_t k = 0; k < 3; k++)
		p->at[k] = local[3 * point + k];
	if (!(widest > 0.0f) || !measure_area(near, NEIGHBOURS, p))
		return;
	p->log_area += 2.0 * log(widest);
	d->count++;
}

/* Fills place. False where too few of them say anything, or memory is short. */
static bool measure(float *local, size_t count, density *d)
{
	int found[NEIGHBOURS];
	float squared[NEIGHBOURS];
	size_t asked = 0;
	gw_neighbour_index *index =
		count > NEIGHBOURS ? gw_neighbour_index_build(local, count, 1) : NULL;
	for (size_t i = 0; i < count && index && asked < 2 * PLACES_MOST; i++) {
		if (!is_chosen(i, count, PLACES_MOST, 2))
			continue;
		asked++;
		if (gw_neighbour_index_search(index, local + 3 * i, 1, NEIGHBOURS, found, squared))
			measure_place(local, i, found, d);
	}
	gw_neighbour_index_free(index);
	return d->count >= PLACES_LEAST && (double)d->count >= PLACES_SHARE * (double)asked;
}

/* ------------------------------------------------------------------------------------- origins */

/* Numbers from 0 to 1 that fill a cube evenly, by the plastic number. */
static void even_place(size_t i, double at[3])
{
	static const double step[3] = { 0.8191725133961645, 0.6710436067037893, 0.5497004779019703 };
	for (size_t k = 0; k < 3; k++)
		at[k] = fmod(0.5 + (double)(i + 1) * step[k], 1.0);
}

static void try_origin(size_t i, double at[3])
{
	even_place(i / 2, at);
	if (i % 2 == 0) {
		for (size_t k = 0; k < 3; k++)
			at[k] = 2.0 * at[k] - 1.0;
		return;
	}
	double distance = NEAREST * exp(at[0] * log(FURTHEST / NEAREST)), z = 2.0 * at[1] - 1.0;
	double across = distance * sqrt(1.0 - z * z), turn = 2.0 * 3.14159265358979324 * at[2];
	at[0] = across * cos(turn);
	at[1] = across * sin(turn);
	at[2] = distance * z;
}

/* Keeps the best few in order. */
static void keep_best(origin *best, size_t count, const origin *o)
{
	if (!(o->spread < best[count - 1].spread))
		return;
	size_t i = count - 1;
	for (; i > 0 && o->spread < best[i - 1].spread; i--)
		best[i] = best[i - 1];
	best[i] = *o;
}

/* The steps that a search takes: towards the middle of the points, and across. */
static void find_steps(const double at[3], double step[3][3])
{
	double length = sqrt(dot(at, at));
	size_t least = fabs(at[0]) < fabs(at[1]) ? 0 : 1;
	least = fabs(at[2]) < fabs(at[least]) ? 2 : least;
	double axis[3] = { least == 0, least == 1, least == 2 };
	for (size_t k = 0; k < 3; k++)
		step[0][k] = length > 0.0 ? at[k] / length : k == (least + 1) % 3;
	for (size_t s = 1; s < 3; s++) {
		const double *a = step[0], *b = s == 1 ? axis : step[1];
		for (size_t k = 0; k < 3; k++)
			step[s][k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
		length = sqrt(dot(step[s], step[s]));
		for (size_t k = 0; k < 3; k++)
			step[s][k] /= length;
	}
}

/* Goes down as long as one of six steps does, and halves them when none does. */
static void refine(const density *d, size_t every, double finest, origin *o)
{
	o->spread = spread_from(d, o->at, every);
	double length = (every > 1 ? 0.2 : 2.0 * COARSE) * fmax(sqrt(dot(o->at, o->at)), 0.5);
	while (length > finest * fmax(sqrt(dot(o->at, o->at)), 0.5)) {
		double step[3][3];
		origin best = *o;
		find_steps(o->at, step);
		for (size_t s = 0; s < 6; s++) {
			origin tried;
			for (size_t k = 0; k < 3; k++)
				tried.at[k] = o->at[k] + (s % 2 ? length : -length) * step[s / 2][k];
			tried.spread = spread_from(d, tried.at, every);
			keep_best(&best, 1, &tried);
		}
		if (!(best.spread < o->spread))
			length *= 0.5;
		*o = best;
	}
}

static origin find_origin(const density *d, double alone)
{
	origin second[SECOND], refined[REFINED], best = { .spread = DBL_MAX };
	for (size_t i = 0; i < SECOND; i++)
		second[i].spread = DBL_MAX;
	for (size_t i = 0; i < REFINED; i++)
		refined[i].spread = DBL_MAX;
	size_t step = (d->count + QUICK - 1) / QUICK;
	for (size_t i = 0; i < 2 * TRIED_NEAR; i++) {
		origin o;
		try_origin(i, o.at);
		o.spread = spread_from(d, o.at, step);
		keep_best(second, SECOND, &o);
	}
	for (size_t i = 0; i < SECOND; i++) {
		second[i].spread = spread_from(d, second[i].at, 1);
		keep_best(refined, REFINED, &second[i]);
	}
	for (size_t i = 0; i < REFINED && refined[0].spread < HOPELESS * alone; i++) {
		refine(d, 4, COARSE, &refined[i]);
		refine(d, 1, FINEST, &refined[i]);
		keep_best(&best, 1, &refined[i]);
	}
	return best;
}

typedef struct raised {
	double elevation, log_area;
} raised;

static int compare_raised(const void *a, const void *b)
{
	double x = ((const raised *)a)->elevation, y = ((const raised *)b)->elevation;
	return (x > y) - (x < y);
}

/* How widely areas spread by themselves among those of one elevation, seen from an origin; 0 when
 * memory is short. Uses rest. */
static double spread_in_rings(const density *d, const double at[3])
{
	raised *of = gw_allocate_array(d->count, sizeof *of);
	double way[3];
	if (!of)
		return 0.0;
	for (size_t i = 0; i < d->count; i++) {
		find_way(&d->place[i], at, way);
		of[i] = (raised){ dot(way, d->axis), d->place[i].log_area };
	}
	qsort(of, d->count, sizeof *of, compare_raised);
	for (size_t i = 0; i < d->count; i++)
		d->rest[i] = (float)(SHIFT + of[i].log_area);
	for (size_t ring = 0; ring < RINGS; ring++) {
		size_t first = ring * d->count / RINGS, count = (ring + 1) * d->count / RINGS - first;
		float usual = gw_nth_element(d->rest + first, count, count / 2);
		for (size_t i = first; i < first + count; i++)
			d->rest[i] += (float)SHIFT - usual;
	}
	free(of);
	return spread_of(d->rest, d->count);
}

/* Whether an origin explains all parts of the points, after spread_from it. */
static bool explains_parts(const density *d, double spread)
{
	double most = fmax(AREA_OFF * spread, AREA_OFF_LEAST);
	double usual = (double)gw_nth_element(d->rest, d->count, d->count / 2);
	for (size_t part = 0; part < PARTS; part++) {
		size_t first = part * d->count / PARTS, end = (part + 1) * d->count / PARTS, off = 0;
		for (size_t i = first; i < end; i++)
			off += fabs((double)d->rest[i] - usual) > most;
		if ((double)off > PART_OFF * (double)(end - first))
			return false;
	}
	return true;
}

/* Takes a way to spread beams. */
static void take_way(density *d, const double up[3], const beam_way *way)
{
	d->beams = way->beams;
	for (size_t k = 0; k < 3; k++)
		d->axis[(k + way->axis) % 3] = up[k];
}

/* The best of all ways in which beams are spread. False when none explains the areas. */
static bool explain(density *d, const double up[3], double at[3])
{
	double alone = spread_alone(d);
	origin best = { .spread = DBL_MAX };
	const beam_way *of_best = ways;
	for (size_t i = 0; i < sizeof ways / sizeof *ways && best.spread > CERTAIN * alone; i++) {
		take_way(d, up, ways + i);
		origin o = find_origin(d, alone);
		of_best = o.spread < best.spread ? ways + i : of_best;
		keep_best(&best, 1, &o);
	}
	memcpy(at, best.at, sizeof best.at);
	take_way(d, up, of_best);
	if (!(best.spread < SPREAD_LEFT * alone) || !(dot(at, at) < FURTHEST * FURTHEST) ||
		!(best.spread < RINGS_LEFT * spread_in_rings(d, at)))
		return false;
	spread_from(d, at, 1);
	return explains_parts(d, best.spread);
}

bool gw_points_find_scanner(const gw_points *points, double scanner[3])
{
	density d = { .count = 0 };
	size_t most = points->count < 2 * POINTS_MOST ? points->count : 2 * POINTS_MOST;
	if (points->count < PLACES_LEAST || !find_frame(points, &d))
		return false;
	float *local = gw_allocate_array(most, 3 * sizeof *local);
	d.place = gw_allocate_array(2 * PLACES_MOST, sizeof *d.place);
	d.rest = gw_allocate_array(2 * PLACES_MOST, sizeof *d.rest);
	double at[3], up[3];
	gw_up_axis(points->up, up);
	bool found = local && d.place && d.rest &&
				 measure(local, take_points(points, &d, local, most), &d) && explain(&d, up, at);
	for (size_t k = 0; k < 3 && found; k++)
		scanner[k] = d.middle[k] + at[k] / d.scale;
	free(local);
	free(d.place);
	free(d.rest);
	return found;
}

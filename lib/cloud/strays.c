/*
 * strays.c - see strays.h.
 *
 * Only what lies in cells with few points around them can be alone, so that most of a cloud costs a
 * look at its cells. The nearest neighbours of the others are searched among all such and one
 * surfel of each other cell: dense surfaces count no more than sparse ones there.
 */
#include "cloud/strays.h"

#include "base/memory.h"
#include "cloud/bulk_bounds.h"
#include "cloud/frame.h"
#include "cloud/neighbour_index.h"
#include "cloud/stray_cells.h"
#include "cloud/stray_mounts.h"
#include "cloud/unit_places.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#define CHUNK 256 /* cells or candidates that a thread takes at a time */

#define CLOUD_LEAST 64 /* surfels: of fewer nobody knows what is usual */
#define FEW_AROUND 6   /* surfels in a cell and those around it, itself among them */
#define FEW_IN_CELL 3  /* of cells with more, one stands for all */
#define SEARCHED 17    /* itself among them */
#define REACHED 6      /* to this neighbour a surfel is alone */

/* How much further off that is than on a surface whose points are as far apart as is usual around.
 * Random points on one are 1.38 spacings from it, of a million hardly one is twice that. */
#define ALONE 3.0
#define ALONE_AT_FIRST 2.0 /* among strays that are to be found yet */
#define USUAL 1.38

/* How far around is looked for what is usual, in distances of that neighbour. */
#define LOOK 4.0

/* A plane through the surfel: half its thickness, of how far most neighbours are from their middle;
 * how many neighbours lie in it; and their least extent to the sides, of that along the line that
 * they lie on most. Of 16 points that fill space at random five and more do so in one case of five,
 * six in one of fifty. */
#define SLAB 0.057
#define IN_PLANE 7
#define MANY_IN_PLANE 12 /* of 16: more than chance, if their own plane passes the surfel */
#define BESIDE_LINE 0.08
#define CONE 0.95        /* share of their offsets' length that is in common: all are to one side */
#define GAPS 3.0         /* how far the second nearest is at most, of how far they are apart */
#define PAIRS_OF 9       /* nearest neighbours that planes are put through, two at a time */
#define LEAST_ANGLE 0.3  /* sine between them */
#define OF_NEIGHBOUR 1.5 /* how much thicker the plane of a neighbour is */

/* So many points that are far off, on planes together, are a sparse surface; fewer are none, nor
 * are those of which most only happen to be in the plane of a few. */
#define ISLAND 12
#define IN_COMMON 2 /* of stray_step.alone: far off, but on such a plane */

/* Strays that hang together hide each other: with those that were found gone, more are alone. Each
 * time there are fewer. */
#define ROUNDS 8

/* More strays than one in so many, of all rounds together, are none: the cloud is that sparse. */
#define MOST 5

#define FOUND_ALONE 2 /* of gw_stray_marks.far */

/* Values that stand for no data, beside all from NO_DATA_FROM on. */
static const double no_data[] = { -9999, 9999, -99999, 99999, -32768, 32767, -32767, 65535 };
#define NO_DATA_FROM 1e9

typedef struct stray_step {
	const gw_surfels *surfels;
	uint32_t threads;
	gw_stray_cells cells;
	uint8_t *sparse; /* a cell: has few around */
	uint32_t *thin;  /* thin_count surfels: those in sparse cells, one of each other */
	size_t thin_count;
	uint32_t *candidate; /* candidate_count surfels; places in thin are the same order */
	size_t *cell;        /* candidate_count, theirs */
	size_t candidate_count;
	float *query; /* 3 * candidate_count */
	double scale; /* a power of two */
	gw_neighbour_index *index;
	atomic_bool failed; /* the search */
	int *found; /* SEARCHED * candidate_count, places in thin; the first is -1 until they are
				   searched for */
	float *squared;
	uint32_t *candidate_of; /* thin_count, 1 + place in candidate, 0: none */
	uint8_t *gone;          /* thin_count: strays that were found in earlier rounds */
	double *plane;          /* 4 * candidate_count: normal and half thickness; 0: is on none */
	uint8_t *asked;         /* candidate_count: its plane is */
	uint8_t *alone;         /* candidate_count: it is, as this round has it */
	const uint8_t *wanted;  /* candidate_count: its neighbours are; NULL: those of all */
	uint8_t *far;           /* candidate_count: which were when they were first looked at */
	uint8_t *stray;         /* surfels->count: what was found */
	size_t strays;
	bool again; /* a round after the first, which found out what is far */
} stray_step;

/* ----------------------------------------------------------------------------------- by number */

static gw_stray_kind kind_of(const double place[3], gw_stray_kind other)
{
	if (place[0] == 0 && place[1] == 0 && place[2] == 0)
		return GW_STRAY_ZERO;
	for (int k = 0; k < 3; k++) {
		if (fabs(place[k]) >= NO_DATA_FROM)
			return GW_STRAY_NO_DATA;
		for (size_t i = 0; i < sizeof no_data / sizeof *no_data; i++)
			if (place[k] == no_data[i])
				return GW_STRAY_NO_DATA;
	}
	return other;
}

static void set_mark(gw_stray_marks *marks, size_t point, gw_stray_kind kind)
{
	marks->count += marks->mark[point] == 0;
	marks->mark[point] = (uint8_t)(1 + kind);
}

static void mark_far(const gw_points *points, gw_stray_marks *marks)
{
	double least[3], most[3], minimum[3], maximum[3];
	gw_points rest = *points;
	size_t finite = gw_finite_bounds(points, least, most);
	memcpy(minimum, least, sizeof least);
	memcpy(maximum, most, sizeof most);
	if (finite == 0 || gw_bulk_bounds(&rest, minimum, maximum) == 0)
		return;
	for (size_t i = 0; i < points->count; i++) {
		const double *place = points->position + 3 * i;
		if (gw_within(place, least, most) && !gw_within(place, minimum, maximum))
			set_mark(marks, i, kind_of(place, GW_STRAY_FAR));
	}
}

static gw_status mark_mounts(const gw_points *points, gw_stray_marks *marks, gw_error *error)
{
	uint8_t *found;
	GW_TRY(gw_stray_mounts_find(points, &found, error));
	for (size_t i = 0; found && i < points->count; i++)
		if (found[i])
			set_mark(marks, i, GW_STRAY_MOUNT);
	free(found);
	return GW_OK;
}

gw_status gw_strays_mark_known(const gw_points *points, gw_stray_marks *marks, gw_error *error)
{
	double minimum[3], maximum[3];
	*marks = (gw_stray_marks){ .mark = gw_allocate_zeros(points->count, 1) };
	if (!marks->mark)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to mark %zu points", points->count);
	if (points->keep_strays)
		return GW_OK;
	size_t finite = gw_finite_bounds(points, minimum, maximum);
	for (size_t i = 0; points->stray && finite > 0 && i < points->count; i++)
		if (points->stray[i] > 0 && points->stray[i] <= GW_STRAY_KIND_COUNT &&
			gw_within(points->position + 3 * i, minimum, maximum))
			set_mark(marks, i, (gw_stray_kind)(points->stray[i] - 1));
	double *position;
	gw_points rest;
	gw_status status = gw_strays_hide(points, marks, &position, &rest, error);
	if (status == GW_OK && gw_finite_bounds(&rest, minimum, maximum) == 0) {
		memset(marks->mark, 0, points->count);
		marks->count = 0;
	} else if (status == GW_OK) {
		mark_far(&rest, marks);
		status = mark_mounts(&rest, marks, error);
	}
	free(position);
	return status;
}

gw_status gw_strays_hide(const gw_points *points, const gw_stray_marks *marks, double **position,
						 gw_points *rest, gw_error *error)
{
	*rest = *points;
	*position = NULL;
	if (marks->count == 0)
		return GW_OK;
	double *places = *position = gw_allocate_array(points->count, 3 * sizeof **position);
	if (!places)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the places of %zu points",
					   points->count);
	memcpy(places, points->position, 3 * points->count * sizeof *places);
	for (size_t i = 0; i < 3 * points->count; i++)
		if (marks->mark[i / 3])
			places[i] = NAN;
	rest->position = places;
	return GW_OK;
}

/* ----------------------------------------------------------------------------------- by place */

static void find_sparse(void *user, size_t first, size_t last, uint32_t worker)
{
	const stray_step *step = user;
	(void)worker;
	for (size_t cell = first; cell < last; cell++)
		step->sparse[cell] = gw_stray_cells_few_around(&step->cells, cell, FEW_AROUND);
}

/* Sorts out the cells. */
static bool take_candidates(stray_step *step)
{
	const gw_stray_cells *c = &step->cells;
	step->sparse = gw_allocate_array(c->count, sizeof *step->sparse);
	step->thin = gw_allocate_array(step->surfels->count, sizeof *step->thin);
	step->candidate = gw_allocate_array(step->surfels->count, sizeof *step->candidate);
	step->cell = gw_allocate_array(step->surfels->count, sizeof *step->cell);
	step->candidate_of = gw_allocate_zeros(step->surfels->count, sizeof *step->candidate_of);
	if (!step->sparse || !step->thin || !step->candidate || !step->cell || !step->candidate_of)
		return false;
	gw_parallel_for(step->threads, c->count, CHUNK, find_sparse, step);
	for (size_t cell = 0; cell < c->count; cell++) {
		size_t first = c->first[cell], end = c->first[cell + 1];
		bool few = step->sparse[cell] > 0;
		bool all = few || end - first <= FEW_IN_CELL;
		for (size_t i = first; i < (all ? end : first + 1); i++) {
			if (few) {
				step->cell[step->candidate_count] = cell;
				step->candidate[step->candidate_count++] = (uint32_t)i;
				step->candidate_of[step->thin_count] = (uint32_t)step->candidate_count;
			}
			step->thin[step->thin_count++] = (uint32_t)i;
		}
	}
	return true;
}

/* Places of some surfels in unit size. */
static float *scaled_positions(const stray_step *step, const uint32_t *surfel, size_t count)
{
	float *scaled = gw_allocate_array(count, 3 * sizeof *scaled);
	for (size_t i = 0; scaled && i < count; i++)
		gw_unit_place(step->surfels, surfel[i], step->scale, scaled + 3 * i);
	return scaled;
}

static bool build_index(stray_step *step)
{
	step->scale = gw_unit_scale(step->surfels);
	size_t n = step->candidate_count;
	step->query = scaled_positions(step, step->candidate, n);
	float *scaled = scaled_positions(step, step->thin, step->thin_count);
	step->found = gw_allocate_array(n, SEARCHED * sizeof *step->found);
	step->squared = gw_allocate_array(n, SEARCHED * sizeof *step->squared);
	step->gone = gw_allocate_zeros(step->thin_count, sizeof *step->gone);
	if (scaled)
		step->index = gw_neighbour_index_build(scaled, step->thin_count, step->threads);
	free(scaled);
	if (!step->index || !step->query || !step->found || !step->squared || !step->gone)
		return false;
	memset(step->found, 0xff, SEARCHED * n * sizeof *step->found);
	gw_neighbour_index_leave_out(step->index, step->gone);
	return true;
}

static void search(stray_step *step, size_t first, size_t count)
{
	if (!atomic_load(&step->failed) &&
		!gw_neighbour_index_search(step->index, step->query + 3 * first, count, SEARCHED,
								   step->found + SEARCHED * first,
								   step->squared + SEARCHED * first))
		atomic_store(&step->failed, true);
}

static void search_all(void *user, size_t first, size_t last, uint32_t worker)
{
	(void)worker;
	search(user, first, last - first);
}

/* Searches for the neighbours of a candidate, if they are not known or one of them is gone. */
static void renew(stray_step *step, size_t candidate)
{
	const int *place = step->found + SEARCHED * candidate;
	bool known = place[0] >= 0;
	for (int j = 0; known && j < SEARCHED; j++)
		known = !step->gone[place[j]];
	if (!known)
		search(step, candidate, 1);
}

static bool is_gone(const stray_step *step, size_t candidate)
{
	return step->stray[step->candidate[candidate]] > 0;
}

static void renew_wanted(void *user, size_t first, size_t last, uint32_t worker)
{
	stray_step *step = user;
	(void)worker;
	for (size_t i = first; i < last; i++)
		if (step->wanted[i] && !is_gone(step, i))
			renew(step, i);
}

/* Knows the neighbours of the candidates that are wanted; false when memory is short. */
static bool search_wanted(stray_step *step, const uint8_t *wanted)
{
	step->wanted = wanted;
	gw_parallel_for(step->threads, step->candidate_count, CHUNK, wanted ? renew_wanted : search_all,
					step);
	return !atomic_load(&step->failed);
}

/* The neighbours of a candidate relative to it, metres. */
typedef struct surrounding {
	double at[SEARCHED][3];
	uint32_t place[SEARCHED]; /* in thin */
	int count;
	double slab; /* half the thickness of a plane here */
	bool aside;  /* they are all in one direction */
} surrounding;

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double median(double *values, int count)
{
	for (int i = 1; i < count; i++) {
		double value = values[i];
		int place = i;
		for (; place > 0 && values[place - 1] > value; place--)
			values[place] = values[place - 1];
		values[place] = value;
	}
	return values[count / 2];
}

/* The middle and the width of what is around are those of most of it: one far neighbour, maybe a
 * stray itself, makes no plane thicker. */
static void measure(surrounding *around)
{
	double sum[3] = { 0 }, middle[3], all[SEARCHED], lengths = 0;
	int n = around->count;
	for (int j = 0; j < n; j++) {
		lengths += sqrt(dot(around->at[j], around->at[j]));
		for (int k = 0; k < 3; k++)
			sum[k] += around->at[j][k];
	}
	for (int k = 0; k < 3; k++) {
		for (int j = 0; j < n; j++)
			all[j] = around->at[j][k];
		middle[k] = median(all, n);
	}
	for (int j = 0; j < n; j++) {
		const double *at = around->at[j];
		const double off[3] = { at[0] - middle[0], at[1] - middle[1], at[2] - middle[2] };
		all[j] = sqrt(dot(off, off));
	}
	around->slab = SLAB * median(all, n);
	around->aside = sqrt(dot(sum, sum)) > CONE * lengths;
}

/* Of those that are nearer to each other than a plane here is thick only the first one counts: from
 * afar a dense surface is a single place. */
static void thin_out(surrounding *around)
{
	int kept = 0;
	for (int j = 0; j < around->count; j++) {
		bool apart = true;
		for (int i = 0; apart && i < kept; i++) {
			const double *a = around->at[i], *b = around->at[j];
			const double between[3] = { a[0] - b[0], a[1] - b[1], a[2] - b[2] };
			apart = dot(between, between) > around->slab * around->slab;
		}
		if (!apart)
			continue;
		memcpy(around->at[kept], around->at[j], sizeof around->at[j]);
		around->place[kept++] = around->place[j];
	}
	around->count = kept;
}

static void look_around(const stray_step *step, size_t candidate, surrounding *around)
{
	const float *position = step->surfels->position;
	const float *own = position + 3 * (size_t)step->candidate[candidate];
	around->count = 0;
	for (int j = 0; j < SEARCHED && around->count < SEARCHED - 1; j++) {
		uint32_t place = (uint32_t)step->found[SEARCHED * candidate + (size_t)j];
		uint32_t surfel = step->thin[place];
		if (surfel == step->candidate[candidate])
			continue;
		for (size_t k = 0; k < 3; k++)
			around->at[around->count][k] =
				(double)position[3 * (size_t)surfel + k] - (double)own[k];
		around->place[around->count++] = place;
	}
	measure(around);
	thin_out(around);
}

/* The unit normal of the plane through two neighbours and the surfel; false where all three lie
 * about on a line. */
static bool normal_through(const double a[3], const double b[3], double n[3])
{
	for (int k = 0; k < 3; k++)
		n[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
	double length = sqrt(dot(n, n));
	if (!(length > LEAST_ANGLE * sqrt(dot(a, a) * dot(b, b))))
		return false;
	for (int k = 0; k < 3; k++)
		n[k] /= length;
	return true;
}

/* The neighbours in a plane through the surfel: two coordinates in it, and the one off it. */
typedef struct layer {
	double at[SEARCHED][3];
	int count;
	double mean[3], moment[3][3]; /* sums of products, about the mean */
} layer;

static void take_layer(const surrounding *around, const double n[3], layer *l)
{
	double u[3], v[3];
	int axis = fabs(n[0]) < 0.6 ? 0 : 1;
	*l = (layer){ .count = 0 };
	for (int k = 0; k < 3; k++)
		u[k] = (k == axis) - n[axis] * n[k];
	double length = sqrt(dot(u, u));
	for (int k = 0; k < 3; k++)
		u[k] /= length;
	for (int k = 0; k < 3; k++)
		v[k] = n[(k + 1) % 3] * u[(k + 2) % 3] - n[(k + 2) % 3] * u[(k + 1) % 3];
	for (int j = 0; j < around->count; j++) {
		const double *to = around->at[j], at[3] = { dot(to, u), dot(to, v), dot(to, n) };
		if (!(fabs(at[2]) <= around->slab))
			continue;
		memcpy(l->at[l->count++], at, sizeof at);
		for (int k = 0; k < 3; k++)
			l->mean[k] += at[k];
	}
	for (int k = 0; k < 3; k++)
		l->mean[k] /= fmax(l->count, 1);
	for (int j = 0; j < l->count; j++)
		for (int k = 0; k < 9; k++)
			l->moment[k / 3][k % 3] +=
				(l->at[j][k / 3] - l->mean[k / 3]) * (l->at[j][k % 3] - l->mean[k % 3]);
}

/* Is the surfel one of them, as far from them as they are from each other? */
static bool is_among(const layer *l)
{
	double gap[SEARCHED], nearest = INFINITY, second = INFINITY; /* sorted */
	for (int i = 0; i < l->count; i++) {
		double own = hypot(l->at[i][0], l->at[i][1]), least = INFINITY;
		for (int j = 0; j < l->count; j++)
			if (j != i)
				least = fmin(least, hypot(l->at[i][0] - l->at[j][0], l->at[i][1] - l->at[j][1]));
		int place = i;
		for (; place > 0 && least < gap[place - 1]; place--)
			gap[place] = gap[place - 1];
		gap[place] = least;
		second = fmin(second, fmax(own, nearest));
		nearest = fmin(nearest, own);
	}
	return second <= GAPS * gap[l->count / 2];
}

/* Does the plane that they lie in by themselves, without the surfel, pass it, and is that known
 * well enough? From afar all that is flat or long looks as if it lay in one plane with whatever is
 * about beside it. */
static bool passes_surfel(const layer *l, double slab)
{
	double xx = l->moment[0][0], xy = l->moment[0][1], yy = l->moment[1][1];
	double xz = l->moment[0][2], yz = l->moment[1][2], zz = l->moment[2][2];
	double x = l->mean[0], y = l->mean[1], determinant = xx * yy - xy * xy;
	if (!(determinant > 0))
		return false;
	double a = (xz * yy - yz * xy) / determinant, b = (yz * xx - xz * xy) / determinant;
	double variance = fmax(zz - a * xz - b * yz, 0) / (l->count - 3);
	variance *= 1.0 / l->count + (x * x * yy - 2 * x * y * xy + y * y * xx) / determinant;
	return hypot(l->mean[2] - a * x - b * y, sqrt(variance)) <= slab;
}

/* Is the surfel beside a line that they are on? */
static bool is_beside_line(const layer *l, double slab)
{
	double xx = l->moment[0][0], xy = l->moment[0][1], yy = l->moment[1][1];
	double half = 0.5 * (xx + yy), root = hypot(0.5 * (xx - yy), xy);
	double least = half - root, most = half + root, off = hypot(l->mean[0], l->mean[1]);
	return least < BESIDE_LINE * BESIDE_LINE * most && off > slab &&
		   off * off > 4 * least / l->count;
}

/* How many neighbours lie in a plane. */
static int count_in_plane(const surrounding *around, const double n[3])
{
	int count = 0;
	for (int j = 0; j < around->count; j++)
		count += fabs(dot(around->at[j], n)) <= around->slab;
	return count;
}

/* Is the surfel on a surface with those neighbours? */
static bool is_with_them(const surrounding *around, const double n[3])
{
	layer l;
	take_layer(around, n, &l);
	if (l.count < IN_PLANE || is_beside_line(&l, around->slab))
		return false;
	return (l.count >= MANY_IN_PLANE && passes_surfel(&l, around->slab)) || is_among(&l);
}

/* Does a candidate lie in a plane with many of its neighbours? */
static void find_plane(stray_step *step, size_t candidate)
{
	surrounding around;
	double *plane = step->plane + 4 * candidate, n[3];
	look_around(step, candidate, &around);
	int best = around.aside ? MANY_IN_PLANE - 1 : IN_PLANE - 1;
	for (int a = 1; a < around.count && a < PAIRS_OF; a++)
		for (int b = 0; b < a; b++) {
			if (!normal_through(around.at[a], around.at[b], n))
				continue;
			int count = count_in_plane(&around, n);
			if (count <= best || !is_with_them(&around, n))
				continue;
			best = count;
			memcpy(plane, n, sizeof n);
			plane[3] = around.slab;
		}
}

/* Or in that of a neighbour that does? In corners that are sampled sparsely. */
static bool is_in_plane(const stray_step *step, size_t candidate)
{
	surrounding around;
	if (step->plane[4 * candidate + 3] > 0)
		return true;
	look_around(step, candidate, &around);
	for (int j = 0; j < around.count; j++) {
		uint32_t other = step->candidate_of[around.place[j]];
		const double *plane = other > 0 ? step->plane + 4 * (size_t)(other - 1) : NULL;
		if (plane && plane[3] > 0 && fabs(dot(around.at[j], plane)) <= OF_NEIGHBOUR * plane[3])
			return true;
	}
	return false;
}

static void judge_far_off(void *user, size_t first, size_t last, uint32_t worker)
{
	stray_step *step = user;
	gw_stray_spacing found = { .known = false };
	(void)worker;
	for (size_t i = first; i < last; i++) {
		uint8_t *far = step->far + i;
		if (step->again && (!*far || is_gone(step, i)))
			continue;
		double reach = sqrt((double)step->squared[SEARCHED * i + REACHED]) / step->scale;
		double usual = gw_stray_cells_spacing(&step->cells, step->cell[i], LOOK * reach, &found);
		if (!step->again)
			*far = reach > ALONE_AT_FIRST * USUAL * usual;
		step->alone[i] = *far && reach > ALONE * USUAL * usual;
	}
}

/* Planes are asked for of what is far off, and of its neighbours. */
static void ask_for_planes(stray_step *step)
{
	for (size_t i = 0; i < step->candidate_count; i++) {
		const int *place = step->found + SEARCHED * i;
		for (int j = 0; step->alone[i] && j < SEARCHED; j++) {
			uint32_t neighbour = step->candidate_of[place[j]];
			if (neighbour > 0)
				step->asked[neighbour - 1] = 1;
		}
		step->asked[i] |= step->alone[i];
	}
}

static void find_planes(void *user, size_t first, size_t last, uint32_t worker)
{
	stray_step *step = user;
	(void)worker;
	for (size_t i = first; i < last; i++)
		if (step->asked[i])
			find_plane(step, i);
}

static void judge_planes(void *user, size_t first, size_t last, uint32_t worker)
{
	stray_step *step = user;
	(void)worker;
	for (size_t i = first; i < last; i++)
		if (step->alone[i] && is_in_plane(step, i))
			step->alone[i] = IN_COMMON;
}

/* The first of those that a candidate is together with. */
static uint32_t find_first(uint32_t *parent, uint32_t i)
{
	while (parent[i] != i)
		i = parent[i] = parent[parent[i]];
	return i;
}

/* What is together with the first of an island. */
typedef struct island {
	uint32_t members, with_plane; /* those that lie in a plane of their own, not a neighbour's */
	uint32_t fellows, others; /* in the members' planes: of the island, and of surfaces around */
} island;

/* Joins a candidate far off to those that it has a plane in common with, and counts the rest of
 * that plane. */
static void join_island(const stray_step *step, size_t i, uint32_t *parent, island *own)
{
	surrounding around;
	const double *plane = step->plane + 4 * i;
	look_around(step, i, &around);
	for (int j = 0; j < around.count; j++) {
		uint32_t other = step->candidate_of[around.place[j]];
		bool fellow = other > 0 && step->alone[other - 1] == IN_COMMON;
		bool in_plane = plane[3] > 0 && fabs(dot(around.at[j], plane)) <= plane[3];
		own->fellows += in_plane && fellow;
		own->others += in_plane && !fellow;
		if (!fellow)
			continue;
		uint32_t a = find_first(parent, (uint32_t)i), b = find_first(parent, other - 1);
		parent[a < b ? b : a] = a < b ? a : b;
	}
	own->members = 1;
	own->with_plane = plane[3] > 0;
}

static bool is_island(const island *all)
{
	bool few = all->members < ISLAND || 2 * all->with_plane < all->members;
	return few && all->others < all->fellows;
}

/* A few points on a plane by themselves, as on a crane, a wire, or what is seen through a gap, are
 * no surface either: that would have more of them, half of them with a plane of their own, or go on
 * in others. False when memory is short. */
static bool judge_islands(stray_step *step)
{
	size_t n = step->candidate_count;
	uint32_t *parent = gw_allocate_array(n, sizeof *parent);
	island *all = gw_allocate_zeros(n, sizeof *all);
	bool good = parent && all;
	for (size_t i = 0; good && i < n; i++)
		parent[i] = (uint32_t)i;
	for (size_t i = 0; good && i < n; i++)
		if (step->alone[i] == IN_COMMON)
			join_island(step, i, parent, all + i);
	for (size_t i = n; good && i-- > 0;) {
		size_t first = find_first(parent, (uint32_t)i);
		if (first == i)
			continue;
		all[first].members += all[i].members;
		all[first].with_plane += all[i].with_plane;
		all[first].fellows += all[i].fellows;
		all[first].others += all[i].others;
	}
	for (size_t i = 0; good && i < n; i++)
		if (step->alone[i] == IN_COMMON)
			step->alone[i] = is_island(&all[find_first(parent, (uint32_t)i)]);
	free(parent);
	free(all);
	return good;
}

/* Finds those alone among the candidates that are not gone. */
static bool judge(stray_step *step)
{
	size_t n = step->candidate_count;
	memset(step->plane, 0, 4 * n * sizeof *step->plane);
	memset(step->asked, 0, n);
	memset(step->alone, 0, n);
	if (!search_wanted(step, step->again ? step->far : NULL))
		return false;
	gw_parallel_for(step->threads, n, CHUNK, judge_far_off, step);
	ask_for_planes(step);
	if (step->again && !search_wanted(step, step->asked))
		return false;
	gw_parallel_for(step->threads, n, CHUNK, find_planes, step);
	gw_parallel_for(step->threads, n, CHUNK, judge_planes, step);
	return judge_islands(step);
}

/* Those that are alone are strays, and gone; returns how many. */
static size_t take_out(stray_step *step)
{
	size_t found = 0;
	for (size_t place = 0; place < step->thin_count; place++) {
		uint32_t candidate = step->candidate_of[place];
		if (candidate == 0 || !step->alone[candidate - 1])
			continue;
		step->gone[place] = 1;
		step->stray[step->candidate[candidate - 1]] = 1;
		found++;
	}

	step->strays += found;
	return found;
}

/* Without those that were taken out others are alone that were in a plane with them, but none that
 * lay far off nothing at first: or the outermost leaves of trees would go, one layer after the
 * other. */
static bool judge_often(stray_step *step)
{
	size_t n = step->candidate_count, found = 1;
	step->plane = gw_allocate_array(n, 4 * sizeof *step->plane);
	step->asked = gw_allocate_array(n, sizeof *step->asked);
	step->alone = gw_allocate_array(n, sizeof *step->alone);
	if (!step->plane || !step->asked || !step->alone || !build_index(step))
		return false;
	for (int round = 0; round < ROUNDS && found > 0; round++) {
		if (step->thin_count - step->strays <= SEARCHED)
			break;
		if (!judge(step))
			return false;
		found = take_out(step);
		step->again = true;
	}
	return true;
}

static void take_marks_back(size_t points, gw_stray_marks *marks)
{
	marks->sparse = true;
	for (size_t i = 0; i < points; i++)
		if (marks->far[i] == FOUND_ALONE) {
			marks->mark[i] = 0;
			marks->count--;
		}
}

static void mark_points(const stray_step *step, const gw_points *points, gw_stray_marks *marks)
{
	const gw_surfels *s = step->surfels;
	marks->alone += step->strays;
	if (marks->alone > marks->surfels / MOST) {
		take_marks_back(s->point_count, marks);
		return;
	}
	for (size_t i = 0; step->strays > 0 && i < s->point_count; i++)
		if (s->surfel_of_point[i] != UINT32_MAX && step->stray[s->surfel_of_point[i]]) {
			set_mark(marks, i, kind_of(points->position + 3 * i, GW_STRAY_ALONE));
			marks->far[i] = FOUND_ALONE;
		}
}

/* Takes over which points lay far off when they were first looked at, if they were. */
static bool recall_far(const gw_stray_marks *marks, stray_step *step)
{
	const gw_surfels *s = step->surfels;
	step->far = gw_allocate_zeros(step->candidate_count, 1);
	uint8_t *far = marks->far ? gw_allocate_zeros(s->count, 1) : NULL;
	step->again = far != NULL;
	for (size_t i = 0; far && i < s->point_count; i++)
		if (marks->far[i] && s->surfel_of_point[i] != UINT32_MAX)
			far[s->surfel_of_point[i]] = 1;
	for (size_t i = 0; far && step->far && i < step->candidate_count; i++)
		step->far[i] = far[step->candidate[i]];
	free(far);
	return step->far && (step->again || !marks->far);
}

/* False when memory is short. */
static bool keep_far(const stray_step *step, gw_stray_marks *marks)
{
	const gw_surfels *s = step->surfels;
	if (marks->far)
		return true;
	uint8_t *far = gw_allocate_zeros(s->count, 1);
	marks->surfels = s->count;
	marks->far = gw_allocate_zeros(s->point_count, 1);
	for (size_t i = 0; far && i < step->candidate_count; i++)
		far[step->candidate[i]] = step->far[i];
	for (size_t i = 0; far && marks->far && i < s->point_count; i++)
		if (s->surfel_of_point[i] != UINT32_MAX)
			marks->far[i] = far[s->surfel_of_point[i]];
	bool kept = far && marks->far;
	free(far);
	return kept;
}

void gw_strays_clear(gw_stray_marks *marks)
{
	free(marks->mark);
	free(marks->far);
	*marks = (gw_stray_marks){ .count = 0 };
}

static bool find_strays(stray_step *step, const gw_points *points, gw_stray_marks *marks)
{
	const gw_surfels *s = step->surfels;
	step->stray = gw_allocate_zeros(s->count, 1);
	if (!step->stray || !gw_stray_cells_make(s, FEW_AROUND, step->threads, &step->cells) ||
		!take_candidates(step) || !recall_far(marks, step))
		return false;
	bool enough = step->candidate_count > 0 && step->thin_count > SEARCHED;
	if ((enough && !judge_often(step)) || !keep_far(step, marks))
		return false;
	mark_points(step, points, marks);
	return true;
}

gw_status gw_strays_mark_alone(const gw_points *points, const gw_surfels_options *options,
							   const gw_surfels *surfels, gw_stray_marks *marks, gw_error *error)
{
	stray_step step = { .surfels = surfels, .threads = options->threads };
	if (points->keep_strays || marks->sparse || surfels->count < CLOUD_LEAST)
		return GW_OK;
	bool good = find_strays(&step, points, marks);
	gw_neighbour_index_free(step.index);
	void *owned[] = { step.sparse, step.thin,  step.candidate, step.cell,        step.query,
					  step.found,  step.plane, step.asked,     step.alone,       step.squared,
					  step.gone,   step.stray, step.far,       step.candidate_of };
	for (size_t i = 0; i < sizeof owned / sizeof *owned; i++)
		free(owned[i]);
	gw_stray_cells_clear(&step.cells);
	return good ? GW_OK
				: gw_fail(error, GW_ERROR_MEMORY, "no memory to look for strays among %zu points",
						  surfels->count);
}

/* ------------------------------------------------------------------------------------ the list */

static gw_stray describe(const gw_points *points, size_t i, gw_stray_kind kind)
{
	gw_stray stray = { .point = (uint32_t)i, .surfel = UINT32_MAX, .kind = (uint32_t)kind };
	for (size_t k = 0; k < 3; k++) {
		float a = points->albedo ? points->albedo[3 * i + k] : GW_ALBEDO_DEFAULT;
		float e = points->emission ? points->emission[3 * i + k] : 0;
		stray.albedo[k] = isnan(a) ? GW_ALBEDO_DEFAULT : fminf(fmaxf(a, 0), GW_ALBEDO_MAX);
		stray.emission[k] = isfinite(e) && e > 0 ? e : 0;
	}
	return stray;
}

gw_status gw_strays_list(const gw_points *points, const gw_stray_marks *marks,
						 gw_neighbours *search, gw_surfels *surfels, gw_error *error)
{
	gw_neighbour_list list;
	if (marks->count == 0)
		return GW_OK;
	surfels->stray = gw_allocate_zeros(marks->count, sizeof *surfels->stray);
	if (!surfels->stray)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu strays", marks->count);
	surfels->non_finite -= marks->count;
	for (size_t i = 0; i < points->count; i++) {
		double place[3];
		if (marks->mark[i] == 0)
			continue;
		gw_stray *stray = surfels->stray + surfels->stray_count++;
		*stray = describe(points, i, (gw_stray_kind)(marks->mark[i] - 1));
		for (int k = 0; k < 3; k++) {
			double low = surfels->minimum[k], high = surfels->maximum[k];
			double local = points->position[3 * i + (size_t)k] - surfels->origin[k];
			/* From so far off all is about as near that is at this side of the cloud. */
			place[k] = fmin(fmax(local, low - (high - low)), high + (high - low));
		}
		gw_neighbours_at(search, place, &list);
		if (list.count > 0)
			stray->surfel = list.index[0];
	}
	return GW_OK;
}

void gw_strays_count(const gw_surfels *surfels, const gw_points *points,
					 gw_stray_count count[GW_STRAY_KIND_COUNT])
{
	memset(count, 0, GW_STRAY_KIND_COUNT * sizeof *count);
	for (size_t i = 0; i < surfels->stray_count; i++) {
		gw_stray_count *kind = &count[surfels->stray[i].kind];
		size_t point = surfels->stray[i].point;
		if (kind->points++ > 0 && point > kind->example)
			continue;
		kind->example = point;
		memcpy(kind->position, points->position + 3 * point, sizeof kind->position);
	}
}

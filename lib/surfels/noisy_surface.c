/*
 * noisy_surface.c - see noisy_surface.h.
 *
 * Points are sorted into cells half as wide as the reach of a plane, of which each knows its number
 * of points and the sums of their coordinates and products. So a plane takes but the cells around
 * its own, with weights that fall to 0 at its reach; and a point goes to where the planes of the
 * cells around it have it, with such weights, too, that it makes no steps from cell to cell. Planes
 * of cells that an edge runs across leave more than those beside it, and count less there.
 */
#include "surfels/noisy_surface.h"

#include "base/key_sort.h"
#include "base/memory.h"
#include "base/nth_element.h"
#include "base/sorted_keys.h"
#include "glowworm_picture.h"
#include "normals/plane_normal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Reaches that are tried: from so many distances to the last of some neighbours, each so many times
 * the one before. Where none will do, points fill space. */
#define REACH_FIRST 2.0
#define REACH_GROWTH 1.4142135623730951
#define REACHES 9

/* A reach will do from so many times on what its planes leave, root mean square. The weights see
 * two thirds of the noise: so it is five standard deviations. */
#define REACH_ENOUGH 7.5

/* What noise leaves is about the same at the reaches beside; it grows with them where it is bushes
 * and roofs that stand above the ground: over twice the reach, by 1.4 of an airborne scan of trees
 * and houses, and by 1.1 of a noisy room. */
#define STEADY 1.3

/* Places that say which, and points that are looked at for it at most. */
#define PLACES 1024u
#define POINTS_FOR_REACH 1000000u

/* A plane is none where it leaves more than this share of all squares, as in corners, or where
 * there are fewer points; and points further off it than so many times what it leaves are none of
 * its surface. */
#define SHARE_MOST 0.12
#define POINTS_LEAST 8.0
#define EXACT 1e-12 /* share of all squares: less is rounding */
#define FAR_OFF 4.0

/* The first planes are askew where noise lies on one side of them, in the outermost cells. */
#define ROUNDS 2

/* Cells along an axis. */
#define CELLS_MOST 2097152.0

/* Cells around a cell whose planes a point is put onto, and that its plane is taken from; near
 * edges the latter for both. */
#define BESIDE 1
#define AROUND 2
#define AROUND_COUNT 125u

/*
 * Crowded are points whose last neighbours are nearer than this share of how near half of all
 * points have theirs: as of the rings above and below a scanner, of which each has as many points
 * as one around its equator. Noise is a hundred times as wide as they are apart, and what planes
 * leave of it still too wide. So they are looked at from reaches on that others have, and points of
 * a cell of half the share become one.
 */
#define CROWDED 0.5
#define CROWDED_LEAST 100u

#define NO_CELL UINT32_MAX

/* The plane of a cell that leaves more than so many times what one beside it does, or none that
 * holds, runs across an edge. */
#define BENT 1.2

/* There points go to planes from so many times as far, by how little these leave and how near they
 * are, in standard deviations of the noise: these times what is left (REACH_ENOUGH). */
#define EDGE_REACH 1.5
#define DEVIATION 1.5

/*
 * Where points are further apart than noise is wide, a reach is wide for much else: both faces of a
 * thin wall are within it. So where a plane leaves so many times what it leaves at this share of
 * the points, these are parted by its sides, and then by which of the planes of these parts they
 * are nearer to. They are two sheets, of a plane each, if these are about parallel and further
 * apart than so many times what either leaves. And points go to no plane that is further off than
 * noise is (FAR_OFF).
 * Six times was chosen by carried scans of rooms and a corridor with 40,000 points: by four, walls
 * that drift has put twice are two, and the corridor is half as much off again; by eight, rooms are
 * a little more off. The other numbers were not varied.
 */
#define SHEETS 2u
#define SHEETS_SINGLE 0.1
#define SHEETS_LEAVE 1.5
#define SHEETS_APART 6.0
#define SHEETS_PARALLEL 0.9
#define SHEETS_ROUNDS 3

typedef struct cell {
	double points, sum[3], product[6]; /* xx, xy, xz, yy, yz, zz */
} cell;

typedef struct cell_plane {
	double normal[3], offset, left; /* metres: of what lies on it, and root mean square off it */
	double most;                    /* metres: what is further off it goes elsewhere */
	bool holds;
} cell_plane;

typedef struct flattening {
	double *place;        /* 3 a surfel */
	const uint32_t *some; /* count, the surfels that are looked at; NULL: all */
	size_t count, step;   /* every so many of these for now */
	double low[3], reach;
	bool sparse;  /* points are further apart than noise is wide */
	double noise; /* metres: what planes left at most points */
	uint32_t threads;
	gw_keyed *sorted; /* points by cells */
	size_t sorted_count;
	uint64_t *key;     /* cells: their Morton keys, ascending */
	size_t *first;     /* cells + 1: in sorted */
	cell *cell;        /* cells */
	cell_plane *plane; /* SHEETS a cell */
	size_t cells;
	uint8_t *moved; /* one a surfel */
	size_t moved_count;
	bool noisy; /* a reach was found, and points put onto planes */
} flattening;

static double squared(const double a[3], const double b[3])
{
	double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
	return x * x + y * y + z * z;
}

static double weight_at(double square, double reach)
{
	double left = 1.0 - square / (reach * reach);
	return left > 0.0 ? left * left : 0.0;
}

/* -------------------------------------------------------------------------------------- cells */

static uint64_t key_of(const flattening *f, const double *place)
{
	uint32_t at[3];
	for (int k = 0; k < 3; k++) {
		double along = floor(2.0 * (place[k] - f->low[k]) / f->reach);
		at[k] = (uint32_t)fmin(fmax(along, 0.0), CELLS_MOST - 1.0);
	}
	return gw_morton_encode(at[0], at[1], at[2]);
}

static void clear_cells(flattening *f)
{
	free(f->key);
	free(f->first);
	free(f->cell);
	free(f->plane);
	f->key = NULL;
	f->first = NULL;
	f->cell = NULL;
	f->plane = NULL;
}

static bool sort_points(flattening *f)
{
	size_t n = 0;
	for (size_t i = 0; i < f->count; i += f->step) {
		uint32_t surfel = f->some ? f->some[i] : (uint32_t)i;
		f->sorted[n++] = (gw_keyed){ key_of(f, f->place + 3 * (size_t)surfel), surfel };
	}
	f->sorted_count = n;
	if (!gw_sort_keyed(&f->sorted, n, 63, f->threads))
		return false;
	f->cells = 0;
	for (size_t i = 0; i < n; i++)
		f->cells += i == 0 || f->sorted[i].key != f->sorted[i - 1].key;
	return true;
}

static bool list_cells(flattening *f)
{
	clear_cells(f);
	f->key = gw_allocate_array(f->cells, sizeof *f->key);
	f->first = gw_allocate_array(f->cells + 1, sizeof *f->first);
	f->cell = gw_allocate_zeros(f->cells, sizeof *f->cell);
	f->plane = gw_allocate_zeros(f->cells, SHEETS * sizeof *f->plane);
	if (!f->key || !f->first || !f->cell || !f->plane)
		return false;
	size_t at = 0;
	for (size_t i = 0; i < f->sorted_count; i++)
		if (i == 0 || f->sorted[i].key != f->sorted[i - 1].key) {
			f->key[at] = f->sorted[i].key;
			f->first[at++] = i;
		}
	f->first[at] = f->sorted_count;
	return true;
}

static void add_point(cell *c, const double *p)
{
	const double product[6] = { p[0] * p[0], p[0] * p[1], p[0] * p[2],
								p[1] * p[1], p[1] * p[2], p[2] * p[2] };
	c->points += 1.0;
	for (int k = 0; k < 3; k++)
		c->sum[k] += p[k];
	for (int k = 0; k < 6; k++)
		c->product[k] += product[k];
}

static void sum_cells(void *user, size_t first, size_t last, uint32_t worker)
{
	const flattening *f = user;
	(void)worker;
	for (size_t c = first; c < last; c++)
		for (size_t i = f->first[c]; i < f->first[c + 1]; i++)
			add_point(&f->cell[c], f->place + 3 * (size_t)f->sorted[i].item);
}

static uint32_t find_cell(const flattening *f, const uint32_t at[3], const int way[3])
{
	uint32_t to[3];
	for (int k = 0; k < 3; k++) {
		int64_t along = (int64_t)at[k] + way[k];
		if (along < 0 || along >= (int64_t)CELLS_MOST)
			return NO_CELL;
		to[k] = (uint32_t)along;
	}
	uint64_t key = gw_morton_encode(to[0], to[1], to[2]);
	size_t found = gw_lower_bound(f->key, f->cells, key);
	return found < f->cells && f->key[found] == key ? (uint32_t)found : NO_CELL;
}

static void middle_of(const cell *c, double middle[3])
{
	for (int k = 0; k < 3; k++)
		middle[k] = c->sum[k] / c->points;
}

/* ------------------------------------------------------------------------------------- planes */

static void add_weighted(cell *sum, const cell *c, double weight)
{
	sum->points += weight * c->points;
	for (int k = 0; k < 3; k++)
		sum->sum[k] += weight * c->sum[k];
	for (int k = 0; k < 6; k++)
		sum->product[k] += weight * c->product[k];
}

/* The plane through what was summed up. */
static cell_plane plane_of(const cell *sum)
{
	static const int row[6] = { 0, 0, 0, 1, 1, 2 }, column[6] = { 0, 1, 2, 1, 2, 2 };
	cell_plane plane = { .holds = false };
	double middle[3], covariance[6], least, all;
	middle_of(sum, middle);
	for (int k = 0; k < 6; k++)
		covariance[k] = sum->product[k] / sum->points - middle[row[k]] * middle[column[k]];
	all = covariance[0] + covariance[3] + covariance[5];
	if (!gw_plane_of_covariance(covariance, plane.normal, &least))
		return plane;
	for (int k = 0; k < 3; k++)
		plane.offset += plane.normal[k] * middle[k];
	plane.left = sqrt(fmax(least, EXACT * all));
	plane.most = FAR_OFF * plane.left;
	plane.holds = sum->points >= POINTS_LEAST && least < SHARE_MOST * all;
	return plane;
}

/* Cells so many cells away at most, itself among them. */
static uint32_t list_cells_around(const flattening *f, size_t c, int most,
								  uint32_t found[AROUND_COUNT])
{
	uint32_t at[3], count = 0;
	int way[3];
	gw_morton_decode(f->key[c], at);
	for (way[2] = -most; way[2] <= most; way[2]++)
		for (way[1] = -most; way[1] <= most; way[1]++)
			for (way[0] = -most; way[0] <= most; way[0]++) {
				uint32_t other = find_cell(f, at, way);
				if (other != NO_CELL)
					found[count++] = other;
			}
	return count;
}

static void find_plane(const flattening *f, size_t c)
{
	cell sum = { 0 };
	double middle[3], other[3];
	uint32_t around[AROUND_COUNT], count = list_cells_around(f, c, AROUND, around);
	middle_of(&f->cell[c], middle);
	for (uint32_t j = 0; j < count; j++) {
		const cell *found = &f->cell[around[j]];
		middle_of(found, other);
		add_weighted(&sum, found, weight_at(squared(middle, other), f->reach));
	}
	f->plane[SHEETS * c] = plane_of(&sum);
}

static void find_planes(void *user, size_t first, size_t last, uint32_t worker)
{
	const flattening *f = user;
	(void)worker;
	for (size_t c = first; c < last; c++)
		find_plane(f, c);
}

/* Cells of a reach, and their planes. */
static gw_status make_planes(flattening *f, gw_neighbours *search, double reach, gw_error *error)
{
	f->reach = reach;
	if (!sort_points(f) || !list_cells(f))
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the planes of %zu points", f->count);
	GW_TRY(gw_neighbours_loop(search, f->cells, sum_cells, f, error));
	return gw_neighbours_loop(search, f->cells, find_planes, f, error);
}

/* ------------------------------------------------------------------------------------- reach */

/* Half of the places have the last of some neighbours nearer than this. */
static double usual_distance(const gw_surfels *s, gw_neighbours *search)
{
	float distance[PLACES];
	size_t step = s->count / PLACES + 1, count = 0;
	for (size_t i = 0; i < s->count; i += step) {
		const float *p = s->position + 3 * i;
		gw_neighbour_list list;
		gw_neighbours_at(search, (const double[3]){ (double)p[0], (double)p[1], (double)p[2] },
						 &list);
		distance[count++] = list.count > 0 ? list.distance[list.count - 1] : 0.0f;
	}
	return count > 0 ? (double)gw_nth_element(distance, count, count / 2) : 0.0;
}

/* What planes leave at a share of the points at most. */
static double usually_left(const flattening *f, double share)
{
	float left[PLACES];
	size_t step = f->sorted_count / PLACES + 1, count = 0, c = 0;
	for (size_t i = 0; i < f->sorted_count; i += step) {
		while (f->first[c + 1] <= i)
			c++;
		left[count++] = (float)f->plane[SHEETS * c].left;
	}
	return count > 0 ? (double)gw_nth_element(left, count, (size_t)(share * (double)count)) : 0.0;
}

/* The least reach that is wide for what its planes leave, if that is noise; 0: there is none. Of
 * crowded points, planes along one ring leave nothing, and those across two more than noise. */
static gw_status find_reach(flattening *f, gw_neighbours *search, double reach, double *found,
							gw_error *error)
{
	double before = INFINITY, earlier = INFINITY; /* what planes left at the last two reaches */
	*found = 0.0;
	f->step = f->count / POINTS_FOR_REACH + 1;
	for (int k = 0; k <= REACHES && reach > 0.0; k++, reach *= REACH_GROWTH) {
		GW_TRY(make_planes(f, search, reach, error));
		double left = usually_left(f, 0.5);
		/* Was the reach before this one enough? */
		if (reach > REACH_GROWTH * REACH_ENOUGH * before) {
			*found = left < STEADY * fmin(earlier, before) ? reach / REACH_GROWTH : 0.0;
			if (*found > 0.0 || !f->some)
				break;
		}
		earlier = before;
		before = left;
	}
	f->step = 1;
	return GW_OK;
}

/* ------------------------------------------------------------------------------------- sheets */

static double distance_off(const cell_plane *p, const double *place)
{
	double off = -p->offset;
	for (int k = 0; k < 3; k++)
		off += p->normal[k] * place[k];
	return off;
}

/* Cells, and the place that points in them count by their distance to. */
typedef struct cells_around {
	uint32_t cell[AROUND_COUNT], count;
	double middle[3];
} cells_around;

/* The sums of points by which of two planes they are nearer to; of points on either side of the
 * first one where the second one does not hold. */
static void part_points(const flattening *f, const cells_around *around,
						const cell_plane sheet[SHEETS], cell sum[SHEETS])
{
	for (uint32_t j = 0; j < around->count; j++)
		for (size_t i = f->first[around->cell[j]]; i < f->first[around->cell[j] + 1]; i++) {
			const double *p = f->place + 3 * (size_t)f->sorted[i].item;
			double off = distance_off(&sheet[0], p), other = distance_off(&sheet[1], p);
			bool second = sheet[1].holds ? fabs(other) < fabs(off) : off > 0.0;
			cell own = { 0 };
			add_point(&own, p);
			add_weighted(&sum[second], &own, weight_at(squared(around->middle, p), f->reach));
		}
}

/* Do planes lie as two sheets around a place, where one leaves so much? */
static bool are_sheets(const cell_plane sheet[SHEETS], double left, const double place[3])
{
	const double *a = sheet[0].normal, *b = sheet[1].normal;
	double cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
	double apart =
		distance_off(&sheet[0], place) - copysign(1.0, cosine) * distance_off(&sheet[1], place);
	double most = fmax(sheet[0].left, sheet[1].left);
	return most < left / SHEETS_LEAVE && fabs(cosine) > SHEETS_PARALLEL &&
		   fabs(apart) > SHEETS_APART * most;
}

/* Puts two planes in place of that of a cell, if its points lie on two sheets. */
static void split_plane(const flattening *f, size_t c)
{
	cell_plane *own = f->plane + SHEETS * c, sheet[SHEETS] = { *own, { .holds = false } };
	cells_around around;
	around.count = list_cells_around(f, c, AROUND, around.cell);
	middle_of(&f->cell[c], around.middle);
	for (int round = 0; round < SHEETS_ROUNDS; round++) {
		cell sum[SHEETS] = { 0 };
		part_points(f, &around, sheet, sum);
		for (uint32_t i = 0; i < SHEETS; i++) {
			if (sum[i].points < POINTS_LEAST)
				return;
			sheet[i] = plane_of(&sum[i]);
			if (!sheet[i].holds)
				return;
		}
	}
	if (are_sheets(sheet, own->left, around.middle))
		memcpy(own, sheet, sizeof sheet);
}

/* The planes of cells beside what planes leave elsewhere. */
typedef struct sheet_work {
	const flattening *f;
	double left;
} sheet_work;

static void split_some(void *user, size_t first, size_t last, uint32_t worker)
{
	const sheet_work *w = user;
	(void)worker;
	for (size_t c = first; c < last; c++)
		if (w->f->plane[SHEETS * c].left > SHEETS_LEAVE * w->left)
			split_plane(w->f, c);
}

/* Splits planes that leave more than those of single sheets do, of which there are some in any
 * scene; and then lets none take more than noise. */
static gw_status split_planes(flattening *f, gw_neighbours *search, gw_error *error)
{
	sheet_work work = { f, usually_left(f, SHEETS_SINGLE) };
	GW_TRY(gw_neighbours_loop(search, f->cells, split_some, &work, error));
	double usual = usually_left(f, 0.5);
	for (size_t i = 0; i < SHEETS * f->cells; i++)
		f->plane[i].most = FAR_OFF * fmin(f->plane[i].left, usual);
	return GW_OK;
}

/* ------------------------------------------------------------------------------------ points */

/* Planes that points of a cell may go to. */
typedef struct planes_around {
	const cell_plane *plane[SHEETS * AROUND_COUNT];
	double middle[SHEETS * AROUND_COUNT][3]; /* of their cells */
	uint32_t count;
	double reach;
	bool edge; /* runs across the cell */
} planes_around;

/* Those of cells so many cells away at most. */
static void list_planes(const flattening *f, size_t c, int most, planes_around *around)
{
	uint32_t found[AROUND_COUNT], count = list_cells_around(f, c, most, found);
	around->count = 0;
	for (uint32_t j = 0; j < SHEETS * count; j++) {
		const cell_plane *plane = &f->plane[SHEETS * found[j / SHEETS] + j % SHEETS];
		if (!plane->holds)
			continue;
		middle_of(&f->cell[found[j / SHEETS]], around->middle[around->count]);
		around->plane[around->count++] = plane;
	}
}

/* Does the plane of a cell leave more than one beside it does? */
static bool is_bent(const cell_plane *own, const planes_around *beside)
{
	double least = INFINITY;
	for (uint32_t j = 0; j < beside->count; j++)
		least = fmin(least, beside->plane[j]->left);
	return !own->holds || own->left > BENT * least;
}

static void look_around(const flattening *f, size_t c, planes_around *around)
{
	list_planes(f, c, BESIDE, around);
	around->edge = is_bent(&f->plane[SHEETS * c], around);
	around->reach = around->edge ? EDGE_REACH * f->reach : f->reach;
	if (around->edge)
		list_planes(f, c, AROUND, around);
}

/* How far a place is off a plane; infinity where that is too far for a place that lies on it. */
static double off_plane(const cell_plane *p, const double *place)
{
	double off = distance_off(p, place);
	return fabs(off) > p->most ? INFINITY : off;
}

/* The least that a plane leaves on which a place may lie. */
static double least_left(const planes_around *around, const double *place)
{
	double least = INFINITY;
	for (uint32_t j = 0; j < around->count; j++)
		if (isfinite(off_plane(around->plane[j], place)))
			least = fmin(least, around->plane[j]->left);
	return least;
}

/* Where the planes around have a point; false where there are none. */
static bool settle(const planes_around *around, double *place)
{
	double sum = 0.0, way[3] = { 0 }, least = around->edge ? least_left(around, place) : 0.0;
	for (uint32_t j = 0; j < around->count; j++) {
		const cell_plane *p = around->plane[j];
		double off = off_plane(p, place);
		if (!isfinite(off))
			continue;
		double weight = weight_at(squared(place, around->middle[j]), around->reach);
		if (around->edge) {
			double flat = least / p->left, apart = off / (DEVIATION * p->left);
			weight *= flat * flat * exp(-0.5 * apart * apart);
		}
		for (int k = 0; k < 3; k++)
			way[k] -= weight * off * p->normal[k];
		sum += weight;
	}
	for (int k = 0; k < 3 && sum > 0.0; k++)
		place[k] += way[k] / sum;
	return sum > 0.0;
}

static void settle_points(void *user, size_t first, size_t last, uint32_t worker)
{
	const flattening *f = user;
	(void)worker;
	for (size_t c = first; c < last; c++) {
		planes_around around;
		look_around(f, c, &around);
		for (size_t i = f->first[c]; i < f->first[c + 1]; i++) {
			size_t point = f->sorted[i].item;
			f->moved[point] |= settle(&around, f->place + 3 * point);
		}
	}
}

static gw_status flatten(flattening *f, gw_neighbours *search, double reach, gw_error *error)
{
	double found;
	GW_TRY(find_reach(f, search, reach, &found, error));
	f->noisy = found > 0.0;
	for (int round = 0; round < ROUNDS && found > 0.0; round++) {
		GW_TRY(make_planes(f, search, found, error));
		f->noise = fmax(f->noise, usually_left(f, 0.5));
		if (f->sparse)
			GW_TRY(split_planes(f, search, error));
		GW_TRY(gw_neighbours_loop(search, f->cells, settle_points, f, error));
	}
	return GW_OK;
}

/* Points of a cell so wide become one. */
static gw_status join_cells(flattening *f, gw_neighbours *search, double width, gw_error *error)
{
	f->reach = 2.0 * width;
	if (!sort_points(f) || !list_cells(f))
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to join %zu points", f->count);
	GW_TRY(gw_neighbours_loop(search, f->cells, sum_cells, f, error));
	for (size_t c = 0; c < f->cells; c++)
		for (size_t i = f->first[c]; i < f->first[c + 1]; i++) {
			middle_of(&f->cell[c], f->place + 3 * (size_t)f->sorted[i].item);
			f->moved[f->sorted[i].item] = 1;
		}
	return GW_OK;
}

/* Hands the places of surfels on to their points. */
static size_t hand_on(const flattening *f, const gw_surfels *s, double *position)
{
	size_t moved = 0;
	for (size_t i = 0; i < s->count; i++)
		moved += f->moved[i];
	for (size_t i = 0; moved > 0 && i < s->point_count; i++) {
		uint32_t surfel = s->surfel_of_point[i];
		if (surfel == UINT32_MAX || !f->moved[surfel])
			continue;
		for (size_t k = 0; k < 3; k++)
			position[3 * i + k] = s->origin[k] + f->place[3 * (size_t)surfel + k];
	}
	return moved;
}

/* Puts some points, or all, onto the planes around them, from a reach on. */
static gw_status flatten_some(flattening *f, const gw_surfels *s, gw_neighbours *search,
							  double reach, double *position, gw_error *error)
{
	f->step = 1;
	f->place = gw_allocate_array(s->count, 3 * sizeof *f->place);
	f->sorted = gw_allocate_array(f->count, sizeof *f->sorted);
	f->moved = gw_allocate_zeros(s->count, 1);
	gw_status status = GW_OK;
	if (!f->place || !f->sorted || !f->moved)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory for the noise of %zu points", f->count);
	for (int k = 0; k < 3; k++)
		f->low[k] = (double)s->minimum[k];
	for (size_t i = 0; status == GW_OK && i < 3 * s->count; i++)
		f->place[i] = (double)s->position[i];
	if (status == GW_OK)
		status = flatten(f, search, reach, error);
	if (status == GW_OK && f->some && f->noisy)
		status = join_cells(f, search, 0.5 * CROWDED * reach, error);
	if (status == GW_OK)
		f->moved_count = hand_on(f, s, position);
	clear_cells(f);
	free(f->place);
	free(f->sorted);
	free(f->moved);
	return status;
}

gw_status gw_noisy_surface_flatten(gw_noisy_points *points, double *position, size_t *moved,
								   gw_error *error)
{
	const gw_surfels *s = points->surfels;
	flattening f = { .some = points->some,
					 .count = s->count,
					 .threads = points->threads,
					 .sparse = points->sparse };
	double usual = usual_distance(s, points->search);
	if (points->some)
		f.count = points->count;
	gw_status status = flatten_some(&f, s, points->search,
									points->some ? usual : REACH_FIRST * usual, position, error);
	*moved = f.moved_count;
	points->noise = f.noise;
	return status;
}

/* Notes how far the neighbours of a surfel are. */
static void note_reach(void *user, size_t surfel, const gw_neighbour_list *list)
{
	float *reach = user;
	reach[surfel] = list->count > 0 ? list->distance[list->count - 1] : 0.0f;
}

gw_status gw_crowded_points_find(gw_noisy_points *points, gw_error *error)
{
	const gw_surfels *s = points->surfels;
	double most = CROWDED * usual_distance(s, points->search);
	float *reach = gw_allocate_array(s->count, sizeof *reach);
	points->some = gw_allocate_array(s->count, sizeof *points->some);
	points->count = 0;
	gw_status status = GW_OK;
	if (!reach || !points->some)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory for the noise of %zu points", s->count);
	if (status == GW_OK)
		status = gw_neighbours_visit_reach(points->search, note_reach, reach, error);
	for (size_t i = 0; status == GW_OK && i < s->count; i++)
		if ((double)reach[i] < most)
			points->some[points->count++] = (uint32_t)i;
	free(reach);
	if (status == GW_OK && points->count >= CROWDED_LEAST)
		return GW_OK;
	free(points->some);
	points->some = NULL;
	return status;
}

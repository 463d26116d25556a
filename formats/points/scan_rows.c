/* scan_rows.c - see scan_rows.h. */
#include "points/scan_rows.h"
#include "glowworm_host.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define POINTS_LEAST 2000u
#define LINES_LEAST 32u /* rows, and columns */
#define LINES_MOST 65536u
#define CELLS_MOST 8.0 /* cells a point */
#define SAMPLES 8192u  /* points at least that cells are looked for with, and one in so many of */
#define SAMPLE_OF 16u  /* all, but no more than sixteen for each of the most lines */
#define SAMPLES_MOST (16u * LINES_MOST)
#define GAP_LEAST 1e-6 /* share of all values' range that is no gap */
#define JUMP 8.0       /* between gaps within a row or column, and those from one to the next */
#define CENTER_OFF 0.1 /* cells by which a row may be off its place, and a point off its row */
#define POINT_OFF 0.2
#define REGULAR 0.95     /* share of rows, and of points, that are not */
#define SHARED_MOST 0.05 /* share of points whose cell another one has */
#define DEPTHS_LEAST 1.1 /* ratio of far to near depths: else it may be a grid drawn on a wall */
#define TANGENT_MOST 2.0 /* of the directions in a camera's picture, in whatever part of it */
#define ORDERED 0.99     /* share of steps through the file that go on as the picture does */

/* How directions are counted. */
typedef struct frame {
	bool camera;  /* along `axis`; else turning about it */
	int axis;     /* 0..2 */
	double ahead; /* 1, or -1 to look along -axis */
	bool uneven;  /* columns are of uneven widths */
} frame;

/* Evenly spaced values: first + step * (0 .. count - 1). Or such as a head that turns unevenly has
 * its columns at. */
typedef struct ruler {
	double first, step;
	uint32_t count;
	double *place; /* NULL: even; else count of them, that is where they are, in order; owned */
	double reach;  /* half of the least gap between these */
} ruler;

typedef struct rows {
	const scan_column *column[3];
	size_t count;
	double eye[3];
	bool moved; /* later, so that none of these axes need be up */
	size_t samples;
	double *value;  /* samples */
	double *gap;    /* samples */
	uint32_t *cell; /* count */
} rows;

/* Direction of a point as a frame counts it, and its depth, which is not above 0 behind a camera.
 * False for points without one: no numbers, or those at the eye, as which many write cells without
 * a depth. */
static bool direction_of(const rows *r, const frame *f, size_t i, double to[2], double *depth)
{
	double way[3];
	for (int k = 0; k < 3; k++)
		way[k] = scan_value(r->column[k], i) - r->eye[k];
	double along = f->ahead * way[f->axis];
	double a = way[(f->axis + 1) % 3], b = way[(f->axis + 2) % 3];
	double flat = hypot(a, b);
	if (!isfinite(along) || !isfinite(flat) || !(flat > 0.0 || along != 0.0))
		return false;
	if (f->camera) {
		to[0] = a / along;
		to[1] = b / along;
		*depth = along;
		return true;
	}
	to[0] = atan2(b, a);
	to[1] = atan2(along, flat);
	*depth = hypot(flat, along);
	return true;
}

static int compare_doubles(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

/* ------------------------------------------------------------------------------- one direction */

/* The gap from which on values are of another row or column; 0 when there is no such. */
static double find_border(rows *r, size_t used)
{
	size_t best = 0;
	double most = 0.0;
	double none = GAP_LEAST * (r->value[used - 1] - r->value[0]);
	for (size_t i = 0; i + 1 < used; i++)
		r->gap[i] = fmax(r->value[i + 1] - r->value[i], none);
	qsort(r->gap, used - 1, sizeof *r->gap, compare_doubles);
	for (size_t i = used - 1 - LINES_LEAST; i > used / 2; i--) {
		double ratio = r->gap[i] / r->gap[i - 1];
		if (ratio > most) {
			most = ratio;
			best = i;
		}
	}
	return most >= JUMP ? sqrt(r->gap[best] * r->gap[best - 1]) : 0.0;
}

/* Replaces the values by the centres of those that no border parts; returns how many. */
static size_t find_centers(double *value, size_t used, double border)
{
	size_t centers = 0;
	for (size_t first = 0, last; first < used; first = last) {
		double sum = 0.0;
		for (last = first; last == first || (last < used && value[last] - value[last - 1] < border);
			 last++)
			sum += value[last];
		value[centers++] = sum / (double)(last - first);
	}
	return centers;
}

/* The straight line through the centres, each counted by how many typical steps it lies on. */
static bool fit_ruler(rows *r, size_t centers, ruler *to)
{
	for (size_t i = 0; i + 1 < centers; i++)
		r->gap[i] = r->value[i + 1] - r->value[i];
	qsort(r->gap, centers - 1, sizeof *r->gap, compare_doubles);
	double typical = r->gap[(centers - 1) / 2], place = 0.0;
	double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
	for (size_t i = 0; i < centers; i++) {
		place += i > 0 ? round((r->value[i] - r->value[i - 1]) / typical) : 0.0;
		n++;
		x += place;
		xx += place * place;
		y += r->value[i];
		xy += place * r->value[i];
	}
	to->step = (n * xy - x * y) / (n * xx - x * x);
	to->first = (y - to->step * x) / n;
	to->count = place < LINES_MOST ? (uint32_t)place + 1 : 0;
	size_t even = 0;
	for (size_t i = 0; i < centers; i++) {
		double at = (r->value[i] - to->first) / to->step;
		even += fabs(at - round(at)) < CENTER_OFF;
	}
	return to->count >= LINES_LEAST && to->step > 0.0 && (double)even > REGULAR * (double)centers &&
		   (double)to->count < CELLS_MOST * n;
}

/* Keeps the centres as they are. */
static bool keep_places(const rows *r, size_t centers, double border, ruler *to)
{
	*to = (ruler){ .count = centers < LINES_MOST ? (uint32_t)centers : 0, .reach = 0.5 * border };
	to->place = to->count > 0 ? reallocarray(NULL, centers, sizeof *to->place) : NULL;
	if (to->place)
		memcpy(to->place, r->value, centers * sizeof *to->place);
	return to->place;
}

/* Rows, or columns, among the sampled values; uneven: which need not be evenly spaced. */
static bool find_ruler(rows *r, size_t used, bool uneven, ruler *to)
{
	if (used < 4 * LINES_LEAST)
		return false;
	qsort(r->value, used, sizeof *r->value, compare_doubles);
	double border = find_border(r, used);
	size_t centers = border > 0.0 ? find_centers(r->value, used, border) : 0;
	return centers >= LINES_LEAST &&
		   (uneven ? keep_places(r, centers, border, to) : fit_ruler(r, centers, to));
}

/* ---------------------------------------------------------------------------------- one frame */

/* Which point sample s is: one of its part of all, by chance, as even steps might meet the same few
 * columns again and again. */
static size_t sample_point(const rows *r, size_t s)
{
	double part = (double)r->count / (double)r->samples;
	uint32_t chance = (uint32_t)s * 2654435761u;
	chance = (chance ^ chance >> 15) * 2246822519u;
	size_t i = (size_t)(((double)s + (double)(chance ^ chance >> 13) * 0x1p-32) * part);
	return i < r->count ? i : r->count - 1;
}

/* The samples' values of direction k. Returns how many there are; 0 where a frame cannot be. */
static size_t take_samples(rows *r, const frame *f, int k)
{
	size_t used = 0;
	double near = INFINITY, far = 0.0, least = INFINITY, most = -INFINITY;
	for (size_t s = 0; s < r->samples; s++) {
		double to[2], depth;
		if (!direction_of(r, f, sample_point(r, s), to, &depth))
			continue;
		if (!(depth > 0.0))
			return 0;
		near = fmin(near, depth);
		far = fmax(far, depth);
		least = fmin(least, to[k]);
		most = fmax(most, to[k]);
		r->value[used++] = to[k];
	}
	bool in_view = !f->camera || (most < TANGENT_MOST && least > -TANGENT_MOST);
	return used >= SAMPLES / 8 && far > DEPTHS_LEAST * near && in_view ? used : 0;
}

/* The place next to a value, or UINT32_MAX where none is near. */
static uint32_t next_place(const ruler *to, double value)
{
	uint32_t low = 0, high = to->count - 1;
	while (low < high) {
		uint32_t middle = low + (high - low) / 2;
		if (0.5 * (to->place[middle] + to->place[middle + 1]) < value)
			low = middle + 1;
		else
			high = middle;
	}
	return fabs(to->place[low] - value) <= to->reach ? low : UINT32_MAX;
}

/* The cell along a ruler, or UINT32_MAX. */
static uint32_t place_on(const ruler *to, double value)
{
	if (to->place)
		return next_place(to, value);
	double at = (value - to->first) / to->step, whole = round(at);
	bool on = fabs(at - whole) < POINT_OFF && whole >= 0.0 && whole < (double)to->count;
	return on ? (uint32_t)whole : UINT32_MAX;
}

static bool same_place(const rows *r, size_t a, size_t b)
{
	bool same = true;
	for (int k = 0; k < 3; k++)
		same = same && scan_value(r->column[k], a) == scan_value(r->column[k], b);
	return same;
}

/* Puts all points into cells. Returns whether nearly each has one of its own; what some write twice
 * counts once.
 *   holder   one a cell, of zeros: receives the point in it, counted from 1 */
static bool fill_cells(rows *r, const frame *f, const ruler to[2], uint32_t *holder)
{
	size_t finite = 0, off = 0, shared = 0;
	for (size_t i = 0; i < r->count; i++) {
		double way[2], depth;
		r->cell[i] = UINT32_MAX;
		if (!direction_of(r, f, i, way, &depth) || !(depth > 0.0))
			continue;
		finite++;
		uint32_t column = place_on(&to[0], way[0]), row = place_on(&to[1], way[1]);
		if (column == UINT32_MAX || row == UINT32_MAX) {
			off++;
			continue;
		}
		size_t cell = (size_t)row * to[0].count + column;
		if (holder[cell] == 0) {
			r->cell[i] = (uint32_t)cell;
			holder[cell] = (uint32_t)i + 1;
		} else {
			shared += !same_place(r, i, holder[cell] - 1);
		}
	}
	return finite >= POINTS_LEAST && (double)off < (1.0 - REGULAR) * (double)finite &&
		   (double)shared < SHARED_MOST * (double)finite;
}

static gw_status fail_memory(const rows *r, gw_error *error)
{
	return gw_fail(error, GW_ERROR_MEMORY, "no memory for rows of %zu points", r->count);
}

static gw_status try_frame(rows *r, const frame *f, ruler to[2], bool *found, gw_error *error)
{
	*found = false;
	for (int k = 0; k < 2; k++)
		if (!find_ruler(r, take_samples(r, f, k), f->uneven && k == 0, &to[k]))
			return GW_OK;
	uint64_t cells = (uint64_t)to[0].count * to[1].count;
	if ((double)cells > CELLS_MOST * (double)r->count || cells >= UINT32_MAX)
		return GW_OK;
	uint32_t *holder = calloc((size_t)cells, sizeof *holder);
	if (!holder)
		return fail_memory(r, error);
	*found = fill_cells(r, f, to, holder);
	free(holder);
	return GW_OK;
}

/* ------------------------------------------------------------------------------ what was found */

/* Whether rows go down y in the order of the file, as depth cameras write them: row by row, or down
 * one column after the other. */
static bool goes_down(const rows *r, const frame *f, const ruler to[2])
{
	size_t steps = 0, by_rows = 0, by_columns = 0;
	uint32_t before = UINT32_MAX;
	if (!f->camera || f->axis != 2 || f->ahead < 0.0)
		return false;
	for (size_t i = 0; i < r->count; i++) {
		if (r->cell[i] == UINT32_MAX)
			continue;
		uint32_t row = r->cell[i] / to[0].count, column = r->cell[i] % to[0].count;
		uint32_t last = before / to[0].count, beside = before % to[0].count;
		bool first = before == UINT32_MAX;
		steps += !first;
		by_rows += !first && row >= last;
		by_columns += !first && (column > beside || (column == beside && row > last));
		before = r->cell[i];
	}
	return (double)(by_rows > by_columns ? by_rows : by_columns) > ORDERED * (double)steps;
}

/* Columns of uneven widths are no picture, but tell where the scanner stood. */
static gw_status take_scanner(scan *cloud, const rows *r, const ruler to[2], gw_error *error)
{
	char text[200];
	if (cloud->scanner_count > 0)
		return GW_OK;
	GW_TRY(scan_add_scanner(cloud, r->eye, 0, r->count, error));
	snprintf(text, sizeof text,
			 SCAN_NOTE "seen from %s,%s,%s, the points lie in %u columns and %u even rows: a "
					   "scanner stood there",
			 GW_SAID_PLACE(r->eye[0]), GW_SAID_PLACE(r->eye[1]), GW_SAID_PLACE(r->eye[2]),
			 to[0].count, to[1].count);
	return scan_add_comment(cloud, text, error);
}

static gw_status take_rows(scan *cloud, const rows *r, const frame *f, const ruler to[2],
						   gw_error *error)
{
	gw_range_image image = { .count = r->count, .columns = to[0].count, .rows = to[1].count };
	char text[200];
	memcpy(image.scanner, r->eye, sizeof image.scanner);
	GW_TRY(scan_add_image(cloud, &image, error));
	memcpy(cloud->image_cell, r->cell, r->count * sizeof *r->cell);
	if (cloud->scanner_count == 0)
		GW_TRY(scan_add_scanner(cloud, r->eye, 0, r->count, error));
	bool down = !r->moved && cloud->up != 'Y' && !cloud->says_up && goes_down(r, f, to);
	if (down)
		cloud->up = 'Y';
	snprintf(text, sizeof text,
			 SCAN_NOTE "seen from %s,%s,%s, this is a %s picture of %u by %u cells%s",
			 GW_SAID_PLACE(r->eye[0]), GW_SAID_PLACE(r->eye[1]), GW_SAID_PLACE(r->eye[2]),
			 f->camera ? "depth camera's" : "scanner's", to[0].count, to[1].count,
			 down ? ", in which -y points up; if it does not, give --up" : "");
	return scan_add_comment(cloud, text, error);
}

static gw_status look(scan *cloud, rows *r, gw_error *error)
{
	static const frame frames[] = { { true, 2, 1.0, false },  { true, 2, -1.0, false },
									{ true, 0, 1.0, false },  { false, 2, 1.0, false },
									{ false, 1, 1.0, false }, { false, 2, 1.0, true },
									{ false, 1, 1.0, true } };
	bool found = false;
	gw_status status = GW_OK;
	for (size_t i = 0; i < sizeof frames / sizeof *frames && !found && status == GW_OK; i++) {
		ruler to[2] = { { .place = NULL }, { .place = NULL } };
		status = try_frame(r, &frames[i], to, &found, error);
		if (found)
			status = frames[i].uneven ? take_scanner(cloud, r, to, error)
									  : take_rows(cloud, r, &frames[i], to, error);
		free(to[0].place);
	}
	return status;
}

gw_status scan_find_rows(scan *cloud, bool moved, gw_error *error)
{
	rows r = { .column = { scan_find(cloud, "x"), scan_find(cloud, "y"), scan_find(cloud, "z") },
			   .count = cloud->count,
			   .moved = moved };
	if (!r.column[0] || !r.column[1] || !r.column[2] || cloud->count < POINTS_LEAST ||
		cloud->count >= UINT32_MAX || cloud->image_count > 0 || cloud->scanner_count > 1)
		return GW_OK;
	if (cloud->scanner_count == 1)
		memcpy(r.eye, cloud->scanner, sizeof r.eye);
	r.samples = cloud->count / SAMPLE_OF > SAMPLES ? cloud->count / SAMPLE_OF : SAMPLES;
	r.samples = r.samples < SAMPLES_MOST ? r.samples : SAMPLES_MOST;
	r.samples = r.samples < cloud->count ? r.samples : cloud->count;
	r.value = reallocarray(NULL, r.samples, sizeof *r.value);
	r.gap = reallocarray(NULL, r.samples, sizeof *r.gap);
	r.cell = reallocarray(NULL, cloud->count, sizeof *r.cell);
	gw_status status = r.value && r.gap && r.cell ? look(cloud, &r, error) : fail_memory(&r, error);
	free(r.value);
	free(r.gap);
	free(r.cell);
	return status;
}

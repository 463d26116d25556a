/* scan_thinning.c - see scan_thinning.h. */
#include "points/scan_thinning.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* By how much cubes grow, of which surface has fewer by the square of it, until this share of the
 * points that may be kept is left. */
#define GROWTH 1.2
#define LEFT_MOST 0.75

/* Where that takes away next to nothing, cubes are far too narrow, and grow by this. */
#define HASTE 4.0
#define HELPED 0.99

/* Values of a column by which the first cubes are chosen. */
#define SAMPLES 1000u

/* The first cubes: of such a part of the width that they have when as many points as may be kept
 * lie on a square as wide as the first part. */
#define START 0.125

/* Columns by which points are told apart. */
typedef struct views {
	const scan_column *place[3], *normal[3]; /* NULL: has none */
} views;

static bool find_views(const scan *cloud, views *v)
{
	static const char *const place[3] = { "x", "y", "z" }, *const normal[3] = { "nx", "ny", "nz" };
	bool placed = true;
	for (int k = 0; k < 3; k++) {
		v->place[k] = scan_find(cloud, place[k]);
		v->normal[k] = scan_find(cloud, normal[k]);
		placed = placed && v->place[k];
	}
	if (!v->normal[0] || !v->normal[1] || !v->normal[2])
		v->normal[0] = NULL;
	return placed;
}

/* False where a place is not finite. */
static bool get_place(const views *v, size_t i, double place[3])
{
	for (int k = 0; k < 3; k++)
		place[k] = scan_value(v->place[k], i);
	return isfinite(place[0]) && isfinite(place[1]) && isfinite(place[2]);
}

/* ---------------------------------------------------------------------------- cubes and ranks */

/* The finalizer of splitmix64 (Steele and others 2014): every bit of the sum tells on all. */
static uint64_t mix(uint64_t state, uint64_t value)
{
	uint64_t z = state + value + UINT64_C(0x9e3779b97f4a7c15);
	z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
	z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
	return z ^ z >> 31;
}

static uint64_t rank_of(const double place[3])
{
	uint64_t rank = 0, bits;
	for (int k = 0; k < 3; k++) {
		memcpy(&bits, place + k, sizeof bits);
		rank = mix(rank, bits);
	}
	return rank;
}

/* Which of the six sides of a cube a point faces, or 6. */
static uint64_t side_of(const views *v, size_t i)
{
	double n[3], longest = 0.0;
	uint64_t side = 6;
	for (uint64_t k = 0; v->normal[0] && k < 3; k++) {
		n[k] = scan_value(v->normal[k], i);
		if (!(fabs(n[k]) > longest))
			continue;
		longest = fabs(n[k]);
		side = 2 * k + (n[k] < 0.0);
	}
	return side;
}

static uint64_t cube_of(const views *v, size_t i, const double place[3], double width)
{
	uint64_t cube = side_of(v, i);
	for (int k = 0; k < 3; k++)
		cube = mix(cube, (uint64_t)(int64_t)fmin(fmax(floor(place[k] / width), -0x1p62), 0x1p62));
	return cube;
}

/* ------------------------------------------------------------------------------ what is kept */

static gw_status no_memory(const scan_thinning *t, gw_error *error)
{
	return gw_fail(error, GW_ERROR_MEMORY, "no memory to keep %zu of the points", t->most);
}

/* Room for the columns of the first part, and what else it says. */
static gw_status open_kept(scan_thinning *t, const scan *part, gw_error *error)
{
	t->kept = (scan){ .count = t->most,
					  .up = part->up,
					  .says_up = part->says_up,
					  .noise_classes = part->noise_classes };
	for (size_t c = 0; c < part->comment_count; c++)
		GW_TRY(scan_add_comment(&t->kept, part->comment[c], error));
	for (size_t c = 0; c < part->column_count; c++)
		if (!scan_add_column(&t->kept, part->column[c].name, part->column[c].type, error))
			return GW_ERROR_MEMORY;
	for (size_t k = 0; k < part->scanner_count; k++)
		GW_TRY(scan_add_scanner(&t->kept, part->scanner + 3 * k, 0, t->most, error));
	t->kept.count = 0;
	t->mask = 1023;
	while (t->mask < 2 * (uint64_t)t->most)
		t->mask = 2 * t->mask + 1;
	t->cube = reallocarray(NULL, t->most, sizeof *t->cube);
	t->rank = reallocarray(NULL, t->most, sizeof *t->rank);
	t->slot = calloc(t->mask + 1, sizeof *t->slot);
	return t->cube && t->rank && t->slot ? GW_OK : no_memory(t, error);
}

static gw_status check_columns(const scan_thinning *t, const scan *part, gw_error *error)
{
	bool same = t->kept.column_count == part->column_count;
	for (size_t c = 0; same && c < part->column_count; c++)
		same = t->kept.column[c].type == part->column[c].type &&
			   strcmp(t->kept.column[c].name, part->column[c].name) == 0;
	return same ? GW_OK : gw_fail(error, GW_ERROR_DATA, "parts of a cloud have different columns");
}

/* The slot of a cube, taken or free. */
static uint32_t *slot_of(scan_thinning *t, uint64_t cube)
{
	uint64_t at = cube & t->mask;
	while (t->slot[at] && t->cube[t->slot[at] - 1] != cube)
		at = (at + 1) & t->mask;
	return &t->slot[at];
}

static void copy_row(scan *to, size_t row, const scan *from, size_t i)
{
	for (size_t c = 0; c < from->column_count; c++) {
		size_t size = scan_type_size(from->column[c].type);
		memmove((char *)to->column[c].data + row * size,
				(const char *)from->column[c].data + i * size, size);
	}
}

/* Point i of a cloud, which may be what is kept itself. */
static void offer(scan_thinning *t, const scan *from, const views *v, size_t i)
{
	double place[3];
	if (!get_place(v, i, place))
		return;
	uint64_t cube = cube_of(v, i, place, t->width), rank = rank_of(place);
	uint32_t *slot = slot_of(t, cube);
	size_t row = *slot ? *slot - 1 : t->kept.count;
	if (*slot && t->rank[row] <= rank)
		return;
	t->kept.count += !*slot;
	*slot = (uint32_t)row + 1;
	t->cube[row] = cube;
	t->rank[row] = rank;
	copy_row(&t->kept, row, from, i);
}

/* Rows move down only, so that none is overwritten before it was looked at. */
static void coarsen(scan_thinning *t)
{
	views v;
	double growth = GROWTH;
	find_views(&t->kept, &v);
	while ((double)t->kept.count > LEFT_MOST * (double)t->most) {
		size_t count = t->kept.count;
		t->width *= growth;
		t->kept.count = 0;
		memset(t->slot, 0, (t->mask + 1) * sizeof *t->slot);
		for (size_t i = 0; i < count; i++)
			offer(t, &t->kept, &v, i);
		growth = (double)t->kept.count > HELPED * (double)count ? HASTE : GROWTH;
	}
}

static int by_value(const void *a, const void *b)
{
	double first = *(const double *)a, second = *(const double *)b;
	return (first > second) - (first < second);
}

/* How far apart the middle nine tenths of some of a column's values lie: strays do not count.
 *   largest   receives the size of the median, more than 0; or 0 where no value is finite */
static double extent_of(const scan_column *column, size_t count, double *largest)
{
	double value[SAMPLES];
	size_t used = 0;
	for (size_t k = 0; k < SAMPLES && k < count; k++) {
		size_t i = (size_t)((double)k / (double)SAMPLES * (double)count);
		value[used] = scan_value(column, count < SAMPLES ? k : i);
		used += isfinite(value[used]);
	}
	qsort(value, used, sizeof *value, by_value);
	*largest = used > 0 ? fmax(fabs(value[used / 2]), DBL_MIN) : 0.0;
	return used > 0 ? value[used - 1 - used / 20] - value[used / 20] : 0.0;
}

/* 0 where no place is finite. */
static double start_width(const scan_thinning *t, const scan *part, const views *v)
{
	double extent = 0.0, largest = 0.0;
	for (int k = 0; k < 3; k++) {
		double size;
		extent = fmax(extent, extent_of(v->place[k], part->count, &size));
		largest = fmax(largest, size);
	}
	/* One place over and over: what single precision tells apart. */
	extent = fmax(extent, 1e-7 * largest);
	return largest > 0.0 ? fmax(START * extent / sqrt((double)t->most), DBL_MIN) : 0.0;
}

/* -------------------------------------------------------------------------------- part by part */

scan_thinning scan_thinning_begin(size_t most)
{
	return (scan_thinning){ .most = most };
}

gw_status scan_thinning_add(scan_thinning *t, const scan *part, gw_error *error)
{
	views v;
	if (!find_views(part, &v))
		return gw_fail(error, GW_ERROR_DATA, "points need x, y and z");
	if (!t->slot)
		GW_TRY(open_kept(t, part, error));
	GW_TRY(check_columns(t, part, error));
	if (!(t->width > 0.0))
		t->width = start_width(t, part, &v);
	for (size_t i = 0; i < part->count && t->width > 0.0; i++) {
		if (t->kept.count == t->most)
			coarsen(t);
		offer(t, part, &v, i);
	}
	return GW_OK;
}

void scan_thinning_take(scan_thinning *t, scan *cloud)
{
	*cloud = t->kept;
	t->kept = (scan){ 0 };
	for (size_t c = 0; c < cloud->column_count; c++) {
		size_t bytes = cloud->count * scan_type_size(cloud->column[c].type);
		void *less = realloc(cloud->column[c].data, bytes > 0 ? bytes : 1);
		cloud->column[c].data = less ? less : cloud->column[c].data;
	}
	scan_thinning_clear(t);
}

void scan_thinning_clear(scan_thinning *t)
{
	scan_clear(&t->kept);
	free(t->cube);
	free(t->rank);
	free(t->slot);
	*t = (scan_thinning){ .most = t->most };
}

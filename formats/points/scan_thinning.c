/* scan_thinning.c - see scan_thinning.h. */
#include "points/scan_thinning.h"

#include "glowworm_host.h"

#include <float.h>
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* While points come there is room for so many times as many as may be kept, and then for some more:
 * however wide cubes are, points on eight sides of the origin that face seven ways lie in others.
 * When it is full cubes get wider, until from a half to LEFT of it is taken, which is soon found:
 * in the end about as many are there as may be, or more, of which those are taken that may be. */
#define ROOM 2.0
#define ROOM_MORE 64u
#define LEFT 0.7
#define NEARLY_LEFT 0.71

/* Where the border of cubes lies at the origin, in their widths: no fraction, so that points in
 * rows do not all go over borders at one width, where some more or less are wanted. */
#define SHIFT 0.38196601125

/* Cubes are good that leave from NEARLY to ALMOST of the points that are wanted, by a count that is
 * a little off, and aim in between. */
#define NEARLY 0.94
#define ALMOST 0.99
#define TRIES_MOST 60

/* By how much a try widens cubes at most; and where the last one took away next to nothing, cubes
 * are far too narrow, and it does. */
#define GROWTH_MOST 4.0
#define HELPED 0.99

/* Bits a point of the table by which cubes are counted, and those of the smallest. */
#define COUNTING_BITS 16u
#define COUNTING_LEAST ((uint64_t)1 << 16)

/* Of more points one in so many of the cubes is counted, a power of two. */
#define COUNTED_LEAST ((size_t)400000)
#define COUNTED_OF 4u

/* Values of a column by which the first cubes are chosen. */
#define SAMPLES 1000u

/* The first cubes: of such a part of the width that they have when as many points as may be kept
 * lie on a square as wide as the first part. */
#define START 0.125

/* Points that a thread looks at at once, and how far ahead of them the table is fetched. */
#define CHUNK ((size_t)4096)
#define AHEAD 16u

/* Columns by which points are told apart. */
typedef struct views {
	const scan_column *place[3], *normal[3]; /* NULL: has none */
	scan_column *emission[3];                /* likewise, or holds no fractions */
} views;

static bool find_views(const scan *cloud, views *v)
{
	static const char *const place[3] = { "x", "y", "z" }, *const normal[3] = { "nx", "ny", "nz" };
	static const char *const emission[3] = { "emission_r", "emission_g", "emission_b" };
	bool placed = true, emits = true;
	for (int k = 0; k < 3; k++) {
		v->place[k] = scan_find(cloud, place[k]);
		v->normal[k] = scan_find(cloud, normal[k]);
		v->emission[k] = scan_find(cloud, emission[k]);
		placed = placed && v->place[k];
		emits = emits && v->emission[k] &&
				(v->emission[k]->type == SCAN_FLOAT32 || v->emission[k]->type == SCAN_FLOAT64);
	}
	if (!v->normal[0] || !v->normal[1] || !v->normal[2])
		v->normal[0] = NULL;
	if (!emits)
		v->emission[0] = NULL;
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
	for (int k = 0; k < 3; k++) {
		double cell = floor(place[k] / width + SHIFT);
		cube = mix(cube, (uint64_t)(int64_t)fmin(fmax(cell, -0x1p62), 0x1p62));
	}
	return cube;
}

/* ------------------------------------------------------------------------------ what is kept */

static gw_status no_memory(const scan_thinning *t, gw_error *error)
{
	return gw_fail(error, GW_ERROR_MEMORY, "no memory to keep %zu of the points", t->most);
}

/* Room for the columns of the first part, and what else it says. */
static gw_status open_kept(scan_thinning *t, const scan *part, const views *v, gw_error *error)
{
	t->kept = (scan){ .count = t->room,
					  .up = part->up,
					  .says_up = part->says_up,
					  .noise_classes = part->noise_classes };
	for (size_t c = 0; c < part->comment_count; c++)
		GW_TRY(scan_add_comment(&t->kept, part->comment[c], error));
	for (size_t c = 0; c < part->column_count; c++)
		if (!scan_add_column(&t->kept, part->column[c].name, part->column[c].type, error))
			return GW_ERROR_MEMORY;
	for (size_t k = 0; k < part->scanner_count; k++)
		GW_TRY(scan_add_scanner(&t->kept, part->scanner + 3 * k, 0, t->room, error));
	if (part->scanner_of)
		GW_TRY(scan_part_scanners(&t->kept, error));
	t->kept.count = 0;
	t->mask = 1023;
	while (t->mask < 2 * (uint64_t)t->room)
		t->mask = 2 * t->mask + 1;
	t->bits_mask = COUNTING_LEAST - 1;
	while (t->bits_mask < COUNTING_BITS * (uint64_t)t->room)
		t->bits_mask = 2 * t->bits_mask + 1;
	t->cube = reallocarray(NULL, t->room, sizeof *t->cube);
	t->rank = reallocarray(NULL, t->room, sizeof *t->rank);
	t->wider = reallocarray(NULL, t->room, sizeof *t->wider);
	t->from = calloc(t->room, sizeof *t->from);
	t->slot = calloc(t->mask + 1, sizeof *t->slot);
	t->bits = calloc(t->bits_mask / 64 + 1, sizeof *t->bits);
	t->emitted = v->emission[0] ? reallocarray(NULL, t->room, sizeof *t->emitted) : NULL;
	bool good = t->cube && t->rank && t->wider && t->from && t->slot && t->bits;
	return good && (t->emitted || !v->emission[0]) ? GW_OK : no_memory(t, error);
}

static gw_status check_columns(const scan_thinning *t, const scan *part, gw_error *error)
{
	bool same = t->kept.column_count == part->column_count;
	for (size_t c = 0; same && c < part->column_count; c++)
		same = t->kept.column[c].type == part->column[c].type &&
			   strcmp(t->kept.column[c].name, part->column[c].name) == 0;
	same = same && (part->scanner_of || !t->kept.scanner_of);
	return same ? GW_OK : gw_fail(error, GW_ERROR_DATA, "parts of a cloud have different columns");
}

/* The slot of a cube, taken or free. */
static uint32_t *slot_of(const scan_thinning *t, uint64_t cube)
{
	uint64_t at = cube & t->mask;
	while (t->slot[at] && t->cube[t->slot[at] - 1] != cube)
		at = (at + 1) & t->mask;
	return &t->slot[at];
}

/* Offers a point of a cube and a rank. The row that is its own then, or t->room. */
static size_t offer(scan_thinning *t, uint64_t cube, uint64_t rank)
{
	uint32_t *slot = slot_of(t, cube);
	size_t row = *slot ? *slot - 1 : t->kept.count;
	if (*slot && t->rank[row] <= rank)
		return t->room;
	if (!*slot && t->emitted)
		t->emitted[row] = (scan_thinning_sum){ .points = 0.0 };
	t->kept.count += !*slot;
	*slot = (uint32_t)row + 1;
	t->cube[row] = cube;
	t->rank[row] = rank;
	return row;
}

/* Adds to what the cube of a point emits, once it was offered. */
static void add_emission(scan_thinning *t, uint64_t cube, const scan_thinning_sum *more)
{
	scan_thinning_sum *sum = &t->emitted[*slot_of(t, cube) - 1];
	for (int k = 0; k < 3; k++)
		sum->emission[k] += more->emission[k];
	sum->points += more->points;
}

static scan_thinning_sum emission_of(const views *v, size_t i)
{
	scan_thinning_sum own = { .points = 1.0 };
	for (int k = 0; k < 3; k++) {
		double value = scan_value(v->emission[k], i);
		own.emission[k] = isfinite(value) && value > 0.0 ? value : 0.0;
	}
	return own;
}

static void copy_value(void *to, size_t row, const void *from, size_t i, size_t size)
{
	switch (size) {
	case 4:
		((uint32_t *)to)[row] = ((const uint32_t *)from)[i];
		break;
	case 8:
		((uint64_t *)to)[row] = ((const uint64_t *)from)[i];
		break;
	default:
		memmove((char *)to + row * size, (const char *)from + i * size, size);
	}
}

/* ----------------------------------------------------------------------------- wider cubes */

typedef struct widening {
	scan_thinning *t;
	views v;
	double width;
	uint64_t left_out; /* 0, or of so many more cubes one is counted */
} widening;

static void find_wider(void *user, size_t first, size_t last, uint32_t worker)
{
	const widening *w = user;
	double place[3];
	(void)worker;
	for (size_t i = first; i < last; i++) {
		get_place(&w->v, i, place);
		w->t->wider[i] = cube_of(&w->v, i, place, w->width);
	}
}

/* Rows move down only, so that none is overwritten before it was moved. Which scanners saw points
 * is one column more. */
static void move_columns(void *user, size_t first, size_t last, uint32_t worker)
{
	const scan_thinning *t = user;
	const scan *kept = &t->kept;
	(void)worker;
	for (size_t c = first; c < last; c++) {
		bool seen = c == kept->column_count;
		size_t size = seen ? sizeof *kept->scanner_of : scan_type_size(kept->column[c].type);
		void *data = seen ? kept->scanner_of : kept->column[c].data;
		for (size_t row = 0; row < t->kept.count; row++)
			copy_value(data, row, data, t->from[row] - 1, size);
	}
}

static void widen(scan_thinning *t)
{
	size_t count = t->kept.count;
	widening w = { .t = t, .width = t->width };
	find_views(&t->kept, &w.v);
	gw_parallel_for(t->threads, count, CHUNK, find_wider, &w);
	memset(t->slot, 0, (t->mask + 1) * sizeof *t->slot);
	t->kept.count = 0;
	for (size_t i = 0; i < count; i++) {
		__builtin_prefetch(&t->slot[t->wider[i + AHEAD < count ? i + AHEAD : i] & t->mask]);
		const scan_thinning_sum own = t->emitted ? t->emitted[i] : (scan_thinning_sum){ 0 };
		size_t row = offer(t, t->wider[i], t->rank[i]);
		if (t->emitted)
			add_emission(t, t->wider[i], &own);
		if (row < t->room)
			t->from[row] = (uint32_t)i + 1;
	}
	size_t columns = t->kept.column_count + (t->kept.scanner_of != NULL);
	gw_parallel_for(t->threads, columns, 1, move_columns, t);
	memset(t->from, 0, t->kept.count * sizeof *t->from);
}

/* Counts cubes of the next width, by bits that they set in a table (linear counting, Whang and
 * others 1990). */
static void count_some(void *user, size_t first, size_t last, uint32_t worker)
{
	const widening *w = user;
	scan_thinning *t = w->t;
	double place[3];
	(void)worker;
	for (size_t i = first; i < last; i++) {
		get_place(&w->v, i, place);
		uint64_t cube = cube_of(&w->v, i, place, w->width), bit = cube & t->bits_mask;
		if (cube >> 32 & w->left_out)
			continue;
		atomic_fetch_or_explicit(&t->bits[bit / 64], UINT64_C(1) << bit % 64, memory_order_relaxed);
	}
}

static double count_cubes(widening *w)
{
	scan_thinning *t = w->t;
	uint64_t words = t->bits_mask / 64 + 1, set = 0;
	double all = (double)(t->bits_mask + 1);
	for (uint64_t i = 0; i < words; i++)
		atomic_store_explicit(&t->bits[i], 0, memory_order_relaxed);
	gw_parallel_for(t->threads, t->kept.count, CHUNK, count_some, w);
	for (uint64_t i = 0; i < words; i++)
		set +=
			(uint64_t)__builtin_popcountll(atomic_load_explicit(&t->bits[i], memory_order_relaxed));
	return -all * log1p(-(double)set / all) * (double)(w->left_out + 1);
}

/* Widens cubes until about so many of the points are left and hardly any more, or if no width does
 * that, fewer. The next one to try is guessed as if surface had four times as many cubes of half
 * the width, and is else amid those that left too many and too few. */
static void coarsen(scan_thinning *t, double wanted, double nearly)
{
	widening w = { .t = t,
				   .width = t->width,
				   .left_out = t->kept.count > COUNTED_LEAST ? COUNTED_OF - 1 : 0 };
	double aim = 0.5 * (nearly + ALMOST), low = t->width, high = INFINITY;
	double cubes = (double)t->kept.count, before = INFINITY;
	find_views(&t->kept, &w.v);
	for (int i = 0; i < TRIES_MOST && (cubes > ALMOST * wanted || cubes < nearly * wanted); i++) {
		double growth = fmin(sqrt(fmax(cubes, 1.0) / (aim * wanted)), GROWTH_MOST);
		double guess = w.width * (cubes > HELPED * before ? GROWTH_MOST : growth);
		before = cubes > ALMOST * wanted ? cubes : INFINITY;
		if (!(guess > low && guess < high))
			guess = isfinite(high) ? sqrt(low) * sqrt(high) : low * GROWTH_MOST;
		w.width = guess;
		cubes = count_cubes(&w);
		low = cubes > ALMOST * wanted ? w.width : low;
		high = cubes < nearly * wanted ? w.width : high;
	}
	t->width = cubes > ALMOST * wanted && isfinite(high) ? high : w.width;
	widen(t);
}

/* ---------------------------------------------------------------------------------- the width */

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

/* Points of a part from `first` on. */
typedef struct looking {
	scan_thinning *t;
	const scan *part;
	const views *v;
	size_t first;
} looking;

/* Their cubes and ranks, while the table's slots are fetched. */
static void find_cubes(const looking *job, size_t first, size_t last)
{
	const scan_thinning *t = job->t;
	const scan_thinning_part *p = &t->part;
	double place[3];
	for (size_t i = first; i < last; i++) {
		p->placed[i] = p->wanted[i] = get_place(job->v, i, place);
		if (!p->placed[i])
			continue;
		p->rank[i] = rank_of(place);
		p->cube[i] = cube_of(job->v, i, place, t->width);
		__builtin_prefetch(&t->slot[p->cube[i] & t->mask]);
	}
}

/* What is kept does not change meanwhile. A point that one of it goes before is none that will be.
 */
static void look_at(void *user, size_t first, size_t last, uint32_t worker)
{
	const looking *job = user;
	const scan_thinning *t = job->t;
	const scan_thinning_part *p = &t->part;
	(void)worker;
	for (size_t next = first; next < last; first = next) {
		next = last - first < AHEAD ? last : first + AHEAD;
		find_cubes(job, job->first + first, job->first + next);
		for (size_t i = job->first + first; i < job->first + next; i++) {
			const uint32_t *slot = p->wanted[i] ? slot_of(t, p->cube[i]) : NULL;
			p->wanted[i] = slot && (!*slot || t->rank[*slot - 1] > p->rank[i]);
		}
	}
}

/* Copies the points that were taken to their rows. */
static void copy_rows(void *user, size_t first, size_t last, uint32_t worker)
{
	const looking *job = user;
	const scan_thinning *t = job->t;
	(void)worker;
	for (size_t c = 0; c < job->part->column_count; c++) {
		const void *from = job->part->column[c].data;
		size_t size = scan_type_size(job->part->column[c].type);
		for (size_t k = first; k < last; k++) {
			uint32_t row = t->part.row[k];
			copy_value(t->kept.column[c].data, row, from, t->from[row] - 1, size);
		}
	}
	for (size_t k = first; k < last && t->kept.scanner_of; k++) {
		uint32_t row = t->part.row[k];
		t->kept.scanner_of[row] = job->part->scanner_of[t->from[row] - 1];
	}
	for (size_t k = first; k < last; k++)
		t->from[t->part.row[k]] = 0;
}

/* Takes points of the part from `first` on, until there is no more room; the next one. */
static size_t take_points(looking *job, size_t first)
{
	scan_thinning *t = job->t;
	scan_thinning_part *p = &t->part;
	size_t count = job->part->count, i = first;
	job->first = first;
	gw_parallel_for(t->threads, count - first, CHUNK, look_at, job);
	for (p->rows = 0; i < count && t->kept.count < t->room; i++) {
		size_t next = i + AHEAD < count ? i + AHEAD : i;
		if (p->wanted[next])
			__builtin_prefetch(&t->slot[p->cube[next] & t->mask]);
		size_t row = p->wanted[i] ? offer(t, p->cube[i], p->rank[i]) : t->room;
		if (t->emitted && p->placed[i]) {
			const scan_thinning_sum own = emission_of(job->v, i);
			add_emission(t, p->cube[i], &own);
		}
		if (row == t->room)
			continue;
		if (!t->from[row])
			p->row[p->rows++] = (uint32_t)row;
		t->from[row] = (uint32_t)i + 1;
	}
	gw_parallel_for(t->threads, p->rows, CHUNK, copy_rows, job);
	return i;
}

static void clear_part(scan_thinning_part *p)
{
	free(p->cube);
	free(p->rank);
	free(p->placed);
	free(p->wanted);
	free(p->row);
	*p = (scan_thinning_part){ .room = 0 };
}

static gw_status make_room(scan_thinning *t, size_t count, gw_error *error)
{
	scan_thinning_part *p = &t->part;
	if (count <= p->room)
		return GW_OK;
	clear_part(p);
	p->room = count;
	p->cube = reallocarray(NULL, count, sizeof *p->cube);
	p->rank = reallocarray(NULL, count, sizeof *p->rank);
	p->placed = malloc(count);
	p->wanted = malloc(count);
	p->row = reallocarray(NULL, count, sizeof *p->row);
	bool good = p->cube && p->rank && p->placed && p->wanted && p->row;
	return good ? GW_OK : no_memory(t, error);
}

scan_thinning scan_thinning_begin(size_t most, uint32_t threads)
{
	size_t room = (size_t)(ROOM * (double)most) + ROOM_MORE;
	return (scan_thinning){ .most = most, .room = room, .threads = threads };
}

gw_status scan_thinning_add(scan_thinning *t, const scan *part, gw_error *error)
{
	views v;
	looking job = { .t = t, .part = part, .v = &v };
	if (!find_views(part, &v))
		return gw_fail(error, GW_ERROR_DATA, "points need x, y and z");
	if (!t->slot)
		GW_TRY(open_kept(t, part, &v, error));
	GW_TRY(check_columns(t, part, error));
	GW_TRY(make_room(t, part->count, error));
	if (!(t->width > 0.0))
		t->width = start_width(t, part, &v);
	for (size_t i = 0; i < part->count && t->width > 0.0;) {
		if (t->kept.count == t->room)
			coarsen(t, LEFT * (double)t->room, NEARLY_LEFT);
		i = take_points(&job, i);
	}
	return GW_OK;
}

/* Of points that are kept: what their cubes emit. */
static void take_emission(scan_thinning *t)
{
	views v;
	find_views(&t->kept, &v);
	for (size_t row = 0; t->emitted && row < t->kept.count; row++)
		for (int k = 0; k < 3; k++)
			scan_store(v.emission[k], row, t->emitted[row].emission[k] / t->emitted[row].points);
}

void scan_thinning_take(scan_thinning *t, scan *cloud)
{
	for (int i = 0; i < TRIES_MOST && t->kept.count > t->most; i++)
		coarsen(t, (double)t->most, NEARLY);
	take_emission(t);
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
	free(t->wider);
	free(t->from);
	free(t->slot);
	free(t->bits);
	free(t->emitted);
	clear_part(&t->part);
	*t = (scan_thinning){ .most = t->most, .room = t->room, .threads = t->threads };
}

/* stray_cells.c - see stray_cells.h. */
#include "cloud/stray_cells.h"

#include "base/memory.h"
#include "base/sorted_keys.h"
#include "glowworm_host.h"

#include <math.h>
#include <stdlib.h>

#define GRID_BITS 21  /* of the surfels' order, see frame.c */
#define FINEST 15     /* level of cells that is tried first */
#define IN_A_CELL 1.5 /* surfels on average, at least */
#define SAMPLES 33    /* surfels whose median stands for that of all */
#define TELLING 8     /* surfels that tell a spacing */
#define LOOKED_AT 512 /* surfels of which most have others in the cells around */
#define LONELY 8      /* one of so many has not, at most */
#define AROUND 27     /* cells: one and its neighbours */
#define CHUNK 16384   /* surfels that a thread takes at a time */

static double extent_of(const gw_surfels *s)
{
	double extent = 0;
	for (int k = 0; k < 3; k++)
		extent = fmax(extent, (double)s->maximum[k] - (double)s->minimum[k]);
	return extent;
}

/* The keys of all surfels in the finest cells. */
typedef struct finest_keys {
	const gw_surfels *surfels;
	double cells_per_metre;
	uint64_t *key;
} finest_keys;

static void find_keys(void *user, size_t first, size_t last, uint32_t worker)
{
	const finest_keys *all = user;
	const gw_surfels *s = all->surfels;
	const double most = (1 << GRID_BITS) - 1;
	(void)worker;
	for (size_t i = first; i < last; i++) {
		uint32_t cell[3];
		for (size_t k = 0; k < 3; k++) {
			double off = (double)s->position[3 * i + k] - (double)s->minimum[k];
			double at = off * all->cells_per_metre;
			cell[k] = at > 0 ? (uint32_t)(at < most ? at : most) : 0;
		}
		all->key[i] = gw_morton_encode(cell[0], cell[1], cell[2]);
	}
}

/* Number of cells of each level: one, and one more where keys differ in it. */
static void count_cells(const uint64_t *key, size_t count, size_t cells[GRID_BITS + 1])
{
	for (int level = 0; level <= GRID_BITS; level++)
		cells[level] = level == 0;
	for (size_t i = 1; i < count; i++)
		if (key[i] != key[i - 1])
			cells[GRID_BITS - (63 - __builtin_clzll(key[i] ^ key[i - 1])) / 3]++;
	for (int level = 1; level <= GRID_BITS; level++)
		cells[level] += cells[level - 1];
}

static bool fill_cells(gw_stray_cells *cells, const uint64_t *key, size_t count)
{
	int shift = 3 * (GRID_BITS - cells->level);
	size_t cell = 0;
	cells->key = gw_allocate_array(cells->count, sizeof *cells->key);
	cells->first = gw_allocate_array(cells->count + 1, sizeof *cells->first);
	if (!cells->key || !cells->first)
		return false;
	for (size_t i = 0; i < count; i++)
		if (i == 0 || key[i] >> shift != key[i - 1] >> shift) {
			cells->key[cell] = key[i] >> shift;
			cells->first[cell++] = i;
		}
	cells->first[cell] = count;
	return true;
}

void gw_stray_cells_clear(gw_stray_cells *cells)
{
	free(cells->key);
	free(cells->first);
	*cells = (gw_stray_cells){ .count = 0 };
}

/* The first cell whose key is not below one. */
static size_t find_key(const gw_stray_cells *cells, uint64_t key)
{
	return gw_lower_bound(cells->key, cells->count, key);
}

/* The same, from a cell that is likely near it, in steps twice as far each; there are cells. */
static size_t find_key_near(const gw_stray_cells *cells, size_t cell, uint64_t key)
{
	size_t first = cell < cells->count ? cell : cells->count - 1, last = first, step = 1;
	while (first > 0 && cells->key[first] >= key) {
		last = first;
		first = first > step ? first - step : 0;
		step *= 2;
	}
	while (last < cells->count && cells->key[last] < key) {
		first = last;
		last = cells->count - last > step ? last + step : cells->count;
		step *= 2;
	}
	return first + gw_lower_bound(cells->key + first, last - first, key);
}

/* The j-th of the cells around one at a place, itself for j = 13, all `coarser` levels coarser than
 * these: its cells; none beyond the bounds. */
static void find_beside(const gw_stray_cells *cells, size_t cell, const uint32_t place[3],
						int coarser, int j, size_t range[2])
{
	const int64_t last = (INT64_C(1) << (cells->level - coarser)) - 1;
	const int64_t step[3] = { j % 3 - 1, j / 3 % 3 - 1, j / 9 - 1 };
	uint32_t at[3];
	range[0] = range[1] = 0;
	for (int k = 0; k < 3; k++) {
		if (place[k] + step[k] < 0 || place[k] + step[k] > last)
			return;
		at[k] = (uint32_t)(place[k] + step[k]);
	}
	uint64_t other = gw_morton_encode(at[0], at[1], at[2]);
	range[0] = find_key_near(cells, cell, other << 3 * coarser);
	range[1] = coarser == 0 ? range[0] + (range[0] < cells->count && cells->key[range[0]] == other)
							: find_key_near(cells, range[0], (other + 1) << 3 * coarser);
}

/* The cells in those around a cell; returns how many surfels they hold. */
static size_t find_around(const gw_stray_cells *cells, size_t cell, int coarser,
						  size_t range[AROUND][2])
{
	size_t surfels = 0;
	uint32_t place[3];
	gw_morton_decode(cells->key[cell] >> 3 * coarser, place);
	for (int j = 0; j < AROUND; j++) {
		find_beside(cells, cell, place, coarser, j, range[j]);
		surfels += cells->first[range[j][1]] - cells->first[range[j][0]];
	}
	return surfels;
}

/* From the middle of the cells around to one of two opposite ones: those with a face in common
 * first, then those with an edge, so that what a surface has is soon counted. */
static const int to_beside[AROUND / 2] = { 1, 3, 9, 2, 4, 6, 8, 10, 12, 5, 7, 11, 13 };

/* Surfels in the eight cells of which the one above them in size is made. All touch each other, and
 * those that there are come one after another. */
static size_t count_siblings(const gw_stray_cells *cells, size_t cell)
{
	uint64_t above = cells->key[cell] >> 3;
	size_t first = cell, end = cell + 1;
	while (first > 0 && cells->key[first - 1] >> 3 == above)
		first--;
	while (end < cells->count && cells->key[end] >> 3 == above)
		end++;
	return cells->first[end] - cells->first[first];
}

bool gw_stray_cells_few_around(const gw_stray_cells *cells, size_t cell, size_t few)
{
	if (count_siblings(cells, cell) > few)
		return false;
	size_t range[2], surfels = cells->first[cell + 1] - cells->first[cell];
	uint32_t place[3];
	gw_morton_decode(cells->key[cell], place);
	for (int j = 0; j < AROUND - 1 && surfels <= few; j++) {
		int off = to_beside[j / 2];
		find_beside(cells, cell, place, 0, AROUND / 2 + (j % 2 ? -off : off), range);
		surfels += cells->first[range[1]] - cells->first[range[0]];
	}
	return surfels <= few;
}

/* The cell of a surfel, which is one of low..high. */
static size_t cell_of(const gw_stray_cells *cells, size_t surfel, size_t low, size_t high)
{
	while (low < high) {
		size_t middle = low + (high - low + 1) / 2;
		if (cells->first[middle] <= surfel)
			low = middle;
		else
			high = middle - 1;
	}
	return low;
}

/* Are few surfels without others in the cells around? */
static bool is_coarse_enough(const gw_stray_cells *cells, size_t surfels, size_t few)
{
	size_t lonely = 0, looked = surfels < LOOKED_AT ? surfels : LOOKED_AT;
	for (size_t i = 0; i < looked; i++) {
		size_t surfel = (size_t)((double)i / (double)looked * (double)surfels);
		lonely +=
			gw_stray_cells_few_around(cells, cell_of(cells, surfel, 0, cells->count - 1), few);
	}
	return lonely <= looked / LONELY;
}

bool gw_stray_cells_make(const gw_surfels *s, size_t few, uint32_t threads, gw_stray_cells *cells)
{
	double extent = extent_of(s);
	finest_keys all = { s, extent > 0 ? (double)((1 << GRID_BITS) - 1) / extent : 0,
						gw_allocate_array(s->count, sizeof *all.key) };
	size_t of_level[GRID_BITS + 1];
	bool good = all.key != NULL, found = false;
	*cells = (gw_stray_cells){ .level = FINEST + 1 };
	if (good) {
		gw_parallel_for(threads, s->count, CHUNK, find_keys, &all);
		count_cells(all.key, s->count, of_level);
	}
	while (good && !found) {
		free(cells->key);
		free(cells->first);
		cells->key = NULL;
		cells->first = NULL;
		cells->level--;
		cells->count = of_level[cells->level];
		if ((double)s->count < IN_A_CELL * (double)cells->count && cells->level > 0)
			continue;
		cells->width = ldexp(extent, -cells->level);
		good = fill_cells(cells, all.key, s->count);
		found = good && (cells->level == 0 || is_coarse_enough(cells, s->count, few));
	}
	free(all.key);
	return good;
}

/* The spacing that the number of surfels means, on a surface, in the least cell around one that has
 * enough to tell. */
static double spacing_at(const gw_stray_cells *cells, size_t cell)
{
	size_t first = cell, end = cell + 1;
	int coarser = 0;
	while (cells->first[end] - cells->first[first] < TELLING && coarser < cells->level) {
		uint64_t key = cells->key[cell] >> 3 * ++coarser;
		first = find_key(cells, key << 3 * coarser);
		end = find_key(cells, (key + 1) << 3 * coarser);
	}
	double number = (double)(cells->first[end] - cells->first[first]);
	return ldexp(cells->width, coarser) / sqrt(number);
}

/* The median of these around a cell, by cells that are so many levels coarser. */
static double median_spacing(const gw_stray_cells *cells, size_t cell, int coarser)
{
	double spacing[SAMPLES]; /* sorted */
	size_t range[AROUND][2], passed = 0;
	int taken = 0;
	size_t surfels = find_around(cells, cell, coarser, range);
	for (int j = 0; j < AROUND; j++) {
		size_t first = cells->first[range[j][0]], end = cells->first[range[j][1]];
		for (; taken < SAMPLES; taken++) {
			size_t sample = (size_t)((taken + 0.5) / SAMPLES * (double)surfels);
			if (sample >= passed + end - first)
				break;
			double own = spacing_at(
				cells, cell_of(cells, first + sample - passed, range[j][0], range[j][1] - 1));
			int at = taken;
			for (; at > 0 && own < spacing[at - 1]; at--)
				spacing[at] = spacing[at - 1];
			spacing[at] = own;
		}
		passed += end - first;
	}
	return taken > 0 ? spacing[taken / 2] : 0;
}

double gw_stray_cells_spacing(const gw_stray_cells *cells, size_t cell, double reach,
							  gw_stray_spacing *last)
{
	int coarser = 0;
	while (coarser < cells->level && ldexp(cells->width, coarser) < reach)
		coarser++;
	uint64_t key = cells->key[cell] >> 3 * coarser;
	if (!last->known || last->coarser != coarser || last->key != key)
		*last = (gw_stray_spacing){ true, coarser, key, median_spacing(cells, cell, coarser) };
	return last->spacing;
}

/*
 * surface_points.c - see surface_points.h.
 */
#include "bake/surface_points.h"

#include "bake/surface_owners.h"
#include "base/hash.h"
#include "base/memory.h"
#include "cloud/bulk_bounds.h"
#include "cloud/frame.h"
#include "device/gpu.h"
#include "glowworm_host.h"
#include "glowworm_parts.h"

#include <float.h>
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* Bytes of a bake of which less is known: at all, and a point of the surface. */
#define FIXED_BYTES (UINT64_C(160) << 20)
#define SURFACE_BYTES 1120u

/* What a program with its drivers holds before a bake, and of each point it was given; when a bake
 * has given back what it took, the light of all points takes less. Where a limit is set this is
 * what counts, and not what it holds just then, which by two threads or another driver is never
 * quite the same: the same points are to make the surface. */
#define PROGRAM_BYTES (UINT64_C(66) << 20)
#define GIVEN_BYTES 150u

/* Surface of fewer points is next to nothing: where memory holds no more, it takes more. */
#define POINTS_LEAST 10000u

/* Of the points that would fit so many are taken: fewer points have more facets each. */
#define FEWER 0.93

/* Points of a surface whose light may be exact enough where an error is asked for. */
#define FIRST_TRIED 50000u

/* From one to the next: tries that fail take a tenth of the one that does not, together. */
#define STEP 16u

/* The grid is good with from NEARLY to all of the cubes that are wanted, and aims in between. */
#define NEARLY 0.94
#define AIM 0.97
#define TRIES_MOST 60

#define CHUNK 16384u

uint64_t gw_surface_points_memory(const gw_points *points, const gw_bake_options *options)
{
	uint64_t taken = PROGRAM_BYTES + GIVEN_BYTES * points->count;
	if (options->surface_points > 0 || options->transport ||
		(options->region && options->region->camera))
		return 0;
	if (options->memory > 0)
		return options->memory > taken ? options->memory - taken : 1;
	/* What drivers take would count or not, as they happen to be loaded. */
	gw_drivers_wait(options->drivers);
	return gw_available_memory() / 4 * 3;
}

/* How many points are likely to take so much; all: where these are all that there are. */
static uint64_t points_for(const gw_scene_description *scene, const gw_bake_options *options,
						   uint64_t memory, bool all)
{
	if (!gw_bake_memory_is_known(options))
		return memory > FIXED_BYTES ? (memory - FIXED_BYTES) / SURFACE_BYTES : 0;
	const gw_memory_facts facts = gw_bake_memory_guess(scene, options, !all);
	return gw_bake_memory_points(&facts, memory, 0.0);
}

uint64_t gw_points_in_memory(uint64_t memory, bool normals, bool lamps,
							 const gw_bake_options *options)
{
	const gw_memory_facts facts = gw_bake_memory_usual(POINTS_LEAST, normals, lamps, options);
	uint64_t left = memory > PROGRAM_BYTES ? memory - PROGRAM_BYTES : 0;
	return gw_bake_memory_points(&facts, left, GIVEN_BYTES);
}

uint64_t gw_memory_of_points(uint64_t points, bool normals, bool lamps,
							 const gw_bake_options *options)
{
	const gw_memory_facts facts = gw_bake_memory_usual(points, normals, lamps, options);
	return PROGRAM_BYTES + GIVEN_BYTES * points + gw_bake_memory(&facts);
}

size_t gw_surface_points_most(const gw_scene_description *scene, const gw_bake_options *options,
							  uint64_t memory)
{
	size_t count = scene->points->count;
	if (options->surface_points > 0)
		return options->surface_points;
	if (memory == 0 || points_for(scene, options, memory, true) >= count)
		return count;
	uint64_t most = points_for(scene, options, memory, false);
	most = most > POINTS_LEAST ? most : POINTS_LEAST;
	return most < count ? (size_t)most : count;
}

gw_memory_ceiling gw_surface_points_ceiling(const gw_bake_options *options, uint64_t memory)
{
	bool known = gw_bake_memory_is_known(options);
	return (gw_memory_ceiling){ .bytes = known ? memory : 0, .least = POINTS_LEAST };
}

size_t gw_surface_points_fewer(uint64_t fit)
{
	return (size_t)(FEWER * (double)fit);
}

size_t gw_surface_points_next(size_t tried, double error, double wanted, size_t most)
{
	size_t next = tried > 0 ? tried : FIRST_TRIED;
	while (tried > 0 && next < most) {
		next *= STEP;
		error *= 0.25;
		if (error <= wanted) /* asked last: its spread may be what missed the target */
			break;
	}
	return next <= most / STEP ? next : most;
}

static gw_status no_memory(const gw_points *points, gw_error *error)
{
	return gw_fail(error, GW_ERROR_MEMORY, "no memory to thin %zu points", points->count);
}

/* ------------------------------------------------------------------------------------- a grid */

typedef struct grid {
	const gw_points *points;
	uint8_t *loose; /* one a point: 1 for those that cubes are for */
	double width;   /* of its cubes, metres */
} grid;

int64_t gw_facing_side(const float *n)
{
	if (!n || !(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] > 0.0f))
		return 6;
	int64_t axis = fabsf(n[0]) >= fabsf(n[1]) ? 0 : 1;
	axis = fabsf(n[2]) > fabsf(n[axis]) ? 2 : axis;
	return 2 * axis + (n[axis] < 0.0f);
}

/* Not 0. */
static uint64_t cube_of(const grid *g, size_t point)
{
	const float *normal = g->points->normal ? g->points->normal + 3 * point : NULL;
	int64_t cell[4] = { [3] = gw_facing_side(normal) };
	for (size_t k = 0; k < 3; k++)
		cell[k] = (int64_t)fmin(fmax(floor(g->points->position[3 * point + k] / g->width), -0x1p62),
								0x1p62);
	uint64_t cube = gw_hash(0, cell, sizeof cell);
	return cube ? cube : 1;
}

/* Counts cubes that hold points, by bits that they set in a table (linear counting, Whang and
 * others 1990). */
typedef struct counting {
	const grid *grid;
	_Atomic uint64_t *bits;
	uint64_t mask;
} counting;

static void count_some(void *user, size_t first, size_t last, uint32_t worker)
{
	const counting *c = user;
	(void)worker;
	for (size_t i = first; i < last; i++) {
		if (!c->grid->loose[i])
			continue;
		uint64_t bit = cube_of(c->grid, i) & c->mask;
		atomic_fetch_or_explicit(&c->bits[bit / 64], UINT64_C(1) << bit % 64, memory_order_relaxed);
	}
}

static double count_cubes(counting *c, uint32_t threads)
{
	uint64_t words = (c->mask + 1) / 64, set = 0;
	double all = (double)(c->mask + 1);
	for (uint64_t i = 0; i < words; i++)
		atomic_store_explicit(&c->bits[i], 0, memory_order_relaxed);
	gw_parallel_for(threads, c->grid->points->count, CHUNK, count_some, c);
	for (uint64_t i = 0; i < words; i++)
		set +=
			(uint64_t)__builtin_popcountll(atomic_load_explicit(&c->bits[i], memory_order_relaxed));
	return set > c->mask ? INFINITY : -all * log1p(-(double)set / all);
}

static uint64_t power_of_two(uint64_t least)
{
	uint64_t power = 1024;
	while (power < least)
		power *= 2;
	return power;
}

/* Surface takes four times as many cubes of half the width. */
static gw_status find_width(grid *g, double wanted, uint32_t threads, gw_error *error)
{
	double low[3], high[3], extent = 0.0;
	counting c = { .grid = g, .mask = power_of_two((uint64_t)(16.0 * wanted)) - 1 };
	c.bits = gw_allocate_array((c.mask + 1) / 64, sizeof *c.bits);
	if (!c.bits)
		return no_memory(g->points, error);
	gw_finite_bounds(g->points, low, high);
	gw_bulk_bounds(g->points, low, high);
	for (size_t k = 0; k < 3; k++)
		extent = fmax(extent, high[k] - low[k]);
	g->width = fmax(extent, DBL_MIN) / sqrt(wanted);
	for (int i = 0; i < TRIES_MOST; i++) {
		double cubes = count_cubes(&c, threads);
		if (cubes <= wanted && cubes >= NEARLY * wanted)
			break;
		double step = sqrt(fmin(fmax(cubes, 1.0), 64.0 * wanted) / (AIM * wanted));
		g->width = fmax(g->width * fmin(fmax(step, 1e-3), 1e3), DBL_MIN);
	}
	free(c.bits);
	return GW_OK;
}

/* ------------------------------------------------------------------------- one point of a cube */

typedef struct cube_table {
	uint64_t mask;
	uint64_t *cube; /* 0: free */
	size_t *point;  /* the one that is taken; later its place among those that are */
} cube_table;

static uint64_t slot_of(const cube_table *t, uint64_t cube)
{
	uint64_t slot = cube & t->mask;
	while (t->cube[slot] != 0 && t->cube[slot] != cube)
		slot = (slot + 1) & t->mask;
	return slot;
}

static uint64_t rank_of(const gw_points *points, size_t point)
{
	return gw_hash(1, points->position + 3 * point, 3 * sizeof(double));
}

/* The slot of a cube, in a table of twice the size where this one is getting full. */
static bool take_slot(cube_table *t, uint64_t cube, uint64_t used, uint64_t *slot)
{
	if (2 * used > t->mask) {
		cube_table larger = { .mask = 2 * t->mask + 1 };
		larger.cube = gw_allocate_zeros(larger.mask + 1, sizeof *larger.cube);
		larger.point = gw_allocate_array(larger.mask + 1, sizeof *larger.point);
		if (!larger.cube || !larger.point) {
			free(larger.cube);
			free(larger.point);
			return false;
		}
		for (uint64_t i = 0; i <= t->mask; i++) {
			if (t->cube[i] == 0)
				continue;
			uint64_t to = slot_of(&larger, t->cube[i]);
			larger.cube[to] = t->cube[i];
			larger.point[to] = t->point[i];
		}
		free(t->cube);
		free(t->point);
		*t = larger;
	}
	*slot = slot_of(t, cube);
	return true;
}

/* Marks the points that are taken, one a cube. */
static bool take_from_cubes(const grid *g, cube_table *t, uint8_t *taken)
{
	const gw_points *points = g->points;
	uint64_t used = 0, slot;
	for (size_t i = 0; i < points->count; i++) {
		if (!g->loose[i])
			continue;
		uint64_t cube = cube_of(g, i);
		if (!take_slot(t, cube, used, &slot))
			return false;
		if (t->cube[slot] == 0) {
			t->cube[slot] = cube;
			t->point[slot] = i;
			used++;
		} else if (rank_of(points, i) < rank_of(points, t->point[slot])) {
			t->point[slot] = i;
		}
	}
	for (uint64_t i = 0; i <= t->mask; i++)
		if (t->cube[i] != 0)
			taken[t->point[i]] = 1;
	return true;
}

/* ----------------------------------------------------------------- means of those stood for */

enum { ALBEDO = 0, EMISSION = 3, OPACITY = 6, MEANS = 7 };

static float usable_albedo(float albedo)
{
	return isfinite(albedo) ? fminf(fmaxf(albedo, 0.0f), GW_ALBEDO_MAX) : GW_ALBEDO_DEFAULT;
}

static void add_point(const gw_points *p, size_t i, double sum[MEANS])
{
	for (size_t c = 0; c < 3; c++) {
		float e = p->emission ? p->emission[3 * i + c] : 0.0f;
		sum[ALBEDO + c] += p->albedo ? (double)usable_albedo(p->albedo[3 * i + c]) : 0.0;
		sum[EMISSION + c] += isfinite(e) && e > 0.0f ? (double)e : 0.0;
	}
	sum[OPACITY] += p->opacity ? (double)p->opacity[i] : 0.0;
}

static void set_point(gw_point_subset *s, size_t k, const double sum[MEANS], double points)
{
	for (size_t c = 0; c < 3; c++) {
		if (s->albedo)
			s->albedo[3 * k + c] = (float)(sum[ALBEDO + c] / points);
		if (s->emission)
			s->emission[3 * k + c] = (float)(sum[EMISSION + c] / points);
	}
	if (s->opacity)
		s->opacity[k] = (float)(sum[OPACITY] / points);
}

bool gw_surface_points_take_means(const gw_points *all, const uint32_t *owner,
								  gw_point_subset *surface)
{
	size_t count = surface->points.count;
	double(*sum)[MEANS] = gw_allocate_zeros(count + 1, sizeof *sum);
	uint32_t *points = gw_allocate_zeros(count + 1, sizeof *points);
	bool good = sum && points;
	for (size_t i = 0; i < all->count && good; i++) {
		if (owner[i] == GW_OWNER_NONE)
			continue;
		add_point(all, i, sum[owner[i]]);
		points[owner[i]]++;
	}
	for (size_t k = 0; k < count && good; k++)
		if (points[k] > 0)
			set_point(surface, k, sum[k], (double)points[k]);
	free(sum);
	free(points);
	return good;
}

/* Whether any of them emits. */
static bool emit(const gw_points *points)
{
	bool any = false;
	for (size_t i = 0; points->emission && i < 3 * points->count && !any; i++)
		any = points->emission[i] > 0.0f && isfinite(points->emission[i]);
	return any;
}

/* Those of their cubes; none stands for others of an image. */
static void own_cubes(const grid *g, cube_table *t, const gw_point_subset *surface, uint32_t *owner)
{
	for (size_t k = 0; k < surface->points.count; k++)
		if (g->loose[surface->from[k]])
			t->point[slot_of(t, cube_of(g, surface->from[k]))] = k;
	for (size_t i = 0; i < g->points->count; i++)
		owner[i] = g->loose[i] ? (uint32_t)t->point[slot_of(t, cube_of(g, i))] : GW_OWNER_NONE;
}

/* To look for the nearest takes as long as to light the points beside them, so it is done where
 * something emits alone. */
static gw_status stand_for_others(const grid *g, cube_table *t, uint32_t threads,
								  gw_point_subset *surface, gw_error *error)
{
	uint32_t *owner = gw_allocate_array(g->points->count, sizeof *owner);
	gw_status status = GW_OK;
	if (owner && emit(g->points))
		status = gw_owners_find(g->points, surface, threads, owner, error);
	else if (owner)
		own_cubes(g, t, surface, owner);
	bool good =
		owner && (status != GW_OK || gw_surface_points_take_means(g->points, owner, surface));
	free(owner);
	return good ? status : no_memory(g->points, error);
}

/* ------------------------------------------------------------------------------------ choosing */

/* Marks points for cubes, and counts them and those of images. */
static void sort_out(const gw_points *points, uint8_t *loose, size_t *in_cubes, size_t *in_images)
{
	size_t image = 0;
	*in_cubes = *in_images = 0;
	for (size_t i = 0; i < points->count; i++) {
		bool pictured = gw_point_subset_image_of(points, i, &image) != NULL;
		loose[i] = !pictured && gw_owners_may_have(points, i);
		*in_cubes += loose[i];
		*in_images += pictured;
	}
}

static bool is_taken(const void *user, size_t point)
{
	return ((const uint8_t *)user)[point];
}

/* What a beam met alone stands for more where fewer beams are left. */
static void widen_things(gw_point_subset *surface, const gw_subset_choice *choice)
{
	for (size_t k = 0; surface->own_area && k < surface->points.count; k++)
		surface->own_area[k] *= (float)choice->columns * (float)choice->rows;
}

/* How many are wanted, and by how many threads. */
typedef struct surface_wish {
	size_t most;
	uint32_t threads;
} surface_wish;

static gw_status choose(grid *g, uint8_t *taken, const surface_wish *wish, gw_point_subset *surface,
						gw_error *error)
{
	const gw_points *points = g->points;
	size_t in_cubes, in_images;
	sort_out(points, g->loose, &in_cubes, &in_images);
	double share = (double)wish->most / fmax((double)(in_cubes + in_images), 1.0);
	double of_each = 1.0 / fmin(share, 1.0);
	uint32_t columns = (uint32_t)ceil(sqrt(of_each)), rows = (uint32_t)ceil(of_each / columns);
	cube_table t = { .mask = power_of_two(1024) - 1 };
	t.cube = gw_allocate_zeros(t.mask + 1, sizeof *t.cube);
	t.point = gw_allocate_array(t.mask + 1, sizeof *t.point);
	/* What stands for a cube is the mean of its points: no place has the cubes of another. */
	const gw_subset_choice choice = { columns, rows, is_taken, taken, false };
	gw_status status = find_width(g, fmax(share * (double)in_cubes, 1.0), wish->threads, error);
	bool good = status == GW_OK && t.cube && t.point && take_from_cubes(g, &t, taken);
	if (good)
		status = gw_point_subset_make(points, &choice, surface, error);
	if (good && status == GW_OK)
		status = stand_for_others(g, &t, wish->threads, surface, error);
	if (good && status == GW_OK)
		widen_things(surface, &choice);
	free(t.cube);
	free(t.point);
	return status != GW_OK || good ? status : no_memory(points, error);
}

gw_status gw_surface_points_choose(const gw_points *points, size_t most, uint32_t threads,
								   gw_point_subset *surface, gw_error *error)
{
	const surface_wish wish = { most, gw_thread_count(threads) };
	grid g = { .points = points, .loose = gw_allocate_zeros(points->count, 1) };
	uint8_t *taken = gw_allocate_zeros(points->count, 1);
	*surface = (gw_point_subset){ .from = NULL };
	gw_status status =
		g.loose && taken ? choose(&g, taken, &wish, surface, error) : no_memory(points, error);
	free(g.loose);
	free(taken);
	return status;
}

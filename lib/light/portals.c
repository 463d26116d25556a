/*
 * portals.c - see portals.h.
 *
 * The octree's cube is cut into a grid of cells. Rays that left the scene count in every cell on
 * their way; then each votes for the cell that most others passed, too. In a portal the rays of
 * all records come together, so cells with many votes are the portals. How fine a grid and how
 * many of its cells is decided by the noise that they leave, see noise_with.
 */
#include "light/portals.h"

#include "light/gather_rays.h"
#include "base/memory.h"
#include "light/transport_layout.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Levels of the grid. */
#define LEVEL_FINEST 7u
#define LEVEL_COARSEST 3u

/* Records that see the sky with more than one in so many rays need no help, nor does a scene. */
#define NARROW 4u
#define SCENE_NARROW 8u

/* Rays that are looked at, at most and at least. */
#define RAYS_MOST 16384u
#define RAYS_LEAST 64u

/* Portals are worth their samples where they leave less than this share of the mean square noise:
 * as many more rays would leave about three quarters. */
#define WORTH 0.6

/* Half a cube's diagonal over its side. */
#define SPHERE_OF_CUBE 0.86603f

/* Some of the records' rays. Every other one, from the first on, elects cells, and the rest tell
 * how good they are: no ray is to speak for the cell that it chose itself. */
typedef struct ray_list {
	uint32_t *ray; /* their numbers */
	float *line;   /* 6 each: where they start, in grid coordinates, and their unit directions */
	bool *covered; /* whether they meet one of the spheres */
	uint32_t count;
	uint32_t covered_count; /* among the rest */
} ray_list;

typedef struct cell_votes {
	uint32_t cell, votes;
} cell_votes;

/* The work in hand. */
typedef struct finder {
	gw_passes *passes;
	const gw_octree *octree;
	const gw_records *records;
	const gw_ray_gather *gather;
	ray_list sky, any; /* rays that left the scene, and rays whether they did or not; of records
						  that see little of the sky */
	double seen;       /* share of such a record's rays that left the scene */
	uint32_t *passing, *votes; /* of each cell */
	cell_votes *best;
} finder;

/* ---------------------------------------------------------------------------------- the rays */

static bool make_list(ray_list *list, uint64_t count)
{
	list->ray = gw_allocate_array((size_t)count, sizeof *list->ray);
	list->line = gw_allocate_array((size_t)count, 6 * sizeof *list->line);
	list->covered = gw_allocate_array((size_t)count, sizeof *list->covered);
	return list->ray && list->line && list->covered;
}

static void clear_list(ray_list *list)
{
	free(list->ray);
	free(list->line);
	free(list->covered);
}

/* How many rays of a record left the scene. */
static uint32_t count_escaped(const uint32_t *facet, uint32_t rays)
{
	uint32_t escaped = 0;
	for (uint32_t k = 0; k < rays; k++)
		escaped += facet[k] == GW_NONE;
	return escaped;
}

/* Fills both lists with every n-th of the rays, so that there are RAYS_MOST at most. */
static void fill_lists(finder *f, const uint32_t *facet, uint64_t sky, uint64_t any)
{
	uint32_t rays = f->gather->rays;
	uint64_t sky_step = (sky + RAYS_MOST - 1) / RAYS_MOST, sky_seen = 0;
	uint64_t any_step = (any + RAYS_MOST - 1) / RAYS_MOST, any_seen = 0;
	for (size_t i = 0; i < f->records->count; i++) {
		const uint32_t *own = facet + i * rays;
		if (count_escaped(own, rays) * NARROW >= rays)
			continue;
		for (uint32_t k = 0; k < rays; k++) {
			uint32_t ray = (uint32_t)(i * rays + k);
			if (any_seen++ % any_step == 0)
				f->any.ray[f->any.count++] = ray;
			if (own[k] == GW_NONE && sky_seen++ % sky_step == 0)
				f->sky.ray[f->sky.count++] = ray;
		}
	}
}

/* Lists rays of records that see little of the sky; none where the scene is open. */
static gw_status list_rays(finder *f, const uint32_t *facet, float *share, gw_error *error)
{
	uint64_t rays = f->gather->rays, all = rays * f->records->count;
	uint64_t escaped = 0, sky = 0, any = 0;
	for (size_t i = 0; i < f->records->count; i++) {
		uint64_t own = count_escaped(facet + i * rays, f->gather->rays);
		bool narrow = own * NARROW < rays;
		escaped += own;
		sky += narrow ? own : 0;
		any += narrow ? rays : 0;
	}
	*share = (float)((double)escaped / (double)all);
	if (sky < RAYS_LEAST || escaped * SCENE_NARROW > all)
		return GW_OK;
	f->seen = (double)sky / (double)any;
	if (!make_list(&f->sky, sky < RAYS_MOST ? sky : RAYS_MOST) ||
		!make_list(&f->any, any < RAYS_MOST ? any : RAYS_MOST))
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to look for portals");
	fill_lists(f, facet, sky, any);
	return GW_OK;
}

static gw_status find_directions(const finder *f, const ray_list *list, gw_buffer *ray,
								 gw_buffer *direction, gw_error *error)
{
	gw_gpu *gpu = f->passes->gpu;
	uint64_t count = list->count;
	GW_TRY(gw_buffer_create(gpu,
							&(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_R32_UINT,
													  4 * count, "rays looked at" },
							ray, error));
	GW_TRY(gw_buffer_upload(gpu, ray, 0, list->ray, 4 * count, error));
	GW_TRY(gw_buffer_create(gpu,
							&(gw_buffer_description){ GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED,
													  16 * count, "their directions" },
							direction, error));
	const gw_binding bindings[] = { gw_whole(ray), gw_whole(&f->records->position),
									gw_whole(&f->records->normal), gw_window(direction, 16) };
	const gw_record_push push = { .rays = f->gather->rays, .seed = f->gather->seed };
	return gw_passes_run(f->passes, GW_PASS_RECORD_DIRECTIONS, bindings, &push, list->count, error);
}

/* Directions of a list's rays, from the device, and where their records stand. */
static gw_status fetch_lines(const finder *f, ray_list *list, gw_error *error)
{
	gw_gpu *gpu = f->passes->gpu;
	gw_buffer ray = { 0 }, direction = { 0 };
	gw_view directions = { 0 }, places = { 0 };
	gw_status status = find_directions(f, list, &ray, &direction, error);
	if (status == GW_OK)
		status = gw_view_open(gpu, &direction, 16 * (uint64_t)list->count, &directions, error);
	if (status == GW_OK)
		status = gw_view_open(gpu, &f->records->position, 16 * (uint64_t)f->records->count, &places,
							  error);
	for (size_t i = 0; i < list->count && status == GW_OK; i++) {
		const float *from = places.bytes, *to = directions.bytes;
		memcpy(list->line + 6 * i, from + 4 * (size_t)(list->ray[i] / f->gather->rays), 12);
		memcpy(list->line + 6 * i + 3, to + 4 * i, 12);
	}
	gw_view_close(&directions);
	gw_view_close(&places);
	gw_buffer_destroy(gpu, &ray);
	gw_buffer_destroy(gpu, &direction);
	return status;
}

/* --------------------------------------------------------------------------------- the cells */

/* A walk along a ray through a grid of side^3 cells. */
typedef struct walk {
	double t[3], step[3];
	int32_t cell[3], forward[3], side;
} walk;

static walk start_walk(const float *line, int32_t side, float width)
{
	walk w = { .side = side };
	for (int k = 0; k < 3; k++) {
		double at = (double)line[k] / (double)width, d = (double)line[3 + k];
		d = fabs(d) > 1e-9 ? d : 1e-9;
		w.cell[k] = (int32_t)floor(at);
		w.forward[k] = d > 0.0 ? 1 : -1;
		w.t[k] = ((double)w.cell[k] + (d > 0.0 ? 1.0 : 0.0) - at) / d;
		w.step[k] = fabs(1.0 / d);
	}
	return w;
}

/* The next cell on the way; false where it leaves the grid. */
static bool go_on(walk *w, uint32_t *cell)
{
	int axis = w->t[0] <= w->t[1] && w->t[0] <= w->t[2] ? 0 : w->t[1] <= w->t[2] ? 1 : 2;
	w->cell[axis] += w->forward[axis];
	w->t[axis] += w->step[axis];
	if (w->cell[axis] < 0 || w->cell[axis] >= w->side)
		return false;
	*cell = (uint32_t)(w->cell[0] + w->side * (w->cell[1] + w->side * w->cell[2]));
	return true;
}

/* Most votes first. */
static int by_votes(const void *a, const void *b)
{
	const cell_votes *x = a, *y = b;
	if (x->votes != y->votes)
		return x->votes < y->votes ? 1 : -1;
	return (x->cell > y->cell) - (x->cell < y->cell);
}

/* The cells with the most votes, in f->best; returns how many, at most as many as there may be
 * portals. The cell in which a ray starts is
 * left out: there all rays of a record come together. */
static uint32_t elect_cells(finder *f, int32_t side, float width)
{
	size_t cells = (size_t)side * (size_t)side * (size_t)side;
	uint32_t cell, count = 0;
	memset(f->passing, 0, cells * sizeof *f->passing);
	memset(f->votes, 0, cells * sizeof *f->votes);
	for (size_t i = 0; i < f->sky.count; i += 2) {
		walk w = start_walk(f->sky.line + 6 * i, side, width);
		while (go_on(&w, &cell))
			f->passing[cell]++;
	}
	for (size_t i = 0; i < f->sky.count; i += 2) {
		uint32_t most = 0, chosen = 0;
		walk w = start_walk(f->sky.line + 6 * i, side, width);
		while (go_on(&w, &cell))
			if (f->passing[cell] > most) {
				most = f->passing[cell];
				chosen = cell;
			}
		f->votes[chosen] += most > 0;
	}
	for (uint32_t i = 0; i < cells; i++)
		if (f->votes[i] > 0)
			f->best[count++] = (cell_votes){ i, f->votes[i] };
	qsort(f->best, count, sizeof *f->best, by_votes);
	return count < GW_PORTALS_MOST ? count : GW_PORTALS_MOST;
}

/* -------------------------------------------------------------------------------- the spheres */

/* Marks the rays that meet a sphere; returns how many more of the rest that makes. */
static uint32_t cover(ray_list *list, const float sphere[4])
{
	uint32_t before = list->covered_count;
	float square = sphere[3] * sphere[3];
	for (size_t i = 0; i < list->count; i++) {
		const float *line = list->line + 6 * i, *d = line + 3;
		float to[3] = { sphere[0] - line[0], sphere[1] - line[1], sphere[2] - line[2] };
		float along = to[0] * d[0] + to[1] * d[1] + to[2] * d[2];
		float far = to[0] * to[0] + to[1] * to[1] + to[2] * to[2];
		bool meets = far <= square || (along > 0.0f && far - along * along <= square);
		list->covered_count += meets && !list->covered[i] && i % 2 == 1;
		list->covered[i] = list->covered[i] || meets;
	}
	return list->covered_count - before;
}

/*
 * The variance that is left at a record, relative to the square of its light: of light that spheres
 * do not cover, counted by the rays that find it, and of the rest by the samples that get through:
 *
 *   (1 - c) / (K q) + c^2 / (M s),  s = c q / a
 *
 * with c the share of the sky's rays that meet spheres, q the share of a record's K rays that see
 * the sky, a the share of all rays that go towards a sphere, and so s that of the M samples which
 * see the sky.
 */
static double noise_with(const finder *f)
{
	double c = (double)f->sky.covered_count / (f->sky.count / 2);
	double a = (double)f->any.covered_count / (f->any.count / 2);
	double rays = (double)f->gather->rays * f->seen;
	double through = fmin(c * f->seen / fmax(a, 1e-9), 1.0);
	return (1.0 - c) / rays + (c > 0.0 ? c * c / (GW_PORTAL_SAMPLES * through) : 0.0);
}

static void uncover(ray_list *list)
{
	memset(list->covered, 0, list->count * sizeof *list->covered);
	list->covered_count = 0;
}

/* Spheres around the cells of one grid, as many as lessen the noise; returns what is left of it. */
static double choose_spheres(finder *f, uint32_t level, float *sphere, uint32_t *count)
{
	float width = ldexpf(1.0f, (int)(f->octree->depth - level));
	uint32_t cells = elect_cells(f, 1 << level, width), mask = (1u << level) - 1, chosen = 0;
	double least = INFINITY;
	uncover(&f->sky);
	uncover(&f->any);
	*count = 0;
	for (uint32_t i = 0; i < cells; i++) {
		float *s = sphere + 4 * (size_t)chosen;
		for (uint32_t k = 0; k < 3; k++)
			s[k] = ((float)(f->best[i].cell >> k * level & mask) + 0.5f) * width;
		s[3] = SPHERE_OF_CUBE * width;
		if (cover(&f->sky, s) == 0)
			continue;
		chosen++;
		cover(&f->any, s);
		double noise = noise_with(f);
		if (noise < least) {
			least = noise;
			*count = chosen;
		}
	}
	return least;
}

/* The spheres of the grid that leaves the least noise, if that is worth it. */
static gw_status find_spheres(finder *f, float *sphere, uint32_t *count, gw_error *error)
{
	float own[4 * GW_PORTALS_MOST];
	uint32_t finest = f->octree->depth < LEVEL_FINEST ? f->octree->depth : LEVEL_FINEST;
	uint32_t cells = 1u << 3 * finest, found;
	double least = WORTH / ((double)f->gather->rays * f->seen);
	f->passing = gw_allocate_array(cells, sizeof *f->passing);
	f->votes = gw_allocate_array(cells, sizeof *f->votes);
	f->best = gw_allocate_array(cells, sizeof *f->best);
	if (!f->passing || !f->votes || !f->best)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a grid of %u cells", cells);
	for (uint32_t level = finest; level + 1 > LEVEL_COARSEST; level--) {
		double noise = choose_spheres(f, level, own, &found);
		if (noise >= least)
			continue;
		least = noise;
		*count = found;
		memcpy(sphere, own, 4 * found * sizeof *sphere);
	}
	return GW_OK;
}

static gw_status keep_spheres(gw_gpu *gpu, const float *sphere, uint32_t count, gw_portals *portals,
							  gw_error *error)
{
	portals->count = count;
	if (count == 0)
		return GW_OK;
	GW_TRY(
		gw_buffer_create(gpu,
						 &(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_R32G32B32A32_SFLOAT,
												   16 * count, "portals" },
						 &portals->sphere, error));
	return gw_buffer_upload(gpu, &portals->sphere, 0, sphere, 16 * count, error);
}

static gw_status look_along(finder *f, float *sphere, uint32_t *count, gw_error *error)
{
	GW_TRY(fetch_lines(f, &f->sky, error));
	GW_TRY(fetch_lines(f, &f->any, error));
	return find_spheres(f, sphere, count, error);
}

gw_status gw_portals_find(gw_passes *passes, const gw_octree *octree, const gw_records *records,
						  const gw_ray_gather *gather, gw_portals *portals, gw_error *error)
{
	finder f = { .passes = passes, .octree = octree, .records = records, .gather = gather };
	float sphere[4 * GW_PORTALS_MOST];
	uint32_t count = 0;
	gw_view hits = { 0 };
	*portals = (gw_portals){ .looked = 1 };
	if (records->count == 0)
		return GW_OK;
	gw_status status = gw_view_open(passes->gpu, &gather->facet,
									4 * (uint64_t)gather->rays * records->count, &hits, error);
	if (status == GW_OK)
		status = list_rays(&f, hits.bytes, &portals->escaped, error);
	gw_view_close(&hits);
	if (status == GW_OK && f.sky.count > 0)
		status = look_along(&f, sphere, &count, error);
	if (status == GW_OK)
		status = keep_spheres(passes->gpu, sphere, count, portals, error);
	clear_list(&f.sky);
	clear_list(&f.any);
	free(f.passing);
	free(f.votes);
	free(f.best);
	if (status != GW_OK)
		gw_portals_destroy(passes->gpu, portals);
	return status;
}

void gw_portals_destroy(gw_gpu *gpu, gw_portals *portals)
{
	gw_buffer_destroy(gpu, &portals->sphere);
	*portals = (gw_portals){ 0 };
}

/*
 * scene_probes.c - see scene_probes.h. Probes are records of another kind: placed in free space,
 * and traced to all sides.
 */
#include "bake/scene_probes.h"

#include "base/memory.h"
#include "glowworm_host.h"
#include "light/octahedral.h"
#include "light/probe_cells.h"
#include "light/probe_places.h"
#include "octree/compartments.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Surfels that balls of free space are grown from, and balls that are looked from, at most. */
#define SEEDS 8192u
#define CANDIDATES 512u

/* Spots on the surface that probes are chosen by, and those that are looked at in the end. */
#define CHOSEN_BY 2048u
#define LOOKED_AT 16384u

/* Rays start at surface within so many leaf cells of a place in its leaf: nearer than that a place
 * is as good as in the surface. */
#define LEAST_CELLS 2.0f

/* Texels a side of what is looked at from places, and the share of them that may lie behind. */
#define OUTLOOK 8u
#define BEHIND_MOST 0.5f

/* Where in its step the first spot lies, for the two choices. */
#define SHIFT_CHOSEN 0.5
#define SHIFT_LOOKED 0.19

/* Where nothing encloses the free space, probes stand outside the bounds by at most this share of
 * the longest side. */
#define OPEN_MARGIN 0.25f

/* All that lasts as long as probes are placed. */
typedef struct placing {
	gw_scene *scene;
	const gw_probes_options *options;
	gw_neighbours *search;
	gw_free_ball *ball;
	size_t ball_count;
	gw_sight_places chosen_by, looked_at;
	gw_free_ball_task room;
	gw_probe_places places;
	bool in_grid; /* they are wanted in grid coordinates, to light records by */
} placing;

static gw_status open_room(placing *p, gw_error *error)
{
	gw_scene *scene = p->scene;
	const gw_surfels *s = &scene->surfels;
	const gw_surfels_options how = gw_scene_surfels_options(scene, NULL, 0);
	const float margin = (float)ldexp((double)p->options->margin, scene->units.length);
	GW_TRY(gw_neighbours_open(s, &how, &p->search, error));
	p->room = (gw_free_ball_task){ .surfels = s,
								   .search = p->search,
								   .least = LEAST_CELLS * scene->octree.leaf_size,
								   .seeds = SEEDS,
								   .most = CANDIDATES,
								   .threads = scene->options.threads };
	for (int k = 0; k < 3; k++) {
		p->room.minimum[k] = s->minimum[k] - margin;
		p->room.maximum[k] = s->maximum[k] + margin;
	}
	return GW_OK;
}

/* Lets places lie outside of the bounds. */
static void widen(placing *p)
{
	const gw_surfels *s = &p->scene->surfels;
	float longest = 0.0f;
	for (int k = 0; k < 3; k++)
		longest = fmaxf(longest, s->maximum[k] - s->minimum[k]);
	for (int k = 0; k < 3; k++) {
		p->room.minimum[k] -= OPEN_MARGIN * longest;
		p->room.maximum[k] += OPEN_MARGIN * longest;
	}
}

/* What is around the balls. */
static gw_status look_out(placing *p, gw_probe_hits *hits, gw_error *error)
{
	gw_scene *scene = p->scene;
	const gw_octree *o = &scene->octree;
	const gw_probe_scene seen = { .passes = &scene->passes,
								  .octree = o,
								  .seed = (uint32_t)p->options->seed,
								  .threads = scene->options.threads };
	hits->place = gw_allocate_zeros(p->ball_count, 4 * sizeof *hits->place);
	hits->behind = gw_allocate_array(p->ball_count, sizeof *hits->behind);
	if (!hits->place || !hits->behind)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu places of probes", p->ball_count);
	for (size_t i = 0; i < p->ball_count; i++)
		for (size_t k = 0; k < 3; k++)
			hits->place[4 * i + k] = (p->ball[i].centre[k] - o->cube_minimum[k]) / o->leaf_size;
	return gw_probe_hits_trace(&seen, hits, error);
}

/* Leaves out balls from which most of what is around is seen through the backs of surfaces: a floor
 * goes on below what stands on it, and what is in front of it there is no free space. Those for
 * records stay where none would be left. */
static gw_status leave_out_solids(placing *p, gw_error *error)
{
	gw_probe_hits hits = { .count = p->ball_count, .size = OUTLOOK };
	gw_status status = look_out(p, &hits, error);
	size_t kept = 0;
	for (size_t i = 0; i < p->ball_count && status == GW_OK; i++)
		if (hits.behind[i] <= BEHIND_MOST)
			p->ball[kept++] = p->ball[i];
	if (status == GW_OK && (kept > 0 || !p->in_grid))
		p->ball_count = kept;
	free(hits.behind);
	gw_probe_hits_clear(&hits);
	return status;
}

static gw_status fail_unseen(size_t places, gw_error *error)
{
	return gw_fail(
		error, GW_ERROR_DATA,
		"there is no free space for a probe: from none of %zu places any surface is seen "
		"from in front; look at the normals",
		places);
}

static gw_status find_balls(placing *p, gw_error *error)
{
	gw_scene *scene = p->scene;
	GW_TRY(gw_free_balls_find(&p->room, &p->ball, &p->ball_count, error));
	if (p->ball_count == 0 && p->in_grid) {
		widen(p);
		GW_TRY(gw_free_balls_find(&p->room, &p->ball, &p->ball_count, error));
	}
	const size_t found = p->ball_count;
	if (found > 0)
		GW_TRY(leave_out_solids(p, error));
	if (p->ball_count > 0)
		return GW_OK;
	if (found > 0)
		return fail_unseen(found, error);
	return gw_fail(
		error, GW_ERROR_DATA,
		"there is no free space for a probe: in front of no surface there is room for "
		"%.3g m to all sides within the bounds of the points; a margin lets probes stand "
		"outside of them",
		ldexp((double)p->room.least, -scene->units.length));
}

static gw_status choose(placing *p, gw_error *error)
{
	gw_scene *scene = p->scene;
	gw_probe_task task = { .sight = { &scene->passes, &scene->octree, &p->chosen_by },
						   .search = p->search,
						   .candidate = p->ball,
						   .candidate_count = p->ball_count,
						   .least = p->room.least,
						   .most = p->options->count,
						   .moves = p->options->moves,
						   .seed = (uint32_t)p->options->seed,
						   .cancelled = gw_scene_stopped,
						   .user = scene };
	memcpy(task.minimum, p->room.minimum, sizeof task.minimum);
	memcpy(task.maximum, p->room.maximum, sizeof task.maximum);
	GW_TRY(gw_sight_places_make(scene->gpu, &scene->octree, CHOSEN_BY, SHIFT_CHOSEN, &p->chosen_by,
								error));
	/* In the largest free ball a probe is as far from everything as it can be. */
	p->chosen_by.reach = p->ball[0].radius / scene->octree.leaf_size;
	GW_TRY(gw_probe_places_choose(&task, &p->places, error));
	if (p->places.count > 0)
		return GW_OK;
	return fail_unseen(p->ball_count, error);
}

/* Middles of the cells of a regular grid over the bounds, but for those at the surface or behind
 * it. */
static gw_status choose_grid(placing *p, gw_error *error)
{
	const gw_octree *o = &p->scene->octree;
	const uint32_t side = p->options->grid;
	p->ball_count = (size_t)side * side * side;
	p->places.place = gw_allocate_array(p->ball_count, 4 * sizeof *p->places.place);
	if (!p->places.place)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a grid of %zu probes", p->ball_count);
	for (size_t i = 0; i < p->ball_count; i++) {
		const size_t cell[3] = { i % side, i / side % side, i / side / side };
		float *to = p->places.place + 4 * (size_t)p->places.count, at[3];
		for (int k = 0; k < 3; k++) {
			at[k] = p->room.minimum[k] + ((float)cell[k] + 0.5f) / (float)side *
											 (p->room.maximum[k] - p->room.minimum[k]);
			to[k] = (at[k] - o->cube_minimum[k]) / o->leaf_size;
		}
		to[3] = 0.0f;
		p->places.count += gw_free_distance(p->search, at) >= p->room.least &&
						   !gw_free_is_behind(p->room.surfels, p->search, at);
	}
	p->places.first = p->places.count;
	if (p->places.count > 0)
		return GW_OK;
	return gw_fail(error, GW_ERROR_DATA,
				   "of %zu probes in a regular grid none stands in free space, %.3g m from all "
				   "surface; ask for a finer one, or for a margin",
				   p->ball_count, ldexp((double)p->room.least, -p->scene->units.length));
}

/* The share of the surface that is seen, at spots that nobody chose by. */
static gw_status measure(placing *p, double *seen, gw_error *error)
{
	gw_scene *scene = p->scene;
	const gw_sight sight = { &scene->passes, &scene->octree, &p->looked_at };
	GW_TRY(gw_sight_places_make(scene->gpu, &scene->octree, LOOKED_AT, SHIFT_LOOKED, &p->looked_at,
								error));
	size_t width = p->looked_at.count;
	float *value = gw_allocate_array(width, p->places.count * sizeof *value);
	if (!value)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for what %u probes see", p->places.count);
	gw_status status = gw_sight_look(&sight, p->places.place, p->places.count, value, error);
	double area = 0.0;
	for (size_t t = 0; t < width && status == GW_OK; t++) {
		bool any = false;
		for (size_t k = 0; k < p->places.count; k++)
			any = any || value[k * width + t] > 0.0f;
		area += any ? (double)p->looked_at.area[t] : 0.0;
	}
	*seen = p->looked_at.total > 0.0 ? area / p->looked_at.total : 0.0;
	free(value);
	return status;
}

/* The maps have to fit into what the scene may use, or else into what is free. */
static gw_status check_room(const gw_scene *scene, size_t count, uint32_t size, gw_error *error)
{
	const uint64_t texels = (uint64_t)size * size, floats = 9 * texels + 2 * (texels / 3);
	const uint64_t bytes = count * floats * sizeof(float);
	const uint64_t room = scene->options.memory > 0 ? scene->options.memory : gw_available_memory();
	if (room == 0 || bytes <= room)
		return GW_OK;
	return gw_fail(error, GW_ERROR_MEMORY,
				   "the maps of %zu probes of %u x %u texels take %llu bytes, and %llu are "
				   "allowed; ask for fewer probes or smaller maps",
				   count, size, size, (unsigned long long)bytes, (unsigned long long)room);
}

static gw_status allocate(size_t count, uint32_t size, gw_probes *probes, gw_error *error)
{
	const size_t texels = (size_t)size * size, mips = (size_t)gw_octahedral_mip_texels(size);
	probes->count = count;
	probes->size = size;
	probes->probe = gw_allocate_zeros(count, sizeof *probes->probe);
	probes->radiance = gw_allocate_zeros(count, 3 * texels * sizeof *probes->radiance);
	probes->normal = gw_allocate_zeros(count, 3 * texels * sizeof *probes->normal);
	probes->distance = gw_allocate_zeros(count, texels * sizeof *probes->distance);
	probes->least = gw_allocate_zeros(count, mips * sizeof *probes->least);
	probes->greatest = gw_allocate_zeros(count, mips * sizeof *probes->greatest);
	return probes->probe && probes->radiance && probes->normal && probes->distance &&
				   probes->least && probes->greatest
			   ? GW_OK
			   : gw_fail(error, GW_ERROR_MEMORY,
						 "no memory for the maps of %zu probes of %u x %u texels; fewer probes or "
						 "smaller maps take less",
						 count, size, size);
}

/* A length of the scene in the metres that were given. */
double gw_scene_metres(const gw_scene *scene, double length)
{
	return ldexp(length, -scene->units.length);
}

/* The same of probes that stay in grid coordinates. */
static void describe_in_grid(const gw_scene *scene, const gw_placed_probes *placed,
							 gw_probes *probes)
{
	const gw_octree *o = &scene->octree;
	const gw_probe_numbers *n = &placed->numbers;
	for (size_t i = 0; i < probes->count; i++)
		for (size_t k = 0; k < 3; k++)
			probes->probe[i].position[k] = (double)placed->hits.place[4 * i + k];
	for (int k = 0; k < 3; k++) {
		probes->minimum[k] = (double)((n->minimum[k] - o->cube_minimum[k]) / o->leaf_size);
		probes->maximum[k] = (double)((n->maximum[k] - o->cube_minimum[k]) / o->leaf_size);
	}
}

/* A place in grid coordinates, in the surfels' frame. */
static void leave_grid(const gw_octree *o, const float *place, float at[3])
{
	for (int k = 0; k < 3; k++)
		at[k] = o->cube_minimum[k] + place[k] * o->leaf_size;
}

/* What is known of the probes without their maps. */
static void describe(const gw_scene *scene, const gw_placed_probes *placed, gw_probes *probes)
{
	const gw_probe_numbers *n = &placed->numbers;
	const double *origin = scene->surfels.origin;
	probes->seeable = n->seeable;
	probes->seen = n->seen;
	probes->candidates = (size_t)n->candidates;
	probes->first = (size_t)n->first;
	for (size_t i = 0; i < probes->count; i++) {
		float at[3];
		leave_grid(&scene->octree, placed->hits.place + 4 * i, at);
		for (int k = 0; k < 3; k++)
			probes->probe[i].position[k] = gw_scene_metres(scene, origin[k] + (double)at[k]);
		probes->probe[i].radius = (float)gw_scene_metres(scene, (double)placed->radius[i]);
	}
	for (int k = 0; k < 3; k++) {
		probes->minimum[k] = gw_scene_metres(scene, origin[k] + (double)n->minimum[k]);
		probes->maximum[k] = gw_scene_metres(scene, origin[k] + (double)n->maximum[k]);
	}
}

gw_status gw_scene_describe_probes(const gw_scene *scene, const gw_placed_probes *placed,
								   bool in_grid, gw_probes *probes, gw_error *error)
{
	GW_TRY(check_room(scene, placed->hits.count, placed->hits.size, error));
	GW_TRY(allocate(placed->hits.count, placed->hits.size, probes, error));
	if (in_grid)
		describe_in_grid(scene, placed, probes);
	else
		describe(scene, placed, probes);
	return GW_OK;
}

/* ------------------------------------------------------------------------------ placing them */

/* Finds places; how much of the surface is seen from them is looked at where they are not for
 * records. */
static gw_status find_places(placing *p, gw_placed_probes *placed, gw_error *error)
{
	gw_probe_numbers *n = &placed->numbers;
	GW_TRY(open_room(p, error));
	if (p->options->grid > 0) {
		GW_TRY(choose_grid(p, error));
	} else {
		GW_TRY(find_balls(p, error));
		GW_TRY(choose(p, error));
	}
	GW_TRY(check_room(p->scene, p->places.count, p->options->size, error));
	if (!p->in_grid)
		GW_TRY(measure(p, &n->seen, error));
	n->count = p->places.count;
	n->seeable = p->options->grid > 0 ? n->seen : p->places.seeable;
	n->candidates = p->ball_count;
	n->first = p->places.first;
	memcpy(n->minimum, p->room.minimum, sizeof n->minimum);
	memcpy(n->maximum, p->room.maximum, sizeof n->maximum);
	return GW_OK;
}

/* How far from all surfels the probes are. */
static gw_status find_radii(placing *p, gw_placed_probes *placed, gw_error *error)
{
	placed->radius = gw_allocate_array(p->places.count, sizeof *placed->radius);
	if (!placed->radius)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %u probes", p->places.count);
	for (size_t i = 0; i < p->places.count; i++) {
		float at[3];
		leave_grid(&p->scene->octree, p->places.place + 4 * i, at);
		placed->radius[i] = gw_free_distance(p->search, at);
	}
	return GW_OK;
}

/* What is seen from the places that were found. */
static gw_status trace(placing *p, gw_placed_probes *placed, gw_error *error)
{
	gw_scene *scene = p->scene;
	const gw_probe_scene seen = { .passes = &scene->passes,
								  .octree = &scene->octree,
								  .seed = (uint32_t)p->options->seed,
								  .threads = scene->options.threads };
	placed->hits = (gw_probe_hits){ .count = p->places.count,
									.size = p->options->size,
									.place = p->places.place };
	p->places.place = NULL;
	return gw_probe_hits_trace(&seen, &placed->hits, error);
}

static void end_placing(placing *p)
{
	gw_probe_places_clear(&p->places);
	gw_sight_places_clear(p->scene->gpu, &p->chosen_by);
	gw_sight_places_clear(p->scene->gpu, &p->looked_at);
	gw_neighbours_close(p->search);
	free(p->ball);
}

gw_status gw_scene_place_probes(gw_scene *scene, const gw_probes_options *options, bool in_grid,
								gw_placed_probes *placed, gw_error *error)
{
	placing p = { .scene = scene, .options = options, .in_grid = in_grid };
	*placed = (gw_placed_probes){ .numbers = gw_probe_numbers_of(options, scene->units.length) };
	gw_status status = find_places(&p, placed, error);
	if (status == GW_OK && !in_grid)
		status = find_radii(&p, placed, error);
	if (status == GW_OK)
		status = trace(&p, placed, error);
	end_placing(&p);
	if (status != GW_OK)
		gw_placed_probes_clear(placed);
	return status;
}

/* -------------------------------------------------------------------------------- for records */

/* Maps without light, and which facets they show. */
static gw_status show(gw_scene *scene, gw_placed_probes *placed, gw_probe_maps *maps,
					  gw_error *error)
{
	const gw_probe_scene seen = { .passes = &scene->passes,
								  .octree = &scene->octree,
								  .threads = scene->options.threads };
	const gw_probe_hits *hits = &placed->hits;
	const size_t texels = hits->count * hits->size * hits->size;
	GW_TRY(gw_scene_describe_probes(scene, placed, true, maps->probes, error));
	GW_TRY(gw_probe_hits_show(&seen, hits, 1.0, maps->probes, error));
	for (size_t i = 0; i < texels; i++)
		if (hits->facet[i] >= scene->octree.facet_count)
			hits->facet[i] = GW_NONE;
	maps->facet = placed->hits.facet;
	placed->hits.facet = NULL;
	return gw_probe_cells_find(maps->probes, scene->options.threads, error);
}

gw_status gw_scene_make_maps(gw_scene *scene, gw_error *error)
{
	gw_probes_options options = gw_probes_options_default();
	gw_placed_probes placed = { .radius = NULL };
	gw_probe_maps *maps = &scene->maps;
	if (maps->probes)
		return GW_OK;
	maps->probes = gw_allocate_zeros(1, sizeof *maps->probes);
	if (!maps->probes)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for probes");
	options.size = scene->options.probe_size;
	options.seed = scene->options.seed;
	gw_status status = gw_compartments_find(scene->gpu, &scene->surfels, scene->options.threads,
											&scene->octree, error);
	if (status == GW_OK)
		status = gw_scene_place_probes(scene, &options, true, &placed, error);
	if (status == GW_OK)
		status = show(scene, &placed, maps, error);
	gw_placed_probes_clear(&placed);
	if (status != GW_OK)
		gw_probe_maps_clear(maps);
	return status;
}

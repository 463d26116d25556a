/* side_light.c - see side_light.h. */
#include "normals/side_light.h"

#include "base/distribution.h"
#include "base/luminance.h"
#include "base/memory.h"
#include "base/up_axis.h"
#include "cloud/frame.h"
#include "glowworm_host.h"
#include "octree/trace_constants.h"
#include "normals/disc_tree.h"
#include "normals/scanner_sight.h"

#include <math.h>
#include <stdlib.h>

/* Discs that stand for all surface, places that light is looked for at, and rays from each side. */
#define DISCS 32768
#define PLACES 4096
#define RAYS 24u
#define PART 1024u /* places between two looks whether to stop */
/* Patches of fewer surfels have no place. */
#define PATCH_LEAST 8

/* A disc's radius by the width of what it stands for: of random points 1 in 300,000 rays gets
 * through a sheet, exp(-pi 2^2). */
#define DISC_WIDTH 2.0f
/* But at most this share of the scene: a point far from all others is no wall. */
#define DISC_MOST 0.05

/* Reflections between places, each of this share of the light. */
#define REFLECTIONS 6
#define ALBEDO 0.5

/*
 * A space in which a scanner could stand: distances across it are above ROOM_PATH metres, and there
 * is a floor. The light that falls into it counts ROOM_FACTOR times, by the 16th power of the
 * share of directions that end at surface: daylight in rooms is about 2 % of that outside, and some
 * 0.2 % gets into a thing through what of it was not scanned. What is reflected does not count so:
 * where surfaces meet, discs stick out on the other side, and show there what light they have on
 * this one.
 */
#define ROOM_PATH 0.5
#define ROOM_FACTOR 300.0

/* Only light at places of which so many rays meet surface is in a room: what stands in the open was
 * put on the wrong side of a closed thing, and has all the light of the other one. */
#define INDOORS 0.75

/* Less light gets into what has a smaller opening: where less than this share of the directions,
 * that of a room with a window, ends in none, it counts by as much more. But so many may pass
 * between discs. */
#define WINDOW 0.02
#define LEAK 0.0003
/*
 * Where no more than this share ends in none, nothing is known to be open: what sun and sky bring
 * came in between discs, as little as it is, and a sealed thing is dark inside but for lamps. Discs
 * let through LEAK at most, of sheets of random points that meet in edges; of the 8 rays that go
 * down of the RAYS from each of PLACES places, 33,000, that is 10 with a standard deviation of 3.1,
 * and this is three such above it. A room of 85 m^2 around has windows of 0.05 m^2 or more then.
 */
#define SEALED (2.0 * LEAK)
/* A lamp within shines on more than this share of the area; through leaks one shines on LEAK of it,
 * and what emits on RAYS times that at most. */
#define SHONE_LEAST 0.05
/* A ray goes down where it falls by this share of its length. */
#define DOWN 0.3f

/* Light that comes from where nothing was scanned, of the mean of what lamps, sun and sky bring. */
#define AMBIENT 0.2

/* Rays and light from lower above a place's plane than this sine are left out: planes are not known
 * that well. */
#define LOWEST 0.25f

/* Where a ray ends that meets no disc. */
#define TO_SKY (GW_NONE - 1)
#define TO_DARK GW_NONE

/* A disc, and what is known of the surface that it stands for. */
typedef struct blocker {
	uint32_t place; /* that has the light of this surface, or GW_NONE */
	float radiance; /* that it emits, luminance */
} blocker;

/* A place on a patch, whose normal is the patch's. */
typedef struct place {
	uint32_t patch;
	float area; /* that it stands for, m^2 */
	bool emits;
	gw_disc disc;
	double direct[2]; /* irradiance on either side, luminance: of lamps and sun */
	bool shone[2];    /* by lamps, which have a place, or by what emits */
	bool seen[2];     /* by scanners */
	double first[2];  /* before any reflection */
	double lit[2];    /* likewise, without light from where nothing was scanned */
	double total[2];
	double path[2];      /* sum of the logarithms of the rays' lengths, to what they meet */
	double dark_path[2]; /* sum of the lengths of those that end where nothing emits, metres */
	uint32_t met[2], down[2], down_met[2]; /* rays */
	uint32_t own[2];           /* bits of rays that end on the emitting surface that they leave */
	float log_length[2][RAYS]; /* of rays that meet a disc */
	uint32_t end[2][RAYS];     /* 2 * disc + side, TO_SKY or TO_DARK */
} place;

typedef struct side_work {
	const gw_surfels_options *options;
	const gw_surfels *surfels;
	const gw_patches *patches;
	double area;     /* of all surface, m^2 */
	float reach;     /* longer than the scene, metres */
	gw_vec3 up;      /* unit */
	double sky;      /* radiance, luminance */
	double ambient;  /* likewise, from everywhere */
	gw_disc *disc;   /* facet: its number among the blockers */
	blocker *blocks; /* disc_count */
	size_t disc_count;
	place *places;
	size_t place_count;
	size_t first; /* place of the part that is being worked at */
	gw_disc_tree tree;
} side_work;

/* ------------------------------------------------------------------------------------ choosing */

static float signed_component(const side_work *w, size_t surfel, size_t k)
{
	float n = w->surfels->normal[3 * surfel + k];
	return w->patches->opposite[surfel] ? -n : n;
}

static gw_disc make_disc(const side_work *w, size_t surfel, double least_area)
{
	const float *p = w->surfels->position + 3 * surfel;
	float area = fmaxf(w->patches->area[surfel], (float)least_area);
	return (gw_disc){ .place = { p[0], p[1], p[2] },
					  .normal = { signed_component(w, surfel, 0), signed_component(w, surfel, 1),
								  signed_component(w, surfel, 2) },
					  .radius = fminf(DISC_WIDTH * sqrtf(area), (float)DISC_MOST * w->reach) };
}

/* How much surface has been passed since something was chosen, per patch and in all. */
typedef struct passed {
	double area, emitted;
	double *of_patch;     /* area */
	uint32_t *last_place; /* of a patch, or GW_NONE */
	uint32_t *size;       /* of a patch, surfels */
} passed;

/* A place for every so much area of a patch, and one at least. */
static void choose_place(side_work *w, passed *so_far, size_t surfel, double every)
{
	uint32_t patch = w->patches->patch_of[surfel];
	double *area = so_far->of_patch + patch;
	bool first = so_far->last_place[patch] == GW_NONE;
	*area += (double)w->patches->area[surfel];
	if (so_far->size[patch] < PATCH_LEAST)
		return;
	if (first || *area >= every) {
		so_far->last_place[patch] = (uint32_t)w->place_count;
		if (w->places)
			w->places[w->place_count] = (place){ .patch = patch,
												 .emits = gw_surfel_emits(w->surfels, surfel),
												 .disc = make_disc(w, surfel, 0.0) };
		w->place_count++;
		*area = 0.0;
	}
	if (w->places)
		w->places[so_far->last_place[patch]].area += w->patches->area[surfel];
}

static void choose_disc(side_work *w, passed *so_far, size_t surfel, double every)
{
	const gw_surfels *s = w->surfels;
	double area = (double)w->patches->area[surfel];
	so_far->area += area;
	so_far->emitted += s->emission ? area * gw_luminance(s->emission + 3 * surfel) : 0.0;
	if (s->count > DISCS && so_far->area < every)
		return;
	if (w->disc) {
		w->disc[w->disc_count] = make_disc(w, surfel, s->count > DISCS ? every : 0.0);
		w->disc[w->disc_count].facet = (uint32_t)w->disc_count;
		w->blocks[w->disc_count] = (blocker){
			.place = so_far->last_place[w->patches->patch_of[surfel]],
			.radiance = so_far->area > 0.0 ? (float)(so_far->emitted / so_far->area) : 0.0f,
		};
	}
	w->disc_count++;
	so_far->area = so_far->emitted = 0.0;
}

/* Goes over all surfels; counts only where there is no room yet. */
static void choose(side_work *w, passed *so_far)
{
	size_t count = w->surfels->count;
	w->disc_count = w->place_count = 0;
	so_far->area = so_far->emitted = 0.0;
	for (size_t i = 0; i < w->patches->count; i++) {
		so_far->of_patch[i] = 0.0;
		so_far->last_place[i] = GW_NONE;
	}
	for (size_t i = 0; i < count; i++) {
		choose_place(w, so_far, i, w->area / PLACES);
		choose_disc(w, so_far, i, w->area / DISCS);
	}
}

static bool make_room(side_work *w)
{
	w->disc = gw_allocate_array(w->disc_count, sizeof *w->disc);
	w->blocks = gw_allocate_array(w->disc_count, sizeof *w->blocks);
	w->places = gw_allocate_array(w->place_count, sizeof *w->places);
	return w->disc && w->blocks && w->places;
}

static gw_status choose_all(side_work *w, gw_error *error)
{
	size_t patches = w->patches->count;
	passed so_far = { .of_patch = gw_allocate_array(patches, sizeof *so_far.of_patch),
					  .last_place = gw_allocate_array(patches, sizeof *so_far.last_place),
					  .size = gw_allocate_zeros(patches, sizeof *so_far.size) };
	bool made = so_far.of_patch && so_far.last_place && so_far.size;
	if (made) {
		for (size_t i = 0; i < w->surfels->count; i++) {
			w->area += (double)w->patches->area[i];
			so_far.size[w->patches->patch_of[i]]++;
		}
		choose(w, &so_far);
		made = make_room(w);
		if (made)
			choose(w, &so_far);
	}
	free(so_far.of_patch);
	free(so_far.last_place);
	free(so_far.size);
	return made ? GW_OK
				: gw_fail(error, GW_ERROR_MEMORY,
						  "no memory for the sides of %zu patches of surface", patches);
}

/* --------------------------------------------------------------------------------------- lights */

/* Whether nothing lies between a place, on one of its sides, and what is so far away. */
static bool is_free(const side_work *w, const place *p, gw_vec3 direction, float length)
{
	gw_disc_start from = { p->disc.place, direction };
	return gw_disc_tree_cross(&w->tree, &from, &p->disc, &length) == GW_NONE;
}

static void add_direct(const side_work *w, place *p, gw_vec3 direction, float length, double value)
{
	float cosine = gw_dot(p->disc.normal, direction);
	if (!(value > 0.0) || !(fabsf(cosine) > LOWEST) || !is_free(w, p, direction, length))
		return;
	p->direct[cosine < 0.0f] += value * fabs((double)cosine);
	p->shone[cosine < 0.0f] |= length < w->reach;
}

static void add_lamp(const side_work *w, place *p, const gw_light *l)
{
	const double *o = w->surfels->origin;
	gw_vec3 to = { (float)(l->position[0] - o[0]), (float)(l->position[1] - o[1]),
				   (float)(l->position[2] - o[2]) };
	to = gw_minus(to, p->disc.place);
	float length = sqrtf(gw_dot(to, to));
	gw_vec3 axis = { (float)l->direction[0], (float)l->direction[1], (float)l->direction[2] };
	gw_vec3 way = gw_times(to, 1.0f / length);
	if (!(length > 0.0f))
		return;
	if (l->type == GW_LIGHT_SPOT && -gw_dot(gw_unit(axis), way) < cosf(l->outer_angle * 0.01745f))
		return;
	double share = (double)gw_distribution_towards(l, gw_times(way, -1.0f));
	double nearest = fmax((double)length, (double)p->disc.radius);
	add_direct(w, p, way, length, gw_luminance(l->intensity) * share / (nearest * nearest));
}

static void add_lights(const side_work *w, place *p)
{
	for (size_t i = 0; i < w->options->light_count; i++) {
		const gw_light *l = w->options->lights + i;
		if (gw_light_has_place(l)) {
			add_lamp(w, p, l);
		} else if (l->type == GW_LIGHT_SUN) {
			gw_vec3 way = { (float)-l->direction[0], (float)-l->direction[1],
							(float)-l->direction[2] };
			add_direct(w, p, gw_unit(way), w->reach, gw_luminance(l->irradiance));
		}
	}
}

/* From where scanners see a place. */
static void look_from_scanners(const side_work *w, place *p)
{
	size_t count = w->patches->scanner_count;
	for (size_t i = 0; i < count; i += gw_sight_step(count)) {
		const double *at = w->patches->scanner + 3 * i;
		gw_vec3 to = gw_minus((gw_vec3){ (float)at[0], (float)at[1], (float)at[2] }, p->disc.place);
		float length = sqrtf(gw_dot(to, to));
		gw_vec3 way = gw_times(to, 1.0f / length);
		float cosine = gw_dot(p->disc.normal, way);
		if (fabsf(cosine) > LOWEST && is_free(w, p, way, length))
			p->seen[cosine < 0.0f] = true;
	}
}

/* ----------------------------------------------------------------------------------------- rays */

/* Directions spread evenly by the cosine, turned from place to place by the golden angle. */
static gw_vec3 ray_direction(const gw_disc *disc, uint32_t ray, size_t number, bool back)
{
	const float normal[3] = { disc->normal.x, disc->normal.y, disc->normal.z };
	float t[3], b[3];
	gw_tangent_frame(normal, t, b);
	float squared = ((float)ray + 0.5f) / (float)RAYS * (1.0f - LOWEST * LOWEST);
	float radius = sqrtf(squared);
	float turn = 2.39996323f * (float)((ray + 7 * number) % 100003);
	float x = radius * cosf(turn), y = radius * sinf(turn), z = sqrtf(1.0f - squared);
	z = back ? -z : z;
	return (gw_vec3){ x * t[0] + y * b[0] + z * normal[0], x * t[1] + y * b[1] + z * normal[1],
					  x * t[2] + y * b[2] + z * normal[2] };
}

/* Does the ray of a place that emits end where that emits, too, no higher above its plane than the
 * disc there is wide? Noisy surface sees itself from either side, which tells nothing. */
static bool is_own(const side_work *w, const place *p, size_t disc, gw_vec3 way)
{
	return p->emits && w->blocks[disc].radiance > 0.0f &&
		   fabsf(gw_dot(way, p->disc.normal)) < w->disc[disc].radius;
}

static void shoot(const side_work *w, place *p, size_t number, bool back)
{
	for (uint32_t ray = 0; ray < RAYS; ray++) {
		gw_disc_start from = { p->disc.place, ray_direction(&p->disc, ray, number, back) };
		float length = w->reach;
		uint32_t disc = gw_disc_tree_cross(&w->tree, &from, &p->disc, &length);
		float rise = gw_dot(from.direction, w->up);
		p->down[back] += rise < -DOWN;
		p->down_met[back] += rise < -DOWN && disc != GW_NONE;
		if (disc == GW_NONE) {
			p->end[back][ray] = rise > 0.0f ? TO_SKY : TO_DARK;
			continue;
		}
		bool from_behind = gw_dot(w->disc[disc].normal, from.direction) > 0.0f;
		p->end[back][ray] = 2 * disc + from_behind;
		p->own[back] |= (uint32_t)is_own(w, p, disc, gw_times(from.direction, length)) << ray;
		p->log_length[back][ray] = logf(length);
		p->path[back] += log((double)length);
		p->dark_path[back] += w->blocks[disc].radiance > 0.0f ? 0.0 : (double)length;
		p->shone[back] |= w->blocks[disc].radiance > 0.0f;
		p->met[back]++;
	}
}

static void look_around(void *user, size_t first, size_t last, uint32_t worker)
{
	side_work *w = user;
	(void)worker;
	for (size_t i = w->first + first; i < w->first + last; i++) {
		add_lights(w, w->places + i);
		look_from_scanners(w, w->places + i);
		shoot(w, w->places + i, i, false);
		shoot(w, w->places + i, i, true);
	}
}

/* In parts, between which somebody may stop it. */
static gw_status look_around_all(side_work *w, gw_error *error)
{
	const gw_surfels_options *o = w->options;
	for (w->first = 0; w->first < w->place_count; w->first += PART) {
		if (o->cancelled && o->cancelled(o->user))
			return gw_fail(error, GW_ERROR_CANCELLED, "stopped while looking for front sides");
		size_t left = w->place_count - w->first;
		gw_parallel_for(o->threads, left < PART ? left : PART, 32, look_around, w);
	}
	return GW_OK;
}

/* ---------------------------------------------------------------------------------- reflections */

/* pi times the radiance at the end of a ray, by what is known so far, but for what its own surface
 * emits; `below` of what comes from below the horizon. */
static double light_from(const side_work *w, uint32_t end, bool own, double below)
{
	if (end == TO_DARK || end == TO_SKY)
		return M_PI * (end == TO_SKY ? w->sky + w->ambient : below);
	const blocker *b = w->blocks + end / 2;
	double light = own ? 0.0 : M_PI * (double)b->radiance;
	return b->place == GW_NONE ? light : light + ALBEDO * w->places[b->place].total[end % 2];
}

static void gather(const side_work *w, place *p, double below, double to[2])
{
	for (int side = 0; side < 2; side++) {
		double sum = 0.0;
		for (uint32_t ray = 0; ray < RAYS; ray++)
			sum += light_from(w, p->end[side][ray], p->own[side] >> ray & 1, below);
		to[side] = p->direct[side] + sum / RAYS;
	}
}

/* Each place sees the newest light of those before it, which only speeds things up. */
static void reflect(side_work *w)
{
	double light = 0.0, area = 0.0;
	w->ambient = 0.0;
	for (size_t i = 0; i < w->place_count; i++)
		w->places[i].total[0] = w->places[i].total[1] = 0.0;
	for (size_t i = 0; i < w->place_count; i++) {
		place *p = w->places + i;
		gather(w, p, 0.0, p->lit);
		light += (double)p->area * fmax(p->lit[0], p->lit[1]);
		area += (double)p->area;
	}
	w->ambient = area > 0.0 ? AMBIENT * light / (M_PI * area) : 0.0;
	for (size_t i = 0; i < w->place_count; i++)
		gather(w, w->places + i, 0.0, w->places[i].first);
	for (int round = 0; round <= REFLECTIONS; round++)
		for (size_t i = 0; i < w->place_count; i++)
			gather(w, w->places + i, w->ambient, w->places[i].total);
}

/* ------------------------------------------------------------------------------------- patches */

static void add_place(const place *p, int side, gw_side_view *sum)
{
	double area = (double)p->area;
	sum->area += area;
	sum->light += area * p->total[side];
	sum->first += p->met[side] >= INDOORS * RAYS ? area * p->first[side] : 0.0;
	sum->shone += p->shone[side] ? area : 0.0;
	sum->lit += area * p->lit[side];
	sum->seen += p->seen[side] && !p->seen[1 - side] ? area : 0.0;
	sum->met += area * p->met[side] / RAYS;
	sum->path += area * p->path[side] / RAYS;
	sum->dark_path += area * p->dark_path[side] / RAYS;
	sum->down += area * p->down[side] / RAYS;
	sum->down_met += area * p->down_met[side] / RAYS;
}

double gw_side_factor(const gw_side_view *side)
{
	if (!(side->met > 0.0) || !(side->light > 0.0))
		return 1.0;
	double closed = side->met / side->area;
	if (side->down > 0.0)
		closed = fmin(closed, side->down_met / side->down);
	if (1.0 - closed < SEALED && side->shone < SHONE_LEAST * side->area)
		return 1.0;
	double path = pow(exp(side->path / side->met) / ROOM_PATH, 4.0);
	double wide = path / (1.0 + path);
	double factor = ROOM_FACTOR * pow(closed, 16.0) * wide;
	factor *= fmax(1.0, wide * WINDOW / (1.0 - closed + LEAK));
	return 1.0 + factor * side->first / side->light;
}

/* ------------------------------------------------------------------------------------ all of it */

bool gw_side_light_is_sky(const gw_surfels_options *options, const gw_surfels *surfels)
{
	bool lit = surfels->emission != NULL;
	for (size_t i = 0; i < options->light_count; i++)
		lit |= gw_light_shines(options->lights + i);
	return !lit;
}

static void find_sky(side_work *w)
{
	for (size_t i = 0; i < w->options->light_count; i++) {
		const gw_light *l = w->options->lights + i;
		if (l->type == GW_LIGHT_ENVIRONMENT)
			w->sky += gw_luminance(l->radiance);
	}
	if (!(w->sky > 0.0) && gw_side_light_is_sky(w->options, w->surfels))
		w->sky = 1.0;
}

static void find_frame(side_work *w)
{
	double up[3];
	gw_up_axis(w->surfels->up, up);
	w->up = (gw_vec3){ (float)up[0], (float)up[1], (float)up[2] };
	double squared = 0.0;
	for (int k = 0; k < 3; k++) {
		double width = (double)w->surfels->maximum[k] - (double)w->surfels->minimum[k];
		squared += width * width;
	}
	w->reach = (float)(1.01 * sqrt(squared));
}

/* What was found, for each patch. */
static void add_up(const side_work *w, gw_side_light *light)
{
	for (size_t i = 0; i < w->patches->count; i++)
		light[i] = (gw_side_light){ 0 };
	for (size_t i = 0; i < w->place_count; i++)
		for (int side = 0; side < 2; side++)
			add_place(w->places + i, side, light[w->places[i].patch].side + side);
}

/* Leaves nothing of the lights but a sky. */
static void leave_sky(side_work *w)
{
	w->sky = 1.0;
	for (size_t i = 0; i < w->place_count; i++)
		w->places[i].direct[0] = w->places[i].direct[1] = 0.0;
	for (size_t i = 0; i < w->disc_count; i++)
		w->blocks[i].radiance = 0.0f;
}

/* What the ray of a place meets, if that has a place of its own. */
static bool find_sight(const side_work *w, const place *p, uint32_t number, gw_side_sight *sight)
{
	uint32_t side = number / RAYS, ray = number % RAYS, end = p->end[side][ray];
	if (end == TO_DARK || end == TO_SKY || w->blocks[end / 2].place == GW_NONE)
		return false;
	*sight = (gw_side_sight){ .from = 2 * p->patch + side,
							  .to = 2 * w->places[w->blocks[end / 2].place].patch + end % 2,
							  .area = p->area / (float)RAYS,
							  .path = p->log_length[side][ray] };
	return true;
}

static gw_status find_sights(const side_work *w, gw_side_lights *found, gw_error *error)
{
	found->sights = gw_allocate_array(2 * RAYS * w->place_count, sizeof *found->sights);
	if (!found->sights)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for what %zu places see", w->place_count);
	for (size_t i = 0; i < w->place_count; i++)
		for (uint32_t number = 0; number < 2 * RAYS; number++)
			found->sight_count +=
				find_sight(w, w->places + i, number, found->sights + found->sight_count);
	return GW_OK;
}

static gw_status find_light(side_work *w, gw_side_lights *found, gw_error *error)
{
	find_sky(w);
	find_frame(w);
	GW_TRY(choose_all(w, error));
	GW_TRY(gw_disc_tree_build(w->disc, w->disc_count, &w->tree, error));
	GW_TRY(look_around_all(w, error));
	reflect(w);
	add_up(w, found->light);
	GW_TRY(find_sights(w, found, error));
	if (found->by_sky) {
		leave_sky(w);
		reflect(w);
		add_up(w, found->by_sky);
	}
	return GW_OK;
}

gw_status gw_side_light_find(const gw_surfels_options *options, const gw_surfels *surfels,
							 const gw_patches *patches, gw_side_lights *found, gw_error *error)
{
	side_work w = { .options = options, .surfels = surfels, .patches = patches };
	gw_status status = find_light(&w, found, error);
	gw_disc_tree_clear(&w.tree);
	free(w.disc);
	free(w.blocks);
	free(w.places);
	return status;
}

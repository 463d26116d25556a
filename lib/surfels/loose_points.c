/*
 * loose_points.c - see loose_points.h.
 */
#include "surfels/loose_points.h"

#include "base/memory.h"
#include "base/nth_element.h"
#include "cloud/frame.h"
#include "surfels/surfel_plane.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

/* Of each point it is measured which share of its neighbours lies on one surface with it. A point
 * is loose when the mean of that share over its neighbours is below this, and the mean over the
 * points up to about twice as far as well: at corners of rooms the first one is low, too, but not
 * the second. */
#define ON_SURFACE 0.5f

/* From this share on it is solid, and says what a point stands for, unless less than one in WITH_IT
 * of its own neighbours lies on a surface with it, as of a stray before a wall. What is in between
 * is beside leaves, in corners, or on wires whose points lie in rows, so that many of one side are
 * alike. */
#define SOLID 0.9f

/* Lists of fewer neighbours than this say nothing: such points count as a surface. */
#define TELLS (GW_NEIGHBOURS / 2)

/* In the midst of what is solid a point floats, as strays do and the rows of them that beams leave
 * which an edge has split, if so many of its neighbours are solid, and less than one in so many of
 * these lies on a surface with it: in a corner half of them do. So it does off a plane of those
 * that face as it does, by so many times what they are off it themselves, and by so much of its
 * disc's radius. Is it so many times the radius of each of their discs away, too, it is as loose as
 * on a leaf. */
#define SOLID_AROUND 3u
#define OFF_PLANE 4.0
#define OFF_DISC 0.5
#define WITH_IT 4u
#define FAR_AFLOAT 4.0

/* Both are loose as well if their disc is wide. It is so for some of its neighbours, whose discs
 * are not half as wide: a sparse room has none such. And it is for what is solid, near it and
 * everywhere: so many times the most that a point stands for there, where a disc of even points has
 * GW_DISC_RANK times as much. Where half of a room is dense and the rest so sparse that none of it
 * is solid, walls stay shut with this (tests/physics/test_leaks.c), and not with 2. */
#define NARROW_NEIGHBOURS 2u
#define WIDE_NEAR (2.5f * (float)GW_DISC_RANK)
#define WIDE_EVERYWHERE (4.0f * (float)GW_DISC_RANK)

/* Half thickness of a surface, in distances of the furthest neighbour, as in surfel_plane.c. */
#define SLAB 0.35

/* So far into leaves areas are handed on from what is solid, in steps of neighbours; further in the
 * median of all that is solid counts. */
#define STEPS_MOST 64

#define NO_SLOT UINT32_MAX

typedef enum looseness { IN_BETWEEN, LOOSE, LOOSE_IF_WIDE, LOOSE_IF_AFLOAT } looseness;

/* What a point stands for on the solid surface near one, m^2. */
typedef struct stood_for {
	float mean, most;
} stood_for;

typedef struct loose_step {
	const gw_surfels *surfels;
	uint8_t *alone;     /* count, 1: hardly any of its neighbours lies on a surface with it, or
						   it is off their plane */
	const float *share; /* count, of neighbours: what the means are taken of */
	float median;       /* m^2, of what is solid: what a point stands for */
	float *mean;        /* count, receives them */
	uint32_t *slot;     /* count, of the row of a point that is not solid, or NO_SLOT */
	uint32_t *row;      /* GW_NEIGHBOURS for each slot: its neighbours */
	uint32_t *surfel;   /* of each slot */
	uint8_t *loose;     /* of each slot: one of looseness */
	stood_for *area;    /* of each slot: what a point stands for there; 0: not known yet */
	size_t slots;
	uint32_t *open;   /* slots whose area is not known yet */
	stood_for *found; /* of each of these: its area, or 0 */
} loose_step;

static double distance_between(const gw_surfels *s, size_t a, size_t b)
{
	double square = 0.0;
	for (size_t k = 0; k < 3; k++) {
		double way = (double)s->position[3 * b + k] - (double)s->position[3 * a + k];
		square += way * way;
	}
	return sqrt(square);
}

/* Cosine between two surfels. */
static float facing(const gw_surfels *s, size_t surfel, size_t other)
{
	const float *n = s->normal + 3 * surfel, *m = s->normal + 3 * other;
	return n[0] * m[0] + n[1] * m[1] + n[2] * m[2];
}

/* How far one lies above the plane of a surfel, metres. */
static double height_of(const gw_surfels *s, size_t surfel, size_t other)
{
	double height = 0.0;
	for (size_t k = 0; k < 3; k++)
		height += (double)s->normal[3 * surfel + k] *
				  ((double)s->position[3 * other + k] - (double)s->position[3 * surfel + k]);
	return height;
}

/* Cosine between two surfels that lie in one slab; 0: they do not. */
static float facing_in_slab(const gw_surfels *s, size_t surfel, size_t other, double slab)
{
	return fabs(height_of(s, surfel, other)) <= slab ? facing(s, surfel, other) : 0.0f;
}

/* Does a surfel float off a plane of those that face as it does? */
static bool is_off_plane(const gw_surfels *s, size_t surfel, const gw_neighbour_list *list)
{
	double sum = 0.0, squares = 0.0, count = 0.0;
	for (uint32_t j = 0; j < list->count; j++) {
		size_t other = list->index[j];
		if (!(facing(s, surfel, other) > (float)GW_SAME_SURFACE))
			continue;
		double height = height_of(s, surfel, other);
		sum += height;
		squares += height * height;
		count += 1.0;
	}
	double mean = fabs(sum) / fmax(count, 1.0);
	double scatter = sqrt(fmax(squares / fmax(count, 1.0) - mean * mean, 0.0));
	return count >= TELLS && mean > OFF_PLANE * scatter &&
		   mean > OFF_DISC * (double)s->radius[surfel];
}

/* Those on the other side of a thin sheet are of the same surface, but more of leaves than of walls
 * lie so by chance: half of them count. */
static void measure(void *user, size_t surfel, const gw_neighbour_list *list)
{
	const loose_step *step = user;
	float alike = 0.0f, opposite = 0.0f;
	double slab = list->count > 0 ? SLAB * (double)list->distance[list->count - 1] : 0.0;
	for (uint32_t j = 0; j < list->count; j++) {
		float cosine = facing_in_slab(step->surfels, surfel, list->index[j], slab);
		alike += cosine > (float)GW_SAME_SURFACE ? 1.0f : 0.0f;
		opposite += cosine < -(float)GW_SAME_SURFACE ? 0.5f : 0.0f;
	}
	bool tells = list->count >= TELLS;
	float share = tells ? (alike + opposite) / ((float)list->count - opposite) : 1.0f;
	step->mean[surfel] = share;
	step->alone[surfel] =
		(float)WITH_IT * share < 1.0f || is_off_plane(step->surfels, surfel, list);
}

static void average(void *user, size_t surfel, const gw_neighbour_list *list)
{
	const loose_step *step = user;
	double sum = (double)step->share[surfel]; /* of equal neighbours the order may be any */
	for (uint32_t j = 0; j < list->count; j++)
		sum += (double)step->share[list->index[j]];
	step->mean[surfel] = (float)(sum / (double)(list->count + 1));
}

/* To mean[0] goes each point's share averaged over its neighbours, once; to mean[2] averaged three
 * times, each time over what the last one gave, and so over points about twice as far. */
static gw_status measure_shares(gw_neighbours *search, loose_step *step, float *mean[3],
								gw_error *error)
{
	const float *from[3] = { mean[1], mean[0], mean[1] };
	step->mean = mean[1];
	GW_TRY(gw_neighbours_visit_reach(search, measure, step, error));
	for (int round = 0; round < 3; round++) {
		step->share = from[round];
		step->mean = mean[round];
		GW_TRY(gw_neighbours_visit_reach(search, average, step, error));
	}
	return GW_OK;
}

static float disc_area(const gw_surfels *s, size_t i)
{
	return (float)M_PI * s->radius[i] * s->radius[i];
}

static bool is_solid(const loose_step *step, const float *once, size_t i)
{
	return !(once[i] < SOLID) && !step->alone[i];
}

/* By its mean shares of its neighbours, and of those up to about twice as far. */
static looseness how_loose(const loose_step *step, const float *once, const float *wide, size_t i)
{
	if (once[i] < ON_SURFACE && wide[i] < ON_SURFACE)
		return LOOSE;
	if (is_solid(step, once, i) || !(disc_area(step->surfels, i) > WIDE_EVERYWHERE * step->median))
		return IN_BETWEEN;
	return wide[i] < SOLID ? LOOSE_IF_WIDE : LOOSE_IF_AFLOAT;
}

/*   room   count, for what is solid */
static float solid_median(const gw_surfels *s, const float *once, float *room)
{
	size_t solid = 0;
	for (size_t i = 0; i < s->count; i++)
		if (!(once[i] < SOLID))
			room[solid++] = s->area[i];
	return solid > 0 ? gw_nth_element(room, solid, solid / 2) : INFINITY;
}

/* Gives each point that is not solid its slot. */
static gw_status choose(const float *once, const float *wide, loose_step *step, gw_error *error)
{
	size_t n = step->surfels->count, at = 0;
	for (size_t i = 0; i < n; i++)
		step->slots += !is_solid(step, once, i);
	if (step->slots == 0)
		return GW_OK;
	step->slot = gw_allocate_array(n, sizeof *step->slot);
	step->row = gw_allocate_array(step->slots, GW_NEIGHBOURS * sizeof *step->row);
	step->surfel = gw_allocate_array(step->slots, sizeof *step->surfel);
	step->area = gw_allocate_zeros(step->slots, sizeof *step->area);
	step->loose = gw_allocate_array(step->slots, sizeof *step->loose);
	if (!step->slot || !step->row || !step->surfel || !step->area || !step->loose)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the leaves of %zu points", n);
	for (size_t i = 0; i < n; i++) {
		bool solid = is_solid(step, once, i);
		step->slot[i] = solid ? NO_SLOT : (uint32_t)at;
		if (!solid)
			step->loose[at++] = (uint8_t)how_loose(step, once, wide, i);
	}
	return GW_OK;
}

static bool is_wide_for_neighbours(const gw_surfels *s, size_t surfel,
								   const gw_neighbour_list *list)
{
	uint32_t narrow = 0;
	for (uint32_t j = 0; j < list->count; j++)
		narrow += 2.0f * s->radius[list->index[j]] < s->radius[surfel];
	return narrow >= NARROW_NEIGHBOURS;
}

/* Does a point float in the midst of what is solid?
 *   far   receives whether it is also far from all of that */
static bool is_afloat(const loose_step *step, size_t surfel, const gw_neighbour_list *list,
					  bool *far)
{
	const gw_surfels *s = step->surfels;
	double slab = list->count > 0 ? SLAB * (double)list->distance[list->count - 1] : 0.0;
	uint32_t solid = 0, with_it = 0, near = 0;
	for (uint32_t j = 0; j < list->count; j++) {
		size_t other = list->index[j];
		if (step->slot[other] != NO_SLOT)
			continue;
		with_it += facing_in_slab(s, surfel, other, slab) > (float)GW_SAME_SURFACE;
		near += distance_between(s, surfel, other) < FAR_AFLOAT * (double)s->radius[other];
		solid++;
	}
	*far = near == 0;
	return solid >= SOLID_AROUND && (WITH_IT * with_it < solid || is_off_plane(s, surfel, list));
}

/* How loose a point is, with its neighbours looked at, of which shares told so much. */
static looseness settle(const loose_step *step, size_t surfel, const gw_neighbour_list *list,
						looseness told)
{
	bool far, afloat = is_afloat(step, surfel, list, &far);
	if (told == LOOSE || (afloat && far))
		return LOOSE;
	bool may = told == LOOSE_IF_WIDE || (told == LOOSE_IF_AFLOAT && afloat);
	return may && is_wide_for_neighbours(step->surfels, surfel, list) ? LOOSE_IF_WIDE : IN_BETWEEN;
}

static void keep_row(void *user, size_t surfel, const gw_neighbour_list *list)
{
	const loose_step *step = user;
	uint32_t slot = step->slot[surfel];
	if (slot == NO_SLOT)
		return;
	step->surfel[slot] = (uint32_t)surfel;
	step->loose[slot] = (uint8_t)settle(step, surfel, list, step->loose[slot]);
	for (uint32_t j = 0; j < GW_NEIGHBOURS; j++)
		step->row[GW_NEIGHBOURS * (size_t)slot + j] =
			j < list->count ? list->index[j] : (uint32_t)surfel;
}

/* The mean of what is known among the neighbours, and the most; 0: nothing. */
static stood_for known_around(const loose_step *step, size_t slot)
{
	double sum = 0.0;
	float most = 0.0f;
	uint32_t known = 0;
	for (uint32_t j = 0; j < GW_NEIGHBOURS; j++) {
		uint32_t other = step->row[GW_NEIGHBOURS * slot + j], its = step->slot[other];
		float solid = step->surfels->area[other];
		stood_for area = its == NO_SLOT ? (stood_for){ solid, solid } : step->area[its];
		sum += (double)area.mean;
		most = fmaxf(most, area.most);
		known += area.mean > 0.0f;
	}
	return known > 0 ? (stood_for){ (float)(sum / known), most } : (stood_for){ 0.0f, 0.0f };
}

static void look_around(void *user, size_t first, size_t last, uint32_t worker)
{
	const loose_step *step = user;
	(void)worker;
	for (size_t i = first; i < last; i++)
		step->found[i] = known_around(step, step->open[i]);
}

/* Takes what was found, and keeps open what was not. Returns how many these are. */
static size_t take_found(const loose_step *step, size_t count)
{
	size_t kept = 0;
	for (size_t i = 0; i < count; i++) {
		step->area[step->open[i]] = step->found[i];
		if (!(step->found[i].mean > 0.0f))
			step->open[kept++] = step->open[i];
	}
	return kept;
}

/* Hands areas on from the solid surface, a neighbourhood at a time, so that the order of the points
 * makes no difference. */
static gw_status spread_areas(gw_neighbours *search, loose_step *step, gw_error *error)
{
	size_t left = step->slots;
	step->open = gw_allocate_array(left, sizeof *step->open);
	step->found = gw_allocate_array(left, sizeof *step->found);
	if (!step->open || !step->found)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the leaves of %zu points", left);
	for (size_t i = 0; i < left; i++)
		step->open[i] = (uint32_t)i;
	for (int round = 0; round < STEPS_MOST && left > 0; round++) {
		GW_TRY(gw_neighbours_loop(search, left, look_around, step, error));
		size_t kept = take_found(step, left);
		left = kept < left ? kept : 0;
	}
	return GW_OK;
}

static void bound_discs(const loose_step *step, const uint8_t *fixed, gw_surfels *s)
{
	for (size_t slot = 0; slot < step->slots; slot++) {
		size_t i = step->surfel[slot];
		bool known = step->area[slot].mean > 0.0f;
		float area = known ? step->area[slot].mean : step->median;
		float most = known ? step->area[slot].most : step->median;
		float from = step->loose[slot] == LOOSE_IF_WIDE ? WIDE_NEAR * most : area;
		if (step->loose[slot] == IN_BETWEEN || fixed[i] || gw_surfel_emits(s, i) ||
			!(disc_area(s, i) > from))
			continue;
		/* Wide ones may be of sparse surface all the same: discs of even points close that. */
		float keep = step->loose[slot] == LOOSE_IF_WIDE ? (float)GW_DISC_RANK * area : area;
		s->radius[i] = fmaxf(sqrtf(keep / (float)M_PI), FLT_MIN);
		s->area[i] = fminf(s->area[i], area);
	}
}

gw_status gw_loose_points_bound(gw_neighbours *search, const uint8_t *fixed, gw_surfels *surfels,
								gw_error *error)
{
	loose_step step = { .surfels = surfels };
	size_t n = surfels->count;
	float *mean[3] = { gw_allocate_array(n, sizeof(float)), gw_allocate_array(n, sizeof(float)),
					   gw_allocate_array(n, sizeof(float)) };
	gw_status status = GW_OK;
	step.alone = gw_allocate_array(n, sizeof *step.alone);
	if (!mean[0] || !mean[1] || !mean[2] || !step.alone)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory for the leaves of %zu points", n);
	if (status == GW_OK)
		status = measure_shares(search, &step, mean, error);
	if (status == GW_OK) {
		step.median = solid_median(surfels, mean[0], mean[1]);
		status = choose(mean[0], mean[2], &step, error);
	}
	if (status == GW_OK && step.slots > 0)
		status = gw_neighbours_visit_reach(search, keep_row, &step, error);
	if (status == GW_OK && step.slots > 0)
		status = spread_areas(search, &step, error);
	if (status == GW_OK && step.slots > 0)
		bound_discs(&step, fixed, surfels);
	for (int k = 0; k < 3; k++)
		free(mean[k]);
	free(step.alone);
	free(step.slot);
	free(step.row);
	free(step.surfel);
	free(step.area);
	free(step.loose);
	free(step.open);
	free(step.found);
	return status;
}

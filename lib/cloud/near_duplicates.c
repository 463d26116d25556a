/* near_duplicates.c - see near_duplicates.h. */
#include "cloud/near_duplicates.h"

#include "base/memory.h"
#include "base/nth_element.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Steps from surfel to surfel, in their order, that are held against so many. */
#define STEPS 16u

/* A step is short below this part of the others; of random points four in a hundred are at most. */
#define SHORT 0.1f

/* Such a share of all steps is, where there are many near duplicates. */
#define MANY 0.06

/* Near duplicates are nearer to each other than this part of the distance to a neighbour of that
 * rank, of which pairs leave three other places. */
#define NEAR 0.1f
#define RANK 8u

#define NO_PARTNER UINT32_MAX

typedef struct join_step {
	const gw_surfels *surfels;
	float near;        /* of the distance to the neighbour of RANK */
	uint32_t *partner; /* count: the nearest, if it is as near as that, or NO_PARTNER */
} join_step;

static float step_length(const gw_surfels *s, size_t i)
{
	double square = 0.0;
	for (size_t k = 0; k < 3; k++) {
		double d = (double)s->position[3 * i + 3 + k] - (double)s->position[3 * i + k];
		square += d * d;
	}
	return (float)sqrt(square);
}

bool gw_near_duplicates_are_many(const gw_surfels *surfels)
{
	size_t steps = 0, few = 0;
	for (size_t first = 0; first + STEPS < surfels->count; first += STEPS) {
		float step[STEPS];
		for (size_t i = 0; i < STEPS; i++)
			step[i] = step_length(surfels, first + i);
		/* Near duplicates are half of the steps at most: three quarters up, it is one between
		 * others. */
		float usual = gw_nth_element(step, STEPS, 3 * STEPS / 4);
		for (size_t i = 0; i < STEPS; i++)
			few += step[i] < SHORT * usual;
		steps += STEPS;
	}
	return (double)few > MANY * (double)steps;
}

static bool emits(const gw_surfels *s, size_t i)
{
	const float *e = s->emission ? s->emission + 3 * i : NULL;
	return e && (e[0] > 0.0f || e[1] > 0.0f || e[2] > 0.0f);
}

/* Normals that are missing are 0, 0, 0. */
static bool faces_as(const gw_surfels *s, size_t i, size_t j)
{
	const float *n = s->normal + 3 * i, *m = s->normal + 3 * j;
	bool known = n[0] != 0.0f || n[1] != 0.0f || n[2] != 0.0f;
	bool other = m[0] != 0.0f || m[1] != 0.0f || m[2] != 0.0f;
	return !known || !other || n[0] * m[0] + n[1] * m[1] + n[2] * m[2] > 0.5f;
}

static void find_partner(void *user, size_t surfel, const gw_neighbour_list *list)
{
	const join_step *step = user;
	step->partner[surfel] = NO_PARTNER;
	if (list->count < RANK || emits(step->surfels, surfel))
		return;
	size_t other = list->index[0];
	if (list->distance[0] < step->near * list->distance[RANK - 1] && !emits(step->surfels, other) &&
		faces_as(step->surfels, surfel, other))
		step->partner[surfel] = (uint32_t)other;
}

/* Where surfels are now that are each other's partners; the others stay. */
static size_t join(const join_step *step, double *place)
{
	const gw_surfels *s = step->surfels;
	size_t moved = 0;
	for (size_t i = 0; i < s->count; i++) {
		size_t other = step->partner[i];
		if (other == NO_PARTNER || other < i || step->partner[other] != i)
			continue;
		for (size_t k = 0; k < 3; k++) {
			double a = (double)s->position[3 * i + k], b = (double)s->position[3 * other + k];
			place[3 * i + k] = place[3 * other + k] = s->origin[k] + 0.5 * (a + b);
		}
		moved += 2;
	}
	return moved;
}

gw_status gw_near_duplicates_join(const gw_surfels *surfels, gw_neighbours *search,
								  gw_near_duplicates_kind kind, double *position, size_t *moved,
								  gw_error *error)
{
	join_step step = { .surfels = surfels, .near = kind == GW_NEAREST_PAIRS ? INFINITY : NEAR };
	*moved = 0;
	step.partner = gw_allocate_array(surfels->count, sizeof *step.partner);
	double *place = gw_allocate_array(surfels->count, 3 * sizeof *place);
	gw_status status = GW_OK;
	if (!step.partner || !place)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory for the near duplicates of %zu points",
						 surfels->count);
	if (status == GW_OK)
		status = gw_neighbours_visit(search, find_partner, &step, error);
	for (size_t i = 0; i < surfels->count && status == GW_OK; i++)
		place[3 * i] = NAN;
	if (status == GW_OK)
		*moved = join(&step, place);
	for (size_t i = 0; *moved > 0 && i < surfels->point_count; i++) {
		uint32_t surfel = surfels->surfel_of_point[i];
		if (surfel != UINT32_MAX && !isnan(place[3 * (size_t)surfel]))
			memcpy(position + 3 * i, place + 3 * (size_t)surfel, 3 * sizeof *position);
	}
	free(place);
	free(step.partner);
	return status;
}

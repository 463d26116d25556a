/* filled_space.c - see filled_space.h. */
#include "surfels/filled_space.h"

#include "base/memory.h"
#include "surfels/surfel_plane.h"

#include <math.h>
#include <stdlib.h>

/*
 * From this thickness on, see there, as the mean over a point and its neighbours, they fill space:
 * nine of ten random points that do, three of a thousand on a plane with noise of half a spacing,
 * and none on a plane or a cube with noise of a third (measured).
 */
#define FILLED 0.15f

/* Where those that face the same way lie in a plane all the same, there is a surface and others
 * near it: so far they may be from it, RMS, of the distance to the furthest neighbour. */
#define IN_PLANE 0.06

/* The disc's radius, of the distance to this neighbour. */
#define RADIUS 0.5f
#define RANK 3

typedef struct filled_step {
	const gw_surfels *surfels;
	float *thickness; /* count */
	uint8_t *filled;
} filled_step;

/* Sums of squares and products of the neighbours' offsets from their middle, the surfel's too. */
static void measure_spread(const gw_surfels *s, size_t surfel, const gw_neighbour_list *list,
						   double c[3][3])
{
	double sum[3] = { 0 }, d[3], n = list->count + 1.0;
	for (uint32_t j = 0; j < list->count; j++) {
		for (size_t k = 0; k < 3; k++) {
			d[k] = (double)s->position[3 * (size_t)list->index[j] + k] -
				   (double)s->position[3 * surfel + k];
			sum[k] += d[k];
		}
		for (int r = 0; r < 3; r++)
			for (int k = 0; k < 3; k++)
				c[r][k] += d[r] * d[k];
	}
	for (int r = 0; r < 3; r++)
		for (int k = 0; k < 3; k++)
			c[r][k] -= sum[r] * sum[k] / n;
}

/*
 * The least share that a direction has in the squares of the neighbours' distances from their
 * middle: 0 where they lie in a plane, a third where they fill a ball. It is the least eigenvalue
 * of their covariance, from the cosine of a third of an angle.
 */
static double thickness(const gw_surfels *s, size_t surfel, const gw_neighbour_list *list)
{
	double c[3][3] = { { 0 } }, squares = 0, determinant = 0;
	measure_spread(s, surfel, list, c);
	double mean = (c[0][0] + c[1][1] + c[2][2]) / 3;
	if (!(mean > 0))
		return 0;
	for (int r = 0; r < 3; r++) {
		for (int k = 0; k < 3; k++)
			c[r][k] /= mean;
		c[r][r] -= 1;
	}
	for (int r = 0; r < 3; r++)
		for (int k = 0; k < 3; k++)
			squares += c[r][k] * c[r][k];
	double size = sqrt(squares / 6);
	if (!(size > 1e-9))
		return 1.0 / 3;
	for (int k = 0; k < 3; k++)
		determinant += c[0][k] * (c[1][(k + 1) % 3] * c[2][(k + 2) % 3] -
								  c[1][(k + 2) % 3] * c[2][(k + 1) % 3]);
	double angle = acos(fmin(fmax(determinant / (2 * size * size * size), -1), 1)) / 3;
	return fmax(1 + 2 * size * cos(angle + 2 * M_PI / 3), 0) / 3;
}

static void measure(void *user, size_t surfel, const gw_neighbour_list *list)
{
	const filled_step *step = user;
	step->thickness[surfel] =
		list->count == GW_NEIGHBOURS ? (float)thickness(step->surfels, surfel, list) : 0;
}

static bool lies_in_plane(const gw_surfels *s, size_t surfel, const gw_neighbour_list *list)
{
	gw_flat_point kept[GW_NEIGHBOURS];
	double noise, sum = 0, squares = 0, reach = (double)list->distance[list->count - 1];
	uint32_t count = gw_plane_surface(s, surfel, list, kept, &noise);
	for (uint32_t j = 0; j < count; j++) {
		sum += kept[j].height;
		squares += kept[j].height * kept[j].height;
	}
	double n = count + 1.0; /* the surfel is one of them */
	return count >= 3 && squares / n - sum * sum / (n * n) < IN_PLANE * IN_PLANE * reach * reach;
}

static void judge(void *user, size_t surfel, const gw_neighbour_list *list)
{
	const filled_step *step = user;
	float sum = step->thickness[surfel];
	for (uint32_t j = 0; j < list->count; j++)
		sum += step->thickness[list->index[j]];
	step->filled[surfel] = list->count == GW_NEIGHBOURS &&
						   sum > FILLED * (float)(list->count + 1) &&
						   !lies_in_plane(step->surfels, surfel, list);
}

gw_status gw_filled_space_find(gw_neighbours *search, const gw_surfels *surfels, uint8_t **filled,
							   gw_error *error)
{
	filled_step step = { .surfels = surfels };
	step.thickness = gw_allocate_array(surfels->count, sizeof *step.thickness);
	step.filled = *filled = gw_allocate_zeros(surfels->count, 1);
	gw_status status = GW_OK;
	if (!step.thickness || !step.filled)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory for the extent of %zu points",
						 surfels->count);
	if (status == GW_OK)
		status = gw_neighbours_visit(search, measure, &step, error);
	if (status == GW_OK)
		status = gw_neighbours_visit(search, judge, &step, error);
	free(step.thickness);
	if (status != GW_OK) {
		free(*filled);
		*filled = NULL;
	}
	return status;
}

float gw_filled_space_radius(const gw_neighbour_list *list)
{
	uint32_t rank = list->count < RANK ? list->count : RANK;
	return rank > 0 ? RADIUS * list->distance[rank - 1] : 0;
}

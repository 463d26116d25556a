/* filled_space.c - see filled_space.h. */
#include "surfels/filled_space.h"

#include "base/memory.h"
#include "normals/normals.h"
#include "surfels/beam_area.h"
#include "surfels/surfel_plane.h"

#include <math.h>
#include <stdlib.h>

/*
 * From this thickness on, see there, as the mean over a point and its neighbours, they fill space:
 * nine of ten random points that do, three of a thousand on a plane with noise of half a spacing,
 * and none on a plane or a cube with noise of a third (measured).
 */
#define FILLED 0.15f

/* The same of points behind most of which a beam went on: that happens to few on surfaces. */
#define SPLIT 0.05f

/* Where those that face the same way lie in a plane all the same, there is a surface and others
 * near it: so far they may be from it, RMS, of the distance to the furthest neighbour. */
#define IN_PLANE 0.06

/* The disc's radius, of the distance to this neighbour. */
#define RADIUS 0.5f
#define RANK 3

/* Foliage has more neighbours that fill space, too, than this share of them. */
#define FOLIAGE 0.9f

/* A disc of random direction shows half of its area, a thing as much from everywhere; but the
 * discs of most face the scanner or lie as their thing does. */
#define TURNED 1.5
#define AT_RANDOM 2.0

typedef struct filled_step {
	const gw_surfels *surfels;
	float *thickness;   /* count */
	const float *share; /* count or NULL, of the beams that stopped */
	const float *own;   /* count or NULL, what things cover */
	uint8_t *filled, *foliage;
} filled_step;

/* Sums of squares and products of the neighbours' offsets from their middle, the place's too. */
static void measure_spread(const gw_surfels *s, const double place[3],
						   const gw_neighbour_list *list, double c[3][3])
{
	double x = 0, y = 0, z = 0, xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
	double n = list->count + 1.0;
	for (uint32_t j = 0; j < list->count; j++) {
		const float *to = s->position + 3 * (size_t)list->index[j];
		double a = (double)to[0] - place[0];
		double b = (double)to[1] - place[1];
		double d = (double)to[2] - place[2];
		x += a;
		y += b;
		z += d;
		xx += a * a;
		xy += a * b;
		xz += a * d;
		yy += b * b;
		yz += b * d;
		zz += d * d;
	}
	c[0][0] = xx - x * x / n;
	c[1][1] = yy - y * y / n;
	c[2][2] = zz - z * z / n;
	c[0][1] = c[1][0] = xy - x * y / n;
	c[0][2] = c[2][0] = xz - x * z / n;
	c[1][2] = c[2][1] = yz - y * z / n;
}

/* The least eigenvalue of their covariance, from the cosine of a third of an angle. */
double gw_filled_space_thickness(const gw_surfels *s, const double place[3],
								 const gw_neighbour_list *list)
{
	double c[3][3], squares = 0, determinant = 0;
	measure_spread(s, place, list, c);
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
	const float *p = step->surfels->position + 3 * surfel;
	const double place[3] = { (double)p[0], (double)p[1], (double)p[2] };
	bool full = list->count == GW_NEIGHBOURS;
	step->thickness[surfel] =
		full ? (float)gw_filled_space_thickness(step->surfels, place, list) : 0.0f;
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

/* Beams went on behind most of those around, and these lie in no plane. */
static void judge_beams(void *user, size_t surfel, const gw_neighbour_list *list)
{
	const filled_step *step = user;
	uint32_t split = step->share[surfel] < 1.0f;
	float sum = step->thickness[surfel];
	for (uint32_t j = 0; j < list->count; j++) {
		split += step->share[list->index[j]] < 1.0f;
		sum += step->thickness[list->index[j]];
	}
	if (list->count == GW_NEIGHBOURS && 2 * split > list->count + 1 &&
		sum > SPLIT * (float)(list->count + 1))
		step->filled[surfel] = step->foliage[surfel] = 1;
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

/* Noise of a surface may look like a filled space here and there. */
static void judge_around(void *user, size_t surfel, const gw_neighbour_list *list)
{
	const filled_step *step = user;
	uint32_t filled = 0;
	for (uint32_t j = 0; j < list->count; j++)
		filled += step->filled[list->index[j]];
	step->foliage[surfel] |= step->filled[surfel] && (float)filled > FOLIAGE * (float)list->count;
}

/* A thing that has them as a quarter of its neighbours is one of them, at their rim or where they
 * lie in a plane by chance. Marked by another bit: those beside it look at the first. */
static void judge_beside(void *user, size_t surfel, const gw_neighbour_list *list)
{
	const filled_step *step = user;
	uint32_t foliage = 0;
	for (uint32_t j = 0; j < list->count; j++)
		foliage += step->foliage[list->index[j]] & 1u;
	if (step->own[surfel] > 0.0f && 4 * foliage > list->count)
		step->foliage[surfel] |= 2u;
}

/* What each surfel is by itself, if it is a thing. */
typedef struct thing_step {
	const float *own;        /* count, m^2, seen from the scanner; 0: none */
	const uint32_t *scanner; /* count */
	float *area;             /* count, receives the disc's */
} thing_step;

/*
 * Each scanner that sees a thing has it covered by its own points. So where several do, each point
 * stands for less: densities of points, one over what each covers, add up.
 */
static void share_thing(void *user, size_t surfel, const gw_neighbour_list *list)
{
	const thing_step *step = user;
	uint32_t seen[GW_NEIGHBOURS + 1], count = 1;
	step->area[surfel] = 0.0f;
	if (!(step->own[surfel] > 0.0f))
		return;
	double density = 1.0 / (double)step->own[surfel];
	seen[0] = step->scanner[surfel];
	for (uint32_t j = 0; j < list->count; j++) {
		size_t other = list->index[j];
		uint32_t k = 0;
		while (k < count && seen[k] != step->scanner[other])
			k++;
		if (k < count || !(step->own[other] > 0.0f))
			continue;
		seen[count++] = step->scanner[other];
		density += 1.0 / (double)step->own[other];
	}
	step->area[surfel] = (float)(TURNED / density);
}

/* Fills lone->area, and marks its surfels. */
static gw_status find_things(const gw_points *points, gw_neighbours *search,
							 const gw_surfels *surfels, gw_lone_points *lone, gw_error *error)
{
	size_t n = surfels->count;
	float *own = gw_allocate_zeros(n, sizeof *own);
	uint32_t *scanner = gw_allocate_zeros(n, sizeof *scanner);
	gw_status status = GW_OK;
	lone->area = gw_allocate_array(n, sizeof *lone->area);
	if (!own || !scanner || !lone->area)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory for the thin things of %zu points", n);
	for (size_t i = 0; i < surfels->point_count && status == GW_OK; i++) {
		uint32_t surfel = surfels->surfel_of_point[i];
		if (surfel == UINT32_MAX || !(points->own_area[i] > own[surfel]))
			continue;
		own[surfel] = points->own_area[i];
		scanner[surfel] = points->scanner_of ? points->scanner_of[i] : 0;
	}
	thing_step step = { own, scanner, lone->area };
	if (status == GW_OK)
		status = gw_neighbours_visit_reach(search, share_thing, &step, error);
	filled_step beside = { .own = own, .foliage = lone->foliage };
	if (status == GW_OK)
		status = gw_neighbours_visit_reach(search, judge_beside, &beside, error);
	for (size_t i = 0; i < n && status == GW_OK; i++) {
		lone->filled[i] |= lone->area[i] > 0.0f;
		lone->area[i] *= lone->foliage[i] ? (float)(AT_RANDOM / TURNED) : 1.0f;
	}
	free(own);
	free(scanner);
	return status;
}

/* Finds more of them, and what each covers: half of their area shows from everywhere. */
static gw_status look_at_beams(const gw_points *points, gw_neighbours *search, filled_step *step,
							   gw_lone_points *lone, gw_error *error)
{
	size_t n = step->surfels->count;
	float *share = gw_allocate_array(n, sizeof *share);
	lone->area = gw_allocate_array(n, sizeof *lone->area);
	gw_status status = GW_OK;
	if (!share || !lone->area)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory for the beams of %zu points", n);
	if (status == GW_OK)
		status = gw_beam_areas(points, step->surfels, share, lone->area, error);
	step->share = share;
	if (status == GW_OK)
		status = gw_neighbours_visit_reach(search, judge_beams, step, error);
	for (size_t i = 0; i < n && status == GW_OK; i++)
		lone->area[i] = lone->filled[i] ? 2.0f * lone->area[i] : 0.0f;
	free(share);
	return status;
}

void gw_lone_points_clear(gw_lone_points *lone)
{
	free(lone->filled);
	free(lone->foliage);
	free(lone->area);
	*lone = (gw_lone_points){ 0 };
}

gw_status gw_filled_space_find(const gw_points *points, gw_neighbours *search,
							   const gw_surfels *surfels, gw_lone_points *lone, gw_error *error)
{
	filled_step step = { .surfels = surfels };
	*lone = (gw_lone_points){ .sides_known = gw_normals_face_scanner(points) };
	step.thickness = gw_allocate_array(surfels->count, sizeof *step.thickness);
	step.filled = lone->filled = gw_allocate_zeros(surfels->count, 1);
	step.foliage = lone->foliage = gw_allocate_zeros(surfels->count, 1);
	gw_status status = GW_OK;
	if (!step.thickness || !step.filled || !step.foliage)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory for the extent of %zu points",
						 surfels->count);
	if (status == GW_OK)
		status = gw_neighbours_visit_reach(search, measure, &step, error);
	if (status == GW_OK)
		status = gw_neighbours_visit_reach(search, judge, &step, error);
	if (status == GW_OK && points->beam_share && !points->own_area)
		status = look_at_beams(points, search, &step, lone, error);
	free(step.thickness);
	if (status == GW_OK)
		status = gw_neighbours_visit_reach(search, judge_around, &step, error);
	if (status == GW_OK && points->own_area)
		status = find_things(points, search, surfels, lone, error);
	if (status != GW_OK)
		gw_lone_points_clear(lone);
	return status;
}

float gw_filled_space_radius(const gw_neighbour_list *list)
{
	uint32_t rank = list->count < RANK ? list->count : RANK;
	return rank > 0 ? RADIUS * list->distance[rank - 1] : 0;
}

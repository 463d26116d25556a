/* normals.c - normals for points that come without; see normal_orientation.h. */
#include "normals/normals.h"

#include "base/memory.h"
#include "base/up_axis.h"
#include "normals/nearest_plane.h"
#include "normals/normal_orientation.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* |cos| between a normal and the way it is oriented to: at most UNTRUSTED is a guess; above SURE
 * no vote of the neighbours changes it. */
#define UNTRUSTED_COSINE 0.1f
#define SURE_COSINE 0.3f

/* Share of the smallest eigenvalue above which neighbours form no plane. Gaussian noise of half a
 * spacing gives 0.09, three walls that meet in a corner 0.2. */
#define CURVATURE_MAX 0.15f

/* Eigenvalues in the plane: below this ratio the neighbours lie on a line. */
#define LINE_RATIO 1e-4

/*
 * Among leaves and wires the neighbours lie on several, and the nearest few of them on one. There
 * these leave less than this share of what all leave, on the average of all neighbours' planes, and
 * all leave more than SEVERAL. Noise of half a spacing on a plane gives 0.74, leaves of six points
 * 0.2 and tubes 0.16 (measured).
 */
#define FEW_SHARE 0.5f
#define SEVERAL 0.04f
/* So wide, in the width that a point covers by itself, may these lie apart: others are of other
 * leaves. */
#define FEW_APART 3.0f

#define VOTES 2

/* A surface seen edge-on is trusted where so much of the vote agrees, of at least so much weight:
 * noise of the normals that could turn it would have turned some of the neighbours. */
#define AGREEMENT_SURE 0.9f
#define AGREEMENT_LEAST 8.0f

/* Where planes in which nearer neighbours count more leave less than this of what those of all
 * alike leave, on the average of a neighbourhood, surface bends there more than it is noisy. They
 * leave as much on a noisy plane. Of caves and rooms with noise and without, bent surface is nearer
 * by them below this, flat surface further off above it (measured). */
#define NEAR_SHARE 0.8f

/* A neighbour's plane is taken when it leaves less than this of what the own plane leaves: noise
 * alone, whose squares over 14 degrees of freedom vary by 0.38, rarely does. With twice this, rough
 * rock takes planes of one flank on its ridges; with half of it, noisy creases are planed off
 * (measured). */
#define BETTER_PLANE 0.08f
#define PLANE_ROUNDS 2

/* Neighbours are a strip when their lesser extent in their plane has this share of the greater
 * one's square: across a line such as one of a scanner's, noise makes one that stands on the
 * surface, and leaves nothing of it. Such a plane is nobody else's, and is given up for one of a
 * neighbour's that leaves less than this. */
#define STRIP_RATIO 0.15
#define STRIP_PLANE 0.02f

/* |cos| between an axis and the estimated normal, below which it has no side that could be told. */
#define AXIS_COSINE 0.5f

/* What is known of one estimated normal. */
enum {
	GIVEN = 0, /* nothing was estimated */
	ESTIMATED = 1,
	UNSURE = 2,    /* orientation may be changed by a vote */
	UNTRUSTED = 4, /* lit from both sides */
	NEGATIVE = 8,  /* the vote's result: points the other way */
	EDGE_ON = 16,  /* untrusted unless the neighbours agree */
	UNCLEAR = 32,  /* nobody knows which side is the front */
	OF_FEW = 64,   /* the plane of the nearest few is the better one */
	STRIP = 128,   /* of a strip of neighbours, which noise may have made of a line */
};

typedef struct normal_step {
	gw_surfels *surfels;
	gw_neighbours *search;
	double *scanner; /* 3 * scanner_count, local */
	size_t scanner_count;
	uint32_t *scanner_of; /* count, the one that saw each surfel, scanner_count or more where nobody
							 knows, or NULL: there is but one */
	uint8_t *state;       /* count, bits as above */
	uint8_t *next;        /* count, state after the vote */
	float *plane;         /* 4 * count: normal, and what of its neighbours' spread it leaves */
	float *better;        /* 4 * count, planes after a round of choosing */
	float *near;          /* 4 * count, planes in which the nearer count more, as `plane` */
	float *thin;          /* count, m^2: own_area of leaves and wires, else 0; NULL: nobody knows */
	float *few;           /* 4 * count or NULL, planes of the nearest few, as `plane` where even */
} normal_step;

/* Points that became one surfel may have been seen by several scanners: the first one counts. */
static bool assign_scanners(normal_step *step, const gw_points *points)
{
	const gw_surfels *s = step->surfels;
	if (points->scanner_count < 2)
		return true;
	step->scanner_of = gw_allocate_array(s->count, sizeof *step->scanner_of);
	if (!step->scanner_of)
		return false;
	memset(step->scanner_of, 0xff, s->count * sizeof *step->scanner_of);
	for (size_t i = 0; points->scanner_of && i < s->point_count; i++) {
		uint32_t surfel = s->surfel_of_point[i];
		if (surfel != UINT32_MAX && points->scanner_of[i] < step->scanner_of[surfel])
			step->scanner_of[surfel] = points->scanner_of[i];
	}
	return true;
}

/* Targets keep their numbers, so that one bad position makes all of them unknown. */
static bool are_places(const gw_points *points)
{
	for (size_t k = 0; k < 3 * points->scanner_count; k++)
		if (!isfinite(points->scanner[k]))
			return false;
	return points->scanner_count > 0;
}

bool gw_normals_face_scanner(const gw_points *points)
{
	return are_places(points) && (points->scanner_count == 1 || points->scanner_of);
}

static bool find_scanners(normal_step *step, const gw_points *points)
{
	if (!are_places(points))
		return true;
	step->scanner = gw_allocate_array(points->scanner_count, 3 * sizeof *step->scanner);
	if (!step->scanner)
		return false;
	step->scanner_count = points->scanner_count;
	for (size_t k = 0; k < 3 * points->scanner_count; k++)
		step->scanner[k] = points->scanner[k] - step->surfels->origin[k % 3];
	return assign_scanners(step, points);
}

/* Unit vector to the scanner that saw a surfel; upwards when there is none. */
static void way_to_scanner(const normal_step *step, size_t surfel, double way[3])
{
	const float *p = step->surfels->position + 3 * surfel;
	double best = INFINITY, up[3];
	gw_up_axis(step->surfels->up, up);
	memcpy(way, up, sizeof up);
	size_t own = step->scanner_of ? step->scanner_of[surfel] : step->scanner_count;
	bool known = own < step->scanner_count;
	for (size_t i = known ? own : 0; i < (known ? own + 1 : step->scanner_count); i++) {
		double d[3], squared = 0;
		for (size_t k = 0; k < 3; k++) {
			d[k] = step->scanner[3 * i + k] - (double)p[k];
			squared += d[k] * d[k];
		}
		if (squared < best) {
			best = squared;
			memcpy(way, d, sizeof d);
		}
	}
	double length = sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]);
	if (!(length > 0) || !isfinite(length)) {
		memcpy(way, up, sizeof up);
		length = 1;
	}
	for (int k = 0; k < 3; k++)
		way[k] /= length;
}

/* Where there is no plane: the way to the scanner, made perpendicular to the line on which the
 * neighbours lie, if they lie on one. */
static void fallback_normal(const float *point, size_t count, const double way[3], float normal[3])
{
	double axis[3] = { 0, 0, 0 }, length = 0, n[3], n_length = 0, along = 0;
	if (count > 1) { /* the furthest neighbour is last and at distance 1 */
		for (size_t k = 0; k < 3; k++) {
			axis[k] = (double)point[3 * (count - 1) + k];
			length += axis[k] * axis[k];
		}
	}
	for (int k = 0; k < 3; k++)
		along += length > 0 ? way[k] * axis[k] / length : 0;
	for (int k = 0; k < 3; k++) {
		n[k] = way[k] - along * axis[k];
		n_length += n[k] * n[k];
	}
	if (n_length < 1e-6) { /* the line points there: any perpendicular */
		float along_axis[3] = { (float)way[0], (float)way[1], (float)way[2] }, bitangent[3];
		gw_tangent_frame(along_axis, normal, bitangent);
		return;
	}
	for (int k = 0; k < 3; k++)
		normal[k] = (float)(n[k] / sqrt(n_length));
}

/* The plane through some points, if they span one; least: as gw_plane_is_spanned has it. */
static bool fit_plane(normal_step *step, const float *point, size_t count, double least,
					  float plane[4])
{
	gw_plane found = gw_plane_normal(point, count, plane, plane + 3);
	if (found == GW_PLANE_NO_MEMORY)
		gw_neighbours_run_short(step->search);
	return found == GW_PLANE_FOUND && gw_plane_is_spanned(point, count, plane, least);
}

/* The plane of the nearest few, if they are no further apart. */
static void fit_few(normal_step *step, const float *point, size_t count, float apart,
					float plane[4])
{
	if (gw_nearest_plane(point, count, apart, plane) == GW_PLANE_NO_MEMORY)
		gw_neighbours_run_short(step->search);
}

/* What points spread about their mean, along three axes together. */
static double spread_of(const float *point, size_t count)
{
	double sum[3] = { 0, 0, 0 }, squares = 0, n = (double)count;
	for (size_t i = 0; i < 3 * count; i++) {
		sum[i % 3] += (double)point[i];
		squares += (double)point[i] * (double)point[i];
	}
	return squares / n - (sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]) / (n * n);
}

/* The plane in which nearer neighbours count more; that of all alike where there is none. Not for
 * neighbours in rows: the nearest are of one row then, and noise turns a plane about it. */
static void fit_near(const normal_step *step, size_t surfel, const gw_neighbour_list *list,
					 const float *point)
{
	const float *plane = step->plane + 4 * surfel;
	float *near = step->near + 4 * surfel;
	size_t count = list->count + 1u;
	double spread = spread_of(point, count);
	bool even = !list->in_rows && plane[3] < INFINITY && spread > 0;
	if (!even || !gw_plane_by_nearness(point, count, spread, near))
		memcpy(near, plane, 4 * sizeof *near);
}

static void estimate_normal(void *user, size_t surfel, const gw_neighbour_list *list)
{
	normal_step *step = user;
	const float *normal = step->surfels->normal + 3 * surfel;
	float point[3 * (GW_NEIGHBOURS + 1)], *plane = step->plane + 4 * surfel;
	double way[3];
	memcpy(plane, normal, 3 * sizeof *plane);
	plane[3] = INFINITY;
	memcpy(step->near + 4 * surfel, plane, 4 * sizeof *plane);
	if (normal[0] != 0 || normal[1] != 0 || normal[2] != 0)
		return;
	size_t count = gw_places_around(step->surfels, surfel, list, point);
	step->state[surfel] = ESTIMATED;
	if (!fit_plane(step, point, count, LINE_RATIO, plane)) {
		way_to_scanner(step, surfel, way);
		fallback_normal(point, count, way, plane);
		plane[3] = INFINITY;
		step->state[surfel] |= UNTRUSTED;
	}
	if (list->in_rows && !gw_plane_is_spanned(point, count, plane, STRIP_RATIO))
		step->state[surfel] |= STRIP;
	fit_near(step, surfel, list, point);
	if (step->few && step->thin[surfel] > 0 && plane[3] > GW_PLANE_UNEVEN && plane[3] < INFINITY) {
		float apart = FEW_APART * sqrtf(step->thin[surfel]) / list->distance[list->count - 1];
		fit_few(step, point, count, apart, step->few + 4 * surfel);
	}
}

static void take_better(normal_step *step)
{
	float *swap = step->plane;
	step->plane = step->better;
	step->better = swap;
}

/* Which of both planes is the surfel's own, by those of its neighbours too. */
static void judge_near(void *user, size_t surfel, const gw_neighbour_list *list)
{
	normal_step *step = user;
	float of_near = 0, of_all = 0;
	for (uint32_t j = 0; j <= list->count; j++) {
		size_t other = j < list->count ? list->index[j] : surfel;
		if (step->plane[4 * other + 3] < INFINITY) {
			of_near += step->near[4 * other + 3];
			of_all += step->plane[4 * other + 3];
		}
	}
	const float *own = of_near < NEAR_SHARE * of_all ? step->near : step->plane;
	memcpy(step->better + 4 * surfel, own + 4 * surfel, 4 * sizeof *own);
}

/* Planes in which nearer neighbours count more, where these are better. */
static gw_status take_near(normal_step *step, gw_error *error)
{
	GW_TRY(gw_neighbours_visit_reach(step->search, judge_near, step, error));
	take_better(step);
	return GW_OK;
}

/* Whether the neighbours of a surfel show that they lie on several surfaces, and few on one. Where
 * most are no thin things, it is of the edge of a wall. */
static void judge_few(void *user, size_t surfel, const gw_neighbour_list *list)
{
	normal_step *step = user;
	float of_few = 0, of_all = 0, planes = 0;
	uint32_t thin = 0;
	if (!(step->few[4 * surfel + 3] < step->plane[4 * surfel + 3]))
		return;
	for (uint32_t j = 0; j <= list->count; j++) {
		size_t other = j < list->count ? list->index[j] : surfel;
		float all = step->plane[4 * other + 3];
		thin += step->thin[other] > 0;
		if (all < INFINITY) {
			of_few += fminf(step->few[4 * other + 3], all);
			of_all += all;
			planes++;
		}
	}
	if (2 * thin > list->count && of_all > SEVERAL * planes && of_few < FEW_SHARE * of_all)
		step->state[surfel] |= OF_FEW;
}

/* Hardly a beam meets what lies along it: such a plane is none of a thing's. */
static bool is_seen(const normal_step *step, size_t surfel)
{
	const float *few = step->few + 4 * surfel;
	double way[3], cosine = 0;
	if (!step->scanner_count)
		return true;
	way_to_scanner(step, surfel, way);
	for (int k = 0; k < 3; k++)
		cosine += way[k] * (double)few[k];
	return fabs(cosine) > (double)UNTRUSTED_COSINE;
}

/* Takes the planes of few where they are better. */
static gw_status take_few(normal_step *step, gw_error *error)
{
	if (!step->few)
		return GW_OK;
	GW_TRY(gw_neighbours_visit_reach(step->search, judge_few, step, error));
	for (size_t i = 0; i < step->surfels->count; i++)
		if (step->state[i] & OF_FEW && is_seen(step, i)) {
			memcpy(step->plane + 4 * i, step->few + 4 * i, 4 * sizeof *step->few);
			memcpy(step->near + 4 * i, step->few + 4 * i, 4 * sizeof *step->few);
		}
	return GW_OK;
}

/* Which surfels are thin things, where rows and columns of the scan tell. */
static bool find_thin(normal_step *step, const gw_points *points)
{
	const gw_surfels *s = step->surfels;
	if (!points->own_area)
		return true;
	step->thin = gw_allocate_zeros(s->count, sizeof *step->thin);
	step->few = gw_allocate_array(s->count, 4 * sizeof *step->few);
	for (size_t i = 0; step->thin && i < s->point_count; i++) {
		uint32_t surfel = s->surfel_of_point[i];
		if (surfel != UINT32_MAX)
			step->thin[surfel] = fmaxf(step->thin[surfel], points->own_area[i]);
	}
	for (size_t i = 0; step->few && i < s->count; i++)
		step->few[4 * i + 3] = INFINITY;
	return step->thin && step->few;
}

/*
 * Near a crease the neighbours lie on both of its faces, and the plane through them on neither.
 * Such a surfel takes the plane of a neighbour that knows one face alone, if it lies on that one,
 * too: its own height above it counts like the spread of the neighbour's points, both squared and
 * in units of the reach.
 */
static void choose_plane(void *user, size_t surfel, const gw_neighbour_list *list)
{
	normal_step *step = user;
	const float *p = step->surfels->position + 3 * surfel, *own = step->plane + 4 * surfel;
	float *better = step->better + 4 * surfel;
	memcpy(better, own, 4 * sizeof *better);
	if (!(step->state[surfel] & ESTIMATED) || step->state[surfel] & UNTRUSTED)
		return;
	float reach = list->distance[list->count - 1];
	float least = step->state[surfel] & STRIP ? STRIP_PLANE : BETTER_PLANE * own[3];
	for (uint32_t j = 0; j < list->count; j++) {
		if (step->state[list->index[j]] & STRIP)
			continue;
		const float *q = step->surfels->position + 3 * (size_t)list->index[j];
		const float *plane = step->plane + 4 * (size_t)list->index[j];
		float height = 0;
		for (size_t k = 0; k < 3; k++)
			height += plane[k] * (p[k] - q[k]) / reach;
		if (plane[3] + height * height < least) {
			least = plane[3] + height * height;
			memcpy(better, plane, 3 * sizeof *better);
			better[3] = least;
		}
	}
}

/* A neighbour of a neighbour may know the face where no neighbour does. */
static gw_status choose_planes(normal_step *step, gw_error *error)
{
	for (int round = 0; round < PLANE_ROUNDS; round++) {
		GW_TRY(gw_neighbours_visit_reach(step->search, choose_plane, step, error));
		take_better(step);
	}
	return GW_OK;
}

/* Is it known which scanner saw a surfel? */
static bool is_seen_by_one(const normal_step *step, size_t surfel)
{
	return step->scanner_of ? step->scanner_of[surfel] < step->scanner_count
							: step->scanner_count > 0;
}

/* Is there a surfel with one of these bits? */
static bool has_state(const normal_step *step, uint8_t bits)
{
	for (size_t i = 0; i < step->surfels->count; i++)
		if (step->state[i] & bits)
			return true;
	return false;
}

/* Does nobody know of some surfels who saw them? */
static bool is_open(const normal_step *step)
{
	for (size_t i = 0; i < step->surfels->count; i++)
		if (step->state[i] & ESTIMATED && !is_seen_by_one(step, i))
			return true;
	return false;
}

/* Takes the planes' normals, to the scanner where there is one. A thin thing that it sees nearly
 * edge-on may show either side. */
static void set_normals(normal_step *step)
{
	for (size_t i = 0; i < step->surfels->count; i++) {
		const float *plane = step->plane + 4 * i;
		double way[3], cosine = 0;
		if (!(step->state[i] & ESTIMATED))
			continue;
		way_to_scanner(step, i, way);
		for (int k = 0; k < 3; k++)
			cosine += way[k] * (double)plane[k];
		for (size_t k = 0; k < 3; k++)
			step->surfels->normal[3 * i + k] = cosine < 0 ? -plane[k] : plane[k];
		bool seen = is_seen_by_one(step, i);
		if (seen && fabs(cosine) < (double)SURE_COSINE)
			step->state[i] |= UNSURE;
		if (seen && fabs(cosine) <= (double)UNTRUSTED_COSINE)
			step->state[i] |= EDGE_ON;
		if (plane[3] > CURVATURE_MAX ||
			(step->thin && step->thin[i] > 0 && step->state[i] & UNSURE))
			step->state[i] |= UNTRUSTED;
	}
}

/* Neighbours on the same surface vote on the sign of an unsure normal; sure ones count four times.
 * All votes of a round see the state before it, so that their order does not matter. */
static void vote(void *user, size_t surfel, const gw_neighbour_list *list)
{
	normal_step *step = user;
	const gw_surfels *s = step->surfels;
	const float *n = s->normal + 3 * surfel;
	uint8_t state = step->state[surfel];
	float balance = 0, weights = 0;
	step->next[surfel] = state;
	if (!(state & UNSURE))
		return;
	for (uint32_t j = 0; j < list->count; j++) {
		size_t other = list->index[j];
		const float *m = s->normal + 3 * other;
		float cosine = n[0] * m[0] + n[1] * m[1] + n[2] * m[2], height = 0;
		for (size_t k = 0; k < 3; k++)
			height += n[k] * (s->position[3 * other + k] - s->position[3 * surfel + k]);
		if (fabsf(cosine) < 0.8f || fabsf(height) > 0.4f * list->distance[list->count - 1])
			continue;
		bool agrees = (cosine > 0) == ((step->state[other] & NEGATIVE) == (state & NEGATIVE));
		float weight = (step->state[other] & UNSURE ? 1.0f : 4.0f) * fabsf(cosine);
		balance += agrees ? weight : -weight;
		weights += weight;
	}
	if (balance < 0)
		step->next[surfel] ^= NEGATIVE;
	if (weights >= AGREEMENT_LEAST && fabsf(balance) >= AGREEMENT_SURE * weights)
		step->next[surfel] &= (uint8_t)~EDGE_ON;
}

static gw_status run_votes(normal_step *step, gw_error *error)
{
	for (int round = 0; round < VOTES; round++) {
		GW_TRY(gw_neighbours_visit_reach(step->search, vote, step, error));
		uint8_t *swap = step->state;
		step->state = step->next;
		step->next = swap;
	}
	return GW_OK;
}

/* Turns what was voted to be turned. */
static void apply_votes(normal_step *step)
{
	for (size_t i = 0; i < step->surfels->count; i++) {
		float *n = step->surfels->normal + 3 * i;
		for (int k = 0; k < 3 && (step->state[i] & NEGATIVE); k++)
			n[k] = -n[k];
		step->state[i] &= (uint8_t)~NEGATIVE;
	}
}

static void apply_states(normal_step *step)
{
	gw_surfels *s = step->surfels;
	for (size_t i = 0; i < s->count; i++) {
		uint8_t state = step->state[i];
		state |= state & EDGE_ON ? UNTRUSTED : 0;
		s->normals_estimated += (state & ESTIMATED) != 0;
		s->normals_untrusted += (state & (UNTRUSTED | UNCLEAR)) != 0;
		if (state & (UNTRUSTED | UNCLEAR))
			s->two_sided[i] = state & UNTRUSTED ? 1 : GW_SIDE_UNCLEAR;
	}
}

/* Where nobody knows which scanner saw it: the front of every piece of surface as a whole. */
static gw_status choose_sides(normal_step *step, const gw_surfels_options *options, gw_error *error)
{
	size_t count = step->surfels->count;
	uint8_t *doubtful = gw_allocate_array(count, sizeof *doubtful);
	for (size_t i = 0; doubtful && i < count; i++)
		step->next[i] = (step->state[i] & ESTIMATED) &&
						!(is_seen_by_one(step, i) && !(step->state[i] & EDGE_ON));
	const gw_known_sides known = { step->next, step->scanner, step->scanner_count };
	gw_status status =
		doubtful ? gw_orient_normals(options, step->search, step->surfels, &known, doubtful, error)
				 : gw_fail(error, GW_ERROR_MEMORY, "no memory to orient %zu normals", count);
	for (size_t i = 0; status == GW_OK && i < count; i++)
		step->state[i] |= doubtful[i] == GW_SIDE_UNCLEAR ? UNCLEAR : doubtful[i] ? UNTRUSTED : 0;
	free(doubtful);
	return status;
}

static gw_status complete(normal_step *step, const gw_points *points,
						  const gw_surfels_options *options, gw_error *error)
{
	const gw_surfels *surfels = step->surfels;
	if (!step->state || !step->next || !step->plane || !step->better || !step->near ||
		!find_scanners(step, points) || !find_thin(step, points))
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to estimate %zu normals", surfels->count);
	GW_TRY(gw_neighbours_visit_reach(step->search, estimate_normal, step, error));
	GW_TRY(take_few(step, error));
	GW_TRY(take_near(step, error));
	GW_TRY(choose_planes(step, error));
	set_normals(step);
	if (has_state(step, UNSURE)) {
		GW_TRY(run_votes(step, error));
		apply_votes(step);
	}
	if (is_open(step))
		GW_TRY(choose_sides(step, options, error));
	apply_states(step);
	return GW_OK;
}

static gw_status complete_all(const gw_points *points, const gw_surfels_options *options,
							  gw_neighbours *search, gw_surfels *surfels, gw_error *error)
{
	size_t count = surfels->count;
	normal_step step = { .surfels = surfels, .search = search };
	step.state = gw_allocate_zeros(count, sizeof *step.state);
	step.next = gw_allocate_zeros(count, sizeof *step.next);
	step.plane = gw_allocate_array(count, 4 * sizeof *step.plane);
	step.better = gw_allocate_array(count, 4 * sizeof *step.better);
	step.near = gw_allocate_array(count, 4 * sizeof *step.near);
	gw_status status = complete(&step, points, options, error);
	free(step.state);
	free(step.next);
	free(step.plane);
	free(step.better);
	free(step.near);
	free(step.thin);
	free(step.few);
	free(step.scanner);
	free(step.scanner_of);
	return status;
}

/* Normals of no side: those that are estimated in their place tell the side, also where they are
 * too noisy to tell more. */
static gw_status turn_axes(const gw_points *points, const gw_surfels_options *options,
						   gw_neighbours *search, gw_surfels *surfels, gw_error *error)
{
	size_t bytes = 3 * surfels->count * sizeof *surfels->normal;
	float *axis = gw_allocate_array(surfels->count, 3 * sizeof *axis);
	if (!axis)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to turn %zu normals", surfels->count);
	memcpy(axis, surfels->normal, bytes);
	memset(surfels->normal, 0, bytes);
	gw_status status = complete_all(points, options, search, surfels, error);
	for (size_t i = 0; status == GW_OK && i < surfels->count; i++) {
		const float *a = axis + 3 * i;
		float *n = surfels->normal + 3 * i, cosine = a[0] * n[0] + a[1] * n[1] + a[2] * n[2];
		if (!(fabsf(cosine) > AXIS_COSINE))
			continue;
		for (size_t k = 0; k < 3; k++)
			n[k] = cosine < 0 ? -a[k] : a[k];
		surfels->normals_estimated--;
	}
	free(axis);
	return status;
}

gw_status gw_normals_complete(const gw_points *points, const gw_surfels_options *options,
							  gw_neighbours *search, gw_surfels *surfels, gw_error *error)
{
	if (points->normal_sideless)
		return turn_axes(points, options, search, surfels, error);
	return surfels->normals_given == surfels->count
			   ? GW_OK
			   : complete_all(points, options, search, surfels, error);
}

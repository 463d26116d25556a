/* normals.c - normals for points that come without; see surfel_steps.h. */
#include "surfel_steps.h"

#include "memory.h"
#include "plane_normal.h"

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

#define VOTES 2

/* What is known of one estimated normal. */
enum {
	GIVEN = 0, /* nothing was estimated */
	ESTIMATED = 1,
	UNSURE = 2,    /* orientation may be changed by a vote */
	UNTRUSTED = 4, /* lit from both sides */
	NEGATIVE = 8,  /* the vote's result: points the other way */
};

typedef enum orientation {
	TO_POSITIONS, /* the scanner that saw it, or the nearest of several scanners or lights */
	AGAINST_SUN,
	UPWARDS,
	TO_MIDDLE,
} orientation;

typedef struct normal_step {
	gw_surfels *surfels;
	gw_neighbours *search;
	orientation orientation;
	double *target; /* 3 * target_count, local; of TO_POSITIONS and TO_MIDDLE */
	size_t target_count;
	uint32_t *target_of; /* count, the one that saw each surfel, or NULL: the nearest */
	double direction[3]; /* of AGAINST_SUN and UPWARDS */
	bool guessed;        /* nothing in the scene says where the outside is */
	uint8_t *state;      /* count, bits as above */
	uint8_t *next;       /* count, state after the vote */
} normal_step;

static bool has_power(const float value[3])
{
	return value[0] > 0 || value[1] > 0 || value[2] > 0;
}

static bool is_lamp(const gw_light *light)
{
	return (light->type == GW_LIGHT_POINT || light->type == GW_LIGHT_SPOT) &&
		   has_power(light->intensity);
}

static bool add_target(normal_step *step, const double position[3])
{
	double *target = gw_resize_array(step->target, step->target_count + 1, 3 * sizeof *target);
	if (!target)
		return false;
	step->target = target;
	for (size_t k = 0; k < 3; k++)
		target[3 * step->target_count + k] = position[k] - step->surfels->origin[k];
	step->target_count++;
	return true;
}

static bool find_sun(normal_step *step, const gw_surfels_options *options)
{
	for (size_t i = 0; i < options->light_count; i++) {
		const gw_light *light = options->lights + i;
		if (light->type != GW_LIGHT_SUN || !has_power(light->irradiance))
			continue;
		for (int k = 0; k < 3; k++)
			step->direction[k] = -light->direction[k];
		step->orientation = AGAINST_SUN;
		return true;
	}
	return false;
}

static bool guess_outside(normal_step *step)
{
	const gw_surfels *s = step->surfels;
	float size[3];
	double middle[3];
	for (int k = 0; k < 3; k++) {
		size[k] = s->maximum[k] - s->minimum[k];
		middle[k] = 0.5 * ((double)s->maximum[k] + (double)s->minimum[k]) + s->origin[k];
	}
	step->guessed = true;
	step->orientation = UPWARDS;
	step->direction[2] = 1;
	if (size[2] < 0.5f * fminf(size[0], size[1]))
		return true;
	step->orientation = TO_MIDDLE;
	return add_target(step, middle);
}

/* Points that became one surfel may have been seen by several scanners: the first one counts. */
static bool assign_scanners(normal_step *step, const gw_points *points)
{
	const gw_surfels *s = step->surfels;
	if (!points->scanner_of)
		return true;
	step->target_of = gw_allocate_array(s->count, sizeof *step->target_of);
	if (!step->target_of)
		return false;
	memset(step->target_of, 0xff, s->count * sizeof *step->target_of);
	for (size_t i = 0; i < s->point_count; i++) {
		uint32_t surfel = s->surfel_of_point[i];
		if (surfel != UINT32_MAX && points->scanner_of[i] < step->target_of[surfel])
			step->target_of[surfel] = points->scanner_of[i];
	}
	return true;
}

/* Targets keep their numbers, so that one bad position makes all of them unknown. */
static bool has_scanners(const gw_points *points)
{
	for (size_t k = 0; k < 3 * points->scanner_count; k++)
		if (!isfinite(points->scanner[k]))
			return false;
	return points->scanner_count > 0;
}

static bool choose_orientation(normal_step *step, const gw_points *points,
							   const gw_surfels_options *options)
{
	step->orientation = TO_POSITIONS;
	if (has_scanners(points)) {
		for (size_t i = 0; i < points->scanner_count; i++)
			if (!add_target(step, points->scanner + 3 * i))
				return false;
		return assign_scanners(step, points);
	}
	for (size_t i = 0; i < options->light_count; i++)
		if (is_lamp(options->lights + i) && !add_target(step, options->lights[i].position))
			return false;
	return step->target_count > 0 || find_sun(step, options) || guess_outside(step);
}

/* Unit vector the normal of a surfel should point along. */
static void outside_of(const normal_step *step, size_t surfel, double way[3])
{
	const float *p = step->surfels->position + 3 * surfel;
	double best = INFINITY;
	memcpy(way, step->direction, 3 * sizeof *way);
	size_t own = step->target_of ? step->target_of[surfel] : step->target_count;
	bool known = own < step->target_count;
	for (size_t i = known ? own : 0; i < (known ? own + 1 : step->target_count); i++) {
		double d[3], squared = 0;
		for (size_t k = 0; k < 3; k++) {
			d[k] = step->target[3 * i + k] - (double)p[k];
			squared += d[k] * d[k];
		}
		if (squared < best) {
			best = squared;
			memcpy(way, d, sizeof d);
		}
	}
	double length = sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]);
	if (!(length > 0) || !isfinite(length)) {
		way[0] = way[1] = 0;
		way[2] = length = 1;
	}
	for (int k = 0; k < 3; k++)
		way[k] /= length;
}

/* The neighbours around a surfel, itself first, in units of the furthest one's distance. */
static size_t gather_points(const gw_surfels *s, size_t surfel, const gw_neighbour_list *list,
							float point[3 * (GW_NEIGHBOURS + 1)])
{
	double reach = list->count ? (double)list->distance[list->count - 1] : 1;
	memset(point, 0, 3 * sizeof *point);
	for (uint32_t j = 0; j < list->count; j++)
		for (size_t k = 0; k < 3; k++) {
			double d = (double)s->position[3 * (size_t)list->index[j] + k] -
					   (double)s->position[3 * surfel + k];
			point[3 * (j + 1) + k] = (float)(d / reach);
		}
	return list->count + 1u;
}

/* Whether points spread in two directions across a normal, rather than along a line. */
static bool spans_plane(const float *point, size_t count, const float normal[3])
{
	float t[3], b[3];
	double u = 0, v = 0, uu = 0, uv = 0, vv = 0;
	gw_tangent_frame(normal, t, b);
	for (size_t i = 0; i < count; i++) {
		const float *p = point + 3 * i;
		double x = (double)(p[0] * t[0] + p[1] * t[1] + p[2] * t[2]);
		double y = (double)(p[0] * b[0] + p[1] * b[1] + p[2] * b[2]);
		u += x;
		v += y;
		uu += x * x;
		uv += x * y;
		vv += y * y;
	}
	double n = (double)count;
	double a = uu - u * u / n, c = vv - v * v / n, mixed = uv - u * v / n;
	double half = 0.5 * (a + c), root = sqrt(0.25 * (a - c) * (a - c) + mixed * mixed);
	return half - root > LINE_RATIO * (half + root);
}

/* Where there is no plane: the outside's direction, made perpendicular to the line on which the
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
	if (n_length < 1e-6) { /* the line points outside: any perpendicular */
		float along_axis[3] = { (float)way[0], (float)way[1], (float)way[2] }, bitangent[3];
		gw_tangent_frame(along_axis, normal, bitangent);
		return;
	}
	for (int k = 0; k < 3; k++)
		normal[k] = (float)(n[k] / sqrt(n_length));
}

static void estimate_normal(void *user, size_t surfel, const gw_neighbour_list *list)
{
	normal_step *step = user;
	float *normal = step->surfels->normal + 3 * surfel;
	float point[3 * (GW_NEIGHBOURS + 1)], curvature = 0;
	double way[3], cosine = 0;
	if (normal[0] != 0 || normal[1] != 0 || normal[2] != 0)
		return;
	size_t count = gather_points(step->surfels, surfel, list, point);
	uint8_t state = ESTIMATED;
	outside_of(step, surfel, way);
	if (!gw_plane_normal(point, count, normal, &curvature) || !spans_plane(point, count, normal)) {
		fallback_normal(point, count, way, normal);
		state |= UNTRUSTED;
	}
	for (int k = 0; k < 3; k++)
		cosine += way[k] * (double)normal[k];
	for (int k = 0; k < 3; k++)
		normal[k] = cosine < 0 ? -normal[k] : normal[k];
	if (fabs(cosine) < (double)SURE_COSINE || step->guessed)
		state |= UNSURE;
	if (fabs(cosine) <= (double)UNTRUSTED_COSINE || curvature > CURVATURE_MAX || step->guessed)
		state |= UNTRUSTED;
	step->state[surfel] = state;
}

/* Neighbours on the same surface vote on the sign of an unsure normal; sure ones count four times.
 * All votes of a round see the state before it, so that their order does not matter. */
static void vote(void *user, size_t surfel, const gw_neighbour_list *list)
{
	normal_step *step = user;
	const gw_surfels *s = step->surfels;
	const float *n = s->normal + 3 * surfel;
	uint8_t state = step->state[surfel];
	float balance = 0;
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
	}
	if (balance < 0)
		step->next[surfel] = state ^ NEGATIVE;
}

static gw_status run_votes(normal_step *step, gw_error *error)
{
	gw_status status = GW_OK;
	for (int round = 0; round < VOTES && status == GW_OK; round++) {
		status = gw_neighbours_visit(step->search, vote, step, error);
		uint8_t *swap = step->state;
		step->state = step->next;
		step->next = swap;
	}
	return status;
}

static void apply_states(normal_step *step)
{
	gw_surfels *s = step->surfels;
	for (size_t i = 0; i < s->count; i++) {
		uint8_t state = step->state[i];
		for (size_t k = 0; k < 3 && (state & NEGATIVE); k++)
			s->normal[3 * i + k] = -s->normal[3 * i + k];
		s->normals_estimated += (state & ESTIMATED) != 0;
		s->normals_untrusted += (state & UNTRUSTED) != 0;
		if (state & UNTRUSTED)
			s->two_sided[i] = 1;
	}
}

gw_status gw_normals_complete(const gw_points *points, const gw_surfels_options *options,
							  gw_neighbours *search, gw_surfels *surfels, gw_error *error)
{
	normal_step step = { .surfels = surfels, .search = search };
	if (surfels->normals_given == surfels->count)
		return GW_OK;
	step.state = gw_allocate_zeros(surfels->count, sizeof *step.state);
	step.next = gw_allocate_zeros(surfels->count, sizeof *step.next);
	gw_status status = GW_OK;
	if (!step.state || !step.next || !choose_orientation(&step, points, options))
		status =
			gw_fail(error, GW_ERROR_MEMORY, "no memory to estimate %zu normals", surfels->count);
	if (status == GW_OK)
		status = gw_neighbours_visit(search, estimate_normal, &step, error);
	if (status == GW_OK)
		status = run_votes(&step, error);
	if (status == GW_OK)
		apply_states(&step);
	free(step.state);
	free(step.next);
	free(step.target);
	free(step.target_of);
	return status;
}

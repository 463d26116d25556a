/* given_normals.c - see given_normals.h. */
#include "normals/given_normals.h"

#include "base/distribution.h"
#include "base/memory.h"
#include "base/nth_element.h"
#include "normals/normal_orientation.h"
#include "normals/plane_normal.h"
#include "normals/scanner_sight.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Surfels that are looked at, and the fewest findings that mean anything. */
#define SAMPLES 30000u
#define FINDINGS_LEAST 50u

/* Spread off a plane below which 16 neighbours are one: noise of a tenth of their reach. */
#define FLAT 0.01f

/* A normal further from the plane's than 45 degrees is wrong; of clean scans some are, at rims. */
#define OFF_COSINE 0.7f
#define OFF_MOST 0.1

/* Neighbours on one plane: their normals but for the sign, and heights over their distance. */
#define SAME_PLANE 0.8f
#define SAME_HEIGHT 0.2f
#define CONFLICT_MOST 0.03

/*
 * Opposing neighbours are the other side of a sheet where they lie behind: by so much of the sum of
 * their heights where that is clear. Through noise as thick as the sheet a single surfel tells next
 * to nothing: those in front take away from those behind. All together they still lie behind a
 * little, which neighbours of wrong signs do by chance alone: seldom by twice the root of the sum
 * of squares, as neighbours share heights, and hardly ever by SHEET_SURE times. Then both sides lie
 * amid each other, on less than half of the surface: signs that are random do so everywhere, and
 * where a patch was turned the two kinds lie on either side of its border. The middles of the two
 * kinds are .33 to .56 of the reach apart amid each other, .9 at borders.
 */
#define SHEET_CLEAR 0.5
#define SHEET_IN_NOISE 0.05
#define SHEET_SURE 10.0
#define NOISE_LEFT 0.8
#define AMID_MOST 0.7
#define AMID_SHARE 0.5

/* Neighbours beyond a crease, both clearly off the other's plane, and how many may disagree: where
 * a scanner saw one thing before another, some do. */
#define CREASE_COSINE 0.6f
#define CREASE_HEIGHT 0.35f
#define CREASE_MOST 0.35

/* Least share of surfels on planes for creases to say anything. */
#define PLANES_LEAST 0.3

/* Turning has to leave less than one in so many contradictions; else the surface is too ragged for
 * anybody to know. */
#define BETTER_BY 5

/* A component keeps the side of its given normals when at least so many of them had it. */
#define MAJORITY 0.6

/* Inside out: share of the ways to the front that may lead out, and of those to the back that
 * must. Coarse cells let a few through that should not be. */
#define OUT_FRONT_MOST 0.005
#define OUT_BACK_LEAST 0.3

/* Share of a scanner's points that face away from it, from which on they are turned. */
#define AWAY_LEAST 0.8

/* Median length of normals below which they are no means of others: those would spread over more
 * than a hemisphere. */
#define LENGTH_LEAST 0.3f

/* Links from each surfel by which connected components are found. */
#define LINKS 4u

/* What was found at one surfel. */
typedef struct finding {
	bool flat, off, conflict;
	uint8_t creases, against;
	float behind, heights; /* of opposing neighbours: sum of heights, and of their sizes */
	float apart; /* how far the middles of opposing and of other neighbours are, of the reach; 0:
					there are not two of each */
} finding;

typedef struct figures {
	uint64_t flat, off, surfels, conflicts, creases, against;
	uint64_t parted; /* surfels whose neighbours are some of each */
	double behind, heights, apart;
	double singly, squares; /* sums of the sizes of behind, and of their squares */
} figures;

typedef struct check {
	gw_neighbours *search;
	const gw_surfels *surfels;
	finding *finding;
	size_t stride;
	uint32_t *link; /* LINKS * count */
	uint32_t *parent;
} check;

static float dot(const float a[3], const float b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static bool is_given(const float n[3])
{
	return n[0] != 0 || n[1] != 0 || n[2] != 0;
}

/* -------------------------------------------------------------------------------- one surfel */

static void look_at_plane(check *c, const float *n, const float *way, uint32_t count, finding *f)
{
	float plane[3], curvature;
	gw_plane found = gw_plane_normal(way, count, plane, &curvature);
	if (found == GW_PLANE_NO_MEMORY)
		gw_neighbours_run_short(c->search);
	f->flat = found == GW_PLANE_FOUND && curvature < FLAT && count > GW_NEIGHBOURS / 2;
	f->off = f->flat && fabsf(dot(n, plane)) < OFF_COSINE;
}

/* Neighbours on one plane with a surfel: those that face as it does, and those that oppose it. */
typedef struct facing {
	float count, way[3]; /* sums */
} facing;

/*
 * Across a crease, a consistent pair either sees each other (concave) or lies behind each other
 * (convex).
 */
static void look_at_pair(const float *n, const float *m, const float *way, float distance,
						 finding *f, facing votes[2])
{
	float cosine = dot(n, m), own = dot(n, way) / distance, other = -dot(m, way) / distance;
	if (fabsf(cosine) > SAME_PLANE && fabsf(own) < SAME_HEIGHT && fabsf(other) < SAME_HEIGHT) {
		votes[cosine < 0].count += 1;
		for (int k = 0; k < 3; k++)
			votes[cosine < 0].way[k] += way[k];
		f->behind += cosine < 0 ? own : 0;
		f->heights += cosine < 0 ? fabsf(own) : 0;
	}
	if (fabsf(cosine) < CREASE_COSINE && fabsf(own) > CREASE_HEIGHT &&
		fabsf(other) > CREASE_HEIGHT) {
		f->creases++;
		f->against += (own > 0) != (other > 0);
	}
}

static float apart(const facing votes[2])
{
	float between[3];
	if (votes[0].count < 2 || votes[1].count < 2)
		return 0;
	for (int k = 0; k < 3; k++)
		between[k] = votes[1].way[k] / votes[1].count - votes[0].way[k] / votes[0].count;
	return sqrtf(dot(between, between));
}

static void look(void *user, size_t surfel, const gw_neighbour_list *list)
{
	check *c = user;
	const gw_surfels *s = c->surfels;
	const float *n = s->normal + 3 * surfel;
	float way[3 * (GW_NEIGHBOURS + 1)] = { 0 };
	facing votes[2] = { { 0 } };
	if (surfel % c->stride != 0 || !is_given(n) || list->count < 3)
		return;
	finding *f = &c->finding[surfel / c->stride];
	float reach = list->distance[list->count - 1];
	for (uint32_t j = 0; j < list->count; j++) {
		size_t other = list->index[j];
		float *to = way + 3 * (j + 1);
		for (size_t k = 0; k < 3; k++)
			to[k] = (s->position[3 * other + k] - s->position[3 * surfel + k]) / reach;
		if (is_given(s->normal + 3 * other))
			look_at_pair(n, s->normal + 3 * other, to, list->distance[j] / reach, f, votes);
	}
	look_at_plane(c, n, way, list->count + 1, f);
	f->apart = apart(votes);
	f->conflict =
		votes[1].count >= 2 && votes[1].count >= 0.25f * (votes[0].count + votes[1].count);
}

static gw_status measure(check *c, figures *all, gw_error *error)
{
	size_t count = (c->surfels->count + c->stride - 1) / c->stride;
	memset(c->finding, 0, count * sizeof *c->finding);
	*all = (figures){ .surfels = count };
	GW_TRY(gw_neighbours_visit(c->search, look, c, error));
	for (size_t i = 0; i < count; i++) {
		const finding *f = &c->finding[i];
		all->flat += f->flat;
		all->off += f->off;
		all->conflicts += f->conflict;
		all->creases += f->creases;
		all->against += f->against;
		all->behind += (double)f->behind;
		all->heights += (double)f->heights;
		all->singly += fabs((double)f->behind);
		all->squares += (double)f->behind * (double)f->behind;
		all->parted += f->apart > 0;
		all->apart += (double)f->apart;
	}
	return GW_OK;
}

static bool is_off(const figures *f)
{
	return f->off >= FINDINGS_LEAST && (double)f->off > OFF_MOST * (double)f->flat;
}

/* Are opposing neighbours the other side of a sheet? */
static bool are_sheets(const figures *f)
{
	bool amid = f->parted >= FINDINGS_LEAST && f->apart < AMID_MOST * (double)f->parted &&
				(double)f->conflicts < AMID_SHARE * (double)f->surfels;
	bool in_noise = f->singly < NOISE_LEFT * f->heights;
	bool sure = f->behind < -SHEET_SURE * sqrt(f->squares);
	return f->behind < -SHEET_CLEAR * f->heights ||
		   (amid && in_noise && sure && f->behind < -SHEET_IN_NOISE * f->heights);
}

static bool is_mixed(const figures *f)
{
	bool conflicts = f->conflicts >= FINDINGS_LEAST && !are_sheets(f) &&
					 (double)f->conflicts > CONFLICT_MOST * (double)f->surfels;
	bool creases = f->against >= FINDINGS_LEAST &&
				   (double)f->flat > PLANES_LEAST * (double)f->surfels &&
				   (double)f->against > CREASE_MOST * (double)f->creases;
	return conflicts || creases;
}

/* ----------------------------------------------------------------------------- the components */

static uint32_t root_of(uint32_t *parent, uint32_t i)
{
	while (parent[i] != i)
		i = parent[i] = parent[parent[i]];
	return i;
}

static void note_links(void *user, size_t surfel, const gw_neighbour_list *list)
{
	check *c = user;
	for (uint32_t j = 0; j < LINKS; j++)
		c->link[LINKS * surfel + j] = j < list->count ? list->index[j] : (uint32_t)surfel;
}

static gw_status find_components(check *c, gw_error *error)
{
	size_t count = c->surfels->count;
	GW_TRY(gw_neighbours_visit_reach(c->search, note_links, c, error));
	for (uint32_t i = 0; i < count; i++)
		c->parent[i] = i;
	for (uint32_t i = 0; i < count; i++)
		for (size_t j = 0; j < LINKS; j++) {
			uint32_t a = root_of(c->parent, i);
			uint32_t b = root_of(c->parent, c->link[LINKS * (size_t)i + j]);
			c->parent[a < b ? b : a] = a < b ? a : b;
		}
	return GW_OK;
}

/* Turns whole components back where clearly most of the given normals were turned. */
static gw_status keep_majority(check *c, gw_surfels *s, const float *before, gw_error *error)
{
	uint32_t(*turned)[2] = gw_allocate_zeros(s->count, sizeof *turned);
	if (!turned)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for components of %zu surfels", s->count);
	for (uint32_t i = 0; i < s->count; i++) {
		const float *n = before + 3 * (size_t)i;
		if (is_given(n))
			turned[root_of(c->parent, i)][dot(n, s->normal + 3 * (size_t)i) < 0]++;
	}
	for (uint32_t i = 0; i < s->count; i++) {
		const uint32_t *t = turned[root_of(c->parent, i)];
		bool back = (double)t[1] > MAJORITY * ((double)t[0] + (double)t[1]);
		for (size_t k = 0; back && k < 3; k++)
			s->normal[3 * (size_t)i + k] = -s->normal[3 * (size_t)i + k];
	}
	free(turned);
	return GW_OK;
}

static uint64_t contradictions(const figures *f)
{
	return (are_sheets(f) ? 0 : f->conflicts) + f->against;
}

static bool is_better(const figures *after, const figures *before)
{
	return BETTER_BY * contradictions(after) < contradictions(before);
}

/* Counts those that were turned, or takes all back when that did not help. */
static void settle(gw_surfels *s, const float *before, bool better)
{
	for (size_t i = 0; i < s->count; i++)
		s->normals_turned +=
			better && is_given(before + 3 * i) && dot(before + 3 * i, s->normal + 3 * i) < 0;
	if (!better)
		memcpy(s->normal, before, 3 * s->count * sizeof *before);
}

/* Room of mend_signs. */
typedef struct mending {
	const gw_points *points;
	const gw_surfels_options *options;
	float *before;            /* 3 a surfel, the normals as they were given */
	uint8_t *open, *doubtful; /* one a surfel, as gw_orient_normals has them */
	double *scanner;          /* 3 each, metres as surfels->position */
} mending;

static gw_status mend_in(check *c, const mending *m, gw_surfels *s, const figures *found,
						 gw_error *error)
{
	figures after;
	if (!m->before || !m->open || !m->doubtful || !m->scanner || !c->link || !c->parent)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to turn %zu normals", s->count);
	memcpy(m->before, s->normal, 3 * s->count * sizeof *m->before);
	memset(m->open, 1, s->count);
	for (size_t i = 0; i < 3 * m->points->scanner_count; i++)
		m->scanner[i] = m->points->scanner[i] - s->origin[i % 3];
	const gw_known_sides known = { m->open, m->scanner, m->points->scanner_count };
	GW_TRY(gw_orient_normals(m->options, c->search, s, &known, m->doubtful, error));
	GW_TRY(find_components(c, error));
	GW_TRY(keep_majority(c, s, m->before, error));
	GW_TRY(measure(c, &after, error));
	settle(s, m->before, is_better(&after, found));
	return GW_OK;
}

static gw_status mend_signs(check *c, const gw_points *points, const gw_surfels_options *options,
							gw_surfels *s, const figures *found, gw_error *error)
{
	const mending m = { points,
						options,
						gw_allocate_array(s->count, 3 * sizeof *m.before),
						gw_allocate_array(s->count, 1),
						gw_allocate_array(s->count, 1),
						gw_allocate_array(points->scanner_count + 1, 3 * sizeof *m.scanner) };
	c->link = gw_allocate_array(s->count, LINKS * sizeof *c->link);
	c->parent = gw_allocate_array(s->count, sizeof *c->parent);
	gw_status status = mend_in(c, &m, s, found, error);
	free(m.before);
	free(m.open);
	free(m.doubtful);
	free(m.scanner);
	free(c->link);
	free(c->parent);
	return status;
}

/* --------------------------------------------------------------------------------- inside out */

static bool is_within(const gw_surfels *s, const double place[3])
{
	bool within = true;
	for (size_t k = 0; k < 3; k++) {
		double p = place[k] - s->origin[k];
		within = within && p > (double)s->minimum[k] && p < (double)s->maximum[k];
	}
	return within;
}

/* Whether light or a scanner may be among the points. */
static bool has_inside(const gw_surfels *s, const gw_points *points,
					   const gw_surfels_options *options)
{
	bool inside = s->emission != NULL;
	for (size_t i = 0; i < points->scanner_count && !inside; i++)
		inside = is_within(s, points->scanner + 3 * i);
	for (size_t i = 0; i < options->light_count && !inside; i++) {
		const gw_light *l = &options->lights[i];
		inside = gw_light_has_place(l) && is_within(s, l->position);
	}
	return inside;
}

/* Volume below the surface as seen from its fronts, over that of a ball so wide: below 0 where
 * most of the fronts face the middle. */
static bool faces_middle(const gw_surfels *s)
{
	double sum = 0, sizes = 0;
	for (size_t i = 0; i < s->count; i++)
		for (size_t k = 0; k < 3; k++) {
			double middle = 0.5 * ((double)s->minimum[k] + (double)s->maximum[k]);
			double part = ((double)s->position[3 * i + k] - middle) * (double)s->normal[3 * i + k];
			sum += part;
			sizes += fabs(part);
		}
	return sum < -0.5 * sizes;
}

static gw_status mend_inside_out(check *c, gw_surfels *s, gw_error *error)
{
	double share[2];
	float *plane = gw_allocate_array(s->count, 4 * sizeof *plane);
	if (!plane)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to look out of %zu points", s->count);
	for (size_t i = 0; i < s->count; i++)
		memcpy(plane + 4 * i, s->normal + 3 * i, 3 * sizeof *plane);
	gw_status status =
		gw_sight_open_share(c->search, s, &(gw_scanner_places){ .plane = plane }, share, error);
	free(plane);
	if (status != GW_OK || share[0] > OUT_FRONT_MOST || share[1] < OUT_BACK_LEAST)
		return status;
	for (size_t i = 0; i < 3 * s->count; i++)
		s->normal[i] = -s->normal[i];
	s->normals_turned = s->normals_given;
	return GW_OK;
}

/* ----------------------------------------------------------------- away from their scanners */

/* Of the points that one scanner saw. */
typedef struct seen_points {
	size_t all, away;
} seen_points;

/* The scanner that saw a point whose surfel has one side; scanner_count where that is not known. */
static size_t scanner_of(const gw_points *points, const gw_surfels *s, size_t point)
{
	uint32_t surfel = s->surfel_of_point[point];
	if (surfel == UINT32_MAX || s->two_sided[surfel] || !is_given(s->normal + 3 * (size_t)surfel))
		return points->scanner_count;
	size_t of = points->scanner_of           ? points->scanner_of[point]
				: points->scanner_count == 1 ? 0
											 : points->scanner_count;
	return of < points->scanner_count ? of : points->scanner_count;
}

static bool faces_away(const gw_points *points, const gw_surfels *s, size_t point)
{
	const double *at = points->scanner + 3 * scanner_of(points, s, point);
	const float *n = s->normal + 3 * (size_t)s->surfel_of_point[point];
	double along = 0;
	for (size_t k = 0; k < 3; k++)
		along += (double)n[k] * (at[k] - points->position[3 * point + k]);
	return along < 0;
}

/* No scanner sees a back: of those whose points nearly all face away, these are turned. Where fewer
 * do, it may be the scanner's place that is wrong. */
static gw_status mend_facing_away(const gw_points *points, gw_surfels *s, gw_error *error)
{
	if (points->scanner_count == 0)
		return GW_OK;
	seen_points *seen = gw_allocate_zeros(points->scanner_count, sizeof *seen);
	if (!seen)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu scanners", points->scanner_count);
	for (size_t i = 0; i < s->point_count; i++) {
		size_t of = scanner_of(points, s, i);
		if (of < points->scanner_count) {
			seen[of].all++;
			seen[of].away += faces_away(points, s, i);
		}
	}
	for (size_t i = 0; i < s->point_count; i++) {
		size_t of = scanner_of(points, s, i), surfel = s->surfel_of_point[i];
		if (of == points->scanner_count || seen[of].away < FINDINGS_LEAST ||
			(double)seen[of].away < AWAY_LEAST * (double)seen[of].all || !faces_away(points, s, i))
			continue;
		for (size_t k = 0; k < 3; k++)
			s->normal[3 * surfel + k] = -s->normal[3 * surfel + k];
		s->normals_turned++;
	}
	free(seen);
	return GW_OK;
}

/* ---------------------------------------------------------------------------------- all of it */

static void forget_normals(gw_surfels *s)
{
	memset(s->normal, 0, 3 * s->count * sizeof *s->normal);
	memset(s->two_sided, 0, s->count);
	for (size_t i = 0; i < s->count; i++)
		s->normal_length[i] = 1;
	s->normals_given = 0;
}

static void mend_lengths(gw_surfels *s)
{
	if (gw_nth_element(s->normal_length, s->count, s->count / 2) >= LENGTH_LEAST)
		return;
	for (size_t i = 0; i < s->count; i++) {
		s->normals_lengthened += s->normal_length[i] < LENGTH_LEAST;
		s->normal_length[i] = 1;
	}
}

static gw_status check_and_mend(check *c, const gw_points *points,
								const gw_surfels_options *options, gw_surfels *s, gw_error *error)
{
	figures found;
	GW_TRY(measure(c, &found, error));
	bool mixed = !points->normal_sideless && is_mixed(&found);
	bool told = points->scanner_of || points->scanner_count == 1;
	if (is_off(&found) || (mixed && told)) {
		s->normals_doubted = s->normals_given;
		forget_normals(s);
		return GW_OK;
	}
	if (points->normal_sideless)
		return GW_OK;
	if (mixed)
		return mend_signs(c, points, options, s, &found, error);
	GW_TRY(mend_facing_away(points, s, error));
	return options->light_count > 0 && faces_middle(s) && !has_inside(s, points, options)
			   ? mend_inside_out(c, s, error)
			   : GW_OK;
}

static gw_status mend(const gw_points *points, const gw_surfels_options *options,
					  gw_neighbours *search, gw_surfels *s, gw_error *error)
{
	if (options->normals == GW_NORMALS_ESTIMATE)
		forget_normals(s);
	if (options->normals != GW_NORMALS_AUTO || s->normals_given < FINDINGS_LEAST)
		return GW_OK;
	check c = { .search = search, .surfels = s, .stride = 1 + s->count / SAMPLES };
	mend_lengths(s);
	c.finding = gw_allocate_array(1 + s->count / c.stride, sizeof *c.finding);
	if (!c.finding)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to check %zu normals", s->count);
	gw_status status = check_and_mend(&c, points, options, s, error);
	free(c.finding);
	return status;
}

gw_status gw_given_normals_mend(const gw_points *points, const gw_surfels_options *options,
								gw_neighbours *search, gw_surfels *s, gw_error *error)
{
	gw_status status = mend(points, options, search, s, error);
	if (points->normal_sideless)
		s->normals_given = 0;
	return status;
}

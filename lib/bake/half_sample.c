/*
 * half_sample.c - see half_sample.h.
 */
#include "bake/half_sample.h"

#include "bake/scene.h"
#include "base/hash.h"
#include "base/luminance.h"
#include "base/memory.h"
#include "cloud/neighbour_index.h"
#include "estimate/side_error.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Points of which half are still a cloud. */
#define POINTS_LEAST 512u

/* Share of the points without a normal of their own, or that stray, from which on a surface is in
 * doubt. */
#define ESTIMATED_LEAST 0.1
#define STRAYS_LEAST 0.002

/* How much further apart points are at some places than at others (gw_report.spacing_ratio), from
 * which on they may be too far apart for what is there: as a scanner sees leaves, wires and what is
 * far off. Of random points on a surface that is 1.3. */
#define UNEVEN_LEAST 4.0

/* Share of points on surface that ends on two sides within their reach, from which on the light is
 * that of leaves and wires, which are as wide as their points say. Of walls that is 0.003, beside
 * rims and corners up to 0.02, which are more of fewer points. */
#define NARROW_LEAST 0.02
#define NARROW_POINTS 10000u

/* Points of a half that are solved again; what they find nobody reads. */
#define SIDES_POINTS 16u

/* Points that are looked up at once. */
#define QUERIES 256u

bool gw_half_sample_is_likely(const gw_points *points, const gw_bake_options *options)
{
	return options->estimate_points > 0 && !gw_transport_is_read(options->transport) &&
		   points->count >= POINTS_LEAST &&
		   (!points->normal || options->normals == GW_NORMALS_ESTIMATE ||
			options->surface_points > 0);
}

bool gw_half_sample_is_wanted(const gw_points *points, const gw_bake_options *options,
							  const gw_report *report)
{
	double strays = 0.0, estimated = 0.0, all = (double)points->count;
	for (int kind = 0; kind < GW_STRAY_KIND_COUNT; kind++)
		strays += (double)report->stray[kind].points;
	for (uint32_t i = 0; i < report->count_count; i++)
		if (strcmp(report->count[i].name, "normals_estimated") == 0)
			estimated = (double)report->count[i].points;
	bool narrow = points->count >= NARROW_POINTS && report->narrow_share > NARROW_LEAST;
	return options->estimate_points > 0 && points->count >= POINTS_LEAST &&
		   (options->surface_points > 0 || estimated > ESTIMATED_LEAST * all ||
			strays > STRAYS_LEAST * all || report->spacing_ratio > UNEVEN_LEAST || narrow);
}

gw_bake_options gw_half_sample_options(const gw_points *points, const gw_bake_options *options)
{
	gw_bake_options plain = *options;
	plain.transport = NULL; /* that it writes is of all points */
	bool guessed = !points->normal || options->normals == GW_NORMALS_ESTIMATE;
	plain.estimate_points = guessed ? SIDES_POINTS : 0;
	plain.max_error = plain.time_limit = plain.gathered_error = 0.0f;
	plain.voxels = plain.lamps = plain.ambient_occlusion = plain.unknown = plain.errors = false;
	plain.bent_normals = plain.volume = false;
	if (plain.gaps == GW_GAPS_OPEN)
		plain.effects_forbidden |= 1u
								   << GW_EFFECT_GAPS; /* gaps that stay open light nothing else */
	return plain;
}

/* ---------------------------------------------------------------------------------- choosing */

typedef struct hashed_points {
	const gw_points *points;
	uint32_t level;
} hashed_points;

static bool takes_by_hash(const void *user, size_t point)
{
	const hashed_points *h = user;
	return gw_hash(0, h->points->position + 3 * point, 3 * sizeof(double)) >> (63 - h->level) & 1;
}

gw_status gw_half_sample_make(const gw_points *points, uint32_t level, gw_point_subset *half,
							  gw_error *error)
{
	const hashed_points hashed = { points, level };
	const gw_subset_choice every_other = { 2, 1, takes_by_hash, &hashed, true };
	return gw_point_subset_make(points, &every_other, half, error);
}

/* ---------------------------------------------------------------------------------- comparing */

static bool counts(const gw_point_subset *half, const gw_bake_result *all, size_t i)
{
	size_t of_all = half->from[i];
	const float *e = half->emission ? half->emission + 3 * i : NULL;
	return !(e && (e[0] > 0.0f || e[1] > 0.0f || e[2] > 0.0f)) &&
		   !(all->stray && all->stray[of_all]) && !(all->asked && !all->asked[of_all]) &&
		   isfinite(half->position[3 * i]);
}

/* Whether a point shows one side in the half and the other one among all. */
static bool is_turned(const gw_point_subset *half, const gw_bake_result *of_half,
					  const gw_bake_result *of_all, size_t i)
{
	const float *n = of_half->normal, *m = of_all->normal;
	if (!n || !m)
		return false;
	n += 3 * i;
	m += 3 * half->from[i];
	return n[0] * m[0] + n[1] * m[1] + n[2] * m[2] < 0.0f;
}

/* ------------------------------------------------------------------------ beside what turns */

/* What becomes of a point's difference. */
typedef enum kind { LEFT_OUT, REST, NEAR, TURNED } kind;

/* Points that turn, around one of them in single precision. */
typedef struct turned_points {
	const gw_point_subset *half;
	const double *middle;
	gw_neighbour_index *index;
	double reach;
} turned_points;

static void place(const turned_points *t, size_t i, float at[3])
{
	for (size_t k = 0; k < 3; k++)
		at[k] = (float)(t->half->position[3 * i + k] - t->middle[k]);
}

/* Marks some of the rest, those that have a point that turns within reach. */
static bool mark_some(const turned_points *t, const size_t *some, size_t count, uint8_t *kinds)
{
	float at[3 * QUERIES], squared[QUERIES];
	int found[QUERIES];
	for (size_t k = 0; k < count; k++)
		place(t, some[k], at + 3 * k);
	bool good = count == 0 || gw_neighbour_index_search(t->index, at, count, 1, found, squared);
	for (size_t k = 0; k < count && good; k++)
		if ((double)squared[k] <= t->reach * t->reach)
			kinds[some[k]] = NEAR;
	return good;
}

static bool mark_all(const turned_points *t, uint8_t *kinds)
{
	size_t some[QUERIES], count = 0;
	bool good = true;
	for (size_t i = 0; i < t->half->points.count && good; i++) {
		if (kinds[i] == REST)
			some[count++] = i;
		if (count < QUERIES)
			continue;
		good = mark_some(t, some, count, kinds);
		count = 0;
	}
	return good && mark_some(t, some, count, kinds);
}

/* Marks what is no further than the reach from points that turn, `turned` of them. */
static bool mark_near(const gw_point_subset *half, double reach, size_t turned, uint8_t *kinds)
{
	turned_points t = { .half = half, .reach = reach };
	float *at = gw_allocate_array(turned, 3 * sizeof *at);
	for (size_t i = 0, k = 0; i < half->points.count && at; i++) {
		if (kinds[i] != TURNED)
			continue;
		t.middle = t.middle ? t.middle : half->position + 3 * i;
		place(&t, i, at + 3 * k++);
	}
	t.index = at ? gw_neighbour_index_build(at, turned, 1) : NULL;
	bool good = t.index && mark_all(&t, kinds);
	gw_neighbour_index_free(t.index);
	free(at);
	return good;
}

/* Metres between records, as far as they stand apart on a surface; 0 without records. */
static double between_records(const gw_report *r)
{
	return r->records > 0 ? (double)r->record_spacing * r->leaf_size : 0.0;
}

/* What each point of the half is; false where there is no memory. */
static bool list_kinds(const gw_point_subset *half, const gw_bake_result *of_half,
					   const gw_bake_result *of_all, uint8_t *kinds)
{
	size_t turned = 0;
	for (size_t i = 0; i < half->points.count; i++) {
		kinds[i] = !counts(half, of_all, i)              ? LEFT_OUT
				   : is_turned(half, of_half, of_all, i) ? TURNED
														 : REST;
		turned += kinds[i] == TURNED;
	}
	double reach = between_records(&of_half->report);
	return turned == 0 || reach <= 0.0 || mark_near(half, reach, turned, kinds);
}

/* What points beside those that turn would differ by if nothing had turned: each as much as others
 * do. Sums of squares. */
static double near_like_rest(const double *square, const size_t *count)
{
	double each = count[REST] > 0 ? square[REST] / (double)count[REST] : 0.0;
	return fmin(each * (double)count[NEAR], square[NEAR]);
}

static gw_half_difference sum_differences(const gw_point_subset *half,
										  const gw_bake_result *of_half,
										  const gw_bake_result *of_all, const uint8_t *kinds)
{
	double square[TURNED + 1] = { 0 }, mean = 0.0, mean_of_half = 0.0;
	size_t count[TURNED + 1] = { 0 }, used = 0;
	for (size_t i = 0; i < half->points.count; i++) {
		if (kinds[i] == LEFT_OUT)
			continue;
		double found = gw_luminance(of_all->radiance + 3 * half->from[i]);
		double other = gw_luminance(of_half->radiance + 3 * i);
		square[kinds[i]] += (other - found) * (other - found);
		mean += found;
		mean_of_half += other;
		count[kinds[i]]++;
		used++;
	}
	double like_rest = near_like_rest(square, count);
	double most = fmax(mean, mean_of_half);
	double scale = most > 0.0 ? sqrt((double)used) / most : 0.0;
	return (gw_half_difference){ .turned = scale * sqrt(square[TURNED]),
								 .near = scale * sqrt(square[NEAR] - like_rest),
								 .rest = scale * sqrt(square[REST] + like_rest),
								 .turned_share = used ? (double)count[TURNED] / (double)used : 0.0,
								 .sides_asked = of_half->report.error.points > 0,
								 .sides = of_half->report.error.sides };
}

gw_status gw_half_sample_difference(const gw_point_subset *half, const gw_bake_result *of_half,
									const gw_bake_result *of_all, gw_half_difference *difference,
									gw_error *error)
{
	uint8_t *kinds = gw_allocate_array(half->points.count + 1, sizeof *kinds);
	bool good = kinds && list_kinds(half, of_half, of_all, kinds);
	if (good)
		*difference = sum_differences(half, of_half, of_all, kinds);
	free(kinds);
	return good ? GW_OK
				: gw_fail(error, GW_ERROR_MEMORY, "no memory to compare %zu points",
						  half->points.count);
}

/* ------------------------------------------------------------------------------------- adding */

double gw_half_difference_all(const gw_half_difference *difference)
{
	return hypot(hypot(difference->rest, difference->near), difference->turned);
}

static double growth_of(double first, double second)
{
	return first > 0.0 ? second / first : 0.0;
}

/* By how much the sides of the half are worse than those of all, by what rays say of both. */
static double growth_by_rays(const gw_half_difference *first, double sides)
{
	if (!first->sides_asked || !(first->turned_share > 0.0))
		return 1.0;
	double unseen = first->turned * first->turned / (first->turned_share * GW_SIDE_POINTS);
	return sqrt((first->sides * first->sides + unseen) / (sides * sides + unseen));
}

/* Of what differs by faults of both, what all points have of it. */
static double of_sides(double first, double growth)
{
	return first / hypot(1.0, fmax(growth, 1.0));
}

/* Of what differs by faults that get more in fewer points. */
static double of_surface(double first, double growth)
{
	return growth > M_SQRT2 ? first / sqrt(growth * growth - 1.0) : first;
}

void gw_half_sample_add(const gw_half_difference *first, const gw_half_difference *second,
						double gathered, gw_error_estimate *estimate)
{
	double growth = growth_of(gw_half_difference_all(first), gw_half_difference_all(second));
	double by_rays = growth_by_rays(first, estimate->sides);
	double surface = of_surface(first->rest, growth);
	/* The two have noise of their own, which is a part of the estimate already. */
	if (first->rest > 0.0)
		surface *= sqrt(fmax(1.0 - 2.0 * gathered * gathered / (first->rest * first->rest), 0.0));
	double turned = hypot(first->turned, first->near);
	double of_turned = growth_of(turned, hypot(second->turned, second->near));
	double sides = of_sides(turned, fmax(of_turned, by_rays));
	estimate->halves = hypot(surface, sides);
	/* Rays know of sides that are guessed alike in both, and of plates that both have. */
	double all = hypot(hypot(surface, fmax(sides, estimate->sides)),
					   hypot(hypot(estimate->gathered, estimate->gaps), estimate->narrow));
	estimate->relative_rms = fmax(estimate->relative_rms, all);
}

/*
 * half_sample.h - how wrong the light is because of which points happened to be scanned, by bakes
 * of half of them.
 *
 * All that rays can tell of an octree, of sides and of normals they tell of the surface that was
 * made of the points. Where noise, wires, leaves, edges and what hangs in the air made a surface
 * that is none, it is so for all rays alike. A surface made of half of the points has the same
 * faults, but larger and elsewhere. So half of the points are baked by themselves, and their light
 * is held against what they have among all.
 *
 * If errors fall as 1 / sqrt(n), and what all points tell is what the half tells and something
 * more, the two differ by as much as all differ from the truth (half-sample replication, McCarthy
 * 1969). Where errors fall faster, with d between all and the half and Q d between the half and
 * half of it, it is d / sqrt(Q^2 - 1). Where they fall more slowly nobody knows by how much,
 * because faults that stay whatever is left out do not show at all; d is taken as it is.
 *
 * A side that is guessed is right or wrong, and another guess it is with other points. Points that
 * show one side among all and the other one in the half are wrong in one of both, as likely in
 * either at the most: their square differences d^2 are the sum of two squares of errors, of which
 * that of all points is d^2 / (1 + Q^2), Q at least 1. So is what points beside them differ by more
 * than others do, as far as records stand apart: a point takes the light of the records around,
 * whose surface turned as well.
 *
 * How much worse the guesses of fewer points are, rays tell as well: both bakes are asked what is
 * wrong with their sides. With S of all and T of the half, Q is at least sqrt((T^2 + u) / (S^2 +
 * u)), where u is what one of the points that rays leave from, wrong where sides differ, would
 * make: rays may miss it.
 *
 * Sides that are guessed alike with all points and with half of them show in no difference, but in
 * what rays say of sides (side_error.h). Of both the larger one counts, and it comes on top of the
 * error at points that show the same side.
 *
 * Where points are few, light gets in that all points together shut out, and the half may be many
 * times as bright as all: differences are held against the brighter of the two.
 *
 * Of points in rows and columns every other column is left, so that they are rows and columns
 * still; of others those that their places' hash says, whatever their order.
 */
#ifndef HALF_SAMPLE_H
#define HALF_SAMPLE_H

#include "bake/point_subset.h"

/*
 * Is there doubt about the surface that such a bake could show? Not where all normals were given,
 * points are about as far apart everywhere, next to none lie on leaves or wires, and next to
 * nothing strays; but always where some of the points alone make the surface. Nobody makes one
 * beside a transport, whose light would come in less time than such a bake takes.
 */
bool gw_half_sample_is_wanted(const gw_points *points, const gw_bake_options *options,
							  const gw_report *report);

/* The same as far as it shows before a bake. */
bool gw_half_sample_is_likely(const gw_points *points, const gw_bake_options *options);

/* Those of a bake of half of these points, of which only the light is wanted, and where normals are
 * estimated what rays say of their sides. */
gw_bake_options gw_half_sample_options(const gw_points *points, const gw_bake_options *options);

/*
 * Takes half of the points.
 *   level   how many halves came before: 0, or 1 for half of a half
 *   half    to be freed with gw_point_subset_clear, also on failure
 * Fails with GW_ERROR_MEMORY.
 */
gw_status gw_half_sample_make(const gw_points *points, uint32_t level, gw_point_subset *half,
							  gw_error *error);

/* Root mean square differences of radiance, over its mean; the squares of the first three add up.
 */
typedef struct gw_half_difference {
	double turned;       /* at points that show the one side here and the other one there */
	double near;         /* at points beside these, more than at others */
	double rest;         /* at all others, and as much at those beside */
	double turned_share; /* of the points */
	bool sides_asked;    /* rays were asked about the half's sides */
	double sides;        /* what they say: its gw_error_estimate.sides */
} gw_half_difference;

/*
 * Between the half and what the same points have in the whole, of points that neither emit nor
 * stray.
 * Fails with GW_ERROR_MEMORY.
 */
gw_status gw_half_sample_difference(const gw_point_subset *half, const gw_bake_result *of_half,
									const gw_bake_result *of_all, gw_half_difference *difference,
									gw_error *error);

/* All parts together. */
double gw_half_difference_all(const gw_half_difference *difference);

/*
 * Takes the error of the surface up into an estimate.
 *   first     difference between all points and half of them
 *   second    the same between that half and half of it; zeros: not known
 *   gathered  error of gathered light in the bakes of halves
 */
void gw_half_sample_add(const gw_half_difference *first, const gw_half_difference *second,
						double gathered, gw_error_estimate *estimate);

#endif

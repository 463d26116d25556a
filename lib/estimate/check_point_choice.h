/*
 * check_point_choice.h - which points are solved again, and how much each of them counts.
 *
 * Most of a bake's square error lies in few places: where the records that speak for a point
 * disagree, and where the light changes within a few points. Points drawn evenly would seldom meet
 * them, and the mean over those few that do would be anything. So a point is drawn with a
 * probability that is a mixture: a third even, a third by how much its records disagree, a third by
 * how much its light differs from its neighbours'. What is found at a point counts by the inverse
 * of its probability (Horvitz and Thompson), so that the mean stays right whatever the shares are.
 *
 * Every point has a number of its own between 0 and 1, and is taken where that is small beside its
 * probability, until there are as many as wanted (sequential Poisson sampling, Ohlsson 1998). So
 * another lighting, with other probabilities, takes as many of the same points as it can: of those
 * it is known what they see (check_point_hits.h).
 */
#ifndef CHECK_POINT_CHOICE_H
#define CHECK_POINT_CHOICE_H

#include "light/read_back.h"
#include "cloud/surfels.h"

/* The mean over all points that count is about sum weight[i] * value(point[i]). */
typedef struct gw_check_point_choice {
	uint32_t count;
	uint32_t *point; /* count, ascending */
	double *weight;  /* count */
} gw_check_point_choice;

/* Points to draw from, and how. */
typedef struct gw_check_point_shares {
	size_t points;
	const bool *counts;        /* one a point: the others are never drawn */
	const double *const *part; /* part_count arrays of `points` numbers, at least 0, of any unit
								  each; each gets as much of the draws as the even part does. Of a
								  part no point has more than what makes it be drawn about once:
								  what a part of a few points can't take falls to the others */
	size_t part_count;
	double
		*room; /* NULL, or `points` numbers to write over: part[0], where nobody reads it again */
} gw_check_point_shares;

/*
 * Draws points by a mixture of shares.
 *   wanted   draws; where fewer points count, each is taken once
 *   choice   on success to be freed with gw_check_point_choice_clear
 */
gw_status gw_check_point_choose(const gw_check_point_shares *shares, uint32_t wanted, uint64_t seed,
								gw_check_point_choice *choice, gw_error *error);
void gw_check_point_choice_clear(gw_check_point_choice *choice);

/* What is known of the mean of a value over the points that count. */
typedef struct gw_check_point_mean {
	double mean;
	double variance; /* of it, by how much the draws differ; too large where all were taken */
} gw_check_point_mean;

/* value: choice->count, at the points drawn; at least 2 */
gw_check_point_mean gw_check_point_average(const gw_check_point_choice *choice,
										   const double *value);

/*
 * Mean square difference of a surfel's light from that of its neighbours on the same surface.
 *   light     one a surfel
 *   contrast  receives surfels->count numbers
 *   threads   as for gw_parallel_for
 */
void gw_check_point_contrast(const gw_surfels *surfels, const float *light, uint32_t threads,
							 double *contrast);

/*
 * Variance of a surfel's light, by how much its records disagree.
 *   light     one a record
 *   variance  receives rows->count numbers, in squares of the light's unit; 0 where no record is
 */
void gw_check_point_disagreement(const gw_read_back *rows, const double *light, uint32_t threads,
								 double *variance);

#endif

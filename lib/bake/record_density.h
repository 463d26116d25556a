/*
 * record_density.h - where more records would lessen the error most.
 *
 * Around a point, records that speak for it disagree: by the noise of what each gathered, and by
 * what the light changes from one to the next. With weights w and their variance V, the mean that
 * the point takes has the variance V sum w^2 (record_fields.h), whatever the cause, and n times as
 * many records make it n times smaller. Every record is handed the variance of the points that it
 * speaks for, m. Of all ways to bring the sum of m / n down to a wanted share, the one with the
 * fewest records makes n follow the root of m (Neyman's allocation), with n at least 1.
 */
#ifndef RECORD_DENSITY_H
#define RECORD_DENSITY_H

#include "bake/lighting.h"
#include "bake/record_steps.h"

/* How much denser records may get. */
typedef struct gw_density_wish {
	double share;       /* of the mean square error that may be left, above 0 */
	float least;        /* spacing that records keep in any case, leaf cells, above 0 */
	double most_growth; /* all records are to become at most so many times as many */
} gw_density_wish;

/*
 * By which factors records are to become more.
 *   mass     count, at least 0: how much of the square error is each one's
 *   most     count, at least 1: largest factor of each
 *   factor   receives count numbers from 1 to most
 * Returns the sum of mass / factor, relative to that of mass; 1 where there is none.
 */
double gw_density_factors(const double *mass, const float *most, size_t count,
						  const gw_density_wish *wish, float *factor);

/*
 * Finds where records of a lit scene are to stand closer, in its density, which is refined further
 * where there is one.
 *   growth   receives by which factor the records become about as many; 1 when they stand as close
 *            as they may, or nothing is lit
 */
gw_status gw_record_density_refine(const gw_lighting *lighting, const gw_density_wish *wish,
								   double *growth, gw_error *error);

#endif

/*
 * point_subset.h - some of the points, as a cloud of their own.
 */
#ifndef POINT_SUBSET_H
#define POINT_SUBSET_H

#include "glowworm.h"

typedef struct gw_point_subset {
	gw_points points; /* refers to the arrays below, and for the rest to what was given */
	size_t *from;     /* points.count, ascending: which point of all each is */
	double *position;
	float *normal, *albedo, *emission; /* NULL where all have none, and so the next */
	float *opacity, *own_area, *beam_share;
	uint32_t *scanner_of, *image_cell;
	gw_range_image *image;
	gw_object_instance *instance;
	uint8_t *stray;
	uint8_t *asked; /* NULL: all; those whose light is asked for */
} gw_point_subset;

/* Which points are taken. Of points in rows and columns every column and row whose number these
 * two divide, so that they are rows and columns still; of others those that `takes` says. */
typedef struct gw_subset_choice {
	uint32_t columns, rows; /* at least 1 */
	bool (*takes)(const void *user, size_t point);
	const void *user;
	bool instances; /* of an object in several places the same points in each, so that they are
					   instances still; else they are points like others */
} gw_subset_choice;

/*
 * Takes some of the points.
 *   subset   to be freed with gw_point_subset_clear, also on failure
 * Fails with GW_ERROR_MEMORY.
 */
gw_status gw_point_subset_make(const gw_points *points, const gw_subset_choice *choice,
							   gw_point_subset *subset, gw_error *error);

/* The image that a point is a cell of, or NULL. Points are asked about in ascending order.
 *   image   0 at first: the image after all those that end before the point */
const gw_range_image *gw_point_subset_image_of(const gw_points *points, size_t point,
											   size_t *image);

/* Asks for the light of those alone whose light is asked for among all.
 *   asked   one a point of all, or NULL: all; as gw_bake_result has it
 * Fails with GW_ERROR_MEMORY. */
gw_status gw_point_subset_ask(gw_point_subset *subset, const uint8_t *asked, gw_error *error);

void gw_point_subset_clear(gw_point_subset *subset);

/* Whether a point emits light. */
static inline bool gw_point_glows(const gw_points *points, size_t point)
{
	const float *e = points->emission ? points->emission + 3 * point : NULL;
	return e && (e[0] > 0.0f || e[1] > 0.0f || e[2] > 0.0f);
}

#endif

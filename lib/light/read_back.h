/*
 * read_back.h - the way from records to surfels: which records speak for a surfel, and how much. It
 * depends on the geometry alone, so it is found once; every light is then a sparse product.
 */
#ifndef READ_BACK_H
#define READ_BACK_H

#include "light/records.h"

/* A sparse matrix on the CPU, a row a surfel. */
typedef struct gw_read_back {
	size_t count;     /* surfels */
	uint32_t *first;  /* count + 1: where each row starts; rows of surfels with no record near are
						 empty */
	uint32_t *record; /* first[count] */
	float *weight;    /* first[count]; of a row they sum to 1 */
	uint32_t parted;  /* of so many records it was seen that none is in another compartment than its
						 row: rows_apart.h */
	bool lent;        /* the arrays are somebody else's, and stay as they are */
} gw_read_back;

/* Finds the rows of all surfels. On success *read_back is owned by the caller. */
gw_status gw_read_back_make(const gw_record_context *on, size_t surfel_count,
							gw_read_back *read_back, gw_error *error);

/*
 * Finds the rows of some surfels alone; those of the others are empty.
 *   reach    how far each surfel looks, a texel buffer R32_SFLOAT, 0 for the others
 *   asked    surfel_count: false for these
 */
gw_status gw_read_back_make_some(const gw_record_context *on, const gw_buffer *reach,
								 const bool *asked, size_t surfel_count, gw_read_back *read_back,
								 gw_error *error);

/*
 * Gives surfels whose rows are empty those of the facets that they lie in.
 *   facet   one a surfel: its facet, or GW_NONE
 * On failure the rows are as they were.
 */
gw_status gw_read_back_take_facets(const gw_record_context *on, const uint32_t *facet,
								   gw_read_back *read_back, gw_error *error);

/*
 * Finds the rows of some surfels again, after records were added; the others keep theirs.
 *   reach    how far each surfel looks, a texel buffer R32_SFLOAT, 0 for those that keep their rows
 *   closer   surfel count: false for those
 */
gw_status gw_read_back_again(const gw_record_context *on, const gw_buffer *reach,
							 const bool *closer, gw_read_back *read_back, gw_error *error);
void gw_read_back_clear(gw_read_back *read_back);

/*
 * Variance of the mean of the records that light a surfel, by how much they disagree.
 *   light    one a record, of any unit
 *   surfel   whose row has at least one record
 *   lonely   what it is, in squares of that mean, where one record speaks alone
 */
double gw_read_back_variance(const gw_read_back *read_back, const double *light, size_t surfel,
							 double lonely);

/*
 * Interpolates.
 *   records   4 floats a record; of the fourth nothing is read
 *   threads   0 means one a core
 *   surfels   receives 4 floats a surfel, the fourth 0
 */
void gw_read_back_apply(const gw_read_back *read_back, const float *records, uint32_t threads,
						float *surfels);

#endif

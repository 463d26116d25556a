/*
 * scan_thinning.h - some of the points of a scan that comes part by part: about as many as are
 * wanted, spread over its surface.
 *
 * One point is kept of each cube of a grid, or one of those in it that face the same of its sides
 * where the scan has normals. Which it is, a hash of its place says. While points come there is
 * room for twice as many as are kept in the end. When there is none left the grid gets coarser, by
 * as much as leaves half of them or more, and what is kept is thinned again, so that neither the
 * extent nor the number of the points has to be known; and in the end by as much as leaves what may
 * be kept, or of it more than 0.93. Points whose place is not finite are left out. What is kept is
 * the same by any number of threads: these look which points may be kept, and one after the other
 * those are.
 *
 * A point that is kept has all that it had in the scan, with which scanner saw it, but for
 * emission_r and its fellows where these are fractions: these become the mean of all points of its
 * cube, so that as much is emitted as before. A lamp of a few points would else be lost, or be as
 * large as a cube. Its albedo is that of one point of many hundred that together light another one,
 * which is no matter.
 */
#ifndef SCAN_THINNING_H
#define SCAN_THINNING_H

#include "points/scan.h"

/* What threads found out of the points of a part. */
typedef struct scan_thinning_part {
	size_t room;     /* points that there is room for */
	uint64_t *cube;  /* of each point */
	uint64_t *rank;  /* likewise */
	uint8_t *placed; /* 0: no place */
	uint8_t *wanted; /* 0: likewise, or a point that is kept goes before it */
	uint32_t *row;   /* rows that get a point of the part */
	size_t rows;
} scan_thinning_part;

/* Emission of all points of a cube. */
typedef struct scan_thinning_sum {
	double emission[3], points;
} scan_thinning_sum;

typedef struct scan_thinning {
	size_t most;      /* points to be kept, 1 or more */
	size_t room;      /* points that are kept meanwhile at most */
	uint32_t threads; /* 0: one a core */
	double width;     /* of the cubes, in units of the coordinates; 0: not known yet */
	scan kept;       /* columns of the parts, with room for `room` points; kept.count are there, and
					  * its other facts are those of the first part */
	uint64_t *cube;  /* one a point that is kept */
	uint64_t *rank;  /* likewise */
	uint64_t *wider; /* likewise: cubes of the next width */
	uint32_t *from;  /* likewise: 0, or 1 + the point that it is to become */
	uint64_t mask;   /* of the table: */
	uint32_t *slot;  /* 0: free; or 1 + the number of a point that is kept */
	uint64_t bits_mask; /* of the table by which cubes are counted: */
	_Atomic uint64_t *bits;
	scan_thinning_sum *emitted; /* one a point that is kept, of its cube; NULL: nothing emits */
	scan_thinning_part part;
} scan_thinning;

/* Nothing kept yet. most: 1 to 2^31. Given back with scan_thinning_clear. */
scan_thinning scan_thinning_begin(size_t most, uint32_t threads);

/*
 * Adds a part, which has the columns of those before it.
 * Fails with GW_ERROR_DATA where it has others or lacks x, y and z, with GW_ERROR_MEMORY.
 */
gw_status scan_thinning_add(scan_thinning *thinning, const scan *part, gw_error *error);

/* Hands over what was kept, as many as may be, in no order that means anything; the thinning is
 * empty then. cloud   to be freed with scan_clear */
void scan_thinning_take(scan_thinning *thinning, scan *cloud);

void scan_thinning_clear(scan_thinning *thinning);

#endif

/*
 * neighbour_scales.h - neighbours of a point's own scale, where its nearest ones are all on one
 * side because the cloud is much denser there. Internal to lib/.
 *
 * A sparse point beside a dense patch has its nearest neighbours in the patch. They say nothing of
 * the surface around it, which seems to end at the point. So the cloud is thinned, to one point a
 * cell of the point's own scale, and its neighbours are taken from there.
 */
#ifndef NEIGHBOUR_SCALES_H
#define NEIGHBOUR_SCALES_H

#include "cloud/neighbour_index.h"
#include "cloud/neighbours.h"

/* Neighbours that stay, of those nearest of all. */
#define GW_SCALED_NEAREST 4u

/* The cloud, thinned to cells of several widths; each is made when it is first asked for. */
typedef struct gw_neighbour_scales gw_neighbour_scales;

/*
 * Returns NULL when memory is short.
 *   surfels   unchanged until gw_neighbour_scales_close, as is
 *   all       the tree over them, times scale
 *   scale     that makes their positions about unit size, a power of two
 *   threads   to build trees on; 0 means one a processor
 */
gw_neighbour_scales *gw_neighbour_scales_open(const gw_surfels *surfels,
											  const gw_neighbour_index *all, double scale,
											  uint32_t threads);
void gw_neighbour_scales_close(gw_neighbour_scales *scales);

/*
 * Replaces the list of a surfel where it needs one of its own scale: all but the first
 * GW_SCALED_NEAREST, which list->complete then says. Does not touch lists of even clouds.
 *   list   the nearest neighbours, GW_NEIGHBOURS of them
 * Returns false when memory is short. Thread-safe.
 */
bool gw_neighbour_scales_widen(gw_neighbour_scales *scales, size_t surfel, gw_neighbour_list *list);

/*
 * The surfels nearest to one in the cloud thinned to cells of some width, or a little less.
 *   width   metres, above 0
 *   index   GW_NEIGHBOURS_WIDE, receives them, nearest first; the surfel itself is one where it was
 *           left
 *   count   receives how many there are, fewer where the thinned cloud has no more
 * Returns false when memory is short. Thread-safe.
 */
bool gw_neighbour_scales_around(gw_neighbour_scales *scales, size_t surfel, double width,
								uint32_t *index, uint32_t *count);

#endif

/*
 * compartments_kept.h - compartments among what a transport keeps (transport_blocks.h): the same
 * surface has the same ones whatever lights it, and to find them takes as long as the shadows of
 * a lamp.
 *
 * Those of a coarser octree are found again each time.
 */
#ifndef COMPARTMENTS_KEPT_H
#define COMPARTMENTS_KEPT_H

#include "octree/compartments.h"

/* What is known of them. */
typedef enum gw_compartments_known {
	GW_COMPARTMENTS_NOT_FOUND,
	GW_COMPARTMENTS_ONE,
	GW_COMPARTMENTS_SEVERAL,
} gw_compartments_known;

typedef struct gw_compartments_numbers {
	uint32_t known; /* gw_compartments_known; the rest is 0 but of several */
	uint32_t tiles; /* whose nodes are cells, with those of walls */
	uint32_t count;
} gw_compartments_numbers;

gw_compartments_numbers gw_compartments_numbers_of(const gw_octree *octree);

/* Whether they can be those of an octree of so many tiles. */
bool gw_compartments_numbers_fit(const gw_compartments_numbers *numbers, uint32_t tiles,
								 uint32_t leaf_tiles);

/*
 * Makes what these numbers say, without its arrays, as octree->compartments.
 *   octree   without compartments
 */
gw_status gw_compartments_restore(const gw_compartments_numbers *numbers, gw_octree *octree,
								  gw_error *error);

/* One of the arrays of several compartments. */
typedef struct gw_compartments_array {
	const char *name;
	void *array; /* address of the pointer to it */
	uint64_t bytes;
	bool labels; /* of compartments: below numbers->count or GW_COMPARTMENT_UNKNOWN */
} gw_compartments_array;

#define GW_COMPARTMENTS_ARRAYS 5

/* Lists them. There are several. */
void gw_compartments_list(gw_octree *octree, size_t surfels,
						  gw_compartments_array list[GW_COMPARTMENTS_ARRAYS]);

/* Whether arrays that come from a file can be walked through: from the root each tile is reached
 * once, none lies beyond their ends, and what lies around the scene is compartment 0. */
gw_status gw_compartments_fit(const gw_octree *octree, bool *fit, gw_error *error);

#endif

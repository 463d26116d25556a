/*
 * compartments.h - the empty space of an octree in compartments that surface keeps apart: a cave
 * and the sky above it, the rooms of a house whose doors are shut.
 *
 * Rays are held against planes and discs, and between those of random points some slip through. No
 * test of a single ray tells a gap between discs from a window; but all empty cells that touch each
 * other by their faces do. What starts in one compartment and ends in another one has gone through
 * rock, whatever the ray said. A hole wider than about two cells joins what lies on both sides of
 * it, so that windows stay open, and a scan with holes all over is one compartment. A narrower one
 * joins no rock, all of whose surface shows its back, with what other surface faces.
 *
 * Everything here is found on the host from whole numbers, or from each surfel by itself, so that
 * it is the same on every device and for any number of threads.
 */
#ifndef COMPARTMENTS_H
#define COMPARTMENTS_H

#include "device/passes.h"
#include "octree/octree.h"

/* A compartment that is not known: of a place in a wall, or amid surface. */
#define GW_COMPARTMENT_UNKNOWN 0xffffffffu

typedef struct gw_compartments gw_compartments;

/*
 * Finds the compartments, and which of them surfels look into; does nothing
 * where that is known. Where all look into the same one, nothing is kept but that.
 *   octree    of these surfels; receives them as octree->compartments
 *   threads   0: one a processor
 */
gw_status gw_compartments_find(gw_gpu *gpu, const gw_surfels *surfels, uint32_t threads,
							   gw_octree *octree, gw_error *error);
void gw_compartments_destroy(gw_compartments **compartments); /* sets it to NULL; accepts NULL */

/* Is an octree so much deeper than its points ask for that a coarser one has its compartments? */
bool gw_compartments_are_coarser(const gw_octree *octree, const gw_surfels *surfels);

/* Is there more than one, so that it is worth asking? An octree that was not asked has one. */
bool gw_compartments_several(const gw_octree *octree);

/* How many there are, numbered from 0. There are several. */
uint32_t gw_compartments_count(const gw_octree *octree);

/* Are two known, and not the same? */
static inline bool gw_compartments_apart(uint32_t label, uint32_t other)
{
	return label != other && label != GW_COMPARTMENT_UNKNOWN && other != GW_COMPARTMENT_UNKNOWN;
}

/* What passes know a compartment by: 0 where it is not known, GW_MARK_OUTSIDE (transport_layout.h)
 * of what lies around the scene. */
static inline uint32_t gw_compartment_mark(uint32_t label)
{
	return label == GW_COMPARTMENT_UNKNOWN ? 0 : label + 1;
}

/* The compartment of all that lies around the scene: the sky's and the sun's. Its number is 0.
 * There are several. */
uint32_t gw_compartment_outside(const gw_octree *octree);

/* That of a place. There are several. */
uint32_t gw_compartment_at(const gw_octree *octree, const float g[3]);

/* That which a surfel looks into from its front or, if it is two-sided, from its back. There are
 * several. */
uint32_t gw_compartment_of_surfel(const gw_octree *octree, size_t surfel, bool back);

/* Places on the surface. */
typedef struct gw_surface_places {
	size_t count;
	const float *place;  /* 4 * count, grid coordinates */
	const float *normal; /* 4 * count, unit */
} gw_surface_places;

/* That which places look into along their normals. There are several.
 *   passes    whose device and number of threads are used
 *   label     of->count, receives them */
gw_status gw_compartments_of_places(const gw_passes *passes, const gw_octree *octree,
									const gw_surface_places *of, uint32_t *label, gw_error *error);

/* That which each facet faces, facet_count; unknown for those with two sides. There are several. */
const uint32_t *gw_compartments_of_facets(const gw_octree *octree);

#endif

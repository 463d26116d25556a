/*
 * bake_memory.h - what a bake takes of the host's memory, foretold once its octree stands.
 *
 * By then everything that grows with the points is known by its number: surfels, with their backs,
 * and facets, of which noise makes many. Records, what is read back from them, direct light and
 * estimate go with these. So what a bake takes at most is, beside the program and the points that
 * it is given,
 *
 *     fixed + max(surfel * surfels + facet * facets, least * surfels) + subset * points
 *
 * where the last is of bakes of some of more points, and what is of facets grows less than the
 * points of large clouds do, whose leaves get wider with them (GW_LEAF_SPACING). A surfel takes
 * more where lamps shine, and where normals are estimated, as the error estimate asks then which
 * surfaces hang together. The numbers are in bake_memory.c, fitted to what bakes of twenty scenes
 * took, from a box to random points, none of which took more than is foretold. Nothing is measured
 * while it runs, so that the same points make the surface each time.
 */
#ifndef BAKE_MEMORY_H
#define BAKE_MEMORY_H

#include "glowworm.h"

/* What the memory of a bake depends on. */
typedef struct gw_memory_facts {
	uint64_t points; /* that it is of */
	uint64_t surfels, facets;
	bool subset;    /* the points are some of more, and copies */
	bool lamps;     /* some shine */
	bool estimated; /* normals are */
	bool widening;  /* leaves are as wide as GW_LEAF_SPACING_AUTO says for rays */
} gw_memory_facts;

/* Whether these settings are such that it depends on nothing else: rays, no more of them and no
 * more records than by default, and neither an error nor a time until which records are added. */
bool gw_bake_memory_is_known(const gw_bake_options *options);

/* The facts of a bake that has not begun: as many surfels and facets as most caves have, which
 * is more than of rooms and less than of noise. */
gw_memory_facts gw_bake_memory_guess(const gw_scene_description *scene,
									 const gw_bake_options *options, bool subset);

/* The same of so many points, all with normals or none, and all that there are. */
gw_memory_facts gw_bake_memory_usual(uint64_t points, bool normals, bool lamps,
									 const gw_bake_options *options);

/* Bytes that it takes at most. */
uint64_t gw_bake_memory(const gw_memory_facts *facts);

/* Bytes that a bake of half of the points takes beside it, to foretell the error. */
uint64_t gw_bake_memory_of_half(const gw_memory_facts *facts);

/* Of how many points a bake would take so many bytes, with as much of all else a point but for what
 * wider leaves save; each takes `given` of these, too. */
uint64_t gw_bake_memory_points(const gw_memory_facts *facts, uint64_t bytes, double given);

/* How many times as many records as now a bake may have that takes as much as was foretold, and may
 * take so many bytes.
 *   records   bytes of these, on the device */
double gw_bake_memory_growth(uint64_t foretold, uint64_t bytes, uint64_t records);

/* How much a bake may take, and whether it would take more. */
typedef struct gw_memory_ceiling {
	uint64_t bytes;    /* beside the program and the points */
	uint64_t least;    /* of fewer points no bake is worth it */
	uint64_t foretold; /* receives what is foretold; 0: nothing yet */
	uint64_t fit;      /* receives 0; or where that is more than it may, of how many points a bake
						  takes no more, if so many are worth it: then this one ends with
						  GW_ERROR_MEMORY */
} gw_memory_ceiling;

#endif

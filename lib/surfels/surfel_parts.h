/*
 * surfel_parts.h - surfels of a scene in which some points move, or stand where others do: each
 * mover's are made once, by themselves, and moved with it; those of all that stands still are made
 * once and stay.
 *
 * No part has neighbours in another, so that an object that passes alters nothing of what it
 * passes: not the regions of influence, not the discs, not the normals.
 */
#ifndef SURFEL_PARTS_H
#define SURFEL_PARTS_H

#include "cloud/surfels.h"

typedef struct gw_surfel_parts {
	size_t still;     /* so many surfels stand still; those of the movers come after, in order */
	size_t own_count; /* movers */
	gw_surfels *own;  /* own_count: of each mover, where gw_points has it; empty of those that have
						 another's */
	size_t *of;       /* own_count: whose surfels each has */
} gw_surfel_parts;

/*
 * Makes the surfels of all parts.
 *   motion   whose movers and frames gw_motion_check has accepted
 *   parts    on success freed with gw_surfel_parts_clear; zeroed on failure
 *   surfels  on success all surfels, movers where gw_points has them, freed with gw_surfels_clear;
 *            its bounds hold the movers of every frame, its origin is that of what stands still
 * Fails as gw_surfels_make.
 */
gw_status gw_surfel_parts_make(const gw_points *points, const gw_motion *motion,
							   const gw_surfels_options *options, gw_surfel_parts *parts,
							   gw_surfels *surfels, gw_error *error);
void gw_surfel_parts_clear(gw_surfel_parts *parts);

/* Puts the movers where a frame has them. Lengths and areas follow the matrix's scale. */
void gw_surfel_parts_move(const gw_surfel_parts *parts, const gw_motion *motion, size_t frame,
						  gw_surfels *surfels);

/*
 * Makes the surfels of a scene in which nothing moves. Those of an object that stands in several
 * places (gw_points.instance) are made once.
 * Fails as gw_surfels_make; GW_ERROR_USAGE and GW_ERROR_DATA when instances are not what they say.
 */
gw_status gw_placed_surfels_make(const gw_points *points, const gw_surfels_options *options,
								 gw_surfels *surfels, gw_error *error);

/* GW_ERROR_USAGE when movers overlap or leave the points; GW_ERROR_DATA when a matrix does more
 * than turn, mirror, move and scale evenly, or flattens. */
gw_status gw_motion_check(const gw_points *points, const gw_motion *motion, gw_error *error);

#endif

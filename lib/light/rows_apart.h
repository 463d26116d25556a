/*
 * rows_apart.h - no record lights facets or surfels that rock keeps apart from it.
 *
 * A record speaks for what lies near it, unless a ray between both meets something. Rays find ways
 * through rock at times, and where no record is near in sight the nearest is taken: in two rooms
 * beside each other that may be one of the other room. So rows lose what is of another compartment
 * (octree/compartments.h) than theirs; those that have nothing else get the nearest record of it.
 */
#ifndef ROWS_APART_H
#define ROWS_APART_H

#include "light/read_back.h"

/*
 * Parts the rows of facets, in on->records, and of surfels; does nothing where there is one
 * compartment, or where it was done for these records already.
 */
gw_status gw_rows_part(const gw_record_context *on, gw_read_back *read_back, gw_error *error);

#endif

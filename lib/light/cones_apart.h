/*
 * cones_apart.h - bounces by cones where rock keeps empty space apart. Cones widen, and what they
 * read then is the mean of all that lies in a coarse voxel, on whatever side of a wall; so each
 * compartment (octree/compartments.h) is gathered by itself, from what faces it.
 */
#ifndef CONES_APART_H
#define CONES_APART_H

#include "light/gather_cones.h"

/*
 * One bounce as by gw_cone_gather_bounce, which is all of it where the octree has one compartment,
 * or was not asked. Else records gather from facets that look into the same compartment as they do,
 * and from the sky if that is the one around the scene; those of which it is not known, from all.
 */
gw_status gw_cones_apart_bounce(const gw_record_context *on, gw_cone_gather *gather,
								gw_facet_radiance radiance, const float sky[3], gw_buffer *gathered,
								gw_error *error);

#endif

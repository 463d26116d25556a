/*
 * volume_labels.h - the compartment of empty space (octree/compartments.h) that each cell of a
 * radiance volume gathers the light of.
 *
 * A cell whose centre lies in a wall is in none, and sees what its rays slip into: both sides of a
 * thin wall. Places of both would read it, and so light would get through. Each such cell belongs
 * to the compartment of which its rays meet most.
 */
#ifndef VOLUME_LABELS_H
#define VOLUME_LABELS_H

#include "light/radiance_volume.h"

/*
 * Labels the cells that are listed, in volume->label; does nothing where there is one compartment.
 *   met   volume->rays a cell: the facets whose fronts they meet first, or GW_VOLUME_MET_...
 */
gw_status gw_volume_label_cells(const gw_record_context *on, const uint32_t *met,
								gw_radiance_volume *volume, gw_error *error);

#endif

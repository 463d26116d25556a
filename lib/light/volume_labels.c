/*
 * volume_labels.c - see volume_labels.h.
 */
#include "light/volume_labels.h"

#include "base/memory.h"
#include "light/volume_cells.h"
#include "octree/compartments.h"

/* The compartment that a ray met, or GW_COMPARTMENT_UNKNOWN. */
static uint32_t label_met(const gw_octree *octree, uint32_t met)
{
	if (met == GW_VOLUME_MET_NOTHING)
		return gw_compartment_outside(octree);
	return met == GW_VOLUME_MET_BACK ? GW_COMPARTMENT_UNKNOWN
									 : gw_compartments_of_facets(octree)[met];
}

/* That which most rays met: of several as many the one that was met first. */
static uint32_t label_met_most(const gw_octree *octree, const uint32_t *met, uint32_t rays)
{
	uint32_t winner = GW_COMPARTMENT_UNKNOWN, most = 0;
	for (uint32_t i = 0; i < rays; i++) {
		uint32_t label = label_met(octree, met[i]), votes = 0;
		for (uint32_t k = i; k < rays && label != GW_COMPARTMENT_UNKNOWN; k++)
			votes += label_met(octree, met[k]) == label;
		if (votes > most) {
			most = votes;
			winner = label;
		}
	}
	return winner;
}

gw_status gw_volume_label_cells(const gw_record_context *on, const uint32_t *met,
								gw_radiance_volume *v, gw_error *error)
{
	if (!gw_compartments_several(on->octree))
		return GW_OK;
	v->label = gw_allocate_array(v->count, sizeof *v->label);
	if (!v->label)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %u cells of a volume", v->count);
	for (size_t i = 0; i < v->count; i++) {
		float centre[3];
		gw_volume_centre(v, v->cell[i], centre);
		v->label[i] = gw_compartment_at(on->octree, centre);
		if (v->label[i] == GW_COMPARTMENT_UNKNOWN)
			v->label[i] = label_met_most(on->octree, met + v->rays * i, v->rays);
	}
	return GW_OK;
}

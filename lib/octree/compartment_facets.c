/*
 * compartment_facets.c - facets of surfels that look into several compartments; see compartments.h.
 *
 * A leaf has two facets at most. Where a wall is thinner than leaves are wide, and more so where
 * three of its sides meet, surface of rooms that the wall keeps apart lies in one facet. Its light
 * would be theirs together, and each would see what shines in the other one. So a facet has the
 * light of those of its surfels alone that look into its own compartment: the others weigh nothing.
 */
#include "octree/compartments_steps.h"

#include "base/memory.h"
#include "cloud/frame.h"
#include "octree/octree_layout.h"

#include <stdlib.h>

/* Buffers in which parting writes. */
#define EDITS 3

/* Facets being parted. */
typedef struct parting {
	const gw_surfels *surfels;
	const gw_octree *octree;
	const uint32_t *leaf, *first, *fragment;
	float *weight;   /* one a fragment */
	float *centre;   /* 4 a facet, area last */
	float *emission; /* 4 a facet; NULL where nothing emits */
	uint32_t parted; /* facets so far */
} parting;

/* Does a surfel look into another compartment than its facet, to whatever side? */
static bool looks_elsewhere(const parting *p, size_t surfel, uint32_t label)
{
	return gw_compartments_apart(gw_compartment_of_surfel(p->octree, surfel, false), label) &&
		   gw_compartment_of_surfel(p->octree, surfel, true) != label;
}

/* Takes its weight from a facet's fragments that are of other compartments. */
static bool leave_out(const parting *p, size_t facet)
{
	uint32_t label = gw_compartments_of_facets(p->octree)[facet];
	size_t leaf = gw_facet_leaf(p->leaf[facet]);
	bool any = false;
	for (uint32_t f = p->first[leaf]; f < p->first[leaf + 1]; f++) {
		if (p->weight[f] == 0.0f || !gw_facet_holds(p->leaf[facet], p->fragment[f]) ||
			!looks_elsewhere(p, p->fragment[f] & GW_FRAGMENT_SURFEL, label))
			continue;
		p->weight[f] = 0.0f;
		any = true;
	}
	return any;
}

/* Makes a facet's area and emission those of the surfels that still weigh something. */
static void add_up_again(const parting *p, size_t facet)
{
	size_t leaf = gw_facet_leaf(p->leaf[facet]);
	double sum[4] = { 0 };
	for (uint32_t f = p->first[leaf]; f < p->first[leaf + 1]; f++) {
		if (!gw_facet_holds(p->leaf[facet], p->fragment[f]))
			continue;
		size_t surfel = p->fragment[f] & GW_FRAGMENT_SURFEL;
		sum[3] += (double)p->weight[f];
		for (size_t c = 0; c < 3 && p->emission; c++)
			sum[c] += (double)p->weight[f] * (double)p->surfels->emission[3 * surfel + c];
	}
	p->centre[4 * facet + 3] = (float)sum[3];
	for (size_t c = 0; c < 3 && p->emission; c++)
		p->emission[4 * facet + c] = sum[3] > 0.0 ? (float)(sum[c] / sum[3]) : 0.0f;
}

static gw_status part_all(gw_gpu *gpu, parting *p, gw_error *error)
{
	const gw_octree *o = p->octree;
	gw_view leaf = { 0 }, first = { 0 }, fragment = { 0 };
	gw_status status =
		gw_view_open(gpu, &o->leaf_fragment, 4 * ((uint64_t)o->leaf_count + 1), &first, error);
	if (status == GW_OK)
		status = gw_view_open(gpu, &o->facet_leaf, 4 * (uint64_t)o->facet_count, &leaf, error);
	if (status == GW_OK)
		status = gw_view_open(gpu, &o->fragment_surfel, 4 * (uint64_t)o->fragment_count, &fragment,
							  error);
	p->leaf = leaf.bytes;
	p->first = first.bytes;
	p->fragment = fragment.bytes;
	for (size_t facet = GW_FACET_EMPTY + 1; facet < o->facet_count && status == GW_OK; facet++) {
		if (!leave_out(p, facet))
			continue;
		add_up_again(p, facet);
		p->parted++;
	}
	gw_view_close(&fragment);
	gw_view_close(&first);
	gw_view_close(&leaf);
	return status;
}

gw_status gw_compartments_part_facets(gw_gpu *gpu, const gw_surfels *surfels, gw_octree *octree,
									  gw_error *error)
{
	gw_buffer *const buffer[EDITS] = { &octree->fragment_weight, &octree->facet_centre,
									   &octree->facet_emission };
	const int edits = gw_surfels_emit(surfels) ? EDITS : EDITS - 1;
	gw_edit edit[EDITS] = { 0 };
	gw_status status = GW_OK;
	for (int i = 0; i < edits && status == GW_OK; i++)
		status = gw_edit_open(gpu, buffer[i], &edit[i], error);
	parting p = { .surfels = surfels,
				  .octree = octree,
				  .weight = edit[0].bytes,
				  .centre = edit[1].bytes,
				  .emission = edit[2].bytes };
	if (status == GW_OK)
		status = part_all(gpu, &p, error);
	for (int i = 0; i < edits; i++) {
		gw_status closed = gw_edit_close(gpu, &edit[i], status == GW_OK && p.parted > 0, error);
		status = status == GW_OK ? closed : status;
	}
	return status;
}

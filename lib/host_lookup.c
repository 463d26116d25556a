/*
 * host_lookup.c - see host_lookup.h.
 */
#include "host_lookup.h"

#include "host_loop.h"

#define CHUNK 512u /* points that a thread takes at a time */

/* The first ten bindings of both. */
#define LOOKUP_BINDINGS                                                                            \
	GW_TRACE_BINDINGS(octree), gw_whole(&octree->level_directory), gw_whole(&records->position),   \
		gw_whole(&records->normal), gw_whole(&records->block_first),                               \
		gw_whole(&records->block_record)

void gw_host_weigh_lobes(gw_passes *passes, const gw_octree *octree, gw_records *records,
						 const gw_buffer *reach, const gw_lookup_push *push)
{
	const gw_binding bindings[] = { LOOKUP_BINDINGS, gw_whole(&records->lobe_record),
									gw_whole(&records->lobe_weight),
									gw_whole(reach ? reach : &records->position),
									GW_TREE_BINDING(octree) };
	gw_lookup_push all = *push;
	all.count = UINT32_MAX;
	const gw_host_pass pass = { GW_PASS_LOBE_WEIGHTS, gw_kernel_lobe_weights, bindings, &all,
								NULL };
	gw_host_run(passes, &pass, 2 * (size_t)octree->leaf_count, CHUNK);
}

void gw_host_weigh_surfels(gw_passes *passes, const gw_octree *octree, const gw_records *records,
						   const gw_buffer *reach, const gw_lookup_push *push, size_t count,
						   gw_buffer *record, gw_buffer *weight)
{
	const gw_binding bindings[] = { LOOKUP_BINDINGS,
									gw_whole(&octree->surfel_position),
									gw_whole(&octree->surfel_normal),
									gw_whole(record),
									gw_whole(weight),
									gw_whole(reach ? reach : &records->position),
									GW_TREE_BINDING(octree) };
	gw_lookup_push all = *push;
	all.count = UINT32_MAX;
	const gw_host_pass pass = { GW_PASS_READ_BACK, gw_kernel_read_back, bindings, &all, NULL };
	gw_host_run(passes, &pass, count, CHUNK);
}

/*
 * cpu_kernels.c - the CPU kernels of the light's passes: what a shader's bindings and push
 * constants hold, given to the loop that does the same (host_rays.h, host_lookup.h,
 * host_products.h). Numbers in brackets are bindings, as the shader lists them.
 */
#include "light/host_lookup.h"
#include "light/host_products.h"
#include "light/host_rays.h"
#include "octree/octree_bindings.h"

#include <assert.h>

/* ------------------------------------------------------------------------------------- lamps */

void gw_cpu_light_visibility(gw_passes *passes, const gw_binding *b, const void *push,
							 uint64_t count)
{
	gw_octree octree = gw_octree_of_bindings(passes, b, b + 8, b + 14);
	gw_host_light_visibility(passes, &octree, push, b[6].buffer, (size_t)count, b[7].buffer);
}

void gw_cpu_light_irradiance(gw_passes *passes, const gw_binding *b, const void *push,
							 uint64_t count)
{
	gw_octree octree = { .surfel_position = *b[0].buffer };
	gw_host_light_irradiance(passes, &octree, push, b[1].buffer, b[2].buffer, (size_t)count,
							 b[3].buffer);
}

void gw_cpu_lobe_direct(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	gw_octree octree = { .leaf_count = (uint32_t)(count / 2),
						 .leaf_fragment = *b[0].buffer,
						 .fragment_surfel = *b[1].buffer,
						 .fragment_weight = *b[2].buffer };
	(void)push;
	gw_host_average(passes, &octree, b[3].buffer, b[4].buffer);
}

/* ------------------------------------------------------------------------------------ records */

/* So many records, whose positions and normals are two bindings next to each other. */
static gw_records records_of(const gw_binding *place, uint64_t count)
{
	return (gw_records){ .count = (uint32_t)count,
						 .position = *place[0].buffer,
						 .normal = *place[1].buffer };
}

void gw_cpu_record_rays(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	const gw_record_push *p = push;
	gw_octree octree = gw_octree_of_bindings(passes, b, b + 9, b + 15);
	gw_records records = records_of(b + 5, count / p->rays);
	gw_ray_gather gather = {
		.rays = p->rays, .seed = p->seed, .lobe = *b[7].buffer, .distance = *b[8].buffer
	};
	gw_host_record_rays(passes, &octree, &records, &gather);
}

void gw_cpu_record_again(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	const gw_keep_push *p = push;
	gw_octree octree = gw_octree_of_bindings(passes, b, b + 10, b + 16);
	gw_records records = records_of(b + 5, 0);
	gw_ray_gather gather = {
		.rays = p->rays, .seed = p->seed, .lobe = *b[8].buffer, .distance = *b[9].buffer
	};
	gw_host_record_again(passes, &octree, &records, b[7].buffer, (uint32_t)count, &gather);
}

void gw_cpu_record_emitters(gw_passes *passes, const gw_binding *b, const void *push,
							uint64_t count)
{
	gw_octree octree = gw_octree_of_bindings(passes, b, b + 11, b + 17);
	gw_records records = records_of(b + 7, count);
	const gw_emitters emitters = { .radiance = b[5].buffer, .table = *b[6].buffer };
	const gw_sampled_sources sources = { .emitters = &emitters, .part = b[10].buffer };
	gw_host_record_emitters(passes, &octree, &records, &sources, push, b[9].buffer);
}

void gw_cpu_record_sky(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	gw_octree octree = gw_octree_of_bindings(passes, b, b + 10, b + 17);
	gw_records records = records_of(b + 7, count);
	const gw_sky_map map = { .texel = *b[5].buffer, .alias = *b[6].buffer };
	gw_host_record_sky(passes, &octree, &records, &map, push, b[9].buffer);
}

void gw_cpu_record_first(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	gw_octree octree = { .lobe_plane = *b[2].buffer };
	gw_records records = records_of(b + 5, count);
	const gw_ray_gather gather = { .lobe = *b[0].buffer, .distance = *b[1].buffer };
	const gw_emitters emitters = { .radiance = b[3].buffer };
	const gw_sampled_sources sources = { .emitters = &emitters, .part = b[8].buffer };
	gw_host_record_first(passes, &octree, &records, &gather, &sources, push, b[4].buffer,
						 b[7].buffer);
}

void gw_cpu_record_gather(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	const gw_ray_gather gather = { .rays = ((const gw_record_push *)push)->rays,
								   .lobe = *b[0].buffer };
	gw_records records = { .count = (uint32_t)count,
						   .normal = *b[2].buffer,
						   .gathered = *b[3].buffer };
	gw_host_gather(passes, &gather, b[1].buffer, &records);
}

void gw_cpu_record_add(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	(void)push;
	gw_host_add(passes, b[0].buffer, b[1].buffer, count);
}

/* ------------------------------------------------------------------------ lobes and surfels */

void gw_cpu_lobe_shade(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	gw_octree octree = { .leaf_count = (uint32_t)(count / 2), .lobe_albedo = *b[0].buffer };
	const gw_records records = { .lobe_record = *b[2].buffer, .lobe_weight = *b[3].buffer };
	gw_host_shade(passes, &octree, &records, b[4].buffer, b[1].buffer,
				  ((const gw_record_push *)push)->direct_share, b[5].buffer);
}

/* What both look-ups begin with. */
static gw_records listed_records(const gw_binding *b)
{
	gw_records records = records_of(b + 6, 0);
	records.block_first = *b[8].buffer;
	records.block_record = *b[9].buffer;
	return records;
}

static gw_octree leveled_octree(const gw_passes *passes, const gw_binding *b,
								const gw_binding *tree)
{
	gw_octree octree = gw_octree_of_bindings(passes, b, NULL, tree);
	octree.level_directory = *b[5].buffer;
	return octree;
}

void gw_cpu_lobe_weights(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	gw_octree octree = leveled_octree(passes, b, b + 13);
	gw_records records = listed_records(b);
	octree.leaf_count = (uint32_t)(count / 2);
	records.lobe_record = *b[10].buffer;
	records.lobe_weight = *b[11].buffer;
	gw_host_weigh_lobes(passes, &octree, &records, b[12].buffer, push);
}

void gw_cpu_read_back(gw_passes *passes, const gw_binding *b, const void *push, uint64_t count)
{
	gw_octree octree = leveled_octree(passes, b, b + 15);
	gw_records records = listed_records(b);
	octree.surfel_position = *b[10].buffer;
	octree.surfel_normal = *b[11].buffer;
	gw_host_weigh_surfels(passes, &octree, &records, b[14].buffer, push, (size_t)count,
						  b[12].buffer, b[13].buffer);
}

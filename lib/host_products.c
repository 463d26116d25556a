/*
 * host_products.c - see host_products.h.
 */
#include "host_products.h"

#include "clock.h"
#include "memory.h"
#include "parallel.h"
#include "transport_layout.h"

#include <math.h>
#include <stdlib.h>

#define CHUNK 4096u       /* lobes, leaves or sums that a thread takes at a time */
#define CHUNK_RAYS 65536u /* that a thread follows at a time */
#define FRAGMENTS 1024u   /* of a leaf, at most about so many count: as lobe_direct.comp */
#define BUFFERS_MAX 7u

static const float pi = 3.14159265358979f;

typedef float vec4_lanes __attribute__((vector_size(16)));

/* Buffers that one loop reads and writes, and where they are; NULL for none. */
typedef struct mapping {
	const gw_buffer *buffer[BUFFERS_MAX];
	void *at[BUFFERS_MAX];
} mapping;

static gw_status map_all(gw_gpu *gpu, mapping *m, gw_error *error)
{
	gw_status status = GW_OK;
	for (size_t i = 0; i < BUFFERS_MAX && status == GW_OK; i++)
		if (m->buffer[i])
			status = gw_buffer_map(gpu, m->buffer[i], &m->at[i], error);
	return status;
}

static void unmap_all(gw_gpu *gpu, const mapping *m)
{
	for (size_t i = 0; i < BUFFERS_MAX; i++)
		if (m->at[i])
			gw_buffer_unmap(gpu, m->buffer[i]);
}

/* Maps the buffers, runs the loop over `count` elements and books its time. `job` begins with the
 * mapping. */
static gw_status run(gw_passes *passes, gw_pass_id id, size_t count, size_t chunk,
					 gw_parallel_work *work, mapping *job, gw_error *error)
{
	double start = gw_seconds();
	gw_status status = map_all(passes->gpu, job, error);
	if (status == GW_OK)
		gw_parallel_for(passes->threads, count, chunk, work, job);
	unmap_all(passes->gpu, job);
	passes->device_seconds[id] += gw_seconds() - start;
	return status;
}

/* ----------------------------------------------------------------------------------- shading */

enum { ALBEDO, RECORD, WEIGHT, IRRADIANCE, RADIANCE, DIRECT, AREA };

typedef struct shading {
	mapping map;
	float direct_share;
	const uint32_t *slot; /* NULL: all */
} shading;

static void shade(void *user, size_t first, size_t last, uint32_t worker)
{
	const shading *job = user;
	void *const *at = job->map.at;
	const vec4_lanes *albedo = at[ALBEDO], *irradiance = at[IRRADIANCE], *direct = at[DIRECT];
	vec4_lanes *radiance = at[RADIANCE];
	(void)worker;
	for (size_t n = first; n < last; n++) {
		size_t i = job->slot ? job->slot[n] : n;
		const uint32_t *record = (const uint32_t *)at[RECORD] + GW_WEIGHTS * i;
		const float *weight = (const float *)at[WEIGHT] + GW_WEIGHTS * i;
		vec4_lanes sum = { 0 };
		if (direct)
			sum = job->direct_share * direct[i];
		for (size_t k = 0; k < GW_WEIGHTS && record[k] != GW_NONE; k++)
			sum += weight[k] * irradiance[record[k]];
		radiance[i] = albedo[i] * sum / pi;
		radiance[i][3] = 0.0f;
	}
}

gw_status gw_host_shade(gw_passes *passes, const gw_octree *octree, const gw_records *records,
						const gw_buffer *records_irradiance, const gw_buffer *lobe_direct,
						float direct_share, gw_buffer *lobe_radiance, gw_error *error)
{
	shading job = { .map.buffer = { [ALBEDO] = &octree->lobe_albedo,
									[RECORD] = &records->lobe_record,
									[WEIGHT] = &records->lobe_weight,
									[IRRADIANCE] = records_irradiance,
									[RADIANCE] = lobe_radiance,
									[DIRECT] = direct_share != 0.0f ? lobe_direct : NULL },
					.direct_share = direct_share };
	return run(passes, GW_PASS_LOBE_SHADE, 2 * (size_t)octree->leaf_count, CHUNK, shade, &job.map,
			   error);
}

/* --------------------------------------------------------------------------- lobes that are hit */

#define POWER_PARTS 8u /* sums of power that are made apart, so that threads do not matter */

typedef struct powers {
	mapping map;
	size_t records;
	double *power; /* 3 a record and part */
	size_t part;   /* slots of a part */
} powers;

static void add_powers(void *user, size_t first, size_t last, uint32_t worker)
{
	const powers *job = user;
	void *const *at = job->map.at;
	const float *albedo = at[ALBEDO], *centre = at[AREA];
	double *power = job->power + 3 * job->records * (first / job->part);
	(void)worker;
	for (size_t i = first; i < last; i++) {
		const uint32_t *record = (const uint32_t *)at[RECORD] + GW_WEIGHTS * i;
		const float *weight = (const float *)at[WEIGHT] + GW_WEIGHTS * i;
		const double area = (double)centre[4 * i + 3];
		const double share[3] = { 0.2126 * area * (double)albedo[4 * i],
								  0.7152 * area * (double)albedo[4 * i + 1],
								  0.0722 * area * (double)albedo[4 * i + 2] };
		for (size_t k = 0; k < GW_WEIGHTS && record[k] != GW_NONE; k++)
			for (size_t c = 0; c < 3; c++)
				power[3 * (size_t)record[k] + c] += share[c] * (double)weight[k];
	}
}

static gw_status find_powers(gw_passes *passes, const gw_octree *octree, const gw_records *records,
							 gw_hit_lobes *hits, gw_error *error)
{
	size_t slots = 2 * (size_t)octree->leaf_count, values = 3 * (size_t)records->count;
	powers job = { .map.buffer = { [ALBEDO] = &octree->lobe_albedo,
								   [RECORD] = &records->lobe_record,
								   [WEIGHT] = &records->lobe_weight,
								   [AREA] = &octree->lobe_centre },
				   .records = records->count,
				   .power = gw_allocate_zeros(values, POWER_PARTS * sizeof *job.power),
				   .part = slots / POWER_PARTS + 1 };
	hits->power = gw_allocate_array(values, sizeof *hits->power);
	gw_status status = GW_OK;
	if (!job.power || !hits->power)
		status = gw_fail(error, GW_ERROR_MEMORY, "no host memory for %u records", records->count);
	if (status == GW_OK)
		status = run(passes, GW_PASS_LOBE_SHADE, slots, job.part, add_powers, &job.map, error);
	for (size_t i = 0; i < values && status == GW_OK; i++) {
		double sum = 0.0;
		for (size_t part = 0; part < POWER_PARTS; part++)
			sum += job.power[part * values + i];
		hits->power[i] = (float)(sum / (double)pi);
	}
	free(job.power);
	return status;
}

/* The slots that rays hit, in ascending order. */
static gw_status find_slots(gw_passes *passes, const gw_octree *octree, const gw_records *records,
							const gw_ray_gather *gather, gw_hit_lobes *hits, gw_error *error)
{
	size_t slots = 2 * (size_t)octree->leaf_count;
	size_t rays = (size_t)gather->rays * records->count;
	bool *is_hit = gw_allocate_zeros(slots, sizeof *is_hit);
	gw_view view = { 0 };
	gw_status status = is_hit
						   ? gw_view_open(passes->gpu, &gather->lobe, 4 * rays, &view, error)
						   : gw_fail(error, GW_ERROR_MEMORY, "no host memory for %zu lobes", slots);
	const uint32_t *lobe = view.bytes;
	for (size_t i = 0; i < rays && status == GW_OK; i++)
		if (lobe[i] != GW_NONE && !is_hit[lobe[i]]) {
			is_hit[lobe[i]] = true;
			hits->count++;
		}
	gw_view_close(passes->gpu, &view);
	if (status == GW_OK) {
		hits->slot = gw_allocate_array(hits->count, sizeof *hits->slot);
		if (!hits->slot)
			status = gw_fail(error, GW_ERROR_MEMORY, "no host memory for %zu lobes", hits->count);
	}
	for (size_t i = 0, n = 0; i < slots && status == GW_OK; i++)
		if (is_hit[i])
			hits->slot[n++] = (uint32_t)i;
	free(is_hit);
	return status;
}

gw_status gw_hit_lobes_find(gw_passes *passes, const gw_octree *octree, const gw_records *records,
							const gw_ray_gather *gather, gw_hit_lobes *hits, gw_error *error)
{
	*hits = (gw_hit_lobes){ 0 };
	gw_status status = find_slots(passes, octree, records, gather, hits, error);
	if (status == GW_OK)
		status = find_powers(passes, octree, records, hits, error);
	if (status != GW_OK)
		gw_hit_lobes_clear(hits);
	return status;
}

void gw_hit_lobes_clear(gw_hit_lobes *hits)
{
	free(hits->slot);
	free(hits->power);
	*hits = (gw_hit_lobes){ 0 };
}

gw_status gw_host_shade_hits(gw_passes *passes, const gw_octree *octree, const gw_records *records,
							 const gw_hit_lobes *hits, gw_buffer *lobe_radiance, gw_error *error)
{
	shading job = { .map.buffer = { [ALBEDO] = &octree->lobe_albedo,
									[RECORD] = &records->lobe_record,
									[WEIGHT] = &records->lobe_weight,
									[IRRADIANCE] = &records->gathered,
									[RADIANCE] = lobe_radiance },
					.slot = hits->slot };
	return run(passes, GW_PASS_LOBE_SHADE, hits->count, CHUNK, shade, &job.map, error);
}

gw_status gw_host_power(gw_passes *passes, const gw_records *records, const gw_hit_lobes *hits,
						double *power, gw_error *error)
{
	gw_view view;
	gw_status status =
		gw_view_open(passes->gpu, &records->gathered, 16 * (uint64_t)records->count, &view, error);
	const float *gathered = view.bytes;
	*power = 0.0;
	for (size_t i = 0; i < records->count && status == GW_OK; i++)
		for (size_t c = 0; c < 3; c++)
			*power += (double)hits->power[3 * i + c] * fabs((double)gathered[4 * i + c]);
	gw_view_close(passes->gpu, &view);
	return status;
}

/* --------------------------------------------------------------------------------- gathering */

enum { HIT, SEEN, NORMAL, GATHERED };

typedef struct gathering {
	mapping map;
	uint32_t rays;
} gathering;

static void gather_records(void *user, size_t first, size_t last, uint32_t worker)
{
	const gathering *job = user;
	const vec4_lanes *seen = job->map.at[SEEN], *normal = job->map.at[NORMAL];
	vec4_lanes *gathered = job->map.at[GATHERED];
	(void)worker;
	for (size_t i = first; i < last; i++) {
		const uint32_t *hit = (const uint32_t *)job->map.at[HIT] + i * job->rays;
		vec4_lanes sum = { 0 };
		for (size_t k = 0; k < job->rays; k++)
			if (hit[k] != GW_NONE)
				sum += seen[hit[k]];
		gathered[i] = sum * normal[i][3] * (pi / (float)job->rays);
		gathered[i][3] = 0.0f;
	}
}

gw_status gw_host_gather(gw_passes *passes, const gw_ray_gather *gather,
						 const gw_buffer *lobe_radiance, gw_records *records, gw_error *error)
{
	gathering job = { .map.buffer = { [HIT] = &gather->lobe,
									  [SEEN] = lobe_radiance,
									  [NORMAL] = &records->normal,
									  [GATHERED] = &records->gathered },
					  .rays = gather->rays };
	size_t chunk = CHUNK_RAYS / gather->rays + 1;
	return run(passes, GW_PASS_RECORD_GATHER, records->count, chunk, gather_records, &job.map,
			   error);
}

/* --------------------------------------------------------------------------- means over lobes */

enum { FIRST, FRAGMENT, SHARE, SURFEL, LOBE };

/* The two lobes of each leaf. */
static void average(void *user, size_t first, size_t last, uint32_t worker)
{
	void *const *at = ((const mapping *)user)->at;
	const uint32_t *start = at[FIRST], *fragment = at[FRAGMENT];
	const float *share = at[SHARE];
	const vec4_lanes *surfel = at[SURFEL];
	vec4_lanes *lobe = at[LOBE];
	(void)worker;
	for (size_t leaf = first; leaf < last; leaf++) {
		uint32_t stride = (start[leaf + 1] - start[leaf]) / FRAGMENTS;
		vec4_lanes sum[2] = { { 0 } };
		float area[2] = { 0 };
		stride = stride > 1 ? stride : 1;
		for (uint64_t f = start[leaf]; f < start[leaf + 1]; f += stride) {
			uint32_t word = fragment[f], side = word >> 30 & 1;
			if (word >> 31)
				continue;
			sum[side] += share[f] * surfel[word & 0x3fffffffu];
			area[side] += share[f];
		}
		for (size_t side = 0; side < 2; side++) {
			lobe[2 * leaf + side] = area[side] > 0.0f ? sum[side] / area[side] : (vec4_lanes){ 0 };
			lobe[2 * leaf + side][3] = 0.0f;
		}
	}
}

gw_status gw_host_average(gw_passes *passes, const gw_octree *octree, const gw_buffer *surfels,
						  gw_buffer *lobes, gw_error *error)
{
	mapping job = { .buffer = { [FIRST] = &octree->leaf_fragment,
								[FRAGMENT] = &octree->fragment_surfel,
								[SHARE] = &octree->fragment_weight,
								[SURFEL] = surfels,
								[LOBE] = lobes } };
	return run(passes, GW_PASS_LOBE_DIRECT, octree->leaf_count, CHUNK, average, &job, error);
}

/* ------------------------------------------------------------------------------------ adding */

enum { FROM, TO };

static void add(void *user, size_t first, size_t last, uint32_t worker)
{
	const mapping *job = user;
	const vec4_lanes *from = job->at[FROM];
	vec4_lanes *to = job->at[TO];
	(void)worker;
	for (size_t i = first; i < last; i++)
		to[i] += from[i];
}

gw_status gw_host_add(gw_passes *passes, const gw_buffer *from, gw_buffer *to, uint64_t count,
					  gw_error *error)
{
	mapping job = { .buffer = { [FROM] = from, [TO] = to } };
	return run(passes, GW_PASS_RECORD_ADD, (size_t)count, 16 * CHUNK, add, &job, error);
}

/*
 * host_products.c - see host_products.h.
 */
#include "light/host_products.h"

#include "light/host_loop.h"
#include "base/memory.h"
#include "light/transport_layout.h"

#include <math.h>
#include <stdlib.h>

#define CHUNK 4096u       /* lobes, leaves or sums that a thread takes at a time */
#define CHUNK_RAYS 65536u /* that a thread follows at a time */
#define FRAGMENTS 1024u   /* of a leaf, at most about so many count: as lobe_direct.comp */
#define BUFFERS_MAX 7u

static const float pi = 3.14159265358979f;

typedef float vec4_lanes __attribute__((vector_size(16)));

/* Where the buffers lie that one loop reads and writes; NULL for none. */
typedef struct arrays {
	void *at[BUFFERS_MAX];
} arrays;

/* ----------------------------------------------------------------------------------- shading */

enum { ALBEDO, RECORD, WEIGHT, IRRADIANCE, RADIANCE, DIRECT, AREA };

typedef struct shading {
	arrays arrays;
	float direct_share;
	const uint32_t *slot; /* NULL: all */
} shading;

static void shade(void *user, size_t first, size_t last, uint32_t worker)
{
	const shading *job = user;
	void *const *at = job->arrays.at;
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

void gw_host_shade(gw_passes *passes, const gw_octree *octree, const gw_records *records,
				   const gw_buffer *records_irradiance, const gw_buffer *lobe_direct,
				   float direct_share, gw_buffer *lobe_radiance)
{
	shading job = { .arrays.at = { [ALBEDO] = octree->lobe_albedo.mapped,
								   [RECORD] = records->lobe_record.mapped,
								   [WEIGHT] = records->lobe_weight.mapped,
								   [IRRADIANCE] = records_irradiance->mapped,
								   [RADIANCE] = lobe_radiance->mapped,
								   [DIRECT] = direct_share != 0.0f ? lobe_direct->mapped : NULL },
					.direct_share = direct_share };
	gw_host_loop(passes, GW_PASS_LOBE_SHADE, 2 * (size_t)octree->leaf_count, CHUNK, shade,
				 &job.arrays);
}

/* --------------------------------------------------------------------------- lobes that are hit */

#define POWER_PARTS 8u /* sums of power that are made apart, so that threads do not matter */

typedef struct powers {
	arrays arrays;
	size_t records;
	double *power; /* 3 a record and part */
	size_t part;   /* slots of a part */
} powers;

static void add_powers(void *user, size_t first, size_t last, uint32_t worker)
{
	const powers *job = user;
	void *const *at = job->arrays.at;
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
	powers job = { .arrays.at = { [ALBEDO] = octree->lobe_albedo.mapped,
								  [RECORD] = records->lobe_record.mapped,
								  [WEIGHT] = records->lobe_weight.mapped,
								  [AREA] = octree->lobe_centre.mapped },
				   .records = records->count,
				   .power = gw_allocate_zeros(values, POWER_PARTS * sizeof *job.power),
				   .part = slots / POWER_PARTS + 1 };
	hits->power = gw_allocate_array(values, sizeof *hits->power);
	gw_status status = GW_OK;
	if (!job.power || !hits->power)
		status = gw_fail(error, GW_ERROR_MEMORY, "no host memory for %u records", records->count);
	if (status == GW_OK)
		gw_host_loop(passes, GW_PASS_LOBE_SHADE, slots, job.part, add_powers, &job.arrays);
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
static gw_status find_slots(const gw_octree *octree, const gw_records *records,
							const gw_ray_gather *gather, gw_hit_lobes *hits, gw_error *error)
{
	size_t slots = 2 * (size_t)octree->leaf_count;
	size_t rays = (size_t)gather->rays * records->count;
	const uint32_t *lobe = gather->lobe.mapped;
	bool *is_hit = gw_allocate_zeros(slots, sizeof *is_hit);
	for (size_t i = 0; i < rays && is_hit; i++)
		if (lobe[i] != GW_NONE && !is_hit[lobe[i]]) {
			is_hit[lobe[i]] = true;
			hits->count++;
		}
	hits->slot = gw_allocate_array(hits->count, sizeof *hits->slot);
	bool complete = is_hit && hits->slot;
	for (size_t i = 0, n = 0; i < slots && complete; i++)
		if (is_hit[i])
			hits->slot[n++] = (uint32_t)i;
	free(is_hit);
	return complete ? GW_OK
					: gw_fail(error, GW_ERROR_MEMORY, "no host memory for %zu lobes", slots);
}

gw_status gw_hit_lobes_find(gw_passes *passes, const gw_octree *octree, const gw_records *records,
							const gw_ray_gather *gather, gw_hit_lobes *hits, gw_error *error)
{
	*hits = (gw_hit_lobes){ 0 };
	if (gw_gpu_stopped(passes->gpu))
		return gw_fail(error, GW_ERROR_CANCELLED, "stopped before the bounces");
	gw_status status = find_slots(octree, records, gather, hits, error);
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

void gw_host_shade_hits(gw_passes *passes, const gw_octree *octree, const gw_records *records,
						const gw_hit_lobes *hits, gw_buffer *lobe_radiance)
{
	shading job = { .arrays.at = { [ALBEDO] = octree->lobe_albedo.mapped,
								   [RECORD] = records->lobe_record.mapped,
								   [WEIGHT] = records->lobe_weight.mapped,
								   [IRRADIANCE] = records->gathered.mapped,
								   [RADIANCE] = lobe_radiance->mapped },
					.slot = hits->slot };
	gw_host_loop(passes, GW_PASS_LOBE_SHADE, hits->count, CHUNK, shade, &job.arrays);
}

double gw_host_power(const gw_records *records, const gw_hit_lobes *hits)
{
	const float *gathered = records->gathered.mapped;
	double power = 0.0;
	for (size_t i = 0; i < records->count; i++)
		for (size_t c = 0; c < 3; c++)
			power += (double)hits->power[3 * i + c] * fabs((double)gathered[4 * i + c]);
	return power;
}

/* --------------------------------------------------------------------------------- gathering */

enum { HIT, SEEN, NORMAL, GATHERED };

typedef struct gathering {
	arrays arrays;
	uint32_t rays;
} gathering;

static void gather_records(void *user, size_t first, size_t last, uint32_t worker)
{
	const gathering *job = user;
	const vec4_lanes *seen = job->arrays.at[SEEN], *normal = job->arrays.at[NORMAL];
	vec4_lanes *gathered = job->arrays.at[GATHERED];
	(void)worker;
	for (size_t i = first; i < last; i++) {
		const uint32_t *hit = (const uint32_t *)job->arrays.at[HIT] + i * job->rays;
		vec4_lanes sum = { 0 };
		for (size_t k = 0; k < job->rays; k++)
			if (hit[k] != GW_NONE)
				sum += seen[hit[k]];
		gathered[i] = sum * normal[i][3] * (pi / (float)job->rays);
		gathered[i][3] = 0.0f;
	}
}

void gw_host_gather(gw_passes *passes, const gw_ray_gather *gather, const gw_buffer *lobe_radiance,
					gw_records *records)
{
	gathering job = { .arrays.at = { [HIT] = gather->lobe.mapped,
									 [SEEN] = lobe_radiance->mapped,
									 [NORMAL] = records->normal.mapped,
									 [GATHERED] = records->gathered.mapped },
					  .rays = gather->rays };
	size_t chunk = CHUNK_RAYS / gather->rays + 1;
	gw_host_loop(passes, GW_PASS_RECORD_GATHER, records->count, chunk, gather_records, &job.arrays);
}

/* --------------------------------------------------------------------------- means over lobes */

enum { FIRST, FRAGMENT, SHARE, SURFEL, LOBE };

/* The two lobes of each leaf. */
static void average(void *user, size_t first, size_t last, uint32_t worker)
{
	void *const *at = ((const arrays *)user)->at;
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

void gw_host_average(gw_passes *passes, const gw_octree *octree, const gw_buffer *surfels,
					 gw_buffer *lobes)
{
	arrays job = { .at = { [FIRST] = octree->leaf_fragment.mapped,
						   [FRAGMENT] = octree->fragment_surfel.mapped,
						   [SHARE] = octree->fragment_weight.mapped,
						   [SURFEL] = surfels->mapped,
						   [LOBE] = lobes->mapped } };
	gw_host_loop(passes, GW_PASS_LOBE_DIRECT, octree->leaf_count, CHUNK, average, &job);
}

/* ------------------------------------------------------------------------------------ adding */

enum { FROM, TO };

static void add(void *user, size_t first, size_t last, uint32_t worker)
{
	const arrays *job = user;
	const vec4_lanes *from = job->at[FROM];
	vec4_lanes *to = job->at[TO];
	(void)worker;
	for (size_t i = first; i < last; i++)
		to[i] += from[i];
}

void gw_host_add(gw_passes *passes, const gw_buffer *from, gw_buffer *to, uint64_t count)
{
	arrays job = { .at = { [FROM] = from->mapped, [TO] = to->mapped } };
	gw_host_loop(passes, GW_PASS_RECORD_ADD, (size_t)count, 16 * CHUNK, add, &job);
}

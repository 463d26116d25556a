/*
 * probe_trace.c - see probe_trace.h.
 */
#include "light/probe_trace.h"

#include "base/memory.h"
#include "base/parallel.h"
#include "base/spherical_harmonics.h"
#include "light/octahedral.h"
#include "light/probe_cells.h"
#include "light/transport_layout.h"
#include "octree/compartments.h"

#include <stdlib.h>

/* Rays that are on the device at a time: 32 MB. */
#define RAYS ((size_t)1 << 22)

/* Directions of the texels: 4 a texel, as gw_octahedral_texel has them; NULL: no memory. */
static float *make_directions(uint32_t size, gw_error *error)
{
	const size_t texels = (size_t)size * size;
	float *direction = gw_allocate_zeros(texels, 4 * sizeof *direction);
	if (!direction)
		gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu texels", texels);
	for (size_t k = 0; direction && k < texels; k++) {
		gw_vec3 d = gw_octahedral_texel(size, (uint32_t)k);
		memcpy(direction + 4 * k, (float[3]){ d.x, d.y, d.z }, 3 * sizeof d.x);
	}
	return direction;
}

void gw_probe_hits_clear(gw_probe_hits *hits)
{
	free(hits->place);
	free(hits->facet);
	free(hits->distance);
	*hits = (gw_probe_hits){ .count = 0 };
}

/* ------------------------------------------------------------------------------- what rays meet */

/* Rays of probes that are on the device together, and what they are for. */
typedef struct tracing {
	const gw_probe_scene *scene;
	gw_probe_hits *hits;
	size_t texels;             /* of a map */
	gw_buffer towards, hit[2]; /* directions; what rays hit, and how far off */
	size_t first;              /* probe of the first of them */
} tracing;

static gw_status open_tracing(tracing *t, size_t rays, gw_error *error)
{
	gw_gpu *gpu = t->scene->passes->gpu;
	const uint64_t bytes = 16 * (uint64_t)t->texels;
	static const char *const name[] = { "hit facets of probes", "hit distances of probes" };
	for (int i = 0; i < 2; i++)
		GW_TRY(
			gw_buffer_create_unset(gpu,
								   &(gw_buffer_description){ GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED,
															 4 * (uint64_t)rays, name[i] },
								   &t->hit[i], error));
	GW_TRY(
		gw_buffer_create(gpu,
						 &(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_R32G32B32A32_SFLOAT,
												   bytes, "directions of probes" },
						 &t->towards, error));
	float *direction = make_directions(t->hits->size, error);
	if (!direction)
		return GW_ERROR_MEMORY;
	gw_status status = gw_buffer_upload(gpu, &t->towards, 0, direction, bytes, error);
	free(direction);
	return status;
}

static void close_tracing(tracing *t)
{
	gw_gpu *gpu = t->scene->passes->gpu;
	gw_buffer_destroy(gpu, &t->towards);
	gw_buffer_destroy(gpu, &t->hit[0]);
	gw_buffer_destroy(gpu, &t->hit[1]);
}

/* Has a ray of a probe in the compartment `own` slipped through rock? */
static bool has_slipped(const tracing *t, uint32_t own, uint32_t facet)
{
	const gw_octree *o = t->scene->octree;
	if (facet == GW_NONE)
		return gw_compartments_apart(own, gw_compartment_outside(o));
	return facet < o->facet_count &&
		   gw_compartments_apart(own, gw_compartments_of_facets(o)[facet]);
}

/* Gives texels of a negative distance what texels beside them have. Returns how many got some. */
static size_t fill_texels(uint32_t size, uint32_t *facet, float *distance)
{
	size_t filled = 0;
	for (uint32_t texel = 0; texel < size * size; texel++)
		for (uint32_t side = 0; side < 4 && distance[texel] < 0.0f; side++) {
			uint32_t beside = gw_octahedral_beside(size, texel, side);
			if (distance[beside] < 0.0f)
				continue;
			facet[texel] = facet[beside];
			distance[texel] = distance[beside];
			filled++;
		}
	return filled;
}

/* Puts right what rays of a probe met that slipped through rock. */
static void mend(const tracing *t, size_t probe)
{
	const gw_octree *o = t->scene->octree;
	uint32_t *facet = t->hits->facet + probe * t->texels;
	float *distance = t->hits->distance + probe * t->texels;
	size_t slipped = 0;
	if (!gw_compartments_several(o))
		return;
	const uint32_t own = gw_compartment_at(o, t->hits->place + 4 * probe);
	for (size_t i = 0; i < t->texels; i++) {
		if (!has_slipped(t, own, facet[i]))
			continue;
		distance[i] = -1.0f;
		slipped++;
	}
	for (size_t filled = 1; slipped > 0 && filled > 0; slipped -= filled)
		filled = fill_texels(t->hits->size, facet, distance);
}

/* What rays of a probe met is as far as it is, whether they passed backs of surfaces or not; tells
 * what share of those that came upon surface did. */
static void count_behind(const tracing *t, size_t probe)
{
	const uint32_t *facet = t->hits->facet + probe * t->texels;
	float *distance = t->hits->distance + probe * t->texels;
	size_t behind = 0, all = 0;
	for (size_t i = 0; i < t->texels; i++) {
		bool passed = signbit(distance[i]) != 0;
		behind += passed;
		all += passed || facet[i] != GW_NONE;
		distance[i] = fabsf(distance[i]);
	}
	if (t->hits->behind)
		t->hits->behind[probe] = all > 0 ? (float)behind / (float)all : 0.0f;
}

/* What is not known is told by the facet alone. */
static void finish(void *user, size_t first, size_t last, uint32_t worker)
{
	const tracing *t = user;
	const uint32_t unknown = t->scene->octree->facet_count;
	(void)worker;
	for (size_t probe = t->first + first; probe < t->first + last; probe++) {
		count_behind(t, probe);
		mend(t, probe);
		for (size_t i = probe * t->texels; i < (probe + 1) * t->texels; i++) {
			uint32_t *facet = &t->hits->facet[i];
			if (t->hits->distance[i] >= 0.0f && (*facet < unknown || *facet == GW_NONE))
				continue;
			*facet = unknown;
			t->hits->distance[i] = 0.0f;
		}
	}
}

/* Probes that go onto the device together. */
static gw_status trace(tracing *t, size_t count, gw_buffer *position, gw_error *error)
{
	gw_passes *passes = t->scene->passes;
	const gw_octree *o = t->scene->octree;
	const gw_probe_hits *h = t->hits;
	const uint64_t rays = (uint64_t)count * t->texels;
	GW_TRY(
		gw_buffer_create(passes->gpu,
						 &(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_R32G32B32A32_SFLOAT,
												   16 * (uint64_t)count, "places of probes" },
						 position, error));
	GW_TRY(gw_buffer_upload(passes->gpu, position, 0, h->place + 4 * t->first, 16 * (uint64_t)count,
							error));
	const gw_binding bindings[] = { GW_TRACE_BINDINGS(o),     gw_whole(position),
									gw_whole(&t->towards),    gw_window(&t->hit[0], 4),
									gw_window(&t->hit[1], 4), GW_DISC_BINDINGS(o),
									GW_TREE_BINDING(o),       GW_OPACITY_BINDING(o),
									GW_LEAF_BINDING(o) };
	const gw_probe_push push = { .rays = (uint32_t)t->texels, .seed = t->scene->seed };
	GW_TRY(gw_passes_run(passes, GW_PASS_PROBE_RAYS, bindings, &push, rays, error));
	GW_TRY(gw_buffer_download(passes->gpu, &t->hit[0], 0, h->facet + t->first * t->texels, 4 * rays,
							  error));
	return gw_buffer_download(passes->gpu, &t->hit[1], 0, h->distance + t->first * t->texels,
							  4 * rays, error);
}

static gw_status trace_all(tracing *t, size_t batch, gw_error *error)
{
	gw_status status = open_tracing(t, batch * t->texels, error);
	for (; t->first < t->hits->count && status == GW_OK; t->first += batch) {
		gw_buffer position = { 0 };
		size_t left = t->hits->count - t->first, some = left < batch ? left : batch;
		status = trace(t, some, &position, error);
		gw_buffer_destroy(t->scene->passes->gpu, &position);
		if (status == GW_OK)
			gw_parallel_for(t->scene->threads, some, 1, finish, t);
	}
	close_tracing(t);
	return status;
}

gw_status gw_probe_hits_trace(const gw_probe_scene *scene, gw_probe_hits *hits, gw_error *error)
{
	tracing t = { .scene = scene, .hits = hits };
	t.texels = (size_t)hits->size * hits->size;
	hits->facet = gw_allocate_array(hits->count, t.texels * sizeof *hits->facet);
	hits->distance = gw_allocate_array(hits->count, t.texels * sizeof *hits->distance);
	if (!hits->facet || !hits->distance)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for what %zu probes see", hits->count);
	return trace_all(&t, RAYS / t.texels < hits->count ? RAYS / t.texels : hits->count, error);
}

/* --------------------------------------------------------------------------- what maps show of it
 */

/* All that the maps are made of. */
typedef struct showing {
	const gw_probe_scene *scene;
	const gw_probe_hits *hits;
	double metres;
	gw_probes *probes;
	size_t texels;           /* of a map */
	float *direction;        /* 4 a texel */
	double *angle;           /* a texel: its solid angle, steradians */
	gw_view radiance, plane; /* of the facets */
} showing;

/* Of surface that is seen: its radiance and its normal towards the probe. */
static void put_hit(const showing *t, uint32_t facet, const float *direction, float *radiance,
					float *normal)
{
	const float *plane = (const float *)t->plane.bytes + 4 * (size_t)facet;
	const float *seen = t->radiance.bytes;
	float side = gw_dot(gw_xyz(plane), gw_xyz(direction)) > 0.0f ? -1.0f : 1.0f;
	for (size_t c = 0; c < 3; c++) {
		radiance[c] = seen ? seen[4 * (size_t)facet + c] : 0.0f;
		normal[c] = side * plane[c];
	}
}

/* What a ray found. */
static void put_texel(const showing *t, size_t texel)
{
	gw_probes *p = t->probes;
	const float *direction = t->direction + 4 * (texel % t->texels);
	const uint32_t facet = t->hits->facet[texel];
	float *radiance = p->radiance + 3 * texel;
	const bool none = facet >= t->scene->octree->facet_count;
	const double distance = (double)t->hits->distance[texel] * t->metres;
	p->distance[texel] = none || distance > (double)GW_PROBE_FAR ? GW_PROBE_FAR : (float)distance;
	if (facet == GW_NONE && t->scene->facet_radiance)
		gw_sky_radiance(&t->scene->sky, gw_xyz(direction), radiance);
	if (!none)
		put_hit(t, facet, direction, radiance, p->normal + 3 * texel);
}

/* Projects a map onto the harmonics: texels by their solid angles. */
static void project(const showing *t, size_t k)
{
	double sum[GW_PROBE_HARMONICS][3] = { { 0.0 } };
	gw_probe *probe = &t->probes->probe[k];
	for (size_t i = 0; i < t->texels; i++) {
		float value[GW_PROBE_HARMONICS];
		gw_spherical_harmonics(t->direction + 4 * i, 3, value);
		for (size_t h = 0; h < GW_PROBE_HARMONICS; h++)
			for (size_t c = 0; c < 3; c++)
				sum[h][c] += t->angle[i] * (double)value[h] *
							 (double)t->probes->radiance[3 * (k * t->texels + i) + c];
	}
	for (size_t h = 0; h < GW_PROBE_HARMONICS; h++)
		for (size_t c = 0; c < 3; c++)
			probe->harmonic[h][c] = (float)sum[h][c];
}

static void put_range(const showing *t, size_t k)
{
	const float *distance = t->probes->distance + k * t->texels;
	gw_probe *probe = &t->probes->probe[k];
	for (size_t i = 0; i < t->texels; i++) {
		if (distance[i] >= GW_PROBE_FAR)
			continue;
		probe->farthest = gw_larger(probe->farthest, distance[i]);
		if (!(probe->nearest > 0.0f) || distance[i] < probe->nearest)
			probe->nearest = distance[i];
	}
}

static void show(void *user, size_t first, size_t last, uint32_t worker)
{
	const showing *t = user;
	gw_probes *p = t->probes;
	size_t mips = (size_t)gw_octahedral_mip_texels(p->size);
	(void)worker;
	for (size_t k = first; k < last; k++) {
		for (size_t j = 0; j < t->texels; j++)
			put_texel(t, k * t->texels + j);
		project(t, k);
		put_range(t, k);
		gw_octahedral_mips(p->size, p->distance + k * t->texels, p->least + k * mips,
						   p->greatest + k * mips);
	}
}

static gw_status open_showing(showing *t, gw_error *error)
{
	gw_gpu *gpu = t->scene->passes->gpu;
	const gw_octree *o = t->scene->octree;
	const uint64_t facets = 16 * (uint64_t)o->facet_count;
	t->direction = make_directions(t->hits->size, error);
	if (!t->direction)
		return GW_ERROR_MEMORY;
	t->angle = gw_allocate_zeros(t->texels, sizeof *t->angle);
	if (!t->angle)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu texels", t->texels);
	for (size_t k = 0; k < t->texels; k++)
		t->angle[k] = gw_octahedral_solid_angle(t->hits->size, (uint32_t)k);
	if (t->scene->facet_radiance)
		GW_TRY(gw_view_open(gpu, t->scene->facet_radiance, facets, &t->radiance, error));
	return gw_view_open(gpu, &o->facet_plane, facets, &t->plane, error);
}

gw_status gw_probe_hits_show(const gw_probe_scene *scene, const gw_probe_hits *hits, double metres,
							 gw_probes *probes, gw_error *error)
{
	showing t = { .scene = scene, .hits = hits, .metres = metres, .probes = probes };
	t.texels = (size_t)hits->size * hits->size;
	gw_status status = open_showing(&t, error);
	if (status == GW_OK)
		gw_parallel_for(scene->threads, hits->count, 1, show, &t);
	gw_view_close(&t.radiance);
	gw_view_close(&t.plane);
	free(t.direction);
	free(t.angle);
	return status;
}

void gw_probes_destroy(gw_probes **probes)
{
	gw_probes *p = *probes;
	*probes = NULL;
	if (!p)
		return;
	free(p->probe);
	free(p->radiance);
	free(p->normal);
	free(p->distance);
	free(p->least);
	free(p->greatest);
	gw_probe_cells_clear(&p->cells);
	free(p);
}

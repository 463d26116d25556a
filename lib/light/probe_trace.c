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

/* All that the texels are made of. */
typedef struct tracing {
	const gw_probe_scene *scene;
	const float *place;
	double metres;
	gw_probes *probes;
	size_t texels;                   /* of a map */
	float *direction;                /* 4 a texel */
	double *angle;                   /* a texel: its solid angle, steradians */
	gw_view radiance, plane, albedo; /* of the facets */
	gw_buffer towards, hit[2];       /* directions; what rays hit, and how far off */
	uint32_t *facet;                 /* RAYS or all: likewise */
	float *distance;
	size_t first; /* probe of the first of them */
} tracing;

static gw_status make_directions(tracing *t, gw_error *error)
{
	const uint64_t bytes = 16 * (uint64_t)t->texels;
	t->direction = gw_allocate_zeros(t->texels, 4 * sizeof *t->direction);
	t->angle = gw_allocate_zeros(t->texels, sizeof *t->angle);
	if (!t->direction || !t->angle)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu texels", t->texels);
	for (size_t k = 0; k < t->texels; k++) {
		gw_vec3 d = gw_octahedral_texel(t->probes->size, (uint32_t)k);
		memcpy(t->direction + 4 * k, (float[3]){ d.x, d.y, d.z }, 3 * sizeof d.x);
		t->angle[k] = gw_octahedral_solid_angle(t->probes->size, (uint32_t)k);
	}
	GW_TRY(
		gw_buffer_create(t->scene->passes->gpu,
						 &(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_R32G32B32A32_SFLOAT,
												   bytes, "directions of probes" },
						 &t->towards, error));
	return gw_buffer_upload(t->scene->passes->gpu, &t->towards, 0, t->direction, bytes, error);
}

static gw_status open_tracing(tracing *t, size_t rays, gw_error *error)
{
	gw_gpu *gpu = t->scene->passes->gpu;
	const gw_octree *o = t->scene->octree;
	const uint64_t facets = 32 * (uint64_t)o->leaf_count;
	static const char *const name[] = { "hit facets of probes", "hit distances of probes" };
	GW_TRY(make_directions(t, error));
	t->facet = gw_allocate_array(rays, sizeof *t->facet);
	t->distance = gw_allocate_array(rays, sizeof *t->distance);
	if (!t->facet || !t->distance)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu rays", rays);
	for (int i = 0; i < 2; i++)
		GW_TRY(
			gw_buffer_create_unset(gpu,
								   &(gw_buffer_description){ GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED,
															 4 * (uint64_t)rays, name[i] },
								   &t->hit[i], error));
	if (t->scene->facet_radiance)
		GW_TRY(gw_view_open(gpu, t->scene->facet_radiance, facets, &t->radiance, error));
	GW_TRY(gw_view_open(gpu, &o->facet_plane, facets, &t->plane, error));
	return gw_view_open(gpu, &o->facet_albedo, facets, &t->albedo, error);
}

static void close_tracing(tracing *t)
{
	gw_gpu *gpu = t->scene->passes->gpu;
	gw_view_close(&t->radiance);
	gw_view_close(&t->plane);
	gw_view_close(&t->albedo);
	gw_buffer_destroy(gpu, &t->towards);
	gw_buffer_destroy(gpu, &t->hit[0]);
	gw_buffer_destroy(gpu, &t->hit[1]);
	free(t->direction);
	free(t->angle);
	free(t->facet);
	free(t->distance);
}

/* ------------------------------------------------------------------------------- one probe */

/* Of surface that is seen: its radiance and its normal towards the probe. */
static void put_hit(const tracing *t, uint32_t facet, const float *direction, float *radiance,
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

/* Has a ray of a probe in the compartment `own` slipped through rock? */
static bool has_slipped(const tracing *t, uint32_t own, uint32_t facet)
{
	const gw_octree *o = t->scene->octree;
	if (facet == GW_NONE)
		return gw_compartments_apart(own, gw_compartment_outside(o));
	return facet < 2 * o->leaf_count &&
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
static void mend(const tracing *t, size_t first_ray, const float place[3])
{
	const gw_octree *o = t->scene->octree;
	uint32_t *facet = t->facet + first_ray;
	float *distance = t->distance + first_ray;
	size_t slipped = 0;
	if (!gw_compartments_several(o))
		return;
	const uint32_t own = gw_compartment_at(o, place);
	for (size_t i = 0; i < t->texels; i++) {
		if (!has_slipped(t, own, facet[i]))
			continue;
		distance[i] = -1.0f;
		slipped++;
	}
	for (size_t filled = 1; slipped > 0 && filled > 0; slipped -= filled)
		filled = fill_texels(t->probes->size, facet, distance);
}

/* What a ray found. */
static void put_texel(const tracing *t, size_t ray, size_t texel)
{
	gw_probes *p = t->probes;
	const float *direction = t->direction + 4 * (texel % t->texels);
	uint32_t facet = t->facet[ray];
	float *radiance = p->radiance + 3 * texel, *normal = p->normal + 3 * texel;
	bool slipped = t->distance[ray] < 0.0f;
	bool none = slipped || facet == GW_NONE || facet >= 2 * t->scene->octree->leaf_count;
	double distance = (double)t->distance[ray] * t->metres;
	p->distance[texel] = none || distance > (double)GW_PROBE_FAR ? GW_PROBE_FAR : (float)distance;
	if (none && !slipped && facet == GW_NONE && t->scene->facet_radiance)
		gw_sky_radiance(&t->scene->sky, gw_xyz(direction), radiance);
	if (!none)
		put_hit(t, facet, direction, radiance, normal);
	if (t->scene->facet)
		t->scene->facet[texel] = none ? GW_NONE : facet;
}

/* Projects a map onto the harmonics: texels by their solid angles. */
static void project(const tracing *t, size_t k)
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

static void put_range(const tracing *t, size_t k)
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

static void finish(void *user, size_t first, size_t last, uint32_t worker)
{
	const tracing *t = user;
	gw_probes *p = t->probes;
	size_t mips = (size_t)gw_octahedral_mip_texels(p->size);
	(void)worker;
	for (size_t i = first; i < last; i++) {
		size_t k = t->first + i;
		mend(t, i * t->texels, t->place + 4 * k);
		for (size_t j = 0; j < t->texels; j++)
			put_texel(t, i * t->texels + j, k * t->texels + j);
		project(t, k);
		put_range(t, k);
		gw_octahedral_mips(p->size, p->distance + k * t->texels, p->least + k * mips,
						   p->greatest + k * mips);
	}
}

/* -------------------------------------------------------------------------------- all of them */

/* Probes that go onto the device together. */
static gw_status trace(tracing *t, size_t count, gw_buffer *position, gw_error *error)
{
	gw_passes *passes = t->scene->passes;
	const gw_octree *o = t->scene->octree;
	const uint64_t rays = (uint64_t)count * t->texels;
	GW_TRY(
		gw_buffer_create(passes->gpu,
						 &(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_R32G32B32A32_SFLOAT,
												   16 * (uint64_t)count, "places of probes" },
						 position, error));
	GW_TRY(gw_buffer_upload(passes->gpu, position, 0, t->place + 4 * t->first, 16 * (uint64_t)count,
							error));
	const gw_binding bindings[] = { GW_TRACE_BINDINGS(o),     gw_whole(position),
									gw_whole(&t->towards),    gw_window(&t->hit[0], 4),
									gw_window(&t->hit[1], 4), GW_DISC_BINDINGS(o),
									GW_TREE_BINDING(o),       GW_OPACITY_BINDING(o) };
	const gw_probe_push push = { .rays = (uint32_t)t->texels, .seed = t->scene->seed };
	GW_TRY(gw_passes_run(passes, GW_PASS_PROBE_RAYS, bindings, &push, rays, error));
	GW_TRY(gw_buffer_download(passes->gpu, &t->hit[0], 0, t->facet, 4 * rays, error));
	return gw_buffer_download(passes->gpu, &t->hit[1], 0, t->distance, 4 * rays, error);
}

gw_status gw_probes_trace(const gw_probe_scene *scene, const float *place, double metres,
						  gw_probes *probes, gw_error *error)
{
	tracing t = { .scene = scene, .place = place, .metres = metres, .probes = probes };
	t.texels = (size_t)probes->size * probes->size;
	size_t batch = RAYS / t.texels < probes->count ? RAYS / t.texels : probes->count;
	gw_status status = open_tracing(&t, batch * t.texels, error);
	for (; t.first < probes->count && status == GW_OK; t.first += batch) {
		gw_buffer position = { 0 };
		size_t left = probes->count - t.first, some = left < batch ? left : batch;
		status = trace(&t, some, &position, error);
		gw_buffer_destroy(scene->passes->gpu, &position);
		if (status == GW_OK)
			gw_parallel_for(scene->threads, some, 1, finish, &t);
	}
	close_tracing(&t);
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

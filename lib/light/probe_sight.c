/*
 * probe_sight.c - see probe_sight.h.
 */
#include "light/probe_sight.h"

#include "base/memory.h"
#include "light/transport_layout.h"

#include <math.h>
#include <stdlib.h>

/* Pairs of a viewer and a place that are on the device at a time: 64 MB. */
#define PAIRS ((size_t)1 << 24)

/* Host copies of what the facets are; 4 floats a facet. */
typedef struct facets {
	size_t count;
	gw_view centre, plane, albedo;
} facets;

static gw_status open_facets(gw_gpu *gpu, const gw_octree *octree, facets *f, gw_error *error)
{
	f->count = octree->facet_count;
	GW_TRY(gw_view_open(gpu, &octree->facet_centre, 16 * f->count, &f->centre, error));
	GW_TRY(gw_view_open(gpu, &octree->facet_plane, 16 * f->count, &f->plane, error));
	return gw_view_open(gpu, &octree->facet_albedo, 16 * f->count, &f->albedo, error);
}

static void close_facets(facets *f)
{
	gw_view_close(&f->centre);
	gw_view_close(&f->plane);
	gw_view_close(&f->albedo);
}

static double area_of(const facets *f, size_t facet)
{
	double area = (double)((const float *)f->centre.bytes)[4 * facet + 3];
	return area > 0.0 ? area : 0.0;
}

/* Arrays of the places while they are chosen. */
typedef struct choice {
	float *position, *normal; /* 4 a place */
	uint32_t count;
} choice;

static void take(const facets *f, size_t facet, double area, choice *c, float *areas)
{
	const float *centre = (const float *)f->centre.bytes + 4 * facet;
	const float *plane = (const float *)f->plane.bytes + 4 * facet;
	bool both = floorf(((const float *)f->albedo.bytes)[4 * facet + 3]) > 0.0f;
	for (size_t k = 0; k < 3; k++) {
		c->position[4 * (size_t)c->count + k] = centre[k];
		c->normal[4 * (size_t)c->count + k] = plane[k];
	}
	c->position[4 * (size_t)c->count + 3] = both ? 1.0f : 0.0f;
	areas[c->count++] = (float)area;
}

/* All facets, or one at each step of area. */
static void choose(const facets *f, size_t used, uint32_t most, double shift, choice *c,
				   gw_sight_places *places)
{
	double step = places->total / (double)most, next = shift * step, sum = 0.0;
	for (size_t facet = 0; facet < f->count; facet++) {
		double area = area_of(f, facet);
		sum += area;
		if (used <= most && area > 0.0)
			take(f, facet, area, c, places->area);
		for (; used > most && next < sum && c->count < most; next += step)
			take(f, facet, step, c, places->area);
	}
}

static gw_status upload(gw_gpu *gpu, const float *values, uint32_t count, const char *name,
						gw_buffer *buffer, gw_error *error)
{
	const uint64_t bytes = 16 * (uint64_t)count;
	GW_TRY(gw_buffer_create(
		gpu,
		&(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_R32G32B32A32_SFLOAT, bytes, name },
		buffer, error));
	return gw_buffer_upload(gpu, buffer, 0, values, bytes, error);
}

static gw_status make(gw_gpu *gpu, const facets *f, uint32_t most, double shift,
					  gw_sight_places *places, gw_error *error)
{
	size_t used = 0;
	for (size_t facet = 0; facet < f->count; facet++) {
		places->total += area_of(f, facet);
		used += area_of(f, facet) > 0.0;
	}
	size_t room = used < most ? used : most;
	choice c = { gw_allocate_zeros(room, 4 * sizeof *c.position),
				 gw_allocate_zeros(room, 4 * sizeof *c.normal), 0 };
	places->area = gw_allocate_zeros(room, sizeof *places->area);
	gw_status status = c.position && c.normal && places->area
						   ? GW_OK
						   : gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu places", room);
	if (status == GW_OK) {
		choose(f, used, most, shift, &c, places);
		places->count = c.count;
		status = upload(gpu, c.position, c.count, "seen places", &places->position, error);
	}
	if (status == GW_OK)
		status = upload(gpu, c.normal, c.count, "normals of seen places", &places->normal, error);
	free(c.position);
	free(c.normal);
	return status;
}

gw_status gw_sight_places_make(gw_gpu *gpu, const gw_octree *octree, uint32_t most, double shift,
							   gw_sight_places *places, gw_error *error)
{
	facets f = { .count = 0 };
	*places = (gw_sight_places){ .reach = (float)(1u << octree->depth) };
	gw_status status = open_facets(gpu, octree, &f, error);
	if (status == GW_OK)
		status = make(gpu, &f, most, shift, places, error);
	close_facets(&f);
	if (status != GW_OK)
		gw_sight_places_clear(gpu, places);
	return status;
}

void gw_sight_places_clear(gw_gpu *gpu, gw_sight_places *places)
{
	gw_buffer_destroy(gpu, &places->position);
	gw_buffer_destroy(gpu, &places->normal);
	free(places->area);
	*places = (gw_sight_places){ 0 };
}

/* Viewers that go onto the device together. */
static gw_status look(const gw_sight *s, const float *viewer, uint32_t count, gw_buffer buffer[2],
					  float *value, gw_error *error)
{
	gw_gpu *gpu = s->passes->gpu;
	const uint64_t pairs = (uint64_t)count * s->places->count;
	GW_TRY(upload(gpu, viewer, count, "viewers", &buffer[0], error));
	GW_TRY(gw_buffer_create_unset(
		gpu, &(gw_buffer_description){ GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED, 4 * pairs, "sight" },
		&buffer[1], error));
	const gw_binding bindings[] = { GW_TRACE_BINDINGS(s->octree),   gw_whole(&buffer[0]),
									gw_whole(&s->places->position), gw_whole(&s->places->normal),
									gw_window(&buffer[1], 4),       GW_DISC_BINDINGS(s->octree),
									GW_TREE_BINDING(s->octree),     GW_OPACITY_BINDING(s->octree),
									GW_LEAF_BINDING(s->octree) };
	const gw_probe_push push = { .rays = s->places->count,
								 .orientation = GW_SIGHT_ORIENTATION,
								 .distance = GW_SIGHT_DISTANCE,
								 .reach = s->places->reach };
	GW_TRY(gw_passes_run(s->passes, GW_PASS_PROBE_SIGHT, bindings, &push, pairs, error));
	return gw_buffer_download(gpu, &buffer[1], 0, value, 4 * pairs, error);
}

gw_status gw_sight_look(const gw_sight *sight, const float *viewer, size_t count, float *value,
						gw_error *error)
{
	gw_status status = GW_OK;
	size_t places = sight->places->count, batch = places > 0 ? PAIRS / places : count;
	batch = batch > 0 ? batch : 1;
	for (size_t first = 0; first < count && places > 0 && status == GW_OK; first += batch) {
		gw_buffer buffer[2] = { { 0 }, { 0 } };
		size_t some = count - first < batch ? count - first : batch;
		status =
			look(sight, viewer + 4 * first, (uint32_t)some, buffer, value + first * places, error);
		gw_buffer_destroy(sight->passes->gpu, &buffer[0]);
		gw_buffer_destroy(sight->passes->gpu, &buffer[1]);
	}
	return status;
}

/*
 * probes.c - see probes.h. What probes see is the radiance that the points send out in the end.
 */
#include "bake/probes.h"
#include "glowworm_host.h"

#include "bake/scene_probes.h"
#include "bake/scene_records.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "light/direct_light.h"
#include "light/probe_cells.h"

#include <math.h>
#include <stdlib.h>

#define CHUNK 8192u /* surfels that a thread takes at a time */

/* ------------------------------------------------------------------------- what is sent out */

typedef struct sending {
	const gw_lighting *lighting;
	const float *direct; /* 4 a surfel, or NULL */
	float *radiance;     /* 4 a surfel */
} sending;

static float part(const float *values, size_t surfel, size_t c)
{
	return values ? values[4 * surfel + c] : 0.0f;
}

static void send(void *user, size_t first, size_t last, uint32_t worker)
{
	const sending *job = user;
	const gw_lighting *l = job->lighting;
	const gw_surfels *s = &l->scene->surfels;
	(void)worker;
	for (size_t i = first; i < last; i++) {
		size_t shown = gw_lighting_shown(l, (uint32_t)i);
		for (size_t c = 0; c < 3; c++)
			job->radiance[4 * i + c] =
				(s->emission ? s->emission[3 * shown + c] : 0.0f) +
				s->albedo[3 * shown + c] / GW_PI *
					(part(job->direct, shown, c) + part(l->surfel_first, shown, c) +
					 part(l->surfel_indirect, shown, c));
	}
}

/* The mean of what its surfels send out, of each facet. */
static gw_status average(gw_scene *scene, const float *radiance, gw_buffer buffer[2],
						 gw_error *error)
{
	const uint64_t bytes[2] = { 16 * (uint64_t)scene->surfels.count,
								16 * (uint64_t)scene->octree.facet_count };
	static const char *const name[] = { "radiance of surfels", "radiance of facets" };
	for (int i = 0; i < 2; i++)
		GW_TRY(gw_buffer_create(scene->gpu,
								&(gw_buffer_description){ GW_BUFFER_TEXEL,
														  VK_FORMAT_R32G32B32A32_SFLOAT, bytes[i],
														  name[i] },
								&buffer[i], error));
	GW_TRY(gw_buffer_upload(scene->gpu, &buffer[0], 0, radiance, bytes[0], error));
	return gw_average_facets(&scene->passes, &scene->octree, &buffer[0], &buffer[1], error);
}

/* What facets send out. */
static gw_status find_radiance(gw_lighting *lighting, gw_buffer *facets, gw_error *error)
{
	gw_scene *scene = lighting->scene;
	gw_buffer buffer[2] = { { 0 }, { 0 } };
	gw_view direct;
	GW_TRY(gw_lighting_choose_sides(lighting, error));
	GW_TRY(gw_lighting_view(lighting, &lighting->surfel_direct, &direct, error));
	sending job = { lighting, direct.bytes,
					gw_allocate_zeros(scene->surfels.count, 4 * sizeof *job.radiance) };
	gw_status status =
		job.radiance ? GW_OK
					 : gw_fail(error, GW_ERROR_MEMORY, "no memory for the radiance of %zu surfels",
							   scene->surfels.count);
	if (status == GW_OK) {
		gw_parallel_for(scene->options.threads, scene->surfels.count, CHUNK, send, &job);
		status = average(scene, job.radiance, buffer, error);
	}
	gw_view_close(&direct);
	free(job.radiance);
	gw_buffer_destroy(scene->gpu, &buffer[0]);
	if (status == GW_OK)
		*facets = buffer[1];
	else
		gw_buffer_destroy(scene->gpu, &buffer[1]);
	return status;
}

/* ------------------------------------------------------------------------------- what they see */

/* The sky's texels, where it has a map. */
static gw_status open_sky(const gw_lighting *lighting, gw_view *texel, gw_sky_view *sky,
						  gw_error *error)
{
	const gw_sky_map *map = &lighting->map;
	*sky = (gw_sky_view){ .radiance = lighting->plan.sky_radiance };
	if (!lighting->plan.map || map->width == 0)
		return GW_OK;
	GW_TRY(gw_view_open(lighting->scene->gpu, &map->texel, 16 * (uint64_t)map->width * map->height,
						texel, error));
	sky->map = map;
	sky->texel = texel->bytes;
	return GW_OK;
}

/* Brings the light into the units that were given. */
static gw_status undo_light(const gw_scene *scene, gw_probes *probes, gw_error *error)
{
	const size_t texels = (size_t)probes->size * probes->size;
	GW_TRY(gw_scaled_scene_undo_radiance(&scene->units, probes->radiance, probes->count * texels,
										 error));
	for (size_t i = 0; i < probes->count; i++)
		GW_TRY(gw_scaled_scene_undo_radiance(&scene->units, probes->probe[i].harmonic[0],
											 GW_PROBE_HARMONICS, error));
	return GW_OK;
}

/* Lights what the rays of the scene's probes met. */
static gw_status show(gw_lighting *lighting, gw_probes *probes, gw_error *error)
{
	gw_scene *scene = lighting->scene;
	gw_buffer facets = { 0 };
	gw_view texel = { 0 };
	gw_probe_scene seen = { .passes = &scene->passes,
							.octree = &scene->octree,
							.facet_radiance = &facets,
							.threads = scene->options.threads };
	GW_TRY(find_radiance(lighting, &facets, error));
	gw_status status = open_sky(lighting, &texel, &seen.sky, error);
	if (status == GW_OK)
		status = gw_probe_hits_show(&seen, &scene->probes.hits,
									gw_scene_metres(scene, (double)scene->octree.leaf_size), probes,
									error);
	gw_view_close(&texel);
	gw_buffer_destroy(scene->gpu, &facets);
	return status == GW_OK ? undo_light(scene, probes, error) : status;
}

/* A scene that began with a transport has the probes that this has, and can place no others: not
 * all of its surface is there. */
static gw_status check_kept(const gw_scene *scene, const gw_probe_numbers *wanted, gw_error *error)
{
	const char *name = scene->options.transport->name;
	double value[2];
	if (scene->probes.numbers.count == 0)
		return gw_fail(error, GW_ERROR_USAGE,
					   "%s: this transport has no probes; save one where probes are placed", name);
	const char *what = gw_probe_numbers_differ(&scene->probes.numbers, wanted, value);
	if (what == NULL)
		return GW_OK;
	return gw_fail(error, GW_ERROR_USAGE,
				   "%s: the %s of this transport is %s and that of these probes %s; they have to "
				   "be the same (0 stands for as many as it takes, or none)",
				   name, what, GW_SAID(value[0], 15), GW_SAID(value[1], 15));
}

/* Sees to it that the scene has the probes that are asked for. */
static gw_status find_probes(gw_scene *scene, const gw_probes_options *options, gw_error *error)
{
	const gw_probe_numbers wanted = gw_probe_numbers_of(options, scene->units.length);
	double value[2];
	if (gw_transport_is_read(scene->options.transport))
		return check_kept(scene, &wanted, error);
	if (scene->probes.numbers.count > 0 &&
		gw_probe_numbers_differ(&scene->probes.numbers, &wanted, value) == NULL)
		return GW_OK;
	gw_placed_probes_clear(&scene->probes);
	GW_TRY(gw_scene_find_compartments(scene, error));
	return gw_scene_place_probes(scene, options, false, &scene->probes, error);
}

gw_status gw_lighting_probes(gw_lighting *lighting, const gw_probes_options *options,
							 gw_probes *probes, gw_error *error)
{
	gw_scene *scene = lighting->scene;
	if (scene->octree.leaf_count == 0)
		return gw_fail(
			error, GW_ERROR_USAGE,
			"the scene has no octree, which probes are traced through; force that effect");
	GW_TRY(find_probes(scene, options, error));
	GW_TRY(gw_scene_describe_probes(scene, &scene->probes, false, probes, error));
	GW_TRY(show(lighting, probes, error));
	return gw_probe_cells_find(probes, scene->options.threads, error);
}

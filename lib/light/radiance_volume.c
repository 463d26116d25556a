/*
 * radiance_volume.c - see radiance_volume.h.
 */
#include "light/radiance_volume.h"

#include "base/memory.h"
#include "base/shared_math.h"
#include "light/shut_out.h"
#include "light/volume_cells.h"
#include "light/volume_labels.h"
#include "octree/compartments.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Rays by which cells are found to be buried: more, of one that stands free, never meet so many
 * backs by chance. */
#define LOOK_RAYS 16u

/* Turns of the pattern from one direction to the next: the golden section's. */
#define GOLDEN 0.618033988749895

static gw_status create_texels(gw_gpu *gpu, VkFormat format, uint64_t bytes, const char *name,
							   gw_buffer *buffer, gw_error *error)
{
	return gw_buffer_create(gpu, &(gw_buffer_description){ GW_BUFFER_TEXEL, format, bytes, name },
							buffer, error);
}

gw_volume_push gw_radiance_volume_push(const gw_radiance_volume *v)
{
	return (gw_volume_push){ .rays = v->rays,
							 .seed = v->seed,
							 .minimum = { v->minimum[0], v->minimum[1], v->minimum[2], v->size },
							 .columns = v->cells[0],
							 .rows = v->cells[1],
							 .layers = v->cells[2],
							 .terms = gw_radiance_volume_terms(v) };
}

/* Directions that share the sphere evenly: one on each of `rays` belts of equal area, a golden
 * section of a turn from the one before. */
static gw_status make_pattern(gw_gpu *gpu, uint32_t rays, gw_buffer *pattern, gw_error *error)
{
	float *direction = gw_allocate_zeros(rays, 4 * sizeof *direction);
	if (!direction)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %u directions", rays);
	for (size_t k = 0; k < rays; k++) {
		double height = 1.0 - (2.0 * (double)k + 1.0) / rays, level = sqrt(1.0 - height * height);
		double azimuth = 2.0 * M_PI * fmod((double)k * GOLDEN, 1.0);
		direction[4 * k] = (float)(level * cos(azimuth));
		direction[4 * k + 1] = (float)(level * sin(azimuth));
		direction[4 * k + 2] = (float)height;
	}
	gw_status status = create_texels(gpu, VK_FORMAT_R32G32B32A32_SFLOAT, 16 * (uint64_t)rays,
									 "directions of cells", pattern, error);
	if (status == GW_OK)
		status = gw_buffer_upload(gpu, pattern, 0, direction, 16 * (uint64_t)rays, error);
	free(direction);
	return status;
}

/* The centres of the cells that are listed, with the marks of their compartments. */
static gw_status put_centres(const gw_record_context *on, gw_radiance_volume *v, gw_error *error)
{
	gw_gpu *gpu = on->passes->gpu;
	float *centre = gw_allocate_array(v->count, 4 * sizeof *centre);
	if (!centre)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %u cells of a volume", v->count);
	for (size_t i = 0; i < v->count; i++) {
		float *at = centre + 4 * i;
		gw_volume_centre(v, v->cell[i], at);
		at[3] =
			(float)gw_compartment_mark(v->label ? v->label[i] : (uint32_t)GW_COMPARTMENT_UNKNOWN);
	}
	gw_buffer_destroy(gpu, &v->centre);
	gw_status status = create_texels(gpu, VK_FORMAT_R32G32B32A32_SFLOAT, 16 * (uint64_t)v->count,
									 "cells of a volume", &v->centre, error);
	if (status == GW_OK)
		status = gw_buffer_upload(gpu, &v->centre, 0, centre, 16 * (uint64_t)v->count, error);
	free(centre);
	return status;
}

/* Traces rays from all cells that are listed, into v->hit: looking, which side each saw first. */
static gw_status trace(const gw_record_context *on, bool looking, gw_radiance_volume *v,
					   gw_error *error)
{
	uint64_t rays = (uint64_t)v->rays * v->count;
	if (rays >= UINT32_MAX)
		return gw_fail(error, GW_ERROR_MEMORY,
					   "%u cells of a volume with %u rays each are more than 2^32 rays; ask for "
					   "fewer of either",
					   v->count, v->rays);
	gw_buffer_destroy(on->passes->gpu, &v->pattern);
	gw_buffer_destroy(on->passes->gpu, &v->hit);
	GW_TRY(make_pattern(on->passes->gpu, v->rays, &v->pattern, error));
	GW_TRY(gw_buffer_create(on->passes->gpu,
							&(gw_buffer_description){ GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED,
													  4 * rays, "hits of a volume's rays" },
							&v->hit, error));
	const gw_binding bindings[] = { GW_TRACE_BINDINGS(on->octree),  gw_whole(&v->centre),
									gw_whole(&v->pattern),          gw_window(&v->hit, 4),
									GW_DISC_BINDINGS(on->octree),   GW_TREE_BINDING(on->octree),
									GW_OPACITY_BINDING(on->octree), GW_LEAF_BINDING(on->octree) };
	gw_volume_push push = gw_radiance_volume_push(v);
	push.looking = looking;
	return gw_passes_run(on->passes, GW_PASS_VOLUME_RAYS, bindings, &push, rays, error);
}

/* Does a cell see mostly the backs of what its rays meet first? */
static bool is_buried(const uint32_t *met, uint32_t rays)
{
	uint32_t front = 0, back = 0;
	for (uint32_t k = 0; k < rays; k++) {
		front += met[k] < GW_VOLUME_MET_NOTHING;
		back += met[k] == GW_VOLUME_MET_BACK;
	}
	return back > front;
}

/* Leaves those that are not, with labels. */
static gw_status leave_free(const gw_record_context *on, gw_radiance_volume *v, gw_error *error)
{
	gw_view met = { 0 };
	uint32_t kept = 0;
	GW_TRY(gw_view_open(on->passes->gpu, &v->hit, 4 * (uint64_t)v->rays * v->count, &met, error));
	gw_status status = gw_volume_label_cells(on, met.bytes, v, error);
	for (size_t i = 0; i < v->count && status == GW_OK; i++) {
		if (is_buried((const uint32_t *)met.bytes + i * v->rays, v->rays))
			continue;
		v->cell[kept] = v->cell[i];
		if (v->label)
			v->label[kept] = v->label[i];
		kept++;
	}
	gw_view_close(&met);
	v->count = kept;
	return status;
}

/* The way from the grid to the cells that are listed. */
static gw_status number_cells(gw_gpu *gpu, gw_radiance_volume *v, gw_error *error)
{
	uint64_t cells = (uint64_t)v->cells[0] * v->cells[1] * v->cells[2];
	uint32_t *slot = gw_allocate_array(cells, sizeof *slot);
	if (!slot)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the %llu cells of a volume",
					   (unsigned long long)cells);
	memset(slot, 0xff, cells * sizeof *slot); /* GW_NONE */
	for (uint32_t i = 0; i < v->count; i++)
		slot[v->cell[i]] = i;
	gw_status status = gw_buffer_upload(gpu, &v->slot, 0, slot, 4 * cells, error);
	free(slot);
	return status;
}

static gw_status make_light(gw_gpu *gpu, gw_radiance_volume *v, gw_error *error)
{
	uint64_t bytes = 16 * (uint64_t)gw_radiance_volume_terms(v) * v->count;
	const VkFormat f4 = VK_FORMAT_R32G32B32A32_SFLOAT;
	GW_TRY(create_texels(gpu, f4, bytes, "radiance of a volume", &v->radiance, error));
	return create_texels(gpu, f4, bytes, "sum of a volume's radiance", &v->sum, error);
}

static gw_status put_right(const gw_record_context *on, gw_radiance_volume *v, gw_error *error)
{
	const gw_labelled_rays rays = { .label = v->label, .count = v->count, .rays = v->rays };
	return v->label ? gw_shut_out_hits_of(on, &rays, &v->hit, error) : GW_OK;
}

static gw_status make(const gw_record_context *on, const gw_volume_wish *wish,
					  gw_radiance_volume *v, gw_error *error)
{
	GW_TRY(gw_volume_lay_out(on, wish, v, error));
	uint64_t cells = (uint64_t)v->cells[0] * v->cells[1] * v->cells[2];
	/* First, because it is held against the memory that there is. */
	GW_TRY(create_texels(on->passes->gpu, VK_FORMAT_R32_UINT, 4 * cells, "cells of a grid",
						 &v->slot, error));
	GW_TRY(gw_volume_list_cells(on, wish, v, error));
	GW_TRY(put_centres(on, v, error));
	v->rays = LOOK_RAYS;
	v->looked = (uint64_t)v->rays * v->count;
	GW_TRY(trace(on, true, v, error));
	GW_TRY(leave_free(on, v, error));
	GW_TRY(put_centres(on, v, error));
	GW_TRY(number_cells(on->passes->gpu, v, error));
	v->rays = wish->rays;
	if (wish->rays > 0) {
		GW_TRY(trace(on, false, v, error));
		GW_TRY(put_right(on, v, error));
	} else {
		gw_buffer_destroy(on->passes->gpu, &v->hit);
	}
	return make_light(on->passes->gpu, v, error);
}

gw_status gw_radiance_volume_make(const gw_record_context *on, const gw_volume_wish *wish,
								  gw_radiance_volume *volume, gw_error *error)
{
	*volume = (gw_radiance_volume){ .order = wish->order, .seed = wish->seed };
	gw_status status = make(on, wish, volume, error);
	if (status != GW_OK)
		gw_radiance_volume_destroy(on->passes->gpu, volume);
	return status;
}

void gw_radiance_volume_destroy(gw_gpu *gpu, gw_radiance_volume *v)
{
	gw_buffer *const buffer[] = {
		&v->slot, &v->centre, &v->pattern, &v->hit, &v->radiance, &v->sum
	};
	for (size_t i = 0; i < sizeof buffer / sizeof *buffer; i++)
		gw_buffer_destroy(gpu, buffer[i]);
	free(v->label);
	free(v->cell);
	*v = (gw_radiance_volume){ 0 };
}

gw_status gw_radiance_volume_fill(gw_passes *passes, gw_radiance_volume *v,
								  const gw_volume_light *light, gw_error *error)
{
	const gw_sky_map *map = light->map && light->map->width > 0 ? light->map : NULL;
	gw_volume_push push = gw_radiance_volume_push(v);
	push.sky = (vec4){ light->sky[0], light->sky[1], light->sky[2], 0.0f };
	if (map) {
		push.sky_width = map->width;
		push.sky_height = map->height;
		push.sky_turn = map->turn;
		push.sky_y_up = map->y_up;
	}
	const gw_binding bindings[] = { gw_whole(&v->centre),
									gw_whole(&v->pattern),
									gw_window(&v->hit, 4 * v->rays),
									gw_whole(light->facets),
									gw_whole(map ? &map->texel : light->facets),
									gw_window(&v->radiance, 16 * gw_radiance_volume_terms(v)) };
	return gw_passes_run(passes, GW_PASS_VOLUME_FILL, bindings, &push, v->count, error);
}

gw_status gw_radiance_volume_add(gw_passes *passes, gw_radiance_volume *v, gw_error *error)
{
	return gw_light_add(passes, &v->radiance, &v->sum,
						(uint64_t)gw_radiance_volume_terms(v) * v->count, error);
}

gw_status gw_radiance_volume_clear_sum(gw_passes *passes, gw_radiance_volume *v, gw_error *error)
{
	return gw_buffer_fill(passes->gpu, &v->sum, 0, error);
}

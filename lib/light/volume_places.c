/*
 * volume_places.c - see volume_places.h.
 */
#include "light/volume_places.h"

#include "base/memory.h"
#include "base/shared_math.h"
#include "light/shut_out.h"
#include "octree/compartments.h"

#include <float.h>
#include <stdlib.h>

/* Surfels that are looked at in a run. */
#define CHUNK 65536u

/* Places to be lit. */
typedef struct places {
	const gw_buffer *position, *normal; /* texel buffers */
	uint32_t first, count;
	bool both_sides; /* some may be lit from both sides, by w of their normals */
	gw_buffer mark;  /* R32_UINT, of all places; empty where there is one compartment */
} places;

static gw_status create_rows(gw_gpu *gpu, uint32_t count, gw_volume_rows *rows, gw_error *error)
{
	const uint64_t bytes = 4 * (uint64_t)GW_VOLUME_WEIGHTS * count;
	gw_buffer_description row = { GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED, bytes,
								  "cells that light places" };
	*rows = (gw_volume_rows){ .count = count };
	gw_status status = gw_buffer_create(gpu, &row, &rows->cell, error);
	row.name = "weights of cells";
	if (status == GW_OK)
		status = gw_buffer_create(gpu, &row, &rows->weight, error);
	if (status != GW_OK)
		gw_volume_rows_destroy(gpu, rows);
	return status;
}

void gw_volume_rows_destroy(gw_gpu *gpu, gw_volume_rows *rows)
{
	gw_buffer_destroy(gpu, &rows->cell);
	gw_buffer_destroy(gpu, &rows->weight);
	rows->count = 0;
}

/* Keeps the marks of places with these labels. */
static gw_status put_marks(gw_gpu *gpu, uint32_t *label, size_t count, gw_buffer *mark,
						   gw_error *error)
{
	for (size_t i = 0; i < count; i++)
		label[i] = gw_compartment_mark(label[i]);
	GW_TRY(gw_buffer_create(gpu,
							&(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_R32_UINT,
													  4 * (uint64_t)count, "marks of places" },
							mark, error));
	return gw_buffer_upload(gpu, mark, 0, label, 4 * (uint64_t)count, error);
}

static gw_volume_push push_of(const gw_radiance_volume *volume, const places *at)
{
	gw_volume_push push = gw_radiance_volume_push(volume);
	push.place_first = at->first;
	push.both_sides = at->both_sides;
	push.marked = at->mark.handle != VK_NULL_HANDLE;
	return push;
}

static gw_status weigh(const gw_record_context *on, const gw_radiance_volume *v, const places *at,
					   const gw_volume_rows *rows, gw_error *error)
{
	const gw_volume_push push = push_of(v, at);
	const gw_binding bindings[] = { GW_TRACE_BINDINGS(on->octree),
									gw_whole(&v->slot),
									gw_whole(&v->centre),
									gw_whole(at->position),
									gw_whole(at->normal),
									gw_whole(push.marked ? &at->mark : &v->slot),
									gw_window(&rows->cell, 4 * GW_VOLUME_WEIGHTS),
									gw_window(&rows->weight, 4 * GW_VOLUME_WEIGHTS),
									GW_TREE_BINDING(on->octree) };
	return gw_passes_run(on->passes, GW_PASS_VOLUME_WEIGHTS, bindings, &push, at->count, error);
}

/* What is read: harmonics of the cells, and the most that comes of them. */
typedef struct reading {
	const gw_buffer *radiance;
	float most;
	gw_buffer *irradiance; /* of the places of this run */
} reading;

static gw_status read_places(const gw_record_context *on, const gw_radiance_volume *v,
							 const places *at, const gw_volume_rows *rows, const reading *of,
							 gw_error *error)
{
	gw_volume_push push = push_of(v, at);
	push.most = of->most;
	const gw_binding bindings[] = { gw_window(&rows->cell, 4 * GW_VOLUME_WEIGHTS),
									gw_window(&rows->weight, 4 * GW_VOLUME_WEIGHTS),
									gw_whole(at->normal), gw_whole(of->radiance),
									gw_window(of->irradiance, 16) };
	return gw_passes_run(on->passes, GW_PASS_VOLUME_READ, bindings, &push, at->count, error);
}

static places records_of(const gw_record_context *on)
{
	return (places){ .position = &on->records->position,
					 .normal = &on->records->normal,
					 .count = on->records->count };
}

gw_status gw_volume_weigh(const gw_record_context *on, const gw_radiance_volume *v,
						  const gw_volume_viewers *viewers, gw_volume_rows *rows, gw_error *error)
{
	gw_gpu *gpu = on->passes->gpu;
	places at = { .position = viewers->position,
				  .normal = viewers->normal,
				  .count = viewers->count };
	GW_TRY(create_rows(gpu, at.count, rows, error));
	gw_status status =
		viewers->label ? put_marks(gpu, viewers->label, at.count, &at.mark, error) : GW_OK;
	if (status == GW_OK)
		status = weigh(on, v, &at, rows, error);
	gw_buffer_destroy(gpu, &at.mark);
	if (status != GW_OK)
		gw_volume_rows_destroy(gpu, rows);
	return status;
}

gw_status gw_volume_weigh_records(const gw_record_context *on, const gw_radiance_volume *v,
								  gw_volume_rows *rows, gw_error *error)
{
	gw_volume_viewers viewers = { &on->records->position, &on->records->normal, on->records->count,
								  NULL };
	if (gw_compartments_several(on->octree))
		GW_TRY(gw_shut_out_label(on, &viewers.label, error));
	gw_status status = gw_volume_weigh(on, v, &viewers, rows, error);
	free(viewers.label);
	return status;
}

gw_status gw_volume_read_records(const gw_record_context *on, const gw_radiance_volume *v,
								 const gw_volume_rows *rows, float largest, gw_buffer *irradiance,
								 gw_error *error)
{
	const places at = records_of(on);
	const reading of = { &v->radiance, GW_PI * largest, irradiance };
	return read_places(on, v, &at, rows, &of, error);
}

static gw_status mark_surfels(const gw_record_context *on, size_t count, gw_buffer *mark,
							  gw_error *error)
{
	if (!gw_compartments_several(on->octree))
		return GW_OK;
	uint32_t *label = gw_allocate_array(count, sizeof *label);
	if (!label)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu surfels", count);
	for (size_t i = 0; i < count; i++)
		label[i] = gw_compartment_of_surfel(on->octree, i, false);
	gw_status status = put_marks(on->passes->gpu, label, count, mark, error);
	free(label);
	return status;
}

/* Surfels under way. */
typedef struct surfel_run {
	places at;
	gw_volume_rows rows;
	gw_buffer irradiance;
} surfel_run;

static gw_status read_chunks(const gw_record_context *on, const gw_radiance_volume *v,
							 size_t surfels, surfel_run *run, float *irradiance, gw_error *error)
{
	gw_gpu *gpu = on->passes->gpu;
	const reading of = { &v->sum, FLT_MAX, &run->irradiance };
	uint32_t chunk = surfels < CHUNK ? (uint32_t)surfels : CHUNK;
	GW_TRY(mark_surfels(on, surfels, &run->at.mark, error));
	GW_TRY(create_rows(gpu, chunk, &run->rows, error));
	GW_TRY(gw_buffer_create(gpu,
							&(gw_buffer_description){ GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED,
													  16 * (uint64_t)chunk, "surfel irradiance" },
							&run->irradiance, error));
	for (size_t first = 0; first < surfels; first += chunk) {
		run->at.first = (uint32_t)first;
		run->at.count = surfels - first < chunk ? (uint32_t)(surfels - first) : chunk;
		GW_TRY(weigh(on, v, &run->at, &run->rows, error));
		GW_TRY(read_places(on, v, &run->at, &run->rows, &of, error));
		GW_TRY(gw_buffer_download(gpu, &run->irradiance, 0, irradiance + 4 * first,
								  16 * (uint64_t)run->at.count, error));
	}
	return GW_OK;
}

gw_status gw_volume_read_surfels(const gw_record_context *on, const gw_radiance_volume *v,
								 size_t surfels, float *irradiance, gw_error *error)
{
	gw_gpu *gpu = on->passes->gpu;
	surfel_run run = { .at = { .position = &on->octree->surfel_position,
							   .normal = &on->octree->surfel_normal,
							   .both_sides = true } };
	gw_status status = read_chunks(on, v, surfels, &run, irradiance, error);
	gw_buffer_destroy(gpu, &run.at.mark);
	gw_buffer_destroy(gpu, &run.irradiance);
	gw_volume_rows_destroy(gpu, &run.rows);
	return status;
}

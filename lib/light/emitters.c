/*
 * emitters.c - see emitters.h.
 */
#include "light/emitters.h"

#include "base/alias_table.h"
#include "base/luminance.h"
#include "base/memory.h"
#include "octree/compartments.h"

#include <stdlib.h>
#include <string.h>

typedef struct emitter_row {
	uint32_t facet;
	uint32_t alias;
	float probability;
	uint32_t mark;
} emitter_row;

/* What a table of emitters is made from, emitters->count each. */
typedef struct table_room {
	emitter_row *rows; /* the table itself, where its buffer is in reach */
	double *share;
	gw_alias_row *alias;
} table_room;

/* Facets that emit, and their power. */
static uint32_t list_emitters(const float *radiance, const float *centre, size_t facets,
							  const table_room *room, double *total)
{
	uint32_t n = 0;
	*total = 0.0;
	for (size_t i = 0; i < facets; i++) {
		double power = gw_luminance(&radiance[4 * i]) * (double)centre[4 * i + 3];
		if (!(power > 0.0))
			continue;
		room->rows[n] = (emitter_row){ .facet = (uint32_t)i };
		room->share[n++] = power;
		*total += power;
	}
	return n;
}

/* Marks those that rock may keep apart from records. */
static void mark_rows(const gw_octree *octree, uint32_t n, emitter_row *rows)
{
	bool several = gw_compartments_several(octree);
	for (uint32_t i = 0; several && i < n; i++)
		rows[i].mark = gw_compartment_mark(gw_compartments_of_facets(octree)[rows[i].facet]);
}

static gw_status make_table(gw_gpu *gpu, const table_room *room, uint32_t n, gw_emitters *emitters,
							gw_error *error)
{
	uint64_t bytes = sizeof *room->rows * (uint64_t)emitters->count;
	GW_TRY(gw_alias_table_fill(room->alias, room->share, n, error));
	for (uint32_t i = 0; i < n; i++) {
		room->rows[i].alias = room->alias[i].alias;
		room->rows[i].probability = room->alias[i].probability;
	}
	for (uint32_t i = n; i < emitters->count; i++)
		room->rows[i] = (emitter_row){ 0 };
	return room->rows == emitters->table.mapped
			   ? GW_OK
			   : gw_buffer_upload(gpu, &emitters->table, 0, room->rows, bytes, error);
}

/* The table's buffer, and room to make it in: there, if that is in reach. */
static gw_status make_room(gw_gpu *gpu, gw_emitters *emitters, table_room *room, gw_error *error)
{
	const gw_buffer_description table = { GW_BUFFER_TEXEL, VK_FORMAT_R32G32B32A32_UINT,
										  sizeof *room->rows * (uint64_t)emitters->count,
										  "emitter table" };
	GW_TRY(gw_buffer_create_unset(gpu, &table, &emitters->table, error));
	room->rows = gw_gpu_shares_memory(gpu) ? emitters->table.mapped
										   : gw_allocate_array(emitters->count, sizeof *room->rows);
	room->share = gw_allocate_array(emitters->count, sizeof *room->share);
	room->alias = gw_allocate_array(emitters->count, sizeof *room->alias);
	return room->rows && room->share && room->alias
			   ? GW_OK
			   : gw_fail(error, GW_ERROR_MEMORY, "no memory for %u emitters", emitters->count);
}

static gw_status upload_table(gw_gpu *gpu, const gw_octree *octree, const float *radiance,
							  const float *centre, gw_emitters *emitters, gw_error *error)
{
	table_room room = { 0 };
	gw_status status = make_room(gpu, emitters, &room, error);
	if (status == GW_OK) {
		double total;
		uint32_t n = list_emitters(radiance, centre, octree->facet_count, &room, &total);
		emitters->power = (float)total;
		mark_rows(octree, n, room.rows);
		status = make_table(gpu, &room, n, emitters, error);
	}
	if (room.rows != emitters->table.mapped)
		free(room.rows);
	free(room.share);
	free(room.alias);
	return status;
}

static void count_emitters(const float *radiance, const float *centre, size_t facets,
						   gw_emitters *emitters)
{
	double emitting = 0.0, whole = 0.0, power = 0.0, square = 0.0;
	for (size_t i = 0; i < facets; i++) {
		double l = gw_luminance(&radiance[4 * i]), area = (double)centre[4 * i + 3];
		whole += area;
		if (!(l * area > 0.0))
			continue;
		emitters->count++;
		emitting += area;
		power += l * area;
		square += l * l * area;
	}
	emitters->area_share = whole > 0.0 ? emitting / whole : 0.0;
	emitters->evenness = square > 0.0 ? power * power / (square * whole) : 0.0;
}

gw_status gw_emitters_make(gw_gpu *gpu, const gw_octree *octree, const gw_buffer *radiance,
						   bool always, gw_emitters *emitters, gw_error *error)
{
	*emitters = (gw_emitters){ .radiance = radiance };
	size_t facets = octree->facet_count;
	if (radiance->bytes < 16 * facets)
		return GW_OK;
	gw_view values = { 0 }, centre = { 0 };
	gw_status status = gw_view_open(gpu, radiance, 16 * facets, &values, error);
	if (status == GW_OK)
		status = gw_view_open(gpu, &octree->facet_centre, 16 * facets, &centre, error);
	if (status == GW_OK)
		count_emitters(values.bytes, centre.bytes, facets, emitters);
	if (status == GW_OK && emitters->count > 0 && (always || gw_emitters_are_small(emitters)))
		status = upload_table(gpu, octree, values.bytes, centre.bytes, emitters, error);
	gw_view_close(&values);
	gw_view_close(&centre);
	return status;
}

void gw_emitters_destroy(gw_gpu *gpu, gw_emitters *emitters)
{
	gw_buffer_destroy(gpu, &emitters->table);
	*emitters = (gw_emitters){ 0 };
}

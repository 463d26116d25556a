/*
 * rows_apart.c - see rows_apart.h.
 */
#include "light/rows_apart.h"

#include "base/memory.h"
#include "light/shut_out.h"
#include "light/transport_layout.h"
#include "octree/compartments.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Rows being parted. */
typedef struct parting {
	const gw_octree *octree;
	const gw_records *records;
	uint32_t *label;              /* of each record */
	const float *place, *facing;  /* of each record, 4 */
	const float *centre, *plane;  /* of each facet, 4 */
	const uint32_t *row;          /* likewise, 1 */
	const float *surfel, *normal; /* of each surfel, 4 */
} parting;

/* What a row is of: its place, and what it looks into to both sides. */
typedef struct row_owner {
	const float *place, *normal;
	uint32_t front, back;
} row_owner;

static bool is_apart(const row_owner *of, uint32_t label)
{
	return gw_compartments_apart(of->front, label) && label != of->back;
}

/* How many of the records of a row may stay; they come first. *kept receives their weight. */
static uint32_t keep(const parting *p, const row_owner *of, uint32_t *record, float *weight,
					 uint32_t length, float *kept)
{
	uint32_t n = 0;
	*kept = 0.0f;
	for (uint32_t i = 0; i < length; i++) {
		if (is_apart(of, p->label[record[i]]))
			continue;
		record[n] = record[i];
		weight[n++] = weight[i];
		*kept += weight[i];
	}
	return n;
}

/* The nearest record of its own compartment, or GW_NONE: as passes find it among all. */
static uint32_t find_nearest(const parting *p, const row_owner *of)
{
	uint32_t nearest = GW_NONE;
	float least = INFINITY;
	for (uint32_t r = 0; r < p->records->count; r++) {
		const float *at = p->place + 4 * (size_t)r, *n = p->facing + 4 * (size_t)r;
		float squared = 0.0f, cosine = 0.0f;
		if (p->label[r] != of->front)
			continue;
		for (int k = 0; k < 3; k++) {
			squared += (of->place[k] - at[k]) * (of->place[k] - at[k]);
			cosine += of->normal[k] * n[k];
		}
		float cost = sqrtf(squared) * (1.5f - cosine);
		if (cost < least) {
			least = cost;
			nearest = r;
		}
	}
	return nearest;
}

/* Parts a row. Returns how many records it has then. */
static uint32_t part_row(const parting *p, const row_owner *of, uint32_t *record, float *weight,
						 uint32_t length)
{
	float kept;
	uint32_t n = keep(p, of, record, weight, length, &kept);
	if (n == length)
		return n;
	for (uint32_t i = 0; i < n && kept > 0.0f; i++)
		weight[i] /= kept;
	if (kept > 0.0f)
		return n;
	record[0] = find_nearest(p, of);
	weight[0] = 1.0f;
	return record[0] == GW_NONE ? 0 : 1;
}

static bool is_row_apart(const parting *p, const row_owner *of, const uint32_t *record,
						 uint32_t length)
{
	bool apart = false;
	for (uint32_t i = 0; i < length && !apart; i++)
		apart = is_apart(of, p->label[record[i]]);
	return apart;
}

/* ------------------------------------------------------------------------------------- surfels */

/* Rows become shorter in place. */
static void part_surfels(const parting *p, gw_read_back *b)
{
	uint32_t used = 0, begin = 0;
	for (size_t i = 0; i < b->count; i++) {
		uint32_t end = b->first[i + 1], length = end - begin;
		const row_owner of = { p->surfel + 4 * i, p->normal + 4 * i,
							   gw_compartment_of_surfel(p->octree, i, false),
							   gw_compartment_of_surfel(p->octree, i, true) };
		length = part_row(p, &of, b->record + begin, b->weight + begin, length);
		memmove(b->record + used, b->record + begin, length * sizeof *b->record);
		memmove(b->weight + used, b->weight + begin, length * sizeof *b->weight);
		b->first[i] = used;
		used += length;
		begin = end;
	}
	b->first[b->count] = used;
}

/* -------------------------------------------------------------------------------------- facets */

static row_owner owner_of_facet(const parting *p, size_t facet)
{
	return (row_owner){ p->centre + 4 * facet, p->plane + 4 * facet,
						gw_compartments_of_facets(p->octree)[facet], GW_COMPARTMENT_UNKNOWN };
}

static uint32_t facet_row_length(const uint32_t *record)
{
	uint32_t n = 0;
	while (n < GW_WEIGHTS && record[n] != GW_NONE)
		n++;
	return n;
}

/* The first facet whose row has a record of another compartment, or how many there are. */
static size_t find_apart(const parting *p, const uint32_t *record)
{
	size_t facet = 0, facets = p->octree->facet_count;
	for (; facet < facets; facet++) {
		const uint32_t *row = record + GW_WEIGHTS * (size_t)p->row[facet];
		const row_owner of = owner_of_facet(p, facet);
		if (is_row_apart(p, &of, row, facet_row_length(row)))
			break;
	}
	return facet;
}

/* Those from `first` on. */
static void part_rows_of_facets(const parting *p, size_t first, uint32_t *record, float *weight)
{
	for (size_t facet = first; facet < p->octree->facet_count; facet++) {
		uint32_t *row = record + GW_WEIGHTS * (size_t)p->row[facet];
		float *row_weight = weight + GW_WEIGHTS * (size_t)p->row[facet];
		const row_owner of = owner_of_facet(p, facet);
		uint32_t length = facet_row_length(row);
		uint32_t kept = part_row(p, &of, row, row_weight, length);
		for (uint32_t i = kept; i < length; i++) {
			row[i] = GW_NONE;
			row_weight[i] = 0.0f;
		}
	}
}

static gw_status part_facets(const gw_record_context *on, const parting *p, gw_error *error)
{
	gw_gpu *gpu = on->passes->gpu;
	gw_records *r = on->records;
	gw_view view = { 0 };
	gw_edit record, weight = { 0 };
	GW_TRY(gw_view_open(gpu, &r->facet_record, r->facet_record.bytes, &view, error));
	size_t first = find_apart(p, view.bytes);
	gw_view_close(&view);
	if (first == p->octree->facet_count)
		return GW_OK;
	GW_TRY(gw_edit_open(gpu, &r->facet_record, &record, error));
	gw_status status = gw_edit_open(gpu, &r->facet_weight, &weight, error);
	bool opened = status == GW_OK;
	if (opened)
		part_rows_of_facets(p, first, record.bytes, weight.bytes);
	gw_edit *const edit[] = { &record, &weight };
	for (int i = 0; i < 2; i++) {
		gw_status closed = gw_edit_close(gpu, edit[i], opened, error);
		status = status == GW_OK ? closed : status;
	}
	return status;
}

/* ---------------------------------------------------------------------------------------- both */

typedef struct views {
	gw_view place, facing, centre, plane, row, surfel, normal;
} views;

static gw_status open_views(const gw_record_context *on, size_t surfels, views *v, gw_error *error)
{
	const gw_octree *o = on->octree;
	const gw_records *r = on->records;
	const uint64_t facets = 16 * (uint64_t)o->facet_count, records = 16 * (uint64_t)r->count;
	const struct {
		const gw_buffer *buffer;
		uint64_t bytes;
		gw_view *view;
	} rows[] = { { &r->position, records, &v->place },
				 { &r->normal, records, &v->facing },
				 { &o->facet_centre, facets, &v->centre },
				 { &o->facet_plane, facets, &v->plane },
				 { &r->facet_row, facets / 4, &v->row },
				 { &o->surfel_position, 16 * (uint64_t)surfels, &v->surfel },
				 { &o->surfel_normal, 16 * (uint64_t)surfels, &v->normal } };
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
		GW_TRY(gw_view_open(on->passes->gpu, rows[i].buffer, rows[i].bytes, rows[i].view, error));
	return GW_OK;
}

static void close_views(views *v)
{
	gw_view *const all[] = { &v->place, &v->facing, &v->centre, &v->plane,
							 &v->row,   &v->surfel, &v->normal };
	for (size_t i = 0; i < sizeof all / sizeof *all; i++)
		gw_view_close(all[i]);
}

gw_status gw_rows_part(const gw_record_context *on, gw_read_back *read_back, gw_error *error)
{
	parting p = { .octree = on->octree, .records = on->records };
	views v = { 0 };
	if (!gw_compartments_several(on->octree) || on->records->count == 0 ||
		on->records->facet_record.handle == VK_NULL_HANDLE || !read_back->first ||
		read_back->parted == on->records->count)
		return GW_OK;
	gw_status status = gw_shut_out_label(on, &p.label, error);
	if (status == GW_OK)
		status = open_views(on, read_back->count, &v, error);
	if (status == GW_OK) {
		p.place = v.place.bytes;
		p.facing = v.facing.bytes;
		p.centre = v.centre.bytes;
		p.plane = v.plane.bytes;
		p.row = v.row.bytes;
		p.surfel = v.surfel.bytes;
		p.normal = v.normal.bytes;
		status = part_facets(on, &p, error);
	}
	if (status == GW_OK) {
		part_surfels(&p, read_back);
		read_back->parted = on->records->count;
	}
	close_views(&v);
	free(p.label);
	return status;
}

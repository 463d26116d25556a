/*
 * PLY files as meshes: the vertices by ply_read, then the faces.
 */
#include "files/input_file.h"
#include "meshes/mesh.h"
#include "files/number_text.h"
#include "ply/ply_format.h"
#include "ply/ply_header.h"
#include "points/scan_color.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

typedef struct reader {
	const input_file *in;
	const ply_header *header;
	mesh *mesh;
	gw_error *error;
	const uint8_t *at, *end; /* what is left of the body */
	bool ascii, swap;
	size_t element, entry; /* where we are, for messages */
	mesh_polygon polygon;
} reader;

static gw_status fail_entry(const reader *r, const char *what)
{
	return gw_fail(r->error, GW_ERROR_DATA, "%s: %.40s number %zu %s", r->in->name,
				   r->header->element[r->element].name, r->entry, what);
}

/* --------------------------------------------------------------------------------- values */

static gw_status take_text(reader *r, double *value)
{
	while (r->at < r->end && (*r->at <= ' '))
		r->at++;
	const uint8_t *first = r->at;
	while (r->at<r->end && * r->at> ' ')
		r->at++;
	size_t length = (size_t)(r->at - first);
	if (length == 0)
		return fail_entry(r, "is missing or cut short; the file is damaged");
	if (number_read((const char *)first, length, value) != length)
		return fail_entry(r, "holds something that is no number");
	return GW_OK;
}

static gw_status take_bytes(reader *r, scan_type type, double *value)
{
	size_t size = scan_type_size(type);
	uint8_t b[8];
	if ((size_t)(r->end - r->at) < size)
		return fail_entry(r, "is missing or cut short; the file is damaged");
	for (size_t i = 0; i < size; i++)
		b[i] = r->at[r->swap ? size - 1 - i : i];
	r->at += size;
	scan_column one = { .type = type, .data = b };
	*value = scan_value(&one, 0);
	return GW_OK;
}

static gw_status take_value(reader *r, scan_type type, double *value)
{
	return r->ascii ? take_text(r, value) : take_bytes(r, type, value);
}

/* The length of a list, checked against the bytes that are left. */
static gw_status take_length(reader *r, const ply_property *property, size_t *length)
{
	double value;
	GW_TRY(take_value(r, property->count_type, &value));
	if (!(value >= 0.0 && value <= 0x1p32 && value == floor(value)))
		return fail_entry(r, "has a list whose length is no count");
	*length = (size_t)value;
	size_t least = r->ascii ? 2 : scan_type_size(property->type);
	if (*length > ((size_t)(r->end - r->at) + 1) / least)
		return fail_entry(r, "has a list that is longer than the file");
	return GW_OK;
}

static gw_status skip_property(reader *r, const ply_property *property)
{
	size_t length = 1;
	double ignored;
	GW_TRY(property->list ? take_length(r, property, &length) : GW_OK);
	if (property->list && !r->ascii) {
		size_t bytes = length * scan_type_size(property->type);
		if ((size_t)(r->end - r->at) < bytes)
			return fail_entry(r, "is missing or cut short; the file is damaged");
		r->at += bytes;
		return GW_OK;
	}
	for (size_t i = 0; i < length; i++)
		GW_TRY(take_value(r, property->type, &ignored));
	return GW_OK;
}

/* Skips an element with all its entries. Without lists that is one step. */
static gw_status skip_element(reader *r, const ply_element *element)
{
	size_t bytes = 0;
	bool lists = false;
	for (size_t k = 0; k < element->property_count; k++) {
		lists = lists || element->property[k].list;
		bytes += scan_type_size(element->property[k].type);
	}
	if (element->property_count == 0)
		return GW_OK;
	if (!r->ascii && !lists) {
		if (element->count > (size_t)(r->end - r->at) / bytes)
			return fail_entry(r, "and those behind it are missing; the file is damaged");
		r->at += element->count * bytes;
		return GW_OK;
	}
	for (r->entry = 0; r->entry < element->count; r->entry++)
		for (size_t k = 0; k < element->property_count; k++)
			GW_TRY(skip_property(r, &element->property[k]));
	return GW_OK;
}

/* ---------------------------------------------------------------------------------- faces */

static bool is_indices(const ply_property *property)
{
	return property->list && (strcmp(property->name, "vertex_indices") == 0 ||
							  strcmp(property->name, "vertex_index") == 0);
}

/* Corners have the normal with their own number, where there are normals. */
static gw_status take_face(reader *r, const ply_property *property)
{
	size_t length = 0;
	GW_TRY(take_length(r, property, &length));
	r->polygon.count = 0;
	for (size_t i = 0; i < length; i++) {
		double index;
		GW_TRY(take_value(r, property->type, &index));
		if (!(index >= 0.0 && index < (double)r->mesh->position_count && index == floor(index))) {
			char text[80];
			snprintf(text, sizeof text, "leads to vertex %.12g; there are %zu, from 0", index,
					 r->mesh->position_count);
			return fail_entry(r, text);
		}
		uint32_t corner = (uint32_t)index;
		GW_TRY(
			mesh_polygon_add(&r->polygon, corner, r->mesh->normal ? corner : MESH_NONE, r->error));
	}
	return mesh_add_polygon(r->mesh, &r->polygon, MESH_NONE, r->error);
}

static gw_status take_faces(reader *r, const ply_element *element)
{
	size_t own = 0;
	while (own < element->property_count && !is_indices(&element->property[own]))
		own++;
	if (own == element->property_count)
		return gw_fail(r->error, GW_ERROR_DATA,
					   "%s: its faces have no list 'vertex_indices', so they lead nowhere",
					   r->in->name);
	for (size_t k = 0; k < element->property_count && !r->mesh->color; k++)
		if (strcmp(element->property[k].name, "red") == 0)
			GW_TRY(mesh_add_note(r->mesh, r->error,
								 "%s: its faces have colours, which are not read; only those of "
								 "vertices are",
								 r->in->name));
	for (r->entry = 0; r->entry < element->count; r->entry++)
		for (size_t k = 0; k < element->property_count; k++)
			GW_TRY(k == own ? take_face(r, &element->property[k])
							: skip_property(r, &element->property[k]));
	return GW_OK;
}

static gw_status take_body(reader *r)
{
	const ply_header *h = r->header;
	bool found = false;
	for (r->element = 0; r->element < h->element_count && !found; r->element++) {
		const ply_element *element = &h->element[r->element];
		found = strcmp(element->name, "face") == 0;
		r->entry = 0;
		GW_TRY(found ? take_faces(r, element) : skip_element(r, element));
		if (found)
			break;
	}
	if (r->mesh->triangle_count == 0)
		return gw_fail(r->error, GW_ERROR_DATA, "%s holds no faces%s", r->in->name,
					   r->mesh->position_count ? "; it is a point cloud, which needs no sampling"
											   : " and no vertices");
	return GW_OK;
}

/* ------------------------------------------------------------------------------- vertices */

static gw_status take_colors(mesh *m, const scan *cloud, gw_error *error)
{
	scan_color color;
	if (!scan_color_find(cloud, scan_color_names, &color) || color.black)
		return GW_OK;
	m->color = reallocarray(NULL, cloud->count, 3 * sizeof *m->color);
	if (!m->color)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu colours", cloud->count);
	for (size_t i = 0; i < cloud->count; i++)
		for (size_t k = 0; k < 3; k++) {
			double value = scan_color_value(&color, (int)k, i);
			m->color[3 * i + k] = value > 0.0 ? (float)scan_srgb_decode(fmin(value, 1.0)) : 0.0f;
		}
	return GW_OK;
}

static gw_status take_vertices(mesh *m, const scan *cloud, const char *name, gw_error *error)
{
	static const char *const position_names[3] = { "x", "y", "z" };
	static const char *const normal_names[3] = { "nx", "ny", "nz" };
	const scan_column *position[3], *normal[3];
	size_t count = cloud->count;
	if (count >= MESH_NONE)
		return gw_fail(error, GW_ERROR_DATA, "%s has more than 4294967294 vertices", name);
	bool normals = scan_find_triple(cloud, normal_names, normal);
	if (!scan_find_triple(cloud, position_names, position))
		return gw_fail(error, GW_ERROR_DATA, "%s: its vertices have no x, y and z", name);
	m->position = reallocarray(NULL, count + 1, 3 * sizeof *m->position);
	m->normal = normals ? reallocarray(NULL, count + 1, 3 * sizeof *m->normal) : NULL;
	if (!m->position || (normals && !m->normal))
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu vertices", count);
	m->position_count = count;
	m->normal_count = normals ? count : 0;
	for (size_t i = 0; i < count; i++)
		for (size_t k = 0; k < 3; k++) {
			m->position[3 * i + k] = scan_value(position[k], i);
			if (normals)
				m->normal[3 * i + k] = (float)scan_value(normal[k], i);
		}
	return count ? take_colors(m, cloud, error) : GW_OK;
}

static gw_status read_faces(input_file *in, mesh *m, gw_error *error)
{
	ply_header header;
	scan comments = { 0 };
	gw_status status = ply_header_parse(&header, in, &comments, error);
	if (status == GW_OK) {
		bool big_host = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__;
		reader r = { .in = in,
					 .header = &header,
					 .mesh = m,
					 .error = error,
					 .at = in->data + header.body,
					 .end = in->data + in->length,
					 .ascii = header.encoding == PLY_ASCII,
					 .swap = big_host != (header.encoding == PLY_BIG_ENDIAN) };
		status = take_body(&r);
		mesh_polygon_clear(&r.polygon);
	}
	ply_header_clear(&header);
	scan_clear(&comments);
	return status;
}

gw_status mesh_ply_read(input_file *in, mesh *m, gw_error *error)
{
	*m = (mesh){ .format = &ply_format };
	scan cloud;
	gw_status status = ply_read(in, &cloud, error);
	if (status == GW_OK)
		status = take_vertices(m, &cloud, in->name, error);
	scan_clear(&cloud);
	if (status == GW_OK)
		status = read_faces(in, m, error);
	m->bare = !m->color;
	if (status != GW_OK)
		mesh_clear(m);
	return status;
}

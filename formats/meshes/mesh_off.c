/*
 * OFF files: the counts, vertices with or without normals and colours, faces. The variants with
 * texture coordinates, with four coordinates and in binary are refused.
 */
#include "files/input_file.h"
#include "meshes/mesh.h"
#include "meshes/mesh_text.h"
#include "meshes/mesh_vertices.h"
#include "points/scan_color.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct reader {
	const input_file *in;
	mesh *mesh;
	mesh_text text;
	gw_error *error;
	mesh_polygon polygon;
	bool colors, normals; /* of the vertices, by the first word */
	size_t faces;
} reader;

/* OFF, COFF, NOFF and CNOFF, which end the word. */
bool mesh_off_probe(const uint8_t *head, size_t length)
{
	size_t at = 0;
	at += at < length && head[at] == 'C';
	at += at < length && head[at] == 'N';
	return length >= at + 4 && memcmp(head + at, "OFF", 3) == 0 &&
		   (head[at + 3] == '\n' || head[at + 3] == '\r' || head[at + 3] == ' ');
}

static gw_status fail_line(const reader *r, const char *what)
{
	return gw_fail(r->error, GW_ERROR_DATA, "%s, line %zu: %s", r->in->name, r->text.line, what);
}

/* Goes to the next line that holds anything but a comment. */
static bool next_line(reader *r)
{
	while (mesh_text_next(&r->text)) {
		mesh_text peek = r->text;
		if (mesh_text_word(&peek).length > 0)
			return true;
	}
	return false;
}

/* Words of a line as numbers; returns how many there are, at most `most` and one. */
static gw_status take_numbers(reader *r, double *value, size_t most, size_t *count)
{
	*count = 0;
	for (mesh_text peek = r->text; mesh_text_word(&peek).length > 0; peek = r->text, ++*count) {
		if (*count == most)
			return fail_line(r, "there are more numbers than belong here");
		if (!mesh_text_number(&r->text, &value[*count]))
			return fail_line(r, "a number was expected");
	}
	return GW_OK;
}

/* The counts; every vertex takes at least the six bytes of "0 0 0" and a line's end, every face
 * two. */
static gw_status take_counts(reader *r)
{
	double v[3];
	size_t count;
	GW_TRY(take_numbers(r, v, 3, &count));
	double bytes = (double)r->in->length;
	if (count < 2 || !(v[0] >= 0.0) || !(v[1] >= 0.0))
		return fail_line(r, "the numbers of vertices and faces were expected");
	if (v[0] * 6.0 > bytes || v[1] * 2.0 > bytes || v[0] > (double)(MESH_NONE - 1))
		return fail_line(r, "the file is too short for so many vertices and faces");
	if (v[0] != (double)(size_t)v[0] || v[1] != (double)(size_t)v[1])
		return fail_line(r, "the numbers of vertices and faces have to be whole");
	r->mesh->position_count = (size_t)v[0];
	r->faces = (size_t)v[1];
	return GW_OK;
}

static gw_status take_head(reader *r)
{
	if (!next_line(r))
		return fail_line(r, "the file is empty");
	mesh_word word = mesh_text_word(&r->text);
	r->colors = word.length > 0 && word.text[0] == 'C';
	r->normals = word.length > (size_t)r->colors && word.text[r->colors] == 'N';
	mesh_text peek = r->text;
	mesh_word behind = mesh_text_word(&peek);
	if (mesh_word_is(behind, "BINARY"))
		return fail_line(r, "binary OFF cannot be read; save it as text");
	if (behind.length == 0 && !next_line(r))
		return fail_line(r, "the numbers of vertices and faces are missing");
	GW_TRY(take_counts(r));
	mesh *m = r->mesh;
	m->position = calloc(m->position_count + 1, 3 * sizeof *m->position);
	m->normal = r->normals ? calloc(m->position_count + 1, 3 * sizeof *m->normal) : NULL;
	m->color = r->colors ? calloc(m->position_count + 1, 3 * sizeof *m->color) : NULL;
	m->normal_count = r->normals ? m->position_count : 0;
	if (!m->position || (r->normals && !m->normal) || (r->colors && !m->color))
		return gw_fail(r->error, GW_ERROR_MEMORY, "no memory for the vertices of %s", r->in->name);
	return GW_OK;
}

/* Colours count to 255 when one is over 1, else to 1. */
static void put_color(float *to, const double *from)
{
	double full = from[0] > 1.0 || from[1] > 1.0 || from[2] > 1.0 ? 255.0 : 1.0;
	for (size_t k = 0; k < 3; k++) {
		double c = from[k] / full;
		to[k] = (float)scan_srgb_decode(c > 0.0 ? c < 1.0 ? c : 1.0 : 0.0);
	}
}

static gw_status take_vertices(reader *r)
{
	mesh *m = r->mesh;
	size_t needed = 3u + 3u * r->normals + 3u * r->colors;
	for (size_t i = 0; i < m->position_count; i++) {
		double v[10];
		size_t count = 0;
		if (!next_line(r))
			return fail_line(r, "the vertices end too early");
		GW_TRY(take_numbers(r, v, r->colors ? needed + 1 : needed, &count));
		if (count < needed)
			return fail_line(r, "a vertex has too few numbers");
		memcpy(m->position + 3 * i, v, 3 * sizeof *v);
		for (size_t k = 0; k < 3 && m->normal; k++)
			m->normal[3 * i + k] = (float)v[3 + k];
		if (m->color)
			put_color(m->color + 3 * i, v + needed - 3);
	}
	return GW_OK;
}

/* A count of corners, their indices; a colour behind them is the face's and is left out. */
static gw_status take_face(reader *r)
{
	double value;
	if (!mesh_text_number(&r->text, &value) || !(value >= 0.0 && value <= 1e9))
		return fail_line(r, "the number of a face's corners was expected");
	size_t corners = (size_t)value;
	r->polygon.count = 0;
	for (size_t c = 0; c < corners; c++) {
		if (!mesh_text_number(&r->text, &value))
			return fail_line(r, "a face has fewer corners than it says");
		if (!(value >= 0.0 && value < (double)r->mesh->position_count) ||
			value != (double)(uint32_t)value)
			return fail_line(r, "a corner is no vertex");
		uint32_t index = (uint32_t)value;
		GW_TRY(mesh_polygon_add(&r->polygon, index, r->normals ? index : MESH_NONE, r->error));
	}
	return mesh_add_polygon(r->mesh, &r->polygon, MESH_NONE, r->error);
}

/* ------------------------------------------------------------------------- vertices as points */

gw_status off_read(input_file *in, scan *cloud, gw_error *error)
{
	mesh m = { 0 };
	reader r = { .in = in, .mesh = &m, .text = mesh_text_start(in), .error = error };
	*cloud = (scan){ .up = 'z' };
	gw_status status = take_head(&r);
	if (status == GW_OK)
		status = take_vertices(&r);
	if (status == GW_OK)
		status = mesh_vertices_put(&m, r.faces > 0, cloud, error);
	mesh_clear(&m);
	if (status != GW_OK)
		scan_clear(cloud);
	return status;
}

static const char *const off_extensions[] = { "off", NULL };

const format off_format = {
	.name = "off",
	.description = "Object File Format, vertices or a mesh",
	.extensions = off_extensions,
	.probe = mesh_off_probe,
	.read = off_read,
};

/* --------------------------------------------------------------------------------------- mesh */

static gw_status read_faces(reader *r)
{
	GW_TRY(take_head(r));
	GW_TRY(take_vertices(r));
	for (size_t f = 0; f < r->faces; f++)
		GW_TRY(next_line(r) ? take_face(r) : fail_line(r, "the faces end too early"));
	if (r->mesh->triangle_count == 0)
		return gw_fail(r->error, GW_ERROR_DATA, "%s holds no faces of three corners", r->in->name);
	return GW_OK;
}

gw_status mesh_off_read(const input_file *in, mesh *m, gw_error *error)
{
	*m = (mesh){ .format = &off_format };
	reader r = { .in = in, .mesh = m, .text = mesh_text_start(in), .error = error };
	gw_status status = read_faces(&r);
	m->bare = !m->color;
	mesh_polygon_clear(&r.polygon);
	if (status != GW_OK)
		mesh_clear(m);
	return status;
}

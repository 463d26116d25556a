/*
 * OBJ files: vertices, normals, faces and the names of materials. The text is read twice, because
 * an index may lead to a vertex further down: first vertices and material files, then faces.
 */
#include "files/growing_table.h"
#include "files/input_file.h"
#include "meshes/mesh.h"
#include "meshes/mesh_text.h"
#include "meshes/mesh_vertices.h"
#include "files/number_text.h"
#include "points/scan_color.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

typedef struct reader {
	const input_file *in;
	const char *path;
	mesh *mesh;
	mesh_text text;
	gw_error *error;
	mesh_polygon polygon;
	size_t colors;            /* vertices with a colour, up to the first without */
	size_t vertices, normals; /* above the current line, for negative indices */
	bool points;              /* only vertices are wanted */
	bool faces;               /* there are some */
	uint32_t material;
	size_t undefined; /* usemtl lines whose material is nowhere */
	char undefined_name[44];
} reader;

static gw_status fail_line(const reader *r, mesh_word word, const char *wrong)
{
	char shown[44];
	return gw_fail(r->error, GW_ERROR_DATA, "%s, line %zu: '%s' %s", r->in->name, r->text.line,
				   mesh_word_show(word, shown), wrong);
}

static gw_status fail_memory(const reader *r)
{
	return gw_fail(r->error, GW_ERROR_MEMORY, "no memory for the vertices of %s", r->in->name);
}

/* ------------------------------------------------------------------------------- vertices */

/* v x y z, with w or with red green blue (0..1, sRGB-encoded) behind it. */
static gw_status take_vertex(reader *r)
{
	mesh *m = r->mesh;
	double v[6];
	size_t count = 0;
	for (mesh_word word; (word = mesh_text_word(&r->text)).length > 0; count++)
		if (count == 6 || number_read(word.text, word.length, &v[count]) != word.length)
			return fail_line(r, word, "where a coordinate was expected");
	if (count < 3)
		return gw_fail(r->error, GW_ERROR_DATA, "%s, line %zu: a vertex needs x, y and z",
					   r->in->name, r->text.line);
	double *position = growing_table_room(m->position, m->position_count, 3 * sizeof *position);
	if (!position)
		return fail_memory(r);
	m->position = position;
	memcpy(position + 3 * m->position_count, v, 3 * sizeof *v);
	if (count == 6 && r->colors == m->position_count) {
		float *color = growing_table_room(m->color, r->colors, 3 * sizeof *color);
		if (!color)
			return fail_memory(r);
		m->color = color;
		for (size_t k = 0; k < 3; k++)
			color[3 * r->colors + k] = (float)scan_srgb_decode(fmin(fmax(v[3 + k], 0.0), 1.0));
		r->colors++;
	}
	m->position_count++;
	return GW_OK;
}

static gw_status take_normal(reader *r)
{
	mesh *m = r->mesh;
	double v[3];
	for (int k = 0; k < 3; k++) {
		mesh_text before = r->text;
		if (!mesh_text_number(&r->text, &v[k]))
			return fail_line(r, mesh_text_word(&before),
							 "where a normal's coordinate was expected");
	}
	float *normal = growing_table_room(m->normal, m->normal_count, 3 * sizeof *normal);
	if (!normal)
		return fail_memory(r);
	m->normal = normal;
	for (size_t k = 0; k < 3; k++)
		normal[3 * m->normal_count + k] = (float)v[k];
	m->normal_count++;
	return GW_OK;
}

/* ------------------------------------------------------------------------- material files */

/* The path of a file that the OBJ file names, from its folder. */
static bool name_beside(const char *obj, mesh_word name, char path[PATH_MAX])
{
	const char *slash = strrchr(obj, '/');
	if (name.length == 0 || name.length >= PATH_MAX || memchr(name.text, '\0', name.length))
		return false;
	bool own = *name.text == '/' || !slash;
	int length = snprintf(path, PATH_MAX, "%.*s%.*s", own ? 0 : (int)(slash - obj) + 1, obj,
						  (int)name.length, name.text);
	return length > 0 && length < PATH_MAX;
}

/* Only regular files: a name out of a file must not make us wait for a device. */
static bool open_beside(const reader *r, mesh_word name, input_file *in)
{
	char path[PATH_MAX];
	struct stat info;
	return name_beside(r->path, name, path) && stat(path, &info) == 0 && S_ISREG(info.st_mode) &&
		   input_file_open(in, path, NULL) == GW_OK;
}

/* One name with blanks in it, else several names. */
static gw_status take_library(reader *r)
{
	mesh_word whole = mesh_text_rest(&r->text), word = whole;
	char shown[44];
	input_file in;
	bool one = open_beside(r, whole, &in);
	gw_status status = GW_OK;
	while (status == GW_OK && (one || (word = mesh_text_word(&r->text)).length > 0)) {
		if (one || open_beside(r, word, &in)) {
			status = input_file_check(&in, mesh_mtl_read(&in, r->mesh, r->error), r->error);
			input_file_close(&in);
		} else {
			status = mesh_add_note(r->mesh, r->error, "%s: its materials, '%s', cannot be read",
								   r->in->name, mesh_word_show(word, shown));
		}
		if (one)
			break;
	}
	return status;
}

/* ---------------------------------------------------------------------------------- faces */

/* An index from 1, or from -1 backwards. */
/* What an index leads to. */
typedef struct indexed {
	const char *what;
	size_t count, above; /* of the whole file, and above this line */
} indexed;

static gw_status take_index(const reader *r, mesh_word word, const char **at, indexed of,
							uint32_t *index)
{
	const char *end = word.text + word.length;
	bool negative = *at < end && **at == '-';
	uint64_t value = 0;
	const char *first = *at += negative;
	for (; *at < end && **at >= '0' && **at <= '9' && value < UINT32_MAX; ++*at)
		value = 10 * value + (uint64_t)(**at - '0');
	if (*at == first || (*at < end && **at != '/'))
		return fail_line(r, word, "where the indices of a corner were expected");
	if (value == 0 || value > (negative ? of.above : of.count)) {
		char wrong[120];
		snprintf(wrong, sizeof wrong, "leads to no %s; there are %zu%s", of.what,
				 negative ? of.above : of.count, negative ? " above this line" : "");
		return fail_line(r, word, wrong);
	}
	*index = (uint32_t)(negative ? of.above - value : value - 1);
	return GW_OK;
}

/* v, v/t, v//n or v/t/n. */
static gw_status take_corner(reader *r, mesh_word word)
{
	const char *at = word.text, *end = word.text + word.length;
	const indexed vertices = { "vertex", r->mesh->position_count, r->vertices };
	const indexed normals = { "normal", r->mesh->normal_count, r->normals };
	uint32_t corner, normal = MESH_NONE;
	GW_TRY(take_index(r, word, &at, vertices, &corner));
	if (at < end) {
		/* Texture coordinates are not needed, so their index is not looked at. */
		for (at++; at < end && *at != '/';)
			at++;
		if (at < end && ++at < end)
			GW_TRY(take_index(r, word, &at, normals, &normal));
	}
	if (at < end)
		return fail_line(r, word, "where the indices of a corner were expected");
	return mesh_polygon_add(&r->polygon, corner, normal, r->error);
}

static gw_status take_face(reader *r)
{
	mesh_word word;
	r->polygon.count = 0;
	while ((word = mesh_text_word(&r->text)).length > 0)
		GW_TRY(take_corner(r, word));
	return mesh_add_polygon(r->mesh, &r->polygon, r->material, r->error);
}

static void take_use(reader *r)
{
	mesh_word name = mesh_text_rest(&r->text);
	r->material = mesh_find_material(r->mesh, name.text, name.length);
	if (r->material == MESH_NONE && r->undefined++ == 0)
		mesh_word_show(name, r->undefined_name);
}

/* ------------------------------------------------------------------------------ the whole */

static gw_status first_pass(reader *r)
{
	r->text = mesh_text_start(r->in);
	while (mesh_text_next(&r->text)) {
		mesh_word key = mesh_text_word(&r->text);
		if (memchr(key.text, '\0', key.length))
			return fail_line(r, key, "is no text; this is no OBJ file");
		if (mesh_word_is(key, "v"))
			GW_TRY(take_vertex(r));
		else if (mesh_word_is(key, "vn"))
			GW_TRY(take_normal(r));
		else if (mesh_word_is(key, "mtllib") && !r->points)
			GW_TRY(take_library(r));
		else if (mesh_word_is(key, "f"))
			r->faces = true;
	}
	if (r->mesh->position_count >= MESH_NONE || r->mesh->normal_count >= MESH_NONE)
		return gw_fail(r->error, GW_ERROR_DATA, "%s has more than 4294967294 vertices",
					   r->in->name);
	return GW_OK;
}

static gw_status second_pass(reader *r)
{
	r->text = mesh_text_start(r->in);
	r->material = MESH_NONE;
	while (mesh_text_next(&r->text)) {
		mesh_word key = mesh_text_word(&r->text);
		if (mesh_word_is(key, "v"))
			r->vertices++;
		else if (mesh_word_is(key, "vn"))
			r->normals++;
		else if (mesh_word_is(key, "usemtl"))
			take_use(r);
		else if (mesh_word_is(key, "f"))
			GW_TRY(take_face(r));
	}
	return GW_OK;
}

/* Colours count when every vertex has one. */
static gw_status check_colors(reader *r)
{
	mesh *m = r->mesh;
	if (r->colors == 0 || r->colors == m->position_count)
		return GW_OK;
	free(m->color);
	m->color = NULL;
	return mesh_add_note(m, r->error,
						 "%s: vertex %zu has no colour but others have, so colours are left out",
						 r->in->name, r->colors + 1);
}

static gw_status finish(reader *r)
{
	mesh *m = r->mesh;
	if (m->triangle_count == 0)
		return gw_fail(r->error, GW_ERROR_DATA, "%s holds no faces (%zu vertices)", r->in->name,
					   m->position_count);
	GW_TRY(check_colors(r));
	if (r->undefined > 0)
		GW_TRY(mesh_add_note(m, r->error,
							 "%s: the material '%s' is nowhere defined; its faces get an albedo "
							 "of %g",
							 r->in->name, r->undefined_name, (double)GW_ALBEDO_DEFAULT));
	m->bare = m->material_count == 0 && !m->color && r->undefined == 0;
	return GW_OK;
}

gw_status mesh_obj_read(const input_file *in, const char *path, mesh *m, gw_error *error)
{
	*m = (mesh){ .format = &obj_format };
	reader r = { .in = in, .path = path, .mesh = m, .error = error };
	gw_status status = first_pass(&r);
	if (status == GW_OK)
		status = second_pass(&r);
	if (status == GW_OK)
		status = finish(&r);
	mesh_polygon_clear(&r.polygon);
	if (status != GW_OK)
		mesh_clear(m);
	return status;
}

/* ------------------------------------------------------------------------- vertices as points */

/* Normals belong to corners of faces. Without faces they go with the vertices, one each. */
static gw_status read_vertices(reader *r, scan *cloud)
{
	GW_TRY(first_pass(r));
	if (r->mesh->position_count == 0)
		return gw_fail(r->error, GW_ERROR_DATA,
					   "%s holds no vertices; this is no OBJ file, or empty", r->in->name);
	GW_TRY(check_colors(r));
	if (r->faces)
		r->mesh->normal_count = 0;
	return mesh_vertices_put(r->mesh, r->faces, cloud, r->error);
}

gw_status obj_read(input_file *in, scan *cloud, gw_error *error)
{
	mesh m = { 0 };
	reader r = { .in = in, .path = "-", .mesh = &m, .error = error, .points = true };
	*cloud = (scan){ .up = 'z' };
	gw_status status = read_vertices(&r, cloud);
	mesh_clear(&m);
	if (status != GW_OK)
		scan_clear(cloud);
	return status;
}

bool mesh_obj_has_faces(const input_file *in)
{
	mesh_text text = mesh_text_start(in);
	while (mesh_text_next(&text))
		if (mesh_word_is(mesh_text_word(&text), "f"))
			return true;
	return false;
}

/* Every name on the line, and all of it as one. */
static gw_status name_libraries(mesh_text *line, const char *obj, mesh_obj_named *named, void *user,
								gw_error *error)
{
	char path[PATH_MAX];
	mesh_word word = mesh_text_rest(line);
	for (; word.length > 0; word = mesh_text_word(line))
		if (name_beside(obj, word, path))
			GW_TRY(named(user, path, error));
	return GW_OK;
}

gw_status mesh_obj_libraries(const char *path, mesh_obj_named *named, void *user, gw_error *error)
{
	input_file in;
	GW_TRY(input_file_open(&in, path, error));
	gw_status status = GW_OK;
	mesh_text text = mesh_text_start(&in);
	while (status == GW_OK && mesh_text_next(&text))
		if (mesh_word_is(mesh_text_word(&text), "mtllib"))
			status = name_libraries(&text, path, named, user, error);
	status = input_file_check(&in, status, error);
	input_file_close(&in);
	return status;
}

static const char *const extensions[] = { "obj", NULL };

const format obj_format = {
	.name = "obj",
	.description = "Wavefront OBJ, vertices or a mesh",
	.extensions = extensions,
	.custom_up = 'y', /* as programs for modelling write it: Blender, Maya, 3ds Max */
	.read = obj_read,
};

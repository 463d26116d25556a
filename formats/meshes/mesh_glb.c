/*
 * Binary glTF files as meshes: triangles, strips and fans with positions, normals, colours of
 * vertices and the colours and emission of materials. glTF has y up; the mesh is turned to z up.
 * Or as points: the vertices of its primitives of points, or of all when there are none.
 *
 * The document is gone through twice: first what there is, so that memory is taken once.
 */
#include "meshes/glb_nodes.h"
#include "glowworm_host.h"
#include "meshes/mesh.h"
#include "meshes/mesh_vertices.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MODE_POINTS = 0, MODE_TRIANGLES = 4, MODE_STRIP, MODE_FAN };

/* Which primitives are taken. */
typedef enum taking { TAKE_TRIANGLES, TAKE_POINTS, TAKE_VERTICES } taking;

/* One list of triangles of a mesh. */
typedef struct primitive {
	glb_values position, normal, color, index;
	bool has_normal, has_color, has_index;
	size_t mode, corners, triangles;
	size_t material; /* SIZE_MAX without */
} primitive;

typedef struct reader {
	glb_document document;
	mesh *mesh;
	taking taking;
	glb_placed *placed;
	size_t placed_count;
	size_t positions, normals, triangles; /* in all */
	size_t left_out;                      /* primitives that are not taken */
	bool colors;
} reader;

/* ------------------------------------------------------------------------------ materials */

static gw_status take_color(const reader *r, json_t *object, const char *key, size_t count,
							double most, float color[3])
{
	double v[4] = { 1, 1, 1, 1 };
	for (int k = 0; k < 3; k++)
		v[k] = (double)color[k];
	GW_TRY(glb_numbers(&r->document, object, key, v, count));
	for (int k = 0; k < 3; k++) {
		color[k] = (float)v[k];
		if (!(v[k] >= 0.0 && v[k] <= most))
			return glb_fail(&r->document, "'%s' has to be from 0 to %s", key, GW_SAID(most, 15));
	}
	return GW_OK;
}

static gw_status take_emission(const reader *r, json_t *object, mesh_material *m)
{
	double strength = 1.0;
	json_t *extension =
		json_object_get(json_object_get(object, "extensions"), "KHR_materials_emissive_strength");
	json_t *value = json_object_get(extension, "emissiveStrength");
	if (value)
		strength = json_is_number(value) ? json_number_value(value) : -1.0;
	if (!(strength >= 0.0 && strength <= 1e30))
		return glb_fail(&r->document, "'emissiveStrength' has to be from 0 to 1e30");
	GW_TRY(take_color(r, object, "emissiveFactor", 3, 1.0, m->emission));
	for (int k = 0; k < 3; k++)
		m->emission[k] *= (float)strength;
	return GW_OK;
}

/* What a texture would say is unknown: grey stands in for its colour, darkness for its light. */
static gw_status take_material(reader *r, json_t *object, mesh_material *m, size_t *textures)
{
	json_t *surface = json_object_get(object, "pbrMetallicRoughness");
	const char *name = json_string_value(json_object_get(object, "name"));
	*m = (mesh_material){ .name = strdup(name ? name : ""), .roughness = 1.0f };
	if (!m->name)
		return gw_fail(r->document.error, GW_ERROR_MEMORY, "no memory for the materials of %s",
					   r->document.in->name);
	for (int k = 0; k < 3; k++)
		m->albedo[k] = 1.0f;
	GW_TRY(take_color(r, surface, "baseColorFactor", 4, 1.0, m->albedo));
	GW_TRY(take_emission(r, object, m));
	bool painted = json_object_get(surface, "baseColorTexture");
	bool glows = json_object_get(object, "emissiveTexture");
	for (int k = 0; k < 3; k++) {
		m->albedo[k] *= painted ? GW_ALBEDO_DEFAULT : 1.0f;
		m->emission[k] *= glows ? 0.0f : 1.0f;
	}
	*textures += (size_t)painted + (size_t)glows;
	return GW_OK;
}

static gw_status take_materials(reader *r)
{
	mesh *m = r->mesh;
	json_t *list = json_object_get(r->document.root, "materials");
	size_t count = json_array_size(list), textures = 0;
	if (count >= MESH_NONE)
		return glb_fail(&r->document, "there are too many materials");
	m->material = calloc(count + 1, sizeof *m->material);
	if (!m->material)
		return gw_fail(r->document.error, GW_ERROR_MEMORY, "no memory for %zu materials", count);
	for (size_t i = 0; i < count; i++) {
		m->material_count = i + 1;
		GW_TRY(take_material(r, json_array_get(list, i), &m->material[i], &textures));
	}
	if (textures > 0)
		GW_TRY(mesh_add_note(m, r->document.error,
							 "%s has textures (%zu), which are not read; an albedo of %g and no "
							 "light stand in for them",
							 r->document.in->name, textures, (double)GW_ALBEDO_DEFAULT));
	return GW_OK;
}

/* ----------------------------------------------------------------------------- primitives */

/* An attribute with one element for each vertex. */
static gw_status find_attribute(const reader *r, json_t *attributes, const char *name,
								size_t vertices, glb_values *values, bool *found)
{
	size_t accessor;
	*found = false;
	GW_TRY(glb_size(&r->document, attributes, name, SIZE_MAX, &accessor));
	if (accessor == SIZE_MAX)
		return GW_OK;
	*found = true;
	GW_TRY(glb_find_values(&r->document, accessor, values));
	if (values->width != 3 && !(values->width == 4 && *name == 'C'))
		return glb_fail(&r->document, "accessors[%zu]: %s needs three numbers each", accessor,
						name);
	if (values->count != vertices && vertices > 0)
		return glb_fail(&r->document, "accessors[%zu]: %s has %zu entries for %zu vertices",
						accessor, name, values->count, vertices);
	return GW_OK;
}

static gw_status find_index(const reader *r, json_t *object, primitive *p)
{
	size_t accessor;
	p->has_index = false;
	p->corners = p->position.count;
	GW_TRY(glb_size(&r->document, object, "indices", SIZE_MAX, &accessor));
	if (accessor == SIZE_MAX)
		return GW_OK;
	p->has_index = true;
	GW_TRY(glb_find_values(&r->document, accessor, &p->index));
	unsigned type = p->index.component;
	if (p->index.width != 1 || (type != GLB_UINT8 && type != GLB_UINT16 && type != GLB_UINT32))
		return glb_fail(&r->document, "accessors[%zu]: indices have to be whole numbers", accessor);
	p->index.normalized = false;
	p->corners = p->index.count;
	return GW_OK;
}

static bool is_taken(const reader *r, size_t mode)
{
	return mode >= MODE_TRIANGLES ? r->taking != TAKE_POINTS
								  : mode == MODE_POINTS && r->taking != TAKE_TRIANGLES;
}

static gw_status find_primitive(const reader *r, json_t *object, primitive *p)
{
	json_t *attributes = json_object_get(object, "attributes");
	bool found;
	*p = (primitive){ .mode = 0 };
	GW_TRY(glb_size(&r->document, object, "mode", MODE_TRIANGLES, &p->mode));
	if (!is_taken(r, p->mode))
		return GW_OK;
	if (json_object_get(json_object_get(object, "extensions"), "KHR_draco_mesh_compression"))
		return glb_fail(&r->document, "its triangles are compressed by Draco, which is not read; "
									  "export it without compression");
	GW_TRY(find_attribute(r, attributes, "POSITION", 0, &p->position, &found));
	if (!found || p->mode > MODE_FAN)
		return glb_fail(&r->document, "a primitive has no POSITION, or an unknown mode");
	size_t vertices = p->position.count;
	GW_TRY(find_attribute(r, attributes, "NORMAL", vertices, &p->normal, &p->has_normal));
	GW_TRY(find_attribute(r, attributes, "COLOR_0", vertices, &p->color, &p->has_color));
	GW_TRY(find_index(r, object, p));
	GW_TRY(glb_size(&r->document, object, "material", SIZE_MAX, &p->material));
	if (p->material != SIZE_MAX && p->material >= r->mesh->material_count)
		return glb_fail(&r->document, "there is no materials[%zu]", p->material);
	p->triangles = r->taking != TAKE_TRIANGLES ? 0
				   : p->mode == MODE_TRIANGLES ? p->corners / 3
				   : p->corners >= 2           ? p->corners - 2
											   : 0;
	return GW_OK;
}

/* Bytes of a vertex with normal and colour, and of a triangle with its sum of areas. */
#define VERTEX_BYTES (3 * 8 + 6 * 4)
#define TRIANGLE_BYTES (7 * 4 + 8)

static gw_status count_primitive(reader *r, const primitive *p)
{
	if (!is_taken(r, p->mode)) {
		r->left_out++;
		return GW_OK;
	}
	r->positions += p->position.count;
	r->normals += p->has_normal ? p->position.count : 0;
	r->triangles += p->triangles;
	r->colors = r->colors || p->has_color;
	uint64_t available = gw_available_memory();
	if (r->positions >= MESH_NONE)
		return glb_fail(&r->document, "its nodes place more than 4294967294 vertices");
	if (available && r->positions > available / VERTEX_BYTES)
		return gw_fail(r->document.error, GW_ERROR_MEMORY,
					   "%s: its nodes place %zu vertices, more "
					   "than fit into memory",
					   r->document.in->name, r->positions);
	if (r->triangles > SIZE_MAX / 64 || (available && r->triangles > available / TRIANGLE_BYTES))
		return gw_fail(r->document.error, GW_ERROR_MEMORY,
					   "%s: its nodes place %zu triangles, "
					   "more than fit into memory",
					   r->document.in->name, r->triangles);
	return GW_OK;
}

/* ------------------------------------------------------------------------------- vertices */

static gw_status put_vertices(reader *r, const primitive *p)
{
	mesh *m = r->mesh;
	for (size_t i = 0; i < p->position.count; i++, m->position_count++) {
		double *to = m->position + 3 * m->position_count;
		for (size_t k = 0; k < 3; k++)
			to[k] = glb_value(&p->position, i, k);
		if (!isfinite(to[0]) || !isfinite(to[1]) || !isfinite(to[2]))
			return glb_fail(&r->document, "vertex %zu of a primitive is at no place", i);
	}
	for (size_t i = 0; i < p->position.count && p->has_normal; i++, m->normal_count++)
		for (size_t k = 0; k < 3; k++)
			m->normal[3 * m->normal_count + k] = (float)glb_value(&p->normal, i, k);
	return GW_OK;
}

/* Linear; the material's colour is a factor. */
static void put_colors(reader *r, const primitive *p, size_t first)
{
	mesh *m = r->mesh;
	const mesh_material *material = p->material == SIZE_MAX ? NULL : &m->material[p->material];
	for (size_t i = 0; i < p->position.count; i++)
		for (size_t k = 0; k < 3; k++) {
			double base = material       ? (double)material->albedo[k]
						  : p->has_color ? 1.0
										 : (double)GW_ALBEDO_DEFAULT;
			double own = p->has_color ? glb_value(&p->color, i, k) : 1.0;
			/* What is no number fails both comparisons. */
			own = own > 0.0 ? (own < 1.0 ? own : 1.0) : 0.0;
			m->color[3 * (first + i) + k] = (float)(base * own);
		}
}

/* Which corner of the list is corner c of triangle t; every second one of a strip goes round the
 * other way. */
static size_t corner_at(const primitive *p, size_t t, size_t c)
{
	if (p->mode == MODE_TRIANGLES)
		return 3 * t + c;
	if (p->mode == MODE_FAN)
		return c == 2 ? 0 : t + 1 + c;
	return t + (t % 2 && c > 0 ? 3 - c : c);
}

static gw_status put_triangles(reader *r, const primitive *p, size_t first, size_t first_normal)
{
	mesh *m = r->mesh;
	for (size_t t = 0; t < p->triangles; t++, m->triangle_count++) {
		for (size_t c = 0; c < 3; c++) {
			size_t at = corner_at(p, t, c);
			if (p->has_index)
				at = (size_t)glb_value(&p->index, at, 0);
			if (at >= p->position.count)
				return glb_fail(&r->document, "a triangle leads to vertex %zu; there are %zu", at,
								p->position.count);
			m->corner[3 * m->triangle_count + c] = (uint32_t)(first + at);
			m->corner_normal[3 * m->triangle_count + c] =
				p->has_normal ? (uint32_t)(first_normal + at) : MESH_NONE;
		}
		m->face_material[m->triangle_count] =
			p->material == SIZE_MAX ? MESH_NONE : (uint32_t)p->material;
	}
	m->faces = m->triangle_count;
	return GW_OK;
}

static gw_status put_primitive(reader *r, const primitive *p)
{
	size_t first = r->mesh->position_count, first_normal = r->mesh->normal_count;
	if (!is_taken(r, p->mode))
		return GW_OK;
	GW_TRY(put_vertices(r, p));
	if (r->colors)
		put_colors(r, p, first);
	return put_triangles(r, p, first, first_normal);
}

/* -------------------------------------------------------------------------------- the whole */

/* Does `put` with each primitive of a placed mesh. */
static gw_status each_primitive(reader *r, const glb_placed *placed, bool put)
{
	json_t *list = json_object_get(placed->mesh, "primitives");
	for (size_t i = 0; i < json_array_size(list); i++) {
		primitive p;
		GW_TRY(find_primitive(r, json_array_get(list, i), &p));
		GW_TRY(put ? put_primitive(r, &p) : count_primitive(r, &p));
	}
	return GW_OK;
}

static gw_status take_memory(reader *r)
{
	mesh *m = r->mesh;
	m->position = reallocarray(NULL, r->positions + 1, 3 * sizeof *m->position);
	m->normal = r->normals ? reallocarray(NULL, r->normals, 3 * sizeof *m->normal) : NULL;
	m->color = r->colors ? reallocarray(NULL, r->positions, 3 * sizeof *m->color) : NULL;
	m->corner = reallocarray(NULL, r->triangles + 1, 3 * sizeof *m->corner);
	m->corner_normal = reallocarray(NULL, r->triangles + 1, 3 * sizeof *m->corner_normal);
	m->face_material = reallocarray(NULL, r->triangles + 1, sizeof *m->face_material);
	m->triangle_capacity = r->triangles;
	if (m->position && m->corner && m->corner_normal && m->face_material &&
		(m->normal || !r->normals) && (m->color || !r->colors))
		return GW_OK;
	return gw_fail(r->document.error, GW_ERROR_MEMORY, "no memory for the %zu triangles of %s",
				   r->triangles, r->document.in->name);
}

static gw_status count_placed(reader *r)
{
	r->left_out = r->positions = r->normals = r->triangles = 0;
	for (size_t i = 0; i < r->placed_count; i++)
		GW_TRY(each_primitive(r, &r->placed[i], false));
	return GW_OK;
}

static gw_status count_all(reader *r)
{
	GW_TRY(count_placed(r));
	if (r->taking == TAKE_POINTS && r->positions == 0) {
		r->taking = TAKE_VERTICES;
		GW_TRY(count_placed(r));
	}
	if (r->taking == TAKE_TRIANGLES && r->triangles == 0)
		return glb_fail(&r->document, "it holds no triangles%s",
						r->left_out ? ", only points or lines" : "");
	if (r->positions == 0)
		return glb_fail(&r->document, "it holds no vertices");
	if (r->left_out > 0)
		GW_TRY(mesh_add_note(r->mesh, r->document.error, "%s: %zu primitive%s of %s %s left out",
							 r->document.in->name, r->left_out, gw_plural(r->left_out, "", "s"),
							 r->taking == TAKE_TRIANGLES ? "points or lines"
							 : r->taking == TAKE_POINTS  ? "lines or faces"
														 : "lines",
							 gw_plural(r->left_out, "is", "are")));
	return GW_OK;
}

static gw_status put_all(reader *r)
{
	GW_TRY(take_memory(r));
	for (size_t i = 0; i < r->placed_count; i++) {
		mesh_mark mark = mesh_mark_now(r->mesh);
		GW_TRY(each_primitive(r, &r->placed[i], true));
		mesh_transform_since(r->mesh, mark, r->placed[i].matrix);
	}
	mesh_stand(r->mesh, 'z');
	return GW_OK;
}

static gw_status read_parts(reader *r, const input_file *in, gw_error *error)
{
	*r->mesh = (mesh){ .format = &glb_format, .up = 'y' };
	GW_TRY(glb_open(&r->document, in, error));
	GW_TRY(take_materials(r));
	GW_TRY(glb_list_meshes(&r->document, &r->placed, &r->placed_count));
	GW_TRY(count_all(r));
	return put_all(r);
}

/* The document, and of it what is taken; *r is to be closed. */
static gw_status read_all(reader *r, const input_file *in, gw_error *error)
{
	gw_status status = read_parts(r, in, error);
	r->mesh->bare = r->mesh->material_count == 0 && !r->mesh->color;
	free(r->placed);
	glb_close(&r->document);
	return status;
}

gw_status mesh_glb_read(const input_file *in, mesh *m, gw_error *error)
{
	reader r = { .mesh = m };
	gw_status status = read_all(&r, in, error);
	if (status != GW_OK)
		mesh_clear(m);
	return status;
}

gw_status glb_read(input_file *in, scan *cloud, gw_error *error)
{
	mesh m;
	reader r = { .mesh = &m, .taking = TAKE_POINTS };
	*cloud = (scan){ .up = 'z' };
	gw_status status = read_all(&r, in, error);
	if (status == GW_OK)
		status = mesh_vertices_put(&m, r.taking == TAKE_VERTICES, cloud, error);
	mesh_clear(&m);
	if (status != GW_OK)
		scan_clear(cloud);
	return status;
}

bool mesh_glb_has_faces(const input_file *in)
{
	glb_document document;
	size_t mode, mesh_index, i;
	json_t *one, *list;
	bool faces = glb_open(&document, in, NULL) != GW_OK;
	json_array_foreach(json_object_get(document.root, "meshes"), mesh_index, one)
	{
		json_array_foreach(json_object_get(one, "primitives"), i, list)
		{
			gw_status status = glb_size(&document, list, "mode", MODE_TRIANGLES, &mode);
			faces = faces || status != GW_OK || mode >= MODE_TRIANGLES;
		}
	}
	glb_close(&document);
	return faces;
}

static const char *const extensions[] = { "glb", NULL };

const format glb_format = {
	.name = "glb",
	.description = "binary glTF 2.0, vertices or a mesh",
	.extensions = extensions,
	.probe = glb_probe,
	.read = glb_read,
};

/*
 * MTL files: the materials of OBJ meshes. Kd, Ks, Ke, Ns and Pr are taken; textures are named in a
 * note, everything else is left out.
 */
#include "files/growing_table.h"
#include "meshes/mesh.h"
#include "meshes/mesh_text.h"
#include "glowworm_host.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Names are searched one by one. */
#define MATERIALS 65536

typedef struct reader {
	const input_file *in;
	mesh *mesh;
	mesh_text text;
	gw_error *error;
	size_t textures;
} reader;

static gw_status fail_line(const reader *r, const char *expected)
{
	return gw_fail(r->error, GW_ERROR_DATA, "%s, line %zu: %s", r->in->name, r->text.line,
				   expected);
}

static gw_status take_material(reader *r)
{
	mesh *m = r->mesh;
	mesh_word name = mesh_text_rest(&r->text);
	if (name.length == 0)
		return fail_line(r, "newmtl needs a name");
	if (memchr(name.text, '\0', name.length))
		return fail_line(r, "a name cannot hold a zero");
	if (m->material_count == MATERIALS)
		return fail_line(r, "more than 65536 materials");
	mesh_material *grown = growing_table_room(m->material, m->material_count, sizeof *grown);
	if (grown)
		m->material = grown;
	char *copy = grown ? strndup(name.text, name.length) : NULL;
	if (!copy)
		return gw_fail(r->error, GW_ERROR_MEMORY, "no memory for the materials of %s", r->in->name);
	m->material[m->material_count++] =
		(mesh_material){ .name = copy,
						 .albedo = { GW_ALBEDO_DEFAULT, GW_ALBEDO_DEFAULT, GW_ALBEDO_DEFAULT },
						 .roughness = 1.0f };
	return GW_OK;
}

/* One number stands for three. */
static gw_status take_color(reader *r, const char *key, double most, float color[3])
{
	double v[3];
	char text[120];
	snprintf(text, sizeof text, "%s needs three numbers, 0 to %s", key, GW_SAID(most, 15));
	bool good = mesh_text_number(&r->text, &v[0]);
	mesh_text peek = r->text;
	bool one = good && mesh_text_word(&peek).length == 0;
	for (int k = 1; k < 3 && good; k++)
		good = one ? (v[k] = v[0], true) : mesh_text_number(&r->text, &v[k]);
	for (int k = 0; k < 3 && good; k++) {
		good = v[k] >= 0.0 && v[k] <= most;
		color[k] = (float)v[k];
	}
	return good ? GW_OK : fail_line(r, text);
}

static gw_status take_number(reader *r, const char *key, double most, double *value)
{
	char text[120];
	snprintf(text, sizeof text, "%s needs a number, 0 to %s", key, GW_SAID(most, 15));
	if (mesh_text_number(&r->text, value) && *value >= 0.0 && *value <= most)
		return GW_OK;
	return fail_line(r, text);
}

static gw_status take_property(reader *r, mesh_word key)
{
	mesh_material *m = &r->mesh->material[r->mesh->material_count - 1];
	float color[3];
	double value;
	if (mesh_word_is(key, "Kd"))
		return take_color(r, "Kd", 1.0, m->albedo);
	if (mesh_word_is(key, "Ke"))
		return take_color(r, "Ke", 1e30, m->emission);
	if (mesh_word_is(key, "Ks")) {
		GW_TRY(take_color(r, "Ks", 1e30, color));
		m->specular = (float)fmin(
			gw_relative_luminance((double)color[0], (double)color[1], (double)color[2]), 1.0);
		return GW_OK;
	}
	if (mesh_word_is(key, "Pr")) {
		GW_TRY(take_number(r, "Pr", 1.0, &value));
		m->roughness = (float)value;
		m->has_roughness = true;
		return GW_OK;
	}
	if (mesh_word_is(key, "Ns")) {
		/* Microfacets of width alpha = sqrt(2 / (Ns + 2)) have a highlight as wide as Phong's
		 * (Walter 2007); alpha is the square of the roughness. */
		GW_TRY(take_number(r, "Ns", 1e30, &value));
		if (!m->has_roughness)
			m->roughness = (float)sqrt(sqrt(2.0 / (value + 2.0)));
		return GW_OK;
	}
	r->textures += key.length > 4 && memcmp(key.text, "map_", 4) == 0;
	return GW_OK;
}

static gw_status take_line(reader *r)
{
	mesh_word key = mesh_text_word(&r->text);
	if (mesh_word_is(key, "newmtl"))
		return take_material(r);
	if (key.length == 0 || r->mesh->material_count == 0)
		return GW_OK;
	/* Colours as spectra or CIE XYZ are rare; what is not three numbers is refused. */
	return take_property(r, key);
}

gw_status mesh_mtl_read(const input_file *in, mesh *m, gw_error *error)
{
	reader r = { .in = in, .mesh = m, .text = mesh_text_start(in), .error = error };
	while (mesh_text_next(&r.text))
		GW_TRY(take_line(&r));
	if (r.textures > 0)
		GW_TRY(mesh_add_note(m, error, "%s names %zu texture%s not read; Kd stands in for %s",
							 in->name, r.textures,
							 gw_plural(r.textures, ", which is", "s, which are"),
							 gw_plural(r.textures, "it", "them")));
	return GW_OK;
}

#include "meshes/mesh.h"

#include "glowworm_picture.h"
#include "files/growing_table.h"
#include "meshes/mesh_sample.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Room for a note. */
#define NOTE 512

void mesh_clear_shape(mesh *m)
{
	for (size_t i = 0; i < m->material_count; i++)
		free(m->material[i].name);
	void **const table[] = { (void **)&m->material,      (void **)&m->position,
							 (void **)&m->color,         (void **)&m->normal,
							 (void **)&m->corner,        (void **)&m->corner_normal,
							 (void **)&m->face_material, (void **)&m->area_sum };
	for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
		free(*table[i]);
		*table[i] = NULL;
	}
	m->material_count = 0;
}

void mesh_clear(mesh *m)
{
	mesh_clear_shape(m);
	for (size_t i = 0; i < m->note_count; i++)
		free(m->note[i]);
	free(m->note);
	*m = (mesh){ 0 };
}

gw_status mesh_add_note(mesh *m, gw_error *error, const char *form, ...)
{
	char **grown = growing_table_room(m->note, m->note_count, sizeof *grown), text[NOTE];
	if (grown)
		m->note = grown;
	va_list arguments;
	va_start(arguments, form);
	vsnprintf(text, sizeof text, form, arguments);
	va_end(arguments);
	char *copy = grown ? strdup(text) : NULL;
	if (!copy)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a note");
	m->note[m->note_count++] = copy;
	return GW_OK;
}

uint32_t mesh_find_material(const mesh *m, const char *name, size_t length)
{
	for (size_t i = m->material_count; i-- > 0;)
		if (strlen(m->material[i].name) == length && memcmp(m->material[i].name, name, length) == 0)
			return (uint32_t)i;
	return MESH_NONE;
}

/* --------------------------------------------------------------------------------- moving */

static void transform_positions(mesh *m, size_t first, const double a[16])
{
	for (size_t i = first; i < m->position_count; i++) {
		double *p = m->position + 3 * i, v[3] = { p[0], p[1], p[2] };
		for (int k = 0; k < 3; k++)
			p[k] = a[4 * k] * v[0] + a[4 * k + 1] * v[1] + a[4 * k + 2] * v[2] + a[4 * k + 3];
	}
}

/* By the cofactors, which are the inverse transposed up to a factor. */
static void transform_normals(mesh *m, size_t first, const double a[16], bool mirrors)
{
	double c[9];
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
			c[3 * i + j] = a[4 * i1 + j1] * a[4 * i2 + j2] - a[4 * i1 + j2] * a[4 * i2 + j1];
		}
	for (size_t i = first; i < m->normal_count; i++) {
		float *n = m->normal + 3 * i;
		double v[3], length = 0.0;
		for (int k = 0; k < 3; k++) {
			v[k] =
				c[3 * k] * (double)n[0] + c[3 * k + 1] * (double)n[1] + c[3 * k + 2] * (double)n[2];
			length += v[k] * v[k];
		}
		/* A zero normal stays zero, for which the face's stands in. */
		double factor = length > 0.0 ? (mirrors ? -1.0 : 1.0) / sqrt(length) : 0.0;
		for (int k = 0; k < 3; k++)
			n[k] = (float)(v[k] * factor);
	}
}

static void swap(uint32_t *a, uint32_t *b)
{
	uint32_t kept = *a;
	*a = *b;
	*b = kept;
}

mesh_mark mesh_mark_now(const mesh *m)
{
	return (mesh_mark){ m->position_count, m->normal_count, m->triangle_count };
}

void mesh_transform_since(mesh *m, mesh_mark mark, const double a[16])
{
	double determinant = a[0] * (a[5] * a[10] - a[6] * a[9]) - a[1] * (a[4] * a[10] - a[6] * a[8]) +
						 a[2] * (a[4] * a[9] - a[5] * a[8]);
	transform_positions(m, mark.position, a);
	transform_normals(m, mark.normal, a, determinant < 0.0);
	for (size_t t = mark.triangle; t < m->triangle_count && determinant < 0.0; t++) {
		swap(&m->corner[3 * t + 1], &m->corner[3 * t + 2]);
		swap(&m->corner_normal[3 * t + 1], &m->corner_normal[3 * t + 2]);
	}
}

void mesh_transform(mesh *m, const double a[16])
{
	mesh_transform_since(m, (mesh_mark){ 0 }, a);
}

void mesh_stand(mesh *m, char up)
{
	double from[3][3], to[3][3], turn[16] = { [15] = 1 };
	if (!m->up || m->up == up)
		return;
	gw_camera_stand(m->up, from[0], from[1], from[2]);
	gw_camera_stand(up, to[0], to[1], to[2]);
	for (int row = 0; row < 3; row++)
		for (int column = 0; column < 3; column++)
			for (int k = 0; k < 3; k++)
				turn[4 * row + column] += to[k][row] * from[k][column];
	mesh_transform(m, turn);
	m->up = up;
}

gw_status mesh_measure(mesh *m, const char *name, gw_error *error)
{
	double *sum = reallocarray(m->area_sum, m->triangle_count + 1, sizeof *sum);
	if (!sum)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu triangles of %s",
					   m->triangle_count, name);
	m->area_sum = sum;
	m->area = gw_mesh_areas(m->position, m->corner, m->triangle_count, sum, &m->degenerate);
	if (!(m->area > 0.0))
		return gw_fail(error, GW_ERROR_DATA,
					   "%s: none of its %zu triangles has an area, so there is nothing to sample",
					   name, m->triangle_count);
	if (!isfinite(m->area))
		return gw_fail(error, GW_ERROR_DATA,
					   "%s: its area is too large for a number; its coordinates are not metres",
					   name);
	return GW_OK;
}

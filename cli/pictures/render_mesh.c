#include "pictures/render_mesh.h"
#include "scene/loaded_scene.h"
#include "meshes/mesh.h"
#include "scene/scene_file.h"
#include "meshes/mesh_reader.h"
#include "program/text_quote.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LONGEST 1.5f       /* edge of a triangle, in spacings of the points */
#define TRIANGLES 8000000u /* when there are so many, larger ones are made */

/* A triangle's corners and normals in the surfels' frame. */
static void place_triangle(const mesh *m, size_t triangle, const double origin[3], float corner[9],
						   float normal[9])
{
	double at[3][3], face[3], length = 0.0;
	for (size_t i = 0; i < 3; i++)
		for (size_t k = 0; k < 3; k++) {
			at[i][k] = m->position[3 * (size_t)m->corner[3 * triangle + i] + k] - origin[k];
			corner[3 * i + k] = (float)at[i][k];
		}
	for (int k = 0; k < 3; k++) {
		int a = (k + 1) % 3, b = (k + 2) % 3;
		face[k] = (at[1][a] - at[0][a]) * (at[2][b] - at[0][b]) -
				  (at[1][b] - at[0][b]) * (at[2][a] - at[0][a]);
		length += face[k] * face[k];
	}
	for (size_t i = 0; i < 3; i++) {
		uint32_t given = m->corner_normal[3 * triangle + i];
		const float *n = given == MESH_NONE ? NULL : m->normal + 3 * (size_t)given;
		float size = n ? sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) : 0.0f;
		bool good = size > 0.0f && isfinite(size);
		for (size_t k = 0; k < 3; k++)
			normal[3 * i + k] = good ? n[k] / size : (float)(face[k] / sqrt(length));
	}
}

static gw_status add_triangles(const mesh *m, const double origin[3], gw_tessellation *triangles,
							   gw_error *error)
{
	for (size_t i = 0; i < m->triangle_count; i++) {
		float corner[9], normal[9];
		/* A triangle without area has no place in the sum of areas either. */
		if (!(m->area_sum[i] > (i > 0 ? m->area_sum[i - 1] : 0.0)))
			continue;
		place_triangle(m, i, origin, corner, normal);
		bool finite = true;
		for (int k = 0; k < 9; k++)
			finite = finite && isfinite(corner[k]) && isfinite(normal[k]);
		if (finite)
			GW_TRY(gw_tessellation_add(triangles, corner, normal, error));
	}
	return GW_OK;
}

static gw_status read_meshes(const settings *list, char up, mesh *meshes, gw_error *error)
{
	size_t found = 0;
	for (size_t i = 0; i < list->input_count; i++) {
		const settings_input *from = list->input + i;
		if (!loaded_scene_is_mesh(list, from))
			continue;
		found++;
		GW_TRY(mesh_read(from->path, meshes + i, error));
		mesh_stand(meshes + i, up);
		if (from->has_matrix)
			mesh_transform(meshes + i, from->matrix);
		GW_TRY(mesh_measure(meshes + i, loaded_scene_input_name(from->path), error));
	}
	if (found == 0)
		return gw_fail(error, GW_ERROR_DATA,
					   "the scene of --mesh has no mesh among its inputs; name one that has, or a "
					   "mesh");
	return GW_OK;
}

/* Bounds of the points, and some more, for triangles that are half inside. */
static void find_bounds(const gw_surfels *s, gw_tessellation *triangles)
{
	for (size_t k = 0; k < 3; k++) {
		triangles->minimum[k] = INFINITY;
		triangles->maximum[k] = -INFINITY;
		for (size_t i = 0; i < s->count; i++) {
			float radius = s->radius[i], at = s->position[3 * i + k];
			triangles->minimum[k] = fminf(triangles->minimum[k], at - radius);
			triangles->maximum[k] = fmaxf(triangles->maximum[k], at + radius);
		}
	}
}

static gw_status cut_meshes(const mesh *meshes, size_t count, render_scene *scene, gw_error *error)
{
	gw_tessellation *triangles = &scene->triangles;
	gw_status status = GW_OK;
	find_bounds(&scene->surfels, triangles);
	triangles->most = TRIANGLES;
	triangles->longest = LONGEST * scene->surfels.spacing;
	do {
		triangles->count = 0;
		for (size_t i = 0; i < count && status == GW_OK; i++)
			status = add_triangles(meshes + i, scene->surfels.origin, triangles, error);
		triangles->longest *= 2.0f;
	} while (status == GW_OK && triangles->count == triangles->most && triangles->longest < 1e30f);
	triangles->longest *= 0.5f;
	return status;
}

static gw_status put_triangles(render_scene *scene, gw_error *error)
{
	const gw_tessellation *p = &scene->triangles;
	scene->index = reallocarray(NULL, p->count + 1, 3 * sizeof *scene->index);
	if (!scene->index)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu triangles", p->count);
	for (size_t i = 0; i < 3 * p->count; i++)
		scene->index[i] = (uint32_t)i;
	scene->raster.triangles = (gw_raster_triangles){ .count = p->count,
													 .vertex_count = 3 * p->count,
													 .index = scene->index,
													 .position = p->position,
													 .normal = p->normal,
													 .channel = p->channel };
	return GW_OK;
}

/* Triangles that no point is near are taken off, and so is a mesh that stands elsewhere. */
static void note_elsewhere(const settings *s, size_t on_mesh)
{
	if (on_mesh == 0 && !s->quiet)
		text_message(
			stderr,
			"glowworm: note: --mesh %s: no point lies on it, and so nothing of it is "
			"drawn; it has to stand where the points do, in metres, to which \"matrix\" in "
			"a scene file brings it\n",
			s->render.mesh);
}

static gw_status light_meshes(const settings *s, render_scene *scene, gw_error *error)
{
	uint8_t *on_mesh = calloc(scene->surfels.count, 1);
	if (!on_mesh)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the meshes");
	gw_status status =
		gw_mesh_light(&scene->triangles, &scene->surfels,
					  (gw_surfel_channels){ scene->channel, scene->raster.channel_count },
					  s->bake.threads, on_mesh, error);
	size_t count = 0;
	for (size_t i = 0; i < scene->surfels.count && status == GW_OK; i++)
		if (on_mesh[i]) {
			scene->surfels.radius[i] = 0.0f;
			count++;
		}
	free(on_mesh);
	if (status == GW_OK)
		note_elsewhere(s, count);
	return status == GW_OK ? put_triangles(scene, error) : status;
}

static gw_status list_meshes(const char *path, settings *list, gw_error *error)
{
	settings_input input = { .path = strdup(path), .mesh = true };
	if (!input.path)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a name");
	gw_status status = settings_add_input(list, &input, error); /* copies the path */
	free(input.path);
	return status == GW_OK && scene_is_file(path) ? scene_read(path, 0, list, error) : status;
}

gw_status render_mesh_add(const settings *s, render_scene *scene, gw_error *error)
{
	if (!s->render.mesh)
		return GW_OK;
	settings list = settings_default();
	gw_status status = list_meshes(s->render.mesh, &list, error);
	mesh *meshes = calloc(list.input_count + 1, sizeof *meshes);
	if (status == GW_OK && !meshes)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory for meshes");
	if (status == GW_OK)
		status = read_meshes(&list, settings_up_axis(s->up), meshes, error);
	if (status == GW_OK)
		status = cut_meshes(meshes, list.input_count, scene, error);
	for (size_t i = 0; meshes && i < list.input_count; i++)
		mesh_clear(meshes + i);
	free(meshes);
	settings_clear(&list);
	return status == GW_OK ? light_meshes(s, scene, error) : status;
}

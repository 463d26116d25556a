#include "pictures/box_mesh.h"

#include <stdlib.h>
#include <string.h>

/* Faces whose vertices 32 bits can count. */
#define FACES_MAX ((size_t)UINT32_MAX / 4)

static gw_status grow(box_mesh *m, gw_error *error)
{
	size_t room = m->face_room ? 2 * m->face_room : 1024;
	float *position = NULL, *channel = NULL;
	uint32_t *index = NULL;
	if (room <= FACES_MAX && (position = reallocarray(m->position, room, 12 * sizeof *position)))
		m->position = position;
	if (position &&
		(channel = reallocarray(m->channel, room, 4 * BOX_MESH_CHANNELS * sizeof *channel)))
		m->channel = channel;
	if (channel && (index = reallocarray(m->index, room, 6 * sizeof *index)))
		m->index = index;
	if (!index)
		return gw_fail(error, GW_ERROR_MEMORY,
					   "no memory to draw more than %zu faces of cells; choose a coarser level",
					   m->face_count);
	m->face_room = room;
	return GW_OK;
}

/* One square, counterclockwise from outside. */
static void add_face(box_mesh *m, const float low[3], float size, const float color[3],
					 unsigned face)
{
	static const float corner[4][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 } };
	static const uint32_t order[6] = { 0, 1, 2, 0, 2, 3 };
	size_t n = m->face_count++;
	unsigned axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
	bool front = face % 2 == 0;
	for (size_t c = 0; c < 4; c++) {
		float *p = m->position + 12 * n + 3 * c, *to = m->channel + (4 * n + c) * BOX_MESH_CHANNELS;
		p[axis] = low[axis] + (front ? size : 0.0f);
		p[u] = low[u] + corner[c][front ? 0 : 1] * size;
		p[v] = low[v] + corner[c][front ? 1 : 0] * size;
		memcpy(to, color, 3 * sizeof *to);
		to[BOX_MESH_U] = corner[c][0];
		to[BOX_MESH_V] = corner[c][1];
	}
	for (size_t k = 0; k < 6; k++)
		m->index[6 * n + k] = (uint32_t)(4 * n) + order[k];
}

gw_status box_mesh_add(box_mesh *m, const float low[3], float size, const float color[3],
					   unsigned faces, gw_error *error)
{
	for (unsigned face = 0; face < 6; face++) {
		if (!(faces & 1u << face))
			continue;
		if (m->face_count == m->face_room)
			GW_TRY(grow(m, error));
		add_face(m, low, size, color, face);
	}
	return GW_OK;
}

void box_mesh_clear(box_mesh *m)
{
	free(m->position);
	free(m->channel);
	free(m->index);
	*m = (box_mesh){ .index = NULL };
}

gw_raster_triangles box_mesh_triangles(const box_mesh *m)
{
	return (gw_raster_triangles){ .count = 2 * m->face_count,
								  .vertex_count = 4 * m->face_count,
								  .index = m->index,
								  .position = m->position,
								  .channel = m->channel };
}

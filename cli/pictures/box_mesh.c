#include "pictures/box_mesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Faces whose vertices 32 bits can count. */
#define FACES_MAX ((size_t)UINT32_MAX / 4)

/* Thickness of a frame's bars, as a share of the box. */
#define BAR 0.04f

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
					   "no memory to draw more than %zu faces; choose a coarser level, or a camera "
					   "that sees less",
					   m->face_count);
	m->face_room = room;
	return GW_OK;
}

/* Four corners, counterclockwise from outside; lines: whether it has edges to be seen. */
static gw_status add_quad(box_mesh *m, float corner[4][3], const float color[3], bool lines,
						  gw_error *error)
{
	static const float place[4][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 } };
	static const uint32_t order[6] = { 0, 1, 2, 0, 2, 3 };
	if (m->face_count == m->face_room)
		GW_TRY(grow(m, error));
	size_t n = m->face_count++;
	for (size_t c = 0; c < 4; c++) {
		float *to = m->channel + (4 * n + c) * BOX_MESH_CHANNELS;
		memcpy(m->position + 12 * n + 3 * c, corner[c], sizeof corner[c]);
		memcpy(to, color, 3 * sizeof *to);
		to[BOX_MESH_U] = lines ? place[c][0] : 0.5f;
		to[BOX_MESH_V] = lines ? place[c][1] : 0.5f;
	}
	for (size_t k = 0; k < 6; k++)
		m->index[6 * n + k] = (uint32_t)(4 * n) + order[k];
	return GW_OK;
}

/* What the sides of a box have in common. */
typedef struct box {
	float low[3], size[3];
	const float *color;
	bool lines;
} box;

static gw_status add_face(box_mesh *m, const box *b, unsigned face, gw_error *error)
{
	static const unsigned place[4][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 } };
	unsigned axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
	bool front = face % 2 == 0;
	float corner[4][3];
	for (size_t c = 0; c < 4; c++) {
		corner[c][axis] = b->low[axis] + (front ? b->size[axis] : 0.0f);
		corner[c][u] = b->low[u] + (place[c][front ? 0 : 1] ? b->size[u] : 0.0f);
		corner[c][v] = b->low[v] + (place[c][front ? 1 : 0] ? b->size[v] : 0.0f);
	}
	return add_quad(m, corner, b->color, b->lines, error);
}

gw_status box_mesh_add(box_mesh *m, const float low[3], float size, const float color[3],
					   unsigned faces, gw_error *error)
{
	const box cube = { { low[0], low[1], low[2] }, { size, size, size }, color, true };
	for (unsigned face = 0; face < 6; face++)
		if (faces & 1u << face)
			GW_TRY(add_face(m, &cube, face, error));
	return GW_OK;
}

gw_status box_mesh_add_edge(box_mesh *m, const float low[3], float size, unsigned edge,
							const float color[3], gw_error *error)
{
	unsigned axis = edge / 4, u = (axis + 1) % 3, v = (axis + 2) % 3;
	const float width = BAR * size;
	box bar = { .size = { width, width, width }, .color = color };
	for (unsigned k = 0; k < 3; k++)
		bar.low[k] = low[k] - 0.5f * width;
	bar.low[u] += edge & 1u ? size : 0.0f;
	bar.low[v] += edge & 2u ? size : 0.0f;
	bar.size[axis] = size + width;
	for (unsigned face = 0; face < 6; face++) /* ends meet those of others */
		if (face / 2 != axis)
			GW_TRY(add_face(m, &bar, face, error));
	return GW_OK;
}

gw_status box_mesh_add_disc(box_mesh *m, const float centre[3], const float normal[3], float radius,
							const float color[3], gw_error *error)
{
	static const unsigned quad[3][4] = { { 0, 1, 2, 3 }, { 0, 3, 4, 7 }, { 4, 5, 6, 7 } };
	float sign = normal[2] < 0.0f ? -1.0f : 1.0f, a = -1.0f / (sign + normal[2]);
	float b = normal[0] * normal[1] * a; /* a frame about the normal (Duff and others 2017) */
	const float t[3] = { 1.0f + sign * normal[0] * normal[0] * a, sign * b, -sign * normal[0] };
	const float s[3] = { b, sign + normal[1] * normal[1] * a, -normal[1] };
	for (size_t q = 0; q < 3; q++) {
		float corner[4][3];
		for (size_t c = 0; c < 4; c++) {
			float angle = (float)(M_PI / 4.0) * (float)quad[q][c];
			for (size_t k = 0; k < 3; k++)
				corner[c][k] = centre[k] + radius * (cosf(angle) * t[k] + sinf(angle) * s[k]);
		}
		GW_TRY(add_quad(m, corner, color, false, error));
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

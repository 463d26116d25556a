/*
 * Faces with more than three corners as triangles: convex ones as a fan, concave ones by cutting
 * off ears (corners whose triangle holds no other corner) in the plane of the face.
 */
#include "meshes/mesh.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Cutting ears takes time with up to the cube of the corners; more than this are cut into a fan. */
#define EAR_CORNERS 256

gw_status mesh_polygon_add(mesh_polygon *p, uint32_t corner, uint32_t normal, gw_error *error)
{
	if (p->count == p->capacity) {
		size_t capacity = p->capacity ? 2 * p->capacity : 8;
		uint32_t *corners = reallocarray(p->corner, capacity, sizeof *corners);
		if (corners)
			p->corner = corners;
		uint32_t *normals = corners ? reallocarray(p->normal, capacity, sizeof *normals) : NULL;
		if (!normals)
			return gw_fail(error, GW_ERROR_MEMORY, "no memory for a face of %zu corners", p->count);
		p->normal = normals;
		p->capacity = capacity;
	}
	p->corner[p->count] = corner;
	p->normal[p->count++] = normal;
	return GW_OK;
}

void mesh_polygon_clear(mesh_polygon *p)
{
	free(p->corner);
	free(p->normal);
	free(p->flat);
	free(p->order);
	*p = (mesh_polygon){ 0 };
}

/* Newell's normal: the area that the polygon has in each coordinate plane. */
static void find_normal(const mesh *m, const mesh_polygon *p, double normal[3])
{
	const double *origin = m->position + 3 * (size_t)p->corner[0];
	memset(normal, 0, 3 * sizeof *normal);
	for (size_t i = 0; i < p->count; i++) {
		const double *a = m->position + 3 * (size_t)p->corner[i];
		const double *b = m->position + 3 * (size_t)p->corner[(i + 1) % p->count];
		for (int k = 0; k < 3; k++) {
			int u = (k + 1) % 3, v = (k + 2) % 3;
			normal[k] +=
				(a[u] - origin[u]) * (b[v] - origin[v]) - (a[v] - origin[v]) * (b[u] - origin[u]);
		}
	}
}

/* Drops the axis along which the normal is longest; the polygon is counter-clockwise then. */
static void flatten(const mesh *m, mesh_polygon *p)
{
	double n[3];
	find_normal(m, p, n);
	int axis = 0;
	for (int k = 1; k < 3; k++)
		axis = fabs(n[k]) > fabs(n[axis]) ? k : axis;
	int u = (axis + 1) % 3, v = (axis + 2) % 3;
	double sign = n[axis] < 0.0 ? -1.0 : 1.0;
	const double *origin = m->position + 3 * (size_t)p->corner[0];
	for (size_t i = 0; i < p->count; i++) {
		const double *a = m->position + 3 * (size_t)p->corner[i];
		p->flat[2 * i] = a[u] - origin[u];
		p->flat[2 * i + 1] = sign * (a[v] - origin[v]);
	}
}

/* Twice the area of three corners, above 0 when they turn left. */
static double turn(const double *flat, uint32_t a, uint32_t b, uint32_t c)
{
	const double *p = flat + 2 * (size_t)a, *q = flat + 2 * (size_t)b, *r = flat + 2 * (size_t)c;
	return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
}

/* A fan from corner 0 is right when none of its triangles turns the other way; a convex polygon's
 * never does. */
static bool fan_is_right(const mesh_polygon *p)
{
	double area = 0.0;
	for (uint32_t i = 1; i + 1 < p->count; i++) {
		double part = turn(p->flat, 0, i, i + 1);
		area += part;
		if (!(part >= 0.0))
			return false;
	}
	return area > 0.0;
}

static bool is_ear(const mesh_polygon *p, const uint32_t *ring, size_t left, size_t at)
{
	const double *flat = p->flat;
	uint32_t a = ring[(at + left - 1) % left], b = ring[at], c = ring[(at + 1) % left];
	if (!(turn(flat, a, b, c) > 0.0))
		return false;
	for (size_t i = 0; i < left; i++) {
		uint32_t q = ring[i];
		const double *f = flat + 2 * (size_t)q;
		bool own = q == a || q == b || q == c;
		for (int k = 0; k < 3 && !own; k++) {
			const double *g = flat + 2 * (size_t)(k == 0 ? a : k == 1 ? b : c);
			own = f[0] == g[0] && f[1] == g[1];
		}
		if (!own && turn(flat, a, b, q) >= 0.0 && turn(flat, b, c, q) >= 0.0 &&
			turn(flat, c, a, q) >= 0.0)
			return false;
	}
	return true;
}

/* Cuts ears off until a triangle is left. Writes 3 * (count - 2) indices; false when no corner is
 * an ear, as happens when edges cross (the rest is a fan then), or the last triangle is inside out.
 */
static bool cut_ears(mesh_polygon *p, uint32_t *out)
{
	uint32_t ring[EAR_CORNERS];
	size_t left = p->count, at = 0, tried = 0;
	double area = 0.0;
	bool simple = true;
	assert(left >= 3);
	for (uint32_t i = 0; i < left; i++)
		ring[i] = i;
	while (left > 3) {
		bool ear = simple ? is_ear(p, ring, left, at) : at == 1;
		if (!ear) {
			at = (at + 1) % left;
			simple = simple && ++tried < left;
			continue;
		}
		area += turn(p->flat, ring[(at + left - 1) % left], ring[at], ring[(at + 1) % left]);
		*out++ = ring[(at + left - 1) % left];
		*out++ = ring[at];
		*out++ = ring[(at + 1) % left];
		memmove(ring + at, ring + at + 1, (left - at - 1) * sizeof *ring);
		left--;
		/* Going on behind the next corner keeps the triangles from becoming one long fan. */
		at = simple ? (at + 1) % left : 1;
		tried = 0;
	}
	memcpy(out, ring, 3 * sizeof *ring);
	/* All but the last triangle turn left; it does too, to rounding, unless edges cross. */
	return simple && turn(p->flat, ring[0], ring[1], ring[2]) >= -1e-9 * area;
}

static gw_status reserve_scratch(mesh_polygon *p, gw_error *error)
{
	if (p->scratch >= p->count)
		return GW_OK;
	double *flat = reallocarray(p->flat, p->count, 2 * sizeof *flat);
	if (flat)
		p->flat = flat;
	uint32_t *order = flat ? reallocarray(p->order, p->count, 3 * sizeof *order) : NULL;
	if (!order)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a face of %zu corners", p->count);
	p->order = order;
	p->scratch = p->count;
	return GW_OK;
}

static void cut(mesh *m, mesh_polygon *p)
{
	for (uint32_t i = 0; i + 2 < p->count; i++) {
		p->order[3 * i] = 0;
		p->order[3 * i + 1] = i + 1;
		p->order[3 * i + 2] = i + 2;
	}
	if (p->count == 3)
		return;
	flatten(m, p);
	if (fan_is_right(p))
		return;
	if (p->count > EAR_CORNERS || !cut_ears(p, p->order))
		m->faces_crossed++;
}

/* Room for n triangles more; tables grow by doubling. */
static gw_status reserve_triangles(mesh *m, size_t n, gw_error *error)
{
	size_t needed = m->triangle_count + n, capacity = m->triangle_capacity;
	if (needed <= capacity)
		return GW_OK;
	capacity = 2 * capacity > needed ? 2 * capacity : needed;
	uint32_t *corner = reallocarray(m->corner, capacity, 3 * sizeof *corner);
	if (corner)
		m->corner = corner;
	uint32_t *normal = reallocarray(m->corner_normal, capacity, 3 * sizeof *normal);
	if (normal)
		m->corner_normal = normal;
	uint32_t *material = reallocarray(m->face_material, capacity, sizeof *material);
	if (material)
		m->face_material = material;
	if (!corner || !normal || !material)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu triangles", needed);
	m->triangle_capacity = capacity;
	return GW_OK;
}

gw_status mesh_add_polygon(mesh *m, mesh_polygon *p, uint32_t material, gw_error *error)
{
	m->faces++;
	if (p->count < 3) {
		m->faces_flat++;
		return GW_OK;
	}
	size_t triangles = p->count - 2;
	GW_TRY(reserve_scratch(p, error));
	GW_TRY(reserve_triangles(m, triangles, error));
	cut(m, p);
	for (size_t i = 0; i < 3 * triangles; i++) {
		m->corner[3 * m->triangle_count + i] = p->corner[p->order[i]];
		m->corner_normal[3 * m->triangle_count + i] = p->normal[p->order[i]];
	}
	for (size_t i = 0; i < triangles; i++)
		m->face_material[m->triangle_count++] = material;
	return GW_OK;
}

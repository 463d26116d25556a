/* raster_shape.c - one disc or triangle as seen by the camera; see raster_steps.h. */
#include "picture/raster_steps.h"

#include "cloud/surfels.h"

#include <string.h>

#define CORNERS 16 /* of the polygon around a disc that the near plane cuts */

/* How far from the plane of a disc others belong to the same surface, in radii: points of a curved
 * surface lie r^2 / 2R beside the plane at distance r, and a scan's noise is of the order of its
 * spacing, which is about 0.6 radii. */
#define SAME_SURFACE 0.5f

static const float pi = 3.14159265f;

/* Bounds on the image plane. */
typedef struct bounds {
	float x0, x1, y0, y1;
} bounds;

static float dot(const float a[3], const float b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const float a[3], const float b[3], float c[3])
{
	c[0] = a[1] * b[2] - a[2] * b[1];
	c[1] = a[2] * b[0] - a[0] * b[2];
	c[2] = a[0] * b[1] - a[1] * b[0];
}

static void to_view(const gw_raster_view *view, const float world[3], float out[3])
{
	double v[3], w[3];
	for (int k = 0; k < 3; k++)
		w[k] = (double)world[k];
	gw_camera_turn(view->camera, w, v);
	for (int k = 0; k < 3; k++)
		out[k] = (float)v[k];
}

/* Subtracted before it is rounded, so that what is near the camera keeps its digits. */
static void place_in_view(const gw_raster_view *view, const float position[3], float out[3])
{
	double v[3], w[3];
	for (int k = 0; k < 3; k++)
		w[k] = (double)position[k] - view->eye[k];
	gw_camera_turn(view->camera, w, v);
	for (int k = 0; k < 3; k++)
		out[k] = (float)v[k];
}

/* From the image plane to whole samples; false when none is inside. */
static bool to_samples(const gw_raster_view *view, const bounds *b, gw_raster_shape *shape)
{
	float columns = (float)view->columns, rows = (float)view->rows;
	float x0 = ceilf(b->x0 / view->step + view->middle_x - 0.5f);
	float x1 = floorf(b->x1 / view->step + view->middle_x - 0.5f);
	float y0 = ceilf(view->middle_y - b->y1 / view->step - 0.5f);
	float y1 = floorf(view->middle_y - b->y0 / view->step - 0.5f);
	if (!(x0 <= x1 && y0 <= y1 && x0 < columns && y0 < rows && x1 >= 0.0f && y1 >= 0.0f))
		return false;
	shape->x0 = (int32_t)fmaxf(x0, 0.0f);
	shape->y0 = (int32_t)fmaxf(y0, 0.0f);
	shape->x1 = (int32_t)fminf(x1, columns - 1.0f);
	shape->y1 = (int32_t)fminf(y1, rows - 1.0f);
	return true;
}

/* Bounds of a convex polygon's part behind the near plane; false when there is none. */
static bool bound_polygon(float (*corner)[3], int count, float near, bounds *b)
{
	*b = (bounds){ INFINITY, -INFINITY, INFINITY, -INFINITY };
	for (int i = 0; i < count; i++) {
		const float *from = corner[i], *to = corner[(i + 1) % count];
		float point[2][3];
		int points = 0;
		if (from[2] >= near)
			memcpy(point[points++], from, sizeof *point);
		if ((from[2] < near) != (to[2] < near)) {
			float at = (near - from[2]) / (to[2] - from[2]);
			for (int k = 0; k < 2; k++)
				point[points][k] = from[k] + at * (to[k] - from[k]);
			point[points++][2] = near;
		}
		for (int p = 0; p < points; p++) {
			float x = point[p][0] / point[p][2], y = point[p][1] / point[p][2];
			*b = (bounds){ fminf(b->x0, x), fmaxf(b->x1, x), fminf(b->y0, y), fmaxf(b->y1, y) };
		}
	}
	return b->x0 <= b->x1;
}

/* ---------------------------------------------------------------------------------- discs */

/*
 * The outline of a disc on the image plane is a conic. A line l touches it when l' C l = 0 with
 * C = p p' - r^2 (1 - n n'); for the lines x = s that is C33 s^2 - 2 C13 s + C11 = 0.
 */
static void bound_outline(const float p[3], const float n[3], float radius, int k, float *low,
						  float *high)
{
	double r2 = (double)radius * (double)radius;
	double c33 = (double)p[2] * (double)p[2] - r2 * (1.0 - (double)n[2] * (double)n[2]);
	double c13 = (double)p[k] * (double)p[2] + r2 * (double)n[k] * (double)n[2];
	double c11 = (double)p[k] * (double)p[k] - r2 * (1.0 - (double)n[k] * (double)n[k]);
	double root = sqrt(fmax(c13 * c13 - c33 * c11, 0.0));
	*low = (float)((c13 - root) / c33);
	*high = (float)((c13 + root) / c33);
}

/* A disc that reaches through the near plane: the polygon around it, cut there. */
static bool bound_cut_disc(const gw_raster_view *view, const gw_raster_shape *s, float radius,
						   bounds *b)
{
	float corner[CORNERS][3], t[3], u[3];
	gw_tangent_frame(s->normal, t, u);
	radius /= cosf(pi / CORNERS);
	for (int i = 0; i < CORNERS; i++) {
		float angle = 2.0f * pi * (float)i / CORNERS;
		float c = radius * cosf(angle), d = radius * sinf(angle);
		for (int k = 0; k < 3; k++)
			corner[i][k] = s->middle[k] + c * t[k] + d * u[k];
	}
	return bound_polygon(corner, CORNERS, view->near, b);
}

/* Widens a disc that is narrower than a sample, and takes as much off its weight. */
static void widen(const gw_raster_view *view, gw_raster_shape *s, float radius, bounds *b)
{
	const float *p = s->middle;
	float distance = sqrtf(dot(p, p));
	float major = radius / (p[2] * view->step);
	float minor = major * fabsf(s->offset) / distance;
	s->widened = minor < 1.0f && p[2] >= view->near;
	if (!s->widened)
		return;
	float x = p[0] / p[2], y = p[1] / p[2], reach = GW_RASTER_WIDENED * view->step;
	s->centre_x = x / view->step + view->middle_x;
	s->centre_y = view->middle_y - y / view->step;
	s->weight *=
		fminf(1.0f, fmaxf(major * minor, 1e-12f) / (GW_RASTER_WIDENED * GW_RASTER_WIDENED));
	*b = (bounds){ fminf(b->x0, x - reach), fmaxf(b->x1, x + reach), fminf(b->y0, y - reach),
				   fmaxf(b->y1, y + reach) };
}

static void make_cuts(const gw_raster_view *view, size_t disc, gw_raster_shape *s)
{
	const gw_raster_discs *discs = &view->scene->discs;
	float t[3], u[3], scale = view->options->radius_scale;
	for (size_t c = 0; c < 2 && discs->clip; c++) {
		const float *clip = discs->clip + 6 * disc + 3 * c;
		if (clip[0] == 0.0f && clip[1] == 0.0f)
			continue;
		gw_tangent_frame(discs->normal + 3 * disc, t, u);
		float direction[3];
		for (int k = 0; k < 3; k++)
			direction[k] = clip[0] * t[k] + clip[1] * u[k];
		gw_raster_cut *cut = s->cut + s->cuts++;
		to_view(view, direction, cut->x);
		cut->offset = clip[2] * scale;
	}
}

float gw_raster_tolerance(const gw_raster_view *view, size_t disc)
{
	return SAME_SURFACE * (view->scene->discs.radius[disc] * view->options->radius_scale);
}

static bool make_disc(const gw_raster_view *view, size_t disc, gw_raster_shape *s)
{
	const gw_raster_discs *discs = &view->scene->discs;
	float radius = discs->radius[disc] * view->options->radius_scale;
	bounds b;
	place_in_view(view, discs->position + 3 * disc, s->middle);
	const float *p = s->middle;
	if (!(radius > 0.0f) || !(p[2] + radius >= view->near))
		return false;
	to_view(view, discs->normal + 3 * disc, s->normal);
	s->offset = dot(s->normal, p);
	bool two_sided = discs->two_sided && discs->two_sided[disc];
	if (s->offset > 0.0f && view->options->cull && !two_sided)
		return false;
	s->inverse = 1.0f / (radius * radius);
	s->tolerance = gw_raster_tolerance(view, disc);
	s->behind = s->offset > 0.0f && !two_sided ? s->tolerance : 0.0f;
	s->weight = 1.0f;
	if (p[2] - radius > view->near) {
		bound_outline(p, s->normal, radius, 0, &b.x0, &b.x1);
		bound_outline(p, s->normal, radius, 1, &b.y0, &b.y1);
	} else if (!bound_cut_disc(view, s, radius, &b)) {
		return false;
	}
	widen(view, s, radius, &b);
	if (!to_samples(view, &b, s))
		return false;
	if (!s->widened)
		make_cuts(view, disc, s);
	/* The tangent frame belongs to the normal as given, so it is turned over last. */
	if (two_sided && s->offset > 0.0f) {
		for (int k = 0; k < 3; k++)
			s->normal[k] = -s->normal[k];
		s->offset = -s->offset;
	}
	return true;
}

/* ------------------------------------------------------------------------------ triangles */

/* The normal of a triangle's front; false when it has no area. */
static bool turn_triangle(const gw_raster_view *view, size_t triangle, float normal[3])
{
	const gw_raster_triangles *mesh = &view->scene->triangles;
	const uint32_t *index = mesh->index + 3 * triangle;
	const float *origin = mesh->position + 3 * (size_t)index[0];
	float side[2][3], world[3];
	for (size_t k = 0; k < 3; k++) {
		side[0][k] = mesh->position[3 * (size_t)index[1] + k] - origin[k];
		side[1][k] = mesh->position[3 * (size_t)index[2] + k] - origin[k];
	}
	cross(side[0], side[1], world);
	float length = sqrtf(dot(world, world));
	for (int k = 0; k < 3; k++)
		world[k] /= length;
	to_view(view, world, normal);
	return length > 0.0f;
}

static bool make_triangle(const gw_raster_view *view, size_t triangle, gw_raster_shape *s)
{
	const gw_raster_triangles *mesh = &view->scene->triangles;
	float corner[3][3];
	bounds b;
	const uint32_t *index = mesh->index + 3 * triangle;
	for (int i = 0; i < 3; i++)
		place_in_view(view, mesh->position + 3 * (size_t)index[i], corner[i]);
	if (!bound_polygon(corner, 3, view->near, &b) || !to_samples(view, &b, s) ||
		!turn_triangle(view, triangle, s->normal))
		return false;
	s->offset = dot(s->normal, corner[0]);
	if (s->offset > 0.0f && view->options->cull)
		return false;
	/* The camera's frame is left-handed, so the edge functions of a front are positive. */
	for (int i = 0; i < 3; i++)
		cross(corner[(i + 1) % 3], corner[(i + 2) % 3], s->edge[i]);
	s->sign = dot(s->edge[0], corner[0]) < 0.0f ? -1.0f : 1.0f;
	return true;
}

void gw_raster_normal(const gw_raster_view *view, size_t primitive, float normal[3])
{
	const gw_raster_discs *discs = &view->scene->discs;
	float middle[3];
	if (primitive >= discs->count) {
		turn_triangle(view, primitive - discs->count, normal);
		return;
	}
	to_view(view, discs->normal + 3 * primitive, normal);
	if (!discs->two_sided || !discs->two_sided[primitive])
		return;
	place_in_view(view, discs->position + 3 * primitive, middle);
	float sign = dot(normal, middle) > 0.0f ? -1.0f : 1.0f;
	for (int k = 0; k < 3; k++)
		normal[k] *= sign;
}

void gw_raster_reach(const gw_raster_view *view, size_t primitive, float *near, float *tolerance)
{
	const gw_raster_discs *discs = &view->scene->discs;
	const gw_raster_triangles *mesh = &view->scene->triangles;
	float point[3];
	*near = INFINITY;
	*tolerance = 0.0f;
	if (primitive < discs->count) {
		float radius = discs->radius[primitive] * view->options->radius_scale;
		place_in_view(view, discs->position + 3 * primitive, point);
		*near = point[2] - radius;
		*tolerance = gw_raster_tolerance(view, primitive);
		return;
	}
	for (size_t i = 0; i < 3; i++) {
		size_t vertex = mesh->index[3 * (primitive - discs->count) + i];
		place_in_view(view, mesh->position + 3 * vertex, point);
		*near = fminf(*near, point[2]);
	}
}

bool gw_raster_shape_make(const gw_raster_view *view, size_t primitive, gw_raster_shape *s)
{
	*s = (gw_raster_shape){ .kind = GW_RASTER_DISC };
	if (primitive < view->scene->discs.count)
		return make_disc(view, primitive, s);
	s->kind = GW_RASTER_TRIANGLE;
	return make_triangle(view, primitive - view->scene->discs.count, s);
}

/* ------------------------------------------------------------------------------ fragments */

static gw_lanes choose(gw_lane_mask mask, gw_lanes yes, gw_lanes no)
{
	return (gw_lanes)((mask & (gw_lane_mask)yes) | (~mask & (gw_lane_mask)no));
}

/* The weight at a squared distance from the middle, relative to the rim's. It is 1 in the middle
 * and falls smoothly; at the rim a trace is left, so that what a disc covers has a weight. */
static gw_lanes kernel(gw_lanes squared)
{
	gw_lanes rest = 1.0f - squared;
	return rest * rest * rest + 1e-4f;
}

/* The rays' x, where z is 1. */
static gw_lanes ray_x(const gw_raster_view *view, int32_t column)
{
	const gw_lanes middles = { 0.5f, 1.5f, 2.5f, 3.5f };
	return ((float)column + middles - view->middle_x) * view->step;
}

static void meet_disc(const gw_raster_view *view, const gw_raster_shape *s, int32_t column,
					  int32_t row, gw_raster_fragments *f)
{
	gw_lanes x = ray_x(view, column);
	float y = gw_raster_ray_y(view, row);
	gw_lanes z = s->offset / (s->normal[0] * x + (s->normal[1] * y + s->normal[2]));
	gw_lanes q[3] = { z * x - s->middle[0], z * y - s->middle[1], z - s->middle[2] };
	gw_lanes squared = (q[0] * q[0] + q[1] * q[1] + q[2] * q[2]) * s->inverse;
	gw_lane_mask inside = (squared <= 1.0f) & (z >= view->near), beyond = { 0 };
	for (uint32_t c = 0; c < s->cuts; c++) {
		const gw_raster_cut *cut = s->cut + c;
		beyond |= cut->x[0] * q[0] + cut->x[1] * q[1] + cut->x[2] * q[2] > cut->offset;
	}
	if (s->widened) {
		const gw_lanes middles = { 0.5f, 1.5f, 2.5f, 3.5f };
		gw_lanes dx = (float)column + middles - s->centre_x;
		float dy = (float)row + 0.5f - s->centre_y;
		gw_lanes flat = (dx * dx + dy * dy) * (1.0f / (GW_RASTER_WIDENED * GW_RASTER_WIDENED));
		z = choose(inside, z, (gw_lanes){ 0 } + s->middle[2]);
		squared = choose(inside & (squared < flat), squared, flat);
		inside |= flat <= 1.0f;
	}
	f->hit = inside & ~beyond;
	f->beyond = inside & beyond;
	f->depth = z + s->behind;
	f->weight = s->weight * kernel(squared);
}

static void meet_triangle(const gw_raster_view *view, const gw_raster_shape *s, gw_lanes x, float y,
						  gw_raster_fragments *f)
{
	gw_lanes sum = { 0 };
	f->depth = s->offset / (s->normal[0] * x + (s->normal[1] * y + s->normal[2]));
	f->weight = (gw_lanes){ 1.0f, 1.0f, 1.0f, 1.0f };
	f->hit = f->depth >= view->near;
	f->beyond = (gw_lane_mask){ 0 };
	for (int k = 0; k < 3; k++) {
		const float *e = s->edge[k];
		f->barycentric[k] = s->sign * (e[0] * x + (e[1] * y + e[2]));
		f->hit &= f->barycentric[k] >= 0.0f;
		sum += f->barycentric[k];
	}
	f->hit &= sum > 0.0f;
	for (int k = 0; k < 3; k++)
		f->barycentric[k] /= sum;
}

void gw_raster_shape_meet(const gw_raster_view *view, const gw_raster_shape *s, int32_t column,
						  int32_t row, gw_raster_fragments *f)
{
	if (s->kind == GW_RASTER_TRIANGLE)
		meet_triangle(view, s, ray_x(view, column), gw_raster_ray_y(view, row), f);
	else
		meet_disc(view, s, column, row, f);
}

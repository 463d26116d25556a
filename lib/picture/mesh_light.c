/* mesh_light.c - triangles that take their light from the points on them; see
 * glowworm_picture.h. */
#include "glowworm_picture.h"

#include "base/memory.h"
#include "cloud/neighbour_index.h"
#include "base/parallel.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#define CHUNK 256u
#define TRIANGLES 4     /* nearest to a point that it may lie on */
#define POINTS 8        /* around a corner that light it */
#define ON_PLANE 0.25f  /* radii of a point's distance from a triangle that it lies on */
#define SAME_PLANE 0.7f /* least |cosine| between their normals */
#define SAME_SIDE 0.6f  /* least cosine between the normals of a corner and of its points */
#define FURTHEST 4.0f   /* longest edges from a corner to the point that lights it */
#define DEEPEST 1024    /* halves on the stack: one for each halving of some edge */

/* ----------------------------------------------------------------------------- cutting */

/* A triangle on its way to smaller ones: positions, then normals. */
typedef struct cut_triangle {
	float corner[3][6];
} cut_triangle;

static double squared_edge(const cut_triangle *t, int from)
{
	const float *a = t->corner[from], *b = t->corner[(from + 1) % 3];
	double x = (double)b[0] - (double)a[0], y = (double)b[1] - (double)a[1];
	double z = (double)b[2] - (double)a[2];
	return x * x + y * y + z * z;
}

static bool is_outside(const gw_tessellation *triangles, const cut_triangle *t)
{
	const float *a = t->corner[0], *b = t->corner[1], *c = t->corner[2];
	for (int k = 0; k < 3; k++)
		if (fmaxf(fmaxf(a[k], b[k]), c[k]) < triangles->minimum[k] ||
			fminf(fminf(a[k], b[k]), c[k]) > triangles->maximum[k])
			return true;
	return false;
}

/* Halves the edge that begins at corner `from`: one half stays, the other is given out. */
static void halve(cut_triangle *t, int from, cut_triangle *other)
{
	int to = (from + 1) % 3;
	float middle[6], length = 0.0f;
	for (int k = 0; k < 6; k++)
		middle[k] = 0.5f * t->corner[from][k] + 0.5f * t->corner[to][k];
	for (int k = 3; k < 6; k++)
		length += middle[k] * middle[k];
	for (int k = 3; k < 6; k++)
		middle[k] = length > 0.0f ? middle[k] / sqrtf(length) : t->corner[from][k];
	*other = *t;
	memcpy(t->corner[to], middle, sizeof middle);
	memcpy(other->corner[from], middle, sizeof middle);
}

static gw_status add_triangle(gw_tessellation *triangles, const cut_triangle *t, gw_error *error)
{
	if (triangles->count == triangles->capacity) {
		size_t capacity = triangles->capacity ? 2 * triangles->capacity : 1024;
		float *position = gw_resize_array(triangles->position, capacity, 9 * sizeof *position);
		triangles->position = position ? position : triangles->position;
		float *normal = gw_resize_array(triangles->normal, capacity, 9 * sizeof *normal);
		triangles->normal = normal ? normal : triangles->normal;
		if (!position || !normal)
			return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu triangles of meshes",
						   capacity);
		triangles->capacity = capacity;
	}
	for (size_t i = 0; i < 3; i++) {
		memcpy(triangles->position + 9 * triangles->count + 3 * i, t->corner[i], 3 * sizeof(float));
		memcpy(triangles->normal + 9 * triangles->count + 3 * i, t->corner[i] + 3,
			   3 * sizeof(float));
	}
	triangles->count++;
	return GW_OK;
}

gw_status gw_tessellation_add(gw_tessellation *triangles, const float corner[9],
							  const float normal[9], gw_error *error)
{
	cut_triangle stack[DEEPEST];
	int depth = 1;
	for (size_t i = 0; i < 3; i++) {
		memcpy(stack[0].corner[i], corner + 3 * i, 3 * sizeof(float));
		memcpy(stack[0].corner[i] + 3, normal + 3 * i, 3 * sizeof(float));
	}
	double longest = (double)triangles->longest;
	while (depth > 0 && triangles->count < triangles->most) {
		cut_triangle *t = &stack[depth - 1];
		if (is_outside(triangles, t)) {
			depth--;
			continue;
		}
		int edge = 0;
		for (int i = 1; i < 3; i++)
			edge = squared_edge(t, i) > squared_edge(t, edge) ? i : edge;
		if (depth < DEEPEST && squared_edge(t, edge) > longest * longest) {
			halve(t, edge, &stack[depth]);
			depth++;
			continue;
		}
		GW_TRY(add_triangle(triangles, t, error));
		depth--;
	}
	return GW_OK;
}

void gw_tessellation_clear(gw_tessellation *triangles)
{
	free(triangles->position);
	free(triangles->normal);
	free(triangles->channel);
	*triangles = (gw_tessellation){ .count = 0 };
}

/* ---------------------------------------------------------------------------- lighting */

/* What all steps need. */
typedef struct lighting {
	gw_tessellation *triangles;
	const gw_surfels *surfels;
	const float *channel;
	uint32_t channel_count, threads;
	float scale; /* to about unit size, for the search */
	gw_neighbour_index *index;
	uint32_t k;       /* neighbours */
	uint8_t *on_mesh; /* surfels */
	uint32_t *point;  /* the surfels on the mesh */
	uint8_t *lit;     /* triangles */
	atomic_bool out_of_memory;
} lighting;

static float dot(const float a[3], const float b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void find_scale(lighting *l)
{
	float largest = 0.0f;
	for (size_t i = 0; i < 3 * l->surfels->count; i++)
		largest = fmaxf(largest, fabsf(l->surfels->position[i]));
	for (size_t i = 0; i < 9 * l->triangles->count; i++)
		largest = fmaxf(largest, fabsf(l->triangles->position[i]));
	l->scale = largest > 0.0f ? ldexpf(1.0f, -ilogbf(largest)) : 1.0f;
}

/* The index's nearest to scaled places; false when memory is short. */
static bool search(lighting *l, const float *place, size_t count, int *found)
{
	float scaled[3 * CHUNK * 3], squared[CHUNK * 3 * POINTS];
	for (size_t i = 0; i < 3 * count; i++)
		scaled[i] = place[i] * l->scale;
	if (gw_neighbour_index_search(l->index, scaled, count, l->k, found, squared))
		return true;
	atomic_store(&l->out_of_memory, true);
	return false;
}

static void middle_of(const gw_tessellation *triangles, size_t triangle, float middle[3])
{
	const float *p = triangles->position + 9 * triangle;
	for (size_t k = 0; k < 3; k++)
		middle[k] = (p[k] + p[3 + k] + p[6 + k]) / 3.0f;
}

static bool lies_on(const lighting *l, size_t surfel, size_t triangle)
{
	const float *p = l->triangles->position + 9 * triangle, *at = l->surfels->position + 3 * surfel;
	float side[2][3], normal[3], middle[3], way[3];
	middle_of(l->triangles, triangle, middle);
	for (size_t k = 0; k < 3; k++) {
		side[0][k] = p[3 + k] - p[k];
		side[1][k] = p[6 + k] - p[k];
		way[k] = at[k] - middle[k];
	}
	for (int k = 0; k < 3; k++) {
		int a = (k + 1) % 3, b = (k + 2) % 3;
		normal[k] = side[0][a] * side[1][b] - side[0][b] * side[1][a];
	}
	float length = sqrtf(dot(normal, normal)), longest = l->triangles->longest;
	return fabsf(dot(normal, way)) <= ON_PLANE * l->surfels->radius[surfel] * length &&
		   dot(way, way) <= longest * longest &&
		   fabsf(dot(normal, l->surfels->normal + 3 * surfel)) >= SAME_PLANE * length;
}

static void find_on_mesh(void *user, size_t first, size_t last, uint32_t worker)
{
	(void)worker;
	lighting *l = user;
	int found[CHUNK * TRIANGLES];
	if (!search(l, l->surfels->position + 3 * first, last - first, found))
		return;
	for (size_t i = first; i < last; i++) {
		l->on_mesh[i] = 0;
		for (size_t j = 0; j < l->k; j++)
			l->on_mesh[i] |= lies_on(l, i, (size_t)found[(i - first) * l->k + j]);
	}
}

/* The mean over the points around a corner, nearer ones with more weight; those of its own side, if
 * there are any. False when there is none near. */
static bool light_corner(const lighting *l, size_t corner, const int *found, float *out)
{
	const float *at = l->triangles->position + 3 * corner,
				*normal = l->triangles->normal + 3 * corner;
	float squared[POINTS], reach = 0.0f, nearest = INFINITY, sum = 0.0f;
	bool same[POINTS], any = false;
	for (size_t j = 0; j < l->k; j++) {
		const float *p = l->surfels->position + 3 * (size_t)l->point[found[j]];
		const float way[3] = { p[0] - at[0], p[1] - at[1], p[2] - at[2] };
		squared[j] = dot(way, way);
		reach = fmaxf(reach, squared[j]);
		nearest = fminf(nearest, squared[j]);
		same[j] = dot(normal, l->surfels->normal + 3 * (size_t)l->point[found[j]]) > SAME_SIDE;
		any |= same[j];
	}
	memset(out, 0, l->channel_count * sizeof *out);
	for (size_t j = 0; j < l->k; j++) {
		float rest = 1.001f - (reach > 0.0f ? squared[j] / reach : 0.0f);
		float weight = any && !same[j] ? 0.0f : rest * rest;
		const float *from = l->channel + (size_t)l->channel_count * l->point[found[j]];
		for (uint32_t c = 0; c < l->channel_count; c++)
			out[c] += weight * from[c];
		sum += weight;
	}
	for (uint32_t c = 0; c < l->channel_count; c++)
		out[c] /= sum;
	return nearest <= FURTHEST * FURTHEST * l->triangles->longest * l->triangles->longest;
}

static void light_triangles(void *user, size_t first, size_t last, uint32_t worker)
{
	(void)worker;
	lighting *l = user;
	int found[CHUNK * 3 * POINTS];
	if (!search(l, l->triangles->position + 9 * first, 3 * (last - first), found))
		return;
	for (size_t i = first; i < last; i++) {
		l->lit[i] = 1;
		for (size_t c = 3 * i; c < 3 * i + 3; c++)
			l->lit[i] &= light_corner(l, c, found + (c - 3 * first) * l->k,
									  l->triangles->channel + (size_t)l->channel_count * c);
	}
}

/* A search over places that are given one by one; which it scales. */
static bool open_index(lighting *l, float *scaled, size_t count, uint32_t most)
{
	for (size_t i = 0; i < 3 * count; i++)
		scaled[i] *= l->scale;
	l->k = count < most ? (uint32_t)count : most;
	l->index = gw_neighbour_index_build(scaled, count, l->threads);
	return l->index != NULL;
}

static bool find_points(lighting *l)
{
	size_t count = l->triangles->count;
	float *middle = gw_allocate_array(count, 3 * sizeof *middle);
	for (size_t i = 0; middle && i < count; i++)
		middle_of(l->triangles, i, middle + 3 * i);
	if (middle && open_index(l, middle, count, TRIANGLES))
		gw_parallel_for(l->threads, l->surfels->count, CHUNK, find_on_mesh, l);
	bool good = l->index && !atomic_load(&l->out_of_memory);
	gw_neighbour_index_free(l->index);
	l->index = NULL;
	free(middle);
	return good;
}

/* Lights all triangles; false when memory is short. */
static bool light(lighting *l, size_t points)
{
	float *place = gw_allocate_array(points, 3 * sizeof *place);
	size_t count = 0;
	for (size_t i = 0; place && i < l->surfels->count; i++)
		if (l->on_mesh[i]) {
			memcpy(place + 3 * count, l->surfels->position + 3 * i, 3 * sizeof *place);
			l->point[count++] = (uint32_t)i;
		}
	if (place && open_index(l, place, points, POINTS))
		gw_parallel_for(l->threads, l->triangles->count, CHUNK, light_triangles, l);
	bool good = l->index && !atomic_load(&l->out_of_memory);
	gw_neighbour_index_free(l->index);
	l->index = NULL;
	free(place);
	return good;
}

static void keep_lit(lighting *l)
{
	gw_tessellation *p = l->triangles;
	size_t kept = 0, width = 3 * (size_t)l->channel_count;
	for (size_t i = 0; i < p->count; i++) {
		if (!l->lit[i])
			continue;
		memmove(p->position + 9 * kept, p->position + 9 * i, 9 * sizeof(float));
		memmove(p->normal + 9 * kept, p->normal + 9 * i, 9 * sizeof(float));
		memmove(p->channel + width * kept, p->channel + width * i, width * sizeof(float));
		kept++;
	}
	p->count = kept;
}

gw_status gw_mesh_light(gw_tessellation *triangles, const gw_surfels *surfels,
						gw_surfel_channels channels, uint32_t threads, uint8_t *on_mesh,
						gw_error *error)
{
	lighting l = { .triangles = triangles,
				   .surfels = surfels,
				   .channel = channels.channel,
				   .channel_count = channels.count,
				   .threads = threads,
				   .on_mesh = on_mesh };
	memset(on_mesh, 0, surfels->count);
	if (triangles->count == 0)
		return GW_OK;
	find_scale(&l);
	l.lit = gw_allocate_zeros(triangles->count, 1);
	l.point = gw_allocate_array(surfels->count, sizeof *l.point);
	triangles->channel = gw_allocate_array(triangles->count,
										   3 * (size_t)channels.count * sizeof *triangles->channel);
	bool good = l.lit && l.point && triangles->channel && find_points(&l);
	size_t points = 0;
	for (size_t i = 0; i < surfels->count && good; i++)
		points += on_mesh[i];
	good = good && (points == 0 || light(&l, points));
	if (good)
		keep_lit(&l);
	free(l.lit);
	free(l.point);
	return good ? GW_OK : gw_fail(error, GW_ERROR_MEMORY, "no memory to light the meshes");
}

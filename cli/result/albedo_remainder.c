/* albedo_remainder.c - see albedo_remainder.h. */
#include "result/albedo_remainder.h"

#include "result/albedo_places.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A difference of logarithms between neighbouring places that is still the light's. */
#define STEP_MOST 0.12

/* So many points of a place have a level. */
#define MEMBERS_LEAST 3

/* Cosine between the normals of neighbours on one surface, and the most of the sine by which the
   way from one to the other leaves it. */
#define SMOOTH_COSINE 0.9
#define RISE_MOST 0.35

/* Power of the cosine between a point's normal and a patch's: at 25 degrees half of it counts, at
 * 45 a sixteenth. */
#define ALIKE_POWER 8.0

/* The residual, of the first, at which the conjugate gradients end. */
#define RESIDUAL_SMALL 1e-4

/* The points of one cube that look about the same way. */
typedef struct patch {
	int32_t at[3];
	uint32_t facing; /* 2 * axis, + 1 against it */
	double center[3], normal[3];
	double mean[3]; /* of the logarithms of the levels */
} patch;

/* Two neighbours on one surface, and by what the light differs, the second less the first. */
typedef struct link {
	uint32_t a, b;
	double differ[3];
} link;

typedef struct leftover {
	albedo_member *list; /* count */
	patch *patch;        /* count at most */
	link *link;
	size_t patch_count, link_count, link_room;
	double *light;     /* 3 * patch_count: what is divided out, logarithms */
	double *work;      /* 4 * patch_count, of the conjugate gradients */
	uint32_t *surface; /* patch_count: the connected surface of each, the first patch of it */
	double low[3], width;
} leftover;

/* ------------------------------------------------------------------------------- the patches */

static uint32_t facing(const float n[3])
{
	int axis = fabsf(n[0]) > fabsf(n[1]) ? 0 : 1;
	axis = fabsf(n[2]) > fabsf(n[axis]) ? 2 : axis;
	return 2u * (uint32_t)axis + (n[axis] < 0.0f);
}

static size_t list_members(leftover *w, const gw_points *p, const float *normal,
						   const uint8_t *left, const float *level)
{
	size_t used = 0;
	for (size_t i = 0; i < p->count; i++) {
		albedo_member *m = &w->list[used];
		*m = (albedo_member){ .group = facing(normal + 3 * i), .point = i };
		bool known = !left[i] && albedo_level_known(level + 3 * i);
		used += known && albedo_place_find(p->position + 3 * i, w->low, w->width, m->at);
	}
	albedo_members_sort(w->list, used);
	return used;
}

static patch make_patch(const albedo_member *list, size_t count, const gw_points *p,
						const float *normal, const float *level)
{
	patch to = { .facing = list[0].group };
	memcpy(to.at, list[0].at, sizeof to.at);
	for (size_t i = 0; i < count; i++)
		for (size_t k = 0; k < 3; k++) {
			size_t at = 3 * list[i].point + k;
			to.center[k] += p->position[at] / (double)count;
			to.normal[k] += (double)normal[at];
			to.mean[k] += log((double)level[at]) / (double)count;
		}
	double length = sqrt(to.normal[0] * to.normal[0] + to.normal[1] * to.normal[1] +
						 to.normal[2] * to.normal[2]);
	for (int k = 0; k < 3; k++)
		to.normal[k] = length > 0.0 ? to.normal[k] / length : 0.0;
	return to;
}

static void make_patches(leftover *w, size_t used, const gw_points *p, const float *normal,
						 const float *level)
{
	for (size_t first = 0, last; first < used; first = last) {
		const albedo_member *m = w->list + first;
		for (last = first; last < used && w->list[last].group == m->group &&
						   memcmp(w->list[last].at, m->at, sizeof m->at) == 0;
			 last++)
			continue;
		if (last - first >= MEMBERS_LEAST)
			w->patch[w->patch_count++] = make_patch(m, last - first, p, normal, level);
	}
}

static int compare_patches(const void *a, const void *b)
{
	const patch *x = a, *y = b;
	for (int k = 0; k < 3; k++)
		if (x->at[k] != y->at[k])
			return x->at[k] < y->at[k] ? -1 : 1;
	return (x->facing > y->facing) - (x->facing < y->facing);
}

/* The patches of one cube, in a row. */
typedef struct cube {
	const patch *first, *end;
} cube;

/* Those of the n-th of the 27 cubes around `at`, of which the 13th is itself. */
static cube patches_around(const leftover *w, const int32_t at[3], int n)
{
	const patch key = { .at = { at[0] + n / 9 - 1, at[1] + n / 3 % 3 - 1, at[2] + n % 3 - 1 } };
	size_t low = 0, high = w->patch_count;
	while (low < high) {
		size_t middle = low + (high - low) / 2;
		if (compare_patches(&w->patch[middle], &key) < 0)
			low = middle + 1;
		else
			high = middle;
	}
	for (high = low; high < w->patch_count; high++)
		if (memcmp(w->patch[high].at, key.at, sizeof key.at) != 0)
			break;
	return (cube){ w->patch + low, w->patch + high };
}

/* --------------------------------------------------------------------------------- the links */

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Whether two patches are of one surface: they look the same way, and neither is above the other.
 */
static bool joined(const patch *a, const patch *b)
{
	const double way[3] = { b->center[0] - a->center[0], b->center[1] - a->center[1],
							b->center[2] - a->center[2] };
	double most = RISE_MOST * sqrt(dot(way, way));
	return dot(a->normal, b->normal) > SMOOTH_COSINE && fabs(dot(way, a->normal)) <= most &&
		   fabs(dot(way, b->normal)) <= most;
}

static bool add_link(leftover *w, const patch *a, const patch *b)
{
	if (w->link_count == w->link_room) {
		size_t room = 2 * w->link_room + 1024;
		link *more = reallocarray(w->link, room, sizeof *more);
		if (!more)
			return false;
		w->link = more;
		w->link_room = room;
	}
	link to = { .a = (uint32_t)(a - w->patch), .b = (uint32_t)(b - w->patch) };
	double most = 0.0;
	for (int k = 0; k < 3; k++) {
		to.differ[k] = b->mean[k] - a->mean[k];
		most = fmax(most, fabs(to.differ[k]));
	}
	if (most > STEP_MOST)
		memset(to.differ, 0, sizeof to.differ);
	w->link[w->link_count++] = to;
	return true;
}

/* Of the cubes around each patch, its own among them, the patches that come after it. */
static bool make_links(leftover *w)
{
	for (const patch *a = w->patch; a < w->patch + w->patch_count; a++)
		for (int n = 13; n < 27; n++) {
			cube near = patches_around(w, a->at, n);
			for (const patch *b = near.first; b < near.end; b++)
				if (b > a && joined(a, b) && !add_link(w, a, b))
					return false;
		}
	return true;
}

/* ------------------------------------------------------------------- the light that they tell */

/* out = the sum over each patch's links of its value less the neighbour's. */
static void differences(const leftover *w, const double *value, double *out)
{
	memset(out, 0, w->patch_count * sizeof *out);
	for (size_t i = 0; i < w->link_count; i++) {
		const link *l = &w->link[i];
		double d = value[l->a] - value[l->b];
		out[l->a] += d;
		out[l->b] -= d;
	}
}

static double inner(const double *a, const double *b, size_t count)
{
	double sum = 0.0;
	for (size_t i = 0; i < count; i++)
		sum += a[i] * b[i];
	return sum;
}

/* Least squares of one channel by conjugate gradients, which end after as many steps as there are
 * unknowns at the latest. */
static void solve_channel(const leftover *w, int k)
{
	size_t n = w->patch_count;
	double *x = w->work, *r = x + n, *way = r + n, *image = way + n;
	memset(x, 0, 2 * n * sizeof *x);
	for (size_t i = 0; i < w->link_count; i++) {
		r[w->link[i].a] -= w->link[i].differ[k];
		r[w->link[i].b] += w->link[i].differ[k];
	}
	memcpy(way, r, n * sizeof *r);
	double now = inner(r, r, n), end = RESIDUAL_SMALL * RESIDUAL_SMALL * now;
	for (size_t step = 0; step < n && now > end; step++) {
		differences(w, way, image);
		double length = now / inner(way, image, n), before = now;
		for (size_t i = 0; i < n; i++) {
			x[i] += length * way[i];
			r[i] -= length * image[i];
		}
		now = inner(r, r, n);
		for (size_t i = 0; i < n; i++)
			way[i] = r[i] + now / before * way[i];
	}
	for (size_t i = 0; i < n; i++)
		w->light[3 * i + (size_t)k] = x[i];
}

static uint32_t first_of(uint32_t *surface, uint32_t i)
{
	while (surface[i] != i)
		i = surface[i] = surface[surface[i]];
	return i;
}

/* Takes the mean of each connected surface out of its light. */
static void center_surfaces(const leftover *w)
{
	size_t n = w->patch_count;
	double *sum = w->work;
	for (uint32_t i = 0; i < n; i++)
		w->surface[i] = i;
	for (size_t i = 0; i < w->link_count; i++) {
		uint32_t a = first_of(w->surface, w->link[i].a), b = first_of(w->surface, w->link[i].b);
		w->surface[a < b ? b : a] = a < b ? a : b;
	}
	memset(sum, 0, 4 * n * sizeof *sum);
	for (uint32_t i = 0; i < n; i++) {
		double *to = sum + 4 * first_of(w->surface, i);
		for (size_t k = 0; k < 3; k++)
			to[k] += w->light[3 * i + k];
		to[3] += 1.0;
	}
	for (uint32_t i = 0; i < n; i++) {
		const double *mean = sum + 4 * first_of(w->surface, i);
		for (size_t k = 0; k < 3; k++)
			w->light[3 * i + k] -= mean[k] / mean[3];
	}
}

/* ------------------------------------------------------------------------------- reading back */

/* What a patch is to a point: more the nearer it is and the more it looks the same way; nothing at
 * right angles. */
static double weight_at(const leftover *w, const patch *b, const double *p, const float *normal)
{
	const double way[3] = { b->center[0] - p[0], b->center[1] - p[1], b->center[2] - p[2] };
	const double n[3] = { (double)normal[0], (double)normal[1], (double)normal[2] };
	double near = fmax(1.0 - sqrt(dot(way, way)) / (1.5 * w->width), 0.0);
	return near * pow(fmax(dot(b->normal, n), 0.0), ALIKE_POWER);
}

/* Light at a point: that of the patches around which face its way, the nearest most. */
static void read_light(const leftover *w, const albedo_member *m, const double *p,
					   const float *normal, double light[3])
{
	double weight = 0.0;
	memset(light, 0, 3 * sizeof *light);
	for (int n = 0; n < 27; n++) {
		cube near = patches_around(w, m->at, n);
		for (const patch *b = near.first; b < near.end; b++) {
			double own = weight_at(w, b, p, normal);
			weight += own;
			for (size_t k = 0; k < 3; k++)
				light[k] += own * w->light[3 * (size_t)(b - w->patch) + k];
		}
	}
	for (int k = 0; k < 3; k++)
		light[k] = weight > 0.0 ? light[k] / weight : 0.0;
}

static double divide_points(const leftover *w, size_t used, const gw_points *p, const float *normal,
							float *level)
{
	double change = 0.0;
	for (size_t i = 0; i < used; i++) {
		size_t point = w->list[i].point;
		double light[3];
		read_light(w, &w->list[i], p->position + 3 * point, normal + 3 * point, light);
		for (size_t k = 0; k < 3; k++) {
			level[3 * point + k] *= (float)exp(-light[k]);
			change += fabs(light[k]);
		}
	}
	return used ? change / (3.0 * (double)used) : 0.0;
}

gw_status albedo_remainder_divide(const gw_points *p, const float *normal, const uint8_t *left,
								  float *level, double *typical, gw_error *error)
{
	leftover w = { .list = reallocarray(NULL, p->count, sizeof *w.list),
				   .patch = reallocarray(NULL, p->count, sizeof *w.patch) };
	w.width = albedo_place_width(p, w.low);
	size_t used = w.list && w.patch ? list_members(&w, p, normal, left, level) : 0;
	make_patches(&w, used, p, normal, level);
	w.light = calloc(w.patch_count + 1, 3 * sizeof *w.light);
	w.work = calloc(w.patch_count + 1, 4 * sizeof *w.work);
	w.surface = calloc(w.patch_count + 1, sizeof *w.surface);
	bool good = w.list && w.patch && w.light && w.work && w.surface && make_links(&w);
	for (int k = 0; k < 3 && good; k++)
		solve_channel(&w, k);
	if (good)
		center_surfaces(&w);
	*typical = good ? divide_points(&w, used, p, normal, level) : 0.0;
	free(w.list);
	free(w.patch);
	free(w.link);
	free(w.light);
	free(w.work);
	free(w.surface);
	return good ? GW_OK : gw_fail(error, GW_ERROR_MEMORY, "no memory for the light that is left");
}

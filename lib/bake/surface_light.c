/*
 * surface_light.c - see surface_light.h.
 */
#include "bake/surface_light.h"

#include "bake/report.h"
#include "base/luminance.h"
#include "base/memory.h"
#include "cloud/neighbour_index.h"
#include "glowworm_host.h"
#include "glowworm_parts.h"

#include <float.h>
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define AROUND 8     /* points of the surface that light one beside it */
#define QUERIES 256u /* points that are looked up at once */
#define CHUNK 8192u  /* points that are summed up by themselves */
#define FACING 0.5f  /* least cosine between normals of one surface */
#define INV_PI 0.318309886f
#define FARTHEST 1e15

/* Sums of a chunk; doubles, added in order. */
typedef struct sums {
	double squares, radiance, distance; /* of differences; of the surface; to the nearest */
	uint64_t compared, beside;
} sums;

typedef struct spread {
	const gw_surface_light_task *task;
	const gw_bake_result *lit;
	gw_bake_result *out; /* NULL: points of the surface are compared with those around */
	double middle[3];
	gw_neighbour_index *index;
	float *place;  /* 3 a lit point of the surface, from the middle */
	uint32_t *row; /* the same: which of the surface it is */
	size_t rows;
	uint8_t *chosen; /* one a point of all: 1 for those of the surface */
	size_t *order;   /* one a point of all: those that are near each other follow each other */
	sums *sum;       /* one a chunk */
	atomic_bool failed;
} spread;

/* Those around a point and what each counts; they add up to 1. */
typedef struct around {
	uint32_t count;
	uint32_t row[AROUND + 1];
	float weight[AROUND + 1];
} around;

/* ------------------------------------------------------------------------------ who lights whom */

static bool is_lit(const gw_bake_result *lit, size_t k)
{
	const float *n = lit->normal + 3 * k;
	return (n[0] != 0.0f || n[1] != 0.0f || n[2] != 0.0f) && !(lit->stray && lit->stray[k]) &&
		   !(lit->asked && !lit->asked[k]);
}

static float dot(const float a[3], const float b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static bool unit_normal(const float *normals, size_t i, float unit[3])
{
	if (!normals)
		return false;
	float length = sqrtf(dot(normals + 3 * i, normals + 3 * i));
	if (!isfinite(length) || !(length > 0.0f))
		return false;
	for (size_t c = 0; c < 3; c++)
		unit[c] = normals[3 * i + c] / length;
	return true;
}

/* A point's own normal where the nearest of the surface was given one that was used, turned as that
 * one was; else that of the nearest. */
static void choose_normal(const spread *s, size_t point, uint32_t nearest, float normal[3])
{
	const float *used = s->lit->normal + 3 * (size_t)nearest;
	float given[3], own[3];
	memcpy(normal, used, 3 * sizeof *normal);
	if (s->task->estimated || !unit_normal(s->task->surface->normal, nearest, given) ||
		!unit_normal(s->task->points->normal, point, own))
		return;
	float same = dot(given, used);
	for (size_t c = 0; c < 3 && fabsf(same) >= FACING; c++)
		normal[c] = same > 0.0f ? own[c] : -own[c];
}

/* Weights of those that were found, nearest first. */
static void weigh(const spread *s, const int *found, const float *squared, uint32_t count,
				  const float normal[3], around *a)
{
	float reach = 1.0001f * sqrtf(squared[count - 1]) + FLT_MIN, whole = 0.0f;
	a->count = 0;
	for (uint32_t k = 0; k < count; k++) {
		uint32_t row = s->row[found[k]];
		float facing = dot(normal, s->lit->normal + 3 * (size_t)row);
		float distance = fmaxf(sqrtf(squared[k]), 1e-6f * reach);
		float near = fmaxf(reach - distance, 1e-4f * reach) / (reach * distance);
		if (facing < FACING)
			continue;
		a->row[a->count] = row;
		a->weight[a->count] = near * near * facing * facing;
		whole += a->weight[a->count++];
	}
	for (uint32_t k = 0; k < a->count; k++)
		a->weight[k] /= whole;
	if (a->count == 0)
		*a = (around){ .count = 1, .row = { s->row[found[0]] }, .weight = { 1.0f } };
}

/* --------------------------------------------------------------------------------- what is taken
 */

static float mean_of(const float *values, size_t width, size_t c, const around *a)
{
	float sum = 0.0f;
	for (uint32_t k = 0; k < a->count; k++)
		sum += a->weight[k] * values[width * a->row[k] + c];
	return sum;
}

/* Of radiance that is reflected, or of a part of it that one lamp gives: what a point of another
 * albedo has of it. emission: what of it is no reflection, or NULL. */
static float reflected(const spread *s, const float *radiance, const float *emission, size_t c,
					   float albedo, const around *a)
{
	float sum = 0.0f, whole = 0.0f;
	for (uint32_t k = 0; k < a->count; k++) {
		size_t at = 3 * (size_t)a->row[k] + c;
		if (!(s->lit->albedo[at] > 0.0f))
			continue;
		float own = radiance[at] - (emission ? emission[at] : 0.0f);
		sum += a->weight[k] * own / s->lit->albedo[at];
		whole += a->weight[k];
	}
	return whole > 0.0f ? albedo * sum / whole : 0.0f;
}

static float albedo_of(const spread *s, size_t point, size_t c, uint32_t nearest)
{
	const gw_points *p = s->task->points;
	if (!p->albedo)
		return s->lit->albedo[3 * (size_t)nearest + c];
	float albedo = p->albedo[3 * point + c];
	return isfinite(albedo) ? fminf(fmaxf(albedo, 0.0f), GW_ALBEDO_MAX) : GW_ALBEDO_DEFAULT;
}

static float emission_of(const gw_points *p, size_t point, size_t c)
{
	float e = p->emission ? p->emission[3 * point + c] : 0.0f;
	return isfinite(e) && e > 0.0f ? e : 0.0f;
}

/* A bent normal is of no length where nothing is open, and else of length 1. */
static void take_bent_normal(const spread *s, size_t point, const around *a)
{
	float *bent = s->out->bent_normal + 3 * point;
	for (size_t c = 0; c < 3; c++)
		bent[c] = mean_of(s->lit->bent_normal, 3, c, a);
	float length = sqrtf(dot(bent, bent));
	for (size_t c = 0; c < 3; c++)
		bent[c] /= length > 0.0f ? length : 1.0f;
}

static void take_scalars(const spread *s, size_t point, const around *a)
{
	const gw_bake_result *lit = s->lit;
	gw_bake_result *out = s->out;
	const struct {
		const float *from;
		float *to;
	} scalar[] = { { lit->ambient_occlusion, out->ambient_occlusion },
				   { lit->error, out->error },
				   { lit->unknown, out->unknown },
				   { lit->roi, out->roi } };
	for (size_t k = 0; k < sizeof scalar / sizeof *scalar; k++)
		if (scalar[k].to)
			scalar[k].to[point] = mean_of(scalar[k].from, 1, 0, a);
	if (out->bent_normal)
		take_bent_normal(s, point, a);
}

static void take_light(const spread *s, size_t point, const float normal[3], const around *a)
{
	const gw_bake_result *lit = s->lit;
	gw_bake_result *out = s->out;
	for (size_t c = 0; c < 3; c++) {
		size_t at = 3 * point + c;
		float albedo = albedo_of(s, point, c, a->row[0]);
		float emission = emission_of(s->task->points, point, c);
		float direct = mean_of(lit->direct_irradiance, 3, c, a);
		float indirect = mean_of(lit->indirect_irradiance, 3, c, a);
		out->direct_irradiance[at] = direct;
		out->indirect_irradiance[at] = indirect;
		out->albedo[at] = albedo;
		out->normal[at] = normal[c];
		out->radiance[at] = emission + albedo * INV_PI * (direct + indirect);
		for (size_t k = 0; k < out->lamp_count; k++)
			out->lamp[k][at] = reflected(s, lit->lamp[k], NULL, c, albedo, a);
		if (out->rest)
			out->rest[at] =
				emission + reflected(s, lit->rest, s->task->surface->emission, c, albedo, a);
	}
	take_scalars(s, point, a);
}

/* Radiance of a point of the surface by those around it, and its own. */
static void compare(const spread *s, uint32_t row, const around *a, sums *sum)
{
	const gw_bake_result *lit = s->lit;
	float own[3], other[3];
	for (size_t c = 0; c < 3; c++) {
		size_t at = 3 * (size_t)row + c;
		if (s->task->surface->emission && s->task->surface->emission[at] > 0.0f)
			return;
		float share = lit->albedo[at] * INV_PI;
		own[c] = share * (lit->direct_irradiance[at] + lit->indirect_irradiance[at]);
		other[c] = share * (mean_of(lit->direct_irradiance, 3, c, a) +
							mean_of(lit->indirect_irradiance, 3, c, a));
	}
	double difference = gw_luminance(other) - gw_luminance(own);
	sum->squares += difference * difference;
	sum->radiance += gw_luminance(own);
	sum->compared++;
}

/* ---------------------------------------------------------------------------------- over all */

/* Where a point is to be lit, from the middle; no farther than FARTHEST, of which squares are
 * within float32. False where it is not lit. */
static bool place_of(const spread *s, size_t point, float at[3])
{
	const double *p = s->task->points->position + 3 * point;
	const float *opacity = s->task->points->opacity;
	for (size_t c = 0; c < 3; c++)
		at[c] = (float)fmin(fmax(p[c] - s->middle[c], -FARTHEST), FARTHEST);
	return isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]) &&
		   !(opacity && !(opacity[point] > 0.0f)) && !(s->task->asked && !s->task->asked[point]);
}

/* Cubes of 1 / SIDE of the surface's extent, in rows: neighbours are looked up faster after those
 * beside them, which left the same parts of the tree in the cache. */
enum { SIDE = 64, CUBES = SIDE * SIDE * SIDE };

static size_t cube_of(const spread *s, const float low[3], float width, size_t point)
{
	size_t cube = 0;
	for (size_t c = 0; c < 3; c++) {
		double at = s->task->points->position[3 * point + c] - s->middle[c] - (double)low[c];
		double cell = fmin(fmax(at / (double)width, 0.0), SIDE - 1.0);
		cube = SIDE * cube + (isfinite(cell) ? (size_t)cell : 0);
	}
	return cube;
}

static bool order_points(spread *s)
{
	float low[3] = { INFINITY, INFINITY, INFINITY }, width = FLT_MIN;
	size_t count = s->task->points->count, before = 0;
	for (size_t k = 0; k < 3 * s->rows; k++)
		low[k % 3] = fminf(low[k % 3], s->place[k]);
	for (size_t k = 0; k < 3 * s->rows; k++)
		width = fmaxf(width, (s->place[k] - low[k % 3]) / SIDE);
	size_t *first = gw_allocate_zeros(CUBES, sizeof *first);
	s->order = gw_allocate_array(count, sizeof *s->order);
	for (size_t i = 0; i < count && first && s->order; i++)
		first[cube_of(s, low, width, i)]++;
	for (size_t k = 0; k < CUBES && first; k++) {
		size_t own = first[k];
		first[k] = before;
		before += own;
	}
	for (size_t i = 0; i < count && first && s->order; i++)
		s->order[first[cube_of(s, low, width, i)]++] = i;
	bool good = first && s->order;
	free(first);
	return good;
}

/* One point of all, or one of the surface that looks beside itself, by what was found. */
static void use_found(const spread *s, size_t which, int *found, float *squared, uint32_t count,
					  sums *sum)
{
	around a;
	float normal[3];
	if (s->out) {
		choose_normal(s, which, s->row[found[0]], normal);
		weigh(s, found, squared, count, normal, &a);
		take_light(s, which, normal, &a);
		sum->beside += !s->chosen[which];
		sum->distance += !s->chosen[which] ? sqrt((double)squared[0]) : 0.0;
		return;
	}
	uint32_t k = 0;
	while (k + 1 < count && found[k] != (int)which)
		k++;
	memmove(found + k, found + k + 1, (count - 1 - k) * sizeof *found);
	memmove(squared + k, squared + k + 1, (count - 1 - k) * sizeof *squared);
	weigh(s, found, squared, count - 1, s->lit->normal + 3 * (size_t)s->row[which], &a);
	compare(s, s->row[which], &a, sum);
	sum->distance += sqrt((double)squared[0]);
}

static bool use_some(const spread *s, const size_t *which, size_t count, const float *at, sums *sum)
{
	int found[QUERIES * (AROUND + 1)];
	float squared[QUERIES * (AROUND + 1)];
	size_t wanted = s->out ? AROUND : AROUND + 1;
	wanted = wanted < s->rows ? wanted : s->rows;
	if (count == 0)
		return true;
	if (!gw_neighbour_index_search(s->index, at, count, wanted, found, squared))
		return false;
	for (size_t i = 0; i < count; i++)
		use_found(s, which[i], found + wanted * i, squared + wanted * i, (uint32_t)wanted, sum);
	return true;
}

static void use_chunk(void *user, size_t first, size_t last, uint32_t worker)
{
	spread *s = user;
	size_t which[QUERIES], count = 0;
	float at[3 * QUERIES];
	sums *sum = &s->sum[first / CHUNK];
	bool good = true;
	(void)worker;
	for (size_t k = first; k < last && good; k++) {
		size_t i = s->out ? s->order[k] : k;
		if (s->out && !place_of(s, i, at + 3 * count))
			continue;
		if (!s->out)
			memcpy(at + 3 * count, s->place + 3 * i, 3 * sizeof *at);
		which[count++] = i;
		if (count < QUERIES)
			continue;
		good = use_some(s, which, count, at, sum);
		count = 0;
	}
	if (!good || !use_some(s, which, count, at, sum))
		atomic_store(&s->failed, true);
}

/* All of `count`, and the sums of it. */
static bool use_all(spread *s, size_t count, sums *all)
{
	size_t chunks = count / CHUNK + 1;
	*all = (sums){ .squares = 0.0 };
	s->sum = gw_allocate_zeros(chunks, sizeof *s->sum);
	if (!s->sum)
		return false;
	gw_parallel_for(gw_thread_count(s->task->threads), count, CHUNK, use_chunk, s);
	for (size_t i = 0; i < chunks; i++) {
		all->squares += s->sum[i].squares;
		all->radiance += s->sum[i].radiance;
		all->distance += s->sum[i].distance;
		all->compared += s->sum[i].compared;
		all->beside += s->sum[i].beside;
	}
	free(s->sum);
	return !atomic_load(&s->failed);
}

/* ---------------------------------------------------------------------------- before and after */

static bool open_index(spread *s)
{
	const gw_point_subset *surface = s->task->surface;
	size_t count = surface->points.count;
	s->place = gw_allocate_array(count + 1, 3 * sizeof *s->place);
	s->row = gw_allocate_array(count + 1, sizeof *s->row);
	if (!s->place || !s->row)
		return false;
	for (size_t k = 0; k < count; k++) {
		if (!is_lit(s->lit, k))
			continue;
		if (s->rows == 0)
			memcpy(s->middle, surface->position + 3 * k, sizeof s->middle);
		for (size_t c = 0; c < 3; c++)
			s->place[3 * s->rows + c] = (float)(surface->position[3 * k + c] - s->middle[c]);
		s->row[s->rows++] = (uint32_t)k;
	}
	s->index = s->rows > 0 ? gw_neighbour_index_build(s->place, s->rows, s->task->threads) : NULL;
	return s->index != NULL || s->rows == 0;
}

static bool mark_chosen(spread *s)
{
	const gw_point_subset *surface = s->task->surface;
	s->chosen = gw_allocate_zeros(s->task->points->count + 1, sizeof *s->chosen);
	for (size_t k = 0; s->chosen && surface->from && k < surface->points.count; k++)
		s->chosen[surface->from[k]] = 1;
	return s->chosen != NULL;
}

/* Makes room for `count` values of `width` where the surface has some. */
static float *room_for(const float *of_surface, size_t count, size_t width, bool *good)
{
	float *room = of_surface ? gw_allocate_zeros(count, width * sizeof *room) : NULL;
	*good = *good && (room || !of_surface);
	return room;
}

static bool make_room(const gw_bake_result *lit, size_t count, gw_bake_result *out)
{
	bool good = true;
	out->count = count;
	out->radiance = room_for(lit->radiance, count, 3, &good);
	out->direct_irradiance = room_for(lit->direct_irradiance, count, 3, &good);
	out->indirect_irradiance = room_for(lit->indirect_irradiance, count, 3, &good);
	out->normal = room_for(lit->normal, count, 3, &good);
	out->albedo = room_for(lit->albedo, count, 3, &good);
	out->rest = room_for(lit->rest, count, 3, &good);
	out->bent_normal = room_for(lit->bent_normal, count, 3, &good);
	out->ambient_occlusion = room_for(lit->ambient_occlusion, count, 1, &good);
	out->error = room_for(lit->error, count, 1, &good);
	out->unknown = room_for(lit->unknown, count, 1, &good);
	out->roi = room_for(lit->roi, count, 1, &good);
	out->lamp = lit->lamp ? gw_allocate_zeros(lit->lamp_count, sizeof *out->lamp) : NULL;
	out->lamp_count = out->lamp ? lit->lamp_count : 0;
	good = good && (out->lamp || !lit->lamp);
	for (size_t k = 0; k < out->lamp_count; k++)
		out->lamp[k] = room_for(lit->lamp[k], count, 3, &good);
	return good;
}

/* Frees what make_room makes. */
static void free_room(gw_bake_result *r)
{
	float *rooms[] = {
		r->radiance, r->direct_irradiance, r->indirect_irradiance, r->normal, r->albedo,
		r->rest,     r->bent_normal,       r->ambient_occlusion,   r->error,  r->unknown,
		r->roi
	};
	for (size_t k = 0; k < sizeof rooms / sizeof *rooms; k++)
		free(rooms[k]);
	for (size_t k = 0; k < r->lamp_count; k++)
		free(r->lamp[k]);
	free(r->lamp);
}

/* Strays are those of the surface, and those of which it was known. */
static bool mark_strays(const gw_surface_light_task *task, const gw_bake_result *lit,
						gw_bake_result *out)
{
	const gw_points *p = task->points;
	bool known = p->stray && !p->keep_strays;
	out->stray = lit->stray || known ? gw_allocate_zeros(p->count, 1) : NULL;
	if (!out->stray)
		return !lit->stray && !known;
	if (known)
		memcpy(out->stray, p->stray, p->count);
	for (size_t k = 0; lit->stray && task->surface->from && k < task->surface->points.count; k++)
		out->stray[task->surface->from[k]] = lit->stray[k];
	return true;
}

static bool mark_asked(const gw_surface_light_task *task, gw_bake_result *out)
{
	out->asked = task->asked ? gw_allocate_array(task->points->count, 1) : NULL;
	if (out->asked)
		memcpy(out->asked, task->asked, task->points->count);
	return out->asked || !task->asked;
}

/* What lies between the points of the surface, where `share` of the points are beside it. */
static void add_error(const sums *beside, const sums *compared, double share, gw_report *report)
{
	gw_error_estimate *e = &report->error;
	if (compared->compared == 0 || !(compared->radiance > 0.0) || beside->beside == 0)
		return;
	double mean = compared->radiance / (double)compared->compared;
	double square = compared->squares / (double)compared->compared / (mean * mean);
	double apart = compared->distance / (double)compared->compared;
	double nearest = beside->distance / (double)beside->beside;
	double between = sqrt(square * share * fmin(nearest / fmax(apart, DBL_MIN), 1.0));
	e->between = hypot(e->between, between);
	e->relative_rms = hypot(e->relative_rms, between);
}

void gw_surface_light_count(uint64_t all, const char *why, gw_report *report)
{
	char meaning[200];
	uint64_t count = report->surface_points;
	snprintf(meaning, sizeof meaning,
			 "point{ is|s are} lit by the surface that %llu others make, %s m apart: %s",
			 (unsigned long long)count, GW_SAID(report->spacing, 3), why);
	gw_report_count(report, "beside_surface", all - count, meaning);
}

/* What lies between points may be what makes the error too large. */
void gw_surface_light_hold_against(double wanted, gw_report *report)
{
	if (!(wanted > 0.0) || report->missed || report->error.relative_rms <= wanted)
		return;
	report->missed = true;
	report->goal = GW_GOAL_EXHAUSTED;
}

/* The index, and how much the surface differs from what is around. */
static bool open_surface(spread *s, sums *compared)
{
	*compared = (sums){ .squares = 0.0 };
	return open_index(s) && (!s->index || use_all(s, s->rows > 1 ? s->rows : 0, compared));
}

/* Lights all points of the task. */
static bool light_all(spread *s, gw_bake_result *out, sums *beside)
{
	size_t count = s->task->points->count;
	*beside = (sums){ .squares = 0.0 };
	if (!make_room(s->lit, count, out) || !mark_strays(s->task, s->lit, out) ||
		!mark_asked(s->task, out) || !mark_chosen(s) || !order_points(s))
		return false;
	s->out = out;
	return !s->index || use_all(s, count, beside);
}

static bool spread_all(spread *s, gw_bake_result *out)
{
	sums compared, beside;
	if (!open_surface(s, &compared) || !light_all(s, out, &beside))
		return false;
	double share = (double)beside.beside / fmax((double)s->task->points->count, 1.0);
	add_error(&beside, &compared, share, &out->report);
	return true;
}

/* What light_all makes for one part. */
static void clear_part(spread *s)
{
	free(s->chosen);
	free(s->order);
	s->chosen = NULL;
	s->order = NULL;
}

static void clear_index(spread *s)
{
	gw_neighbour_index_free(s->index);
	free(s->place);
	free(s->row);
}

gw_status gw_surface_light_spread(const gw_surface_light_task *task, gw_bake_result *result,
								  gw_error *error)
{
	gw_bake_result out = *result;
	spread s = { .task = task, .lit = result };
	bool good = spread_all(&s, &out);
	clear_part(&s);
	clear_index(&s);
	gw_bake_result *rest = good ? result : &out;
	free_room(rest);
	free(rest->stray);
	free(rest->asked);
	if (good)
		*result = out;
	return good ? GW_OK
				: gw_fail(error, GW_ERROR_MEMORY, "no memory for the light of %zu points",
						  task->points->count);
}

/* ------------------------------------------------------------------------------------- in parts */

struct gw_lit_surface {
	gw_point_subset surface; /* refers to what was given */
	gw_surface_light_task task;
	spread spread;
	sums compared, beside;
	double wanted; /* gw_bake_options.max_error */
};

static gw_status no_memory(size_t points, gw_error *error)
{
	return gw_fail(error, GW_ERROR_MEMORY, "no memory for the light of %zu points", points);
}

gw_status gw_lit_surface_open(const gw_points *points, const gw_bake_result *lit,
							  const gw_bake_options *options, gw_lit_surface **surface,
							  gw_error *error)
{
	gw_lit_surface *made = *surface = gw_allocate_zeros(1, sizeof *made);
	if (!made)
		return no_memory(points->count, error);
	made->surface.points = *points;
	made->surface.position = (double *)points->position;
	made->surface.normal = (float *)points->normal;
	made->surface.emission = (float *)points->emission;
	made->task = (gw_surface_light_task){ .surface = &made->surface,
										  .estimated = options->normals == GW_NORMALS_ESTIMATE,
										  .threads = options->threads };
	made->spread = (spread){ .task = &made->task, .lit = lit };
	made->wanted = (double)options->max_error;
	if (open_surface(&made->spread, &made->compared))
		return GW_OK;
	gw_lit_surface_close(surface);
	return no_memory(points->count, error);
}

/* The report's numbers, without what the light of the surface owns. */
static void copy_numbers(const gw_report *report, gw_report *copy)
{
	*copy = *report;
	copy->bounce = NULL;
	copy->bounce_count = 0;
}

gw_status gw_lit_surface_light(gw_lit_surface *surface, const gw_points *part,
							   gw_bake_result **light, gw_error *error)
{
	gw_bake_result *out = *light = gw_allocate_zeros(1, sizeof *out);
	spread s = surface->spread;
	sums beside;
	if (!out)
		return no_memory(part->count, error);
	copy_numbers(&s.lit->report, &out->report);
	surface->task.points = part;
	bool good = light_all(&s, out, &beside);
	clear_part(&s);
	surface->beside.distance += beside.distance;
	surface->beside.beside += beside.beside;
	if (!good)
		gw_bake_result_destroy(light);
	return good ? GW_OK : no_memory(part->count, error);
}

void gw_lit_surface_report(const gw_lit_surface *surface, uint64_t all, gw_report *report)
{
	if (report->surface_points == 0)
		report->surface_points = surface->surface.points.count;
	gw_surface_light_count(all, "memory holds no more", report);
	add_error(&surface->beside, &surface->compared, 1.0, report);
	gw_surface_light_hold_against(surface->wanted, report);
}

void gw_lit_surface_close(gw_lit_surface **surface)
{
	if (*surface)
		clear_index(&(*surface)->spread);
	free(*surface);
	*surface = NULL;
}

/*
 * error_estimate.c - see error_estimate.h.
 */
#include "estimate/error_estimate.h"

#include "light/bounces.h"
#include "light/gap_light.h"
#include "estimate/emission_error.h"
#include "estimate/geometry_error.h"
#include "base/luminance.h"
#include "base/memory.h"
#include "cloud/frame.h"
#include "normals/normal_error.h"
#include "base/parallel.h"
#include "estimate/check_point_choice.h"
#include "estimate/hit_light.h"
#include "estimate/narrow_error.h"
#include "estimate/shadow_error.h"
#include "estimate/side_error.h"
#include "light/transport_layout.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Rays, and samples of the emitters, in each of the two gathers of a point: as many as a record
 * has, so that fine bakes are held against something finer. */
#define HALF_LEAST 64u
#define HALF_MOST 512u

/* Points that are solved again: see gw_estimate_points. */
#define RECORDS_A_CHECK_POINT 20u
#define POINTS_MOST 4u

/* Records that light a point, by their weights: 1 / sum w^2. */
#define RECORDS_A_POINT 3.0

static const double reciprocal_pi = 0.31830988618379067;

/* A point of which more of the rays than this pass the back of a surface stands behind the plane of
 * a wall at its foot, and sees what is inside: what it finds says nothing about the bake. */
#define BEHIND_MOST 0.25

/* What of the error the rays do not see, because they meet the planes that the records met: a tenth
 * or so on scenes with known answers, by which the estimate is less sure than its points say. */
#define UNSEEN_SHARE 0.1

/* What all points are off alike counts in each reflection, 20 times among white walls: only that
 * much of it as is beyond chance, by so many of its standard errors, of which 95 % are within two.
 */
#define SURE_DEVIATIONS 2.0

/* What the estimate of one lighting needs. */
typedef struct estimate {
	bool *counts;                 /* one a surfel: whether its error counts */
	gw_check_point_choice choice; /* points that are solved again */
	gw_records place;             /* position and normal of each, and what it gathers */
	uint32_t *behind;             /* one a check point: rays that passed the back of a surface */
	float *half[2];     /* 4 a check point, irradiance that the first and the second gather found */
	double mean_square; /* of what all are off alike, that far as points are sure of it */
	gw_hit_light hit_light; /* empty where facets' light is not asked, or comes by no rays */
} estimate;

uint32_t gw_estimate_rays(uint32_t rays)
{
	uint32_t half = rays > HALF_LEAST ? rays : HALF_LEAST;
	return half < HALF_MOST ? half : HALF_MOST;
}

uint32_t gw_estimate_points(uint32_t wanted, uint32_t records)
{
	uint64_t points = records / RECORDS_A_CHECK_POINT, most = POINTS_MOST * (uint64_t)wanted;
	points = points < most ? points : most;
	if (points < wanted)
		points = wanted;
	return points < UINT32_MAX ? (uint32_t)points : UINT32_MAX;
}

static bool emits(const gw_surfels *surfels, size_t i)
{
	const float *e = surfels->emission ? surfels->emission + 3 * i : NULL;
	return e && (e[0] > 0.0f || e[1] > 0.0f || e[2] > 0.0f);
}

/* Points whose error counts: emitters outshine theirs, so they do not unless there is nothing else;
 * and of points that are lit from both sides at once it is not known which side a gather is to look
 * from. */
static void choose_points(const gw_surfels *surfels, const bool *asked, bool *counts)
{
	size_t dark = 0;
	for (size_t i = 0; i < surfels->count; i++)
		dark += counts[i] =
			gw_surfels_one_sided(surfels, i) && !emits(surfels, i) && (!asked || asked[i]);
	for (size_t i = 0; i < surfels->count && dark == 0; i++)
		counts[i] = gw_surfels_one_sided(surfels, i) && (!asked || asked[i]);
}

/* Radiance that a surfel reflects of an irradiance. */
static double reflected(const gw_surfels *surfels, size_t surfel, const float irradiance[3])
{
	const float *rho = surfels->albedo + 3 * surfel;
	const float c[3] = { rho[0] * irradiance[0], rho[1] * irradiance[1], rho[2] * irradiance[2] };
	return reciprocal_pi * gw_luminance(c);
}

/* Which records around a point disagree, and where the light changes, in radiance. */
static void predict(const gw_estimate_task *task, const double *light, double *variance,
					double *contrast, float *radiance)
{
	const gw_surfels *s = task->surfels;
	gw_check_point_disagreement(task->read_back, light, task->threads, variance);
	for (size_t i = 0; i < s->count; i++) {
		double rho = gw_luminance(s->albedo + 3 * i);
		variance[i] *= rho * rho;
		radiance[i] =
			(float)(reflected(s, i, task->first + 4 * i) + reflected(s, i, task->indirect + 4 * i));
	}
	gw_check_point_contrast(s, radiance, task->threads, contrast);
}

static gw_status draw(const gw_estimate_task *task, const bool *counts,
					  gw_check_point_choice *choice, gw_error *error)
{
	size_t points = task->surfels->count;
	double *light = gw_allocate_array(task->records->count, sizeof *light);
	double *part[2] = { gw_allocate_array(points, sizeof *part[0]),
						gw_allocate_array(points, sizeof *part[1]) };
	float *radiance = gw_allocate_array(points, sizeof *radiance);
	gw_status status = GW_OK;
	if (!light || !part[0] || !part[1] || !radiance)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory to draw from %zu points", points);
	if (status == GW_OK)
		status = gw_records_light(task->passes->gpu, task->records, light, error);
	if (status == GW_OK) {
		predict(task, light, part[0], part[1], radiance);
		status = gw_check_point_choose(
			&(gw_check_point_shares){ points, counts, (const double *const[]){ part[0], part[1] },
									  2, part[0] },
			task->points, task->seed, choice, error);
	}
	free(light);
	free(part[0]);
	free(part[1]);
	free(radiance);
	return status;
}

static gw_status sum_and_shade(const gw_estimate_task *task, gw_buffer *total, gw_buffer *radiance,
							   gw_error *error)
{
	gw_records *records = task->records;
	const gw_record_context on = { task->passes, task->octree, records };
	GW_TRY(gw_light_add(task->passes, &records->first, total, records->count, error));
	GW_TRY(gw_light_add(task->passes, &records->indirect, total, records->count, error));
	GW_TRY(gw_buffer_create(task->passes->gpu,
							&(gw_buffer_description){
								GW_BUFFER_TEXEL, VK_FORMAT_R32G32B32A32_SFLOAT,
								16 * (uint64_t)task->octree->facet_count, "final facet radiance" },
							radiance, error));
	return gw_facets_shade(&on, total, task->facet_direct, 1.0f, radiance, error);
}

/* What the facets send out in the end, their own emission left out. */
static gw_status shade_all(const gw_estimate_task *task, gw_buffer *radiance, gw_error *error)
{
	gw_gpu *gpu = task->passes->gpu;
	gw_buffer total = { 0 };
	GW_TRY(gw_buffer_create(
		gpu,
		&(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_R32G32B32A32_SFLOAT,
								  16 * (uint64_t)task->records->count, "record irradiance" },
		&total, error));
	gw_status status = sum_and_shade(task, &total, radiance, error);
	gw_buffer_destroy(gpu, &total);
	return status;
}

static gw_status download_added(gw_gpu *gpu, gw_buffer *buffer, float *sum, uint32_t count,
								gw_error *error)
{
	float *values = gw_allocate_array(count, 4 * sizeof *values);
	if (!values)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %u points", count);
	gw_status status = gw_buffer_download(gpu, buffer, 0, values, 16 * (uint64_t)count, error);
	for (size_t i = 0; i < 4 * (size_t)count && status == GW_OK; i++)
		sum[i] += values[i];
	free(values);
	return status;
}

/* What was gathered, with gaps closed as the bake closes them (gap_light.h). */
static gw_status close_gaps(const gw_estimate_task *task, const gw_ray_gather *rays, bool first,
							gw_records *place, gw_error *error)
{
	const gw_record_context on = { task->passes, task->octree, place };
	const gw_bake_options *o = task->options;
	const gw_gap_task look = { &on, rays, task->closed, task->sky, task->map, task->threads, NULL };
	const float fill[3] = { o->gap_radiance, o->gap_radiance, o->gap_radiance };
	bool mean = o->gaps == GW_GAPS_MEAN;
	gw_gap_sight *gap;
	if (!first && !mean)
		return GW_OK;
	GW_TRY(gw_gap_light_find(&look, &gap, error));
	gw_status status =
		first ? gw_gap_light_close(&on, gap, mean ? NULL : fill, !gw_surfels_emit(task->surfels),
								   &place->gathered, error)
			  : gw_gap_light_fill(&on, gap, &place->gathered, error);
	free(gap);
	return status;
}

/* Light straight from some emitters, or from what facets reflect, added to e->half[half]. */
static gw_status gather_from(const gw_estimate_task *task, const gw_ray_gather *rays, int half,
							 const gw_sampled_sources *sources, estimate *e, gw_error *error)
{
	gw_records *place = &e->place;
	const gw_record_context on = { task->passes, task->octree, place };
	GW_TRY(gw_ray_gather_sampled(&on, rays, sources, &place->gathered, error));
	if (task->closed)
		GW_TRY(close_gaps(task, rays, sources->emitters == task->emitters, place, error));
	return download_added(task->passes->gpu, &place->gathered, e->half[half], place->count, error);
}

static void count_behind(const gw_check_point_hits *hits, uint32_t *behind)
{
	size_t rows = GW_CHECK_POINT_GATHERS * (size_t)hits->count;
	for (size_t i = 0; i < rows * hits->rays; i++)
		behind[i / hits->rays % hits->count] += hits->distance[i] < 0.0f;
}

/* All that reaches the points along these rays, into e->half[half]. */
static gw_status gather_along(const gw_estimate_task *task, gw_check_point_view *view, int half,
							  const gw_emitters *reflectors, estimate *e, gw_error *error)
{
	const gw_record_context on = { task->passes, task->octree, &e->place };
	gw_ray_gather *rays = &view->rays;
	const float black[3] = { 0 };
	uint32_t samples = rays->rays;
	const gw_sampled_sources emitters = { .emitters = task->emitters,
										  .samples = samples,
										  .use_hits = true,
										  .sky = task->sky,
										  .map = task->map,
										  .map_samples = samples,
										  .map_hits = true,
										  .portals = task->portals,
										  .seed = rays->seed,
										  .kept = task->hits->emitted ? &view->emitted : NULL };
	const gw_sampled_sources reflected = { .emitters = reflectors,
										   .samples =
											   gw_emitters_are_small(reflectors) ? samples : 0,
										   .use_hits = true,
										   .sky = black,
										   .seed = rays->seed };
	if (task->portals)
		GW_TRY(gw_ray_gather_open(&on, task->portals, rays, error));
	GW_TRY(gather_from(task, rays, half, &emitters, e, error));
	if (task->bounces)
		GW_TRY(gather_from(task, rays, half, &reflected, e, error));
	return GW_OK;
}

/* What lamps send to the places that the rays meet, beyond the facets' light. */
static gw_status add_at_hits(const gw_estimate_task *task, uint32_t seed, int half, estimate *e,
							 gw_error *error)
{
	const gw_check_point_hits *hits = task->hits;
	const size_t first = (size_t)half * hits->count * hits->rays;
	const gw_hit_light_rays rays = { &e->place, hits->facet + first, hits->distance + first,
									 hits->rays, seed };
	if (e->hit_light.lamps == 0)
		return GW_OK;
	return gw_hit_light_add(&e->hit_light, &rays, gw_thread_count(task->threads), e->half[half],
							error);
}

static gw_status gather_half(const gw_estimate_task *task, const gw_check_point_task *check_points,
							 int half, const gw_emitters *reflectors, estimate *e, gw_error *error)
{
	gw_check_point_view view = { 0 };
	e->half[half] = gw_allocate_zeros(e->place.count, 4 * sizeof(float));
	if (!e->half[half])
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %u points", e->place.count);
	gw_status status = gw_check_point_hits_gather(check_points, task->hits, &e->place,
												  (uint32_t)half, &view, error);
	if (status == GW_OK)
		status = gather_along(task, &view, half, reflectors, e, error);
	if (status == GW_OK)
		status = add_at_hits(task, view.rays.seed, half, e, error);
	gw_check_point_view_destroy(task->passes->gpu, &view);
	return status;
}

static double mean_radiance(const gw_estimate_task *task, const bool *counts)
{
	const gw_surfels *s = task->surfels;
	double sum = 0.0;
	size_t used = 0;
	for (size_t i = 0; i < s->count; i++) {
		if (!counts[i])
			continue;
		if (task->records)
			sum += reflected(s, i, task->first + 4 * i) + reflected(s, i, task->indirect + 4 * i);
		sum += task->direct ? reflected(s, i, task->direct + 4 * i) : 0.0;
		sum += s->emission ? gw_luminance(s->emission + 3 * i) : 0.0;
		used++;
	}
	return used ? sum / (double)used : 0.0;
}

/* The square errors that were found, noise of the finding taken off; rows of a table. */
enum { OFF, EXCESS, HALVES, VALUES };

static bool is_sound(const gw_estimate_task *task, const estimate *e, size_t i)
{
	return e->behind[i] <= BEHIND_MOST * 2 * gw_estimate_rays(task->rays);
}

/* Leaves the points that are sound, which then stand for all. */
static void keep_sound(const gw_estimate_task *task, estimate *e)
{
	gw_check_point_choice *c = &e->choice;
	double all = 0.0, sound = 0.0;
	uint32_t kept = 0;
	for (uint32_t i = 0; i < c->count; i++) {
		bool keep = is_sound(task, e, i);
		all += c->weight[i];
		sound += keep ? c->weight[i] : 0.0;
		if (!keep)
			continue;
		for (int half = 0; half < 2; half++)
			memmove(e->half[half] + 4 * (size_t)kept, e->half[half] + 4 * (size_t)i,
					4 * sizeof(float));
		c->point[kept] = c->point[i];
		c->weight[kept++] = c->weight[i];
	}
	for (uint32_t i = 0; i < kept; i++)
		c->weight[i] *= all / sound;
	c->count = kept;
}

static void list_errors(const gw_estimate_task *task, const estimate *e, double mean,
						double *value[VALUES])
{
	const gw_check_point_choice *c = &e->choice;
	for (size_t i = 0; i < c->count; i++) {
		size_t s = c->point[i];
		double a = reflected(task->surfels, s, e->half[0] + 4 * i);
		double b = reflected(task->surfels, s, e->half[1] + 4 * i);
		double found = reflected(task->surfels, s, task->first + 4 * s) +
					   reflected(task->surfels, s, task->indirect + 4 * s);
		double off = (found - 0.5 * (a + b)) / mean, noise = 0.5 * (a - b) / mean;
		value[OFF][i] = off;
		value[EXCESS][i] = off * off - noise * noise;
		value[HALVES][i] = 2.0 * noise * noise;
	}
}

/* How often light arrives until it is gone, over how often it does before it was reflected. */
static double reflections(const gw_estimate_task *task)
{
	const gw_surfels *s = task->surfels;
	double first = 0.0, all = 0.0;
	for (size_t i = 0; i < s->count; i++) {
		double area = (double)s->area[i], unreflected = gw_luminance(task->first + 4 * i);
		unreflected += task->direct ? gw_luminance(task->direct + 4 * i) : 0.0;
		first += area * unreflected;
		all += area * (unreflected + gw_luminance(task->indirect + 4 * i));
	}
	return first > 0.0 ? all / first : 1.0;
}

/*
 * Points gather what the bake says that surfaces send out, so what they find is what one gather is
 * off. Where G is what gathers right and the bake is off by b, L = E + G L + b is off by
 * (1 - G)^-1 b: what is too much on average is so again in each reflection. That holds for records'
 * rays, too, where facets are the mean of points that do not count alike; geometry_error.h says
 * what the octree's surface adds, which points see as records do. Returns by how much more the mean
 * square is, and what it is in all into e->mean_square.
 */
static double square_of_reflections(const gw_estimate_task *task, gw_check_point_mean off,
									estimate *e)
{
	double chance = SURE_DEVIATIONS * SURE_DEVIATIONS * off.variance, times = 1.0;
	double sure = fmax(off.mean * off.mean - chance, 0.0);
	if (task->bounces)
		times = reflections(task);
	e->mean_square = sure * times * times;
	return e->mean_square - sure;
}

static gw_status compare(const gw_estimate_task *task, estimate *e, double mean,
						 gw_error_estimate *result, gw_error *error)
{
	const gw_check_point_choice *c = &e->choice;
	keep_sound(task, e);
	if (c->count < 2 || !(mean > 0.0))
		return GW_OK;
	double *room = gw_allocate_array(c->count, VALUES * sizeof *room);
	if (!room)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %u points", c->count);
	double *value[VALUES] = { room, room + c->count, room + 2 * (size_t)c->count };
	list_errors(task, e, mean, value);
	gw_check_point_mean square = gw_check_point_average(c, value[EXCESS]);
	gw_check_point_mean off = gw_check_point_average(c, value[OFF]);
	square.mean += square_of_reflections(task, off, e);
	double rms = sqrt(fmax(square.mean, 0.0)), half = gw_check_point_average(c, value[HALVES]).mean;
	result->points = c->count;
	result->relative_rms = result->gathered = rms;
	/* d sqrt(x) = dx / (2 sqrt(x)); at 0 the spread of x is all that is known. */
	double spread = fmin(sqrt(square.variance) / (2.0 * rms), sqrt(sqrt(square.variance)));
	/* What was there is that of the sides. */
	result->spread = hypot(result->spread, hypot(spread, UNSEEN_SHARE * rms));
	result->bias = off.mean;
	/* A point's light is a mean over records, each of which gathers like a half does. */
	double samples = fmin(task->rays, task->light_samples), own = gw_estimate_rays(task->rays);
	result->noise = fmin(sqrt(half * own / samples / RECORDS_A_POINT), rms);
	free(room);
	return GW_OK;
}

/* What the edges of lamps' shadows add, and noise of the normals. */
static gw_status add_lamps(const gw_estimate_task *task, const estimate *e, double mean,
						   gw_error_estimate *result, gw_error *error)
{
	double square;
	if (!task->direct || !(mean > 0.0))
		return GW_OK;
	gw_status status = gw_shadow_error(task->surfels, task->direct, e->counts,
									   gw_thread_count(task->threads), &square, error);
	result->shadows = status == GW_OK ? sqrt(square) / mean : 0.0;
	if (status == GW_OK && task->turned)
		result->normals =
			sqrt(gw_normal_error(task->surfels, task->direct, task->turned, e->counts)) / mean;
	result->relative_rms = hypot(result->relative_rms, hypot(result->shadows, result->normals));
	return status;
}

/* What emitters that are too bright or too dark add: as much as points have their light from them.
 * Of light that reached a surface for the first time, theirs is at most what they send out; a sky
 * may have brought the rest, as lamps did beside that. */
static void add_emission(const gw_estimate_task *task, const estimate *e, double mean,
						 gw_error_estimate *result)
{
	const gw_surfels *s = task->surfels;
	double sent = 0.0, first = 0.0, lamps = 0.0, square = 0.0;
	size_t used = 0;
	if (!task->records || !gw_surfels_emit(s) || !(mean > 0.0))
		return;
	for (size_t i = 0; i < s->count; i++) {
		double area = (double)s->area[i];
		sent += area * gw_luminance(s->emission + 3 * i) / reciprocal_pi;
		first += area * gw_luminance(task->first + 4 * i);
		lamps += task->direct ? area * gw_luminance(task->direct + 4 * i) : 0.0;
	}
	double share = first > 0.0 ? fmin(sent / first, 1.0) : 0.0;
	double share_reflected = share > 0.0 ? share * first / (first + lamps) : 0.0;
	for (size_t i = 0; i < s->count; i++) {
		if (!e->counts[i])
			continue;
		double light = share * reflected(s, i, task->first + 4 * i) +
					   share_reflected * reflected(s, i, task->indirect + 4 * i);
		square += light * light;
		used++;
	}
	result->emission = used ? gw_emission_error(s) * sqrt(square / (double)used) / mean : 0.0;
	result->relative_rms = hypot(result->relative_rms, result->emission);
}

/* What bounces that nobody asked to be left out would add, all of which is missing. Points gather
 * one bounce more than the bake, so what they find that all are off alike has it in it. */
static void add_remaining(const gw_estimate_task *task, const estimate *e,
						  gw_error_estimate *result)
{
	double unseen = task->remaining * task->remaining - e->mean_square;
	if (task->limit == GW_BOUNCES_AUTO && (result->points > 0 || result->relative_rms > 0.0))
		result->relative_rms = hypot(result->relative_rms, sqrt(fmax(unseen, 0.0)));
}

/* Where the points stand, and what they see. */
static gw_status look(const gw_estimate_task *task, const gw_check_point_task *check_points,
					  estimate *e, gw_error *error)
{
	const gw_check_point_choice *c = &e->choice;
	GW_TRY(gw_check_point_hits_find(check_points, c->point, c->count, task->hits, error));
	e->behind = gw_allocate_zeros(c->count, sizeof *e->behind);
	if (!e->behind)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %u points", c->count);
	count_behind(task->hits, e->behind);
	return gw_check_point_hits_place(check_points, c->point, c->count, &e->place, error);
}

/* Luminance of what each surfel sends out and gathers see. */
static float *list_radiance(const gw_estimate_task *task)
{
	const gw_surfels *s = task->surfels;
	float *light = gw_allocate_array(s->count, sizeof *light);
	for (size_t i = 0; i < s->count && light; i++) {
		double sum = s->emission ? gw_luminance(s->emission + 3 * i) : 0.0;
		if (task->bounces)
			sum += reflected(s, i, task->first + 4 * i) + reflected(s, i, task->indirect + 4 * i);
		if (task->bounces && task->direct)
			sum += reflected(s, i, task->direct + 4 * i);
		light[i] = (float)sum;
	}
	return light;
}

/* What it costs that some points may face the other way, and that some may be on narrow things. */
static gw_status check_points(const gw_geometry_task *geometry, const gw_estimate_task *task,
							  double mean, gw_error_estimate *result, gw_error *error)
{
	gw_view texel = { 0 };
	gw_side_finding found;
	double narrow = 0.0;
	const gw_sky_map *m = geometry->map;
	gw_status status = GW_OK;
	if (geometry->records && m && m->width > 0)
		status = gw_view_open(geometry->gpu, &m->texel, 16 * (uint64_t)m->width * m->height, &texel,
							  error);
	const gw_side_task check = { .gpu = geometry->gpu,
								 .octree = geometry->octree,
								 .surfels = geometry->surfels,
								 .discs = geometry->discs,
								 .asked = task->asked,
								 .seen = task->seen,
								 .seed = geometry->seed,
								 .threads = geometry->threads,
								 .radiance = geometry->radiance,
								 .whole = geometry->facet_radiance != NULL,
								 .sky = { geometry->sky, m, texel.bytes },
								 .limit = geometry->limit,
								 .lights = geometry->lights,
								 .light_count = geometry->direct ? geometry->light_count : 0,
								 .options = geometry->options };
	if (status == GW_OK)
		status = gw_side_error(&check, &found, error);
	if (status == GW_OK)
		status = gw_narrow_error(&check, geometry->counts, &narrow, error);
	gw_view_close(&texel);
	if (status == GW_OK) {
		result->sides = found.rms / mean;
		result->sides_share = found.share;
		result->narrow = narrow / mean;
		result->spread = hypot(result->spread, found.spread / mean);
	}
	return status;
}

static bool is_geometry_checked(const gw_estimate_task *task, double mean)
{
	return mean > 0.0 && task->octree->leaf_count > 0;
}

/* The discs by which geometry is checked. Building their tree takes more than it, so it comes
 * before what else is needed then. */
static gw_status open_discs(const gw_estimate_task *task, double mean, gw_error *error)
{
	return is_geometry_checked(task, mean)
			   ? gw_check_discs_open(task->passes, task->octree, task->surfels, task->discs, error)
			   : GW_OK;
}

/* What the geometry by itself says. *facet_radiance is gone when nothing reads it any more. */
static gw_status check_geometry(const gw_estimate_task *task, const estimate *e,
								gw_buffer *facet_radiance, double mean, gw_error_estimate *result,
								gw_error *error)
{
	double rms = 0.0;
	if (!is_geometry_checked(task, mean))
		return GW_OK;
	float *light = task->records ? list_radiance(task) : NULL;
	if (task->records && !light)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu points", task->surfels->count);
	bool shadows = task->options->shadows != GW_SHADOWS_NONE;
	const gw_geometry_task check = { .gpu = task->passes->gpu,
									 .octree = task->octree,
									 .surfels = task->surfels,
									 .discs = task->discs,
									 .counts = e->counts,
									 .seed = task->seed,
									 .threads = task->threads,
									 .records = task->records,
									 .rays = task->rays_of_records,
									 .read_back = task->read_back,
									 .facet_radiance = task->bounces ? facet_radiance : NULL,
									 .hit_light = e->hit_light.lamps ? &e->hit_light : NULL,
									 .radiance = light,
									 .sky = task->sky,
									 .map = task->map,
									 .limit = task->limit,
									 .direct = shadows ? task->direct : NULL,
									 .lights = task->lights,
									 .light_count = task->light_count,
									 .options = task->options,
									 .closed = task->closed };
	gw_status status = gw_geometry_error(&check, &rms, error);
	if (facet_radiance)
		gw_buffer_destroy(task->passes->gpu, facet_radiance);
	if (status == GW_OK)
		status = check_points(&check, task, mean, result, error);
	free(light);
	result->geometry = rms / mean;
	return status;
}

/* What the light that arrives at the points again comes from. */
typedef struct again {
	gw_buffer radiance; /* of facets */
	gw_emitters reflectors;
} again;

/* Where facets are sampled, because what is bright is small, their light does not come by rays. */
static gw_status open_hit_light(const gw_estimate_task *task, const gw_emitters *reflectors,
								gw_hit_light *light, gw_error *error)
{
	const gw_hit_light_task of = { task->passes->gpu,  task->octree, task->surfels,
								   task->facet_direct, task->direct, task->lights,
								   task->light_count,  task->options };
	return task->direct && !gw_emitters_are_small(reflectors) ? gw_hit_light_open(&of, light, error)
															  : GW_OK;
}

static gw_status solve_with(const gw_estimate_task *task, again *a, estimate *e, double mean,
							gw_error_estimate *result, gw_error *error)
{
	const gw_check_point_task check_points = { .passes = task->passes,
											   .octree = task->octree,
											   .surfels = task->surfels,
											   .emitters = task->emitters,
											   .rays = gw_estimate_rays(task->rays),
											   .seed = task->seed };
	GW_TRY(look(task, &check_points, e, error));
	GW_TRY(open_discs(task, mean, error));
	if (task->bounces) {
		GW_TRY(shade_all(task, &a->radiance, error));
		GW_TRY(gw_emitters_make(task->passes->gpu, task->octree, &a->radiance, false,
								&a->reflectors, error));
		GW_TRY(open_hit_light(task, &a->reflectors, &e->hit_light, error));
	}
	for (int half = 0; half < 2; half++)
		GW_TRY(gather_half(task, &check_points, half, &a->reflectors, e, error));
	GW_TRY(check_geometry(task, e, &a->radiance, mean, result, error));
	return compare(task, e, mean, result, error);
}

/* What the points find, and what that says of the bake. */
static gw_status solve_again(const gw_estimate_task *task, estimate *e, double mean,
							 gw_error_estimate *result, gw_error *error)
{
	again a = { .radiance = { 0 } };
	GW_TRY(draw(task, e->counts, &e->choice, error));
	if (e->choice.count == 0)
		return GW_OK;
	gw_status status = solve_with(task, &a, e, mean, result, error);
	gw_emitters_destroy(task->passes->gpu, &a.reflectors);
	gw_buffer_destroy(task->passes->gpu, &a.radiance);
	return status;
}

gw_status gw_estimate_foresee(const gw_check_point_task *task, uint32_t points,
							  gw_check_point_hits *hits, gw_error *error)
{
	const gw_surfels *s = task->surfels;
	gw_check_point_choice choice = { 0 };
	bool *counts = gw_allocate_array(s->count, sizeof *counts);
	if (!counts)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu points", s->count);
	choose_points(s, NULL, counts);
	gw_status status =
		gw_check_point_choose(&(gw_check_point_shares){ s->count, counts, NULL, 0, NULL }, points,
							  task->seed, &choice, error);
	if (status == GW_OK && choice.count > 0)
		status = gw_check_point_hits_find(task, choice.point, choice.count, hits, error);
	gw_check_point_choice_clear(&choice);
	free(counts);
	return status;
}

gw_status gw_estimate_error(const gw_estimate_task *task, gw_error_estimate *result,
							gw_error *error)
{
	estimate e = { 0 };
	*result = (gw_error_estimate){ 0 };
	e.counts = gw_allocate_array(task->surfels->count, sizeof *e.counts);
	if (!e.counts)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu points", task->surfels->count);
	choose_points(task->surfels, task->asked, e.counts);
	double mean = mean_radiance(task, e.counts);
	gw_status status = GW_OK;
	if (task->records)
		status = solve_again(task, &e, mean, result, error);
	else
		status = open_discs(task, mean, error);
	if (status == GW_OK && !task->records)
		status = check_geometry(task, &e, NULL, mean, result, error);
	if (status == GW_OK)
		status = add_lamps(task, &e, mean, result, error);
	if (status == GW_OK)
		add_emission(task, &e, mean, result);
	result->relative_rms =
		hypot(result->relative_rms, hypot(hypot(result->geometry, result->sides), result->narrow));
	add_remaining(task, &e, result);
	gw_hit_light_close(&e.hit_light);
	gw_records_destroy(task->passes->gpu, &e.place);
	gw_check_point_choice_clear(&e.choice);
	free(e.behind);
	free(e.half[0]);
	free(e.half[1]);
	free(e.counts);
	return status;
}

/*
 * gap_error.c - see gap_error.h.
 */
#include "estimate/gap_error.h"

#include "base/luminance.h"
#include "base/memory.h"
#include "estimate/check_light.h"
#include "light/direct_light.h"

#include <math.h>
#include <stdlib.h>

/* Points whose ways to the lamps are looked at. */
#define LAMP_POINTS 512u

/* Of a record's directions, so many may be gaps; the others say what surrounds them. */
#define SHARE_MOST 0.9

typedef struct work {
	const gw_gap_error_task *task;
	double *mean, *square; /* one a record: what it counts for in the mean over the points */
	double *plain;         /* likewise, whatever the points reflect */
	double *sent;          /* irradiance */
	double radiance;       /* mean of the points */
	double reflected;      /* mean reflectance */
} work;

static const double reciprocal_pi = 0.31830988618379067;

static bool emits(const gw_surfels *s, size_t i)
{
	return s->emission && gw_luminance(s->emission + 3 * i) > 0.0;
}

static void weigh_point(work *w, size_t i)
{
	const gw_gap_error_task *t = w->task;
	const gw_read_back *rows = t->read_back;
	double rho = gw_luminance(t->surfels->albedo + 3 * i);
	double light = gw_luminance(t->first + 4 * i) + gw_luminance(t->indirect + 4 * i);
	if (t->direct)
		light += gw_luminance(t->direct + 4 * i);
	w->radiance += reciprocal_pi * rho * light;
	if (t->surfels->emission)
		w->radiance += gw_luminance(t->surfels->emission + 3 * i);
	w->reflected += rho;
	for (uint32_t e = rows->first[i]; e < rows->first[i + 1]; e++) {
		uint32_t r = rows->record[e];
		double weight = (double)rows->weight[e];
		w->plain[r] += weight;
		w->mean[r] += rho * weight;
		w->square[r] += rho * rho * weight;
	}
}

static void weigh(work *w)
{
	const gw_surfels *s = w->task->surfels;
	size_t used = 0, dark = 0;
	for (size_t i = 0; i < s->count; i++)
		dark += !emits(s, i);
	for (size_t i = 0; i < s->count; i++) {
		if (dark > 0 && emits(s, i))
			continue;
		weigh_point(w, i);
		used++;
	}
	double share = used > 0 ? 1.0 / (double)used : 0.0;
	for (size_t r = 0; r < w->task->on.records->count; r++) {
		w->plain[r] *= share;
		w->mean[r] *= share;
		w->square[r] *= share;
	}
	w->radiance *= share;
	w->reflected *= share;
}

/* What a record sees but for gaps, as a mean over all of its directions. */
static double beside_gaps(const work *w, size_t record)
{
	const gw_gap_sight *g = &w->task->gap[record];
	const gw_bake_options *o = w->task->options;
	double all = reciprocal_pi * w->sent[record], share = fmin((double)g->share, SHARE_MOST);
	if (o->gaps == GW_GAPS_MEAN)
		return all * (1.0 - share);
	double through =
		o->gaps == GW_GAPS_OPEN ? gw_luminance(g->sky) : (double)g->share * (double)o->gap_radiance;
	return fmax(all - through, 0.0);
}

/* 1 + kept + kept^2 and so on. */
static double reflections(const work *w)
{
	double kept = fmin(w->reflected, (double)GW_ALBEDO_MAX);
	uint32_t limit = w->task->limit;
	return limit == GW_BOUNCES_AUTO ? 1.0 / (1.0 - kept) : (1.0 - pow(kept, limit)) / (1.0 - kept);
}

static void sum_records(const work *w, gw_gap_report *report, gw_error_estimate *estimate)
{
	double sky = 0.0, through = 0.0, black = 0.0, bright = 0.0, mean = 0.0, square = 0.0;
	for (size_t r = 0; r < w->task->on.records->count; r++) {
		const gw_gap_sight *g = &w->task->gap[r];
		double share = fmin((double)g->share, SHARE_MOST), rest = beside_gaps(w, r);
		double full = rest / (1.0 - share), now = reciprocal_pi * w->sent[r];
		/* Closed as they are, gaps are known no better than to half of what closes them. */
		double off = fmax(fabs(full - now), 0.5 * (full - rest));
		report->share += w->plain[r] * (double)g->share;
		sky += w->mean[r] * (double)g->all;
		through += w->mean[r] * gw_luminance(g->sky);
		black += w->mean[r] * (rest - now);
		bright += w->mean[r] * (full - now);
		mean += w->mean[r] * (full < now ? -off : off);
		square += w->square[r] * off * off;
	}
	double more = reflections(w) / w->radiance;
	double single = fmax(square - mean * mean, 0.0);
	report->sky = sky > 0.0 ? through / sky : 0.0;
	report->black = fmax(1.0 + more * black, 0.0);
	report->bright = fmax(1.0 + more * bright, 0.0);
	estimate->gaps = hypot(more * mean, sqrt(single) / w->radiance);
}

/* -------------------------------------------------------------------------------------- lamps */

/* Light of a lamp at a surfel were nothing in the way, and whether its way passes a gap. */
static double lamp_at(const work *w, const gw_light_push *lamp, size_t surfel, bool *passes)
{
	const gw_octree *o = w->task->on.octree;
	const float *p = w->task->surfels->position + 3 * surfel;
	const float *n = w->task->surfels->normal + 3 * surfel, *low = o->cube_minimum;
	gw_way way = { .from = { p[0], p[1], p[2] } };
	const gw_check_place place = { gw_times(gw_minus(way.from, (gw_vec3){ low[0], low[1], low[2] }),
											1.0f / o->leaf_size),
								   { n[0], n[1], n[2] } };
	float distance;
	double light = gw_check_lamp_light(lamp, &place, &way.direction, &distance);
	way.length = lamp->type == GW_PUSH_SUN ? INFINITY : distance * o->leaf_size;
	*passes = light > 0.0 && gw_scanned_space_is_gap(w->task->space, &way);
	return light;
}

static double share_of_lamps(const work *w, const gw_light_push *lamp, size_t lamps)
{
	const gw_gap_error_task *t = w->task;
	const gw_surfels *s = t->surfels;
	size_t step = s->count / LAMP_POINTS + 1;
	double sum = 0.0, through = 0.0;
	for (size_t i = 0; i < s->count; i += step) {
		double found = gw_luminance(s->albedo + 3 * i) * gw_luminance(t->direct + 4 * i);
		double all = 0.0, passing = 0.0;
		for (size_t l = 0; l < lamps && found > 0.0; l++) {
			bool passes;
			double light = lamp_at(w, &lamp[l], i, &passes);
			all += light;
			passing += passes ? light : 0.0;
		}
		sum += found;
		through += all > 0.0 ? found * passing / all : 0.0;
	}
	return sum > 0.0 ? through / sum : 0.0;
}

static gw_status look_at_lamps(const work *w, gw_gap_report *report, gw_error *error)
{
	const gw_gap_error_task *t = w->task;
	size_t lamps = 0;
	if (!t->direct)
		return GW_OK;
	gw_light_push *lamp = gw_allocate_array(t->light_count, sizeof *lamp);
	if (!lamp)
		return gw_fail(error, GW_ERROR_MEMORY, "no host memory for %zu lights", t->light_count);
	for (size_t i = 0; i < t->light_count; i++)
		if (gw_light_shines(&t->lights[i]))
			lamp[lamps++] = gw_light_push_of(&t->lights[i], t->on.octree, t->surfels, t->options);
	report->lamps = share_of_lamps(w, lamp, lamps);
	free(lamp);
	return GW_OK;
}

gw_status gw_gap_error(const gw_gap_error_task *task, gw_gap_report *report,
					   gw_error_estimate *estimate, gw_error *error)
{
	size_t count = task->on.records->count;
	*report = (gw_gap_report){ .scanners = report->scanners, .black = 1.0, .bright = 1.0 };
	double *room = gw_allocate_zeros(count, 4 * sizeof *room);
	if (!room)
		return gw_fail(error, GW_ERROR_MEMORY, "no host memory for %zu records", count);
	work w = { task, room, room + count, room + 2 * count, room + 3 * count, 0.0, 0.0 };
	gw_status status = gw_records_light(task->on.passes->gpu, task->on.records, w.sent, error);
	if (status == GW_OK)
		weigh(&w);
	if (status == GW_OK && w.radiance > 0.0)
		sum_records(&w, report, estimate);
	if (status == GW_OK)
		status = look_at_lamps(&w, report, error);
	estimate->relative_rms = hypot(estimate->relative_rms, estimate->gaps);
	free(room);
	return status;
}

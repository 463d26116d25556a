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

/* Lit points whose ways to the lamps are looked at. */
#define LAMP_POINTS 512u

/* Directions in which it is looked where a lamp's light goes. */
#define LAMP_RAYS 2048u

#define GOLDEN_ANGLE 2.39996323f
#define FAR_METRES 1e30f

/* Of a record's directions, so many may be gaps; the others say what surrounds them. */
#define SHARE_MOST 0.9

typedef struct work {
	const gw_gap_error_task *task;
	double *mean, *square;    /* one a record: what it counts for in the mean over the points */
	double *plain;            /* likewise, whatever the points reflect */
	double *sent;             /* irradiance */
	double radiance;          /* mean of the points */
	double reflected;         /* mean reflectance */
	double of_lamps;          /* part of radiance: lamps' light that was reflected before */
	double of_direct, of_sky; /* sums of the points' irradiance before any reflection */
	double shone;    /* part of radiance: of lamps and suns straight, not reflected again */
	double contrast; /* of reflected light: root mean square over mean */
	double lost;     /* of the light that lamps send: is as likely to be missing */
	bool guessed;    /* gaps are holes, which may as well be windows */
	bool sky_shines; /* through some of them, so that one of them is */
	/* Light of suns through gaps, reflected once, and its square: means over the points. */
	double passing, passing_square;
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
	double lamps = t->direct ? gw_luminance(t->direct + 4 * i) : 0.0;
	light += lamps;
	w->of_direct += lamps;
	w->of_sky += gw_luminance(t->first + 4 * i);
	w->shone += reciprocal_pi * rho * lamps;
	double reflected = reciprocal_pi * rho * gw_luminance(t->indirect + 4 * i);
	w->of_lamps += reflected;
	w->contrast += reflected * reflected;
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
	const bool *asked = w->task->asked;
	for (size_t i = 0; i < s->count; i++)
		dark += !emits(s, i) && (!asked || asked[i]);
	for (size_t i = 0; i < s->count; i++) {
		if ((asked && !asked[i]) || (dark > 0 && emits(s, i)))
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
	w->shone *= share;
	w->contrast = w->of_lamps > 0.0 ? sqrt(w->contrast / share) / w->of_lamps : 1.0;
	if (w->of_direct > 0.0)
		w->of_lamps *= share * w->of_direct / (w->of_direct + w->of_sky);
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

/* Each of so many holes is as likely a window as none, but where light comes through them one of
 * them has to be: somebody set up that light to be seen. */
static double chance_of_none(uint32_t holes)
{
	double none = ldexp(1.0, -(int)(holes < 64 ? holes : 64));
	return holes > 0 ? (0.5 - none) / (1.0 - none) : 0.0;
}

/* Light of the sky through holes, and what its rays bring of others, is wrong where they are none;
 * that each is none by itself makes their sum surer. Held against the mean that is likely then. */
static double doubt_of_windows(const work *w)
{
	double none = chance_of_none(w->task->space->holes), mean = w->passing;
	double square = w->passing_square;
	for (size_t r = 0; r < w->task->on.records->count && w->task->options->gaps == GW_GAPS_OPEN;
		 r++) {
		double sky = gw_luminance(w->task->gap[r].sky);
		mean += w->mean[r] * sky;
		square += w->square[r] * sky * sky;
	}
	double part = none * none + none * (1.0 - none) / w->task->space->holes;
	double single = fmax(none * square - part * mean * mean, 0.0);
	double lost = fmin(reflections(w) * mean / w->radiance, 1.0);
	return hypot(sqrt(part) * lost, sqrt(single) / w->radiance) / (1.0 - none * lost);
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
		if (w->guessed && w->task->options->gaps == GW_GAPS_OPEN)
			off = w->sky_shines ? 0.0 : M_SQRT1_2 * (full - rest);
		/* Panes are black now. */
		off += M_SQRT1_2 * full * fmin((double)g->pane, SHARE_MOST);
		report->share += w->plain[r] * (double)g->share;
		sky += w->mean[r] * (double)g->all;
		through += w->mean[r] * gw_luminance(g->sky);
		black += w->mean[r] * (rest - now);
		bright += w->mean[r] * (full - now);
		mean += w->mean[r] * (full < now ? -off : off);
		square += w->square[r] * off * off;
	}
	double more = reflections(w) / w->radiance;
	double missing = w->of_lamps / w->radiance * w->lost / (1.0 - w->lost);
	double single = fmax(square - mean * mean, 0.0);
	report->sky = sky > 0.0 ? through / sky : 0.0;
	report->black = fmax(1.0 + more * black, 0.0);
	report->bright = fmax(1.0 + more * bright, 0.0);
	estimate->gaps = hypot(w->contrast * (more * mean + missing), sqrt(single) / w->radiance);
	if (w->guessed)
		estimate->gaps = hypot(estimate->gaps, doubt_of_windows(w));
}

/* -------------------------------------------------------------------------------------- lamps */

/* Light of a lamp at a surfel were nothing in the way, and whether its way passes a gap. */
static double lamp_at(const work *w, const gw_lamp *lamp, size_t surfel, bool *passes)
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
	way.length = lamp->push.type == GW_PUSH_SUN ? INFINITY : distance * o->leaf_size;
	*passes = light > 0.0 && gw_scanned_space_is_gap(w->task->space, &way);
	return light;
}

/* Share of what lamps send to a surfel that passes gaps; of suns, which shine from outside, goes to
 * *of_suns. */
static double share_passing(const work *w, const gw_lamp *lamp, size_t lamps, size_t surfel,
							double *of_suns)
{
	double all = 0.0, passing = 0.0, suns = 0.0;
	for (size_t l = 0; l < lamps; l++) {
		bool passes;
		double light = lamp_at(w, &lamp[l], surfel, &passes);
		all += light;
		passing += passes ? light : 0.0;
		suns += passes && lamp[l].push.type == GW_PUSH_SUN ? light : 0.0;
	}
	*of_suns = all > 0.0 ? suns / all : 0.0;
	return all > 0.0 ? passing / all : 0.0;
}

static double radiance_of_lamps(const work *w, size_t surfel)
{
	const gw_gap_error_task *t = w->task;
	double light = gw_luminance(t->direct + 4 * surfel);
	return reciprocal_pi * gw_luminance(t->surfels->albedo + 3 * surfel) * light;
}

/* Spots of sun are small, so that it is looked at lit points alone. Returns the share of the light
 * of all lamps that passes gaps. */
static double add_passing(work *w, const gw_lamp *lamp, size_t lamps)
{
	size_t count = w->task->surfels->count, lit = 0, number = 0, looked = 0;
	double sum = 0.0, through = 0.0, of_suns;
	for (size_t i = 0; i < count; i++)
		lit += radiance_of_lamps(w, i) > 0.0;
	size_t step = lit / LAMP_POINTS + 1;
	for (size_t i = 0; i < count; i++) {
		double found = radiance_of_lamps(w, i);
		if (!(found > 0.0) || number++ % step > 0)
			continue;
		sum += found;
		through += found * share_passing(w, lamp, lamps, i, &of_suns);
		w->passing += found * of_suns;
		w->passing_square += found * of_suns * found * of_suns;
		looked++;
	}
	double each = looked > 0 ? (double)lit / (double)looked / (double)count : 0.0;
	w->passing *= each;
	w->passing_square *= each;
	return sum > 0.0 ? through / sum : 0.0;
}

/* What a ray of a lamp says about its light: how much of it should have lit something. Where only
 * one size of the discs leaves a hole, half of it. */
static double loss_of(const work *w, const gw_check_discs *discs, const gw_way *way)
{
	const gw_check_ray ray = { .origin = way->from,
							   .direction = way->direction,
							   .facing = way->direction,
							   .t_max = FAR_METRES };
	gw_check_hit hit = gw_check_discs_trace(discs, &ray, GW_THROUGH_LEAST);
	if (hit.passed_back_face)
		return 1.0;
	if (hit.large != GW_NONE && hit.small != GW_NONE)
		return 0.0;
	double leaves = hit.large == GW_NONE && hit.small == GW_NONE ? 1.0 : 0.5;
	if (w->guessed && w->sky_shines)
		return 0.0;
	if (gw_scanned_space_is_gap(w->task->space, way))
		return w->guessed ? M_SQRT1_2 * leaves : leaves;
	return gw_scanned_space_is_pane(w->task->space, way) ? M_SQRT1_2 * leaves : 0.0;
}

/* Adds what a lamp sends, and what of it is lost where nothing was scanned. */
static void follow_lamp(const work *w, const gw_check_discs *discs, const gw_lamp *lamp,
						double *sent, double *lost)
{
	const gw_octree *o = w->task->on.octree;
	const float *low = o->cube_minimum;
	gw_vec3 at = gw_xyz(&lamp->push.position.x);
	gw_way way = { .length = INFINITY };
	way.from = gw_plus((gw_vec3){ low[0], low[1], low[2] }, gw_times(at, o->leaf_size));
	for (uint32_t k = 0; k < LAMP_RAYS; k++) {
		float z = 1.0f - (2.0f * (float)k + 1.0f) / LAMP_RAYS, r = sqrtf(1.0f - z * z), distance;
		way.direction =
			(gw_vec3){ r * cosf(GOLDEN_ANGLE * (float)k), r * sinf(GOLDEN_ANGLE * (float)k), z };
		const gw_check_place place = { gw_plus(at, way.direction), gw_times(way.direction, -1.0f) };
		gw_vec3 towards;
		double light = gw_check_lamp_light(lamp, &place, &towards, &distance);
		*sent += light;
		*lost += light > 0.0 ? light * loss_of(w, discs, &way) : 0.0;
	}
}

/* No point tells of light that went where none is. So it is looked where lamps send theirs. */
static gw_status follow_lamps(work *w, gw_error *error)
{
	const gw_gap_error_task *t = w->task;
	double sent = 0.0, lost = 0.0;
	if (!(w->of_lamps > 0.0) || !t->direct)
		return GW_OK;
	GW_TRY(gw_check_discs_open(t->on.passes->gpu, t->on.octree, t->surfels, t->discs, error));
	for (size_t i = 0; i < t->light_count; i++) {
		if (!gw_light_shines(&t->lights[i]))
			continue;
		gw_lamp lamp = gw_lamp_of(&t->lights[i], t->on.octree, t->surfels, t->options);
		if (lamp.push.type != GW_PUSH_SUN)
			follow_lamp(w, t->discs, &lamp, &sent, &lost);
	}
	w->lost = sent > 0.0 ? fmin(lost / sent, (double)SHARE_MOST) : 0.0;
	return GW_OK;
}

static gw_status look_at_lamps(work *w, gw_gap_report *report, gw_error *error)
{
	const gw_gap_error_task *t = w->task;
	size_t lamps = 0;
	if (!t->direct || t->options->gaps != GW_GAPS_OPEN)
		return GW_OK;
	gw_lamp *lamp = gw_allocate_array(t->light_count, sizeof *lamp);
	if (!lamp)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu lights", t->light_count);
	for (size_t i = 0; i < t->light_count; i++)
		if (gw_light_shines(&t->lights[i]))
			lamp[lamps++] = gw_lamp_of(&t->lights[i], t->on.octree, t->surfels, t->options);
	report->lamps = add_passing(w, lamp, lamps);
	free(lamp);
	return GW_OK;
}

/* Of black gaps, and of bright ones, no lamp shines through. */
static void take_lamps_off(const work *w, gw_gap_report *report)
{
	double lost = w->radiance > 0.0 ? reflections(w) * report->lamps * w->shone / w->radiance : 0.0;
	report->black = fmax(report->black - lost, 0.0);
	report->bright = fmax(report->bright - lost, 0.0);
}

gw_status gw_gap_error(const gw_gap_error_task *task, gw_gap_report *report,
					   gw_error_estimate *estimate, gw_error *error)
{
	size_t count = task->on.records->count;
	report->black = report->bright = 1.0;
	report->share = report->sky = report->lamps = 0.0;
	double *room = gw_allocate_zeros(count, 4 * sizeof *room);
	if (!room)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu records", count);
	work w = { .task = task,
			   .mean = room,
			   .square = room + count,
			   .plain = room + 2 * count,
			   .sent = room + 3 * count,
			   .guessed = task->space->scanners == 0 };
	for (size_t r = 0; r < count; r++)
		w.sky_shines = w.sky_shines || task->gap[r].all > 0.0f;
	gw_status status = gw_records_light(task->on.passes->gpu, task->on.records, w.sent, error);
	if (status == GW_OK) {
		weigh(&w);
		status = follow_lamps(&w, error);
	}
	if (status == GW_OK)
		status = look_at_lamps(&w, report, error);
	if (status == GW_OK && w.radiance > 0.0)
		sum_records(&w, report, estimate);
	if (status == GW_OK)
		take_lamps_off(&w, report);
	estimate->relative_rms = hypot(estimate->relative_rms, estimate->gaps);
	free(room);
	return status;
}

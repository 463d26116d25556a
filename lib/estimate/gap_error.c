/*
 * gap_error.c - see gap_error.h.
 */
#include "estimate/gap_error.h"

#include "base/luminance.h"
#include "base/memory.h"
#include "cloud/frame.h"
#include "estimate/check_light.h"
#include "estimate/emitted_ways.h"
#include "light/direct_light.h"

#include <math.h>
#include <stdlib.h>

/* Lit points whose ways to the lamps are looked at. */
#define LAMP_POINTS 512u

/* Directions in which it is looked where a lamp's light goes. */
#define LAMP_RAYS 2048u

/* Rays from all that emits: a power of two. */
#define EMITTER_RAYS 4096u

/* Records from which it is looked where emitted light is missing: of more, every so many-th. The
 * means that they are asked for are known to a sixtieth of how far they differ. */
#define EMITTED_RECORDS 4096u

/* So many radii around a point lies the surface that its rays leave. */
#define OWN_RADII 2.0f

#define GOLDEN_ANGLE 2.39996323f
#define FAR_METRES 1e30f

/* Of a record's directions, so many may be gaps; the others say what surrounds them. */
#define SHARE_MOST 0.9

typedef struct work {
	const gw_gap_error_task *task;
	double *mean, *square;    /* one a record: what it counts for in the mean over the points */
	double *plain;            /* likewise, whatever the points reflect */
	double *surface;          /* likewise, as square metres */
	double *sent;             /* irradiance */
	double radiance;          /* mean of the points */
	double reflected;         /* mean reflectance */
	double of_lamps;          /* part of radiance: lamps' light that was reflected before */
	double of_direct, of_sky; /* sums of the points' irradiance before any reflection */
	double of_all;            /* the mean of both together */
	double of_emitters;       /* share of what emits in that */
	double shone;            /* part of radiance: of lamps and suns straight, not reflected again */
	double contrast;         /* of reflected light: root mean square over mean */
	double lost;             /* of the light that lamps send: is as likely to be missing */
	double lost_of_emitters; /* of the light that is emitted, likewise */
	double glow;             /* of gaps in what emits, over the latter's */
	double darkness;         /* what surface that is missing would send of that */
	double *straight;        /* irradiance of the records from what emits */
	gw_emitted_ways *emitted; /* of that; NULL: nothing emits */
	size_t step;              /* every so many-th record has been looked at for that */
	bool guessed;             /* gaps are holes, which may as well be windows */
	bool sky_shines;          /* through some of them, so that one of them is */
	/* Light of suns through gaps, reflected once, and its square: means over the points. */
	double passing, passing_square;
} work;

static const double reciprocal_pi = 0.31830988618379067;

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
		w->surface[r] += (double)t->surfels->area[i] * weight;
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
		dark += !gw_surfel_emits(s, i) && (!asked || asked[i]);
	for (size_t i = 0; i < s->count; i++) {
		if ((asked && !asked[i]) || (dark > 0 && gw_surfel_emits(s, i)))
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
	w->of_all = share * (w->of_direct + w->of_sky);
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

static double reflections(const work *w)
{
	return gw_check_reflections(w->reflected, w->task->limit);
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

/* What a record would get more of emitted light were surface where there are gaps: what these emit,
 * as that comes to it which is emitted around them, without what comes through them. */
static double emitted_beyond(const work *w, size_t record)
{
	const gw_emitted_ways *e = &w->emitted[record];
	double chance = w->sky_shines ? chance_of_none(w->task->space->holes) : 0.5;
	double straight = reciprocal_pi * w->straight[record];
	return straight * (sqrt(chance) * (w->glow - (double)e->gap) - (double)e->solid);
}

/* What it would get more of light that is lost now, and which part of that squared is chance: a ray
 * or none. */
static double darkness_at(const work *w, size_t record, double *chance)
{
	const gw_emitted_ways *e = &w->emitted[record];
	*chance = w->darkness * w->darkness * (double)e->squares;
	return w->darkness * (double)e->lost;
}

/* Share of a sum over records that those have which are looked at. */
static double share_looked_at(const work *w, const double *of_record)
{
	double all = 0.0, looked = 0.0;
	for (size_t r = 0; r < w->task->on.records->count; r++) {
		all += of_record[r];
		looked += r % w->step == 0 ? of_record[r] : 0.0;
	}
	return looked > 0.0 ? looked / all : 1.0;
}

static void sum_records(const work *w, gw_gap_report *report, gw_error_estimate *estimate)
{
	double sky = 0.0, through = 0.0, black = 0.0, bright = 0.0, mean = 0.0, square = 0.0;
	double means = share_looked_at(w, w->mean), squares = share_looked_at(w, w->square);
	for (size_t r = 0; r < w->task->on.records->count; r++) {
		const gw_gap_sight *g = &w->task->gap[r];
		double share = fmin((double)g->share, SHARE_MOST), rest = beside_gaps(w, r);
		double full = rest / (1.0 - share), now = reciprocal_pi * w->sent[r];
		/* Closed as they are, gaps are known no better than to half of what closes them. */
		double off = fmax(fabs(full - now), 0.5 * (full - rest));
		if (w->guessed && w->task->options->gaps == GW_GAPS_OPEN)
			off = w->sky_shines ? 0.0 : M_SQRT1_2 * (1.0 - w->of_emitters) * (full - rest);
		/* Panes are black now. */
		off += M_SQRT1_2 * full * fmin((double)g->pane, SHARE_MOST);
		off = full < now ? -off : off;
		double chance = 0.0;
		if (w->emitted)
			off += emitted_beyond(w, r) + darkness_at(w, r, &chance);
		report->share += w->plain[r] * (double)g->share;
		sky += w->mean[r] * (double)g->all;
		through += w->mean[r] * gw_luminance(g->sky);
		black += w->mean[r] * (rest - now);
		bright += w->mean[r] * (full - now + (double)g->glow);
		if (r % w->step > 0)
			continue;
		mean += w->mean[r] / means * off;
		square += w->square[r] / squares * (off * off - chance);
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

/* Whether what is solid lies on the way to what it meets. */
static bool meets_solid(const work *w, const gw_way *way, const gw_check_hit *hit)
{
	gw_way until = *way;
	if (hit->small != GW_NONE) {
		const float *at = w->task->surfels->position + 3 * (size_t)hit->small;
		until.length = gw_dot(gw_minus(gw_xyz(at), way->from), way->direction);
	}
	return gw_scanned_space_is_solid(w->task->space, &until, NULL);
}

/* What a ray of a lamp says about its light: how much of it should have lit something. Where only
 * one size of the discs leaves a hole, half of it. */
static double loss_of(const work *w, const gw_check_ray *ray)
{
	const gw_way leaving = { ray->origin, ray->direction, INFINITY }, *way = &leaving;
	gw_check_hit hit = gw_check_discs_trace(w->task->discs, ray, GW_THROUGH_LEAST);
	if (hit.passed_back_face || meets_solid(w, way, &hit))
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
static void follow_lamp(const work *w, const gw_lamp *lamp, double *sent, double *lost)
{
	const gw_octree *o = w->task->on.octree;
	const float *low = o->cube_minimum;
	gw_vec3 at = gw_xyz(&lamp->push.position.x);
	gw_check_ray ray = { .t_max = FAR_METRES };
	ray.origin = gw_plus((gw_vec3){ low[0], low[1], low[2] }, gw_times(at, o->leaf_size));
	for (uint32_t k = 0; k < LAMP_RAYS; k++) {
		float z = 1.0f - (2.0f * (float)k + 1.0f) / LAMP_RAYS, r = sqrtf(1.0f - z * z), distance;
		ray.direction = ray.facing =
			(gw_vec3){ r * cosf(GOLDEN_ANGLE * (float)k), r * sinf(GOLDEN_ANGLE * (float)k), z };
		const gw_check_place place = { gw_plus(at, ray.direction), gw_times(ray.direction, -1.0f) };
		gw_vec3 towards;
		double light = gw_check_lamp_light(lamp, &place, &towards, &distance);
		*sent += light;
		*lost += light > 0.0 ? light * loss_of(w, &ray) : 0.0;
	}
}

/* No point tells of light that went where none is. So it is looked where lamps send theirs. */
static gw_status follow_lamps(work *w, gw_error *error)
{
	const gw_gap_error_task *t = w->task;
	double sent = 0.0, lost = 0.0;
	if (!(w->of_lamps > 0.0) || !t->direct)
		return GW_OK;
	GW_TRY(gw_check_discs_open(t->on.passes, t->on.octree, t->surfels, t->discs, error));
	for (size_t i = 0; i < t->light_count; i++) {
		if (!gw_light_shines(&t->lights[i]))
			continue;
		gw_lamp lamp = gw_lamp_of(&t->lights[i], t->on.octree, t->surfels, t->options);
		if (lamp.push.type != GW_PUSH_SUN)
			follow_lamp(w, &lamp, &sent, &lost);
	}
	w->lost = sent > 0.0 ? fmin(lost / sent, (double)SHARE_MOST) : 0.0;
	return GW_OK;
}

/* One of EMITTER_RAYS rays from points that emit: numbers in the order of the points, and
 * directions as far apart as can be for numbers that follow each other (van der Corput 1935). */
static double loss_from(const work *w, size_t surfel, uint32_t number)
{
	const gw_gap_error_task *t = w->task;
	const gw_surfels *s = t->surfels;
	uint32_t turned = 0;
	for (uint32_t bit = 1; bit < EMITTER_RAYS; bit *= 2)
		turned = 2 * turned + ((number & bit) != 0);
	gw_vec3 at = gw_xyz(s->position + 3 * surfel), normal = gw_xyz(s->normal + 3 * surfel);
	gw_check_ray ray = { .origin = at, .facing = normal, .t_max = FAR_METRES };
	ray.own = fmaxf(OWN_RADII * s->radius[surfel], t->on.octree->leaf_size);
	ray.direction = gw_record_ray((gw_vec3){ 0 }, normal, turned, EMITTER_RAYS, 0);
	return loss_of(w, &ray);
}

/* Emitted light that arrives, and on which ways. */
static gw_status look_along_emitted(work *w, gw_error *error)
{
	const gw_gap_error_task *t = w->task;
	size_t count = t->on.records->count;
	const gw_emitted_ways_task task = { t->on,    t->surfels,          t->space, t->rays,
										t->discs, t->options->threads, w->step };
	float *first = gw_allocate_array(count, 4 * sizeof *first);
	w->emitted = gw_allocate_array(count, sizeof *w->emitted);
	if (!first || !w->emitted) {
		free(first);
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu records", count);
	}
	gw_status status = gw_buffer_download(t->on.passes->gpu, &t->on.records->first, 0, first,
										  16 * (uint64_t)count, error);
	for (size_t r = 0; r < count && status == GW_OK; r++)
		w->straight[r] = fmax(gw_luminance(first + 4 * r) - M_PI * (double)t->gap[r].all, 0.0);
	free(first);
	return status == GW_OK ? gw_emitted_ways_find(&task, w->emitted, error) : status;
}

/*
 * Of emitted light, how much gaps would add and how much of it is lost in them.
 *
 * What is lost would be reflected by the surface that is missing, and be seen by the records whose
 * rays pass there: as much of it in all as is reflected of the rest. What they see of it is the
 * more the fewer they are.
 */
static void find_missing(work *w)
{
	double seen = 0.0, glow = 0.0, straight = 0.0, arrives = 0.0, lost = w->lost_of_emitters;
	for (size_t r = 0; r < w->task->on.records->count; r++) {
		seen += w->surface[r] * (double)w->emitted[r].lost;
		glow += w->surface[r] * (double)w->task->gap[r].glow;
		straight += reciprocal_pi * w->surface[r] * w->straight[r];
		arrives += w->plain[r] * w->straight[r];
	}
	w->of_emitters = arrives > 0.0 ? fmin(arrives / w->of_all, 1.0) : 0.0;
	w->glow = straight > 0.0 ? glow / straight : 0.0;
	seen /= share_looked_at(w, w->surface);
	w->darkness = seen > 0.0 ? w->reflected * straight * lost / (1.0 - lost) / seen : 0.0;
}

/* The same of what emits. */
static gw_status follow_emitters(work *w, gw_error *error)
{
	const gw_gap_error_task *t = w->task;
	const gw_surfels *s = t->surfels;
	double power = 0.0, passed = 0.0, lost = 0.0;
	uint32_t number = 0;
	if (!gw_surfels_emit(s) || !w->guessed)
		return GW_OK;
	GW_TRY(gw_check_discs_open(t->on.passes, t->on.octree, s, t->discs, error));
	for (size_t i = 0; i < s->count; i++)
		power += gw_emitted_power(s, i);
	for (size_t i = 0; i < s->count; i++) {
		passed += gw_emitted_power(s, i);
		for (; number < EMITTER_RAYS && (number + 0.5) * power < passed * EMITTER_RAYS; number++)
			lost += loss_from(w, i, number);
	}
	w->lost_of_emitters = fmin(lost / EMITTER_RAYS, (double)SHARE_MOST);
	w->step = t->on.records->count / EMITTED_RECORDS + 1;
	GW_TRY(look_along_emitted(w, error));
	find_missing(w);
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
	double *room = gw_allocate_zeros(count, 6 * sizeof *room);
	if (!room)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu records", count);
	work w = { .task = task,
			   .mean = room,
			   .square = room + count,
			   .plain = room + 2 * count,
			   .sent = room + 3 * count,
			   .straight = room + 4 * count,
			   .surface = room + 5 * count,
			   .guessed = task->space->scanners == 0,
			   .step = 1 };
	for (size_t r = 0; r < count; r++)
		w.sky_shines = w.sky_shines || task->gap[r].all > 0.0f;
	gw_status status = gw_records_light(task->on.passes->gpu, task->on.records, w.sent, error);
	if (status == GW_OK) {
		weigh(&w);
		status = follow_lamps(&w, error);
	}
	if (status == GW_OK)
		status = follow_emitters(&w, error);
	if (status == GW_OK)
		status = look_at_lamps(&w, report, error);
	if (status == GW_OK && w.radiance > 0.0)
		sum_records(&w, report, estimate);
	if (status == GW_OK)
		take_lamps_off(&w, report);
	estimate->relative_rms = hypot(estimate->relative_rms, estimate->gaps);
	free(w.emitted);
	free(room);
	return status;
}

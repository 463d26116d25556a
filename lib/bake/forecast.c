/*
 * forecast.c - see forecast.h.
 *
 * A pilot runs all stages that gather, with few records. Passes over records take as long a record
 * as they will with many; the rest of a stage (weights of facets, tables of emitters, sums) goes
 * with the octree and takes as long as it will. Noise of a record's rays is the same, and the rest
 * of the error falls as records become more (error_price.h).
 *
 * Where a volume gathers, records only read it, and all of them do; its cells are few or many by
 * what lies in them, so all are lit, with few rays. Light that goes from cell to cell has none to
 * save. Compartments and maps of probes are made once, for the pilot and what follows.
 */
#include "bake/forecast.h"

#include "bake/effect_seconds.h"
#include "bake/error_price.h"
#include "bake/report.h"
#include "bake/result.h"
#include "bake/record_steps.h"
#include "bake/scene_probes.h"
#include "bake/scene_records.h"
#include "bake/options_check.h"
#include "bake/lighting_steps.h"
#include "bake/lighting_error.h"
#include "base/memory.h"
#include "glowworm_host.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Records of the pilot: a share of what the bake will have, and at least so many. */
#define PILOT_SHARE (1.0 / 12.0)
#define PILOT_LEAST 500.0

/* Rays of a cell in the pilot: a share of what it will have, and at least so many. */
#define PILOT_CELL_SHARE (1.0 / 6.0)
#define PILOT_CELL_LEAST 8u

/* The number of records goes with this power of their spacing (error_price.c). */
#define RECORDS_POWER 1.7

/* Points that the pilot solves again. */
#define PILOT_POINTS 100u

/* Errors below this are not told apart: the scatter of a pilot of some hundred places. */
#define SPREAD_LEAST 5e-4

/* Spread of what the octree does to the light, by its few rays: four seeds in a hall. */
#define GEOMETRY_SPREAD 0.25

/* By how much a bake's error of gathered light may exceed its pilot's where points read maps of
 * probes: four seeds in a hall, 1.2 to 1.6 times. */
#define PROBE_SPREAD 0.5

/* What a stage of the pilot took: in all, and of that in passes over records, and in those that go
 * with the rays of a volume's cells. */
typedef struct spent {
	double seconds, of_records, of_cells;
} spent;

/* All that the pilot measures. */
typedef struct pilot {
	gw_lighting *lighting;
	gw_bake_result *plan;
	gw_bake_result *light;               /* NULL, or for the light that it found */
	gw_bake_options asked;               /* of the bake */
	gw_report *report;                   /* scratch */
	double passes_before[GW_PASS_COUNT]; /* seconds of the passes until then */
	uint64_t records;                    /* that the bake will have */
	float spacing;                       /* with which they will be placed, leaf cells */
	double ratio;                        /* of these to the pilot's */
	double cell_ratio;                   /* likewise of the rays of a volume's cells */
	double point_ratio;                  /* likewise of points that are solved again */
	spent place, first, bounce, read_back, estimate;
	uint64_t before, grown; /* bytes on the device; and by how much they will be more, */
	uint64_t more;          /* of which so much by more records than the pilot's */
	uint64_t peak;          /* what the device will hold at its highest */
} pilot;

double gw_pilot_record_seconds(gw_passes *passes)
{
	static const gw_pass_id of_records[] = { GW_PASS_RECORD_RAYS,       GW_PASS_RECORD_EMITTERS,
											 GW_PASS_RECORD_SKY,        GW_PASS_RECORD_PORTALS,
											 GW_PASS_PORTAL_LIGHT,      GW_PASS_RECORD_FIRST,
											 GW_PASS_RECORD_GATHER,     GW_PASS_RECORD_CONES,
											 GW_PASS_RECORD_DIRECTIONS, GW_PASS_RECORD_AGAIN,
											 GW_PASS_RECORD_KEEP };
	const double *of_pass = gw_passes_seconds(passes);
	double seconds = 0.0;
	for (size_t i = 0; i < sizeof of_records / sizeof *of_records; i++)
		seconds += of_pass[of_records[i]];
	return seconds;
}

/* Seconds of passes that go with the rays of a volume's cells, but for those that look for them. */
static double cell_seconds(gw_scene *s)
{
	const double *seconds = gw_passes_seconds(&s->passes);
	double rays = (double)s->volume.rays * s->volume.count, looked = (double)s->volume.looked;
	return seconds[GW_PASS_VOLUME_FILL] +
		   seconds[GW_PASS_VOLUME_RAYS] * rays / fmax(rays + looked, 1.0);
}

static gw_status place(gw_lighting *lighting, gw_error *error)
{
	return gw_scene_place_records(lighting->scene, error);
}

/* Runs a stage and adds what it took. */
static gw_status measure(pilot *p, gw_status (*stage)(gw_lighting *, gw_error *), spent *sum,
						 gw_error *error)
{
	gw_scene *scene = p->lighting->scene;
	/* Both wait for what is under way, of before and of the stage. */
	double before = gw_pilot_record_seconds(&scene->passes), cells_before = cell_seconds(scene);
	double start = gw_seconds();
	GW_TRY(stage(p->lighting, error));
	sum->of_records += gw_pilot_record_seconds(&scene->passes) - before;
	sum->of_cells += cell_seconds(scene) - cells_before;
	sum->seconds += gw_seconds() - start;
	return GW_OK;
}

/* What the bake's own stage will take. */
static double scaled(const pilot *p, const spent *s)
{
	double of_records = fmin(s->of_records, s->seconds);
	double of_cells = fmin(s->of_cells, s->seconds - of_records);
	return s->seconds + (p->ratio - 1.0) * of_records + (p->cell_ratio - 1.0) * of_cells;
}

/* The same of points that are solved again. */
static double scaled_estimate(const pilot *p)
{
	double of_points = fmin(p->estimate.of_records, p->estimate.seconds);
	return p->estimate.seconds + (p->point_ratio - 1.0) * of_points;
}

float gw_pilot_spacing(uint64_t records, float spacing)
{
	double wanted = fmax(PILOT_SHARE * (double)records, PILOT_LEAST);
	if (!(wanted < (double)records))
		return spacing;
	double wider = pow((double)records / wanted, 1.0 / RECORDS_POWER);
	return fminf((float)(fmax((double)spacing, 1.0) * wider), 64.0f);
}

/* Few rays of a volume's cells, of which all records read. */
static void choose_cell_rays(pilot *p)
{
	gw_bake_options *o = &p->lighting->scene->options;
	double few = fmax(PILOT_CELL_SHARE * o->rays, PILOT_CELL_LEAST);
	if (o->method == GW_METHOD_VOLUME && few < (double)o->rays)
		o->rays = (uint32_t)few;
	p->cell_ratio = (double)p->asked.rays / o->rays;
}

/* How many records there will be, and the spacing that leaves few of them. */
static gw_status choose_records(pilot *p, gw_error *error)
{
	gw_scene *s = p->lighting->scene;
	const gw_record_context on = gw_scene_context(s, &s->records);
	const gw_record_wish wish = gw_scene_wish_records(s, &p->asked);
	GW_TRY(gw_records_place(&on, &wish, error));
	p->records = s->records.count;
	p->spacing = s->records.spacing;
	gw_scene_drop_records(s);
	if (gw_method_has_cells(p->asked.method)) {
		choose_cell_rays(p);
	} else {
		s->options.record_spacing = gw_pilot_spacing(p->records, p->spacing);
		s->options.least_records = s->options.most_records = 0;
	}
	uint32_t points = gw_estimate_points(p->asked.estimate_points, (uint32_t)p->records);
	s->options.estimate_points = points < PILOT_POINTS ? points : PILOT_POINTS;
	return GW_OK;
}

uint64_t gw_pilot_record_bytes(const gw_scene *s)
{
	const gw_records *r = &s->records;
	const gw_buffer *const buffer[] = { &r->position,
										&r->normal,
										&r->block_record,
										&r->first,
										&r->indirect,
										&r->gathered,
										&s->rays.facet,
										&s->rays.distance,
										&s->rays.through,
										&s->buffers.hits.facet,
										&s->buffers.hits.distance,
										&s->sampled,
										&s->sampled_moment,
										&r->first_moment,
										&r->indirect_moment };
	uint64_t bytes = 0;
	for (size_t i = 0; i < sizeof buffer / sizeof *buffer; i++)
		bytes += buffer[i]->allocated;
	return bytes;
}

/* The light of the points, for those who want it. */
static gw_status keep_light(const pilot *p, gw_error *error)
{
	if (!p->light)
		return GW_OK;
	GW_TRY(gw_result_collect(p->lighting, p->light, error));
	p->light->report.error = p->report->error;
	p->light->report.record_spacing = p->lighting->scene->options.record_spacing;
	p->light->report.forecast.cell_rays = p->lighting->scene->volume.rays;
	return GW_OK;
}

/* All stages that the pilot has, and the light that they find. */
static gw_status run_stages(pilot *p, gw_error *error)
{
	gw_scene *s = p->lighting->scene;
	GW_TRY(choose_records(p, error));
	GW_TRY(measure(p, place, &p->place, error));
	p->ratio = s->records.count > 0 ? (double)p->records / s->records.count : 1.0;
	GW_TRY(measure(p, gw_lighting_gather_first, &p->first, error));
	GW_TRY(measure(p, gw_lighting_bounce, &p->bounce, error));
	GW_TRY(measure(p, gw_lighting_read_back, &p->read_back, error));
	GW_TRY(gw_result_share_light(p->lighting, p->plan, error));
	uint64_t now = gw_gpu_read_account(s->gpu).bytes;
	p->more = (uint64_t)((p->ratio - 1.0) * (double)gw_pilot_record_bytes(s) +
						 (p->cell_ratio - 1.0) * (double)s->volume.hit.allocated);
	p->grown = now - p->before + p->more;
	if (!p->lighting->plan.error)
		return GW_OK;
	GW_TRY(measure(p, gw_lighting_estimate, &p->estimate, error));
	double points = gw_estimate_points(p->asked.estimate_points, (uint32_t)p->records);
	p->point_ratio = points / fmax(p->report->error.points, 1.0);
	return keep_light(p, error);
}

/* The same; its highest is that of the pilot with the bytes of more records on top, as these stand
 * from the first stage to the last, unless the octree took more before. */
static gw_status run_pilot(pilot *p, gw_error *error)
{
	gw_gpu *gpu = p->lighting->scene->gpu;
	uint64_t earlier = gw_gpu_restart_peak(gpu);
	gw_status status = run_stages(p, error);
	uint64_t later = gw_gpu_read_account(gpu).peak_bytes + p->more;
	gw_gpu_restore_peak(gpu, earlier);
	p->peak = later > earlier ? later : earlier;
	return status;
}

/* ----------------------------------------------------------------------------- what it tells */

/* What gathered light is brought down to where records are few at first; 0: they are not. */
static double quality_of_few(const pilot *p)
{
	const gw_bake_options *o = &p->asked;
	bool few = p->lighting->scene->adds_records && gw_options_few_records(o) &&
			   p->spacing > fmaxf(o->record_spacing, GW_RECORD_SPACING_LEAST);
	return few ? (double)o->gathered_error : 0.0;
}

/* What of gathered light would be wrong with more rays of a volume's cells: if all of it were their
 * noise, and if none were; what it is off on the average stays. Noise of many rays falls with their
 * root, and of how much the cells' size makes the rest the pilot knows nothing.
 *   spread   receives half of what lies between */
static double error_with_cell_rays(const pilot *p, double *spread)
{
	const gw_error_estimate *e = &p->report->error;
	double most = e->gathered, stays = fmin(fabs(e->bias), most);
	double least = sqrt(stays * stays + (most * most - stays * stays) / p->cell_ratio);
	*spread = 0.5 * (most - least);
	return sqrt(most * least);
}

/* What of gathered light would be wrong in the bake. The maps of probes are those of the bake, and
 * points read them as they will: records only light what the maps see, which is right where it is
 * read and where it is checked alike.
 *   spread   receives how much that may be off */
static double error_of_gathered(const pilot *p, double *spread)
{
	const gw_error_estimate *e = &p->report->error;
	if (p->cell_ratio > 1.0)
		return error_with_cell_rays(p, spread);
	if (p->asked.method != GW_METHOD_PROBES)
		return gw_error_with_records(e, p->ratio, spread);
	*spread = PROBE_SPREAD * e->gathered;
	return e->gathered;
}

static void foretell_error(const pilot *p, gw_forecast *f)
{
	const gw_error_estimate *e = &p->report->error;
	double power, enough = quality_of_few(p), rest = error_of_gathered(p, &power);
	if (enough > 0.0 && rest > enough && !gw_options_refine(&p->asked))
		rest = enough;
	double others = e->relative_rms * e->relative_rms - e->gathered * e->gathered;
	f->error = sqrt(rest * rest + fmax(others, 0.0));
	if (!(f->error > 0.0))
		return;
	double own = e->spread * rest / fmax(e->gathered, 1e-30);
	f->spread = hypot(hypot(own, power + SPREAD_LEAST), GEOMETRY_SPREAD * e->geometry);
}

/* Seconds with which a bake that refines reaches its error, or its time is up. */
static double refined_seconds(const pilot *p, const gw_forecast *f, double round)
{
	const gw_bake_options *o = &p->asked;
	double seconds = f->seconds, limit = (double)o->time_limit, spread;
	double rays = (double)p->records * o->rays;
	gw_price_task task = { .error = p->report->error,
						   .rays = o->rays,
						   .records = (double)p->records,
						   .spacing = (double)p->spacing,
						   .fixed_seconds = f->seconds - round,
						   .round_seconds = round - p->ratio * p->place.of_records,
						   .ray_seconds = p->ratio * p->place.of_records / fmax(rays, 1.0) };
	task.error.gathered = gw_error_with_records(&p->report->error, p->ratio, &spread);
	double target = (double)o->max_error, enough = quality_of_few(p);
	bool more = target > 0.0 && f->error > target;
	if (!gw_options_refine(o) && enough > 0.0) {
		more = task.error.gathered > enough;
		target = hypot(enough, gw_error_floor(&task.error));
	}
	if (more)
		seconds = fmax(seconds, gw_price_of(&task, target).seconds);
	return limit > 0.0 && (seconds > limit || !(o->max_error > 0.0f)) ? fmax(limit, f->seconds)
																	  : seconds;
}

/* Light of the points and columns of records, on the host. */
static uint64_t host_bytes(const pilot *p)
{
	const gw_scene *s = p->lighting->scene;
	const gw_bake_options *o = &p->asked;
	uint64_t surfels = s->surfels.count, points = s->surfels.point_count;
	uint64_t weights = s->read_back.first ? s->read_back.first[surfels] : 0;
	uint64_t result = 16 * sizeof(float); /* radiance, two irradiances, normal, albedo, RoI */
	result += sizeof(float) * ((o->ambient_occlusion ? 1u : 0u) + (o->unknown ? 1u : 0u) +
							   (o->errors ? 1u : 0u) + (o->bent_normals ? 3u : 0u));
	if (o->lamps)
		result += 3 * sizeof(float) * (p->lighting->light_count + 1);
	uint64_t shared = gw_gpu_shares_memory(s->gpu) ? p->grown : 0;
	return shared + 3 * 4 * sizeof(float) * surfels + 8 * weights + result * points;
}

static void foretell(const pilot *p, double done, gw_forecast *f)
{
	const gw_scene *s = p->lighting->scene;
	double light = scaled(p, &p->first) + scaled(p, &p->bounce) + scaled(p, &p->read_back);
	double round = scaled(p, &p->place) + light + scaled_estimate(p);
	*f = (gw_forecast){ .places = s->records.count,
						.cell_rays = s->volume.rays,
						.records = p->records,
						.record_spacing = p->spacing,
						.seconds = done + round,
						.done_seconds = done,
						.device_bytes = p->peak,
						.host_bytes = host_bytes(p),
						.bounces = p->report->bounce_count,
						.remaining = p->report->remaining,
						.escaped = (double)s->portals.escaped };
	foretell_error(p, f);
	if (p->asked.lamps)
		f->seconds += light * (double)p->lighting->light_count;
	f->seconds = refined_seconds(p, f, round);
}

/* Of what the plan calls for, with the stages before as they were. */
static void foretell_prices(const pilot *p)
{
	gw_report *report = &p->plan->report;
	gw_stage_seconds price = { .emitters = 0.0 };
	gw_stage_seconds_read(&p->lighting->scene->passes, p->passes_before, &price);
	price.emitters *= p->ratio;
	price.sky *= p->ratio;
	price.portals *= p->ratio;
	price.direct_light = gw_report_seconds(report, "direct light");
	price.gaps = gw_report_seconds(report, "gaps");
	price.octree = gw_report_seconds(report, "octree");
	price.gather = scaled(p, &p->place) + scaled(p, &p->first) + scaled(p, &p->read_back);
	price.bounces = scaled(p, &p->bounce);
	price.estimate = scaled_estimate(p);
	if (p->asked.lamps)
		price.columns = (scaled(p, &p->first) + price.bounces + scaled(p, &p->read_back)) *
						(double)p->lighting->light_count;
	gw_effect_seconds_set(&p->lighting->plan, &price, report);
}

/* What the octree has become, and whether light is kept in bricks of its tiles. */
static void describe_octree(const pilot *p, gw_report *report)
{
	const gw_octree *octree = &p->lighting->scene->octree;
	bool cones = p->lighting->plan.records && p->asked.method == GW_METHOD_CONES;
	if (octree->leaf_count == 0)
		return;
	for (uint32_t i = 0; i < report->effect_count; i++) {
		gw_effect *e = &report->effect[i];
		size_t length = strlen(e->reason);
		if (strcmp(e->name, gw_effect_name(GW_EFFECT_OCTREE)) == 0)
			snprintf(e->reason + length, sizeof e->reason - length, "; %u leaves at depth %u",
					 octree->leaf_count, octree->depth);
	}
	if (cones)
		gw_report_effect(report, "bricks", "filled anew with each reflection",
						 "cones look light up in %u of them, %.3g MB with their coarser levels",
						 octree->tile_count, 1e-6 * (double)report->brick_bytes);
	else
		gw_report_effect(report, "bricks", NULL, "nothing looks light up in coarser levels");
}

/* What rays have found out beside what was known without them. */
static void add_reasons(const pilot *p, const gw_forecast *f, gw_report *report)
{
	const gw_plan *plan = &p->lighting->plan;
	for (uint32_t i = 0; i < p->report->effect_count; i++) { /* portals */
		const gw_effect *e = &p->report->effect[i];
		gw_report_effect(report, e->name, e->called_for ? e->method : NULL, "%s", e->reason);
	}
	if (plan->sky && plan->portals)
		gw_report_effect(report, gw_effect_name(GW_EFFECT_SKY),
						 plan->map ? "sampled, and seen by rays" : "seen by rays",
						 "%.3g %% of the rays of %u places leave the scene", 100.0 * f->escaped,
						 f->places);
	if (plan->bounces)
		gw_report_effect(report, gw_effect_name(GW_EFFECT_BOUNCES), gw_method_name(p->asked.method),
						 "%u reflections, the next would add at most %.2g %%", f->bounces,
						 100.0 * f->remaining);
}

/* The bake begins with what it would have begun with. */
static void put_back(pilot *p)
{
	gw_scene *s = p->lighting->scene;
	gw_lighting_drop_gathered(p->lighting);
	gw_lighting_drop_map(p->lighting);
	gw_scene_drop_records(s);
	s->options = p->asked;
	(void)gw_passes_seconds(&s->passes); /* what is under way counts no longer */
	memcpy(s->passes.device_seconds, p->passes_before, sizeof p->passes_before);
}

/* Where lamps alone shine, nothing is gathered; what is wrong is told by what they lit. */
static gw_status foretell_lamps(pilot *p, double done, gw_forecast *f, gw_error *error)
{
	const gw_scene *s = p->lighting->scene;
	if (p->lighting->plan.error)
		GW_TRY(measure(p, gw_lighting_estimate, &p->estimate, error));
	GW_TRY(gw_result_share_light(p->lighting, p->plan, error));
	GW_TRY(keep_light(p, error));
	*f = (gw_forecast){ .seconds = done + p->estimate.seconds,
						.done_seconds = done,
						.device_bytes = gw_gpu_read_account(s->gpu).peak_bytes,
						.host_bytes = host_bytes(p),
						.error = p->report->error.relative_rms,
						.spread = p->report->error.spread };
	return GW_OK;
}

/* What the bake needs as well, and then finds made. done: grows by the seconds that it took. */
static gw_status make_what_stays(gw_lighting *lighting, double *done, gw_error *error)
{
	gw_scene *s = lighting->scene;
	double start = gw_seconds();
	if (lighting->plan.records)
		GW_TRY(gw_scene_part_facets(s, error));
	if (lighting->plan.records && s->options.method == GW_METHOD_PROBES)
		GW_TRY(gw_scene_make_maps(s, error));
	*done += gw_seconds() - start;
	return GW_OK;
}

gw_status gw_forecast_make(gw_lighting *lighting, double done, gw_bake_result *plan,
						   gw_bake_result *light, gw_error *error)
{
	gw_scene *s = lighting->scene;
	gw_report *report = s->report;
	gw_forecast *forecast = &report->forecast;
	GW_TRY(make_what_stays(lighting, &done, error));
	double start = gw_seconds();
	pilot p = { .lighting = lighting,
				.plan = plan,
				.light = light,
				.asked = s->options,
				.report = gw_allocate_zeros(1, sizeof *p.report),
				.ratio = 1.0,
				.cell_ratio = 1.0,
				.point_ratio = 1.0,
				.before = gw_gpu_read_account(s->gpu).bytes };
	if (!p.report)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a report");
	memcpy(p.passes_before, gw_passes_seconds(&s->passes), sizeof p.passes_before);
	s->report = p.report;
	gw_status status =
		lighting->plan.records ? run_pilot(&p, error) : foretell_lamps(&p, done, forecast, error);
	if (status == GW_OK && lighting->plan.records)
		foretell(&p, done, forecast);
	if (status == GW_OK && lighting->plan.records)
		add_reasons(&p, forecast, report);
	if (status == GW_OK) {
		describe_octree(&p, report);
		foretell_prices(&p);
	}
	s->report = report;
	put_back(&p);
	forecast->own_seconds = gw_seconds() - start;
	free(p.report->bounce);
	free(p.report);
	return status;
}

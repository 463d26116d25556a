/*
 * bake.c - the data's way from points to lit points, see bake.h. Its steps are in scene.h,
 * lighting.h and result.h; here is their order, and what is done again to refine.
 */
#include "bake/bake.h"

#include "glowworm_host.h"
#include "light/direct_light.h"
#include "octree/compartments.h"
#include "bake/bake_memory.h"
#include "bake/effect_seconds.h"
#include "bake/error_price.h"
#include "bake/forecast.h"
#include "bake/half_forecast.h"
#include "bake/half_sample.h"
#include "bake/lighting_error.h"
#include "bake/lighting_steps.h"
#include "bake/options_check.h"
#include "base/memory.h"
#include "bake/record_fields.h"
#include "bake/record_steps.h"
#include "bake/refine.h"
#include "bake/region.h"
#include "bake/report.h"
#include "bake/result.h"
#include "bake/scaled_scene.h"
#include "bake/scene_records.h"
#include "bake/transport.h"
#include "bake/unlit_space.h"
#include "bake/voxels.h"
#include "bake/volume_light.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Records that would become less than so many times as many stand as close as they may. */
#define GROWTH_LEAST 1.02

/* Of the points that are solved again before a target counts as reached: how many times as many,
 * and what sets their draw apart. */
#define CONFIRM_POINTS 3u
#define CONFIRM_SEED 0x7feb352du

/* Two errors are the same if they differ by no more than this share: rounding of other drivers, and
 * of the same lamps with another power. */
#define SAME_ERROR 1e-4

/* All that one bake holds. */
typedef struct bake {
	const gw_points *points;
	gw_bake_result *result;
	gw_report *report;
	double start;        /* of the call */
	double round_start;  /* of the round under way */
	double octree_start; /* of the octree in use, and what it and the direct light took */
	double octree_seconds;
	bool refining; /* the first round is over */
	bool planning; /* nothing comes after the forecast */
	bool trial;    /* as in gw_bake_manner, as is: */
	gw_memory_ceiling *ceiling;

	gw_scene scene;
	gw_lighting light;
	uint32_t first_round; /* the one that placed the first of them */
	double whole_seconds; /* that a round would take that does all that this one built on */
	bool crowded;         /* no more can be */
	float least_spacing;  /* of a bake that has no target, leaf cells */
} bake;

/* Begins a stage and books it. All rounds after the first are booked as one. */
static gw_status stage(bake *b, const char *name, double done, double share, gw_error *error)
{
	if (!b->refining)
		gw_report_stage(b->report, b->scene.gpu, name);
	return gw_scene_begin(&b->scene, name, done, share, error);
}

static bool keeps_transport(const bake *b)
{
	return gw_transport_is_written(b->scene.options.transport);
}

/* -------------------------------------------------------------------------------------- steps */

static gw_status open_device(bake *b, gw_error *error)
{
	return gw_scene_open_device(&b->scene, error);
}

static gw_status load_transport(bake *b, gw_error *error)
{
	return gw_transport_load(&b->scene, b->points, b->scene.options.transport, error);
}

static gw_status save_transport(bake *b, gw_error *error)
{
	const gw_transport_identity of = gw_transport_identify(b->points);
	return gw_transport_save(&b->light, &of, b->scene.options.transport, error);
}

static gw_status make_surfels(bake *b, gw_error *error)
{
	const gw_scene_description from = { b->points, b->light.lights, b->light.light_count };
	GW_TRY(gw_scene_make_surfels(&b->scene, &from, error));
	GW_TRY(gw_region_ask(&b->scene, error));
	if (b->scene.known)
		GW_TRY(gw_region_set_width(&b->scene, error));
	return gw_unlit_space_find(&b->scene, &from, error);
}

static gw_status make_plan(bake *b, gw_error *error)
{
	(void)error;
	gw_lighting_plan(&b->light);
	return GW_OK;
}

static gw_status find_gaps(bake *b, gw_error *error)
{
	return gw_scene_find_space(&b->scene, b->points, error);
}

/* Of a region it is known only by its records what lamps have to shine on. */
static bool waits_for_records(const bake *b)
{
	return b->scene.region.asked && b->light.plan.records;
}

/* Cuts and bends of discs go when the octree is made of them, unless another one may follow. Lamps
 * light large discs by them, each lamp again where columns of lamps are asked for and all where
 * records of a region may be placed anew, and where lamps shine the estimate bends discs as well.
 * lit: by the lamps. */
static void drop_shapes(bake *b, bool lit)
{
	gw_scene *scene = &b->scene;
	gw_surfels *s = &scene->surfels;
	bool again = gw_options_refine(&scene->options) || keeps_transport(b) ||
				 gw_compartments_are_coarser(&scene->octree, s);
	bool relit = scene->options.lamps || waits_for_records(b);
	bool large = b->light.plan.lamps && scene->octree.tree_discs > 0;
	if (again || (large && (!lit || relit)))
		return;
	gw_free_unless_lent(s->clip, s->lent, s->lent_bytes);
	s->clip = NULL;
	if (b->light.plan.lamps)
		return;
	gw_free_unless_lent(s->bend, s->lent, s->lent_bytes);
	s->bend = NULL;
}

static gw_memory_facts memory_facts(const bake *b)
{
	const gw_scene_description scene = { b->points, b->light.lights, b->light.light_count };
	const gw_bake_options *options = &b->scene.options;
	gw_memory_facts facts = gw_bake_memory_guess(&scene, options, options->surface_points > 0);
	facts.surfels = b->scene.surfels.count;
	facts.facets = b->scene.octree.facet_count;
	return facts;
}

/* Whether memory holds what will be made with the octree. */
static gw_status check_memory(bake *b, gw_error *error)
{
	gw_memory_ceiling *c = b->ceiling;
	if (!c || c->foretold > 0)
		return GW_OK;
	const gw_memory_facts facts = memory_facts(b);
	c->foretold = gw_bake_memory(&facts);
	uint64_t fit = gw_bake_memory_points(&facts, c->bytes, 0.0);
	if (c->foretold <= c->bytes || fit < c->least)
		return GW_OK;
	c->fit = fit;
	return gw_fail(error, GW_ERROR_MEMORY,
				   "the light of %zu points would take %" PRIu64 " MB of memory", b->points->count,
				   c->foretold / 1000000);
}

static gw_status build_octree(bake *b, gw_error *error)
{
	b->octree_start = gw_seconds();
	if (!b->light.plan.octree)
		return gw_scene_do_without_octree(&b->scene, error);
	GW_TRY(gw_scene_build_octree(&b->scene, error));
	drop_shapes(b, false);
	return check_memory(b, error);
}

static gw_status light_directly(bake *b, gw_error *error)
{
	GW_TRY(gw_lighting_direct(&b->light, error));
	drop_shapes(b, true);
	b->octree_seconds = gw_seconds() - b->octree_start;
	return GW_OK;
}

/* A gw_half_bake for which there is no room beside what is there. */
static gw_status refuse_half(const gw_scene_description *scene, const gw_bake_options *options,
							 gw_gpu **device, const gw_bake_callbacks *callbacks,
							 gw_bake_result **result, gw_error *error)
{
	(void)options;
	(void)device;
	(void)callbacks;
	*result = NULL;
	return gw_fail(error, GW_ERROR_MEMORY,
				   "no memory to bake half of %zu points beside all of them", scene->points->count);
}

static bool has_room_for_half(const bake *b)
{
	const gw_memory_ceiling *c = b->ceiling;
	const gw_memory_facts facts = memory_facts(b);
	return !c || c->foretold == 0 || c->foretold + gw_bake_memory_of_half(&facts) <= c->bytes;
}

static gw_status foretell_halves(bake *b, const gw_bake_result *light, gw_error *error)
{
	const gw_scene_description scene = { b->points, b->light.lights, b->light.light_count };
	gw_half_bake *half = has_room_for_half(b) ? gw_bake_on_device : refuse_half;
	const gw_half_forecast_task task = { half, &scene, &b->scene.options, &b->scene.callbacks,
										 b->scene.gpu };
	return gw_half_forecast_add(&task, light, b->report, error);
}

static gw_status foretell_all(bake *b, double done, gw_bake_result *light, gw_error *error)
{
	GW_TRY(gw_forecast_make(&b->light, done, b->result, light, error));
	return light ? foretell_halves(b, light, error) : GW_OK;
}

/* Tells what is going to be done, and what it will take. */
static gw_status foretell(bake *b, gw_error *error)
{
	gw_report *r = b->report;
	gw_bake_result *light = NULL;
	double done = 0.0;
	for (uint32_t i = 0; i + 1 < r->stage_count; i++)
		done += r->stage[i].seconds;
	bool halves = !gw_transport_is_read(b->scene.options.transport) &&
				  gw_half_sample_is_wanted(b->points, &b->scene.options, r);
	if (halves && !(light = gw_allocate_zeros(1, sizeof *light)))
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the light of points");
	gw_status status = foretell_all(b, done, light, error);
	gw_bake_result_destroy(&light);
	GW_TRY(status);
	uint64_t peak = gw_gpu_read_account(b->scene.gpu).peak_bytes; /* the forecast's own too */
	if (!b->planning && r->forecast.device_bytes < peak)
		r->forecast.device_bytes = peak;
	if (b->scene.callbacks.planned)
		b->scene.callbacks.planned(b->scene.callbacks.user, b->result);
	return GW_OK;
}

static gw_status place_records(bake *b, gw_error *error)
{
	b->round_start = gw_seconds();
	if (b->scene.density.facet_spacing)
		return gw_scene_add_records(&b->scene, error);
	return gw_scene_place_records(&b->scene, error);
}

/* Weights of fragments say what facets get of the lamps' light, and what a region depends on. */
static void drop_weights(bake *b)
{
	if (!b->light.plan.lamps && !b->scene.region.asked && !keeps_transport(b))
		gw_buffer_destroy(b->scene.gpu, &b->scene.octree.fragment_weight);
}

static gw_status gather_first(bake *b, gw_error *error)
{
	GW_TRY(gw_lighting_gather_first(&b->light, error));
	drop_weights(b);
	return GW_OK;
}

static gw_status bounce(bake *b, gw_error *error)
{
	return gw_lighting_bounce(&b->light, error);
}

static gw_status read_back(bake *b, gw_error *error)
{
	return gw_lighting_read_back(&b->light, error);
}

static gw_status estimate(bake *b, gw_error *error)
{
	return gw_lighting_estimate(&b->light, error);
}

static gw_status collect_volume(bake *b, gw_error *error)
{
	return gw_volume_light_collect(&b->light, b->result, error);
}

static gw_status collect_voxels(bake *b, gw_error *error)
{
	return gw_result_collect_voxels(&b->light, b->result, error);
}

static gw_status collect_lamps(bake *b, gw_error *error)
{
	return gw_result_collect_lamps(&b->light, b->result, error);
}

static gw_status collect_record_fields(bake *b, gw_error *error)
{
	return gw_record_fields_collect(&b->light, b->result, error);
}

/* Unless columns of lamps follow, nothing is traced and gathered any more. */
static gw_status collect(bake *b, gw_error *error)
{
	if (!b->scene.options.lamps)
		gw_scene_drop_traced(&b->scene);
	return gw_result_collect(&b->light, b->result, error);
}

typedef struct step {
	const char *name;
	double share; /* of the whole, for progress: what was measured on a 1.4 M point cave */
	gw_status (*run)(bake *b, gw_error *error);
	bool (*wanted)(const bake *b);
} step;

static bool always(const bake *b)
{
	(void)b;
	return true;
}

static bool has_transport(const bake *b)
{
	return gw_transport_is_read(b->scene.options.transport);
}

static bool needs_surface(const bake *b)
{
	return !has_transport(b);
}

static bool needs_gaps(const bake *b)
{
	return needs_surface(b) && b->light.plan.gaps;
}

/* Where nothing is traced, lamps still shine on surfels. */
static bool needs_octree(const bake *b)
{
	return needs_surface(b) && (b->light.plan.octree || b->light.plan.lamps);
}

static bool needs_lamplight(const bake *b)
{
	return b->light.plan.lamps && !waits_for_records(b);
}

/* What records are added to depends on the same surface. */
static bool needs_late_lamplight(const bake *b)
{
	return (b->light.plan.lamps || b->scene.known) && waits_for_records(b) &&
		   !b->scene.density.facet_spacing;
}

static bool needs_records(const bake *b)
{
	return b->light.plan.records;
}

/* A transport has records, whatever this light calls for; to these some may be added. */
static bool needs_places(const bake *b)
{
	return (!has_transport(b) || b->refining) &&
		   (b->light.plan.records || keeps_transport(b) || b->scene.options.volume ||
			gw_options_occlusion(&b->scene.options));
}

static bool needs_estimate(const bake *b)
{
	return b->light.plan.error && (b->light.plan.records || b->light.plan.lamps);
}

/* What begins with a transport is short. */
static bool needs_forecast(const bake *b)
{
	return (b->planning || b->scene.callbacks.planned) && !has_transport(b);
}

static bool needs_columns(const bake *b)
{
	return b->scene.options.lamps;
}

static bool needs_record_fields(const bake *b)
{
	return gw_options_record_fields(&b->scene.options);
}

static bool needs_volume(const bake *b)
{
	return b->scene.options.volume;
}

static bool needs_voxels(const bake *b)
{
	return b->scene.options.voxels;
}

static const step steps[] = {
	{ "device", 0.01, open_device, always },
	{ "transport", 0.0, load_transport, has_transport },
	{ "surfels", 0.33, make_surfels, needs_surface },
	{ "plan", 0.0, make_plan, always },
	{ "gaps", 0.0, find_gaps, needs_gaps },
	{ "octree", 0.23, build_octree, needs_octree },
	{ "direct light", 0.1, light_directly, needs_lamplight },
	{ "forecast", 0.0, foretell, needs_forecast },
	{ "records", 0.18, place_records, needs_places },
	{ "direct light", 0.0, light_directly, needs_late_lamplight },
	{ "first gather", 0.04, gather_first, needs_records },
	{ "bounces", 0.05, bounce, needs_records },
	{ "read back", 0.0, read_back, needs_records },
	{ "estimate", 0.02, estimate, needs_estimate },
	{ "save transport", 0.0, save_transport, keeps_transport },
	{ "fields", 0.0, collect_record_fields, needs_record_fields },
	{ "volume", 0.0, collect_volume, needs_volume }, /* before records add up their light */
	{ "voxels", 0.02, collect_voxels, needs_voxels },
	{ "points", 0.02, collect, always },
	{ "lamps", 0.0, collect_lamps, needs_columns },
};

/* Where in steps a round begins: with a new octree, or with new records; and what comes after. */
enum { OCTREE_STEP = 5, RECORDS_STEP = 8, AFTER_ROUND = 14, STEP_COUNT = 20 };

_Static_assert(sizeof steps / sizeof *steps == STEP_COUNT, "all steps run");

/* Runs the steps first to last - 1. */
static gw_status run_steps(bake *b, size_t first, size_t last, gw_error *error)
{
	double done = 0.0;
	for (size_t i = 0; i < last; i++) {
		if (i >= first && steps[i].wanted(b)) {
			GW_TRY(b->refining ? stage(b, steps[i].name, fmax(done, 0.9), 0.0, error)
							   : stage(b, steps[i].name, done, steps[i].share, error));
			GW_TRY(steps[i].run(b, error));
		}
		done += steps[i].share;
	}
	return GW_OK;
}

/* ------------------------------------------------------------------------------------ rounds */

/* What the passes took is told of the last round. */
static void forget_seconds(bake *b)
{
	(void)gw_passes_seconds(&b->scene.passes); /* of what is under way, too */
	memset(b->scene.passes.device_seconds, 0, sizeof b->scene.passes.device_seconds);
}

static void drop_records(bake *b)
{
	gw_lighting_drop_gathered(&b->light);
	gw_scene_drop_records(&b->scene);
	forget_seconds(b);
}

static void drop_octree(bake *b)
{
	gw_lighting_clear(&b->light);
	gw_scene_drop_octree(&b->scene);
	forget_seconds(b);
}

static void book_round(bake *b, double seconds, const char *why)
{
	const gw_bake_options *o = &b->scene.options;
	gw_round *round = &b->report->round[b->report->round_count++];
	*round = (gw_round){ .record_spacing = b->report->record_spacing,
						 .leaf_spacing = gw_scene_leaf_spacing(&b->scene),
						 .rays = o->rays,
						 .light_samples = o->light_samples,
						 .cones = o->cones,
						 .records = b->report->records,
						 .error = b->report->error,
						 .seconds = seconds };
	snprintf(round->why, sizeof round->why, "%s", why);
}

/* Solves again; surfels stay, and the octree when its leaves do. */
static gw_status run_round(bake *b, const gw_bake_options *next, bool keep, const char *why,
						   gw_error *error)
{
	b->scene.callbacks.planned = NULL; /* told already */
	double start = gw_seconds();
	b->scene.options = *next;
	if (keep)
		drop_records(b);
	else
		drop_octree(b);
	b->crowded = false;
	b->first_round = b->report->round_count;
	gw_status status = run_steps(b, keep ? RECORDS_STEP : OCTREE_STEP, AFTER_ROUND, error);
	b->whole_seconds = gw_seconds() - b->round_start;
	if (status == GW_OK)
		book_round(b, gw_seconds() - start, why);
	return status;
}

/* Where finer settings found no memory, the result is that of the settings before; with their
 * octree, where it is still there. */
static gw_status go_back(bake *b, const gw_bake_options *last, bool same_octree, gw_error *error)
{
	b->report->goal = GW_GOAL_MEMORY;
	return run_round(b, last, same_octree, "finer settings found no memory", error);
}

static gw_status refine_settings(bake *b, const gw_bake_options *next, const char *why,
								 gw_error *error)
{
	gw_bake_options last = b->scene.options, asked = *next;
	bool keep = next->leaf_spacing == gw_scene_leaf_spacing(&b->scene);
	if (keep)
		asked.leaf_spacing = last.leaf_spacing;
	gw_status status = run_round(b, &asked, keep, why, error);
	return status == GW_ERROR_MEMORY ? go_back(b, &last, false, error) : status;
}

/* Records of one spacing that are about as many as those that were added up. */
static gw_bake_options as_even(const bake *b)
{
	gw_bake_options even = b->scene.options;
	const gw_report *r = b->report;
	even.leaf_spacing = gw_scene_leaf_spacing(&b->scene);
	even.record_spacing = r->record_spacing;
	if (r->round_count > 1 && b->scene.density.facet_spacing && r->records > 0)
		even.record_spacing *=
			(float)sqrt((double)r->round[b->first_round].records / (double)r->records);
	return even;
}

static gw_status refine_records(bake *b, const gw_density_wish *wish, const char *why,
								gw_error *error)
{
	double start = gw_seconds(), growth;
	uint64_t before = b->report->records;
	gw_bake_options even = as_even(b);
	gw_status status = gw_record_density_refine(&b->light, wish, &growth, error);
	if (status != GW_OK || growth < GROWTH_LEAST) {
		b->crowded = true;
		return status;
	}
	gw_lighting_drop_gathered(&b->light);
	status = run_steps(b, RECORDS_STEP, AFTER_ROUND, error);
	even.leaf_spacing = b->scene.options.leaf_spacing;
	if (status == GW_ERROR_MEMORY)
		return go_back(b, &even, true, error);
	b->whole_seconds += gw_seconds() - start;
	b->crowded = (double)b->report->records < GROWTH_LEAST * (double)before;
	if (status == GW_OK)
		book_round(b, gw_seconds() - start, why);
	return status;
}

static gw_refine_state state_of(const bake *b, const gw_bake_options *even)
{
	double now = gw_seconds(), limit = (double)b->scene.options.time_limit;
	return (gw_refine_state){ .options = even,
							  .error = b->report->error,
							  .round_seconds = b->whole_seconds,
							  .octree_seconds = b->octree_seconds,
							  .crowded = b->crowded,
							  .trial = b->trial,
							  .least_spacing = gw_options_refine(even) ? GW_RECORD_SPACING_LEAST
																	   : b->least_spacing,
							  .round = b->report->round,
							  .round_count = b->report->round_count,
							  .seconds_left = limit > 0.0 ? b->start + limit - now : INFINITY };
}

/* One round more, or the reason why there is none. */
static gw_status refine_once(bake *b, gw_error *error)
{
	static const gw_goal goal[] = { [GW_REFINE_NO_TIME] = GW_GOAL_TIME,
									[GW_REFINE_EXHAUSTED] = GW_GOAL_EXHAUSTED,
									[GW_REFINE_STALLED] = GW_GOAL_STALLED,
									[GW_REFINE_OUT_OF_REACH] = GW_GOAL_OUT_OF_REACH };
	char why[96];
	gw_density_wish wish;
	gw_bake_options even = as_even(b), next;
	gw_refine_state state = state_of(b, &even);
	/* One place is kept for going back. */
	if (b->report->error.points == 0 || b->report->round_count >= GW_REPORT_ROUNDS - 1) {
		b->report->goal = GW_GOAL_EXHAUSTED;
		return GW_OK;
	}
	gw_refine_answer answer = gw_refine_records(&state, &wish, why);
	if (answer == GW_REFINE_ROUND)
		return refine_records(b, &wish, why, error);
	if (answer == GW_REFINE_EXHAUSTED)
		answer = gw_refine_next(&state, &next, why);
	if (answer == GW_REFINE_ROUND)
		return refine_settings(b, &next, why, error);
	b->report->goal = goal[answer];
	return GW_OK;
}

/*
 * The target is within reach: is it still, by points drawn anew? Rounds go on until an estimate is
 * small enough, so the first one that is has likely drawn too few of the points that are off; what
 * is told in the end should not be chosen like that. Three times as many are drawn, so that it
 * seldom takes another turn.
 */
static gw_status confirm(bake *b, gw_error *error)
{
	gw_bake_options *o = &b->scene.options, asked = *o;
	gw_report *r = b->report;
	gw_check_point_hits_forget(&b->scene.check_points);
	o->seed ^= CONFIRM_SEED;
	o->estimate_points = asked.estimate_points < UINT32_MAX / CONFIRM_POINTS
							 ? CONFIRM_POINTS * asked.estimate_points
							 : asked.estimate_points;
	gw_status status = gw_lighting_estimate(&b->light, error);
	gw_check_point_hits_forget(&b->scene.check_points);
	o->seed = asked.seed;
	o->estimate_points = asked.estimate_points;
	r->round[r->round_count - 1].error = r->error;
	if (status == GW_OK && gw_refine_reached(o, &r->error))
		r->goal = GW_GOAL_REACHED;
	return status;
}

static void begin_rounds(bake *b, const char *why)
{
	book_round(b, gw_seconds() - b->start, why);
	b->whole_seconds = gw_seconds() - b->round_start;
	gw_report_stage(b->report, b->scene.gpu, "refining");
	b->refining = true;
}

/* Goes on until the target is reached, the time is up, or nothing is left to refine. */
static gw_status refine(bake *b, gw_error *error)
{
	gw_report *r = b->report;
	gw_status status = GW_OK;
	begin_rounds(b, "the settings that were given");
	while (status == GW_OK && r->goal == GW_GOAL_NONE) {
		if (!b->light.plan.records)
			r->goal = GW_GOAL_REACHED;
		else if (gw_refine_reached(&b->scene.options, &r->error))
			status = confirm(b, error);
		if (status == GW_OK && r->goal == GW_GOAL_NONE)
			status = refine_once(b, error);
	}
	/* What is wrong with the light of lamps alone, no setting lessens. */
	double wanted = (double)b->scene.options.max_error;
	r->missed =
		wanted > 0.0 && (b->light.plan.records ? !gw_refine_reached(&b->scene.options, &r->error)
											   : r->error.relative_rms > wanted);
	if (r->missed && !b->light.plan.records)
		r->goal = GW_GOAL_EXHAUSTED;
	b->refining = false;
	return status;
}

/* Whether records were placed farther apart than they may stand, and more can be added. */
static bool has_few_records(const bake *b)
{
	const gw_bake_options *o = &b->scene.options;
	return b->light.plan.records && gw_options_few_records(o) && o->gathered_error > 0.0f &&
		   b->report->error.points > 0 &&
		   b->scene.records.spacing > fmaxf(o->record_spacing, GW_RECORD_SPACING_LEAST);
}

/* Adds no more records than memory holds; false: it holds none. */
static bool has_room(const bake *b, gw_density_wish *wish)
{
	const gw_memory_ceiling *c = b->ceiling;
	if (!c || c->foretold == 0)
		return true;
	uint64_t records = gw_pilot_record_bytes(&b->scene);
	wish->most_growth =
		fmin(wish->most_growth, gw_bake_memory_growth(c->foretold, c->bytes, records));
	return wish->most_growth >= GROWTH_LEAST;
}

/* Whether records of a transport have been added in vain for light like this: as wrong where it is
 * gathered, to what a scale of the lamps or another device leaves of that. */
static bool was_in_vain(const bake *b)
{
	double before = b->scene.density.in_vain, now = b->report->error.gathered;
	return before > 0.0 && fabs(now - before) <= SAME_ERROR * before;
}

/* How adding to few records has come to its end, with what gw_refine_gathered said last. */
static gw_goal goal_of_few(const bake *b, gw_refine_answer last, bool room)
{
	if (b->report->error.gathered <= (double)b->scene.options.gathered_error)
		return GW_GOAL_REACHED;
	if (!room || b->report->goal == GW_GOAL_MEMORY)
		return GW_GOAL_MEMORY;
	return last == GW_REFINE_STALLED ? GW_GOAL_STALLED : GW_GOAL_EXHAUSTED;
}

/* Adds records where few disagree, until gathered light is right enough or they stand as close as
 * they may, or memory holds no more. */
static gw_status add_to_few(bake *b, gw_error *error)
{
	char why[96];
	gw_density_wish wish;
	bool room = true;
	gw_status status = GW_OK;
	gw_refine_answer answer = was_in_vain(b) ? GW_REFINE_STALLED : GW_REFINE_ROUND;
	begin_rounds(b, "few records");
	b->least_spacing = fmaxf(b->scene.options.record_spacing, GW_RECORD_SPACING_LEAST);
	while (status == GW_OK && answer == GW_REFINE_ROUND && b->report->goal == GW_GOAL_NONE &&
		   b->report->round_count < GW_REPORT_ROUNDS - 1) {
		const gw_bake_options even = as_even(b);
		const gw_refine_state state = state_of(b, &even);
		answer = gw_refine_gathered(&state, &wish, why);
		room = answer != GW_REFINE_ROUND || has_room(b, &wish);
		if (answer != GW_REFINE_ROUND || !room)
			break;
		status = refine_records(b, &wish, why, error);
	}
	b->report->gathered_goal = goal_of_few(b, answer, room);
	b->scene.density.in_vain = answer == GW_REFINE_STALLED ? b->report->error.gathered : 0.0;
	b->refining = false;
	return status;
}

/* What the bounces cost, in the terms of Salm's tables 5.1 to 5.4. */
static void report_profile(gw_passes *passes, gw_report *report)
{
	const double *seconds = gw_passes_seconds(passes);
	report->inject_seconds = seconds[GW_PASS_FACET_SHADE] + seconds[GW_PASS_BRICK_INJECT] +
							 seconds[GW_PASS_BRICK_MIPMAP];
	report->trace_seconds = seconds[GW_PASS_RECORD_RAYS] + seconds[GW_PASS_RECORD_EMITTERS] +
							seconds[GW_PASS_RECORD_FIRST] + seconds[GW_PASS_VOLUME_RAYS] +
							seconds[GW_PASS_VOLUME_FACES];
	report->gather_seconds = seconds[GW_PASS_RECORD_GATHER] + seconds[GW_PASS_RECORD_CONES] +
							 seconds[GW_PASS_VOLUME_FILL] + seconds[GW_PASS_VOLUME_READ] +
							 seconds[GW_PASS_VOLUME_INJECT] + seconds[GW_PASS_VOLUME_SPREAD];
}

/* Seconds that a ray takes, with what else is done for it; to be asked when the rounds are over. */
static double ray_seconds(bake *b)
{
	static const gw_pass_id of_rays[] = { GW_PASS_RECORD_RAYS, GW_PASS_RECORD_EMITTERS,
										  GW_PASS_RECORD_SKY, GW_PASS_RECORD_FIRST,
										  GW_PASS_RECORD_GATHER };
	const gw_report *r = b->report;
	const double *of_pass = gw_passes_seconds(&b->scene.passes);
	double seconds = 0.0, check_points = (double)b->scene.check_points.traced;
	for (size_t i = 0; i < sizeof of_rays / sizeof *of_rays; i++)
		seconds += of_pass[of_rays[i]];
	return r->rays > 0 ? seconds / ((double)r->rays + check_points) : 0.0;
}

/* What a smaller error would cost. Of cones it is not known: theirs has parts that stay; nor where
 * light is left out because bounces are no more than so many. */
static void set_price(bake *b, const gw_bake_options *first, double ray)
{
	static const char *const of_round[] = { "records", "first gather", "bounces", "read back",
											"estimate" };
	gw_report *r = b->report;
	if (b->scene.options.method != GW_METHOD_RAYS || r->error.points == 0 ||
		!(first->record_spacing > 0.0f))
		return;
	double whole = 0.0, round = 0.0;
	for (uint32_t i = 0; i < r->stage_count; i++)
		whole += r->stage[i].seconds;
	for (size_t i = 0; i < sizeof of_round / sizeof *of_round; i++)
		round += gw_report_seconds(r, of_round[i]);
	double records = (double)(r->round_count > 0 ? r->round[0].records : r->records);
	const gw_price_task task = {
		.error = r->error,
		.rays = b->scene.options.rays,
		.records = (double)r->records,
		.spacing = (double)r->record_spacing,
		.refined = b->scene.density.facet_spacing != NULL,
		.fixed_seconds = whole - round - gw_report_seconds(r, "refining"),
		.round_seconds = fmax(round - ray * records * first->rays, 0.0),
		.ray_seconds = ray,
	};
	r->price = r->missed ? gw_price_of(&task, (double)first->max_error) : gw_price_of_less(&task);
	if (b->scene.options.bounces != GW_BOUNCES_AUTO && r->remaining > r->price.error)
		r->price = (gw_price){ 0 };
	if (has_transport(b))
		r->price.seconds = 0.0; /* another bake made what this one began with */
}

static gw_status run(bake *b, gw_error *error)
{
	const gw_bake_options first = b->scene.options;
	double ray = 0.0;

	gw_status status = run_steps(b, 0, b->planning ? RECORDS_STEP : AFTER_ROUND, error);
	if (b->planning) {
		gw_report_stage(b->report, b->scene.gpu, NULL);
		return status == GW_OK ? gw_scene_check_validation(&b->scene, error) : status;
	}
	if (status == GW_OK && gw_options_refine(&b->scene.options))
		status = refine(b, error);
	else if (status == GW_OK && has_few_records(b))
		status = add_to_few(b, error);
	if (status == GW_OK) {
		ray = ray_seconds(b);
		status = run_steps(b, AFTER_ROUND, STEP_COUNT, error);
	}
	gw_report_stage(b->report, b->scene.gpu, NULL);
	if (status == GW_OK)
		set_price(b, &first, ray);
	report_profile(&b->scene.passes, b->report);
	if (status == GW_OK) {
		const gw_stage_seconds spent = gw_stage_seconds_of(b->report, &b->scene.passes);
		gw_effect_seconds_set(&b->light.plan, &spent, b->report);
	}
	gw_report_device(b->report, b->scene.gpu);
	return status == GW_OK ? gw_scene_check_validation(&b->scene, error) : status;
}

static gw_status bake_in_units(const gw_scaled_scene *scaled, gw_bake_manner manner,
							   const gw_bake_callbacks *callbacks, gw_bake_result **result,
							   gw_error *error)
{
	const gw_bake_options *options = &scaled->options;
	*result = NULL;
	bake b = { .points = scaled->scene.points,
			   .planning = manner.planning,
			   .trial = manner.trial,
			   .ceiling = manner.ceiling };
	b.result = gw_allocate_zeros(1, sizeof *b.result);
	if (!b.result)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a result");
	b.report = &b.result->report;
	b.scene = (gw_scene){
		.options = *options,
		.report = b.report,
		.lent = manner.device,
		.known = manner.known,
		.known_unit = ldexpf(1.0f, scaled->light),
		.adds_records = true,
	};
	if (callbacks)
		b.scene.callbacks = *callbacks;
	b.light = (gw_lighting){ .scene = &b.scene,
							 .lights = scaled->scene.lights,
							 .light_count = scaled->scene.light_count,
							 .kept = options->lamps };
	b.start = gw_seconds();
	gw_status status = run(&b, error);
	gw_lighting_clear(&b.light);
	gw_scene_close(&b.scene);
	if (status == GW_OK)
		*result = b.result;
	else
		gw_bake_result_destroy(&b.result);
	return status;
}

gw_status gw_bake_once(const gw_scene_description *scene, const gw_bake_options *options,
					   gw_bake_manner manner, const gw_bake_callbacks *callbacks,
					   gw_bake_result **result, gw_error *error)
{
	gw_scaled_scene scaled;
	gw_status status = gw_scaled_scene_make(scene, options, 0.0, &scaled, error);
	if (status == GW_OK)
		status = bake_in_units(&scaled, manner, callbacks, result, error);
	if (status == GW_OK)
		status = gw_scaled_scene_undo(&scaled, *result, error);
	if (status != GW_OK)
		gw_bake_result_destroy(result);
	gw_scaled_scene_clear(&scaled);
	return status;
}

gw_status gw_bake_on_device(const gw_scene_description *scene, const gw_bake_options *options,
							gw_gpu **device, const gw_bake_callbacks *callbacks,
							gw_bake_result **result, gw_error *error)
{
	const gw_bake_manner manner = { .device = device };
	return gw_bake_once(scene, options, manner, callbacks, result, error);
}

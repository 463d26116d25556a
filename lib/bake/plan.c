/*
 * plan.c - see plan.h.
 */
#include "bake/plan.h"
#include "glowworm_host.h"

#include "cloud/frame.h"
#include "light/direct_light.h"
#include "light/lamp_reach.h"
#include "bake/report.h"

#include <math.h>
#include <stdio.h>

#define FORCED "it is forced"
#define FORBIDDEN "it is forbidden"

bool gw_effect_forced(const gw_bake_options *options, gw_effect_kind effect)
{
	return options->effects_forced & 1u << effect;
}

static bool is_forbidden(const gw_bake_options *options, gw_effect_kind effect)
{
	return options->effects_forbidden & 1u << effect;
}

/* An effect that the scene calls for, or does not; returns whether it is computed. Whoever forces
 * or forbids it has the last word. */
typedef struct call {
	gw_effect_kind effect;
	bool wanted;        /* by the scene */
	const char *reason; /* why, or why not */
	const char *method; /* where it is computed */
} call;

static bool decide(const gw_plan_task *task, call c, gw_report *report)
{
	bool forced = gw_effect_forced(task->options, c.effect);
	bool forbidden = is_forbidden(task->options, c.effect);
	bool computed = forced || (c.wanted && !forbidden);
	const char *end = forced && !c.wanted ? ", but " FORCED : "";
	if (forbidden)
		gw_report_effect(report, gw_effect_name(c.effect), NULL, "%s", FORBIDDEN);
	else
		gw_report_effect(report, gw_effect_name(c.effect), computed ? c.method : NULL, "%s%s",
						 c.reason, end);
	return computed;
}

static float largest_of(const float *values, size_t count)
{
	float largest = 0.0f;
	for (size_t i = 0; values != NULL && i < count; i++)
		largest = values[i] > largest ? values[i] : largest;
	return largest;
}

/* Which lamps are left out, as the end of a sentence: "'entrance' shines past all points". */
static void name_left_out(const gw_plan_task *task, size_t first, size_t count, char *text,
						  size_t room)
{
	const gw_light *light = &task->lights[first];
	const char *why = gw_light_shines(light) ? "shines past all points" : "is black";
	char number[32];
	snprintf(number, sizeof number, "light %zu", first + 1);
	if (count > 1)
		snprintf(text, room, "; %s %s, and %zu more light nothing either",
				 light->name[0] ? light->name : number, why, count - 1);
	else
		snprintf(text, room, "; %s %s", light->name[0] ? light->name : number, why);
}

/* Maps show what is solid. */
static gw_shadows shadows_made(const gw_plan_task *task)
{
	gw_shadows asked = task->options->shadows;
	return asked == GW_SHADOWS_MAPS && gw_surfels_count_clear(task->surfels) > 0 ? GW_SHADOWS_TRACED
																				 : asked;
}

static void plan_lamps(const gw_plan_task *task, gw_plan *plan, gw_report *report)
{
	size_t lamps = 0, reaching = 0, first_out = 0;
	char reason[sizeof report->effect->reason], out[160] = "";
	for (size_t i = 0; i < task->light_count; i++) {
		if (task->lights[i].type == GW_LIGHT_ENVIRONMENT)
			continue;
		bool reaches = gw_lamp_reaches(&task->lights[i], task->surfels, task->options->threads);
		if (!reaches && reaching == lamps)
			first_out = i;
		lamps++;
		reaching += reaches;
	}
	if (reaching < lamps)
		name_left_out(task, first_out, lamps - reaching, out, sizeof out);
	snprintf(reason, sizeof reason, "%zu of %zu lamps and suns shine on points%s", reaching, lamps,
			 out);
	const call lamp = { GW_EFFECT_LAMPS, reaching > 0 && plan->limit > 0,
						plan->limit == 0 ? "no reflection is asked for"
						: lamps == 0     ? "there is no lamp or sun"
										 : reason,
						"at every point" };
	plan->lamps = decide(task, lamp, report);
	bool none = task->options->shadows == GW_SHADOWS_NONE;
	const call shadow = { GW_EFFECT_SHADOWS, plan->lamps && !none,
						  none          ? "none are asked for"
						  : plan->lamps ? "points hide lamps from each other"
										: "no lamp shines on points",
						  gw_shadows_name(shadows_made(task)) };
	plan->shadows = decide(task, shadow, report);
	if (plan->shadows && shadows_made(task) != task->options->shadows)
		gw_report_count(
			report, "shadows_traced", gw_surfels_count_clear(task->surfels),
			"point{ lets|s let} light through, which maps cannot show: shadows are traced");
}

static void plan_emitters(const gw_plan_task *task, gw_plan *plan, gw_report *report)
{
	float largest = largest_of(task->surfels->emission, 3 * task->surfels->count);
	char reason[sizeof report->effect->reason];
	snprintf(reason, sizeof reason, "points emit a radiance of up to %s",
			 GW_SAID((double)largest, 6));
	const call c = { GW_EFFECT_EMITTERS, largest > 0.0f && plan->limit > 0,
					 !(largest > 0.0f)  ? "no point emits"
					 : plan->limit == 0 ? "no reflection is asked for"
										: reason,
					 gw_method_keeps_hits(task->options->method) ? "sampled, and hit by rays"
					 : task->options->method == GW_METHOD_CONES
						 ? "sampled, or as light of the voxels"
					 : task->options->method == GW_METHOD_BUFFERS ? "sampled, or seen in buffers"
					 : task->options->method == GW_METHOD_LPV
						 ? "sampled, or sent into the cells"
						 : "sampled, or hit by rays of the volume" };
	plan->emitters = decide(task, c, report);
}

/* What of the lights is sky. */
static void add_sky(const gw_plan_task *task, gw_plan *plan)
{
	for (size_t i = 0; i < task->light_count; i++) {
		const gw_light *light = &task->lights[i];
		if (light->type != GW_LIGHT_ENVIRONMENT)
			continue;
		if (light->map && largest_of(light->radiance, 3) > 0.0f)
			plan->map = light;
		for (int c = 0; c < 3 && !light->map; c++)
			plan->sky_radiance[c] += light->radiance[c];
	}
}

static void drop_sky(gw_plan *plan)
{
	plan->map = NULL;
	for (int c = 0; c < 3; c++)
		plan->sky_radiance[c] = 0.0f;
}

static void plan_sky(const gw_plan_task *task, gw_plan *plan, gw_report *report)
{
	char reason[sizeof report->effect->reason];
	add_sky(task, plan);
	bool shines = plan->map || largest_of(plan->sky_radiance, 3) > 0.0f;
	if (plan->map)
		snprintf(reason, sizeof reason, "an environment light has a map of %u x %u",
				 plan->map->map_width, plan->map->map_height);
	else
		snprintf(reason, sizeof reason, "an environment light shines");
	const call sky = { GW_EFFECT_SKY, shines && plan->limit > 0,
					   !shines            ? "no environment light shines"
					   : plan->limit == 0 ? "no reflection is asked for"
										  : reason,
					   plan->map ? "sampled, and seen by rays that leave the scene"
								 : "seen by rays that leave the scene" };
	plan->sky = decide(task, sky, report);
	if (!plan->sky)
		drop_sky(plan);
	bool buffers = task->options->method == GW_METHOD_BUFFERS;
	bool rays = gw_method_keeps_hits(task->options->method) || buffers;
	bool cones = task->options->method == GW_METHOD_CONES;
	const call portals = { GW_EFFECT_PORTALS, plan->sky && rays,
						   !plan->sky ? "no sky shines"
						   : rays     ? "whether openings to the sky are few is found by rays"
						   : cones    ? "cones see the sky themselves"
						   : task->options->method == GW_METHOD_LPV
							   ? "the sky shines into the cells at the grid's end"
							   : "rays of the volume see the sky themselves",
						   buffers ? "sampled beside the buffers" : "sampled beside the rays" };
	plan->portals = decide(task, portals, report);
}

static void plan_bounces(const gw_plan_task *task, gw_plan *plan, gw_report *report)
{
	float albedo = largest_of(task->surfels->albedo, 3 * task->surfels->count);
	bool lit = plan->lamps || plan->emitters || plan->sky;
	char reason[sizeof report->effect->reason];
	snprintf(reason, sizeof reason, "albedo reaches %.3g, so reflected light matters",
			 (double)albedo);
	const call c = { GW_EFFECT_BOUNCES, lit && plan->limit > 1 && albedo > 0.0f,
					 !lit               ? "there is no light"
					 : !(albedo > 0.0f) ? "every point is black"
					 : plan->limit < 2  ? "one reflection is asked for"
										: reason,
					 gw_method_name(task->options->method) };
	plan->bounces = decide(task, c, report);
}

/* What all of these need, and what says how good they are. */
static void plan_rest(const gw_plan_task *task, gw_plan *plan, gw_report *report)
{
	const gw_bake_options *o = task->options;
	bool lit = plan->records || plan->lamps, hidden = plan->records || plan->shadows;
	bool points = o->estimate_points > 0;
	const call gaps = { GW_EFFECT_GAPS, hidden || o->unknown,
						hidden ? "light comes from where nobody may have scanned"
							   : "no light is hidden by anything",
						"what scanners saw, else holes of surfaces" };
	plan->gaps = decide(task, gaps, report);
	const call error = { GW_EFFECT_ERROR, lit && points,
						 !points ? "no points are to be solved again for it"
						 : lit   ? "light that is computed is wrong by something"
								 : "there is no light to be wrong",
						 plan->records ? "points solved again" : "by what lamps' shadows show" };
	plan->error = decide(task, error, report);
	bool open = o->ambient_occlusion || o->bent_normals;
	bool kept = o->transport && o->transport->write;
	plan->octree_asked = kept || o->voxels || o->volume || open;
	const call octree = { GW_EFFECT_OCTREE, hidden || plan->octree_asked,
						  plan->records   ? "light is gathered by rays or cones"
						  : plan->shadows ? "shadows are traced through it"
						  : kept          ? "a transport has one"
						  : o->voxels     ? "grids are made of its leaves"
						  : o->volume     ? "radiance in free space is found by rays"
						  : open          ? "ambient occlusion is found by rays"
										  : "nothing is traced",
						  "sparse voxels" };
	plan->octree = decide(task, octree, report);
}

/* What was decided when the surface was made; points that need it are told of all the same. */
static void report_surface(const gw_plan_task *task, call c, const char *not_needed,
						   gw_report *report)
{
	bool forced = gw_effect_forced(task->options, c.effect);
	bool forbidden = is_forbidden(task->options, c.effect);
	const char *name = gw_effect_name(c.effect);
	if (c.wanted)
		gw_report_effect(report, name, c.method, "%s%s", c.reason, forced ? ", and " FORCED : "");
	else
		gw_report_effect(report, name, NULL, "%s", forbidden ? FORBIDDEN : not_needed);
}

static void plan_surface(const gw_plan_task *task, gw_report *report)
{
	const gw_surfels *s = task->surfels;
	char reason[sizeof report->effect->reason];
	bool all = gw_effect_forced(task->options, GW_EFFECT_NOISE) && s->shading_normal;
	snprintf(reason, sizeof reason, "%.3g %% of the points come without one that can be trusted",
			 100.0 * (double)s->normals_estimated / fmax((double)s->count, 1.0));
	char through[sizeof report->effect->reason];
	size_t clear = gw_surfels_count_clear(s);
	bool cones = task->options->method == GW_METHOD_CONES;
	if (clear > 0)
		snprintf(through, sizeof through,
				 "%.3g %% of the points are less than opaque, or fill space as leaves do",
				 100.0 * (double)clear / (double)s->count);
	else
		snprintf(through, sizeof through, "all points are opaque%s",
				 cones ? ", by cones light may differ by 0.5 %" : "");
	const call transmission = { GW_EFFECT_TRANSMISSION, s->transparency != NULL, through,
								"attenuated once a surface" };
	const call noise = { GW_EFFECT_NOISE, s->shading_normal != NULL,
						 all ? "the points are looked at for it"
							 : "the points scatter about "
							   "their surface",
						 "normals of a smoothed surface" };
	const call normals = { GW_EFFECT_NORMALS, s->normals_estimated > 0, reason,
						   "planes through neighbours" };
	report_surface(task, normals, "all points have their own", report);
	report_surface(task, noise, "the points lie on their surface", report);
	report_surface(task, transmission, "all points are opaque", report);
}

static void plan_columns(const gw_plan_task *task, gw_report *report)
{
	char reason[sizeof report->effect->reason];
	snprintf(reason, sizeof reason, "a column for each of %zu lights is asked for",
			 task->light_count);
	const call columns = { GW_EFFECT_COLUMNS, task->options->lamps,
						   task->options->lamps ? reason : "no light is asked for by itself",
						   "solved again for each light" };
	decide(task, columns, report);
}

bool gw_plan_may_gather(const gw_bake_options *o)
{
	const gw_effect_kind gathered[] = { GW_EFFECT_EMITTERS, GW_EFFECT_SKY, GW_EFFECT_PORTALS,
										GW_EFFECT_BOUNCES };
	bool may = false;
	for (size_t i = 0; i < sizeof gathered / sizeof *gathered; i++)
		may |= gw_effect_forced(o, gathered[i]);
	bool first = !is_forbidden(o, GW_EFFECT_EMITTERS) || !is_forbidden(o, GW_EFFECT_SKY);
	return may || (o->bounces > 0 && first) || o->bounces > 1 || o->ambient_occlusion ||
		   o->bent_normals || o->volume;
}

bool gw_plan_may_trace(const gw_bake_options *o)
{
	bool lamps = gw_effect_forced(o, GW_EFFECT_LAMPS) ||
				 (o->bounces > 0 && !is_forbidden(o, GW_EFFECT_LAMPS));
	return gw_plan_may_gather(o) || (lamps && o->shadows != GW_SHADOWS_NONE) || o->voxels ||
		   gw_effect_forced(o, GW_EFFECT_SHADOWS) || gw_effect_forced(o, GW_EFFECT_OCTREE);
}

void gw_plan_make(const gw_plan_task *task, gw_plan *plan, gw_report *report)
{
	*plan = (gw_plan){ .limit = task->options->bounces };
	plan_lamps(task, plan, report);
	plan_emitters(task, plan, report);
	plan_sky(task, plan, report);
	plan_bounces(task, plan, report);
	plan->records = plan->emitters || plan->sky || plan->portals || plan->bounces;
	plan_rest(task, plan, report);
	plan_surface(task, report);
	plan_columns(task, report);
}

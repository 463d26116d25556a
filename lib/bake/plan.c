/*
 * plan.c - see plan.h.
 */
#include "bake/plan.h"

#include "light/direct_light.h"
#include "bake/report.h"

static float largest_of(const float *values, size_t count)
{
	float largest = 0.0f;
	for (size_t i = 0; values != NULL && i < count; i++)
		largest = values[i] > largest ? values[i] : largest;
	return largest;
}

static void plan_lamps(const gw_light *lights, size_t light_count, const gw_bake_options *options,
					   gw_plan *plan, gw_report *report)
{
	size_t shining = 0;
	for (size_t i = 0; i < light_count; i++)
		shining += gw_light_shines(&lights[i]);
	plan->lamps = shining > 0 && plan->limit > 0;
	if (plan->lamps)
		gw_report_effect(report, "direct light", gw_shadows_name(options->shadows),
						 "%zu point, spot or sun lights shine", shining);
	else
		gw_report_effect(report, "direct light", NULL,
						 shining > 0 ? "no reflection is asked for"
									 : "no point, spot or sun light shines");
}

static void plan_emitters(const gw_surfels *surfels, const gw_bake_options *options, gw_plan *plan,
						  gw_report *report)
{
	float largest = largest_of(surfels->emission, 3 * surfels->count);
	plan->emitters = largest > 0.0f && plan->limit > 0;
	if (plan->emitters)
		gw_report_effect(report, "emitters",
						 options->method == GW_METHOD_RAYS ? "sampled, and hit by rays"
														   : "sampled, or as light of the voxels",
						 "points emit up to %g W/(sr m^2)", (double)largest);
	else
		gw_report_effect(report, "emitters", NULL,
						 largest > 0.0f ? "no reflection is asked for" : "no point emits");
}

static void plan_sky(const gw_light *lights, size_t light_count, gw_plan *plan, gw_report *report)
{
	for (size_t i = 0; i < light_count; i++) {
		if (lights[i].type != GW_LIGHT_ENVIRONMENT)
			continue;
		if (lights[i].map) {
			bool shines = plan->limit > 0 && largest_of(lights[i].radiance, 3) > 0.0f;
			plan->map = shines ? &lights[i] : NULL;
			continue;
		}
		for (int c = 0; c < 3; c++)
			plan->sky_radiance[c] += lights[i].radiance[c];
	}
	plan->sky = (plan->map || largest_of(plan->sky_radiance, 3) > 0.0f) && plan->limit > 0;
	if (plan->map)
		gw_report_effect(report, "sky", "sampled, and seen by rays that leave the scene",
						 "an environment light has a map of %u x %u", plan->map->map_width,
						 plan->map->map_height);
	else if (plan->sky)
		gw_report_effect(report, "sky", "seen by rays that leave the scene",
						 "an environment light shines");
	else
		gw_report_effect(report, "sky", NULL, "no environment light shines");
}

static void plan_bounces(const gw_surfels *surfels, const gw_bake_options *options, gw_plan *plan,
						 gw_report *report)
{
	float albedo = largest_of(surfels->albedo, 3 * surfels->count);
	bool lit = plan->lamps || plan->emitters || plan->sky;
	plan->bounces = lit && plan->limit > 1 && albedo > 0.0f;
	if (plan->bounces)
		gw_report_effect(report, "diffuse bounces", gw_method_name(options->method),
						 "albedo reaches %.3g, so reflected light matters", (double)albedo);
	else
		gw_report_effect(report, "diffuse bounces", NULL,
						 !lit            ? "there is no light"
						 : albedo > 0.0f ? "one reflection is asked for"
										 : "every point is black");
}

void gw_plan_make(const gw_surfels *surfels, const gw_light *lights, size_t light_count,
				  const gw_bake_options *options, gw_plan *plan, gw_report *report)
{
	*plan = (gw_plan){ .limit = options->bounces };
	plan_lamps(lights, light_count, options, plan, report);
	plan_emitters(surfels, options, plan, report);
	plan_sky(lights, light_count, plan, report);
	plan_bounces(surfels, options, plan, report);
	plan->records = plan->emitters || plan->sky || plan->bounces;
}

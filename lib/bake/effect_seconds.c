/*
 * effect_seconds.c - see effect_seconds.h.
 */
#include "bake/effect_seconds.h"

#include "bake/report.h"

void gw_stage_seconds_read(gw_passes *passes, const double *before, gw_stage_seconds *spent)
{
	const double *seconds = gw_passes_seconds(passes);
	double own[GW_PASS_COUNT];
	for (size_t i = 0; i < GW_PASS_COUNT; i++)
		own[i] = seconds[i] - (before ? before[i] : 0.0);
	spent->emitters = own[GW_PASS_RECORD_EMITTERS];
	spent->sky = own[GW_PASS_RECORD_SKY];
	spent->portals = own[GW_PASS_RECORD_PORTALS] + own[GW_PASS_PORTAL_LIGHT];
}

gw_stage_seconds gw_stage_seconds_of(const gw_report *report, gw_passes *passes)
{
	gw_stage_seconds spent = { .direct_light = gw_report_seconds(report, "direct light"),
							   .gaps = gw_report_seconds(report, "gaps"),
							   .octree = gw_report_seconds(report, "octree"),
							   .gather = gw_report_seconds(report, "records") +
										 gw_report_seconds(report, "first gather") +
										 gw_report_seconds(report, "read back"),
							   .bounces = gw_report_seconds(report, "bounces"),
							   .estimate = gw_report_seconds(report, "estimate"),
							   .columns = gw_report_seconds(report, "lamps") };
	gw_stage_seconds_read(passes, NULL, &spent);
	return spent;
}

void gw_effect_seconds_set(const gw_plan *plan, const gw_stage_seconds *spent, gw_report *report)
{
	int gatherers = plan->emitters + plan->sky + plan->bounces;
	bool octree_goes = gatherers + plan->shadows == 1 && !plan->octree_asked;
	double octree = octree_goes ? spent->octree : 0.0;
	double last = gatherers == 1 ? spent->gather + octree : 0.0;
	double hidden = plan->shadows ? octree : 0.0;
	const struct {
		gw_effect_kind effect;
		bool computed;
		double seconds;
	} rows[] = {
		{ GW_EFFECT_LAMPS, plan->lamps, spent->direct_light + hidden },
		{ GW_EFFECT_SHADOWS, plan->shadows, spent->direct_light + hidden },
		{ GW_EFFECT_EMITTERS, plan->emitters, last > 0.0 ? last : spent->emitters },
		{ GW_EFFECT_SKY, plan->sky, last > 0.0 ? last : spent->sky + spent->portals },
		{ GW_EFFECT_PORTALS, plan->portals, spent->portals },
		{ GW_EFFECT_BOUNCES, plan->bounces, spent->bounces + last },
		{ GW_EFFECT_GAPS, plan->gaps, spent->gaps },
		{ GW_EFFECT_ERROR, plan->error, spent->estimate },
		{ GW_EFFECT_OCTREE, plan->octree, spent->octree },
		{ GW_EFFECT_COLUMNS, spent->columns > 0.0, spent->columns },
	};
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
		gw_report_price(report, gw_effect_name(rows[i].effect),
						rows[i].computed ? rows[i].seconds : 0.0);
}

/*
 * frames_plan.c - gw_frames_plan: what bakes of frames will take; see glowworm.h.
 *
 * What one frame by itself takes is foretold as of any bake. What the first one takes when it
 * prepares the others, and what one of these takes, is found by baking two of them with few
 * records: passes over records take so many times as long as there will be more of them.
 */
#include "glowworm_host.h"
#include "base/memory.h"
#include "bake/forecast.h"
#include "bake/frames.h"
#include "bake/report.h"
#include "light/direct_light.h"

#include <math.h>
#include <stdlib.h>

/* One of the two frames. */
typedef struct trial {
	size_t frame;
	const gw_light *lights;
	double seconds;       /* with as many records as there will be */
	uint64_t more_memory; /* bytes that these take beside those of the trial */
} trial;

/* The rest of the forecast of a frame by itself. */
static gw_status plan_alone(gw_frames *f, const trial *first, gw_bake_result *plan, gw_error *error)
{
	double start = gw_seconds();
	f->alone = true;
	f->light.lights = first->lights;
	f->scene.report = &plan->report;
	gw_status status = gw_frames_light(f, first->frame, error);
	gw_report_stage(&plan->report, f->scene.gpu, NULL);
	if (status == GW_OK)
		status = gw_forecast_make(&f->light, gw_seconds() - start, plan, NULL, error);
	f->alone = false;
	return status;
}

static gw_status bake_trial(gw_frames *f, uint64_t records, trial *t, gw_error *error)
{
	gw_bake_result *result = gw_allocate_zeros(1, sizeof *result);
	if (!result)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a result");
	gw_passes *passes = &f->scene.passes;
	double before = gw_pilot_record_seconds(passes), start = gw_seconds();
	f->light.lights = t->lights;
	f->scene.report = &result->report;
	gw_status status = gw_frames_solve(f, t->frame, result, error);
	gw_report_stage(&result->report, f->scene.gpu, NULL);
	if (status == GW_OK) {
		uint64_t own = f->scene.records.count > 0 ? f->scene.records.count : 1;
		double more = fmax((double)records / (double)own - 1.0, 0.0);
		t->seconds = gw_seconds() - start + more * (gw_pilot_record_seconds(passes) - before);
		/* Once in the frame, and once as kept of what stands still. */
		t->more_memory = (uint64_t)(2.0 * more * (double)gw_pilot_record_bytes(&f->scene));
	}
	gw_bake_result_destroy(&result);
	return status;
}

/* The two frames, one after the other, as they will be baked. */
static gw_status try_frames(gw_frames *f, trial *trials, gw_forecast *forecast, gw_error *error)
{
	const gw_bake_options asked = f->scene.options;
	double surfels = f->shared_seconds;
	gw_frames_drop_geometry(f);
	f->scene.options.record_spacing = gw_pilot_spacing(forecast->records, forecast->record_spacing);
	f->scene.options.least_records = 0;
	gw_status status = bake_trial(f, forecast->records, &trials[0], error);
	if (status == GW_OK && trials[1].frame != trials[0].frame)
		status = bake_trial(f, forecast->records, &trials[1], error);
	f->scene.options = asked;
	GW_TRY(status);
	uint64_t peak = gw_gpu_read_account(f->scene.gpu).peak_bytes + trials[0].more_memory;
	forecast->seconds = surfels + trials[0].seconds;
	forecast->frame_seconds = trials[1].seconds;
	forecast->device_bytes = peak > forecast->device_bytes ? peak : forecast->device_bytes;
	return GW_OK;
}

static gw_status plan_in_units(gw_frames *f, trial *trials, gw_bake_result *plan, gw_error *error)
{
	gw_forecast *forecast = &plan->report.forecast;
	double start = gw_seconds();
	const gw_bake_options asked = f->scene.options; /* an estimate is made once */
	GW_TRY(plan_alone(f, &trials[0], plan, error));
	forecast->frame_seconds = forecast->seconds;
	if (!f->how.rebuild)
		GW_TRY(try_frames(f, trials, forecast, error));
	f->scene.options = asked;
	forecast->own_seconds = gw_seconds() - start;
	forecast->done_seconds = 0.0; /* frames begin anew */
	return gw_scene_check_validation(&f->scene, error);
}

/* Both with lights in the units of the frames. */
static gw_status plan_frames(gw_frames *f, trial *trials, gw_bake_result *plan, gw_error *error)
{
	gw_status status = plan_in_units(f, trials, plan, error);
	f->scene.report = NULL;
	f->light.lights = NULL;
	f->light.light_count = 0;
	gw_frames_forget(f);
	f->shared_seconds = 0.0;
	return status == GW_OK ? gw_scaled_scene_undo(&f->units, plan, error) : status;
}

gw_status gw_frames_plan(gw_frames *f, const size_t frame[2], const gw_light *const lights[2],
						 size_t light_count, gw_bake_result **plan, gw_error *error)
{
	gw_light *own[2] = { NULL, NULL };
	trial trials[2];
	*plan = NULL;
	for (int i = 0; i < 2; i++) {
		if (frame[i] >= f->motion->frame_count)
			return gw_fail(error, GW_ERROR_USAGE, "there is no frame %zu; the last one is %zu",
						   frame[i], f->motion->frame_count - 1);
		GW_TRY(gw_lights_check(lights[i], light_count, error));
	}
	gw_bake_result *r = gw_allocate_zeros(1, sizeof *r);
	gw_status status = r ? GW_OK : gw_fail(error, GW_ERROR_MEMORY, "no memory for a plan");
	for (int i = 0; i < 2; i++) {
		if (status == GW_OK)
			status = gw_scaled_lights(&f->units, lights[i], light_count, &own[i], error);
		trials[i] = (trial){ .frame = frame[i], .lights = own[i] };
	}
	f->light.light_count = light_count;
	if (status == GW_OK)
		status = plan_frames(f, trials, r, error);
	f->light.light_count = 0;
	free(own[0]);
	free(own[1]);
	if (status == GW_OK)
		*plan = r;
	else
		gw_bake_result_destroy(&r);
	return status;
}

#include "verbs/verbs.h"
#include "result/bake_plan.h"
#include "result/frame_bake.h"
#include "result/light_shares.h"
#include "result/lit_scan.h"
#include "scene/file_roles.h"
#include "scene/glossy_points.h"
#include "scene/input_notes.h"
#include "options/output_name.h"
#include "options/progress.h"
#include "options/quality_preset.h"
#include "scene/scene_file.h"
#include "program/signals.h"
#include "program/text_quote.h"
#include "glowworm_host.h"

#include <stdio.h>
#include <stdlib.h>

/* All that lives as long as one plan. */
typedef struct plan {
	settings *settings;
	parted_cloud parted; /* where memory does not hold all points */
	loaded_scene scene;
	gw_light *light;
	gw_drivers *drivers;
	gw_bake_result *result;
	double read_seconds;
	progress progress;
	gw_error *error;
} plan;

static void on_progress(void *user, const char *stage, double done)
{
	progress_show(&((plan *)user)->progress, stage, done);
}

static bool on_cancelled(void *user)
{
	(void)user;
	return signals_pending() != 0;
}

static gw_status read_scene(plan *p)
{
	settings *s = p->settings;
	double start = gw_seconds();
	GW_TRY(scene_read_all(s, p->error));
	quality_preset_apply(s);
	bake_plan_apply_effects(s);
	GW_TRY(bake_plan_apply_motion(s, p->error));
	if (s->input_count == 0)
		return gw_fail(p->error, GW_ERROR_USAGE,
					   "what to plan for? Name an input, or - for standard input");
	s->bake.drivers = p->drivers = gw_drivers_load();
	const format *to = NULL;
	if (s->output)
		GW_TRY(output_name_format(s->output, s->output_format, &to, p->error));
	GW_TRY(parted_cloud_open_to_plan(s, to, &p->parted, p->error));
	parted_cloud *parted = p->parted.most > 0 ? &p->parted : NULL;
	GW_TRY(loaded_scene_read_parted(s, parted, &p->scene, p->error));
	if (!s->quiet && parted)
		text_message(
			stderr,
			"glowworm: note: %zu points make the surface of all %llu: memory holds no more "
			"(--memory)\n",
			p->scene.cloud.count, (unsigned long long)parted->file.count);
	if (!s->quiet)
		input_notes_print(s, &p->scene);
	glossy_points_apply(s, &p->scene);
	GW_TRY(loaded_scene_lights(&p->scene, s, &p->light, p->error));
	p->read_seconds = gw_seconds() - start;
	return GW_OK;
}

static gw_status make(plan *p)
{
	const settings *s = p->settings;
	gw_bake_options options = bake_plan_options(s);
	const gw_bake_callbacks callbacks = { on_progress, on_cancelled, p, NULL };
	const gw_scene_description scene = { &p->scene.points.points, p->light, s->light_count };
	gw_status status = s->frame_count > 0
						   ? frame_bake_plan(s, &p->scene, &callbacks, &p->result, p->error)
						   : gw_plan_bake(&scene, &options, &callbacks, &p->result, p->error);
	progress_clear(&p->progress);
	return status;
}

static void print(plan *p)
{
	const settings *s = p->settings;
	size_t columns, row = lit_scan_row_bytes(&p->scene, s, &columns);
	bake_plan_add_scene(&p->result->report, s, &p->scene);
	const bake_plan_forecast forecast = bake_plan_foretell(
		s, &p->scene, p->result, p->read_seconds, s->output ? row : 0, frame_bake_following(s));
	if (!s->json) {
		bake_plan_print(&forecast, stdout);
		return;
	}
	json_writer json = { .out = stdout, .lines = true };
	json_put_open(&json, NULL, '{');
	bake_plan_write_effects(&json, &p->result->report);
	light_shares_write(&json, &(light_shares){ s, &p->scene, p->result, 0 });
	bake_plan_write_forecast(&json, &forecast);
	json_put_close(&json, '}');
	putchar('\n');
}

gw_status verb_plan(settings *s, gw_error *error)
{
	plan p = { .settings = s,
			   .progress = progress_start((settings_progress)s->progress, s->quiet),
			   .error = error };
	gw_status status = read_scene(&p);
	if (status == GW_OK)
		status = make(&p);
	progress_end(&p.progress);
	if (status == GW_OK)
		print(&p);
	s->bake.drivers = NULL;
	gw_bake_result_destroy(&p.result);
	gw_drivers_release(&p.drivers);
	loaded_scene_clear(&p.scene);
	parted_cloud_close(&p.parted);
	free(p.light);
	return status;
}

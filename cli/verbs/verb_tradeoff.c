#include "verbs/verbs.h"
#include "scene/file_roles.h"
#include "scene/stream_roles.h"
#include "scene/glossy_points.h"
#include "scene/input_notes.h"
#include "files/output_file.h"
#include "scene/scene_file.h"
#include "scene/thinned_scene.h"
#include "program/exit_code.h"
#include "program/text_quote.h"
#include "comparison/tradeoff_plot.h"

#include <stdlib.h>
#include <string.h>

#define MEGABYTE 1e6

/* All that lives as long as one sweep. */
typedef struct sweep {
	settings *settings;
	output_file *csv, *svg;
	thinned_scene scene;
	gw_light *light;
	tradeoff tradeoff;
	gw_error *error;
} sweep;

static gw_status check(sweep *w)
{
	const settings *s = w->settings;
	if (s->input_count == 0)
		return gw_fail(w->error, GW_ERROR_USAGE,
					   "what to light? Name an input, or - for standard input");
	const stream_output out[] = { { "--csv", s->csv, NULL }, { "--svg", s->svg, NULL } };
	GW_TRY(stream_roles_check_inputs(s, w->error));
	GW_TRY(stream_roles_check_outputs(out, sizeof out / sizeof *out, w->error));
	GW_TRY(file_roles_check(VERB_TRADEOFF, s, NULL, w->error));
	if (s->csv)
		GW_TRY(output_file_create(&w->csv, s->csv, s->force, w->error));
	if (s->svg)
		GW_TRY(output_file_create(&w->svg, s->svg, s->force, w->error));
	return GW_OK;
}

/* ------------------------------------------------------------------------------- the table */

static void print_row(const tradeoff_run *run, bool reference, FILE *out)
{
	fprintf(out, "%-24s", run->name);
	if (run->status != GW_OK) {
		fprintf(out, run->status == GW_ERROR_MEMORY ? " does not fit into memory\n"
													: " has no place among these points\n");
		return;
	}
	if (reference)
		fprintf(out, " %8s %8s %8s", "-", "-", "-");
	else
		fprintf(out, " %8.2f %8.2f %+8.2f", 100.0 * run->difference.rel_rmse,
				100.0 * run->difference.best_99, 100.0 * run->difference.bias);
	fprintf(out, " %9.2f %9.0f %9.0f  %s\n", run->seconds, (double)run->host_bytes / MEGABYTE,
			(double)run->device_bytes / MEGABYTE, run->front && !reference ? "*" : "");
}

static void print_table(const tradeoff *t, FILE *out)
{
	const gw_error_estimate *e = &t->run[0].estimate;
	char error[TEXT_PERCENT], spread[TEXT_PERCENT];
	fprintf(out, "Difference of the luminance from the reference, %% of its mean\n\n");
	fprintf(out, "%-24s %8s %8s %8s %9s %9s %9s  %s\n", "", "relRMSE", "best 99%", "bias",
			"seconds", "MB", "device MB", "best");
	for (size_t i = 0; i < t->count; i++)
		print_row(&t->run[i], i == 0, out);
	fprintf(out, "\n* no other setting is both as fast and as near.\n");
	if (e->points)
		fprintf(out,
				"The reference estimates its own error as %s %% +- %s %%; differences of that "
				"size say little.\n",
				text_percent(e->relative_rms, error), text_percent(e->spread, spread));
}

/* What reaches an error, the fastest first; the reference counts by its own estimate. */
static gw_status print_reaching(const tradeoff *t, double wanted, FILE *out, gw_error *error)
{
	double last = -1.0;
	size_t found = 0;
	for (size_t k = 0; k < t->count; k++) {
		const tradeoff_run *next = NULL;
		for (size_t i = 0; i < t->count; i++) {
			const tradeoff_run *run = &t->run[i];
			double off =
				i ? run->difference.rel_rmse : run->estimate.relative_rms + run->estimate.spread;
			if (run->status == GW_OK && off <= wanted && run->seconds > last &&
				(!next || run->seconds < next->seconds))
				next = run;
		}
		if (!next)
			break;
		last = next->seconds;
		if (found++ == 0)
			fprintf(out, "\nAt most %.3g %% off, the fastest first:\n", 100.0 * wanted);
		fprintf(out, "  %8.2f s  %s\n", next->seconds, next->options);
	}
	if (found > 0)
		return GW_OK;
	return gw_fail(error, STATUS_MISSED, "no setting that was tried is at most %.3g %% off",
				   100.0 * wanted);
}

static void print_csv(const tradeoff *t, FILE *out)
{
	fputs(
		"setting,options,record_spacing,leaf_spacing,rays,light_samples,cones,relrmse,best99,bias,"
		"estimate,seconds,peak_bytes,device_bytes,front\n",
		out);
	for (size_t i = 0; i < t->count; i++) {
		const tradeoff_run *run = &t->run[i];
		const gw_bake_options *o = &run->bake;
		if (run->status != GW_OK)
			continue;
		fprintf(out, "\"%s\",%s,%g,", run->name, run->options, (double)o->record_spacing);
		if (o->leaf_spacing == GW_LEAF_SPACING_AUTO)
			fputs("auto,", out);
		else
			fprintf(out, "%g,", (double)o->leaf_spacing);
		fprintf(out, "%u,%u,%u,", o->rays, o->light_samples, o->cones);
		if (i == 0)
			fputs(",,,", out);
		else
			fprintf(out, "%.6g,%.6g,%.6g,", run->difference.rel_rmse, run->difference.best_99,
					run->difference.bias);
		fprintf(out, "%.6g,%.4f,%llu,%llu,%d\n", run->estimate.relative_rms, run->seconds,
				(unsigned long long)run->host_bytes, (unsigned long long)run->device_bytes,
				run->front && i > 0);
	}
}

/* --------------------------------------------------------------------------------- files */

static gw_status write_file(output_file **to, void (*print)(const tradeoff *, FILE *),
							const tradeoff *t, gw_error *error)
{
	char *text = NULL;
	size_t length;
	FILE *out = open_memstream(&text, &length);
	gw_status status = GW_OK;
	if (out)
		print(t, out);
	if (!out || fclose(out) != 0)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory for a table");
	if (status == GW_OK)
		status = output_file_write(*to, text, length, error);
	free(text);
	return status == GW_OK ? output_file_commit(to, error) : status;
}

static gw_status show(sweep *w)
{
	const settings *s = w->settings;
	FILE *out = stream_roles_standard(s->csv) || stream_roles_standard(s->svg) ? stderr : stdout;
	print_table(&w->tradeoff, out);
	if (w->csv)
		GW_TRY(write_file(&w->csv, print_csv, &w->tradeoff, w->error));
	if (w->svg)
		GW_TRY(write_file(&w->svg, tradeoff_plot_write, &w->tradeoff, w->error));
	if (s->bake.max_error > 0.0f)
		GW_TRY(print_reaching(&w->tradeoff, (double)s->bake.max_error, out, w->error));
	return GW_OK;
}

static gw_status run(sweep *w)
{
	const parted_cloud_look look = { .bytes = THINNED_SCENE_LIT_BYTES };
	settings *s = w->settings;
	progress shown = progress_start((settings_progress)s->progress, s->quiet);
	GW_TRY(scene_read_all(s, w->error));
	GW_TRY(check(w));
	GW_TRY(thinned_scene_read(s, &look, "taken", &w->scene, w->error));
	if (!s->quiet)
		input_notes_print(s, &w->scene.loaded);
	glossy_points_apply(s, &w->scene.loaded);
	GW_TRY(loaded_scene_lights(&w->scene.loaded, s, &w->light, w->error));
	/* Each run has its settings from the start, and says how wrong it is. */
	gw_bake_options base = s->bake;
	base.max_error = base.time_limit = 0.0f;
	tradeoff_plan(&base, &w->tradeoff);
	GW_TRY(
		tradeoff_bake(&w->scene.loaded, w->light, s->light_count, &w->tradeoff, &shown, w->error));
	return show(w);
}

gw_status verb_tradeoff(settings *s, gw_error *error)
{
	sweep w = { .settings = s, .error = error };
	gw_status status = run(&w);
	output_file_abandon(&w.csv);
	output_file_abandon(&w.svg);
	thinned_scene_clear(&w.scene);
	free(w.light);
	return status;
}

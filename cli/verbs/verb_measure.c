#include "verbs/verbs.h"
#include "glowworm_host.h"
#include "options/options.h"
#include "program/json_writer.h"
#include "program/text_quote.h"
#include "result/light_measure.h"
#include "scene/thinned_scene.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static void print(const light_measure *m, FILE *out)
{
	char percent[TEXT_PERCENT];
	fprintf(out, "%-12s %s, %zu points on %s m^2\n", m->quantity, m->unit, m->points,
			GW_SAID(m->area, 4));
	fprintf(out, "%-12s %s\n", "mean", GW_SAID(m->mean, 4));
	fprintf(out, "%-12s %s\n", "least", GW_SAID(m->least, 4));
	fprintf(out, "%-12s %s\n", "most", GW_SAID(m->most, 4));
	fprintf(out, "%-12s %.3f least over mean, %.3f least over most\n", "uniformity",
			m->mean > 0.0 ? m->least / m->mean : 0.0, m->most > 0.0 ? m->least / m->most : 0.0);
	for (size_t i = 0; i < m->lamp_count; i++)
		fprintf(out, "%-12s %s %%\n", m->lamp[i].name, text_percent(m->lamp[i].share, percent));
	for (size_t i = 0; i < m->group_count; i++)
		fprintf(out, "%-12s %s %%, all of the group\n", m->group[i].name,
				text_percent(m->group[i].share, percent));
}

static void write_lamps(json_writer *json, const char *name, const measure_lamp *list, size_t count)
{
	json_put_open(json, name, '[');
	for (size_t i = 0; i < count; i++) {
		json_put_open_flat(json, NULL, '{');
		json_put_text(json, "name", list[i].name);
		json_put_real(json, "share", list[i].share);
		json_put_close(json, '}');
	}
	json_put_close(json, ']');
}

static void write_json(const light_measure *m, FILE *out)
{
	json_writer json = { .out = out, .lines = true };
	json_put_open(&json, NULL, '{');
	json_put_text(&json, "quantity", m->quantity);
	json_put_text(&json, "unit", m->unit);
	json_put_count(&json, "points", m->points);
	json_put_real(&json, "area", m->area);
	json_put_real(&json, "mean", m->mean);
	json_put_real(&json, "least", m->least);
	json_put_real(&json, "most", m->most);
	json_put_real(&json, "least_over_mean", m->mean > 0.0 ? m->least / m->mean : 0.0);
	json_put_real(&json, "least_over_most", m->most > 0.0 ? m->least / m->most : 0.0);
	write_lamps(&json, "lamps", m->lamp, m->lamp_count);
	write_lamps(&json, "groups", m->group, m->group_count);
	json_put_close(&json, '}');
	fputc('\n', out);
}

static gw_status measure(const settings *s, const measure_region *region, gw_error *error)
{
	const parted_cloud_look look = { .bytes = THINNED_SCENE_SEEN_BYTES };
	thinned_scene scene;
	light_measure found;
	gw_status status = thinned_scene_read(s, &look, "measured", &scene, error);
	if (status == GW_OK)
		status = light_measure_make(s, &scene.loaded, region, &found, error);
	thinned_scene_clear(&scene);
	GW_TRY(status);
	(s->json ? write_json : print)(&found, stdout);
	light_measure_clear(&found);
	return GW_OK;
}

gw_status verb_measure(const settings *s, gw_error *error)
{
	measure_region region;
	if (s->input_count > 1)
		return gw_fail(
			error, GW_ERROR_USAGE,
			"measure takes one lit cloud, but '%s' stands after it; a box or a path is one "
			"argument: --box X,Y,Z,X,Y,Z, --path 'X,Y,Z X,Y,Z'",
			s->input[1].path);
	if (s->input_count != 1)
		return gw_fail(error, GW_ERROR_USAGE, "measure what? Name one lit cloud, or -");
	const option *reach = option_find(VERB_MEASURE, "reach", strlen("reach"));
	if (!s->measure_path && s->given[reach - options] != SETTINGS_BY_DEFAULT)
		return gw_fail(error, GW_ERROR_USAGE,
					   "--reach says how near a --path is; give one, or leave it out");
	GW_TRY(measure_region_read(s->measure_box, s->measure_path, (double)s->measure_reach, &region,
							   error));
	gw_status status = measure(s, &region, error);
	measure_region_clear(&region);
	return status;
}

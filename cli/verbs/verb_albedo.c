#include "verbs/verbs.h"
#include "files/output_file.h"
#include "options/output_name.h"
#include "options/output_scanners.h"
#include "options/output_columns.h"
#include "options/output_system.h"
#include "options/quality_preset.h"
#include "points/scan_color.h"
#include "program/text_quote.h"
#include "result/albedo_solve.h"
#include "result/albedo_stations.h"
#include "scene/file_roles.h"
#include "scene/stream_roles.h"
#include "scene/scene_file.h"
#include "glowworm_host.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static gw_status check(settings *s, const format **to, gw_error *error)
{
	if (s->input_count == 0)
		return gw_fail(error, GW_ERROR_USAGE, "whose albedo? Name a scan, or - for standard input");
	if (!s->output)
		return gw_fail(error, GW_ERROR_USAGE,
					   "where to write? Give -o FILE, or -o - for standard output");
	GW_TRY(
		stream_roles_check_outputs(&(stream_output){ "--output", s->output, "this is" }, 1, error));
	GW_TRY(file_roles_check(VERB_ALBEDO, s, NULL, error));
	GW_TRY(output_name_format(s->output, s->output_format, to, error));
	return output_shift_read(s->shift, *to, &s->shifting, error);
}

/* What is photographed must not be lit already: its colours are a preview then. */
static gw_status read_scan(settings *s, loaded_scene *scene, gw_error *error)
{
	s->points.albedo = SCAN_ALBEDO_COLOR;
	GW_TRY(loaded_scene_read(s, scene, error));
	for (size_t i = 0; i < scene->input_count; i++)
		if (scene->input[i].lit)
			return gw_fail(error, GW_ERROR_USAGE,
						   "%s was lit by glowworm and holds its albedo; photographs have none",
						   loaded_scene_input_name(scene->input[i].path));
	return GW_OK;
}

/* ------------------------------------------------------------------------------- the set-up */

static settings_capture find_capture(const settings *s, const loaded_scene *scene)
{
	if (s->capture != SETTINGS_CAPTURE_AUTO)
		return (settings_capture)s->capture;
	if (s->light_count > 0)
		return SETTINGS_CAPTURE_LIGHTS;
	return scan_find_scalar(&scene->cloud, "intensity") ? SETTINGS_CAPTURE_INTENSITY
														: SETTINGS_CAPTURE_AUTO;
}

static gw_status add_flashes(settings *s, const loaded_scene *scene, gw_error *error)
{
	const scan *cloud = &scene->cloud;
	if (cloud->scanner_count == 0)
		return gw_fail(error, GW_ERROR_USAGE,
					   "nobody says where the flash was; give --scanner X,Y,Z");
	if (cloud->scanner_count > 64)
		return gw_fail(error, GW_ERROR_USAGE,
					   "the scanner stood at %zu places; that is no flash on a tripod",
					   cloud->scanner_count);
	for (size_t i = 0; i < cloud->scanner_count; i++) {
		lamp flash = light_default(GW_LIGHT_POINT);
		for (size_t k = 0; k < 3; k++) {
			flash.light.position[k] = cloud->scanner[3 * i + k];
			flash.light.intensity[k] = 1.0f;
		}
		GW_TRY(settings_add_light(s, &flash, error));
	}
	return GW_OK;
}

static gw_status add_sky(settings *s, gw_error *error)
{
	lamp sky = light_default(GW_LIGHT_ENVIRONMENT);
	for (size_t k = 0; k < 3; k++)
		sky.light.radiance[k] = 1.0f;
	return settings_add_light(s, &sky, error);
}

static gw_status make_setup(settings *s, settings_capture capture, const loaded_scene *scene,
							gw_error *error)
{
	bool own = capture == SETTINGS_CAPTURE_FLASH || capture == SETTINGS_CAPTURE_OVERCAST;
	if (own && s->light_count > 0)
		return gw_fail(error, GW_ERROR_USAGE,
					   "--light and --capture %s are two set-ups; give one of them",
					   capture == SETTINGS_CAPTURE_FLASH ? "flash" : "overcast");
	if (capture == SETTINGS_CAPTURE_FLASH)
		return add_flashes(s, scene, error);
	if (capture == SETTINGS_CAPTURE_OVERCAST)
		return add_sky(s, error);
	if (capture == SETTINGS_CAPTURE_INTENSITY && !scan_find_scalar(&scene->cloud, "intensity"))
		return gw_fail(error, GW_ERROR_USAGE, "the points have no laser intensity");
	if (capture == SETTINGS_CAPTURE_INTENSITY && s->remainder == SETTINGS_REMAINDER_LIGHT)
		return gw_fail(error, GW_ERROR_USAGE,
					   "--remainder light divides light out of photographs, but here the laser's "
					   "intensity is taken; name their light with --light or --capture");
	if (capture == SETTINGS_CAPTURE_AUTO ||
		(capture == SETTINGS_CAPTURE_LIGHTS && s->light_count == 0))
		return gw_fail(error, GW_ERROR_USAGE,
					   "in what light were the photographs taken? Say it with --light, or with "
					   "--capture flash or overcast");
	return GW_OK;
}

/* ------------------------------------------------------------------------------- the result */

static gw_status find_albedo(settings *s, loaded_scene *scene, gw_error *error)
{
	albedo_facts facts;
	char percent[TEXT_PERCENT];
	gw_light *light = NULL;
	settings_capture capture = find_capture(s, scene);
	GW_TRY(make_setup(s, capture, scene, error));
	bool laser = capture == SETTINGS_CAPTURE_INTENSITY;
	gw_status status = GW_OK;
	if (!laser)
		status = loaded_scene_lights(scene, s, &light, error);
	if (status == GW_OK && laser)
		status = albedo_of_laser(scene, s, &facts, error);
	else if (status == GW_OK)
		status = albedo_solve(
			scene, s, &(albedo_setup){ light, s->light_count, capture == SETTINGS_CAPTURE_FLASH },
			&facts, error);
	free(light);
	if (status == GW_OK && !s->quiet && laser && facts.how[0])
		text_message(stderr, "glowworm: intensity: %s\n", facts.how);
	if (status != GW_OK || s->quiet || laser)
		return status;
	if (albedo_stations_are_a_way(scene))
		text_message(
			stderr,
			"glowworm: note: there are %zu scanners, too many for a tripod, so they are taken "
			"for one that was carried, with one exposure in each input; where exposures "
			"differ, give each scan as a file of its own\n",
			scene->points.points.scanner_count);
	if (facts.ends > 0)
		text_message(stderr,
					 "glowworm: note: %zu point%s white or black in the photographs, as far as "
					 "these go: of those values only a bound of the albedo is known, and within it "
					 "%s that of the points around %s\n",
					 facts.ends, gw_plural(facts.ends, " is", "s are"),
					 gw_plural(facts.ends, "it has", "they have"),
					 gw_plural(facts.ends, "it", "them"));
	if (facts.dark > 0)
		text_message(stderr,
					 "glowworm: note: %zu point%s that the light of the capture does not reach: "
					 "%s the median's albedo and the chroma of %s colour\n",
					 facts.dark, gw_plural(facts.dark, "", "s"),
					 gw_plural(facts.dark, "it has", "they have"),
					 gw_plural(facts.dark, "its", "their"));
	if (facts.clipped > 0)
		text_message(
			stderr,
			"glowworm: note: %zu point%s brighter than white in that light: %s albedo is %g\n",
			facts.clipped, gw_plural(facts.clipped, "", "s"),
			gw_plural(facts.clipped, "its", "their"), (double)ALBEDO_SOLVE_MOST);
	if (s->remainder == SETTINGS_REMAINDER_LIGHT)
		text_message(stderr,
					 "glowworm: light that nobody named: %s %% of the light of the capture, in "
					 "the mean\n",
					 text_percent(facts.remainder, percent));
	text_message(stderr,
				 "glowworm: radiance 1 is colour %.4g; the albedo changed by %.2g %% in round %d, "
				 "the last\n",
				 facts.scale, 100.0 * facts.change, facts.rounds);
	return status;
}

static gw_status store_albedo(const settings *s, loaded_scene *scene, gw_error *error)
{
	scan *cloud = &scene->cloud;
	for (size_t k = 0; k < 3; k++) {
		scan_remove_column(cloud, scan_albedo_names[k]);
		scan_remove_column(cloud, scan_color_names[k]);
		scan_column *column = scan_add_column(cloud, scan_color_names[k], SCAN_UINT8, error);
		if (!column)
			return GW_ERROR_MEMORY;
		for (size_t i = 0; i < cloud->count; i++)
			((uint8_t *)column->data)[i] =
				(uint8_t)(255.0 * scan_srgb_encode((double)scene->points.albedo[3 * i + k]) + 0.5);
	}
	char text[1024];
	snprintf(text, sizeof text, "colours are the albedo, by glowworm " GW_VERSION ": %.900s",
			 s->command);
	return scan_add_comment(cloud, text, error);
}

static gw_status run(settings *s, loaded_scene *scene, output_file **output, gw_error *error)
{
	const format *to = NULL;
	GW_TRY(scene_read_all(s, error));
	quality_preset_apply(s);
	GW_TRY(check(s, &to, error));
	GW_TRY(output_file_create(output, s->output, s->force, error));
	output_file_use_threads(*output, s->bake.threads);
	GW_TRY(read_scan(s, scene, error));
	GW_TRY(find_albedo(s, scene, error));
	GW_TRY(store_albedo(s, scene, error));
	GW_TRY(output_scanners_settle(to, &scene->cloud, s->quiet, error));
	output_shift_settle_by(&s->shifting, &scene->cloud, s->quiet);
	GW_TRY(output_shift_apply(&s->shifting, &scene->cloud, error));
	GW_TRY(output_system_settle(to, &scene->cloud, s->quiet, error));
	output_columns_note(to, &scene->cloud, s->quiet);
	GW_TRY(to->write(*output, &scene->cloud, error));
	return output_file_commit(output, error);
}

gw_status verb_albedo(settings *s, gw_error *error)
{
	output_file *output = NULL;
	loaded_scene scene = { 0 };
	gw_status status = run(s, &scene, &output, error);
	output_file_abandon(&output);
	loaded_scene_clear(&scene);
	return status;
}

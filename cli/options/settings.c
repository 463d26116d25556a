#include "options/settings.h"
#include "luminaires/luminaire_reader.h"
#include "files/growing_table.h"

#include <math.h>
#include <string.h>

const char *settings_effect_name(int effect)
{
	if (effect < GW_EFFECT_KIND_COUNT)
		return gw_effect_name((gw_effect_kind)effect);
	return effect == SETTINGS_EFFECT_GLOSS    ? "gloss"
		   : effect == SETTINGS_EFFECT_MOTION ? "motion"
											  : NULL;
}

bool settings_bakes_gloss(const settings *s)
{
	return (s->effects.forbidden & 1u << SETTINGS_EFFECT_GLOSS) == 0;
}

bool settings_shows_gloss(const settings *s)
{
	const uint32_t gloss = 1u << SETTINGS_EFFECT_GLOSS;
	bool own = (s->render.effects.forced | s->render.effects.forbidden) & gloss;
	bool forbidden = (own ? s->render.effects.forbidden : s->effects.forbidden) & gloss;
	return s->render.glossy != SETTINGS_GLOSSY_OFF && !forbidden;
}

settings settings_default(void)
{
	settings s = { .bake = gw_bake_options_default(),
				   .points = SCAN_POINTS_OPTIONS_DEFAULT,
				   .opacity = -1.0f,
				   .quality = GW_QUALITY_NORMAL,
				   .count = 1000000,
				   .exposure = NAN,
				   .worst_count = 1000,
				   .page_points = 2000000,
				   .max_rel_rmse = NAN,
				   .max_best_99 = NAN,
				   .max_bias = NAN,
				   .render = { .camera = "auto",
							   .size = "1600x900",
							   .background = "0",
							   .orbit = 1,
							   .glossy = SETTINGS_GLOSSY_RAYS,
							   .glossy_rays = 32,
							   .samples = 2 } };
	s.measure_reach = 0.5f;
	s.probes = gw_probes_options_default();
	s.bake.normals = GW_NORMALS_AUTO; /* files are wrong more often than programs */
	return s;
}

static const char up_axis[SETTINGS_UP_COUNT] = { 'z', 'y', 'z', 'x', 'Y', 'Z', 'X' };

char settings_up_axis(int up)
{
	return up_axis[up];
}

const char *settings_up_name(char axis)
{
	static const char *const name[SETTINGS_UP_COUNT] = { "auto", "y", "z", "x", "-y", "-z", "-x" };
	int up = axis ? 1 : 0;
	while (axis && up + 1 < SETTINGS_UP_COUNT && up_axis[up] != axis)
		up++;
	return name[up];
}

void settings_clear(settings *s)
{
	for (size_t i = 0; i < s->input_count; i++)
		free(s->input[i].path);
	for (size_t i = 0; i < s->text_count; i++)
		free(s->text[i]);
	for (size_t i = 0; i < s->path_count; i++)
		motion_path_clear(&s->path[i]);
	free(s->path);
	free(s->input);
	free(s->light);
	for (size_t i = 0; i < s->luminaire_count; i++) {
		luminaire_clear(s->luminaire[i]);
		free(s->luminaire[i]);
	}
	free(s->luminaire);
	free(s->scanner);
	free(s->gain);
	free(s->view);
	free(s->text);
	free(s->command);
	*s = settings_default();
}

gw_status settings_add_input(settings *s, const settings_input *input, gw_error *error)
{
	settings_input *grown = growing_table_room(s->input, s->input_count, sizeof *grown);
	if (grown)
		s->input = grown;
	char *path = strdup(input->path);
	if (!grown || !path) {
		free(path);
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the list of inputs");
	}
	s->input[s->input_count] = *input;
	s->input[s->input_count++].path = path;
	return GW_OK;
}

gw_status settings_add_light(settings *s, const lamp *light, gw_error *error)
{
	lamp *grown = growing_table_room(s->light, s->light_count, sizeof *grown);
	if (!grown)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the list of lights");
	s->light = grown;
	s->light[s->light_count++] = *light;
	return GW_OK;
}

static gw_status read_luminaire(settings *s, const char *path, const luminaire **read,
								gw_error *error)
{
	luminaire **grown = growing_table_room(s->luminaire, s->luminaire_count, sizeof *grown);
	if (grown)
		s->luminaire = grown;
	luminaire *own = malloc(sizeof *own);
	if (!grown || !own) {
		free(own);
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the list of luminaires");
	}
	gw_status status = luminaire_read(path, own, error);
	if (status != GW_OK) {
		free(own);
		return status;
	}
	*read = s->luminaire[s->luminaire_count++] = own;
	return GW_OK;
}

gw_status settings_read_luminaires(settings *s, gw_error *error)
{
	for (size_t i = 0; i < s->light_count; i++) {
		lamp *light = &s->light[i];
		for (size_t j = 0; j < i && light->ies[0] && !light->luminaire; j++)
			if (strcmp(light->ies, s->light[j].ies) == 0)
				light->luminaire = s->light[j].luminaire;
		if (light->ies[0] && !light->luminaire)
			GW_TRY(read_luminaire(s, light->ies, &light->luminaire, error));
		if (light->luminaire)
			GW_TRY(light_check_luminaire(light, error));
		if (light->luminaire)
			light->flux = luminaire_lumens(light->luminaire);
	}
	return GW_OK;
}

gw_status settings_add_scanner(settings *s, const double place[3], gw_error *error)
{
	if (s->scanner_none)
		return GW_OK;
	double *grown = growing_table_room(s->scanner, s->scanner_count, 3 * sizeof *grown);
	if (!grown)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the list of scanners");
	s->scanner = grown;
	memcpy(grown + 3 * s->scanner_count++, place, 3 * sizeof *place);
	return GW_OK;
}

void settings_set_scanner_none(settings *s)
{
	s->scanner_count = 0;
	s->scanner_none = true;
}

gw_status settings_add_path(settings *s, motion_path *path, size_t *number, gw_error *error)
{
	motion_path *grown = growing_table_room(s->path, s->path_count, sizeof *grown);
	if (!grown)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the list of paths");
	s->path = grown;
	s->path[s->path_count++] = *path;
	*path = (motion_path){ 0 };
	*number = s->path_count;
	return GW_OK;
}

gw_status settings_add_gain(settings *s, const settings_gain *gain, gw_error *error)
{
	settings_gain *grown = growing_table_room(s->gain, s->gain_count, sizeof *grown);
	if (!grown)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the list of gains");
	s->gain = grown;
	s->gain[s->gain_count++] = *gain;
	return GW_OK;
}

gw_status settings_add_view(settings *s, const char *text, gw_error *error)
{
	const char **grown = growing_table_room(s->view, s->view_count, sizeof *grown);
	if (!grown)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the list of cameras");
	s->view = grown;
	const char *kept = settings_keep(s, text, error);
	if (kept)
		s->view[s->view_count++] = kept;
	return kept ? GW_OK : GW_ERROR_MEMORY;
}

const char *settings_keep(settings *s, const char *text, gw_error *error)
{
	char **grown = growing_table_room(s->text, s->text_count, sizeof *grown);
	if (grown)
		s->text = grown;
	char *copy = strdup(text);
	if (!grown || !copy) {
		free(copy);
		gw_fail(error, GW_ERROR_MEMORY, "no memory for an option's text");
		return NULL;
	}
	return s->text[s->text_count++] = copy;
}

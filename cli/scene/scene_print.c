/*
 * The scene with all values in effect, as a scene file.
 */
#include "files/number_text.h"
#include "options/options.h"
#include "scene/scene_file.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

/* A colour as three numbers; with its unit behind them, in a text, where one was said. */
static void write_color(json_writer *json, light_key_id id, light_units units, const float color[3])
{
	const char *unit = light_unit_name(light_key_quantity(id), units), *name = light_keys[id].name;
	char text[3 * NUMBER_TEXT + 16], number[3][NUMBER_TEXT];
	if (!*unit) {
		json_put_singles(json, name, color, 3);
		return;
	}
	for (int k = 0; k < 3; k++)
		number_print_float(number[k], color[k]);
	snprintf(text, sizeof text, "%s,%s,%s%s", number[0], number[1], number[2], unit);
	json_put_text(json, name, text);
}

/* What only a sky with a model has. */
static void write_sky_key(json_writer *json, const lamp *light, light_key_id id)
{
	const double sun[2] = { light->azimuth + light->north, light->elevation };
	const char *name = light_keys[id].name;
	if (id == LIGHT_KEY_MODEL)
		json_put_text(json, name, sky_model_name(light->model));
	else if (id == LIGHT_KEY_SKY && sky_model_has_sun(light->model))
		json_put_reals(json, name, sun, 2);
	else if (id == LIGHT_KEY_TURBIDITY && light->model == SKY_MODEL_PHYSICAL)
		json_put_real(json, name, light->turbidity);
	else if (id == LIGHT_KEY_HORIZON && light->model == SKY_MODEL_GRADIENT)
		write_color(json, id, light->units, light->horizon);
}

/* As what a sky's brightness is written: it is worked out, but for that of a model or a map that is
 * to give an illuminance. */
static void write_sky_amount(json_writer *json, const lamp *light, light_key_id id)
{
	bool itself = light->model || light->map[0];
	light_key_id as = itself && light->measure == LIGHT_KEY_ILLUMINANCE   ? LIGHT_KEY_ILLUMINANCE
					  : light->model && light->measure == LIGHT_KEY_COUNT ? LIGHT_KEY_COUNT
																		  : LIGHT_KEY_RADIANCE;
	if (id != as)
		return;
	float color[3];
	light_color(light, color);
	write_color(json, id, light->units, id == LIGHT_KEY_RADIANCE ? light->light.radiance : color);
}

static void write_key(json_writer *json, const lamp *light, light_key_id id)
{
	const gw_light *l = &light->light;
	const char *name = light_keys[id].name;
	switch (id) {
	case LIGHT_KEY_POSITION:
		json_put_reals(json, name, l->position, 3);
		break;
	case LIGHT_KEY_DIRECTION:
		if (l->type != GW_LIGHT_POINT || light->luminaire)
			json_put_reals(json, name, l->direction, 3);
		break;
	case LIGHT_KEY_IES:
		if (light->ies[0])
			json_put_text(json, name, light->ies);
		break;
	case LIGHT_KEY_ROLL:
		if (light->luminaire || l->type == GW_LIGHT_RECTANGLE)
			json_put_real(json, name, light->roll);
		break;
	case LIGHT_KEY_SIZE:
		json_put_singles(json, name, l->size, 2);
		break;
	case LIGHT_KEY_INTENSITY:
		write_color(json, id, light->units, l->intensity);
		break;
	case LIGHT_KEY_IRRADIANCE:
		write_color(json, id, light->units, l->irradiance);
		break;
	case LIGHT_KEY_RADIANCE:
	case LIGHT_KEY_ILLUMINANCE:
		if (l->type == GW_LIGHT_ENVIRONMENT)
			write_sky_amount(json, light, id);
		break;
	case LIGHT_KEY_MODEL:
	case LIGHT_KEY_TURBIDITY:
	case LIGHT_KEY_HORIZON:
	case LIGHT_KEY_SKY:
		if (light->model)
			write_sky_key(json, light, id);
		break;
	case LIGHT_KEY_MAP:
		if (light->map[0])
			json_put_text(json, name, light->map);
		break;
	case LIGHT_KEY_ROTATION:
		if (light->map[0])
			json_put_single(json, name, l->rotation);
		break;
	case LIGHT_KEY_INNER:
		json_put_single(json, name, l->inner_angle);
		break;
	case LIGHT_KEY_OUTER:
		json_put_single(json, name, l->outer_angle);
		break;
	case LIGHT_KEY_RADIUS:
		json_put_single(json, name, l->radius);
		break;
	case LIGHT_KEY_ANGLE:
		json_put_single(json, name, l->angle);
		break;
	case LIGHT_KEY_NAME:
		if (l->name[0])
			json_put_text(json, name, l->name);
		break;
	case LIGHT_KEY_GROUP:
		if (light->group[0])
			json_put_text(json, name, light->group);
		break;
	case LIGHT_KEY_TARGET: /* what these say, others have: directions and colours */
	case LIGHT_KEY_PLACE:
	case LIGHT_KEY_TIME:
	case LIGHT_KEY_NORTH:
	case LIGHT_KEY_LUMENS:
	case LIGHT_KEY_WATTS:
	case LIGHT_KEY_KELVIN:
	case LIGHT_KEY_SCALE:
	case LIGHT_KEY_DISTANCE:
	case LIGHT_KEY_COUNT:
		break;
	}
}

/* A value of an input's keyframe, or of a light's. */
static void write_value(json_writer *json, const motion_key *key, int which, bool of_light)
{
	static const char *const name[MOTION_VALUES] = { "move", "rotate", "scale" };
	assert(of_light || which < MOTION_VALUES);
	bool one = of_light ? light_keys[which].value == LIGHT_VALUE_NUMBER : which == MOTION_SCALE;
	const char *own = of_light ? light_keys[which].name : name[which];
	bool pair = of_light && light_keys[which].value == LIGHT_VALUE_SKY;
	if (one)
		json_put_real(json, own, key->value[which][0]);
	else
		json_put_reals(json, own, key->value[which], pair ? 2 : 3);
}

static void write_path(json_writer *json, const motion_path *path, bool of_light)
{
	if (path->matrix_count > 0) {
		json_put_open_flat(json, "matrices", '[');
		for (size_t i = 0; i < path->matrix_count; i++)
			json_put_reals(json, NULL, path->matrix + 16 * i, 16);
		json_put_close(json, ']');
		return;
	}
	if (path->smooth)
		json_put_text(json, "interpolation", "smooth");
	if (path->has_pivot)
		json_put_reals(json, "pivot", path->pivot, 3);
	json_put_open_flat(json, "path", '[');
	for (size_t i = 0; i < path->key_count; i++) {
		json_put_open_flat(json, NULL, '{');
		json_put_count(json, "frame", path->key[i].frame);
		for (int which = 0; which < LIGHT_KEY_COUNT; which++)
			if (path->key[i].given & 1u << which)
				write_value(json, &path->key[i], which, of_light);
		json_put_close(json, '}');
	}
	json_put_close(json, ']');
}

static void write_lights(json_writer *json, const settings *s)
{
	json_put_open(json, "lights", '[');
	for (size_t i = 0; i < s->light_count; i++) {
		const gw_light *l = &s->light[i].light;
		json_put_open_flat(json, NULL, '{');
		json_put_text(json, "type", gw_light_type_name(l->type));
		for (int k = 0; k < LIGHT_KEY_COUNT; k++)
			if (light_keys[k].types & 1u << l->type)
				write_key(json, &s->light[i], (light_key_id)k);
		if (s->light[i].motion > 0)
			write_path(json, &s->path[s->light[i].motion - 1], true);
		json_put_close(json, '}');
	}
	json_put_close(json, ']');
}

/* A number stays a number, a flag a flag; words and sizes are texts. */
static void write_option(json_writer *json, const option *o, const settings *s)
{
	char key[64], text[OPTION_VALUE];
	double value;
	option_key(o, key);
	if (!option_print(o, s, text))
		return;
	bool number = o->type == OPTION_COUNT || o->type == OPTION_REAL || o->type == OPTION_SEED;
	if (number && number_read(text, strlen(text), &value) == strlen(text) &&
		(o->type != OPTION_SEED || value < 0x1p53))
		json_put_real(json, key, value);
	else
		json_put_text(json, key, text);
}

void scene_write_members(json_writer *json, const settings *s)
{
	json_put_text(json, "units",
				  s->units == LIGHT_UNITS_PHOTOMETRIC ? "photometric" : "radiometric");
	if (s->frame_count > 0)
		json_put_count(json, "frames", s->frame_count);
	write_lights(json, s);
	if (s->scanner_none)
		json_put_text(json, "scanners", "none");
	if (s->scanner_count > 0)
		json_put_open(json, "scanners", '[');
	for (size_t i = 0; i < s->scanner_count; i++)
		json_put_reals(json, NULL, s->scanner + 3 * i, 3);
	if (s->scanner_count > 0)
		json_put_close(json, ']');
	json_put_open(json, "bake", '{');
	for (const option *o = options; o->name; o++)
		if (o->scene)
			write_option(json, o, s);
	json_put_close(json, '}');
}

void scene_write(FILE *out, const settings *s)
{
	json_writer json = { .out = out, .lines = true };
	json_put_open(&json, NULL, '{');
	json_put_count(&json, "version", 1);
	json_put_open(&json, "inputs", '[');
	for (size_t i = 0; i < s->input_count; i++) {
		const settings_input *input = &s->input[i];
		json_put_open_flat(&json, NULL, '{');
		json_put_text(&json, "file", input->path);
		const motion_path *path = input->motion > 0 ? &s->path[input->motion - 1] : NULL;
		if (path)
			write_path(&json, path, false);
		if (input->has_matrix && !(path && path->matrix_count > 0))
			json_put_reals(&json, "matrix", input->matrix, 16);
		if (input->has_emission)
			json_put_singles(&json, "emission", input->emission, 3);
		if (input->has_albedo)
			json_put_singles(&json, "albedo", input->albedo, 3);
		if (input->has_opacity)
			json_put_single(&json, "opacity", input->opacity);
		if (input->has_specular)
			json_put_single(&json, "specular", input->specular);
		if (input->has_roughness)
			json_put_single(&json, "roughness", input->roughness);
		if (input->mesh || input->vertices)
			json_put_bool(&json, "mesh", input->mesh);
		if (input->density > 0.0f)
			json_put_single(&json, "density", input->density);
		json_put_close(&json, '}');
	}
	json_put_close(&json, ']');
	scene_write_members(&json, s);
	json_put_close(&json, '}');
	fputc('\n', out);
}

#include "options/light_text.h"
#include "program/nearest_name.h"
#include "program/words.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define POINT (1u << GW_LIGHT_POINT)
#define SPOT (1u << GW_LIGHT_SPOT)
#define SUN (1u << GW_LIGHT_SUN)
#define SKY (1u << GW_LIGHT_ENVIRONMENT)

const light_key light_keys[LIGHT_KEY_COUNT] = {
	[LIGHT_KEY_POSITION] = { "at", "position", LIGHT_VALUE_VECTOR, POINT | SPOT, POINT | SPOT,
							 "X,Y,Z: where it is, in the input's coordinates" },
	[LIGHT_KEY_TARGET] = { "to", NULL, LIGHT_VALUE_VECTOR, SPOT, 0, "X,Y,Z: a point on its axis" },
	[LIGHT_KEY_DIRECTION] = { "toward", "direction", LIGHT_VALUE_VECTOR, SPOT | SUN, 0,
							  "X,Y,Z: the way the light travels" },
	[LIGHT_KEY_SKY] = { "from", NULL, LIGHT_VALUE_SKY, SUN, 0,
						"AZIMUTH,ELEVATION in degrees: clockwise from +y, above the horizon" },
	[LIGHT_KEY_INTENSITY] = { NULL, "intensity", LIGHT_VALUE_COLOR, POINT | SPOT, POINT | SPOT,
							  "W/sr or cd" },
	[LIGHT_KEY_IRRADIANCE] = { NULL, "irradiance", LIGHT_VALUE_COLOR, SUN, SUN,
							   "W/m^2 or lx on a plane that faces it" },
	[LIGHT_KEY_RADIANCE] = { NULL, "radiance", LIGHT_VALUE_COLOR, SKY, 0,
							 "W/(sr m^2) or cd/m^2, the same from everywhere, or times the map" },
	[LIGHT_KEY_MAP] = { NULL, "map", LIGHT_VALUE_PATH, SKY, 0,
						"EXR or HDR file, longitude by latitude; its centre is toward +y" },
	[LIGHT_KEY_ROTATION] = { NULL, "rotation", LIGHT_VALUE_ANGLE, SKY, 0,
							 "degrees the map is turned clockwise, seen from above; 0" },
	[LIGHT_KEY_INNER] = { "inner", "inner_angle", LIGHT_VALUE_NUMBER, SPOT, 0,
						  "degrees from the axis up to which it is at its full; 0" },
	[LIGHT_KEY_OUTER] = { "outer", "outer_angle", LIGHT_VALUE_NUMBER, SPOT, 0,
						  "degrees from the axis at which it ends; 45" },
	[LIGHT_KEY_RADIUS] = { NULL, "radius", LIGHT_VALUE_NUMBER, POINT | SPOT, 0,
						   "metres; makes soft shadows; 0" },
	[LIGHT_KEY_ANGLE] = { NULL, "angle", LIGHT_VALUE_NUMBER, SUN, 0,
						  "degrees, its diameter in the sky; 0.53" },
	[LIGHT_KEY_NAME] = { NULL, "name", LIGHT_VALUE_NAME, POINT | SPOT | SUN | SKY, 0,
						 "one word, for the report" },
};

gw_light_type light_type_by_name(const char *word)
{
	if (strcmp(word, "sky") == 0)
		return GW_LIGHT_ENVIRONMENT;
	int type = 0;
	while (type < GW_LIGHT_TYPE_COUNT && strcmp(word, gw_light_type_name((gw_light_type)type)) != 0)
		type++;
	return (gw_light_type)type;
}

static void list_name(char *text, size_t size, const char *name)
{
	size_t used = strlen(text);
	if (used < size)
		snprintf(text + used, size - used, "%s%s", used ? ", " : "", name);
}

void light_list_types(char *text, size_t size)
{
	text[0] = '\0';
	for (int type = 0; type < GW_LIGHT_TYPE_COUNT; type++)
		list_name(text, size, gw_light_type_name((gw_light_type)type));
	list_name(text, size, "sky");
}

static const char *key_name(const light_key *key, bool scene)
{
	if (scene)
		return key->name;
	return key->word ? key->word : key->name;
}

/* Writes the names of a type's keys (scene: the scene file's), for messages. */
static void list_keys(gw_light_type type, bool scene, char *text, size_t size)
{
	text[0] = '\0';
	for (int k = 0; k < LIGHT_KEY_COUNT; k++) {
		const char *name = key_name(&light_keys[k], scene);
		if (name && light_keys[k].types & 1u << type)
			list_name(text, size, name);
	}
}

lamp light_default(gw_light_type type)
{
	float sky = type == GW_LIGHT_ENVIRONMENT ? 1.0f : 0.0f;
	return (lamp){ .light = { .type = type,
							  .outer_angle = type == GW_LIGHT_SPOT ? 45.0f : 0.0f,
							  .angle = type == GW_LIGHT_SUN ? 0.53f : 0.0f,
							  .radiance = { sky, sky, sky } } };
}

/* ---------------------------------------------------------------------------- one key */

static void set_color(float color[3], const double *values, size_t count)
{
	for (size_t k = 0; k < 3; k++)
		color[k] = (float)values[count == 3 ? k : 0];
}

static void set_vector(double vector[3], const double *values)
{
	memcpy(vector, values, 3 * sizeof *vector);
}

static gw_status check_numbers(light_value value, const double *values, size_t count,
							   gw_error *error)
{
	for (size_t k = 0; k < count; k++) {
		bool positive = value == LIGHT_VALUE_COLOR || value == LIGHT_VALUE_NUMBER;
		if (!isfinite(values[k]) || !isfinite((float)values[k]))
			return gw_fail(error, GW_ERROR_USAGE, "a number of finite size is needed");
		if (positive && values[k] < 0.0)
			return gw_fail(error, GW_ERROR_USAGE, "it must be 0 or more");
	}
	if (value == LIGHT_VALUE_SKY && fabs(values[1]) > 90.0)
		return gw_fail(error, GW_ERROR_USAGE, "the elevation must be from -90 to 90 degrees");
	return GW_OK;
}

gw_status light_set(lamp *light, light_key_id key, const double *values, size_t count,
					gw_error *error)
{
	gw_light *l = &light->light;
	GW_TRY(check_numbers(light_keys[key].value, values, count, error));
	switch (key) {
	case LIGHT_KEY_POSITION:
		set_vector(l->position, values);
		break;
	case LIGHT_KEY_TARGET:
		light->aimed = true;
		set_vector(light->target, values);
		break;
	case LIGHT_KEY_DIRECTION:
		if (values[0] == 0.0 && values[1] == 0.0 && values[2] == 0.0)
			return gw_fail(error, GW_ERROR_USAGE, "0,0,0 is no direction");
		set_vector(l->direction, values);
		break;
	case LIGHT_KEY_SKY:
		light->from_sky = true;
		light->azimuth = values[0];
		light->elevation = values[1];
		break;
	case LIGHT_KEY_INTENSITY:
		set_color(l->intensity, values, count);
		break;
	case LIGHT_KEY_IRRADIANCE:
		set_color(l->irradiance, values, count);
		break;
	case LIGHT_KEY_RADIANCE:
		set_color(l->radiance, values, count);
		break;
	case LIGHT_KEY_INNER:
		l->inner_angle = (float)values[0];
		break;
	case LIGHT_KEY_OUTER:
		l->outer_angle = (float)values[0];
		break;
	case LIGHT_KEY_RADIUS:
		l->radius = (float)values[0];
		break;
	case LIGHT_KEY_ANGLE:
		l->angle = (float)values[0];
		break;
	case LIGHT_KEY_ROTATION:
		l->rotation = (float)values[0];
		break;
	case LIGHT_KEY_MAP:
	case LIGHT_KEY_NAME:
	case LIGHT_KEY_COUNT:
		break;
	}
	return GW_OK;
}

gw_status light_set_text(lamp *light, light_key_id key, const char *text, gw_error *error)
{
	char *to = key == LIGHT_KEY_MAP ? light->map : light->light.name;
	size_t room = key == LIGHT_KEY_MAP ? sizeof light->map : sizeof light->light.name;
	if (!*text)
		return gw_fail(error, GW_ERROR_USAGE, "it must not be empty");
	if (strlen(text) >= room)
		return gw_fail(error, GW_ERROR_USAGE, "it is too long; %zu bytes are the most", room - 1);
	memcpy(to, text, strlen(text) + 1);
	return GW_OK;
}

/* ------------------------------------------------------------------------- the whole light */

static gw_status check_direction(const lamp *light, unsigned given, bool scene, gw_error *error)
{
	unsigned any =
		given & (1u << LIGHT_KEY_DIRECTION | 1u << LIGHT_KEY_TARGET | 1u << LIGHT_KEY_SKY);
	const char *type = gw_light_type_name(light->light.type);
	const char *other = light->light.type == GW_LIGHT_SUN ? "'from'" : "'to'";
	if (!any)
		return gw_fail(error, GW_ERROR_USAGE, "a %s needs %s%s", type,
					   scene ? "'direction'" : "'toward' or ", scene ? "" : other);
	if (any & (any - 1))
		return gw_fail(error, GW_ERROR_USAGE, "a %s takes one of 'toward' and %s, not both", type,
					   other);
	if (light->aimed && memcmp(light->target, light->light.position, sizeof light->target) == 0)
		return gw_fail(error, GW_ERROR_USAGE, "a spot cannot shine to the place where it is");
	return GW_OK;
}

gw_status light_check(const lamp *light, unsigned given, bool scene, gw_error *error)
{
	const gw_light *l = &light->light;
	for (int k = 0; k < LIGHT_KEY_COUNT; k++)
		if (light_keys[k].needed & 1u << l->type && !(given & 1u << k))
			return gw_fail(error, GW_ERROR_USAGE, "a %s light needs '%s'",
						   gw_light_type_name(l->type), key_name(&light_keys[k], scene));
	if (l->type == GW_LIGHT_ENVIRONMENT &&
		!(given & (1u << LIGHT_KEY_RADIANCE | 1u << LIGHT_KEY_MAP)))
		return gw_fail(error, GW_ERROR_USAGE, "an environment light needs 'radiance' or 'map'");
	if (given & 1u << LIGHT_KEY_ROTATION && !(given & 1u << LIGHT_KEY_MAP))
		return gw_fail(error, GW_ERROR_USAGE, "only a 'map' can have a 'rotation'");
	if (l->type == GW_LIGHT_SPOT && l->outer_angle > 180.0f)
		return gw_fail(error, GW_ERROR_USAGE, "the outer angle is %g degrees; 180 is all around",
					   (double)l->outer_angle);
	if (l->type == GW_LIGHT_SPOT && l->inner_angle > l->outer_angle)
		return gw_fail(error, GW_ERROR_USAGE,
					   "the inner angle of %g degrees is larger than the outer one of %g",
					   (double)l->inner_angle, (double)l->outer_angle);
	if (l->type == GW_LIGHT_SUN && l->angle > 180.0f)
		return gw_fail(error, GW_ERROR_USAGE, "a sun %g degrees wide is no sun; use an environment",
					   (double)l->angle);
	if (l->type == GW_LIGHT_SPOT || l->type == GW_LIGHT_SUN)
		return check_direction(light, given, scene, error);
	return GW_OK;
}

void light_resolve(lamp *light, char up)
{
	gw_light *l = &light->light;
	l->map_y_up = up == 'y';
	if (light->aimed)
		for (int k = 0; k < 3; k++)
			l->direction[k] = light->target[k] - l->position[k];
	if (!light->from_sky)
		return;
	const double degree = acos(-1.0) / 180.0;
	double a = light->azimuth * degree, e = light->elevation * degree;
	double east = sin(a) * cos(e), north = cos(a) * cos(e), height = sin(e);
	/* From 0, so that no -0 comes out. */
	l->direction[0] = 0.0 - east;
	l->direction[1] = 0.0 - (up == 'y' ? height : north);
	l->direction[2] = up == 'y' ? north : 0.0 - height;
}

/* -------------------------------------------------------------------------------- words */

static gw_status set_from_word(words *w, lamp *light, light_key_id id, const char *key)
{
	static const struct {
		const char *expected;
		unsigned counts; /* 1 << n for each number of values allowed */
	} shape[] = {
		[LIGHT_VALUE_VECTOR] = { "three numbers X,Y,Z", 1u << 3 },
		[LIGHT_VALUE_COLOR] = { "a colour R,G,B or one number", 1u << 3 | 1u << 1 },
		[LIGHT_VALUE_SKY] = { "two numbers AZIMUTH,ELEVATION", 1u << 2 },
		[LIGHT_VALUE_NUMBER] = { "one number", 1u << 1 },
		[LIGHT_VALUE_ANGLE] = { "one number", 1u << 1 },
		[LIGHT_VALUE_NAME] = { "a name", 0 },
		[LIGHT_VALUE_PATH] = { "a file", 0 },
	};
	light_value value = light_keys[id].value;
	char sentence[GW_ERROR_TEXT];
	if (!words_next(w)) {
		snprintf(sentence, sizeof sentence, "'%s' wants %s behind it", key, shape[value].expected);
		return words_fail(w, sentence);
	}
	gw_error reason = { 0 };
	if (value == LIGHT_VALUE_NAME || value == LIGHT_VALUE_PATH) {
		if (light_set_text(light, id, w->word, &reason) == GW_OK && strlen(w->word) < WORD_MAX - 1)
			return GW_OK;
		snprintf(sentence, sizeof sentence, "the %s is too long; %d characters are the most", key,
				 value == LIGHT_VALUE_NAME ? 63 : WORD_MAX - 2);
		return words_fail(w, sentence);
	}
	double values[3] = { 0 };
	size_t count = words_numbers(w->word, values);
	if (!(shape[value].counts & 1u << count) || count == 0)
		snprintf(sentence, sizeof sentence, "'%.60s', where '%s' wants %s without blanks", w->word,
				 key, shape[value].expected);
	else if (light_set(light, id, values, count, &reason) != GW_OK)
		snprintf(sentence, sizeof sentence, "%.40s is %.60s: %.700s", key, w->word, reason.text);
	else
		return GW_OK;
	return words_fail(w, sentence);
}

/* Which key of this type a word names; LIGHT_KEY_COUNT and a message when none. */
static light_key_id find_key(const words *w, gw_light_type type)
{
	const char *name[2 * LIGHT_KEY_COUNT] = { NULL };
	for (int k = 0; k < LIGHT_KEY_COUNT; k++) {
		const light_key *key = &light_keys[k];
		if (!(key->types & 1u << type))
			continue;
		if ((key->word && strcmp(w->word, key->word) == 0) ||
			(key->name && strcmp(w->word, key->name) == 0))
			return (light_key_id)k;
		name[2 * k] = key->word;
		name[2 * k + 1] = key->name;
	}
	char sentence[GW_ERROR_TEXT], known[256], hint[NEAREST_NAME_HINT];
	list_keys(type, false, known, sizeof known);
	nearest_name_hint(hint, w->word, "", name, 2 * LIGHT_KEY_COUNT);
	snprintf(sentence, sizeof sentence, "a %s light has no '%.60s'; it has %s%s",
			 gw_light_type_name(type), w->word, known, hint);
	words_fail(w, sentence);
	return LIGHT_KEY_COUNT;
}

static gw_status find_type(words *w, gw_light_type *type)
{
	char sentence[GW_ERROR_TEXT], known[128], hint[NEAREST_NAME_HINT];
	const char *name[GW_LIGHT_TYPE_COUNT + 1] = { [GW_LIGHT_TYPE_COUNT] = "sky" };
	bool any = words_next(w);
	*type = light_type_by_name(w->word);
	if (*type != GW_LIGHT_TYPE_COUNT)
		return GW_OK;
	for (int t = 0; t < GW_LIGHT_TYPE_COUNT; t++)
		name[t] = gw_light_type_name((gw_light_type)t);
	light_list_types(known, sizeof known);
	nearest_name_hint(hint, w->word, "", name, GW_LIGHT_TYPE_COUNT + 1);
	if (any)
		snprintf(sentence, sizeof sentence, "there is no light '%.60s'; there are %s%s", w->word,
				 known, hint);
	else
		snprintf(sentence, sizeof sentence, "a light begins with its type: %s", known);
	return words_fail(w, sentence);
}

gw_status light_from_text(const char *text, lamp *out, gw_error *error)
{
	words w = words_of("--light", text, error);
	gw_light_type type;
	unsigned given = 0;
	GW_TRY(find_type(&w, &type));
	*out = light_default(type);
	while (words_next(&w)) {
		light_key_id id = find_key(&w, type);
		if (id == LIGHT_KEY_COUNT)
			return GW_ERROR_USAGE;
		if (given & 1u << id)
			return words_fail(&w, "this has been said before");
		given |= 1u << id;
		char key[WORD_MAX];
		memcpy(key, w.word, sizeof key);
		GW_TRY(set_from_word(&w, out, id, key));
	}
	gw_error reason = { 0 };
	if (light_check(out, given, false, &reason) != GW_OK)
		return words_fail(&w, reason.text);
	return GW_OK;
}

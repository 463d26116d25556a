/* light_keys.c - the keys of lights, and what they mean together; see light_text.h. */
#include "lamps/light_text.h"
#include "glowworm_host.h"

#include "glowworm_picture.h"
#include "files/number_text.h"
#include "program/words.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define PI 3.14159265358979323846
#define DEGREE (PI / 180.0)

/* Widths of lamps, metres; the library also refuses what is too narrow or too wide for the scene.
 */
#define EXTENT_LEAST 1e-25
#define EXTENT_MOST 1e25

#define POINT (1u << GW_LIGHT_POINT)
#define SPOT (1u << GW_LIGHT_SPOT)
#define SUN (1u << GW_LIGHT_SUN)
#define SKY (1u << GW_LIGHT_ENVIRONMENT)
#define SPHERE (1u << GW_LIGHT_SPHERE)
#define DISC (1u << GW_LIGHT_DISC)
#define RECTANGLE (1u << GW_LIGHT_RECTANGLE)
#define AREA (SPHERE | DISC | RECTANGLE)

#define BIT(key) (1u << LIGHT_KEY_##key)

const light_key light_keys[LIGHT_KEY_COUNT] = {
	[LIGHT_KEY_POSITION] = { "at", "position", LIGHT_VALUE_VECTOR, POINT | SPOT | AREA,
							 POINT | SPOT | AREA,
							 "X,Y,Z: where it is, in the input's coordinates; or scanner:N, "
							 "floor:N" },
	[LIGHT_KEY_TARGET] = { "to", NULL, LIGHT_VALUE_VECTOR, POINT | SPOT | DISC | RECTANGLE, 0,
						   "X,Y,Z: a point on its axis; or scanner:N, floor:N" },
	[LIGHT_KEY_DIRECTION] = { "toward", "direction", LIGHT_VALUE_VECTOR,
							  POINT | SPOT | SUN | DISC | RECTANGLE, 0,
							  "X,Y,Z: the way the light travels" },
	[LIGHT_KEY_IES] = { NULL, "ies", LIGHT_VALUE_PATH, POINT | DISC | RECTANGLE, 0,
						"IES or EULUMDAT file: how it shines, and its size; down unless aimed" },
	[LIGHT_KEY_ROLL] = { NULL, "roll", LIGHT_VALUE_ANGLE, POINT | DISC | RECTANGLE, 0,
						 "degrees it is turned clockwise, seen from behind; 0: C 0, W is right" },
	[LIGHT_KEY_SCALE] = { NULL, "scale", LIGHT_VALUE_NUMBER, POINT | DISC | RECTANGLE, 0,
						  "times the light that the file says; 1" },
	[LIGHT_KEY_SKY] = { "from", "from", LIGHT_VALUE_SKY, SUN | SKY, 0,
						"AZIMUTH,ELEVATION of the sun, degrees clockwise from +y, up" },
	[LIGHT_KEY_PLACE] = { NULL, "place", LIGHT_VALUE_PLACE, SUN | SKY, 0,
						  "LATITUDE,LONGITUDE of the scan; with time: where the sun is" },
	[LIGHT_KEY_TIME] = { NULL, "time", LIGHT_VALUE_TIME, SUN | SKY, 0,
						 "as 2026-06-21T14:30+02:00, or with Z for UTC; with place" },
	[LIGHT_KEY_NORTH] = { NULL, "north", LIGHT_VALUE_ANGLE, SUN | SKY, 0,
						  "degrees clockwise from +y in which north lies; 0" },
	[LIGHT_KEY_INTENSITY] = { NULL, "intensity", LIGHT_VALUE_COLOR, POINT | SPOT | AREA, 0,
							  "W/sr or cd, along its axis, or the most of an ies; or else" },
	[LIGHT_KEY_LUMENS] = { NULL, "lumens", LIGHT_VALUE_COLOR, POINT | SPOT | AREA, 0,
						   "lm, luminous flux over all directions; or else" },
	[LIGHT_KEY_WATTS] = { NULL, "watts", LIGHT_VALUE_COLOR, POINT | SPOT | AREA, 0,
						  "W of light, radiant flux over all directions" },
	[LIGHT_KEY_IRRADIANCE] = { NULL, "irradiance", LIGHT_VALUE_COLOR, SUN, 0,
							   "W/m^2 or lx on a plane that faces it" },
	[LIGHT_KEY_RADIANCE] = { NULL, "radiance", LIGHT_VALUE_COLOR, SKY | AREA, 0,
							 "W/(sr m^2) or cd/m^2; of a model at its zenith; of a map a factor" },
	[LIGHT_KEY_ILLUMINANCE] = { NULL, "illuminance", LIGHT_VALUE_COLOR, SUN | SKY, 0,
								"lx, of a sun on a plane that faces it, of a sky on level ground" },
	[LIGHT_KEY_KELVIN] = { NULL, "kelvin", LIGHT_VALUE_NUMBER, POINT | SPOT | SUN | SKY | AREA, 0,
						   "colour temperature, 1000 to 40000; luminance stays" },
	[LIGHT_KEY_MODEL] = { NULL, "model", LIGHT_VALUE_MODEL, SKY, 0,
						  "overcast, intermediate, clear, physical or gradient" },
	[LIGHT_KEY_TURBIDITY] = { NULL, "turbidity", LIGHT_VALUE_NUMBER, SKY, 0,
							  "of a physical sky: 2, very clear, to 10, hazy; 3" },
	[LIGHT_KEY_HORIZON] = { NULL, "horizon", LIGHT_VALUE_COLOR, SKY, 0,
							"radiance of a gradient at the horizon" },
	[LIGHT_KEY_MAP] = { NULL, "map", LIGHT_VALUE_PATH, SKY, 0,
						"EXR or HDR file, longitude by latitude; its centre is toward +y" },
	[LIGHT_KEY_ROTATION] = { NULL, "rotation", LIGHT_VALUE_ANGLE, SKY, 0,
							 "degrees the map is turned clockwise, seen from above; 0" },
	[LIGHT_KEY_INNER] = { "inner", "inner_angle", LIGHT_VALUE_NUMBER, SPOT, 0,
						  "degrees from the axis up to which it is at its full; 0" },
	[LIGHT_KEY_OUTER] = { "outer", "outer_angle", LIGHT_VALUE_NUMBER, SPOT, 0,
						  "degrees from the axis at which it ends; 45" },
	[LIGHT_KEY_DISTANCE] = { NULL, "distance", LIGHT_VALUE_NUMBER, SPOT, 0,
							 "metres at which its middle gives 0.25 lx; with lumens it has a "
							 "cone" },
	[LIGHT_KEY_RADIUS] = { NULL, "radius", LIGHT_VALUE_NUMBER, POINT | SPOT | SPHERE | DISC,
						   SPHERE | DISC, "metres; makes soft shadows; 0" },
	[LIGHT_KEY_SIZE] = { NULL, "size", LIGHT_VALUE_SIZE, RECTANGLE, RECTANGLE,
						 "W,H: metres to the right of who looks along its light, and up" },
	[LIGHT_KEY_ANGLE] = { NULL, "angle", LIGHT_VALUE_NUMBER, SUN, 0,
						  "degrees, its diameter in the sky; 0.53" },
	[LIGHT_KEY_NAME] = { NULL, "name", LIGHT_VALUE_NAME, POINT | SPOT | SUN | SKY | AREA, 0,
						 "one word, for the report" },
	[LIGHT_KEY_GROUP] = { NULL, "group", LIGHT_VALUE_NAME, POINT | SPOT | SUN | SKY | AREA, 0,
						  "one word: lamps that mix --group dims together" },
};

lamp light_default(gw_light_type type)
{
	float sky = type == GW_LIGHT_ENVIRONMENT ? 1.0f : 0.0f;
	return (lamp){ .light = { .type = type,
							  .outer_angle = type == GW_LIGHT_SPOT ? 45.0f : 0.0f,
							  .angle = type == GW_LIGHT_SUN ? 0.53f : 0.0f,
							  .radiance = { sky, sky, sky } },
				   .measure = LIGHT_KEY_COUNT,
				   .turbidity = 3.0,
				   .scale = 1.0 };
}

bool light_key_moves(light_key_id key)
{
	light_value value = light_keys[key].value;
	return value != LIGHT_VALUE_NAME && value != LIGHT_VALUE_PATH && value != LIGHT_VALUE_TIME &&
		   value != LIGHT_VALUE_PLACE && value != LIGHT_VALUE_MODEL && value != LIGHT_VALUE_SIZE;
}

/* ---------------------------------------------------------------------------- one key */

light_quantity light_key_quantity(light_key_id key)
{
	switch (key) {
	case LIGHT_KEY_INTENSITY:
		return LIGHT_QUANTITY_INTENSITY;
	case LIGHT_KEY_LUMENS:
	case LIGHT_KEY_WATTS:
		return LIGHT_QUANTITY_FLUX;
	case LIGHT_KEY_IRRADIANCE:
	case LIGHT_KEY_ILLUMINANCE:
		return LIGHT_QUANTITY_IRRADIANCE;
	case LIGHT_KEY_RADIANCE:
	case LIGHT_KEY_HORIZON:
		return LIGHT_QUANTITY_RADIANCE;
	default:
		return LIGHT_QUANTITY_COUNT;
	}
}

static void set_vector(double vector[3], const double *values)
{
	memcpy(vector, values, 3 * sizeof *vector);
}

/* How much light: kept as it was said, and worked out when the light is resolved. */
static gw_status set_amount(lamp *light, light_key_id key, const double *values, size_t count,
							gw_error *error)
{
	bool preset = light->measure != LIGHT_KEY_COUNT && light->preset & 1u << light->measure;
	if (light->measure != LIGHT_KEY_COUNT && light->measure != key && !preset)
		return gw_fail(error, GW_ERROR_USAGE, "'%s' has said how much light already",
					   light_keys[light->measure].name);
	light->measure = key;
	light->white = count == 1;
	if (preset && !light->white) /* a colour takes the place of the preset's own */
		light->kelvin = 0.0;
	for (size_t k = 0; k < 3; k++)
		light->amount[k] = values[count == 3 ? k : 0];
	return GW_OK;
}

/* Photometric or not, from a unit or from the key itself; all numbers of a light agree. */
static gw_status take_units(lamp *light, light_key_id key, light_units said, gw_error *error)
{
	bool photometric =
		key == LIGHT_KEY_LUMENS || key == LIGHT_KEY_ILLUMINANCE || key == LIGHT_KEY_DISTANCE;
	light_units own = photometric              ? LIGHT_UNITS_PHOTOMETRIC
					  : key == LIGHT_KEY_WATTS ? LIGHT_UNITS_RADIOMETRIC
											   : said;
	light_quantity quantity = light_key_quantity(key);
	if (said != LIGHT_UNITS_UNSAID && said != own)
		return gw_fail(error, GW_ERROR_USAGE, "it is in %s, not in %s",
					   light_unit_name(quantity, own), light_unit_name(quantity, said));
	if (own != LIGHT_UNITS_UNSAID && light->units != LIGHT_UNITS_UNSAID && own != light->units)
		return gw_fail(error, GW_ERROR_USAGE,
					   "watts and lumens do not go together; how they convert depends on the "
					   "spectrum");
	if (own != LIGHT_UNITS_UNSAID)
		light->units = own;
	return GW_OK;
}

static gw_status check_extent(const double *metres, size_t count, gw_error *error)
{
	for (size_t k = 0; k < count; k++)
		if (!(metres[k] >= EXTENT_LEAST && metres[k] <= EXTENT_MOST))
			return gw_fail(error, GW_ERROR_USAGE, "it must be from %s to %s m",
						   GW_SAID(EXTENT_LEAST, 15), GW_SAID(EXTENT_MOST, 15));
	return GW_OK;
}

/* Is its length 0 in the arithmetic of lights? */
static bool is_no_direction(const double way[3])
{
	return way[0] * way[0] + way[1] * way[1] + way[2] * way[2] == 0.0;
}

static gw_status check_range(light_key_id key, const double *values, gw_error *error)
{
	if (light_keys[key].value == LIGHT_VALUE_SKY && fabs(values[1]) > 90.0)
		return gw_fail(error, GW_ERROR_USAGE, "the elevation must be from -90 to 90 degrees");
	if (key == LIGHT_KEY_PLACE && (fabs(values[0]) > 90.0 || fabs(values[1]) > 180.0))
		return gw_fail(
			error, GW_ERROR_USAGE,
			"the latitude must be from -90 to 90, the longitude from -180 to 180 degrees");
	if (key == LIGHT_KEY_SIZE && !(values[0] > 0.0 && values[1] > 0.0))
		return gw_fail(error, GW_ERROR_USAGE, "both sides must be above 0");
	if (key == LIGHT_KEY_SIZE)
		GW_TRY(check_extent(values, 2, error));
	if (key == LIGHT_KEY_RADIUS && values[0] != 0.0)
		GW_TRY(check_extent(values, 1, error));
	if (key == LIGHT_KEY_KELVIN && !(values[0] >= KELVIN_LEAST && values[0] <= KELVIN_MOST))
		return gw_fail(error, GW_ERROR_USAGE, "it must be from %s to %s", GW_SAID(KELVIN_LEAST, 15),
					   GW_SAID(KELVIN_MOST, 15));
	if (key == LIGHT_KEY_TURBIDITY &&
		!(values[0] >= SKY_TURBIDITY_LEAST && values[0] <= SKY_TURBIDITY_MOST))
		return gw_fail(error, GW_ERROR_USAGE, "it must be from %g to %g", SKY_TURBIDITY_LEAST,
					   SKY_TURBIDITY_MOST);
	if (key == LIGHT_KEY_DIRECTION && is_no_direction(values))
		return gw_fail(error, GW_ERROR_USAGE, "0,0,0, or what is as short, is no direction");
	return GW_OK;
}

static gw_status check_numbers(light_key_id key, const double *values, size_t count,
							   gw_error *error)
{
	light_value value = light_keys[key].value;
	bool positive = value == LIGHT_VALUE_COLOR || value == LIGHT_VALUE_NUMBER;
	for (size_t k = 0; k < count; k++) {
		if (!isfinite(values[k]) || !isfinite((float)values[k]))
			return gw_fail(error, GW_ERROR_USAGE, "a number of finite size is needed");
		if (positive && values[k] < 0.0)
			return gw_fail(error, GW_ERROR_USAGE, "it must be 0 or more");
	}
	return check_range(key, values, error);
}

gw_status light_set(lamp *light, light_key_id key, const double *values, size_t count,
					gw_error *error)
{
	gw_light *l = &light->light;
	GW_TRY(check_numbers(key, values, count, error));
	GW_TRY(take_units(light, key, LIGHT_UNITS_UNSAID, error));
	switch (key) {
	case LIGHT_KEY_POSITION:
		light->stand.kind = LIGHT_PLACE_NONE;
		set_vector(l->position, values);
		break;
	case LIGHT_KEY_TARGET:
		light->aimed = true;
		light->aim.kind = LIGHT_PLACE_NONE;
		set_vector(light->target, values);
		break;
	case LIGHT_KEY_DIRECTION:
		set_vector(l->direction, values);
		break;
	case LIGHT_KEY_SKY:
		light->from_sky = true;
		light->azimuth = values[0];
		light->elevation = values[1];
		break;
	case LIGHT_KEY_PLACE:
		light->moment.latitude = values[0];
		light->moment.longitude = values[1];
		break;
	case LIGHT_KEY_NORTH:
		light->north = values[0];
		break;
	case LIGHT_KEY_INTENSITY:
	case LIGHT_KEY_LUMENS:
	case LIGHT_KEY_WATTS:
	case LIGHT_KEY_IRRADIANCE:
	case LIGHT_KEY_RADIANCE:
	case LIGHT_KEY_ILLUMINANCE:
		return set_amount(light, key, values, count, error);
	case LIGHT_KEY_KELVIN:
		light->kelvin = values[0];
		break;
	case LIGHT_KEY_TURBIDITY:
		light->turbidity = values[0];
		break;
	case LIGHT_KEY_HORIZON:
		for (size_t k = 0; k < 3; k++)
			light->horizon[k] = (float)values[count == 3 ? k : 0];
		break;
	case LIGHT_KEY_INNER:
		l->inner_angle = (float)values[0];
		break;
	case LIGHT_KEY_OUTER:
		l->outer_angle = (float)values[0];
		break;
	case LIGHT_KEY_DISTANCE:
		light->distance = values[0];
		break;
	case LIGHT_KEY_RADIUS:
		l->radius = (float)values[0];
		break;
	case LIGHT_KEY_SIZE:
		l->size[0] = (float)values[0];
		l->size[1] = (float)values[1];
		break;
	case LIGHT_KEY_ANGLE:
		l->angle = (float)values[0];
		break;
	case LIGHT_KEY_ROTATION:
		l->rotation = (float)values[0];
		break;
	case LIGHT_KEY_ROLL:
		light->roll = values[0];
		break;
	case LIGHT_KEY_SCALE:
		light->scale = values[0];
		break;
	case LIGHT_KEY_IES:
	case LIGHT_KEY_TIME:
	case LIGHT_KEY_MODEL:
	case LIGHT_KEY_MAP:
	case LIGHT_KEY_NAME:
	case LIGHT_KEY_GROUP:
	case LIGHT_KEY_COUNT:
		break;
	}
	return GW_OK;
}

/* What a value looks like, and 1 << n for each number of numbers that it may have. */
typedef struct value_shape {
	const char *expected;
	unsigned counts;
} value_shape;

static const value_shape shape[] = {
	[LIGHT_VALUE_VECTOR] = { "three numbers X,Y,Z", 1u << 3 },
	[LIGHT_VALUE_COLOR] = { "a colour R,G,B or one number", 1u << 3 | 1u << 1 },
	[LIGHT_VALUE_SKY] = { "two numbers AZIMUTH,ELEVATION", 1u << 2 },
	[LIGHT_VALUE_PLACE] = { "two numbers LATITUDE,LONGITUDE", 1u << 2 },
	[LIGHT_VALUE_SIZE] = { "two numbers W,H", 1u << 2 },
	[LIGHT_VALUE_NUMBER] = { "one number", 1u << 1 },
	[LIGHT_VALUE_ANGLE] = { "one number", 1u << 1 },
	[LIGHT_VALUE_NAME] = { "a name", 0 },
	[LIGHT_VALUE_PATH] = { "a file", 0 },
	[LIGHT_VALUE_TIME] = { "a time such as 2026-06-21T14:30+02:00", 0 },
	[LIGHT_VALUE_MODEL] = { "the name of a sky", 0 },
};

const char *light_value_expected(light_value value)
{
	return shape[value].expected;
}

/* scanner:N and floor:N, the N-th that info --places lists, or floor:N+H, so high above it. */
static bool read_place(const char *text, light_place *place)
{
	static const char *const name[] = {
		[LIGHT_PLACE_SCANNER] = "scanner:", [LIGHT_PLACE_FLOOR] = "floor:"
	};
	bool floor_place = strncmp(text, name[LIGHT_PLACE_FLOOR], 6) == 0;
	light_place_kind kind = floor_place ? LIGHT_PLACE_FLOOR : LIGHT_PLACE_SCANNER;
	double value = 0.0, height = LIGHT_FLOOR_HEIGHT;
	if (strncmp(text, name[kind], strlen(name[kind])) != 0)
		return false;
	text += strlen(name[kind]);
	size_t used = number_read(text, strcspn(text, "+"), &value);
	if (used == 0 || value != floor(value) || !(value >= 1.0 && value <= 1e9))
		return false;
	text += used;
	if (*text == '+' && floor_place) {
		text++;
		used = number_read(text, strlen(text), &height);
		text += used;
		if (used == 0 || !(height >= 0.0 && height <= 1e9))
			return false;
	}
	*place = (light_place){ kind, (size_t)value, height };
	return *text == '\0';
}

static gw_status set_place(lamp *light, light_key_id key, const char *text, gw_error *error)
{
	light_place *place = key == LIGHT_KEY_POSITION ? &light->stand : &light->aim;
	if (key == LIGHT_KEY_DIRECTION || !read_place(text, place))
		return gw_fail(
			error, GW_ERROR_USAGE, "it wants X,Y,Z%s",
			key == LIGHT_KEY_DIRECTION
				? ""
				: ", scanner:N, floor:N or floor:N+HEIGHT; glowworm info --places lists them");
	light->aimed = light->aimed || key == LIGHT_KEY_TARGET;
	return GW_OK;
}

gw_status light_set_numbers(lamp *light, light_key_id key, const char *text, gw_error *error)
{
	bool named = strchr(text, ':') || (isalpha((unsigned char)*text) && !strchr(text, ','));
	if (light_keys[key].value == LIGHT_VALUE_VECTOR && named)
		return set_place(light, key, text, error);
	char word[WORD_MAX];
	double values[3] = { 0 };
	light_quantity quantity = light_key_quantity(key);
	light_units units = LIGHT_UNITS_UNSAID;
	light_value kind = light_keys[key].value;
	snprintf(word, sizeof word, "%s", text);
	if (quantity != LIGHT_QUANTITY_COUNT)
		GW_TRY(light_unit_cut(word, quantity, &units, error));
	size_t count = words_numbers(word, values);
	if (!(shape[kind].counts & 1u << count) || count == 0)
		return gw_fail(error, GW_ERROR_USAGE, "it wants %s without blanks", shape[kind].expected);
	GW_TRY(light_set(light, key, values, count, error));
	return take_units(light, key, units, error);
}

static gw_status set_model(lamp *light, const char *text, gw_error *error)
{
	for (int model = SKY_MODEL_NONE + 1; sky_model_name(model); model++)
		if (strcmp(text, sky_model_name(model)) == 0) {
			light->model = (sky_model)model;
			return GW_OK;
		}
	return gw_fail(error, GW_ERROR_USAGE,
				   "there is no sky '%.40s'; there are overcast, intermediate, clear, physical and "
				   "gradient",
				   text);
}

gw_status light_set_text(lamp *light, light_key_id key, const char *text, gw_error *error)
{
	bool path = light_keys[key].value == LIGHT_VALUE_PATH;
	char *to = key == LIGHT_KEY_MAP     ? light->map
			   : path                   ? light->ies
			   : key == LIGHT_KEY_GROUP ? light->group
										: light->light.name;
	size_t room = path ? LIGHT_MAP_PATH : sizeof light->light.name;
	if (!*text)
		return gw_fail(error, GW_ERROR_USAGE, "it must not be empty");
	if (key == LIGHT_KEY_TIME)
		return sun_time_read(text, &light->moment.seconds, error);
	if (key == LIGHT_KEY_MODEL)
		return set_model(light, text, error);
	if (key == LIGHT_KEY_GROUP && strcmp(text, "rest") == 0)
		return gw_fail(error, GW_ERROR_USAGE, "that is the name of light that is no lamp's");
	if (strlen(text) >= room)
		return gw_fail(error, GW_ERROR_USAGE, "it is too long; %zu bytes are the most", room - 1);
	memcpy(to, text, strlen(text) + 1);
	return GW_OK;
}

/* ------------------------------------------------------------------------- the whole light */

/* Cosine of the half angle of a cone that falls off from its axis on, and gives its lumens with the
 * intensity by which it reaches so far: see solid_angle. */
static double beam_cosine(const lamp *light)
{
	const double *a = light->amount;
	double lumens = gw_relative_luminance(a[0], a[1], a[2]) * light->scale;
	return 1.0 - lumens / (LIGHT_BEAM_END * light->distance * light->distance) / PI;
}

static bool is_area(gw_light_type type)
{
	return AREA & 1u << type;
}

static gw_status check_direction(const lamp *light, unsigned given, bool scene, gw_error *error)
{
	unsigned any = given & (BIT(DIRECTION) | BIT(TARGET) | BIT(SKY) | BIT(PLACE));
	const char *type = gw_light_type_name(light->light.type);
	bool sun = light->light.type == GW_LIGHT_SUN;
	const char *name = scene ? "direction" : "toward", *other = sun ? "'from'" : "'to'";
	if (!any && (light->ies[0] || is_area(light->light.type)))
		return GW_OK;
	if (!any && (sun || !scene))
		return gw_fail(error, GW_ERROR_USAGE, "a %s needs '%s' or %s%s", type, name, other,
					   sun ? ", or 'place' and 'time'" : "");
	if (!any)
		return gw_fail(error, GW_ERROR_USAGE, "a %s needs '%s'", type, name);
	if (any & (any - 1))
		return gw_fail(error, GW_ERROR_USAGE, "a %s takes one of '%s'%s %s%s, not both", type, name,
					   given & BIT(PLACE) ? "," : " and", other,
					   given & BIT(PLACE) ? " and 'place'" : "");
	if (light->aimed && !light->stand.kind && !light->aim.kind &&
		memcmp(light->target, light->light.position, sizeof light->target) == 0)
		return gw_fail(error, GW_ERROR_USAGE, "a %s cannot shine to the place where it is", type);
	return GW_OK;
}

/* One key says how much light there is. */
static gw_status check_amount(const lamp *light, unsigned given, gw_error *error)
{
	gw_light_type type = light->light.type;
	const char *name = gw_light_type_name(type);
	if (light->measure == LIGHT_KEY_COUNT && !light->ies[0] && !(given & BIT(DISTANCE)) &&
		(type == GW_LIGHT_POINT || type == GW_LIGHT_SPOT))
		return gw_fail(error, GW_ERROR_USAGE, "a %s light needs 'intensity', 'lumens' or 'watts'",
					   name);
	if (light->measure == LIGHT_KEY_COUNT && is_area(type) && !light->ies[0])
		return gw_fail(error, GW_ERROR_USAGE,
					   "a %s light needs 'intensity', 'lumens', 'watts' or 'radiance'", name);
	if (light->measure == LIGHT_KEY_COUNT && type == GW_LIGHT_SUN)
		return gw_fail(error, GW_ERROR_USAGE, "a sun light needs 'irradiance' or 'illuminance'");
	bool itself = given & BIT(MAP) || light->model == SKY_MODEL_PHYSICAL;
	if (light->measure == LIGHT_KEY_COUNT && !itself && type == GW_LIGHT_ENVIRONMENT)
		return gw_fail(error, GW_ERROR_USAGE, "an environment light needs 'radiance'%s",
					   light->model ? " or 'illuminance'" : ", 'illuminance', 'model' or 'map'");
	if (light->kelvin > 0.0 && light->measure != LIGHT_KEY_COUNT && !light->white)
		return gw_fail(error, GW_ERROR_USAGE,
					   "a colour and 'kelvin' do not go together; give one number");
	return GW_OK;
}

/* Its intensity comes from how far it reaches, its cone from its lumens. */
static gw_status check_beam(const lamp *light, unsigned given, gw_error *error)
{
	if (!(given & BIT(DISTANCE)))
		return GW_OK;
	if (!(light->distance > 0.0))
		return gw_fail(error, GW_ERROR_USAGE, "'distance' must be above 0");
	if (light->measure != LIGHT_KEY_COUNT && light->measure != LIGHT_KEY_LUMENS)
		return gw_fail(error, GW_ERROR_USAGE, "'distance' says how strong it is; '%s' does so too",
					   light_keys[light->measure].name);
	if (light->measure == LIGHT_KEY_LUMENS && given & (BIT(INNER) | BIT(OUTER)))
		return gw_fail(error, GW_ERROR_USAGE,
					   "'lumens' and 'distance' say how wide it is; leave out its angles");
	if (light->measure == LIGHT_KEY_LUMENS && !(beam_cosine(light) >= -1.0))
		return gw_fail(error, GW_ERROR_USAGE,
					   "so many lumens fill no cone that gives 0.25 lx no further than %s m away",
					   GW_SAID(light->distance, 6));
	return GW_OK;
}

/* What a preset cannot know. */
static gw_status check_wanted(const lamp *light, unsigned given, gw_error *error)
{
	char missing[256] = "";
	for (int k = 0; k < LIGHT_KEY_COUNT; k++) {
		size_t used = strlen(missing);
		if (light->wanted & 1u << k)
			snprintf(missing + used, sizeof missing - used, "%s'%s'", used ? " and " : "",
					 light_keys[k].name);
	}
	if (light->wanted & ~given)
		return gw_fail(error, GW_ERROR_USAGE, "this lamp needs %s", missing);
	return GW_OK;
}

static gw_status check_sky(const lamp *light, unsigned given, gw_error *error)
{
	if (given & BIT(MAP) && light->model)
		return gw_fail(error, GW_ERROR_USAGE, "a sky has a 'map' or a 'model', not both");
	if (given & BIT(ROTATION) && !(given & BIT(MAP)))
		return gw_fail(error, GW_ERROR_USAGE, "only a 'map' can have a 'rotation'");
	if (given & BIT(TURBIDITY) && light->model != SKY_MODEL_PHYSICAL)
		return gw_fail(error, GW_ERROR_USAGE, "only a physical sky has a 'turbidity'");
	if (!(given & BIT(HORIZON)) != (light->model != SKY_MODEL_GRADIENT))
		return gw_fail(error, GW_ERROR_USAGE, "%s",
					   light->model == SKY_MODEL_GRADIENT ? "a gradient needs 'horizon'"
														  : "only a gradient has a 'horizon'");
	if (light->model == SKY_MODEL_GRADIENT && light->measure == LIGHT_KEY_ILLUMINANCE)
		return gw_fail(error, GW_ERROR_USAGE,
					   "a gradient needs 'radiance', which is that overhead, not 'illuminance'");
	if (light->model == SKY_MODEL_PHYSICAL && light->measure == LIGHT_KEY_RADIANCE)
		return gw_fail(error, GW_ERROR_USAGE,
					   "a physical sky has its own radiance; 'illuminance' scales it");
	bool sun = given & (BIT(SKY) | BIT(PLACE));
	if (sky_model_has_sun(light->model) && !sun)
		return gw_fail(error, GW_ERROR_USAGE,
					   "this sky needs the sun: 'from', or 'place' and 'time'");
	if (!sky_model_has_sun(light->model) && sun)
		return gw_fail(error, GW_ERROR_USAGE,
					   "where the sun is matters to a clear, intermediate or physical sky alone");
	if ((given & (BIT(SKY) | BIT(PLACE))) == (BIT(SKY) | BIT(PLACE)))
		return gw_fail(error, GW_ERROR_USAGE, "a sky takes 'from' or 'place', not both");
	return GW_OK;
}

/* Places the sun by place and time. */
static gw_status place_sun(lamp *light, unsigned given, gw_error *error)
{
	if (!(given & BIT(PLACE)) != !(given & BIT(TIME)))
		return gw_fail(error, GW_ERROR_USAGE, "'place' and 'time' go together; one is missing");
	if (given & BIT(NORTH) && !(given & (BIT(SKY) | BIT(PLACE))))
		return gw_fail(error, GW_ERROR_USAGE, "'north' says from where 'from' and 'place' count");
	if (given & BIT(PLACE)) {
		sun_position(&light->moment, &light->azimuth, &light->elevation);
		light->from_sky = true;
	}
	bool of_sky = light->light.type == GW_LIGHT_ENVIRONMENT;
	const char *remedy =
		given & BIT(PLACE) ? " there and then; leave this light out, or give a time of day"
		: of_sky           ? ", where no model has it; give one above it"
						   : "; 'toward' ('direction' in a scene file) is for light from below";
	if (light->from_sky && (light->elevation < 0.0 || (of_sky && light->elevation <= 0.0)))
		return gw_fail(error, GW_ERROR_USAGE, "the sun is %.2g degrees below the horizon%s",
					   -light->elevation, remedy);
	return GW_OK;
}

/* Only a luminaire has an axis among lights that are points. */
static gw_status check_point(const lamp *light, unsigned given, bool scene, gw_error *error)
{
	static const light_key_id own[] = { LIGHT_KEY_TARGET, LIGHT_KEY_DIRECTION, LIGHT_KEY_ROLL,
										LIGHT_KEY_SCALE };
	if (light->ies[0])
		return check_direction(light, given, scene, error);
	for (size_t i = 0; i < sizeof own / sizeof *own; i++) {
		const light_key *key = &light_keys[own[i]];
		if (given & 1u << own[i])
			return gw_fail(error, GW_ERROR_USAGE,
						   "only a point light with 'ies', the file of a luminaire, has '%s'",
						   key->word && !scene ? key->word : key->name);
	}
	return GW_OK;
}

/* Discs and rectangles, with what only those of luminaires have. */
static gw_status check_opening(const lamp *light, unsigned given, bool scene, gw_error *error)
{
	bool rectangle = light->light.type == GW_LIGHT_RECTANGLE;
	unsigned own = BIT(SCALE) | (rectangle ? 0 : BIT(ROLL));
	if (!light->ies[0] && given & own)
		return gw_fail(
			error, GW_ERROR_USAGE, "only a %s with 'ies', the file of a luminaire, has '%s'",
			gw_light_type_name(light->light.type), given & BIT(SCALE) ? "scale" : "roll");
	if (light->ies[0] && given & BIT(RADIANCE))
		return gw_fail(error, GW_ERROR_USAGE,
					   "a luminaire is as bright as its file says, from each side; 'scale', "
					   "'intensity' or 'lumens' change that");
	return check_direction(light, given, scene, error);
}

/* What the physical sky has is luminance; what luminaires are measured in, candela. */
static gw_status settle_units(lamp *light, gw_error *error)
{
	if (light->ies[0] && light->units == LIGHT_UNITS_UNSAID)
		light->units = LIGHT_UNITS_PHOTOMETRIC;
	if (light->model != SKY_MODEL_PHYSICAL)
		return GW_OK;
	if (light->units == LIGHT_UNITS_RADIOMETRIC)
		return gw_fail(error, GW_ERROR_USAGE, "a physical sky is in cd/m^2");
	light->units = LIGHT_UNITS_PHOTOMETRIC;
	return GW_OK;
}

static gw_status check_angles(const gw_light *l, gw_error *error)
{
	if (l->type == GW_LIGHT_SPOT && l->outer_angle == 0.0f)
		return gw_fail(error, GW_ERROR_USAGE,
					   "an outer angle of 0 degrees leaves the spot no beam");
	if (l->type == GW_LIGHT_SPOT && l->outer_angle > 180.0f)
		return gw_fail(error, GW_ERROR_USAGE, "the outer angle is %s degrees; 180 is all around",
					   GW_SAID((double)l->outer_angle, 6));
	if (l->type == GW_LIGHT_SPOT && l->inner_angle > l->outer_angle)
		return gw_fail(error, GW_ERROR_USAGE,
					   "the inner angle of %s degrees is larger than the outer one of %s",
					   GW_SAID((double)l->inner_angle, 6), GW_SAID((double)l->outer_angle, 6));
	if (l->type == GW_LIGHT_SUN && l->angle > 180.0f)
		return gw_fail(error, GW_ERROR_USAGE, "a sun %s degrees wide is no sun; use an environment",
					   GW_SAID((double)l->angle, 6));
	return GW_OK;
}

gw_status light_complete(lamp *light, unsigned said, bool scene, gw_error *error)
{
	gw_light_type type = light->light.type;
	unsigned given = said | light->preset;
	for (int k = 0; k < LIGHT_KEY_COUNT; k++)
		if (light_keys[k].needed & 1u << type && !(given & 1u << k) &&
			!(light->ies[0] && (k == LIGHT_KEY_RADIUS || k == LIGHT_KEY_SIZE)))
			return gw_fail(error, GW_ERROR_USAGE, "a %s light needs '%s'", gw_light_type_name(type),
						   scene || !light_keys[k].word ? light_keys[k].name : light_keys[k].word);
	GW_TRY(check_wanted(light, given, error));
	GW_TRY(check_amount(light, given, error));
	GW_TRY(check_beam(light, given, error));
	GW_TRY(check_angles(&light->light, error));
	if (type == GW_LIGHT_ENVIRONMENT)
		GW_TRY(check_sky(light, given, error));
	if (type == GW_LIGHT_SPOT || type == GW_LIGHT_SUN)
		GW_TRY(check_direction(light, given, scene, error));
	if (type == GW_LIGHT_POINT)
		GW_TRY(check_point(light, given, scene, error));
	if (type == GW_LIGHT_DISC || type == GW_LIGHT_RECTANGLE)
		GW_TRY(check_opening(light, given, scene, error));
	bool own_size = !light->ies[0] || given & BIT(RADIUS);
	if ((type == GW_LIGHT_SPHERE || type == GW_LIGHT_DISC) && own_size &&
		!(light->light.radius > 0.0f))
		return gw_fail(error, GW_ERROR_USAGE, "the radius of a %s must be above 0",
					   gw_light_type_name(type));
	light->hangs = (light->ies[0] || is_area(type)) && !(given & (BIT(DIRECTION) | BIT(TARGET)));
	GW_TRY(place_sun(light, given, error));
	return settle_units(light, error);
}

gw_status light_check_luminaire(const lamp *light, gw_error *error)
{
	const luminaire *l = light->luminaire;
	bool disc = light->light.type == GW_LIGHT_DISC;
	bool area = disc || light->light.type == GW_LIGHT_RECTANGLE;
	bool said = disc ? light->light.radius > 0.0f : light->light.size[0] > 0.0f;
	if (!area || said)
		return GW_OK;
	const char *type = gw_light_type_name(light->light.type);
	if (!(l->size[0] > 0.0 && l->size[1] > 0.0))
		return gw_fail(error, GW_ERROR_USAGE,
					   "%s does not say how large its opening is; give its '%s', or take a point",
					   light->ies, disc ? "radius" : "size");
	if (l->round != disc)
		return gw_fail(error, GW_ERROR_USAGE, "the opening of %s is no %s; take a %s", light->ies,
					   type, disc ? "rectangle" : "disc");
	return GW_OK;
}

gw_status lights_agree(const lamp *lights, size_t count, light_units *scene, gw_error *error)
{
	static const char *const name[] = { "", "watts", "lumens, candela or lux" };
	size_t first = count;
	for (size_t i = 0; i < count; i++) {
		light_units own = lights[i].units;
		if (own == LIGHT_UNITS_UNSAID)
			continue;
		if (*scene != LIGHT_UNITS_UNSAID && own != *scene && first == count)
			return gw_fail(error, GW_ERROR_USAGE, "light %zu is in %s, but the scene is to be %s",
						   i + 1, name[own],
						   own == LIGHT_UNITS_PHOTOMETRIC ? "radiometric" : "photometric");
		if (first < count && own != lights[first].units)
			return gw_fail(
				error, GW_ERROR_USAGE,
				"light %zu is in %s, light %zu in %s; those of a scene have to be of one "
				"kind, because how one converts to the other depends on the spectrum",
				first + 1, name[lights[first].units], i + 1, name[own]);
		first = i;
		*scene = own;
	}
	return GW_OK;
}

/* ------------------------------------------------------------------------------- resolved */

/* Solid angle of a light of even intensity with the same flux, sr: that of a spot is its inner cone
 * and, as smoothstep in the cosine is one half on average, half of what lies around it. */
static double solid_angle(const lamp *light)
{
	const gw_light *l = &light->light;
	if (light->luminaire)
		return light->flux / light->luminaire->candela;
	if (l->type == GW_LIGHT_DISC || l->type == GW_LIGHT_RECTANGLE)
		return PI;
	if (l->type != GW_LIGHT_SPOT)
		return 4.0 * PI;
	double inner = cos((double)l->inner_angle * DEGREE),
		   outer = cos((double)l->outer_angle * DEGREE);
	return 2.0 * PI * (1.0 - 0.5 * (inner + outer));
}

/* What of a light that is an area is seen from afar along its axis, square metres. */
static double area(const gw_light *l)
{
	double radius = (double)l->radius;
	return l->type == GW_LIGHT_RECTANGLE ? (double)l->size[0] * (double)l->size[1]
										 : PI * radius * radius;
}

/* The light's own colour: of a temperature, or white. */
static void find_tint(const lamp *light, double tint[3])
{
	tint[0] = tint[1] = tint[2] = 1.0;
	if (light->kelvin > 0.0)
		kelvin_color(light->kelvin, tint);
}

static void put_color(const lamp *light, double share, float color[3])
{
	double tint[3];
	find_tint(light, tint);
	for (int k = 0; k < 3; k++)
		color[k] = (float)(light->amount[k] * tint[k] * share);
}

/* As its maker measured it. */
static void resolve_measured(lamp *light)
{
	double tint[3];
	find_tint(light, tint);
	for (int k = 0; k < 3; k++)
		light->light.intensity[k] = (float)(light->luminaire->candela * tint[k] * light->scale);
}

/* By how far it reaches. */
static void resolve_beam(lamp *light)
{
	gw_light *l = &light->light;
	double tint[3];
	find_tint(light, tint);
	for (int k = 0; k < 3; k++)
		l->intensity[k] = (float)(LIGHT_BEAM_END * light->distance * light->distance * tint[k]);
	if (light->measure != LIGHT_KEY_LUMENS)
		return;
	l->inner_angle = 0.0f;
	l->outer_angle = (float)(acos(beam_cosine(light)) / DEGREE);
}

static void resolve_amount(lamp *light)
{
	gw_light *l = &light->light;
	light_key_id measure = light->measure;
	if (light->distance > 0.0)
		resolve_beam(light);
	if (measure == LIGHT_KEY_COUNT && light->luminaire)
		resolve_measured(light);
	if (measure == LIGHT_KEY_COUNT)
		return;
	if (measure == LIGHT_KEY_INTENSITY)
		put_color(light, light->scale, l->intensity);
	else if (measure == LIGHT_KEY_LUMENS || measure == LIGHT_KEY_WATTS)
		put_color(light, light->scale / solid_angle(light), l->intensity);
	else if (l->type == GW_LIGHT_SUN)
		put_color(light, 1.0, l->irradiance);
	else if (measure == LIGHT_KEY_RADIANCE && is_area(l->type))
		put_color(light, area(l), l->intensity);
	else if (measure == LIGHT_KEY_RADIANCE)
		put_color(light, 1.0, l->radiance);
	else if (measure == LIGHT_KEY_ILLUMINANCE) /* of an even sky; of a map see light_scale_map */
		put_color(light, 1.0 / PI, l->radiance);
}

void light_color(const lamp *light, float color[3])
{
	put_color(light, 1.0, color);
}

/* Where a luminaire's C 0 lies, or the right side of a rectangle: level, right of who looks along
 * its light, and turned by its roll; of one that shines straight down or up, toward +x. Returns the
 * degrees between its direction and straight down. */
static double resolve_frame(lamp *light, char up)
{
	gw_light *l = &light->light;
	double stand[3][3], right[3], *d = l->direction, length = 0.0, across = 0.0, over_all = 0.0;
	const double *above = stand[2];
	gw_camera_stand(up, stand[0], stand[1], stand[2]);
	for (int k = 0; k < 3; k++)
		d[k] = light->hangs ? 0.0 - above[k] : d[k];
	for (int k = 0; k < 3; k++) {
		int i = (k + 1) % 3, j = (k + 2) % 3;
		right[k] = d[i] * above[j] - d[j] * above[i];
		length += d[k] * d[k];
		over_all += d[k] * above[k];
		across += right[k] * right[k];
	}
	bool upright = across <= 1e-12 * length;
	double roll = light->roll * DEGREE;
	for (int k = 0; k < 3; k++)
		right[k] = upright ? stand[0][k] : right[k] / sqrt(across);
	for (int k = 0; k < 3; k++) {
		int i = (k + 1) % 3, j = (k + 2) % 3;
		double over = (right[i] * d[j] - right[j] * d[i]) / sqrt(length);
		l->across[k] = cos(roll) * right[k] - sin(roll) * over;
	}
	return acos(fmin(fmax(-over_all / sqrt(length), -1.0), 1.0)) / DEGREE;
}

/* What only those have that were measured. */
static void resolve_luminaire(lamp *light, double tilt)
{
	gw_light *l = &light->light;
	for (int k = 0; k < 3 && light->measure == LIGHT_KEY_COUNT; k++)
		l->intensity[k] *= (float)luminaire_tilt_factor(light->luminaire, tilt);
	if (l->type == GW_LIGHT_DISC && !(l->radius > 0.0f))
		l->radius = (float)(0.25 * (light->luminaire->size[0] + light->luminaire->size[1]));
	for (int k = 0; k < 2 && l->type == GW_LIGHT_RECTANGLE && !(l->size[1] > 0.0f); k++)
		l->size[k] = (float)light->luminaire->size[k];
	l->distribution = light->luminaire->distribution;
	l->vertical_count = light->luminaire->verticals;
	l->horizontal_count = light->luminaire->horizontals;
}

void light_resolve(lamp *light, char up)
{
	gw_light *l = &light->light;
	l->map_y_up = up == 'y';
	resolve_amount(light);
	if (light->aimed)
		for (int k = 0; k < 3; k++)
			l->direction[k] = light->target[k] - l->position[k];
	if (light->luminaire)
		resolve_luminaire(light, resolve_frame(light, up));
	else if (is_area(l->type))
		resolve_frame(light, up);
	if (!light->from_sky)
		return;
	double a = (light->azimuth + light->north) * DEGREE, e = light->elevation * DEGREE;
	double east = sin(a) * cos(e), north = cos(a) * cos(e), height = sin(e);
	double axis[3][3];
	gw_camera_stand(up, axis[0], axis[1], axis[2]);
	/* From 0, so that no -0 comes out. */
	for (int k = 0; k < 3; k++)
		l->direction[k] = 0.0 - (east * axis[0][k] + north * axis[1][k] + height * axis[2][k]);
}

gw_status light_scale_map(lamp *light, const panorama *map, gw_error *error)
{
	if (light->measure != LIGHT_KEY_ILLUMINANCE)
		return GW_OK;
	double level = sky_map_illuminance(map);
	if (!(level > 0.0 && isfinite(level)))
		return gw_fail(
			error, GW_ERROR_DATA,
			"the map is black above its horizon, or has no finite brightness, and cannot "
			"give an illuminance; give 'radiance'");
	put_color(light, 1.0 / level, light->light.radiance);
	return GW_OK;
}

gw_status light_sky(lamp *light, panorama *map, gw_error *error)
{
	double tint[3];
	sky_description sky = { .model = light->model,
							.azimuth = light->azimuth + light->north,
							.elevation = light->elevation,
							.turbidity = light->turbidity };
	find_tint(light, tint);
	memcpy(sky.horizon, light->horizon, sizeof sky.horizon);
	memcpy(sky.zenith, light->light.radiance, sizeof sky.zenith);
	GW_TRY(sky_model_map(&sky, map, error));
	light->light.rotation = 0.0f;
	if (light->model == SKY_MODEL_GRADIENT)
		for (int k = 0; k < 3; k++)
			light->light.radiance[k] = 1.0f;
	else if (light->measure == LIGHT_KEY_COUNT)
		for (int k = 0; k < 3; k++)
			light->light.radiance[k] = (float)tint[k];
	return light_scale_map(light, map, error);
}

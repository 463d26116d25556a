#include "scene/scene_file.h"
#include "glowworm_host.h"
#include "files/input_file.h"
#include "scene/json_place.h"
#include "meshes/mesh.h"
#include "program/nearest_name.h"
#include "files/number_text.h"
#include "options/options.h"
#include "meshes/mesh_reader.h"

#include <jansson.h>
#include <math.h>
#include <stdarg.h>
#include <string.h>
#include <strings.h>

/* A scene is a few hundred lines; more than this is some other file. */
#define SCENE_BYTES_MAX ((size_t)64 << 20)

/* What is being read, and where in it we are. */
typedef struct reader {
	const char *path;
	const input_file *in;
	settings *settings;
	json_step step[8];
	size_t depth;
	gw_error *error;
} reader;

bool scene_is_file(const char *path)
{
	size_t length = strlen(path);
	return length > 5 && strcasecmp(path + length - 5, ".json") == 0;
}

/* ------------------------------------------------------------------------------- messages */

static gw_status fail_here(const reader *r, const char *form, ...)
	__attribute__((format(printf, 2, 3)));

/* File and line, the way to the value ("lights[1].radius"), and the sentence. */
static gw_status fail_here(const reader *r, const char *form, ...)
{
	char way[256] = "", sentence[700];
	for (size_t i = 0; i < r->depth; i++) {
		size_t used = strlen(way);
		if (r->step[i].key)
			snprintf(way + used, sizeof way - used, "%s%.60s", i ? "." : "", r->step[i].key);
		else
			snprintf(way + used, sizeof way - used, "[%zu]", r->step[i].index);
	}
	va_list arguments;
	va_start(arguments, form);
	vsnprintf(sentence, sizeof sentence, form, arguments);
	va_end(arguments);
	size_t line = json_place_line((const char *)r->in->data, r->in->length, r->step, r->depth);
	return gw_fail(r->error, GW_ERROR_DATA, "%s, line %zu: %s%s%s", r->path, line, way,
				   *way ? ": " : "", sentence);
}

static void enter_key(reader *r, const char *key)
{
	r->step[r->depth++] = (json_step){ .key = key };
}

static void enter_index(reader *r, size_t index)
{
	r->step[r->depth++] = (json_step){ .index = index };
}

/* Only where all went well: what fails ends the reading. */
static void leave(reader *r)
{
	r->depth--;
}

static gw_status fail_key(const reader *r, const char *const *name, size_t count)
{
	char known[512] = "", hint[NEAREST_NAME_HINT];
	const char *key = r->step[r->depth - 1].key;
	for (size_t i = 0; i < count; i++)
		if (name[i])
			snprintf(known + strlen(known), sizeof known - strlen(known), "%s%s",
					 *known ? ", " : "", name[i]);
	nearest_name_hint(hint, key, "", name, count);
	return fail_here(r, "there is no such key; there are %s%s", known, hint);
}

/* --------------------------------------------------------------------------------- values */

/* An array of numbers, or where one is allowed a single number. */
static gw_status take_numbers(const reader *r, json_t *value, double *to, size_t most,
							  bool one_allowed, size_t *count)
{
	bool one = json_is_number(value) && one_allowed;
	if (one)
		to[0] = json_number_value(value);
	*count = one ? 1 : json_array_size(value);
	bool good = one || (json_is_array(value) && *count == most && most > 1);
	for (size_t i = 0; i < *count && good && !one; i++) {
		good = json_is_number(json_array_get(value, i));
		to[i] = json_number_value(json_array_get(value, i));
	}
	if (good)
		return GW_OK;
	if (most == 1)
		return fail_here(r, "a number is needed");
	return fail_here(r, "an array of %zu numbers%s is needed", most,
					 one_allowed ? ", or one number," : "");
}

static gw_status take_color(const reader *r, json_t *value, double most, float color[3])
{
	double v[3] = { 0 };
	size_t count;
	GW_TRY(take_numbers(r, value, v, 3, true, &count));
	for (size_t k = 0; k < 3; k++) {
		double number = v[count == 3 ? k : 0];
		color[k] = (float)number;
		if (!(number >= 0.0 && number <= most && isfinite(color[k])))
			GW_TRY(isinf(most) ? fail_here(r, "it must be 0 or more")
							   : fail_here(r, "it must be 0 to %s", GW_SAID(most, 15)));
	}
	return GW_OK;
}

/* --------------------------------------------------------------------------------- inputs */

static gw_status take_matrix(const reader *r, json_t *value, double m[16])
{
	size_t count;
	GW_TRY(take_numbers(r, value, m, 16, false, &count));
	double determinant = m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) +
						 m[2] * (m[4] * m[9] - m[5] * m[8]);
	if (m[12] != 0.0 || m[13] != 0.0 || m[14] != 0.0 || m[15] != 1.0)
		return fail_here(r, "the last row must be 0, 0, 0, 1; rows come one after the other");
	/* The volume of its rows, next to that of a box with edges as long: what is left of a matrix
	 * without an inverse after its numbers were rounded to doubles. */
	double box = 1.0;
	for (int row = 0; row < 3; row++)
		box *= hypot(hypot(m[4 * row], m[4 * row + 1]), m[4 * row + 2]);
	if (!(fabs(determinant) > 1e-14 * box) || !isfinite(determinant))
		return fail_here(r, "this matrix has no inverse");
	return GW_OK;
}

/* ---------------------------------------------------------------------------------- motion */

static gw_status take_frame(const reader *r, json_t *value, uint32_t *frame)
{
	json_int_t number = json_integer_value(value);
	if (!json_is_integer(value) || number < 0 || number >= SETTINGS_FRAMES_MAX)
		return fail_here(r, "the number of a frame is needed, 0 or above");
	*frame = (uint32_t)number;
	return GW_OK;
}

static gw_status take_input_value(const reader *r, const char *key, json_t *value, motion_key *to)
{
	static const char *const name[MOTION_VALUES + 1] = { "move", "rotate", "scale", "frame" };
	int which = 0;
	size_t count;
	while (which < MOTION_VALUES && strcmp(key, name[which]) != 0)
		which++;
	if (which == MOTION_VALUES)
		return fail_key(r, name, MOTION_VALUES + 1);
	to->given |= 1u << which;
	GW_TRY(take_numbers(r, value, to->value[which], which == MOTION_SCALE ? 1 : 3,
						which == MOTION_SCALE, &count));
	if (which == MOTION_SCALE && !(to->value[which][0] > 0.0))
		return fail_here(r, "it must be above 0");
	return GW_OK;
}

static gw_status take_light_key(const reader *r, const char *key, json_t *value, lamp *light,
								unsigned *given);

/* The light's own keys, checked as there. */
static gw_status take_light_value(const reader *r, const char *key, json_t *value,
								  const lamp *light, motion_key *to)
{
	lamp trial = *light;
	unsigned given = 0;
	GW_TRY(take_light_key(r, key, value, &trial, &given));
	int which = 0;
	while (!(given & 1u << which))
		which++;
	if (!light_key_moves((light_key_id)which))
		return fail_here(r, "a light's %s stays the same", key);
	light_value kind = light_keys[which].value;
	size_t count = 0, most = kind == LIGHT_VALUE_NUMBER ? 1 : kind == LIGHT_VALUE_SKY ? 2 : 3;
	GW_TRY(take_numbers(r, value, to->value[which], most, true, &count));
	for (size_t k = count; k < most; k++)
		to->value[which][k] = to->value[which][0];
	to->given |= given;
	return GW_OK;
}

/* light: NULL for an input's keyframe. */
static gw_status take_keyframe(reader *r, json_t *object, const lamp *light, motion_path *path)
{
	motion_key *to = &path->key[path->key_count];
	const char *key;
	json_t *value;
	if (!json_is_object(object) || !json_object_get(object, "frame"))
		return fail_here(r, "a keyframe is an object with \"frame\"");
	json_object_foreach(object, key, value)
	{
		enter_key(r, key);
		if (strcmp(key, "frame") == 0)
			GW_TRY(take_frame(r, value, &to->frame));
		else if (light)
			GW_TRY(take_light_value(r, key, value, light, to));
		else
			GW_TRY(take_input_value(r, key, value, to));
		leave(r);
	}
	if (!to->given)
		return fail_here(r, "this keyframe says nothing but its frame");
	if (path->key_count > 0 && to->frame <= to[-1].frame)
		return fail_here(r, "keyframes must be in ascending order, each in a frame of its own");
	path->key_count++;
	return GW_OK;
}

static gw_status take_path_keys(reader *r, json_t *list, const lamp *light, motion_path *path)
{
	size_t count = json_array_size(list);
	if (!json_is_array(list) || count == 0)
		return fail_here(r, "an array of keyframes is needed, at least one");
	path->key = calloc(count, sizeof *path->key);
	if (!path->key)
		return gw_fail(r->error, GW_ERROR_MEMORY, "no memory for %zu keyframes", count);
	for (size_t i = 0; i < count; i++) {
		enter_index(r, i);
		GW_TRY(take_keyframe(r, json_array_get(list, i), light, path));
		leave(r);
	}
	return GW_OK;
}

static gw_status take_matrices(reader *r, json_t *list, motion_path *path)
{
	size_t count = json_array_size(list);
	if (!json_is_array(list) || count == 0)
		return fail_here(r, "an array of matrices is needed, one for each frame");
	path->matrix = reallocarray(NULL, count, 16 * sizeof *path->matrix);
	if (!path->matrix)
		return gw_fail(r->error, GW_ERROR_MEMORY, "no memory for %zu matrices", count);
	for (size_t i = 0; i < count; i++) {
		enter_index(r, i);
		GW_TRY(take_matrix(r, json_array_get(list, i), path->matrix + 16 * i));
		leave(r);
	}
	path->matrix_count = count;
	return GW_OK;
}

/* The keys that tell how an input or a light moves; *known is false for any other. */
static gw_status take_motion_key(reader *r, const char *key, json_t *value, const lamp *light,
								 motion_path *path, bool *known)
{
	const char *word = json_string_value(value);
	size_t count;
	*known = true;
	if (strcmp(key, "path") == 0)
		return take_path_keys(r, value, light, path);
	if (strcmp(key, "interpolation") == 0) {
		path->smooth = word && strcmp(word, "smooth") == 0;
		return path->smooth || (word && strcmp(word, "linear") == 0)
				   ? GW_OK
				   : fail_here(r, "it must be \"linear\" or \"smooth\"");
	}
	if (!light && strcmp(key, "matrices") == 0)
		return take_matrices(r, value, path);
	if (!light && strcmp(key, "pivot") == 0) {
		path->has_pivot = true;
		return take_numbers(r, value, path->pivot, 3, false, &count);
	}
	*known = false;
	return GW_OK;
}

/* Keys that only make sense together. */
static gw_status check_motion(const reader *r, json_t *object, const motion_path *path)
{
	if (path->key_count > 0 && path->matrix_count > 0)
		return fail_here(r, "it moves by 'path' or by 'matrices', not by both");
	if (path->matrix_count > 0 && json_object_get(object, "matrix"))
		return fail_here(r, "'matrices' take the place of 'matrix'; give one of them");
	if (path->key_count == 0 && (path->has_pivot || json_object_get(object, "interpolation")))
		return fail_here(r, "'pivot' and 'interpolation' belong to a 'path', which is missing");
	return GW_OK;
}

/* What a path needs to know of the input, and the path itself, go to the settings. */
static gw_status finish_motion(reader *r, json_t *object, motion_path *path, settings_input *input,
							   size_t *number)
{
	static const double identity[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };
	gw_status status = check_motion(r, object, path);
	if (status != GW_OK || (path->key_count == 0 && path->matrix_count == 0))
		return status;
	if (input && !input->has_matrix)
		memcpy(input->matrix, path->matrix_count > 0 ? path->matrix : identity, sizeof identity);
	if (input)
		input->has_matrix = true;
	return settings_add_path(r->settings, path, number, r->error);
}

/* ---------------------------------------------------------------------------- inputs' keys */

/* A path counts from the scene file's folder; "-" is standard input. */
static gw_status take_path(const reader *r, json_t *value, char **path)
{
	const char *name = json_string_value(value);
	if (!name || !*name)
		return fail_here(r, "the name of a file is needed");
	if (strlen(name) != json_string_length(value))
		return fail_here(r, "a name cannot hold a zero");
	const char *slash = strrchr(r->path, '/');
	bool own = *name == '/' || strcmp(name, "-") == 0 || !slash;
	free(*path);
	if (asprintf(path, "%.*s%s", own ? 0 : (int)(slash - r->path) + 1, r->path, name) < 0) {
		*path = NULL;
		return gw_fail(r->error, GW_ERROR_MEMORY, "no memory for a name");
	}
	return GW_OK;
}

static gw_status take_density(const reader *r, json_t *value, float *density)
{
	double number = json_number_value(value);
	*density = (float)number;
	if (json_is_number(value) && *density > 0.0f && number <= 1e12)
		return GW_OK;
	return fail_here(r, "points on a square metre are needed, above 0");
}

static gw_status take_share(const reader *r, json_t *value, bool *given, float *share)
{
	double number = json_number_value(value);
	*given = true;
	*share = (float)number;
	if (json_is_number(value) && number >= 0.0 && number <= 1.0)
		return GW_OK;
	return fail_here(r, "a number from 0 to 1 is needed");
}

static gw_status take_input_key(reader *r, const char *key, json_t *value, settings_input *input)
{
	static const char *const name[] = { "file",          "matrix",   "emission", "albedo",
										"opacity",       "mesh",     "density",  "specular",
										"roughness",     "path",     "matrices", "pivot",
										"interpolation", "instances" };
	if (strcmp(key, "file") == 0)
		return take_path(r, value, &input->path);
	if (strcmp(key, "instances") == 0) /* taken when all other keys are known */
		return GW_OK;
	if (strcmp(key, "matrix") == 0) {
		input->has_matrix = true;
		return take_matrix(r, value, input->matrix);
	}
	if (strcmp(key, "emission") == 0) {
		input->has_emission = true;
		return take_color(r, value, HUGE_VAL, input->emission);
	}
	if (strcmp(key, "albedo") == 0) {
		input->has_albedo = true;
		return take_color(r, value, 1.0, input->albedo);
	}
	if (strcmp(key, "mesh") == 0) {
		input->mesh = json_is_true(value);
		return json_is_boolean(value) ? GW_OK : fail_here(r, "true or false is needed");
	}
	if (strcmp(key, "density") == 0)
		return take_density(r, value, &input->density);
	if (strcmp(key, "specular") == 0)
		return take_share(r, value, &input->has_specular, &input->specular);
	if (strcmp(key, "opacity") == 0)
		return take_share(r, value, &input->has_opacity, &input->opacity);
	if (strcmp(key, "roughness") == 0)
		return take_share(r, value, &input->has_roughness, &input->roughness);
	return fail_key(r, name, sizeof name / sizeof *name);
}

/* Two matrices as one: first `inner`, then `outer`. */
static void chain_matrices(const double outer[16], const double inner[16], double both[16])
{
	for (size_t row = 0; row < 4; row++) {
		for (size_t column = 0; column < 4; column++) {
			double sum = 0.0;
			for (size_t k = 0; k < 4; k++)
				sum += outer[4 * row + k] * inner[4 * k + column];
			both[4 * row + column] = sum;
		}
	}
}

/* An input for each place where the same thing stands. */
static gw_status add_instances(reader *r, json_t *list, const settings_input *input)
{
	size_t count = json_array_size(list);
	if (!json_is_array(list) || count == 0)
		return fail_here(r, "an array of matrices is needed, one for each place where it stands");
	if (input->motion > 0)
		return fail_here(r, "what moves is no instance; list it as an input of its own");
	for (size_t i = 0; i < count; i++) {
		settings_input instance = *input;
		double matrix[16];
		enter_index(r, i);
		GW_TRY(take_matrix(r, json_array_get(list, i), matrix));
		if (input->has_matrix)
			chain_matrices(matrix, input->matrix, instance.matrix);
		else
			memcpy(instance.matrix, matrix, sizeof matrix);
		instance.has_matrix = true;
		instance.again = i > 0;
		GW_TRY(settings_add_input(r->settings, &instance, r->error));
		leave(r);
	}
	return GW_OK;
}

static gw_status add_input(reader *r, json_t *object, const settings_input *input)
{
	json_t *list = json_object_get(object, "instances");
	if (!list)
		return settings_add_input(r->settings, input, r->error);
	enter_key(r, "instances");
	GW_TRY(add_instances(r, list, input));
	leave(r);
	return GW_OK;
}

static gw_status take_input_keys(reader *r, json_t *object, motion_path *path,
								 settings_input *input)
{
	bool known;
	const char *key;
	json_t *value;
	json_object_foreach(object, key, value)
	{
		enter_key(r, key);
		GW_TRY(take_motion_key(r, key, value, NULL, path, &known));
		if (!known)
			GW_TRY(take_input_key(r, key, value, input));
		leave(r);
	}
	if (!input->path)
		return fail_here(r, "an input needs 'file'");
	input->vertices = json_is_false(json_object_get(object, "mesh"));
	bool is_mesh = input->mesh || (mesh_is_name(input->path) && !input->vertices);
	if (input->density > 0.0f && !is_mesh)
		return fail_here(r, "'density' is for meshes; add \"mesh\": true to sample the faces");
	GW_TRY(finish_motion(r, object, path, input, &input->motion));
	return add_input(r, object, input);
}

static gw_status take_input(reader *r, json_t *object)
{
	settings_input input = { 0 };
	motion_path path = { 0 };
	if (!json_is_object(object))
		return fail_here(r, "an input is an object with \"file\"");
	gw_status status = take_input_keys(r, object, &path, &input);
	motion_path_clear(&path);
	free(input.path);
	return status;
}

/* --------------------------------------------------------------------------------- lights */

static gw_status fail_light_key(const reader *r, gw_light_type type)
{
	const char *name[LIGHT_KEY_COUNT + 1] = { [LIGHT_KEY_COUNT] = "type" };
	for (int k = 0; k < LIGHT_KEY_COUNT; k++)
		if (light_keys[k].types & 1u << type)
			name[k] = light_keys[k].name;
	return fail_key(r, name, LIGHT_KEY_COUNT + 1);
}

/* A file of a light: its path counts from the scene file's folder, as those of inputs do. */
static gw_status take_light_file(const reader *r, json_t *value, light_key_id id, lamp *light)
{
	char *path = NULL;
	gw_error reason = { 0 };
	gw_status status = take_path(r, value, &path);
	if (status == GW_OK && light_set_text(light, id, path, &reason) != GW_OK)
		status = fail_here(r, "%.600s", reason.text);
	free(path);
	return status;
}

/* Numbers, or a text of numbers with their unit: "40cd". */
static gw_status take_light_number(const reader *r, json_t *value, light_key_id id, lamp *light)
{
	light_value kind = light_keys[id].value;
	const char *text = json_string_value(value);
	gw_error reason = { 0 };
	double v[3] = { 0 };
	size_t count;
	if (kind == LIGHT_VALUE_TIME || kind == LIGHT_VALUE_MODEL) {
		if (!text)
			return fail_here(r, "a text is needed");
		return light_set_text(light, id, text, &reason) == GW_OK
				   ? GW_OK
				   : fail_here(r, "%.600s", reason.text);
	}
	if (text && (kind == LIGHT_VALUE_COLOR || id == LIGHT_KEY_POSITION))
		return light_set_numbers(light, id, text, &reason) == GW_OK
				   ? GW_OK
				   : fail_here(r, "%.600s", reason.text);
	bool single = kind == LIGHT_VALUE_NUMBER || kind == LIGHT_VALUE_ANGLE;
	bool pair = kind == LIGHT_VALUE_SKY || kind == LIGHT_VALUE_PLACE || kind == LIGHT_VALUE_SIZE;
	bool one = single || kind == LIGHT_VALUE_COLOR;
	GW_TRY(take_numbers(r, value, v, single ? 1 : pair ? 2 : 3, one, &count));
	if (light_set(light, id, v, count, &reason) != GW_OK)
		return fail_here(r, "%.600s", reason.text);
	return GW_OK;
}

/* A name may be empty, and have blanks, which a word cannot. */
static gw_status take_light_name(const reader *r, json_t *value, light_key_id id, lamp *light)
{
	const char *name = json_string_value(value);
	gw_error reason = { 0 };
	if (!name || strlen(name) >= sizeof light->light.name)
		return fail_here(r, "a text of at most 63 bytes is needed");
	if (*name && light_set_text(light, id, name, &reason) != GW_OK)
		return fail_here(r, "%.600s", reason.text);
	return GW_OK;
}

static gw_status take_light_key(const reader *r, const char *key, json_t *value, lamp *light,
								unsigned *given)
{
	int id = 0;
	while (id < LIGHT_KEY_COUNT && !(light_keys[id].types & 1u << light->light.type &&
									 light_keys[id].name && strcmp(key, light_keys[id].name) == 0))
		id++;
	if (id == LIGHT_KEY_COUNT)
		return fail_light_key(r, light->light.type);
	*given |= 1u << id;
	if (light_keys[id].value == LIGHT_VALUE_NAME)
		return take_light_name(r, value, (light_key_id)id, light);
	if (light_keys[id].value == LIGHT_VALUE_PATH)
		return take_light_file(r, value, (light_key_id)id, light);
	return take_light_number(r, value, (light_key_id)id, light);
}

static gw_status begin_light(reader *r, json_t *object, lamp *light)
{
	const char *word = json_string_value(json_object_get(object, "type"));
	char known[256], hint[NEAREST_NAME_HINT];
	const char *name[LIGHT_NAMES_MAX];
	light_list_names(known, sizeof known);
	if (!word)
		return fail_here(r, "a light needs 'type': %s", known);
	if (light_begin(word, light))
		return GW_OK;
	enter_key(r, "type");
	gw_status status = fail_here(r, "there is no light '%.60s'; there are %s%s", word, known,
								 nearest_name_hint(hint, word, "", name, light_names(name)));
	leave(r);
	return status;
}

static gw_status take_light_keys(reader *r, json_t *object, motion_path *path, lamp *light)
{
	unsigned given = 0;
	bool known;
	gw_error reason = { 0 };
	const char *key;
	json_t *value;
	json_object_foreach(object, key, value)
	{
		enter_key(r, key);
		GW_TRY(take_motion_key(r, key, value, light, path, &known));
		if (!known && strcmp(key, "type") != 0)
			GW_TRY(take_light_key(r, key, value, light, &given));
		leave(r);
	}
	if (light_complete(light, given, true, &reason) != GW_OK)
		return fail_here(r, "%.600s", reason.text);
	GW_TRY(finish_motion(r, object, path, NULL, &light->motion));
	return settings_add_light(r->settings, light, r->error);
}

static gw_status take_light(reader *r, json_t *object)
{
	lamp light = light_default(GW_LIGHT_POINT);
	if (!json_is_object(object))
		return fail_here(r, "a light is an object with \"type\"");
	GW_TRY(begin_light(r, object, &light));
	motion_path path = { 0 };
	gw_status status = take_light_keys(r, object, &path, &light);
	motion_path_clear(&path);
	return status;
}

/* ------------------------------------------------------------------------------------ bake */

static gw_status fail_bake_key(const reader *r)
{
	char key[SETTINGS_OPTIONS][64];
	const char *name[SETTINGS_OPTIONS];
	size_t count = 0;
	for (const option *o = options; o->name; o++)
		if (o->scene) {
			option_key(o, key[count]);
			name[count] = key[count];
			count++;
		}
	return fail_key(r, name, count);
}

/* The value as the text that the option takes. */
static bool value_text(json_t *value, char text[OPTION_VALUE])
{
	if (json_is_string(value))
		return (size_t)snprintf(text, OPTION_VALUE, "%s", json_string_value(value)) < OPTION_VALUE;
	if (json_is_integer(value))
		snprintf(text, OPTION_VALUE, "%" JSON_INTEGER_FORMAT, json_integer_value(value));
	else if (json_is_real(value))
		number_print(text, json_real_value(value));
	return json_is_number(value);
}

/* What the command line says wins, but the scene still has to make sense. */
static gw_status take_bake_key(const reader *r, const char *key, json_t *value)
{
	char text[OPTION_VALUE];
	const option *o = option_find_key(key);
	if (!o)
		return fail_bake_key(r);
	if (!value_text(value, text))
		return fail_here(r, "a number or a short text is needed");
	settings unused = settings_default();
	bool given = r->settings->given[o - options] == SETTINGS_BY_COMMAND;
	gw_error reason = { 0 };
	gw_status status = option_set(o, given ? &unused : r->settings, text, &reason);
	settings_clear(&unused);
	if (!given)
		r->settings->given[o - options] = SETTINGS_BY_SCENE;
	return status == GW_OK ? GW_OK : fail_here(r, "it %.600s", reason.text);
}

static gw_status take_bake(reader *r, json_t *object)
{
	const char *key;
	json_t *value;
	if (!json_is_object(object))
		return fail_here(r, "an object is needed");
	json_object_foreach(object, key, value)
	{
		enter_key(r, key);
		GW_TRY(take_bake_key(r, key, value));
		leave(r);
	}
	return GW_OK;
}

/* ------------------------------------------------------------------------------- the scene */

static gw_status take_units(const reader *r, json_t *value)
{
	const char *units = json_string_value(value);
	if (units && strcmp(units, "radiometric") == 0)
		r->settings->units = LIGHT_UNITS_RADIOMETRIC;
	else if (units && strcmp(units, "photometric") == 0)
		r->settings->units = LIGHT_UNITS_PHOTOMETRIC;
	else
		return fail_here(r, "it must be \"radiometric\" or \"photometric\"");
	r->settings->units_said = true;
	return GW_OK;
}

static gw_status take_list(reader *r, json_t *list, gw_status (*take)(reader *, json_t *))
{
	if (!json_is_array(list))
		return fail_here(r, "an array is needed");
	for (size_t i = 0; i < json_array_size(list); i++) {
		enter_index(r, i);
		GW_TRY(take(r, json_array_get(list, i)));
		leave(r);
	}
	return GW_OK;
}

static gw_status take_scanner(reader *r, json_t *value)
{
	double place[3];
	size_t count;
	GW_TRY(take_numbers(r, value, place, 3, false, &count));
	return settings_add_scanner(r->settings, place, r->error);
}

/* A list of places, or that nobody knows. */
static gw_status take_scanners(reader *r, json_t *value)
{
	if (!json_is_string(value))
		return take_list(r, value, take_scanner);
	if (strcmp(json_string_value(value), "none") != 0)
		return fail_here(r, "a list of places is needed, or \"none\"");
	settings_set_scanner_none(r->settings);
	return GW_OK;
}

static gw_status take_frame_count(const reader *r, json_t *value)
{
	json_int_t count = json_integer_value(value);
	if (!json_is_integer(value) || count < 1 || count > SETTINGS_FRAMES_MAX)
		return fail_here(r, "the number of frames is needed, 1 to %d", SETTINGS_FRAMES_MAX);
	r->settings->frame_count = (uint32_t)count;
	return GW_OK;
}

/* Paths must fit the frames, which may stand behind them. */
static gw_status check_frames(const reader *r)
{
	const settings *s = r->settings;
	if (s->path_count > 0 && s->frame_count == 0)
		return fail_here(r, "something moves, but not in how many frames; add \"frames\": N");
	for (size_t i = 0; i < s->path_count; i++) {
		const motion_path *path = &s->path[i];
		if (path->matrix_count > 0 && path->matrix_count != s->frame_count)
			return fail_here(r, "there are %zu matrices for %u frames; each frame needs one",
							 path->matrix_count, s->frame_count);
		if (path->key_count > 0 && path->key[path->key_count - 1].frame >= s->frame_count)
			return fail_here(r, "there is a keyframe %u, but the last frame is %u",
							 path->key[path->key_count - 1].frame, s->frame_count - 1);
	}
	return GW_OK;
}

static gw_status take_member(reader *r, const char *key, json_t *value)
{
	static const char *const name[] = { "version",  "units",  "inputs", "lights",
										"scanners", "frames", "bake" };
	if (strcmp(key, "version") == 0)
		return json_integer_value(value) == 1 ? GW_OK
											  : fail_here(r, "this program reads version 1 only");
	if (strcmp(key, "units") == 0)
		return take_units(r, value);
	if (strcmp(key, "inputs") == 0)
		return take_list(r, value, take_input);
	if (strcmp(key, "lights") == 0)
		return take_list(r, value, take_light);
	if (strcmp(key, "scanners") == 0)
		return take_scanners(r, value);
	if (strcmp(key, "frames") == 0)
		return take_frame_count(r, value);
	if (strcmp(key, "bake") == 0)
		return take_bake(r, value);
	return fail_key(r, name, sizeof name / sizeof *name);
}

static gw_status take_scene(reader *r, json_t *root)
{
	const char *key;
	json_t *value;
	if (!json_is_object(root))
		return fail_here(r, "a scene is an object");
	if (!json_object_get(root, "version"))
		return fail_here(r, "a scene begins with \"version\": 1");
	json_object_foreach(root, key, value)
	{
		enter_key(r, key);
		GW_TRY(take_member(r, key, value));
		leave(r);
	}
	return check_frames(r);
}

static gw_status parse(reader *r)
{
	json_error_t problem;
	if (r->in->length > SCENE_BYTES_MAX)
		return gw_fail(r->error, GW_ERROR_DATA, "%s has %zu bytes; that is no scene file", r->path,
					   r->in->length);
	/* jansson refuses what is nested more than 2048 deep. */
	json_t *root =
		json_loadb((const char *)r->in->data, r->in->length, JSON_REJECT_DUPLICATES, &problem);
	if (!root)
		return gw_fail(r->error, GW_ERROR_DATA, "%s, line %d, column %d: %s", r->path, problem.line,
					   problem.column, problem.text);
	gw_status status = take_scene(r, root);
	json_decref(root);
	return status;
}

/* Moves the last count entries of a table with total ones to place `to`. */
static gw_status move_last(void *table, size_t size, size_t total, size_t count, size_t to,
						   gw_error *error)
{
	char *base = table, *kept = reallocarray(NULL, count + 1, size);
	if (!kept)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to join two lists");
	if (count > 0) {
		memcpy(kept, base + (total - count) * size, count * size);
		memmove(base + (to + count) * size, base + to * size, (total - count - to) * size);
		memcpy(base + to * size, kept, count * size);
	}
	free(kept);
	return GW_OK;
}

gw_status scene_read(const char *path, size_t index, settings *s, gw_error *error)
{
	input_file in;
	GW_TRY(input_file_open(&in, path, error));
	size_t inputs = s->input_count, lights = s->light_count;
	reader r = { .path = path, .in = &in, .settings = s, .error = error };
	gw_status status = input_file_check(&in, parse(&r), error);
	input_file_close(&in);
	GW_TRY(status);
	GW_TRY(move_last(s->input, sizeof *s->input, s->input_count, s->input_count - inputs, index + 1,
					 error));
	if (s->light_count > 0)
		GW_TRY(move_last(s->light, sizeof *s->light, s->light_count, s->light_count - lights, 0,
						 error));
	free(s->input[index].path);
	memmove(&s->input[index], &s->input[index + 1],
			(s->input_count - index - 1) * sizeof *s->input);
	s->input_count--;
	return GW_OK;
}

/* Lights of the file that do not go together are the file's fault. They are the first ones. */
static gw_status check_lights(const settings *s, size_t count, gw_error *error)
{
	light_units units = LIGHT_UNITS_UNSAID;
	gw_error own;
	if (lights_agree(s->light, count, &units, &own) != GW_OK)
		return gw_fail(error, GW_ERROR_DATA, "%s: %s", s->scene, own.text);
	return GW_OK;
}

gw_status scene_read_all(settings *s, gw_error *error)
{
	bool any = false;
	for (size_t i = 0; i < s->input_count; i++) {
		if (!scene_is_file(s->input[i].path))
			continue;
		if (any)
			return gw_fail(error, GW_ERROR_USAGE, "%s is a second scene file; one is enough",
						   s->input[i].path);
		any = true;
		s->scene = settings_keep(s, s->input[i].path, error);
		if (!s->scene)
			return GW_ERROR_MEMORY;
		size_t before = s->input_count, lights = s->light_count;
		GW_TRY(scene_read(s->scene, i, s, error));
		GW_TRY(check_lights(s, s->light_count - lights, error));
		i += s->input_count - before;
	}
	GW_TRY(lights_agree(s->light, s->light_count, &s->units, error));
	return settings_read_luminaires(s, error);
}

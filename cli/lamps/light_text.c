#include "lamps/light_text.h"
#include "lamps/light_preset.h"

#include "program/nearest_name.h"
#include "program/words.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

/* The type called `word` ("sky" is an environment); GW_LIGHT_TYPE_COUNT when there is none. */
static gw_light_type type_by_name(const char *word)
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

size_t light_names(const char *name[LIGHT_NAMES_MAX])
{
	size_t count = 0;
	for (int type = 0; type < GW_LIGHT_TYPE_COUNT; type++)
		name[count++] = gw_light_type_name((gw_light_type)type);
	name[count++] = "sky";
	for (const light_preset *p = light_presets; p->name; p++) {
		assert(count < LIGHT_NAMES_MAX);
		name[count++] = p->name;
	}
	return count;
}

void light_list_names(char *text, size_t size)
{
	const char *name[LIGHT_NAMES_MAX];
	size_t count = light_names(name);
	text[0] = '\0';
	for (size_t i = 0; i < count; i++)
		list_name(text, size, name[i]);
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

/* -------------------------------------------------------------------------------- words */

static gw_status set_from_word(words *w, lamp *light, light_key_id id, const char *key)
{
	char sentence[GW_ERROR_TEXT];
	gw_error reason = { 0 };
	if (!words_next(w)) {
		snprintf(sentence, sizeof sentence, "'%.60s' wants %s behind it", key,
				 light_value_expected(light_keys[id].value));
		return words_fail(w, sentence);
	}
	bool numbers = light_key_moves(id) || light_keys[id].value == LIGHT_VALUE_PLACE ||
				   light_keys[id].value == LIGHT_VALUE_SIZE;
	gw_status status = numbers ? light_set_numbers(light, id, w->word, &reason)
							   : light_set_text(light, id, w->word, &reason);
	if (status == GW_OK && strlen(w->word) < WORD_MAX - 1)
		return GW_OK;
	if (status == GW_OK)
		snprintf(sentence, sizeof sentence, "the %.60s is too long; %d characters are the most",
				 key, WORD_MAX - 2);
	else
		snprintf(sentence, sizeof sentence, "%.40s is '%.60s': %.700s", key, w->word, reason.text);
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
	char sentence[GW_ERROR_TEXT], known[512], hint[NEAREST_NAME_HINT];
	list_keys(type, false, known, sizeof known);
	nearest_name_hint(hint, w->word, "", name, 2 * LIGHT_KEY_COUNT);
	snprintf(sentence, sizeof sentence, "a %s light has no '%.60s'; it has %s%s",
			 gw_light_type_name(type), w->word, known, hint);
	words_fail(w, sentence);
	return LIGHT_KEY_COUNT;
}

static gw_status find_type(words *w, lamp *out)
{
	char sentence[GW_ERROR_TEXT], known[256], hint[NEAREST_NAME_HINT];
	const char *name[LIGHT_NAMES_MAX];
	bool any = words_next(w);
	if (light_begin(w->word, out))
		return GW_OK;
	light_list_names(known, sizeof known);
	nearest_name_hint(hint, w->word, "", name, light_names(name));
	if (any)
		snprintf(sentence, sizeof sentence, "there is no light '%.60s'; there are %s%s", w->word,
				 known, hint);
	else
		snprintf(sentence, sizeof sentence, "a light begins with its type: %s", known);
	return words_fail(w, sentence);
}

/* What a preset says stands in its table and is right. */
static void take_preset(const light_preset *preset, lamp *light)
{
	gw_error error = { 0 };
	words w = words_of("--light", preset->keys, &error);
	while (words_next(&w)) {
		char key[WORD_MAX];
		memcpy(key, w.word, sizeof key);
		light_key_id id = find_key(&w, preset->type);
		gw_status status =
			id == LIGHT_KEY_COUNT ? GW_ERROR_USAGE : set_from_word(&w, light, id, key);
		assert(status == GW_OK);
		(void)status;
		light->preset |= 1u << id;
	}
	light->wanted = preset->needed;
}

bool light_begin(const char *word, lamp *light)
{
	const light_preset *preset = light_preset_find(word);
	gw_light_type type = preset ? preset->type : type_by_name(word);
	if (type == GW_LIGHT_TYPE_COUNT)
		return false;
	*light = light_default(type);
	if (preset)
		take_preset(preset, light);
	return true;
}

gw_status light_from_text(const char *text, lamp *out, gw_error *error)
{
	words w = words_of("--light", text, error);
	unsigned given = 0;
	GW_TRY(find_type(&w, out));
	while (words_next(&w)) {
		light_key_id id = find_key(&w, out->light.type);
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
	if (light_complete(out, given, false, &reason) != GW_OK)
		return words_fail(&w, reason.text);
	return GW_OK;
}

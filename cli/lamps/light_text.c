#include "lamps/light_text.h"

#include "program/nearest_name.h"
#include "program/words.h"

#include <stdio.h>
#include <string.h>

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
	if (light_complete(out, given, false, &reason) != GW_OK)
		return words_fail(&w, reason.text);
	return GW_OK;
}

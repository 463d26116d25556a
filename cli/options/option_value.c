/*
 * Values of options from text and back.
 */
#include "program/nearest_name.h"
#include "glowworm_host.h"
#include "files/number_text.h"
#include "options/options.h"
#include "options/scanner_text.h"
#include "program/words.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *albedo_name(int albedo)
{
	static const char *const name[] = { [SCAN_ALBEDO_AUTO] = "auto",
										[SCAN_ALBEDO_COLOR] = "rgb",
										[SCAN_ALBEDO_INTENSITY] = "intensity",
										[SCAN_ALBEDO_CONSTANT] = "constant:V",
										[SCAN_ALBEDO_PROPERTY] = "property:NAME",
										[SCAN_ALBEDO_COUNT] = NULL };
	return name[albedo];
}

static const char *(*choices_of(const option *o))(int)
{
	return o->type == OPTION_ALBEDO ? albedo_name : o->choice;
}

void option_argument(const option *o, char text[OPTION_VALUE])
{
	text[0] = '\0';
	bool list = o->type == OPTION_FIELDS || o->type == OPTION_VIEW || o->type == OPTION_EFFECTS;
	const char *(*choice)(int) = list ? NULL : choices_of(o);
	for (int i = 0; choice && choice(i); i++)
		snprintf(text + strlen(text), OPTION_VALUE - strlen(text), "%s%s", i ? "|" : "", choice(i));
	if (!choice && o->argument)
		snprintf(text, OPTION_VALUE, "%s%s%s", o->automatic ? o->automatic : "",
				 o->automatic ? "|" : "", o->argument);
}

void option_legal(const option *o, char text[OPTION_VALUE])
{
	char least[GW_SAID_NUMBER], most[GW_SAID_NUMBER];
	text[0] = '\0';
	const char *(*choice)(int) = choices_of(o);
	for (int i = 0; choice && choice(i); i++)
		snprintf(text + strlen(text), OPTION_VALUE - strlen(text), "%s%s",
				 !i              ? ""
				 : choice(i + 1) ? ", "
								 : " or ",
				 choice(i));
	gw_say_number(o->minimum, 15, least);
	gw_say_number(o->maximum, 15, most);
	if (o->type == OPTION_COUNT || o->type == OPTION_REAL)
		snprintf(text, OPTION_VALUE,
				 o->open                   ? "above %s and below %s"
				 : o->type == OPTION_COUNT ? "a whole number, %s to %s"
										   : "%s to %s",
				 least, most);
	if (o->type == OPTION_SEED)
		snprintf(text, OPTION_VALUE, "a whole number");
	if (o->type == OPTION_SIZE)
		snprintf(text, OPTION_VALUE, "bytes, or a number with K, M, G or T behind it");
	if (o->automatic && text[0])
		snprintf(text + strlen(text), OPTION_VALUE - strlen(text), ", or %s", o->automatic);
}

static void *place_of(const option *o, settings *s)
{
	return (char *)s + o->offset;
}

static gw_status fail_value(const option *o, const char *text, gw_error *error)
{
	char legal[OPTION_VALUE], hint[NEAREST_NAME_HINT] = "";
	const char *name[32] = { NULL };
	const char *(*choice)(int) = choices_of(o);
	size_t count = 0;
	for (; choice && count < 31 && choice((int)count); count++)
		name[count] = choice((int)count);
	name[count] = o->automatic;
	option_legal(o, legal);
	nearest_name_hint(hint, text, "", name, count + 1);
	return gw_fail(error, GW_ERROR_USAGE, "is '%.80s', but must be %s%s", text, legal, hint);
}

static bool read_whole(const char *text, double *value)
{
	size_t length = strlen(text), used = number_read(text, length, value);
	return used > 0 && used == length && !isnan(*value);
}

static gw_status set_choice(const option *o, settings *s, const char *text, gw_error *error)
{
	for (int i = 0; o->choice(i); i++)
		if (strcmp(text, o->choice(i)) == 0) {
			*(int *)place_of(o, s) = i;
			return GW_OK;
		}
	return fail_value(o, text, error);
}

/* "cells:LEVEL" among the choices is cells, a colon, and anything. */
static gw_status set_view(const option *o, settings *s, const char *text, gw_error *error)
{
	size_t length = strcspn(text, ":");
	for (int i = 0; o->choice(i); i++) {
		const char *name = o->choice(i);
		if (strcspn(name, ":") != length || strncmp(name, text, length) != 0 ||
			(name[length] == ':') != (text[length] == ':'))
			continue;
		s->render.detail = text[length] ? settings_keep(s, text + length + 1, error) : NULL;
		*(int *)place_of(o, s) = i;
		return text[length] && !s->render.detail ? GW_ERROR_MEMORY : GW_OK;
	}
	return fail_value(o, text, error);
}

static gw_status set_number(const option *o, settings *s, const char *text, gw_error *error)
{
	double value;
	if (o->automatic && strcmp(text, o->automatic) == 0) {
		value = o->automatic_value;
	} else {
		if (!read_whole(text, &value) || isinf(value))
			return fail_value(o, text, error);
		bool inside = o->open ? value > o->minimum && value < o->maximum
							  : value >= o->minimum && value <= o->maximum;
		if (!inside || (o->type == OPTION_COUNT && value != floor(value)))
			return fail_value(o, text, error);
	}
	if (o->type == OPTION_COUNT)
		*(uint32_t *)place_of(o, s) = (uint32_t)value;
	else
		*(float *)place_of(o, s) = (float)value;
	return GW_OK;
}

static gw_status set_seed(const option *o, settings *s, const char *text, gw_error *error)
{
	uint64_t value = 0;
	bool good = text[0] != '\0';
	for (const char *c = text; *c && good; c++)
		good = *c >= '0' && *c <= '9' && !__builtin_mul_overflow(value, 10u, &value) &&
			   !__builtin_add_overflow(value, (unsigned)(*c - '0'), &value);
	if (!good)
		return fail_value(o, text, error);
	*(uint64_t *)place_of(o, s) = value;
	return GW_OK;
}

static gw_status set_size(const option *o, settings *s, const char *text, gw_error *error)
{
	static const char suffix[] = "KMGT";
	if (strcmp(text, o->automatic) == 0) {
		*(uint64_t *)place_of(o, s) = 0;
		return GW_OK;
	}
	double value;
	size_t used = number_read(text, strlen(text), &value);
	const char *end = text + used, *found = *end ? strchr(suffix, *end & ~0x20) : NULL;
	for (const char *c = suffix; found && c <= found; c++)
		value *= 1024.0;
	end += found ? 1 : 0;
	end += found && *end == 'i' ? 1 : 0;
	end += found && *end == 'B' ? 1 : 0;
	if (used == 0 || *end || !(value >= 1.0 && value < 0x1p63))
		return fail_value(o, text, error);
	*(uint64_t *)place_of(o, s) = (uint64_t)value;
	return GW_OK;
}

static gw_status set_albedo(const option *o, settings *s, const char *text, gw_error *error)
{
	double value;
	if (strncmp(text, "constant:", 9) == 0) {
		if (!read_whole(text + 9, &value) || !(value >= 0.0 && value <= 1.0))
			return gw_fail(error, GW_ERROR_USAGE, "is '%.80s', but a constant must be 0 to 1",
						   text);
		s->points.albedo = SCAN_ALBEDO_CONSTANT;
		s->points.constant = (float)value;
		return GW_OK;
	}
	if (strncmp(text, "property:", 9) == 0 && text[9]) {
		s->points.albedo = SCAN_ALBEDO_PROPERTY;
		s->points.property = settings_keep(s, text + 9, error);
		return s->points.property ? GW_OK : GW_ERROR_MEMORY;
	}
	for (int i = 0; i < SCAN_ALBEDO_CONSTANT; i++)
		if (strcmp(text, albedo_name(i)) == 0) {
			s->points.albedo = (scan_albedo)i;
			return GW_OK;
		}
	return fail_value(o, text, error);
}

static gw_status set_fields(const option *o, settings *s, const char *text, gw_error *error)
{
	uint32_t set = 0;
	const char *at = text;
	while (*at) {
		size_t length = strcspn(at, ",");
		int i = 0;
		while (o->choice(i) &&
			   (strlen(o->choice(i)) != length || strncmp(at, o->choice(i), length)))
			i++;
		if (!o->choice(i)) {
			char part[OPTION_VALUE];
			snprintf(part, sizeof part, "%.*s", (int)length, at);
			return fail_value(o, part, error);
		}
		set |= 1u << i;
		at += length + (at[length] == ',');
	}
	*(uint32_t *)place_of(o, s) = set;
	return GW_OK;
}

/* Effects that change what was asked for, or the light by more than nothing, are forced by their
 * own names alone; and lists without signs are of light, so that the surface stays what it is. */
#define OF_SURFACE                                                                                 \
	(1u << GW_EFFECT_TRANSMISSION | 1u << GW_EFFECT_NORMALS | 1u << GW_EFFECT_NOISE |              \
	 1u << SETTINGS_EFFECT_GLOSS)
#define OF_RESULT (1u << GW_EFFECT_COLUMNS | 1u << SETTINGS_EFFECT_MOTION)
#define NOT_OF_ALL (1u << GW_EFFECT_NORMALS | OF_RESULT)
#define NOT_OF_LISTS (OF_SURFACE | OF_RESULT | 1u << GW_EFFECT_OCTREE)
#define OF_LIBRARY ((1u << GW_EFFECT_KIND_COUNT) - 1)

/* That of a name; 0: there is none. Options may offer a part of them. */
static uint32_t effect_called(const option *o, const char *word)
{
	bool offered = false;
	for (int i = 0; o->choice(i); i++)
		offered |= strcmp(o->choice(i), word) == 0;
	for (int i = 0; offered && i < SETTINGS_EFFECT_COUNT; i++)
		if (strcmp(settings_effect_name(i), word) == 0)
			return 1u << i;
	return 0;
}

static uint32_t effects_offered(const option *o)
{
	uint32_t all = 0;
	for (int i = 0; o->choice(i); i++)
		all |= effect_called(o, o->choice(i));
	return all;
}

/* One word of a list of effects. *alone: names without a sign so far. */
static bool set_effect(const option *o, settings_effects *e, const char *word, uint32_t *alone)
{
	char sign = *word == '+' || *word == '-' ? *word++ : '\0';
	if (!sign && strcmp(word, "auto") == 0)
		return true;
	if (!sign && strcmp(word, "all") == 0) {
		e->forced = effects_offered(o) & ~NOT_OF_ALL;
		return true;
	}
	uint32_t effect = effect_called(o, word);
	e->forced = (e->forced & ~effect) | (sign == '+' ? effect : 0);
	e->forbidden = (e->forbidden & ~effect) | (sign == '-' ? effect : 0);
	*alone |= sign ? 0 : effect;
	return effect != 0;
}

static gw_status fail_effect(const option *o, const char *word, gw_error *error)
{
	char hint[NEAREST_NAME_HINT] = "", names[OPTION_VALUE];
	const char *name[SETTINGS_EFFECT_COUNT];
	size_t count = 0;
	for (; o->choice((int)count); count++)
		name[count] = o->choice((int)count);
	option_legal(o, names);
	nearest_name_hint(hint, word + (*word == '+' || *word == '-'), "", name, count);
	return gw_fail(error, GW_ERROR_USAGE,
				   "has '%.80s', but takes auto, all, and %s %s, alone or with + or - "
				   "before %s%s",
				   word, count > 1 ? "the effects" : "the effect", names, count > 1 ? "them" : "it",
				   hint);
}

static gw_status set_effects(const option *o, settings *s, const char *text, gw_error *error)
{
	uint32_t alone = 0;
	settings_effects all = { 0 };
	char word[OPTION_VALUE];
	for (const char *at = text;; at++) {
		size_t length = strcspn(at, ",");
		snprintf(word, sizeof word, "%.*s", (int)length, at);
		if (!set_effect(o, &all, word, &alone))
			return fail_effect(o, word, error);
		at += length;
		if (!*at)
			break;
	}
	/* Those named, and whatever they need. */
	if (alone)
		all.forbidden |= effects_offered(o) & ~alone & ~all.forced & ~NOT_OF_LISTS;
	*(settings_effects *)place_of(o, s) =
		(settings_effects){ all.forced & ~OF_LIBRARY, all.forbidden & ~OF_LIBRARY };
	if (effects_offered(o) & OF_LIBRARY) {
		s->bake.effects_forced = all.forced & OF_LIBRARY;
		s->bake.effects_forbidden = all.forbidden & OF_LIBRARY;
	}
	return GW_OK;
}

static gw_status set_gain(settings *s, const char *text, bool group, gw_error *error)
{
	settings_gain gain = { .group = group };
	const char *equals = strrchr(text, '='), *at = equals ? equals + 1 : text;
	double value = NAN;
	int count = 0;
	while (equals && equals > text && count < 3) {
		size_t used = number_read(at, strlen(at), &value);
		if (used == 0 || !(value >= 0.0 && value <= 1e9))
			break;
		gain.factor[count++] = (float)value;
		at += used;
		if (*at != ',')
			break;
		at++;
	}
	if ((count != 1 && count != 3) || *at || at[-1] == ',')
		return gw_fail(error, GW_ERROR_USAGE,
					   "is '%.80s', but must be NAME=FACTOR or NAME=R,G,B with factors of 0 to 1e9",
					   text);
	for (int k = count; k < 3; k++)
		gain.factor[k] = gain.factor[0];
	const char *kept = settings_keep(s, text, error);
	if (!kept)
		return GW_ERROR_MEMORY;
	s->text[s->text_count - 1][equals - text] = '\0';
	gain.name = kept;
	return settings_add_gain(s, &gain, error);
}

/* A set-up's name, then a gain a word. */
static gw_status set_setup(settings *s, const char *text, gw_error *error)
{
	const char *colon = strchr(text, ':');
	char word[WORD_MAX];
	if (!colon || colon == text || !colon[1 + strspn(colon + 1, " ")])
		return gw_fail(error, GW_ERROR_USAGE,
					   "is '%.80s', but must be 'NAME: LAMP=FACTOR LAMP=FACTOR ...'", text);
	const char *name = settings_keep(s, text, error);
	if (!name)
		return GW_ERROR_MEMORY;
	s->text[s->text_count - 1][colon - text] = '\0';
	for (const char *at = colon + 1; at[strspn(at, " ")];) {
		at += strspn(at, " ");
		size_t length = strcspn(at, " ");
		if (length >= sizeof word)
			return gw_fail(error, GW_ERROR_USAGE, "has a word of more than %zu bytes",
						   sizeof word - 1);
		memcpy(word, at, length);
		word[length] = '\0';
		GW_TRY(set_gain(s, word, false, error));
		s->gain[s->gain_count - 1].setup = name;
		at += length;
	}
	return GW_OK;
}

gw_status option_set(const option *o, settings *s, const char *text, gw_error *error)
{
	lamp light;
	const char *kept;
	switch (o->type) {
	case OPTION_FLAG:
		*(bool *)place_of(o, s) = true;
		return GW_OK;
	case OPTION_TEXT:
		if (!*text)
			return gw_fail(error, GW_ERROR_USAGE, "is empty");
		kept = settings_keep(s, text, error);
		*(const char **)place_of(o, s) = kept;
		return kept ? GW_OK : GW_ERROR_MEMORY;
	case OPTION_CHOICE:
		return set_choice(o, s, text, error);
	case OPTION_VIEW:
		return set_view(o, s, text, error);
	case OPTION_COUNT:
	case OPTION_REAL:
		return set_number(o, s, text, error);
	case OPTION_SEED:
		return set_seed(o, s, text, error);
	case OPTION_SIZE:
		return set_size(o, s, text, error);
	case OPTION_LIGHT:
		if (light_from_text(text, &light, error) != GW_OK)
			return GW_ERROR_USAGE;
		return settings_add_light(s, &light, error);
	case OPTION_SCANNER:
		return scanner_text_add(s, text, error);
	case OPTION_GAIN:
		return set_gain(s, text, false, error);
	case OPTION_GROUP:
		return set_gain(s, text, true, error);
	case OPTION_SETUP:
		return set_setup(s, text, error);
	case OPTION_CAMERA:
		return settings_add_view(s, text, error);
	case OPTION_ALBEDO:
		return set_albedo(o, s, text, error);
	case OPTION_FIELDS:
		return set_fields(o, s, text, error);
	case OPTION_EFFECTS:
		return set_effects(o, s, text, error);
	}
	return GW_ERROR_INTERNAL;
}

/* ------------------------------------------------------------------------------ printing */

static void print_size(uint64_t bytes, char *text)
{
	static const char suffix[] = " KMGT";
	int power = 0;
	while (power < 4 && bytes && bytes % 1024 == 0) {
		bytes /= 1024;
		power++;
	}
	snprintf(text, OPTION_VALUE, "%" PRIu64 "%.*s", bytes, power ? 1 : 0, &suffix[power]);
}

static void print_albedo(const settings *s, char *text)
{
	int kind = (int)s->points.albedo;
	if (kind == SCAN_ALBEDO_CONSTANT) {
		memcpy(text, "constant:", 10);
		number_print_float(text + 9, s->points.constant);
	} else if (kind == SCAN_ALBEDO_PROPERTY) {
		snprintf(text, OPTION_VALUE, "property:%s", s->points.property);
	} else {
		snprintf(text, OPTION_VALUE, "%s", albedo_name(kind));
	}
}

static void print_fields(const option *o, uint32_t fields, char *text)
{
	text[0] = '\0';
	for (int i = 0; o->choice(i); i++)
		if (fields & 1u << i)
			snprintf(text + strlen(text), OPTION_VALUE - strlen(text), "%s%s", *text ? "," : "",
					 o->choice(i));
}

static void print_effects(const option *o, const settings *s, char text[OPTION_VALUE])
{
	const settings_effects *own = (const void *)((const char *)s + o->offset);
	bool library = effects_offered(o) & OF_LIBRARY;
	uint32_t all_forced = own->forced | (library ? s->bake.effects_forced : 0);
	uint32_t all_forbidden = own->forbidden | (library ? s->bake.effects_forbidden : 0);
	for (int i = 0; o->choice(i); i++) {
		uint32_t effect = effect_called(o, o->choice(i));
		bool forced = all_forced & effect, forbidden = all_forbidden & effect;
		if (forced || forbidden)
			snprintf(text + strlen(text), OPTION_VALUE - strlen(text), "%s%c%s", *text ? "," : "",
					 forced ? '+' : '-', o->choice(i));
	}
	if (!*text)
		snprintf(text, OPTION_VALUE, "auto");
}

bool option_print(const option *o, const settings *s, char text[OPTION_VALUE])
{
	const void *place = (const char *)s + o->offset;
	double number = o->type == OPTION_REAL    ? (double)*(const float *)place
					: o->type == OPTION_COUNT ? (double)*(const uint32_t *)place
											  : 0.0;
	bool same = number == o->automatic_value || (isnan(number) && isnan(o->automatic_value));
	text[0] = '\0';
	if (o->type == OPTION_FLAG)
		snprintf(text, OPTION_VALUE, "%s", *(const bool *)place ? "true" : "false");
	else if (o->type == OPTION_TEXT && *(const char *const *)place)
		snprintf(text, OPTION_VALUE, "%s", *(const char *const *)place);
	else if (o->type == OPTION_CHOICE || o->type == OPTION_VIEW)
		snprintf(text, OPTION_VALUE, "%s", o->choice(*(const int *)place));
	else if (o->type == OPTION_SEED)
		snprintf(text, OPTION_VALUE, "%" PRIu64, *(const uint64_t *)place);
	else if (o->type == OPTION_SIZE && *(const uint64_t *)place)
		print_size(*(const uint64_t *)place, text);
	else if (o->type == OPTION_ALBEDO)
		print_albedo(s, text);
	else if (o->type == OPTION_FIELDS)
		print_fields(o, *(const uint32_t *)place, text);
	else if (o->type == OPTION_EFFECTS)
		print_effects(o, s, text);
	else if (o->automatic && same)
		snprintf(text, OPTION_VALUE, "%s", o->automatic);
	else if (o->type == OPTION_REAL)
		number_print_float(text, *(const float *)place);
	else if (o->type == OPTION_COUNT)
		snprintf(text, OPTION_VALUE, "%" PRIu32, *(const uint32_t *)place);
	return text[0] != '\0';
}

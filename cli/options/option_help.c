/*
 * --help.
 */
#include "lamps/light_preset.h"
#include "options/option_text.h"

#include <string.h>

#define COLUMNS 80
#define INDENT 27

void option_text_usage(FILE *out)
{
	fprintf(out, "Lights point clouds: adds to every point the light that it sends out.\n\n");
	for (int v = 0; verb_name(v); v++)
		fprintf(out, "%s glowworm %s\n", v ? "      " : "Usage:", verb_synopsis((verb)v));
	fprintf(out, "       glowworm VERB --help | help VERB | --version\n\n");
	fprintf(out, "Example: glowworm bake cave.ply --light 'point at 1,2,1.5 intensity 40' "
				 "-o lit.ply\n");
}

/* Writes words from a column on, with line breaks; *column is where the line stands. */
static void write_words(FILE *out, const char *text, size_t *column)
{
	while (*text) {
		size_t length = strcspn(text, " ");
		if (*column + 1 + length > COLUMNS) {
			fprintf(out, "\n%*s", INDENT, "");
			*column = INDENT;
		} else if (*column > INDENT) {
			fputc(' ', out);
			(*column)++;
		}
		fprintf(out, "%.*s", (int)length, text);
		*column += length;
		text += length + (text[length] == ' ');
	}
}

static void write_option(FILE *out, const option *o, const settings *defaults)
{
	char argument[OPTION_VALUE], text[OPTION_VALUE], note[2 * OPTION_VALUE] = "";
	char left[2 * OPTION_VALUE];
	option_argument(o, argument);
	snprintf(left, sizeof left, "  %c%c%c --%s%s%s", o->letter ? '-' : ' ',
			 o->letter ? o->letter : ' ', o->letter ? ',' : ' ', o->name, *argument ? " " : "",
			 argument);
	fputs(left, out);
	size_t column = strlen(left);
	if (column >= INDENT) {
		fprintf(out, "\n%*s", INDENT, "");
	} else {
		fprintf(out, "%*s", (int)(INDENT - column), "");
	}
	column = INDENT;
	write_words(out, o->help, &column);
	option_legal(o, text);
	if (*text && (o->type == OPTION_COUNT || o->type == OPTION_REAL || o->type == OPTION_FIELDS ||
				  o->type == OPTION_VIEW)) {
		snprintf(note, sizeof note, "(%s)", text);
		write_words(out, note, &column);
	}
	if (o->type != OPTION_FLAG && option_print(o, defaults, text)) {
		snprintf(note, sizeof note, "[default: %s]", text);
		write_words(out, note, &column);
	}
	fputc('\n', out);
}

static void write_lights(FILE *out)
{
	fprintf(out,
			"\nLights: a type, then pairs of key and value; colours are R,G,B or one number\n");
	for (int t = 0; t < GW_LIGHT_TYPE_COUNT; t++) {
		fprintf(out, "  %s%s\n", gw_light_type_name((gw_light_type)t),
				t == GW_LIGHT_ENVIRONMENT ? " or sky" : "");
		for (int k = 0; k < LIGHT_KEY_COUNT; k++) {
			const light_key *key = &light_keys[k];
			if (key->types & 1u << t)
				fprintf(out, "    %-14s %s\n", key->word ? key->word : key->name, key->help);
		}
	}
	fprintf(out, "\nLamps by name, in place of a type; what is said behind them wins\n");
	for (const light_preset *p = light_presets; p->name; p++)
		fprintf(out, "  %-16s %s%s\n", p->name, p->about, p->estimated ? " (an estimate)" : "");
}

void option_text_help(verb v, FILE *out)
{
	settings defaults = settings_default();
	const char *group = "";
	fprintf(out, "glowworm %s - %s\n\nUsage: glowworm %s\n", verb_name(v), verb_summary(v),
			verb_synopsis(v));
	if (v == VERB_BAKE)
		fprintf(out, "An input is a point cloud, or a scene file that ends in .json; - is standard "
					 "input.\n");
	for (const option *o = options; o->name; o++) {
		if (!(o->verbs & 1u << v))
			continue;
		if (strcmp(group, o->group) != 0)
			fprintf(out, "\n%s\n", o->group);
		group = o->group;
		write_option(out, o, &defaults);
	}
	if (v == VERB_BAKE)
		write_lights(out);
}

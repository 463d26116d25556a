/*
 * --help.
 */
#include "lamps/light_preset.h"
#include "options/option_text.h"

#include <string.h>

#define COLUMNS 80
#define INDENT 27
#define LEFT_INDENT 12
#define KEY_INDENT 19

void option_text_usage(FILE *out)
{
	fprintf(out, "Lights point clouds: adds to every point the light that it sends out.\n\n"
				 "Usage: glowworm VERB INPUT... [option]...\n");
	for (int g = 0; verb_group_name(g); g++) {
		fprintf(out, "\n%s\n", verb_group_name(g));
		for (int v = 0; verb_name(v); v++)
			if (verb_group((verb)v) == g)
				fprintf(out, "  %-10s %s\n", verb_name(v), verb_summary((verb)v));
	}
	fprintf(out, "\nHelp\n"
				 "  glowworm VERB --help       what most people need of it, with examples\n"
				 "  glowworm VERB --help all   every option\n"
				 "  man glowworm-VERB          all that there is to say\n"
				 "  glowworm --version\n\n"
				 "Example\n"
				 "  glowworm bake cave.ply --light 'point at 1,2,1.5 intensity 40' -o lit.ply\n");
}

/* Writes words, with line breaks, from a column on and further lines from another.
 *   column   where the line stands; receives where it ends
 *   fresh    no blank stands before the first word */
static void write_words(FILE *out, const char *text, size_t indent, size_t *column, bool fresh)
{
	while (*text) {
		size_t length = strcspn(text, " ");
		if (*column + !fresh + length > COLUMNS && *column > indent) {
			fprintf(out, "\n%*s", (int)indent, "");
			*column = indent;
		} else if (!fresh) {
			fputc(' ', out);
			(*column)++;
		}
		fprintf(out, "%.*s", (int)length, text);
		*column += length;
		text += length + (text[length] == ' ');
		fresh = false;
	}
}

/* A line that begins with a title, and goes on below what stands behind it. */
static void write_titled(FILE *out, const char *title, const char *text, size_t indent)
{
	size_t column = strlen(title);
	fputs(title, out);
	write_words(out, text, indent, &column, true);
	fputc('\n', out);
}

/* What an option is called; among many values lines break. */
static void write_left(FILE *out, const char *left, size_t *column)
{
	*column = 0;
	while (*left) {
		size_t length = strcspn(left, "|");
		length += left[length] == '|';
		if (*column + length > COLUMNS && *column > LEFT_INDENT) {
			fprintf(out, "\n%*s", LEFT_INDENT, "");
			*column = LEFT_INDENT;
		}
		fprintf(out, "%.*s", (int)length, left);
		*column += length;
		left += length;
	}
}

/* What an option is for, without what else there is to know: up to where a sentence ends. */
static void first_words(const char *help, char *text, size_t size)
{
	size_t length = strlen(help);
	const char *const ends[] = { ". ", "; " };
	for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
		const char *end = strstr(help, ends[i]);
		if (end && (size_t)(end - help) < length)
			length = (size_t)(end - help);
	}
	snprintf(text, size, "%.*s", (int)length, help);
}

static void write_option(FILE *out, const option *o, const settings *defaults, bool all)
{
	char argument[OPTION_VALUE], text[OPTION_VALUE], note[2 * OPTION_VALUE] = "";
	char left[2 * OPTION_VALUE], words[4 * OPTION_VALUE];
	option_argument(o, argument);
	snprintf(left, sizeof left, "  %c%c%c --%s%s%s", o->letter ? '-' : ' ',
			 o->letter ? o->letter : ' ', o->letter ? ',' : ' ', o->name, *argument ? " " : "",
			 argument);
	size_t column;
	write_left(out, left, &column);
	if (column >= INDENT)
		fprintf(out, "\n%*s", INDENT, "");
	else
		fprintf(out, "%*s", (int)(INDENT - column), "");
	column = INDENT;
	first_words(o->help, words, sizeof words);
	write_words(out, all ? o->help : words, INDENT, &column, true);
	option_legal(o, text);
	if (*text && (o->type == OPTION_COUNT || o->type == OPTION_REAL || o->type == OPTION_FIELDS ||
				  o->type == OPTION_VIEW)) {
		snprintf(note, sizeof note, "(%s)", text);
		write_words(out, note, INDENT, &column, false);
	}
	if (o->type != OPTION_FLAG && option_print(o, defaults, text)) {
		snprintf(note, sizeof note, "[default: %s]", text);
		write_words(out, note, INDENT, &column, false);
	}
	fputc('\n', out);
}

/* A word, and what it means beside it. */
static void write_key(FILE *out, int before, const char *word, const char *help)
{
	char title[OPTION_VALUE];
	snprintf(title, sizeof title, "%*s%-*s", before, "", KEY_INDENT - before, word);
	write_titled(out, title, help, KEY_INDENT);
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
				write_key(out, 4, key->word ? key->word : key->name, key->help);
		}
	}
	fprintf(out, "\nLamps by name, in place of a type; what is said behind them wins\n");
	for (const light_preset *p = light_presets; p->name; p++) {
		char about[OPTION_VALUE];
		snprintf(about, sizeof about, "%s%s", p->about, p->estimated ? " (an estimate)" : "");
		write_key(out, 2, p->name, about);
	}
}

/* How to write lights, for those who have never done it. */
static void write_light_examples(FILE *out)
{
	fputs("\nLights: --light, once for each; type, keys and values; metres, W, W/m^2, degrees\n"
		  "  --light 'point at 1,2,1.5 intensity 40'                 a bulb, 40 W/sr\n"
		  "  --light 'spot at 1,2,0.5 to 4,2,0 intensity 200 inner 20 outer 30'\n"
		  "  --light 'sun from 135,40 irradiance 3'                  azimuth, elevation\n"
		  "  --light 'sun place 47.05,8.3 time 2026-06-21T16:30+02:00 illuminance 80000'\n"
		  "  --light 'sky radiance 0.3,0.4,0.6'                      R,G,B, or one number\n"
		  "  --light 'carbide at floor:2'                            a lamp by its name:\n",
		  out);
	size_t column = 4;
	fputs("   ", out);
	for (const light_preset *p = light_presets; p->name; p++) {
		size_t length = strlen(p->name) + 1;
		if (column + length > COLUMNS) {
			fputs("\n   ", out);
			column = 4;
		}
		fprintf(out, " %s", p->name);
		column += length;
	}
	fputs("\n  `glowworm info --places FILE` names places; --help all lists every key.\n", out);
}

static void write_examples(FILE *out, verb v)
{
	fputs("\nExamples\n", out);
	for (const char *line = verb_examples(v); *line;) {
		size_t length = strcspn(line, "\n");
		fprintf(out, "  %.*s\n", (int)length, line);
		line += length + (line[length] == '\n');
	}
}

/* Verbs with no more options than this show all of them. */
#define FEW_OPTIONS 12

static size_t count_options(verb v)
{
	size_t count = 0;
	for (const option *o = options; o->name; o++)
		count += (o->verbs & 1u << v) != 0;
	return count;
}

/* Options under the headings of their groups; of the short list in one piece. */
static void write_options(FILE *out, verb v, bool all)
{
	settings defaults = settings_default();
	const char *group = "";
	bool few = count_options(v) <= FEW_OPTIONS;
	if (!all)
		fprintf(out, "\n%s\n", few ? "Options" : "Options that most people need");
	for (const option *o = options; o->name; o++) {
		if (!(o->verbs & 1u << v) || !(all || few || o->common & 1u << v))
			continue;
		if (all && strcmp(group, o->group) != 0)
			fprintf(out, "\n%s\n", o->group);
		group = o->group;
		write_option(out, o, &defaults, all);
	}
}

void option_text_help(verb v, bool all, FILE *out)
{
	char text[OPTION_VALUE];
	size_t count = count_options(v);
	fprintf(out, "glowworm %s - %s\n\n", verb_name(v), verb_summary(v));
	snprintf(text, sizeof text, "Usage: glowworm %s", verb_synopsis(v));
	write_titled(out, "", text, sizeof "Usage: glowworm" + strlen(verb_name(v)) + 1);
	if (v == VERB_BAKE)
		write_titled(out, "",
					 "An input is a point cloud, or a scene file that ends in .json; - is standard "
					 "input.",
					 0);
	if (v == VERB_BAKE && !all)
		write_light_examples(out);
	write_examples(out, v);
	write_options(out, v, all);
	if (v == VERB_BAKE && all)
		write_lights(out);
	if (all)
		return;
	if (count > FEW_OPTIONS)
		snprintf(text, sizeof text,
				 "All %zu options: glowworm %s --help all. All about it: man glowworm-%s", count,
				 verb_name(v), verb_name(v));
	else
		snprintf(text, sizeof text, "More about each: glowworm %s --help all, man glowworm-%s",
				 verb_name(v), verb_name(v));
	write_titled(out, "\n", text, 0);
}

/*
 * What is made from the table of options when the program is built: the part of the manual that
 * repeats it, and completions for three shells.
 */
#include "program/exit_code.h"
#include "table/format_table.h"
#include "lamps/light_preset.h"
#include "options/option_text.h"

#include <string.h>

/* -------------------------------------------------------------------------------- manual */

/* Text for roff: dashes that can be copied, no backslashes, no control lines. */
static void write_roff(FILE *out, const char *text)
{
	for (const char *c = text; *c; c++) {
		if (*c == '-')
			fputs("\\-", out);
		else if (*c == '\\')
			fputs("\\e", out);
		else if ((c == text || c[-1] == '\n') && (*c == '.' || *c == '\''))
			fprintf(out, "\\&%c", *c);
		else
			fputc(*c, out);
	}
}

static void write_manual_option(FILE *out, const option *o, const settings *defaults)
{
	char argument[OPTION_VALUE], text[OPTION_VALUE];
	option_argument(o, argument);
	fputs(".TP\n.B ", out);
	if (o->letter)
		fprintf(out, "\\-%c\\fR, \\fB", o->letter);
	fputs("\\-\\-", out);
	write_roff(out, o->name);
	if (*argument) {
		fputs(" \\fI", out);
		write_roff(out, argument);
		fputs("\\fR", out);
	}
	fputc('\n', out);
	write_roff(out, o->help);
	fputs(".\n", out);
	option_legal(o, text);
	if (*text && (!o->choice || o->type == OPTION_VIEW)) {
		fputs("Legal: ", out);
		write_roff(out, text);
		fputs(".\n", out);
	} else if (o->type == OPTION_FIELDS) {
		fputs("A column is ", out);
		write_roff(out, text);
		fputs(".\n", out);
	}
	if (o->type != OPTION_FLAG && option_print(o, defaults, text)) {
		fputs("Default: ", out);
		write_roff(out, text);
		fputs(".\n", out);
	}
	if (o->scene) {
		option_key(o, text);
		fprintf(out, "In a scene file: \\fB%s\\fR.\n", text);
	}
}

/* Lamps that have names, and from where their numbers are. */
static void write_manual_presets(FILE *out)
{
	fputs(".SS Lamps by name\n"
		  "These stand in place of a type, on the command line and as \"type\" in scene files.\n"
		  "They are the type with keys that are known; whatever is said behind them wins:\n"
		  ".B candle at 1,2,3 kelvin 2000\n",
		  out);
	for (const light_preset *p = light_presets; p->name; p++) {
		fprintf(out, ".TP\n.B %s\n", p->name);
		write_roff(out, p->about);
		fprintf(out, "; %s %s", gw_light_type_name(p->type), p->keys);
		if (p->estimated)
			fprintf(out, ", an estimate of its intensity from\n%s", p->estimated);
		fputs(".\nSource: ", out);
		write_roff(out, p->source);
		fputs(".\n", out);
	}
}

static void write_manual_lights(FILE *out)
{
	fputs(".SH LIGHTS\n", out);
	fputs(
		"A light is its type and pairs of key and value, separated by blanks; numbers that belong\n"
		"together have commas and no blanks between them. A colour is R,G,B or one number, which\n"
		"is white. The scene file's name of a key, where it is another one, stands in brackets\n"
		"and is understood too.\n"
		".PP\nUnits may stand behind numbers: 40cd, 3W/sr, 400lm, 60W, 10000lx, 3W/m^2, 5cd/m^2.\n"
		"Without units they are what you take them for or, beside a lamp that has some, the same\n"
		"as its. Photometric and radiometric ones are never\n"
		"converted, because the luminous efficacy depends on the spectrum (683 lm/W at 540 THz\n"
		"alone), and cannot stand in one scene. Candela in give cd/m^2 out, lux are irradiance.\n"
		".PP\nThe sun stands by azimuth and elevation, or by place and time, to 0.01 degrees. "
		"Skies:\n"
		"overcast, intermediate and clear are the CIE standard overcast sky and types 7 and 12 of\n"
		"the CIE standard general sky (ISO 15469); physical is the clear sky of Preetham, Shirley\n"
		"and Smits (1999) with its colours, in cd/m^2; gradient goes from radiance overhead to\n"
		"horizon. None of them holds the sun itself, which is a light of its own.\n",
		out);
	for (int t = 0; t < GW_LIGHT_TYPE_COUNT; t++) {
		fprintf(out, ".SS %s%s\n", gw_light_type_name((gw_light_type)t),
				t == GW_LIGHT_ENVIRONMENT ? " (or sky)" : "");
		for (int k = 0; k < LIGHT_KEY_COUNT; k++) {
			const light_key *key = &light_keys[k];
			if (!(key->types & 1u << t))
				continue;
			fprintf(out, ".TP\n.B %s", key->word ? key->word : key->name);
			if (key->word && key->name)
				fprintf(out, " \\fR[%s]", key->name);
			fputc('\n', out);
			write_roff(out, key->help);
			fputs(key->needed & 1u << t ? "; needed.\n" : ".\n", out);
		}
	}
	write_manual_presets(out);
}

/* Which options most people need. */
static void write_manual_common(verb v, FILE *out)
{
	size_t left = 0;
	for (const option *o = options; o->name; o++)
		left += (o->common & 1u << v) != 0;
	if (left == 0)
		return;
	fputs("Most people need\n", out);
	for (const option *o = options; o->name; o++) {
		if (!(o->common & 1u << v))
			continue;
		fputs(".BR \\-\\-", out);
		write_roff(out, o->name);
		fputs(--left > 0 ? " ,\n" : "\nalone.\n", out);
	}
}

static void write_manual_verb(verb v, FILE *out)
{
	settings defaults = settings_default();
	const char *group = "";
	fputs(".SH OPTIONS\n", out);
	write_manual_common(v, out);
	for (const option *o = options; o->name; o++) {
		if (!(o->verbs & 1u << v))
			continue;
		if (strcmp(group, o->group) != 0)
			fprintf(out, ".SS %s\n", o->group);
		group = o->group;
		write_manual_option(out, o, &defaults);
	}
	if (v == VERB_BAKE)
		write_manual_lights(out);
}

static void write_manual_program(FILE *out)
{
	const char *meaning;
	fputs(".SH VERBS\n", out);
	for (int v = 0; verb_name(v); v++)
		fprintf(out, ".TP\n.BR glowworm\\-%s (1)\n%s\n", verb_name(v), verb_summary((verb)v));
	fputs(".SH FORMATS\n", out);
	for (size_t f = 0; formats[f]; f++) {
		fprintf(out, ".TP\n.B %s\n", formats[f]->name);
		write_roff(out, formats[f]->description);
		fprintf(out, "; %s%s%s.\n", formats[f]->read ? "read" : "",
				formats[f]->read && formats[f]->write ? " and " : "",
				formats[f]->write ? "written" : "");
	}
	fputs(".SH EXIT STATUS\n", out);
	for (int i = 0; exit_code_describe(i, &meaning) >= 0; i++) {
		fprintf(out, ".TP\n.B %d\n", exit_code_describe(i, &meaning));
		write_roff(out, meaning);
		fputs(".\n", out);
	}
}

/* ----------------------------------------------------------------------------- completions */

/* Words that a value can be; false when any text goes. */
static bool write_choices(FILE *out, const option *o)
{
	for (int i = 0; o->choice && o->choice(i); i++)
		fprintf(out, "%s%.*s", i ? " " : "", (int)(strcspn(o->choice(i), ":") + 1), o->choice(i));
	if (o->type == OPTION_ALBEDO)
		fputs("auto rgb intensity constant: property:", out);
	return o->choice || o->type == OPTION_ALBEDO;
}

static void write_bash(FILE *out)
{
	fputs("# Completion of glowworm for bash.\n_glowworm() {\n"
		  "\tlocal word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}\n"
		  "\tlocal verb=${COMP_WORDS[1]}\n\tCOMPREPLY=()\n"
		  "\tif [ \"$COMP_CWORD\" -eq 1 ]; then\n\t\tCOMPREPLY=($(compgen -W '",
		  out);
	for (int v = 0; verb_name(v); v++)
		fprintf(out, "%s ", verb_name(v));
	fputs("help --help --version' -- \"$word\"))\n\t\treturn\n\tfi\n\tcase $before in\n", out);
	fputs("\thelp) COMPREPLY=($(compgen -W '", out);
	for (int v = 0; verb_name(v); v++)
		fprintf(out, "%s ", verb_name(v));
	fputs("' -- \"$word\")); return ;;\n"
		  "\t--help) COMPREPLY=($(compgen -W all -- \"$word\")); return ;;\n",
		  out);
	for (const option *o = options; o->name; o++) {
		if (!o->choice && o->type != OPTION_ALBEDO)
			continue;
		fprintf(out, "\t--%s) COMPREPLY=($(compgen -W '", o->name);
		write_choices(out, o);
		fputs("' -- \"$word\")); return ;;\n", out);
	}
	fputs("\tesac\n\tcase $verb:$word in\n", out);
	for (int v = 0; verb_name(v); v++) {
		fprintf(out, "\t%s:-*) COMPREPLY=($(compgen -W '", verb_name(v));
		for (const option *o = options; o->name; o++)
			if (o->verbs & 1u << v)
				fprintf(out, "--%s ", o->name);
		fputs("' -- \"$word\")) ;;\n", out);
	}
	fputs("\t*) COMPREPLY=($(compgen -f -- \"$word\")) ;;\n\tesac\n}\n"
		  "complete -o filenames -F _glowworm glowworm\n",
		  out);
}

/* The help sentence within single quotes and brackets. */
static void write_plain(FILE *out, const char *text)
{
	for (const char *c = text; *c; c++)
		if (!strchr("'[]:`\"$\\", *c))
			fputc(*c, out);
}

static void write_zsh(FILE *out)
{
	fputs("#compdef glowworm\n# Completion of glowworm for zsh.\nlocal -a verbs\nverbs=(", out);
	for (int v = 0; verb_name(v); v++) {
		fprintf(out, " '%s:", verb_name(v));
		write_plain(out, verb_summary((verb)v));
		fputc('\'', out);
	}
	fputs(" )\nif (( CURRENT == 2 )); then\n\t_describe verb verbs\n\treturn\nfi\n"
		  "case $words[2] in\n",
		  out);
	for (int v = 0; verb_name(v); v++) {
		fprintf(out, "%s)\n\tshift words; (( CURRENT-- ))\n\t_arguments", verb_name(v));
		for (const option *o = options; o->name; o++) {
			if (!(o->verbs & 1u << v))
				continue;
			fprintf(out, " \\\n\t\t'%s--%s%s[", option_repeats(o) ? "*" : "", o->name,
					o->type == OPTION_FLAG ? "" : "=");
			write_plain(out, o->help);
			fputs(o->type == OPTION_FLAG ? "]" : "]:value:", out);
			if (o->choice || o->type == OPTION_ALBEDO) {
				fputc('(', out);
				write_choices(out, o);
				fputc(')', out);
			} else if (o->type == OPTION_TEXT) {
				fputs("_files", out);
			}
			fputc('\'', out);
		}
		fputs(" \\\n\t\t'*:input:_files'\n\t;;\n", out);
	}
	fputs("esac\n", out);
}

static void write_fish(FILE *out)
{
	fputs("# Completion of glowworm for fish.\n", out);
	for (int v = 0; verb_name(v); v++) {
		fprintf(out, "complete -c glowworm -n __fish_use_subcommand -a %s -d '", verb_name(v));
		write_plain(out, verb_summary((verb)v));
		fputs("'\n", out);
		for (const option *o = options; o->name; o++) {
			if (!(o->verbs & 1u << v))
				continue;
			fprintf(out, "complete -c glowworm -n '__fish_seen_subcommand_from %s' -l %s",
					verb_name(v), o->name);
			if (o->letter)
				fprintf(out, " -s %c", o->letter);
			if (o->choice || o->type == OPTION_ALBEDO) {
				fputs(" -x -a '", out);
				write_choices(out, o);
				fputc('\'', out);
			} else if (o->type != OPTION_FLAG) {
				fputs(" -r", out);
			}
			fputs(" -d '", out);
			write_plain(out, o->help);
			fputs("'\n", out);
		}
	}
}

gw_status option_text_generate(const char *what, FILE *out, gw_error *error)
{
	static const char page[] = "man-glowworm";
	if (strcmp(what, "bash") == 0) {
		write_bash(out);
	} else if (strcmp(what, "zsh") == 0) {
		write_zsh(out);
	} else if (strcmp(what, "fish") == 0) {
		write_fish(out);
	} else if (strcmp(what, page) == 0) {
		write_manual_program(out);
	} else {
		size_t length = sizeof page - 1;
		int v = 0;
		while (verb_name(v) && !(strncmp(what, page, length) == 0 && what[length] == '-' &&
								 strcmp(what + length + 1, verb_name(v)) == 0))
			v++;
		if (!verb_name(v))
			return gw_fail(error, GW_ERROR_USAGE,
						   "--generate makes man-glowworm, man-glowworm-VERB, bash, zsh or fish");
		write_manual_verb((verb)v, out);
	}
	return GW_OK;
}

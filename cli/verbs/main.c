/*
 * glowworm - finds the verb, reads its options, runs it, says what went wrong.
 */
#include "program/crash.h"
#include "program/exit_code.h"
#include "program/nearest_name.h"
#include "options/option_text.h"
#include "program/ranks.h"
#include "program/signals.h"
#include "program/text_quote.h"
#include "verbs/verbs.h"

#include <malloc.h>
#include <string.h>
#include <unistd.h>

static gw_status find_verb(const char *word, verb *found, gw_error *error)
{
	char hint[NEAREST_NAME_HINT], known[160] = "";
	const char *name[VERB_COUNT];
	for (int v = 0; v < VERB_COUNT; v++) {
		name[v] = verb_name(v);
		if (strcmp(word, name[v]) == 0) {
			*found = (verb)v;
			return GW_OK;
		}
		snprintf(known + strlen(known), sizeof known - strlen(known), "%s%s", v ? ", " : "",
				 name[v]);
	}
	return gw_fail(error, GW_ERROR_USAGE, "there is no verb '%.60s'; there are %s%s", word, known,
				   nearest_name_hint(hint, word, "", name, VERB_COUNT));
}

static gw_status call_verb(verb v, settings *s, gw_error *error)
{
	switch (v) {
	case VERB_BAKE:
		return verb_bake(s, error);
	case VERB_PLAN:
		return verb_plan(s, error);
	case VERB_INFO:
		return verb_info(s, error);
	case VERB_COMPARE:
		return verb_compare(s, error);
	case VERB_MIX:
		return verb_mix(s, error);
	case VERB_SAMPLE:
		return verb_sample(s, error);
	case VERB_CONVERT:
		return verb_convert(s, error);
	case VERB_RENDER:
		return verb_render(s, error);
	case VERB_TRADEOFF:
		return verb_tradeoff(s, error);
	case VERB_ALBEDO:
		return verb_albedo(s, error);
	case VERB_DOCTOR:
		return verb_doctor(s, error);
	case VERB_LAMP:
		return verb_lamp(s, error);
	case VERB_MEASURE:
		return verb_measure(s, error);
	case VERB_PROBES:
		return verb_probes(s, error);
	case VERB_METHODS:
		return verb_methods(s, error);
	case VERB_PAGE:
		return verb_page(s, error);
	case VERB_COUNT:
		break;
	}
	return GW_ERROR_INTERNAL;
}

/* Behind the request for help stands `all`; or what belongs to a command of which it is a part: an
 * option, or a file, whose name has an extension or a folder. */
static gw_status check_help(verb v, int count, char *const *argument, bool *all, gw_error *error)
{
	static const char *const known[] = { "all" };
	const char *word = NULL;
	for (int i = count - 2; i >= 0; i--)
		if (strcmp(argument[i], "--help") == 0 || strcmp(argument[i], "-h") == 0)
			word = argument[i + 1];
	char hint[NEAREST_NAME_HINT] = "";
	*all = word && strcmp(word, "all") == 0;
	if (!word || *all || word[0] == '-' || strpbrk(word, "./"))
		return GW_OK;
	nearest_name_hint(hint, word, "", known, 1);
	return gw_fail(
		error, GW_ERROR_USAGE,
		"'%.60s' is no help that there is; there are glowworm %s --help, and glowworm %s "
		"--help all%s",
		word, verb_name(v), verb_name(v), hint);
}

static gw_status run_verb(int count, char **argument, gw_error *error)
{
	verb v = VERB_BAKE;
	GW_TRY(find_verb(argument[0], &v, error));
	settings s = settings_default();
	gw_status status = options_parse(v, count - 1, argument + 1, &s, error);
	if (s.help) {
		bool all;
		status = check_help(v, count, argument, &all, error);
		if (status == GW_OK)
			option_text_help(v, all, stdout);
	} else if (status == GW_OK) {
		status = call_verb(v, &s, error);
	}
	settings_clear(&s);
	return status;
}

/* Help as other programs have it: `help`, `help VERB`, and `help VERB all`. */
static gw_status run_help(int count, char *const *word, gw_error *error)
{
	verb v = VERB_BAKE;
	if (count == 0) {
		option_text_usage(stdout);
		return GW_OK;
	}
	GW_TRY(find_verb(word[0], &v, error));
	if (count > 2 || (count == 2 && strcmp(word[1], "all") != 0))
		return gw_fail(error, GW_ERROR_USAGE,
					   "'%.60s' is too much; there are glowworm help %s, and glowworm help %s all",
					   word[count - 1], word[0], word[0]);
	option_text_help(v, count == 2, stdout);
	return GW_OK;
}

static gw_status run(int count, char **argument, gw_error *error)
{
	if (strcmp(argument[0], "--version") == 0 || strcmp(argument[0], "-V") == 0) {
		puts("glowworm " GW_VERSION);
		return GW_OK;
	}
	if (strcmp(argument[0], "--help") == 0 || strcmp(argument[0], "-h") == 0)
		return run_help(count - 1, argument + 1, error);
	if (strcmp(argument[0], "help") == 0)
		return run_help(count - 1, argument + 1, error);
	if (strcmp(argument[0], "--generate") == 0 && count == 2)
		return option_text_generate(argument[1], stdout, error);
	if (argument[0][0] == '-')
		return gw_fail(error, GW_ERROR_USAGE,
					   "'%.60s' is no option here; there are --help and --version", argument[0]);
	return run_verb(count, argument, error);
}

static int run_program(int count, char **argument)
{
	if (count < 2) {
		option_text_usage(stderr);
		return EXIT_CODE_USAGE;
	}
	gw_error error = { 0 };
	gw_status status = run(count - 1, argument + 1, &error);
	if (status == GW_OK)
		status = exit_code_flush(stdout, &error);
	bool said = error.text[0] != '\0' && (status != GW_ERROR_CANCELLED || ranks_speak());
	if (status != GW_OK && said)
		text_message(stderr, "glowworm: %s\n", error.text);
	return exit_code_of(status, signals_pending());
}

/* What is freed is used again instead of going back to the system, which would have to clear its
 * pages anew, and grows in steps that huge pages fit into: see gw_wish_huge_pages. Not of arrays of
 * a huge page and more, of which holes would stay between them: a twentieth of a million points. */
static void keep_freed_memory(void)
{
	mallopt(M_MMAP_THRESHOLD, 2 << 20);
	mallopt(M_TRIM_THRESHOLD, 64 << 20);
	mallopt(M_TOP_PAD, 16 << 20);
}

int main(int count, char **argument)
{
	keep_freed_memory();
	signals_install();
	crash_install();
	int code = run_program(count, argument);
	ranks_end(code);
	crash_finish();
	/* A loader that got no memory may hold its lock for ever, and wait for it at a normal end. */
	if (code == EXIT_CODE_MEMORY) {
		fflush(NULL);
		_exit(code);
	}
	return code;
}

/* lit_notes.c - see lit_notes.h. */
#include "result/lit_notes.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct finder {
	const scan *cloud;
	lit_notes *notes;
	gw_error *error;
} finder;

static gw_status fail_memory(const finder *f)
{
	return gw_fail(f->error, GW_ERROR_MEMORY, "no memory for what a file says of its light");
}

/* Adds a note, whose text it takes. */
static gw_status add(const finder *f, const char *key, char *text)
{
	lit_notes *n = f->notes;
	lit_note *more = text ? reallocarray(n->note, n->count + 1, sizeof *more) : NULL;
	if (!more) {
		free(text);
		return fail_memory(f);
	}
	n->note = more;
	n->note[n->count++] = (lit_note){ key, text };
	return GW_OK;
}

/* What stands behind the words with which a comment begins; NULL: it begins otherwise. */
static const char *behind(const char *comment, const char *words)
{
	size_t length = strlen(words);
	return strncmp(comment, words, length) == 0 ? comment + length : NULL;
}

/* The next word of a command as text_quote wrote it, without its quotes, to be freed; NULL without
 * one, or without memory. */
static char *next_word(const char **command)
{
	const char *at = *command + strspn(*command, " ");
	char *word = *at ? malloc(strlen(at) + 1) : NULL, *end = word;
	bool quoted = false;
	for (; word && *at && (quoted || *at != ' '); at++) {
		if (*at == '\'')
			quoted = !quoted;
		else if (!quoted && *at == '\\' && at[1])
			*end++ = *++at;
		else
			*end++ = *at;
	}
	if (word)
		*end = '\0';
	*command = at;
	return word;
}

/* Lamps that a command names, and scene files that may have more. */
static gw_status find_lamps(const finder *f, const char *command)
{
	bool lamp = false;
	gw_status status = GW_OK;
	while (status == GW_OK && command[strspn(command, " ")]) {
		char *word = next_word(&command);
		if (!word)
			return fail_memory(f);
		size_t length = strlen(word);
		bool scene = !lamp && length > 5 && strcmp(word + length - 5, ".json") == 0;
		bool next = !lamp && strcmp(word, "--light") == 0;
		char *text = lamp ? strdup(word) : NULL;
		if (scene && asprintf(&text, "lamps of %s", word) < 0)
			text = NULL;
		if (lamp || scene)
			status = add(f, "lit_by", text);
		free(word);
		lamp = next;
	}
	return status;
}

/* Adds what stands behind these words in each comment that has them at its beginning; behind `last`
 * in it, if that is not NULL. */
static gw_status find_said(const finder *f, const char *key, const char *words, const char *last)
{
	for (size_t c = 0; c < f->cloud->comment_count; c++) {
		const char *said = behind(f->cloud->comment[c], words);
		const char *part = said && last ? strstr(said, last) : said;
		if (part)
			GW_TRY(add(f, key, strdup(part + (last ? strlen(last) : 0))));
	}
	return GW_OK;
}

/* Names of lamps of which mix can make more or less, as in scalar_light_NAME_r. */
static gw_status find_columns(const finder *f)
{
	static const char prefix[] = "scalar_light_";
	for (size_t c = 0; c < f->cloud->column_count; c++) {
		const char *name = behind(f->cloud->column[c].name, prefix);
		size_t length = name ? strlen(name) : 0;
		if (length > 2 && strcmp(name + length - 2, "_r") == 0)
			GW_TRY(add(f, "lamps", strndup(name, length - 2)));
	}
	return GW_OK;
}

static gw_status find_all(const finder *f)
{
	for (size_t c = 0; c < f->cloud->comment_count; c++) {
		const char *command = behind(f->cloud->comment[c], "glowworm command:");
		if (command)
			GW_TRY(find_lamps(f, command));
	}
	GW_TRY(find_columns(f));
	GW_TRY(find_said(f, "unit", "glowworm units: ", "; "));
	GW_TRY(find_said(f, "exposure", "glowworm preview", "EV "));
	GW_TRY(find_said(f, "error", "glowworm estimated error: ", NULL));
	return find_said(f, "mixed", "glowworm mixed: ", NULL);
}

gw_status lit_notes_find(const scan *cloud, lit_notes *notes, gw_error *error)
{
	*notes = (lit_notes){ NULL, 0 };
	const finder f = { cloud, notes, error };
	gw_status status = find_all(&f);
	if (status != GW_OK)
		lit_notes_clear(notes);
	return status;
}

void lit_notes_clear(lit_notes *notes)
{
	for (size_t i = 0; i < notes->count; i++)
		free(notes->note[i].text);
	free(notes->note);
	*notes = (lit_notes){ NULL, 0 };
}

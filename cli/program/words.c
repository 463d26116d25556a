#include "program/words.h"
#include "files/number_text.h"

#include <stdio.h>
#include <string.h>

words words_of(const char *option, const char *text, gw_error *error)
{
	return (words){ .option = option, .text = text, .at = text, .error = error };
}

bool words_next(words *w)
{
	w->at += strspn(w->at, " \t\n");
	size_t length = strcspn(w->at, " \t\n");
	w->place = (size_t)(w->at - w->text) + 1;
	snprintf(w->word, sizeof w->word, "%.*s", (int)(length < WORD_MAX ? length : WORD_MAX - 1),
			 w->at);
	w->at += length;
	return length > 0;
}

gw_status words_fail(const words *w, const char *sentence)
{
	return gw_fail(w->error, GW_ERROR_USAGE, "%s '%.200s', character %zu: %s", w->option, w->text,
				   w->place, sentence);
}

size_t words_numbers(const char *word, double values[3])
{
	size_t count = 0, length = strlen(word);
	while (count < 3) {
		size_t used = number_read(word, length, &values[count]);
		if (used == 0)
			return 0;
		count++;
		word += used;
		length -= used;
		if (length == 0)
			return count;
		if (*word != ',')
			return 0;
		word++;
		length--;
	}
	return 0;
}

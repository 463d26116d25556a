#include "program/nearest_name.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#define LENGTH_MAX 63

static size_t smallest(size_t a, size_t b)
{
	return a < b ? a : b;
}

/* Edits between two words of at most LENGTH_MAX letters, by rows of the usual table. */
static size_t count_edits(const char *a, const char *b)
{
	size_t table[3][LENGTH_MAX + 1];
	size_t m = strlen(a), n = strlen(b);
	for (size_t j = 0; j <= n; j++)
		table[0][j] = j;
	for (size_t i = 1; i <= m; i++) {
		size_t *row = table[i % 3], *above = table[(i + 2) % 3], *two_above = table[(i + 1) % 3];
		row[0] = i;
		for (size_t j = 1; j <= n; j++) {
			row[j] = above[j - 1] + (a[i - 1] != b[j - 1]);
			row[j] = smallest(row[j], smallest(above[j], row[j - 1]) + 1);
			if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
				row[j] = smallest(row[j], two_above[j - 2] + 1);
		}
	}
	return table[m % 3][n];
}

const char *nearest_name_hint(char hint[NEAREST_NAME_HINT], const char *word, const char *prefix,
							  const char *const *name, size_t count)
{
	const char *best = NULL;
	size_t length = strlen(word), fewest = (length + 2) / 3 + 1;
	hint[0] = '\0';
	if (length == 0 || length > LENGTH_MAX)
		return hint;
	for (size_t i = 0; i < count; i++) {
		if (!name[i] || strlen(name[i]) > LENGTH_MAX)
			continue;
		bool begins = length >= 3 && strncasecmp(name[i], word, length) == 0;
		size_t edits = begins ? 1 : count_edits(word, name[i]);
		if (edits < fewest) {
			fewest = edits;
			best = name[i];
		}
	}
	if (best)
		snprintf(hint, NEAREST_NAME_HINT, "; did you mean '%s%.70s'?", prefix, best);
	return hint;
}

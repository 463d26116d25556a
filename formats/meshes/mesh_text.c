#include "meshes/mesh_text.h"
#include "files/number_text.h"

#include <stdio.h>
#include <string.h>

mesh_text mesh_text_start(const input_file *in)
{
	const char *at = (const char *)in->data;
	/* Some editors put a byte order mark before UTF-8. */
	bool mark = in->length >= 3 && memcmp(at, "\xef\xbb\xbf", 3) == 0;
	return (mesh_text){ .at = at + (mark ? 3 : 0), .end = at + in->length, .next = 1 };
}

/* Bytes of the line end at c: 0, 1, or 2 for CRLF. */
static size_t line_end(const char *c, const char *end)
{
	if (c == end || (*c != '\n' && *c != '\r'))
		return 0;
	return *c == '\r' && end - c > 1 && c[1] == '\n' ? 2 : 1;
}

/* Most lines are short, end in LF and are not joined with others; those are found quickly. */
static bool take_plain_line(mesh_text *t)
{
	size_t most = t->end - t->at < 1024 ? (size_t)(t->end - t->at) : 1024;
	const char *end = memchr(t->at, '\n', most);
	size_t length = end ? (size_t)(end - t->at) : 0;
	if (!end || memchr(t->at, '\r', length) || memchr(t->at, '\\', length))
		return false;
	t->stop = end;
	t->at = end + 1;
	return true;
}

bool mesh_text_next(mesh_text *t)
{
	if (t->at == t->end)
		return false;
	t->line += t->next;
	t->next = 1;
	t->word = t->stop = t->at;
	if (take_plain_line(t))
		return true;
	const char *c = t->at;
	bool comment = *c == '#';
	while (c < t->end) {
		size_t joined = *c == '\\' && !comment ? line_end(c + 1, t->end) : 0;
		size_t ended = line_end(c, t->end);
		t->next += joined > 0;
		c += joined ? joined + 1 : ended ? ended : 1;
		if (ended)
			break;
		t->stop = c;
	}
	t->at = c;
	return true;
}

/* A backslash is a blank where it joins lines. */
static inline bool is_blank(const char *c, const char *stop)
{
	if (*c > ' ' && *c != '\\')
		return false;
	return *c == ' ' || *c == '\t' || *c == '\v' || *c == '\f' || *c == '\r' || *c == '\n' ||
		   (*c == '\\' && line_end(c + 1, stop) > 0);
}

mesh_word mesh_text_word(mesh_text *t)
{
	while (t->word < t->stop && is_blank(t->word, t->stop))
		t->word++;
	const char *first = t->word;
	if (first < t->stop && *first == '#')
		return (mesh_word){ t->word = t->stop, 0 };
	while (t->word < t->stop && !is_blank(t->word, t->stop))
		t->word++;
	return (mesh_word){ first, (size_t)(t->word - first) };
}

mesh_word mesh_text_rest(const mesh_text *t)
{
	const char *first = t->word, *last = t->stop;
	while (first < last && is_blank(first, last))
		first++;
	while (last > first && is_blank(last - 1, last))
		last--;
	return (mesh_word){ first, (size_t)(last - first) };
}

bool mesh_word_is(mesh_word word, const char *name)
{
	return word.length == strlen(name) && memcmp(word.text, name, word.length) == 0;
}

bool mesh_text_number(mesh_text *t, double *value)
{
	mesh_word word = mesh_text_word(t);
	return word.length > 0 && number_read(word.text, word.length, value) == word.length;
}

const char *mesh_word_show(mesh_word word, char shown[44])
{
	size_t length = word.length < 40 ? word.length : 40;
	for (size_t i = 0; i < length; i++)
		shown[i] = word.text[i] >= ' ' && word.text[i] <= '~' ? word.text[i] : '?';
	snprintf(shown + length, 44 - length, "%s", word.length > length ? "..." : "");
	return shown;
}

#include "ply/ply_header.h"
#include "files/growing_table.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Both spellings of every type: the paper's, and the one with the size in it. */
static const char *const type_names[SCAN_TYPE_COUNT][2] = {
	[SCAN_INT8] = { "char", "int8" },        [SCAN_UINT8] = { "uchar", "uint8" },
	[SCAN_INT16] = { "short", "int16" },     [SCAN_UINT16] = { "ushort", "uint16" },
	[SCAN_INT32] = { "int", "int32" },       [SCAN_UINT32] = { "uint", "uint32" },
	[SCAN_FLOAT32] = { "float", "float32" }, [SCAN_FLOAT64] = { "double", "float64" },
};

const char *ply_type_name(scan_type type)
{
	return type_names[type][0];
}

/* --------------------------------------------------------------------------------- words */

typedef struct word {
	const char *text;
	size_t length;
} word;

/* The rest of a line that has more words than this is only needed whole, for comments. */
#define WORDS 6

typedef struct parser {
	const input_file *in;
	ply_header *header;
	scan *comments;
	gw_error *error;
	size_t at;    /* offset of the next line */
	bool bare_cr; /* lines end in CR only */
	bool has_format, has_vertex;
	word line; /* the current one, without its end */
	word word[WORDS];
	size_t words;
} parser;

static bool is_blank(char c)
{
	return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

static bool word_is(const word *w, const char *text)
{
	return w->length == strlen(text) && memcmp(w->text, text, w->length) == 0;
}

/* Text of a file made fit for a message: short, and nothing that a terminal would obey. */
static const char *shown(const word *w, char text[44])
{
	size_t length = w->length < 40 ? w->length : 40;
	for (size_t i = 0; i < length; i++)
		text[i] = w->text[i] >= ' ' && w->text[i] <= '~' ? w->text[i] : '?';
	snprintf(text + length, 44 - length, "%s", w->length > length ? "..." : "");
	return text;
}

static char *copied(const word *w)
{
	return strndup(w->text, w->length);
}

static gw_status fail_line(const parser *p, const word *w, const char *expected)
{
	char text[44];
	return gw_fail(p->error, GW_ERROR_DATA, "%s, line %zu: '%s' where %s was expected", p->in->name,
				   p->header->lines, shown(w, text), expected);
}

static gw_status fail_memory(const parser *p)
{
	return gw_fail(p->error, GW_ERROR_MEMORY, "no memory for the header of %s", p->in->name);
}

/* Takes the next line apart; false at the end of the bytes. */
static bool next_line(parser *p)
{
	const char *text = (const char *)p->in->data;
	size_t end = p->in->length < PLY_HEADER_BYTES ? p->in->length : PLY_HEADER_BYTES;
	if (p->at >= end)
		return false;
	const char *start = text + p->at;
	const char *stop = memchr(start, p->bare_cr ? '\r' : '\n', end - p->at);
	if (!stop)
		return false;
	p->line = (word){ start, (size_t)(stop - start) };
	p->at = (size_t)(stop - text) + 1;
	p->header->lines++;
	while (p->line.length > 0 && is_blank(p->line.text[p->line.length - 1]))
		p->line.length--;

	p->words = 0;
	for (size_t i = 0; i < p->line.length && p->words < WORDS;) {
		if (is_blank(start[i])) {
			i++;
			continue;
		}
		size_t first = i;
		while (i < p->line.length && !is_blank(start[i]))
			i++;
		p->word[p->words++] = (word){ start + first, i - first };
	}
	return true;
}

/* ------------------------------------------------------------------------- kinds of lines */

static gw_status take_format(parser *p)
{
	static const char *const names[] = { [PLY_ASCII] = "ascii",
										 [PLY_LITTLE_ENDIAN] = "binary_little_endian",
										 [PLY_BIG_ENDIAN] = "binary_big_endian" };
	if (p->words != 3 || !word_is(&p->word[2], "1.0"))
		return fail_line(p, &p->line, "'format ENCODING 1.0'");
	for (size_t e = 0; e < sizeof names / sizeof *names; e++) {
		if (word_is(&p->word[1], names[e])) {
			p->header->encoding = (ply_encoding)e;
			p->has_format = true;
			return GW_OK;
		}
	}
	return fail_line(p, &p->word[1], "ascii, binary_little_endian or binary_big_endian");
}

static bool parse_count(const word *w, uint64_t *count)
{
	*count = 0;
	for (size_t i = 0; i < w->length; i++) {
		if (w->text[i] < '0' || w->text[i] > '9')
			return false;
		if (__builtin_mul_overflow(*count, 10, count) ||
			__builtin_add_overflow(*count, (uint64_t)(w->text[i] - '0'), count))
			return false;
	}
	return w->length > 0;
}

static gw_status take_element(parser *p)
{
	ply_header *h = p->header;
	uint64_t count;
	if (p->words != 3)
		return fail_line(p, &p->line, "'element NAME COUNT'");
	if (!parse_count(&p->word[2], &count))
		return fail_line(p, &p->word[2], "a count of elements");
	bool vertex = word_is(&p->word[1], "vertex");
	if (vertex && p->has_vertex)
		return fail_line(p, &p->line, "only one element 'vertex'");
	if (vertex) {
		p->has_vertex = true;
		h->vertex = h->element_count;
	}
	ply_element *grown = growing_table_room(h->element, h->element_count, sizeof *grown);
	if (!grown)
		return fail_memory(p);
	h->element = grown;
	char *name = copied(&p->word[1]);
	if (!name)
		return fail_memory(p);
	h->element[h->element_count++] = (ply_element){ .name = name, .count = count };
	return GW_OK;
}

static bool parse_type(const word *w, scan_type *type)
{
	for (int t = 0; t < SCAN_TYPE_COUNT; t++) {
		if (word_is(w, type_names[t][0]) || word_is(w, type_names[t][1])) {
			*type = (scan_type)t;
			return true;
		}
	}
	return false;
}

static gw_status parse_property(parser *p, ply_property *property, const word **name)
{
	static const char types[] = "char, uchar, short, ushort, int, uint, float or double";
	property->list = p->words >= 2 && word_is(&p->word[1], "list");
	if (p->words != (property->list ? 5 : 3))
		return fail_line(p, &p->line, "'property TYPE NAME' or 'property list TYPE TYPE NAME'");
	const word *type = &p->word[property->list ? 3 : 1];
	if (!parse_type(type, &property->type))
		return fail_line(p, type, types);
	if (property->list) {
		const word *count = &p->word[2];
		if (!parse_type(count, &property->count_type) || property->count_type == SCAN_FLOAT32 ||
			property->count_type == SCAN_FLOAT64)
			return fail_line(p, count, "an integer type that counts the values of a list");
	}
	*name = type + 1;
	return GW_OK;
}

static gw_status take_property(parser *p)
{
	ply_header *h = p->header;
	ply_property property = { 0 };
	const word *name = NULL;
	if (h->element_count == 0)
		return fail_line(p, &p->line, "an element before its properties");
	GW_TRY(parse_property(p, &property, &name));
	ply_element *element = &h->element[h->element_count - 1];
	if (element->property_count >= PLY_PROPERTIES)
		return fail_line(p, &p->line, "no property after the 4096th");
	for (size_t i = 0; i < element->property_count; i++)
		if (word_is(name, element->property[i].name))
			return fail_line(p, name, "a property that was not there before");
	ply_property *grown =
		growing_table_room(element->property, element->property_count, sizeof *grown);
	if (!grown)
		return fail_memory(p);
	element->property = grown;
	property.name = copied(name);
	if (!property.name)
		return fail_memory(p);
	element->property[element->property_count++] = property;
	return GW_OK;
}

/* Keeps what follows the keyword; for obj_info the keyword too. */
static gw_status take_comment(parser *p, bool keep_keyword)
{
	const char *end = p->line.text + p->line.length;
	word text = { p->word[0].text + p->word[0].length, 0 };
	if (text.text < end && is_blank(*text.text))
		text.text++;
	if (keep_keyword)
		text.text = p->word[0].text;
	text.length = (size_t)(end - text.text);
	char *copy = copied(&text);
	if (!copy)
		return fail_memory(p);
	gw_status status = scan_add_comment(p->comments, copy, p->error);
	free(copy);
	return status;
}

static gw_status take_line(parser *p)
{
	const word *keyword = &p->word[0];
	if (memchr(p->line.text, '\0', p->line.length))
		return fail_line(p, &p->line, "text without zero bytes");
	if (word_is(keyword, "comment"))
		return take_comment(p, false);
	if (word_is(keyword, "obj_info"))
		return take_comment(p, true);
	if (word_is(keyword, "format"))
		return take_format(p);
	if (word_is(keyword, "element"))
		return take_element(p);
	if (word_is(keyword, "property"))
		return take_property(p);
	return fail_line(p, keyword, "format, element, property, comment, obj_info or end_header");
}

/* -------------------------------------------------------------------------- the whole header */

/* The first line tells how lines end. A bare CR is one that no LF follows. */
static gw_status take_first_line(parser *p)
{
	const char *text = (const char *)p->in->data;
	size_t length = p->in->length, i = 0;
	while (i < length && i < 16 && text[i] != '\n' && text[i] != '\r')
		i++;
	p->bare_cr = i + 1 < length && text[i] == '\r' && text[i + 1] != '\n';
	if (!next_line(p) || p->words != 1 || !word_is(&p->word[0], "ply"))
		return gw_fail(p->error, GW_ERROR_DATA, "%s is no PLY file: its first line is not 'ply'",
					   p->in->name);
	return GW_OK;
}

static gw_status check_whole(const parser *p)
{
	if (!p->has_format)
		return gw_fail(p->error, GW_ERROR_DATA, "%s: the header has no line 'format ENCODING 1.0'",
					   p->in->name);
	if (!p->has_vertex)
		return gw_fail(p->error, GW_ERROR_DATA,
					   "%s: the header has no element 'vertex', so the file holds no points",
					   p->in->name);
	return GW_OK;
}

static gw_status parse_lines(parser *p)
{
	GW_TRY(take_first_line(p));
	for (;;) {
		if (!next_line(p))
			return gw_fail(p->error, GW_ERROR_DATA,
						   "%s: no line 'end_header' in the first %zu bytes; the header "
						   "is cut short or damaged",
						   p->in->name,
						   p->in->length < PLY_HEADER_BYTES ? p->in->length : PLY_HEADER_BYTES);
		if (p->words == 1 && word_is(&p->word[0], "end_header"))
			break;
		if (p->words > 0)
			GW_TRY(take_line(p));
	}
	GW_TRY(check_whole(p));
	p->header->body = p->at;
	return GW_OK;
}

gw_status ply_header_parse(ply_header *header, const input_file *in, scan *comments,
						   gw_error *error)
{
	*header = (ply_header){ 0 };
	parser p = { .in = in, .header = header, .comments = comments, .error = error };
	gw_status status = parse_lines(&p);
	if (status != GW_OK)
		ply_header_clear(header);
	return status;
}

void ply_header_clear(ply_header *header)
{
	for (size_t e = 0; e < header->element_count; e++) {
		ply_element *element = &header->element[e];
		for (size_t i = 0; i < element->property_count; i++)
			free(element->property[i].name);
		free(element->property);
		free(element->name);
	}
	free(header->element);
	*header = (ply_header){ 0 };
}

#include "pcd/pcd_header.h"
#include "files/growing_table.h"
#include "files/number_text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* More than this is no header of a point cloud, and would only cost time. */
#define HEADER_BYTES ((size_t)1 << 20)

/* A word of the line. */
typedef struct word {
	const char *text;
	size_t length;
} word;

/* Keywords that have been seen. */
enum {
	SAW_FIELDS = 1,
	SAW_SIZE = 2,
	SAW_TYPE = 4,
	SAW_COUNT = 8,
	SAW_WIDTH = 16,
	SAW_HEIGHT = 32,
	SAW_POINTS = 64,
	SAW_DATA = 128
};

typedef struct parser {
	const input_file *in;
	pcd_header *header;
	scan *comments;
	gw_error *error;
	const char *at, *end; /* what is left of the line */
	unsigned saw;
} parser;

static bool is_blank(char c)
{
	return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

/* The next word of the line; false at its end. */
static bool next_word(parser *p, word *w)
{
	while (p->at < p->end && is_blank(*p->at))
		p->at++;
	w->text = p->at;
	while (p->at < p->end && !is_blank(*p->at))
		p->at++;
	w->length = (size_t)(p->at - w->text);
	return w->length > 0;
}

static bool word_is(const word *w, const char *text)
{
	return w->length == strlen(text) && memcmp(w->text, text, w->length) == 0;
}

static gw_status fail_line(const parser *p, const word *w, const char *expected)
{
	char text[44];
	size_t length = w->length < 40 ? w->length : 40;
	for (size_t i = 0; i < length; i++)
		text[i] = w->text[i] >= ' ' && w->text[i] <= '~' ? w->text[i] : '?';
	text[length] = '\0';
	return gw_fail(p->error, GW_ERROR_DATA, "%s, line %zu: '%s' where %s was expected", p->in->name,
				   p->header->lines, text, expected);
}

static bool parse_count(const word *w, uint64_t *count)
{
	*count = 0;
	for (size_t i = 0; i < w->length; i++) {
		if (w->text[i] < '0' || w->text[i] > '9' || __builtin_mul_overflow(*count, 10, count) ||
			__builtin_add_overflow(*count, (uint64_t)(w->text[i] - '0'), count))
			return false;
	}
	return w->length > 0;
}

/* ------------------------------------------------------------------------- kinds of lines */

static gw_status take_fields(parser *p)
{
	pcd_header *h = p->header;
	word w;
	while (next_word(p, &w)) {
		if (h->field_count == PCD_VALUES)
			return fail_line(p, &w, "no field after the 4096th");
		pcd_field *grown = growing_table_room(h->field, h->field_count, sizeof *grown);
		if (grown)
			h->field = grown;
		char *name = grown ? strndup(w.text, w.length) : NULL;
		if (!name)
			return gw_fail(p->error, GW_ERROR_MEMORY, "no memory for the header of %s",
						   p->in->name);
		h->field[h->field_count++] =
			(pcd_field){ .name = name, .size = 4, .type = 'F', .count = 1 };
	}
	return h->field_count ? GW_OK : fail_line(p, &w, "the name of a field");
}

static gw_status take_attribute(parser *p, unsigned which)
{
	word w;
	if (!(p->saw & SAW_FIELDS)) {
		next_word(p, &w);
		return fail_line(p, &w, "FIELDS before this line");
	}
	for (size_t f = 0; f < p->header->field_count; f++) {
		pcd_field *field = &p->header->field[f];
		uint64_t number = 0;
		if (!next_word(p, &w))
			return fail_line(p, &w, "a value for each field");
		bool counted = which != SAW_TYPE && parse_count(&w, &number);
		if (which == SAW_SIZE &&
			!(counted && (number == 1 || number == 2 || number == 4 || number == 8)))
			return fail_line(p, &w, "a size of 1, 2, 4 or 8 bytes");
		if (which == SAW_COUNT && !(counted && number >= 1 && number <= PCD_VALUES))
			return fail_line(p, &w, "a count from 1 to 4096");
		if (which == SAW_TYPE && !(w.length == 1 && strchr("IUF", *w.text)))
			return fail_line(p, &w, "a type I, U or F");
		if (which == SAW_SIZE)
			field->size = (size_t)number;
		else if (which == SAW_COUNT)
			field->count = (size_t)number;
		else
			field->type = *w.text;
	}
	return next_word(p, &w) ? fail_line(p, &w, "one value for each field") : GW_OK;
}

static gw_status take_count(parser *p, uint64_t *count)
{
	word w;
	if (!next_word(p, &w) || !parse_count(&w, count))
		return fail_line(p, &w, "a count");
	return GW_OK;
}

static gw_status take_viewpoint(parser *p)
{
	word w;
	for (int k = 0; k < 7; k++) {
		double *value = &p->header->viewpoint[k];
		if (!next_word(p, &w) || number_read(w.text, w.length, value) != w.length ||
			!isfinite(*value))
			return fail_line(p, &w, "one of seven finite numbers of a viewpoint");
	}
	return GW_OK;
}

static gw_status take_data(parser *p)
{
	static const char *const names[] = {
		[PCD_ASCII] = "ascii", [PCD_BINARY] = "binary", [PCD_COMPRESSED] = "binary_compressed"
	};
	word w;
	next_word(p, &w);
	for (size_t e = 0; e < sizeof names / sizeof *names; e++) {
		if (word_is(&w, names[e])) {
			p->header->encoding = (pcd_encoding)e;
			return GW_OK;
		}
	}
	return fail_line(p, &w, "ascii, binary or binary_compressed");
}

/* Comments are kept, but not the one that every such file begins with. */
static gw_status take_comment(parser *p)
{
	static const char usual[] = ".PCD v";
	const char *text = p->at + (p->at < p->end && *p->at == '#');
	while (text < p->end && is_blank(*text))
		text++;
	size_t length = (size_t)(p->end - text);
	while (length > 0 && is_blank(text[length - 1]))
		length--;
	if (length >= strlen(usual) && memcmp(text, usual, strlen(usual)) == 0)
		return GW_OK;
	char *copy = strndup(text, length);
	gw_status status = copy ? scan_add_comment(p->comments, copy, p->error)
							: gw_fail(p->error, GW_ERROR_MEMORY, "no memory for a comment line");
	free(copy);
	return status;
}

static gw_status take_line(parser *p)
{
	static const struct {
		const char *keyword;
		unsigned saw;
	} known[] = { { "FIELDS", SAW_FIELDS }, { "COLUMNS", SAW_FIELDS }, { "SIZE", SAW_SIZE },
				  { "TYPE", SAW_TYPE },     { "COUNT", SAW_COUNT },    { "WIDTH", SAW_WIDTH },
				  { "HEIGHT", SAW_HEIGHT }, { "POINTS", SAW_POINTS },  { "DATA", SAW_DATA } };
	pcd_header *h = p->header;
	unsigned which = 0;
	word w;
	if (!next_word(p, &w) || word_is(&w, "VERSION"))
		return GW_OK;
	if (word_is(&w, "VIEWPOINT"))
		return take_viewpoint(p);
	for (size_t k = 0; k < sizeof known / sizeof *known && !which; k++)
		which = word_is(&w, known[k].keyword) ? known[k].saw : 0;
	if (!which)
		return fail_line(p, &w,
						 "VERSION, FIELDS, SIZE, TYPE, COUNT, WIDTH, HEIGHT, VIEWPOINT, POINTS or "
						 "DATA");
	if (p->saw & which)
		return fail_line(p, &w, "a keyword that was not there before");
	p->saw |= which;
	if (which == SAW_FIELDS)
		return take_fields(p);
	if (which == SAW_DATA)
		return take_data(p);
	if (which == SAW_WIDTH || which == SAW_HEIGHT || which == SAW_POINTS)
		return take_count(p, which == SAW_WIDTH    ? &h->width
							 : which == SAW_HEIGHT ? &h->height
												   : &h->points);
	return take_attribute(p, which);
}

/* -------------------------------------------------------------------------- the whole header */

static gw_status check_fields(parser *p)
{
	pcd_header *h = p->header;
	for (size_t f = 0; f < h->field_count; f++) {
		const pcd_field *field = &h->field[f];
		if (field->type == 'F' && field->size < 4)
			return gw_fail(p->error, GW_ERROR_DATA,
						   "%s: the field '%.40s' is a floating-point number of %zu bytes, which "
						   "there is not",
						   p->in->name, field->name, field->size);
		h->values += field->count;
		h->stride += field->size * field->count;
	}
	if (h->values > PCD_VALUES)
		return gw_fail(p->error, GW_ERROR_DATA,
					   "%s: a point of %zu values is too large; 4096 is "
					   "the most",
					   p->in->name, h->values);
	return GW_OK;
}

static gw_status check_whole(parser *p)
{
	pcd_header *h = p->header;
	static const struct {
		unsigned saw;
		const char *keyword;
	} needed[] = { { SAW_FIELDS, "FIELDS" }, { SAW_SIZE, "SIZE" }, { SAW_TYPE, "TYPE" } };
	for (size_t k = 0; k < sizeof needed / sizeof *needed; k++)
		if (!(p->saw & needed[k].saw))
			return gw_fail(p->error, GW_ERROR_DATA, "%s: the header has no line %s", p->in->name,
						   needed[k].keyword);
	if (!(p->saw & SAW_HEIGHT))
		h->height = 1;
	if (!(p->saw & SAW_POINTS) &&
		(!(p->saw & SAW_WIDTH) || __builtin_mul_overflow(h->width, h->height, &h->points)))
		return gw_fail(p->error, GW_ERROR_DATA,
					   "%s: the header does not say how many points there are (POINTS, or WIDTH "
					   "and HEIGHT)",
					   p->in->name);
	return check_fields(p);
}

static bool next_line(parser *p)
{
	const char *text = (const char *)p->in->data;
	size_t end = p->in->length < HEADER_BYTES ? p->in->length : HEADER_BYTES;
	if (p->header->body >= end)
		return false;
	p->at = text + p->header->body;
	const char *stop = memchr(p->at, '\n', end - p->header->body);
	if (!stop)
		return false;
	p->end = stop;
	p->header->body = (size_t)(stop - text) + 1;
	p->header->lines++;
	return true;
}

static gw_status parse_lines(parser *p)
{
	while (!(p->saw & SAW_DATA)) {
		if (!next_line(p))
			return gw_fail(p->error, GW_ERROR_DATA,
						   "%s: no line DATA in the first %zu bytes; this is no PCD file, or its "
						   "header is cut short",
						   p->in->name,
						   p->in->length < HEADER_BYTES ? p->in->length : HEADER_BYTES);
		while (p->at < p->end && is_blank(*p->at))
			p->at++;
		GW_TRY(p->at < p->end && *p->at == '#' ? take_comment(p) : take_line(p));
	}
	return check_whole(p);
}

gw_status pcd_header_parse(pcd_header *header, const input_file *in, scan *comments,
						   gw_error *error)
{
	*header = (pcd_header){ .viewpoint = { 0, 0, 0, 1, 0, 0, 0 } };
	parser p = { .in = in, .header = header, .comments = comments, .error = error };
	gw_status status = parse_lines(&p);
	if (status != GW_OK)
		pcd_header_clear(header);
	return status;
}

void pcd_header_clear(pcd_header *header)
{
	for (size_t f = 0; f < header->field_count; f++)
		free(header->field[f].name);
	free(header->field);
	*header = (pcd_header){ 0 };
}

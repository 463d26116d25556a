#include "e57/e57_description.h"
#include "e57/e57_names.h"
#include "files/growing_table.h"
#include "files/number_text.h"

#include <expat.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Elements within elements: more are none of E57's. */
#define DEPTH 32
#define NAME 64
#define VALUE 64

typedef struct parser {
	const input_file *in;
	e57_description *to;
	XML_Parser xml;
	gw_status status;
	gw_error *error;
	char name[DEPTH][NAME]; /* of the elements that are open, cut to what fits */
	size_t depth;
	char value[VALUE]; /* text of the innermost element, as far as it fits */
	size_t value_length;
	char *comment; /* owned; text of a comment so far */
	size_t comment_length, comment_room;
} parser;

/* ------------------------------------------------------------------------------ failures */

static void fail(parser *p, const char *element, const char *what)
{
	if (p->status != GW_OK)
		return;
	p->status =
		gw_fail(p->error, GW_ERROR_DATA, "%s, line %lu of its description: <%.60s> %s", p->in->name,
				(unsigned long)XML_GetCurrentLineNumber(p->xml), element, what);
	XML_StopParser(p->xml, XML_FALSE);
}

static void fail_memory(parser *p)
{
	if (p->status != GW_OK)
		return;
	p->status =
		gw_fail(p->error, GW_ERROR_MEMORY, "no memory for the description of %s", p->in->name);
	XML_StopParser(p->xml, XML_FALSE);
}

/* --------------------------------------------------------------------------- attributes */

static const char *find_attribute(const char **attribute, const char *name)
{
	for (; *attribute; attribute += 2)
		if (strcmp(attribute[0], name) == 0)
			return attribute[1];
	return NULL;
}

static bool parse_integer(const char *text, int64_t *value)
{
	bool negative = *text == '-';
	int64_t sum = 0;
	text += *text == '-' || *text == '+';
	if (!*text)
		return false;
	for (; *text >= '0' && *text <= '9'; text++)
		if (__builtin_mul_overflow(sum, 10, &sum) ||
			(negative ? __builtin_sub_overflow(sum, *text - '0', &sum)
					  : __builtin_add_overflow(sum, *text - '0', &sum)))
			return false;
	*value = sum;
	return *text == '\0';
}

/* Takes an attribute of integers; false when it is there and is none. */
static bool take_integer(const char **attribute, const char *name, int64_t *value)
{
	const char *text = find_attribute(attribute, name);
	return !text || parse_integer(text, value);
}

static bool take_real(const char **attribute, const char *name, double *value)
{
	const char *text = find_attribute(attribute, name);
	return !text ||
		   (*text && number_read(text, strlen(text), value) == strlen(text) && isfinite(*value));
}

static bool parse_count(const char *text, uint64_t *value)
{
	int64_t parsed;
	if (!text || !parse_integer(text, &parsed) || parsed < 0)
		return false;
	*value = (uint64_t)parsed;
	return true;
}

/* ------------------------------------------------------------------------------ elements */

/* Whether the innermost element is a scan, or the `depth`th within one, below these names. */
static bool is_at(const parser *p, size_t depth, const char *a, const char *b)
{
	return p->depth == 3 + depth && strcmp(p->name[0], "e57Root") == 0 &&
		   strcmp(p->name[1], "data3D") == 0 && strcmp(p->name[2], "vectorChild") == 0 &&
		   (!a || strcmp(p->name[3], a) == 0) && (!b || strcmp(p->name[4], b) == 0);
}

static e57_scan *current(const parser *p)
{
	return p->to->scan_count ? &p->to->scan[p->to->scan_count - 1] : NULL;
}

static void add_scan(parser *p)
{
	e57_scan *grown = growing_table_room(p->to->scan, p->to->scan_count, sizeof *grown);
	if (!grown) {
		fail_memory(p);
		return;
	}
	p->to->scan = grown;
	grown[p->to->scan_count++] = (e57_scan){ .rotation = { 1, 0, 0, 0 } };
}

static void take_points(parser *p, const char *element, const char **attribute)
{
	const char *type = find_attribute(attribute, "type");
	if (!type || strcmp(type, "CompressedVector") != 0 ||
		!parse_count(find_attribute(attribute, "fileOffset"), &current(p)->offset) ||
		!parse_count(find_attribute(attribute, "recordCount"), &current(p)->count))
		fail(p, element, "is no CompressedVector with a fileOffset and a recordCount");
}

static bool find_type(const char **attribute, e57_type *type)
{
	const char *name = find_attribute(attribute, "type");
	const char *precision = find_attribute(attribute, "precision");
	if (!name)
		return false;
	if (strcmp(name, "Float") == 0)
		*type = precision && strcmp(precision, "single") == 0 ? E57_SINGLE : E57_DOUBLE;
	else if (strcmp(name, "Integer") == 0)
		*type = E57_INTEGER;
	else if (strcmp(name, "ScaledInteger") == 0)
		*type = E57_SCALED;
	else if (strcmp(name, "String") == 0)
		*type = E57_STRING;
	else
		return false;
	return true;
}

/* Bits that integers from minimum to maximum take. */
static unsigned bits_of(int64_t minimum, int64_t maximum)
{
	uint64_t range = (uint64_t)maximum - (uint64_t)minimum;
	return range ? 64u - (unsigned)__builtin_clzll(range) : 0;
}

static void take_field(parser *p, const char *element, const char **attribute)
{
	e57_field f = { .minimum = INT64_MIN, .maximum = INT64_MAX, .scale = 1.0 };
	e57_scan *scan = current(p);
	if (!find_type(attribute, &f.type)) {
		fail(p, element, "is of a type that records do not have");
		return;
	}
	bool whole = f.type == E57_INTEGER || f.type == E57_SCALED;
	if (whole &&
		(!take_integer(attribute, "minimum", &f.minimum) ||
		 !take_integer(attribute, "maximum", &f.maximum) || f.minimum > f.maximum ||
		 !take_real(attribute, "scale", &f.scale) || !take_real(attribute, "offset", &f.offset))) {
		fail(p, element, "has a minimum, maximum, scale or offset that makes no sense");
		return;
	}
	f.bits = whole ? bits_of(f.minimum, f.maximum) : f.type == E57_SINGLE ? 32 : 64;
	if (scan->field_count == E57_FIELDS) {
		fail(p, element, "is one field too many: 1024 are the most");
		return;
	}
	e57_field *grown = growing_table_room(scan->field, scan->field_count, sizeof *grown);
	if (grown)
		scan->field = grown;
	bool ours = false;
	f.name = grown ? strdup(element) : NULL;
	f.column = f.name ? e57_name_read(element, &ours) : NULL;
	if (f.name && (f.column || !ours)) {
		scan->field[scan->field_count++] = f;
	} else {
		free(f.name);
		fail_memory(p);
	}
}

/* Whether the innermost element is one of our comments. */
static bool is_comment(const parser *p)
{
	return p->depth == 3 && strcmp(p->name[0], "e57Root") == 0 &&
		   strcmp(p->name[1], E57_COMMENTS) == 0 && strcmp(p->name[2], "vectorChild") == 0;
}

static void add_to_comment(parser *p, const char *text, size_t length)
{
	if (p->comment_room - p->comment_length <= length) {
		size_t room = 2 * p->comment_room + length + 64;
		char *grown = realloc(p->comment, room);
		if (!grown) {
			fail_memory(p);
			return;
		}
		p->comment = grown;
		p->comment_room = room;
	}
	memcpy(p->comment + p->comment_length, text, length);
	p->comment_length += length;
	p->comment[p->comment_length] = '\0';
}

static void end_comment(parser *p)
{
	e57_description *d = p->to;
	char **grown = growing_table_room(d->comment, d->comment_count, sizeof *grown);
	char *text = strdup(p->comment ? p->comment : "");
	if (grown)
		d->comment = grown;
	if (grown && text) {
		d->comment[d->comment_count++] = text;
	} else {
		free(text);
		fail_memory(p);
	}
}

static void XMLCALL open_element(void *user, const char *element, const char **attribute)
{
	parser *p = user;
	if (p->status != GW_OK)
		return;
	if (p->depth == DEPTH) {
		fail(p, element, "is too deep within others");
		return;
	}
	snprintf(p->name[p->depth], NAME, "%s", element);
	p->depth++;
	p->value_length = 0;
	p->comment_length = 0;
	if (p->comment)
		p->comment[0] = '\0';
	if (is_at(p, 0, NULL, NULL))
		add_scan(p);
	else if (is_at(p, 1, "points", NULL))
		take_points(p, element, attribute);
	else if (is_at(p, 3, "points", "prototype"))
		take_field(p, element, attribute);
}

static void XMLCALL take_text(void *user, const char *text, int length)
{
	parser *p = user;
	if (p->status == GW_OK && is_comment(p) && length > 0)
		add_to_comment(p, text, (size_t)length);
	for (int i = 0; i < length; i++)
		if (p->value_length < VALUE && (unsigned char)text[i] > ' ')
			p->value[p->value_length++] = text[i];
}

/* Where a number of the pose goes that the innermost element holds, or NULL. */
static double *find_pose(const parser *p)
{
	static const char *const names[] = { "w", "x", "y", "z" };
	bool rotation = is_at(p, 3, "pose", "rotation");
	if (!rotation && !is_at(p, 3, "pose", "translation"))
		return NULL;
	for (size_t k = rotation ? 0 : 1; k < 4; k++)
		if (strcmp(p->name[5], names[k]) == 0)
			return rotation ? &current(p)->rotation[k] : &current(p)->translation[k - 1];
	return NULL;
}

static void XMLCALL close_element(void *user, const char *element)
{
	parser *p = user;
	if (p->status != GW_OK)
		return;
	double *pose = find_pose(p);
	if (is_comment(p))
		end_comment(p);
	if (pose) {
		/* An empty number is zero. */
		*pose = 0.0;
		if (p->value_length > 0 &&
			(number_read(p->value, p->value_length, pose) != p->value_length || !isfinite(*pose)))
			fail(p, element, "of a pose is no finite number");
		current(p)->has_pose = true;
	}
	p->value_length = 0;
	memset(p->name[--p->depth], 0, NAME);
}

/* Declarations of one's own could make a short text endless. */
static void XMLCALL refuse_declarations(void *user, const char *name, const char *system,
										const char *public_name, int internal)
{
	(void)system;
	(void)public_name;
	(void)internal;
	fail(user, name, "is declared, which E57 does not do");
}

static gw_status parse_text(parser *p, const e57_pages *pages)
{
	XML_SetUserData(p->xml, p);
	XML_SetElementHandler(p->xml, open_element, close_element);
	XML_SetCharacterDataHandler(p->xml, take_text);
	XML_SetStartDoctypeDeclHandler(p->xml, refuse_declarations);
	size_t at = pages->xml, left = pages->xml_length;
	enum XML_Status good = XML_STATUS_OK;
	while (left > 0 && good == XML_STATUS_OK) {
		size_t chunk = left < (1u << 20) ? left : 1u << 20;
		void *text = XML_GetBuffer(p->xml, (int)chunk);
		if (!text)
			return gw_fail(p->error, GW_ERROR_MEMORY, "no memory for the description of %s",
						   p->in->name);
		e57_pages_copy(pages, at, chunk, text);
		at += chunk;
		left -= chunk;
		good = XML_ParseBuffer(p->xml, (int)chunk, left == 0);
	}
	GW_TRY(p->status);
	if (good == XML_STATUS_OK && pages->xml_length > 0)
		return GW_OK;
	bool memory = XML_GetErrorCode(p->xml) == XML_ERROR_NO_MEMORY;
	if (memory)
		return gw_fail(p->error, GW_ERROR_MEMORY, "no memory for the description of %s",
					   p->in->name);
	return gw_fail(p->error, GW_ERROR_DATA, "%s, line %lu of its description is no XML: %s",
				   p->in->name, (unsigned long)XML_GetCurrentLineNumber(p->xml),
				   XML_ErrorString(XML_GetErrorCode(p->xml)));
}

gw_status e57_description_parse(e57_description *description, const e57_pages *pages,
								const input_file *in, gw_error *error)
{
	*description = (e57_description){ 0 };
	parser *p = calloc(1, sizeof *p);
	XML_Parser xml = p ? XML_ParserCreate(NULL) : NULL;
	gw_status status;
	if (!xml) {
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory for the description of %s", in->name);
	} else {
		*p = (parser){ .in = in, .to = description, .xml = xml, .error = error };
		status = parse_text(p, pages);
		XML_ParserFree(xml);
		free(p->comment);
	}
	free(p);
	if (status != GW_OK)
		e57_description_clear(description);
	return status;
}

static void clear_field(e57_field *field)
{
	free(field->name);
	free(field->column);
}

void e57_description_clear(e57_description *description)
{
	for (size_t s = 0; s < description->scan_count; s++) {
		for (size_t f = 0; f < description->scan[s].field_count; f++)
			clear_field(&description->scan[s].field[f]);
		free(description->scan[s].field);
	}
	free(description->scan);
	for (size_t c = 0; c < description->comment_count; c++)
		free(description->comment[c]);
	free(description->comment);
	*description = (e57_description){ 0 };
}

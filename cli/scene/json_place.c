#include "scene/json_place.h"

#include <stdbool.h>
#include <string.h>

typedef struct cursor {
	const char *at, *end;
} cursor;

static void skip_blanks(cursor *c)
{
	while (c->at < c->end && strchr(" \t\r\n", *c->at))
		c->at++;
}

/* From a quote to behind its partner. */
static void skip_string(cursor *c)
{
	c->at++;
	while (c->at < c->end && *c->at != '"')
		c->at += *c->at == '\\' && c->at + 1 < c->end ? 2 : 1;
	if (c->at < c->end)
		c->at++;
}

static void skip_value(cursor *c)
{
	size_t depth = 0;
	do {
		skip_blanks(c);
		if (c->at >= c->end)
			return;
		if (*c->at == '"') {
			skip_string(c);
		} else if (strchr("{[", *c->at)) {
			depth++;
			c->at++;
		} else if (strchr("}]", *c->at)) {
			if (depth == 0)
				return;
			depth--;
			c->at++;
		} else if (strchr(",:", *c->at)) {
			c->at++;
		} else {
			while (c->at < c->end && !strchr(" \t\r\n,:]}", *c->at))
				c->at++;
		}
	} while (depth > 0);
}

/* Goes to a member or element; false when there is none. */
static bool enter(cursor *c, const json_step *step)
{
	skip_blanks(c);
	if (c->at >= c->end || *c->at != (step->key ? '{' : '['))
		return false;
	c->at++;
	for (size_t i = 0;; i++) {
		skip_blanks(c);
		if (c->at >= c->end || *c->at == '}' || *c->at == ']')
			return false;
		bool found = !step->key && i == step->index;
		if (step->key) {
			const char *key = c->at + 1;
			skip_string(c);
			size_t length = (size_t)(c->at - key) - 1;
			found = length == strlen(step->key) && memcmp(key, step->key, length) == 0;
			skip_blanks(c);
			c->at += c->at < c->end;
			skip_blanks(c);
		}
		if (found)
			return true;
		skip_value(c);
		skip_blanks(c);
		c->at += c->at < c->end && *c->at == ',';
	}
}

size_t json_place_line(const char *text, size_t length, const json_step *step, size_t count)
{
	cursor c = { text, text + length };
	skip_blanks(&c);
	for (size_t i = 0; i < count; i++) {
		cursor inner = c;
		if (!enter(&inner, &step[i]))
			break;
		c = inner;
	}
	size_t line = 1;
	for (const char *at = text; at < c.at; at++)
		line += *at == '\n';
	return line;
}

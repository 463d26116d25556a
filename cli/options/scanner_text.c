/* scanner_text.c - see scanner_text.h. */
#include "options/scanner_text.h"
#include "files/input_file.h"
#include "files/number_text.h"

#include <math.h>
#include <string.h>

static size_t skip(const char *text, size_t length, const char *set)
{
	size_t used = 0;
	while (used < length && text[used] && strchr(set, text[used]))
		used++;
	return used;
}

/* Three finite numbers with a comma or blanks between two of them, and nothing else. */
static bool read_place(const char *text, size_t length, double place[3])
{
	size_t at = skip(text, length, " \t\r");
	for (int k = 0; k < 3; k++) {
		size_t used = number_read(text + at, length - at, &place[k]);
		if (used == 0 || !isfinite(place[k]))
			return false;
		at += used;
		size_t blank = skip(text + at, length - at, " \t\r");
		size_t comma = k < 2 && at + blank < length && text[at + blank] == ',' ? 1 : 0;
		if (k < 2 && blank + comma == 0)
			return false;
		at += blank + comma;
		at += comma ? skip(text + at, length - at, " \t\r") : 0;
	}
	return at == length;
}

static gw_status read_lines(settings *s, const input_file *in, gw_error *error)
{
	const char *at = (const char *)in->data, *end = at + in->length;
	size_t before = s->scanner_count;
	gw_status status = GW_OK;
	for (size_t number = 1; at < end && status == GW_OK; number++) {
		const char *newline = memchr(at, '\n', (size_t)(end - at));
		size_t length = (size_t)((newline ? newline : end) - at);
		const char *comment = memchr(at, '#', length);
		size_t said = comment ? (size_t)(comment - at) : length;
		double place[3];
		if (skip(at, said, " \t\r") == said)
			status = GW_OK;
		else if (read_place(at, said, place))
			status = settings_add_scanner(s, place, error);
		else
			status = gw_fail(error, GW_ERROR_DATA,
							 "%s, line %zu: this is no place; X,Y,Z in metres is expected",
							 in->name, number);
		at += length + 1;
	}
	if (status == GW_OK && s->scanner_count == before)
		return gw_fail(error, GW_ERROR_DATA, "%s holds no places; one a line is expected",
					   in->name);
	return status;
}

gw_status scanner_text_add(settings *s, const char *text, gw_error *error)
{
	double place[3];
	if (strcmp(text, "none") == 0) {
		settings_set_scanner_none(s);
		return GW_OK;
	}
	if (text[0] != '@' || !text[1]) {
		if (!read_place(text, strlen(text), place))
			return gw_fail(error, GW_ERROR_USAGE,
						   "is '%.80s', but must be X,Y,Z in metres, @FILE with one place a "
						   "line, or none",
						   text);
		return settings_add_scanner(s, place, error);
	}
	input_file in;
	GW_TRY(input_file_open(&in, text + 1, error));
	gw_status status = input_file_check(&in, read_lines(s, &in, error), error);
	input_file_close(&in);
	return status;
}

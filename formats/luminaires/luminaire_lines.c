#include "luminaires/luminaire_lines.h"

#include "files/number_text.h"
#include "glowworm_host.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

luminaire_lines luminaire_lines_of(const input_file *in, gw_error *error)
{
	bool mark = in->length >= 3 && memcmp(in->data, "\xef\xbb\xbf", 3) == 0;
	return (luminaire_lines){ .in = in, .at = mark ? 3 : 0, .line = 1, .error = error };
}

gw_status luminaire_lines_fail(const luminaire_lines *lines, const char *form, ...)
{
	char sentence[700];
	va_list arguments;
	va_start(arguments, form);
	vsnprintf(sentence, sizeof sentence, form, arguments);
	va_end(arguments);
	return gw_fail(lines->error, GW_ERROR_DATA, "%s, line %zu: %s", lines->in->name, lines->line,
				   sentence);
}

static bool ends_line(uint8_t byte)
{
	return byte == '\n' || byte == '\r';
}

bool luminaire_lines_tilt(const input_file *in)
{
	const char *text = (const char *)in->data;
	for (size_t i = 0; i + 5 <= in->length; i++) {
		bool begins = i == 0 || ends_line(in->data[i - 1]) ||
					  (i == 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0);
		if (begins && strncasecmp(text + i, "TILT=", 5) == 0)
			return true;
	}
	return false;
}

/* ------------------------------------------------------------------------------------- text */

/* Bytes of the UTF-8 character at the start of a text; 0 when there is none. */
static size_t character_bytes(const uint8_t *text, size_t length)
{
	size_t bytes = text[0] < 0x80                      ? 1
				   : text[0] >= 0xc2 && text[0] < 0xe0 ? 2
				   : text[0] >= 0xe0 && text[0] < 0xf0 ? 3
				   : text[0] >= 0xf0 && text[0] < 0xf5 ? 4
													   : 0;
	for (size_t i = 1; i < bytes; i++)
		if (i >= length || (text[i] & 0xc0) != 0x80)
			return 0;
	if (bytes == 3 && ((text[0] == 0xe0 && text[1] < 0xa0) || (text[0] == 0xed && text[1] > 0x9f)))
		return 0;
	if (bytes == 4 && ((text[0] == 0xf0 && text[1] < 0x90) || (text[0] == 0xf4 && text[1] > 0x8f)))
		return 0;
	return bytes;
}

static bool is_utf8(const uint8_t *text, size_t length)
{
	for (size_t i = 0; i < length;) {
		size_t bytes = character_bytes(text + i, length - i);
		if (bytes == 0)
			return false;
		i += bytes;
	}
	return true;
}

/* Whole characters only; C1 controls of both kinds are left out. */
static void copy_text(const uint8_t *from, size_t length, char *to)
{
	bool latin = !is_utf8(from, length);
	size_t used = 0;
	for (size_t i = 0; i < length;) {
		size_t bytes = latin ? 1 : character_bytes(from + i, length - i);
		char own[4] = { (char)from[i] };
		size_t width = bytes;
		memcpy(own, from + i, bytes);
		if (latin && from[i] >= 0x80) {
			own[0] = (char)(0xc0 | from[i] >> 6);
			own[1] = (char)(0x80 | (from[i] & 0x3f));
			width = 2;
		}
		bool control = from[i] < 0x20 || from[i] == 0x7f ||
					   (width == 2 && (uint8_t)own[0] == 0xc2 && (uint8_t)own[1] < 0xa0);
		if (used + width >= LUMINAIRE_TEXT)
			break;
		if (!control) {
			memcpy(to + used, own, width);
			used += width;
		}
		i += bytes;
	}
	to[used] = '\0';
}

bool luminaire_lines_next(luminaire_lines *lines, char *text)
{
	const uint8_t *data = lines->in->data;
	size_t length = lines->in->length, first = lines->at, last = first;
	text[0] = '\0';
	if (first >= length)
		return false;
	while (last < length && !ends_line(data[last]))
		last++;
	bool both = last + 1 < length && data[last] == '\r' && data[last + 1] == '\n';
	lines->at = last + (last < length) + both;
	lines->line++;
	while (first < last && (data[first] == ' ' || data[first] == '\t'))
		first++;
	while (last > first && (data[last - 1] == ' ' || data[last - 1] == '\t'))
		last--;
	copy_text(data + first, last - first, text);
	return true;
}

/* ---------------------------------------------------------------------------------- numbers */

static bool separates(uint8_t byte)
{
	return byte == ' ' || byte == '\t' || byte == ',' || ends_line(byte);
}

static void skip_blanks(luminaire_lines *lines)
{
	const uint8_t *data = lines->in->data;
	while (lines->at < lines->in->length && separates(data[lines->at])) {
		bool pair = data[lines->at] == '\n' && lines->at > 0 && data[lines->at - 1] == '\r';
		lines->line += ends_line(data[lines->at]) && !pair;
		lines->at++;
	}
}

gw_status luminaire_lines_number(luminaire_lines *lines, const char *what, double *value)
{
	skip_blanks(lines);
	size_t left = lines->in->length - lines->at;
	const char *text = (const char *)lines->in->data + lines->at;
	size_t taken = number_read(text, left, value);
	if (left == 0)
		return luminaire_lines_fail(lines, "the file ends where %s should be", what);
	if (taken == 0 || (taken < left && !separates((uint8_t)text[taken]) && text[taken] != 26))
		return luminaire_lines_fail(lines, "%s should be here, and this is no number", what);
	if (!isfinite(*value))
		return luminaire_lines_fail(lines, "%s is not a finite number", what);
	lines->at += taken;
	return GW_OK;
}

gw_status luminaire_lines_count(luminaire_lines *lines, const char *what, double least, double most,
								size_t *count)
{
	double value;
	*count = 0;
	GW_TRY(luminaire_lines_number(lines, what, &value));
	if (!(value >= least && value <= most) || value != floor(value))
		return luminaire_lines_fail(lines, "%s is %s; it must be a whole number from %s to %s",
									what, GW_SAID(value, 15), GW_SAID(least, 15),
									GW_SAID(most, 15));
	*count = (size_t)value;
	return GW_OK;
}

gw_status luminaire_lines_numbers(luminaire_lines *lines, luminaire_lines_take *take,
								  const char *what, size_t count, double **values)
{
	size_t left = lines->in->length - lines->at;
	*values = NULL;
	/* One digit and what keeps it apart from the next. */
	if (count > left / 2 + 1)
		return luminaire_lines_fail(
			lines, "%zu numbers should follow, each %s, but the file has only %zu bytes left",
			count, what, left);
	*values = reallocarray(NULL, count + !count, sizeof **values);
	if (!*values)
		return gw_fail(lines->error, GW_ERROR_MEMORY, "no memory for %zu numbers", count);
	gw_status status = GW_OK;
	for (size_t i = 0; i < count && status == GW_OK; i++)
		status = take(lines, what, *values + i);
	if (status != GW_OK) {
		free(*values);
		*values = NULL;
	}
	return status;
}

gw_status luminaire_lines_value(luminaire_lines *lines, const char *what, double *value)
{
	char text[LUMINAIRE_TEXT];
	bool any = luminaire_lines_next(lines, text);
	char *comma = strchr(text, ',');
	if (comma)
		*comma = '.';
	size_t length = strlen(text);
	luminaire_lines before = *lines;
	before.line -= any;
	if (!any)
		return luminaire_lines_fail(&before, "the file ends where %s should be", what);
	if (length == 0 || number_read(text, length, value) != length)
		return luminaire_lines_fail(&before, "%s should be here, not '%.60s'", what, text);
	if (!isfinite(*value))
		return luminaire_lines_fail(&before, "%s is not a finite number", what);
	return GW_OK;
}

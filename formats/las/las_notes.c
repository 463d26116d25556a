#include "las/las_notes.h"
#include "files/number_text.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

gw_status las_note(scan *cloud, gw_error *error, const char *format, ...)
{
	char text[512] = SCAN_NOTE;
	size_t used = strlen(text);
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(text + used, sizeof text - used, format, arguments);
	va_end(arguments);
	return scan_add_comment(cloud, text, error);
}

gw_status las_note_numbers(scan *cloud, const char *key, const double *value, size_t count,
						   gw_error *error)
{
	char text[64 + 16 * NUMBER_TEXT];
	int used = snprintf(text, sizeof text, LAS_NOTE "%s", key);
	for (size_t i = 0; i < count && i < 16; i++) {
		text[used++] = ' ';
		used += (int)number_print(text + used, value[i]);
	}
	return scan_add_comment(cloud, text, error);
}

/* Where to cut a text: not beside a blank, which readers of lines would drop. */
static size_t part(const char *text, size_t length)
{
	if (length <= LAS_NOTE_TEXT)
		return length;
	size_t cut = LAS_NOTE_TEXT;
	while (cut > 1 && (text[cut - 1] <= ' ' || text[cut] <= ' '))
		cut--;
	return cut > 1 ? cut : LAS_NOTE_TEXT;
}

gw_status las_note_text(scan *cloud, const char *key, const char *text, size_t length,
						gw_error *error)
{
	for (size_t at = 0, size; at < length; at += size) {
		char line[64 + LAS_NOTE_TEXT];
		size = part(text + at, length - at);
		int used = snprintf(line, 64, LAS_NOTE "%s%s ", key, at ? "+" : "");
		for (size_t i = 0; i < size; i++) {
			char c = text[at + i];
			line[used++] = c >= ' ' && c <= '~' ? c : ' ';
		}
		line[used] = '\0';
		GW_TRY(scan_add_comment(cloud, line, error));
	}
	return GW_OK;
}

const char *las_note_find(const char *comment, const char *key)
{
	size_t prefix = strlen(LAS_NOTE), length = strlen(key);
	bool found = strncmp(comment, LAS_NOTE, prefix) == 0 &&
				 strncmp(comment + prefix, key, length) == 0 && comment[prefix + length] == ' ';
	return found ? comment + prefix + length + 1 : NULL;
}

size_t las_note_read(const char *comment, const char *key, double *value, size_t capacity)
{
	const char *text = las_note_find(comment, key);
	size_t count = 0;
	while (text && count < capacity) {
		while (*text == ' ')
			text++;
		size_t length = number_read(text, strlen(text), &value[count]);
		if (length == 0)
			break;
		text += length;
		count++;
	}
	return count;
}

gw_status las_note_join(const scan *cloud, const char *key, char **text, gw_error *error)
{
	char more[64];
	snprintf(more, sizeof more, "%s+", key);
	*text = NULL;
	for (size_t c = 0; c < cloud->comment_count; c++) {
		const char *part = las_note_find(cloud->comment[c], *text ? more : key);
		if (!part && *text)
			break;
		if (!part)
			continue;
		size_t had = *text ? strlen(*text) : 0, length = strlen(part);
		char *grown = realloc(*text, had + length + 1);
		if (!grown) {
			free(*text);
			*text = NULL;
			return gw_fail(error, GW_ERROR_MEMORY, "no memory for the text '%s'", key);
		}
		memcpy(grown + had, part, length + 1);
		*text = grown;
	}
	return GW_OK;
}

static bool is_from_las(const scan *cloud)
{
	bool from_las = false;
	for (size_t c = 0; c < cloud->comment_count && !from_las; c++)
		from_las = las_note_find(cloud->comment[c], "scale") != NULL;
	return from_las;
}

bool las_note_legacy(const scan *cloud)
{
	/* Only new formats have angles as such, and the flag. */
	return is_from_las(cloud) && scan_find(cloud, "scan_angle_rank") &&
		   !scan_find(cloud, "scan_angle") && !scan_find(cloud, "overlap");
}

unsigned las_note_noise(const scan *cloud)
{
	bool newer = scan_find(cloud, "scan_angle") && !scan_find(cloud, "scan_angle_rank");
	return !is_from_las(cloud) ? 0 : newer ? LAS_LOW_NOISE | LAS_HIGH_NOISE : LAS_LOW_NOISE;
}

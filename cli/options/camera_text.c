#include "options/camera_text.h"
#include "glowworm_picture.h"
#include "files/growing_table.h"
#include "files/input_file.h"
#include "program/nearest_name.h"
#include "program/words.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LINE 1024 /* longest line of a file */

static const char *const kind_name[GW_VIEWPOINT_COUNT] = { "auto", "inside", "outside" };
static const char *const key_name[] = { "at", "to", "fov" };

static gw_status read_place(words *w, const char *key, double place[3])
{
	double value[3];
	char sentence[WORD_MAX + 64];
	if (words_next(w) && words_numbers(w->word, value) == 3 && isfinite(value[0]) &&
		isfinite(value[1]) && isfinite(value[2])) {
		memcpy(place, value, sizeof value);
		return GW_OK;
	}
	snprintf(sentence, sizeof sentence, "'%s' wants three numbers X,Y,Z without blanks", key);
	return words_fail(w, sentence);
}

static gw_status read_angle(words *w, double *angle)
{
	double value[3];
	if (words_next(w) && words_numbers(w->word, value) == 1 && value[0] > 0.0 &&
		value[0] <= GW_CAMERA_ANGLE_MAX) {
		*angle = value[0];
		return GW_OK;
	}
	char sentence[128];
	snprintf(sentence, sizeof sentence,
			 "'fov' wants the vertical angle of view in degrees, above 0 and at most %g",
			 GW_CAMERA_ANGLE_MAX);
	return words_fail(w, sentence);
}

static gw_status fail_unknown(const words *w)
{
	const char *name[GW_VIEWPOINT_COUNT + 3];
	char hint[NEAREST_NAME_HINT], sentence[512];
	size_t count = 0;
	for (int k = 0; k < GW_VIEWPOINT_COUNT; k++)
		name[count++] = kind_name[k];
	for (int k = 0; k < 3; k++)
		name[count++] = key_name[k];
	nearest_name_hint(hint, w->word, "", name, count);
	snprintf(sentence, sizeof sentence,
			 "'%.60s' says nothing about a camera; it is 'at X,Y,Z to X,Y,Z fov DEGREES', or auto, "
			 "inside or outside%s",
			 w->word, hint);
	return words_fail(w, sentence);
}

gw_status camera_text_read(const char *option, const char *text, camera_text *camera,
						   gw_error *error)
{
	words w = words_of(option, text, error);
	bool given[3] = { false };
	bool kind_given = false;
	*camera = (camera_text){ .kind = GW_VIEWPOINT_AUTO };
	while (words_next(&w)) {
		int kind = 0, key = 0;
		while (kind < GW_VIEWPOINT_COUNT && strcmp(w.word, kind_name[kind]) != 0)
			kind++;
		while (key < 3 && strcmp(w.word, key_name[key]) != 0)
			key++;
		if (kind == GW_VIEWPOINT_COUNT && key == 3)
			return fail_unknown(&w);
		if (key < 3 ? given[key] : kind_given)
			return words_fail(&w, "this has been said before");
		gw_status status = GW_OK;
		if (key == 3) {
			camera->kind = (gw_viewpoint_kind)kind;
			kind_given = true;
		} else {
			given[key] = true;
			status = key == 2 ? read_angle(&w, &camera->angle)
							  : read_place(&w, key_name[key], key ? camera->to : camera->at);
		}
		GW_TRY(status);
	}
	camera->placed = given[0];
	if (given[0] != given[1] || (kind_given && given[0]) || !(kind_given || given[0] || given[2]))
		return words_fail(&w, "a camera takes both 'at' and 'to', or one of auto, inside and "
							  "outside");
	return GW_OK;
}

static gw_status read_line(const input_file *in, size_t number, const char *line,
						   camera_text *camera, gw_error *error)
{
	char place[LINE];
	gw_error reason = { 0 };
	snprintf(place, sizeof place, "%.500s, line %zu:", in->name, number);
	if (camera_text_read(place, line, camera, &reason) == GW_OK)
		return GW_OK;
	return gw_fail(error, GW_ERROR_DATA, "%s", reason.text);
}

static gw_status read_lines(const input_file *in, camera_text **cameras, size_t *count,
							gw_error *error)
{
	const char *at = (const char *)in->data, *end = at + in->length;
	for (size_t number = 1; at < end; number++) {
		const char *newline = memchr(at, '\n', (size_t)(end - at));
		size_t length = (size_t)((newline ? newline : end) - at);
		char line[LINE];
		if (length >= sizeof line || memchr(at, '\0', length))
			return gw_fail(error, GW_ERROR_DATA, "%s, line %zu: this is no camera", in->name,
						   number);
		memcpy(line, at, length);
		line[length] = '\0';
		at = newline ? newline + 1 : end;
		char first = line[strspn(line, " \t\r")];
		if (first == '\0' || first == '#')
			continue;
		line[strcspn(line, "\r")] = '\0';
		camera_text *grown = growing_table_room(*cameras, *count, sizeof *grown);
		if (!grown)
			return gw_fail(error, GW_ERROR_MEMORY, "no memory for the cameras of %s", in->name);
		*cameras = grown;
		GW_TRY(read_line(in, number, line, grown + (*count)++, error));
	}
	if (*count == 0)
		return gw_fail(error, GW_ERROR_DATA, "%s holds no cameras; one a line is expected",
					   in->name);
	return GW_OK;
}

gw_status camera_text_read_file(const char *path, camera_text **cameras, size_t *count,
								gw_error *error)
{
	input_file in;
	*cameras = NULL;
	*count = 0;
	GW_TRY(input_file_open(&in, path, error));
	gw_status status = input_file_check(&in, read_lines(&in, cameras, count, error), error);
	input_file_close(&in);
	if (status != GW_OK) {
		free(*cameras);
		*cameras = NULL;
	}
	return status;
}

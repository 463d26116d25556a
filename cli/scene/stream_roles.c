#include "scene/stream_roles.h"

#include "scene/loaded_scene.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

bool stream_roles_standard(const char *path)
{
	return path && strcmp(path, "-") == 0;
}

bool stream_roles_nameless(const char *path)
{
	struct stat info;
	return stream_roles_standard(path) || (stat(path, &info) == 0 && !S_ISREG(info.st_mode));
}

/* ---------------------------------------------------------------------------------- input */

/* A pipe is spent by whoever reads it first, by whatever name; a file is opened anew. */
static bool is_input(const char *path)
{
	struct stat named, input;
	if (!path || stream_roles_standard(path))
		return path != NULL;
	return stat(path, &named) == 0 && (S_ISFIFO(named.st_mode) || S_ISSOCK(named.st_mode)) &&
		   fstat(STDIN_FILENO, &input) == 0 && named.st_dev == input.st_dev &&
		   named.st_ino == input.st_ino;
}

int stream_roles_inputs(const settings *s)
{
	int from = is_input(s->transport) + is_input(s->render.path);
	for (size_t i = 0; i < s->input_count; i++)
		if (!s->input[i].again || loaded_scene_is_mesh(s, &s->input[i])) /* read once */
			from += is_input(s->input[i].path);
	return from;
}

gw_status stream_roles_check_inputs(const settings *s, gw_error *error)
{
	int from = stream_roles_inputs(s);
	if (from > 1)
		return gw_fail(error, GW_ERROR_USAGE, "standard input can be read once, not %d times",
					   from);
	return GW_OK;
}

/* --------------------------------------------------------------------------------- output */

static gw_status fail_several(const stream_output *output, size_t count, int to, gw_error *error)
{
	char names[256] = "", number[16] = "both";
	size_t length = 0;
	for (size_t i = 0; i < count && length < sizeof names; i++) {
		const char *before = i == 0 ? "" : i + 1 == count ? " and " : ", ";
		length += (size_t)snprintf(names + length, sizeof names - length, "%s%s", before,
								   output[i].option);
	}
	if (count > 2)
		snprintf(number, sizeof number, "%d", to);
	return gw_fail(error, GW_ERROR_USAGE, "standard output can hold one of %s, not %s", names,
				   number);
}

static gw_status fail_terminal(const stream_output *output, const char *binary, gw_error *error)
{
	const char *option = strcmp(output->option, "--output") == 0 ? "-o" : output->option;
	return gw_fail(error, GW_ERROR_USAGE,
				   "standard output is a terminal, and %s binary data; redirect it, or name a "
				   "file with %s",
				   binary, option);
}

gw_status stream_roles_check_outputs(const stream_output *output, size_t count, gw_error *error)
{
	const char *binary = NULL;
	int to = 0;
	for (size_t i = 0; i < count; i++) {
		bool standard = stream_roles_standard(output[i].path);
		binary = standard ? output[i].binary : binary;
		to += standard;
	}
	if (to > 1)
		return fail_several(output, count, to, error);
	return binary && isatty(STDOUT_FILENO) ? fail_terminal(output, binary, error) : GW_OK;
}

#include "verbs/verbs.h"
#include "scene/file_roles.h"
#include "files/output_file.h"
#include "options/output_name.h"
#include "program/signals.h"

#include <string.h>
#include <unistd.h>

static gw_status check(const settings *s, const format **to, gw_error *error)
{
	if (s->input_count != 2)
		return gw_fail(error, GW_ERROR_USAGE,
					   "convert what into what? Name an input and an output; - is standard input "
					   "or output");
	const char *out = s->input[1].path;
	gw_status status = file_roles_check(VERB_CONVERT, s, NULL, error);
	if (status == GW_OK)
		status = output_name_format(out, s->output_format, to, error);
	bool binary =
		status == GW_OK && strcmp((*to)->name, "xyz") != 0 && strcmp((*to)->name, "csv") != 0;
	if (binary && strcmp(out, "-") == 0 && isatty(STDOUT_FILENO))
		return gw_fail(error, GW_ERROR_USAGE,
					   "standard output is a terminal, and this is binary data; redirect it, or "
					   "name a file");
	return status;
}

gw_status verb_convert(const settings *s, gw_error *error)
{
	const format *to = NULL;
	output_file *out = NULL;
	scan cloud = { 0 };
	gw_status status = check(s, &to, error);
	if (status == GW_OK)
		status = output_file_create(&out, s->input[1].path, s->force, error);
	format_options options = { s->format, s->columns, s->bake.threads };
	if (status == GW_OK)
		status = format_read_with(s->input[0].path, &options, &cloud, NULL, error);
	if (status == GW_OK && signals_pending())
		status = gw_fail(error, GW_ERROR_CANCELLED, "stopped");
	if (status == GW_OK)
		status = to->write(out, &cloud, error);
	if (status == GW_OK && signals_pending())
		status = gw_fail(error, GW_ERROR_CANCELLED, "stopped");
	if (status == GW_OK)
		status = output_file_commit(&out, error);
	output_file_abandon(&out);
	scan_clear(&cloud);
	return status;
}

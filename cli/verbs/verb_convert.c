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

static gw_status convert(const settings *s, scan *cloud, output_file **out, gw_error *error)
{
	const format *to = NULL;
	const format_options options = { s->format, s->columns, s->bake.threads };
	GW_TRY(check(s, &to, error));
	GW_TRY(output_file_create(out, s->input[1].path, s->force, error));
	GW_TRY(format_read_with(s->input[0].path, &options, cloud, NULL, error));
	GW_TRY(signals_check(error));
	GW_TRY(to->write(*out, cloud, error));
	GW_TRY(signals_check(error));
	return output_file_commit(out, error);
}

gw_status verb_convert(const settings *s, gw_error *error)
{
	output_file *out = NULL;
	scan cloud = { 0 };
	gw_status status = convert(s, &cloud, &out, error);
	output_file_abandon(&out);
	scan_clear(&cloud);
	return status;
}

#include "options/output_name.h"
#include "glowworm_host.h"

#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

bool output_name_is_stream(const char *path)
{
	struct stat info;
	return strcmp(path, "-") == 0 || (stat(path, &info) == 0 && !S_ISREG(info.st_mode));
}

bool output_name_takes_parts(const char *path, const format *f)
{
	return f && f->parted && !(f->parted->pack_loose && output_name_is_stream(path));
}

gw_status output_name_format(const char *path, const char *name, const format **found,
							 gw_error *error)
{
	bool stream = output_name_is_stream(path);
	*found = name ? format_by_name(name) : format_by_path(path);
	if (!*found && !name && stream)
		*found = format_by_name("ply");
	if (*found && (*found)->write)
		return GW_OK;
	char known[256] = "";
	for (size_t f = 0; formats[f]; f++)
		if (formats[f]->write)
			snprintf(known + strlen(known), sizeof known - strlen(known), "%s%s%s",
					 *known ? ", " : "", name ? "" : ".",
					 name ? formats[f]->name : formats[f]->extensions[0]);
	if (name)
		return gw_fail(error, GW_ERROR_USAGE, "'%s' is no format that can be written; there are %s",
					   name, known);
	return gw_fail(error, GW_ERROR_USAGE,
				   "%s: the name must end in a format that can be written: %s", path, known);
}

gw_status output_name_check_rounding(const format *f, const settings *s, const char *path,
									 gw_error *error)
{
	static const char *const kin[] = { "las", "laz", "copc", NULL };
	bool light = s->las_radiance != SETTINGS_LAS_FLOAT;
	for (const char *const *k = kin; *k; k++)
		if ((!light && s->las_step == 0.0f) || strcmp(f->name, *k) == 0)
			return GW_OK;
	return gw_fail(error, GW_ERROR_USAGE, "%s is for LAS, LAZ and COPC, and %s is %s; leave it out",
				   light ? "--las-radiance" : "--las-step", path, f->name);
}

/* Degrees that are about a millimetre, and metres that a degree is. */
#define FEW_DEGREES 1e-8f
#define DEGREE_METRES 111e3

gw_status output_name_check_step(const settings *s, bool degrees, gw_error *error)
{
	if (!degrees || s->las_step <= FEW_DEGREES)
		return GW_OK;
	return gw_fail(error, GW_ERROR_USAGE,
				   "--las-step %s: x and y are degrees, or look like them, of which that is up to "
				   "%s m; 1e-9 is a tenth of a millimetre",
				   GW_SAID((double)s->las_step, 6),
				   GW_SAID(DEGREE_METRES * (double)s->las_step, 2));
}

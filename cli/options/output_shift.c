/* output_shift.c - see output_shift.h. */
#include "options/output_shift.h"
#include "glowworm_host.h"
#include "files/number_text.h"
#include "points/format.h"
#include "points/scan_shift.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Three finite numbers with commas between them. */
static bool read_numbers(const char *text, double by[3])
{
	for (int k = 0; k < 3; k++) {
		size_t used = number_read(text, strlen(text), &by[k]);
		if (used == 0 || !isfinite(by[k]) || text[used] != (k < 2 ? ',' : '\0'))
			return false;
		text += used + (k < 2);
	}
	return true;
}

gw_status output_shift_read(const char *text, const format *to, output_shift *shift,
							gw_error *error)
{
	*shift = (output_shift){ .wanted = text != NULL };
	if (!text)
		return GW_OK;
	shift->automatic = strcmp(text, "auto") == 0;
	if (!shift->automatic && !read_numbers(text, shift->by))
		return gw_fail(error, GW_ERROR_USAGE, "--shift is '%.80s', but must be X,Y,Z or auto",
					   text);
	if (!to || strcmp(to->name, "ply") != 0)
		return gw_fail(error, GW_ERROR_USAGE,
					   "--shift is for PLY, whose header says it; %s: leave it out",
					   !to             ? "no points are written"
					   : to->row_bytes ? "LAS files hold coordinates by an offset of their own"
									   : "other formats keep the coordinates as they are");
	return GW_OK;
}

void output_shift_settle(output_shift *shift, const double low[3], const double high[3], bool quiet)
{
	if (!shift->wanted)
		return;
	if (shift->automatic)
		shift->wanted = scan_shift_choose(low, high, shift->by);
	shift->automatic = false;
	if (quiet)
		return;
	if (!shift->wanted) {
		fprintf(stderr,
				"glowworm: note: all coordinates are below %s, which floats resolve; they "
				"are written without a shift\n",
				GW_SAID(SCAN_SHIFT_LEAST, 6));
		return;
	}
	double most = 0.0;
	for (int k = 0; k < 3; k++)
		if (low[k] <= high[k])
			most = fmax(most, fmax(fabs(low[k] - shift->by[k]), fabs(high[k] - shift->by[k])));
	/* Half of the distance between floats. */
	fprintf(stderr,
			"glowworm: note: coordinates are written as floats, less %.12g,%.12g,%.12g, which "
			"rounds them by %s at most\n",
			shift->by[0], shift->by[1], shift->by[2], GW_SAID(most * (double)FLT_EPSILON / 2.0, 1));
}

void output_shift_settle_by(output_shift *shift, const scan *cloud, bool quiet)
{
	double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY };
	if (!shift->wanted)
		return;
	scan_shift_bounds(cloud, low, high);
	output_shift_settle(shift, low, high, quiet);
}

gw_status output_shift_apply(const output_shift *shift, scan *cloud, gw_error *error)
{
	return shift->wanted ? scan_shift_apply(cloud, shift->by, error) : GW_OK;
}

/* output_scanners.c - see output_scanners.h. */
#include "options/output_scanners.h"

#include <stdio.h>
#include <string.h>

/* What LAS has of an airborne scan tells readers of any LAS file again where scanners were. */
static bool is_las_again(const format *to, const scan *cloud)
{
	bool las = strcmp(to->name, "las") == 0 || strcmp(to->name, "laz") == 0 ||
			   strcmp(to->name, "copc") == 0;
	for (size_t c = 0; c < cloud->comment_count && las; c++)
		if (strncmp(cloud->comment[c], "las scale ", strlen("las scale ")) == 0)
			return true;
	return false;
}

static bool needs_comments(const format *to, const scan *cloud)
{
	return strcmp(to->name, "e57") != 0 && !is_las_again(to, cloud);
}

void output_scanners_note(const format *to, const scan *cloud, bool quiet)
{
	if (!quiet && cloud->scanner_count > SCAN_SCANNERS_SAID && needs_comments(to, cloud))
		fprintf(stderr,
				"glowworm: note: where the input's %zu scanners stood is lost: comments tell %d at "
				"most; write E57 to keep it\n",
				cloud->scanner_count, SCAN_SCANNERS_SAID);
}

gw_status output_scanners_settle(const format *to, scan *cloud, bool quiet, gw_error *error)
{
	if (!needs_comments(to, cloud))
		return GW_OK;
	output_scanners_note(to, cloud, quiet);
	return scan_say_scanners(cloud, cloud, error);
}

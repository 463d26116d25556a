/* output_system.c - see output_system.h. */
#include "options/output_system.h"

#include "units/coordinates.h"

#include <stdio.h>
#include <string.h>

gw_status output_system_settle(const format *to, scan *cloud, bool quiet, gw_error *error)
{
	bool missing;
	if (strcmp(to->name, "copc") != 0)
		return GW_OK;
	GW_TRY(coordinates_add_wkt(cloud, &missing, error));
	if (missing && !quiet)
		fprintf(stderr,
				"glowworm: note: the coordinate system of the input is told by GeoTIFF keys, "
				"which COPC does not read, and could not be made WKT; write LAZ to keep it\n");
	return GW_OK;
}

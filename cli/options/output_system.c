/* output_system.c - see output_system.h. */
#include "options/output_system.h"

#include "las/las_notes.h"
#include "options/output_name.h"
#include "units/coordinates.h"
#include "glowworm_host.h"

#include <stdio.h>
#include <string.h>

/* Two classes of old point formats that new ones call otherwise. */
static void note_classes(const scan *cloud)
{
	const scan_column *class = scan_find(cloud, "classification");
	size_t overlap = 0, other = 0;
	if (!class || !las_note_legacy(cloud))
		return;
	for (size_t i = 0; i < cloud->count; i++) {
		double value = scan_value(class, i);
		overlap += value == LAS_CLASS_OVERLAP;
		other += value == LAS_CLASS_HIGH_NOISE;
	}
	if (overlap > 0)
		fprintf(stderr,
				"glowworm: note: class 12 of %zu point%s, overlap, becomes the flag overlap of "
				"class 0, as COPC has it\n",
				overlap, gw_plural(overlap, "", "s"));
	if (other > 0)
		fprintf(
			stderr,
			"glowworm: note: class 18 of %zu point%s has no meaning in the input's point format, "
			"but that of high noise in COPC: others leave such points out; write LAZ to keep "
			"the format\n",
			other, gw_plural(other, "", "s"));
}

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
	if (!quiet)
		note_classes(cloud);
	return GW_OK;
}

gw_status output_system_check_step(const settings *s, const scan *cloud, const double low[3],
								   const double high[3], gw_error *error)
{
	bool degrees = false;
	if (s->las_step > 0.0f)
		GW_TRY(coordinates_say_degrees(cloud, low, high, &degrees, error));
	return output_name_check_step(s, degrees, error);
}

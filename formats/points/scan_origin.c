/* scan_origin.c - see scan_origin.h. */
#include "points/scan_origin.h"

#include "glowworm_picture.h"
#include "points/scan_color.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool find_position(const scan *cloud, const scan_column *position[3])
{
	position[0] = scan_find(cloud, "x");
	position[1] = scan_find(cloud, "y");
	position[2] = scan_find(cloud, "z");
	return position[0] && position[1] && position[2];
}

static void take_places(const scan_column *position[3], size_t first, size_t count, double *place)
{
	for (size_t i = 0; i < count; i++)
		for (size_t k = 0; k < 3; k++)
			place[3 * i + k] = scan_value(position[k], first + i);
}

bool scan_settle_origin(scan *cloud, size_t index)
{
	const scan_column *position[3];
	gw_range_image *image = &cloud->image[index], own = *image;
	double *place = reallocarray(NULL, image->count ? image->count : 1, 3 * sizeof *place);
	bool found = false;
	if (place && find_position(cloud, position)) {
		take_places(position, image->first, image->count, place);
		own.first = 0;
		const gw_points points = { .count = image->count,
								   .position = place,
								   .image_cell = cloud->image_cell + image->first };
		found = gw_range_image_find_scanner(&points, &own, image->scanner);
	}
	free(place);
	return found;
}

gw_status scan_find_origin(scan *cloud, gw_error *error)
{
	static const char *const normal[3] = { "nx", "ny", "nz" };
	const scan_column *position[3], *given[3];
	double at[3];
	char text[300];
	if (cloud->scanner_count > 0 || cloud->image_count > 1 || cloud->count == 0 ||
		!find_position(cloud, position) || scan_find_triple(cloud, normal, given))
		return GW_OK;
	double *place = reallocarray(NULL, cloud->count, 3 * sizeof *place);
	if (!place)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the places of %zu points",
					   cloud->count);
	take_places(position, 0, cloud->count, place);
	const gw_points points = { .count = cloud->count, .position = place, .up = cloud->up };
	bool found = gw_points_find_scanner(&points, at);
	free(place);
	if (!found)
		return GW_OK;
	if (cloud->image_count > 0)
		memcpy(cloud->image[0].scanner, at, sizeof at);
	GW_TRY(scan_add_scanner(cloud, at, 0, cloud->count, error));
	snprintf(text, sizeof text,
			 SCAN_NOTE "the points lie as densely as if one scanner had seen all of them from "
					   "%.9g,%.9g,%.9g, which is taken; --scanner X,Y,Z says where one stood, "
					   "--scanner none that nobody knows",
			 at[0], at[1], at[2]);
	return scan_add_comment(cloud, text, error);
}

gw_status scan_keep_scanner(scan_first_scanner *first, scan *piece, gw_error *error)
{
	if (piece->count == 0)
		return GW_OK;
	if (first->looked)
		return first->known ? scan_add_scanner(piece, first->place, 0, piece->count, error) : GW_OK;
	first->looked = true;
	first->known = piece->scanner_count > 0;
	if (first->known)
		memcpy(first->place, piece->scanner, sizeof first->place);
	return GW_OK;
}

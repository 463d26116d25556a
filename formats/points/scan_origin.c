/* scan_origin.c - see scan_origin.h. */
#include "points/scan_origin.h"

#include "glowworm_picture.h"

#include <stdlib.h>

bool scan_settle_origin(scan *cloud, size_t index)
{
	const scan_column *position[3] = { scan_find(cloud, "x"), scan_find(cloud, "y"),
									   scan_find(cloud, "z") };
	gw_range_image *image = &cloud->image[index], own = *image;
	double *place = reallocarray(NULL, image->count ? image->count : 1, 3 * sizeof *place);
	bool found = false;
	if (place && position[0] && position[1] && position[2]) {
		for (size_t i = 0; i < image->count; i++)
			for (size_t k = 0; k < 3; k++)
				place[3 * i + k] = scan_value(position[k], image->first + i);
		own.first = 0;
		const gw_points points = { .count = image->count,
								   .position = place,
								   .image_cell = cloud->image_cell + image->first };
		found = gw_range_image_find_scanner(&points, &own, image->scanner);
	}
	free(place);
	return found;
}

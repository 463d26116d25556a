#include "panoramas/panorama.h"

#include <stdlib.h>

gw_status panorama_allocate(const input_file *in, uint64_t width, uint64_t height, uint64_t most,
							panorama *map, gw_error *error)
{
	if (width == 0 || height == 0 || width > UINT32_MAX || width != 2 * height)
		return gw_fail(error, GW_ERROR_DATA,
					   "%s is %llu x %llu pixels; a map of longitude and latitude is twice as wide "
					   "as high",
					   in->name, (unsigned long long)width, (unsigned long long)height);
	if (width * height > PANORAMA_PIXELS)
		return gw_fail(error, GW_ERROR_DATA,
					   "%s is %llu x %llu pixels, more than 16384 x 8192; scale it down", in->name,
					   (unsigned long long)width, (unsigned long long)height);
	if (width * height > most)
		return gw_fail(error, GW_ERROR_DATA,
					   "%s has %zu bytes, which cannot hold the %llu x %llu pixels that it claims; "
					   "it is cut short",
					   in->name, in->length, (unsigned long long)width, (unsigned long long)height);
	*map = (panorama){ .width = (uint32_t)width, .height = (uint32_t)height };
	map->pixels = calloc((size_t)(width * height), 3 * sizeof *map->pixels);
	if (!map->pixels)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the %llu x %llu pixels of %s",
					   (unsigned long long)width, (unsigned long long)height, in->name);
	return GW_OK;
}

void panorama_clear(panorama *map)
{
	free(map->pixels);
	*map = (panorama){ 0 };
}

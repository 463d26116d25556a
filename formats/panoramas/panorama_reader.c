#include "panoramas/panorama_reader.h"

#include <string.h>

gw_status panorama_read(const char *path, panorama *map, gw_error *error)
{
	input_file in;
	*map = (panorama){ 0 };
	GW_TRY(input_file_open_as(&in, path, UINT64_MAX, 0, error));
	gw_status status = GW_OK;
	if (in.length >= 4 && memcmp(in.data, "\x76\x2f\x31\x01", 4) == 0)
		status = panorama_exr_read(&in, map, error);
	else if (in.length >= 2 && memcmp(in.data, "#?", 2) == 0)
		status = panorama_hdr_read(&in, map, error);
	else
		status =
			gw_fail(error, GW_ERROR_DATA,
					"%s is neither an OpenEXR nor a Radiance HDR picture; a map of the sky has "
					"to be one of them",
					in.name);
	input_file_close(&in);
	return status;
}

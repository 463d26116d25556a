/* scan_splats.c - see scan_splats.h. */
#include "points/scan_splats.h"

const char *const scan_axis_names[3] = { "axis_x", "axis_y", "axis_z" };

bool scan_is_haze(const scan_column *splat_opacity, size_t i)
{
	return splat_opacity && !(scan_value(splat_opacity, i) >= SCAN_HAZE_BELOW);
}

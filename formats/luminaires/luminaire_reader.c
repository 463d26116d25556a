#include "luminaires/luminaire_reader.h"

#include "luminaires/luminaire_lines.h"

/* Files of luminaires have some ten thousand numbers. */
#define BYTES_MOST ((size_t)64 << 20)

static gw_status read_bytes(const input_file *in, luminaire *l, gw_error *error)
{
	if (in->length > BYTES_MOST)
		return gw_fail(error, GW_ERROR_DATA, "%s has %zu bytes; that is no luminaire", in->name,
					   in->length);
	if (luminaire_lines_tilt(in))
		return luminaire_ies_read(in, l, error);
	gw_error reason = { 0 };
	gw_status status = luminaire_eulumdat_read(in, l, &reason);
	return status == GW_OK
			   ? GW_OK
			   : gw_fail(error, status,
						 "%.800s (no line begins with TILT=, so it is read as EULUMDAT)",
						 reason.text);
}

gw_status luminaire_read(const char *path, luminaire *l, gw_error *error)
{
	input_file in;
	*l = (luminaire){ .distribution = NULL };
	GW_TRY(input_file_open(&in, path, error));
	gw_status status = input_file_check(&in, read_bytes(&in, l, error), error);
	input_file_close(&in);
	if (status != GW_OK)
		luminaire_clear(l);
	return status;
}

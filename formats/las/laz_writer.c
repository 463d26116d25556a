#include "las/las_format.h"
#include "las/las_whole.h"
#include "las/laz_output.h"

#include <stdlib.h>

static gw_status write_all(laz_output *o, const las_records *records, output_file *out,
						   gw_error *error)
{
	if (!output_file_temporary(out))
		return laz_output_append(o, records, out, error);
	GW_TRY(laz_output_begin(o, records, out, error));
	GW_TRY(laz_output_add(o, records, error));
	return laz_output_end(o, error);
}

gw_status laz_write(output_file *out, const scan *cloud, gw_error *error)
{
	las_records records;
	laz_output o = { .out = NULL };
	gw_status status = las_records_make(&records, cloud, output_file_name(out), false, error);
	if (status == GW_OK)
		status = write_all(&o, &records, out, error);
	laz_output_clear(&o);
	las_records_clear(&records);
	return status;
}

/* ------------------------------------------------------------------------------------ in parts */

static gw_status write_head(output_file *out, const format_whole *whole, const scan *first,
							gw_error *error)
{
	las_records records;
	laz_output *o = whole->survey->packed = calloc(1, sizeof *o);
	if (!o)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to write %s", whole->name);
	if (!output_file_temporary(out))
		return gw_fail(error, GW_ERROR_USAGE,
					   "%s: LAZ is written part by part to files alone, because it says before the "
					   "points what is known after them; write LAS",
					   whole->name);
	gw_status status = las_records_of_part(&records, whole->survey, first, false, error);
	if (status == GW_OK)
		status = laz_output_begin(o, &records, out, error);
	las_records_clear(&records);
	return status;
}

static gw_status write_rows(output_file *out, const format_whole *whole, const scan *part,
							gw_error *error)
{
	las_records records;
	(void)out;
	gw_status status = las_records_of_part(&records, whole->survey, part, false, error);
	if (status == GW_OK)
		status = laz_output_add(whole->survey->packed, &records, error);
	las_records_clear(&records);
	return status;
}

static gw_status pack_rows(output_file *out, const format_whole *whole, const format_loose *rows,
						   gw_error *error)
{
	const las_records records = {
		.name = whole->name, .made = rows->bytes, .count = rows->count, .layout.bytes = rows->row
	};
	(void)out;
	return laz_output_add(whole->survey->packed, &records, error);
}

static gw_status write_end(output_file *out, const format_whole *whole, gw_error *error)
{
	(void)out;
	return laz_output_end(whole->survey->packed, error);
}

static void survey_clear(format_whole *whole)
{
	laz_output *o = whole->survey ? whole->survey->packed : NULL;
	if (o)
		laz_output_clear(o);
	free(o);
	las_whole_clear(whole);
}

const format_parted laz_parted = {
	.survey_begin = las_whole_begin,
	.survey_add = las_whole_add,
	.survey_go_on = las_whole_go_on,
	.survey_clear = survey_clear,
	.row = las_whole_row,
	.write_head = write_head,
	.write_rows = write_rows,
	.write_end = write_end,
	.write_loose = las_whole_write_rows,
	.pack_loose = pack_rows,
};

#include "las/las_format.h"
#include "las/las_head.h"
#include "las/las_whole.h"

static gw_status write_before(output_file *out, const las_records *records, gw_error *error)
{
	las_head head = { 0 };
	gw_status status = las_head_make(&head, records, error);
	if (status == GW_OK)
		status = las_head_write(&head, out, error);
	las_head_clear(&head);
	return status;
}

gw_status las_write(output_file *out, const scan *cloud, gw_error *error)
{
	las_records records;
	gw_status status = las_records_make(&records, cloud, output_file_name(out), false, error);
	if (status == GW_OK)
		status = write_before(out, &records, error);
	if (status == GW_OK)
		status = las_whole_write_records(out, &records, error);
	las_records_clear(&records);
	return status;
}

static gw_status write_head(output_file *out, const format_whole *whole, const scan *first,
							gw_error *error)
{
	las_records records;
	gw_status status = las_records_of_part(&records, whole->survey, first, false, error);
	if (status == GW_OK)
		status = write_before(out, &records, error);
	las_records_clear(&records);
	return status;
}

const format_parted las_parted = {
	.survey_begin = las_whole_begin,
	.survey_add = las_whole_add,
	.survey_go_on = las_whole_go_on,
	.survey_clear = las_whole_clear,
	.row = las_whole_row,
	.write_head = write_head,
	.write_rows = las_whole_write_rows,
};

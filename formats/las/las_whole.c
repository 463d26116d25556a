#include "las/las_whole.h"

#include <stdlib.h>

/* Bytes of records that are put together before they are handed on. */
#define BLOCK_BYTES ((size_t)1 << 18)

gw_status las_whole_begin(format_whole *whole, gw_error *error)
{
	whole->survey = calloc(1, sizeof *whole->survey);
	if (!whole->survey)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to write %s", whole->name);
	return las_survey_begin(whole->survey, whole->name, error);
}

gw_status las_whole_add(format_whole *whole, const scan *part, gw_error *error)
{
	return las_survey_add(whole->survey, part, error);
}

static gw_status check_count(const format_whole *whole, gw_error *error)
{
	if (whole->survey->count == whole->count)
		return GW_OK;
	return gw_fail(error, GW_ERROR_DATA, "%s: the input has %llu points now, and had %llu",
				   whole->name, (unsigned long long)whole->survey->count,
				   (unsigned long long)whole->count);
}

/* That LAS has a grid for them is known here, and not when hours of work are done. */
gw_status las_whole_go_on(format_whole *whole, bool *again, gw_error *error)
{
	las_grid grid;
	las_survey *survey = whole->survey;
	GW_TRY(check_count(whole, error));
	GW_TRY(las_survey_go_on(survey, again, error));
	for (int k = 0; k < 3 && !*again; k++)
		GW_TRY(las_grid_search_take(&survey->axis[k], 0.0, k, whole->name, &grid, error));
	return GW_OK;
}

void las_whole_clear(format_whole *whole)
{
	if (whole->survey)
		las_survey_clear(whole->survey);
	free(whole->survey);
	whole->survey = NULL;
}

gw_status las_whole_row(const format_whole *whole, const scan *part, size_t *row, gw_error *error)
{
	las_records records;
	gw_status status = las_records_of_part(&records, whole->survey, part, false, error);
	*row = records.layout.bytes;
	las_records_clear(&records);
	return status;
}

gw_status las_whole_write_records(output_file *out, const las_records *records, gw_error *error)
{
	size_t record = records->layout.bytes, rows = BLOCK_BYTES / record;
	uint8_t *block = reallocarray(NULL, rows, record);
	if (!block)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to write %s", records->name);
	gw_status status = GW_OK;
	for (size_t first = 0; first < records->count && status == GW_OK; first += rows) {
		size_t rest = records->count - first, count = rest < rows ? rest : rows;
		las_records_put(records, first, count, block);
		status = output_file_write(out, block, count * record, error);
	}
	free(block);
	return status;
}

gw_status las_whole_write_rows(output_file *out, const format_whole *whole, const scan *part,
							   gw_error *error)
{
	las_records records;
	gw_status status = las_records_of_part(&records, whole->survey, part, false, error);
	if (status == GW_OK)
		status = las_whole_write_records(out, &records, error);
	las_records_clear(&records);
	return status;
}

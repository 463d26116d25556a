#include "las/las_format.h"
#include "las/las_head.h"

#include <stdlib.h>

/* Bytes of records that are put together before they are handed on. */
#define BLOCK_BYTES ((size_t)1 << 18)

static gw_status write_points(const las_records *records, output_file *out, gw_error *error)
{
	size_t record = records->layout.bytes, rows = BLOCK_BYTES / record;
	uint8_t *block = reallocarray(NULL, rows, record);
	if (!block)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to write %s", records->name);
	gw_status status = GW_OK;
	for (size_t first = 0; first < records->cloud->count && status == GW_OK; first += rows) {
		size_t rest = records->cloud->count - first, count = rest < rows ? rest : rows;
		las_records_put(records, first, count, block);
		status = output_file_write(out, block, count * record, error);
	}
	free(block);
	return status;
}

gw_status las_write(output_file *out, const scan *cloud, gw_error *error)
{
	las_records records;
	las_head head = { 0 };
	gw_status status = las_records_make(&records, cloud, output_file_name(out), false, error);
	if (status == GW_OK)
		status = las_head_make(&head, &records, error);
	if (status == GW_OK)
		status = las_head_write(&head, out, error);
	if (status == GW_OK)
		status = write_points(&records, out, error);
	las_head_clear(&head);
	las_records_clear(&records);
	return status;
}

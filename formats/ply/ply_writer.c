#include "files/little_endian.h"
#include "ply/ply_format.h"
#include "ply/ply_header.h"

#include <stdlib.h>
#include <string.h>

/* Rows that are put together before they are handed on. */
#define BLOCK_ROWS 1024

/* One line of text: whatever could end it becomes a blank. */
static gw_status write_comment(output_file *out, const char *text, gw_error *error)
{
	size_t prefix = strlen(PLY_OBJ_INFO);
	bool own_keyword = strncmp(text, PLY_OBJ_INFO, prefix) == 0;
	char *line = strdup(text);
	if (!line)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a comment line");
	for (char *c = line; *c; c++)
		if ((unsigned char)*c < ' ')
			*c = ' ';
	gw_status status = output_file_print(out, error, "%s%s\n", own_keyword ? "" : "comment ", line);
	free(line);
	return status;
}

/* A property's name is one word. */
static gw_status write_property(output_file *out, const scan_column *column, gw_error *error)
{
	char *name = strdup(column->name[0] ? column->name : "unnamed");
	if (!name)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a property's name");
	for (char *c = name; *c; c++)
		if ((unsigned char)*c <= ' ')
			*c = '_';
	gw_status status =
		output_file_print(out, error, "property %s %s\n", ply_type_name(column->type), name);
	free(name);
	return status;
}

gw_status ply_write_head(output_file *out, const format_whole *whole, const scan *cloud,
						 gw_error *error)
{
	output_file_print(out, NULL, "ply\nformat binary_little_endian 1.0\n");
	for (size_t c = 0; c < cloud->comment_count; c++)
		GW_TRY(write_comment(out, cloud->comment[c], error));
	output_file_print(out, NULL, "element vertex %llu\n", (unsigned long long)whole->count);
	for (size_t c = 0; c < cloud->column_count; c++)
		GW_TRY(write_property(out, &cloud->column[c], error));
	return output_file_print(out, error, "end_header\n");
}

static void fill_rows(uint8_t *rows, size_t stride, const scan *cloud, size_t first, size_t count)
{
	uint8_t *place = rows;
	for (size_t c = 0; c < cloud->column_count; c++) {
		size_t size = scan_type_size(cloud->column[c].type);
		const uint8_t *from = (const uint8_t *)cloud->column[c].data + first * size;
		for (size_t i = 0; i < count; i++)
			store_value(place + i * stride, from + i * size, size);
		place += size;
	}
}

gw_status ply_write_rows(output_file *out, const format_whole *whole, const scan *cloud,
						 gw_error *error)
{
	(void)whole;
	size_t stride = 0;
	for (size_t c = 0; c < cloud->column_count; c++)
		stride += scan_type_size(cloud->column[c].type);
	gw_status status = GW_OK;
	uint8_t *rows = reallocarray(NULL, stride ? stride : 1, BLOCK_ROWS);
	if (!rows)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to write %s", output_file_name(out));
	for (size_t first = 0; first < cloud->count && status == GW_OK; first += BLOCK_ROWS) {
		size_t rest = cloud->count - first;
		size_t count = rest < BLOCK_ROWS ? rest : BLOCK_ROWS;
		fill_rows(rows, stride, cloud, first, count);
		status = output_file_write(out, rows, stride * count, error);
	}
	free(rows);
	return status;
}

gw_status ply_write(output_file *out, const scan *cloud, gw_error *error)
{
	const format_whole whole = { .count = cloud->count };
	GW_TRY(ply_write_head(out, &whole, cloud, error));
	return ply_write_rows(out, &whole, cloud, error);
}

#include "points/scan.h"
#include "files/growing_table.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ------------------------------------------------------------------------------- columns */

size_t scan_type_size(scan_type type)
{
	static const size_t size[SCAN_TYPE_COUNT] = {
		[SCAN_INT8] = 1,  [SCAN_UINT8] = 1,  [SCAN_INT16] = 2,   [SCAN_UINT16] = 2,
		[SCAN_INT32] = 4, [SCAN_UINT32] = 4, [SCAN_FLOAT32] = 4, [SCAN_FLOAT64] = 8,
	};
	assert((unsigned)type < SCAN_TYPE_COUNT);
	return size[type];
}

void scan_clear(scan *cloud)
{
	for (size_t c = 0; c < cloud->column_count; c++) {
		free(cloud->column[c].name);
		free(cloud->column[c].data);
	}
	free(cloud->column);
	for (size_t c = 0; c < cloud->comment_count; c++)
		free(cloud->comment[c]);
	free(cloud->comment);
	free(cloud->scanner);
	free(cloud->scanner_of);
	free(cloud->image);
	free(cloud->image_cell);
	memset(cloud, 0, sizeof *cloud);
}

scan_column *scan_add_column(scan *cloud, const char *name, scan_type type, gw_error *error)
{
	if (scan_find(cloud, name)) {
		gw_fail(error, GW_ERROR_DATA, "two columns are called '%s'; rename one of them", name);
		return NULL;
	}
	scan_column *grown = growing_table_room(cloud->column, cloud->column_count, sizeof *grown);
	if (grown)
		cloud->column = grown;
	char *copy = strdup(name);
	/* One more, because no bytes may come back as NULL. */
	void *data = calloc(cloud->count ? cloud->count : 1, scan_type_size(type));
	if (!grown || !copy || !data) {
		free(copy);
		free(data);
		gw_fail(error, GW_ERROR_MEMORY, "no memory for the column '%s' of %zu points", name,
				cloud->count);
		return NULL;
	}
	scan_column *column = &cloud->column[cloud->column_count++];
	*column = (scan_column){ .name = copy, .type = type, .data = data };
	return column;
}

void scan_remove_points(scan *cloud, const uint8_t *gone)
{
	size_t kept = 0;
	for (size_t c = 0; c < cloud->column_count; c++) {
		size_t size = scan_type_size(cloud->column[c].type);
		char *data = cloud->column[c].data;
		kept = 0;
		for (size_t i = 0; i < cloud->count; i++)
			if (!gone[i])
				memmove(data + size * kept++, data + size * i, size);
	}
	kept = 0;
	for (size_t i = 0; i < cloud->count; i++) {
		if (gone[i])
			continue;
		if (cloud->scanner_of)
			cloud->scanner_of[kept] = cloud->scanner_of[i];
		kept++;
	}
	cloud->count = kept;
}

static void take_values(const scan_column *from, const uint32_t *point, size_t count,
						scan_column *to)
{
	size_t size = scan_type_size(from->type);
	const char *values = from->data;
	char *taken = to->data;
	for (size_t i = 0; i < count; i++)
		memcpy(taken + size * i, values + size * point[i], size);
}

gw_status scan_take_points(const scan *cloud, const uint32_t *point, size_t count, scan *some,
						   gw_error *error)
{
	*some = (scan){ .count = count,
					.up = cloud->up,
					.says_up = cloud->says_up,
					.noise_classes = cloud->noise_classes };
	for (size_t c = 0; c < cloud->column_count; c++) {
		const scan_column *from = &cloud->column[c];
		scan_column *to = scan_add_column(some, from->name, from->type, error);
		if (!to) {
			scan_clear(some);
			return GW_ERROR_MEMORY;
		}
		take_values(from, point, count, to);
	}
	return GW_OK;
}

gw_status scan_add_comment(scan *cloud, const char *text, gw_error *error)
{
	char **grown = growing_table_room(cloud->comment, cloud->comment_count, sizeof *grown);
	if (grown)
		cloud->comment = grown;
	char *copy = strdup(text);
	if (!grown || !copy) {
		free(copy);
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a comment line");
	}
	cloud->comment[cloud->comment_count++] = copy;
	return GW_OK;
}

gw_status scan_say_scanners(const scan *from, scan *to, gw_error *error)
{
	for (size_t c = 0; c < to->comment_count; c++)
		if (strncmp(to->comment[c], SCAN_SCANNER, strlen(SCAN_SCANNER)) == 0)
			return GW_OK;
	const double *at = from->scanner;
	size_t count = from->scanner_count <= SCAN_SCANNERS_SAID ? from->scanner_count : 0;
	for (size_t i = 0; i < count; i++, at += 3) {
		char text[128];
		snprintf(text, sizeof text, SCAN_SCANNER "%.17g %.17g %.17g", at[0], at[1], at[2]);
		GW_TRY(scan_add_comment(to, text, error));
	}
	return GW_OK;
}

uint32_t scan_scanner_at(scan *cloud, const double position[3])
{
	size_t recent = cloud->scanner_count < 64 ? 0 : cloud->scanner_count - 64;
	for (size_t s = recent; s < cloud->scanner_count; s++)
		if (memcmp(cloud->scanner + 3 * s, position, 3 * sizeof *position) == 0)
			return (uint32_t)s;
	double *grown = growing_table_room(cloud->scanner, cloud->scanner_count, 3 * sizeof *grown);
	if (!grown || cloud->scanner_count >= SCAN_NO_SCANNER)
		return SCAN_NO_SCANNER;
	cloud->scanner = grown;
	memcpy(grown + 3 * cloud->scanner_count, position, 3 * sizeof *position);
	return (uint32_t)cloud->scanner_count++;
}

gw_status scan_add_image(scan *cloud, const gw_range_image *image, gw_error *error)
{
	gw_range_image *grown = growing_table_room(cloud->image, cloud->image_count, sizeof *grown);
	if (grown)
		cloud->image = grown;
	if (grown && !cloud->image_cell) {
		cloud->image_cell =
			reallocarray(NULL, cloud->count ? cloud->count : 1, sizeof *cloud->image_cell);
		for (size_t i = 0; cloud->image_cell && i < cloud->count; i++)
			cloud->image_cell[i] = UINT32_MAX;
	}
	if (!grown || !cloud->image_cell)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the cells of %zu points",
					   cloud->count);
	cloud->image[cloud->image_count++] = *image;
	return GW_OK;
}

gw_status scan_part_scanners(scan *cloud, gw_error *error)
{
	if (cloud->scanner_of)
		return GW_OK;
	uint32_t *of = reallocarray(NULL, cloud->count ? cloud->count : 1, sizeof *of);
	if (!of)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the scanners of %zu points",
					   cloud->count);
	for (size_t i = 0; i < cloud->count; i++)
		of[i] = cloud->scanner_count ? 0 : SCAN_NO_SCANNER;
	cloud->scanner_of = of;
	return GW_OK;
}

gw_status scan_add_scanner(scan *cloud, const double position[3], size_t first, size_t count,
						   gw_error *error)
{
	bool all = count == cloud->count;
	if (!all) {
		GW_TRY(scan_part_scanners(cloud, error));
	}
	uint32_t scanner = scan_scanner_at(cloud, position);
	if (scanner == SCAN_NO_SCANNER)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for another scanner");
	for (size_t i = first; i < first + count && cloud->scanner_of; i++)
		cloud->scanner_of[i] = scanner;
	return GW_OK;
}

scan_column *scan_find(const scan *cloud, const char *name)
{
	for (size_t c = 0; c < cloud->column_count; c++)
		if (strcmp(cloud->column[c].name, name) == 0)
			return &cloud->column[c];
	return NULL;
}

void scan_remove_column(scan *cloud, const char *name)
{
	scan_column *column = scan_find(cloud, name);
	if (!column)
		return;
	free(column->name);
	free(column->data);
	size_t behind = cloud->column_count - (size_t)(column - cloud->column) - 1;
	memmove(column, column + 1, behind * sizeof *column);
	cloud->column_count--;
}

bool scan_is_zero(const scan_column *column, size_t count)
{
	const uint8_t *bytes = column->data;
	size_t size = count * scan_type_size(column->type);
	return size == 0 || (bytes[0] == 0 && memcmp(bytes, bytes + 1, size - 1) == 0);
}

double scan_value(const scan_column *column, size_t i)
{
	switch (column->type) {
	case SCAN_INT8:
		return ((const int8_t *)column->data)[i];
	case SCAN_UINT8:
		return ((const uint8_t *)column->data)[i];
	case SCAN_INT16:
		return ((const int16_t *)column->data)[i];
	case SCAN_UINT16:
		return ((const uint16_t *)column->data)[i];
	case SCAN_INT32:
		return ((const int32_t *)column->data)[i];
	case SCAN_UINT32:
		return ((const uint32_t *)column->data)[i];
	case SCAN_FLOAT32:
		return (double)((const float *)column->data)[i];
	case SCAN_FLOAT64:
		return ((const double *)column->data)[i];
	case SCAN_TYPE_COUNT:
		break;
	}
	return 0.0;
}

void scan_store(scan_column *column, size_t i, double value)
{
	switch (column->type) {
	case SCAN_INT8:
		((int8_t *)column->data)[i] = (int8_t)value;
		break;
	case SCAN_UINT8:
		((uint8_t *)column->data)[i] = (uint8_t)value;
		break;
	case SCAN_INT16:
		((int16_t *)column->data)[i] = (int16_t)value;
		break;
	case SCAN_UINT16:
		((uint16_t *)column->data)[i] = (uint16_t)value;
		break;
	case SCAN_INT32:
		((int32_t *)column->data)[i] = (int32_t)value;
		break;
	case SCAN_UINT32:
		((uint32_t *)column->data)[i] = (uint32_t)value;
		break;
	case SCAN_FLOAT32:
		((float *)column->data)[i] = (float)value;
		break;
	case SCAN_FLOAT64:
		((double *)column->data)[i] = value;
		break;
	case SCAN_TYPE_COUNT:
		break;
	}
}

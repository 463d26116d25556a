/* scan_shift.c - see scan_shift.h. */
#include "points/scan_shift.h"
#include "glowworm_host.h"
#include "files/number_text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const axis_name[3] = { "x", "y", "z" };

void scan_shift_bounds(const scan *cloud, double low[3], double high[3])
{
	for (int k = 0; k < 3; k++) {
		const scan_column *column = scan_find(cloud, axis_name[k]);
		for (size_t i = 0; column && i < cloud->count; i++) {
			double value = scan_value(column, i);
			if (!isfinite(value))
				continue;
			low[k] = fmin(low[k], value);
			high[k] = fmax(high[k], value);
		}
	}
}

bool scan_shift_choose(const double low[3], const double high[3], double shift[3])
{
	bool wide = false;
	for (int k = 0; k < 3; k++) {
		bool far = low[k] <= high[k] && fmax(fabs(low[k]), fabs(high[k])) >= SCAN_SHIFT_LEAST;
		double middle = low[k] / 2.0 + high[k] / 2.0;
		shift[k] = far ? SCAN_SHIFT_STEP * round(middle / SCAN_SHIFT_STEP) + 0.0 : 0.0;
		wide = wide || far;
	}
	return wide;
}

/* Replaces the values of a column by those of another type that are so much more. */
static gw_status move_column(scan_column *column, size_t count, scan_type type, double by,
							 gw_error *error)
{
	scan_column moved = { column->name, type, NULL };
	moved.data = reallocarray(NULL, count ? count : 1, scan_type_size(type));
	if (!moved.data)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to shift %zu coordinates", count);
	for (size_t i = 0; i < count; i++) {
		double value = scan_value(column, i), sum = value + by;
		if (type == SCAN_FLOAT32 && isfinite(value) && !isfinite((float)sum)) {
			free(moved.data);
			return gw_fail(error, GW_ERROR_DATA,
						   "point %zu has %s %s, which less the shift, %s, is beyond floats", i,
						   column->name, GW_SAID_PLACE(value), GW_SAID_PLACE(-by));
		}
		if (type == SCAN_FLOAT32)
			((float *)moved.data)[i] = (float)sum;
		else
			((double *)moved.data)[i] = sum;
	}
	free(column->data);
	*column = moved;
	return GW_OK;
}

gw_status scan_shift_apply(scan *cloud, const double shift[3], gw_error *error)
{
	char text[3 * NUMBER_TEXT + 32] = SCAN_SHIFT, number[NUMBER_TEXT];
	for (int k = 0; k < 3; k++) {
		scan_column *column = scan_find(cloud, axis_name[k]);
		if (column)
			GW_TRY(move_column(column, cloud->count, SCAN_FLOAT32, -shift[k], error));
		number_print(number, 0.0 - shift[k]);
		snprintf(text + strlen(text), sizeof text - strlen(text), "%s%s", k ? " " : "", number);
	}
	return scan_add_comment(cloud, text, error);
}

/* The numbers of such a comment, and nothing else behind them. */
static bool read_shift(const char *text, double shift[3])
{
	size_t length = strlen(SCAN_SHIFT), used = 1;
	if (strncmp(text, SCAN_SHIFT, length) != 0)
		return false;
	text += length;
	for (int k = 0; k < 3 && used > 0; k++) {
		text += strspn(text, " ");
		used = number_read(text, strlen(text), &shift[k]);
		used = isfinite(shift[k]) ? used : 0;
		text += used;
	}
	return used > 0 && text[strspn(text, " \r\t")] == '\0';
}

static gw_status undo(scan *cloud, const double shift[3], gw_error *error)
{
	char text[256];
	for (int k = 0; k < 3; k++)
		GW_TRY(move_column(scan_find(cloud, axis_name[k]), cloud->count, SCAN_FLOAT64, -shift[k],
						   error));
	snprintf(text, sizeof text,
			 SCAN_NOTE
			 "the file has its coordinates less %.12g %.12g %.12g, which is added to them",
			 0.0 - shift[0], 0.0 - shift[1], 0.0 - shift[2]);
	return scan_add_comment(cloud, text, error);
}

gw_status scan_shift_undo(scan *cloud, gw_error *error)
{
	double shift[3] = { 0.0, 0.0, 0.0 };
	bool floats = true;
	size_t c = 0;
	while (c < cloud->comment_count && !read_shift(cloud->comment[c], shift))
		c++;
	for (int k = 0; k < 3; k++) {
		const scan_column *column = scan_find(cloud, axis_name[k]);
		floats = floats && column && column->type == SCAN_FLOAT32;
	}
	if (c == cloud->comment_count || !floats)
		return GW_OK;
	free(cloud->comment[c]);
	cloud->comment_count--;
	memmove(&cloud->comment[c], &cloud->comment[c + 1],
			(cloud->comment_count - c) * sizeof *cloud->comment);
	return undo(cloud, shift, error);
}

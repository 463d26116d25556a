/*
 * scan_aside.c - see scan_aside.h.
 */
#include "points/scan_aside.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#define REPEATED 9u

/* One column, and where its first value is among the points: the others follow at steps of 3. */
typedef struct repeated {
	scan_column *column; /* NULL: there is none, or not of a type that can be made again */
	const double *wide;
	const float *narrow; /* one of the two */
} repeated;

static void find_repeated(const scan *cloud, const scan_points *points, repeated found[REPEATED])
{
	static const char *const name[REPEATED] = { "x",  "y",          "z",          "nx",        "ny",
												"nz", "emission_r", "emission_g", "emission_b" };
	const float *const triple[2] = { points->normal, points->emission };
	for (size_t k = 0; k < REPEATED; k++) {
		const float *narrow = k < 3 ? NULL : triple[k / 3 - 1];
		scan_column *column = scan_find(cloud, name[k]);
		bool able = column && (k < 3 || narrow) &&
					(column->type == SCAN_FLOAT32 || column->type == SCAN_FLOAT64);
		found[k] = (repeated){ able ? column : NULL, k < 3 ? points->position + k : NULL,
							   narrow ? narrow + k % 3 : NULL };
	}
}

static double value_of(const repeated *r, size_t i)
{
	return r->wide ? r->wide[3 * i] : (double)r->narrow[3 * i];
}

/* Whether a column has these values to the last bit. */
static bool is_same(const repeated *r, size_t count)
{
	bool same = true;
	for (size_t i = 0; i < count && same; i++) {
		double value = value_of(r, i);
		float narrow = (float)value;
		same = r->column->type == SCAN_FLOAT64
				   ? memcmp((double *)r->column->data + i, &value, sizeof value) == 0
				   : memcmp((float *)r->column->data + i, &narrow, sizeof narrow) == 0;
	}
	return same;
}

void scan_put_aside(scan *cloud, const scan_points *points)
{
	repeated found[REPEATED];
	find_repeated(cloud, points, found);
	for (size_t k = 0; k < REPEATED; k++) {
		if (!found[k].column || !is_same(&found[k], cloud->count))
			continue;
		free(found[k].column->data);
		found[k].column->data = NULL;
	}
}

static bool make_again(const repeated *r, size_t count)
{
	bool wide = r->column->type == SCAN_FLOAT64;
	r->column->data = reallocarray(NULL, count ? count : 1, scan_type_size(r->column->type));
	if (!r->column->data)
		return false;
	for (size_t i = 0; i < count; i++) {
		if (wide)
			((double *)r->column->data)[i] = value_of(r, i);
		else
			((float *)r->column->data)[i] = (float)value_of(r, i);
	}
	return true;
}

gw_status scan_take_back(scan *cloud, const scan_points *points, gw_error *error)
{
	repeated found[REPEATED];
	find_repeated(cloud, points, found);
	for (size_t k = 0; k < REPEATED; k++)
		if (found[k].column && !found[k].column->data && !make_again(&found[k], cloud->count))
			return gw_fail(error, GW_ERROR_MEMORY, "no memory for the column '%s' of %zu points",
						   found[k].column->name, cloud->count);
	return GW_OK;
}

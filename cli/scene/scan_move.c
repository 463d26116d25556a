/* scan_move.c - see scan_move.h. */
#include "scene/scan_move.h"

#include "points/scan_splats.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const position_names[3] = { "x", "y", "z" };
static const char *const normal_names[3] = { "nx", "ny", "nz" };

/* Replaces three columns by doubles, M * v; what they held comes from scan_value. */
static gw_status transform_columns(scan *cloud, const char *const name[3], const double m[9],
								   const double shift[3], gw_error *error)
{
	double *value = reallocarray(NULL, cloud->count, 3 * sizeof *value);
	if (!value)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to move %zu points", cloud->count);
	for (int k = 0; k < 3; k++) {
		const scan_column *column = scan_find(cloud, name[k]);
		for (size_t i = 0; i < cloud->count; i++)
			value[3 * i + (size_t)k] = scan_value(column, i);
	}
	gw_status status = GW_OK;
	for (int k = 0; k < 3 && status == GW_OK; k++) {
		scan_remove_column(cloud, name[k]);
		scan_column *column = scan_add_column(cloud, name[k], SCAN_FLOAT64, error);
		status = column ? GW_OK : GW_ERROR_MEMORY;
		for (size_t i = 0; column && i < cloud->count; i++) {
			const double *v = value + 3 * i;
			((double *)column->data)[i] =
				m[3 * k] * v[0] + m[3 * k + 1] * v[1] + m[3 * k + 2] * v[2] + shift[k];
		}
	}
	free(value);
	return status;
}

/* Cofactors of a 3x3 matrix: its inverse transposed, up to a factor. */
static void cofactors(const double a[9], double c[9])
{
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
			c[3 * i + j] = a[3 * i1 + j1] * a[3 * i2 + j2] - a[3 * i1 + j2] * a[3 * i2 + j1];
		}
}

/* Normals keep their length, which says how much they spread. */
static gw_status transform_normals(scan *cloud, const char *const name[3], const double linear[9],
								   gw_error *error)
{
	static const double zero[3] = { 0 };
	double c[9];
	cofactors(linear, c);
	double determinant = linear[0] * c[0] + linear[1] * c[1] + linear[2] * c[2];
	for (int k = 0; k < 9; k++)
		c[k] *= determinant < 0.0 ? -1.0 : 1.0;
	double *length = reallocarray(NULL, cloud->count, sizeof *length);
	if (!length)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to turn %zu normals", cloud->count);
	for (size_t i = 0; i < cloud->count; i++) {
		double n[3];
		for (int k = 0; k < 3; k++)
			n[k] = scan_value(scan_find(cloud, name[k]), i);
		length[i] = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
	}
	gw_status status = transform_columns(cloud, name, c, zero, error);
	for (size_t i = 0; i < cloud->count && status == GW_OK; i++) {
		double *n[3], sum = 0.0;
		for (int k = 0; k < 3; k++) {
			n[k] = (double *)scan_find(cloud, name[k])->data + i;
			sum += *n[k] * *n[k];
		}
		for (int k = 0; k < 3 && sum > 0.0; k++)
			*n[k] *= length[i] / sqrt(sum);
	}
	free(length);
	return status;
}

gw_status scan_move(scan *cloud, const double matrix[16], gw_error *error)
{
	double linear[9], shift[3];
	for (int row = 0; row < 3; row++) {
		memcpy(linear + 3 * row, matrix + 4 * row, 3 * sizeof *linear);
		shift[row] = matrix[4 * row + 3];
	}
	for (size_t i = 0; i < cloud->scanner_count + cloud->image_count; i++) {
		bool image = i >= cloud->scanner_count;
		double s[3],
			*to = image ? cloud->image[i - cloud->scanner_count].scanner : cloud->scanner + 3 * i;
		memcpy(s, to, sizeof s);
		for (int k = 0; k < 3; k++)
			to[k] = linear[3 * k] * s[0] + linear[3 * k + 1] * s[1] + linear[3 * k + 2] * s[2] +
					shift[k];
	}
	GW_TRY(transform_columns(cloud, position_names, linear, shift, error));
	for (int t = 0; t < 2; t++) {
		const char *const *name = t == 0 ? normal_names : scan_axis_names;
		if (scan_find(cloud, name[0]) && scan_find(cloud, name[1]) && scan_find(cloud, name[2]))
			GW_TRY(transform_normals(cloud, name, linear, error));
	}
	return GW_OK;
}

#include "options/motion_path.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void motion_path_clear(motion_path *path)
{
	free(path->key);
	free(path->matrix);
	*path = (motion_path){ 0 };
}

/* ------------------------------------------------------------------------------ interpolation */

/* The nearest key from `at` on, stepping by `step`, that gives the value; key_count: none. */
static size_t find_key(const motion_path *path, int which, size_t at, int step)
{
	while (at < path->key_count && !(path->key[at].given & 1u << which))
		at += (size_t)step; /* below 0 it wraps, to above key_count */
	return at < path->key_count ? at : path->key_count;
}

/* Slope at key `at` between those before and behind it, a frame. */
static void slope_at(const motion_path *path, int which, size_t at, double slope[3])
{
	size_t before = find_key(path, which, at - 1, -1), behind = find_key(path, which, at + 1, 1);
	const motion_key *a = &path->key[before < path->key_count ? before : at];
	const motion_key *b = &path->key[behind < path->key_count ? behind : at];
	double frames = (double)b->frame - (double)a->frame;
	for (int k = 0; k < 3; k++)
		slope[k] = frames > 0.0 ? (b->value[which][k] - a->value[which][k]) / frames : 0.0;
}

/* Cubic Hermite between two keys, whose slopes follow from their neighbours (Catmull-Rom). */
static void between(const motion_path *path, int which, size_t from, size_t to, double share,
					double value[3])
{
	const double *a = path->key[from].value[which], *b = path->key[to].value[which];
	if (!path->smooth) {
		for (int k = 0; k < 3; k++)
			value[k] = a[k] + share * (b[k] - a[k]);
		return;
	}
	double u[3], v[3], frames = (double)path->key[to].frame - (double)path->key[from].frame;
	double t = share, t2 = t * t, t3 = t2 * t;
	slope_at(path, which, from, u);
	slope_at(path, which, to, v);
	for (int k = 0; k < 3; k++)
		value[k] = (2 * t3 - 3 * t2 + 1) * a[k] + (t3 - 2 * t2 + t) * frames * u[k] +
				   (3 * t2 - 2 * t3) * b[k] + (t3 - t2) * frames * v[k];
}

/*
 * A value in a frame: that of the keyframes around it which give it, interpolated; before the first
 * and behind the last of them, theirs. False, and `value` left alone, when no keyframe gives it.
 */
static bool value_in_frame(const motion_path *path, int which, uint32_t frame, double value[3])
{
	size_t behind = find_key(path, which, 0, 1);
	while (behind < path->key_count && path->key[behind].frame <= frame)
		behind = find_key(path, which, behind + 1, 1);
	size_t last = find_key(path, which, behind - 1, -1);
	if (behind == path->key_count && last == path->key_count)
		return false;
	if (behind == path->key_count || last == path->key_count) {
		memcpy(value, path->key[last == path->key_count ? behind : last].value[which],
			   3 * sizeof *value);
		return true;
	}
	double first = path->key[last].frame, frames = path->key[behind].frame - first;
	between(path, which, last, behind, ((double)frame - first) / frames, value);
	return true;
}

/* ------------------------------------------------------------------------------------ matrices */

static void multiply(const double a[16], const double b[16], double result[16])
{
	double product[16];
	for (int i = 0; i < 4; i++)
		for (int j = 0; j < 4; j++) {
			product[4 * i + j] = 0.0;
			for (int k = 0; k < 4; k++)
				product[4 * i + j] += a[4 * i + k] * b[4 * k + j];
		}
	memcpy(result, product, sizeof product);
}

/* Of a matrix that has an inverse, and whose last row is 0, 0, 0, 1. */
static void invert(const double m[16], double result[16])
{
	double c[9], determinant = 0.0;
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
			c[3 * i + j] = m[4 * i1 + j1] * m[4 * i2 + j2] - m[4 * i1 + j2] * m[4 * i2 + j1];
		}
	for (int j = 0; j < 3; j++)
		determinant += m[j] * c[j];
	memset(result, 0, 16 * sizeof *result);
	result[15] = 1.0;
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			result[4 * i + j] = c[3 * j + i] / determinant;
			result[4 * i + 3] -= result[4 * i + j] * m[4 * j + 3];
		}
}

static void turn(double m[16], int axis, double degrees)
{
	const double radians = degrees * acos(-1.0) / 180.0;
	const int a = (axis + 1) % 3, b = (axis + 2) % 3;
	double rotation[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };
	rotation[4 * a + a] = rotation[4 * b + b] = cos(radians);
	rotation[4 * b + a] = sin(radians);
	rotation[4 * a + b] = -sin(radians);
	multiply(rotation, m, m);
}

void motion_path_matrix(const motion_path *path, const double *matrix, uint32_t frame,
						double result[16])
{
	if (path->matrix_count > 0) {
		double back[16];
		invert(matrix, back);
		multiply(path->matrix + 16 * (size_t)frame, back, result);
		memcpy(result + 12, (double[4]){ 0, 0, 0, 1 }, 4 * sizeof *result);
		return;
	}
	double move[3] = { 0 }, degrees[3] = { 0 }, scale[3] = { 1 }, pivot[3];
	value_in_frame(path, MOTION_MOVE, frame, move);
	value_in_frame(path, MOTION_ROTATE, frame, degrees);
	value_in_frame(path, MOTION_SCALE, frame, scale);
	for (int k = 0; k < 3; k++)
		pivot[k] = path->has_pivot ? path->pivot[k] : matrix[4 * k + 3];
	memset(result, 0, 16 * sizeof *result);
	for (int k = 0; k < 3; k++) {
		result[5 * k] = scale[0];
		result[4 * k + 3] = -scale[0] * pivot[k];
	}
	result[15] = 1.0;
	for (int axis = 0; axis < 3; axis++)
		turn(result, axis, degrees[axis]);
	for (int k = 0; k < 3; k++)
		result[4 * k + 3] += pivot[k] + move[k];
}

/* --------------------------------------------------------------------------------------- lamps */

gw_status motion_path_lamp(const motion_path *path, uint32_t frame, lamp *light, gw_error *error)
{
	for (int which = 0; which < LIGHT_KEY_COUNT; which++) {
		double value[3];
		light_value kind = light_keys[which].value;
		if (!value_in_frame(path, which, frame, value))
			continue;
		bool positive = kind == LIGHT_VALUE_COLOR || kind == LIGHT_VALUE_NUMBER;
		for (int k = 0; k < 3 && positive; k++)
			value[k] = fmax(value[k], 0.0);
		GW_TRY(light_set(light, (light_key_id)which, value, kind == LIGHT_VALUE_NUMBER ? 1 : 3,
						 error));
	}
	return GW_OK;
}

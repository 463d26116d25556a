#include "text/cloud_format.h"
#include "points/scan_color.h"

#include <math.h>
#include <string.h>

#define SAMPLE_BYTES 27

static uint32_t load_32(const uint8_t *bytes)
{
	return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 |
		   (uint32_t)bytes[3] << 24;
}

static void store_32(uint8_t *bytes, uint32_t value)
{
	for (int b = 0; b < 4; b++)
		bytes[b] = (uint8_t)(value >> 8 * b);
}

/* ------------------------------------------------------------------------------- reading */

static gw_status check_length(const input_file *in, size_t *count, gw_error *error)
{
	if (in->length < 4)
		return gw_fail(error, GW_ERROR_DATA,
					   "%s has %zu bytes, too few for the count at the start of a .cloud file",
					   in->name, in->length);
	uint32_t claimed = load_32(in->data);
	if (claimed > INT32_MAX || (in->length - 4) % SAMPLE_BYTES != 0 ||
		(in->length - 4) / SAMPLE_BYTES != claimed)
		return gw_fail(error, GW_ERROR_DATA,
					   "%s: the count at byte 0 is %ld, but %zu bytes follow it, which is %zu "
					   "samples of 27 bytes and %zu bytes more; the file is damaged",
					   in->name, (long)(int32_t)claimed, in->length - 4,
					   (in->length - 4) / SAMPLE_BYTES, (in->length - 4) % SAMPLE_BYTES);
	*count = claimed;
	return GW_OK;
}

gw_status cloud_read(input_file *in, scan *cloud, gw_error *error)
{
	static const char *const names[9] = { "x", "y", "z", "nx", "ny", "nz", "red", "green", "blue" };
	*cloud = (scan){ .up = 'y' };
	GW_TRY(check_length(in, &cloud->count, error));
	for (size_t c = 0; c < 9; c++) {
		scan_column *column =
			scan_add_column(cloud, names[c], c < 6 ? SCAN_FLOAT32 : SCAN_UINT8, error);
		if (!column) {
			scan_clear(cloud);
			return GW_ERROR_MEMORY;
		}
		const uint8_t *from = in->data + 4 + (c < 6 ? 4 * c : 18 + c);
		for (size_t i = 0; i < cloud->count; i++, from += SAMPLE_BYTES) {
			if (c < 6) {
				uint32_t bits = load_32(from);
				memcpy((float *)column->data + i, &bits, sizeof bits);
			} else {
				((uint8_t *)column->data)[i] = *from;
			}
		}
	}
	return GW_OK;
}

/* ------------------------------------------------------------------------------- writing */

typedef struct sources {
	const scan_column *position[3];
	const scan_column *normal[3]; /* NULL when there are none */
	scan_color color;
	bool has_normal, has_color;
	bool turn; /* z up to y up */
} sources;

static gw_status cloud_accept(const scan *cloud, const char *name, gw_error *error)
{
	static const char *const names[3] = { "x", "y", "z" };
	const scan_column *position[3];
	if (cloud->count > INT32_MAX)
		return gw_fail(error, GW_ERROR_DATA,
					   "%s: a .cloud file holds at most 2147483647 points, not %zu; write PLY",
					   name, cloud->count);
	if (!scan_find_triple(cloud, names, position))
		return gw_fail(error, GW_ERROR_DATA, "%s: the points have no coordinates x, y and z", name);
	for (int k = 0; k < 3; k++) {
		for (size_t i = 0; i < cloud->count; i++) {
			double value = scan_value(position[k], i);
			if (isfinite(value) && fabs(value - (double)(float)value) > 1e-3)
				return gw_fail(error, GW_ERROR_DATA,
							   "%s: the coordinate %.3f of point %zu would move by over a "
							   "millimetre in the 32-bit numbers of a .cloud file; write PLY",
							   name, value, i);
		}
	}
	return GW_OK;
}

static void find_sources(const scan *cloud, sources *from)
{
	static const char *const position[3] = { "x", "y", "z" };
	static const char *const normal[3] = { "nx", "ny", "nz" };
	scan_find_triple(cloud, position, from->position);
	from->has_normal = scan_find_triple(cloud, normal, from->normal);
	from->has_color = scan_color_find(cloud, scan_color_names, &from->color);
	from->turn = cloud->up == 'z';
}

static void put_vector(uint8_t *to, const scan_column *const column[3], size_t i, bool turn)
{
	float v[3] = { (float)scan_value(column[0], i), (float)scan_value(column[1], i),
				   (float)scan_value(column[2], i) };
	if (turn) {
		float up = v[2];
		v[2] = -v[1];
		v[1] = up;
	}
	for (int k = 0; k < 3; k++) {
		uint32_t bits;
		memcpy(&bits, &v[k], sizeof bits);
		store_32(to + 4 * k, bits);
	}
}

static uint8_t to_byte(double value)
{
	if (!(value > 0.0))
		return 0;
	return value >= 1.0 ? 255 : (uint8_t)(value * 255.0 + 0.5);
}

static void put_sample(uint8_t *to, const sources *from, size_t i)
{
	memset(to, 0, SAMPLE_BYTES);
	put_vector(to, from->position, i, from->turn);
	if (from->has_normal)
		put_vector(to + 12, from->normal, i, from->turn);
	for (int k = 0; k < 3; k++)
		to[24 + k] = to_byte(from->has_color ? scan_color_value(&from->color, k, i)
											 : scan_srgb_encode((double)GW_ALBEDO_DEFAULT));
}

gw_status cloud_write(output_file *out, const scan *cloud, gw_error *error)
{
	sources from = { 0 };
	GW_TRY(cloud_accept(cloud, output_file_name(out), error));
	find_sources(cloud, &from);
	uint8_t bytes[SAMPLE_BYTES];
	store_32(bytes, (uint32_t)cloud->count);
	GW_TRY(output_file_write(out, bytes, 4, error));
	for (size_t i = 0; i < cloud->count; i++) {
		put_sample(bytes, &from, i);
		GW_TRY(output_file_write(out, bytes, SAMPLE_BYTES, error));
	}
	return GW_OK;
}

static const char *const extensions[] = { "cloud", NULL };

const format cloud_format = {
	.name = "cloud",
	.description = "point cloud of Salm's thesis, y up",
	.extensions = extensions,
	.read = cloud_read,
	.accept = cloud_accept,
	.row_bytes = SAMPLE_BYTES,
	.write = cloud_write,
};

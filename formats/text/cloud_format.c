#include "text/cloud_format.h"
#include "points/scan_color.h"

#include <math.h>
#include <stdlib.h>
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

static gw_status read_column(const input_file *in, const format_rows *rows, size_t c, scan *cloud,
							 gw_error *error)
{
	static const char *const names[9] = { "x", "y", "z", "nx", "ny", "nz", "red", "green", "blue" };
	const uint8_t *from = in->data + 4 + rows->first * SAMPLE_BYTES + (c < 6 ? 4 * c : 18 + c);
	scan_column *column =
		scan_add_column(cloud, names[c], c < 6 ? SCAN_FLOAT32 : SCAN_UINT8, error);
	if (!column)
		return GW_ERROR_MEMORY;
	for (size_t i = 0; i < cloud->count; i++, from += SAMPLE_BYTES) {
		if (c < 6) {
			uint32_t bits = load_32(from);
			memcpy((float *)column->data + i, &bits, sizeof bits);
		} else {
			((uint8_t *)column->data)[i] = *from;
		}
	}
	return GW_OK;
}

gw_status cloud_read_rows(input_file *in, const format_rows *rows, scan *cloud, gw_error *error)
{
	size_t all;
	*cloud = (scan){ .up = 'y' };
	GW_TRY(check_length(in, &all, error));
	size_t left = rows->first < all ? all - (size_t)rows->first : 0;
	cloud->count = rows->count < left ? (size_t)rows->count : left;
	gw_status status = GW_OK;
	for (size_t c = 0; c < 9 && status == GW_OK; c++)
		status = read_column(in, rows, c, cloud, error);
	const uint8_t *begin = in->data + 4 + rows->first * SAMPLE_BYTES;
	if (status == GW_OK)
		input_file_release(in, begin, begin + cloud->count * SAMPLE_BYTES);
	if (status != GW_OK)
		scan_clear(cloud);
	return status;
}

gw_status cloud_read(input_file *in, scan *cloud, gw_error *error)
{
	return cloud_read_rows(in, &(format_rows){ 0, UINT64_MAX }, cloud, error);
}

uint64_t cloud_count_rows(input_file *in, uint64_t *together)
{
	size_t count;
	gw_error ignored = { 0 };
	*together = 1;
	return check_length(in, &count, &ignored) == GW_OK ? count : 0;
}

/* ------------------------------------------------------------------------------- writing */

typedef struct sources {
	const scan_column *position[3];
	const scan_column *normal[3]; /* NULL when there are none */
	scan_color color;
	bool has_normal, has_color;
	bool turn; /* z up to y up */
} sources;

/* first   points before those of the part */
static gw_status check_part(const scan *part, uint64_t first, const char *name, gw_error *error)
{
	static const char *const names[3] = { "x", "y", "z" };
	const scan_column *position[3];
	if (!scan_find_triple(part, names, position))
		return gw_fail(error, GW_ERROR_DATA, "%s: the points have no coordinates x, y and z", name);
	for (int k = 0; k < 3; k++) {
		for (size_t i = 0; i < part->count; i++) {
			double value = scan_value(position[k], i);
			if (isfinite(value) && fabs(value - (double)(float)value) > 1e-3)
				return gw_fail(error, GW_ERROR_DATA,
							   "%s: the coordinate %.3f of point %llu would move by over a "
							   "millimetre in the 32-bit numbers of a .cloud file; write PLY",
							   name, value, (unsigned long long)(first + i));
		}
	}
	return GW_OK;
}

static gw_status check_count(uint64_t count, const char *name, gw_error *error)
{
	if (count > INT32_MAX)
		return gw_fail(error, GW_ERROR_DATA,
					   "%s: a .cloud file holds at most 2147483647 points, not %llu; write PLY",
					   name, (unsigned long long)count);
	return GW_OK;
}

static gw_status cloud_accept(const scan *cloud, const char *name, gw_error *error)
{
	GW_TRY(check_count(cloud->count, name, error));
	return check_part(cloud, 0, name, error);
}

/* Of colours that are more than bytes all values tell what they count to.
 *   told   by these; NULL: the cloud has all of them */
static void find_sources(const scan *cloud, const scan_color_tally *told, sources *from)
{
	static const char *const position[3] = { "x", "y", "z" };
	static const char *const normal[3] = { "nx", "ny", "nz" };
	scan_find_triple(cloud, position, from->position);
	from->has_normal = scan_find_triple(cloud, normal, from->normal);
	from->has_color = scan_color_find(cloud, scan_color_names, &from->color);
	bool bytes = true;
	for (int k = 0; k < 3 && from->has_color; k++)
		bytes = bytes && from->color.column[k]->type == SCAN_UINT8;
	if (told && !bytes && told->count > 0)
		scan_color_tally_settle(told, &from->color);
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

static gw_status write_count(output_file *out, uint64_t count, gw_error *error)
{
	uint8_t bytes[4];
	store_32(bytes, (uint32_t)count);
	return output_file_write(out, bytes, sizeof bytes, error);
}

static gw_status write_samples(output_file *out, const scan *cloud, const scan_color_tally *told,
							   gw_error *error)
{
	sources from = { 0 };
	uint8_t bytes[SAMPLE_BYTES];
	find_sources(cloud, told, &from);
	for (size_t i = 0; i < cloud->count; i++) {
		put_sample(bytes, &from, i);
		GW_TRY(output_file_write(out, bytes, SAMPLE_BYTES, error));
	}
	return GW_OK;
}

gw_status cloud_write(output_file *out, const scan *cloud, gw_error *error)
{
	GW_TRY(cloud_accept(cloud, output_file_name(out), error));
	GW_TRY(write_count(out, cloud->count, error));
	return write_samples(out, cloud, NULL, error);
}

/* ------------------------------------------------------------------------------ in parts */

/* This format's own part of format.parted. */
typedef struct format_survey {
	scan_color_tally color;
	uint64_t count;
} cloud_survey;

static gw_status survey_begin(format_whole *whole, gw_error *error)
{
	GW_TRY(check_count(whole->count, whole->name, error));
	whole->survey = calloc(1, sizeof *whole->survey);
	return whole->survey ? GW_OK
						 : gw_fail(error, GW_ERROR_MEMORY, "no memory to write %s", whole->name);
}

static gw_status survey_add(format_whole *whole, const scan *part, gw_error *error)
{
	scan_color color;
	GW_TRY(check_part(part, whole->survey->count, whole->name, error));
	(void)scan_color_tally_add(&whole->survey->color, part, scan_color_names, &color);
	whole->survey->count += part->count;
	return GW_OK;
}

static gw_status row(const format_whole *whole, const scan *part, size_t *bytes, gw_error *error)
{
	(void)whole;
	(void)part;
	(void)error;
	*bytes = SAMPLE_BYTES;
	return GW_OK;
}

static gw_status write_head(output_file *out, const format_whole *whole, const scan *first,
							gw_error *error)
{
	(void)first;
	return write_count(out, whole->count, error);
}

static gw_status write_rows(output_file *out, const format_whole *whole, const scan *part,
							gw_error *error)
{
	return write_samples(out, part, &whole->survey->color, error);
}

static const format_parted parted = {
	.survey_begin = survey_begin,
	.survey_add = survey_add,
	.row = row,
	.write_head = write_head,
	.write_rows = write_rows,
};

static const char *const extensions[] = { "cloud", NULL };
static const char *const columns[] = {
	"x", "y", "z", "nx", "ny", "nz", "red", "green", "blue", NULL
};

const format cloud_format = {
	.name = "cloud",
	.description = "point cloud of Salm's thesis, y up",
	.extensions = extensions,
	.read = cloud_read,
	.count_rows = cloud_count_rows,
	.read_rows = cloud_read_rows,
	.accept = cloud_accept,
	.columns = columns,
	.row_bytes = SAMPLE_BYTES,
	.write = cloud_write,
	.parted = &parted,
};

/*
 * Radiance HDR pictures (.hdr, .pic): a header of text, then pixels of four bytes, three mantissas
 * and an exponent, flat or run-length encoded by component and row.
 */
#include "files/number_text.h"
#include "panoramas/panorama.h"

#include <math.h>
#include <string.h>

typedef struct hdr {
	const input_file *in;
	const uint8_t *at, *end;
	double exposure; /* pixels are divided by this */
	gw_error *error;
} hdr;

static gw_status bad(const hdr *h, const char *what)
{
	return gw_fail(h->error, GW_ERROR_DATA, "%s, byte %zu: %s", h->in->name,
				   (size_t)(h->at - h->in->data), what);
}

/* Takes a line without its end; false when there is none. */
static bool take_line(hdr *h, const char **line, size_t *length)
{
	const uint8_t *stop = memchr(h->at, '\n', (size_t)(h->end - h->at));
	if (!stop)
		return false;
	*line = (const char *)h->at;
	*length = (size_t)(stop - h->at);
	h->at = stop + 1;
	return true;
}

static bool begins(const char *line, size_t length, const char *with)
{
	return length >= strlen(with) && memcmp(line, with, strlen(with)) == 0;
}

static gw_status take_header(hdr *h)
{
	const char *line;
	size_t length;
	while (take_line(h, &line, &length)) {
		double factor;
		if (length == 0)
			return GW_OK;
		if (begins(line, length, "FORMAT=") && !begins(line, length, "FORMAT=32-bit_rle_rgbe"))
			return bad(h, "its colours are not 32-bit_rle_rgbe; convert it with ra_xyze -r");
		if (!begins(line, length, "EXPOSURE="))
			continue;
		const char *number = line + 9 + strspn(line + 9, " \t");
		if (number_read(number, (size_t)(line + length - number), &factor) == 0 ||
			!(factor > 1e-30 && factor < 1e30))
			return bad(h, "the exposure before this is no number above 0");
		h->exposure *= factor;
	}
	return bad(h, "the header has no end");
}

/* Takes digits behind an axis, such as "-Y 512"; 0 when they are something else. */
static uint64_t take_side(const char **at, const char *end, const char *axis)
{
	uint64_t side = 0;
	if (end - *at < 4 || memcmp(*at, axis, 3) != 0)
		return 0;
	for (*at += 3; *at < end && **at >= '0' && **at <= '9' && side < 1000000; ++*at)
		side = 10 * side + (uint64_t)(**at - '0');
	return side;
}

static gw_status take_size(hdr *h, panorama *map)
{
	const char *line;
	size_t length;
	if (!take_line(h, &line, &length))
		return bad(h, "the size of the picture is missing");
	const char *at = line, *end = line + length;
	uint64_t height = take_side(&at, end, "-Y "), width = 0;
	if (height > 0 && at < end && *at == ' ') {
		at++;
		width = take_side(&at, end, "+X ");
	}
	if (width == 0)
		return bad(h, "the size before this is not '-Y height +X width', rows from the top");
	/* A run of 127 takes two bytes of each of the four components. */
	uint64_t most = (uint64_t)(h->end - h->at) * 16;
	return panorama_allocate(h->in, width, height, most, map, h->error);
}

/* One component of a row. */
static gw_status take_runs(hdr *h, uint32_t width, uint8_t *component)
{
	uint32_t x = 0;
	while (x < width) {
		if (h->end - h->at < 2)
			return bad(h, "the pixels end too early");
		uint32_t count = *h->at++;
		bool run = count > 128;
		count -= run ? 128 : 0;
		if (count == 0 || count > width - x)
			return bad(h, "a run of pixels does not fit into its row");
		if (!run && (size_t)(h->end - h->at) < count)
			return bad(h, "the pixels end too early");
		if (run)
			memset(component + x, *h->at, count);
		else
			memcpy(component + x, h->at, count);
		h->at += run ? 1 : count;
		x += count;
	}
	return GW_OK;
}

static void put_pixel(const hdr *h, const uint8_t rgbe[4], float *pixel)
{
	if (rgbe[3] == 0)
		return;
	/* A mantissa stands for the middle of its step. */
	double scale = ldexp(1.0, rgbe[3] - 136) / h->exposure;
	for (size_t c = 0; c < 3; c++)
		pixel[c] = (float)(((double)rgbe[c] + 0.5) * scale);
}

/* row: 4 * width bytes of scratch. */
static gw_status take_row(hdr *h, uint32_t width, uint8_t *row, float *pixel)
{
	if (h->end - h->at < 4)
		return bad(h, "the pixels end too early");
	bool runs = width >= 8 && width < 32768 && h->at[0] == 2 && h->at[1] == 2 &&
				((uint32_t)h->at[2] << 8 | h->at[3]) == width;
	if (runs) {
		h->at += 4;
		for (size_t c = 0; c < 4; c++)
			GW_TRY(take_runs(h, width, row + c * width));
		for (uint32_t x = 0; x < width; x++) {
			const uint8_t rgbe[4] = { row[x], row[width + x], row[2 * width + x],
									  row[3 * width + x] };
			put_pixel(h, rgbe, pixel + 3 * (size_t)x);
		}
		return GW_OK;
	}
	for (uint32_t x = 0; x < width; x++, h->at += 4) {
		if (h->end - h->at < 4)
			return bad(h, "the pixels end too early");
		if (h->at[0] == 1 && h->at[1] == 1 && h->at[2] == 1)
			return bad(h, "runs of the kind from before 1991; convert it with ra_xyze -r");
		put_pixel(h, h->at, pixel + 3 * (size_t)x);
	}
	return GW_OK;
}

gw_status panorama_hdr_read(const input_file *in, panorama *map, gw_error *error)
{
	static _Thread_local uint8_t row[4 * 32768];
	hdr h = { in, in->data, in->data + in->length, 1.0, error };
	*map = (panorama){ 0 };
	gw_status status = take_header(&h);
	if (status == GW_OK)
		status = take_size(&h, map);
	for (uint32_t y = 0; status == GW_OK && y < map->height; y++)
		status = take_row(&h, map->width, row, map->pixels + 3 * (size_t)map->width * y);
	if (status != GW_OK)
		panorama_clear(map);
	return status;
}

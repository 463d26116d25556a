#include "las/las_header.h"
#include "las/las_notes.h"
#include "files/little_endian.h"
#include "files/number_text.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* An extended VLR, after the points, has a length of 64 bits. */
#define EVLR_BYTES 60

/* Lines of text VLRs that become comments; more only cost memory. */
#define TEXT_LINES 256

typedef struct parser {
	const input_file *in;
	las_header *header;
	scan *notes;
	gw_error *error;
	size_t size;  /* of the public header block */
	size_t lines; /* of text VLRs so far */
} parser;

size_t las_format_bytes(unsigned format)
{
	static const size_t bytes[LAS_FORMATS] = { 20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67 };
	return bytes[format];
}

static gw_status fail(const parser *p, size_t at, const char *what)
{
	return gw_fail(p->error, GW_ERROR_DATA, "%s, byte %zu: %s", p->in->name, at, what);
}

/* ------------------------------------------------------------------- public header block */

static gw_status check_kind(parser *p)
{
	const uint8_t *data = p->in->data;
	if (p->in->length < LAS_HEADER_BYTES || memcmp(data, "LASF", 4) != 0)
		return gw_fail(p->error, GW_ERROR_DATA,
					   "%s is no LAS file: it does not begin with LASF and a header of %d bytes",
					   p->in->name, LAS_HEADER_BYTES);
	p->header->minor = data[25];
	if (data[24] != 1 || data[25] > 5)
		return gw_fail(p->error, GW_ERROR_DATA,
					   "%s, byte 24: LAS version %u.%u, where 1.0 to 1.5 can be read", p->in->name,
					   data[24], data[25]);
	p->header->encoding = load_16(data + 6);
	p->header->format = data[104] & 0x3f;
	p->header->compressed = (data[104] & 0xc0) != 0;
	if (p->header->format >= LAS_FORMATS)
		return gw_fail(p->error, GW_ERROR_DATA,
					   "%s, byte 104: point data record format %u, where 0 to 10 can be read",
					   p->in->name, p->header->format);
	return GW_OK;
}

static gw_status take_sizes(parser *p)
{
	las_header *h = p->header;
	p->size = load_16(p->in->data + 94);
	h->points = load_32(p->in->data + 96);
	h->record = load_16(p->in->data + 105);
	if (p->size < LAS_HEADER_BYTES || p->size > p->in->length)
		return gw_fail(p->error, GW_ERROR_DATA,
					   "%s, byte 94: a header of %zu bytes in a file of %zu; it has 227 or more",
					   p->in->name, p->size, p->in->length);
	if (h->points < p->size || h->points > p->in->length)
		return gw_fail(p->error, GW_ERROR_DATA,
					   "%s, byte 96: the points shall begin at byte %zu, but the header ends at "
					   "%zu and the file at %zu",
					   p->in->name, h->points, p->size, p->in->length);
	if (h->record < las_format_bytes(h->format))
		return gw_fail(p->error, GW_ERROR_DATA,
					   "%s, byte 105: points of %zu bytes, but those of format %u take %zu",
					   p->in->name, h->record, h->format, las_format_bytes(h->format));
	return GW_OK;
}

/* LAS 1.4 counts in 64 bits; the old count is then 0, or the same, or wrong. */
static gw_status take_count(parser *p)
{
	uint64_t old = load_32(p->in->data + 107), count = 0;
	if (p->header->minor >= 4 && p->size >= LAS_HEADER_BYTES_1_4)
		count = load_64(p->in->data + 247);
	p->header->count = count ? count : old;
	if (count && old && count != old)
		return las_note(p->notes, p->error,
						"the header counts %" PRIu64 " points in 64 bits and %" PRIu64
						" in 32; the first holds",
						count, old);
	return GW_OK;
}

static gw_status take_grid(parser *p)
{
	las_header *h = p->header;
	for (size_t k = 0; k < 3; k++) {
		h->scale[k] = load_double(p->in->data + 131 + 8 * k);
		h->offset[k] = load_double(p->in->data + 155 + 8 * k);
		h->maximum[k] = load_double(p->in->data + 179 + 16 * k);
		h->minimum[k] = load_double(p->in->data + 187 + 16 * k);
		if (!isfinite(h->scale[k]) || h->scale[k] == 0.0)
			return fail(p, 131 + 8 * k, "a scale of the coordinates that is 0 or no number");
		if (!isfinite(h->offset[k]))
			return fail(p, 155 + 8 * k, "an offset of the coordinates that is no number");
	}
	return GW_OK;
}

/* A text that fills its field or ends in a zero. */
static gw_status note_field(parser *p, const char *key, size_t at, size_t size)
{
	const char *text = (const char *)p->in->data + at;
	return las_note_text(p->notes, key, text, strnlen(text, size), p->error);
}

static gw_status note_header(parser *p)
{
	const uint8_t *data = p->in->data;
	double file[4] = { load_16(data + 6), load_16(data + 4), load_16(data + 90),
					   load_16(data + 92) };
	GW_TRY(las_note_numbers(p->notes, "scale", p->header->scale, 3, p->error));
	GW_TRY(las_note_numbers(p->notes, "offset", p->header->offset, 3, p->error));
	GW_TRY(las_note_numbers(p->notes, "file", file, 4, p->error));
	GW_TRY(note_field(p, "system", 26, 32));
	return note_field(p, "software", 58, 32);
}

/* ------------------------------------------------------------------------------------ VLRs */

/* Numbers as text: 16-bit keys or doubles. */
static gw_status note_geo(parser *p, const char *key, las_vlr body, size_t size)
{
	size_t count = body.length / size, used = 0;
	char *text = reallocarray(NULL, count + 1, NUMBER_TEXT);
	if (!text)
		return gw_fail(p->error, GW_ERROR_MEMORY, "no memory for the header of %s", p->in->name);
	for (size_t i = 0; i < count; i++) {
		const uint8_t *from = body.data + i * size;
		used += number_print(text + used, size == 2 ? load_16(from) : load_double(from));
		text[used++] = ' ';
	}
	gw_status status = las_note_text(p->notes, key, text, used ? used - 1 : 0, p->error);
	free(text);
	return status;
}

/* Each line is a comment, but for those that name columns. */
static gw_status note_lines(parser *p, las_vlr body)
{
	const char *text = (const char *)body.data;
	size_t length = strnlen(text, body.length);
	for (size_t at = 0; at < length && p->lines < TEXT_LINES;) {
		size_t end = at;
		char line[LAS_NOTE_TEXT + 1];
		while (end < length && text[end] != '\n')
			end++;
		size_t size = end - at < LAS_NOTE_TEXT ? end - at : LAS_NOTE_TEXT;
		for (size_t i = 0; i < size; i++)
			line[i] = text[at + i] >= ' ' && text[at + i] <= '~' ? text[at + i] : ' ';
		while (size > 0 && line[size - 1] == ' ')
			size--;
		line[size] = '\0';
		at = end + 1;
		if (size > 0 && strncmp(line, LAS_COLUMN_LINE, strlen(LAS_COLUMN_LINE)) != 0 && ++p->lines)
			GW_TRY(scan_add_comment(p->notes, line, p->error));
	}
	return GW_OK;
}

static gw_status take_crs(parser *p, unsigned id, las_vlr body)
{
	const char *text = (const char *)body.data;
	switch (id) {
	case LAS_VLR_WKT:
		return las_note_text(p->notes, "wkt", text, strnlen(text, body.length), p->error);
	case LAS_VLR_GEO_KEYS:
		return note_geo(p, "geokeys", body, 2);
	case LAS_VLR_GEO_DOUBLES:
		return note_geo(p, "geodoubles", body, 8);
	case LAS_VLR_GEO_TEXT:
		return las_note_text(p->notes, "geotext", text, strnlen(text, body.length), p->error);
	default:
		return GW_OK;
	}
}

/* record: a VLR or an EVLR, whose user and number stand at the same places. */
static gw_status take_vlr(parser *p, const uint8_t *record, las_vlr body)
{
	const char *user = (const char *)record + 2;
	unsigned id = load_16(record + 18);
	if (strncmp(user, LAS_USER_CRS, 16) == 0)
		return take_crs(p, id, body);
	if (strncmp(user, LAS_USER_LASZIP, 16) == 0 && id == LAS_VLR_LASZIP)
		p->header->laszip = body;
	if (strncmp(user, LAS_USER_SPEC, 16) == 0 && id == LAS_VLR_EXTRA)
		p->header->extra = body;
	if (strncmp(user, LAS_USER_SPEC, 16) == 0 && id == LAS_VLR_TEXT) {
		p->header->text = body;
		return note_lines(p, body);
	}
	return GW_OK;
}

static gw_status take_vlrs(parser *p)
{
	uint32_t count = load_32(p->in->data + 100), done = 0;
	size_t at = p->size, end = p->header->points;
	for (; done < count; done++) {
		if (end - at < LAS_VLR_BYTES)
			break;
		const uint8_t *record = p->in->data + at;
		size_t length = load_16(record + 20);
		if (length > end - at - LAS_VLR_BYTES)
			break;
		GW_TRY(take_vlr(p, record, (las_vlr){ record + LAS_VLR_BYTES, length }));
		at += LAS_VLR_BYTES + length;
	}
	if (done < count)
		GW_TRY(las_note(p->notes, p->error,
						"the header counts %" PRIu32 " variable-length records, of which %" PRIu32
						" are whole before the points",
						count, done));
	return GW_OK;
}

/* Those after the points; only a coordinate system is looked for there. */
static gw_status take_evlrs(parser *p)
{
	if (p->header->minor < 4 || p->size < LAS_HEADER_BYTES_1_4)
		return GW_OK;
	uint64_t start = load_64(p->in->data + 235);
	uint32_t count = load_32(p->in->data + 243);
	for (uint32_t done = 0; done < count; done++) {
		if (start < p->header->points || start > p->in->length ||
			p->in->length - start < EVLR_BYTES)
			break;
		const uint8_t *record = p->in->data + start;
		uint64_t length = load_64(record + 20), rest = p->in->length - start - EVLR_BYTES;
		if (length > rest)
			break;
		if (strncmp((const char *)record + 2, LAS_USER_CRS, 16) == 0 && length <= UINT16_MAX)
			GW_TRY(take_crs(p, load_16(record + 18),
							(las_vlr){ record + EVLR_BYTES, (size_t)length }));
		start += EVLR_BYTES + length;
	}
	return GW_OK;
}

gw_status las_header_parse(las_header *header, const input_file *in, scan *notes, gw_error *error)
{
	*header = (las_header){ 0 };
	parser p = { .in = in, .header = header, .notes = notes, .error = error };
	GW_TRY(check_kind(&p));
	GW_TRY(take_sizes(&p));
	GW_TRY(take_count(&p));
	GW_TRY(take_grid(&p));
	GW_TRY(note_header(&p));
	GW_TRY(take_vlrs(&p));
	return take_evlrs(&p);
}

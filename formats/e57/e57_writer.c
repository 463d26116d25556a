/*
 * E57, written from its first byte to its last: header, packets of each scan, description.
 */
#include "e57/e57_format.h"
#include "e57/e57_layout.h"
#include "e57/e57_sink.h"
#include "e57/e57_text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct writer {
	const e57_layout *layout;
	e57_sink sink;
	uint8_t *stretch; /* owned; values of a field in a packet */
	gw_error *error;
} writer;

/* ------------------------------------------------------------------------------- values */

static bool is_finite_point(const e57_out_scan *s, size_t p)
{
	for (size_t f = 0; f < s->field_count; f++)
		if (s->field[f].source == E57_OF_POSITION && !isfinite(scan_value(s->field[f].column, p)))
			return false;
	return true;
}

static double real_value(const e57_out_scan *s, const e57_out_field *f, size_t p)
{
	double value = scan_value(f->column, p);
	if (f->source != E57_OF_POSITION)
		return value;
	if (!isfinite(value))
		return 0.0;
	return s->place ? e57_layout_local(value, s->place[f->axis]) : value;
}

static int64_t whole_value(const e57_layout *l, const e57_out_scan *s, const e57_out_field *f,
						   size_t p)
{
	switch (f->source) {
	case E57_OF_STATE:
		return is_finite_point(s, p) ? 0 : 2;
	case E57_OF_ROW:
		return l->cloud->image_cell[p] / s->image->columns;
	case E57_OF_CELL_COLUMN:
		return l->cloud->image_cell[p] % s->image->columns;
	case E57_OF_COLUMN:
	case E57_OF_POSITION:
		break;
	}
	return (int64_t)scan_value(f->column, p);
}

static void store(uint8_t *to, uint64_t value, size_t size)
{
	for (size_t b = 0; b < size; b++)
		to[b] = (uint8_t)(value >> 8 * b);
}

static void store_real(uint8_t *to, double value, e57_type type)
{
	uint64_t bits;
	uint32_t few;
	float single = (float)value;
	memcpy(&bits, &value, sizeof bits);
	memcpy(&few, &single, sizeof few);
	store(to, type == E57_SINGLE ? few : bits, type == E57_SINGLE ? 4 : 8);
}

/* Integers each in its bits, the lowest first. */
static void fill_whole(const writer *w, const e57_out_scan *s, const e57_out_field *f, size_t first,
					   size_t count)
{
	uint64_t kept = 0;
	unsigned bits = 0;
	uint8_t *to = w->stretch;
	for (size_t i = first; i < first + count; i++) {
		size_t p = e57_layout_point(w->layout, s, i);
		uint64_t value = (uint64_t)whole_value(w->layout, s, f, p) - (uint64_t)f->field.minimum;
		/* Not more than 32 bits, as the columns have, so that 7 more have room. */
		kept |= value << bits;
		for (bits += f->field.bits; bits >= 8; bits -= 8, kept >>= 8)
			*to++ = (uint8_t)kept;
	}
	if (bits > 0)
		*to = (uint8_t)kept;
}

static void fill_stretch(const writer *w, const e57_out_scan *s, const e57_out_field *f,
						 size_t first, size_t count)
{
	size_t size = f->field.bits / 8;
	if (f->field.type == E57_INTEGER) {
		if (f->field.bits > 0)
			fill_whole(w, s, f, first, count);
		return;
	}
	for (size_t i = 0; i < count; i++) {
		size_t p = e57_layout_point(w->layout, s, first + i);
		store_real(w->stretch + i * size, real_value(s, f, p), f->field.type);
	}
}

/* ------------------------------------------------------------------------------- packets */

static void write_packet(writer *w, const e57_out_scan *s, size_t first, size_t count)
{
	size_t length = e57_layout_packet(s, count), written = e57_layout_packet_head(s);
	e57_sink_number(&w->sink, 1, 2);
	e57_sink_number(&w->sink, length - 1, 2);
	e57_sink_number(&w->sink, s->field_count, 2);
	for (size_t f = 0; f < s->field_count; f++)
		e57_sink_number(&w->sink, e57_layout_stretch(&s->field[f], count), 2);
	for (size_t f = 0; f < s->field_count; f++) {
		size_t size = e57_layout_stretch(&s->field[f], count);
		fill_stretch(w, s, &s->field[f], first, count);
		e57_sink_put(&w->sink, w->stretch, size);
		written += size;
	}
	e57_sink_number(&w->sink, 0, length - written);
}

static void write_section(writer *w, const e57_out_scan *s)
{
	e57_sink_number(&w->sink, 1, 8);
	e57_sink_number(&w->sink, s->length, 8);
	e57_sink_number(&w->sink, e57_sink_place(s->at + E57_SECTION_HEAD), 8);
	e57_sink_number(&w->sink, 0, 8);
	for (size_t first = 0; first < s->count; first += s->packet) {
		size_t rest = s->count - first;
		write_packet(w, s, first, rest < s->packet ? rest : s->packet);
	}
}

static void write_header(writer *w, size_t text_length)
{
	uint64_t length = w->layout->length;
	e57_sink_put(&w->sink, "ASTM-E57", 8);
	e57_sink_number(&w->sink, 1, 4);
	e57_sink_number(&w->sink, 0, 4);
	e57_sink_number(&w->sink, e57_sink_length(length + text_length), 8);
	e57_sink_number(&w->sink, e57_sink_place(length), 8);
	e57_sink_number(&w->sink, text_length, 8);
	e57_sink_number(&w->sink, E57_PAGE, 8);
}

static gw_status write_all(writer *w)
{
	char *text;
	size_t length;
	GW_TRY(e57_text_make(w->layout, &text, &length, w->error));
	write_header(w, length);
	for (size_t s = 0; s < w->layout->scan_count; s++)
		write_section(w, &w->layout->scan[s]);
	e57_sink_put(&w->sink, text, length);
	free(text);
	return e57_sink_end(&w->sink, w->error);
}

gw_status e57_write(output_file *out, const scan *cloud, gw_error *error)
{
	e57_layout layout;
	/* A stretch is at most as long as a packet. */
	writer w = { .layout = &layout, .sink = { .out = out }, .error = error };
	gw_status status = e57_layout_make(cloud, output_file_name(out), &layout, error);
	w.stretch = status == GW_OK ? malloc((size_t)1 << 16) : NULL;
	if (status == GW_OK && !w.stretch)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory to write %s", output_file_name(out));
	if (status == GW_OK)
		status = write_all(&w);
	free(w.stretch);
	e57_layout_clear(&layout);
	return status;
}

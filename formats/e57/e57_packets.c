/* e57_packets.c - see e57_packets.h. */
#include "e57/e57_packets.h"

#include "e57/e57_text.h"

#include <stdlib.h>

gw_status e57_packets_begin(e57_packets *p, output_file *out, gw_error *error)
{
	/* A stretch is at most as long as a packet. */
	*p = (e57_packets){ .sink = { .out = out }, .stretch = malloc((size_t)1 << 16) };
	if (!p->stretch)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to write %s", output_file_name(out));
	return GW_OK;
}

void e57_packets_clear(e57_packets *p)
{
	free(p->stretch);
	*p = (e57_packets){ .stretch = NULL };
}

void e57_packets_header(e57_packets *p, const e57_layout *layout, size_t text_length)
{
	uint64_t length = layout->length;
	e57_sink_put(&p->sink, "ASTM-E57", 8);
	e57_sink_number(&p->sink, 1, 4);
	e57_sink_number(&p->sink, 0, 4);
	e57_sink_number(&p->sink, e57_sink_length(length + text_length), 8);
	e57_sink_number(&p->sink, e57_sink_place(length), 8);
	e57_sink_number(&p->sink, text_length, 8);
	e57_sink_number(&p->sink, E57_PAGE, 8);
}

void e57_packets_section(e57_packets *p, const e57_out_scan *s)
{
	e57_sink_number(&p->sink, 1, 8);
	e57_sink_number(&p->sink, s->length, 8);
	e57_sink_number(&p->sink, e57_sink_place(s->at + E57_SECTION_HEAD), 8);
	e57_sink_number(&p->sink, 0, 8);
}

void e57_packets_put(e57_packets *p, const e57_out_scan *s, const e57_packet *packet)
{
	size_t count = packet->count;
	size_t length = e57_layout_packet(s, count), written = e57_layout_packet_head(s);
	e57_sink_number(&p->sink, 1, 2);
	e57_sink_number(&p->sink, length - 1, 2);
	e57_sink_number(&p->sink, s->field_count, 2);
	for (size_t f = 0; f < s->field_count; f++)
		e57_sink_number(&p->sink, e57_layout_stretch(&s->field[f], count), 2);
	for (const e57_out_field *f = s->field; f < s->field + s->field_count; f++) {
		size_t size = e57_layout_stretch(f, count);
		if (packet->rows)
			e57_rows_stretch(s, f, packet->rows, count, p->stretch);
		else
			e57_records_stretch(packet->layout, s, f, packet->first, count, p->stretch);
		checksum_add(&p->sum, p->stretch, size);
		e57_sink_put(&p->sink, p->stretch, size);
		written += size;
	}
	e57_sink_number(&p->sink, 0, length - written);
}

gw_status e57_packets_end(e57_packets *p, const e57_layout *layout, size_t *length, gw_error *error)
{
	char *text;
	GW_TRY(e57_text_make(layout, checksum_value(&p->sum), &text, length, error));
	e57_sink_put(&p->sink, text, *length);
	free(text);
	return e57_sink_end(&p->sink, error);
}

/*
 * E57, written from its first byte to its last. What is said before the points of what stands
 * behind them is known before: how long the description is does not hang on its names.
 */
#include "e57/e57_format.h"
#include "e57/e57_packets.h"
#include "e57/e57_text.h"

#include <stdlib.h>

static void write_scan(e57_packets *p, const e57_layout *layout, const e57_out_scan *s)
{
	e57_packets_section(p, s);
	for (size_t first = 0; first < s->count; first += s->packet) {
		size_t rest = s->count - first;
		e57_packets_put(p, s,
						&(e57_packet){ .layout = layout,
									   .first = first,
									   .count = rest < s->packet ? rest : s->packet });
	}
}

static gw_status write_all(e57_packets *p, const e57_layout *layout, gw_error *error)
{
	char *text;
	size_t length;
	GW_TRY(e57_text_make(layout, 0, &text, &length, error));
	free(text);
	e57_packets_header(p, layout, length);
	for (size_t s = 0; s < layout->scan_count; s++)
		write_scan(p, layout, &layout->scan[s]);
	return e57_packets_end(p, layout, &length, error);
}

gw_status e57_write(output_file *out, const scan *cloud, gw_error *error)
{
	e57_layout layout;
	e57_packets p = { .stretch = NULL };
	gw_status status = e57_layout_make(cloud, output_file_name(out), &layout, error);
	if (status == GW_OK)
		status = e57_packets_begin(&p, out, error);
	if (status == GW_OK)
		status = write_all(&p, &layout, error);
	e57_packets_clear(&p);
	e57_layout_clear(&layout);
	return status;
}

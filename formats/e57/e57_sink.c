/* e57_sink.c - see e57_sink.h. */
#include "e57/e57_sink.h"

#include <string.h>

void e57_sink_seal(uint8_t page[E57_PAGE])
{
	uint32_t sum = e57_page_checksum(page);
	for (size_t b = 0; b < 4; b++)
		page[E57_CONTENT + b] = (uint8_t)(sum >> 8 * (3 - b));
}

static void write_page(e57_sink *sink)
{
	e57_sink_seal(sink->page);
	if (sink->first)
		memcpy(sink->first, sink->page, E57_PAGE);
	sink->first = NULL;
	output_file_write(sink->out, sink->page, E57_PAGE, NULL);
	sink->used = 0;
}

void e57_sink_put(e57_sink *sink, const void *bytes, size_t length)
{
	const uint8_t *from = bytes;
	while (length > 0) {
		size_t room = E57_CONTENT - sink->used, part = length < room ? length : room;
		memcpy(sink->page + sink->used, from, part);
		sink->used += part;
		from += part;
		length -= part;
		if (sink->used == E57_CONTENT)
			write_page(sink);
	}
}

void e57_sink_number(e57_sink *sink, uint64_t value, size_t size)
{
	uint8_t bytes[8];
	for (size_t b = 0; b < size; b++)
		bytes[b] = (uint8_t)(value >> 8 * b);
	e57_sink_put(sink, bytes, size);
}

gw_status e57_sink_end(e57_sink *sink, gw_error *error)
{
	if (sink->used > 0) {
		memset(sink->page + sink->used, 0, E57_CONTENT - sink->used);
		write_page(sink);
	}
	return output_file_write(sink->out, "", 0, error);
}

uint64_t e57_sink_place(uint64_t at)
{
	return at / E57_CONTENT * E57_PAGE + at % E57_CONTENT;
}

uint64_t e57_sink_length(uint64_t bytes)
{
	return (bytes + E57_CONTENT - 1) / E57_CONTENT * E57_PAGE;
}

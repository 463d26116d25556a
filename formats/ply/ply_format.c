#include "ply/ply_format.h"

#include <string.h>

static bool probe(const uint8_t *head, size_t length)
{
	return length >= 4 && memcmp(head, "ply", 3) == 0 &&
		   (head[3] == '\n' || head[3] == '\r' || head[3] == ' ' || head[3] == '\t');
}

static const char *const extensions[] = { "ply", NULL };

static const format_parted parted = {
	.write_head = ply_write_head,
	.write_rows = ply_write_rows,
};

const format ply_format = {
	.name = "ply",
	.description = "polygon file format, points only",
	.extensions = extensions,
	.probe = probe,
	.read = ply_read,
	.write = ply_write,
	.count_rows = ply_count_rows,
	.read_rows = ply_read_rows,
	.parted = &parted,
};

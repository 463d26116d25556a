#include "points/scan_bytes.h"

#include <stdlib.h>
#include <string.h>

#define TEXT_MAX (UINT64_C(1) << 24)
#define ENTRIES_MAX (UINT64_C(1) << 20)
#define POINTS_MAX (UINT64_C(1) << 31)

/* What goes before the comments, columns and scanners. */
typedef struct head {
	uint64_t count, left_out, columns, comments, scanners;
	uint32_t noise_classes;
	uint8_t up, says_up, seen, none; /* seen: which scanner saw which point follows */
} head;

static gw_status put(const gw_byte_sink *to, const void *bytes, size_t length, gw_error *error)
{
	return length > 0 ? to->write(to->user, bytes, length, error) : GW_OK;
}

static gw_status put_text(const gw_byte_sink *to, const char *text, gw_error *error)
{
	uint64_t length = strlen(text);
	GW_TRY(put(to, &length, sizeof length, error));
	return put(to, text, (size_t)length, error);
}

gw_status scan_bytes_save(const scan *cloud, const gw_byte_sink *to, gw_error *error)
{
	const head h = { .count = cloud->count,
					 .left_out = cloud->left_out,
					 .columns = cloud->column_count,
					 .comments = cloud->comment_count,
					 .scanners = cloud->scanner_count,
					 .noise_classes = cloud->noise_classes,
					 .up = (uint8_t)cloud->up,
					 .says_up = cloud->says_up,
					 .seen = cloud->scanner_of != NULL };
	GW_TRY(put(to, &h, sizeof h, error));
	for (size_t c = 0; c < cloud->comment_count; c++)
		GW_TRY(put_text(to, cloud->comment[c], error));
	for (size_t c = 0; c < cloud->column_count; c++) {
		const scan_column *column = &cloud->column[c];
		const uint64_t type = column->type;
		GW_TRY(put_text(to, column->name, error));
		GW_TRY(put(to, &type, sizeof type, error));
		GW_TRY(put(to, column->data, cloud->count * scan_type_size(column->type), error));
	}
	GW_TRY(put(to, cloud->scanner, 3 * cloud->scanner_count * sizeof *cloud->scanner, error));
	return h.seen ? put(to, cloud->scanner_of, cloud->count * sizeof *cloud->scanner_of, error)
				  : GW_OK;
}

/* ---------------------------------------------------------------------------------- from bytes */

static gw_status take(const gw_byte_source *from, void *bytes, size_t length, gw_error *error)
{
	return length > 0 ? from->read(from->user, bytes, length, error) : GW_OK;
}

/* text: for free() */
static gw_status take_text(const gw_byte_source *from, char **text, gw_error *error)
{
	uint64_t length;
	*text = NULL;
	GW_TRY(take(from, &length, sizeof length, error));
	if (length > TEXT_MAX)
		return gw_fail(error, GW_ERROR_DATA, "the points that were kept are damaged");
	char *made = calloc(1, (size_t)length + 1);
	if (!made)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a text");
	gw_status status = take(from, made, (size_t)length, error);
	if (status == GW_OK)
		*text = made;
	else
		free(made);
	return status;
}

static gw_status take_comment(const gw_byte_source *from, scan *cloud, gw_error *error)
{
	char *text;
	GW_TRY(take_text(from, &text, error));
	gw_status status = scan_add_comment(cloud, text, error);
	free(text);
	return status;
}

static gw_status take_column(const gw_byte_source *from, scan *cloud, gw_error *error)
{
	char *name;
	uint64_t type = 0;
	GW_TRY(take_text(from, &name, error));
	gw_status status = take(from, &type, sizeof type, error);
	if (status == GW_OK && type >= SCAN_TYPE_COUNT)
		status = gw_fail(error, GW_ERROR_DATA, "the points that were kept are damaged");
	if (status == GW_OK) {
		scan_column *column = scan_add_column(cloud, name, (scan_type)type, error);
		status = column
					 ? take(from, column->data, cloud->count * scan_type_size(column->type), error)
					 : GW_ERROR_MEMORY;
	}
	free(name);
	return status;
}

static gw_status take_scanners(const gw_byte_source *from, const head *h, scan *cloud,
							   gw_error *error)
{
	size_t count = (size_t)h->scanners, seen = h->seen ? cloud->count : 0;
	cloud->scanner = count > 0 ? reallocarray(NULL, count, 3 * sizeof *cloud->scanner) : NULL;
	cloud->scanner_of = seen > 0 ? reallocarray(NULL, seen, sizeof *cloud->scanner_of) : NULL;
	if ((count > 0 && !cloud->scanner) || (seen > 0 && !cloud->scanner_of))
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu scanners", count);
	cloud->scanner_count = count;
	GW_TRY(take(from, cloud->scanner, 3 * count * sizeof *cloud->scanner, error));
	return take(from, cloud->scanner_of, seen * sizeof *cloud->scanner_of, error);
}

static gw_status take_all(const gw_byte_source *from, scan *cloud, gw_error *error)
{
	head h;
	GW_TRY(take(from, &h, sizeof h, error));
	if (h.count > POINTS_MAX || h.columns > ENTRIES_MAX || h.comments > ENTRIES_MAX ||
		h.scanners > ENTRIES_MAX)
		return gw_fail(error, GW_ERROR_DATA, "the points that were kept are damaged");
	*cloud = (scan){ .count = (size_t)h.count,
					 .left_out = h.left_out,
					 .up = (char)h.up,
					 .says_up = h.says_up,
					 .noise_classes = h.noise_classes };
	for (uint64_t c = 0; c < h.comments; c++)
		GW_TRY(take_comment(from, cloud, error));
	for (uint64_t c = 0; c < h.columns; c++)
		GW_TRY(take_column(from, cloud, error));
	return take_scanners(from, &h, cloud, error);
}

gw_status scan_bytes_load(const gw_byte_source *from, scan *cloud, gw_error *error)
{
	*cloud = (scan){ 0 };
	gw_status status = take_all(from, cloud, error);
	if (status != GW_OK)
		scan_clear(cloud);
	return status;
}

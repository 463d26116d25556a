#include "points/scan.h"
#include "files/growing_table.h"
#include "points/scan_color.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ------------------------------------------------------------------------------- columns */

size_t scan_type_size(scan_type type)
{
	static const size_t size[SCAN_TYPE_COUNT] = {
		[SCAN_INT8] = 1,  [SCAN_UINT8] = 1,  [SCAN_INT16] = 2,   [SCAN_UINT16] = 2,
		[SCAN_INT32] = 4, [SCAN_UINT32] = 4, [SCAN_FLOAT32] = 4, [SCAN_FLOAT64] = 8,
	};
	assert((unsigned)type < SCAN_TYPE_COUNT);
	return size[type];
}

void scan_clear(scan *cloud)
{
	for (size_t c = 0; c < cloud->column_count; c++) {
		free(cloud->column[c].name);
		free(cloud->column[c].data);
	}
	free(cloud->column);
	for (size_t c = 0; c < cloud->comment_count; c++)
		free(cloud->comment[c]);
	free(cloud->comment);
	free(cloud->scanner);
	free(cloud->scanner_of);
	memset(cloud, 0, sizeof *cloud);
}

scan_column *scan_add_column(scan *cloud, const char *name, scan_type type, gw_error *error)
{
	if (scan_find(cloud, name)) {
		gw_fail(error, GW_ERROR_DATA, "two columns are called '%s'; rename one of them", name);
		return NULL;
	}
	scan_column *grown = growing_table_room(cloud->column, cloud->column_count, sizeof *grown);
	if (grown)
		cloud->column = grown;
	char *copy = strdup(name);
	/* One more, because no bytes may come back as NULL. */
	void *data = calloc(cloud->count ? cloud->count : 1, scan_type_size(type));
	if (!grown || !copy || !data) {
		free(copy);
		free(data);
		gw_fail(error, GW_ERROR_MEMORY, "no memory for the column '%s' of %zu points", name,
				cloud->count);
		return NULL;
	}
	scan_column *column = &cloud->column[cloud->column_count++];
	*column = (scan_column){ .name = copy, .type = type, .data = data };
	return column;
}

gw_status scan_add_comment(scan *cloud, const char *text, gw_error *error)
{
	char **grown = growing_table_room(cloud->comment, cloud->comment_count, sizeof *grown);
	if (grown)
		cloud->comment = grown;
	char *copy = strdup(text);
	if (!grown || !copy) {
		free(copy);
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a comment line");
	}
	cloud->comment[cloud->comment_count++] = copy;
	return GW_OK;
}

/* Index of the scanner at a position, which is added unless it is one of the last; SCAN_NO_SCANNER
 * when memory is short. A file may have a million, so that not all are compared. */
static uint32_t find_scanner(scan *cloud, const double position[3])
{
	size_t recent = cloud->scanner_count < 64 ? 0 : cloud->scanner_count - 64;
	for (size_t s = recent; s < cloud->scanner_count; s++)
		if (memcmp(cloud->scanner + 3 * s, position, 3 * sizeof *position) == 0)
			return (uint32_t)s;
	double *grown = growing_table_room(cloud->scanner, cloud->scanner_count, 3 * sizeof *grown);
	if (!grown || cloud->scanner_count >= SCAN_NO_SCANNER)
		return SCAN_NO_SCANNER;
	cloud->scanner = grown;
	memcpy(grown + 3 * cloud->scanner_count, position, 3 * sizeof *position);
	return (uint32_t)cloud->scanner_count++;
}

/* Makes room for which scanner saw each point: the first all of them, or none. */
static gw_status part_scanners(scan *cloud, gw_error *error)
{
	if (cloud->scanner_of)
		return GW_OK;
	uint32_t *of = reallocarray(NULL, cloud->count ? cloud->count : 1, sizeof *of);
	if (!of)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the scanners of %zu points",
					   cloud->count);
	for (size_t i = 0; i < cloud->count; i++)
		of[i] = cloud->scanner_count ? 0 : SCAN_NO_SCANNER;
	cloud->scanner_of = of;
	return GW_OK;
}

gw_status scan_add_scanner(scan *cloud, const double position[3], size_t first, size_t count,
						   gw_error *error)
{
	bool all = count == cloud->count;
	if (!all) {
		gw_status status = part_scanners(cloud, error);
		if (status != GW_OK)
			return status;
	}
	uint32_t scanner = find_scanner(cloud, position);
	if (scanner == SCAN_NO_SCANNER)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for another scanner");
	for (size_t i = first; i < first + count && cloud->scanner_of; i++)
		cloud->scanner_of[i] = scanner;
	return GW_OK;
}

scan_column *scan_find(const scan *cloud, const char *name)
{
	for (size_t c = 0; c < cloud->column_count; c++)
		if (strcmp(cloud->column[c].name, name) == 0)
			return &cloud->column[c];
	return NULL;
}

void scan_remove_column(scan *cloud, const char *name)
{
	scan_column *column = scan_find(cloud, name);
	if (!column)
		return;
	free(column->name);
	free(column->data);
	size_t behind = cloud->column_count - (size_t)(column - cloud->column) - 1;
	memmove(column, column + 1, behind * sizeof *column);
	cloud->column_count--;
}

double scan_value(const scan_column *column, size_t i)
{
	switch (column->type) {
	case SCAN_INT8:
		return ((const int8_t *)column->data)[i];
	case SCAN_UINT8:
		return ((const uint8_t *)column->data)[i];
	case SCAN_INT16:
		return ((const int16_t *)column->data)[i];
	case SCAN_UINT16:
		return ((const uint16_t *)column->data)[i];
	case SCAN_INT32:
		return ((const int32_t *)column->data)[i];
	case SCAN_UINT32:
		return ((const uint32_t *)column->data)[i];
	case SCAN_FLOAT32:
		return (double)((const float *)column->data)[i];
	case SCAN_FLOAT64:
		return ((const double *)column->data)[i];
	case SCAN_TYPE_COUNT:
		break;
	}
	return 0.0;
}

void scan_store(scan_column *column, size_t i, double value)
{
	switch (column->type) {
	case SCAN_INT8:
		((int8_t *)column->data)[i] = (int8_t)value;
		break;
	case SCAN_UINT8:
		((uint8_t *)column->data)[i] = (uint8_t)value;
		break;
	case SCAN_INT16:
		((int16_t *)column->data)[i] = (int16_t)value;
		break;
	case SCAN_UINT16:
		((uint16_t *)column->data)[i] = (uint16_t)value;
		break;
	case SCAN_INT32:
		((int32_t *)column->data)[i] = (int32_t)value;
		break;
	case SCAN_UINT32:
		((uint32_t *)column->data)[i] = (uint32_t)value;
		break;
	case SCAN_FLOAT32:
		((float *)column->data)[i] = (float)value;
		break;
	case SCAN_FLOAT64:
		((double *)column->data)[i] = value;
		break;
	case SCAN_TYPE_COUNT:
		break;
	}
}

/* ------------------------------------------------------------------------------ appending */

static bool is_float(scan_type type)
{
	return type == SCAN_FLOAT32 || type == SCAN_FLOAT64;
}

static bool is_signed(scan_type type)
{
	return type == SCAN_INT8 || type == SCAN_INT16 || type == SCAN_INT32;
}

/* The smallest type that holds every value of both. */
static scan_type widen(scan_type a, scan_type b)
{
	if (a == b)
		return a;
	if (is_float(a) || is_float(b)) {
		size_t other = scan_type_size(is_float(a) ? b : a);
		bool single = a != SCAN_FLOAT64 && b != SCAN_FLOAT64 && other <= 2;
		return single ? SCAN_FLOAT32 : SCAN_FLOAT64;
	}
	size_t size_a = scan_type_size(a), size_b = scan_type_size(b);
	size_t size = size_a > size_b ? size_a : size_b;
	if (is_signed(a) == is_signed(b))
		return size_a > size_b ? a : b;
	/* One is signed: it must be larger than the unsigned one. */
	size_t unsigned_size = is_signed(a) ? size_b : size_a;
	if (unsigned_size == size)
		size *= 2;
	return size == 2 ? SCAN_INT16 : size == 4 ? SCAN_INT32 : SCAN_FLOAT64;
}

/* Copies the values of one column into another of the same or a wider type, from point `first`. */
static void copy_values(scan_column *to, size_t first, const scan_column *from, size_t count)
{
	if (to->type == from->type) {
		size_t size = scan_type_size(to->type);
		memcpy((char *)to->data + first * size, from->data, count * size);
		return;
	}
	for (size_t i = 0; i < count; i++)
		scan_store(to, first + i, scan_value(from, i));
}

/* Colours of two scans may count to different numbers; joined they must count to one. */
typedef struct color_match {
	const char *const *name; /* three of them */
	bool differ;             /* both scans have these colours, and they count differently */
	scan_color head, tail;
	scan_type type; /* of the joined columns: uint16 to 65535 or float to 1 */
} color_match;

static color_match match_colors(const scan *head, const scan *tail, const char *const name[3])
{
	color_match match = { .name = name, .type = SCAN_UINT16 };
	match.differ = scan_color_find(head, name, &match.head) &&
				   scan_color_find(tail, name, &match.tail) && match.head.range != match.tail.range;
	for (int k = 0; k < 3 && match.differ; k++)
		if (is_float(match.head.column[k]->type) || is_float(match.tail.column[k]->type))
			match.type = SCAN_FLOAT32;
	return match;
}

/* Stores channel k of some colours from point `first` on. */
static void put_colors(scan_column *to, size_t first, const scan_color *color, int k, size_t count)
{
	for (size_t i = 0; i < count; i++) {
		double value = scan_color_value(color, k, i);
		if (to->type == SCAN_FLOAT32)
			scan_store(to, first + i, value);
		else
			scan_store(to, first + i, value > 0.0 ? fmin(value, 1.0) * 65535.0 + 0.5 : 0.0);
	}
}

/* Two scans on their way to one. */
typedef struct join {
	const scan *head, *tail;
	color_match match[2]; /* of red green blue, and of albedo_* */
	scan *joined;
} join;

/* The match that a column takes part in, and as which channel; NULL when it is joined as it is. */
static const color_match *find_match(const join *j, const char *name, int *channel)
{
	for (int m = 0; m < 2; m++) {
		for (int k = 0; k < 3; k++) {
			*channel = k;
			if (j->match[m].differ && strcmp(j->match[m].name[k], name) == 0)
				return &j->match[m];
		}
	}
	return NULL;
}

/* Adds to the joined scan the column that both scans have under this name, or one of them has. */
static gw_status join_column(const join *j, const char *name, gw_error *error)
{
	int channel;
	const scan_column *a = scan_find(j->head, name), *b = scan_find(j->tail, name);
	const color_match *match = a && b ? find_match(j, name, &channel) : NULL;
	scan_type type = a && b ? widen(a->type, b->type) : a ? a->type : b->type;
	scan_column *to = scan_add_column(j->joined, name, match ? match->type : type, error);
	if (!to)
		return GW_ERROR_MEMORY;
	if (match) {
		put_colors(to, 0, &match->head, channel, j->head->count);
		put_colors(to, j->head->count, &match->tail, channel, j->tail->count);
		return GW_OK;
	}
	if (a)
		copy_values(to, 0, a, j->head->count);
	if (b)
		copy_values(to, j->head->count, b, j->tail->count);
	return GW_OK;
}

static gw_status join_columns(scan *joined, const scan *head, const scan *tail, gw_error *error)
{
	join j = { .head = head, .tail = tail, .joined = joined };
	j.match[0] = match_colors(head, tail, scan_color_names);
	j.match[1] = match_colors(head, tail, scan_albedo_names);
	gw_status status = GW_OK;
	for (size_t c = 0; c < head->column_count && status == GW_OK; c++)
		status = join_column(&j, head->column[c].name, error);
	for (size_t c = 0; c < tail->column_count && status == GW_OK; c++)
		if (!scan_find(head, tail->column[c].name))
			status = join_column(&j, tail->column[c].name, error);
	for (size_t c = 0; c < head->comment_count && status == GW_OK; c++)
		status = scan_add_comment(joined, head->comment[c], error);
	for (size_t c = 0; c < tail->comment_count && status == GW_OK; c++)
		status = scan_add_comment(joined, tail->comment[c], error);
	return status;
}

/* Adds a part's scanners to the scan that it is joined to, where its points are from `first` on. */
static gw_status join_scanners(scan *joined, const scan *part, size_t first, gw_error *error)
{
	if (part->scanner_count == 0)
		return GW_OK;
	if (!part->scanner_of)
		return scan_add_scanner(joined, part->scanner, first, part->count, error);
	uint32_t *index = reallocarray(NULL, part->scanner_count, sizeof *index);
	gw_status status = part_scanners(joined, error);
	bool found = index && status == GW_OK;
	for (size_t s = 0; s < part->scanner_count && found; s++) {
		index[s] = find_scanner(joined, part->scanner + 3 * s);
		found = index[s] != SCAN_NO_SCANNER;
	}
	for (size_t i = 0; i < part->count && found; i++)
		if (part->scanner_of[i] < part->scanner_count)
			joined->scanner_of[first + i] = index[part->scanner_of[i]];
	free(index);
	return found ? GW_OK : gw_fail(error, GW_ERROR_MEMORY, "no memory for the scanners");
}

gw_status scan_append(scan *cloud, const scan *tail, gw_error *error)
{
	scan joined = { .up = cloud->column_count ? cloud->up : tail->up };
	if (__builtin_add_overflow(cloud->count, tail->count, &joined.count))
		return gw_fail(error, GW_ERROR_MEMORY, "%zu and %zu points are too many for one scene",
					   cloud->count, tail->count);
	joined.left_out = cloud->left_out + tail->left_out;
	gw_status status = join_columns(&joined, cloud, tail, error);
	if (status == GW_OK)
		status = join_scanners(&joined, cloud, 0, error);
	if (status == GW_OK)
		status = join_scanners(&joined, tail, cloud->count, error);
	if (status != GW_OK) {
		scan_clear(&joined);
		return status;
	}
	scan_clear(cloud);
	*cloud = joined;
	return GW_OK;
}

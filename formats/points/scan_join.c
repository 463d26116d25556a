/* scan_join.c - see scan_join.h. */
#include "points/scan_join.h"
#include "points/scan_color.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool is_float(scan_type type)
{
	return type == SCAN_FLOAT32 || type == SCAN_FLOAT64;
}

static bool is_signed(scan_type type)
{
	return type == SCAN_INT8 || type == SCAN_INT16 || type == SCAN_INT32;
}

scan_type scan_type_widen(scan_type a, scan_type b)
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
	scan_type type = a && b ? scan_type_widen(a->type, b->type) : a ? a->type : b->type;
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
	for (size_t c = 0; c < head->column_count; c++)
		GW_TRY(join_column(&j, head->column[c].name, error));
	for (size_t c = 0; c < tail->column_count; c++)
		if (!scan_find(head, tail->column[c].name))
			GW_TRY(join_column(&j, tail->column[c].name, error));
	for (size_t c = 0; c < head->comment_count; c++)
		GW_TRY(scan_add_comment(joined, head->comment[c], error));
	for (size_t c = 0; c < tail->comment_count; c++)
		GW_TRY(scan_add_comment(joined, tail->comment[c], error));
	return GW_OK;
}

/* Adds a part's scanners to the scan that it is joined to, where its points are from `first` on. */
static gw_status join_scanners(scan *joined, const scan *part, size_t first, gw_error *error)
{
	if (part->scanner_count == 0)
		return GW_OK;
	if (!part->scanner_of)
		return scan_add_scanner(joined, part->scanner, first, part->count, error);
	uint32_t *index = reallocarray(NULL, part->scanner_count, sizeof *index);
	gw_status status = scan_part_scanners(joined, error);
	bool found = index && status == GW_OK;
	for (size_t s = 0; s < part->scanner_count && found; s++) {
		index[s] = scan_scanner_at(joined, part->scanner + 3 * s);
		found = index[s] != SCAN_NO_SCANNER;
	}
	for (size_t i = 0; i < part->count && found; i++)
		if (part->scanner_of[i] < part->scanner_count)
			joined->scanner_of[first + i] = index[part->scanner_of[i]];
	free(index);
	return found ? GW_OK : gw_fail(error, GW_ERROR_MEMORY, "no memory for the scanners");
}

/* The same with its range images. */
static gw_status join_images(scan *joined, const scan *part, size_t first, gw_error *error)
{
	for (size_t i = 0; i < part->image_count; i++) {
		gw_range_image image = part->image[i];
		image.first += first;
		GW_TRY(scan_add_image(joined, &image, error));
	}
	if (part->image_cell)
		memcpy(joined->image_cell + first, part->image_cell,
			   part->count * sizeof *part->image_cell);
	return GW_OK;
}

static gw_status join_all(scan *joined, const scan *cloud, const scan *tail, gw_error *error)
{
	GW_TRY(join_columns(joined, cloud, tail, error));
	GW_TRY(join_scanners(joined, cloud, 0, error));
	GW_TRY(join_scanners(joined, tail, cloud->count, error));
	GW_TRY(join_images(joined, cloud, 0, error));
	return join_images(joined, tail, cloud->count, error);
}

gw_status scan_append(scan *cloud, const scan *tail, gw_error *error)
{
	scan joined = { .up = cloud->column_count ? cloud->up : tail->up };
	if (__builtin_add_overflow(cloud->count, tail->count, &joined.count))
		return gw_fail(error, GW_ERROR_MEMORY, "%zu and %zu points are too many for one scene",
					   cloud->count, tail->count);
	joined.left_out = cloud->left_out + tail->left_out;
	gw_status status = join_all(&joined, cloud, tail, error);
	if (status != GW_OK) {
		scan_clear(&joined);
		return status;
	}
	scan_clear(cloud);
	*cloud = joined;
	return GW_OK;
}

gw_status scan_copy(const scan *from, scan *copy, gw_error *error)
{
	*copy = (scan){ 0 };
	GW_TRY(scan_append(copy, from, error));
	copy->says_up = from->says_up;
	copy->noise_classes = from->noise_classes;
	return GW_OK;
}

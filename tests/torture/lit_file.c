#include "lit_file.h"
#include "torture_child.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define COLUMN_MAXIMUM 64

typedef struct column {
	char type[16], name[64];
	size_t size, offset;
} column;

static size_t type_size(const char *type)
{
	static const struct {
		const char *name;
		size_t size;
	} table[] = { { "char", 1 }, { "uchar", 1 }, { "short", 2 }, { "ushort", 2 },
				  { "int", 4 },  { "uint", 4 },  { "float", 4 }, { "double", 8 } };
	for (size_t i = 0; i < sizeof table / sizeof *table; i++)
		if (strcmp(table[i].name, type) == 0)
			return table[i].size;
	return 0;
}

static double number_at(const unsigned char *at, const char *type)
{
	double d;
	float f;
	uint32_t bits = 0;
	if (strcmp(type, "double") == 0)
		return memcpy(&d, at, 8), d;
	if (strcmp(type, "float") == 0)
		return memcpy(&f, at, 4), (double)f;
	memcpy(&bits, at, type_size(type));
	return (double)bits; /* only whether it is finite matters */
}

/* Reads the header's columns; the length of the header, or 0. */
static size_t read_header(const char *text, size_t *count, column *columns, size_t *column_count,
						  size_t *stride)
{
	const char *end = strstr(text, "end_header\n");
	*column_count = *stride = *count = 0;
	for (const char *line = text; end && line < end; line = strchr(line, '\n') + 1) {
		column *k = &columns[*column_count];
		if (sscanf(line, "element vertex %zu", count) == 1)
			continue;
		if (sscanf(line, "property %15s %63s", k->type, k->name) != 2)
			continue;
		k->size = type_size(k->type);
		k->offset = *stride;
		*stride += k->size;
		if (k->size == 0 || ++*column_count == COLUMN_MAXIMUM)
			return 0;
	}
	return end ? (size_t)(end - text) + strlen("end_header\n") : 0;
}

static const column *find_column(const column *columns, size_t count, const char *name)
{
	for (size_t k = 0; k < count; k++)
		if (strcmp(columns[k].name, name) == 0)
			return &columns[k];
	return NULL;
}

static void *take(size_t count)
{
	double *memory = calloc(count ? count : 1, sizeof *memory);
	if (!memory)
		exit(71);
	return memory;
}

static void fill(lit_file *lit, const unsigned char *rows, size_t stride, const column *columns)
{
	static const char *const wanted[] = {
		"x", "y", "z", "scalar_radiance_r", "scalar_radiance_g", "scalar_radiance_b"
	};
	for (int w = 0; w < 6; w++) {
		const column *k = find_column(columns, lit->columns, wanted[w]);
		double *to = w < 3 ? lit->at + w : lit->radiance + w - 3;
		for (size_t i = 0; k && i < lit->count; i++)
			to[3 * i] = number_at(rows + i * stride + k->offset, k->type);
	}
	for (size_t i = 0; i < lit->count; i++)
		for (size_t k = 0; k < lit->columns; k++)
			lit->value[i * lit->columns + k] =
				number_at(rows + i * stride + columns[k].offset, columns[k].type);
}

bool lit_file_read(torture_case *c, const char *row, const char *name, lit_file *lit)
{
	column columns[COLUMN_MAXIMUM];
	size_t length, stride;
	char class_name[200];
	*lit = (lit_file){ 0 };
	unsigned char *bytes = child_read_file(c, name, &length);
	size_t begin =
		bytes ? read_header((char *)bytes, &lit->count, columns, &lit->columns, &stride) : 0;
	bool whole = begin > 0 && find_column(columns, lit->columns, "scalar_radiance_g") &&
				 length == begin + lit->count * stride;
	if (whole) {
		lit->at = take(3 * lit->count);
		lit->radiance = take(3 * lit->count);
		lit->value = take(lit->columns * lit->count);
		fill(lit, bytes + begin, stride, columns);
	} else {
		snprintf(class_name, sizeof class_name, "%s/output", row);
		case_fail(c, class_name, "%s is %s", name,
				  bytes ? "not a whole file of lit points" : "not there");
	}
	free(bytes);
	return whole;
}

void lit_file_clear(lit_file *lit)
{
	free(lit->at);
	free(lit->radiance);
	free(lit->value);
	*lit = (lit_file){ 0 };
}

double lit_file_mean(const lit_file *lit, size_t first, size_t end)
{
	double sum = 0;
	for (size_t i = first; i < end; i++)
		sum += lit->radiance[3 * i + 1];
	return sum / (double)(end - first);
}

static double member(const json_t *root, const char *object, const char *name)
{
	const json_t *value = json_object_get(object ? json_object_get(root, object) : root, name);
	return json_is_number(value) ? json_number_value(value) : (double)NAN;
}

bool lit_report_read(torture_case *c, const char *row, const char *name, lit_report *report)
{
	json_error_t error;
	char class_name[200];
	json_t *root = json_load_file(case_path(c, name), 0, &error);
	*report = (lit_report){ 0 };
	if (!root) {
		snprintf(class_name, sizeof class_name, "%s/report", row);
		case_fail(c, class_name, "%s: %s", name, error.text);
		return false;
	}
	const json_t *bounces = json_object_get(root, "bounces");
	for (size_t i = 0; i < json_array_size(bounces) && i < REPORT_BOUNCES; i++) {
		const json_t *bounce = json_array_get(bounces, i);
		report->energy[i] = member(bounce, NULL, "energy");
		report->carriers[i] = member(bounce, NULL, "carriers");
		report->largest[i] = member(bounce, NULL, "largest_irradiance");
		report->bounces = i + 1;
	}
	report->records = member(root, NULL, "records");
	report->error = member(root, "error", "relative_rms");
	report->spread = member(root, "error", "spread");
	report->remaining = member(root, NULL, "remaining");
	report->depth = member(root, "octree", "depth");
	report->leaf_size = member(root, "octree", "leaf_size");
	report->spacing = member(root, NULL, "spacing");
	report->left_out = member(json_array_get(json_object_get(root, "inputs"), 0), NULL, "left_out");
	json_decref(root);
	return true;
}

#include "verbs/verbs.h"
#include "program/json_writer.h"
#include "program/text_quote.h"
#include "points/scan_origin.h"
#include "points/scan_rows.h"
#include "scene/floor_places.h"
#include "scene/loaded_scene.h"
#include "table/format_table.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What is known of one column. */
typedef struct column_range {
	double minimum, maximum;
	uint64_t bad; /* not finite */
} column_range;

/* All that is said of one file. */
typedef struct facts {
	const char *name;
	const format *format;
	const scan *cloud;
	const scan_points *points;
	const coordinates *place; /* from the coordinates to metres, as the statistics are */
	gw_statistics statistics;
	double albedo[3];     /* mean, linear */
	double normal_length; /* mean of the given ones */
	char up;              /* as scan_up has it, and whether y may be meant */
	bool up_doubtful;
	bool up_said; /* by the user */
} facts;

static const char *type_name(scan_type type)
{
	static const char *const name[SCAN_TYPE_COUNT] = {
		[SCAN_INT8] = "int8",       [SCAN_UINT8] = "uint8",     [SCAN_INT16] = "int16",
		[SCAN_UINT16] = "uint16",   [SCAN_INT32] = "int32",     [SCAN_UINT32] = "uint32",
		[SCAN_FLOAT32] = "float32", [SCAN_FLOAT64] = "float64",
	};
	return name[type];
}

static column_range find_range(const scan_column *column, size_t count)
{
	column_range range = { INFINITY, -INFINITY, 0 };
	for (size_t i = 0; i < count; i++) {
		double value = scan_value(column, i);
		if (!isfinite(value)) {
			range.bad++;
			continue;
		}
		range.minimum = fmin(range.minimum, value);
		range.maximum = fmax(range.maximum, value);
	}
	return range;
}

static void find_means(facts *f)
{
	const scan_points *p = f->points;
	uint64_t normals = 0;
	for (size_t i = 0; i < f->cloud->count; i++) {
		double length = 0.0;
		for (size_t k = 0; k < 3; k++) {
			f->albedo[k] += (double)p->albedo[3 * i + k] / (double)f->cloud->count;
			double n = p->normal ? (double)p->normal[3 * i + k] : 0.0;
			length += n * n;
		}
		if (length > 0.0 && isfinite(length)) {
			f->normal_length += sqrt(length);
			normals++;
		}
	}
	if (normals)
		f->normal_length /= (double)normals;
}

/* ---------------------------------------------------------------------------------- JSON */

static void write_fields(json_writer *json, const facts *f)
{
	json_put_open(json, "fields", '[');
	for (size_t c = 0; c < f->cloud->column_count; c++) {
		const scan_column *column = &f->cloud->column[c];
		column_range range = find_range(column, f->cloud->count);
		json_put_open(json, NULL, '{');
		json_put_text(json, "name", column->name);
		json_put_text(json, "type", type_name(column->type));
		json_put_real(json, "minimum", range.minimum);
		json_put_real(json, "maximum", range.maximum);
		json_put_count(json, "not_finite", range.bad);
		json_put_close(json, '}');
	}
	json_put_close(json, ']');
}

static void write_strays(json_writer *json, const facts *f)
{
	json_put_open(json, "strays", '[');
	for (int kind = 0; kind < GW_STRAY_KIND_COUNT; kind++) {
		const gw_stray_count *stray = &f->statistics.stray[kind];
		if (stray->points == 0)
			continue;
		json_put_open_flat(json, NULL, '{');
		json_put_text(json, "kind", gw_stray_kind_name((gw_stray_kind)kind));
		json_put_count(json, "points", stray->points);
		json_put_reals(json, "position", stray->position, 3);
		json_put_close(json, '}');
	}
	json_put_close(json, ']');
}

static void print_json(const facts *f)
{
	const gw_statistics *s = &f->statistics;
	json_writer json = { .out = stdout };
	json_put_open(&json, NULL, '{');
	json_put_text(&json, "file", f->name);
	json_put_text(&json, "format", f->format->name);
	json_put_count(&json, "points", s->points);
	json_put_count(&json, "finite", s->finite);
	json_put_count(&json, "duplicates", s->duplicates);
	json_put_count(&json, "left_out", f->cloud->left_out);
	write_strays(&json, f);
	json_put_text(&json, "up", settings_up_name(f->up));
	json_put_text(&json, "units", f->place->name);
	json_put_reals(&json, "minimum", s->minimum, 3);
	json_put_reals(&json, "maximum", s->maximum, 3);
	json_put_reals(&json, "spacing", s->spacing, 3);
	json_put_real(&json, "density", s->density);
	json_put_count(&json, "normals_given", s->normals_given);
	json_put_count(&json, "normals_bad", s->normals_bad);
	json_put_real(&json, "normals_length", f->normal_length);
	json_put_reals(&json, "albedo", f->albedo, 3);
	json_put_text(&json, "albedo_source", f->points->albedo_source);
	json_put_count(&json, "depth", s->depth);
	json_put_count(&json, "memory", s->memory);
	json_put_open(&json, "scanners", '[');
	for (size_t i = 0; i < f->cloud->scanner_count; i++)
		json_put_reals(&json, NULL, f->cloud->scanner + 3 * i, 3);
	json_put_close(&json, ']');
	write_fields(&json, f);
	json_put_open(&json, "comments", '[');
	for (size_t c = 0; c < f->cloud->comment_count; c++)
		json_put_text(&json, NULL, f->cloud->comment[c]);
	json_put_close(&json, ']');
	json_put_close(&json, '}');
	putchar('\n');
}

/* ------------------------------------------------------------------------------------ text */

static void print_columns(const facts *f)
{
	printf("  %-24s %-8s %14s %14s %s\n", "field", "type", "minimum", "maximum", "not finite");
	for (size_t c = 0; c < f->cloud->column_count; c++) {
		const scan_column *column = &f->cloud->column[c];
		column_range range = find_range(column, f->cloud->count);
		text_message(stdout, "  %-24s %-8s ", column->name, type_name(column->type));
		if (range.bad < f->cloud->count)
			printf("%14.12g %14.12g %" PRIu64 "\n", range.minimum, range.maximum, range.bad);
		else
			printf("%14s %14s %" PRIu64 "\n", "-", "-", range.bad);
	}
}

/* Points of no surface, of each kind with one of them. */
static void print_strays(const gw_stray_count *stray)
{
	const char *before = "  strays    ";
	for (int kind = 0; kind < GW_STRAY_KIND_COUNT; kind++) {
		const double *at = stray[kind].position;
		if (stray[kind].points == 0)
			continue;
		printf("%s %" PRIu64 " %s, as at %.9g %.9g %.9g", before, stray[kind].points,
			   gw_stray_kind_name((gw_stray_kind)kind), at[0], at[1], at[2]);
		before = ";";
	}
	if (*before == ';')
		printf("; bakes make no surface of them\n");
}

static void print_text(const facts *f)
{
	const gw_statistics *s = &f->statistics;
	text_message(stdout, "%s\n", f->name);
	printf("  format     %s, %s up%s\n", f->format->name, settings_up_name(f->up),
		   f->up_said              ? ""
		   : f->up != f->cloud->up ? ", by how its points lie"
		   : f->up_doubtful        ? ", though y looks like it"
								   : "");
	printf("  points     %" PRIu64 ", of which %" PRIu64 " are not finite and %" PRIu64
		   " stand where another one does\n",
		   s->points, s->points - s->finite, s->duplicates);
	print_strays(s->stray);
	if (f->cloud->left_out)
		printf("  left out   %" PRIu64 " rows without a point\n", f->cloud->left_out);
	for (size_t i = 0; i < f->cloud->scanner_count; i++) {
		const double *at = f->cloud->scanner + 3 * i;
		printf("  %-10s at %.12g %.12g %.12g\n", i ? "" : "scanner", at[0], at[1], at[2]);
	}
	for (int k = 0; k < 3 && s->finite; k++)
		printf("  %-10s %.12g to %.12g m\n", k ? "" : "bounds", s->minimum[k], s->maximum[k]);
	if (f->place->changes)
		printf("  units      coordinates are %s; all here is in metres\n", f->place->name);
	printf("  spacing    %.4g m (5th percentile %.4g, 95th %.4g)\n", s->spacing[1], s->spacing[0],
		   s->spacing[2]);
	printf("  density    %.4g points/m^2\n", s->density);
	if (f->points->normal)
		printf("  normals    %" PRIu64 " given, of mean length %.4g; %" PRIu64 " bad\n",
			   s->normals_given, f->normal_length, s->normals_bad);
	else
		printf("  normals    none; they would be estimated\n");
	text_message(stdout, "  albedo     mean %.3g %.3g %.3g, from %s\n", f->albedo[0], f->albedo[1],
				 f->albedo[2], f->points->albedo_source);
	for (size_t c = 0; c < f->cloud->comment_count; c++)
		if (strncmp(f->cloud->comment[c], SCAN_NOTE, strlen(SCAN_NOTE)) == 0)
			text_message(stdout, "  note       %s\n", f->cloud->comment[c] + strlen(SCAN_NOTE));
	printf("  bake       depth %" PRIu32 ", about %.2f GB\n", s->depth, (double)s->memory * 1e-9);
	print_columns(f);
}

/* Which axis is up: as the user says, else the file, else how its points lie. */
static void find_up(const settings *s, facts *f, const double *position)
{
	f->up_said = s->up != SETTINGS_UP_AUTO;
	if (f->up_said)
		f->up = settings_up_axis(s->up);
	else
		f->up = scan_up(f->cloud, position, f->format->custom_up, &f->up_doubtful);
	if (s->places && f->up_doubtful)
		text_message(stderr,
					 "glowworm: note: %s: nothing says which axis points up, and z is taken; the "
					 "points lie as if it were y: if it is, say --up y, also to bake and render\n",
					 f->name);
}

/* ---------------------------------------------------------------------------------- places */

static void print_place(const settings *s, json_writer *json, const char *kind, size_t number,
						const double at[3])
{
	char name[64];
	snprintf(name, sizeof name, "%s:%zu", kind, number);
	if (!s->json) {
		printf("  %-12s %.12g %.12g %.12g\n", name, at[0], at[1], at[2]);
		return;
	}
	json_put_open_flat(json, NULL, '{');
	json_put_text(json, "name", name);
	json_put_reals(json, "position", at, 3);
	json_put_close(json, '}');
}

/* Scanners, and floor where somebody can stand, in the file's coordinates. */
static gw_status list_places(const settings *s, facts *f, const double *position, gw_error *error)
{
	double floor_at[3 * FLOOR_PLACES_MAX];
	size_t floors;
	json_writer json = { .out = stdout };
	GW_TRY(floor_places_find(position, f->cloud->count, f->up, floor_at, &floors, error));
	if (s->json) {
		json_put_open(&json, NULL, '{');
		json_put_text(&json, "file", f->name);
		json_put_open(&json, "places", '[');
	} else {
		text_message(stdout, "%s\n", f->name);
	}
	for (size_t i = 0; i < f->cloud->scanner_count; i++)
		print_place(s, &json, "scanner", i + 1, f->cloud->scanner + 3 * i);
	for (size_t i = 0; i < floors; i++) {
		coordinates_from_metres(f->place, floor_at + 3 * i);
		print_place(s, &json, "floor", i + 1, floor_at + 3 * i);
	}
	if (s->json) {
		json_put_close(&json, ']');
		json_put_close(&json, '}');
		putchar('\n');
	} else if (f->cloud->scanner_count + floors == 0) {
		printf("  none: no scanner is known, and no floor is free to %g m\n", FLOOR_HEAD);
	}
	return GW_OK;
}

/* --------------------------------------------------------------------------------- the verb */

static gw_status describe(const settings *s, facts *f, gw_error *error)
{
	gw_error reason = { 0 };
	scan_points points;
	gw_status status = scan_points_make(f->cloud, &s->points, &points, &reason);
	if (status == GW_OK) {
		find_up(s, f, points.position);
		for (size_t i = 0; i < f->cloud->count && f->place->changes; i++)
			coordinates_to_metres(f->place, points.position + 3 * i);
		if (s->places)
			status = list_places(s, f, points.position, &reason);
		else
			status = gw_measure(&points.points, s->bake.threads, &f->statistics, &reason);
		f->points = &points;
		if (!s->places)
			find_means(f);
	}
	if (status != GW_OK)
		gw_fail(error, status, "%s: %.900s", f->name, reason.text);
	else if (s->json && !s->places)
		print_json(f);
	else if (!s->places)
		print_text(f);
	f->points = NULL;
	scan_points_clear(&points);
	return status;
}

static gw_status describe_file(const settings *s, const char *path, gw_error *error)
{
	scan cloud = { 0 };
	facts f = { .name = loaded_scene_input_name(path), .cloud = &cloud };
	format_options options = { s->format, s->columns, s->bake.threads };
	gw_status status = format_read_with(path, &options, &cloud, &f.format, error);
	if (status == GW_OK)
		status = scan_find_rows(&cloud, false, error);
	if (status == GW_OK)
		status = scan_find_origin(&cloud, error);
	coordinates place = coordinates_metres();
	gw_error reason = { 0 };
	f.place = &place;
	if (status == GW_OK) {
		status = coordinates_find(&cloud, (coordinates_unit)s->length, &place, &reason);
		if (status != GW_OK)
			gw_fail(error, status, "%s: %.900s", f.name, reason.text);
	}
	if (status == GW_OK)
		status = describe(s, &f, error);
	coordinates_clear(&place);
	scan_clear(&cloud);
	return status;
}

static void print_device(const gw_device_info *d, size_t index, bool as_json)
{
	if (!as_json) {
		printf("%zu  %s (%s), %.1f GB, %s%s%s\n", index, d->name, d->type, (double)d->memory * 1e-9,
			   d->driver, d->usable ? "" : "; not usable: ", d->usable ? "" : d->missing);
		return;
	}
	json_writer json = { .out = stdout };
	json_put_open(&json, NULL, '{');
	json_put_count(&json, "index", index);
	json_put_text(&json, "name", d->name);
	json_put_text(&json, "type", d->type);
	json_put_text(&json, "driver", d->driver);
	json_put_count(&json, "memory", d->memory);
	json_put_count(&json, "subgroup_size", d->subgroup_size);
	json_put_bool(&json, "usable", d->usable);
	if (!d->usable)
		json_put_text(&json, "missing", d->missing);
	json_put_close(&json, '}');
	putchar('\n');
}

static gw_status list_devices(const settings *s, gw_error *error)
{
	gw_device_info *device;
	size_t count;
	GW_TRY(gw_devices(&device, &count, error));
	for (size_t i = 0; i < count; i++)
		print_device(&device[i], i, s->json);
	free(device);
	if (count == 0)
		return gw_fail(error, GW_ERROR_NO_DEVICE,
					   "there is no Vulkan device; the package mesa-vulkan-drivers has one that "
					   "runs on any processor");
	return GW_OK;
}

gw_status verb_info(const settings *s, gw_error *error)
{
	if (s->devices && (s->input_count > 0 || s->places))
		return gw_fail(error, GW_ERROR_USAGE, "--devices takes no files and lists no places");
	if (s->devices)
		return list_devices(s, error);
	if (s->input_count == 0)
		return gw_fail(error, GW_ERROR_USAGE,
					   "describe what? Name files, - for standard input, or --devices");
	for (size_t i = 0; i < s->input_count; i++)
		GW_TRY(describe_file(s, s->input[i].path, error));
	return GW_OK;
}

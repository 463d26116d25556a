/*
 * info_print.c - what is known of a file as text and as JSON, see info_facts.h.
 */
#include "verbs/info_facts.h"
#include "glowworm_host.h"
#include "program/json_writer.h"
#include "program/text_quote.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

static const char *type_name(scan_type type)
{
	static const char *const name[SCAN_TYPE_COUNT] = {
		[SCAN_INT8] = "int8",       [SCAN_UINT8] = "uint8",     [SCAN_INT16] = "int16",
		[SCAN_UINT16] = "uint16",   [SCAN_INT32] = "int32",     [SCAN_UINT32] = "uint32",
		[SCAN_FLOAT32] = "float32", [SCAN_FLOAT64] = "float64",
	};
	return name[type];
}

/* ---------------------------------------------------------------------------------- JSON */

static void write_fields(json_writer *json, const info_facts *f)
{
	json_put_open(json, "fields", '[');
	for (size_t c = 0; c < f->cloud.column_count; c++) {
		const scan_column *column = &f->cloud.column[c];
		const column_range range = f->range[c];
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

static void write_strays(json_writer *json, const info_facts *f)
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

/* What a lit file says of its light, by its keys. */
static void write_lit(json_writer *json, const lit_notes *lit)
{
	json_put_open(json, "light", '{');
	for (size_t i = 0; i < lit->count; i++) {
		bool first = i == 0 || strcmp(lit->note[i].key, lit->note[i - 1].key) != 0;
		if (first && i > 0)
			json_put_close(json, ']');
		if (first)
			json_put_open(json, lit->note[i].key, '[');
		json_put_text(json, NULL, lit->note[i].text);
	}
	if (lit->count > 0)
		json_put_close(json, ']');
	json_put_close(json, '}');
}

/* What was measured where --stats asked for it. */
static void write_measures(json_writer *json, const info_facts *f)
{
	const gw_statistics *s = &f->statistics;
	json_put_count(json, "finite", s->finite);
	json_put_count(json, "duplicates", s->duplicates);
	write_strays(json, f);
	json_put_reals(json, "spacing", s->spacing, 3);
	json_put_real(json, "density", s->density);
	json_put_count(json, "normals_given", s->normals_given);
	json_put_count(json, "normals_bad", s->normals_bad);
	json_put_real(json, "normals_length", f->normal_length);
	json_put_reals(json, "albedo", f->albedo, 3);
	json_put_text(json, "albedo_source", f->of_points.albedo_source);
	json_put_count(json, "depth", s->depth);
	json_put_count(json, "memory", s->memory);
}

void info_facts_print_json(const info_facts *f)
{
	json_writer json = { .out = stdout };
	json_put_open(&json, NULL, '{');
	json_put_text(&json, "file", f->name);
	json_put_text(&json, "format", f->format->name);
	json_put_count(&json, "points", f->points);
	json_put_count(&json, "left_out", f->cloud.left_out);
	json_put_text(&json, "up", settings_up_name(f->up));
	json_put_text(&json, "units", f->place.name);
	if (f->bounded) {
		json_put_reals(&json, "minimum", f->minimum, 3);
		json_put_reals(&json, "maximum", f->maximum, 3);
	}
	if (f->measured)
		write_measures(&json, f);
	json_put_open(&json, "scanners", '[');
	for (size_t i = 0; i < f->cloud.scanner_count; i++)
		json_put_reals(&json, NULL, f->cloud.scanner + 3 * i, 3);
	json_put_close(&json, ']');
	if (f->lit.count > 0)
		write_lit(&json, &f->lit);
	if (f->part)
		json_put_count(&json, "fields_of_first", f->cloud.count);
	write_fields(&json, f);
	json_put_open(&json, "comments", '[');
	for (size_t c = 0; c < f->cloud.comment_count; c++)
		json_put_text(&json, NULL, f->cloud.comment[c]);
	json_put_close(&json, ']');
	json_put_close(&json, '}');
	putchar('\n');
}

/* ------------------------------------------------------------------------------------ text */

/* Whether a column is among those that are only named: 0 at all points of a few. */
static bool is_idle(const info_facts *f, size_t c)
{
	const column_range *range = &f->range[c];
	return f->part && range->bad == 0 && range->minimum == 0.0 && range->maximum == 0.0;
}

static void print_columns(const info_facts *f)
{
	const char *before = "  0 there    ";
	if (f->part)
		printf("  of the first %zu points:\n", f->cloud.count);
	printf("  %-24s %-8s %14s %14s %s\n", "field", "type", "minimum", "maximum", "not finite");
	for (size_t c = 0; c < f->cloud.column_count; c++) {
		const scan_column *column = &f->cloud.column[c];
		const column_range range = f->range[c];
		if (is_idle(f, c))
			continue;
		text_message(stdout, "  %-24s %-8s ", column->name, type_name(column->type));
		if (range.minimum <= range.maximum)
			printf("%14.12g %14.12g %" PRIu64 "\n", range.minimum, range.maximum, range.bad);
		else
			printf("%14s %14s %" PRIu64 "\n", "-", "-", range.bad);
	}
	for (size_t c = 0; c < f->cloud.column_count; c++)
		if (is_idle(f, c)) {
			text_message(stdout, "%s%s", before, f->cloud.column[c].name);
			before = " ";
		}
	if (*before && !before[1])
		putchar('\n');
}

/* Points of no surface, of each kind with one of them. */
static void print_strays(const gw_stray_count *stray)
{
	const char *before = "  strays    ";
	for (int kind = 0; kind < GW_STRAY_KIND_COUNT; kind++) {
		const double *at = stray[kind].position;
		if (stray[kind].points == 0)
			continue;
		printf("%s %" PRIu64 " %s, as at %s %s %s", before, stray[kind].points,
			   gw_stray_kind_name((gw_stray_kind)kind), GW_SAID_PLACE(at[0]), GW_SAID_PLACE(at[1]),
			   GW_SAID_PLACE(at[2]));
		before = ";";
	}
	if (*before == ';')
		printf("; bakes make no surface of them\n");
}

static void print_format(const info_facts *f)
{
	printf("  format     %s, %s up%s\n", f->format->name, settings_up_name(f->up),
		   f->up_said             ? ""
		   : f->up != f->cloud.up ? ", by how its points lie"
		   : f->up_doubtful       ? ", though y looks like it"
								  : "");
	if (!f->measured) {
		printf("  points     %" PRIu64 "\n", f->points);
		return;
	}
	const gw_statistics *s = &f->statistics;
	printf("  points     %" PRIu64 ", of which %" PRIu64 " are not finite and %" PRIu64
		   " stand where another one does\n",
		   s->points, s->points - s->finite, s->duplicates);
	print_strays(s->stray);
}

static void print_places(const info_facts *f)
{
	bool degrees = f->place.projected && !f->measured;
	if (f->cloud.left_out)
		printf("  left out   %" PRIu64 " rows without a point\n", f->cloud.left_out);
	for (size_t i = 0; i < f->cloud.scanner_count; i++) {
		const double *at = f->cloud.scanner + 3 * i;
		printf("  %-10s at %.12g %.12g %.12g\n", i ? "" : "scanner", at[0], at[1], at[2]);
	}
	for (int k = 0; k < 3 && f->bounded; k++)
		printf("  %-10s %.12g to %.12g%s\n", k ? "" : "bounds", f->minimum[k], f->maximum[k],
			   degrees ? "" : " m");
	if (f->place.changes)
		printf("  units      coordinates are %s; %s\n", f->place.name,
			   degrees ? "--stats takes them to metres" : "all here is in metres");
}

/* What was measured where --stats asked for it. */
static void print_measures(const info_facts *f)
{
	const gw_statistics *s = &f->statistics;
	printf("  spacing    %s m (5th percentile %s, 95th %s)\n", GW_SAID(s->spacing[1], 4),
		   GW_SAID(s->spacing[0], 4), GW_SAID(s->spacing[2], 4));
	printf("  density    %s points/m^2\n", GW_SAID(s->density, 4));
	if (f->of_points.normal)
		printf("  normals    %" PRIu64 " given, of mean length %.4g; %" PRIu64 " bad\n",
			   s->normals_given, f->normal_length, s->normals_bad);
	else
		printf("  normals    none; they would be estimated\n");
	text_message(stdout, "  albedo     mean %.3g %.3g %.3g, from %s\n", f->albedo[0], f->albedo[1],
				 f->albedo[2], f->of_points.albedo_source);
}

/* By what it is lit, and what else the file says of its light. */
static void print_lit(const lit_notes *lit)
{
	const char *key = "";
	for (size_t i = 0; i < lit->count; i++) {
		char label[16];
		snprintf(label, sizeof label, "%s", lit->note[i].key);
		label[strcspn(label, "_")] = label[strcspn(label, "_")] ? ' ' : '\0';
		bool again = strcmp(key, lit->note[i].key) == 0;
		bool exposure = strcmp(lit->note[i].key, "exposure") == 0;
		text_message(stdout, "  %-10s %s%s\n", again ? "" : label, exposure ? "EV " : "",
					 lit->note[i].text);
		key = lit->note[i].key;
	}
}

void info_facts_print(const info_facts *f)
{
	text_message(stdout, "%s\n", f->name);
	print_format(f);
	print_places(f);
	if (f->measured)
		print_measures(f);
	else
		printf("  normals    %s\n",
			   scan_find(&f->cloud, "nx") ? "in the file" : "none; they would be estimated");
	print_lit(&f->lit);
	for (size_t c = 0; c < f->cloud.comment_count; c++)
		if (strncmp(f->cloud.comment[c], SCAN_NOTE, strlen(SCAN_NOTE)) == 0)
			text_message(stdout, "  note       %s\n", f->cloud.comment[c] + strlen(SCAN_NOTE));
	if (f->measured)
		printf("  bake       depth %" PRIu32 ", about %.2f GB\n", f->statistics.depth,
			   (double)f->statistics.memory * 1e-9);
	print_columns(f);
}

#include "result/lit_scan.h"
#include "result/bake_columns.h"
#include "result/lamp_columns.h"
#include "files/number_text.h"
#include "glowworm_host.h"
#include "options/preview.h"
#include "points/scan_color.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CHUNK_POINTS 8192u /* that a thread colours at a time */

/* What the work on one table needs. */
typedef struct maker {
	scan *from, *lit;
	const gw_bake_result *result;
	const settings *settings;
	double exposure;
	gw_error *error;
} maker;

/* Moves a column from the one table to the other. */
static gw_status move_column(maker *m, const char *name)
{
	scan_column *from = scan_find(m->from, name);
	if (!from)
		return GW_OK;
	scan_column *to = scan_add_column(m->lit, name, from->type, m->error);
	if (!to)
		return GW_ERROR_MEMORY;
	void *data = to->data;
	to->data = from->data;
	from->data = data;
	scan_remove_column(m->from, name);
	return GW_OK;
}

static gw_status move_triple(maker *m, const char *const name[3])
{
	for (int k = 0; k < 3; k++)
		GW_TRY(move_column(m, name[k]));
	return GW_OK;
}

static gw_status add_floats(maker *m, const char *name, const float *values, size_t stride)
{
	scan_column *column = scan_add_column(m->lit, name, SCAN_FLOAT32, m->error);
	if (!column)
		return GW_ERROR_MEMORY;
	for (size_t i = 0; i < m->lit->count; i++)
		((float *)column->data)[i] = values[stride * i];
	return GW_OK;
}

static gw_status add_triple(maker *m, const char *name, const float *values)
{
	static const char channel[3] = "rgb";
	for (size_t k = 0; k < 3; k++) {
		char full[64];
		snprintf(full, sizeof full, "scalar_%s_%c", name, channel[k]);
		GW_TRY(add_floats(m, full, values + k, 3));
	}
	return GW_OK;
}

/* ------------------------------------------------------------------------------- normals */

static void set_value(scan_column *column, size_t i, float value)
{
	if (column->type == SCAN_FLOAT64)
		((double *)column->data)[i] = (double)value;
	else
		((float *)column->data)[i] = value;
}

static bool is_float(const scan_column *column)
{
	return column && (column->type == SCAN_FLOAT32 || column->type == SCAN_FLOAT64);
}

/* The normals that came in stay, with their length; the others are those that the bake used. */
static gw_status make_normals(maker *m)
{
	static const char *const name[3] = { "nx", "ny", "nz" };
	scan_column *given[3];
	bool keep = true;
	for (int k = 0; k < 3; k++) {
		given[k] = scan_find(m->from, name[k]);
		keep = keep && is_float(given[k]);
	}
	for (size_t i = 0; keep && i < m->from->count; i++) {
		double length = 0.0;
		for (int k = 0; k < 3; k++)
			length += scan_value(given[k], i) * scan_value(given[k], i);
		for (size_t k = 0; k < 3 && !(length > 0.0 && isfinite(length)); k++)
			set_value(given[k], i, m->result->normal[3 * i + k]);
	}
	if (keep)
		return move_triple(m, name);
	for (size_t k = 0; k < 3; k++) {
		scan_remove_column(m->from, name[k]);
		GW_TRY(add_floats(m, name[k], m->result->normal + k, 3));
	}
	return GW_OK;
}

/* ------------------------------------------------------------------------------- colours */

typedef struct coloring {
	const float *radiance;
	double scale;
	uint8_t *data[3];
} coloring;

static void color_points(void *user, size_t first, size_t last, uint32_t worker)
{
	const coloring *job = user;
	(void)worker;
	for (size_t i = first; i < last; i++) {
		uint8_t rgb[3];
		preview_color(job->radiance + 3 * i, job->scale, rgb);
		for (int k = 0; k < 3; k++)
			job->data[k][i] = rgb[k];
	}
}

static gw_status make_colors(maker *m)
{
	if (m->settings->colors == 1)
		return move_triple(m, scan_color_names);
	coloring job = { .radiance = m->result->radiance, .scale = preview_scale(m->exposure) };
	for (int k = 0; k < 3; k++) {
		scan_remove_column(m->from, scan_color_names[k]);
		scan_column *column = scan_add_column(m->lit, scan_color_names[k], SCAN_UINT8, m->error);
		if (!column)
			return GW_ERROR_MEMORY;
		job.data[k] = column->data;
	}
	gw_parallel_for(m->settings->bake.threads, m->lit->count, CHUNK_POINTS, color_points, &job);
	return GW_OK;
}

static gw_status make_light(maker *m)
{
	const gw_bake_result *r = m->result;
	scan_column *quality = scan_add_column(m->lit, "quality", SCAN_FLOAT32, m->error);
	if (!quality)
		return GW_ERROR_MEMORY;
	for (size_t i = 0; i < m->lit->count; i++)
		((float *)quality->data)[i] = (float)preview_luminance(r->radiance + 3 * i);
	return add_triple(m, "radiance", r->radiance);
}

/* Numbers made point by point, `width` of them, and added as columns. */
typedef void point_values(const gw_bake_result *result, size_t point, float *values);

static gw_status add_made(maker *m, const char *name, size_t width, point_values *values)
{
	float *all = reallocarray(NULL, m->lit->count + 1, width * sizeof *all);
	if (!all)
		return gw_fail(m->error, GW_ERROR_MEMORY, "no memory for the column %s", name);
	for (size_t i = 0; i < m->lit->count; i++)
		values(m->result, i, all + width * i);
	gw_status status = width == 3 ? add_triple(m, name, all) : add_floats(m, name, all, 1);
	free(all);
	return status;
}

#define INVERSE_PI 0.318309886f

/* What light of one way makes a point send out: rho / pi * E. */
static void direct_radiance(const gw_bake_result *r, size_t point, float *values)
{
	for (size_t i = 3 * point; i < 3 * point + 3; i++)
		*values++ = r->albedo[i] * INVERSE_PI * r->direct_irradiance[i];
}

static void indirect_radiance(const gw_bake_result *r, size_t point, float *values)
{
	for (size_t i = 3 * point; i < 3 * point + 3; i++)
		*values++ = r->albedo[i] * INVERSE_PI * r->indirect_irradiance[i];
}

static void whole_irradiance(const gw_bake_result *r, size_t point, float *values)
{
	for (size_t i = 3 * point; i < 3 * point + 3; i++)
		*values++ = r->direct_irradiance[i] + r->indirect_irradiance[i];
}

static void illuminance(const gw_bake_result *r, size_t point, float *values)
{
	float e[3];
	whole_irradiance(r, point, e);
	*values = (float)preview_luminance(e);
}

static void luminance(const gw_bake_result *r, size_t point, float *values)
{
	*values = (float)preview_luminance(r->radiance + 3 * point);
}

static gw_status add_vectors(maker *m, const char *name, const float *values)
{
	for (size_t k = 0; k < 3; k++) {
		char full[64];
		snprintf(full, sizeof full, "scalar_%s_%c", name, "xyz"[k]);
		GW_TRY(add_floats(m, full, values + k, 3));
	}
	return GW_OK;
}

static gw_status make_light_fields(maker *m)
{
	uint32_t fields = m->settings->fields;
	const gw_bake_result *r = m->result;
	if (fields & 1u << SETTINGS_FIELD_DIRECT)
		GW_TRY(add_made(m, "direct", 3, direct_radiance));
	if (fields & 1u << SETTINGS_FIELD_INDIRECT)
		GW_TRY(add_made(m, "indirect", 3, indirect_radiance));
	if (fields & 1u << SETTINGS_FIELD_IRRADIANCE)
		GW_TRY(add_made(m, "irradiance", 3, whole_irradiance));
	if (fields & 1u << SETTINGS_FIELD_DIRECT_IRRADIANCE)
		GW_TRY(add_triple(m, "direct_irradiance", r->direct_irradiance));
	if (fields & 1u << SETTINGS_FIELD_INDIRECT_IRRADIANCE)
		GW_TRY(add_triple(m, "indirect_irradiance", r->indirect_irradiance));
	if (fields & 1u << SETTINGS_FIELD_LUMINANCE)
		GW_TRY(add_made(m, "scalar_luminance", 1, luminance));
	if (fields & 1u << SETTINGS_FIELD_ILLUMINANCE)
		GW_TRY(add_made(m, "scalar_illuminance", 1, illuminance));
	return GW_OK;
}

static gw_status make_fields(maker *m)
{
	uint32_t fields = m->settings->fields;
	GW_TRY(make_light_fields(m));
	if (fields & 1u << SETTINGS_FIELD_ROI)
		GW_TRY(add_floats(m, "scalar_roi", m->result->roi, 1));
	if (fields & 1u << SETTINGS_FIELD_AO)
		GW_TRY(add_floats(m, "scalar_ao", m->result->ambient_occlusion, 1));
	if (fields & 1u << SETTINGS_FIELD_BENT_NORMALS)
		GW_TRY(add_vectors(m, "bent_normal", m->result->bent_normal));
	if (fields & 1u << SETTINGS_FIELD_NORMALS)
		GW_TRY(add_vectors(m, "normal", m->result->normal));
	if (fields & 1u << SETTINGS_FIELD_ERROR)
		GW_TRY(add_floats(m, "scalar_error", m->result->error, 1));
	if (fields & 1u << SETTINGS_FIELD_UNKNOWN)
		GW_TRY(add_floats(m, "scalar_unknown", m->result->unknown, 1));
	if (fields & SETTINGS_FIELDS_OF_LAMPS)
		GW_TRY(lamp_columns_add(m->lit, m->result, m->settings, m->error));
	return GW_OK;
}

/* ------------------------------------------------------------------------------- comments */

static gw_status comment(maker *m, const char *text)
{
	return scan_add_comment(m->lit, text, m->error);
}

/* The command can be longer than any buffer. */
static gw_status comment_command(maker *m)
{
	char *text;
	if (asprintf(&text, "glowworm command: %s", m->settings->command) < 0)
		return gw_fail(m->error, GW_ERROR_MEMORY, "no memory for a comment line");
	gw_status status = comment(m, text);
	free(text);
	return status;
}

static gw_status comment_error(maker *m)
{
	const gw_report *r = &m->result->report;
	char text[560], remaining[NUMBER_TEXT], rms[NUMBER_TEXT], spread[NUMBER_TEXT];
	char shadows[NUMBER_TEXT], normals[NUMBER_TEXT], emission[NUMBER_TEXT];
	char geometry[NUMBER_TEXT], sides[NUMBER_TEXT], gaps[NUMBER_TEXT], halves[NUMBER_TEXT];
	char narrow[NUMBER_TEXT], between[NUMBER_TEXT];
	number_print_float(remaining, (float)r->remaining);
	number_print_float(rms, (float)r->error.relative_rms);
	number_print_float(spread, (float)r->error.spread);
	number_print_float(shadows, (float)r->error.shadows);
	number_print_float(normals, (float)r->error.normals);
	number_print_float(emission, (float)r->error.emission);
	number_print_float(geometry, (float)r->error.geometry);
	number_print_float(sides, (float)r->error.sides);
	number_print_float(gaps, (float)r->error.gaps);
	number_print_float(narrow, (float)r->error.narrow);
	number_print_float(between, (float)r->error.between);
	number_print_float(halves, (float)r->error.halves);
	snprintf(text, sizeof text,
			 "glowworm estimated error: bounces left out would add at most %s of the light",
			 remaining);
	gw_status status = comment(m, text);
	int length = snprintf(
		text, sizeof text,
		"glowworm estimated error: RMS %s +- %s of the mean radiance, from %u points; edges of "
		"shadows alone %s",
		rms, spread, r->error.points, shadows);
	if (r->error.normals > 0)
		length += snprintf(text + length, sizeof text - (size_t)length, ", errors of normals %s",
						   normals);
	if (r->error.emission > 0)
		length += snprintf(text + length, sizeof text - (size_t)length, ", edges of emitters %s",
						   emission);
	if (r->error.geometry > 0)
		length +=
			snprintf(text + length, sizeof text - (size_t)length, ", the octree %s", geometry);
	if (r->error.sides > 0)
		length +=
			snprintf(text + length, sizeof text - (size_t)length, ", guessed sides %s", sides);
	if (r->error.gaps > 0)
		length += snprintf(text + length, sizeof text - (size_t)length, ", gaps %s", gaps);
	if (r->error.narrow > 0)
		length +=
			snprintf(text + length, sizeof text - (size_t)length, ", narrow things %s", narrow);
	if (r->error.between > 0)
		length += snprintf(text + length, sizeof text - (size_t)length,
						   ", between points of the surface %s", between);
	if (r->error.halves > 0)
		snprintf(text + length, sizeof text - (size_t)length,
				 ", the surface by half of the points %s", halves);
	else if (r->halves_left_out)
		snprintf(text + length, sizeof text - (size_t)length,
				 ", half of the points not asked of the surface");
	bool known = r->error.points > 0 || r->error.relative_rms > 0.0;
	return status == GW_OK && known ? comment(m, text) : status;
}

static gw_status make_comments(maker *m)
{
	char text[256], exposure[NUMBER_TEXT];
	number_print_float(exposure, (float)m->exposure);
	for (size_t c = 0; c < m->from->comment_count; c++)
		if (strncmp(m->from->comment[c], "glowworm ", 9) != 0 &&
			strncmp(m->from->comment[c], SCAN_NOTE, strlen(SCAN_NOTE)) != 0)
			GW_TRY(comment(m, m->from->comment[c]));
	GW_TRY(comment(m, "glowworm " GW_VERSION));
	GW_TRY(comment_command(m));
	snprintf(text, sizeof text,
			 "glowworm units: linear RGB, Rec.709; radiance in %s, irradiance in %s",
			 m->settings->units == LIGHT_UNITS_PHOTOMETRIC ? "cd/m^2" : "W/(sr m^2)",
			 m->settings->units == LIGHT_UNITS_PHOTOMETRIC ? "lx" : "W/m^2");
	GW_TRY(comment(m, text));
	snprintf(text, sizeof text,
			 "glowworm preview: sRGB(PBR Neutral(radiance * 0.18 / (0.125 * 2^EV))), EV %s",
			 exposure);
	if (m->settings->colors == 0)
		GW_TRY(comment(m, text));
	if (m->result->report.unlit_space)
		GW_TRY(comment(m, SCAN_ENCLOSED));
	GW_TRY(scan_say_scanners(m->from, m->lit, m->error));
	snprintf(text, sizeof text, SCAN_UP "%s", settings_up_name(m->lit->up));
	if (m->lit->up != 'z' || m->settings->up != SETTINGS_UP_AUTO)
		GW_TRY(comment(m, text));
	return comment_error(m);
}

static gw_status make_all(maker *m)
{
	static const char *const position[3] = { "x", "y", "z" };
	GW_TRY(make_comments(m));
	GW_TRY(move_triple(m, position));
	GW_TRY(make_normals(m));
	GW_TRY(make_colors(m));
	GW_TRY(move_triple(m, scan_albedo_names));
	while (m->from->column_count > 0)
		GW_TRY(move_column(m, m->from->column[0].name));
	GW_TRY(make_light(m));
	GW_TRY(make_fields(m));
	return output_shift_apply(&m->settings->shifting, m->lit, m->error);
}

/* The exposure of the points that are written. */
static gw_status meter(const gw_bake_result *result, const float *emission, double *exposure,
					   gw_error *error)
{
	size_t count = 0;
	if (!result->asked) {
		*exposure = preview_exposure(result->radiance, emission, result->count);
		return GW_OK;
	}
	float *light = reallocarray(NULL, result->count + 1, 6 * sizeof *light);
	if (!light)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to meter %zu points", result->count);
	float *glow = light + 3 * result->count;
	for (size_t i = 0; i < result->count; i++) {
		if (!result->asked[i])
			continue;
		memcpy(light + 3 * count, result->radiance + 3 * i, 3 * sizeof *light);
		if (emission)
			memcpy(glow + 3 * count, emission + 3 * i, 3 * sizeof *glow);
		count++;
	}
	*exposure = preview_exposure(light, emission ? glow : NULL, count);
	free(light);
	return GW_OK;
}

/* Points that are not asked for, and strays that are not to be written, leave. */
static gw_status drop_points(scan *lit, const gw_bake_result *result, bool strays, gw_error *error)
{
	strays = strays && result->stray;
	if (!strays && !result->asked)
		return GW_OK;
	uint8_t *gone = calloc(result->count + 1, 1);
	if (!gone)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to mark %zu points", result->count);
	for (size_t i = 0; i < result->count; i++)
		gone[i] = (strays && result->stray[i]) || (result->asked && !result->asked[i]);
	scan_remove_points(lit, gone);
	free(gone);
	return GW_OK;
}

gw_status lit_scan_meter(const loaded_scene *scene, const gw_bake_result *result, const settings *s,
						 double *exposure, gw_error *error)
{
	*exposure = (double)s->exposure;
	return isnan(s->exposure) ? meter(result, scene->points.points.emission, exposure, error)
							  : GW_OK;
}

static void move_images(scan *from, scan *to)
{
	to->image = from->image;
	to->image_count = from->image_count;
	to->image_cell = from->image_cell;
	from->image = NULL;
	from->image_count = 0;
	from->image_cell = NULL;
}

gw_status lit_scan_make(loaded_scene *scene, const gw_bake_result *result, const settings *s,
						scan *lit, double *exposure, gw_error *error)
{
	*lit = (scan){ .count = scene->cloud.count, .up = scene->up };
	GW_TRY(lit_scan_meter(scene, result, s, exposure, error));
	maker m = { &scene->cloud, lit, result, s, *exposure, error };
	bake_columns_remove(m.from, BAKE_COLUMNS_ALL);
	lamp_columns_remove(m.from);
	gw_status status = make_all(&m);
	lit->scanner = m.from->scanner;
	lit->scanner_count = m.from->scanner_count;
	lit->scanner_of = m.from->scanner_of;
	m.from->scanner = NULL;
	m.from->scanner_of = NULL;
	m.from->scanner_count = 0;
	/* Pictures have all of their points, or are none. */
	if (!result->asked && !(s->strays == SETTINGS_STRAYS_DROP && result->stray))
		move_images(m.from, lit);
	scan_clear(&scene->cloud);
	if (status == GW_OK)
		status = drop_points(lit, result, s->strays == SETTINGS_STRAYS_DROP, error);
	if (status != GW_OK)
		scan_clear(lit);
	else
		bake_columns_round(lit, s);
	return status;
}

size_t lit_scan_row_bytes(const loaded_scene *scene, const settings *s, size_t *columns)
{
	static const char *const position[3] = { "x", "y", "z" };
	static const size_t floats[SETTINGS_FIELD_COUNT] = {
		[SETTINGS_FIELD_DIRECT] = 3,
		[SETTINGS_FIELD_INDIRECT] = 3,
		[SETTINGS_FIELD_IRRADIANCE] = 3,
		[SETTINGS_FIELD_DIRECT_IRRADIANCE] = 3,
		[SETTINGS_FIELD_INDIRECT_IRRADIANCE] = 3,
		[SETTINGS_FIELD_LUMINANCE] = 1,
		[SETTINGS_FIELD_ILLUMINANCE] = 1,
		[SETTINGS_FIELD_ROI] = 1,
		[SETTINGS_FIELD_AO] = 1,
		[SETTINGS_FIELD_BENT_NORMALS] = 3,
		[SETTINGS_FIELD_NORMALS] = 3,
		[SETTINGS_FIELD_ERROR] = 1,
		[SETTINGS_FIELD_UNKNOWN] = 1,
	};
	size_t bytes = 6, count = 7; /* normals, the luminance and radiance; colours and albedo */
	for (int k = 0; k < 3; k++)
		bytes += scan_type_size(scan_find(&scene->cloud, position[k])->type);
	for (size_t f = 0; f < SETTINGS_FIELD_COUNT; f++)
		count += s->fields >> f & 1u ? floats[f] : 0;
	bytes += count * sizeof(float);
	*columns = count + 9;
	return bytes;
}

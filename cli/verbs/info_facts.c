/* info_facts.c - see info_facts.h. */
#include "verbs/info_facts.h"
#include "files/input_file.h"
#include "program/signals.h"
#include "program/text_quote.h"
#include "points/scan_origin.h"
#include "points/scan_rows.h"
#include "scene/loaded_scene.h"
#include "table/format_parts.h"
#include "table/format_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Points of a part that is gone through. */
#define PART_POINTS (1u << 18)

/* --------------------------------------------------------------------------------- ranges */

static void widen_range(const scan_column *column, size_t count, column_range *range)
{
	for (size_t i = 0; i < count; i++) {
		double value = scan_value(column, i);
		if (!isfinite(value)) {
			range->bad++;
			continue;
		}
		range->minimum = fmin(range->minimum, value);
		range->maximum = fmax(range->maximum, value);
	}
}

/* Takes the values of a part, which has the columns of the first one. */
static gw_status take_values(info_facts *f, const scan *part, gw_error *error)
{
	size_t count = f->cloud.column_count;
	if (!f->range) {
		f->range = reallocarray(NULL, count + 1, sizeof *f->range);
		if (!f->range)
			return gw_fail(error, GW_ERROR_MEMORY, "no memory for the columns of %s", f->name);
		for (size_t c = 0; c < count; c++)
			f->range[c] = (column_range){ INFINITY, -INFINITY, 0 };
	}
	for (size_t c = 0; c < count && c < part->column_count; c++)
		widen_range(&part->column[c], part->count, &f->range[c]);
	return GW_OK;
}

/* Bounds by the ranges of coordinates, if there are some that are finite. */
static void take_bounds(info_facts *f)
{
	static const char *const name[3] = { "x", "y", "z" };
	f->bounded = true;
	for (int k = 0; k < 3; k++) {
		const scan_column *column = scan_find(&f->cloud, name[k]);
		const column_range *range = column ? &f->range[column - f->cloud.column] : NULL;
		f->bounded = f->bounded && range && range->minimum <= range->maximum;
		f->minimum[k] = range ? range->minimum : 0.0;
		f->maximum[k] = range ? range->maximum : 0.0;
	}
}

/* Of a box in degrees the corners say little, so that it stays as it is. */
static void bounds_to_metres(info_facts *f)
{
	if (!f->bounded || !f->place.changes || f->place.projected)
		return;
	coordinates_to_metres(&f->place, f->minimum);
	coordinates_to_metres(&f->place, f->maximum);
}

/* -------------------------------------------------------------------------------- reading */

/* The first points of a file whose header has the bounds. */
static gw_status read_first(info_facts *f, format_parts *parts, gw_error *error)
{
	f->part = true;
	f->up_unasked = true;
	GW_TRY(format_parts_read(parts, 0, INFO_FIRST_POINTS, &f->cloud, error));
	return take_values(f, &f->cloud, error);
}

/* Goes through all points, of which the first are kept. */
static gw_status read_through(info_facts *f, format_parts *parts, gw_error *error)
{
	gw_status status = GW_OK;
	f->up_unasked = true;
	for (uint64_t first = 0; first < parts->count && status == GW_OK; first += PART_POINTS) {
		scan part;
		GW_TRY(signals_check(error));
		GW_TRY(format_parts_read(parts, first, PART_POINTS, first ? &part : &f->cloud, error));
		status = take_values(f, first ? &part : &f->cloud, error);
		if (first)
			scan_clear(&part);
	}
	take_bounds(f);
	return status;
}

/* What can be told without reading all of a large file; found is left NULL where it has to be. */
static gw_status read_quickly(const settings *s, const char *path, info_facts *f, gw_error *error)
{
	format_parts parts;
	const format_options options = { s->format, s->columns, s->bake.threads };
	GW_TRY(format_parts_open(path, &options, &parts, error));
	const format *found = parts.count > INFO_FIRST_POINTS ? parts.found : NULL;
	gw_status status = GW_OK;
	f->bounded = found && found->say_bounds && found->say_bounds(&parts.in, f->minimum, f->maximum);
	if (found && (f->bounded || parts.count > INFO_WHOLE_POINTS)) {
		f->format = found;
		f->points = parts.count;
		status = f->bounded ? read_first(f, &parts, error) : read_through(f, &parts, error);
	}
	format_parts_close(&parts);
	return status;
}

static gw_status read_whole(const settings *s, const char *path, info_facts *f, gw_error *error)
{
	const format_options options = { s->format, s->columns, s->bake.threads };
	GW_TRY(format_read_with(path, &options, &f->cloud, &f->format, error));
	if (s->stats || s->places) {
		GW_TRY(scan_find_rows(&f->cloud, false, error));
		GW_TRY(scan_find_origin(&f->cloud, error));
	}
	f->points = f->cloud.count;
	if (s->places)
		return GW_OK;
	GW_TRY(take_values(f, &f->cloud, error));
	take_bounds(f);
	return GW_OK;
}

/* ------------------------------------------------------------------------------- measuring */

static void find_means(info_facts *f)
{
	const scan_points *p = &f->of_points;
	uint64_t normals = 0;
	for (size_t i = 0; i < f->cloud.count; i++) {
		double length = 0.0;
		for (size_t k = 0; k < 3; k++) {
			f->albedo[k] += (double)p->albedo[3 * i + k] / (double)f->cloud.count;
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

/* Which axis is up: as the user says, else the file, else how its points lie. */
static void find_up(const settings *s, info_facts *f, const double *position)
{
	f->up_said = s->up != SETTINGS_UP_AUTO;
	if (f->up_said)
		f->up = settings_up_axis(s->up);
	else
		f->up = scan_up(&f->cloud, position, f->format->custom_up, &f->up_doubtful);
	if (s->places && f->up_doubtful)
		text_message(stderr,
					 "glowworm: note: %s: nothing says which axis points up, and z is taken; the "
					 "points lie as if it were y: if it is, say --up y, also to bake and render\n",
					 f->name);
}

static gw_status measure(const settings *s, info_facts *f, gw_error *error)
{
	scan_points *points = &f->of_points;
	GW_TRY(scan_points_make(&f->cloud, &s->points, points, error));
	find_up(s, f, points->position);
	for (size_t i = 0; i < f->cloud.count && f->place.changes; i++)
		coordinates_to_metres(&f->place, points->position + 3 * i);
	if (s->places)
		return GW_OK;
	f->measured = true;
	GW_TRY(gw_measure(&points->points, s->bake.threads, &f->statistics, error));
	find_means(f);
	f->bounded = f->statistics.finite > 0;
	memcpy(f->minimum, f->statistics.minimum, sizeof f->minimum);
	memcpy(f->maximum, f->statistics.maximum, sizeof f->maximum);
	return GW_OK;
}

/* Which axis points up, of points that were read but not measured. */
static gw_status find_up_quickly(const settings *s, info_facts *f, gw_error *error)
{
	static const char *const name[3] = { "x", "y", "z" };
	size_t count = f->up_unasked ? 0 : f->cloud.count;
	double *position = reallocarray(NULL, count ? count : 1, 3 * sizeof *position);
	if (!position)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the positions of %s", f->name);
	for (int k = 0; k < 3; k++) {
		const scan_column *column = scan_find(&f->cloud, name[k]);
		for (size_t i = 0; i < count; i++)
			position[3 * i + (size_t)k] = column ? scan_value(column, i) : 0.0;
	}
	size_t all = f->cloud.count;
	f->cloud.count = count;
	find_up(s, f, position);
	f->cloud.count = all;
	free(position);
	return GW_OK;
}

/* ------------------------------------------------------------------------------------ all */

static gw_status find_all(const settings *s, const char *path, info_facts *f, gw_error *error)
{
	gw_error reason = { 0 };
	bool slowly = s->stats || s->places;
	if (!slowly)
		GW_TRY(read_quickly(s, path, f, error));
	if (!f->format)
		GW_TRY(read_whole(s, path, f, error));
	if (f->points == 0)
		return gw_fail(error, GW_ERROR_DATA, "%s: there are no points", f->name);
	gw_status status = coordinates_find(&f->cloud, (coordinates_unit)s->length, &f->place, &reason);
	if (status == GW_OK) {
		bounds_to_metres(f);
		status = lit_notes_find(&f->cloud, &f->lit, &reason);
	}
	if (status == GW_OK)
		status = slowly ? measure(s, f, &reason) : find_up_quickly(s, f, &reason);
	if (status != GW_OK)
		gw_fail(error, status, "%s: %.900s", f->name, reason.text);
	return status;
}

gw_status info_facts_find(const settings *s, const char *path, info_facts *facts, gw_error *error)
{
	*facts = (info_facts){ .name = loaded_scene_input_name(path), .place = coordinates_metres() };
	return find_all(s, path, facts, error);
}

void info_facts_clear(info_facts *facts)
{
	scan_clear(&facts->cloud);
	free(facts->range);
	coordinates_clear(&facts->place);
	lit_notes_clear(&facts->lit);
	scan_points_clear(&facts->of_points);
}

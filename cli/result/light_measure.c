#include "result/light_measure.h"
#include "result/bake_columns.h"
#include "files/growing_table.h"
#include "files/number_text.h"
#include "glowworm_picture.h"
#include "options/preview.h"
#include "points/scan_color.h"
#include "program/signals.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ------------------------------------------------------------------------------ where */

/* `count` numbers with commas between them; returns what follows, or NULL. */
static const char *read_numbers(const char *text, size_t count, double *value)
{
	for (size_t i = 0; i < count; i++) {
		size_t used = number_read(text, strlen(text), &value[i]);
		if (used == 0 || !isfinite(value[i]))
			return NULL;
		text += used;
		if (i + 1 < count && *text++ != ',')
			return NULL;
	}
	return text;
}

static gw_status read_box(const char *text, measure_region *r, gw_error *error)
{
	double value[6];
	const char *end = read_numbers(text, 6, value);
	if (!end || *end)
		return gw_fail(error, GW_ERROR_USAGE,
					   "--box is '%.80s', but must be X,Y,Z,X,Y,Z: two opposite corners in metres",
					   text);
	r->has_box = true;
	for (int k = 0; k < 3; k++) {
		r->low[k] = fmin(value[k], value[3 + k]);
		r->high[k] = fmax(value[k], value[3 + k]);
	}
	return GW_OK;
}

static gw_status read_path(const char *text, measure_region *r, gw_error *error)
{
	for (const char *at = text + strspn(text, " "); *at; at += strspn(at, " ")) {
		double *grown = growing_table_room(r->place, r->place_count, 3 * sizeof *grown);
		if (!grown)
			return gw_fail(error, GW_ERROR_MEMORY, "no memory for a path");
		r->place = grown;
		at = read_numbers(at, 3, grown + 3 * r->place_count);
		if (!at || (*at && *at != ' '))
			break;
		r->place_count++;
		if (!*at)
			return GW_OK;
	}
	return gw_fail(error, GW_ERROR_USAGE,
				   "--path is '%.80s', but must be X,Y,Z X,Y,Z ...: places in metres with blanks "
				   "between them",
				   text);
}

gw_status measure_region_read(const char *box, const char *path, double reach,
							  measure_region *region, gw_error *error)
{
	*region = (measure_region){ .reach = reach };
	gw_status status = box ? read_box(box, region, error) : GW_OK;
	if (status == GW_OK && path)
		status = read_path(path, region, error);
	if (status != GW_OK)
		measure_region_clear(region);
	return status;
}

void measure_region_clear(measure_region *region)
{
	free(region->place);
	*region = (measure_region){ .place = NULL };
}

/* Squared distance between a point and the segment of the path from a to b. */
static double square_to_segment(const double p[3], const double a[3], const double b[3])
{
	double along = 0.0, length = 0.0, square = 0.0;
	for (int k = 0; k < 3; k++) {
		along += (p[k] - a[k]) * (b[k] - a[k]);
		length += (b[k] - a[k]) * (b[k] - a[k]);
	}
	double t = length > 0.0 ? fmin(fmax(along / length, 0.0), 1.0) : 0.0;
	for (int k = 0; k < 3; k++) {
		double off = p[k] - a[k] - t * (b[k] - a[k]);
		square += off * off;
	}
	return square;
}

static bool is_within(const measure_region *r, const double p[3])
{
	for (int k = 0; k < 3 && r->has_box; k++)
		if (!(p[k] >= r->low[k] && p[k] <= r->high[k]))
			return false;
	bool near = r->place_count == 0;
	for (size_t i = 0; i < r->place_count && !near; i++) {
		size_t next = i + 1 < r->place_count ? i + 1 : i;
		near = square_to_segment(p, r->place + 3 * i, r->place + 3 * next) <= r->reach * r->reach;
	}
	return near;
}

/* ------------------------------------------------------------------------------ what */

/* Columns of one number or three. */
typedef struct light_columns {
	const scan_column *column[3];
} light_columns;

static bool find_three(const scan *cloud, const char *name, light_columns *found)
{
	char own[96];
	bool all = true;
	for (int k = 0; k < 3; k++) {
		snprintf(own, sizeof own, "%s_%c", name, "rgb"[k]);
		found->column[k] = scan_find_scalar(cloud, own);
		all = all && found->column[k];
	}
	return all;
}

static double luminance_of(const light_columns *c, size_t i)
{
	double value = c->column[1] ? gw_relative_luminance(scan_value(c->column[0], i),
														scan_value(c->column[1], i),
														scan_value(c->column[2], i))
								: scan_value(c->column[0], i);
	return isfinite(value) ? value : 0.0;
}

static gw_status find_quantity(const scan *cloud, light_columns *found, light_measure *m,
							   gw_error *error)
{
	bool photometric = bake_columns_photometric(cloud);
	*found = (light_columns){ { scan_find_scalar(cloud, "illuminance") } };
	if (found->column[0]) {
		m->quantity = "illuminance";
		m->unit = "lx";
	} else if (find_three(cloud, "irradiance", found)) {
		m->quantity = photometric ? "illuminance" : "irradiance";
		m->unit = photometric ? "lx" : "W/m^2";
	} else if (find_three(cloud, "radiance", found)) {
		m->quantity = photometric ? "luminance" : "radiance";
		m->unit = photometric ? "cd/m^2" : "W/(sr m^2)";
	} else {
		return gw_fail(error, GW_ERROR_DATA,
					   "there is no light to measure: the points have no columns of illuminance, "
					   "irradiance or radiance, as a bake writes");
	}
	return GW_OK;
}

/* ------------------------------------------------------------------------------ summing */

static bool is_cancelled(void *user)
{
	(void)user;
	return signals_pending() != 0;
}

/* m^2 of surface that each point stands for; 0 where it does not count. */
static double *find_areas(const settings *s, const loaded_scene *scene,
						  const measure_region *region, gw_error *error)
{
	const gw_points *points = &scene->points.points;
	const gw_surfels_options options = { .threads = s->bake.threads,
										 .normals = GW_NORMALS_GIVEN,
										 .cancelled = is_cancelled };
	gw_surfels surfels;
	if (gw_surfels_make(points, &options, &surfels, error) != GW_OK)
		return NULL;
	double *area = calloc(points->count + 1, sizeof *area);
	uint32_t *shared = calloc(surfels.count + 1, sizeof *shared);
	for (size_t i = 0; i < points->count && area && shared; i++)
		if (surfels.surfel_of_point[i] != UINT32_MAX)
			shared[surfels.surfel_of_point[i]]++;
	for (size_t i = 0; i < points->count && area && shared; i++) {
		uint32_t surfel = surfels.surfel_of_point[i];
		if (surfel != UINT32_MAX && is_within(region, points->position + 3 * i))
			area[i] = (double)surfels.area[surfel] / shared[surfel];
	}
	if (!area || !shared) {
		gw_fail(error, GW_ERROR_MEMORY, "no memory for the areas of %zu points", points->count);
		free(area);
		area = NULL;
	}
	free(shared);
	gw_surfels_clear(&surfels);
	return area;
}

static gw_status sum_up(const light_columns *light, const double *area, size_t count,
						light_measure *m, gw_error *error)
{
	double sum = 0.0;
	m->least = INFINITY;
	for (size_t i = 0; i < count; i++) {
		if (!(area[i] > 0.0))
			continue;
		double value = luminance_of(light, i);
		m->points++;
		m->area += area[i];
		sum += area[i] * value;
		m->least = fmin(m->least, value);
		m->most = fmax(m->most, value);
	}
	if (m->points == 0)
		return gw_fail(error, GW_ERROR_DATA,
					   "none of the %zu points lies where it is to be measured; `glowworm info` "
					   "tells where they are",
					   count);
	m->mean = sum / m->area;
	return GW_OK;
}

static gw_status add_lamp(measure_lamp **list, size_t *count, const char *name, size_t length,
						  gw_error *error)
{
	measure_lamp *grown = growing_table_room(*list, *count, sizeof *grown);
	*list = grown ? grown : *list;
	char *kept = grown ? strndup(name, length) : NULL;
	if (!kept)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a list of lamps");
	(*list)[(*count)++] = (measure_lamp){ kept, 0.0 };
	return GW_OK;
}

/* What lamps called GROUP.NAME give together, group by group. */
static gw_status sum_groups(light_measure *m, gw_error *error)
{
	for (size_t i = 0; i < m->lamp_count; i++) {
		const char *name = m->lamp[i].name;
		size_t length = strcspn(name, "."), g = 0;
		if (!name[length])
			continue;
		while (g < m->group_count &&
			   (strncmp(m->group[g].name, name, length) != 0 || m->group[g].name[length] != '\0'))
			g++;
		if (g == m->group_count)
			GW_TRY(add_lamp(&m->group, &m->group_count, name, length, error));
		m->group[g].share += m->lamp[i].share;
	}
	return GW_OK;
}

/* What each lamp gives of the radiance, where a bake wrote that (--fields lights). */
static gw_status share_out(const scan *cloud, const double *area, light_measure *m, gw_error *error)
{
	static const char prefix[] = "scalar_light_";
	double all = 0.0;
	for (size_t c = 0; c < cloud->column_count; c++) {
		const char *own = cloud->column[c].name;
		size_t length = strlen(own), head = sizeof prefix - 1;
		char name[256];
		light_columns light;
		if (strncmp(own, prefix, head) != 0 || length < head + 3 ||
			strcmp(own + length - 2, "_r") != 0)
			continue;
		snprintf(name, sizeof name, "light_%.*s", (int)(length - head - 2), own + head);
		if (!find_three(cloud, name, &light))
			continue;
		GW_TRY(add_lamp(&m->lamp, &m->lamp_count, own + head, length - head - 2, error));
		measure_lamp *shown = &m->lamp[m->lamp_count - 1];
		for (size_t i = 0; i < cloud->count; i++)
			shown->share += area[i] * luminance_of(&light, i);
		all += shown->share;
	}
	for (size_t i = 0; i < m->lamp_count && all > 0.0; i++)
		m->lamp[i].share /= all;
	return sum_groups(m, error);
}

gw_status light_measure_make(const settings *s, const loaded_scene *scene,
							 const measure_region *region, light_measure *measure, gw_error *error)
{
	light_columns light;
	*measure = (light_measure){ .points = 0 };
	GW_TRY(find_quantity(&scene->cloud, &light, measure, error));
	double *area = find_areas(s, scene, region, error);
	if (!area)
		return error->status;
	gw_status status = sum_up(&light, area, scene->cloud.count, measure, error);
	if (status == GW_OK)
		status = share_out(&scene->cloud, area, measure, error);
	free(area);
	if (status != GW_OK)
		light_measure_clear(measure);
	return status;
}

void light_measure_clear(light_measure *measure)
{
	for (size_t i = 0; i < measure->lamp_count; i++)
		free(measure->lamp[i].name);
	for (size_t i = 0; i < measure->group_count; i++)
		free(measure->group[i].name);
	free(measure->lamp);
	free(measure->group);
	*measure = (light_measure){ .points = 0 };
}

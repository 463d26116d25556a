/* coordinates.c - feet and degrees as metres; see coordinates.h. */
#include "units/coordinates.h"

#include "las/las_notes.h"

#include <math.h>
#include <proj.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define GEO_KEYS 512       /* numbers of GeoTIFF keys that are looked at, four a key */
#define GEO_PROJECTED 3072 /* keys: EPSG number of a projected system, */
#define GEO_GEOGRAPHIC 2048
#define GEO_LINEAR 3076   /* unit along it, an EPSG number */
#define GEO_VERTICAL 4099 /* unit of heights */
#define GEO_USER 32767    /* a number that says nothing */
#define EPSG_FOOT 9002
#define EPSG_US_FOOT 9003
#define US_FOOT (1200.0 / 3937.0)

/* What looks like degrees: far from the origin and narrow beside that, and many times as high. */
#define DEGREES_NARROW 0.05
#define DEGREES_HIGH 300.0
/* But no higher than mountains are, in metres or feet, and not in the sea off Ghana, where a small
 * thing in metres would lie that has one point far off. */
#define DEGREES_HIGHEST 40000.0
#define DEGREES_AWAY 0.5

static const double metres_of[COORDINATES_UNIT_COUNT] = { 1.0,    1.0,    0.001,   0.01, 1000.0,
														  0.0254, 0.3048, US_FOOT, 1.0 };

const char *coordinates_unit_name(coordinates_unit unit)
{
	static const char *const name[COORDINATES_UNIT_COUNT] = { "auto", "m",  "mm",    "cm",     "km",
															  "in",   "ft", "us-ft", "degrees" };
	return name[unit];
}

coordinates coordinates_metres(void)
{
	return (coordinates){ .scale = { 1, 1, 1 }, .name = "metres" };
}

void coordinates_clear(coordinates *c)
{
	proj_destroy(c->projection);
	if (c->context)
		proj_context_destroy(c->context);
	*c = coordinates_metres();
}

bool coordinates_agree(const coordinates *a, const coordinates *b)
{
	return memcmp(a->scale, b->scale, sizeof a->scale) == 0 && !a->projection == !b->projection;
}

/* ----------------------------------------------------------------------- what a file says */

/* A system that a file names, as PROJ takes it, and units that it gives beside it. */
typedef struct system_name {
	char *text;              /* owned, or NULL */
	double linear, vertical; /* metres; 0: not said */
} system_name;

static double unit_of_code(unsigned code)
{
	return code == EPSG_FOOT ? 0.3048 : code == EPSG_US_FOOT ? US_FOOT : code == 9001 ? 1.0 : 0.0;
}

static gw_status name_by_keys(const scan *cloud, system_name *name, gw_error *error)
{
	double key[GEO_KEYS];
	unsigned projected = 0, geographic = 0;
	for (size_t c = 0; c < cloud->comment_count; c++) {
		size_t count = las_note_read(cloud->comment[c], "geokeys", key, GEO_KEYS);
		for (size_t k = 4; k + 4 <= count; k += 4) {
			if (key[k + 1] != 0.0) /* its value stands elsewhere */
				continue;
			unsigned id = (unsigned)key[k], value = (unsigned)key[k + 3];
			projected = id == GEO_PROJECTED ? value : projected;
			geographic = id == GEO_GEOGRAPHIC ? value : geographic;
			name->linear = id == GEO_LINEAR ? unit_of_code(value) : name->linear;
			name->vertical = id == GEO_VERTICAL ? unit_of_code(value) : name->vertical;
		}
	}
	unsigned code = projected ? projected : name->linear > 0.0 ? 0 : geographic;
	if (code == 0 || code == GEO_USER)
		return GW_OK;
	if (asprintf(&name->text, "EPSG:%u", code) < 0) {
		name->text = NULL;
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a coordinate system");
	}
	return GW_OK;
}

/* Metres of one unit of an axis; 0 when that is an angle or not known. */
static double axis_unit(PJ_CONTEXT *context, const PJ *system, int axis)
{
	double factor = 0.0;
	const char *name = NULL;
	PJ *axes = system ? proj_crs_get_coordinate_system(context, system) : NULL;
	if (axes && axis < proj_cs_get_axis_count(context, axes) &&
		!proj_cs_get_axis_info(context, axes, axis, NULL, NULL, NULL, &factor, &name, NULL, NULL))
		factor = 0.0;
	if (axes && name && strstr(name, "degree"))
		factor = 0.0;
	proj_destroy(axes);
	return factor;
}

static bool is_geographic(const PJ *system)
{
	PJ_TYPE type = proj_get_type(system);
	return type == PJ_TYPE_GEOGRAPHIC_2D_CRS || type == PJ_TYPE_GEOGRAPHIC_3D_CRS;
}

/* The units of a system: its parts are replaced by the one that lies flat. */
static PJ *take_units(PJ_CONTEXT *context, PJ *system, double scale[3])
{
	double height = 0.0;
	if (system && proj_get_type(system) == PJ_TYPE_COMPOUND_CRS) {
		PJ *upright = proj_crs_get_sub_crs(context, system, 1);
		height = axis_unit(context, upright, 0);
		proj_destroy(upright);
		PJ *flat = proj_crs_get_sub_crs(context, system, 0);
		proj_destroy(system);
		system = flat;
	}
	if (system && proj_get_type(system) == PJ_TYPE_BOUND_CRS) {
		PJ *source = proj_get_source_crs(context, system);
		proj_destroy(system);
		system = source;
	}
	double flat = system && !is_geographic(system) ? axis_unit(context, system, 0) : 0.0;
	scale[0] = scale[1] = flat > 0.0 ? flat : 1.0;
	scale[2] = height > 0.0 ? height : scale[0];
	return system;
}

/* -------------------------------------------------------------------------------- degrees */

typedef struct bounds {
	double low[3], high[3];
} bounds;

static bounds find_bounds(const scan *cloud)
{
	static const char *const name[3] = { "x", "y", "z" };
	bounds b = { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } };
	for (int k = 0; k < 3; k++) {
		const scan_column *column = scan_find(cloud, name[k]);
		for (size_t i = 0; column && i < cloud->count; i++) {
			double value = scan_value(column, i);
			if (isfinite(value)) {
				b.low[k] = fmin(b.low[k], value);
				b.high[k] = fmax(b.high[k], value);
			}
		}
	}
	return b;
}

static bool can_be_degrees(const bounds *b)
{
	return b->low[0] >= -360.0 && b->high[0] <= 360.0 && b->low[1] >= -90.0 && b->high[1] <= 90.0;
}

static bool look_like_degrees(const bounds *b)
{
	double width = fmax(b->high[0] - b->low[0], b->high[1] - b->low[1]);
	double away = hypot(b->low[0], b->low[1]);
	double height = b->high[2] - b->low[2];
	return can_be_degrees(b) && width > 0.0 && width < DEGREES_NARROW * away &&
		   away > DEGREES_AWAY && height > DEGREES_HIGH * width && height < DEGREES_HIGHEST;
}

/* A projection to metres around the middle, in which lengths are right to one in a thousand within
 * 200 km. */
static gw_status project(const PJ *system, const bounds *b, coordinates *to, gw_error *error)
{
	char local[160];
	double middle[2];
	for (int k = 0; k < 2; k++)
		middle[k] = round(50.0 * (b->low[k] + b->high[k])) / 100.0;
	snprintf(local, sizeof local,
			 "+proj=tmerc +lat_0=%.2f +lon_0=%.2f +datum=WGS84 +units=m +type=crs", middle[1],
			 middle[0]);
	PJ *target = proj_create(to->context, local), *whole = NULL;
	if (target)
		whole = proj_create_crs_to_crs_from_pj(to->context, system, target, NULL, NULL);
	if (whole)
		to->projection = proj_normalize_for_visualization(to->context, whole);
	proj_destroy(target);
	proj_destroy(whole);
	if (!to->projection)
		return gw_fail(error, GW_ERROR_DATA,
					   "x and y are degrees, and PROJ has no way to project them (is the package "
					   "proj-data installed?); project them with another program");
	to->changes = true;
	snprintf(to->name, sizeof to->name,
			 "degrees, projected to metres around longitude %.2f and latitude %.2f", middle[0],
			 middle[1]);
	return GW_OK;
}

/* ------------------------------------------------------------------------------- together */

static void name_scale(coordinates *c)
{
	double s = c->scale[0];
	const char *unit = s == 1.0                   ? "metres"
					   : s == 0.3048              ? "feet"
					   : fabs(s - US_FOOT) < 1e-9 ? "US survey feet"
					   : s == 0.0254              ? "inches"
												  : "units";
	c->changes = s != 1.0 || c->scale[2] != 1.0;
	int length = snprintf(c->name, sizeof c->name, "%s", unit);
	if (s != 1.0)
		length += snprintf(c->name + length, sizeof c->name - (size_t)length, " of %.9g m", s);
	if (c->scale[2] != s)
		snprintf(c->name + length, sizeof c->name - (size_t)length, ", heights in units of %.9g m",
				 c->scale[2]);
}

static gw_status find_by_system(scan *cloud, const system_name *name, const bounds *b,
								coordinates *to, gw_error *error)
{
	to->context = proj_context_create();
	if (!to->context)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a coordinate system");
	proj_log_level(to->context, PJ_LOG_NONE);
	PJ *system = name->text ? proj_create(to->context, name->text) : NULL;
	system = take_units(to->context, system, to->scale);
	gw_status status = GW_OK;
	if (system && is_geographic(system) && can_be_degrees(b)) {
		status = project(system, b, to, error);
	} else {
		if (system && is_geographic(system))
			status = scan_add_comment(cloud,
									  SCAN_NOTE "its header claims degrees, which its coordinates "
												"cannot be; they are taken as metres, but for "
												"--units",
									  error);
		if (name->linear > 0.0)
			to->scale[0] = to->scale[1] = to->scale[2] = name->linear;
		if (name->vertical > 0.0)
			to->scale[2] = name->vertical;
		name_scale(to);
	}
	proj_destroy(system);
	return status;
}

static gw_status find_by_file(scan *cloud, const bounds *b, coordinates *to, gw_error *error)
{
	system_name name = { 0 };
	gw_status status = las_note_join(cloud, "wkt", &name.text, error);
	if (status == GW_OK && !name.text)
		status = name_by_keys(cloud, &name, error);
	bool named = name.text || name.linear > 0.0 || name.vertical > 0.0;
	if (status == GW_OK && named)
		status = find_by_system(cloud, &name, b, to, error);
	free(name.text);
	to->by_file = true;
	if (status == GW_OK && !named && look_like_degrees(b))
		return gw_fail(
			error, GW_ERROR_DATA,
			"x and y look like degrees, %g to %g and %g to %g beside %g units of height; "
			"--units degrees projects longitude and latitude, and --units m says that "
			"they are metres",
			b->low[0], b->high[0], b->low[1], b->high[1], b->high[2] - b->low[2]);
	return status;
}

gw_status coordinates_find(scan *cloud, coordinates_unit unit, coordinates *to, gw_error *error)
{
	*to = coordinates_metres();
	gw_status status = GW_OK;
	bounds b = find_bounds(cloud);
	if (unit == COORDINATES_AUTO) {
		status = find_by_file(cloud, &b, to, error);
	} else if (unit == COORDINATES_DEGREES) {
		system_name name = { .text = (char[]){ "EPSG:4326" } };
		status = can_be_degrees(&b)
					 ? find_by_system(cloud, &name, &b, to, error)
					 : gw_fail(error, GW_ERROR_DATA,
							   "x and y are to be degrees, but reach from %g to %g and %g to %g",
							   b.low[0], b.high[0], b.low[1], b.high[1]);
	} else {
		for (int k = 0; k < 3; k++)
			to->scale[k] = metres_of[unit];
		name_scale(to);
	}
	if (status != GW_OK)
		coordinates_clear(to);
	return status;
}

void coordinates_to_metres(const coordinates *c, double place[3])
{
	if (!c->projection) {
		for (int k = 0; k < 3; k++)
			place[k] *= c->scale[k];
		return;
	}
	PJ_COORD at = proj_trans(c->projection, PJ_FWD, proj_coord(place[0], place[1], 0, 0));
	place[0] = isfinite(place[0]) ? at.xy.x : place[0];
	place[1] = isfinite(place[1]) ? at.xy.y : place[1];
	place[2] *= c->scale[2];
}

void coordinates_from_metres(const coordinates *c, double place[3])
{
	if (!c->projection) {
		for (int k = 0; k < 3; k++)
			place[k] /= c->scale[k];
		return;
	}
	PJ_COORD at = proj_trans(c->projection, PJ_INV, proj_coord(place[0], place[1], 0, 0));
	place[0] = at.xy.x;
	place[1] = at.xy.y;
	place[2] /= c->scale[2];
}

/* coordinates.c - feet and degrees as metres; see coordinates.h. */
#include "units/coordinates.h"
#include "glowworm_host.h"

#include "files/plugin.h"
#include "las/las_notes.h"
#include "units/proj_system.h"

#include <math.h>
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
#define DEGREES_SYSTEM "EPSG:4326" /* of --units degrees */

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

void coordinates_short_name(double metres, char name[COORDINATES_NAME])
{
	snprintf(name, COORDINATES_NAME, "x %.9g m", metres);
	for (coordinates_unit unit = COORDINATES_M; unit < COORDINATES_DEGREES; unit++)
		if (fabs(metres_of[unit] - metres) < 1e-9 * metres)
			snprintf(name, COORDINATES_NAME, "%s", coordinates_unit_name(unit));
}

coordinates coordinates_metres(void)
{
	return (coordinates){ .scale = { 1, 1, 1 }, .name = "metres" };
}

void coordinates_clear(coordinates *c)
{
	if (c->system)
		c->proj->destroy(c->system);
	*c = coordinates_metres();
}

bool coordinates_agree(const coordinates *a, const coordinates *b)
{
	return memcmp(a->scale, b->scale, sizeof a->scale) == 0 && a->projected == b->projected;
}

/* ----------------------------------------------------------------------- what a file says */

/* A system that a file names, as PROJ takes it, and units that it gives beside it. */
typedef struct system_name {
	char *text;              /* owned, or NULL */
	double linear, vertical; /* metres; 0: not said */
	bool geographic;         /* keys name longitude and latitude */
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
	name->geographic = geographic && code == geographic;
	if (code == 0 || code == GEO_USER)
		return GW_OK;
	if (asprintf(&name->text, "EPSG:%u", code) < 0) {
		name->text = NULL;
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a coordinate system");
	}
	return GW_OK;
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

/* Lengths are right to one in a thousand within 200 km of the middle. */
static gw_status project(const bounds *b, coordinates *to, gw_error *error)
{
	double middle[2];
	for (int k = 0; k < 2; k++)
		middle[k] = round(50.0 * (b->low[k] + b->high[k])) / 100.0;
	to->projected = to->proj->project(to->system, middle);
	if (!to->projected)
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

static gw_status look_up(const char *name, coordinates *to, gw_error *error)
{
	const void *address = NULL;
	GW_TRY(plugin_find(PROJ_SYSTEM_FILE, PROJ_SYSTEM_SYMBOL, "coordinate systems need", &address,
					   error));
	to->proj = address;
	to->system = to->proj->create(name, to->scale);
	if (!to->system)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a coordinate system");
	return GW_OK;
}

/* Whether keys say no unit beside the system that it does not have itself. */
static bool has_those_units(const coordinates *c, const system_name *name)
{
	bool flat = !(name->linear > 0.0) || fabs(name->linear - c->scale[0]) < 1e-9;
	return flat && (!(name->vertical > 0.0) || fabs(name->vertical - c->scale[2]) < 1e-9);
}

static gw_status add_wkt(scan *cloud, const system_name *name, bool *missing, gw_error *error)
{
	gw_error ignored = { 0 };
	coordinates c = coordinates_metres();
	bool known = look_up(name->text, &c, &ignored) == GW_OK && has_those_units(&c, name);
	const char *wkt = known ? c.proj->wkt(c.system) : NULL;
	gw_status status = wkt ? las_note_text(cloud, "wkt", wkt, strlen(wkt), error) : GW_OK;
	*missing = !wkt;
	coordinates_clear(&c);
	return status;
}

gw_status coordinates_add_wkt(scan *cloud, bool *missing, gw_error *error)
{
	bool keys = false, wkt = false;
	system_name name = { 0 };
	for (size_t c = 0; c < cloud->comment_count; c++) {
		keys = keys || las_note_find(cloud->comment[c], "geokeys");
		wkt = wkt || las_note_find(cloud->comment[c], "wkt");
	}
	*missing = keys && !wkt;
	if (!*missing)
		return GW_OK;
	gw_status status = name_by_keys(cloud, &name, error);
	if (status == GW_OK && name.text)
		status = add_wkt(cloud, &name, missing, error);
	free(name.text);
	return status;
}

/* WKT of a projected system has the one that it is projected from in it. */
static bool is_geographic(const char *wkt)
{
	return !strstr(wkt, "PROJCS") && !strstr(wkt, "PROJCRS") &&
		   (strstr(wkt, "GEOGCS") || strstr(wkt, "GEOGCRS") || strstr(wkt, "GEODCRS"));
}

gw_status coordinates_say_degrees(const scan *cloud, const double low[3], const double high[3],
								  bool *degrees, gw_error *error)
{
	system_name wkt = { 0 }, keys = { 0 };
	bounds b = low && high ? (bounds){ { low[0], low[1], low[2] }, { high[0], high[1], high[2] } }
						   : find_bounds(cloud);
	gw_status status = las_note_join(cloud, "wkt", &wkt.text, error);
	if (status == GW_OK)
		status = name_by_keys(cloud, &keys, error);
	bool named = wkt.text && *wkt.text, silent = !named && !keys.text && !(keys.linear > 0.0);
	bool said = named ? is_geographic(wkt.text) : keys.geographic;
	*degrees = (said && can_be_degrees(&b)) || (silent && look_like_degrees(&b));
	free(wkt.text);
	free(keys.text);
	return status;
}

gw_status coordinates_try(gw_error *error)
{
	coordinates c = coordinates_metres();
	gw_status status = look_up(DEGREES_SYSTEM, &c, error);
	if (status == GW_OK && !c.proj->is_geographic(c.system))
		status = gw_fail(error, GW_ERROR_INTERNAL,
						 "PROJ knows no " DEGREES_SYSTEM " (is the package proj-data installed?)");
	coordinates_clear(&c);
	return status;
}

static gw_status refuse_degrees(const bounds *b, gw_error *error)
{
	return gw_fail(error, GW_ERROR_DATA,
				   "x and y look like degrees, %s to %s and %s to %s beside %s units of height; "
				   "--units degrees projects longitude and latitude, and --units m says that "
				   "they are metres",
				   GW_SAID_PLACE(b->low[0]), GW_SAID_PLACE(b->high[0]), GW_SAID_PLACE(b->low[1]),
				   GW_SAID_PLACE(b->high[1]), GW_SAID(b->high[2] - b->low[2], 6));
}

static gw_status note_no_units(scan *cloud, const bounds *b, gw_error *error)
{
	if (look_like_degrees(b))
		return refuse_degrees(b, error);
	return scan_add_comment(cloud,
							SCAN_NOTE "nobody knows the units of the coordinate system that its "
									  "header names; they are taken as metres, but for --units",
							error);
}

static gw_status find_by_system(scan *cloud, const system_name *name, const bounds *b,
								coordinates *to, gw_error *error)
{
	if (name->text)
		GW_TRY(look_up(name->text, to, error));
	if (to->system && to->proj->is_geographic(to->system)) {
		if (can_be_degrees(b))
			return project(b, to, error);
		GW_TRY(scan_add_comment(cloud,
								SCAN_NOTE "its header claims degrees, which its coordinates "
										  "cannot be; they are taken as metres, but for "
										  "--units",
								error));
	}
	if (to->system && !to->proj->has_units(to->system) && !(name->linear > 0.0))
		GW_TRY(note_no_units(cloud, b, error));
	if (name->linear > 0.0)
		to->scale[0] = to->scale[1] = to->scale[2] = name->linear;
	if (name->vertical > 0.0)
		to->scale[2] = name->vertical;
	name_scale(to);
	return GW_OK;
}

static gw_status find_by_file(scan *cloud, const bounds *b, coordinates *to, gw_error *error)
{
	system_name name = { 0 };
	gw_status status = las_note_join(cloud, "wkt", &name.text, error);
	if (name.text &&
		!name.text[strspn(name.text, " '\"")]) { /* an empty one, as some programs write it */
		free(name.text);
		name.text = NULL;
	}
	if (status == GW_OK && !name.text)
		status = name_by_keys(cloud, &name, error);
	bool named = name.text || name.linear > 0.0 || name.vertical > 0.0;
	if (status == GW_OK && named)
		status = find_by_system(cloud, &name, b, to, error);
	free(name.text);
	to->by_file = true;
	if (status == GW_OK && !named && look_like_degrees(b))
		return refuse_degrees(b, error);
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
		system_name name = { .text = (char[]){ DEGREES_SYSTEM } };
		status = can_be_degrees(&b)
					 ? find_by_system(cloud, &name, &b, to, error)
					 : gw_fail(error, GW_ERROR_DATA,
							   "x and y are to be degrees, but reach from %s to %s and %s to %s",
							   GW_SAID_PLACE(b.low[0]), GW_SAID_PLACE(b.high[0]),
							   GW_SAID_PLACE(b.low[1]), GW_SAID_PLACE(b.high[1]));
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
	if (!c->projected) {
		for (int k = 0; k < 3; k++)
			place[k] *= c->scale[k];
		return;
	}
	double at[2] = { place[0], place[1] };
	c->proj->move(c->system, false, at);
	for (int k = 0; k < 2; k++)
		place[k] = isfinite(place[k]) ? at[k] : place[k];
	place[2] *= c->scale[2];
}

void coordinates_from_metres(const coordinates *c, double place[3])
{
	if (!c->projected) {
		for (int k = 0; k < 3; k++)
			place[k] /= c->scale[k];
		return;
	}
	c->proj->move(c->system, true, place);
	place[2] /= c->scale[2];
}

/*
 * coordinates.h - from the coordinates of a file to metres and back. Light needs metres; what is
 * written keeps the file's coordinates.
 */
#ifndef COORDINATES_H
#define COORDINATES_H

#include "points/scan.h"

/* What coordinates are in, as somebody says it. */
typedef enum coordinates_unit {
	COORDINATES_AUTO, /* as the file says, else metres */
	COORDINATES_M,
	COORDINATES_MM,
	COORDINATES_CM,
	COORDINATES_KM,
	COORDINATES_IN,
	COORDINATES_FT,
	COORDINATES_US_FT,
	COORDINATES_DEGREES, /* longitude and latitude (WGS 84), and metres of height */
	COORDINATES_UNIT_COUNT
} coordinates_unit;

/* "us-ft"; the names of all, in order. */
const char *coordinates_unit_name(coordinates_unit unit);

/* A unit of so many metres as it stands behind a number: "ft", or "x 0.3 m" if it has no name. */
#define COORDINATES_NAME 32
void coordinates_short_name(double metres, char name[COORDINATES_NAME]);

typedef struct coordinates {
	double scale[3];                   /* metres of one of them; not of degrees */
	const struct proj_functions *proj; /* with what the system is looked up, or NULL */
	struct proj_system *system;        /* owned: the system that a name stands for, or NULL */
	bool projected;                    /* they are degrees, which `system` takes to metres */
	char name[120];                    /* a phrase for messages: "feet (0.3048 m)" */
	bool changes;                      /* they are not metres */
	bool by_file;                      /* who says so */
} coordinates;

/* Coordinates that are metres. */
coordinates coordinates_metres(void);

/*
 * Finds out what the coordinates of a cloud are in: by `unit`, else by the WKT or GeoTIFF keys that
 * its file had (las_notes.h), unless the coordinates cannot be degrees that these claim, which
 * becomes a note of the scan.
 *   to   on success freed with coordinates_clear; metres on failure
 * GW_ERROR_DATA, without the file's name, when nothing says so and they look like degrees, or PROJ
 * has no way to project them; GW_ERROR_INTERNAL where the plugin for PROJ is missing;
 * GW_ERROR_MEMORY.
 */
gw_status coordinates_find(scan *cloud, coordinates_unit unit, coordinates *to, gw_error *error);
void coordinates_clear(coordinates *c);

/* To a scan of whose coordinate system GeoTIFF keys alone tell adds it as WKT (las_notes.h), where
 * PROJ knows it and it counts in the units that the keys say.
 *   missing   receives whether there are keys, but no WKT after all
 * GW_ERROR_MEMORY. */
gw_status coordinates_add_wkt(scan *cloud, bool *missing, gw_error *error);

/* Whether x and y of a scan are degrees: the WKT or GeoTIFF keys that its file had say so, and they
 * can be; or nothing says what they are, and they look like degrees. GW_ERROR_MEMORY.
 *   low, high   of its finite coordinates; NULL: those of the scan, which has all of them */
gw_status coordinates_say_degrees(const scan *cloud, const double low[3], const double high[3],
								  bool *degrees, gw_error *error);

/* Sees that systems which files name can be looked up. GW_ERROR_INTERNAL where the plugin or PROJ's
 * data is missing; GW_ERROR_MEMORY. */
gw_status coordinates_try(gw_error *error);

/* Whether two clouds' coordinates are of the same kind. */
bool coordinates_agree(const coordinates *a, const coordinates *b);

/* Turns a place into metres, and back. */
void coordinates_to_metres(const coordinates *c, double place[3]);
void coordinates_from_metres(const coordinates *c, double place[3]);

#endif

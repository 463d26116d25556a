/*
 * proj_system.h - coordinate systems that files name, by PROJ. PROJ takes thirty-seven libraries
 * and 6 ms to load, so that this is a shared object of its own, opened when a file names a system.
 */
#ifndef PROJ_SYSTEM_H
#define PROJ_SYSTEM_H

#include <stdbool.h>

/* What a name stands for. */
typedef struct proj_system proj_system;

/* What the shared object can do, in the order of use. */
typedef struct proj_functions {
	/*
	 * Looks a system up, and in what units it counts.
	 *   name    "EPSG:2992" or WKT, or one that PROJ does not know
	 *   scale   becomes metres of a unit along x, y and z; 1 where that is an angle or not known
	 * NULL without memory. What it gives ends with `destroy`.
	 */
	proj_system *(*create)(const char *name, double scale[3]);

	/* Whether that is known of x and y; not of a name that PROJ does not know. */
	bool (*has_units)(const proj_system *system);

	/* Whether x and y are longitude and latitude. */
	bool (*is_geographic)(const proj_system *system);

	/* Makes `move` project degrees of such a system to metres around a place; false: no way. */
	bool (*project)(proj_system *system, const double middle[2]);

	/* Degrees to metres, or back; what cannot be projected becomes infinite. */
	void (*move)(const proj_system *system, bool back, double place[2]);

	void (*destroy)(proj_system *system);

	/* The system as WKT 1 in one line, or NULL: PROJ does not know it, or it has none. Valid as
	 * long as the system. */
	const char *(*wkt)(const proj_system *system);
} proj_functions;

/* The one symbol of the shared object: a constant proj_functions. */
#define PROJ_SYSTEM_FILE "libglowworm-proj.so"
#define PROJ_SYSTEM_SYMBOL "proj_system_functions"

#endif

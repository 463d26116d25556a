/* proj_system.c - a shared object by itself: coordinate systems by PROJ; see proj_system.h. */
#include "units/proj_system.h"

#include <math.h>
#include <proj.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct proj_system {
	PJ_CONTEXT *context;
	PJ *system;     /* the part that lies flat; NULL: a name that PROJ does not know */
	PJ *projection; /* of degrees, to metres; NULL: not asked for */
};

static void destroy(proj_system *s)
{
	if (!s)
		return;
	proj_destroy(s->projection);
	proj_destroy(s->system);
	if (s->context)
		proj_context_destroy(s->context);
	free(s);
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

static bool is_geographic(const proj_system *s)
{
	PJ_TYPE type = s->system ? proj_get_type(s->system) : PJ_TYPE_UNKNOWN;
	return type == PJ_TYPE_GEOGRAPHIC_2D_CRS || type == PJ_TYPE_GEOGRAPHIC_3D_CRS;
}

/* The units of a system: its parts are replaced by the one that lies flat. */
static void take_units(proj_system *s, double scale[3])
{
	double height = 0.0;
	if (s->system && proj_get_type(s->system) == PJ_TYPE_COMPOUND_CRS) {
		PJ *upright = proj_crs_get_sub_crs(s->context, s->system, 1);
		height = axis_unit(s->context, upright, 0);
		proj_destroy(upright);
		PJ *flat = proj_crs_get_sub_crs(s->context, s->system, 0);
		proj_destroy(s->system);
		s->system = flat;
	}
	if (s->system && proj_get_type(s->system) == PJ_TYPE_BOUND_CRS) {
		PJ *source = proj_get_source_crs(s->context, s->system);
		proj_destroy(s->system);
		s->system = source;
	}
	double flat = is_geographic(s) ? 0.0 : axis_unit(s->context, s->system, 0);
	scale[0] = scale[1] = flat > 0.0 ? flat : 1.0;
	scale[2] = height > 0.0 ? height : scale[0];
}

/* Does anybody know in what a system counts? */
static bool has_units(const proj_system *s)
{
	return is_geographic(s) || axis_unit(s->context, s->system, 0) > 0.0;
}

static proj_system *create(const char *name, double scale[3])
{
	proj_system *s = calloc(1, sizeof *s);
	if (s)
		s->context = proj_context_create();
	if (!s || !s->context) {
		destroy(s);
		return NULL;
	}
	proj_log_level(s->context, PJ_LOG_NONE);
	s->system = proj_create(s->context, name);
	take_units(s, scale);
	return s;
}

/* Lengths are right to one in a thousand within 200 km. */
static bool project(proj_system *s, const double middle[2])
{
	char local[160];
	snprintf(local, sizeof local,
			 "+proj=tmerc +lat_0=%.2f +lon_0=%.2f +datum=WGS84 +units=m +type=crs", middle[1],
			 middle[0]);
	PJ *target = proj_create(s->context, local), *whole = NULL;
	if (target)
		whole = proj_create_crs_to_crs_from_pj(s->context, s->system, target, NULL, NULL);
	if (whole)
		s->projection = proj_normalize_for_visualization(s->context, whole);
	proj_destroy(target);
	proj_destroy(whole);
	return s->projection != NULL;
}

static void move(const proj_system *s, bool back, double place[2])
{
	PJ_COORD at =
		proj_trans(s->projection, back ? PJ_INV : PJ_FWD, proj_coord(place[0], place[1], 0, 0));
	place[0] = at.xy.x;
	place[1] = at.xy.y;
}

static const char *wkt(const proj_system *s)
{
	static const char *const one_line[] = { "MULTILINE=NO", NULL };
	return s->system ? proj_as_wkt(s->context, s->system, PJ_WKT1_GDAL, one_line) : NULL;
}

extern const proj_functions proj_system_functions;
const proj_functions proj_system_functions = { create,  has_units, is_geographic, project, move,
											   destroy, wkt };

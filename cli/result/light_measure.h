/*
 * light_measure.h - light on a piece of surface in a few figures, as those who plan light read it:
 * mean, least, most, how even it is, and which lamp gives how much.
 *
 * Every point counts by the area of surface that it stands for, so that a mean does not depend on
 * how densely a place was scanned; strays count nothing. Uniformity is the least over the mean and
 * the least over the most (U0 and Ud of EN 12464-1).
 */
#ifndef LIGHT_MEASURE_H
#define LIGHT_MEASURE_H

#include "scene/loaded_scene.h"

/* Where to measure: in a box, or near a path; without both, everywhere. Metres. */
typedef struct measure_region {
	bool has_box;
	double low[3], high[3];
	double *place; /* owned; 3 * place_count, corners of the path */
	size_t place_count;
	double reach; /* from the path */
} measure_region;

/* What one lamp gives of the radiance there. */
typedef struct measure_lamp {
	char *name;   /* owned */
	double share; /* 0..1 */
} measure_lamp;

typedef struct light_measure {
	const char *quantity, *unit;
	size_t points;
	double area; /* m^2 */
	double mean, least, most;
	measure_lamp *lamp; /* owned; lamp_count; none without columns of lamps */
	size_t lamp_count;
	measure_lamp *group; /* owned; group_count: those of lamps of which the columns name a group */
	size_t group_count;
} light_measure;

/*
 * A region from text; NULL where none is given.
 *   box    "X,Y,Z,X,Y,Z": two opposite corners
 *   path   "X,Y,Z X,Y,Z ...": its corners, one at least
 *   region on success to be freed with measure_region_clear
 * GW_ERROR_USAGE with a sentence.
 */
gw_status measure_region_read(const char *box, const char *path, double reach,
							  measure_region *region, gw_error *error);
void measure_region_clear(measure_region *region);

/*
 * Measures the illuminance of a lit cloud where it has one, else its irradiance, else the luminance
 * or radiance that it sends out.
 *   measure   on success to be freed with light_measure_clear
 * GW_ERROR_DATA when the cloud has none of these, or no point in the region.
 */
gw_status light_measure_make(const settings *s, const loaded_scene *scene,
							 const measure_region *region, light_measure *measure, gw_error *error);
void light_measure_clear(light_measure *measure);

#endif

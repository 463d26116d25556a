/*
 * sky_model.h - skies that have names: how bright each part of them is, as a map.
 */
#ifndef SKY_MODEL_H
#define SKY_MODEL_H

#include "panoramas/panorama.h"

typedef enum sky_model {
	SKY_MODEL_NONE,
	SKY_MODEL_OVERCAST,     /* CIE standard overcast sky: L = zenith * (1 + 2 sin elevation) / 3 */
	SKY_MODEL_INTERMEDIATE, /* CIE standard general sky 7: partly cloudy, bright about the sun */
	SKY_MODEL_CLEAR,        /* CIE standard general sky 12, the CIE standard clear sky */
	SKY_MODEL_PHYSICAL,     /* clear sky by turbidity, with its colours, in cd/m^2 */
	SKY_MODEL_GRADIENT,     /* from one colour at the horizon to another one overhead */
	SKY_MODEL_COUNT
} sky_model;

/* What the turbidity of a physical sky may be: very clear to hazy, for which it was fitted. */
#define SKY_TURBIDITY_LEAST 2.0
#define SKY_TURBIDITY_MOST 10.0

typedef struct sky_description {
	sky_model model;
	double azimuth, elevation; /* of the sun, degrees: clockwise from the map's centre, above the
								  horizon; for models that sky_model_has_sun */
	double turbidity;          /* of a physical sky */
	float zenith[3];           /* colours of a gradient */
	float horizon[3];
} sky_description;

/* Its name on the command line; NULL behind the last. SKY_MODEL_NONE has none. */
const char *sky_model_name(int model);

/* Whether it depends on where the sun is. */
bool sky_model_has_sun(sky_model model);

/*
 * Radiance of a direction above the horizon.
 *   elevation  degrees, 0..90
 *   from_sun   degrees between the direction and the sun
 *   rgb        receives linear RGB. CIE skies: white, 1 overhead. Physical: cd/m^2, of which
 * colours that a screen does not have are cut. Gradient: linear in the sine of the elevation
 * Sources: ISO 15469:2004 (CIE S 011/E:2003); A. J. Preetham, P. Shirley, B. Smits: A Practical
 * Analytic Model for Daylight, 1999, appendix A.2.
 */
void sky_model_radiance(const sky_description *sky, double elevation, double from_sun,
						float rgb[3]);

/* Makes the map of a sky, black below the horizon. map: on success the caller's, freed with
 * panorama_clear. GW_ERROR_MEMORY. */
gw_status sky_model_map(const sky_description *sky, panorama *map, gw_error *error);

/* What the upper half of a map sends onto level ground: the sum over its luminance, solid angle and
 * sine of elevation. */
double sky_map_illuminance(const panorama *map);

#endif

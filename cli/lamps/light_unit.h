/*
 * light_unit.h - units behind numbers of lamps (40cd, 400lm, 10000lx), and the colour of what
 * glows.
 *
 * Radiometric and photometric units are never converted into each other: 683 lm/W, the luminous
 * efficacy of radiation by definition of the candela, holds for light of 540 THz alone, and what
 * it is for a lamp its spectrum decides. All lights of a scene have to be of one kind.
 */
#ifndef LIGHT_UNIT_H
#define LIGHT_UNIT_H

#include "glowworm.h"

/* What a lamp's numbers are said to be. */
typedef enum light_units {
	LIGHT_UNITS_UNSAID,
	LIGHT_UNITS_RADIOMETRIC, /* W, W/sr, W/m^2 */
	LIGHT_UNITS_PHOTOMETRIC, /* lm, cd, lx, cd/m^2 */
} light_units;

/* Quantities that have units. */
typedef enum light_quantity {
	LIGHT_QUANTITY_INTENSITY,  /* W/sr, cd */
	LIGHT_QUANTITY_FLUX,       /* W, lm */
	LIGHT_QUANTITY_IRRADIANCE, /* W/m^2, lx */
	LIGHT_QUANTITY_RADIANCE,   /* W/(sr m^2), cd/m^2 */
	LIGHT_QUANTITY_COUNT
} light_quantity;

/*
 * Cuts the unit off the end of a word: "40cd" becomes "40".
 *   word   changed in place where a unit of the quantity stands there
 *   units  receives what kind it is; LIGHT_UNITS_UNSAID without one
 * GW_ERROR_USAGE with a phrase when letters stand there that are no unit of this quantity.
 */
gw_status light_unit_cut(char *word, light_quantity quantity, light_units *units, gw_error *error);

/* The unit in which a quantity is written; "" when unsaid. */
const char *light_unit_name(light_quantity quantity, light_units units);

/* What colour temperatures may be. */
#define KELVIN_LEAST 1000.0
#define KELVIN_MOST 40000.0

/*
 * Linear RGB of a black body of that temperature, of luminance 1, so that lumens stay what they
 * are; what Rec. 709 does not have (blue below 0 under 1,900 K) is 0.
 * Sources: Planck's law, and the CIE 1931 observer after C. Wyman, P.-P. Sloan, P. Shirley, Simple
 * Analytic Approximations to the CIE XYZ Color Matching Functions, JCGT 2(2), 2013.
 */
void kelvin_color(double kelvin, double rgb[3]);

#endif

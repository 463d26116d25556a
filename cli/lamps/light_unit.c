#include "lamps/light_unit.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

typedef struct unit_name {
	const char *text;
	light_quantity quantity;
	light_units units;
} unit_name;

/* The first of each kind is the one that is written. */
static const unit_name names[] = {
	{ "cd", LIGHT_QUANTITY_INTENSITY, LIGHT_UNITS_PHOTOMETRIC },
	{ "W/sr", LIGHT_QUANTITY_INTENSITY, LIGHT_UNITS_RADIOMETRIC },
	{ "lm", LIGHT_QUANTITY_FLUX, LIGHT_UNITS_PHOTOMETRIC },
	{ "W", LIGHT_QUANTITY_FLUX, LIGHT_UNITS_RADIOMETRIC },
	{ "lx", LIGHT_QUANTITY_IRRADIANCE, LIGHT_UNITS_PHOTOMETRIC },
	{ "W/m^2", LIGHT_QUANTITY_IRRADIANCE, LIGHT_UNITS_RADIOMETRIC },
	{ "W/m2", LIGHT_QUANTITY_IRRADIANCE, LIGHT_UNITS_RADIOMETRIC },
	{ "cd/m^2", LIGHT_QUANTITY_RADIANCE, LIGHT_UNITS_PHOTOMETRIC },
	{ "cd/m2", LIGHT_QUANTITY_RADIANCE, LIGHT_UNITS_PHOTOMETRIC },
	{ "W/sr/m^2", LIGHT_QUANTITY_RADIANCE, LIGHT_UNITS_RADIOMETRIC },
	{ "W/sr/m2", LIGHT_QUANTITY_RADIANCE, LIGHT_UNITS_RADIOMETRIC },
};
#define NAMES (sizeof names / sizeof *names)

const char *light_unit_name(light_quantity quantity, light_units units)
{
	for (size_t i = 0; i < NAMES; i++)
		if (names[i].quantity == quantity && names[i].units == units)
			return names[i].text;
	return "";
}

/* Where the number ends: at the first letter that is no exponent between digits. */
static size_t number_length(const char *word)
{
	size_t i = 0;
	while (word[i] && (!isalpha((unsigned char)word[i]) ||
					   ((word[i] == 'e' || word[i] == 'E') && i > 0 &&
						strchr("+-.0123456789", word[i + 1]) && word[i + 1])))
		i++;
	return i;
}

gw_status light_unit_cut(char *word, light_quantity quantity, light_units *units, gw_error *error)
{
	size_t length = number_length(word);
	*units = LIGHT_UNITS_UNSAID;
	if (length == 0 || !word[length]) /* "inf" and what is no number at all is refused as such */
		return GW_OK;
	for (size_t i = 0; i < NAMES; i++)
		if (names[i].quantity == quantity && strcmp(word + length, names[i].text) == 0) {
			*units = names[i].units;
			word[length] = '\0';
			return GW_OK;
		}
	return gw_fail(error, GW_ERROR_USAGE, "'%.20s' is no unit of it; it is in %s or %s",
				   word + length, light_unit_name(quantity, LIGHT_UNITS_PHOTOMETRIC),
				   light_unit_name(quantity, LIGHT_UNITS_RADIOMETRIC));
}

/* ------------------------------------------------------------------------------ what glows */

/* A bell with a width to either side of its middle; nanometres. */
static double bell(double x, double middle, double left, double right)
{
	double t = (x - middle) * (x < middle ? left : right);
	return exp(-0.5 * t * t);
}

static void observer(double nanometres, double xyz[3])
{
	double w = nanometres;
	xyz[0] = 1.056 * bell(w, 599.8, 0.0264, 0.0323) + 0.362 * bell(w, 442.0, 0.0624, 0.0374) -
			 0.065 * bell(w, 501.1, 0.0490, 0.0382);
	xyz[1] = 0.821 * bell(w, 568.8, 0.0213, 0.0247) + 0.286 * bell(w, 530.9, 0.0613, 0.0322);
	xyz[2] = 1.217 * bell(w, 437.0, 0.0845, 0.0278) + 0.681 * bell(w, 459.0, 0.0385, 0.0725);
}

void kelvin_color(double kelvin, double rgb[3])
{
	const double second_radiation = 1.438776877e7; /* nm K */
	double sum[3] = { 0 }, xyz[3];
	for (double w = 380.0; w <= 780.0; w += 5.0) {
		/* Planck's law relative to what it is at 560 nm, so that nothing overflows. */
		double planck = pow(560.0 / w, 5.0) * (exp(second_radiation / (560.0 * kelvin)) - 1.0) /
						(exp(second_radiation / (w * kelvin)) - 1.0);
		observer(w, xyz);
		for (int k = 0; k < 3; k++)
			sum[k] += planck * xyz[k];
	}
	double x = sum[0] / sum[1], z = sum[2] / sum[1];
	rgb[0] = fmax(3.2406 * x - 1.5372 - 0.4986 * z, 0.0);
	rgb[1] = fmax(-0.9689 * x + 1.8758 + 0.0415 * z, 0.0);
	rgb[2] = fmax(0.0557 * x - 0.2040 + 1.0570 * z, 0.0);
	double luminance = gw_relative_luminance(rgb[0], rgb[1], rgb[2]);
	for (int k = 0; k < 3; k++)
		rgb[k] /= luminance;
}

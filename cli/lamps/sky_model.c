#include "lamps/sky_model.h"

#include <math.h>
#include <stdlib.h>

#define PI 3.14159265358979323846
#define DEGREE (PI / 180.0)
#define MAP_WIDTH 1024u /* pixels; a third of a degree, in which no sky changes by much */

const char *sky_model_name(int model)
{
	static const char *const name[SKY_MODEL_COUNT] = {
		[SKY_MODEL_NONE] = "",
		[SKY_MODEL_OVERCAST] = "overcast",
		[SKY_MODEL_INTERMEDIATE] = "intermediate",
		[SKY_MODEL_CLEAR] = "clear",
		[SKY_MODEL_PHYSICAL] = "physical",
		[SKY_MODEL_GRADIENT] = "gradient",
	};
	return model < SKY_MODEL_COUNT ? name[model] : NULL;
}

bool sky_model_has_sun(sky_model model)
{
	return model == SKY_MODEL_INTERMEDIATE || model == SKY_MODEL_CLEAR ||
		   model == SKY_MODEL_PHYSICAL;
}

/* --------------------------------------------------------------------------- two formulas */

/* CIE standard general sky: gradation by a, b and indicatrix by c, d, e. */
typedef struct general_sky {
	double a, b, c, d, e;
} general_sky;

static double gradation(const general_sky *s, double zenith_angle)
{
	double cosine = cos(zenith_angle);
	return 1.0 + (cosine > 1e-6 ? s->a * exp(s->b / cosine) : 0.0);
}

static double indicatrix(const general_sky *s, double angle)
{
	return 1.0 + s->c * (exp(s->d * angle) - exp(s->d * PI / 2.0)) + s->e * cos(angle) * cos(angle);
}

static double general_luminance(const general_sky *s, double zenith_angle, double from_sun,
								double sun_zenith)
{
	return gradation(s, zenith_angle) * indicatrix(s, from_sun) /
		   (gradation(s, 0.0) * indicatrix(s, sun_zenith));
}

/* Perez' five factors of the three quantities Y, x, y are linear in the turbidity. */
static const double perez_slope[3][5] = { { 0.1787, -0.3554, -0.0227, 0.1206, -0.0670 },
										  { -0.0193, -0.0665, -0.0004, -0.0641, -0.0033 },
										  { -0.0167, -0.0950, -0.0079, -0.0441, -0.0109 } };
static const double perez_level[3][5] = { { -1.4630, 0.4275, 5.3251, -2.5771, 0.3703 },
										  { -0.2592, 0.0008, 0.2125, -0.8989, 0.0452 },
										  { -0.2608, 0.0092, 0.2102, -1.6537, 0.0529 } };

static double perez(const double f[5], double cosine, double angle)
{
	return (1.0 + f[0] * exp(f[1] / fmax(cosine, 1e-3))) *
		   (1.0 + f[2] * exp(f[3] * angle) + f[4] * cos(angle) * cos(angle));
}

/* Luminance, kcd/m^2, and chromaticity overhead. */
static void zenith_values(double turbidity, double sun_zenith, double value[3])
{
	static const double chroma[2][3][4] = {
		{ { 0.00166, -0.00375, 0.00209, 0.0 },
		  { -0.02903, 0.06377, -0.03202, 0.00394 },
		  { 0.11693, -0.21196, 0.06052, 0.25886 } },
		{ { 0.00275, -0.00610, 0.00317, 0.0 },
		  { -0.04214, 0.08970, -0.04153, 0.00516 },
		  { 0.15346, -0.26756, 0.06670, 0.26688 } },
	};
	double t = turbidity, angle = sun_zenith;
	value[0] = (4.0453 * t - 4.9710) * tan((4.0 / 9.0 - t / 120.0) * (PI - 2.0 * angle)) -
			   0.2155 * t + 2.4192;
	for (int k = 0; k < 2; k++) {
		value[k + 1] = 0.0;
		for (int row = 0; row < 3; row++) {
			const double *m = chroma[k][row];
			double cubic = ((m[0] * angle + m[1]) * angle + m[2]) * angle + m[3];
			value[k + 1] = value[k + 1] * t + cubic;
		}
	}
}

static void physical_radiance(const sky_description *sky, double zenith_angle, double from_sun,
							  float rgb[3])
{
	double sun_zenith = (90.0 - sky->elevation) * DEGREE, value[3], f[5];
	zenith_values(sky->turbidity, sun_zenith, value);
	for (int k = 0; k < 3; k++) {
		for (int i = 0; i < 5; i++)
			f[i] = perez_slope[k][i] * sky->turbidity + perez_level[k][i];
		value[k] *= perez(f, cos(zenith_angle), from_sun) / perez(f, 1.0, sun_zenith);
	}
	/* CIE xyY to XYZ to linear RGB of Rec. 709 (IEC 61966-2-1). */
	double luminance = fmax(1000.0 * value[0], 0.0);
	double x = luminance * value[1] / value[2], y = luminance;
	double z = luminance * (1.0 - value[1] - value[2]) / value[2];
	rgb[0] = (float)fmax(3.2406 * x - 1.5372 * y - 0.4986 * z, 0.0);
	rgb[1] = (float)fmax(-0.9689 * x + 1.8758 * y + 0.0415 * z, 0.0);
	rgb[2] = (float)fmax(0.0557 * x - 0.2040 * y + 1.0570 * z, 0.0);
}

/* ----------------------------------------------------------------------------- whole skies */

static double white_radiance(const sky_description *sky, double zenith_angle, double from_sun)
{
	static const general_sky partly_cloudy = { 0.0, -1.0, 5.0, -2.5, 0.30 };
	static const general_sky clear = { -1.0, -0.32, 10.0, -3.0, 0.45 };
	double sun_zenith = (90.0 - sky->elevation) * DEGREE;
	if (sky->model == SKY_MODEL_OVERCAST)
		return (1.0 + 2.0 * cos(zenith_angle)) / 3.0;
	return general_luminance(sky->model == SKY_MODEL_CLEAR ? &clear : &partly_cloudy, zenith_angle,
							 from_sun, sun_zenith);
}

void sky_model_radiance(const sky_description *sky, double elevation, double from_sun, float rgb[3])
{
	double zenith_angle = (90.0 - elevation) * DEGREE;
	if (sky->model == SKY_MODEL_PHYSICAL) {
		physical_radiance(sky, zenith_angle, from_sun * DEGREE, rgb);
	} else if (sky->model == SKY_MODEL_GRADIENT) {
		for (int c = 0; c < 3; c++)
			rgb[c] =
				sky->horizon[c] + (sky->zenith[c] - sky->horizon[c]) * (float)cos(zenith_angle);
	} else {
		rgb[0] = rgb[1] = rgb[2] = (float)white_radiance(sky, zenith_angle, from_sun * DEGREE);
	}
}

/* Degrees between two directions given by azimuth and elevation. */
static double angle_between(double azimuth_a, double elevation_a, double azimuth_b,
							double elevation_b)
{
	double a = elevation_a * DEGREE, b = elevation_b * DEGREE;
	double cosine = sin(a) * sin(b) + cos(a) * cos(b) * cos((azimuth_a - azimuth_b) * DEGREE);
	return acos(fmin(fmax(cosine, -1.0), 1.0)) / DEGREE;
}

/* Elevation of the middle of a row. */
static double row_elevation(const panorama *map, uint32_t row)
{
	return 90.0 - 180.0 * ((double)row + 0.5) / (double)map->height;
}

gw_status sky_model_map(const sky_description *sky, panorama *map, gw_error *error)
{
	*map = (panorama){ .width = MAP_WIDTH, .height = MAP_WIDTH / 2 };
	map->pixels = calloc((size_t)map->width * map->height, 3 * sizeof *map->pixels);
	if (!map->pixels) {
		*map = (panorama){ 0 };
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the map of a sky");
	}
	for (uint32_t row = 0; row < map->height / 2; row++) {
		double elevation = row_elevation(map, row);
		for (uint32_t column = 0; column < map->width; column++) {
			double azimuth = 360.0 * ((double)column + 0.5) / (double)map->width - 180.0;
			double from_sun = angle_between(azimuth, elevation, sky->azimuth, sky->elevation);
			float *pixel = map->pixels + 3 * ((size_t)row * map->width + column);
			sky_model_radiance(sky, elevation, from_sun, pixel);
		}
	}
	return GW_OK;
}

double sky_map_illuminance(const panorama *map)
{
	double sum = 0.0, band = PI / (double)map->height;
	for (uint32_t row = 0; row < map->height / 2; row++) {
		double luminance = 0.0, top = (double)row * band;
		for (uint32_t column = 0; column < map->width; column++) {
			const float *pixel = map->pixels + 3 * ((size_t)row * map->width + column);
			luminance +=
				gw_relative_luminance((double)pixel[0], (double)pixel[1], (double)pixel[2]);
		}
		/* The integral of sine times cosine of the angle from the zenith over the row's band. */
		double weight = 0.5 * (pow(sin(top + band), 2.0) - pow(sin(top), 2.0));
		sum += luminance * weight * 2.0 * PI / (double)map->width;
	}
	return sum;
}

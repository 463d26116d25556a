/* What lamps say: the sun by place and time, skies, units and colour temperatures. */
#include "lamps/light_preset.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define PI 3.14159265358979323846

static void assert_near(double a, double b, double tolerance)
{
	if (!(fabs(a - b) <= tolerance))
		fail_msg("%.12g is not %.12g to %g", a, b, tolerance);
}

static void find_sun(double latitude, double longitude, const char *time, double seen[2])
{
	gw_error error = { 0 };
	sun_moment moment = { .latitude = latitude, .longitude = longitude };
	if (sun_time_read(time, &moment.seconds, &error) != GW_OK)
		fail_msg("%s: %s", time, error.text);
	sun_position(&moment, &seen[0], &seen[1]);
}

/* ------------------------------------------------------------------------------------ the sun */

/*
 * The example of I. Reda and A. Andreas, Solar Position Algorithm for Solar Radiation Applications,
 * NREL/TP-560-34302, table A5.1: azimuth 194.34024, zenith angle 50.11162 degrees in air of 820 hPa
 * and 11 degrees Celsius, which lifts the sun by 0.0163 degrees where ours lifts it by 0.0193. The
 * header promises 0.01 degrees.
 */
static void test_published_sun(void **state)
{
	(void)state;
	double seen[2];
	find_sun(39.742476, -105.1786, "2003-10-17T12:30:30-07:00", seen);
	assert_near(seen[0], 194.34024, 0.01);
	assert_near(90.0 - seen[1] - 50.11162, 0.0163 - 0.0193, 0.01);
}

/* At the pole the sun stands as high as its declination, which at a solstice is the obliquity of
 * the ecliptic: 23.436 degrees in 2026; the air lifts it by 0.037 there, parallax lowers it by
 * 0.002. The solstice was at 08:24 UTC on the 21st of June (almanacs: IMCCE, USNO). */
static void test_solstice(void **state)
{
	(void)state;
	double seen[2];
	find_sun(90.0, 0.0, "2026-06-21T08:24Z", seen);
	assert_near(seen[1], 23.436 + 0.037 - 0.002, 0.01);
}

/* On the equator at an equinox the sun passes overhead, within the 15 degrees an hour that it
 * moves, and stands in the east before noon. */
static void test_equinox(void **state)
{
	(void)state;
	double morning[2], evening[2];
	find_sun(0.0, 0.0, "2026-03-20T09:00Z", morning);
	find_sun(0.0, 0.0, "2026-03-20T15:00Z", evening);
	assert_near(morning[0], 90.0, 0.5);
	assert_near(evening[0], 270.0, 0.5);
	/* Noon is 7.5 minutes late by the equation of time, so that the morning's is lower by twice. */
	assert_near(evening[1] - morning[1], 2.0 * 7.5 * 0.25, 0.1);
}

static void test_times(void **state)
{
	(void)state;
	static const struct {
		const char *text;
		double seconds;
	} good[] = {
		{ "1970-01-01T00:00Z", 0 },
		{ "2000-03-01T00:00:01Z", 951868801 },
		{ "2026-06-21T14:30+02:00", 1782045000 },
		{ "2024-02-29T23:59:59-09:30", 1709285399 },
		{ "1901-01-01T00:00Z", -2177452800 },
		{ "2099-12-31T23:59Z", 4102444740 },
	};
	static const char *const bad[] = { "",
									   "noon",
									   "2026-06-21",
									   "2026-06-21T14:30",
									   "2026-06-21T14:30+2:00",
									   "2026-06-21T14:30+15:00",
									   "2025-02-29T12:00Z",
									   "2026-13-01T12:00Z",
									   "2026-00-01T12:00Z",
									   "2026-01-01T24:00Z",
									   "1900-01-01T00:00Z",
									   "2100-01-01T00:00Z",
									   "2026-01-01T12:00Zx",
									   "2026-01-01 12:00Z" };
	double seconds;
	gw_error error;
	for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
		assert_int_equal(sun_time_read(good[i].text, &seconds, &error), GW_OK);
		assert_near(seconds, good[i].seconds, 0);
	}
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
		assert_int_equal(sun_time_read(bad[i], &seconds, &error), GW_ERROR_USAGE);
}

/* ------------------------------------------------------------------------------------- skies */

static panorama make_sky(sky_model model, double elevation)
{
	panorama map;
	gw_error error;
	sky_description sky = { .model = model, .azimuth = 30, .elevation = elevation, .turbidity = 3 };
	assert_int_equal(sky_model_map(&sky, &map, &error), GW_OK);
	return map;
}

/* What a wall that looks along azimuth 0 gets of the sky's green. */
static double on_wall(const panorama *map)
{
	double sum = 0.0, band = PI / map->height, sector = 2.0 * PI / map->width;
	for (uint32_t row = 0; row < map->height / 2; row++)
		for (uint32_t column = 0; column < map->width; column++) {
			double elevation = PI / 2 - (row + 0.5) * band;
			double toward = cos(elevation) * cos((column + 0.5) * sector - PI);
			double green = (double)map->pixels[3 * ((size_t)row * map->width + column) + 1];
			sum += fmax(toward, 0.0) * green * cos(elevation) * band * sector;
		}
	return sum;
}

/* Of the overcast sky both have closed forms: 7 pi / 9 times the radiance overhead on the ground,
 * and 0.396 of that on a wall (P. Moon, D. Spencer, Illumination from a non-uniform sky, 1942). The
 * middle of a pixel is off by the square of its size, (pi / 512)^2 / 24. */
static void test_overcast(void **state)
{
	(void)state;
	panorama map = make_sky(SKY_MODEL_OVERCAST, 40);
	double ground = sky_map_illuminance(&map);
	assert_near(ground, 7.0 * PI / 9.0, 1e-5);
	assert_near(on_wall(&map) / ground, 0.396, 0.0005);
	panorama_clear(&map);
}

/* By ISO 15469 the general sky is 1 overhead whatever the sun, and at the sun's own place the ratio
 * of its two functions; type 12 with the sun at 45 degrees: gradation 1 - exp(-0.32 / cos 45) over
 * 1 - exp(-0.32), indicatrix 1 + 10 (1 - exp(-3 pi / 2)) + 0.45 over that at 45 degrees. */
static void test_clear_sky(void **state)
{
	(void)state;
	float overhead[3], at_sun[3];
	sky_description sky = { .model = SKY_MODEL_CLEAR, .elevation = 45 };
	sky_model_radiance(&sky, 90, 45, overhead);
	sky_model_radiance(&sky, 45, 0, at_sun);
	double gradation = (1 - exp(-0.32 / cos(PI / 4))) / (1 - exp(-0.32)), tail = exp(-1.5 * PI);
	double indicatrix =
		(1 + 10 * (1 - tail) + 0.45) / (1 + 10 * (exp(-3 * PI / 4) - tail) + 0.45 / 2);
	assert_near((double)overhead[0], 1.0, 1e-6);
	assert_near((double)at_sun[0], gradation * indicatrix, 1e-5);
}

/* Zenith luminance after Preetham et al., A.2, for turbidity 5 and the sun overhead, worked out by
 * hand: 15.2555 tan(0.402778 pi) - 1.0775 + 2.4192 = 49.54 kcd/m^2. And a clear sky away from the
 * sun is blue. */
static void test_physical_sky(void **state)
{
	(void)state;
	float rgb[3];
	sky_description sky = { .model = SKY_MODEL_PHYSICAL, .elevation = 90, .turbidity = 5 };
	sky_model_radiance(&sky, 90, 0, rgb);
	double hand = 1000.0 * (15.2555 * tan(0.402778 * PI) - 1.0775 + 2.4192);
	/* The matrix to RGB has four digits. */
	assert_near(gw_relative_luminance((double)rgb[0], (double)rgb[1], (double)rgb[2]) / hand, 1.0,
				1e-3);
	sky.elevation = 30;
	sky.turbidity = 2;
	sky_model_radiance(&sky, 90, 60, rgb);
	assert_true(rgb[2] > 1.5f * rgb[0] && rgb[1] > rgb[0]);
}

/* -------------------------------------------------------------------------------------- lamps */

static lamp read_lamp(const char *text)
{
	lamp light;
	gw_error error = { 0 };
	if (light_from_text(text, &light, &error) != GW_OK)
		fail_msg("%s", error.text);
	light_resolve(&light, 'z');
	return light;
}

/* Flux over the solid angle; of a spot by summing its profile over rings of a thousandth. */
static void test_flux(void **state)
{
	(void)state;
	lamp point = read_lamp("point at 0,0,0 lumens 400");
	assert_near((double)point.light.intensity[1], 400 / (4 * PI), 1e-5);
	lamp spot = read_lamp("spot at 0,0,0 to 0,0,1 watts 5 inner 20 outer 50");
	double flux = 0, inner = cos(20 * PI / 180), outer = cos(50 * PI / 180);
	for (int i = 0; i < 10000; i++) {
		double cosine = outer + (1 - outer) * (i + 0.5) / 10000;
		double x = fmin((cosine - outer) / (inner - outer), 1.0);
		flux +=
			(double)spot.light.intensity[0] * x * x * (3 - 2 * x) * 2 * PI * (1 - outer) / 10000;
	}
	assert_near(flux, 5, 1e-5);
	assert_int_equal(spot.units, LIGHT_UNITS_RADIOMETRIC);
}

/* A colour temperature leaves the luminance: 40 cd stay 40 cd. What glows at 6,500 K is near the
 * white of Rec. 709, D65 of 6,504 K, which is daylight and a little greener. */
static void test_kelvin(void **state)
{
	(void)state;
	lamp warm = read_lamp("point at 0,0,0 intensity 40cd kelvin 2700");
	const float *i = warm.light.intensity;
	assert_near(gw_relative_luminance((double)i[0], (double)i[1], (double)i[2]), 40.0, 1e-4);
	assert_true(i[0] > i[1] && i[1] > i[2]);
	double rgb[3];
	kelvin_color(6504, rgb);
	for (int k = 0; k < 3; k++)
		assert_near(rgb[k], 1.0, 0.05);
	light_resolve(&warm, 'y'); /* again: nothing is multiplied twice */
	assert_near(gw_relative_luminance((double)i[0], (double)i[1], (double)i[2]), 40.0, 1e-4);
}

/* An even sky of 10,000 lx has 10,000 / pi cd/m^2; a model's map times its scale gives what was
 * asked for. */
static void test_illuminance(void **state)
{
	(void)state;
	panorama map;
	gw_error error;
	lamp even = read_lamp("sky illuminance 10000lx");
	assert_near((double)even.light.radiance[0], 10000 / PI, 1e-3);
	lamp clear = read_lamp("sky model clear from 120,35 illuminance 20000");
	assert_int_equal(light_sky(&clear, &map, &error), GW_OK);
	assert_near((double)clear.light.radiance[1] * sky_map_illuminance(&map), 20000, 0.01);
	panorama_clear(&map);
}

/* North 90 degrees clockwise from +y lies along +x: a sun in the south shines from -x. */
static void test_north(void **state)
{
	(void)state;
	lamp sun = read_lamp("sun from 180,0 north 90 irradiance 1");
	assert_near(sun.light.direction[0], 1, 1e-12);
	assert_near(sun.light.direction[1], 0, 1e-12);
}

static void test_units_of_a_scene(void **state)
{
	(void)state;
	gw_error error;
	light_units units = LIGHT_UNITS_UNSAID;
	lamp lights[3] = { read_lamp("point at 0,0,0 intensity 4"), read_lamp("sky radiance 2cd/m^2"),
					   read_lamp("sun from 0,90 irradiance 3W/m2") };
	assert_int_equal(lights_agree(lights, 2, &units, &error), GW_OK);
	assert_int_equal(units, LIGHT_UNITS_PHOTOMETRIC);
	units = LIGHT_UNITS_UNSAID;
	assert_int_equal(lights_agree(lights, 3, &units, &error), GW_ERROR_USAGE);
	assert_non_null(strstr(error.text, "light 2"));
	assert_non_null(strstr(error.text, "light 3"));
	units = LIGHT_UNITS_RADIOMETRIC;
	assert_int_equal(lights_agree(lights, 2, &units, &error), GW_ERROR_USAGE);
}

/* Each name stands for a light, and what is said behind it wins. */
static void test_presets(void **state)
{
	(void)state;
	for (const light_preset *p = light_presets; p->name; p++) {
		char text[256];
		snprintf(text, sizeof text, "%s at 0,0,0%s", p->name,
				 p->needed ? " to 1,0,0 lumens 300 distance 100" : "");
		lamp named = read_lamp(text);
		assert_int_equal(named.light.type, p->type);
		assert_int_equal(named.units, LIGHT_UNITS_PHOTOMETRIC);
		assert_true(named.light.intensity[0] > 0.0f);
		assert_true(strlen(p->source) > 0);
	}
	const float *i = NULL;
	lamp bright = read_lamp("candle at 0,0,0 lumens 125.663706");
	i = bright.light.intensity;
	assert_near(gw_relative_luminance((double)i[0], (double)i[1], (double)i[2]), 10.0, 1e-5);
	assert_true(i[0] > i[2]);
	lamp dyed = read_lamp("candle at 0,0,0 intensity 1,2,3");
	for (int k = 0; k < 3; k++)
		assert_near((double)dyed.light.intensity[k], k + 1.0, 0.0);
}

/* What stands on a lamp's box: 0.25 lx at the distance in the middle of the beam, and all its
 * lumens within the cone. The sum over 100,000 rings is exact to their width. */
static void test_beam(void **state)
{
	(void)state;
	static const double box[][2] = { { 300, 100 }, { 1000, 50 }, { 30, 10 } };
	for (size_t b = 0; b < sizeof box / sizeof *box; b++) {
		char text[128];
		snprintf(text, sizeof text, "headlamp at 0,0,0 toward 1,0,0 lumens %g distance %g",
				 box[b][0], box[b][1]);
		lamp light = read_lamp(text);
		double peak = (double)light.light.intensity[0], sum = 0.0;
		assert_near(peak / (box[b][1] * box[b][1]), 0.25, 1e-6);
		double outer = cos((double)light.light.outer_angle * PI / 180.0);
		const int rings = 100000;
		for (int r = 0; r < rings; r++) {
			double t = (r + 0.5) / rings;
			sum += peak * t * t * (3.0 - 2.0 * t) * 2.0 * PI * (1.0 - outer) / rings;
		}
		assert_near(sum / box[b][0], 1.0, 1e-4);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_published_sun), cmocka_unit_test(test_solstice),
		cmocka_unit_test(test_equinox),       cmocka_unit_test(test_times),
		cmocka_unit_test(test_overcast),      cmocka_unit_test(test_clear_sky),
		cmocka_unit_test(test_physical_sky),  cmocka_unit_test(test_flux),
		cmocka_unit_test(test_kelvin),        cmocka_unit_test(test_illuminance),
		cmocka_unit_test(test_north),         cmocka_unit_test(test_units_of_a_scene),
		cmocka_unit_test(test_presets),       cmocka_unit_test(test_beam),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

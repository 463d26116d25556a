/* Feet and degrees as metres, by what files say and by what users do. */
#include "units/coordinates.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

/* Two points at the corners of a box. */
static scan make_cloud(const double low[3], const double high[3])
{
	static const char *const name[3] = { "x", "y", "z" };
	scan cloud = { .count = 2, .up = 'z' };
	for (int k = 0; k < 3; k++) {
		scan_column *column = scan_add_column(&cloud, name[k], SCAN_FLOAT64, NULL);
		((double *)column->data)[0] = low[k];
		((double *)column->data)[1] = high[k];
	}
	return cloud;
}

static const double feet_low[3] = { 636000, 848000, 400 }, feet_high[3] = { 639000, 853000, 600 };
static const double degrees_low[3] = { 10.0, 50.0, 100 }, degrees_high[3] = { 10.02, 50.01, 180 };

static coordinates find(scan *cloud, const char *comment, coordinates_unit unit)
{
	coordinates c;
	gw_error error = { 0 };
	if (comment)
		scan_add_comment(cloud, comment, NULL);
	if (coordinates_find(cloud, unit, &c, &error) != GW_OK)
		fail_msg("%s", error.text);
	return c;
}

static void units_are_what_is_said(void **state)
{
	(void)state;
	const struct {
		coordinates_unit unit;
		double metres;
	} cases[] = { { COORDINATES_AUTO, 1 },    { COORDINATES_M, 1 },
				  { COORDINATES_MM, 0.001 },  { COORDINATES_FT, 0.3048 },
				  { COORDINATES_IN, 0.0254 }, { COORDINATES_US_FT, 1200.0 / 3937.0 } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		scan cloud = make_cloud(feet_low, feet_high);
		coordinates c = find(&cloud, NULL, cases[i].unit);
		double place[3] = { 1, 2, 3 };
		coordinates_to_metres(&c, place);
		for (int k = 0; k < 3; k++)
			assert_true(place[k] == cases[i].metres * (k + 1));
		assert_true(c.changes == (cases[i].metres != 1));
		coordinates_clear(&c);
		scan_clear(&cloud);
	}
}

/* Keys: a projected system whose number says nothing, in US survey feet (9003); and a WKT with
 * metres along the ground and feet of height. */
static void files_say_their_units(void **state)
{
	(void)state;
	scan cloud = make_cloud(feet_low, feet_high);
	coordinates c = find(&cloud, "las geokeys 1 1 0 3 1024 0 1 1 3072 0 1 32767 3076 0 1 9003",
						 COORDINATES_AUTO);
	assert_true(fabs(c.scale[0] - 1200.0 / 3937.0) < 1e-12 && c.scale[2] == c.scale[0]);
	assert_true(c.changes && c.by_file);
	coordinates_clear(&c);
	c = find(&cloud, NULL, COORDINATES_M);
	assert_false(c.changes);
	coordinates_clear(&c);
	scan_clear(&cloud);

	cloud = make_cloud(feet_low, feet_high);
	c = find(&cloud,
			 "las wkt COMPD_CS[\"mixed\",PROJCS[\"m\",GEOGCS[\"g\",DATUM[\"d\",SPHEROID[\"GRS "
			 "1980\",6378137,298.257222101]],PRIMEM[\"Greenwich\",0],UNIT[\"degree\","
			 "0.0174532925199433]],PROJECTION[\"Transverse_Mercator\"],PARAMETER["
			 "\"latitude_of_origin\",0],PARAMETER[\"central_meridian\",9],PARAMETER["
			 "\"scale_factor\",1],PARAMETER[\"false_easting\",0],PARAMETER[\"false_northing\",0],"
			 "UNIT[\"metre\",1]],VERT_CS[\"h\",VERT_DATUM[\"v\",2005],UNIT[\"foot\",0.3048]]]",
			 COORDINATES_AUTO);
	assert_true(c.scale[0] == 1 && fabs(c.scale[2] - 0.3048) < 1e-12 && c.changes);
	coordinates_clear(&c);
	scan_clear(&cloud);
}

/* A minute of latitude is a sea mile, 1,855.3 m at 50 degrees (WGS 84); one of longitude
 * 1,855.3 cos(50) or so: 1194.0 m by the radius of curvature, 6,390,702 m. */
static void degrees_become_metres(void **state)
{
	(void)state;
	scan cloud = make_cloud(degrees_low, degrees_high);
	coordinates c = find(&cloud, "las geokeys 1 1 0 2 1024 0 1 2 2048 0 1 4326", COORDINATES_AUTO);
	double a[3] = { 10, 50, 7 }, b[3] = { 10 + 1.0 / 60, 50, 7 }, n[3] = { 10, 50 + 1.0 / 60, 7 };
	coordinates_to_metres(&c, a);
	coordinates_to_metres(&c, b);
	coordinates_to_metres(&c, n);
	const double minute = M_PI / 180 / 60;
	double east = 6390702.0 * cos(50 * M_PI / 180) * minute, north = 6372956.0 * minute;
	/* The meridian's radius of curvature changes by less than one in 10,000 within a minute. */
	assert_true(fabs(b[0] - a[0] - east) < 1e-4 * east);
	assert_true(fabs(n[1] - a[1] - north) < 1e-3 * north);
	assert_true(a[2] == 7 && c.changes);
	coordinates_from_metres(&c, a);
	assert_true(fabs(a[0] - 10) < 1e-9 && fabs(a[1] - 50) < 1e-9 && a[2] == 7);
	coordinates_clear(&c);
	scan_clear(&cloud);
}

/* What a file's text says, which nobody has to look up: not of a projected system, which names the
 * degrees that it is projected from, and not where coordinates cannot be degrees. Where nothing is
 * said they may look so. */
static void texts_say_degrees(void **state)
{
	(void)state;
	static const struct {
		const char *text;
		bool far, degrees;
	} row[] = {
		{ "las geokeys 1 1 0 2 1024 0 1 2 2048 0 1 4326", false, true },
		{ "las geokeys 1 1 0 2 1024 0 1 2 2048 0 1 4326", true, false },
		{ "las geokeys 1 1 0 2 3072 0 1 25832 2048 0 1 4258", false, false },
		{ "las geokeys 1 1 0 2 2048 0 1 4326 3076 0 1 9001", false, false },
		{ "las wkt GEOGCS[\"WGS 84\"]", false, true },
		{ "las wkt PROJCS[\"m\",GEOGCS[\"g\"]]", false, false },
		{ "las wkt COMPOUNDCRS[\"c\",GEOGCRS[\"g\"],VERTCRS[\"v\"]]", false, true },
		{ "said", false, true },
		{ "said", true, false },
	};
	for (size_t r = 0; r < sizeof row / sizeof *row; r++) {
		gw_error error = { 0 };
		bool degrees = !row[r].degrees;
		scan cloud =
			row[r].far ? make_cloud(feet_low, feet_high) : make_cloud(degrees_low, degrees_high);
		assert_int_equal(scan_add_comment(&cloud, row[r].text, &error), GW_OK);
		assert_int_equal(coordinates_say_degrees(&cloud, NULL, NULL, &degrees, &error), GW_OK);
		assert_int_equal(degrees, row[r].degrees);
		scan_clear(&cloud);
	}
}

/* A system that nobody knows: metres, with a note, but for what looks like degrees. Where keys name
 * the unit beside it nothing is missing. */
static void unknown_systems_are_noted(void **state)
{
	(void)state;
	coordinates c;
	gw_error error = { 0 };
	const char *const unknown = "las geokeys 1 1 0 2 1024 0 1 1 3072 0 1 29999";
	scan cloud = make_cloud(feet_low, feet_high);
	c = find(&cloud, unknown, COORDINATES_AUTO);
	assert_false(c.changes);
	assert_int_equal(cloud.comment_count, 2);
	assert_non_null(strstr(cloud.comment[1], "--units"));
	coordinates_clear(&c);
	scan_clear(&cloud);

	cloud = make_cloud(degrees_low, degrees_high);
	scan_add_comment(&cloud, unknown, NULL);
	assert_int_equal(coordinates_find(&cloud, COORDINATES_AUTO, &c, &error), GW_ERROR_DATA);
	assert_non_null(strstr(error.text, "--units degrees"));
	scan_clear(&cloud);

	cloud = make_cloud(feet_low, feet_high);
	c = find(&cloud, "las geokeys 1 1 0 3 1024 0 1 1 3072 0 1 29999 3076 0 1 9002",
			 COORDINATES_AUTO);
	assert_true(c.scale[0] == 0.3048);
	assert_int_equal(cloud.comment_count, 1);
	coordinates_clear(&c);
	scan_clear(&cloud);

	cloud = make_cloud(feet_low, feet_high);
	c = find(&cloud, "las wkt EPSG:2225", COORDINATES_AUTO); /* California, US survey feet */
	assert_true(fabs(c.scale[0] - 1200.0 / 3937.0) < 1e-12);
	coordinates_clear(&c);
	scan_clear(&cloud);

	cloud = make_cloud(feet_low, feet_high);
	c = find(&cloud, "las wkt ''", COORDINATES_AUTO);
	assert_false(c.changes);
	assert_int_equal(cloud.comment_count, 1);
	coordinates_clear(&c);
	scan_clear(&cloud);
}

/* Degrees that nobody names are refused; those that a file claims of a projected cloud are noted;
 * a table of a metre beside a tower is neither. */
static void degrees_are_noticed(void **state)
{
	(void)state;
	coordinates c;
	gw_error error = { 0 };
	scan cloud = make_cloud(degrees_low, degrees_high);
	assert_int_equal(coordinates_find(&cloud, COORDINATES_AUTO, &c, &error), GW_ERROR_DATA);
	assert_non_null(strstr(error.text, "--units degrees"));
	assert_non_null(strstr(error.text, "--units m"));
	c = find(&cloud, NULL, COORDINATES_DEGREES);
	assert_true(c.changes && c.projected);
	coordinates_clear(&c);
	c = find(&cloud, NULL, COORDINATES_M);
	assert_false(c.changes);
	coordinates_clear(&c);
	scan_clear(&cloud);

	cloud = make_cloud(feet_low, feet_high);
	c = find(&cloud, "las geokeys 1 1 0 2 1024 0 1 2 2048 0 1 4326", COORDINATES_AUTO);
	assert_false(c.changes);
	assert_int_equal(cloud.comment_count, 2);
	assert_non_null(strstr(cloud.comment[1], "degrees"));
	coordinates_clear(&c);
	assert_int_equal(coordinates_find(&cloud, COORDINATES_DEGREES, &c, &error), GW_ERROR_DATA);
	scan_clear(&cloud);

	const double low[3] = { 5, 5, 0 }, high[3] = { 6, 6, 40 };
	cloud = make_cloud(low, high);
	c = find(&cloud, NULL, COORDINATES_AUTO);
	assert_false(c.changes);
	coordinates_clear(&c);
	scan_clear(&cloud);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(units_are_what_is_said), cmocka_unit_test(files_say_their_units),
		cmocka_unit_test(degrees_become_metres),  cmocka_unit_test(unknown_systems_are_noted),
		cmocka_unit_test(degrees_are_noticed),    cmocka_unit_test(texts_say_degrees),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

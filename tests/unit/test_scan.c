/* Scans: columns, joining, and the way to points. */
#include "points/scan_origin.h"
#include "points/scan_aside.h"
#include "points/scan_color.h"
#include "points/scan_join.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* float32 keeps 24 bits; an albedo below 1 that was computed in double and rounded once is off by
 * at most 2^-25. */
#define HALF_ULP 0x1p-25

static void assert_near(double a, double b, double tolerance)
{
	if (!(fabs(a - b) <= tolerance))
		fail_msg("%.9g is not %.9g", a, b);
}

static scan_column *add(scan *cloud, const char *name, scan_type type, const double *values)
{
	gw_error error = { 0 };
	scan_column *column = scan_add_column(cloud, name, type, &error);
	assert_non_null(column);
	for (size_t i = 0; i < cloud->count; i++) {
		if (type == SCAN_FLOAT64)
			((double *)column->data)[i] = values[i];
		else if (type == SCAN_FLOAT32)
			((float *)column->data)[i] = (float)values[i];
		else if (type == SCAN_UINT8 || type == SCAN_INT8)
			((uint8_t *)column->data)[i] = (uint8_t)(int)values[i];
		else if (type == SCAN_UINT16)
			((uint16_t *)column->data)[i] = (uint16_t)values[i];
		else if (type == SCAN_INT16)
			((int16_t *)column->data)[i] = (int16_t)values[i];
		else if (type == SCAN_INT32)
			((int32_t *)column->data)[i] = (int32_t)values[i];
		else
			((uint32_t *)column->data)[i] = (uint32_t)values[i];
	}
	return column;
}

static void add_position(scan *cloud)
{
	static const double x[4] = { 0, 1, 2, 3 };
	add(cloud, "x", SCAN_FLOAT64, x);
	add(cloud, "y", SCAN_FLOAT32, x);
	add(cloud, "z", SCAN_INT32, x);
}

static void add_triple(scan *cloud, const char *const name[3], scan_type type, const double *values)
{
	for (int k = 0; k < 3; k++)
		add(cloud, name[k], type, values);
}

/* ------------------------------------------------------------------------------- columns */

static void columns_come_and_go(void **state)
{
	(void)state;
	scan cloud = { .count = 4 };
	gw_error error = { 0 };
	add_position(&cloud);
	assert_null(scan_add_column(&cloud, "y", SCAN_UINT8, &error));
	assert_int_equal(error.status, GW_ERROR_DATA);
	assert_int_equal(cloud.column_count, 3);
	scan_remove_column(&cloud, "y");
	scan_remove_column(&cloud, "none");
	assert_int_equal(cloud.column_count, 2);
	assert_null(scan_find(&cloud, "y"));
	assert_true(scan_value(scan_find(&cloud, "z"), 3) == 3.0);
	assert_int_equal(scan_add_comment(&cloud, "hello", NULL), GW_OK);
	assert_string_equal(cloud.comment[0], "hello");
	scan_clear(&cloud);
	assert_int_equal(cloud.column_count, 0);
	scan_clear(&cloud);
}

static void every_type_gives_its_value(void **state)
{
	(void)state;
	static const size_t size[SCAN_TYPE_COUNT] = { 1, 1, 2, 2, 4, 4, 4, 8 };
	const double values[2] = { 7, 100 };
	for (int t = 0; t < SCAN_TYPE_COUNT; t++) {
		scan cloud = { .count = 2 };
		scan_column *column = add(&cloud, "a", (scan_type)t, values);
		assert_int_equal(scan_type_size((scan_type)t), size[t]);
		assert_true(scan_value(column, 0) == 7.0 && scan_value(column, 1) == 100.0);
		scan_clear(&cloud);
	}
}

/* Whatever two types meet, the joined column holds the extremes of both. */
static void joining_widens_types(void **state)
{
	(void)state;
	static const double extreme[SCAN_TYPE_COUNT][2] = {
		{ -128, 127 },
		{ 0, 255 },
		{ -32768, 32767 },
		{ 0, 65535 },
		{ -2147483648.0, 2147483647.0 },
		{ 0, 4294967295.0 },
		{ -0x1p100, 0x1p-100 },
		{ -0x1p1000, 0x1.fffffffffffffp52 },
	};
	for (int a = 0; a < SCAN_TYPE_COUNT; a++) {
		for (int b = 0; b < SCAN_TYPE_COUNT; b++) {
			scan head = { .count = 2 }, tail = { .count = 2 };
			add(&head, "v", (scan_type)a, extreme[a]);
			add(&tail, "v", (scan_type)b, extreme[b]);
			assert_int_equal(scan_append(&head, &tail, NULL), GW_OK);
			const scan_column *v = scan_find(&head, "v");
			assert_true(a != b || v->type == (scan_type)a);
			for (size_t i = 0; i < 2; i++) {
				assert_true(scan_value(v, i) == extreme[a][i]);
				assert_true(scan_value(v, 2 + i) == extreme[b][i]);
			}
			scan_clear(&head);
			scan_clear(&tail);
		}
	}
}

static void joining_keeps_all_columns(void **state)
{
	(void)state;
	const double ones[4] = { 1, 1, 1, 1 };
	scan head = { .count = 4, .up = 'z' };
	scan tail = { .count = 4, .up = 'z' };
	add_position(&head);
	add_position(&tail);
	add(&head, "mine", SCAN_UINT8, ones);
	add(&tail, "yours", SCAN_INT16, ones);
	scan_add_comment(&tail, "from the tail", NULL);
	assert_int_equal(scan_append(&head, &tail, NULL), GW_OK);
	assert_int_equal(head.count, 8);
	assert_int_equal(head.column_count, 5);
	assert_true(scan_value(scan_find(&head, "mine"), 3) == 1.0);
	assert_true(scan_value(scan_find(&head, "mine"), 4) == 0.0);
	assert_true(scan_value(scan_find(&head, "yours"), 3) == 0.0);
	assert_true(scan_value(scan_find(&head, "yours"), 4) == 1.0);
	assert_string_equal(head.comment[0], "from the tail");
	assert_int_equal(tail.count, 4);

	scan empty = { 0 };
	assert_int_equal(scan_append(&empty, &tail, NULL), GW_OK);
	assert_int_equal(empty.count, 4);
	assert_int_equal(empty.up, 'z');
	scan_clear(&empty);
	scan_clear(&head);
	scan_clear(&tail);
}

/* A lamp with 8-bit colours joined to a scan with 16-bit ones must not turn black. */
static void joining_keeps_colors(void **state)
{
	(void)state;
	const double bytes[2] = { 51, 255 }, words[2] = { 13107, 65535 }, units[2] = { 0.2, 1.0 };
	const struct {
		scan_type head, tail, joined;
		const double *from, *to, *expected;
	} cases[] = { { SCAN_UINT8, SCAN_UINT16, SCAN_UINT16, bytes, words, words },
				  { SCAN_UINT16, SCAN_UINT16, SCAN_UINT16, words, bytes, words },
				  { SCAN_UINT8, SCAN_FLOAT32, SCAN_FLOAT32, bytes, units, units },
				  { SCAN_FLOAT64, SCAN_UINT16, SCAN_FLOAT32, units, words, units },
				  { SCAN_UINT8, SCAN_UINT8, SCAN_UINT8, bytes, bytes, bytes } };
	for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
		scan head = { .count = 2 }, tail = { .count = 2 };
		add_triple(&head, scan_color_names, cases[n].head, cases[n].from);
		add_triple(&tail, scan_color_names, cases[n].tail, cases[n].to);
		assert_int_equal(scan_append(&head, &tail, NULL), GW_OK);
		for (int k = 0; k < 3; k++) {
			const scan_column *column = scan_find(&head, scan_color_names[k]);
			assert_int_equal(column->type, cases[n].joined);
			for (size_t i = 0; i < 4; i++) /* 0.2 is rounded to float once */
				assert_near(scan_value(column, i), cases[n].expected[i % 2], HALF_ULP);
		}
		scan_clear(&head);
		scan_clear(&tail);
	}
}

/* ------------------------------------------------------------------------------ to points */

/* Albedo of point 1 of a cloud whose colours have these four values. */
static float albedo_of(const char *const name[3], scan_type type, const double *values, bool linear)
{
	scan cloud = { .count = 4 };
	scan_points points;
	scan_points_options options = SCAN_POINTS_OPTIONS_DEFAULT;
	options.linear_colors = linear;
	add_position(&cloud);
	add_triple(&cloud, name, type, values);
	assert_int_equal(scan_points_make(&cloud, &options, &points, NULL), GW_OK);
	float albedo = points.points.albedo[3];
	assert_true(albedo == points.points.albedo[4] && albedo == points.points.albedo[5]);
	scan_points_clear(&points);
	scan_clear(&cloud);
	return albedo;
}

/* What a colour counts to is told by its type and its largest value; 51/255 = 13107/65535 = 0.2,
 * which sRGB decodes to ((0.2 + 0.055) / 1.055)^2.4. */
static void colors_count_to_their_type(void **state)
{
	(void)state;
	const double decoded = 0.033104766570885055;
	const double bytes[4] = { 0, 51, 255, 10 }, words[4] = { 0, 13107, 65535, 10 };
	const double units[4] = { 0, 0.2, 1.0, 0.04 };
	const struct {
		scan_type type;
		const double *values;
	} cases[] = { { SCAN_UINT8, bytes },   { SCAN_INT8, bytes },    { SCAN_UINT16, bytes },
				  { SCAN_UINT16, words },  { SCAN_UINT32, words },  { SCAN_INT16, bytes },
				  { SCAN_FLOAT32, bytes }, { SCAN_FLOAT64, units }, { SCAN_FLOAT32, units } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		/* 0.2 as a float is off by 2^-27; the curve's slope there is below 0.5. */
		assert_near(albedo_of(scan_color_names, cases[i].type, cases[i].values, false), decoded,
					HALF_ULP);
		assert_near(albedo_of(scan_color_names, cases[i].type, cases[i].values, true), 0.2,
					HALF_ULP);
	}
}

/* The same 0.2 of full in other ranges, with values a little over it, and under other names. One
 * value in four thousand that does not fit changes nothing. */
static void colors_tell_what_they_count_to(void **state)
{
	(void)state;
	const double decoded = 0.033104766570885055;
	const double bits_10[4] = { 0, 204.6, 1023, 10 }, bits_12[4] = { 0, 819, 4095, 10 };
	const double floats_16[4] = { 0, 13107, 65535, 10 }, over[4] = { 0, 0.2, 1.02, 0.3 };
	const struct {
		scan_type type;
		const double *values;
		double range;
		bool told;
	} cases[] = {
		{ SCAN_FLOAT32, bits_10, 1023, true },    { SCAN_UINT16, bits_12, 4095, true },
		{ SCAN_FLOAT32, floats_16, 65535, true }, { SCAN_FLOAT64, floats_16, 65535, true },
		{ SCAN_UINT16, floats_16, 65535, false }, { SCAN_FLOAT32, over, 1, false }
	};
	static const char *const names[][3] = { { "red", "green", "blue" },
											{ "R", "G", "B" },
											{ "Rf", "Gf", "Bf" },
											{ "scalar_Rf", "scalar_Gf", "scalar_Bf" },
											{ "diffuse_red", "diffuse_green", "diffuse_blue" } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
		for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
			scan cloud = { .count = 4 };
			scan_color color;
			add_triple(&cloud, names[n], cases[i].type, cases[i].values);
			assert_true(scan_color_find(&cloud, scan_color_names, &color));
			assert_true(color.range == cases[i].range && color.told == cases[i].told);
			scan_clear(&cloud);
			/* 0.2 of 1023 as a float is off by 2^-17 / 1023. */
			assert_near(albedo_of(names[n], cases[i].type, cases[i].values, false), decoded, 1e-7);
		}
	scan cloud = { .count = 4000 };
	scan_color color;
	for (int k = 0; k < 3; k++) {
		scan_column *column = scan_add_column(&cloud, scan_color_names[k], SCAN_FLOAT32, NULL);
		for (size_t i = 0; i < cloud.count; i++)
			((float *)column->data)[i] = i == 7 ? 255.0f : 0.5f;
	}
	assert_true(scan_color_find(&cloud, scan_color_names, &color) && color.range == 1.0);
	scan_clear(&cloud);
}

/* 0x334455 as a number of any type and as the bits of a float; numbers below 2^16 are none. */
static void packed_colors_are_taken_out(void **state)
{
	(void)state;
	const double number[4] = { 0x334455, 0x334455, 0, 0xff334455u };
	const double small[4] = { 1, 2, 3, 4 };
	static const scan_type types[] = { SCAN_UINT32, SCAN_FLOAT64 };
	for (size_t t = 0; t < 2; t++) {
		scan cloud = { .count = 4 };
		add_position(&cloud);
		add(&cloud, "RGB", types[t], number);
		add(&cloud, "last", SCAN_UINT8, small);
		assert_int_equal(scan_color_unpack(&cloud, NULL), GW_OK);
		assert_int_equal(cloud.column_count, 7);
		assert_string_equal(cloud.column[3].name, "red");
		assert_string_equal(cloud.column[6].name, "last");
		for (size_t i = 0; i < 4; i++)
			for (int k = 0; k < 3; k++)
				assert_true(scan_value(&cloud.column[3 + k], i) == (i == 2 ? 0 : 0x33 + 0x11 * k));
		scan_clear(&cloud);
	}
	scan cloud = { .count = 4 };
	const uint32_t bits = 0x334455;
	scan_column *column = scan_add_column(&cloud, "rgb", SCAN_FLOAT32, NULL);
	for (size_t i = 0; i < 4; i++)
		memcpy((float *)column->data + i, &bits, sizeof bits);
	assert_int_equal(scan_color_unpack(&cloud, NULL), GW_OK);
	assert_true(scan_value(scan_find(&cloud, "green"), 3) == 0x44);
	scan_clear(&cloud);
	cloud = (scan){ .count = 4 };
	add(&cloud, "rgb", SCAN_UINT32, small);
	assert_int_equal(scan_color_unpack(&cloud, NULL), GW_OK);
	assert_non_null(scan_find(&cloud, "rgb"));
	scan_clear(&cloud);
}

static void srgb_is_its_own_inverse(void **state)
{
	(void)state;
	/* Anchors of IEC 61966-2-1; the two branches meet at 0.04045 within 1e-7. */
	assert_near(scan_srgb_decode(0.0), 0.0, 0.0);
	assert_near(scan_srgb_decode(1.0), 1.0, 1e-15);
	assert_near(scan_srgb_decode(0.5), 0.21404114048223255, 1e-15);
	for (int i = 0; i <= 255; i++)
		assert_near(scan_srgb_encode(scan_srgb_decode(i / 255.0)), i / 255.0, 1e-7);
}

static void lit_file_is_lit_again_from_its_albedo(void **state)
{
	(void)state;
	const double preview[4] = { 255, 255, 255, 255 }, albedo[4] = { 0, 51, 0, 0 };
	scan cloud = { .count = 4 };
	scan_points points;
	add_position(&cloud);
	add_triple(&cloud, scan_color_names, SCAN_UINT8, preview);
	add_triple(&cloud, scan_albedo_names, SCAN_UINT8, albedo);
	assert_int_equal(scan_points_make(&cloud, &SCAN_POINTS_OPTIONS_DEFAULT, &points, NULL), GW_OK);
	assert_near(points.points.albedo[3], 0.033104766570885055, HALF_ULP);
	assert_non_null(strstr(points.albedo_source, "albedo_r"));
	scan_points_clear(&points);
	scan_clear(&cloud);
}

static void black_or_missing_colors_give_the_default(void **state)
{
	(void)state;
	const double black[4] = { 0, 0, 0, 0 };
	scan cloud = { .count = 4 };
	scan_points points;
	scan_points_options options = SCAN_POINTS_OPTIONS_DEFAULT;
	add_position(&cloud);
	assert_int_equal(scan_points_make(&cloud, &options, &points, NULL), GW_OK);
	assert_true(points.points.albedo[11] == GW_ALBEDO_DEFAULT);
	assert_null(points.points.normal);
	assert_null(points.points.emission);
	assert_null(points.points.scanner);
	scan_points_clear(&points);

	options.albedo = SCAN_ALBEDO_COLOR;
	assert_int_equal(scan_points_make(&cloud, &options, &points, NULL), GW_ERROR_USAGE);
	add_triple(&cloud, scan_color_names, SCAN_UINT16, black);
	assert_int_equal(scan_points_make(&cloud, &options, &points, NULL), GW_OK);
	assert_true(points.points.albedo[0] == 0.0f);
	scan_points_clear(&points);
	options.albedo = SCAN_ALBEDO_AUTO;
	assert_int_equal(scan_points_make(&cloud, &options, &points, NULL), GW_OK);
	assert_true(points.points.albedo[0] == GW_ALBEDO_DEFAULT);
	assert_non_null(strstr(points.albedo_source, "black"));
	scan_points_clear(&points);
	scan_clear(&cloud);
}

/* A camera saw two thirds of 900 points; so far as it did, none is black. Among dark ones, black is
 * a colour like others. */
static void points_that_no_camera_saw_get_the_default(void **state)
{
	(void)state;
	double place[900], color[900];
	scan cloud = { .count = 900 };
	scan_points points;
	scan_points_options options = SCAN_POINTS_OPTIONS_DEFAULT;
	for (int i = 0; i < 900; i++) {
		place[i] = i;
		color[i] = i < 300 ? 0 : 5 + i % 200;
	}
	add(&cloud, "x", SCAN_FLOAT64, place);
	add(&cloud, "y", SCAN_FLOAT64, place);
	add(&cloud, "z", SCAN_FLOAT64, place);
	add_triple(&cloud, scan_color_names, SCAN_UINT8, color);
	/* Among grey ones they are a black wall. */
	assert_int_equal(scan_points_make(&cloud, &options, &points, NULL), GW_OK);
	assert_true(points.points.albedo[0] == 0.0f);
	scan_points_clear(&points);
	for (int i = 300; i < 900; i++)
		((uint8_t *)cloud.column[5].data)[i]++;
	assert_int_equal(scan_points_make(&cloud, &options, &points, NULL), GW_OK);
	assert_true(points.points.albedo[0] == GW_ALBEDO_DEFAULT);
	assert_true(points.points.albedo[3 * 300] < 0.2f);
	assert_true(points.albedo_told);
	assert_non_null(strstr(points.albedo_source, "300 points that are exactly black"));
	scan_points_clear(&points);
	options.albedo = SCAN_ALBEDO_COLOR;
	assert_int_equal(scan_points_make(&cloud, &options, &points, NULL), GW_OK);
	assert_true(points.points.albedo[0] == 0.0f);
	scan_points_clear(&points);
	options.albedo = SCAN_ALBEDO_AUTO;
	for (int k = 0; k < 3; k++)
		for (int i = 300; i < 400; i++)
			((uint8_t *)cloud.column[3 + k].data)[i] = 4;
	assert_int_equal(scan_points_make(&cloud, &options, &points, NULL), GW_OK);
	assert_true(points.points.albedo[0] == 0.0f);
	assert_false(points.albedo_told);
	scan_points_clear(&points);
	scan_clear(&cloud);
}

/* 1000 shuffled intensities 1..1000 and two that are no numbers: rank 990 of 1000 is 990. */
static void intensity_is_scaled_to_its_percentile(void **state)
{
	(void)state;
	enum { N = 1002 };
	double x[N], intensity[N];
	for (int i = 0; i < N; i++) {
		x[i] = i;
		intensity[i] = i < 1000    ? 1.0 + i * 7919 % 1000
					   : i == 1000 ? (double)NAN
								   : (double)INFINITY;
	}
	scan cloud = { .count = N };
	scan_points points;
	scan_points_options options = SCAN_POINTS_OPTIONS_DEFAULT;
	options.albedo = SCAN_ALBEDO_INTENSITY;
	add(&cloud, "x", SCAN_FLOAT64, x);
	add(&cloud, "y", SCAN_FLOAT64, x);
	add(&cloud, "z", SCAN_FLOAT64, x);
	assert_int_equal(scan_points_make(&cloud, &options, &points, NULL), GW_ERROR_USAGE);
	add(&cloud, "scalar_Intensity", SCAN_FLOAT32, intensity);
	assert_int_equal(scan_points_make(&cloud, &options, &points, NULL), GW_OK);
	for (size_t i = 0; i < 1000; i++)
		assert_near(points.points.albedo[3 * i], intensity[i] / 990.0, 2 * HALF_ULP);
	scan_points_clear(&points);
	scan_clear(&cloud);
}

/* A floor of two colours below a scanner 1.6 m up: as it echoes, by cosine / range^2, and as a
 * scanner writes it that corrects for the cosine itself, or for both. In each case the albedo is
 * that of the colours, up to a factor: within one in fifty, as the bins are of some width; and what
 * is told of is what was divided out. */
static void intensity_loses_range_and_angle(void **state)
{
	(void)state;
	enum { SIDE = 120, N = SIDE * SIDE };
	for (int corrected = 0; corrected < 3; corrected++) {
		scan cloud = { .count = N };
		static const char *const name[4] = { "x", "y", "z", "intensity" };
		for (int k = 0; k < 4; k++)
			assert_non_null(scan_add_column(&cloud, name[k], SCAN_FLOAT64, NULL));
		const double at[3] = { 0.03, -0.02, 1.6 };
		assert_int_equal(scan_add_scanner(&cloud, at, 0, N, NULL), GW_OK);
		for (size_t i = 0; i < N; i++) {
			double x = 0.1 * ((double)(i % SIDE) - 60), y = 0.1 * ((double)(i / SIDE) - 60);
			double squared = (x - at[0]) * (x - at[0]) + (y - at[1]) * (y - at[1]) + at[2] * at[2];
			double rho = i * 2654435761u % 4294967296u < 2147483648u ? 0.2 : 0.8;
			scan_store(scan_find(&cloud, "x"), i, x);
			scan_store(scan_find(&cloud, "y"), i, y);
			const double echo[3] = { at[2] / (squared * sqrt(squared)), 1.0 / squared, 1.0 };
			scan_store(scan_find(&cloud, "intensity"), i, 900 * rho * echo[corrected]);
		}
		scan_points points;
		scan_points_options options = SCAN_POINTS_OPTIONS_DEFAULT;
		options.albedo = SCAN_ALBEDO_INTENSITY;
		assert_int_equal(scan_points_make(&cloud, &options, &points, NULL), GW_OK);
		for (size_t i = 0; i < N; i++) {
			double rho = i * 2654435761u % 4294967296u < 2147483648u ? 0.25 : 1.0;
			if (!(fabs((double)points.albedo[3 * i] - rho) < 0.02 * rho))
				fail_msg("point %zu: %g, not %g; %s", i, (double)points.albedo[3 * i], rho,
						 points.albedo_source);
		}
		static const char *const told[3] = {
			" counts as 1, without its fall by the power 2 of range and the power 1 of cosine",
			" counts as 1, without its fall by the power 2 of range", " counts as 1"
		};
		const char *end = strstr(points.albedo_source, " counts as");
		assert_string_equal(end ? end : points.albedo_source, told[corrected]);
		scan_points_clear(&points);
		scan_clear(&cloud);
	}
}

static void albedo_is_scaled_and_blended(void **state)
{
	(void)state;
	const double rho[4] = { 0.1, 0.25, 0.5, 1.0 };
	scan cloud = { .count = 4 };
	scan_points points;
	scan_points_options options = SCAN_POINTS_OPTIONS_DEFAULT;
	options.albedo = SCAN_ALBEDO_PROPERTY;
	options.property = "reflectance";
	options.scale = 0.5f;
	options.white = 0.2f;
	add_position(&cloud);
	add(&cloud, "reflectance", SCAN_FLOAT32, rho);
	assert_int_equal(scan_points_make(&cloud, &options, &points, NULL), GW_OK);
	/* Three roundings to float. */
	for (size_t i = 0; i < 4; i++)
		assert_near(points.points.albedo[3 * i], rho[i] * 0.5 + 0.2 * (1 - rho[i] * 0.5),
					3 * HALF_ULP);
	scan_points_clear(&points);

	options.property = "none";
	assert_int_equal(scan_points_make(&cloud, &options, &points, NULL), GW_ERROR_USAGE);
	options = SCAN_POINTS_OPTIONS_DEFAULT;
	options.albedo = SCAN_ALBEDO_CONSTANT;
	options.constant = 0.75f;
	assert_int_equal(scan_points_make(&cloud, &options, &points, NULL), GW_OK);
	assert_true(points.points.albedo[5] == 0.75f);
	scan_points_clear(&points);
	options.white = NAN;
	assert_int_equal(scan_points_make(&cloud, &options, &points, NULL), GW_ERROR_USAGE);
	scan_clear(&cloud);
}

/* A grid of angles on the walls of a room, seen from a place. */
static scan make_grid(double x, double y, double z)
{
	enum { ROWS = 40, COLUMNS = 90 };
	static const char *const name[5] = { "x", "y", "z", "rowIndex", "columnIndex" };
	scan cloud = { .count = (size_t)ROWS * COLUMNS };
	double *v[5];
	for (int c = 0; c < 5; c++)
		assert_non_null(scan_add_column(&cloud, name[c], SCAN_FLOAT64, NULL));
	for (int c = 0; c < 5; c++)
		v[c] = scan_find(&cloud, name[c])->data;
	for (size_t i = 0; i < cloud.count; i++) {
		double row = (double)(i / COLUMNS), column = (double)(i % COLUMNS);
		double e = (row - 20) * 0.06, a = column * 0.06;
		double d[3] = { cos(e) * cos(a), cos(e) * sin(a), sin(e) };
		double range = 3 / fmax(fmax(fabs(d[0]), fabs(d[1])), fabs(d[2]));
		const double moved[3] = { x, y, z };
		for (int k = 0; k < 3; k++)
			v[k][i] = range * d[k] + moved[k];
		v[3][i] = row;
		v[4][i] = column;
	}
	return cloud;
}

/* Says that a grid's points are a picture that was seen from the origin. */
static void add_picture(scan *cloud, bool turned)
{
	const scan_column *const index[2] = { scan_find(cloud, turned ? "columnIndex" : "rowIndex"),
										  scan_find(cloud, turned ? "rowIndex" : "columnIndex") };
	const gw_range_image image = { .count = cloud->count,
								   .columns = turned ? 40 : 90,
								   .rows = turned ? 90 : 40 };
	assert_int_equal(scan_add_image(cloud, &image, NULL), GW_OK);
	for (size_t i = 0; i < cloud->count; i++)
		cloud->image_cell[i] =
			(uint32_t)scan_value(index[0], i) * image.columns + (uint32_t)scan_value(index[1], i);
}

static void grids_say_where_their_scanner_stood(void **state)
{
	(void)state;
	const double moved[4] = { 0, 0.3, 50, 512000 };
	for (int i = 0; i < 8; i++) {
		double x = moved[i / 2], z = moved[i / 2] / 2;
		scan cloud = make_grid(x, 0, z);
		add_picture(&cloud, i % 2);
		assert_true(scan_settle_origin(&cloud, 0));
		const double *found = cloud.image[0].scanner;
		assert_true(hypot(hypot(found[0] - x, found[1]), found[2] - z) < 1e-6 * fmax(1, x));
		scan_clear(&cloud);
	}
	/* Points in an order of their own say nothing. */
	scan cloud = make_grid(0, 0, 0);
	add_picture(&cloud, false);
	for (size_t i = 0; i < cloud.count; i++)
		cloud.image_cell[i] = (uint32_t)(i * 7919 % cloud.count);
	assert_false(scan_settle_origin(&cloud, 0));
	scan_clear(&cloud);
}

static void scanners_keep_their_points(void **state)
{
	(void)state;
	const double a[3] = { 1, 2, 3 }, b[3] = { 4, 5, 6 };
	scan one = { .count = 2 }, two = { .count = 3 }, none = { .count = 1 };
	add_position(&one);
	add_position(&two);
	add_position(&none);
	assert_int_equal(scan_add_scanner(&one, a, 0, 2, NULL), GW_OK);
	assert_null(one.scanner_of);
	assert_int_equal(scan_add_scanner(&two, b, 0, 1, NULL), GW_OK);
	assert_int_equal(scan_add_scanner(&two, a, 2, 1, NULL), GW_OK);
	assert_int_equal(scan_append(&one, &two, NULL), GW_OK);
	assert_int_equal(scan_append(&one, &none, NULL), GW_OK);
	static const uint32_t expected[] = { 0, 0, 1, SCAN_NO_SCANNER, 0, SCAN_NO_SCANNER };
	assert_int_equal(one.scanner_count, 2);
	assert_memory_equal(one.scanner, a, sizeof a);
	assert_memory_equal(one.scanner + 3, b, sizeof b);
	assert_memory_equal(one.scanner_of, expected, sizeof expected);
	scan_clear(&one);
	scan_clear(&two);
	scan_clear(&none);
}

static void everything_else_is_handed_on(void **state)
{
	(void)state;
	static const char *const normal[3] = { "scalar_nx", "scalar_Ny", "nz" };
	const double values[4] = { 1, -2, NAN, 4 };
	scan cloud = { .count = 4 };
	assert_int_equal(scan_add_scanner(&cloud, (double[]){ 5, 6, 7 }, 0, 4, NULL), GW_OK);
	scan_points points;
	add_position(&cloud);
	add_triple(&cloud, normal, SCAN_FLOAT32, values);
	add(&cloud, "emission_g", SCAN_FLOAT32, values);
	assert_int_equal(scan_points_make(&cloud, &SCAN_POINTS_OPTIONS_DEFAULT, &points, NULL), GW_OK);
	assert_int_equal(points.points.count, 4);
	assert_true(points.points.position[3] == 1.0 && points.points.position[11] == 3.0);
	assert_true(points.points.normal[5] == -2.0f && isnan(points.points.normal[6]));
	assert_true(points.points.emission[3] == 0.0f && points.points.emission[4] == -2.0f);
	assert_int_equal(points.points.scanner_count, 1);
	assert_true(points.points.scanner[2] == 7.0);
	assert_null(points.points.scanner_of);
	scan_points_clear(&points);

	scan_remove_column(&cloud, "y");
	gw_error error = { 0 };
	assert_int_equal(scan_points_make(&cloud, &SCAN_POINTS_OPTIONS_DEFAULT, &points, &error),
					 GW_ERROR_DATA);
	assert_non_null(strstr(error.text, "'y'"));
	scan_clear(&cloud);
	assert_int_equal(scan_points_make(&cloud, &SCAN_POINTS_OPTIONS_DEFAULT, &points, &error),
					 GW_ERROR_DATA);
}

/* A column of which one value is not that of the points, or of whole numbers, stays. */
static void columns_come_back_as_they_were(void **state)
{
	(void)state;
	static const char *const normal[3] = { "nx", "ny", "nz" };
	const double values[4] = { 1, -0.0, NAN, 1e-42 }; /* as a float that is subnormal */
	scan cloud = { .count = 4 };
	scan_points points;
	gw_error error = { 0 };
	add_position(&cloud);
	add_triple(&cloud, normal, SCAN_FLOAT32, values);
	assert_int_equal(scan_points_make(&cloud, &SCAN_POINTS_OPTIONS_DEFAULT, &points, NULL), GW_OK);
	points.normal[3 * 2 + 1] = 5.0f;
	scan_put_aside(&cloud, &points);
	static const char *const gone[4] = { "x", "y", "nx", "nz" };
	for (int k = 0; k < 4; k++)
		assert_null(scan_find(&cloud, gone[k])->data);
	assert_non_null(scan_find(&cloud, "z")->data);
	assert_non_null(scan_find(&cloud, "ny")->data);
	assert_int_equal(scan_take_back(&cloud, &points, &error), GW_OK);
	for (int k = 0; k < 4; k++)
		for (size_t i = 0; i < 4; i++) {
			double expected = k < 2 ? (double)i : (double)(float)values[i];
			double value = scan_value(scan_find(&cloud, gone[k]), i);
			assert_true(isnan(expected) ? isnan(value) : value == expected);
			assert_true(signbit(value) == signbit(expected));
		}
	scan_points_clear(&points);
	scan_clear(&cloud);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(columns_come_and_go),
		cmocka_unit_test(every_type_gives_its_value),
		cmocka_unit_test(joining_widens_types),
		cmocka_unit_test(joining_keeps_all_columns),
		cmocka_unit_test(joining_keeps_colors),
		cmocka_unit_test(colors_count_to_their_type),
		cmocka_unit_test(colors_tell_what_they_count_to),
		cmocka_unit_test(packed_colors_are_taken_out),
		cmocka_unit_test(srgb_is_its_own_inverse),
		cmocka_unit_test(lit_file_is_lit_again_from_its_albedo),
		cmocka_unit_test(black_or_missing_colors_give_the_default),
		cmocka_unit_test(points_that_no_camera_saw_get_the_default),
		cmocka_unit_test(intensity_is_scaled_to_its_percentile),
		cmocka_unit_test(intensity_loses_range_and_angle),
		cmocka_unit_test(albedo_is_scaled_and_blended),
		cmocka_unit_test(grids_say_where_their_scanner_stood),
		cmocka_unit_test(scanners_keep_their_points),
		cmocka_unit_test(everything_else_is_handed_on),
		cmocka_unit_test(columns_come_back_as_they_were),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

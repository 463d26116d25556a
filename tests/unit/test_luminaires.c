/* Luminaires: IES and EULUMDAT files of known lamps against closed forms, symmetries, types of
 * photometry against each other, and files that make no sense. */
#include "luminaire_files.h"
#include "luminaires/luminaire_lines.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define DEGREE (M_PI / 180.0)

static char text[LUMINAIRE_FILE];

/* In memory of exactly that length, so that a sanitizer sees a byte too many. */
static gw_status read_bytes(const char *data, size_t length, luminaire *l, gw_error *error)
{
	uint8_t *copy = malloc(length + !length);
	assert_non_null(copy);
	memcpy(copy, data, length);
	const input_file in = { .name = "lamp.file", .data = copy, .length = length };
	gw_status status = luminaire_lines_tilt(&in) ? luminaire_ies_read(&in, l, error)
												 : luminaire_eulumdat_read(&in, l, error);
	free(copy);
	if (status != GW_OK && (l->distribution || !strstr(error->text, "lamp.file")))
		fail_msg("refused by '%s', or something is left", error->text);
	return status;
}

static luminaire read_good(size_t length)
{
	luminaire l;
	gw_error error = { 0 };
	if (read_bytes(text, length, &l, &error) != GW_OK)
		fail_msg("%s", error.text);
	return l;
}

static void assert_near(double found, double expected, double tolerance, const char *what)
{
	if (!(fabs(found - expected) <= tolerance))
		fail_msg("%s: %.9g, not %.9g; off by %.3g, allowed %.3g", what, found, expected,
				 fabs(found - expected), tolerance);
}

static double lambert(double x, double y, double z)
{
	(void)x;
	(void)y;
	return 100.0 * fmax(z, 0.0);
}

static double narrow(double x, double y, double z)
{
	(void)x;
	(void)y;
	return 250.0 * pow(fmax(z, 0.0), 20.0);
}

static double even(double x, double y, double z)
{
	(void)x;
	(void)y;
	(void)z;
	return 7.0;
}

/* No symmetry at all. */
static double uneven(double x, double y, double z)
{
	return 10.0 + 3.0 * x + 4.0 * y * y + 2.0 * y * x + 5.0 * z;
}

/* The same in all quarters. */
static double quartered(double x, double y, double z)
{
	return 10.0 + 3.0 * x * x + 4.0 * fabs(y) + 5.0 * z;
}

/* y mirrored, x not; and the other way. */
static double halved(double x, double y, double z)
{
	return 10.0 + 3.0 * x + 4.0 * y * y + 5.0 * z;
}

static double halved_across(double x, double y, double z)
{
	return halved(y, x, z);
}

static double round_shape(double x, double y, double z)
{
	return halved(0.0, sqrt(x * x + y * y), z);
}

/* Flux over a sphere: pi I, 2 pi I / 21, 4 pi I. Between angles 1 degree apart a cosine to the n is
 * off by its second derivative, at most n, over 8 times the square of the step, 3.8e-5 n of I. */
static void fluxes_have_closed_forms(void **state)
{
	(void)state;
	const luminaire_grid half = { { 0, 90, 1 }, { 0, 0, 0 } };
	luminaire l = read_good(luminaire_file_ies(text, 'C', &half, lambert));
	luminaire_facts facts = luminaire_measure(&l);
	assert_near(facts.lumens, 100.0 * M_PI, 3.8e-5 * 100.0 * M_PI, "flux of a Lambertian");
	assert_near(facts.downward, 1.0, 1e-12, "its share downward");
	assert_near(facts.beam[0], 120.0, 0.1, "its beam"); /* twice a step of it, 0.05 */
	assert_near(facts.field[1], 2.0 * acos(0.1) / DEGREE, 0.1, "its field");
	assert_string_equal(l.maker, "Works of M\xc3\xbcller");
	assert_string_equal(l.format, "IES LM-63-2002");
	assert_true(l.horizontals == 1 && l.size[0] == 1.0 && l.size[1] == 2.0 && l.watts == 10.0);
	luminaire_clear(&l);
	l = read_good(luminaire_file_ies(text, 'C', &half, narrow));
	facts = luminaire_measure(&l);
	assert_near(facts.lumens, 250.0 * 2.0 * M_PI / 21.0, 20 * 3.8e-5 * 250.0 * 2.0 * M_PI / 21.0,
				"flux of a cosine to the 20");
	assert_near(facts.beam[0], 2.0 * acos(pow(0.5, 0.05)) / DEGREE, 0.1, "its beam");
	luminaire_clear(&l);
	const luminaire_grid whole = { { 0, 180, 5 }, { 0, 360, 90 } };
	l = read_good(luminaire_file_ies(text, 'C', &whole, even));
	facts = luminaire_measure(&l);
	assert_near(facts.lumens, 28.0 * M_PI, 1e-5, "flux of a ball"); /* angles are float32 */
	assert_near(facts.downward, 0.5, 1e-6, "its share downward");
	luminaire_clear(&l);
}

/* At directions all over the sphere, relative to the most. */
static double furthest_apart(const luminaire *l, luminaire_shape shape, double most_gamma)
{
	double most = 0.0;
	for (int i = 0; i < 2000; i++) {
		double gamma = most_gamma * (i + 0.5) / 2000.0, c = fmod(137.50776 * i, 360.0);
		double g = gamma * DEGREE, t = c * DEGREE;
		double truth = shape(sin(g) * cos(t), sin(g) * sin(t), cos(g));
		most = fmax(most, fabs(luminaire_intensity(l, gamma, c) - truth));
	}
	return most / l->candela;
}

/* Steps of 2.5 and 5 degrees: second derivatives here are below the most, 24: 1/8 of the squares of
 * the steps. */
#define OF_GRID (0.125 * (2.5 * 2.5 + 5.0 * 5.0) * DEGREE * DEGREE)

static void planes_are_mirrored(void **state)
{
	(void)state;
	static const struct {
		double last[2];
		luminaire_shape shape;
	} cases[] = { { { 0, 360 }, uneven },
				  { { 0, 355 }, uneven },
				  { { 0, 180 }, halved },
				  { { 90, 270 }, halved_across },
				  { { 0, 90 }, quartered } };
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		const luminaire_grid grid = { { 0, 180, 2.5 }, { cases[i].last[0], cases[i].last[1], 5 } };
		luminaire l = read_good(luminaire_file_ies(text, 'C', &grid, cases[i].shape));
		assert_near(furthest_apart(&l, cases[i].shape, 180.0), 0.0, OF_GRID, "planes of type C");
		assert_true(l.horizontals == 73);
		luminaire_clear(&l);
	}
}

/* Types B and A of the same lamp as C; that grid, and one of half a degree by two after it. */
static void types_agree(void **state)
{
	(void)state;
	static const char type[] = { 'B', 'A', 'B', 'A' };
	for (int i = 0; i < 4; i++) {
		double from = i < 2 ? -90 : 0;
		luminaire_shape shape = i < 2 ? uneven : quartered;
		const luminaire_grid grid = { { from, 90, 2.5 }, { from, 90, 2.5 } };
		luminaire l = read_good(luminaire_file_ies(text, type[i], &grid, shape));
		assert_true(l.photometry == type[i]);
		assert_near(furthest_apart(&l, shape, 89.0), 0.0, OF_GRID, "planes of types B and A");
		assert_near(luminaire_intensity(&l, 95.0, 10.0), 0.0, 0.0, "behind it");
		luminaire_clear(&l);
	}
}

static void eulumdat_is_the_same(void **state)
{
	(void)state;
	static const luminaire_shape shape[5] = { uneven, round_shape, halved, halved_across,
											  quartered };
	for (int s = 0; s < 5; s++) {
		luminaire l = read_good(luminaire_file_eulumdat(text, s, shape[s]));
		/* Planes 15 degrees apart. */
		assert_near(furthest_apart(&l, shape[s], 180.0), 0.0, 9.0 * OF_GRID, "an EULUMDAT file");
		assert_true(l.lamp_lumens == 2000.0 && l.watts == 25.0 && l.size[0] == 0.2);
		assert_near(l.stated_lumens, 1610.0, 1e-9, "what leaves it");
		assert_string_equal(l.maker, "M\xc3\xbcller");
		luminaire_clear(&l);
	}
}

/* All factors, in the years in which they are factors; feet; tilts; a round opening. */
static void factors_count(void **state)
{
	(void)state;
	static const char *const first[] = { "an old lamp", "IESNA91", "IESNA:LM-63-1995",
										 "IESNA:LM-63-2002", "IES:LM-63-2019" };
	for (int year = 0; year < 5; year++) {
		size_t length = (size_t)sprintf(text,
										"%s\nTILT=INCLUDE\n1\n3\n0 30 90\n1 .9 0.5\n"
										"2 500 3 2 1 1 1 -1 -1 0\n0.5, 0.25, 60\n"
										"0 90\n0\n4 8\n",
										first[year]);
		luminaire l = read_good(length);
		assert_near(l.candela, year < 3 ? 3.0 : 12.0, 1e-12, "the largest intensity");
		assert_true(l.lamp_lumens == 1000.0 && l.watts == 60.0 && l.round);
		assert_near(l.size[0], 0.3048, 1e-9, "a foot");
		assert_near(luminaire_tilt_factor(&l, 60.0), 0.7, 1e-12, "the factor of a tilt");
		assert_near(luminaire_tilt_factor(&l, 120.0), 0.5, 1e-12, "that of a larger one");
		luminaire_clear(&l);
	}
}

/* What stands in a good file, what instead, and words of the sentence. */
typedef struct fault {
	const char *was, *is, *words;
} fault;

static void assert_refused(const char *good, const fault *f)
{
	const char *place = strstr(good, f->was);
	assert_non_null(place);
	size_t before = (size_t)(place - good);
	size_t length =
		(size_t)sprintf(text, "%.*s%s%s", (int)before, good, f->is, place + strlen(f->was));
	luminaire l;
	gw_error error = { 0 };
	if (read_bytes(text, length, &l, &error) != GW_ERROR_DATA)
		fail_msg("'%s' in the place of '%s' is taken", f->is, f->was);
	if (!strstr(error.text, f->words))
		fail_msg("'%s' in the place of '%s' says: %s", f->is, f->was, error.text);
}

static void nonsense_is_refused(void **state)
{
	(void)state;
	static const char good[] = "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 3 2 1 2 0 0 0\n1 1 10\n"
							   "0 45 90\n0 90\n5 4 3\n6 5 4\n";
	static const fault faults[] = {
		{ "TILT=NONE", "TILT=other.tlt", "names another file" },
		{ "6 5 4", "6 5", "the file ends where an intensity should be" },
		{ "1 -1 1 3 2", "1 -1 1 4 2", "bytes left" },
		{ "1 -1 1 3 2", "1 -1 1 3 1", "more intensities than the file announces" },
		{ "1 -1 1 3 2", "1 -1 1 8000 8000", "bytes left" },
		{ "1 -1 1 3 2", "1 -1 1 99999999 2", "must be a whole number from 2 to 8192" },
		{ "1 -1 1 3 2", "1 -1 1 1 2", "must be a whole number from 2" },
		{ "1 -1 1 3 2", "1 -1 1 3 0", "must be a whole number from 1" },
		{ "1 -1 1 3 2", "1 -1 1 2.5 2", "must be a whole number" },
		{ "1 -1 1 3 2", "1 -1 -1 3 2", "the candela multiplier is -1" },
		{ "1 -1 1 3 2", "0 -1 1 3 2", "the number of lamps is 0" },
		{ "1 -1 1 3 2", "1 nan 1 3 2", "not a finite number" },
		{ "2 1 2 0", "2 4 2 0", "the type of the photometry" },
		{ "1 2 0 0", "1 3 0 0", "the unit of lengths" },
		{ "0 45 90\n", "0 45 45\n", "they must ascend" },
		{ "0 45 90\n", "0 45 190\n", "it must be from 0 to 180" },
		{ "0 45 90\n", "0 inf 90\n", "not a finite number" },
		{ "\n0 90\n", "\n0 100\n", "horizontal angles go from 0 to 100" },
		{ "\n0 90\n", "\n10 90\n", "horizontal angles go from 10 to 90" },
		{ "5 4 3", "5 -4 3", "the intensity at vertical angle 45, horizontal angle 0 is -4" },
		{ "5 4 3", "5 nan 3", "not a finite number" },
		{ "5 4 3", "5 1e39 3", "below 3e38" },
		{ "5 4 3", "5 x 3", "this is no number" },
		{ "5 4 3\n6 5 4", "0 0 0\n0 0 0", "it gives no light" },
		{ "1 1 10", "0 1 10", "the ballast factor is 0" },
		{ "1 1 10", "1 1 -10", "the input watts is -10" },
		{ "TILT=NONE", "TILT=INCLUDE\n1 2\n30 20\n1 1", "they must ascend from 0 to 180" },
		{ "TILT=NONE", "TILT=INCLUDE\n1 1000\n", "the number of tilts is 1000" },
		{ "TILT=NONE", "TILT=INCLUDE\n1 1\n0\n-1", "the factor of a tilt is -1" },
	};
	for (size_t i = 0; i < sizeof faults / sizeof *faults; i++)
		assert_refused(good, &faults[i]);
}

static void eulumdat_nonsense_is_refused(void **state)
{
	(void)state;
	static char good[100000];
	static const fault faults[] = {
		{ "\n4\n24\n", "\n5\n24\n", "the symmetry is 5" },
		{ "\n4\n24\n", "\n4\n20\n", "more intensities" },
		{ "\n4\n24\n", "\n4\n8000\n", "bytes left" },
		{ "\n4\n24\n", "\n4\n0\n", "the number of C planes is 0" },
		{ "\n15\n73\n", "\n15\n1e9\n", "must be from 2 to 8192" },
		{ "\n15\n73\n", "\n15\n72\n", "more intensities" },
		{ "\n15\n73\n", "\n15\nmany\n", "not 'many'" },
		{ "\n2000\n", "\nnan\n", "not a finite number" },
		{ "\n2000\n", "\n-2000\n", "the flux of the lamps is -2000" },
		{ "\n2000\n", "\n0\n", "it gives no light" },
		{ "\n30\n", "\n15\n", "horizontal angle 3 is 15 degrees, after 15" },
		{ "\n90\n", "\n95\n", "horizontal angles go from 0 to 95" },
		{ "\n7.5\n", "\n\n", "an angle in a plane should be here, not ''" },
	};
	good[luminaire_file_eulumdat(good, 4, quartered)] = '\0';
	for (size_t i = 0; i < sizeof faults / sizeof *faults; i++)
		assert_refused(good, &faults[i]);
}

/* Cut short at each byte a file is refused, but for its last line's end. */
static void cut_files_are_refused(void **state)
{
	(void)state;
	const luminaire_grid grid = { { 0, 90, 45 }, { 0, 90, 45 } };
	size_t length = luminaire_file_ies(text, 'C', &grid, quartered);
	for (size_t cut = 0; cut + 14 < length; cut++) {
		luminaire l;
		gw_error error = { 0 };
		assert_int_equal(read_bytes(text, cut, &l, &error), GW_ERROR_DATA);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(fluxes_have_closed_forms),
		cmocka_unit_test(planes_are_mirrored),
		cmocka_unit_test(types_agree),
		cmocka_unit_test(eulumdat_is_the_same),
		cmocka_unit_test(factors_count),
		cmocka_unit_test(nonsense_is_refused),
		cmocka_unit_test(eulumdat_nonsense_is_refused),
		cmocka_unit_test(cut_files_are_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

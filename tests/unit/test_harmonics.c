/* Spherical harmonics and their cosine lobe against closed forms. */
#include "base/harmonic_values.h"
#include "base/spherical_harmonics.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#define PI 3.14159265358979323846

/* Constants of the basis have 24 bits, and values are products of up to four such numbers. */
#define ROUNDED 1e-6

/* Integrals by the midpoint rule: exact around the axis for so many steps, and along it off by
 * h^2 / 24 times the change of slope of polynomials of degree 4, under 50. */
#define BELTS 2000
#define AROUND 16
#define INTEGRATED (50.0 / 24.0 * 4.0 / BELTS / BELTS * 2.0 * PI + ROUNDED)

typedef double of_direction(const float d[3], const void *user);

static double integrate(of_direction *f, const void *user)
{
	double sum = 0.0;
	for (int i = 0; i < BELTS; i++)
		for (int k = 0; k < AROUND; k++) {
			double z = -1.0 + (2.0 * i + 1.0) / BELTS, level = sqrt(1.0 - z * z);
			double turn = 2.0 * PI * (k + 0.5) / AROUND;
			const float d[3] = { (float)(level * cos(turn)), (float)(level * sin(turn)), (float)z };
			sum += f(d, user);
		}
	return sum * 4.0 * PI / (BELTS * AROUND);
}

static double product(const float d[3], const void *user)
{
	const int *pair = user;
	float value[GW_HARMONICS_MOST];
	gw_spherical_harmonics(d, 3, value);
	return (double)value[pair[0]] * (double)value[pair[1]];
}

static void orthonormal(void **state)
{
	(void)state;
	for (int i = 0; i < (int)GW_HARMONICS_MOST; i++)
		for (int j = 0; j <= i; j++) {
			double found = integrate(product, (const int[2]){ i, j });
			if (!(fabs(found - (i == j)) <= INTEGRATED))
				fail_msg("harmonics %d and %d: %.9g", i, j, found);
		}
}

static void assert_values(const float d[3], const double expected[GW_HARMONICS_MOST])
{
	float value[GW_HARMONICS_MOST + 1];
	for (int order = 1; order <= 3; order++) {
		value[order * order] = 7.0f;
		gw_spherical_harmonics(d, order, value);
		for (int j = 0; j < order * order; j++)
			if (!(fabs((double)value[j] - expected[j]) <= ROUNDED))
				fail_msg("harmonic %d is %.9g, not %.9g", j, (double)value[j], expected[j]);
		assert_true(value[order * order] == 7.0f); /* nothing behind them is written */
	}
}

/* Order and signs, along an axis and off all of them. */
static void values(void **state)
{
	const double one = sqrt(3.0 / (4.0 * PI)), two = sqrt(15.0 / (4.0 * PI));
	const double zero = 0.5 / sqrt(PI), polar = sqrt(5.0 / (16.0 * PI));
	(void)state;
	assert_values((float[3]){ 1, 0, 0 }, (double[]){ zero, 0, 0, one, 0, 0, -polar, 0, 0.5 * two });
	assert_values((float[3]){ 0, 1, 0 },
				  (double[]){ zero, one, 0, 0, 0, 0, -polar, 0, -0.5 * two });
	assert_values((float[3]){ 0, 0, -1 }, (double[]){ zero, 0, -one, 0, 0, 0, 2.0 * polar, 0, 0 });
	const double x = 2.0 / 7.0, y = -3.0 / 7.0, z = 6.0 / 7.0;
	assert_values((float[3]){ 2.0f / 7.0f, -3.0f / 7.0f, 6.0f / 7.0f },
				  (double[]){ zero, one * y, one * z, one * x, two * x * y, two * y * z,
							  polar * (3.0 * z * z - 1.0), two * x * z,
							  0.5 * two * (x * x - y * y) });
}

/* Harmonic `index` times the cosine with z above the horizon. */
static double below_lobe(const float d[3], const void *user)
{
	const int *index = user;
	float value[GW_HARMONICS_MOST];
	gw_spherical_harmonics(d, 3, value);
	return d[2] > 0.0f ? (double)value[*index] * (double)d[2] : 0.0;
}

/* Irradiance of each harmonic on a plane that faces z is that harmonic along z times its factor. */
static void cosine_lobe(void **state)
{
	float up[GW_HARMONICS_MOST];
	(void)state;
	gw_spherical_harmonics((float[3]){ 0, 0, 1 }, 3, up);
	for (int j = 0; j < (int)GW_HARMONICS_MOST; j++) {
		double found = integrate(below_lobe, &j);
		double expected = (double)harmonic_cosine((uint32_t)j) * (double)up[j];
		/* The lobe's kink lies between two belts. */
		if (!(fabs(found - expected) <= INTEGRATED))
			fail_msg("harmonic %d: %.9g, not %.9g", j, found, expected);
	}
	assert_true(fabs((double)harmonic_cosine(0) - PI) <= ROUNDED);
	assert_true(fabs((double)harmonic_cosine(2) - 2.0 * PI / 3.0) <= ROUNDED);
	assert_true(fabs((double)harmonic_cosine(6) - PI / 4.0) <= ROUNDED);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(orthonormal),
		cmocka_unit_test(values),
		cmocka_unit_test(cosine_lobe),
	};
	return cmocka_run_group_tests_name("harmonics", tests, NULL, NULL);
}

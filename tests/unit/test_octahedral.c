/* The octahedral map against its definition, texels' solid angles against quadrature, smaller maps
 * against brute force; spherical harmonics against closed forms. */
#include "base/spherical_harmonics.h"
#include "light/octahedral.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

#define PI 3.14159265358979323846

/* A direction and back, two square roots and some ten roundings of 2^-24. */
#define ROUNDINGS (16.0 * 0x1p-24)

static void assert_near(const char *what, double found, double expected, double allowed)
{
	if (!(fabs(found - expected) <= allowed))
		fail_msg("%s: %.9g, not %.9g: off by %.3g, allowed %.3g", what, found, expected,
				 fabs(found - expected), allowed);
}

static void there_and_back(void **state)
{
	(void)state;
	for (uint32_t size = 2; size <= 64; size *= 2)
		for (uint32_t texel = 0; texel < size * size; texel++) {
			float u, v, step = 2.0f / (float)size;
			gw_vec3 d = gw_octahedral_texel(size, texel);
			assert_near("length", sqrt((double)gw_dot(d, d)), 1.0, ROUNDINGS);
			gw_octahedral_place(d, &u, &v);
			assert_near("u", (double)u, ((texel % size) + 0.5) * (double)step - 1.0, ROUNDINGS);
			assert_near("v", (double)v, (texel / size + 0.5) * (double)step - 1.0, ROUNDINGS);
		}
}

/* The middle is z, the corners -z, the middles of the sides the other axes. */
static void axes(void **state)
{
	(void)state;
	const struct {
		float u, v;
		gw_vec3 axis;
	} known[] = { { 0, 0, { 0, 0, 1 } },  { 1, 0, { 1, 0, 0 } },   { 0, -1, { 0, -1, 0 } },
				  { 1, 1, { 0, 0, -1 } }, { -1, 1, { 0, 0, -1 } }, { 0, 1, { 0, 1, 0 } } };
	for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
		gw_vec3 d = gw_octahedral_direction(known[i].u, known[i].v);
		assert_near("cosine", (double)gw_dot(d, known[i].axis), 1.0, ROUNDINGS);
	}
}

/* By quadrature: a small piece of a face of the octahedron is seen under its area times
 * 1 / (sqrt(3) |p|^3), where p = (u, v, 1 - |u| - |v|), and that area is sqrt(3) du dv. */
static double solid_angle_by_sum(uint32_t size, uint32_t texel)
{
	const uint32_t steps = 64;
	double sum = 0.0, step = 2.0 / (double)size, piece = step / (double)steps;
	for (uint32_t j = 0; j < steps; j++)
		for (uint32_t i = 0; i < steps; i++) {
			double u = (texel % size) * step - 1.0 + (i + 0.5) * piece;
			double v = (texel / size) * step - 1.0 + (j + 0.5) * piece;
			double z = 1.0 - fabs(u) - fabs(v), x = u, y = v;
			if (z < 0.0) {
				x = 1.0 - fabs(v);
				y = 1.0 - fabs(u);
			}
			sum += piece * piece / pow(x * x + y * y + z * z, 1.5);
		}
	return sum;
}

/* The midpoint rule with 64 steps a side: its relative error is that of the second derivative, of
 * |p|^-3 at most about 40 of its value, over 24 times the square of a step of 2 / (4 * 64). Solid
 * angles come from unit vectors of floats: 2^-22 of a sine. */
static void solid_angles(void **state)
{
	(void)state;
	for (uint32_t size = 4; size <= 128; size *= 2) {
		double sum = 0.0, least = INFINITY, most = 0.0;
		for (uint32_t texel = 0; texel < size * size; texel++) {
			double own = gw_octahedral_solid_angle(size, texel);
			sum += own;
			least = fmin(least, own);
			most = fmax(most, own);
			if (size <= 8)
				assert_near("solid angle", own, solid_angle_by_sum(size, texel), 2e-4 * own);
		}
		assert_near("all solid angles", sum, 4.0 * PI, 1e-5);
		/* |p| is 1 / sqrt(3) in the middle of a face and 1 at its corners. */
		assert_true(most / least < 5.19615243);
	}
}

static void smaller_maps(void **state)
{
	(void)state;
	enum { SIZE = 16 };
	float value[SIZE * SIZE], least[85], most[85];
	assert_int_equal(gw_octahedral_mip_texels(SIZE), 85);
	for (size_t i = 0; i < SIZE * SIZE; i++)
		value[i] = (float)(i * 7919u % 1009u);
	gw_octahedral_mips(SIZE, value, least, most);
	const float *low = least, *high = most;
	for (uint32_t side = SIZE / 2; side > 0; side /= 2) {
		uint32_t wide = SIZE / side;
		for (uint32_t t = 0; t < side * side; t++) {
			float smallest = INFINITY, largest = -INFINITY;
			for (uint32_t i = 0; i < wide * wide; i++) {
				float one = value[(t / side * wide + i / wide) * SIZE + t % side * wide + i % wide];
				smallest = fminf(smallest, one);
				largest = fmaxf(largest, one);
			}
			assert_true(low[t] == smallest && high[t] == largest);
		}
		low += side * side;
		high += side * side;
	}
}

/* Sums over a map of 128 texels a side: products of two harmonics are polynomials of degree 4,
 * whose second derivative across a texel of 2 / 128 is at most some 20; a mean over texels errs by
 * 20 / 24 * (2 / 128)^2 of their values, at most 1.1, over 4 pi. */
#define QUADRATURE 0.002

static void orthonormal(void **state)
{
	(void)state;
	const uint32_t size = 128;
	double product[9][9] = { { 0.0 } };
	for (uint32_t t = 0; t < size * size; t++) {
		gw_vec3 d = gw_octahedral_texel(size, t);
		float value[9];
		gw_spherical_harmonics((const float[3]){ d.x, d.y, d.z }, 3, value);
		for (size_t i = 0; i < 9; i++)
			for (size_t j = 0; j < 9; j++)
				product[i][j] +=
					gw_octahedral_solid_angle(size, t) * (double)value[i] * (double)value[j];
	}
	for (size_t i = 0; i < 9; i++)
		for (size_t j = 0; j < 9; j++)
			assert_near("product", product[i][j], i == j ? 1.0 : 0.0, QUADRATURE);
}

/* Along the axes their values are known, and lower orders are the first of higher ones. */
static void harmonics_of_axes(void **state)
{
	(void)state;
	const double band0 = sqrt(1.0 / (4.0 * PI)), band1 = sqrt(3.0 / (4.0 * PI)),
				 zonal = sqrt(5.0 / (16.0 * PI)), other = sqrt(15.0 / (16.0 * PI));
	const double known[3][9] = { { band0, 0, 0, band1, 0, 0, -zonal, 0, other },
								 { band0, band1, 0, 0, 0, 0, -zonal, 0, -other },
								 { band0, 0, band1, 0, 0, 0, 2 * zonal, 0, 0 } };
	for (size_t axis = 0; axis < 3; axis++)
		for (int order = 1; order <= 3; order++) {
			float direction[3] = { 0 }, value[10];
			direction[axis] = 1.0f;
			value[order * order] = 77.0f;
			gw_spherical_harmonics(direction, order, value);
			for (int i = 0; i < order * order; i++)
				assert_near("harmonic", (double)value[i], known[axis][i], ROUNDINGS);
			assert_true(value[order * order] == 77.0f);
		}
}

/* A texel beside another is so from both, and never further off than two texels are wide: along a
 * face of the octahedron the map is stretched by up to sqrt(3), and across an edge two halves meet.
 */
static void beside(void **state)
{
	(void)state;
	for (uint32_t size = 4; size <= 64; size *= 4)
		for (uint32_t texel = 0; texel < size * size; texel++)
			for (uint32_t side = 0; side < 4; side++) {
				uint32_t other = gw_octahedral_beside(size, texel, side), back = 0;
				assert_true(other < size * size && other != texel);
				for (uint32_t k = 0; k < 4; k++)
					back += gw_octahedral_beside(size, other, k) == texel;
				assert_true(back >= 1);
				gw_vec3 off =
					gw_minus(gw_octahedral_texel(size, texel), gw_octahedral_texel(size, other));
				assert_true(sqrtf(gw_dot(off, off)) < 2.0f * 1.7321f * 2.0f / (float)size);
			}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(there_and_back),
		cmocka_unit_test(axes),
		cmocka_unit_test(beside),
		cmocka_unit_test(solid_angles),
		cmocka_unit_test(smaller_maps),
		cmocka_unit_test(orthonormal),
		cmocka_unit_test(harmonics_of_axes),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

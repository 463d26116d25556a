#include "surfels/mesh_sample.h"

#include <assert.h>
#include <math.h>

/* Twice the area over the square of the longest edge: below this the corners of a triangle with
 * double coordinates lie on a line, and its normal is rounding error. */
#define FLAT 1e-12

/* 2^64 over the golden ratio, odd. */
#define GOLDEN 0x9e3779b97f4a7c15u

void gw_mesh_cross(const double *position, const uint32_t corner[3], double normal[3])
{
	const double *p = position + 3 * (size_t)corner[0];
	const double *q = position + 3 * (size_t)corner[1];
	const double *r = position + 3 * (size_t)corner[2];
	double a[3], b[3];
	for (int k = 0; k < 3; k++) {
		a[k] = q[k] - p[k];
		b[k] = r[k] - p[k];
	}
	for (int k = 0; k < 3; k++) {
		int u = (k + 1) % 3, v = (k + 2) % 3;
		normal[k] = a[u] * b[v] - a[v] * b[u];
	}
}

static double longest_edge_squared(const double *position, const uint32_t corner[3])
{
	double longest = 0.0;
	for (int c = 0; c < 3; c++) {
		const double *p = position + 3 * (size_t)corner[c];
		const double *q = position + 3 * (size_t)corner[(c + 1) % 3];
		double sum = 0.0;
		for (int k = 0; k < 3; k++)
			sum += (q[k] - p[k]) * (q[k] - p[k]);
		longest = sum > longest ? sum : longest;
	}
	return longest;
}

double gw_mesh_areas(const double *position, const uint32_t *corner, size_t triangles, double *sum,
					 size_t *degenerate)
{
	double total = 0.0;
	*degenerate = 0;
	for (size_t t = 0; t < triangles; t++) {
		double n[3];
		gw_mesh_cross(position, corner + 3 * t, n);
		double doubled = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
		if (isfinite(doubled) && doubled > FLAT * longest_edge_squared(position, corner + 3 * t))
			total += 0.5 * doubled;
		else
			++*degenerate;
		sum[t] = total;
	}
	return total;
}

/* SplitMix64's finaliser: a number that looks random for each key. */
static uint64_t hash(uint64_t key)
{
	key = (key ^ key >> 30) * 0xbf58476d1ce4e5b9u;
	key = (key ^ key >> 27) * 0x94d049bb133111ebu;
	return key ^ key >> 31;
}

/* The upper 53 bits as a number in [0, 1). */
static double fraction(uint64_t bits)
{
	return (double)(bits >> 11) * 0x1p-53;
}

/* The first triangle whose sum is above `at`; all of them have area. */
static size_t find(const double *sum, size_t triangles, double at)
{
	size_t low = 0, high = triangles - 1;
	while (low < high) {
		size_t middle = low + (high - low) / 2;
		if (sum[middle] > at)
			high = middle;
		else
			low = middle + 1;
	}
	return low;
}

gw_mesh_place gw_mesh_place_of(const double *sum, size_t triangles, uint64_t count, uint64_t seed,
							   uint64_t index)
{
	assert(triangles > 0 && index < count);
	double total = sum[triangles - 1];
	uint64_t key = hash(seed + GOLDEN);
	double jitter = fraction(hash(key + GOLDEN * (index + 1)));
	double at = ((double)index + jitter) / (double)count * total;
	/* Rounding must not lead behind the last triangle that has area. */
	at = at < total ? at : nextafter(total, 0.0);
	size_t t = find(sum, triangles, at);
	double before = t > 0 ? sum[t - 1] : 0.0;
	double r1 = (at - before) / (sum[t] - before);
	double r2 = fraction(GOLDEN * index + hash(key));
	double root = sqrt(r1 < 1.0 ? r1 : 1.0);
	return (gw_mesh_place){ t, { 1.0 - root, (1.0 - r2) * root, r2 * root } };
}

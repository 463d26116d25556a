/* nearest_plane.c - see nearest_plane.h. */
#include "normals/nearest_plane.h"

#include <math.h>
#include <string.h>

#define FEW 4

/* So much wider than a line they are, in squares: where columns of a scan are further apart
 * than its rows, or on a wire, the nearest few lie on a line, and a plane through it is what noise
 * makes of it. 0.01 to 0.1 do as well (measured). */
#define FEW_LINE_RATIO 0.03

size_t gw_places_around(const gw_surfels *s, size_t surfel, const gw_neighbour_list *list,
						float point[3 * (GW_NEIGHBOURS + 1)])
{
	double reach = list->count ? (double)list->distance[list->count - 1] : 1;
	memset(point, 0, 3 * sizeof *point);
	for (uint32_t j = 0; j < list->count; j++)
		for (size_t k = 0; k < 3; k++) {
			double d = (double)s->position[3 * (size_t)list->index[j] + k] -
					   (double)s->position[3 * surfel + k];
			point[3 * (j + 1) + k] = (float)(d / reach);
		}
	return list->count + 1u;
}

bool gw_plane_is_spanned(const float *point, size_t count, const float normal[3], double least)
{
	float t[3], b[3];
	double u = 0, v = 0, uu = 0, uv = 0, vv = 0;
	gw_tangent_frame(normal, t, b);
	for (size_t i = 0; i < count; i++) {
		const float *p = point + 3 * i;
		double x = (double)(p[0] * t[0] + p[1] * t[1] + p[2] * t[2]);
		double y = (double)(p[0] * b[0] + p[1] * b[1] + p[2] * b[2]);
		u += x;
		v += y;
		uu += x * x;
		uv += x * y;
		vv += y * y;
	}
	double n = (double)count;
	double a = uu - u * u / n, c = vv - v * v / n, mixed = uv - u * v / n;
	double half = 0.5 * (a + c), root = sqrt(0.25 * (a - c) * (a - c) + mixed * mixed);
	return half - root > least * (half + root);
}

/* The first point and those nearest to it, in order; returns how many of these. */
static size_t take_nearest(const float *point, size_t count, float few[3 * (FEW + 1)],
						   float squared[FEW + 1])
{
	size_t kept = 0;
	memset(few, 0, 3 * (FEW + 1) * sizeof *few);
	for (size_t i = 1; i < count; i++) {
		const float *p = point + 3 * i;
		size_t at = kept; /* kept in order of distance; one too many falls off the end */
		float d = p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
		for (; at > 0 && d < squared[at - 1]; at--)
			squared[at] = squared[at - 1];
		squared[at] = d;
		if (at < FEW) {
			memmove(few + 3 * (at + 2), few + 3 * (at + 1), 3 * (FEW - 1 - at) * sizeof *few);
			memcpy(few + 3 * (at + 1), p, 3 * sizeof *few);
		}
		kept += kept < FEW;
	}
	return kept;
}

gw_plane gw_nearest_plane(const float *point, size_t count, float apart, float plane[4])
{
	float few[3 * (FEW + 1)], squared[FEW + 1], own[4];
	if (take_nearest(point, count, few, squared) < FEW || !(squared[FEW - 1] < apart * apart))
		return GW_PLANE_NONE;
	gw_plane found = gw_plane_normal(few, FEW + 1, own, own + 3);
	if (found == GW_PLANE_FOUND && !gw_plane_is_spanned(few, FEW + 1, own, FEW_LINE_RATIO))
		found = GW_PLANE_NONE;
	if (found == GW_PLANE_FOUND)
		memcpy(plane, own, sizeof own);
	return found;
}

/* So much wider than a line are those that count, in squares; across a line of points noise makes a
 * plane that leaves nothing. */
#define NEAR_LINE_RATIO 0.15

/* Three numbers of a plane are fitted to so many points of equal weight. */
#define PLANE_NUMBERS 3.0

/* Sums over weighted points, about their mean once that is taken off. */
typedef struct weighted_sums {
	double weight, squared_weight, mean[3], covariance[6];
} weighted_sums;

static double nearness(const float *p)
{
	double squared = (double)(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
	double left = fmax(1 - squared, 0);
	return left * left * left;
}

static void sum_by_nearness(const float *point, size_t count, weighted_sums *sums)
{
	double *c = sums->covariance, *m = sums->mean;
	memset(sums, 0, sizeof *sums);
	for (size_t i = 0; i < count; i++) {
		const float *p = point + 3 * i;
		double w = nearness(p), x = (double)p[0], y = (double)p[1], z = (double)p[2];
		sums->weight += w;
		sums->squared_weight += w * w;
		m[0] += w * x, m[1] += w * y, m[2] += w * z;
		c[0] += w * x * x, c[1] += w * x * y, c[2] += w * x * z;
		c[3] += w * y * y, c[4] += w * y * z, c[5] += w * z * z;
	}
	for (int k = 0; k < 3; k++)
		m[k] /= sums->weight;
	for (int k = 0, at = 0; k < 3; k++)
		for (int l = k; l < 3; l++, at++)
			c[at] = c[at] / sums->weight - m[k] * m[l];
}

/* The two greater eigenvalues of a covariance whose least is known: whether the lesser of them is
 * more than a share of the greater. */
static bool is_wider(const double c[6], double least, double share)
{
	double both = c[0] + c[3] + c[5] - least;
	double minors =
		c[0] * c[3] - c[1] * c[1] + c[0] * c[5] - c[2] * c[2] + c[3] * c[5] - c[4] * c[4];
	double half = 0.5 * both, root = sqrt(fmax(half * half - (minors - least * both), 0));
	return half - root > share * (half + root);
}

/* Of the variance that was there, what is left beside a plane of so many points, on the average. */
static double left_over(double points)
{
	return fmax(1 - PLANE_NUMBERS / points, 0.1);
}

bool gw_plane_by_nearness(const float *point, size_t count, double spread, float plane[4])
{
	weighted_sums sums;
	double normal[3], least;
	sum_by_nearness(point, count, &sums);
	if (!gw_plane_of_covariance(sums.covariance, normal, &least) ||
		!is_wider(sums.covariance, least, NEAR_LINE_RATIO))
		return false;
	double points = sums.weight * sums.weight / sums.squared_weight;
	for (int k = 0; k < 3; k++)
		plane[k] = (float)normal[k];
	plane[3] = (float)(fmax(least, 0) / spread * left_over((double)count) / left_over(points));
	return true;
}

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

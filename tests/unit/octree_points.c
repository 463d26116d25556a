/*
 * octree_points.c - see octree_points.h.
 */
#include "octree_points.h"

#include "octree/octree.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* SplitMix64 (Steele et al. 2014). */
double octree_points_random(uint64_t *state)
{
	uint64_t z = *state += UINT64_C(0x9e3779b97f4a7c15);
	z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
	z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
	z ^= z >> 31;
	return (double)(z >> 11) * 0x1p-53;
}

bool octree_points_make(size_t count, bool emission, gw_surfels *s)
{
	memset(s, 0, sizeof *s);
	s->count = count;
	s->position = calloc(3 * count, sizeof(float));
	s->normal = calloc(3 * count, sizeof(float));
	s->albedo = calloc(3 * count, sizeof(float));
	s->emission = emission ? calloc(3 * count, sizeof(float)) : NULL;
	s->nearest = calloc(count, sizeof(float));
	s->radius = calloc(count, sizeof(float));
	s->area = calloc(count, sizeof(float));
	s->clip = calloc(6 * count, sizeof(float));
	s->two_sided = calloc(count, 1);
	if (!s->position || !s->normal || !s->albedo || !s->nearest || !s->radius || !s->area ||
		!s->clip || !s->two_sided || (emission && !s->emission)) {
		gw_surfels_clear(s);
		return false;
	}
	for (size_t i = 0; i < count; i++)
		s->normal[3 * i + 2] = 1;
	return true;
}

void octree_points_bound(gw_surfels *s)
{
	for (int k = 0; k < 3; k++) {
		s->minimum[k] = s->maximum[k] = s->position[k];
		for (size_t i = 1; i < s->count; i++) {
			s->minimum[k] = fminf(s->minimum[k], s->position[3 * i + (size_t)k]);
			s->maximum[k] = fmaxf(s->maximum[k], s->position[3 * i + (size_t)k]);
		}
	}
}

/* A point on its way to its place. */
typedef struct placed {
	uint64_t key;
	double position[3];
} placed;

static int compare_placed(const void *a, const void *b)
{
	uint64_t x = ((const placed *)a)->key, y = ((const placed *)b)->key;
	return x < y ? -1 : x > y;
}

/* Random points on the unit sphere, in the order of Morton keys, as surfels are. */
static placed *place_on_sphere(size_t count, uint64_t seed)
{
	const double pi = 3.14159265358979323846;
	placed *place = calloc(count, sizeof *place);
	for (size_t i = 0; i < count && place != NULL; i++) {
		double z = 2 * octree_points_random(&seed) - 1, turn = 2 * pi * octree_points_random(&seed);
		double ring = sqrt(1 - z * z), p[3] = { ring * cos(turn), ring * sin(turn), z };
		uint32_t cell[3];
		for (int k = 0; k < 3; k++)
			cell[k] = (uint32_t)((p[k] * 0.5 + 0.5) * 0x1fffff);
		memcpy(place[i].position, p, sizeof p);
		place[i].key = gw_morton_encode(cell[0], cell[1], cell[2]);
	}
	if (place != NULL)
		qsort(place, count, sizeof *place, compare_placed);
	return place;
}

bool octree_points_sphere(size_t count, uint64_t seed, gw_surfels *s)
{
	const double pi = 3.14159265358979323846;
	placed *place = place_on_sphere(count, seed);
	if (place == NULL || !octree_points_make(count, false, s)) {
		free(place);
		return false;
	}
	double area = 4 * pi / (double)count;
	for (size_t i = 0; i < count; i++) {
		for (size_t k = 0; k < 3; k++) {
			double p = place[i].position[k];
			s->position[3 * i + k] = s->normal[3 * i + k] = (float)p;
			s->albedo[3 * i + k] = (float)(0.5 + 0.4 * p);
		}
		/* Random points: the k-th neighbour is at sqrt(k area / pi) on average. */
		s->radius[i] = (float)sqrt(8 * area / pi);
		s->nearest[i] = (float)(0.5 * sqrt(area));
		s->area[i] = (float)area;
	}
	free(place);
	s->spacing = (float)sqrt(area);
	octree_points_bound(s);
	return true;
}

/* surfel_crease.c - see surfel_crease.h. */
#include "surfels/surfel_crease.h"

#include <math.h>

#define CREASE_VOTES 3   /* neighbours that have to agree on a crease */
#define CREASE_DOUBT 0.1 /* by how much a point may lie on the wrong side, of the reach */

/* Where the surfel's plane meets other surfaces: one line a neighbour on such a surface. */
typedef struct crease_lines {
	gw_half_plane line[GW_NEIGHBOURS];
	uint32_t count;
} crease_lines;

/*
 * The line in the surfel's plane where that of a neighbour on another surface crosses it. In a
 * concave crease each point lies in front of the other's plane, in a convex one behind it; where
 * the two disagree by more than doubt allows, the surfaces do not meet there.
 */
static bool find_crease(const gw_surfels *s, size_t surfel, size_t other, double reach,
						gw_half_plane *line)
{
	const float *n = s->normal + 3 * surfel, *m = s->normal + 3 * other;
	float t[3], b[3];
	double cosine = 0, x = 0, y = 0, ahead = 0, facing = 0;
	/* Most neighbours lie on the same surface: there is no more to find out about them. */
	for (size_t k = 0; k < 3; k++)
		cosine += (double)(n[k] * m[k]);
	if (fabs(cosine) > GW_SAME_SURFACE || s->two_sided[surfel] || s->two_sided[other])
		return false;
	gw_tangent_frame(n, t, b);
	for (size_t k = 0; k < 3; k++) {
		double d = (double)s->position[3 * other + k] - (double)s->position[3 * surfel + k];
		x += (double)(m[k] * t[k]);
		y += (double)(m[k] * b[k]);
		ahead += (double)n[k] * d;
		facing -= (double)m[k] * d;
	}
	double side = ahead + facing < 0 ? -1 : 1, slope = sqrt(x * x + y * y);
	if (fmin(side * ahead, side * facing) < -CREASE_DOUBT * reach)
		return false;
	*line = (gw_half_plane){ -side * x / slope, -side * y / slope, fmax(side * facing, 0) / slope };
	return line->offset < reach;
}

static void find_creases(const gw_surfels *s, size_t surfel, const gw_neighbour_list *list,
						 double reach, crease_lines *creases)
{
	creases->count = 0;
	for (uint32_t j = 0; j < list->count; j++)
		creases->count +=
			find_crease(s, surfel, list->index[j], reach, creases->line + creases->count);
}

/* The mean of the lines that agree with the nearest one, which are then taken off the list. */
static uint32_t merge_lines(crease_lines *creases, double reach, gw_half_plane *mean)
{
	uint32_t left = 0, votes = 0;
	gw_half_plane nearest = creases->line[0];
	*mean = (gw_half_plane){ 0, 0, 0 };
	for (uint32_t j = 1; j < creases->count; j++)
		if (creases->line[j].offset < nearest.offset)
			nearest = creases->line[j];
	for (uint32_t j = 0; j < creases->count; j++) {
		gw_half_plane line = creases->line[j];
		if (gw_distance_along(&nearest, line.x, line.y) < 0.7 ||
			line.offset - nearest.offset > 0.35 * reach) {
			creases->line[left++] = line;
			continue;
		}
		votes++;
		mean->x += line.x;
		mean->y += line.y;
		mean->offset += line.offset;
	}
	creases->count = left;
	double length = hypot(mean->x, mean->y);
	*mean = (gw_half_plane){ mean->x / length, mean->y / length, mean->offset / votes };
	return votes;
}

uint32_t gw_creases_find(const gw_surfels *s, size_t surfel, const gw_neighbour_list *list,
						 double reach, gw_half_plane edge[2])
{
	crease_lines creases;
	uint32_t found = 0;
	find_creases(s, surfel, list, reach, &creases);
	while (creases.count > 0 && found < 2) {
		if (merge_lines(&creases, reach, edge + found) >= CREASE_VOTES)
			found++;
	}
	return found;
}

bool gw_plane_meets_crease(const gw_surfels *s, size_t surfel, const gw_neighbour_list *list,
						   gw_half_plane *edge, double reach)
{
	crease_lines creases;
	gw_half_plane line;
	find_creases(s, surfel, list, GW_VOID_WIDTH * reach, &creases);
	while (creases.count > 0)
		if (merge_lines(&creases, reach, &line) >= CREASE_VOTES &&
			gw_distance_along(edge, line.x, line.y) > 0.7 && line.offset > edge->offset) {
			*edge = line;
			return true;
		}
	return false;
}

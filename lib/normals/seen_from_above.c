/* seen_from_above.c - see seen_from_above.h. */
#include "normals/seen_from_above.h"

#include "base/memory.h"
#include "base/nth_element.h"
#include "base/up_axis.h"

#include <math.h>
#include <stdlib.h>

/*
 * Metres between points, and across the plan, from which on a cloud may be airborne: the beam of
 * such a scanner is decimetres wide. Measured where trees or roofs need it: 0.44 to 37 m and 33 m
 * or more; rooms, caves and things, as scanners on tripods and cameras see them, 0.002 to 0.056 m.
 */
#define APART_LEAST 0.1
#define WIDE_LEAST 15.0

/* Points that one sheet of surface has in a cell of the plan, on average. */
#define CELL_POINTS 8.0
/* Cell widths that two layers of surface are apart. Within as much a steep slope stays. */
#define LAYER_GAP 2.0
/* So much of the plan has several layers at most. Measured: 0.21 of a wood, 0.05 of houses and
 * trees on a slope, less of others; 0.53 of a corridor, 0.72 of a cave, 0.77 of rooms. */
#define LAYERED_MOST 0.33

/* Of more points every second, third ... one is looked at: shares need no more. */
#define POINTS_MOST 131072u

/* A point as the plan has it. */
typedef struct plan_point {
	int32_t cell[2];
	float height;
} plan_point;

/* The plan, in cells of a width. */
typedef struct plan {
	plan_point *points;
	size_t count;
	double cell;
} plan;

static int by_cell_and_height(const void *left, const void *right)
{
	const plan_point *a = left, *b = right;
	for (int k = 0; k < 2; k++)
		if (a->cell[k] != b->cell[k])
			return a->cell[k] < b->cell[k] ? -1 : 1;
	return a->height < b->height ? -1 : a->height > b->height;
}

static void fill_plan(const gw_surfels *surfels, size_t step, plan *p)
{
	double up[3];
	gw_up_axis(surfels->up, up);
	size_t axis = up[0] != 0 ? 0 : up[1] != 0 ? 1 : 2;
	for (size_t i = 0; i < p->count; i++) {
		const float *at = surfels->position + 3 * i * step;
		for (size_t k = 0; k < 2; k++) {
			size_t along = (axis + 1 + k) % 3;
			double from_low = (double)at[along] - (double)surfels->minimum[along];
			p->points[i].cell[k] = (int32_t)fmin(from_low / p->cell, INT32_MAX);
		}
		p->points[i].height = at[axis];
	}
	qsort(p->points, p->count, sizeof *p->points, by_cell_and_height);
}

/* Whether the plan is wide, and one layer lies over most of it. */
static bool is_one_layer(const plan *p)
{
	size_t cells = 0, layered = 0;
	for (size_t i = 0, next; i < p->count; i = next) {
		double gap = 0;
		for (next = i + 1; next < p->count; next++) {
			const plan_point *a = p->points + next - 1, *b = p->points + next;
			if (a->cell[0] != b->cell[0] || a->cell[1] != b->cell[1])
				break;
			gap = fmax(gap, fabs((double)b->height - (double)a->height));
		}
		cells++;
		layered += gap > LAYER_GAP * p->cell;
	}
	return sqrt((double)cells) * p->cell >= WIDE_LEAST &&
		   (double)layered <= LAYERED_MOST * (double)cells;
}

gw_status gw_is_one_wide_layer(const gw_surfels *surfels, const float *area, bool *is_wide,
							   gw_error *error)
{
	size_t step = surfels->count / POINTS_MOST + 1;
	double each =
		surfels->count ? (double)gw_nth_element(area, surfels->count, surfels->count / 2) : 0.0;
	*is_wide = false;
	if (!(sqrt(each) >= APART_LEAST))
		return GW_OK;
	plan p = { .count = surfels->count / step, .cell = sqrt(CELL_POINTS * (double)step * each) };
	p.points = gw_allocate_array(p.count, sizeof *p.points);
	if (!p.points)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the plan of %zu points", p.count);
	fill_plan(surfels, step, &p);
	*is_wide = is_one_layer(&p);
	free(p.points);
	return GW_OK;
}

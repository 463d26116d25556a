/*
 * disc_width.c - how wide a disc may be at most.
 *
 * A disc reaches to its neighbours because the surface between them and its surfel has no other
 * points. Some points alone in the middle of a lake, behind a window or beyond the end of a room
 * have their next neighbours far off, all around even, but those are much nearer to each other: had
 * there been surface as far as to them, it would have as many points. So a disc is hardly wider
 * than those of the neighbours that it reaches to. Where the cloud becomes denser, some of them lie
 * on the other side, where it is as sparse as at the surfel.
 */
#include "surfels/surfel_disc.h"

#include "base/memory.h"
#include "surfels/surfel_plane.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

/* How much wider a disc may be than those it reaches to, and the share of these that have to be as
 * wide as that asks for. */
#define WIDER 3.0f
#define SHARE 4 /* one in so many */

/* From this share of the radius on a neighbour is one that the disc reaches to. Those nearer may
 * be as alone as the surfel. */
#define REACHED 0.3

typedef struct width_step {
	gw_surfels *surfels;
	float *radius, *area; /* count, receive those of the bounded discs */
	bool rough_area;
} width_step;

static bool is_much_wider(const gw_surfels *s, size_t surfel, const gw_neighbour_list *list)
{
	float least = INFINITY;
	for (uint32_t j = 0; j < list->count; j++)
		least = fminf(least, s->radius[list->index[j]]);
	return s->radius[surfel] > WIDER * least;
}

/* The most that the neighbours in a surfel's plane allow. */
static float widest(const gw_surfels *s, size_t surfel, const gw_flat_point *kept, uint32_t count)
{
	float around[GW_NEIGHBOURS]; /* sorted, widest first */
	uint32_t reached = 0;
	for (uint32_t j = 0; j < count; j++) {
		if (kept[j].distance < REACHED * (double)s->radius[surfel])
			continue;
		float other = s->radius[kept[j].index];
		uint32_t at = reached++;
		for (; at > 0 && other > around[at - 1]; at--)
			around[at] = around[at - 1];
		around[at] = other;
	}
	return reached > 0 ? WIDER * around[reached / SHARE] : INFINITY;
}

static void bound(void *user, size_t surfel, const gw_neighbour_list *list)
{
	width_step *step = user;
	const gw_surfels *s = step->surfels;
	gw_flat_point kept[GW_NEIGHBOURS];
	double noise;
	step->radius[surfel] = s->radius[surfel];
	step->area[surfel] = s->area[surfel];
	uint32_t count =
		is_much_wider(s, surfel, list) ? gw_plane_surface(s, surfel, list, kept, &noise) : 0;
	float most = widest(s, surfel, kept, count);
	if (!(s->radius[surfel] > most))
		return;
	double radius = (double)most, reach = (double)list->distance[list->count - 1];
	gw_half_plane edge[2];
	uint32_t edges = gw_plane_load_clips(s, surfel, edge);
	double area = step->rough_area ? M_PI * radius * radius / GW_DISC_RANK
								   : gw_plane_cell_area(kept, count, radius, reach, edge, edges);
	step->radius[surfel] = fmaxf(most, FLT_MIN);
	step->area[surfel] = fmaxf(fminf((float)area, s->area[surfel]), FLT_MIN);
}

gw_status gw_disc_widths_bound(gw_neighbours *search, gw_surfels *surfels, bool rough_area,
							   gw_error *error)
{
	width_step step = { .surfels = surfels, .rough_area = rough_area };
	step.radius = gw_allocate_array(surfels->count, sizeof *step.radius);
	step.area = gw_allocate_array(surfels->count, sizeof *step.area);
	gw_status status = GW_OK;
	if (!step.radius || !step.area)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory for the widths of %zu points",
						 surfels->count);
	if (status == GW_OK)
		status = gw_neighbours_visit_reach(search, bound, &step, error);
	if (status != GW_OK) {
		free(step.radius);
		free(step.area);
		return status;
	}
	free(surfels->radius);
	free(surfels->area);
	surfels->radius = step.radius;
	surfels->area = step.area;
	return GW_OK;
}

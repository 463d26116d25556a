/* viewpoint.c - from where to look at a cloud; see glowworm_picture.h. */
#include "picture/viewpoint_steps.h"

#include <math.h>

double gw_viewpoint_enclosure(const gw_surfels *s)
{
	double centre[3] = { 0, 0, 0 }, area = 0, sum = 0, magnitude = 0;
	for (size_t i = 0; i < s->count; i++) {
		double a = s->two_sided[i] ? 0.0 : (double)s->area[i];
		for (size_t k = 0; k < 3; k++)
			centre[k] += a * (double)s->position[3 * i + k];
		area += a;
	}
	for (size_t i = 0; i < s->count && area > 0.0; i++) {
		double term = 0;
		for (size_t k = 0; k < 3; k++)
			term +=
				((double)s->position[3 * i + k] - centre[k] / area) * (double)s->normal[3 * i + k];
		term *= s->two_sided[i] ? 0.0 : (double)s->area[i];
		sum -= term;
		magnitude += fabs(term);
	}
	return magnitude > 0.0 ? sum / magnitude : 0.0;
}

#define FLAT 0.97       /* cosine of the slope of what is flat */
#define FLAT_SHARE 0.4  /* of the surface, that ground has */
#define FLAT_OTHER 0.25 /* times that: what may be flat across the other axis */
#define FLAT_HEIGHT 0.5 /* of the width, the most of what lies on ground */

/* The axis across which the surface lies flat, if that is not the one that points up. */
static char find_flat(const view_space *v)
{
	double share[3] = { 0, 0, 0 };
	for (size_t i = 0; i < v->count; i++)
		for (int k = 0; k < 3 && v->cell[i].area > 0.0f; k++)
			if (fabsf(v->cell[i].normal[k]) > (float)FLAT * v->cell[i].area)
				share[k] += (double)v->cell[i].area / v->area;
	int flat = share[1] > share[2] ? 1 : 2;
	int other = 3 - flat;
	bool lies = share[flat] > FLAT_SHARE && share[other] < FLAT_OTHER * share[flat];
	for (int k = 0; k < 3; k++)
		lies = lies &&
			   (k == flat || v->high[flat] - v->low[flat] < FLAT_HEIGHT * (v->high[k] - v->low[k]));
	return lies && v->up[flat] == 0.0 ? (char)('x' + flat) : 0;
}

/* Share of the light that a view from outside shows of what is lit there, at least. */
#define SHOWN_LEAST 0.25
#define OWN_CELLS 2 /* around a surface that do not hide it */

/* Whether what is in a cell is seen from a place, in cells, by its front. */
static bool shows(const view_space *v, size_t cell, const double place[3])
{
	double way[3], length;
	int32_t at[3];
	gw_view_space_place(v, cell, at);
	for (int k = 0; k < 3; k++)
		way[k] = place[k] - at[k];
	length = sqrt(view_dot(way, way));
	for (int k = 0; k < 3; k++)
		way[k] /= length;
	if (!(gw_view_space_facing(v, cell, way) > 0))
		return false;
	view_hit hit = gw_view_space_look(v, at, way, OWN_CELLS);
	return !(hit.depth > 0 && hit.depth < length);
}

/* The share of the light that comes from what is seen from a place in the points' coordinates. */
static double share_shown(const view_space *v, const double place[3])
{
	double all = 0, shown = 0, cell[3];
	for (size_t k = 0; k < 3; k++)
		cell[k] = (place[k] - v->surfels->origin[k] - v->least[k]) / v->width - 0.5;
	for (size_t i = 0; i < v->count; i++)
		if (v->cell[i].light > 0.0f) {
			all += (double)v->cell[i].light;
			shown += shows(v, i, cell) ? (double)v->cell[i].light : 0;
		}
	return all > 0 ? shown / all : 1;
}

/* Goes inside where most of the light is there and none of that is seen from outside: lamps light
 * rooms of a building of which the rest is dark. Where there is no place with a better view, or
 * nobody knows which sides are fronts, the viewpoint stays. */
static void go_to_light(const view_space *v, gw_viewpoint *viewpoint)
{
	gw_viewpoint within = { .flat = viewpoint->flat };
	double shown = v->wish->luminance && v->sided ? share_shown(v, viewpoint->at) : 1;
	if (!(shown < SHOWN_LEAST))
		return;
	gw_viewpoint_within(v, &within);
	if (within.inside && share_shown(v, within.at) > SHOWN_LEAST)
		*viewpoint = within;
}

static gw_status find_in(const view_space *space, const gw_viewpoint_wish *wish,
						 gw_viewpoint *viewpoint, gw_error *error)
{
	bool inside = wish->kind == GW_VIEWPOINT_INSIDE;
	viewpoint->flat = find_flat(space);
	if (wish->kind == GW_VIEWPOINT_AUTO && !wish->around)
		GW_TRY(gw_viewpoint_of_scanner(space, viewpoint, error));
	if (viewpoint->from_scanner)
		return GW_OK;
	if (wish->kind == GW_VIEWPOINT_AUTO)
		GW_TRY(gw_viewpoint_is_inside(space, &inside, error));
	if (inside)
		gw_viewpoint_within(space, viewpoint);
	if (viewpoint->inside)
		return GW_OK;
	GW_TRY(gw_viewpoint_without(space, viewpoint, error));
	if (wish->kind == GW_VIEWPOINT_AUTO)
		go_to_light(space, viewpoint);
	return GW_OK;
}

gw_status gw_viewpoint_find(const gw_surfels *surfels, const gw_viewpoint_wish *wish,
							gw_viewpoint *viewpoint, gw_error *error)
{
	*viewpoint = (gw_viewpoint){ .inside = false };
	view_space space;
	gw_status status = gw_view_space_make(surfels, wish, &space, error);
	if (status == GW_OK)
		status = find_in(&space, wish, viewpoint, error);
	gw_view_space_clear(&space);
	return status;
}

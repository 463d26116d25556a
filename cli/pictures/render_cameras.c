#include "pictures/render_cameras.h"
#include "options/options.h"

#include "glowworm_host.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Nearest distance that is seen, in spacings of the points: nothing closer has any detail. */
#define NEAR 0.05

#define LOOKED_THROUGH 64 /* pictures; of more, nearly everything is in some */
#define SURROUNDINGS 4.0f /* radii around a picture that belong to it */

gw_status camera_plan_read(const settings *s, camera_plan *plan, gw_error *error)
{
	*plan = (camera_plan){ .orbit = s->render.orbit };
	if (s->render.path) {
		const option *camera = option_find(VERB_RENDER, "camera", 6);
		if (s->given[camera - options] == SETTINGS_BY_COMMAND)
			return gw_fail(error, GW_ERROR_USAGE,
						   "the cameras come from --path or from --camera, not from both");
		return camera_text_read_file(s->render.path, &plan->text, &plan->text_count, error);
	}
	plan->text = calloc(1, sizeof *plan->text);
	if (!plan->text)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a camera");
	plan->text_count = 1;
	gw_status status = camera_text_read("--camera", s->render.camera, plan->text, error);
	if (status != GW_OK)
		camera_plan_clear(plan);
	return status;
}

void camera_plan_clear(camera_plan *plan)
{
	free(plan->text);
	free(plan->view);
	*plan = (camera_plan){ .text = NULL };
}

size_t camera_plan_count(const camera_plan *plan)
{
	return plan->text_count * plan->orbit;
}

#define ROUNDING 1e-10 /* of CAMERA_TEXT_NUMBER */

/* To the digits that a camera is printed with, so that it takes the same picture again; and what is
 * less than a rounding of the longest way along an axis is none. */
static void round_view(const coordinates *place, gw_viewpoint *view)
{
	double longest = 0.0;
	coordinates_from_metres(place, view->at);
	coordinates_from_metres(place, view->to);
	for (int k = 0; k < 3; k++)
		longest = fmax(longest, fabs(view->to[k] - view->at[k]));
	for (int k = 0; k < 6; k++) {
		double *number = k < 3 ? view->at + k : view->to + k - 3;
		char text[64];
		snprintf(text, sizeof text, CAMERA_TEXT_NUMBER, *number);
		*number = fabs(*number) < ROUNDING * longest ? 0.0 : strtod(text, NULL);
	}
	coordinates_to_metres(place, view->at);
	coordinates_to_metres(place, view->to);
}

/* With -y up and all in front of the origin along z, a depth camera stood there. */
static bool is_camera_frame(char up, const gw_surfels *s)
{
	return up == 'Y' && s->origin[2] + (double)s->minimum[2] > 0.0;
}

gw_status camera_plan_place(camera_plan *plan, const render_scene *scene, const gw_surfels *surfels,
							double aspect, gw_error *error)
{
	static const double origin[3] = { 0 };
	plan->up = scene->up;
	bool seen = scene->scanner_count == 0 && is_camera_frame(plan->up, surfels);
	const double *seen_from = seen ? origin : scene->scanner;
	plan->view = calloc(plan->text_count, sizeof *plan->view);
	if (!plan->view)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu cameras", plan->text_count);
	for (size_t i = 0; i < plan->text_count; i++) {
		const camera_text *text = plan->text + i;
		gw_viewpoint *view = plan->view + i;
		if (text->placed) {
			view->angle = text->angle > 0.0 ? text->angle : CAMERA_TEXT_ANGLE;
			memcpy(view->at, text->at, sizeof view->at);
			memcpy(view->to, text->to, sizeof view->to);
			coordinates_to_metres(&scene->place, view->at);
			coordinates_to_metres(&scene->place, view->to);
		} else {
			bool within = scene->enclosed && text->kind == GW_VIEWPOINT_AUTO;
			const gw_viewpoint_wish wish = { .kind = within ? GW_VIEWPOINT_INSIDE : text->kind,
											 .luminance = scene->luminance,
											 .up = plan->up,
											 .angle = text->angle,
											 .aspect = aspect,
											 .around = plan->orbit > 1,
											 .scanner = seen_from,
											 .scanner_count = seen ? 1 : scene->scanner_count };
			/* Its normals face where light came from. */
			gw_surfels unsided = *surfels;
			unsided.normals_given = within ? 0 : surfels->normals_given;
			GW_TRY(gw_viewpoint_find(&unsided, &wish, view, error));
			round_view(&scene->place, view);
		}
	}
	return GW_OK;
}

/*
 * The widest disc anywhere near. Where points that are far from each other border on a place where
 * they are close, the former need the latter as neighbours: without them their discs would reach as
 * far as the next ones that are there, across the picture.
 */
#define SIDE 64 /* cells along the longest side of the bounds, at most */

typedef struct reach {
	const gw_surfels *surfels;
	double per_metre;
	int side[3];
	float *widest; /* owned; one a cell */
} reach;

static void reach_cell(const reach *r, size_t surfel, int cell[3])
{
	for (size_t k = 0; k < 3; k++) {
		double offset =
			(double)r->surfels->position[3 * surfel + k] - (double)r->surfels->minimum[k];
		/* Strays lie outside the bounds, as far as one likes. */
		cell[k] = (int)fmin(fmax(offset * r->per_metre, 0.0), r->side[k] - 1.0);
	}
}

static float *reach_at(const reach *r, const int cell[3])
{
	return &r->widest[((size_t)cell[2] * (size_t)r->side[1] + (size_t)cell[1]) *
						  (size_t)r->side[0] +
					  (size_t)cell[0]];
}

/* Cells are as wide as the widest disc or wider, so that its neighbours lie in those around it. */
static gw_status make_reach(const gw_surfels *s, reach *r, gw_error *error)
{
	double extent = 0.0, width = 1e-30;
	size_t cells = 1;
	for (size_t i = 0; i < s->count; i++)
		width = fmax(width, (double)s->radius[i]);
	for (int k = 0; k < 3; k++)
		extent = fmax(extent, (double)s->maximum[k] - (double)s->minimum[k]);
	width = fmax(width, extent / SIDE);
	*r = (reach){ .surfels = s, .per_metre = 1.0 / width };
	for (int k = 0; k < 3; k++) {
		r->side[k] = (int)(((double)s->maximum[k] - (double)s->minimum[k]) / width) + 1;
		cells *= (size_t)r->side[k];
	}
	r->widest = calloc(cells, sizeof *r->widest);
	if (!r->widest)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to choose what is in the picture");
	for (size_t i = 0; i < s->count; i++) {
		int cell[3];
		reach_cell(r, i, cell);
		float *widest = reach_at(r, cell);
		*widest = fmaxf(*widest, s->radius[i]);
	}
	return GW_OK;
}

static float reach_around(const reach *r, size_t surfel)
{
	int cell[3], at[3];
	float widest = 0.0f;
	reach_cell(r, surfel, cell);
	for (int i = 0; i < 27; i++) {
		bool inside = true;
		for (int k = 0, rest = i; k < 3; k++, rest /= 3) {
			at[k] = cell[k] + rest % 3 - 1;
			inside = inside && at[k] >= 0 && at[k] < r->side[k];
		}
		widest = inside ? fmaxf(widest, *reach_at(r, at)) : widest;
	}
	return widest;
}

/* What is in one picture. */
typedef struct choice {
	const gw_surfels *surfels;
	reach reach;
	gw_camera camera;
	double aspect;
	uint8_t *chosen;
} choice;

static void choose_range(void *user, size_t first, size_t last, uint32_t worker)
{
	(void)worker;
	const choice *c = user;
	const gw_surfels *s = c->surfels;
	for (size_t i = first; i < last; i++) {
		double centre[3];
		for (size_t k = 0; k < 3; k++)
			centre[k] = s->origin[k] + (double)s->position[3 * i + k];
		double radius = (double)(SURROUNDINGS * reach_around(&c->reach, i));
		c->chosen[i] |= gw_camera_sees(&c->camera, c->aspect, centre, radius);
	}
}

gw_status camera_plan_choose(const camera_plan *plan, const gw_surfels *surfels, double aspect,
							 uint8_t *chosen, gw_error *error)
{
	choice c = { .surfels = surfels, .aspect = aspect, .chosen = chosen };
	size_t pictures = camera_plan_count(plan);
	if (pictures > LOOKED_THROUGH) {
		memset(chosen, 1, surfels->count);
		return GW_OK;
	}
	gw_status status = make_reach(surfels, &c.reach, error);
	for (size_t i = 0; i < pictures && status == GW_OK; i++) {
		status = camera_plan_camera(plan, 0.0, i, &c.camera, error);
		if (status == GW_OK)
			gw_parallel_for(0, surfels->count, 65536, choose_range, &c);
	}
	free(c.reach.widest);
	return status;
}

gw_status camera_plan_camera(const camera_plan *plan, double spacing, size_t picture,
							 gw_camera *camera, gw_error *error)
{
	const double turn = 2.0 * acos(-1.0);
	const gw_viewpoint *view = plan->view + picture / plan->orbit;
	double up[3];
	gw_camera_up(plan->up, up);
	GW_TRY(gw_camera_look(camera, view->at, view->to, up, view->angle, error));
	double radians = turn * (double)(picture % plan->orbit) / (double)plan->orbit;
	gw_camera_orbit(camera, view->inside ? view->at : view->to, up, radians);
	camera->near = fmax(NEAR * spacing, view->near);
	return GW_OK;
}

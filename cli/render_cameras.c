#include "render_cameras.h"
#include "options.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Nearest distance that is seen, in spacings of the points: nothing closer has any detail. */
#define NEAR 0.05

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

gw_status camera_plan_place(camera_plan *plan, const render_scene *scene, double aspect,
							gw_error *error)
{
	gw_status status = GW_OK;
	plan->view = calloc(plan->text_count, sizeof *plan->view);
	if (!plan->view)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu cameras", plan->text_count);
	for (size_t i = 0; i < plan->text_count && status == GW_OK; i++) {
		const camera_text *text = plan->text + i;
		gw_viewpoint *view = plan->view + i;
		if (text->placed) {
			view->angle = text->angle > 0.0 ? text->angle : CAMERA_TEXT_ANGLE;
			memcpy(view->at, text->at, sizeof view->at);
			memcpy(view->to, text->to, sizeof view->to);
		} else {
			status = gw_viewpoint_find(&scene->surfels, scene->luminance, scene->up, text->kind,
									   text->angle, aspect, view, error);
		}
	}
	return status;
}

gw_status camera_plan_camera(const camera_plan *plan, const render_scene *scene, size_t picture,
							 gw_camera *camera, gw_error *error)
{
	const double turn = 2.0 * acos(-1.0);
	const gw_viewpoint *view = plan->view + picture / plan->orbit;
	const double up[3] = { 0.0, scene->up == 'y', scene->up != 'y' };
	gw_status status = gw_camera_look(camera, view->at, view->to, up, view->angle, error);
	if (status != GW_OK)
		return status;
	double radians = turn * (double)(picture % plan->orbit) / (double)plan->orbit;
	gw_camera_orbit(camera, view->inside ? view->at : view->to, up, radians);
	camera->near = NEAR * (double)scene->surfels.spacing;
	return GW_OK;
}

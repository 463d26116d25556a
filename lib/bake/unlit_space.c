/*
 * unlit_space.c - see unlit_space.h.
 */
#include "bake/unlit_space.h"

#include "glowworm_picture.h"

#include <string.h>

static bool shines_from_outside(const gw_scene_description *from)
{
	bool outside = from->light_count > 0;
	for (size_t i = 0; i < from->light_count; i++)
		outside = outside && (from->lights[i].type == GW_LIGHT_SUN ||
							  from->lights[i].type == GW_LIGHT_ENVIRONMENT);
	return outside;
}

/* The viewpoint for surfels whose normals count as given, or as nobody's. */
static gw_status find_viewpoint(const gw_scene *scene, const gw_points *points, bool given,
								gw_viewpoint *view, gw_error *error)
{
	const gw_viewpoint_wish wish = { .up = points->up ? points->up : 'z',
									 .aspect = 1.0,
									 .scanner = points->scanner,
									 .scanner_count = points->scanner_count };
	gw_surfels surfels = scene->surfels;
	surfels.normals_given = given ? surfels.count : 0;
	return gw_viewpoint_find(&surfels, &wish, view, error);
}

gw_status gw_unlit_space_find(gw_scene *scene, const gw_scene_description *from, gw_error *error)
{
	const gw_surfels *s = &scene->surfels;
	gw_report *r = scene->report;
	gw_viewpoint unsided, sided;
	if (2 * s->normals_given > s->count || from->points->emission || !shines_from_outside(from))
		return GW_OK;
	GW_TRY(find_viewpoint(scene, from->points, false, &unsided, error));
	if (!unsided.inside)
		return GW_OK;
	GW_TRY(find_viewpoint(scene, from->points, true, &sided, error));
	r->unlit_space = !sided.inside;
	memcpy(r->unlit_place, unsided.at, sizeof r->unlit_place);
	return GW_OK;
}

/* parted_result.c - see parted_result.h. */
#include "result/parted_result.h"

#include "points/format.h"
#include "program/signals.h"
#include "result/lit_scan.h"
#include "scene/glossy_points.h"

/* Parts by which is told how far points are from those that were baked. */
#define PARTS_MEASURED 8u

/* A part and its light. */
typedef struct lit_part {
	loaded_scene scene;
	gw_bake_result *light;
} lit_part;

static void clear(lit_part *p)
{
	gw_bake_result_destroy(&p->light);
	loaded_scene_clear_part(&p->scene);
}

/* To be cleared also on failure. */
static gw_status light_part(const parted_result *r, uint64_t first, lit_part *p, gw_error *error)
{
	*p = (lit_part){ .light = NULL };
	GW_TRY(loaded_scene_read_part(r->settings, r->scene, first, &p->scene, error));
	glossy_points_apply(r->settings, &p->scene);
	GW_TRY(gw_lit_surface_light(r->surface, &p->scene.points.points, &p->light, error));
	return signals_check(error);
}

gw_status parted_result_open(parted_result *r, gw_error *error)
{
	uint64_t count = r->scene->parted->file.count, step = count / PARTS_MEASURED;
	GW_TRY(gw_lit_surface_open(&r->scene->points.points, r->light, &r->settings->bake, &r->surface,
							   error));
	for (uint64_t first = 0, points = 0; first<count; first += points> step ? points : step) {
		lit_part p;
		gw_status status = light_part(r, first, &p, error);
		points = p.scene.cloud.count;
		clear(&p);
		GW_TRY(status);
	}
	gw_lit_surface_report(r->surface, count, &r->light->report);
	return GW_OK;
}

void parted_result_close(parted_result *r)
{
	gw_lit_surface_close(&r->surface);
}

/* Takes the part's columns. */
static gw_status write_part(const parted_result *r, const settings *s, lit_part *p, bool first,
							output_file *out, gw_error *error)
{
	double exposure;
	scan lit;
	const format_rows all = { .count = r->scene->parted->file.count };
	GW_TRY(lit_scan_make(&p->scene, p->light, s, &lit, &exposure, error));
	gw_status status = first ? r->format->write_head(out, &all, &lit, error) : GW_OK;
	if (status == GW_OK)
		status = r->format->write_rows(out, &lit, error);
	scan_clear(&lit);
	return status;
}

gw_status parted_result_write(const parted_result *r, output_file *out, double *exposure,
							  gw_error *error)
{
	settings s = *r->settings; /* nothing of it is freed */
	uint64_t count = r->scene->parted->file.count;
	GW_TRY(lit_scan_meter(r->scene, r->light, r->settings, exposure, error));
	s.exposure = (float)*exposure;
	for (uint64_t first = 0, points = 0; first < count; first += points) {
		lit_part p;
		gw_status status = light_part(r, first, &p, error);
		points = p.scene.cloud.count;
		if (status == GW_OK)
			status = write_part(r, &s, &p, first == 0, out, error);
		clear(&p);
		GW_TRY(status);
		progress_show(r->progress, "write", (double)(first + points) / (double)count);
	}
	return GW_OK;
}

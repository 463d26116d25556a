/*
 * page_scene.h - what a page shows: points, what each lamp gives them, set-ups of the lamps, and
 * cameras.
 */
#ifndef PAGE_SCENE_H
#define PAGE_SCENE_H

#include "page/page_order.h"
#include "page/page_points.h"
#include "pictures/render_cameras.h"
#include "pictures/render_scene.h"

/* Width by height of the pictures for which cameras are chosen: that of most screens. */
#define PAGE_ASPECT (16.0 / 9.0)

/* A lamp, or all light of a cloud that does not say which lamp it comes from. */
typedef struct page_lamp {
	char *name;      /* owned */
	size_t group;    /* bytes of the name that are its group's; 0: it has none */
	double scale;    /* radiance of 1 in its packed light */
	uint32_t *light; /* owned; a surfel, as RGB9E5 */
} page_lamp;

/* A camera, by its place among those of the plan. */
typedef struct page_scene {
	render_scene scene;
	camera_plan plan;
	char **camera_name; /* owned, and each; plan.text_count */
	page_order order;
	page_lamp *lamp; /* owned; lamp_count */
	size_t lamp_count;
	float *gain; /* owned; 3 * lamp_count for each of setup_count */
	const char **setup;
	size_t setup_count;
	char *bake_error; /* owned; what the bake said of its error, or NULL */
	uint64_t points;  /* of the input */
	uint64_t outside; /* surfels that are far off all the rest, which are left out */
	bool whole;       /* no lamp has its own columns: one has all light */
} page_scene;

/*
 * Reads the lit cloud settings->input[0].
 *   page   on success freed with page_scene_clear; zeroed on failure
 * Fails as render_scene_read; GW_ERROR_DATA when there is no light in the cloud; GW_ERROR_USAGE
 * when a set-up names a lamp that it does not have, there are more than PAGE_LAMPS_MAX, or a camera
 * is none.
 */
gw_status page_scene_read(const settings *settings, page_scene *page, gw_error *error);
void page_scene_clear(page_scene *page);

#endif

#include "page/page_scene.h"
#include "options/preview.h"
#include "result/lit_lamps.h"
#include "points/scan_color.h"
#include "scene/thinned_scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The power of two below which all light of a lamp is packed. RGB9E5 holds 65408. */
#define LARGEST_EXPONENT 15

/* ---------------------------------------------------------------------------------- cameras */

/* 'NAME: CAMERA', or a camera alone, which goes by its number. */
static gw_status read_camera(const char *text, size_t number, camera_text *camera, char **name,
							 gw_error *error)
{
	const char *colon = strchr(text, ':');
	char numbered[32];
	if (colon == text)
		return gw_fail(error, GW_ERROR_USAGE,
					   "--camera '%.80s' has no name before the colon; write 'NAME: CAMERA'", text);
	snprintf(numbered, sizeof numbered, "view %zu", number);
	*name = colon ? strndup(text, (size_t)(colon - text)) : strdup(numbered);
	if (!*name)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a camera");
	return camera_text_read("--camera", colon ? colon + 1 : text, camera, error);
}

/* The automatic one, then those that are asked for. */
static gw_status read_cameras(const settings *s, page_scene *page, gw_error *error)
{
	size_t count = 1 + s->view_count;
	camera_plan *plan = &page->plan;
	plan->orbit = 1;
	plan->text = calloc(count, sizeof *plan->text);
	page->camera_name = calloc(count, sizeof *page->camera_name);
	if (!plan->text || !page->camera_name)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu cameras", count);
	plan->text_count = count;
	GW_TRY(read_camera("overview: auto", 0, plan->text, page->camera_name, error));
	for (size_t i = 1; i < count; i++)
		GW_TRY(read_camera(s->view[i - 1], i, plan->text + i, page->camera_name + i, error));
	return GW_OK;
}

/* ----------------------------------------------------------------------------------- points */

/* Surfels within the bounds, the first `most` of an order of these alone. The back of one has its
 * place and its light. */
static gw_status order_inside(const gw_surfels *s, size_t most, page_order *order,
							  uint64_t *outside, gw_error *error)
{
	size_t count = 0, backs = 0;
	uint32_t *inside = reallocarray(NULL, s->count, sizeof *inside);
	float *position = reallocarray(NULL, s->count, 3 * sizeof *position);
	for (size_t i = 0; i < s->count && inside && position; i++) {
		bool within = !s->two_sided || s->two_sided[i] != GW_SIDE_BACK;
		backs += !within;
		for (size_t k = 0; k < 3; k++)
			within = within && s->position[3 * i + k] >= s->minimum[k] &&
					 s->position[3 * i + k] <= s->maximum[k];
		if (within) {
			memcpy(position + 3 * count, s->position + 3 * i, 3 * sizeof *position);
			inside[count++] = (uint32_t)i;
		}
	}
	*order = (page_order){ .count = 0 };
	*outside = s->count - count - backs;
	gw_status status =
		inside && position
			? page_order_make(position, count, order, error)
			: gw_fail(error, GW_ERROR_MEMORY, "no memory for the order of %zu points", s->count);
	for (size_t i = 0; i < count && status == GW_OK; i++)
		order->point[i] = inside[order->point[i]];
	page_order_cut(order, most);
	free(position);
	free(inside);
	return status;
}

typedef struct chooser {
	page_scene *page;
	size_t most;
} chooser;

/* The points that are shown: those that come first. */
static gw_status choose(void *user, const render_scene *scene, const gw_surfels *surfels,
						uint8_t *chosen, gw_error *error)
{
	chooser *c = user;
	page_order order;
	GW_TRY(camera_plan_place(&c->page->plan, scene, surfels, PAGE_ASPECT, error));
	GW_TRY(order_inside(surfels, c->most, &order, &c->page->outside, error));
	for (size_t i = 0; i < order.count; i++)
		chosen[order.point[i]] = 1;
	page_order_clear(&order);
	return GW_OK;
}

/* ------------------------------------------------------------------------------------ lamps */

/* Packs light, 3 a surfel, in a scale in which most of RGB9E5's exponents are used. */
static gw_status pack_light(const float *light, size_t count, page_lamp *to, gw_error *error)
{
	float most = 0.0f;
	for (size_t i = 0; i < 3 * count; i++)
		most = fmaxf(most, light[i]);
	int exponent = most > 0.0f ? ilogbf(most) + 1 - LARGEST_EXPONENT : 0;
	to->scale = ldexp(1.0, exponent);
	to->light = reallocarray(NULL, count ? count : 1, sizeof *to->light);
	if (!to->light)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the light of %zu points", count);
	for (size_t i = 0; i < count; i++) {
		double rgb[3];
		for (size_t k = 0; k < 3; k++)
			rgb[k] = ldexp((double)light[3 * i + k], -exponent);
		to->light[i] = page_points_rgb9e5(rgb);
	}
	return GW_OK;
}

static gw_status add_lamp(page_scene *page, const scan *cloud, const lit_lamp *of, float *light,
						  gw_error *error)
{
	page_lamp *to = &page->lamp[page->lamp_count];
	const scan_column *column[3];
	for (size_t k = 0; k < 3; k++)
		column[k] = &cloud->column[of->column[k]];
	GW_TRY(render_scene_means(&page->scene.surfels, column, light, error));
	*to = (page_lamp){ .name = strdup(of->name), .group = lit_lamp_group(of) };
	page->lamp_count++;
	if (!to->name)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the list of lamps");
	return pack_light(light, page->scene.surfels.count, to, error);
}

/* The lamps' own columns, or those of all light as of one lamp. */
static gw_status add_lamps(page_scene *page, const scan *cloud, const lit_lamps *lamps,
						   gw_error *error)
{
	static char name[] = "light";
	lit_lamp all = { .name = name };
	size_t count = page->whole ? 1 : lamps->count;
	for (size_t k = 0; k < 3 && page->whole; k++) {
		char radiance[] = "radiance_r";
		radiance[sizeof radiance - 2] = "rgb"[k];
		all.column[k] = (size_t)(scan_find_scalar(cloud, radiance) - cloud->column);
	}
	float *light = reallocarray(NULL, page->scene.surfels.count, 3 * sizeof *light);
	page->lamp = calloc(count, sizeof *page->lamp);
	gw_status status = light && page->lamp
						   ? GW_OK
						   : gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu lamps", count);
	for (size_t l = 0; l < count && status == GW_OK; l++)
		status = add_lamp(page, cloud, page->whole ? &all : &lamps->lamp[l], light, error);
	free(light);
	return status;
}

/* ---------------------------------------------------------------------------------- set-ups */

/* Whether a set-up's gain is for a lamp: by its name, its own name, its group's, or all. */
static bool is_meant(const lit_lamps *lamps, size_t number, const settings_gain *gain)
{
	settings_gain group = *gain;
	group.group = true;
	return strcmp(gain->name, "*") == 0 || lit_lamps_is_meant(lamps, number, gain) ||
		   lit_lamps_is_meant(lamps, number, &group);
}

/* Sets a gain in a set-up's row, three a lamp. */
static gw_status set_gain(float *to, const lit_lamps *lamps, const settings_gain *gain,
						  gw_error *error)
{
	bool found = false;
	for (size_t l = 0; l < lamps->count; l++)
		if (is_meant(lamps, l, gain)) {
			found = true;
			memcpy(to + 3 * l, gain->factor, sizeof gain->factor);
		}
	return found ? GW_OK : lit_lamps_fail_unknown(lamps, gain, error);
}

static gw_status make_setups(const settings *s, page_scene *page, const lit_lamps *lamps,
							 gw_error *error)
{
	if (s->gain_count > 0 && lamps->count == 0)
		return gw_fail(error, GW_ERROR_DATA,
					   "--setup '%.80s: ...' wants lamps, but the points do not say which lamp "
					   "their light comes from; bake them with --fields lights",
					   s->gain[0].setup);
	size_t width = 3 * (page->whole ? 1 : lamps->count);
	page->gain = calloc(s->gain_count + 1, width * sizeof *page->gain);
	page->setup = calloc(s->gain_count + 1, sizeof *page->setup);
	if (!page->gain || !page->setup)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the set-ups");
	float *all = page->gain;
	for (size_t i = 0; i < s->gain_count; i++) {
		if (i == 0 || s->gain[i].setup != s->gain[i - 1].setup) {
			all = page->gain + width * page->setup_count;
			page->setup[page->setup_count++] = s->gain[i].setup;
			for (size_t k = 0; k < width; k++)
				all[k] = 1.0f;
		}
		GW_TRY(set_gain(all, lamps, &s->gain[i], error));
	}
	return GW_OK;
}

/* ------------------------------------------------------------------------------------ whole */

static gw_status keep_error(const scan *cloud, page_scene *page, gw_error *error)
{
	static const char start[] = "glowworm estimated error: RMS ";
	for (size_t c = 0; c < cloud->comment_count; c++)
		if (strncmp(cloud->comment[c], start, sizeof start - 1) == 0) {
			free(page->bake_error);
			page->bake_error = strdup(cloud->comment[c] + sizeof start - 1);
			if (!page->bake_error)
				return gw_fail(error, GW_ERROR_MEMORY, "no memory for a comment");
		}
	return GW_OK;
}

static gw_status check_light(const scan *cloud, const char *name, gw_error *error)
{
	if (scan_find_scalar(cloud, "radiance_r") && scan_find_scalar(cloud, "radiance_g") &&
		scan_find_scalar(cloud, "radiance_b"))
		return GW_OK;
	return gw_fail(error, GW_ERROR_DATA,
				   "%s: there is no baked light in it; light it with glowworm bake --fields lights",
				   name);
}

/* What may be wrong with what was asked for is said before there is much to do. */
static gw_status find_lamps(const settings *s, const scan *cloud, page_scene *page,
							lit_lamps *lamps, gw_error *error)
{
	GW_TRY(lit_lamps_find(cloud, lamps, error));
	page->whole = lamps->count == 0;
	if (lamps->count > PAGE_LAMPS_MAX)
		return gw_fail(error, GW_ERROR_USAGE,
					   "a page has sliders for %u lamps, but the cloud has %zu: bake with --fields "
					   "groups, so that lamps of a group share one",
					   PAGE_LAMPS_MAX, lamps->count);
	return make_setups(s, page, lamps, error);
}

static gw_status make_surface(const settings *s, loaded_scene *loaded, page_scene *page,
							  gw_error *error)
{
	chooser c = { page, s->page_points };
	const render_scene_wish wish = { 1u << RENDER_RADIANCE | 1u << RENDER_EMISSION,
									 RENDER_OCTREE_NO, choose, &c };
	uint64_t outside;
	GW_TRY(render_scene_make(s, loaded, &wish, &page->scene, error));
	return order_inside(&page->scene.surfels, s->page_points, &page->order, &outside, error);
}

static gw_status make(const settings *s, loaded_scene *loaded, page_scene *page, gw_error *error)
{
	lit_lamps lamps = { .count = 0 };
	const scan *cloud = &loaded->cloud;
	GW_TRY(check_light(cloud, loaded_scene_input_name(s->input[0].path), error));
	page->points = cloud->count;
	GW_TRY(keep_error(cloud, page, error));
	gw_status status = find_lamps(s, cloud, page, &lamps, error);
	if (status == GW_OK)
		status = make_surface(s, loaded, page, error);
	if (status == GW_OK)
		status = add_lamps(page, cloud, &lamps, error);
	lit_lamps_clear(&lamps);
	return status;
}

gw_status page_scene_read(const settings *s, page_scene *page, gw_error *error)
{
	const parted_cloud_look look = { .bytes = THINNED_SCENE_SEEN_BYTES };
	thinned_scene thinned = { .loaded = { .place = coordinates_metres() } };
	*page = (page_scene){ .scene = { .place = coordinates_metres() } };
	gw_status status = read_cameras(s, page, error);
	if (status == GW_OK)
		status = thinned_scene_read(s, &look, "looked at", &thinned, error);
	if (status == GW_OK && !s->quiet)
		render_scene_print_notes(&thinned.loaded.cloud);
	if (status == GW_OK)
		status = make(s, &thinned.loaded, page, error);
	thinned_scene_clear(&thinned);
	if (status != GW_OK)
		page_scene_clear(page);
	return status;
}

void page_scene_clear(page_scene *page)
{
	for (size_t i = 0; page->camera_name && i < page->plan.text_count; i++)
		free(page->camera_name[i]);
	free(page->camera_name);
	for (size_t l = 0; l < page->lamp_count; l++) {
		free(page->lamp[l].name);
		free(page->lamp[l].light);
	}
	free(page->lamp);
	free(page->gain);
	free(page->setup);
	free(page->bake_error);
	page_order_clear(&page->order);
	camera_plan_clear(&page->plan);
	render_scene_clear(&page->scene);
	*page = (page_scene){ .scene = { .place = coordinates_metres() } };
}

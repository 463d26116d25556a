/*
 * raster_holes.c - closes holes that the cuts of discs leave; see raster_steps.h.
 *
 * Discs are cut where a surface seems to end, and now and then that is wrong and leaves a hole.
 * What lies beyond the cut is shown where there is solid surface on both sides, left and right or
 * above and below, and nothing empty between. Beyond the picture's edge there is none. All of the
 * picture takes part: tiles would show at the rims of large holes.
 */
#include "picture/raster_steps.h"

#include "base/memory.h"

#include <stdlib.h>

/* Solid surface is met first, among all that is not empty, on that side of the pixel. */
enum { ON_LEFT = 1, ON_RIGHT = 2, ABOVE = 4, BELOW = 8 };

/* Whether what follows on a pixel sees solid surface, when the pixel sees it or not. */
static bool passes_on(const gw_raster_cover *c, unsigned all, bool solid)
{
	return c->sure == all || (solid && c->sure + c->beyond == (int)all);
}

static void look_along_row(const gw_raster_cover *cover, size_t width, unsigned all, uint8_t *seen)
{
	bool left = false, right = false;
	for (size_t i = 0, j = width - 1; i < width; i++, j--) {
		seen[i] |= left ? ON_LEFT : 0;
		seen[j] |= right ? ON_RIGHT : 0;
		left = passes_on(cover + i, all, left);
		right = passes_on(cover + j, all, right);
	}
}

/* One row further; `solid` holds what the last one passed on. */
static void look_across_row(const gw_raster_cover *cover, size_t width, unsigned all, uint8_t bit,
							uint8_t *solid, uint8_t *seen)
{
	for (size_t i = 0; i < width; i++) {
		seen[i] |= solid[i] ? bit : 0;
		solid[i] = passes_on(cover + i, all, solid[i]);
	}
}

static void look_around(const gw_gbuffer *g, const gw_raster_cover *cover, unsigned all,
						uint8_t *above, uint8_t *below, uint8_t *seen)
{
	size_t width = g->width, height = g->height;
	for (size_t i = 0, j = height - 1; i < height; i++, j--) {
		look_along_row(cover + i * width, width, all, seen + i * width);
		look_across_row(cover + i * width, width, all, ABOVE, above, seen + i * width);
		look_across_row(cover + j * width, width, all, BELOW, below, seen + j * width);
	}
}

static void empty_pixel(gw_gbuffer *g, size_t pixel)
{
	g->depth[pixel] = INFINITY;
	g->facing[pixel] = 0.0f;
	g->id[pixel] = GW_RASTER_NOTHING;
	for (size_t k = 0; k < 3; k++)
		g->normal[3 * pixel + k] = 0.0f;
	for (size_t c = 0; c < g->channel_count; c++)
		g->channel[g->channel_count * pixel + c] = 0.0f;
}

gw_status gw_raster_holes_close(const gw_raster_view *view, const gw_raster_cover *cover,
								gw_gbuffer *g, gw_error *error)
{
	unsigned all = view->options->samples * view->options->samples;
	size_t pixels = (size_t)g->width * g->height;
	uint8_t *seen = gw_allocate_zeros(pixels, 1);
	uint8_t *solid = gw_allocate_zeros(g->width, 2);
	bool good = seen && solid;
	if (good)
		look_around(g, cover, all, solid, solid + g->width, seen);
	for (size_t i = 0; i < pixels && good; i++) {
		bool across = (seen[i] & ON_LEFT) && (seen[i] & ON_RIGHT);
		bool along = (seen[i] & ABOVE) && (seen[i] & BELOW);
		unsigned covered = cover[i].sure + (across || along ? (unsigned)cover[i].beyond : 0u);
		g->coverage[i] = (float)covered / (float)all;
		if (covered == 0)
			empty_pixel(g, i);
	}
	free(seen);
	free(solid);
	return good ? GW_OK : gw_fail(error, GW_ERROR_MEMORY, "no memory to close holes");
}

/*
 * raster_holes.c - closes holes that the cuts of discs leave; see raster_steps.h.
 *
 * Discs are cut where a surface seems to end, and now and then that is wrong and leaves a hole.
 * What lies beyond the cut is shown where there is solid surface on both sides along five of eight
 * lines through it or more, and nothing empty between: lines along rows and columns alone would
 * leave holes and rims that are boxes. Beyond the picture's edge there is none. All of the picture
 * takes part: tiles would show at the rims of large holes.
 */
#include "picture/raster_steps.h"

#include "base/memory.h"

#include <stdlib.h>

#define LINES 8
#define LEAST_LINES 5 /* with surface on both sides */

/* From a pixel to the one before it on each line, in the order of rows; and to the one behind it
 * the other way round. */
static const int step_of[LINES][2] = { { -1, 0 },  { 0, -1 }, { -1, -1 }, { 1, -1 },
									   { -2, -1 }, { 2, -1 }, { -1, -2 }, { 1, -2 } };

/* What a pixel passes on: 1 << line where solid surface is met first, among all that is not empty.
 */
static uint8_t passes_on(const gw_raster_cover *c, unsigned all, uint8_t solid)
{
	return c->sure == all ? UINT8_MAX : c->sure + c->beyond == (int)all ? solid : 0;
}

/* One way along all lines, way 1 from the first row down, -1 from the last one up. Sets the bits of
 * a pixel in `seen`, and uses `passed`, both a byte a pixel. */
static void look_along(const gw_gbuffer *g, const gw_raster_cover *cover, unsigned all, int way,
					   uint8_t *seen, uint8_t *passed)
{
	int64_t width = g->width, height = g->height, pixels = width * height;
	for (int64_t n = 0; n < pixels; n++) {
		int64_t i = way > 0 ? n : pixels - 1 - n, x = i % width, y = i / width;
		uint8_t bits = 0;
		for (int line = 0; line < LINES && cover[i].sure < all; line++) {
			int64_t from_x = x + way * step_of[line][0], from_y = y + way * step_of[line][1];
			if (from_x >= 0 && from_x < width && from_y >= 0 && from_y < height)
				bits |= (uint8_t)(passed[from_y * width + from_x] & 1u << line);
		}
		seen[i] = bits;
		passed[i] = passes_on(cover + i, all, bits);
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
	uint8_t *above = gw_allocate_zeros(pixels, 1), *below = gw_allocate_zeros(pixels, 1);
	uint8_t *passed = gw_allocate_zeros(pixels, 1);
	bool good = above && below && passed;
	if (good) {
		look_along(g, cover, all, 1, above, passed);
		look_along(g, cover, all, -1, below, passed);
	}
	for (size_t i = 0; i < pixels && good; i++) {
		bool between = __builtin_popcount(above[i] & below[i]) >= LEAST_LINES;
		unsigned covered = cover[i].sure + (between ? (unsigned)cover[i].beyond : 0u);
		g->coverage[i] *= (float)covered / (float)all;
		if (covered == 0)
			empty_pixel(g, i);
	}
	free(above);
	free(below);
	free(passed);
	return good ? GW_OK : gw_fail(error, GW_ERROR_MEMORY, "no memory to close holes");
}

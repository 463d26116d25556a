/*
 * picture_holes.c - see picture_holes.h. Pixels are filled from the picture's edges inwards.
 */
#include "pictures/picture_holes.h"

#include <stdbool.h>
#include <stdlib.h>

/* Pixels that are reached from outside, of which some were not gone on from yet. */
typedef struct filling {
	const gw_gbuffer *g;
	bool *reached;   /* a pixel */
	size_t *pending; /* of them; count */
	size_t count;
} filling;

static void reach(filling *f, size_t x, size_t y)
{
	size_t i = y * f->g->width + x;
	if (f->reached[i] || f->g->coverage[i] > 0.0f)
		return;
	f->reached[i] = true;
	f->pending[f->count++] = i;
}

static void enter(filling *f)
{
	size_t width = f->g->width, height = f->g->height;
	for (size_t x = 0; x < width; x++) {
		reach(f, x, 0);
		reach(f, x, height - 1);
	}
	for (size_t y = 0; y < height; y++) {
		reach(f, 0, y);
		reach(f, width - 1, y);
	}
}

static void spread(filling *f)
{
	size_t width = f->g->width, height = f->g->height;
	while (f->count > 0) {
		size_t i = f->pending[--f->count], x = i % width, y = i / width;
		if (x > 0)
			reach(f, x - 1, y);
		if (x + 1 < width)
			reach(f, x + 1, y);
		if (y > 0)
			reach(f, x, y - 1);
		if (y + 1 < height)
			reach(f, x, y + 1);
	}
}

static double measure(const filling *f, size_t pixels)
{
	size_t holes = 0, covered = 0;
	for (size_t i = 0; i < pixels; i++) {
		bool shown = f->g->coverage[i] > 0.0f;
		covered += shown;
		holes += !shown && !f->reached[i];
	}
	return holes > 0 ? (double)holes / (double)(holes + covered) : 0.0;
}

gw_status picture_holes_find(const gw_gbuffer *g, double *share, gw_error *error)
{
	size_t pixels = (size_t)g->width * g->height;
	filling f = { g, calloc(pixels, sizeof *f.reached),
				  reallocarray(NULL, pixels, sizeof *f.pending), 0 };
	gw_status status =
		f.reached && f.pending
			? GW_OK
			: gw_fail(error, GW_ERROR_MEMORY, "no memory to look for holes in %zu pixels", pixels);
	if (status == GW_OK) {
		enter(&f);
		spread(&f);
		*share = measure(&f, pixels);
	}
	free(f.pending);
	free(f.reached);
	return status;
}

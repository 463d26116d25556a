/* raster.c - drawing a scene into a G-buffer, tile by tile; see glowworm_picture.h. */
#include "picture/raster_steps.h"

#include "base/memory.h"
#include "base/parallel.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#define TILE 64u        /* samples a side of a tile, at least; 4096 samples fit into a cache */
#define TILE_PIXELS 16u /* pixels a side of a tile, at least */

typedef struct drawing {
	const gw_raster_view *view;
	const gw_raster_bins *bins;
	gw_raster_scratch *scratch; /* one a thread */
	gw_raster_cover *cover;     /* width * height */
	gw_gbuffer *gbuffer;
	atomic_bool cancelled;
} drawing;

static gw_status check(const gw_raster_scene *scene, const gw_raster_options *o, gw_error *error)
{
	if (o->width < 1 || o->height < 1 || o->width > GW_RASTER_SIZE_MAX ||
		o->height > GW_RASTER_SIZE_MAX)
		return gw_fail(error, GW_ERROR_USAGE,
					   "a picture of %u x %u pixels cannot be drawn; 1 to %u a side can", o->width,
					   o->height, GW_RASTER_SIZE_MAX);
	if (o->samples < 1 || o->samples > GW_RASTER_SAMPLES_MAX)
		return gw_fail(error, GW_ERROR_USAGE,
					   "%u samples a side of a pixel cannot be drawn; 1 to %u can", o->samples,
					   GW_RASTER_SAMPLES_MAX);
	if (!(o->radius_scale > 0.0f) || scene->channel_count > GW_RASTER_CHANNELS_MAX)
		return gw_fail(error, GW_ERROR_USAGE, "radius scale or number of channels are bad");
	if (scene->discs.count >= GW_RASTER_NOTHING ||
		scene->triangles.count >= GW_RASTER_NOTHING - scene->discs.count)
		return gw_fail(error, GW_ERROR_USAGE, "no more than %u primitives can be drawn",
					   GW_RASTER_NOTHING - 1);
	return GW_OK;
}

static gw_raster_view make_view(const gw_raster_scene *scene, const gw_camera *camera,
								const gw_raster_options *o)
{
	gw_raster_view v = { .scene = scene,
						 .camera = camera,
						 .options = o,
						 .columns = o->width * o->samples,
						 .rows = o->height * o->samples,
						 .near = (float)camera->near,
						 .primitives = scene->discs.count + scene->triangles.count,
						 .tile = TILE_PIXELS * o->samples };
	while (v.tile < TILE)
		v.tile *= 2;
	for (int k = 0; k < 3; k++)
		v.eye[k] = camera->position[k] - scene->origin[k];
	v.step = (float)(2.0 * camera->tangent / (double)v.rows);
	v.middle_x = 0.5f * (float)v.columns;
	v.middle_y = 0.5f * (float)v.rows;
	v.tiles_x = (v.columns + v.tile - 1) / v.tile;
	v.tiles_y = (v.rows + v.tile - 1) / v.tile;
	return v;
}

/* Bytes a pixel: the G-buffer without its channels, what is known of its cover, and what becomes of
 * it: gaps and what lies around them, or three floats more, and bytes of a file. */
#define PIXEL_BYTES (28u + 3u + 25u + 4u)

/* The system promises more memory than it has, and ends the program that takes it at its word. */
static gw_status check_memory(const gw_raster_view *v, gw_error *error)
{
	uint64_t pixels = (uint64_t)v->options->width * v->options->height;
	uint64_t needed = pixels * (PIXEL_BYTES + 4u * v->scene->channel_count);
	uint64_t free_bytes = gw_available_memory();
	if (free_bytes == 0 || needed <= free_bytes)
		return GW_OK;
	return gw_fail(
		error, GW_ERROR_MEMORY,
		"a picture of %u x %u pixels takes %llu MB, and %llu MB of memory are free; make "
		"it smaller",
		v->options->width, v->options->height, (unsigned long long)(needed >> 20),
		(unsigned long long)(free_bytes >> 20));
}

static gw_status make_gbuffer(const gw_raster_view *v, gw_gbuffer *g, gw_error *error)
{
	size_t pixels = (size_t)v->options->width * v->options->height;
	*g =
		(gw_gbuffer){ .width = v->options->width,
					  .height = v->options->height,
					  .channel_count = v->scene->channel_count,
					  .coverage = gw_allocate_array(pixels, sizeof(float)),
					  .depth = gw_allocate_array(pixels, sizeof(float)),
					  .facing = gw_allocate_array(pixels, sizeof(float)),
					  .normal = gw_allocate_array(pixels, 3 * sizeof(float)),
					  .channel = gw_allocate_array(pixels, v->scene->channel_count * sizeof(float)),
					  .id = gw_allocate_array(pixels, sizeof(uint32_t)) };
	if (g->coverage && g->depth && g->facing && g->normal && g->channel && g->id)
		return GW_OK;
	gw_gbuffer_clear(g);
	return gw_fail(error, GW_ERROR_MEMORY, "no memory for a picture of %u x %u pixels",
				   v->options->width, v->options->height);
}

static void free_scratch(gw_raster_scratch *scratch, uint32_t threads)
{
	for (uint32_t t = 0; scratch && t < threads; t++) {
		for (int l = 0; l < 2; l++) {
			free(scratch[t].layer[l].depth);
			free(scratch[t].layer[l].id);
			free(scratch[t].layer[l].normal);
			free(scratch[t].layer[l].sum);
			free(scratch[t].layer[l].glow);
		}
		free(scratch[t].floor);
		free(scratch[t].far);
		free(scratch[t].entry);
		free(scratch[t].order);
		free(scratch[t].left);
		free(scratch[t].start);
		free(scratch[t].blend);
	}
	free(scratch);
}

static bool make_layer(gw_raster_layer *layer, size_t samples, size_t stride, bool glows)
{
	layer->depth = gw_allocate_array(samples, sizeof *layer->depth);
	layer->id = gw_allocate_array(samples, sizeof *layer->id);
	layer->normal = gw_allocate_array(samples, 3 * sizeof *layer->normal);
	layer->sum = gw_allocate_array(samples, stride * sizeof *layer->sum);
	if (glows)
		layer->glow = gw_allocate_array(samples, stride * sizeof *layer->glow);
	return layer->depth && layer->id && layer->normal && layer->sum && (layer->glow || !glows);
}

static gw_raster_scratch *make_scratch(const gw_raster_view *v, size_t longest, uint32_t threads)
{
	size_t samples = (size_t)v->tile * v->tile;
	size_t blocks = samples / (GW_RASTER_BLOCK * GW_RASTER_BLOCK);
	gw_raster_scratch *scratch = gw_allocate_zeros(threads, sizeof *scratch);
	bool good = scratch != NULL;
	for (uint32_t t = 0; t < threads && good; t++) {
		gw_raster_scratch *s = scratch + t;
		for (int l = 0; l < 2 && good; l++)
			good = make_layer(s->layer + l, samples, GW_RASTER_FIXED + v->scene->channel_count,
							  v->scene->discs.glows != NULL);
		s->floor = gw_allocate_array(samples, sizeof *s->floor);
		s->far = gw_allocate_array(blocks, sizeof *s->far);
		s->entry = gw_allocate_array(longest, sizeof *s->entry);
		s->order = gw_allocate_array(longest, sizeof *s->order);
		if (v->scene->discs.transparency) {
			s->left = gw_allocate_array(samples, sizeof *s->left);
			s->start = gw_allocate_array(samples, sizeof *s->start);
			s->blend = gw_allocate_array(samples, (1u + v->scene->channel_count) * sizeof(float));
			good = good && s->left && s->start && s->blend;
		}
		good = good && s->floor && s->far && s->entry && s->order;
	}
	if (good)
		return scratch;
	free_scratch(scratch, threads);
	return NULL;
}

static void draw_tiles(void *user, size_t first, size_t last, uint32_t worker)
{
	drawing *d = user;
	const gw_raster_options *o = d->view->options;
	for (size_t tile = first; tile < last && !atomic_load(&d->cancelled); tile++) {
		/* Only the caller's own thread may be asked. */
		if (worker == 0 && o->cancelled && o->cancelled(o->user))
			atomic_store(&d->cancelled, true);
		gw_raster_tile_draw(d->view, d->bins, tile, d->scratch + worker, d->cover, d->gbuffer);
	}
}

static gw_status draw(drawing *d, gw_raster_bins *bins, uint32_t threads, gw_gbuffer *gbuffer,
					  gw_error *error)
{
	const gw_raster_view *view = d->view;
	GW_TRY(check_memory(view, error));
	GW_TRY(gw_raster_bins_make(view, bins, error));
	GW_TRY(make_gbuffer(view, gbuffer, error));
	d->scratch = make_scratch(view, bins->longest, threads);
	d->cover = gw_allocate_array((size_t)gbuffer->width * gbuffer->height, sizeof *d->cover);
	if (!d->scratch || !d->cover)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to draw with %u threads", threads);
	gw_parallel_for(threads, (size_t)view->tiles_x * view->tiles_y, 1, draw_tiles, d);
	if (atomic_load(&d->cancelled))
		return gw_fail(error, GW_ERROR_CANCELLED, "stopped while drawing");
	gbuffer->drawn = bins->drawn;
	GW_TRY(gw_raster_holes_close(view, d->cover, gbuffer, error));
	bool surface = view->scene->discs.count > 0 && !view->scene->discs.transparency &&
				   view->options->radius_scale >= 1.0f;
	return surface ? gw_raster_gaps_bridge(view, gbuffer, error) : GW_OK;
}

gw_status gw_raster_draw(const gw_raster_scene *scene, const gw_camera *camera,
						 const gw_raster_options *options, gw_gbuffer *gbuffer, gw_error *error)
{
	*gbuffer = (gw_gbuffer){ .width = 0 };
	GW_TRY(check(scene, options, error));
	gw_raster_view view = make_view(scene, camera, options);
	gw_raster_bins bins = { .drawn = 0 };
	uint32_t threads = gw_thread_count(options->threads);
	drawing d = { .view = &view, .bins = &bins, .gbuffer = gbuffer };
	gw_status status = draw(&d, &bins, threads, gbuffer, error);
	free(d.cover);
	free_scratch(d.scratch, threads);
	gw_raster_bins_clear(&bins);
	if (status != GW_OK)
		gw_gbuffer_clear(gbuffer);
	return status;
}

void gw_gbuffer_clear(gw_gbuffer *gbuffer)
{
	free(gbuffer->coverage);
	free(gbuffer->depth);
	free(gbuffer->facing);
	free(gbuffer->normal);
	free(gbuffer->channel);
	free(gbuffer->id);
	memset(gbuffer, 0, sizeof *gbuffer);
}

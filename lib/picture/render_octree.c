/*
 * render_octree.c - see render_octree.h.
 */
#include "picture/render_octree.h"

#include "base/memory.h"
#include "light/direct_light.h"
#include "octree/compartments.h"
#include "picture/gloss_caches.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Pixels that are on the device at once: 48 MB. */
#define BATCH ((size_t)1 << 20)

/* What a batch needs on the device. */
typedef struct batch {
	gw_buffer position, normal, result; /* vec4 a pixel */
	float *host;                        /* 4 a pixel */
	size_t first, count;                /* pixels that are in it now */
} batch;

/* ------------------------------------------------------------------------------- making */

static float largest_of(const float *values, size_t count)
{
	float largest = 0.0f;
	for (size_t i = 0; i < count; i++)
		largest = fmaxf(largest, values[i]);
	return largest;
}

static gw_status upload_radiance(gw_render_octree *o, const gw_surfels *surfels,
								 const float *radiance, gw_error *error)
{
	float *wide = gw_allocate_zeros(surfels->count, 4 * sizeof *wide);
	if (!wide)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the radiance of %zu surfels",
					   surfels->count);
	for (size_t i = 0; i < 3 * surfels->count; i++)
		wide[i / 3 * 4 + i % 3] = radiance[i];
	uint64_t bytes = 16 * (uint64_t)surfels->count;
	gw_status status =
		gw_buffer_create(o->gpu,
						 &(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_R32G32B32A32_SFLOAT,
												   bytes, "surfel radiance" },
						 &o->surfel_radiance, error);
	if (status == GW_OK)
		status = gw_buffer_upload(o->gpu, &o->surfel_radiance, 0, wide, bytes, error);
	free(wide);
	return status;
}

static gw_status average_facets(gw_render_octree *o, gw_error *error)
{
	uint64_t slots = 2 * (uint64_t)o->octree.leaf_count;
	GW_TRY(
		gw_buffer_create(o->gpu,
						 &(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_R32G32B32A32_SFLOAT,
												   16 * slots, "facet radiance" },
						 &o->facet_radiance, error));
	const gw_binding bindings[] = { gw_whole(&o->octree.leaf_fragment),
									gw_whole(&o->octree.fragment_surfel),
									gw_whole(&o->octree.fragment_weight),
									gw_whole(&o->surfel_radiance),
									gw_window(&o->facet_radiance, 16) };
	return gw_passes_run(&o->passes, GW_PASS_FACET_DIRECT, bindings, &(gw_record_push){ 0 }, slots,
						 error);
}

static gw_status fill_bricks(gw_render_octree *o, float largest, gw_error *error)
{
	GW_TRY(gw_cone_gather_create(o->gpu, &o->octree, 1, 0, &o->bricks, error));
	o->has_bricks = true;
	return gw_cone_gather_fill(
		&o->passes, &o->octree, &o->bricks,
		(gw_facet_radiance){ .facets = &o->facet_radiance, .largest = largest }, &o->scale, error);
}

static gw_status make(gw_render_octree *o, const gw_surfels *surfels, const float *radiance,
					  const gw_render_octree_options *options, gw_error *error)
{
	const gw_gpu_options device = { .device = options->device,
									.memory = options->memory,
									.passes = options->passes,
									.validate_synchronization =
										options->validate == GW_VALIDATE_CALLS,
									.validate_gpu_assisted =
										options->validate == GW_VALIDATE_ACCESSES };
	GW_TRY(gw_gpu_create(&device, &o->gpu, error));
	if (options->depth == GW_DEPTH_AUTO)
		GW_TRY(gw_octree_build_spaced(o->gpu, surfels, options->leaf_spacing, &o->octree, error));
	else
		GW_TRY(gw_octree_build(o->gpu, surfels, options->depth, &o->octree, error));
	gw_octree_passes(&o->passes, o->gpu, &o->octree);
	GW_TRY(upload_radiance(o, surfels, radiance, error));
	GW_TRY(average_facets(o, error));
	return options->bricks ? fill_bricks(o, largest_of(radiance, 3 * surfels->count), error)
						   : GW_OK;
}

gw_status gw_render_octree_create(const gw_surfels *surfels, const float *radiance,
								  const gw_render_octree_options *options, gw_render_octree **made,
								  gw_error *error)
{
	*made = NULL;
	gw_render_octree *o = gw_allocate_zeros(1, sizeof *o);
	if (!o)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for an octree");
	gw_status status = make(o, surfels, radiance, options, error);
	if (status == GW_OK)
		*made = o;
	else
		gw_render_octree_destroy(&o);
	return status;
}

void gw_render_octree_destroy(gw_render_octree **octree)
{
	gw_render_octree *o = *octree;
	*octree = NULL;
	if (!o)
		return;
	if (o->gpu) {
		gw_cone_gather_destroy(o->gpu, &o->bricks);
		gw_sky_map_destroy(o->gpu, &o->sky);
		gw_buffer_destroy(o->gpu, &o->facet_radiance);
		gw_buffer_destroy(o->gpu, &o->surfel_radiance);
		if (o->passes.gpu)
			gw_passes_destroy(&o->passes);
		gw_octree_destroy(o->gpu, &o->octree);
		gw_gpu_destroy(&o->gpu);
	}
	free(o);
}

gw_status gw_render_octree_set_sky(gw_render_octree *o, const gw_light *light, gw_error *error)
{
	gw_sky_map_destroy(o->gpu, &o->sky);
	return light ? gw_sky_map_make(o->gpu, light, &o->sky, error) : GW_OK;
}

/* ------------------------------------------------------------------------- what it is like */

gw_octree_width gw_render_octree_width(const gw_render_octree *octree)
{
	const gw_octree *o = &octree->octree;
	return (gw_octree_width){ (double)o->leaf_size, (double)o->wanted_leaf_size, o->why_coarser };
}

gw_status gw_render_octree_records(gw_render_octree *o, const gw_bake_options *bake,
								   float **position, size_t *count, gw_error *error)
{
	const gw_record_wish wish = { .spacing = bake->record_spacing,
								  .least = bake->least_records,
								  .seed = bake->seed };
	gw_records records = { 0 };
	const gw_record_context on = { &o->passes, &o->octree, &records };
	float *cell = NULL;
	*position = NULL;
	*count = 0;
	gw_status status = gw_records_place(&on, &wish, error);
	if (status == GW_OK) {
		cell = gw_allocate_array(records.count, 4 * sizeof *cell);
		*position = gw_allocate_array(records.count, 3 * sizeof **position);
		status = cell && *position
					 ? gw_buffer_download(o->gpu, &records.position, 0, cell,
										  16 * (uint64_t)records.count, error)
					 : gw_fail(error, GW_ERROR_MEMORY, "no memory for %u records", records.count);
	}
	if (status == GW_OK) {
		*count = records.count;
		for (size_t i = 0; i < 3 * *count; i++)
			(*position)[i] =
				o->octree.cube_minimum[i % 3] + cell[i / 3 * 4 + i % 3] * o->octree.leaf_size;
	} else {
		free(*position);
		*position = NULL;
	}
	free(cell);
	gw_records_destroy(o->gpu, &records);
	return status;
}

gw_status gw_render_octree_shadow(gw_render_octree *o, const gw_surfels *surfels,
								  const gw_light *light, const gw_bake_options *options,
								  float *share, gw_error *error)
{
	const gw_lit_cloud cloud = {
		.passes = &o->passes, .octree = &o->octree, .surfels = surfels, .options = options
	};
	GW_TRY(gw_compartments_find(o->gpu, surfels, options->threads, &o->octree, error));
	return gw_light_share(&cloud, light, share, error);
}

/* ------------------------------------------------------------------------------- pixels */

void gw_render_octree_to_grid(const gw_render_octree *octree, const float metres[3], float grid[3])
{
	const gw_octree *o = &octree->octree;
	for (int k = 0; k < 3; k++)
		grid[k] = (metres[k] - o->cube_minimum[k]) / o->leaf_size;
}

/* Where the eye is, for a push. */
static vec4 eye_of(const gw_render_octree *o, const gw_pixels *pixels, float w)
{
	float eye[3];
	gw_render_octree_to_grid(o, pixels->eye, eye);
	return (vec4){ eye[0], eye[1], eye[2], w };
}

static gw_status open_batch(gw_render_octree *o, size_t pixels, batch *b, gw_error *error)
{
	size_t count = pixels < BATCH ? pixels : BATCH;
	b->host = gw_allocate_array(count, 4 * sizeof *b->host);
	if (!b->host)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu pixels", count);
	gw_buffer *const buffer[] = { &b->position, &b->normal, &b->result };
	static const char *const name[] = { "pixel position", "pixel normal", "pixel result" };
	for (int i = 0; i < 3; i++)
		GW_TRY(gw_buffer_create(o->gpu,
								&(gw_buffer_description){ GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED,
														  16 * (uint64_t)count, name[i] },
								buffer[i], error));
	return GW_OK;
}

static void close_batch(gw_render_octree *o, batch *b)
{
	gw_buffer_destroy(o->gpu, &b->position);
	gw_buffer_destroy(o->gpu, &b->normal);
	gw_buffer_destroy(o->gpu, &b->result);
	free(b->host);
}

static gw_status load_batch(gw_render_octree *o, batch *b, const gw_pixels *pixels, size_t first,
							size_t count, gw_error *error)
{
	b->first = first;
	b->count = count;
	for (size_t i = 0; i < count; i++) {
		gw_render_octree_to_grid(o, pixels->position + 4 * (first + i), b->host + 4 * i);
		b->host[4 * i + 3] = pixels->position[4 * (first + i) + 3];
	}
	GW_TRY(gw_buffer_upload(o->gpu, &b->position, 0, b->host, 16 * (uint64_t)count, error));
	return gw_buffer_upload(o->gpu, &b->normal, 0, pixels->normal + 4 * first, 16 * (uint64_t)count,
							error);
}

/* One pass over a batch. */
typedef gw_status (*batch_pass)(gw_render_octree *o, const batch *b, const gw_pixels *pixels,
								const void *how, gw_error *error);

static gw_status run_batches(gw_render_octree *o, const gw_pixels *pixels, batch_pass run,
							 const void *how, float *result, gw_error *error)
{
	batch b = { .host = NULL };
	gw_status status = pixels->count ? open_batch(o, pixels->count, &b, error) : GW_OK;
	for (size_t first = 0; first < pixels->count && status == GW_OK; first += BATCH) {
		size_t count = pixels->count - first < BATCH ? pixels->count - first : BATCH;
		status = load_batch(o, &b, pixels, first, count, error);
		if (status == GW_OK)
			status = run(o, &b, pixels, how, error);
		if (status == GW_OK)
			status = gw_buffer_download(o->gpu, &b.result, 0, result + 4 * first,
										16 * (uint64_t)count, error);
	}
	close_batch(o, &b);
	return status;
}

gw_binding gw_render_octree_sky(const gw_render_octree *o)
{
	return gw_whole(o->sky.width > 0 ? &o->sky.texel : &o->surfel_radiance);
}

static gw_status run_rays(gw_render_octree *o, const batch *b, const gw_pixels *pixels,
						  const void *how, gw_error *error)
{
	const gw_reflection *r = how;
	const gw_octree *t = &o->octree;
	gw_pixel_push push = { .rays = r->rays,
						   .seed = r->seed,
						   .pixel_first = (uint32_t)b->first,
						   .eye = eye_of(o, pixels, 0.0f),
						   .sky = { r->sky[0], r->sky[1], r->sky[2], 0.0f },
						   .sky_width = o->sky.width,
						   .sky_height = o->sky.height,
						   .sky_turn = o->sky.turn,
						   .sky_y_up = o->sky.y_up };
	const gw_binding bindings[] = {
		GW_TRACE_BINDINGS(t),        GW_DISC_BINDINGS(t),       gw_whole(&o->surfel_radiance),
		gw_window(&b->position, 16), gw_window(&b->normal, 16), gw_window(&b->result, 16),
		GW_TREE_BINDING(t),          gw_render_octree_sky(o),   GW_OPACITY_BINDING(t)
	};
	for (push.ray = 0; push.ray < r->rays; push.ray++) {
		GW_TRY(gw_passes_run(&o->passes, GW_PASS_PIXEL_RAYS, bindings, &push, b->count, error));
		if (r->cancelled && r->cancelled(r->user))
			return gw_fail(error, GW_ERROR_CANCELLED, "stopped while light was reflected");
	}
	return GW_OK;
}

/* Of passes that read the bricks. */
#define BRICK_BINDINGS(o, b)                                                                       \
	gw_whole(&(o)->octree.level_directory), gw_whole(&(o)->octree.node),                           \
		gw_voxels_of(&(o)->bricks.leaf_pool), gw_voxels_of(&(o)->bricks.mip_pool),                 \
		gw_window(&(b)->position, 16), gw_window(&(b)->normal, 16), gw_window(&(b)->result, 16)

static gw_status run_cone(gw_render_octree *o, const batch *b, const gw_pixels *pixels,
						  const void *how, gw_error *error)
{
	const gw_reflection *r = how;
	gw_cone_push push = gw_cone_gather_push(&o->bricks, o->scale, r->sky);
	push.eye = eye_of(o, pixels, 0.0f);
	push.sky_width = o->sky.width;
	push.sky_height = o->sky.height;
	push.sky_turn = o->sky.turn;
	push.sky_y_up = o->sky.y_up;
	const gw_binding bindings[] = { BRICK_BINDINGS(o, b), gw_render_octree_sky(o) };
	return gw_passes_run(&o->passes, GW_PASS_PIXEL_CONE, bindings, &push, b->count, error);
}

/* ------------------------------------------------------------------------- pixels, by caches */

typedef struct cache_run {
	const gw_gloss_caches *caches;
	const gw_reflection *reflection;
} cache_run;

static gw_status run_caches(gw_render_octree *o, const batch *b, const gw_pixels *pixels,
							const void *how, gw_error *error)
{
	const cache_run *run = how;
	const gw_gloss_caches *c = run->caches;
	gw_cache_push push = gw_gloss_caches_push(o, c, run->reflection);
	push.pixel_first = (uint32_t)b->first;
	push.eye = eye_of(o, pixels, 0.0f);
	const gw_binding bindings[] = { gw_whole(&c->tile_first),    gw_whole(&c->place),
									gw_whole(&c->facing),        gw_whole(&c->pixel),
									gw_whole(&c->texel),         gw_whole(&c->screen),
									gw_window(&b->position, 16), gw_window(&b->normal, 16),
									gw_window(&b->result, 16) };
	if (run->reflection->cancelled && run->reflection->cancelled(run->reflection->user))
		return gw_fail(error, GW_ERROR_CANCELLED, "stopped while light was reflected");
	return gw_passes_run(&o->passes, GW_PASS_PIXEL_CACHES, bindings, &push, b->count, error);
}

/* Some of the pixels, as pixels of their own. */
typedef struct pixel_part {
	size_t count;
	uint32_t *pixel; /* count: which of all, ascending */
	float *position, *normal, *reflected;
} pixel_part;

static void clear_part(pixel_part *part)
{
	free(part->pixel);
	free(part->position);
	free(part->normal);
	free(part->reflected);
}

/* Takes those that read caches, or all others. */
static gw_status take_part(const gw_pixels *pixels, const gw_gloss_caches *caches, bool readers,
						   pixel_part *part, gw_error *error)
{
	size_t count = readers ? caches->reader_count : pixels->count - caches->reader_count;
	*part = (pixel_part){ .pixel = gw_allocate_array(count, sizeof *part->pixel),
						  .position = gw_allocate_array(count, 4 * sizeof *part->position),
						  .normal = gw_allocate_array(count, 4 * sizeof *part->normal),
						  .reflected = gw_allocate_array(count, 4 * sizeof *part->reflected) };
	if (!part->pixel || !part->position || !part->normal || !part->reflected)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu pixels", count);
	for (size_t i = 0, next = 0; i < pixels->count; i++) {
		bool reads = next < caches->reader_count && caches->reader[next] == i;
		next += reads;
		if (reads != readers)
			continue;
		memcpy(part->position + 4 * part->count, pixels->position + 4 * i, 4 * sizeof(float));
		memcpy(part->normal + 4 * part->count, pixels->normal + 4 * i, 4 * sizeof(float));
		part->pixel[part->count++] = (uint32_t)i;
	}
	return GW_OK;
}

static gw_status reflect_part(gw_render_octree *o, const gw_pixels *pixels, const cache_run *how,
							  bool readers, float *reflected, gw_error *error)
{
	pixel_part part;
	gw_status status = take_part(pixels, how->caches, readers, &part, error);
	gw_pixels own = { .count = part.count, .position = part.position, .normal = part.normal };
	memcpy(own.eye, pixels->eye, sizeof own.eye);
	if (status == GW_OK)
		status = readers ? run_batches(o, &own, run_caches, how, part.reflected, error)
						 : run_batches(o, &own, run_rays, how->reflection, part.reflected, error);
	for (size_t i = 0; i < part.count && status == GW_OK; i++)
		memcpy(reflected + 4 * (size_t)part.pixel[i], part.reflected + 4 * i, 4 * sizeof(float));
	clear_part(&part);
	return status;
}

static gw_status reflect_by_caches(gw_render_octree *o, const gw_pixels *pixels,
								   const gw_reflection *reflection, float *reflected,
								   gw_error *error)
{
	gw_gloss_caches caches;
	GW_TRY(gw_gloss_caches_make(o, pixels, reflection, &caches, error));
	const cache_run how = { &caches, reflection };
	gw_status status = reflect_part(o, pixels, &how, true, reflected, error);
	if (status == GW_OK)
		status = reflect_part(o, pixels, &how, false, reflected, error);
	gw_gloss_caches_destroy(o->gpu, &caches);
	return status;
}

gw_status gw_render_octree_reflect(gw_render_octree *o, const gw_pixels *pixels,
								   const gw_reflection *reflection, float *reflected,
								   gw_error *error)
{
	if (reflection->caches)
		return reflect_by_caches(o, pixels, reflection, reflected, error);
	return run_batches(o, pixels, reflection->cone ? run_cone : run_rays, reflection, reflected,
					   error);
}

static gw_status run_read(gw_render_octree *o, const batch *b, const gw_pixels *pixels,
						  const void *how, gw_error *error)
{
	const float black[3] = { 0 };
	gw_cone_push push = gw_cone_gather_push(&o->bricks, o->scale, black);
	push.eye = eye_of(o, pixels, *(const bool *)how ? 1.0f : 0.0f);
	const gw_binding bindings[] = { BRICK_BINDINGS(o, b) };
	return gw_passes_run(&o->passes, GW_PASS_PIXEL_BRICKS, bindings, &push, b->count, error);
}

gw_status gw_render_octree_read(gw_render_octree *o, const gw_pixels *pixels, bool cubic,
								float *radiance, gw_error *error)
{
	return run_batches(o, pixels, run_read, &cubic, radiance, error);
}

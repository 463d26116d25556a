/* raster_tile.c - one tile of the picture; see raster_steps.h. */
#include "picture/raster_steps.h"

#include <assert.h>
#include <stddef.h>
#include <string.h>

/* Fragments whose normals are further apart are of another surface, or of the back of this one. */
#define LEAST_COSINE 0.3f

/* How far behind the nearest one a fragment of the same surface may lie, in tolerances: surfaces
 * that are seen edge-on would reach through everything. */
#define DEEPEST 4.0f

/* Least sum of weights of a solid surface. Within one some eight discs overlap and the sum is 2 on
 * average; less than this has the rim of one or two discs, which mostly stick out over an edge. */
#define SOLID 0.25f

#define BUCKETS 1024u /* of depth, into which a tile's primitives are sorted */
#define BATCH 32u     /* primitives between two looks at how far a tile reaches */

#define FIXED GW_RASTER_FIXED

/* Of what lies behind, so little is not seen; and so many surfaces one behind the other at most. */
#define LEFT_LEAST (1.0f / 256.0f)
#define SURFACES_MOST 64

/* One tile being drawn. */
typedef struct tile_job {
	const gw_raster_view *view;
	gw_raster_scratch *scratch;
	gw_raster_cover *cover;
	const gw_raster_layer *layer; /* that is being drawn */
	int32_t x0, x1, y0, y1;       /* samples, both ends included */
} tile_job;

static size_t slot_of(const tile_job *job, int32_t x, int32_t y)
{
	return (size_t)(y - job->y0) * job->view->tile + (size_t)(x - job->x0);
}

/* Cuts the samples of a shape to those of the tile, and begins at a multiple of the lanes. What is
 * added at the side misses the shape. */
static void cut_to_tile(const tile_job *job, gw_raster_shape *s)
{
	s->x0 = s->x0 > job->x0 ? s->x0 : job->x0;
	s->y0 = s->y0 > job->y0 ? s->y0 : job->y0;
	s->x1 = s->x1 < job->x1 ? s->x1 : job->x1;
	s->y1 = s->y1 < job->y1 ? s->y1 : job->y1;
	s->x0 -= (s->x0 - job->x0) % GW_LANES;
}

/* The fragments of a shape in the layer. Where nothing else is, what lies beyond an edge counts. */
static void meet_shape(const tile_job *job, const gw_raster_shape *s, int32_t x, int32_t y,
					   gw_raster_fragments *f)
{
	gw_raster_shape_meet(job->view, s, x, y, f);
	const gw_raster_layer *first = job->scratch->layer;
	if (s->cuts == 0 || job->layer == first)
		return;
	for (int i = 0; i < GW_LANES; i++)
		if (first->id[slot_of(job, x + i, y)] == GW_RASTER_NOTHING)
			f->hit[i] |= f->beyond[i];
}

static void draw_depth(const tile_job *job, const gw_raster_shape *s, uint32_t id)
{
	for (int32_t y = s->y0; y <= s->y1; y++)
		for (int32_t x = s->x0; x <= s->x1; x += GW_LANES) {
			size_t slot = slot_of(job, x, y);
			float *depth = job->layer->depth + slot;
			const float *least = job->scratch->floor + slot;
			uint32_t *seen = job->layer->id + slot;
			gw_raster_fragments f;
			meet_shape(job, s, x, y, &f);
			for (int i = 0; i < GW_LANES; i++) {
				bool nearer = f.hit[i] && f.depth[i] < depth[i] && f.depth[i] > least[i];
				depth[i] = nearer ? f.depth[i] : depth[i];
				seen[i] = nearer ? id : seen[i];
			}
		}
}

/* The normals of what is nearest, against which the second pass compares. */
static void note_normals(const tile_job *job)
{
	const gw_raster_layer *layer = job->layer;
	size_t samples = (size_t)job->view->tile * job->view->tile;
	for (size_t i = 0; i < samples; i++)
		if (layer->id[i] != GW_RASTER_NOTHING)
			gw_raster_normal(job->view, layer->id[i], layer->normal + 3 * i);
}

/* The furthest depth of each block, now. */
static void measure_blocks(const tile_job *job)
{
	const gw_raster_scratch *scratch = job->scratch;
	size_t side = job->view->tile, blocks = side / GW_RASTER_BLOCK;
	for (size_t b = 0; b < blocks * blocks; b++) {
		const float *depth =
			job->layer->depth + b / blocks * GW_RASTER_BLOCK * side + b % blocks * GW_RASTER_BLOCK;
		float far = 0.0f;
		for (size_t y = 0; y < GW_RASTER_BLOCK; y++)
			for (size_t x = 0; x < GW_RASTER_BLOCK; x++)
				far = depth[y * side + x] > far ? depth[y * side + x] : far;
		scratch->far[b] = far;
	}
}

/* Whether all that a primitive may meet is nearer than it. Samples outside of the picture are never
 * covered, so their blocks hide nothing. */
static bool is_hidden(const tile_job *job, const gw_raster_entry *entry, float near)
{
	size_t blocks = job->view->tile / GW_RASTER_BLOCK;
	for (size_t y = entry->y0; y <= entry->y1; y++)
		for (size_t x = entry->x0; x <= entry->x1; x++)
			if (near <= job->scratch->far[y * blocks + x])
				return false;
	return true;
}

/* Which fragments belong to the surface that is seen at their samples. */
static gw_lane_mask find_seen(const tile_job *job, const gw_raster_shape *s, uint32_t id,
							  const gw_raster_fragments *f, int32_t x, int32_t y)
{
	size_t slot = slot_of(job, x, y);
	const float *depth = job->layer->depth + slot;
	const uint32_t *seen = job->layer->id + slot;
	float ray_y = gw_raster_ray_y(job->view, y);
	gw_lane_mask mask = f->hit;
	for (int i = 0; i < GW_LANES; i++) {
		if (!mask[i] || seen[i] == id)
			continue;
		if (seen[i] == GW_RASTER_NOTHING) {
			mask[i] = 0;
			continue;
		}
		float behind = f->depth[i] - depth[i];
		float slope = fabsf(s->normal[0] * gw_raster_ray_x(job->view, x + i) +
							s->normal[1] * ray_y + s->normal[2]);
		const float *n = job->layer->normal + 3 * (slot + (size_t)i);
		float cosine = n[0] * s->normal[0] + n[1] * s->normal[1] + n[2] * s->normal[2];
		/* Of the second layer, all that is nearer belongs to the first. */
		if (behind < 0.0f || behind > DEEPEST * s->tolerance || behind * slope > s->tolerance ||
			!(cosine > LEAST_COSINE))
			mask[i] = 0;
	}
	return mask;
}

static void add_disc(const tile_job *job, const gw_raster_shape *s, uint32_t id, float weight,
					 float *sum)
{
	uint32_t channels = job->view->scene->channel_count;
	const float *channel = job->view->scene->discs.channel + (size_t)channels * id;
	const float *clear = job->view->scene->discs.transparency;
	sum[0] += weight;
	for (int k = 0; k < 3; k++)
		sum[1 + k] += weight * s->normal[k];
	sum[4] += clear ? weight * (1.0f - clear[id]) : weight;
	for (uint32_t c = 0; c < channels; c++)
		sum[FIXED + c] += weight * channel[c];
}

static void add_triangle(const tile_job *job, const gw_raster_shape *s, size_t triangle,
						 const gw_raster_fragments *f, int lane, float *sum)
{
	const gw_raster_triangles *mesh = &job->view->scene->triangles;
	uint32_t channels = job->view->scene->channel_count;
	double world[3] = { 0, 0, 0 }, turned[3];
	float weight = f->weight[lane];
	sum[0] += weight;
	for (size_t i = 0; i < 3; i++) {
		size_t vertex = mesh->index[3 * triangle + i];
		float share = weight * f->barycentric[i][lane];
		for (size_t k = 0; k < 3 && mesh->normal; k++)
			world[k] += (double)(share * mesh->normal[3 * vertex + k]);
		for (uint32_t c = 0; c < channels; c++)
			sum[FIXED + c] += share * mesh->channel[channels * vertex + c];
	}
	gw_camera_turn(job->view->camera, world, turned);
	sum[4] += weight;
	for (int k = 0; k < 3; k++)
		sum[1 + k] += mesh->normal ? (float)turned[k] : weight * s->normal[k];
}

static void draw_attributes(const tile_job *job, const gw_raster_shape *s, uint32_t id)
{
	const gw_raster_view *view = job->view;
	size_t stride = FIXED + view->scene->channel_count, discs = view->scene->discs.count;
	for (int32_t y = s->y0; y <= s->y1; y++)
		for (int32_t x = s->x0; x <= s->x1; x += GW_LANES) {
			gw_raster_fragments f;
			meet_shape(job, s, x, y, &f);
			gw_lane_mask seen = find_seen(job, s, id, &f, x, y);
			bool glows = id < discs && view->scene->discs.glows && view->scene->discs.glows[id];
			float *sum = glows ? job->layer->glow : job->layer->sum;
			sum += slot_of(job, x, y) * stride;
			for (int i = 0; i < GW_LANES; i++, sum += stride) {
				if (!seen[i])
					continue;
				if (id < discs)
					add_disc(job, s, id, f.weight[i], sum);
				else
					add_triangle(job, s, id - discs, &f, i, sum);
			}
		}
}

/* ------------------------------------------------------------------------ samples to pixels */

typedef struct pixel_sum {
	uint32_t covered;
	float depth, facing, normal[3], channel[GW_RASTER_CHANNELS_MAX];
	uint32_t id;
} pixel_sum;

/* The layer that is shown at a sample. The second one is sure when the first is thin; where that is
 * empty, it is what lies beyond an edge. */
typedef enum shown_layer { SHOWN_FIRST, SHOWN_SECOND, SHOWN_BEYOND, SHOWN_NOTHING } shown_layer;

/* What is behind counts where it is solid and the front is not. */
static shown_layer choose_layer(const tile_job *job, size_t slot)
{
	const gw_raster_layer *layer = job->scratch->layer;
	size_t stride = FIXED + job->view->scene->channel_count;
	float front = layer[0].sum[slot * stride], back = layer[1].sum[slot * stride];
	if (front > 0.0f)
		return front < SOLID && back >= SOLID ? SHOWN_SECOND : SHOWN_FIRST;
	return back > 0.0f ? SHOWN_BEYOND : SHOWN_NOTHING;
}

/* The depth of what is nearest, without what the back of a surface was put behind. */
static float depth_of(const tile_job *job, const gw_raster_layer *layer, size_t slot,
					  const float ray[3])
{
	const gw_raster_discs *discs = &job->view->scene->discs;
	const float *n = layer->normal + 3 * slot;
	uint32_t id = layer->id[slot];
	bool back = n[0] * ray[0] + n[1] * ray[1] + n[2] > 0.0f && id < discs->count;
	float behind = back ? gw_raster_tolerance(job->view, id) : 0.0f;
	return layer->depth[slot] - behind;
}

static void add_sample(const tile_job *job, int32_t x, int32_t y, const gw_raster_layer *layer,
					   pixel_sum *pixel)
{
	uint32_t channels = job->view->scene->channel_count;
	size_t slot = slot_of(job, x, y);
	const float *sum = layer->sum + slot * (FIXED + channels);
	const float ray[3] = { gw_raster_ray_x(job->view, x), gw_raster_ray_y(job->view, y), 1.0f };
	float scale = 1.0f / sum[0], along = 0.0f, lengths = 0.0f, depth;
	for (int k = 0; k < 3; k++) {
		along += ray[k] * sum[1 + k];
		lengths += sum[1 + k] * sum[1 + k];
	}
	lengths *= ray[0] * ray[0] + ray[1] * ray[1] + 1.0f;
	pixel->facing += lengths > 0.0f ? fabsf(along) / sqrtf(lengths) : 0.0f;
	pixel->covered++;
	for (int k = 0; k < 3; k++)
		pixel->normal[k] += scale * sum[1 + k];
	for (uint32_t c = 0; c < channels; c++)
		pixel->channel[c] += scale * sum[FIXED + c];
	depth = depth_of(job, layer, slot, ray);
	if (depth < pixel->depth) {
		pixel->depth = depth;
		pixel->id = layer->id[slot];
	}
}

static void store_pixel(const gw_raster_view *view, const pixel_sum *pixel, gw_gbuffer *g,
						size_t at)
{
	uint32_t channels = g->channel_count;
	const gw_camera *camera = view->camera;
	const float *n = pixel->normal;
	float length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
	float share = pixel->covered ? 1.0f / (float)pixel->covered : 0.0f;
	g->coverage[at] = 1.0f;
	g->depth[at] = pixel->depth;
	g->facing[at] = share * pixel->facing;
	g->id[at] = pixel->id;
	for (size_t k = 0; k < 3; k++) {
		double world = (double)n[0] * camera->right[k] + (double)n[1] * camera->up[k] +
					   (double)n[2] * camera->forward[k];
		g->normal[3 * at + k] = length > 0.0f ? (float)(world / (double)length) : 0.0f;
	}
	for (uint32_t c = 0; c < channels; c++)
		g->channel[channels * at + c] = share * pixel->channel[c];
}

/* What lies beyond edges is the pixel's only when there is nothing else. */
static void resolve_pixel(const tile_job *job, int32_t x, int32_t y, gw_gbuffer *g)
{
	const pixel_sum nothing = { .depth = INFINITY, .id = GW_RASTER_NOTHING };
	pixel_sum sure = nothing, beyond = nothing;
	int32_t samples = (int32_t)job->view->options->samples;
	const gw_raster_layer *layer = job->scratch->layer;
	assert(samples > 0);
	for (int32_t j = 0; j < samples; j++)
		for (int32_t i = 0; i < samples; i++) {
			size_t slot = slot_of(job, x + i, y + j);
			shown_layer shown = choose_layer(job, slot);
			if (shown != SHOWN_NOTHING)
				add_sample(job, x + i, y + j, layer + (shown != SHOWN_FIRST),
						   shown == SHOWN_BEYOND ? &beyond : &sure);
		}
	size_t at = (size_t)(y / samples) * g->width + (size_t)(x / samples);
	job->cover[at] = (gw_raster_cover){ (uint8_t)sure.covered, (uint8_t)beyond.covered };
	store_pixel(job->view, sure.covered ? &sure : &beyond, g, at);
}

static void resolve(const tile_job *job, gw_gbuffer *g)
{
	int32_t samples = (int32_t)job->view->options->samples;
	for (int32_t y = job->y0; y <= job->y1; y += samples)
		for (int32_t x = job->x0; x <= job->x1; x += samples)
			resolve_pixel(job, x, y, g);
}

/* Sorts the tile's primitives from near to far, roughly: what is drawn late is mostly hidden. */
static size_t sort_primitives(const tile_job *job, const gw_raster_bins *bins, size_t tile)
{
	gw_raster_scratch *scratch = job->scratch;
	size_t count = bins->first[tile + 1] - bins->first[tile], start[BUCKETS + 1] = { 0 };
	uint8_t last = (uint8_t)(job->view->tile / GW_RASTER_BLOCK - 1);
	float low = INFINITY, high = 0.0f;
	for (size_t i = 0; i < count; i++) {
		gw_raster_entry entry = { .primitive = bins->primitive[bins->first[tile] + i],
								  .x1 = last,
								  .y1 = last };
		gw_raster_reach(job->view, entry.primitive, &entry.near, &entry.tolerance);
		entry.near = fmaxf(entry.near, job->view->near);
		scratch->entry[i] = entry;
		low = fminf(low, entry.near);
		high = fmaxf(high, entry.near);
	}
	float scale = high > low ? (float)(BUCKETS - 1) / (high - low) : 0.0f;
	for (size_t i = 0; i < count; i++)
		start[(size_t)((scratch->entry[i].near - low) * scale) + 1]++;
	for (size_t b = 0; b < BUCKETS; b++)
		start[b + 1] += start[b];
	for (size_t i = 0; i < count; i++)
		scratch->order[start[(size_t)((scratch->entry[i].near - low) * scale)]++] =
			scratch->entry[i];
	return count;
}

/* Makes the shape of an entry, unless that is hidden, and notes where it is. */
static bool make_shape(const tile_job *job, gw_raster_entry *entry, float near,
					   gw_raster_shape *shape)
{
	if (is_hidden(job, entry, near) || !gw_raster_shape_make(job->view, entry->primitive, shape))
		return false;
	cut_to_tile(job, shape);
	entry->x0 = (uint8_t)((uint32_t)(shape->x0 - job->x0) / GW_RASTER_BLOCK);
	entry->x1 = (uint8_t)((uint32_t)(shape->x1 - job->x0) / GW_RASTER_BLOCK);
	entry->y0 = (uint8_t)((uint32_t)(shape->y0 - job->y0) / GW_RASTER_BLOCK);
	entry->y1 = (uint8_t)((uint32_t)(shape->y1 - job->y0) / GW_RASTER_BLOCK);
	return !is_hidden(job, entry, near);
}

static void draw_pass(const tile_job *job, size_t count, bool attributes)
{
	measure_blocks(job);
	uint32_t drawn = 0;
	for (size_t i = 0; i < count; i++) {
		gw_raster_entry *entry = job->scratch->order + i;
		gw_raster_shape shape;
		float near = entry->near - (attributes ? DEEPEST * entry->tolerance : 0.0f);
		if (!make_shape(job, entry, near, &shape))
			continue;
		if (attributes) {
			draw_attributes(job, &shape, entry->primitive);
		} else {
			draw_depth(job, &shape, entry->primitive);
			if (++drawn % BATCH == 0)
				measure_blocks(job);
		}
	}
}

/* Of what glows and what does not, the one that weighs more stands for both. */
static void choose_glow(const tile_job *job)
{
	const gw_raster_layer *layer = job->layer;
	size_t samples = (size_t)job->view->tile * job->view->tile;
	size_t stride = FIXED + job->view->scene->channel_count;
	for (size_t i = 0; i < samples && layer->glow; i++) {
		float *sum = layer->sum + i * stride;
		const float *glow = layer->glow + i * stride;
		if (!(glow[0] > 0.0f))
			continue;
		bool glows = glow[0] > sum[0];
		float scale = (glow[0] + sum[0]) / (glows ? glow[0] : sum[0]);
		for (size_t k = 0; k < stride; k++)
			sum[k] = scale * (glows ? glow[k] : sum[k]);
	}
}

static void draw_layer(tile_job *job, int layer, size_t count)
{
	job->layer = job->scratch->layer + layer;
	draw_pass(job, count, false);
	note_normals(job);
	draw_pass(job, count, true);
	choose_glow(job);
}

/* Opens the first layer, behind what has been blended, where that lets anything be seen. */
static void clear_first(const tile_job *job)
{
	const gw_raster_scratch *scratch = job->scratch;
	const gw_raster_layer *layer = scratch->layer;
	size_t samples = (size_t)job->view->tile * job->view->tile;
	size_t stride = FIXED + job->view->scene->channel_count;
	for (size_t i = 0; i < samples; i++) {
		bool open = !scratch->left || scratch->left[i] > LEFT_LEAST;
		layer->depth[i] = open ? INFINITY : 0.0f;
		layer->id[i] = GW_RASTER_NOTHING;
		scratch->floor[i] = scratch->start ? scratch->start[i] : 0.0f;
	}
	for (int l = 0; l < 2; l++) {
		memset(layer[l].sum, 0, samples * stride * sizeof *layer->sum);
		if (layer[l].glow)
			memset(layer[l].glow, 0, samples * stride * sizeof *layer->glow);
	}
}

/* Opens the second layer where the first is thin or empty, and closes it elsewhere; false when it
 * is so nowhere. */
static bool clear_second(const tile_job *job)
{
	const gw_raster_discs *discs = &job->view->scene->discs;
	const gw_raster_layer *first = job->scratch->layer, *second = first + 1;
	size_t samples = (size_t)job->view->tile * job->view->tile;
	size_t stride = FIXED + job->view->scene->channel_count;
	bool any = false;
	for (size_t i = 0; i < samples; i++) {
		bool empty = first->id[i] == GW_RASTER_NOTHING;
		bool closed = empty && first->depth[i] == 0.0f;
		bool open = !closed && (empty || first->sum[i * stride] < SOLID);
		any |= open;
		second->depth[i] = open ? INFINITY : 0.0f;
		second->id[i] = GW_RASTER_NOTHING;
		float start = job->scratch->start ? job->scratch->start[i] : 0.0f;
		job->scratch->floor[i] = empty ? start : first->depth[i];
		if (open && first->id[i] < discs->count)
			job->scratch->floor[i] +=
				discs->radius[first->id[i]] * job->view->options->radius_scale;
	}
	return any;
}

static void draw_layers(tile_job *job, size_t count)
{
	clear_first(job);
	draw_layer(job, 0, count);
	if (clear_second(job))
		draw_layer(job, 1, count);
}

/* ---------------------------------------------------------------- surface that is seen through */

static void clear_blend(const tile_job *job)
{
	const gw_raster_scratch *scratch = job->scratch;
	size_t samples = (size_t)job->view->tile * job->view->tile;
	for (size_t i = 0; i < samples; i++) {
		scratch->left[i] = 1.0f;
		scratch->start[i] = 0.0f;
	}
	memset(scratch->blend, 0, samples * (1 + job->view->scene->channel_count) * sizeof(float));
}

/* Behind which depth all is of another surface than the one that is nearest there. */
static float end_of_surface(const tile_job *job, const gw_raster_layer *layer, size_t slot,
							int32_t x, int32_t y)
{
	uint32_t id = layer->id[slot];
	if (id >= job->view->scene->discs.count)
		return layer->depth[slot];
	const float *n = layer->normal + 3 * slot;
	float slope =
		fabsf(n[0] * gw_raster_ray_x(job->view, x) + n[1] * gw_raster_ray_y(job->view, y) + n[2]);
	float tolerance = gw_raster_tolerance(job->view, id);
	return layer->depth[slot] + fminf(DEEPEST * tolerance, tolerance / fmaxf(slope, 1e-6f));
}

/* Puts what is shown at a sample behind what has been blended there; false when nothing behind that
 * can be seen. What lies beyond edges is there for holes in what is solid. */
static bool blend_sample(const tile_job *job, int32_t x, int32_t y)
{
	const gw_raster_scratch *scratch = job->scratch;
	uint32_t channels = job->view->scene->channel_count;
	size_t slot = slot_of(job, x, y);
	shown_layer shown = choose_layer(job, slot);
	float *left = scratch->left + slot, *blend = scratch->blend + slot * (1 + channels);
	if (!(*left > LEFT_LEAST) || shown == SHOWN_NOTHING || shown == SHOWN_BEYOND) {
		*left = 0.0f;
		return false;
	}
	const gw_raster_layer *layer = scratch->layer + (shown != SHOWN_FIRST);
	const float *sum = layer->sum + slot * (FIXED + channels);
	float opacity = fminf(sum[4] / sum[0], 1.0f);
	blend[0] += *left * opacity;
	for (uint32_t c = 0; c < channels; c++)
		blend[1 + c] += *left * opacity * sum[FIXED + c] / sum[0];
	*left *= 1.0f - opacity;
	scratch->start[slot] = end_of_surface(job, layer, slot, x, y);
	return *left > LEFT_LEAST;
}

/* The same of all samples; false when none is left. */
static bool blend_layers(const tile_job *job)
{
	bool any = false;
	for (int32_t y = job->y0; y <= job->y1; y++)
		for (int32_t x = job->x0; x <= job->x1; x++)
			any |= blend_sample(job, x, y);
	return any;
}

/* Channels and opacity of a pixel, from the samples where anything is. */
static void resolve_blend_pixel(const tile_job *job, int32_t x, int32_t y, gw_gbuffer *g)
{
	uint32_t channels = g->channel_count;
	int32_t samples = (int32_t)job->view->options->samples;
	size_t at = (size_t)(y / samples) * g->width + (size_t)(x / samples);
	float sum[1 + GW_RASTER_CHANNELS_MAX] = { 0.0f };
	for (int32_t i = 0; i < samples * samples; i++) {
		size_t slot = slot_of(job, x + i % samples, y + i / samples);
		for (uint32_t c = 0; c <= channels; c++)
			sum[c] += job->scratch->blend[slot * (1 + channels) + c];
	}
	if (!(sum[0] > 0.0f))
		return;
	for (uint32_t c = 0; c < channels; c++)
		g->channel[channels * at + c] = sum[1 + c] / sum[0];
	g->coverage[at] = fminf(sum[0] / (float)job->cover[at].sure, 1.0f);
}

static void resolve_blend(const tile_job *job, gw_gbuffer *g)
{
	int32_t samples = (int32_t)job->view->options->samples;
	for (int32_t y = job->y0; y <= job->y1; y += samples)
		for (int32_t x = job->x0; x <= job->x1; x += samples)
			resolve_blend_pixel(job, x, y, g);
}

void gw_raster_tile_draw(const gw_raster_view *view, const gw_raster_bins *bins, size_t tile,
						 gw_raster_scratch *scratch, gw_raster_cover *cover, gw_gbuffer *gbuffer)
{
	uint32_t left = (uint32_t)(tile % view->tiles_x) * view->tile;
	uint32_t top = (uint32_t)(tile / view->tiles_x) * view->tile;
	uint32_t right = left + view->tile, bottom = top + view->tile;
	right = right < view->columns ? right : view->columns;
	bottom = bottom < view->rows ? bottom : view->rows;
	tile_job job = { .view = view,
					 .scratch = scratch,
					 .cover = cover,
					 .x0 = (int32_t)left,
					 .x1 = (int32_t)right - 1,
					 .y0 = (int32_t)top,
					 .y1 = (int32_t)bottom - 1 };
	if (scratch->left)
		clear_blend(&job);
	size_t count = sort_primitives(&job, bins, tile);
	draw_layers(&job, count);
	resolve(&job, gbuffer);
	if (!scratch->left)
		return;
	for (int surface = 1; blend_layers(&job) && surface < SURFACES_MOST; surface++)
		draw_layers(&job, count);
	resolve_blend(&job, gbuffer);
}

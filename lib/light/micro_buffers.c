/*
 * micro_buffers.c - see micro_buffers.h. On the processor: how many nodes a record visits has no
 * bound that a device's loops would keep to.
 */
#include "light/micro_buffers.h"

#include "base/memory.h"
#include "base/parallel.h"
#include "base/shader_math.h"
#include "cloud/surfels.h"
#include "light/shader_functions.h"
#include "light/shut_out.h"
#include "octree/compartments.h"
#include "octree/trace_constants.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* Of a node that is drawn: the half-angle of its cone, radians; how many texels the sphere around
 * it covers; the same where an edge lies in it, which leaves no room for both sides of a wall; how
 * many of its radii it is away. */
#define CONE_MOST 0.45f
#define TEXELS_MOST_COVERED 2.0f
#define CONE_OF_EDGE 1.0f
#define EDGE_TEXELS 0.25f
#define RADII_LEAST 2.0f

/* Sine of the height above the horizon below which nothing is drawn: 0.04 % of an even sky. */
#define HORIZON 0.02f

/* By how much pieces reach beyond their cells, of the cells' sides, so that no crack is left
 * between planes that adjoin; more would make what stands out of a surface wider than it is. */
#define NODE_OVERLAP 0.02f
#define FACET_OVERLAP 0.1f

/* Where a texel sees nothing, as GW_FAR of rays. */
#define FAR_AWAY 1e9f

#define TEXELS_MOST (GW_BUFFER_SIDE_MOST * GW_BUFFER_SIDE_MOST)

/* What all records share. */
typedef struct drawing {
	const gw_surface_tree *tree;
	const float *place, *normal; /* 4 a record */
	uint32_t side, rays, seed, dark;
	float texel_angle; /* steradians, mean */
	uint32_t *hit;     /* rays a record */
	float *distance;
	_Atomic uint64_t drawn;
	struct buffer *of_worker; /* one a thread */
} drawing;

/* One record's buffer. */
typedef struct buffer {
	const drawing *d;
	gw_vec3 g, normal, tangent, bitangent;
	uint32_t seed;
	uint64_t drawn;
	uint32_t *texel;                             /* of each ray */
	uint32_t of[TEXELS_MOST];                    /* how many rays go through each texel */
	gw_vec3 way[TEXELS_MOST];                    /* where it looks */
	float depth[TEXELS_MOST], back[TEXELS_MOST]; /* back: of what turns its back */
	uint32_t piece[TEXELS_MOST];
} buffer;

uint32_t gw_micro_buffers_side(uint32_t rays)
{
	uint32_t side = GW_BUFFER_SIDE_LEAST;
	while (side < GW_BUFFER_SIDE_MOST && side * side < 4 * rays)
		side++;
	return side;
}

/* ------------------------------------------------------------------------------- the paraboloid */

/* The texel of a direction above the horizon. */
static uint32_t texel_of(const buffer *b, gw_vec3 direction)
{
	uint32_t side = b->d->side, last = side - 1;
	float scale = 0.5f * (float)side / (1.0f + gw_larger(gw_dot(direction, b->normal), 0.0f));
	float half = 0.5f * (float)side;
	float x = half + scale * gw_dot(direction, b->tangent);
	float y = half + scale * gw_dot(direction, b->bitangent);
	uint32_t i = x > 0.0f ? (uint32_t)x : 0, j = y > 0.0f ? (uint32_t)y : 0;
	return (j < last ? j : last) * side + (i < last ? i : last);
}

/* Texels that may see some of a sphere; none: the first lies behind the last. */
typedef struct window {
	uint32_t first[2], last[2]; /* columns, rows; last: one behind */
} window;

static void clip(float low, float high, uint32_t side, uint32_t *first, uint32_t *last)
{
	float from = floorf(0.5f * (float)side * (low + 1.0f));
	float to = ceilf(0.5f * (float)side * (high + 1.0f));
	*first = from > 0.0f ? (uint32_t)fminf(from, (float)side) : 0;
	*last = to > 0.0f ? (uint32_t)fminf(to, (float)side) : 0;
}

/* Circles of directions are circles of the paraboloid. */
static window window_of(const buffer *b, gw_vec3 to, float distance, float radius)
{
	uint32_t side = b->d->side;
	window w = { { 0, 0 }, { side, side } };
	if (distance <= radius)
		return w;
	float x = gw_dot(to, b->tangent), y = gw_dot(to, b->bitangent), z = gw_dot(to, b->normal);
	float sine = radius / distance, half = sine / (1.0f + sqrtf(1.0f - sine * sine));
	float level = sqrtf(x * x + y * y), rho = level / gw_larger(distance + z, 1e-6f * distance);
	float far = 1.0f - rho * half;
	if (far < 0.1f)
		return w;
	float nearer = (rho - half) / (1.0f + rho * half), farther = (rho + half) / far;
	float reach = 0.5f * (farther - nearer), along = 0.5f * (farther + nearer);
	float scale = level > 0.0f ? along / level : 0.0f;
	clip(x * scale - reach, x * scale + reach, side, &w.first[0], &w.last[0]);
	clip(y * scale - reach, y * scale + reach, side, &w.first[1], &w.last[1]);
	return w;
}

/* ------------------------------------------------------------------------------------- drawing */

/* Does a piece hold a place on its plane? */
static bool holds(const gw_surface_piece *p, gw_vec3 at, float overlap)
{
	gw_vec3 off = gw_minus(at, (gw_vec3){ p->place[0], p->place[1], p->place[2] });
	if (gw_dot(off, off) > p->radius * p->radius)
		return false;
	if (p->size == 0.0f)
		return true;
	float half = 0.5f * p->size, most = half + overlap;
	return fabsf(at.x - p->low[0] - half) <= most && fabsf(at.y - p->low[1] - half) <= most &&
		   fabsf(at.z - p->low[2] - half) <= most;
}

/* May what is so near be the surface that the record lies on? As for rays: octree_trace.glsl. */
static bool is_own(const buffer *b, const gw_surface_piece *p, float t)
{
	const gw_vec3 normal = { p->normal[0], p->normal[1], p->normal[2] };
	const gw_vec3 place = { p->place[0], p->place[1], p->place[2] };
	float like = gw_larger(gw_dot(normal, b->normal), GW_LIKE_LEAST);
	return t < GW_NEAR && gw_dot(b->normal, gw_minus(place, b->g)) < GW_NEAR_HEIGHT * like;
}

/* Does a direction pass what lets some of them through? */
static bool is_let_through(const buffer *b, const gw_surface_piece *p, uint32_t texel)
{
	uint32_t piece = (uint32_t)(p - b->d->tree->piece);
	return p->opacity < 1.0f && (float)pcg_hash2(piece, b->seed ^ texel) * 0x1p-32f >= p->opacity;
}

static void draw_texel(buffer *b, const gw_surface_piece *p, float height, uint32_t texel)
{
	const gw_vec3 normal = { p->normal[0], p->normal[1], p->normal[2] };
	float approach = gw_dot(normal, b->way[texel]), t = height / approach;
	bool behind = approach > 0.0f && !p->two_sided;
	if (!(t > 0.0f) || t >= gw_larger(b->depth[texel], b->back[texel]))
		return;
	float overlap = p->count > 0 ? NODE_OVERLAP * p->size : FACET_OVERLAP;
	if (!holds(p, gw_plus(b->g, gw_times(b->way[texel], t)), overlap) || is_own(b, p, t) ||
		is_let_through(b, p, texel))
		return;
	bool dark = behind && p->opacity < 1.0f;
	if (behind && !dark) {
		b->back[texel] = gw_smaller(b->back[texel], t);
	} else if (t < b->depth[texel]) {
		b->depth[texel] = t;
		b->piece[texel] = dark ? b->d->dark : (uint32_t)(p - b->d->tree->piece);
	}
}

static void draw_piece(buffer *b, const gw_surface_piece *p, const window *w)
{
	float height =
		p->offset - p->normal[0] * b->g.x - p->normal[1] * b->g.y - p->normal[2] * b->g.z;
	uint32_t side = b->d->side;
	b->drawn++;
	for (uint32_t j = w->first[1]; j < w->last[1]; j++)
		for (uint32_t i = w->first[0]; i < w->last[0]; i++)
			if (b->of[j * side + i] > 0)
				draw_texel(b, p, height, j * side + i);
}

/* Is a node fine enough? At an edge, where it cannot be flat or ends, it has to be finer. */
static bool is_fine(const buffer *b, const gw_surface_piece *p, float distance)
{
	float texels = GW_PI * p->radius * p->radius / (distance * distance * b->d->texel_angle);
	float cone = texels <= EDGE_TEXELS ? CONE_OF_EDGE : CONE_MOST;
	return texels <= (p->full ? TEXELS_MOST_COVERED : EDGE_TEXELS) && p->cone <= cone &&
		   distance >= RADII_LEAST * p->radius;
}

/* Is a piece below the horizon, or so near to it that it hardly matters? What faces as the record
 * does is flat along it. `to` leads to its place. */
static bool is_low(const buffer *b, const gw_surface_piece *p, gw_vec3 to, float distance)
{
	const gw_vec3 normal = { p->normal[0], p->normal[1], p->normal[2] };
	float height = gw_dot(to, b->normal), rise = p->radius;
	if (p->cone < CONE_MOST) {
		float like = gw_smaller(fabsf(gw_dot(normal, b->normal)), 1.0f);
		rise *= gw_smaller(sqrtf(1.0f - like * like) + p->cone, 1.0f);
	}
	return height + rise < HORIZON * distance;
}

/* Draws a piece of the tree, or what is below it. */
static void draw(buffer *b, uint32_t number)
{
	const gw_surface_piece *p = &b->d->tree->piece[number];
	gw_vec3 to = gw_minus((gw_vec3){ p->place[0], p->place[1], p->place[2] }, b->g);
	float distance = sqrtf(gw_dot(to, to));
	if (!(p->area > 0.0f) || is_low(b, p, to, distance))
		return;
	if (p->count == 0 || is_fine(b, p, distance)) {
		window w = window_of(b, to, distance, p->radius);
		draw_piece(b, p, &w);
		return;
	}
	for (uint32_t i = p->first; i < p->first + p->count; i++)
		draw(b, i);
}

/* Turns the texels of a record against those of others. */
static void set_frame(buffer *b, uint32_t record)
{
	float normal[3] = { b->normal.x, b->normal.y, b->normal.z }, t[3], u[3];
	b->seed = pcg_hash2(record, b->d->seed);
	float turn = 2.0f * GW_PI * (float)b->seed * 0x1p-32f, c = cosf(turn), s = sinf(turn);
	gw_tangent_frame(normal, t, u);
	b->tangent = (gw_vec3){ c * t[0] + s * u[0], c * t[1] + s * u[1], c * t[2] + s * u[2] };
	b->bitangent = (gw_vec3){ c * u[0] - s * t[0], c * u[1] - s * t[1], c * u[2] - s * t[2] };
}

/* A texel looks along one of the rays that go through it, drawn by chance; those without any are
 * not looked at. */
static void begin(buffer *b, uint32_t record)
{
	const drawing *d = b->d;
	b->g = gw_xyz(d->place + 4 * (size_t)record);
	b->normal = gw_xyz(d->normal + 4 * (size_t)record);
	b->drawn = 0;
	set_frame(b, record);
	for (uint32_t i = 0; i < d->side * d->side; i++) {
		b->of[i] = 0;
		b->depth[i] = b->back[i] = FAR_AWAY;
		b->piece[i] = GW_NONE;
	}
	for (uint32_t k = 0; k < d->rays; k++) {
		gw_vec3 way = gw_record_ray(b->g, b->normal, k, d->rays, d->seed);
		uint32_t texel = texel_of(b, way), among = ++b->of[texel];
		b->texel[k] = texel;
		if ((float)pcg_hash2(k, b->seed) * 0x1p-32f * (float)among <= 1.0f)
			b->way[texel] = way;
	}
}

/* What a record's rays hit: what their texels show. */
static void look_up(const buffer *b, uint32_t record)
{
	const drawing *d = b->d;
	for (uint32_t k = 0; k < d->rays; k++) {
		size_t at = (size_t)record * d->rays + k;
		uint32_t texel = b->texel[k];
		d->hit[at] = b->piece[texel];
		d->distance[at] = b->back[texel] < b->depth[texel] ? -b->depth[texel] : b->depth[texel];
	}
}

static void draw_some(void *user, size_t first, size_t last, uint32_t worker)
{
	drawing *d = user;
	buffer *b = &d->of_worker[worker];
	for (size_t i = first; i < last; i++) {
		begin(b, (uint32_t)i);
		draw(b, d->tree->count - 1);
		look_up(b, (uint32_t)i);
		atomic_fetch_add(&d->drawn, b->drawn);
	}
}

/* ------------------------------------------------------------------------------ from the device */

static gw_status draw_in_parallel(const gw_record_context *on, drawing *d, gw_error *error)
{
	uint32_t threads = gw_thread_count(on->passes->threads);
	uint32_t *texel = gw_allocate_array((size_t)threads * d->rays, sizeof *texel);
	d->of_worker = gw_allocate_zeros(threads, sizeof *d->of_worker);
	for (uint32_t i = 0; i < threads && texel && d->of_worker; i++) {
		d->of_worker[i].d = d;
		d->of_worker[i].texel = texel + (size_t)i * d->rays;
	}
	gw_status status =
		texel && d->of_worker
			? GW_OK
			: gw_fail(error, GW_ERROR_MEMORY, "no memory for the buffers of %u threads", threads);
	if (status == GW_OK)
		gw_parallel_for(threads, on->records->count, 16, draw_some, d);
	free(d->of_worker);
	free(texel);
	return status;
}

static gw_status draw_all(const gw_record_context *on, drawing *d, gw_error *error)
{
	gw_gpu *gpu = on->passes->gpu;
	uint64_t bytes = 16 * (uint64_t)on->records->count;
	gw_view place = { 0 }, normal = { 0 };
	gw_status status = gw_view_open(gpu, &on->records->position, bytes, &place, error);
	if (status == GW_OK)
		status = gw_view_open(gpu, &on->records->normal, bytes, &normal, error);
	d->place = place.bytes;
	d->normal = normal.bytes;
	if (status == GW_OK)
		status = draw_in_parallel(on, d, error);
	gw_view_close(&normal);
	gw_view_close(&place);
	return status;
}

/* Draws, and keeps what rays hit on the device. */
static gw_status find_hits(const gw_record_context *on, drawing *d, gw_micro_buffers *buffers,
						   gw_error *error)
{
	gw_gpu *gpu = on->passes->gpu;
	uint64_t bytes = 4 * (uint64_t)d->rays * on->records->count;
	GW_TRY(draw_all(on, d, error));
	GW_TRY(gw_buffer_upload(gpu, &buffers->hits.facet, 0, d->hit, bytes, error));
	buffers->drawn = d->drawn;
	return gw_buffer_upload(gpu, &buffers->hits.distance, 0, d->distance, bytes, error);
}

static gw_status draw_buffers(const gw_record_context *on, gw_micro_buffers *buffers,
							  gw_error *error)
{
	uint32_t side = buffers->side;
	size_t hits = (size_t)buffers->hits.rays * on->records->count;
	drawing d = { .tree = &buffers->tree,
				  .side = side,
				  .rays = buffers->hits.rays,
				  .seed = buffers->hits.seed,
				  .dark = on->octree->dark_facet > 0 ? on->octree->dark_facet - 1 : GW_NONE,
				  .texel_angle = 8.0f / (float)(side * side),
				  .hit = gw_allocate_array(hits, sizeof *d.hit),
				  .distance = gw_allocate_array(hits, sizeof *d.distance) };
	gw_status status = d.hit && d.distance ? GW_OK
										   : gw_fail(error, GW_ERROR_MEMORY,
													 "no memory for %zu hits of buffers", hits);
	if (status == GW_OK) {
		status = find_hits(on, &d, buffers, error);
	}
	free(d.distance);
	free(d.hit);
	return status;
}

gw_status gw_micro_buffers_make(const gw_record_context *on, uint32_t rays, uint32_t seed,
								gw_micro_buffers *buffers, gw_error *error)
{
	gw_gpu *gpu = on->passes->gpu;
	*buffers = (gw_micro_buffers){ .side = gw_micro_buffers_side(rays) };
	gw_status status = gw_surface_tree_make(gpu, on->octree, &buffers->tree, error);
	if (status == GW_OK)
		status = gw_buffer_create(
			gpu,
			&(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_R32G32B32A32_SFLOAT,
									  16 * (uint64_t)buffers->tree.count, "radiance of nodes" },
			&buffers->radiance, error);
	if (status == GW_OK)
		status = gw_ray_gather_create(gpu, on->records, rays, seed, &buffers->hits, error);
	if (status == GW_OK)
		status = draw_buffers(on, buffers, error);
	if (status != GW_OK)
		gw_micro_buffers_destroy(gpu, buffers);
	return status;
}

void gw_micro_buffers_destroy(gw_gpu *gpu, gw_micro_buffers *buffers)
{
	gw_surface_tree_clear(&buffers->tree);
	gw_ray_gather_destroy(gpu, &buffers->hits);
	gw_buffer_destroy(gpu, &buffers->radiance);
	*buffers = (gw_micro_buffers){ 0 };
}

/* ---------------------------------------------------------------------------- what is kept apart
 */

/* The compartment that all of a node's surface faces; unknown where it faces several. */
static void label_nodes(const gw_surface_tree *tree, uint32_t *label)
{
	for (uint32_t i = tree->facets; i < tree->count; i++) {
		const gw_surface_piece *node = &tree->piece[i];
		bool any = false, several = false;
		label[i] = GW_COMPARTMENT_UNKNOWN;
		for (uint32_t c = node->first; c < node->first + node->count; c++) {
			if (!(tree->piece[c].area > 0.0f))
				continue;
			several |= any && label[c] != label[i];
			label[i] = label[c];
			any = true;
		}
		if (several)
			label[i] = GW_COMPARTMENT_UNKNOWN;
	}
}

static gw_status shut_out(const gw_record_context *on, const uint32_t *records, uint32_t *pieces,
						  gw_micro_buffers *buffers, gw_error *error)
{
	const gw_surface_tree *tree = &buffers->tree;
	const gw_labelled_rays from = { records, on->records->count, buffers->hits.rays, pieces };
	if (!pieces)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %u compartments", tree->count);
	memcpy(pieces, gw_compartments_of_facets(on->octree), tree->facets * sizeof *pieces);
	label_nodes(tree, pieces);
	return gw_shut_out_hits_of(on, &from, &buffers->hits.facet, error);
}

gw_status gw_micro_buffers_shut_out(const gw_record_context *on, gw_micro_buffers *buffers,
									gw_error *error)
{
	uint32_t *records;
	if (!gw_compartments_several(on->octree) || buffers->hits.shut_out == on->records->count)
		return GW_OK;
	GW_TRY(gw_shut_out_label(on, &records, error));
	uint32_t *pieces = gw_allocate_array(buffers->tree.count, sizeof *pieces);
	gw_status status = shut_out(on, records, pieces, buffers, error);
	free(pieces);
	free(records);
	if (status == GW_OK)
		buffers->hits.shut_out = on->records->count;
	return status;
}

/* --------------------------------------------------------------------------------------- bounces
 */

static gw_status pull(const gw_record_context *on, gw_micro_buffers *buffers,
					  const gw_buffer *facet_radiance, float *radiance, gw_error *error)
{
	gw_gpu *gpu = on->passes->gpu;
	const gw_surface_tree *tree = &buffers->tree;
	GW_TRY(
		gw_buffer_download(gpu, facet_radiance, 0, radiance, 16 * (uint64_t)tree->facets, error));
	gw_surface_tree_pull(tree, on->passes->threads, radiance);
	return gw_buffer_upload(gpu, &buffers->radiance, 0, radiance, 16 * (uint64_t)tree->count,
							error);
}

gw_status gw_micro_buffers_bounce(const gw_record_context *on, gw_micro_buffers *buffers,
								  const gw_buffer *facet_radiance, gw_error *error)
{
	float *radiance = gw_allocate_array(buffers->tree.count, 4 * sizeof *radiance);
	if (!radiance)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the radiance of %u nodes",
					   buffers->tree.count);
	gw_status status = pull(on, buffers, facet_radiance, radiance, error);
	free(radiance);
	return status == GW_OK ? gw_ray_gather_bounce(on->passes, &buffers->hits, &buffers->radiance,
												  on->records, error)
						   : status;
}

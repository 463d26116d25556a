/*
 * shadow_map.c - see shadow_map.h. For each view of a light and each window of its map: clear, draw
 * the facets, look up the surfels that lie in it.
 */
#include "light/shadow_map.h"

#include "light/shadow_layout.h"

#include <float.h>
#include <math.h>

/* Cosine of 80 degrees: wider spots are drawn as cubes, because a flat map of a wide cone spends
 * most of its texels on the rim. */
#define SPOT_COSINE 0.17364817766693033f

/* A lamp this many times the cloud's radius from its middle sees it in one map, of which the cloud
 * fills as much as of a face of a cube: 45 degrees from the axis. */
#define OUTSIDE 1.4142136f

/* Leaf cells: distances up to this have squares that a float holds. */
#define RANGE_MAX 1e18f

/* The bits of 1.0f: the depth of a texel that sees nothing. */
#define FAR_DEPTH 0x3f800000u

/* Leaf cells around the cloud that its planes may reach into. */
#define MARGIN 1.0f

typedef struct shadow_map {
	gw_passes *passes;
	const gw_octree *octree;
	uint64_t surfels;
	uint32_t size;         /* texels a side of the whole map */
	uint32_t window;       /* of a window, without borders */
	float low[3], high[3]; /* bounds of the cloud, grid coordinates */
	gw_buffer depth;       /* R32_SFLOAT, a window with borders: distance / range */
	gw_buffer most;        /* one word: tiles of the largest picture of a facet */
	gw_buffer *visibility;
} shadow_map;

static void corner_of(const shadow_map *map, unsigned index, float corner[3])
{
	for (unsigned axis = 0; axis < 3; axis++)
		corner[axis] = (index >> axis & 1u) ? map->high[axis] : map->low[axis];
}

static float dot3(vec4 a, const float b[3])
{
	return a.x * b[0] + a.y * b[1] + a.z * b[2];
}

/* -------------------------------------------------------------------------------- windows */

/* Draws all facets into the window; further runs draw what is left of large pictures. */
static gw_status draw_facets(shadow_map *map, gw_shadow_push *push, gw_error *error)
{
	const gw_binding bindings[] = { gw_whole(&map->octree->leaf_cell),
									gw_whole(&map->octree->facet_plane), gw_whole(&map->depth),
									gw_whole(&map->most), GW_LEAF_BINDING(map->octree) };
	gw_gpu *gpu = map->passes->gpu;
	uint32_t rounds = 1;
	GW_TRY(gw_buffer_fill(gpu, &map->most, 0, error));
	for (push->round = 0; push->round < rounds; push->round++) {
		GW_TRY(gw_passes_run(map->passes, GW_PASS_SHADOW_MAP_SPLAT, bindings, push,
							 map->octree->facet_count, error));
		uint32_t most = 0;
		if (push->round == 0)
			GW_TRY(gw_buffer_download(gpu, &map->most, 0, &most, sizeof most, error));
		rounds = most > rounds ? most : rounds;
	}
	return GW_OK;
}

static gw_status run_window(shadow_map *map, gw_shadow_push *push, gw_error *error)
{
	GW_TRY(gw_buffer_fill(map->passes->gpu, &map->depth, FAR_DEPTH, error));
	GW_TRY(draw_facets(map, push, error));
	const gw_binding bindings[] = { gw_whole(&map->depth),
									gw_window(&map->octree->surfel_position, 16),
									gw_window(&map->octree->surfel_normal, 16),
									gw_window(map->visibility, 4) };
	return gw_passes_run(map->passes, GW_PASS_SHADOW_MAP_VISIBILITY, bindings, push, map->surfels,
						 error);
}

/* Runs all windows of one view; extent is half its width, a tangent or leaf cells. */
static gw_status run_view(shadow_map *map, gw_shadow_push push, float extent, gw_error *error)
{
	/* A lamp as far away as this sends nothing that a float could hold. */
	if (!(push.up.w < RANGE_MAX))
		return GW_OK;
	float half = 0.5f * (float)map->size;
	push.right.w = half / extent;
	push.forward.w = (float)map->size;
	push.side = map->window + 2 * GW_SHADOW_BORDER;
	for (uint32_t y = 0; y < map->size; y += map->window) {
		for (uint32_t x = 0; x < map->size; x += map->window) {
			push.first_x = (float)x;
			push.first_y = (float)y;
			push.centre_x = half - push.first_x + (float)GW_SHADOW_BORDER;
			push.centre_y = half - push.first_y + (float)GW_SHADOW_BORDER;
			GW_TRY(run_window(map, &push, error));
		}
	}
	return GW_OK;
}

/* ---------------------------------------------------------------------------------- views */

static vec4 axis_vector(int axis, float sign)
{
	float v[3] = { 0 };
	v[axis] = sign;
	return (vec4){ v[0], v[1], v[2], 0.0f };
}

static void frame_along(gw_shadow_push *push, vec4 direction)
{
	const float forward[3] = { direction.x, direction.y, direction.z };
	float right[3], up[3];
	gw_tangent_frame(forward, right, up);
	push->right = (vec4){ right[0], right[1], right[2], 0.0f };
	push->up = (vec4){ up[0], up[1], up[2], push->up.w };
	push->forward = (vec4){ forward[0], forward[1], forward[2], 0.0f };
}

static float furthest_corner(const shadow_map *map, vec4 from)
{
	float furthest = 0.0f;
	for (unsigned k = 0; k < 8; k++) {
		float c[3];
		corner_of(map, k, c);
		furthest = fmaxf(furthest, hypotf(hypotf(c[0] - from.x, c[1] - from.y), c[2] - from.z));
	}
	return furthest;
}

/* Tangent of the angle from a spot's axis that its map has to reach; infinite when too wide. */
static float spot_tangent(const gw_light_push *light)
{
	float c = light->cos_outer;
	if (light->type != GW_PUSH_SPOT || c <= SPOT_COSINE)
		return INFINITY;
	/* The narrowest cones keep a view that is not of width zero. */
	return fmaxf(sqrtf(fmaxf(0.0f, 1.0f - c * c)) / c, 1e-3f);
}

/* The same of one map from a lamp outside of the cloud that holds all of it, and the direction to
 * the cloud's middle; infinite when the lamp is too near for that. */
static float outside_tangent(const shadow_map *map, vec4 lamp, vec4 *direction)
{
	vec4 to = { 0.5f * (map->low[0] + map->high[0]) - lamp.x,
				0.5f * (map->low[1] + map->high[1]) - lamp.y,
				0.5f * (map->low[2] + map->high[2]) - lamp.z, 0.0f };
	float distance = hypotf(hypotf(to.x, to.y), to.z);
	float radius = 0.5f * hypotf(hypotf(map->high[0] - map->low[0], map->high[1] - map->low[1]),
								 map->high[2] - map->low[2]);
	if (distance < OUTSIDE * radius)
		return INFINITY;
	*direction = (vec4){ to.x / distance, to.y / distance, to.z / distance, 0.0f };
	float share = radius / distance;
	return share / sqrtf(1.0f - share * share);
}

static gw_status run_lamp(shadow_map *map, const gw_light_push *light, gw_error *error)
{
	gw_shadow_push push = { .origin = light->position };
	push.origin.w = 0.0f;
	push.up.w = furthest_corner(map, light->position);
	vec4 middle = { 0 };
	float spot = spot_tangent(light), outside = outside_tangent(map, light->position, &middle);
	if (isfinite(fminf(spot, outside))) {
		frame_along(&push, spot <= outside ? light->direction : middle);
		return run_view(map, push, fminf(spot, outside), error);
	}
	float range = push.up.w;
	for (int face = 0; face < 6; face++) {
		int axis = face / 2;
		push.forward = axis_vector(axis, face % 2 ? -1.0f : 1.0f);
		push.right = axis_vector((axis + 1) % 3, 1.0f);
		push.up = axis_vector((axis + 2) % 3, 1.0f);
		push.up.w = range;
		GW_TRY(run_view(map, push, 1.0f, error));
	}
	return GW_OK;
}

static gw_status run_sun(shadow_map *map, const gw_light_push *light, gw_error *error)
{
	gw_shadow_push push = { 0 };
	frame_along(&push, light->direction);
	const vec4 axes[3] = { push.right, push.up, push.forward };
	float low[3] = { FLT_MAX, FLT_MAX, FLT_MAX }, high[3] = { -FLT_MAX, -FLT_MAX, -FLT_MAX };
	for (unsigned k = 0; k < 8; k++) {
		float corner[3];
		corner_of(map, k, corner);
		for (int a = 0; a < 3; a++) {
			low[a] = fminf(low[a], dot3(axes[a], corner));
			high[a] = fmaxf(high[a], dot3(axes[a], corner));
		}
	}
	/* The plane that the map looks from touches the cloud where the light comes first. */
	float at[3] = { 0.5f * (low[0] + high[0]), 0.5f * (low[1] + high[1]), low[2] };
	push.origin = (vec4){ 0.0f, 0.0f, 0.0f, 1.0f };
	for (int a = 0; a < 3; a++) {
		push.origin.x += axes[a].x * at[a];
		push.origin.y += axes[a].y * at[a];
		push.origin.z += axes[a].z * at[a];
	}
	push.up.w = high[2] - low[2];
	return run_view(map, push, 0.5f * fmaxf(high[0] - low[0], high[1] - low[1]), error);
}

/* -------------------------------------------------------------------------------- visibility */

static gw_status create(shadow_map *map, gw_error *error)
{
	gw_gpu *gpu = map->passes->gpu;
	uint64_t side = (uint64_t)map->window + 2 * GW_SHADOW_BORDER;
	GW_TRY(gw_buffer_create(gpu,
							&(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_R32_SFLOAT,
													  4 * side * side, "shadow map" },
							&map->depth, error));
	GW_TRY(gw_buffer_create(
		gpu,
		&(gw_buffer_description){ GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED, 4, "shadow map tiles" },
		&map->most, error));
	return gw_buffer_fill(gpu, map->visibility, 0, error);
}

gw_status gw_shadow_map_visibility(const gw_lit_cloud *cloud, const gw_light_push *light,
								   gw_buffer *visibility, gw_error *error)
{
	const gw_octree *octree = cloud->octree;
	const gw_surfels *surfels = cloud->surfels;
	uint32_t size = cloud->options->shadow_map_size;
	shadow_map map = { .passes = cloud->passes,
					   .octree = octree,
					   .surfels = surfels->count,
					   .size = size,
					   .window = size < GW_SHADOW_WINDOW ? size : GW_SHADOW_WINDOW,
					   .visibility = visibility };
	for (int axis = 0; axis < 3; axis++) {
		float minimum = octree->cube_minimum[axis], cell = octree->leaf_size;
		map.low[axis] = (surfels->minimum[axis] - minimum) / cell - MARGIN;
		map.high[axis] = (surfels->maximum[axis] - minimum) / cell + MARGIN;
	}
	gw_status status = create(&map, error);
	if (status == GW_OK)
		status =
			light->type == GW_PUSH_SUN ? run_sun(&map, light, error) : run_lamp(&map, light, error);
	gw_buffer_destroy(cloud->passes->gpu, &map.depth);
	gw_buffer_destroy(cloud->passes->gpu, &map.most);
	return status;
}

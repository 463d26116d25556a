/*
 * direct_light.c - see direct_light.h. For each light: which share of it each surfel sees, then its
 * irradiance, then the mean over the facets.
 */
#include "light/direct_light.h"
#include "glowworm_host.h"

#include "base/distribution.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "cloud/frame.h"
#include "normals/normal_error.h"
#include "light/large_discs.h"
#include "light/lamp_reach.h"
#include "light/light_given.h"
#include "light/shut_out.h"
#include "light/transport_layout.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define DEGREES (M_PI / 180.0)

/* Shadow rays to a light that has an extent. */
#define PENUMBRA_RAYS 16u

#define UPLOAD_SURFELS 65536u /* at a time */
#define NORMALS_CHUNK 2048    /* of these that a thread takes at a time */
#define CLOSED_SURFELS 1024u  /* the same where ways are closed */

static gw_status bad_light(size_t index, const gw_light *light, const char *what, double value,
						   const char *remedy, gw_error *error)
{
	return gw_fail(error, GW_ERROR_USAGE, "light %zu (%s%s%s): %s is %s; %s", index + 1,
				   gw_light_type_name(light->type), light->name[0] ? " " : "", light->name, what,
				   GW_SAID(value, 15), remedy);
}

static gw_status check_color(size_t index, const gw_light *light, const char *what,
							 const float color[3], gw_error *error)
{
	for (int c = 0; c < 3; c++) {
		if (!isfinite(color[c]) || color[c] < 0.0f)
			return bad_light(index, light, what, (double)color[c],
							 "give three finite numbers of at least 0", error);
	}
	return GW_OK;
}

static gw_status check_direction(size_t index, const gw_light *light, gw_error *error)
{
	const double *d = light->direction;
	double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
	if (!isfinite(length) || length <= 0.0)
		return bad_light(index, light, "length of the direction", length,
						 "give a direction of finite length above 0", error);
	return GW_OK;
}

static gw_status check_lamp(size_t index, const gw_light *light, gw_error *error)
{
	for (int axis = 0; axis < 3; axis++) {
		if (!isfinite(light->position[axis]))
			return bad_light(index, light, "a coordinate", light->position[axis],
							 "give a finite position", error);
	}
	if (!isfinite(light->radius) || light->radius < 0.0f)
		return bad_light(index, light, "radius", (double)light->radius, "give metres of at least 0",
						 error);
	if (light->type == GW_LIGHT_SPOT) {
		if (!(light->outer_angle > 0.0f && light->outer_angle <= 180.0f))
			return bad_light(index, light, "outer angle", (double)light->outer_angle,
							 "give degrees from the axis above 0 and up to 180", error);
		if (!(light->inner_angle >= 0.0f && light->inner_angle <= light->outer_angle))
			return bad_light(index, light, "inner angle", (double)light->inner_angle,
							 "give degrees from 0 to the outer angle", error);
		GW_TRY(check_direction(index, light, error));
	}
	if (gw_distribution_counts(light) && gw_distribution_fault(light))
		return gw_fail(error, GW_ERROR_USAGE, "light %zu (%s%s%s): %s", index + 1,
					   gw_light_type_name(light->type), light->name[0] ? " " : "", light->name,
					   gw_distribution_fault(light));
	return check_color(index, light, "intensity", light->intensity, error);
}

/* Lights that are areas have one. */
static gw_status check_area(size_t index, const gw_light *light, gw_error *error)
{
	GW_TRY(check_lamp(index, light, error));
	if (light->type == GW_LIGHT_RECTANGLE) {
		for (int k = 0; k < 2; k++)
			if (!(light->size[k] > 0.0f && isfinite(light->size[k])))
				return bad_light(index, light, "a side", (double)light->size[k],
								 "give metres above 0", error);
		if (!gw_distribution_has_frame(light))
			return gw_fail(error, GW_ERROR_USAGE,
						   "light %zu (rectangle%s%s) needs a direction, and one across it",
						   index + 1, light->name[0] ? " " : "", light->name);
		return GW_OK;
	}
	if (!(light->radius > 0.0f))
		return bad_light(index, light, "radius", (double)light->radius, "give metres above 0",
						 error);
	return light->type == GW_LIGHT_DISC ? check_direction(index, light, error) : GW_OK;
}

static gw_status check_environment(size_t index, const gw_light *light, size_t *maps,
								   gw_error *error)
{
	if (light->map && (light->map_width == 0 || light->map_height == 0))
		return bad_light(index, light, "a side of the map", 0.0, "give a map with pixels", error);
	if (light->map && !isfinite(light->rotation))
		return bad_light(index, light, "rotation", (double)light->rotation, "give degrees", error);
	if (light->map && ++*maps > 1)
		return gw_fail(
			error, GW_ERROR_USAGE,
			"light %zu is the second with a map; a bake takes one, so bake twice and add",
			index + 1);
	return check_color(index, light, "radiance", light->radiance, error);
}

gw_status gw_lights_check(const gw_light *lights, size_t count, gw_error *error)
{
	size_t maps = 0;
	for (size_t i = 0; i < count; i++) {
		const gw_light *light = &lights[i];
		switch (light->type) {
		case GW_LIGHT_POINT:
		case GW_LIGHT_SPOT:
			GW_TRY(check_lamp(i, light, error));
			break;
		case GW_LIGHT_SPHERE:
		case GW_LIGHT_DISC:
		case GW_LIGHT_RECTANGLE:
			GW_TRY(check_area(i, light, error));
			break;
		case GW_LIGHT_SUN:
			if (!(light->angle >= 0.0f && light->angle < 90.0f))
				return bad_light(i, light, "angle", (double)light->angle,
								 "give degrees from 0 to below 90", error);
			GW_TRY(check_direction(i, light, error));
			GW_TRY(check_color(i, light, "irradiance", light->irradiance, error));
			break;
		case GW_LIGHT_ENVIRONMENT:
			GW_TRY(check_environment(i, light, &maps, error));
			break;
		default:
			return gw_fail(error, GW_ERROR_USAGE, "light %zu has the unknown type %d", i + 1,
						   (int)light->type);
		}
	}
	return GW_OK;
}

static void put_distribution(const gw_light *light, gw_light_push *push)
{
	gw_vec3 axis, across;
	gw_distribution_frame(light, &axis, &across);
	push->direction = (vec4){ axis.x, axis.y, axis.z, 0.0f };
	push->across = (vec4){ across.x, across.y, across.z, 0.0f };
	push->verticals = light->vertical_count;
	push->horizontals = light->horizontal_count;
}

static uint32_t push_type(gw_light_type type)
{
	static const uint32_t of[GW_LIGHT_TYPE_COUNT] = { [GW_LIGHT_SPOT] = GW_PUSH_SPOT,
													  [GW_LIGHT_SUN] = GW_PUSH_SUN,
													  [GW_LIGHT_SPHERE] = GW_PUSH_SPHERE,
													  [GW_LIGHT_DISC] = GW_PUSH_DISC,
													  [GW_LIGHT_RECTANGLE] = GW_PUSH_RECTANGLE };
	return of[type];
}

/* Sides of a rectangle, and where it is across; of a disc any direction is. */
static void put_area(const gw_light *light, double cell, gw_light_push *push)
{
	const float direction[3] = { push->direction.x, push->direction.y, push->direction.z };
	float across[3], other[3];
	gw_vec3 axis, along;
	push->samples = PENUMBRA_RAYS;
	if (light->type == GW_LIGHT_RECTANGLE) {
		gw_distribution_frame(light, &axis, &along);
		push->across =
			(vec4){ along.x, along.y, along.z, (float)(0.5 * (double)light->size[0] / cell) };
		push->half_height = (float)(0.5 * (double)light->size[1] / cell);
	} else if (light->type == GW_LIGHT_DISC && push->verticals == 0) {
		gw_tangent_frame(direction, across, other);
		push->across = (vec4){ across[0], across[1], across[2], 0.0f };
	}
}

/* A light as passes get it. Subtracting the frame's origin in double keeps large coordinates exact.
 */
static gw_light_push push_of(const gw_light *light, const gw_octree *octree,
							 const gw_surfels *surfels, const gw_bake_options *options)
{
	gw_light_push push = { .type = push_type(light->type),
						   .samples = 1,
						   .cos_inner = (float)cos((double)light->inner_angle * DEGREES),
						   .cos_outer = (float)cos((double)light->outer_angle * DEGREES),
						   .seed = (uint32_t)options->seed,
						   .shadows = options->shadows != GW_SHADOWS_NONE };
	double cell = (double)octree->leaf_size;
	double g[3];
	for (int axis = 0; axis < 3; axis++)
		g[axis] =
			((light->position[axis] - surfels->origin[axis]) - (double)octree->cube_minimum[axis]) /
			cell;
	push.position =
		(vec4){ (float)g[0], (float)g[1], (float)g[2], (float)((double)light->radius / cell) };
	const double *d = light->direction;
	double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
	double scale = length > 0.0 ? 1.0 / length : 0.0;
	push.direction = (vec4){ (float)(d[0] * scale), (float)(d[1] * scale), (float)(d[2] * scale),
							 (float)tan((double)light->angle * 0.5 * DEGREES) };
	bool sun = light->type == GW_LIGHT_SUN;
	const float *power = sun ? light->irradiance : light->intensity;
	double unit = sun ? 1.0 : 1.0 / (cell * cell);
	push.intensity = (vec4){ (float)((double)power[0] * unit), (float)((double)power[1] * unit),
							 (float)((double)power[2] * unit), 0.0f };
	if ((sun && light->angle > 0.0f) || (!sun && light->radius > 0.0f))
		push.samples = PENUMBRA_RAYS;
	if (gw_distribution_counts(light))
		put_distribution(light, &push);
	if (push.type >= GW_PUSH_SPHERE)
		put_area(light, cell, &push);
	return push;
}

gw_lamp gw_lamp_of(const gw_light *light, const gw_octree *octree, const gw_surfels *surfels,
				   const gw_bake_options *options)
{
	return (gw_lamp){ push_of(light, octree, surfels, options), light->distribution };
}

/* Some of the points' own normals, on their way to the device. */
typedef struct own_normals {
	const gw_lit_cloud *cloud;
	bool off;     /* as far off as they may be */
	size_t first; /* surfel of */
	float *four;  /* 4 a surfel: and whether it is lit from both sides */
} own_normals;

static void take_normals(void *user, size_t first, size_t last, uint32_t worker)
{
	const own_normals *n = user;
	const gw_surfels *surfels = n->cloud->surfels;
	const float *own = surfels->shading_normal ? surfels->shading_normal : surfels->normal;
	(void)worker;
	for (size_t i = first; i < last; i++) {
		size_t s = n->first + i;
		float *to = n->four + 4 * i;
		uint8_t sides = surfels->two_sided[s];
		memcpy(to, own + 3 * s, 3 * sizeof *to);
		if (n->cloud->lit && !n->cloud->lit[s]) /* nothing reaches a surfel without a normal */
			memset(to, 0, 3 * sizeof *to);
		else if (n->off)
			gw_normal_turn(surfels, s, to);
		to[3] = sides == 1 || sides == GW_SIDE_FOLIAGE ? 1.0f : 0.0f;
	}
}

/* The points' own normals, like octree->surfel_normal, which has those of the smoothed surface; as
 * they are, or as far off as they may be; none for those that stay dark. */
static gw_status upload_normals(const gw_lit_cloud *cloud, bool off, gw_buffer *normal,
								gw_error *error)
{
	gw_gpu *gpu = cloud->passes->gpu;
	size_t all = cloud->surfels->count, most = all < UPLOAD_SURFELS ? all : UPLOAD_SURFELS;
	own_normals n = { cloud, off, 0, gw_allocate_array(most, 4 * sizeof *n.four) };
	if (!n.four)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the normals of %zu surfels", all);
	const gw_buffer_description description = { GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED,
												16 * (uint64_t)all, "shading normals" };
	gw_status status = gw_buffer_create(gpu, &description, normal, error);
	for (; n.first < all && status == GW_OK; n.first += UPLOAD_SURFELS) {
		size_t count = all - n.first < UPLOAD_SURFELS ? all - n.first : UPLOAD_SURFELS;
		gw_parallel_for(cloud->options->threads, count, NORMALS_CHUNK, take_normals, &n);
		status = gw_buffer_upload(gpu, normal, 16 * (uint64_t)n.first, n.four, 16 * (uint64_t)count,
								  error);
	}
	free(n.four);
	return status;
}

/* A light as passes get it. */
typedef struct light_on_device {
	gw_light_push push;
	const float *intensities; /* gw_light.distribution */
	gw_buffer distribution;   /* of its intensity; one number where it has none */
} light_on_device;

static gw_status put_on_device(const gw_lit_cloud *cloud, const gw_light *light,
							   light_on_device *lamp, gw_error *error)
{
	gw_gpu *gpu = cloud->passes->gpu;
	const float none = 0.0f;
	lamp->push = push_of(light, cloud->octree, cloud->surfels, cloud->options);
	lamp->intensities = light->distribution;
	bool has = lamp->push.verticals > 0;
	uint64_t bytes = sizeof none * (has ? gw_distribution_length(light) : 1);
	GW_TRY(gw_buffer_create(gpu,
							&(gw_buffer_description){ GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED, bytes,
													  "distribution of a luminaire" },
							&lamp->distribution, error));
	gw_status status = gw_buffer_upload(gpu, &lamp->distribution, 0,
										has ? light->distribution : &none, bytes, error);
	if (status != GW_OK)
		gw_buffer_destroy(gpu, &lamp->distribution);
	return status;
}

static gw_status trace_visibility(const gw_lit_cloud *cloud, const light_on_device *lamp,
								  const gw_buffer *normal, gw_buffer *visibility, gw_error *error)
{
	const gw_binding bindings[] = { GW_TRACE_BINDINGS(cloud->octree),
									gw_window(&cloud->octree->surfel_position, 16),
									gw_window(normal, 16),
									gw_window(visibility, 4),
									GW_DISC_BINDINGS(cloud->octree),
									GW_TREE_BINDING(cloud->octree),
									gw_whole(&lamp->distribution),
									GW_OPACITY_BINDING(cloud->octree),
									GW_LEAF_BINDING(cloud->octree) };
	return gw_passes_run(cloud->passes, GW_PASS_LIGHT_VISIBILITY, bindings, &lamp->push,
						 cloud->surfels->count, error);
}

static gw_status find_visibility(const gw_lit_cloud *cloud, const light_on_device *lamp,
								 const gw_buffer *normal, gw_buffer *visibility, gw_error *error)
{
	/* Maps show planes in cells, and of large discs no more than that. */
	bool maps = cloud->options->shadows == GW_SHADOWS_MAPS && cloud->octree->tree_discs == 0 &&
				gw_surfels_count_clear(cloud->surfels) == 0;
	if (maps)
		return gw_shadow_map_visibility(cloud, &lamp->push, visibility, error);
	if (cloud->options->shadows != GW_SHADOWS_NONE)
		return trace_visibility(cloud, lamp, normal, visibility, error);
	return GW_OK;
}

gw_way gw_light_way(const gw_light_push *light, const gw_octree *octree, const gw_surfels *surfels,
					size_t surfel)
{
	gw_way way = { .from = gw_xyz(surfels->position + 3 * surfel), .length = INFINITY };
	if (light->type == GW_PUSH_SUN) {
		way.direction = gw_times(gw_xyz(&light->direction.x), -1.0f);
		return way;
	}
	gw_vec3 to = gw_plus(gw_xyz(octree->cube_minimum),
						 gw_times(gw_xyz(&light->position.x), octree->leaf_size));
	gw_vec3 along = gw_minus(to, way.from);
	way.length = sqrtf(gw_dot(along, along));
	way.direction = gw_times(along, way.length > 0.0f ? 1.0f / way.length : 0.0f);
	return way;
}

typedef struct closing {
	const gw_lit_cloud *cloud;
	const gw_light_push *push;
	float *visibility;
} closing;

static void close_ways(void *user, size_t first, size_t last, uint32_t worker)
{
	const closing *c = user;
	(void)worker;
	for (size_t i = first; i < last; i++) {
		if (!(c->visibility[i] > 0.0f))
			continue;
		gw_way way = gw_light_way(c->push, c->cloud->octree, c->cloud->surfels, i);
		if (gw_scanned_space_is_gap(c->cloud->closed, &way))
			c->visibility[i] = 0.0f;
	}
}

/* What comes through gaps is hidden. */
static gw_status close_gaps(const gw_lit_cloud *cloud, const gw_light_push *push,
							gw_buffer *visibility, gw_error *error)
{
	gw_gpu *gpu = cloud->passes->gpu;
	size_t count = cloud->surfels->count;
	if (!cloud->closed || cloud->options->shadows == GW_SHADOWS_NONE)
		return GW_OK;
	closing c = { cloud, push, gw_allocate_array(count, sizeof *c.visibility) };
	if (!c.visibility)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the lamps of %zu surfels", count);
	gw_status status =
		gw_buffer_download(gpu, visibility, 0, c.visibility, count * sizeof *c.visibility, error);
	if (status == GW_OK) {
		gw_parallel_for(cloud->options->threads, count, CLOSED_SURFELS, close_ways, &c);
		status =
			gw_buffer_upload(gpu, visibility, 0, c.visibility, count * sizeof *c.visibility, error);
	}
	free(c.visibility);
	return status;
}

static gw_status add_irradiance(const gw_lit_cloud *cloud, const light_on_device *lamp,
								const gw_buffer *normal, const gw_buffer *visibility,
								gw_buffer *irradiance, gw_error *error)
{
	const gw_binding bindings[] = { gw_window(&cloud->octree->surfel_position, 16),
									gw_window(normal, 16), gw_window(visibility, 4),
									gw_window(irradiance, 16), gw_whole(&lamp->distribution) };
	return gw_passes_run(cloud->passes, GW_PASS_LIGHT_IRRADIANCE, bindings, &lamp->push,
						 cloud->surfels->count, error);
}

gw_status gw_average_facets(gw_passes *passes, const gw_octree *octree, const gw_buffer *surfels,
							gw_buffer *facets, gw_error *error)
{
	const gw_binding bindings[] = { gw_whole(&octree->leaf_fragment),
									gw_whole(&octree->fragment_surfel),
									gw_whole(&octree->fragment_weight),
									gw_whole(surfels),
									gw_window(facets, 16),
									GW_LEAF_BINDING(octree) };
	return gw_passes_run(passes, GW_PASS_FACET_DIRECT, bindings, &(gw_record_push){ 0 },
						 octree->facet_count, error);
}

/* Normals at which light comes in; turned is NULL, or those that are off. */
typedef struct light_normals {
	const gw_buffer *own, *turned;
} light_normals;

/* Buffers of gw_direct_light. */
typedef struct lit_buffers {
	gw_buffer visibility, own_normal, off_normal;
	double given; /* by the lamps so far */
	gw_large_discs discs;
	bool discs_known; /* the first lamp that reaches anything asks for them */
} lit_buffers;

/* What one light adds. */
static gw_status add_light(const gw_lit_cloud *cloud, const light_on_device *lamp,
						   light_normals normals, lit_buffers *b, const gw_direct_irradiance *to,
						   gw_error *error)
{
	gw_gpu *gpu = cloud->passes->gpu;
	const gw_light_push *push = &lamp->push;
	gw_buffer *visibility = &b->visibility, reached = { 0 }, reached_turned = { 0 };
	gw_status status = GW_OK;
	if (push->shadows)
		status = gw_shut_out_light(cloud, push, normals.own, &reached, error);
	if (status == GW_OK && push->shadows && normals.turned)
		status = gw_shut_out_light(cloud, push, normals.turned, &reached_turned, error);
	if (reached.handle != VK_NULL_HANDLE)
		normals.own = &reached;
	if (reached_turned.handle != VK_NULL_HANDLE)
		normals.turned = &reached_turned;
	if (status == GW_OK)
		status = find_visibility(cloud, lamp, normals.own, visibility, error);
	if (status == GW_OK)
		status = close_gaps(cloud, push, visibility, error);
	if (status == GW_OK)
		status = add_irradiance(cloud, lamp, normals.own, visibility, to->surfels, error);
	if (status == GW_OK && normals.turned)
		status = add_irradiance(cloud, lamp, normals.turned, visibility, to->turned, error);
	if (status == GW_OK)
		status = gw_large_discs_light(cloud, &(gw_lamp){ lamp->push, lamp->intensities },
									  normals.own, visibility, &b->discs, error);
	gw_buffer_destroy(gpu, &reached_turned);
	gw_buffer_destroy(gpu, &reached);
	return status;
}

static gw_status add_lights(const gw_lit_cloud *cloud, const gw_light *lights, size_t light_count,
							const gw_direct_irradiance *to, lit_buffers *b, gw_error *error)
{
	gw_gpu *gpu = cloud->passes->gpu;
	uint64_t bytes = 4 * (uint64_t)cloud->surfels->count;
	GW_TRY(gw_buffer_create(
		gpu,
		&(gw_buffer_description){ GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED, bytes, "visibility" },
		&b->visibility, error));
	bool own = cloud->surfels->shading_normal || cloud->lit;
	if (own)
		GW_TRY(upload_normals(cloud, false, &b->own_normal, error));
	if (to->turned)
		GW_TRY(upload_normals(cloud, true, &b->off_normal, error));
	const light_normals normals = { own ? &b->own_normal : &cloud->octree->surfel_normal,
									to->turned ? &b->off_normal : NULL };
	bool forced = cloud->options->effects_forced & 1u << GW_EFFECT_LAMPS;
	for (size_t i = 0; i < light_count; i++) {
		light_on_device lamp = { .push = { 0 } };
		if (lights[i].type == GW_LIGHT_ENVIRONMENT)
			continue;
		bool reaches = gw_lamp_reaches(&lights[i], cloud->surfels, cloud->options->threads);
		if (!reaches && !forced)
			continue;
		if (!b->discs_known)
			GW_TRY(gw_large_discs_find(cloud, &b->discs, error));
		b->discs_known = true;
		GW_TRY(put_on_device(cloud, &lights[i], &lamp, error));
		gw_status status = add_light(cloud, &lamp, normals, b, to, error);
		gw_buffer_destroy(gpu, &lamp.distribution);
		const gw_lamp shone = { lamp.push, lights[i].distribution };
		if (status == GW_OK && reaches && to->given)
			status = gw_given_book(cloud, &shone, to->surfels, &to->given[i], &b->given, error);
		GW_TRY(status);
	}
	return GW_OK;
}

/* The means over the facets. */
static gw_status light_facets(const gw_lit_cloud *cloud, const gw_direct_irradiance *to,
							  const gw_large_discs *discs, gw_error *error)
{
	gw_buffer means = { 0 };
	if (cloud->octree->leaf_count == 0)
		return GW_OK;
	if (discs->count > 0)
		GW_TRY(gw_large_discs_mean(cloud, discs, to->surfels, &means, error));
	gw_status status = gw_average_facets(
		cloud->passes, cloud->octree, discs->count > 0 ? &means : to->surfels, to->facets, error);
	gw_buffer_destroy(cloud->passes->gpu, &means);
	return status;
}

gw_status gw_direct_light(const gw_lit_cloud *cloud, const gw_light *lights, size_t light_count,
						  const gw_direct_irradiance *to, gw_error *error)
{
	lit_buffers b = { 0 };
	gw_status status = add_lights(cloud, lights, light_count, to, &b, error);
	if (status == GW_OK)
		status = light_facets(cloud, to, &b.discs, error);
	gw_large_discs_clear(&b.discs);
	gw_buffer_destroy(cloud->passes->gpu, &b.off_normal);
	gw_buffer_destroy(cloud->passes->gpu, &b.own_normal);
	gw_buffer_destroy(cloud->passes->gpu, &b.visibility);
	return status;
}

static gw_status find_share(const gw_lit_cloud *cloud, const light_on_device *lamp,
							gw_buffer *visibility, float *share, gw_error *error)
{
	gw_gpu *gpu = cloud->passes->gpu;
	uint64_t bytes = 4 * (uint64_t)cloud->surfels->count;
	const float one = 1.0f;
	uint32_t seen;
	memcpy(&seen, &one, sizeof seen);
	GW_TRY(gw_buffer_create(
		gpu,
		&(gw_buffer_description){ GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED, bytes, "visibility" },
		visibility, error));
	GW_TRY(gw_buffer_fill(gpu, visibility, seen, error));
	gw_buffer reached = { 0 };
	const gw_buffer *normal = &cloud->octree->surfel_normal;
	GW_TRY(gw_shut_out_light(cloud, &lamp->push, normal, &reached, error));
	gw_status status = find_visibility(
		cloud, lamp, reached.handle != VK_NULL_HANDLE ? &reached : normal, visibility, error);
	gw_buffer_destroy(gpu, &reached);
	return status == GW_OK ? gw_buffer_download(gpu, visibility, 0, share, bytes, error) : status;
}

gw_status gw_light_share(const gw_lit_cloud *cloud, const gw_light *light, float *share,
						 gw_error *error)
{
	gw_buffer visibility = { 0 };
	light_on_device lamp = { .push = { 0 } };
	GW_TRY(put_on_device(cloud, light, &lamp, error));
	gw_status status = find_share(cloud, &lamp, &visibility, share, error);
	gw_buffer_destroy(cloud->passes->gpu, &visibility);
	gw_buffer_destroy(cloud->passes->gpu, &lamp.distribution);
	GW_TRY(status);
	for (size_t i = 0; i < cloud->surfels->count; i++)
		share[i] = GW_SHARE_SEEN(share[i]);
	return GW_OK;
}

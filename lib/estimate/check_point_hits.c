/*
 * check_point_hits.c - see check_point_hits.h.
 */
#include "estimate/check_point_hits.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/* Of the rays of one gather, where the points' is `seed`. */
static uint32_t seed_of(uint32_t seed, uint32_t gather)
{
	return seed ^ (gather ? 0xb5297a4du : 0x68e31da4u);
}

static bool have_emitters(const gw_check_point_task *task)
{
	return task->emitters && task->emitters->count > 0;
}

void gw_check_point_hits_forget_emitted(gw_check_point_hits *hits)
{
	free(hits->emitted);
	hits->emitted = NULL;
}

void gw_check_point_hits_clear(gw_check_point_hits *hits)
{
	gw_check_point_hits_forget_emitted(hits);
	free(hits->point);
	free(hits->facet);
	free(hits->distance);
	*hits = (gw_check_point_hits){ 0 };
}

void gw_check_point_hits_forget(gw_check_point_hits *hits)
{
	uint64_t traced = hits->traced;
	gw_check_point_hits_clear(hits);
	hits->traced = traced;
}

gw_status gw_check_point_hits_place(const gw_check_point_task *task, const uint32_t *point,
									uint32_t count, gw_records *place, gw_error *error)
{
	const gw_octree *octree = task->octree;
	const gw_surfels *s = task->surfels;
	float *rows = gw_allocate_zeros(count, 8 * sizeof *rows);
	if (!rows)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %u points", count);
	float *normal = rows + 4 * (size_t)count;
	for (size_t i = 0; i < count; i++) {
		size_t surfel = point[i];
		for (size_t k = 0; k < 3; k++)
			rows[4 * i + k] =
				(s->position[3 * surfel + k] - octree->cube_minimum[k]) / octree->leaf_size;
		memcpy(normal + 4 * i, s->normal + 3 * surfel, 3 * sizeof *normal);
	}
	gw_status status = gw_records_put(task->passes->gpu, rows, normal, count, place, error);
	free(rows);
	return status;
}

/* ----------------------------------------------------------------------------- what is known */

static gw_status make_room(uint32_t count, uint32_t rays, bool emitted, gw_check_point_hits *hits,
						   gw_error *error)
{
	size_t rows = GW_CHECK_POINT_GATHERS * (size_t)count;
	*hits =
		(gw_check_point_hits){ .count = count,
							   .rays = rays,
							   .point = gw_allocate_array(count, sizeof *hits->point),
							   .facet = gw_allocate_array(rows, rays * sizeof *hits->facet),
							   .distance = gw_allocate_array(rows, rays * sizeof *hits->distance),
							   .emitted =
								   emitted ? gw_allocate_array(rows, 4 * sizeof(float)) : NULL };
	if (hits->point && hits->facet && hits->distance && (hits->emitted || !emitted))
		return GW_OK;
	gw_check_point_hits_clear(hits);
	return gw_fail(error, GW_ERROR_MEMORY, "no memory for what %u points see", count);
}

/* Copies what is known of point `from` to point `to` of another set. */
static void take_over(const gw_check_point_hits *known, size_t from, gw_check_point_hits *hits,
					  size_t to)
{
	size_t rays = hits->rays;
	for (size_t g = 0; g < GW_CHECK_POINT_GATHERS; g++) {
		size_t source = g * known->count + from, target = g * hits->count + to;
		memcpy(hits->facet + target * rays, known->facet + source * rays,
			   rays * sizeof *hits->facet);
		memcpy(hits->distance + target * rays, known->distance + source * rays,
			   rays * sizeof *hits->distance);
		if (hits->emitted && known->emitted)
			memcpy(hits->emitted + 4 * target, known->emitted + 4 * source, 4 * sizeof(float));
	}
}

/* Takes over all that is known; lists the points that lack, by their place in *hits. */
static uint32_t list_missing(const gw_check_point_hits *known, gw_check_point_hits *hits,
							 uint32_t *missing)
{
	uint32_t count = 0, at = 0, last = known->rays == hits->rays ? known->count : 0;
	for (uint32_t i = 0; i < hits->count; i++) {
		while (at < last && known->point[at] < hits->point[i])
			at++;
		if (at < last && known->point[at] == hits->point[i])
			take_over(known, at, hits, i);
		else
			missing[count++] = i;
	}
	return count;
}

/* ----------------------------------------------------------------------------------- tracing */

/* Some of the points: their places in *hits, and what is on the device for them. */
typedef struct some_points {
	const uint32_t *index; /* count */
	uint32_t count;
	gw_records place;
	char *rows; /* room for one gather of theirs, of 4 bytes a ray, or 16 */
} some_points;

static gw_status choose_some(const gw_check_point_task *task, const gw_check_point_hits *hits,
							 const uint32_t *index, uint32_t count, some_points *some,
							 gw_error *error)
{
	uint32_t *point = gw_allocate_array(count, sizeof *point);
	size_t row = 4 * (size_t)(hits->rays > 4 ? hits->rays : 4);
	*some = (some_points){ .index = index, .count = count, .rows = gw_allocate_array(count, row) };
	gw_status status = GW_OK;
	if (!point || !some->rows)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory for %u points", count);
	for (uint32_t i = 0; i < count && status == GW_OK; i++)
		point[i] = hits->point[index[i]];
	if (status == GW_OK)
		status = gw_check_point_hits_place(task, point, count, &some->place, error);
	free(point);
	return status;
}

static void free_some(const gw_check_point_task *task, some_points *some)
{
	gw_records_destroy(task->passes->gpu, &some->place);
	free(some->rows);
}

/* Rows of a buffer that go to those of these points in one gather. */
static gw_status fetch_rows(const gw_check_point_task *task, const some_points *some,
							gw_buffer *buffer, size_t row, char *first, gw_error *error)
{
	GW_TRY(gw_buffer_download(task->passes->gpu, buffer, 0, some->rows, row * some->count, error));
	for (size_t i = 0; i < some->count; i++)
		memcpy(first + row * some->index[i], some->rows + row * i, row);
	return GW_OK;
}

static gw_status put_rows(const gw_check_point_task *task, const some_points *some,
						  const char *first, size_t row, gw_buffer *buffer, gw_error *error)
{
	for (size_t i = 0; i < some->count; i++)
		memcpy(some->rows + row * i, first + row * some->index[i], row);
	return gw_buffer_upload(task->passes->gpu, buffer, 0, some->rows, row * some->count, error);
}

static gw_record_context context_of(const gw_check_point_task *task, some_points *some)
{
	return (gw_record_context){ task->passes, task->octree, &some->place };
}

static gw_status trace_some(const gw_check_point_task *task, some_points *some, uint32_t gather,
							gw_check_point_hits *hits, gw_error *error)
{
	const gw_record_context on = context_of(task, some);
	gw_ray_gather rays = { 0 };
	size_t row = 4 * (size_t)hits->rays, first = gather * (size_t)hits->count * row;
	gw_status status =
		gw_ray_gather_trace(&on, hits->rays, seed_of(task->seed, gather), &rays, error);
	if (status == GW_OK)
		status = gw_ray_gather_shut_out(&on, &rays, error);
	if (status == GW_OK)
		status = fetch_rows(task, some, &rays.facet, row, (char *)hits->facet + first, error);
	if (status == GW_OK)
		status = fetch_rows(task, some, &rays.distance, row, (char *)hits->distance + first, error);
	gw_ray_gather_destroy(task->passes->gpu, &rays);
	hits->traced += (uint64_t)hits->rays * some->count;
	return status;
}

/* ---------------------------------------------------------------------------------- emitters */

static gw_status light_by(const gw_check_point_task *task, some_points *some, uint32_t gather,
						  gw_ray_gather *rays, gw_check_point_hits *hits, gw_error *error)
{
	const float black[3] = { 0 };
	const gw_sampled_sources sources = { .emitters = task->emitters,
										 .samples = hits->rays,
										 .use_hits = true,
										 .sky = black,
										 .seed = rays->seed };
	const gw_record_context on = context_of(task, some);
	size_t row = 4 * (size_t)hits->rays, first = gather * (size_t)hits->count;
	GW_TRY(put_rows(task, some, (char *)hits->facet + first * row, row, &rays->facet, error));
	GW_TRY(put_rows(task, some, (char *)hits->distance + first * row, row, &rays->distance, error));
	GW_TRY(gw_ray_gather_sampled(&on, rays, &sources, &some->place.gathered, error));
	return fetch_rows(task, some, &some->place.gathered, 16, (char *)(hits->emitted + 4 * first),
					  error);
}

/* What emitters bring to these points along rays whose hits are known. */
static gw_status light_some(const gw_check_point_task *task, some_points *some, uint32_t gather,
							gw_check_point_hits *hits, gw_error *error)
{
	gw_ray_gather rays = { 0 };
	gw_status status = gw_ray_gather_create(task->passes->gpu, &some->place, hits->rays,
											seed_of(task->seed, gather), &rays, error);
	if (status == GW_OK)
		status = light_by(task, some, gather, &rays, hits, error);
	gw_ray_gather_destroy(task->passes->gpu, &rays);
	return status;
}

/* ------------------------------------------------------------------------------- all of both */

/* Fills in one gather of some points. */
typedef gw_status fill_some(const gw_check_point_task *task, some_points *some, uint32_t gather,
							gw_check_point_hits *hits, gw_error *error);

static gw_status fill_missing(const gw_check_point_task *task, const uint32_t *missing,
							  uint32_t count, fill_some *fill, gw_check_point_hits *hits,
							  gw_error *error)
{
	some_points some = { 0 };
	if (count == 0)
		return GW_OK;
	gw_status status = choose_some(task, hits, missing, count, &some, error);
	for (uint32_t g = 0; g < GW_CHECK_POINT_GATHERS && status == GW_OK; g++)
		status = fill(task, &some, g, hits, error);
	free_some(task, &some);
	return status;
}

gw_status gw_check_point_hits_find(const gw_check_point_task *task, const uint32_t *point,
								   uint32_t count, gw_check_point_hits *hits, gw_error *error)
{
	gw_check_point_hits next;
	uint32_t *missing = gw_allocate_array(count, sizeof *missing), found = 0;
	if (!missing)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %u points", count);
	gw_status status = make_room(count, task->rays, have_emitters(task), &next, error);
	if (status == GW_OK) {
		memcpy(next.point, point, count * sizeof *point);
		next.traced = hits->traced;
		found = list_missing(hits, &next, missing);
		status = fill_missing(task, missing, found, trace_some, &next, error);
	}
	if (status == GW_OK && !hits->emitted)
		for (found = 0; found < count; found++)
			missing[found] = found;
	if (status == GW_OK && next.emitted)
		status = fill_missing(task, missing, found, light_some, &next, error);
	free(missing);
	if (status != GW_OK) {
		gw_check_point_hits_clear(&next);
		return status;
	}
	gw_check_point_hits_clear(hits);
	*hits = next;
	return GW_OK;
}

/* --------------------------------------------------------------------------- to be gathered */

void gw_check_point_view_destroy(gw_gpu *gpu, gw_check_point_view *view)
{
	gw_ray_gather_destroy(gpu, &view->rays);
	gw_buffer_destroy(gpu, &view->emitted);
}

static gw_status fill_view(const gw_check_point_task *task, const gw_check_point_hits *hits,
						   uint32_t gather, gw_check_point_view *view, gw_error *error)
{
	gw_gpu *gpu = task->passes->gpu;
	size_t first = gather * (size_t)hits->count, row = hits->rays;
	uint64_t bytes = 4 * (uint64_t)hits->count * hits->rays;
	GW_TRY(gw_buffer_upload(gpu, &view->rays.facet, 0, hits->facet + first * row, bytes, error));
	GW_TRY(
		gw_buffer_upload(gpu, &view->rays.distance, 0, hits->distance + first * row, bytes, error));
	if (!hits->emitted)
		return GW_OK;
	bytes = 16 * (uint64_t)hits->count;
	GW_TRY(
		gw_buffer_create(gpu,
						 &(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_R32G32B32A32_SFLOAT,
												   bytes, "irradiance from emitters" },
						 &view->emitted, error));
	return gw_buffer_upload(gpu, &view->emitted, 0, hits->emitted + 4 * first, bytes, error);
}

gw_status gw_check_point_hits_gather(const gw_check_point_task *task,
									 const gw_check_point_hits *hits, const gw_records *place,
									 uint32_t gather, gw_check_point_view *view, gw_error *error)
{
	gw_gpu *gpu = task->passes->gpu;
	*view = (gw_check_point_view){ 0 };
	gw_status status = gw_ray_gather_create(gpu, place, hits->rays, seed_of(task->seed, gather),
											&view->rays, error);
	if (status == GW_OK)
		status = fill_view(task, hits, gather, view, error);
	if (status != GW_OK)
		gw_check_point_view_destroy(gpu, view);
	return status;
}

/*
 * raster_specks.c - pixels that show what lies behind narrow holes; see raster_steps.h.
 *
 * Where points lie at random, their discs leave holes here and there, though the surface goes on.
 * Before the sky these are gaps; before another surface they are specks: pixels, no more than a
 * hole of the widest kind has, all around which something nearer is shown, which they lie behind.
 * Pixels at their rims show some of both. raster_bridges.c says which of them are closed.
 */
#include "picture/raster_steps.h"

#define FULL 0.999f /* coverage of a pixel that has no gap */
#define BEHIND 1.0f /* radii behind the plane of a disc, from which on it is another surface */
#define NEIGHBOURS 8

/* Those that share a side with a pixel first. */
static const int neighbour_of[NEIGHBOURS][2] = { { -1, 0 },  { 1, 0 },  { 0, -1 }, { 0, 1 },
												 { -1, -1 }, { 1, -1 }, { -1, 1 }, { 1, 1 } };

/* While specks are looked for, beside the values of gw_raster_open. */
enum { IN_SPECK = 0x40, TOO_LARGE = 0x80 };

typedef struct speck_job {
	const gw_raster_view *view;
	const gw_gbuffer *g;
	uint32_t *pixel; /* those of one speck */
	uint8_t *open;
} speck_job;

void gw_raster_place_at(const gw_raster_view *view, const gw_gbuffer *g, size_t pixel,
						float place[3])
{
	int32_t samples = (int32_t)view->options->samples;
	int32_t column = (int32_t)(pixel % g->width), row = (int32_t)(pixel / g->width);
	float depth = g->depth[pixel], half = 0.5f * (float)(samples - 1) * view->step;
	place[0] = depth * (gw_raster_ray_x(view, column * samples) + half);
	place[1] = depth * (gw_raster_ray_y(view, row * samples) - half);
	place[2] = depth;
}

float gw_raster_radius_at(const gw_raster_view *view, const gw_gbuffer *g, size_t pixel)
{
	const gw_raster_discs *discs = &view->scene->discs;
	uint32_t id = g->id[pixel];
	if (id >= discs->count || (discs->two_sided && discs->two_sided[id] == GW_SIDE_FOLIAGE))
		return 0.0f;
	return discs->radius[id] * view->options->radius_scale;
}

/* How far a way, camera's frame, leads along a direction of the scene. */
static float length_along(const gw_raster_view *view, const float direction[3], const float way[3])
{
	double world[3], turned[3], length = 0.0;
	for (size_t k = 0; k < 3; k++)
		world[k] = (double)direction[k];
	gw_camera_turn(view->camera, world, turned);
	for (int k = 0; k < 3; k++)
		length += turned[k] * (double)way[k];
	return (float)length;
}

float gw_raster_height_over(const gw_raster_view *view, const gw_gbuffer *g, size_t pixel,
							const float way[3])
{
	return length_along(view, g->normal + 3 * pixel, way);
}

/* Whether what a pixel shows lies behind the surface that another one shows: its disc, since the
 * normal of a pixel at a rim is that of some of both. */
static bool lies_behind(const speck_job *job, size_t pixel, size_t near)
{
	const gw_gbuffer *g = job->g;
	float radius = gw_raster_radius_at(job->view, g, near), at[3], from[3], way[3];
	if (!(g->depth[pixel] > g->depth[near] && radius > 0.0f))
		return false;
	gw_raster_place_at(job->view, g, pixel, at);
	gw_raster_place_at(job->view, g, near, from);
	for (int k = 0; k < 3; k++)
		way[k] = at[k] - from[k];
	/* As seen from the camera, whichever side of the disc it sees. */
	const float *normal = job->view->scene->discs.normal + 3 * (size_t)g->id[near];
	float side = length_along(job->view, normal, from) > 0.0f ? 1.0f : -1.0f;
	return side * length_along(job->view, normal, way) > BEHIND * radius;
}

/* Pixels of the largest speck that is closed, of the size of discs at a pixel: a square as wide as
 * the widest gap. */
static size_t largest_speck(const speck_job *job, size_t pixel)
{
	float step = job->view->step * (float)job->view->options->samples;
	float radius = gw_raster_radius_at(job->view, job->g, pixel) / (job->g->depth[pixel] * step);
	float width = GW_RASTER_WIDEST_GAP * radius + 1.0f, pixels = width * width;
	return pixels < 1e6f ? (size_t)pixels : 1000000;
}

/* The neighbour of a pixel; false beyond the picture's edge. */
static bool find_neighbour(const speck_job *job, size_t pixel, int n, size_t *next)
{
	int64_t x = (int64_t)(pixel % job->g->width) + neighbour_of[n][0];
	int64_t y = (int64_t)(pixel / job->g->width) + neighbour_of[n][1];
	if (x < 0 || y < 0 || x >= job->g->width || y >= job->g->height)
		return false;
	*next = (size_t)(y * job->g->width + x);
	return true;
}

/* Adds to a speck what is around one of its pixels and no nearer; false when that is no speck. */
static bool grow_speck(const speck_job *job, size_t pixel, size_t *count, size_t most)
{
	for (int n = 0; n < 4; n++) {
		size_t next;
		if (!find_neighbour(job, pixel, n, &next))
			return false;
		if (job->open[next] & IN_SPECK || lies_behind(job, pixel, next))
			continue;
		if (job->open[next] != GW_RASTER_FULL || *count >= most)
			return false;
		job->open[next] |= IN_SPECK;
		job->pixel[(*count)++] = (uint32_t)next;
	}
	return true;
}

/* Marks the pixels of a speck and those at its rim, or as too many for one. */
static void try_speck(const speck_job *job, size_t first, size_t near)
{
	size_t count = 1, most = largest_speck(job, near);
	bool closed = true;
	job->pixel[0] = (uint32_t)first;
	job->open[first] |= IN_SPECK;
	for (size_t i = 0; i < count && closed; i++)
		closed = grow_speck(job, job->pixel[i], &count, most);
	for (size_t i = 0; i < count; i++)
		job->open[job->pixel[i]] = closed ? GW_RASTER_BEHIND : TOO_LARGE;
	for (size_t i = 0; i < count && closed; i++)
		for (int n = 0; n < NEIGHBOURS; n++) {
			size_t next;
			if (find_neighbour(job, job->pixel[i], n, &next) && job->open[next] != GW_RASTER_EMPTY)
				job->open[next] = GW_RASTER_BEHIND;
		}
}

void gw_raster_specks_find(const gw_raster_view *view, const gw_gbuffer *g, uint32_t *scratch,
						   uint8_t *open)
{
	speck_job job = { .view = view, .g = g, .pixel = scratch, .open = open };
	size_t pixels = (size_t)g->width * g->height;
	for (size_t i = 0; i < pixels; i++)
		open[i] = g->coverage[i] > FULL           ? GW_RASTER_FULL
				  : g->id[i] == GW_RASTER_NOTHING ? GW_RASTER_EMPTY
												  : GW_RASTER_PARTLY;
	for (size_t i = 0; i < pixels; i++)
		for (int n = 0; n < 4 && open[i] == GW_RASTER_FULL; n++) {
			size_t near;
			if (find_neighbour(&job, i, n, &near) && open[near] == GW_RASTER_FULL &&
				lies_behind(&job, i, near))
				try_speck(&job, i, near);
		}
	for (size_t i = 0; i < pixels; i++)
		if (open[i] == TOO_LARGE)
			open[i] = GW_RASTER_FULL;
}

/*
 * raster_bridges.c - closes gaps that are narrow for the surface around them; see raster_steps.h.
 *
 * A disc is as wide as the points next to it say. Where these lie in lines, as an airborne scanner
 * or a turning one leaves them, the next line may be further off than the disc is wide, and ground
 * shows slits; where they lie at random, as those of many stations do, it shows specks. At a pixel
 * that nothing covers, or that shows what lies behind such a speck (raster_specks.c), there is a
 * bridge when surface is met on both sides along five of eight lines through it, as in
 * raster_holes.c, and along one of them what is met on the two sides is one surface. A gap is
 * closed as a whole, where most of it is no wider than four radii of the discs around; else its rim
 * would be ragged. Windows are wider, and between leaves no surface goes on beyond. A closed pixel
 * shows what lies between the two ends of its bridge.
 */
#include "picture/raster_steps.h"

#include "base/memory.h"

#include <stdlib.h>

#define LINES 8
#define LEAST_LINES 5 /* with surface on both sides */
#define COSINE 0.9f   /* between their normals, at least */
#define SLOPE 0.2f    /* of the way between them against their planes, at most */
#define NOWHERE UINT32_MAX

static const int step_of[LINES][2] = { { -1, 0 },  { 0, -1 }, { -1, -1 }, { 1, -1 },
									   { -2, -1 }, { 2, -1 }, { -1, -2 }, { 1, -2 } };

/* Of each pixel. */
typedef struct bridge {
	uint32_t from, to; /* pixels, or NOWHERE */
	float span;        /* radii between them */
	uint8_t lines;     /* with surface on both sides */
} bridge;

typedef struct bridge_job {
	const gw_raster_view *view;
	gw_gbuffer *g;
	uint32_t *met[2]; /* owned; a pixel each: the next one with surface, either way along a line;
						 then the pixels of one gap */
	bridge *best;     /* owned; a pixel each */
	uint8_t *open;    /* owned; a gw_raster_open of each pixel */
	uint8_t *visited; /* owned; a pixel each */
} bridge_job;

/* The way between two pixels, radii of what they show, if that is one surface; else infinite. */
static float span_between(const bridge_job *job, size_t a, size_t b)
{
	const size_t pixel[2] = { a, b };
	float place[2][3], way[3], squared = 0.0f, cosine = 0.0f;
	float first = gw_raster_radius_at(job->view, job->g, a),
		  second = gw_raster_radius_at(job->view, job->g, b);
	gw_raster_place_at(job->view, job->g, a, place[0]);
	gw_raster_place_at(job->view, job->g, b, place[1]);
	for (size_t k = 0; k < 3; k++) {
		way[k] = place[1][k] - place[0][k];
		squared += way[k] * way[k];
		cosine += job->g->normal[3 * a + k] * job->g->normal[3 * b + k];
	}
	float span = sqrtf(squared), rise = 0.0f;
	for (int i = 0; i < 2; i++) {
		float height = gw_raster_height_over(job->view, job->g, pixel[i], way);
		rise = fmaxf(rise, fabsf(height));
	}
	bool one = first > 0.0f && second > 0.0f && cosine >= COSINE && rise <= SLOPE * span;
	return one ? span / (0.5f * (first + second)) : INFINITY;
}

/* The next pixels with surface one way along a line, 1 from the first row down, -1 up. */
static void meet_along(const bridge_job *job, int line, int way, uint32_t *met)
{
	const gw_gbuffer *g = job->g;
	int64_t width = g->width, height = g->height, pixels = width * height;
	for (int64_t n = 0; n < pixels; n++) {
		int64_t i = way > 0 ? n : pixels - 1 - n;
		int64_t x = i % width + way * step_of[line][0], y = i / width + way * step_of[line][1];
		bool inside = x >= 0 && x < width && y >= 0 && y < height;
		met[i] = job->open[i] == GW_RASTER_FULL ? (uint32_t)i
				 : inside                       ? met[y * width + x]
												: NOWHERE;
	}
}

static void look_along(const bridge_job *job, int line)
{
	const gw_gbuffer *g = job->g;
	meet_along(job, line, 1, job->met[0]);
	meet_along(job, line, -1, job->met[1]);
	for (size_t i = 0; i < (size_t)g->width * g->height; i++) {
		uint32_t from = job->met[0][i], to = job->met[1][i];
		if (job->open[i] == GW_RASTER_FULL || from == NOWHERE || to == NOWHERE)
			continue;
		bridge *best = job->best + i;
		float span = span_between(job, from, to);
		best->lines++;
		if (best->lines == 1 || span < best->span)
			*best = (bridge){ from, to, span, best->lines };
	}
}

/* Shows at a pixel what lies between the two ends of its bridge. What covers a part of the pixel
 * stays, and covers all of it. */
static void cross_pixel(const bridge_job *job, size_t pixel)
{
	const bridge *b = job->best + pixel;
	gw_gbuffer *g = job->g;
	size_t width = g->width, end[2] = { b->from, b->to };
	float share[2];
	g->coverage[pixel] = 1.0f;
	if (job->open[pixel] == GW_RASTER_PARTLY)
		return;
	for (int e = 0; e < 2; e++)
		share[1 - e] = hypotf((float)(pixel % width) - (float)(end[e] % width),
							  (float)(pixel / width) - (float)(end[e] / width));
	float all = share[0] + share[1], length = 0.0f;
	for (int e = 0; e < 2; e++)
		share[e] /= all;
	g->id[pixel] = g->id[end[share[1] > share[0]]];
	/* Along a straight way the inverse of the depth is linear on the picture. */
	g->depth[pixel] = 1.0f / (share[0] / g->depth[end[0]] + share[1] / g->depth[end[1]]);
	g->facing[pixel] = share[0] * g->facing[end[0]] + share[1] * g->facing[end[1]];
	for (size_t k = 0; k < 3; k++) {
		float n = share[0] * g->normal[3 * end[0] + k] + share[1] * g->normal[3 * end[1] + k];
		g->normal[3 * pixel + k] = n;
		length += n * n;
	}
	for (size_t k = 0; k < 3; k++)
		g->normal[3 * pixel + k] /= sqrtf(length);
	for (size_t c = 0, n = g->channel_count; c < n; c++)
		g->channel[n * pixel + c] =
			share[0] * g->channel[n * end[0] + c] + share[1] * g->channel[n * end[1] + c];
}

static bool has_bridge(const bridge *b)
{
	return b->lines >= LEAST_LINES && b->span < INFINITY;
}

/* The pixels of the gap that one lies in, put into met[0]; how many there are. */
static size_t find_gap(const bridge_job *job, size_t first)
{
	size_t width = job->g->width, height = job->g->height, count = 1;
	uint32_t *pixel = job->met[0];
	pixel[0] = (uint32_t)first;
	job->visited[first] = 1;
	for (size_t i = 0; i < count; i++) {
		size_t at = pixel[i], x = at % width, y = at / width;
		const size_t next[4] = { x > 0 ? at - 1 : at, x + 1 < width ? at + 1 : at,
								 y > 0 ? at - width : at, y + 1 < height ? at + width : at };
		for (int n = 0; n < 4; n++)
			if (!job->visited[next[n]] && job->open[next[n]] != GW_RASTER_FULL) {
				job->visited[next[n]] = 1;
				pixel[count++] = (uint32_t)next[n];
			}
	}
	return count;
}

static void close_gaps(const bridge_job *job)
{
	for (size_t i = 0; i < (size_t)job->g->width * job->g->height; i++) {
		if (job->visited[i] || job->open[i] == GW_RASTER_FULL)
			continue;
		size_t count = find_gap(job, i), narrow = 0;
		for (size_t n = 0; n < count; n++) {
			const bridge *b = job->best + job->met[0][n];
			narrow += has_bridge(b) && b->span <= GW_RASTER_WIDEST_GAP;
		}
		for (size_t n = 0; n < count && 2 * narrow > count; n++)
			if (has_bridge(job->best + job->met[0][n]))
				cross_pixel(job, job->met[0][n]);
	}
}

gw_status gw_raster_gaps_bridge(const gw_raster_view *view, gw_gbuffer *g, gw_error *error)
{
	size_t pixels = (size_t)g->width * g->height;
	bridge_job job = { .view = view, .g = g };
	job.met[0] = gw_allocate_array(pixels, sizeof *job.met[0]);
	job.met[1] = gw_allocate_array(pixels, sizeof *job.met[1]);
	job.best = gw_allocate_zeros(pixels, sizeof *job.best);
	job.visited = gw_allocate_zeros(pixels, sizeof *job.visited);
	job.open = gw_allocate_zeros(pixels, sizeof *job.open);
	bool good = job.met[0] && job.met[1] && job.best && job.visited && job.open;
	if (good)
		gw_raster_specks_find(view, g, job.met[0], job.open);
	for (int line = 0; line < LINES && good; line++)
		look_along(&job, line);
	if (good)
		close_gaps(&job);
	free(job.met[0]);
	free(job.met[1]);
	free(job.best);
	free(job.open);
	free(job.visited);
	return good ? GW_OK : gw_fail(error, GW_ERROR_MEMORY, "no memory to close gaps");
}

/*
 * gloss_clusters.c - see gloss_clusters.h.
 */
#include "picture/gloss_clusters.h"

#include "base/memory.h"
#include "light/octahedral.h"
#include "picture/gloss_cache.h"
#include "picture/gloss_functions.h"

#include <stdlib.h>

/* Directions of a histogram, a side of their octahedral map; and how wide their blur is: a normal
 * counts 1 / e where 1 - cosine is this, at 26 degrees. */
#define SIDE 8u
#define BINS (SIDE * SIDE)
#define BLUR 0.1f

#define AXES 3

/* A cluster is as deep as so many tiles are wide. */
#define DEEP 4.0f

/* Bits of a key below the tile's: slices of depth, axes with signs, pixels. */
#define SLICE_BITS 9
#define SLICES_MOST ((1u << SLICE_BITS) - 1u)
#define AXIS_BITS 3
#define PIXEL_BITS 32

typedef struct clustering {
	const gw_pixels *pixels;
	gw_gloss_clusters *clusters;
	gw_vec3 bin[BINS];
	float blur[BINS][BINS];
	float (*histogram)[BINS]; /* of each tile */
	gw_vec3 (*axis)[AXES];    /* likewise */
	uint64_t *key;            /* of each pixel that has a cluster, with it: sorted */
	size_t kept;
	float nearest; /* of the pixels to the eye */
} clustering;

static gw_vec3 place_of(const gw_pixels *p, size_t pixel)
{
	return gw_xyz(p->position + 4 * pixel);
}

static gw_vec3 to_eye(const gw_pixels *p, size_t pixel)
{
	return gw_minus(gw_xyz(p->eye), place_of(p, pixel));
}

static float distance_of(const gw_pixels *p, size_t pixel)
{
	gw_vec3 way = to_eye(p, pixel);
	return sqrtf(gw_dot(way, way));
}

static gw_vec3 normal_of(const gw_pixels *p, size_t pixel)
{
	float distance = distance_of(p, pixel);
	gw_vec3 way = gw_times(to_eye(p, pixel), distance > 0.0f ? 1.0f / distance : 0.0f);
	return gw_gloss_facing(gw_xyz(p->normal + 4 * pixel), way);
}

bool gw_gloss_is_cached(float roughness)
{
	return gloss_lobe_angle(roughness) >= GW_CACHE_LEAST_LOBE * GW_CACHE_ANGLE;
}

static bool is_cached(const gw_pixels *p, size_t pixel)
{
	return gw_gloss_is_cached(p->position[4 * pixel + 3]);
}

static uint32_t tile_of(const clustering *c, size_t pixel)
{
	uint32_t place = c->pixels->place[pixel], width = c->pixels->width;
	return place / width / c->clusters->tile * c->clusters->columns +
		   place % width / c->clusters->tile;
}

/* --------------------------------------------------------------------------------------- axes */

static void make_bins(clustering *c)
{
	for (uint32_t k = 0; k < BINS; k++)
		c->bin[k] = gw_octahedral_texel(SIDE, k);
	for (uint32_t k = 0; k < BINS; k++)
		for (uint32_t j = 0; j < BINS; j++)
			c->blur[k][j] = expf((gw_dot(c->bin[k], c->bin[j]) - 1.0f) / BLUR);
}

static void count_normals(clustering *c)
{
	const gw_pixels *p = c->pixels;
	c->nearest = INFINITY;
	for (size_t i = 0; i < p->count; i++) {
		if (!is_cached(p, i))
			continue;
		float u, v;
		gw_octahedral_place(normal_of(p, i), &u, &v);
		uint32_t column = (uint32_t)(u * (float)SIDE), row = (uint32_t)(v * (float)SIDE);
		column = column < SIDE ? column : SIDE - 1;
		row = row < SIDE ? row : SIDE - 1;
		c->histogram[tile_of(c, i)][row * SIDE + column] += 1.0f;
		c->nearest = gw_smaller(c->nearest, distance_of(p, i));
	}
}

static float to_the_eighth(float x)
{
	float x2 = x * x, x4 = x2 * x2;
	return x4 * x4;
}

static void choose_axes(const clustering *c, const float histogram[BINS], gw_vec3 axis[AXES])
{
	float weight[BINS] = { 0 };
	for (uint32_t j = 0; j < BINS; j++)
		for (uint32_t k = 0; k < BINS && histogram[j] > 0.0f; k++)
			weight[k] += histogram[j] * c->blur[k][j];
	for (int a = 0; a < AXES; a++) {
		uint32_t best = 0;
		for (uint32_t k = 1; k < BINS; k++)
			if (weight[k] > weight[best])
				best = k;
		axis[a] = c->bin[best];
		for (uint32_t k = 0; k < BINS; k++)
			weight[k] =
				(weight[k] + 1.0f) * (1.0f - to_the_eighth(gw_dot(c->bin[k], c->bin[best])));
	}
}

/* ------------------------------------------------------------------------------------ clusters */

/* The axis that describes a normal best, with its sign. */
static uint32_t axis_of(const gw_vec3 axis[AXES], gw_vec3 normal)
{
	uint32_t best = 0;
	float most = -1.0f;
	for (uint32_t a = 0; a < AXES; a++) {
		float along = gw_dot(axis[a], normal);
		if (fabsf(along) > most) {
			most = fabsf(along);
			best = 2 * a + (along < 0.0f);
		}
	}
	return best;
}

/* Slices get deeper with the distance, as tiles get wider. */
static uint32_t slice_of(const clustering *c, size_t pixel)
{
	float deep = DEEP * (float)c->clusters->tile * c->pixels->step;
	float slice = logf(distance_of(c->pixels, pixel) / c->nearest) / log1pf(deep);
	return slice < (float)SLICES_MOST ? (uint32_t)gw_larger(slice, 0.0f) : SLICES_MOST;
}

static void make_keys(clustering *c)
{
	const gw_pixels *p = c->pixels;
	for (size_t i = 0; i < p->count; i++) {
		if (!is_cached(p, i))
			continue;
		uint64_t tile = tile_of(c, i);
		uint64_t key = tile << SLICE_BITS | slice_of(c, i);
		key = key << AXIS_BITS | axis_of(c->axis[tile], normal_of(p, i));
		c->key[c->kept++] = key << PIXEL_BITS | i;
	}
}

static int compare_keys(const void *a, const void *b)
{
	const uint64_t *x = a, *y = b;
	return (*x > *y) - (*x < *y);
}

/* What is asked of the pixels of a cluster. */
typedef struct middle {
	gw_vec3 centre, normal; /* of the box around them; mean, unit */
	float width;            /* of a tile there: lengths are told by it */
} middle;

static middle middle_of(const clustering *c, const uint64_t *key, size_t count)
{
	gw_vec3 low = { INFINITY, INFINITY, INFINITY }, high = gw_times(low, -1.0f), sum = { 0 };
	for (size_t i = 0; i < count; i++) {
		size_t pixel = (size_t)(key[i] & UINT32_MAX);
		gw_vec3 p = place_of(c->pixels, pixel);
		low = (gw_vec3){ gw_smaller(low.x, p.x), gw_smaller(low.y, p.y), gw_smaller(low.z, p.z) };
		high = (gw_vec3){ gw_larger(high.x, p.x), gw_larger(high.y, p.y), gw_larger(high.z, p.z) };
		sum = gw_plus(sum, normal_of(c->pixels, pixel));
	}
	gw_vec3 centre = gw_times(gw_plus(low, high), 0.5f),
			off = gw_minus(gw_xyz(c->pixels->eye), centre);
	float length = sqrtf(gw_dot(sum, sum));
	float width = (float)c->clusters->tile * c->pixels->step * sqrtf(gw_dot(off, off));
	return (middle){ centre, gw_times(sum, length > 0.0f ? 1.0f / length : 0.0f),
					 gw_larger(width, 1e-20f) };
}

/* How well a pixel speaks for its cluster: it faces as all do, stands out, and in the middle. */
static float score_of(const clustering *c, const middle *m, size_t pixel)
{
	gw_vec3 off = gw_times(gw_minus(place_of(c->pixels, pixel), m->centre), 1.0f / m->width);
	float out = gw_dot(off, m->normal);
	gw_vec3 aside = gw_minus(off, gw_times(m->normal, out));
	return (gw_dot(normal_of(c->pixels, pixel), m->normal) + out) /
		   (1.0f + sqrtf(gw_dot(aside, aside)));
}

static uint32_t best_of(const clustering *c, const uint64_t *key, size_t count)
{
	middle m = middle_of(c, key, count);
	uint32_t best = (uint32_t)(key[0] & UINT32_MAX);
	float most = -INFINITY;
	for (size_t i = 0; i < count; i++) {
		uint32_t pixel = (uint32_t)(key[i] & UINT32_MAX);
		float score = score_of(c, &m, pixel);
		if (score > most) {
			most = score;
			best = pixel;
		}
	}
	return best;
}

/* Runs of equal keys are clusters. */
static void number_clusters(clustering *c)
{
	gw_gloss_clusters *g = c->clusters;
	uint64_t tile = 0;
	for (size_t first = 0, last; first < c->kept; first = last) {
		uint64_t key = c->key[first] >> PIXEL_BITS;
		for (last = first; last < c->kept && c->key[last] >> PIXEL_BITS == key; last++)
			g->cluster_of[c->key[last] & UINT32_MAX] = (uint32_t)g->count;
		for (; tile <= key >> (SLICE_BITS + AXIS_BITS); tile++)
			g->tile_first[tile] = (uint32_t)g->count;
		g->representative[g->count++] = best_of(c, c->key + first, last - first);
	}
	for (; tile <= (uint64_t)g->columns * g->rows; tile++)
		g->tile_first[tile] = (uint32_t)g->count;
}

/* -------------------------------------------------------------------------------------- making */

static gw_status open_clusters(clustering *c, uint32_t tile, gw_error *error)
{
	const gw_pixels *p = c->pixels;
	gw_gloss_clusters *g = c->clusters;
	g->tile = tile;
	g->columns = (p->width + tile - 1) / tile;
	g->rows = (p->height + tile - 1) / tile;
	size_t tiles = (size_t)g->columns * g->rows;
	g->tile_first = gw_allocate_array(tiles + 1, sizeof *g->tile_first);
	g->representative = gw_allocate_array(p->count, sizeof *g->representative);
	g->cluster_of = gw_allocate_array(p->count, sizeof *g->cluster_of);
	c->histogram = gw_allocate_zeros(tiles, sizeof *c->histogram);
	c->axis = gw_allocate_array(tiles, sizeof *c->axis);
	c->key = gw_allocate_array(p->count, sizeof *c->key);
	if (!g->tile_first || !g->representative || !g->cluster_of || !c->histogram || !c->axis ||
		!c->key)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for clusters of %zu pixels", p->count);
	for (size_t i = 0; i < p->count; i++)
		g->cluster_of[i] = GW_NO_CLUSTER;
	return GW_OK;
}

static gw_status make_clusters(clustering *c, uint32_t tile, gw_error *error)
{
	GW_TRY(open_clusters(c, tile, error));
	count_normals(c);
	for (size_t t = 0; t < (size_t)c->clusters->columns * c->clusters->rows; t++)
		choose_axes(c, c->histogram[t], c->axis[t]);
	make_keys(c);
	qsort(c->key, c->kept, sizeof *c->key, compare_keys);
	number_clusters(c);
	return GW_OK;
}

gw_status gw_gloss_clusters_make(const gw_pixels *pixels, size_t most, gw_gloss_clusters *clusters,
								 gw_error *error)
{
	gw_status status = GW_OK;
	*clusters = (gw_gloss_clusters){ .count = SIZE_MAX };
	for (uint32_t tile = GW_GLOSS_TILE; status == GW_OK && clusters->count > most; tile *= 2) {
		clustering c = { .pixels = pixels, .clusters = clusters };
		gw_gloss_clusters_clear(clusters);
		make_bins(&c);
		status = make_clusters(&c, tile, error);
		free(c.histogram);
		free(c.axis);
		free(c.key);
	}
	if (status != GW_OK)
		gw_gloss_clusters_clear(clusters);
	return status;
}

void gw_gloss_clusters_clear(gw_gloss_clusters *clusters)
{
	free(clusters->tile_first);
	free(clusters->representative);
	free(clusters->cluster_of);
	*clusters = (gw_gloss_clusters){ .tile_first = NULL };
}

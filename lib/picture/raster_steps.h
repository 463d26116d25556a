/*
 * raster_steps.h - the steps of gw_raster_draw. Internal to lib/.
 *
 *   shape   gw_raster_shape_make   one primitive as seen by the camera, and which samples it meets
 *   bins    gw_raster_bins_make    which primitives reach into which tile
 *   tile    gw_raster_tile_draw    the two passes over one tile, and its pixels
 *   holes   gw_raster_holes_close  which pixels that only edges hide are shown
 *   specks  gw_raster_specks_find  which pixels show what lies behind narrow holes
 *   bridges gw_raster_gaps_bridge  which pixels in narrow gaps are shown
 *
 * Samples are counted from 0 at the left and the top; the middle of sample (i, j) is at
 * (i + 1/2, j + 1/2). A ray through it has the direction (x, y, 1) in the camera's frame.
 */
#ifndef RASTER_STEPS_H
#define RASTER_STEPS_H

#include "glowworm_picture.h"

#include <math.h>

/* A widened disc reaches so far from its middle, samples: any circle as large meets a sample. */
#define GW_RASTER_WIDENED 0.7072f

/* What all steps need of scene, camera and options. */
typedef struct gw_raster_view {
	const gw_raster_scene *scene;
	const gw_camera *camera;
	const gw_raster_options *options;
	double eye[3];            /* the camera in the scene's local frame */
	uint32_t columns, rows;   /* of samples */
	float step;               /* between samples on the image plane */
	float middle_x, middle_y; /* of the picture, in samples */
	float near;               /* metres */
	size_t primitives;        /* discs and triangles */
	uint32_t tile;            /* samples a side of a tile */
	uint32_t tiles_x, tiles_y;
} gw_raster_view;

typedef enum gw_raster_kind { GW_RASTER_DISC, GW_RASTER_TRIANGLE } gw_raster_kind;

/* A half-plane in space: inside is x * q <= offset for offsets q from the disc's middle. */
typedef struct gw_raster_cut {
	float x[3], offset;
} gw_raster_cut;

/* One primitive in the camera's frame. */
typedef struct gw_raster_shape {
	gw_raster_kind kind;
	int32_t x0, x1, y0, y1;  /* samples it may meet, both ends included */
	float normal[3], offset; /* of its plane: normal * q = offset */
	float tolerance;         /* metres from the plane within which others are the same surface */
	float behind;            /* metres that its depth counts as further than it is, when it is the
								back of a surface: where a front lies as near, that is seen */
	/* A disc. */
	float middle[3];
	float inverse;            /* 1 / radius^2 */
	float weight;             /* of its centre */
	float centre_x, centre_y; /* its middle on the picture, samples; only when widened */
	bool widened;
	uint32_t cuts;
	gw_raster_cut cut[2];
	/* A triangle: edge functions over directions, each 0 on one edge. */
	float edge[3][3];
	float sign; /* makes the edge functions positive inside */
} gw_raster_shape;

/* Four samples side by side. Comparisons give 0 or -1 in each lane. */
typedef float gw_lanes __attribute__((vector_size(16)));
typedef int32_t gw_lane_mask __attribute__((vector_size(16)));
#define GW_LANES 4

/* One primitive at four samples. */
typedef struct gw_raster_fragments {
	gw_lane_mask hit;
	gw_lane_mask beyond;     /* would hit, had a half-plane not cut the disc there */
	gw_lanes depth, weight;  /* depth with gw_raster_shape.behind */
	gw_lanes barycentric[3]; /* of a triangle */
} gw_raster_fragments;

/* The normal of a primitive in the camera's frame, as gw_raster_shape.normal has it. */
void gw_raster_normal(const gw_raster_view *view, size_t primitive, float normal[3]);

/* A distance along the camera's axis that nothing of a primitive falls below, and what will be its
 * shape's tolerance. */
void gw_raster_reach(const gw_raster_view *view, size_t primitive, float *near, float *tolerance);

/* The tolerance of a disc's shape. */
float gw_raster_tolerance(const gw_raster_view *view, size_t disc);

/* False when the primitive is not in the picture. */
bool gw_raster_shape_make(const gw_raster_view *view, size_t primitive, gw_raster_shape *shape);

/* Of the ray through sample (column, row): its direction is (x, y, 1). */
static inline float gw_raster_ray_x(const gw_raster_view *view, int32_t column)
{
	return ((float)column + 0.5f - view->middle_x) * view->step;
}

static inline float gw_raster_ray_y(const gw_raster_view *view, int32_t row)
{
	return (view->middle_y - (float)row - 0.5f) * view->step;
}

/* Where a primitive meets the rays through the samples from (column, row) on. */
void gw_raster_shape_meet(const gw_raster_view *view, const gw_raster_shape *shape, int32_t column,
						  int32_t row, gw_raster_fragments *fragments);

/* For each tile, the primitives that reach into it, in ascending order. */
typedef struct gw_raster_bins {
	uint64_t *first;     /* tiles + 1: where a tile's list begins */
	uint32_t *primitive; /* first[tiles] */
	uint64_t drawn;      /* primitives that are in some list */
	size_t longest;      /* primitives of the longest list */
} gw_raster_bins;

/*
 * Makes the lists of all tiles.
 *   bins   on success owned by the caller, freed with gw_raster_bins_clear; zeroed on failure
 * Fails with GW_ERROR_MEMORY.
 */
gw_status gw_raster_bins_make(const gw_raster_view *view, gw_raster_bins *bins, gw_error *error);
void gw_raster_bins_clear(gw_raster_bins *bins);

/* A primitive of a tile, and what is known of it without its shape. */
typedef struct gw_raster_entry {
	float near;      /* metres; nothing of it is nearer */
	float tolerance; /* as gw_raster_shape.tolerance */
	uint32_t primitive;
	uint8_t x0, x1, y0, y1; /* blocks of the tile that it may meet, both ends included */
} gw_raster_entry;

/* Samples a side of a block, of which the furthest depth is kept. */
#define GW_RASTER_BLOCK 8u

#define GW_RASTER_FIXED 5u /* floats of a sum before the channels: weight, normal, opacity */

/* The surface that is seen at each sample of a tile. */
typedef struct gw_raster_layer {
	float *depth;  /* of the nearest; infinity */
	uint32_t *id;  /* of the nearest */
	float *normal; /* 3 a sample, of the nearest, in the camera's frame */
	float *sum;    /* GW_RASTER_FIXED + channel_count a sample: weight, and weighted sums of normal,
					  opacity and channels */
	float *glow;   /* likewise of discs that glow, until one sum is chosen; NULL when none do */
} gw_raster_layer;

/* A thread's memory while it draws a tile: tile * tile samples. */
typedef struct gw_raster_scratch {
	gw_raster_layer layer[2]; /* the nearest surface, and what is behind where that is thin */
	float *floor;             /* only what is behind this may be in the second layer */
	float *far;               /* of each block, the furthest of its depths, or further */
	gw_raster_entry *entry;   /* of the tile, then of the tile from near to far */
	gw_raster_entry *order;
	/* Only where discs let light through: of each sample, how much of what is behind is seen, from
	 * which depth on; and opacity and channels of what is in front, blended. */
	float *left, *start, *blend;
} gw_raster_scratch;

/* How many samples of a pixel are covered for sure, and how many more by what lies beyond edges at
 * which discs are cut. */
typedef struct gw_raster_cover {
	uint8_t sure, beyond;
} gw_raster_cover;

/* Draws one tile into the pixels of the G-buffer that it covers; their coverage is yet
 * the opacity of what is covered.
 *   cover   of the whole picture, width * height */
void gw_raster_tile_draw(const gw_raster_view *view, const gw_raster_bins *bins, size_t tile,
						 gw_raster_scratch *scratch, gw_raster_cover *cover, gw_gbuffer *gbuffer);

/*
 * Once all tiles are there: decides which holes are closed, completes the coverage, and empties
 * pixels of which nothing is left. Fails with GW_ERROR_MEMORY.
 */
gw_status gw_raster_holes_close(const gw_raster_view *view, const gw_raster_cover *cover,
								gw_gbuffer *gbuffer, gw_error *error);

/* Mean radii of the discs around, that a gap is wide at most which is closed. */
#define GW_RASTER_WIDEST_GAP 4.0f

/* What a pixel misses of the surface around it: nothing; all of it; all, and it shows what lies
 * behind; or a part. */
typedef enum gw_raster_open {
	GW_RASTER_FULL,
	GW_RASTER_EMPTY,
	GW_RASTER_BEHIND,
	GW_RASTER_PARTLY
} gw_raster_open;

/* The place that a pixel shows, camera's frame, metres. */
void gw_raster_place_at(const gw_raster_view *view, const gw_gbuffer *gbuffer, size_t pixel,
						float place[3]);

/* Radius of the disc that a pixel shows, metres; 0 when that is none, or a leaf. */
float gw_raster_radius_at(const gw_raster_view *view, const gw_gbuffer *gbuffer, size_t pixel);

/* How far a way from what a pixel shows leads off its plane, metres, to where its normal points. */
float gw_raster_height_over(const gw_raster_view *view, const gw_gbuffer *gbuffer, size_t pixel,
							const float way[3]);

/*
 * What each pixel misses.
 *   scratch   a number a pixel, for the time of the call
 *   open      out, a gw_raster_open a pixel
 */
void gw_raster_specks_find(const gw_raster_view *view, const gw_gbuffer *gbuffer, uint32_t *scratch,
						   uint8_t *open);

/*
 * Then closes gaps between discs of one surface that are narrow for these. Only for discs that are
 * as wide as the surface: smaller ones are meant to be seen apart. Fails with GW_ERROR_MEMORY.
 */
gw_status gw_raster_gaps_bridge(const gw_raster_view *view, gw_gbuffer *gbuffer, gw_error *error);

#endif

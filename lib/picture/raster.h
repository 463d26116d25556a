/*
 * raster.h - surfels and triangles seen by a camera: a G-buffer, made on the host.
 *
 * Deferred, as in Salm 4.1 and 4.6: geometry is drawn once into a buffer of attributes, and a later
 * pass turns those into colours. A surfel is a flat disc, drawn with exact perspective: along each
 * ray the depth of its plane. Where discs of one surface overlap, their attributes are blended with
 * a weight that falls from the centre to the rim (surface splatting after Zwicker et al. 2001, in
 * the two passes of Botsch et al. 2005):
 *
 *   1. the nearest depth of every sample;
 *   2. the weighted mean over all fragments that belong to the surface there: not much further
 *      than the nearest, and facing the same way.
 *
 * The back of a disc gives way to a front within half a radius, so that of a sheet with two sides,
 * or a box on a floor, the side is seen that looks at the camera.
 *
 * Where the nearest surface is thin, which is the rim of a disc or two that stick out over an edge,
 * both passes are repeated behind it, and solid surface found there is shown instead. Where nothing
 * is, they are repeated without the half-planes at which discs are cut, and what that brings is
 * shown if it closes a hole: with surface on both sides.
 *
 * Where discs that glow lie among others, a sample shows the kind that weighs more, so that a lamp
 * ends where its points end, not where the last of its discs does.
 *
 * A disc smaller than a sample is widened until it meets one, and weighs as much less as it grew,
 * so that points below a sample's size neither vanish nor outweigh others.
 *
 * The picture is cut into tiles, each of which goes over its own list of primitives from near to
 * far, in an order that depends on nothing else; so the result is the same for any number of
 * threads.
 */
#ifndef RASTER_H
#define RASTER_H

#include "picture/camera.h"

/* Limits of gw_raster_options. */
#define GW_RASTER_SIZE_MAX 16384u
#define GW_RASTER_SAMPLES_MAX 8u
#define GW_RASTER_CHANNELS_MAX 32u

/* The id of a pixel that shows nothing. */
#define GW_RASTER_NOTHING UINT32_MAX

/* Discs to draw; all arrays belong to the caller and stay unchanged. */
typedef struct gw_raster_discs {
	size_t count;
	const float *position;    /* 3 * count, metres in the local frame */
	const float *normal;      /* 3 * count, unit */
	const float *radius;      /* count, metres; 0: not drawn */
	const float *clip;        /* 6 * count or NULL: half-planes as in gw_surfels.clip */
	const uint8_t *two_sided; /* count or NULL: 1 where the normal's sign means nothing */
	const uint8_t *glows;     /* count or NULL: 1 for those that are not blended with others */
	const float *channel;     /* channel_count * count, what is blended */
} gw_raster_discs;

/* Triangles to draw, as an indexed mesh; all arrays belong to the caller and stay unchanged. */
typedef struct gw_raster_triangles {
	size_t count; /* triangles */
	size_t vertex_count;
	const uint32_t *index; /* 3 * count, below vertex_count; counterclockwise from the front */
	const float *position; /* 3 * vertex_count, metres in the local frame */
	const float *normal;   /* 3 * vertex_count, unit; or NULL: the triangles' own */
	const float *channel;  /* channel_count * vertex_count, interpolated linearly */
} gw_raster_triangles;

typedef struct gw_raster_scene {
	double origin[3]; /* of the local frame, metres */
	gw_raster_discs discs;
	gw_raster_triangles triangles;
	uint32_t channel_count; /* floats a disc or vertex, at most GW_RASTER_CHANNELS_MAX */
} gw_raster_scene;

typedef struct gw_raster_options {
	uint32_t width, height; /* pixels, 1..GW_RASTER_SIZE_MAX */
	uint32_t samples;       /* a side of the grid in every pixel, 1..GW_RASTER_SAMPLES_MAX */
	float radius_scale;     /* every disc's radius times this; 1 draws the surface */
	bool cull;              /* leave out what is seen from behind */
	uint32_t threads;       /* 0: one a processor */
	bool (*cancelled)(void *user);
	void *user;
} gw_raster_options;

/* What is seen in each pixel. Rows run from the top to the bottom of the picture. */
typedef struct gw_gbuffer {
	uint32_t width, height, channel_count;
	float *coverage; /* width * height, share of the pixel that something covers, 0..1 */
	float *depth;    /* width * height, metres along the camera's forward axis, of the nearest
						sample; infinity where there is nothing */
	float *facing;  /* width * height, mean of the covered samples' |cosine| between normal and ray:
					   more than the mean normal tells where surfaces meet; 0 for nothing */
	float *normal;  /* 3 * width * height, unit, in the world's axes; 0, 0, 0 for nothing */
	float *channel; /* channel_count * width * height, mean over what is covered (not multiplied
					   by the coverage); 0 for nothing */
	uint32_t *id;   /* width * height, of the nearest primitive: a disc's index, or the number of
					   discs plus a triangle's index; GW_RASTER_NOTHING */
	uint64_t drawn; /* primitives that reach into the picture */
} gw_gbuffer;

/*
 * Draws a scene.
 *   gbuffer   on success owned by the caller, freed with gw_gbuffer_clear; zeroed on failure
 * Fails with GW_ERROR_USAGE when a size is out of its limits, GW_ERROR_MEMORY, GW_ERROR_CANCELLED.
 * A scene of which nothing is in view gives an empty picture with drawn = 0.
 * Thread-safe: draws with threads of its own.
 */
gw_status gw_raster_draw(const gw_raster_scene *scene, const gw_camera *camera,
						 const gw_raster_options *options, gw_gbuffer *gbuffer, gw_error *error);
void gw_gbuffer_clear(gw_gbuffer *gbuffer);

#endif

/*
 * radiance_volume.h - place, trace and basis step by a uniform grid (Mavridis and Papaioannou,
 * Global Illumination using Imperfect Volumes): cells that lie in free space send rays over the
 * whole sphere once, and every light is a sum over their hits, kept as spherical harmonics of the
 * radiance that arrives at their centres. volume_places.h reads it back.
 *
 * The paper marches its rays through the grid itself, whose cells are surface where a point lies in
 * them; here they meet the planes in the octree's leaves, as those of records do.
 */
#ifndef RADIANCE_VOLUME_H
#define RADIANCE_VOLUME_H

#include "light/gather_rays.h"
#include "light/transport_layout.h"

/* Cells along the longest side of the scene, at most as many as there are halves of leaf cells. */
#define GW_VOLUME_CELLS_LEAST 2u
#define GW_VOLUME_CELLS_MOST 512u

/* What a volume is to be. */
typedef struct gw_volume_wish {
	const gw_surfels *surfels; /* of the octree: bounds, and places that read the volume */
	uint32_t cells;            /* along the longest side of their bounds, within these limits */
	uint32_t order;            /* of the spherical harmonics: 2 (4 a cell) or 3 (9) */
	uint32_t rays;             /* a cell; 0: none, light gets there another way */
	uint32_t seed;             /* of their directions */
	bool whole; /* all cells in free space, not only those that surfels and records read */
} gw_volume_wish;

typedef struct gw_radiance_volume {
	float minimum[3];  /* grid coordinates of the corner of cell (0, 0, 0) */
	float size;        /* side of a cell, leaf cells */
	uint32_t cells[3]; /* along x, y, z: those of the bounds, and one more at each end */
	uint32_t order, rays, seed;
	uint32_t count;     /* cells with light: in free space, and read */
	uint64_t looked;    /* rays by which it was found which these are */
	uint32_t *cell;     /* count: which of the grid, x + cells[0] * (y + cells[1] * z) */
	uint32_t *label;    /* count: compartments (volume_labels.h); NULL where there is one */
	gw_buffer slot;     /* R32_UINT, a cell of the grid: its number among the count, or GW_NONE */
	gw_buffer centre;   /* R32G32B32A32_SFLOAT, count: grid coordinates; mark of the compartment */
	gw_buffer pattern;  /* R32G32B32A32_SFLOAT, rays: unit directions before they are turned */
	gw_buffer hit;      /* R32_UINT, rays * count: facet that each ray hit, GW_NONE for nothing */
	gw_buffer radiance; /* R32G32B32A32_SFLOAT, order^2 * count: harmonics of the latest light */
	gw_buffer sum;      /* likewise, of what was added up */
} gw_radiance_volume;

/*
 * Chooses the cells and traces their rays. Cells are buried that see mostly the backs of what they
 * see first: they lie in something solid, and have no light. Of backs within GW_NEAR leaf cells
 * rays know nothing. On failure *volume is empty.
 *   on       its records read the volume, too, unless the wish is a whole one: then they may be
 *            empty. Where the octree knows compartments, hits behind rock are put right
 * Fails with GW_ERROR_MEMORY for more cells than the device or its memory can hold.
 */
gw_status gw_radiance_volume_make(const gw_record_context *on, const gw_volume_wish *wish,
								  gw_radiance_volume *volume, gw_error *error);
void gw_radiance_volume_destroy(gw_gpu *gpu, gw_radiance_volume *volume); /* an empty one is fine */

/* Where the light of a volume comes from. */
typedef struct gw_volume_light {
	const gw_buffer *facets; /* texel buffer, facet_count vec4: radiance */
	const float *sky;        /* 3, even radiance that rays see which leave the scene */
	const gw_sky_map *map;   /* NULL, or what they see besides */
} gw_volume_light;

/* Fills volume->radiance with light. */
gw_status gw_radiance_volume_fill(gw_passes *passes, gw_radiance_volume *volume,
								  const gw_volume_light *light, gw_error *error);

/* Adds volume->radiance to volume->sum; or forgets what was added up. */
gw_status gw_radiance_volume_add(gw_passes *passes, gw_radiance_volume *volume, gw_error *error);
gw_status gw_radiance_volume_clear_sum(gw_passes *passes, gw_radiance_volume *volume,
									   gw_error *error);

/* What all passes of a volume are pushed. */
gw_volume_push gw_radiance_volume_push(const gw_radiance_volume *volume);

/* Spherical harmonics a cell. */
static inline uint32_t gw_radiance_volume_terms(const gw_radiance_volume *volume)
{
	return volume->order * volume->order;
}

#endif

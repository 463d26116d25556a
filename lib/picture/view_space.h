/*
 * view_space.h - a cloud as coarse cells: where its points are, where there is free space, and what
 * is met from there. Points far from the rest do not count.
 */
#ifndef VIEW_SPACE_H
#define VIEW_SPACE_H

#include "glowworm_picture.h"

/* Sums over the surfels in a cell. */
typedef struct view_cell {
	float normal[3]; /* area * normal */
	float light;     /* area * luminance */
	float height;    /* area * place along the up axis */
	float area;      /* m^2; 0: free */
} view_cell;

typedef struct view_space {
	const gw_surfels *surfels;
	const gw_viewpoint_wish *wish;
	double side[3], back[3], up[3]; /* as gw_camera_stand */
	double low[3], high[3];         /* bounds of what counts, local frame, metres */
	view_cell *cell;                /* owned */
	int32_t size[3];                /* cells */
	size_t count;                   /* of all cells */
	double least[3];                /* corner of cell 0, local frame */
	double width;                   /* of a cell, metres */
	double area, light;             /* m^2 of all; geometric mean of the luminance, so that lamps
									   do not decide it */
	bool given;                     /* the normals were, most of them */
	bool sided;                     /* or scanners are known, so that fronts are */
} view_space;

/* What one ray met. */
typedef struct view_hit {
	double depth; /* cells; 0: nothing */
	size_t cell;
} view_hit;

static inline double view_dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Makes the cells. On success freed with gw_view_space_clear. GW_ERROR_MEMORY. */
gw_status gw_view_space_make(const gw_surfels *surfels, const gw_viewpoint_wish *wish,
							 view_space *space, gw_error *error);
void gw_view_space_clear(view_space *space);

/* Whether a place, local frame, is within the bounds of what counts. */
bool gw_view_space_holds(const view_space *space, const float position[3]);

/* The place of a cell in the grid. */
void gw_view_space_place(const view_space *space, size_t cell, int32_t at[3]);

/* Follows a ray from the middle of a cell, which may lie outside of the grid, to the first one that
 * is not free, but not among the first `skipped` that it enters. */
view_hit gw_view_space_look(const view_space *space, const int32_t from[3], const double ray[3],
							int skipped);

/*
 * Cosine between the surface of a cell and a direction towards its viewer; 0 where its normals
 * cancel. Which side is its front is what the normals say if they were given, else where the
 * scanner stood; when nobody knows, both are.
 */
double gw_view_space_facing(const view_space *space, size_t cell, const double to_viewer[3]);

/* How well lit the surface of a cell is, 0..1; 0.5 is the mean, and unlit clouds. */
double gw_view_space_lit(const view_space *space, size_t cell);

/* A direction by azimuth and elevation, radians; azimuth 0 is from the front. */
void gw_view_space_direction(const view_space *space, double azimuth, double elevation,
							 double d[3]);

#endif

/*
 * surfel_plane.h - the neighbours of a surfel in the plane of its normal, and half-planes that cut
 * its cell there. Coordinates are along the tangent and bitangent of gw_tangent_frame, metres, the
 * surfel at 0. Internal to lib/. Thread-safe, as gw_neighbours_at is.
 */
#ifndef SURFEL_PLANE_H
#define SURFEL_PLANE_H

#include "cloud/neighbours.h"

/* Directions in which the neighbours' extent is looked at. */
#define GW_DIRECTIONS 16

/* A little more, so that directions 60 degrees apart are enough. */
#define GW_COS_60 0.5001

/* Discs reach to this neighbour on their surface: where points are even, that is as far as covers
 * so many times what each stands for. */
#define GW_DISC_RANK 8

/* Cosine and sine of the directions, evenly around. */
extern const double gw_direction[GW_DIRECTIONS][2];

/* A neighbour in the plane of the surfel's normal. */
typedef struct gw_flat_point {
	double x, y, height; /* along tangent, bitangent, normal, metres */
	double distance;     /* in the plane */
	uint32_t index;      /* of the surfel that it is */
} gw_flat_point;

typedef struct gw_half_plane {
	double x, y, offset; /* unit direction; inside is x u + y v <= offset */
} gw_half_plane;

static inline double gw_distance_along(const gw_half_plane *h, double x, double y)
{
	return h->x * x + h->y * y;
}

/*
 * Neighbours with a normal like the surfel's; unoriented normals may be opposite.
 *   flat   receives them, at most list->count, in the list's order
 * Returns how many.
 */
uint32_t gw_plane_flatten(const gw_surfels *surfels, size_t surfel, const gw_neighbour_list *list,
						  gw_flat_point *flat);

/*
 * Those of them that may be of the same surface though they lie further off than the surfel's
 * neighbours: not so far above or below its plane that they are of another one, as a street before
 * the edge of a roof.
 *   reach   distance of the furthest neighbour, metres
 */
uint32_t gw_plane_flatten_level(const gw_surfels *surfels, size_t surfel,
								const gw_neighbour_list *list, double reach, gw_flat_point *flat);

/*
 * Neighbours on the surfel's surface: with a normal like its own and near the plane through them.
 *   flat    receives them, at most list->count, nearest in the plane first
 *   noise   receives the RMS distance of those with a like normal from their plane, metres
 * Returns how many.
 */
uint32_t gw_plane_surface(const gw_surfels *surfels, size_t surfel, const gw_neighbour_list *list,
						  gw_flat_point *flat, double *noise);

/*
 * The surfels nearest to a place in the surfel's plane, by distance from that place.
 *   list   receives them, at most GW_NEIGHBOURS_AT
 */
void gw_plane_look_at(gw_neighbours *search, const gw_surfels *surfels, size_t surfel, double x,
					  double y, gw_neighbour_list *list);

/*
 * Area of the surfel's Voronoi cell, m^2, within its disc, the edges and where the furthest
 * neighbour lets it be known.
 *   kept     count neighbours on its surface, nearest first
 *   radius   of the disc, metres
 *   reach    distance of the furthest of all neighbours, metres
 *   edge     edges half-planes, two at most
 */
double gw_plane_cell_area(const gw_flat_point *kept, uint32_t count, double radius, double reach,
						  const gw_half_plane *edge, uint32_t edges);

/* Noise, of the reach of the neighbours, up to which planes tell where their crease is. */
#define GW_CREASE_NOISE 0.02

/* Makes up to two half-planes the surfel's clips, in place of those it has. */
void gw_plane_store_clips(gw_surfels *surfels, size_t surfel, const gw_half_plane *edge,
						  uint32_t edges);

/* Gives the surfel's clips as half-planes; returns how many there are. */
uint32_t gw_plane_load_clips(const gw_surfels *surfels, size_t surfel, gw_half_plane edge[2]);

#endif

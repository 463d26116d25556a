/*
 * mesh_scenes.h - scenes of triangles, whose light a reference tracer can find, and clouds of
 * points sampled from them.
 *
 * Most scenes are a box seen from inside with solid blocks in it, so that nothing ever looks at the
 * back of a surface; what a back sends out is nobody's business. Only surface that can be seen is
 * sampled.
 */
#ifndef MESH_SCENES_H
#define MESH_SCENES_H

#include "glowworm.h"

typedef enum mesh_kind {
	MESH_CORNELL,  /* box open to one side, two blocks, a glowing rectangle in the ceiling */
	MESH_ROOMS,    /* two rooms joined by a door in a wall of 10 cm, one lamp */
	MESH_CORRIDOR, /* a corridor 1 m wide with two bends, the lamp at one end */
	MESH_HOLE,     /* a room lit by sun and sky through a hole in its ceiling */
	MESH_RUIN,     /* broken walls in the open, sun and sky */
	MESH_CAVE,     /* a closed rough surface, a lamp and a spot */
	MESH_BALL,     /* a ball on a floor in the open, sun and sky */
	MESH_CARTON,   /* a turned box on a floor, a lamp */
	MESH_TORUS,    /* a ring that lies on a floor under an even sky */
	MESH_TERRAIN,  /* hills with a house, sun and sky */
	MESH_FENCE,    /* wires of 5 mm between posts, a low wall behind, sun and sky */
	MESH_TREE,     /* trunk, branches and leaves over a floor, sun and sky */
	MESH_KINDS
} mesh_kind;

/* One flat piece of surface, seen from the side to which its normal points. */
typedef struct mesh_triangle {
	double corner[3][3]; /* metres, counterclockwise about the normal */
	double normal[3];    /* unit length */
	double area;         /* m^2 */
	uint8_t color[3];    /* sRGB-encoded albedo */
	float albedo[3];     /* the same, linear */
	float emission[3];   /* radiance */
} mesh_triangle;

/* A block with a vertical axis; surface within it is not sampled. */
typedef struct mesh_solid {
	double centre[3], half[3]; /* metres */
	double cosine, sine;       /* of its turn about the vertical */
} mesh_solid;

/* A rectangle through which all sky enters; none when its area is 0. */
typedef struct mesh_opening {
	double corner[3], u[3], v[3], normal[3]; /* the normal points inwards */
	double area;
} mesh_opening;

#define MESH_SOLIDS 16
#define MESH_LIGHTS 4
#define MESH_STATIONS 5

typedef struct mesh_scene {
	mesh_triangle *triangle; /* owned; count */
	size_t count;
	mesh_solid solid[MESH_SOLIDS];
	size_t solid_count;
	mesh_opening opening;
	double low[3], high[3]; /* surface outside is not sampled */
	gw_light light[MESH_LIGHTS];
	size_t light_count;
	double station[MESH_STATIONS][3]; /* where scanners would stand */
	size_t station_count;
} mesh_scene;

/* The name of a kind ("cornell"), or NULL behind the last. */
const char *mesh_kind_name(int kind);

/* Makes a scene, freed with mesh_scene_clear. GW_ERROR_MEMORY. */
gw_status mesh_scene_make(mesh_kind kind, mesh_scene *scene, gw_error *error);
void mesh_scene_clear(mesh_scene *scene);

/* How to sample points. */
typedef struct mesh_sampling {
	size_t count;
	bool even;           /* on each triangle along a low-discrepancy sequence, else independent */
	double noise;        /* standard deviation along the normal, in spacings */
	double normal_noise; /* standard deviation of each normal's turn about two axes, degrees */
	double uneven;       /* densest over sparsest, as from a scanner amid the scene, or 0 */
	uint64_t seed;
} mesh_sampling;

/* Points of a scene, all arrays owned. */
typedef struct mesh_points {
	size_t count;
	double *position;   /* 3 * count, metres, with noise */
	float *normal;      /* 3 * count, unit, with noise */
	double *surface;    /* 3 * count, the place on the triangle, without noise */
	uint32_t *triangle; /* count, the triangle that each is on */
	double spacing;     /* root of the area that each point stands for, metres */
} mesh_points;

/* Samples the visible surface, the same number of points on each unit of area unless uneven; freed
 * with mesh_points_clear. GW_ERROR_MEMORY. */
gw_status mesh_points_make(const mesh_scene *scene, const mesh_sampling *sampling,
						   mesh_points *points, gw_error *error);
void mesh_points_clear(mesh_points *points);

#endif

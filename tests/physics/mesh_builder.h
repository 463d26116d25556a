/*
 * mesh_builder.h - what those share that build scenes of triangles: mesh_scenes.c has the rooms and
 * thing_scenes.c what is seen from outside.
 */
#ifndef MESH_BUILDER_H
#define MESH_BUILDER_H

#include "mesh_scenes.h"

/* A scene under construction; the first failure is kept. */
typedef struct mesh_builder {
	mesh_scene *scene;
	bool failed;
	uint8_t color[3]; /* of what is added next */
	float emission[3];
} mesh_builder;

void mesh_set_color(mesh_builder *b, int red, int green, int blue);

/* Counterclockwise about the normal, as seen from the side that is seen. */
void mesh_add_triangle(mesh_builder *b, const double p[3], const double q[3], const double r[3]);

/* A parallelogram whose normal is along u x v. */
void mesh_add_patch(mesh_builder *b, const double corner[3], const double u[3], const double v[3]);

/* One side of a box from `low` to `high`, seen from inside; side: 0 to 5 for -x +x -y +y -z +z. */
void mesh_add_side(mesh_builder *b, const double low[3], const double high[3], int side);

/* A solid block, seen from outside, turned about the vertical; it hides surface within it. */
void mesh_add_solid(mesh_builder *b, const double centre[3], const double half[3], double turn);

gw_light *mesh_add_light(mesh_builder *b, gw_light_type type);

/* Where scanners would stand; at most MESH_STATIONS. */
void mesh_set_stations(mesh_builder *b, const double (*place)[3], size_t count);

void mesh_set_color3(float to[3], float x, float y, float z);
void mesh_set_place(double to[3], double x, double y, double z);

/* Smooth noise in [-1, 1]: random values on a lattice, interpolated by smoothstep. */
double mesh_smooth_noise(const double p[3]);

void mesh_make_ball(mesh_builder *b);
void mesh_make_carton(mesh_builder *b);
void mesh_make_torus(mesh_builder *b);
void mesh_make_terrain(mesh_builder *b);
void mesh_make_fence(mesh_builder *b);
void mesh_make_tree(mesh_builder *b);

#endif

/*
 * hard_cloud.h - point clouds that are hard to light, made from a case's random numbers.
 *
 * A cloud begins as a shape of a size near 1 about the origin; what makes it hard is done to it
 * afterwards. Values are kept as doubles and written as PLY with double coordinates, so that no
 * step rounds what the next one needs.
 */
#ifndef HARD_CLOUD_H
#define HARD_CLOUD_H

#include "torture_case.h"

typedef struct hard_point {
	double at[3], normal[3], albedo[3], emission[3];
} hard_point;

typedef struct hard_cloud {
	hard_point *point; /* owned */
	size_t count, capacity;
	bool has_normals, has_emission;
} hard_cloud;

typedef enum hard_shape {
	SPHERE, /* closed, radius 1, normals inward */
	BALL,   /* the same, normals outward */
	ROOM,   /* the six walls of a cube of side 2, normals inward */
	PLANE,  /* a square of side 2, normal up */
	SHEETS, /* two squares, one above the other, facing each other */
	HILLS,  /* a wavy floor */
	TUBE,   /* a bent corridor */
	CROWD,  /* points all over a cube, random normals */
	SHAPE_COUNT
} hard_shape;

const char *hard_shape_name(hard_shape shape);
bool hard_shape_is_closed(hard_shape shape);

/* Adds points of a shape, albedo 0.5. */
void hard_cloud_add(torture_case *c, hard_cloud *cloud, hard_shape shape, size_t count);

/* Adds one point. */
hard_point *hard_cloud_push(hard_cloud *cloud);

/* Sets albedo, or emission, of all points. */
void hard_cloud_albedo(hard_cloud *cloud, double albedo);
void hard_cloud_emission(hard_cloud *cloud, double emission);

/* Turns all points and normals about a random axis. */
void hard_cloud_turn(torture_case *c, hard_cloud *cloud);

/* x -> scale * x + shift */
void hard_cloud_place(hard_cloud *cloud, double scale, const double shift[3]);

/* Puts random numbers on all coordinates, of that standard deviation. */
void hard_cloud_shake(torture_case *c, hard_cloud *cloud, double deviation);

/* Shuffles the points. */
void hard_cloud_shuffle(torture_case *c, hard_cloud *cloud);

/* Writes it into the case's folder. */
void hard_cloud_write(const torture_case *c, const hard_cloud *cloud, const char *name);

void hard_cloud_clear(hard_cloud *cloud);

#endif

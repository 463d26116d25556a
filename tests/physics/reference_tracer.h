/*
 * reference_tracer.h - the light on triangles by path tracing: an answer that shares nothing with
 * the library that it is held against.
 *
 * Rays go through Embree against the triangles themselves. Every vertex of a path aims at all
 * lamps, at one place of the emitters, and at one place of the surface that these light, in
 * proportion to how much; what is both aimed at and met by chance is weighed by the balance
 * heuristic (Veach 1997), and paths end by Russian roulette. So the estimate has noise but no bias.
 * Directions come from scrambled Sobol points (Burley 2020). A point's samples are split into
 * batches that are independent of each other; their spread is the standard error.
 *
 * Surfaces are seen from the side of their normals; their backs are black.
 */
#ifndef REFERENCE_TRACER_H
#define REFERENCE_TRACER_H

#include "mesh_scenes.h"

typedef struct reference_tracer reference_tracer;

/* Batches a point; their spread has this many degrees of freedom less one. */
#define REFERENCE_BATCHES 16u

/* What arrives at one point. */
typedef struct reference_light {
	double direct[3];   /* irradiance straight from lamps, emitters and sky, W/m^2 */
	double indirect[3]; /* irradiance that was reflected before */
	double error;       /* standard error of the luminance of albedo / pi * both, W/(sr m^2) */
} reference_light;

/* The tracer of a scene, which must live as long; ended by reference_tracer_destroy.
 * GW_ERROR_INTERNAL when Embree fails. */
gw_status reference_tracer_create(const mesh_scene *scene, reference_tracer **tracer,
								  gw_error *error);
void reference_tracer_destroy(reference_tracer **tracer);

/* Places on the surface, and how their light is to be found. */
typedef struct reference_places {
	const double *surface;    /* 3 * count, metres */
	const uint32_t *triangle; /* count, the triangle that each is on */
	size_t count;
	uint32_t
		paths; /* of each batch, rounded up to a power of two; REFERENCE_BATCHES as many in all */
	uint32_t threads; /* 0 means one a processor; the result is the same for any number */
	uint64_t seed;
	void (*shown)(double done); /* NULL, or called now and then with the share that is done */
} reference_places;

/* Light at places on the surface; light receives places->count answers. */
void reference_tracer_light(const reference_tracer *tracer, const reference_places *places,
							reference_light *light);

/* The triangle that a ray meets first, from either side, and how far off in lengths of `direction`;
 * false when none. Thread-safe. */
bool reference_tracer_hit(const reference_tracer *tracer, const double origin[3],
						  const double direction[3], uint32_t *triangle, double *distance);

#endif

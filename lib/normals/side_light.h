/*
 * side_light.h - how much light falls on either side of patches of surface, where nobody knows yet
 * which side is their front. Internal to lib/.
 *
 * Of a patch of surface only one side was scanned, as a rule, and only one is looked at: the outer
 * one of a thing, the inner one of a room. Light tells which: the back of a scanned surface looks
 * into what is solid, where no light gets. So light is let in from the lamps, the sun, the sky and
 * what emits, roughly, on both sides of everything: rays from some thousand places on the patches
 * against some ten thousand discs, and a few reflections between the places.
 *
 * One case is left in which light says the wrong thing: a room with windows is brighter on the
 * outside. There, what looks into a space that is closed nearly all around and large enough for a
 * scanner to stand in has its light multiplied, the more, the smaller its openings are. The sky
 * shines from above the horizon alone here, since ground goes on beyond what was scanned; and a
 * little light comes from wherever nothing was scanned, since what is open can be seen even where
 * the lamps of this bake do not reach.
 *
 * Source: sides told apart by what rays from them see, as for the faces of meshes by Takayama et
 * al., A Simple Method for Correcting Facet Orientations in Polygon Meshes Based on Ray Casting,
 * JCGT 3(4), 2014.
 */
#ifndef SIDE_LIGHT_H
#define SIDE_LIGHT_H

#include "cloud/surfels.h"

/* Patches of surface: of each, the normals have one sign that is open. */
typedef struct gw_patches {
	const uint32_t *patch_of; /* a surfel's patch */
	const uint8_t *opposite; /* a surfel's: 1 where its normal is against the others of its patch */
	const float *area;       /* a surfel's, m^2, rough */
	size_t count;            /* of patches */
	const double *scanner;   /* 3 * scanner_count, metres as surfels->position: where some stood */
	size_t scanner_count;
} gw_patches;

/* What rays from one side of a surface found, as sums over places, each times its area. */
typedef struct gw_side_view {
	double light;     /* irradiance, luminance, in a unit that is the same for all */
	double first;     /* of that, what was not reflected before, at places that may be in a room */
	double shone;     /* m^2 that lamps or what emits shine on, whatever light is asked about */
	double lit;       /* irradiance straight from lamps, sun, sky and what emits */
	double seen;      /* m^2 that a scanner sees, which none sees from the other side */
	double area;      /* m^2 */
	double met;       /* share of the rays that met surface */
	double path;      /* logarithm of how far away, metres, of these */
	double dark_path; /* metres to what does not emit, and 0 for rays that meet no such surface */
	double down, down_met; /* share of the rays that go down, and that meet surface there */
} gw_side_view;

/* The side that a patch's normals point to, then the other one; 0 where nothing is known. */
typedef struct gw_side_light {
	gw_side_view side[2];
} gw_side_light;

/* A ray from one side of a patch that meets a side of another one, or of itself. */
typedef struct gw_side_sight {
	uint32_t from, to; /* twice the patch, plus 1 for the side that its normals do not point to */
	float area;        /* m^2, that it stands for */
	float path;        /* logarithm of its length, metres */
} gw_side_sight;

/* What is found: of light and by_sky patches->count each. */
typedef struct gw_side_lights {
	gw_side_light *light;  /* receives the light that there is */
	gw_side_light *by_sky; /* receives the same as if an even sky shone alone; or NULL */
	gw_side_sight *sights; /* receives what rays meet; to be freed by the caller, on failure too */
	size_t sight_count;
} gw_side_lights;

/* By what the light on one side of a surface, of as much as hangs together, is to be multiplied
 * because it may be a room's: 1 or more. */
double gw_side_factor(const gw_side_view *side);

/*
 * Finds the light on both sides of every patch.
 *   options   its lights, threads and what asks whether to stop. Without any light, and where
 *             nothing emits, the sky shines
 *   surfels   position, normal and emission of all
 *   patches   with arrays of surfels->count elements
 *   found     receives the result
 * Fails with GW_ERROR_MEMORY or GW_ERROR_CANCELLED. The result does not depend on threads.
 */
gw_status gw_side_light_find(const gw_surfels_options *options, const gw_surfels *surfels,
							 const gw_patches *patches, gw_side_lights *found, gw_error *error);

/* Does nothing shine but a sky, which is taken as even here, or nothing at all? */
bool gw_side_light_is_sky(const gw_surfels_options *options, const gw_surfels *surfels);

#endif

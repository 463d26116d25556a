/*
 * lighting.h - one lighting of a scene: what depends on lamps, emission and sky.
 *
 * The steps, in this order:
 *
 *   plan -> direct light -> first gather -> bounces -> read back -> error
 *
 * They may be run again on the same scene with other lights: each step begins with dark buffers.
 * Steps after the direct light (lighting_steps.h, lighting_error.h) need the scene's records and
 * are to be left out unless plan.records.
 */
#ifndef LIGHTING_H
#define LIGHTING_H

#include "bake/plan.h"
#include "bake/scene.h"
#include "light/gap_light.h"

/* What gw_lighting of glowworm.h is. */
struct gw_lighting {
	gw_scene *scene;        /* not owned */
	const gw_light *lights; /* light_count, not owned */
	size_t light_count;
	gw_plan plan;
	/* NULL, or this is a part of that lighting: all that depends on how much light there is, is
	 * done as there, so that the parts add up to the whole but for roundings. */
	const gw_lighting *whole;
	bool kept;                /* parts will follow: keep what they need */
	gw_emitters patches;      /* of the kept: the lit facets, and */
	gw_buffer patch_radiance; /* what they reflect first */
	bool patches_sampled;     /* whether they were sampled */
	gw_emitters emitters;     /* the facets that emit */
	gw_sky_map map;           /* of the environment light that has one */
	bool map_made;
	gw_light_given *given; /* light_count: flux of each lamp in place of its share; NULL of parts */
	gw_buffer surfel_direct; /* vec4 a surfel: irradiance from lamps */
	gw_buffer surfel_turned; /* the same with normals that are off, where an estimate needs it */
	float *surfel_first, *surfel_indirect; /* 4 a surfel, on the CPU */
	uint32_t *shown; /* NULL, or one a surfel: that whose light is written, its own or its back's */
	gw_buffer facet_direct, facet_radiance; /* vec4 a facet; the latter while light is gathered */
	gw_gap_sight *gap;                      /* one a record, or NULL: what it sees through gaps */
	const float *carried; /* NULL, or 4 a surfel, not owned: a guess at surfel_indirect, with which
							 bounces by rays begin */
	gw_light *own_lights; /* NULL, or lights, owned: of lightings that are kept (handles.c) */
	uint64_t emissions;   /* of the scene, when these were lit last */
};

/* Decides which effects these lights call for, and writes it into the scene's report. */
void gw_lighting_plan(gw_lighting *lighting);

/* Decides the same as the whole for a part: for these lights, and the emission of points or not. */
void gw_lighting_plan_part(gw_lighting *part, bool emission);

/* What is known of the lights before they shine, into given. */
gw_status gw_lighting_list_lights(gw_lighting *lighting, gw_error *error);

/* Light of lamps at every surfel and facet. */
gw_status gw_lighting_direct(gw_lighting *lighting, gw_error *error);

/* Of surface that has surfels of both sides: that of the brighter side is shown. Of a part of a
 * lighting what is shown is as of the whole. */
gw_status gw_lighting_choose_sides(gw_lighting *lighting, gw_error *error);
uint32_t gw_lighting_shown(const gw_lighting *lighting, uint32_t surfel);

/* A buffer of `count` dark vec4, made when there is none yet. */
gw_status gw_lighting_darken(gw_lighting *lighting, gw_buffer_kind kind, uint64_t count,
							 const char *name, gw_buffer *buffer, gw_error *error);

/* What is at a buffer, 4 floats a surfel, such as the lamps' light; no bytes where there is no
 * buffer, as where no lamp shines. On success to be closed by the caller, while the buffer is. */
gw_status gw_lighting_view(const gw_lighting *lighting, const gw_buffer *buffer, gw_view *view,
						   gw_error *error);

/* Forget the map of the sky, when another is to take its place; what was gathered; all light.
 * Before the scene drops the records, or the octree. */
void gw_lighting_drop_map(gw_lighting *lighting);
void gw_lighting_drop_gathered(gw_lighting *lighting);
void gw_lighting_clear(gw_lighting *lighting);

#endif

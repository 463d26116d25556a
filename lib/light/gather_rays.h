/*
 * gather_rays.h - trace step by rays (Salm 4.4.3, the ray-based variant on the leaf level): each
 * record sends rays against the planes in the leaves once; the hits stay and every bounce is a
 * sparse product over them.
 */
#ifndef GATHER_RAYS_H
#define GATHER_RAYS_H

#include "light/emitters.h"
#include "light/portals.h"
#include "light/records.h"
#include "light/sky_map.h"

typedef struct gw_ray_gather {
	uint32_t rays; /* a record */
	uint32_t seed;
	gw_buffer facet;    /* R32_UINT, rays * records: what each ray hit, GW_NONE for nothing */
	gw_buffer distance; /* R32_SFLOAT, likewise, leaf cells */
	gw_buffer through;  /* R32_UINT, a record: which samples of the portals leave the
						   scene; empty until a sky shines in by portals */
	uint32_t shut_out;  /* records whose hits were held against the compartments of empty space */
} gw_ray_gather;

/* Makes room for the hits of `rays` rays from every record. */
gw_status gw_ray_gather_create(gw_gpu *gpu, const gw_records *records, uint32_t rays, uint32_t seed,
							   gw_ray_gather *gather, gw_error *error);

/* Traces `rays` rays from every record. */
gw_status gw_ray_gather_trace(const gw_record_context *on, uint32_t rays, uint32_t seed,
							  gw_ray_gather *gather, gw_error *error);
void gw_ray_gather_destroy(gw_gpu *gpu, gw_ray_gather *gather);

/* Turns hits on surface that rock keeps apart from their records to what sends out no light (see
 * shut_out.h), unless that is done. Light is the same in whatever order lamps are lit only if it is
 * done before the first. */
gw_status gw_ray_gather_shut_out(const gw_record_context *on, gw_ray_gather *gather,
								 gw_error *error);

/* Traces rays from further records, as many from each, and keeps their hits behind the others.
 *   on    the further records alone
 *   own   receives these hits alone, to be destroyed by the caller, also on failure */
gw_status gw_ray_gather_add(const gw_record_context *on, gw_ray_gather *gather, gw_ray_gather *own,
							gw_error *error);

/* Samples the portals from every record, into gather->through, unless that is there. */
gw_status gw_ray_gather_open(const gw_record_context *on, const gw_portals *portals,
							 gw_ray_gather *gather, gw_error *error);

/* The same from further records, whose hits alone are *own, behind the others; on has these alone.
 */
gw_status gw_ray_gather_open_further(const gw_record_context *on, const gw_portals *portals,
									 gw_ray_gather *gather, gw_ray_gather *own, gw_error *error);

/* What a sampled gather looks for. */
typedef struct gw_sampled_sources {
	const gw_emitters *emitters; /* sampled, where they send out light; count may be 0 */
	const gw_buffer *part;       /* NULL, or what is gathered in place of emitters->radiance, by the
									same samples: of a part of the light, at most as large */
	uint32_t samples;            /* of them, a record; 0: only hits count */
	bool use_hits;         /* emitters that the rays hit count as well, combined with the samples by
							  multiple    importance sampling */
	const float *sky;      /* 3, radiance seen by rays that leave the scene */
	const gw_sky_map *map; /* NULL or without width: none. With map_hits, rays that leave the scene
							  see it too, combined likewise */
	uint32_t map_samples;
	bool map_hits;
	const gw_portals *portals; /* NULL, or those to the sky, sampled by gather->through */
	bool looked;               /* what is nearest and which are buried is known already */
	uint32_t seed;             /* of the samples */
	gw_buffer *kept; /* NULL, or where what emitters brought is left for another time: vec4 a
						record. A buffer that exists is taken in place of their samples and hits */
	/* NULL, or receives the irradiance's moment: how it changes where normals turn, 2 vec4 a record
	 * (record_moment.glsl); and where that of emitters is left, if kept is not NULL. */
	gw_buffer *moment, *kept_moment;
} gw_sampled_sources;

struct gw_record_push;

/* Puts the map of the sky, if there is one, into what its passes are given. */
void gw_sampled_map_push(const gw_sampled_sources *sources, struct gw_record_push *push);

/*
 * Irradiance that reaches the records straight from emitters and sky; unless sources->looked also
 * finds the distance to the nearest thing each record saw, into position w, and which are buried,
 * into normal w.
 *   irradiance   receives it, records->count vec4
 */
gw_status gw_ray_gather_sampled(const gw_record_context *on, const gw_ray_gather *gather,
								const gw_sampled_sources *sources, gw_buffer *irradiance,
								gw_error *error);

/* Gathers what emitters bring to further records, whose hits alone are *own, and keeps it behind
 * *sources->kept, which exists, and its moment likewise; on has these records alone. */
gw_status gw_ray_gather_sample_further(const gw_record_context *on, const gw_ray_gather *own,
									   const gw_sampled_sources *sources, gw_error *error);

/* Finds these two alone; leaves records->first dark. */
gw_status gw_ray_gather_look(const gw_record_context *on, const gw_ray_gather *gather,
							 gw_error *error);

/* One bounce: irradiance from what the rays hit, into records->gathered. */
gw_status gw_ray_gather_bounce(gw_passes *passes, const gw_ray_gather *gather,
							   const gw_buffer *facet_radiance, gw_records *records,
							   gw_error *error);

/* Adds the moment of what a bounce by these rays gathers to `moment`, 2 vec4 a record. on: the
 * records that were traced. */
gw_status gw_ray_gather_moments(const gw_record_context *on, const gw_ray_gather *gather,
								const gw_buffer *facet_radiance, gw_buffer *moment,
								gw_error *error);

/* Adds `count` vec4 of one buffer to those of another, or takes them off. */
gw_status gw_light_add(gw_passes *passes, const gw_buffer *from, gw_buffer *to, uint64_t count,
					   gw_error *error);
gw_status gw_light_take(gw_passes *passes, const gw_buffer *from, gw_buffer *to, uint64_t count,
						gw_error *error);

#endif

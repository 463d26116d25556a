/*
 * bounces.h - progressive bounces over records: what light does between the first reflection and
 * the last one that matters. The trace step is exchangeable (rays or cones).
 */
#ifndef BOUNCES_H
#define BOUNCES_H

#include "light/gather_cones.h"
#include "light/gather_rays.h"

/* One trace step: fills records->gathered from the facets' radiance. largest is its largest
 * component. gather_first, or NULL, takes its place for the first reflection, of light that lamps
 * and emitters may have thrown on a few small patches. gather_apart, or NULL, takes its place where
 * what is gathered is no light. hits, or NULL, is what gather follows. */
typedef struct gw_trace_step {
	gw_status (*gather)(void *self, const gw_buffer *facet_radiance, float largest,
						gw_error *error);
	gw_status (*gather_first)(void *self, const gw_buffer *facet_radiance, float largest,
							  gw_error *error);
	gw_status (*gather_apart)(void *self, const gw_buffer *facet_radiance, float largest,
							  gw_error *error);
	const gw_ray_gather *hits;
	void *self;
} gw_trace_step;

typedef struct gw_bounces {
	gw_bounce
		*bounce; /* allocated; bounce_count entries, the first is the reflection of direct light */
	uint32_t bounce_count;
	double remaining;   /* bound on the light of bounces left out, relative to the light found */
	double contraction; /* largest share of irradiance that a further bounce can keep anywhere */
} gw_bounces;

typedef struct gw_bounces_task {
	gw_record_context on;
	/* Irradiance of the facets from point, spot and sun lights; of no handle where there is none.
	 */
	const gw_buffer *facet_direct;
	gw_buffer *facet_radiance; /* texel buffer, facet_count vec4: work space */
	gw_trace_step step;
	const gw_buffer *carried; /* NULL, or a guess at the facets' reflected irradiance, with which
								 bounces that follow the tolerance begin. For trace steps that bear
								 radiance below 0 */
	uint32_t limit;           /* reflections, GW_BOUNCES_AUTO: until tolerance */
	float tolerance;
	bool no_bound;      /* what is left out is not to be bounded: no contraction */
	bool lit_elsewhere; /* most of what is reflected first is far off, and its light is known: what
						   bounces leave out is held against what they gather alone */
	bool (*cancelled)(void *user);
	void *user;
} gw_bounces_task;

/*
 * Reflects light until the limit or the tolerance. On entry records->first holds what came
 * unreflected; on return records->indirect holds all that was reflected at least once.
 *   bounces   on success its array is owned by the caller
 */
gw_status gw_bounces_run(const gw_bounces_task *task, gw_bounces *bounces, gw_error *error);

/* Radiance that the facets reflect of irradiance `records_irradiance` and of direct_share times
 * facet_direct. */
gw_status gw_facets_shade(const gw_record_context *on, const gw_buffer *records_irradiance,
						  const gw_buffer *facet_direct, float direct_share,
						  gw_buffer *facet_radiance, gw_error *error);

#endif

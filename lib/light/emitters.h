/*
 * emitters.h - facets that send out light, ready to be sampled by their power: those that emit, and
 * those that lamps light brightly.
 */
#ifndef EMITTERS_H
#define EMITTERS_H

#include "octree/octree_bindings.h"

typedef struct gw_emitters {
	const gw_buffer *radiance; /* of the facets: not owned, outlives the emitters */
	uint32_t count;            /* facets that send out light */
	float power;               /* sum of luminance(L) * area, leaf cells^2 */
	double area_share;         /* of the whole surface, 0..1 */
	double evenness; /* share of the whole surface that, glowing evenly, would be as easily
						missed by rays: (sum L a)^2 / (sum L^2 a sum a), 0..1 */
	gw_buffer table; /* R32G32B32A32_UINT, count rows: facet, alias row, probability (float bits),
						mark of its compartment (alias method, Walker 1977, Vose 1991) */
} gw_emitters;

/* Lists the facets of an octree that send out light; count is 0 and the table empty when none does.
 *   radiance   texel buffer, vec4 a facet; smaller than that: nothing emits
 *   always     whether the table is made even when they are not small, as below */
gw_status gw_emitters_make(gw_gpu *gpu, const gw_octree *octree, const gw_buffer *radiance,
						   bool always, gw_emitters *emitters, gw_error *error);

/* Whether gather rays would rather miss them: 64 rays find a tenth of the surface with an error of
 * about 40 %, and less of it with more. Samples of more than that are spent better on rays,
 * because much of such light is out of sight. */
static inline bool gw_emitters_are_small(const gw_emitters *emitters)
{
	return emitters->count > 0 && emitters->evenness < 0.09;
}

/* Whether so much glows that gather rays find all they need. Samples of what lies near on a curved
 * surface end at what is in between, so that with them a glowing sphere is up to 2 % too dark. */
static inline bool gw_emitters_are_everywhere(const gw_emitters *emitters)
{
	return emitters->evenness > 0.5;
}

void gw_emitters_destroy(gw_gpu *gpu, gw_emitters *emitters);

#endif

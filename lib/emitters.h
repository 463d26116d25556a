/*
 * emitters.h - the lobes that emit, ready to be sampled by their power.
 */
#ifndef EMITTERS_H
#define EMITTERS_H

#include "passes.h"

typedef struct gw_emitters {
	uint32_t count;    /* lobes that emit */
	float power;       /* sum of luminance(Le) * area, leaf cells^2 */
	double area_share; /* of the whole surface, 0..1 */
	gw_buffer table; /* R32G32B32A32_UINT, count rows: lobe, alias row, probability (float bits), 0
						(alias method, Walker 1977, Vose 1991) */
} gw_emitters;

/* Lists the emitting lobes of an octree; count is 0 and the table empty when nothing emits. */
gw_status gw_emitters_make(gw_gpu *gpu, const gw_octree *octree, gw_emitters *emitters,
						   gw_error *error);
void gw_emitters_destroy(gw_gpu *gpu, gw_emitters *emitters);

#endif

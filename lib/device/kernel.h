/*
 * kernel.h - passes as functions of the processor: the texts of shaders/ compiled as C++, by
 * kernel.cpp.
 *
 * A kernel does what its pass does, on the same buffers, but for roundings of the device's own sine
 * or root. Buffers have to lie in memory of the processor (gw_gpu_shares_memory).
 */
#ifndef KERNEL_H
#define KERNEL_H

#include "device/gpu.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What one run has. */
typedef struct gw_kernel_input {
	const gw_binding *bindings; /* windows begin at element 0 */
	const uint32_t *constant;   /* specialisation constants 1, 2, ... */
	const void *push;           /* `first` of its span is 0, `count` above every element */
	const uint32_t *element;    /* which elements are run, or NULL: all */
} gw_kernel_input;

/* Runs the pass over elements first to last - 1, or over element[first] to element[last - 1].
 * Thread-safe. */
typedef void gw_kernel(const gw_kernel_input *run, size_t first, size_t last);

gw_kernel gw_kernel_prefix_sum, gw_kernel_light_visibility, gw_kernel_light_irradiance,
	gw_kernel_facet_direct, gw_kernel_record_rays, gw_kernel_record_again,
	gw_kernel_record_emitters, gw_kernel_record_sky, gw_kernel_record_portals,
	gw_kernel_portal_light, gw_kernel_record_first, gw_kernel_record_gather,
	gw_kernel_record_moments, gw_kernel_record_share, gw_kernel_record_add, gw_kernel_facet_weights,
	gw_kernel_facet_shade, gw_kernel_read_back, gw_kernel_volume_rays, gw_kernel_volume_fill,
	gw_kernel_volume_weights, gw_kernel_volume_read, gw_kernel_volume_faces,
	gw_kernel_volume_inject, gw_kernel_volume_spread, gw_kernel_probe_sight, gw_kernel_probe_rays,
	gw_kernel_cache_rays, gw_kernel_cache_mips, gw_kernel_pixel_caches, gw_kernel_given_rays;

#ifdef __cplusplus
}
#endif

#endif

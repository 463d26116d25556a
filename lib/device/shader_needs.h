/*
 * shader_needs.h - what shaders ask of a device, read from their words (SPIR-V 1.5).
 */
#ifndef SHADER_NEEDS_H
#define SHADER_NEEDS_H

#include "device/gpu.h"

typedef struct gw_shader_needs {
	uint32_t storage_buffers;
	uint32_t sampled; /* texel buffers and sampled images */
	uint32_t storage_images;
	uint32_t resources; /* all of these */
} gw_shader_needs;

/* Of one shader. */
gw_shader_needs gw_shader_needs_of(const gw_shader *shader);

/* Of all that bakes run, the most of each; those of tests do not count. */
gw_shader_needs gw_shader_needs_most(void);

#endif

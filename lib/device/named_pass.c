/*
 * named_pass.c - passes by name; see named_pass.h.
 */
#include "device/named_pass.h"

#include <assert.h>

#define BINDINGS_MAX 32u

gw_status gw_named_pass_create(gw_gpu *gpu, const char *shader, const char *bindings,
							   uint32_t push_bytes, uint32_t loop_bound, gw_pass **pass,
							   gw_error *error)
{
	const gw_shader *code = gw_shader_find(shader);
	gw_binding_kind kind[BINDINGS_MAX];
	uint32_t count = 0;
	for (; bindings[count] != '\0'; count++) {
		assert(count < BINDINGS_MAX && (bindings[count] == 'S' || bindings[count] == 'T'));
		kind[count] = bindings[count] == 'S' ? GW_BIND_STORAGE : GW_BIND_TEXEL;
	}
	gw_pass_description description = {
		.name = code->name,
		.spirv = code->spirv,
		.spirv_words = code->words,
		.bindings = kind,
		.binding_count = count,
		.push_bytes = push_bytes,
		.loop_bound = loop_bound,
	};
	*pass = NULL;
	return gw_pass_create(gpu, &description, pass, error);
}

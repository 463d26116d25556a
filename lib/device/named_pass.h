/*
 * named_pass.h - passes made from a shader's name and its bindings in short.
 */
#ifndef NAMED_PASS_H
#define NAMED_PASS_H

#include "device/gpu.h"

/* Returns from the calling function when a call of ours did not succeed. */
#ifndef GW_TRY
#define GW_TRY(call)                                                                               \
	do {                                                                                           \
		gw_status gw_status_ = (call);                                                             \
		if (gw_status_ != GW_OK)                                                                   \
			return gw_status_;                                                                     \
	} while (0)
#endif

/*
 * Makes the pass of a shader that has no specialisation constants but its workgroup's size.
 *   shader      "NAME" of shaders/NAME.comp; it is the pass's name, too
 *   bindings    one letter each: S storage buffer, T texel buffer; at most 32
 *   push_bytes  as of gw_pass_description
 *   loop_bound  likewise
 *   pass        to be destroyed with gw_pass_destroy; NULL on failure
 * Fails as gw_pass_create.
 */
gw_status gw_named_pass_create(gw_gpu *gpu, const char *shader, const char *bindings,
							   uint32_t push_bytes, uint32_t loop_bound, gw_pass **pass,
							   gw_error *error);

#endif

/* gpu_result.c - what calls of Vulkan return, as sentences. */
#include "device/gpu_internal.h"

#include <stdio.h>
#include <string.h>

const char *gw_vulkan_result_name(VkResult result)
{
#define NAME(r)                                                                                    \
	case r:                                                                                        \
		return #r
	switch (result) {
		NAME(VK_SUCCESS);
		NAME(VK_NOT_READY);
		NAME(VK_TIMEOUT);
		NAME(VK_INCOMPLETE);
		NAME(VK_ERROR_OUT_OF_HOST_MEMORY);
		NAME(VK_ERROR_OUT_OF_DEVICE_MEMORY);
		NAME(VK_ERROR_INITIALIZATION_FAILED);
		NAME(VK_ERROR_DEVICE_LOST);
		NAME(VK_ERROR_MEMORY_MAP_FAILED);
		NAME(VK_ERROR_LAYER_NOT_PRESENT);
		NAME(VK_ERROR_EXTENSION_NOT_PRESENT);
		NAME(VK_ERROR_FEATURE_NOT_PRESENT);
		NAME(VK_ERROR_INCOMPATIBLE_DRIVER);
		NAME(VK_ERROR_TOO_MANY_OBJECTS);
		NAME(VK_ERROR_FORMAT_NOT_SUPPORTED);
		NAME(VK_ERROR_FRAGMENTED_POOL);
		NAME(VK_ERROR_UNKNOWN);
		NAME(VK_ERROR_OUT_OF_POOL_MEMORY);
		NAME(VK_ERROR_FRAGMENTATION);
		NAME(VK_ERROR_INVALID_SHADER_NV);
	default:
		return "a result without a name";
	}
#undef NAME
}

static gw_status class_of(VkResult result)
{
	switch (result) {
	case VK_ERROR_OUT_OF_HOST_MEMORY:
	case VK_ERROR_OUT_OF_DEVICE_MEMORY:
	case VK_ERROR_OUT_OF_POOL_MEMORY:
	case VK_ERROR_FRAGMENTED_POOL:
	case VK_ERROR_FRAGMENTATION:
	case VK_ERROR_TOO_MANY_OBJECTS:
	case VK_ERROR_MEMORY_MAP_FAILED:
		return GW_ERROR_MEMORY;
	default:
		return GW_ERROR_INTERNAL;
	}
}

gw_status gw_vulkan_fail(gw_gpu *gpu, gw_error *error, const char *call, const char *what,
						 VkResult result)
{
	int length = (int)strcspn(call, "(");
	if (gpu != NULL && result == VK_ERROR_DEVICE_LOST && !gpu->lost) {
		gpu->lost = true;
		snprintf(gpu->lost_text, sizeof gpu->lost_text,
				 "the device \"%s\" was lost in %.*s for %s: the driver reset it, often because "
				 "one piece of work took too long; run again, or choose another device",
				 gpu->device.info.name, length, call, what);
	}
	if (gpu != NULL && gpu->lost)
		return gw_fail(error, GW_ERROR_INTERNAL, "%s", gpu->lost_text);
	gw_status status = class_of(result);
	return gw_fail(error, status, "%.*s for %s failed: %s%s", length, call, what,
				   gw_vulkan_result_name(result),
				   status == GW_ERROR_MEMORY ? "; free memory, or give the bake less to do" : "");
}

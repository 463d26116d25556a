/* gpu_limits.c - what a device has to have. */
#include "device/gpu_internal.h"
#include "device/shader_needs.h"

#include <string.h>

/*
 * A million points make some 16 fragments each. They are listed in words of 4 bytes, which have to
 * be bound as a whole, once as a storage buffer and once as a texel buffer.
 */
#define FRAGMENTS (UINT64_C(16) << 20)

/* Bricks of a level lie beside each other in an image of at most this side, at a million points. */
#define IMAGE_SIDE 256u

void gw_limits_list(const gw_candidate *device, gw_device_limit limit[GW_DEVICE_LIMITS])
{
	const VkPhysicalDeviceLimits *l = &device->properties.limits;
	gw_shader_needs needs = gw_shader_needs_most();
	uint32_t threads = l->maxComputeWorkGroupSize[0] < l->maxComputeWorkGroupInvocations
						   ? l->maxComputeWorkGroupSize[0]
						   : l->maxComputeWorkGroupInvocations;
	const gw_device_limit list[] = {
		{ "storage buffers", needs.storage_buffers, l->maxPerStageDescriptorStorageBuffers },
		{ "texel buffers, images", needs.sampled, l->maxPerStageDescriptorSampledImages },
		{ "storage images", needs.storage_images, l->maxPerStageDescriptorStorageImages },
		{ "resources", needs.resources, l->maxPerStageResources },
		{ "push constants, bytes", GW_PUSH_BYTES_MAX, l->maxPushConstantsSize },
		{ "threads of a workgroup", GW_WORKGROUP_SIZE, threads },
		{ "storage buffer, bytes", 4 * FRAGMENTS, l->maxStorageBufferRange },
		{ "texel buffer, texels", FRAGMENTS, l->maxTexelBufferElements },
		{ "3D image, side", IMAGE_SIDE, l->maxImageDimension3D },
	};
	_Static_assert(sizeof list == GW_DEVICE_LIMITS * sizeof *list, "all limits are listed");
	memcpy(limit, list, sizeof list);
}

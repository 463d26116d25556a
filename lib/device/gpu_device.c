/*
 * gpu_device.c - opening and closing a device, submissions, results, account.
 */
#include "device/gpu_internal.h"
#include "glowworm_host.h"
#include "base/memory.h"
#include "base/parallel.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A software driver starts no more of a kind, of which it has two, and two besides. */
#define DRIVER_THREADS 32u

/* Between two looks at whether it waits in vain. */
#define WAIT_NANOSECONDS UINT64_C(1000000000)

#define SLICE_SECONDS_DEFAULT 0.05

/* ------------------------------------------------------------------------------ results */

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

bool gw_gpu_stopped(gw_gpu *gpu)
{
	gpu->stopped = gpu->stopped || (gpu->cancelled != NULL && gpu->cancelled(gpu->user));
	return gpu->stopped;
}

void gw_gpu_resume(gw_gpu *gpu)
{
	gpu->stopped = false;
}

gw_status gw_gpu_check(gw_gpu *gpu, gw_error *error)
{
	if (gpu->lost)
		return gw_fail(error, GW_ERROR_INTERNAL, "%s", gpu->lost_text);
	if (gpu->stopped)
		return gw_fail(error, GW_ERROR_CANCELLED, "stopped in the middle of the work");
	gw_messages *messages = &gpu->messages;
	if (messages->count > messages->reported) {
		messages->reported = messages->count;
		return gw_fail(error, GW_ERROR_INTERNAL, "Vulkan validation: %.900s", messages->latest);
	}
	return GW_OK;
}

void gw_gpu_name(gw_gpu *gpu, VkObjectType type, uint64_t handle, const char *name)
{
	if (gpu->instance.set_name == NULL)
		return;
	VkDebugUtilsObjectNameInfoEXT info = {
		.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT,
		.objectType = type,
		.objectHandle = handle,
		.pObjectName = name,
	};
	/* A name that could not be set harms nothing. */
	(void)gpu->instance.set_name(gpu->handle, &info);
}

/* ------------------------------------------------------------------------------ opening */

/* Whether the device is the CPU and can use its memory as it lies. */
static bool can_import(const gw_candidate *device)
{
	uint32_t count = 0;
	bool found = false;
	if (device->properties.deviceType != VK_PHYSICAL_DEVICE_TYPE_CPU ||
		vkEnumerateDeviceExtensionProperties(device->handle, NULL, &count, NULL) != VK_SUCCESS)
		return false;
	VkExtensionProperties *list = gw_allocate_array(count, sizeof *list);
	if (list == NULL ||
		vkEnumerateDeviceExtensionProperties(device->handle, NULL, &count, list) != VK_SUCCESS)
		count = 0;
	for (uint32_t i = 0; i < count; i++)
		found |= strcmp(list[i].extensionName, VK_EXT_EXTERNAL_MEMORY_HOST_EXTENSION_NAME) == 0;
	free(list);
	return found;
}

/* Software drivers start threads without looking whether they run, and wait for them for ever. */
static gw_status check_threads(const gw_gpu *gpu, gw_error *error)
{
	uint32_t wanted = gw_thread_count(0), started;
	wanted = 2 * (wanted < DRIVER_THREADS ? wanted : DRIVER_THREADS) + 2;
	if (gpu->device.properties.deviceType != VK_PHYSICAL_DEVICE_TYPE_CPU)
		return GW_OK;
	started = gw_threads_startable(wanted);
	return started == wanted
			   ? GW_OK
			   : gw_fail(error, GW_ERROR_MEMORY,
						 "\"%s\" needs %u threads, and %u can be started: allow more (see ulimit "
						 "-u), or more memory",
						 gpu->device.info.name, wanted, started);
}

static gw_status create_device(gw_gpu *gpu, gw_error *error)
{
	GW_TRY(check_threads(gpu, error));
	static const char *const extension[] = { VK_EXT_EXTERNAL_MEMORY_HOST_EXTENSION_NAME };
	gpu->imports = can_import(&gpu->device);
	float priority = 1.0f;
	VkDeviceQueueCreateInfo queue = {
		.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
		.queueFamilyIndex = gpu->device.queue_family,
		.queueCount = 1,
		.pQueuePriorities = &priority,
	};
	VkPhysicalDeviceVulkan12Features features12 = {
		.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES,
		.shaderBufferInt64Atomics = gpu->device.int64_atomics,
	};
	VkPhysicalDeviceFeatures2 features = {
		.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
		.pNext = &features12,
		.features = { .shaderInt64 = gpu->device.int64 },
	};
	VkDeviceCreateInfo info = {
		.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
		.pNext = &features,
		.queueCreateInfoCount = 1,
		.pQueueCreateInfos = &queue,
		.enabledExtensionCount = gpu->imports ? 1 : 0,
		.ppEnabledExtensionNames = extension,
	};
	VkResult result = vkCreateDevice(gpu->device.handle, &info, NULL, &gpu->handle);
	if (result != VK_SUCCESS) {
		GW_TRY(check_threads(gpu, error)); /* drivers have no result of their own for that */
		return gw_vulkan_fail(gpu, error, "vkCreateDevice", gpu->device.info.name, result);
	}
	vkGetDeviceQueue(gpu->handle, gpu->device.queue_family, 0, &gpu->queue);
	gw_gpu_name(gpu, VK_OBJECT_TYPE_QUEUE, (uint64_t)(uintptr_t)gpu->queue, "queue");
	return GW_OK;
}

static gw_status create_commands(gw_gpu *gpu, gw_error *error)
{
	VkCommandPoolCreateInfo pool = {
		.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
		.queueFamilyIndex = gpu->device.queue_family,
	};
	GW_VULKAN(gpu, error, "commands", vkCreateCommandPool(gpu->handle, &pool, NULL, &gpu->pool));
	gw_gpu_name(gpu, VK_OBJECT_TYPE_COMMAND_POOL, (uint64_t)gpu->pool, "command pool");
	VkCommandBufferAllocateInfo commands = {
		.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
		.commandPool = gpu->pool,
		.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
		.commandBufferCount = 1,
	};
	GW_VULKAN(gpu, error, "commands",
			  vkAllocateCommandBuffers(gpu->handle, &commands, &gpu->commands));
	gw_gpu_name(gpu, VK_OBJECT_TYPE_COMMAND_BUFFER, (uint64_t)(uintptr_t)gpu->commands, "commands");
	VkFenceCreateInfo fence = { .sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO };
	GW_VULKAN(gpu, error, "commands", vkCreateFence(gpu->handle, &fence, NULL, &gpu->fence));
	gw_gpu_name(gpu, VK_OBJECT_TYPE_FENCE, (uint64_t)gpu->fence, "submission done");

	if (gpu->device.timestamp_bits == 0 || !(gpu->device.properties.limits.timestampPeriod > 0))
		return GW_OK;
	VkQueryPoolCreateInfo queries = {
		.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
		.queryType = VK_QUERY_TYPE_TIMESTAMP,
		.queryCount = 2,
	};
	GW_VULKAN(gpu, error, "timestamps",
			  vkCreateQueryPool(gpu->handle, &queries, NULL, &gpu->timestamps));
	gw_gpu_name(gpu, VK_OBJECT_TYPE_QUERY_POOL, (uint64_t)gpu->timestamps, "timestamps");
	return GW_OK;
}

static gw_status create_sampler(gw_gpu *gpu, VkFilter filter, const char *name, VkSampler *sampler,
								gw_error *error)
{
	VkSamplerCreateInfo info = {
		.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
		.magFilter = filter,
		.minFilter = filter,
		.mipmapMode = VK_SAMPLER_MIPMAP_MODE_NEAREST,
		.addressModeU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
		.addressModeV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
		.addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
	};
	GW_VULKAN(gpu, error, name, vkCreateSampler(gpu->handle, &info, NULL, sampler));
	gw_gpu_name(gpu, VK_OBJECT_TYPE_SAMPLER, (uint64_t)*sampler, name);
	return GW_OK;
}

/* How much may be allocated: see gw_gpu_options.memory. */
static uint64_t choose_budget(const gw_gpu *gpu, uint64_t asked)
{
	if (gpu->device.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU) {
		/* The software driver's heap size says little, and it never refuses an allocation. */
		uint64_t available = gw_available_memory() / 4 * 3;
		if (available == 0)
			available = gpu->device.info.memory;
		return asked > 0 && asked < available ? asked : available;
	}
	return asked > 0 && asked < gpu->device.info.memory ? asked : gpu->device.info.memory;
}

static void read_limits(gw_gpu *gpu)
{
	VkPhysicalDeviceMaintenance3Properties maintenance = {
		.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_3_PROPERTIES
	};
	VkPhysicalDeviceProperties2 properties = { .sType =
												   VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2,
											   .pNext = &maintenance };
	vkGetPhysicalDeviceProperties2(gpu->device.handle, &properties);
	vkGetPhysicalDeviceMemoryProperties(gpu->device.handle, &gpu->memory);
	gpu->largest_allocation = maintenance.maxMemoryAllocationSize;
	gpu->storage_range = properties.properties.limits.maxStorageBufferRange;
	gpu->may_map = true;
}

static gw_status check_workgroup_size(const gw_gpu *gpu, gw_error *error)
{
	const VkPhysicalDeviceLimits *limits = gw_gpu_limits(gpu);
	uint32_t size = gpu->workgroup_size;
	if ((size & (size - 1)) != 0)
		return gw_fail(error, GW_ERROR_USAGE, "a workgroup of %u threads is not a power of two",
					   size);
	if (size > limits->maxComputeWorkGroupSize[0] || size > limits->maxComputeWorkGroupInvocations)
		return gw_fail(error, GW_ERROR_USAGE,
					   "a workgroup of %u threads is more than \"%s\" allows (%u)", size,
					   gpu->device.info.name, limits->maxComputeWorkGroupInvocations);
	return GW_OK;
}

static gw_status check_passes(const gw_gpu *gpu, gw_error *error)
{
	if (gpu->passes != GW_PASSES_CPU || gw_gpu_shares_memory(gpu))
		return GW_OK;
	return gw_fail(error, GW_ERROR_USAGE,
				   "\"%s\" has memory of its own, in which loops of the processor cannot stand in "
				   "for passes: choose the software driver, or leave the choice of passes open",
				   gpu->device.info.name);
}

static gw_status open_device(const gw_gpu_options *options, gw_gpu *gpu, gw_error *error)
{
	GW_TRY(gw_instance_create(options, &gpu->messages, &gpu->instance, error));
	gw_candidate *list;
	size_t count;
	GW_TRY(gw_candidates_find(gpu->instance.handle, &list, &count, error));
	gw_status status = gw_candidate_choose(list, count, options->device, &gpu->device, error);
	free(list);
	if (status != GW_OK)
		return status;
	read_limits(gpu);
	gpu->budget = choose_budget(gpu, options->memory);
	gpu->cancelled = options->cancelled;
	gpu->user = options->user;
	gpu->slice_seconds =
		options->slice_seconds > 0 ? options->slice_seconds : SLICE_SECONDS_DEFAULT;
	gpu->workgroup_size = options->workgroup_size > 0 ? options->workgroup_size : GW_WORKGROUP_SIZE;
	gpu->passes = options->passes;
	GW_TRY(check_workgroup_size(gpu, error));
	GW_TRY(check_passes(gpu, error));
	GW_TRY(create_device(gpu, error));
	GW_TRY(create_commands(gpu, error));
	GW_TRY(create_sampler(gpu, VK_FILTER_LINEAR, "linear sampler", &gpu->linear, error));
	GW_TRY(create_sampler(gpu, VK_FILTER_NEAREST, "nearest sampler", &gpu->nearest, error));
	return gw_gpu_check(gpu, error);
}

gw_status gw_gpu_create(const gw_gpu_options *options, gw_gpu **gpu, gw_error *error)
{
	assert(options != NULL && gpu != NULL);
	*gpu = gw_allocate_zeros(1, sizeof **gpu);
	if (*gpu == NULL)
		return gw_fail(error, GW_ERROR_MEMORY, "not enough memory to open a device");
	gw_status status = open_device(options, *gpu, error);
	if (status != GW_OK)
		gw_gpu_destroy(gpu);
	return status;
}

void gw_gpu_destroy(gw_gpu **gpu_address)
{
	gw_gpu *gpu = *gpu_address;
	if (gpu == NULL)
		return;
	*gpu_address = NULL;
	if (gpu->stuck)
		return;
	if (gpu->handle != VK_NULL_HANDLE) {
		gw_staging_destroy(gpu);
		vkDestroySampler(gpu->handle, gpu->linear, NULL);
		vkDestroySampler(gpu->handle, gpu->nearest, NULL);
		vkDestroyQueryPool(gpu->handle, gpu->timestamps, NULL);
		vkDestroyFence(gpu->handle, gpu->fence, NULL);
		vkDestroyCommandPool(gpu->handle, gpu->pool, NULL);
		vkDestroyDevice(gpu->handle, NULL);
	}
	gw_instance_destroy(&gpu->instance);
	free(gpu);
}

const gw_device_info *gw_gpu_device(const gw_gpu *gpu)
{
	return &gpu->device.info;
}

const VkPhysicalDeviceLimits *gw_gpu_limits(const gw_gpu *gpu)
{
	return &gpu->device.properties.limits;
}

uint32_t gw_gpu_validation_messages(const gw_gpu *gpu, const char **first)
{
	if (first != NULL)
		*first = gpu->messages.first;
	return gpu->messages.count;
}

gw_gpu_account gw_gpu_read_account(const gw_gpu *gpu)
{
	return gpu->account;
}

/* -------------------------------------------------------------------------- submissions */

static void record_barrier(VkCommandBuffer commands, VkPipelineStageFlags before,
						   VkPipelineStageFlags after)
{
	VkMemoryBarrier barrier = {
		.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
		.srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT,
		.dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT,
	};
	vkCmdPipelineBarrier(commands, before, after, 0, 1, &barrier, 0, NULL, 0, NULL);
}

/* The stages that work of ours runs in. */
#define WORK_STAGES (VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT)

gw_status gw_commands_begin(gw_gpu *gpu, gw_error *error)
{
	GW_TRY(gw_gpu_check(gpu, error));
	GW_VULKAN(gpu, error, "commands", vkResetCommandPool(gpu->handle, gpu->pool, 0));
	VkCommandBufferBeginInfo info = {
		.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
		.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT,
	};
	GW_VULKAN(gpu, error, "commands", vkBeginCommandBuffer(gpu->commands, &info));
	if (gpu->timestamps != VK_NULL_HANDLE)
		vkCmdResetQueryPool(gpu->commands, gpu->timestamps, 0, 2);
	record_barrier(gpu->commands, WORK_STAGES | VK_PIPELINE_STAGE_HOST_BIT, WORK_STAGES);
	if (gpu->timestamps != VK_NULL_HANDLE)
		vkCmdWriteTimestamp(gpu->commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, gpu->timestamps,
							0);
	return GW_OK;
}

void gw_commands_barrier(gw_gpu *gpu)
{
	record_barrier(gpu->commands, WORK_STAGES, WORK_STAGES);
}

/* Seconds between the two timestamps, which may have wrapped once. */
static double read_timestamps(gw_gpu *gpu, double fallback)
{
	uint64_t tick[2];
	if (gpu->timestamps == VK_NULL_HANDLE ||
		vkGetQueryPoolResults(gpu->handle, gpu->timestamps, 0, 2, sizeof tick, tick, sizeof tick[0],
							  VK_QUERY_RESULT_64_BIT) != VK_SUCCESS)
		return fallback;
	uint32_t bits = gpu->device.timestamp_bits;
	uint64_t mask = bits >= 64 ? UINT64_MAX : (UINT64_C(1) << bits) - 1;
	return 1e-9 * (double)gw_gpu_limits(gpu)->timestampPeriod *
		   (double)((tick[1] - tick[0]) & mask);
}

/* Waits until the device is done. Threads of a software driver may have failed to start after all:
 * then it would wait for ever. */
static gw_status wait_for_device(gw_gpu *gpu, const char *what, gw_error *error)
{
	VkResult result;
	while ((result = vkWaitForFences(gpu->handle, 1, &gpu->fence, VK_TRUE, WAIT_NANOSECONDS)) ==
		   VK_TIMEOUT) {
		gpu->stuck = gpu->device.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU &&
					 gw_threads_startable(1) == 0;
		if (gpu->stuck)
			return gw_fail(error, GW_ERROR_MEMORY,
						   "no thread can be started for \"%s\" on \"%s\": allow more (see ulimit "
						   "-u), or more memory",
						   what, gpu->device.info.name);
	}
	return result == VK_SUCCESS ? GW_OK
								: gw_vulkan_fail(gpu, error, "vkWaitForFences", what, result);
}

gw_status gw_commands_submit(gw_gpu *gpu, const char *what, double *seconds, gw_error *error)
{
	if (gpu->timestamps != VK_NULL_HANDLE)
		vkCmdWriteTimestamp(gpu->commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, gpu->timestamps,
							1);
	record_barrier(gpu->commands, WORK_STAGES, WORK_STAGES | VK_PIPELINE_STAGE_HOST_BIT);
	GW_VULKAN(gpu, error, what, vkEndCommandBuffer(gpu->commands));
	VkSubmitInfo info = {
		.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
		.commandBufferCount = 1,
		.pCommandBuffers = &gpu->commands,
	};
	double start = gw_seconds();
	GW_VULKAN(gpu, error, what, vkQueueSubmit(gpu->queue, 1, &info, gpu->fence));
	GW_TRY(wait_for_device(gpu, what, error));
	GW_VULKAN(gpu, error, what, vkResetFences(gpu->handle, 1, &gpu->fence));
	double wall = gw_seconds() - start;
	if (seconds != NULL)
		*seconds = read_timestamps(gpu, wall);
	return gw_gpu_check(gpu, error);
}

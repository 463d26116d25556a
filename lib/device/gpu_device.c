/*
 * gpu_device.c - opening and closing a device, its account.
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

#define SLICE_SECONDS_DEFAULT 0.05

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
		.queryCount = 2 * GW_STEPS_MAX,
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
	GW_TRY(status);
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

void gw_gpu_keep_passes(gw_gpu *gpu)
{
	gpu->keeps_passes = true;
}

void gw_gpu_begin_again(gw_gpu *gpu, const gw_gpu_options *options)
{
	gw_gpu_settle(gpu);
	const uint64_t bytes = gpu->account.bytes;
	gpu->budget = choose_budget(gpu, options->memory);
	gpu->cancelled = options->cancelled;
	gpu->user = options->user;
	gpu->stopped = false;
	gpu->missed = (gw_error){ 0 };
	gpu->account = (gw_gpu_account){ .bytes = bytes, .peak_bytes = bytes };
	memset(gpu->pass_runs, 0, sizeof gpu->pass_runs);
	memset(gpu->pass_compiled, 0, sizeof gpu->pass_compiled);
}

static void destroy_spare_passes(gw_gpu *gpu)
{
	for (int id = 0; id < GW_PASS_COUNT; id++)
		while (gpu->spare[id]) {
			gw_spare_pass *spare = gpu->spare[id];
			gpu->spare[id] = spare->next;
			gw_pass_destroy(gpu, &spare->pass);
			free(spare);
		}
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
		destroy_spare_passes(gpu);
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

uint32_t gw_gpu_validation_messages(const gw_gpu *gpu, const char **first)
{
	if (first != NULL)
		*first = gpu->messages.first;
	return gpu->messages.count;
}

gw_gpu_account gw_gpu_read_account(gw_gpu *gpu)
{
	gw_gpu_settle(gpu);
	return gpu->account;
}

uint64_t gw_gpu_restart_peak(gw_gpu *gpu)
{
	uint64_t peak = gpu->account.peak_bytes;
	gpu->account.peak_bytes = gpu->account.bytes;
	return peak;
}

void gw_gpu_restore_peak(gw_gpu *gpu, uint64_t peak)
{
	if (gpu->account.peak_bytes < peak)
		gpu->account.peak_bytes = peak;
}

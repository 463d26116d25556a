/*
 * gpu_commands.c - work for a device: whether it may go on, recording, submitting, waiting.
 *
 * There is one command buffer. What is recorded stays in it until somebody needs it done; then it
 * is submitted as a whole, and waited for, so that never more than one submission is under way.
 * Between any two things that are recorded one after the other is a full barrier: passes follow
 * each other because each reads what the one before wrote. What is recorded notes the buffers and
 * images that it uses: only who touches one of these has to wait.
 */
#include "device/gpu_internal.h"
#include "base/parallel.h"
#include "glowworm_host.h"

#include <assert.h>
#include <stdatomic.h>
#include <stdio.h>
#include <time.h>

/* Between two looks at whether it waits in vain: 1 s. */
#define WAIT_NANOSECONDS UINT64_C(1000000000)

/* A software driver that computes uses more of the processor than this between two looks; one that
 * used less at so many looks one after the other has lost a thread. */
#define IDLE_SECONDS 1e-3
#define IDLE_MOST 15u

/* A driver of this process was given up. */
static atomic_bool one_is_stuck;

bool gw_lent_memory_is_kept(void)
{
	return atomic_load(&one_is_stuck);
}

const VkPhysicalDeviceLimits *gw_gpu_limits(const gw_gpu *gpu)
{
	return &gpu->device.properties.limits;
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
	if (gpu->stuck)
		return gw_fail(error, GW_ERROR_MEMORY, "%s", gpu->lost_text);
	if (gpu->lost)
		return gw_fail(error, GW_ERROR_INTERNAL, "%s", gpu->lost_text);
	if (gpu->missed.status != GW_OK)
		return gw_fail(error, gpu->missed.status, "%s", gpu->missed.text);
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

/* Begins the command buffer, which is not in use. */
static gw_status begin_batch(gw_gpu *gpu, gw_error *error)
{
	gw_batch *batch = &gpu->batch;
	GW_VULKAN(gpu, error, "commands", vkResetCommandPool(gpu->handle, gpu->pool, 0));
	VkCommandBufferBeginInfo info = {
		.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
		.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT,
	};
	GW_VULKAN(gpu, error, "commands", vkBeginCommandBuffer(gpu->commands, &info));
	if (gpu->timestamps != VK_NULL_HANDLE)
		vkCmdResetQueryPool(gpu->commands, gpu->timestamps, 0, 2 * GW_STEPS_MAX);
	record_barrier(gpu->commands, WORK_STAGES | VK_PIPELINE_STAGE_HOST_BIT, WORK_STAGES);
	batch->open = true;
	batch->number++;
	batch->step_count = batch->use_count = 0;
	batch->expected = 0.0;
	batch->what = "commands";
	return GW_OK;
}

gw_status gw_commands_begin(gw_gpu *gpu, gw_error *error)
{
	GW_TRY(gw_gpu_check(gpu, error));
	if (gpu->batch.use_count + GW_BINDINGS_MAX > GW_USES_MAX)
		GW_TRY(gw_commands_submit(gpu, error));
	if (!gpu->batch.open)
		return begin_batch(gpu, error);
	gw_commands_barrier(gpu);
	return GW_OK;
}

void gw_commands_barrier(gw_gpu *gpu)
{
	record_barrier(gpu->commands, WORK_STAGES, WORK_STAGES);
}

void gw_commands_use(gw_gpu *gpu, uint64_t handle, const char *what)
{
	gw_batch *batch = &gpu->batch;
	assert(batch->open && batch->use_count < GW_USES_MAX);
	batch->use[batch->use_count++] = handle;
	batch->what = what;
}

bool gw_commands_used(const gw_gpu *gpu, uint64_t handle)
{
	const gw_batch *batch = &gpu->batch;
	for (uint32_t i = 0; i < batch->use_count && batch->open; i++)
		if (batch->use[i] == handle)
			return true;
	return false;
}

static void write_timestamp(gw_gpu *gpu, uint32_t index)
{
	if (gpu->timestamps != VK_NULL_HANDLE)
		vkCmdWriteTimestamp(gpu->commands, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, gpu->timestamps,
							index);
}

void gw_commands_begin_step(gw_gpu *gpu)
{
	assert(gpu->batch.open && gpu->batch.step_count < GW_STEPS_MAX);
	write_timestamp(gpu, 2 * gpu->batch.step_count);
}

void gw_commands_end_step(gw_gpu *gpu, gw_step step)
{
	gw_batch *batch = &gpu->batch;
	write_timestamp(gpu, 2 * batch->step_count + 1);
	batch->step[batch->step_count++] = step;
}

/* Books how long each step took: between its timestamps, which may have wrapped once, or else an
 * equal share of the whole. */
static void book_steps(gw_gpu *gpu, double whole)
{
	uint64_t tick[2 * GW_STEPS_MAX];
	const gw_batch *batch = &gpu->batch;
	bool told =
		batch->step_count > 0 && gpu->timestamps != VK_NULL_HANDLE &&
		vkGetQueryPoolResults(gpu->handle, gpu->timestamps, 0, 2 * batch->step_count, sizeof tick,
							  tick, sizeof tick[0], VK_QUERY_RESULT_64_BIT) == VK_SUCCESS;
	uint32_t bits = gpu->device.timestamp_bits;
	uint64_t mask = bits >= 64 ? UINT64_MAX : (UINT64_C(1) << bits) - 1;
	double period = 1e-9 * (double)gw_gpu_limits(gpu)->timestampPeriod;
	for (uint32_t i = 0; i < batch->step_count; i++) {
		uint64_t ticks = told ? (tick[2 * i + 1] - tick[2 * i]) & mask : 0;
		gw_pass_book(gpu, batch->step[i],
					 told ? period * (double)ticks : whole / (double)batch->step_count);
	}
}

/* Seconds of the processor that this process has used. */
static double processor_seconds(void)
{
	struct timespec used = { 0 };
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
	return (double)used.tv_sec + 1e-9 * (double)used.tv_nsec;
}

/* Gives the driver up, and says so from then on. */
static gw_status give_up(gw_gpu *gpu, const char *what, bool idle, gw_error *error)
{
	const char *device = gpu->device.info.name;
	gpu->stuck = true;
	atomic_store(&one_is_stuck, true);
	if (idle)
		snprintf(gpu->lost_text, sizeof gpu->lost_text,
				 "\"%s\" does not end on \"%s\": its driver has waited for %u s with nothing to "
				 "compute, as one does that could not start all of its threads: allow more (see "
				 "ulimit -u), or more memory",
				 what, device, IDLE_MOST);
	else
		snprintf(gpu->lost_text, sizeof gpu->lost_text,
				 "a thread could not be started for \"%s\" on \"%s\": allow more (see ulimit -u), "
				 "or more memory",
				 what, device);
	return gw_gpu_check(gpu, error);
}

/* Waits until the device is done. Threads of a software driver may have failed to start after all:
 * then it would wait for ever, while none of its threads computes or waits for a disk, as those do
 * that read a mapped file. What looking takes does not count. */
static gw_status wait_for_device(gw_gpu *gpu, const char *what, gw_error *error)
{
	VkResult result;
	uint32_t idle = 0;
	bool software = gpu->device.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
	double used = processor_seconds();
	while ((result = vkWaitForFences(gpu->handle, 1, &gpu->fence, VK_TRUE, WAIT_NANOSECONDS)) ==
		   VK_TIMEOUT) {
		bool computes = processor_seconds() - used >= IDLE_SECONDS;
		idle = computes || gw_threads_any_busy() ? 0 : idle + 1;
		if (software && (idle >= IDLE_MOST || gw_threads_startable(1) == 0))
			return give_up(gpu, what, idle >= IDLE_MOST, error);
		used = processor_seconds();
	}
	return result == VK_SUCCESS ? GW_OK
								: gw_vulkan_fail(gpu, error, "vkWaitForFences", what, result);
}

static gw_status submit(gw_gpu *gpu, gw_error *error)
{
	const char *what = gpu->batch.what;
	record_barrier(gpu->commands, WORK_STAGES, WORK_STAGES | VK_PIPELINE_STAGE_HOST_BIT);
	GW_VULKAN(gpu, error, what, vkEndCommandBuffer(gpu->commands));
	VkSubmitInfo info = {
		.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
		.commandBufferCount = 1,
		.pCommandBuffers = &gpu->commands,
	};
	double start = gw_seconds();
	GW_VULKAN(gpu, error, what, vkQueueSubmit(gpu->queue, 1, &info, gpu->fence));
	gpu->account.submissions++;
	GW_TRY(wait_for_device(gpu, what, error));
	GW_VULKAN(gpu, error, what, vkResetFences(gpu->handle, 1, &gpu->fence));
	book_steps(gpu, gw_seconds() - start);
	return gw_gpu_check(gpu, error);
}

gw_status gw_commands_submit(gw_gpu *gpu, gw_error *error)
{
	gw_status status = gw_gpu_check(gpu, error);
	if (!gpu->batch.open)
		return status;
	/* What was recorded before somebody wanted to stop is done: others may have it. After other
	 * errors it is dropped. */
	if (status == GW_OK || status == GW_ERROR_CANCELLED)
		status = submit(gpu, error);
	gpu->batch.open = false;
	return status;
}

gw_status gw_gpu_finish(gw_gpu *gpu, gw_error *error)
{
	return gw_commands_submit(gpu, error);
}

void gw_gpu_settle(gw_gpu *gpu)
{
	gw_error error;
	gw_status status = gpu->batch.open ? gw_commands_submit(gpu, &error) : GW_OK;
	if (status != GW_OK && status != GW_ERROR_CANCELLED && gpu->missed.status == GW_OK)
		gpu->missed = error;
}

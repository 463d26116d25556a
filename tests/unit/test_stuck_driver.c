/* A software driver that waits for ever is given up, one that waits for a disk is not, and of the
 * one that was given up nothing is destroyed, nor is memory given back that it may still read. */
#include "base/parallel.h"
#include "device/gpu_internal.h"
#include "expected.h"
#include "files/input_file.h"
#include "glowworm_host.h"

#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#define WORDS 100u

/* Looks in vain that waits for the device still make, and how many they made. */
static int vain_left, vain;
static int destroyed; /* buffers and pieces of memory */
static bool refused;  /* the next submission is */

VkResult __real_vkWaitForFences(VkDevice device, uint32_t count, const VkFence *fence, VkBool32 all,
								uint64_t nanoseconds);
VkResult __wrap_vkWaitForFences(VkDevice device, uint32_t count, const VkFence *fence, VkBool32 all,
								uint64_t nanoseconds);
VkResult __real_vkQueueSubmit(VkQueue queue, uint32_t count, const VkSubmitInfo *info,
							  VkFence fence);
VkResult __wrap_vkQueueSubmit(VkQueue queue, uint32_t count, const VkSubmitInfo *info,
							  VkFence fence);
void __real_vkDestroyBuffer(VkDevice device, VkBuffer buffer, const VkAllocationCallbacks *by);
void __wrap_vkDestroyBuffer(VkDevice device, VkBuffer buffer, const VkAllocationCallbacks *by);
void __real_vkFreeMemory(VkDevice device, VkDeviceMemory memory, const VkAllocationCallbacks *by);
void __wrap_vkFreeMemory(VkDevice device, VkDeviceMemory memory, const VkAllocationCallbacks *by);

VkResult __wrap_vkWaitForFences(VkDevice device, uint32_t count, const VkFence *fence, VkBool32 all,
								uint64_t nanoseconds)
{
	if (vain_left == 0)
		return __real_vkWaitForFences(device, count, fence, all, nanoseconds);
	vain_left--;
	vain++;
	return VK_TIMEOUT;
}

VkResult __wrap_vkQueueSubmit(VkQueue queue, uint32_t count, const VkSubmitInfo *info,
							  VkFence fence)
{
	bool refuse = refused;
	refused = false;
	return refuse ? VK_ERROR_OUT_OF_HOST_MEMORY : __real_vkQueueSubmit(queue, count, info, fence);
}

void __wrap_vkDestroyBuffer(VkDevice device, VkBuffer buffer, const VkAllocationCallbacks *by)
{
	destroyed++;
	__real_vkDestroyBuffer(device, buffer, by);
}

void __wrap_vkFreeMemory(VkDevice device, VkDeviceMemory memory, const VkAllocationCallbacks *by)
{
	destroyed++;
	__real_vkFreeMemory(device, memory, by);
}

/* A software driver whose copies are work of the device, and a buffer there. */
static gw_gpu *open_software(gw_buffer *buffer)
{
	gw_error error;
	gw_gpu *gpu = open_gpu((gw_gpu_options){ 0 });
	if (gpu->device.properties.deviceType != VK_PHYSICAL_DEVICE_TYPE_CPU) {
		gw_gpu_destroy(&gpu);
		skip();
	}
	gpu->may_map = false;
	const gw_buffer_description description = { GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED, 4 * WORDS,
												"words" };
	assert_ok(gw_buffer_create(gpu, &description, buffer, &error), &error);
	return gpu;
}

static gw_status copy(gw_gpu *gpu, gw_buffer *buffer, gw_error *error)
{
	uint32_t word[WORDS] = { 0 };
	GW_TRY(gw_buffer_upload(gpu, buffer, 0, word, sizeof word, error));
	return gw_gpu_finish(gpu, error);
}

/* Whether bytes of a file, which may have been lent, are still there after it was closed. */
static bool stays_when_closed(void)
{
	gw_error error;
	input_file in;
	assert_ok(input_file_open_as(&in, "/proc/self/exe", UINT64_MAX, 0, &error), &error);
	const uint8_t *data = in.data;
	assert_true(in.storage != INPUT_FILE_HEAP && in.length > 0);
	input_file_close(&in);
	return msync((void *)(uintptr_t)data, 1, MS_ASYNC) == 0;
}

static void it_is_given_up_and_left_alone(void **state)
{
	(void)state;
	gw_error error;
	gw_buffer buffer;
	gw_gpu *gpu = open_software(&buffer), *kept = gpu;
	assert_ok(copy(gpu, &buffer, &error), &error);
	assert_false(gw_lent_memory_is_kept());
	assert_false(stays_when_closed());
	vain_left = 1 << 20;
	vain = 0;
	assert_int_equal(copy(gpu, &buffer, &error), GW_ERROR_MEMORY);
	vain_left = 0;
	assert_true(vain >= 15);
	assert_non_null(strstr(error.text, "nothing to compute"));

	/* No more work, and nothing is destroyed; handles are empty all the same. */
	gw_buffer copy_of_buffer = buffer;
	assert_int_equal(copy(gpu, &buffer, &error), GW_ERROR_MEMORY);
	assert_non_null(strstr(error.text, "nothing to compute"));
	destroyed = 0;
	gw_buffer_destroy(gpu, &buffer);
	assert_true(buffer.handle == VK_NULL_HANDLE);
	gw_gpu_destroy(&gpu);
	assert_null(gpu);
	assert_int_equal(destroyed, 0);
	assert_true(gw_lent_memory_is_kept());
	assert_true(stays_when_closed());

	/* The driver was not stuck at all. */
	assert_int_equal(vkDeviceWaitIdle(kept->handle), VK_SUCCESS);
	kept->stuck = false;
	gw_buffer_destroy(kept, &copy_of_buffer);
	gw_gpu_destroy(&kept);
	assert_true(destroyed > 2);
}

/* Work that fails where nobody can be told, as its buffer is destroyed: later calls say so, until
 * the device is begun with again. */
static void it_tells_later_what_failed(void **state)
{
	(void)state;
	gw_error error;
	gw_buffer buffer, other;
	const gw_buffer_description description = { GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED, 4 * WORDS,
												"other" };
	gw_gpu *gpu = open_software(&buffer);
	assert_ok(gw_buffer_create(gpu, &description, &other, &error), &error);
	assert_ok(gw_buffer_upload(gpu, &buffer, 0, &(uint32_t){ 1 }, 4, &error), &error);
	refused = true;
	gw_buffer_destroy(gpu, &buffer);
	assert_false(refused);
	for (int i = 0; i < 2; i++) {
		assert_int_equal(copy(gpu, &other, &error), GW_ERROR_MEMORY);
		assert_non_null(strstr(error.text, "vkQueueSubmit for words"));
	}
	gw_gpu_begin_again(gpu, &(gw_gpu_options){ 0 });
	gpu->may_map = false;
	assert_ok(copy(gpu, &other, &error), &error);
	gw_buffer_destroy(gpu, &other);
	gw_gpu_destroy(&gpu);
}

static int until[2]; /* a pipe: at its end the disk answers */

/* To the system, whoever waits for a child of vfork waits as for a disk. */
static void *wait_as_for_disk(void *user)
{
	(void)user;
	pid_t child = vfork();
	if (child == 0) {
		char byte;
		ssize_t got = read(until[0], &byte, 1);
		_exit(got == 1 ? 0 : 1);
	}
	waitpid(child, NULL, 0);
	return NULL;
}

static void it_may_wait_for_a_disk(void **state)
{
	(void)state;
	gw_error error;
	gw_buffer buffer;
	pthread_t thread;
	gw_gpu *gpu = open_software(&buffer);
	assert_ok(copy(gpu, &buffer, &error), &error);
	assert_int_equal(pipe(until), 0);
	assert_int_equal(pthread_create(&thread, NULL, wait_as_for_disk, NULL), 0);
	for (int i = 0; i < 10000 && !gw_threads_any_busy(); i++) /* until it has got there */
		usleep(1000);
	assert_true(gw_threads_any_busy());
	vain_left = 60;
	vain = 0;
	assert_ok(copy(gpu, &buffer, &error), &error);
	assert_int_equal(vain, 60);
	assert_int_equal(write(until[1], "", 1), 1);
	assert_int_equal(pthread_join(thread, NULL), 0);
	close(until[0]);
	close(until[1]);
	gw_buffer_destroy(gpu, &buffer);
	gw_gpu_destroy(&gpu);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(it_is_given_up_and_left_alone),
		cmocka_unit_test(it_may_wait_for_a_disk),
		cmocka_unit_test(it_tells_later_what_failed),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}

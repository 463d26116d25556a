/*
 * gpu_internal.h - what the files of the device layer share. Nobody else includes it, except the
 * unit tests that plant faults and that forbid mapping.
 *
 *   gpu_instance.c   instance, validation messages, list and choice of devices
 *   gpu_result.c     what calls of Vulkan return, as sentences
 *   gpu_limits.c     what a device has to have
 *   gpu_commands.c   recording, submitting, waiting
 *   gpu_device.c     opening and closing a device, its account
 *   gpu_memory.c     buffers, images, transfers
 *   gpu_pass.c       passes
 *   gpu_trial.c      trials of a device, for those who look for what is wrong
 */
#ifndef GPU_INTERNAL_H
#define GPU_INTERNAL_H

#include "device/gpu.h"
#include "device/pass_table.h"

/* The Vulkan instance and the functions of its debug extension (NULL when it isn't there). */
typedef struct gw_instance {
	VkInstance handle;
	VkDebugUtilsMessengerEXT messenger;
	PFN_vkSetDebugUtilsObjectNameEXT set_name;
	PFN_vkDestroyDebugUtilsMessengerEXT destroy_messenger;
	bool lent; /* it belongs to drivers that were loaded before */
} gw_instance;

/* Messages of the validation layer; the layer's callback fills it. */
typedef struct gw_messages {
	uint32_t count;
	uint32_t reported; /* of these, how many an error has told about */
	char first[GW_ERROR_TEXT];
	char latest[GW_ERROR_TEXT];
} gw_messages;

/* One device of the machine with what decides about it. */
typedef struct gw_candidate {
	VkPhysicalDevice handle;
	VkPhysicalDeviceProperties properties;
	uint32_t queue_family;
	uint32_t timestamp_bits;
	bool int64, int64_atomics;
	gw_device_info info;
} gw_candidate;

/* Host-visible memory that copies go through where the device's own cannot be mapped. */
typedef struct gw_staging {
	VkBuffer handle;
	VkDeviceMemory memory;
	void *mapped;
	uint64_t bytes;
	uint64_t allocated;
} gw_staging;

/* What one submission has at most: runs that it measures, and buffers and images that they use, for
 * which there is room for as many as a pass binds as long as it goes on. */
#define GW_STEPS_MAX 64u
#define GW_BINDINGS_MAX 32u
#define GW_USES_MAX (GW_STEPS_MAX * GW_BINDINGS_MAX)

/* A run of a pass, or as much of it as one submission has, between two timestamps. */
typedef struct gw_step {
	gw_pass *pass;
	uint64_t elements; /* 0: the empty span of its first run */
	uint64_t asked;    /* as many would have been right for its length */
} gw_step;

/* Work that was recorded and not submitted yet: see gpu_commands.c. */
typedef struct gw_batch {
	bool open;       /* the command buffer has been begun */
	uint32_t number; /* how many there were before */
	gw_step step[GW_STEPS_MAX];
	uint32_t step_count;
	double expected;           /* seconds, of all steps */
	uint64_t use[GW_USES_MAX]; /* handles of the buffers and images */
	uint32_t use_count;
	const char *what; /* the latest of them is about */
} gw_batch;

/* A pass that was made and is not in use, with its specialisation constants, 0 for those that its
 * shader does not have. */
typedef struct gw_spare_pass {
	uint32_t constant[GW_PASS_CONSTANTS];
	gw_pass *pass;
	struct gw_spare_pass *next;
} gw_spare_pass;

struct gw_gpu {
	gw_instance instance;
	gw_messages messages;
	gw_candidate device; /* the one in use */
	VkPhysicalDeviceMemoryProperties memory;
	uint64_t largest_allocation; /* bytes of one vkAllocateMemory */
	uint64_t storage_range;      /* bytes of one storage binding; tests make it smaller */
	bool may_map;                /* copies map memory where they can; tests forbid it */

	bool imports; /* the device can make buffers of memory of the host */

	VkDevice handle;
	VkQueue queue;
	VkCommandPool pool;
	VkCommandBuffer commands;
	VkFence fence;
	VkQueryPool timestamps; /* two a step; VK_NULL_HANDLE when the queue has none */
	gw_batch batch;
	VkSampler linear, nearest;
	gw_staging staging;

	uint64_t budget; /* bytes */
	uint32_t workgroup_size;
	double slice_seconds;
	gw_pass_choice passes;
	bool (*cancelled)(void *user); /* or NULL */
	void *user;
	bool stopped; /* it said so once */
	gw_gpu_account account;
	uint64_t pass_runs[GW_PASS_COUNT]; /* of pass_table.h, by shader or by kernel */
	uint32_t pass_compiled[GW_PASS_COUNT];
	bool keeps_passes;
	gw_spare_pass *spare[GW_PASS_COUNT]; /* those that nobody uses now; owned */
	/* The driver was given up while work that it had begun had not ended. No more work is
	 * submitted, and since the driver may still use them, its buffers, images and passes are not
	 * destroyed but left to the end of the process. */
	bool stuck;
	bool lost;                     /* the device is */
	char lost_text[GW_ERROR_TEXT]; /* why, of either */
	gw_error missed; /* work failed when nobody could be told: calls say so from then on */
};

/* ---------------------------------------------------------------------------------- results */

/* Name of a result, "VK_ERROR_DEVICE_LOST". */
const char *gw_vulkan_result_name(VkResult result);

/*
 * Turns a failed result into an error of the right class. `call` is the call's source text; the
 * sentence names the function. A lost device is remembered: from then on gw_gpu_check fails.
 *   gpu   may be NULL
 *   what  what the call was for: the name of a buffer or pass
 */
gw_status gw_vulkan_fail(gw_gpu *gpu, gw_error *error, const char *call, const char *what,
						 VkResult result);

/* Returns from the calling function when a Vulkan call did not succeed. */
#define GW_VULKAN(gpu, error, what, call)                                                          \
	do {                                                                                           \
		VkResult gw_result_ = (call);                                                              \
		if (gw_result_ != VK_SUCCESS)                                                              \
			return gw_vulkan_fail((gpu), (error), #call, (what), gw_result_);                      \
	} while (0)

/* Fails when the device is lost, the work was stopped, or validation has said something that no
 * error told yet. */
gw_status gw_gpu_check(gw_gpu *gpu, gw_error *error);

/* --------------------------------------------------------------------------------- instance */

gw_status gw_instance_create(const gw_gpu_options *options, gw_messages *messages,
							 gw_instance *instance, gw_error *error);
void gw_instance_destroy(gw_instance *instance);

/* Finds all devices, best first. The caller frees *list. */
gw_status gw_candidates_find(VkInstance instance, gw_candidate **list, size_t *count,
							 gw_error *error);

/* Picks the device that `wanted` means (NULL: the first usable one). */
gw_status gw_candidate_choose(const gw_candidate *list, size_t count, const char *wanted,
							  gw_candidate *chosen, gw_error *error);

/* What is asked of a device's limits, for gw_device_info. */
void gw_limits_list(const gw_candidate *device, gw_device_limit limit[GW_DEVICE_LIMITS]);

/* ------------------------------------------------------------------------------ submissions */

/* Names an object for validation messages and debuggers. */
void gw_gpu_name(gw_gpu *gpu, VkObjectType type, uint64_t handle, const char *name);

/* Begins the command buffer, or goes on with it where it is begun; what was recorded or submitted
 * before is done and visible to what follows. */
gw_status gw_commands_begin(gw_gpu *gpu, gw_error *error);

/* Notes that what is recorded next uses a buffer or an image.
 *   what   named in errors */
void gw_commands_use(gw_gpu *gpu, uint64_t handle, const char *what);

/* Whether what was recorded and not submitted yet uses it. */
bool gw_commands_used(const gw_gpu *gpu, uint64_t handle);

/* What is recorded between the two is a step; gw_pass_book is told how long it took. */
void gw_commands_begin_step(gw_gpu *gpu);
void gw_commands_end_step(gw_gpu *gpu, gw_step step);

/* Everything recorded so far is finished and visible to everything recorded from here on. */
void gw_commands_barrier(gw_gpu *gpu);

/* Submits what was recorded, if anything was, and waits for it; it is visible to the host then. */
gw_status gw_commands_submit(gw_gpu *gpu, gw_error *error);

/* ----------------------------------------------------------------------------------- memory */

/* Frees the staging buffer. */
void gw_staging_destroy(gw_gpu *gpu);

/* ----------------------------------------------------------------------------------- passes */

/* One dispatch of a pass: elements [first, first + count), by one of its GW_SLICES_MAX descriptor
 * sets. Nothing in flight may use that set. */
typedef struct gw_slice {
	uint32_t first;
	uint32_t count;
	uint32_t set;
} gw_slice;

/* Bytes of push constants that a pass has at most: what every Vulkan device has. */
#define GW_PUSH_BYTES_MAX 128u

/* Threads of a workgroup, unless a pass or the caller asks for another number. */
#define GW_WORKGROUP_SIZE 64u

/*
 * The software driver ends all loops of a group of 8 lanes after 65,535 iterations, summed over
 * branches that diverge, and says nothing: 8 * 8000 stays below that.
 */
#define GW_LOOP_BOUND_MAX 8000u
#define GW_LOOP_LANES 8u

/* Slices that one submission holds at most, when windows force them to be short. */
#define GW_SLICES_MAX 16u

/*
 * Records one slice into the begun command buffer, without any barrier.
 *   push  as of gw_pass_run
 */
gw_status gw_pass_record(gw_gpu *gpu, gw_pass *pass, gw_slice slice, const gw_binding *bindings,
						 const void *push, gw_error *error);

/* Books how long a step took. */
void gw_pass_book(gw_gpu *gpu, gw_step step, double seconds);

#endif

/*
 * gpu.h - the Vulkan compute layer: one device, buffers, 3D images and passes.
 *
 * A pass is a compute pipeline with its bindings. Everything that can fail returns gw_status and
 * fills a gw_error; every Vulkan result is checked, every object carries a name. The layer keeps
 * its own account of device memory, because the software driver never reports that memory is
 * short, and splits every dispatch so that none runs long (watchdogs) or loops past the software
 * driver's silent limit.
 *
 * Work is recorded, and submitted when the host asks for what it made, when it has become as much
 * as should be submitted at once, or by gw_gpu_finish: so a chain of passes is one submission, for
 * which the host waits once. Nobody who uses the functions below sees the difference, except that
 * an error may be told by a later call. Those who read or write gw_buffer.mapped themselves call
 * gw_gpu_settle before.
 *
 * Thread-safety: a gw_gpu and all that was made with it belong to one thread at a time.
 */
#ifndef GPU_H
#define GPU_H

#include "glowworm.h"

#include <vulkan/vulkan.h>

typedef struct gw_gpu gw_gpu;

typedef struct gw_gpu_options {
	const char *device; /* NULL: the best; else index, type name or part of a name */
	uint64_t memory;    /* bytes of device memory that may be allocated; 0, or more than
						   there is: the heap's size, or on a CPU device 3/4 of the
						   machine's available memory */
	bool validate;      /* core validation; messages become errors of the next call */
	bool validate_synchronization;
	bool validate_gpu_assisted;    /* not together with validate_synchronization */
	uint32_t workgroup_size;       /* threads a workgroup, power of two; 0: the layer chooses */
	gw_drivers *drivers;           /* NULL, or loaded before: used when there is no validation; they
									  outlive the device */
	double slice_seconds;          /* target length of one dispatch; 0: 0.05 */
	gw_pass_choice passes;         /* see passes.h. GW_PASSES_CPU fails with GW_ERROR_USAGE where
									  the device does not share memory */
	bool (*cancelled)(void *user); /* NULL, or asked between dispatches */
	void *user;
} gw_gpu_options;

/* Returns when drivers are loaded. NULL is accepted. */
void gw_drivers_wait(gw_drivers *drivers);

gw_status gw_gpu_create(const gw_gpu_options *options, gw_gpu **gpu, gw_error *error);
void gw_gpu_destroy(gw_gpu **gpu);

/* Asks whether to stop. Once the answer was yes it stays so: whatever runs or is read afterwards
 * fails with GW_ERROR_CANCELLED, since what was to be computed is not there. */
bool gw_gpu_stopped(gw_gpu *gpu);

/* Waits until all that was asked for is done. */
gw_status gw_gpu_finish(gw_gpu *gpu, gw_error *error);

/* The same for those who cannot fail; if it does, later calls do. */
void gw_gpu_settle(gw_gpu *gpu);

/* Forgets that answer: what was not computed will not be looked at. */
void gw_gpu_resume(gw_gpu *gpu);

/* The device in use; valid as long as the gw_gpu. */
const gw_device_info *gw_gpu_device(const gw_gpu *gpu);

/* Limits that passes ask for: see Vulkan's VkPhysicalDeviceLimits. */
const VkPhysicalDeviceLimits *gw_gpu_limits(const gw_gpu *gpu);

/*
 * From here on passes that are destroyed are kept until the device is closed, for those who want
 * the same again: for bakes that follow each other.
 */
void gw_gpu_keep_passes(gw_gpu *gpu);

/* Begins with an open device again as if it had just been opened: its account is empty, and memory
 * and `cancelled` are those of the options. Nothing of before may be in use, unless it was put
 * aside (passes.h). */
void gw_gpu_begin_again(gw_gpu *gpu, const gw_gpu_options *options);

/* The number of validation messages so far, and the first one's text ("" when none). */
uint32_t gw_gpu_validation_messages(const gw_gpu *gpu, const char **first);

/* ------------------------------------------------------------------------------------- account */

/* Running totals since the device was opened; take differences around a stage. */
typedef struct gw_gpu_account {
	uint64_t bytes;      /* device memory allocated now */
	uint64_t peak_bytes; /* at its highest */
	uint64_t dispatches;
	uint64_t submissions; /* that the host waited for */
	/* From the host to buffers and back: by copies, and what is read or changed in place where
	 * memory is shared, which a device with memory of its own would have copied. */
	uint64_t uploaded_bytes;
	uint64_t downloaded_bytes;
	double device_seconds;  /* by timestamps, all passes */
	double compile_seconds; /* creating pipelines and their first dispatch */
} gw_gpu_account;

/* Of all that was asked for so far, after waiting for it. */
gw_gpu_account gw_gpu_read_account(gw_gpu *gpu);

/* Sets the highest to what is allocated now, to see by how much something raises it; returns what
 * it was. Afterwards gw_gpu_restore_peak makes it the highest of all again. */
uint64_t gw_gpu_restart_peak(gw_gpu *gpu);
void gw_gpu_restore_peak(gw_gpu *gpu, uint64_t peak);

/* ------------------------------------------------------------------------------------- buffers */

typedef enum gw_buffer_kind {
	GW_BUFFER_STORAGE, /* read and written by passes as a storage buffer */
	GW_BUFFER_TEXEL,   /* the same, and readable as a texel buffer (quick random access on the
						  software driver) through the view of its format */
} gw_buffer_kind;

typedef struct gw_buffer {
	VkBuffer handle;
	VkBufferView view; /* of GW_BUFFER_TEXEL, whole buffer */
	VkDeviceMemory memory;
	uint64_t bytes; /* as asked for */
	uint64_t allocated;
	void *mapped;  /* where its bytes lie if gw_gpu_shares_memory; else NULL */
	bool lent;     /* these are somebody else's, and stay as they are */
	bool fleeting; /* lent, and only for the threads of this program: a pass that the driver runs
					  reads a copy, which becomes the buffer's */
	VkFormat format;
	const char *name;
} gw_buffer;

/* What a buffer is to be. */
typedef struct gw_buffer_description {
	gw_buffer_kind kind;
	VkFormat format;  /* of GW_BUFFER_TEXEL: VK_FORMAT_R32_UINT, R32G32B32A32_SFLOAT, ...; else
						 VK_FORMAT_UNDEFINED */
	uint64_t bytes;   /* a multiple of the format's texel size; of 0 at least 1 is allocated */
	const char *name; /* a string that outlives the buffer */
} gw_buffer_description;

/*
 * Allocates a buffer filled with zeros. An earlier buffer in *buffer must have been destroyed.
 * Fails with GW_ERROR_MEMORY when the budget, an allocation or the texel limit is too small; the
 * sentence holds the bytes needed. On failure *buffer is zeroed.
 */
gw_status gw_buffer_create(gw_gpu *gpu, const gw_buffer_description *description, gw_buffer *buffer,
						   gw_error *error);

/* The same without zeros, for a buffer that is written as a whole next: what it holds till then is
 * not defined. */
gw_status gw_buffer_create_unset(gw_gpu *gpu, const gw_buffer_description *description,
								 gw_buffer *buffer, gw_error *error);

/* What is lent begins at a multiple of this, and can be read up to the next one after its end. */
#define GW_LENT_ALIGNMENT 4096u

/* Whether a buffer can be made of bytes that lie there already: where the device shares memory and
 * its driver can do it, if they begin at such a multiple. */
bool gw_buffer_may_borrow(const gw_gpu *gpu, const void *bytes);

/*
 * A texel buffer of bytes that lie there already, without a copy: for gw_buffer_may_borrow.
 *   description   of GW_BUFFER_TEXEL
 *   lent          stays the caller's, and as it is until the buffer is destroyed: nothing may write
 * to it, no pass either
 *   fleeting      reading it may take a handler of signals, which a driver's threads have not: the
 * driver never reads it
 * For the rest as gw_buffer_create.
 */
gw_status gw_buffer_borrow(gw_gpu *gpu, const gw_buffer_description *description, const void *lent,
						   bool fleeting, gw_buffer *buffer, gw_error *error);

/* Makes a borrowed buffer one that may be written to, by a copy of what is lent; any other one
 * stays as it is. For the rest as gw_buffer_create; on failure it is as before. */
gw_status gw_buffer_own(gw_gpu *gpu, gw_buffer *buffer, gw_error *error);
void gw_buffer_destroy(gw_gpu *gpu, gw_buffer *buffer); /* zeroes it; a zeroed one is accepted */

/* Copies between host and buffer; `data` is the caller's again, or there, when they return. offset
 * and bytes are multiples of 4. A range past the end of the buffer fails. */
gw_status gw_buffer_upload(gw_gpu *gpu, gw_buffer *buffer, uint64_t offset, const void *data,
						   uint64_t bytes, gw_error *error);
gw_status gw_buffer_download(gw_gpu *gpu, const gw_buffer *buffer, uint64_t offset, void *data,
							 uint64_t bytes, gw_error *error);
gw_status gw_buffer_fill(gw_gpu *gpu, gw_buffer *buffer, uint32_t word, gw_error *error);

/* Whether buffers lie in the processor's memory, at gw_buffer.mapped, for it to read and write in
 * place: so with the software driver, whose device is the processor. */
bool gw_gpu_shares_memory(const gw_gpu *gpu);

/* The bytes of a buffer for the processor to read: those themselves where they lie in its memory, a
 * copy elsewhere. All zero is an empty view. */
typedef struct gw_view {
	const void *bytes;
	void *copy; /* NULL, or the same */
} gw_view;

/* Opens a view of the first `bytes` bytes; the buffer is left alone until it is closed. On failure
 * the view is empty. */
gw_status gw_view_open(gw_gpu *gpu, const gw_buffer *buffer, uint64_t bytes, gw_view *view,
					   gw_error *error);
void gw_view_close(gw_view *view); /* empties it; an empty one is accepted */

/* The bytes of a texel buffer for the processor to change: where they lie in its memory those
 * themselves, or a copy that becomes the buffer's if they are lent; elsewhere a copy that goes back
 * in the end. All zero is an empty edit. */
typedef struct gw_edit {
	void *bytes;
	gw_buffer *buffer;
	void *copy; /* NULL, or the same as bytes */
} gw_edit;

/* Opens all of a buffer, which is left alone until the edit is closed. On failure the edit is
 * empty. */
gw_status gw_edit_open(gw_gpu *gpu, gw_buffer *buffer, gw_edit *edit, gw_error *error);

/* Empties it; an empty one is accepted.
 *   changed   false: nothing was written to it */
gw_status gw_edit_close(gw_gpu *gpu, gw_edit *edit, bool changed, gw_error *error);

/* ------------------------------------------------------------------------------------ 3D images */

typedef struct gw_image {
	VkImage handle;
	VkImageView view;
	VkDeviceMemory memory;
	VkFormat format;
	uint32_t extent[3];
	uint64_t allocated;
	const char *name;
} gw_image;

/* Allocates a 3D image cleared to zero, usable as storage image and with a sampler; it stays in
 * VK_IMAGE_LAYOUT_GENERAL. Fails with GW_ERROR_MEMORY when the device's largest side or the budget
 * is too small. */
gw_status gw_image_create(gw_gpu *gpu, VkFormat format, const uint32_t extent[3], const char *name,
						  gw_image *image, gw_error *error);
void gw_image_destroy(gw_gpu *gpu, gw_image *image);
/* Copies the whole image to the host, tightly packed, x fastest. */
gw_status gw_image_download(gw_gpu *gpu, gw_image *image, void *data, uint64_t bytes,
							gw_error *error);

/* --------------------------------------------------------------------------------------- passes */

typedef enum gw_binding_kind {
	GW_BIND_STORAGE,       /* gw_buffer as storage buffer */
	GW_BIND_TEXEL,         /* gw_buffer as uniform texel buffer */
	GW_BIND_TEXEL_WRITTEN, /* gw_buffer as storage texel buffer, imageLoad/imageStore; it may be
							  larger than the device's largest storage range */
	GW_BIND_STORAGE_IMAGE, /* gw_image, imageLoad/imageStore */
	GW_BIND_SAMPLED_IMAGE, /* gw_image with a linear, clamp-to-edge sampler; nearest for formats
							  that the device cannot filter, as integers */
} gw_binding_kind;

/*
 * One resource for one run. stride > 0 windows a storage buffer: each slice sees only the part
 * [first * stride, (first + count) * stride) of it, indexed from 0, so that buffers may be larger
 * than the device's largest storage range. Without stride the whole buffer is bound, which fails
 * when it is larger than that range.
 */
typedef struct gw_binding {
	gw_buffer *buffer;
	gw_image *image;
	uint32_t stride;
} gw_binding;

/*
 * Every push-constant block begins with this span; the layer fills it for each slice. A shader
 * returns at once from invocations at or past `count`; its element is
 * span.first + gl_GlobalInvocationID.x. (No barrier() may follow such a return: passes with
 * barriers clamp instead.)
 */
typedef struct gw_span {
	uint32_t first;
	uint32_t count;
} gw_span;

typedef struct gw_pass gw_pass;

/*
 * What a pass is. Specialisation constant 0 is always the workgroup's size in x (y = z = 1).
 *   elements_per_invocation   how many elements (of gw_pass_run's count) one invocation covers; 0
 *                        and 1 mean one. Above 1 the span counts elements and slices are multiples
 *                        of workgroup_size * elements_per_invocation.
 *   loop_bound           an upper bound of loop iterations of one invocation, 0 when small; slices
 *                        do not help there, so above 8000 gw_pass_create fails: split the work
 */
typedef struct gw_pass_description {
	const char *name;
	const uint32_t *spirv;
	size_t spirv_words;
	const gw_binding_kind *bindings;
	uint32_t binding_count;
	uint32_t push_bytes;      /* with the span; at most 128 */
	const uint32_t *constant; /* specialisation constants 1, 2, ... */
	uint32_t constant_count;
	uint32_t workgroup_size; /* 0: the device's choice; else exactly this, or an error */
	uint32_t elements_per_invocation;
	uint32_t loop_bound;
} gw_pass_description;

gw_status gw_pass_create(gw_gpu *gpu, const gw_pass_description *description, gw_pass **pass,
						 gw_error *error);
void gw_pass_destroy(gw_gpu *gpu, gw_pass **pass);
uint32_t gw_pass_workgroup_size(const gw_pass *pass);

/* Seconds that its runs took by timestamps since this was asked last, after waiting for them. */
double gw_pass_take_seconds(gw_gpu *gpu, gw_pass *pass);

/*
 * Runs a pass over `count` elements, in slices whose length follows the time measured; all that was
 * written before is visible to it, and all that it writes to later passes and copies.
 *   bindings  as many as the pass has, in binding order (binding i is `layout(binding = i)`, set 0)
 *   push      push_bytes bytes; the span at its start is ignored and filled by the layer
 *   count     number of elements; 0 is fine and does nothing
 * The first run of a pass dispatches one workgroup with an empty span (count 0) first and books
 * its time as compile time; nothing may be written then. Slices begin at multiples of the
 * workgroup's elements and of 64; results must not depend on where else they begin, because that
 * follows the time measured. Between slices there is a full barrier.
 */
gw_status gw_pass_run(gw_gpu *gpu, gw_pass *pass, const gw_binding *bindings, const void *push,
					  uint64_t count, gw_error *error);

/* ------------------------------------------------------------------------------------- shaders */

/* Every shaders/NAME.comp, compiled into the library. */
typedef struct gw_shader {
	const char *name; /* "NAME" */
	const uint32_t *spirv;
	size_t words;
} gw_shader;

/* The shader of that name; asserts that it exists. */
const gw_shader *gw_shader_find(const char *name);

/* The i-th of all, or NULL behind the last. */
const gw_shader *gw_shader_at(size_t i);

#endif
